"""Kernels: sums over the control points of a surface, with the basis of both directions.

The scratch holds the basis of u from 0 on and that of v from `BASIS_V` on, each as `write_basis` left it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from heavylift.contours.layout import COUNT_U, COUNT_V, DEGREE_U, DEGREE_V, LARGEST_DEGREE, NET, WEIGHTS
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["BASIS_V", "EVALUATION", "SCRATCH", "bicubic", "polynomial", "rational"]

EVALUATION = 18
"""Numbers of one evaluation: S 0:3, S_u 3:6, S_v 6:9, S_uu 9:12, S_uv 12:15, S_vv 15:18."""

BASIS_V = 3 * (LARGEST_DEGREE + 1)
BASIS_W = 2 * BASIS_V
ORDERS_U, ORDERS_V = (0, 1, 0, 2, 1, 0), (0, 0, 1, 0, 1, 2)
"""Of the derivatives in an evaluation."""

SCRATCH = 2 * BASIS_V + 6
"""Length of the scratch array of the kernels here: the basis of u, that of v, the weight function."""


@kernel(inline=True, internal=True)
def bicubic(
    contour: NDArray[np.int64],
    net: NDArray[np.float64],
    start_u: int,
    start_v: int,
    scratch: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:
    """Sums over 4 x 4 control points, everything in registers."""
    count_u = contour[COUNT_U]
    count_v = contour[COUNT_V]
    first = contour[NET]
    c0 = start_v
    c1 = start_v + 1
    c2 = start_v + 2
    c3 = start_v + 3
    # functions beyond the seam of a closed direction belong to its first control points
    c0 -= count_v if c0 >= count_v else 0
    c1 -= count_v if c1 >= count_v else 0
    c2 -= count_v if c2 >= count_v else 0
    c3 -= count_v if c3 >= count_v else 0
    n0, n1, n2, n3 = scratch[BASIS_V], scratch[BASIS_V + 1], scratch[BASIS_V + 2], scratch[BASIS_V + 3]
    d0, d1, d2, d3 = scratch[BASIS_V + 4], scratch[BASIS_V + 5], scratch[BASIS_V + 6], scratch[BASIS_V + 7]
    e0, e1, e2, e3 = scratch[BASIS_V + 8], scratch[BASIS_V + 9], scratch[BASIS_V + 10], scratch[BASIS_V + 11]
    for k in range(3):
        s = su = sv = suu = suv = svv = 0.0
        for i in range(4):
            row = start_u + i
            row = first + (row - count_u if row >= count_u else row) * count_v
            p0 = net[row + c0, k]
            p1 = net[row + c1, k]
            p2 = net[row + c2, k]
            p3 = net[row + c3, k]
            a = (n0 * p0 + n1 * p1) + (n2 * p2 + n3 * p3)
            b = (d0 * p0 + d1 * p1) + (d2 * p2 + d3 * p3)
            c = (e0 * p0 + e1 * p1) + (e2 * p2 + e3 * p3)
            n = scratch[i]
            d = scratch[4 + i]
            s += n * a
            sv += n * b
            svv += n * c
            su += d * a
            suv += d * b
            suu += scratch[8 + i] * a
        out[k] = s
        out[3 + k] = su
        out[6 + k] = sv
        out[9 + k] = suu
        out[12 + k] = suv
        out[15 + k] = svv


@kernel(internal=True)
def polynomial(
    contour: NDArray[np.int64],
    net: NDArray[np.float64],
    start_u: int,
    start_v: int,
    scratch: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:
    """Sums over the control points at any degrees."""
    count_u = contour[COUNT_U]
    count_v = contour[COUNT_V]
    wide_u = contour[DEGREE_U] + 1
    wide_v = contour[DEGREE_V] + 1
    for k in range(EVALUATION):
        out[k] = 0.0
    for i in range(wide_u):
        row = start_u + i
        row = contour[NET] + (row - count_u if row >= count_u else row) * count_v
        ax = ay = az = bx = by = bz = cx = cy = cz = 0.0
        for j in range(wide_v):
            column = start_v + j
            point = row + (column - count_v if column >= count_v else column)
            n = scratch[BASIS_V + j]
            d = scratch[BASIS_V + wide_v + j]
            e = scratch[BASIS_V + 2 * wide_v + j]
            x, y, z = net[point, 0], net[point, 1], net[point, 2]
            ax += n * x
            ay += n * y
            az += n * z
            bx += d * x
            by += d * y
            bz += d * z
            cx += e * x
            cy += e * y
            cz += e * z
        n = scratch[i]
        d = scratch[wide_u + i]
        e = scratch[2 * wide_u + i]
        out[0] += n * ax
        out[1] += n * ay
        out[2] += n * az
        out[3] += d * ax
        out[4] += d * ay
        out[5] += d * az
        out[6] += n * bx
        out[7] += n * by
        out[8] += n * bz
        out[9] += e * ax
        out[10] += e * ay
        out[11] += e * az
        out[12] += d * bx
        out[13] += d * by
        out[14] += d * bz
        out[15] += n * cx
        out[16] += n * cy
        out[17] += n * cz


@kernel(internal=True)
def rational(
    contour: NDArray[np.int64],
    weights: NDArray[np.float64],
    net: NDArray[np.float64],
    start_u: int,
    start_v: int,
    scratch: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:
    """Quotient of homogeneous sums (The NURBS Book, eq 4.20 for derivatives to order 2)."""
    count_u = contour[COUNT_U]
    count_v = contour[COUNT_V]
    wide_u = contour[DEGREE_U] + 1
    wide_v = contour[DEGREE_V] + 1
    for k in range(EVALUATION):
        out[k] = 0.0
    for k in range(6):
        scratch[BASIS_W + k] = 0.0
    for i in range(wide_u):
        row = start_u + i
        row = (row - count_u if row >= count_u else row) * count_v
        for j in range(wide_v):
            column = start_v + j
            local = row + (column - count_v if column >= count_v else column)
            weight = weights[contour[WEIGHTS] + local]
            for order in range(6):
                along = scratch[ORDERS_U[order] * wide_u + i]
                part = weight * along * scratch[BASIS_V + ORDERS_V[order] * wide_v + j]
                scratch[BASIS_W + order] += part
                for k in range(3):
                    out[3 * order + k] += part * net[contour[NET] + local, k]
    inverse = 1.0 / scratch[BASIS_W]
    wu = scratch[BASIS_W + 1]
    wv = scratch[BASIS_W + 2]
    wuu = scratch[BASIS_W + 3]
    wuv = scratch[BASIS_W + 4]
    wvv = scratch[BASIS_W + 5]
    for k in range(3):
        s = out[k] * inverse
        su = (out[3 + k] - wu * s) * inverse
        sv = (out[6 + k] - wv * s) * inverse
        out[k] = s
        out[3 + k] = su
        out[6 + k] = sv
        out[9 + k] = (out[9 + k] - 2.0 * wu * su - wuu * s) * inverse
        out[12 + k] = (out[12 + k] - wu * sv - wv * su - wuv * s) * inverse
        out[15 + k] = (out[15 + k] - 2.0 * wv * sv - wvv * s) * inverse
