"""Forces of ropes on lugs: in the plane of the eye, across it, and the angle to that plane.

With the force F of the rope on the lug and the normal n of its plate, along the pin::

    force = |F|     out_of_plane = F . n     in_plane = sqrt(F^2 - (F . n)^2)     angle = atan2(F . n, in_plane)

A rope that carries nothing has no direction that matters: its angle is 0.

It acts on nothing. The ropes leave their forces at the end of every step
(`heavylift.solver.force_elements.line_forces`), where normals are markers as those of forces.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import BodyDirection, NameOf
from heavylift.numerics.records import Record, Records, filled, records
from heavylift.numerics.vectors import dot, vector
from heavylift.solver.extremes import Extremes
from heavylift.solver.force_elements.line_forces import LineForce
from heavylift.solver.force_elements.watched import WatchedRopes, WatchesRopes
from heavylift.solver.interface import (
    FORCES,
    Bodies,
    Workspace,
    add_forces,
    record_forces,
    watch_motions,
)
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

__all__ = ["Lug", "LugEntry", "Lugs", "pack"]


@outputs
class LugSeen(Outputs):
    """What is seen of a lug."""

    force: float = channel("force", "force of the rope on the lug")
    in_plane: float = channel("force", "its part in the plane of the eye")
    out_of_plane: float = channel("force", "its part across that plane, positive along the normal")
    angle: float = channel("angle", "angle of the rope to the plane of the eye; 0 while it carries nothing")


@outputs
class LugOutputs(Outputs):
    """What a lug records."""

    seen: LugSeen = nested(LugSeen)
    largest: LugSeen = largest_of_all(LugSeen)
    smallest: LugSeen = smallest_of_all(LugSeen)


@MEASURES.describe("lugs")
@dataclass(frozen=True, eq=False, kw_only=True)
class Lug(WatchesRopes):
    """Force of a rope on a lug of a body, in the plane of the eye and across it, and its angle to that plane."""

    CHANNELS: ClassVar = LugOutputs.CHANNELS
    """What it records, in the order of its columns."""

    body: Annotated[str, NameOf("body")]
    """Body with the lug."""
    rope: Annotated[str, NameOf("known rope")]
    """Rope of ``[[ropes]]``, or of a builder, that ends there."""
    normal: Annotated[NDArray[np.float64], BodyDirection()]
    """Normal of the plane of the eye, along its pin, in the coordinates of the geometry of the body; any length."""
    place: Annotated[int | None, Interval(ge=1)] = None
    """Number in the path of the rope, from 1 on, of the place that is the lug; its end on the body if absent."""

    @property
    def watched_ropes(self) -> tuple[str, ...]:
        """The rope."""
        return (self.rope,)


class LugEntry(Record):
    """Number of the pull at its place, marker of its normal, first record column."""

    pull: int
    normal: int
    column: int


lug_outputs = outputs_at(LugOutputs)


class Lugs(Arrays):
    """All lugs of a scene.

    Attributes
    ----------
    table
        The lugs.
    pulls
        What ropes pull with, which they write.
    extremes
        Of what is seen of each.
    seen
        Of one of them; scratch.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("extremes",)

    table: Records[LugEntry]
    pulls: Records[LineForce]
    extremes: Records[Extremes]
    seen: LugSeen


def pack(lugs: Sequence[Lug], context: PackingContext) -> None:
    """Make the kind.

    Raises
    ------
    InputError
        If the rope is not on the body, or is there at several places and none is given.
    """
    rows, watched = [], context.watched
    for lug in lugs:
        place = _place(lug, watched)
        normal = np.asarray(lug.normal, dtype=np.float64)
        point = watched.ropes[lug.rope].path[place].point
        marker = context.direction(lug.body, normal / np.linalg.norm(normal), FORCES, at=np.asarray(point))
        pull = watched.first[lug.rope] + place
        rows.append(filled(LugEntry, pull=pull, normal=marker, column=context.column(lug)))
    extremes = extremes_of(LugSeen, len(rows))
    context.add_forces(Lugs(records(LugEntry, rows), watched.pulls, extremes, zeros_of(LugSeen)))


def _place(lug: Lug, watched: WatchedRopes) -> int:
    """Number of the place of the path, from 0 on."""
    path: Any = watched.ropes[lug.rope].path
    on_body = watched.places_on(lug.rope, lug.body)
    if not on_body:
        raise InputError(
            f"{lug.rope!r} has no place on {lug.body!r}",
            source=lug.name,
            key="rope",
            expected=f"a rope with an end on this body, or body = {path[-1].body!r}",
        )
    spec = ", ".join(str(place + 1) for place in on_body)
    if lug.place is not None:
        if lug.place - 1 not in on_body:
            raise InputError(
                f"place {lug.place} of {lug.rope!r} is not on {lug.body!r}",
                source=lug.name,
                key="place",
                expected=f"one of: {spec}",
            )
        return lug.place - 1
    ends = [place for place in on_body if place in {0, len(path) - 1}]
    chosen = ends if len(ends) == 1 else on_body
    if len(chosen) > 1:
        raise InputError(
            f"{lug.rope!r} is on {lug.body!r} at {len(chosen)} places",
            source=lug.name,
            key="place",
            expected=f"the number of one of them: {spec}",
        )
    return chosen[0]


@implement(add_forces, Lugs)
@kernel(internal=True)
def add_no_forces(kind: Lugs, time: float, work: Workspace) -> None:
    """It only watches."""


@kernel(internal=True)
def _look(kind: Lugs, i: int, work: Workspace) -> None:
    """Force, its parts, angle."""
    entry, seen = kind.table[i], kind.seen
    force = vector(kind.pulls[entry.pull].force)
    square, out = dot(force, force), dot(force, vector(work.markers[entry.normal].point))
    inside = math.sqrt(max(0.0, square - out * out))
    seen.force, seen.in_plane, seen.out_of_plane = math.sqrt(square), inside, out
    seen.angle = math.atan2(out, inside) if square > 0.0 else 0.0


@implement(watch_motions, Lugs)
@kernel(internal=True)
def watch_lugs(kind: Lugs, bodies: Bodies, work: Workspace) -> None:
    """Extremes at the ends of steps."""
    for i in range(kind.table.shape[0]):
        _look(kind, i, work)
        note_seen(kind.extremes, i, work.control.interval, kind.seen.words)


@implement(record_forces, Lugs)
@kernel(internal=True)
def record_lugs(kind: Lugs, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """What is seen, then the largest and smallest values of all of it."""
    interval = work.control.interval
    for i in range(kind.table.shape[0]):
        out = lug_outputs(row, kind.table[i].column)
        _look(kind, i, work)
        put_seen(
            kind.extremes, i, interval, kind.seen.words, out.seen.words, out.largest.words, out.smallest.words
        )
