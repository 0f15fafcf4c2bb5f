"""Outer surface of a body with modes: triangles between its nodes, and what the modes do to them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.modal.reduced import ReducedBody

__all__ = ["BodySurface", "body_surface", "point_shapes"]


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


def body_surface(reduced: ReducedBody, name: str = "surface") -> BodySurface:
    """Outer surface of a body: faces of its solid elements that no other element shares.

    Parameters
    ----------
    reduced
        The body.
    name
        What messages call the surface.

    Raises
    ------
    InputError
        If nothing is known of its elements.
    """
    if reduced.mesh is None:
        raise InputError(
            "a body whose elements are not known has no surface",
            source=name,
            key="body",
            expected="a body made of a mesh; of matrices alone a contour through its nodes",
        )
    triangles = reduced.mesh.boundary_triangles()
    nodes, numbers = np.unique(triangles, return_inverse=True)
    points = reduced.nodes[nodes]
    return BodySurface(TriangleSurface(points, numbers.reshape(-1, 3), 0.0, name), nodes)


def point_shapes(reduced: ReducedBody, nodes: NDArray[np.int64]) -> NDArray[np.float64]:
    """Mode shapes of the points of a surface [kg^-1/2], shape (nf, n, 3)."""
    return np.ascontiguousarray(reduced.mode_shapes[:, nodes])
