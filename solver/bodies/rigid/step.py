"""Steps of rigid bodies: their stage, the second-order step in momentum form, the first-order scheme for comparison."""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.numerics.rotation import quaternion_product, rotate_by_quaternion
from heavylift.numerics.vectors import (
    Three,
    Vector,
    add,
    add_scaled,
    cross,
    rotate,
    rotate_back,
    scaled,
    vector,
    vector_at,
)
from heavylift.solver.bodies.frames.base import FrameMotion
from heavylift.solver.bodies.frames.motion import (
    add_wrench,
    advance_pose,
    columns_of,
    orientation_of,
    pose_stage,
    predict_pose,
    write_turn,
)
from heavylift.solver.bodies.rigid.kind import RigidBodies, RigidFrame, RigidFrames
from heavylift.solver.drive import DRIVEN, FIXED, FREE, drive_pose, drive_velocity
from heavylift.solver.interface import (
    ACCELERATIONS,
    RECORD,
    ROWS,
    Workspace,
    advance,
    end_velocity,
    estimate_error,
    factor,
    fill_markers,
    finish,
    forget_accelerations,
    predict,
    set_velocity,
    start,
    thesis_advance,
    thesis_velocity,
)
from heavylift.solver.kinds import implement

__all__ = [
    "axial_momentum_at_middle",
    "gather_marker_forces",
    "mean_velocity",
    "move_driven",
    "prescribe",
    "principal_momentum",
    "spatial_momentum",
    "stage_at_state",
    "start_rigid_bodies",
]


# ---- the stage: markers, gathered forces, prescribed motion ----


@kernel(inline=True, internal=True)
def principal_momentum(frame: RigidFrame, w: Three) -> Vector:
    """``I w`` of a spin, principal axes."""
    I = frame.principal_inertia
    return I[0] * w[0], I[1] * w[1], I[2] * w[2]


@kernel(inline=True, internal=True)
def spatial_momentum(frame: RigidFrame, w: Three) -> Vector:
    """``R I w`` of a spin at the carried orientation."""
    L = principal_momentum(frame, w)
    return rotate_by_quaternion(orientation_of(frame), L[0], L[1], L[2])


@kernel(internal=True)
def prescribe(kind: RigidFrames, body: int, time: float, out: FrameMotion) -> None:
    """Write the motion of the principal frame of a driven body."""
    drive = kind.constants[kind.table[body].drive :]
    pose, motion = kind.frame[body].drive_pose, kind.frame[body].drive_rates
    drive_pose(drive, time, pose)
    drive_velocity(drive, time, motion)
    frame = kind.frame[body]
    q = (pose[3], pose[4], pose[5], pose[6])
    axes = (frame.axes[0], frame.axes[1], frame.axes[2], frame.axes[3])
    back = (axes[0], -axes[1], -axes[2], -axes[3])
    c, w, b = vector(frame.centre), vector_at(motion, 3), vector_at(motion, 9)
    s = cross(w, c)
    a = add(cross(b, c), cross(w, s))
    arm = rotate_by_quaternion(q, c[0], c[1], c[2])
    side = rotate_by_quaternion(q, s[0], s[1], s[2])
    rate = rotate_by_quaternion(q, a[0], a[1], a[2])
    spin = rotate_by_quaternion(back, w[0], w[1], w[2])
    spin_rate = rotate_by_quaternion(back, b[0], b[1], b[2])
    turned = quaternion_product(q, axes)
    for k in range(4):
        out.orientation[k] = turned[k]
    for k in range(3):
        out.position[k] = pose[k] + arm[k]
        out.velocity[k] = motion[k] + side[k]
        out.spin[k] = spin[k]
        out.acceleration[k] = motion[6 + k] + rate[k]
        out.spin_rate[k] = spin_rate[k]


