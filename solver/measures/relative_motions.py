"""Motion of a point of one body in the axes of another one: clearances, tilts, how fast they change.

With the axes a_i of body a and b_i of body b as they are in the world, their angular velocities w_a and w_b, and r from
the point on a to the point on b::

    position_i = a_i . r        velocity_i = a_i . (r' - w_a x r)        R_ij = a_i . b_j

so the velocity is the rate of the position, as one who stands on a sees it. R is taken apart as b is turned out of the
axes of a: by the yaw about z, then by the pitch about the new y, then by the roll about the new x::

    yaw = atan2(R_21, R_11)   pitch = atan2(-R_31, sqrt(R_11^2 + R_21^2))   roll = atan2(R_32, R_33)

The angle of the whole rotation has the sine ``|(R_32 - R_23, R_13 - R_31, R_21 - R_12)| / 2`` and the cosine
``(R_11 + R_22 + R_33 - 1) / 2``; the tilt is the angle of both z axes (J. Wittenburg, Dynamics of Multibody Systems,
2008, chapter 2). The angular velocity is ``a_i . (w_b - w_a)``, with ``w = sum e_i x e_i' / 2`` of the axes of a body.

It acts on nothing. Markers are filled once more at the end of every step, for the extremes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, Records, records
from heavylift.numerics.vectors import Vector, add_scaled, cross, dot, scaled, subtract, vector
from heavylift.solver.extremes import Extremes, largest_of, note_value, smallest_of
from heavylift.solver.interface import (
    RECORD,
    Bodies,
    Workspace,
    add_forces,
    fill_markers,
    record_forces,
    watch_motions,
)
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.scene.connections import MEASURES, Between, PackedForce
from heavylift.solver.scene.descriptions import XYZ, ChannelKind, interval_extremes

__all__ = ["RelativeMotion", "RelativeMotions", "pack"]

SEEN = (
    ChannelKind("position", "length", "from the point of a to that of b, axes of a", XYZ),
    ChannelKind("velocity", "velocity", "rate of that position, as seen from a", XYZ),
    ChannelKind("distance", "length", "distance of the two points"),
    ChannelKind(
        "rotation",
        "angle",
        "angles that turn the axes of a to those of b: yaw about z first, then pitch about y, then roll about x; "
        "within 180 deg, the pitch within 90 deg",
        ("roll", "pitch", "yaw"),
    ),
    ChannelKind("angle", "angle", "angle of the whole rotation of b against a, 0 to 180 deg"),
    ChannelKind("tilt", "angle", "angle of the z axes of a and b, 0 to 180 deg"),
    ChannelKind("angular_velocity", "angular velocity", "of b against a, axes of a", XYZ),
    ChannelKind("radius", "length", "distance of the point of b from the z axis of a through its point"),
)
"""What is seen of a motion, in the order of its columns."""

VALUES = 16
"""Numbers of it."""
LARGEST, SMALLEST = zip(
    *(interval_extremes(seen.name, seen.quantity, components=seen.components) for seen in SEEN), strict=True
)
"""Channels of extremes over all steps, in the same order."""


@MEASURES.describe("relative_motions")
@dataclass(frozen=True, eq=False, kw_only=True)
class RelativeMotion(Between, PackedForce):
    """Motion of the point of side b in the axes of side a, and the rotation of b against a.

    The axes are those of the geometries of the bodies, on the ground those of the world. A flexible body has those of
    its frame, a shell those with which it has turned at the point.
    """

    CHANNELS: ClassVar = (*SEEN, *LARGEST, *SMALLEST)
    """What it records, in the order of its columns."""


class RelativeMotionEntry(Record):
    """Markers of both points, the first of three axes each, first record column."""

    a: int
    b: int
    axes_a: int
    axes_b: int
    column: int


class RelativeMotions(Arrays):
    """All relative motions of a scene.

    Attributes
    ----------
    table
        The motions.
    extremes
        Of the `VALUES` of each, one after the other.
    values
        What is seen of one of them, in the order of its columns; scratch, shape (VALUES,).
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("extremes",)

    table: Records[RelativeMotionEntry]
    extremes: Records[Extremes]
    values: Floats1


