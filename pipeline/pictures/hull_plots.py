"""Plots of what floats, as PNG: hydrodynamic databases, response operators, righting arms."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.pictures.plots import few_colours, figure_png
from heavylift.preprocess.hydrodynamics.database import COORDINATES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
    from heavylift.solver.water.hulls.frequency_domain import MotionOperators, NaturalMode
    from heavylift.solver.water.hulls.hydrostatics import FloatingPosition, RightingArmCurve

__all__ = [
    "added_mass_plot",
    "damping_plot",
    "database_plots",
    "excitation_plot",
    "operator_plot",
    "righting_arm_plot",
]

_DPI = 110
_SIZE = (10.0, 5.6)
_INK = "#1d2733"
_GREY = "#66707c"
_COLOURS = ("#1f5fa8", "#d1661a", "#2e8b57", "#8e3b9c", "#b8322a", "#4d6470", "#a98600", "#1a9aa8")
_SHOWN_HEADINGS = np.deg2rad([0.0, 45.0, 90.0, 135.0, 180.0])
_MASS_UNITS = ("kg", "kg m²")
_DAMPING_UNITS = ("kg/s", "kg m²/s")
_FORCE_UNITS = ("N/m", "N")


def database_plots(database: HydrodynamicDatabase) -> dict[str, bytes]:
    """All plots by name: ``<hull>_added_mass``, ``<hull>_damping``, and ``<hull>_excitation`` if there is one."""
    plots = {}
    for body in database.bodies:
        plots[f"{body}_added_mass"] = added_mass_plot(database, body)
        plots[f"{body}_damping"] = damping_plot(database, body)
        if database.has_excitation:
            plots[f"{body}_excitation"] = excitation_plot(database, body)
    return plots


def added_mass_plot(database: HydrodynamicDatabase, body: str) -> bytes:
    """Six diagonal entries over frequency, with their limits for infinite frequency.

    Entries with the same coordinate of other hulls are dashed.
    """
    return _matrix_plot(
        database, body, database.added_mass, database.added_mass_infinite, ("added mass", "A"), _MASS_UNITS
    )


def damping_plot(database: HydrodynamicDatabase, body: str) -> bytes:
    """Six diagonal entries over frequency; entries with the same coordinate of other hulls are dashed."""
    return _matrix_plot(database, body, database.damping, None, ("radiation damping", "B"), _DAMPING_UNITS)


def excitation_plot(
    database: HydrodynamicDatabase,
    body: str,
    headings: Sequence[float] | NDArray[np.float64] = _SHOWN_HEADINGS,
) -> bytes:
    """Modulus of the excitation over frequency, at the headings of the database nearest to some [rad]."""
    first = 6 * database.body_index(body)
    places = sorted({int(np.argmin(np.abs(database.headings - heading))) for heading in headings})
    round_off = _round_off(database, first)
    figure, panels = _six_panels(f"{body}: excitation per metre of amplitude")
    for i, axes in enumerate(panels):
        modulus = np.abs(database.excitation[:, :, first + i])
        if modulus.max() < round_off[i]:
            modulus = np.zeros_like(modulus)
        scale, prefix = _scale(modulus)
        for number, place in enumerate(places):
            axes.plot(
                database.omega,
                modulus[:, place] / scale,
                color=_COLOURS[number % len(_COLOURS)],
                lw=2.4 - 0.35 * number,  # curves that are the same by symmetry stay visible
                label=f"{np.rad2deg(database.headings[place]):.0f}°",
            )
        _finish(axes, i, f"X{i + 1} [{prefix}{_FORCE_UNITS[i // 3]}]", database.omega[-1])
    panels[0].figure.legend(
        *panels[0].get_legend_handles_labels(),
        loc="outside lower center",
        ncols=len(places),
        frameon=False,
        fontsize=9.5,
        title="waves travel towards",
        title_fontsize=9.5,
    )
    return few_colours(figure_png(figure))


def _matrix_plot(
    database: HydrodynamicDatabase,
    body: str,
    values: NDArray[np.float64],
    limit: NDArray[np.float64] | None,
    words: tuple[str, str],
    units: tuple[str, str],
) -> bytes:
    """Diagonal of the block of one hull, and that of its blocks with the others."""
    own = database.body_index(body)
    figure, panels = _six_panels(f"{body}: {words[0]}")
    for i, axes in enumerate(panels):
        curves = [values[:, 6 * own + i, 6 * other + i] for other in range(database.body_count)]
        scale, prefix = _scale(np.array([np.abs(curve).max() for curve in curves]))
        for other, curve in enumerate(curves):
            with_other = "" if other == own else f" with {database.bodies[other]}"
            axes.plot(
                database.omega,
                curve / scale,
                color=_COLOURS[0 if other == own else 1 + other % (len(_COLOURS) - 1)],
                ls="-" if other == own else "--",
                lw=1.4 if other == own else 1.0,
                label=f"{body}{with_other}",
            )
        if limit is not None:
            end = limit[6 * own + i, 6 * own + i] / scale
            axes.axhline(end, color=_GREY, lw=1.0, ls=":", label="infinite frequency")
        _finish(axes, i, f"{words[1]}{i + 1}{i + 1} [{prefix}{units[i // 3]}]", database.omega[-1])
    handles, labels = panels[0].get_legend_handles_labels()
    if len(labels) > 1:
        figure.legend(
            handles, labels, loc="outside lower center", ncols=len(labels), frameon=False, fontsize=9.5
        )
    return few_colours(figure_png(figure))


def _round_off(database: HydrodynamicDatabase, first: int) -> NDArray[np.float64]:
    """(6,) below which a force is zero by symmetry and only round-off is left."""
    forces = np.abs(database.excitation[:, :, first : first + 6]).max(axis=(0, 1))
    return 1e-6 * np.repeat([forces[:3].max(), forces[3:].max()], 3)


def _six_panels(title: str) -> tuple[Any, list[Any]]:
    """A figure of two rows: translations and rotations."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=_SIZE, dpi=_DPI, facecolor="white", layout="constrained")
    figure.suptitle(title, color=_INK, fontsize=12, x=0.01, ha="left")
    return figure, list(figure.subplots(2, 3, sharex=True).ravel())


