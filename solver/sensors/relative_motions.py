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
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, Records, filled, records
from heavylift.numerics.vectors import Vector, add_scaled, cross, dot, scaled, subtract, vector
from heavylift.solver.extremes import Extremes
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
from heavylift.solver.recording import outputs_at, zeros_of
from heavylift.solver.scene.connections import MEASURES, Between, PackedForce
from heavylift.solver.scene.descriptions import XYZ
from heavylift.solver.scene.outputs import (
    Components,
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

__all__ = ["RelativeMotion", "RelativeMotions", "pack"]


@outputs
class MotionSeen(Outputs):
    """What is seen of a motion."""

    position: Components = channel("length", "from the point of a to that of b, axes of a", XYZ)
    velocity: Components = channel("velocity", "rate of that position, as seen from a", XYZ)
    distance: float = channel("length", "distance of the two points")
    rotation: Components = channel(
        "angle",
        "angles that turn the axes of a to those of b: yaw about z first, then pitch about y, then roll about x; "
        "within 180 deg, the pitch within 90 deg",
        ("roll", "pitch", "yaw"),
    )
    angle: float = channel("angle", "angle of the whole rotation of b against a, 0 to 180 deg")
    tilt: float = channel("angle", "angle of the z axes of a and b, 0 to 180 deg")
    angular_velocity: Components = channel("angular velocity", "of b against a, axes of a", XYZ)
    radius: float = channel("length", "distance of the point of b from the z axis of a through its point")


@outputs
class MotionOutputs(Outputs):
    """What a motion records."""

    seen: MotionSeen = nested(MotionSeen)
    largest: MotionSeen = largest_of_all(MotionSeen)
    smallest: MotionSeen = smallest_of_all(MotionSeen)


@MEASURES.describe("relative_motions")
@dataclass(frozen=True, eq=False, kw_only=True)
class RelativeMotion(Between, PackedForce):
    """Motion of the point of side b in the axes of side a, and the rotation of b against a.

    The axes are those of the geometries of the bodies, on the ground those of the world. A flexible body or
    a shell has those with which it has turned at the point.
    """

    CHANNELS: ClassVar = MotionOutputs.CHANNELS
    """What it records, in the order of its columns."""


class RelativeMotionEntry(Record):
    """Markers of both points, the first of three axes each, first record column."""

    a: int
    b: int
    axes_a: int
    axes_b: int
    column: int


motion_outputs = outputs_at(MotionOutputs)


class RelativeMotions(Arrays):
    """All relative motions of a scene.

    Attributes
    ----------
    table
        The motions.
    extremes
        Of what is seen of each.
    seen
        Of one of them; scratch.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("extremes",)

    table: Records[RelativeMotionEntry]
    extremes: Records[Extremes]
    seen: MotionSeen


def pack(motions: Sequence[RelativeMotion], context: PackingContext) -> None:
    """Make the kind."""
    rows = []
    for motion in motions:
        sides = ((motion.body_a, motion.point_a), (motion.body_b, motion.point_b))
        points = [context.point(body, point, RECORD) for body, point in sides]
        axes = [
            [context.direction(body, axis, RECORD, at=point) for axis in np.eye(3)] for body, point in sides
        ]
        rows.append(
            filled(
                RelativeMotionEntry,
                a=points[0],
                b=points[1],
                axes_a=axes[0][0],
                axes_b=axes[1][0],
                column=context.column(motion),
            )
        )
    extremes = extremes_of(MotionSeen, len(rows))
    context.add_forces(RelativeMotions(records(RelativeMotionEntry, rows), extremes, zeros_of(MotionSeen)))


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
    entry, out = kind.table[i], kind.seen
    a, b = work.markers[entry.a], work.markers[entry.b]
    r, rate = subtract(b.point, a.point), subtract(b.velocity, a.velocity)
    spin = _spin(work, entry.axes_a)
    seen = subtract(rate, cross(spin, r))
    turning = subtract(_spin(work, entry.axes_b), spin)
    b1, b2, b3 = _unit(work, entry.axes_b), _unit(work, entry.axes_b + 1), _unit(work, entry.axes_b + 2)
    for k in range(3):
        axis = _unit(work, entry.axes_a + k)
        out.position[k] = dot(axis, r)
        out.velocity[k] = dot(axis, seen)
        out.angular_velocity[k] = dot(axis, turning)
    a1, a2, a3 = _unit(work, entry.axes_a), _unit(work, entry.axes_a + 1), _unit(work, entry.axes_a + 2)
    out.distance = math.sqrt(dot(r, r))
    out.radius = math.hypot(out.position[0], out.position[1])
    roll, yaw = math.atan2(dot(a3, b2), dot(a3, b3)), math.atan2(dot(a2, b1), dot(a1, b1))
    pitch = math.atan2(-dot(a3, b1), math.hypot(dot(a1, b1), dot(a2, b1)))
    out.rotation[0], out.rotation[1], out.rotation[2] = roll, pitch, yaw
    x, y = dot(a3, b2) - dot(a2, b3), dot(a1, b3) - dot(a3, b1)
    z = dot(a2, b1) - dot(a1, b2)
    trace = dot(a1, b1) + dot(a2, b2) + dot(a3, b3)
    out.angle = math.atan2(0.5 * math.sqrt(x * x + y * y + z * z), 0.5 * (trace - 1.0))
    out.tilt = math.atan2(math.hypot(dot(a1, b3), dot(a2, b3)), dot(a3, b3))


@implement(watch_motions, RelativeMotions)
@kernel(internal=True)
def watch_relative_motions(kind: RelativeMotions, bodies: Bodies, work: Workspace) -> None:
    """Extremes at the ends of steps."""
    fill_markers(bodies, False, RECORD, work)
    for i in range(kind.table.shape[0]):
        _look(kind, i, work)
        note_seen(kind.extremes, i, work.control.interval, kind.seen.words)


@implement(record_forces, RelativeMotions)
@kernel(internal=True)
def record_relative_motions(
    kind: RelativeMotions, time: float, work: Workspace, row: NDArray[np.float64]
) -> None:
    """What is seen, then the largest and smallest values of all of it."""
    interval = work.control.interval
    for i in range(kind.table.shape[0]):
        out = motion_outputs(row, kind.table[i].column)
        _look(kind, i, work)
        put_seen(
            kind.extremes, i, interval, kind.seen.words, out.seen.words, out.largest.words, out.smallest.words
        )