@implement(start, RigidFrames)
@kernel(internal=True)
def start_rigid_bodies(kind: RigidFrames, time: float, work: Workspace) -> None:
    """Place driven bodies; angular momenta of the start state; the constant part of the marker windows."""
    for marker in range(kind.markers.shape[0]):
        number, direction = kind.markers[marker].number, kind.markers[marker].direction
        for k in range(3):
            work.jacobian[number, k, k] = 0.0 if direction else 1.0
    for body in range(kind.table.shape[0]):
        if kind.table[body].motion == DRIVEN:
            prescribe(kind, body, time, kind.frame[body])
        frame = kind.frame[body]
        L = spatial_momentum(frame, frame.spin)
        for k in range(3):
            frame.angular_momentum[k] = L[k]


@kernel(internal=True)
def stage_at_state(kind: RigidFrames) -> None:
    """Set the stages to the carried state."""
    for body in range(kind.table.shape[0]):
        frame = kind.frame[body]
        pose_stage(frame)
        for k in range(3):
            frame.mid_velocity[k] = frame.velocity[k]
            frame.mid_spin[k] = frame.spin[k]


@implement(fill_markers, RigidFrames)
@kernel(internal=True)
def fill_rigid_markers(kind: RigidFrames, at_midpoint: bool, level: int, work: Workspace) -> None:
    """Vectors, and the windows ``[1, -R u~]``, whose first half is written once, by `start`."""
    if not at_midpoint:
        stage_at_state(kind)
    for marker in range(kind.markers.shape[0]):
        serves = kind.markers[marker].level
        if serves > level:
            break  # they are in this order
        number, body, begin = (
            kind.markers[marker].number,
            kind.markers[marker].body,
            kind.markers[marker].data,
        )
        direction = kind.markers[marker].direction
        frame, u = kind.frame[body], vector_at(kind.constants, begin)
        axes, translation = columns_of(frame.mid_rotation), 0.0 if direction else 1.0
        a, b, c = axes
        out = work.markers[number]
        point = scaled(translation, frame.mid_position)
        point = add_scaled(add_scaled(add_scaled(point, u[0], a), u[1], b), u[2], c)
        for k in range(3):
            out.point[k] = point[k]
        write_turn(axes, u, work.jacobian[number])
        if serves == ROWS and level < ACCELERATIONS:
            continue
        R, w = frame.mid_rotation, vector(frame.mid_spin)
        turned = cross(w, u)
        rate = rotate(R, turned)
        for k in range(3):
            out.velocity[k] = rate[k] + translation * frame.mid_velocity[k]
        if level == ACCELERATIONS:
            bias = rotate(R, cross(w, turned))
            for k in range(3):
                out.bias[k] = bias[k]


@kernel(internal=True)
def gather_marker_forces(kind: RigidFrames, work: Workspace) -> None:
    """Resultants (world axes) and moments about the centres of mass (body axes) of all marker forces."""
    for body in range(kind.table.shape[0]):
        for j in range(6):
            kind.frame[body].wrench[j] = 0.0
    for marker in range(kind.markers.shape[0] - 1, -1, -1):
        if kind.markers[marker].level == RECORD:
            continue
        if kind.markers[marker].level == ROWS:
            break  # they come first
        number, body = kind.markers[marker].number, kind.markers[marker].body
        add_wrench(kind.frame[body], work.jacobian[number], 0, work.markers[number].force)


@kernel(internal=True)
def mean_velocity(kind: RigidFrames, body: int, end: float, step: float) -> None:
    """Constant velocity and spin that lead a driven body from its pose to that at the end of the step."""
    frame = kind.frame[body]
    prescribe(kind, body, end, kind.frame[body].end)
    q = orientation_of(frame)
    after = (
        frame.end.orientation[0],
        frame.end.orientation[1],
        frame.end.orientation[2],
        frame.end.orientation[3],
    )
    c, s1, s2, s3 = quaternion_product((q[0], -q[1], -q[2], -q[3]), after)
    sine = math.sqrt(s1 * s1 + s2 * s2 + s3 * s3)
    # a turn of less than half a circle, of either sign of the quaternion; 2 atan(s/c)/s tends to 2/c
    scale = 2.0 * math.atan(sine / c) / sine if sine > 1e-8 else 2.0 / c
    frame.mean_twist[3], frame.mean_twist[4], frame.mean_twist[5] = (
        scale * s1 / step,
        scale * s2 / step,
        scale * s3 / step,
    )
    for k in range(3):
        frame.mean_twist[k] = (frame.end.position[k] - frame.position[k]) / step


