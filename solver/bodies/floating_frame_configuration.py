"""Flexible bodies before time starts: poses, modes and velocities read and set as vectors of the whole scene.

These run in Python, a few hundred times at most. They serve floating frames and fixed
ones alike: what a frame that is not free has of its own are its modes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.bodies.floating_frame import (
    ACCELERATION,
    AT_END,
    DOF,
    LAG,
    MODAL,
    MODES,
    MOTION,
    NUMBER,
    ORIENTATION,
    POSITION,
    RATE,
    RATE2,
    S1,
    SHAPE,
    SHAPE_FIRST_MOMENT,
    SHAPE_INERTIA,
    SHAPE_MASS,
    SPIN,
    SPIN_RATE,
    STIFFNESS,
    TF1,
    VELOCITY,
    FixedFrameBodies,
    FlexibleBodies,
    FloatingFrameBodies,
    Q,
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


def _modes(kind: FlexibleBodies, body: int) -> slice:
    """Columns of the modal state."""
    first = int(kind.table[body, MODAL])
    return slice(first, first + int(kind.table[body, MODES]))


def _dofs(kind: FlexibleBodies, body: int) -> tuple[slice, slice]:
    """Places of the velocities of the frame and of the modes."""
    dof, n = int(kind.table[body, DOF]), int(kind.table[body, MODES])
    return slice(dof, dof + 6), slice(dof + 6, dof + 6 + n)


def _head(kind: FlexibleBodies, body: int) -> NDArray[np.float64]:
    """Mass, first moment and second moments of the packed shape."""
    n = int(kind.table[body, MODES])
    start = int(kind.table[body, SHAPE]) + 8 * n * n
    return kind.constants[start : start + SHAPE_INERTIA + 3]


@implement(survey, FloatingFrameBodies)
@implement(survey, FixedFrameBodies)
def survey_flexible_bodies(
    kind: FlexibleBodies,
    places: NDArray[np.float64],
    inertia: NDArray[np.float64],
    velocity: NDArray[np.float64],
) -> None:
    """Frame origin and axes; mass, undeformed inertia about the centre of mass, one for each mode."""
    for body in range(len(kind.table)):
        frame, head, number = kind.frame[body], _head(kind, body), kind.table[body, NUMBER]
        rigid, modal = _dofs(kind, body)
        places[number, 0] = kind.table[body, DOF]
        places[number, 1:] = frame[POSITION : ORIENTATION + 4]
        if kind.table[body, MOTION] == FREE:
            mass = head[SHAPE_MASS]
            centre = head[SHAPE_FIRST_MOMENT : SHAPE_FIRST_MOMENT + 3] / mass
            second = head[SHAPE_INERTIA : SHAPE_INERTIA + 3] - mass * centre**2
            inertia[rigid] = [mass] * 3 + list(second.sum() - second)
        inertia[modal] = 1.0
        velocity[rigid] = frame[[*range(VELOCITY, VELOCITY + 3), *range(SPIN, SPIN + 3)]]
        velocity[modal] = kind.modal[RATE, _modes(kind, body)]


@implement(move, FloatingFrameBodies)
@implement(move, FixedFrameBodies)
def move_flexible_bodies(kind: FlexibleBodies, increment: NDArray[np.float64]) -> None:
    """``x += d``, ``R := R exp(t)`` of free frames, ``q += e``."""
    from scipy.spatial.transform import Rotation

    for body in range(len(kind.table)):
        rigid, modal = _dofs(kind, body)
        kind.modal[Q, _modes(kind, body)] += increment[modal]
        kind.frame[body, AT_END] = 0.0
        if kind.table[body, MOTION] == FREE:
            shift = increment[rigid]
            kind.frame[body, POSITION : POSITION + 3] += shift[:3]
            scalar_last = [ORIENTATION + 1, ORIENTATION + 2, ORIENTATION + 3, ORIENTATION]
            before = Rotation.from_quat(kind.frame[body, scalar_last])
            kind.frame[body, scalar_last] = (before * Rotation.from_rotvec(shift[3:])).as_quat()


@implement(put_velocity, FloatingFrameBodies)
@implement(put_velocity, FixedFrameBodies)
def put_flexible_velocity(kind: FlexibleBodies, velocity: NDArray[np.float64]) -> None:
    """Of free frames, and of all modes."""
    for body in range(len(kind.table)):
        rigid, modal = _dofs(kind, body)
        own, frame = _modes(kind, body), kind.frame[body]
        kind.modal[RATE, own] = velocity[modal]
        kind.modal[RATE2, own] = 0.0
        frame[LAG : LAG + 6] = 0.0
        frame[AT_END] = 0.0
        if kind.table[body, MOTION] == FREE:
            given = velocity[rigid]
            frame[VELOCITY : VELOCITY + 3], frame[SPIN : SPIN + 3] = given[:3], given[3:]
            frame[ACCELERATION : ACCELERATION + 3] = frame[SPIN_RATE : SPIN_RATE + 3] = 0.0


@implement(collect_load, FloatingFrameBodies)
@implement(collect_load, FixedFrameBodies)
def collect_flexible_load(kind: FlexibleBodies, work: Workspace, load: NDArray[np.float64]) -> None:
    """``J^T f`` of the markers that forces act on, gravity on the frame and the modes, ``-k q``."""
    for number, body, _, _, serves in kind.markers:
        if serves == FORCES:
            rigid, modal = _dofs(kind, body)
            force = work.markers[number].force
            load[rigid.start : modal.stop] += force @ work.jacobian[number, :, : modal.stop - rigid.start]
    for body in range(len(kind.table)):
        rigid, modal = _dofs(kind, body)
        own, head = _modes(kind, body), _head(kind, body)
        g = work.sums.gravity
        inside = rotation_matrix(kind.frame[body, ORIENTATION : ORIENTATION + 4]).T @ g
        S, q = kind.modal[S1:TF1, own], kind.modal[Q, own]
        first_moment = head[SHAPE_FIRST_MOMENT : SHAPE_FIRST_MOMENT + 3] + S @ q
        load[rigid] += np.concatenate([head[SHAPE_MASS] * g, np.cross(first_moment, inside)])
        load[modal] += inside @ S - kind.modal[STIFFNESS, own] * q
