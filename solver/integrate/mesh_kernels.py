"""Compiled parts of the statics of meshes: stresses and stiffness at the carried state, their own loads."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.solver.bodies.ancf.assembly import set_size
from heavylift.solver.bodies.ancf.elements import (
    add_follower_load,
    add_stiffness,
    add_stress_forces,
    find_strains,
)
from heavylift.solver.bodies.ancf.kind import (
    LOAD,
    LOAD_DATA,
    LOAD_PLACE,
    RIGHT,
    SHAPE_STRAIN,
    STEP_SET,
    TIME,
    TRIAL,
    Meshes,
    Q,
)
from heavylift.solver.bodies.ancf.loads import gather_loads
from heavylift.solver.bodies.ancf.step import add_gravity
from heavylift.solver.integrate.loop import evaluate_forces
from heavylift.solver.interface import FORCES, Bodies, Forces, Workspace

__all__ = [
    "difference_follower",
    "evaluate_loads",
    "fill_stiffness",
    "fill_stress_forces",
    "fill_weight_and_loads",
]


@kernel
def fill_stress_forces(kind: Meshes) -> None:
    """``B^T C e`` of the carried coordinates into row `RIGHT`."""
    for i in range(kind.nodal.shape[1]):
        kind.nodal[RIGHT, i] = 0.0
    for body in range(kind.table.shape[0]):
        find_strains(kind, body, Q, SHAPE_STRAIN)
        add_stress_forces(kind, body, Q, SHAPE_STRAIN, RIGHT, 1.0)


@kernel
def fill_stiffness(kind: Meshes) -> None:
    """Derivative of `fill_stress_forces` into the step set, which is made anew in each step."""
    size = set_size(kind)
    for i in range(STEP_SET * size, STEP_SET * size + size):
        kind.blocks[i] = 0.0
    for i in range(kind.nodal.shape[1]):
        kind.nodal[RIGHT, i] = 0.0
    for body in range(kind.table.shape[0]):
        find_strains(kind, body, Q, SHAPE_STRAIN)
        add_stiffness(kind, body, Q, SHAPE_STRAIN, RIGHT, 1.0, 1.0, 1.0)


@kernel
def fill_weight_and_loads(kind: Meshes, work: Workspace, time: float) -> None:
    """Weight into row `RIGHT`, loads of the mesh and forces of the markers into row `LOAD`."""
    for i in range(kind.nodal.shape[1]):
        kind.nodal[RIGHT, i] = 0.0
    for body in range(kind.table.shape[0]):
        kind.body[body, TIME] = time
        add_gravity(kind, body, work, 1.0)
    gather_loads(kind, Q, work)


@kernel
def difference_follower(
    kind: Meshes,
    body: int,
    load: int,
    factor: float,
    step: float,
    places: NDArray[np.int64],
    out: NDArray[np.float64],
) -> None:
    """Derivative of a follower load on an element by the coordinates at some places, shape (places, places)."""
    element, data = kind.loads[load, LOAD_PLACE], kind.loads[load, LOAD_DATA]
    count = places.shape[0]
    for i in range(count):
        kind.nodal[TRIAL, places[i]] = kind.nodal[Q, places[i]]
    for column in range(count):
        for side in range(2):
            sign = 1.0 - 2.0 * side
            kind.nodal[TRIAL, places[column]] = kind.nodal[Q, places[column]] + sign * step
            for i in range(count):
                kind.nodal[LOAD, places[i]] = 0.0
            add_follower_load(kind, body, TRIAL, element, LOAD, data, factor)
            for i in range(count):
                if side == 0:
                    out[i, column] = kind.nodal[LOAD, places[i]]
                else:
                    out[i, column] = (out[i, column] - kind.nodal[LOAD, places[i]]) / (2.0 * step)
        kind.nodal[TRIAL, places[column]] = kind.nodal[Q, places[column]]


@entry
def evaluate_loads(bodies: Bodies, forces: Forces, work: Workspace, time: float) -> None:
    """Markers and forces at the carried state."""
    evaluate_forces(bodies, forces, work, time, False, FORCES)
