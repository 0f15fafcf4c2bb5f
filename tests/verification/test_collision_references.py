"""References of the collision cases against a second way to the same numbers."""

from __future__ import annotations

import importlib.util
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy.integrate import solve_ivp

if TYPE_CHECKING:
    from types import ModuleType

CASES = Path(__file__).resolve().parents[2] / "cases"


def reference(case: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"reference_of_{case}", CASES / case / "make_reference.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("softness", [1, 10, 50])
def test_soft_touch_by_integration(softness: int) -> None:
    """Depth, peak and duration by DOP853; the impulse is the change of momentum and that of gravity."""
    case = reference("box_drop")
    one = case.soft_touch(softness)

    def force(y: np.ndarray) -> float:
        return one.stiffness * y[0] + one.damping * y[1]

    def gone(_: float, y: np.ndarray) -> float:
        return force(y)

    gone.terminal, gone.direction = True, -1.0  # type: ignore[attr-defined]
    found = solve_ivp(
        lambda _, y: [y[1], case.GRAVITY - force(y) / case.MASS, force(y)],
        (0.0, 1.0),
        [0.0, case.ARRIVAL, 0.0],
        "DOP853",
        events=gone,
        rtol=1e-12,
        atol=1e-12,
        dense_output=True,
    )
    end = found.t[-1]
    y = found.sol(np.linspace(0.0, end, 20001))
    assert end == pytest.approx(one.duration, rel=1e-9)
    assert y[1, -1] == pytest.approx(-case.DEPARTURE, rel=1e-9)
    assert y[0].max() == pytest.approx(one.peak(lambda t: one.depth(t)[0]), rel=1e-7)
    assert max(force(row) for row in y.T) == pytest.approx(one.peak(one.force), rel=1e-7)
    assert y[2, -1] == pytest.approx(
        case.MASS * (case.ARRIVAL + case.DEPARTURE + case.GRAVITY * end), rel=1e-9
    )


def test_published_depths_and_forces() -> None:
    """Table 2-6: depths to 0.015 m, forces to 9 %, which is what the printed graphs and the simulation allow."""
    case = reference("box_drop")
    for softness, (_, depth, force) in case.PUBLISHED.items():
        one = case.soft_touch(softness)
        assert one.peak(lambda t, one=one: one.depth(t)[0]) == pytest.approx(depth, abs=0.015)
        assert one.peak(one.force) == pytest.approx(force, rel=0.09)


def test_apexes_of_bounces() -> None:
    case = reference("box_drop")
    fall = np.sqrt(2.0 * case.DROP / case.GRAVITY)
    for e in (0.0, 0.5, 1.0):
        for n in (1, 2):
            apex = fall * (1.0 + 2.0 * sum(e**k for k in range(1, n)) + e**n)
            found = float(case.height(np.array([0.0, apex, 5.0]), e)[1])
            assert found == pytest.approx(e ** (2 * n) * case.DROP, abs=1e-12)


def test_rocking_block_two_ways() -> None:
    """Impact times by an integral of the energy, apexes by the energy, r by moments about the new edge."""
    case = reference("rocking_block")
    theta, impacts = case.motion()
    phi = case.apexes(len(impacts))
    quarters = np.array([case.quarter_period(value) for value in phi[: len(impacts)]])
    times = np.cumsum(quarters + np.concatenate([[0.0], quarters[1:]]))
    np.testing.assert_allclose([time for time, _ in impacts], times, rtol=0, atol=1e-7)
    assert np.abs(theta).max() == pytest.approx(case.START * case.ALPHA)
    b, h = case.HALF_WIDTH, case.HALF_HEIGHT
    square = b * b + h * h
    # moment about the new edge: that of the turning, (b^2 + h^2)/3, and of the centre moving with -h, -b at b, h
    assert (square / 3.0 + h * h - b * b) / (4.0 / 3.0 * square) == pytest.approx(case.RATIO)


def test_settling_stack_by_integration() -> None:
    """Newton's law of ten boxes with contacts that only push."""
    case = reference("stack")
    n, k, tau = case.SOFT_BOXES, case.SOFT_STIFFNESS, case.SOFT_TAU

    def right(_: float, y: np.ndarray) -> np.ndarray:
        squeeze, rate = np.diff(y[:n], prepend=0.0), np.diff(y[n:], prepend=0.0)
        push = np.maximum(k * (squeeze + tau * rate), 0.0)
        net = case.GRAVITY - (push - np.append(push[1:], 0.0)) / case.MASS
        return np.concatenate([y[n:], net])

    found = solve_ivp(right, (0.0, 2.0), np.zeros(2 * n), "DOP853", t_eval=case.TIMES, rtol=1e-11, atol=1e-13)
    table = case.references()["settling.csv"]
    np.testing.assert_allclose(found.y[[0, n - 1]].T, table[:, 1:3], rtol=0, atol=1e-10)
    assert table[-1, 2] == pytest.approx(case.depths(n, k).sum(), rel=0.02)
    assert case.contact_forces()[1:].min() > 0.0


def test_blow_on_links() -> None:
    """One link: P = m v0 / (1 + m r^2 / I), r along the plate; chains: nothing but the plate pushes from outside."""
    case = reference("links_drop")
    tilt = 0.3
    r = case.HALF * np.cos(tilt) - case.LIFT * np.sin(tilt)
    expected = case.MASS * case.SPEED / (1.0 + case.MASS * r**2 / case.INERTIA)
    assert case.blow(1, tilt)[0] == pytest.approx(expected)
    for count in (2, 5):
        impulse, after = case.blow(count, tilt)
        np.testing.assert_allclose(after[:, 0].sum(), 0.0, atol=1e-12)
        np.testing.assert_allclose(case.MASS * (after[:, 1] + case.SPEED).sum(), impulse)
        u = np.array([np.cos(tilt), np.sin(tilt)]) * case.HALF
        for a, b in pairwise(after):
            ends = [v[:2] + sign * v[2] * np.array([-u[1], u[0]]) for v, sign in ((a, 1.0), (b, -1.0))]
            np.testing.assert_allclose(*ends, atol=1e-12)


@pytest.mark.parametrize("degrees", [10, 30])
def test_roof_by_energy(degrees: int) -> None:
    case = reference("links_drop")
    tilt = np.radians(degrees)
    _, end, _, least = case.roof(tilt)
    assert case.flat_by_energy(tilt) == pytest.approx(end, abs=1e-9)
    assert least > 0.0


def test_tipping_box_in_cartesian_coordinates() -> None:
    """The same motion as a body in the plane with the force of the rim as a multiplier."""
    case = reference("unenclosed_box")

    def right(_: float, y: np.ndarray) -> np.ndarray:
        x, z, phi, u, w, rate = y
        sin, cos = np.sin(phi), np.cos(phi)
        # gap = x sin + z cos - c = 0; its gradient over (x, z, phi), and its second rate without accelerations
        row = np.array([sin, cos, x * cos - z * sin])
        rest = 2.0 * (u * cos - w * sin) * rate - (x * sin + z * cos) * rate**2
        masses = np.array([case.MASS, case.MASS, case.INERTIA])
        free = np.array([0.0, -case.GRAVITY, 0.0])
        push = -(row @ free + rest) / (row @ (row / masses))
        return np.concatenate([y[3:], free + push * row / masses])

    start, _ = case.after_blow()
    _, end, _ = case.tipping()
    table = case.references()["tipping.csv"]
    touching = table[:, 0] > case.FALL
    begin = [case.OFFSET, case.HALF, 0.0, 0.0, -case.OFFSET * start[3], start[3]]
    found = solve_ivp(
        right, (case.FALL, end), begin, "DOP853", t_eval=table[touching, 0], rtol=1e-12, atol=1e-13
    )
    np.testing.assert_allclose(found.y[:3].T, table[touching, 1:4], rtol=0, atol=1e-9)


def test_threshold_of_friction() -> None:
    case = reference("incline")
    for factor in (1.0 - 1e-6, 1.0, 1.0 + 1e-6):
        slope = case.FRICTION * factor
        theta = np.arctan(slope)
        expected = case.GRAVITY * (np.sin(theta) - case.FRICTION * np.cos(theta))
        assert case.acceleration(slope) == pytest.approx(expected, abs=1e-14)
    assert case.acceleration(case.FRICTION * (1.0 + 1e-6)) == pytest.approx(4.387164e-6, rel=2e-7)


def test_fall_of_the_bunny_by_a_grid() -> None:
    """On vertical lines, the lowest of one surface is at least as high over the highest of the other as it falls."""
    case = reference("bunnies")
    bunny = case.read_stl(CASES / "bunnies" / "bunny.stl")
    lower, upper = bunny + case.TWIN, case.turned(bunny) + case.FALLING
    touch, _ = case.first_touch()
    lines = np.stack(np.meshgrid(*(touch.place[k] + 2e-3 * np.arange(-20, 21) for k in (0, 1))), axis=-1)
    lines = np.concatenate([lines.reshape(-1, 2), np.zeros((41 * 41, 1))], axis=1)
    top = np.nanmax(np.nan_to_num(-case.over_triangles(lines, lower), nan=-np.inf), axis=1)
    bottom = np.nanmin(np.nan_to_num(-case.over_triangles(lines, upper), nan=np.inf), axis=1)
    least = (bottom - top).min()
    assert touch.distance <= least < touch.distance + 4e-3
    # the twin's point is on the triangle that touches it, which faces down
    assert touch.normal[2] > 0.0
    speed = np.sqrt(2.0 * case.GRAVITY * touch.distance)
    _, impulse, lost = case.blow(touch)
    assert lost == pytest.approx(0.5 * impulse * speed * touch.normal[2])
    assert lost < case.MASS * case.GRAVITY * touch.distance
