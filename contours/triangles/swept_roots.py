"""Roots of a cubic in [0, 1] that are certified against rounding, one after another from the left.

The cubic is held by its Bernstein coefficients: if all have one sign there is no root, if their signs change
once there is exactly one (Descartes' rule in the Bernstein basis). Each coefficient carries a bound of its
rounding error; a sign counts only beyond the bound, and where signs stay unknown the caller is told so.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel

__all__ = ["NO_ROOT", "ONE_ROOT", "ROUNDING", "UNCERTAIN", "next_root"]

NO_ROOT = 0
"""The cubic has no root from the start to 1."""

ONE_ROOT = 1
"""There is exactly one root in the interval, and none from the start to the interval."""

UNCERTAIN = 2
"""There is no root from the start to the beginning of the interval; nothing is known of what follows."""

ROUNDING = 4e-15
"""Bound of the error of a determinant of coordinate differences, and of a convex combination of such, over the sum
of the magnitudes of its terms: 12 roundings of 2^-53 at most in a determinant, 24 in a combination."""

NARROWEST = 2.0**-24
"""Intervals are not halved below this: what stays unknown there is a double root within rounding."""

NEWTON_STEPS = 40
"""Bound of the safeguarded Newton steps, each of which at least halves the interval every second time."""


@kernel(inline=True, internal=True)
def blossom(b0: float, b1: float, b2: float, b3: float, r: float, s: float, t: float) -> float:
    """Polar form of a cubic; with three equal arguments its value, by convex combinations in [0, 1]."""
    p0 = b0 + r * (b1 - b0)
    p1 = b1 + r * (b2 - b1)
    p2 = b2 + r * (b3 - b2)
    p0 += s * (p1 - p0)
    p1 += s * (p2 - p1)
    return p0 + t * (p1 - p0)


@kernel(internal=True)
def narrow_root(
    b0: float, b1: float, b2: float, b3: float, error: float, low: float, high: float, sign: float
) -> tuple[float, float]:
    """Shrink an interval around its only root as far as signs can be certified.

    Parameters
    ----------
    b0, b1, b2, b3
        Bernstein coefficients on [0, 1].
    error
        Bound of the rounding error of a coefficient and of a value.
    low, high
        Interval; the values at its ends are certified to have different signs.
    sign
        Of the value at ``low``.

    Returns
    -------
    low, high
        Interval around the root with the same property; the given one if it cannot be made small.
    """
    left = low
    right = high
    t = 0.5 * (left + right)
    slope = 0.0
    for _ in range(NEWTON_STEPS):
        p0 = b0 + t * (b1 - b0)
        p1 = b1 + t * (b2 - b1)
        p2 = b2 + t * (b3 - b2)
        p0 += t * (p1 - p0)
        p1 += t * (p2 - p1)
        slope = 3.0 * (p1 - p0)
        value = sign * (p0 + t * (p1 - p0))
        if value > 0.0:
            left = t
        else:
            right = t
        if abs(value) <= error:
            break
        new = t - sign * value / slope
        if not left < new < right:
            new = 0.5 * (left + right)
        done = abs(new - t) <= 1e-15
        t = new
        if done:
            break
    reach = 1e-14 + 3.0 * error / (abs(slope) + 1e-300)
    for _ in range(3):
        left = max(low, t - reach)
        right = min(high, t + reach)
        before = left <= low or sign * blossom(b0, b1, b2, b3, left, left, left) > error
        after = right >= high or sign * blossom(b0, b1, b2, b3, right, right, right) < -error
        if before and after:
            return left, right
        reach *= 8.0
    return low, high


@kernel(internal=True)
def next_root(
    b0: float, b1: float, b2: float, b3: float, error: float, start: float
) -> tuple[int, float, float]:
    """Find the first root of a cubic from a start in [0, 1].

    Parameters
    ----------
    b0, b1, b2, b3
        Bernstein coefficients on [0, 1].
    error
        Bound of the rounding error of a coefficient and of a value, zero or more.
    start
        Where to begin, in [0, 1].

    Returns
    -------
    outcome
        `NO_ROOT`, `ONE_ROOT` or `UNCERTAIN`.
    low, high
        The interval of the outcome.
    """
    low = start
    width = 1.0 - start
    c0 = b0
    c1 = b1
    c2 = b2
    c3 = b3
    whole = start == 0.0
    while True:
        high = min(1.0, low + width)
        if not whole:
            c0 = blossom(b0, b1, b2, b3, low, low, low)
            c1 = blossom(b0, b1, b2, b3, low, low, high)
            c2 = blossom(b0, b1, b2, b3, low, high, high)
            c3 = blossom(b0, b1, b2, b3, high, high, high)
        whole = False
        if not abs(c0) > error:
            return UNCERTAIN, low, 1.0
        sign = 1.0 if c0 > 0.0 else -1.0
        if sign * c1 > error and sign * c2 > error and sign * c3 > error:
            if high >= 1.0:
                return NO_ROOT, 1.0, 1.0
            low = high
            width = min(2.0 * width, 1.0 - low)
            continue
        if sign * c3 < -error and (sign * c1 > error or sign * c2 < -error):
            low, high = narrow_root(b0, b1, b2, b3, error, low, high, sign)
            return ONE_ROOT, low, high
        width *= 0.5
        if width < NARROWEST:
            return UNCERTAIN, low, 1.0
