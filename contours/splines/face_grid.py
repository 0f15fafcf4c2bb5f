"""Nodes of a mesh as contours: a flat face that is a grid, a straight line, a circle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.contours.splines.checks import inward_share
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["TOLERANCE", "circle_nodes", "face_grid", "face_normal", "line_nodes", "plane_nodes"]

TOLERANCE = 1e-6
"""Relative to the size of the body: coordinates of printed meshes have seven digits."""

AXES = {"x": 0, "y": 1, "z": 2}

GRID_HELP = (
    "nodes in rows and columns (a mesh of bricks, a part of the face by 'from' and 'to', or a node matrix)"
)


def _tolerance(nodes: NDArray[np.float64], tolerance: float | None) -> float:
    """Given, or `TOLERANCE` of the largest extent [m]."""
    return TOLERANCE * float(np.ptp(nodes, axis=0).max()) if tolerance is None else tolerance


def plane_nodes(
    nodes: NDArray[np.float64],
    axis: str,
    at: float,
    *,
    lower: NDArray[np.float64] | None = None,
    upper: NDArray[np.float64] | None = None,
    tolerance: float | None = None,
    source: str = "contour",
) -> NDArray[np.int64]:
    """Nodes on a plane across a coordinate axis.

    Parameters
    ----------
    nodes
        Of the mesh, body frame [m], shape (n, 3).
    axis, at
        ``"x"``, ``"y"`` or ``"z"``, and the coordinate of the plane [m].
    lower, upper
        Corners of a box; nodes outside are left out.
    tolerance
        [m]; a millionth of the body if absent.
    source
        Name of the contour, for messages.

    Returns
    -------
    NDArray
        Indices from 0.

    Raises
    ------
    InputError
        There are none; the nearest plane that has some is named.
    """
    near = _tolerance(nodes, tolerance)
    inside = np.ones(len(nodes), dtype=bool)
    if lower is not None:
        inside &= np.all(nodes >= np.asarray(lower) - near, axis=1)
    if upper is not None:
        inside &= np.all(nodes <= np.asarray(upper) + near, axis=1)
    if not np.any(inside):
        low, high = nodes.min(axis=0), nodes.max(axis=0)
        raise InputError(
            "no node lies between 'from' and 'to'",
            source=source,
            expected=f"a box that meets the body, {low.tolist()} to {high.tolist()} m",
        )
    distance = np.abs(nodes[:, AXES[axis]] - at)
    found = np.flatnonzero(inside & (distance <= near))
    if found.size == 0:
        nearest = nodes[np.flatnonzero(inside)[np.argmin(distance[inside])], AXES[axis]]
        raise InputError(
            f"no node has {axis} = {at:g} m",
            source=source,
            expected=f"a plane of nodes, the nearest is {axis} = {nearest:.9g} m",
        )
    return found


def _levels(values: NDArray[np.float64], near: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Different values in rising order, and which of them each value is."""
    order = np.argsort(values, kind="stable")
    jumps = np.diff(values[order]) > near
    rank = np.concatenate([[0], np.cumsum(jumps)])
    which = np.empty(values.size, dtype=np.int64)
    which[order] = rank
    return values[order][np.concatenate([[True], jumps])], which


