"""Tyres with side slip: a transporter that is free in the plane, held there by its treads alone, and driven.

The tread of a bogie touches the road a deflection (e_x, e_y) away from its wheel, along and across that, which the
velocity (v_x, v_y) of the wheel over the deck makes grow and rolling makes forget (H. B. Pacejka, Tire and Vehicle
Dynamics, 3rd ed. 2012, section 7.2: the single contact point)::

    e_y' = v_y - |v_x| e_y / sigma ,     F_y = - K (e_y + tau e_y') ,     K = C f / sigma

with the load f, the cornering stiffness C over the load, the relaxation length sigma. So ``sigma F' / |v_x| + F`` is
the force ``-C f tan(alpha)`` of the slip angle alpha where f stays; at rest a tread is a spring that holds and does not
creep, and backwards it is as good as forwards. The damping time tau is what rubber loses; it does not change steady
forces. Along the wheel the deflection stops growing where its force is the rolling resistance ``c f``: dry friction
that holds at rest. With brakes on the wheel does not roll, and what brakes hold is added to that.

No force of a tread is beyond the friction ``mu f``. Across, what the drive leaves of the circle limits it,
``F_y^2 <= (mu f)^2 - F_x^2``. A wheel that is locked slides against its velocity.

In a step the velocities over the deck are constant: then deflections are exponentials, also where a limit ends them,
and their means and ends are exact; so are the losses, which are never negative at constant load. Loads, steering and
the rolled way are those that are predicted. What a drive leaves of friction is fitted with the rest, but for steps in
which it takes all of it and the iteration would not end: there the circle is missed by a percent or two. Three rows
for each body and plane of decks, velocities along and across and yaw rate of the vehicle there, carry the sums of all
forces, and are fitted as any law.

Motors in parallel have one pressure and share one flow. So the drive is one row: driven wheels, each rolling along its
own direction, together roll as the plan of the path says, ``sum w_i d_i . v_i = s' sum w_i |r_i|``, and its reaction is
the force F of each motor. That needs no controller with gains that somebody would have to choose. The row gives way
where F is more than motors or friction can: it then pushes with that, and the plan waits. What a wheel with less load
cannot put on the road goes to the others: its weight is ``w_i = mu f_i / F`` for what F grows to at most in the step,
which is the friction of the best wheel if that is less.
At rest motors are off and driven wheels braked.

Wheels are steered as the path has them at the way that has been rolled, and nobody corrects that: a driver would hide
the drift that this is there to show. What a slope of the profile takes along the road is a force on the vehicle here.
"""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Ints1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, Records
from heavylift.numerics.records import Vector as VectorField
from heavylift.solver.force_elements.line_bearing import rub
from heavylift.solver.force_elements.rows import fit_row_law, put_law, put_row_law, put_stick, rate_of_row
from heavylift.solver.interface import (
    Workspace,
    fill_rows,
    record_joints,
    relinearise,
    set_targets,
    update_rows,
    watch_joints,
)
from heavylift.solver.joints.row_writing import Vector, add_direction_row, dot, minus, rate, vector
from heavylift.solver.kinds import implement
from heavylift.solver.recording import part
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.transport import TyreParts
from heavylift.solver.transport.lever_arms import add_place_row, place, place_rate
from heavylift.solver.transport.paths import (
    DriveState,
    PathData,
    Paths,
    PlanState,
    distance_at,
    drive_capacity,
    drive_outputs,
    hermite,
    path_outputs,
    pose_at,
    record_drive,
    rolling_at,
    row_before,
    tell_steering,
    watch_drive,
    weigh_plans,
)
from heavylift.solver.transport.transporters import BogieState, DeckData

__all__ = [
    "PlaneRows",
    "TyreData",
    "TyreState",
    "TyredVehicles",
    "WheelData",
    "WheelState",
    "deflect",
    "tread",
]

NEGLIGIBLE = 1e-13
"""Miss of a row over all friction of its wheels that counts as fitted: what the sum is rounded by."""

PLAIN_ROUNDS = 5
"""Rounds of the iteration of the rows after which treads count as stiff as they can be: corners can go to and fro."""

GROWTH, LEAST = 1.25, 0.05
"""By how much the force of a motor may grow in a step beyond what wheels with less load can put on the road, and what
it may be in any case, over the friction of the best wheel."""

HALVINGS = 60
"""Of a step, to find how long a plan waits."""

SMALL = 0.03
"""Way over the relaxation length below which means are series: their terms would cancel."""


class TyreData(Record):
    """A vehicle on tyres.

    Attributes
    ----------
    path
        Its number in `TyredVehicles.paths`.
    first_plane, planes
        Planes of decks.
    block, drive_block, attachments
        First of the blocks of its planes, block of the drive, and attachments of that.
    parts
        Where what is recorded of its wheels is.
    cornering, length, delay
        C [1], sigma [m], tau [s].
    reach
        Largest distance of a bogie from the middle of all [m].
    """

    path: int
    first_plane: int
    planes: int
    block: int
    drive_block: int
    attachments: int
    parts: TyreParts
    cornering: float
    length: float
    delay: float
    reach: float


class TyreState(DriveState):
    """What a vehicle on tyres carries.

    Attributes
    ----------
    fresh
        Whether no step has been made yet.
    wait
        How long its plan has waited for it [s].
    way, moved, step
        Rolled way at the end of the last step, way of the plan in the step [m], its length [s].
    stood, rests, branch, rounds
        Whether it was to stand in the last step, and in this one; 0 if the drive gives what the plan asks for, else the
        sense in which it pushes as it can; of the iteration.
    flow, wheels, most, back, capacity
        Wanted rate of the row of the drive [m/s], that over the rate of the way; largest force of a motor forwards, and
        backwards, where rolling resistance adds to what it takes of friction; without regard to friction [N].
    before
        Rate of the row of the drive at the end of the step, before velocities are projected [m/s].
    push
        On the vehicle along, across and about its middle, in the middle of the last step [N, N, N m].
    work, loss, stored
        Of drives, lost, and elastic in treads [J].
    """

    fresh: bool
    wait: float
    way: float
    moved: float
    step: float
    stood: bool
    rests: bool
    branch: int
    rounds: int
    flow: float
    wheels: float
    most: float
    back: float
    capacity: float
    before: float
    push: VectorField
    work: float
    loss: float
    stored: float


