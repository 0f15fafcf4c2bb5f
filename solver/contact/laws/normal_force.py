"""Normal forces of compliant contacts over a step: discrete gradients of their energies.

Depth d is positive where the bodies overlap. The elastic part is the mean over the way from ``d0`` to ``d1``::

    F = ( U(d1) - U(d0) ) / (d1 - d0)

so its work is exactly the change of the stored energy, also in a step in which the bodies touch or part (O. Gonzalez,
J. Nonlinear Science 6, 1996). Dampers act for the part of the step with contact. No force ever pulls, and all grow
with ``d1``, which gives every step one solution.

Laws: linear ``k d + c d'``; Hertz ``k d^(3/2)``; ``k d^n (1 + a d')`` of K. H. Hunt and F. R. E. Crossley, J. Applied
Mechanics 42 (1975).
"""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.layout import HERTZ, LINEAR

__all__ = ["hunt_crossley_damping", "mean_normal_force", "normal_force", "stored_energy"]

SMALLEST_RESTITUTION = 1e-6


@kernel(inline=True, internal=True)
def _exponent(law: int, exponent: float) -> float:
    if law == LINEAR:
        return 1.0
    return 1.5 if law == HERTZ else exponent


@kernel
def stored_energy(law: int, k: float, exponent: float, d: float) -> float:
    """Elastic energy [J] at a depth: ``k d^(n+1) / (n+1)``.

    Parameters
    ----------
    law
        LINEAR, HERTZ or HUNT_CROSSLEY of the layout; the exponent is read for the last.
    k, exponent
        Stiffness [N/m^n] and n.
    d
        Depth [m].
    """
    if d <= 0.0:
        return 0.0
    n = _exponent(law, exponent)
    return k * d ** (n + 1.0) / (n + 1.0)


@kernel
def normal_force(law: int, k: float, exponent: float, damping: float, d: float, rate: float) -> float:
    """Force [N] at a depth d [m] that grows with a rate [m/s]; damping is c [N s/m] or a [s/m]."""
    if d <= 0.0:
        return 0.0
    if law == LINEAR:
        return max(0.0, k * d + damping * rate)
    if law == HERTZ:
        return k * d * math.sqrt(d)
    return k * d**exponent * max(0.0, 1.0 + damping * rate)


@kernel(inline=True, internal=True)
def _mean_power(k: float, n: float, d0: float, d1: float) -> tuple[float, float]:
    """Mean of ``k max(0, d)^n`` from d0 to d1 and its derivative by d1, without cancellation for d1 near d0."""
    if d0 <= 0.0 and d1 <= 0.0:
        return 0.0, 0.0
    span = d1 - d0
    if d0 <= 0.0 or d1 <= 0.0:
        deepest = max(d0, d1)
        force = k * math.sqrt(deepest) * deepest if n == 1.5 else k * deepest**n
        mean = force * deepest / ((n + 1.0) * abs(span))
        end = force if d1 > 0.0 else 0.0
        return mean, (end - mean) / span
    if n == 1.0:
        return 0.5 * k * (d0 + d1), 0.5 * k
    x = span / d0
    if n == 1.5:
        s0, s1 = math.sqrt(d0), math.sqrt(d1)
        mean = 0.4 * k * (s1 * s1 * (s1 * s1 + s1 * s0 + s0 * s0) + s0 * s0 * s0 * (s1 + s0)) / (s1 + s0)
        end = k * d1 * s1
    else:
        end = k * d1**n
        if abs(x) < 1e-8:
            mean = k * d0**n * (1.0 + 0.5 * n * x)
        else:
            mean = k * d0**n * math.expm1((n + 1.0) * math.log1p(x)) / ((n + 1.0) * x)
    if abs(x) < 1e-5:
        return mean, k * n * d0 ** (n - 1.0) * (0.5 + (n - 1.0) * x / 3.0)
    return mean, (end - mean) / span


