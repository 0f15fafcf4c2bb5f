"""``heavylift statistics``: moments, significant values, spectra and extremes of recorded channels, over seeds too."""

from __future__ import annotations

import csv
import io
import math
import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.pictures.plots import few_colours, figure_png
from heavylift.pipeline.results.signals import scaled_unit
from heavylift.pipeline.results.statistics import (
    LEAST_RUNS,
    PROBABILITY,
    chosen_columns,
    column_statistics,
    run_statistics,
)
from heavylift.pipeline.results.storage import OutputFolder, StopError, replacing, write_json

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.statistics import Column, ColumnStatistics, GumbelFit, RunStatistics

__all__ = [
    "SeedRun",
    "gumbel_plots",
    "reported_stops",
    "seed_keys",
    "simulate_seeds",
    "spectrum_plots",
    "statistics_command",
]

T = TypeVar("T")

PANELS = 6
"""Of a picture."""

ENERGY_SHOWN = 0.999
"""Part of the variance up to which a spectrum is drawn."""

ENDS_ALL = frozenset(
    {Outcome.INTERRUPTED, Outcome.DISK_FULL, Outcome.LOCKED, Outcome.OUT_OF_MEMORY, Outcome.FAULT}
)
"""Ends of a run that give no information on what is simulated."""

_DPI = 110
_INK, _GREY = "#1d2733", "#66707c"
_BLUE, _RED = "#1f5fa8", "#b8322a"
_PROBABILITIES = (0.05, 0.2, 0.5, 0.8, 0.9, 0.95, 0.98)


def spectrum_plots(found: Sequence[ColumnStatistics], *, title: str) -> list[bytes]:
    """Spectra over frequency, a panel a channel, with the significant value; all of them have a spectrum."""
    pictures = []
    for group in _groups(found):
        figure, panels = _panels(len(group), title)
        for axes, one in zip(panels, group, strict=True):
            assert one.spectrum is not None
            entry = one.entry()
            factor, unit = _shown(one.column.unit, entry["standard_deviation"])
            w, S = one.spectrum.frequency, factor**2 * one.spectrum.density
            energy = np.cumsum(S)
            still = not energy[-1] > 0.0
            last = len(w) - 1 if still else int(np.searchsorted(energy, ENERGY_SHOWN * energy[-1]))
            axes.fill_between(w, S, color=_BLUE, alpha=0.12, lw=0)
            axes.plot(w, S, color=_BLUE, lw=1.4)
            axes.set_xlim(0.0, float(w[min(max(last, 8), len(w) - 1)]) * 1.05)
            axes.set_ylim(bottom=0.0)
            words = f"4 st. dev. = {factor * entry['significant_by_deviation']:.4g} {unit}"
            axes.set_title(f"{_text(one.column.name)}   {words}", loc="left", fontsize=9.5, color=_INK)
            axes.set_ylabel(
                f"[{unit}² s/rad]" if unit.isalpha() else f"[({unit})² s/rad]", color=_INK, fontsize=9
            )
            axes.set_xlabel("frequency [rad/s]", color=_INK, fontsize=9)
            _tidy(axes)
        pictures.append(few_colours(figure_png(figure)))
    return pictures


def gumbel_plots(found: Sequence[ColumnStatistics], *, title: str) -> list[bytes]:
    """Extremes over their probability, with the fitted lines; maxima and minima in a panel each."""
    sides = [
        (one, fit, [getattr(record, word) for record in one.records])
        for one in found
        for fit, word in ((one.maxima, "maximum"), (one.minima, "minimum"))
        if fit is not None
    ]
    pictures = []
    for group in _groups(sides):
        figure, panels = _panels(len(group), title)
        for axes, (one, fit, values) in zip(panels, group, strict=True):
            assert fit is not None
            _draw_extremes(axes, one, fit, np.sort(np.array(values) * fit.side) * fit.side)
        pictures.append(few_colours(figure_png(figure)))
    return pictures


