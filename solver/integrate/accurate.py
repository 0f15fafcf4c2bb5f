"""The accurate integrator: DOP853 on the accelerations of the constrained system, for smooth scenes.

Bodies are ordinary differential equations of their positions, quaternions and velocities; joints are
differentiated twice and add the accelerations that keep them (`accurate_rows`). After every step positions
and velocities are projected back onto the joints. Steps follow the tolerance alone: records come from
interpolation (`dense_output`), so the integrator is ahead of them, and what it carries between two calls lives
in an `Integration`.

A step is accepted if its estimated error is a displacement of no more than a tenth of the tolerance: the error
of the velocity of any point of a body, out to its farthest joint, times the longest of the recent steps (times
the step itself, short steps beside a singular position would be allowed any error). Steps end at the corners of
loads and drives, behind which interpolation starts anew.
"""

from __future__ import annotations

import math

from heavylift.numerics.arrays import Floats2
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.outcome import Outcome
from heavylift.solver.combination import PART, combine_part
from heavylift.solver.integrate.dense_output import choose_nodes, node_weights, quadrature_weights
from heavylift.solver.integrate.dop853 import NODES, ORDER, STAGES, write_end, write_errors, write_stage
from heavylift.solver.integrate.integration import (
    END,
    END_RATE,
    FIFTH,
    NEEDED,
    NODE_ROWS,
    QUADRATURES,
    SECOND,
    SLOTS,
    STAGE,
    STATE,
    THIRD,
    VECTORS,
    Integration,
    Progress,
    carried,
    make_integration,
    stiffness_seen,
    watch_stability,
)
from heavylift.solver.integrate.loop import write_record
from heavylift.solver.integrate.state_vector import (
    add_to_nodes,
    displace_poses,
    fastest_spin,
    measure_error,
    write_rates,
    write_second_rates,
    write_velocities,
)
from heavylift.solver.integrate.trees.interface import (
    close_trees,
    evaluate_trees,
    find_tree_spin,
    measure_tree_error,
    store_trees,
    write_second_tree_rates,
    write_tree_velocities,
)
from heavylift.solver.interface import (
    Bodies,
    Forces,
    Joints,
    Systems,
    Workspace,
    add_forces,
    begin_stage,
    complete_accelerations,
    free_acceleration,
    hold_turns,
    joint_rows,
    store_state,
)
from heavylift.solver.rows.accurate import constrain, forget_reactions, project, soften

__all__ = ["Integration", "begin_anew", "make_integration", "run", "stiffness_seen"]

SAFETY, SMALLEST_FACTOR, LARGEST_FACTOR = 0.8, 0.2, 2.0
SHARE = 0.1
"""Of the tolerance, that the error of one step may be: errors of many steps add up, and grow."""

LARGEST_TURN = 1.0
"""Of a body in a step [rad]: errors of steps that turn farther are not what their estimates say. The estimates of a
gyroscope that turned up to two radians a step passed a tolerance of 0.1 mm while it lost half of its energy."""

LEAST_ERROR = 1e-6
MEMORY_DECAY = 0.9
AT_REST_FOR = 100.0
"""Output intervals: what could begin with a longer step is at rest but for rounding, which tells nothing of a step. The
positions tried in steps of days are anywhere, and turns of an angle are counted through them."""

PIECE = 20_000
"""Steps after which a call comes back, so that someone can end the run."""

SHORTEST = 1e-13
"""Shortest step, relative to the time or to the output interval."""

NOT_FINITE, STEP_TOO_SMALL = int(Outcome.NOT_FINITE), int(Outcome.STEP_TOO_SMALL)


