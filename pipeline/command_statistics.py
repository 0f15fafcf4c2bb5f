"""``heavylift statistics``: moments, significant values, spectra and extremes of recorded channels, over seeds too."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.statistics import gumbel_fit, power_spectrum, record_statistics
from heavylift.pipeline.storage import replacing, write_json

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.log import Log
    from heavylift.pipeline.results import Results
    from heavylift.pipeline.statistics import GumbelFit, PowerSpectrum, RecordStatistics

__all__ = ["Column", "ColumnStatistics", "chosen_columns", "column_statistics", "statistics_command"]

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


def statistics_command(
    path: Path,
    *,
    out: Path | None = None,
    overrides: Sequence[str] = (),
    channels: Sequence[str] = (),
    seeds: int | None = None,
    after: float | None = None,
    log: Log,
) -> tuple[dict[str, Any], list[str]]:
    """Statistics of a finished run, or of runs with several seeds; writes ``statistics/``.

    Parameters
    ----------
    path, out, overrides, log
        As of other commands.
    channels
        Names as ``barge.position.z``, ``barge.roll``, ``line.tension``; a channel without a component means all of
        them. By default motions of hulls and tensions of lines.
    seeds
        Simulate so many times, with seeds that count up from those of the case; None: the run of the case alone.
    after
        Begin of the statistics [s]; by default the end of the ramp of the waves.

    Returns
    -------
    tuple
        Document, and a table for a person.

    Raises
    ------
    InputError
        If there are no results, no seeds, unknown channels, or too few records after the begin.
    StopError
        If a run stops by itself.
    """
    from heavylift.pipeline.command_statistics_seeds import simulate_seeds
    from heavylift.pipeline.lock import locked
    from heavylift.pipeline.results import load_results
    from heavylift.pipeline.stages import load_changed_case
    from heavylift.pipeline.storage import OutputFolder

    case = load_changed_case(path, overrides)
    root = Path(out) if out is not None else case.output_folder
    begin = (0.0 if case.sea is None else case.sea.ramp) if after is None else after
    first_seeds: list[int] = []
    if seeds is None:
        runs = [load_results(case, root)]
        if runs[0].outcome != "completed":
            log.say(f"statistics: the run is not complete: {runs[0].outcome}")
    else:
        first_seeds, runs = simulate_seeds(case, root, path, overrides, seeds, log)
    columns = chosen_columns(runs[0], channels)
    found = [column_statistics(column, runs, begin) for column in columns]
    folder = OutputFolder(root).stage("statistics")
    document = {
        "case": case.name,
        "after": begin,
        "seeds": first_seeds,
        "channels": [one.entry() for one in found],
    }
    with locked(root):
        files = _write(folder, document, found, first_seeds, case.name)
    document["files"] = [str(file) for file in files]
    return document, [*_lines(document), "", *(f"  written: {file}" for file in files)]


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


def _write(
    folder: Path,
    document: Mapping[str, Any],
    found: Sequence[ColumnStatistics],
    seeds: Sequence[int],
    case: str,
) -> list[Path]:
    """Tables and pictures."""
    from heavylift.pipeline.command_statistics_plots import gumbel_plots, spectrum_plots

    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / "statistics.json", folder / "statistics.csv"]
    write_json(files[0], document)
    keys = [key for key, value in document["channels"][0].items() if not isinstance(value, dict)]
    rows: list[list[Any]] = [keys]
    rows += [["" if one[key] is None else one[key] for key in keys] for one in document["channels"]]
    _write_csv(files[1], rows)
    with_spectrum = [one for one in found if one.spectrum is not None]
    if with_spectrum:
        files.append(folder / "spectra.csv")
        header = [
            "omega_rad_s",
            *(f"{one.column.name} [({one.column.unit})^2 s/rad]" for one in with_spectrum),
        ]
        table = np.column_stack(
            [with_spectrum[0].spectrum.frequency, *(one.spectrum.density for one in with_spectrum)]  # type: ignore[union-attr]
        )
        _write_csv(files[-1], [header, *table.tolist()])
        for number, png in enumerate(spectrum_plots(with_spectrum, title=f"{case}: spectra"), start=1):
            files.append(folder / f"spectra_{number}.png")
            with replacing(files[-1]) as temporary:
                temporary.write_bytes(png)
    if seeds:
        files.append(folder / "extremes.csv")
        header = ["seed", *(f"{one.column.name} {side}" for one in found for side in ("maximum", "minimum"))]
        table_rows = [
            [seed, *(value for one in found for value in (one.records[k].maximum, one.records[k].minimum))]
            for k, seed in enumerate(seeds)
        ]
        _write_csv(files[-1], [header, *table_rows])
        title = f"{case}: extremes of {len(seeds)} runs"
        for number, png in enumerate(gumbel_plots(found, title=title), start=1):
            files.append(folder / f"extremes_{number}.png")
            with replacing(files[-1]) as temporary:
                temporary.write_bytes(png)
    return files


def _write_csv(path: Path, rows: Sequence[Sequence[Any]]) -> None:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(
        [[f"{value:.9g}" if isinstance(value, float) else value for value in row] for row in rows]
    )
    with replacing(path) as temporary:
        temporary.write_text(text.getvalue(), encoding="utf-8")


def _lines(document: Mapping[str, Any]) -> list[str]:
    """Table: angles in degrees."""
    seeds = document["seeds"]
    runs = f"{len(seeds)} runs, seeds {seeds[0]} to {seeds[-1]}" if seeds else "one run"
    lines = [f"{document['case']}: statistics of {runs}, from {document['after']:g} s on", ""]
    head = ("mean", "st. dev.", "4 st. dev.", "H1/3", "minimum", "maximum", "period s")
    lines.append(f"  {'channel':<30s}{'unit':<6s}" + "".join(f"{word:>12s}" for word in head))
    keys = (
        "mean",
        "standard_deviation",
        "significant_by_deviation",
        "significant_by_cycles",
        "minimum",
        "maximum",
    )
    for one in document["channels"]:
        factor, unit = (180.0 / math.pi, "deg") if one["unit"] == "rad" else (1.0, one["unit"])
        words = "".join(
            f"{factor * one[key]:>12.5g}" if one[key] is not None else f"{'-':>12s}" for key in keys
        )
        period = f"{one['mean_period']:>12.4g}" if one["mean_period"] is not None else f"{'-':>12s}"
        lines.append(f"  {one['channel']:<30s}{unit:<6s}{words}{period}")
    if not any("maxima" in one for one in document["channels"]):
        return lines
    lines += [
        "",
        "  extremes of a run (Gumbel): most probable, expected, and the value that is kept with 90 %",
        "",
    ]
    for side in ("maxima", "minima"):
        for one in document["channels"]:
            factor, unit = (180.0 / math.pi, "deg") if one["unit"] == "rad" else (1.0, one["unit"])
            fit = one[side]
            numbers = [fit["mode"], fit["expected"], fit[f"quantile_{PROBABILITY:g}"]]
            error = factor * fit[f"standard_error_{PROBABILITY:g}"]
            words = "".join(f"{factor * value:>12.5g}" for value in numbers)
            lines.append(f"  {one['channel']:<30s}{unit:<6s}{side[:3]}{words}  +- {error:.2g}")
    return lines
