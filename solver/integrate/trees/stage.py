"""Trees in the accurate integrator: evaluations, coordinates, errors, records."""

from __future__ import annotations

import math

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.rotation import quaternion_product
from heavylift.numerics.vectors import (
    Vector,
    add,
    add_scaled,
    cross,
    dot,
    rotate,
    scaled,
    subtract,
    vector,
    vector_at,
)
from heavylift.solver.integrate.integration import END_RATE, QUADRATURES, VECTORS, Integration
from heavylift.solver.integrate.state_vector import squared_error
from heavylift.solver.integrate.trees.forest import (
    BALL,
    DISTANCE,
    FIXED,
    FLOATING,
    HINGE,
    SLIDER,
    Forest,
    TreeBody,
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
from heavylift.solver.integrate.trees.loops import (
    add_answers,
    answer_rows,
    choose_rows,
    factor_loops,
    move_coordinates,
    row_acceleration,
    row_rate,
    solve_loops,
)
from heavylift.solver.integrate.trees.record import note_joints
from heavylift.solver.integrate.trees.sweeps import (
    ZERO,
    accelerate,
    direction_of,
    gather_inward,
    joint_wrench,
    own_quaternion,
    pose_outward,
    put,
    see_bodies,
)
from heavylift.solver.interface import (
    Bodies,
    Forces,
    Joints,
    Systems,
    Workspace,
    add_forces,
    begin_stage,
    fill_bias,
    fill_rows,
    free_acceleration,
    store_state,
)
from heavylift.solver.kinds import implement
from heavylift.solver.rows.accurate import constrain

__all__: list[str] = []

CLOSINGS = 3
"""Of positions, at most: of the second on, rows are chosen anew."""

OPEN = 1e-7
"""Of a row that was left out, relative to a gap with which a run has failed, from which on it is needed."""


@implement(evaluate_trees, Forest)
@kernel(internal=True)
def evaluate_forest(
    forest: Forest,
    bodies: Bodies,
    forces: Forces,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    integration: Integration,
    at: int,
    out: int,
    time: float,
    with_reactions: bool,
    factored: bool,
) -> None:
    """Bodies are looked at only if forces or rows need them; loads come as what they would accelerate a body alone.

    Where loops are to give their reactions, there are no rates.
    """
    values, sums, loaded = integration.vectors, work.sums, forest.loaded
    looped = forest.loops.shape[0] > 0
    pose_outward(forest, values, at)
    if with_reactions and looped:
        see_bodies(forest, values, at)
        begin_stage(bodies, time, forest.poses, 0, work)
    elif loaded or looped:
        see_bodies(forest, values, at)
        begin_stage(forest.seen, time, forest.poses, 0, work)
    sums.gravity[0] = sums.gravity[1] = sums.gravity[2] = 0.0
    sums.external_work = sums.drive_work = sums.dissipated = 0.0
    if loaded:
        for i in range(forest.pushed.shape[0]):
            put(work.markers[forest.pushed[i]].force, ZERO)
    add_forces(forces, time, work)
    if with_reactions and looped:  # of all rows, since those that follow from others share
        free_acceleration(bodies, forest.poses, 0, work)
        constrain(systems, bodies, joints, integration, at, True, False, work, time)
        return
    gravity = vector(sums.gravity)
    if loaded:
        free_acceleration(forest.seen, forest.poses, 0, work)
        _add_loads(forest, work)
        gravity = ZERO
    gather_inward(forest)
    accelerate(forest, gravity, values, out)
    if looped:
        _hold_loops(forest, gravity, values, out, factored, work, time)
    _write_rates(forest, values, at, out)
    end = out + values.shape[0] // VECTORS - QUADRATURES
    values[end], values[end + 1], values[end + 2] = sums.external_work, sums.drive_work, sums.dissipated
    if with_reactions and forest.recorded.shape[0] > 0:
        note_joints(forest, values, at)
    elif with_reactions:
        _find_reactions(forest, values, at)


@kernel(internal=True)
def _add_loads(forest: Forest, work: Workspace) -> None:
    """Biases from the accelerations of the bodies alone, gravity and gyroscopic parts included."""
    for i in range(forest.bodies.shape[0]):
        one = forest.bodies[i]
        c, w, m = vector(one.to_centre), vector(one.spin), one.mass
        pushed = subtract(cross(w, cross(w, c)), vector_at(work.velocity, one.dof))
        force = scaled(m, pushed)
        turned = vector_at(work.velocity, one.dof + 3)
        I = one.inertia
        moment = rotate(one.R, (I[0] * turned[0], I[1] * turned[1], I[2] * turned[2]))
        put(one.force, force)
        put(one.moment, subtract(cross(c, force), moment))


@kernel(inline=True, internal=True)
def _write_rates(forest: Forest, values: Floats1, at: int, out: int) -> None:
    """Of the coordinates: the velocities, and ``q' = q o (0, w)/2``."""
    if not forest.spun:  # coordinates follow their velocities one by one
        for i in range(forest.velocities):
            values[out + forest.velocities + i] = values[at + i]
        return
    for i in range(forest.bodies.shape[0]):
        one = forest.bodies[i]
        place, speed = forest.velocities + one.place, one.speed
        if one.joint <= SLIDER:
            values[out + place] = values[at + speed]
        elif one.joint >= BALL:
            if one.joint != BALL:
                for k in range(3):
                    values[out + place + k] = values[at + speed + k]
                place, speed = place + 3, speed + 3
            q1, q2, q3 = vector_at(values, at + place + 1)
            q0, (w1, w2, w3) = values[at + place], vector_at(values, at + speed)
            values[out + place] = -0.5 * (q1 * w1 + q2 * w2 + q3 * w3)
            values[out + place + 1] = 0.5 * (q0 * w1 + q2 * w3 - q3 * w2)
            values[out + place + 2] = 0.5 * (q0 * w2 + q3 * w1 - q1 * w3)
            values[out + place + 3] = 0.5 * (q0 * w3 + q1 * w2 - q2 * w1)


@implement(write_second_tree_rates, Forest)
@kernel(internal=True)
def write_second_forest_rates(forest: Forest, values: Floats1, at: int, rate: int, second: int) -> None:
    """Accelerations, and ``q'' = ( q' o (0, w) + q o (0, w') )/2``."""
    for i in range(forest.bodies.shape[0]):
        one = forest.bodies[i]
        place, speed = forest.velocities + one.place, one.speed
        if one.joint <= SLIDER:
            values[second + place] = values[rate + speed]
        elif one.joint >= BALL:
            if one.joint != BALL:
                for k in range(3):
                    values[second + place + k] = values[rate + speed + k]
                place, speed = place + 3, speed + 3
            q, turn = values[at + place : at + place + 4], values[rate + place : rate + place + 4]
            w, a = vector_at(values, at + speed), vector_at(values, rate + speed)
            bend = quaternion_product((turn[0], turn[1], turn[2], turn[3]), (0.0, w[0], w[1], w[2]))
            drift = quaternion_product((q[0], q[1], q[2], q[3]), (0.0, a[0], a[1], a[2]))
            for k in range(4):
                values[second + place + k] = 0.5 * (bend[k] + drift[k])


@implement(write_tree_velocities, Forest)
@kernel(internal=True)
def write_forest_velocities(forest: Forest, values: Floats1, at: int, rate: int) -> None:
    """The rates themselves, and ``w = 2 q* o q'``."""
    for i in range(forest.bodies.shape[0]):
        one = forest.bodies[i]
        place, speed = forest.velocities + one.place, at + one.speed
        if one.joint <= SLIDER:
            values[speed] = values[rate + place]
        elif one.joint >= BALL:
            if one.joint != BALL:
                for k in range(3):
                    values[speed + k] = values[rate + place + k]
                if one.joint == DISTANCE:
                    put_direction(values, at + place, speed)
                place, speed = place + 3, speed + 3
            p, r = values[at + place : at + place + 4], values[rate + place : rate + place + 4]
            size = 1.0 / math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3])
            q = (size * p[0], size * p[1], size * p[2], size * p[3])
            back = (2.0 * size * q[0], -2.0 * size * q[1], -2.0 * size * q[2], -2.0 * size * q[3])
            w = quaternion_product(back, (r[0], r[1], r[2], r[3]))
            for k in range(3):
                values[speed + k] = w[1 + k]
            for k in range(4):
                p[k] = q[k]


