"""Criteria in the report: their table, their charts, and the files that other programs read."""

from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from heavylift.pipeline.case.rope_parts import tensions_of
from heavylift.pipeline.checks.criteria import RecordedRun
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.pictures.criteria_plots import curve_plot, tension_plot, utilisation_plot
from heavylift.pipeline.report.document import Figure, Section, Table, Text
from heavylift.pipeline.report.operation import phase_bands
from heavylift.pipeline.results.signals import scaled_unit
from heavylift.pipeline.results.storage import replacing, write_json

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.numerics.outcome import InputError
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.criteria.results import CriterionResult, CurveFigure
    from heavylift.pipeline.checks.quantities import CheckResult
    from heavylift.pipeline.report.document import Album
    from heavylift.pipeline.results.histories import Results

__all__ = [
    "briefly",
    "criteria_section",
    "criterion_cells",
    "governing_words",
    "result_words",
    "used_words",
    "write_criteria",
]

_CURVES = 12  # of the chart of utilisations at most
_HEADER = ("criterion", "value", "limit", "used", "margin", "governs", "source", "factors", "result")


def briefly(error: InputError) -> str:
    """What is wrong and in which file, by its name: a report is read elsewhere than it was made."""
    parts = getattr(error, "errors", [error])
    return "; ".join(": ".join(filter(None, (Path(one.source).name, one.key, one.problem))) for one in parts)


