"""Triangle surfaces of bodies that may touch: the data, and how a soup of triangles is made one.

CAD models of ships arrive as triangles that share no vertex. Welding gives every place one number, without which
neighbours are not found and the same corner is tested six times (Ericson, *Real-Time Collision Detection*, 2005,
section 12.1).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.joined import joined
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "WELD_TOLERANCE",
    "CleanCounts",
    "TriangleSurface",
    "checked_arrays",
    "clean",
    "placed",
    "with_triangles",
]

WELD_TOLERANCE = 1e-7  # of the extent

FEW = 256
"""Points of which each is compared with each: sooner done than a tree is imported."""


@dataclass(frozen=True, eq=False)
class TriangleSurface:
    """Points and triangles of one surface, in the axes of its body.

    Nothing is asked of it: plates without thickness, open edges, edges of three plates, neighbours wound against
    each other, triangles that meet in a T are all allowed.

    Parameters
    ----------
    points
        Positions [m], shape (nv, 3); no two in one place (`clean` sees to that).
    triangles
        Numbers of three points each, shape (nt, 3). Rows that repeat a number make round shapes and are no faces:
        (v, v, v) is a lone point, (a, b, b) a lone segment.
    radius
        Rounding [m]: the surface is the set of all points at this distance from the triangles. A sphere is a lone
        point, a capsule a lone segment.
    name
        Where it comes from, for messages.

    Raises
    ------
    InputError
        For arrays of the wrong shape, no triangle, coordinates that are not finite, numbers of points that do not
        exist, a radius that is negative or not finite, a lone point or segment without a radius.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    radius: float = 0.0
    name: str = ""

    def __post_init__(self) -> None:
        source = self.name or "surface"
        points, triangles = checked_arrays(self.points, self.triangles, source)
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "triangles", triangles)
        object.__setattr__(self, "radius", float(self.radius))
        if not (np.isfinite(self.radius) and self.radius >= 0.0):
            raise InputError(
                f"{self.radius!r}", source=source, key="radius", expected="a length in m, zero or positive"
            )
        lone = np.flatnonzero(~self.faces)
        if self.radius == 0.0 and lone.size:
            raise InputError(
                f"repeats a point: {triangles[lone[0]].tolist()}",
                source=source,
                key=f"triangle {lone[0] + 1}",
                expected="three different points, or a radius that makes it round",
            )

    @property
    def faces(self) -> NDArray[np.bool_]:
        """Which rows of `triangles` are faces, not lone points or segments, shape (nt,)."""
        a, b, c = self.triangles.T
        return (a != b) & (b != c) & (c != a)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Lowest and highest corner [m] of the triangles with their rounding, shape (2, 3)."""
        used = self.points[self.triangles.ravel()]
        return np.array([used.min(axis=0) - self.radius, used.max(axis=0) + self.radius])


def checked_arrays(
    points: ArrayLike, triangles: ArrayLike, source: object
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Points and triangles as arrays that kernels take.

    Parameters
    ----------
    points, triangles
        Positions [m], shape (nv, 3), and numbers of points, shape (nt, 3).
    source
        What messages call them.

    Raises
    ------
    InputError
        See `TriangleSurface`.
    """
    p = np.ascontiguousarray(points, dtype=np.float64)
    t = np.asarray(triangles)
    if p.ndim != 2 or p.shape[1] != 3:
        raise InputError(f"array of shape {p.shape}", source=source, key="points", expected="shape (nv, 3)")
    if t.ndim != 2 or t.shape[1] != 3 or (t.size and t.dtype.kind not in "iu"):
        raise InputError(
            f"array of shape {t.shape} of {t.dtype}",
            source=source,
            key="triangles",
            expected="whole numbers, shape (nt, 3)",
        )
    if len(t) == 0:
        raise InputError("contains no triangle", source=source, expected="at least one triangle")
    t = np.ascontiguousarray(t, dtype=np.int64)
    lowest, highest = int(t.min()), int(t.max())
    if lowest < 0 or highest >= len(p):
        bad = lowest if lowest < 0 else highest
        raise InputError(
            f"point {bad}",
            source=source,
            key=f"triangle {int(np.argmax((t == bad).any(axis=1))) + 1}",
            expected=f"numbers from 0 to {len(p) - 1}, one for each of the {len(p)} points",
        )
    wrong = np.flatnonzero(~np.isfinite(p).all(axis=1))
    if wrong.size:
        raise InputError(
            f"position {p[wrong[0]].tolist()} ({wrong.size} such points)",
            source=source,
            key=f"point {wrong[0] + 1}",
            expected="three finite coordinates",
        )
    return p, t


class CleanCounts(NamedTuple):
    """What `clean` was given and what it took away."""

    points: int  # given, used or not
    triangles: int  # given
    welded: int  # points that went into another one
    unused: int  # points of no triangle, before or after
    degenerate: int  # triangles without area: a repeated point or three points on a line
    duplicate: int  # triangles of the same three points as one before, wound either way


