"""Paths of transporters: the place of a vehicle in the plane and its heading are driven; what its bogies give for it.

The decks under a vehicle may move, each by itself. Each body j that carries some has a plan that moves along with it,
in which the middle of the bogies is at (x_j, y_j) and its axis f has the heading with the sine Y_j . f. With weights
w_j, which follow the shares of the bodies in the load with the delay T, three rows keep the mean of all plans on the
path (x, y, psi)(t)::

    sum w_j x_j - x = 0 ,    sum w_j y_j - y = 0 ,    sum w_j (cos psi Y_j - sin psi X_j) . f = 0
    T w_j' = share_j - w_j

so a vehicle that has rolled from one body to another one belongs to that in the end, without a jump. The weights change
within a step by what is known when it begins, and the rows ask for the rates that this takes.

Driven bogies push with one force F, as motors with a common pressure do. With the rates by way, r of the pose and v_i
of the wheels, what the reaction R of the rows and the loads f_i need is ::

    F sum |v_i| = R . r + sum f_i (z_i' + c |v_i|)

over driven bogies on the left, all of them on the right: z_i' is how the road lifts a wheel and c the rolling
resistance.
"""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats2, Ints2
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, Records, Vector
from heavylift.solver.extremes import Extremes, largest_of, note_value, smallest_of
from heavylift.solver.interface import (
    Workspace,
    fill_rows,
    record_joints,
    set_targets,
    update_rows,
    watch_joints,
)
from heavylift.solver.joints.row_writing import add_direction_row, dot, minus, residuals, targets, vector
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at, part
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.transport import DriveOutputs, PathOutputs, SteeringParts
from heavylift.solver.transport.lever_arms import PlaceData, add_place_row, place
from heavylift.solver.transport.path_distances import way_on_pieces
from heavylift.solver.transport.transporters import BogieState

__all__ = [
    "DriveData",
    "DriveState",
    "Largest",
    "PathBogie",
    "PathData",
    "PathPlan",
    "PathState",
    "Paths",
    "PlanState",
    "distance_at",
    "drive_capacity",
    "drive_outputs",
    "hermite",
    "path_outputs",
    "pose_at",
    "record_drive",
    "rolling_at",
    "row_before",
    "tell_steering",
    "watch_drive",
    "weigh_plans",
]

LEAST_LOAD = 1e-3
"""Of the force of a bogie: less load on the road counts as this, so what is in the air is used a thousandfold."""


class PathData(Record):
    """A path.

    Attributes
    ----------
    block, attachments
        Of its rows.
    column, parts, drive_column
        First record column, where what is recorded of its bogies is, and first record column of its drive.
    middle, forward, side
        The middle of the bogies, marker of the axis of the vehicle, and the side of the rows on which it is.
    first_plan, plans
        Bodies with decks.
    first_node, nodes, first_piece, pieces
        Its route, see `heavylift.solver.transport.routes`.
    first_bogie, bogies
        Of the vehicle.
    delay
        T [s].
    weight
        Of a bogie [N].
    drive, driven
        Number of its drive, -1 without; how many bogies it drives.
    tells
        Whether a deck asks for how bogies are steered.
    """

    block: int
    attachments: int
    column: int
    parts: SteeringParts
    drive_column: int
    middle: PlaceData
    forward: int
    side: int
    first_plan: int
    plans: int
    first_node: int
    nodes: int
    first_piece: int
    pieces: int
    first_bogie: int
    bogies: int
    delay: float
    weight: float
    drive: int
    driven: int
    tells: bool


class Largest(Record):
    """Largest value so far, and when [s]."""

    value: float
    time: float


class DriveState(Record):
    """What a drive carries.

    Attributes
    ----------
    force, traction, power, brake
        Force of a driven bogie in the middle of the last step [N], and shares of what wheels, motors and brakes can do
        at most.
    forces, tractions, powers, brakes
        Their extremes.
    time
        At the end of the step [s].
    most_traction, most_power, most_brake
        Largest shares of the run, and when.
    """

    force: float
    traction: float
    power: float
    brake: float
    forces: Extremes
    tractions: Extremes
    powers: Extremes
    brakes: Extremes
    time: float
    most_traction: Largest
    most_power: Largest
    most_brake: Largest


class PathState(DriveState):
    """What a path and its drive carry.

    Attributes
    ----------
    yaw, step, moved, way
        Heading about which the rows are written [rad], length of the last step [s], way in it and at its end [m].
    advance
        By which the rows moved in the last step [m, m, rad].
    work, loss
        Of the rows before the last step, and against rolling [J].
    """

    yaw: float
    step: float
    moved: float
    way: float
    advance: Vector
    work: float
    loss: float


