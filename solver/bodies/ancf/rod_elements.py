"""Elements of rods: the operations of elements, for strains that are sums of products of nodal vectors.

With ``u_t = U_t v`` and ``w_t = W_t v`` a strain ``s = sum_t u_t.w_t - s_0`` has the derivatives by the nodal vectors
``g_a = sum_t U_ta w_t + W_ta u_t``, the force ``C s g_a`` and the stiffness ``C g_a g_b^T + C s P_ab 1`` with the
products P. Strains are quadratic, so over a step those of the midpoint take energy and momenta as they are.

Results are those of a frame at its axis, and the moment about it.
"""

from __future__ import annotations

import math

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, add_scaled, dot, scaled
from heavylift.solver.bodies.ancf.elements import (
    add_follower_load,
    add_stiffness,
    add_strain_rates,
    add_stress_forces,
    find_strains,
    measure_drift,
    measure_strain_energy,
    record_elements,
)
from heavylift.solver.bodies.ancf.frame_data import STRESS_PLACES, combine, frame_data, load_element
from heavylift.solver.bodies.ancf.frame_exact import curvature
from heavylift.solver.bodies.ancf.kind import RodMeshes
from heavylift.solver.bodies.ancf.record import write_nodes
from heavylift.solver.bodies.ancf.rod_data import (
    ROD_FRAME,
    ROD_STRAINS,
    TERMS,
    TWIST,
    VECTORS,
    RodStrain,
    rod_data,
    rod_strain,
)
from heavylift.solver.kinds import implement
from heavylift.solver.recording import part

__all__: list[str] = []

LANES = 16
"""Places of a column of a block."""


