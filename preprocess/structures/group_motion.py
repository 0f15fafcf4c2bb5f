"""Motion of a place as that of a group of nodes: the mean in the sense of least squares, and the rigid one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.structures.beam import skew

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["WORST_CONDITION", "mean_motion", "rigid_motion"]

WORST_CONDITION = 1e8
"""Of the second moments of a group about its centre: beyond it the group is a line."""


def rigid_motion(arms: NDArray[np.float64]) -> NDArray[np.float64]:
    """Displacements ``u + theta x r`` at arms r (m, 3) from displacement and rotation of a point, shape (m, 3, 6)."""
    A = np.zeros((len(arms), 3, 6))
    A[:, :, :3] = np.eye(3)
    A[:, :, 3:] = -skew(arms)
    return A


def mean_motion(
    point: NDArray[np.float64],
    positions: NDArray[np.float64],
    weights: NDArray[np.float64],
    rotating: NDArray[np.bool_],
    *,
    source: object = "structure",
    key: str = "",
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Weighted mean of the motion of some nodes (RBE3).

    Parameters
    ----------
    point
        Whose motion is wanted [m], shape (3,).
    positions
        Of the nodes [m], shape (m, 3).
    weights
        Positive, shape (m,).
    rotating
        Which nodes have rotations, shape (m,).
    source, key
        Named in messages.

    Returns
    -------
    tuple
        Loads on the nodes from the force and the moment at the point: forces and moments, each of shape (m, 3, 6).
        Transposed they make displacement and rotation of the point of displacements and rotations of the nodes.

    Raises
    ------
    InputError
        Weights that are not positive; nodes on one line, or a single one, that have no rotations.

    Notes
    -----
    With ``A_i = [1, -skew(x_i - p)]`` the motion V = (u, theta) of the point minimises ``sum w_i |u_i - A_i V|^2``:
    ``V = (sum w A^T A)^-1 sum w_i A_i^T u_i``. About the line of nodes that are on one displacements say nothing; then
    ``sum w_i l^2 |theta_i - theta|^2`` is added, l the size of the group.
    """
    w = np.asarray(weights, dtype=np.float64)
    if len(w) != len(positions) or not len(w) or not np.all(np.isfinite(w)) or np.any(w <= 0.0):
        raise InputError(
            f"weights {w.tolist()}" if len(w) < 9 else f"{len(w)} weights, {w.min():g} the smallest",
            source=source,
            key=key,
            expected=f"{len(positions)} positive weights, one a node of the group",
        )
    arms = positions - point
    A = rigid_motion(arms)
    H = np.einsum("m,mki,mkj->ij", w, A, A)
    spread = positions - w @ positions / w.sum()
    second = np.einsum("m,mi,mj->ij", w, spread, spread)
    inertia = np.linalg.eigvalsh(np.trace(second) * np.eye(3) - second)
    turns = np.zeros((len(w), 3, 6))
    if inertia[0] * WORST_CONDITION <= inertia[2] or inertia[2] == 0.0:
        if not rotating.any():
            x, y, z = positions[0]
            raise InputError(
                "is a node without rotations" if len(w) == 1 else "is on one line of nodes without rotations",
                source=source,
                key=key,
                expected="nodes of plates and beams, or nodes of solids that are not on one line, around "
                f"({x:.6g}, {y:.6g}, {z:.6g}) m: the rotation of the group follows from nothing else",
            )
        size = float(np.ptp(positions, axis=0).max()) or 1.0
        turned = w * rotating * size**2
        H[3:, 3:] += turned.sum() * np.eye(3)
        turns[:, :, 3:] = turned[:, None, None] * np.eye(3)
    scale = np.sqrt(np.diagonal(H))
    inverse = np.linalg.inv(H / np.outer(scale, scale)) / np.outer(scale, scale)
    return w[:, None, None] * np.matmul(A, inverse), np.matmul(turns, inverse)
