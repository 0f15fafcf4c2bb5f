"""Waves as sums of components: regular, irregular from a spectrum, or through a measured elevation.

The elevation is ``Re sum_m a_m exp(i (k_m . x) - i (omega_m t + eps_m))`` with ``k_m = k (cos b, sin b)``; directions
are those of propagation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.water.waves.spectra import (
    WaveSpectrum,
    check_angle,
    check_steepness,
    dispersion,
    spreading_quantile,
)

__all__ = ["WaveTrains", "irregular_waves", "measured_waves", "regular_wave", "superposition"]

ENERGY_BELOW = 5e-4
"""Part of m0 that may lie below the lowest component of an irregular sea."""

ENERGY_ABOVE = 5e-3
"""Part of m0 that may lie above the highest: those waves are metres long and move no hull."""


@dataclass(frozen=True, eq=False)
class WaveTrains:
    """Components of a sea.

    Attributes
    ----------
    omega
        Circular frequencies [rad/s], > 0, shape (m,).
    wavenumber
        k [1/m], of the same depth, shape (m,).
    direction
        Of propagation, from world +x anticlockwise [rad], shape (m,).
    amplitude
        [m], >= 0, shape (m,).
    phase
        eps [rad], shape (m,).
    depth, gravity
        [m] (``inf`` for deep water) and [m/s^2] of the dispersion relation.
    peak_period
        Of the most energetic part [s]; ramps are measured in it.
    repeat_period
        After it the elevation repeats [s]; ``inf`` for components whose frequencies have no common measure.
    seeds
        Seeds of the random generators, one a random train.
    description
        Words for reports.
    """

    omega: NDArray[np.float64]
    wavenumber: NDArray[np.float64]
    direction: NDArray[np.float64]
    amplitude: NDArray[np.float64]
    phase: NDArray[np.float64]
    depth: float
    gravity: float
    peak_period: float
    repeat_period: float
    seeds: tuple[int, ...] = ()
    description: str = ""

    @property
    def variance(self) -> float:
        """m0 of the components [m^2], the variance of the elevation over a long time."""
        return float(0.5 * np.sum(self.amplitude**2))

    @property
    def significant_height(self) -> float:
        """Four standard deviations of the elevation [m]."""
        return 4.0 * math.sqrt(self.variance)

    def elevation(self, x: ArrayLike, y: ArrayLike, t: ArrayLike) -> NDArray[np.float64]:
        """Elevation above the still water [m] at places and times that broadcast against each other.

        Parameters
        ----------
        x, y
            World place [m].
        t
            Time [s].
        """
        px, py, time = np.broadcast_arrays(*(np.asarray(v, dtype=np.float64) for v in (x, y, t)))
        flat = np.zeros(px.size)
        kx = self.wavenumber * np.cos(self.direction)
        ky = self.wavenumber * np.sin(self.direction)
        rows = max(1, 1_000_000 // max(1, len(self.omega)))  # bounds the memory of the table of phases
        for first in range(0, px.size, rows):
            part = slice(first, first + rows)
            angle = (
                np.multiply.outer(px.ravel()[part], kx)
                + np.multiply.outer(py.ravel()[part], ky)
                - np.multiply.outer(time.ravel()[part], self.omega)
                - self.phase
            )
            flat[part] = np.sum(self.amplitude * np.cos(angle), axis=1)
        return flat.reshape(px.shape)


def regular_wave(
    height: float,
    period: float,
    direction: float = 0.0,
    *,
    phase: float = 0.0,
    depth: float = math.inf,
    gravity: float = 9.81,
    name: str = "regular wave",
) -> WaveTrains:
    """One component: a sinusoidal wave.

    Parameters
    ----------
    height
        Trough to crest [m], twice the amplitude.
    period
        [s].
    direction
        Of propagation [rad].
    phase
        eps [rad]; with 0 a crest is at the origin at t = 0, with pi/2 it was there a quarter of a period before.
    depth, gravity
        [m], [m/s^2].
    name
        For messages.

    Raises
    ------
    InputError
        If a value is out of range or the wave would break.
    """
    check_steepness(height, period, depth=depth, gravity=gravity, source=name)
    check_angle(direction, source=name)
    check_angle(phase, key="phase", source=name)
    w = np.array([2.0 * math.pi / period])
    return WaveTrains(
        omega=w,
        wavenumber=dispersion(w, depth, gravity),
        direction=np.array([float(direction)]),
        amplitude=np.array([0.5 * height]),
        phase=np.array([float(phase)]),
        depth=float(depth),
        gravity=float(gravity),
        peak_period=float(period),
        repeat_period=float(period),
        description=f"regular, height {height:g} m, period {period:g} s",
    )


def irregular_waves(
    spectrum: WaveSpectrum,
    *,
    seed: int,
    direction: float = 0.0,
    count: int = 200,
    bins: str = "random",
    amplitudes: str = "deterministic",
    spreading: float | None = None,
    directions: int = 1,
    frequency_range: tuple[float, float] | None = None,
    depth: float = math.inf,
    gravity: float = 9.81,
    name: str = "irregular waves",
) -> WaveTrains:
    """A realisation of a spectrum.

    Parameters
    ----------
    spectrum
        Of the elevation at a point.
    seed
        Of ``Generator(PCG64(seed))``, the only source of chance: same seed, same bits.
    direction
        Mean direction of propagation [rad].
    count
        Frequency bins of equal width.
    bins
        ``"random"``: one random frequency in each bin, no repetition. ``"equal"``: frequencies that are multiples
        of the bin width dw, so that the elevation repeats after 2 pi / dw.
    amplitudes
        ``"deterministic"``: each component has the energy of its bin, so that all seeds have the same variance.
        ``"rayleigh"``: random ones of that mean energy, as in a Gaussian sea.
    spreading
        Exponent s of the cos^2s distribution of directions (half the angle), see `spectra.spreading`; None: all
        travel in the mean direction.
    directions
        Components in a frequency bin, each with its own frequency and with one random direction from its own of so
        many sectors of equal energy. Never two directions at one frequency: they would stand still as a pattern.
    frequency_range
        [rad/s]; by default all but the lowest 0.05 % and the highest 0.5 % of m0. The components are scaled to the
        energy of the whole spectrum, so that the significant height is kept.
    depth, gravity
        [m], [m/s^2].
    name
        For messages.

    Raises
    ------
    InputError
        If an option is unknown, a number is out of range, or the waves would break at this depth.
    """
    check_angle(direction, source=name)
    check_steepness(
        spectrum.significant_height,
        spectrum.peak_period,
        depth=depth,
        gravity=gravity,
        what="significant height",
        source=name,
    )
    _check_options(seed, count, bins, amplitudes, spreading, directions, name)
    low, high = frequency_range or (spectrum.quantile(ENERGY_BELOW), spectrum.quantile(1.0 - ENERGY_ABOVE))
    inside = float(spectrum.energy(low, high)[0]) if 0.0 <= low < high else 0.0
    whole = spectrum.moment(0)
    if inside < 0.8 * whole:
        raise InputError(
            f"{low:.3g} to {high:.3g} rad/s holds {inside / whole:.0%} of the energy",
            source=name,
            key="frequency_range",
            expected="a range [rad/s] around the peak, with at least 80 %",
        )
    generator = np.random.Generator(np.random.PCG64(seed))
    components = count * directions
    width = (high - low) / components
    if bins == "random":
        edges = low + width * np.arange(components + 1)
        omega = edges[:-1] + width * generator.random(components)
    else:
        first = max(1, round(low / width + 0.5))
        omega = width * np.arange(first, first + components, dtype=np.float64)
        edges = width * (np.arange(first, first + components + 1, dtype=np.float64) - 0.5)
    energy = spectrum.energy(edges[:-1], edges[1:])
    energy *= whole / float(np.sum(energy))
    phase = 2.0 * math.pi * generator.random(components)
    amplitude = np.sqrt(2.0 * energy)
    if amplitudes == "rayleigh":
        amplitude *= np.sqrt(generator.exponential(size=components))
    angle = np.full(components, float(direction))
    if spreading is not None:
        sector = np.concatenate([generator.permutation(directions) for _ in range(count)])
        angle = direction + spreading_quantile(
            (sector + generator.random(components)) / directions, spreading
        )
    return WaveTrains(
        omega=omega,
        wavenumber=dispersion(omega, depth, gravity),
        direction=angle,
        amplitude=amplitude,
        phase=phase,
        depth=float(depth),
        gravity=float(gravity),
        peak_period=spectrum.peak_period,
        repeat_period=math.inf if bins == "random" else 2.0 * math.pi / width,
        seeds=(int(seed),),
        description=f"{spectrum.name}, Hs {spectrum.significant_height:.4g} m, Tp {spectrum.peak_period:.4g} s, "
        f"{components} components, seed {seed}",
    )


def measured_waves(
    times: ArrayLike,
    values: ArrayLike,
    *,
    direction: float = 0.0,
    place: tuple[float, float] = (0.0, 0.0),
    frequency_range: tuple[float, float] | None = None,
    depth: float = math.inf,
    gravity: float = 9.81,
    name: str = "elevation record",
) -> WaveTrains:
    """Components of a given elevation at one place, by discrete Fourier transform.

    Parameters
    ----------
    times
        Equally spaced [s], shape (n,), n >= 8.
    values
        Elevation [m], shape (n,); the mean is taken off.
    direction
        Of propagation of all components [rad].
    place
        World x, y at which it was measured [m].
    frequency_range
        Components outside [rad/s] are left out; by default all that carry more than 1e-12 of the variance.
    depth, gravity
        [m], [m/s^2].
    name
        Of the file, for messages.

    Raises
    ------
    InputError
        If times are not equally spaced, a value is not finite or too high, or nothing is left.

    Notes
    -----
    The record repeats after its length n dt; a jump between its ends spreads over all frequencies.
    """
    check_angle(direction, source=name)
    t, eta = np.asarray(times, dtype=np.float64), np.asarray(values, dtype=np.float64)
    if t.ndim != 1 or t.shape != eta.shape or len(t) < 8:
        raise InputError(f"times of shape {t.shape}, values of shape {eta.shape}", source=name,
                         expected="two columns of one length, at least 8 rows")  # fmt: skip
    step = (t[-1] - t[0]) / (len(t) - 1)
    if not np.all(np.isfinite(t)) or not step > 0.0 or np.any(np.abs(np.diff(t) - step) > 1e-3 * step):
        raise InputError(
            "times are not equally spaced", source=name, key="times", expected="one step [s], increasing"
        )
    if not np.all(np.isfinite(eta)) or np.ptp(eta) > 60.0:
        raise InputError("an elevation is not finite, or the range exceeds 60 m", source=name, key="values",
                         expected="metres")  # fmt: skip
    n = len(eta)
    transform = np.fft.rfft(eta - np.mean(eta))
    omega = 2.0 * math.pi * np.fft.rfftfreq(n, step)
    amplitude = 2.0 * np.abs(transform) / n
    if n % 2 == 0:
        amplitude[-1] *= 0.5  # the highest frequency stands once in the transform of a real record
    power = amplitude**2
    keep = (omega > 0.0) & (power > 1e-12 * np.sum(power))
    if frequency_range is not None:
        keep &= (omega >= frequency_range[0]) & (omega <= frequency_range[1])
    if not np.any(keep):
        raise InputError("no component is left", source=name, key="frequency_range",
                         expected="rad/s, a range in which the record has energy")  # fmt: skip
    omega, amplitude = omega[keep], amplitude[keep]
    k = dispersion(omega, depth, gravity)
    along = place[0] * math.cos(direction) + place[1] * math.sin(direction)
    # a cos(omega (t - t0) + arg) at the place is a cos(k . x - omega t - eps) there
    phase = np.angle(transform[keep]) - omega * t[0] + k * along
    return WaveTrains(
        omega=omega,
        wavenumber=k,
        direction=np.full(len(omega), float(direction)),
        amplitude=amplitude,
        phase=np.mod(phase, 2.0 * math.pi),
        depth=float(depth),
        gravity=float(gravity),
        peak_period=float(2.0 * math.pi / omega[np.argmax(amplitude)]),
        repeat_period=n * step,
        description=f"measured elevation, {n} samples every {step:g} s, {len(omega)} components",
    )


def superposition(trains: Sequence[WaveTrains]) -> WaveTrains:
    """All components of several trains, e.g. of wind sea and swell.

    Raises
    ------
    InputError
        If there is none, or depths or gravities differ.
    """
    if not trains:
        raise InputError("no wave train", expected="at least one")
    if len(trains) == 1:
        return trains[0]
    first = trains[0]
    if any(one.depth != first.depth or one.gravity != first.gravity for one in trains):
        raise InputError(
            "wave trains of different depth or gravity", key="depth", expected="one sea, one depth"
        )
    strongest = max(trains, key=lambda one: one.variance)
    return WaveTrains(
        omega=np.concatenate([one.omega for one in trains]),
        wavenumber=np.concatenate([one.wavenumber for one in trains]),
        direction=np.concatenate([one.direction for one in trains]),
        amplitude=np.concatenate([one.amplitude for one in trains]),
        phase=np.concatenate([one.phase for one in trains]),
        depth=first.depth,
        gravity=first.gravity,
        peak_period=strongest.peak_period,
        repeat_period=math.inf,
        seeds=tuple(seed for one in trains for seed in one.seeds),
        description="; ".join(one.description for one in trains),
    )


def _check_options(
    seed: int, count: int, bins: str, amplitudes: str, spreading: float | None, directions: int, name: str
) -> None:
    """Refuse unknown words and counts out of range."""
    for key, value, known in (
        ("bins", bins, ("random", "equal")),
        ("amplitudes", amplitudes, ("deterministic", "rayleigh")),
    ):
        if value not in known:
            raise InputError(f"{value!r}", source=name, key=key, expected=" or ".join(known))
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise InputError(f"seed {seed!r}", source=name, key="seed", expected="an integer >= 0")
    if count < 10 or directions < 1 or count * directions > 100_000:
        raise InputError(
            f"{count} frequencies and {directions} directions",
            source=name,
            key="count",
            expected="at least 10 frequencies (200 is usual) and 1 direction, at most 100,000 components",
        )
    if spreading is None and directions > 1:
        raise InputError(f"{directions} directions without spreading", source=name, key="spreading",
                         expected="the exponent s of cos^2s")  # fmt: skip
    if spreading is not None and not (0.0 < spreading <= 1000.0):
        raise InputError(
            f"spreading exponent {spreading:g}", source=name, key="spreading", expected="above 0, to 1000"
        )
