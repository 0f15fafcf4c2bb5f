"""Controllers of ballast: they look at a hull every now and then, and tell pumps how fast until they look again.

What is kept are heel, trim, a draft, or heights of points over the ground, the water or another hull: errors e, each
filtered by two lags of the time constant T behind each other, ``T^2 y'' + 2 T y' + y = e``, exact for an error that
stays over a step. At a look the errors shall change at the rates ``r = -K y``, and as the tide asks for. What a
kilogram of each pump does to them, A, follows from the stiffness of the hull in still water at the start::

    q = A^T (A A^T)^-1 (r - A q_f) ,     c = s (plan + q)

is the least of all flows q of the pumps that does it, besides those f that have no room: a pump that would run its
tank over or dry within a period, with the water that still follows by its lag, or that cannot turn round. The share
s <= 1 keeps every pump within its rate. The flow of a pump follows c with its own lag, exactly, so nothing depends on
the steps but the times of the looks, which are whole steps; all is carried, so a continued run is bitwise identical.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Record, Records, Vector, filled, filled_rows, records
from heavylift.numerics.rotation import rotation_matrix, write_rotation_matrix
from heavylift.numerics.vectors import Vector as Triple
from heavylift.numerics.vectors import rotate
from heavylift.solver.bodies.frames.motion import orientation_of
from heavylift.solver.interface import (
    Bodies,
    Forces,
    Joints,
    Systems,
    Workspace,
    add_forces,
    record_forces,
)
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at, part, placed
from heavylift.solver.scenario.interface import direct
from heavylift.solver.scene.ballast import GROUND, SEA, Controller, ControllerOutputs, ControllerParts
from heavylift.solver.scene.outputs import Columns
from heavylift.solver.scene.sea import Sea
from heavylift.solver.water.hulls.kind import Hulls, restore_at_rest
from heavylift.solver.water.hulls.step import filtered
from heavylift.solver.water.hulls.tanks import pump_at, tank_mass, tide_at

__all__ = ["Controllers", "begin_controllers", "pack_controllers"]

HEEL, TRIM, DRAFT, HEIGHT = range(4)
"""What is kept."""

ON_GROUND, ON_SEA = -1, -2
"""In place of the number of another hull, over which a height is."""

MOST = 3
"""Things that a controller keeps."""

RIDGE = 1e-9
"""Of the unit rows of A A^T: what pumps cannot do is left."""

DEPENDENT = 1e-6
"""Of the largest singular value of the unit rows of A, below which pumps cannot do what they should."""

TOGETHER = 1e-9
"""Of a period, by which a look may come before its time."""


class ControllerData(Record):
    """A controller.

    Attributes
    ----------
    first_aim, aims, first_pump, pumps, first_effect
        What it keeps, its pumps, and what these do.
    hull
        That it keeps.
    period, gain, filter
        [s]; [1/s]; [s], 0 for none.
    dead_band, dead_angle
        Errors that are left alone [m, rad].
    tide_ahead
        Whether it goes ahead of the tide.
    parts, column
        Where its errors are in a record, and the first column behind them.
    """

    first_aim: int
    aims: int
    first_pump: int
    pumps: int
    first_effect: int
    hull: int
    period: float
    gain: float
    filter: float
    dead_band: float
    dead_angle: float
    tide_ahead: bool
    parts: ControllerParts
    column: int


class AimData(Record):
    """What is kept; point of the hull in principal axes [m]; value; the other hull, and its point."""

    sort: int
    point: Vector
    value: float
    other: int
    other_point: Vector


class ServedPump(Record):
    """Number of the pump; rows of its plan."""

    pump: int
    first: int
    count: int


class PlanRow(Record):
    """From a time on [s], a command [kg/s]."""

    time: float
    command: float


class AimState(Record):
    """Error as it is seen and its rate; the error itself at the last step."""

    seen: float
    rate: float
    error: float


class ControllerState(Record):
    """Looks so far; share of what the last wanted that the pumps can give."""

    looks: int
    share: float


controller_outputs = outputs_at(ControllerOutputs)


class Controllers(Arrays):
    """All controllers of a scene.

    Attributes
    ----------
    table, aims, served, plans
        The description.
    state, aim_state
        Carried.
    effects
        Of a kilogram of each pump on each aim [m/kg, rad/kg]; carried, as it is found at the start.
    hulls
        With the pumps whose rows are rewritten.
    rotation, rows, wanted, flow, fixed
        Scratch.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state", "aim_state", "effects")

    table: Records[ControllerData]
    aims: Records[AimData]
    served: Records[ServedPump]
    plans: Records[PlanRow]
    state: Records[ControllerState]
    aim_state: Records[AimState]
    effects: Floats1
    hulls: Hulls
    rotation: Floats1
    rows: Floats1
    wanted: Floats1
    flow: Floats1
    fixed: Floats1


