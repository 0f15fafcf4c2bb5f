"""A retardation kernel as a sum of exponentials with common poles: K(t) = Re sum_p R_p exp(s_p t).

Poles from the singular vectors of a Hankel matrix of all channels (Kung's method; Hua and Sarkar, Matrix pencil
method for estimating parameters of exponentially damped/undamped sinusoids, IEEE Trans. ASSP 38 (1990)), residues by
least squares with two properties that radiation has: no damping at zero frequency, and nowhere negative damping.
Ships' memory by state-space models: Kristiansen, Hjulstad and Egeland, Ocean Engineering 32 (2005).

Residues are changed as little as makes the damping positive semidefinite everywhere. With given poles the damping
B(omega) = Re K(i omega) is linear in the residues, and those with v' B(omega) v >= 0 for
all omega and v are a convex set. It is approached by cutting planes: the nearest residues in the sense of least
squares of the kernel that satisfy the conditions found so far, then the frequencies and vectors where damping is
still negative become conditions themselves. Each problem is one of least distance (Lawson and Hanson, *Solving Least
Squares Problems* (1974), chapter 23).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.retardation import channel_scales

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "ExponentialKernel",
    "PassiveFit",
    "common_poles",
    "damping_functions",
    "fit_exponentials",
    "lowest_damping",
    "make_passive",
]


# ---- passive residues ----


MARGIN = 1e-4
"""Damping that a violated place gets, relative to the largest, times `_shape`."""

ENOUGH = 0.1
"""Of the margin: with this much everywhere the search for violations ends."""

ROUNDS = 60
"""Of cutting planes at most."""

CUTS = 200
"""Conditions added in a round at most, the worst first."""

ZOOMS = 6
"""Each searches a minimum on a quarter of the interval."""

DECADES = 4
"""Below and above the frequencies of the poles that are searched."""

PER_DECADE = 120
"""Frequencies searched in each decade."""

PER_DECAY = 5
"""Frequencies searched besides, in each interval as wide as the decay of a pole and near it."""

FINER = 4
"""Density of the grid on which the outcome is confirmed."""


class PassiveFit(NamedTuple):
    """Outcome of `make_passive`.

    Attributes
    ----------
    coefficients
        Re R and Im R, shape (2 P, channels).
    lowest
        Smallest eigenvalue of the damping relative to the largest, before.
    extra
        Constant damping of every coordinate that is needed on top (scaled); zero unless the search did not end.
    rounds
        Cutting plane problems solved.
    """

    coefficients: NDArray[np.float64]
    lowest: float
    extra: float
    rounds: int


def damping_functions(poles: NDArray[np.complex128], omega: NDArray[np.float64]) -> NDArray[np.float64]:
    """Factors of Re R and Im R in Re K(i omega), shape (m, 2 P).

    K(i omega) = 1/2 sum_p [R_p / (i omega - s_p) + conj(R_p) / (i omega - conj(s_p))] for one pole of each pair; a real
    pole with a real residue has the same form.
    """
    a, b = -poles.real, poles.imag
    below, above = omega[:, None] - b, omega[:, None] + b
    near, far = 1.0 / (a * a + below * below), 1.0 / (a * a + above * above)
    return np.hstack([0.5 * a * (near + far), 0.5 * (below * near - above * far)])


def make_passive(
    poles: NDArray[np.complex128],
    coefficients: NDArray[np.float64],
    pairs: NDArray[np.int64],
    size: int,
    basis: NDArray[np.float64],
    functions: NDArray[np.float64],
) -> PassiveFit:
    """Change the residues so that the damping is nowhere negative.

    Parameters
    ----------
    poles
        One of each conjugate pair, shape (P,).
    coefficients
        Re R and Im R of the channels, shape (2 P, channels), without damping at zero frequency.
    pairs
        Coordinates i <= j of the channels, shape (channels, 2).
    size
        Number of coordinates, which are scaled to a comparable size.
    basis
        Of the coefficients without damping at zero frequency, shape (2 P, free).
    functions
        What a change along each of its columns adds to a kernel at the times where the change is measured, shape
        (m, free).
    """
    from scipy.linalg import solve_triangular

    grid, finer = _frequencies(poles, 1), _frequencies(poles, FINER)
    values = _eigenvalues(poles, coefficients, pairs, size, grid)
    largest, peak = float(values.max()), float(grid[np.argmax(values.max(axis=1))])
    lowest = float(values.min()) / largest
    R = np.asarray(np.linalg.qr(functions, mode="r"))
    diagonal = np.abs(np.diag(R))
    least = 1e-10 * diagonal.max()  # equal poles must not divide by zero
    R[np.diag_indices_from(R)] = np.where(diagonal < least, least, np.diag(R))
    twice = _twice(pairs)
    weights = np.sqrt(twice)  # of a channel that stands for two entries
    # a condition is the product of a vector over the coefficients, one over the channels, and a number
    cuts = (np.zeros((0, R.shape[0])), np.zeros((0, len(pairs))), np.zeros(0))
    current = coefficients
    for done in range(ROUNDS + 1):
        for searched in (grid, finer):
            places, vectors = _violations(
                poles, current, pairs, size, searched, peak, ENOUGH * MARGIN * largest
            )
            if len(places):
                break
        if len(places) == 0:
            return PassiveFit(current, lowest, 0.0, done)
        if done == ROUNDS:
            break
        dampings = damping_functions(poles, places)
        reduced = solve_triangular(R, (dampings @ basis).T, trans="T", lower=False).T
        factors = twice * vectors[:, pairs[:, 0]] * vectors[:, pairs[:, 1]]
        now = np.einsum("kc,kp,pc->k", factors, dampings, coefficients)
        sizes = np.linalg.norm(reduced, axis=1), np.linalg.norm(factors / weights, axis=1)
        needs = (MARGIN * largest * _shape(places, peak) - now) / (sizes[0] * sizes[1])
        new = (reduced / sizes[0][:, None], factors / weights / sizes[1][:, None], needs)
        over, across, needed = (np.concatenate(parts) for parts in zip(cuts, new, strict=True))
        held = _least_distance((over @ over.T) * (across @ across.T), needed)
        if held is None:
            break
        kept = held > 0.0
        move = (over[kept] * held[kept, None]).T @ across[kept]
        cuts = (over[kept], across[kept], needed[kept])
        change = solve_triangular(R, move, lower=False) / weights
        current = coefficients + basis @ change
    deficit = lowest_damping(poles, current, pairs, size)
    return PassiveFit(current, lowest, max(0.0, -deficit) * (1.0 + 1e-6) + 1e-12 * largest, ROUNDS)


def lowest_damping(
    poles: NDArray[np.complex128], coefficients: NDArray[np.float64], pairs: NDArray[np.int64], size: int
) -> float:
    """Smallest eigenvalue of the damping over all frequencies."""
    grid = np.concatenate([[0.0], _frequencies(poles, FINER)])
    places, values = _low_places(poles, coefficients, pairs, size, grid, np.ones_like)
    lowest = _eigenvalues(poles, coefficients, pairs, size, places).min(initial=0.0)
    return float(
        min(lowest, values.min(initial=0.0), _eigenvalues(poles, coefficients, pairs, size, grid).min())
    )


def _frequencies(poles: NDArray[np.complex128], density: int) -> NDArray[np.float64]:
    """Where the damping is searched for negative values: decades, and closely around each pole."""
    moduli = np.abs(poles)
    low, high = np.log10(moduli.min()) - DECADES, np.log10(moduli.max()) + DECADES
    grid = [np.logspace(low, high, int((high - low) * PER_DECADE * density))]
    around = np.linspace(-4.0, 4.0, 8 * PER_DECAY * density + 1)
    grid += [pole.imag - pole.real * around for pole in poles]
    whole = np.concatenate(grid)
    return np.unique(whole[whole >= 10.0**low])


def _shape(omega: NDArray[np.float64] | float, peak: float) -> NDArray[np.float64]:
    """One at the peak, with the powers at zero and infinity that radiation damping has in a sum of exponentials."""
    ratio = (np.asarray(omega) / peak) ** 2
    return 4.0 * ratio / (1.0 + ratio) ** 2


def _matrices(
    poles: NDArray[np.complex128],
    coefficients: NDArray[np.float64],
    pairs: NDArray[np.int64],
    size: int,
    omega: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Damping at some frequencies, shape (m, size, size)."""
    values = damping_functions(poles, omega) @ coefficients
    B = np.zeros((len(omega), size, size))
    B[:, pairs[:, 0], pairs[:, 1]] = values
    B[:, pairs[:, 1], pairs[:, 0]] = values
    return B


