"""Frames and shells in the accurate integrator: ``M q'' = f - B^T C e(q) - K_b q``, M factored once.

Coordinates and velocities of a kind stand in the state vector as in nodal vectors, one after the other, from
`state_place` on. Among the velocities of all bodies a mesh has those of its bases, whose accelerations the joints
see and change; the impulses of the rows then go to all nodes by the same factor that gave the bases their
compliance. Losses and the work of loads are integrated with the motion.

For joints, which are differentiated twice, directions have second rates without accelerations of the bases. Points and
slopes are linear in the coordinates, so theirs are zero. With ``t`` a tangent and ``u = t/|t|``::

    u'' = -2 (u.t')/|t| u' - |u'|^2 u      at t'' = 0

A direction d fixed in the triad of two slopes a, b (see `heavylift.solver.bodies.ancf.step`) turns with w, of
components p, q, r in the triad. With A_i, B_i the components of ``a'/|a|`` and ``b'``, and b_i those of b, at
``a'' = b'' = 0``::

    r = A_2,    r' = -p q - 2 r A_1          q = -A_3,    q' = p r - 2 q A_1
    p b_2 = B_3 + b_1 q,    p' b_2 = 2 q B_1 - 2 p B_2 + q r b_2 + p r b_1 + b_1 q'
    d'' = w' x d + w x (w x d),    w' = p' e_1 + q' e_2 + r' e_3
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, add, add_scaled, cross, dot, scaled, vector_at
from heavylift.solver.bodies.ancf.assembly import add_matrix_products
from heavylift.solver.bodies.ancf.elements import (
    add_elastic_forces,
    add_strain_rates,
    add_stress_forces,
    find_strains,
)
from heavylift.solver.bodies.ancf.joints import take_impulses
from heavylift.solver.bodies.ancf.kind import MASS_SET, TANGENT_MARKER, TRIAD_MARKER, Meshes
from heavylift.solver.bodies.ancf.step import (
    add_gravity,
    base_value,
    fill_mesh_markers,
    gather_loads,
    write_bases,
    write_free_bases,
)
from heavylift.solver.bodies.ancf.substitution import node_span, scatter_back, solve_forward
from heavylift.solver.combination import copy_parts
from heavylift.solver.interface import (
    FORCES,
    Systems,
    Workspace,
    begin_stage,
    complete_accelerations,
    free_acceleration,
    store_state,
)
from heavylift.solver.kinds import implement

__all__ = [
    "write_second_rates",
]


# ---- second rates of directions ----


@kernel(internal=True)
def _put(kind: Meshes, body: int, out: Any, x: Vector) -> None:
    """Into world axes."""
    R = kind.body[body].rotation
    for k in range(3):
        out.bias[k] = R[k, 0] * x[0] + R[k, 1] * x[1] + R[k, 2] * x[2]


@kernel(internal=True)
def _tangent(kind: Meshes, marker: int) -> Vector:
    base = kind.markers[marker].base
    sense = kind.constants[kind.markers[marker].data]
    t, w = base_value(kind, base, kind.mid_position), base_value(kind, base, kind.mid_velocity)
    size = 1.0 / math.sqrt(dot(t, t))
    u = scaled(size, t)
    along = dot(u, w)
    turn = scaled(size, add_scaled(w, -along, u))
    first, second = -2.0 * sense * along * size, -sense * dot(turn, turn)
    return add_scaled(scaled(first, turn), second, u)


@kernel(internal=True)
def _triad(kind: Meshes, marker: int) -> Vector:
    base, data = kind.markers[marker].base, kind.markers[marker].data
    d = vector_at(kind.constants, data)
    a, b = base_value(kind, base, kind.mid_position), base_value(kind, base + 1, kind.mid_position)
    ra, rb = base_value(kind, base, kind.mid_velocity), base_value(kind, base + 1, kind.mid_velocity)
    size = 1.0 / math.sqrt(dot(a, a))
    e1 = scaled(size, a)
    n = cross(a, b)
    area = 1.0 / math.sqrt(dot(n, n))
    e3 = scaled(area, n)
    e2 = cross(e3, e1)
    b1, b2 = dot(b, e1), dot(b, e2)
    along = size * dot(e1, ra)
    q, r = -size * dot(e3, ra), size * dot(e2, ra)
    p = (dot(e3, rb) + b1 * q) / b2
    dr = -p * q - 2.0 * r * along
    dq = p * r - 2.0 * q * along
    dp = 2.0 * q * dot(e1, rb) - 2.0 * p * dot(e2, rb) + q * r * b2 + p * r * b1 + b1 * dq
    dp /= b2
    c = add(cross((dp, dq, dr), d), cross((p, q, r), cross((p, q, r), d)))
    return add_scaled(add_scaled(scaled(c[0], e1), c[1], e2), c[2], e3)


@kernel(internal=True)
def write_second_rates(kind: Meshes, level: int, work: Workspace) -> None:
    """Of all markers that a level needs, at `mid_position` and `mid_velocity`."""
    for marker in range(kind.markers.shape[0]):
        if kind.markers[marker].level > level:
            continue
        which, body = kind.markers[marker].type, kind.markers[marker].body
        out = work.markers[kind.markers[marker].number]
        if which == TANGENT_MARKER:
            _put(kind, body, out, _tangent(kind, marker))
        elif which == TRIAD_MARKER:
            _put(kind, body, out, _triad(kind, marker))
        else:
            _put(kind, body, out, (0.0, 0.0, 0.0))


# ---- the integrator ----


@implement(begin_stage, Meshes)
@kernel(internal=True)
def begin_mesh_stage(
    kind: Meshes, time: float, values: NDArray[np.float64], at: int, work: Workspace
) -> None:
    """Coordinates into those of the midpoint, then markers from these."""
    place, count = at + kind.table[0].state_place, kind.position.shape[0]
    copy_parts(values, place, kind.mid_position, 0, count)
    copy_parts(values, place + count, kind.mid_velocity, 0, count)
    for body in range(kind.table.shape[0]):
        kind.body[body].time = time
    if kind.bases.shape[0] > 0:
        write_bases(kind, kind.mid_velocity, values[at : at + work.velocity.shape[0]])
        fill_mesh_markers(kind, True, FORCES, work)
        write_second_rates(kind, FORCES, work)


@implement(free_acceleration, Meshes)
@kernel(internal=True)
def free_mesh_acceleration(kind: Meshes, values: NDArray[np.float64], at: int, work: Workspace) -> None:
    """All forces, and forward substitution; the bases get their accelerations, the nodes later."""
    loaded = kind.loads.shape[0] > 0 or kind.bases.shape[0] > 0
    if loaded:
        gather_loads(kind, kind.mid_position, work)
    right = kind.right_hand_side
    for body in range(kind.table.shape[0]):
        first, last = node_span(kind, body)
        for i in range(first, last):
            right[i] = 0.0
        if loaded:
            _add_loads(kind, body, work)
        add_gravity(kind, body, work, 1.0)
        add_elastic_forces(kind, body, kind.mid_position, right, -1.0)
        if kind.body[body].viscous_damping > 0.0 or kind.body[body].stiffness_damping > 0.0:
            _add_damping(kind, body, work)
        solve_forward(kind, body, MASS_SET)
        write_free_bases(kind, body, kind.velocity, 0.0, work)


@kernel(internal=True, reassociate=True)
def _add_loads(kind: Meshes, body: int, work: Workspace) -> None:
    """Loads and their power."""
    first, last = node_span(kind, body)
    right, load, speed = kind.right_hand_side, kind.external_force, kind.mid_velocity
    power = 0.0
    for i in range(first, last):
        power += load[i] * speed[i]
    for i in range(first, last):
        right[i] += load[i]
    work.sums.external_work += power


@kernel(internal=True, reassociate=True)
def _add_damping(kind: Meshes, body: int, work: Workspace) -> None:
    """``-a M v - b (B^T C B + K_b) v`` and the power that it takes."""
    first, last = node_span(kind, body)
    viscous, stiff = kind.body[body].viscous_damping, kind.body[body].stiffness_damping
    right, force, speed = kind.right_hand_side, kind.forward_solution, kind.mid_velocity
    for i in range(first, last):
        force[i] = 0.0
    add_matrix_products(kind, body, speed, viscous, speed, stiff, force)
    if stiff > 0.0:
        begin = kind.table[body].first_strain
        for i in range(begin, begin + kind.table[body].strain_count):
            kind.shape_strain[i] = 0.0
        add_strain_rates(kind, body, kind.mid_position, speed, kind.shape_strain, stiff)
        add_stress_forces(kind, body, kind.mid_position, kind.shape_strain, force, 1.0)
    lost = 0.0
    for i in range(first, last):
        lost += force[i] * speed[i]
    for i in range(first, last):
        right[i] -= force[i]
    work.sums.dissipated += lost


@implement(complete_accelerations, Meshes)
@kernel(internal=True)
def complete_mesh_accelerations(
    kind: Meshes, systems: Systems, with_forces: bool, values: NDArray[np.float64], rate: int
) -> None:
    """Back substitution, ``M^-1 J^T P`` on top of what `free_acceleration` has left, or alone."""
    take_impulses(kind, systems, kind.right_hand_side)
    place, right = rate + kind.table[0].state_place + kind.position.shape[0], kind.right_hand_side
    for body in range(kind.table.shape[0]):
        first, last = node_span(kind, body)
        if not with_forces:
            for i in range(first, last):
                right[i] = 0.0
        if with_forces or kind.table[body].base_node_count > 0:
            scatter_back(kind, body, MASS_SET)
        copy_parts(right, first, values, place + first, last - first)


@implement(store_state, Meshes)
@kernel(internal=True)
def store_mesh_state(
    kind: Meshes, time: float, values: NDArray[np.float64], at: int, work: Workspace
) -> None:
    """Fixed coordinates do not move; strains are those of the shape."""
    place, count = at + kind.table[0].state_place, kind.position.shape[0]
    for i in range(count):
        values[place + count + i] *= kind.free[i]
    copy_parts(values, place, kind.position, 0, count)
    copy_parts(values, place + count, kind.velocity, 0, count)
    for body in range(kind.table.shape[0]):
        find_strains(kind, body, kind.position, kind.strain)
