"""Ropes as a group: sum, largest and smallest tension, their spread, how much of the breaking load is used, slack.

With the tensions T_i of all parts of all ropes, of lines of one force the lines, and their breaking load F::

    spread = (max T_i - min T_i) / mean T_i        utilisation = max T_i / F

It acts on nothing. The ropes leave their tensions at the end of every step
(`heavylift.solver.force_elements.line_forces`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Ints1
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Least, NameOf, Positive
from heavylift.numerics.records import Record, Records, filled, records
from heavylift.solver.extremes import Extremes
from heavylift.solver.force_elements.line_forces import LineForce
from heavylift.solver.force_elements.watched import WatchesRopes
from heavylift.solver.interface import Bodies, Workspace, add_forces, record_forces, watch_motions
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at, zeros_of
from heavylift.solver.scene.connections import MEASURES
from heavylift.solver.scene.outputs import (
    Outputs,
    channel,
    largest_of_all,
    nested,
    outputs,
    smallest_of_all,
)
from heavylift.solver.sensors.seen import extremes_of, note_seen, put_seen

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackingContext

__all__ = ["RopeGroup", "RopeGroupEntry", "RopeGroups", "pack"]


@outputs
class RopeGroupSeen(Outputs):
    """What is seen of a group."""

    total_tension: float = channel("force", "sum of the tensions, of each rope the largest of its parts")
    largest_tension: float = channel("force", "largest tension")
    smallest_tension: float = channel("force", "smallest tension")
    spread: float = channel(
        "number", "largest less smallest tension over their mean; 0 while all carry nothing"
    )
    utilisation: float = channel("number", "largest tension over `breaking_load`; 0 without it")


@outputs
class RopeGroupOutputs(Outputs):
    """What a group records."""

    seen: RopeGroupSeen = nested(RopeGroupSeen)
    largest: RopeGroupSeen = largest_of_all(RopeGroupSeen)
    smallest: RopeGroupSeen = smallest_of_all(RopeGroupSeen)
    slack_time: float = channel("time", "how long so far at least one of them has carried nothing")


@MEASURES.describe("rope_groups")
@dataclass(frozen=True, eq=False, kw_only=True)
class RopeGroup(WatchesRopes):
    """Tensions of ropes that share a load, or of the parts of a single one, at the ends of all steps."""

    CHANNELS: ClassVar = RopeGroupOutputs.CHANNELS
    """What it records, in the order of its columns."""

    STEPS: ClassVar = True

    ropes: Annotated[tuple[str, ...], NameOf("ropes"), Least(1)]
    """Ropes of ``[[ropes]]``, or of builders, by names or patterns: ``["sling_*"]``."""
    breaking_load: Annotated[float | None, Positive("force")] = None
    """Of one rope [N], for `utilisation`."""

    @property
    def watched_ropes(self) -> tuple[str, ...]:
        """The ropes."""
        return self.ropes

    @staticmethod
    def check(spec: Any) -> None:
        """Each rope counts once."""
        twice = next((name for name in spec.ropes if list(spec.ropes).count(name) > 1), None)
        if twice is not None:
            raise InputError(f"{twice!r} twice", key="ropes", expected="each rope once")


class RopeGroupEntry(Record):
    """First of its ropes, or lines of one force, and how many; breaking load [N], infinite without; record column."""

    first: int
    count: int
    breaking_load: float
    column: int


group_outputs = outputs_at(RopeGroupOutputs)


class RopeGroupState(Record):
    """How long one of the ropes has carried nothing [s]."""

    slack_time: float


class RopeGroups(Arrays):
    """All groups of a scene.

    Attributes
    ----------
    table
        The groups.
    part_first
        Places in `parts` of each rope of each group: from its own number to the next, shape (n + 1,).
    parts
        Numbers of pulls with the tensions of the ropes.
    pulls
        What ropes pull with, which they write.
    state
        What the groups carry.
    extremes
        Of what is seen of each.
    seen
        Of one of them; scratch.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state", "extremes")

    table: Records[RopeGroupEntry]
    part_first: Ints1
    parts: Ints1
    pulls: Records[LineForce]
    state: Records[RopeGroupState]
    extremes: Records[Extremes]
    seen: RopeGroupSeen


def pack(groups: Sequence[RopeGroup], context: PackingContext) -> None:
    """Make the kind."""
    rows, first, parts, watched = [], [0], [], context.watched
    for group in groups:
        load = math.inf if group.breaking_load is None else group.breaking_load
        members = [member for rope in group.ropes for member in watched.members(rope)]
        entry = filled(
            RopeGroupEntry,
            first=len(first) - 1,
            count=len(members),
            breaking_load=load,
            column=context.column(group),
        )
        rows.append(entry)
        for member in members:
            parts += member
            first.append(len(parts))
    kind = RopeGroups(
        records(RopeGroupEntry, rows),
        np.array(first, dtype=np.int64),
        np.array(parts, dtype=np.int64),
        watched.pulls,
        records(RopeGroupState, len(rows)),
        extremes_of(RopeGroupSeen, len(rows)),
        zeros_of(RopeGroupSeen),
    )
    context.add_forces(kind)


@implement(add_forces, RopeGroups)
@kernel(internal=True)
def add_no_forces(kind: RopeGroups, time: float, work: Workspace) -> None:
    """It only watches."""


@kernel(internal=True)
def _look(kind: RopeGroups, i: int) -> None:
    """Sum, largest and smallest tension, spread, utilisation."""
    entry, seen = kind.table[i], kind.seen
    total = mean = largest = 0.0
    smallest, count = math.inf, 0
    for rope in range(entry.first, entry.first + entry.count):
        of_rope = 0.0
        for k in range(kind.part_first[rope], kind.part_first[rope + 1]):
            tension = kind.pulls[kind.parts[k]].tension
            of_rope = max(of_rope, tension)
            smallest = min(smallest, tension)
            mean += tension
            count += 1
        total += of_rope
        largest = max(largest, of_rope)
    mean /= count
    seen.total_tension, seen.largest_tension, seen.smallest_tension = total, largest, smallest
    seen.spread = (largest - smallest) / mean if mean > 0.0 else 0.0
    seen.utilisation = largest / entry.breaking_load


@implement(watch_motions, RopeGroups)
@kernel(internal=True)
def watch_rope_groups(kind: RopeGroups, bodies: Bodies, work: Workspace) -> None:
    """Extremes at the ends of steps; steps at whose end a rope carries nothing are slack."""
    for i in range(kind.table.shape[0]):
        _look(kind, i)
        if kind.seen.smallest_tension <= 0.0:
            kind.state[i].slack_time += work.control.last_step
        note_seen(kind.extremes, i, work.control.interval, kind.seen.words)


@implement(record_forces, RopeGroups)
@kernel(internal=True)
def record_rope_groups(kind: RopeGroups, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """What is seen, then the largest and smallest values of all of it, and the time of slack ropes."""
    interval = work.control.interval
    for i in range(kind.table.shape[0]):
        out = group_outputs(row, kind.table[i].column)
        _look(kind, i)
        put_seen(
            kind.extremes, i, interval, kind.seen.words, out.seen.words, out.largest.words, out.smallest.words
        )
        out.slack_time = kind.state[i].slack_time
