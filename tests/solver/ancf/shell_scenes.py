"""Shells as the arrays of their kind, by hand: every pair of nodes of an element has a block of its own."""

from __future__ import annotations

from typing import Any

import numpy as np

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import records
from heavylift.solver.bodies.ancf import shell_elements  # noqa: F401  registers the kernels
from heavylift.solver.bodies.ancf.elements import (
    add_follower_load,
    add_stiffness,
    add_strain_rates,
    add_stress_forces,
    find_strains,
    measure_drift,
    measure_strain_energy,
    record_elements,
)
from heavylift.solver.bodies.ancf.kind import (
    NODAL_VECTORS,
    SHELL_PAIRS,
    STRAIN_VECTORS,
    MeshNumbers,
    ShellMeshElement,
    ShellMeshes,
    ShellPlaces,
)
from heavylift.solver.bodies.ancf.shell_packing import (
    body_constants,
    element_data,
    start_coordinates,
    strain_counts,
)
from heavylift.solver.scene.meshes import ShellBody, ShellSection
from tests.solver.groups import partly

LANES, BLOCK = 16, 12 * 16

STEEL = ShellSection(0.01, 7850.0, 2.1e11, 0.3)


def shell(mesh: Any, section: ShellSection = STEEL, **more: Any) -> ShellBody:
    """A body on a mesh of `heavylift.solver.scene.mesh_shapes`."""
    return ShellBody(
        name="plate",
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(section,),
        **more,
    )


def element(
    vectors: np.ndarray, lengths: tuple[float, float], section: ShellSection = STEEL, **more: Any
) -> ShellBody:
    """One element with nodal vectors of shape (4, 4, 3)."""
    return ShellBody(
        name="plate",
        nodes=vectors[:, 0].copy(),
        slopes=vectors[:, 1:].copy(),
        elements=np.array([[0, 1, 2, 3]]),
        lengths=np.array([lengths]),
        sections=(section,),
        **more,
    )


def distorted_element(section: ShellSection = STEEL, **more: Any) -> ShellBody:
    """One element whose lines are neither straight nor square to each other, in a plane of any direction."""
    a, b = 1.3, 0.8
    flat = np.zeros((4, 4, 3))
    flat[:, 0, :2] = [[0.0, 0.0], [1.4, 0.1], [1.2, 0.9], [-0.2, 0.7]]
    flat[:, 1, :2] = [[1.0, 0.2], [1.1, -0.1], [0.9, 0.1], [1.2, 0.1]]
    flat[:, 2, :2] = [[-0.3, 1.0], [-0.1, 1.1], [-0.2, 0.9], [-0.1, 1.0]]
    flat[:, 3, :2] = [[0.1, 0.05], [-0.1, 0.1], [0.1, -0.1], [0.05, 0.1]]
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    vectors = flat @ turn.T
    vectors[:, 0] += [3.0, -2.0, 1.0]
    return element(vectors, (a, b), section, **more)


def rotation() -> np.ndarray:
    """A rotation by an angle and axis of no meaning."""
    turn = np.linalg.qr(np.random.default_rng(8).normal(size=(3, 3)))[0]
    return turn * np.linalg.det(turn)


