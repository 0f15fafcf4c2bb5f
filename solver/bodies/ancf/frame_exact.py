"""Frames with the engineering strain and the material curvature: kernels over the elements of a body.

With ``d = r'`` and ``c = r''`` (by arc length of the reference): ``e = |d| - 1`` and ``K = d x c / |d|^2``, whose
product with E I is the moment; the geometric curvature, over ``|d|^3``, is not conjugate to it (J. Gerstmayr and
H. Irschik, J. Sound Vib. 318, 2008). Where the reference is straight, the strains of a bending point are the three
components of K.

Where it is curved they are one number, ``|K| - |K_0|``: without torsion round sections turn about the axis until their
energy is least, and ``min |K - R K_0|`` over all turns R is just this. So a curved element resists no bending out of
its plane, as a real rod without torsional stiffness would not; it is meant for motion in a plane. Where ``K`` passes
zero the sections of such a rod turn over at once: energy and force stay defined, the tangent is not.

Forces over a step that conserve energy and momenta are discrete gradients in invariants: strains are functions of ``a
= r'.r'``, ``b = r'.r''`` and ``c = r''.r''``, which are quadratic in the coordinates and know nothing of rotations.
With means of both ends of a step (barred; those of vectors: m) their changes D over the step are exactly::

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

import math

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, add, add_scaled, cross, dot, scaled
from heavylift.solver.bodies.ancf.frame_data import (
    AXIAL_POINTS,
    BENDING_POINTS,
    Full,
    Symmetric,
    add_full,
    add_symmetric,
    axial_point,
    bending_point,
    combine,
    frame_data,
    full,
    load_element,
    put_forces,
    put_stiffness,
    spread,
    transpose,
)
from heavylift.solver.bodies.ancf.kind import FrameMeshes

__all__ = [
    "add_exact_forces",
    "add_exact_mean_forces",
    "add_exact_rates",
    "add_exact_stiffness",
    "curvature",
    "find_exact_strains",
]


@kernel(inline=True, internal=True)
def curvature(d: Vector, c: Vector) -> Vector:
    """``K = d x c / |d|^2``."""
    k = cross(d, c)
    inverse = 1.0 / dot(d, d)
    return inverse * k[0], inverse * k[1], inverse * k[2]


@kernel(inline=True, internal=True)
def _direction(d: Vector, c: Vector) -> tuple[float, Vector]:
    """``|K|`` and ``K / |K|``; zero where the element is straight, as its energy has no slope there."""
    k = curvature(d, c)
    length = math.sqrt(dot(k, k))
    inverse = 1.0 / length if length > 0.0 else 0.0
    return length, (inverse * k[0], inverse * k[1], inverse * k[2])


@kernel(inline=True, internal=True)
def _moment(strain: Floats1, at: int, curved: bool, d: Vector, c: Vector) -> Vector:
    """Strain of a bending point as a vector, the moment over E I: along K where the strain is a number."""
    if curved:
        n = _direction(d, c)[1]
        s = strain[at]
        return s * n[0], s * n[1], s * n[2]
    return strain[at], strain[at + 1], strain[at + 2]


@kernel(inline=True, internal=True)
def _gradient(d: Vector, c: Vector, m: Vector) -> tuple[Vector, Vector]:
    """Derivatives of ``m.K`` by d and c: ``(c x m) / |d|^2 - 2 m.K d / |d|^2`` and ``(m x d) / |d|^2``."""
    inverse = 1.0 / dot(d, d)
    by_d = cross(c, m)
    by_c = cross(m, d)
    along = 2.0 * inverse * dot(d, by_d)  # d.(c x m) = m.(d x c)
    return (
        (
            inverse * (by_d[0] - along * d[0]),
            inverse * (by_d[1] - along * d[1]),
            inverse * (by_d[2] - along * d[2]),
        ),
        (inverse * by_c[0], inverse * by_c[1], inverse * by_c[2]),
    )


@kernel(inline=True, internal=True)
def _curvature_stiffness(
    d: Vector, c: Vector, m: Vector, material: float, geometric: float
) -> tuple[Symmetric, Full, Symmetric]:
    """``material P^T P + geometric (m.K)''`` by d d, d c and c c, with ``P`` the derivatives of K."""
    inverse = 1.0 / dot(d, d)
    g = dot(c, d)
    a2 = material * inverse * inverse
    p = 2.0 * geometric * inverse * inverse
    cm = cross(c, m)
    md = cross(m, d)
    triple = dot(d, cm)
    ratio = g * inverse
    # by d d: (..) I - a2 c c^T + u d^T + d u^T
    uc = 2.0 * a2 * ratio
    ud = -2.0 * a2 * ratio * ratio + 2.0 * p * triple * inverse
    u = (
        uc * c[0] + ud * d[0] - p * cm[0],
        uc * c[1] + ud * d[1] - p * cm[1],
        uc * c[2] + ud * d[2] - p * cm[2],
    )
    isotropic = a2 * dot(c, c) - p * triple
    e0, e1, e2 = a2 * c[0], a2 * c[1], a2 * c[2]
    dd = (
        isotropic - e0 * c[0] + 2.0 * u[0] * d[0],
        isotropic - e1 * c[1] + 2.0 * u[1] * d[1],
        isotropic - e2 * c[2] + 2.0 * u[2] * d[2],
        u[0] * d[1] + u[1] * d[0] - e0 * c[1],
        u[0] * d[2] + u[2] * d[0] - e0 * c[2],
        u[1] * d[2] + u[2] * d[1] - e1 * c[2],
    )
    # by d c: -a2 g I - geometric m~ / |d|^2 + d v^T
    v = (uc * d[0] - e0 - p * md[0], uc * d[1] - e1 - p * md[1], uc * d[2] - e2 - p * md[2])
    isotropic = -a2 * g
    skew = geometric * inverse
    dc = (
        isotropic + d[0] * v[0],
        d[0] * v[1] + skew * m[2],
        d[0] * v[2] - skew * m[1],
        d[1] * v[0] - skew * m[2],
        isotropic + d[1] * v[1],
        d[1] * v[2] + skew * m[0],
        d[2] * v[0] + skew * m[1],
        d[2] * v[1] - skew * m[0],
        isotropic + d[2] * v[2],
    )
    isotropic = material * inverse
    e0, e1, e2 = a2 * d[0], a2 * d[1], a2 * d[2]
    ccs = (
        isotropic - e0 * d[0],
        isotropic - e1 * d[1],
        isotropic - e2 * d[2],
        -e0 * d[1],
        -e0 * d[2],
        -e1 * d[2],
    )
    return dd, dc, ccs


@kernel(inline=True, internal=True)
def _square(f: float, v: Vector) -> Symmetric:
    """``f v v^T``."""
    x, y, z = f * v[0], f * v[1], f * v[2]
    return x * v[0], y * v[1], z * v[2], x * v[1], x * v[2], y * v[2]


@kernel(inline=True, internal=True)
def _outer(f: float, u: Vector, v: Vector) -> Full:
    """``f u v^T``."""
    x, y, z = f * u[0], f * u[1], f * u[2]
    return (
        x * v[0],
        x * v[1],
        x * v[2],
        y * v[0],
        y * v[1],
        y * v[2],
        z * v[0],
        z * v[1],
        z * v[2],
    )


@kernel(internal=True)
def find_exact_strains(kind: FrameMeshes, body: int, q: Floats1, strain: Floats1) -> None:
    """Axial strains of an element, then its curvatures."""
    constants = kind.constants
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data, place = kind.elements[e].data, kind.elements[e].strain
        curved = frame_data(constants, data).curved
        x = load_element(kind, e, q)
        rest = frame_data(constants, data).initial_strain - 1.0
        for g in range(AXIAL_POINTS):
            d = combine(axial_point(constants, data, g).first, x)
            strain[place + g] = math.sqrt(dot(d, d)) + rest
        place += AXIAL_POINTS
        for g in range(BENDING_POINTS):
            section = bending_point(constants, data, g)
            k = curvature(combine(section.first, x), combine(section.second, x))
            if curved:
                strain[place] = math.sqrt(dot(k, k)) - section.curvature
                place += 1
            else:
                strain[place] = k[0]
                strain[place + 1] = k[1]
                strain[place + 2] = k[2]
                place += 3


@kernel(internal=True)
def add_exact_rates(
    kind: FrameMeshes, body: int, q: Floats1, v: Floats1, strain: Floats1, factor: float
) -> None:
    """``e' = t.d'`` and ``K' = (d' x c + d x c' - 2 (d.d') K) / |d|^2``."""
    constants = kind.constants
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data, place = kind.elements[e].data, kind.elements[e].strain
        curved = frame_data(constants, data).curved
        x, rate = load_element(kind, e, q), load_element(kind, e, v)
        for g in range(AXIAL_POINTS):
            point = axial_point(constants, data, g)
            d, change = combine(point.first, x), combine(point.first, rate)
            strain[place + g] += factor * dot(d, change) / math.sqrt(dot(d, d))
        place += AXIAL_POINTS
        for g in range(BENDING_POINTS):
            section = bending_point(constants, data, g)
            d, c = combine(section.first, x), combine(section.second, x)
            d1, c1 = combine(section.first, rate), combine(section.second, rate)
            if curved:
                n = _direction(d, c)[1]
                by_d, by_c = _gradient(d, c, n)
                strain[place] += factor * (dot(by_d, d1) + dot(by_c, c1))
                place += 1
            else:
                inverse = factor / dot(d, d)
                k = curvature(d, c)
                turn = cross(d1, c)
                bend = cross(d, c1)
                stretch = 2.0 * dot(d, d1)
                for i in range(3):
                    strain[place + i] += inverse * (turn[i] + bend[i] - stretch * k[i])
                place += 3


@kernel(internal=True)
def add_exact_forces(
    kind: FrameMeshes, body: int, q: Floats1, strain: Floats1, force: Floats1, factor: float
) -> None:
    """Axial stress along ``t``, moments along the derivatives of K."""
    constants = kind.constants
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data, place = kind.elements[e].data, kind.elements[e].strain
        curved = frame_data(constants, data).curved
        x = load_element(kind, e, q)
        forces = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        for g in range(AXIAL_POINTS):
            point = axial_point(constants, data, g)
            d = combine(point.first, x)
            tension = factor * point.stiffness * strain[place + g] / math.sqrt(dot(d, d))
            forces = spread(forces, tension, point.first, d)
        place += AXIAL_POINTS
        for g in range(BENDING_POINTS):
            section = bending_point(constants, data, g)
            d, c = combine(section.first, x), combine(section.second, x)
            by_d, by_c = _gradient(d, c, _moment(strain, place, curved, d, c))
            place += 1 if curved else 3
            weight = factor * section.stiffness
            forces = spread(spread(forces, weight, section.first, by_d), weight, section.second, by_c)
        put_forces(kind, e, force, forces)


@kernel(internal=True)
def add_exact_stiffness(
    kind: FrameMeshes,
    body: int,
    q: Floats1,
    strain: Floats1,
    force: Floats1,
    factor: float,
    scale: float,
    geometric: float,
) -> None:
    """Axial ``t t^T + e / |d| (I - t t^T)``, and the curvature as in `_curvature_stiffness`.

    A number ``k = |K|`` with the stress s has ``k' = K'.n`` and ``k'' = (n.K)'' + (P^T P - k' k'^T) / k``.
    """
    constants = kind.constants
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data, place = kind.elements[e].data, kind.elements[e].strain
        curved = frame_data(constants, data).curved
        x = load_element(kind, e, q)
        forces = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        aa = sab = sac = bb = sbc = cc = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        for g in range(AXIAL_POINTS):
            point = axial_point(constants, data, g)
            d = combine(point.first, x)
            stretch = strain[place + g]
            square = dot(d, d)
            inverse = 1.0 / math.sqrt(square)
            tension = factor * point.stiffness * stretch * inverse
            forces = spread(forces, tension, point.first, d)
            isotropic = scale * geometric * stretch * inverse
            h = _square((scale - isotropic) * inverse * inverse, d)
            h = (h[0] + isotropic, h[1] + isotropic, h[2] + isotropic, h[3], h[4], h[5])
            aa = add_symmetric(aa, point.products[0], h)
            sab = add_symmetric(sab, point.products[1], h)
            sac = add_symmetric(sac, point.products[2], h)
            bb = add_symmetric(bb, point.products[3], h)
            sbc = add_symmetric(sbc, point.products[4], h)
            cc = add_symmetric(cc, point.products[5], h)
        ab, ac, bc = full(sab), full(sac), full(sbc)
        place += AXIAL_POINTS
        for g in range(BENDING_POINTS):
            section = bending_point(constants, data, g)
            d, c = combine(section.first, x), combine(section.second, x)
            m = _moment(strain, place, curved, d, c)
            by_d, by_c = _gradient(d, c, m)
            weight = factor * section.stiffness
            forces = spread(spread(forces, weight, section.first, by_d), weight, section.second, by_c)
            material = scale
            if curved:
                k, n = _direction(d, c)
                material = scale * geometric * strain[place] / k if k > 0.0 else 0.0
            dd, dc, ccs = _curvature_stiffness(d, c, m, material, scale * geometric)
            if curved:
                by_d, by_c = _gradient(d, c, n)
                dd = add_symmetric(dd, scale - material, _square(1.0, by_d))
                dc = add_full(dc, scale - material, _outer(1.0, by_d, by_c))
                ccs = add_symmetric(ccs, scale - material, _square(1.0, by_c))
                place += 1
            else:
                place += 3
            both = (
                2.0 * dc[0],
                2.0 * dc[4],
                2.0 * dc[8],
                dc[1] + dc[3],
                dc[2] + dc[6],
                dc[5] + dc[7],
            )
            cd, ddf, ccf = transpose(dc), full(dd), full(ccs)
            aa = add_symmetric(aa, section.products[0], dd)
            aa = add_symmetric(aa, section.products[6], ccs)
            aa = add_symmetric(aa, section.products[12], both)
            bb = add_symmetric(bb, section.products[3], dd)
            bb = add_symmetric(bb, section.products[9], ccs)
            bb = add_symmetric(bb, section.products[15], both)
            cc = add_symmetric(cc, section.products[5], dd)
            cc = add_symmetric(cc, section.products[11], ccs)
            cc = add_symmetric(cc, section.products[17], both)
            ab = add_full(add_full(ab, section.products[1], ddf), section.products[7], ccf)
            ab = add_full(add_full(ab, section.products[13], dc), section.products[18], cd)
            ac = add_full(add_full(ac, section.products[2], ddf), section.products[8], ccf)
            ac = add_full(add_full(ac, section.products[14], dc), section.products[19], cd)
            bc = add_full(add_full(bc, section.products[4], ddf), section.products[10], ccf)
            bc = add_full(add_full(bc, section.products[16], dc), section.products[20], cd)
        put_forces(kind, e, force, forces)
        put_stiffness(kind, e, aa, ab, ac, bb, bc, cc)


# ---- over a step ----


@kernel(inline=True, internal=True)
def _middle(u: Vector, v: Vector) -> Vector:
    """``(u + v) / 2``."""
    return scaled(0.5, add(u, v))


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
        add_scaled(scaled(by_b, c), by_a, d),
        add_scaled(scaled(by_c, c), by_b, d),
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
    return add_scaled(scaled(u, by_d), along, d), scaled(u, by_c)


@kernel(internal=True)
def add_exact_mean_forces(kind: FrameMeshes, body: int, force: Floats1, factor: float) -> None:
    """``factor B^T C s`` with ``B (q_1 - q_0) = e_1 - e_0`` and the mean strains s of a step."""
    constants = kind.constants
    start_strain, end_strain, mean_strain = kind.start_strain, kind.shape_strain, kind.stage_strain
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data, place = kind.elements[e].data, kind.elements[e].strain
        curved = frame_data(constants, data).curved
        x0, x1 = load_element(kind, e, kind.position), load_element(kind, e, kind.trial_position)
        rest = 2.0 - 2.0 * frame_data(constants, data).initial_strain
        forces = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        for g in range(AXIAL_POINTS):
            point = axial_point(constants, data, g)
            d0, d1 = combine(point.first, x0), combine(point.first, x1)
            both = add(d0, d1)
            lengths = start_strain[place + g] + end_strain[place + g] + rest
            tension = factor * point.stiffness * mean_strain[place + g] / lengths
            forces = spread(forces, tension, point.first, both)
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
                by_d, by_c = add(by_d, more_d), add(by_c, more_c)
                place += 3
            weight = factor * section.stiffness
            forces = spread(spread(forces, weight, section.first, by_d), weight, section.second, by_c)
        put_forces(kind, e, force, forces)
