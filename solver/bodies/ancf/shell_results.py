"""Stresses of shells at their nodes, for pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.solver.bodies.ancf.shell_data import NODE_PLACES
from heavylift.solver.bodies.ancf.shell_stress import shell_stresses

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.meshes import ShellBody

__all__ = ["nodal_stresses"]


def nodal_stresses(body: ShellBody, coordinates: NDArray[np.float64]) -> NDArray[np.float64]:
    """Equivalent stresses at the nodes [Pa], means over their elements; shape (n, 3): top, middle, bottom.

    Parameters
    ----------
    body
        The shell: its unloaded shape and sections count.
    coordinates
        ``r`` [m], ``r_x``, ``r_y`` [1] and ``r_xy`` [1/m] of the nodes in any axes, shape (n, 4, 3).
    """
    stresses = shell_stresses(body, coordinates, (0.0, 1.0), (0.0, 1.0))
    out, shared = np.zeros((len(body.nodes), 3)), np.zeros(len(body.nodes))
    x, y = np.array(NODE_PLACES).T
    np.add.at(shared, body.elements, 1.0)
    for column, side in enumerate(("top", "middle", "bottom")):
        corners = stresses.von_mises(side)[:, x, y]  # type: ignore[arg-type]
        np.add.at(out[:, column], body.elements, corners)
    return out / shared[:, np.newaxis]
