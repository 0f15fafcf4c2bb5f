"""Panels of the wetted hull for a boundary element method, and the hydrostatics that follow from them.

A panel has four corners, wound so that its normal points into the water; a triangle repeats its last
corner. The hull is open at the still water, z = 0, where the method puts a lid.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

__all__ = [
    "HullPanels",
    "PanelHydrostatics",
    "box_panels",
    "cut_at_plane",
    "hemisphere_panels",
    "hydrostatics",
    "mirrored_panels",
    "surface_panels",
    "triangle_panels",
]

AT_LEVEL = 1e-9  # of the extent


@dataclass(frozen=True, eq=False)
class HullPanels:
    """Wetted panels of one hull, in axes whose z = 0 is the still water.

    Attributes
    ----------
    points
        (nv, 3) corners [m].
    panels
        (np, 4) numbers of corners; a triangle repeats its last one.
    name
        Of the hull.
    """

    points: NDArray[np.float64]
    panels: NDArray[np.int64]
    name: str

    @property
    def triangles(self) -> NDArray[np.int64]:
        """(nt, 3) the panels cut along a diagonal, without empty halves."""
        first, second = self.panels[:, [0, 1, 2]], self.panels[:, [0, 2, 3]]
        return np.concatenate([first, second[self.panels[:, 2] != self.panels[:, 3]]])

    @property
    def longest_side(self) -> float:
        """Longest side of a panel [m]."""
        corners = self.points[self.panels]
        return float(np.max(np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)))

    @property
    def characteristic_size(self) -> float:
        """Side [m] of the square that has the area of the largest panel."""
        corners = self.points[self.panels]
        diagonals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        return float(np.sqrt(0.5 * np.max(np.linalg.norm(diagonals, axis=1))))

    def translated(self, x: float, y: float, *, name: str = "") -> HullPanels:
        """The same hull elsewhere in the plane of the still water [m]."""
        return replace(self, points=self.points + np.array([x, y, 0.0]), name=name or self.name)


@dataclass(frozen=True, eq=False)
class PanelHydrostatics:
    """Displaced volume [m^3], centre of buoyancy (3,) [m], stiffness (6, 6) without the terms of weight."""

    volume: float
    centre_of_buoyancy: NDArray[np.float64]
    stiffness: NDArray[np.float64]


def box_panels(
    length: float, breadth: float, draft: float, size: float, *, rows: int = 0, name: str = "box"
) -> HullPanels:
    """Wetted panels of a box barge, centred on the origin, symmetric about both middle planes.

    Parameters
    ----------
    length, breadth, draft
        [m].
    size
        Length and breadth of a panel [m], to the nearest whole number of panels.
    rows
        Panels over the draft; 0: half as high as they are long, because the pressure falls with depth.
    name
        Of the hull.

    Raises
    ------
    InputError
        A dimension is not positive.
    """
    for key, value in (("length", length), ("breadth", breadth), ("draft", draft), ("size", size)):
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(f"{value!r}", source=name, key=key, expected="a length > 0 [m]")
    along, across = max(1, round(length / size)), max(1, round(breadth / size))
    down = rows if rows > 0 else max(1, round(2.0 * draft / size))
    x = length * (np.arange(along + 1) / along - 0.5)
    y = breadth * (np.arange(across + 1) / across - 0.5)
    z = draft * (np.arange(down + 1) / down - 1.0)
    # every side: first and second direction turn right-handed about the normal into the water
    grids = (
        _grid(y, x, lambda v, u: (u, v, np.full_like(u, -draft))),
        _grid(x, z, lambda u, w: (u, np.full_like(u, -breadth / 2), w)),
        _grid(z, x, lambda w, u: (u, np.full_like(u, breadth / 2), w)),
        _grid(z, y, lambda w, v: (np.full_like(v, -length / 2), v, w)),
        _grid(y, z, lambda v, w: (np.full_like(v, length / 2), v, w)),
    )
    return _joined(grids, name)


def hemisphere_panels(radius: float, rings: int, sectors: int, *, name: str = "hemisphere") -> HullPanels:
    """Wetted panels of a floating hemisphere: ``rings`` from the water line to the pole, ``sectors`` around."""
    if not radius > 0.0 or rings < 1 or sectors < 3:
        raise InputError(
            f"radius {radius}, {rings} rings, {sectors} sectors", source=name, expected="> 0, >= 1, >= 3"
        )
    latitude = 0.5 * np.pi * (np.arange(rings + 1) / rings - 1.0)
    longitude = 2.0 * np.pi * np.arange(sectors + 1) / sectors
    grid = _grid(
        longitude,
        latitude,
        lambda u, v: (radius * np.cos(v) * np.cos(u), radius * np.cos(v) * np.sin(u), radius * np.sin(v)),
    )
    return _joined((grid,), name)


def surface_panels(surface: TriangleSurface, *, level: float = 0.0, name: str = "") -> HullPanels:
    """The part of a closed surface below ``level`` as panels, with z measured from there.

    Triangles that cross the water are cut; two corners below leave a quadrilateral, one leaves a triangle.
    Panels are as large as the triangles are: refine the surface first.

    Raises
    ------
    InputError
        Nothing is below the water, or the surface is inside out.
    """
    name = name or surface.name
    points = np.asarray(surface.points, dtype=np.float64) - np.array([0.0, 0.0, level])
    tolerance = AT_LEVEL * float(np.ptp(points, axis=0).max())
    corners = points[surface.triangles]
    corners[np.abs(corners[:, :, 2]) < tolerance, 2] = 0.0
    polygons = [_below(triangle) for triangle in corners]
    kept = [p for p in polygons if len(p) >= 3]
    if not kept:
        raise InputError(
            f"all {len(corners)} triangles are above the water", source=name, expected="a hull with a draft"
        )
    quads = np.array([p if len(p) == 4 else [*p, p[-1]] for p in kept], dtype=np.float64)
    hull = _welded(quads.reshape(-1, 3), np.arange(4 * len(quads)).reshape(-1, 4), name)
    if hydrostatics(hull, 1.0, 1.0, np.zeros(3)).volume <= 0.0:
        raise InputError(
            "the displaced volume is negative", source=name, expected="triangles wound to face outward"
        )
    return hull


def triangle_panels(points: NDArray[np.float64], triangles: NDArray[np.int64], name: str) -> HullPanels:
    """Panels of triangles (nt, 3); corners in one place get one number, triangles that collapse are left out."""
    return _welded(points, np.column_stack([triangles, triangles[:, 2]]), name)


def cut_at_plane(hull: HullPanels, axis: int, *, above: bool = False) -> HullPanels:
    """Triangles of the part of a hull with a negative coordinate, or with a positive one.

    Parameters
    ----------
    hull
        Its panels; those that cross the plane through the origin are cut.
    axis
        0, 1 or 2: normal to the plane.
    above
        True: the part with a positive coordinate.
    """
    sign = -1.0 if above else 1.0
    turn = [(axis + 1) % 3, (axis + 2) % 3, axis]
    corners = hull.points[hull.triangles][:, :, turn] * np.array([1.0, 1.0, sign])
    corners[np.abs(corners[:, :, 2]) < AT_LEVEL * float(np.ptp(hull.points, axis=0).max()), 2] = 0.0
    rows = [(p[0], p[i], p[i + 1]) for p in map(_below, corners) for i in range(1, len(p) - 1)]
    points = np.empty((3 * len(rows), 3))
    points[:, turn] = np.array(rows).reshape(-1, 3) * np.array([1.0, 1.0, sign])
    return triangle_panels(points, np.arange(len(points)).reshape(-1, 3), hull.name)


def mirrored_panels(half: HullPanels) -> HullPanels:
    """A hull whose half on one side of y = 0 is given; both halves share the corners in the plane."""
    middle = np.abs(half.points[:, 1]) <= 1e-6 * float(np.ptp(half.points, axis=0).max())
    points = half.points.copy()
    points[middle, 1] = 0.0
    image = np.arange(len(points))
    image[~middle] = len(points) + np.arange(np.count_nonzero(~middle))
    others = points[~middle] * np.array([1.0, -1.0, 1.0])
    turned = half.panels[:, ::-1].copy()
    three = half.panels[:, 2] == half.panels[:, 3]
    turned[three] = half.panels[three][:, [1, 0, 2, 2]]
    panels = np.concatenate([half.panels, image[turned]])
    return HullPanels(np.concatenate([points, others]), panels, half.name)


def hydrostatics(
    hull: HullPanels, density: float, gravity: float, reference: NDArray[np.float64]
) -> PanelHydrostatics:
    """Volume, centre of buoyancy and stiffness about ``reference`` of the panels, without the terms of weight.

    With the origin in the water plane the missing top has no part in the integrals of z; those of the water
    plane come from the flux of (0, 0, f(x, y)) through the hull: int f dA = - int f n_z dS, exact on
    triangles by their middle points of sides for f up to the second degree.

    Source: Faltinsen, Sea Loads, eq. (3.49), (3.50): C33 = rho g A, C44 = rho g V (z_B - z_ref) + rho g int
    (y - y_ref)^2 dA, ...
    """
    a, b, c = (hull.points[hull.triangles[:, i]] for i in range(3))
    normal = 0.5 * np.cross(b - a, c - a)  # area vector, into the water
    six = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    volume = float(six.sum())
    centre = (six[:, None] * (a + b + c)).sum(axis=0) / (4.0 * volume) if volume != 0.0 else np.zeros(3)
    middles = np.stack([a + b, b + c, c + a]) / 2.0 - np.asarray(reference)
    weight = -normal[:, 2] / 3.0

    def plane(f: NDArray[np.float64]) -> float:
        return float((f * weight).sum())

    x, y = middles[:, :, 0], middles[:, :, 1]
    buoyancy = centre - reference
    stiffness = np.zeros((6, 6))
    stiffness[2, 2] = plane(np.ones_like(x))
    stiffness[2, 3] = stiffness[3, 2] = plane(y)
    stiffness[2, 4] = stiffness[4, 2] = -plane(x)
    stiffness[3, 3] = plane(y * y) + volume * buoyancy[2]
    stiffness[4, 4] = plane(x * x) + volume * buoyancy[2]
    stiffness[3, 4] = stiffness[4, 3] = -plane(x * y)
    # no counterpart below the diagonal: a vertical force has no moment about the vertical
    stiffness[3, 5] = -volume * buoyancy[0]
    stiffness[4, 5] = -volume * buoyancy[1]
    return PanelHydrostatics(volume, centre, density * gravity * stiffness)


def _grid(
    first: NDArray[np.float64],
    second: NDArray[np.float64],
    place: Callable[..., tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]],
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Corners and panels of a mapped rectangle."""
    u, v = np.meshgrid(first, second, indexing="ij")
    points = np.stack(place(u.ravel(), v.ravel()), axis=1)
    number = np.arange(points.shape[0]).reshape(u.shape)
    panels = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1)
    return points, panels.reshape(-1, 4)


