"""The frequency of a sampled sinusoid is found to rounding, whatever its phase and place between lines."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.results.sinusoid import fit_sinusoid


@pytest.mark.parametrize("frequency", [51.0, 622.97, 7237.81, 49000.0])
@pytest.mark.parametrize("phase", [0.0, 0.7, 3.0])
def test_clean_data(frequency, phase):
    t = 0.3 + np.arange(2001) * 1e-5
    fit = fit_sinusoid(t, 0.02 * np.cos(2.0 * np.pi * frequency * t + phase) - 0.5)
    assert fit.frequency == pytest.approx(frequency, rel=1e-11)
    assert fit.offset == pytest.approx(-0.5, rel=1e-9)
    assert np.hypot(fit.cosine, fit.sine) == pytest.approx(0.02, rel=1e-8)
    error = np.arctan2(-fit.sine, fit.cosine) - phase
    assert np.exp(1j * error) == pytest.approx(1.0, abs=1e-6)


def test_a_damped_sinusoid():
    t = np.arange(2001) * 1e-5
    fit = fit_sinusoid(t, 3.0 * np.exp(-80.0 * t) * np.sin(2.0 * np.pi * 622.97 * t), damped=True)
    assert fit.frequency == pytest.approx(622.97, rel=1e-12)
    assert fit.decay == pytest.approx(80.0, rel=1e-10)
    assert fit.sine == pytest.approx(3.0, rel=1e-10)


def test_two_periods_are_enough():
    t = np.arange(300) * 1e-5
    assert fit_sinusoid(t, np.sin(2.0 * np.pi * 700.0 * t)).frequency == pytest.approx(700.0, rel=1e-11)


def test_noise_disturbs_by_the_cramer_rao_bound():
    t = np.arange(2001) * 1e-5
    noise = 0.01 * np.random.default_rng(1).standard_normal(len(t))
    fit = fit_sinusoid(t, np.sin(2.0 * np.pi * 622.97 * t) + noise)
    bound = np.sqrt(24.0) * 0.01 / (2.0 * np.pi * (t[-1] - t[0]) * np.sqrt(len(t)))
    assert abs(fit.frequency - 622.97) < 4.0 * bound
    assert fit.residual == pytest.approx(0.01 * np.sqrt(2.0), rel=0.1)


@pytest.mark.parametrize("values", [np.zeros(100), np.ones(100), np.full(100, np.nan)])
def test_what_does_not_oscillate_is_refused(values):
    with pytest.raises(InputError, match="oscillate"):
        fit_sinusoid(np.arange(100.0), values)


def test_too_few_samples_are_refused():
    with pytest.raises(InputError, match="at least 8"):
        fit_sinusoid(np.arange(5.0), np.arange(5.0))
