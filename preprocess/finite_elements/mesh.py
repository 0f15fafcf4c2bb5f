"""A solid mesh of one element type: nodes, elements, named node groups, and the checks it must pass."""

from __future__ import annotations

from dataclasses import field, replace
from typing import TYPE_CHECKING, Protocol

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.reference_elements import (
    FACE_CORNER_COUNT,
    FACE_TRIANGLES,
    FACES,
    NODE_COUNT,
    REFERENCE_NODES,
    jacobians,
    shape_functions,
    shape_gradients,
    volume_rule,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["BESIDE", "Elements", "Mesh", "find_place"]

BESIDE = 1e-2
"""Of the largest extent of a body: a point that is farther away is not of the body."""
_AT = 1e-9  # of the largest extent: a point is in an element, or at a node
_NEWTON_STEPS = 30
_CHUNK = 4096  # elements handled at once, so that memory does not grow with the mesh


class Elements(Protocol):
    """What lies between nodes: a mesh of solids, or a structure of plates and beams."""

    def nearest_place(
        self, point: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], NDArray[np.float64], float]:
        """Nodes and shape functions at the place of the body nearest to a point, and its distance [m]."""


@dataclass(frozen=True)
class Mesh:
    """Nodes and elements of one solid body.

    Parameters
    ----------
    nodes
        Positions [m], shape (n, 3), body frame.
    elements
        Zero-based node indices in VTK/meshio order, shape (ne, 8) for ``hex8``, (ne, 20) for ``hex20`` or (ne, 10) for
        ``tet10``.
    element_type
        ``"hex8"``, ``"hex20"`` or ``"tet10"``.
    node_groups
        Named, sorted node indices.
    name
        Where the mesh comes from, for messages.

    Raises
    ------
    InputError
        For an unknown element type, arrays of the wrong shape, positions that are not finite, node indices
        outside the mesh, an empty mesh or an empty group.
    """

    nodes: NDArray[np.float64]
    elements: NDArray[np.int64]
    element_type: str
    node_groups: dict[str, NDArray[np.int64]] = field(default_factory=dict)
    name: str = ""

    def __post_init__(self) -> None:
        source = self.name or "mesh"
        if self.element_type not in NODE_COUNT:
            raise InputError(
                f"element type {self.element_type!r} is unknown",
                source=source,
                key="element_type",
                expected="one of " + ", ".join(repr(kind) for kind in NODE_COUNT),
            )
        object.__setattr__(self, "nodes", np.ascontiguousarray(self.nodes, dtype=np.float64))
        object.__setattr__(self, "elements", np.ascontiguousarray(self.elements, dtype=np.int64))
        if self.nodes.ndim != 2 or self.nodes.shape[1] != 3:
            raise InputError(
                f"array of shape {self.nodes.shape}", source=source, key="nodes", expected="shape (n, 3)"
            )
        width = NODE_COUNT[self.element_type]
        if self.elements.ndim != 2 or self.elements.shape[1] != width or len(self.elements) == 0:
            raise InputError(
                f"array of shape {self.elements.shape}",
                source=source,
                key="elements",
                expected=f"shape (ne, {width}) with at least one {self.element_type} element",
            )
        bad = np.flatnonzero(~np.isfinite(self.nodes).all(axis=1))
        if bad.size:
            raise InputError(
                f"position {self.nodes[bad[0]].tolist()}",
                source=source,
                key=f"node {bad[0] + 1}",
                expected="three finite coordinates",
            )
        self._check_indices(self.elements.min(initial=0), self.elements.max(initial=0), "elements")
        groups = {}
        for key, members in self.node_groups.items():
            sorted_members = np.unique(np.asarray(members, dtype=np.int64))
            if sorted_members.size == 0:
                raise InputError("contains no node", source=source, key=f"node group {key!r}")
            self._check_indices(sorted_members[0], sorted_members[-1], f"node group {key!r}")
            groups[key] = sorted_members
        object.__setattr__(self, "node_groups", groups)

    def _check_indices(self, lowest: int, highest: int, key: str) -> None:
        if lowest < 0 or highest >= len(self.nodes):
            raise InputError(
                f"node index {lowest if lowest < 0 else highest}",
                source=self.name or "mesh",
                key=key,
                expected=f"zero-based indices below the node count {len(self.nodes)}",
            )

    @property
    def node_count(self) -> int:
        """Number of nodes."""
        return len(self.nodes)

    @property
    def element_count(self) -> int:
        """Number of elements."""
        return len(self.elements)

    def with_groups(self, groups: dict[str, NDArray[np.int64]]) -> Mesh:
        """Return the same mesh with more (or replaced) node groups."""
        return replace(self, node_groups={**self.node_groups, **groups})

    def element_volumes(self) -> NDArray[np.float64]:
        """Volume of every element [m3], shape (ne,), exact for curved elements."""
        points, weights = volume_rule(self.element_type)
        return self._determinants(points) @ weights

    @property
    def volume(self) -> float:
        """Volume of the body [m3]."""
        return float(self.element_volumes().sum())

    def locate(
        self, point: ArrayLike, *, source: object = ""
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Nodes of the element at a point, and their shape functions there; see `find_place`."""
        return find_place(self.nodes, self, point, source=str(source) or self.name or "mesh")

    def nearest_place(
        self, point: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], NDArray[np.float64], float]:
        """Nodes and shape functions at the place of the body nearest to a point, and its distance [m]."""
        corners = self.nodes[self.elements]
        lower, upper = corners.min(axis=1), corners.max(axis=1)
        # an element is no nearer than its box: look at near ones only, nearest first
        beside = np.linalg.norm(np.maximum(np.maximum(lower - point, point - upper), 0.0), axis=1)
        size = float(np.ptp(self.nodes, axis=0).max())
        best, found = np.inf, (self.elements[0], np.zeros(self.elements.shape[1]))
        for element in np.argsort(beside, kind="stable"):
            if beside[element] > best or best <= _AT * size:
                break
            weights = self._nearest(corners[element], point)
            distance = float(np.linalg.norm(weights @ corners[element] - point))
            if distance < best:
                best, found = distance, (self.elements[element], weights)
        return *found, best

    def _nearest(self, corners: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Shape functions at a point of an element, by Newton's method; at a nearby point of it if it is outside."""
        brick = self.element_type != "tet10"
        local = REFERENCE_NODES[self.element_type].mean(axis=0)
        for _ in range(_NEWTON_STEPS):
            N = shape_functions(self.element_type, local[np.newaxis])[0]
            J = jacobians(corners[np.newaxis], shape_gradients(self.element_type, local[np.newaxis]))[0, 0]
            step = np.linalg.lstsq(J, point - N @ corners, rcond=None)[0]
            before, local = local, _inside(local + step, brick)
            if np.abs(local - before).max() <= 1e-14:
                break
        weights: NDArray[np.float64] = shape_functions(self.element_type, local[np.newaxis])[0]
        return weights

    def boundary_faces(self) -> NDArray[np.int64]:
        """Faces that belong to one element only.

        Returns
        -------
        NDArray
            Node indices, shape (nf, 4) for ``hex8``, (nf, 8) for ``hex20``, (nf, 6) for ``tet10`` (corners, then
            middle nodes), anticlockwise seen from outside.
        """
        _, face_of, count = self._unique_faces()
        faces = self.elements[:, FACES[self.element_type]].reshape(-1, FACES[self.element_type].shape[1])
        return faces[count[face_of] == 1]

    def boundary_triangles(self) -> NDArray[np.int64]:
        """Triangles of the outer surface, outward winding.

        Returns
        -------
        NDArray
            Node indices, shape (nt, 3): two triangles for each face of an 8-node brick, four for each face of a
            quadratic tetrahedron and six for one of a 20-node brick (through its middle nodes).
        """
        return self.boundary_faces()[:, FACE_TRIANGLES[self.element_type]].reshape(-1, 3)

    def check(self) -> Mesh:
        """Check that the mesh is one sound body; returns the mesh itself.

        Raises
        ------
        InputError
            For an inverted element (non-positive Jacobian determinant at a node or at the centre), a face
            shared by more than two elements, a node in no element, or parts that are not joined through
            common faces (a part that hangs on a node or an edge only is a mechanism).
        """
        source = self.name or "mesh"
        inverted = np.flatnonzero(self.smallest_determinants() <= 0.0)
        if inverted.size:
            raise InputError(
                f"inverted or flat: the Jacobian determinant is not positive ({inverted.size} such elements)",
                source=source,
                key=self._element_words(inverted[0]),
                expected="node order of VTK (corners, then middle nodes) and a convex element",
            )
        unused = np.setdiff1d(np.arange(self.node_count), self.elements)
        if unused.size:
            raise InputError(
                f"belongs to no element ({unused.size} such nodes)",
                source=source,
                key=f"node {unused[0] + 1}",
                expected="every node in at least one element",
            )
        self._check_connected(source)
        return self

    def smallest_determinants(self) -> NDArray[np.float64]:
        """Smallest det J of every element over its nodes and its centre [m3], shape (ne,)."""
        points = REFERENCE_NODES[self.element_type]
        return self._determinants(np.vstack([points, points.mean(axis=0)])).min(axis=1)

    def _determinants(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        gradients = shape_gradients(self.element_type, points)
        return np.vstack(
            [
                np.linalg.det(jacobians(self.nodes[self.elements[start : start + _CHUNK]], gradients))
                for start in range(0, self.element_count, _CHUNK)
            ]
        )

    def _unique_faces(self) -> tuple[int, NDArray[np.int64], NDArray[np.int64]]:
        """Return the number of distinct faces, the face of each (element, side), and the elements at each."""
        corners = FACES[self.element_type][:, : FACE_CORNER_COUNT[self.element_type]]
        keys = np.sort(self.elements[:, corners].reshape(-1, corners.shape[1]), axis=1)
        # three corners identify a face, of a brick too: two faces of a mesh share two corners at most
        n = self.node_count
        if n < 2_000_000:  # n^3 < 2^63: one integer a face sorts faster than rows
            key = (keys[:, 0] * n + keys[:, 1]) * n + keys[:, 2]
            _, face_of, count = np.unique(key, return_inverse=True, return_counts=True)
        else:
            _, face_of, count = np.unique(keys[:, :3], axis=0, return_inverse=True, return_counts=True)
        return len(count), face_of.ravel(), count

    def parts(self) -> NDArray[np.int64]:
        """Zero-based part of every element, shape (ne,): elements are of one part if faces join them.

        Raises
        ------
        InputError
            For a face shared by more than two elements.
        """
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        face_count, face_of, count = self._unique_faces()
        owner = np.repeat(np.arange(self.element_count), len(FACES[self.element_type]))
        if count.max() > 2:
            raise InputError(
                f"has a face shared by {count.max()} elements",
                source=self.name or "mesh",
                key=self._element_words(owner[np.argmax(count[face_of])]),
                expected="two elements at most at a face (no element twice, none overlapping)",
            )
        ne = self.element_count
        size = ne + face_count
        graph = coo_array((np.ones(len(owner), dtype=np.int8), (owner, ne + face_of)), shape=(size, size))
        _, labels = connected_components(graph, directed=False)
        found: NDArray[np.int64] = labels[:ne].astype(np.int64)
        return found

    def _check_connected(self, source: str) -> None:
        labels = self.parts()
        if labels.max() > 0:
            sizes = np.bincount(labels)
            smallest = np.flatnonzero(labels == np.argmin(sizes))
            raise InputError(
                f"the mesh falls into {sizes.size} parts that share no face; the smallest has "
                f"{smallest.size} element(s)",
                source=source,
                key=self._element_words(smallest[0]),
                expected="one body: merge coincident nodes, or remove the loose part",
            )

    def _element_words(self, index: int) -> str:
        centre = self.nodes[self.elements[index]].mean(axis=0)
        return f"element {index + 1} at ({centre[0]:.6g}, {centre[1]:.6g}, {centre[2]:.6g}) m"


def find_place(
    nodes: NDArray[np.float64],
    mesh: Elements | None,
    point: ArrayLike,
    *,
    source: object,
    key: str = "",
    origin: ArrayLike = (0.0, 0.0, 0.0),
    within: float = BESIDE,
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Nodes whose displacements make that of a place of a body, and their weights.

    Parameters
    ----------
    nodes
        Positions [m], shape (n, 3).
    mesh
        Elements between these nodes: displacements are interpolated by their shape functions. None if they are not
        known: then the nearest node has to be the place.
    point
        Coordinates [m], shape (3,). Beside the mesh, as where straight edges stand for a curved face, a point of
        an element counts that is as near, to a factor of about two.
    source, key
        Where the point stands, for the message.
    origin
        Of these coordinates in those of the message [m].
    within
        How far the place may be from the point, in largest extents of the body.

    Returns
    -------
    tuple
        Node indices and weights of sum 1, shapes (m,): the node itself where the point is at one.

    Raises
    ------
    InputError
        If the point is farther away.
    """
    place = np.asarray(point, dtype=np.float64)
    if place.shape != (3,) or not np.all(np.isfinite(place)):
        raise InputError(f"point {point!r}", source=source, key=key, expected="three finite coordinates [m]")
    size = float(np.ptp(nodes, axis=0).max())
    squares = np.sum((nodes - place) ** 2, axis=1)
    node = int(np.argmin(squares))
    distance = float(np.sqrt(squares[node]))
    found, weights = np.array([node]), np.ones(1)
    if mesh is not None and distance > _AT * size:
        found, weights, distance = mesh.nearest_place(place)
    if distance <= within * size:
        return found, weights
    words = ", ".join(f"{1e3 * x:.6g}" for x in place + np.asarray(origin))
    near = ", ".join(f"{1e3 * x:.6g}" for x in weights @ nodes[found] + np.asarray(origin))
    what = "its nearest place" if mesh is not None else "its nearest node (no elements are known)"
    raise InputError(
        f"point ({words}) mm is not on the body: {what}, at ({near}) mm, is {1e3 * distance:.6g} mm away",
        source=source,
        key=key,
        expected=f"a point on the body, to {within:.0%} of its largest extent of {1e3 * size:.6g} mm, in the "
        "coordinates of the geometry (are the units right?)",
    )


def _inside(local: NDArray[np.float64], brick: bool) -> NDArray[np.float64]:
    """Reference coordinates moved into the element: clipped to the cube, or projected onto the tetrahedron."""
    if brick:
        return np.clip(local, -1.0, 1.0)
    positive = np.maximum(local, 0.0)
    if positive.sum() <= 1.0:
        return positive
    # projection onto the simplex: subtract what makes the positive rest sum to one
    descending = np.sort(local)[::-1]
    excess = (np.cumsum(descending) - 1.0) / np.arange(1, 4)
    return np.maximum(local - excess[np.flatnonzero(descending > excess)[-1]], 0.0)
