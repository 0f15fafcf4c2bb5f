"""Closest or deepest point of a contour to a rigid primitive: `contours.splines.search` with a distance to a core.

The signed distance to a convex core is minimised over the points of the contour. Where its gradient m is along the
normal of the surface the two touch: open, the pair is the closest one; penetrating, the point is the deepest of the
surface in the primitive, and the distance stays smooth through zero gap, because the core lies deeper by the radius.
Where the surface has reached the core the pair has no common normal any more, and the result says DEEP (an ellipsoid is
all core, and smooth up to its centres of curvature).
Faces of a box on a flat surface are no exception: any of the many minima is one.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.splines.convex import ELLIPSOID, core_distance
from heavylift.contours.splines.evaluate import curve_point, surface_point
from heavylift.contours.splines.search import ROUNDING, leaves_window
from heavylift.contours.splines.search_cold import (
    begin_at_samples,
    distances_to_point,
    nearest_sample,
    start_at_sample,
)
from heavylift.contours.splines.search_step import (
    BEHIND,
    CONVERGED,
    DEEP,
    EVALUATE,
    NEED_SPAN,
    NOT_FINITE,
    step_search,
)
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import vector

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.splines.convex import Primitive
    from heavylift.contours.splines.packed_contour import PackedContour
    from heavylift.contours.splines.samples import SampleGrid, Samples
    from heavylift.contours.splines.search_step import ContourSearch

__all__ = [
    "closest_shape_cold",
    "closest_shape_on_curve",
    "closest_shape_on_surface",
    "into_shape",
    "shape_gap",
]


@kernel(inline=True, internal=True)
def into_shape(shape: Primitive, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Direction in the axes of the shape."""
    return (
        shape.axes[0, 0] * x + shape.axes[1, 0] * y + shape.axes[2, 0] * z,
        shape.axes[0, 1] * x + shape.axes[1, 1] * y + shape.axes[2, 1] * z,
        shape.axes[0, 2] * x + shape.axes[1, 2] * y + shape.axes[2, 2] * z,
    )