# ---- what it sees ----


@kernel(internal=True)
def _arm(kind: Controllers, hull: int, point: NDArray[np.float64]) -> Triple:
    """From the centre of mass of a hull to a point of it, in the world, at the carried state."""
    write_rotation_matrix(orientation_of(kind.hulls.frame[hull]), kind.rotation)
    return rotate(kind.rotation, point)


@kernel(internal=True)
def _height(kind: Controllers, hull: int, point: NDArray[np.float64]) -> float:
    """Of a point of a hull in the world [m]."""
    _, _, z = _arm(kind, hull, point)
    return kind.hulls.frame[hull].position[2] + z


@kernel(internal=True)
def _error(kind: Controllers, hull: int, aim: AimData, time: float) -> float:
    """What is kept less what it should be."""
    if aim.sort == HEEL:
        _, _, up = _arm(kind, hull, kind.hulls.hulls[hull].axis_y)
        return math.asin(min(max(up, -1.0), 1.0)) - aim.value
    if aim.sort == TRIM:
        _, _, up = _arm(kind, hull, kind.hulls.hulls[hull].axis_x)
        return -math.asin(min(max(up, -1.0), 1.0)) - aim.value
    level = kind.hulls.water.level
    if kind.hulls.tide.shape[0] > 0:
        level = tide_at(kind.hulls, time)
    height = _height(kind, hull, aim.point)
    if aim.sort == DRAFT:
        return level - height - aim.value
    if aim.other >= 0:
        return height - _height(kind, aim.other, aim.other_point) - aim.value
    return height - aim.value - (level if aim.other == ON_SEA else 0.0)


@kernel(internal=True)
def _watch(kind: Controllers, c: int, time: float, step: float) -> None:
    """Errors at the end of a step, through the filter; at the start without one."""
    data = kind.table[c]
    for i in range(data.first_aim, data.first_aim + data.aims):
        state = kind.aim_state[i]
        error = _error(kind, data.hull, kind.aims[i], time)
        if data.filter > 0.0 and step > 0.0:
            mean = 0.5 * (state.error + error)
            state.seen, state.rate = filtered(state.seen, state.rate, mean, 1.0 / data.filter, step)
        else:
            state.seen, state.rate = error, 0.0
        state.error = error


# ---- what it tells ----


@kernel(internal=True)
def _plan_at(kind: Controllers, served: int, time: float) -> float:
    """Command of the plan of a pump at a time [kg/s]."""
    data = kind.served[served]
    found = 0.0
    for k in range(data.first, data.first + data.count):
        if kind.plans[k].time <= time:
            found = kind.plans[k].command
    return found


@kernel(internal=True)
def _want(kind: Controllers, c: int, time: float) -> None:
    """Rates at which the errors shall change, beside the plan."""
    data = kind.table[c]
    tide = 0.0
    if data.tide_ahead and kind.hulls.tide.shape[0] > 0:
        tide = (tide_at(kind.hulls, time + data.period) - tide_at(kind.hulls, time)) / data.period
    for a in range(data.aims):
        aim, error = kind.aims[data.first_aim + a], kind.aim_state[data.first_aim + a].seen
        left = data.dead_angle if aim.sort < DRAFT else data.dead_band
        kind.wanted[a] = -data.gain * error if abs(error) > left else 0.0
        if aim.sort == HEIGHT and aim.other == ON_GROUND:
            kind.wanted[a] -= tide


