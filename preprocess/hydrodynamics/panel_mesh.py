"""Quadrilateral panels of nearly equal size on a wetted surface of triangles, whose edges and knuckles stay.

The surface is taken apart into patches along its edges; curves between them are divided evenly. Patches with four
corners and sides of equal count get a mapped grid (transfinite interpolation), others an unstructured one of
quadrilaterals by gmsh on their own triangles.

Source: Gordon and Hall, "Construction of curvilinear co-ordinate systems and applications to mesh generation", Int. J.
Numer. Methods Eng. 7 (1973); Remacle et al., "Blossom-Quad", Int. J. Numer. Methods Eng. 89 (2012).
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.joined import joined
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.gmsh_session import gmsh_session
from heavylift.preprocess.hydrodynamics.hull_panels import (
    HullPanels,
    cut_at_plane,
    hydrostatics,
    mirrored_panels,
    triangle_panels,
)
from heavylift.preprocess.hydrodynamics.hull_patches import (
    ON,
    along,
    corners_of,
    curves_between,
    edges_of,
    flat_patches,
    loops_around,
    normals_of,
    patched,
    sides_of,
)
from heavylift.preprocess.surfaces.refinement import refined_triangles

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.hull_patches import Curve, PatchedSurface

__all__ = ["PanelMesh", "flat_panels", "hull_panels"]

LIKE_A_RECTANGLE = 1.5
"""Largest ratio of opposite sides of a patch that gets a mapped grid."""
TOLERANCE = 0.01
"""Of volume and water plane, that panels may lose on curved surfaces before they are made smaller."""
SMALLEST = 0.4
"""Of the wanted size: curved patches are refined to this at most."""
ROUNDS = 4
WIDE = 1.5
"""Of the size of a panel: a face that is wider is flat, not a facet of something round."""
LONGEST = 3.0
"""Of the size of a panel: longer sides come from facets that no plane can be wrapped around."""
MOST = 200_000
"""Panels beyond which a size is taken for a slip of units."""


@dataclass(frozen=True, eq=False)
class PanelMesh:
    """Panels of a hull, and how well they stand for it.

    Attributes
    ----------
    hull
        The panels.
    volume, waterplane
        Of the panels relative to the exact surface below the water.
    size
        Of the panels on curved patches relative to the wanted one: less than 1 where volume asked for it.
    curved
        Share of the surface that is curved.
    problem
        Why triangles were halved instead of meshed anew; empty if they were not.
    """

    hull: HullPanels
    volume: float
    waterplane: float
    size: float
    curved: float
    problem: str = ""


def hull_panels(wetted: HullPanels, size: float, *, symmetric: bool = False) -> PanelMesh:
    """Panels of about one size on a wetted hull.

    Parameters
    ----------
    wetted
        The exact surface below z = 0, of triangles of any size and shape.
    size
        Side of a panel [m]. Panels of curved patches are smaller if volume or water plane would be off by more
        than 1 %.
    symmetric
        The surface is symmetric about y = 0: one half is meshed and mirrored.

    Raises
    ------
    InputError
        If the size is not positive or gives more than 200,000 panels.

    Notes
    -----
    Surfaces that cannot be taken apart (edges of more than two triangles, patches that gmsh cannot flatten) keep
    their triangles, of which the longest sides are halved; `PanelMesh.problem` says why.
    """
    if not 0.0 < size < np.inf:
        raise InputError(f"{size!r}", source=wetted.name, key="size", expected="a length > 0 [m]")
    exact = hydrostatics(wetted, 1.0, 1.0, np.zeros(3))
    part = cut_at_plane(wetted, 1) if symmetric else wetted
    if normals_of(part)[1].sum() > MOST * size**2:
        raise InputError(
            f"{size:g} m gives more than {MOST} panels",
            source=wetted.name,
            key="size",
            expected="a larger size [m]",
        )
    relative, curved, problem = 1.0, 0.0, ""
    try:
        for _ in range(ROUNDS):
            meshed, curved = _meshed(part, size, relative * size)
            off = _off(mirrored_panels(meshed) if symmetric else meshed, exact)
            if off <= TOLERANCE or relative <= SMALLEST:
                break
            # flat panels lose with the square of their size
            relative = max(SMALLEST, relative * min(0.9, 0.95 * float(np.sqrt(TOLERANCE / off))))
        if off > 2.0 * TOLERANCE:
            problem = f"new panels would change the hull by {off:.1%}"
    except InputError as error:
        problem = error.problem
    if problem:
        points, triangles = refined_triangles(part.points, part.triangles, size, name=wetted.name)
        meshed, relative = triangle_panels(points, triangles, wetted.name), 1.0
    hull = mirrored_panels(meshed) if symmetric else meshed
    found = hydrostatics(hull, 1.0, 1.0, np.zeros(3))
    plane = exact.stiffness[2, 2]
    return PanelMesh(
        hull,
        found.volume / exact.volume,
        found.stiffness[2, 2] / plane if plane > ON * exact.volume ** (2.0 / 3.0) else 1.0,
        relative,
        curved,
        problem,
    )


def flat_panels(plane: HullPanels, size: float, *, symmetric: bool = False) -> HullPanels:
    """Panels of about one size on flat triangles, with their border; as `hull_panels`, but without a volume.

    Raises
    ------
    InputError
        If the triangles have no clear border.
    """
    part = cut_at_plane(plane, 1) if symmetric else plane
    meshed, _ = _meshed(part, size, size)
    return mirrored_panels(meshed) if symmetric else meshed


def _off(hull: HullPanels, exact: Any) -> float:
    """Largest relative difference of volume and water plane."""
    found = hydrostatics(hull, 1.0, 1.0, np.zeros(3))
    off = abs(found.volume / exact.volume - 1.0)
    if exact.stiffness[2, 2] > ON * exact.volume ** (2.0 / 3.0):
        off = max(off, abs(found.stiffness[2, 2] / exact.stiffness[2, 2] - 1.0))
    return float(off)


def _meshed(part: HullPanels, size: float, curved_size: float) -> tuple[HullPanels, float]:
    """New panels of a surface, each of its separate parts by itself, and how much of it is curved.

    Raises
    ------
    InputError
        If its edges or patches cannot be found, or gmsh fails.
    """
    extent = float(np.ptp(part.points, axis=0).max())
    triangles = part.triangles
    label = joined(len(part.points), np.concatenate([triangles[:, :2], triangles[:, 1:]]))[triangles[:, 0]]
    hulls, curved, whole = [], 0.0, 0.0
    for number in np.unique(label):
        own = triangle_panels(part.points, triangles[label == number], part.name)
        hull, round_area, area = _meshed_part(own, size, curved_size, WIDE * size, extent)
        if hull.longest_side > LONGEST * size:
            # few facets at odd angles: every one is a face of its own
            hull, round_area, area = _meshed_part(own, size, curved_size, 0.0, extent)
        if hull.longest_side > LONGEST * size:
            raise InputError(f"sides of {hull.longest_side:.3g} m")
        hulls.append((hull.points, hull.panels))
        curved, whole = curved + round_area, whole + area
    return _joined_panels(hulls, part.name, extent), curved / whole


def _meshed_part(
    part: HullPanels, size: float, curved_size: float, wide: float, extent: float
) -> tuple[HullPanels, float, float]:
    """The same of a connected surface: panels, curved area, area [m^2]."""
    surface = patched(part, wide, extent)
    curves = curves_between(surface, extent)
    loops = loops_around(surface, curves)
    flat = flat_patches(surface)
    sizes = np.where(flat, size, curved_size)
    corners = [corners_of(surface, curves, loop) for loop in loops]
    counts = _counts(surface, curves, loops, corners, sizes)
    areas = np.bincount(surface.patch, normals_of(surface)[1], minlength=len(flat))
    grids = _generated(surface, curves, loops, corners, counts, flat, sizes, part.name)
    hull = _joined_panels(grids, part.name, extent)
    _same_border(surface, hull, extent)
    return hull, float(areas[~flat].sum()), float(areas.sum())


def _border_length(points: NDArray[np.float64], panels: NDArray[np.int64]) -> float:
    edges = edges_of(panels)
    ends = points[edges.ends[edges.faces.min(axis=1) < 0]]
    return float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum())


def _same_border(surface: PatchedSurface, hull: HullPanels, extent: float) -> None:
    """Raise if neighbours in the new panels do not share their corners."""
    before = _border_length(surface.points, surface.triangles)
    after = _border_length(hull.points, hull.panels)
    # a border in chords is a little shorter; a seam that opens counts twice
    if after > before + ON * extent:
        raise InputError("seams that do not close")


def _counts(
    surface: PatchedSurface,
    curves: list[Curve],
    loops: list[list[tuple[int, bool]]],
    corners: list[list[int]],
    sizes: NDArray[np.float64],
) -> list[int]:
    """Panels along each curve; opposite sides of patches like rectangles get the same."""
    length = [float(along(surface.points[curve.points])[-1]) for curve in curves]
    counts = []
    for number, curve in enumerate(curves):
        size = min(float(sizes[p]) for p in curve.patches if p >= 0)
        counts.append(max(1, int(np.ceil(length[number] / size * (1.0 - 1e-6)))))
    pairs = []
    for loop, turns in zip(loops, corners, strict=True):
        if len(turns) != 4:
            continue
        sides = sides_of(loop, turns)
        for one, other in ((sides[0], sides[2]), (sides[1], sides[3])):
            lengths = [sum(length[n] for n, _ in side) for side in (one, other)]
            if max(lengths) > LIKE_A_RECTANGLE * min(lengths):
                break
        else:
            for one, other in ((sides[0], sides[2]), (sides[1], sides[3])):
                if len(one) == len(other) == 1:
                    pairs.append((one[0][0], other[0][0]))
    if pairs:
        same = joined(len(curves), np.array(pairs))
        most = np.zeros(int(same.max()) + 1, dtype=np.int64)
        np.maximum.at(most, same, counts)
        counts = most[same].tolist()
    return counts


def _evenly(points: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Points at equal distances along a polyline, its ends included."""
    s = along(points)
    at = np.linspace(0.0, s[-1], count + 1)
    return np.stack([np.interp(at, s, points[:, k]) for k in range(3)], axis=1)


