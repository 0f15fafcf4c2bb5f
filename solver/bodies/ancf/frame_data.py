"""What the kernels of frames find in `constants`, and their arithmetic on 3-vectors and 3x3 matrices.

An element is a cubic ``r(xi) = S1 r_1 + S2 r'_1 + S3 r_2 + S4 r'_2``. Because ``S1 + S3 = 1`` its derivatives need
three numbers only: ``r' = a (r_2 - r_1) + b r'_1 + c r'_2``, and ``r''`` likewise with ``(A, B, C)``, both by the arc
length of the reference shape. The stiffness is a sum over points of products of two of these six numbers times 3x3
matrices; the products, weighed, are stored.
"""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, record_at
from heavylift.numerics.records import Vector as VectorField
from heavylift.numerics.small import nonnegative
from heavylift.numerics.vectors import Vector, add_scaled, scaled, subtract, vector_at
from heavylift.solver.bodies.ancf.kind import Meshes

__all__ = [
    "AXIAL_POINTS",
    "BENDING_POINTS",
    "STRESS_PLACES",
    "AxialPoint",
    "BendingPoint",
    "FrameData",
    "FrameElement",
    "FrameFollower",
    "Symmetric",
    "add_full",
    "add_symmetric",
    "axial_point",
    "bending_point",
    "combine",
    "frame_data",
    "frame_follower",
    "full",
    "load_element",
    "put_forces",
    "put_stiffness",
    "spread",
    "transpose",
]

# models, first number of `body_constants`
GREEN_LAGRANGE, EXACT = range(2)

AXIAL_POINTS = 5
"""Gauss points of the axial strain: exact for Green-Lagrange, whose force has degree 8."""

BENDING_POINTS = 3
"""Gauss points of the curvature: its error is two orders smaller than that of the cubic."""


STRESS_PLACES = 13
"""Places along an element, ends and centre included, at which the largest stress is looked for. Pictures draw some of
these and no others, so that none shows more than is recorded."""


class FrameData(Record):
    """Data of an element; its axial points follow, then the bending points of the exact model.

    Attributes
    ----------
    mass, bending
        Scalar matrices of the four nodal vectors.
    axial_stiffness, bending_stiffness, area
        ``E A``, ``E I`` and A of the section.
    stress
        Of the outer fibre, of a unit moment.
    height
        Length by which a curvature is compared with a strain.
    curved
        Whether the reference is, of the exact model.
    initial_strain
        Of the reference shape.
    first, second
        (a, b, c) and (A, B, C) at the places of stress.
    curvature
        Of the reference at these places.
    """

    mass: Annotated[NDArray[np.float64], (4, 4)]
    bending: Annotated[NDArray[np.float64], (4, 4)]
    axial_stiffness: float
    bending_stiffness: float
    area: float
    stress: float
    height: float
    curved: bool
    initial_strain: float
    first: Annotated[NDArray[np.float64], (STRESS_PLACES, 3)]
    second: Annotated[NDArray[np.float64], (STRESS_PLACES, 3)]
    curvature: Annotated[NDArray[np.float64], (STRESS_PLACES,)]


class AxialPoint(Record):
    """Gauss point of the axial strain.

    Attributes
    ----------
    stiffness
        ``E A ds``.
    first
        (a, b, c).
    products
        ``E A ds`` times aa, ab, ac, bb, bc, cc.
    loads
        ds times S1 to S4.
    """

    stiffness: float
    first: VectorField
    products: Annotated[NDArray[np.float64], (6,)]
    loads: Annotated[NDArray[np.float64], (4,)]


class BendingPoint(Record):
    """Gauss point of the curvature.

    Attributes
    ----------
    stiffness
        ``E I ds``.
    first, second
        (a, b, c) and (A, B, C).
    curvature
        Of the reference.
    products
        ``E I ds`` times aa, ab, ac, bb, bc, cc; AA, AB, AC, BB, BC, CC; aA, aB, aC, bB, bC, cC; Ab, Ac, Bc.
    """

    stiffness: float
    first: VectorField
    second: VectorField
    curvature: float
    products: Annotated[NDArray[np.float64], (21,)]


class FrameFollower(Record):
    """Data of a follower load: normal and tangential part [N, N/m of the reference], axis in axes of the body."""

    normal: float
    tangential: float
    axis: VectorField


WORD = 8
AXIAL_LENGTH, BENDING_LENGTH = AxialPoint.layout.itemsize // WORD, BendingPoint.layout.itemsize // WORD
AXIAL = FrameData.layout.itemsize // WORD
"""Place of the axial points in the data of an element."""
BENDING = AXIAL + AXIAL_POINTS * AXIAL_LENGTH
"""Place of the bending points."""
EXACT_LENGTH = BENDING + BENDING_POINTS * BENDING_LENGTH

frame_data, frame_follower = record_at(FrameData), record_at(FrameFollower)
_axial_point, _bending_point = record_at(AxialPoint), record_at(BendingPoint)

LANES = 8
"""Places of a node in a nodal vector, and of a column of a block."""

Symmetric = tuple[float, float, float, float, float, float]
"""Of a 3x3 matrix: xx, yy, zz, xy, xz, yz."""
Full = tuple[float, float, float, float, float, float, float, float, float]
"""A 3x3 matrix by rows."""
FrameElement = tuple[Vector, Vector, Vector]
"""``r_2 - r_1``, ``r'_1``, ``r'_2``, or the rates of these."""


