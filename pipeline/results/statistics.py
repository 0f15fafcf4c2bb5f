"""Statistics of channels over time: moments, significant values, extremes over seeds, spectra; and of recorded columns.

Sources: DNV-RP-C205 (2019), sections 3.5 and 3.6; E. J. Gumbel, *Statistics of Extremes* (1958).
"""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.channel_names import split_name

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import ArrayLike, NDArray

    from heavylift.pipeline.results.histories import Results

__all__ = [
    "LEAST_RUNS",
    "PROBABILITY",
    "Column",
    "ColumnStatistics",
    "GumbelFit",
    "PowerSpectrum",
    "RecordStatistics",
    "RunStatistics",
    "at_extreme",
    "chosen_columns",
    "column_statistics",
    "gumbel_fit",
    "power_spectrum",
    "record_statistics",
    "run_statistics",
]

EULER = 0.5772156649015329
"""Mean of the standard Gumbel distribution (Euler's constant)."""


@dataclass(frozen=True)
class RecordStatistics:
    """Of one record, in the unit of the channel.

    Attributes
    ----------
    mean, standard_deviation, minimum, maximum
        Over time, each sample weighted by its share of the duration.
    significant_by_deviation
        Four standard deviations: the significant double amplitude (height) if the record is narrow-banded Gaussian.
    significant_by_cycles
        Mean of the highest third of the ranges between upcrossings of the mean; NaN without a whole cycle.
    largest_range
        The highest of these ranges; NaN without a whole cycle.
    cycles
        Number of whole cycles.
    mean_period
        Between upcrossings [s]; NaN without a whole cycle.
    duration
        [s].
    """

    mean: float
    standard_deviation: float
    minimum: float
    maximum: float
    significant_by_deviation: float
    significant_by_cycles: float
    largest_range: float
    cycles: int
    mean_period: float
    duration: float


@dataclass(frozen=True)
class GumbelFit:
    """Distribution of the extremes of records of one length, ``F(x) = exp(-exp(-(x - mode) / scale))``.

    Attributes
    ----------
    mode
        Most probable extreme, in the unit of the channel.
    scale
        > 0, or zero if all extremes are equal.
    count
        Records.
    mode_error, scale_error
        Standard errors of the two.
    covariance
        Of the two.
    side
        1 for maxima, -1 for minima (the fit is to the mirrored values).
    """

    mode: float
    scale: float
    count: int
    mode_error: float
    scale_error: float
    covariance: float
    side: int = 1

    @property
    def mean(self) -> float:
        """Expected extreme."""
        return self.mode + self.side * EULER * self.scale

    def quantile(self, probability: float) -> float:
        """Extreme that a record stays below (for minima: above) with this probability.

        Raises
        ------
        InputError
            If the probability is not between 0 and 1.
        """
        return self.mode + self.side * self.scale * _reduced(probability)

    def standard_error(self, probability: float) -> float:
        """Standard error of `quantile` from the number of records alone."""
        y = _reduced(probability)
        variance = self.mode_error**2 + 2.0 * y * self.covariance + (y * self.scale_error) ** 2
        return math.sqrt(max(variance, 0.0))

    def band(self, probability: float, confidence: float = 0.9) -> tuple[float, float]:
        """Where `quantile` of the true distribution lies with a confidence, as few records tell, lower value first.

        Notes
        -----
        Of fits by likelihood. The distribution of ``(found - true) / found scale`` depends on the number of records
        alone (L. J. Bain and M. Engelhardt, *Statistical Analysis of Reliability and Life-Testing Models*, 1991), and
        is found from some thousand samples of that size: unlike the standard errors, which are asymptotic, it has the
        bias of small samples.
        """
        low, high = _pivots(self.count, probability, confidence)
        found = self.side * self.quantile(probability)
        ends = sorted(self.side * (found - pivot * self.scale) for pivot in (low, high))
        return ends[0], ends[1]


