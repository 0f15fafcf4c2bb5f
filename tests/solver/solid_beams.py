"""Cantilevers of bricks with modes, for tests of bodies whose places have elements around them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from heavylift.modal.bases import Basis, Loads, eigenmode_basis, place_loads, static_vectors
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility
from heavylift.modal.place_rotation import place_rotation
from heavylift.modal.reduced import ReducedBody
from heavylift.modal.reduction import reduce_body
from heavylift.modal.stress_stiffness import inertia_stiffening, stress_stiffness, with_loads
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.model import FEModel, Material
from heavylift.solver.scene.scene import Fixed, FlexibleBody

LENGTH, SIDE = 1.0, 0.02
YOUNG, DENSITY = 210e9, 7850.0
BENDING = YOUNG * SIDE**4 / 12.0
"""E I [N m2]."""


@cache
def model(
    elements: int = 20, young: float = YOUNG, density: float = DENSITY, length: float = LENGTH
) -> FEModel:
    """A square bar along x from the origin, its axis the x axis; groups ``root`` and ``tip``."""
    half = SIDE / 2.0
    mesh = mesh_blocks(
        [Box("beam", (0.0, -half, -half), (length, half, half))],
        element_type="hex8",
        divisions={"x": [elements], "y": [2], "z": [2]},
        groups=(OnPlane("root", "x", 0.0), OnPlane("tip", "x", length)),
    )
    return assemble(mesh, Material(young, 0.0, density))


def moment_loads(bar: FEModel, points: Any) -> Loads:
    """Unit moments about the three axes at points, as forces on the nodes that make the rotation there."""
    forces = np.zeros((3 * bar.node_count, 3 * len(points)))
    for column, point in enumerate(points):
        assert bar.mesh is not None
        nodes, weights = bar.mesh.locate(point)
        around, turning = place_rotation(
            bar.nodes, bar.mesh, nodes[np.abs(weights) > 1e-9], weights @ bar.nodes[nodes]
        )
        rows = 3 * around[:, None] + np.arange(3)
        forces[rows[:, None], 3 * column + np.arange(3)[None, :, None]] = turning
    return Loads(forces, tuple(f"{point} moment {axis}" for point in points for axis in "xyz"))


@cache
def cantilever(
    elements: int = 20,
    modes: int = 8,
    points: tuple[tuple[float, float, float], ...] = (),
    young: float = YOUNG,
    free: bool = False,
    density: float = DENSITY,
    held: tuple[tuple[float, float, float], ...] = (),
    stiffening: bool = False,
) -> ReducedBody:
    """Clamped at the root, or free; with static vectors for forces at points, and for moments too at held places.

    With geometric stiffening if asked for.
    """
    bar = model(elements, young, density)
    clamp = np.empty(0, dtype=np.int64) if free else bar.node_groups["root"]
    flexibility = Flexibility(bar, clamp)
    basis: Basis = eigenmode_basis(eigenmodes(bar, modes, flexibility=flexibility))
    if points or held:
        basis += static_vectors(flexibility, place_loads(bar, (*points, *held)))
    if held:
        basis += static_vectors(flexibility, moment_loads(bar, held))
    reduced = reduce_body(bar, basis.vectors, basis.labels, fixed_nodes=clamp, mean_axis=free)
    if not stiffening:
        return reduced
    stiffness_of = stress_stiffness(bar)
    found = inertia_stiffening(flexibility, reduced, stiffness_of)
    if points:
        found = with_loads(
            found, flexibility, reduced, stiffness_of, place_loads(bar, points), np.array(points)
        )
    return replace(reduced, stiffening=found)


def beam(reduced: ReducedBody, **more: Any) -> FlexibleBody:
    """A body of it, its frame fixed unless a motion is given."""
    return FlexibleBody("beam", reduced, **{"motion": Fixed(), **more})
