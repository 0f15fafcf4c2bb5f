"""What the still water cuts out of hulls: the water plane inside them, lids on it, and moonpools.

Panels of a hull are open at z = 0. Seen from above their rim runs clockwise around a hull, and anticlockwise around
water that a hull encloses.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.gmsh_session import gmsh_session
from heavylift.preprocess.hydrodynamics.hull_panels import HullPanels, triangle_panels
from heavylift.preprocess.hydrodynamics.panel_mesh import flat_panels

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Moonpool", "lid_panels", "moonpools", "opening_height", "piston_frequency"]

AT_WATER = 1e-7
"""Of the extent."""
_TRIANGLE = 2
"""gmsh's number of it."""


@dataclass(frozen=True, eq=False)
class Moonpool:
    """Water that a hull encloses.

    Attributes
    ----------
    centre
        Of its surface, shape (2,) [m].
    length, breadth
        Of the rectangle with its area and the proportions of its extent along x and y [m].
    draft
        Depth of the lower rim [m].
    """

    centre: NDArray[np.float64]
    length: float
    breadth: float
    draft: float


def _rims(hull: HullPanels) -> list[NDArray[np.int64]]:
    """Closed rims in the water: numbers of corners in the order in which panels run along them."""
    extent = float(np.ptp(hull.points, axis=0).max())
    high = np.abs(hull.points[:, 2]) <= AT_WATER * extent
    sides = np.stack([hull.panels, np.roll(hull.panels, -1, axis=1)], axis=2).reshape(-1, 2)
    sides = sides[high[sides].all(axis=1) & (sides[:, 0] != sides[:, 1])]
    there = {(a, b) for a, b in sides.tolist()}
    after: dict[int, int] = {}
    for a, b in sorted(there):
        if (b, a) in there:
            continue  # a panel in the water plane on the other side
        if a in after:
            raise InputError("two rims touch in the water plane", source=hull.name, expected="hulls apart")
        after[a] = b
    found = []
    while after:
        start = vertex = min(after)
        loop = []
        while vertex in after:
            loop.append(vertex)
            vertex = after.pop(vertex)
        if vertex != start:
            raise InputError("the rim at the water is not closed", source=hull.name, expected="closed hulls")
        found.append(np.array(loop, dtype=np.int64))
    return found


def _signed_area(loop: NDArray[np.float64]) -> float:
    x, y = (loop[:, k] - loop[0, k] for k in (0, 1))
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def _inside(points: NDArray[np.float64], loop: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which points (n, 2) a polygon encloses."""
    a, b = loop[None, :, :2], np.roll(loop[:, :2], -1, axis=0)[None]
    p = points[:, None, :2]
    above = (a[..., 1] > p[..., 1]) != (b[..., 1] > p[..., 1])
    rise = np.where(above, b[..., 1] - a[..., 1], 1.0)
    x = a[..., 0] + (p[..., 1] - a[..., 1]) * (b[..., 0] - a[..., 0]) / rise
    return np.asarray(np.count_nonzero(above & (p[..., 0] < x), axis=1) % 2 == 1)


def moonpools(hull: HullPanels) -> tuple[Moonpool, ...]:
    """Water that a hull encloses, the largest first: rims around which the hull is outside.

    Raises
    ------
    InputError
        If rims are open or touch each other.
    """
    loops = _rims(hull)
    extent = float(np.ptp(hull.points, axis=0).max())
    found = []
    for loop in loops:
        rim = hull.points[loop]
        area = _signed_area(rim)
        if area <= 0.0:
            continue
        low, high = rim[:, :2].min(axis=0), rim[:, :2].max(axis=0)
        along, across = high - low
        # walls may lean: what lies below the opening or at its rim, up to a hundredth of the extent
        grown = rim[:, :2] + 0.01 * extent * np.sign(rim[:, :2] - 0.5 * (low + high))
        below = hull.points[_inside(hull.points, grown)]
        scale = np.sqrt(area / (along * across))
        found.append(
            Moonpool(
                0.5 * (low + high), float(along * scale), float(across * scale), float(-below[:, 2].min())
            )
        )
    return tuple(sorted(found, key=lambda pool: -pool.length * pool.breadth))


def opening_height(length: float, breadth: float) -> float:
    """Height of the water below a rectangular opening in a wide bottom that moves with the water in it [m].

    Half of the mean of 1/r over all pairs of points of the rectangle, times its area over pi, in closed form.

    Source: Molin, "On the piston and sloshing modes in moonpools", J. Fluid Mech. 430 (2001), b f3(b / l).
    """
    diagonal = np.hypot(length, breadth)
    rest = (length**3 + breadth**3 - diagonal**3) / (3.0 * length * breadth)
    return float(
        (length * np.arcsinh(breadth / length) + breadth * np.arcsinh(length / breadth) + rest) / np.pi
    )


def piston_frequency(pool: Moonpool, gravity: float) -> float:
    """Natural frequency of the water in a moonpool that goes up and down as a whole [rad/s].

    omega^2 = g / (draft + height of the opening): of a fixed hull that is long and wide against the moonpool, with
    vertical walls and deep water.

    Source: Molin (2001), see `opening_height`.
    """
    return float(np.sqrt(gravity / (pool.draft + opening_height(pool.length, pool.breadth))))


def lid_panels(hull: HullPanels, size: float, *, symmetric: bool = False) -> HullPanels | None:
    """Panels of the water plane inside a hull, from rim to rim; moonpools stay open.

    Parameters
    ----------
    hull
        Its panels.
    size
        Of the panels of the lid [m].
    symmetric
        Hull and lid are symmetric about y = 0.

    Returns
    -------
    HullPanels
        Panels with their normals down; None for a hull that is under water altogether.

    Raises
    ------
    InputError
        If rims are open or touch each other.
    """
    loops = _rims(hull)
    if not loops:
        return None
    with gmsh_session(hull.name) as gmsh:
        rims = []
        for loop in loops:
            places = hull.points[loop]
            points = [gmsh.model.geo.addPoint(x, y, 0.0) for x, y, _ in places.tolist()]
            lines = [
                gmsh.model.geo.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)
            ]
            rims.append((gmsh.model.geo.addCurveLoop(lines), places, lines))
        holes = [(curve, places) for curve, places, _ in rims if _signed_area(places) > 0.0]
        for curve, places, _ in rims:
            if _signed_area(places) < 0.0:
                own = [hole for hole, around in holes if _inside(around[:1], places)[0]]
                gmsh.model.geo.addPlaneSurface([curve, *own])
        gmsh.model.geo.synchronize()
        for _, _, lines in rims:
            for line in lines:
                gmsh.model.mesh.setTransfiniteCurve(line, 2)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.model.mesh.generate(2)
        tags, places, _ = gmsh.model.mesh.getNodes()
        place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        place[tags.astype(np.int64)] = np.arange(len(tags))
        _, connectivity = gmsh.model.mesh.getElementsByType(_TRIANGLE)
    corners = place[connectivity.astype(np.int64)].reshape(-1, 3)
    points = places.reshape(-1, 3)
    a, b, c = (points[corners[:, i]] for i in range(3))
    up = np.cross(b - a, c - a)[:, 2] > 0.0
    corners[up] = corners[up][:, ::-1]
    return flat_panels(triangle_panels(points, corners, hull.name), size, symmetric=symmetric)