def _generated(
    surface: PatchedSurface,
    curves: list[Curve],
    loops: list[list[tuple[int, bool]]],
    corners: list[list[int]],
    counts: list[int],
    flat: NDArray[np.bool_],
    sizes: NDArray[np.float64],
    name: str,
) -> list[tuple[NDArray[np.float64], NDArray[np.int64]]]:
    """Points and panels of each patch."""
    nodes = [
        _evenly(surface.points[curve.points], count) for curve, count in zip(curves, counts, strict=True)
    ]
    found: list[tuple[NDArray[np.float64], NDArray[np.int64]]] = []
    for patch, loop in enumerate(loops):
        sides = sides_of(loop, corners[patch]) if len(corners[patch]) == 4 else []
        borders = [_chain(nodes, side) for side in sides]
        grid = None
        if borders and len(borders[0]) == len(borders[2]) and len(borders[1]) == len(borders[3]):
            grid = _mapped(surface, patch, borders, flat=bool(flat[patch]))
        if grid is None:
            size, plane = float(sizes[patch]), bool(flat[patch])
            grid = _unstructured(surface, curves, loop, nodes, patch, flat=plane, size=size, name=name)
        found.append(grid)
    return found


def _joined_panels(
    grids: list[tuple[NDArray[np.float64], NDArray[np.int64]]], name: str, extent: float
) -> HullPanels:
    """One hull; corners in one place get one number."""
    starts = np.cumsum([0] + [len(points) for points, _ in grids])
    points = np.concatenate([points for points, _ in grids])
    panels = np.concatenate([panels + start for (_, panels), start in zip(grids, starts[:-1], strict=True)])
    points = np.where(np.abs(points) <= ON * extent, 0.0, points)
    _, index, inverse = np.unique(
        np.round(points / (ON * extent)).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    return HullPanels(points[index], inverse.reshape(-1)[panels], name)


def _chain(nodes: list[NDArray[np.float64]], side: list[tuple[int, bool]]) -> NDArray[np.float64]:
    """Nodes of several curves in a row, each once."""
    rows = [nodes[number] if forward else nodes[number][::-1] for number, forward in side]
    return np.concatenate([*(row[:-1] for row in rows), rows[-1][-1:]])


def _mapped(
    surface: PatchedSurface, patch: int, borders: list[NDArray[np.float64]], *, flat: bool
) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
    """Grid between four sides, on the patch; None if its panels would be folded or very skew."""
    south, east, north, west = borders[0], borders[1], borders[2][::-1], borders[3][::-1]
    u = np.linspace(0.0, 1.0, len(south))[:, None, None]
    v = np.linspace(0.0, 1.0, len(west))[None, :, None]
    points = (
        (1 - v) * south[:, None]
        + v * north[:, None]
        + (1 - u) * west[None]
        + u * east[None]
        - (1 - u) * (1 - v) * south[0]
        - u * (1 - v) * south[-1]
        - (1 - u) * v * north[0]
        - u * v * north[-1]
    )
    points[:, 0], points[:, -1], points[0], points[-1] = south, north, west, east
    own = surface.triangles[surface.patch == patch]
    if not flat and min(points.shape[:2]) > 2:
        inner = points[1:-1, 1:-1].reshape(-1, 3)
        points[1:-1, 1:-1] = _closest(inner, surface.points[own]).reshape(points[1:-1, 1:-1].shape)
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    turns = np.stack(
        [np.cross(q - p, r - q) for p, q, r in ((a, b, c), (b, c, d), (c, d, a), (d, a, b))]
    ).reshape(4, -1, 3)
    sides = np.stack(
        [
            np.linalg.norm(q - p, axis=-1) * np.linalg.norm(r - q, axis=-1)
            for p, q, r in ((a, b, c), (b, c, d), (c, d, a), (d, a, b))
        ]
    ).reshape(4, -1)
    mean = turns.mean(axis=0)
    mean /= np.maximum(np.linalg.norm(mean, axis=1), 1e-300)[:, None]
    if np.any(np.einsum("kij,ij->ki", turns, mean) < SKEW * sides):
        return None
    number = np.arange(points.shape[0] * points.shape[1]).reshape(points.shape[:2])
    panels = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1)
    return points.reshape(-1, 3), panels.reshape(-1, 4)