@kernel(internal=True)
def _share_out(kind: Controllers, c: int) -> None:
    """The least flows of the pumps that are free that give what is wanted and the others do not."""
    data = kind.table[c]
    n, m, first = data.pumps, data.aims, data.first_effect
    M, y = kind.rows, kind.rows[MOST * MOST :]
    for a in range(m):
        size = y_a = 0.0
        for p in range(n):
            e = kind.effects[first + a * n + p]
            size += e * e
            if kind.fixed[p] > 0.0:
                y_a -= e * kind.flow[p]
        size = math.sqrt(size)
        y[MOST + a] = 1.0 / size
        y[a] = (kind.wanted[a] + y_a) / size
    for a in range(m):
        for b in range(m):
            total = 0.0
            for p in range(n):
                if kind.fixed[p] == 0.0:
                    total += kind.effects[first + a * n + p] * kind.effects[first + b * n + p]
            M[a * MOST + b] = total * y[MOST + a] * y[MOST + b] + (RIDGE if a == b else 0.0)
    for a in range(m):  # symmetric and positive: no pivots
        for b in range(a + 1, m):
            part = M[b * MOST + a] / M[a * MOST + a]
            for k in range(a, m):
                M[b * MOST + k] -= part * M[a * MOST + k]
            y[b] -= part * y[a]
    for a in range(m - 1, -1, -1):
        for k in range(a + 1, m):
            y[a] -= M[a * MOST + k] * y[k]
        y[a] /= M[a * MOST + a]
    for p in range(n):
        if kind.fixed[p] == 0.0:
            kind.flow[p] = 0.0
            for a in range(m):
                kind.flow[p] += kind.effects[first + a * n + p] * y[MOST + a] * y[a]


@kernel(internal=True)
def _room(kind: Controllers, c: int, tank: int, way: float, pump: int, time: float) -> float:
    """Largest command [kg/s] with which a tank has room for what a pump moves in a period and after it, by its lag."""
    data = kind.table[c]
    if tank < 0:
        return math.inf
    mass = tank_mass(kind.hulls, tank, time)
    room = kind.hulls.tanks[tank].capacity - mass if way > 0.0 else mass
    sharers = 0
    for p in range(kind.hulls.pumps.shape[0]):
        one = kind.hulls.pumps[p]
        if tank in (one.source, one.target):
            sharers += 1
            flow, _, _ = pump_at(kind.hulls, p, time)
            if p == pump:
                room -= way * (1.0 if one.target == tank else -1.0) * one.lag * flow
    return room / (sharers * data.period)


@kernel(internal=True)
def _limit(kind: Controllers, c: int, p: int, time: float) -> bool:
    """Whether a pump has no room for what it should do: then it does what it can, in place of the whole."""
    served = kind.served[kind.table[c].first_pump + p]
    pump = kind.hulls.pumps[served.pump]
    ahead = min(
        _room(kind, c, pump.target, 1.0, served.pump, time),
        _room(kind, c, pump.source, -1.0, served.pump, time),
    )
    back = min(
        _room(kind, c, pump.source, 1.0, served.pump, time),
        _room(kind, c, pump.target, -1.0, served.pump, time),
    )
    plan = _plan_at(kind, kind.table[c].first_pump + p, time)
    command = plan + kind.flow[p]
    low = max(-back, 0.0) if pump.least == 0.0 else -back
    kept = max(min(command, ahead), low)
    if kept == command:
        return False
    kind.flow[p] = kept - plan
    return True


@kernel(internal=True)
def _look(kind: Controllers, c: int, time: float) -> None:
    """Tell all pumps of a controller what to do from now on."""
    data = kind.table[c]
    _want(kind, c, time)
    for p in range(data.pumps):
        served = data.first_pump + p
        failed = kind.hulls.pumps[kind.served[served].pump].failed
        kind.fixed[p] = 1.0 if failed else 0.0
        kind.flow[p] = -_plan_at(kind, served, time) if failed else 0.0
    for _ in range(data.pumps + 1):
        _share_out(kind, c)
        changed = False
        for p in range(data.pumps):
            if kind.fixed[p] == 0.0 and _limit(kind, c, p, time):
                kind.fixed[p] = 1.0
                changed = True
        if not changed:
            break
    share = 1.0
    for p in range(data.pumps):
        served = data.first_pump + p
        pump = kind.hulls.pumps[kind.served[served].pump]
        command = _plan_at(kind, served, time) + kind.flow[p]
        limit = pump.most if command > 0.0 else -pump.least
        if abs(command) > limit:
            share = min(share, limit / abs(command))
    for p in range(data.pumps):
        served = data.first_pump + p
        number = kind.served[served].pump
        command = share * (_plan_at(kind, served, time) + kind.flow[p])
        flow, _, pumped = pump_at(kind.hulls, number, time)
        if kind.hulls.pumps[number].failed:
            flow = command = 0.0
        row = kind.hulls.pump_rows[kind.hulls.pumps[number].first]
        row.flow = flow if kind.hulls.pumps[number].lag > 0.0 else command
        row.time, row.command, row.pumped = time, command, pumped
    kind.state[c].share = share
    kind.state[c].looks = math.floor(time / data.period + TOGETHER) + 1


