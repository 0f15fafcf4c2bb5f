"""Eigenvalues and eigenvectors of a linear system; motions that nothing holds are told apart from slow ones.

A displacement that nothing holds, and its velocity, have a double eigenvalue zero with one eigenvector, and rounding
e of the matrix makes it ``+- sqrt(e)``, a slow mode that does not exist. So eigenvalues below what rounding can make
are taken together: their invariant subspace from an ordered Schur form (G. W. Stewart, ACM Trans. Math. Software 2,
1976), in which the matrix is nilpotent but for rounding, and its null vectors there.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["find_modes"]

ROUNDING = 1e-9
"""Of the largest eigenvalue: what rounding makes of one that is zero, beside a given rate."""

SAME = 1e-6
"""Relative difference of eigenvalues that have their eigenvectors together."""

INDEPENDENT = 1e-3
"""Singular value of unit eigenvectors above which they span their space."""


def find_modes(
    A: NDArray[np.float64], scale: NDArray[np.float64], slowest: float
) -> tuple[NDArray[np.complex128], NDArray[np.complex128], NDArray[np.float64], int]:
    """Modes of ``x' = A x``.

    Parameters
    ----------
    A
        Shape (n, n).
    scale
        States of comparable size, shape (n,).
    slowest
        Rate below which an eigenvalue is zero [1/s].

    Returns
    -------
    values
        Eigenvalues [1/s], of each pair the one with a positive imaginary part, by modulus; zeros come first, one for
        each independent motion.
    vectors
        Eigenvectors with a largest component of 1 in units of the scale, shape (n, modes).
    parts
        Part of each state in each mode, shape (n, modes): products of left and right eigenvectors (I. J. Perez-Arriaga,
        G. C. Verghese and F. C. Schweppe, IEEE Trans. PAS 101, 1982), as parts of the sum of their moduli.
    zeros
        Eigenvalues that are zero, velocities included.
    """
    from scipy.linalg import eig, schur

    count = len(A)
    if count == 0:
        nothing = np.zeros((0, 0))
        return np.zeros(0, dtype=np.complex128), nothing.astype(np.complex128), nothing, 0
    S = A / scale[:, None] * scale
    values, left, vectors = eig(S, left=True)
    limit = max(slowest, ROUNDING * float(np.abs(values).max()))
    still = np.abs(values) <= limit
    zeros, null = int(np.count_nonzero(still)), np.zeros((count, 0))
    if zeros:
        T, Z, zeros = schur(S, output="real", sort=lambda re, im=0.0: np.hypot(re, im) <= limit)
        _, sizes, right = np.linalg.svd(T[:zeros, :zeros])
        null = Z[:, :zeros] @ right[sizes <= max(limit, INDEPENDENT * sizes[0])].T
    order = np.argsort(np.abs(values), kind="stable")
    order = order[(values[order].imag >= 0.0) & ~still[order]]
    found = _independent(values[order], vectors[:, order])
    both = np.hstack([null.astype(np.complex128), found])
    largest = both[np.abs(both).argmax(axis=0), np.arange(both.shape[1])]
    both = both / largest * scale[:, None]
    parts = np.hstack([np.abs(null) ** 2, np.abs(left[:, order] * vectors[:, order])])
    parts = parts / parts.sum(axis=0)
    return np.concatenate([np.zeros(null.shape[1]), values[order]]), both, parts, zeros


def _independent(values: NDArray[np.complex128], vectors: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Eigenvectors of repeated eigenvalues as an orthonormal basis of their space, if they span one."""
    found = vectors.copy()
    first = 0
    while first < len(values):
        last = first + 1
        while last < len(values) and abs(values[last] - values[first]) <= SAME * abs(values[first]):
            last += 1
        if last - first > 1:
            left, sizes, _ = np.linalg.svd(vectors[:, first:last], full_matrices=False)
            if sizes[-1] > INDEPENDENT * sizes[0]:
                found[:, first:last] = left
        first = last
    return found
