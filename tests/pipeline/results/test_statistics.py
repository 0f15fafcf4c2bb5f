"""Statistics of records against closed forms and against samples of known distributions."""

import math
from dataclasses import replace

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.results.statistics import (
    Column,
    RunStatistics,
    at_extreme,
    column_statistics,
    gumbel_fit,
    power_spectrum,
    record_statistics,
)
from heavylift.solver.water.waves.spectra import jonswap
from heavylift.solver.water.waves.wave_trains import irregular_waves


def test_sine_has_its_mean_deviation_ranges_and_period():
    t = np.linspace(0.0, 200.0, 20_001)  # 20 periods
    found = record_statistics(t, 3.0 + 2.0 * np.sin(2.0 * math.pi * t / 10.0 - 0.4))
    assert found.mean == pytest.approx(3.0, abs=1e-9)
    assert found.standard_deviation == pytest.approx(math.sqrt(2.0), rel=1e-6)
    assert found.significant_by_deviation == pytest.approx(4.0 * math.sqrt(2.0), rel=1e-6)
    assert found.significant_by_cycles == pytest.approx(4.0, rel=1e-5)
    assert found.largest_range == pytest.approx(4.0, rel=1e-5)
    assert (found.minimum, found.maximum) == pytest.approx((1.0, 5.0), abs=1e-5)
    assert found.cycles == 19
    assert found.mean_period == pytest.approx(10.0, rel=1e-6)


def test_unequal_steps_weigh_by_time():
    t = np.concatenate([np.linspace(0.0, 1.0, 1001), np.linspace(1.0, 3.0, 11)[1:]])
    x = np.where(t <= 1.0, 1.0, 0.0)
    assert record_statistics(t, x).mean == pytest.approx(1.0 / 3.0 + 0.1 / 3.0, rel=1e-2)


def test_begin_leaves_the_ramp_out():
    t = np.arange(0.0, 100.0, 0.1)
    x = np.where(t < 20.0, 1e6, np.sin(t))
    assert record_statistics(t, x, begin=20.0).maximum <= 1.0


def test_ranges_are_those_between_upcrossings():
    x = np.array([-1.0, 1.0, -2.0, 3.0, 5.0, -1.0, -6.0, 2.0, -1.0])
    assert x.sum() == 0.0
    found = record_statistics(np.arange(9.0), x)
    assert found.cycles == 2  # of 3 and of 11; the highest third is the higher one
    assert found.significant_by_cycles == pytest.approx(11.0)


def test_significant_range_of_a_gaussian_sea_is_four_deviations_within_the_known_bias():
    t = np.arange(0.0, 3600.0, 0.2)
    ratios = []
    for seed in range(5):
        found = record_statistics(t, irregular_waves(jonswap(3.0, 9.0), seed=seed).elevation(0.0, 0.0, t))
        ratios.append(found.significant_by_cycles / found.significant_by_deviation)
    # wide spectra give 0.92 to 0.97 of the narrow-banded value (Forristall 1978)
    assert 0.91 < np.mean(ratios) < 0.98


@pytest.mark.slow
@pytest.mark.parametrize("method", ["likelihood", "moments"])
def test_gumbel_fit_finds_the_distribution_within_its_stated_errors(method):
    mode, scale, n, trials = 12.0, 0.8, 20, 2000
    rng = np.random.default_rng(7)
    fits = [gumbel_fit(mode - scale * np.log(rng.exponential(size=n)), method=method) for _ in range(trials)]
    for name, exact in (("mode", mode), ("scale", scale)):
        values = np.array([getattr(fit, name) for fit in fits])
        stated = np.mean([getattr(fit, name + "_error") for fit in fits])
        assert np.std(values) == pytest.approx(stated, rel=0.15)
        assert abs(np.mean(values) - exact) < 0.3 * stated  # bias of small samples
    high = np.array([fit.quantile(0.9) for fit in fits])
    assert np.std(high) == pytest.approx(np.mean([fit.standard_error(0.9) for fit in fits]), rel=0.15)
    assert np.mean(high) == pytest.approx(mode - scale * math.log(-math.log(0.9)), rel=0.01)


def test_likelihood_is_at_its_maximum():
    x = 5.0 - 0.3 * np.log(np.random.default_rng(1).exponential(size=15))
    fit = gumbel_fit(x)

    def likelihood(mode, scale):
        z = (x - mode) / scale
        return np.sum(-np.log(scale) - z - np.exp(-z))

    best = likelihood(fit.mode, fit.scale)
    for dm, ds in ((1e-4, 0.0), (-1e-4, 0.0), (0.0, 1e-4), (0.0, -1e-4)):
        assert likelihood(fit.mode + dm, fit.scale + ds) < best