@implement(add_forces, Controllers)
@kernel(internal=True)
def add_no_forces(kind: Controllers, time: float, work: Workspace) -> None:
    """They act by pumps."""


@implement(record_forces, Controllers)
@kernel(internal=True)
def record_controllers(kind: Controllers, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """Errors as they are seen, and the share that pumps can give."""
    for c in range(kind.table.shape[0]):
        data = kind.table[c]
        error = part(row, data.parts.error)
        for a in range(data.aims):
            error[a] = kind.aim_state[data.first_aim + a].seen
        controller_outputs(row, data.column).share = kind.state[c].share


@implement(direct, Controllers)
@kernel(internal=True)
def direct_pumps(
    kind: Controllers,
    forces: Forces,
    bodies: Bodies,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    time: float,
    step: float,
    recorded: bool,
) -> None:
    """Watch the end of a step that stands, and look if it is time."""
    if work.control.split > 0.0:  # a scenario takes it back
        return
    end = time + step
    for c in range(kind.table.shape[0]):
        _watch(kind, c, end, step)
        if end >= (kind.state[c].looks - TOGETHER) * kind.table[c].period:
            _look(kind, c, end)


@entry
def first_look(kind: Controllers) -> None:
    """At the start of time."""
    for c in range(kind.table.shape[0]):
        _watch(kind, c, 0.0, 0.0)
        _look(kind, c, 0.0)


# ---- before time starts ----


def pack_controllers(
    sea: Sea, hulls: Hulls, names: Sequence[str], columns: Mapping[str, Columns], step: float
) -> Controllers:
    """Make the kind.

    Parameters
    ----------
    sea
        The scene.
    hulls
        The kind of all hulls.
    names
        Of them, in its order.
    columns
        Where their outputs are, by name.
    step
        Length of all steps [s], 0 if they vary.

    Raises
    ------
    InputError
        If a period is not of whole steps.
    """
    numbers = {pump.name: i for i, pump in enumerate(sea.pumps)}
    table = records(ControllerData, len(sea.controllers))
    aims: list[AimData] = []
    served: list[ServedPump] = []
    plans: list[PlanRow] = []
    effects = 0
    for data, one in zip(table, sea.controllers, strict=True):
        if step > 0.0 and abs(one.period / step - max(1, round(one.period / step))) > 1e-6:
            raise InputError(
                f"{one.period:g} s with steps of {step:g} s",
                source=one.name,
                key="period",
                expected="a period of whole steps",
            )
        hull, found = names.index(one.hull), _aims(one, hulls, names)
        data.first_aim, data.aims = len(aims), len(found)
        data.first_pump, data.pumps, data.first_effect = len(served), len(one.pumps), effects
        data.hull, data.period, data.gain, data.filter = hull, one.period, one.gain, one.filter
        data.dead_band, data.dead_angle, data.tide_ahead = one.dead_band, one.dead_angle, one.tide_ahead
        data.parts = placed(ControllerParts, columns[one.name])
        data.column = columns[one.name].at(ControllerOutputs)
        aims += found
        effects += len(found) * len(one.pumps)
        for name in one.pumps:
            times, commands = sea.pumps[numbers[name]].plan()[:, :2].T
            served.append(filled(ServedPump, pump=numbers[name], first=len(plans), count=len(times)))
            plans.extend(filled_rows(PlanRow, time=times, command=commands))
    most = max(len(one.pumps) for one in sea.controllers)
    return Controllers(
        table=table,
        aims=records(AimData, aims),
        served=records(ServedPump, served),
        plans=records(PlanRow, plans),
        state=records(ControllerState, len(table)),
        aim_state=records(AimState, len(aims)),
        effects=np.zeros(effects),
        hulls=hulls,
        rotation=np.zeros(9),
        rows=np.zeros(MOST * MOST + 2 * MOST),
        wanted=np.zeros(MOST),
        flow=np.zeros(most),
        fixed=np.zeros(most),
    )


def _aims(one: Controller, hulls: Hulls, names: Sequence[str]) -> list[AimData]:
    """What a controller keeps."""
    nowhere = np.zeros(3)
    hull, found = names.index(one.hull), []

    def add(sort: int, point: Any, value: float, other: int, beside: Any = nowhere) -> None:
        found.append(filled(AimData, sort=sort, point=point, value=value, other=other, other_point=beside))

    for sort, value in ((HEEL, one.heel), (TRIM, one.trim)):
        if value is not None:
            add(sort, nowhere, value, ON_GROUND)
    if one.draft is not None:
        add(DRAFT, _principal(hulls, hull, one.draft_at), one.draft, ON_SEA)
    for level in one.levels:
        point = _principal(hulls, hull, level.point)
        if level.of in {GROUND, SEA}:
            other, beside = ON_GROUND if level.of == GROUND else ON_SEA, nowhere
        else:
            other = names.index(level.of)
            beside = _principal(hulls, other, level.beside)
        add(HEIGHT, point, level.height, other, beside)
    return found


def _principal(hulls: Hulls, hull: int, point: Any) -> NDArray[np.float64]:
    """A point of a hull from its centre of mass in principal axes [m]."""
    frame = hulls.frame[hull]
    moved: NDArray[np.float64] = rotation_matrix(frame.axes).T @ (np.asarray(point) - frame.centre)
    return moved


def begin_controllers(kind: Controllers, names: Sequence[str]) -> None:
    """Find what each pump does, and look for the first time.

    Parameters
    ----------
    kind
        At the state of the start.
    names
        Of the controllers.

    Raises
    ------
    InputError
        If the pumps of a controller cannot change what it keeps, or the hull does not stand upright by itself.
    """
    restore_at_rest(kind.hulls)
    for name, data in zip(names, kind.table, strict=True):
        A = _effects(kind, data, name)
        sizes = np.linalg.norm(A, axis=1)
        unit = A / np.where(sizes > 0.0, sizes, 1.0)[:, None]
        values = np.linalg.svd(unit, compute_uv=False)
        if not (sizes > 0.0).all() or len(values) < len(A) or values[-1] < DEPENDENT * values[0]:
            raise InputError(
                f"{len(A)} quantities to keep, and the pumps can change {int((values > DEPENDENT * values[0]).sum())}"
                " of them by themselves",
                source=name,
                key="pumps",
                expected="tanks at places from which all that is kept can be changed",
            )
        kind.effects[data.first_effect : data.first_effect + A.size] = A.ravel()
    first_look(kind)


def _effects(kind: Controllers, data: Any, name: str) -> NDArray[np.float64]:
    """Derivatives of what is kept by the mass that each pump moves; shape (aims, pumps)."""
    hulls, g = kind.hulls, kind.hulls.water.gravity
    hull, frame = hulls.hulls[data.hull], hulls.frame[data.hull]
    R = rotation_matrix(frame.orientation)
    zz, zx, zy, xx, yy, xy = hulls.stage[data.hull].stiffness
    K = np.array([[zz, zx, zy], [zx, xx, xy], [zy, xy, yy]])
    for tank in hulls.tanks[hull.first_tank : hull.last_tank]:
        K[1:, 1:] -= tank.mass * g * float((R @ tank.point)[2]) * np.eye(2)
    if not np.linalg.eigvalsh(0.5 * (K + K.T))[0] > 0.0:
        raise InputError(
            "the hull does not stand upright by itself at the start",
            source=name,
            key="hull",
            expected="metacentric heights above 0",
        )

    def lift(point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Change of the height of a point by heave and rotations about x and y of the world."""
        x, y, _ = R @ point
        return np.array([1.0, y, -x])

    rows = []
    for aim in kind.aims[data.first_aim : data.first_aim + data.aims]:
        if aim.sort == HEEL:
            rows.append(lift(hull.axis_y) - [1.0, 0.0, 0.0])
        elif aim.sort == TRIM:
            rows.append([1.0, 0.0, 0.0] - lift(hull.axis_x))
        else:
            rows.append(lift(aim.point) * (-1.0 if aim.sort == DRAFT else 1.0))
    loads = np.zeros((3, data.pumps))
    for p, served in enumerate(kind.served[data.first_pump : data.first_pump + data.pumps]):
        pump = hulls.pumps[served.pump]
        for end, way in ((pump.target, 1.0), (pump.source, -1.0)):
            if end >= 0 and hulls.tanks[end].hull == data.hull:
                loads[:, p] -= way * g * lift(hulls.tanks[end].point)
    effects: NDArray[np.float64] = np.array(rows) @ np.linalg.solve(K, loads)
    return effects
