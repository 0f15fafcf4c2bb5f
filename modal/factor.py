"""Sparse Cholesky factorisations behind one interface: our own, and those of installed libraries."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING, Protocol

import numpy as np

from heavylift.modal.multifrontal import MultifrontalCholesky, NotPositiveDefiniteError, block_graph
from heavylift.numerics.elimination import dissect
from heavylift.numerics.outcome import InputError
from heavylift.numerics.threads import one_blas_thread

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray
    from scipy.sparse import csc_matrix, csr_array, sparray, spmatrix

__all__ = ["BACKENDS", "Factorisation", "NotPositiveDefiniteError", "available_backends", "factorise"]

BACKENDS = ("multifrontal", "cholmod", "pardiso", "superlu")
"""All backends, in the order in which ``auto`` takes the first that is installed.

The first one needs nothing but this package, so ``auto`` gives bitwise identical numbers wherever it runs. On
one thread, 110 000 unknowns and 30 modes, CHOLMOD takes a sixth less time if it is linked to an
optimised BLAS, and more with the reference BLAS, which cannot be detected here. PARDISO takes half as
much again, because its solves are slow, and SuperLU twice as much; ``benchmarks/eigen.py`` measures.
"""


class _Factor(Protocol):
    entries: int

    def solve(self, rhs: NDArray[np.float64]) -> NDArray[np.float64]: ...


class Factorisation:
    """A factorised symmetric positive definite matrix.

    Attributes
    ----------
    backend
        Which one was used.
    size
        Number of unknowns N.
    entries
        Entries of the triangular factor; 0 where the library does not tell.
    """

    def __init__(self, backend: str, size: int, factor: _Factor) -> None:
        self.backend = backend
        self.size = size
        self.entries = factor.entries
        self._factor = factor

    def solve(self, rhs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return x of ``A x = rhs`` for one right-hand side (N,) or several (N, m)."""
        rhs = np.asarray(rhs, dtype=np.float64)
        if rhs.ndim not in {1, 2} or rhs.shape[0] != self.size:
            raise InputError(
                f"right-hand side of shape {rhs.shape}",
                source="factorisation",
                expected=f"({self.size},) or ({self.size}, m)",
            )
        return self._factor.solve(rhs)


def available_backends() -> tuple[str, ...]:
    """Names of the backends that can be used here, best first."""
    modules = {"cholmod": "sksparse", "pardiso": "pypardiso"}
    return tuple(name for name in BACKENDS if name not in modules or find_spec(modules[name]) is not None)


@one_blas_thread
def factorise(
    matrix: sparray | spmatrix,
    *,
    backend: str = "auto",
    coordinates: NDArray[np.float64] | None = None,
) -> Factorisation:
    """Factorise a symmetric positive definite sparse matrix.

    Parameters
    ----------
    matrix
        Both triangles stored, (N, N).
    backend
        ``"auto"`` or one of `BACKENDS`.
    coordinates
        Positions of the nodes [m], shape (N/k, 3), if the unknowns are node-major with k of them a
        node. Gives a better elimination order, sooner; not needed.

    Raises
    ------
    InputError
        Unknown or not installed backend, or coordinates that do not fit.
    NotPositiveDefiniteError
        If the matrix is singular or indefinite.
    """
    from scipy.sparse import csr_array

    installed = available_backends()
    if backend == "auto":
        backend = installed[0]
    if backend not in installed:
        known = backend in BACKENDS
        raise InputError(
            f"factorisation {backend!r} is {'not installed' if known else 'unknown'}",
            source="modes",
            key="backend",
            expected="one of auto, " + ", ".join(installed),
        )
    size = matrix.shape[0]
    if matrix.shape != (size, size) or (
        coordinates is not None and (len(coordinates) == 0 or size % len(coordinates))
    ):
        places = "no" if coordinates is None else len(coordinates)
        raise InputError(
            f"matrix of shape {matrix.shape} with {places} positions",
            source="factorisation",
            expected="a square matrix and as many positions as nodes",
        )
    return Factorisation(backend, size, _MAKERS[backend](csr_array(matrix), coordinates))


def _dissected(
    matrix: csr_array, coordinates: NDArray[np.float64] | None
) -> tuple[NDArray[np.int64], csc_matrix]:
    """Nested-dissection order of the unknowns and the matrix in this order."""
    from scipy.sparse import csc_matrix

    blocks, graph = block_graph(matrix, coordinates)
    block = blocks.blocksize[0]
    del blocks
    unknowns = (block * dissect(graph, coordinates).order[:, None] + np.arange(block)).ravel()
    return unknowns, csc_matrix(matrix[unknowns][:, unknowns])


class _SuperLU:
    """LU without pivoting on our dissection: SuperLU's own orderings fill, or order, far slower."""

    def __init__(self, matrix: csr_array, coordinates: NDArray[np.float64] | None) -> None:
        from scipy.sparse.linalg import splu

        self._unknowns, permuted = _dissected(matrix, coordinates)
        try:
            self._lu = splu(
                permuted, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
            )
        except RuntimeError as error:
            raise NotPositiveDefiniteError(str(error)) from error
        self.entries = int(self._lu.nnz) // 2

    def solve(self, rhs: NDArray[np.float64]) -> NDArray[np.float64]:
        x = np.empty_like(rhs)
        x[self._unknowns] = self._lu.solve(rhs[self._unknowns])
        return x


class _Cholmod:
    """Supernodal Cholesky of SuiteSparse by scikit-sparse, on our dissection (METIS may be missing)."""

    def __init__(self, matrix: csr_array, coordinates: NDArray[np.float64] | None) -> None:
        from sksparse.cholmod import CholmodNotPositiveDefiniteError, cholesky

        self._unknowns, permuted = _dissected(matrix, coordinates)
        self.entries = 0
        try:
            self._factor = cholesky(permuted, mode="supernodal", ordering_method="natural")
            self._factor(np.zeros(matrix.shape[0]))  # a failed factor only shows on use
        except CholmodNotPositiveDefiniteError as error:
            raise NotPositiveDefiniteError(str(error)) from error

    def solve(self, rhs: NDArray[np.float64]) -> NDArray[np.float64]:
        x = np.empty_like(rhs)
        x[self._unknowns] = self._factor(rhs[self._unknowns])
        return x


class _Pardiso:
    """Intel MKL PARDISO by pypardiso, with its own METIS ordering."""

    def __init__(self, matrix: csr_array, coordinates: NDArray[np.float64] | None) -> None:
        import weakref

        from pypardiso import PyPardisoSolver
        from pypardiso.pardiso_wrapper import PyPardisoError
        from scipy.sparse import csr_matrix, triu

        del coordinates
        self._solver = PyPardisoSolver(mtype=2)
        self._upper = csr_matrix(triu(matrix, format="csr"))
        self._upper.sort_indices()
        try:
            self._solver.factorize(self._upper)
        except PyPardisoError as error:
            raise NotPositiveDefiniteError(str(error)) from error
        finally:
            weakref.finalize(self, self._solver.free_memory, everything=True)
        self.entries = int(self._solver.get_iparm(18))

    def solve(self, rhs: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.ascontiguousarray(self._solver.solve(self._upper, np.asfortranarray(rhs))).reshape(
            rhs.shape
        )


_MAKERS: dict[str, Callable[[csr_array, NDArray[np.float64] | None], _Factor]] = {
    "multifrontal": MultifrontalCholesky,
    "cholmod": _Cholmod,
    "pardiso": _Pardiso,
    "superlu": _SuperLU,
}