@kernel(internal=True)
def _evaluate(
    bodies: Bodies,
    forces: Forces,
    joints: Joints,
    rows: Systems,
    work: Workspace,
    integration: Integration,
    stage: int,
    rate: int,
    time: float,
    with_reactions: bool,
    factored: bool,
) -> None:
    """Rates of the state in one row of the vectors into another row; the factor of its position may be there."""
    progress, values, sums = integration.progress, integration.vectors, work.sums
    size = values.shape[0] // VECTORS
    at, out, end = stage * size, rate * size, (rate + 1) * size - QUADRATURES
    if progress.trees:
        evaluate_trees(
            rows, bodies, forces, joints, rows, work, integration, at, out, time, with_reactions, factored
        )
        return
    begin_stage(bodies, time, values, at, work)
    write_rates(integration.coordinates, values, at, out)
    if progress.loaded:
        for marker in range(work.markers.shape[0]):
            for k in range(3):
                work.markers[marker].force[k] = 0.0
    sums.gravity[0] = sums.gravity[1] = sums.gravity[2] = 0.0
    sums.external_work = sums.drive_work = sums.dissipated = 0.0
    add_forces(forces, time, work)
    free_acceleration(bodies, values, at, work)
    constrain(rows, bodies, joints, integration, at, with_reactions, factored, work, time)
    complete_accelerations(bodies, rows, True, values, out)
    for i in range(work.velocity.shape[0]):
        values[out + i] = work.velocity[i]
    values[end], values[end + 1], values[end + 2] = sums.external_work, sums.drive_work, sums.dissipated


@kernel(internal=True)
def _project(
    bodies: Bodies,
    joints: Joints,
    rows: Systems,
    work: Workspace,
    integration: Integration,
    allowed: float,
    time: float,
) -> None:
    """Close the joints of the state at the end: one Newton step of positions, and velocities in the closed position.

    The factor of that position stays, and serves its accelerations.
    """
    values = integration.vectors
    size = values.shape[0] // VECTORS
    at = END * size
    if integration.progress.trees:
        close_trees(rows, bodies, integration, at, work, time)
        return
    begin_stage(bodies, time, values, at, work)
    for i in range(work.velocity.shape[0]):
        work.velocity[i] = 0.0
    project(rows, bodies, joints, integration, False, allowed, work, time)
    displace_poses(integration.coordinates, values, at, work.velocity)
    _change_nodes(bodies, rows, integration, False)
    begin_stage(bodies, time, values, at, work)
    for i in range(work.velocity.shape[0]):
        work.velocity[i] = values[at + i]
    project(rows, bodies, joints, integration, True, allowed, work, time)
    for i in range(work.velocity.shape[0]):
        values[at + i] = work.velocity[i]
    _change_nodes(bodies, rows, integration, True)


@kernel(internal=True)
def _change_nodes(bodies: Bodies, rows: Systems, integration: Integration, of_velocity: bool) -> None:
    """What the impulses of the rows do to coordinates, or to velocities, of nodes at the end."""
    if integration.progress.based:
        values = integration.vectors
        size = values.shape[0] // VECTORS
        complete_accelerations(bodies, rows, False, values, END_RATE * size)
        add_to_nodes(integration.coordinates, values, END * size, END_RATE * size, of_velocity)


@kernel(internal=True)
def _add_node(rows: Systems, integration: Integration, time: float) -> None:
    """Keep the state at the end with its rates as the newest node."""
    progress, values = integration.progress, integration.vectors
    size = values.shape[0] // VECTORS
    write_second_rates(integration.coordinates, values, END * size, END_RATE * size, SECOND * size)
    write_second_tree_rates(rows, values, END * size, END_RATE * size, SECOND * size)
    slot = (progress.newest + 1) % SLOTS
    progress.newest = slot
    progress.filled = min(progress.filled + 1, SLOTS)
    progress.times[slot] = time
    place = slot * NODE_ROWS * size
    for i in range(NODE_ROWS * size):
        integration.nodes[place + i] = values[END * size + i]


@kernel(internal=True)
def _take_newest(integration: Integration, row: int, count: int) -> None:
    """The newest node into rows of the vectors: its state, or that and its rate."""
    size = integration.vectors.shape[0] // VECTORS
    place = integration.progress.newest * NODE_ROWS * size
    for i in range(count * size):
        integration.vectors[row * size + i] = integration.nodes[place + i]


