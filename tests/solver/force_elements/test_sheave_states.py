"""Which sheaves stick and which slide, against all states tried one after another in plain NumPy."""

from __future__ import annotations

import dataclasses
import itertools
from typing import Any

import numpy as np
import pytest
from law_scenes import G, body, eye, pulley, run, scene, wire

from heavylift.solver.force_elements.sheave_states import find_states, make_search
from heavylift.solver.joints.slider import Slider
from heavylift.solver.scene.connections import GROUND, JointFrame, axes_about
from heavylift.solver.scene.scene import Scene


def solve_by_trial(a: Any, b: Any, q: Any, eta: Any) -> list[tuple[Any, Any]]:
    """States and frictions that contradict nothing.

    Tensions before and beyond each sheave, and flows, are each a constant and a matrix of the frictions.
    """
    m, found = len(eta), []
    for states in itertools.product((-1, 0, 1), repeat=m):
        rows = [
            (q[0][j], q[1][j])
            if s == 0
            else (b[0][j] - a[0][j] * eta[j] ** -s, b[1][j] - a[1][j] * eta[j] ** -s)
            for j, s in enumerate(states)
        ]
        f = np.linalg.solve(np.array([row[1] for row in rows]), [-row[0] for row in rows])
        before, beyond, flow = (x[0] + x[1] @ f for x in (a, b, q))
        small = 1e-9 * np.abs(beyond).max(), 1e-9 * np.abs(flow).max()
        if all(
            s * flow[j] >= -small[1]
            if s
            else eta[j] * before[j] <= beyond[j] + small[0] and eta[j] * beyond[j] <= before[j] + small[0]
            for j, s in enumerate(states)
        ):
            found.append((np.array(states), f))
    return found


@pytest.mark.parametrize("sheaves", [[1], [3], [2, 3], [6]], ids=str)
@pytest.mark.parametrize("spread", [1.0, 6.0])
def test_search_finds_what_trial_finds(sheaves: list[int], spread: float) -> None:
    """Ropes that are coupled by any mobility of their parts, with eigenvalues some factors of e apart."""
    rng = np.random.default_rng(sum(sheaves))
    for _ in range(40 if sum(sheaves) < 6 else 8):
        parts = np.add(sheaves, 1)
        n, m = sum(parts), sum(sheaves)
        rope_of_part = np.repeat(np.arange(len(parts)), parts)
        axes = np.linalg.qr(rng.normal(size=(n, n)))[0]
        mobility = axes @ np.diag(np.exp(-rng.uniform(0.0, spread, n))) @ axes.T
        rate = mobility @ rng.uniform(0.3, 1.5, n)
        whole = (rope_of_part[None, :] == np.arange(len(parts))[:, None]).astype(float)
        weight = np.concatenate([rng.dirichlet(np.full(count, 3.0)) for count in parts])
        flows, share, before = [], [], []
        for last in np.cumsum(parts) - 1:
            r = rope_of_part[last]
            for k in np.flatnonzero(rope_of_part == r)[:-1]:
                beyond = (rope_of_part == r) & (np.arange(n) > k)
                share.append(weight[beyond].sum())
                flows.append(beyond - share[-1] * whole[r])
                before.append(k)
        H = np.array(flows)
        stiffness = np.exp(rng.uniform(0.0, 3.0, len(parts)))
        A = np.eye(len(parts)) + stiffness[:, None] * (whole @ mobility @ whole.T)
        mean = np.linalg.solve(A, rng.uniform(0.5, 1.5, len(parts)) + stiffness * (whole @ rate))
        by = -np.linalg.solve(A, stiffness[:, None] * (whole @ mobility @ H.T))
        tension = whole.T @ mean, whole.T @ by + H.T
        flow = H @ (rate - mobility @ tension[0]), -H @ mobility @ tension[1]
        eta = rng.uniform(0.6, 1.0, m)
        expected = solve_by_trial(
            tuple(x[before] for x in tension), tuple(x[np.add(before, 1)] for x in tension), flow, eta
        )
        search = make_search(m, len(parts))
        search.counts.sheaves = m
        at = 0.1 * rng.normal(size=m)
        search.rope[:], search.share[:] = np.repeat(np.arange(len(parts)), sheaves), share
        search.loss[:], search.force[:], search.creep[:] = 1.0 - eta, at, 1e-12
        search.flow[:], search.tension[:] = flow[0] + flow[1] @ at, mean + by @ at
        search.response[...], search.stiffness[...] = flow[1], by
        assert find_states(search)
        assert len(expected) == 1
        np.testing.assert_array_equal(search.branch, expected[0][0])
        np.testing.assert_allclose(search.force, expected[0][1], rtol=1e-7, atol=1e-9)


RADIUS, DEPTH, EA, STEP = 0.4, 3.0, 6e8, 1e-2


