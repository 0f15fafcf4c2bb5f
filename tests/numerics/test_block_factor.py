"""Block-sparse factor against dense NumPy: solutions, Schur complements, and what a broken pivot does."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.block_factor import backward_blocks, factor_blocks, forward_blocks
from heavylift.numerics.block_pattern import BlockPattern, pack_blocks
from heavylift.numerics.jit import kernel

OFFSET = 24  # of the vectors in their array


@kernel
def factor(shape, columns, updates, blocks, base, first, last, scratch):
    factor_blocks(shape, columns, updates, blocks, base, first, last, scratch)


@kernel
def forward(shape, columns, lower, blocks, base, first, last, x, x_at):
    forward_blocks(shape, columns, lower, blocks, base, first, last, x, x_at)


@kernel
def backward(shape, columns, lower, blocks, base, first, last, x, x_at):
    backward_blocks(shape, columns, lower, blocks, base, first, last, x, x_at)


class System:
    """Blocks and vectors of a pattern, with matrices put in and taken out."""

    def __init__(self, pattern: BlockPattern, *, base: int = 0) -> None:
        self.pattern, self.base = pattern, base
        self.rows, self.lanes = map(len, pattern.shape)
        self.blocks = np.zeros(base + pattern.size)
        self.x = np.zeros(OFFSET + pattern.rank.size * self.lanes)

    @property
    def vectors(self) -> np.ndarray:
        return self.x[OFFSET:].reshape(-1, self.lanes)[:, : self.rows]

    def index(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Where entries (row of a, column of b) stand, shape (n, rows, rows)."""
        places, swap = self.pattern.places(a, b)
        r = np.arange(self.rows)
        straight = r[None, :] * self.lanes + r[:, None]
        return self.base + places[:, None, None] + np.where(swap[:, None, None], straight.T, straight)

    def put(self, a: np.ndarray, b: np.ndarray, values: np.ndarray) -> None:
        self.blocks[self.index(a, b)] = values

    def factor(self, first: int, last: int) -> None:
        p = self.pattern
        factor(p.shape, p.columns, p.updates, self.blocks, self.base, first, last, p.scratch)

    def forward(self, first: int, last: int) -> None:
        p = self.pattern
        forward(p.shape, p.columns, p.lower, self.blocks, self.base, first, last, self.x, OFFSET)

    def backward(self, first: int, last: int) -> None:
        p = self.pattern
        backward(p.shape, p.columns, p.lower, self.blocks, self.base, first, last, self.x, OFFSET)

    def solve(self) -> None:
        count = len(self.pattern.columns)
        self.factor(0, count)
        self.forward(0, count)
        self.backward(0, count)


def grid_edges(nx: int, ny: int) -> np.ndarray:
    """Couplings of all nodes of each cell of a mesh of (nx + 1)(ny + 1) nodes."""
    number = np.arange((nx + 1) * (ny + 1)).reshape(nx + 1, ny + 1)
    corners = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
    edges = [
        np.stack([a.ravel(), b.ravel()], axis=1) for i, a in enumerate(corners) for b in corners[i + 1 :]
    ]
    return np.unique(np.sort(np.concatenate(edges), axis=1), axis=0)


def chain_edges(count: int) -> np.ndarray:
    return np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)


def positive_definite(rng: np.random.Generator, count: int, edges: np.ndarray, rows: int) -> np.ndarray:
    """Random matrix with this pattern, of order one and condition about ten, shape (count, rows, count, rows)."""
    matrix = np.zeros((count, rows, count, rows))
    values = rng.normal(size=(len(edges), rows, rows))
    a, b = edges.T
    matrix[a, :, b, :] = values
    matrix[b, :, a, :] = values.transpose(0, 2, 1)
    inner = rng.normal(size=(count, rows, rows))
    matrix[np.arange(count), :, np.arange(count), :] = inner + inner.transpose(0, 2, 1)
    flat = matrix.reshape(count * rows, -1)
    low, high = np.linalg.eigvalsh(flat)[[0, -1]]
    flat += np.eye(count * rows) * (0.1 * (high - low) - low)
    return matrix / (high - low)


