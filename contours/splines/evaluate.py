"""Kernels: position, tangents and second derivatives of packed contours, and the weights of their control points.

A contour (`PackedContour`) points into flat arrays of knots, rational weights and control
points. Parameters are wrapped into a closed direction and clamped to an open one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from heavylift.contours.splines.basis import find_span, wrap, write_basis
from heavylift.contours.splines.net_sums import BASIS_V, SCRATCH, Evaluation, bicubic, polynomial, rational
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.splines.packed_contour import PackedContour

__all__ = [
    "SCRATCH",
    "Evaluation",
    "curve_point",
    "curve_weights",
    "surface_point",
    "surface_weights",
]


@kernel(inline=True, internal=True)
def place(contour: PackedContour, knots: NDArray[np.float64], u: float, scratch: NDArray[np.float64]) -> int:
    """Basis of direction u into the scratch; returns the index of its first function."""
    degree = contour.u.degree
    count = contour.u.count
    closed = contour.u.closed
    first = contour.u.first_knot
    inside = wrap(u, closed)
    span = find_span(knots, first, degree, count + degree if closed else count, inside)
    write_basis(knots, first, degree, span, inside, scratch, 0)
    return span - degree


@kernel(inline=True, internal=True)
def place_across(
    contour: PackedContour, knots: NDArray[np.float64], v: float, scratch: NDArray[np.float64]
) -> int:
    """Basis of direction v into the scratch; returns the index of its first function."""
    degree = contour.v.degree
    count = contour.v.count
    closed = contour.v.closed
    first = contour.v.first_knot
    inside = wrap(v, closed)
    span = find_span(knots, first, degree, count + degree if closed else count, inside)
    write_basis(knots, first, degree, span, inside, scratch, BASIS_V)
    return span - degree


@kernel(internal=True)
def surface_point(
    contour: PackedContour,
    knots: NDArray[np.float64],
    weights: NDArray[np.float64],
    net: NDArray[np.float64],
    u: float,
    v: float,
    scratch: NDArray[np.float64],
    out: Evaluation,
) -> None:
    """Position, tangents and second derivatives of a surface.

    Parameters
    ----------
    contour
        The packed surface.
    knots, weights, net
        Flat knots, flat rational weights, control points [m] of shape (n, 3).
    u, v
        Parameters: wrapped if the direction is closed, clamped to [0, 1] if open.
    scratch
        Shape (SCRATCH,).
    out
        All of it is written.
    """
    start_u = place(contour, knots, u, scratch)
    start_v = place_across(contour, knots, v, scratch)
    if contour.first_weight >= 0:
        rational(contour, weights, net, start_u, start_v, scratch, out)
    elif contour.u.degree == 3 and contour.v.degree == 3:
        bicubic(contour, net, start_u, start_v, scratch, out)
    else:
        polynomial(contour, net, start_u, start_v, scratch, out)


@kernel(internal=True)
def curve_point(
    contour: PackedContour,
    knots: NDArray[np.float64],
    weights: NDArray[np.float64],
    net: NDArray[np.float64],
    u: float,
    scratch: NDArray[np.float64],
    out: Evaluation,
) -> None:
    """Position, tangent and second derivative by u of a curve, only these of `out`; see `surface_point`."""
    start = place(contour, knots, u, scratch)
    count = contour.u.count
    wide = contour.u.degree + 1
    first_weight, first_control = contour.first_weight, contour.first_control
    x = y = z = dx = dy = dz = ex = ey = ez = 0.0
    w = dw = ew = 0.0
    for i in range(wide):
        local = start + i
        local = local - count if local >= count else local
        weight = weights[first_weight + local] if first_weight >= 0 else 1.0
        n = weight * scratch[i]
        d = weight * scratch[wide + i]
        e = weight * scratch[2 * wide + i]
        at = first_control + local
        px, py, pz = net[at, 0], net[at, 1], net[at, 2]
        x += n * px
        y += n * py
        z += n * pz
        w += n
        dx += d * px
        dy += d * py
        dz += d * pz
        dw += d
        ex += e * px
        ey += e * py
        ez += e * pz
        ew += e
    if contour.first_weight >= 0:
        inverse = 1.0 / w
        x, y, z = x * inverse, y * inverse, z * inverse
        dx, dy, dz = (dx - dw * x) * inverse, (dy - dw * y) * inverse, (dz - dw * z) * inverse
        ex = (ex - 2.0 * dw * dx - ew * x) * inverse
        ey = (ey - 2.0 * dw * dy - ew * y) * inverse
        ez = (ez - 2.0 * dw * dz - ew * z) * inverse
    out.position[0], out.position[1], out.position[2] = x, y, z
    out.tangent_u[0], out.tangent_u[1], out.tangent_u[2] = dx, dy, dz
    out.derivative_uu[0], out.derivative_uu[1], out.derivative_uu[2] = ex, ey, ez


@kernel(internal=True)
def surface_weights(
    contour: PackedContour,
    knots: NDArray[np.float64],
    weights: NDArray[np.float64],
    u: float,
    v: float,
    scratch: NDArray[np.float64],
    controls: NDArray[np.int64],
    w: NDArray[np.float64],
) -> int:
    """What each control point contributes to the position and the tangents of a surface.

    ``S = sum_c w[c] P[controls[c]]``, ``S_u`` and ``S_v`` likewise with ``w[c + stride]`` and ``w[c + 2 stride]``: the
    Jacobian of any body is this sum over the Jacobians of its control points.

    Parameters
    ----------
    contour, knots, weights, u, v, scratch
        See `surface_point`.
    controls
        Local indices ``i * count_v + j``, int64, at least stride of them.
    w
        At least 3 strides.

    Returns
    -------
    int
        The stride: ``(degree_u + 1) (degree_v + 1)``.
    """
    start_u = place(contour, knots, u, scratch)
    start_v = place_across(contour, knots, v, scratch)
    count_u = contour.u.count
    count_v = contour.v.count
    wide_u = contour.u.degree + 1
    wide_v = contour.v.degree + 1
    stride = wide_u * wide_v
    at = 0
    for i in range(wide_u):
        row = start_u + i
        row = (row - count_u if row >= count_u else row) * count_v
        n = scratch[i]
        d = scratch[wide_u + i]
        for j in range(wide_v):
            column = start_v + j
            controls[at] = row + (column - count_v if column >= count_v else column)
            across = scratch[BASIS_V + j]
            slope = scratch[BASIS_V + wide_v + j]
            w[at] = n * across
            w[at + stride] = d * across
            w[at + 2 * stride] = n * slope
            at += 1
    if contour.first_weight >= 0:
        total = total_u = total_v = 0.0
        for c in range(stride):
            weight = weights[contour.first_weight + controls[c]]
            w[c] *= weight
            w[c + stride] *= weight
            w[c + 2 * stride] *= weight
            total += w[c]
            total_u += w[c + stride]
            total_v += w[c + 2 * stride]
        inverse = 1.0 / total
        for c in range(stride):
            value = w[c] * inverse
            w[c] = value
            w[c + stride] = (w[c + stride] - total_u * value) * inverse
            w[c + 2 * stride] = (w[c + 2 * stride] - total_v * value) * inverse
    return stride


@kernel(internal=True)
def curve_weights(
    contour: PackedContour,
    knots: NDArray[np.float64],
    weights: NDArray[np.float64],
    u: float,
    scratch: NDArray[np.float64],
    controls: NDArray[np.int64],
    w: NDArray[np.float64],
) -> int:
    """What each control point contributes to the position and the tangent of a curve; see `surface_weights`.

    Returns
    -------
    int
        The stride: degree + 1. ``w[c]`` and ``w[c + stride]`` are written, ``w[c + 2 stride]`` is set to zero.
    """
    start = place(contour, knots, u, scratch)
    count = contour.u.count
    stride = contour.u.degree + 1
    for i in range(stride):
        local = start + i
        controls[i] = local - count if local >= count else local
        w[i] = scratch[i]
        w[i + stride] = scratch[stride + i]
        w[i + 2 * stride] = 0.0
    if contour.first_weight >= 0:
        total = slope = 0.0
        for c in range(stride):
            weight = weights[contour.first_weight + controls[c]]
            w[c] *= weight
            w[c + stride] *= weight
            total += w[c]
            slope += w[c + stride]
        inverse = 1.0 / total
        for c in range(stride):
            value = w[c] * inverse
            w[c] = value
            w[c + stride] = (w[c + stride] - slope * value) * inverse
    return stride
