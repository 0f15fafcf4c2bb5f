"""The retardation kernel of radiated waves from the damping of a hydrodynamic database, and its added mass at infinity.

    K(t) = (2 / pi) int_0^inf B(omega) cos(omega t) domega
    A(omega) = A_inf - (1 / omega) int_0^inf K(t) sin(omega t) dt

Sources: Cummins, The impulse response function and ship motions, Schiffstechnik 9 (1962); Ogilvie, Recent progress
toward the understanding and prediction of ship motions, 5th Symposium on Naval Hydrodynamics (1964); *Integrated
simulation ... ships and offshore structures* (2018), section 2.9. Integrals of a piecewise linear function times a
cosine: Filon, Proc. R. Soc. Edinburgh 49 (1930).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "RetardationKernel",
    "channel_scales",
    "check_infinite_added_mass",
    "consistent_added_mass",
    "infinite_added_mass",
    "memory_length",
    "ogilvie_deviation",
    "retardation_kernel",
]

SERIES = 80
"""Terms of the integral over the tail."""

TAIL_LEVEL = 0.01
"""Of the largest damping of a coordinate; a tail that begins higher always gets its power from the data."""

TAIL_SCATTER = 0.1
"""Of the logarithm of the damping about a power law, below which a lower tail gets its power from the data as well."""

TAIL_POWERS = (2.0, 7.0)
"""Range of the powers of 1/omega; radiation damping of a hemisphere ends as the seventh."""

SMALL_TAIL_POWER = 4.0
"""Of tails that begin so low that noise would choose their power: they matter little."""

TAIL_FROM = 0.75
"""Of the highest frequency; from here on the data choose the power."""

TIMES_AT_ONCE = 1000
"""Rows of the matrices over times and frequencies that are held at once."""

TOLERABLE = 0.45
"""Of the added mass: nobody can ask for more to be tolerated in its limit."""

TRUSTED = 0.7
"""Of the highest frequency; added mass above it is not used for the limit at infinity."""


@dataclass(frozen=True, eq=False)
class RetardationKernel:
    """K(t) of damping that is piecewise linear in the frequency, with a power law above the highest one.

    Attributes
    ----------
    omega
        [rad/s], shape (nw + 1,), beginning with zero.
    damping
        Symmetric, shape (nw + 1, n, n), zero at zero frequency.
    tail
        Damping from which the tail begins, shape (n, n).
    powers
        p_i, shape (n,): above the highest frequency W the damping is tail_ij (W / omega)^((p_i + p_j) / 2), which
        stays positive semidefinite when it begins so.
    """

    omega: NDArray[np.float64]
    damping: NDArray[np.float64]
    tail: NDArray[np.float64]
    powers: NDArray[np.float64]

    def __call__(self, times: ArrayLike) -> NDArray[np.float64]:
        """K(t) at times [s] of shape (m,), exact integrals, shape (m, n, n)."""
        t = np.abs(np.asarray(times, dtype=np.float64))
        n = self.damping.shape[1]
        W = self.omega[-1]
        middle = 0.5 * (self.omega[1:] + self.omega[:-1])
        half = 0.5 * np.diff(self.omega)
        steps = np.diff(self.damping, axis=0).reshape(len(half), n * n)
        K = np.outer(W * np.sinc(W * t / np.pi), self.damping[-1].ravel())
        # by parts: [B sin(w t) / t] and the differences of cosines, written so that nothing cancels at small times
        for first in range(0, len(t), TIMES_AT_ONCE):
            part = slice(first, first + TIMES_AT_ONCE)
            shape = np.sinc(np.outer(t[part], middle / np.pi)) * np.sinc(np.outer(t[part], half / np.pi))
            K[part] -= (shape * middle) @ steps
        power = 0.5 * (self.powers[:, None] + self.powers[None, :])
        for p in np.unique(power[self.tail != 0.0]):
            begin = np.where(power == p, self.tail, 0.0)
            K += np.outer(W * exponential_integral(float(p), W * t).real, begin.ravel())
        return (2.0 / np.pi) * K.reshape(len(t), n, n)

    def damping_at(self, omega: ArrayLike) -> NDArray[np.float64]:
        """B at frequencies [rad/s] of shape (m,), interpolated and continued as in the kernel, shape (m, n, n)."""
        w = np.asarray(omega, dtype=np.float64)
        n = self.damping.shape[1]
        power = 0.5 * (self.powers[:, None] + self.powers[None, :])
        W = self.omega[-1]
        out = np.empty((len(w), n, n))
        for i in range(n):
            for j in range(n):
                out[:, i, j] = np.interp(w, self.omega, self.damping[:, i, j])
        above = w > W
        out[above] = self.tail * (W / w[above])[:, None, None] ** power
        return out


def retardation_kernel(omega: ArrayLike, damping: ArrayLike, *, source: str = "") -> RetardationKernel:
    """Kernel of tabulated radiation damping.

    Parameters
    ----------
    omega
        [rad/s], shape (nw,), increasing, positive (a leading zero is allowed); at least three.
    damping
        Shape (nw, n, n); the symmetric part is used.
    source
        Named in errors.

    Raises
    ------
    InputError
        If shapes do not fit, a value is not finite, or frequencies do not increase.
    """
    w, B = _checked(omega, damping, "damping", source)
    if w[0] > 0.0:
        w = np.concatenate([[0.0], w])
        B = np.concatenate([np.zeros((1, *B.shape[1:])), B])
    else:
        B = B.copy()
        B[0] = 0.0  # a body far below every wave length makes none
    tail, powers = _fitted_tail(w, B)
    return RetardationKernel(w, B, tail, powers)


def _checked(
    omega: ArrayLike, values: ArrayLike, key: str, source: str
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies and the symmetric parts of matrices over them."""
    w = np.asarray(omega, dtype=np.float64)
    X = np.asarray(values, dtype=np.float64)
    if w.ndim != 1 or len(w) < 3:
        raise InputError(
            f"shape {w.shape}", source=source, key="omega", expected="at least three frequencies, shape (nw,)"
        )
    if X.ndim != 3 or X.shape[0] != len(w) or X.shape[1] != X.shape[2]:
        raise InputError(f"shape {X.shape}", source=source, key=key, expected=f"({len(w)}, n, n)")
    if not (np.isfinite(w).all() and np.isfinite(X).all()):
        raise InputError(
            "a value is not finite", source=source, key=f"omega, {key}", expected="finite numbers"
        )
    if w[0] < 0.0 or not (np.diff(w) > 0.0).all():
        raise InputError(
            f"{w[0]:g} to {w[-1]:g} rad/s", source=source, key="omega", expected="positive, increasing"
        )
    return w, 0.5 * (X + X.transpose(0, 2, 1))


