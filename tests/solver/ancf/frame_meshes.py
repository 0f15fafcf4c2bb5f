"""Packs one frame into a `FrameMeshes` whose blocks do not overlap: a place of its own for each pair of nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.jit import kernel
from heavylift.numerics.records import records
from heavylift.solver.bodies.ancf import elements as generics
from heavylift.solver.bodies.ancf import frame_elements  # noqa: F401  implements the generic functions
from heavylift.solver.bodies.ancf.frame_packing import (
    body_constants,
    element_data,
    start_coordinates,
    strain_counts,
)
from heavylift.solver.bodies.ancf.kind import (
    FRAME_PAIRS,
    NODAL_VECTORS,
    STRAIN_VECTORS,
    FrameMeshes,
    FramePlaces,
    MeshElement,
    MeshNumbers,
)
from tests.solver.groups import partly

if TYPE_CHECKING:
    from heavylift.solver.scene.meshes import FrameBody

__all__ = ["get", "matrix", "pack", "put"]

LANES = 8


def pack(body: FrameBody, *, swap: bool = False) -> FrameMeshes:
    """The kind of one frame, in its start shape; `swap` stores the pairs of different nodes transposed."""
    count, nodes = len(body.elements), len(body.nodes)
    known: dict[int, int] = {}
    constants = [body_constants(body), np.zeros(64)]
    size = 1 + 64
    elements = records(MeshElement, count)
    for e, data in enumerate(element_data(body)):
        if id(data) not in known:
            known[id(data)] = size
            constants.append(data)
            size += len(data)
        elements[e].nodes[:2] = LANES * body.elements[e]
        elements[e].data = known[id(data)]
    strains = strain_counts(body)
    elements["strain"] = np.cumsum(strains) - strains
    for p, (i, j) in enumerate(FRAME_PAIRS):
        elements["blocks"][:, p, 0] = 48 * (3 * np.arange(count) + p)
        elements["blocks"][:, p, 1] = int(swap and i != j)
    table = records(FramePlaces, 1)
    line = table[0]
    line.node_count, line.element_count, line.strain_count = nodes, count, strains.sum()
    used = {
        "table": table,
        "elements": elements,
        "constants": np.concatenate(constants),
        "body": records(MeshNumbers, 1),
        **{name: np.zeros(LANES * nodes) for name in NODAL_VECTORS},
        **{name: np.zeros(int(strains.sum())) for name in STRAIN_VECTORS},
        "blocks": np.zeros(48 * 3 * count),
    }
    kind = partly(FrameMeshes, **used)
    put(kind.position, start_coordinates(body).ravel())
    return kind


def put(nodal: np.ndarray, q: np.ndarray) -> None:
    """Coordinates, six a node, into a nodal vector."""
    nodal.reshape(-1, LANES)[:, :6] = q.reshape(-1, 6)


def get(nodal: np.ndarray) -> np.ndarray:
    """Coordinates of a nodal vector, six a node; what lies in the padding must be zero."""
    rows = nodal.reshape(-1, LANES)
    assert not np.any(rows[:, 6:])
    return rows[:, :6].ravel().copy()


def matrix(kind: FrameMeshes) -> np.ndarray:
    """All blocks as one dense symmetric matrix."""
    size = 6 * kind.table[0].node_count
    total = np.zeros((size, size))
    for row in kind.elements:
        for p, (i, j) in enumerate(FRAME_PAIRS):
            at, swapped = row.blocks[p]
            block = kind.blocks[at : at + 48].reshape(6, LANES)
            assert not np.any(block[:, 6:])
            entry = block[:, :6] if swapped else block[:, :6].T
            a, b = 6 * (row.nodes[i] // LANES), 6 * (row.nodes[j] // LANES)
            total[a : a + 6, b : b + 6] += entry
            if i != j:
                total[b : b + 6, a : a + 6] += entry.T
    return total


@kernel
def find_strains(kind, body, q, strain):
    generics.find_strains(kind, body, q, strain)


@kernel
def add_strain_rates(kind, body, q, v, strain, factor):
    generics.add_strain_rates(kind, body, q, v, strain, factor)


@kernel
def add_stress_forces(kind, body, q, strain, force, factor):
    generics.add_stress_forces(kind, body, q, strain, force, factor)


@kernel
def add_stiffness(kind, body, q, strain, force, factor, scale, geometric):
    generics.add_stiffness(kind, body, q, strain, force, factor, scale, geometric)


@kernel
def measure_strain_energy(kind, body, strain):
    generics.measure_strain_energy(kind, body, strain)


@kernel
def measure_drift(kind, body, first, second):
    generics.measure_drift(kind, body, first, second)


@kernel
def add_follower_load(kind, body, q, element, load, data, factor):
    generics.add_follower_load(kind, body, q, element, load, data, factor)


@kernel
def record_elements(kind, body, row):
    generics.record_elements(kind, body, row)
