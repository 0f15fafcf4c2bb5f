"""Kernels of the B-spline basis: the span of a parameter, its non-zero functions and their first two derivatives.

"Deformable bodies with complex geometries ... sliding contacts" (2014), section 3.2.1.

Piegl & Tiller, The NURBS Book, algorithms A2.1 to A2.3, arranged so that nothing but the result is stored: values of
degree ``p - 2`` are differenced twice, those of degree ``p - 1`` once, and the same values continue to degree p.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["find_span", "wrap", "write_basis"]

STEPS = 4
"""Of walking from a guessed span before the search by halves begins."""


@kernel(inline=True, internal=True)
def wrap(u: float, closed: int) -> float:
    """Parameter in the domain: in [0, 1) on a closed contour, at the nearer end beyond an open one."""
    if closed:
        inside = u - np.floor(u)
        return 0.0 if inside >= 1.0 else inside  # a tiny negative parameter rounds to 1
    return min(max(u, 0.0), 1.0)


@kernel(inline=True, internal=True)
def find_span(knots: NDArray[np.float64], first: int, degree: int, functions: int, u: float) -> int:
    """Index of the last function that is not zero at a parameter (A2.1).

    Parameters
    ----------
    knots, first
        Flat array, and the place in it where the knots of the space begin.
    degree, functions
        Of the space: ``count`` functions if open, ``count + degree`` if closed.
    u
        Parameter in [0, 1].

    Returns
    -------
    int
        span with ``knots[first + span] <= u < knots[first + span + 1]``; at the end of the domain its last piece that
        has a length.
    """
    low = degree
    high = functions - 1
    guess = u * (
        functions - degree
    )  # exact for even knots; not a number has no span, and stays in the result
    span = min(degree + (int(guess) if guess > 0.0 else 0), high)
    for _ in range(STEPS):
        if u < knots[first + span] and span > low:
            span -= 1
        elif u >= knots[first + span + 1] and span < high:
            span += 1
        else:
            break
    if u < knots[first + span]:
        high = span
        while high - low > 1:
            middle = (low + high) // 2
            if u < knots[first + middle]:
                high = middle
            else:
                low = middle
        span = low
    elif u >= knots[first + span + 1] and span < high:
        low = span
        high += 1
        while high - low > 1:
            middle = (low + high) // 2
            if u < knots[first + middle]:
                high = middle
            else:
                low = middle
        span = low
    while knots[first + span] == knots[first + span + 1] and span > degree:
        span -= 1  # the end of the domain with a knot that stands several times
    return span


@kernel(inline=True, internal=True)
def raise_values(
    knots: NDArray[np.float64],
    first: int,
    span: int,
    degree: int,
    u: float,
    out: NDArray[np.float64],
    at: int,
) -> None:
    """Turn the non-zero functions of one degree less into those of this degree, in place (A2.2)."""
    saved = 0.0
    for r in range(degree):
        right_knot = knots[first + span + 1 + r]
        left_knot = knots[first + span + 1 - degree + r]
        part = out[at + r] / (right_knot - left_knot)
        out[at + r] = saved + (right_knot - u) * part
        saved = (u - left_knot) * part
    out[at + degree] = saved


@kernel(inline=True, internal=True)
def difference(
    knots: NDArray[np.float64], first: int, span: int, degree: int, out: NDArray[np.float64], at: int
) -> None:
    """Turn functions of one degree less, or derivatives of them, into derivatives of this degree, in place (eq 2.7)."""
    saved = 0.0
    for r in range(degree):
        width = knots[first + span + 1 + r] - knots[first + span + 1 - degree + r]
        quotient = degree * out[at + r] / width
        out[at + r] = saved - quotient
        saved = quotient
    out[at + degree] = saved


@kernel(inline=True, internal=True)
def write_cubic(
    knots: NDArray[np.float64], first: int, span: int, u: float, out: NDArray[np.float64], at: int
) -> None:
    """`write_basis` of degree 3, without loops and with every division done once."""
    k = first + span
    t1 = knots[k]
    t2 = knots[k + 1]
    left2 = knots[k - 1]
    left3 = knots[k - 2]
    right2 = knots[k + 2]
    right3 = knots[k + 3]
    a = u - t1
    b = t2 - u
    # inverse widths of the supports of degree 1; 2, 2; 3, 3, 3
    d1 = 1.0 / (t2 - t1)
    d20 = 1.0 / (t2 - left2)
    d21 = 1.0 / (right2 - t1)
    d30 = 1.0 / (t2 - left3)
    d31 = 1.0 / (right2 - left2)
    d32 = 1.0 / (right3 - t1)
    # degree 1 and 2
    n10 = b * d1
    n11 = a * d1
    p0 = n10 * d20
    p1 = n11 * d21
    n20 = b * p0
    n21 = (u - left2) * p0 + (right2 - u) * p1
    n22 = a * p1
    # degree 3
    q0 = n20 * d30
    q1 = n21 * d31
    q2 = n22 * d32
    out[at] = b * q0
    out[at + 1] = (u - left3) * q0 + (right2 - u) * q1
    out[at + 2] = (u - left2) * q1 + (right3 - u) * q2
    out[at + 3] = a * q2
    out[at + 4] = -3.0 * q0
    out[at + 5] = 3.0 * (q0 - q1)
    out[at + 6] = 3.0 * (q1 - q2)
    out[at + 7] = 3.0 * q2
    # derivatives of degree 2, then of those of degree 3
    e0 = -6.0 * p0 * d30
    e1 = 6.0 * (p0 - p1) * d31
    e2 = 6.0 * p1 * d32
    out[at + 8] = -e0
    out[at + 9] = e0 - e1
    out[at + 10] = e1 - e2
    out[at + 11] = e2


@kernel(internal=True)
def write_any(
    knots: NDArray[np.float64],
    first: int,
    degree: int,
    span: int,
    u: float,
    out: NDArray[np.float64],
    at: int,
) -> None:
    """`write_basis` of any degree."""
    wide = degree + 1
    for k in range(3 * wide):
        out[at + k] = 0.0
    out[at] = 1.0
    for d in range(1, degree + 1):
        # now the row of values holds degree d - 1
        if d == degree - 1:
            for k in range(d):
                out[at + 2 * wide + k] = out[at + k]
            difference(knots, first, span, d, out, at + 2 * wide)
            difference(knots, first, span, d + 1, out, at + 2 * wide)
        if d == degree:
            for k in range(d):
                out[at + wide + k] = out[at + k]
            difference(knots, first, span, d, out, at + wide)
        raise_values(knots, first, span, d, u, out, at)


@kernel(inline=True, internal=True)
def write_basis(
    knots: NDArray[np.float64],
    first: int,
    degree: int,
    span: int,
    u: float,
    out: NDArray[np.float64],
    at: int,
) -> None:
    """Functions ``span - degree`` to ``span`` and their first and second derivatives at a parameter.

    Parameters
    ----------
    knots, first, degree
        Of the space, see `find_span`.
    span, u
        Parameter and its span.
    out, at
        Function ``span - degree + k`` goes to ``out[at + k]``, its derivatives to ``out[at + degree + 1 + k]`` and
        ``out[at + 2 (degree + 1) + k]``.
    """
    if degree == 3:
        write_cubic(knots, first, span, u, out, at)
    else:
        write_any(knots, first, degree, span, u, out, at)