def put_all(system: System, matrix: np.ndarray, edges: np.ndarray) -> None:
    every = np.concatenate([edges, np.repeat(np.arange(len(matrix))[:, None], 2, axis=1)])
    system.put(*every.T, matrix[every[:, 0], :, every[:, 1], :])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rows", "count", "edges"),
    [
        pytest.param(6, 40, chain_edges(40), id="frame"),
        pytest.param(6, 30, np.concatenate([chain_edges(30), [[0, 29], [7, 22]]]), id="frame with loops"),
        pytest.param(12, 63, grid_edges(8, 6), id="shell"),
        pytest.param(12, 44, np.concatenate([grid_edges(3, 4), grid_edges(3, 5) + 20]), id="two shells"),
        pytest.param(12, 20, np.stack(np.triu_indices(20, 1), axis=1), id="full matrix"),
        pytest.param(1, 63, grid_edges(8, 6), id="one row"),
        pytest.param(5, 35, grid_edges(6, 4), id="five rows"),
    ],
)
def test_solves_like_dense_numpy(rows, count, edges):
    rng = np.random.default_rng(rows)
    matrix = positive_definite(rng, count, edges, rows)
    system = System(pack_blocks(count, edges, rows), base=16)
    system.blocks[:16] = 7.0
    put_all(system, matrix, edges)
    right = rng.normal(size=(count, rows))
    system.vectors[:] = right
    system.solve()
    expected = np.linalg.solve(matrix.reshape(count * rows, -1), right.ravel())
    np.testing.assert_allclose(system.vectors.ravel(), expected, rtol=0.0, atol=1e-12 * abs(expected).max())
    assert np.all(system.blocks[:16] == 7.0)
    assert np.all(system.x[OFFSET:].reshape(-1, system.lanes)[:, rows:] == 0.0)


@pytest.mark.parametrize("rows", [6, 12])
def test_base_nodes_keep_the_schur_complement(rows):
    """Constraints J on bodies of stiffness A: ``-J A^-1 J^T``, ``-J A^-1 r``, then ``A^-1 (r + J^T p)``."""
    rng = np.random.default_rng(rows + 1)
    sizes, held = (35, 12), ((0, 17, 34), (5, 11))  # of two bodies; nodes that their constraints touch
    meshes = (grid_edges(6, 4), chain_edges(12))
    bodies, constraints, edges, bases = [], [], [], []
    first = 0
    for size, touched, mesh in zip(sizes, held, meshes, strict=True):
        nodes = first + np.arange(size)
        base = np.array([first + size, first + size + 1])
        links = np.array([(base[i % 2], nodes[t]) for i, t in enumerate(touched)])
        bodies.append((nodes, positive_definite(rng, size, mesh, rows)))
        constraints.append((base, links, rng.normal(size=(len(links), rows, rows))))
        edges += [mesh + first, links]
        bases.append(base.tolist())
        first += size + 2
    groups = np.repeat([0, 1], [sizes[0] + 2, sizes[1] + 2])
    system = System(pack_blocks(first, np.concatenate(edges), rows, last=bases, groups=groups), base=48)
    right, impulse = rng.normal(size=(2, first, rows))
    for (nodes, matrix), (_, links, values), mesh in zip(bodies, constraints, meshes, strict=True):
        every = np.concatenate([mesh, np.repeat(np.arange(len(nodes))[:, None], 2, axis=1)])
        system.put(*nodes[every].T, matrix[every[:, 0], :, every[:, 1], :])
        system.put(links[:, 0], links[:, 1], values)
        system.vectors[nodes] = right[nodes]

    for g in (0, 1):  # body by body
        system.factor(*system.pattern.ranges[g])
        system.forward(*system.pattern.ranges[g])

    for (nodes, matrix), (base, links, values) in zip(bodies, constraints, strict=True):
        J = np.zeros((2, rows, len(nodes), rows))
        J[links[:, 0] - base[0], :, links[:, 1] - nodes[0], :] = values
        A, J = matrix.reshape(len(nodes) * rows, -1), J.reshape(2 * rows, -1)
        r, p = right[nodes].ravel(), impulse[base].ravel()
        a, b = np.repeat(base, 2), np.tile(base, 2)
        schur = system.blocks[system.index(a, b)].reshape(2, 2, rows, rows).transpose(0, 2, 1, 3)
        expected = -J @ np.linalg.solve(A, J.T)
        np.testing.assert_allclose(schur.reshape(2 * rows, -1), expected, atol=1e-12 * abs(expected).max())
        rate = -J @ np.linalg.solve(A, r)
        np.testing.assert_allclose(system.vectors[base].ravel(), rate, atol=1e-12 * abs(rate).max())
        system.vectors[base] = -impulse[base]
        motion = np.linalg.solve(A, r + J.T @ p)
        g = int(groups[base[0]])
        system.backward(*system.pattern.ranges[g])
        np.testing.assert_allclose(system.vectors[nodes].ravel(), motion, atol=1e-12 * abs(motion).max())