@kernel(internal=True)
def _begin(
    bodies: Bodies,
    forces: Forces,
    joints: Joints,
    rows: Systems,
    work: Workspace,
    integration: Integration,
    allowed: float,
    time: float,
) -> None:
    """First node of the scene, closed, or first one behind a corner."""
    _take_newest(integration, END, 1)
    closed = not integration.progress.started
    if closed:
        _project(bodies, joints, rows, work, integration, allowed, time)
    _evaluate(bodies, forces, joints, rows, work, integration, END, END_RATE, time, False, closed)
    hold_turns(forces, False)
    integration.progress.filled = 0
    _add_node(rows, integration, time)


@kernel(internal=True)
def _first_step(
    rows: Systems, work: Workspace, integration: Integration, allowed: float, interval: float
) -> float:
    """A step whose error in order 8 is about as allowed [m], from how fast velocities change [s]."""
    length = integration.progress.length
    work.control.error = 0.0
    _measure(rows, work, integration, END_RATE, END_RATE)
    acceleration = work.control.error
    work.control.error = 0.0
    _measure(rows, work, integration, END, END)
    rate = max(math.sqrt(acceleration / length), work.control.error / length)
    if not rate > 0.0:
        return interval
    found = (allowed / length) ** (1.0 / (ORDER + 1)) / rate
    return found if found < AT_REST_FOR * interval else interval


@kernel(internal=True)
def _measure(rows: Systems, work: Workspace, integration: Integration, fifth: int, third: int) -> None:
    """Raise the errors in `work.control` to those that two rows of the vectors tell."""
    values = integration.vectors
    size = values.shape[0] // VECTORS
    measure_error(integration.coordinates, values, fifth * size, third * size, work)
    measure_tree_error(rows, values, fifth * size, third * size, work)


@kernel(internal=True)
def _step(
    bodies: Bodies,
    forces: Forces,
    joints: Joints,
    rows: Systems,
    work: Workspace,
    integration: Integration,
    wanted: float,
    interval: float,
) -> bool:
    """One accepted step; its end becomes the newest node. False if there is none, with the reason in the status."""
    progress, values, control = integration.progress, integration.vectors, work.control
    allowed = min(wanted, progress.largest_error)
    size = values.shape[0] // VECTORS
    if progress.started:  # records were evaluated since
        hold_turns(forces, True)
    if not progress.started or progress.at_corner:
        time = progress.times[progress.newest] if progress.started else 0.0
        _begin(bodies, forces, joints, rows, work, integration, allowed, time)
        if not progress.started:
            control.next_step = _first_step(rows, work, integration, allowed, interval)
        progress.started = True
        progress.at_corner = False
    time = progress.times[progress.newest]
    _take_newest(integration, STATE, 2)
    shortest = SHORTEST * max(abs(time), interval)
    corner = int(control.corner)
    while corner < work.corners.shape[0] and work.corners[corner] <= time + shortest:
        corner += 1
    control.corner = corner
    ahead = work.corners[corner] - time if corner < work.corners.shape[0] else math.inf
    # three nodes are needed between two corners
    rest = 0.5 * ahead if progress.filled < 2 else ahead
    progress.spin = fastest_spin(integration.coordinates, values, STATE * size)
    find_tree_spin(rows, integration, STATE * size)
    spin = progress.spin
    while True:
        h = control.next_step
        if h * spin > LARGEST_TURN:
            h = LARGEST_TURN / spin
        at_corner = h >= rest
        if at_corner:
            h = rest
        last = time + h
        if at_corner and rest == ahead:
            last -= 1e-12 * max(abs(last), h)  # what holds before the corner
        for stage in range(2, STAGES + 1):
            write_stage(values, size, STAGE, stage, h)
            _evaluate(
                bodies,
                forces,
                joints,
                rows,
                work,
                integration,
                STAGE,
                stage,
                min(time + NODES[stage - 1] * h, last),
                False,
                False,
            )
        write_errors(values, size, FIFTH, THIRD)
        control.error = control.pose_error = 0.0
        _measure(rows, work, integration, FIFTH, THIRD)
        error = h * max(max(h, progress.recent_step) * control.error, control.pose_error) / allowed
        if error <= 1.0:
            break
        factor = SMALLEST_FACTOR
        if error < math.inf:
            factor = max(SAFETY * error ** (-1.0 / ORDER), SMALLEST_FACTOR)
        hold_turns(forces, True)
        control.next_step = h * factor
        progress.rejected = True
        progress.rejections += 1
        if h * factor < shortest:
            # `measure_error` left the body
            work.status.outcome = STEP_TOO_SMALL if error < math.inf else NOT_FINITE
            return False
    write_end(values, size, END, h)
    chosen = progress.chosen
    _project(bodies, joints, rows, work, integration, allowed, last)
    if progress.chosen != chosen:  # rows came back: begin anew where they were not needed yet
        control.next_step = SMALLEST_FACTOR * h
        progress.rejections += 1
        progress.at_corner = True
        return True
    _evaluate(bodies, forces, joints, rows, work, integration, END, END_RATE, last, False, True)
    hold_turns(forces, False)
    watch_stability(integration, h)
    time += h
    if at_corner and rest == ahead:
        time = work.corners[corner]
        progress.at_corner = True
    _add_node(rows, integration, time)
    error = max(error, LEAST_ERROR)
    factor = SAFETY * error ** (-1.0 / ORDER)
    if progress.error_before > 0.0:  # what makes the error grow continues
        factor *= min((progress.error_before / error) ** (1.0 / ORDER) * h / control.last_step, 1.0)
    progress.error_before = error
    factor = min(max(factor, SMALLEST_FACTOR), LARGEST_FACTOR)
    if progress.rejected:
        factor = min(factor, 1.0)
    progress.rejected = False
    control.next_step = max(control.next_step, h * factor) if at_corner else h * factor
    progress.recent_step = max(h, MEMORY_DECAY * progress.recent_step)
    control.last_step = h
    control.step_count += 1
    return True


