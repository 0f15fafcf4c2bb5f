"""Rigid bodies before time starts: poses and velocities read and set as vectors of the whole scene.

These run in Python, a few hundred times at most, on all bodies at once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.bodies.rigid import (
    RigidBodies,
)
from heavylift.solver.drive import FREE
from heavylift.solver.interface import (
    FORCES,
    Workspace,
    collect_load,
    move,
    put_velocity,
    survey,
)
from heavylift.solver.kinds import implement

__all__: list[str] = []


def _dofs(kind: RigidBodies) -> NDArray[np.int64]:
    """Places of the velocities, shape (bodies, 6)."""
    return kind.table["dof"][:, None] + np.arange(6)


@implement(survey, RigidBodies)
def survey_rigid_bodies(
    kind: RigidBodies,
    places: NDArray[np.float64],
    inertia: NDArray[np.float64],
    velocity: NDArray[np.float64],
) -> None:
    """Centre of mass and principal axes; masses and principal inertias."""
    frame, dofs, number = kind.frame, _dofs(kind), kind.table["number"]
    free = kind.table["motion"][:, None] == FREE
    places[number, 0] = kind.table["dof"]
    places[number, 1:] = frame["pose"]
    inertia[dofs[:, :3]] = np.where(free, frame["mass"][:, None], 0.0)
    inertia[dofs[:, 3:]] = np.where(free, frame["principal_inertia"], 0.0)
    velocity[dofs[:, :3]] = frame["velocity"]
    velocity[dofs[:, 3:]] = frame["spin"]


@implement(move, RigidBodies)
def move_rigid_bodies(kind: RigidBodies, increment: NDArray[np.float64]) -> None:
    """``x += d``, ``R := R exp(t)`` of free bodies."""
    from scipy.spatial.transform import Rotation

    free = np.flatnonzero(kind.table["motion"] == FREE)
    if not free.size:
        return
    shift = increment[_dofs(kind)[free]]
    kind.frame["position"][free] += shift[:, :3]
    before = Rotation.from_quat(kind.frame["orientation"][free], scalar_first=True)
    after = before * Rotation.from_rotvec(shift[:, 3:])
    kind.frame["orientation"][free] = after.as_quat(scalar_first=True)


@implement(put_velocity, RigidBodies)
def put_rigid_velocity(kind: RigidBodies, velocity: NDArray[np.float64]) -> None:
    """Of free bodies."""
    free = np.flatnonzero(kind.table["motion"] == FREE)
    given = velocity[_dofs(kind)[free]]
    kind.frame["twist"][free] = given
    kind.frame["acceleration"][free] = 0.0
    kind.frame["spin_rate"][free] = 0.0


@implement(collect_load, RigidBodies)
def collect_rigid_load(kind: RigidBodies, work: Workspace, load: NDArray[np.float64]) -> None:
    """``J^T f`` of the markers that forces act on, and ``m g``."""
    loaded = kind.markers[kind.markers["level"] == FORCES]
    dofs = _dofs(kind)
    force = work.markers["force"][loaded["number"]]
    np.add.at(
        load, dofs[loaded["body"]], np.einsum("mkj,mk->mj", work.jacobian[loaded["number"], :, :6], force)
    )
    load[dofs[:, :3]] += kind.frame["mass"][:, None] * work.sums.gravity
