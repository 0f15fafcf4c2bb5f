"""Forces of springs and ropes over a step: discrete gradients of their energies.

A midpoint force evaluated in the middle of a step gains or loses energy where a rope goes slack or a
table bends. The mean of the force over the way from the elongation ``e0`` to ``e1`` does not: its work is
exactly the change of the stored energy (O. Gonzalez, J. Nonlinear Science 6, 1996)::

    F = ( U(e1) - U(e0) ) / (e1 - e0)

Where the force is linear that is the force in the middle. All forces here grow with ``e1``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel

__all__ = ["mean_force", "pull", "spring_force"]


@kernel(inline=True, internal=True)
def pull(e0: float, e1: float, k: float, c: float, h: float) -> tuple[float, float, float]:
    """Tension of something that pulls and never pushes, ``U = k/2 max(0, e)^2``, mean over a step.

    Parameters
    ----------
    e0, e1
        Elongation at the start and at the end of the step [m].
    k, c, h
        Stiffness [N/m], damping [N s/m], step [s].

    Returns
    -------
    elastic
        The discrete gradient of the energy [N].
    tension
        With the damper, which acts for the taut part of the step; not below zero [N].
    slope
        Derivative of the tension by ``e1`` [N/m].
    """
    if e1 > 0.0:
        if e0 > 0.0:
            elastic, slope = 0.5 * k * (e0 + e1), 0.5 * k
            damper = c * (e1 - e0) / h
        else:
            span = e1 - e0
            elastic, slope = 0.5 * k * e1 * e1 / span, 0.5 * k * e1 * (e1 - 2.0 * e0) / (span * span)
            damper = c * e1 / h
        slope += c / h
    elif e0 > 0.0:
        span = e0 - e1
        elastic, slope = 0.5 * k * e0 * e0 / span, 0.5 * k * e0 * e0 / (span * span)
        damper = -c * e0 / h
    else:
        return 0.0, 0.0, 0.0
    tension = elastic + damper
    if tension <= 0.0:
        return elastic, 0.0, 0.0
    return elastic, tension, slope


@kernel(internal=True)
def _segment(table: NDArray[np.float64], first: int, count: int, e: float) -> int:
    """Row of the table at which the segment that serves e begins; the outer ones go on for ever."""
    low, high = first, first + count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if table[middle, 0] <= e:
            low = middle
        else:
            high = middle
    return low


@kernel(inline=True, internal=True)
def _slope(table: NDArray[np.float64], row: int) -> float:
    return (table[row + 1, 1] - table[row, 1]) / (table[row + 1, 0] - table[row, 0])


@kernel(internal=True)
def spring_force(table: NDArray[np.float64], first: int, count: int, k: float, e: float) -> float:
    """Force at an elongation: ``k e``, or from rows (elongation, force) of a table if `count` is not 0."""
    if count == 0:
        return k * e
    row = _segment(table, first, count, e)
    return table[row, 1] + _slope(table, row) * (e - table[row, 0])


@kernel(internal=True)
def mean_force(
    table: NDArray[np.float64], first: int, count: int, k: float, e0: float, e1: float
) -> tuple[float, float]:
    """Mean of `spring_force` from ``e0`` to ``e1``, and its derivative by ``e1``."""
    if count == 0:
        return 0.5 * k * (e0 + e1), 0.5 * k
    start, end = _segment(table, first, count, e0), _segment(table, first, count, e1)
    f0, f1 = spring_force(table, first, count, k, e0), spring_force(table, first, count, k, e1)
    if start == end:
        return 0.5 * (f0 + f1), 0.5 * _slope(table, start)
    sign = 1.0 if end > start else -1.0
    x, f = (e0, f0) if end > start else (e1, f1)
    area = 0.0
    for row in range(min(start, end) + 1, max(start, end) + 1):
        area += 0.5 * (f + table[row, 1]) * (table[row, 0] - x)
        x, f = table[row, 0], table[row, 1]
    last, force = (e1, f1) if end > start else (e0, f0)
    area += 0.5 * (f + force) * (last - x)
    span = sign * (e1 - e0)
    mean = area / span
    return mean, max(0.0, (f1 - mean) / (e1 - e0))
