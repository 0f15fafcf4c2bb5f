"""Frames with the axial strain of Green-Lagrange, ``e = (r'.r' - 1) / 2``: kernels over the elements of a body.

"Integrated simulation ... (2018)", equation 88. Bending, ``E I / 2`` times the integral of ``r''.r''``, is a constant
matrix and none of their business.
"""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import dot
from heavylift.solver.bodies.ancf.frame_data import (
    AXIAL_POINTS,
    add_symmetric,
    axial_point,
    combine,
    frame_data,
    full,
    load_element,
    put_forces,
    put_stiffness,
    spread,
)
from heavylift.solver.bodies.ancf.kind import FrameMeshes

__all__ = [
    "add_green_lagrange_forces",
    "add_green_lagrange_rates",
    "add_green_lagrange_stiffness",
    "find_green_lagrange_strains",
]


@kernel(internal=True)
def find_green_lagrange_strains(kind: FrameMeshes, body: int, q: Floats1, strain: Floats1) -> None:
    """``e = (r'.r' - 1) / 2 + e_0``."""
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data, place = kind.elements[e].data, kind.elements[e].strain
        x = load_element(kind, e, q)
        rest = frame_data(kind.constants, data).initial_strain - 0.5
        for g in range(AXIAL_POINTS):
            d = combine(axial_point(kind.constants, data, g).first, x)
            strain[place + g] = 0.5 * dot(d, d) + rest


@kernel(internal=True)
def add_green_lagrange_rates(
    kind: FrameMeshes, body: int, q: Floats1, v: Floats1, strain: Floats1, factor: float
) -> None:
    """``r'.v'``."""
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data, place = kind.elements[e].data, kind.elements[e].strain
        x, rate = load_element(kind, e, q), load_element(kind, e, v)
        for g in range(AXIAL_POINTS):
            point = axial_point(kind.constants, data, g)
            d, change = combine(point.first, x), combine(point.first, rate)
            strain[place + g] += factor * dot(d, change)


@kernel(internal=True)
def add_green_lagrange_forces(
    kind: FrameMeshes, body: int, q: Floats1, strain: Floats1, force: Floats1, factor: float
) -> None:
    """``E A int e r' S'_a ds``."""
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data, place = kind.elements[e].data, kind.elements[e].strain
        x = load_element(kind, e, q)
        forces = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        for g in range(AXIAL_POINTS):
            point = axial_point(kind.constants, data, g)
            d = combine(point.first, x)
            stress = factor * point.stiffness * strain[place + g]
            forces = spread(forces, stress, point.first, d)
        put_forces(kind, e, force, forces)


@kernel(internal=True)
def add_green_lagrange_stiffness(
    kind: FrameMeshes,
    body: int,
    q: Floats1,
    strain: Floats1,
    force: Floats1,
    factor: float,
    scale: float,
    geometric: float,
) -> None:
    """``K = E A int (r' r'^T + e I) S'_a S'_b ds``."""
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data, place = kind.elements[e].data, kind.elements[e].strain
        x = load_element(kind, e, q)
        forces = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        aa = ab = ac = bb = bc = cc = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        for g in range(AXIAL_POINTS):
            point = axial_point(kind.constants, data, g)
            d = combine(point.first, x)
            stretch = strain[place + g]
            stress = factor * point.stiffness * stretch
            forces = spread(forces, stress, point.first, d)
            isotropic = scale * geometric * stretch
            d0, d1, d2 = scale * d[0], scale * d[1], scale * d[2]
            m = (
                d0 * d[0] + isotropic,
                d1 * d[1] + isotropic,
                d2 * d[2] + isotropic,
                d0 * d[1],
                d0 * d[2],
                d1 * d[2],
            )
            aa = add_symmetric(aa, point.products[0], m)
            ab = add_symmetric(ab, point.products[1], m)
            ac = add_symmetric(ac, point.products[2], m)
            bb = add_symmetric(bb, point.products[3], m)
            bc = add_symmetric(bc, point.products[4], m)
            cc = add_symmetric(cc, point.products[5], m)
        put_forces(kind, e, force, forces)
        put_stiffness(kind, e, aa, full(ab), full(ac), bb, full(bc), cc)
