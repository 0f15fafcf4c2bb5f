"""Rotation of a place of a solid, whose nodes have none: that of the rigid motion that fits nodes around the place.

With the arms r of the nodes from their weighted middle, displacements u and weights w::

    theta = J^-1 sum w r x u,    J = sum w (r^2 I - r r^T)

and a moment at the place is the forces ``w J^-1 M x r`` on these nodes, which have no resultant: an interface that
averages (RBE3). Which nodes decides. Rotations of a section are those of its own nodes: a fit that reaches one layer
of elements of length h into a body of length L from its end turns as the middle of the layer does, short by h / (2 L)
under a moment. So at the surface the nodes are those of the faces around the place, on one side of an edge; inside they
are those of the elements around.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.finite_elements.reference_elements import FACE_CORNER_COUNT, FACES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.preprocess.structures.structure import Structure

__all__ = ["place_rotation"]

_FLAT = np.cos(np.radians(30.0))
"""Cosine of the largest angle between normals of faces that are one side of an edge."""
_NEIGHBOURS = 27  # nodes around a place, of a body without elements: those of a block of eight bricks


def place_rotation(
    nodes: NDArray[np.float64],
    elements: Mesh | Structure | None,
    at: NDArray[np.int64],
    place: NDArray[np.float64],
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Nodes whose displacements make the rotation of a place, and how.

    Parameters
    ----------
    nodes
        Positions [m], shape (n, 3).
    elements
        Between them, of a structure the solids; where there are none at the place the nearest nodes count.
    at
        Nodes whose displacements make that of the place.
    place
        [m], shape (3,).

    Returns
    -------
    tuple
        Nodes, shape (m,), and matrices G of ``theta = sum G_i u_i`` [1/m], shape (m, 3, 3); a moment M at the place is
        the forces ``G_i^T M``.
    """
    mesh = elements if elements is None or isinstance(elements, Mesh) else _solids_at(elements, at)
    if mesh is None:
        around = np.argsort(np.sum((nodes - place) ** 2, axis=1), kind="stable")[:_NEIGHBOURS]
        weights = np.ones(len(around))
    else:
        around, weights = _face_nodes(nodes, mesh, at, place)
        if not around.size:
            around = np.unique(mesh.elements[np.isin(mesh.elements, at).any(axis=1)])
            weights = np.ones(len(around))
    arms = nodes[around] - np.average(nodes[around], axis=0, weights=weights)
    second = (arms * weights[:, None]).T @ arms
    inertia = np.trace(second) * np.eye(3) - second
    inverse = np.linalg.pinv(inertia, rcond=1e-9, hermitian=True)
    return around, np.einsum("kl,a,ajl->akj", inverse, weights, np.cross(arms[:, None], np.eye(3)))


def _solids_at(structure: Structure, at: NDArray[np.int64]) -> Mesh | None:
    """Solids of a structure that have some nodes, None if there are none."""
    part = next((part for part in structure.solids if np.isin(at, part.elements).all()), None)
    return None if part is None else Mesh(structure.nodes, part.elements, part.element_type)


def _face_nodes(
    nodes: NDArray[np.float64], mesh: Mesh, at: NDArray[np.int64], place: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Nodes of the outer faces around a place, with their shares of the area; none if the place is inside.

    Of a place at an edge those of the side whose middle is nearest to it.
    """
    kind = mesh.element_type
    touching = mesh.elements[np.isin(mesh.elements, at).any(axis=1)]
    faces = touching[:, FACES[kind]].reshape(-1, FACES[kind].shape[1])
    faces = faces[np.isin(faces, at).any(axis=1)]  # both elements of one that is inside are there
    _, face_of, count = np.unique(np.sort(faces, axis=1), axis=0, return_inverse=True, return_counts=True)
    outer = faces[count[face_of.ravel()] == 1]
    corners = nodes[outer[:, : FACE_CORNER_COUNT[kind]]]
    normals = 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1])
    areas = np.linalg.norm(normals, axis=1)
    normals /= areas[:, None]
    holding = (outer[:, :, None] == at).any(axis=1).all(axis=1)
    best = np.inf
    found: NDArray[np.int64] = np.empty(0, dtype=np.int64)
    weights: NDArray[np.float64] = np.empty(0)
    for normal in normals[holding]:
        side = normals @ normal > _FLAT
        group, position = np.unique(outer[side], return_inverse=True)
        shares = np.repeat(areas[side] / outer.shape[1], outer.shape[1])
        own: NDArray[np.float64] = np.bincount(position.ravel(), weights=shares).astype(np.float64)
        distance = float(np.linalg.norm(np.average(nodes[group], axis=0, weights=own) - place))
        if distance < best - 1e-9 * np.sqrt(areas.max()):
            best, found, weights = distance, group, own
    return found, weights
