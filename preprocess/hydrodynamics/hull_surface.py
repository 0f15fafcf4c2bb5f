"""Checks that a triangle surface is the outside of a hull: closed, wound outwards, with a volume.

Hydrostatics integrates over the surface, so a hole or a triangle that is wound the wrong way gives a wrong volume
without a sign. An open deck is the exception: as long as its rim is dry, what is missing lies above the water.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.joined import joined
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.report import unique_edges
from heavylift.preprocess.surfaces.triangle_surface import WELD_TOLERANCE, TriangleSurface, clean
from heavylift.preprocess.surfaces.twice_inside import twice_inside

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.preprocess.surfaces.report import Edges

__all__ = ["HullSurface", "check_hull"]

_SLIT = 4.0 * WELD_TOLERANCE  # of the extent: what lies closer to an edge lies on it
_FLAT = 1e-9  # of the box around: less volume is none
_TWICE = 1e-3  # of the volume, that parts may share, as facets of round bulkheads that touch, or a skeg in its hull


@dataclass(frozen=True, eq=False)
class HullSurface:
    """Surface that water can press on.

    Parameters
    ----------
    surface
        Welded triangles in the axes of the body [m], wound anticlockwise seen from outside.
    covered
        The same with a cone over every opening, hence closed. What is above the rim does not matter while it is dry,
        and once it is wet water would run in, whatever is computed; but a search that passes such positions meets a
        hull that is closed.
    volume
        Inside [m^3], with an open deck up to its rim.
    rim
        Ends of the open edges [m], shape (n, 3); none if the surface is closed. Volumes are right only while all of
        them are above the water.
    """

    surface: TriangleSurface
    covered: TriangleSurface
    volume: float
    rim: NDArray[np.float64]

    @property
    def name(self) -> str:
        """Of the surface, for messages."""
        return self.surface.name or "hull"

    @property
    def is_closed(self) -> bool:
        """Whether there is no opening."""
        return len(self.rim) == 0


def check_hull(
    surface: TriangleSurface, *, open_deck: float | None = None, key: str = "surface"
) -> HullSurface:
    """Weld a surface and make sure that it is the outside of a hull.

    Parameters
    ----------
    surface
        Triangles in the axes of the body [m], z up; may consist of several closed parts that do not overlap, as the
        pontoons of a platform, and may touch, as compartments.
    open_deck
        Height [m] in these axes, at or above which the surface may be open. The hull is then right only while the whole
        rim of the opening is dry, which must be watched.
    key
        What messages call the surface, beside its name.

    Raises
    ------
    InputError
        For a rounded surface, holes, plates inside, triangles wound against each other, parts that are inside-out, no
        volume, parts that overlap or lie in each other by more than 0.1 % of the volume.

    Notes
    -----
    Every edge must be run through in one direction as often as in the other. Edges that meet others in a T, as in
    many CAD files, are cut there first.
    """
    source = surface.name or "hull"
    if surface.radius > 0.0 or not surface.faces.all():
        raise InputError(
            f"is rounded with {surface.radius:.6g} m",
            source=source,
            key=key,
            expected="flat triangles without a rounding; make round hulls of small triangles",
        )
    welded, _ = clean(surface.points, surface.triangles, name=surface.name)
    edges = unique_edges(welded)
    along = np.bincount(edges.of_side[edges.forward], minlength=len(edges.ends))
    surplus = 2 * along - edges.faces  # directions that nothing runs against
    _refuse_flipped(welded, edges, (edges.faces == 2) & (surplus != 0), source, key)
    loose = np.flatnonzero(surplus)
    pieces = _cut_at_points(welded.points, edges.ends[loose], surplus[loose])
    ends = pieces[pieces[:, 2] != 0, :2]
    extent = float(np.ptp(welded.bounds, axis=0).max())
    if len(ends):
        _refuse_leaks(welded, ends, open_deck, _SLIT * extent, source, key)
    covered = _cover(welded, pieces[pieces[:, 2] != 0])
    volume = _part_volumes(covered, np.vstack([edges.ends, pieces[:, :2]]), source, key)
    rim = welded.points[np.unique(ends)]
    _refuse_twice(covered, volume, float(rim[:, 2].min(initial=np.inf)), source, key)
    return HullSurface(welded, covered, volume, rim)


def _refuse_twice(surface: TriangleSurface, volume: float, below: float, source: str, key: str) -> None:
    """Raise if parts enclose the same space, which would displace water twice."""
    twice = twice_inside(surface, below=below)
    if twice.volume > _TWICE * volume:
        place = ", ".join(f"{x:.3g}" for x in twice.place)
        raise InputError(
            f"parts overlap or lie in each other: about {twice.volume:.3g} m3 of {volume:.5g} m3, around ({place}) m, "
            "would be counted twice",
            source=source,
            key=key,
            expected="the outside of the hull alone: join parts that overlap to one in the CAD program, leave out what "
            "is inside (tanks are [[tanks]]); parts may touch",
        )


def _refuse_flipped(
    surface: TriangleSurface, edges: Edges, flipped: NDArray[np.bool_], source: str, key: str
) -> None:
    if flipped.any():
        raise InputError(
            f"{np.count_nonzero(flipped)} edges between triangles that are wound against each other, "
            f"{_place(surface.points, edges.ends[flipped])}",
            source=source,
            key=key,
            expected="all triangles anticlockwise seen from outside (make normals consistent in the CAD program)",
        )


def _refuse_leaks(
    surface: TriangleSurface,
    ends: NDArray[np.int64],
    open_deck: float | None,
    reach: float,
    source: str,
    key: str,
) -> None:
    """Raise for open edges that no open deck explains."""
    lowest = surface.points[ends][:, :, 2].min(axis=1)
    if open_deck is None:
        wrong = np.ones(len(ends), dtype=bool)
        expected = (
            "a closed surface; or 'open_deck', the height of the rim, if it is open above all water lines"
        )
        what = "open edges"
    else:
        wrong = lowest < open_deck - reach
        expected = f"openings at z = {open_deck:.6g} m ('open_deck') or above only"
        what = f"open edges below the open deck, down to z = {lowest.min():.6g} m"
    if wrong.any():
        problem = f"leaks: {np.count_nonzero(wrong)} {what}, {_place(surface.points, ends[wrong])}"
        raise InputError(problem, source=source, key=key, expected=expected)


def _place(points: NDArray[np.float64], ends: NDArray[np.int64]) -> str:
    """Where some edges are, for a message."""
    low, high = points[ends].min(axis=(0, 1)), points[ends].max(axis=(0, 1))
    first = points[ends[0]].mean(axis=0)
    place = f"the first at ({', '.join(f'{x:.5g}' for x in first)}) m"
    if len(ends) == 1:
        return place
    corners = " to ".join(f"({', '.join(f'{x:.5g}' for x in corner)})" for corner in (low, high))
    return f"{place}, all in {corners} m"


def _cut_at_points(
    points: NDArray[np.float64], ends: NDArray[np.int64], surplus: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Cut open edges where ends of others lie on them.

    Parameters
    ----------
    points
        [m], shape (nv, 3).
    ends
        Points of each open edge, shape (n, 2).
    surplus
        How often it is run from the first to the second end, less the other way, shape (n,).

    Returns
    -------
    ndarray
        Pieces: two points, and how often a piece is run forward, less backward; 0 where the sides of a T meet.
        Shape (m, 3).
    """
    if len(ends) == 0:
        return np.empty((0, 3), dtype=np.int64)
    from scipy.spatial import cKDTree

    numbers = np.unique(ends)
    a, b = points[ends[:, 0]], points[ends[:, 1]]
    length = np.linalg.norm(b - a, axis=1)
    reach = _SLIT * float(np.ptp(points, axis=0).max())
    near = cKDTree(points[numbers]).query_ball_point(0.5 * (a + b), 0.5 * length + reach)
    pieces: dict[tuple[int, int], int] = {}
    for edge, around in enumerate(near):
        others = numbers[around]
        offset = points[others] - a[edge]
        direction = (b[edge] - a[edge]) / length[edge]
        along = offset @ direction
        off = np.linalg.norm(offset - np.outer(along, direction), axis=1)
        on = (off <= reach) & (along > reach) & (along < length[edge] - reach)
        chain = [int(ends[edge, 0]), *others[on][np.argsort(along[on])].tolist(), int(ends[edge, 1])]
        for i, j in pairwise(chain):
            sign = 1 if i < j else -1
            place = (min(i, j), max(i, j))
            pieces[place] = pieces.get(place, 0) + sign * int(surplus[edge])
    return np.array([(i, j, n) for (i, j), n in pieces.items()], dtype=np.int64)


