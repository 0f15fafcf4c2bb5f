"""Parametric solids made of axis-aligned boxes: union of some minus others, as tetrahedra or bricks."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.memory import refuse_beyond_memory
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.gmsh_session import gmsh_session, mesh_tetrahedra
from heavylift.preprocess.finite_elements.groups import AXES, InBox, NodeSelector, OnFace, select_nodes
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.finite_elements.refinement import CurveSize, Refinement, curves_of_groups

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

__all__ = ["Box", "mesh_blocks"]

_Point = tuple[float, float, float]
BRICK_BYTES, BRICK_SECONDS = 8e3, 56e-6
"""Of a brick, meshed and assembled; measured on cubes of 27,000 and 216,000 of them."""
BEYOND = 1e18
"""Elements along an edge that nobody has memory for."""
_SNAP = 1e-9  # coordinates closer than this, in diagonals of the body, are one plane


@dataclass(frozen=True)
class Box:
    """An axis-aligned box.

    Parameters
    ----------
    name
        Name, unique within a body; its faces are ``"NAME.x_min"`` ... ``"NAME.z_max"``.
    lower, upper
        Opposite corners [m], lower < upper in every direction.

    Raises
    ------
    InputError
        A box without volume, or a corner that is not finite.
    """

    name: str
    lower: tuple[float, float, float]
    upper: tuple[float, float, float]

    def __post_init__(self) -> None:
        lower, upper = np.asarray(self.lower, dtype=float), np.asarray(self.upper, dtype=float)
        good = lower.shape == upper.shape == (3,) and np.isfinite([lower, upper]).all()
        if not good or (lower >= upper).any():
            raise InputError(
                f"lower {self.lower!r}, upper {self.upper!r}",
                source=f"box {self.name!r}",
                expected="two corners of three finite coordinates, lower < upper in every direction",
            )


def mesh_blocks(
    add: Sequence[Box],
    cut: Sequence[Box] = (),
    *,
    element_type: str = "tet10",
    size: float | None = None,
    divisions: Mapping[str, Sequence[int]] | None = None,
    breaks: Mapping[str, Sequence[float]] | None = None,
    groups: Sequence[NodeSelector] = (),
    refine: Sequence[Refinement] = (),
    name: str = "blocks",
) -> Mesh:
    """Mesh the union of the boxes `add` minus the boxes `cut`.

    Parameters
    ----------
    add, cut
        Boxes to unite, and boxes to remove from the union.
    element_type
        ``"tet10"``: unstructured straight-sided tetrahedra by gmsh. ``"hex8"``: the tensor grid through all
        faces of all boxes, cells outside the solid left out.
    size
        Target edge length [m]. Default: half the smallest distance between two parallel planes of the
        boxes, but no more than a tenth of the largest extent, so that every wall has two quadratic
        elements.
    divisions
        For ``hex8``: numbers of elements in the intervals between the planes along ``"x"``, ``"y"``,
        ``"z"``; a missing axis is divided by `size`.
    breaks
        For ``hex8``: coordinates of the grid planes along an axis [m], ascending; must contain every plane
        of the boxes along it. Default: just those planes.
    groups
        Node groups to name.
    refine
        For ``tet10``: smaller elements along re-entrant edges and the edges of groups.
    name
        Named in messages.

    Returns
    -------
    Mesh
        Checked; with the groups asked for.

    Raises
    ------
    InputError
        No box, nothing left after the cuts, divisions that do not fit the intervals, a size that is not
        positive, an empty group, parts that are not joined, or whatever gmsh refuses.
    """
    if not add:
        raise InputError("no box to add", source=name, key="add", expected="at least one box")
    names = [box.name for box in (*add, *cut)]
    repeated = next((n for n in names if names.count(n) > 1), None)
    if repeated is not None:
        raise InputError(f"box {repeated!r} is given twice", source=name, expected="one box a name")
    planes = {axis: _planes([*add, *cut], k, _diagonal(add)) for axis, k in AXES.items()}
    for axis, values in planes.items():
        if len(values) < 2:
            raise InputError(
                f"along {axis} all boxes are thinner than {_SNAP:g} of their diagonal, {_diagonal(add):.3g} m",
                source=name,
                key="add",
                expected="boxes of one size (a unit that is missing?)",
            )
    if size is None:
        size = _default_size(add, planes)
    if not (np.isfinite(size) and size > 0.0):
        raise InputError(f"{size!r}", source=name, key="size", expected="a positive length in m")
    if element_type == "hex8":
        if refine:
            raise InputError(
                "bricks cannot be refined locally",
                source=name,
                key="refine",
                expected="'divisions' or 'breaks'",
            )
        mesh = _bricks(add, cut, planes, size, divisions or {}, breaks or {}, name)
    elif element_type == "tet10":
        if divisions or breaks:
            raise InputError(
                "tetrahedra are not structured",
                source=name,
                key="divisions" if divisions else "breaks",
                expected="a target 'size', or element_type 'hex8'",
            )
        mesh = _tetrahedra(add, cut, size, groups, refine, name)
    else:
        raise InputError(f"{element_type!r}", source=name, key="element_type", expected="'tet10' or 'hex8'")
    mesh.check()
    return mesh.with_groups(
        select_nodes(mesh.nodes, groups, faces=_box_faces(mesh.nodes, add, cut), source=name)
    )


def _diagonal(add: Sequence[Box]) -> float:
    lower = np.min([box.lower for box in add], axis=0)
    upper = np.max([box.upper for box in add], axis=0)
    return float(np.linalg.norm(upper - lower))


def _planes(boxes: Sequence[Box], k: int, diagonal: float) -> NDArray[np.float64]:
    """Distinct coordinates of the faces across axis k, ascending."""
    values = np.unique([value for box in boxes for value in (box.lower[k], box.upper[k])])
    keep = np.concatenate([[True], np.diff(values) > _SNAP * diagonal])
    return values[keep].astype(np.float64)


def _default_size(add: Sequence[Box], planes: Mapping[str, NDArray[np.float64]]) -> float:
    smallest = min(float(np.diff(values).min()) for values in planes.values())
    extent = max(np.max([b.upper[k] for b in add]) - np.min([b.lower[k] for b in add]) for k in range(3))
    return min(0.5 * smallest, 0.1 * float(extent))


def _inside(points: NDArray[np.float64], boxes: Sequence[Box]) -> NDArray[np.bool_]:
    inside = np.zeros(len(points), dtype=bool)
    for box in boxes:
        inside |= ((points > np.asarray(box.lower)) & (points < np.asarray(box.upper))).all(axis=1)
    return inside


def _box_faces(
    nodes: NDArray[np.float64], add: Sequence[Box], cut: Sequence[Box]
) -> dict[str, NDArray[np.int64]]:
    """Nodes on every face of every box; a face that the union swallowed may have none."""
    tolerance = 1e-6 * _diagonal(add)
    faces = {}
    for face, (lower, upper) in _flat_boxes(add, cut).items():
        within = (nodes >= np.asarray(lower) - tolerance) & (nodes <= np.asarray(upper) + tolerance)
        faces[face] = np.flatnonzero(within.all(axis=1))
    return faces


def _point(values: Sequence[float]) -> _Point:
    x, y, z = values
    return x, y, z


def _flat_boxes(add: Sequence[Box], cut: Sequence[Box]) -> dict[str, tuple[_Point, _Point]]:
    """Every face of every box by its name, as a box without thickness."""
    flat = {}
    for box in (*add, *cut):
        for axis, k in AXES.items():
            # the one coordinate across the face: that of the other corner
            at_min = (*box.upper[:k], box.lower[k], *box.upper[k + 1 :])
            at_max = (*box.lower[:k], box.upper[k], *box.lower[k + 1 :])
            flat[f"{box.name}.{axis}_min"] = (box.lower, _point(at_min))
            flat[f"{box.name}.{axis}_max"] = (_point(at_max), box.upper)
    return flat


def _tetrahedra(
    add: Sequence[Box],
    cut: Sequence[Box],
    size: float,
    groups: Sequence[NodeSelector],
    refine: Sequence[Refinement],
    name: str,
) -> Mesh:
    # OpenCASCADE's tolerance is 1e-7 in units of the model: work on a body about 1000 long
    scale = 1000.0 / _diagonal(add)
    with gmsh_session(name) as gmsh:
        occ = gmsh.model.occ

        def volumes(boxes: Sequence[Box]) -> list[tuple[int, int]]:
            tags = []
            for box in boxes:
                lower, upper = scale * np.asarray(box.lower), scale * np.asarray(box.upper)
                tags.append((3, occ.addBox(*lower, *(upper - lower))))
            return tags

        solid = volumes(add)
        if len(solid) > 1:
            solid, _ = occ.fuse(solid[:1], solid[1:])
        if cut:
            solid, _ = occ.cut(solid, volumes(cut))
        occ.synchronize()
        if not gmsh.model.getEntities(3):
            raise InputError("nothing is left after the cuts", source=name, key="cut")
        wishes = _curve_sizes(gmsh, scale, add, cut, groups, refine, name) if refine else []
        nodes, elements, _ = mesh_tetrahedra(gmsh, scale * size, source=name, refine=wishes)
    nodes = nodes / scale
    # put surface nodes exactly on the planes they were meshed on
    for k in range(3):
        for value in _planes([*add, *cut], k, _diagonal(add)):
            nodes[np.abs(nodes[:, k] - value) < _SNAP * _diagonal(add), k] = value
    return Mesh(nodes, elements, "tet10", name=name)


def _curve_sizes(
    gmsh: Any,
    scale: float,
    add: Sequence[Box],
    cut: Sequence[Box],
    groups: Sequence[NodeSelector],
    refine: Sequence[Refinement],
    name: str,
) -> list[CurveSize]:
    """Curves and sizes of the refinements, in units of gmsh's model."""
    boxes = {tag: np.array(gmsh.model.getBoundingBox(1, tag)) / scale for _, tag in gmsh.model.getEntities(1)}
    # the faces of boxes are known by their nodes only after meshing: say them as boxes
    selectors: list[NodeSelector] = []
    flat = _flat_boxes(add, cut)
    for group in groups:
        if isinstance(group, OnFace) and group.face in flat:
            selectors.append(InBox(group.name, *flat[group.face]))
        else:
            selectors.append(group)
    edges = [tag for tag, box in boxes.items() if _is_re_entrant(box, add, cut)]
    found = curves_of_groups(boxes, refine, selectors, {}, edges, name)
    return [CurveSize(curves, scale * item.size, item.growth) for curves, item in found]


