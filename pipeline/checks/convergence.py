"""What a convergence study found: rows, observed orders, the cost of an accuracy, tables."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "ConvergenceRow",
    "ConvergenceStudy",
    "WorkPrecision",
    "cost_of_error",
    "fitted_slope",
    "observed_order",
    "study_table",
]

CONSISTENT = 1.5
"""Largest ratio of the orders from row to row within the asymptotic range."""
TARGETS = (1e-2, 1e-4, 1e-6)
"""Errors whose cost the table of several series tells."""


@dataclass(frozen=True)
class ConvergenceRow:
    """One run of a study.

    Attributes
    ----------
    value
        Value of the parameter, SI if it is a quantity.
    error
        Distance of the quantity from its reference; not a number if the run did not complete.
    cpu_s
        CPU time of the stages that make the quantity, without compiling [s].
    steps
        Steps of the simulation; None if the quantity needs none.
    message
        Why the run did not complete; empty if it did.
    """

    value: Any
    error: float
    cpu_s: float
    steps: int | None = None
    message: str = ""


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
        Order of convergence by `observed_order`, over the rows in `fitted`; None if it is unknown. Of a
        tolerance the slope by `fitted_slope`, which says how the error follows it and is no order.
    fitted
        Numbers of the rows the order was taken from.
    name
        Of the series, if it is one of several.
    """

    case: str
    parameter: str
    quantity: str
    relative: bool
    rows: tuple[ConvergenceRow, ...]
    order: float | None
    fitted: tuple[int, ...]
    name: str = ""

    @property
    def is_over_tolerance(self) -> bool:
        """Whether the parameter is a tolerance."""
        return self.parameter.rpartition(".")[2] == "tolerance"

    def document(self) -> dict[str, Any]:
        """The document that ``converge --json`` prints."""
        rows = [{"value": row.value, "error": row.error, "cpu_s": row.cpu_s} for row in self.rows]
        return {"case": self.case, "parameter": self.parameter, "rows": rows, "order": self.order}


@dataclass(frozen=True)
class WorkPrecision:
    """Several series of runs that compute the same quantity in different ways.

    Attributes
    ----------
    case, quantity
        Names.
    relative
        Whether errors are relative.
    series
        One study a series.
    """

    case: str
    quantity: str
    relative: bool
    series: tuple[ConvergenceStudy, ...]

    def document(self) -> dict[str, Any]:
        """The document that ``converge --json`` prints."""
        return {
            "case": self.case,
            "quantity": self.quantity,
            "relative": self.relative,
            "series": [
                {
                    "name": study.name,
                    "parameter": study.parameter,
                    "rows": [
                        {
                            "value": row.value,
                            "error": row.error,
                            "cpu_s": row.cpu_s,
                            "steps": row.steps,
                            "message": row.message,
                        }
                        for row in study.rows
                    ],
                    "slope" if study.is_over_tolerance else "order": study.order,
                    "cpu_s_of_error": {f"{e:g}": cost_of_error(study.rows, e) for e in TARGETS},
                }
                for study in self.series
            ],
        }


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
    pairs = _logarithms(values, errors)
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


def fitted_slope(values: Sequence[Any], errors: Sequence[float]) -> tuple[float | None, tuple[int, ...]]:
    """Least-squares slope of log error over log parameter through all rows, and their numbers.

    For a tolerance, which the error follows in jumps: 1 says that the error is proportional to it.
    """
    pairs = _logarithms(values, errors)
    if len({x for _, x, _ in pairs}) < 2:
        return None, ()
    slope = float(np.polyfit([x for _, x, _ in pairs], [y for _, _, y in pairs], 1)[0])
    return slope, tuple(i for i, _, _ in pairs)


def _logarithms(values: Sequence[Any], errors: Sequence[float]) -> list[tuple[int, float, float]]:
    """Row numbers, logarithms of values and errors, where both have one."""
    return [
        (i, math.log(float(value)), math.log(error))
        for i, (value, error) in enumerate(zip(values, errors, strict=True))
        if isinstance(value, (int, float)) and value > 0.0 and error > 0.0 and math.isfinite(error)
    ]


def cost_of_error(rows: Sequence[ConvergenceRow], error: float) -> float | None:
    """Least CPU time [s] that reaches an error, by logarithmic interpolation between successive rows.

    That of the cheapest row if even this one is more accurate; None if no row is accurate enough.
    """
    good = [row for row in rows if math.isfinite(row.error) and row.cpu_s > 0.0]
    costs = [row.cpu_s for row in good if row.error <= error]
    for a, b in pairwise(good):
        if a.error > error >= b.error > 0.0:
            share = math.log(a.error / error) / math.log(a.error / b.error)
            costs.append(a.cpu_s * (b.cpu_s / a.cpu_s) ** share)
    return min(costs, default=None)


def study_table(study: ConvergenceStudy | WorkPrecision) -> list[str]:
    """Lines of a table for a person."""
    kind = "relative error" if study.relative else "error"
    head = f"{study.case}: {kind} of {study.quantity}"
    if isinstance(study, ConvergenceStudy):
        return [head, *_rows(study)]
    lines = [head]
    for series in study.series:
        words = [f"{error:g}: {_cost_words(series.rows, error)}" for error in TARGETS]
        lines += ["", f"  {series.name}", *_rows(series), f"  CPU time for an error of {', '.join(words)}"]
    return lines


def _cost_words(rows: Sequence[ConvergenceRow], error: float) -> str:
    """Cost of an error; "at most" if no run is less accurate, so that a cheaper one might do."""
    cost = cost_of_error(rows, error)
    if cost is None:
        return "not reached"
    bound = "" if any(row.error > error for row in rows) else "at most "
    return f"{bound}{1e3 * cost:.3g} ms"


def _rows(study: ConvergenceStudy) -> list[str]:
    """Header, rows and order of one series."""
    counted = study.name and any(row.steps is not None for row in study.rows)
    steps = f" {'steps':>9}" if counted else ""
    lines = [f"  {study.parameter:>24} {'error':>12} {'CPU [s]':>11}{steps}"]
    for i, row in enumerate(study.rows):
        value = f"{row.value:.6g}" if isinstance(row.value, (int, float)) else str(row.value)
        if row.message:
            lines.append(f"  {value:>24} {'-':>12} {row.cpu_s:11.4g}  {row.message.splitlines()[0]}")
            continue
        mark = "" if i in study.fitted else "  (not used for the order)"
        count = f" {row.steps:9d}" if counted and row.steps is not None else ""
        lines.append(f"  {value:>24} {row.error:12.3e} {row.cpu_s:11.4g}{count}{mark}")
    what = "slope of log error over log tolerance" if study.is_over_tolerance else "observed order"
    order = "unknown" if study.order is None else f"{study.order:.2f}, least squares over the rows used"
    return [*lines, f"  {what}: {order}"]
