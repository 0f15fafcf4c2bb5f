"""How frames move: their pose in a step, their velocities, what records say of them, what rows see and cost a drive."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.rotation import rotate_by_exponential, write_rotation_matrix
from heavylift.numerics.vectors import (
    Vector,
    add,
    add_scaled,
    cross,
    dot,
    rotate,
    scaled,
    subtract,
    vector,
    vector_at,
)
from heavylift.solver.bodies.frames.base import Frame, FrameBodies, FrameMotion
from heavylift.solver.drive import DRIVEN, FREE
from heavylift.solver.interface import Sums, Workspace, add_row_work, check, write_velocity
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.rows.impulses import row_power
from heavylift.solver.rows.structure import FACTORED, PRESCRIBED, RowArrays
from heavylift.solver.scene.bodies import FrameOutputs, HeldOutputs, PointOutputs

__all__ = [
    "add_momenta",
    "add_wrench",
    "advance_pose",
    "attached_body",
    "body_with",
    "check_frames",
    "columns_of",
    "combine_axes",
    "frame_outputs",
    "held_outputs",
    "orientation_of",
    "point_outputs",
    "pose_stage",
    "predict_pose",
    "write_frame_velocities",
    "write_motion",
    "write_point",
    "write_turn",
]


Axes = tuple[Vector, Vector, Vector]

point_outputs, frame_outputs = outputs_at(PointOutputs), outputs_at(FrameOutputs)
held_outputs = outputs_at(HeldOutputs)

NOT_FINITE, STEP_TOO_LARGE = int(Outcome.NOT_FINITE), int(Outcome.STEP_TOO_LARGE)


@kernel(inline=True, internal=True)
def orientation_of(frame: FrameMotion) -> tuple[float, float, float, float]:
    """Carried quaternion."""
    q = frame.orientation
    return q[0], q[1], q[2], q[3]


@kernel(inline=True, internal=True)
def columns_of(R: NDArray[np.float64]) -> Axes:
    """Columns of a rotation matrix: all of it is read, since the compiler must assume that what is written overlaps."""
    return (R[0], R[3], R[6]), (R[1], R[4], R[7]), (R[2], R[5], R[8])


@kernel(inline=True, internal=True)
def combine_axes(axes: Axes, u: Vector) -> Vector:
    """``R u``, from the columns of R."""
    return add_scaled(add_scaled(scaled(u[0], axes[0]), u[1], axes[1]), u[2], axes[2])


@kernel(inline=True, internal=True)
def write_turn(axes: Axes, u: Vector, window: NDArray[np.float64]) -> None:
    """``-R u~``, what a spin does to a vector of the body, into its three columns of a window."""
    a, b, c = axes
    by_x = subtract(scaled(u[1], c), scaled(u[2], b))
    by_y = subtract(scaled(u[2], a), scaled(u[0], c))
    by_z = subtract(scaled(u[0], b), scaled(u[1], a))
    for k in range(3):
        window[k, 3] = by_x[k]
        window[k, 4] = by_y[k]
        window[k, 5] = by_z[k]


@kernel(internal=True)
def pose_stage(frame: Frame) -> None:
    """Pose of the stage at the carried state."""
    write_rotation_matrix(orientation_of(frame), frame.mid_rotation)
    for k in range(3):
        frame.mid_position[k] = frame.position[k]


@kernel(internal=True)
def predict_pose(frame: Frame, step: float, curve: float) -> None:
    """Pose of the stage half a step ahead along an arc, which leaves the tangent by `curve` [s2] accelerations."""
    h, a = step, curve
    for k in range(3):
        frame.mid_position[k] = frame.position[k] + 0.5 * h * frame.velocity[k] + a * frame.acceleration[k]
    quaternion = rotate_by_exponential(
        orientation_of(frame),
        0.5 * h * frame.spin[0] + a * frame.spin_rate[0],
        0.5 * h * frame.spin[1] + a * frame.spin_rate[1],
        0.5 * h * frame.spin[2] + a * frame.spin_rate[2],
    )
    write_rotation_matrix(quaternion, frame.mid_rotation)


@kernel(internal=True)
def advance_pose(frame: Frame, velocity: NDArray[np.float64], step: float) -> None:
    """``x += h v``, ``R := R exp(h w)`` with six constant velocities."""
    h = step
    quaternion = rotate_by_exponential(
        orientation_of(frame), h * velocity[3], h * velocity[4], h * velocity[5]
    )
    for k in range(3):
        frame.position[k] += h * velocity[k]
    for k in range(4):
        frame.orientation[k] = quaternion[k]


@kernel(internal=True)
def add_wrench(frame: Frame, jacobian: NDArray[np.float64], offset: int, force: NDArray[np.float64]) -> None:
    """``J^T f`` of a marker, whose window has the velocities of the frame from `offset` on."""
    f1, f2, f3 = vector(force)
    for j in range(6):
        frame.wrench[j] += (
            jacobian[0, offset + j] * f1 + jacobian[1, offset + j] * f2 + jacobian[2, offset + j] * f3
        )


@implement(write_velocity, FrameBodies)
@kernel(internal=True)
def write_frame_velocities(kind: FrameBodies, work: Workspace) -> None:
    """World velocities of the origins, spins in body axes."""
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        for k in range(6):
            work.velocity[dof + k] = kind.frame[body].twist[k]


@implement(check, FrameBodies)
@kernel(internal=True)
def check_frames(kind: FrameBodies, step: float, work: Workspace) -> None:
    """Refuse what is not finite, and turns of free frames of more than `largest_turn` in a step."""
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        total = 0.0
        for i in range(dof, dof + 6):
            total += abs(work.velocity[i])
        spin = vector_at(work.velocity, dof + 3)
        turn = step * math.sqrt(dot(spin, spin))
        if not math.isfinite(total):
            work.status.outcome = NOT_FINITE
            work.status.body = kind.table[body].number
        elif kind.table[body].motion == FREE and turn > kind.largest_turn:
            work.status.outcome = STEP_TOO_LARGE
            work.status.body = kind.table[body].number


@kernel(internal=True)
def write_motion(frame: FrameMotion, out: FrameOutputs) -> None:
    """Position, quaternion, velocity and spin into a record."""
    for k in range(3):
        out.position[k] = frame.position[k]
        out.velocity[k] = frame.velocity[k]
        out.angular_velocity[k] = frame.spin[k]
    for k in range(4):
        out.orientation[k] = frame.orientation[k]


@kernel(internal=True)
def write_point(frame: Frame, place: Vector, rate: Vector, out: PointOutputs) -> None:
    """World position and velocity of a point, of which place and rate in body axes are known, into a record."""
    u, d = place, rate
    c = cross(frame.spin, u)
    point = rotate(frame.mid_rotation, u)
    moved = rotate(frame.mid_rotation, add(c, d))
    for k in range(3):
        out.position[k] = frame.position[k] + point[k]
        out.velocity[k] = frame.velocity[k] + moved[k]


@kernel(internal=True)
def add_momenta(frame: Frame, linear: Vector, angular: Vector, sums: Sums) -> None:
    """Momenta of a body, the angular one about the origin of its frame, and works into the totals; world axes."""
    p = linear
    x = cross(frame.position, p)
    for k in range(3):
        sums.linear_momentum[k] += p[k]
        sums.angular_momentum[k] += angular[k] + x[k]
    sums.external_work += frame.external_work
    sums.drive_work += frame.drive_work


# ---- rows ----


@kernel(inline=True, internal=True)
def body_with(kind: FrameBodies, dof: int) -> int:
    """Row of the body whose first velocity is `dof`, -1 if it is not of this kind."""
    low, high = 0, kind.table.shape[0] - 1
    while low < high:
        middle = (low + high + 1) // 2
        if kind.table[middle].dof <= dof:
            low = middle
        else:
            high = middle - 1
    return low if kind.table[low].dof == dof else -1


@kernel(internal=True)
def attached_body(kind: FrameBodies, system: RowArrays, attachment: int) -> int:
    """Row of the body that an attachment is on, -1 if that is not of this kind or has a diagonal mass."""
    holder = system.attachments[attachment].holder
    if holder != FACTORED and holder != PRESCRIBED:  # noqa: PLR1714  a set costs time here
        return -1
    return body_with(kind, system.attachments[attachment].dof)


@implement(add_row_work, FrameBodies)
@kernel(internal=True)
def add_row_work_of_frames(kind: FrameBodies, weight: float, work: Workspace, system: RowArrays) -> None:
    """A drive does the work that joints take out of its body."""
    if not kind.driven:
        return
    for i in range(system.attachments.shape[0]):
        body = attached_body(kind, system, i)
        if body >= 0 and kind.table[body].motion == DRIVEN:
            kind.frame[body].drive_work -= weight * row_power(system, i, work.velocity)
