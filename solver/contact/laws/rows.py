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
from heavylift.numerics.records import Record, Records, record_at
from heavylift.numerics.records import Vector as VectorField
from heavylift.numerics.vectors import Vector, add
from heavylift.solver.contact.laws.normal_force import mean_normal_force
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
    "RECORD",
    "ROWS",
    "LinearisedContact",
    "SolvedRows",
    "clip",
    "linearise",
    "linearise_unilateral",
    "linearised_contact",
    "solved_rows",
]


class LinearisedContact(Record):
    """``dp = r - D dw`` of a contact; the entries 01 and 02 of D are zero."""

    r: VectorField
    d00: float
    d10: float
    d11: float
    d12: float
    d20: float
    d21: float
    d22: float


class SolvedRows(Record):
    """Softness S [m/(s Ns)] and target b [m/s] of the rows of a contact, as the solver has them."""

    softness: VectorField
    target: VectorField


RECORD, ROWS = (of.layout.itemsize // 8 for of in (LinearisedContact, SolvedRows))
"""Numbers of these in the workspace of the solver."""

linearised_contact, solved_rows = record_at(LinearisedContact), record_at(SolvedRows)


@kernel(inline=True, internal=True)
def _linearise_normal(
    kind: RowKind,
    parameters: RowParameters,
    row: SolvedRows,
    p: float,
    w: float,
    r: float,
    record: LinearisedContact,
) -> tuple[float, float, float, float]:
    """Write the normal row; returns residual, impulse that bounds friction now and from p, derivative of it by p."""
    P = p + parameters.offset[0]
    if kind.kind == COMPLIANT:
        h, depth = parameters.step, parameters.depth
        S = row.softness[0]
        _, force, slope = mean_normal_force(
            kind.law,
            parameters.stiffness,
            parameters.exponent,
            parameters.damping,
            depth,
            depth - h * (w + S * p - row.target[0]),
            h,
        )
        D = 0.5 * h * h * slope
        lack = (0.5 * h * force - p) / (1.0 + D * S)
        D /= 1.0 + D * S
        record.r[0] = lack
        record.d00 = D
        error = lack / (r + D)
        predicted = P + r * error  # all of lack would bring the rounding of w into friction, D times
        return error, max(0.0, predicted), max(0.0, P), 1.0 if predicted > 0.0 else 0.0
    if kind.kind in (UNILATERAL, BILATERAL):  # a set would be allocated
        S = row.softness[0]
        g = w + S * p - row.target[0]
        predicted = P - r * g
        if kind.kind == BILATERAL or predicted > 0.0:
            record.r[0] = -g / S
            record.d00 = 1.0 / S
            if kind.kind == BILATERAL:
                return g, abs(P), abs(P), 1.0 if P >= 0.0 else -1.0
            return g, predicted, P, 1.0
        record.r[0] = -P
        record.d00 = 0.0
        return P / r, 0.0, 0.0, 0.0
    record.r[0] = -p  # given
    record.d00 = 0.0
    normal = max(0.0, parameters.offset[0])
    return p / r, normal, normal, 0.0


@kernel(inline=True, internal=True)
def _linearise_friction(
    parameters: RowParameters,
    row: SolvedRows,
    p: Vector,
    w: Vector,
    cone: tuple[float, float, float],
    r_t: float,
    record: LinearisedContact,
) -> float:
    """Write both tangents; returns their squared residual.

    Parameters
    ----------
    parameters, row, p, w, r_t
        As for `linearise`.
    cone
        mu times the impulse on the normal as predicted, as it is, and its derivative by p.
    record
        Its normal row is there.
    """
    bound, target, slope = cone
    P1, P2 = p[1] + parameters.offset[1], p[2] + parameters.offset[2]
    if bound <= 0.0 and target <= 0.0:  # no friction
        record.r[1], record.r[2] = -P1, -P2
        record.d10 = record.d11 = record.d12 = record.d20 = record.d21 = record.d22 = 0.0
        return (P1 * P1 + P2 * P2) / (r_t * r_t)
    S1, S2 = row.softness[1], row.softness[2]
    g1 = w[1] + S1 * p[1] - row.target[1]
    g2 = w[2] + S2 * p[2] - row.target[2]
    x1, x2 = P1 - r_t * g1, P2 - r_t * g2
    size = math.sqrt(x1 * x1 + x2 * x2)
    if size <= bound:  # sticks
        i1, i2 = 1.0 / S1, 1.0 / S2
        record.r[1], record.r[2] = -g1 * i1, -g2 * i2
        record.d10 = record.d12 = record.d20 = record.d21 = 0.0
        record.d11, record.d22 = i1, i2
        return g1 * g1 + g2 * g2
    r0, D = record.r[0], record.d00
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
    record.r[1], record.r[2] = lack1 + along * e1 + f1 * r0, lack2 + along * e2 + f2 * r0
    record.d10, record.d20 = f1 * D, f2 * D
    record.d11, record.d22 = across * e1 * e1, across * e2 * e2
    record.d12 = record.d21 = across * e1 * e2
    return (left1 * left1 + left2 * left2) / (r_t * r_t)


@kernel(inline=True, internal=True)
def linearise_unilateral(
    parameters: RowParameters,
    row: SolvedRows,
    p: Vector,
    w: Vector,
    r_n: float,
    r_t: float,
    record: LinearisedContact,
) -> float:
    """As `linearise`, for a contact that can only push: short enough to stand in the loop over contacts."""
    P0, S0, mu = p[0] + parameters.offset[0], row.softness[0], parameters.friction
    g0 = w[0] + S0 * p[0] - row.target[0]
    predicted = P0 - r_n * g0
    if predicted > 0.0:
        D = 1.0 / S0
        r0, square = -g0 * D, g0 * g0
        bound, target = mu * predicted, mu * P0
    else:
        D, r0, square = 0.0, -P0, (P0 / r_n) ** 2
        bound = target = 0.0
    record.r[0], record.d00 = r0, D
    return square + _linearise_friction(parameters, row, p, w, (bound, target, mu), r_t, record)


@kernel(inline=True, internal=True)
def linearise(
    kind: RowKind,
    parameters: RowParameters,
    row: SolvedRows,
    p: Vector,
    w: Vector,
    r_n: float,
    r_t: float,
    record: LinearisedContact,
) -> float:
    """Write the linearised laws of a contact; returns its squared residual in units of rate.

    Parameters
    ----------
    kind, parameters
        Of the contact, see the layout; softness and target are not read from there.
    row
        Softness and target of its rows.
    p, w
        Impulses and rates of its rows.
    r_n, r_t
        Positive numbers of the size of 1/W of the contact.
    record
        Written.
    """
    if kind.kind == INACTIVE:
        record.r[0], record.r[1], record.r[2] = -p[0], -p[1], -p[2]
        record.d00 = record.d10 = record.d11 = record.d12 = record.d20 = record.d21 = record.d22 = 0.0
        return (p[0] / r_n) ** 2 + (p[1] * p[1] + p[2] * p[2]) / (r_t * r_t)
    if kind.kind == CURVE:
        return _linearise_curve(parameters, row, p, w, r_t, record)
    error, present, after, slope = _linearise_normal(kind, parameters, row, p[0], w[0], r_n, record)
    mu = parameters.friction
    cone = (mu * present, mu * after, mu * slope)
    return error * error + _linearise_friction(parameters, row, p, w, cone, r_t, record)


@kernel(internal=True)
def _linearise_curve(
    parameters: RowParameters,
    row: SolvedRows,
    p: Vector,
    w: Vector,
    r_t: float,
    record: LinearisedContact,
) -> float:
    """Two equations and friction along the third row."""
    S0, S1, S2 = row.softness[0], row.softness[1], row.softness[2]
    g0 = w[0] + S0 * p[0] - row.target[0]
    g1 = w[1] + S1 * p[1] - row.target[1]
    r0, r1 = -g0 / S0, -g1 / S1
    record.r[0], record.r[1] = r0, r1
    record.d00, record.d11 = 1.0 / S0, 1.0 / S1
    record.d10 = record.d12 = 0.0
    P0, P1, P2 = add(p, parameters.offset)
    mu = parameters.friction
    normal = math.sqrt(P0 * P0 + P1 * P1)
    bound, f0, f1 = mu * normal, 0.0, 0.0
    if normal > 0.0:
        f0, f1 = mu * P0 / normal, mu * P1 / normal
    g2, x = 0.0, P2
    if mu > 0.0:
        g2 = w[2] + S2 * p[2] - row.target[2]
        x = P2 - r_t * g2
    if mu > 0.0 and abs(x) <= bound:
        record.r[2] = -g2 / S2
        record.d20 = record.d21 = 0.0
        record.d22 = 1.0 / S2
        error = g2
    else:
        sign = 1.0 if x > 0.0 else -1.0
        record.r[2] = sign * (bound + f0 * r0 + f1 * r1) - P2
        record.d20, record.d21 = sign * f0 / S0, sign * f1 / S1
        record.d22 = 0.0
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
