"""Frames and shells in the first-order scheme of "Integrated simulation ... (2018)", eqs. 12 and 49.

Elastic forces are those of the start of the step, so it is stable for short steps only: 2 over the highest
circular frequency, as the leapfrog, with which it shares its positions.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.ancf.assembly import add_matrix_products
from heavylift.solver.bodies.ancf.elements import add_strain_rates, add_stress_forces, find_strains
from heavylift.solver.bodies.ancf.kind import MASS_SET, Meshes
from heavylift.solver.bodies.ancf.step import add_gravity, add_mesh_work, gather_loads, solve_free
from heavylift.solver.bodies.ancf.substitution import node_span
from heavylift.solver.interface import Workspace, thesis_advance, thesis_velocity
from heavylift.solver.kinds import implement

__all__: list[str] = []


@implement(thesis_velocity, Meshes)
@kernel(internal=True)
def thesis_velocity_meshes(kind: Meshes, time: float, step: float, work: Workspace) -> None:
    """``M (v+ - v) = h ( f - Q(q) - damping )``, without joints."""
    for body in range(kind.table.shape[0]):
        kind.body[body].time = time
    gather_loads(kind, kind.position, work)
    right = kind.right_hand_side
    for body in range(kind.table.shape[0]):
        first, last = node_span(kind, body)
        viscous, stiff = kind.body[body].viscous_damping, kind.body[body].stiffness_damping
        for i in range(first, last):
            right[i] = step * kind.external_force[i]
            kind.mid_position[i] = kind.position[i]
        add_gravity(kind, body, work, step)
        add_matrix_products(kind, body, kind.velocity, -step * viscous, kind.position, -step, right)
        find_strains(kind, body, kind.position, kind.shape_strain)
        if stiff > 0.0:
            add_matrix_products(kind, body, kind.velocity, 0.0, kind.velocity, -step * stiff, right)
            add_strain_rates(kind, body, kind.position, kind.velocity, kind.shape_strain, stiff)
        add_stress_forces(kind, body, kind.position, kind.shape_strain, right, -step)
        kind.body[body].stage_set = MASS_SET
        solve_free(kind, body, work)


@implement(thesis_advance, Meshes)
@kernel(internal=True)
def thesis_advance_meshes(kind: Meshes, time: float, step: float, work: Workspace) -> None:
    """Coordinates by the end velocity."""
    for body in range(kind.table.shape[0]):
        first, last = node_span(kind, body)
        add_mesh_work(kind, body, step, False)
        for i in range(first, last):
            kind.velocity[i] = kind.mid_velocity[i]
            kind.position[i] += step * kind.velocity[i]
        find_strains(kind, body, kind.position, kind.strain)
