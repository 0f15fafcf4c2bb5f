"""Which of two features near each other are the nearest of their surfaces, and on which side they are.

Two triangles near each other offer up to fifteen pairs of features, of which at most a few can push: the others have a
neighbour that is nearer to the other surface. A contact of one of those would push sideways at the seam of two
coplanar triangles, or from within a body. The test is that of Voronoi regions (Ericson, *Real-Time Collision
Detection*, 2005, section 9.5): the direction `d` from a feature to the other surface must lead away from everything
that is joined to the feature. It holds for open surfaces, wound either way, as only neighbours are asked.

The same neighbours tell on which side a feature begins that touches from the start, where the sign of its distance is
rounding.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.numerics.vectors import Vector

__all__ = ["SLACK", "edge_inward_sum", "edge_is_nearest", "vertex_is_nearest", "vertex_neighbour_sum"]

SLACK = 0.02
"""Sine of the angle by which a neighbour may be nearer. Flat faces that rest on each other must not lose a corner to
the tilt that their compliance gives them."""


@kernel(internal=True)
def vertex_is_nearest(
    points: NDArray[np.float64],
    vertex_first: NDArray[np.int64],
    vertex_neighbours: NDArray[np.int64],
    vertex: int,
    d: Vector,
    slack: float,
) -> bool:
    """Whether no neighbour of a vertex lies further along the unit direction `d`, given in the axes of the vertex."""
    x, y, z = points[vertex, 0], points[vertex, 1], points[vertex, 2]
    for k in range(vertex_first[vertex], vertex_first[vertex + 1]):
        other = vertex_neighbours[k]
        ex, ey, ez = points[other, 0] - x, points[other, 1] - y, points[other, 2] - z
        along = ex * d[0] + ey * d[1] + ez * d[2]
        if slack >= 0.0:
            if along > 0.0 and along * along > slack * slack * (ex * ex + ey * ey + ez * ez):
                return False
        elif along > 0.0 or along * along < slack * slack * (ex * ex + ey * ey + ez * ez):
            return False
    return True


@kernel(internal=True)
def edge_is_nearest(
    edge_first: NDArray[np.int64], edge_inward: NDArray[np.float64], edge: int, d: Vector, slack: float
) -> bool:
    """Whether no triangle at an edge leads along the unit direction `d`, given in the axes of the edge."""
    for k in range(edge_first[edge], edge_first[edge + 1]):
        if edge_inward[k, 0] * d[0] + edge_inward[k, 1] * d[1] + edge_inward[k, 2] * d[2] > slack:
            return False
    return True


@kernel(inline=True, internal=True)
def vertex_neighbour_sum(
    points: NDArray[np.float64],
    vertex_first: NDArray[np.int64],
    vertex_neighbours: NDArray[np.int64],
    vertex: int,
) -> Vector:
    """Sum of the edges [m] that leave a vertex: points into its surface."""
    x, y, z = points[vertex, 0], points[vertex, 1], points[vertex, 2]
    sx, sy, sz = 0.0, 0.0, 0.0
    for k in range(vertex_first[vertex], vertex_first[vertex + 1]):
        other = vertex_neighbours[k]
        sx += points[other, 0] - x
        sy += points[other, 1] - y
        sz += points[other, 2] - z
    return sx, sy, sz


@kernel(inline=True, internal=True)
def edge_inward_sum(edge_first: NDArray[np.int64], edge_inward: NDArray[np.float64], edge: int) -> Vector:
    """Sum of the directions from an edge into its triangles."""
    sx, sy, sz = 0.0, 0.0, 0.0
    for k in range(edge_first[edge], edge_first[edge + 1]):
        sx += edge_inward[k, 0]
        sy += edge_inward[k, 1]
        sz += edge_inward[k, 2]
    return sx, sy, sz