class PlaneRows(Record):
    """Rows of a vehicle on all decks of a body that lie in parallel planes.

    Attributes
    ----------
    origin, x, y
        Markers of a point of the body, and of axes in the planes.
    side, drive_side
        Of the body in its own block, and in that of the drive; -1 of the ground.
    vehicle_side
        Of the vehicle in the block of the drive.
    grip
        Friction of all wheels on it in the step [N].
    driven
        Parts of its rates in the row of the drive.
    rates, motor, forces
        Rates of its rows and force of a motor for which the forces of its wheels were found last, and sums of these
        against the rates [m/s, rad/s; N; N, N m].
    """

    origin: int
    x: int
    y: int
    side: int
    drive_side: int
    vehicle_side: int
    grip: float
    driven: VectorField
    rates: VectorField
    motor: float
    forces: VectorField


class WheelData(Record):
    """A bogie: by which angle it is off its steering, to the left [rad]; where it is drawn on its plane [m]."""

    error: float
    start_x: float
    start_y: float


class WheelState(Record):
    """What the tread of a bogie carries.

    Attributes
    ----------
    along, aside
        Deflection along and across the wheel, at the end of the last step [m].
    held_x, held_y
        Direction of the wheel then, in the axes of the vehicle.
    x, y, size
        Direction in which the wheel rolls, in the axes of the vehicle, and its way by that of the path.
    load, stiffness, limit, hold
        f [N], K [N/m] in the step; largest deflection by friction, and along the wheel by rolling resistance and
        brakes [m].
    room
        Deflection across that what goes along it leaves of the limit [m].
    locked
        Whether its brakes hold more than friction.
    plane
        On which it stands.
    rolls, mean, lag
        Way that it rolls in the step over sigma; ``(1 - exp(-rolls)) / rolls`` and ``(1 - mean) / rolls``.
    weight
        Share of the force of a motor that it gets.
    downhill_x, downhill_y
        Force of the slope of the road, in the axes of the vehicle [N].
    end_along, end_aside
        Deflection along and across the wheel at the end of the step [m].
    force, side, forwards, across
        Of the tread along and across the wheel in the mean of the step [N]; velocity over the deck likewise [m/s].
    """

    along: float
    aside: float
    held_x: float
    held_y: float
    x: float
    y: float
    size: float
    load: float
    stiffness: float
    limit: float
    hold: float
    room: float
    locked: bool
    plane: int
    rolls: float
    mean: float
    lag: float
    weight: float
    downhill_x: float
    downhill_y: float
    end_along: float
    end_aside: float
    force: float
    side: float
    forwards: float
    across: float


