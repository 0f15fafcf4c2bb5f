"""Plots of results as PNG: time histories, amplitude spectra, energy balance, convergence."""

from __future__ import annotations

import io
import math
import re
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.pipeline.results.signals import amplitude_spectrum, envelope, scaled_unit, spectrum_peaks
from heavylift.pipeline.results.storage import replacing
from heavylift.solver.integrate.run_watch import RunWatch
from heavylift.solver.scene.channels import Channel

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.pipeline.checks.convergence import ConvergenceStudy, WorkPrecision

__all__ = [
    "COLOURS",
    "GREY",
    "INK",
    "Series",
    "add_legend",
    "add_title",
    "constant_parts",
    "energy_plot",
    "few_colours",
    "figure_png",
    "history_figure",
    "history_plot",
    "plain_text",
    "plot_figure",
    "plot_series",
    "plot_study",
    "shade",
    "spectrum_plot",
    "tidy_axes",
]


def figure_png(figure: Any) -> bytes:
    """Content of a PNG file at the resolution of the figure."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    buffer = io.BytesIO()
    FigureCanvasAgg(figure).print_png(buffer)
    return buffer.getvalue()


def few_colours(png: bytes) -> bytes:
    """The picture with a palette of 256 colours: a quarter of the size for plots and for sheets of thumbnails."""
    from PIL import Image

    buffer = io.BytesIO()
    with Image.open(io.BytesIO(png)) as image:
        flat = image.convert("RGB").quantize(256, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    flat.save(buffer, format="png")
    return buffer.getvalue()


_DPI = 110
_WIDTH = 10.0
_LETTER, _HANDLE = 0.085, 0.55  # width of a letter, and of a line with its space, in a legend [in]
INK = "#1d2733"
GREY = "#66707c"
_FAR = 2.0  # an energy is shifted that never comes nearer to zero than this many times the largest change of any,
_STEADY = 1.0e-9  # unless nothing changes, but for rounding
_NAMED = 0.012  # part of the whole time that is wide enough for a name
COLOURS = ("#1f5fa8", "#d1661a", "#2e8b57", "#8e3b9c", "#b8322a", "#4d6470", "#a98600", "#1a9aa8")


class Series(NamedTuple):
    """One curve: what it is, and its values over time, shape (nt,).

    `aliased` says that it oscillates faster than half the sampling rate, so that its spectrum shows false
    frequencies; they are not labelled.
    """

    label: str
    values: NDArray[np.float64]
    aliased: bool = False


def history_plot(
    times: NDArray[np.float64],
    series: Sequence[Series],
    *,
    title: str,
    unit: str,
    stacked: bool = False,
    bands: Sequence[tuple[str, float, float]] = (),
) -> bytes:
    """Curves over time, as a picture.

    Parameters
    ----------
    times
        [s], shape (nt,).
    series
        Curves of one unit.
    title
        Heading.
    unit
        SI unit of the values; written with a prefix that suits them.
    stacked
        One axis system a curve, each with its own scale; otherwise all in one.
    bands
        Names of parts of the time, and where they begin and end [s]; every other one is shaded.
    """
    groups = [[curve] for curve in series] if stacked else [list(series)]
    figure = history_figure(times, [(unit, group) for group in groups], title=title, bands=bands)
    return few_colours(figure_png(figure))


def history_figure(
    times: NDArray[np.float64],
    groups: Sequence[tuple[str, Sequence[Series]]],
    *,
    title: str,
    bands: Sequence[tuple[str, float, float]] = (),
) -> Any:
    """Curves over time, as a `matplotlib.figure.Figure`.

    Parameters
    ----------
    times, title, bands
        As of `history_plot`.
    groups
        Curves that share axes, below each other: their SI unit, which is written with a prefix that suits them.
    """
    rows = len(groups)
    heights = [1.25 if len(group) == 1 else 2.0 for _, group in groups]
    figure = plot_figure(0.9 + (sum(heights) if rows > 1 else 3.2))
    panels = figure.subplots(rows, 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    time_unit = scaled_unit("s", [times])
    number = 0
    for axes, (unit, group) in zip(panels, groups, strict=True):
        own = scaled_unit(unit, [curve.values for curve in group])
        for curve in group:
            t, y = envelope(times, curve.values)
            colour = COLOURS[number % len(COLOURS)]
            axes.plot(
                t / time_unit.divisor, y / own.divisor, color=colour, lw=1.0, label=plain_text(curve.label)
            )
            number += 1
        tidy_axes(axes)
        axes.set_xlim(times[0] / time_unit.divisor, max(times[-1], times[0] + 1e-12) / time_unit.divisor)
        shade(axes, bands, time_unit.divisor, named=axes is panels[-1])
        if rows > 1 and len(group) == 1:
            axes.set_ylabel(f"{plain_text(group[0].label)}\n[{_unit(own.text)}]", color=INK, fontsize=9)
        else:
            axes.set_ylabel(f"[{_unit(own.text)}]", color=INK)
        if rows > 1:
            axes.yaxis.set_major_locator(_few_ticks())
        if len(group) > 1:
            add_legend(axes)
    panels[-1].set_xlabel(f"time [{time_unit.text}]", color=INK)
    figure.align_ylabels(panels)
    add_title(figure, title)
    return figure


def spectrum_plot(
    interval: float,
    series: Sequence[Series],
    *,
    title: str,
    unit: str,
    lines: Mapping[str, float] | None = None,
    peak_count: int = 6,
) -> bytes:
    """Amplitude spectra with their peaks marked.

    Parameters
    ----------
    interval
        Time between samples [s].
    series
        Curves of one unit, at least 8 samples each.
    title
        Heading.
    unit
        SI unit of the values.
    lines
        Frequencies [Hz] drawn as dashed lines, with short labels written at their upper ends.
    peak_count
        So many peaks, the highest of all curves that are not aliased, are marked with their frequency.
    """
    figure = plot_figure(4.4)
    axes = figure.subplots()
    spectra = [amplitude_spectrum(curve.values, interval) for curve in series]
    scale = scaled_unit(unit, [spectrum.amplitudes for spectrum in spectra])
    top = max(float(spectrum.amplitudes.max()) for spectrum in spectra)
    upper = _upper_frequency(spectra, lines or {}, top)
    hertz = scaled_unit("Hz", [np.array([upper])])
    peaks = []
    for number, (curve, spectrum) in enumerate(zip(series, spectra, strict=True)):
        colour = COLOURS[number % len(COLOURS)]
        shown = spectrum.frequencies <= upper
        x, y = envelope(spectrum.frequencies[shown], spectrum.amplitudes[shown], 4000)
        name = plain_text(curve.label) + (" (aliased)" if curve.aliased else "")
        axes.plot(x / hertz.divisor, y / scale.divisor, color=colour, lw=1.1, label=name)
        if curve.aliased:
            continue
        peaks += [
            (amplitude, frequency, colour)
            for frequency, amplitude in spectrum_peaks(spectrum, count=peak_count)
            if amplitude > 1.0e-3 * top and frequency <= upper
        ]
    axes.set_yscale("log")
    axes.set_xlim(0.0, upper / hertz.divisor)
    if top > 0.0:
        axes.set_ylim(1.0e-5 * top / scale.divisor, 8.0 * top / scale.divisor)
    tidy_axes(axes)
    _frequency_lines(
        axes, {label: f / hertz.divisor for label, f in (lines or {}).items()}, upper / hertz.divisor
    )
    peaks = sorted(peaks, reverse=True)[:peak_count]
    _peak_labels(axes, [(f / hertz.divisor, a / scale.divisor, colour, f) for a, f, colour in peaks])
    axes.set_xlabel(f"frequency [{hertz.text}]", color=INK)
    axes.set_ylabel(f"amplitude [{_unit(scale.text)}]", color=INK)
    if len(series) > 1:
        add_legend(axes)
    add_title(figure, title)
    return few_colours(figure_png(figure))


def constant_parts(energies: Mapping[str, NDArray[np.float64]]) -> dict[str, float]:
    """Initial values [J] of energies that stay far from zero compared with what changes, by name.

    Drawn from zero on such an energy would hide all that happens: the potential of a ship, whose zero is arbitrary.
    """
    parts = {name: values for name, values in energies.items() if name != "balance" and len(values)}
    change = max((float(np.ptp(values)) for values in parts.values()), default=0.0)
    least = {name: float(np.abs(values).min()) for name, values in parts.items()}
    if not change > _STEADY * max(least.values(), default=0.0):
        return {}
    return {name: float(values[0]) for name, values in parts.items() if least[name] > _FAR * change}


def energy_plot(
    times: NDArray[np.float64], energies: Mapping[str, NDArray[np.float64]], *, title: str = "Energy balance"
) -> bytes:
    """Energies over time, and below them how far their balance strays from its initial value.

    Parameters
    ----------
    times
        [s], shape (nt,).
    energies
        Name to values [J], shape (nt,); ``"balance"`` is constant in exact arithmetic. Energies that stay zero
        are left out; of those that are large and hardly change the initial value is subtracted, which the legend says.
    title
        Heading.

    Notes
    -----
    The drift is relative to the energy turned over, as in `heavylift.solver.integrate.run_watch`.
    """
    parts = {name: values for name, values in energies.items() if name != "balance" and np.any(values)}
    words = {name: plain_text(name.replace("_", " ")) for name in parts}
    watch = RunWatch([Channel(f"energy.{name}", "J", ("",), i, "") for i, name in enumerate(energies)])
    watch.add(np.column_stack(list(energies.values())))
    reference = watch.scale or 1.0
    for name, constant in constant_parts(parts).items():
        unit = scaled_unit("J", [np.array([constant])])
        size = f"{abs(constant) / unit.divisor:.5g} {_unit(unit.text)}"
        words[name] += f" {'-' if constant > 0.0 else '+'} {size}"
        parts[name] = parts[name] - constant
    balance = energies.get("balance")
    figure = plot_figure(5.2 if balance is not None else 3.8)
    ratios = [2.2, 1.0] if balance is not None else [1.0]
    panels = figure.subplots(len(ratios), 1, sharex=True, squeeze=False, height_ratios=ratios)[:, 0]
    time_unit = scaled_unit("s", [times])
    scale = scaled_unit("J", list(parts.values()))
    for number, (name, values) in enumerate(parts.items()):
        t, y = envelope(times, values)
        panels[0].plot(
            t / time_unit.divisor,
            y / scale.divisor,
            color=COLOURS[number % len(COLOURS)],
            lw=1.0,
            label=words[name],
        )
    if parts and max(np.ptp(v) for v in parts.values()) <= _STEADY * max(
        np.abs(v).max() for v in parts.values()
    ):
        low, high = panels[0].get_ylim()
        panels[0].set_ylim(min(1.1 * low, 0.0), max(1.1 * high, 0.0))  # rounding alone would fill the picture
    panels[0].set_ylabel(f"energy [{_unit(scale.text)}]", color=INK)
    if parts:
        add_legend(panels[0])
    if balance is not None:
        t, y = envelope(times, (balance - balance[0]) / reference)
        error = scaled_unit("", [y])
        panels[1].plot(t / time_unit.divisor, y / error.divisor, color=COLOURS[4], lw=1.0)
        unit_words = _unit(error.text.strip() or "–")
        panels[1].set_ylabel(f"drift of balance /\nenergy turned over [{unit_words}]", color=INK)
    for axes in panels:
        tidy_axes(axes)
        axes.set_xlim(times[0] / time_unit.divisor, max(times[-1], times[0] + 1e-12) / time_unit.divisor)
    panels[-1].set_xlabel(f"time [{time_unit.text}]", color=INK)
    figure.align_ylabels(panels)
    add_title(figure, title)
    return few_colours(figure_png(figure))


def _upper_frequency(spectra: Sequence[Any], lines: Mapping[str, float], top: float) -> float:
    """Where the plot ends: beyond what rises above a thousandth of the top, and some lines; Nyquist at most."""
    nyquist = float(spectra[0].frequencies[-1])
    high = [s.frequencies[s.amplitudes > 1.0e-3 * top].max(initial=0.0) for s in spectra]
    active = max(float(f) for f in high) or nyquist
    beyond = [f for f in lines.values() if f <= 1.3 * active]
    return min(nyquist, 1.2 * max([active, *beyond]))


def _frequency_lines(axes: Any, lines: Mapping[str, float], upper: float) -> None:
    """Dashed lines with a label at the top; labels too near to the one before are left out."""
    last = -np.inf
    for label, place in sorted(lines.items(), key=lambda item: item[1]):
        if place > upper:
            break
        axes.axvline(place, color=GREY, ls=(0, (4, 3)), lw=0.8, zorder=1)
        if place - last > 0.022 * upper:
            axes.annotate(
                plain_text(label),
                (place, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(0, -3),
                textcoords="offset points",
                fontsize=8,
                color=GREY,
                ha="center",
                va="top",
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0},
            )
            last = place


def _peak_labels(axes: Any, peaks: Sequence[tuple[float, float, str, float]]) -> None:
    """Mark peaks; write the frequency [Hz] above or beside those that leave room for it, highest first."""
    low, high = axes.get_xlim()
    bottom, top = np.log10(axes.get_ylim())
    taken: list[tuple[float, float]] = []
    for x, y, colour, hertz in peaks:
        axes.plot([x], [y], marker="o", ms=4, color=colour, zorder=3)
        u, v = (x - low) / (high - low), (np.log10(y) - bottom) / (top - bottom)
        # centre of the label in shares of the axes, offset in points, alignment
        places = (
            ((u, v + 0.05), (0, 6), "center"),
            ((u + 0.05, v), (8, -4), "left"),
            ((u - 0.05, v), (-8, -4), "right"),
        )
        for place, offset, alignment in places:
            inside = 0.04 < place[0] < 0.96
            if inside and all(abs(place[0] - s) > 0.085 or abs(place[1] - t) > 0.06 for s, t in taken):
                axes.annotate(
                    f"{hertz:.5g} Hz",
                    (x, y),
                    xytext=offset,
                    textcoords="offset points",
                    fontsize=9,
                    color=colour,
                    ha=alignment,
                    va="bottom",
                    zorder=4,
                    bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8},
                )
                taken.append(place)
                break


def plot_figure(height: float) -> Any:
    """An empty figure of the width of a report and a height [in]."""
    return _figure_class()(figsize=(_WIDTH, height), dpi=_DPI, facecolor="white", layout="constrained")


@cache
def _figure_class() -> Any:
    """Class of figures that a notebook shows as pictures, whatever draws its other figures."""
    from matplotlib.figure import Figure

    def picture(self: Any) -> bytes:
        return figure_png(self)

    return type("PlotFigure", (Figure,), {"__doc__": "A figure of results.", "_repr_png_": picture})


def tidy_axes(axes: Any) -> None:
    """Grid, ticks and spines as in all plots."""
    axes.grid(visible=True, color="#e3e7eb", lw=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(colors=INK, labelsize=9.5, length=3)
    axes.ticklabel_format(axis="x", useOffset=False)
    if axes.get_yscale() == "linear":
        axes.ticklabel_format(axis="y", useOffset=False)
    for side, spine in axes.spines.items():
        spine.set_visible(side in {"left", "bottom"})
        spine.set_color("#9aa4ae")


def shade(
    axes: Any, bands: Sequence[tuple[str, float, float]], divisor: float, *, named: bool = True
) -> None:
    """Shade every other part of the time; names stand upright in those that are wide enough."""
    low, high = axes.get_xlim()
    for number, (name, begin, end) in enumerate(bands):
        if number % 2 == 0:
            axes.axvspan(begin / divisor, end / divisor, color="#eef2f6", lw=0.0, zorder=0)
        if named and (end - begin) / divisor > _NAMED * (high - low):
            axes.text(
                0.5 * (begin + end) / divisor,
                0.02,
                plain_text(name.replace("_", " ")),
                transform=axes.get_xaxis_transform(),
                rotation=90,
                ha="center",
                va="bottom",
                fontsize=8,
                color=GREY,
            )


def _few_ticks() -> Any:
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(4, steps=[1, 2, 2.5, 5, 10])


def add_legend(axes: Any) -> None:
    """Legend above the axes, at the right: never over a curve, and in as many rows as its words need."""
    labels = axes.get_legend_handles_labels()[1]
    axes.legend(
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncols=max(1, min(8, int(_WIDTH / (_HANDLE + _LETTER * max(map(len, labels), default=0))))),
        frameon=False,
        fontsize=9.5,
        labelcolor=INK,
        handlelength=1.4,
        columnspacing=1.2,
        borderaxespad=0.2,
    )


def add_title(figure: Any, title: str) -> None:
    """Heading of a figure."""
    figure.suptitle(plain_text(title), x=0.012, ha="left", fontsize=13, weight="bold", color=INK)


def plain_text(text: str) -> str:
    """Text in which matplotlib finds no formula."""
    return text.replace("$", r"\$")


def _unit(text: str) -> str:
    """Powers of a unit as superscripts."""
    return re.sub(r"\^(-?[\d.]+)", r"$^{\1}$", text)


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
        _tidy_logarithmic(axes)
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
    _tidy_logarithmic(axes)
    axes.margins(0.1)
    figure.legend(loc="outside lower left", fontsize=9)
    figure.suptitle(f"{study.case}: work and precision")
    with replacing(path) as temporary:
        figure.savefig(temporary, format="png", dpi=120)


def _short(value: Any) -> str:
    return f"{value:g}" if isinstance(value, (int, float)) else str(value)


def _tidy_logarithmic(axes: Any) -> None:
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
