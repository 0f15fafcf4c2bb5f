"""Plot of a convergence study: error against CPU time, and against the parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING

from heavylift.pipeline.storage import replacing

if TYPE_CHECKING:
    from pathlib import Path

    from heavylift.pipeline.converge import ConvergenceStudy

__all__ = ["plot_study"]


def plot_study(study: ConvergenceStudy, path: Path) -> None:
    """Write a PNG with error over CPU time (left) and over the parameter with its order (right)."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    figure = Figure(figsize=(10.0, 4.5), layout="constrained")
    FigureCanvasAgg(figure)
    cost, refinement = figure.subplots(1, 2, sharey=True)
    errors = [row.error for row in study.rows]
    cost.loglog([row.cpu_s for row in study.rows], errors, "o-", color="C0")
    for row in study.rows:
        label = f"{row.value:g}" if isinstance(row.value, (int, float)) else str(row.value)
        cost.annotate(label, (row.cpu_s, row.error), textcoords="offset points", xytext=(5, 4), fontsize=8)
    kind = "relative error" if study.relative else "error"
    cost.set_xlabel("CPU time [s]")
    cost.set_ylabel(f"{kind} of {study.quantity}")
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
    else:
        refinement.set_visible(False)
    for axes in (cost, refinement):
        axes.grid(visible=True, which="both", alpha=0.3)
        axes.margins(0.18)
        for axis in (axes.xaxis, axes.yaxis):  # 1, 2, 5: readable over less than a decade, never crowded
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter(
                FuncFormatter(lambda value, _: f"{value:.0e}" if value < 1e-2 else f"{value:g}")
            )
            axis.set_minor_formatter(NullFormatter())
    figure.suptitle(f"{study.case}: convergence with {study.parameter}")
    with replacing(path) as temporary:
        figure.savefig(temporary, format="png", dpi=120)
