"""The scalars on which springs, stops, friction and motors act: a distance, the angle or the travel of a joint.

Each is a function of three markers; loads are its derivatives by these, so a load times the rate of the scalar
is exactly the power of the forces on the markers. On a direction marker e a force f acts as the torque e x f.
"""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Record
from heavylift.solver.interface import Workspace
from heavylift.solver.joints.packing import angle_markers, travel_markers
from heavylift.solver.joints.row_writing import (
    Vector,
    angle_row,
    difference,
    dot,
    hinge_angle,
    hinge_rate,
    minus,
    put_direction_row,
    rate,
    travel,
    travel_rate,
    travel_row,
    vector,
)
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.connections import AlongJoint, Between, Joint

__all__ = [
    "ANGLE",
    "DISTANCE",
    "TRAVEL",
    "CoordinateEntry",
    "add_load",
    "coordinate_rate",
    "coordinate_row",
    "coordinate_value",
    "joint_coordinate",
    "joint_markers",
    "spring_markers",
]

DISTANCE, ANGLE, TRAVEL = range(3)
"""Distance of two points (the third marker is not used), angle of a hinge, travel of a slider."""


class CoordinateEntry(Record):
    """What everything that acts on such a scalar keeps.

    Attributes
    ----------
    coordinate
        `DISTANCE`, `ANGLE` or `TRAVEL`.
    a, b, c
        Its markers.
    column
        First record column, or -1.
    """

    coordinate: int
    a: int
    b: int
    c: int
    column: int


def joint_coordinate(joint: Joint, user: AlongJoint | Joint) -> int:
    """`ANGLE` or `TRAVEL`: what a spring or a motor acts on.

    Raises
    ------
    InputError
        If the joint has neither, or both and none is given, or not the given one.
    """
    spec = getattr(user, "coordinate", None)
    both = {"angle", "travel"} <= {channel.name for channel in joint.CHANNELS}
    found = spec if both and not joint.COORDINATE else joint.COORDINATE
    if found and spec in {None, found}:
        return ANGLE if found == "angle" else TRAVEL
    kind = type(joint).__name__
    if found:
        raise InputError(
            f"{spec!r} of joint {joint.name!r}, a {kind}, whose {found} counts",
            source=user.name,
            key="coordinate",
            expected=f"{found!r}, or none",
        )
    raise InputError(
        f"joint {joint.name!r} is a {kind}, which has {'both' if both else 'no single angle or travel'}",
        source=user.name,
        key="coordinate" if both else "joint",
        expected="'angle' or 'travel'" if both else "a hinge or a slider",
    )


def joint_markers(book: MarkerBook, joint: Joint, coordinate: int, level: int) -> tuple[int, int, int]:
    """Markers of the angle or travel of a joint."""
    if coordinate == ANGLE:
        angle = angle_markers(book, joint, level)
        return angle.x_a, angle.x_b, angle.y_b
    travel = travel_markers(book, joint, level)
    return travel.point_a, travel.point_b, travel.axis


def spring_markers(book: MarkerBook, spring: Between, level: int) -> tuple[int, int, int]:
    """Markers of the two ends of a spring."""
    a = book.point(spring.body_a, spring.point_a, level)
    return a, book.point(spring.body_b, spring.point_b, level), a


@kernel(inline=True, internal=True)
def _line(work: Workspace, a: int, b: int) -> tuple[float, Vector]:
    """Distance [m] and unit direction from a to b; no direction where they coincide."""
    r = difference(work, a, b)
    size = math.sqrt(dot(r, r))
    inverse = 1.0 / size if size > 0.0 else 0.0
    return size, (inverse * r[0], inverse * r[1], inverse * r[2])


@kernel(internal=True)
def coordinate_value(work: Workspace, coordinate: int, a: int, b: int, c: int) -> float:
    """The scalar [m] or [rad]; angles in (-pi, pi]."""
    if coordinate == DISTANCE:
        return _line(work, a, b)[0]
    if coordinate == ANGLE:
        return hinge_angle(work, a, b, c)
    return travel(work, a, b, c)


@kernel(internal=True)
def coordinate_rate(work: Workspace, coordinate: int, a: int, b: int, c: int) -> float:
    """Its rate from the rates of the markers."""
    if coordinate == DISTANCE:
        return dot(_line(work, a, b)[1], minus(rate(work, b), rate(work, a)))
    if coordinate == ANGLE:
        return hinge_rate(work, a, b, c)
    return travel_rate(work, a, b, c)


@kernel(internal=True)
def coordinate_row(
    system: RowArrays, block: int, work: Workspace, coordinate: int, a: int, b: int, c: int
) -> float:
    """Write its derivative as the first row of a block; the scalar."""
    if coordinate == DISTANCE:
        size, e = _line(work, a, b)
        put_direction_row(system, 2 * block, 0, work, a, (-e[0], -e[1], -e[2]))
        put_direction_row(system, 2 * block + 1, 0, work, b, e)
        return size
    if coordinate == ANGLE:
        return angle_row(system, block, 0, work, a, b, c)
    return travel_row(system, block, 0, work, a, b, c)


@kernel(inline=True, internal=True)
def _add_force(work: Workspace, marker: int, s: float, v: Vector) -> None:
    for k in range(3):
        work.markers[marker].force[k] += s * v[k]


@kernel(internal=True)
def add_load(work: Workspace, coordinate: int, a: int, b: int, c: int, load: float) -> None:
    """Forces on the markers whose power is the load times the rate: positive loads drive the scalar up."""
    if coordinate == DISTANCE:
        e = _line(work, a, b)[1]
        _add_force(work, a, -load, e)
        _add_force(work, b, load, e)
    elif coordinate == ANGLE:  # as in `angle_row`
        x, x2, y2 = vector(work, a), vector(work, b), vector(work, c)
        s, q = -dot(y2, x), dot(x2, x)
        scale = -load / (s * s + q * q)
        _add_force(work, a, scale * q, y2)
        _add_force(work, a, scale * s, x2)
        _add_force(work, c, scale * q, x)
        _add_force(work, b, scale * s, x)
    else:
        e = vector(work, c)
        _add_force(work, a, -load, e)
        _add_force(work, b, load, e)
        _add_force(work, c, load, difference(work, a, b))