@kernel(inline=True, internal=True)
def _place(kind: RodMeshes, e: int, a: int) -> int:
    """Place of a vector of an element in a nodal vector."""
    return kind.elements[e].nodes[a // 4] + 3 * (a % 4)


@kernel(internal=True)
def _sum(kind: RodMeshes, e: int, row: Floats1, nodal: Floats1) -> Vector:
    """A row times the nodal vectors of an element."""
    x = y = z = 0.0
    for a in range(VECTORS):
        if row[a] != 0.0:
            at = _place(kind, e, a)
            x += row[a] * nodal[at]
            y += row[a] * nodal[at + 1]
            z += row[a] * nodal[at + 2]
    return x, y, z


@implement(find_strains, RodMeshes)
@kernel(internal=True)
def find_rod_strains(kind: RodMeshes, body: int, q: Floats1, strain: Floats1) -> None:
    """``sum u.w - s_0``."""
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data, place = kind.elements[e].data, kind.elements[e].strain
        for number in range(ROD_STRAINS):
            own = rod_strain(kind.constants, data, number)
            total = -own.rest
            for t in range(TERMS if number == TWIST else 1):
                total += dot(_sum(kind, e, own.left[t], q), _sum(kind, e, own.right[t], q))
            strain[place + number] = total


@implement(add_strain_rates, RodMeshes)
@kernel(internal=True)
def add_rod_rates(kind: RodMeshes, body: int, q: Floats1, v: Floats1, strain: Floats1, factor: float) -> None:
    """``sum u'.w + u.w'``."""
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        data, place = kind.elements[e].data, kind.elements[e].strain
        for number in range(ROD_STRAINS):
            own = rod_strain(kind.constants, data, number)
            total = 0.0
            for t in range(TERMS if number == TWIST else 1):
                left, right = own.left[t], own.right[t]
                total += dot(_sum(kind, e, left, v), _sum(kind, e, right, q))
                total += dot(_sum(kind, e, left, q), _sum(kind, e, right, v))
            strain[place + number] += factor * total


@kernel(inline=True, internal=True)
def _slope(own: RodStrain, a: int, u0: Vector, w0: Vector, u1: Vector, w1: Vector) -> Vector:
    """Derivative of a strain by a nodal vector."""
    g = add_scaled(scaled(own.left[0, a], w0), own.right[0, a], u0)
    return add_scaled(add_scaled(g, own.left[1, a], w1), own.right[1, a], u1)


@kernel(internal=True)
def _add_element(
    kind: RodMeshes,
    e: int,
    q: Floats1,
    strain: Floats1,
    force: Floats1,
    factor: float,
    scale: float,
    geometric: float,
) -> None:
    """Forces of an element, and its stiffness into the blocks where `scale` is not zero."""
    data, at = kind.elements[e].data, kind.elements[e].strain
    zero = (0.0, 0.0, 0.0)
    for number in range(ROD_STRAINS):
        own = rod_strain(kind.constants, data, number)
        stress = own.stiffness * strain[at + number]
        u0, w0, u1, w1 = _sum(kind, e, own.left[0], q), _sum(kind, e, own.right[0], q), zero, zero
        if number == TWIST:
            u1, w1 = _sum(kind, e, own.left[1], q), _sum(kind, e, own.right[1], q)
        for a in range(VECTORS):
            if own.products[a, a] == 0.0 and not _takes_part(own, a):
                continue
            g = _slope(own, a, u0, w0, u1, w1)
            place = _place(kind, e, a)
            for k in range(3):
                force[place + k] += factor * stress * g[k]
            if scale == 0.0:
                continue
            material, tense = scale * own.stiffness, scale * geometric * stress
            for b in range(VECTORS):
                if (b // 4) > (a // 4) or not _takes_part(own, b):
                    continue  # blocks of the pairs of nodes (0, 0), (1, 0), (1, 1)
                h = _slope(own, b, u0, w0, u1, w1)
                pair = a // 4 + b // 4
                block, swapped = kind.elements[e].blocks[pair, 0], kind.elements[e].blocks[pair, 1]
                row, column = 3 * (a % 4), 3 * (b % 4)
                isotropic = tense * own.products[a, b]
                for k in range(3):
                    for l in range(3):
                        value = material * g[k] * h[l] + (isotropic if k == l else 0.0)
                        if swapped == 0:
                            kind.blocks[block + (column + l) * LANES + row + k] += value
                        else:
                            kind.blocks[block + (row + k) * LANES + column + l] += value


@kernel(inline=True, internal=True)
def _takes_part(own: RodStrain, a: int) -> bool:
    """Whether a strain depends on a nodal vector."""
    return own.left[0, a] != 0.0 or own.right[0, a] != 0.0 or own.left[1, a] != 0.0 or own.right[1, a] != 0.0


@implement(add_stress_forces, RodMeshes)
@kernel(internal=True)
def add_rod_forces(
    kind: RodMeshes, body: int, q: Floats1, strain: Floats1, force: Floats1, factor: float
) -> None:
    """Of all elements."""
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        _add_element(kind, e, q, strain, force, factor, 0.0, 0.0)


@implement(add_stiffness, RodMeshes)
@kernel(internal=True)
def add_rod_stiffness(
    kind: RodMeshes,
    body: int,
    q: Floats1,
    strain: Floats1,
    force: Floats1,
    factor: float,
    scale: float,
    geometric: float,
) -> None:
    """Of all elements."""
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        _add_element(kind, e, q, strain, force, factor, scale, geometric)


@implement(measure_strain_energy, RodMeshes)
@kernel(internal=True)
def measure_rod_energy(kind: RodMeshes, body: int, strain: Floats1) -> None:
    """``1/2 C s^2``."""
    first, energy = kind.table[body].first_element, 0.0
    for e in range(first, first + kind.table[body].element_count):
        data, place = kind.elements[e].data, kind.elements[e].strain
        for number in range(ROD_STRAINS):
            s = strain[place + number]
            energy += rod_strain(kind.constants, data, number).stiffness * s * s
    kind.body[body].elastic_energy += 0.5 * energy


@implement(measure_drift, RodMeshes)
@kernel(internal=True)
def measure_rod_drift(kind: RodMeshes, body: int, first: Floats1, second: Floats1) -> None:
    """Curvatures and twist count with half of the height of the section."""
    start = kind.table[body].first_element
    drift, strained, worst = 0.0, 0.0, 0
    for number in range(kind.table[body].element_count):
        data, place = kind.elements[start + number].data, kind.elements[start + number].strain
        for i in range(ROD_STRAINS):
            height = rod_strain(kind.constants, data, i).height
            distance = height * abs(first[place + i] - second[place + i])
            strained = max(strained, height * abs(second[place + i]))
            if not distance <= drift and not math.isnan(drift):  # a lost number is a drift, and stays one
                drift, worst = distance, number
    kind.body[body].drift, kind.body[body].strained = drift, strained
    kind.body[body].drift_element = worst


@implement(add_follower_load, RodMeshes)
@kernel(internal=True)
def add_rod_follower(
    kind: RodMeshes, body: int, q: Floats1, element: int, load: Floats1, data: int, factor: float
) -> None:
    """None: packing refuses them."""


@kernel(internal=True)
def _section_forces(kind: RodMeshes, element: int, place: int) -> tuple[float, float]:
    """Axial force and magnitude of the bending moment at one of the places of stress [N], [N m]."""
    own = frame_data(kind.constants, kind.elements[element].data + ROD_FRAME)
    x = load_element(kind, element, kind.position)
    d = combine(own.first[place], x)
    square = dot(d, d)
    strain = (0.5 * (square - 1.0) + own.initial_strain) * math.sqrt(square)
    k = curvature(d, combine(own.second[place], x))
    change = math.sqrt(dot(k, k)) - own.curvature[place]
    return own.axial_stiffness * strain, abs(own.bending_stiffness * change)


@implement(record_elements, RodMeshes)
@kernel(internal=True)
def record_rod_elements(kind: RodMeshes, body: int, row: Floats1) -> None:
    """Vectors and velocities of nodes; axial force, torque, two moments and the largest stress of elements."""
    entry, parts = kind.table[body], kind.table[body].parts
    write_nodes(kind, body, kind.position, 0, 1.0, part(row, parts.position))
    write_nodes(kind, body, kind.position, 1, 0.0, part(row, parts.tangent))
    write_nodes(kind, body, kind.position, 2, 0.0, part(row, parts.normal))
    write_nodes(kind, body, kind.velocity, 0, 0.0, part(row, parts.velocity))
    tensions, torques = part(row, parts.axial_force), part(row, parts.twisting_moment)
    moments, stresses = part(row, parts.bending_moment), part(row, parts.axial_stress)
    first = entry.first_element
    find_strains(kind, body, kind.position, kind.shape_strain)
    for number in range(entry.element_count):
        e = first + number
        own = frame_data(kind.constants, kind.elements[e].data + ROD_FRAME)
        tensions[number], _ = _section_forces(kind, e, STRESS_PLACES // 2)
        twist = kind.shape_strain[kind.elements[e].strain + TWIST]
        torques[number] = rod_data(kind.constants, kind.elements[e].data).torque * twist
        largest = lost = 0.0
        for place in range(STRESS_PLACES):
            force, moment = _section_forces(kind, e, place)
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