def _is_re_entrant(edge: NDArray[np.float64], add: Sequence[Box], cut: Sequence[Box]) -> bool:
    """Whether three of the four quadrants around an edge, given by its bounding box, are filled."""
    along = int(np.argmax(edge[3:] - edge[:3]))
    first, second = (k for k in range(3) if k != along)
    quadrants = np.tile(0.5 * (edge[:3] + edge[3:]), (4, 1))
    step = 1e-6 * _diagonal(add)
    quadrants[:, first] += step * np.array([-1, -1, 1, 1])
    quadrants[:, second] += step * np.array([-1, 1, -1, 1])
    return int((_inside(quadrants, add) & ~_inside(quadrants, cut)).sum()) == 3


def _bricks(
    add: Sequence[Box],
    cut: Sequence[Box],
    planes: Mapping[str, NDArray[np.float64]],
    size: float,
    divisions: Mapping[str, Sequence[int]],
    breaks: Mapping[str, Sequence[float]],
    name: str,
) -> Mesh:
    for key, given in (("divisions", divisions), ("breaks", breaks)):
        for axis in given:
            if axis not in AXES:
                raise InputError(f"axis {axis!r}", source=name, key=key, expected="'x', 'y' or 'z'")
    tolerance = _SNAP * _diagonal(add)
    grids = {axis: _grid_planes(axis, planes[axis], breaks, tolerance, name) for axis in AXES}
    counts = {axis: _divisions(axis, grids[axis], size, divisions.get(axis), name) for axis in AXES}
    most = max(AXES, key=lambda axis: sum(counts[axis]))
    refuse_beyond_memory(
        math.prod(float(sum(one)) for one in counts.values()),
        "bricks",
        bytes_each=BRICK_BYTES,
        seconds_each=BRICK_SECONDS,
        source=name,
        key=f"divisions.{most}" if most in divisions else "size",
        remedy="fewer divisions" if most in divisions else "a larger size",
    )
    x, y, z = (_grid_lines(grids[axis], counts[axis]) for axis in AXES)
    middles = [0.5 * (line[:-1] + line[1:]) for line in (x, y, z)]
    cells = np.stack(np.meshgrid(*middles, indexing="ij"), axis=-1).reshape(-1, 3)
    keep = _inside(cells, add) & ~_inside(cells, cut)
    if not keep.any():
        raise InputError("nothing is left after the cuts", source=name, key="cut")
    nx, ny, nz = (len(line) for line in (x, y, z))
    index = np.arange(nx * ny * nz).reshape(nx, ny, nz)
    corner = (slice(None, -1), slice(1, None))
    order = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    elements = np.stack([index[corner[i], corner[j], corner[k]].ravel() for i, j, k in order], axis=1)[keep]
    used, elements_flat = np.unique(elements, return_inverse=True)
    nodes = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)[used]
    return Mesh(nodes, elements_flat.reshape(-1, 8), "hex8", name=name)


