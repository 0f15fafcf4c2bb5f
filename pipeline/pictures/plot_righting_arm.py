"""Plot of a righting-arm curve: arm over heel with its particular angles, and the area below it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.pictures.png import few_colours, figure_png

if TYPE_CHECKING:
    from heavylift.solver.water.hulls.hydrostatics import FloatingPosition, RightingArmCurve

__all__ = ["righting_arm_plot"]

_INK = "#1d2733"
_GREY = "#66707c"
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


def _tidy(axes: Any) -> None:
    axes.grid(visible=True, color="#e3e7eb", lw=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(colors=_INK, labelsize=9.5, length=3)
    for side, spine in axes.spines.items():
        spine.set_visible(side in {"left", "bottom"})
        spine.set_color("#9aa4ae")
