"""A spline surface fitted to the nodes of an unstructured face, as tetrahedra and free meshes of CAD faces have them.

The face is projected onto its mean plane, into the rectangle of least area around it; in that the spline is the one
that is nearest to all nodes, with as much bending taken away as the nodes leave open (P. Dierckx, *Curve and Surface
Fitting with Splines*, 1993, section 9.1). The fit is linear in the places of the nodes, so that the control points of
all mode shapes come from the same matrix.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.spatial import ConvexHull

from heavylift.contours.splines.face_grid import face_normal
from heavylift.contours.splines.interpolation import basis_matrix
from heavylift.contours.splines.neutral import NeutralContour
from heavylift.contours.splines.spaces import SplineSpace, clamped_space
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["FaceFit", "fitted_surface"]

NODES_OF_CONTROL = 6.0
"""Nodes for each control point, at least: the sides of quadratic tetrahedra have a node in their middle."""

SMOOTHING = 1e-9
"""Weight of differences of third order of control points beside the mean distance of nodes: it decides where nodes say
nothing, and moves nothing elsewhere."""

STEEPEST = 0.7
"""Height over extent of a face from which on its projection tells too little."""

FARTHEST = 1e-2
"""Of the extent of the face: a node that lies farther from the fit is a feature that it has no room for."""

NODES_OF_CELL = 12.0
"""Nodes that a part of the rectangle around a face would have if they were spread evenly: one without any is a hole."""

MOST_CONTROLS = 40
"""Along one direction."""


class FaceFit(NamedTuple):
    """A fitted surface.

    Attributes
    ----------
    contour
        The spline.
    distance
        Largest distance of a node from it [m].
    shares
        Of each node in the place of each control point, shape (controls, members): a force on the contour is one on the
        nodes in these shares.
    normal
        Of the mean plane, out of the material, shape (3,).
    """

    contour: NeutralContour
    distance: float
    shares: NDArray[np.float64]
    normal: NDArray[np.float64]


def fitted_surface(
    nodes: NDArray[np.float64],
    members: NDArray[np.int64],
    mode_shapes: NDArray[np.float64],
    *,
    degrees: tuple[int, int] = (3, 3),
    source: str = "contour",
) -> FaceFit:
    """Surface near the nodes of a face, its normal out of the material.

    Parameters
    ----------
    nodes
        Of the mesh, body frame [m], shape (n, 3).
    members
        Indices of the nodes of the face.
    mode_shapes
        Of all nodes, shape (nf, n, 3).
    degrees
        Along and across the longer side of the face.
    source
        Name of the contour, for messages.

    Raises
    ------
    InputError
        Too few nodes for the degrees, a face that is folded, that leaves a part of its rectangle without nodes, or that
        the spline does not fit.
    """
    points = nodes[members]
    normal = face_normal(nodes, members, source=source)
    centre = points.mean(axis=0)
    height = (points - centre) @ normal
    first = _along(points - centre, normal)
    second = np.cross(normal, first)
    place = np.stack([(points - centre) @ first, (points - centre) @ second], axis=1)
    low, extent = place.min(axis=0), np.ptp(place, axis=0)
    if np.ptp(height) > STEEPEST * extent.min():
        raise InputError(
            f"the face is {np.ptp(height):.3g} m high over {extent.min():.3g} m",
            source=source,
            expected="a face that a plane shows without folds, or several contours",
        )
    spaces = _spaces(len(points), extent, degrees, source)
    u = np.clip((place - low) / extent, 0.0, 1.0)
    _check_cover(u, extent, source)
    B = np.einsum("ka,kb->kab", basis_matrix(spaces[0], u[:, 0]), basis_matrix(spaces[1], u[:, 1])).reshape(
        len(points), -1
    )
    shares = _least_squares(B, _roughness(spaces))
    values = np.concatenate([points[np.newaxis], mode_shapes[:, members]])
    control = np.einsum("ca,mak->mck", shares, values)
    distance = float(np.linalg.norm(B @ control[0] - points, axis=1).max())
    if distance > FARTHEST * extent.max():
        raise InputError(
            f"a spline of {spaces[0].count} by {spaces[1].count} control points passes the nodes of the face by up to "
            f"{distance:.3g} m",
            source=source,
            expected="a smooth face without edges, a finer mesh, or a part of the face by 'from' and 'to'",
        )
    contour = NeutralContour(spaces, control[0], control[1:], np.empty(0))
    return FaceFit(contour, distance, shares, normal)


def _along(flat: NDArray[np.float64], normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Direction of the longer side of the rectangle of least area around a face: it lies along its convex hull."""
    a = np.eye(3)[np.argmin(np.abs(normal))]
    a = a - (a @ normal) * normal
    a /= np.linalg.norm(a)
    b = np.cross(normal, a)
    place = np.stack([flat @ a, flat @ b], axis=1)
    corners = place[ConvexHull(place).vertices]
    sides = np.roll(corners, -1, axis=0) - corners
    angles = np.unique(np.round(np.mod(np.arctan2(sides[:, 1], sides[:, 0]), 0.5 * np.pi), 9))
    turned = np.stack([np.cos(angles), np.sin(angles)])
    across = np.stack([-np.sin(angles), np.cos(angles)])
    extents = np.ptp(corners @ turned, axis=0), np.ptp(corners @ across, axis=0)
    best = int(np.argmin(extents[0] * extents[1]))
    along = turned[:, best] if extents[0][best] >= extents[1][best] else across[:, best]
    direction: NDArray[np.float64] = along[0] * a + along[1] * b
    # of two opposite directions the one that grows along its largest coordinate
    return direction * np.sign(direction[np.argmax(np.abs(direction))])


