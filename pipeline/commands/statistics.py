"""``heavylift statistics``: moments, significant values, spectra and extremes of recorded channels, over seeds too."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.results.statistics import PROBABILITY, chosen_columns, column_statistics
from heavylift.pipeline.results.storage import replacing, write_json

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from heavylift.pipeline.log import Log
    from heavylift.pipeline.results.statistics import ColumnStatistics

__all__ = ["statistics_command"]


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
    from heavylift.pipeline.commands.statistics_seeds import simulate_seeds
    from heavylift.pipeline.results.histories import load_results
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.pipeline.stages.stages import load_changed_case, locked

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


def _write(
    folder: Path,
    document: Mapping[str, Any],
    found: Sequence[ColumnStatistics],
    seeds: Sequence[int],
    case: str,
) -> list[Path]:
    """Tables and pictures."""
    from heavylift.pipeline.commands.statistics_plots import gumbel_plots, spectrum_plots

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
