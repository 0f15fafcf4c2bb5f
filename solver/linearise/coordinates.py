"""Independent coordinates of a scene at a state: which velocities determine all others, and how.

Rows of rigid joints ``G U = g(t)`` leave some velocities free. Of all velocities U as many are chosen as states w
(coordinate partitioning: R. A. Wehage and E. J. Haug, J. Mechanical Design 104, 1982), and ``U = N w + U_0`` with
``G N = 0``: so states are coordinates of bodies, with their units.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.solver.start.rows import StartRows, quoted

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
    rows
        The scene; its rows are filled.
    turning
        Velocities that should be dependent if possible, shape (dof_count,).
    size
        Of the scene [m].

    Attributes
    ----------
    chosen
        Places of the independent velocities among all, shape (n,).
    dependent
        Of those that follow from them, shape (r,).
    N
        All velocities by the independent ones, shape (dof_count, n); rows of zeros for what is prescribed.
    rank, row_count
        Of the rigid rows.
    """

    def __init__(self, rows: StartRows, turning: NDArray[np.bool_], size: float) -> None:
        from scipy.linalg import qr

        self._rows, self._size = rows, size
        rows.fill()
        free = rows.free
        self._root = np.sqrt(np.where(rows.inertia > 0.0, rows.inertia, 1.0))
        A, _ = self._unit_rows()
        A = A[:, free]
        rank, order = 0, np.arange(len(free))
        if A.size:
            values = np.linalg.svd(A, compute_uv=False)
            rank = int(np.count_nonzero(values > DEPENDENT * max(values[0], 1e-300)))
            _, order = qr(A * np.where(turning[free], PREFERRED, 1.0), mode="r", pivoting=True)
        self.dependent, self.chosen = free[order[:rank]], np.sort(free[order[rank:]])
        self.rank, self.row_count = rank, len(A)
        self.N = np.zeros((len(rows.inertia), len(self.chosen)))
        self.N[self.chosen, np.arange(len(self.chosen))] = 1.0
        if rank and len(self.chosen):
            by = self._solve(-self._unit_rows()[0][:, self.chosen])
            self.N[self.dependent] = by * self._root[self.chosen]

    def _unit_rows(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Rigid rows over all velocities times the roots of their masses, of unit length; and their lengths."""
        rows = self._rows
        G = rows.matrix()
        G = np.asarray(G if isinstance(G, np.ndarray) else G.toarray())[rows.rigid]
        G[:, rows.inertia == 0.0] = 0.0
        A = G / self._root
        length = np.sqrt(np.sum(A * A, axis=1))
        length[length == 0.0] = 1.0
        return A / length[:, None], length

    def _solve(self, right: NDArray[np.float64]) -> NDArray[np.float64]:
        """Dependent velocities with which the unit rows have a value; rows that depend on others agree."""
        A, _ = self._unit_rows()
        found = np.linalg.lstsq(A[:, self.dependent], right, rcond=DEPENDENT)[0]
        return np.asarray((found.T / self._root[self.dependent]).T)

    def close(self) -> None:
        """Close the joints by dependent coordinates alone.

        Raises
        ------
        InputError
            If they do not close, as beside a position in which a mechanism branches.
        """
        rows = self._rows
        last = np.inf
        for _ in range(ITERATIONS):
            rows.fill()
            gap = rows.residual[rows.rigid]
            worst = float(np.abs(gap).max(initial=0.0))
            goal = CLOSED * self._size
            if worst <= goal and (worst > 0.3 * last or worst <= 1e-3 * goal):
                return
            last = worst
            increment = np.zeros(len(rows.inertia))
            increment[self.dependent] = self._solve(-gap / self._unit_rows()[1])
            rows.move(increment)
        names = rows.worst(rows.residual, rows.rigid)
        raise InputError(
            f"beside this position {quoted([rows.names[rows.block[row]] for row in names])} do not close",
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
        rows = self._rows
        U = rows.survey()[2]
        U[self.chosen] = w
        if self.rank:
            rows.fill()
            U[self.dependent] = 0.0
            G = rows.matrix()
            G = np.asarray(G if isinstance(G, np.ndarray) else G.toarray())[rows.rigid]
            wanted = rows.column("target")[rows.rigid] - G @ U
            U[self.dependent] = self._solve(wanted / self._unit_rows()[1])
        rows.put_velocity(U)