def _finish(axes: Any, coordinate: int, label: str, top: float) -> None:
    """Names, units and grid of one panel."""
    axes.set_title(COORDINATES[coordinate], color=_INK, fontsize=10.5, loc="left")
    axes.set_ylabel(label, color=_INK, fontsize=9.5)
    if coordinate >= 3:
        axes.set_xlabel("frequency [rad/s]", color=_INK, fontsize=9.5)
    axes.set_xlim(0.0, top)
    axes.axhline(0.0, color="#9aa4ae", lw=0.8)
    axes.grid(visible=True, color="#e3e7eb", lw=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(colors=_INK, labelsize=9, length=3)
    axes.ticklabel_format(axis="y", useOffset=False, style="plain")
    for side, spine in axes.spines.items():
        spine.set_visible(side in {"left", "bottom"})
        spine.set_color("#9aa4ae")


def _scale(values: NDArray[np.float64]) -> tuple[float, str]:
    """A power of a thousand that keeps numbers below 1000, and how it is written before the unit."""
    largest = float(np.max(np.abs(values), initial=0.0))
    power = int(np.floor(np.log10(largest) / 3.0)) if largest > 0.0 else 0
    power = max(0, power)
    return 1000.0**power, "" if power == 0 else f"$10^{{{3 * power}}}$ "


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
        _tidy(amplitude, size=8.0)
        _tidy(phase, size=8.0)
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


def _without_jumps(degrees: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angles with a gap where they pass from 180 to -180 degrees."""
    jump = np.append(False, np.abs(np.diff(degrees)) > 180.0)
    return np.where(jump, np.nan, degrees)


def _figure(height: float) -> Any:
    from matplotlib.figure import Figure

    return Figure(figsize=(10.0, height), dpi=_DPI, layout="constrained")


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


_BLUE, _ORANGE, _GREEN, _RED = "#1f5fa8", "#d1661a", "#2e8b57", "#b8322a"


def righting_arm_plot(title: str, curve: RightingArmCurve, position: FloatingPosition | None = None) -> bytes:
    """PNG of righting arm and work over heel.

    Parameters
    ----------
    title
        Heading.
    curve
        Arms [m] over angles [rad].
    position
        In equilibrium; its metacentric height is drawn as the tangent of the curve there.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 6.2), dpi=110, facecolor="white", layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2.6, 1.0))
    degrees = np.degrees(curve.angles)
    upper.axhline(0.0, color=_GREY, lw=0.8)
    # the largest one may lie where the hull floods, behind the last of the angles
    x, y = np.append(curve.angles, curve.largest_angle), np.append(curve.arms, curve.largest_arm)
    order = np.argsort(x)[np.isfinite(y[np.argsort(x)])]
    x, y = x[order], y[order]
    upper.plot(np.degrees(x), y, color=_BLUE, lw=1.8, label="righting arm GZ")
    if math.isfinite(curve.range):
        shaded = np.linspace(curve.equilibrium, min(curve.equilibrium + curve.range, x[-1]), 400)
        upper.fill_between(np.degrees(shaded), 0.0, np.interp(shaded, x, y), color=_BLUE, alpha=0.10, lw=0)
    low, high = float(np.nanmin(curve.arms)), float(np.nanmax(curve.arms))
    reach = max(high - low, 1e-12)
    limits = (min(low, 0.0) - 0.12 * reach, max(high, 0.0) + 0.16 * reach)
    if position is not None and math.isfinite(curve.equilibrium):
        start = math.degrees(curve.equilibrium)
        upper.plot(
            [start, start + math.degrees(1.0)],
            [0.0, position.GM_T],
            color=_GREY,
            lw=1.1,
            ls="--",
            label=f"GM = {position.GM_T:.4g} m in equilibrium",
        )
    floods = math.degrees(curve.flooding)
    end = min(degrees[-1], 1.6 * floods) if floods > degrees[0] else degrees[-1]
    _mark(upper, curve.equilibrium, 0.0, "equilibrium", _GREEN, offset=(6, -15))
    largest = f"largest {curve.largest_arm:.4g} m"
    late = math.degrees(curve.largest_angle) > degrees[0] + 0.8 * (end - degrees[0])
    _mark(upper, curve.largest_angle, curve.largest_arm, largest, _ORANGE, offset=(-8 if late else 2, 9))
    _mark(upper, curve.vanishing, 0.0, "vanishes", _RED, offset=(7, 7))
    if math.isfinite(curve.flooding):
        for axes in (upper, lower):
            axes.axvspan(floods, end, color="#dfe5ea", lw=0, zorder=0)
        upper.annotate(
            f"opening floods\nat {floods:.1f}°",
            (floods, 0.5),
            xycoords=("data", "axes fraction"),
            xytext=(5, 0),
            textcoords="offset points",
            fontsize=9,
            color=_INK,
            va="center",
        )
    upper.set_ylim(*limits)
    upper.set_ylabel("righting arm GZ [m]", color=_INK)
    upper.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, frameon=False, fontsize=9.5, labelcolor=_INK
    )
    lower.plot(degrees, curve.work, color=_ORANGE, lw=1.5)
    lower.axhline(0.0, color=_GREY, lw=0.8)
    lower.set_ylabel("area [m rad]", color=_INK)
    side = "" if curve.side > 0 else " (to the side of negative list)"
    lower.set_xlabel(f"heel [°]{side}", color=_INK)
    lower.set_xlim(degrees[0], end)
    for axes in (upper, lower):
        _tidy(axes)
    figure.align_ylabels([upper, lower])
    figure.suptitle(title.replace("$", r"\$"), x=0.012, ha="left", fontsize=13, weight="bold", color=_INK)
    return few_colours(figure_png(figure))


def _mark(axes: Any, angle: float, arm: float, words: str, colour: str, *, offset: tuple[int, int]) -> None:
    """Write what is at an angle [rad], if there is one."""
    if not math.isfinite(angle):
        return
    x = math.degrees(angle)
    axes.plot([x], [arm], "o", ms=6, color=colour, zorder=4)
    axes.annotate(
        f"{words}, {x:.1f}°",
        (x, arm),
        xytext=offset,
        textcoords="offset points",
        ha="right" if offset[0] < 0 else "left",
        fontsize=9,
        color=colour,
        zorder=5,
    )


def _tidy(axes: Any, *, size: float = 9.5) -> None:
    axes.grid(visible=True, color="#e3e7eb", lw=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(colors=_INK, labelsize=size, length=3)
    for side, spine in axes.spines.items():
        spine.set_visible(side in {"left", "bottom"})
        spine.set_color("#9aa4ae")
