"""Joints in the accurate integrator: accelerations that keep the rows, and the projection of a state.

The rows are differentiated twice: ``G a = -gamma``. Redundant rows are regularised by a small softness, and
one refinement against the rows without it makes its effect invisible also near singular positions::

    ( G M^-1 G^T + delta D ) l = -gamma - G a0,     a = a0 + M^-1 G^T l,     and again with what is left

The softness must stay large against the square of the distance to the constraints, at which redundant rows
contradict each other and would lock the mechanism, and that distance is what the projection keeps small.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.solver.integrate.row_solver import assemble, factor_rows, solve_rows
from heavylift.solver.interface import (
    Bodies,
    Joints,
    Systems,
    Workspace,
    apply_inverse,
    fill_bias,
    fill_rows,
    set_targets,
)
from heavylift.solver.kinds import implement, optional
from heavylift.solver.rows import (
    DOF,
    HALF_IMPULSE,
    HOLDER,
    IMPULSE,
    LAST_REACTION,
    OWNER,
    PANEL,
    PRESCRIBED,
    REACTION,
    RESIDUAL,
    ROW_COLUMNS,
    SCALE,
    SOFTNESS,
    TARGET,
    WIDTH,
    RowSystem,
)

__all__ = ["add_drive_power", "constrain", "correct_velocity", "find_displacement", "is_tree", "soften"]


def is_tree(system: RowSystem) -> bool:
    """Whether the joints form no loop, so that their rows are independent in every position."""
    parent: dict[int, int] = {}

    def root(body: int) -> int:
        while parent.setdefault(body, body) != body:
            body = parent[body]
        return body

    ground = -1
    for first, second in system.attachments.reshape(-1, 2, system.attachments.shape[1]):
        a, b = (ground if end[HOLDER] == PRESCRIBED else int(end[DOF]) for end in (first, second))
        if root(a) == root(b):
            return False
        parent[root(a)] = root(b)
    return True


@optional("accurate")
def soften(systems: Systems, softening: float) -> None:
    """Rows: their softness in this integrator, the same in all stages, for one or two solutions."""


@implement(soften, RowSystem)
@kernel(internal=True)
def soften_rows(system: RowSystem, softening: float) -> None:
    """Of the rows in use; padding keeps its own."""
    lanes = len(system.shape[1])
    for node in range(system.attachments.shape[0] // 2):
        at = node * ROW_COLUMNS * lanes
        for r in range(lanes):
            scale = system.rows[at + SCALE * lanes + r]
            if scale > 0.0:
                system.rows[at + SOFTNESS * lanes + r] = softening * scale
            system.rows[at + LAST_REACTION * lanes + r] = 0.0


@optional("accurate")
def constrain(
    systems: Systems,
    bodies: Bodies,
    joints: Joints,
    work: Workspace,
    time: float,
    solutions: int,
    with_reactions: bool,
) -> None:
    """Rows: accelerations without joints in `work.velocity` become those with them."""


@implement(constrain, RowSystem)
@kernel(inline=True, internal=True)
def constrain_rows(
    system: RowSystem,
    bodies: Bodies,
    joints: Joints,
    work: Workspace,
    time: float,
    solutions: int,
    with_reactions: bool,
) -> None:
    """One factorisation; each solution starts without impulses, so later ones do not see the softness.

    With reactions the impulses are the sums of all solutions in the end.
    """
    lanes = len(system.shape[1])
    width = ROW_COLUMNS * lanes
    nodes = system.attachments.shape[0] // 2
    fill_rows(joints, False, work, system)
    fill_bias(joints, time, work, system)
    apply_inverse(bodies, False, system)
    assemble(system)
    factor_rows(system)
    if with_reactions:
        for node in range(nodes):
            for r in range(lanes):
                system.rows[node * width + REACTION * lanes + r] = 0.0
    for _ in range(solutions):
        for node in range(nodes):
            for r in range(lanes):
                system.rows[node * width + IMPULSE * lanes + r] = 0.0
        solve_rows(system, work.velocity)
        if with_reactions:
            for node in range(nodes):
                at = node * width
                for r in range(lanes):
                    system.rows[at + REACTION * lanes + r] += system.rows[at + IMPULSE * lanes + r]
                    system.rows[at + IMPULSE * lanes + r] = system.rows[at + REACTION * lanes + r]


@optional("accurate")
def find_displacement(systems: Systems, bodies: Bodies, joints: Joints, work: Workspace, time: float) -> None:
    """Rows: displacement in `work.velocity` that closes them to first order; the factor is that of this position."""


@implement(find_displacement, RowSystem)
@kernel(internal=True)
def find_row_displacement(
    system: RowSystem, bodies: Bodies, joints: Joints, work: Workspace, time: float
) -> None:
    """``G d = -g``; the targets of the velocities are kept for `correct_velocity`."""
    lanes = len(system.shape[1])
    width = ROW_COLUMNS * lanes
    nodes = system.attachments.shape[0] // 2
    fill_rows(joints, True, work, system)
    for node in range(nodes):
        for r in range(lanes):
            system.rows[node * width + TARGET * lanes + r] = 0.0
    set_targets(joints, time, 0.0, False, work, system)
    for node in range(nodes):
        for r in range(lanes):
            at = node * width + r
            system.rows[at + HALF_IMPULSE * lanes] = system.rows[at + TARGET * lanes]
            system.rows[at + TARGET * lanes] = -system.rows[at + RESIDUAL * lanes]
            system.rows[at + IMPULSE * lanes] = 0.0
    apply_inverse(bodies, False, system)
    assemble(system)
    factor_rows(system)
    solve_rows(system, work.velocity)


@optional("accurate")
def correct_velocity(systems: Systems, work: Workspace) -> None:
    """Rows: project the velocities in `work.velocity`, after `find_displacement`."""


@implement(correct_velocity, RowSystem)
@kernel(internal=True)
def correct_row_velocity(system: RowSystem, work: Workspace) -> None:
    """``G u = l'``, with prescribed velocities as they are."""
    lanes = len(system.shape[1])
    width = ROW_COLUMNS * lanes
    for node in range(system.attachments.shape[0] // 2):
        for r in range(lanes):
            at = node * width + r
            system.rows[at + TARGET * lanes] = system.rows[at + HALF_IMPULSE * lanes]
            system.rows[at + IMPULSE * lanes] = 0.0
    solve_rows(system, work.velocity)


@optional("accurate")
def add_drive_power(systems: Systems, values: Floats1, at: int, work: Workspace) -> None:
    """Rows: add the power [W] that drives put into free bodies to `work.sums`, by the reactions of `constrain`."""


@implement(add_drive_power, RowSystem)
@kernel(internal=True)
def add_row_drive_power(system: RowSystem, values: NDArray[np.float64], at: int, work: Workspace) -> None:
    """``l . G u`` over the sides that are not prescribed."""
    lanes = len(system.shape[1])
    for i in range(system.attachments.shape[0]):
        if system.attachments[i, HOLDER] == PRESCRIBED:
            continue
        dof, panel = system.attachments[i, DOF], system.attachments[i, PANEL]
        reaction = (system.attachments[i, OWNER] * ROW_COLUMNS + REACTION) * lanes
        for k in range(system.attachments[i, WIDTH]):
            for r in range(lanes):
                work.sums.drive_work += (
                    system.rows[reaction + r] * system.panels[panel + k * lanes + r] * values[at + dof + k]
                )
