"""Forces of ropes on lugs: in the plane of the eye, across it, and the angle to that plane.

With the force F of the rope on the lug and the normal n of its plate, along the pin::

    force = |F|     out_of_plane = F . n     in_plane = sqrt(F^2 - (F . n)^2)     angle = atan2(F . n, in_plane)

A rope that carries nothing has no direction that matters: its angle is 0.

It acts on nothing. The ropes leave their forces at the end of every step (`heavylift.solver.laws.pulls`), where normals
are markers as those of forces.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import BodyDirection, NameOf
from heavylift.numerics.records import Record, Records, records
from heavylift.numerics.vectors import dot, vector
from heavylift.solver.extremes import Extremes, largest_of, note_value, smallest_of
from heavylift.solver.interface import (
    FORCES,
    Bodies,
    Workspace,
    add_forces,
    record_forces,
    watch_motions,
)
from heavylift.solver.kinds import implement
from heavylift.solver.laws.pulls import RopePull
from heavylift.solver.laws.watched import WatchedRopes, WatchesRopes
from heavylift.solver.markers import MarkerBook
from heavylift.solver.scene.connections import MEASURES
from heavylift.solver.scene.descriptions import ChannelKind, interval_extremes

__all__ = ["Lug", "LugEntry", "Lugs", "pack"]

SEEN = (
    ChannelKind("force", "force", "force of the rope on the lug"),
    ChannelKind("in_plane", "force", "its part in the plane of the eye"),
    ChannelKind("out_of_plane", "force", "its part across that plane, positive along the normal"),
    ChannelKind("angle", "angle", "angle of the rope to the plane of the eye; 0 while it carries nothing"),
)
"""What is seen of a lug, in the order of its columns."""

VALUES = 4
"""Numbers of it."""
LARGEST, SMALLEST = zip(*(interval_extremes(seen.name, seen.quantity) for seen in SEEN), strict=True)
"""Channels of extremes over all steps, in the same order."""


@MEASURES.describe("lugs")
@dataclass(frozen=True, eq=False, kw_only=True)
class Lug(WatchesRopes):
    """Force of a rope on a lug of a body, in the plane of the eye and across it, and its angle to that plane."""

    CHANNELS: ClassVar = (*SEEN, *LARGEST, *SMALLEST)
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


class Lugs(Arrays):
    """All lugs of a scene.

    Attributes
    ----------
    table
        The lugs.
    pulls
        What ropes pull with, which they write.
    extremes
        Of the `VALUES` of each, one after the other.
    values
        What is seen of one of them, in the order of its columns; scratch, shape (VALUES,).
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("extremes",)

    table: Records[LugEntry]
    pulls: Records[RopePull]
    extremes: Records[Extremes]
    values: Floats1


def pack(lugs: Sequence[Lug], columns: Sequence[int], book: MarkerBook, watched: WatchedRopes) -> Lugs:
    """Make the kind.

    Raises
    ------
    InputError
        If the rope is not on the body, or is there at several places and none is said.
    """
    rows = []
    for lug, column in zip(lugs, columns, strict=True):
        place = _place(lug, watched)
        normal = np.asarray(lug.normal, dtype=np.float64)
        point = watched.ropes[lug.rope].path[place].point
        marker = book.direction(lug.body, normal / np.linalg.norm(normal), FORCES, at=np.asarray(point))
        rows.append((watched.first[lug.rope] + place, marker, column))
    extremes = records(Extremes, VALUES * len(rows))
    return Lugs(records(LugEntry, rows), watched.pulls, extremes, np.zeros(VALUES))


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
    said = ", ".join(str(place + 1) for place in on_body)
    if lug.place is not None:
        if lug.place - 1 not in on_body:
            raise InputError(
                f"place {lug.place} of {lug.rope!r} is not on {lug.body!r}",
                source=lug.name,
                key="place",
                expected=f"one of: {said}",
            )
        return lug.place - 1
    ends = [place for place in on_body if place in {0, len(path) - 1}]
    chosen = ends if len(ends) == 1 else on_body
    if len(chosen) > 1:
        raise InputError(
            f"{lug.rope!r} is on {lug.body!r} at {len(chosen)} places",
            source=lug.name,
            key="place",
            expected=f"the number of one of them: {said}",
        )
    return chosen[0]


@implement(add_forces, Lugs)
@kernel(internal=True)
def add_no_forces(kind: Lugs, time: float, work: Workspace) -> None:
    """It only watches."""


@kernel(internal=True)
def _look(kind: Lugs, i: int, work: Workspace) -> None:
    """Force, its parts, angle."""
    entry, values = kind.table[i], kind.values
    force = vector(kind.pulls[entry.pull].force)
    square, out = dot(force, force), dot(force, vector(work.markers[entry.normal].point))
    inside = math.sqrt(max(0.0, square - out * out))
    values[0], values[1], values[2] = math.sqrt(square), inside, out
    values[3] = math.atan2(out, inside) if square > 0.0 else 0.0


@implement(watch_motions, Lugs)
@kernel(internal=True)
def watch_lugs(kind: Lugs, bodies: Bodies, work: Workspace) -> None:
    """Extremes at the ends of steps."""
    for i in range(kind.table.shape[0]):
        _look(kind, i, work)
        for k in range(VALUES):
            note_value(kind.extremes[VALUES * i + k], work.control.interval, kind.values[k])


@implement(record_forces, Lugs)
@kernel(internal=True)
def record_lugs(kind: Lugs, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """What is seen, then the largest and smallest values of all of it."""
    interval = work.control.interval
    for i in range(kind.table.shape[0]):
        column = kind.table[i].column
        _look(kind, i, work)
        for k in range(VALUES):
            value, extremes = kind.values[k], kind.extremes[VALUES * i + k]
            row[column + k] = value
            row[column + VALUES + k] = largest_of(extremes, interval, value)
            row[column + 2 * VALUES + k] = smallest_of(extremes, interval, value)
