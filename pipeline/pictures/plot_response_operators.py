"""Pictures of response operators and response spectra as PNG."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.pictures.png import few_colours, figure_png
from heavylift.preprocess.hydrodynamics.database import COORDINATES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.solver.water.hulls.frequency_domain import MotionOperators, NaturalMode, ResponseStatistics

__all__ = ["operator_plot", "response_plot"]

_DPI = 110
_INK = "#1d2733"
_GREY = "#66707c"
_COLOURS = ("#1f5fa8", "#d1661a", "#2e8b57", "#8e3b9c", "#b8322a", "#4d6470", "#a98600", "#1a9aa8")

_INVISIBLE = 1e-6
"""Of the largest amplitude of a coordinate: the phase of less is round-off."""

_SMALL = 1e-2
"""Of the largest amplitude of its panel: the phase of less turns fast and says nothing."""


def operator_plot(
    operators: MotionOperators, *, body: int = 0, title: str = "", modes: Sequence[NaturalMode] = ()
) -> bytes:
    """Amplitude and phase of the six coordinates of a hull over the wave period, a curve a heading.

    Parameters
    ----------
    operators
        Response operators.
    body
        Index of the hull.
    title
        Heading; by default the name of the hull.
    modes
        Natural modes; those of this hull are dashed lines in the panel of their largest coordinate.

    Returns
    -------
    bytes
        PNG.
    """
    figure = _figure(9.5)
    panels = figure.subplots(6, 2, sharex=True)
    periods = 2.0 * math.pi / operators.omega
    for j, name in enumerate(COORDINATES):
        amplitude, phase = panels[j]
        factor, unit = (1.0, "m/m") if j < 3 else (180.0 / math.pi, "deg/m")
        values = operators.motion[:, :, 6 * body + j]
        # what is zero by symmetry has no phase: measured by the other translations or rotations
        kind = operators.amplitude[:, :, 6 * body + 3 * (j // 3) : 6 * body + 3 * (j // 3) + 3]
        size = np.abs(values)
        shown = size > max(_INVISIBLE * float(kind.max()), _SMALL * float(size.max()), 1e-30)
        for number, heading in enumerate(operators.headings):
            colour = _COLOURS[number % len(_COLOURS)]
            label = f"{math.degrees(heading):.4g}°"
            amplitude.plot(periods, factor * np.abs(values[:, number]), color=colour, lw=1.2, label=label)
            if np.any(shown[:, number]):
                angles = np.where(shown[:, number], np.degrees(np.angle(values[:, number])), np.nan)
                phase.plot(periods, _without_jumps(angles), color=colour, lw=1.0)
        for mode in modes:
            if mode.coordinate == 6 * body + j and periods.min() <= mode.period <= periods.max():
                amplitude.axvline(mode.period, color=_GREY, ls=(0, (4, 3)), lw=0.8)
        amplitude.set_ylabel(f"{name}\n[{unit}]", color=_INK, fontsize=9)
        amplitude.set_ylim(bottom=0.0)
        phase.set_ylim(-190.0, 190.0)
        phase.set_yticks([-180, -90, 0, 90, 180])
        _tidy(amplitude)
        _tidy(phase)
    panels[0, 0].set_title("amplitude", fontsize=10, color=_INK)
    panels[0, 1].set_title("phase behind the crest [deg]", fontsize=10, color=_INK)
    # long waves say little and would fill the axis
    panels[0, 0].set_xlim(float(periods.min()), min(float(periods.max()), 30.0))
    for axes in panels[-1]:
        axes.set_xlabel("wave period [s]", color=_INK)
    _legend(figure, panels[0, 0], "heading (direction of travel)")
    figure.align_ylabels(panels[:, 0])
    figure.suptitle(title or f"Motions of {operators.bodies[body]}", color=_INK, fontsize=12)
    return few_colours(figure_png(figure))


def response_plot(
    statistics: ResponseStatistics,
    wave: NDArray[np.float64],
    *,
    body: int = 0,
    title: str = "Response spectra",
) -> bytes:
    """Response spectra of the six coordinates of a hull above the spectrum of the waves.

    Parameters
    ----------
    statistics
        Response.
    wave
        Density of the elevation [m^2 s/rad] on the same frequencies, shape (k,).
    body
        Index of the hull.
    title
        Heading.

    Returns
    -------
    bytes
        PNG.
    """
    figure = _figure(7.0)
    panels = figure.subplots(4, 2, sharex=True)
    panels[0, 0].plot(statistics.omega, wave, color=_GREY, lw=1.2)
    panels[0, 0].set_ylabel("waves\n[m² s/rad]", color=_INK, fontsize=9)
    panels[0, 1].axis("off")
    for j, name in enumerate(COORDINATES):
        axes = panels[1 + j % 3, j // 3]
        factor, unit = (1.0, "m") if j < 3 else (180.0 / math.pi, "deg")
        axes.plot(
            statistics.omega, factor**2 * statistics.density[:, 6 * body + j], color=_COLOURS[j], lw=1.2
        )
        axes.set_ylabel(f"{name}\n[{unit}² s/rad]", color=_INK, fontsize=9)
        significant = factor * statistics.significant[6 * body + j]
        axes.text(0.97, 0.86, f"significant amplitude {significant:.3g} {unit}", transform=axes.transAxes,
                  ha="right", va="top", fontsize=8, color=_INK)  # fmt: skip
    for axes in panels.ravel():
        if axes.axison:
            _tidy(axes)
            axes.set_ylim(bottom=0.0)
    for axes in panels[-1]:
        axes.set_xlabel("frequency [rad/s]", color=_INK)
    total = np.cumsum(np.append(0.0, 0.5 * (wave[1:] + wave[:-1]) * np.diff(statistics.omega)))
    last = int(np.searchsorted(total, 0.999 * total[-1]))
    panels[0, 0].set_xlim(float(statistics.omega[0]), float(statistics.omega[min(last, len(wave) - 1)]))
    figure.suptitle(title, color=_INK, fontsize=12)
    return few_colours(figure_png(figure))


def _without_jumps(degrees: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angles with a gap where they pass from 180 to -180 degrees."""
    jump = np.append(False, np.abs(np.diff(degrees)) > 180.0)
    return np.where(jump, np.nan, degrees)


def _figure(height: float) -> Any:
    from matplotlib.figure import Figure

    return Figure(figsize=(10.0, height), dpi=_DPI, layout="constrained")


def _tidy(axes: Any) -> None:
    axes.grid(visible=True, color="#e3e7eb", lw=0.6)
    axes.tick_params(colors=_INK, labelsize=8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _legend(figure: Any, axes: Any, title: str) -> None:
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(
        handles,
        labels,
        title=title,
        loc="outside lower center",
        ncols=min(len(labels), 8),
        fontsize=8,
        frameon=False,
    )
