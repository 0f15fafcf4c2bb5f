from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from heavylift.numerics.outcome import InputError
from heavylift.solver.water.wind.spectrum import (
    averaging_factor,
    check_speed,
    gust_speed,
    hourly_mean,
    log_profile,
    npd_coherence,
    npd_spectrum,
    standard_deviation,
    turbulence_intensity,
    wind_components,
    wind_record,
)

TABLE = np.genfromtxt(
    Path(__file__).resolve().parents[2] / "reference_data" / "marine" / "npd_wind_targets.csv",
    delimiter=",",
    names=True,
    skip_header=1,
)
SEEDS = range(20)


@pytest.mark.parametrize("row", TABLE, ids=lambda row: f"{row[0]:g} m/s at {row[1]:g} m")
def test_the_published_formulae_give_the_tabulated_numbers(row):
    speed, z = row["U0_1h_10m"], row["z_m"]
    f = np.array([1 / 3600, 1 / 600, 0.01, 0.1, 0.5])
    densities = [row[n] for n in ("S_1_3600Hz", "S_1_600Hz", "S_0p01Hz", "S_0p1Hz", "S_0p5Hz")]
    np.testing.assert_allclose(npd_spectrum(f, speed, z), densities, rtol=1e-4)
    found = (
        standard_deviation(speed, z, 1 / 3600),
        standard_deviation(speed, z),
        turbulence_intensity(z, speed),
        log_profile(z, speed),
        averaging_factor(600.0, z, speed),
        averaging_factor(3.0, z, speed),
    )
    names = (
        *("std_1_3600_to_0p5Hz", "std_1_600_to_0p5Hz", "Iu", "Uz_log_1h"),
        *("ratio_10min_to_1h", "ratio_3s_to_1h"),
    )
    np.testing.assert_allclose(found, [row[n] for n in names], rtol=1e-4)


def test_the_standard_deviation_is_the_integral_of_the_spectrum():
    variance = quad(lambda x: np.exp(x) * npd_spectrum(np.exp(x), 12.0, 30.0), np.log(1 / 600), np.log(0.5))[
        0
    ]
    assert standard_deviation(12.0, 30.0) == pytest.approx(np.sqrt(variance), rel=1e-10)


def test_the_variance_of_records_is_that_of_the_spectrum():
    t = 0.5 * np.arange(7200)
    # about the known mean, zero: its expectation is the variance for any length of the record
    squares = [np.mean(wind_record(wind_components(10.0, seed=seed), t) ** 2) for seed in SEEDS]
    error = np.std(squares, ddof=1) / np.sqrt(len(squares))
    assert abs(np.mean(squares) - 0.8714**2) < 3.0 * error + 1e-4
    assert error < 0.1


@pytest.mark.slow
@pytest.mark.parametrize(("low", "high"), [(0.004, 0.02), (0.02, 0.1), (0.1, 0.5)])
def test_records_have_the_variance_of_the_spectrum_in_each_band(low, high):
    t = 0.5 * np.arange(7200)
    f = np.fft.rfftfreq(len(t), 0.5)
    inside = (f >= low) & (f < high)
    window = np.hanning(len(t))  # a component stays in its band
    expected = quad(lambda x: npd_spectrum(x, 10.0), low, high)[0]
    found = []
    for seed in SEEDS:
        u = np.fft.rfft(window * wind_record(wind_components(10.0, seed=seed), t))
        found.append(2.0 * np.sum(np.abs(u[inside]) ** 2) / len(t) / np.sum(window**2))
    assert (
        abs(np.mean(found) - expected) < 3.0 * np.std(found, ddof=1) / np.sqrt(len(found)) + 0.02 * expected
    )


def test_the_components_carry_the_variance_exactly_and_lie_in_their_bins():
    components = wind_components(10.0, (0.0, 0.0, 50.0), seed=3, count=300, lowest=1 / 3600)
    assert 0.5 * np.sum(np.abs(components.amplitudes[0]) ** 2) == pytest.approx(0.7877**2, rel=2e-4)
    edges = np.geomspace(1 / 3600, 0.5, 301)
    assert np.all((edges[:-1] <= components.frequencies) & (components.frequencies <= edges[1:]))


def test_the_same_seed_gives_the_same_bits_and_another_one_another_record():
    t = np.linspace(0.0, 600.0, 1001)
    first, again, other = (wind_record(wind_components(15.0, seed=seed), t) for seed in (7, 7, 8))
    assert np.array_equal(first, again)
    assert np.corrcoef(first, other)[0, 1] < 0.9


