"""Plots of criteria: values over a curve of limits, what criteria use over time, how tensions are spread."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.pipeline.pictures.plots import (
    COLOURS,
    GREY,
    INK,
    add_legend,
    add_title,
    few_colours,
    figure_png,
    plain_text,
    plot_figure,
    shade,
    tidy_axes,
)
from heavylift.pipeline.results.signals import envelope, scaled_unit

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.case.criteria.results import CurveFigure

__all__ = ["curve_plot", "tension_plot", "utilisation_plot"]

_LIMIT = "#b8322a"
_FEW = 8  # curves with names of their own


def curve_plot(content: CurveFigure) -> bytes:
    """Values of a run over a place, beside a curve of limits, what is nearest to it marked."""
    (places, limits), (place, value) = content.curve, content.values
    figure = plot_figure(4.6)
    axes = figure.subplots()
    scale = scaled_unit(content.unit, [np.array(limits), value])
    axes.plot(places, np.array(limits) / scale.divisor, "-o", color=_LIMIT, lw=1.8, ms=4, label=content.limit)
    axes.plot(place, value / scale.divisor, color=COLOURS[0], lw=1.2, label=f"{content.value} over the run")
    axes.plot(
        place[:1],
        value[:1] / scale.divisor,
        "o",
        color="white",
        mec=COLOURS[0],
        ms=6,
        label="start",
        zorder=3,
    )
    if content.governing is not None:
        axes.plot(
            [content.governing[0]],
            [content.governing[1] / scale.divisor],
            "D",
            color=COLOURS[1],
            ms=7,
            label="governs",
            zorder=4,
        )
    finite = np.isfinite(place)
    low = min(places[0], float(place[finite].min(initial=places[0])))
    high = max(places[-1], float(place[finite].max(initial=places[-1])))
    axes.set_xlim(low - 0.04 * (high - low), high + 0.04 * (high - low))
    axes.set_ylim(bottom=0.0)
    tidy_axes(axes)
    axes.set_xlabel(content.place, color=INK)
    axes.set_ylabel(f"{content.value} [{scale.text}]", color=INK)
    add_legend(axes)
    add_title(figure, content.title)
    return few_colours(figure_png(figure))


def utilisation_plot(
    histories: Mapping[str, tuple[NDArray[np.float64], NDArray[np.float64]]],
    *,
    title: str,
    bands: Sequence[tuple[str, float, float]] = (),
) -> bytes:
    """What criteria use of their limits over time, the limit at 100 %, phases as bands.

    Parameters
    ----------
    histories
        Times [s] and utilisations, by name; beyond the first eight names the rest is drawn in grey.
    title
        Heading.
    bands
        Phases of the operation: name, begin and end [s].
    """
    figure = plot_figure(4.4 + 0.22 * min(len(histories), _FEW))
    axes = figure.subplots()
    every = [times for times, _ in histories.values()]
    begin, end = min(float(t[0]) for t in every), max(float(t[-1]) for t in every)
    unit = scaled_unit("s", every)
    for number, (name, (times, used)) in enumerate(histories.items()):
        shown = np.where(np.isfinite(used), 100.0 * used, np.nan)
        t, y = envelope(times, shown) if np.isfinite(shown).all() else (times, shown)
        few = number < _FEW
        colour = COLOURS[number % len(COLOURS)] if few else GREY
        label = name if few else "others" if number == _FEW else None
        axes.plot(
            t / unit.divisor, y, color=colour, lw=1.1 if few else 0.6, label=label and plain_text(label)
        )
    axes.axhline(100.0, color=_LIMIT, lw=1.4, ls=(0, (5, 3)))
    axes.set_xlim(begin / unit.divisor, max(end, begin + 1e-12) / unit.divisor)
    peaks = [100.0 * float(np.nanmax(u[np.isfinite(u)], initial=0.0)) for _, u in histories.values()]
    axes.set_ylim(0.0, min(max(115.0, 1.15 * max(peaks)), 400.0))
    shade(axes, bands, unit.divisor)
    tidy_axes(axes)
    axes.set_xlabel(f"time [{unit.text}]", color=INK)
    axes.set_ylabel("used of the limit [%]", color=INK)
    axes.legend(
        loc="upper left",
        bbox_to_anchor=(0.0, -0.16),
        ncols=2,
        frameon=False,
        fontsize=9.0,
        labelcolor=INK,
        handlelength=1.4,
    )
    add_title(figure, title)
    return few_colours(figure_png(figure))


def tension_plot(
    times: NDArray[np.float64],
    tensions: Mapping[str, NDArray[np.float64]],
    *,
    title: str,
    bands: Sequence[tuple[str, float, float]] = (),
) -> bytes:
    """Tensions of several ropes, the band between the smallest and the largest one, and their mean.

    Parameters
    ----------
    times
        [s], shape (nt,).
    tensions
        By name [N], shape (nt,); single curves are drawn of up to eight.
    title
        Heading.
    bands
        Phases of the operation: name, begin and end [s].
    """
    figure = plot_figure(4.1)
    axes = figure.subplots()
    values = np.array(list(tensions.values()))
    scale, unit = scaled_unit("N", [values]), scaled_unit("s", [times])
    t = times / unit.divisor
    axes.fill_between(
        t,
        values.min(axis=0) / scale.divisor,
        values.max(axis=0) / scale.divisor,
        color=COLOURS[0],
        alpha=0.16,
        lw=0,
        label="smallest to largest",
    )
    if len(tensions) <= _FEW:
        for number, (name, one) in enumerate(tensions.items()):
            axes.plot(
                t, one / scale.divisor, color=COLOURS[number % len(COLOURS)], lw=0.9, label=plain_text(name)
            )
    axes.plot(t, values.mean(axis=0) / scale.divisor, color=INK, lw=1.2, ls=(0, (4, 2)), label="mean")
    axes.set_xlim(t[0], max(t[-1], t[0] + 1e-12))
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    shade(axes, bands, unit.divisor)
    tidy_axes(axes)
    axes.set_xlabel(f"time [{unit.text}]", color=INK)
    axes.set_ylabel(f"tension [{scale.text}]", color=INK)
    axes.legend(
        loc="upper left",
        bbox_to_anchor=(0.0, -0.16),
        ncols=5,
        frameon=False,
        fontsize=9.0,
        labelcolor=INK,
        handlelength=1.4,
    )
    add_title(figure, title)
    return few_colours(figure_png(figure))
