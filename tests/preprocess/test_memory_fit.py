"""Exponentials for whole databases: what is not felt takes no poles, and a fit is stored to the last bit."""

from __future__ import annotations

import time
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase, length_scales
from heavylift.preprocess.hydrodynamics.memory_fit import (
    database_memory,
    felt_scales,
    fit_memory,
    read_memory,
    write_memory,
)
from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf

CASES = Path(__file__).parents[2] / "cases"
TIMES = np.arange(0.0, 60.0, 0.1)


@pytest.fixture(scope="module")
def noisy() -> HydrodynamicDatabase:
    """Two barges, 12 coordinates, with nothing but noise of 1e-5 of the largest damping in yaw of both."""
    barges = read_netcdf(CASES / "two_barges" / "two_barges.nc")
    scales, damping = length_scales(barges), barges.damping.copy()
    largest = np.abs(damping * np.outer(scales, scales)).max()
    rng = np.random.default_rng(3)
    for i in (5, 11):
        damping[:, i, :] = damping[:, :, i] = 0.0
        damping[:, i, i] = 1e-5 * largest / scales[i] ** 2 * np.abs(rng.normal(size=len(damping)))
    return replace(barges, damping=damping)


@pytest.mark.slow
def test_coordinates_of_noise_take_no_poles(noisy: HydrodynamicDatabase) -> None:
    begin = time.process_time()
    fit = fit_memory(noisy)
    assert time.process_time() - begin < 10.0  # two of a quiet core
    kernel, _ = database_memory(noisy)
    K = kernel(TIMES)
    own = np.sqrt(np.abs(np.einsum("kii->ki", K)).max(axis=0))
    error = np.abs(fit(TIMES) - K).max(axis=0)
    felt = [i for i in range(12) if i not in (5, 11)]
    assert (error / np.outer(own, own))[np.ix_(felt, felt)].max() < 5e-3
    assert fit.warning == ""
    # less than a thousandth of a thousandth of the critical damping is left of the noise
    scales = felt_scales(noisy)
    assert (np.diag(error) / scales**2)[[5, 11]].max() < 1e-3
    # the same poles as without the noise, or as many
    damping = noisy.damping.copy()
    damping[:, 5, 5] = damping[:, 11, 11] = 0.0
    assert fit.pole_count <= fit_memory(replace(noisy, damping=damping)).pole_count + 1


@pytest.mark.slow
def test_a_fit_comes_back_from_its_file(tmp_path: Path, noisy: HydrodynamicDatabase) -> None:
    fit = fit_memory(noisy, tolerance=0.05)
    write_memory(tmp_path / "fit.npz", fit, "key")
    back = read_memory(tmp_path / "fit.npz", "key")
    assert back is not None
    for field in fields(fit):
        np.testing.assert_array_equal(getattr(back, field.name), getattr(fit, field.name))
    assert read_memory(tmp_path / "fit.npz", "other") is None
    assert read_memory(tmp_path / "none.npz", "key") is None
    (tmp_path / "cut.npz").write_bytes((tmp_path / "fit.npz").read_bytes()[:200])
    assert read_memory(tmp_path / "cut.npz", "key") is None
