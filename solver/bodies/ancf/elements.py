"""What a type of ANCF element offers: operations over all elements of one body.

Coordinates `q`, velocities `v` and forces are nodal vectors, strains are vectors of strains; the body is its row of
`table`. Forces are added in the places of the nodes, stiffness to the blocks of the step matrix, both without regard
to fixed coordinates. None of them but `add_elastic_forces` knows of bending matrices and mass matrices: these are
constant, see `constants`. Two of them follow from others, and elements that know better bring versions of their own.
"""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.ancf.assembly import add_matrix_products
from heavylift.solver.bodies.ancf.kind import Meshes
from heavylift.solver.kinds import generic, implement

__all__ = [
    "add_elastic_forces",
    "add_follower_load",
    "add_mean_stress_forces",
    "add_stiffness",
    "add_strain_rates",
    "add_stress_forces",
    "find_strains",
    "measure_drift",
    "measure_strain_energy",
    "record_elements",
]


@generic()
def find_strains(kinds: Meshes, body: int, q: Floats1, strain: Floats1) -> None:
    """``strain = e(q)``."""


@generic()
def add_strain_rates(
    kinds: Meshes, body: int, q: Floats1, v: Floats1, strain: Floats1, factor: float
) -> None:
    """``strain += factor B(q) v``."""


@generic()
def add_stress_forces(
    kinds: Meshes, body: int, q: Floats1, strain: Floats1, force: Floats1, factor: float
) -> None:
    """``force += factor B(q)^T C strain``."""


@generic()
def add_mean_stress_forces(kinds: Meshes, body: int, force: Floats1, factor: float) -> None:
    """``force += factor Bm^T C s`` with the mean strains s of a step and ``Bm (q_1 - q_0) = e_1 - e_0``.

    So the work of a step is that of the mean strain in the change of the strains of the shape, however long the step.
    At its start are `position` and `start_strain`, at its end `trial_position` and `shape_strain`; `stage_strain` is
    the mean. `mid_position` is the mean of both ends; at strains that are quadratic in the coordinates ``Bm`` is ``B``
    there.
    """


@generic()
def add_elastic_forces(kinds: Meshes, body: int, q: Floats1, force: Floats1, factor: float) -> None:
    """``force += factor (B^T C e(q) + K_b q)`` in one pass; `shape_strain` is scratch."""


@generic()
def add_stiffness(
    kinds: Meshes,
    body: int,
    q: Floats1,
    strain: Floats1,
    force: Floats1,
    factor: float,
    scale: float,
    geometric: float,
) -> None:
    """Both in one pass: `add_stress_forces`, and ``scale (B^T C B + geometric G)`` into the blocks of the step set.

    ``G`` is the derivative of ``B^T`` at the stress ``C strain``; at `geometric` 0 it costs nothing.
    """


@generic()
def measure_strain_energy(kinds: Meshes, body: int, strain: Floats1) -> None:
    """``elastic_energy += e^T C e / 2`` of a body with some strains."""


@generic()
def measure_drift(kinds: Meshes, body: int, first: Floats1, second: Floats1) -> None:
    """Largest difference [1] of two vectors of strains into `drift`, its element of the body into `drift_element`.

    The largest strain of the second one goes into `strained`.

    Curvatures count with half the height of the section.
    """


@generic()
def add_follower_load(
    kinds: Meshes, body: int, q: Floats1, element: int, load: Floats1, data: int, factor: float
) -> None:
    """``load += factor`` times the load of an element at the coordinates `q`, data from `constants[data]` on."""


@generic()
def record_elements(kinds: Meshes, body: int, row: Floats1) -> None:
    """Vectors of the nodes, section forces and stresses of the carried state into a record."""


# ---- what follows from others ----


@implement(add_mean_stress_forces, Meshes)
@kernel(internal=True)
def add_mean_forces_of_squares(kind: Meshes, body: int, force: Floats1, factor: float) -> None:
    """For strains that are quadratic in the coordinates."""
    add_stress_forces(kind, body, kind.mid_position, kind.stage_strain, force, factor)


@implement(add_elastic_forces, Meshes)
@kernel(internal=True)
def add_all_elastic_forces(kind: Meshes, body: int, q: Floats1, force: Floats1, factor: float) -> None:
    """In two passes; strains are left in `shape_strain`."""
    add_matrix_products(kind, body, q, 0.0, q, factor, force)
    find_strains(kind, body, q, kind.shape_strain)
    add_stress_forces(kind, body, q, kind.shape_strain, force, factor)
