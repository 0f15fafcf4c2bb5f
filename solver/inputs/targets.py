"""What inputs drive: tables of winches, drives, tanks and controllers, rewritten when an input is set.

A table is written by the kernels of the scenario (`heavylift.solver.scenario.sequencer`), as Python functions: from now
on a value that changes at a rate, and is held from a time on.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import in_python
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, records
from heavylift.solver.inputs.kind import Inputs
from heavylift.solver.inputs.packing import with_tables
from heavylift.solver.joints.coordinate import ANGLE, joint_coordinate
from heavylift.solver.scene.descriptions import recorded_channels
from heavylift.solver.scene.speed_profiles import FOREVER

if TYPE_CHECKING:
    from heavylift.solver.scenario.moves import MoveRow
    from heavylift.solver.scene.descriptions import ChannelKind

__all__ = ["BoundInputs", "Target", "bind_inputs"]

LAST = 1e-9
"""Part of the time in which a drive changes, by which that lasts longer."""


@dataclass(frozen=True, eq=False)
class BoundInputs:
    """Inputs of a packed scene.

    Attributes
    ----------
    kind
        Their kind.
    inputs
        Their descriptions.
    targets
        What each drives.
    records
        What each records.
    """

    kind: Inputs
    inputs: tuple[Any, ...]
    targets: tuple[Target, ...]
    records: tuple[ChannelKind, ...]


class Target:
    """What an input drives; this one is nothing: the input acts itself.

    Attributes
    ----------
    lowest, highest
        What it can do.
    why
        Why no more, as words.
    steady
        Whether it takes no rate.
    """

    lowest, highest, why, steady = -math.inf, math.inf, "", False

    def start(self) -> float | None:
        """Value that it has at the start, of what has one without an input."""
        return None

    def put(self, time: float, value: float, rate: float, until: float) -> None:
        """Write its table: a value that changes at a rate from a time on [s], until another one, when it is held."""

    def displace(self, time: float, amount: float) -> None:
        """Let the place of what a speed drives be another one, by an amount of that speed times a time."""

    def end(self, time: float, value: float, rate: float, until: float, step: float) -> tuple[float, str]:
        """When it can do so no more [s], and why; infinite if it always can. `step` is that of the run [s]."""
        del time, value, rate, until, step
        return math.inf, ""


class _Planned(Target):
    """What reads a plan of cubics."""

    def __init__(self) -> None:
        from heavylift.solver.scenario.moves import MOVE_ROWS, MoveRow

        self._plan: Records[MoveRow] = records(MoveRow, MOVE_ROWS)

    def _put_rows(self, *rows: tuple[float, float, float, float]) -> int:
        """Time since now, value, speed and acceleration of each row; how many there are."""
        for to, (time, value, speed, acceleration) in zip(self._plan, rows, strict=False):
            to.time, to.value, to.speed, to.acceleration, to.jerk = time, value, speed, acceleration, 0.0
        return len(rows)

    def _put_speed(self, now: float, place: float, value: float, rate: float, until: float) -> int:
        """A speed that changes at a rate until it is held."""
        if rate == 0.0:
            return self._put_rows((0.0, place, value, 0.0))
        span = min(until - now, FOREVER)
        end = value + rate * span
        return self._put_rows(
            (0.0, place, value, rate), (span, place + span * (value + 0.5 * rate * span), end, 0.0)
        )

    def _put_place(self, now: float, place: float, rate: float, until: float, *, linear_speeds: bool) -> int:
        """A place that changes at a rate until it is held; where speeds are linear the last row stands twice."""
        if rate == 0.0 or math.isinf(until):
            return self._put_rows((0.0, place, rate, 0.0))
        span = until - now
        end = place + rate * span
        twice = [(span, end, rate, 0.0)] * linear_speeds
        return self._put_rows((0.0, place, rate, 0.0), *twice, (span, end, 0.0, 0.0))


class WinchTarget(_Planned):
    """The winch of a rope, by its speed or the unstretched length of the rope, with those that follow it.

    Parameters
    ----------
    ropes
        Names, kinds, numbers in these and ratios: of the rope itself and of those that follow.
    by_length
        Whether the input is a length.
    fastest
        Largest speed [m/s].
    """

    def __init__(
        self, ropes: Sequence[tuple[str, Any, int, float]], *, by_length: bool, fastest: float | None
    ) -> None:
        super().__init__()
        self._ropes, self._by_length, self.fastest = tuple(ropes), by_length, fastest
        if by_length:
            self.lowest, self.why = 0.0, "a rope has a length"
        elif fastest is not None:
            self.lowest, self.highest, self.why = -fastest, fastest, f"the winch does {fastest:g} m/s at most"

    def _hauled(self, kind: Any, number: int, time: float) -> float:
        """Length hauled in at a time [m]."""
        from heavylift.solver.force_elements.wire_rope import table_state

        entry = kind.table[number]
        return in_python(table_state)(kind.winches, int(entry.winch), int(entry.winch_rows), time)[0]

    def start(self) -> float | None:
        """Unstretched length [m]."""
        _, kind, number, _ = self._ropes[0]
        return float(kind.table[number].start_length) if self._by_length else None

    def put(self, time: float, value: float, rate: float, until: float) -> None:
        """Rows of the winches."""
        from heavylift.solver.scenario.sequencer import write_winch

        if self._by_length:
            count = self._put_place(time, 0.0, -rate, until, linear_speeds=True)
        else:
            count = self._put_speed(time, 0.0, value, rate, until)
        for place, (_, kind, number, ratio) in enumerate(self._ropes):
            hauled = self._hauled(kind, number, time)
            if self._by_length and place == 0:  # as the value says, whatever rounding has left before
                hauled = float(kind.table[number].start_length) - value
            in_python(write_winch)(kind, number, count, time, ratio, hauled, self._plan)

    def displace(self, time: float, amount: float) -> None:
        """A length hauled in more."""
        del time
        for _, kind, number, ratio in self._ropes:
            kind.table[number].start_length -= ratio * amount
            kind.state[number].rest -= ratio * amount

    def end(self, time: float, value: float, rate: float, until: float, step: float) -> tuple[float, str]:
        """Two steps before the whole rope is hauled in, as in a scenario."""
        speed, growth = (-rate, 0.0) if self._by_length else (value, rate)
        span = until - time
        if self._by_length and self.fastest is not None and abs(speed) > self.fastest * (1.0 + 1e-9):
            return (
                time,
                f"the winch would move with {abs(speed):g} m/s, and does {self.fastest:g} m/s at most",
            )
        first, why = math.inf, ""
        for name, kind, number, ratio in self._ropes:
            left = float(kind.table[number].start_length) - self._hauled(kind, number, time)
            if hasattr(kind, "control_state"):  # its brake slips more, perhaps, until then
                left += float(kind.control_state[number].paid_out)
            last = speed + growth * span if growth != 0.0 else speed
            fastest = max(ratio * speed, ratio * last, 0.0)
            left -= 2.0 * step * (fastest if math.isfinite(fastest) else max(ratio * speed, 0.0))
            behind = 0.0 if self._by_length else ratio * last
            when = time + _used_up(left, ratio * speed, ratio * growth, span, behind)
            if when < first:
                first, why = when, f"the winch of {name!r} has hauled in the whole rope"
        return first, why


def _used_up(left: float, speed: float, growth: float, span: float, behind: float) -> float:
    """When a length is used up at a speed that grows over a span of time and is another one behind it; or never."""
    if left <= 0.0:
        return 0.0 if speed > 0.0 or growth > 0.0 or behind > 0.0 else math.inf
    # left = speed t + growth t^2/2
    root = speed * speed + 2.0 * growth * left
    if root >= 0.0:
        divisor = speed + math.sqrt(root)
        found = 2.0 * left / divisor if divisor > 0.0 else math.inf
        if found <= span:
            return found
    if math.isinf(span) or behind <= 0.0:
        return math.inf
    return span + (left - span * (speed + 0.5 * growth * span)) / behind


class DriveTarget(_Planned):
    """A drive of a joint or of a frame, by its speed or its place.

    Parameters
    ----------
    profiles, first
        All profiles, and where that of the drive begins.
    by_place
        Whether the input is a place.
    """

    def __init__(self, profiles: NDArray[np.float64], first: int, *, by_place: bool) -> None:
        super().__init__()
        self._profiles, self._first, self._by_place = profiles, first, by_place

    def _place(self, time: float) -> float:
        from heavylift.solver.drive import profile_value

        return in_python(profile_value)(self._profiles, self._first, time)[0]

    def start(self) -> float | None:
        """Value of the coordinate, or displacement."""
        return self._place(0.0) if self._by_place else None

    def put(self, time: float, value: float, rate: float, until: float) -> None:
        """Cubics of the profile."""
        from heavylift.solver.scenario.sequencer import write_profile

        if self._by_place:
            count = self._put_place(time, value, rate, until, linear_speeds=False)
        else:
            count = self._put_speed(time, self._place(time), value, rate, until)
        if count > 1:  # what is recorded at the end is how the frame came there
            last = self._plan[count - 1]
            longer = LAST * float(last.time)
            last.time, last.value = last.time + longer, last.value + longer * last.speed
        in_python(write_profile)(self._profiles, self._first, count, time, self._plan)

    def displace(self, time: float, amount: float) -> None:
        """Another place, with the speed that it has."""
        from heavylift.solver.drive import profile_value
        from heavylift.solver.scenario.sequencer import write_profile

        place, speed, _ = in_python(profile_value)(self._profiles, self._first, time)
        count = self._put_rows((0.0, place + amount, speed, 0.0))
        in_python(write_profile)(self._profiles, self._first, count, time, self._plan)


class TankTarget(_Planned):
    """Water of a tank, by its rate: it stops where the tank is empty, and a run where it is full.

    Parameters
    ----------
    name
        Of the tank.
    hulls, number
        Kind of the hulls, and number of the tank.
    """

    steady = True

    def __init__(self, name: str, hulls: Any, number: int) -> None:
        super().__init__()
        self._name, self._hulls, self._number = name, hulls, number

    def _mass(self, time: float) -> float:
        tank = self._hulls.tanks[self._number]
        rows = self._hulls.tank_levels[int(tank.first) : int(tank.first) + int(tank.count)]
        return float(np.interp(time, rows["time"], rows["mass"]))

    def put(self, time: float, value: float, rate: float, until: float) -> None:
        """Levels of the tank."""
        del rate, until
        from heavylift.solver.scenario.sequencer import write_levels

        mass = self._mass(time)
        rows = [(0.0, mass, value if mass > 0.0 else max(value, 0.0), 0.0)]
        if value < 0.0 < mass:
            rows.append((-mass / value, 0.0, 0.0, 0.0))
        count = self._put_rows(*rows)
        in_python(write_levels)(
            self._hulls.tanks, self._hulls.tank_levels, self._number, count, time, self._plan
        )

    def end(self, time: float, value: float, rate: float, until: float, step: float) -> tuple[float, str]:
        """Where it is full."""
        del rate, until, step
        room = float(self._hulls.tanks[self._number].capacity) - self._mass(time)
        if value <= 0.0 or math.isinf(room):
            return math.inf, ""
        return time + max(room, 0.0) / value, f"tank {self._name!r} is full"


class AimTarget(Target):
    """A set point of a controller.

    Parameters
    ----------
    aims, number
        What all controllers keep, and which of them.
    """

    steady = True

    def __init__(self, aims: Any, number: int) -> None:
        self._aims, self._number = aims, number

    def start(self) -> float | None:
        """What it is without an input."""
        return float(self._aims[self._number].value)

    def put(self, time: float, value: float, rate: float, until: float) -> None:
        """The aim itself."""
        del time, rate, until
        self._aims[self._number].value = value


class FlowTarget(Target):
    """The speed of a wind or a current, with all that follows from it: profile and gust.

    Parameters
    ----------
    loads, number
        Kind of the loads, and which of its fields.
    field
        The wind or current.
    """

    steady = True
    lowest = 0.0

    def __init__(self, loads: Any, number: int, field: Any) -> None:
        from heavylift.solver.scene.wind_loads import WindField
        from heavylift.solver.water.wind.spectrum import LARGEST_CURRENT, LARGEST_WIND

        self._loads, self._number, self._field = loads, number, field
        self._blows = isinstance(field, WindField)
        self.highest = LARGEST_WIND if self._blows else LARGEST_CURRENT

    def start(self) -> float | None:
        """Its speed without an input, as the case gives it."""
        return float(self._field.speed)

    def put(self, time: float, value: float, rate: float, until: float) -> None:
        """The field."""
        del time, rate, until
        from heavylift.solver.water.wind.packing import put_wind

        data = self._loads.fields[self._number]
        rows = np.array([[0.0, value]])
        if self._blows:
            rows, _ = put_wind(replace(self._field, speed=value), data)
        if len(rows):
            self._loads.profiles[int(data.profile_first)].value = rows[0, 1]


class TurnTarget(Target):
    """The direction of a wind or a current.

    Parameters
    ----------
    turns, first
        Directions over the time, and the first of its two rows.
    """

    def __init__(self, turns: Any, first: int) -> None:
        self._turns, self._first = turns, first

    def start(self) -> float | None:
        """Its direction without an input."""
        return float(self._turns[self._first].value)

    def put(self, time: float, value: float, rate: float, until: float) -> None:
        """Two rows, held behind the second one."""
        span = min(until - time, FOREVER) if rate != 0.0 else 1.0
        begin, end = self._turns[self._first], self._turns[self._first + 1]
        begin.at, begin.value = time, value
        end.at, end.value = time + span, value + rate * span


def bind_inputs(
    scene: Any,
    kinds: tuple[tuple[Any, ...], tuple[Any, ...], tuple[Any, ...]],
    forces: list[Any],
    controllers: Any,
    channels: Sequence[Any],
    profiles: NDArray[np.float64],
) -> BoundInputs:
    """Give inputs the tables that they write, in their values at the start, and their kind what it is to carry.

    Parameters
    ----------
    scene
        With inputs.
    kinds
        Of bodies, joints and systems, with room in the tables.
    forces
        Kinds of forces, in which that of the inputs is replaced.
    controllers
        Kind of the controllers of ballast; None without.
    channels
        Of the record.
    profiles
        Of all drives that something changes.

    Raises
    ------
    InputError
        If a drive has a plan of its own, a tank follows a schedule, or a controller does not keep what is to be set.
    """
    place = next(i for i, kind in enumerate(forces) if isinstance(kind, Inputs))
    binder = _Binder(scene, kinds, forces, controllers, channels, profiles)
    targets = tuple(map(binder.target, scene.inputs))
    kind = with_tables(forces[place], **binder.carried())
    forces[place] = kind
    for one, target, state in zip(scene.inputs, targets, kind.state, strict=True):
        begun = target.start()
        if begun is not None:
            state.value = begun
        elif one.DRIVES:
            target.put(0.0, float(state.value), 0.0, math.inf)
    return BoundInputs(kind, tuple(scene.inputs), targets, tuple(map(binder.records, scene.inputs)))


class _Binder:
    """Finds the tables of what inputs drive."""

    def __init__(
        self,
        scene: Any,
        kinds: tuple[tuple[Any, ...], tuple[Any, ...], tuple[Any, ...]],
        forces: list[Any],
        controllers: Any,
        channels: Sequence[Any],
        profiles: NDArray[np.float64],
    ) -> None:
        self._scene, self._kinds, self._forces, self._controllers = scene, kinds, forces, controllers
        self._channels, self._profiles = channels, profiles

    def target(self, one: Any) -> Target:
        """What an input drives.

        Raises
        ------
        InputError
            With its name and key.
        """
        if not one.DRIVES:
            return Target()
        made: Mapping[str, Any] = {
            "winch": self._winch,
            "drive": self._drive,
            "tank": self._tank,
            "controller": self._aim,
            "fluid": self._fluid,
        }
        found: Target = made[one.DRIVES](one)
        return found

    def records(self, one: Any) -> ChannelKind:
        """What an input records, along a joint that of its coordinate."""
        coordinate = ""
        if hasattr(one, "joint"):
            joint = next(joint for joint in self._scene.joints if joint.name == one.joint)
            coordinate = "angle" if joint_coordinate(joint, one) == ANGLE else "travel"
        return recorded_channels(type(one), coordinate)[0]

    def carried(self) -> dict[str, Any]:
        """Tables that inputs write and nothing else carries."""
        driven = {one.DRIVES for one in self._scene.inputs}
        found: dict[str, Any] = {}
        if "controller" in driven:
            found["aims"] = self._controllers.aims
        if "fluid" in driven:
            loads = self._loads
            found |= {"fields": loads.fields, "heights": loads.profiles, "turns": loads.turns}
        if self._scene.scenario is not None:
            return found
        if "winch" in driven:
            from heavylift.solver.scenario.packing import rope_kinds

            plain, rubbing, held = rope_kinds(self._kinds[1])
            found |= {
                "winches": plain.winches,
                "rubbing_winches": rubbing.winches,
                "held_winches": held.winches,
            }
        if "tank" in driven:
            found["levels"] = self._hulls.tank_levels
        if "drive" in driven:
            found["profiles"] = self._profiles
        return found

    @property
    def _hulls(self) -> Any:
        return next(kind for kind in self._kinds[0] if kind.FLOATS)

    @property
    def _loads(self) -> Any:
        from heavylift.solver.water.wind.forces import FluidLoads

        return next(kind for kind in self._forces if isinstance(kind, FluidLoads))

    def _fluid(self, one: Any) -> Target:
        from heavylift.solver.water.wind.forces import TablePoint

        what = one.PART
        names = [field.name for field in self._scene.sea.fields]
        number = names.index(one.fluid)
        field, loads = self._scene.sea.fields[number], self._loads
        if not isinstance(getattr(field, what), Real) or (
            what == "speed" and getattr(field, "fluctuation", None) is not None
        ):
            raise InputError(
                f"the {what} of {one.fluid!r} is a table, or fluctuates",
                source=one.name,
                key="fluid",
                expected=f"a wind or current with a constant {what}",
            )
        if what == "speed":
            return FlowTarget(loads, number, field)
        place = next(i for i, kind in enumerate(self._forces) if kind is loads)
        data = loads.fields[number]
        turns = records(TablePoint, [*loads.turns, *records(TablePoint, 2)])
        data.turn_first, data.turn_count = len(turns) - 2, 2
        self._forces[place] = loads._replace(turns=turns)
        target = TurnTarget(turns, len(turns) - 2)
        target.put(0.0, float(field.direction), 0.0, math.inf)
        return target

    @property
    def _columns(self) -> dict[str, int]:
        from heavylift.solver.scenario.packing import first_columns

        return first_columns(self._channels)

    def _winch(self, one: Any) -> Target:
        from heavylift.solver.scenario.packing import followers, rope_kinds

        columns = self._columns
        places = {
            int(entry.column): (kind, i)
            for kind in rope_kinds(self._kinds[1])
            for i, entry in enumerate(kind.table)
        }
        ropes = {rope.name: rope for rope in self._scene.ropes}
        names = [one.rope, *(name for name, leader in followers(self._scene).items() if leader == one.rope)]
        ratios = [1.0, *(ropes[name].winch.ratio for name in names[1:])]
        winch = ropes[one.rope].winch
        return WinchTarget(
            [(name, *places[columns[name]], ratio) for name, ratio in zip(names, ratios, strict=True)],
            by_length=one.MOVES,
            fastest=None if winch is None else winch.fastest,
        )

    def _drive(self, one: Any) -> Target:
        from heavylift.solver.packed_profiles import profile_parts
        from heavylift.solver.scenario.packing import profile_start

        first = profile_start(one.target, self._kinds, self._columns, self._profiles)
        _, cubics, _ = profile_parts(self._profiles, first)
        if cubics[:, :3].any() or np.ptp(cubics[:, 3]) != 0.0:
            raise InputError(
                f"the drive of {one.target!r} has a plan of its own",
                source=one.name,
                key=one.TARGET,
                expected="a drive that stands: speeds of 0, or one value at all times",
            )
        return DriveTarget(self._profiles, first, by_place=one.MOVES)

    def _tank(self, one: Any) -> Target:
        tanks = self._scene.sea.tanks_of(self._scene.bodies)
        number = next(i for i, tank in enumerate(tanks) if tank.name == one.tank)
        if tanks[number].mass is None:
            raise InputError(
                f"tank {one.tank!r} follows a schedule",
                source=one.name,
                key="tank",
                expected="a tank with 'mass', that at the start",
            )
        return TankTarget(one.tank, self._hulls, number)

    def _aim(self, one: Any) -> Target:
        names = [controller.name for controller in self._scene.sea.controllers]
        number = names.index(one.controller)
        kept = self._scene.sea.controllers[number].components["error"]
        if one.keeps not in kept:
            raise InputError(
                f"{one.controller!r} does not keep {one.keeps!r}",
                source=one.name,
                key="keeps",
                expected=f"one of: {', '.join(kept)}",
            )
        first = int(self._controllers.table[number].first_aim)
        return AimTarget(self._controllers.aims, first + kept.index(one.keeps))
