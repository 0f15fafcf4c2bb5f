"""Wave spectra: JONSWAP, Pierson-Moskowitz and tables, their moments, spreading, and the dispersion relation."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError

__all__ = [
    "STEEPNESS_LIMIT",
    "WaveSpectrum",
    "check_angle",
    "check_steepness",
    "dispersion",
    "jonswap",
    "pierson_moskowitz",
    "spreading",
    "spreading_quantile",
    "tabulated_spectrum",
]

STEEPNESS_LIMIT = 0.142
"""Height over length of the steepest regular wave in deep water (Michell 1893)."""

LONGEST_PERIOD = 60.0
"""[s]; longer waves are not wind waves but swell of no known storm, and mostly a period in other units."""

HIGHEST_WAVE = 40.0
"""[m]; no significant height above it has been measured: mostly a height in other units."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)


def dispersion(omega: ArrayLike, depth: float, gravity: float = 9.81) -> NDArray[np.float64]:
    """Wave number of small waves, ``omega^2 = g k tanh(k h)``.

    Parameters
    ----------
    omega
        Circular frequencies [rad/s], not negative, any shape.
    depth
        Water depth h [m]; ``inf`` for deep water.
    gravity
        [m/s^2].

    Returns
    -------
    NDArray
        Wave numbers [1/m], same shape, to 1e-14 relative.

    Raises
    ------
    InputError
        If a frequency is negative or not finite, or the depth or gravity is not positive.

    Notes
    -----
    Newton on ``y tanh y = x`` with ``x = omega^2 h / g`` from the start of Fenton and McKee (1990), which is
    within 1.5 % everywhere: quadratic convergence needs four steps at most.
    """
    w = np.asarray(omega, dtype=np.float64)
    if not np.all(np.isfinite(w)) or np.any(w < 0.0):
        raise InputError("a wave frequency is negative or not finite", key="omega", expected="rad/s, >= 0")
    if not depth > 0.0:
        raise InputError(f"water depth {depth:g} m", key="depth", expected="> 0, or inf for deep water")
    if not (gravity > 0.0 and math.isfinite(gravity)):
        raise InputError(f"gravity {gravity:g} m/s^2", key="gravity", expected="> 0")
    if math.isinf(depth):
        return np.asarray(w * w / gravity)
    x = np.maximum(w * w * depth / gravity, 1e-300)
    y = x / np.tanh(x**0.75) ** (2.0 / 3.0)
    for _ in range(5):
        t = np.tanh(y)
        y = y - (y * t - x) / (t + y * (1.0 - t * t))
    return np.asarray(np.where(w > 0.0, y / depth, 0.0))


