"""Friction of a line bearing: its energy, its limit, and the path of a point that sticks and slides, in plain NumPy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from heavylift.numerics.jit import in_python
from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, run_case
from heavylift.solver.force_elements.line_bearing import rub as rub_kernel

rub = in_python(rub_kernel)
K, LIMIT = 5e7, 2e4


def crept(e: NDArray[np.float64], way: NDArray[np.float64], parts: int) -> tuple[NDArray[np.float64], float]:
    """Displacement and work of friction: sticks within the limit, else is pulled along, in many small parts."""
    work, step = 0.0, way / parts
    for _ in range(parts):
        before = e
        e = e + step
        size = float(np.linalg.norm(e))
        if size > LIMIT / K:
            e = e * (LIMIT / K / size)
        work += float(0.5 * K * (before + e) @ step)
    return e, work


def test_path_of_a_point_that_sticks_and_slides() -> None:
    """To and fro along a line, whatever the steps; around a circle within what steps resolve."""
    e, done = np.zeros(2), 0.0
    truth, spent = np.zeros(2), 0.0
    for x in (3e-4, 5e-4, -2e-4, -3e-3, 4e-3, 1e-5):
        fx, fy, *end, _, _, _ = rub(*e, x, 0.0, K, LIMIT)
        done += fx * x + fy * 0.0
        e = np.array(end)
        truth, work = crept(truth, np.array([x, 0.0]), 20_000)
        spent += work
        np.testing.assert_allclose(e, truth, atol=1e-12)
    assert done == pytest.approx(spent, rel=1e-4)
    angles = np.linspace(0.0, 2.0 * np.pi, 401)
    turns = 2e-3 * np.column_stack([np.cos(angles), np.sin(angles)])
    e, done, truth, spent = np.zeros(2), 0.0, np.zeros(2), 0.0
    for way in np.diff(turns, axis=0):
        fx, fy, *end, _, _, _ = rub(*e, *way, K, LIMIT)
        done += fx * way[0] + fy * way[1]
        e = np.array(end)
        truth, work = crept(truth, way, 200)
        spent += work
    np.testing.assert_allclose(e, truth, atol=0.01 * LIMIT / K)
    assert done == pytest.approx(spent, rel=2e-3)


def test_friction_keeps_its_energy_and_its_limit() -> None:
    """``F . d`` is what is stored and what is lost, which is not negative; the slope along the way."""
    rng = np.random.default_rng(7)
    for _ in range(500):
        e = rng.normal(size=2) * 4e-4
        way = rng.normal(size=2) * 10.0 ** rng.uniform(-6, -1)
        limit = LIMIT * rng.uniform(0.0, 2.0)
        fx, fy, ax, ay, lost, _, _ = rub(*e, *way, K, limit)
        stored = 0.5 * K * (ax * ax + ay * ay - e @ e)
        assert lost >= 0.0
        assert fx * way[0] + fy * way[1] == pytest.approx(stored + lost, abs=1e-9 * (K * e @ e + limit))
        assert np.hypot(fx, fy) <= limit * (1.0 + 1e-12)
        assert K * np.hypot(ax, ay) <= limit * (1.0 + 1e-12)
    for angle in rng.uniform(
        0.0, 6.3, 200
    ):  # at rest at its limit, which rounding puts beyond it now and then
        e = 1.5 * LIMIT / K * np.array([np.cos(angle), np.sin(angle)])
        fx, fy, ax, ay, *_ = rub(*e, 0.0, 0.0, K, LIMIT)
        np.testing.assert_allclose(
            [fx, fy, K * ax, K * ay], np.tile(e * LIMIT / np.hypot(*e), 2), rtol=1e-12, atol=1e-9
        )
    for x in (1e-5, 1e-3, -2e-3):
        fx, *_, slope, _ = rub(1e-4, 0.0, x, 0.0, K, LIMIT)
        ahead, behind = (rub(1e-4, 0.0, x + d, 0.0, K, LIMIT)[0] for d in (1e-9, -1e-9))
        assert slope == pytest.approx((ahead - behind) / 2e-9, rel=1e-4)


SCENE = """
title = "a beam on a shelf"
[gravity]
acceleration = [0, 0, -9.81]
[bodies.beam]
type = "rigid"
mass = 1000
inertia = [100, 100, 100]
frame = { motion = "free" }
[[forces]]
name = "rest"
type = "line_bearing"
between = ["ground", "beam"]
points = [[0, 0, 0], [PLACE, 0, HEIGHT]]
inward = INWARD
deck_length = 4
length = 2
stiffness = 1e7
[simulate]
duration = 0.1
output_interval = 0.1
step = 0.01
"""


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"PLACE": -1}, "its line is 1 m before the border of the deck at the start"),
        ({"PLACE": 5}, "its line is 1 m behind the end of the deck at the start"),
        ({"HEIGHT": -1}, "its line is 1 m below the plane at the start"),
        ({"INWARD": [1, 0, 0.5]}, r"\[1.0, 0.0, 0.5\] leans against the normal \[0.0, 0.0, 1.0\]"),
        ({"INWARD": [0, 0, 0]}, "a direction of length zero"),
    ],
)
def test_refused(tmp_path: Path, change: dict[str, object], words: str) -> None:
    text = SCENE
    for key, value in ({"PLACE": 1, "HEIGHT": 0, "INWARD": [1, 0, 0]} | change).items():
        text = text.replace(key, str(value))
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=words):
        run_case(load_case(tmp_path), stages=("simulate",))
