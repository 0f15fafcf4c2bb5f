"""Plots of a hydrodynamic database as PNG: added mass, damping, excitation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.pictures.png import few_colours, figure_png
from heavylift.preprocess.hydrodynamics.database import COORDINATES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase

__all__ = ["added_mass_plot", "damping_plot", "database_plots", "excitation_plot"]

_DPI = 110
_SIZE = (10.0, 5.6)
_INK = "#1d2733"
_GREY = "#66707c"
_COLOURS = ("#1f5fa8", "#d1661a", "#2e8b57", "#8e3b9c", "#b8322a")
_SHOWN_HEADINGS = np.deg2rad([0.0, 45.0, 90.0, 135.0, 180.0])
_MASS_UNITS = ("kg", "kg m²")
_DAMPING_UNITS = ("kg/s", "kg m²/s")
_FORCE_UNITS = ("N/m", "N")


def database_plots(database: HydrodynamicDatabase) -> dict[str, bytes]:
    """All plots by name: ``<hull>_added_mass``, ``<hull>_damping``, ``<hull>_excitation``."""
    plots = {}
    for body in database.bodies:
        plots[f"{body}_added_mass"] = added_mass_plot(database, body)
        plots[f"{body}_damping"] = damping_plot(database, body)
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