def pack(motions: Sequence[RelativeMotion], columns: Sequence[int], book: MarkerBook) -> RelativeMotions:
    """Make the kind."""
    rows = []
    for motion, column in zip(motions, columns, strict=True):
        sides = ((motion.body_a, motion.point_a), (motion.body_b, motion.point_b))
        points = [book.point(body, point, RECORD) for body, point in sides]
        axes = [[book.direction(body, axis, RECORD, at=point) for axis in np.eye(3)] for body, point in sides]
        rows.append((*points, axes[0][0], axes[1][0], column))
    extremes = records(Extremes, VALUES * len(rows))
    return RelativeMotions(records(RelativeMotionEntry, rows), extremes, np.zeros(VALUES))


@implement(add_forces, RelativeMotions)
@kernel(internal=True)
def add_no_forces(kind: RelativeMotions, time: float, work: Workspace) -> None:
    """It only watches."""


@kernel(inline=True, internal=True)
def _unit(work: Workspace, marker: int) -> Vector:
    """An axis: on a shell, which strains, its length is not quite 1."""
    axis = vector(work.markers[marker].point)
    return scaled(1.0 / math.sqrt(dot(axis, axis)), axis)


@kernel(internal=True)
def _spin(work: Workspace, axes: int) -> Vector:
    """Angular velocity of three axes [rad/s], world axes."""
    spin = (0.0, 0.0, 0.0)
    for k in range(3):
        axis = work.markers[axes + k]
        spin = add_scaled(spin, 0.5, cross(axis.point, axis.velocity))
    return spin


@kernel(internal=True)
def _look(kind: RelativeMotions, i: int, work: Workspace) -> None:
    """Position, velocity, distance, rotation, angles, angular velocity, radius from the markers."""
    entry, values = kind.table[i], kind.values
    a, b = work.markers[entry.a], work.markers[entry.b]
    r, rate = subtract(b.point, a.point), subtract(b.velocity, a.velocity)
    spin = _spin(work, entry.axes_a)
    seen = subtract(rate, cross(spin, r))
    turning = subtract(_spin(work, entry.axes_b), spin)
    b1, b2, b3 = _unit(work, entry.axes_b), _unit(work, entry.axes_b + 1), _unit(work, entry.axes_b + 2)
    for k in range(3):
        axis = _unit(work, entry.axes_a + k)
        values[k] = dot(axis, r)
        values[3 + k] = dot(axis, seen)
        values[12 + k] = dot(axis, turning)
    a1, a2, a3 = _unit(work, entry.axes_a), _unit(work, entry.axes_a + 1), _unit(work, entry.axes_a + 2)
    values[6] = math.sqrt(dot(r, r))
    values[15] = math.hypot(values[0], values[1])
    values[7] = math.atan2(dot(a3, b2), dot(a3, b3))
    values[8] = math.atan2(-dot(a3, b1), math.hypot(dot(a1, b1), dot(a2, b1)))
    values[9] = math.atan2(dot(a2, b1), dot(a1, b1))
    x, y = dot(a3, b2) - dot(a2, b3), dot(a1, b3) - dot(a3, b1)
    z = dot(a2, b1) - dot(a1, b2)
    trace = dot(a1, b1) + dot(a2, b2) + dot(a3, b3)
    values[10] = math.atan2(0.5 * math.sqrt(x * x + y * y + z * z), 0.5 * (trace - 1.0))
    values[11] = math.atan2(math.hypot(dot(a1, b3), dot(a2, b3)), dot(a3, b3))


@implement(watch_motions, RelativeMotions)
@kernel(internal=True)
def watch_relative_motions(kind: RelativeMotions, bodies: Bodies, work: Workspace) -> None:
    """Extremes at the ends of steps."""
    fill_markers(bodies, False, RECORD, work)
    for i in range(kind.table.shape[0]):
        _look(kind, i, work)
        for k in range(VALUES):
            note_value(kind.extremes[VALUES * i + k], work.control.interval, kind.values[k])


@implement(record_forces, RelativeMotions)
@kernel(internal=True)
def record_relative_motions(
    kind: RelativeMotions, time: float, work: Workspace, row: NDArray[np.float64]
) -> None:
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
