"""Kernels: control points of flexible bodies from modal coordinates, and the shapes at a touched point.

Data of a control point stand together: its undeformed place (3), then its mode shapes component by component
(3 x modes). Four control points are taken at once, so that every coordinate and every sum is loaded a quarter as often:
these loops, not the spline, are what a contact of a body with many modes costs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.splines.neutral import NeutralContour

__all__ = ["modal_data", "modal_points", "modal_shapes"]


def modal_data(contour: NeutralContour) -> NDArray[np.float64]:
    """Places and mode shapes of the control points as the kernels read them, shape (n (3 + 3 modes),)."""
    count = len(contour.control)
    shapes = contour.modal.transpose(1, 2, 0).reshape(count, -1)
    return np.ascontiguousarray(np.concatenate([contour.control, shapes], axis=1).ravel())


@kernel(internal=True, reassociate=True)
def modal_points(
    data: NDArray[np.float64],
    begin: int,
    modes: int,
    q: NDArray[np.float64],
    at_q: int,
    controls: NDArray[np.int64],
    count: int,
    net: NDArray[np.float64],
    first: int,
) -> None:
    """Place of some control points: ``P_0 + P_Phi q``.

    Parameters
    ----------
    data, begin, modes
        Of `modal_data`; where those of the contour begin.
    q, at_q
        Modal coordinates, and where they begin.
    controls, count
        Local indices of control points, and how many.
    net, first
        Control point c goes to ``net[first + c]``.
    """
    width = 3 + 3 * modes
    x = q[at_q : at_q + modes]
    done = count - count % 4
    for c in range(0, done, 4):
        p0, p1, p2, p3 = controls[c], controls[c + 1], controls[c + 2], controls[c + 3]
        a0, a1 = begin + p0 * width, begin + p1 * width
        a2, a3 = begin + p2 * width, begin + p3 * width
        for k in range(3):
            s0, s1, s2, s3 = data[a0 + k], data[a1 + k], data[a2 + k], data[a3 + k]
            skip = 3 + k * modes
            # views from zero on: with offsets in the index the loop is not vectorised
            d0 = data[a0 + skip : a0 + skip + modes]
            d1 = data[a1 + skip : a1 + skip + modes]
            d2 = data[a2 + skip : a2 + skip + modes]
            d3 = data[a3 + skip : a3 + skip + modes]
            for i in range(modes):
                s0 += d0[i] * x[i]
                s1 += d1[i] * x[i]
                s2 += d2[i] * x[i]
                s3 += d3[i] * x[i]
            net[first + p0, k] = s0
            net[first + p1, k] = s1
            net[first + p2, k] = s2
            net[first + p3, k] = s3
    for c in range(done, count):
        place = begin + controls[c] * width
        for k in range(3):
            total = data[place + k]
            skip = place + 3 + k * modes
            d = data[skip : skip + modes]
            for i in range(modes):
                total += d[i] * x[i]
            net[first + controls[c], k] = total


@kernel(internal=True, reassociate=True)
def modal_shapes(
    data: NDArray[np.float64],
    begin: int,
    modes: int,
    controls: NDArray[np.int64],
    count: int,
    w: NDArray[np.float64],
    at_w: int,
    out: NDArray[np.float64],
    at: int,
) -> None:
    """Mode shapes at a point of the contour, or their derivatives along it: weighted sums over its control points.

    Parameters
    ----------
    data, begin, modes, controls, count
        See `modal_points`.
    w, at_w
        Weights from `surface_weights`, and where those of the wanted derivative begin.
    out, at
        ``out[at + k * modes + i]`` is component k of mode i.
    """
    width = 3 + 3 * modes
    length = 3 * modes
    sums = out[at : at + length]
    for i in range(length):
        sums[i] = 0.0
    done = count - count % 4
    for c in range(0, done, 4):
        a0, a1 = begin + controls[c] * width + 3, begin + controls[c + 1] * width + 3
        a2, a3 = begin + controls[c + 2] * width + 3, begin + controls[c + 3] * width + 3
        w0, w1, w2, w3 = w[at_w + c], w[at_w + c + 1], w[at_w + c + 2], w[at_w + c + 3]
        d0, d1, d2, d3 = (
            data[a0 : a0 + length],
            data[a1 : a1 + length],
            data[a2 : a2 + length],
            data[a3 : a3 + length],
        )
        for i in range(length):
            sums[i] += (w0 * d0[i] + w1 * d1[i]) + (w2 * d2[i] + w3 * d3[i])
    for c in range(done, count):
        place = begin + controls[c] * width + 3
        weight = w[at_w + c]
        d = data[place : place + length]
        for i in range(length):
            sums[i] += weight * d[i]