@kernel(internal=True)
def _hold_loops(
    forest: Forest, gravity: Vector, values: Floats1, out: int, factored: bool, work: Workspace, time: float
) -> None:
    """Accelerations that keep the rows which no joint of a tree replaces."""
    if not factored:
        fill_rows(forest.joints, False, work, forest.rows)
        answer_rows(forest, False)
        factor_loops(forest)
    fill_bias(forest.joints, time, work, forest.rows)
    for i in range(forest.order[forest.loops.shape[0]]):
        row = forest.loops[forest.order[i]]
        target = forest.rows.rows[row.block].target
        row.target = target[row.row] - row_acceleration(forest, row, gravity)
    solve_loops(forest)
    add_answers(forest, values, out)


@kernel(inline=True, internal=True)
def _look_at_loops(forest: Forest, integration: Integration, at: int, work: Workspace, time: float) -> None:
    """Rows and residuals of a state vector."""
    values = integration.vectors
    pose_outward(forest, values, at)
    see_bodies(forest, values, at)
    begin_stage(forest.seen, time, forest.poses, 0, work)
    fill_rows(forest.joints, True, work, forest.rows)


@kernel(internal=True)
def _largest_gap(forest: Forest) -> tuple[float, float]:
    """Of the rows that are left out, relative to one with which a run has failed; and in m or rad."""
    gap = opening = 0.0
    for i in range(forest.loops.shape[0]):
        row = forest.loops[i]
        if not row.kept:
            of_block = forest.rows.rows[row.block]
            gap = max(gap, abs(of_block.rigid[row.row] * of_block.residual[row.row]))
            opening = max(opening, abs(of_block.residual[row.row]))
    return gap, opening


