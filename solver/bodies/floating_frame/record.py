"""State, reactions, sensors, energies and momenta of floating-frame bodies, at the ends of steps."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import add, cross, rotate, rotate_back, scaled, subtract, vector, vector_at
from heavylift.solver.bodies.floating_frame.fixed_frame import add_totals_of_fixed, place_fixed, record_fixed
from heavylift.solver.bodies.floating_frame.inertia import (
    body_momenta,
    frame_velocity_forces,
    inertia_product,
    quadratic_modal_force,
)
from heavylift.solver.bodies.floating_frame.kind import (
    FloatingFrameBodies,
    shape_of,
)
from heavylift.solver.bodies.floating_frame.stage import (
    add_joint_forces,
    drive_frame,
    gather_marker_forces,
    stage_at_state,
    write_sensor,
)
from heavylift.solver.bodies.floating_frame.step import momentum_about_axis
from heavylift.solver.bodies.floating_frame.stiffening import (
    add_acceleration_forces,
    add_load_forces,
    add_quadratic_forces,
    with_shortening,
)
from heavylift.solver.bodies.frames.motion import add_momenta, frame_outputs, held_outputs, write_motion
from heavylift.solver.drive import DRIVEN, FIXED, FREE, drive_velocity
from heavylift.solver.interface import (
    Workspace,
    add_totals,
    record,
    start,
)
from heavylift.solver.kinds import implement
from heavylift.solver.recording import part
from heavylift.solver.scene.bodies import HeldOutputs

__all__: list[str] = []


@implement(start, FloatingFrameBodies)
@kernel(internal=True)
def start_floating_frames(kind: FloatingFrameBodies, time: float, work: Workspace) -> None:
    """Place driven frames, evaluate products and momenta of the start state."""
    for body in range(kind.table.shape[0]):
        n, first = kind.table[body].mode_count, kind.table[body].first_mode
        frame = kind.frame[body]
        if kind.table[body].motion == FIXED:
            place_fixed(kind, body)
            continue
        if kind.table[body].motion == DRIVEN:
            drive_frame(kind, body, time)
            drive_velocity(kind.constants[kind.table[body].drive :], time, frame.drive_rates)
            for k in range(3):
                frame.velocity[k] = frame.drive_rates[k]
                frame.spin[k] = frame.drive_rates[3 + k]
        stage_at_state(kind, body, True)
        R = frame.mid_rotation
        v = rotate_back(R, frame.velocity)
        w = (frame.spin[0], frame.spin[1], frame.spin[2])
        modes = slice(first, first + n)
        p, l = body_momenta(
            shape_of(kind, body), frame, kind.coupling[:, modes], v, w, kind.modal_velocity[modes]
        )
        if frame.slender:
            frame.axial_momentum = momentum_about_axis(frame, p, l)
        p = rotate(R, p)
        l = rotate(R, l)
        for k in range(3):
            frame.linear_momentum[k] = p[k]
            frame.angular_momentum[k] = l[k]


@implement(record, FloatingFrameBodies)
@kernel(internal=True)
def record_floating_frames(
    kind: FloatingFrameBodies, time: float, work: Workspace, row: NDArray[np.float64]
) -> None:
    """Motion of the frames, modal coordinates and rates, reactions of frames that are held, sensors."""
    gather_marker_forces(kind, work)
    for body in range(kind.table.shape[0]):
        entry, first = kind.table[body], kind.table[body].first_mode
        if entry.motion == FIXED:
            g = rotate_back(kind.frame[body].mid_rotation, work.sums.gravity)
            q = kind.modal_position[first : first + entry.mode_count]
            add_load_forces(kind, body, q)
            add_acceleration_forces(kind, body, scaled(-1.0, g), (0.0, 0.0, 0.0), q)
            record_fixed(kind, body, work, row)
            continue
        write_motion(kind.frame[body], frame_outputs(row, entry.column))
        q, rates = part(row, entry.parts.modal_position), part(row, entry.parts.modal_velocity)
        for i in range(entry.mode_count):
            q[i], rates[i] = kind.modal_position[first + i], kind.modal_velocity[first + i]
        if entry.motion != FREE:
            add_joint_forces(kind, body, work)
            _write_reaction(kind, body, time, work, held_outputs(row, entry.held))
        elif kind.sensors.shape[0] > 0:
            stage_at_state(kind, body, False)
    for sensor in range(kind.sensors.shape[0]):
        write_sensor(kind, sensor, row)


@kernel(reassociate=True, internal=True)
def _write_reaction(
    kind: FloatingFrameBodies, body: int, time: float, work: Workspace, out: HeldOutputs
) -> None:
    """Force and moment about the frame origin, world axes, that hold a driven frame on its course.

    Notes
    -----
    The modal accelerations follow from the modal rows at this instant; the frame rows of the equations
    of motion, quadratic velocity forces included, then give what is missing to balance them.
    """
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    frame = kind.frame[body]
    modes = slice(first, first + n)
    modal_position = kind.modal_position[modes]
    modal_velocity = kind.modal_velocity[modes]
    stiffness = kind.stiffness[modes]
    damping = kind.damping[modes]
    quadratic_force = kind.quadratic_force[modes]
    coupling = kind.coupling[:, modes]
    modal_load = kind.modal_load[modes]
    shape = shape_of(kind, body)
    stage_at_state(kind, body, True)
    rows = slice(8 * first, 8 * (first + n))
    position_products = kind.position_products[rows]
    velocity_products = kind.velocity_products[rows]
    R = frame.mid_rotation
    motion = frame.drive_rates
    drive_velocity(kind.constants[kind.table[body].drive :], time, motion)
    w, b = vector_at(motion, 3), vector_at(motion, 9)
    # gravity acts like an acceleration of the frame in the other direction
    a = rotate_back(R, subtract(vector_at(motion, 6), work.sums.gravity))
    quadratic_modal_force(shape, modal_position, position_products, velocity_products, w, quadratic_force)
    add_quadratic_forces(kind, body, w)
    add_load_forces(kind, body, modal_position)
    add_acceleration_forces(kind, body, a, b, modal_position)
    f, m = frame_velocity_forces(shape, modal_position, position_products, frame, w, modal_velocity)
    m = with_shortening(kind, body, w, modal_velocity, m)
    p1 = p2 = p3 = 0.0
    l1 = l2 = l3 = 0.0
    for i in range(n):
        acceleration = (
            modal_load[i]
            + quadratic_force[i]
            - stiffness[i] * modal_position[i]
            - damping[i] * modal_velocity[i]
            - shape[i] * a[0]
            - shape[n + i] * a[1]
            - shape[2 * n + i] * a[2]
            - coupling[0, i] * b[0]
            - coupling[1, i] * b[1]
            - coupling[2, i] * b[2]
        )
        p1 += shape[i] * acceleration
        p2 += shape[n + i] * acceleration
        p3 += shape[2 * n + i] * acceleration
        l1 += coupling[0, i] * acceleration
        l2 += coupling[1, i] * acceleration
        l3 += coupling[2, i] * acceleration
    s = vector(frame.first_moment)
    p = add(add(scaled(frame.mass, a), cross(b, s)), (p1, p2, p3))
    l = add(add(cross(s, a), inertia_product(frame, b)), (l1, l2, l3))
    force = rotate(R, subtract(p, f))
    moment = rotate(R, subtract(subtract(l, m), frame.moment))
    for k in range(3):
        out.reaction_force[k] = force[k] - frame.force[k]
        out.reaction_moment[k] = moment[k]


@implement(add_totals, FloatingFrameBodies)
@kernel(reassociate=True, internal=True)
def add_floating_frame_totals(kind: FloatingFrameBodies, work: Workspace) -> None:
    """Energies and momenta from the carried velocities."""
    totals = work.sums
    for body in range(kind.table.shape[0]):
        n, first = kind.table[body].mode_count, kind.table[body].first_mode
        modes = slice(first, first + n)
        if kind.table[body].motion == FIXED:
            add_totals_of_fixed(kind, body, totals)
            continue
        frame = kind.frame[body]
        shape = shape_of(kind, body)
        stage_at_state(kind, body, True)
        R = frame.mid_rotation
        rates = kind.modal_velocity[modes]
        I_tf = kind.coupling[:, modes]
        v = rotate_back(R, frame.velocity)
        w = (frame.spin[0], frame.spin[1], frame.spin[2])
        p, l = body_momenta(shape, frame, I_tf, v, w, rates)
        kinetic = p[0] * v[0] + p[1] * v[1] + p[2] * v[2] + l[0] * w[0] + l[1] * w[1] + l[2] * w[2]
        elastic = 0.0
        for i in range(n):
            modal_momentum = (
                rates[i]
                + shape[i] * v[0]
                + shape[n + i] * v[1]
                + shape[2 * n + i] * v[2]
                + I_tf[0, i] * w[0]
                + I_tf[1, i] * w[1]
                + I_tf[2, i] * w[2]
            )
            kinetic += modal_momentum * rates[i]
            elastic += kind.stiffness[first + i] * kind.modal_position[first + i] ** 2
        totals.kinetic += 0.5 * kinetic
        totals.elastic += 0.5 * elastic
        m = frame.mass
        s = rotate(R, frame.first_moment)
        for k in range(3):
            totals.potential -= work.sums.gravity[k] * (m * frame.position[k] + s[k])
        totals.dissipated += frame.dissipated_work
        add_momenta(frame, rotate(R, p), rotate(R, l), totals)