def hanging(masses: Any, eta: float) -> Scene:
    """Pulleys on vertical guides on one rope, with fixed sheaves between them."""
    path, bodies, joints = [eye(GROUND, (-RADIUS, 0, 0))], [], []
    for i, mass in enumerate(masses):
        x = 4.0 * RADIUS * i
        bodies.append(body(f"p{i}", mass, (x, 0, -DEPTH)))
        path.append(pulley(f"p{i}", (0, 0, 0), RADIUS, -1.0))
        path.append(pulley(GROUND, (x + 2.0 * RADIUS, 0, 0), RADIUS))
        frames = [JointFrame(np.array(at), axes_about((0.0, 0.0, 1.0))) for at in ((x, 0, -DEPTH), (0, 0, 0))]
        joints.append(
            Slider(name=f"g{i}", body_a=GROUND, body_b=f"p{i}", frame_a=frames[0], frame_b=frames[1])
        )
    path = [dataclasses.replace(p, efficiency=eta) if p.radius else p for p in path[:-1]]
    path.append(eye(GROUND, (4.0 * RADIUS * (len(masses) - 1) + RADIUS, 0, 0)))
    tension = 0.5 * G * float(np.mean(masses))
    return scene(bodies, joints=joints, ropes=[wire(*path, stiffness=EA, tension=tension)])


def first_step(masses: Any, eta: float) -> list[tuple[Any, Any]]:
    """Of these: states, and speeds downwards after a step from rest."""
    n = len(masses)
    length = np.full(2 * n, DEPTH + 0.5 * np.pi * RADIUS * 2.0)
    length[[0, -1]] -= 0.5 * np.pi * RADIUS
    tension = 0.5 * G * np.mean(masses)
    rest = length.sum() / (1.0 + tension / EA)
    on = np.repeat(np.eye(n), 2, axis=0)  # rates of the parts by the speeds of the pulleys
    share = np.array([length[j + 1 :].sum() for j in range(2 * n - 1)]) / length.sum()
    H = np.tril(np.ones((2 * n, 2 * n)), -1)[:, : 2 * n - 1].T - share[:, None]
    B = np.diag(0.5 * STEP / np.asarray(masses))  # speed in the middle of the step by a force
    k, one = EA / rest, np.ones(2 * n)
    stretch = on.T @ one
    D = 1.0 + k * 0.5 * STEP * stretch @ B @ stretch
    mean = (tension + k * 0.5 * STEP * stretch @ B @ (np.asarray(masses) * G)) / D
    by = -k * 0.5 * STEP * stretch @ B @ on.T @ H.T / D
    T = mean * one, np.outer(one, by) + H.T
    speed = B @ (np.asarray(masses) * G - on.T @ T[0]), -B @ on.T @ T[1]
    softness = 1e-13 * np.eye(2 * n - 1)  # shares frictions that nothing moves between
    flow = H @ on @ speed[0], H @ on @ speed[1] - softness
    found = solve_by_trial((T[0][:-1], T[1][:-1]), (T[0][1:], T[1][1:]), flow, np.full(2 * n - 1, eta))
    return [(states, 2.0 * (speed[0] + speed[1] @ f)) for states, f in found]


@pytest.mark.parametrize(("count", "eta"), [(2, 0.96), (3, 0.98), (3, 0.9), (4, 0.95)])
def test_pulleys_on_many_bodies_begin_as_by_trial(count: int, eta: float) -> None:
    """A step of pulleys of random masses: of all 3^(2 n - 1) states one is right, and that is the one."""
    rng = np.random.default_rng(count)
    for _ in range(3):
        masses = 6e4 * (1.0 + rng.uniform(-0.25, 0.25, count))
        expected = first_step(masses, eta)
        assert expected
        result = run(hanging(masses, eta), STEP, STEP)
        speeds = [-result[f"p{i}.velocity"][-1, 2] for i in range(count)]
        miss = [np.abs(v - speeds).max() for _, v in expected]
        assert min(miss) < 1e-6 * G * STEP


def test_many_pulleys_stick_and_slide_as_friction_says() -> None:
    """Every ratio of tensions is within what friction holds, each sheave that slides loses power, energy is closed."""
    rng = np.random.default_rng(5)
    for spread in (0.02, 0.2, 0.6):
        masses = 6e4 * (1.0 + spread * rng.uniform(-0.5, 0.5, 5))
        result = run(hanging(masses, 0.95), STEP, 0.5)
        T, q = result["rope.segment_tension"][1:], result["rope.sheave_speed"][1:]
        ratio = T[:, 1:] / T[:, :-1]
        assert ratio.min() > 0.95 * (1.0 - 1e-9)
        assert ratio.max() < (1.0 + 1e-9) / 0.95
        assert ((T[:, 1:] - T[:, :-1]) * q).min() > -1e-9 * T.max()
        assert result.balance < 1e-6 * (1.0 + result["energy.kinetic"].max())