@kernel(internal=True)
def move_driven(kind: RigidFrames, body: int, time: float, step: float, work: Workspace) -> None:
    """Move a driven body to its place at a time; the work of its drive is the change of momentum along the way."""
    frame = kind.frame[body]
    R = frame.mid_rotation
    v1, v2, v3 = frame.velocity[0], frame.velocity[1], frame.velocity[2]
    l1, l2, l3 = frame.angular_momentum[0], frame.angular_momentum[1], frame.angular_momentum[2]
    x1, x2, x3 = frame.position[0], frame.position[1], frame.position[2]
    spin_before = rotate_by_quaternion(orientation_of(frame), frame.spin[0], frame.spin[1], frame.spin[2])
    prescribe(kind, body, time, kind.frame[body])
    L = spatial_momentum(frame, frame.spin)
    spin_after = rotate_by_quaternion(orientation_of(frame), frame.spin[0], frame.spin[1], frame.spin[2])
    moment = rotate(R, frame.moment)
    before, moved = (v1, v2, v3), (frame.position[0] - x1, frame.position[1] - x2, frame.position[2] - x3)
    twist_before = (l1, l2, l3)
    done = external = 0.0
    for k in range(3):
        m = frame.mass
        turn = 0.5 * step * (spin_before[k] + spin_after[k])
        force_work = frame.force[k] * moved[k] + moment[k] * turn
        change = 0.5 * m * (frame.velocity[k] ** 2 - before[k] ** 2)
        change += 0.5 * (L[k] - twist_before[k]) * (spin_before[k] + spin_after[k])
        external += force_work
        done += change - force_work - m * work.sums.gravity[k] * moved[k]
        frame.angular_momentum[k] = L[k]
    frame.external_work += external
    frame.drive_work += done


# ---- the second-order step ----


@implement(predict, RigidFrames)
@kernel(internal=True)
def predict_rigid_bodies(kind: RigidFrames, time: float, step: float) -> None:
    """Arc midpoint and predicted midpoint velocities."""
    h = step
    for body in range(kind.table.shape[0]):
        frame = kind.frame[body]
        predict_pose(frame, h, frame.arc * h * h)
        for k in range(3):
            frame.mid_velocity[k] = frame.velocity[k] + 0.5 * h * frame.acceleration[k]
            frame.mid_spin[k] = frame.spin[k] + 0.5 * h * frame.spin_rate[k]
        if kind.table[body].motion == DRIVEN:
            mean_velocity(kind, body, time + h, h)


@kernel(inline=True, internal=True)
def axial_momentum_at_middle(frame: RigidFrame, w: Three, step: float) -> float:
    """Momentum of a slender body about its axis, in the middle of a step without moments, by a spin of the middle.

    The part of the spatial momentum along the axis is not it: where the predicted axis is off by an angle, the momentum
    across it has a part along it that is that angle times the ratio of the moments of inertia too large for the spin.
    """
    I = frame.principal_inertia
    return I[0] * frame.spin[0] + 0.5 * step * (I[1] - I[2]) * w[1] * w[2]


@implement(factor, RigidBodies)
@kernel(internal=True)
def factor_rigid_bodies(kind: RigidBodies, step: float, work: Workspace) -> None:
    """Midpoint velocity; the mass matrix is diagonal, so there is nothing to factor."""
    h = step
    gather_marker_forces(kind, work)
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        frame = kind.frame[body]
        if kind.table[body].motion == FREE:
            L = rotate_back(frame.mid_rotation, frame.angular_momentum)
            if frame.slender:
                L = axial_momentum_at_middle(frame, vector(frame.mid_spin), h), L[1], L[2]
            for k in range(3):
                work.velocity[dof + k] = frame.velocity[k] + 0.5 * h * (
                    frame.force[k] * frame.inverse_mass + work.sums.gravity[k]
                )
                work.velocity[dof + 3 + k] = (L[k] + 0.5 * h * frame.moment[k]) * frame.inverse_inertia[k]
        else:
            for k in range(6):  # rows see how a driven body moves over the step
                work.velocity[dof + k] = frame.mean_twist[k]