def clean(
    points: ArrayLike,
    triangles: ArrayLike,
    *,
    radius: float = 0.0,
    name: str = "",
    tolerance: float = WELD_TOLERANCE,
) -> tuple[TriangleSurface, CleanCounts]:
    """Weld a soup of triangles and drop those that are none.

    Points closer than the tolerance become one, which keeps the place of the first of them; what is welded in a
    chain becomes one as well. A triangle is degenerate if its smallest height does not exceed the tolerance: it is a
    line, and the neighbours have its edges.

    Parameters
    ----------
    points
        Positions [m], shape (n, 3).
    triangles
        Numbers of three points each, shape (m, 3).
    radius, name
        Of the surface.
    tolerance
        As a fraction of the largest extent of the triangles.

    Returns
    -------
    tuple
        The surface, its points numbered as the triangles first name them, and the counts.

    Raises
    ------
    InputError
        See `TriangleSurface`; also if nothing but degenerate triangles is left.
    """
    p, t = checked_arrays(points, triangles, name or "surface")
    used = np.unique(t)
    extent = float(np.ptp(p[used], axis=0).max())
    reach = tolerance * extent
    chosen = np.empty(len(p), dtype=np.int64)
    chosen[used] = used[_first_of_same_place(p[used], reach)]
    welded = used.size - np.count_nonzero(chosen[used] == used)
    t = chosen[t]
    sound = _smallest_heights(p, t) > reach
    solid = t[sound]
    keys = np.sort(solid, axis=1)
    _, first = np.unique(keys, axis=0, return_index=True)
    kept = solid[np.sort(first)]
    if len(kept) == 0:
        raise InputError(
            f"all {len(t)} triangles are points or lines (extent {extent:.6g} m)",
            source=name or "surface",
            expected="at least one triangle with an area",
        )
    surface = with_triangles(TriangleSurface(p, kept, radius, name), kept)
    counts = CleanCounts(
        points=len(p),
        triangles=len(t),
        welded=int(welded),
        unused=len(p) - int(welded) - len(surface.points),
        degenerate=len(t) - len(solid),
        duplicate=len(solid) - len(kept),
    )
    return surface, counts


def with_triangles(surface: TriangleSurface, triangles: NDArray[np.int64]) -> TriangleSurface:
    """Return the surface of some triangles only, with the points that they use, in the order of their use.

    Parameters
    ----------
    surface
        Points [m] and rounding.
    triangles
        Numbers of its points, shape (n, 3).
    """
    flat = triangles.ravel()
    used, first, place = np.unique(flat, return_index=True, return_inverse=True)
    order = np.argsort(first)
    number = np.empty(used.size, dtype=np.int64)
    number[order] = np.arange(used.size)
    rows = number[place.ravel()].reshape(-1, 3)
    return TriangleSurface(surface.points[used[order]], rows, surface.radius, surface.name)


def placed(
    surface: TriangleSurface, rotation: ArrayLike | None = None, position: ArrayLike = (0.0, 0.0, 0.0)
) -> TriangleSurface:
    """Return the surface turned, then moved.

    Parameters
    ----------
    rotation
        Shape (3, 3), orthogonal; default no rotation.
    position
        Of the origin of the surface [m], shape (3,).
    """
    turn = np.eye(3) if rotation is None else np.asarray(rotation, dtype=np.float64)
    points = surface.points @ turn.T + np.asarray(position, dtype=np.float64)
    return TriangleSurface(points, surface.triangles, surface.radius, surface.name)


def _first_of_same_place(points: NDArray[np.float64], reach: float) -> NDArray[np.int64]:
    """Number of the first of the points that lie in one place, for each point, shape (n,)."""
    # equal coordinates first, by sorting: a corner of hundreds of triangles would make a pair of each two of them
    order = np.lexsort(points.T)  # stable: the first of equal points is the one with the lowest number
    rows = points[order]
    new = np.concatenate([[True], (rows[1:] != rows[:-1]).any(axis=1)])
    group = np.empty(len(points), dtype=np.int64)
    group[order] = np.cumsum(new) - 1
    first = order[new]
    pairs = _near_pairs(points[first], reach)
    if len(pairs):
        part = joined(first.size, pairs)
        lowest = np.full(int(part.max()) + 1, len(points), dtype=np.int64)
        np.minimum.at(lowest, part, first)
        first = lowest[part]
    return first[group]


def _near_pairs(points: NDArray[np.float64], reach: float) -> NDArray[np.int64]:
    """Pairs of points that are not farther apart than `reach`, each once, shape (n, 2)."""
    if len(points) <= FEW:
        squares = ((points[:, None] - points) ** 2).sum(axis=2)
        return np.argwhere(np.triu(squares <= reach * reach, 1))
    from scipy.spatial import cKDTree

    pairs: NDArray[np.int64] = cKDTree(points).query_pairs(reach, output_type="ndarray")
    return pairs


def _smallest_heights(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    """Smallest height of each triangle [m], shape (nt,)."""
    a, b, c = points[triangles[:, 0]], points[triangles[:, 1]], points[triangles[:, 2]]
    longest = np.sqrt(np.max([((q - p) ** 2).sum(axis=1) for p, q in ((a, b), (b, c), (c, a))], axis=0))
    double_area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return double_area / np.where(longest > 0.0, longest, 1.0)