def _spaces(
    count: int, extent: NDArray[np.float64], degrees: tuple[int, int], source: str
) -> tuple[SplineSpace, SplineSpace]:
    """As many control points along each direction as the nodes determine."""
    spacing = np.sqrt(NODES_OF_CONTROL * extent[0] * extent[1] / count)
    made = []
    for axis, degree in enumerate(degrees):
        controls = int(np.clip(extent[axis] / spacing, degree + 1, MOST_CONTROLS))
        made.append(clamped_space(degree, np.linspace(0.0, 1.0, controls - degree + 1)[1:-1]))
    if made[0].count * made[1].count > count:
        raise InputError(
            f"{count} nodes for {made[0].count} by {made[1].count} control points",
            source=source,
            expected="a finer mesh, or a lower degree",
        )
    return made[0], made[1]


def _check_cover(u: NDArray[np.float64], extent: NDArray[np.float64], source: str) -> None:
    """Every part of the rectangle has nodes: a spline has no holes and four sides."""
    side = np.sqrt(NODES_OF_CELL * extent[0] * extent[1] / len(u))
    cells = [max(1, int(extent[k] / side)) for k in range(2)]
    at = [np.minimum((u[:, k] * cells[k]).astype(int), cells[k] - 1) for k in range(2)]
    taken = np.unique(at[0] * cells[1] + at[1]).size
    if taken < cells[0] * cells[1]:
        share = 1.0 - taken / (cells[0] * cells[1])
        raise InputError(
            f"some {share:.0%} of the rectangle of {extent[0]:.4g} m by {extent[1]:.4g} m around the face have no node",
            source=source,
            expected="a face with four sides and no large holes, a part of it by 'from' and 'to', or [[surfaces]] of "
            "the body and [[collisions]], which take any face",
        )


def _roughness(spaces: tuple[SplineSpace, SplineSpace]) -> NDArray[np.float64]:
    """Third differences of neighbouring control points along both directions."""
    rows = []
    for axis, space in enumerate(spaces):
        difference = np.diff(np.eye(space.count), n=3, axis=0)
        other = np.eye(spaces[1 - axis].count)
        rows.append(np.kron(difference, other) if axis == 0 else np.kron(other, difference))
    return np.concatenate(rows)


def _least_squares(B: NDArray[np.float64], rough: NDArray[np.float64]) -> NDArray[np.float64]:
    """Operator from values at nodes to control points, shape (controls, nodes)."""
    system = np.concatenate([B, np.sqrt(SMOOTHING) * rough])
    found: NDArray[np.float64] = np.linalg.pinv(system)[:, : len(B)]
    return found
