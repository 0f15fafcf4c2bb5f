"""Pictures of ``heavylift statistics``: spectra, and extremes of several runs on Gumbel's probability paper."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.pictures.png import few_colours, figure_png
from heavylift.pipeline.results.signals import scaled_unit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from heavylift.pipeline.results.statistics import ColumnStatistics, GumbelFit

__all__ = ["gumbel_plots", "spectrum_plots"]

PANELS = 6
"""Of a picture."""

ENERGY_SHOWN = 0.999
"""Part of the variance up to which a spectrum is drawn."""

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
