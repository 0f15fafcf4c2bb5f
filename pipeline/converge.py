"""Convergence studies: the error of one quantity against the CPU time that it costs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.case import load_case
from heavylift.pipeline.case_overrides import override_text
from heavylift.pipeline.case_sections import QuantityReference, RunReference
from heavylift.pipeline.quantities import Quantities
from heavylift.pipeline.stages import run_case
from heavylift.pipeline.storage import StopError, write_json
from heavylift.pipeline.verify import needed_stages

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.pipeline.case import Case
    from heavylift.pipeline.log import Log

__all__ = ["ConvergenceRow", "ConvergenceStudy", "converge_case", "observed_order", "study_table"]

CONSISTENT = 1.5
"""Largest ratio of the orders from row to row within the asymptotic range."""


@dataclass(frozen=True)
class ConvergenceRow:
    """One run of a study.

    Attributes
    ----------
    value
        Value of the parameter, SI if it is a quantity.
    error
        Distance of the quantity from its reference.
    cpu_s
        CPU time of the stages that make the quantity, without compiling [s].
    """

    value: Any
    error: float
    cpu_s: float


@dataclass(frozen=True)
class ConvergenceStudy:
    """A parameter, its runs and what they show.

    Attributes
    ----------
    case, parameter, quantity
        Names.
    relative
        Whether errors are relative.
    rows
        Coarse to fine, as in the case.
    order
        Slope of log error over log value by least squares, over the rows in `fitted`; None if it cannot be told.
    fitted
        Numbers of the rows the order was taken from.
    """

    case: str
    parameter: str
    quantity: str
    relative: bool
    rows: tuple[ConvergenceRow, ...]
    order: float | None
    fitted: tuple[int, ...]

    def document(self) -> dict[str, Any]:
        """The document that ``converge --json`` prints."""
        rows = [{"value": row.value, "error": row.error, "cpu_s": row.cpu_s} for row in self.rows]
        return {"case": self.case, "parameter": self.parameter, "rows": rows, "order": self.order}


def converge_case(
    path: Path, *, out: Path | None, overrides: Sequence[str], force: bool, log: Log
) -> tuple[ConvergenceStudy, Path]:
    """Run a case for every value of its ``[converge]`` section, and write the study and its plot.

    Returns
    -------
    tuple
        The study, and the plot that was written.

    Raises
    ------
    InputError
        If the case has no study, or a value does not fit the parameter.
    StopError
        If a run does not complete.
    """
    base = load_case(path, overrides)
    section = base.converge
    if section is None:
        raise InputError(
            "no [converge] section", source=base.file, expected="parameter, values, quantity, reference"
        )
    root = out if out is not None else base.output_folder
    texts = [section.quantity]
    if isinstance(section.reference, QuantityReference):
        texts.append(section.reference.quantity)
    stages = needed_stages(texts)
    runs = list(section.values)
    if isinstance(section.reference, RunReference):
        runs.append(section.reference.run)
    # read every case before the first run: a value that does not fit is known at once
    cases = [load_case(path, [*overrides, override_text(section.parameter, value)]) for value in runs]
    values, costs = [], []
    folders = [root / "converge" / str(number) for number in range(len(runs))]
    references: list[NDArray[np.float64]] = []
    for number, (case, folder) in enumerate(zip(cases, folders, strict=True)):
        log.say(f"converge: {section.parameter} = {runs[number]}")
        report = run_case(
            case,
            out=folder,
            stages=stages,
            force=stages if force else (),
            log=log,
            reuse=[root, *folders[:number]],
        )
        if report.outcome is not Outcome.COMPLETED:
            raise StopError(report.outcome, f"{section.parameter} = {runs[number]}: {report.message}")
        quantities = Quantities(case, folder)
        values.append(quantities.evaluate(section.quantity))
        if isinstance(section.reference, QuantityReference):
            references.append(quantities.evaluate(section.reference.quantity))
        last = report.stage(stages[-1])
        costs.append(report.cpu_s if stages[-1] != "simulate" or last is None else last.cpu_s)
    if isinstance(section.reference, RunReference):
        references = [values[-1]] * len(section.values)
    elif isinstance(section.reference, float):
        references = [np.asarray(section.reference)] * len(section.values)
    rows = tuple(
        ConvergenceRow(
            _parameter(cases[i], section.parameter),
            _error(values[i], references[i], section.relative),
            costs[i],
        )
        for i in range(len(section.values))
    )
    order, fitted = observed_order([row.value for row in rows], [row.error for row in rows])
    study = ConvergenceStudy(
        base.name, section.parameter, section.quantity, section.relative, rows, order, fitted
    )
    return study, _write(study, root / "converge")


def _write(study: ConvergenceStudy, folder: Path) -> Path:
    from heavylift.pipeline.converge_plot import plot_study

    write_json(
        folder / "converge.json", {**study.document(), "quantity": study.quantity, "fitted": study.fitted}
    )
    plot = folder / "converge.png"
    plot_study(study, plot)
    return plot


def _parameter(case: Case, path: str) -> Any:
    """Value of a dotted key in SI; the raw value if it is not part of the model under that name."""
    node: Any = case
    raw: Any = case.document
    for key in path.split("."):
        raw = raw[int(key)] if isinstance(raw, list) else raw[key]
        if isinstance(node, (tuple, list)):
            node = node[int(key)]
        elif isinstance(node, dict):
            node = node.get(key)
        else:
            node = getattr(node, key, None)
    return raw if node is None else node


def _error(value: NDArray[np.float64], reference: NDArray[np.float64], relative: bool) -> float:
    """Norm of the difference, divided by the norm of the reference if it is to be relative."""
    if value.shape != reference.shape:
        raise InputError(
            f"the quantity has shape {value.shape}, its reference {reference.shape}",
            source="converge",
            expected="a component, or a reference of the same shape",
        )
    scale = float(np.linalg.norm(reference)) if relative else 1.0
    if scale == 0.0:
        raise InputError("the reference is zero", source="converge", expected="relative = false")
    return float(np.linalg.norm(value - reference)) / scale


def observed_order(values: Sequence[Any], errors: Sequence[float]) -> tuple[float | None, tuple[int, ...]]:
    """Order of convergence: least-squares slope of log error over log parameter, in the asymptotic range.

    The asymptotic range is the longest run of rows whose orders from row to row are positive and agree within
    a factor of 1.5, the finest of equally long ones: coarse rows that do not converge yet and a plateau of
    rounding are left out. A parameter that grows as it refines, such as a number of modes, gives the order in
    its inverse.

    Returns
    -------
    tuple
        The order, or None if the error does not fall; and the numbers of the rows used.
    """
    pairs = [
        (i, math.log(float(value)), math.log(error))
        for i, (value, error) in enumerate(zip(values, errors, strict=True))
        if isinstance(value, (int, float)) and value > 0.0 and error > 0.0 and math.isfinite(error)
    ]
    slopes = [abs(x1 - x0) and (y0 - y1) / abs(x1 - x0) for (_, x0, y0), (_, x1, y1) in pairwise(pairs)]
    best = (0, 0)
    for start in range(len(slopes)):
        for end in range(start + 1, len(slopes) + 1):
            run = slopes[start:end]
            if min(run) > 0.0 and max(run) <= CONSISTENT * min(run) and end - start >= best[1] - best[0]:
                best = (start, end)
    if best == (0, 0):
        return None, ()
    used = pairs[best[0] : best[1] + 1]
    slope = float(np.polyfit([x for _, x, _ in used], [y for _, _, y in used], 1)[0])
    return abs(slope), tuple(i for i, _, _ in used)


def study_table(study: ConvergenceStudy) -> list[str]:
    """Lines of a table for a person."""
    kind = "relative error" if study.relative else "error"
    lines = [
        f"{study.case}: {kind} of {study.quantity}",
        f"  {study.parameter:>24} {'error':>12} {'CPU [s]':>10}",
    ]
    for i, row in enumerate(study.rows):
        value = f"{row.value:.6g}" if isinstance(row.value, (int, float)) else str(row.value)
        mark = "" if i in study.fitted else "  (not used for the order)"
        lines.append(f"  {value:>24} {row.error:12.3e} {row.cpu_s:10.3f}{mark}")
    order = (
        "cannot be told" if study.order is None else f"{study.order:.2f}, least squares over the rows used"
    )
    return [*lines, f"  observed order: {order}"]
