"""Independent coordinates of a scene at a state: which velocities determine all others, and how.

Rows of rigid joints ``G U = g(t)`` leave some velocities free. Of all velocities U as many are chosen as states w
(coordinate partitioning: R. A. Wehage and E. J. Haug, J. Mechanical Design 104, 1982), and ``U = N w + U_0`` with
``G N = 0``: so states are coordinates of bodies, with their units.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.solver.linearise.motions import Motions
from heavylift.solver.start.rows import quoted

__all__ = ["Independent"]

DEPENDENT = 1e-9
"""Singular value of the unit rows, relative to the largest, below which rows depend on each other."""

PREFERRED = 1e6
"""Weight with which velocities of bodies that turn become dependent ones: axes that turn make no good coordinates."""

CLOSED = 1e-12
"""Gap relative to the size of the scene [m], or absolute [rad], with which a position counts as closed."""

ITERATIONS = 20


class Independent:
    """The choice at the present state, and positions and velocities that follow from it nearby.

    Parameters
    ----------
    motions
        What can move.
    turning
        Unknowns that should be dependent if possible, shape (count,).
    size
        Of the scene [m].

    Attributes
    ----------
    chosen
        Independent ones among all unknowns, shape (n,).
    dependent
        Those that follow from them, shape (r,).
    N
        Velocities of all unknowns by the independent ones, shape (count, n).
    """

    def __init__(self, motions: Motions, turning: NDArray[np.bool_], size: float) -> None:
        from scipy.linalg import qr

        self._motions, self._size = motions, size
        self._root = np.sqrt(motions.inertia)
        A, _ = self._unit_rows()
        rank, order = 0, np.arange(motions.count)
        if A.size:
            values = np.linalg.svd(A, compute_uv=False)
            rank = int(np.count_nonzero(values > DEPENDENT * max(values[0], 1e-300)))
            _, order = qr(A * np.where(turning, PREFERRED, 1.0), mode="r", pivoting=True)
        self.dependent, self.chosen = order[:rank], np.sort(order[rank:])
        self.N = np.zeros((motions.count, len(self.chosen)))
        self.N[self.chosen, np.arange(len(self.chosen))] = 1.0
        if rank and len(self.chosen):
            self.N[self.dependent] = self._solve(-A[:, self.chosen], A) * self._root[self.chosen]

    def _unit_rows(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Rigid rows over unknowns times the roots of their masses, of unit length; their lengths."""
        A = self._motions.rigid_rows() / self._root
        length = np.sqrt(np.sum(A * A, axis=1))
        length[length == 0.0] = 1.0
        return A / length[:, None], length

    def _solve(self, right: NDArray[np.float64], A: NDArray[np.float64]) -> NDArray[np.float64]:
        """Dependent velocities with which the unit rows have a value; rows that depend on others agree."""
        found = np.linalg.lstsq(A[:, self.dependent], right, rcond=DEPENDENT)[0]
        return np.asarray((found.T / self._root[self.dependent]).T)

    def close(self) -> None:
        """Close the joints by dependent coordinates alone.

        Raises
        ------
        InputError
            If they do not close, as beside a position in which a mechanism branches.
        """
        motions, last, goal = self._motions, np.inf, CLOSED * self._size
        for _ in range(ITERATIONS):
            A, length = self._unit_rows()
            gap = motions.gaps()
            worst = float(np.abs(gap).max(initial=0.0))
            if worst <= goal and (worst > 0.3 * last or worst <= 1e-3 * goal):
                return
            last = worst
            increment = np.zeros(motions.count)
            increment[self.dependent] = self._solve(-gap / length, A)
            motions.move(increment)
        raise InputError(
            f"beside this position {quoted(motions.worst())} do not close",
            source="linearisation",
            key="state",
            expected="a position in which the joints leave as many motions as beside it",
        )

    def put_velocity(self, w: NDArray[np.float64]) -> None:
        """Take independent velocities, and those that follow from them and from what drives prescribe.

        Parameters
        ----------
        w
            Shape (n,).
        """
        motions = self._motions
        U = motions.velocity
        U[self.chosen] = w
        U[self.dependent] = 0.0
        motions.put_velocity(U)
        if self.dependent.size:
            A, length = self._unit_rows()
            U[self.dependent] = self._solve(motions.missing_rates() / length, A)
            motions.put_velocity(U)