@dataclass(frozen=True, eq=False)
class PowerSpectrum:
    """One-sided spectrum: its integral over all frequencies is the variance.

    Attributes
    ----------
    frequency
        In Hz, or rad/s, see `per`; shape (k,).
    density
        (unit of the channel)^2 per Hz, or per rad/s; shape (k,).
    per
        ``"Hz"`` or ``"rad/s"``.
    resolution
        Distance of the frequencies.
    segments
        Number of averaged pieces.
    relative_error
        Standard error of a value divided by the value, of Gaussian records.
    """

    frequency: NDArray[np.float64]
    density: NDArray[np.float64]
    per: str
    resolution: float
    segments: int
    relative_error: float


def record_statistics(times: ArrayLike, values: ArrayLike, *, begin: float = -math.inf) -> RecordStatistics:
    """Statistics of one channel.

    Parameters
    ----------
    times
        Increasing [s], shape (n,); steps may differ.
    values
        Shape (n,).
    begin
        Earlier samples are left out [s], e.g. the ramp of the waves.

    Raises
    ------
    InputError
        If fewer than two samples are left, shapes differ, times do not increase or a value is not finite.
    """
    t, x = _record(times, values, begin)
    weights = np.empty(len(t))
    weights[1:-1] = 0.5 * (t[2:] - t[:-2])
    weights[0], weights[-1] = 0.5 * (t[1] - t[0]), 0.5 * (t[-1] - t[-2])
    weights /= np.sum(weights)
    mean = float(weights @ x)
    deviation = math.sqrt(float(weights @ (x - mean) ** 2))
    ranges, period = _cycles(t, x - mean)
    third = np.sort(ranges)[len(ranges) - max(1, round(len(ranges) / 3)) :] if len(ranges) else ranges
    return RecordStatistics(
        mean=mean,
        standard_deviation=deviation,
        minimum=float(np.min(x)),
        maximum=float(np.max(x)),
        significant_by_deviation=4.0 * deviation,
        significant_by_cycles=float(np.mean(third)) if len(ranges) else math.nan,
        largest_range=float(np.max(ranges)) if len(ranges) else math.nan,
        cycles=len(ranges),
        mean_period=period,
        duration=float(t[-1] - t[0]),
    )


def gumbel_fit(extremes: ArrayLike, *, method: str = "likelihood", minima: bool = False) -> GumbelFit:
    """Fit the distribution of the largest value in a record to the extremes of several records (seeds).

    Parameters
    ----------
    extremes
        One of each record of equal length, shape (n,), n >= 3; ten or more give useful errors.
    method
        ``"likelihood"`` (maximum likelihood, the smaller error) or ``"moments"``.
    minima
        The values are minima.

    Raises
    ------
    InputError
        If there are fewer than three, one is not finite, or the method is unknown.

    Notes
    -----
    Moments: ``scale = sqrt(6) s / pi``, ``mode = mean - 0.5772 scale``, with s^2 the unbiased variance. Likelihood:
    the scale solves ``scale = mean - sum x exp(-x / scale) / sum exp(-x / scale)``. Standard errors are the
    asymptotic ones: of the likelihood ``var(mode) = 1.10867 scale^2 / n``, ``var(scale) = 0.60793 scale^2 / n``,
    ``cov = 0.25702 scale^2 / n``; of moments 1.16780, 1.1 and 0.09583 (from the third and fourth moments of the
    distribution).
    """
    x = np.asarray(extremes, dtype=np.float64).ravel()
    if len(x) < 3 or not np.all(np.isfinite(x)):
        raise InputError(f"{len(x)} extremes, or one that is not finite", key="extremes",
                         expected="at least 3 records (10 or more for useful errors)")  # fmt: skip
    if method not in ("likelihood", "moments"):
        raise InputError(f"{method!r}", key="method", expected="likelihood or moments")
    side = -1 if minima else 1
    x = side * x
    n = len(x)
    scale = math.sqrt(6.0 * float(np.var(x, ddof=1))) / math.pi
    mode = float(np.mean(x)) - EULER * scale
    factors = _MOMENT_FACTORS
    if method == "likelihood" and scale > 0.0:
        found = _likelihood_scale(x, np.array(scale))
        scale, mode = float(found), float(_likelihood_mode(x, found))
        factors = _LIKELIHOOD_FACTORS
    unit = scale / math.sqrt(n)
    return GumbelFit(
        mode=side * mode,
        scale=scale,
        count=n,
        mode_error=math.sqrt(factors[0]) * unit,
        scale_error=math.sqrt(factors[1]) * unit,
        covariance=factors[2] * unit**2,
        side=side,
    )


