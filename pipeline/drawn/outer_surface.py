"""The outer surface of a body as pictures need it: triangles, the edges worth drawing, sampled points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.preprocess.finite_elements.mesh import Mesh
    from heavylift.preprocess.structures.structure import Structure

__all__ = [
    "Surface",
    "feature_edges",
    "surface_from_mesh",
    "surface_from_nodes",
    "surface_from_structure",
    "surface_from_triangles",
    "surface_of_model",
]

# edges of one boundary face, as positions within a row of `Mesh.boundary_faces()`
_FACE_EDGES = {
    4: np.array([[0, 1], [1, 2], [2, 3], [3, 0]]),
    6: np.array([[0, 3], [3, 1], [1, 4], [4, 2], [2, 5], [5, 0]]),
    8: np.array([[0, 4], [4, 1], [1, 5], [5, 2], [2, 6], [6, 3], [3, 7], [7, 0]]),
}


@dataclass(frozen=True, eq=False)
class Surface:
    """Surface nodes of one body and how they are joined; volume nodes are left out.

    Attributes
    ----------
    nodes
        Positions [m], shape (m, 3), body frame.
    node_indices
        Row of each surface node in the nodes of the model, shape (m,).
    triangles
        Indices into `nodes`, shape (nt, 3), outward winding. Empty for a bare cloud of nodes.
    element_edges
        Edges of the finite elements, shape (ne, 2), indices into `nodes`.
    feature_edges
        Edges at which the surface has a kink, shape (nk, 2), indices into `nodes`.
    """

    nodes: NDArray[np.float64]
    node_indices: NDArray[np.int64]
    triangles: NDArray[np.int64]
    element_edges: NDArray[np.int64]
    feature_edges: NDArray[np.int64]

    @property
    def diagonal(self) -> float:
        """Diagonal of the bounding box [m]."""
        return float(np.linalg.norm(np.ptp(self.nodes, axis=0)))

    def pick(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rows of a field on all nodes of the model that belong to the surface nodes."""
        return np.ascontiguousarray(values[self.node_indices])

    def members(self, node_group: NDArray[np.int64]) -> NDArray[np.int64]:
        """Surface nodes (indices into `nodes`) that belong to a group of model nodes."""
        return np.flatnonzero(np.isin(self.node_indices, node_group))

    def triangles_within(self, members: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Mask of the triangles whose three corners are all `members` (indices into `nodes`)."""
        inside = np.zeros(len(self.nodes), dtype=bool)
        inside[members] = True
        return np.all(inside[self.triangles], axis=1)


def surface_from_mesh(mesh: Mesh) -> Surface:
    """Outer surface of a mesh with the edges of its elements (not the diagonals of the triangles)."""
    faces = mesh.boundary_faces()
    edges = faces[:, _FACE_EDGES[faces.shape[1]]].reshape(-1, 2)
    return surface_from_triangles(mesh.nodes, mesh.boundary_triangles(), element_edges=edges)


def surface_from_structure(structure: Structure) -> Surface:
    """Plates and outer faces of solids of a structure, with the edges of plates; stiffeners are edges where plates are.

    A structure of beams alone is a cloud of nodes.
    """
    triangles = structure.boundary_triangles()
    if not len(triangles):
        return surface_from_nodes(structure.nodes)
    used = np.zeros(structure.node_count, dtype=bool)
    used[triangles] = True
    edges = [part.elements[:, [k, (k + 1) % part.elements.shape[1]]] for part in structure.shells
             for k in range(part.elements.shape[1])]  # fmt: skip
    edges += [part.elements for part in structure.beams]
    if structure.solids:
        # of triangles: the faces of solids have no other edges here
        edges += [triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]
    joined = np.concatenate(edges)
    return surface_from_triangles(structure.nodes, triangles, element_edges=joined[used[joined].all(axis=1)])


def surface_of_model(mesh: Mesh | None, structure: Structure | None) -> Surface | None:
    """Surface of whichever a body has between its nodes; None if they are loose."""
    if structure is not None:
        return surface_from_structure(structure)
    return None if mesh is None else surface_from_mesh(mesh)


def surface_from_triangles(
    nodes: NDArray[np.float64],
    triangles: NDArray[np.int64],
    *,
    element_edges: NDArray[np.int64] | None = None,
    feature_angle: float = np.radians(30.0),
) -> Surface:
    """Keep the nodes that triangles use and find the edges to draw.

    Parameters
    ----------
    nodes
        Positions of all nodes of the model [m], shape (n, 3).
    triangles
        Node indices, shape (nt, 3), outward winding.
    element_edges
        Node indices of element edges, shape (ne, 2), with repetitions; those of the triangles when absent.
    feature_angle
        Smallest angle between the normals of two triangles [rad] that makes their edge a feature.
    """
    used, compact = np.unique(triangles, return_inverse=True)
    compact = compact.reshape(triangles.shape)
    if element_edges is None:
        edges = compact[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    else:
        edges = np.searchsorted(used, element_edges)
    edges = np.unique(np.sort(edges, axis=1), axis=0)
    surface_nodes = np.ascontiguousarray(nodes[used], dtype=np.float64)
    return Surface(
        nodes=surface_nodes,
        node_indices=used,
        triangles=compact,
        element_edges=edges,
        feature_edges=feature_edges(surface_nodes, compact, feature_angle),
    )


def surface_from_nodes(nodes: NDArray[np.float64]) -> Surface:
    """Bare cloud of nodes, for models that come without a mesh."""
    none = np.empty((0, 2), dtype=np.int64)
    return Surface(
        nodes=np.ascontiguousarray(nodes, dtype=np.float64),
        node_indices=np.arange(len(nodes)),
        triangles=np.empty((0, 3), dtype=np.int64),
        element_edges=none,
        feature_edges=none,
    )


def feature_edges(
    nodes: NDArray[np.float64], triangles: NDArray[np.int64], angle: float, *, wound: bool = True
) -> NDArray[np.int64]:
    """Edges whose two triangles meet at more than an angle, and edges of one triangle or more than two.

    Parameters
    ----------
    nodes, triangles
        Points [m], shape (n, 3), and corners, shape (m, 3).
    angle
        [rad].
    wound
        Whether all triangles are wound the same way; if not, normals may point to either side.

    Returns
    -------
    NDArray
        Ends of the edges, shape (k, 2).
    """
    if not len(triangles):
        return np.empty((0, 2), dtype=np.int64)
    corner = nodes[triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), np.finfo(float).tiny)
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(len(triangles)), 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, owner = edges[order], owner[order]
    unique, first, count = np.unique(edges, axis=0, return_index=True, return_counts=True)
    second = np.minimum(first + 1, len(owner) - 1)
    cosine = np.einsum("ij,ij->i", normal[owner[first]], normal[owner[second]])
    return unique[(count != 2) | ((cosine if wound else np.abs(cosine)) < np.cos(angle))]