def _directions(normal: NDArray[np.float64], flat: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Candidates of the first direction of a grid in a plane: coordinate axes, then the edges at a corner."""
    candidates = []
    along = int(np.argmax(np.abs(normal)))
    for axis in ((along + 1) % 3, (along + 2) % 3, along):
        direction = np.eye(3)[axis] - normal[axis] * normal
        candidates.append(direction)
    corner = flat[np.argmax(np.linalg.norm(flat - flat.mean(axis=0), axis=1))]
    ways = flat - corner
    candidates += list(ways[np.argsort(np.linalg.norm(ways, axis=1))[1:4]])
    units = [way / np.linalg.norm(way) for way in candidates if np.linalg.norm(way) > 1e-9]
    return [way for way in units if np.all(np.isfinite(way))]


def face_grid(
    nodes: NDArray[np.float64],
    members: NDArray[np.int64],
    *,
    outward: NDArray[np.float64] | None = None,
    tolerance: float | None = None,
    source: str = "contour",
) -> NDArray[np.int64]:
    """Put the nodes of a flat face into rows and columns, the normal of the grid out of the material.

    Parameters
    ----------
    nodes
        Of the mesh, body frame [m], shape (n, 3).
    members
        Indices of the nodes of the face.
    outward
        Direction out of the material, shape (3,); found from the other nodes of the body if absent.
    tolerance
        Of coordinates [m]; a millionth of the body if absent.
    source
        Name of the contour, for messages.

    Returns
    -------
    NDArray
        Node indices, shape (a, b): the first direction x the second one points outward.

    Raises
    ------
    InputError
        Fewer than 4 nodes, nodes not in one plane, nodes that make no grid (what they make is named), or material on
        both sides of the face.
    """
    near = _tolerance(nodes, tolerance)
    members = np.asarray(members, dtype=np.int64)
    flat = nodes[members]
    if len(members) < 4:
        raise InputError(f"{len(members)} nodes on the face", source=source, expected="at least 2 by 2 nodes")
    centre = flat.mean(axis=0)
    _, extent, axes = np.linalg.svd(flat - centre, full_matrices=False)
    if extent[1] <= near:
        raise InputError("all nodes of the face lie on a line", source=source, expected="a face")
    normal = axes[2]
    height = np.abs((flat - centre) @ normal)
    if np.max(height) > 2.0 * near:
        worst = members[np.argmax(height)]
        raise InputError(
            f"the nodes of the face are not in one plane: node {worst + 1} lies {np.max(height):g} m off",
            source=source,
            expected="a flat face, or a node matrix",
        )
    normal = _outward(nodes, members, normal, outward, source)
    best: tuple[float, NDArray[np.int64], NDArray[np.int64]] | None = None
    for first in _directions(normal, flat - centre):
        _, row = _levels((flat - centre) @ first, near)
        _, column = _levels((flat - centre) @ np.cross(normal, first), near)
        places = int((row.max() + 1) * (column.max() + 1))
        taken = np.unique(row * (column.max() + 1) + column).size
        if taken == places == len(members) and min(row.max(), column.max()) > 0:
            grid = np.empty((row.max() + 1, column.max() + 1), dtype=np.int64)
            grid[row, column] = members
            return grid
        if best is None or taken / places > best[0]:
            best = (taken / places, row, column)
    assert best is not None
    raise _no_grid(members, best[1], best[2], source)


def face_normal(
    nodes: NDArray[np.float64], members: NDArray[np.int64], *, source: str = "contour"
) -> NDArray[np.float64]:
    """Unit normal of the mean plane of a face, out of the material, shape (3,); errors as `face_grid`."""
    flat = nodes[members]
    _, extent, axes = np.linalg.svd(flat - flat.mean(axis=0), full_matrices=False)
    if len(members) < 4 or extent[1] <= _tolerance(nodes, None):
        raise InputError(
            f"{len(members)} nodes, or all on a line", source=source, expected="a face with an area"
        )
    return _outward(nodes, members, axes[2], None, source)


def _outward(
    nodes: NDArray[np.float64],
    members: NDArray[np.int64],
    normal: NDArray[np.float64],
    outward: NDArray[np.float64] | None,
    source: str,
) -> NDArray[np.float64]:
    """The normal of a plane, turned out of the material."""
    if outward is not None:
        side = float(np.dot(outward, normal))
        if abs(side) < 0.1 * float(np.linalg.norm(outward)):
            raise InputError(
                f"the direction {np.asarray(outward).tolist()} lies in the face",
                source=source,
                expected="a direction out of the material",
            )
        return normal if side > 0.0 else -normal
    others = np.ones(len(nodes), dtype=bool)
    others[members] = False
    some = members[:: max(1, len(members) // 200)]
    out, into = inward_share(nodes[some], np.tile(normal, (len(some), 1)), nodes[others])
    if max(out, into) < 2.0 * min(out, into) or max(out, into) == 0.0:
        where = "no material" if not np.any(others) else "material on both sides"
        raise InputError(
            f"{where} of the face",
            source=source,
            expected="a face of the body's surface",
        )
    return normal if out > into else -normal


def _no_grid(
    members: NDArray[np.int64], row: NDArray[np.int64], column: NDArray[np.int64], source: str
) -> InputError:
    """What the nodes make in place of a grid."""
    rows, columns = int(row.max()) + 1, int(column.max()) + 1
    places = row * columns + column
    empty = np.setdiff1d(np.arange(rows * columns), places)
    words = f"{len(members)} nodes at {rows} by {columns} different coordinates"
    if empty.size:
        gap = divmod(int(empty[0]), columns)
        words += f", {empty.size} places of the grid without a node (the first: row {gap[0] + 1}, column {gap[1] + 1})"
    else:
        words += ", several in one place"
    return InputError(f"the nodes of the face make no grid: {words}", source=source, expected=GRID_HELP)


def line_nodes(
    nodes: NDArray[np.float64],
    start: NDArray[np.float64],
    end: NDArray[np.float64],
    *,
    tolerance: float | None = None,
    source: str = "contour",
) -> NDArray[np.int64]:
    """Nodes on a straight line between two points, in order.

    Parameters
    ----------
    nodes
        Of the mesh, body frame [m], shape (n, 3).
    start, end
        Of the line [m], shape (3,).
    tolerance
        Distance from the line [m]; a millionth of the body if absent.
    source
        Name of the contour, for messages.

    Returns
    -------
    NDArray
        Indices from 0, shape (k,).

    Raises
    ------
    InputError
        Both points in one place, or fewer than two nodes on the line (the nearest line of nodes is named).
    """
    near = _tolerance(nodes, tolerance)
    start, end = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    length = float(np.linalg.norm(end - start))
    if length <= near:
        raise InputError(f"both ends are {start.tolist()} m", source=source, expected="a line with a length")
    direction = (end - start) / length
    along = (nodes - start) @ direction
    across = np.linalg.norm(nodes - start - along[:, None] * direction, axis=1)
    beside = (along >= -near) & (along <= length + near)
    found = np.flatnonzero(beside & (across <= near))
    if found.size < 2:
        hint = ""
        if np.any(beside):
            closest = int(np.flatnonzero(beside)[np.argmin(across[beside])])
            hint = f"; the nearest, node {closest + 1}, lies {across[closest]:g} m beside it"
        count = ("no node", "one node")[found.size]
        raise InputError(
            f"{count} on the line {start.tolist()} to {end.tolist()} m{hint}",
            source=source,
            expected="a line through nodes of the mesh",
        )
    order = found[np.argsort(along[found])]
    same = np.flatnonzero(np.diff(along[order]) <= near)
    if same.size:
        raise InputError(
            f"nodes {order[same[0]] + 1} and {order[same[0] + 1] + 1} on the line are in one place",
            source=source,
            expected="a mesh whose parts are merged",
        )
    return order


def circle_nodes(
    nodes: NDArray[np.float64],
    centre: NDArray[np.float64],
    axis: NDArray[np.float64],
    radius: float,
    *,
    tolerance: float | None = None,
    source: str = "contour",
) -> NDArray[np.int64]:
    """Nodes on a circle, anticlockwise seen against its axis.

    Parameters
    ----------
    nodes
        Of the mesh, body frame [m], shape (n, 3).
    centre, axis, radius
        Of the circle: [m], a direction of any length, [m].
    tolerance
        Distance from the circle [m]; a millionth of the body if absent.
    source
        Name of the contour, for messages.

    Returns
    -------
    NDArray
        Indices from 0, shape (k,), the first one nearest to the coordinate axis that the circle crosses most squarely.

    Raises
    ------
    InputError
        Fewer than 4 nodes, or an arc without nodes of more than a quarter of the circle.
    """
    near = _tolerance(nodes, tolerance)
    normal = np.asarray(axis, dtype=np.float64)
    normal = normal / np.linalg.norm(normal)
    first = np.eye(3)[np.argmin(np.abs(normal))]
    first = first - np.dot(first, normal) * normal
    first /= np.linalg.norm(first)
    way = nodes - np.asarray(centre, dtype=np.float64)
    height, x, y = way @ normal, way @ first, way @ np.cross(normal, first)
    off = np.hypot(np.hypot(x, y) - radius, height)
    found = np.flatnonzero(off <= near)
    if found.size < 4:
        closest = int(np.argmin(off))
        raise InputError(
            f"{found.size} nodes on the circle; the nearest other one, node {closest + 1}, lies {off[closest]:g} m off"
            if off[closest] > near
            else f"{found.size} nodes on the circle",
            source=source,
            expected="at least 4 nodes of the mesh on the circle",
        )
    angle = np.mod(np.arctan2(y[found], x[found]) + 1e-9, 2.0 * np.pi)
    order = found[np.argsort(angle)]
    gaps = np.diff(np.sort(angle), append=np.min(angle) + 2.0 * np.pi)
    if np.max(gaps) > 0.5 * np.pi + 1e-6:
        raise InputError(
            f"the {found.size} nodes on the circle leave {np.degrees(np.max(gaps)):.0f} degrees of it without a node",
            source=source,
            expected="nodes all around the circle, or 'nodes' along an open curve",
        )
    if np.min(gaps) * radius <= near:
        raise InputError(
            "two nodes on the circle are in one place",
            source=source,
            expected="a mesh whose parts are merged",
        )
    return order
