"""Elastic forces of all elements of a body from its coordinates alone, in one pass: what explicit schemes need.

Of a frame, with ``d = r'``, ``c = r''``, ``i = 1/d.d`` and ``g = i c.d``, the curvature ``K = i d x c`` has the square
``i c.c - g^2``, and a bending point of weight w adds the derivatives of ``w K.K/2``::

    by c:  w i (c - g d)                by d:  w i ((2 g^2 - i c.c) d - g c)

Where the reference is curved, w becomes ``w (1 - |K_0|/|K|)``: see `heavylift.solver.bodies.ancf.frame_exact`.
"""

from __future__ import annotations

import math

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.ancf.elements import add_elastic_forces
from heavylift.solver.bodies.ancf.frame_data import (
    AXIAL_POINTS,
    BENDING_POINTS,
    GREEN_LAGRANGE,
    add_vector,
    axial_point,
    bending_point,
    combine,
    dot,
    frame_data,
    load_element,
    put_forces,
)
from heavylift.solver.bodies.ancf.kind import FrameMeshes
from heavylift.solver.kinds import implement

__all__: list[str] = []


@implement(add_elastic_forces, FrameMeshes)
@kernel(internal=True)
def add_frame_elastic_forces(kind: FrameMeshes, body: int, q: Floats1, force: Floats1, factor: float) -> None:
    """By model."""
    if kind.constants[kind.table[body].constants] == GREEN_LAGRANGE:
        _add_green_lagrange(kind, body, q, force, factor)
    else:
        _add_exact(kind, body, q, force, factor)


@kernel(internal=True, reassociate=True)
def _add_green_lagrange(kind: FrameMeshes, body: int, q: Floats1, force: Floats1, factor: float) -> None:
    """The matrix of bending knows the difference of both positions only."""
    constants = kind.constants
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data = kind.elements[e].data
        x = load_element(kind, e, q)
        K = frame_data(constants, data).bending
        aa, ab, ac = factor * K[2, 2], factor * K[2, 1], factor * K[2, 3]
        bb, bc, cc = factor * K[1, 1], factor * K[1, 3], factor * K[3, 3]
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
        rest = frame_data(constants, data).initial_strain - 0.5
        for g in range(AXIAL_POINTS):
            point = axial_point(constants, data, g)
            d = combine(point.first, x)
            stress = factor * point.stiffness * (0.5 * dot(d, d) + rest)
            fa = add_vector(fa, stress * point.first[0], d)
            fb = add_vector(fb, stress * point.first[1], d)
            fc = add_vector(fc, stress * point.first[2], d)
        put_forces(kind, e, force, fa, fb, fc)


@kernel(internal=True, reassociate=True)
def _add_exact(kind: FrameMeshes, body: int, q: Floats1, force: Floats1, factor: float) -> None:
    """Tension ``E A (|d| - 1 + e_0)`` along ``d/|d|``, and moments."""
    constants = kind.constants
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data = kind.elements[e].data
        x = load_element(kind, e, q)
        fa = fb = fc = (0.0, 0.0, 0.0)
        rest = frame_data(constants, data).initial_strain - 1.0
        for g in range(AXIAL_POINTS):
            point = axial_point(constants, data, g)
            d = combine(point.first, x)
            tension = factor * point.stiffness * (1.0 + rest / math.sqrt(dot(d, d)))
            fa = add_vector(fa, tension * point.first[0], d)
            fb = add_vector(fb, tension * point.first[1], d)
            fc = add_vector(fc, tension * point.first[2], d)
        curved = frame_data(constants, data).curved
        for g in range(BENDING_POINTS):
            section = bending_point(constants, data, g)
            d, c = combine(section.first, x), combine(section.second, x)
            i = 1.0 / dot(d, d)
            h = i * dot(c, d)
            cc = i * dot(c, c)
            weight = factor * section.stiffness * i
            if curved:
                square = cc - h * h
                weight *= 1.0 - section.curvature / math.sqrt(square) if square > 0.0 else 0.0
            a, b = weight * (2.0 * h * h - cc), -weight * h
            by_d = (a * d[0] + b * c[0], a * d[1] + b * c[1], a * d[2] + b * c[2])
            by_c = (weight * c[0] + b * d[0], weight * c[1] + b * d[1], weight * c[2] + b * d[2])
            fa = add_vector(add_vector(fa, section.first[0], by_d), section.second[0], by_c)
            fb = add_vector(add_vector(fb, section.first[1], by_d), section.second[1], by_c)
            fc = add_vector(add_vector(fc, section.first[2], by_d), section.second[2], by_c)
        put_forces(kind, e, force, fa, fb, fc)
