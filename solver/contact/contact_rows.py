"""One contact of the solver: residual of its laws and their linearisation.

The laws of a contact are one nonsmooth equation between its impulses p and rates w (P. Alart and A. Curnier, Comput.
Methods Appl. Mech. Eng. 92 (1991)), with ``P = p + o`` and ``g = w + S p - b``::

    P_n = max(0, P_n - r_n g_n),        P_t = Proj_{|.| <= mu P_n} ( P_t - r_t g_t )

for any positive r_n, r_t; near 1/W of the contact they let Newton's method find the state of the contact best. Its step
reads ``dp = r - D dw``. As S is positive, that also exists in a closed contact, where p is no function of w otherwise;
D is not symmetric, because the bound of friction follows the normal impulse.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Records
from heavylift.solver.contact.laws import mean_normal_force
from heavylift.solver.contact.layout import (
    BILATERAL,
    COMPLIANT,
    CURVE,
    INACTIVE,
    UNILATERAL,
    RowKind,
    RowParameters,
)

__all__ = [
    "D00",
    "D10",
    "D11",
    "D12",
    "D20",
    "D21",
    "D22",
    "R0",
    "R1",
    "R2",
    "RECORD",
    "ROWS",
    "clip",
    "linearise",
    "linearise_unilateral",
    "rub",
]

RECORD = 10
"""Numbers of a linearised contact: r (3), entries 00, 10, 11, 12, 20, 21, 22 of D (the other two are zero)."""

R0, R1, R2, D00, D10, D11, D12, D20, D21, D22 = range(RECORD)

ROWS = 6
"""Numbers of the rows of a contact: softness S (3) and target b (3)."""


@kernel(inline=True, internal=True)
def _linearise_normal(
    kinds: Records[RowKind],
    parameters: Records[RowParameters],
    rows: NDArray[np.float64],
    c: int,
    p: float,
    w: float,
    r: float,
    record: NDArray[np.float64],
    at: int,
) -> tuple[float, float, float, float]:
    """Write the normal row; returns residual, impulse that bounds friction now and from p, derivative of it by p."""
    kind = kinds[c].kind
    P = p + parameters[c].offset[0]
    if kind == COMPLIANT:
        h, depth = parameters[c].step, parameters[c].depth
        S = rows[ROWS * c]
        _, force, slope = mean_normal_force(
            kinds[c].law,
            parameters[c].stiffness,
            parameters[c].exponent,
            parameters[c].damping,
            depth,
            depth - h * (w + S * p - rows[ROWS * c + 3]),
            h,
        )
        D = 0.5 * h * h * slope
        lack = (0.5 * h * force - p) / (1.0 + D * S)
        D /= 1.0 + D * S
        record[at + R0] = lack
        record[at + D00] = D
        error = lack / (r + D)
        predicted = P + r * error  # all of lack would bring the rounding of w into friction, D times
        return error, max(0.0, predicted), max(0.0, P), 1.0 if predicted > 0.0 else 0.0
    if kind in (UNILATERAL, BILATERAL):  # a set would be allocated
        S = rows[ROWS * c]
        g = w + S * p - rows[ROWS * c + 3]
        predicted = P - r * g
        if kind == BILATERAL or predicted > 0.0:
            record[at + R0] = -g / S
            record[at + D00] = 1.0 / S
            if kind == BILATERAL:
                return g, abs(P), abs(P), 1.0 if P >= 0.0 else -1.0
            return g, predicted, P, 1.0
        record[at + R0] = -P
        record[at + D00] = 0.0
        return P / r, 0.0, 0.0, 0.0
    record[at + R0] = -p  # given
    record[at + D00] = 0.0
    normal = max(0.0, parameters[c].offset[0])
    return p / r, normal, normal, 0.0


@kernel(inline=True, internal=True)
def rub(
    bound: float,
    target: float,
    slope: float,
    r0: float,
    D: float,
    P1: float,
    P2: float,
    g1: float,
    g2: float,
    S1: float,
    S2: float,
    r_t: float,
) -> tuple[float, float, float, float, float, float, float, float]:
    """Linearise friction.

    Parameters
    ----------
    bound, target, slope
        mu times the impulse on the normal as predicted, as it is, and its derivative by p.
    r0, D
        Of the record of the normal row.
    P1, P2, g1, g2, S1, S2, r_t
        See above, for the tangents.

    Returns
    -------
    r1, r2, D10, D20, D11, D12, D22, square
        Of the record, D21 = D12, and the squared residual.
    """
    x1, x2 = P1 - r_t * g1, P2 - r_t * g2
    size = math.sqrt(x1 * x1 + x2 * x2)
    if size <= bound:  # sticks
        i1, i2 = 1.0 / S1, 1.0 / S2
        return -g1 * i1, -g2 * i2, 0.0, 0.0, i1, 0.0, i2, g1 * g1 + g2 * g2
    over = 1.0 / size
    d1, d2, ratio = x1 * over, x2 * over, bound * over
    # (1 - e u.) dp_t = lack + slope d dp_n - ratio r_t e (e . dw_t), with e across d
    e1, e2 = -d2, d1
    u1, u2 = ratio * (1.0 - r_t * S1) * e1, ratio * (1.0 - r_t * S2) * e2
    beta = 1.0 / (1.0 - u1 * e1 - u2 * e2)
    lack1, lack2 = target * d1 - P1, target * d2 - P2
    along = beta * (u1 * lack1 + u2 * lack2)
    turn = slope * beta * (u1 * d1 + u2 * d2)
    f1, f2 = slope * d1 + turn * e1, slope * d2 + turn * e2  # dp_t by dp_n
    across = ratio * r_t * beta
    left1, left2 = P1 - bound * d1, P2 - bound * d2
    return (
        lack1 + along * e1 + f1 * r0,
        lack2 + along * e2 + f2 * r0,
        f1 * D,
        f2 * D,
        across * e1 * e1,
        across * e1 * e2,
        across * e2 * e2,
        (left1 * left1 + left2 * left2) / (r_t * r_t),
    )


@kernel(inline=True, internal=True)
def linearise_unilateral(
    parameters: Records[RowParameters],
    rows: NDArray[np.float64],
    c: int,
    p0: float,
    p1: float,
    p2: float,
    w0: float,
    w1: float,
    w2: float,
    r_n: float,
    r_t: float,
    record: NDArray[np.float64],
    at: int,
) -> float:
    """As `linearise`, for a contact that can only push: short enough to stand in the loop over contacts."""
    P0, P1, P2 = p0 + parameters[c].offset[0], p1 + parameters[c].offset[1], p2 + parameters[c].offset[2]
    S0, S1, S2 = rows[ROWS * c], rows[ROWS * c + 1], rows[ROWS * c + 2]
    g0 = w0 + S0 * p0 - rows[ROWS * c + 3]
    predicted, mu = P0 - r_n * g0, parameters[c].friction
    if predicted > 0.0:
        D = 1.0 / S0
        r0, square = -g0 * D, g0 * g0
        bound, target = mu * predicted, mu * P0
    else:
        D, r0, square = 0.0, -P0, (P0 / r_n) ** 2
        bound = target = 0.0
    record[at + R0], record[at + D00] = r0, D
    if bound <= 0.0 and target <= 0.0:  # no friction
        record[at + R1], record[at + R2] = -P1, -P2
        for i in range(D10, RECORD):
            record[at + i] = 0.0
        return square + (P1 * P1 + P2 * P2) / (r_t * r_t)
    g1 = w1 + S1 * p1 - rows[ROWS * c + 4]
    g2 = w2 + S2 * p2 - rows[ROWS * c + 5]
    r1, r2, a10, a20, a11, a12, a22, more = rub(bound, target, mu, r0, D, P1, P2, g1, g2, S1, S2, r_t)
    record[at + R1], record[at + R2] = r1, r2
    record[at + D10], record[at + D11], record[at + D12] = a10, a11, a12
    record[at + D20], record[at + D21], record[at + D22] = a20, a12, a22
    return square + more


@kernel(inline=True, internal=True)
def linearise(
    kinds: Records[RowKind],
    parameters: Records[RowParameters],
    rows: NDArray[np.float64],
    c: int,
    p: NDArray[np.float64],
    w: NDArray[np.float64],
    r_n: float,
    r_t: float,
    record: NDArray[np.float64],
    at: int,
) -> float:
    """Write the linearised laws of a contact; returns its squared residual in units of rate.

    Parameters
    ----------
    kinds, parameters
        Of all contacts, see the layout; softness and target are not read from there.
    rows
        Softness and target of the rows of all contacts.
    c
        Contact.
    p, w
        Impulses and rates of all rows.
    r_n, r_t
        Positive numbers of the size of 1/W of the contact.
    record, at
        The record begins at ``record[at]``.
    """
    kind = kinds[c].kind
    p0, p1, p2 = p[3 * c], p[3 * c + 1], p[3 * c + 2]
    if kind == INACTIVE:
        for i in range(RECORD):
            record[at + i] = 0.0
        record[at + R0], record[at + R1], record[at + R2] = -p0, -p1, -p2
        return (p0 / r_n) ** 2 + (p1 * p1 + p2 * p2) / (r_t * r_t)
    w0, w1, w2 = w[3 * c], w[3 * c + 1], w[3 * c + 2]
    if kind == CURVE:
        return _linearise_curve(parameters, rows, c, p0, p1, p2, w0, w1, w2, r_t, record, at)
    error_n, present, after, slope = _linearise_normal(kinds, parameters, rows, c, p0, w0, r_n, record, at)
    mu = parameters[c].friction
    P1, P2 = p1 + parameters[c].offset[1], p2 + parameters[c].offset[2]
    bound, target, slope = mu * present, mu * after, mu * slope
    if bound <= 0.0 and target <= 0.0:  # no friction
        for i in range(D10, RECORD):
            record[at + i] = 0.0
        record[at + R1], record[at + R2] = -P1, -P2
        return error_n * error_n + (P1 * P1 + P2 * P2) / (r_t * r_t)
    S1, S2 = rows[ROWS * c + 1], rows[ROWS * c + 2]
    g1 = w1 + S1 * p1 - rows[ROWS * c + 4]
    g2 = w2 + S2 * p2 - rows[ROWS * c + 5]
    r1, r2, a10, a20, a11, a12, a22, square = rub(
        bound, target, slope, record[at + R0], record[at + D00], P1, P2, g1, g2, S1, S2, r_t
    )
    record[at + R1], record[at + R2] = r1, r2
    record[at + D10], record[at + D11], record[at + D12] = a10, a11, a12
    record[at + D20], record[at + D21], record[at + D22] = a20, a12, a22
    return error_n * error_n + square


@kernel(internal=True)
def _linearise_curve(
    parameters: Records[RowParameters],
    rows: NDArray[np.float64],
    c: int,
    p0: float,
    p1: float,
    p2: float,
    w0: float,
    w1: float,
    w2: float,
    r_t: float,
    record: NDArray[np.float64],
    at: int,
) -> float:
    """Two equations and friction along the third row."""
    S0, S1, S2 = rows[ROWS * c], rows[ROWS * c + 1], rows[ROWS * c + 2]
    g0 = w0 + S0 * p0 - rows[ROWS * c + 3]
    g1 = w1 + S1 * p1 - rows[ROWS * c + 4]
    r0, r1 = -g0 / S0, -g1 / S1
    record[at + R0], record[at + R1] = r0, r1
    record[at + D00], record[at + D11] = 1.0 / S0, 1.0 / S1
    record[at + D10] = record[at + D12] = 0.0
    P0, P1, P2 = p0 + parameters[c].offset[0], p1 + parameters[c].offset[1], p2 + parameters[c].offset[2]
    mu = parameters[c].friction
    normal = math.sqrt(P0 * P0 + P1 * P1)
    bound, f0, f1 = mu * normal, 0.0, 0.0
    if normal > 0.0:
        f0, f1 = mu * P0 / normal, mu * P1 / normal
    g2, x = 0.0, P2
    if mu > 0.0:
        g2 = w2 + S2 * p2 - rows[ROWS * c + 5]
        x = P2 - r_t * g2
    if mu > 0.0 and abs(x) <= bound:
        record[at + R2] = -g2 / S2
        record[at + D20] = record[at + D21] = 0.0
        record[at + D22] = 1.0 / S2
        error = g2
    else:
        sign = 1.0 if x > 0.0 else -1.0
        record[at + R2] = sign * (bound + f0 * r0 + f1 * r1) - P2
        record[at + D20], record[at + D21] = sign * f0 / S0, sign * f1 / S1
        record[at + D22] = 0.0
        error = (P2 - sign * bound) / r_t
    return g0 * g0 + g1 * g1 + error * error


@kernel(internal=True)
def clip(kinds: Records[RowKind], parameters: Records[RowParameters], c: int, p: NDArray[np.float64]) -> None:
    """Remove what rounding left outside of the cone of friction."""
    kind = kinds[c].kind
    first = 3 * c
    if kind == INACTIVE:
        p[first] = p[first + 1] = p[first + 2] = 0.0
        return
    mu = parameters[c].friction
    normal = p[first] + parameters[c].offset[0]
    if kind == CURVE:
        bound = mu * math.hypot(normal, p[first + 1] + parameters[c].offset[1])
        o2 = parameters[c].offset[2]
        p[first + 2] = min(max(p[first + 2], -bound - o2), bound - o2)
        return
    if kind == UNILATERAL and normal < 0.0:
        p[first], normal = -parameters[c].offset[0], 0.0
    bound = mu * (abs(normal) if kind == BILATERAL else max(0.0, normal))
    P1, P2 = p[first + 1] + parameters[c].offset[1], p[first + 2] + parameters[c].offset[2]
    size = math.hypot(P1, P2)
    if size > bound:
        factor = bound / size
        p[first + 1] = factor * P1 - parameters[c].offset[1]
        p[first + 2] = factor * P2 - parameters[c].offset[2]
