"""Mean wind, gusts and turbulence over the sea: the NPD spectrum of ISO 19901-1.

All of it hangs on one number, the mean speed over **one hour** at 10 m above the water. Spectra are one-sided, per Hz.

Notes
-----
"Integrated simulation ... ships and offshore structures" (2018), eqs. (226), (227), where the exponent n = 0.468,
the unit and the averaging time are left out; ISO 19901-1, Petroleum and natural gas industries, Metocean design
and operating considerations, wind. The spectrum holds from 1/600 to 0.5 Hz.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError

__all__ = [
    "HIGHEST_FREQUENCY",
    "HOUR",
    "LARGEST_CURRENT",
    "LARGEST_WIND",
    "LOWEST_FREQUENCY",
    "POWER_EXPONENT",
    "REFERENCE_HEIGHT",
    "WindComponents",
    "averaging_factor",
    "check_speed",
    "gust_coefficient",
    "gust_speed",
    "hourly_mean",
    "log_profile",
    "npd_coherence",
    "npd_spectrum",
    "profile_slope",
    "standard_deviation",
    "turbulence_intensity",
    "wind_components",
    "wind_record",
]

REFERENCE_HEIGHT = 10.0
"""Height [m] above the water at which the mean wind is given."""

HOUR = 3600.0
"""Averaging time [s] of the mean wind in all formulae."""

LOWEST_FREQUENCY, HIGHEST_FREQUENCY = 1.0 / 600.0, 0.5
"""Range [Hz] of the spectrum."""

POWER_EXPONENT = 0.11
"""Of the power law."""

LARGEST_WIND, LARGEST_CURRENT = 75.0, 10.0
"""Speeds [m/s] beyond which a number is taken for a slip of units."""

KNOT = 0.514444

SPECTRAL_EXPONENT = 0.468
"""n of the spectrum."""

COHERENCE = np.array([[2.9, 1.0, 0.4, 0.92], [45.0, 1.0, 0.4, 0.92], [13.0, 1.25, 0.5, 0.85]])
"""alpha, q, p and r of the coherence: along the wind, across it, vertical."""

QUADRATURE_POINTS = 8
"""Gauss points for the variance in a bin, over the logarithm of the frequency."""

BLOCK = 65536
"""Times that are summed at once."""

Array = NDArray[np.float64]


def check_speed(speed: float, *, source: object, key: str, largest: float = LARGEST_WIND) -> float:
    """A speed [m/s] that can be one.

    Raises
    ------
    InputError
        If it is negative, not finite or too large, as a number that was meant in knots or km/h is.
    """
    if 0.0 <= speed <= largest:
        return float(speed)
    problem, expected = f"{speed:g} m/s", f"a speed from 0 to {largest:g} m/s"
    if largest < speed < math.inf:
        expected += f'; in knots "{speed:g} knot" is {speed * KNOT:.4g} m/s'
    elif speed < 0.0:
        expected += "; the direction says where it goes"
    raise InputError(problem, source=source, key=key, expected=expected)


def npd_spectrum(frequency: ArrayLike, speed: float, height: float = REFERENCE_HEIGHT) -> Array:
    """Spectral density of the wind speed [m2/s2 per Hz], one-sided, shape of the frequencies.

    Parameters
    ----------
    frequency
        [Hz].
    speed
        One-hour mean at 10 m [m/s], positive.
    height
        Above the water [m].

    Notes
    -----
    Eq. (227) with n = 0.468::

        S(f) = 320 (U0/10)^2 (z/10)^0.45 / (1 + f~^n)^(5/(3n)),   f~ = 172 f (z/10)^(2/3) (U0/10)^-0.75
    """
    f = np.asarray(frequency, dtype=np.float64)
    reduced = 172.0 * f * (height / 10.0) ** (2.0 / 3.0) * (speed / 10.0) ** -0.75
    scale = 320.0 * (speed / 10.0) ** 2 * (height / 10.0) ** 0.45
    return np.asarray(
        scale / (1.0 + reduced**SPECTRAL_EXPONENT) ** (5.0 / (3.0 * SPECTRAL_EXPONENT)), dtype=np.float64
    )


def profile_slope(speed: float) -> float:
    """C of the logarithmic profile, from the one-hour mean at 10 m [m/s]."""
    return 0.0573 * math.sqrt(1.0 + 0.15 * speed)


def log_profile(height: float, speed: float) -> float:
    """One-hour mean [m/s] at a height [m]: ``U0 (1 + C ln(z/10))`` (ISO 19901-1), 0 where that is negative."""
    return max(speed * (1.0 + profile_slope(speed) * math.log(height / REFERENCE_HEIGHT)), 0.0)


def turbulence_intensity(height: float, speed: float) -> float:
    """Standard deviation of the speed by its mean: ``Iu = 0.06 (1 + 0.043 U0) (z/10)^-0.22`` (ISO 19901-1)."""
    return float(0.06 * (1.0 + 0.043 * speed) * (height / REFERENCE_HEIGHT) ** -0.22)


def gust_coefficient(duration: float, speed: float) -> float:
    """What the mean over a shorter time [s] has more at 10 m, relative to the one-hour mean [m/s].

    Raises
    ------
    InputError
        If the time is not positive or longer than an hour.
    """
    if not 0.0 < duration <= HOUR:
        raise InputError(
            f"averaging time {duration:g} s", source="wind", key="averaging_time", expected="0 to 3600 s"
        )
    return -0.41 * turbulence_intensity(REFERENCE_HEIGHT, speed) * math.log(duration / HOUR)


def averaging_factor(duration: float, height: float, speed: float) -> float:
    """Mean over a shorter time [s] by the one-hour mean: ``1 - 0.41 Iu(z) ln(t/3600)`` (ISO 19901-1)."""
    return 1.0 + gust_coefficient(duration, speed) * (height / REFERENCE_HEIGHT) ** -0.22


def gust_speed(duration: float, height: float, speed: float) -> float:
    """Mean over a shorter time [s] at a height [m], from the one-hour mean at 10 m [m/s]."""
    return log_profile(height, speed) * averaging_factor(duration, height, speed)


def hourly_mean(speed: float, duration: float, height: float = REFERENCE_HEIGHT) -> float:
    """One-hour mean at 10 m [m/s] of a wind whose mean over a shorter time [s] at a height [m] is given.

    Raises
    ------
    InputError
        If the speed, the time or the height make no sense.
    """
    check_speed(speed, source="wind", key="speed")
    if not 1.0 <= height <= 1000.0:
        raise InputError(f"height {height:g} m", source="wind", key="height", expected="1 to 1000 m")
    gust_coefficient(duration, 0.0)
    low, high = 0.0, 4.0 * speed
    for _ in range(200):  # gust_speed grows with the mean; bisection until no number lies between
        middle = 0.5 * (low + high)
        if middle in {low, high}:
            break
        if gust_speed(duration, height, middle) < speed:
            low = middle
        else:
            high = middle
    return high


def npd_coherence(frequency: ArrayLike, point_a: ArrayLike, point_b: ArrayLike, speed: float) -> Array:
    """Coherence of the wind speed at two points, 1 where they coincide; shape of the frequencies.

    Parameters
    ----------
    frequency
        [Hz].
    point_a, point_b
        Along the wind, across it, height above the water [m], shape (3,).
    speed
        One-hour mean at 10 m [m/s].

    Notes
    -----
    ISO 19901-1 (in API RP 2A and DNV-RP-C205 with the same numbers, as Froya coherence), over three distances::

        Coh = exp( -sqrt(sum A_i^2) / U0 ),   A_i = alpha_i f^r_i |d_i|^q_i z_g^-p_i,   z_g = sqrt(z_a z_b) / 10

    Taken as ``|S_ab| / sqrt(S_a S_b)``. Where it is read as the square of that, as "squared correlation" suggests,
    points are correlated more: then take its root.
    """
    f = np.asarray(frequency, dtype=np.float64)
    a, b = np.asarray(point_a, dtype=np.float64), np.asarray(point_b, dtype=np.float64)
    mean_height = math.sqrt(a[2] * b[2]) / REFERENCE_HEIGHT
    total = np.zeros_like(f)
    for (alpha, q, p, r), distance in zip(COHERENCE, np.abs(b - a), strict=True):
        total += (alpha * f**r * distance**q * mean_height**-p) ** 2
    return np.asarray(np.exp(-np.sqrt(total) / speed), dtype=np.float64)


def _bin_variances(edges: Array, speed: float, height: float) -> Array:
    """Variance [m2/s2] in each bin of frequencies: Gauss quadrature over the logarithm of the frequency."""
    nodes, weights = np.polynomial.legendre.leggauss(QUADRATURE_POINTS)
    low, high = np.log(edges[:-1, None]), np.log(edges[1:, None])
    f = np.exp(0.5 * (low + high) + 0.5 * (high - low) * nodes)
    return np.asarray(
        np.sum(weights * f * npd_spectrum(f, speed, height), axis=1) * 0.5 * (high - low)[:, 0],
        dtype=np.float64,
    )


def standard_deviation(
    speed: float,
    height: float = REFERENCE_HEIGHT,
    lowest: float = LOWEST_FREQUENCY,
    highest: float = HIGHEST_FREQUENCY,
) -> float:
    """Standard deviation of the wind speed [m/s] in a range of frequencies [Hz]: the integral of the spectrum."""
    return math.sqrt(float(np.sum(_bin_variances(np.geomspace(lowest, highest, 33), speed, height))))


@dataclass(frozen=True, eq=False)
class WindComponents:
    """Harmonic components of the fluctuation of the wind speed at some points.

    ``u_j(t) = Re sum_m amplitudes[j, m] exp( i 2 pi frequencies[m] t )``

    Attributes
    ----------
    frequencies
        [Hz], increasing, shape (n,).
    amplitudes
        Complex [m/s], shape (points, n).
    seed
        Of the random numbers.
    """

    frequencies: Array
    amplitudes: NDArray[np.complex128]
    seed: int


def wind_components(
    speed: float,
    points: ArrayLike = (0.0, 0.0, REFERENCE_HEIGHT),
    *,
    seed: int,
    count: int = 200,
    lowest: float = LOWEST_FREQUENCY,
    highest: float = HIGHEST_FREQUENCY,
) -> WindComponents:
    """Components of the NPD spectrum, at one point or, with the coherence of ISO 19901-1, at several.

    Parameters
    ----------
    speed
        One-hour mean at 10 m [m/s].
    points
        Along the wind, across it, height above the water [m]; shape (3,) or (points, 3).
    seed
        Of a PCG64 generator of its own: the same seed gives bitwise identical numbers.
    count
        Bins, equal in the logarithm of the frequency, with one random frequency in each, so that nothing repeats.
        Each carries the variance of its bin exactly.
    lowest, highest
        Range [Hz]; from 1/3600 for what an hour holds.

    Raises
    ------
    InputError
        If the speed, a height, the count or the range make no sense.

    Notes
    -----
    Amplitudes of several points are ``a_j L_j`` with a random phase for each column of L, ``L L^T`` being the matrix
    of coherences of a frequency (Shinozuka, Digital simulation of random processes and its applications, 1972).
    """
    check_speed(speed, source="wind", key="speed")
    places = np.atleast_2d(np.asarray(points, dtype=np.float64))
    if places.shape[1:] != (3,) or not np.all(places[:, 2] > 0.0):
        raise InputError(
            f"points {places.tolist()}",
            source="wind",
            key="height",
            expected="along the wind, across it, height above the water, in m, heights positive",
        )
    if count < 1:
        raise InputError(f"{count} components", source="wind", key="components", expected="200 or more")
    if not 1.0 / HOUR * (1.0 - 1e-9) <= lowest < highest <= HIGHEST_FREQUENCY:
        raise InputError(
            f"frequencies from {lowest:g} to {highest:g} Hz",
            source="wind",
            key="frequencies",
            expected="a range in 1/600 to 0.5 Hz, or from 1/3600 Hz",
        )
    generator = np.random.Generator(np.random.PCG64(seed))
    edges = np.geomspace(lowest, highest, count + 1)
    f = edges[:-1] * (edges[1:] / edges[:-1]) ** generator.random(count)
    phases = 2.0 * np.pi * generator.random((len(places), count))
    if speed == 0.0:
        return WindComponents(f, np.zeros((len(places), count), dtype=np.complex128), seed)
    sizes = np.sqrt([2.0 * _bin_variances(edges, speed, height) for height in places[:, 2]])
    shares = _coherence_roots(f, places, speed)
    return WindComponents(f, sizes * np.einsum("mjk,km->jm", shares, np.exp(1j * phases)), seed)


def _coherence_roots(f: Array, places: Array, speed: float) -> Array:
    """L with ``L L^T`` the matrix of coherences of each frequency, shape (frequencies, points, points)."""
    matrix = np.ones((len(f), len(places), len(places)))
    for j in range(len(places)):
        for k in range(j):
            matrix[:, j, k] = matrix[:, k, j] = npd_coherence(f, places[j], places[k], speed)
    if len(places) == 1:
        return matrix
    # the empirical function may leave eigenvalues a little below zero; lengths of the rows keep the variances
    values, vectors = np.linalg.eigh(matrix)
    roots = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    return np.asarray(roots / np.linalg.norm(roots, axis=2, keepdims=True), dtype=np.float64)


def wind_record(components: WindComponents, times: ArrayLike, point: int = 0) -> Array:
    """Fluctuation of the wind speed [m/s] at times [s], at one of the points; shape of the times."""
    t = np.asarray(times, dtype=np.float64)
    out = np.zeros(t.size)
    flat = t.ravel()
    for start in range(0, t.size, BLOCK):
        part, block = out[start : start + BLOCK], flat[start : start + BLOCK]
        for f, amplitude in zip(components.frequencies, components.amplitudes[point], strict=True):
            part += abs(amplitude) * np.cos(2.0 * np.pi * f * block + np.angle(amplitude))
    return out.reshape(t.shape)