@kernel(internal=True)
def _known_until(progress: Progress) -> float:
    """Latest time at which a record can be interpolated [s]: the end of the last but one step, or a corner."""
    if progress.at_corner:
        return progress.times[progress.newest]
    if progress.filled < NEEDED:
        return -math.inf
    return progress.times[(progress.newest - 1) % SLOTS]


@kernel(internal=True)
def _sample(
    bodies: Bodies,
    forces: Forces,
    joints: Joints,
    rows: Systems,
    work: Workspace,
    integration: Integration,
    time: float,
) -> None:
    """Carried state, works and reactions at a time between the last nodes."""
    progress, values, kept = integration.progress, integration.vectors, integration.nodes
    size = values.shape[0] // VECTORS
    times = progress.times
    a, b, c, d, count = choose_nodes(time, times, progress.newest, progress.filled)
    ta, tb, tc, td = times[a], times[b], times[c], times[d]
    a0, a1, a2, da0, da1, da2 = node_weights(time, ta, (tb, tc, td), count)
    b0, b1, b2, db0, db1, db2 = node_weights(time, tb, (ta, tc, td), count)
    c0 = c1 = c2 = dc0 = dc1 = dc2 = d0 = d1 = d2 = dd0 = dd1 = dd2 = 0.0
    if count > 2:
        c0, c1, c2, dc0, dc1, dc2 = node_weights(time, tc, (ta, tb, td), count)
    if count > 3:
        d0, d1, d2, dd0, dd1, dd2 = node_weights(time, td, (ta, tb, tc), count)
    A, B, C, D = NODE_ROWS * a, NODE_ROWS * b, NODE_ROWS * c, NODE_ROWS * d
    nodes = (A, A + 1, A + 2, B, B + 1, B + 2, C, C + 1, C + 2, D, D + 1, D + 2)
    weights = (a0, a1, a2, b0, b1, b2, c0, c1, c2, d0, d1, d2)
    rates = (da0, da1, da2, db0, db1, db2, dc0, dc1, dc2, dd0, dd1, dd2)
    first = progress.velocities // PART * PART
    for i in range(first, size, PART):
        combine_part(values, END * size + i, kept, i, size, nodes, weights)
        combine_part(values, END_RATE * size + i, kept, i, size, nodes, rates)
    a0, a1 = quadrature_weights(time, ta, (tb, tc, td), count)
    b0, b1 = quadrature_weights(time, tb, (ta, tc, td), count)
    if count > 2:
        c0, c1 = quadrature_weights(time, tc, (ta, tb, td), count)
    if count > 3:
        d0, d1 = quadrature_weights(time, td, (ta, tb, tc), count)
    end = size - QUADRATURES
    for k in range(QUADRATURES):
        progress.works[k] = (
            a0 * kept[end + A * size + k]
            + a1 * kept[end + (A + 1) * size + k]
            + b0 * kept[end + B * size + k]
            + b1 * kept[end + (B + 1) * size + k]
            + c0 * kept[end + C * size + k]
            + c1 * kept[end + (C + 1) * size + k]
            + d0 * kept[end + D * size + k]
            + d1 * kept[end + (D + 1) * size + k]
        )
    if progress.trees:
        write_tree_velocities(rows, values, END * size, END_RATE * size)
    else:
        write_velocities(integration.coordinates, values, END * size, END_RATE * size)
        store_state(bodies, time, values, END * size, work)
    _evaluate(bodies, forces, joints, rows, work, integration, END, END_RATE, time, True, False)
    if progress.trees:
        store_trees(rows, bodies, time, values, END * size, work)


