"""Discrete gradients: the work of the mean force is exactly the change of the stored energy."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.jit import kernel
from heavylift.solver.force_elements.forces import mean_force, pull

TABLE = np.array([[-0.5, -30.0], [0.0, -2.0], [0.2, -2.0], [0.3, 40.0], [1.0, 50.0]])


@kernel
def pulled(e0: float, e1: float, k: float, c: float, h: float) -> tuple[float, float, float]:
    return pull(e0, e1, k, c, h)


@kernel
def mean(table: np.ndarray, e0: float, e1: float) -> tuple[float, float]:
    return mean_force(table, 0, table.shape[0], 0.0, e0, e1)


def energy(e: float) -> float:
    """Of the table, from 0, by fine quadrature of the piecewise linear force."""
    x = np.union1d(np.linspace(0.0, e, 20001), TABLE[(TABLE[:, 0] - e) * TABLE[:, 0] < 0.0, 0])
    f = np.interp(x, TABLE[:, 0], TABLE[:, 1])
    f += np.minimum(x - TABLE[0, 0], 0.0) * 56.0 + np.maximum(x - TABLE[-1, 0], 0.0) * (10.0 / 0.7)
    return float(np.trapezoid(f, x)) * (1.0 if e > 0.0 else -1.0)


@pytest.mark.parametrize("seed", range(5))
def test_rope(seed: int) -> None:
    rng = np.random.default_rng(seed)
    k, h = 1e6, 1e-2
    for e0, e1 in rng.normal(size=(50, 2)) * 0.01:
        elastic, tension, slope = pulled(e0, e1, k, 0.0, h)
        stored = 0.5 * k * (max(e1, 0.0) ** 2 - max(e0, 0.0) ** 2)
        assert elastic * (e1 - e0) == pytest.approx(stored, rel=1e-12)
        assert tension == elastic
        d = 1e-6 * abs(e1 - e0)
        difference = (pulled(e0, e1 + d, k, 0.0, h)[1] - pulled(e0, e1 - d, k, 0.0, h)[1]) / (2.0 * d)
        assert slope == pytest.approx(difference, rel=1e-4, abs=1e-3)


def test_damper_takes_energy_and_never_pushes() -> None:
    rng = np.random.default_rng(3)
    for e0, e1 in rng.normal(size=(200, 2)) * 0.01:
        elastic, tension, slope = pulled(e0, e1, 1e6, 1e5, 1e-2)
        assert tension >= 0.0
        assert slope >= 0.0
        assert (tension - elastic) * (e1 - e0) >= 0.0


@pytest.mark.parametrize("seed", range(5))
def test_table(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for e0, e1 in rng.uniform(-1.0, 1.5, size=(20, 2)):
        force, slope = mean(TABLE, e0, e1)
        assert force * (e1 - e0) == pytest.approx(energy(e1) - energy(e0), rel=1e-6, abs=1e-6)
        d = 1e-6
        difference = (mean(TABLE, e0, e1 + d)[0] - mean(TABLE, e0, e1 - d)[0]) / (2.0 * d)
        assert slope == pytest.approx(difference, rel=1e-3, abs=1e-3)
