"""What nothing holds: motions of the bodies as rigid ones that supports, joints and springs leave free.

Bodies that deform resist every motion but these, so a static problem is determined where there are none.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.start.motion_words import motion_words
from heavylift.solver.statics.mesh_system import MeshSystem

__all__ = ["FreeMotions", "find_free_motions"]

HELD = 1e-7
"""Singular value of rows in units of length below which a motion is free."""

LOADED = 1e-9
"""Work of the loads along a motion relative to their size that counts."""


@dataclass(frozen=True)
class FreeMotions:
    """Motions that nothing holds.

    Attributes
    ----------
    count
        How many are independent.
    text
        What can move how; empty if nothing can.
    sinking
        The same of translations that the loads drive: there is no equilibrium.
    """

    count: int
    text: str
    sinking: str


def find_free_motions(system: MeshSystem) -> FreeMotions:
    """Look for motions without resistance at the present position.

    Parameters
    ----------
    system
        The scene.
    """
    places = system.rows.survey()[0]
    motions, fixed, parameters = _rigid_motions(system, places)
    if not motions.shape[1]:
        return FreeMotions(0, "", "")
    parts = [fixed, _unit(system.all_rows() @ motions)]
    if system.has_springs:
        parts.append(_unit(system.between(0.0) @ (system.T @ motions)))
    A = np.vstack(parts)
    _, sigma, vt = np.linalg.svd(np.vstack([A, np.zeros((1, A.shape[1]))]), full_matrices=True)
    held = int(np.count_nonzero(sigma > HELD * max(1.0, sigma.max(initial=0.0))))
    null = vt[held:].T
    if not null.shape[1]:
        return FreeMotions(0, "", "")
    free = parameters @ null
    spins = np.concatenate([free[6 * body + 3 : 6 * body + 6] for body in range(len(places))])
    _, turning, ut = np.linalg.svd(np.vstack([spins, np.zeros((1, spins.shape[1]))]), full_matrices=True)
    slides = null @ ut[int(np.count_nonzero(turning > HELD)) :].T
    load = system.external_force()
    work = np.abs(load @ motions @ slides) if slides.shape[1] else np.zeros(0)
    size = float(np.abs(load[system.positions]).sum())
    sinking = ""
    if np.any(work > LOADED * size):
        sinking = _words(system, places, parameters @ null)
    return FreeMotions(null.shape[1], _words(system, places, free), sinking)


def _unit(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rows of unit length; those that are zero stay."""
    norm = np.linalg.norm(rows, axis=1)
    small = 1e-12 * norm.max(initial=0.0)
    return rows[norm > small] / norm[norm > small, None]


def _rigid_motions(
    system: MeshSystem, places: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Independent rigid motions of all bodies.

    Returns
    -------
    motions
        Of the unknowns, shape (count, n).
    fixed
        Of the coordinates that are held, in units of the size of their body, shape (m, n).
    parameters
        Velocity of the point and spin of each body as in `survey`, shape (6 bodies, n).
    """
    bodies = len(places)
    motions, fixed, parameters = [], [], []
    for number, (kind, matrices, first) in system.body_unknowns().items():
        row = int(np.flatnonzero(kind.table["number"] == number)[0])
        line, numbers = kind.table[row], kind.body[row]
        size = float(numbers.size)
        R = numbers.rotation
        centre = R.T @ (places[number, 1:4] - numbers.origin)
        turn = rotation_matrix(places[number, 4:])
        nodes = np.arange(line.first_node, line.first_node + line.node_count) * matrices.lanes
        slots = (nodes[:, None] + 3 * np.arange(matrices.vectors)).ravel()
        vectors = kind.position[slots[:, None] + np.arange(3)]
        is_position = np.tile(np.arange(matrices.vectors) == 0, len(nodes))
        every = np.zeros((kind.position.shape[0], 6))
        at = slots[:, None] + np.arange(3)
        for j in range(6):
            given = np.zeros(3)
            given[j % 3] = 1.0 if j < 3 else 1.0 / size
            if j < 3:
                change = np.where(is_position[:, None], R.T @ given, 0.0)
            else:
                spin = R.T @ turn @ given
                change = np.cross(spin, vectors - np.where(is_position[:, None], centre, 0.0))
            every[at, j] = change
        own = np.zeros((system.count, 6))
        own[first : first + len(matrices.places)] = every[matrices.places]
        own[first : first + len(matrices.places)][matrices.body != row] = 0.0
        held = every[at.ravel()[kind.free[at.ravel()] == 0.0]]
        _, sigma, vt = np.linalg.svd(np.vstack([own, held]), full_matrices=False)
        basis = vt[sigma > HELD * sigma.max(initial=0.0)].T
        motions.append(own @ basis)
        fixed.append(held @ basis)
        scaled = np.zeros((6 * bodies, basis.shape[1]))
        scaled[6 * number : 6 * number + 6] = basis / np.array([1.0, 1.0, 1.0, size, size, size])[:, None]
        parameters.append(scaled)
    rows = system.rows
    for number in range(bodies):
        dofs = np.flatnonzero(rows.owner[system.dofs] == number)
        begin = rows.owner_starts[np.searchsorted(rows.owner_starts, system.dofs[dofs], side="right") - 1]
        which = system.dofs[dofs] - begin
        for dof, j in zip(dofs[which < 6], which[which < 6], strict=True):
            scale = 1.0 if j < 3 else 1.0 / system.length
            own, given = np.zeros((system.count, 1)), np.zeros((6 * bodies, 1))
            own[system.first[-1] + dof], given[6 * number + j] = scale, scale
            motions.append(own)
            parameters.append(given)
            fixed.append(np.zeros((0, 1)))
    if not motions:
        return np.zeros((system.count, 0)), np.zeros((0, 0)), np.zeros((6 * bodies, 0))
    from scipy.linalg import block_diag

    return np.hstack(motions), block_diag(*fixed), np.hstack(parameters)


def _words(system: MeshSystem, places: NDArray[np.float64], free: NDArray[np.float64]) -> str:
    """What each body can do."""
    names = system.layout.body_names
    found = []
    for number, place in enumerate(places):
        own = free[6 * number : 6 * number + 6]
        weights = np.array([1.0, 1.0, 1.0, system.length, system.length, system.length])
        u, sigma, _ = np.linalg.svd(own * weights[:, None], full_matrices=False)
        basis = u[:, sigma > 1e-6] / weights[:, None]
        if basis.shape[1]:
            found.append(f"'{names[number]}' can {motion_words(place, basis)}")
    together = " together" if len(found) > 1 else ""
    return ", ".join(found[:6]) + (" and so on" if len(found) > 6 else "") + together
