"""The system of all rows against a dense solution, for trees, loops and hubs."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.jit import kernel
from heavylift.solver.rows.solver import (
    assemble,
    assemble_without_absent,
    factor_present,
    factor_rows,
    smallest_pivot,
    solve_rows,
)
from heavylift.solver.rows.structure import (
    ABSENT,
    DIAGONAL,
    PRESCRIBED,
    Attachment,
    pack_rows,
)

GROUND = -1


@kernel
def solve(system, velocity):
    assemble(system)
    factor_rows(system)
    solve_rows(system, velocity)


@kernel
def solve_present(system, velocity):
    assemble_without_absent(system)
    factor_present(system)
    solve_rows(system, velocity)


@kernel
def solve_again(system, velocity):
    solve_rows(system, velocity)


@kernel
def pivot_of(system):
    return smallest_pivot(system)


def packed(edges, counts, body_count, rng, held=()):
    """A system with random rows, and its dense matrices."""
    inverse_mass = rng.uniform(0.5, 3.0, size=6 * body_count)
    for body in held:
        inverse_mass[6 * body : 6 * body + 6] = 0.0

    def attachment(body):
        if body == GROUND:
            return Attachment(GROUND, -1, 0, PRESCRIBED)
        return Attachment(body, 6 * body, 6, PRESCRIBED if body in held else DIAGONAL)

    sides = [(attachment(a), attachment(b)) for a, b in edges]
    system = pack_rows(counts, sides, [np.ones(n) for n in counts], inverse_mass, 0)
    lanes = len(system.shape[1])
    rows = system.rows
    total = sum(counts)
    G, Z, target = np.zeros((total, 6 * body_count)), np.zeros(total), np.zeros(total)
    first = 0
    for block, (pair, n) in enumerate(zip(edges, counts, strict=True)):
        for side, body in enumerate(pair):
            if body == GROUND:
                continue
            panel = rng.normal(size=(6, n))
            at = system.attachments[2 * block + side].panel
            system.panels[at : at + 6 * lanes].reshape(6, lanes)[:, :n] = panel
            G[first : first + n, 6 * body : 6 * body + 6] += panel.T
        Z[first : first + n] = rows[block].softness[:n] = rng.uniform(0.01, 0.1, size=n)
        target[first : first + n] = rows[block].target[:n] = rng.normal(size=n)
        first += n
    return system, G, np.diag(inverse_mass), Z, target


def impulses(system, counts):
    rows = system.rows
    return np.concatenate([rows[block].impulse[:n] for block, n in enumerate(counts)])


SCENES = {
    "chain": [(GROUND, 0), (0, 1), (1, 2), (2, 3)],
    "loops": [(GROUND, 0), (0, 1), (1, 2), (2, GROUND), (1, 3), (3, 0)],
    "parallel joints on one pair": [(0, 1), (0, 1), (1, 2)],
    "hub": [(GROUND, 0), *[(0, i) for i in range(1, 16)], (3, 4), (7, 8), (8, GROUND)],
    "two hubs": [*[(0, i) for i in range(2, 16)], *[(1, i) for i in range(2, 16)], (0, 1)],
}


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("held", [(), (2,)], ids=["free", "one prescribed"])
@pytest.mark.parametrize("sizes", [(1, 3, 5, 6), (1, 5, 8)], ids=["joints", "ropes"])
def test_solution_is_that_of_the_dense_system(name, held, sizes):
    rng = np.random.default_rng(len(name) + len(held))
    edges = SCENES[name]
    counts = [int(n) for n in rng.choice(sizes, size=len(edges))]
    body_count = 1 + max(max(pair) for pair in edges)
    system, G, W, Z, target = packed(edges, counts, body_count, rng, held)
    velocity = rng.normal(size=6 * body_count)
    moved = velocity.copy()
    solve(system, moved)

    expected = np.linalg.solve(G @ W @ G.T + np.diag(Z), target - G @ velocity)
    np.testing.assert_allclose(impulses(system, counts), expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(moved, velocity + W @ G.T @ expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("share", [0.4, 1.0])
def test_absent_blocks_are_left_out_whatever_stands_in_their_place(name, share):
    rng = np.random.default_rng(len(name))
    edges = SCENES[name]
    counts = [int(n) for n in rng.choice((1, 3, 5, 6), size=len(edges))]
    system, G, W, Z, target = packed(edges, counts, 1 + max(max(pair) for pair in edges), rng)
    absent = rng.random(len(edges)) < share
    gone = np.repeat(absent, counts)
    for block in np.flatnonzero(absent):
        n = counts[block]
        system.rows[block].softness[:n] = ABSENT
        system.rows[block].target[:n] = 0.0
    given = int(np.flatnonzero(absent)[0])  # a law that gives a force, however soft its row is, is not absent
    system.rows[given].target[0] = 0.5 * ABSENT
    Z[gone], target[gone] = ABSENT, 0.0
    target[sum(counts[:given])] = 0.5 * ABSENT
    velocity = rng.normal(size=len(W))
    moved = velocity.copy()
    system.blocks[:] = rng.normal(size=len(system.blocks))
    solve_present(system, moved)

    scale = 1.0 / np.sqrt(Z)
    right = scale * (target - G @ velocity)
    expected = scale * np.linalg.solve(scale[:, None] * (G @ W @ G.T + np.diag(Z)) * scale, right)
    np.testing.assert_allclose(impulses(system, counts), expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(moved, velocity + W @ G.T @ expected, rtol=1e-9, atol=1e-9)
    assert np.count_nonzero(system.present[: len(edges)]) == np.count_nonzero(~absent) + 1
    assert pivot_of(system) > 0.0


def test_a_second_solve_corrects_for_other_velocities():
    rng = np.random.default_rng(7)
    edges = SCENES["loops"]
    counts = [5] * len(edges)
    system, G, W, Z, target = packed(edges, counts, 4, rng)
    velocity, change = rng.normal(size=(2, 24))
    moved = velocity.copy()
    solve(system, moved)
    moved += change  # as a body does that re-evaluates its forces
    solve_again(system, moved)

    expected = np.linalg.solve(G @ W @ G.T + np.diag(Z), target - G @ (velocity + change))
    np.testing.assert_allclose(impulses(system, counts), expected, rtol=1e-9, atol=1e-9)


def test_a_hub_makes_no_clique():
    """40 joints on one body: without a node for it the factor would hold 40 * 41 / 2 blocks."""
    rng = np.random.default_rng(1)
    edges = [(0, i) for i in range(1, 41)]
    system, *_ = packed(edges, [3] * 40, 41, rng)
    assert len(system.lower) == 40


def test_chain_grows_in_proportion():
    rng = np.random.default_rng(1)
    sizes = []
    for count in (100, 200):
        edges = [(GROUND, 0), *[(i, i + 1) for i in range(count - 1)]]
        system, *_ = packed(edges, [5] * count, count, rng)
        sizes.append(len(system.blocks))
    assert sizes[1] < 2.02 * sizes[0]


def test_smallest_pivot_tells_a_redundant_row():
    """Two equal rows: the second pivot is what the softness leaves."""
    rng = np.random.default_rng(3)
    system, *_ = packed([(GROUND, 0), (GROUND, 0)], [1, 1], 1, rng)
    lanes = len(system.shape[1])
    rows = system.rows
    at = [int(system.attachments[i].panel) for i in (1, 3)]
    for k in range(6):
        system.panels[at[1] + k * lanes] = system.panels[at[0] + k * lanes]
    rows["softness"] = 1e-7
    rows["scale"] = 1.0
    solve(system, np.zeros(6))
    assert pivot_of(system) == pytest.approx(2e-7, rel=1e-3)
