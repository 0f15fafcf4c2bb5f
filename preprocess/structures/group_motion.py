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
        Positive in sum, shape (m,).
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
        Weights of no positive sum; nodes on one line, or a single one, that have no rotations.

    Notes
    -----
    With the weighted centre c, the arms r from it, and W the sum of weights::

        theta = J^-1 sum w r x u,    u_p = sum w u / W + theta x (p - c),    J = sum w (r^2 1 - r r^T)

    minimise ``sum w |u_i - u_p - theta x (x_i - p)|^2``. About the line of nodes that are on one, displacements say
    nothing; then ``sum w l^2 |theta_i - theta|^2`` is added, l the length of the group.
    """
    w = np.asarray(weights, dtype=np.float64)
    total = float(w.sum())
    if w.shape != (len(positions),) or not np.all(np.isfinite(w)) or not total > 0.0:
        raise InputError(
            f"{len(w)} weights of sum {total:g}",
            source=source,
            key=key,
            expected=f"{len(positions)} weights, one a node of the group, of a positive sum",
        )
    centre = w @ positions / total
    arms = positions - centre
    second = (arms * w[:, None]).T @ arms
    inertia = np.trace(second) * np.eye(3) - second
    moments_of_inertia = np.linalg.eigvalsh(inertia)
    turning = np.zeros(len(w))
    if moments_of_inertia[0] * WORST_CONDITION <= moments_of_inertia[-1]:
        if not rotating.any():
            what = (
                "one node without rotations"
                if len(w) == 1
                else f"{len(w)} nodes without rotations on one line"
            )
            raise InputError(
                f"its group is {what}",
                source=source,
                key=key,
                expected="three nodes or more that are not on one line (a node of a solid has no rotation)",
            )
        length = float(np.linalg.norm(np.ptp(positions, axis=0))) or 1.0
        turning = np.where(rotating, w * length**2, 0.0)
        inertia = inertia + turning.sum() * np.eye(3)
    # columns: the moment about the centre of each of the six loads
    about_centre = np.hstack([np.cross(point - centre, np.eye(3)).T, np.eye(3)])
    rates = np.linalg.solve(inertia, about_centre)  # (3, 6)
    forces = w[:, None, None] * np.cross(rates.T[None], arms[:, None]).transpose(0, 2, 1)
    forces[:, :, :3] += w[:, None, None] * np.eye(3) / total
    return forces, turning[:, None, None] * rates
