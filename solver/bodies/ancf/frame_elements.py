"""Elements of frames: the operations of elements, by model; loads that follow them and what they record.

Results of an element: at its centre the axial force ``E A e`` (Green-Lagrange: ``E A e |r'|``, conjugate to the
length); at both ends the magnitude of the moment ``E I |K|``, K the material curvature ``r' x r'' / |r'|^2`` (in curved
elements ``E I (|K| - |K_0|)``); of the outer fibres the stress of largest amount, with the sign of the axial force:
``N / A`` and the moment times ``outer_fibre / I``, both at the same place, of places spread over the element. Moments
are linear along a cubic, so under a load q per length those at the ends are ``q l^2 / 12`` off, as in any cubic beam.

Explicit schemes need elastic forces of all elements from coordinates alone, in one pass. With ``d = r'``,
``c = r''``, ``i = 1/d.d`` and ``g = i c.d``, the curvature ``K = i d x c`` has the square
``i c.c - g^2``, and a bending point of weight w adds the derivatives of ``w K.K/2``::

    by c:  w i (c - g d)                by d:  w i ((2 g^2 - i c.c) d - g c)

Where the reference is curved, w becomes ``w (1 - |K_0|/|K|)``: see `heavylift.solver.bodies.ancf.frame_exact`.
"""

from __future__ import annotations

import math

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import add_scaled, cross, dot, scaled
from heavylift.solver.bodies.ancf.elements import (
    add_elastic_forces,
    add_follower_load,
    add_mean_stress_forces,
    add_stiffness,
    add_strain_rates,
    add_stress_forces,
    find_strains,
    measure_drift,
    measure_strain_energy,
    record_elements,
)
from heavylift.solver.bodies.ancf.frame_data import (
    AXIAL_POINTS,
    BENDING_POINTS,
    GREEN_LAGRANGE,
    STRESS_PLACES,
    axial_point,
    bending_point,
    combine,
    frame_data,
    frame_follower,
    load_element,
    put_forces,
    spread,
)
from heavylift.solver.bodies.ancf.frame_exact import (
    add_exact_forces,
    add_exact_mean_forces,
    add_exact_rates,
    add_exact_stiffness,
    curvature,
    find_exact_strains,
)
from heavylift.solver.bodies.ancf.frame_green_lagrange import (
    add_green_lagrange_forces,
    add_green_lagrange_rates,
    add_green_lagrange_stiffness,
    find_green_lagrange_strains,
)
from heavylift.solver.bodies.ancf.kind import FrameMeshes
from heavylift.solver.bodies.ancf.record import write_nodes
from heavylift.solver.kinds import implement
from heavylift.solver.recording import part

__all__: list[str] = []


@kernel(inline=True, internal=True)
def _is_exact(kind: FrameMeshes, body: int) -> bool:
    return kind.constants[kind.table[body].constants] != GREEN_LAGRANGE


@implement(find_strains, FrameMeshes)
@kernel(internal=True)
def find_frame_strains(kind: FrameMeshes, body: int, q: Floats1, strain: Floats1) -> None:
    if _is_exact(kind, body):
        find_exact_strains(kind, body, q, strain)
    else:
        find_green_lagrange_strains(kind, body, q, strain)


@implement(add_strain_rates, FrameMeshes)
@kernel(internal=True)
def add_frame_rates(
    kind: FrameMeshes, body: int, q: Floats1, v: Floats1, strain: Floats1, factor: float
) -> None:
    if _is_exact(kind, body):
        add_exact_rates(kind, body, q, v, strain, factor)
    else:
        add_green_lagrange_rates(kind, body, q, v, strain, factor)


@implement(add_stress_forces, FrameMeshes)
@kernel(internal=True)
def add_frame_forces(
    kind: FrameMeshes, body: int, q: Floats1, strain: Floats1, force: Floats1, factor: float
) -> None:
    if _is_exact(kind, body):
        add_exact_forces(kind, body, q, strain, force, factor)
    else:
        add_green_lagrange_forces(kind, body, q, strain, force, factor)