@kernel(inline=True, internal=True)
def _out_of_shape(shape: Primitive, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Direction in the axes of the contour."""
    return (
        shape.axes[0, 0] * x + shape.axes[0, 1] * y + shape.axes[0, 2] * z,
        shape.axes[1, 0] * x + shape.axes[1, 1] * y + shape.axes[1, 2] * z,
        shape.axes[2, 0] * x + shape.axes[2, 1] * y + shape.axes[2, 2] * z,
    )


@kernel(inline=True, internal=True)
def _resolution(shape: Primitive, result: ContourSearch) -> float:
    """Rounding error of positions about the shape."""
    size = (
        abs(result.position[0])
        + abs(result.position[1])
        + abs(result.position[2])
        + abs(shape.centre[0])
        + abs(shape.centre[1])
        + abs(shape.centre[2])
    )
    return ROUNDING * (size + shape.sizes[0] + shape.sizes[1] + shape.sizes[2])


@kernel(internal=True)
def closest_shape_on_surface(
    contour: PackedContour,
    knots: NDArray,
    weights: NDArray,
    net: NDArray,
    kind: int,
    shape: Primitive,
    scratch: NDArray,
    result: ContourSearch,
) -> int:
    """Continue with the search for the point of a surface that is closest to, or deepest in, a primitive.

    Parameters
    ----------
    kind, shape
        Kind and record of the primitive, its centre and axes in those of the contour.
    contour, knots, weights, net, scratch, result
        As of `heavylift.contours.splines.search.closest_on_surface`.

    Returns
    -------
    Status as there. `squared_distance` is that of the core, shifted by the shift of the primitive; the gap is from
    `shape_gap`. BEHIND is set if the normal of the surface points away from the primitive, DEEP if the gap is not above
    minus the radius.
    """
    while True:
        if leaves_window(contour, knots, result):
            return NEED_SPAN
        surface_point(contour, knots, weights, net, result.trial_u, result.trial_v, scratch, result)
        a1, a2, a3 = result.tangent_u[0], result.tangent_u[1], result.tangent_u[2]
        b1, b2, b3 = result.tangent_v[0], result.tangent_v[1], result.tangent_v[2]
        uu, uv, vv = result.derivative_uu, result.derivative_uv, result.derivative_vv
        x, y, z = into_shape(
            shape,
            result.position[0] - shape.centre[0],
            result.position[1] - shape.centre[1],
            result.position[2] - shape.centre[2],
        )
        value, m1, m2, m3, h11, h22, h33, h12, h13, h23 = core_distance(kind, shape, x, y, z)
        g1, g2, g3 = _out_of_shape(shape, m1, m2, m3)
        p1, p2, p3 = into_shape(shape, a1, a2, a3)
        q1, q2, q3 = into_shape(shape, b1, b2, b3)
        hq1 = h11 * q1 + h12 * q2 + h13 * q3
        hq2 = h12 * q1 + h22 * q2 + h23 * q3
        hq3 = h13 * q1 + h23 * q2 + h33 * q3
        hp1 = h11 * p1 + h12 * p2 + h13 * p3
        hp2 = h12 * p1 + h22 * p2 + h23 * p3
        hp3 = h13 * p1 + h23 * p2 + h33 * p3
        status = step_search(
            contour,
            0.5 * value * value,
            g1 * a1 + g2 * a2 + g3 * a3,
            g1 * b1 + g2 * b2 + g3 * b3,
            p1 * hp1 + p2 * hp2 + p3 * hp3 + g1 * uu[0] + g2 * uu[1] + g3 * uu[2],
            p1 * hq1 + p2 * hq2 + p3 * hq3 + g1 * uv[0] + g2 * uv[1] + g3 * uv[2],
            q1 * hq1 + q2 * hq2 + q3 * hq3 + g1 * vv[0] + g2 * vv[1] + g3 * vv[2],
            _resolution(shape, result),
            result,
        )
        if status == CONVERGED:
            gap, _, _, _, _, _, _, side = shape_gap(kind, shape, result)
            flags = result.flags
            if kind != ELLIPSOID and gap + shape.radius <= ROUNDING:
                flags |= DEEP
            elif side > 0.0:
                flags |= BEHIND
            result.flags = flags
            return status
        if status != EVALUATE:
            return status


@kernel(internal=True)
def closest_shape_on_curve(
    contour: PackedContour,
    knots: NDArray,
    weights: NDArray,
    net: NDArray,
    kind: int,
    shape: Primitive,
    scratch: NDArray,
    result: ContourSearch,
) -> int:
    """Continue with the search for the point of a curve that is closest to, or deepest in, a primitive.

    As `closest_shape_on_surface` with ``v = 0``. Of a ring it is the closest distance of two curves.
    """
    while True:
        if leaves_window(contour, knots, result):
            return NEED_SPAN
        curve_point(contour, knots, weights, net, result.trial_u, scratch, result)
        a1, a2, a3 = result.tangent_u[0], result.tangent_u[1], result.tangent_u[2]
        uu = result.derivative_uu
        x, y, z = into_shape(
            shape,
            result.position[0] - shape.centre[0],
            result.position[1] - shape.centre[1],
            result.position[2] - shape.centre[2],
        )
        value, m1, m2, m3, h11, h22, h33, h12, h13, h23 = core_distance(kind, shape, x, y, z)
        g1, g2, g3 = _out_of_shape(shape, m1, m2, m3)
        p1, p2, p3 = into_shape(shape, a1, a2, a3)
        status = step_search(
            contour,
            0.5 * value * value,
            g1 * a1 + g2 * a2 + g3 * a3,
            0.0,
            h11 * p1 * p1
            + h22 * p2 * p2
            + h33 * p3 * p3
            + 2.0 * (h12 * p1 * p2 + h13 * p1 * p3 + h23 * p2 * p3)
            + g1 * uu[0]
            + g2 * uu[1]
            + g3 * uu[2],
            0.0,
            1.0,
            _resolution(shape, result),
            result,
        )
        if status != EVALUATE:
            return status


@kernel(internal=True)
def shape_gap(
    kind: int, shape: Primitive, result: ContourSearch
) -> tuple[float, float, float, float, float, float, float, float]:
    """Gap of a primitive to the contour point of a result, and where it is touched.

    Returns
    -------
    g, m1, m2, m3, x1, x2, x3, side
        Gap ``phi - radius`` [m]; unit direction from the primitive to the contour, at an inner minimum the inward
        normal of a surface; point of the primitive [m], ``S = x + g m``; sine of m above the tangents of a surface,
        below 0 if its normal faces the primitive.
    """
    s1, s2, s3 = result.position[0], result.position[1], result.position[2]
    x, y, z = into_shape(shape, s1 - shape.centre[0], s2 - shape.centre[1], s3 - shape.centre[2])
    value, d1, d2, d3, _, _, _, _, _, _ = core_distance(kind, shape, x, y, z)
    m1, m2, m3 = _out_of_shape(shape, d1 / value, d2 / value, d3 / value)
    gap = value - shape.shift - shape.radius
    a, b = result.tangent_u, result.tangent_v
    n1 = a[1] * b[2] - a[2] * b[1]
    n2 = a[2] * b[0] - a[0] * b[2]
    n3 = a[0] * b[1] - a[1] * b[0]
    side = (m1 * n1 + m2 * n2 + m3 * n3) / math.sqrt(n1 * n1 + n2 * n2 + n3 * n3)
    return gap, m1, m2, m3, s1 - gap * m1, s2 - gap * m2, s3 - gap * m3, side


@kernel(internal=True)
def _distances_to_shape(
    kind: int, shape: Primitive, samples: Samples, grid: SampleGrid, separation: float
) -> None:
    """Squared distances, shifted, of samples to the core of a primitive.

    Of samples that are farther than the best by more than their reach and the separation, only a bound of that from the
    ball about the core.
    """
    distances_to_point(samples, grid, vector(shape.centre))
    points, distances = samples.points[grid.points : grid.points + 3], samples.distances
    count = grid.count_u * grid.count_v
    nearest = nearest_sample(distances, count)
    if nearest < 0:
        return
    p, q, r = shape.sizes[0], shape.sizes[1], shape.sizes[2]
    ball = math.sqrt(p * p + q * q + r * r) - shape.shift
    x, y, z = into_shape(
        shape,
        points[0, nearest] - shape.centre[0],
        points[1, nearest] - shape.centre[1],
        points[2, nearest] - shape.centre[2],
    )
    within = core_distance(kind, shape, x, y, z)[0] + separation + grid.reach
    for k in range(count):
        bound = math.sqrt(distances[k]) - ball
        if bound > within:
            distances[k] = bound * bound
        else:
            x, y, z = into_shape(
                shape,
                points[0, k] - shape.centre[0],
                points[1, k] - shape.centre[1],
                points[2, k] - shape.centre[2],
            )
            value = core_distance(kind, shape, x, y, z)[0]
            distances[k] = value * value


@kernel(internal=True)
def closest_shape_cold(
    contour: PackedContour,
    knots: NDArray,
    weights: NDArray,
    net: NDArray,
    kind: int,
    shape: Primitive,
    samples: Samples,
    grid: SampleGrid,
    scratch: NDArray,
    result: ContourSearch,
) -> int:
    """Closest or deepest point of a surface or a curve to a primitive, without a start; see `closest_point_cold`.

    A ring against a surface has `ring_cold`. `other_distance` is that to the core, shifted as `squared_distance` is.
    """
    _distances_to_shape(kind, shape, samples, grid, result.separation)
    begin_at_samples(contour, grid, result)
    status = NOT_FINITE
    while start_at_sample(contour, samples, grid, status, result):
        if contour.v.degree == 0:
            status = closest_shape_on_curve(contour, knots, weights, net, kind, shape, scratch, result)
        else:
            status = closest_shape_on_surface(contour, knots, weights, net, kind, shape, scratch, result)
    return status