@kernel(inline=True, internal=True)
def _mean_linear(k: float, c: float, d0: float, d1: float, h: float) -> tuple[float, float, float]:
    """Mean of ``max(0, k d + c d')`` over the part of the step with contact."""
    elastic, slope = _mean_power(k, 1.0, d0, d1)
    span = d1 - d0
    if span >= 0.0:
        if d1 <= 0.0:
            return 0.0, 0.0, 0.0
        return elastic, elastic + c * (d1 - max(0.0, d0)) / h, slope + c / h
    if d0 <= 0.0 or k <= 0.0:
        return elastic, 0.0, 0.0
    lost = -c * span / (k * h)  # depth at which the damper has used up the force while the bodies part
    if d1 >= lost:
        return elastic, elastic + c * span / h, slope + c / h
    if d0 <= lost:
        return elastic, 0.0, 0.0
    pressed = d0 - lost
    return (
        elastic,
        -0.5 * k * pressed * pressed / span,
        0.5 * k * pressed * (pressed + 2.0 * lost) / (span * span),
    )


@kernel
def mean_normal_force(
    law: int, k: float, exponent: float, damping: float, d0: float, d1: float, h: float
) -> tuple[float, float, float]:
    """Mean force over a step with constant rate of depth; contact in a part of it included.

    Parameters
    ----------
    law
        LINEAR, HERTZ or HUNT_CROSSLEY of the layout.
    k, exponent
        Stiffness [N/m^n] and exponent n (read for HUNT_CROSSLEY).
    damping
        c [N s/m] of the linear law, a [s/m] of Hunt and Crossley.
    d0, d1
        Depth [m] at the start and at the end of the step; negative: a gap.
    h
        Step [s].

    Returns
    -------
    elastic
        Discrete gradient of the energy [N]; ``elastic (d1 - d0)`` is its change.
    force
        With damping [N], not below zero; ``(force - elastic) (d1 - d0) >= 0`` is dissipated.
    slope
        Derivative of the force by ``d1`` [N/m], not below zero.
    """
    if law == LINEAR:
        return _mean_linear(k, damping, d0, d1, h)
    elastic, slope = _mean_power(k, _exponent(law, exponent), d0, d1)
    if law == HERTZ:
        return elastic, elastic, slope
    factor = 1.0 + damping * (d1 - d0) / h
    if factor <= 0.0:
        return elastic, 0.0, 0.0
    return elastic, elastic * factor, slope * factor + elastic * damping / h


@kernel(internal=True)
def _loss_balance(D: float, e: float) -> float:
    """``( D (1+e) - ln[(1+D)/(1-e D)] ) / D^2``: positive below the root, negative above it."""
    if D > 0.1:
        return (D * (1.0 + e) - math.log1p(D) + math.log1p(-e * D)) / (D * D)
    total, power, sign, restitution = 0.0, 1.0, 1.0, e * e
    for j in range(2, 19):
        total += power * (sign - restitution) / j
        power *= D
        sign = -sign
        restitution *= e
    return total


@kernel
def hunt_crossley_damping(restitution: float, approach: float) -> float:
    """Damping a [s/m] of ``k d^n (1 + a d')`` that returns a restitution e at a speed of approach v_i.

    Root of ``ln[(1+D)/(1-e D)] = D (1+e)`` with ``D = a v_i``, which holds for all k, n and masses.

    Parameters
    ----------
    restitution
        e; below 1e-6 it is taken as 1e-6, for 0 would need infinite damping. 1 or more: no damping.
    approach
        Speed of first touch [m/s]; zero or less: no damping.
    """
    if restitution >= 1.0 or approach <= 0.0:
        return 0.0
    e = max(restitution, SMALLEST_RESTITUTION)
    low, high = 0.0, 1.0 / e
    for _ in range(200):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        if e * middle < 1.0 and _loss_balance(middle, e) > 0.0:
            low = middle
        else:
            high = middle
    return low / approach
