"""Sums of wave components: variance, spectrum, repetition, records, and the same bits from the same seed."""

import math

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.solver.water.waves.spectra import jonswap
from heavylift.solver.water.waves.wave_trains import (
    irregular_waves,
    measured_waves,
    regular_wave,
    superposition,
)

SPECTRUM = jonswap(1.65, 6.12)
FIELDS = ("omega", "wavenumber", "direction", "amplitude", "phase")


def test_regular_wave_is_the_closed_form_in_finite_depth():
    depth, period, direction, phase = 12.0, 8.0, 0.7, 0.3
    train = regular_wave(1.4, period, direction, phase=phase, depth=depth)
    k, w = train.wavenumber[0], 2.0 * math.pi / period
    assert w**2 == pytest.approx(9.81 * k * math.tanh(k * depth), rel=1e-14)
    x, y, t = np.array([3.0, -40.0]), np.array([10.0, 7.0]), np.array([1.0, 77.7])
    along = k * (x * math.cos(direction) + y * math.sin(direction))
    assert train.elevation(x, y, t) == pytest.approx(0.7 * np.cos(along - w * t - phase), abs=1e-12)
    assert train.repeat_period == period


@pytest.mark.slow
@pytest.mark.parametrize("options", [{}, {"amplitudes": "rayleigh"}, {"bins": "equal"}])
def test_variance_of_sampled_elevations_is_that_of_the_sea(options):
    times = np.arange(0.0, 1200.0, 0.6)
    variances = [
        np.var(irregular_waves(SPECTRUM, seed=seed, **options).elevation(0.0, 0.0, times))
        for seed in range(20)
    ]
    error = np.std(variances, ddof=1) / math.sqrt(20.0)
    assert abs(np.mean(variances) - 1.65**2 / 16.0) < 3.0 * error
    assert error < 0.05 * 1.65**2 / 16.0


def test_energy_of_bands_is_that_of_the_spectrum():
    edges = np.array([0.7, 0.9, 1.0, 1.1, 1.4, 2.0])
    exact = SPECTRUM.energy(edges[:-1], edges[1:])
    found = np.zeros(5)
    for seed in range(20):
        train = irregular_waves(SPECTRUM, seed=seed, count=1000)
        found += np.histogram(train.omega, edges, weights=0.5 * train.amplitude**2)[0] / 20.0
    # 0.5 % beyond the highest component is spread over all; the rest is the width of a bin at the edges
    assert found == pytest.approx(exact, rel=0.02)


def test_deterministic_amplitudes_keep_the_height_exactly():
    for directions, spread in ((1, None), (1, 10.0), (8, 10.0)):
        train = irregular_waves(SPECTRUM, seed=5, count=60, directions=directions, spreading=spread)
        assert train.significant_height == pytest.approx(1.65, rel=1e-12)
        assert len(np.unique(train.omega)) == 60 * directions


def test_same_seed_same_bits_other_seed_other_waves():
    options = {"spreading": 6.0, "directions": 3, "amplitudes": "rayleigh", "direction": 0.4}
    one, two = (irregular_waves(SPECTRUM, seed=11, **options) for _ in range(2))
    other = irregular_waves(SPECTRUM, seed=12, **options)
    for field in FIELDS:
        assert getattr(one, field).tobytes() == getattr(two, field).tobytes()
    assert not np.any(one.phase == other.phase)
    assert one.seeds == (11,)


def test_one_frequency_in_each_bin_never_repeats_and_equal_bins_repeat_when_stated():
    train = irregular_waves(SPECTRUM, seed=1, count=50)
    edges = np.linspace(SPECTRUM.quantile(5e-4), SPECTRUM.quantile(0.995), 51)
    assert np.all(np.histogram(train.omega, edges)[0] == 1)
    assert train.repeat_period == math.inf
    equal = irregular_waves(SPECTRUM, seed=1, count=50, bins="equal")
    t = np.linspace(0.0, 100.0, 60)
    assert equal.elevation(0.0, 0.0, t + equal.repeat_period) == pytest.approx(
        equal.elevation(0.0, 0.0, t), abs=1e-10
    )


def test_directions_follow_the_spreading():
    s = 5.0
    train = irregular_waves(SPECTRUM, seed=3, count=100, directions=20, spreading=s, direction=1.0)
    energy = train.amplitude**2 / np.sum(train.amplitude**2)
    # the mean cosine of cos^2s spreading is s / (s + 1)
    assert np.sum(energy * np.cos(train.direction - 1.0)) == pytest.approx(s / (s + 1.0), rel=0.01)
    assert abs(np.sum(energy * np.sin(train.direction - 1.0))) < 0.02


@pytest.mark.parametrize("count", [400, 401])
def test_measured_record_is_reproduced_where_and_when_it_was_measured(count):
    times = 5.0 + 0.25 * np.arange(count)
    record = irregular_waves(SPECTRUM, seed=9).elevation(0.0, 0.0, times)
    train = measured_waves(times, record, direction=0.6, place=(20.0, -7.0), depth=15.0)
    assert train.elevation(20.0, -7.0, times) == pytest.approx(record - np.mean(record), abs=1e-5)
    assert train.repeat_period == pytest.approx(0.25 * count)
    assert train.variance == pytest.approx(np.var(record), rel=1e-6)


def test_measured_single_wave_travels():
    wave = regular_wave(1.0, 10.0, 0.8, phase=1.1, depth=30.0)
    times = 0.5 * np.arange(200)
    train = measured_waves(
        times, wave.elevation(3.0, 4.0, times), direction=0.8, place=(3.0, 4.0), depth=30.0
    )
    assert train.elevation(70.0, -20.0, 33.3) == pytest.approx(wave.elevation(70.0, -20.0, 33.3), abs=1e-9)


def test_superposition_adds():
    swell = regular_wave(0.8, 14.0, 1.2)
    sea = irregular_waves(SPECTRUM, seed=4)
    both = superposition([swell, sea])
    place = (13.0, -6.0, np.linspace(0.0, 50.0, 20))
    assert both.elevation(*place) == pytest.approx(swell.elevation(*place) + sea.elevation(*place), abs=1e-12)
    assert both.peak_period == pytest.approx(6.12)
    assert both.seeds == (4,)
    with pytest.raises(InputError, match="depth"):
        superposition([swell, regular_wave(0.8, 14.0, depth=20.0)])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"bins": "odd"}, "bins"),
        ({"amplitudes": "large"}, "amplitudes"),
        ({"seed": -1}, "seed"),
        ({"seed": 1.5}, "seed"),
        ({"count": 3}, "count"),
        ({"direction": 30.0}, "degrees"),
        ({"directions": 4}, "spreading"),
        ({"spreading": 0.0}, "spreading"),
        ({"frequency_range": (2.0, 3.0)}, "frequency_range"),
        ({"frequency_range": (3.0, 0.5)}, "frequency_range"),
        ({"depth": 1.0}, "beyond breaking"),
    ],
)
def test_wrong_options_are_refused(options, words):
    with pytest.raises(InputError, match=words):
        irregular_waves(SPECTRUM, **({"seed": 1} | options))


def test_wrong_records_are_refused():
    times = np.arange(20.0)
    with pytest.raises(InputError, match="equally spaced"):
        measured_waves(times**2, np.sin(times))
    with pytest.raises(InputError, match="metres"):
        measured_waves(times, 1000.0 * np.sin(times))
    with pytest.raises(InputError, match="frequency_range"):
        measured_waves(times, np.sin(times), frequency_range=(50.0, 60.0))
    with pytest.raises(InputError, match="rows"):
        measured_waves(times[:4], times[:4])
