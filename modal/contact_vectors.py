"""Loads of contact on the surface of a body: on the nodes of a patch, and spread over a smooth footprint.

Their static deflections (`heavylift.modal.bases.static_vectors`) let a reduced body answer a contact force with
the compliance of its finite-element model. Eigenmodes miss the local indentation under a concentrated load however
many are taken, and a contact then meets a light, stiff mass that every touch sets in motion anew.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.modal.bases import Loads, patch_loads, point_loads
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from heavylift.preprocess.finite_elements.model import FEModel

    Nodes = Sequence[int] | NDArray[np.int64]

__all__ = [
    "NORMAL",
    "contact_loads",
    "face_rule",
    "footprint_loads",
    "footprint_weights",
    "grid_normals",
    "outer_faces",
    "patch_nodes",
    "surface_normals",
]

NORMAL = "normal"
"""Direction of a load: along the outward normal of the surface."""

_CELLS = 16  # integration cells along the radius of a footprint
_COVERED = 0.9  # part of a footprint that must lie on its face
_TOLERANCE = 1e-9  # of the size of the body: nodes on the border of a patch belong to it


def outer_faces(model: FEModel, nodes: Nodes, *, name: str = "face") -> NDArray[np.int64]:
    """Element faces on the surface of a body, all of whose nodes are among some nodes.

    Parameters
    ----------
    model
        Finite element model with its elements.
    nodes
        Nodes of a face of the body, or of all of its surface.
    name
        For messages.

    Returns
    -------
    NDArray
        Node indices, shape (nf, 4) or (nf, 8) of bricks or (nf, 6) of quadratic tetrahedra, anticlockwise from
        outside; of structures (nf, 4), plates anticlockwise about the normal, triangles with their last node twice.

    Raises
    ------
    InputError
        If the model has no elements, or no outer face has all of its nodes among those given.
    """
    source = model.name or "finite element model"
    elements = model.mesh or model.structure
    if elements is None:
        raise InputError(
            "a model of nodes and matrices alone has no surface",
            source=source,
            key=name,
            expected=f"a model with elements, or loads in directions x, y, z in place of {NORMAL!r}",
        )
    chosen = np.zeros(model.node_count, dtype=bool)
    chosen[np.asarray(nodes, dtype=np.int64)] = True
    faces = elements.boundary_faces()
    faces = faces[chosen[faces].all(axis=1)]
    if not len(faces):
        raise InputError(
            f"{np.count_nonzero(chosen)} node(s) that make up no outer face of the mesh",
            source=source,
            key=name,
            expected="the nodes of a face of the body",
        )
    return faces


def surface_normals(model: FEModel, faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """Outward unit normals at the nodes of outer faces, mean of the faces around by their areas.

    Parameters
    ----------
    model
        Finite element model.
    faces
        From `outer_faces`.

    Returns
    -------
    NDArray
        Shape (n, 3), zero at nodes of no face and where the faces around cancel.
    """
    corners = model.nodes[faces[:, : 3 if faces.shape[1] == 6 else 4]]
    # half the cross product of the diagonals; a triangle is a quadrilateral whose last corner is its first
    areas = 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3 % corners.shape[1]] - corners[:, 1])
    sums = np.zeros((model.node_count, 3))
    for column in faces.T:
        np.add.at(sums, column, areas)
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    small = 1e-12 * np.linalg.norm(areas, axis=1).max()
    return np.where(length > small, sums / np.maximum(length, small), 0.0)


def grid_normals(
    points: NDArray[np.float64], closed: tuple[bool, bool] = (False, False)
) -> NDArray[np.float64]:
    """Unit normals of a surface through a grid of points, by differences of neighbours.

    Parameters
    ----------
    points
        Shape (a, b, 3) [m], a and b at least 2.
    closed
        Whether the last row follows upon the first one, and so for columns.

    Returns
    -------
    NDArray
        Shape (a, b, 3), along (difference of rows) x (difference of columns); zero where these are parallel.
    """
    rows, columns = (
        np.roll(points, -1, axis) - np.roll(points, 1, axis) if round_ else np.gradient(points, axis=axis)
        for axis, round_ in enumerate(closed)
    )
    normals = np.cross(rows, columns)
    length = np.linalg.norm(normals, axis=2, keepdims=True)
    return np.where(length > 0.0, normals / np.maximum(length, np.finfo(float).tiny), 0.0)


def patch_nodes(
    model: FEModel,
    nodes: Nodes,
    *,
    box: tuple[ArrayLike, ArrayLike] | None = None,
    disc: tuple[ArrayLike, float] | None = None,
    name: str = "patch",
) -> NDArray[np.int64]:
    """Those of some nodes that lie in a box or within a radius; the border belongs to it.

    Parameters
    ----------
    model
        Finite element model.
    nodes
        Nodes of a face.
    box
        Corners with the smallest and largest coordinates [m].
    disc
        Centre [m] and radius [m].
    name
        For messages.

    Raises
    ------
    InputError
        If there is no such node.
    """
    chosen = np.unique(np.asarray(nodes, dtype=np.int64))
    positions = model.nodes[chosen]
    slack = _TOLERANCE * float(np.linalg.norm(np.ptp(model.nodes, axis=0)))
    inside = np.ones(len(chosen), dtype=bool)
    words = []
    if box is not None:
        lower, upper = (np.asarray(corner, dtype=np.float64) for corner in box)
        inside &= np.all((positions >= lower - slack) & (positions <= upper + slack), axis=1)
        words.append(f"in the box {lower.tolist()} to {upper.tolist()} m")
    if disc is not None:
        centre, radius = np.asarray(disc[0], dtype=np.float64), float(disc[1])
        inside &= np.linalg.norm(positions - centre, axis=1) <= radius + slack
        words.append(f"within {radius:g} m of {centre.tolist()} m")
    if not inside.any():
        raise InputError(
            f"none of {len(chosen)} nodes of the face is {' and '.join(words)}",
            source=model.name or "finite element model",
            key=name,
            expected="at least one node, "
            + (f"which lie in {_extent(positions)}" if len(chosen) else "and there is none"),
        )
    return chosen[inside]


def contact_loads(
    model: FEModel,
    nodes: Nodes,
    directions: str = NORMAL,
    *,
    normals: NDArray[np.float64] | None = None,
    fixed_nodes: Nodes = (),
    name: str = "patch",
) -> Loads:
    """Unit forces on each node of a contact patch: one vector a node and direction.

    Any pressure on element faces between these nodes is a combination of the vectors, and so is the force of a
    contour whose control points are fitted to these nodes.

    Parameters
    ----------
    model
        Finite element model.
    nodes
        Nodes of the patch; those among `fixed_nodes` or clamped by the model are left out.
    directions
        ``"normal"``, or some of the letters x, y, z; ``"xyz"`` where friction acts.
    normals
        For ``"normal"``: direction at every node of the model, shape (n, 3).
    fixed_nodes
        Clamped nodes.
    name
        For labels and messages.

    Raises
    ------
    InputError
        If no node is free, an index or direction is wrong, or a node has no normal.
    """
    free = np.setdiff1d(np.asarray(nodes, dtype=np.int64), np.union1d(fixed_nodes, model.fixed_nodes))
    source = model.name or "finite element model"
    if not free.size:
        raise InputError(
            f"{len(nodes)} node(s), all of them clamped" if len(nodes) else "no node",
            source=source,
            key=name,
            expected="at least one free node",
        )
    if directions != NORMAL:
        loads = point_loads(model, free, directions)
        return Loads(loads.forces, tuple(f"{name} {label}" for label in loads.labels))
    point_loads(model, free)  # checks the indices
    along = np.zeros((len(free), 3)) if normals is None else np.asarray(normals, dtype=np.float64)[free]
    bare = np.flatnonzero(~(np.abs(np.linalg.norm(along, axis=1) - 1.0) < 1e-6))
    if bare.size:
        raise InputError(
            f"node {free[bare[0]]} at {model.nodes[free[bare[0]]].tolist()} m has no normal",
            source=source,
            key=name,
            expected="nodes of outer faces, or directions of x, y, z",
        )
    forces = np.zeros((model.dof_count, len(free)))
    forces[(3 * free[:, None] + np.arange(3)).T, np.arange(len(free))] = along.T
    return Loads(forces, tuple(f"{name} node {node} {NORMAL}" for node in free))


def footprint_loads(
    model: FEModel,
    faces: NDArray[np.int64],
    centre: ArrayLike,
    radius: float,
    directions: str = NORMAL,
    *,
    name: str = "footprint",
) -> Loads:
    """Resultant force 1 spread over a disc with the weight ``(1 - r^2/R^2)^2``: one vector a direction.

    Parameters
    ----------
    model
        Finite element model.
    faces
        From `outer_faces`.
    centre
        Of the disc [m], on the faces.
    radius
        R [m].
    directions
        ``"normal"``, the local normal of the surface, or some of the letters x, y, z.
    name
        For labels and messages.

    Raises
    ------
    InputError
        See `footprint_weights`; or for an unknown direction.

    Notes
    -----
    Consistent nodal forces ``integral of w N_i n dA / integral of w dA``. The transposed vector reads the mean
    displacement over the disc with the same weight from nodal displacements.
    """
    weights, normal = footprint_weights(model, faces, centre, radius, name=name)
    if directions != NORMAL:
        touched = np.flatnonzero(weights)
        return patch_loads(model, touched, directions, weights=weights[touched], name=name)
    forces = np.zeros((model.dof_count, 1))
    forces[: normal.size, 0] = normal.ravel()
    return Loads(forces, (f"{name} {NORMAL}",))


def footprint_weights(
    model: FEModel, faces: NDArray[np.int64], centre: ArrayLike, radius: float, *, name: str = "footprint"
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Shares of the nodes in a mean over a disc with the weight ``(1 - r^2/R^2)^2``.

    Parameters
    ----------
    model, faces, centre, radius, name
        See `footprint_loads`.

    Returns
    -------
    shares
        Sum 1, shape (n,).
    normals
        The same integrals with the outward normal, shape (n, 3).

    Raises
    ------
    InputError
        For a radius that is not positive, or a disc of which a tenth or more lies beside the faces.
    """
    source = model.name or "finite element model"
    if not (np.isfinite(radius) and radius > 0.0):
        raise InputError(f"radius {radius!r}", source=source, key=name, expected="a positive length [m]")
    middle = np.asarray(centre, dtype=np.float64)
    corners = model.nodes[faces]
    reach = np.linalg.norm(np.ptp(corners, axis=1), axis=1)
    near = np.linalg.norm(corners.mean(axis=1) - middle, axis=1) <= radius + reach
    shares, normals = np.zeros(model.node_count), np.zeros((model.node_count, 3))
    for face, x in zip(faces[near], corners[near], strict=True):
        cells = int(np.ceil(np.ptp(x, axis=0).max() * _CELLS / radius))
        N, tangents, rule = face_rule(len(face), min(max(cells, 1), 8 * _CELLS))
        normal = np.cross(tangents[0] @ x, tangents[1] @ x)
        squared = np.sum((N @ x - middle) ** 2, axis=1) / radius**2
        w = rule * np.maximum(1.0 - squared, 0.0) ** 2
        shares[face] += N.T @ (w * np.linalg.norm(normal, axis=1))
        normals[face] += N.T @ (w[:, None] * normal)
    total = float(shares.sum())
    covered = total / (np.pi * radius**2 / 3.0)  # the weight has the mean 1/3
    if covered <= _COVERED:
        raise InputError(
            f"{100.0 * covered:.3g} % of the disc of radius {radius:g} m about {middle.tolist()} m is on the face",
            source=source,
            key=name,
            expected=f"a centre on the face, at least the radius away from its edges; it spans "
            f"{_extent(model.nodes[np.unique(faces)])}",
        )
    return shares / total, normals / total