class PathPlan(Record):
    """The plan of a body with decks: markers of its origin and axes, and the side of the rows; -1 of the ground."""

    origin: int
    x: int
    y: int
    side: int


class PlanState(Record):
    """Weight of a plan at the end of the last step, and of this one; in the rows; load on its decks [N]."""

    weight: float
    next_weight: float
    used: float
    load: float


class PathBogie(Record):
    """A bogie: its place from the middle of all, along and to the left [m]; whether it is driven."""

    x: float
    y: float
    driven: bool


class DriveData(Record):
    """A drive: resistance, friction, force of the brakes [N], and its table."""

    resistance: float
    friction: float
    brake: float
    first: int
    count: int


path_outputs, drive_outputs = outputs_at(PathOutputs), outputs_at(DriveOutputs)


class Paths(Arrays):
    """All paths of a scene.

    Attributes
    ----------
    table, plans, bogies, drives
        The description.
    nodes, pieces, capacity
        Routes; speed and force of drives, shape (n, 2).
    legs
        Number of the path, and what `heavylift.solver.transport.routes.Route` says of its legs, shape (legs, 5).
    turns
        Half turns of the wheels by leg and bogie [rad]: legs of all paths one below the other, as the last column of
        `nodes` counts.
    deck_plans
        Number of the plan, within those of a path, of each deck; shape (paths, decks).
    state, plan_state
        Carried.
    bogie_state, steering
        Of the transporters.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state", "plan_state")

    table: Records[PathData]
    plans: Records[PathPlan]
    bogies: Records[PathBogie]
    drives: Records[DriveData]
    nodes: Floats2
    pieces: Floats2
    capacity: Floats2
    legs: Floats2
    turns: Floats2
    deck_plans: Ints2
    state: Records[PathState]
    plan_state: Records[PlanState]
    bogie_state: Records[BogieState]
    steering: Floats2


# ---- the route ----


@kernel(internal=True)
def row_before(table: NDArray[np.float64], first: int, count: int, value: float) -> int:
    """Last row whose first column is not above a value, but not the last of all."""
    low, high = first, first + count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if table[middle, 0] <= value:
            low = middle
        else:
            high = middle
    return low


@kernel(internal=True)
def distance_at(kind: Paths, path: PathData, time: float) -> tuple[float, float]:
    """Way [m] and speed [m/s] at a time."""
    way, speed, _ = way_on_pieces(kind.pieces, path.first_piece, path.pieces, time)
    return way, speed


@kernel(internal=True)
def hermite(h: float, t: float, a: float, slope_a: float, b: float, slope_b: float) -> tuple[float, float]:
    """Cubic between two values with slopes, t from 0 to 1 over the length h; value and slope."""
    rise = b - a
    bend, twist = 3.0 * rise - h * (2.0 * slope_a + slope_b), h * (slope_a + slope_b) - 2.0 * rise
    value = a + t * (h * slope_a + t * (bend + t * twist))
    return value, slope_a + t * (2.0 * bend + 3.0 * t * twist) / h


@kernel(internal=True)
def pose_at(
    kind: Paths, path: PathData, way: float
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Pose of the middle at a way [m, rad] and its rates by way."""
    i = row_before(kind.nodes, path.first_node, path.nodes, way)
    h = kind.nodes[i + 1, 0] - kind.nodes[i, 0]
    t = min(max((way - kind.nodes[i, 0]) / h, 0.0), 1.0)
    x = hermite(h, t, kind.nodes[i, 1], kind.nodes[i, 4], kind.nodes[i + 1, 1], kind.nodes[i + 1, 4])
    y = hermite(h, t, kind.nodes[i, 2], kind.nodes[i, 5], kind.nodes[i + 1, 2], kind.nodes[i + 1, 5])
    yaw = hermite(h, t, kind.nodes[i, 3], kind.nodes[i, 6], kind.nodes[i + 1, 3], kind.nodes[i + 1, 6])
    return (x[0], y[0], yaw[0]), (x[1], y[1], yaw[1])