def _draw_extremes(axes: Any, one: ColumnStatistics, fit: GumbelFit, values: Any) -> None:
    """Points at (i - 0.44) / (n + 0.12) (Gringorten), the line of the fit and its standard errors."""
    factor, unit = _shown(one.column.unit, float(np.abs(values).max()))
    count = len(values)
    place = (np.arange(1, count + 1) - 0.44) / (count + 0.12)
    p = np.linspace(min(0.02, float(place[0])), max(0.985, float(place[-1])), 200)
    line = factor * np.array([fit.quantile(float(x)) for x in p])
    error = factor * np.array([fit.standard_error(float(x)) for x in p])
    y = _reduced(p)
    axes.fill_between(y, line - error, line + error, color=_BLUE, alpha=0.14, lw=0, label="standard error")
    axes.plot(y, line, color=_BLUE, lw=1.4, label="Gumbel")
    axes.plot(_reduced(place), factor * values, "o", ms=4.5, color=_RED, label="runs")
    axes.set_xticks(_reduced(np.array(_PROBABILITIES)), [f"{100.0 * x:g}" for x in _PROBABILITIES])
    axes.set_xlim(float(y[0]), float(y[-1]))
    side = "maximum" if fit.side > 0 else "minimum"
    words = f"{side}, expected {factor * fit.mean:.4g} {unit}"
    axes.set_title(f"{_text(one.column.name)}: {words}", loc="left", fontsize=9.5, color=_INK)
    axes.set_ylabel(f"[{unit}]", color=_INK, fontsize=9)
    axes.set_xlabel("probability of not being exceeded [%]", color=_INK, fontsize=9)
    axes.legend(frameon=False, fontsize=8, loc="best")
    _tidy(axes)


def _reduced(p: Any) -> Any:
    return -np.log(-np.log(p))


def _shown(unit: str, size: float) -> tuple[float, str]:
    """Factor and unit for a picture: angles in degrees, forces in kN or MN."""
    if unit == "rad":
        return 180.0 / math.pi, "deg"
    if unit == "m" or not size > 0.0:
        return 1.0, unit
    scaled = scaled_unit(unit, [np.array([size])])
    return 1.0 / scaled.divisor, scaled.text


def _groups(entries: Sequence[Any]) -> list[Sequence[Any]]:
    return [entries[first : first + PANELS] for first in range(0, len(entries), PANELS)]


def _panels(count: int, title: str) -> tuple[Any, list[Any]]:
    """A figure with two columns of panels, or one."""
    from matplotlib.figure import Figure

    columns = min(count, 2)
    rows = math.ceil(count / columns)
    figure = Figure(
        figsize=(5.4 * columns, 0.5 + 2.6 * rows), dpi=_DPI, facecolor="white", layout="constrained"
    )
    axes = list(figure.subplots(rows, columns, squeeze=False).ravel())
    for unused in axes[count:]:
        unused.set_visible(False)
    figure.suptitle(_text(title), x=0.01, ha="left", fontsize=12, color=_INK)
    return figure, axes[:count]


def _text(words: str) -> str:
    return words.replace("$", r"\$")


