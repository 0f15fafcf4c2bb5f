"""Joints in a step: the midpoint system, and the exact projection of the velocities at its end.

Regularised rows at the midpoint, solved for half impulses, as in "Integrated simulation ... (2018)", eq. 49,
with the Jacobian of the middle of the step; then a projection of the velocities onto the rows of the end,
without which closed loops fail and an inconsistent start rings for ever.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.solver.contact.system_interface import follow, respond
from heavylift.solver.interface import (
    FORCES,
    Bodies,
    Joints,
    Systems,
    Workspace,
    add_row_work,
    apply_inverse,
    close_step,
    complete,
    end_rows,
    end_velocity,
    fill_markers,
    fill_rows,
    record_joints,
    record_rows,
    refactor_rows,
    relinearise,
    set_targets,
    set_velocity,
    solve_again,
    solve_end,
    solve_midpoint,
    update_rows,
    watch_joints,
)
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.ringing import alternating_slope, carried_force, kept_share, steady_force
from heavylift.solver.rows.impulses import add_impulses, add_reactions
from heavylift.solver.rows.solver import (
    assemble,
    assemble_without_absent,
    factor_present,
    factor_rows,
    respond_rows,
    smallest_pivot,
    solve_rows,
)
from heavylift.solver.rows.structure import (
    REGULARISATION,
    TURNS,
    Row,
    RowSystem,
)
from heavylift.solver.scene.channels import MonitorOutputs

__all__ = ["end_step"]

monitor_outputs = outputs_at(MonitorOutputs)

LAW_ITERATIONS = 200
GOLDEN = 0.6180339887498949
NOT_CONVERGED, NOT_CLOSED = int(Outcome.NOT_CONVERGED), int(Outcome.NOT_CLOSED)


@implement(solve_midpoint, RowSystem)
@kernel(internal=True)
def solve_midpoint_laws(
    system: RowSystem,
    all_systems: Systems,
    bodies: Bodies,
    joints: Joints,
    work: Workspace,
    time: float,
    step: float,
    nominal: float,
) -> None:
    """Newton iteration: solve, fit the laws to the velocities found, solve for the rest.

    Notes
    -----
    Laws are monotone and the system is positive definite, so linearising them again at each result finds the
    solution in a few rounds; most steps need one, because only a law that changes its branch moves.
    """
    _start_midpoint(system, bodies, joints, work, time, step, nominal)
    assemble(system)
    factor_rows(system)
    fit_laws(system, joints, work, time, step)


@kernel(internal=True)
def fit_laws(system: RowSystem, joints: Joints, work: Workspace, time: float, step: float) -> None:
    """Rounds of the Newton iteration, the first with the factor that is there; without laws it is the only one.

    Then `work.control.changed` stays as it is: bodies that iterate count in it.
    """
    if not system.laws:
        solve_rows(system, work.velocity)
        return
    softness = _softness(system)
    for _ in range(LAW_ITERATIONS):
        solve_rows(system, work.velocity)
        work.control.changed = 0
        relinearise(joints, time, step, work, system)
        if work.control.changed == 0:
            return
        before, softness = softness, _softness(system)
        if softness != before:  # else only forces that are given have changed
            assemble(system)
            factor_rows(system)
    work.status.outcome = NOT_CONVERGED


@kernel(internal=True, reassociate=True)
def _softness(system: RowSystem) -> float:
    """A sum that tells whether a softness has changed: with a factor of another one rounds do not converge.

    Of roots, since some are 1e30 times as large as others, with weights that depend on the row.
    """
    total = 0.0
    for node in range(system.attachments.shape[0] // 2):
        softness = system.rows[node].softness
        part = 0.0
        for r in range(len(system.shape[1])):
            part += (r + 1.3) * math.sqrt(math.sqrt(math.sqrt(softness[r])))
        share = GOLDEN * (node + 1)
        total += (1.0 + share - math.floor(share)) * part
    return total


@implement(solve_again, RowSystem)
@kernel(internal=True)
def solve_laws_again(
    system: RowSystem, all_systems: Systems, joints: Joints, work: Workspace, time: float, step: float
) -> None:
    """One solve more, it is incremental; and laws once more."""
    fit_laws(system, joints, work, time, step)


@implement(refactor_rows, RowSystem)
@kernel(internal=True)
def refactor_row_system(system: RowSystem, bodies: Bodies, joints: Joints, work: Workspace) -> None:
    """The impulses stay as they are, and act along the new rows.

    Notes
    -----
    Hubs have no velocities of their own to which impulses could be added: with hubs the rows stay, and what
    `solve_again` adds belongs to the new matrices.
    """
    if system.hubs.shape[0] == 0:
        add_impulses(system, work.velocity, -1.0)
        fill_markers(bodies, True, FORCES, work)
        fill_rows(joints, False, work, system)
        apply_inverse(bodies, True, system)
        add_impulses(system, work.velocity, 1.0)
    else:
        apply_inverse(bodies, True, system)
    assemble(system)
    factor_rows(system)


@kernel(internal=True)
def _start_midpoint(
    system: RowSystem,
    bodies: Bodies,
    joints: Joints,
    work: Workspace,
    time: float,
    step: float,
    nominal: float,
) -> None:
    """Rows of the midpoint with targets and softness. Positions are corrected over the nominal step."""
    lanes = len(system.shape[1])
    fill_rows(joints, False, work, system)
    rate = 1.0 / nominal
    for node in range(system.attachments.shape[0] // 2):
        row = system.rows[node]
        if row.rigid[0] == 0.0 or row.relaxation[0] > 0.0:
            _aim_compliant(system, node, step, nominal)
            continue
        for r in range(lanes):
            row.impulse[r] = 0.0
            row.target[r] = -rate * row.residual[r]
            row.softness[r] = row.hold[r]
    set_targets(joints, time, step, True, work, system)
    apply_inverse(bodies, True, system)


@kernel(internal=True)
def _aim_compliant(system: RowSystem, node: int, step: float, nominal: float) -> None:
    """Targets and softness of a block with physical compliance or relaxation; laws replace them."""
    row, lanes = system.rows[node], len(system.shape[1])
    for r in range(lanes):
        row.impulse[r] = 0.0
        scale = row.scale[r]
        if scale > 0.0:
            compliance = row.compliance[r]
            relaxation = row.relaxation[r]
            # the force of a spring is that of this step, however long steps are otherwise
            delay = (nominal if compliance == 0.0 else 0.5 * step) + relaxation
            row.target[r] = -row.residual[r] / delay
            row.softness[r] = REGULARISATION * scale + 2.0 * compliance / (step * (0.5 * step + relaxation))


@kernel(internal=True)
def end_step(
    systems: Systems, bodies: Bodies, joints: Joints, work: Workspace, time: float, step: float
) -> None:
    """End of the step: velocities projected onto the rigid rows there, impacts, reactions of the step.

    With `work.control.split` set an impact lies within the step, or contacts were not found at its end: then all
    of it has to be taken back.
    """
    end_rows(systems, bodies, joints, work, time, step)
    if work.control.split > 0.0:
        return
    solve_end(systems, systems, bodies, joints, work, time, step)
    if work.control.split > 0.0:
        return
    close_step(systems, systems, bodies, joints, work, step)


@implement(end_rows, RowSystem)
@kernel(internal=True)
def end_row_system(
    system: RowSystem, bodies: Bodies, joints: Joints, work: Workspace, time: float, step: float
) -> None:
    """Impulses of the midpoint are halves of those of the step."""
    lanes = len(system.shape[1])
    update_rows(joints, time, step, work, system)
    add_row_work(bodies, 2.0, work, system)
    end_velocity(bodies, step, work)
    fill_markers(bodies, False, FORCES, work)  # damped springs are rows on markers with rates
    for node in range(system.attachments.shape[0] // 2):
        row = system.rows[node]
        for r in range(lanes):
            row.half_impulse[r] = row.impulse[r]


@implement(solve_end, RowSystem)
@kernel(internal=True)
def solve_end_rows(
    system: RowSystem,
    all_systems: Systems,
    bodies: Bodies,
    joints: Joints,
    work: Workspace,
    time: float,
    step: float,
) -> None:
    """One factorisation more, of the rigid rows with the mass alone; what relaxation has taken in the step."""
    lanes, blocks = len(system.shape[1]), system.attachments.shape[0] // 2
    for node in range(blocks):
        row = system.rows[node]
        for r in range(lanes):
            row.solution[r] = row.residual[r]
    fill_rows(joints, True, work, system)
    for node in range(blocks):
        row = system.rows[node]
        for r in range(lanes):
            row.impulse[r] = 0.0
            row.target[r] = 0.0
            row.softness[r] = row.hold[r]
    set_targets(joints, time + step, step, False, work, system)
    for node in range(blocks):
        row = system.rows[node]
        for r in range(lanes):
            way = row.residual[r] - row.solution[r]  # against what drives prescribe
            row.loss[r] += row.stiffness[r] * row.relaxation[r] * way * way / step
    apply_inverse(bodies, False, system)
    assemble_without_absent(system)
    factor_present(system)
    solve_rows(system, work.velocity)


@implement(close_step, RowSystem)
@kernel(internal=True)
def close_row_step(
    system: RowSystem, all_systems: Systems, bodies: Bodies, joints: Joints, work: Workspace, step: float
) -> None:
    """Forces of the step from all its impulses; rows and velocities are those of its end."""
    lanes = len(system.shape[1])
    add_row_work(bodies, 1.0, work, system)
    complete(bodies, all_systems, False, step, work)
    set_velocity(bodies, step, work)
    _check_closed(system, work)
    spacing = 0.5 * (step + work.control.last_step)
    rate, per_spacing = 1.0 / step, 1.0 / spacing
    for node in range(system.attachments.shape[0] // 2):
        row = system.rows[node]
        for r in range(lanes):
            # of second order in the middle of the step only, and only with the part of the projection
            middle = rate * (2.0 * row.half_impulse[r] + row.impulse[r])
            row.solution[r] = per_spacing * (middle - row.last_reaction[r])
            row.last_reaction[r] = middle
        for vector in range(TURNS + 1):
            _find_reactions(row, lanes, float(vector), step, spacing)
        for r in range(lanes):
            row.slope_before[r] = row.slope[r]
            row.slope[r] = row.solution[r]
    watch_joints(joints, work, system)


@kernel(internal=True)
def _find_reactions(row: Row, lanes: int, vector: float, step: float, spacing: float) -> None:
    """Reactions at the end of the step of the rows of a vector, or of those alone; `solution` has their slopes."""
    if vector == 0.0:
        for r in range(lanes):
            if row.vector[r] == 0.0:
                slope, before, long_before = row.solution[r], row.slope[r], row.slope_before[r]
                row.reaction[r] = steady_force(
                    row.last_reaction[r], slope, before, long_before, step, spacing
                )
        return
    now = before = long_before = square = 0.0
    for r in range(lanes):
        if row.vector[r] == vector:
            turn = row.solution[r] - 2.0 * row.slope[r] + row.slope_before[r]
            square += turn * turn
            now += turn * row.solution[r]
            before += turn * row.slope[r]
            long_before += turn * row.slope_before[r]
    # along the direction in which they change by turns
    along = alternating_slope(now, before, long_before) / square if square > 0.0 else 0.0
    both = steady = steady_before = bend = bend_square = bend_before_square = 0.0
    for r in range(lanes):
        if row.vector[r] == vector:
            part = along * (row.solution[r] - 2.0 * row.slope[r] + row.slope_before[r])
            rest, rest_before = row.solution[r] - part, row.slope[r] + part
            turn, turn_before = rest - rest_before, rest_before - row.slope_before[r] + part
            both += rest * rest_before
            steady += rest * rest
            steady_before += rest_before * rest_before
            bend += turn * turn_before
            bend_square += turn * turn
            bend_before_square += turn_before * turn_before
    share = kept_share(both, steady, steady_before, bend, bend_square, bend_before_square)
    for r in range(lanes):
        if row.vector[r] == vector:
            part = along * (row.solution[r] - 2.0 * row.slope[r] + row.slope_before[r])
            row.reaction[r] = carried_force(row.last_reaction[r], row.solution[r], part, share, step, spacing)


@implement(respond, RowSystem)
@kernel(internal=True)
def respond_row_system(system: RowSystem, velocity: NDArray[np.float64]) -> None:
    """By the factor that is there."""
    respond_rows(system, velocity)


@implement(follow, RowSystem)
@kernel(internal=True)
def follow_contacts(
    system: RowSystem, joints: Joints, at_midpoint: bool, work: Workspace, time: float, step: float
) -> None:
    """One solve more, it is incremental; at the midpoint laws are fitted again if contacts have moved them."""
    solve_rows(system, work.velocity)
    if not (at_midpoint and system.laws):
        return
    work.control.changed = 0
    relinearise(joints, time, step, work, system)
    if work.control.changed > 0:
        assemble(system)
        factor_rows(system)
        fit_laws(system, joints, work, time, step)
        work.control.changed = 1


@kernel(internal=True)
def _check_closed(system: RowSystem, work: Workspace) -> None:
    """Refuse a step that leaves a joint apart, or anything that is not a number."""
    lanes = len(system.shape[1])
    for node in range(system.attachments.shape[0] // 2):
        row = system.rows[node]
        total = 0.0
        for r in range(lanes):
            total += abs(row.rigid[r] * row.residual[r])
        if not total <= 1.0:
            work.status.outcome = NOT_CLOSED
            work.status.block = node


@implement(record_rows, RowSystem)
@kernel(internal=True)
def record_row_system(
    system: RowSystem,
    bodies: Bodies,
    joints: Joints,
    work: Workspace,
    time: float,
    row: NDArray[np.float64],
) -> None:
    """Largest violation of a rigid row, smallest pivot of the last projection, largest drift of a law.

    Joints with compliance store the energy of a spring, whose stretch is the violation of their rows.
    """
    lanes = len(system.shape[1])
    fill_rows(joints, True, work, system)
    set_targets(joints, time, 1.0, False, work, system)  # drives are violated by their value at this time
    add_reactions(system, work.row_force)
    record_joints(joints, time, work, system, row)
    violation = 0.0
    for node in range(system.attachments.shape[0] // 2):
        rows = system.rows[node]
        for r in range(lanes):
            if rows.rigid[r] > 0.0:
                violation = max(violation, abs(rows.residual[r]))
            work.sums.elastic += 0.5 * rows.stiffness[r] * rows.residual[r] ** 2
            work.sums.dissipated += rows.loss[r]
    if system.monitor >= 0:
        out = monitor_outputs(row, system.monitor)
        out.violation, out.pivot, out.carried_drift = violation, smallest_pivot(system), work.sums.drift