@kernel(internal=True)
def rolling_at(kind: Paths, path: PathData, way: float, bogie: int) -> tuple[float, float, float]:
    """Velocity of a bogie by way, along and to the left of the vehicle, and the half turns of its wheels [rad]."""
    i = row_before(kind.nodes, path.first_node, path.nodes, way)
    h = kind.nodes[i + 1, 0] - kind.nodes[i, 0]
    t = min(max((way - kind.nodes[i, 0]) / h, 0.0), 1.0)
    slip, _ = hermite(h, t, kind.nodes[i, 7], kind.nodes[i, 8], kind.nodes[i + 1, 7], kind.nodes[i + 1, 8])
    speed = kind.nodes[i, 9]
    turn = kind.nodes[i, 6] + t * (kind.nodes[i + 1, 6] - kind.nodes[i, 6])
    x, y = kind.bogies[bogie].x - kind.nodes[i, 10], kind.bogies[bogie].y - kind.nodes[i, 11]
    half = kind.turns[int(kind.nodes[i, 12]), bogie]
    return speed * math.cos(slip) - turn * y, speed * math.sin(slip) + turn * x, half


@kernel(internal=True)
def tell_steering(kind: Paths, path: PathData, way: float, moved: float) -> None:
    """Tell bogies how they are steered at the start of the next step, and how they turn in it if it is as this one.

    Between two legs they turn at rest: what that lifts them is no slope that the drive climbs within the step.
    """
    here = row_before(kind.nodes, path.first_node, path.nodes, way)
    there = row_before(kind.nodes, path.first_node, path.nodes, way + moved)
    ahead = way + moved if kind.nodes[here, 12] == kind.nodes[there, 12] else way
    for i in range(path.first_bogie, path.first_bogie + path.bogies):
        u, v, _ = rolling_at(kind, path, way, i)
        a, b, _ = rolling_at(kind, path, ahead, i)
        kind.steering[i, 0] = math.atan2(v, u)
        kind.steering[i, 1] = math.atan2(u * b - v * a, u * a + v * b)


# ---- rows ----


@kernel(internal=True)
def _write_rows(kind: Paths, number: int, work: Workspace, system: RowArrays) -> None:
    """Rows with the weights in use, about the heading in use."""
    path, lanes = kind.table[number], system.lanes
    for side in range(2 * path.block, 2 * path.block + path.attachments):
        panel = system.attachments[side].panel
        for k in range(system.attachments[side].width):
            for r in range(3):
                system.panels[panel + k * lanes + r] = 0.0
    c, s = math.cos(kind.state[number].yaw), math.sin(kind.state[number].yaw)
    f = vector(work, path.forward)
    for j in range(path.first_plan, path.first_plan + path.plans):
        plan, w = kind.plans[j], kind.plan_state[j].used
        if w == 0.0:
            continue
        x, y = vector(work, plan.x), vector(work, plan.y)
        across = (w * (c * y[0] - s * x[0]), w * (c * y[1] - s * x[1]), w * (c * y[2] - s * x[2]))
        add_place_row(system, path.side, 0, work, path.middle, (w * x[0], w * x[1], w * x[2]))
        add_place_row(system, path.side, 1, work, path.middle, (w * y[0], w * y[1], w * y[2]))
        add_direction_row(system, path.side, 2, work, path.forward, across)
        if plan.side < 0:
            continue
        d = minus(place(work, path.middle), vector(work, plan.origin))
        add_direction_row(system, plan.side, 0, work, plan.origin, (-w * x[0], -w * x[1], -w * x[2]))
        add_direction_row(system, plan.side, 0, work, plan.x, (w * d[0], w * d[1], w * d[2]))
        add_direction_row(system, plan.side, 1, work, plan.origin, (-w * y[0], -w * y[1], -w * y[2]))
        add_direction_row(system, plan.side, 1, work, plan.y, (w * d[0], w * d[1], w * d[2]))
        a, b = -w * s, w * c
        add_direction_row(system, plan.side, 2, work, plan.x, (a * f[0], a * f[1], a * f[2]))
        add_direction_row(system, plan.side, 2, work, plan.y, (b * f[0], b * f[1], b * f[2]))


@kernel(internal=True)
def _place(kind: Paths, number: int, j: int, work: Workspace) -> tuple[tuple[float, float, float], float]:
    """Place on a plan [m] and what the third row is of it; cosine of the angle between headings."""
    path, plan = kind.table[number], kind.plans[j]
    c, s = math.cos(kind.state[number].yaw), math.sin(kind.state[number].yaw)
    x, y, f = vector(work, plan.x), vector(work, plan.y), vector(work, path.forward)
    d = minus(place(work, path.middle), vector(work, plan.origin))
    ahead, aside = dot(x, f), dot(y, f)
    return (dot(d, x), dot(d, y), c * aside - s * ahead), c * ahead + s * aside


