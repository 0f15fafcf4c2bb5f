"""Joints on fixed frames: only modes move, and their step matrix is diagonal."""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.floating_frame import (
    FixedFrameBodies,
)
from heavylift.solver.bodies.floating_frame_panels import attached_body, gather_row_forces, scale_modal_panel
from heavylift.solver.interface import (
    Workspace,
    apply_inverse,
    end_velocity,
    estimate_error,
    gather_reactions,
    set_velocity,
    write_velocity,
)
from heavylift.solver.kinds import implement
from heavylift.solver.rows import RowArrays

__all__: list[str] = []


@implement(apply_inverse, FixedFrameBodies)
@kernel(internal=True)
def apply_inverse_of_fixed_frames(kind: FixedFrameBodies, at_midpoint: bool, system: RowArrays) -> None:
    """Of the attachments of these bodies; at the end of the step the modal mass is one."""
    if not at_midpoint:
        for i in range(kind.modal_position.shape[0]):
            kind.inverse_diagonal[i] = 1.0
    for i in range(system.attachments.shape[0]):
        body = attached_body(kind, system, i)
        if body >= 0:
            scale_modal_panel(kind, body, system, i)


@implement(gather_reactions, FixedFrameBodies)
@kernel(internal=True)
def gather_reactions_on_fixed_frames(kind: FixedFrameBodies, fresh: bool, system: RowArrays) -> None:
    """The recorded reaction of the frame balances them."""
    gather_row_forces(kind, fresh, system)


@implement(write_velocity, FixedFrameBodies)
@kernel(internal=True)
def write_velocity_of_fixed_frames(kind: FixedFrameBodies, work: Workspace) -> None:
    """Modal rates."""
    for body in range(kind.table.shape[0]):
        n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
        for k in range(6):
            work.velocity[dof + k] = 0.0
        for i in range(n):
            work.velocity[dof + 6 + i] = kind.modal_velocity[first + i]


@implement(end_velocity, FixedFrameBodies)
@kernel(internal=True)
def end_velocity_of_fixed_frames(kind: FixedFrameBodies, step: float, work: Workspace) -> None:
    """Those that `advance` has found."""
    write_velocity_of_fixed_frames(kind, work)


@implement(set_velocity, FixedFrameBodies)
@kernel(internal=True)
def set_velocity_of_fixed_frames(kind: FixedFrameBodies, step: float, work: Workspace) -> None:
    """Projected modal rates."""
    for body in range(kind.table.shape[0]):
        n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
        for i in range(n):
            rate = work.velocity[dof + 6 + i]
            kind.modal_acceleration[first + i] += (rate - kind.modal_velocity[first + i]) / step
            kind.modal_velocity[first + i] = rate


@implement(estimate_error, FixedFrameBodies)
@kernel(internal=True, reassociate=True)
def estimate_fixed_frame_error(kind: FixedFrameBodies, step: float, work: Workspace) -> None:
    """As of floating frames: mean velocity of deformation that was not predicted, over the step [m]."""
    for body in range(kind.table.shape[0]):
        n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
        deformed = 0.0
        for i in range(n):
            predicted = kind.modal_velocity[first + i] + 0.5 * step * kind.modal_acceleration[first + i]
            deformed += (work.velocity[dof + 6 + i] - predicted) ** 2
        error = step * math.sqrt(deformed / kind.frame[body].mass)
        work.control.error = max(work.control.error, error)
