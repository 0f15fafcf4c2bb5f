"""Geometric stiffening of a reduced body: what its loads do to the stiffness of its modes.

Linear modes know no axial force. To first order it changes the stiffness of the modes by the geometric stiffness of the
stress of each load,

    K_eff = K + sum_k s_k G_k,    G_k = Phi^T K_g(sigma_k) Phi

with the stress sigma_k of the static answer to a unit load k, by inertia relief of a body that is free. With it the
second-order displacement of what bends, its shortening, is accounted for: a load does the work ``-1/2 q^T G q`` on it.
So the fields of inertia make corrections of the inertia integrals of the deformed body, which keep its momenta and its
energy what they are (T. R. Kane, R. R. Ryan and A. K. Banerjee, "Dynamics of a cantilever beam attached to a moving
base", J. Guidance 10, 1987, say what goes wrong without).

It holds while the stress follows the loads as at rest (frequencies of loads below a third of the lowest one) and
bending is small.
"""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["HERE", "PRODUCTS", "Stiffening"]

HERE = 1e-6
"""Of the size of a body: distance of a point from the place that it is."""

PRODUCTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Components of the symmetric matrices of second moments, in their order."""


@dataclass(frozen=True, eq=False)
class Stiffening:
    """Change of the modal stiffness by unit loads.

    Attributes
    ----------
    second_moments
        ``E_kl`` of the field ``M C x`` with C the symmetric unit matrix of 11 22 33 12 13 23, shape (6, nf, nf): the
        second moments of the deformed body are ``int x_k x_l dm - q^T E_kl q`` more than those of its linear
        displacements, and the field of an angular velocity w adds the stiffness ``w^2 tr E - sum w_k w_l E_kl``.
    angular
        Of the field of a unit angular acceleration of the frame, shape (3, nf, nf).
    linear
        Of the field of a unit acceleration of the frame [1/m], shape (3, nf, nf): accelerations minus gravity, in axes
        of the frame.
    places
        Where forces act whose stiffening is known [m], frame of the body, shape (np, 3).
    labels
        Names of unit loads there, length m.
    loads
        Of unit forces [1/(N s2)] and moments [1/(N m s2)] there, in axes of the frame, shape (m, nf, nf).
    generalised
        What each of these loads is to the undeformed body: force, moment about the origin, and forces on the modes,
        shape (m, 6 + nf).
    """

    second_moments: NDArray[np.float64]
    angular: NDArray[np.float64]
    linear: NDArray[np.float64]
    places: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 3)))
    labels: tuple[str, ...] = ()
    loads: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 0, 0)))
    generalised: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 0)))

    @property
    def trace(self) -> NDArray[np.float64]:
        """``E_11 + E_22 + E_33``, shape (nf, nf)."""
        total: NDArray[np.float64] = self.second_moments[:3].sum(axis=0)
        return total

    @property
    def largest_of_spin(self) -> float:
        """No less than the norm of the stiffness of a unit angular velocity about any axis."""
        axes = [float(np.linalg.norm(self.of_spin(axis), 2)) for axis in np.eye(3)]
        return max(axes) + 2.0 * max(float(np.linalg.norm(E, 2)) for E in self.second_moments[3:])

    def of_spin(self, w: NDArray[np.float64]) -> NDArray[np.float64]:
        """Stiffness [1/s2] of an angular velocity [rad/s] in axes of the frame, shape (nf, nf)."""
        total: NDArray[np.float64] = w @ w * self.trace
        for (k, l), E in zip(PRODUCTS, self.second_moments, strict=True):
            total = total - (1.0 if k == l else 2.0) * w[k] * w[l] * E
        return total
