"""Reactions of redundant joints at the start: what such joints do against each other is taken out.

Joints that hold a body more than once fit each other to rounding only. A tiny step tells their common reaction, but
presses them against each other with rounding over the square of that step. The forces ``G^T l`` on the bodies are right
in any case; of all reactions with these forces, redundant rows that share by their softness have those with the least
``l . D l``, where D is the characteristic inverse mass of each row.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.start.rows import StartRows

__all__ = ["share_reactions"]

ITERATIONS, MET = 200, 1e-14
"""Of the least squares, at most; and relative change at which they end."""


def share_reactions(rows: StartRows, reactions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Reactions of the rows with the same forces on all bodies, shared by the rigid rows.

    Parameters
    ----------
    rows
        The scene at its start.
    reactions
        [N, N m], shape (rows,).

    Returns
    -------
    ndarray
        Shape (rows,).
    """
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import lsqr

    rows.fill()
    rigid = rows.rigid
    root = np.sqrt(rows.column("scale")[rigid])
    A = (diags_array(1.0 / root) @ rows.jacobian()[rigid][:, rows.free]).T
    # columns of unit length, so that translations and turns count alike
    norm = np.sqrt(np.asarray((A * A).sum(axis=1)).ravel())
    A = diags_array(1.0 / np.where(norm > 0.0, norm, 1.0)) @ A
    pressed = root * reactions[rigid]
    shared = reactions.copy()
    shared[rigid] = lsqr(A, A @ pressed, atol=MET, btol=MET, iter_lim=ITERATIONS + 4 * A.shape[0])[0] / root
    return shared
