"""A surface of triangles taken apart along its edges and knuckles: patches with one border, and curves between them."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.joined import joined
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.hull_panels import HullPanels, cut_at_plane, triangle_panels

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "ON",
    "Curve",
    "PatchedSurface",
    "along",
    "corners_of",
    "curves_between",
    "edges_of",
    "flat_patches",
    "loops_around",
    "normals_of",
    "patched",
    "sides_of",
]

SHARP = np.deg2rad(30.0)
"""Between the normals of two triangles: an edge always."""
KNUCKLE = np.deg2rad(5.0)
"""The same where flat faces meet that are wider than a panel; between narrower ones it is a curve in facets."""
FLAT = np.deg2rad(0.5)
"""Between triangles of a flat face."""
CORNER = np.deg2rad(35.0)
"""Turn of a curve at a corner."""
ON = 1e-7
"""Of the extent: what lies closer to a plane lies on it."""


class PatchedSurface(NamedTuple):
    """Triangles and the patch of each."""

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    patch: NDArray[np.int64]


class Edges(NamedTuple):
    """Edges of triangles: ends (ne, 2), the triangles at both sides (ne, 2), -1 where there is none."""

    ends: NDArray[np.int64]
    faces: NDArray[np.int64]


class Curve(NamedTuple):
    """Points of a piece of the border between patches, from corner to corner, and these patches (-1: none)."""

    points: list[int]
    patches: tuple[int, int]


def edges_of(panels: NDArray[np.int64]) -> Edges:
    """Edges of triangles (n, 3) or panels (n, 4); raise where more than two meet, or two against each other."""
    sides = np.stack([panels, np.roll(panels, -1, axis=1)], axis=2).reshape(-1, 2)
    of = np.repeat(np.arange(len(panels)), panels.shape[1])
    real = sides[:, 0] != sides[:, 1]
    sides, of = sides[real], of[real]
    ends, inverse, count = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True, return_counts=True)
    inverse = inverse.reshape(-1)
    forward = sides[:, 0] < sides[:, 1]
    ahead = np.bincount(inverse[forward], minlength=len(ends))
    if count.max() > 2 or ahead.max() > 1 or (count - ahead).max() > 1:
        raise InputError("edges where more than two triangles meet, or two against each other")
    faces = np.full((len(ends), 2), -1, dtype=np.int64)
    faces[inverse[forward], 0] = of[forward]
    faces[inverse[~forward], 1] = of[~forward]
    return Edges(ends, faces)


def normals_of(surface: HullPanels | PatchedSurface) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions (nt, 3) and areas (nt,) [m^2] of triangles."""
    a, b, c = (surface.points[surface.triangles[:, i]] for i in range(3))
    normal = 0.5 * np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1)
    return normal / np.maximum(area, 1e-300)[:, None], area


def _patches(part: HullPanels, edges: Edges, wide: float) -> NDArray[np.int64]:
    """Number of the patch of each triangle; edges between faces wider than `wide` [m] are knuckles."""
    triangles = part.triangles
    normal, area = normals_of(part)
    inner = np.flatnonzero(edges.faces.min(axis=1) >= 0)
    left, right = edges.faces[inner].T
    turn = np.arctan2(
        np.linalg.norm(np.cross(normal[left], normal[right]), axis=1),
        np.einsum("ij,ij->i", normal[left], normal[right]),
    )
    # a sliver has no direction of its own: it goes with its neighbours
    sliver = area < ON * np.median(area)
    turn[sliver[left] | sliver[right]] = 0.0
    face = joined(len(triangles), edges.faces[inner[turn < FLAT]])
    width = _widths(part.points, triangles, face, area)
    knuckle = (turn > KNUCKLE) & (np.minimum(width[face[left]], width[face[right]]) > wide)
    return joined(len(triangles), edges.faces[inner[~(knuckle | (turn > SHARP))]])