@kernel(internal=True)
def weigh_plans(kind: Paths, number: int) -> float:
    """Loads on the plans of a path now [N]; their sum."""
    path, total = kind.table[number], 0.0
    for j in range(path.first_plan, path.first_plan + path.plans):
        kind.plan_state[j].load = 0.0
    for i in range(path.first_bogie, path.first_bogie + path.bogies):
        bogie = kind.bogie_state[i]
        j = path.first_plan + kind.deck_plans[number, bogie.deck]
        kind.plan_state[j].load += bogie.load
        total += bogie.load
    return total


@implement(fill_rows, Paths)
@kernel(internal=True)
def fill_path_rows(kind: Paths, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows as they were written last; what they are wrong by is known with the time, see `set_path_targets`."""
    for p in range(kind.table.shape[0]):
        _write_rows(kind, p, work, system)


@implement(set_targets, Paths)
@kernel(internal=True)
def set_path_targets(
    kind: Paths, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """Follow the route; weights of the step."""
    for p in range(kind.table.shape[0]):
        path, state = kind.table[p], kind.state[p]
        total = weigh_plans(kind, p)
        target = targets(system, path.block)
        before, speed = distance_at(kind, path, time)
        here, rates = pose_at(kind, path, before)
        if at_midpoint:
            last = system.rows[path.block].last_reaction
            for k in range(3):
                state.work += last[k] * state.advance[k]
            after, _ = distance_at(kind, path, time + step)
            there, _ = pose_at(kind, path, after)
            state.yaw, state.step, state.moved = 0.5 * (here[2] + there[2]), step, after - before
            state.way, state.time = after, time + step
            part = -math.expm1(-step / path.delay)
            ahead, a, b, c = 0.0, 0.0, 0.0, 0.0
            for j in range(path.first_plan, path.first_plan + path.plans):
                plan = kind.plan_state[j]
                share = plan.load / total if total > 0.0 else plan.weight
                plan.next_weight = plan.weight + part * (share - plan.weight)
                plan.used = 0.5 * (plan.weight + plan.next_weight)
                gain = plan.next_weight - plan.weight
                at, cosine = _place(kind, p, j, work)
                ahead += plan.used * cosine
                a, b, c = a + gain * at[0], b + gain * at[1], c + gain * at[2]
            state.advance[0] = there[0] - here[0] - a
            state.advance[1] = there[1] - here[1] - b
            state.advance[2] = (there[2] - here[2]) * ahead - c
            _write_rows(kind, p, work, system)
            for k in range(3):
                target[k] += state.advance[k] / step
            if path.tells:
                tell_steering(kind, path, after, after - before)
            continue
        state.yaw = here[2]
        residual = residuals(system, path.block)
        ahead, a, b, c = 0.0, -here[0], -here[1], 0.0
        u, v, w = speed * rates[0], speed * rates[1], 0.0
        for j in range(path.first_plan, path.first_plan + path.plans):
            plan = kind.plan_state[j]
            plan.used = plan.weight
            share = plan.load / total if total > 0.0 else plan.weight
            gain = (share - plan.weight) / path.delay
            at, cosine = _place(kind, p, j, work)
            ahead += plan.used * cosine
            a, b, c = a + plan.used * at[0], b + plan.used * at[1], c + plan.used * at[2]
            u, v, w = u - gain * at[0], v - gain * at[1], w - gain * at[2]
        _write_rows(kind, p, work, system)
        residual[0], residual[1], residual[2] = a, b, c
        target[0], target[1], target[2] = u, v, speed * rates[2] * ahead + w


@implement(update_rows, Paths)
@kernel(internal=True)
def update_paths(kind: Paths, time: float, step: float, work: Workspace, system: RowArrays) -> None:
    """Carry the weights over the step."""
    for j in range(kind.plans.shape[0]):
        kind.plan_state[j].weight = kind.plan_state[j].next_weight


# ---- drives and records ----


@kernel(internal=True)
def drive_capacity(kind: Paths, drive: DriveData, speed: float) -> float:
    """Largest force of a driven bogie at a speed of its wheel [N]."""
    if drive.count == 0:
        return math.inf
    for i in range(drive.first, drive.first + drive.count - 1):
        a, b = kind.capacity[i, 0], kind.capacity[i + 1, 0]
        if speed <= b:
            share = max(speed - a, 0.0) / (b - a)
            return kind.capacity[i, 1] + share * (kind.capacity[i + 1, 1] - kind.capacity[i, 1])
    return kind.capacity[drive.first + drive.count - 1, 1]


@kernel(internal=True)
def _push(kind: Paths, p: int, way: float, system: RowArrays) -> None:
    """Force of a driven bogie in the step that ended, and how much of what it can is used."""
    path, state = kind.table[p], kind.state[p]
    drive = kind.drives[path.drive]
    middle = way - 0.5 * state.moved
    rates = pose_at(kind, path, middle)[1]
    moves = state.moved > 0.0
    needed = 0.0
    for k in range(3):
        needed += system.rows[path.block].last_reaction[k] * rates[k]
    reach, fastest = 0.0, 0.0
    for i in range(path.first_bogie, path.first_bogie + path.bogies):
        bogie = kind.bogie_state[i]
        u, v, _ = rolling_at(kind, path, middle, i)
        size = math.hypot(u, v)
        if moves:
            needed += bogie.mean * bogie.climbed / state.moved
            rolls = drive.resistance * (bogie.mean + path.weight) * size
            needed += rolls
            state.loss += rolls * state.moved
        if kind.bogies[i].driven:
            reach += size
            fastest = max(fastest, size * state.moved / state.step)
    state.force = needed / reach if reach > 0.0 else 0.0
    size = abs(state.force)
    state.traction = 0.0
    for i in range(path.first_bogie, path.first_bogie + path.bogies):
        if kind.bogies[i].driven and size > 0.0:
            held = max(drive.friction * (kind.bogie_state[i].mean + path.weight), LEAST_LOAD * size)
            state.traction = max(state.traction, size / held)
    state.power = size / drive_capacity(kind, drive, fastest) if moves else 0.0
    state.brake = 0.0 if moves else size / drive.brake


@implement(watch_joints, Paths)
@kernel(internal=True)
def watch_paths(kind: Paths, work: Workspace, system: RowArrays) -> None:
    """Drives in the step, and their extremes."""
    interval = work.control.interval
    for p in range(kind.table.shape[0]):
        path, state = kind.table[p], kind.state[p]
        if path.drive < 0:
            continue
        _push(kind, p, state.way, system)
        watch_drive(state, interval)


@kernel(internal=True)
def watch_drive(state: DriveState, interval: int) -> None:
    """What a drive gave in the step that ended, and its extremes."""
    note_value(state.forces, interval, state.force)
    note_value(state.tractions, interval, state.traction)
    note_value(state.powers, interval, state.power)
    note_value(state.brakes, interval, state.brake)
    _keep_largest(state.most_traction, state.traction, state.time)
    _keep_largest(state.most_power, state.power, state.time)
    _keep_largest(state.most_brake, state.brake, state.time)


@kernel(internal=True)
def record_drive(state: DriveState, interval: int, driven: float, out: DriveOutputs) -> None:
    """Of a drive, with the number of bogies that push with its force."""
    out.drive_demand, out.bogie_drive = driven * state.force, state.force
    out.bogie_drive_max = largest_of(state.forces, interval, state.force)
    out.bogie_drive_min = smallest_of(state.forces, interval, state.force)
    out.traction_used_max = largest_of(state.tractions, interval, state.traction)
    out.drive_used_max = largest_of(state.powers, interval, state.power)
    out.brake_used_max = largest_of(state.brakes, interval, state.brake)


@kernel(inline=True, internal=True)
def _keep_largest(largest: Largest, value: float, time: float) -> None:
    """Keep a value if it is larger."""
    if value > largest.value:
        largest.value, largest.time = value, time


@implement(record_joints, Paths)
@kernel(internal=True)
def record_paths(
    kind: Paths, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Way, distance from the path, reactions in the axes of the vehicle, steering; drives; works."""
    interval = work.control.interval
    for p in range(kind.table.shape[0]):
        path, state = kind.table[p], kind.state[p]
        way, speed = distance_at(kind, path, time)
        off, reaction = residuals(system, path.block), system.rows[path.block].reaction
        c, s = math.cos(state.yaw), math.sin(state.yaw)
        out = path_outputs(row, path.column)
        out.path_way, out.off_path = way, math.hypot(off[0], off[1])
        out.off_heading = math.asin(min(max(off[2], -1.0), 1.0))
        out.push_along = c * reaction[0] + s * reaction[1]
        out.push_across = c * reaction[1] - s * reaction[0]
        out.push_turning = reaction[2]
        angles, speeds = part(row, path.parts.steering), part(row, path.parts.rolling_speed)
        for i in range(path.bogies):
            u, v, half = rolling_at(kind, path, way, path.first_bogie + i)
            angles[i] = math.atan2(v, u) + half
            speeds[i] = speed * math.hypot(u, v)
        for k in range(3):
            work.sums.drive_work += system.rows[path.block].last_reaction[k] * state.advance[k]
        work.sums.drive_work += state.work + state.loss
        work.sums.dissipated += state.loss
        if path.drive >= 0:
            record_drive(state, interval, float(path.driven), drive_outputs(row, path.drive_column))