class TyredVehicles(Arrays):
    """All vehicles on tyres of a scene.

    Attributes
    ----------
    table, planes, wheels
        Vehicles; by vehicle and plane; by bogie.
    deck_planes
        Number of the plane, within those of a vehicle, of each deck.
    paths
        Their paths, which are no kind of the scene: nothing drives them but what is here.
    decks
        Of the transporters.
    state, wheel_state, plan_state
        Carried; the last is that of `paths`.
    bogie_state
        Of the transporters.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state", "wheel_state", "plan_state")

    table: Records[TyreData]
    planes: Records[PlaneRows]
    wheels: Records[WheelData]
    deck_planes: Ints1
    paths: Paths
    decks: Records[DeckData]
    state: Records[TyreState]
    wheel_state: Records[WheelState]
    plan_state: Records[PlanState]
    bogie_state: Records[BogieState]


# ---- a tread ----


@kernel(internal=True)
def _means(a: float) -> tuple[float, float]:
    """``m = (1 - exp(-a)) / a`` and ``(1 - m) / a``: means over a step of what decays, and of what grows towards 1."""
    if a < SMALL:
        lag = 0.5 - a * (1.0 / 6.0 - a * (1.0 / 24.0 - a * (1.0 / 120.0 - a * (1.0 / 720.0 - a / 5040.0))))
        return 1.0 - a * lag, lag
    mean = -math.expm1(-a) / a
    return mean, (1.0 - mean) / a


@kernel
def deflect(
    e: float, d: float, a: float, limit: float, mean: float, lag: float
) -> tuple[float, float, float]:
    """A deflection over a step in which its wheel goes evenly.

    Parameters
    ----------
    e, d
        At the start, at most `limit` then; way across of the wheel [m].
    a, mean, lag
        Rolled way over sigma, and its `_means`.
    limit
        At which the tread slides [m].

    Returns
    -------
    middle, end
        Mean and end [m].
    slope
        Derivative of the mean by d.
    """
    if not limit > 0.0:
        return 0.0, 0.0, 0.0
    e = min(max(e, -limit), limit)
    end = e * (1.0 - a * mean) + d * mean
    if abs(end) <= limit:
        return e * mean + d * lag, end, lag
    stop = limit if end > 0.0 else -limit
    # e' = d - a e goes evenly in the sense of the limit: it is met at the share t of the step
    growth = d - a * e
    part = (stop - e) / growth
    t = part if a * part < 1e-9 else -math.log1p(-a * part) / a
    t = min(max(t, 0.0), 1.0)
    mean, lag = _means(a * t)
    return t * (e * mean + d * t * lag) + (1.0 - t) * stop, stop, t * t * lag


@kernel(internal=True)
def tread(
    wheel: WheelState,
    ex: float,
    ey: float,
    dx: float,
    dy: float,
    drive: float,
    damping: float,
    keeps: bool,
) -> tuple[float, float, float, float, float, float]:
    """A tread in a step.

    Parameters
    ----------
    wheel
        What is known of it in the step.
    ex, ey
        Deflection at the start, along and across the wheel [m].
    dx, dy
        Way of the wheel over the deck [m].
    drive
        Force of its motor, over the stiffness [m].
    damping
        tau over the step.
    keeps
        Whether what the drive leaves of friction stays as it is: where that is next to nothing it is steep.

    Returns
    -------
    x, y
        Mean force against the way, along and across, over the stiffness [m].
    end_x, end_y
        Deflection at the end [m].
    slope_x, slope_y
        Derivatives of x by dx, of y by dy.
    """
    limit = wheel.limit
    if not limit > 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if wheel.locked:
        size = math.hypot(ex, ey)
        back = limit / size if size > limit else 1.0
        ex, ey = ex * back, ey * back
        x, y, end_x, end_y, _, slope_x, slope_y = rub(ex, ey, dx, dy, 1.0, limit)
        x, y = x + damping * (end_x - ex), y + damping * (end_y - ey)
        size = math.hypot(x, y)
        if size > limit:
            x, y = x * limit / size, y * limit / size
        elif math.hypot(ex + dx, ey + dy) <= limit:
            slope_x, slope_y = slope_x + damping, slope_y + damping
        return x, y, end_x, end_y, slope_x, slope_y
    hold = min(wheel.hold, limit)
    x, end_x, slope_x = deflect(ex, dx, 0.0, hold, 1.0, 0.5)
    x, slope_x = _damped(x, end_x - min(max(ex, -hold), hold), slope_x, damping, 1.0, hold)
    free = drive - x
    if not keeps:
        wheel.room = math.sqrt(max(limit * limit - free * free, 0.0))
    across = wheel.room
    y, end_y, slope_y = deflect(ey, dy, wheel.rolls, across, wheel.mean, wheel.lag)
    y, slope_y = _damped(y, end_y - min(max(ey, -across), across), slope_y, damping, wheel.mean, across)
    return x, y, end_x, end_y, slope_x, slope_y


@kernel(inline=True, internal=True)
def _damped(
    e: float, change: float, slope: float, damping: float, mean: float, limit: float
) -> tuple[float, float]:
    """Force of a deflection with what rubber adds while it changes, and its slope; not beyond the limit."""
    force = e + damping * change
    if abs(force) >= limit:
        return min(max(force, -limit), limit), slope
    return force, slope + damping * mean


# ---- the plane of a deck ----


@kernel(internal=True)
def _axes(kind: TyredVehicles, v: int, j: int, work: Workspace) -> tuple[Vector, Vector, float, float, float]:
    """Axes of a vehicle along and across in a plane, world axes; cosine and sine of its heading there, its length."""
    path, plan = kind.paths.table[kind.table[v].path], kind.planes[j]
    x, y, f = vector(work, plan.x), vector(work, plan.y), vector(work, path.forward)
    c, s = dot(x, f), dot(y, f)
    size = math.hypot(c, s)
    c, s = c / size, s / size
    along = (c * x[0] + s * y[0], c * x[1] + s * y[1], c * x[2] + s * y[2])
    across = (c * y[0] - s * x[0], c * y[1] - s * x[1], c * y[2] - s * x[2])
    return along, across, c, s, size


@kernel(internal=True)
def _add_row(
    kind: TyredVehicles,
    v: int,
    j: int,
    sides: tuple[int, int],
    lane: int,
    parts: tuple[float, float, float],
    work: Workspace,
    system: RowArrays,
) -> None:
    """Add velocities of a vehicle over a plane, along and across and its yaw rate, times some parts, to a row."""
    path, plan = kind.paths.table[kind.table[v].path], kind.planes[j]
    along, across, c, s, size = _axes(kind, v, j, work)
    a, b, yaw = parts[0], parts[1], parts[2] / size
    p = (
        a * along[0] + b * across[0],
        a * along[1] + b * across[1],
        a * along[2] + b * across[2],
    )
    add_place_row(system, sides[0], lane, work, path.middle, p)
    add_direction_row(
        system, sides[0], lane, work, path.forward, (yaw * across[0], yaw * across[1], yaw * across[2])
    )
    if sides[1] < 0:
        return
    d, f = minus(place(work, path.middle), vector(work, plan.origin)), vector(work, path.forward)
    add_direction_row(system, sides[1], lane, work, plan.origin, (-p[0], -p[1], -p[2]))
    to_x, to_y = a * c - b * s, a * s + b * c
    turn_x, turn_y = -yaw * s, yaw * c
    add_direction_row(
        system, sides[1], lane, work, plan.x,
        (to_x * d[0] + turn_x * f[0], to_x * d[1] + turn_x * f[1], to_x * d[2] + turn_x * f[2]),
    )  # fmt: skip
    add_direction_row(
        system, sides[1], lane, work, plan.y,
        (to_y * d[0] + turn_y * f[0], to_y * d[1] + turn_y * f[1], to_y * d[2] + turn_y * f[2]),
    )  # fmt: skip


@kernel(internal=True)
def _clear(system: RowArrays, first: int, count: int, rows: int) -> None:
    """Empty rows of some sides."""
    for side in range(first, first + count):
        panel = system.attachments[side].panel
        for k in range(system.attachments[side].width):
            for r in range(rows):
                system.panels[panel + k * system.lanes + r] = 0.0


@kernel(inline=True, internal=True)
def _block(kind: TyredVehicles, v: int, j: int) -> int:
    """Block of the rows of a plane."""
    return kind.table[v].block + j - kind.table[v].first_plane


@kernel(internal=True)
def _write_rows(kind: TyredVehicles, v: int, work: Workspace, system: RowArrays) -> None:
    """Rows of the planes, and of the drive with the directions of the wheels that are known."""
    data = kind.table[v]
    _clear(system, 2 * data.drive_block, data.attachments, 1)
    for j in range(data.first_plane, data.first_plane + data.planes):
        rows, block = kind.planes[j], _block(kind, v, j)
        _clear(system, 2 * block, 2, 3)
        sides = 2 * block, rows.side
        _add_row(kind, v, j, sides, 0, (1.0, 0.0, 0.0), work, system)
        _add_row(kind, v, j, sides, 1, (0.0, 1.0, 0.0), work, system)
        _add_row(kind, v, j, sides, 2, (0.0, 0.0, 1.0), work, system)
        a, b, yaw = rows.driven[0], rows.driven[1], rows.driven[2]
        if a != 0.0 or b != 0.0 or yaw != 0.0:
            _add_row(kind, v, j, (rows.vehicle_side, rows.drive_side), 0, (a, b, yaw), work, system)


@kernel(internal=True)
def _sum_drive(kind: TyredVehicles, v: int) -> None:
    """Parts of the row of the drive on each plane, with the directions of the wheels that are known."""
    data = kind.table[v]
    path = kind.paths.table[data.path]
    for j in range(data.first_plane, data.first_plane + data.planes):
        for r in range(3):
            kind.planes[j].driven[r] = 0.0
    for i in range(path.first_bogie, path.first_bogie + path.bogies):
        wheel, at = kind.wheel_state[i], kind.paths.bogies[i]
        if wheel.weight > 0.0:
            x, y = wheel.weight * wheel.x, wheel.weight * wheel.y
            rows = kind.planes[wheel.plane]
            rows.driven[0] += x
            rows.driven[1] += y
            rows.driven[2] += at.x * y - at.y * x


@kernel(internal=True)
def _velocities(kind: TyredVehicles, v: int, j: int, work: Workspace) -> tuple[float, float, float]:
    """Velocities of a vehicle over a plane as predicted, along and across [m/s], and its yaw rate [rad/s]."""
    path, plan = kind.paths.table[kind.table[v].path], kind.planes[j]
    along, across, c, s, size = _axes(kind, v, j, work)
    d = minus(place(work, path.middle), vector(work, plan.origin))
    u = minus(place_rate(work, path.middle), rate(work, plan.origin))
    x_rate, y_rate = rate(work, plan.x), rate(work, plan.y)
    a, b = dot(x_rate, d), dot(y_rate, d)
    f, f_rate = vector(work, path.forward), rate(work, path.forward)
    yaw = (dot(across, f_rate) + c * dot(y_rate, f) - s * dot(x_rate, f)) / size
    return dot(along, u) + c * a + s * b, dot(across, u) + c * b - s * a, yaw


# ---- wheels in a step ----


@kernel(internal=True)
def _aim(kind: TyredVehicles, v: int, way: float) -> None:
    """Steer all wheels as the path has them at a way."""
    paths, path = kind.paths, kind.paths.table[kind.table[v].path]
    i = row_before(paths.nodes, path.first_node, path.nodes, way)
    h = paths.nodes[i + 1, 0] - paths.nodes[i, 0]
    t = min(max((way - paths.nodes[i, 0]) / h, 0.0), 1.0)
    slip, _ = hermite(
        h, t, paths.nodes[i, 7], paths.nodes[i, 8], paths.nodes[i + 1, 7], paths.nodes[i + 1, 8]
    )
    turn = paths.nodes[i, 6] + t * (paths.nodes[i + 1, 6] - paths.nodes[i, 6])
    u, w = paths.nodes[i, 9] * math.cos(slip), paths.nodes[i, 9] * math.sin(slip)
    for k in range(path.first_bogie, path.first_bogie + path.bogies):
        wheel, bogie = kind.wheel_state[k], paths.bogies[k]
        x, y = u - turn * (bogie.y - paths.nodes[i, 11]), w + turn * (bogie.x - paths.nodes[i, 10])
        wheel.size = math.sqrt(x * x + y * y)
        if wheel.size > 0.0:
            x, y = x / wheel.size, y / wheel.size
        else:
            x, y = 1.0, 0.0
        error = kind.wheels[k].error
        if error != 0.0:
            c, s = math.cos(error), math.sin(error)
            x, y = c * x - s * y, s * x + c * y
        wheel.x, wheel.y = x, y


@kernel(internal=True)
def _keep_forces(kind: TyredVehicles, path: PathData) -> None:
    """Turn wheels that stand: treads stay where they are on the ground. Those that roll turn their treads along."""
    for i in range(path.first_bogie, path.first_bogie + path.bogies):
        wheel = kind.wheel_state[i]
        c, s = (
            wheel.held_x * wheel.x + wheel.held_y * wheel.y,
            wheel.held_x * wheel.y - wheel.held_y * wheel.x,
        )
        p, q = wheel.along, wheel.aside
        wheel.along, wheel.aside = c * p + s * q, c * q - s * p
        wheel.held_x, wheel.held_y = wheel.x, wheel.y


@kernel(internal=True)
def _look_at_loads(kind: TyredVehicles, v: int, time: float, step: float) -> None:
    """Plan of the step; loads, limits and shares of the wheels in it."""
    data, state = kind.table[v], kind.state[v]
    path = kind.paths.table[data.path]
    drive = kind.paths.drives[path.drive]
    before, _ = distance_at(kind.paths, path, time - state.wait)
    after, _ = distance_at(kind.paths, path, time + step - state.wait)
    state.moved, state.step, state.time = after - before, step, time + step
    state.rests = not state.moved > 0.0
    _aim(kind, v, state.way + 0.5 * state.moved)
    if state.stood:
        _keep_forces(kind, path)
    for j in range(data.first_plane, data.first_plane + data.planes):
        kind.planes[j].grip = 0.0
    best, state.wheels, state.most = 0.0, 0.0, math.inf
    left = max(1.0 - drive.resistance / drive.friction, 0.0)
    for i in range(path.first_bogie, path.first_bogie + path.bogies):
        if kind.paths.bogies[i].driven:
            best = max(best, drive.friction * (kind.bogie_state[i].mean + path.weight))
    # beyond what the best wheel can none is tried: shares would be of a force that no motor reaches
    tried = min(max(GROWTH * abs(state.force), LEAST * best), best)
    for i in range(path.first_bogie, path.first_bogie + path.bogies):
        wheel, bogie = kind.wheel_state[i], kind.bogie_state[i]
        f = bogie.mean + path.weight
        driven = kind.paths.bogies[i].driven
        wheel.load, wheel.stiffness = f, data.cornering * f / data.length
        wheel.limit = drive.friction * data.length / data.cornering if f > 0.0 else 0.0
        wheel.plane = data.first_plane + kind.deck_planes[bogie.deck]
        kind.planes[wheel.plane].grip += drive.friction * f
        held = drive.resistance * f
        wheel.locked = state.rests and driven and held + drive.brake >= drive.friction * f
        if state.rests and driven:
            held = min(held + drive.brake, drive.friction * f)
        wheel.hold = held / wheel.stiffness if f > 0.0 else 0.0
        wheel.weight = 0.0
        if driven and not state.rests:
            # a wheel that rolls back resists in the sense of its motor
            grip = drive.friction * f * (left if wheel.along < 0.0 else 1.0)
            wheel.weight = min(1.0, grip / tried) if tried > 0.0 else 0.0
            state.most = min(state.most, max(grip, tried))
            state.wheels += wheel.weight * wheel.size
    state.most = min(state.most, best)
    state.back = left * state.most
    state.flow = state.wheels * state.moved / step
    if state.rests or not state.wheels > 0.0:
        state.branch = 0


@kernel(internal=True)
def _look_at_rates(kind: TyredVehicles, v: int, step: float, work: Workspace) -> None:
    """Ways that wheels roll in the step as predicted, slopes under them; what their motors can at that speed."""
    data, state = kind.table[v], kind.state[v]
    path = kind.paths.table[data.path]
    fastest = 0.0
    for j in range(data.first_plane, data.first_plane + data.planes):
        if not kind.planes[j].grip > 0.0:
            continue
        a, b, yaw = _velocities(kind, v, j, work)
        along, across, _, _, _ = _axes(kind, v, j, work)
        for i in range(path.first_bogie, path.first_bogie + path.bogies):
            wheel, bogie, at = kind.wheel_state[i], kind.bogie_state[i], kind.paths.bogies[i]
            if wheel.plane != j:
                continue
            u, w = a - yaw * at.y, b + yaw * at.x
            forwards = wheel.x * u + wheel.y * w
            if wheel.weight > 0.0:
                fastest = max(fastest, abs(forwards))
            # what bends the tread does not roll it
            bent = min(max(wheel.along, -wheel.hold), wheel.hold)
            bent += step * forwards
            rolled = 0.0 if wheel.locked else min(max(abs(bent) - wheel.hold, 0.0), step * abs(forwards))
            wheel.rolls = rolled / data.length
            wheel.mean, wheel.lag = _means(wheel.rolls)
            wheel.downhill_x = wheel.downhill_y = 0.0
            if bogie.incline_x != 0.0 or bogie.incline_y != 0.0:
                x, y = vector(work, kind.decks[bogie.deck].x), vector(work, kind.decks[bogie.deck].y)
                p, q, f = bogie.incline_x, bogie.incline_y, bogie.mean + path.weight
                wheel.downhill_x = -f * (p * dot(x, along) + q * dot(y, along))
                wheel.downhill_y = -f * (p * dot(x, across) + q * dot(y, across))
    state.capacity = drive_capacity(kind.paths, kind.paths.drives[path.drive], fastest)
    state.back = min(state.back, state.capacity)
    state.most = min(state.most, state.capacity)


@kernel(internal=True)
def _settle(
    kind: TyredVehicles, v: int, time: float, step: float, at_midpoint: bool, work: Workspace
) -> None:
    """Deflect the treads of a vehicle that stands at the start: sides and brakes hold what gravity takes downhill.

    If it has moved from where it is drawn, as in a search for an equilibrium, treads are deflected by that too.
    """
    data, state = kind.table[v], kind.state[v]
    path = kind.paths.table[data.path]
    _look_at_loads(kind, v, time, step)
    _look_at_rates(kind, v, step, work)
    state.stored = 0.0
    push_x, push_y, turning = 0.0, 0.0, 0.0
    g = work.sums.gravity
    braked, total = 0.0, 0.0
    for i in range(path.first_bogie, path.first_bogie + path.bogies):
        f = kind.wheel_state[i].load
        total += f
        braked += f if kind.paths.bogies[i].driven else 0.0
    for i in range(path.first_bogie, path.first_bogie + path.bogies):
        wheel, bogie = kind.wheel_state[i], kind.bogie_state[i]
        along, across, c, s, _ = _axes(kind, v, wheel.plane, work)
        n = vector(work, kind.decks[bogie.deck].z)
        down = -(g[0] * n[0] + g[1] * n[1] + g[2] * n[2])
        if not (down > 0.0 and wheel.load > 0.0 and total > 0.0):
            continue
        x = (g[0] * along[0] + g[1] * along[1] + g[2] * along[2]) / down + wheel.downhill_x / wheel.load
        y = (g[0] * across[0] + g[1] * across[1] + g[2] * across[2]) / down + wheel.downhill_y / wheel.load
        # in the axes of the wheel: sides carry all alike, brakes what goes along it
        forwards, aside = wheel.x * x + wheel.y * y, wheel.x * y - wheel.y * x
        forwards *= total / braked if kind.paths.bogies[i].driven else 0.0
        scale, plane, at = data.length / data.cornering, kind.planes[wheel.plane], kind.paths.bogies[i]
        d = minus(place(work, path.middle), vector(work, plane.origin))
        p = dot(d, vector(work, plane.x)) + c * at.x - s * at.y - kind.wheels[i].start_x
        q = dot(d, vector(work, plane.y)) + s * at.x + c * at.y - kind.wheels[i].start_y
        p, q = c * p + s * q, c * q - s * p
        if at_midpoint:  # not where it is in the middle of the first step, but at its start
            u, w, yaw = _velocities(kind, v, wheel.plane, work)
            p, q = p - 0.5 * step * (u - yaw * at.y), q - 0.5 * step * (w + yaw * at.x)
        wheel.along = scale * forwards + wheel.x * p + wheel.y * q
        wheel.aside = scale * aside + wheel.x * q - wheel.y * p
        wheel.held_x, wheel.held_y = wheel.x, wheel.y
        state.stored += 0.5 * wheel.stiffness * (wheel.along * wheel.along + wheel.aside * wheel.aside)
        wheel.force, wheel.side = -wheel.stiffness * wheel.along, -wheel.stiffness * wheel.aside
        x = wheel.x * wheel.force - wheel.y * wheel.side + wheel.downhill_x
        y = wheel.y * wheel.force + wheel.x * wheel.side + wheel.downhill_y
        push_x, push_y, turning = push_x + x, push_y + y, turning + at.x * y - at.y * x
    state.push[0], state.push[1], state.push[2] = push_x, push_y, turning


@kernel(internal=True)
def _sum_forces(
    kind: TyredVehicles, v: int, j: int, rates: Vector, motor: float, step: float
) -> tuple[Vector, Vector]:
    """Forces of treads and slopes of a plane against the rates of its rows, mean over a step, and their derivatives.

    Parameters
    ----------
    kind, v, j
        Vehicle and plane; forces and ends of its wheels are written.
    rates
        Of the rows [m/s, m/s, rad/s].
    motor
        Force of a motor [N].
    step
        [s].
    """
    data, state = kind.table[v], kind.state[v]
    path = kind.paths.table[data.path]
    damping, stiff = data.delay / step, state.rounds > PLAIN_ROUNDS
    a, b, yaw = 0.0, 0.0, 0.0
    by_a, by_b, by_yaw = 0.0, 0.0, 0.0
    for i in range(path.first_bogie, path.first_bogie + path.bogies):
        wheel, at = kind.wheel_state[i], kind.paths.bogies[i]
        if wheel.plane != j:
            continue
        c, s, K = wheel.x, wheel.y, wheel.stiffness
        u, w = step * (rates[0] - rates[2] * at.y), step * (rates[1] + rates[2] * at.x)
        drive = wheel.weight * motor / K if K > 0.0 else 0.0
        x, y, end_x, end_y, slope_x, slope_y = tread(
            wheel, wheel.along, wheel.aside, c * u + s * w, c * w - s * u, drive, damping, stiff
        )
        if stiff:
            slope_x = slope_y = 0.5 + damping
        wheel.end_along, wheel.end_aside = end_x, end_y
        wheel.force, wheel.side = K * (drive - x), -K * y
        p, q = K * (c * x - s * y) - wheel.downhill_x, K * (s * x + c * y) - wheel.downhill_y
        a, b, yaw = a + p, b + q, yaw + at.x * q - at.y * p
        kx, ky = step * K * slope_x, step * K * slope_y
        xx, yy, xy = kx * c * c + ky * s * s, kx * s * s + ky * c * c, (kx - ky) * c * s
        by_a, by_b = by_a + xx, by_b + yy
        by_yaw += at.y * at.y * xx + at.x * at.x * yy - 2.0 * at.x * at.y * xy
    rows = kind.planes[j]
    rows.motor = motor
    rows.rates[0], rows.rates[1], rows.rates[2] = rates[0], rates[1], rates[2]
    rows.forces[0], rows.forces[1], rows.forces[2] = a, b, yaw
    return (a, b, yaw), (by_a, by_b, by_yaw)


# ---- rows ----


@implement(fill_rows, TyredVehicles)
@kernel(internal=True)
def fill_tyre_rows(kind: TyredVehicles, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows with the directions of the wheels that are known; none is ever off its place."""
    for v in range(kind.table.shape[0]):
        _write_rows(kind, v, work, system)