@implement(add_mean_stress_forces, FrameMeshes)
@kernel(internal=True)
def add_frame_mean_forces(kind: FrameMeshes, body: int, force: Floats1, factor: float) -> None:
    if _is_exact(kind, body):
        add_exact_mean_forces(kind, body, force, factor)
    else:
        add_green_lagrange_forces(kind, body, kind.mid_position, kind.stage_strain, force, factor)


@implement(add_stiffness, FrameMeshes)
@kernel(internal=True)
def add_frame_stiffness(
    kind: FrameMeshes,
    body: int,
    q: Floats1,
    strain: Floats1,
    force: Floats1,
    factor: float,
    scale: float,
    geometric: float,
) -> None:
    if _is_exact(kind, body):
        add_exact_stiffness(kind, body, q, strain, force, factor, scale, geometric)
    else:
        add_green_lagrange_stiffness(kind, body, q, strain, force, factor, scale, geometric)


@implement(measure_strain_energy, FrameMeshes)
@kernel(internal=True)
def measure_frame_energy(kind: FrameMeshes, body: int, strain: Floats1) -> None:
    constants = kind.constants
    exact = _is_exact(kind, body)
    first = kind.table[body].first_element
    energy = 0.0
    for e in range(first, first + kind.table[body].element_count):
        data, place = kind.elements[e].data, kind.elements[e].strain
        for g in range(AXIAL_POINTS):
            s = strain[place + g]
            energy += axial_point(constants, data, g).stiffness * s * s
        if exact:
            components = 1 if frame_data(constants, data).curved else 3
            place += AXIAL_POINTS
            for g in range(BENDING_POINTS):
                weight = bending_point(constants, data, g).stiffness
                for k in range(components):
                    s = strain[place + k]
                    energy += weight * s * s
                place += components
    kind.body[body].elastic_energy += 0.5 * energy


@implement(measure_drift, FrameMeshes)
@kernel(internal=True)
def measure_frame_drift(kind: FrameMeshes, body: int, first: Floats1, second: Floats1) -> None:
    constants = kind.constants
    exact = _is_exact(kind, body)
    start = kind.table[body].first_element
    drift, strained, worst = 0.0, 0.0, 0
    for number in range(kind.table[body].element_count):
        e = start + number
        data, place = kind.elements[e].data, kind.elements[e].strain
        count = AXIAL_POINTS
        if exact:
            count += BENDING_POINTS if frame_data(constants, data).curved else 3 * BENDING_POINTS
        for i in range(count):
            distance = abs(first[place + i] - second[place + i])
            strain = abs(second[place + i])
            if i >= AXIAL_POINTS:
                distance *= frame_data(constants, data).height
                strain *= frame_data(constants, data).height
            strained = max(strained, strain)
            if not distance <= drift and not math.isnan(drift):  # a lost number is a drift, and stays one
                drift, worst = distance, number
    kind.body[body].drift, kind.body[body].strained = drift, strained
    kind.body[body].drift_element = worst


@implement(add_follower_load, FrameMeshes)
@kernel(internal=True)
def add_frame_follower(
    kind: FrameMeshes, body: int, q: Floats1, element: int, load: Floats1, data: int, factor: float
) -> None:
    """By `FrameFollower`."""
    constants = kind.constants
    i, j, own = kind.elements[element].nodes[0], kind.elements[element].nodes[1], kind.elements[element].data
    given = frame_follower(constants, data)
    normal, tangential, axis = factor * given.normal, factor * given.tangential, given.axis
    shape = load_element(kind, element, q)
    f1 = f2 = f3 = f4 = (0.0, 0.0, 0.0)
    for g in range(AXIAL_POINTS):
        point = axial_point(constants, own, g)
        d = combine(point.first, shape)
        inverse = 1.0 / math.sqrt(dot(d, d))
        side = cross(axis, d)
        f = add_scaled(scaled(inverse * normal, side), inverse * tangential, d)
        f1 = add_scaled(f1, point.loads[0], f)
        f2 = add_scaled(f2, point.loads[1], f)
        f3 = add_scaled(f3, point.loads[2], f)
        f4 = add_scaled(f4, point.loads[3], f)
    for k in range(3):
        load[i + k] += f1[k]
        load[i + 3 + k] += f2[k]
        load[j + k] += f3[k]
        load[j + 3 + k] += f4[k]


