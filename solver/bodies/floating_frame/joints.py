"""Joints on floating frames: ``X = A^-1 G^T``, projected velocities, the second pass of the step with rows.

The step matrix of a body is an arrow: a dense block of the six frame velocities v in body axes, a diagonal D of
the modes, and their coupling ``C = [S; I_tf]``. For each column g = (f, m) of ``G^T``, modes eliminated first::

    K y = f - C D^-1 m,    x = ( y, D^-1 (m - C^T y) ),    K = M_rr - C D^-1 C^T

with the factor of K that the free velocity was found with. The rows of a joint lie side by side in lanes, so
one pass over the modes serves all of them. At the end of the step A is the mass matrix there, D = 1. Of a driven
frame only the modes move: y = 0.

Markers move and turn with their places: a joint on a flexible body follows the displacement of its point and the
rotation there, and its moments bend the body.
"""

from __future__ import annotations

import math
from typing import Any

from heavylift.numerics.jit import kernel
from heavylift.numerics.lanes import LANES_1, LANES_2, LANES_4, LANES_8, add_multiple
from heavylift.numerics.vectors import rotate, rotate_back
from heavylift.solver.bodies.floating_frame.inertia import body_momenta, leading_products
from heavylift.solver.bodies.floating_frame.kind import FloatingFrameBodies, product_columns, shape_of
from heavylift.solver.bodies.floating_frame.stage import factor_frame
from heavylift.solver.bodies.floating_frame.step import evaluate_end
from heavylift.solver.bodies.frames.motion import attached_body, write_frame_velocities
from heavylift.solver.drive import FIXED, FREE
from heavylift.solver.interface import (
    Workspace,
    apply_inverse,
    end_velocity,
    estimate_error,
    set_velocity,
    write_velocity,
)
from heavylift.solver.kinds import implement
from heavylift.solver.rows.structure import RowArrays

__all__ = ["scale_modal_panel"]


# ---- panels ----


@kernel(internal=True)
def scale_modal_panel(kind: FloatingFrameBodies, body: int, system: RowArrays, attachment: int) -> None:
    """Modal rows of X: those of G times the inverse diagonal of the modes; frame rows zero."""
    if system.lanes == 1:
        _scale_modal_panel(LANES_1, kind, body, system, attachment)
    elif system.lanes == 2:
        _scale_modal_panel(LANES_2, kind, body, system, attachment)
    elif system.lanes == 4:
        _scale_modal_panel(LANES_4, kind, body, system, attachment)
    else:
        _scale_modal_panel(LANES_8, kind, body, system, attachment)


@kernel(internal=True)
def _scale_modal_panel(
    shape: Any, kind: FloatingFrameBodies, body: int, system: RowArrays, attachment: int
) -> None:
    G = system.panels
    lanes = len(shape[1])
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    panel = system.attachments[attachment].panel
    out = G.shape[0] // 2 + panel
    for r in range((6 + n) * lanes):
        G[out + r] = 0.0
    for i in range(n):
        at = (6 + i) * lanes
        add_multiple(shape, G, out + at, G, panel + at, kind.inverse_diagonal, first + i)


# ---- operations ----


@implement(apply_inverse, FloatingFrameBodies)
@kernel(internal=True)
def apply_inverse_of_floating_frames(kind: FloatingFrameBodies, at_midpoint: bool, system: RowArrays) -> None:
    """Of the attachments of these bodies."""
    for body in range(kind.table.shape[0]):
        _prepare(kind, body, at_midpoint)
    for i in range(system.attachments.shape[0]):
        body = attached_body(kind, system, i)
        if body >= 0:
            scale_modal_panel(kind, body, system, i)
            if kind.table[body].motion == FREE:
                _apply_to_frame(kind, body, at_midpoint, system, system.attachments[i].panel)


