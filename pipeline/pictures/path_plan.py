"""Plan of the path of a transporter: its outline and its wheels, as they were steered, at some times."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.pipeline.pictures.plots import (
    COLOURS,
    GREY,
    INK,
    add_title,
    few_colours,
    figure_png,
    plot_figure,
    tidy_axes,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["Stand", "path_plan"]

_WHEEL = 0.4  # half the length of a wheel as drawn, by the smallest distance of two of them


class Stand(NamedTuple):
    """A vehicle at a time [s]: places of its wheels in the plan [m], shape (n, 2), and where they point [rad]."""

    time: float
    wheels: NDArray[np.float64]
    directions: NDArray[np.float64]


def path_plan(way: NDArray[np.float64], stands: Sequence[Stand], *, title: str) -> bytes:
    """Plan with the way of the middle [m], shape (nt, 2), and the vehicle at some times."""
    figure = plot_figure(7.0)
    axes = figure.subplots()
    axes.plot(*way.T, color=GREY, lw=1.2, ls="--")
    for number, (time, wheels, directions) in enumerate(stands):
        colour = COLOURS[number % len(COLOURS)]
        apart = np.hypot(*(wheels[:, None] - wheels[None]).transpose(2, 0, 1))
        half = _WHEEL * float(apart[apart > 1e-9].min(initial=10.0))
        along = half * np.column_stack([np.cos(directions), np.sin(directions)])
        for wheel, arm in zip(wheels, along, strict=True):
            axes.plot(*np.transpose([wheel - arm, wheel + arm]), color=colour, lw=2.2)
        middle = wheels.mean(axis=0)
        note = {"color": INK, "fontsize": 8, "ha": "center", "va": "center"}
        box = {"boxstyle": "round,pad=0.15", "fc": "white", "ec": colour, "lw": 0.7}
        axes.text(*middle, f"{time:.4g} s", bbox=box, **note)
    axes.set_aspect("equal", adjustable="datalim")
    tidy_axes(axes)
    axes.set_xlabel("x [m]", color=INK)
    axes.set_ylabel("y [m]", color=INK)
    add_title(figure, title)
    return few_colours(figure_png(figure))
