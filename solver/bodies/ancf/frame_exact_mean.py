"""Forces of exact frames over a step that conserve energy and momenta: discrete gradients in invariants.

Strains of `heavylift.solver.bodies.ancf.frame_exact` are functions of ``a = r'.r'``, ``b = r'.r''`` and
``c = r''.r''``, which are quadratic in the coordinates and know nothing of rotations. With means of both ends of a
step (barred; those of vectors: m) their changes D over the step are exactly::

    D|r'|  = 2 r'_m.Dr' / (|r'|_0 + |r'|_1)
    D|K|^2 = D(c u - v^2) = u_ Dc - 2 u_ v_ Db - (c_ - 2 b_ v_) Da / (a_0 a_1),   u = 1/a,  v = b/a
    D|K|   = D|K|^2 / (|K|_0 + |K|_1)
    Da = 2 r'_m.Dr',   Db = r'_m.Dr'' + r''_m.Dr',   Dc = 2 r''_m.Dr''

What stands before ``Dr'`` and ``Dr''`` takes the place of the derivatives at the midpoint: a discrete gradient (O.
Gonzalez, J. Nonlinear Sci. 6, 1996) by the product rule, which needs no correction that is divided by the increment
and so no measure of it. It is symmetric in both ends, so the scheme stays of second order.

The energy ``E I |K|^2 / 2`` of straight elements is such a function too, with no root in it. The remainder of their
strain, stiffness damping and what is left of a drift of carried strains, is a vector in fixed axes as it is there::

    D K = u_ (r'_m x Dr'' + Dr' x r''_m) - 2 N_ (r'_m.Dr') / (a_0 a_1),   N = r' x r''

whose stress does exactly the work that the strain says, but has a moment of its own: with it the angular
momentum is kept to the order of the scheme only.
"""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import cross
from heavylift.solver.bodies.ancf.frame_data import (
    AXIAL_POINTS,
    BENDING_POINTS,
    Vector,
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

__all__ = ["add_exact_mean_forces"]


@kernel(inline=True, internal=True)
def _middle(u: Vector, v: Vector) -> Vector:
    """``(u + v) / 2``."""
    return 0.5 * (u[0] + v[0]), 0.5 * (u[1] + v[1]), 0.5 * (u[2] + v[2])


@kernel(inline=True, internal=True)
def _square_gradient(f: float, d0: Vector, c0: Vector, d1: Vector, c1: Vector) -> tuple[Vector, Vector]:
    """``f`` times what stands before ``Dr'`` and ``Dr''`` in ``D|K|^2``; d is r', c is r''."""
    d, c = _middle(d0, d1), _middle(c0, c1)
    u0, u1 = 1.0 / dot(d0, d0), 1.0 / dot(d1, d1)
    b0, b1 = dot(d0, c0), dot(d1, c1)
    u, v = 0.5 * (u0 + u1), 0.5 * (b0 * u0 + b1 * u1)
    square = 0.5 * (dot(c0, c0) + dot(c1, c1)) - (b0 + b1) * v
    by_c, by_b, by_a = 2.0 * f * u, -2.0 * f * u * v, -2.0 * f * u0 * u1 * square
    return (
        (by_b * c[0] + by_a * d[0], by_b * c[1] + by_a * d[1], by_b * c[2] + by_a * d[2]),
        (by_c * c[0] + by_b * d[0], by_c * c[1] + by_b * d[1], by_c * c[2] + by_b * d[2]),
    )


@kernel(inline=True, internal=True)
def _vector_gradient(m: Vector, d0: Vector, c0: Vector, d1: Vector, c1: Vector) -> tuple[Vector, Vector]:
    """What stands before ``Dr'`` and ``Dr''`` in ``m.DK``."""
    d, c = _middle(d0, d1), _middle(c0, c1)
    u0, u1 = 1.0 / dot(d0, d0), 1.0 / dot(d1, d1)
    u = 0.5 * (u0 + u1)
    normal = _middle(cross(d0, c0), cross(d1, c1))
    by_d = cross(c, m)
    by_c = cross(m, d)
    along = -2.0 * u0 * u1 * dot(m, normal)
    return (
        (u * by_d[0] + along * d[0], u * by_d[1] + along * d[1], u * by_d[2] + along * d[2]),
        (u * by_c[0], u * by_c[1], u * by_c[2]),
    )


@kernel(internal=True)
def add_exact_mean_forces(
    kind: FrameMeshes,
    body: int,
    q_start: Floats1,
    q_end: Floats1,
    start_strain: Floats1,
    end_strain: Floats1,
    mean_strain: Floats1,
    force: Floats1,
    factor: float,
) -> None:
    """``factor B^T C s`` with ``B (q_end - q_start) = e_end - e_start`` and the mean strains s of a step."""
    constants = kind.constants
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data, place = kind.elements[e].data, kind.elements[e].strain
        curved = frame_data(constants, data).curved
        x0, x1 = load_element(kind, e, q_start), load_element(kind, e, q_end)
        rest = 2.0 - 2.0 * frame_data(constants, data).initial_strain
        fa = fb = fc = (0.0, 0.0, 0.0)
        for g in range(AXIAL_POINTS):
            point = axial_point(constants, data, g)
            d0, d1 = combine(point.first, x0), combine(point.first, x1)
            both = (d0[0] + d1[0], d0[1] + d1[1], d0[2] + d1[2])
            lengths = start_strain[place + g] + end_strain[place + g] + rest
            tension = factor * point.stiffness * mean_strain[place + g] / lengths
            fa = add_vector(fa, tension * point.first[0], both)
            fb = add_vector(fb, tension * point.first[1], both)
            fc = add_vector(fc, tension * point.first[2], both)
        place += AXIAL_POINTS
        for g in range(BENDING_POINTS):
            section = bending_point(constants, data, g)
            d0, c0 = combine(section.first, x0), combine(section.second, x0)
            d1, c1 = combine(section.first, x1), combine(section.second, x1)
            if curved:
                ends = start_strain[place] + end_strain[place]
                ends += 2.0 * section.curvature
                moment = mean_strain[place] / ends if ends > 0.0 else 0.0
                by_d, by_c = _square_gradient(moment, d0, c0, d1, c1)
                place += 1
            else:
                by_d, by_c = _square_gradient(0.5, d0, c0, d1, c1)
                m = (
                    mean_strain[place] - 0.5 * (start_strain[place] + end_strain[place]),
                    mean_strain[place + 1] - 0.5 * (start_strain[place + 1] + end_strain[place + 1]),
                    mean_strain[place + 2] - 0.5 * (start_strain[place + 2] + end_strain[place + 2]),
                )
                more_d, more_c = _vector_gradient(m, d0, c0, d1, c1)
                by_d, by_c = add_vector(by_d, 1.0, more_d), add_vector(by_c, 1.0, more_c)
                place += 3
            weight = factor * section.stiffness
            fa = add_vector(add_vector(fa, weight * section.first[0], by_d), weight * section.second[0], by_c)
            fb = add_vector(
                add_vector(fb, weight * section.first[1], by_d),
                weight * section.second[1],
                by_c,
            )
            fc = add_vector(
                add_vector(fc, weight * section.first[2], by_d),
                weight * section.second[2],
                by_c,
            )
        put_forces(kind, e, force, fa, fb, fc)
