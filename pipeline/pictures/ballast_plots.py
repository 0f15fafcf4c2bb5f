"""Plot of a ballast plan, as PNG: water in the tanks over the stages, shear force and bending moment along the hull."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from heavylift.pipeline.pictures.plots import figure_png

if TYPE_CHECKING:
    from collections.abc import Sequence

    from heavylift.solver.water.hulls.ballast_plan import Girder

__all__ = ["ballast_plot"]

_COLOURS = ("#1f5fa8", "#d1661a", "#2e8b57", "#8e3b9c", "#b8322a", "#4d6470", "#a98600", "#1a9aa8")
_SHOWN = 8
"""Stages of which the girder is drawn."""


def ballast_plot(title: str, document: dict[str, Any], girders: Sequence[Girder]) -> bytes:
    """Three panels.

    Parameters
    ----------
    title
        Of the plot.
    document
        Of the command, in SI.
    girders
        One a stage.
    """
    from matplotlib.figure import Figure

    stages = document["stages"]
    names = list(document["capacity"])
    figure = Figure(figsize=(10.0, 10.5), dpi=110, layout="constrained")
    figure.suptitle(title)
    upper, middle, lower = figure.subplots(3, 1)
    width = 0.8 / len(names)
    for i, name in enumerate(names):
        places = [k + (i - 0.5 * (len(names) - 1)) * width for k in range(len(stages))]
        upper.bar(
            places,
            [row["tanks"][name] * 1e-3 for row in stages],
            0.9 * width,
            label=name,
            color=_COLOURS[i % len(_COLOURS)],
        )
    upper.set_xticks(
        range(len(stages)),
        [row["stage"] for row in stages],
        rotation=30 if len(stages) > 6 else 0,
        ha="right" if len(stages) > 6 else "center",
    )
    upper.set_ylabel("water [t]")
    upper.legend(ncols=min(len(names), 6), fontsize="small")
    shown = range(0, len(stages), -(-len(stages) // _SHOWN))
    for colour, k in zip(_COLOURS, shown, strict=False):
        beam = girders[k]
        middle.plot(beam.stations, beam.shear * 1e-6, color=colour, label=stages[k]["stage"])
        lower.plot(beam.stations, beam.bending * 1e-6, color=colour)
    middle.set_ylabel("shear force [MN]")
    lower.set_ylabel("bending moment, sagging up [MN m]")
    lower.set_xlabel("x [m]")
    middle.legend(ncols=min(len(shown), 4), fontsize="small")
    for axes in (upper, middle, lower):
        axes.grid(alpha=0.3)
        axes.axhline(0.0, color="#66707c", linewidth=0.8)
    return figure_png(figure)