def power_spectrum(
    times: ArrayLike,
    values: ArrayLike,
    *,
    begin: float = -math.inf,
    per: str = "rad/s",
    segment: float | None = None,
) -> PowerSpectrum:
    """Spectrum by Welch's method: Hann windows over segments that overlap by half, the mean taken off.

    Parameters
    ----------
    times
        Equally spaced [s], shape (n,).
    values
        Shape (n,).
    begin
        Earlier samples are left out [s].
    per
        Unit of frequency, ``"rad/s"`` or ``"Hz"``.
    segment
        Length of a segment [s]; by default an eighth of the record. Longer ones resolve more and scatter more.

    Raises
    ------
    InputError
        If times are not equally spaced, or the segment is longer than the record or shorter than eight samples.
    """
    from scipy.signal import welch

    if per not in ("rad/s", "Hz"):
        raise InputError(f"{per!r}", key="per", expected="rad/s or Hz")
    t, x = _record(times, values, begin)
    step = (t[-1] - t[0]) / (len(t) - 1)
    if np.any(np.abs(np.diff(t) - step) > 1e-3 * step):
        raise InputError(
            "times are not equally spaced", key="times", expected="one step [s]; resample the channel"
        )
    length = len(x) // 8 if segment is None else round(segment / step)
    if length < 8 or length > len(x):
        raise InputError(f"segments of {length} samples in a record of {len(x)}", key="segment",
                         expected=f"{8 * step:.3g} to {t[-1] - t[0]:.3g} s")  # fmt: skip
    frequency, density = welch(x, fs=1.0 / step, nperseg=length, detrend="constant", scaling="density")
    segments = 1 + (len(x) - length) // (length - length // 2)
    # neighbours that overlap by half under Hann windows correlate by 1/36 in power (Welch 1967)
    error = math.sqrt((1.0 + 2.0 * (1.0 - 1.0 / segments) / 36.0) / segments)
    if per == "rad/s":
        frequency, density = 2.0 * math.pi * frequency, density / (2.0 * math.pi)
    return PowerSpectrum(frequency, density, per, float(frequency[1]), segments, error)


_LIKELIHOOD_FACTORS = (
    1.0 + 6.0 * (1.0 - EULER) ** 2 / math.pi**2,
    6.0 / math.pi**2,
    6.0 * (1.0 - EULER) / math.pi**2,
)
"""Variance of mode and scale, and covariance, times n / scale^2: the inverse of Fisher's information."""

_SKEW = 1.1395470994046486
_KURTOSIS = 5.4
_ROOT = math.sqrt(6.0) / math.pi
_MOMENT_FACTORS = (
    1.0 / _ROOT**2 - EULER * _SKEW / _ROOT + EULER**2 * (_KURTOSIS - 1.0) / 4.0,
    (_KURTOSIS - 1.0) / 4.0,
    0.5 * _SKEW / _ROOT - EULER * (_KURTOSIS - 1.0) / 4.0,
)
"""The same of the method of moments: var(mean) = s^2 / n, var(s) = s^2 (kurtosis - 1) / 4n, cov = s^2 skew / 2n."""


def _likelihood_scale(x: NDArray[np.float64], start: NDArray[np.float64]) -> NDArray[np.float64]:
    """Root of ``scale - mean + sum x w / sum w`` with ``w = exp(-x / scale)``, increasing in the scale.

    Of samples along the last axis of `x`; `start` are guesses > 0, shape (...,).
    """
    centred = x - np.min(x, axis=-1, keepdims=True)
    mean = np.mean(centred, axis=-1)

    def residual(scale: NDArray[np.float64]) -> NDArray[np.float64]:
        w = np.exp(-centred / scale[..., None])
        return np.asarray(scale - mean + np.sum(centred * w, axis=-1) / np.sum(w, axis=-1))

    low, high = 0.1 * start, 10.0 * start
    while np.any(above := residual(low) > 0.0):
        low = np.where(above, 0.5 * low, low)
    while np.any(below := residual(high) < 0.0):
        high = np.where(below, 2.0 * high, high)
    for _ in range(200):
        middle = 0.5 * (low + high)
        below = residual(middle) < 0.0
        low, high = np.where(below, middle, low), np.where(below, high, middle)
        if np.all(high - low < 1e-15 * high):
            break
    return np.asarray(0.5 * (low + high))