@kernel(internal=True)
def section_forces(kind: FrameMeshes, element: int, place: int, exact: bool) -> tuple[float, float]:
    """Axial force and magnitude of the moment at one of the places of stress [N], [N m]."""
    own = frame_data(kind.constants, kind.elements[element].data)
    x = load_element(kind, element, kind.position)
    d = combine(own.first[place], x)
    square = dot(d, d)
    stretch = math.sqrt(square)
    initial = own.initial_strain
    strain = stretch - 1.0 + initial if exact else (0.5 * (square - 1.0) + initial) * stretch
    k = curvature(d, combine(own.second[place], x))
    change = math.sqrt(dot(k, k)) - own.curvature[place]
    return own.axial_stiffness * strain, abs(own.bending_stiffness * change)


@implement(record_elements, FrameMeshes)
@kernel(internal=True)
def record_frame_elements(kind: FrameMeshes, body: int, row: Floats1) -> None:
    """Positions, tangents and velocities; axial forces, two moments and the stress of largest amount of elements."""
    entry, parts, exact = kind.table[body], kind.table[body].parts, _is_exact(kind, body)
    write_nodes(kind, body, kind.position, 0, 1.0, part(row, parts.position))
    write_nodes(kind, body, kind.position, 1, 0.0, part(row, parts.tangent))
    write_nodes(kind, body, kind.velocity, 0, 0.0, part(row, parts.velocity))
    tensions, moments = part(row, parts.axial_force), part(row, parts.bending_moment)
    stresses = part(row, parts.axial_stress)
    first = entry.first_element
    for number in range(entry.element_count):
        own = frame_data(kind.constants, kind.elements[first + number].data)
        tensions[number], _ = section_forces(kind, first + number, STRESS_PLACES // 2, exact)
        largest = lost = 0.0
        for place in range(STRESS_PLACES):
            force, moment = section_forces(kind, first + number, place, exact)
            if place == 0:
                moments[2 * number] = moment
            elif place == STRESS_PLACES - 1:
                moments[2 * number + 1] = moment
            bending = moment * own.stress
            stress = force / own.area + (-bending if force < 0.0 else bending)
            if abs(stress) > abs(largest):
                largest = stress
            lost += 0.0 * stress  # NaN, which a comparison passes over
        stresses[number] = largest + lost


# ---- in one pass, for explicit schemes ----


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
        forces = combine((aa, ab, ac), x), combine((ab, bb, bc), x), combine((ac, bc, cc), x)
        rest = frame_data(constants, data).initial_strain - 0.5
        for g in range(AXIAL_POINTS):
            point = axial_point(constants, data, g)
            d = combine(point.first, x)
            stress = factor * point.stiffness * (0.5 * dot(d, d) + rest)
            forces = spread(forces, stress, point.first, d)
        put_forces(kind, e, force, forces)


@kernel(internal=True, reassociate=True)
def _add_exact(kind: FrameMeshes, body: int, q: Floats1, force: Floats1, factor: float) -> None:
    """Tension ``E A (|d| - 1 + e_0)`` along ``d/|d|``, and moments."""
    constants = kind.constants
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data = kind.elements[e].data
        x = load_element(kind, e, q)
        forces = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        rest = frame_data(constants, data).initial_strain - 1.0
        for g in range(AXIAL_POINTS):
            point = axial_point(constants, data, g)
            d = combine(point.first, x)
            tension = factor * point.stiffness * (1.0 + rest / math.sqrt(dot(d, d)))
            forces = spread(forces, tension, point.first, d)
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
            by_d = add_scaled(scaled(a, d), b, c)
            by_c = add_scaled(scaled(weight, c), b, d)
            forces = spread(spread(forces, 1.0, section.first, by_d), 1.0, section.second, by_c)
        put_forces(kind, e, force, forces)
