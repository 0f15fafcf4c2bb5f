"""Equalizers without masses of pulleys become one kind: markers, rows, stiffnesses as drawn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

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
from heavylift.solver.force_elements.system import LawBlock
from heavylift.solver.force_elements.watched import WatchedRopes
from heavylift.solver.interface import FORCES, ROWS
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.packing import start_frames
from heavylift.solver.markers import MarkerBook
from heavylift.solver.recording import placed
from heavylift.solver.rows.structure import Attachment
from heavylift.solver.scene.connections import GROUND, JointFrame
from heavylift.solver.scene.outputs import Columns
from heavylift.solver.scene.scene import AnyBody

__all__ = ["pack_equalized"]


def pack_equalized(
    members: Sequence[SharedLines],
    columns: Sequence[Columns],
    book: MarkerBook,
    attachment: Callable[[str], Attachment],
    scales: Callable[[str], tuple[float, float]],
    bodies: Sequence[AnyBody],
    add: Callable[[LawBlock], int],
    watched: WatchedRopes,
    *,
    integrator: str,
) -> EqualizedLines:
    """Make the kind; `add` takes a row and gives its number, `watched` knows whose pulls something watches.

    Raises
    ------
    InputError
        If a line does not reach its lug, or the integrator takes no rows that change at stops.
    """
    if integrator == "accurate":
        raise InputError(
            "'accurate' with lines of one force, whose rows change at stops",
            source=members[0].name,
            key="type",
            expected="integrator 'dele2', or an equalizer with pulleys",
        )
    table: list[EqualizedEntry] = []
    lines: list[EqualizedLine] = []
    for rope, column in zip(members, columns, strict=True):
        count, first = rope.segment_count, len(lines)
        level = FORCES if rope.damping > 0.0 else ROWS
        held = list(dict.fromkeys(stop.body for stop in rope.path if stop.body != GROUND))
        block = _row(rope.name, held, attachment, scales, add)
        direction = np.asarray(rope.direction, dtype=np.float64)
        direction = direction / np.linalg.norm(direction)
        for k in range(count):
            outlet, lug = rope.path[2 * k], rope.path[2 * k + 1]
            cosine = _start_cosine(rope, k, direction, bodies)
            pair = list(dict.fromkeys(stop.body for stop in (outlet, lug) if stop.body != GROUND))
            own = _row(rope.name, pair, attachment, scales, add)
            length = float(rope.lengths[k])
            lines.append(
                filled(
                    EqualizedLine,
                    outlet=book.point(outlet.body, outlet.point, level),
                    lug=book.point(lug.body, lug.point, level),
                    guide=book.direction(outlet.body, direction, level, at=outlet.point),
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
        table.append(
            filled(
                EqualizedEntry,
                block=block,
                attachments=len(held),
                first=first,
                count=count,
                column=column,
                parts=placed(EqualizedParts, column),
                shown=watched.first.get(rope.name, -1),
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
        watched.pulls,
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


def _row(
    name: str,
    held: Sequence[str],
    attachment: Callable[[str], Attachment],
    scales: Callable[[str], tuple[float, float]],
    add: Callable[[LawBlock], int],
) -> int:
    """Number of a new row on some bodies."""
    return add(
        LawBlock(name, tuple(attachment(body) for body in held), sum(scales(body)[0] for body in held))
    )


def _side(body: str, block: int, held: Sequence[str]) -> int:
    """Attachment of a body in a row on some, -1 on the ground."""
    return -1 if body == GROUND else 2 * block + held.index(body)


def _start_cosine(rope: SharedLines, k: int, direction: Any, bodies: Sequence[AnyBody]) -> float:
    """Cosine of the angle of a line to its guide as drawn."""
    outlet, lug = (
        start_frames(
            FixedJoint(
                name=rope.name,
                body_a=GROUND,
                body_b=stop.body,
                frame_b=JointFrame(np.asarray(stop.point, dtype=np.float64)),
            ),
            bodies,
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
