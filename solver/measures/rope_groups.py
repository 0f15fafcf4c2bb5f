"""Ropes as a group: sum, largest and smallest tension, their spread, how much of the breaking load is used, slack.

With the tensions T_i of all parts of all ropes, of lines of one force the lines, and their breaking load F::

    spread = (max T_i - min T_i) / mean T_i        utilisation = max T_i / F

It acts on nothing. The ropes leave their tensions at the end of every step (`heavylift.solver.laws.pulls`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Ints1
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Least, NameOf, Positive
from heavylift.numerics.records import Record, Records, records
from heavylift.solver.extremes import Extremes, largest_of, note_value, smallest_of
from heavylift.solver.interface import Bodies, Workspace, add_forces, record_forces, watch_motions
from heavylift.solver.kinds import implement
from heavylift.solver.laws.pulls import RopePull
from heavylift.solver.laws.watched import WatchedRopes, WatchesRopes
from heavylift.solver.markers import MarkerBook
from heavylift.solver.scene.connections import MEASURES
from heavylift.solver.scene.descriptions import ChannelKind, interval_extremes

__all__ = ["RopeGroup", "RopeGroupEntry", "RopeGroups", "pack"]

SEEN = (
    ChannelKind("total_tension", "force", "sum of the tensions, of each rope the largest of its parts"),
    ChannelKind("largest_tension", "force", "largest tension"),
    ChannelKind("smallest_tension", "force", "smallest tension"),
    ChannelKind(
        "spread", "number", "largest less smallest tension over their mean; 0 while all carry nothing"
    ),
    ChannelKind("utilisation", "number", "largest tension over `breaking_load`; 0 without it"),
)
"""What is seen of a group, in the order of its columns."""

VALUES = 5
"""Numbers of it."""
LARGEST, SMALLEST = zip(*(interval_extremes(seen.name, seen.quantity) for seen in SEEN), strict=True)
"""Channels of extremes over all steps, in the same order."""
SLACK = ChannelKind("slack_time", "time", "how long so far at least one of them has carried nothing")


@MEASURES.describe("rope_groups")
@dataclass(frozen=True, eq=False, kw_only=True)
class RopeGroup(WatchesRopes):
    """Tensions of ropes that share a load, or of the parts of a single one, at the ends of all steps."""

    CHANNELS: ClassVar = (*SEEN, *LARGEST, *SMALLEST, SLACK)
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
    def check(said: Any) -> None:
        """Each rope counts once."""
        twice = next((name for name in said.ropes if list(said.ropes).count(name) > 1), None)
        if twice is not None:
            raise InputError(f"{twice!r} twice", key="ropes", expected="each rope once")


class RopeGroupEntry(Record):
    """First of its ropes, or lines of one force, and how many; breaking load [N], infinite without; record column."""

    first: int
    count: int
    breaking_load: float
    column: int


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
        Of the `VALUES` of each, one after the other.
    values
        What is seen of one of them, in the order of its columns; scratch, shape (VALUES,).
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state", "extremes")

    table: Records[RopeGroupEntry]
    part_first: Ints1
    parts: Ints1
    pulls: Records[RopePull]
    state: Records[RopeGroupState]
    extremes: Records[Extremes]
    values: Floats1


def pack(
    groups: Sequence[RopeGroup], columns: Sequence[int], _book: MarkerBook, watched: WatchedRopes
) -> RopeGroups:
    """Make the kind."""
    rows, first, parts = [], [0], []
    for group, column in zip(groups, columns, strict=True):
        load = math.inf if group.breaking_load is None else group.breaking_load
        members = [member for rope in group.ropes for member in watched.members(rope)]
        rows.append((len(first) - 1, len(members), load, column))
        for member in members:
            parts += member
            first.append(len(parts))
    return RopeGroups(
        records(RopeGroupEntry, rows),
        np.array(first, dtype=np.int64),
        np.array(parts, dtype=np.int64),
        watched.pulls,
        records(RopeGroupState, len(rows)),
        records(Extremes, VALUES * len(rows)),
        np.zeros(VALUES),
    )


@implement(add_forces, RopeGroups)
@kernel(internal=True)
def add_no_forces(kind: RopeGroups, time: float, work: Workspace) -> None:
    """It only watches."""


@kernel(internal=True)
def _look(kind: RopeGroups, i: int) -> None:
    """Sum, largest and smallest tension, spread, utilisation."""
    entry, values = kind.table[i], kind.values
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
    values[0], values[1], values[2] = total, largest, smallest
    values[3] = (largest - smallest) / mean if mean > 0.0 else 0.0
    values[4] = largest / entry.breaking_load


@implement(watch_motions, RopeGroups)
@kernel(internal=True)
def watch_rope_groups(kind: RopeGroups, bodies: Bodies, work: Workspace) -> None:
    """Extremes at the ends of steps; steps at whose end a rope carries nothing are slack."""
    for i in range(kind.table.shape[0]):
        _look(kind, i)
        if kind.values[2] <= 0.0:
            kind.state[i].slack_time += work.control.last_step
        for k in range(VALUES):
            note_value(kind.extremes[VALUES * i + k], work.control.interval, kind.values[k])


@implement(record_forces, RopeGroups)
@kernel(internal=True)
def record_rope_groups(kind: RopeGroups, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """What is seen, then the largest and smallest values of all of it, and the time of slack ropes."""
    interval = work.control.interval
    for i in range(kind.table.shape[0]):
        column = kind.table[i].column
        _look(kind, i)
        for k in range(VALUES):
            value, extremes = kind.values[k], kind.extremes[VALUES * i + k]
            row[column + k] = value
            row[column + VALUES + k] = largest_of(extremes, interval, value)
            row[column + 2 * VALUES + k] = smallest_of(extremes, interval, value)
        row[column + 3 * VALUES] = kind.state[i].slack_time
