"""A scenario becomes a kind: names of channels become columns, those of ropes numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Record, Records, filled, lane_records, records
from heavylift.numerics.small import aligned
from heavylift.solver.carried import LINE
from heavylift.solver.drive import DRIVE_HEAD
from heavylift.solver.force_elements.line_forces import LineForce
from heavylift.solver.force_elements.rope_path import PlaceGradient, RopePlace
from heavylift.solver.force_elements.winch_control import (
    ControlledRopes,
    ControlState,
    TensionRow,
    WinchControl,
)
from heavylift.solver.force_elements.wire_rope import PlaceMarkers, RopeEntry, Ropes, RopeState, WinchRow
from heavylift.solver.recording import placed
from heavylift.solver.rows.structure import Row, RowSystem
from heavylift.solver.scenario.moves import MOVE_ROWS, ActionEntry, MoveRow
from heavylift.solver.scenario.sequencer import (
    DRIVE,
    DRIVE_BREAKS,
    FAILS_ACTUATOR,
    FAILS_LEVELLING,
    FAILS_PUMP,
    FUNCTIONS,
    HELD_ROPE,
    PATH,
    PLAIN_ROPE,
    RUBBING_ROPE,
    TANK,
    Actuator,
    ActuatorState,
    ConditionEntry,
    LimitEntry,
    LogEntry,
    PathPieces,
    PhaseEntry,
    Sequencer,
    SequencerState,
    SignalEntry,
    TermEntry,
    Timer,
    TrackEntry,
    TrackState,
    Worst,
)
from heavylift.solver.scene.bodies import Driven, Fixed, Profile
from heavylift.solver.scene.channels import Channel, TrackOutputs
from heavylift.solver.scene.commands import Command
from heavylift.solver.scene.inputs import check_inputs
from heavylift.solver.scene.operation_state import AXES, Movable, drives_of, helpers_of, releases_of
from heavylift.solver.scene.outputs import Columns
from heavylift.solver.scene.scenario import Scenario, check_scenario
from heavylift.solver.scene.signals import Signal, Term
from heavylift.solver.transport.paths import Paths
from heavylift.solver.transport.transporters import (
    GroupData,
    GroupState,
    Transporters,
    VehicleData,
    VehicleState,
)
from heavylift.solver.water.hulls.kind import PumpData, PumpRow, TankData, TankLevel

__all__ = [
    "action_entry",
    "first_columns",
    "followers",
    "pack_scenario",
    "profile_start",
    "reserve_tables",
    "rope_kinds",
    "share_profiles",
    "with_drives",
]

TANK_LEVELS = 3
"""Of a commanded tank, at least."""

INPUT_ROWS = 3
"""Of a winch that an input drives: a speed, another one, and that behind them."""

TOLD_LINES = 1000
"""Of the log, for operator commands."""


def with_drives(scene: Any) -> Any:
    """A scene in which frames that a scenario commands or an input drives can move: fixed ones stand still until then.

    Raises
    ------
    InputError
        If something is commanded that does not exist, or is not suitable.
    """
    tanks = () if scene.sea is None else scene.sea.tanks
    motions = {body.name: body.motion for body in scene.bodies if hasattr(body, "motion")}
    drives = drives_of(scene.joints, motions)
    ropes = {rope.name: rope for rope in scene.ropes}
    pumped = {} if scene.sea is None else {tank: pump.name for pump in scene.sea.pumps for tank in pump.tanks}
    vehicles = {one.name: one for one in scene.transporters if one.legs}
    capacities = {tank.name: tank.capacity(scene.sea.water) for tank in tanks}
    movable = Movable(
        ropes,
        frozenset(capacities),
        drives,
        pumped=pumped,
        vehicles=vehicles,
        capacities=capacities,
        releases=releases_of(scene.joints, (*scene.forces, *scene.inputs)),
        helpers=helpers_of(
            () if scene.sea is None else scene.sea.pumps,
            () if scene.sea is None else scene.sea.controllers,
            scene.transporters,
        ),
    )
    if scene.scenario is not None:
        check_scenario(scene.scenario, movable)
    controllers = {} if scene.sea is None else {one.name: one for one in scene.sea.controllers}
    fields = () if scene.sea is None else scene.sea.fields
    check_inputs(scene.inputs, scene.scenario, movable, controllers, [one.name for one in fields])
    told = {name.rpartition(".")[::2] for name in _driven(scene, "drive") if "." in name}
    standing = Profile(times=np.zeros(1), speeds=np.zeros(1))

    def ready(body: Any) -> Any:
        axes = [axis for name, axis in told if name == body.name and axis in AXES]
        motion = getattr(body, "motion", None)
        if not axes or not isinstance(motion, (Fixed, Driven)):
            return body
        given = motion if isinstance(motion, Driven) else Driven()
        missing: dict[str, Any] = {axis: standing for axis in axes if getattr(given, axis) is None}
        return replace(body, motion=replace(given, **missing))

    return replace(scene, bodies=tuple(map(ready, scene.bodies)))


def reserve_tables(
    kinds: tuple[tuple[Any, ...], tuple[Any, ...]], scene: Any, channels: Sequence[Channel]
) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """Kinds of bodies and joints with room for the commands of a scenario, and for what inputs are set to.

    Parameters
    ----------
    kinds
        Bodies, joints.
    scene
        With a scenario, or inputs.
    channels
        Of the record, those of the ropes among them.
    """
    columns = first_columns(channels)
    winches = {columns[name] for name in _commanded_winches(scene) if name in columns}
    drives = _driven(scene, "drive")
    joints = {columns[name] for name in drives if name in columns}
    frames: dict[int, set[int]] = {
        columns[name.rpartition(".")[0]]: set() for name in drives if name.rpartition(".")[0] in columns
    }
    for name in drives:
        owner, _, axis = name.rpartition(".")
        if owner in columns:
            frames[columns[owner]].add(AXES.index(axis))
    pumped = set(_driven(scene, "tank"))
    bodies = []
    for kind in kinds[0]:
        made = kind
        if kind.FLOATS and pumped:
            made = _with_levels(kind, scene.sea.tanks_of(scene.bodies), pumped)
        if frames and kind.FRAMES:
            made = _with_frame_profiles(made, frames)
        bodies.append(made)
    connections: list[Any] = []
    longest = max(
        (int(k.table["winch_rows"].max()) for k in kinds[1] if isinstance(k, Ropes) and k.COMMANDED),
        default=0,
    )
    follows = scene.scenario is not None and any(command.leader for command in scene.scenario.commands)
    for kind in kinds[1]:
        if isinstance(kind, Ropes) and kind.COMMANDED:
            least = INPUT_ROWS if scene.scenario is None else MOVE_ROWS
            connections.append(_with_winch_rows(kind, winches, max(least, longest if follows else 0)))
        elif isinstance(kind, Paths):
            connections.append(_with_pieces(kind, _commanded_paths(scene)))
        elif "profiles" in kind._fields and any(int(entry.column) in joints for entry in kind.table):
            connections.append(_with_profiles(kind, joints))
        else:
            connections.append(kind)
    return tuple(bodies), tuple(connections)


def first_columns(channels: Sequence[Channel]) -> dict[str, int]:
    """First record column of each owner."""
    found: dict[str, int] = {}
    for channel in channels:
        found.setdefault(channel.name.rpartition(".")[0], channel.column)
    return found


def _commanded(scenario: Scenario, sort: str) -> list[str]:
    """Names of what gets commands, of a sort, each once.

    In order: a checkpoint is of another process, in which a set may have another one.
    """
    return list(dict.fromkeys(one.name for one in scenario.commands if one.actuates == sort))


def _driven(scene: Any, sort: str) -> list[str]:
    """Names of what a scenario commands or inputs drive, of a sort, each once; in order as `_commanded`."""
    told = [] if scene.scenario is None else _commanded(scene.scenario, sort)
    return list(dict.fromkeys([*told, *(one.target for one in scene.inputs if sort == one.DRIVES)]))


def _commanded_winches(scene: Any) -> set[str]:
    """Names of ropes whose winches get commands, or are driven by an input, or follow one that is."""
    found = set(_driven(scene, "winch"))
    if scene.scenario is not None:
        found |= {command.leader for command in scene.scenario.commands if command.leader}
    return found | {name for name, leader in followers(scene).items() if leader in found}


def followers(scene: Any) -> dict[str, str]:
    """Leaders of the winches that follow another one from the start, by name."""
    winches = {rope.name: getattr(rope, "winch", None) for rope in scene.ropes}
    return {name: winch.follow for name, winch in winches.items() if winch is not None and winch.follow}


def _with_winch_rows(kind: Ropes, told: Iterable[int], count: int) -> Ropes:
    """Room for plans in the winches of some ropes, by their record columns."""
    rows: list[Any] = []
    for entry in kind.table:
        own = list(kind.winches[entry.winch : entry.winch + entry.winch_rows])
        if int(entry.column) in told:
            own = own or [WinchRow.one()]
            own += [own[-1]] * (count - len(own))
        entry.winch, entry.winch_rows = len(rows), len(own)
        rows += own
    winches = records(WinchRow, len(rows))
    for place, row in zip(winches, rows, strict=True):
        place.words[:] = row.words
    return kind._replace(winches=winches)


def _with_levels(kind: Any, tanks: Sequence[Any], told: set[str]) -> Any:
    """Room for plans in the schedules of some tanks, of all in the order of the kind."""
    rows: list[TankLevel] = []
    for entry, tank in zip(kind.tanks, tanks, strict=True):
        own = list(kind.tank_levels[entry.first : entry.first + entry.count])
        if tank.name in told:
            own += [own[-1]] * (TANK_LEVELS - len(own))
        entry.first, entry.count = len(rows), len(own)
        rows += own
    return kind._replace(tank_levels=records(TankLevel, rows))


def _profile_length(data: NDArray[np.float64], start: int) -> int:
    """Numbers of a packed profile."""
    count, harmonics = int(data[start]), int(data[start + 1])
    return 2 + (count + 4 * (count - 1) if count else 0) + 3 * harmonics


def _roomy(block: NDArray[np.float64]) -> NDArray[np.float64]:
    """A packed profile without harmonics with `DRIVE_BREAKS` breaks or more, which is the same function."""
    count = int(block[0])
    if count >= DRIVE_BREAKS:
        return block
    breaks, cubics = np.array([-1.0]), np.zeros((0, 4))
    if count:
        breaks = block[2 : 2 + count]
        cubics = block[2 + count : 2 + count + 4 * (count - 1)].reshape(-1, 4)
    end = float(np.polyval(cubics[-1], breaks[-1] - breaks[-2])) if count else 0.0
    more = DRIVE_BREAKS - len(breaks)
    breaks = np.append(breaks, breaks[-1] + 1.0 + np.arange(more))
    held = np.tile([0.0, 0.0, 0.0, end], (more, 1))
    return np.concatenate([[DRIVE_BREAKS, 0.0], breaks, np.vstack([cubics, held]).ravel()])


def _with_profiles(kind: Any, told: set[int]) -> Any:
    """Room for plans in the profiles of some driven joints, by their record columns."""
    blocks = []
    for entry in kind.table:
        start = int(entry.profile)
        block = kind.profiles[start : start + _profile_length(kind.profiles, start)]
        blocks.append(_roomy(block) if int(entry.column) in told else block)
    for entry, start in zip(kind.table, np.cumsum([0, *map(len, blocks)])[:-1], strict=True):
        entry.profile = start
    return kind._replace(profiles=np.concatenate(blocks))


def _with_frame_profiles(kind: Any, told: Mapping[int, set[int]]) -> Any:
    """Room for plans in the profiles of some driven frames, by the record columns of their bodies; by their axes."""
    constants = kind.constants
    for entry in kind.table:
        axes = told.get(int(entry.column))
        if axes is None:
            continue
        old = constants[int(entry.drive) :]
        blocks = []
        for axis in range(len(AXES)):
            start = int(old[DRIVE_HEAD - len(AXES) + axis])
            block = old[start : start + _profile_length(old, start)]
            blocks.append(_roomy(block) if axis in axes else block)
        head = old[:DRIVE_HEAD].copy()
        head[DRIVE_HEAD - len(AXES) :] = DRIVE_HEAD + np.cumsum([0, *map(len, blocks)])[:-1]
        entry.drive = len(constants)
        constants = np.concatenate([constants, head, *blocks])
    if constants is kind.constants:
        return kind
    flat = aligned(len(constants))
    flat[:] = constants
    return kind._replace(constants=flat)


def _vehicles(scene: Any) -> list[str]:
    """Transporters of the kind of paths, in its order."""
    return [one.name for one in scene.transporters if one.legs and one.tyres is None]


def _commanded_paths(scene: Any) -> set[int]:
    """Numbers of paths that get commands."""
    if scene.scenario is None:
        return set()
    names = _vehicles(scene)
    return {names.index(name) for name in _commanded(scene.scenario, "path")}


def _with_pieces(kind: Paths, told: set[int]) -> Paths:
    """Room for plans in the pieces of some paths."""
    rows: list[NDArray[np.float64]] = []
    for number, path in enumerate(kind.table):
        own = kind.pieces[path.first_piece : path.first_piece + path.pieces]
        if number in told:
            own = np.vstack([own, np.repeat(own[-1:], MOVE_ROWS, axis=0)])
        path.first_piece, path.pieces = sum(map(len, rows)), len(own)
        rows.append(own)
    return kind._replace(pieces=np.ascontiguousarray(np.vstack(rows)))


class _Actuators:
    """Everything that can get commands, with its place in the tables of its kind."""

    def __init__(self) -> None:
        self.numbers: dict[str, int] = {}
        self.rows: list[Actuator] = []

    def add(
        self,
        name: str,
        sort: int,
        number: int,
        *,
        commanded: bool = True,
        axial_stiffness: float = 0.0,
        damping: float = 0.0,
    ) -> None:
        """One more."""
        self.numbers[name] = len(self.rows)
        self.rows.append(
            filled(
                Actuator,
                sort=sort,
                number=number,
                axial_stiffness=axial_stiffness,
                damping=damping,
                commanded=commanded,
            )
        )


def share_profiles(
    kinds: tuple[tuple[Any, ...], tuple[Any, ...]], scene: Any
) -> tuple[tuple[tuple[Any, ...], tuple[Any, ...]], NDArray[np.float64]]:
    """Kinds with drives that a scenario or inputs change keep their profiles in one array."""
    if not _driven(scene, "drive"):
        return kinds, np.zeros(0)
    fields = [(0, i, "constants") for i, kind in enumerate(kinds[0]) if kind.FRAMES and kind.driven]
    fields += [(1, i, "profiles") for i, kind in enumerate(kinds[1]) if "profiles" in kind._fields]
    arrays = [getattr(kinds[row][i], field) for row, i, field in fields]
    starts = np.cumsum([0, *(-(-len(array) // LINE) * LINE for array in arrays)])
    whole = aligned(int(starts[-1]))
    made = [list(group) for group in kinds]
    for (row, i, field), array, start in zip(fields, arrays, starts, strict=False):
        view = whole[start : start + len(array)]
        view[:] = array
        made[row][i] = made[row][i]._replace(**{field: view})
    return (tuple(made[0]), tuple(made[1])), whole


def pack_scenario(
    scene: Any,
    kinds: tuple[tuple[Any, ...], tuple[Any, ...], tuple[Any, ...]],
    block_names: Sequence[str],
    channels: Sequence[Channel],
    columns: Columns,
    width: int,
    carried: Any,
    profiles: NDArray[np.float64],
) -> Sequencer:
    """Make the kind.

    Parameters
    ----------
    scene
        With a scenario.
    kinds
        Of bodies and joints, in which `reserve_tables` has made room, and systems.
    block_names
        Of the blocks of the rows of joints, in their order.
    channels
        Of the whole record.
    columns, width
        Of its own channels, and of a record.
    carried
        What a step changes, of which it is to keep a copy; empty if contacts do.
    profiles
        Of all drives, as `share_profiles` gives them.

    Raises
    ------
    InputError
        If a channel is not there, or an action does not fit.
    """
    scenario: Scenario = scene.scenario
    known = {channel.name: channel for channel in channels}
    columns_of = first_columns(channels)
    actuators = _Actuators()
    of_sort = rope_kinds(kinds[1])
    owners = {column: name for name, column in columns_of.items()}
    commanded, leaders = _commanded_winches(scene), followers(scene)
    ratios = {rope.name: rope.winch.ratio for rope in scene.ropes if rope.name in leaders}
    for sort, kind in enumerate(of_sort):
        for i, entry in enumerate(kind.table):
            name = owners[int(entry.column)]
            given = {"axial_stiffness": float(entry.axial_stiffness), "damping": float(entry.damping)}
            actuators.add(name, sort, i, commanded=name in commanded, **given)
            if name in scenario.prepared:
                entry.axial_stiffness = entry.damping = 0.0
    hulls = next((kind for kind in kinds[0] if kind.FLOATS), None)
    for i, tank in enumerate(() if scene.sea is None else scene.sea.tanks_of(scene.bodies)):
        actuators.add(tank.name, TANK, i)
    for name in _commanded(scenario, "drive"):
        actuators.add(name, DRIVE, profile_start(name, kinds, columns_of, profiles))
    paths = next((kind for kind in kinds[1] if isinstance(kind, Paths)), None)
    for number in sorted(_commanded_paths(scene)):
        actuators.add(_vehicles(scene)[number], PATH, number)
    states = records(ActuatorState, len(actuators.rows))
    states["leader"], states["arrives"] = -1, math.inf
    for name, leader in leaders.items():
        if name in actuators.numbers:
            states[actuators.numbers[name]].leader = actuators.numbers[leader]
            states[actuators.numbers[name]].ratio = ratios[name]
    weight = _Weights(scene)
    blocks = {name: block_names.index(name) for name in _commanded(scenario, "joint")}
    rolling = next((kind for kind in kinds[1] if isinstance(kind, Transporters)), None)
    helpers = {("pump", pump.name): i for i, pump in enumerate(() if scene.sea is None else scene.sea.pumps)}
    helpers |= {("levelling", one.name): i for i, one in enumerate(scene.transporters)}
    tables = _Tables(scenario, actuators.numbers, blocks, known, weight, helpers)
    system = next((one for one in kinds[2] if isinstance(one, RowSystem)), None)
    timers = records(Timer, len(tables.conditions))
    timers["since"] = timers["trial"] = math.nan
    state = SequencerState.one()
    state.continued = -math.inf
    plain, rubbing, held = of_sort
    logged = 2 * len(tables.phases) + len(tables.actions) + len(tables.limits) + 2 + TOLD_LINES
    return Sequencer(
        tracks=_table(TrackEntry, tables.tracks),
        phases=_table(PhaseEntry, tables.phases),
        conditions=_table(ConditionEntry, tables.conditions),
        limits=_table(LimitEntry, tables.limits),
        actions=_table(ActionEntry, tables.actions),
        signals=_table(SignalEntry, tables.signals),
        terms=_table(TermEntry, tables.terms),
        actuators=_table(Actuator, actuators.rows),
        ropes=plain,
        rubbing=rubbing,
        held=held,
        controlled=held,
        rope_table=plain.table,
        winches=plain.winches,
        rubbing_table=rubbing.table,
        rubbing_winches=rubbing.winches,
        held_table=held.table,
        held_winches=held.winches,
        controls=held.controls,
        control_state=held.control_state,
        tanks=records(TankData, 0) if hulls is None else hulls.tanks,
        levels=records(TankLevel, 0) if hulls is None else hulls.tank_levels,
        pumps=records(PumpData, 0) if hulls is None else hulls.pumps,
        pump_rows=records(PumpRow, 0) if hulls is None else hulls.pump_rows,
        vehicles=records(VehicleData, 0) if rolling is None else rolling.vehicles,
        groups=records(GroupData, 0) if rolling is None else rolling.groups,
        group_state=records(GroupState, 0) if rolling is None else rolling.group_state,
        vehicle_state=records(VehicleState, 0) if rolling is None else rolling.vehicle_state,
        profiles=profiles,
        paths=_table(
            PathPieces,
            []
            if paths is None
            else [filled(PathPieces, first=path.first_piece, count=path.pieces) for path in paths.table],
        ),
        path_pieces=np.zeros((0, 4)) if paths is None else paths.pieces,
        path_legs=np.zeros((0, 5)) if paths is None else paths.legs,
        path_plan=np.zeros((0, 4)) if paths is None else paths.pieces.copy(),
        state=state,
        track_state=records(TrackState, len(tables.tracks)),
        actuator_state=states,
        timers=timers,
        passed=records(Worst, len(tables.limits)),
        values=np.zeros(len(tables.signals)),
        log=records(LogEntry, logged),
        trial=np.zeros(len(tables.signals)),
        joint_rows=lane_records(Row, 0, 1) if system is None else system.rows,
        lanes=1 if system is None else system.lanes,
        record=np.zeros(width),
        plan=records(MoveRow, MOVE_ROWS),
        column=columns,
        beside=placed(TrackOutputs, columns),
        stops_at_end=scenario.stops_at_end,
        carried=carried,
        saved=np.zeros_like(carried),
    )


def rope_kinds(joints: Sequence[Any]) -> tuple[Ropes, Ropes, ControlledRopes]:
    """Kinds of ropes by their sort, empty ones where a scene has none."""
    found: dict[int, Any] = {
        PLAIN_ROPE: _no_ropes(),
        RUBBING_ROPE: _no_ropes(),
        HELD_ROPE: _no_controlled_ropes(),
    }
    for kind in joints:
        if isinstance(kind, Ropes) and kind.COMMANDED:
            rubs = "sheaves" in kind._fields
            found[
                HELD_ROPE if isinstance(kind, ControlledRopes) else RUBBING_ROPE if rubs else PLAIN_ROPE
            ] = kind
    return found[PLAIN_ROPE], found[RUBBING_ROPE], found[HELD_ROPE]


def profile_start(
    name: str, kinds: tuple[tuple[Any, ...], ...], columns: Mapping[str, int], profiles: NDArray[np.float64]
) -> int:
    """Where the profile of a drive begins among all that are shared."""
    owner, _, axis = name.rpartition(".")
    for row, group in enumerate(kinds):
        for kind in group:
            array = getattr(kind, ("constants", "profiles")[row], None)
            if array is None or (row == 0 and not kind.FRAMES) or not np.may_share_memory(array, profiles):
                continue
            base = (array.ctypes.data - profiles.ctypes.data) // profiles.itemsize
            for entry in kind.table:
                if row == 1 and int(entry.column) == columns.get(name):
                    return int(base + entry.profile)
                if row == 0 and int(entry.column) == columns.get(owner):
                    place = DRIVE_HEAD - len(AXES) + AXES.index(axis)
                    return int(base + entry.drive + array[int(entry.drive) + place])
    raise AssertionError(name)


class _Weights:
    """Weights of bodies [N]."""

    def __init__(self, scene: Any) -> None:
        from heavylift.solver.scene.scene import Gravity

        self.bodies = {body.name: body for body in scene.bodies}
        gravity = sum((f.acceleration for f in scene.forces if isinstance(f, Gravity)), np.zeros(3))
        self.gravity = float(np.linalg.norm(gravity))

    def of(self, names: Sequence[str]) -> float:
        """Sum over some bodies [N]; 1 of none.

        Raises
        ------
        InputError
            If one is not there, or nothing weighs anything.
        """
        total = 0.0
        for name in names:
            body = self.bodies.get(name)
            known = None if body is None else body.mass_properties
            if known is None:
                raise InputError(
                    f"{name!r} is no body with a mass of its own",
                    source="scenario",
                    key="of",
                    expected="rigid bodies, and bodies with modes",
                )
            total += float(known[0]) * self.gravity
        if names and not total > 0.0:
            raise InputError(
                "a part of a weight without gravity", source="scenario", key="of", expected="[gravity]"
            )
        return total if names else 1.0


class _Tables:
    """Rows of all tables of a scenario."""

    def __init__(
        self,
        scenario: Scenario,
        actuators: Mapping[str, int],
        blocks: Mapping[str, int],
        known: Mapping[str, Channel],
        weights: _Weights,
        helpers: Mapping[tuple[str, str], int],
    ) -> None:
        self.tracks: list[TrackEntry] = []
        self.phases: list[PhaseEntry] = []
        self.conditions: list[ConditionEntry] = []
        self.limits: list[LimitEntry] = []
        self.signals: list[SignalEntry] = []
        self.terms: list[TermEntry] = []
        for signal in scenario.signals:
            if signal.function == "arrived":
                parts = [(actuators[term.channel], 1.0) for term in signal.terms]
            else:
                parts = [found for term in signal.terms for found in _columns(term, signal, known)]
            function = FUNCTIONS.index(signal.function)
            entry = filled(SignalEntry, first=len(self.terms), terms=len(parts), function=function)
            self.signals.append(entry)
            self.terms += [filled(TermEntry, column=column, weight=weight) for column, weight in parts]
        place = {signal: i for i, signal in enumerate(scenario.signals)}
        actions = 0
        for row in scenario.rows:
            self.tracks.append(filled(TrackEntry, first=len(self.phases), phases=len(row)))
            for phase in row:
                self.phases.append(
                    filled(
                        PhaseEntry,
                        first_action=actions,
                        actions=len(phase.actions),
                        first_condition=len(self.conditions),
                        conditions=len(phase.until),
                        first_limit=len(self.limits),
                        limits=len(phase.limits),
                        any_of=phase.ends_with == "any",
                        timeout=phase.timeout or math.inf,
                    )
                )
                actions += len(phase.actions)
                self.conditions += [
                    filled(
                        ConditionEntry,
                        signal=-1 if one.signal is None else place[one.signal],
                        below=one.below,
                        value=one.value * weights.of(one.weight_of),
                        hold=one.hold,
                    )
                    for one in phase.until
                ]
                self.limits += [
                    filled(
                        LimitEntry,
                        signal=place[limit.signal],
                        below=limit.below,
                        value=limit.value * weights.of(limit.weight_of),
                        stop=limit.stop,
                    )
                    for limit in phase.limits
                ]
        self.actions = [
            action_entry(command, actuators, place, blocks, helpers) for command in scenario.commands
        ]


def _table(of: type[Record], rows: Sequence[Record]) -> Records[Any]:
    """Records of some rows, of none too."""
    return records(of, rows) if rows else records(of, 0)


def _no_ropes() -> Ropes:
    """The kind of a scene without ropes."""
    return Ropes(
        table=records(RopeEntry, 0),
        places=records(PlaceMarkers, 0),
        winches=records(WinchRow, 0),
        path=records(RopePlace, 0),
        gradient=records(PlaceGradient, 0),
        state=records(RopeState, 0),
        wraps=np.zeros(0),
        held=np.zeros(0),
        pulls=records(LineForce, 0),
    )


def _no_controlled_ropes() -> ControlledRopes:
    """The same of ropes whose winches answer to their tension."""
    none = _no_ropes()
    return ControlledRopes(
        **{name: getattr(none, name) for name in none._fields},
        controls=records(WinchControl, 0),
        control_state=records(ControlState, 0),
        tensions=records(TensionRow, 0),
    )


def _columns(term: Term, signal: Signal, known: Mapping[str, Channel]) -> list[tuple[int, float]]:
    """Columns of a term, and their weight."""
    channel = known.get(term.channel)
    if channel is None:
        near = get_close_matches(term.channel, known, 3, 0.4)
        raise InputError(
            f"{term.channel!r} in {signal.name!r} is no channel",
            source="scenario",
            key=signal.name,
            expected=f"a channel; the nearest are: {', '.join(near) or 'none'}",
        )
    if term.component:
        if term.component not in channel.components:
            raise InputError(
                f"{term.channel!r} has no component {term.component!r}",
                source="scenario",
                key=signal.name,
                expected=f"one of: {', '.join(channel.components)}",
            )
        return [(channel.column + channel.components.index(term.component), term.weight)]
    if len(channel.components) > 1 and signal.function == "sum":
        raise InputError(
            f"{term.channel!r} has {len(channel.components)} components",
            source="scenario",
            key=signal.name,
            expected=f"one of: {', '.join(channel.components)}; or norm, largest, smallest",
        )
    return [(channel.column + i, term.weight) for i in range(len(channel.components))]


def action_entry(
    command: Command,
    actuators: Mapping[str, int] | None = None,
    signals: Mapping[Signal, int] | None = None,
    blocks: Mapping[str, int] | None = None,
    helpers: Mapping[tuple[str, str], int] | None = None,
) -> ActionEntry:
    """Record of a command, with numbers in place of its names; -1 where none are given.

    Parameters
    ----------
    command
        Of an action.
    actuators, signals, blocks
        Numbers of actuators, signals, and of the blocks of joints.
    helpers
        Numbers of pumps and levelled transporters, by sort and name.
    """
    joint, helps = command.actuates == "joint", command.actuates in _FAILS
    return filled(
        ActionEntry,
        operation=command.operation,
        actuator=_number("" if joint or helps else command.name, actuators),
        value=command.value,
        speed=command.speed,
        ramp=command.ramp,
        acceleration=command.acceleration,
        jerk=command.jerk,
        leader=_number(command.leader, actuators),
        ratio=command.ratio,
        signal=-1 if command.signal is None or signals is None else signals[command.signal],
        parts=command.parts,
        dead_band=command.dead_band,
        group=command.group,
        block=_number(command.name if joint else "", blocks),
        helper=-1 if not helps or helpers is None else helpers[command.actuates, command.name],
        fails=_FAILS.get(command.actuates, FAILS_ACTUATOR),
    )


def _number(name: str, numbers: Mapping[str, int] | None) -> int:
    """Number of what has a name; -1 of nothing."""
    return numbers[name] if name and numbers is not None else -1


_FAILS = {"pump": FAILS_PUMP, "levelling": FAILS_LEVELLING}
"""What fails that is no actuator."""
