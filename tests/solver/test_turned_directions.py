"""Directions that modes turn: beside rotations of scipy, and differences of these."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.floating_frame.turned_directions import (
    exponential_factors,
    write_turned_direction,
)

Array = NDArray[np.float64]
PSI = np.array([[1.0, 0.2, -0.4], [0.1, -0.7, 0.3], [0.5, 0.4, 0.9], [-0.3, 0.8, 0.2]])
"""Rotations of the place, shape (nf, 3)."""


@kernel
def probe(data: Array, R: Array, q: Array, rates: Array, window: Array, out: Array) -> None:
    d, by_modes = write_turned_direction(data, R, q, rates, window)
    for k in range(3):
        out[k], out[3 + k] = d[k], by_modes[k]


def turned(q: Array, start: Array) -> Array:
    return Rotation.from_rotvec(q @ PSI).apply(start)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-4, 0.1, 0.1999, 0.2001, 0.5, 2.0])
def test_vector_rate_and_columns(angle: float) -> None:
    rng = np.random.default_rng(5)
    start = rng.normal(size=3)
    start /= np.linalg.norm(start)
    q, rates = rng.normal(size=4), rng.normal(size=4)
    q *= angle / np.linalg.norm(q @ PSI)
    frame = Rotation.from_rotvec([0.3, -1.2, 0.8])
    window = np.zeros((3, 10))
    data = np.concatenate([start, PSI.T.ravel()])
    out = np.zeros(6)
    probe(data, frame.as_matrix().ravel(), q, rates, window, out)
    d, by_modes = out[:3], out[3:]
    np.testing.assert_allclose(d, turned(q, start), atol=1e-15)
    step = 1e-3
    for i, unit in enumerate(np.eye(4)):
        a, b, c, e = (turned(q + k * step * unit, start) for k in (-2, -1, 1, 2))
        slope = (a - 8.0 * b + 8.0 * c - e) / (12.0 * step)
        np.testing.assert_allclose(window[:, 6 + i], frame.apply(slope), atol=1e-12)
    np.testing.assert_allclose(by_modes, window[:, 6:] @ rates, atol=1e-14)
    assert not window[:, :6].any()


def test_series_and_closed_form_meet() -> None:
    """On both sides of the change-over, to the rounding of ``t - sin t``."""
    for t in (0.19, 0.21, 1.0, 3.0):
        a, b = exponential_factors(t * t)
        assert a == pytest.approx((1.0 - np.cos(t)) / t**2, rel=1e-13)
        assert b == pytest.approx((t - np.sin(t)) / t**3, rel=1e-12)
