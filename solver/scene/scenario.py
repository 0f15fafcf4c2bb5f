"""What a user says of an operation: phases in a row, what each of them does, waits for, and must not see."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.connections import controlled

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

__all__ = [
    "AXES",
    "MOVES",
    "Action",
    "Condition",
    "Connect",
    "DriveSpeed",
    "DriveTo",
    "Limit",
    "Movable",
    "Note",
    "PathGoOn",
    "PathSpeed",
    "Phase",
    "Release",
    "ReleaseJoint",
    "Scenario",
    "Signal",
    "TankRate",
    "Term",
    "Track",
    "WinchBrake",
    "WinchFollow",
    "WinchHaul",
    "WinchLength",
    "WinchLevel",
    "WinchSpeed",
    "WinchTension",
    "acted_on",
    "check_scenario",
    "drives_of",
    "loose_ropes",
    "releases_of",
]


@dataclass(frozen=True)
class Term:
    """A component of a channel, times a weight.

    Attributes
    ----------
    channel, component
        Such as ``"hook.position"`` and ``"z"``; no component of a channel with one, or for all of them.
    weight
        What it is multiplied by.
    """

    channel: str
    component: str = ""
    weight: float = 1.0


@dataclass(frozen=True)
class Signal:
    """A number that is looked at after each step.

    Attributes
    ----------
    terms
        Of which it is made.
    function
        Sum of the terms; the norm of a vector with these components; the largest or the smallest of them. `arrived`:
        time since the last of the things with the names of the terms came to rest where it was told to go; `told`, of
        no terms: 1 since someone outside said "continue" in a phase, else 0.
    text
        Its name in messages; made from the terms if empty.
    """

    terms: tuple[Term, ...]
    function: Literal["sum", "norm", "largest", "smallest", "arrived", "told"] = "sum"
    text: str = ""

    @property
    def name(self) -> str:
        """Words for it."""
        if self.function == "told":
            return "'continue' from outside"
        names = [f"{term.channel}.{term.component}".rstrip(".") for term in self.terms]
        return self.text or (names[0] if len(names) == 1 else f"{self.function}({', '.join(names)})")


@dataclass(frozen=True)
class Condition:
    """Something that is true from a value on: above it, or below.

    Attributes
    ----------
    signal
        None for the time in the phase [s].
    value
        In SI; with `weight_of` relative to that weight.
    below
        Whether it is true below the value, not above.
    hold
        How long it has to be true without a break [s].
    weight_of
        Names of bodies of whose weight the value is a part.
    """

    signal: Signal | None
    value: float
    below: bool = False
    hold: float = 0.0
    weight_of: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """Words for it."""
        name = "time in the phase" if self.signal is None else self.signal.name
        held = f" for {self.hold:g} s" if self.hold else ""
        if self.signal is not None and self.signal.function == "told":
            return name
        if self.signal is not None and self.signal.function == "arrived":
            return f"{name} at rest where told to go{held}"
        return f"{name} {'below' if self.below else 'above'} {_value(self)}{held}"


@dataclass(frozen=True)
class Limit:
    """What has to be so during a phase: a signal above or below a value.

    Attributes
    ----------
    signal, value, below, weight_of
        As of a condition.
    stop
        Whether the run ends where it is not so; else it is told.
    """

    signal: Signal
    value: float
    below: bool = True
    stop: bool = True
    weight_of: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """Words for it."""
        return f"{self.signal.name} {'below' if self.below else 'above'} {_value(self)}"


def _value(spec: Condition | Limit) -> str:
    """Value of a condition or limit, as words."""
    return f"{spec.value:.6g}" + f" of the weight of {', '.join(spec.weight_of)}" * bool(spec.weight_of)


@dataclass(frozen=True)
class _Ramp:
    """How quickly a speed changes.

    Attributes
    ----------
    ramp
        Of what derives from it: time that the change takes, or that from rest to the largest speed and back [s]; at
        once with 0.
    acceleration, jerk
        In place of it limits of the speed's rate of change, and of that of the acceleration; 0 is none.
    """

    acceleration: float = field(default=0.0, kw_only=True)
    jerk: float = field(default=0.0, kw_only=True)

    @property
    def _in_ramp(self) -> str:
        ramp = float(getattr(self, "ramp", 0.0))
        return f" in {ramp:g} s" * bool(ramp)


@dataclass(frozen=True)
class WinchSpeed(_Ramp):
    """From its present speed a winch comes to another one.

    Attributes
    ----------
    rope
        Name.
    speed
        [m/s], hauls in if positive.
    """

    rope: str
    speed: float
    ramp: float = 0.0

    @property
    def text(self) -> str:
        """Words for it."""
        return f"winch of {self.rope!r} to {self.speed:g} m/s{self._in_ramp}"


@dataclass(frozen=True)
class WinchLength(_Ramp):
    """A winch hauls in or pays out until the rope has an unstretched length, and stops there.

    Attributes
    ----------
    rope
        Name.
    length
        Unstretched length in play [m].
    speed
        At most [m/s].
    """

    rope: str
    length: float
    speed: float
    ramp: float = 0.0

    @property
    def text(self) -> str:
        """Words for it."""
        return f"winch of {self.rope!r} to {self.length:g} m at {self.speed:g} m/s"


@dataclass(frozen=True)
class WinchHaul(_Ramp):
    """A winch hauls in a length, pays out if it is negative, and stops.

    Attributes
    ----------
    rope
        Name.
    length
        [m]; or, with a signal, the value that it is to have.
    speed
        At most [m/s].
    signal, parts
        The winch hauls in what the signal is below its value, times the number of parts of rope that the load hangs on.
    """

    rope: str
    length: float
    speed: float
    ramp: float = 0.0
    signal: Signal | None = None
    parts: float = 1.0

    @property
    def text(self) -> str:
        """Words for it."""
        if self.signal is None:
            return f"winch of {self.rope!r} by {self.length:g} m at {self.speed:g} m/s"
        return f"winch of {self.rope!r} until {self.signal.name} is {self.length:g} m, at {self.speed:g} m/s"


@dataclass(frozen=True)
class WinchFollow:
    """A winch does as another one, times a ratio, from now on and whatever that is told, until it is told something."""

    rope: str
    leader: str
    ratio: float = 1.0

    @property
    def text(self) -> str:
        """Words for it."""
        return f"winch of {self.rope!r} follows that of {self.leader!r}"


@dataclass(frozen=True)
class WinchTension:
    """A winch stops where it is, and keeps a tension from now on.

    Attributes
    ----------
    rope
        Name of one whose winch answers to the tension.
    tension
        [N].
    speed
        At most [m/s].
    dead_band
        Part of the tension by which it may be off before the winch moves.
    """

    rope: str
    tension: float
    speed: float
    dead_band: float = 0.05

    @property
    def text(self) -> str:
        """Words for it."""
        return f"winch of {self.rope!r} keeps {self.tension:g} N, at most with {self.speed:g} m/s"


@dataclass(frozen=True)
class WinchLevel:
    """A winch keeps its share of what a group of winches holds, beside whatever it is told.

    Attributes
    ----------
    rope
        Name of one whose winch answers to the tension.
    share
        Relative to the shares of the others; 0 ends it.
    speed
        At most, beside that which it is told [m/s].
    dead_band
        Part of its share by which it may be off before it moves.
    group
        Number of the group.
    """

    rope: str
    share: float
    speed: float = 0.0
    dead_band: float = 0.05
    group: int = 0

    @property
    def text(self) -> str:
        """Words for it."""
        return f"winch of {self.rope!r} {'levels its load' if self.share else 'levels no longer'}"


@dataclass(frozen=True)
class WinchBrake:
    """A brake is set, so that the drum rests until it slips, or let off."""

    rope: str
    on: bool

    @property
    def text(self) -> str:
        """Words for it."""
        return f"brake of {self.rope!r} {'set' if self.on else 'off'}"


@dataclass(frozen=True)
class TankRate:
    """The pump of a tank fills it, or empties it.

    Attributes
    ----------
    tank
        Name.
    rate
        [kg/s]; with a mass at most, else empties it if negative.
    mass
        At which the pump stops [kg].
    """

    tank: str
    rate: float
    mass: float | None = None

    @property
    def text(self) -> str:
        """Words for it."""
        until = "" if self.mass is None else f" to {self.mass:g} kg"
        return f"pump of {self.tank!r} with {self.rate:g} kg/s{until}"


@dataclass(frozen=True)
class DriveSpeed(_Ramp):
    """A drive comes to a speed.

    Attributes
    ----------
    drive
        Name of a joint with a drive, or of a body with an axis: ``"trolley.x"``, ``"mast.angle"``.
    speed
        [m/s] or [rad/s].
    """

    drive: str
    speed: float
    ramp: float = 0.0

    @property
    def text(self) -> str:
        """Words for it."""
        return f"drive of {self.drive!r} to {self.speed:g} /s{self._in_ramp}"


@dataclass(frozen=True)
class DriveTo(_Ramp):
    """A drive goes to a place, and stops there.

    Attributes
    ----------
    drive
        As of `DriveSpeed`.
    place
        Value of the coordinate of the joint, displacement or angle of the frame [m] or [rad].
    speed
        At most.
    by
        Whether the place is reckoned from where it is.
    """

    drive: str
    place: float
    speed: float
    ramp: float = 0.0
    by: bool = False

    @property
    def text(self) -> str:
        """Words for it."""
        return f"drive of {self.drive!r} {'by' if self.by else 'to'} {self.place:g} at {self.speed:g} /s"


@dataclass(frozen=True)
class PathSpeed(_Ramp):
    """A transporter goes along its path at a speed to the end of the leg on which it is, and stops there.

    Attributes
    ----------
    path
        Name of the transporter.
    speed
        [m/s]; 0 stops it where it is.
    """

    path: str
    speed: float
    ramp: float = 0.0

    @property
    def text(self) -> str:
        """Words for it."""
        if self.speed == 0.0:
            return f"{self.path!r} stops on its path{self._in_ramp}"
        return f"{self.path!r} along its leg at {self.speed:g} m/s{self._in_ramp}"


@dataclass(frozen=True)
class PathGoOn:
    """A transporter goes on along its path, this leg and all others as they are planned."""

    path: str

    @property
    def text(self) -> str:
        """Words for it."""
        return f"{self.path!r} goes on along its path"


@dataclass(frozen=True)
class Fail:
    """What drives something fails, at once: it stands where it is, held by its brake.

    Attributes
    ----------
    machine
        Name of the rope of a winch, of a drive, a tank, a pump or a transporter.
    sort
        What of it: its winch, its drive, the pump of the tank, the pump, the levelling of the transporter.
    """

    machine: str
    sort: Literal["winch", "drive", "tank", "pump", "levelling"]

    @property
    def text(self) -> str:
        """Words for it."""
        return f"failure of {_MACHINES[self.sort]} {self.machine!r}"


@dataclass(frozen=True)
class Restore:
    """What has failed works again: it stands until it is told something, or its controller looks.

    Attributes
    ----------
    machine, sort
        As of `Fail`.
    """

    machine: str
    sort: Literal["winch", "drive", "tank", "pump", "levelling"]

    @property
    def text(self) -> str:
        """Words for it."""
        return f"{_MACHINES[self.sort]} {self.machine!r} works again"


_MACHINES = {
    "winch": "the winch of",
    "drive": "drive",
    "tank": "the pump of tank",
    "pump": "pump",
    "levelling": "the levelling of",
}
MOVERS = frozenset({"winch", "drive", "tank"})
"""What of these can be told something by a scenario."""


@dataclass(frozen=True)
class Release:
    """A rope lets go: from now on it does nothing, and what it had stored is lost."""

    rope: str

    @property
    def text(self) -> str:
        """Words for it."""
        return f"release of {self.rope!r}"


@dataclass(frozen=True)
class ReleaseJoint:
    """A joint lets go: from now on its rows do nothing."""

    joint: str

    @property
    def text(self) -> str:
        """Words for it."""
        return f"release of joint {self.joint!r}"


@dataclass(frozen=True)
class Connect:
    """A rope that does nothing gets the length of its path, and some slack [m], and holds from now on."""

    rope: str
    slack: float = 0.0

    @property
    def text(self) -> str:
        """Words for it."""
        return f"connection of {self.rope!r}"


@dataclass(frozen=True)
class Note:
    """A line in the log."""

    words: str

    @property
    def text(self) -> str:
        """The words."""
        return self.words


RopeAction: TypeAlias = (
    WinchSpeed
    | WinchLength
    | WinchHaul
    | WinchFollow
    | WinchTension
    | WinchLevel
    | WinchBrake
    | Release
    | Connect
)
DriveAction: TypeAlias = DriveSpeed | DriveTo
PathAction: TypeAlias = PathSpeed | PathGoOn
Action: TypeAlias = RopeAction | ReleaseJoint | TankRate | DriveAction | PathAction | Fail | Restore | Note
MOVES = (WinchSpeed, WinchLength, WinchHaul)
"""What a winch is told that it does by itself."""


@dataclass(frozen=True)
class Phase:
    """A part of an operation.

    Attributes
    ----------
    name
        Of its own.
    actions
        Done at its start, in order.
    until
        Conditions with which it ends; of the last phase none is needed.
    ends_with
        Whether all of them have to be true, or any.
    limits
        What is watched.
    timeout
        Time in the phase after which the run ends [s]; 0 is never.
    """

    name: str
    actions: tuple[Action, ...] = ()
    until: tuple[Condition, ...] = ()
    ends_with: Literal["all", "any"] = "all"
    limits: tuple[Limit, ...] = ()
    timeout: float = 0.0


@dataclass(frozen=True)
class Track:
    """Phases in a row that go on beside others."""

    name: str
    phases: tuple[Phase, ...]


@dataclass(frozen=True)
class Scenario:
    """Phases in a row.

    Attributes
    ----------
    phases
        In order.
    prepared
        Names of ropes that are not connected at the start.
    stops_at_end
        Whether the run ends with the last phase, and not with its duration.
    tracks
        Other phases, which go on beside these.
    """

    phases: tuple[Phase, ...]
    prepared: tuple[str, ...] = ()
    stops_at_end: bool = False
    tracks: tuple[Track, ...] = ()

    @property
    def rows(self) -> tuple[tuple[Phase, ...], ...]:
        """Phases of all tracks."""
        return self.phases, *(track.phases for track in self.tracks)

    @property
    def all_phases(self) -> tuple[Phase, ...]:
        """Those of all tracks, one after the other."""
        return tuple(phase for row in self.rows for phase in row)

    @property
    def actions(self) -> tuple[Action, ...]:
        """Of all phases, one after the other."""
        return tuple(action for phase in self.all_phases for action in phase.actions)

    @property
    def signals(self) -> tuple[Signal, ...]:
        """All that is looked at, each once."""
        found: dict[Signal, None] = {}
        for phase in self.all_phases:
            waited = [condition.signal for condition in phase.until if condition.signal is not None]
            asked = [
                one.signal for one in phase.actions if isinstance(one, WinchHaul) and one.signal is not None
            ]
            found |= dict.fromkeys([*waited, *asked, *(limit.signal for limit in phase.limits)])
        return tuple(found)


def loose_ropes(scenario: Scenario, phases: Sequence[int]) -> set[str]:
    """Names of ropes that are not connected, by the numbers of the phases of all tracks.

    Parameters
    ----------
    scenario
        Phases.
    phases
        Of each track from 1 on; one more than there are is the end.
    """
    loose = set(scenario.prepared)
    for row, number in zip(scenario.rows, phases, strict=True):
        for done in row[:number]:
            for action in done.actions:
                if isinstance(action, Release):
                    loose.add(action.rope)
                elif isinstance(action, Connect):
                    loose.discard(action.rope)
    return loose


AXES = ("x", "y", "z", "angle")
"""Along which a frame is driven, or about which."""


@dataclass(frozen=True)
class Movable:
    """What a scene or a case has that can be told something.

    Attributes
    ----------
    ropes
        By name: of the scene, or sections of a case.
    tanks
        Names.
    drives
        By name: whether harmonics are added to it.
    duration
        Of the run [s]; infinite if it is not known.
    pumped
        Tanks with `[[pumps]]`, which nothing else is to fill, and one of these each.
    vehicles
        Transporters with a path by name: of the scene, or sections of a case.
    capacities
        Masses of full tanks [kg], as far as they are known.
    releases
        Joints by name, and why they cannot be released: in words, empty if they can.
    helpers
        Pumps and levelled transporters by name, and why they cannot fail: in words, empty if they can.
    """

    ropes: Mapping[str, Any]
    tanks: frozenset[str] = frozenset()
    drives: Mapping[str, bool] = field(default_factory=dict)
    duration: float = math.inf
    pumped: Mapping[str, str] = field(default_factory=dict)
    vehicles: Mapping[str, Any] = field(default_factory=dict)
    capacities: Mapping[str, float] = field(default_factory=dict)
    releases: Mapping[str, str] = field(default_factory=dict)
    helpers: Mapping[str, str] = field(default_factory=dict)


def helpers_of(
    pumps: Iterable[Any], controllers: Iterable[Any], transporters: Iterable[Any]
) -> dict[str, str]:
    """Pumps and levelled transporters by name, and why one cannot fail; empty if it can.

    Parameters
    ----------
    pumps, controllers, transporters
        Of a scene or a case.
    """
    told = {name for one in controllers for name in one.pumps}
    found = {
        pump.name: "" if pump.name in told else "follows its own plan, and no controller tells it"
        for pump in pumps
    }
    return found | {one.name: "" for one in transporters if one.levelling is not None}


def drives_of(joints: Iterable[Any], motions: Mapping[str, Any]) -> dict[str, bool]:
    """Names of all drives, and whether harmonics are added to one.

    Parameters
    ----------
    joints
        Of a scene or a case.
    motions
        Motions of the frames of bodies by name, of a scene or a case. One that is fixed can be told to move.
    """
    found = {}
    for joint in joints:
        drive = getattr(joint, "drive", None)
        if drive is not None:
            found[joint.name] = bool(drive.harmonics)
    for name, motion in motions.items():
        if getattr(motion, "motion", type(motion).__name__.lower()) not in {"fixed", "driven"}:
            continue
        for axis in AXES:
            profile = getattr(motion, axis, None)
            found[f"{name}.{axis}"] = profile is not None and bool(profile.harmonics)
    return found


RELEASABLE = frozenset(
    {"ball", "cylindrical", "fixed", "hinge", "planar", "slider", "slider_hinge", "universal"}
)
"""Words of joints that can be released: each is one block of rows, and nothing but these."""


def releases_of(joints: Iterable[Any], users: Iterable[Any]) -> dict[str, str]:
    """Names of all joints, and why one cannot be released; empty if it can.

    Parameters
    ----------
    joints
        Of a scene or a case.
    users
        What may act along a joint, as springs and motors do.
    """
    used = {one.joint: one.name for one in users if isinstance(getattr(one, "joint", None), str)}
    own = ("limits", "angle_limits", "travel_limits", "friction", "angle_friction", "travel_friction")
    found = {}
    for joint in joints:
        word = getattr(joint, "DESCRIBED", type(joint)).WORD
        reason = ""
        if word not in RELEASABLE:
            reason = f"is a joint of type {word!r}"
        elif getattr(joint, "drive", None) is not None:
            reason = "has a drive"
        elif any(getattr(joint, key, None) for key in own):
            reason = "has stops or friction"
        elif joint.name in used:
            reason = f"has {used[joint.name]!r} along it"
        found[joint.name] = reason
    return found


class _Checker:
    """Goes through the phases of a track, and knows what is connected and how winches stand."""

    def __init__(self, movable: Movable, prepared: Iterable[str], others: Iterable[Action]) -> None:
        others = tuple(others)
        self.movable, self.elsewhere = movable, {acted_on(action) for action in others} - {""}
        self.followed = {action.rope: action.leader for action in others if isinstance(action, WinchFollow)}
        """Leaders of winches that follow one: those of other tracks at any time, since nobody knows when."""
        for name, rope in movable.ropes.items():
            leader = getattr(getattr(rope, "winch", None), "follow", None)
            if leader is not None:
                self.followed[name] = leader
        self.loose = set(prepared)
        self.braked: set[str] = set()
        self.planned: dict[str, float] = {}
        self.largest: dict[str, tuple[float, float]] = {}
        """Speeds of what moves by itself, at most: in the phase, and behind it."""
        self.levels: dict[str, float] = {}
        """Speeds at most of winches that keep a level, beside that."""
        self.lengths: dict[str, float] = {}
        self.arriving: set[str] = set()
        self.failed: set[str] = set()

    def rope(self, name: str, key: str) -> Any:
        """A rope of type wire."""
        rope = _known("rope", name, self.movable.ropes, key)
        described = getattr(rope, "DESCRIBED", type(rope))  # of a case file, or an object
        if described.WORD != "wire":
            raise InputError(
                f"{name!r} is a rope of type {described.WORD!r}", key=key, expected="a rope of type 'wire'"
            )
        return rope

    def act(self, action: Action, key: str) -> None:
        """See that an action finds what it needs, and change what is so after it."""
        if isinstance(action, Note):
            return
        if acted_on(action) in self.elsewhere:
            raise InputError(
                f"{acted_on(action)!r} is told something in another track",
                key=key,
                expected="actions of one track for one thing",
            )
        if isinstance(action, (Fail, Restore)):
            self._machine(action, f"{key}.{'fail' if isinstance(action, Fail) else 'restore'}")
            return
        for name in (acted_on(action), getattr(action, "leader", "")):
            if name in self.failed and not isinstance(action, (Release, Connect)):
                raise InputError(
                    f"what drives {name!r} has failed then",
                    key=key,
                    expected="'restore' before, or another one",
                )
        if isinstance(action, TankRate):
            _known("tank", action.tank, self.movable.tanks, f"{key}.tank")
            if action.tank in self.movable.pumped:
                raise InputError(
                    f"the pump {self.movable.pumped[action.tank]!r} fills or empties {action.tank!r}",
                    key=f"{key}.tank",
                    expected="a tank without [[pumps]]",
                )
            room = self.movable.capacities.get(action.tank, math.inf)
            if action.mass is not None and action.mass > room * (1.0 + 1e-9):
                raise InputError(
                    f"{action.mass:g} kg, and {action.tank!r} is full with {room:.6g} kg",
                    key=f"{key}.mass",
                    expected=f"at most {room:.6g} kg",
                )
            if action.mass is not None or action.rate < 0.0:
                self.arriving.add(action.tank)
            return
        if isinstance(action, (DriveSpeed, DriveTo)):
            self._drive(action, f"{key}.drive")
            return
        if isinstance(action, (PathSpeed, PathGoOn)):
            self._path(action, key)
            return
        if isinstance(action, ReleaseJoint):
            self._release(action.joint, f"{key}.release")
            return
        word = {Release: "release", Connect: "connect"}.get(type(action), "winch")
        place = f"{key}.{word}"
        rope = self.rope(action.rope, place)
        if word == "winch":
            self._has_one_winch(rope, place)
        if isinstance(action, Release):
            if action.rope in self.loose:
                raise InputError(
                    f"{action.rope!r} is not connected then", key=place, expected="a rope that is"
                )
            self.loose.add(action.rope)
        elif isinstance(action, Connect):
            if action.rope not in self.loose:
                raise InputError(
                    f"{action.rope!r} is connected then",
                    key=place,
                    expected="a rope that was released, or is in 'prepared'",
                )
            self.loose.discard(action.rope)
        elif isinstance(action, (WinchTension, WinchLevel, WinchBrake)):
            self._control(action, rope, key)
        else:
            self._move(action, rope, key)

    def _machine(self, action: Fail | Restore, key: str) -> None:
        """Something that works and fails, or has failed and works again."""
        name = action.machine
        if action.sort == "winch":
            self._has_one_winch(self.rope(name, key), key)
        elif action.sort == "drive":
            if _known("drive", name, self.movable.drives, key) is True:
                raise InputError(
                    f"harmonics are added to {name!r}", key=key, expected="a drive without 'harmonics'"
                )
        elif action.sort == "tank":
            _known("tank", name, self.movable.tanks, key)
            if name in self.movable.pumped:
                raise InputError(
                    f"the pump {self.movable.pumped[name]!r} fills or empties {name!r}",
                    key=key,
                    expected=f"that pump, {self.movable.pumped[name]!r}",
                )
        else:
            reason = _known("pump or levelled transporter", name, self.movable.helpers, key)
            if reason:
                raise InputError(f"{name!r} {reason}", key=key, expected="a pump of a controller")
        fails = isinstance(action, Fail)
        if fails == (name in self.failed):
            problem = "has failed already" if fails else "has not failed"
            raise InputError(f"{name!r} {problem} then", key=key, expected="'fail' first, then 'restore'")
        (self.failed.add if fails else self.failed.discard)(name)
        if fails:
            for known in (self.followed, self.levels, self.lengths):
                known.pop(name, None)
            self.planned[name], self.largest[name] = 0.0, (0.0, 0.0)
            followers = [one for one, leader in self.followed.items() if leader == name]
            self.arriving -= {name, *followers}

    @staticmethod
    def _has_one_winch(rope: Any, key: str) -> None:
        """What is told to a winch, or followed, is not the sum of two."""
        if rope.other_winch is not None:
            raise InputError(
                f"{rope.name!r} has two winches", key=key, expected="a rope without 'other_winch'"
            )

    def _drive(self, action: DriveSpeed | DriveTo, key: str) -> None:
        """A drive that is there, and is a table alone."""
        if _known("drive", action.drive, self.movable.drives, key) is True:
            raise InputError(
                f"harmonics are added to {action.drive!r}", key=key, expected="a drive without 'harmonics'"
            )
        if isinstance(action, DriveTo) or action.speed == 0.0:
            self.arriving.add(action.drive)

    def _release(self, name: str, key: str) -> None:
        """A joint that is there still, and is rows alone."""
        reason = _known("joint", name, self.movable.releases, key)
        if reason:
            raise InputError(
                f"{name!r} {reason}",
                key=key,
                expected=f"a joint of type {', '.join(sorted(RELEASABLE))} that nothing drives, stops or loads",
            )
        if name in self.loose:
            raise InputError(f"{name!r} is released then", key=key, expected="a joint that is not")
        self.loose.add(name)

    def _path(self, action: PathAction, key: str) -> None:
        """A vehicle whose plan waits for nothing else, and whose drive can do the speed."""
        vehicle = _known("transporter with 'legs'", action.path, self.movable.vehicles, f"{key}.path")
        if vehicle.tyres is not None:
            raise InputError(
                f"{action.path!r} has 'tyres', and its plan waits for what its drives can",
                key=f"{key}.path",
                expected="a transporter without 'tyres'",
            )
        self.arriving.add(action.path)
        if not isinstance(action, PathSpeed) or vehicle.drive is None or not len(vehicle.drive.speeds):
            return
        fastest = max(leg.speed for leg in vehicle.legs)
        if action.speed > fastest * (1.0 + 1e-12):
            raise InputError(
                f"{action.speed:g} m/s, and the drives of {action.path!r} are planned for {fastest:g} m/s",
                key=f"{key}.speed",
                expected="at most the speed of its fastest leg, or a drive without 'speeds'",
            )

    def _control(self, action: WinchTension | WinchLevel | WinchBrake, rope: Any, key: str) -> None:
        """The winch answers to its tension; its brake is off, and is set while it rests."""
        name = action.rope
        if isinstance(action, WinchBrake):
            if getattr(rope.winch, "brake", None) is None:
                raise InputError(
                    f"the winch of {name!r} has no brake",
                    key=f"{key}.brake",
                    expected="'brake' in its 'winch'",
                )
            if action.on and self.planned.get(name, 0.0):
                raise InputError(
                    f"the brake of {name!r} is set while its winch goes with {self.planned[name]:g} m/s",
                    key=f"{key}.brake",
                    expected="a speed of 0 before, or a length to go to",
                )
            self.followed.pop(name, None)
            self.levels.pop(name, None)
            (self.braked.add if action.on else self.braked.discard)(name)
            return
        if not controlled(rope):
            raise InputError(
                f"the winch of {name!r} does not answer to its tension",
                key=f"{key}.{'tension' if isinstance(action, WinchTension) else 'level'}",
                expected="a rope whose 'winch' has 'brake' or 'tensions'",
            )
        self._is_off(name, key)
        if isinstance(action, WinchTension):
            self.followed.pop(name, None)
            self.planned[name] = 0.0
            self.largest.pop(name, None)
            if action.tension > LARGEST_STRAIN * rope.axial_stiffness:
                raise InputError(
                    f"{action.tension:g} N is a strain of {action.tension / rope.axial_stiffness:.3g}",
                    key=f"{key}.tension",
                    expected=f"at most {LARGEST_STRAIN * rope.axial_stiffness:g} N",
                )
            brake = rope.winch.brake
            if brake is not None and action.tension >= brake:
                raise InputError(
                    f"{action.tension:g} N, and the brake of {name!r} slips at {brake:g} N",
                    key=f"{key}.tension",
                    expected=f"less than {brake:g} N",
                )
        self._check_speed(action.speed, rope, key)
        if isinstance(action, WinchLevel) and action.share:
            self.levels[name] = action.speed
            self._check_both(rope, key)
        else:
            self.levels.pop(name, None)

    def _check_both(self, rope: Any, key: str) -> None:
        """What a winch is told and what it does for a level are together no faster than it can be."""
        name = rope.name
        most = getattr(getattr(rope, "winch", None), "fastest", None)
        told, level = self.largest.get(name, (0.0, 0.0))[0], self.levels.get(name, 0.0)
        if most is not None and level > 0.0 and told + level > most * (1.0 + 1e-12):
            raise InputError(
                f"{told:g} m/s that the winch of {name!r} is told and {level:g} m/s to keep its level",
                key=f"{key}.speed",
                expected=f"at most {most:g} m/s together",
            )

    def end(self, phase: Phase) -> None:
        """What has arrived in a phase that waits for it rests."""
        for name, (_, behind) in self.largest.items():
            self.largest[name] = behind, behind
        if phase.ends_with == "any" and len(phase.until) > 1:
            return
        for one in phase.until:
            if one.signal is not None and one.signal.function == "arrived":
                self.largest |= {term.channel: (0.0, 0.0) for term in one.signal.terms}

    def _is_off(self, name: str, key: str) -> None:
        """Nothing moves a drum whose brake is set."""
        if name in self.braked:
            raise InputError(
                f"the brake of {name!r} is set", key=f"{key}.winch", expected="'brake = false' before"
            )

    def _check_speed(self, speed: float, rope: Any, key: str) -> None:
        """A winch is no faster than it is said to be."""
        winch = getattr(rope, "winch", None)
        most = (
            min((one for one in (winch.speed, winch.fastest) if one is not None), default=None)
            if winch
            else None
        )
        if most is not None and abs(speed) > most * (1.0 + 1e-12):
            raise InputError(
                f"{abs(speed):g} m/s, and the winch of {rope.name!r} has at most {most:g} m/s",
                key=f"{key}.speed",
                expected=f"at most {most:g} m/s",
            )

    def _check_follower(self, action: WinchFollow, rope: Any, key: str) -> None:
        """A winch that follows is no faster than it can be, however fast the other one goes."""
        most = getattr(getattr(rope, "winch", None), "fastest", None)
        if most is None:
            return
        leader = getattr(getattr(self.rope(action.leader, f"{key}.follow"), "winch", None), "fastest", None)
        told = abs(action.ratio) * (math.inf if leader is None else leader)
        if told > most * (1.0 + 1e-12):
            raise InputError(
                f"the winch of {rope.name!r} can do {most:g} m/s, and that of {action.leader!r} leads it with "
                + ("any speed" if leader is None else f"{told:g} m/s"),
                key=f"{key}.follow",
                expected=f"'fastest' of the winch of {action.leader!r}, at most {most / abs(action.ratio):g} m/s",
            )

    def _move(self, action: WinchSpeed | WinchLength | WinchHaul | WinchFollow, rope: Any, key: str) -> None:
        """The brake is off, the speed within the limit of the winch."""
        name = action.rope
        self._is_off(name, key)
        if isinstance(action, WinchFollow):
            self._has_one_winch(self.rope(action.leader, f"{key}.follow"), f"{key}.follow")
            if name == action.leader:
                raise InputError(f"{name!r} follows itself", key=f"{key}.follow", expected="another rope")
            if action.leader in self.followed:
                raise InputError(
                    f"the winch of {action.leader!r} follows another one itself",
                    key=f"{key}.follow",
                    expected="a winch that follows none",
                )
            follower = next((one for one, leader in self.followed.items() if leader == name), None)
            if follower is not None:
                raise InputError(
                    f"the winch of {follower!r} follows that of {name!r}",
                    key=f"{key}.follow",
                    expected="a winch that none follows",
                )
            self._check_follower(action, rope, key)
            self.followed[name] = action.leader
            self.planned[name] = action.ratio * self.planned.get(action.leader, 0.0)
            self.largest[name] = (abs(action.ratio) * self.largest.get(action.leader, (0.0, 0.0))[0],) * 2
            self._check_both(rope, key)
            self.arriving.add(name)
            return
        self._check_speed(action.speed, rope, key)
        at_once = not action.ramp and not action.acceleration
        before = 0.0 if at_once else self.largest.get(name, (0.0, 0.0))[0]
        self.largest[name] = max(before, abs(action.speed)), abs(action.speed)
        self._check_both(rope, key)
        self.followed.pop(name, None)
        self.planned[name] = action.speed if isinstance(action, WinchSpeed) else 0.0
        self.lengths.pop(name, None)
        if isinstance(action, WinchLength):
            self.lengths[name] = action.length
        if not isinstance(action, WinchSpeed) or action.speed == 0.0:
            self.arriving.add(name)
        else:
            self.arriving.discard(name)


def acted_on(action: Action) -> str:
    """Name of what an action is for; empty of a note."""
    words = (getattr(action, key, "") for key in ("rope", "joint", "tank", "drive", "path", "machine"))
    return str(next(filter(None, words), ""))


LARGEST_STRAIN = 0.02
"""Of a rope whose winch keeps a tension."""


def check_scenario(scenario: Scenario, movable: Movable) -> None:
    """Refuse phases that cannot end, and actions on what is not there or is not as they need it.

    Parameters
    ----------
    scenario
        Phases.
    movable
        What the scene has.

    Raises
    ------
    InputError
        The first thing that is wrong; the key says where in the scenario.
    """
    if not scenario.phases:
        raise InputError("no phases", key="phases", expected="one or more")
    for index, name in enumerate(scenario.prepared):
        _known("rope", name, movable.ropes, f"prepared.{index}")
    names: set[str] = set()
    for row, phases in enumerate(scenario.rows):
        others = (phase for other in scenario.rows if other is not phases for phase in other)
        checker = _Checker(
            movable, scenario.prepared, (action for phase in others for action in phase.actions)
        )
        for index, phase in enumerate(phases):
            key = f"tracks.{row - 1}.phases.{index}" if row else f"phases.{index}"
            if phase.name in names:
                raise InputError(
                    f"{phase.name!r} is the name of two phases",
                    key=f"{key}.name",
                    expected="a name of its own",
                )
            names.add(phase.name)
            last = index + 1 == len(phases)
            if not phase.until and not phase.timeout and not last:
                raise InputError(
                    f"phase {phase.name!r} can never end: it has neither 'until' nor 'timeout'",
                    key=key,
                    expected="'until', or no phases behind it",
                )
            if not phase.until and scenario.stops_at_end and last:
                raise InputError(
                    f"the last phase {phase.name!r} has no 'until', with which the run could end",
                    key=key,
                    expected="'until', or 'at_end' of the scenario 'go_on'",
                )
            for number, action in enumerate(phase.actions):
                checker.act(action, f"{key}.actions.{number}")
            _can_end(phase, checker, f"{key}.until")
            checker.end(phase)


def _can_end(phase: Phase, checker: _Checker, key: str) -> None:
    """Refuse conditions of a phase that cannot become true."""
    reasons = [_why_never(one, checker) for one in phase.until]
    never = all(reasons) if phase.ends_with == "any" else any(reasons)
    if reasons and never:
        reason, expected = next(one for one in reasons if one)
        raise InputError(f"phase {phase.name!r} can never end: {reason}", key=key, expected=expected)


def _why_never(condition: Condition, checker: _Checker) -> tuple[str, str] | None:
    """Why a condition cannot become true, and what could; None if nothing is known against it."""
    signal, value = condition.signal, condition.value
    if signal is None:
        if value + condition.hold > checker.movable.duration * (1.0 + 1e-12):
            problem = (
                f"it waits for {value + condition.hold:g} s, and the run takes {checker.movable.duration:g} s"
            )
            return problem, "a shorter time, or a longer duration"
        return None
    if signal.function == "arrived":
        idle = [
            term.channel for term in signal.terms if term.channel not in checker.arriving | checker.elsewhere
        ]
        if idle:
            return f"{idle[0]!r} has not been told to go anywhere", "an action with a place to go to before"
        return None
    owner, _, kind = signal.terms[0].channel.rpartition(".") if signal.terms else ("", "", "")
    if len(signal.terms) != 1 or owner not in checker.movable.ropes or signal.terms[0].weight != 1.0:
        return None
    if owner in checker.elsewhere:
        return None
    if kind == "tension" and not condition.below and value > 0.0 and owner in checker.loose:
        return f"{owner!r} is not connected, and has no tension", "a rope that is connected"
    if kind == "rest_length" and owner in checker.lengths:
        length = checker.lengths[owner]
        if value < length if condition.below else value > length:
            return (
                f"the winch of {owner!r} stops at {length:g} m, and it waits for {condition.text}",
                "a length that it reaches",
            )
        return None
    if kind == "rest_length":
        speed = checker.planned.get(owner, 0.0)
        if (speed > 0.0 and not condition.below) or (speed < 0.0 and condition.below):
            way = "hauls in" if speed > 0.0 else "pays out"
            return (
                None
                if condition.hold
                else (
                    f"the winch of {owner!r} {way} with {abs(speed):g} m/s, and it waits for {condition.text}",
                    "the other sense, or the other comparison",
                )
            )
    return None


def _known(what: str, name: str, known: Any, key: str) -> Any:
    """What has a name; True of a set."""
    if name not in known:
        near = get_close_matches(name, list(known), 1)
        raise InputError(
            f"{name!r} is no {what}" + (f"; did you mean {near[0]!r}?" if near else ""),
            key=key,
            expected=f"one of: {', '.join(sorted(known)) or 'there are none'}",
        )
    return known[name] if hasattr(known, "__getitem__") else None
