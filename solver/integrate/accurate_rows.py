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
    PRESCRIBED,
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
    for first in range(0, len(system.attachments), 2):
        ends = system.attachments[first], system.attachments[first + 1]
        a, b = (ground if end.holder == PRESCRIBED else int(end.dof) for end in ends)
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
        row = system.rows[node]
        for r in range(lanes):
            scale = row.scale[r]
            if scale > 0.0:
                row.softness[r] = softening * scale
            row.last_reaction[r] = 0.0


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
    nodes = system.attachments.shape[0] // 2
    fill_rows(joints, False, work, system)
    fill_bias(joints, time, work, system)
    apply_inverse(bodies, False, system)
    assemble(system)
    factor_rows(system)
    if with_reactions:
        for node in range(nodes):
            for r in range(lanes):
                system.rows[node].reaction[r] = 0.0
    for _ in range(solutions):
        for node in range(nodes):
            for r in range(lanes):
                system.rows[node].impulse[r] = 0.0
        solve_rows(system, work.velocity)
        if with_reactions:
            for node in range(nodes):
                row = system.rows[node]
                for r in range(lanes):
                    row.reaction[r] += row.impulse[r]
                    row.impulse[r] = row.reaction[r]


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
    nodes = system.attachments.shape[0] // 2
    fill_rows(joints, True, work, system)
    for node in range(nodes):
        for r in range(lanes):
            system.rows[node].target[r] = 0.0
    set_targets(joints, time, 0.0, False, work, system)
    for node in range(nodes):
        row = system.rows[node]
        for r in range(lanes):
            row.half_impulse[r] = row.target[r]
            row.target[r] = -row.residual[r]
            row.impulse[r] = 0.0
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
    for node in range(system.attachments.shape[0] // 2):
        row = system.rows[node]
        for r in range(lanes):
            row.target[r] = row.half_impulse[r]
            row.impulse[r] = 0.0
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
        if system.attachments[i].holder == PRESCRIBED:
            continue
        dof, panel = system.attachments[i].dof, system.attachments[i].panel
        reaction = system.rows[system.attachments[i].owner].reaction
        for k in range(system.attachments[i].width):
            for r in range(lanes):
                work.sums.drive_work += (
                    reaction[r] * system.panels[panel + k * lanes + r] * values[at + dof + k]
                )