def _widths(
    points: NDArray[np.float64],
    triangles: NDArray[np.int64],
    face: NDArray[np.int64],
    area: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Area of each face divided by its longest extent [m]."""
    count = int(face.max()) + 1
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    corners = points[triangles]
    np.minimum.at(low, face, corners.min(axis=1))
    np.maximum.at(high, face, corners.max(axis=1))
    return np.bincount(face, area, minlength=count) / np.linalg.norm(high - low, axis=1)


def patched(part: HullPanels, wide: float, extent: float) -> PatchedSurface:
    """Patches with one border each: rings and closed ones are cut through their middle, across and along.

    Raises
    ------
    InputError
        Edges of more than two triangles, or patches with many holes.

    Notes
    -----
    Every angle above 5 degrees between faces wider than `wide` [m] is a knuckle that stays; between narrower ones it
    is a curve in facets, up to 30 degrees.
    """
    cuts: list[tuple[int, float]] = []
    for axis in (1, 0, 2, 1, 0):
        edges = edges_of(part.triangles)
        patch = _patches(part, edges, wide)
        for direction, at in cuts:
            patch = _halved(part, edges, patch, direction, at, extent)
        surface = PatchedSurface(part.points, part.triangles, patch)
        rings = [p for p in range(int(patch.max()) + 1) if not _is_disc(part.triangles[patch == p])]
        if not rings:
            return surface
        of = np.isin(patch, rings)
        corners = part.points[part.triangles[of]].reshape(-1, 3)[:, axis]
        middle = 0.5 * float(corners.min() + corners.max())
        cuts.append((axis, middle))
        shift = np.zeros(3)
        shift[axis] = middle
        moved = HullPanels(part.points - shift, part.panels, part.name)
        both = [cut_at_plane(moved, axis), cut_at_plane(moved, axis, above=True)]
        joined = HullPanels(
            np.concatenate([half.points for half in both]),
            np.concatenate([both[0].panels, both[1].panels + len(both[0].points)]),
            part.name,
        )
        joined = triangle_panels(joined.points, joined.triangles, part.name)
        part = HullPanels(joined.points + shift, joined.panels, part.name)
    raise InputError("faces with many holes")


def _is_disc(triangles: NDArray[np.int64]) -> bool:
    """One border: Euler's characteristic is 1."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    edges = np.unique(np.sort(sides, axis=1), axis=0)
    return len(np.unique(triangles)) - len(edges) + len(triangles) == 1


def _halved(
    part: HullPanels, edges: Edges, patch: NDArray[np.int64], axis: int, at: float, extent: float
) -> NDArray[np.int64]:
    """Patches that are no discs, taken apart at a plane in which triangles were cut."""
    triangles = part.triangles
    rings = [p for p in range(int(patch.max()) + 1) if not _is_disc(triangles[patch == p])]
    on = np.abs(part.points[:, axis] - at) <= ON * extent
    inner = np.flatnonzero(edges.faces.min(axis=1) >= 0)
    left, right = patch[edges.faces[inner]].T
    cut = on[edges.ends[inner]].all(axis=1) & np.isin(left, rings)
    return joined(len(triangles), edges.faces[inner[(left == right) & ~cut]])


def flat_patches(surface: PatchedSurface) -> NDArray[np.bool_]:
    """Which patches are flat."""
    normal, area = normals_of(surface)
    count = int(surface.patch.max()) + 1
    mean = np.stack(
        [np.bincount(surface.patch, normal[:, k] * area, minlength=count) for k in range(3)], axis=1
    )
    total = np.bincount(surface.patch, area, minlength=count)
    return np.linalg.norm(mean, axis=1) > np.cos(FLAT) * total


def curves_between(surface: PatchedSurface, extent: float) -> list[Curve]:
    """Pieces of borders between corners; a loop without corners is cut in two places."""
    edges = edges_of(surface.triangles)
    there = edges.faces >= 0
    on = np.abs(surface.points) <= ON * extent
    loose = edges.ends[~there.all(axis=1)]
    if not (on[loose, 2].all(axis=1) | on[loose, 1].all(axis=1)).all():
        raise InputError("edges below the water that neighbours do not share")
    patches = np.where(there, surface.patch[edges.faces], -1)
    border = np.flatnonzero(patches[:, 0] != patches[:, 1])
    # rims in the water and in the plane of symmetry are different curves
    kinds = np.column_stack([np.sort(patches[border], axis=1), np.all(on[edges.ends[border], 1:], axis=1)])
    _, kind = np.unique(kinds, axis=0, return_inverse=True)
    kind = kind.reshape(-1)
    at: dict[int, list[int]] = {}
    for number, (a, b) in enumerate(edges.ends[border].tolist()):
        at.setdefault(a, []).append(number)
        at.setdefault(b, []).append(number)
    ends = edges.ends[border].tolist()

    def other(number: int, vertex: int) -> int:
        a, b = ends[number]
        return int(b if a == vertex else a)

    def is_corner(vertex: int) -> bool:
        around = at[vertex]
        if len(around) != 2 or kind[around[0]] != kind[around[1]]:
            return True
        into = surface.points[vertex] - surface.points[other(around[0], vertex)]
        out = surface.points[other(around[1], vertex)] - surface.points[vertex]
        return bool(np.arctan2(np.linalg.norm(np.cross(into, out)), into @ out) > CORNER)

    corners = {vertex for vertex in at if is_corner(vertex)}
    unused = set(range(len(border)))
    found: list[Curve] = []

    def run(start: int, number: int) -> list[int]:
        chain, vertex = [start], start
        while True:
            unused.discard(number)
            vertex = other(number, vertex)
            chain.append(vertex)
            if vertex in corners or vertex == start:
                return chain
            number = next(n for n in at[vertex] if n != number)

    for vertex in sorted(corners):
        for number in at[vertex]:
            if number in unused:
                a, b = patches[border[number]].tolist()
                found.append(Curve(run(vertex, number), (a, b)))
    while unused:
        number = min(unused)
        a, b = patches[border[number]].tolist()
        # the foremost point, and the one half of the way round
        chain = run(ends[number][0], number)
        first = max(range(len(chain) - 1), key=lambda i: tuple(surface.points[chain[i]].tolist()))
        chain = [*chain[first:-1], *chain[: first + 1]]
        half = _middle_of(surface.points[chain])
        found += [Curve(chain[: half + 1], (a, b)), Curve(chain[half:], (a, b))]
    return found


def along(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance of each point of a polyline from its beginning [m]."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])


def _middle_of(points: NDArray[np.float64]) -> int:
    s = along(points)
    return int(np.clip(np.argmin(np.abs(s - 0.5 * s[-1])), 1, len(points) - 2))


def loops_around(surface: PatchedSurface, curves: list[Curve]) -> list[list[tuple[int, bool]]]:
    """The border of each patch: curves in order, and whether they are run forward, anticlockwise about the normal."""
    triangles = surface.triangles
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    of = {(int(a), int(b)): int(p) for (a, b), p in zip(sides, np.tile(surface.patch, 3), strict=True)}
    loops = []
    members: list[dict[int, tuple[int, bool]]] = [{} for _ in range(int(surface.patch.max()) + 1)]
    for number, curve in enumerate(curves):
        for patch in curve.patches:
            if patch < 0:
                continue
            forward = of.get((curve.points[0], curve.points[1])) == patch
            start = curve.points[0] if forward else curve.points[-1]
            if start in members[patch]:
                raise InputError("patches that touch themselves in a point")
            members[patch][start] = (number, forward)
    for own in members:
        start = vertex = min(own)
        loop = []
        while True:
            number, forward = own[vertex]
            loop.append((number, forward))
            vertex = curves[number].points[-1 if forward else 0]
            if vertex == start:
                break
            if vertex not in own or len(loop) > len(own):
                raise InputError("borders of patches that do not close")
        if len(loop) != len(own):
            raise InputError("patches with holes")
        loops.append(loop)
    return loops


def corners_of(surface: PatchedSurface, curves: list[Curve], loop: list[tuple[int, bool]]) -> list[int]:
    """Positions in a loop where a new side begins."""
    found = []
    for k, (number, forward) in enumerate(loop):
        before, was = loop[k - 1]
        out = curves[number].points if forward else curves[number].points[::-1]
        into = curves[before].points if was else curves[before].points[::-1]
        a = surface.points[into[-1]] - surface.points[into[-2]]
        b = surface.points[out[1]] - surface.points[out[0]]
        if np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b) > CORNER:
            found.append(k)
    return found


def sides_of(loop: list[tuple[int, bool]], corners: list[int]) -> list[list[tuple[int, bool]]]:
    """Curves of the sides between the corners of a loop."""
    turned = [*loop[corners[0] :], *loop[: corners[0]]]
    starts = [k - corners[0] for k in corners] + [len(loop)]
    return [turned[a:b] for a, b in pairwise(starts)]
