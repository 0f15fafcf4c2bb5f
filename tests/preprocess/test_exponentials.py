"""Sums of exponentials: known poles come back, published kernels are fitted, and no fit makes waves from nothing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics import exponentials as passivity
from heavylift.preprocess.hydrodynamics.exponentials import (
    ExponentialKernel,
    common_poles,
    damping_functions,
    fit_exponentials,
    make_passive,
)
from heavylift.preprocess.hydrodynamics.retardation import channel_scales, retardation_kernel

MARINE = Path(__file__).resolve().parents[1] / "reference_data" / "marine"
TIMES = 0.1 * np.arange(401)


def lowest(fit: ExponentialKernel) -> float:
    """Smallest eigenvalue of the damping relative to the largest, on a grid that knows nothing of the poles."""
    w = np.concatenate([[0.0], np.logspace(-5, 5, 6000), np.linspace(0.0, 8.0, 16001)])
    damping = fit.damping_at(w)
    scale = np.sqrt(np.einsum("kii->ki", damping).max(axis=0))
    scale[scale == 0.0] = 1.0
    values = np.linalg.eigvalsh(damping / np.outer(scale, scale))
    return float(values.min() / values.max())


def sphere_kernel() -> np.ndarray:
    """Heave of a hemisphere of radius 5 m from Hulme's table, B / (rho V w) = 3 pi ka / 4 for long waves."""
    table = np.loadtxt(MARINE / "hemisphere_heave_hulme.csv", delimiter=",", skiprows=2)
    curve = CubicSpline(
        np.append(0.0, table[:, 0]), np.append(0.0, table[:, 2]), bc_type=((1, 0.75 * np.pi), "not-a-knot")
    )
    ka = 10.0 * np.linspace(0.0, 1.0, 400)[1:] ** 2
    w = np.sqrt(9.81 * ka / 5.0)
    return retardation_kernel(w, (curve(ka) * w)[:, None, None])(TIMES)


def barge_kernel(surge_pitch: float, sway_roll: float) -> np.ndarray:
    """Damping of the box barge, with the two couplings as a part of what is physically possible."""
    table = np.genfromtxt(MARINE / "tb_box_barge_bem.csv", delimiter=",", names=True, skip_header=1)
    damping = np.zeros((20, 6, 6))
    for i in range(6):
        damping[:, i, i] = table[f"B{i + 1}{i + 1}"][:-1]
    for i, j, part in ((0, 4, surge_pitch), (1, 3, sway_roll)):
        damping[:, i, j] = damping[:, j, i] = part * np.sqrt(damping[:, i, i] * damping[:, j, j])
    return retardation_kernel(table["omega_rad_s"][:-1], damping)(TIMES)


def relative_error(fit: ExponentialKernel, K: np.ndarray) -> float:
    scale = channel_scales(K)
    return float((np.abs(fit(TIMES) - K) / np.outer(scale, scale)).max())


def test_known_poles_come_back() -> None:
    s = np.array([-0.9, -0.25 + 0.8j, -0.4 + 1.9j])
    residues = np.array([[1.0, 0.4], [2.0 - 1j, 0.3], [0.5, -0.7 + 0.2j]])
    series = np.exp(np.outer(TIMES, s)) @ residues
    found = common_poles(series.real, 0.1, 5)
    np.testing.assert_allclose(found, s, atol=1e-9)


def test_a_passive_sum_of_exponentials_is_reproduced() -> None:
    """K_ij = v_i v_j exp(-a t)(cos b t - a/b sin b t): damping 4 a w^2 ... >= 0, and none at zero frequency."""
    K = np.zeros((401, 2, 2))
    s = np.array([-0.3 + 0.7j, -0.5 + 1.6j])
    for pole, v in zip(s, np.array([[1.0, 0.5], [30.0, -40.0]]), strict=True):
        a, b = -pole.real, pole.imag
        K += (np.exp(-a * TIMES) * (np.cos(b * TIMES) - a / b * np.sin(b * TIMES)))[:, None, None] * np.outer(
            v, v
        )
    fit = fit_exponentials(K, tolerance=1e-6)
    assert fit.pole_count == 4
    np.testing.assert_allclose(fit.poles, s, atol=1e-7)
    assert relative_error(fit, K) < 1e-6
    assert fit.change < 1e-6
    assert not fit.warning


@pytest.mark.parametrize(("tolerance", "most"), [(1.2e-3, 6), (2.6e-4, 12)])
def test_hemisphere(tolerance: float, most: int) -> None:
    K = sphere_kernel()
    fit = fit_exponentials(K, tolerance=tolerance)
    assert fit.pole_count <= most
    assert relative_error(fit, K) == pytest.approx(fit.error, rel=1e-9)
    assert fit.error <= tolerance
    assert lowest(fit) > -1e-9
    assert not fit.warning