def test_constraints_may_stand_among_the_eliminated_nodes():
    """A quasi-definite matrix has a factor in any order: R. J. Vanderbei, SIAM J. Optimization 5 (1995)."""
    rng = np.random.default_rng(9)
    count, edges, rows = 35, grid_edges(6, 4), 6
    matrix = positive_definite(rng, count, edges, rows)
    negative = rng.permutation(count)[:10]
    for a in negative:  # their couplings among each other turn round too
        matrix[a] *= -1.0
    for a in np.setdiff1d(np.arange(count), negative):
        matrix[a][:, negative] *= -1.0
    flat = matrix.reshape(count * rows, -1)
    np.testing.assert_allclose(flat, flat.T)
    system = System(pack_blocks(count, edges, rows))
    put_all(system, matrix, edges)
    right = rng.normal(size=(count, rows))
    system.vectors[:] = right
    system.solve()
    np.testing.assert_allclose(system.vectors.ravel(), np.linalg.solve(flat, right.ravel()), atol=1e-10)


def test_large_mesh_leaves_no_residual():
    """A mesh of the size in use, where panels are as wide as they get: ``A x = b`` with b of a known x."""
    rng = np.random.default_rng(4)
    nx, ny, rows = 24, 16, 12
    count, edges = (nx + 1) * (ny + 1), grid_edges(nx, ny)
    system = System(pack_blocks(count, edges, rows))
    values = rng.normal(size=(len(edges), rows, rows))
    diagonal = rng.normal(size=(count, rows, rows))
    diagonal = diagonal + diagonal.transpose(0, 2, 1) + 150.0 * np.eye(rows)
    a, b = edges.T
    system.put(a, b, values)
    system.put(np.arange(count), np.arange(count), diagonal)
    known = rng.normal(size=(count, rows))
    right = np.einsum("nij,nj->ni", diagonal, known)
    np.add.at(right, a, np.einsum("nij,nj->ni", values, known[b]))
    np.add.at(right, b, np.einsum("nij,ni->nj", values, known[a]))
    system.vectors[:] = right
    system.solve()
    np.testing.assert_allclose(system.vectors, known, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("rows", [6, 12])
@pytest.mark.parametrize("broken", [0.0, np.nan], ids=["zero pivot", "not a number"])
def test_broken_pivots_show_in_their_own_body_only(rows, broken):
    rng = np.random.default_rng(6)
    mesh = grid_edges(4, 3)
    edges = np.concatenate([mesh, mesh + 20])
    matrix = positive_definite(rng, 40, edges, rows)
    node = 7
    if broken == 0.0:
        matrix[node, 2] = 0.0  # a coordinate without mass or stiffness
        matrix[:, :, node, 2] = 0.0
    else:
        matrix[node, 2, node, 2] = broken
    system = System(pack_blocks(40, edges, rows))
    put_all(system, matrix, edges)
    right = rng.normal(size=(40, rows))
    system.vectors[:] = right
    system.solve()
    assert not np.isfinite(system.vectors[node, 2])
    whole = matrix[20:, :, 20:, :].reshape(20 * rows, -1)
    expected = np.linalg.solve(whole, right[20:].ravel())
    np.testing.assert_allclose(system.vectors[20:].ravel(), expected, atol=1e-11)
