"""What Python asks of a kind of meshes before time starts, compiled: its mass matrix, its own forces and stiffness.

Methods of group ``rest`` serve every scene with meshes, those of group ``static`` its equilibrium.
"""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1, Floats2, Ints1
from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.ancf.assembly import factor_mass, set_size
from heavylift.solver.bodies.ancf.elements import (
    add_follower_load,
    add_stiffness,
    add_strain_rates,
    add_stress_forces,
    find_strains,
)
from heavylift.solver.bodies.ancf.kind import MASS_SET, STEP_SET, Meshes, read_bases, spread_base
from heavylift.solver.bodies.ancf.step import add_gravity, base_value, gather_loads
from heavylift.solver.bodies.ancf.substitution import scatter_back
from heavylift.solver.interface import Workspace
from heavylift.solver.kinds import implement, method

__all__ = [
    "difference_follower",
    "fill_promised_stiffness",
    "fill_stress_forces",
    "fill_weight_and_loads",
    "prepare_mass",
    "promise_strains",
]


# ---- of every scene ----


@method("rest")
@kernel(internal=True)
def prepare_mass(kind: Meshes) -> None:
    """Factor the mass matrix of all bodies."""
    factor_mass(kind)


@implement(read_bases, Meshes)
@kernel(internal=True)
def read_mesh_bases(kind: Meshes, body: int, nodal: Floats1, out: Floats1) -> None:
    """Sums over the nodes of the element in which a base lies."""
    first = kind.table[body].first_base
    for i in range(kind.table[body].base_count):
        out[3 * i], out[3 * i + 1], out[3 * i + 2] = base_value(kind, first + i, nodal)


@implement(spread_base, Meshes)
@kernel(internal=True)
def spread_mesh_base(kind: Meshes, body: int) -> None:
    """The substitution of the factor of the mass matrix."""
    scatter_back(kind, body, MASS_SET)


# ---- of equilibrium ----


@method("static")
@kernel(internal=True)
def fill_stress_forces(kind: Meshes, with_stiffness: bool) -> None:
    """``B^T C e`` of the carried coordinates into `right_hand_side`, its derivative into the step set if asked for.

    Steps make the step set anew.
    """
    size = set_size(kind)
    for i in range(kind.position.shape[0]):
        kind.right_hand_side[i] = 0.0
    if with_stiffness:
        for i in range(STEP_SET * size, STEP_SET * size + size):
            kind.blocks[i] = 0.0
    for body in range(kind.table.shape[0]):
        find_strains(kind, body, kind.position, kind.shape_strain)
        if with_stiffness:
            add_stiffness(kind, body, kind.position, kind.shape_strain, kind.right_hand_side, 1.0, 1.0, 1.0)
        else:
            add_stress_forces(kind, body, kind.position, kind.shape_strain, kind.right_hand_side, 1.0)


@method("static")
@kernel(internal=True)
def promise_strains(kind: Meshes) -> None:
    """Strains that a displacement in `velocity_change` promises at the carried coordinates, into `stage_strain`."""
    for body in range(kind.table.shape[0]):
        find_strains(kind, body, kind.position, kind.stage_strain)
        add_strain_rates(kind, body, kind.position, kind.velocity_change, kind.stage_strain, 1.0)


@method("static")
@kernel(internal=True)
def fill_promised_stiffness(kind: Meshes) -> None:
    """Stiffness at the carried coordinates with the stress of `stage_strain`, into the step set."""
    size = set_size(kind)
    for i in range(STEP_SET * size, STEP_SET * size + size):
        kind.blocks[i] = 0.0
    for body in range(kind.table.shape[0]):
        add_stiffness(kind, body, kind.position, kind.stage_strain, kind.right_hand_side, 0.0, 1.0, 1.0)


@method("static")
@kernel(internal=True)
def fill_weight_and_loads(kind: Meshes, work: Workspace, time: float) -> None:
    """Weight into `right_hand_side`, loads of the mesh and forces of the markers into `external_force`."""
    for i in range(kind.position.shape[0]):
        kind.right_hand_side[i] = 0.0
    for body in range(kind.table.shape[0]):
        kind.body[body].time = time
        add_gravity(kind, body, work, 1.0)
    gather_loads(kind, kind.position, work)


@method("static")
@kernel(internal=True)
def difference_follower(
    kind: Meshes, body: int, load: int, factor: float, step: float, places: Ints1, out: Floats2
) -> None:
    """Derivative of a follower load on an element by coordinates at some places, shape (places, places)."""
    element, data = kind.loads[load].place, kind.loads[load].data
    count = places.shape[0]
    for i in range(count):
        kind.trial_position[places[i]] = kind.position[places[i]]
    for column in range(count):
        for side in range(2):
            sign = 1.0 - 2.0 * side
            kind.trial_position[places[column]] = kind.position[places[column]] + sign * step
            for i in range(count):
                kind.external_force[places[i]] = 0.0
            add_follower_load(kind, body, kind.trial_position, element, kind.external_force, data, factor)
            for i in range(count):
                if side == 0:
                    out[i, column] = kind.external_force[places[i]]
                else:
                    out[i, column] = (out[i, column] - kind.external_force[places[i]]) / (2.0 * step)
        kind.trial_position[places[column]] = kind.position[places[column]]