@kernel(internal=True)
def _put_axial_momentum(frame: RigidFrame, axial: float) -> None:
    """Replace the part of the angular momentum along the axis of a slender body."""
    q = orientation_of(frame)
    L = frame.angular_momentum
    across = rotate_by_quaternion((q[0], -q[1], -q[2], -q[3]), L[0], L[1], L[2])
    turned = rotate_by_quaternion(q, axial, across[1], across[2])
    for k in range(3):
        L[k] = turned[k]


@implement(advance, RigidFrames)
@kernel(internal=True)
def advance_rigid_bodies(kind: RigidFrames, time: float, step: float, work: Workspace) -> None:
    """Configuration and momenta to the end of the step, and the work of the marker forces."""
    h = step
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        frame = kind.frame[body]
        if kind.table[body].motion == DRIVEN:
            move_driven(kind, body, time + h, h, work)
            continue
        if kind.table[body].motion == FIXED:
            continue
        velocity = work.velocity[dof : dof + 6]
        L = rotate(frame.mid_rotation, principal_momentum(frame, vector_at(velocity, 3)))
        external = 0.0
        for k in range(3):
            external += frame.force[k] * velocity[k] + frame.moment[k] * velocity[3 + k]
            end = 2.0 * velocity[k] - frame.velocity[k]
            frame.acceleration[k] = (end - frame.velocity[k]) / h
            frame.velocity[k] = end
            frame.angular_momentum[k] = 2.0 * L[k] - frame.angular_momentum[k]
        frame.external_work += h * external
        advance_pose(frame, velocity, h)
        if frame.slender:
            _put_axial_momentum(frame, frame.principal_inertia[0] * (2.0 * velocity[3] - frame.spin[0]))


@implement(end_velocity, RigidFrames)
@kernel(internal=True)
def end_velocity_rigid_bodies(kind: RigidFrames, step: float, work: Workspace) -> None:
    """End velocities from the momenta; prescribed ones as they are."""
    for body in range(kind.table.shape[0]):
        frame = kind.frame[body]
        dof = kind.table[body].dof
        free = kind.table[body].motion == FREE
        q = orientation_of(frame)
        w = rotate_by_quaternion(
            (q[0], -q[1], -q[2], -q[3]),
            frame.angular_momentum[0],
            frame.angular_momentum[1],
            frame.angular_momentum[2],
        )
        for k in range(3):
            work.velocity[dof + k] = frame.velocity[k]
            work.velocity[dof + 3 + k] = w[k] * frame.inverse_inertia[k] if free else frame.spin[k]


@implement(set_velocity, RigidFrames)
@kernel(internal=True)
def set_velocity_rigid_bodies(kind: RigidFrames, step: float, work: Workspace) -> None:
    """Projected velocities, ``L = R I w``."""
    for body in range(kind.table.shape[0]):
        if kind.table[body].motion != FREE:
            continue
        frame = kind.frame[body]
        dof = kind.table[body].dof
        L = spatial_momentum(frame, vector_at(work.velocity, dof + 3))
        for k in range(3):
            frame.acceleration[k] += (work.velocity[dof + k] - frame.velocity[k]) / step
            frame.velocity[k] = work.velocity[dof + k]
            frame.angular_momentum[k] = L[k]


