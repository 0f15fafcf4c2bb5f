"""What modes leave out of the static answer to loads: the correction of mode acceleration.

With mode acceleration a displacement or stress is the static answer to the loads of the time, minus the answer of each
mode to its own inertia and damping (R. R. Craig, A. J. Kurdila, *Fundamentals of Structural Dynamics*). For unit modal
mass this is the modal superposition and, for each load with the history s_j(t),

    u = Phi q + sum_j s_j r_j,    r_j = K^-1 b_j - Phi Lambda^-1 Phi^T b_j,

without accelerations: r_j is what no combination of the modes can follow, and is zero where the static answer is one of
them. A body that is not held has the static answer of inertia relief.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.modal.flexibility import Flexibility

__all__ = ["StaticCorrection", "inertia_fields", "static_correction"]

_FOLLOWED = 1e-9  # of the strain energy of a load: left out by the modes through rounding
_EMPTY = 1e-20  # of the square of the largest load: loads that are balanced by the rigid motion they cause


@dataclass(frozen=True, eq=False)
class StaticCorrection:
    """Displacements that loads make besides those of the modes.

    Attributes
    ----------
    loads
        Numbers of the loads that have some, shape (k,).
    shapes
        Displacements and rotations by unit load, shape (N, k).
    energy
        Strain energy of each of these shapes [J by the square of the unit], shape (k,).
    missing
        Share of the strain energy of each load, of all that were asked for, that the modes do not have, shape (loads,).
    """

    loads: NDArray[np.int64]
    shapes: NDArray[np.float64]
    energy: NDArray[np.float64]
    missing: NDArray[np.float64]


def static_correction(
    flexibility: Flexibility,
    shapes: NDArray[np.float64],
    eigenvalues: NDArray[np.float64],
    forces: NDArray[np.float64],
) -> StaticCorrection:
    """Correction for unit loads.

    Parameters
    ----------
    flexibility
        Of the body as it was reduced: held where its modes are.
    shapes
        Mode shapes of unit modal mass [kg^-1/2], shape (N, nf).
    eigenvalues
        Diagonal of the modal stiffness [rad^2/s^2], shape (nf,).
    forces
        On all degrees of freedom, one column a load [N], shape (N, loads).
    """
    loads = np.column_stack([flexibility.equilibrated(column) for column in forces.T])
    still = np.sum(loads**2, axis=0) <= _EMPTY * max(
        float(np.sum(forces**2, axis=0).max(initial=0.0)), 1e-300
    )
    loads[:, still] = 0.0
    static = flexibility.solve(loads)
    static += flexibility.solve(loads - flexibility.model.stiffness @ static)
    energy = np.einsum("ij,ij->j", loads, static)
    modal = shapes.T @ loads / eigenvalues[:, np.newaxis]
    rest = static - shapes @ modal
    left = np.einsum("ij,ij->j", rest, flexibility.model.stiffness @ rest)
    missing = np.divide(left, energy, out=np.zeros_like(left), where=energy > 0.0)
    chosen = np.flatnonzero(missing > _FOLLOWED)
    return StaticCorrection(chosen, rest[:, chosen], 0.5 * left[chosen], np.maximum(missing, 0.0))


def inertia_fields(
    positions: NDArray[np.float64], *, free: bool
) -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """Accelerations of the points of a body by which its frame, and gravity, load it.

    Parameters
    ----------
    positions
        Of the points in the body frame [m], shape (n, 3).
    free
        Whether the body is not held: then fields that only accelerate it as a rigid body strain nothing.

    Returns
    -------
    tuple
        Names of the fields, and accelerations by unit amplitude, shape (n, 3, fields): of a held body ``"x"``, ``"y"``,
        ``"z"`` and the nine ``"xx"`` to ``"zz"``, acceleration along the first axis by the coordinate along the second;
        of a free one the six symmetric ones of these, ``"xy"`` with ``"yx"``.
    """
    axes = "xyz"
    n = len(positions)
    names: list[str] = []
    fields: list[NDArray[np.float64]] = []
    if not free:
        for k, axis in enumerate(axes):
            names.append(axis)
            fields.append(np.tile(np.eye(3)[k], (n, 1)))
    for i in range(3):
        for j in range(i if free else 0, 3):
            names.append(axes[i] + axes[j])
            field = np.zeros((n, 3))
            field[:, i] = positions[:, j]
            if free and i != j:
                field[:, j] = positions[:, i]
            fields.append(field)
    return tuple(names), np.stack(fields, axis=2)