@kernel(internal=True)
def _prepare(kind: FloatingFrameBodies, body: int, at_midpoint: bool) -> None:
    """Factor of the mass matrix at the end of the step; couplings and factor in the form that lanes need."""
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    frame = kind.frame[body]
    modes = slice(first, first + n)
    inverse_diagonal = kind.inverse_diagonal[modes]
    scaled_coupling = kind.scaled_coupling[:, modes]
    translation = kind.translation[:, modes]
    coupling = kind.coupling[:, modes]
    free = kind.table[body].motion == FREE
    if not at_midpoint:
        for i in range(n):
            inverse_diagonal[i] = 1.0
        if free:
            factor_frame(frame, inverse_diagonal, translation, coupling)
    if free:
        for k in range(3):
            for i in range(n):
                scaled_coupling[k, i] = translation[k, i] * inverse_diagonal[i]
                scaled_coupling[3 + k, i] = coupling[k, i] * inverse_diagonal[i]
        for i in range(6):
            for j in range(i):
                frame.negative_factor[6 * i + j] = -frame.factor[6 * i + j]
            frame.negative_factor[7 * i] = frame.factor[7 * i]


@kernel(internal=True)
def _apply_to_frame(
    kind: FloatingFrameBodies, body: int, at_midpoint: bool, system: RowArrays, panel: int
) -> None:
    """Frame rows of X, and what they add to the modal rows, which hold ``D^-1 m``."""
    if system.lanes == 1:
        _apply_of_lanes(LANES_1, kind, body, at_midpoint, system, panel)
    elif system.lanes == 2:
        _apply_of_lanes(LANES_2, kind, body, at_midpoint, system, panel)
    elif system.lanes == 4:
        _apply_of_lanes(LANES_4, kind, body, at_midpoint, system, panel)
    else:
        _apply_of_lanes(LANES_8, kind, body, at_midpoint, system, panel)


@kernel(internal=True)
def _apply_of_lanes(
    shape: Any, kind: FloatingFrameBodies, body: int, at_midpoint: bool, system: RowArrays, panel: int
) -> None:
    G = system.panels
    lanes = len(shape[1])
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    frame, coupling = kind.frame[body], kind.scaled_coupling
    total = coupling.shape[1]
    out = G.shape[0] // 2 + panel
    R = frame.mid_rotation if at_midpoint else frame.end_rotation
    for r in range(lanes):  # -y, so that all that follows are sums
        f = rotate_back(R, (G[panel + r], G[panel + lanes + r], G[panel + 2 * lanes + r]))
        for k in range(3):
            G[out + k * lanes + r] = -f[k]
            G[out + (3 + k) * lanes + r] = -G[panel + (3 + k) * lanes + r]
    for i in range(n):
        at = panel + (6 + i) * lanes
        for k in range(6):
            add_multiple(shape, G, out + k * lanes, G, at, coupling, k * total + first + i)
    factor = frame.negative_factor
    for i in range(6):
        for j in range(i):
            add_multiple(shape, G, out + i * lanes, G, out + j * lanes, factor, 6 * i + j)
        for r in range(lanes):
            G[out + i * lanes + r] *= factor[7 * i]
    for i in range(5, -1, -1):
        for j in range(i + 1, 6):
            add_multiple(shape, G, out + i * lanes, G, out + j * lanes, factor, 6 * j + i)
        for r in range(lanes):
            G[out + i * lanes + r] *= factor[7 * i]
    for i in range(n):
        at = out + (6 + i) * lanes
        for k in range(6):
            add_multiple(shape, G, at, G, out + k * lanes, coupling, k * total + first + i)
    for r in range(lanes):
        v = rotate(R, (G[out + r], G[out + lanes + r], G[out + 2 * lanes + r]))
        for k in range(3):
            G[out + k * lanes + r] = -v[k]
            G[out + (3 + k) * lanes + r] *= -1.0


