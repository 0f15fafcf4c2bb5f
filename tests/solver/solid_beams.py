"""Cantilevers of bricks with modes, for tests of bodies whose places have elements around them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from heavylift.modal.bases import Basis, eigenmode_basis, place_loads, static_vectors
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility
from heavylift.modal.reduced import ReducedBody
from heavylift.modal.reduction import reduce_body
from heavylift.modal.stiffening import inertia_stiffening, stress_stiffness, with_loads
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
def model(elements: int = 20, young: float = YOUNG, density: float = DENSITY) -> FEModel:
    """A square bar along x from the origin, its axis the x axis; groups ``root`` and ``tip``."""
    half = SIDE / 2.0
    mesh = mesh_blocks(
        [Box("beam", (0.0, -half, -half), (LENGTH, half, half))],
        element_type="hex8",
        divisions={"x": [elements], "y": [2], "z": [2]},
        groups=(OnPlane("root", "x", 0.0), OnPlane("tip", "x", LENGTH)),
    )
    return assemble(mesh, Material(young, 0.0, density))


@cache
def cantilever(
    elements: int = 20,
    modes: int = 8,
    points: tuple[tuple[float, float, float], ...] = (),
    young: float = YOUNG,
    free: bool = False,
    stiffening: bool = False,
) -> ReducedBody:
    """Clamped at the root, or free; with static vectors for forces at points, and with geometric stiffening."""
    bar = model(elements, young)
    clamp = np.empty(0, dtype=np.int64) if free else bar.node_groups["root"]
    flexibility = Flexibility(bar, clamp)
    basis: Basis = eigenmode_basis(eigenmodes(bar, modes, flexibility=flexibility))
    if points:
        basis += static_vectors(flexibility, place_loads(bar, points))
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
