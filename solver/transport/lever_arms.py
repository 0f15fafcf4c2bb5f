"""Places of wheels on a body: material points, or points below it that hang on one by an arm.

A body with modes is known at the nodes of its mesh, and the wheels of a transporter stand on the road below it. A place
there is ``p = p_node + R a``: the node moves with the modes, the arm a turns with the frame of the body. The force of a
wheel so has the lever that it has, and acts on the mode shapes of the node.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record
from heavylift.numerics.records import Vector as VectorField
from heavylift.solver.interface import Workspace
from heavylift.solver.joints.row_writing import Vector, add_direction_row, rate, vector
from heavylift.solver.rows.structure import RowArrays

__all__ = ["PlaceData", "add_place_row", "place", "place_rate"]


class PlaceData(Record):
    """A place on a body.

    Attributes
    ----------
    marker
        Of a material point.
    x, y, z
        Markers of the axes of the arm; -1 if the place is the point.
    arm
        From the point to the place, along the axes [m].
    """

    marker: int
    x: int
    y: int
    z: int
    arm: VectorField


@kernel(internal=True)
def _along(a: Vector, arm: NDArray[np.float64], x: Vector, y: Vector, z: Vector) -> Vector:
    """``a + arm[0] x + arm[1] y + arm[2] z``."""
    return (
        a[0] + arm[0] * x[0] + arm[1] * y[0] + arm[2] * z[0],
        a[1] + arm[0] * x[1] + arm[1] * y[1] + arm[2] * z[1],
        a[2] + arm[0] * x[2] + arm[1] * y[2] + arm[2] * z[2],
    )


@kernel(inline=True, internal=True)
def place(work: Workspace, at: PlaceData) -> Vector:
    """Where a place is in the world [m]."""
    if at.x < 0:
        return vector(work, at.marker)
    return _along(vector(work, at.marker), at.arm, vector(work, at.x), vector(work, at.y), vector(work, at.z))


@kernel(inline=True, internal=True)
def place_rate(work: Workspace, at: PlaceData) -> Vector:
    """Velocity of a place [m/s]."""
    if at.x < 0:
        return rate(work, at.marker)
    return _along(rate(work, at.marker), at.arm, rate(work, at.x), rate(work, at.y), rate(work, at.z))


@kernel(internal=True)
def add_place_row(
    system: RowArrays, attachment: int, row: int, work: Workspace, at: PlaceData, c: Vector
) -> None:
    """Add ``c . J`` of a place to one row."""
    add_direction_row(system, attachment, row, work, at.marker, c)
    if at.x < 0:
        return
    a = at.arm
    add_direction_row(system, attachment, row, work, at.x, (a[0] * c[0], a[0] * c[1], a[0] * c[2]))
    add_direction_row(system, attachment, row, work, at.y, (a[1] * c[0], a[1] * c[1], a[1] * c[2]))
    add_direction_row(system, attachment, row, work, at.z, (a[2] * c[0], a[2] * c[1], a[2] * c[2]))
