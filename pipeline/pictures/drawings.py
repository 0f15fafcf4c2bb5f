"""What a picture of a body shows, as plain data: points in place, colours, outlines."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.pipeline.pictures.render import Drawing, Lines, Points, rgb

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from heavylift.pipeline.drawn.outer_surface import Surface

__all__ = [
    "BANDED",
    "DIVERGING",
    "INK",
    "bounding_box",
    "colours",
    "mark_colours",
    "mesh_drawing",
    "mode_drawing",
    "stress_bands",
    "stress_drawing",
    "stress_limit",
    "stress_unit",
]

INK = "#1d2733"
_BODY = "#b9c6d3"
_MARKS = ("#c62828", "#1565c0", "#2e7d32", "#ef6c00", "#6a1b9a", "#00838f")
# the dark ends of the maps are left out: lines must stay readable on them
_SMOOTH = ("viridis", 0.1, 1.0)
BANDED = ("turbo", 0.09, 0.95)
"""Colour map of amounts, see `colours`."""
DIVERGING = ("coolwarm", 0.0, 1.0)
"""Colour map of values with a sign."""


def stress_limit(stress: NDArray[np.float64]) -> float:
    """Upper end of the colour scale: the maximum, or less when a few nodes alone stand far above the rest.

    Re-entrant corners and clamped edges have an infinite stress in linear elasticity; coloured up to there
    the part would be one colour. The picture states the maximum in any case.
    """
    known = stress[np.isfinite(stress)]
    largest = float(known.max(initial=0.0))
    if largest <= 0.0:
        return 1.0
    bulk = float(np.quantile(known, 0.995))
    return largest if largest <= 1.6 * bulk or bulk <= 0.0 else bulk


def stress_bands(limit: float, *, most: int = 12) -> tuple[float, int]:
    """Round upper end of a colour scale from zero, and its number of bands of round height, half of `most` or more."""
    power = 10.0 ** np.floor(np.log10(2.0 * limit / most))
    step = min(s * power for s in (1.0, 2.0, 2.5, 5.0, 10.0) if limit <= most * s * power * (1.0 + 1.0e-9))
    count = int(np.ceil(limit / step * (1.0 - 1.0e-9)))
    return float(count * step), count


def mesh_drawing(surface: Surface, marks: Mapping[str, NDArray[np.int64]], *, scale: float = 1.0) -> Drawing:
    """Surface with the element edges; the faces and nodes of each marked group in a colour of its own.

    Parameters
    ----------
    surface
        Of the undeformed body.
    marks
        Group name to node indices of the model.
    scale
        Factor from metres to the unit of the picture.
    """
    points = surface.nodes * scale
    colours = np.tile(rgb(_BODY).astype(float), (len(surface.triangles), 1))
    balls = []
    for colour, group in zip(mark_colours(len(marks)), marks.values(), strict=True):
        members = surface.members(group)
        within = surface.triangles_within(members)
        colours[within] = 0.45 * rgb(colour) + 0.55 * np.array([255, 255, 255])
        balls.append(Points(points[members], colour=colour, size=5.0 if within.any() else 10.0))
    return Drawing(
        points,
        surface.triangles,
        triangle_colours=colours.astype(np.uint8),
        lines=(
            Lines(points, surface.element_edges, colour="#4a5663", width=1.0, opacity=0.7),
            Lines(points, surface.feature_edges, colour=INK, width=2.0),
        ),
        marks=tuple(balls),
    )


def mode_drawing(
    surface: Surface, shape: NDArray[np.float64], *, scale: float = 1.0, share: float = 0.1
) -> Drawing:
    """Deformed surface coloured by the displacement relative to its largest, with the undeformed outline.

    Parameters
    ----------
    surface
        Of the undeformed body.
    shape
        Displacement of all nodes of the model in any unit, shape (n, 3).
    scale
        Factor from metres to the unit of the picture.
    share
        Largest drawn displacement as a share of the diagonal of the part.
    """
    largest = max(float(np.linalg.norm(shape, axis=1).max()), np.finfo(float).tiny)
    relative = surface.pick(shape) / largest
    deformed = (surface.nodes + share * surface.diagonal * relative) * scale
    return Drawing(
        deformed,
        surface.triangles,
        values=np.linalg.norm(relative, axis=1),
        limits=(0.0, 1.0),
        colours=colours(_SMOOTH, 256),
        lines=_outlines(surface, deformed, scale),
    )


def stress_drawing(
    surface: Surface,
    displacement: NDArray[np.float64],
    stress: NDArray[np.float64],
    *,
    factor: float,
    scale: float = 1.0,
    divisor: float = 1.0e6,
) -> Drawing:
    """Deformed surface coloured by a stress.

    Parameters
    ----------
    surface
        Of the undeformed body.
    displacement
        Of all nodes of the model [m], shape (n, 3).
    stress
        Equivalent stress at all nodes of the model [Pa], shape (n,); not a number where it is not known.
    factor
        Displacements are drawn this many times as large as they are.
    scale
        Factor from metres to the unit of the picture.
    divisor
        Pascals in the unit of the colour scale.
    """
    deformed = (surface.nodes + factor * surface.pick(displacement)) * scale
    values = surface.pick(stress) / divisor
    limit, bands = stress_bands(stress_limit(values))
    return Drawing(
        deformed,
        surface.triangles,
        values=values,
        limits=(0.0, limit),
        colours=colours(BANDED, bands),
        lines=_outlines(surface, deformed, scale),
    )


def stress_unit(largest: float) -> tuple[float, str]:
    """Pascals in the unit that suits a stress, and its name: MPa, or kPa and Pa for tiny ones."""
    for divisor, name in ((1.0e6, "MPa"), (1.0e3, "kPa")):
        if largest >= 0.1 * divisor:
            return divisor, name
    return (1.0, "Pa") if largest > 0.0 else (1.0e6, "MPa")


def bounding_box(low: NDArray[np.float64], high: NDArray[np.float64]) -> Lines:
    """Bounding box; its first point is the low corner, its last the high one."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    ends = np.array([(i, i + bit) for bit in (4, 2, 1) for i in range(8) if not i & bit])
    return Lines(low + corners * (high - low), ends, colour="#b4bcc5", width=0.9, opacity=0.8)


def mark_colours(count: int) -> list[str]:
    """Colours of marked groups, in their order."""
    return [_MARKS[number % len(_MARKS)] for number in range(count)]


def _outlines(surface: Surface, deformed: NDArray[np.float64], scale: float) -> tuple[Lines, Lines]:
    """Outline of the body at rest, and of the deformed body."""
    return (
        Lines(surface.nodes * scale, surface.feature_edges, colour="#8a949f", width=1.2, opacity=0.8),
        Lines(deformed, surface.feature_edges, colour=INK, width=1.3, opacity=0.8),
    )


def colours(colour_map: tuple[str, float, float], count: int) -> tuple[str, ...]:
    """Colours from a part of a matplotlib map: name, and the two ends of the part from 0 to 1."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    name, start, end = colour_map
    return tuple(to_hex(colour) for colour in colormaps[name](np.linspace(start, end, count)))
