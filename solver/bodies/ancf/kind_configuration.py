"""Frames and shells before time starts: their bases read and set as vectors of the whole scene, in Python.

A displacement or velocity of the bases goes to all nodes by ``E = M^-1 J^T (J M^-1 J^T)^+``: of all motions of the
mesh that give the bases what is wanted, the one with the least kinetic energy.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.bodies.ancf.at_rest import read_bases, spread_base
from heavylift.solver.bodies.ancf.kind import FrameMeshes, Meshes, ShellMeshes
from heavylift.solver.interface import Workspace, collect_load, move, put_velocity, survey
from heavylift.solver.kinds import implement

__all__: list[str] = []


def _nodes(kind: Meshes, body: int) -> slice:
    """Places of the nodes of a body."""
    lanes = len(kind.shape[1])
    first = int(kind.table[body].first_node) * lanes
    return slice(first, first + int(kind.table[body].node_count) * lanes)


def _spread(kind: Meshes, body: int, wanted: NDArray[np.float64]) -> NDArray[np.float64]:
    """Motion of all nodes that gives the bases what is wanted, flat over their places."""
    count = len(wanted)
    own = _nodes(kind, body)
    first = int(kind.table[body].first_base)
    places = np.add.outer(kind.bases["place"][first : first + count // 3], np.arange(3)).ravel()
    right = kind.right_hand_side
    motions = np.zeros((count, own.stop - own.start))
    compliance = np.zeros((count, count))
    for i in range(count):
        right[own] = 0.0
        right[places] = 0.0
        right[places[i]] = -1.0
        spread_base(kind, body)
        motions[i] = right[own]
        read_bases(kind, body, kind.right_hand_side, compliance[i])
    size = np.sqrt(np.diag(compliance))
    size[size == 0.0] = 1.0
    weights = np.linalg.pinv(compliance / np.outer(size, size), rcond=1e-11, hermitian=True) @ (wanted / size)
    return (weights / size) @ motions


@implement(survey, FrameMeshes)
@implement(survey, ShellMeshes)
def survey_meshes(
    kind: Meshes, places: NDArray[np.float64], inertia: NDArray[np.float64], velocity: NDArray[np.float64]
) -> None:
    """Centre of mass and mean velocity of the body; its mass for each velocity of a base."""
    for body, line in enumerate(kind.table):
        own = _nodes(kind, body)
        lanes, numbers = len(kind.shape[1]), kind.body[body]
        rotation = numbers.rotation
        rows = [
            nodal[own].reshape(-1, lanes)[:, : len(kind.shape[0])].reshape(-1, 3)
            for nodal in (kind.nodal_mass, kind.position)
        ]
        centre = (rows[0] * rows[1]).sum(axis=0) / numbers.mass
        places[line.number, 0] = line.dof
        places[line.number, 1:4] = numbers.origin + rotation @ centre
        places[line.number, 4:] = 1.0, 0.0, 0.0, 0.0
        count = 3 * int(line.base_count)
        inertia[line.dof : line.dof + count] = numbers.mass
        read_bases(kind, body, kind.velocity, velocity[line.dof : line.dof + count])


@implement(move, FrameMeshes)
@implement(move, ShellMeshes)
def move_meshes(kind: Meshes, increment: NDArray[np.float64]) -> None:
    """Displace the bases, and all nodes with them."""
    for body, line in enumerate(kind.table):
        wanted = increment[line.dof : line.dof + 3 * line.base_count]
        if np.any(wanted):
            kind.position[_nodes(kind, body)] += _spread(kind, body, wanted)


@implement(put_velocity, FrameMeshes)
@implement(put_velocity, ShellMeshes)
def put_mesh_velocity(kind: Meshes, velocity: NDArray[np.float64]) -> None:
    """Velocities of the bases; the other nodes change as little as possible."""
    for body, line in enumerate(kind.table):
        count = 3 * int(line.base_count)
        own, before = _nodes(kind, body), np.zeros(count)
        kind.mean_acceleration[own] = 0.0
        read_bases(kind, body, kind.velocity, before)
        change = velocity[line.dof : line.dof + count] - before
        if np.any(change):
            kind.velocity[own] += _spread(kind, body, change)


@implement(collect_load, FrameMeshes)
@implement(collect_load, ShellMeshes)
def collect_mesh_load(kind: Meshes, work: Workspace, load: NDArray[np.float64]) -> None:
    """Nothing: equilibrium of a mesh is found with all its coordinates, not with its bases."""
