"""Rank and null spaces of the rows of joints: dense where it is cheap, by blocks of a body where it is not."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["block_rank", "null_spaces", "rank_of"]

DENSE = 480
"""Columns up to which a singular value decomposition is taken."""


def null_spaces(
    matrix: NDArray[np.float64], tolerance: float
) -> tuple[int, NDArray[np.float64], NDArray[np.float64]]:
    """Rank, null space (columns, n) and left null space (columns, m) of a dense matrix (m, n) of unit rows."""
    m, n = matrix.shape
    if m == 0 or n == 0:
        return 0, np.eye(n), np.eye(m)
    u, sigma, vt = np.linalg.svd(matrix)
    rank = int(np.count_nonzero(sigma > tolerance))
    return rank, vt[rank:].T, u[:, rank:]


def rank_of(matrix: Any, owner: NDArray[np.int64], tolerance: float) -> int:
    """Rank of a sparse matrix of unit rows, shape (rows, columns), with the body of each column."""
    if matrix.shape[0] == 0:
        return 0
    if matrix.shape[1] <= DENSE:
        return null_spaces(matrix.toarray(), tolerance)[0]
    return block_rank(matrix, owner, tolerance)


def block_rank(matrix: Any, owner: NDArray[np.int64], tolerance: float) -> int:
    """Rank by orthogonal elimination of one body after the other.

    Parameters
    ----------
    matrix
        Sparse by rows, unit rows, shape (rows, columns).
    owner
        Body of each column.
    tolerance
        Size of what counts as zero.

    Notes
    -----
    All rows on a body are rotated so that as few of them as its own rank, found by QR with exchange of
    columns, have anything in its columns; these are put aside and counted, the others go on to its neighbours.
    Rotations keep the rank, so this is a multifrontal QR (T. A. Davis, ACM Trans. Math. Software 38, 2011, on
    SuiteSparseQR) whose fronts are bodies; bodies with few neighbours go first.
    """
    from scipy.linalg import qr

    numbers = {body: np.flatnonzero(owner == body) for body in np.unique(owner)}
    fronts: dict[int, tuple[tuple[int, ...], NDArray[np.float64]]] = {}
    on_body: dict[int, set[int]] = {body: set() for body in numbers}

    def add(bodies: tuple[int, ...], dense: NDArray[np.float64]) -> None:
        key = add.count  # type: ignore[attr-defined]
        add.count += 1  # type: ignore[attr-defined]
        fronts[key] = bodies, dense
        for body in bodies:
            on_body[body].add(key)

    add.count = 0  # type: ignore[attr-defined]
    for row in range(matrix.shape[0]):
        columns = matrix.indices[matrix.indptr[row] : matrix.indptr[row + 1]]
        bodies = tuple(int(body) for body in np.unique(owner[columns]))
        if bodies:
            wide = np.concatenate([numbers[body] for body in bodies])
            dense = np.zeros((1, len(wide)))
            dense[
                0, np.searchsorted(wide, columns) if np.all(np.diff(wide) > 0) else _places(wide, columns)
            ] = matrix.data[matrix.indptr[row] : matrix.indptr[row + 1]]
            add(bodies, dense)
    rank = 0
    left = set(numbers)
    while left:
        body = min(left, key=lambda one: (len({b for key in on_body[one] for b in fronts[key][0]}), one))
        left.remove(body)
        keys = sorted(on_body.pop(body))
        others = sorted({b for key in keys for b in fronts[key][0]} - {body})
        bodies = (body, *others)
        width = [len(numbers[b]) for b in bodies]
        starts = dict(zip(bodies, np.cumsum([0, *width[:-1]]), strict=True))
        stacked = []
        for key in keys:
            own, dense = fronts.pop(key)
            wide = np.zeros((len(dense), sum(width)))
            at = 0
            for b in own:
                count = len(numbers[b])
                wide[:, starts[b] : starts[b] + count] = dense[:, at : at + count]
                at += count
                if b != body:
                    on_body[b].discard(key)
            stacked.append(wide)
        if not stacked:
            continue
        front = np.vstack(stacked)
        Q, R, _ = qr(front[:, : width[0]], pivoting=True)
        own_rank = int(np.count_nonzero(np.abs(np.diag(R)) > tolerance))
        rank += own_rank
        rest = (Q[:, own_rank:].T @ front)[:, width[0] :]
        if len(rest) > rest.shape[1] > 0:
            rest = np.linalg.qr(rest, mode="r")
        rest = rest[np.abs(rest).max(axis=1, initial=0.0) > tolerance]
        if len(rest):
            add(tuple(others), rest)
    return rank


def _places(wide: NDArray[np.int64], columns: Sequence[int] | NDArray[np.int64]) -> NDArray[np.int64]:
    """Where columns stand in a list of columns that is not sorted."""
    order = np.argsort(wide)
    return order[np.searchsorted(wide[order], columns)]
