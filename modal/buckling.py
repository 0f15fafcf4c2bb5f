"""Linear buckling: how many times a load can grow until a body leaves its shape.

With the geometric stiffness of the stress under a load, ``K phi = -lambda K_g phi``: the smallest positive lambda is
the factor by which all of the load may grow. It is an upper bound for a real body, whose shape and seams are not
perfect, and says nothing of yield. Modes of a reduced body know only the shapes that they have; so it is sought on the
full model.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.modal.eigen import signed
from heavylift.modal.lanczos import BLOCK, block_lanczos
from heavylift.numerics.outcome import InputError
from heavylift.numerics.threads import one_blas_thread

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.modal.flexibility import Flexibility

__all__ = ["Buckling", "buckling"]

_TOLERANCE = 1e-6  # of a vector; errors of the factor are of its square
_LIMIT = 400  # vectors of the Krylov space
_NEVER = 1e-9
"""Smallest inverse of a factor, relative to the largest of the load the other way round, that is not rounding."""


class Buckling(NamedTuple):
    """How a body buckles.

    Attributes
    ----------
    factor
        Of the load; infinite if no multiple of it buckles the body.
    shape
        Motion of all degrees of freedom, largest component 1, shape (N,); zeros if it does not buckle.
    """

    factor: float
    shape: NDArray[np.float64]


@one_blas_thread
def buckling(flexibility: Flexibility, geometric: csr_array, *, source: str = "", key: str = "") -> Buckling:
    """Lowest positive buckling factor of a load.

    Parameters
    ----------
    flexibility
        Factorised stiffness with its supports, or of a free body.
    geometric
        Geometric stiffness of the stress under the load [N/m, N, N m], sparse (N, N).
    source, key
        For messages.

    Raises
    ------
    InputError
        If the iteration does not converge.

    Notes
    -----
    Block Lanczos on ``-K^-1 K_g``, self-adjoint in the inner product of K; its largest eigenvalue is ``1 / lambda``.
    """
    model = flexibility.model
    loads = np.zeros((model.dof_count, BLOCK))
    loads[flexibility.unknowns] = np.random.default_rng(20140623).standard_normal(
        (len(flexibility.unknowns), BLOCK)
    )
    start = flexibility.solve(loads)
    elastic = len(flexibility.unknowns) - flexibility.rigid_count
    pairs = block_lanczos(
        lambda block: -flexibility.solve(geometric @ block),
        lambda block: np.asarray(model.stiffness @ block),
        start,
        1,
        tolerance=_TOLERANCE,
        limit=min(elastic, _LIMIT),
    )
    theta = float(pairs.values[0])
    # the other end of the spectrum is the load the other way round
    shape = pairs.vectors[:, 0]
    scale = float(np.linalg.norm(geometric @ shape)) / max(
        float(np.linalg.norm(model.stiffness @ shape)), 1e-300
    )
    if theta <= _NEVER * max(scale, 1e-300) or theta <= 0.0:
        return Buckling(np.inf, np.zeros(model.dof_count))
    if not pairs.converged and pairs.errors[0] > np.sqrt(_TOLERANCE):
        raise InputError(
            f"no buckling factor is found: an error of {pairs.errors[0]:.1e} is left after {pairs.dimension} vectors",
            source=source or model.name or "finite element model",
            key=key,
            expected="a load that presses somewhere, or no 'buckling'",
        )
    return Buckling(1.0 / theta, signed(shape[:, None])[:, 0] / np.abs(shape).max())
