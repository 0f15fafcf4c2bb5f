"""Frames and shells in the accurate integrator: ``M q'' = f - B^T C e(q) - K_b q``, M factored once.

Coordinates and velocities of a kind stand in the state vector as in nodal vectors, one after the other, from
`state_place` on. Among the velocities of all bodies a mesh has those of its bases, whose accelerations the joints
see and change; the impulses of the rows then go to all nodes by the same factor that gave the bases their
compliance. Losses and the work of loads are integrated with the motion.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.ancf.assembly import add_matrix_products
from heavylift.solver.bodies.ancf.elements import (
    add_elastic_forces,
    add_strain_rates,
    add_stress_forces,
    find_strains,
)
from heavylift.solver.bodies.ancf.joints import take_impulses
from heavylift.solver.bodies.ancf.kind import MASS_SET, Meshes
from heavylift.solver.bodies.ancf.loads import gather_loads
from heavylift.solver.bodies.ancf.second_rates import write_second_rates
from heavylift.solver.bodies.ancf.stage import fill_mesh_markers, write_bases
from heavylift.solver.bodies.ancf.step import add_gravity, write_free_bases
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

__all__: list[str] = []


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