@dataclass(frozen=True, eq=False)
class WaveSpectrum:
    """A one-sided spectrum of the elevation at a point, over circular frequency.

    Attributes
    ----------
    name
        Words for reports, e.g. ``"JONSWAP"``.
    density
        S(omega) [m^2 s/rad] of an array [rad/s], zero outside the support.
    breaks
        Frequencies [rad/s] between which the density is smooth and well resolved by eight Gauss points,
        shape (panels + 1,).
    tail
        Whether the density continues beyond the last break as ``omega^-5 exp(-c omega^-4)``.
    peak_frequency
        [rad/s]; of the largest density.
    """

    name: str
    density: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    breaks: NDArray[np.float64]
    tail: bool
    peak_frequency: float

    @property
    def peak_period(self) -> float:
        """Tp [s]."""
        return 2.0 * math.pi / self.peak_frequency

    @property
    def significant_height(self) -> float:
        """Hs [m], four times the standard deviation of the elevation."""
        return 4.0 * math.sqrt(self.moment(0))

    def energy(self, lower: ArrayLike, upper: ArrayLike, order: int = 0) -> NDArray[np.float64]:
        """Integrals of ``omega^order S`` over intervals, in m^2 (rad/s)^order.

        Parameters
        ----------
        lower, upper
            Ends of the intervals [rad/s], shape (k,); an upper end may be infinite.
        order
            Power of the frequency.
        """
        below = np.atleast_1d(np.asarray(lower, dtype=np.float64))
        above = np.atleast_1d(np.asarray(upper, dtype=np.float64))
        last = float(self.breaks[-1])
        ends = np.concatenate([self.breaks, np.minimum(below, last), np.minimum(above, last)])
        points = np.unique(np.maximum(ends, self.breaks[0]))
        # in one pass over all panels between breaks and ends, so that shared parts are integrated once
        half = 0.5 * np.diff(points)
        w = points[:-1, None] + half[:, None] * (1.0 + _NODES)
        sums = half * ((w**order * self.density(w)) @ _WEIGHTS)
        cumulative = np.concatenate([[0.0], np.cumsum(sums)])

        def below_of(x: NDArray[np.float64]) -> NDArray[np.float64]:
            inside = np.clip(x, self.breaks[0], last)
            return np.asarray(cumulative[np.searchsorted(points, inside)]) + self._tail_below(x, order)

        return below_of(above) - below_of(below)

    def moment(self, order: int, upper: float = math.inf) -> float:
        """Spectral moment m_n = int_0^upper omega^n S d omega [m^2 (rad/s)^n].

        Infinite for n >= 4 without an upper end if the spectrum has a tail: omega^-5 decays too slowly.
        """
        if self.tail and order >= 4 and math.isinf(upper):
            return math.inf
        return float(self.energy(0.0, upper, order)[0])

    def mean_period(self, upper: float = math.inf) -> float:
        """T1 = 2 pi m0 / m1 [s]."""
        return 2.0 * math.pi * self.moment(0, upper) / self.moment(1, upper)

    def quantile(self, part: float) -> float:
        """Frequency [rad/s] below which a part of m0 lies, by bisection."""
        total = self.moment(0)
        low, high = float(self.breaks[0]), float(self.breaks[-1])
        while self.tail and self.moment(0, high) < part * total:
            high *= 2.0
        for _ in range(60):
            middle = 0.5 * (low + high)
            if self.moment(0, middle) < part * total:
                low = middle
            else:
                high = middle
        return 0.5 * (low + high)

    def _tail_below(self, x: NDArray[np.float64], order: int) -> NDArray[np.float64]:
        """Integral of ``omega^order S`` from the last break to x, zero for x below; y = 1 / omega is smooth."""
        last = float(self.breaks[-1])
        if not self.tail or np.all(x <= last):
            return np.zeros_like(x)
        low = 1.0 / np.maximum(x, last)  # zero for an infinite end
        half = 0.5 * (1.0 / last - low)
        y = np.maximum(low[:, None] + half[:, None] * (1.0 + _NODES), 1e-300)
        values = self.density(1.0 / y) * y ** (-order - 2)
        return np.asarray(half * (np.where(half[:, None] > 0.0, values, 0.0) @ _WEIGHTS))


def jonswap(
    significant_height: float, peak_period: float, peakedness: float = 3.3, *, renormalise: bool = True
) -> WaveSpectrum:
    """The JONSWAP spectrum.

    Parameters
    ----------
    significant_height
        Hs [m].
    peak_period
        Tp [s].
    peakedness
        gamma, 1 to 10; 1 is Pierson-Moskowitz, 3.3 the mean of the North Sea measurements.
    renormalise
        Scale to Hs exactly; the factor ``1 - 0.287 ln gamma`` alone gives 1.0011 Hs at 3.3.

    Raises
    ------
    InputError
        If a value is out of range or the waves would be steeper than breaking ones.

    Notes
    -----
    ``S = (5/16) Hs^2 wp^4 w^-5 exp(-5/4 (wp/w)^4) gamma^exp(-(w - wp)^2 / (2 s^2 wp^2)) (1 - 0.287 ln gamma)``
    with s = 0.07 below and 0.09 above the peak (Hasselmann et al. 1973; DNV-RP-C205, 3.5.5).
    """
    check_steepness(significant_height, peak_period, what="significant height")
    if not 1.0 <= peakedness <= 10.0:
        raise InputError(f"peakedness {peakedness:g}", key="peakedness", expected="1 to 10 (3.3 is usual)")
    wp = 2.0 * math.pi / peak_period
    scale = 0.3125 * significant_height**2 * wp**4 * (1.0 - 0.287 * math.log(peakedness))
    breaks = wp * np.concatenate([np.linspace(0.2, 0.7, 11), np.linspace(0.7, 1.5, 33)[1:],
                                  np.linspace(1.5, 4.0, 26)[1:]])  # fmt: skip
    breaks[np.argmin(np.abs(breaks - wp))] = wp  # the width jumps there
    name = "Pierson-Moskowitz" if peakedness == 1.0 else f"JONSWAP (peakedness {peakedness:g})"

    def with_scale(factor: float) -> WaveSpectrum:
        return WaveSpectrum(name, partial(_jonswap_density, factor, wp, peakedness), breaks, True, wp)

    plain = with_scale(scale)
    if not renormalise:
        return plain
    return with_scale(scale * significant_height**2 / (16.0 * plain.moment(0)))