@kernel(inline=True, internal=True)
def axial_point(constants: NDArray[np.float64], data: int, number: int) -> AxialPoint:
    """A point of the element whose data begin at a place."""
    return _axial_point(constants, data + AXIAL + number * AXIAL_LENGTH)


@kernel(inline=True, internal=True)
def bending_point(constants: NDArray[np.float64], data: int, number: int) -> BendingPoint:
    """A point of the element whose data begin at a place."""
    return _bending_point(constants, data + BENDING + number * BENDING_LENGTH)


@kernel(inline=True, internal=True)
def load_element(kind: Meshes, e: int, nodal: Floats1) -> FrameElement:
    """What the derivatives along an element need of a nodal vector."""
    i, j = nonnegative(kind.elements[e].nodes[0]), nonnegative(kind.elements[e].nodes[1])
    return (
        subtract(vector_at(nodal, j), vector_at(nodal, i)),
        vector_at(nodal, i + 3),
        vector_at(nodal, j + 3),
    )


@kernel(inline=True, internal=True)
def combine(numbers: Any, x: FrameElement) -> Vector:
    """``A (r_2 - r_1) + B r'_1 + C r'_2`` with three numbers."""
    return add_scaled(add_scaled(scaled(numbers[0], x[0]), numbers[1], x[1]), numbers[2], x[2])


@kernel(inline=True, internal=True)
def spread(total: FrameElement, f: float, numbers: Any, v: Vector) -> FrameElement:
    """``total + f (A v, B v, C v)``: what a vector that `combine` would be multiplied with does on the element."""
    return (
        add_scaled(total[0], f * numbers[0], v),
        add_scaled(total[1], f * numbers[1], v),
        add_scaled(total[2], f * numbers[2], v),
    )


@kernel(inline=True, internal=True)
def add_symmetric(total: Symmetric, f: float, m: Symmetric) -> Symmetric:
    """``total + f m``."""
    return (
        total[0] + f * m[0],
        total[1] + f * m[1],
        total[2] + f * m[2],
        total[3] + f * m[3],
        total[4] + f * m[4],
        total[5] + f * m[5],
    )


@kernel(inline=True, internal=True)
def add_full(total: Full, f: float, m: Full) -> Full:
    """``total + f m``."""
    return (
        total[0] + f * m[0],
        total[1] + f * m[1],
        total[2] + f * m[2],
        total[3] + f * m[3],
        total[4] + f * m[4],
        total[5] + f * m[5],
        total[6] + f * m[6],
        total[7] + f * m[7],
        total[8] + f * m[8],
    )


@kernel(inline=True, internal=True)
def full(m: Symmetric) -> Full:
    """All nine entries of a symmetric matrix."""
    return m[0], m[3], m[4], m[3], m[1], m[5], m[4], m[5], m[2]


@kernel(inline=True, internal=True)
def transpose(m: Full) -> Full:
    """Rows for columns."""
    return m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]


@kernel(inline=True, internal=True)
def put_forces(kind: Meshes, e: int, nodal: Floats1, forces: FrameElement) -> None:
    """Add the forces on ``r_2 - r_1``, ``r'_1`` and ``r'_2`` to a nodal vector."""
    fa, fb, fc = forces
    i, j = nonnegative(kind.elements[e].nodes[0]), nonnegative(kind.elements[e].nodes[1])
    for k in range(3):
        nodal[i + k] -= fa[k]
        nodal[i + 3 + k] += fb[k]
        nodal[j + k] += fa[k]
        nodal[j + 3 + k] += fc[k]


@kernel(inline=True, internal=True)
def _put_matrix(blocks: Any, at: int, f: float, m: Full) -> None:
    """Add ``f m``: columns of the matrix lie along the lanes."""
    for column in range(3):
        for row in range(3):
            blocks[at + column * LANES + row] += f * m[3 * row + column]


@kernel(inline=True, internal=True)
def put_stiffness(
    kind: Meshes, e: int, aa: Symmetric, ab: Full, ac: Full, bb: Symmetric, bc: Full, cc: Symmetric
) -> None:
    """Add the stiffness against ``r_2 - r_1``, ``r'_1`` and ``r'_2`` to the blocks of the pairs of nodes."""
    blocks, of_pairs = kind.blocks, kind.elements[e].blocks
    at = of_pairs[0, 0]
    slopes = 3 * LANES  # the part of a block that belongs to the slope of its column node
    _put_matrix(blocks, at, 1.0, full(aa))
    _put_matrix(blocks, at + 3, -1.0, transpose(ab))
    _put_matrix(blocks, at + slopes, -1.0, ab)
    _put_matrix(blocks, at + slopes + 3, 1.0, full(bb))
    at = of_pairs[1, 0]
    if of_pairs[1, 1] == 0:
        _put_matrix(blocks, at, -1.0, full(aa))
        _put_matrix(blocks, at + 3, -1.0, transpose(ac))
        _put_matrix(blocks, at + slopes, 1.0, ab)
        _put_matrix(blocks, at + slopes + 3, 1.0, transpose(bc))
    else:
        _put_matrix(blocks, at, -1.0, full(aa))
        _put_matrix(blocks, at + 3, 1.0, transpose(ab))
        _put_matrix(blocks, at + slopes, -1.0, ac)
        _put_matrix(blocks, at + slopes + 3, 1.0, bc)
    at = of_pairs[2, 0]
    _put_matrix(blocks, at, 1.0, full(aa))
    _put_matrix(blocks, at + 3, 1.0, transpose(ac))
    _put_matrix(blocks, at + slopes, 1.0, ac)
    _put_matrix(blocks, at + slopes + 3, 1.0, full(cc))
