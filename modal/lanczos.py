"""Block Lanczos iteration: the largest eigenpairs of an operator that is fast on many vectors at once."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Operator = Callable[[NDArray[np.float64]], NDArray[np.float64]]

__all__ = ["RitzPairs", "block_lanczos", "mass_orthonormal"]

BLOCK = 8
"""Vectors solved at once: a solve of 8 costs about twice one, wider blocks need larger spaces."""

_DEPENDENT = 1e-10  # a vector that keeps less of its length is in the space already


class RitzPairs(NamedTuple):
    """Converged pairs.

    Attributes
    ----------
    values
        Eigenvalues of the operator, descending, shape (count,).
    vectors
        M-orthonormal, shape (N, count).
    errors
        Estimates of ``||A x - theta x||_M / theta``, shape (count,).
    dimension
        Vectors in the Krylov space.
    converged
        Whether all errors are below the tolerance.
    """

    values: NDArray[np.float64]
    vectors: NDArray[np.float64]
    errors: NDArray[np.float64]
    dimension: int
    converged: bool


def block_lanczos(
    operator: Operator,
    mass: Operator,
    start: NDArray[np.float64],
    count: int,
    *,
    tolerance: float,
    limit: int,
    down_to: float = 0.0,
) -> RitzPairs:
    """Largest eigenpairs of an operator A that is self-adjoint in the inner product of M.

    Parameters
    ----------
    operator, mass
        Apply A and M to blocks (N, m).
    start
        First block, shape (N, m).
    count
        Number of pairs.
    tolerance
        For ``||A x - theta x||_M / theta``; errors of eigenvalues are of its square.
    limit
        Largest dimension of the Krylov space.
    down_to
        Only eigenvalues no smaller than this, and the next one, which shows that there are no more.

    Notes
    -----
    Grimes, Lewis, Simon, "A shifted block Lanczos algorithm for solving sparse symmetric generalized
    eigenproblems", SIAM J. Matrix Anal. Appl. 15 (1994), with full reorthogonalisation instead of the
    selective one: the space stays small, because the spectrum of a flexibility decays fast.
    The block also finds eigenvalues of multiplicity up to its width.
    """
    basis: list[NDArray[np.float64]] = []
    weighted: list[NDArray[np.float64]] = []  # M times the basis
    projected = np.zeros((0, 0))
    next_check = count if down_to == 0.0 else min(count, 4 * start.shape[1])
    block, block_mass, _ = _new_block(start, mass, basis, weighted)
    while True:
        basis.append(block)
        weighted.append(block_mass)
        width, size = block.shape[1], sum(part.shape[1] for part in basis)
        image = operator(block)
        # the image is orthogonal to all but the last two blocks up to rounding
        coefficients = np.zeros((size, block.shape[1]))
        recent = sum(part.shape[1] for part in basis[-2:])
        coefficients[size - recent :] += _orthogonalise(image, basis[-2:], weighted[-2:])
        coefficients += _orthogonalise(image, basis, weighted)
        grown = np.zeros((size, size))
        grown[: size - width, : size - width] = projected
        grown[:, size - width :] = coefficients
        grown[size - width :, :] = coefficients.T
        projected = grown
        projected[-width:, -width:] = 0.5 * (coefficients[-width:] + coefficients[-width:].T)
        block, block_mass, coupling = _new_block(image, mass, basis, weighted, np.abs(coefficients).max())
        exhausted = block.shape[1] == 0 or size + block.shape[1] > limit
        if size < next_check and not exhausted:
            continue
        next_check = (
            int((1.05 if down_to == 0.0 else 1.2) * size) + 1
        )  # the small eigenproblem costs the cube of its size
        values, small = np.linalg.eigh(projected)
        wanted = min(count, int(np.count_nonzero(values >= down_to)) + 1)
        values, small = values[::-1][:wanted], small[:, ::-1][:, :wanted]
        errors = np.linalg.norm(coupling @ small[-width:], axis=0) / np.maximum(np.abs(values), 1e-300)
        converged = len(values) == wanted and bool(np.all(errors <= tolerance))
        if converged or exhausted:
            vectors = np.zeros((len(start), len(values)))
            row = 0
            for part in basis:
                vectors += part @ small[row : row + part.shape[1]]
                row += part.shape[1]
            return RitzPairs(values, vectors, errors, size, converged)


def mass_orthonormal(
    vectors: NDArray[np.float64], vectors_mass: NDArray[np.float64], scale: float
) -> NDArray[np.float64]:
    """Combinations C that make ``V C`` M-orthonormal, without those shorter than `scale`; (m, m')."""
    gram = vectors.T @ vectors_mass
    length, axes = np.linalg.eigh(0.5 * (gram + gram.T))
    keep = length > scale**2
    return axes[:, keep] / np.sqrt(length[keep])


def _orthogonalise(
    image: NDArray[np.float64], basis: list[NDArray[np.float64]], weighted: list[NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Make a block M-orthogonal to the basis, in place; return the coefficients removed."""
    removed = []
    for part, part_mass in zip(basis, weighted, strict=True):
        removed.append(part_mass.T @ image)
        image -= part @ removed[-1]
    return np.concatenate(removed)


def _new_block(
    image: NDArray[np.float64],
    mass: Operator,
    basis: list[NDArray[np.float64]],
    weighted: list[NDArray[np.float64]],
    scale: float = 0.0,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """M-orthonormal basis of what is new in a block, M times it, and B with ``image = block B``."""
    image_mass = mass(image)
    combination = mass_orthonormal(image, image_mass, _DEPENDENT * scale)
    block = image @ combination
    if scale:
        _orthogonalise(block, basis, weighted)  # small vectors lost some orthogonality by scaling
    block_mass = mass(block)
    second = mass_orthonormal(block, block_mass, 0.5)  # of length one up to rounding
    block, block_mass = block @ second, block_mass @ second
    return block, block_mass, block_mass.T @ image
