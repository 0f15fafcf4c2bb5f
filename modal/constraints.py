"""What is left to move of a model: degrees of freedom that are neither held nor follow others."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.finite_elements.model import FEModel

__all__ = ["FreeDofs", "following", "free_dofs"]

_NOTHING = 1e-12  # entry of a condition, whose largest one is 1
_RANK = 1e-9  # of the first pivot: conditions that repeat others


class FreeDofs(NamedTuple):
    """Unknowns of a model, and all of its degrees of freedom from them.

    Attributes
    ----------
    unknowns
        Degrees of freedom that are neither held nor follow others, sorted.
    expansion
        E, sparse (N, N): all degrees of freedom from the unknowns, with columns of zeros where there is no unknown.
        None if nothing follows: then those that are no unknowns are zero.
    """

    unknowns: NDArray[np.int64]
    expansion: csr_array | None

    def gathered(self, forces: NDArray[np.float64]) -> NDArray[np.float64]:
        """Forces on the unknowns, those on what follows included: ``E^T f``, shape (N,) or (N, m) like `forces`."""
        return forces if self.expansion is None else np.asarray(self.expansion.T @ forces)

    def expanded(self, displacements: NDArray[np.float64]) -> NDArray[np.float64]:
        """All displacements from those of the unknowns, zero elsewhere; ``E u``, shape (N,) or (N, m)."""
        return displacements if self.expansion is None else np.asarray(self.expansion @ displacements)

    def condensed(self, matrix: csr_array) -> csr_array:
        """``E^T A E`` of a sparse matrix (N, N)."""
        from scipy.sparse import csr_array

        if self.expansion is None:
            return csr_array(matrix)
        return csr_array(self.expansion.T @ (matrix @ self.expansion))


def following(model: FEModel) -> csr_array | None:
    """All degrees of freedom of a model from those that follow none, sparse (N, N); None if nothing follows.

    Raises
    ------
    InputError
        If a free one has no row of its own in the constraint of the model.
    """
    from scipy.sparse import csr_array

    if model.constraint is None:
        return None
    constraint = csr_array(model.constraint)
    single = np.flatnonzero(np.diff(constraint.indptr) == 1)
    entries = constraint.indptr[single]
    single, columns = (
        part[constraint.data[entries] == 1.0] for part in (single, constraint.indices[entries])
    )
    found, first = np.unique(columns, return_index=True)
    if len(found) < constraint.shape[1]:
        raise InputError(
            f"{constraint.shape[1] - len(found)} free degree(s) of freedom without a row of their own",
            source=model.name or "finite element model",
            key="constraint",
            expected="a row with a single 1 for each column",
        )
    own = single[first].astype(np.int64)
    size = model.dof_count
    return csr_array((constraint.data, own[constraint.indices], constraint.indptr), shape=(size, size))


def free_dofs(model: FEModel, held: NDArray[np.int64]) -> FreeDofs:
    """Unknowns of a model with some degrees of freedom held.

    Parameters
    ----------
    model
        Finite element model.
    held
        Degrees of freedom that do not move. One that follows others is a condition on those.

    Raises
    ------
    InputError
        See `following`.
    """
    from scipy.linalg import qr, solve_triangular
    from scipy.sparse import coo_array, csr_array, diags_array

    free = np.ones(model.dof_count, dtype=bool)
    free[held] = False
    expansion = following(model)
    if expansion is None:
        return FreeDofs(np.flatnonzero(free), None)
    leads = np.zeros(model.dof_count, dtype=bool)
    leads[expansion.indices] = True
    free &= leads
    conditions = csr_array(expansion[held] @ diags_array(free.astype(np.float64)))
    conditions.eliminate_zeros()
    involved = np.unique(conditions.indices)
    dense = conditions[:, involved].toarray()
    largest = np.abs(dense).max(axis=1, initial=0.0)
    dense = dense[largest > _NOTHING] / largest[largest > _NOTHING, None]
    if len(dense):
        R, pivots = qr(dense, mode="r", pivoting=True)
        rank = int(np.count_nonzero(np.abs(np.diagonal(R)) > _RANK * abs(R[0, 0])))
        led, rest = involved[pivots[:rank]], involved[pivots[rank:]]
        free[led] = False
        weights = coo_array(-solve_triangular(R[:rank, :rank], R[:rank, rank:]))
        size = model.dof_count
        leading = csr_array((weights.data, (led[weights.row], rest[weights.col])), shape=(size, size))
        expansion = expansion @ (leading + diags_array(free.astype(np.float64)))
    expansion = csr_array(expansion @ diags_array(free.astype(np.float64)))
    expansion.eliminate_zeros()
    return FreeDofs(np.flatnonzero(free), expansion)
