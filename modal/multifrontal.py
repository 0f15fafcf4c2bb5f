"""Multifrontal Cholesky factorisation on a nested-dissection tree: sparse work done by dense BLAS3.

Not `heavylift.numerics.block_factor`, whose tables pay where one pattern is factored many times: for a block of 3,840
nodes they take 4.3 s to find, and all of this, order included, 0.24 s.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.elimination import dissect
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import bsr_array, csr_array

    from heavylift.numerics.arrays import Floats2, Floats3, Ints1

__all__ = ["MultifrontalCholesky", "NotPositiveDefiniteError", "block_graph"]


_SINGULAR = 1e-14
"""A pivot that keeps no more of its diagonal entry is rounding left over from a zero."""


class NotPositiveDefiniteError(RuntimeError):
    """A pivot was not positive: the matrix is singular or indefinite."""


def block_graph(matrix: csr_array, coordinates: NDArray[np.float64] | None) -> tuple[bsr_array, csr_array]:
    """Matrix in square blocks, one a node, and the graph of its nodes; parameters as of `MultifrontalCholesky`."""
    from scipy.sparse import csr_array

    size = matrix.shape[0]
    block = (3 if size % 3 == 0 else 1) if coordinates is None else size // len(coordinates)
    blocks = matrix.tobsr(blocksize=(block, block))
    ones = np.ones(len(blocks.indices), dtype=np.int8)
    return blocks, csr_array((ones, blocks.indices, blocks.indptr), shape=(size // block, size // block))


class _Front(NamedTuple):
    """One block column of the factor: rows of its own unknowns and rows of the later ones it touches."""

    first: int  # own unknowns are first:last in the elimination order
    last: int
    rows: NDArray[np.int64]  # places of the later unknowns
    diagonal: NDArray[np.float64]  # L11, lower triangle, Fortran order
    below: NDArray[np.float64]  # L21, Fortran order


class MultifrontalCholesky:
    """``P A P^T = L L^T`` of a symmetric positive definite sparse matrix.

    Parameters
    ----------
    matrix
        Both triangles stored, sparse (N, N), CSR.
    coordinates
        Node positions, shape (N/block, d), block = 1, 2, 3, ...; unknowns are node-major. None: the
        order is found from the graph alone, with block 3 if N is divisible by 3, else 1.

    Raises
    ------
    NotPositiveDefiniteError
        If a pivot block is not positive definite.

    Notes
    -----
    Duff and Reid, "The multifrontal solution of indefinite sparse symmetric linear equations", ACM
    TOMS 9 (1983). Each group of the dissection is one dense front; its Schur complement is added to
    the front of the group that owns the first row of it. Symbolic work is on nodes, not on unknowns.
    Only L is stored, about half of what an LU factorisation needs.
    """

    def __init__(self, matrix: csr_array, coordinates: NDArray[np.float64] | None = None) -> None:
        blocks, graph = block_graph(matrix, coordinates)
        size, n, block = matrix.shape[0], graph.shape[0], blocks.blocksize[0]
        order, starts = dissect(graph, coordinates)
        place = np.empty(n, dtype=np.int64)
        place[order] = np.arange(n)
        self.size = size
        self.entries = 0
        self._unknowns = (block * order[:, None] + np.arange(block)).ravel()
        self._fronts: list[_Front] = []
        self._factorise(blocks, order, place, starts)

    def _factorise(
        self,
        blocks: csr_array,
        order: NDArray[np.int64],
        place: NDArray[np.int64],
        starts: NDArray[np.int64],
    ) -> None:
        """Eliminate group by group; `blocks` is the matrix in block rows."""
        from scipy.linalg.blas import dsyrk, dtrsm
        from scipy.linalg.lapack import dpotrf

        indptr = blocks.indptr.astype(np.int64)
        indices = blocks.indices.astype(np.int64)
        data = np.ascontiguousarray(blocks.data)
        p = data.shape[1]
        original = blocks.diagonal()
        group_of = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
        # Schur complements that wait for their parent
        waiting: dict[int, list[tuple[NDArray[np.int64], NDArray[np.float64]]]] = {}
        for g in range(len(starts) - 1):
            a, b = int(starts[g]), int(starts[g + 1])
            children = waiting.pop(g, [])
            touched = [place[indices[indptr[node] : indptr[node + 1]]] for node in order[a:b]]
            later = np.unique(np.concatenate([*touched, *(rows for rows, _ in children)]))
            later = later[np.searchsorted(later, b) :]
            s, t = p * (b - a), p * len(later)
            diagonal = np.zeros((s, s), order="F")
            below = np.zeros((t, s), order="F")
            schur = np.zeros((t, t), order="F")
            _scatter(a, b, order, place, indptr, indices, data, later, diagonal.T, below.T)
            while children:
                rows, update = children.pop()
                target = np.empty(p * len(rows), dtype=np.int64)
                _extend_add(update.T, rows, p, a, b, later, diagonal.T, below.T, schur.T, target)
                del update
            diagonal, info = dpotrf(diagonal, lower=1, clean=0, overwrite_a=1)
            before = original[self._unknowns[p * a : p * b]]
            if info != 0 or np.any(np.diagonal(diagonal) ** 2 <= _SINGULAR * before):
                raise NotPositiveDefiniteError(f"a pivot of unknowns {p * a + 1} to {p * b} is not positive")
            if t:
                below = dtrsm(1.0, diagonal, below, side=1, lower=1, trans_a=1, overwrite_b=1)
                schur = dsyrk(-1.0, below, beta=1.0, c=schur, lower=1, overwrite_c=1)
                waiting.setdefault(int(group_of[later[0]]), []).append((later, schur))
            rows_of_unknowns = (p * later[:, None] + np.arange(p)).ravel()
            self._fronts.append(_Front(p * a, p * b, rows_of_unknowns, diagonal, below))
            self.entries += s * (s + 1) // 2 + s * t

    def solve(self, rhs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return x of ``A x = rhs``; rhs of shape (N,) or (N, m). Many columns at once cost far less each."""
        from scipy.linalg.blas import dgemm, dtrsm

        # all products by scipy's BLAS: numpy's is another library with threads of its own,
        # and two pools that take turns in small calls spend ten times the work on waiting
        rhs = np.asarray(rhs, dtype=np.float64)
        y = np.ascontiguousarray(rhs.reshape(self.size, -1)[self._unknowns])
        if not y.shape[1]:
            return np.zeros(rhs.shape)
        for front in self._fronts:  # L y = b
            # rows of y are contiguous, so their transpose is a Fortran array: X L^T = B in place
            own = y[front.first : front.last].T
            dtrsm(1.0, front.diagonal, own, side=1, lower=1, trans_a=1, overwrite_b=1)
            if len(front.rows):
                y[front.rows] -= dgemm(1.0, own, front.below, trans_b=1).T
        for front in reversed(self._fronts):  # L^T x = y
            own = y[front.first : front.last].T
            if len(front.rows):
                dgemm(-1.0, y[front.rows].T, front.below, beta=1.0, c=own, overwrite_c=1)
            dtrsm(1.0, front.diagonal, own, side=1, lower=1, overwrite_b=1)
        x = np.empty_like(y)
        x[self._unknowns] = y
        return x.reshape(rhs.shape)