def _fitted_tail(
    omega: NDArray[np.float64], damping: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where the tails of the damping begin, and their powers."""
    diagonal = np.einsum("kii->ki", damping)
    last = diagonal[-1]
    highest = np.abs(diagonal).max(axis=0)
    powers = np.full(len(last), SMALL_TAIL_POWER)
    near = omega >= TAIL_FROM * omega[-1]
    near[-3:] = True
    for i in np.flatnonzero(last > 0.0):
        used = near & (diagonal[:, i] > 0.0)
        if used.sum() < 3:
            continue
        x, y = np.log(omega[used]), np.log(diagonal[used, i])
        slope, offset = np.polyfit(x, y, 1)
        scatter = np.sqrt(np.mean((y - slope * x - offset) ** 2))
        if last[i] > TAIL_LEVEL * highest[i] or scatter < TAIL_SCATTER:
            powers[i] = np.clip(np.round(-slope), *TAIL_POWERS)
    begin = np.where(np.outer(last > 0.0, last > 0.0), damping[-1], 0.0)
    return begin, powers


def exponential_integral(power: float, x: NDArray[np.float64]) -> NDArray[np.complex128]:
    """E_p(-i x) = int_1^inf s^-p exp(i x s) ds for whole and half powers p > 1 and real x >= 0.

    Notes
    -----
    Recursion in p from E_1 or E_1/2 for small arguments, the continued fraction for large ones (Abramowitz and
    Stegun, *Handbook of Mathematical Functions*, 5.1.14 and 5.1.22; the fraction holds for any p).
    """
    from scipy.special import erfc, exp1

    out = np.empty(len(x), dtype=np.complex128)
    small, large = (x > 0.0) & (x < 12.0), x >= 12.0
    out[x == 0.0] = 1.0 / (power - 1.0)
    z = -1j * x[small]
    p = power - np.floor(power)
    p, value = (1.0, exp1(z)) if p == 0.0 else (0.5, np.sqrt(np.pi / z) * erfc(np.sqrt(z)))
    while p < power - 0.25:
        value = (np.exp(-z) - z * value) / p
        p += 1.0
    out[small] = value
    z = -1j * x[large]
    fraction = np.zeros(len(z), dtype=np.complex128)
    for k in range(60, 0, -1):
        fraction = k * (power + k - 1.0) / (z + power + 2.0 * k - fraction)
    out[large] = np.exp(-z) / (z + power - fraction)
    return out


def channel_scales(samples: ArrayLike, least: ArrayLike | None = None) -> NDArray[np.float64]:
    """Square roots of the largest |K_ii|, shape (n,): K_ij / (s_i s_j) has no unit.

    Parameters
    ----------
    samples
        Kernels over time, shape (m, n, n).
    least
        Square roots of kernels so small that nothing feels them, shape (n,); smaller ones do not count.
    """
    K = np.asarray(samples, dtype=np.float64)
    own = np.sqrt(np.abs(np.einsum("kii->ki", K)).max(axis=0))
    return own if least is None else np.maximum(own, np.asarray(least, dtype=np.float64))


def memory_length(
    kernel: RetardationKernel,
    *,
    tolerance: float = 0.01,
    longest: float = 60.0,
    step: float = 0.05,
    least: ArrayLike | None = None,
) -> float:
    """Time after which no entry of K exceeds a fraction of s_i s_j of `channel_scales`, at most the longest [s]."""
    times = np.arange(0.0, longest + 0.5 * step, step)
    K = kernel(times)
    s = channel_scales(K, least)
    unit = np.outer(s, s)
    relative = (np.abs(K) / np.where(unit > 0.0, unit, np.inf)).max(axis=(1, 2))
    above = np.flatnonzero(relative > tolerance)
    return float(times[min(above[-1] + 1, len(times) - 1)]) if len(above) else step


def infinite_added_mass(
    omega: ArrayLike, added_mass: ArrayLike, damping: ArrayLike, *, source: str = ""
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Added mass at infinite frequency from that at finite ones and the damping (Ogilvie's relation).

    Parameters
    ----------
    omega
        [rad/s], shape (nw,).
    added_mass, damping
        Shape (nw, n, n).
    source
        Named in errors.

    Returns
    -------
    value
        Median over the frequencies up to 0.7 of the highest, shape (n, n): single irregular ones do not count.
    spread
        Median deviation of the estimates from it, shape (n, n).

    Raises
    ------
    InputError
        As `retardation_kernel`.

    Notes
    -----
    With the kernel inserted, A_inf = A(w) + (2 / pi) P int_0^inf B(x) / (w^2 - x^2) dx, a principal value that is
    a sum of logarithms for piecewise linear B; those of a tabulated frequency with itself cancel.
    """
    w, A = _checked(omega, added_mass, "added_mass", source)
    kernel = retardation_kernel(omega, damping, source=source)
    x, B = kernel.omega, kernel.damping
    n = A.shape[1]
    slopes = np.diff(B, axis=0) / np.diff(x)[:, None, None]
    offsets = B[:-1] - slopes * x[:-1, None, None]
    power = 0.5 * (kernel.powers[:, None] + kernel.powers[None, :])
    divisors = power + 1.0 + 2.0 * np.arange(SERIES)[:, None, None]
    used = np.flatnonzero((w > 0.0) & (w <= TRUSTED * w[-1]))
    estimates = np.empty((len(used), n, n))
    for row, k in enumerate(used):
        apart = np.abs(w[k] - x)
        near = np.log(np.where(apart > 0.0, apart, 1.0))
        far = np.log(w[k] + x)
        odd, even = np.diff(far - near), np.diff(far + near)
        integral = np.tensordot(odd, offsets, 1) / (2.0 * w[k]) - 0.5 * np.tensordot(even, slopes, 1)
        ratio = (w[k] / x[-1]) ** 2
        powers = np.array([ratio**m for m in range(SERIES)])  # w < 0.7 W: below 1e-20
        series = (powers[:, None, None] / divisors).sum(axis=0)
        integral -= kernel.tail / x[-1] * series
        estimates[row] = A[k] + (2.0 / np.pi) * integral
    value = np.median(estimates, axis=0)
    return value, np.median(np.abs(estimates - value), axis=0)


def consistent_added_mass(
    omega: NDArray[np.float64],
    added_mass: NDArray[np.float64],
    damping: NDArray[np.float64],
    added_mass_infinite: NDArray[np.float64],
    *,
    least: ArrayLike = 0.0,
    source: str = "",
) -> NDArray[np.float64]:
    """Added mass at infinite frequency by Ogilvie's relation, symmetric, shape (n, n), if that given is near to it.

    Parameters
    ----------
    omega, added_mass, damping, added_mass_infinite, least, source
        As of `check_infinite_added_mass`.

    Raises
    ------
    InputError
        As `check_infinite_added_mass`.
    """
    found = infinite_added_mass(omega, added_mass, damping, source=source)[0]
    check_infinite_added_mass(
        omega, added_mass, damping, added_mass_infinite, least=least, source=source, value=found
    )
    return np.asarray(0.5 * (found + found.T))


def ogilvie_deviation(
    omega: ArrayLike,
    added_mass: ArrayLike,
    damping: ArrayLike,
    added_mass_infinite: ArrayLike,
    least: ArrayLike = 0.0,
    value: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """How far a given A_inf is from that of Ogilvie's relation, |difference_ij| / sqrt(A_ii A_jj), shape (n, n).

    A_ii is the largest added mass at any frequency: that of a slender hull ahead is far smaller at the infinite one.
    It is not below `least`, shape (n,): that of a body of revolution in yaw is round-off. `value` is that of the
    relation, if it is known.
    """
    if value is None:
        value, _ = infinite_added_mass(omega, added_mass, damping)
    given = np.asarray(added_mass_infinite, dtype=np.float64)
    largest = np.abs(np.diagonal(np.asarray(added_mass, dtype=np.float64), axis1=1, axis2=2)).max(axis=0)
    scale = np.sqrt(
        np.maximum.reduce([largest, np.abs(np.diag(value)), np.abs(np.diag(given)), largest * 0.0 + least])
    )
    unit = np.outer(scale, scale)
    return np.abs(0.5 * (given + given.T) - value) / np.where(unit > 0.0, unit, 1.0)


def check_infinite_added_mass(
    omega: ArrayLike,
    added_mass: ArrayLike,
    damping: ArrayLike,
    added_mass_infinite: ArrayLike,
    *,
    limit: float = 0.1,
    least: ArrayLike = 0.0,
    source: str = "",
    value: NDArray[np.float64] | None = None,
) -> float:
    """Refuse an added mass at infinite frequency that does not belong to the rest of a database.

    Parameters
    ----------
    omega, added_mass, damping
        As for `infinite_added_mass`.
    added_mass_infinite
        Shape (n, n).
    limit
        Largest accepted deviation, as of `ogilvie_deviation`.
    least, value
        As of `ogilvie_deviation`.
    source
        Named in errors.

    Returns
    -------
    float
        Largest deviation.

    Raises
    ------
    InputError
        If A_inf is missing (not finite, or nothing but zeros) or inconsistent.
    """
    given = np.asarray(added_mass_infinite, dtype=np.float64)
    A = np.asarray(added_mass, dtype=np.float64)
    expected = "the limit of the added mass that belongs to the damping"
    if given.shape != A.shape[1:] or not np.isfinite(given).all() or (A.any() and not given.any()):
        raise InputError("missing", source=source, key="A_inf", expected=expected)
    deviation = ogilvie_deviation(omega, A, damping, given, least, value)
    i, j = np.unravel_index(np.argmax(deviation), deviation.shape)
    worst = float(deviation[i, j])
    if worst > limit:
        raise InputError(
            f"entry ({i + 1}, {j + 1}) = {given[i, j]:.4g} is off by {worst:.1%} of what added mass and damping "
            "imply",
            source=source,
            key="A_inf",
            expected=f"{expected}; or 'tolerance' above {worst:.2f} for this database: it is found from the damping"
            if worst < TOLERABLE
            else f"{expected} (periods taken for frequencies, or a length scale?)",
        )
    return worst
