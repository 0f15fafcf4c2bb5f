"""Outer surface of a body with modes: triangles between its nodes, and what the modes do to them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from heavylift.modal.reduced import ReducedBody
    from heavylift.preprocess.structures.structure import Structure

__all__ = ["BodySurface", "body_surface", "point_shapes"]


BESIDE = 1e-12
"""Of the size of a body: what is nearer to its node lies in it."""


class BodySurface(NamedTuple):
    """Triangles that deform with a body.

    Attributes
    ----------
    surface
        Undeformed, in the frame of the body.
    nodes
        Node of each of its points, shape (n,).
    """

    surface: TriangleSurface
    nodes: NDArray[np.int64]

    def only(self, kept: NDArray[np.bool_]) -> BodySurface:
        """Some of its triangles, and the points between them; `kept` has shape (nt,)."""
        used, triangles = np.unique(self.surface.triangles[kept], return_inverse=True)
        points = self.surface.points[used]
        surface = TriangleSurface(points, triangles.reshape(-1, 3), self.surface.radius, self.surface.name)
        return BodySurface(surface, self.nodes[used])


def body_surface(
    reduced: ReducedBody,
    name: str = "surface",
    *,
    chosen: Callable[[TriangleSurface], NDArray[np.bool_]] | None = None,
) -> BodySurface:
    """Outer surface of a body: faces of its solid elements that no other element shares, or its plates.

    Plates are their middle surfaces, rounded by half of the largest thickness.

    Parameters
    ----------
    reduced
        The body.
    name
        What messages call the surface.
    chosen
        Which triangles are meant, shape (nt,); all if absent.

    Raises
    ------
    InputError
        If nothing is known of its elements, or plates and solid elements are meant at once.
    """
    if reduced.structure is not None:
        return _structure_surface(reduced.structure, name, chosen)
    if reduced.mesh is None:
        raise InputError(
            "a body whose elements are not known has no surface",
            source=name,
            key="body",
            expected="a body made of a mesh; of matrices alone a contour through its nodes",
        )
    triangles = reduced.mesh.boundary_triangles()
    nodes, numbers = np.unique(triangles, return_inverse=True)
    made = BodySurface(TriangleSurface(reduced.nodes[nodes], numbers.reshape(-1, 3), 0.0, name), nodes)
    return made if chosen is None else made.only(chosen(made.surface))


def _structure_surface(
    structure: Structure, name: str, chosen: Callable[[TriangleSurface], NDArray[np.bool_]] | None
) -> BodySurface:
    """Middle surfaces of plates, which offsets move away from the nodes, or outer faces of solids."""
    triangles = structure.boundary_triangles()
    thickness, offset = np.zeros(len(triangles)), np.zeros(len(triangles))
    sides = [*structure.shells, *(part for part in structure.shells if part.elements.shape[1] == 4)]
    at = 0
    for part in sides:  # in the order of `surface_triangles`
        rows = slice(at, at + len(part.elements))
        thickness[rows], offset[rows] = part.thickness, part.offset
        at += len(part.elements)
    kept = np.ones(len(triangles), dtype=bool)
    if chosen is not None:
        kept = chosen(TriangleSurface(structure.nodes, triangles, 0.0, name))
    if kept[:at].any() and kept[at:].any():
        raise InputError(
            "plates and solid elements in one surface",
            source=name,
            key="exclude",
            expected="boxes that leave the triangles of plates or those of solid elements",
        )
    nodes, numbers = np.unique(triangles[kept], return_inverse=True)
    numbers = numbers.reshape(-1, 3)
    points = structure.nodes[nodes]
    if offset[kept].any():
        a, b, c = (points[numbers[:, k]] for k in range(3))
        area = np.cross(b - a, c - a)
        moved, weight = np.zeros_like(points), np.zeros(len(points))
        size = np.linalg.norm(area, axis=1)
        for k in range(3):
            np.add.at(moved, numbers[:, k], offset[kept][:, np.newaxis] * area)
            np.add.at(weight, numbers[:, k], size)
        points = points + moved / weight[:, np.newaxis]
    radius = 0.5 * float(thickness[kept].max(initial=0.0))
    return BodySurface(TriangleSurface(points, numbers, radius, name), nodes)


def point_shapes(
    reduced: ReducedBody, nodes: NDArray[np.int64], points: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Mode shapes of the points of a surface [kg^-1/2], shape (nf, n, 3); points beside their nodes turn with these."""
    shapes = np.ascontiguousarray(reduced.mode_shapes[:, nodes])
    arms = points - reduced.nodes[nodes]
    if reduced.mode_rotations is not None and np.abs(arms).max(initial=0.0) > BESIDE * np.ptp(reduced.nodes):
        shapes += np.cross(reduced.mode_rotations[:, nodes], arms)
    return shapes