def _joined(grids: tuple[tuple[NDArray[np.float64], NDArray[np.int64]], ...], name: str) -> HullPanels:
    """One hull of several sides."""
    starts = np.cumsum([0] + [len(points) for points, _ in grids])
    points = np.concatenate([points for points, _ in grids])
    panels = np.concatenate([panels + start for (_, panels), start in zip(grids, starts[:-1], strict=True)])
    return _welded(points, panels, name)


def _welded(points: NDArray[np.float64], panels: NDArray[np.int64], name: str) -> HullPanels:
    """Corners in one place get one number; panels that collapse to a triangle repeat their last corner."""
    size = float(np.ptp(points, axis=0).max())
    _, index, inverse = np.unique(
        np.round(points / (AT_LEVEL * size)).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    numbered = np.asarray(inverse).reshape(-1)[panels]
    rows = []
    for row in numbered:
        corners = [int(v) for i, v in enumerate(row) if v != row[i - 1]]
        if len(corners) == 3:
            rows.append([*corners, corners[-1]])
        elif len(corners) == 4:
            rows.append(corners)
    return HullPanels(points[index], np.array(rows, dtype=np.int64), name)


def _below(triangle: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Corners of the part of a triangle below z = 0, in order; none for one that only touches."""
    if triangle[:, 2].min() >= 0.0:
        return []
    polygon = []
    for i in range(3):
        here, there = triangle[i], triangle[(i + 1) % 3]
        if here[2] <= 0.0:
            polygon.append(here)
        if here[2] * there[2] < 0.0:
            # from below, so that neighbours find the very same place
            low, high = (here, there) if here[2] < 0.0 else (there, here)
            cut = low + low[2] / (low[2] - high[2]) * (high - low)
            polygon.append(np.array([cut[0], cut[1], 0.0]))
    return polygon