def test_a_record_does_not_depend_on_how_its_times_are_blocked():
    components = wind_components(15.0, seed=1, count=3)
    t = 0.1 * np.arange(70000)
    np.testing.assert_array_equal(wind_record(components, t)[-5:], wind_record(components, t[-5:]))


def test_coherence_falls_from_one_with_distance_and_is_that_of_the_standard():
    here = np.array([0.0, 0.0, 40.0])
    assert npd_coherence(0.05, here, here, 10.0) == 1.0
    # A_3 = 13 f^0.85 d^1.25 z_g^-0.5 and A_2 = 45 f^0.92 d z_g^-0.4, z_g = sqrt(40 90) / 10 = 6
    vertical = np.exp(-13.0 * 0.05**0.85 * 50.0**1.25 / np.sqrt(6.0) / 10.0)
    assert npd_coherence(0.05, here, here + np.array([0.0, 0.0, 50.0]), 10.0) == pytest.approx(
        vertical, rel=1e-12
    )
    across = np.exp(-45.0 * 0.01**0.92 * 20.0 * 4.0**-0.4 / 10.0)
    assert npd_coherence(0.01, here, here + np.array([0.0, 20.0, 0.0]), 10.0) == pytest.approx(
        across, rel=1e-12
    )
    along = np.exp(-2.9 * 0.01**0.92 * 20.0 * 4.0**-0.4 / 10.0)
    assert npd_coherence(0.01, here, here + np.array([20.0, 0.0, 0.0]), 10.0) == pytest.approx(
        along, rel=1e-12
    )


def test_records_at_two_points_have_the_coherence_of_the_standard():
    points = np.array([[0.0, 0.0, 20.0], [0.0, 15.0, 30.0]])
    cross, power = np.zeros(200), np.zeros((2, 200))
    for seed in range(400):
        components = wind_components(12.0, points, seed=seed)
        a, b = components.amplitudes
        cross += np.real(a * np.conj(b))
        power += np.abs([a, b]) ** 2
    f = np.sqrt(np.geomspace(1 / 600, 0.5, 201)[1:] * np.geomspace(1 / 600, 0.5, 201)[:-1])
    found = cross / np.sqrt(power[0] * power[1])
    expected = npd_coherence(f, *points, 12.0)
    # of 400 samples; neighbouring frequencies are independent
    assert np.max(np.abs(found - expected)) < 5.0 / np.sqrt(400)
    assert abs(np.mean(found - expected)) < 3.0 / np.sqrt(400 * 200) + 0.002
    np.testing.assert_allclose(
        np.sqrt(0.5 * power.sum(axis=1) / 400), [standard_deviation(12.0, z) for z in (20.0, 30.0)], rtol=0.02
    )


@pytest.mark.parametrize(("duration", "height"), [(600.0, 10.0), (3.0, 10.0), (60.0, 45.0), (3600.0, 100.0)])
def test_the_hourly_mean_of_a_gust_is_the_wind_that_has_this_gust(duration, height):
    # by hand: U0 (1 + 0.0573 sqrt(1 + 0.15 U0) ln(z/10)) (1 - 0.41 0.06 (1 + 0.043 U0) (z/10)^-0.22 ln(t/3600))
    mean = hourly_mean(20.0, duration, height)
    profile = 1.0 + 0.0573 * np.sqrt(1.0 + 0.15 * mean) * np.log(height / 10.0)
    gust = 1.0 - 0.0246 * (1.0 + 0.043 * mean) * (height / 10.0) ** -0.22 * np.log(duration / 3600.0)
    assert mean * profile * gust == pytest.approx(20.0, rel=1e-12)
    assert gust_speed(duration, height, mean) == pytest.approx(20.0, rel=1e-12)


def test_speeds_that_look_like_knots_are_refused_with_the_conversion():
    with pytest.raises(InputError, match=r'120 m/s.*knots "120 knot" is 61\.73 m/s'):
        check_speed(120.0, source="wind", key="speed")
    for speed in (-1.0, np.nan, np.inf):
        with pytest.raises(InputError, match="speed from 0 to 75"):
            check_speed(speed, source="wind", key="speed")


def test_impossible_requests_are_refused():
    with pytest.raises(InputError, match="averaging time 7200"):
        averaging_factor(7200.0, 10.0, 10.0)
    with pytest.raises(InputError, match="0 components"):
        wind_components(10.0, seed=1, count=0)
    with pytest.raises(InputError, match=r"from 0\.1 to 2 Hz"):
        wind_components(10.0, seed=1, lowest=0.1, highest=2.0)
    with pytest.raises(InputError, match="heights positive"):
        wind_components(10.0, (0.0, 0.0, -5.0), seed=1)
    assert np.all(wind_components(0.0, seed=1).amplitudes == 0.0)
