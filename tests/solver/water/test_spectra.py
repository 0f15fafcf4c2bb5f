"""Wave spectra, spreading and dispersion against published tables, closed forms and SciPy's quadrature."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import gamma

from heavylift.numerics.outcome import InputError
from heavylift.solver.water.waves.spectra import (
    check_angle,
    check_steepness,
    dispersion,
    jonswap,
    pierson_moskowitz,
    spreading,
    spreading_quantile,
    tabulated_spectrum,
)

# JONSWAP with the factor 1 - 0.287 ln(gamma), gamma = 3.3, S in m^2 s/rad; periods integrated to 12 rad/s.
# Hs, Tp, S(0.7 wp), S(wp), S(1.3 wp), S(2 wp), 4 sqrt(m0), Tz, T1, Te
JONSWAP_TABLE = (
    (1.65, 6.12, 0.017772, 0.515025, 0.095147, 0.015744, 1.65196, 4.7749, 5.1088, 5.5284),
    (6.1, 10.47, 0.415551, 12.04246, 2.224764, 0.368121, 6.10735, 8.1495, 8.7364, 9.4576),
)


@pytest.mark.parametrize("row", JONSWAP_TABLE)
def test_jonswap_densities_and_periods_are_those_of_the_table(row):
    height, period, *targets = row
    spectrum = jonswap(height, period, renormalise=False)
    wp = 2.0 * math.pi / period
    found = [
        *spectrum.density(wp * np.array([0.7, 1.0, 1.3, 2.0])),
        4.0 * math.sqrt(spectrum.moment(0, 12.0)),
        2.0 * math.pi * math.sqrt(spectrum.moment(0, 12.0) / spectrum.moment(2, 12.0)),
        spectrum.mean_period(12.0),
        2.0 * math.pi * spectrum.moment(-1, 12.0) / spectrum.moment(0, 12.0),
    ]
    assert found == pytest.approx(targets, rel=1e-4)


@pytest.mark.parametrize("peakedness", [1.0, 2.0, 3.3, 7.0])
def test_renormalised_height_is_exact_and_moments_are_those_of_adaptive_quadrature(peakedness):
    spectrum = jonswap(3.1, 9.3, peakedness)
    assert spectrum.significant_height == pytest.approx(3.1, rel=1e-12)
    wp = spectrum.peak_frequency
    for order in (-1, 0, 1, 2):
        ends = (0.05 * wp, 0.9 * wp, wp, 1.1 * wp, 2.0 * wp, 10.0 * wp, np.inf)
        parts = [
            quad(
                lambda w, n=order: w**n * float(spectrum.density(w)),
                a,
                b,
                epsabs=0.0,
                epsrel=1e-11,
                limit=200,
            )[0]
            for a, b in itertools.pairwise(ends)
        ]
        assert spectrum.moment(order) == pytest.approx(sum(parts), rel=1e-9)
    assert spectrum.moment(4) == math.inf
    assert spectrum.moment(4, 5.0) < math.inf


def test_pierson_moskowitz_has_the_moments_of_its_closed_form():
    height, period = 2.5, 8.0
    spectrum = pierson_moskowitz(height, period)
    b = 1.25 * (2.0 * math.pi / period) ** 4
    a = height**2 * b / 4.0
    for n in (0, 1, 2, 3):
        closed = 0.25 * a * b ** (n / 4.0 - 1.0) * gamma(1.0 - n / 4.0)
        assert spectrum.moment(n) == pytest.approx(closed, rel=1e-10)
    zero_crossing = 2.0 * math.pi * math.sqrt(spectrum.moment(0) / spectrum.moment(2))
    assert zero_crossing == pytest.approx(period / (1.25 * math.pi) ** 0.25, rel=1e-10)


def test_energy_of_intervals_adds_up_and_quantiles_divide_it():
    spectrum = jonswap(2.0, 8.0)
    edges = np.array([0.0, 0.5, 0.7853, 0.9, 3.0, 30.0, np.inf])
    assert np.sum(spectrum.energy(edges[:-1], edges[1:])) == pytest.approx(spectrum.moment(0), rel=1e-13)
    for part in (0.001, 0.3, 0.5, 0.99, 0.9999):
        assert spectrum.moment(0, spectrum.quantile(part)) == pytest.approx(
            part * spectrum.moment(0), rel=1e-9
        )


def test_table_is_integrated_exactly():
    spectrum = tabulated_spectrum([0.4, 0.6, 1.0], [0.0, 1.0, 0.0], name="triangle")
    assert spectrum.moment(0) == pytest.approx(0.3, rel=1e-14)
    # first moment of a triangle: area times centroid
    assert spectrum.moment(1) == pytest.approx(0.3 * (0.4 + 0.6 + 1.0) / 3.0, rel=1e-14)
    assert spectrum.peak_period == pytest.approx(2.0 * math.pi / 0.6)
    assert spectrum.moment(4) < math.inf


@pytest.mark.parametrize("depth", [0.5, 12.0, 40.0, 3000.0])
def test_dispersion_relation_holds_to_round_off(depth):
    w = np.geomspace(1e-3, 30.0, 500)
    k = dispersion(w, depth)
    assert 9.81 * k * np.tanh(k * depth) == pytest.approx(w**2, rel=1e-14)


def test_dispersion_has_the_deep_and_the_shallow_limit():
    w = np.array([0.0, 0.5, 1.0])
    assert dispersion(w, np.inf) == pytest.approx(w**2 / 9.81, rel=1e-15)
    assert dispersion(w[1:], 5000.0) == pytest.approx(w[1:] ** 2 / 9.81, rel=1e-12)
    # (k h)^2 (1 - (k h)^2 / 3) = omega^2 h / g
    assert dispersion(0.01, 2.0) == pytest.approx(0.01 / math.sqrt(9.81 * 2.0), rel=1e-5)
    assert dispersion(0.0, 10.0) == 0.0


@pytest.mark.parametrize("s", [1.0, 4.0, 12.5, 75.0])
def test_spreading_has_unit_integral_and_its_quantiles(s):
    whole = quad(lambda a: float(spreading(a, s)), -math.pi, math.pi, points=[0.0], epsrel=1e-12)[0]
    assert whole == pytest.approx(1.0, rel=1e-10)
    for part in (0.05, 0.5, 0.8):
        angle = float(spreading_quantile(part, s))
        below = quad(lambda a: float(spreading(a, s)), -math.pi, angle, points=[-0.1], epsrel=1e-12)[0]
        assert below == pytest.approx(part, rel=1e-8)


@pytest.mark.parametrize(
    ("height", "period", "words"),
    [
        (0.0, 8.0, "height"),
        (-1.0, 8.0, "> 0 m"),
        (math.nan, 8.0, "> 0 m"),
        (1.0, 0.0, "period"),
        (3.0, 3.0, "beyond breaking"),
        (165.0, 12.0, "in metres"),
        (1.0, 600.0, "in seconds"),
    ],
)
def test_impossible_seas_are_refused(height, period, words):
    with pytest.raises(InputError, match=words):
        jonswap(height, period)


def test_shallow_water_breaks_waves_that_deep_water_carries():
    check_steepness(4.0, 8.0)
    with pytest.raises(InputError, match="beyond breaking"):
        check_steepness(4.0, 8.0, depth=3.0)


def test_degrees_and_other_mistakes_are_refused():
    with pytest.raises(InputError, match="degrees"):
        check_angle(45.0)
    check_angle(-2.0 * math.pi)
    with pytest.raises(InputError, match="peakedness"):
        jonswap(1.0, 8.0, 33.0)
    with pytest.raises(InputError, match="depth"):
        dispersion(1.0, 0.0)
    with pytest.raises(InputError, match="increasing"):
        tabulated_spectrum([0.5, 0.4], [1.0, 1.0])
    with pytest.raises(InputError, match="negative"):
        tabulated_spectrum([0.5, 0.6], [1.0, -1.0])