@implement(estimate_error, RigidFrames)
@kernel(internal=True)
def estimate_rigid_error(kind: RigidFrames, step: float, work: Workspace) -> None:
    """Distance of the midpoint velocity from its prediction, as a displacement [m] over the step."""
    for body in range(kind.table.shape[0]):
        if kind.table[body].motion != FREE:
            continue
        frame = kind.frame[body]
        dof = kind.table[body].dof
        moved = turned = 0.0
        for k in range(3):
            moved += (work.velocity[dof + k] - frame.mid_velocity[k]) ** 2
            turned += (work.velocity[dof + 3 + k] - frame.mid_spin[k]) ** 2
        error = step * max(math.sqrt(moved), frame.reach * math.sqrt(turned))
        if not error <= work.control.error:
            work.control.error = error
            work.status.body = kind.table[body].number


@implement(finish, RigidFrames)
@kernel(internal=True)
def finish_rigid_bodies(kind: RigidFrames, step: float, work: Workspace) -> None:
    """Spin from the angular momentum at the new orientation."""
    for body in range(kind.table.shape[0]):
        if kind.table[body].motion != FREE:
            continue
        frame = kind.frame[body]
        q = orientation_of(frame)
        back = (q[0], -q[1], -q[2], -q[3])
        L = rotate_by_quaternion(
            back, frame.angular_momentum[0], frame.angular_momentum[1], frame.angular_momentum[2]
        )
        for k in range(3):
            w = L[k] * frame.inverse_inertia[k]
            frame.spin_rate[k] = (w - frame.spin[k]) / step
            frame.spin[k] = w


# ---- the first-order scheme ----


@implement(thesis_velocity, RigidBodies)
@kernel(internal=True)
def thesis_velocity_rigid_bodies(kind: RigidBodies, time: float, step: float, work: Workspace) -> None:
    """Eq. 49 of the 2018 thesis without joints: ``U+ = U + h M^-1 Q``, gyroscopic torque at the start."""
    h = step
    stage_at_state(kind)
    gather_marker_forces(kind, work)
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        frame = kind.frame[body]
        if kind.table[body].motion != FREE:
            for k in range(6):
                work.velocity[dof + k] = 0.0
            continue
        gyroscopic = cross(frame.spin, principal_momentum(frame, frame.spin))
        for k in range(3):
            work.velocity[dof + k] = frame.velocity[k] + h * (
                frame.force[k] * frame.inverse_mass + work.sums.gravity[k]
            )
            work.velocity[dof + 3 + k] = (
                frame.spin[k] + h * (frame.moment[k] - gyroscopic[k]) / frame.principal_inertia[k]
            )


@implement(thesis_advance, RigidBodies)
@kernel(internal=True)
def thesis_advance_rigid_bodies(kind: RigidBodies, time: float, step: float, work: Workspace) -> None:
    """Configuration by the end velocity."""
    h = step
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        frame = kind.frame[body]
        if kind.table[body].motion == DRIVEN:
            move_driven(kind, body, time + h, h, work)
        if kind.table[body].motion != FREE:
            continue
        velocity = work.velocity[dof : dof + 6]
        external = 0.0
        for k in range(3):
            external += frame.force[k] * velocity[k] + frame.moment[k] * velocity[3 + k]
            frame.velocity[k] = velocity[k]
            frame.spin[k] = velocity[3 + k]
        frame.external_work += h * external
        advance_pose(frame, velocity, h)


# ---- impacts ----


@implement(forget_accelerations, RigidFrames)
@kernel(internal=True)
def forget_rigid_accelerations(kind: RigidFrames) -> None:
    """Of the frame; that of its spin is Euler's of a body without moments, which the middle of the next step needs."""
    for body in range(kind.table.shape[0]):
        if kind.table[body].motion != FREE:
            continue
        frame = kind.frame[body]
        w1, w2, w3 = frame.spin[0], frame.spin[1], frame.spin[2]
        i1, i2, i3 = frame.principal_inertia[0], frame.principal_inertia[1], frame.principal_inertia[2]
        for k in range(3):
            frame.acceleration[k] = 0.0
        frame.spin_rate[0] = (i2 - i3) / i1 * w2 * w3
        frame.spin_rate[1] = (i3 - i1) / i2 * w3 * w1
        frame.spin_rate[2] = (i1 - i2) / i3 * w1 * w2
