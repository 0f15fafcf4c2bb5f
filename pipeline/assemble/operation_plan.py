"""What is known of an operation before it runs: how long its phases take, and where winches, pumps and drives go.

Nothing is simulated. A phase that waits for a time, for a rope to have a length, or for something to arrive, takes a
time that is known; moves are planned as the run plans them. One that waits for something else takes anything up to its
timeout, so values are between two from there on, until something goes to a place.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import in_python
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import records
from heavylift.solver.drive import pack_profile, profile_value
from heavylift.solver.scenario.moves import MOVE_ROWS, MoveRow, plan_command, plan_leg
from heavylift.solver.scenario.packing import action_entry
from heavylift.solver.scenario.sequencer import PATH
from heavylift.solver.scene.bodies import Driven, Fixed
from heavylift.solver.scene.operation_state import AXES
from heavylift.solver.scene.operations import (
    BRAKE,
    CONNECT,
    FAIL,
    FOLLOW,
    GO_BY,
    GO_TO,
    KEEP,
    KEEP_LEVEL,
    MOVES,
    RELEASE,
    SPEED,
)
from heavylift.solver.transport.routes import Route

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from heavylift.pipeline.case.case_file import Case
    from heavylift.solver.scenario.operation import Operation
    from heavylift.solver.scene.commands import Command
    from heavylift.solver.scene.scenario import Phase, Scenario
    from heavylift.solver.scene.scene import Scene

__all__ = ["PlannedPhase", "Range", "check_hooks", "check_plan", "plan", "routes_of", "starts_of"]


@dataclass(frozen=True)
class Range:
    """Between two values [m], [rad], [kg], [s]; equal if it is known."""

    low: float
    high: float

    @property
    def known(self) -> bool:
        """Whether it is one value."""
        return math.isfinite(self.high) and self.high - self.low <= 1e-9 * max(1.0, abs(self.high))

    @property
    def text(self) -> str:
        """Words for it."""
        if not math.isfinite(self.high) and not math.isfinite(self.low):
            return "unknown"
        if self.known:
            return f"{self.high:.3f}"
        low = "any" if not math.isfinite(self.low) else f"{self.low:.3f}"
        return f"{low} to {'any' if not math.isfinite(self.high) else f'{self.high:.3f}'}"


ANYTHING = Range(-math.inf, math.inf)
ACTUATORS = frozenset({"winch", "drive", "tank", "path"})
"""What moves by a plan."""


@dataclass(frozen=True)
class PlannedPhase:
    """A phase as far as it is known before.

    Attributes
    ----------
    name
        Its name.
    takes
        How long [s].
    values
        At its end, of everything that is commanded to move: unstretched length of a rope [m], mass in a tank [kg],
        place of a drive [m], [rad].
    speeds
        Largest ones on the way.
    """

    name: str
    takes: Range
    values: Mapping[str, Range]
    speeds: Mapping[str, float]


@dataclass
class _Course:
    """Of something that moves: a planned value since the phase began, or bounds.

    Attributes
    ----------
    value
        Where it is as the phase begins.
    speed, acceleration
        Then, as far as the value is known.
    rows
        Plan; none of what stands still, or continues with its speed.
    target
        Where it comes to rest.
    arrived
        Whether it is at its commanded position.
    largest
        Speed.
    leader, ratio
        What it follows.
    """

    value: Range
    speed: float = 0.0
    acceleration: float = 0.0
    rows: Any = None
    target: Range | None = None
    arrived: bool = False
    largest: float = 0.0
    leader: str = ""
    ratio: float = 1.0

    def obey(self, command: Command) -> None:
        """Do as the run does, as far as it is known where it is; a winch makes its rope shorter as it hauls in."""
        operation = command.operation
        if operation == KEEP_LEVEL:  # beside what it does
            return
        self.leader = ""
        if operation == FOLLOW:
            self.leader, self.ratio = command.leader, command.ratio
        elif operation == KEEP or command.signal is not None:
            self.value, self.largest, self.rows, self.target = ANYTHING, command.speed, None, None
            self.speed = 0.0 if operation == KEEP else self.speed
        elif operation != BRAKE or command.value:
            self._plan(command)

    def _plan(self, command: Command) -> None:
        """Moves by the kernel of the run; bounds of what goes to a place from an unknown one."""
        sense = -1.0 if command.actuates == "winch" else 1.0
        empties = command.actuates == "tank" and command.operation == SPEED and command.value < 0.0
        to, most = (0.0, -command.value) if empties else (command.value, command.speed)
        goes = empties or command.operation == GO_TO
        if goes and not self.value.known:
            self.rows, self.largest, self.arrived, self.target = None, most, False, Range(to, to)
            return
        begin = sense * self.value.low if self.value.known else 0.0
        target = begin + to if command.operation == GO_BY else sense * to
        rows = records(MoveRow, MOVE_ROWS)
        entry, speed, acceleration = action_entry(command), sense * self.speed, sense * self.acceleration
        count = plan_command(entry, empties, begin, speed, acceleration, target, rows)
        rows = rows[:count]
        rows["value"] -= begin
        for key in ("value", "speed", "acceleration", "jerk"):
            rows[key] *= sense
        before = 0.0 if goes or command.operation == GO_BY else abs(self.speed)
        self.largest = max(before, float(np.abs(rows["speed"]).max()))
        self.rows, self.arrived, self.target = rows, False, None
        if goes:
            self.target = Range(to, to)
        elif command.operation in MOVES and rows["speed"][-1] == 0.0:
            way = float(rows["value"][-1])
            self.target = Range(self.value.low + way, self.value.high + way)

    @property
    def arrives(self) -> float:
        """Time since the phase began at which it is at rest at its commanded position [s]; not a number if unknown."""
        if self.arrived:
            return 0.0
        return math.nan if self.rows is None or self.target is None else float(self.rows["time"][-1])

    @property
    def fastest_left(self) -> float:
        """Largest speed without a command."""
        return abs(self.speed)

    def at(self, time: float) -> tuple[float, float, float]:
        """Way, speed and acceleration after a time."""
        if self.rows is None:
            return self.speed * time if self.speed else 0.0, self.speed, 0.0
        if math.isinf(time):
            end = self.rows[-1]
            return (
                math.copysign(math.inf, end.speed) if end.speed else float(end.value),
                float(end.speed),
                0.0,
            )
        row = self.rows[max(int(np.searchsorted(self.rows["time"], time, side="right")) - 1, 0)]
        d = time - row.time
        way = row.value + d * (row.speed + d * (0.5 * row.acceleration + d * row.jerk / 6.0))
        return (
            float(way),
            float(row.speed + d * (row.acceleration + 0.5 * d * row.jerk)),
            float(row.acceleration + d * row.jerk),
        )

    def reaches(self, value: float) -> float:
        """When it has a value [s]; not a number if never or unknown."""
        if not self.value.known:
            return math.nan
        way = value - self.value.low
        last = 1e7
        low, high = 0.0, math.nan
        times = [0.0, *(self.rows["time"].tolist() if self.rows is not None else []), last]
        for before, after in pairwise(times):
            if (self.at(before)[0] - way) * (self.at(after)[0] - way) <= 0.0 and self.at(after)[0] != self.at(
                before
            )[0]:
                low, high = before, after
                break
        if math.isnan(high):
            return math.nan
        begin = self.at(low)[0] - way
        for _ in range(200):
            middle = 0.5 * (low + high)
            if (self.at(middle)[0] - way) * begin > 0.0:
                low = middle
            else:
                high = middle
        return high

    def finish(self, takes: Range, *, arrives: bool) -> Range:
        """Values at the end of a phase, which it keeps for the next one; `arrives` if the phase waits for that."""
        target = self.target
        there = target is not None and (arrives or takes.low >= self.arrives * (1.0 - 1e-12))
        if there:
            assert target is not None
            found = target
        elif target is not None and self.rows is None:
            found = Range(min(self.value.low, target.low), max(self.value.high, target.high))
        else:
            times = [takes.low, takes.high]
            inside = [] if self.rows is None else self.rows["time"].tolist() + self._turns()
            times += [time for time in inside if takes.low < time < takes.high]
            ways = [self.at(time)[0] for time in times]
            found = Range(self.value.low + min(ways), self.value.high + max(ways))
        _, self.speed, self.acceleration = self.at(takes.low if takes.known else math.inf)
        left = None if there else self._rest(takes)
        if target is not None and left is None:
            self.speed = self.acceleration = 0.0
        self.value, self.rows, self.target = found, left, target if left is not None else None
        self.arrived = self.arrived or there
        return found

    def _rest(self, takes: Range) -> Any:
        """What of the plan is left behind a phase."""
        if self.rows is None or not takes.known or takes.low >= self.rows["time"][-1]:
            return None
        way, speed, acceleration = self.at(takes.low)
        first = max(int(np.searchsorted(self.rows["time"], takes.low, side="right")) - 1, 0)
        rows = self.rows[first:].copy()
        rows["time"] -= takes.low
        rows["value"] -= way
        rows["time"][0] = rows["value"][0] = 0.0
        rows["speed"][0], rows["acceleration"][0] = speed, acceleration
        return rows

    def _turns(self) -> list[float]:
        """Times at which the sense of the speed changes."""
        found = []
        for row, after in pairwise(self.rows):
            roots = np.roots([0.5 * row.jerk, row.acceleration, row.speed])
            found += [
                float(row.time + r.real)
                for r in roots
                if r.imag == 0.0 and 0.0 < r.real < after.time - row.time
            ]
        return found


class _PathCourse(_Course):
    """Of a transporter on its path, which follows its legs until the first command."""

    def __init__(self, route: Route) -> None:
        super().__init__(Range(0.0, 0.0))
        self.route = route
        self.rows = _rows(route.pieces)
        self.target = Range(*[float(route.legs[-1, 0])] * 2)
        self.largest = float(route.legs[:, 1].max())

    @property
    def fastest_left(self) -> float:
        """Of what is planned."""
        return abs(self.speed) if self.rows is None else float(np.abs(self.rows["speed"]).max())

    def obey(self, command: Command) -> None:
        """Stop, go to the end of the leg, or on as planned, by the kernel of the run."""
        legs, before, commanded = self.route.legs, self.speed, command.operation == SPEED
        first, last = (
            min(int(np.searchsorted(legs[:, 0] * (1.0 - 1e-9), way, side="right")), len(legs) - 1)
            for way in (max(self.value.low, 0.0), min(self.value.high, float(legs[-1, 0])))
        )
        end, planned, gentle, _ = map(float, legs[first])
        speed = command.value if commanded else planned
        whole = Range(*[float(legs[-1, 0])] * 2)
        if not self.value.known:
            target = Range(self.value.low, whole.high)
            if not commanded:
                target = whole
            elif speed > 0.0 and first == last:
                target = Range(end, end)
            self.rows, self.largest, self.arrived, self.target = None, max(speed, before), False, target
            return
        way = self.value.low
        rows = records(MoveRow, MOVE_ROWS)
        count = plan_leg(action_entry(command), way, before, end, planned, gentle, rows)
        self.rows, self.arrived = rows[:count], False
        self.rows["value"] -= way
        self.largest = max(before if speed == 0.0 else 0.0, float(np.abs(self.rows["speed"]).max()))
        self.target = Range(end, end)
        if speed == 0.0:
            self.target = Range(*[way + float(self.rows["value"][-1])] * 2)
        elif not commanded and first + 1 < len(legs):
            begin = int(legs[first + 1, 3])
            later = _rows(self.route.pieces[begin:])
            later["time"] += self.rows["time"][-1] - self.route.pieces[begin - 1, 0]
            later["value"] -= way
            self.rows, self.target = _joined(self.rows, later), whole
            self.largest = max(self.largest, float(legs[first:, 1].max()))


def _rows(pieces: Any) -> Any:
    """Pieces of a path as a plan."""
    rows = records(MoveRow, len(pieces))
    for key, column in zip(("time", "value", "speed", "acceleration"), pieces.T, strict=True):
        rows[key] = column
    return rows if rows["time"][0] == 0.0 else _joined(records(MoveRow, 1), rows)


def _joined(first: Any, then: Any) -> Any:
    """A plan and one that follows it."""
    rows = records(MoveRow, len(first) + len(then))
    for key in ("time", "value", "speed", "acceleration", "jerk"):
        rows[key] = np.concatenate([first[key], then[key]])
    return rows


def plan(
    scenario: Scenario, starts: Mapping[str, float], routes: Mapping[str, Route] | None = None
) -> list[list[PlannedPhase]]:
    """Times and values of the phases of all tracks.

    Parameters
    ----------
    scenario
        Checked.
    starts
        Unstretched lengths of ropes, masses in tanks, places of drives, ways of transporters at the start, by name.
    routes
        Of the commanded transporters, by name.
    """
    return [_plan_row(row, starts, routes or {}) for row in scenario.rows]


def _plan_row(
    phases: Sequence[Phase], starts: Mapping[str, float], routes: Mapping[str, Route]
) -> list[PlannedPhase]:
    commands = [action.command() for phase in phases for action in phase.actions]
    moved = [one for one in commands if one.actuates in ACTUATORS and one.operation != BRAKE]
    names = dict.fromkeys(one.name for one in moved)
    courses = {
        name: _PathCourse(routes[name]) if name in routes else _Course(Range(starts[name], starts[name]))
        for name in names
    }
    found = []
    for phase in phases:
        for course in courses.values():
            course.largest = course.fastest_left
        for action in phase.actions:
            command = action.command()
            if command.name in courses:
                _obey(courses[command.name], command)
        takes = _takes(phase, courses)
        leaders = {name: course.at(takes.low)[0] for name, course in courses.items() if not course.leader}
        values = {}
        arrivals = [
            one.signal.terms
            for one in phase.until
            if one.signal is not None and one.signal.function == "arrived"
        ]
        together = len(phase.until) == 1 or phase.ends_with == "all"
        waited = {term.channel for terms in arrivals for term in terms} if together else set()
        for name, course in courses.items():
            if course.leader:
                known = takes.known and course.leader in leaders and course.value.known
                way = course.ratio * leaders.get(course.leader, 0.0)
                value = Range(course.value.low + way, course.value.high + way) if known else ANYTHING
                values[name] = course.value = value
                course.largest = (
                    abs(course.ratio) * courses[course.leader].largest if course.leader in courses else 0.0
                )
                continue
            values[name] = course.finish(takes, arrives=name in waited)
            if together:
                values[name] = course.value = _as_waited(phase, name, course.value)
        found.append(
            PlannedPhase(phase.name, takes, values, {name: c.largest for name, c in courses.items()})
        )
    return found


def _as_waited(phase: Phase, name: str, value: Range) -> Range:
    """Length of a rope at the end of a phase that waits for it to be above or below a value."""
    for one in phase.until:
        if one.signal is not None and one.signal.name == f"{name}.rest_length":
            low, high = value.low, value.high
            value = (
                Range(min(low, one.value), min(high, one.value))
                if one.below
                else Range(max(low, one.value), max(high, one.value))
            )
    return value


def _obey(course: _Course, command: Command) -> None:
    """Let one of them do something."""
    if command.operation == CONNECT:
        course.value = ANYTHING  # that of its path then
    elif command.operation != RELEASE and (command.operation != FAIL or command.value):
        course.obey(command)


def _takes(phase: Phase, courses: Mapping[str, _Course]) -> Range:
    """How long a phase may take [s]."""
    longest = phase.timeout or math.inf
    lows, highs = [], []
    for condition in phase.until:
        signal, low = condition.signal, condition.hold
        when = math.nan
        if signal is None:
            when = condition.value
        elif signal.function == "arrived":
            times = [
                courses[term.channel].arrives if term.channel in courses else math.nan
                for term in signal.terms
            ]
            when = max(times) if not any(map(math.isnan, times)) else math.nan
        elif len(signal.terms) == 1 and signal.name.endswith(".rest_length"):
            course = courses.get(signal.name.removesuffix(".rest_length"))
            when = math.nan if course is None else course.reaches(condition.value)
        lows.append(low + (0.0 if math.isnan(when) else when))
        highs.append(longest if math.isnan(when) else low + when)
    if not lows:
        return Range(0.0, longest)
    choose = min if phase.ends_with == "any" else max
    return Range(min(choose(lows), longest), min(choose(highs), longest))


def starts_of(scene: Scene, operation: Operation) -> dict[str, float]:
    """Unstretched lengths of ropes, masses in tanks, places of drives, ways of transporters at the start, by name."""
    found = operation.rope_lengths | {one.name: 0.0 for one in scene.transporters if one.legs}
    found |= {tank.name: tank.start_mass for tank in (() if scene.sea is None else scene.sea.tanks)}
    drives = {joint.name: getattr(joint, "drive", None) for joint in scene.joints}
    for body in scene.bodies:
        drives |= {f"{body.name}.{axis}": getattr(getattr(body, "motion", None), axis, None) for axis in AXES}
    for name, profile in drives.items():
        value = in_python(profile_value)(pack_profile(profile), 0, 0.0)[0]
        found.setdefault(name, float(value))
    return found


def routes_of(scene: Scene, operation: Operation) -> dict[str, Route]:
    """Routes of the commanded transporters, by name, without their plane."""
    sequencer, found = operation.sequencer, {}
    vehicles = [one.name for one in scene.transporters]
    told = {one.name for one in operation.scenario.commands if one.actuates == "path"}
    actuators = [int(actuator.number) for actuator in sequencer.actuators if int(actuator.sort) == PATH]
    for name, number in zip([name for name in vehicles if name in told], actuators, strict=True):
        path = sequencer.paths[number]
        pieces = sequencer.path_plan[path.first : path.first + path.count - MOVE_ROWS]
        legs = sequencer.path_legs[sequencer.path_legs[:, 0] == number, 1:]
        found[name] = Route(np.zeros((0, 0)), pieces, legs)
    return found


def check_plan(case: Case, phases: Sequence[Sequence[PlannedPhase]], starts: Mapping[str, float]) -> None:
    """Refuse what is certain to go wrong: too little time, a rope hauled in whole, a hook that comes to its crown.

    Raises
    ------
    InputError
        The first such phase.
    """
    ropes = {rope.name for rope in case.ropes}
    falls = {f"{one.name}_rope": one for one in case.falls}
    trolleys = {
        f"{crane.name}_trolley_{i + 1}.x": (f"{crane.name}_girder.x", trolley.position, 0.5 * crane.span)
        for crane in case.gantry_cranes
        for i, trolley in enumerate(crane.trolleys)
    }
    duration = math.inf if case.simulate is None else case.simulate.duration or math.inf
    for row, track in enumerate(phases):
        needed = 0.0
        for i, phase in enumerate(track):
            needed += phase.takes.low
            if needed > duration * (1.0 + 1e-9):
                raise InputError(
                    f"phase {phase.name!r} ends at {needed:.6g} s at the earliest, and the run takes {duration:.6g} s",
                    source=case.file,
                    key=f"scenario.tracks.{row - 1}.phases.{i}" if row else f"scenario.phases.{i}",
                    expected="a longer duration",
                )
            key = f"scenario.tracks.{row - 1}.phases.{i}" if row else f"scenario.phases.{i}"
            for name, value in phase.values.items():
                if name in trolleys:
                    _check_trolley(case, key, phase, name, *trolleys[name])
                if name not in ropes or not math.isfinite(value.high):
                    continue
                if value.high <= 0.0:
                    raise InputError(
                        f"phase {phase.name!r} hauls in {starts[name] - value.high:.6g} m of {name!r} or more, which "
                        f"has {starts[name]:.6g} m",
                        source=case.file,
                        key=key,
                        expected="less",
                    )
                hook = falls.get(name)
                hoisted = 0.0 if hook is None else (starts[name] - value.high) / hook.parts
                if hook is not None and hoisted >= hook.drop - 2.0 * hook.sheave_radius:
                    raise InputError(
                        f"phase {phase.name!r} hoists the block of {hook.name!r}, {hook.drop:.6g} m below its crown, "
                        f"by {hoisted:.6g} m",
                        source=case.file,
                        key=key,
                        expected=f"less than {hook.drop - 2.0 * hook.sheave_radius:.6g} m",
                    )


def _check_trolley(
    case: Case, key: str, phase: PlannedPhase, name: str, girder: str, position: float, half: float
) -> None:
    """Refuse a trolley that is certain to be beyond the end of its girder behind a phase."""
    at, moved = phase.values[name], phase.values.get(girder, Range(0.0, 0.0))
    low, high = at.low - moved.high + position, at.high - moved.low + position
    if low > half * (1.0 + 1e-9) or high < -half * (1.0 + 1e-9):
        raise InputError(
            f"phase {phase.name!r} drives {name.removesuffix('.x')!r} to {low if low > 0.0 else high:.6g} m from the "
            f"middle of a girder of {2.0 * half:.6g} m",
            source=case.file,
            key=key,
            expected=f"at most {half:.6g} m",
        )


def check_hooks(case: Case, scene: Scene) -> None:
    """Refuse a commanded height of a hook above the crown of its falls, where the crown does not move vertically.

    Raises
    ------
    InputError
        The first one.
    """
    scenario = scene.scenario
    assert scenario is not None
    bodies = {body.name: body for body in scene.bodies}
    told = {one.name for one in scenario.commands if one.actuates == "drive" and one.operation in MOVES}
    tops = {}
    for falls in case.falls:
        carrier, block = bodies.get(falls.crown.body), bodies[f"{falls.name}_block"]
        if carrier is None or _keeps_its_height(carrier, told):
            crown = float(np.asarray(block.position)[2]) + falls.drop
            tops[f"{falls.name}_rope"] = falls, crown - 2.0 * falls.sheave_radius
    for number, phase in enumerate(scenario.all_phases):
        for action in phase.actions:
            command = action.command()
            if command.signal is None or command.name not in tops:
                continue
            falls, top = tops[command.name]
            if command.value >= top:
                depth = falls.block.hook_depth
                raise InputError(
                    f"phase {phase.name!r} hoists {falls.name!r} to {command.value - depth:.6g} m, and its crown stops "
                    f"it at {top - depth:.6g} m",
                    source=case.file,
                    key=_key_of_phase(scenario, number),
                    expected="a hook below its crown",
                )


def _keeps_its_height(body: Any, told: set[str]) -> bool:
    """Whether a body is driven, or fixed, and neither rises nor turns."""
    motion = getattr(body, "motion", None)
    if not isinstance(motion, (Fixed, Driven)):
        return False
    return all(
        getattr(motion, axis, None) is None and f"{body.name}.{axis}" not in told for axis in ("z", "angle")
    )


def _key_of_phase(scenario: Scenario, number: int) -> str:
    """Key in a case of a phase by its number among all tracks."""
    for row, phases in enumerate(scenario.rows):
        if number < len(phases):
            return f"scenario.tracks.{row - 1}.phases.{number}" if row else f"scenario.phases.{number}"
        number -= len(phases)
    raise AssertionError(number)
