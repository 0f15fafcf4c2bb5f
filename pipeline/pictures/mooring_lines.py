"""Pictures of mooring lines: side views with seabed and tension, and polylines for scenes in space."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.pictures.plots import few_colours, figure_png
from heavylift.pipeline.results.signals import scaled_unit
from heavylift.solver.water.lines.catenary import SLACK

if TYPE_CHECKING:
    from collections.abc import Sequence

    from heavylift.pipeline.drawn.hanging import HangingLine

__all__ = ["profile_picture"]

_DPI = 110
_WIDTH = 10.0
_PANEL, _FRAME, _TALLEST = 2.3, 0.9, 14.0
"""Heights [inch] of a line, of title and labels, and of all at most."""
_INK, _GREY, _SAND, _WATER = "#1d2733", "#66707c", "#d9c9a3", "#7fb2d9"
_COLOUR_MAP = "viridis"


def profile_picture(
    lines: Sequence[HangingLine], *, level: float | None = None, title: str = "Mooring lines"
) -> bytes:
    """Side views of lines, one a panel, each with its own colours of tension, as the content of a PNG file.

    Parameters
    ----------
    lines
        From `hanging_line`, one or more.
    level
        Height of the water [m]; None for none.
    title
        Heading.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    height = min(_FRAME + _PANEL * len(lines), _TALLEST)
    figure = Figure(figsize=(_WIDTH, height), dpi=_DPI, layout="constrained")
    panels = figure.subplots(len(lines), 1, squeeze=False)[:, 0]
    for axes, drawn in zip(panels, lines, strict=True):
        x, z, tension = drawn.profile.x, drawn.points[:, 2], drawn.profile.tension
        unit = scaled_unit("N", [tension])
        scale = Normalize(float(tension.min()) / unit.divisor, float(tension.max()) / unit.divisor)
        way = np.column_stack([x, z])
        parts = LineCollection(
            list(np.stack([way[:-1], way[1:]], axis=1)),
            cmap=_COLOUR_MAP,
            norm=scale,
            lw=2.4,
            capstyle="round",
            zorder=3,
        )
        parts.set_array(0.5 * (tension[1:] + tension[:-1]) / unit.divisor)
        axes.add_collection(parts)
        _surroundings(axes, drawn, level)
        axes.plot(x[[0, -1]], z[[0, -1]], "o", color=_INK, ms=5, zorder=4)
        axes.plot(x[drawn.joints], z[drawn.joints], "o", mfc="white", mec=_INK, ms=5, zorder=4)
        bar = figure.colorbar(parts, ax=axes, pad=0.01, aspect=12)
        bar.set_label(f"tension [{unit.text}]", color=_INK)
        bar.ax.tick_params(colors=_GREY, labelsize=9)
        axes.set_title(_words(drawn, unit), loc="left", fontsize=9, color=_INK)
        axes.set_ylabel("z [m]", color=_INK)
        axes.tick_params(colors=_GREY, labelsize=9)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    panels[-1].set_xlabel("distance from the anchor [m]", color=_INK)
    figure.suptitle(title.replace("$", r"\$"), x=0.01, ha="left", fontsize=11, color=_INK)
    return few_colours(figure_png(figure))


def _words(drawn: HangingLine, unit: Any) -> str:
    """Name and numbers of a line."""
    found = drawn.catenary
    text = (
        f"{drawn.line.name}: fairlead {found.tension / unit.divisor:.4g} {unit.text},"
        f" horizontal {found.horizontal / unit.divisor:.4g} {unit.text},"
        f" anchor {found.anchor_tension / unit.divisor:.4g} {unit.text}, length {drawn.profile.s[-1]:.2f} m"
    )
    if drawn.line.seabed is not None:
        text += f", {found.on_seabed:.2f} m of it on the seabed"
    return text.replace("$", r"\$") + (" (slack)" if found.branch == SLACK else "")


def _surroundings(axes: Any, drawn: HangingLine, level: float | None) -> None:
    """Seabed and water, and the limits of the panel."""
    x, z = drawn.profile.x, drawn.points[:, 2]
    margin = 0.03 * max(float(np.ptp(x)), float(np.ptp(z)), 1e-3)
    left, right = float(x.min()) - margin, float(x.max()) + margin
    above = max(float(z.max()), level if level is not None else -np.inf)
    rise = max(above - float(z.min()), 1e-3)
    bottom, top = float(z.min()) - 0.15 * rise, above + 0.12 * rise
    if drawn.bottom is not None:
        feet = drawn.points[:, 2] - [drawn.bottom.below(place) for place in drawn.points]
        rise = (feet[-1] - feet[0]) / (x[-1] - x[0]) if x[-1] != x[0] else 0.0
        ends = np.array([left, right])
        floor = feet[0] + rise * (ends - x[0])
        bottom = min(bottom, float(floor.min()) - 0.05 * (top - bottom))
        axes.fill_between(ends, bottom, floor, color=_SAND, lw=0, zorder=0)
        axes.plot(ends, floor, color=_GREY, lw=0.8, zorder=1)
    if level is not None:
        axes.axhline(level, color=_WATER, lw=1.2, zorder=1)
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