def _grid_planes(
    axis: str,
    planes: NDArray[np.float64],
    breaks: Mapping[str, Sequence[float]],
    tolerance: float,
    name: str,
) -> NDArray[np.float64]:
    if axis not in breaks:
        return planes
    lines = np.asarray(breaks[axis], dtype=np.float64)
    if lines.ndim != 1 or not np.isfinite(lines).all() or (np.diff(lines) <= tolerance).any():
        raise InputError(
            f"{list(breaks[axis])}", source=name, key=f"breaks.{axis}", expected="ascending coordinates in m"
        )
    for plane in planes:
        nearest = int(np.argmin(np.abs(lines - plane)))
        if abs(lines[nearest] - plane) > tolerance:
            raise InputError(
                f"no grid plane at {plane:.9g} m, where a box ends",
                source=name,
                key=f"breaks.{axis}",
                expected="every face of a box on a grid plane: " + ", ".join(f"{p:.9g}" for p in planes),
            )
        lines[nearest] = plane
    return lines


def _divisions(
    axis: str, planes: NDArray[np.float64], size: float, counts: Sequence[int] | None, name: str
) -> list[int]:
    """Numbers of equal elements in the intervals between planes."""
    intervals = len(planes) - 1
    if counts is None:
        # the small allowance keeps 20 mm / 5 mm at four elements
        return [max(1, math.ceil(min(d / size, BEYOND) - 1e-9)) for d in np.diff(planes).tolist()]
    if len(counts) != intervals or any(int(c) != c or c < 1 for c in counts):
        raise InputError(
            f"{list(counts)}",
            source=name,
            key=f"divisions.{axis}",
            expected=f"{intervals} positive whole numbers, one an interval between the planes "
            + ", ".join(f"{p:.9g}" for p in planes)
            + " m",
        )
    return [int(count) for count in counts]


def _grid_lines(planes: NDArray[np.float64], counts: Sequence[int]) -> NDArray[np.float64]:
    """Divide each interval between planes into equal elements."""
    parts = [
        np.linspace(a, b, count + 1)[:-1] for (a, b), count in zip(pairwise(planes), counts, strict=True)
    ]
    return np.concatenate([*parts, planes[-1:]])
