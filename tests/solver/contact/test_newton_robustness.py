"""Solver of contacts on hard problems: closed forms, an independent slow solver, and invariance under other axes."""

from __future__ import annotations

import contact_problems as problems
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from heavylift.solver.contact.layout import (
    COMPLIANT,
    LINEAR,
)

pytestmark = pytest.mark.slow

RESIDUAL = 1e-10


def solved(problem, start=None):
    """Solve; the laws must hold by the solver's own measure and by that of `violation`."""
    status, _, residual, p, w = problem.solve(start)
    assert status >= 0
    assert residual <= RESIDUAL
    assert problems.violation(problem, p, w) <= 10.0 * RESIDUAL
    return p, w


def sweeps(problem, most=20_000):
    """Impulses by projected Gauss-Seidel sweeps on the full matrix: slow, and nothing but the laws."""
    mu = problem.parameters["friction"]
    A = problem.W + np.diag(problem.parameters["softness"].ravel())
    q = problem.N @ problem.y0 - problem.parameters["target"].ravel()
    sizes = [np.linalg.norm(A[i + 1 : i + 3, i + 1 : i + 3], 2) for i in range(0, len(q), 3)]
    p = np.zeros(len(q))
    for _ in range(most):
        before = p.copy()
        for c, size in enumerate(sizes):
            n, t = 3 * c, slice(3 * c + 1, 3 * c + 3)
            p[n] = max(0.0, p[n] - (A[n] @ p + q[n]) / A[n, n])
            trial = p[t] - (A[t] @ p + q[t]) / size
            p[t] = trial * min(1.0, mu[c] * p[n] / max(np.hypot(*trial), 1e-300))
        if np.abs(p - before).max() <= 1e-14 * np.abs(p).max():
            return p.reshape(-1, 3)
    raise AssertionError


def soften(problem, softness=0.03):
    """Softness relative to W, for one solution only and sweeps that come to an end."""
    d = problem.W.diagonal().reshape(-1, 3)
    problem.parameters["softness"] = softness * d.mean(axis=1)[:, None]
    return problem


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", ["stack", "resting", "tank"])
def test_velocities_against_sweeps(name, seed):
    rng = np.random.default_rng([21, seed])
    if name == "stack":
        problem = problems.stack(3, rng, 0.05)
    elif name == "resting":
        problem = problems.resting(rng, 6)
    else:
        problem = problems.tank_in_hull(rng, 10, 1e8, 0.1)
    soften(problem)
    p, w = solved(problem)
    expected = sweeps(problem)
    rates = (problem.N @ problem.y0 + problem.W @ expected.ravel()).reshape(-1, 3)
    scale = np.abs(problem.N @ problem.y0).max()
    np.testing.assert_allclose(w, rates, rtol=0.0, atol=1e-9 * scale)
    np.testing.assert_allclose(p, expected, rtol=0.0, atol=1e-8 * np.abs(expected).max())


def tower(masses, rng, push, mu=0.3, softness=1e-7):
    """Boxes of given masses upon each other."""
    problem = problems.stack(len(masses), rng, push, mu)
    B = problems.inverse_masses(np.asarray(masses), problems.BOX)
    contacts = [
        [
            (int(first), block.reshape(3, 6))
            for first, block in zip(ends[::2], blocks.reshape(2, 18), strict=True)
        ]
        for ends, blocks in zip(problem.ends, problem.blocks, strict=True)
    ]
    contacts = [
        parts if ends[3] > 0 else parts[:1] for parts, ends in zip(contacts, problem.ends, strict=True)
    ]
    return problems.build(contacts, problem.y0, B, mu, softness)


@pytest.mark.parametrize(
    "masses", [(1.0, 1e6), (1e6, 1.0), (1.0, 1e3, 1e6), (1e6, 1.0, 1e6), (1.0, 1e6, 1.0, 1e6)]
)
def test_mass_ratios(masses):
    for seed in range(10):
        rng = np.random.default_rng([22, seed])
        solved(tower(masses, rng, 10.0 ** rng.uniform(-3.0, 0.0), rng.choice([0.1, 0.3, 0.6])))


def test_weight_of_a_heavy_box_on_a_light_one():
    problem = tower((1.0, 1e6), np.random.default_rng(0), 0.0, softness=1e-14)
    p, w = solved(problem)
    totals = p[:, 0].reshape(2, 4).sum(axis=1)
    np.testing.assert_allclose(totals, [0.0981 * (1e6 + 1.0), 0.0981 * 1e6], rtol=1e-6)
    assert np.abs(w).max() < 1e-7


