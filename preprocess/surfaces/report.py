"""What a surface is like, for a person: counts, open edges, windings; and whether two surfaces have the same unit."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.joined import joined

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.preprocess.surfaces.triangle_surface import CleanCounts, TriangleSurface

__all__ = ["SurfaceReport", "check_against_body", "check_magnitudes", "report_surface", "unique_edges"]

_LARGEST_RATIO = 300.0  # of the extents of two bodies that meet
_LONGEST = 500.0  # m; the longest ship has 458 m


class Edges(NamedTuple):
    """Edges of the faces of a surface, each once."""

    ends: NDArray[np.int64]  # (ne, 2) points, the lower number first
    of_side: NDArray[np.int64]  # (nt, 3) edges of the sides AB, BC, CA of each face
    forward: NDArray[np.bool_]  # (nt, 3) whether the side runs from the lower number to the higher
    faces: NDArray[np.int64]  # (ne,) how many faces the edge has


def unique_edges(surface: TriangleSurface) -> Edges:
    """Find the edges of the faces; lone points and segments have none.

    Parameters
    ----------
    surface
        Triangles, shape (nt, 3), of which some may be no faces.
    """
    faces = surface.triangles[surface.faces]
    sides = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    forward = sides[:, 0] < sides[:, 1]
    keys = sides.min(axis=1) * len(surface.points) + sides.max(axis=1)
    unique, place, count = np.unique(keys, return_inverse=True, return_counts=True)
    ends = np.column_stack(np.divmod(unique, len(surface.points)))
    return Edges(ends, place.reshape(-1, 3), forward.reshape(-1, 3), count)


@dataclass(frozen=True)
class SurfaceReport:
    """Counts and sizes of a surface.

    Collision asks for none of what is missing here: it takes open edges, several plates at an edge and windings as they
    come.
    """

    name: str
    points: int
    triangles: int
    """Faces, lone points and segments of round shapes included."""
    edges: int
    open_edges: int
    """Edges of one face."""
    junction_edges: int
    """Edges of more than two faces."""
    flipped_edges: int
    """Edges of two faces that are wound against each other: both run along the edge in the same direction."""
    reversed_triangles: int
    """Fewest faces to be turned so that no edge is flipped; parts with one side only (Moebius) are left out."""
    watertight: bool
    """Whether every edge has exactly two faces."""
    bounds: NDArray[np.float64]
    """Lowest and highest corner [m] with the rounding, shape (2, 3)."""
    area: float
    """Of the faces, one side [m2]."""
    radius: float
    """Rounding [m]."""
    dropped: CleanCounts | None
    """What cleaning found, if the surface was cleaned."""

    def lines(self) -> list[str]:
        """Return the report as lines of text."""
        size = np.ptp(self.bounds, axis=0)
        counts = f"{self.triangles} triangles, {self.points} points, {self.edges} edges"
        text = [
            f"{self.name or 'surface'}: {counts}, {self.area:.6g} m2",
            f"  box {_box(self.bounds)}, {size[0]:.4g} x {size[1]:.4g} x {size[2]:.4g} m",
        ]
        if self.radius > 0.0:
            text.append(f"  rounded with {self.radius:.6g} m")
        shut = "watertight" if self.watertight else "not watertight"
        text.append(
            f"  {shut}: {self.open_edges} open edges, {self.junction_edges} of more than two triangles; "
            f"{self.flipped_edges} edges between triangles wound against each other "
            f"({self.reversed_triangles} to be turned)"
        )
        if self.dropped is not None:
            d = self.dropped
            text.append(
                f"  from {d.triangles} triangles on {d.points} points: {d.welded} points welded, {d.unused} unused, "
                f"{d.degenerate} degenerate and {d.duplicate} duplicate triangles dropped"
            )
        return text

    def __str__(self) -> str:
        return "\n".join(self.lines())


def report_surface(surface: TriangleSurface, dropped: CleanCounts | None = None) -> SurfaceReport:
    """Count edges and windings of a surface, and measure it.

    Parameters
    ----------
    surface
        Points [m] and triangles.
    dropped
        What cleaning has left out, from `heavylift.preprocess.surfaces.triangle_surface.clean`.
    """
    edges = unique_edges(surface)
    a, b, c = np.moveaxis(surface.points[surface.triangles], 1, 0)
    along = np.bincount(edges.of_side[edges.forward], minlength=len(edges.ends))
    flipped = (edges.faces == 2) & (along != 1)
    return SurfaceReport(
        name=surface.name,
        points=len(surface.points),
        triangles=len(surface.triangles),
        edges=len(edges.ends),
        open_edges=int(np.count_nonzero(edges.faces == 1)),
        junction_edges=int(np.count_nonzero(edges.faces > 2)),
        flipped_edges=int(np.count_nonzero(flipped)),
        reversed_triangles=_fewest_to_turn(edges, flipped),
        watertight=bool(len(edges.faces) > 0 and (edges.faces == 2).all()),
        bounds=surface.bounds,
        area=0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()),
        radius=surface.radius,
        dropped=dropped,
    )


def check_against_body(name: str, surface: TriangleSurface, body: str, gyration: float) -> str | None:
    """Say if a surface looks as if it were in another unit than the inertia of its body.

    A box has two to four times its radius of gyration as its longest side; so far more than `_LARGEST_RATIO` times is a
    file in mm that is taken for metres, whatever small and heavy inertia the body has.

    Parameters
    ----------
    name, body
        What the message calls them.
    surface
        Points in m.
    gyration
        Largest radius of gyration of the body [m].

    Returns
    -------
    str or None
        A warning with both sizes.
    """
    size = float(np.ptp(surface.bounds, axis=0).max())
    if not gyration > 0.0 or size <= _LARGEST_RATIO * gyration:
        return None
    return (
        f"{name} measures {size:.4g} m, and the radius of gyration of its body {body} is {gyration:.4g} m: is it in mm "
        f'(then it would measure {1e-3 * size:.4g} m; unit = "mm")?'
    )


def check_magnitudes(
    name_a: str, surface_a: TriangleSurface, name_b: str, surface_b: TriangleSurface
) -> str | None:
    """Say if one of two surfaces looks as if it were in another unit than the other.

    That is if one is more than 300 times as large as the other, or more than 500 m. Planes (two triangles at most)
    stand for the ground and may be as large as they like. A part of half a metre in mm stays below both.

    Parameters
    ----------
    name_a, name_b
        What the message calls them.
    surface_a, surface_b
        Surfaces of two bodies that may meet, points in m.

    Returns
    -------
    str or None
        A warning with both bounding boxes.
    """
    sizes = [
        (float(np.ptp(surface.bounds, axis=0).max()), name, surface)
        for name, surface in ((name_a, surface_a), (name_b, surface_b))
    ]
    boxes = "; ".join(
        f"{name} in {_box(surface.bounds)}" for name, surface in ((name_a, surface_a), (name_b, surface_b))
    )
    bodies = [item for item in sizes if len(item[2].triangles) > 2 or item[2].radius > 0.0]
    if not bodies:
        return None
    large, name, _ = max(bodies, key=lambda item: item[0])
    small, other, _ = min(bodies, key=lambda item: item[0])
    if len(bodies) == 2 and large > _LARGEST_RATIO * small:
        problem = f"{name} is {large / small:.3g} times as large as {other}"
    elif large > _LONGEST:
        problem = f"{name} measures {large:.4g} m"
    else:
        return None
    return f"{problem}: is it in mm (then it would measure {1e-3 * large:.4g} m)? Boxes: {boxes}"


def _box(bounds: NDArray[np.float64]) -> str:
    low, high = (", ".join(f"{value:.5g}" for value in corner) for corner in bounds)
    return f"({low}) to ({high}) m"


def _fewest_to_turn(edges: Edges, flipped: NDArray[np.bool_]) -> int:
    """Fewest faces to be turned so that all neighbours across edges of two faces agree.

    Every face stands twice in a graph, as it is and turned; neighbours join the copies that agree. A part of the
    surface that has two sides falls into two mirrored components, of which the smaller number of turned faces counts.
    """
    count = len(edges.of_side)
    if count == 0:
        return 0
    face = np.repeat(np.arange(count), 3)
    order = np.argsort(edges.of_side.ravel(), kind="stable")
    first = np.concatenate([[0], np.cumsum(edges.faces)[:-1]])
    pair = edges.faces == 2
    a, b = face[order[first[pair]]], face[order[first[pair] + 1]]
    turned = count * flipped[pair]
    rows, columns = np.concatenate([a, a + count]), np.concatenate([b + turned, b + count - turned])
    label = joined(2 * count, np.column_stack([rows, columns]))
    parts = int(label.max()) + 1
    as_is, mirrored = label[:count], label[count:]
    two_sided = as_is != mirrored
    # in the component of one choice: faces that stand as they are, and faces that stand turned
    keep = np.bincount(as_is[two_sided], minlength=parts)
    turn = np.bincount(mirrored[two_sided], minlength=parts)
    chosen = np.unique(np.minimum(as_is, mirrored)[two_sided])  # one of each two mirrored components
    return int(np.minimum(keep[chosen], turn[chosen]).sum())
