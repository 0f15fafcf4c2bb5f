"""Surfaces of bodies with modes become the arrays that their points are formed from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.triangles.body_surface import point_shapes
from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import filled, records
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.contact.kind import OF_MODAL_FACETS, ContactContour, ContourPose
from heavylift.solver.contact.triangles.modal_kind import ModalState, ModalSurface, ModalSurfaces

if TYPE_CHECKING:
    from heavylift.contours.triangles.pair_list import PairLists
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces
    from heavylift.preprocess.finite_elements.mesh import Mesh
    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
    from heavylift.solver.scene.bodies import FlexibleBody
    from heavylift.solver.scene.collisions import CollisionSurface

__all__ = ["ModalBook", "pack_modal", "pack_modal_surface"]


@dataclass(frozen=True, eq=False)
class ModalBook:
    """How a surface deforms with the modes of its body.

    Attributes
    ----------
    dof
        First velocity of the body.
    points
        Undeformed [m], shape (n, 3).
    shapes
        Mode shapes of the points [kg^-1/2], shape (nf, n, 3).
    nodes
        Nodes of the points, shape (n,).
    mesh
        Solid elements between the nodes; None without.
    """

    dof: int
    points: NDArray[np.float64]
    shapes: NDArray[np.float64]
    nodes: NDArray[np.int64]
    mesh: Mesh | None

    @property
    def data(self) -> NDArray[np.float64]:
        """Of each point its place, then its mode shapes component by component, shape (n (3 + 3 nf),)."""
        shapes = self.shapes.transpose(1, 2, 0).reshape(len(self.points), -1)
        return np.concatenate([self.points, shapes], axis=1).ravel()

    @property
    def largest(self) -> NDArray[np.float64]:
        """Largest displacement of a point in each mode, shape (nf,)."""
        return np.linalg.norm(self.shapes, axis=2).max(axis=1, initial=0.0)


def pack_modal_surface(
    one: CollisionSurface, body: FlexibleBody, number: int, dof: int
) -> tuple[ContactContour, ContourPose, TriangleSurface, ModalBook]:
    """Row and pose of a surface, its undeformed triangles, and how they deform.

    Raises
    ------
    InputError
        If triangles and nodes do not fit together, or the points are not those of the nodes.
    """
    surface, nodes = one.surface, one.nodes
    if surface is None or nodes is None:
        raise InputError(
            f"no triangles between nodes of {one.body!r}",
            source=one.name,
            key="surface",
            expected="those of body_surface, with the nodes that they are between",
        )
    count = body.reduced.node_count
    if nodes.shape != (len(surface.points),) or nodes.min(initial=0) < 0 or nodes.max(initial=0) >= count:
        raise InputError(
            f"nodes of shape {nodes.shape}",
            source=one.name,
            key="nodes",
            expected=f"one of the {count} nodes of {one.body!r} for each of the {len(surface.points)} points",
        )
    row = ContactContour.one()
    row.owner, row.dof, row.body = OF_MODAL_FACETS, dof, number
    pose = ContourPose.one()
    pose.rotation[:] = rotation_matrix(np.asarray(body.orientation, dtype=np.float64)).ravel()
    pose.origin[:] = body.position
    pose.reach = float(np.linalg.norm(surface.points, axis=1).max()) + surface.radius
    return (
        row,
        pose,
        surface,
        ModalBook(
            dof, surface.points, point_shapes(body.reduced, nodes, surface.points), nodes, body.reduced.mesh
        ),
    )


def pack_modal(
    books: Mapping[int, ModalBook],
    packed: CollisionSurfaces,
    lists: PairLists,
    surface_count: int,
    first_pose: int,
) -> ModalSurfaces:
    """Make the arrays.

    Parameters
    ----------
    books
        By number of the surface.
    packed, lists
        All surfaces, and the lists of near triangles of their pairs.
    surface_count, first_pose
        Surfaces of the scene, and contours, whose poses come first.
    """
    if not books:
        return ModalSurfaces.none()
    rows = records(ModalSurface, len(books))
    row_of = np.full(first_pose + surface_count, -1, dtype=np.int64)
    row_of_surface = np.full(surface_count, -1, dtype=np.int64)
    edge_ends = np.append(packed.surfaces["first_edge"], len(packed.edges))
    shapes = coordinates = points = triangles = edges = 0
    for k, (s, book) in enumerate(books.items()):
        one = packed.surfaces[s]
        row_of[first_pose + s] = row_of_surface[s] = k
        modes = len(book.shapes)
        rows[k] = filled(
            ModalSurface,
            surface=s,
            dof=book.dof,
            pose=first_pose + s,
            modes=modes,
            shapes=shapes,
            first_coordinate=coordinates,
            first_point=one.first_point,
            points=one.point_count,
            first_needed=points,
            first_triangle=triangles,
            first_edge=edges,
            needed=0,
            triangles=0,
            edges=0,
            whole=False,
            solid=book.mesh is not None,
        )
        shapes += len(book.points) * (3 + 3 * modes)
        coordinates += modes
        points += int(one.point_count)
        triangles += int(one.triangle_count)
        edges += int(edge_ends[s + 1] - edge_ends[s])
    most = max(len(book.points) for book in books.values())
    state = ModalState.one()
    state.traversals = -1
    outward, edge_outward = _ways_out(packed)
    half_depths = np.full(len(packed.points), np.inf)
    for s, book in books.items():
        first = int(packed.surfaces[s].first_point)
        own = slice(first, first + len(book.points))
        if book.mesh is not None:
            half_depths[own] = 0.5 * _thicknesses(book.mesh, book.nodes, outward[own])
    return ModalSurfaces(
        rows=rows,
        row_of=row_of,
        row_of_surface=row_of_surface,
        shapes=np.concatenate([book.data for book in books.values()]),
        coordinates=np.zeros(coordinates),
        placed=np.zeros(coordinates),
        largest=np.concatenate([book.largest for book in books.values()]),
        everything=np.arange(most, dtype=np.int64),
        needed=np.zeros(points, dtype=np.int64),
        triangles=np.zeros(triangles, dtype=np.int64),
        edges=np.zeros(edges, dtype=np.int64),
        point_marks=np.zeros(len(packed.points), dtype=np.int64),
        triangle_marks=np.zeros(len(packed.triangles), dtype=np.int64),
        edge_marks=np.zeros(len(packed.edges), dtype=np.int64),
        outward=outward,
        edge_outward=edge_outward,
        half_depths=half_depths,
        lists=lists,
        state=state,
    )


def _ways_out(packed: CollisionSurfaces) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Means of the normals of the faces at each point, by their areas, and at each edge; unit vectors or zeros."""
    corners, edges = packed.triangles["corners"], packed.triangles["edges"]
    a, b, c = (packed.points[corners[:, k]] for k in range(3))
    area = np.cross(b - a, c - a)
    at_points, at_edges = np.zeros((len(packed.points), 3)), np.zeros((len(packed.edges), 3))
    for k in range(3):
        np.add.at(at_points, corners[:, k], area)
        there = edges[:, k] >= 0
        np.add.at(at_edges, edges[there, k], packed.normals[there])
    return _unit(at_points), _unit(at_edges)


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    length = np.linalg.norm(vectors, axis=1)
    vectors[length == 0.0] = 0.0
    return vectors / np.where(length > 0.0, length, 1.0)[:, np.newaxis]


def _thicknesses(mesh: Mesh, nodes: NDArray[np.int64], outward: NDArray[np.float64]) -> NDArray[np.float64]:
    """Least extent of the elements at each of some nodes along a direction there [m], shape (n,)."""
    number = np.full(mesh.node_count, -1, dtype=np.int64)
    number[nodes] = np.arange(len(nodes))
    found = np.full(len(nodes), np.inf)
    for local in range(mesh.elements.shape[1]):
        own = number[mesh.elements[:, local]]
        at = np.flatnonzero(own >= 0)
        along = np.einsum("enk,ek->en", mesh.nodes[mesh.elements[at]], outward[own[at]])
        np.minimum.at(found, own[at], np.ptp(along, axis=1))
    return found
