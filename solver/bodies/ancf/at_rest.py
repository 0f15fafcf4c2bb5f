"""What Python asks of a mesh before time starts, compiled: its mass matrix, its bases, its own forces and stiffness.

The verbs of group ``rest`` serve every scene with meshes, those of group ``static`` its equilibrium.
"""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1, Floats2, Ints1
from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.ancf.assembly import factor_mass, set_size
from heavylift.solver.bodies.ancf.elements import (
    add_follower_load,
    add_stiffness,
    add_stress_forces,
    find_strains,
)
from heavylift.solver.bodies.ancf.kind import MASS_SET, STEP_SET, FrameMeshes, Meshes, ShellMeshes
from heavylift.solver.bodies.ancf.loads import gather_loads
from heavylift.solver.bodies.ancf.stage import base_value
from heavylift.solver.bodies.ancf.step import add_gravity
from heavylift.solver.bodies.ancf.substitution import scatter_back
from heavylift.solver.interface import Bodies, Workspace
from heavylift.solver.kinds import implement, optional

__all__ = [
    "difference_follower",
    "fill_stiffness",
    "fill_stress_forces",
    "fill_weight_and_loads",
    "prepare_mass",
    "read_bases",
    "spread_base",
]


# ---- of every scene ----


@optional("rest")
def prepare_mass(kinds: Bodies) -> None:
    """Meshes: factor the mass matrix of all bodies."""


@optional("rest")
def read_bases(kinds: Bodies, body: int, nodal: Floats1, out: Floats1) -> None:
    """Meshes: values of a nodal vector at the bases of a body, body axes, shape (3 bases,)."""


@optional("rest")
def spread_base(kinds: Bodies, body: int) -> None:
    """Meshes: `right_hand_side`, with minus the impulses in the places of the bases, becomes velocities of nodes."""


@implement(prepare_mass, FrameMeshes)
@implement(prepare_mass, ShellMeshes)
@kernel(internal=True)
def _prepare_mass(kind: Meshes) -> None:
    factor_mass(kind)


@implement(read_bases, FrameMeshes)
@implement(read_bases, ShellMeshes)
@kernel(internal=True)
def _read_bases(kind: Meshes, body: int, nodal: Floats1, out: Floats1) -> None:
    first = kind.table[body].first_base
    for i in range(kind.table[body].base_count):
        out[3 * i], out[3 * i + 1], out[3 * i + 2] = base_value(kind, first + i, nodal)


@implement(spread_base, FrameMeshes)
@implement(spread_base, ShellMeshes)
@kernel(internal=True)
def _spread_base(kind: Meshes, body: int) -> None:
    scatter_back(kind, body, MASS_SET)


# ---- of equilibrium ----


@optional("static")
def fill_stress_forces(kinds: Bodies) -> None:
    """Meshes: ``B^T C e`` of the carried coordinates into `right_hand_side`."""


@optional("static")
def fill_stiffness(kinds: Bodies) -> None:
    """Meshes: derivative of `fill_stress_forces` into the step set, which is made anew in each step."""


@optional("static")
def fill_weight_and_loads(kinds: Bodies, work: Workspace, time: float) -> None:
    """Meshes: weight into `right_hand_side`, loads of the mesh and forces of the markers into `external_force`."""


@optional("static")
def difference_follower(
    kinds: Bodies, body: int, load: int, factor: float, step: float, places: Ints1, out: Floats2
) -> None:
    """Meshes: derivative of a follower load on an element by coordinates at some places, shape (places, places)."""


@implement(fill_stress_forces, FrameMeshes)
@implement(fill_stress_forces, ShellMeshes)
@kernel(internal=True)
def _fill_stress_forces(kind: Meshes) -> None:
    for i in range(kind.position.shape[0]):
        kind.right_hand_side[i] = 0.0
    for body in range(kind.table.shape[0]):
        find_strains(kind, body, kind.position, kind.shape_strain)
        add_stress_forces(kind, body, kind.position, kind.shape_strain, kind.right_hand_side, 1.0)


@implement(fill_stiffness, FrameMeshes)
@implement(fill_stiffness, ShellMeshes)
@kernel(internal=True)
def _fill_stiffness(kind: Meshes) -> None:
    size = set_size(kind)
    for i in range(STEP_SET * size, STEP_SET * size + size):
        kind.blocks[i] = 0.0
    for i in range(kind.position.shape[0]):
        kind.right_hand_side[i] = 0.0
    for body in range(kind.table.shape[0]):
        find_strains(kind, body, kind.position, kind.shape_strain)
        add_stiffness(kind, body, kind.position, kind.shape_strain, kind.right_hand_side, 1.0, 1.0, 1.0)


@implement(fill_weight_and_loads, FrameMeshes)
@implement(fill_weight_and_loads, ShellMeshes)
@kernel(internal=True)
def _fill_weight_and_loads(kind: Meshes, work: Workspace, time: float) -> None:
    for i in range(kind.position.shape[0]):
        kind.right_hand_side[i] = 0.0
    for body in range(kind.table.shape[0]):
        kind.body[body].time = time
        add_gravity(kind, body, work, 1.0)
    gather_loads(kind, kind.position, work)


@implement(difference_follower, FrameMeshes)
@implement(difference_follower, ShellMeshes)
@kernel(internal=True)
def _difference_follower(
    kind: Meshes, body: int, load: int, factor: float, step: float, places: Ints1, out: Floats2
) -> None:
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