@kernel(internal=True)
def _place_in(rows: Ints1, node: int) -> int:
    """Place of a node in ascending ones, of which it is one."""
    low, high = 0, rows.shape[0]
    while low < high:
        middle = (low + high) // 2
        if rows[middle] < node:
            low = middle + 1
        else:
            high = middle
    return low


@entry
def _scatter(
    a: int,
    b: int,
    order: Ints1,
    place: Ints1,
    indptr: Ints1,
    indices: Ints1,
    data: Floats3,
    later: Ints1,
    diagonal: Floats2,
    below: Floats2,
) -> None:
    """Copy the columns a:b of the matrix, lower triangle, into a front: transposed, as Fortran arrays are."""
    p = data.shape[1]
    for j in range(a, b):
        node = order[j]
        for k in range(indptr[node], indptr[node + 1]):
            i = place[indices[k]]
            if i < j:
                continue
            # block k is K[j, i]; the entry below the diagonal is its transpose
            if i < b:
                for c in range(p):
                    for r in range(p):
                        diagonal[p * (j - a) + c, p * (i - a) + r] = data[k, c, r]
            else:
                row = p * _place_in(later, i)
                for c in range(p):
                    for r in range(p):
                        below[p * (j - a) + c, row + r] = data[k, c, r]


@entry
def _extend_add(
    update: Floats2,
    rows: Ints1,
    p: int,
    a: int,
    b: int,
    later: Ints1,
    diagonal: Floats2,
    below: Floats2,
    schur: Floats2,
    target: Ints1,
) -> None:
    """Add a child's Schur complement (lower triangle, unknowns of nodes `rows`) to its parent's front.

    All are transposed, as Fortran arrays are; `target` is scratch, one place for each unknown.
    """
    m = p * rows.shape[0]
    own = 0  # target: places within own or within later unknowns
    for i in range(rows.shape[0]):
        if rows[i] < b:
            first = p * (rows[i] - a)
            own += p
        else:
            first = p * _place_in(later, rows[i])
        for r in range(p):
            target[p * i + r] = first + r
    for j in range(own):
        for i in range(j, own):
            diagonal[target[j], target[i]] += update[j, i]
        for i in range(own, m):
            below[target[j], target[i]] += update[j, i]
    for j in range(own, m):
        for i in range(j, m):
            schur[target[j], target[i]] += update[j, i]
