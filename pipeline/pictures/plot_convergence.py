"""Plots of convergence studies: error against CPU time, and against the parameter."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.results.signals import scaled_unit
from heavylift.pipeline.results.storage import replacing

if TYPE_CHECKING:
    from pathlib import Path

    from heavylift.pipeline.checks.convergence import ConvergenceStudy, WorkPrecision

__all__ = ["plot_series", "plot_study"]


def plot_study(study: ConvergenceStudy, path: Path) -> None:
    """Write a PNG with error over CPU time (left) and over the parameter with its order (right)."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 4.5), layout="constrained")
    FigureCanvasAgg(figure)
    cost, refinement = figure.subplots(1, 2, sharey=True)
    errors = [row.error for row in study.rows]
    costly = any(row.cpu_s > 0.0 for row in study.rows)  # not where only a start is computed
    cost.set_visible(costly)
    if costly:
        cost.loglog([row.cpu_s for row in study.rows], errors, "o-", color="C0")
    for row in study.rows if costly else ():
        label = f"{row.value:g}" if isinstance(row.value, (int, float)) else str(row.value)
        cost.annotate(label, (row.cpu_s, row.error), textcoords="offset points", xytext=(5, 4), fontsize=8)
    kind_of_error = f"{'relative error' if study.relative else 'error'} of {study.quantity}"
    cost.set_xlabel("CPU time [s]")
    cost.set_ylabel(kind_of_error)
    values = [row.value for row in study.rows]
    if all(isinstance(value, (int, float)) for value in values):
        refinement.loglog(values, errors, "o-", color="C0")
        if study.order is not None:
            used = [study.rows[i] for i in study.fitted]
            anchor = used[-1]
            rising = (used[0].value > used[-1].value) == (used[0].error > used[-1].error)
            slope = study.order if rising else -study.order
            line = [anchor.error * (row.value / anchor.value) ** slope for row in used]
            refinement.loglog([row.value for row in used], line, "k--", label=f"order {study.order:.2f}")
            refinement.legend(loc="upper left")
        refinement.set_xlabel(f"{study.parameter} (SI)")
        refinement.set_ylabel("" if costly else kind_of_error)
    else:
        refinement.set_visible(False)
    for axes in (cost, refinement) if costly else (refinement,):
        _tidy(axes)
        axes.margins(0.18)
    figure.suptitle(f"{study.case}: convergence with {study.parameter}")
    with replacing(path) as temporary:
        figure.savefig(temporary, format="png", dpi=120)


def plot_series(study: WorkPrecision, path: Path) -> None:
    """Write a PNG with error over CPU time, one curve a series, its first and last value written beside it."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.5, 5.5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    costs = [row.cpu_s for series in study.series for row in series.rows if row.cpu_s > 0.0]
    unit = scaled_unit("s", [np.array([max(costs, default=1.0) / 10.0])])
    for number, series in enumerate(study.series):
        rows = [
            row for row in series.rows if math.isfinite(row.error) and row.error > 0.0 and row.cpu_s > 0.0
        ]
        word = series.parameter.rpartition(".")[2]
        if not rows:
            axes.plot([], [], "o-", color=f"C{number}", label=f"{series.name}: no run completed")
            continue
        rate = (
            ""
            if series.order is None
            else f", {'slope' if series.is_over_tolerance else 'order'} {series.order:.2f}"
        )
        marker = "os^Dv<>p*h"[number % 10]
        axes.loglog(
            [row.cpu_s / unit.divisor for row in rows],
            [row.error for row in rows],
            f"{marker}-",
            color=f"C{number}",
            label=f"{series.name} ({word} {_short(rows[0].value)} to {_short(rows[-1].value)}{rate})",
        )
        for row in dict.fromkeys((rows[0], rows[-1])):
            axes.annotate(
                _short(row.value),
                (row.cpu_s / unit.divisor, row.error),
                textcoords="offset points",
                xytext=(6, 5),
                fontsize=8,
                color=f"C{number}",
            )
    kind = "relative error" if study.relative else "error"
    axes.set_xlabel(f"CPU time [{unit.text}]")
    axes.set_ylabel(f"{kind} of {study.quantity}")
    _tidy(axes)
    axes.margins(0.1)
    figure.legend(loc="outside lower left", fontsize=9)
    figure.suptitle(f"{study.case}: work and precision")
    with replacing(path) as temporary:
        figure.savefig(temporary, format="png", dpi=120)


def _short(value: Any) -> str:
    return f"{value:g}" if isinstance(value, (int, float)) else str(value)


def _tidy(axes: Any) -> None:
    """Grid, and ticks that are readable over less than a decade and not crowded over many."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.grid(visible=True, which="both", alpha=0.3)
    for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        narrow = low <= 0.0 or high / low < 1e3
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if narrow else (1.0,)))
        axis.set_major_formatter(
            FuncFormatter(lambda value, _: f"{value:.0e}" if value < 1e-2 else f"{value:g}")
        )
        axis.set_minor_formatter(NullFormatter())