def face_rule(
    count: int, cells: int
) -> tuple[NDArray[np.float64], tuple[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]:
    """Shape functions (nq, count), their two derivatives and weights (nq,) on a face cut into cells."""
    gauss, weight = np.polynomial.legendre.leggauss(3)
    edges = np.linspace(0.0, 1.0, cells + 1)
    line = (edges[:-1, None] + 0.5 * (gauss + 1.0) / cells).ravel()
    weights = np.tile(0.5 * weight / cells, cells)
    a, b = (grid.ravel() for grid in np.meshgrid(line, line, indexing="ij"))
    rule = np.outer(weights, weights).ravel()
    if count == 4:
        N = np.column_stack([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b])
        along_a = np.column_stack([b - 1, 1 - b, b, -b])
        along_b = np.column_stack([a - 1, -a, a, 1 - a])
        return N, (along_a, along_b), rule
    if count == 8:
        return *_serendipity(2.0 * a - 1.0, 2.0 * b - 1.0), rule
    # a square folded onto the triangle: L1 = a (1 - b), L2 = b, Jacobian 1 - b
    rule = rule * (1.0 - b)
    a = a * (1.0 - b)
    c = 1.0 - a - b
    one = np.ones_like(a)
    L = (c, a, b)
    slopes = ((-one, one, 0 * one), (-one, 0 * one, one))
    N = np.column_stack([x * (2 * x - 1) for x in L] + [4 * L[k] * L[(k + 1) % 3] for k in range(3)])
    along = tuple(
        np.column_stack(
            [(4 * x - 1) * dx for x, dx in zip(L, d, strict=True)]
            + [4 * (L[k] * d[(k + 1) % 3] + d[k] * L[(k + 1) % 3]) for k in range(3)]
        )
        for d in slopes
    )
    return N, (along[0], along[1]), rule


def _serendipity(
    s: NDArray[np.float64], t: NDArray[np.float64]
) -> tuple[NDArray[np.float64], tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Shape functions of a face of a 20-node brick and their derivatives by a = (1 + s) / 2 and b = (1 + t) / 2."""
    N, along_a, along_b = [], [], []
    for sa, ta in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        p, q = 1 + sa * s, 1 + ta * t
        last = sa * s + ta * t - 1
        N.append(p * q * last / 4)
        along_a.append(sa * q * (last + p) / 2)
        along_b.append(ta * p * (last + q) / 2)
    for sa, ta in ((0, -1), (1, 0), (0, 1), (-1, 0)):
        if sa == 0:
            bubble, ramp = 1 - s**2, 1 + ta * t
            N.append(bubble * ramp / 2)
            along_a.append(-2 * s * ramp)
            along_b.append(ta * bubble)
        else:
            bubble, ramp = 1 - t**2, 1 + sa * s
            N.append(bubble * ramp / 2)
            along_a.append(sa * bubble)
            along_b.append(-2 * t * ramp)
    return np.column_stack(N), (np.column_stack(along_a), np.column_stack(along_b))


def _extent(positions: NDArray[np.float64]) -> str:
    low, high = positions.min(axis=0), positions.max(axis=0)
    return ", ".join(f"{axis} {low[k]:.6g} to {high[k]:.6g}" for k, axis in enumerate("xyz")) + " m"
