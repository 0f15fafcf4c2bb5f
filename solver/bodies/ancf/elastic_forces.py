"""Elastic forces of all elements of a body from its coordinates alone, in one pass: what explicit schemes need.

Of a frame, with ``d = r'``, ``c = r''``, ``i = 1/d.d`` and ``g = i c.d``, the curvature ``K = i d x c`` has the square
``i c.c - g^2``, and a bending point of weight w adds the derivatives of ``w K.K/2``::

    by c:  w i (c - g d)                by d:  w i ((2 g^2 - i c.c) d - g c)

Where the reference is curved, w becomes ``w (1 - |K_0|/|K|)``: see `heavylift.solver.bodies.ancf.frame_exact`.
"""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.ancf.assembly import add_matrix_products
from heavylift.solver.bodies.ancf.elements import add_elastic_forces, add_stress_forces, find_strains
from heavylift.solver.bodies.ancf.frame_data import (
    AXIAL,
    AXIAL_COLUMNS,
    AXIAL_POINTS,
    BENDING,
    BENDING_COLUMNS,
    BENDING_POINTS,
    CURVATURE,
    CURVED,
    GREEN_LAGRANGE,
    INITIAL_STRAIN,
    SCALAR_BENDING,
    SECOND,
    SHAPE,
    WEIGHT,
    add_vector,
    combine,
    dot,
    load_element,
    put_forces,
)
from heavylift.solver.bodies.ancf.kind import (
    SHAPE_STRAIN,
    FrameMeshes,
    ShellMeshes,
)
from heavylift.solver.kinds import implement

__all__: list[str] = []


@implement(add_elastic_forces, FrameMeshes)
@kernel(internal=True)
def add_frame_elastic_forces(kind: FrameMeshes, body: int, q: int, force: int, factor: float) -> None:
    """By model."""
    if kind.constants[kind.table[body].constants] == GREEN_LAGRANGE:
        _add_green_lagrange(kind, body, q, force, factor)
    else:
        _add_exact(kind, body, q, force, factor)


@kernel(internal=True, reassociate=True)
def _add_green_lagrange(kind: FrameMeshes, body: int, q: int, force: int, factor: float) -> None:
    """The matrix of bending knows the difference of both positions only."""
    constants = kind.constants
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data = kind.elements[e].data
        x = load_element(kind, e, q)
        K = data + SCALAR_BENDING
        aa, ab, ac = factor * constants[K + 10], factor * constants[K + 9], factor * constants[K + 11]
        bb, bc, cc = factor * constants[K + 5], factor * constants[K + 7], factor * constants[K + 15]
        u, p, s = x
        fa = (
            aa * u[0] + ab * p[0] + ac * s[0],
            aa * u[1] + ab * p[1] + ac * s[1],
            aa * u[2] + ab * p[2] + ac * s[2],
        )
        fb = (
            ab * u[0] + bb * p[0] + bc * s[0],
            ab * u[1] + bb * p[1] + bc * s[1],
            ab * u[2] + bb * p[2] + bc * s[2],
        )
        fc = (
            ac * u[0] + bc * p[0] + cc * s[0],
            ac * u[1] + bc * p[1] + cc * s[1],
            ac * u[2] + bc * p[2] + cc * s[2],
        )
        rest = constants[data + INITIAL_STRAIN] - 0.5
        for g in range(AXIAL_POINTS):
            at = data + AXIAL + g * AXIAL_COLUMNS
            d = combine(constants, at + SHAPE, x)
            stress = factor * constants[at + WEIGHT] * (0.5 * dot(d, d) + rest)
            fa = add_vector(fa, stress * constants[at + SHAPE], d)
            fb = add_vector(fb, stress * constants[at + SHAPE + 1], d)
            fc = add_vector(fc, stress * constants[at + SHAPE + 2], d)
        put_forces(kind, e, force, fa, fb, fc)


@kernel(internal=True, reassociate=True)
def _add_exact(kind: FrameMeshes, body: int, q: int, force: int, factor: float) -> None:
    """Tension ``E A (|d| - 1 + e_0)`` along ``d/|d|``, and moments."""
    constants = kind.constants
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data = kind.elements[e].data
        x = load_element(kind, e, q)
        fa = fb = fc = (0.0, 0.0, 0.0)
        rest = constants[data + INITIAL_STRAIN] - 1.0
        for g in range(AXIAL_POINTS):
            at = data + AXIAL + g * AXIAL_COLUMNS
            d = combine(constants, at + SHAPE, x)
            tension = factor * constants[at + WEIGHT] * (1.0 + rest / math.sqrt(dot(d, d)))
            fa = add_vector(fa, tension * constants[at + SHAPE], d)
            fb = add_vector(fb, tension * constants[at + SHAPE + 1], d)
            fc = add_vector(fc, tension * constants[at + SHAPE + 2], d)
        curved = constants[data + CURVED] != 0.0
        for g in range(BENDING_POINTS):
            at = data + BENDING + g * BENDING_COLUMNS
            d, c = combine(constants, at + SHAPE, x), combine(constants, at + SECOND, x)
            i = 1.0 / dot(d, d)
            h = i * dot(c, d)
            cc = i * dot(c, c)
            weight = factor * constants[at + WEIGHT] * i
            if curved:
                square = cc - h * h
                weight *= 1.0 - constants[at + CURVATURE] / math.sqrt(square) if square > 0.0 else 0.0
            a, b = weight * (2.0 * h * h - cc), -weight * h
            by_d = (a * d[0] + b * c[0], a * d[1] + b * c[1], a * d[2] + b * c[2])
            by_c = (weight * c[0] + b * d[0], weight * c[1] + b * d[1], weight * c[2] + b * d[2])
            fa = add_vector(add_vector(fa, constants[at + SHAPE], by_d), constants[at + SECOND], by_c)
            fb = add_vector(add_vector(fb, constants[at + SHAPE + 1], by_d), constants[at + SECOND + 1], by_c)
            fc = add_vector(add_vector(fc, constants[at + SHAPE + 2], by_d), constants[at + SECOND + 2], by_c)
        put_forces(kind, e, force, fa, fb, fc)


@implement(add_elastic_forces, ShellMeshes)
@kernel(internal=True)
def add_shell_elastic_forces(kind: ShellMeshes, body: int, q: int, force: int, factor: float) -> None:
    """Strains are left in row `SHAPE_STRAIN`."""
    add_matrix_products(kind, body, q, 0.0, q, factor, force)
    find_strains(kind, body, q, SHAPE_STRAIN)
    add_stress_forces(kind, body, q, SHAPE_STRAIN, force, factor)
