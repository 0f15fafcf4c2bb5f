"""Rigid bodies before time starts: poses and velocities read and set as vectors of the whole scene.

These run in Python, a few hundred times at most, on all bodies at once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.bodies.rigid import (
    ACCELERATION,
    DOF,
    MASS,
    MOTION,
    NUMBER,
    ORIENTATION,
    POSITION,
    PRINCIPAL,
    SPIN,
    SPIN_RATE,
    VELOCITY,
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
    return kind.table[:, DOF, None] + np.arange(6)


@implement(survey, RigidBodies)
def survey_rigid_bodies(
    kind: RigidBodies,
    places: NDArray[np.float64],
    inertia: NDArray[np.float64],
    velocity: NDArray[np.float64],
) -> None:
    """Centre of mass and principal axes; masses and principal inertias."""
    frame, dofs, number = kind.frame, _dofs(kind), kind.table[:, NUMBER]
    free = kind.table[:, MOTION, None] == FREE
    places[number, 0] = kind.table[:, DOF]
    places[number, 1:] = frame[:, POSITION : ORIENTATION + 4]
    inertia[dofs[:, :3]] = np.where(free, frame[:, MASS, None], 0.0)
    inertia[dofs[:, 3:]] = np.where(free, frame[:, PRINCIPAL : PRINCIPAL + 3], 0.0)
    velocity[dofs[:, :3]] = frame[:, VELOCITY : VELOCITY + 3]
    velocity[dofs[:, 3:]] = frame[:, SPIN : SPIN + 3]


@implement(move, RigidBodies)
def move_rigid_bodies(kind: RigidBodies, increment: NDArray[np.float64]) -> None:
    """``x += d``, ``R := R exp(t)`` of free bodies."""
    from scipy.spatial.transform import Rotation

    free = np.flatnonzero(kind.table[:, MOTION] == FREE)
    if not free.size:
        return
    shift = increment[_dofs(kind)[free]]
    kind.frame[free, POSITION : POSITION + 3] += shift[:, :3]
    scalar_last = np.array([ORIENTATION + 1, ORIENTATION + 2, ORIENTATION + 3, ORIENTATION])
    before = Rotation.from_quat(kind.frame[free[:, None], scalar_last])
    kind.frame[free[:, None], scalar_last] = (before * Rotation.from_rotvec(shift[:, 3:])).as_quat()


@implement(put_velocity, RigidBodies)
def put_rigid_velocity(kind: RigidBodies, velocity: NDArray[np.float64]) -> None:
    """Of free bodies."""
    free = np.flatnonzero(kind.table[:, MOTION] == FREE)
    given = velocity[_dofs(kind)[free]]
    kind.frame[free, VELOCITY : VELOCITY + 3] = given[:, :3]
    kind.frame[free, SPIN : SPIN + 3] = given[:, 3:]
    kind.frame[free, ACCELERATION : ACCELERATION + 3] = 0.0
    kind.frame[free, SPIN_RATE : SPIN_RATE + 3] = 0.0


@implement(collect_load, RigidBodies)
def collect_rigid_load(kind: RigidBodies, work: Workspace, load: NDArray[np.float64]) -> None:
    """``J^T f`` of the markers that forces act on, and ``m g``."""
    loaded = kind.markers[kind.markers[:, 4] == FORCES]
    dofs = _dofs(kind)
    force = work.markers["force"][loaded[:, 0]]
    np.add.at(load, dofs[loaded[:, 1]], np.einsum("mkj,mk->mj", work.jacobian[loaded[:, 0], :, :6], force))
    load[dofs[:, :3]] += kind.frame[:, MASS, None] * work.sums.gravity