@pytest.mark.parametrize("couplings", [(0.0, 0.0), (0.7, -0.9), (1.0, -1.0)])
def test_box_barge(couplings: tuple[float, float]) -> None:
    """The last one has damping of rank one in two planes, which no rounding may turn negative."""
    K = barge_kernel(*couplings)
    fit = fit_exponentials(K)
    assert fit.pole_count <= 20
    assert relative_error(fit, K) <= 5e-3
    assert fit.lowest < -1e-4  # what least squares alone would have given
    assert 0.0 < fit.change < 0.01
    assert not fit.damping.any()
    assert lowest(fit) > -1e-9
    np.testing.assert_array_equal(fit.residues, fit.residues.transpose(0, 2, 1))
    assert np.abs(fit.damping_at([0.0])).max() < 1e-12 * np.abs(fit.damping_at([1.0])).max()
    assert (fit.residues[:, 0, 1] == 0.0).all()


def test_damping_is_the_cosine_transform_of_the_kernel() -> None:
    fit = fit_exponentials(sphere_kernel(), tolerance=1e-3)
    t = np.linspace(0.0, 200.0, 400001)
    K = fit(t)[:, 0, 0]
    for w in (0.3, 1.0, 2.5):
        values = K * np.cos(w * t)
        simpson = (t[1] / 3.0) * (
            values[0] + 4.0 * values[1::2].sum() + 2.0 * values[2:-1:2].sum() + values[-1]
        )
        assert fit.damping_at([w])[0, 0, 0] == pytest.approx(simpson, rel=1e-6)


def test_negative_damping_is_removed_by_the_smallest_change() -> None:
    """One channel, with the conditions of a fine grid given to another optimiser."""
    s = np.array([-0.2 + 0.6j, -0.3 + 1.5j])
    x = np.array([1.0, -0.25, -0.2 / 0.6, 0.0])
    x[3] = -0.25 * -0.3 / 1.5
    row = damping_functions(s, np.zeros(1))[0]
    x[2] -= (row @ x) / row[2]  # none at zero frequency
    basis = np.linalg.svd(row[None])[2][1:].T
    powers = np.exp(np.outer(TIMES, s))
    functions = np.hstack([powers.real, -powers.imag])
    made = make_passive(s, x[:, None], np.array([[0, 0]]), 1, basis, functions @ basis)
    assert made.lowest < -0.08
    assert made.extra == 0.0
    w = np.linspace(0.01, 20.0, 2000)
    G = damping_functions(s, w) * (1.0 + w[:, None] ** 2) / w[:, None]
    assert (damping_functions(s, w) @ made.coefficients).min() > 0.0
    other = minimize(
        lambda y: float(np.sum((functions @ basis @ y) ** 2)),
        np.zeros(3),
        method="SLSQP",
        constraints={"type": "ineq", "fun": lambda y: G @ (x + basis @ y)},
        options={"ftol": 1e-12, "maxiter": 300},
    )
    change = np.sum((functions @ (made.coefficients[:, 0] - x)) ** 2)
    assert change == pytest.approx(other.fun, rel=0.01)


def test_too_few_poles_are_told() -> None:
    fit = fit_exponentials(barge_kernel(0.7, -0.9), most_poles=6)
    assert fit.pole_count <= 6
    assert "6 poles fit the memory to" in fit.warning
    assert "not 0.50%" in fit.warning
    assert lowest(fit) > -1e-9


def test_what_cannot_be_made_passive_gets_damping(monkeypatch: pytest.MonkeyPatch) -> None:
    """As when the search for conditions does not end: here it may not begin."""
    monkeypatch.setattr(passivity, "ROUNDS", 0)
    K = barge_kernel(0.7, -0.9)
    fit = fit_exponentials(K)
    assert "was added to keep the memory passive" in fit.warning
    assert (np.diag(fit.damping) > 0.0).all()
    assert (np.diag(fit.damping) < 0.01 * K[0].diagonal()).all()  # [1/s]
    assert lowest(fit) > -1e-9


def test_coordinates_without_damping_stay_without() -> None:
    K = np.zeros((401, 3, 3))
    assert not fit_exponentials(K).residues.any()
    K[:, 1, 1] = sphere_kernel()[:, 0, 0]
    fit = fit_exponentials(K)
    assert set(map(tuple, np.argwhere(fit.residues != 0.0)[:, 1:])) == {(1, 1)}


@pytest.mark.parametrize(
    ("samples", "message"),
    [
        (np.ones((50, 1, 1)), "at least 120"),
        (np.ones((400, 2, 1)), "n, n"),
        (np.full((400, 1, 1), np.inf), "finite"),
    ],
)
def test_bad_samples(samples: np.ndarray, message: str) -> None:
    with pytest.raises(InputError, match=message):
        fit_exponentials(samples, source="base.nc")