def pack(bodies: list[ShellBody], swaps: int = 0) -> ShellMeshes:
    """The kind of some shells; `swaps` seeds which blocks are stored transposed (none at 0)."""
    constants: list[np.ndarray] = []
    table, elements = (
        records(ShellPlaces, len(bodies)),
        records(ShellMeshElement, sum(len(b.elements) for b in bodies)),
    )
    number, nodes, start, strains, pairs = 0, 0, [], 0, 0
    rng = np.random.default_rng(swaps)

    def store(values: np.ndarray) -> int:
        place = sum(map(len, constants))
        constants.append(values)
        return place

    for row, body in zip(table, bodies, strict=True):
        row.constants = store(body_constants(body))
        row.first_element, row.element_count = number, len(body.elements)
        row.first_node, row.node_count = nodes, len(body.nodes)
        for own, data, count in zip(body.elements, element_data(body), strain_counts(body), strict=True):
            line = elements[number]
            line.nodes[:] = (nodes + own) * LANES
            line.data, line.strain = store(data), strains
            for p, (i, j) in enumerate(SHELL_PAIRS):
                line.blocks[p, 0] = pairs * BLOCK
                line.blocks[p, 1] = int(swaps and i != j and rng.integers(2))
                pairs += 1
            number += 1
            strains += int(count)
        nodes += len(body.nodes)
        start.append(start_coordinates(body).reshape(-1, 12))
    nodal = {name: np.zeros(nodes * LANES) for name in NODAL_VECTORS}
    put(nodal["position"], np.vstack(start))
    given = {
        "table": table,
        "elements": elements,
        "constants": np.concatenate(constants),
        "body": records(MeshNumbers, len(bodies)),
        **nodal,
        **{name: np.zeros(strains) for name in STRAIN_VECTORS},
        "blocks": np.zeros(pairs * BLOCK),
    }
    return partly(ShellMeshes, **given)


def put(nodal: np.ndarray, coordinates: np.ndarray) -> None:
    """Set a nodal vector to vectors of nodes, shape (n, 4, 3)."""
    nodal.reshape(-1, LANES)[:, :12] = coordinates.reshape(-1, 12)


def taken(nodal: np.ndarray) -> np.ndarray:
    """Vectors of nodes of a nodal vector, shape (n, 4, 3); checks that padding is left alone."""
    rows = nodal.reshape(-1, LANES)
    assert not rows[:, 12:].any()
    return rows[:, :12].reshape(-1, 4, 3).copy()


def stiffness(kind: ShellMeshes) -> np.ndarray:
    """The blocks as one matrix over all coordinates, shape (12 n, 12 n)."""
    nodes = kind.position.shape[0] // LANES
    out = np.zeros((nodes, 12, nodes, 12))
    for line in kind.elements:
        for p, (i, j) in enumerate(SHELL_PAIRS):
            place, swap = line.blocks[p]
            block = kind.blocks[place : place + BLOCK].reshape(12, LANES)
            assert not block[:, 12:].any()
            block = block[:, :12] if swap else block[:, :12].T
            m, n = line.nodes[i] // LANES, line.nodes[j] // LANES
            out[m, :, n] += block
            if i != j:
                out[n, :, m] += block.T
    return out.reshape(12 * nodes, 12 * nodes)


@kernel
def find(kind: ShellMeshes, body: int, q: Floats1, strain: Floats1) -> None:
    find_strains(kind, body, q, strain)


@kernel
def add_rates(kind: ShellMeshes, body: int, q: Floats1, v: Floats1, strain: Floats1, factor: float) -> None:
    add_strain_rates(kind, body, q, v, strain, factor)


@kernel
def add_forces(
    kind: ShellMeshes, body: int, q: Floats1, strain: Floats1, force: Floats1, factor: float
) -> None:
    add_stress_forces(kind, body, q, strain, force, factor)


@kernel
def add_both(
    kind: ShellMeshes,
    body: int,
    q: Floats1,
    strain: Floats1,
    force: Floats1,
    factor: float,
    scale: float,
    geometric: float,
) -> None:
    add_stiffness(kind, body, q, strain, force, factor, scale, geometric)


@kernel
def energy(kind: ShellMeshes, body: int, strain: Floats1) -> None:
    measure_strain_energy(kind, body, strain)


@kernel
def drift(kind: ShellMeshes, body: int, first: Floats1, second: Floats1) -> None:
    measure_drift(kind, body, first, second)


@kernel
def follow(
    kind: ShellMeshes, body: int, q: Floats1, number: int, load: Floats1, data: int, factor: float
) -> None:
    add_follower_load(kind, body, q, number, load, data, factor)


@kernel
def recorded(kind: ShellMeshes, body: int, row: np.ndarray) -> None:
    record_elements(kind, body, row)