@kernel(inline=True, internal=True)
def _rates(
    kind: TyredVehicles, v: int, j: int, work: Workspace, system: RowArrays
) -> tuple[float, float, float]:
    """Rates of the rows of a plane."""
    first = 2 * _block(kind, v, j)
    return (
        rate_of_row(system, first, first + 2, 0, work.velocity),
        rate_of_row(system, first, first + 2, 1, work.velocity),
        rate_of_row(system, first, first + 2, 2, work.velocity),
    )


@kernel(internal=True)
def _put_drive(kind: TyredVehicles, v: int, flow: float, step: float, system: RowArrays) -> None:
    """Row of the drive in its present branch."""
    block, state = kind.table[v].drive_block, kind.state[v]
    if state.rests or not state.wheels > 0.0:
        put_law(system, block, step, 0.0, 0.0, 0.0)
    elif state.branch == 0:
        put_stick(system, block)
        system.rows[block].target[0] = flow
    else:
        put_law(system, block, step, 0.0, -state.most if state.branch > 0 else state.back, 0.0)


@implement(set_targets, TyredVehicles)
@kernel(internal=True)
def set_tyre_targets(
    kind: TyredVehicles, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """Wheels as predicted, and first guess of their forces; at the end of a step the drive holds its speed there."""
    for v in range(kind.table.shape[0]):
        data, state = kind.table[v], kind.state[v]
        path = kind.paths.table[data.path]
        if not at_midpoint:
            if state.fresh:
                _settle(kind, v, time, step, False, work)
            _aim(kind, v, state.way)
            _sum_drive(kind, v)
            _write_rows(kind, v, work, system)
            first = 2 * data.drive_block
            state.before = rate_of_row(system, first, first + data.attachments, 0, work.velocity)
            if not state.fresh and not state.rests and state.branch == 0 and state.wheels > 0.0:
                _, speed = distance_at(kind.paths, path, time - state.wait)
                flow = 0.0
                for i in range(path.first_bogie, path.first_bogie + path.bogies):
                    flow += kind.wheel_state[i].weight * kind.wheel_state[i].size
                _put_drive(kind, v, flow * speed, step, system)
            continue
        if state.fresh:
            _settle(kind, v, time, step, True, work)
        _look_at_loads(kind, v, time, step)
        _look_at_rates(kind, v, step, work)
        _share_plans(kind, v, step)
        _sum_drive(kind, v)
        _write_rows(kind, v, work, system)
        _put_drive(kind, v, state.flow, step, system)
        state.rounds = 0
        motor = 0.0 if state.rests else min(max(state.force, -state.back), state.most)
        for j in range(data.first_plane, data.first_plane + data.planes):
            block, rates = _block(kind, v, j), (0.0, 0.0, 0.0)
            if kind.planes[j].grip > 0.0:
                rates = _velocities(kind, v, j, work)
            forces, slopes = _sum_forces(kind, v, j, rates, motor, step)
            for r in range(3):
                put_row_law(system, block, r, step, rates[r], forces[r], slopes[r])


@kernel(internal=True)
def _share_plans(kind: TyredVehicles, v: int, step: float) -> None:
    """Weights of the plans at the end of the step, as of a path that is driven: what the way is measured in."""
    path = kind.paths.table[kind.table[v].path]
    total = weigh_plans(kind.paths, kind.table[v].path)
    part = -math.expm1(-step / path.delay)
    for j in range(path.first_plan, path.first_plan + path.plans):
        plan = kind.plan_state[j]
        share = plan.load / total if total > 0.0 else plan.weight
        plan.next_weight = plan.weight + part * (share - plan.weight)


@implement(relinearise, TyredVehicles)
@kernel(internal=True)
def relinearise_tyres(
    kind: TyredVehicles, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Fit treads to the rates found; let the drive give way where it is asked for more than it can."""
    for v in range(kind.table.shape[0]):
        data, state = kind.table[v], kind.state[v]
        block = data.drive_block
        state.rounds += 1
        motor = 0.0 if state.rests else 2.0 * system.rows[block].impulse[0] / step
        if state.wheels > 0.0 and not state.rests:
            first = 2 * block
            u = rate_of_row(system, first, first + data.attachments, 0, work.velocity)
            branch = state.branch
            if state.rounds <= PLAIN_ROUNDS or work.control.changed == 0:
                if branch == 0 and motor > state.most * (1.0 + 1e-10):
                    state.branch = 1
                elif branch == 0 and motor < -state.back * (1.0 + 1e-10):
                    state.branch = -1
                elif branch != 0 and branch * (u - state.flow) > 1e-12 * abs(state.flow):
                    state.branch = 0
            if state.branch != branch:
                _put_drive(kind, v, state.flow, step, system)
                work.control.changed += 1
                work.status.block = block
        motor = min(max(motor, -state.back), state.most)
        for j in range(data.first_plane, data.first_plane + data.planes):
            grip = kind.planes[j].grip
            if not grip > 0.0:
                continue
            block, rates = _block(kind, v, j), _rates(kind, v, j, work, system)
            forces, slopes = _sum_forces(kind, v, j, rates, motor, step)
            for r in range(3):
                miss = abs(system.rows[block].impulse[r] + 0.5 * step * forces[r])
                if miss > NEGLIGIBLE * 0.5 * step * grip * (data.reach if r == 2 else 1.0):
                    fit_row_law(system, block, r, step, rates[r], forces[r], slopes[r], work)


@kernel(internal=True)
def _waited(paths: Paths, path: PathData, way: float, begin: float, step: float) -> float:
    """How long of a step a plan waits for a vehicle that has got to a way only [s]."""
    low, high = 0.0, step
    if distance_at(paths, path, begin + high)[0] <= way:
        return 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if distance_at(paths, path, begin + middle)[0] < way:
            low = middle
        else:
            high = middle
    return step - low


@implement(update_rows, TyredVehicles)
@kernel(internal=True)
def update_tyres(kind: TyredVehicles, time: float, step: float, work: Workspace, system: RowArrays) -> None:
    """Carry deflections, way and plan over the step; works."""
    for v in range(kind.table.shape[0]):
        data, state = kind.table[v], kind.state[v]
        path, block = kind.paths.table[data.path], data.drive_block
        motor = 0.0 if state.rests else 2.0 * system.rows[block].impulse[0] / step
        state.force = motor
        for j in range(path.first_plan, path.first_plan + path.plans):
            kind.plan_state[j].weight = kind.plan_state[j].next_weight
        spent, stored = 0.0, 0.0
        a, b, yaw = 0.0, 0.0, 0.0
        for j in range(data.first_plane, data.first_plane + data.planes):
            if not kind.planes[j].grip > 0.0:
                continue
            rates = _rates(kind, v, j, work, system)
            rows = kind.planes[j]
            known = rows.rates[0] == rates[0] and rows.rates[1] == rates[1] and rows.rates[2] == rates[2]
            if not (known and rows.motor == motor):  # else they were fitted to that last
                _sum_forces(kind, v, j, rates, motor, step)
            forces = rows.forces[0], rows.forces[1], rows.forces[2]
            spent += step * (forces[0] * rates[0] + forces[1] * rates[1] + forces[2] * rates[2])
            a, b, yaw = a - forces[0], b - forces[1], yaw - forces[2]
            for i in range(path.first_bogie, path.first_bogie + path.bogies):
                wheel, at = kind.wheel_state[i], kind.paths.bogies[i]
                if wheel.plane != j:
                    continue
                wheel.along, wheel.aside = wheel.end_along, wheel.end_aside
                wheel.held_x, wheel.held_y = wheel.x, wheel.y
                stored += 0.5 * wheel.stiffness * (wheel.along * wheel.along + wheel.aside * wheel.aside)
                u, w = rates[0] - rates[2] * at.y, rates[1] + rates[2] * at.x
                p, q = wheel.downhill_x, wheel.downhill_y
                spent += step * (p * u + q * w)
                state.work += step * (p * u + q * w)
                x, y = wheel.weight * motor * wheel.x, wheel.weight * motor * wheel.y
                a, b, yaw = a + x, b + y, yaw + at.x * y - at.y * x
                wheel.forwards, wheel.across = wheel.x * u + wheel.y * w, wheel.x * w - wheel.y * u
        state.push[0], state.push[1], state.push[2] = a, b, yaw
        state.loss += spent - (stored - state.stored)
        state.stored = stored
        if not state.rests and state.wheels > 0.0:
            first = 2 * block
            u = rate_of_row(system, first, first + data.attachments, 0, work.velocity)
            state.work += step * motor * u
            state.way += step * u / state.wheels
            if state.branch != 0:
                state.wait += _waited(kind.paths, path, state.way, time - state.wait, step)
        if path.tells:
            tell_steering(kind.paths, path, state.way, state.moved)
        state.rounds = 0
        state.fresh, state.stood = False, state.rests


# ---- records ----


@kernel(internal=True)
def _shares(kind: TyredVehicles, v: int) -> None:
    """How much of what wheels, motors and brakes can is used in the step that ended."""
    data, state = kind.table[v], kind.state[v]
    path = kind.paths.table[data.path]
    drive = kind.paths.drives[path.drive]
    most, state.brake = 0.0, 0.0
    for i in range(path.first_bogie, path.first_bogie + path.bogies):
        wheel = kind.wheel_state[i]
        if wheel.load > 0.0:
            used = (wheel.force * wheel.force + wheel.side * wheel.side) / (wheel.load * wheel.load)
            most = max(most, used)
            if state.rests and kind.paths.bogies[i].driven:
                held = max(abs(wheel.force) - drive.resistance * wheel.load, 0.0)
                state.brake = max(state.brake, held / drive.brake)
    state.traction = math.sqrt(most) / drive.friction
    state.power = 0.0 if state.rests else abs(state.force) / state.capacity


@implement(watch_joints, TyredVehicles)
@kernel(internal=True)
def watch_tyres(kind: TyredVehicles, work: Workspace, system: RowArrays) -> None:
    """Drives in the step, and their extremes."""
    interval = work.control.interval
    for v in range(kind.table.shape[0]):
        state, rows = kind.state[v], system.rows[kind.table[v].drive_block]
        if not state.rests:  # of the projection at the end
            state.work += 0.5 * rows.impulse[0] * (state.before + rows.target[0])
        _shares(kind, v)
        watch_drive(state, interval)


@implement(record_joints, TyredVehicles)
@kernel(internal=True)
def record_tyres(
    kind: TyredVehicles, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Way, distance from the path, forces, steering, slip; works."""
    interval = work.control.interval
    for v in range(kind.table.shape[0]):
        data, state = kind.table[v], kind.state[v]
        path = kind.paths.table[data.path]
        pose, _ = pose_at(kind.paths, path, state.way)
        off_x, off_y, off_c, off_s = -pose[0], -pose[1], 0.0, 0.0
        for j in range(path.first_plan, path.first_plan + path.plans):
            weight, plan = kind.plan_state[j].weight, kind.paths.plans[j]
            x, y, f = vector(work, plan.x), vector(work, plan.y), vector(work, path.forward)
            d = minus(place(work, path.middle), vector(work, plan.origin))
            off_x, off_y = off_x + weight * dot(d, x), off_y + weight * dot(d, y)
            off_c, off_s = off_c + weight * dot(f, x), off_s + weight * dot(f, y)
        c, s = math.cos(pose[2]), math.sin(pose[2])
        out = path_outputs(row, path.column)
        out.path_way, out.off_path = state.way, math.hypot(off_x, off_y)
        out.off_heading = math.atan2(c * off_s - s * off_c, c * off_c + s * off_s)
        out.push_along, out.push_across, out.push_turning = state.push[0], state.push[1], state.push[2]
        angles, speeds = part(row, path.parts.steering), part(row, path.parts.rolling_speed)
        forces, slips = part(row, data.parts.side_force), part(row, data.parts.slip_angle)
        _, speed = distance_at(kind.paths, path, time - state.wait)
        driven = 0.0
        for i in range(path.bogies):
            bogie, wheel = path.first_bogie + i, kind.wheel_state[path.first_bogie + i]
            u, w, half = rolling_at(kind.paths, path, state.way, bogie)
            angles[i] = math.atan2(w, u) + half + kind.wheels[bogie].error
            speeds[i] = speed * math.hypot(u, w)
            forces[i] = wheel.side
            slips[i] = 0.0 if state.rests else math.atan2(wheel.across, abs(wheel.forwards))
            driven += wheel.weight
        record_drive(state, interval, driven, drive_outputs(row, path.drive_column))
        work.sums.drive_work += state.work
        work.sums.dissipated += state.loss
        work.sums.elastic += state.stored
