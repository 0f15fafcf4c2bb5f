"""Kernels: sums over the control points of a surface, with the basis of both directions.

The scratch holds the basis of u from 0 on and that of v from `BASIS_V` on, each as `write_basis` left it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from heavylift.contours.splines.limits import LARGEST_DEGREE
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, Vector

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.splines.packed_contour import PackedContour

__all__ = ["BASIS_V", "SCRATCH", "Evaluation", "bicubic", "polynomial", "rational"]


class Evaluation(Record):
    """A contour at one place (u, v).

    Attributes
    ----------
    position
        S [m].
    tangent_u, tangent_v
        First derivatives S_u, S_v by the parameters [m].
    derivative_uu, derivative_uv, derivative_vv
        Second derivatives S_uu, S_uv, S_vv [m].
    """

    position: Vector
    tangent_u: Vector
    tangent_v: Vector
    derivative_uu: Vector
    derivative_uv: Vector
    derivative_vv: Vector


BASIS_V = 3 * (LARGEST_DEGREE + 1)

SCRATCH = 2 * BASIS_V
"""Length of the scratch array of the kernels here: the basis of u, that of v."""


@kernel(inline=True, internal=True)
def _clear(out: Evaluation) -> None:
    """Begin sums."""
    for k in range(3):
        out.position[k] = 0.0
        out.tangent_u[k] = 0.0
        out.tangent_v[k] = 0.0
        out.derivative_uu[k] = 0.0
        out.derivative_uv[k] = 0.0
        out.derivative_vv[k] = 0.0


@kernel(inline=True, internal=True)
def bicubic(
    contour: PackedContour,
    net: NDArray[np.float64],
    start_u: int,
    start_v: int,
    scratch: NDArray[np.float64],
    out: Evaluation,
) -> None:
    """Sums over 4 x 4 control points, everything in registers."""
    count_u = contour.u.count
    count_v = contour.v.count
    first = contour.first_control
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
        out.position[k] = s
        out.tangent_u[k] = su
        out.tangent_v[k] = sv
        out.derivative_uu[k] = suu
        out.derivative_uv[k] = suv
        out.derivative_vv[k] = svv


@kernel(internal=True)
def polynomial(
    contour: PackedContour,
    net: NDArray[np.float64],
    start_u: int,
    start_v: int,
    scratch: NDArray[np.float64],
    out: Evaluation,
) -> None:
    """Sums over the control points at any degrees."""
    count_u = contour.u.count
    count_v = contour.v.count
    wide_u = contour.u.degree + 1
    wide_v = contour.v.degree + 1
    _clear(out)
    for i in range(wide_u):
        row = start_u + i
        row = contour.first_control + (row - count_u if row >= count_u else row) * count_v
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
        out.position[0] += n * ax
        out.position[1] += n * ay
        out.position[2] += n * az
        out.tangent_u[0] += d * ax
        out.tangent_u[1] += d * ay
        out.tangent_u[2] += d * az
        out.tangent_v[0] += n * bx
        out.tangent_v[1] += n * by
        out.tangent_v[2] += n * bz
        out.derivative_uu[0] += e * ax
        out.derivative_uu[1] += e * ay
        out.derivative_uu[2] += e * az
        out.derivative_uv[0] += d * bx
        out.derivative_uv[1] += d * by
        out.derivative_uv[2] += d * bz
        out.derivative_vv[0] += n * cx
        out.derivative_vv[1] += n * cy
        out.derivative_vv[2] += n * cz


@kernel(internal=True)
def rational(
    contour: PackedContour,
    weights: NDArray[np.float64],
    net: NDArray[np.float64],
    start_u: int,
    start_v: int,
    scratch: NDArray[np.float64],
    out: Evaluation,
) -> None:
    """Quotient of homogeneous sums (The NURBS Book, eq 4.20 for derivatives to order 2)."""
    count_u = contour.u.count
    count_v = contour.v.count
    wide_u = contour.u.degree + 1
    wide_v = contour.v.degree + 1
    _clear(out)
    w = wu = wv = wuu = wuv = wvv = 0.0
    for i in range(wide_u):
        row = start_u + i
        row = (row - count_u if row >= count_u else row) * count_v
        for j in range(wide_v):
            column = start_v + j
            local = row + (column - count_v if column >= count_v else column)
            weight = weights[contour.first_weight + local]
            n = weight * scratch[i]
            d = weight * scratch[wide_u + i]
            e = weight * scratch[2 * wide_u + i]
            part = n * scratch[BASIS_V + j]
            part_u = d * scratch[BASIS_V + j]
            part_v = n * scratch[BASIS_V + wide_v + j]
            part_uu = e * scratch[BASIS_V + j]
            part_uv = d * scratch[BASIS_V + wide_v + j]
            part_vv = n * scratch[BASIS_V + 2 * wide_v + j]
            w += part
            wu += part_u
            wv += part_v
            wuu += part_uu
            wuv += part_uv
            wvv += part_vv
            for k in range(3):
                p = net[contour.first_control + local, k]
                out.position[k] += part * p
                out.tangent_u[k] += part_u * p
                out.tangent_v[k] += part_v * p
                out.derivative_uu[k] += part_uu * p
                out.derivative_uv[k] += part_uv * p
                out.derivative_vv[k] += part_vv * p
    inverse = 1.0 / w
    for k in range(3):
        s = out.position[k] * inverse
        su = (out.tangent_u[k] - wu * s) * inverse
        sv = (out.tangent_v[k] - wv * s) * inverse
        out.position[k] = s
        out.tangent_u[k] = su
        out.tangent_v[k] = sv
        out.derivative_uu[k] = (out.derivative_uu[k] - 2.0 * wu * su - wuu * s) * inverse
        out.derivative_uv[k] = (out.derivative_uv[k] - wu * sv - wv * su - wuv * s) * inverse
        out.derivative_vv[k] = (out.derivative_vv[k] - 2.0 * wv * sv - wvv * s) * inverse