@entry
def begin_anew(
    bodies: Bodies, forces: Forces, joints: Joints, systems: Systems, work: Workspace, time: float
) -> None:
    """Forget what was found behind a record, before something jumps there: its state becomes the newest node.

    Parameters
    ----------
    bodies, forces, joints, systems, work
        As of `run`.
    time
        Of the record [s].
    """
    integration, rows = carried(systems, 0), systems
    progress = integration.progress
    if not progress.started or (progress.at_corner and progress.times[progress.newest] == time):
        return
    _sample(bodies, forces, joints, rows, work, integration, time)
    hold_turns(forces, False)
    size = integration.vectors.shape[0] // VECTORS
    for k in range(QUADRATURES):
        integration.vectors[(END + 1) * size - QUADRATURES + k] = progress.works[k]
    place = progress.newest * NODE_ROWS * size
    for i in range(size):
        integration.nodes[place + i] = integration.vectors[END * size + i]
    progress.times[progress.newest] = time
    progress.filled = 1
    progress.at_corner = True


@entry  # eleven parameters: the scene is five; which steps, how exact and where records go are six
def run(
    bodies: Bodies,
    forces: Forces,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    step: float,
    tolerance: float,
    first: int,
    last: int,
    every: int,
    records: Floats2,
) -> int:
    """Integrate from index `first` to `last`: an index is an output interval, and the steps do not see it.

    Parameters
    ----------
    bodies, forces, joints
        Tuples of kinds.
    systems
        The system of the rows, if there are joints, and the `Integration`.
    work
        Shared arrays.
    step
        Output interval [s].
    tolerance
        Error of the positions that is wanted at the end, about [m].
    first, last
        Indices.
    every
        A record is written after each index that is divisible by this.
    records
        Receives them, shape (rows, columns).

    Returns
    -------
    int
        Last index that was completed. If it is not `last`, `work.status` says why, or `PIECE` steps are done: the next
        call continues with the same bits.
    """
    integration, rows = carried(systems, 0), systems
    progress = integration.progress
    for i in range(joint_rows(rows)):
        soften(joint_rows(rows, i), integration, False)
        forget_reactions(joint_rows(rows, i))
    if not progress.started:  # reactions of the first record
        _take_newest(integration, END, 1)
        _evaluate(bodies, forces, joints, rows, work, integration, END, END_RATE, 0.0, True, False)
    row = taken = 0
    for index in range(first, last):
        time = (index + 1) * step
        while _known_until(progress) < time:
            if taken == PIECE:
                return index
            if progress.steps == progress.most_steps:
                work.status.outcome = STEP_TOO_SMALL
                return index
            if not _step(bodies, forces, joints, rows, work, integration, SHARE * tolerance, step):
                return index
            taken += 1
            progress.steps += 1
        progress.steps = 0
        if (index + 1) % every == 0:
            _sample(bodies, forces, joints, rows, work, integration, time)
            write_record(bodies, forces, joints, systems, work, time, records[row])
            row += 1
    return last