@kernel(internal=True)
def _close_loops(forest: Forest, integration: Integration, at: int, work: Workspace, time: float) -> None:
    """A Newton step of the positions, in which rows are chosen anew if one that was left out opens; velocities.

    The factor of the closed position stays.
    """
    values, rate = integration.vectors, END_RATE * (integration.vectors.shape[0] // VECTORS)
    _look_at_loops(forest, integration, at, work, time)
    for attempt in range(CLOSINGS):
        gather_inward(forest)
        if attempt > 0 or forest.loops[0].kept < 0:
            choose_rows(forest)
        answer_rows(forest, False)
        factor_loops(forest)
        for i in range(forest.order[forest.loops.shape[0]]):
            row = forest.loops[forest.order[i]]
            row.target = -forest.rows.rows[row.block].residual[row.row]
        solve_loops(forest)
        for i in range(forest.velocities):
            values[rate + i] = 0.0
        add_answers(forest, values, rate)
        move_coordinates(forest, values, at, values, rate)
        _look_at_loops(forest, integration, at, work, time)
        gap, opening = _largest_gap(forest)
        if gap < OPEN:
            break
        if attempt == CLOSINGS - 1:  # no choice of rows closes all
            integration.progress.left_open = max(integration.progress.left_open, opening)
    gather_inward(forest)
    answer_rows(forest, False)
    factor_loops(forest)
    for i in range(forest.order[forest.loops.shape[0]]):
        row = forest.loops[forest.order[i]]
        row.target = -row_rate(forest, row)
    solve_loops(forest)
    add_answers(forest, values, at)


@kernel(inline=True, internal=True)
def put_direction(values: Floats1, place: int, speed: int) -> None:
    """Direction of a distance at unit length, and its rate across it."""
    e, rate = direction_of(values, place, speed)
    for k in range(3):
        values[place + k], values[speed + k] = e[k], rate[k]


@implement(close_trees, Forest)
@kernel(internal=True)
def close_forest(
    forest: Forest, bodies: Bodies, integration: Integration, at: int, work: Workspace, time: float
) -> None:
    """Joints of trees never open."""
    if forest.loops.shape[0] > 0:
        _close_loops(forest, integration, at, work, time)
    if not forest.spun:
        return
    values = integration.vectors
    for i in range(forest.bodies.shape[0]):
        one = forest.bodies[i]
        if one.joint >= BALL:
            place = at + forest.velocities + one.place
            if one.joint == DISTANCE:
                put_direction(values, place, at + one.speed)
            place += 0 if one.joint == BALL else 3
            q = own_quaternion(values, place)
            values[place], values[place + 1], values[place + 2], values[place + 3] = q


@implement(find_tree_spin, Forest)
@kernel(internal=True)
def find_forest_spin(forest: Forest, integration: Integration, at: int) -> None:
    """Of hinges the rate of their angle."""
    progress, values = integration.progress, integration.vectors
    largest = 0.0
    for i in range(forest.bodies.shape[0]):
        one = forest.bodies[i]
        speed = at + one.speed
        if one.joint == HINGE:
            largest = max(largest, values[speed] * values[speed])
        elif one.joint >= BALL:
            w = vector_at(values, speed if one.joint == BALL else speed + 3)
            largest = max(largest, dot(w, w))
    progress.spin = max(progress.spin, math.sqrt(largest))


@implement(measure_tree_error, Forest)
@kernel(internal=True)
def measure_forest_error(forest: Forest, values: Floats1, fifth: int, third: int, work: Workspace) -> None:
    """Errors of joints go outward: what counts is the error of a point of a body, out to its reach."""
    control = work.control
    for i in range(forest.bodies.shape[0]):
        one = forest.bodies[i]
        turn5, move5 = _error_outward(forest, one, values, fifth, 0)
        turn3, move3 = _error_outward(forest, one, values, third, 1)
        square = one.reach * one.reach
        e5, e3 = (
            dot(move5, move5) + square * dot(turn5, turn5),
            dot(move3, move3) + square * dot(turn3, turn3),
        )
        error = math.sqrt(squared_error(e5, e3))
        if error > control.error or math.isnan(error):  # which stays
            control.error = error
            work.status.body = one.number
        if one.joint >= BALL:
            place = forest.velocities + one.place + (0 if one.joint == BALL else 3)
            e5 = e3 = 0.0
            for k in range(place, place + 4):
                e5 += values[fifth + k] ** 2
                e3 += values[third + k] ** 2
            control.pose_error = max(control.pose_error, 2.0 * one.reach * math.sqrt(squared_error(e5, e3)))


@kernel(inline=True, internal=True)
def _error_outward(
    forest: Forest, one: TreeBody, values: Floats1, at: int, order: int
) -> tuple[Vector, Vector]:
    """Errors of the spin and of the velocity of the centre of mass of a body."""
    speed, turn, move = at + one.speed, ZERO, ZERO
    kept = one.error3 if order == 1 else one.error5
    if one.parent >= 0:
        above = forest.bodies[one.parent]
        known = above.error3 if order == 1 else above.error5
        turn = known[0], known[1], known[2]
        move = add((known[3], known[4], known[5]), cross(turn, one.arm))
    if one.joint == HINGE:
        turn = add_scaled(turn, values[speed], one.along)
    elif one.joint == SLIDER:
        move = add_scaled(move, values[speed], one.along)
    elif one.joint == BALL:
        turn = rotate(one.R, vector_at(values, speed))
    elif one.joint == DISTANCE:
        move = add_scaled(move, one.length, vector_at(values, speed))
        turn = rotate(one.R, vector_at(values, speed + 3))
    elif one.joint == FLOATING:
        turn = rotate(one.R, vector_at(values, speed + 3))
        move = subtract(vector_at(values, speed), cross(turn, one.to_centre))
    for k in range(3):
        kept[k], kept[3 + k] = turn[k], move[k]
    return turn, add(move, cross(turn, one.to_centre))


@implement(store_trees, Forest)
@kernel(internal=True)
def store_forest(
    forest: Forest, bodies: Bodies, time: float, values: Floats1, at: int, work: Workspace
) -> None:
    """Bodies as their kind reads them; their rotations are those of the last evaluation."""
    see_bodies(forest, values, at)
    store_state(bodies, time, forest.poses, 0, work)


@kernel(internal=True)
def _find_reactions(forest: Forest, values: Floats1, at: int) -> None:
    """Reactions of the rows from what each joint exerts on its body b, of which they are components.

    With the axes of the joint frame, which is closed, and force F and moment N at the point of b::

        point    l = F;      travel d    l = d . F
        parallel z:          N = l1 x x z + l2 y x z,    l1 = -y . N,  l2 = x . N
        square x y:          N = l y x x,                l = -z . N
    """
    for i in range(forest.bodies.shape[0]):
        one = forest.bodies[i]
        if one.joint == FLOATING:
            continue
        n, f = joint_wrench(one)
        x, y = vector(one.x), vector(one.y)
        if one.sign > 0.0:
            x, y = rotate(one.R, x), rotate(one.R, y)
        else:
            if one.joint == SLIDER:
                travel = values[at + forest.velocities + one.place]
                n = add_scaled(n, travel, cross(one.along, f))
            n, f = scaled(-1.0, n), scaled(-1.0, f)
            if one.parent >= 0:
                above = forest.bodies[one.parent]
                x, y = rotate(above.R, x), rotate(above.R, y)
        reaction, first = forest.rows.rows[one.block].reaction, 3
        if one.joint == DISTANCE:
            reaction[0] = dot(one.along, f) * one.sign
            continue
        if one.joint == SLIDER:
            reaction[0], reaction[1], first = dot(x, f), dot(y, f), 2
        else:
            reaction[0], reaction[1], reaction[2] = f
        if one.joint <= FIXED:
            reaction[first], reaction[first + 1] = -dot(y, n), dot(x, n)
            if one.joint != HINGE:
                reaction[first + 2] = -dot(cross(x, y), n)
