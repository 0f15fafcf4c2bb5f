"""Flexible bodies whose frame stands still: modal oscillators, reactions, nothing else.

A clamped body has no inertia coupling, no velocity forces and a diagonal step matrix. It could run
through the code of a frame that moves too, but a scene should execute only what it needs.
The trapezoidal rule of the second-order step is, per mode::

    ( 1 + h^2/4 k + h/2 d ) qd_b = qd + h/2 ( Q - k q ),   q += h qd_b,   qd := 2 qd_b - qd
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import cross, rotate, rotate_back
from heavylift.solver.bodies.floating_frame.inertia import deformed_inertia, stacked_products
from heavylift.solver.bodies.floating_frame.kind import FloatingFrameBodies, product_columns, shape_of
from heavylift.solver.bodies.floating_frame.stage import add_joint_forces
from heavylift.solver.bodies.frames.motion import (
    add_momenta,
    frame_outputs,
    held_outputs,
    pose_stage,
    write_motion,
)
from heavylift.solver.interface import Sums, Workspace

__all__ = [
    "add_totals_of_fixed",
    "advance_fixed",
    "factor_fixed",
    "place_fixed",
    "predict_fixed",
    "record_fixed",
    "thesis_advance_fixed",
    "thesis_velocity_fixed",
]


@kernel(internal=True)
def place_fixed(kind: FloatingFrameBodies, body: int) -> None:
    """The pose of the stage is that of the frame, once and for all."""
    pose_stage(kind.frame[body])


@kernel(internal=True)
def predict_fixed(kind: FloatingFrameBodies, body: int, step: float) -> None:
    """Modal coordinates at the midpoint, for markers and contours only."""
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    modes = slice(first, first + n)
    modal_position, modal_velocity = kind.modal_position[modes], kind.modal_velocity[modes]
    mid_modal_position, mid_modal_velocity = kind.mid_modal_position[modes], kind.mid_modal_velocity[modes]
    for i in range(n):
        mid_modal_position[i] = modal_position[i] + 0.5 * step * modal_velocity[i]
        mid_modal_velocity[i] = modal_velocity[i]


@kernel(internal=True)
def _gather_loads(kind: FloatingFrameBodies, body: int, work: Workspace) -> None:
    """Modal loads of the markers and gravity as right-hand sides."""
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    modes = slice(first, first + n)
    modal_right_hand_side = kind.modal_right_hand_side[modes]
    modal_load = kind.modal_load[modes]
    translation = kind.translation[:, modes]
    gravity = work.sums.gravity
    for i in range(n):
        modal_right_hand_side[i] = modal_load[i]
    if gravity[0] != 0.0 or gravity[1] != 0.0 or gravity[2] != 0.0:
        g = rotate_back(kind.frame[body].mid_rotation, gravity)
        for i in range(n):
            modal_right_hand_side[i] += (
                translation[0, i] * g[0] + translation[1, i] * g[1] + translation[2, i] * g[2]
            )


@kernel(internal=True)
def factor_fixed(kind: FloatingFrameBodies, body: int, step: float, work: Workspace) -> None:
    """Midpoint rates of all modes."""
    _gather_loads(kind, body, work)
    half = 0.5 * step
    n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
    modes = slice(first, first + n)
    modal_position = kind.modal_position[modes]
    modal_velocity = kind.modal_velocity[modes]
    stiffness = kind.stiffness[modes]
    damping = kind.damping[modes]
    modal_right_hand_side = kind.modal_right_hand_side[modes]
    inverse_diagonal = kind.inverse_diagonal[modes]
    rates = work.velocity[dof + 6 : dof + 6 + n]
    for k in range(6):
        work.velocity[dof + k] = 0.0
    for i in range(n):
        inverse_diagonal[i] = 1.0 / (1.0 + half * (half * stiffness[i] + damping[i]))
        rates[i] = inverse_diagonal[i] * (
            modal_velocity[i] + half * (modal_right_hand_side[i] - stiffness[i] * modal_position[i])
        )


@kernel(internal=True, reassociate=True)
def _add_work(kind: FloatingFrameBodies, body: int, step: float, rates: NDArray[np.float64]) -> None:
    """Work of the marker forces and loss in the dampers, with the rates of the stage, shape (n,)."""
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    modes = slice(first, first + n)
    modal_load = kind.modal_load[modes]
    damping = kind.damping[modes]
    external = dissipated = 0.0
    for i in range(n):
        external += modal_load[i] * rates[i]
        dissipated += damping[i] * rates[i] * rates[i]
    kind.frame[body].external_work += step * external
    kind.frame[body].dissipated_work += step * dissipated


@kernel(internal=True)
def advance_fixed(kind: FloatingFrameBodies, body: int, step: float, work: Workspace) -> None:
    """Modal coordinates and rates to the end of the step."""
    n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
    modes = slice(first, first + n)
    modal_position = kind.modal_position[modes]
    modal_velocity = kind.modal_velocity[modes]
    modal_acceleration = kind.modal_acceleration[modes]
    rates = work.velocity[dof + 6 : dof + 6 + n]
    _add_work(kind, body, step, rates)
    for i in range(n):
        modal_position[i] += step * rates[i]
        modal_acceleration[i] = 2.0 * (rates[i] - modal_velocity[i]) / step
        modal_velocity[i] = 2.0 * rates[i] - modal_velocity[i]


@kernel(internal=True)
def thesis_velocity_fixed(kind: FloatingFrameBodies, body: int, step: float, work: Workspace) -> None:
    """``( 1 + h^2/4 k + h d ) qd+ = ( 1 + h^2/4 k ) qd + h ( Q - k q )``, as for floating frames."""
    h = step
    _gather_loads(kind, body, work)
    n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
    for k in range(6):
        work.velocity[dof + k] = 0.0
    modes = slice(first, first + n)
    modal_position = kind.modal_position[modes]
    modal_velocity = kind.modal_velocity[modes]
    stiffness = kind.stiffness[modes]
    damping = kind.damping[modes]
    modal_right_hand_side = kind.modal_right_hand_side[modes]
    rates = work.velocity[dof + 6 : dof + 6 + n]
    for i in range(n):
        elastic = 1.0 + 0.25 * h * h * stiffness[i]
        load = modal_right_hand_side[i] - stiffness[i] * modal_position[i]
        rates[i] = (elastic * modal_velocity[i] + h * load) / (elastic + h * damping[i])


@kernel(internal=True)
def thesis_advance_fixed(kind: FloatingFrameBodies, body: int, step: float, work: Workspace) -> None:
    """Modal coordinates by the end rates."""
    n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
    modes = slice(first, first + n)
    modal_position = kind.modal_position[modes]
    modal_velocity = kind.modal_velocity[modes]
    rates = work.velocity[dof + 6 : dof + 6 + n]
    _add_work(kind, body, step, rates)
    for i in range(n):
        modal_position[i] += step * rates[i]
        modal_velocity[i] = rates[i]


@kernel(internal=True)
def _deform(kind: FloatingFrameBodies, body: int) -> None:
    """Products, ``S_t`` and ``I_tf`` of the carried state: needed for records only."""
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    rows = slice(8 * first, 8 * (first + n))
    position_products = kind.position_products[rows]
    velocity_products = kind.velocity_products[rows]
    q, rates = kind.modal_position[first : first + n], kind.modal_velocity[first : first + n]
    stacked_products(product_columns(kind, body), q, rates, position_products, velocity_products)
    deformed_inertia(
        shape_of(kind, body), q, position_products, kind.frame[body], kind.coupling[:, first : first + n]
    )


@kernel(internal=True, reassociate=True)
def record_fixed(kind: FloatingFrameBodies, body: int, work: Workspace, row: NDArray[np.float64]) -> None:
    """Motion of the frame, modal coordinates and rates, and the reaction.

    Notes
    -----
    The reaction balances ``dp/dt = S qdd`` and ``dL/dt = I_tf(q) qdd``, gravity and the marker forces;
    ``(d I_tf/dt) qd`` vanishes because the matrices A_k are antisymmetric.
    """
    add_joint_forces(kind, body, work)
    _gather_loads(kind, body, work)
    entry, n, first = kind.table[body], kind.table[body].mode_count, kind.table[body].first_mode
    frame, shape = kind.frame[body], shape_of(kind, body)
    R = frame.mid_rotation
    _deform(kind, body)
    write_motion(frame, frame_outputs(row, entry.column))
    # places in the row, no views of it: these change how the compiler orders the sums below
    at, rates_at = entry.parts.modal_position.first, entry.parts.modal_velocity.first
    p1 = p2 = p3 = 0.0
    l1 = l2 = l3 = 0.0
    for i in range(n):
        m = first + i
        row[at + i] = kind.modal_position[m]
        row[rates_at + i] = kind.modal_velocity[m]
        a = (
            kind.modal_right_hand_side[m]
            - kind.stiffness[m] * kind.modal_position[m]
            - kind.damping[m] * kind.modal_velocity[m]
        )
        p1 += shape[i] * a
        p2 += shape[n + i] * a
        p3 += shape[2 * n + i] * a
        l1 += kind.coupling[0, m] * a
        l2 += kind.coupling[1, m] * a
        l3 += kind.coupling[2, m] * a
    g = rotate_back(R, work.sums.gravity)
    mass = frame.mass
    t = cross(frame.first_moment, g)
    force = rotate(R, (p1 - mass * g[0], p2 - mass * g[1], p3 - mass * g[2]))
    moment = rotate(
        R, (l1 - t[0] - frame.moment[0], l2 - t[1] - frame.moment[1], l3 - t[2] - frame.moment[2])
    )
    out = held_outputs(row, entry.held)
    for k in range(3):
        out.reaction_force[k] = force[k] - frame.force[k]
        out.reaction_moment[k] = moment[k]


@kernel(internal=True, reassociate=True)
def add_totals_of_fixed(kind: FloatingFrameBodies, body: int, sums: Sums) -> None:
    """Energies and momenta; the products and the coupling are those of the record just written."""
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    frame, shape = kind.frame[body], shape_of(kind, body)
    R = frame.mid_rotation
    p1 = p2 = p3 = 0.0
    l1 = l2 = l3 = 0.0
    kinetic = elastic = 0.0
    for i in range(n):
        m = first + i
        rate = kind.modal_velocity[m]
        kinetic += rate * rate
        elastic += kind.stiffness[m] * kind.modal_position[m] * kind.modal_position[m]
        p1 += shape[i] * rate
        p2 += shape[n + i] * rate
        p3 += shape[2 * n + i] * rate
        l1 += kind.coupling[0, m] * rate
        l2 += kind.coupling[1, m] * rate
        l3 += kind.coupling[2, m] * rate
    sums.kinetic += 0.5 * kinetic
    sums.elastic += 0.5 * elastic
    s = rotate(R, frame.first_moment)
    p = rotate(R, (p1, p2, p3))
    for k in range(3):
        sums.potential -= sums.gravity[k] * (frame.mass * frame.position[k] + s[k])
    add_momenta(frame, p, rotate(R, (l1, l2, l3)), sums)
    sums.dissipated += frame.dissipated_work
