"""Statistics of recorded channels, a number a record: components, and angles of hulls."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.results.statistics import gumbel_fit, power_spectrum, record_statistics

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.statistics import GumbelFit, PowerSpectrum, RecordStatistics

__all__ = ["LEAST_RUNS", "PROBABILITY", "Column", "ColumnStatistics", "chosen_columns", "column_statistics"]


PROBABILITY = 0.9
"""Of not being exceeded, of the extreme value that is told."""


LEAST_RUNS = 3
"""For a distribution of extremes."""


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
    """

    column: Column
    records: tuple[RecordStatistics, ...]
    spectrum: PowerSpectrum | None
    maxima: GumbelFit | None
    minima: GumbelFit | None

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
            "cycles": sum(one.cycles for one in records),
        }
        for key, fit in (("maxima", self.maxima), ("minima", self.minima)):
            if fit is not None:
                found[key] = {
                    **asdict(fit),
                    "expected": fit.mean,
                    f"quantile_{PROBABILITY:g}": fit.quantile(PROBABILITY),
                    f"standard_error_{PROBABILITY:g}": fit.standard_error(PROBABILITY),
                }
        return found


def chosen_columns(results: Results, names: Sequence[str]) -> list[Column]:
    """Columns by the names of channels, with or without a component.

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
    for name in names:
        owner, _, last = name.rpartition(".")
        if name in results:
            parts = results.components(name)
            found += [_component(results, name, index, len(parts)) for index in range(len(parts))]
        elif owner in results and last in results.components(owner):
            parts = results.components(owner)
            found.append(_component(results, owner, parts.index(last), len(parts)))
        elif last in _ANGLES and f"{owner}.orientation" in results:
            found.append(_angle(owner, last))
        else:
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
        return values if values.ndim == 1 else values[:, index]

    return Column(name, results.unit(channel), channel, read)


def _angle(owner: str, name: str) -> Column:
    """Of a body that turns, then pitches, then rolls: angles of small motions about the axes of its heading."""

    def read(run: Results) -> NDArray[np.float64]:
        from scipy.spatial.transform import Rotation

        q = run[f"{owner}.orientation"]
        angles = Rotation.from_quat(q[:, [1, 2, 3, 0]]).as_euler("ZYX")
        return np.unwrap(angles[:, 2 - _ANGLES.index(name)])

    return Column(f"{owner}.{name}", "rad", f"{owner}.orientation", read)


def column_statistics(column: Column, runs: Sequence[Results], begin: float) -> ColumnStatistics:
    """Statistics of a column in each run, from a time on [s]; fits to extremes if there are three runs or more."""
    histories = [(run.time, column.read(run)) for run in runs]
    records = tuple(record_statistics(time, values, begin=begin) for time, values in histories)
    spectra = []
    for time, values in histories:
        if np.count_nonzero(time >= begin) >= SHORTEST:
            spectra.append(power_spectrum(time, values, begin=begin))
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
    if len(runs) >= LEAST_RUNS:
        fits = [
            gumbel_fit([one.maximum for one in records]),
            gumbel_fit([one.minimum for one in records], minima=True),
        ]
    return ColumnStatistics(column, records, spectrum, fits[0], fits[1])