@pytest.mark.parametrize("push", [0.003, 0.03, 0.3])
@pytest.mark.parametrize("count", [10, 30])
def test_stacks_that_stick_and_slip(count, push):
    states = set()
    for seed in range(4):
        problem = problems.stack(count, np.random.default_rng([23, seed]), push)
        p, _ = solved(problem)
        size = np.hypot(p[:, 1], p[:, 2])
        pressed = p[:, 0] > 0.0
        states |= set(np.where(pressed, np.where(size > 0.299999 * p[:, 0], "slip", "stick"), "open"))
        problem.y0 *= 1.001
        solved(problem, p)
    assert {"slip", "stick"} <= states if push > 0.01 else "stick" in states


def test_pressure_of_600_coplanar_contacts_is_linear():
    rng = np.random.default_rng(5)
    arms = np.column_stack([rng.uniform(-1.0, 1.0, (600, 2)), np.full(600, -0.5)])
    half, mass = np.array([1.0, 1.0, 0.5]), 1e4
    y0 = np.array([0.0, 0.0, -0.0981, 0.02, -0.03, 0.0])  # pressed at one side more than at the other
    B = problems.inverse_masses(np.array([mass]), half)
    contacts = [[(0, problems.rows_at(problems.UP, arm))] for arm in arms]
    problem = problems.build(contacts, y0, B, 0.0, 1e-4)
    S = problem.parameters[0].softness[0]
    problem.parameters["softness"][:, 0] = S
    p, w = solved(problem)
    assert p[:, 0].min() > 0.0
    # p = -w / S, and w is linear in x and y: velocities from three balances
    rows = np.column_stack([np.ones(600), arms[:, 1], -arms[:, 0]])
    inverse = np.diag(B)[2:5]
    velocities = np.linalg.solve(np.diag(1.0 / inverse) + rows.T @ rows / S, y0[2:5] / inverse)
    np.testing.assert_allclose(w[:, 0], rows @ velocities, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(p[:, 0], -(rows @ velocities) / S, rtol=1e-8)


@pytest.mark.parametrize("angle", [0.2, 0.8, 1.4])
def test_block_in_a_wedge(angle):
    mass, contacts = 500.0, []
    for side in (-1.0, 1.0):
        frame = problems.frame_about(np.array([0.0, -side * np.sin(angle), np.cos(angle)]))
        for x in (-1.0, 1.0):
            arm = np.array([x, side * np.cos(angle), -np.sin(angle)])
            contacts.append([(0, problems.rows_at(frame, arm))])
    B = problems.inverse_masses(np.array([mass]), np.array([1.0, 0.5, 0.5]))
    y0 = np.array([0.0, 0.0, -0.0981, 0.0, 0.0, 0.0])
    p, w = solved(problems.build(contacts, y0, B, 0.0))
    np.testing.assert_allclose(p[:, 0], mass * 0.0981 / (4.0 * np.cos(angle)), rtol=1e-5)
    _, w = solved(problems.build(contacts, y0, B, 0.8))
    assert np.abs(w).max() < 1e-6


def test_bodies_in_any_order():
    plain = soften(problems.stack(12, np.random.default_rng(7), 0.03), 1e-3)
    expected, rates = solved(plain)
    for seed in range(5):
        order = np.random.default_rng(seed).permutation(12)
        place = np.argsort(order)
        columns = (6 * order[:, None] + np.arange(6)).ravel()
        ends = plain.ends.copy()
        for end in (0, 2):
            there = ends[:, end + 1] > 0
            ends[there, end] = 6 * place[ends[there, end] // 6]
        other = problems.ContactProblem(
            plain.kinds,
            plain.parameters,
            ends,
            plain.blocks,
            plain.y0[columns],
            np.ascontiguousarray(plain.B[np.ix_(columns, columns)]),
            plain.N[:, columns],
        )
        p, w = solved(other)
        np.testing.assert_allclose(w, rates, rtol=0.0, atol=1e-11)
        np.testing.assert_allclose(p, expected, rtol=0.0, atol=1e-7 * expected.max())


def test_inertia_in_any_axes():
    plain = soften(problems.stack(4, np.random.default_rng(8), 0.03), 1e-3)
    expected, rates = solved(plain)
    turn = np.eye(24)
    for i in range(4):
        T = np.eye(6)
        T[:3, :3], T[3:, 3:] = Rotation.random(2, random_state=i).as_matrix()
        T[3:, :3] = np.random.default_rng(i).normal(size=(3, 3))  # another point of reference: full blocks
        turn[6 * i : 6 * i + 6, 6 * i : 6 * i + 6] = T
    back = np.linalg.inv(turn)
    contacts = [
        [
            (
                int(ends[e]),
                blocks[9 * e : 9 * e + 18].reshape(3, 6) @ back[ends[e] : ends[e] + 6, ends[e] : ends[e] + 6],
            )
            for e in (0, 2)
            if ends[e + 1] > 0
        ]
        for ends, blocks in zip(plain.ends, plain.blocks, strict=True)
    ]
    B = turn @ plain.B @ turn.T
    other = problems.build(contacts, turn @ plain.y0, 0.5 * (B + B.T), 0.3)
    other.parameters[:] = plain.parameters
    p, w = solved(other)
    np.testing.assert_allclose(w, rates, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(p, expected, rtol=0.0, atol=1e-8 * expected.max())


@pytest.mark.parametrize("coupled", [False, True])
def test_ends_of_fewer_velocities(coupled):
    """Points with masses of their own, or all coupled, against the form on the matrix of the rows."""
    for seed in range(20):
        rng = np.random.default_rng([24, seed])
        B = np.zeros((12, 12))
        for i in range(4):
            root = rng.normal(size=(3, 3))
            B[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = root @ root.T + 0.1 * np.eye(3)
        if coupled:
            root = rng.normal(size=(12, 12))
            B += 0.1 * root @ root.T
        contacts = []
        for c in range(6):
            frame = problems.frame_about(rng.normal(size=3))
            parts = [(3 * (c % 4), frame)]
            if c > 1:
                parts.append((3 * ((c + 1) % 4), -frame))
            contacts.append(parts)
        problem = problems.build(contacts, rng.normal(size=12), B, 0.2, 1e-2)
        p, w = solved(problem)
        status, _, _, q, v = problem.solve_rows()
        assert status >= 0
        np.testing.assert_allclose(w, v, rtol=0.0, atol=1e-9 * np.abs(v).max())
        np.testing.assert_allclose(p, q, rtol=0.0, atol=1e-8 * np.abs(q).max())


@pytest.mark.parametrize("h", [1e-3, 1e-2])
@pytest.mark.parametrize("part", [-0.5, 1e-6])
def test_patch_with_elastic_slip_on_an_incline(part, h):
    """Springs of a patch under a block of 1 t, midpoint rule: closed forms of rest and of sliding."""
    mu, g, mass, k, members, steps = 0.5, 9.81, 1000.0, 1e7, 4, 1000
    slope = np.arctan(mu * (1.0 + part))
    weight = mass * g * np.array([-np.cos(slope), np.sin(slope), 0.0])
    normal, tangent = k / members, k / (1.5 * members)
    damping = np.sqrt(tangent * mass / members)
    v, x, depth, s = np.zeros(3), np.zeros(3), np.full(members, -weight[0] / k), np.zeros((members, 2))
    if part > 0.0:  # stretched by the weight
        s[:, 0] = weight[1] / (members * tangent)
    speeds = []
    S = 1.0 / (0.5 * h * (0.5 * h * tangent + damping))
    for _ in range(steps):
        problem = problems.build(
            [[(0, np.eye(3))]] * members, v + 0.5 * h * weight / mass, np.eye(3) / mass, mu
        )
        problem.kinds[:] = COMPLIANT, LINEAR
        told = problem.parameters
        told["stiffness"], told["damping"], told["step"] = normal, 0.1 * normal, h
        problem.parameters["depth"] = depth
        problem.parameters["softness"][:, 1:3] = S
        problem.parameters["target"][:, 1:3] = -S * 0.5 * h * tangent * s
        status, _, _, p, w = problem.solve()
        assert status >= 0
        v, x, depth = 2.0 * w[0] - v, x + h * w[0], depth - h * w[:, 0]
        s += h * w[:, 1:]
        slips = np.hypot(p[:, 1], p[:, 2]) >= mu * p[:, 0] * (1.0 - 1e-12)
        longest = 2.0 * mu * p[:, 0] / (h * tangent)
        s *= np.where(slips, np.minimum(1.0, longest / np.maximum(np.hypot(*s.T), 1e-300)), 1.0)[:, None]
        speeds.append(v[1])
    np.testing.assert_allclose(2.0 * p[:, 0] / h, -weight[0] / members, rtol=1e-12)
    if part < 0.0:
        np.testing.assert_allclose(x[1], weight[1] / (members * tangent), rtol=1e-9)
        assert abs(v[1]) < 1e-12
    else:
        expected = g * (np.sin(slope) - mu * np.cos(slope))
        np.testing.assert_allclose((speeds[-1] - speeds[500]) / (499 * h), expected, rtol=1e-6)
