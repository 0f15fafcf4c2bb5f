"""Sections of beams from the dimensions of shapes that other programs know by name.

Every shape is a sum of rectangles between the coordinates y, along axis 2, and z, along axis 3, of the beam, or round;
`heavylift.preprocess.structures.sections` has what follows from these.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.structures.sections import (
    BeamSection,
    Rectangle,
    centroid,
    rectangles_section,
    round_section,
)

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["BAR_SHAPES", "ROUND_SHAPES", "BarShape", "shape_section"]


class BarShape(NamedTuple):
    """A shape of Nastran's library (PBARL, PBEAML): how many dimensions, and its rectangles.

    `closed` gives the enclosed area and the lengths and thicknesses of the walls, for torsion.
    """

    dimensions: int
    rectangles: Callable[..., list[Rectangle]]
    closed: Callable[..., tuple[float, list[tuple[float, float]]]] | None = None


def _tee(width: float, height: float, flange: float, web: float) -> list[Rectangle]:
    low = height - flange
    return [(low, height, -width / 2, width / 2), (0.0, low, -web / 2, web / 2)]


def _i(height: float, low: float, high: float, web: float, t_low: float, t_high: float) -> list[Rectangle]:
    return [
        (0.0, t_low, -low / 2, low / 2),
        (t_low, height - t_high, -web / 2, web / 2),
        (height - t_high, height, -high / 2, high / 2),
    ]


def _channel(width: float, height: float, web: float, flange: float) -> list[Rectangle]:
    return [
        (0.0, flange, 0.0, width),
        (flange, height - flange, 0.0, web),
        (height - flange, height, 0.0, width),
    ]


def _box(
    width: float, height: float, top: float, bottom: float, left: float, right: float
) -> list[Rectangle]:
    if not (left + right < width and top + bottom < height):
        raise InputError(
            "dimensions that leave no wall apart", source="section", expected="walls thinner than the shape"
        )
    return [
        (0.0, bottom, 0.0, width),
        (height - top, height, 0.0, width),
        (bottom, height - top, 0.0, left),
        (bottom, height - top, width - right, width),
    ]


def _box_walls(
    width: float, height: float, top: float, bottom: float, left: float, right: float
) -> tuple[float, list[tuple[float, float]]]:
    b, h = width - (left + right) / 2, height - (top + bottom) / 2
    return b * h, [(b, top), (b, bottom), (h, left), (h, right)]


def _hat(height: float, t: float, top: float, brim: float) -> list[Rectangle]:
    half = top / 2
    return [
        (height - t, height, -half, half),
        (t, height - t, -half, -half + t),
        (t, height - t, half - t, half),
        (0.0, t, -half - brim, -half + t),
        (0.0, t, half - t, half + brim),
    ]


def _i_centre(
    height: float, low: float, high: float, _web: float, t_low: float, t_high: float
) -> tuple[float, float]:
    inertia_low, inertia_high = t_low * low**3, t_high * high**3
    h = height - (t_low + t_high) / 2
    return t_low / 2 + h * inertia_high / (inertia_low + inertia_high), 0.0


def _channel_centre(width: float, height: float, web: float, flange: float) -> tuple[float, float]:
    b, h = width - web / 2, height - flange
    return height / 2, web / 2 - 3.0 * b**2 * flange / (h * web + 6.0 * b * flange)


_SHEAR_CENTRES: dict[str, Callable[..., tuple[float, float]]] = {
    "T": lambda _b, h, tf, _tw: (h - tf / 2, 0.0),
    "T1": lambda _b, _a, tf, _tw: (0.0, tf / 2),
    "T2": lambda _b, _h, tf, _tw: (tf / 2, 0.0),
    "L": lambda _b, _h, t1, t2: (t1 / 2, t2 / 2),
    "I": _i_centre,
    "CHAN": _channel_centre,
    "CHAN1": lambda a, t, h, H: _channel_centre(a + t, H, t, (H - h) / 2),
    "CHAN2": lambda t, tb, h, b: (_channel_centre(h, b, tb, t)[1], 0.0),
}
"""Shear centres of thin walls (Timoshenko); of shapes that are not named the centroid."""


BAR_SHAPES: dict[str, BarShape] = {
    # DIM1 along z, DIM2 along y
    "BAR": BarShape(2, lambda b, h: [(-h / 2, h / 2, -b / 2, b / 2)]),
    # width, height, thickness of bottom and top, of the sides
    "BOX": BarShape(
        4,
        lambda b, h, t1, t2: _box(b, h, t1, t1, t2, t2),
        lambda b, h, t1, t2: _box_walls(b, h, t1, t1, t2, t2),
    ),
    # width, height, thickness of top, bottom, left, right
    "BOX1": BarShape(6, _box, _box_walls),
    # height, width of bottom and top flange, thickness of web, bottom and top flange
    "I": BarShape(6, _i),
    # overhang of both flanges together, thickness of web, height between flanges, height
    "I1": BarShape(4, lambda a, t, h, H: _i(H, a + t, a + t, t, (H - h) / 2, (H - h) / 2)),
    # width of flange, height, thickness of flange, of web; flange on top
    "T": BarShape(4, _tee),
    # height of flange, length of web, thickness of flange, of web; the web lies along -z
    "T1": BarShape(4, lambda b, a, tf, tw: [(-b / 2, b / 2, 0.0, tf), (-tw / 2, tw / 2, -a, 0.0)]),
    # width of flange, height, thickness of flange, of web; flange at the bottom
    "T2": BarShape(4, lambda b, h, tf, tw: [(0.0, tf, -b / 2, b / 2), (tf, h, -tw / 2, tw / 2)]),
    # width, height, thickness of the horizontal leg, of the upright one
    "L": BarShape(4, lambda b, h, t1, t2: [(0.0, t1, 0.0, b), (t1, h, 0.0, t2)]),
    # width, height, thickness of web, of flanges
    "CHAN": BarShape(4, _channel),
    # length of flanges beyond the web, thickness of web, height between flanges, height
    "CHAN1": BarShape(4, lambda a, t, h, H: _channel(a + t, H, t, (H - h) / 2)),
    # thickness of the two legs, of the bottom, height, width
    "CHAN2": BarShape(
        4,
        lambda t, tb, h, b: [
            (0.0, tb, -b / 2, b / 2),
            (tb, h, -b / 2, -b / 2 + t),
            (tb, h, b / 2 - t, b / 2),
        ],
    ),
    # length of a flange beyond the web, thickness of web, height between flanges, height
    "Z": BarShape(
        4,
        lambda a, t, h, H: [
            (0.0, (H - h) / 2, -t / 2 - a, t / 2),
            ((H - h) / 2, (H + h) / 2, -t / 2, t / 2),
            ((H + h) / 2, H, -t / 2, t / 2 + a),
        ],
    ),
    # length of both arms together, thickness of the upright, height, thickness of the arms
    "CROSS": BarShape(
        4,
        lambda a, t, h, ta: [
            (-h / 2, h / 2, -t / 2, t / 2),
            (-ta / 2, ta / 2, t / 2, (t + a) / 2),
            (-ta / 2, ta / 2, -(t + a) / 2, -t / 2),
        ],
    ),
    # length of the crossbar, thickness of both uprights together, height, thickness of the crossbar
    "H": BarShape(
        4,
        lambda a, t, h, ta: [
            (-ta / 2, ta / 2, -a / 2, a / 2),
            (-h / 2, h / 2, a / 2, (a + t) / 2),
            (-h / 2, h / 2, -(a + t) / 2, -a / 2),
        ],
    ),
    # height, thickness, width of the top, length of a brim
    "HAT": BarShape(4, _hat),
}
"""Shapes of rectangles by Nastran's names; dimensions in Nastran's order."""

ROUND_SHAPES = {"ROD": 1, "TUBE": 2, "TUBE2": 2}
"""Round shapes and their number of dimensions: radius; outer and inner radius; outer radius and thickness."""


def shape_section(
    shape: str,
    dimensions: tuple[float, ...],
    nonstructural_mass: float = 0.0,
    name: str = "",
    *,
    shear_centre: bool = True,
) -> BeamSection:
    """Section of a shape of Nastran's library.

    Parameters
    ----------
    shape
        Key of `BAR_SHAPES` or `ROUND_SHAPES`.
    dimensions
        As many as it has, in any unit of length.
    nonstructural_mass
        Per length.
    name
        Of the section.
    shear_centre
        Whether torsion and shear act about the shear centre (PBEAML), or about the centroid (PBARL).

    Raises
    ------
    InputError
        Dimensions that make no section: walls thicker than the shape.
    """
    if shape in ROUND_SHAPES:
        outer = dimensions[0]
        inner = {"ROD": 0.0, "TUBE": dimensions[-1], "TUBE2": outer - dimensions[-1]}[shape]
        return round_section(outer, inner, nonstructural_mass=nonstructural_mass, name=name)
    made = BAR_SHAPES[shape]
    rectangles = made.rectangles(*dimensions)
    closed = made.closed(*dimensions) if made.closed else None
    section = rectangles_section(rectangles, closed, nonstructural_mass=nonstructural_mass, name=name)
    if shear_centre and shape in _SHEAR_CENTRES:
        (y, z), (yc, zc) = _SHEAR_CENTRES[shape](*dimensions), centroid(rectangles)
        return replace(section, shear_centre=(y - yc, z - zc))
    return section
