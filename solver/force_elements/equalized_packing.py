"""Equalizers without masses of pulleys become one kind: markers, rows, stiffnesses as drawn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import filled, records
from heavylift.solver.force_elements.equalized import (
    EqualizedEntry,
    EqualizedLine,
    EqualizedLines,
    EqualizedParts,
    EqualizedState,
    LineState,
    SharedLines,
)
from heavylift.solver.force_elements.rope_packing import LARGEST_DRIFT, LARGEST_SHARE
from heavylift.solver.interface import FORCES, ROWS
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.recording import placed
from heavylift.solver.scene.connections import GROUND, JointFrame

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackingContext

__all__ = ["pack"]


def pack(ropes: Sequence[SharedLines], context: PackingContext) -> None:
    """Make a kind of those without friction, and one of those with.

    Raises
    ------
    InputError
        If a line does not reach its lug, or the integrator takes no rows that change at stops.
    """
    for rubs in (False, True):
        members = [rope for rope in ropes if (rope.efficiency < 1.0) is rubs]
        if members:
            context.add_rows(_pack_group(members, context))


def _pack_group(members: Sequence[SharedLines], context: PackingContext) -> EqualizedLines:
    """A kind and its rows."""
    if context.integrator == "accurate":
        raise InputError(
            "'accurate' with lines of one force, whose rows change at stops",
            source=members[0].name,
            key="type",
            expected="integrator 'dele2', or an equalizer with pulleys",
        )
    table: list[EqualizedEntry] = []
    lines: list[EqualizedLine] = []
    for rope in members:
        count, first = rope.segment_count, len(lines)
        level = FORCES if rope.damping > 0.0 else ROWS
        held = list(dict.fromkeys(stop.body for stop in rope.path if stop.body != GROUND))
        block = context.block(rope.name, held)
        direction = np.asarray(rope.direction, dtype=np.float64)
        direction = direction / np.linalg.norm(direction)
        for k in range(count):
            outlet, lug = rope.path[2 * k], rope.path[2 * k + 1]
            cosine = _start_cosine(rope, k, direction, context)
            pair = list(dict.fromkeys(stop.body for stop in (outlet, lug) if stop.body != GROUND))
            own = context.block(rope.name, pair)
            length = float(rope.lengths[k])
            lines.append(
                filled(
                    EqualizedLine,
                    outlet=context.point(outlet.body, outlet.point, level),
                    lug=context.point(lug.body, lug.point, level),
                    guide=context.direction(outlet.body, direction, level, at=outlet.point),
                    block=own,
                    attachments=len(pair),
                    own_outlet=_side(outlet.body, own, pair),
                    own_lug=_side(lug.body, own, pair),
                    all_outlet=_side(outlet.body, block, held),
                    all_lug=_side(lug.body, block, held),
                    length=length,
                    stiffness=rope.line_stiffness * cosine**2 / length,
                    low=rope.depth - rope.up,
                    high=rope.depth + rope.down,
                    damping=rope.damping,
                    largest_drift=min(LARGEST_DRIFT, LARGEST_SHARE * length),
                )
            )
        column = context.column(rope)
        table.append(
            filled(
                EqualizedEntry,
                block=block,
                attachments=len(held),
                first=first,
                count=count,
                column=column,
                parts=placed(EqualizedParts, column),
                shown=context.watched.first.get(rope.name, -1),
                total=count * rope.depth,
                compliance=rope.rope_length / (4.0 * rope.axial_stiffness),
                damping=rope.damping / count,
            )
        )
    state = records(EqualizedState, len(table))
    state["fresh"] = True
    kind = EqualizedLines(
        records(EqualizedEntry, table),
        records(EqualizedLine, lines),
        state,
        records(LineState, len(lines)),
        context.watched.pulls,
    )
    return _with_friction(kind, members) if members[0].efficiency < 1.0 else kind


def _with_friction(kind: EqualizedLines, members: Sequence[SharedLines]) -> EqualizedLines:
    """The kind of lines over sheaves with an efficiency."""
    from heavylift.solver.force_elements.equalized_friction import (
        HeldLine,
        LineSheave,
        RubbingEntry,
        RubbingLines,
    )
    from heavylift.solver.force_elements.sheave_states import make_search

    rubs: list[RubbingEntry] = []
    sheaves = 0
    for entry, rope in zip(kind.table, members, strict=True):
        rubs.append(
            filled(
                RubbingEntry,
                sheave=sheaves,
                share=entry.compliance / entry.count,
                loss=1.0 - rope.efficiency,
                acting=False,
            )
        )
        sheaves += 2 * int(entry.count) - 1
    most = max(rope.segment_count for rope in members)
    return RubbingLines(
        **{name: getattr(kind, name) for name in kind._fields},
        rubs=records(RubbingEntry, rubs),
        held=records(HeldLine, len(kind.lines)),
        sheaves=records(LineSheave, sheaves),
        compliance=np.zeros(most),
        way=np.zeros(most),
        line_force=np.zeros(most),
        matrix=np.zeros((2 * most - 1, 2 * most)),
        search=make_search(2 * most - 1, 1),
    )


def _side(body: str, block: int, held: Sequence[str]) -> int:
    """Attachment of a body in a row on some, -1 on the ground."""
    return -1 if body == GROUND else 2 * block + held.index(body)


def _start_cosine(rope: SharedLines, k: int, direction: Any, context: PackingContext) -> float:
    """Cosine of the angle of a line to its guide as drawn."""
    outlet, lug = (
        context.start_frames(
            FixedJoint(
                name=rope.name,
                body_a=GROUND,
                body_b=stop.body,
                frame_b=JointFrame(np.asarray(stop.point, dtype=np.float64)),
            )
        )[1]
        for stop in rope.path[2 * k : 2 * k + 2]
    )
    way = lug.point - outlet.point
    guide = outlet.axes @ direction
    aside, length = float(np.linalg.norm(way - (way @ guide) * guide)), float(rope.lengths[k])
    if not aside < length:
        raise InputError(
            f"line {k + 1} is {length:.6g} m long, its lug {aside:.6g} m aside from the guide",
            source=rope.name,
            key="lengths",
            expected="lines that reach their lugs",
        )
    return float(np.sqrt(1.0 - (aside / length) ** 2))