SKEW = 0.35
"""Sine of the smallest angle of a panel in a mapped grid."""


def _closest(points: NDArray[np.float64], corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Nearest places on triangles (nt, 3, 3) to points (n, 3)."""
    import trimesh

    found = np.empty_like(points)
    middle = corners.mean(axis=1)
    reach = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
    for row, point in enumerate(points):
        off = np.linalg.norm(middle - point, axis=1)
        # none is nearer than its middle less its reach; all others are farther than the nearest middle
        own = corners[off - reach <= off.min()]
        near = trimesh.triangles.closest_point(own, np.tile(point, (len(own), 1)))
        found[row] = near[np.argmin(np.einsum("ij,ij->i", near - point, near - point))]
    return found


def _plane_patch(gmsh: Any, loop: list[tuple[NDArray[np.float64], bool]]) -> None:
    """A flat face: straight lines between the nodes of its border."""
    border = np.concatenate([(nodes if forward else nodes[::-1])[:-1] for nodes, forward in loop])
    points = [gmsh.model.geo.addPoint(*place) for place in border.tolist()]
    lines = [gmsh.model.geo.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]
    gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(lines)])
    gmsh.model.geo.synchronize()
    for line in lines:
        gmsh.model.mesh.setTransfiniteCurve(line, 2)


def _curved_patch(
    gmsh: Any,
    surface: PatchedSurface,
    patch: int,
    chains: list[tuple[list[int], bool, int]],
) -> None:
    """Triangles of a patch, and its border in curves (points, forward, count), as a discrete surface."""
    own = surface.triangles[surface.patch == patch]
    used = np.unique(own)
    tag = {int(v): k + 1 for k, v in enumerate(used)}
    corner: dict[int, int] = {}
    for chain, _, _ in chains:
        for v in (chain[0], chain[-1]):
            if v not in corner:
                corner[v] = gmsh.model.addDiscreteEntity(0, len(corner) + 1)
                gmsh.model.setCoordinates(corner[v], *surface.points[v].tolist())
    for k, (chain, _, _) in enumerate(chains, start=1):
        gmsh.model.addDiscreteEntity(1, k, [corner[chain[0]], corner[chain[-1]]])
    border = [k if forward else -k for k, (_, forward, _) in enumerate(chains, start=1)]
    gmsh.model.addDiscreteEntity(2, 1, border)
    gmsh.model.mesh.addNodes(2, 1, list(tag.values()), surface.points[used].ravel())
    for v, point in corner.items():
        gmsh.model.mesh.addElementsByType(point, _POINT, [], [tag[v]])
    for k, (chain, _, _) in enumerate(chains, start=1):
        ends = [tag[v] for pair in itertools.pairwise(chain) for v in pair]
        gmsh.model.mesh.addElementsByType(k, _LINE, [], ends)
    gmsh.model.mesh.addElementsByType(1, _TRIANGLE, [], [tag[v] for v in own.ravel().tolist()])
    gmsh.model.mesh.reclassifyNodes()
    gmsh.model.mesh.createGeometry()
    for k, (_, _, count) in enumerate(chains, start=1):
        gmsh.model.mesh.setTransfiniteCurve(k, count + 1)


_LINE, _TRIANGLE, _QUADRILATERAL, _POINT = 1, 2, 3, 15
"""gmsh's numbers of elements."""


def _unstructured(
    surface: PatchedSurface,
    curves: list[Curve],
    loop: list[tuple[int, bool]],
    nodes: list[NDArray[np.float64]],
    patch: int,
    *,
    flat: bool,
    size: float,
    name: str,
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Quadrilaterals by gmsh between the nodes of the border of a patch."""
    with gmsh_session(name) as gmsh:
        if flat:
            _plane_patch(gmsh, [(nodes[n], forward) for n, forward in loop])
        else:
            chains = [(curves[n].points, forward, len(nodes[n]) - 1) for n, forward in loop]
            _curved_patch(gmsh, surface, patch, chains)
        for option, value in _OPTIONS.items():
            gmsh.option.setNumber(option, value)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.MeshSizeMin", size)
        gmsh.model.mesh.generate(2)
        tags, places, _ = gmsh.model.mesh.getNodes()
        places = places.reshape(-1, 3)
        place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        place[tags.astype(np.int64)] = np.arange(len(tags))
        if not flat:
            # the nodes of the curves are those that neighbours have
            for k, (number, _) in enumerate(loop, start=1):
                own, _, at = gmsh.model.mesh.getNodes(1, k)
                inner = nodes[number][1:-1]
                if len(own) != len(inner):
                    raise InputError("a border that gmsh divides otherwise")
                places[place[own[np.argsort(at)].astype(np.int64)]] = inner
        rows = []
        for kind, corners in ((_QUADRILATERAL, 4), (_TRIANGLE, 3)):
            _, connectivity = gmsh.model.mesh.getElementsByType(kind)
            found = place[connectivity.astype(np.int64)].reshape(-1, corners)
            rows.append(found if corners == 4 else np.column_stack([found, found[:, 2]]))
    panels = np.concatenate(rows)
    if len(panels) == 0:
        raise InputError("a patch without panels")
    own = surface.triangles[surface.patch == patch]
    outward, _ = _area_vector(surface.points, own)
    there, _ = _area_vector(places, HullPanels(places, panels, name).triangles)
    if outward @ there < 0.0:
        panels = np.where((panels[:, 2] == panels[:, 3])[:, None], panels[:, [1, 0, 2, 2]], panels[:, ::-1])
    return places, panels


_OPTIONS = {
    "Mesh.MeshSizeFromPoints": 0,
    "Mesh.MeshSizeExtendFromBoundary": 0,
    "Mesh.Algorithm": 8,  # frontal Delaunay for quadrilaterals
    "Mesh.RecombineAll": 1,
    "Mesh.RecombinationAlgorithm": 1,  # blossom
}


def _area_vector(
    points: NDArray[np.float64], triangles: NDArray[np.int64]
) -> tuple[NDArray[np.float64], float]:
    """Sum of area vectors, and of areas."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    each = 0.5 * np.cross(b - a, c - a)
    return each.sum(axis=0), float(np.linalg.norm(each, axis=1).sum())
