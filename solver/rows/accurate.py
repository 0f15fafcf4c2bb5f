"""Joints in the accurate integrator: accelerations that keep the rows, and the projection of a state.

The rows are differentiated twice: ``G a = -gamma``. Redundant rows of loops are left out, if a choice is known
(`heavylift.solver.start.independent_rows`); they come back, all of them, once one that was left out opens. Reactions
are those of all rows, among which redundant ones share.

Where no choice is known redundant rows are regularised by a small softness, and one refinement against the rows
without it makes its effect invisible also near singular positions::

    ( G M^-1 G^T + delta D ) l = -gamma - G a0,     a = a0 + M^-1 G^T l,     and again with what is left

The softness must then stay large against the square of the distance to the constraints, at which redundant rows
contradict each other and would lock the mechanism, and that distance is what the projection keeps small.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.integrate.integration import (
    LOOSEST_SHARED,
    OPENS,
    SHARED_SOFTENING,
    Integration,
)
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
from heavylift.solver.rows.solver import assemble, factor_rows, solve_rows
from heavylift.solver.rows.structure import (
    ABSENT,
    PRESCRIBED,
    RowArrays,
    RowSystem,
)

__all__ = ["constrain", "forget_reactions", "project", "soften"]


@kernel(internal=True)
def soften(system: RowArrays, integration: Integration, shared: bool) -> None:
    """Softness of the rows of a stage, or of all rows so that redundant ones share; padding keeps its own."""
    lanes = system.lanes
    for node in range(system.attachments.shape[0] // 2):
        row = system.rows[node]
        for r in range(lanes):
            scale = row.scale[r]
            if scale > 0.0:
                row.softness[r] = scale * (
                    SHARED_SOFTENING if shared else integration.softening[node * lanes + r]
                )


@kernel(internal=True)
def forget_reactions(system: RowArrays) -> None:
    """Reactions of the middle of a step, of which there are none."""
    for node in range(system.attachments.shape[0] // 2):
        for r in range(system.lanes):
            system.rows[node].last_reaction[r] = 0.0


@optional("accurate")
def constrain(
    systems: Systems,
    bodies: Bodies,
    joints: Joints,
    integration: Integration,
    at: int,
    with_reactions: bool,
    factored: bool,
    work: Workspace,
    time: float,
) -> None:
    """Rows: accelerations without joints in `work.velocity` become those with them.

    Drives add their power [W] at the state vector that begins at `at` of the vectors of the integration. The factor of
    this position may be there, from the projection of its velocities.
    """


@implement(constrain, RowSystem)
@kernel(internal=True)
def constrain_rows(
    system: RowSystem,
    bodies: Bodies,
    joints: Joints,
    integration: Integration,
    at: int,
    with_reactions: bool,
    factored: bool,
    work: Workspace,
    time: float,
) -> None:
    """One factorisation; each solution starts without impulses, so later ones do not see the softness.

    With reactions the impulses are the sums of all solutions in the end.
    """
    progress = integration.progress
    wanted = with_reactions or progress.driven or progress.based
    shared = with_reactions and progress.chosen
    if shared:
        soften(system, integration, True)
    lanes = len(system.shape[1])
    nodes = system.attachments.shape[0] // 2
    if not factored:
        fill_rows(joints, False, work, system)
        apply_inverse(bodies, False, system)
        assemble(system)
        factor_rows(system)
    fill_bias(joints, time, work, system)
    if wanted:
        for node in range(nodes):
            for r in range(lanes):
                system.rows[node].reaction[r] = 0.0
    for _ in range(progress.solutions):
        for node in range(nodes):
            for r in range(lanes):
                system.rows[node].impulse[r] = 0.0
        solve_rows(system, work.velocity)
        if wanted:
            for node in range(nodes):
                row = system.rows[node]
                for r in range(lanes):
                    row.reaction[r] += row.impulse[r]
                    row.impulse[r] = row.reaction[r]
    if shared:
        soften(system, integration, False)
    if progress.driven:
        _add_drive_power(system, integration.vectors, at, work)


@kernel(internal=True)
def _add_drive_power(system: RowSystem, values: NDArray[np.float64], at: int, work: Workspace) -> None:
    """Power [W] that drives put into free bodies: ``l . G u`` over the sides that are not prescribed."""
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


@optional("accurate")
def project(
    systems: Systems,
    bodies: Bodies,
    joints: Joints,
    integration: Integration,
    of_velocity: bool,
    allowed: float,
    work: Workspace,
    time: float,
) -> None:
    """Rows: a displacement in `work.velocity` becomes one that closes them to first order, or velocities keep them.

    Velocities are those of a position that is closed: beside a singular one the factor of an open position would leave
    rates of the rows, from which accelerations grow. There, gaps of rows that are left out are watched, beside the
    error [m] that a step may have.
    """


@implement(project, RowSystem)
@kernel(internal=True)
def project_rows(
    system: RowSystem,
    bodies: Bodies,
    joints: Joints,
    integration: Integration,
    of_velocity: bool,
    allowed: float,
    work: Workspace,
    time: float,
) -> None:
    """``G d = -g``, or ``G u`` as prescribed, by the factor of the position of the markers, which stays."""
    lanes = len(system.shape[1])
    nodes = system.attachments.shape[0] // 2
    watched = of_velocity and integration.progress.chosen
    fill_rows(joints, watched or not of_velocity, work, system)
    for node in range(nodes):
        row = system.rows[node]
        for r in range(lanes):
            row.target[r] = row.impulse[r] = 0.0
    set_targets(joints, time, 0.0, False, work, system)
    if watched:
        _watch_gaps(system, integration, allowed)
    apply_inverse(bodies, False, system)
    assemble(system)
    factor_rows(system)
    if not of_velocity:
        for node in range(nodes):
            row = system.rows[node]
            for r in range(lanes):
                row.target[r] = -row.residual[r]
    solve_rows(system, work.velocity)


@kernel(internal=True)
def _watch_gaps(system: RowSystem, integration: Integration, allowed: float) -> None:
    """Take rows back that were left out, if one of them opens: then they share, as where no choice is known."""
    progress = integration.progress
    lanes = len(system.shape[1])
    gap = 0.0
    for node in range(system.attachments.shape[0] // 2):
        row = system.rows[node]
        for r in range(lanes):
            if integration.softening[node * lanes + r] == ABSENT:
                gap = max(gap, abs(row.residual[r]))
    if not progress.started:
        progress.start_gap = gap
    elif not gap <= 2.0 * progress.start_gap + OPENS * allowed:
        progress.chosen, progress.left_open = False, gap
        progress.largest_error = LOOSEST_SHARED * progress.length
        for i in range(integration.softening.shape[0]):
            integration.softening[i] = SHARED_SOFTENING
        soften(system, integration, False)