def _likelihood_mode(x: NDArray[np.float64], scale: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mode that belongs to the scale, of samples along the last axis."""
    least = np.min(x, axis=-1)  # keeps the exponentials in range
    weights = np.exp(-(x - least[..., None]) / scale[..., None])
    return np.asarray(least - scale * np.log(np.mean(weights, axis=-1)))


@cache
def _pivots(count: int, probability: float, confidence: float) -> tuple[float, float]:
    """Lower and upper quantile of ``(found quantile - true one) / found scale`` of samples of a size."""
    x = np.random.default_rng(1958).gumbel(size=(max(1000, min(SAMPLES, 200_000 // count)), count))
    scale = _likelihood_scale(x, np.sqrt(6.0) / math.pi * np.std(x, axis=-1, ddof=1))
    y = _reduced(probability)
    pivots = (_likelihood_mode(x, scale) + (scale - 1.0) * y) / scale
    low, high = np.quantile(pivots, [0.5 * (1.0 - confidence), 0.5 * (1.0 + confidence)])
    return float(low), float(high)


def _reduced(probability: float) -> float:
    """Quantile of the standard Gumbel distribution."""
    if not 0.0 < probability < 1.0:
        raise InputError(f"probability {probability:g}", key="probability", expected="between 0 and 1")
    return -math.log(-math.log(probability))


def _record(
    times: ArrayLike, values: ArrayLike, begin: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The samples from `begin` on, checked."""
    t, x = np.asarray(times, dtype=np.float64), np.asarray(values, dtype=np.float64)
    if t.ndim != 1 or t.shape != x.shape:
        raise InputError(
            f"times of shape {t.shape}, values of shape {x.shape}", expected="two columns of one length"
        )
    kept = t >= begin
    t, x = t[kept], x[kept]
    if len(t) < 2 or np.any(np.diff(t) <= 0.0) or not np.all(np.isfinite(x)):
        raise InputError(f"{len(t)} samples from {begin:g} s on, times that do not increase or values not finite",
                         key="times", expected="at least two samples, increasing times, finite values")  # fmt: skip
    return t, x


def _cycles(t: NDArray[np.float64], x: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """Ranges between upcrossings of zero and the mean distance of these."""
    up = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    if len(up) < 2:
        return np.zeros(0), math.nan
    crossings = t[up] - x[up] * (t[up + 1] - t[up]) / (x[up + 1] - x[up])
    first, last = up[0] + 1, up[-1] + 1
    starts = up[:-1] + 1 - first
    part = x[first:last]
    ranges = np.maximum.reduceat(part, starts) - np.minimum.reduceat(part, starts)
    return ranges, float(np.mean(np.diff(crossings)))


PROBABILITY = 0.9
"""Of not being exceeded, of the reported extreme value."""


LEAST_RUNS = 3
"""For a distribution of extremes."""

MOST_TIES = 0.1
"""Part of the runs that may share their extreme."""

SAMPLES = 4000
"""Of a size, from which bands are found."""


SHORTEST = 64
"""Samples from which on a spectrum means something."""


_ANGLES = ("roll", "pitch", "yaw")


class Column(NamedTuple):
    """One number a record: a component of a channel, or an angle of a hull."""

    name: str
    unit: str
    channel: str
    read: Callable[[Results], NDArray[np.float64]]


@dataclass(frozen=True, eq=False)
class RunStatistics:
    """Of one column over one record.

    Attributes
    ----------
    record
        Its statistics.
    spectrum
        None if it is too short.
    every_step
        Whether its extremes are those of all steps.
    """

    record: RecordStatistics
    spectrum: PowerSpectrum | None
    every_step: bool


@dataclass(frozen=True, eq=False)
class ColumnStatistics:
    """Of one column over one or several records of equal length.

    Attributes
    ----------
    column
        Which.
    records
        Statistics of each record.
    spectrum
        Mean over the records; None if they are too short.
    maxima, minima
        Fits to the extremes of the records; None for fewer than three.
    seen
        Of what the extremes are: ``"steps"`` or ``"records"``.
    ties
        How many runs share their largest value, and their smallest one, if more than one does: where that are more than
        a tenth there is a limit, of which no distribution of extremes knows, and no fit.
    """

    column: Column
    records: tuple[RecordStatistics, ...]
    spectrum: PowerSpectrum | None
    maxima: GumbelFit | None
    minima: GumbelFit | None
    seen: str = "records"
    ties: tuple[int, int] = (0, 0)

    def entry(self) -> dict[str, Any]:
        """For a document: means over the records, extremes of all, fits."""
        records = self.records
        mean = {
            key: float(np.nanmean(values)) if np.any(np.isfinite(values)) else None
            for key in (
                "mean",
                "significant_by_deviation",
                "significant_by_cycles",
                "mean_period",
                "duration",
            )
            for values in [np.array([getattr(one, key) for one in records])]
        }
        deviation = math.sqrt(float(np.mean([one.standard_deviation**2 for one in records])))
        found: dict[str, Any] = {
            "channel": self.column.name,
            "unit": self.column.unit,
            "records": len(records),
            "standard_deviation": deviation,
            **mean,
            "minimum": min(one.minimum for one in records),
            "maximum": max(one.maximum for one in records),
            "extremes_of": self.seen,
            "cycles": sum(one.cycles for one in records),
        }
        sides = (("maxima", self.maxima, self.ties[0]), ("minima", self.minima, self.ties[1]))
        for key, fit, tied in sides:
            if fit is not None:
                found[key] = {
                    **asdict(fit),
                    "expected": fit.mean,
                    f"quantile_{PROBABILITY:g}": fit.quantile(PROBABILITY),
                    f"standard_error_{PROBABILITY:g}": fit.standard_error(PROBABILITY),
                    f"band_{PROBABILITY:g}": list(fit.band(PROBABILITY)),
                }
            elif tied:
                found[key] = {"tied": tied, "count": len(records)}
        return found


def chosen_columns(results: Results, names: Sequence[str]) -> list[Column]:
    """Columns by names of channels, with or without a component, of patterns and of combinations of channels.

    Raises
    ------
    InputError
        If a name is none of the run.
    """
    hulls = [name.rpartition(".")[0] for name in results.names if name.endswith(".wave_elevation")]
    lines = [name.rpartition(".")[0] for name in results.names if name.endswith(".anchor_tension")]
    if not names:
        names = [f"{hull}.{what}" for hull in hulls for what in ("position", *_ANGLES, "wave_elevation")]
        names += [f"{line}.tension" for line in lines]
        names = names or [name for name in results.names if len(results.components(name)) <= 3]
    found: list[Column] = []
    for name in (one for given in names for one in results.fitting(given)):
        *parts_before, last = split_name(name)
        owner = ".".join(parts_before)
        if name in results:
            parts = results.components(name)
            found += [_component(results, name, index, len(parts)) for index in range(len(parts))]
        elif owner in results and last in results.components(owner):
            parts = results.components(owner)
            found.append(_component(results, owner, parts.index(last), len(parts)))
        elif last in _ANGLES and f"{owner}.orientation" in results:
            found.append(_angle(owner, last))
        else:
            if "(" in name:  # tells what is wrong with it
                results.channel(name if name.endswith(")") else owner)
            angles = [f"{hull}.{angle}" for hull in hulls for angle in _ANGLES]
            raise InputError(
                f"channel {name!r} does not exist",
                source=results.source,
                expected=f"one of: {', '.join([*results.names, *angles])}",
            )
    return found


def _component(results: Results, channel: str, index: int, count: int) -> Column:
    part = results.components(channel)[index]
    name = channel if count == 1 else f"{channel}.{part}"

    def read(run: Results) -> NDArray[np.float64]:
        values = run[channel]
        column = values if values.ndim == 1 else values[:, index]
        if ".gap" in channel and np.isnan(column).any():
            raise InputError(
                f"{channel!r} is not known at all times: surfaces out of reach, and their distance not requested",
                source=run.source,
                expected="'clearance = true' in the collision, or a check, criterion or [report] channels that name it",
            )
        if "(" in channel and np.isnan(column).any():
            at = run.time[np.isnan(column)][0]
            raise InputError(
                f"{channel!r} divides by zero at {at:.6g} s",
                source=run.source,
                expected="a number at all times",
            )
        return column

    return Column(name, results.unit(channel), channel, read)


def _angle(owner: str, name: str) -> Column:
    """Of a body that turns, then pitches, then rolls: angles of small motions about the axes of its heading."""

    def read(run: Results) -> NDArray[np.float64]:
        from scipy.spatial.transform import Rotation

        q = run[f"{owner}.orientation"]
        angles = Rotation.from_quat(q[:, [1, 2, 3, 0]]).as_euler("ZYX")
        return np.unwrap(angles[:, 2 - _ANGLES.index(name)])

    return Column(f"{owner}.{name}", "rad", f"{owner}.orientation", read)


def run_statistics(column: Column, run: Results, begin: float) -> RunStatistics:
    """Statistics of a column of one run, from a time on [s]."""
    time, values = run.time, column.read(run)
    record = _with_extremes(column, run, record_statistics(time, values, begin=begin), begin)
    spectrum = None
    if np.count_nonzero(time >= begin) >= SHORTEST:
        spectrum = power_spectrum(time, values, begin=begin)
    return RunStatistics(record, spectrum, _sees_every_step(column, run))


def column_statistics(column: Column, runs: Sequence[RunStatistics]) -> ColumnStatistics:
    """Statistics of a column over runs; fits to extremes if there are three or more, and no limit cuts them off."""
    records = tuple(run.record for run in runs)
    spectra = [run.spectrum for run in runs if run.spectrum is not None]
    spectrum = None
    if spectra:
        first, count = spectra[0], min(len(one.density) for one in spectra)
        density = np.mean([one.density[:count] for one in spectra], axis=0)
        spectrum = type(first)(
            first.frequency[:count],
            density,
            first.per,
            first.resolution,
            first.segments * len(spectra),
            first.relative_error / math.sqrt(len(spectra)),
        )
    fits: list[GumbelFit | None] = [None, None]
    ties = [0, 0]
    if len(runs) >= LEAST_RUNS:
        sides = [record.maximum for record in records], [record.minimum for record in records]
        ties = [at_extreme(values, minima=bool(side)) for side, values in enumerate(sides)]
        fits = [
            None if tied > MOST_TIES * len(runs) else gumbel_fit(values, minima=bool(side))
            for side, (values, tied) in enumerate(zip(sides, ties, strict=True))
        ]
    every = all(run.every_step for run in runs)
    seen = "steps" if every else "records"
    return ColumnStatistics(column, records, spectrum, fits[0], fits[1], seen, (ties[0], ties[1]))


def at_extreme(values: Sequence[float], *, minima: bool = False) -> int:
    """How many runs have one and the same extreme, as at a stop or of slack ropes; 0 if only one has it."""
    x = np.asarray(values, dtype=np.float64)
    extreme = x.min() if minima else x.max()
    tied = int(np.count_nonzero(np.abs(x - extreme) <= 1e-9 * np.abs(x).max(initial=0.0)))
    return tied if tied > 1 else 0


def _sees_every_step(column: Column, run: Results) -> bool:
    """Whether the extremes of a column between records are recorded beside it."""
    return column.name == column.channel and run.extremes(column.channel, "max")[1].endswith("steps")


def _with_extremes(column: Column, run: Results, found: RecordStatistics, begin: float) -> RecordStatistics:
    """With the extremes of all steps of the window, where they are known; the first interval begins before it."""
    if not _sees_every_step(column, run):
        return found
    kept = np.flatnonzero(run.time >= begin)[1:]
    largest = run.extremes(column.channel, "max")[0][kept].max(initial=found.maximum)
    smallest = run.extremes(column.channel, "min")[0][kept].min(initial=found.minimum)
    return replace(found, maximum=float(largest), minimum=float(smallest))
