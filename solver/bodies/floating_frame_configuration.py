"""Flexible bodies before time starts: poses, modes and velocities read and set as vectors of the whole scene.

These run in Python, a few hundred times at most. They serve floating frames and fixed
ones alike: what a frame that is not free has of its own are its modes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.bodies.floating_frame import (
    FloatingFrameBodies,
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


def _modes(kind: FloatingFrameBodies, body: int) -> slice:
    """Columns of the modal state."""
    first = int(kind.table[body].first_mode)
    return slice(first, first + int(kind.table[body].mode_count))


def _dofs(kind: FloatingFrameBodies, body: int) -> tuple[slice, slice]:
    """Places of the velocities of the frame and of the modes."""
    dof, n = int(kind.table[body].dof), int(kind.table[body].mode_count)
    return slice(dof, dof + 6), slice(dof + 6, dof + 6 + n)


@implement(survey, FloatingFrameBodies)
def survey_flexible_bodies(
    kind: FloatingFrameBodies,
    places: NDArray[np.float64],
    inertia: NDArray[np.float64],
    velocity: NDArray[np.float64],
) -> None:
    """Frame origin and axes; mass, undeformed inertia about the centre of mass, one for each mode."""
    for body in range(len(kind.table)):
        frame, number = kind.frame[body], kind.table[body].number
        rigid, modal = _dofs(kind, body)
        places[number, 0] = kind.table[body].dof
        places[number, 1:] = [*frame.position, *frame.orientation]
        if kind.table[body].motion == FREE:
            centre = frame.undeformed_first_moment / frame.mass
            second = frame.undeformed_second_moments[:3] - frame.mass * centre**2
            inertia[rigid] = [frame.mass] * 3 + list(second.sum() - second)
        inertia[modal] = 1.0
        velocity[rigid] = [*frame.velocity, *frame.spin]
        velocity[modal] = kind.modal_velocity[_modes(kind, body)]


@implement(move, FloatingFrameBodies)
def move_flexible_bodies(kind: FloatingFrameBodies, increment: NDArray[np.float64]) -> None:
    """``x += d``, ``R := R exp(t)`` of free frames, ``q += e``."""
    from scipy.spatial.transform import Rotation

    for body in range(len(kind.table)):
        rigid, modal = _dofs(kind, body)
        kind.modal_position[_modes(kind, body)] += increment[modal]
        frame = kind.frame[body]
        frame.at_end = False
        if kind.table[body].motion == FREE:
            shift = increment[rigid]
            frame.position[:] += shift[:3]
            turned = Rotation.from_quat(np.roll(frame.orientation, -1)) * Rotation.from_rotvec(shift[3:])
            frame.orientation[:] = np.roll(turned.as_quat(), 1)


@implement(put_velocity, FloatingFrameBodies)
def put_flexible_velocity(kind: FloatingFrameBodies, velocity: NDArray[np.float64]) -> None:
    """Of free frames, and of all modes."""
    for body in range(len(kind.table)):
        rigid, modal = _dofs(kind, body)
        own, frame = _modes(kind, body), kind.frame[body]
        kind.modal_velocity[own] = velocity[modal]
        kind.modal_acceleration[own] = 0.0
        frame.lag[:] = 0.0
        frame.at_end = False
        if kind.table[body].motion == FREE:
            given = velocity[rigid]
            frame.velocity[:], frame.spin[:] = given[:3], given[3:]
            frame.acceleration[:] = frame.spin_rate[:] = 0.0


@implement(collect_load, FloatingFrameBodies)
def collect_flexible_load(kind: FloatingFrameBodies, work: Workspace, load: NDArray[np.float64]) -> None:
    """``J^T f`` of the markers that forces act on, gravity on the frame and the modes, ``-k q``."""
    for marker in kind.markers:
        if marker.level == FORCES:
            number, body = marker.number, marker.body
            rigid, modal = _dofs(kind, body)
            force = work.markers[number].force
            load[rigid.start : modal.stop] += force @ work.jacobian[number, :, : modal.stop - rigid.start]
    for body in range(len(kind.table)):
        rigid, modal = _dofs(kind, body)
        own, frame = _modes(kind, body), kind.frame[body]
        g = work.sums.gravity
        inside = rotation_matrix(frame.orientation).T @ g
        S, q = kind.translation[:, own], kind.modal_position[own]
        first_moment = frame.undeformed_first_moment + S @ q
        load[rigid] += np.concatenate([frame.mass * g, np.cross(first_moment, inside)])
        load[modal] += inside @ S - kind.stiffness[own] * q