def _eigenvalues(
    poles: NDArray[np.complex128],
    coefficients: NDArray[np.float64],
    pairs: NDArray[np.int64],
    size: int,
    omega: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Eigenvalues of the damping, shape (m, size), increasing."""
    return np.asarray(
        np.linalg.eigvalsh(_matrices(poles, coefficients, pairs, size, omega)), dtype=np.float64
    )


def _low_places(
    poles: NDArray[np.complex128],
    coefficients: NDArray[np.float64],
    pairs: NDArray[np.int64],
    size: int,
    grid: NDArray[np.float64],
    shape: Callable[[NDArray[np.float64]], NDArray[np.float64]],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Local minima of the damping over a shape, and their values.

    Where eigenvalues cross, the smallest one has kinks that a grid misses. So each sorted eigenvalue is followed from
    its minima on the grid by the damping of its eigenvector there, which is smooth.
    """
    ratio = _eigenvalues(poles, coefficients, pairs, size, grid) / shape(grid)[:, None]
    padded = np.pad(ratio, ((1, 1), (0, 0)), constant_values=np.inf)
    at, which = np.nonzero((ratio <= padded[:-2]) & (ratio <= padded[2:]))
    low, high = grid[np.maximum(at - 1, 0)], grid[np.minimum(at + 1, len(grid) - 1)]
    vectors = np.linalg.eigh(_matrices(poles, coefficients, pairs, size, grid[at]))[1][
        np.arange(len(at)), :, which
    ]
    factors = _twice(pairs) * vectors[:, pairs[:, 0]] * vectors[:, pairs[:, 1]] @ coefficients.T
    row = np.arange(len(at))
    place, value = grid[at], ratio[at, which]
    for _ in range(ZOOMS):
        inside = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, 9)
        flat = inside.ravel()
        functions = damping_functions(poles, flat).reshape(len(at), 9, -1)
        values = np.einsum("kqp,kp->kq", functions, factors) / shape(flat).reshape(len(at), 9)
        best = np.argmin(values, axis=1)
        better = values[row, best] < value
        place = np.where(better, inside[row, best], place)
        value = np.minimum(value, values[row, best])
        low, high = inside[row, np.maximum(best - 1, 0)], inside[row, np.minimum(best + 1, 8)]
    return place, value