def pierson_moskowitz(significant_height: float, peak_period: float) -> WaveSpectrum:
    """Spectrum of a fully developed sea, with two parameters (also Bretschneider, ISSC); see `jonswap`."""
    return jonswap(significant_height, peak_period, 1.0)


def tabulated_spectrum(omega: ArrayLike, density: ArrayLike, *, name: str = "table") -> WaveSpectrum:
    """Spectrum given by a table, linear between its rows and zero outside.

    Parameters
    ----------
    omega
        Circular frequencies [rad/s], increasing, shape (k,), k >= 2.
    density
        S [m^2 s/rad], >= 0, shape (k,).
    name
        Where the table comes from.

    Raises
    ------
    InputError
        If the table is not of this form, holds no energy, or is steeper than breaking waves.
    """
    w, s = np.asarray(omega, dtype=np.float64), np.asarray(density, dtype=np.float64)
    if (
        w.ndim != 1
        or w.shape != s.shape
        or len(w) < 2
        or not np.all(np.isfinite(w))
        or np.any(np.diff(w) <= 0.0)
    ):
        raise InputError(f"frequencies of shape {w.shape}, densities of shape {s.shape}", source=name,
                         key="omega", expected="two columns of one length >= 2, frequencies increasing")  # fmt: skip
    if w[0] < 0.0 or not np.all(np.isfinite(s)) or np.any(s < 0.0) or not np.any(s > 0.0):
        raise InputError("a frequency or density is negative or not finite, or all are zero", source=name,
                         key="density", expected="rad/s and m^2 s/rad, >= 0")  # fmt: skip
    spectrum = WaveSpectrum(name, partial(_table_density, w, s), w, False, float(w[np.argmax(s)]))
    if spectrum.peak_frequency > 0.0:
        check_steepness(
            spectrum.significant_height, spectrum.peak_period, what="significant height", source=name
        )
    return spectrum


def check_steepness(
    height: float,
    period: float,
    *,
    depth: float = math.inf,
    gravity: float = 9.81,
    what: str = "wave height",
    source: str = "",
) -> None:
    """Refuse heights and periods that no wave has, most often a mix-up of units.

    Parameters
    ----------
    height, period
        [m], [s].
    depth, gravity
        [m], [m/s^2].
    what, source
        Words for the message.

    Raises
    ------
    InputError
        If one is not positive or out of range, or the height is beyond breaking,
        ``H > 0.142 L tanh(k h)`` (Miche 1944), L the wave length.
    """
    if not (height > 0.0 and math.isfinite(height)):
        raise InputError(f"{what} {height:g} m", source=source, key="height", expected="> 0 m")
    if not (period > 0.0 and math.isfinite(period)):
        raise InputError(f"wave period {period:g} s", source=source, key="period", expected="> 0 s")
    if height > HIGHEST_WAVE:
        raise InputError(f"{what} {height:g} m", source=source, key="height",
                         expected=f"at most {HIGHEST_WAVE:g} m; is it in metres?")  # fmt: skip
    if period > LONGEST_PERIOD:
        raise InputError(f"wave period {period:g} s", source=source, key="period",
                         expected=f"at most {LONGEST_PERIOD:g} s; is it in seconds?")  # fmt: skip
    k = float(dispersion(2.0 * math.pi / period, depth, gravity))
    length = 2.0 * math.pi / k
    limit = STEEPNESS_LIMIT * length * (1.0 if math.isinf(depth) else math.tanh(k * depth))
    if height > limit:
        raise InputError(
            f"{what} {height:g} m at {period:g} s is beyond breaking: the wave is {length:.3g} m long",
            source=source,
            key="height",
            expected=f"at most {limit:.3g} m (0.142 of the length, less in shallow water)",
        )


