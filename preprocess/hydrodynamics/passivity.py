"""Residues of a sum of exponentials, changed as little as makes its damping positive semidefinite everywhere.

With given poles the damping B(omega) = Re K(i omega) is linear in the residues, and those with v' B(omega) v >= 0 for
all omega and v are a convex set. It is approached by cutting planes: the nearest residues in the sense of least
squares of the kernel that satisfy the conditions found so far, then the frequencies and vectors where damping is
still negative become conditions themselves. Each problem is one of least distance (Lawson and Hanson, *Solving Least
Squares Problems* (1974), chapter 23).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

__all__ = ["PassiveFit", "damping_functions", "lowest_damping", "make_passive"]

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
    rows: list[NDArray[np.float64]] = []
    needs: list[float] = []
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
        for k in range(len(places)):
            row = np.outer(reduced[k], factors[k] / weights).ravel()
            norm = float(np.linalg.norm(row))
            rows.append(row / norm)
            needs.append((MARGIN * largest * float(_shape(places[k], peak)) - now[k]) / norm)
        nearest = _least_distance(np.array(rows), np.array(needs))
        if nearest is None:
            break
        move, holding = nearest
        rows = [row for row, kept in zip(rows, holding, strict=True) if kept]
        needs = [need for need, kept in zip(needs, holding, strict=True) if kept]
        change = solve_triangular(R, move.reshape(R.shape[0], len(pairs)), lower=False) / weights
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


def _least_distance(
    G: NDArray[np.float64], h: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]] | None:
    """The shortest x with G x >= h and which rows hold it, or None if there is none (Lawson and Hanson, 23.4)."""
    from scipy.optimize import nnls

    size = float(np.abs(h).max())
    E = np.vstack([G.T, h[None] / size])
    f = np.zeros(len(E))
    f[-1] = 1.0
    Q, R = np.linalg.qr(E)
    try:
        u, _ = nnls(R, Q.T @ f, maxiter=10 * E.shape[1] + 100)
    except RuntimeError:
        return None
    residual = E @ u - f
    if np.linalg.norm(residual) < 1e-10 or residual[-1] == 0.0:
        return None
    return -residual[:-1] / residual[-1] * size, u > 0.0