def test_minima_are_mirrored_maxima():
    x = np.random.default_rng(2).gumbel(4.0, 0.5, 12)
    maxima, minima = gumbel_fit(x), gumbel_fit(-x, minima=True)
    assert minima.mode == pytest.approx(-maxima.mode, rel=1e-12)
    assert minima.quantile(0.95) == pytest.approx(-maxima.quantile(0.95), rel=1e-12)
    assert minima.mean == pytest.approx(-maxima.mean, rel=1e-12)


def test_equal_extremes_have_no_scale():
    fit = gumbel_fit([3.0, 3.0, 3.0, 3.0])
    assert (fit.mode, fit.scale, fit.quantile(0.99), fit.standard_error(0.99)) == (3.0, 0.0, 3.0, 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("n", [5, 20])
def test_bands_of_few_runs_hold_the_true_value_as_often_as_they_say(n):
    """Of five runs, two asymptotic standard errors hold it far less often than they should."""
    mode, scale, trials = 3.0, 0.4, 1500
    exact = mode - scale * math.log(-math.log(0.9))
    rng = np.random.default_rng(11)
    fits = [gumbel_fit(rng.gumbel(mode, scale, n)) for _ in range(trials)]
    for sign, minima in ((1.0, False), (-1.0, True)):
        found = [
            gumbel_fit(sign * rng.gumbel(mode, scale, n), minima=minima).band(0.9) for _ in range(trials)
        ]
        held = np.mean([low < sign * exact < high for low, high in found])
        assert held == pytest.approx(0.9, abs=3.0 * math.sqrt(0.09 / trials) + 0.01)
    by_errors = np.mean([abs(f.quantile(0.9) - exact) < 1.645 * f.standard_error(0.9) for f in fits])
    assert by_errors < 0.9 - (0.04 if n == 5 else 0.01)


def test_extremes_that_are_cut_off_have_no_fit():
    """Ropes that go slack in three of twelve runs, and a stop that one run reaches."""
    rng = np.random.default_rng(3)
    lows = np.where(np.arange(12) < 3, 0.0, rng.uniform(1.0, 2.0, 12))
    highs = rng.gumbel(10.0, 1.0, 12)
    assert (at_extreme(lows, minima=True), at_extreme(highs)) == (3, 0)
    record = record_statistics(np.arange(3.0), np.array([0.0, 1.0, 0.0]))
    runs = [
        RunStatistics(replace(record, minimum=low, maximum=high), None, every_step=True)
        for low, high in zip(lows, highs, strict=True)
    ]
    entry = column_statistics(Column("a.tension", "N", "a.tension", lambda run: run.time), runs).entry()
    assert entry["minima"] == {"tied": 3, "count": 12}
    assert entry["maxima"]["mode"] == pytest.approx(gumbel_fit(highs).mode)


def test_spectrum_integrates_to_the_variance_in_both_units():
    rng = np.random.default_rng(8)
    t = 0.1 * np.arange(80_000)
    x = rng.normal(size=80_000)  # white: variance over Nyquist everywhere
    for per, nyquist in (("Hz", 5.0), ("rad/s", 10.0 * math.pi)):
        found = power_spectrum(t, x, per=per, segment=40.0)
        inner = found.density[5:-5]
        assert np.mean(inner) == pytest.approx(1.0 / nyquist, rel=0.01)
        assert np.sum(found.density) * found.resolution == pytest.approx(1.0, rel=0.02)
        assert np.std(inner) / np.mean(inner) == pytest.approx(found.relative_error, rel=0.2)


def test_spectrum_of_a_jonswap_sea_is_the_jonswap_spectrum():
    spectrum = jonswap(1.65, 6.12)
    t = 0.4 * np.arange(18_000)
    found = [power_spectrum(t, irregular_waves(spectrum, seed=s, count=400).elevation(0.0, 0.0, t), segment=400.0)
             for s in range(4)]  # fmt: skip
    density = np.mean([one.density for one in found], axis=0)
    w = found[0].frequency
    band = (w > 0.9) & (w < 1.8)
    width = found[0].resolution
    assert np.sum(density[band]) * width == pytest.approx(float(spectrum.energy(0.9, 1.8)[0]), rel=0.03)


def test_wrong_input_is_refused():
    t = np.arange(100.0)
    with pytest.raises(InputError, match="3 records"):
        gumbel_fit([1.0, 2.0])
    with pytest.raises(InputError, match="method"):
        gumbel_fit([1.0, 2.0, 3.0], method="luck")
    with pytest.raises(InputError, match="probability"):
        gumbel_fit([1.0, 2.0, 3.0]).quantile(1.0)
    with pytest.raises(InputError, match="finite"):
        record_statistics(t, np.where(t == 3.0, np.nan, 0.0))
    with pytest.raises(InputError, match="equally spaced"):
        power_spectrum(t**1.5, t)
    with pytest.raises(InputError, match="segment"):
        power_spectrum(t, t, segment=1e6)
    with pytest.raises(InputError, match="rad/s or Hz"):
        power_spectrum(t, t, per="rpm")