def check_angle(angle: float, *, key: str = "direction", source: str = "") -> None:
    """Refuse angles beyond a full turn: in radians they are meant as degrees.

    Raises
    ------
    InputError
        If the angle is not finite or its magnitude is above 2 pi.
    """
    if not math.isfinite(angle) or abs(angle) > 2.0 * math.pi + 1e-9:
        raise InputError(f"angle {angle:g}", source=source, key=key,
                         expected="radians between -2 pi and 2 pi; are these degrees?")  # fmt: skip


def spreading(angle: ArrayLike, exponent: float) -> NDArray[np.float64]:
    """Directional distribution ``D = C cos^2s(angle / 2)`` [1/rad], integral one over a full turn.

    Parameters
    ----------
    angle
        From the mean direction [rad], any shape, within [-pi, pi].
    exponent
        s > 0; the standard deviation is about sqrt(2 / (1 + s)) rad.

    Notes
    -----
    Longuet-Higgins, Cartwright and Smith (1963); ``C = Gamma(s + 1) / (2 sqrt(pi) Gamma(s + 1/2))``.
    """
    if not (exponent > 0.0 and math.isfinite(exponent)):
        raise InputError(f"spreading exponent {exponent:g}", key="spreading", expected="s > 0")
    scale = math.exp(math.lgamma(exponent + 1.0) - math.lgamma(exponent + 0.5)) / (2.0 * math.sqrt(math.pi))
    return np.asarray(scale * np.abs(np.cos(0.5 * np.asarray(angle, dtype=np.float64))) ** (2.0 * exponent))


def spreading_quantile(part: ArrayLike, exponent: float) -> NDArray[np.float64]:
    """Angle from the mean direction [rad] below which a part (0 to 1) of the energy travels.

    Notes
    -----
    With ``u = sin(angle / 2)`` the distribution is that of Student-like ``(1 - u^2)^(s - 1/2)`` on (-1, 1), so
    that ``(1 + u) / 2`` is beta distributed with both parameters s + 1/2.
    """
    from scipy.special import betaincinv

    if not (exponent > 0.0 and math.isfinite(exponent)):
        raise InputError(f"spreading exponent {exponent:g}", key="spreading", expected="s > 0")
    beta = betaincinv(exponent + 0.5, exponent + 0.5, np.asarray(part, dtype=np.float64))
    return np.asarray(2.0 * np.arcsin(2.0 * beta - 1.0))


def _jonswap_density(scale: float, wp: float, peakedness: float, omega: ArrayLike) -> NDArray[np.float64]:
    w = np.asarray(omega, dtype=np.float64)
    x = np.maximum(w / wp, 1e-3)  # exp(-5/4 x^-4) is zero long before
    width = np.where(x <= 1.0, 0.07, 0.09)
    bump = np.exp(-0.5 * ((x - 1.0) / width) ** 2)
    return np.asarray(scale * wp**-5 * x**-5 * np.exp(-1.25 * x**-4) * peakedness**bump)


def _table_density(w: NDArray[np.float64], s: NDArray[np.float64], omega: ArrayLike) -> NDArray[np.float64]:
    return np.asarray(np.interp(np.asarray(omega, dtype=np.float64), w, s, left=0.0, right=0.0))