@implement(end_velocity, FloatingFrameBodies)
@kernel(internal=True)
def end_velocity_of_floating_frames(kind: FloatingFrameBodies, step: float, work: Workspace) -> None:
    """(F6) of the step, with the inertia there."""
    for body in range(kind.table.shape[0]):
        if kind.table[body].motion == FIXED:
            continue
        n, first = kind.table[body].mode_count, kind.table[body].first_mode
        columns, q = product_columns(kind, body), kind.modal_position[first : first + n]
        leading_products(columns, q, 8 * n, kind.position_products[8 * first : 8 * (first + n)])
        evaluate_end(kind, body)
        kind.frame[body].at_end = True
    write_velocity_of_floating_frames(kind, work)


@implement(write_velocity, FloatingFrameBodies)
@kernel(internal=True)
def write_velocity_of_floating_frames(kind: FloatingFrameBodies, work: Workspace) -> None:
    """Frames, and modal rates."""
    write_frame_velocities(kind, work)
    for body in range(kind.table.shape[0]):
        n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
        modal_velocity = kind.modal_velocity[first : first + n]
        for i in range(n):
            work.velocity[dof + 6 + i] = modal_velocity[i]


@implement(set_velocity, FloatingFrameBodies)
@kernel(internal=True)
def set_velocity_of_floating_frames(kind: FloatingFrameBodies, step: float, work: Workspace) -> None:
    """Projected velocities, and the momenta that belong to them."""
    for body in range(kind.table.shape[0]):
        n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
        velocity = work.velocity[dof : dof + 6 + n]
        frame = kind.frame[body]
        modes = slice(first, first + n)
        modal_velocity = kind.modal_velocity[modes]
        modal_acceleration = kind.modal_acceleration[modes]
        for i in range(n):
            modal_acceleration[i] += (velocity[6 + i] - modal_velocity[i]) / step
            modal_velocity[i] = velocity[6 + i]
        if kind.table[body].motion != FREE:
            continue
        R = frame.end_rotation
        v = rotate_back(R, velocity)
        w = (velocity[3], velocity[4], velocity[5])
        p, l = body_momenta(shape_of(kind, body), frame, kind.coupling[:, modes], v, w, velocity[6:])
        p, l = rotate(R, p), rotate(R, l)
        for k in range(3):
            frame.velocity[k] = velocity[k]
            frame.spin[k] = velocity[3 + k]
            frame.linear_momentum[k] = p[k]
            frame.angular_momentum[k] = l[k]


@implement(estimate_error, FloatingFrameBodies)
@kernel(internal=True, reassociate=True)
def estimate_floating_frame_error(kind: FloatingFrameBodies, step: float, work: Workspace) -> None:
    """Distance of the midpoint velocity from its prediction, as a displacement [m] over the step.

    Notes
    -----
    Modes have unit modal mass: the root of the sum of squares of modal rates, over that of the mass, is the mean
    velocity of deformation, weighted by mass.
    """
    h = step
    for body in range(kind.table.shape[0]):
        n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
        frame = kind.frame[body]
        modes = slice(first, first + n)
        mid_modal_velocity = kind.mid_modal_velocity[modes]
        moved = turned = deformed = 0.0
        if kind.table[body].motion == FREE:
            for k in range(3):
                predicted = frame.start_velocity[k] + 0.5 * h * frame.acceleration[k]
                moved += (work.velocity[dof + k] - predicted) ** 2
                turned += (work.velocity[dof + 3 + k] - frame.mid_spin[k]) ** 2
        # the stage of a fixed frame is at the velocity of the start
        ahead = 0.5 * h if kind.table[body].motion == FIXED else 0.0
        for i in range(n):
            predicted = mid_modal_velocity[i] + ahead * kind.modal_acceleration[first + i]
            deformed += (work.velocity[dof + 6 + i] - predicted) ** 2
        speed = max(math.sqrt(moved), frame.reach * math.sqrt(turned))
        speed = max(speed, math.sqrt(deformed / frame.mass))
        work.control.error = max(work.control.error, h * speed)