def _violations(
    poles: NDArray[np.complex128],
    coefficients: NDArray[np.float64],
    pairs: NDArray[np.int64],
    size: int,
    grid: NDArray[np.float64],
    peak: float,
    least: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies and vectors for which the damping over its shape is below the least."""

    def shape(omega: NDArray[np.float64]) -> NDArray[np.float64]:
        return _shape(omega, peak)

    places, ratio = _low_places(poles, coefficients, pairs, size, grid, shape)
    places = np.unique(places[ratio < least])
    eigenvalues, vectors = np.linalg.eigh(_matrices(poles, coefficients, pairs, size, places))
    relative = eigenvalues / shape(places)[:, None]
    at, which = np.nonzero(relative < least)
    worst = np.argsort(relative[at, which])[:CUTS]
    at, which = at[worst], which[worst]
    return places[at], vectors[at, :, which]


def _twice(pairs: NDArray[np.int64]) -> NDArray[np.float64]:
    """How many entries of a matrix each channel stands for."""
    return np.where(pairs[:, 0] == pairs[:, 1], 1.0, 2.0)


def _least_distance(gram: NDArray[np.float64], h: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Factors u >= 0 of the rows g_k in the shortest x = sum u_k g_k with g_k . x >= h_k, or None if there is none.

    Lawson and Hanson, 23.4: with E = [G^T; h^T], x follows from the residual of E u = (0, .., 0, 1), u >= 0. Of the
    rows only their products ``gram`` are needed: R'R = E'E takes the place of E, which is far longer than wide.
    """
    from scipy.linalg import solve_triangular
    from scipy.linalg.lapack import dpstrf
    from scipy.optimize import nnls

    size = float(np.abs(h).max())
    needed = h / size
    factor, pivots, rank, _ = dpstrf(gram + np.outer(needed, needed), lower=0)
    order = pivots - 1
    R = np.zeros((rank, len(h)))
    R[:, order] = np.triu(factor)[:rank]
    right = solve_triangular(R[:, order[:rank]], needed[order[:rank]], trans="T")
    try:
        u, _ = nnls(R, right, maxiter=10 * len(h) + 100)
    except RuntimeError:
        return None
    last = float(needed @ u) - 1.0
    if float(u @ gram @ u) + last * last < 1e-20 or last == 0.0:
        return None
    return np.asarray(-u / last * size)


# ---- the fit ----


SLOWEST = 0.5
"""Slowest decay of a pole, in parts of the length of the samples: nothing outlives them undamped."""

SAFETY = 0.9
"""Of the tolerance that a fit has to reach before it is made passive."""

NEGLIGIBLE = 1e-3
"""Of the tolerance: parts of the series below it choose no poles."""

MOST_SAMPLES, MOST_COLUMNS = 1200, 400
"""From which poles are found, and columns of the Hankel matrices: longer memories take no longer."""

HANKEL_NUMBERS = 4_000_000
"""Of the Hankel matrices that are held at once."""

EXTRA_POLES = 6
"""Added at most, after the unconstrained fit is good enough, when the passive one is not."""


@dataclass(frozen=True, eq=False)
class ExponentialKernel:
    """K(t) = Re sum_p R_p exp(s_p t), one pole of each conjugate pair, and damping of the present velocity.

    Attributes
    ----------
    poles
        s_p [1/s], shape (P,), imaginary parts >= 0, real parts negative.
    residues
        Symmetric complex matrices, shape (P, n, n); real for real poles.
    damping
        Constant damping that was added where residues alone could not be made passive, shape (n, n); usually zero.
    error
        Largest |difference_ij| to the samples, relative to s_i s_j of `channel_scales`.
    lowest
        Smallest eigenvalue of Re K(i omega), relative to the largest, before the fit was made passive.
    change
        Largest change of the kernel by which it was made passive, relative as `error`.
    length
        How far the samples reach [s].
    warning
        A sentence if the error is larger than was asked for or damping was added; else empty.
    """

    poles: NDArray[np.complex128]
    residues: NDArray[np.complex128]
    damping: NDArray[np.float64]
    error: float
    lowest: float
    change: float
    length: float = 0.0
    warning: str = ""

    @property
    def pole_count(self) -> int:
        """Number of poles, both of each conjugate pair."""
        return int(len(self.poles) + np.count_nonzero(self.poles.imag))

    def __call__(self, times: ArrayLike) -> NDArray[np.float64]:
        """K(t) at times [s] of shape (m,), without the constant damping, shape (m, n, n)."""
        t = np.asarray(times, dtype=np.float64)
        return np.tensordot(np.exp(np.outer(t, self.poles)), self.residues, 1).real

    def damping_at(self, omega: ArrayLike) -> NDArray[np.float64]:
        """Re K(i omega), the constant damping included, at frequencies [rad/s] of shape (m,), shape (m, n, n)."""
        functions = damping_functions(self.poles, np.asarray(omega, dtype=np.float64))
        parts = np.concatenate([self.residues.real, self.residues.imag])
        return np.tensordot(functions, parts, 1) + self.damping


def fit_exponentials(
    samples: ArrayLike,
    step: float = 0.1,
    *,
    tolerance: float = 0.005,
    most_poles: int = 30,
    floor: float = 1e-3,
    passive: bool = True,
    least: ArrayLike | None = None,
    source: str = "",
) -> ExponentialKernel:
    """Fit a kernel with as few poles as a tolerance needs.

    Parameters
    ----------
    samples
        K at 0, step, 2 step, ..., shape (m, n, n); about 40 s in steps of 0.1 s.
    step
        [s].
    tolerance
        Largest error relative to s_i s_j; see `ExponentialKernel`.
    most_poles
        Limit of their number, both of each conjugate pair counted.
    floor
        Channels below it, relative to s_i s_j, are noise and become zero.
    passive
        Make the damping positive semidefinite at all frequencies.
    least
        Square roots of kernels so small that nothing feels them, shape (n,): s_i is not smaller.
    source
        Named in errors.

    Raises
    ------
    InputError
        If shapes do not fit, a sample is not finite, or there are too few samples for the poles.
    """
    K = np.asarray(samples, dtype=np.float64)
    if K.ndim != 3 or K.shape[1] != K.shape[2] or len(K) < 4 * most_poles:
        raise InputError(
            f"shape {K.shape}",
            source=source,
            key="kernel",
            expected=f"(m, n, n), m at least {4 * most_poles} for {most_poles} poles",
        )
    if not np.isfinite(K).all() or not (step > 0.0 and tolerance > 0.0 and most_poles >= 2):
        raise InputError(
            f"step {step}, tolerance {tolerance}, at most {most_poles} poles",
            source=source,
            key="kernel",
            expected="finite samples, a positive step and tolerance, two poles or more",
        )
    K = 0.5 * (K + K.transpose(0, 2, 1))
    n = K.shape[1]
    scales = channel_scales(K, least)
    significant = np.abs(K).max(axis=0) > floor * np.outer(scales, scales)
    active = np.flatnonzero(significant.any(axis=0))
    if len(active) == 0:
        zero = np.zeros((1, n, n), dtype=np.complex128)
        length = step * (len(K) - 1)
        return ExponentialKernel(np.array([-1.0 + 0.0j]), zero, np.zeros((n, n)), 0.0, 0.0, 0.0, length)
    unit = np.outer(scales[active], scales[active])
    inner = np.ix_(active, active)
    scaled = K[:, inner[0], inner[1]] / unit
    pairs = np.argwhere(np.triu(significant[inner]))
    series = np.ascontiguousarray(scaled[:, pairs[:, 0], pairs[:, 1]])
    times = step * np.arange(len(K), dtype=np.float64)
    vectors = _right_vectors(series, most_poles + EXTRA_POLES, NEGLIGIBLE * tolerance)
    best = _unfitted(vectors, series, times, tolerance, most_poles)
    lowest, change, extra = 0.0, 0.0, np.zeros(len(active))
    if passive:
        begin = len(best[0]) + int(np.count_nonzero(best[0].imag))
        more = EXTRA_POLES if best[2] <= tolerance else 0
        found = None
        for count in range(begin, min(begin + more, most_poles) + 1):
            poles, free, _ = best if count == begin else _fitted(vectors, count, series, times)
            functions = kernel_functions(poles, times)
            basis = free_coefficients(poles)
            trial = make_passive(poles, free, pairs, len(active), basis, functions @ basis)
            error = float(np.abs(functions @ trial.coefficients - series).max())
            if found is None or error < found[0]:
                found = (error, poles, free, trial)
            if error <= tolerance and not trial.extra:
                break
        assert found is not None
        error, poles, free, trial = found
        change = float(np.abs(kernel_functions(poles, times) @ (trial.coefficients - free)).max())
        lowest, extra = trial.lowest, np.full(len(active), trial.extra)
        best = (poles, trial.coefficients, error)
    poles, coefficients, error = best
    count = len(poles)
    residues = np.zeros((count, n, n), dtype=np.complex128)
    for c, (i, j) in enumerate(pairs):
        a, b = active[i], active[j]
        residues[:, a, b] = (coefficients[:count, c] + 1j * coefficients[count:, c]) * unit[i, j]
        residues[:, b, a] = residues[:, a, b]
    damping = np.zeros((n, n))
    damping[active, active] = extra * scales[active] ** 2
    parts = []
    if error > tolerance:
        parts.append(
            f"{count + np.count_nonzero(poles.imag)} poles fit the memory to {error:.2%}, not {tolerance:.2%}"
        )
    if extra.any():
        parts.append(
            f"damping of {extra[0]:.2g} of the kernel's start per second was added to keep the memory passive"
        )
    return ExponentialKernel(
        poles, residues, damping, error, lowest, change, float(times[-1]), "; ".join(parts)
    )


def common_poles(series: ArrayLike, step: float, count: int) -> NDArray[np.complex128]:
    """Poles that several series have in common, one of each conjugate pair.

    Parameters
    ----------
    series
        Samples at equal times, shape (m, channels), of about the same size.
    step
        Between samples [s].
    count
        Number of poles, both of each pair counted.
    """
    y = np.asarray(series, dtype=np.float64)
    return _poles(_right_vectors(y, count, 0.0), count, step, step * (len(y) - 1))


def _right_vectors(series: NDArray[np.float64], count: int, negligible: float) -> NDArray[np.float64]:
    """Leading right singular vectors of the Hankel matrices of all series under each other, shape (columns, count).

    Series are mixed first so that as few as possible are left: an orthogonal mixture of the Hankel matrices has the
    same right vectors. Those that are negligible are dropped.
    """
    series = series[:MOST_SAMPLES]
    left, sizes, _ = np.linalg.svd(series, full_matrices=False)
    mixed = left * sizes
    mixed = mixed[:, np.abs(mixed).max(axis=0) > negligible]
    m = len(series)
    columns = min(m // 2, MOST_COLUMNS)
    at_once = max(1, HANKEL_NUMBERS // ((m - columns + 1) * columns))
    triangle = np.zeros((0, columns))
    for first in range(0, mixed.shape[1], at_once):
        hankel = [
            np.lib.stride_tricks.sliding_window_view(y, columns) for y in mixed[:, first : first + at_once].T
        ]
        triangle = np.asarray(np.linalg.qr(np.vstack([triangle, *hankel]), mode="r"))
    return np.ascontiguousarray(np.linalg.svd(triangle)[2][:count].T)


def _poles(vectors: NDArray[np.float64], count: int, step: float, duration: float) -> NDArray[np.complex128]:
    """Poles from the invariance of the leading vectors to a shift by one sample."""
    V = vectors[:, :count]
    shift = np.linalg.lstsq(V[:-1], V[1:], rcond=None)[0]
    z = np.asarray(np.linalg.eigvals(shift), dtype=np.complex128)
    z = z[z.imag >= 0.0]
    real = z.imag == 0.0
    z[real] = np.maximum(np.abs(z[real]), 1e-6)  # alternating samples have no pole with a real kernel
    s = np.log(z) / step
    decay = np.maximum(np.abs(s.real), SLOWEST / duration)  # a growing one is reflected
    s.real, s.imag = -decay, np.where(real, 0.0, np.abs(s.imag))
    return np.asarray(s[np.lexsort((s.real, s.imag))], dtype=np.complex128)


def kernel_functions(poles: NDArray[np.complex128], times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Factors of Re R and Im R in K(t), shape (m, 2 P)."""
    powers = np.exp(np.outer(times, poles))
    return np.hstack([powers.real, -powers.imag])


def free_coefficients(poles: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Basis of the coefficients (Re R, Im R) without damping at zero frequency, shape (2 P, free).

    The imaginary part of the residue of a real pole has no effect and is left out.
    """
    kept = np.concatenate([np.ones(len(poles), dtype=bool), poles.imag != 0.0])
    row = damping_functions(poles, np.zeros(1))[0, kept]
    basis = np.zeros((len(kept), kept.sum() - 1))
    basis[kept] = np.linalg.svd(row[None])[2][1:].T
    return basis


def _fitted(
    vectors: NDArray[np.float64], count: int, series: NDArray[np.float64], times: NDArray[np.float64]
) -> tuple[NDArray[np.complex128], NDArray[np.float64], float]:
    """Poles, coefficients by least squares, shape (2 P, channels), and the largest error."""
    poles = _poles(vectors, count, times[1] - times[0], times[-1])
    basis = free_coefficients(poles)
    functions = kernel_functions(poles, times) @ basis
    free = np.linalg.lstsq(functions, series, rcond=1e-12)[0]
    return poles, basis @ free, float(np.abs(functions @ free - series).max())


def _unfitted(
    vectors: NDArray[np.float64],
    series: NDArray[np.float64],
    times: NDArray[np.float64],
    tolerance: float,
    most_poles: int,
) -> tuple[NDArray[np.complex128], NDArray[np.float64], float]:
    """The first number of poles that fits well enough, or the best of all."""
    best = None
    for count in range(2, most_poles + 1):
        trial = _fitted(vectors, count, series, times)
        if best is None or trial[2] < best[2]:
            best = trial
        if best[2] <= SAFETY * tolerance:
            break
    assert best is not None
    return best