def _cover(surface: TriangleSurface, rims: NDArray[np.int64]) -> TriangleSurface:
    """Close every opening by a cone from its rim to the mean of its corners.

    Parameters
    ----------
    surface
        Triangles with openings.
    rims
        Pieces of `_cut_at_points` that are open, shape (m, 3).
    """
    if len(rims) == 0:
        return surface
    _, label = _components(len(surface.points), rims[:, :2])
    of_rim = label[rims[:, 0]]
    tips, cones = [], []
    for opening in np.unique(of_rim):
        own = rims[of_rim == opening]
        tips.append(surface.points[np.unique(own[:, :2])].mean(axis=0))
        tip = len(surface.points) + len(tips) - 1
        # against the direction in which the faces run along the rim
        cones += [(j, i, tip) if n > 0 else (i, j, tip) for i, j, n in own.tolist() for _ in range(abs(n))]
    return TriangleSurface(
        np.vstack([surface.points, *tips]), np.vstack([surface.triangles, cones]), name=surface.name
    )


def _components(size: int, joins: NDArray[np.int64]) -> tuple[int, NDArray[np.int64]]:
    """Count the sets of points that edges join, and number them for each point, shape (size,)."""
    label = joined(size, joins)
    return int(label.max(initial=-1)) + 1, label


def _part_volumes(surface: TriangleSurface, joins: NDArray[np.int64], source: str, key: str) -> float:
    """Add the volumes [m^3] of the closed parts that `joins` connects; raise if one has none, or a negative one."""
    _, label = _components(len(surface.points), joins)
    of_face = label[surface.triangles[:, 0]]
    numbers = np.unique(of_face)
    parts, total = len(numbers), 0.0
    for part in numbers:
        faces = surface.triangles[of_face == part]
        corners = surface.points[faces] - surface.points[faces[0, 0]]
        volume = float(np.einsum("ni,ni->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0)
        box = float(np.ptp(corners.reshape(-1, 3), axis=0).prod())
        if volume <= _FLAT * box:
            centre = ", ".join(f"{x:.5g}" for x in surface.points[faces].mean(axis=(0, 1)))
            which = (
                "" if parts == 1 else f"one of {parts} parts, of {len(faces)} triangles about ({centre}) m, "
            )
            if volume < -_FLAT * box:
                problem = f"{which}is inside-out: its volume is {volume:.6g} m3"
                expected = (
                    "triangles anticlockwise seen from outside (turn the normals), no inner skins (leave out)"
                )
            else:
                problem = f"{which}encloses no volume"
                expected = "the outside of a hull; leave plates out"
            raise InputError(problem, source=source, key=key, expected=expected)
        total += volume
    return total