def _tidy(axes: Any) -> None:
    axes.grid(visible=True, color="#e3e7eb", lw=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(colors=_INK, labelsize=8.5, length=3)
    for side, spine in axes.spines.items():
        spine.set_visible(side in {"left", "bottom"})
        spine.set_color("#9aa4ae")


def seed_keys(case: Case) -> dict[str, int]:
    """Dotted keys of the seeds in the [sea] of a case file, and their values."""
    found: dict[str, int] = {}

    def walk(value: Any, written: Any, key: str) -> None:
        if isinstance(value, dict):
            for name, entry in value.items():
                if name == "seed" and isinstance(entry, int):
                    found[f"{key}.seed"] = entry
                else:
                    walk(entry, written.get(name) if isinstance(written, dict) else None, f"{key}.{name}")
        elif isinstance(value, (list, tuple)):
            for index, entry in enumerate(value):
                # a single table may stand for a list of one
                inside = written[index] if isinstance(written, list) else written
                walk(entry, inside, f"{key}.{index}" if isinstance(written, list) else key)

    if case.sea is not None:
        walk(case.sea.model_dump(), case.document.get("sea"), "sea")
    return found


@dataclass(frozen=True)
class SeedRun(Generic[T]):
    """The run of a seed.

    Attributes
    ----------
    seed
        The smallest of its seeds.
    outcome, message
        How it ended.
    found
        What was taken from its records; None of a run that stopped by itself.
    """

    seed: int
    outcome: Outcome
    message: str
    found: T | None

    def row(self) -> dict[str, Any]:
        """As a document has it."""
        return {"seed": self.seed, "outcome": self.outcome.name.lower(), "message": self.message}


def simulate_seeds(
    case: Case,
    root: Path,
    path: Path,
    overrides: Sequence[str],
    count: int,
    take: Callable[[Case, Path], T],
    log: Log,
    *,
    force: bool = False,
) -> list[SeedRun[T]]:
    """Runs of several seeds, each in a folder of its own below ``seeds``; those that are there are not repeated.

    Of each run `take` takes what is wanted from the case of its seed and its folder, so that the records of one run are
    in memory. A run that stops by itself is one without, and the others continue.

    Raises
    ------
    InputError
        If no wave or wind has a seed, or fewer runs are wanted than tell something.
    StopError
        If bodies could not be prepared, somebody interrupts, or the machine has no room.
    """
    from heavylift.pipeline.stages.stages import load_changed_case, run_case

    keys = seed_keys(case)
    if count < LEAST_RUNS:
        raise InputError(f"{count}", source="--seeds", expected=f"{LEAST_RUNS} runs or more, better 10 to 20")
    if not keys:
        raise InputError(
            "no wave or wind has a seed",
            source=case.file,
            key="sea",
            expected="irregular waves, or wind with turbulence",
        )
    if case.simulate is None:
        raise InputError(
            "no [simulate] section", source=case.file, expected="step or tolerance, output_interval, duration"
        )
    prepared = ("mesh", "modes")
    made = run_case(case, out=root, stages=prepared, force=prepared if force else (), log=log)
    if made.outcome is not Outcome.COMPLETED:
        raise StopError(made.outcome, made.message)
    main = OutputFolder(root)
    runs: list[SeedRun[T]] = []
    first = min(keys.values())
    for number in range(count):
        changes = [*overrides, *(f"{key}={seed + number}" for key, seed in keys.items())]
        varied = load_changed_case(path, changes)
        folder = main.stage("seeds", f"seed_{first + number}")
        for stage in ("mesh", "modes"):  # the same for all seeds: surfaces and databases too
            _link(main.stage(stage), OutputFolder(folder).stage(stage))
        log.say(f"seed {first + number}, run {number + 1} of {count}")
        again = ("simulate",) if force else ()
        done = run_case(varied, out=folder, stages=("mesh", "modes", "simulate"), force=again, log=log)
        if done.outcome in ENDS_ALL:
            raise StopError(done.outcome, f"seed {first + number}: {done.message}")
        found = take(varied, folder) if done.outcome is Outcome.COMPLETED else None
        runs.append(SeedRun(first + number, done.outcome, done.message, found))
    return runs


def reported_stops(runs: Sequence[SeedRun[Any]]) -> list[str]:
    """Lines of the runs that stopped by themselves."""
    stopped = [run for run in runs if run.found is None]
    if not stopped:
        return []
    lines = [f"  {len(stopped)} of {len(runs)} runs stopped by themselves and are in none of these numbers:"]
    return [*lines, *(f"    seed {run.seed}: {run.message.splitlines()[0]}" for run in stopped)]


def _link(source: Path, target: Path) -> None:
    """The files of a stage in another folder; files are replaced, never changed, so they may be shared."""
    if not source.is_dir():
        return
    for file in source.rglob("*"):
        place = target / file.relative_to(source)
        if file.is_dir() or place.exists() or file.name.startswith("."):
            continue
        with replacing(place) as temporary:
            try:
                os.link(file, temporary)
            except OSError:
                shutil.copyfile(file, temporary)


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
        If so many runs stop by themselves that too few are left.
    """
    from heavylift.pipeline.results.histories import load_results
    from heavylift.pipeline.stages.lock import locked
    from heavylift.pipeline.stages.stages import load_changed_case

    case = load_changed_case(path, overrides)
    root = Path(out) if out is not None else case.output_folder
    folder = OutputFolder(root).stage("statistics")  # before runs that take long
    begin = (0.0 if case.sea is None else case.sea.ramp) if after is None else after

    def take(run: Results) -> list[tuple[Column, RunStatistics]]:
        return [(column, run_statistics(column, run, begin)) for column in chosen_columns(run, channels)]

    runs: list[SeedRun[list[tuple[Column, RunStatistics]]]] = []
    if seeds is None:
        results = load_results(case, root)
        if results.outcome != "completed":
            log.say(f"statistics: the run is not complete: {results.outcome}")
        taken = [take(results)]
    else:
        runs = simulate_seeds(
            case, root, path, overrides, seeds, lambda varied, at: take(load_results(varied, at)), log
        )
        taken = [run.found for run in runs if run.found is not None]
        if len(taken) < LEAST_RUNS:
            stopped = next(run for run in runs if run.found is None)
            told = f"{len(taken)} of {len(runs)} runs completed; seed {stopped.seed}: {stopped.message}"
            raise StopError(stopped.outcome, told)
    found = [
        column_statistics(column, [one[place][1] for one in taken])
        for place, (column, _) in enumerate(taken[0])
    ]
    document: dict[str, Any] = {
        "case": case.name,
        "after": begin,
        "seeds": [run.seed for run in runs if run.found is not None],
        "runs": [run.row() for run in runs],
        "channels": [one.entry() for one in found],
    }
    with locked(root):
        files = _write(folder, document, found, runs, case.name)
    document["files"] = [str(file) for file in files]
    stops = reported_stops(runs)
    lines = [*_lines(document), *([""] if stops else []), *stops]
    return document, [*lines, "", *(f"  written: {file}" for file in files)]


def _write(
    folder: Path,
    document: Mapping[str, Any],
    found: Sequence[ColumnStatistics],
    runs: Sequence[SeedRun[Any]],
    case: str,
) -> list[Path]:
    """Tables and pictures."""
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
    if runs:
        files.append(folder / "extremes.csv")
        sides = ("maximum", "minimum")
        header = ["seed", "outcome", *(f"{one.column.name} {side}" for one in found for side in sides)]
        table_rows: list[list[Any]] = []
        completed = 0
        for run in runs:
            table_rows.append([run.seed, run.outcome.name.lower()])
            if run.found is None:
                table_rows[-1] += [""] * (len(header) - 2)
                continue
            records = [one.records[completed] for one in found]
            table_rows[-1] += [value for one in records for value in (one.maximum, one.minimum)]
            completed += 1
        _write_csv(files[-1], [header, *table_rows])
        title = f"{case}: extremes of {completed} runs"
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
    wide = max([29, *(len(one["channel"]) for one in document["channels"])]) + 1
    lines.append(f"  {'channel':<{wide}s}{'unit':<6s}" + "".join(f"{word:>12s}" for word in head))
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
        lines.append(f"  {one['channel']:<{wide}s}{unit:<6s}{words}{period}")
    if not any("maxima" in one for one in document["channels"]):
        return lines
    kept = f"{100.0 * PROBABILITY:g} %"
    lines += [
        "",
        f"  extremes of a run (Gumbel): most probable, expected, and what {kept} of runs keep within, its",
    ]
    lines += ["  standard error, and its 90 % confidence interval for this number of runs", ""]
    for side in ("maxima", "minima"):
        for one in document["channels"]:
            factor, unit = (180.0 / math.pi, "deg") if one["unit"] == "rad" else (1.0, one["unit"])
            fit = one[side]
            if "tied" in fit:
                words = (
                    f"  {fit['tied']} of {fit['count']} runs share it: a limit, no distribution of extremes"
                )
                lines.append(f"  {one['channel']:<{wide}s}{unit:<6s}{side[:3]}{words}")
                continue
            numbers = [fit["mode"], fit["expected"], fit[f"quantile_{PROBABILITY:g}"]]
            error = factor * fit[f"standard_error_{PROBABILITY:g}"]
            words = "".join(f"{factor * value:>12.5g}" for value in numbers)
            low, high = (factor * end for end in fit[f"band_{PROBABILITY:g}"])
            band = f"{low:.5g} to {high:.5g}"
            lines.append(f"  {one['channel']:<{wide}s}{unit:<6s}{side[:3]}{words}  +- {error:.2g}  {band}")
    return lines