def write_criteria(
    folder: Path,
    case: Case,
    found: Sequence[CriterionResult],
    missing: Mapping[str, str],
    outcome: str = "completed",
) -> list[Path]:
    """Write ``criteria.json`` and ``criteria.csv`` with one line a result; values in SI.

    A run that did not complete, whose outcome is given, has not passed.
    """
    rows = [result.row() for result in found]
    document = {
        "case": case.name,
        "outcome": outcome,
        "passed": outcome == "completed" and not missing and all(result.passed for result in found),
        "criteria": rows,
        "not_evaluated": dict(missing),
    }
    write_json(folder / "criteria.json", document)
    keys = [key for key in (rows[0] if rows else {"name": ""}) if key not in {"factors", "sources"}]
    with (
        replacing(folder / "criteria.csv") as temporary,
        temporary.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.writer(file)
        writer.writerow([*keys, "factors", "sources"])
        for row, result in zip(rows, found, strict=True):
            factors = "; ".join(factor.text for factor in result.factors)
            writer.writerow([*("" if row[key] is None else row[key] for key in keys), factors, result.source])
        for name, reason in missing.items():
            own = {"name": name, "note": reason, "passed": False}
            writer.writerow([*(own.get(key, "") for key in keys), "", ""])
    return [folder / "criteria.json", folder / "criteria.csv"]


def criterion_cells(result: CriterionResult) -> tuple[str, str, str]:
    """Value, limit and margin of a result in words, angles in degrees."""
    numbers = [result.value, result.limit, result.margin]
    if result.unit == "rad":
        numbers, unit, divisor = [math.degrees(number) for number in numbers], "deg", 1.0
    else:
        unit = "" if result.unit == "1" else result.unit
        finite = [number for number in numbers[:2] if math.isfinite(number)]
        scaled = scaled_unit(unit, [np.array(finite)]) if unit else None
        divisor, unit = (1.0, "") if scaled is None else scaled
    value, limit, margin = (f"{number / divisor + 0.0:.4g} {unit}".strip() for number in numbers)
    return value, f"{ {'<=': '≤', '>=': '≥', '>': '>'}[result.side] } {limit}", margin


def used_words(result: CriterionResult | CheckResult) -> str:
    """Utilisation in percent; empty where there is none."""
    used = result.utilisation
    # zero has no sign, also if it is what rounding leaves of an angle
    return "" if used is None else "> 999 %" if used > 9.99 else f"{round(100.0 * used, 1) + 0.0:.1f} %"


def governing_words(result: CriterionResult) -> str:
    """Where, when and in which phase it governs."""
    time = "" if result.time is None else f"at {result.time:.6g} s"
    phase = f"in {result.phase}" if result.phase else ""
    return ", ".join(filter(None, (result.where, time, phase)))


def result_words(result: CriterionResult) -> str:
    """Passed, passed with a warning, or FAILED."""
    return "FAILED" if not result.passed else "WARNING" if result.warns else "passed"


def criteria_section(
    case: Case,
    out: Path,
    results: Results | None,
    found: Sequence[CriterionResult],
    missing: Mapping[str, str],
    album: Album,
) -> list[Section]:
    """Table of all criteria, and the charts of those that have histories."""
    if not case.criteria:
        return []
    rows = []
    for result in found:
        value, limit, margin = criterion_cells(result)
        used = used_words(result) or "–"
        governs = "; ".join(filter(None, (governing_words(result), result.note))) or "–"
        factors = "; ".join(factor.text for factor in result.factors)
        source = "; ".join(filter(None, (result.source, f"of {result.seen}" if result.seen else "")))
        name = f"{result.name}: {result.what}"
        rows.append((name, value, limit, used, margin, governs, source, factors or "–", result_words(result)))
    rows += [(name, "–", "–", "–", "–", reason, "–", "–", "open") for name, reason in missing.items()]
    marks = (*(result.passed for result in found), *(None for _ in missing))
    items: list[Text | Table | Figure] = [Table(_HEADER, tuple(rows), frozenset({1, 2, 3, 4}), marks)]
    if any(one.status not in {"case file", "assumption"} for result in found for one in result.clauses):
        items.append(
            Text(
                "Clauses were read in public copies, or are quoted from memory where marked so: they are to be "
                "confirmed in the standard that applies before this report is issued."
            )
        )
    if results is not None:
        items += _charts(case, out, results, found, album)
    return [Section("Criteria", tuple(items))]


def _charts(
    case: Case, out: Path, results: Results, found: Sequence[CriterionResult], album: Album
) -> list[Text | Table | Figure]:
    items: list[Text | Table | Figure] = []
    quantities = Quantities(case, out)
    quantities.__dict__["results"] = results
    for criterion in case.criteria:
        lines = [one for one in found if one.name == criterion.name]
        if lines:
            figures = criterion.figures(RecordedRun(case, quantities, criterion), lines)
            items += [_curve_figure(figure, album) for figure in figures]
    bands = phase_bands(results)
    histories: dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]] = {}
    for result in sorted(found, key=lambda one: -(one.utilisation or 0.0)):
        if result.history is not None and len(histories) < _CURVES:
            histories[f"{result.name}: {result.what}"] = result.history
    if histories:
        content = utilisation_plot(histories, title="Criteria over time", bands=bands)
        caption = "Utilisation of each criterion, for the governing rope or channel; the limit is dashed."
        left = sum(one.history is not None for one in found) - len(histories)
        caption += f" {left} that use less are left out." if left else ""
        items.append(Figure(album.add("criteria", content), caption))
    given: list[tuple[str, ...]] = [getattr(criterion, "ropes", ()) for criterion in case.criteria]
    groups = dict.fromkeys(given)
    for number, ropes in enumerate(groups):
        recorded = [rope for rope in ropes if f"{rope}.tension" in results]
        names = tensions_of(case, recorded)
        if len(results.time) > 1 and len(names) > 1:
            tensions = {label: quantities.history(f"channel.{name}.end") for label, name in names.items()}
            title = f"Tensions of {len(names)} ropes"
            content = tension_plot(results.time, tensions, title=title, bands=bands)
            caption = f"Spread of the tensions of {', '.join(list(names)[:8])}{' …' * (len(names) > 8)}, by records."
            items.append(Figure(album.add(f"tensions_{number + 1}", content), caption))
    return items


def _curve_figure(figure: CurveFigure, album: Album) -> Figure:
    used = f"; largest utilisation {words}" if (words := used_words(figure.line)) else ""
    return Figure(album.add(figure.name, curve_plot(figure)), f"{figure.caption}{used}.")
