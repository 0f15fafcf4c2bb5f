"""Winches of ropes: speeds, lengths, tensions, levels and brakes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import NameOf, Positive, Quantity
from heavylift.solver.scene.actions import ACTIONS, Action, Hook, MotionKeys, NamesOf, Ramp
from heavylift.solver.scene.commands import Command
from heavylift.solver.scene.connections import controlled
from heavylift.solver.scene.operations import BRAKE, FOLLOW, GO_BY, GO_TO, KEEP, KEEP_LEVEL, SPEED

if TYPE_CHECKING:
    from heavylift.solver.scene.actions import Targets
    from heavylift.solver.scene.operation_state import OperationState
    from heavylift.solver.scene.signals import Signal

__all__ = [
    "LevelKeys",
    "WinchBrake",
    "WinchFollow",
    "WinchHaul",
    "WinchLength",
    "WinchLevel",
    "WinchSpeed",
    "WinchTension",
    "winch_action",
]

LARGEST_STRAIN = 0.02
"""Of a rope whose winch keeps a tension."""


@dataclass(frozen=True)
class WinchSpeed(Ramp):
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
        return f"winch of {self.rope!r} to {self.speed:g} m/s{self.in_ramp}"

    def command(self) -> Command:
        """A speed."""
        return Command(operation=SPEED, actuates="winch", name=self.rope, value=self.speed, **self.limits)

    def check(self, state: OperationState, key: str) -> None:
        """The brake is off, the speed within the limit of the winch."""
        _check_move(self, self.speed, state, key)
        state.planned[self.rope] = self.speed
        if self.speed == 0.0:
            state.arriving.add(self.rope)
        else:
            state.arriving.discard(self.rope)


@dataclass(frozen=True)
class WinchLength(Ramp):
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

    def command(self) -> Command:
        """A move to rest."""
        return Command(
            operation=GO_TO,
            actuates="winch",
            name=self.rope,
            value=self.length,
            speed=self.speed,
            **self.limits,
        )

    def check(self, state: OperationState, key: str) -> None:
        """The brake is off, the speed within the limit of the winch."""
        _check_move(self, self.speed, state, key)
        state.planned[self.rope] = 0.0
        state.lengths[self.rope] = self.length
        state.arriving.add(self.rope)


@dataclass(frozen=True)
class WinchHaul(Ramp):
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

    def command(self) -> Command:
        """A move to rest."""
        return Command(
            operation=GO_BY,
            actuates="winch",
            name=self.rope,
            value=self.length,
            speed=self.speed,
            signal=self.signal,
            parts=self.parts,
            **self.limits,
        )

    def check(self, state: OperationState, key: str) -> None:
        """The brake is off, the speed within the limit of the winch."""
        _check_move(self, self.speed, state, key)
        state.planned[self.rope] = 0.0
        state.arriving.add(self.rope)


@dataclass(frozen=True)
class WinchFollow(Action):
    """A winch follows another one, times a ratio, whatever that is commanded, until its own next command."""

    rope: str
    leader: str
    ratio: float = 1.0

    @property
    def text(self) -> str:
        """Words for it."""
        return f"winch of {self.rope!r} follows that of {self.leader!r}"

    def command(self) -> Command:
        """The moves of the other one."""
        return Command(
            operation=FOLLOW, actuates="winch", name=self.rope, leader=self.leader, ratio=self.ratio
        )

    def check(self, state: OperationState, key: str) -> None:
        """The other one follows none, and is no faster than this one can be."""
        name, place = self.rope, f"{key}.follow"
        rope = state.winch(name, f"{key}.winch")
        _check_off(name, state, key)
        state.winch(self.leader, place)
        if name == self.leader:
            raise InputError(f"{name!r} follows itself", key=place, expected="another rope")
        if self.leader in state.followed:
            raise InputError(
                f"the winch of {self.leader!r} follows another one itself",
                key=place,
                expected="a winch that follows none",
            )
        follower = next((one for one, leader in state.followed.items() if leader == name), None)
        if follower is not None:
            raise InputError(
                f"the winch of {follower!r} follows that of {name!r}",
                key=place,
                expected="a winch that none follows",
            )
        self._check_ratio(rope, state, place)
        state.followed[name] = self.leader
        state.planned[name] = self.ratio * state.planned.get(self.leader, 0.0)
        state.largest[name] = (abs(self.ratio) * state.largest.get(self.leader, (0.0, 0.0))[0],) * 2
        _check_with_level(rope, state, key)
        state.arriving.add(name)

    def _check_ratio(self, rope: Any, state: OperationState, key: str) -> None:
        """It is no faster than it can be, however fast the other one goes."""
        most = getattr(getattr(rope, "winch", None), "fastest", None)
        if most is None:
            return
        leader = getattr(getattr(state.rope(self.leader, key), "winch", None), "fastest", None)
        commanded = abs(self.ratio) * (math.inf if leader is None else leader)
        if commanded > most * (1.0 + 1e-12):
            raise InputError(
                f"the winch of {rope.name!r} has at most {most:g} m/s, and that of {self.leader!r} leads it with "
                + ("any speed" if leader is None else f"{commanded:g} m/s"),
                key=key,
                expected=f"'fastest' of the winch of {self.leader!r}, at most {most / abs(self.ratio):g} m/s",
            )


@dataclass(frozen=True)
class WinchTension(Action):
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
        Part of the tension by which it may deviate before the winch moves.
    """

    rope: str
    tension: float
    speed: float
    dead_band: float = 0.05

    @property
    def text(self) -> str:
        """Words for it."""
        return f"winch of {self.rope!r} keeps {self.tension:g} N, at most with {self.speed:g} m/s"

    def command(self) -> Command:
        """A tension."""
        return Command(
            operation=KEEP,
            actuates="winch",
            name=self.rope,
            value=self.tension,
            speed=self.speed,
            dead_band=self.dead_band,
        )

    def check(self, state: OperationState, key: str) -> None:
        """The rope and the brake bear the tension."""
        name = self.rope
        rope = _controlled(name, "tension", state, key)
        state.followed.pop(name, None)
        state.planned[name] = 0.0
        state.largest.pop(name, None)
        if self.tension > LARGEST_STRAIN * rope.axial_stiffness:
            raise InputError(
                f"{self.tension:g} N is a strain of {self.tension / rope.axial_stiffness:.3g}",
                key=f"{key}.tension",
                expected=f"at most {LARGEST_STRAIN * rope.axial_stiffness:g} N",
            )
        brake = rope.winch.brake
        if brake is not None and self.tension >= brake:
            raise InputError(
                f"{self.tension:g} N, and the brake of {name!r} slips at {brake:g} N",
                key=f"{key}.tension",
                expected=f"less than {brake:g} N",
            )
        _check_speed(self.speed, rope, key)
        state.levels.pop(name, None)


@dataclass(frozen=True)
class WinchLevel(Action):
    """A winch keeps its share of the load of a group of winches, in addition to its commands.

    Attributes
    ----------
    rope
        Name of one whose winch answers to the tension.
    share
        Relative to the shares of the others; 0 ends it.
    speed
        At most, in addition to the commanded speed [m/s].
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

    def command(self) -> Command:
        """A share beside what it does."""
        return Command(
            operation=KEEP_LEVEL,
            actuates="winch",
            name=self.rope,
            value=self.share,
            speed=self.speed,
            dead_band=self.dead_band,
            group=self.group,
        )

    def check(self, state: OperationState, key: str) -> None:
        """It is no faster than it can be with all that it does."""
        rope = _controlled(self.rope, "level", state, key)
        _check_speed(self.speed, rope, key)
        if self.share:
            state.levels[self.rope] = self.speed
            _check_with_level(rope, state, key)
        else:
            state.levels.pop(self.rope, None)


@dataclass(frozen=True)
class WinchBrake(Action):
    """A brake is set, so that the drum rests until it slips, or let off."""

    rope: str
    on: bool

    @property
    def text(self) -> str:
        """Words for it."""
        return f"brake of {self.rope!r} {'set' if self.on else 'off'}"

    def command(self) -> Command:
        """The brake."""
        return Command(operation=BRAKE, actuates="winch", name=self.rope, value=float(self.on))

    def check(self, state: OperationState, key: str) -> None:
        """It has one, which is set while the winch rests."""
        name, place = self.rope, f"{key}.brake"
        rope = state.winch(name, f"{key}.winch")
        if getattr(rope.winch, "brake", None) is None:
            raise InputError(
                f"the winch of {name!r} has no brake", key=place, expected="'brake' in its 'winch'"
            )
        if self.on and state.planned.get(name, 0.0):
            raise InputError(
                f"the brake of {name!r} is set while its winch moves at {state.planned[name]:g} m/s",
                key=place,
                expected="a speed of 0 before, or a target length",
            )
        state.followed.pop(name, None)
        state.levels.pop(name, None)
        (state.braked.add if self.on else state.braked.discard)(name)


def _check_off(name: str, state: OperationState, key: str) -> None:
    """Nothing moves a drum whose brake is set."""
    if name in state.braked:
        raise InputError(
            f"the brake of {name!r} is set", key=f"{key}.winch", expected="'brake = false' before"
        )


def _controlled(name: str, word: str, state: OperationState, key: str) -> Any:
    """A rope whose winch answers to the tension."""
    rope = state.winch(name, f"{key}.winch")
    if not controlled(rope):
        raise InputError(
            f"the winch of {name!r} is not controlled by its tension",
            key=f"{key}.{word}",
            expected="a rope whose 'winch' has 'brake' or 'tensions'",
        )
    _check_off(name, state, key)
    return rope


def _check_speed(speed: float, rope: Any, key: str) -> None:
    """A winch is no faster than its limits."""
    winch = getattr(rope, "winch", None)
    limits = (winch.speed, winch.fastest) if winch else ()
    most = min((one for one in limits if one is not None), default=None)
    if most is not None and abs(speed) > most * (1.0 + 1e-12):
        raise InputError(
            f"{abs(speed):g} m/s, and the winch of {rope.name!r} has at most {most:g} m/s",
            key=f"{key}.speed",
            expected=f"at most {most:g} m/s",
        )


def _check_with_level(rope: Any, state: OperationState, key: str) -> None:
    """The commanded speed of a winch and its speed for a level do not exceed its largest speed together."""
    name = rope.name
    most = getattr(getattr(rope, "winch", None), "fastest", None)
    told, level = state.largest.get(name, (0.0, 0.0))[0], state.levels.get(name, 0.0)
    if most is not None and level > 0.0 and told + level > most * (1.0 + 1e-12):
        raise InputError(
            f"{told:g} m/s commanded to the winch of {name!r} and {level:g} m/s to keep its level",
            key=f"{key}.speed",
            expected=f"at most {most:g} m/s together",
        )


def _check_move(
    action: WinchSpeed | WinchLength | WinchHaul, speed: float, state: OperationState, key: str
) -> None:
    """The brake is off, the speed within the limit of the winch."""
    name = action.rope
    rope = state.winch(name, f"{key}.winch")
    _check_off(name, state, key)
    _check_speed(speed, rope, key)
    at_once = not action.ramp and not action.acceleration
    before = 0.0 if at_once else state.largest.get(name, (0.0, 0.0))[0]
    state.largest[name] = max(before, abs(speed)), abs(speed)
    _check_with_level(rope, state, key)
    state.followed.pop(name, None)
    state.lengths.pop(name, None)


@dataclass(frozen=True, kw_only=True)
class LevelKeys(MotionKeys):
    """Keys of winches that answer to the tension, by their ropes or by hooks."""

    level: bool | None = None
    """Whether these winches, two or more, each with a ``brake`` or ``tensions``, keep equal parts of what they hold, of
    hooks of the load: at most with `speed`, in addition to their commands."""
    dead_band: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0)] = 0.05
    """Part of `tension`, or of the share of `level`, by which it may deviate before the winch moves."""
    brake: bool | None = None
    """Whether the brake is set: the drum rests where it is, until it slips."""

    @classmethod
    def check_group(cls, given: Any, names: list[str]) -> None:
        """One alone has nothing to share."""
        if given.level and len(names) < 2:
            raise InputError(f"{names[0]!r} alone is level", key=cls.WORD, expected="two or more")


def winch_action(rope: str, given: Any, group: int, hook: Hook = Hook(1, 0.0)) -> Action:  # noqa: B008
    """What winches and hooks have in common; of a hook the rope goes n times as fast."""
    n, speed = hook.parts, given.speed or 0.0
    if given.brake is not None:
        return WinchBrake(rope, given.brake)
    if given.level is not None:
        return WinchLevel(rope, 1.0 / n if given.level else 0.0, n * speed, given.dead_band, group)
    limits = scaled_limits(given, n)
    if given.distance is not None:
        return WinchHaul(rope, n * given.distance, n * speed, given.ramp, **limits)
    return WinchSpeed(rope, n * speed, given.ramp, **limits)


def scaled_limits(given: Any, parts: int) -> dict[str, Any]:
    """Limits of a winch, whose rope has some parts."""
    return {"acceleration": parts * (given.acceleration or 0.0), "jerk": parts * (given.jerk or 0.0)}


@ACTIONS.describe("winch")
@dataclass(frozen=True)
class WinchKeys(LevelKeys):
    """What winches do."""

    ORDER: ClassVar[float] = 1
    TELLS: ClassVar[tuple[str, ...]] = ("length", "distance", "follow", "tension", "brake", "level")

    winch: Annotated[str, NamesOf("ropes", "rope")]
    """Ropes whose winches get another speed, or a length to go to, ...: a name, a pattern such as ``"fall_*"``, or a
    list."""
    length: Annotated[float | None, Positive("length")] = None
    """Unstretched length of the rope at which its winch stops [m]."""
    follow: Annotated[str | None, NameOf("rope")] = None
    """Rope whose winch this one copies from now on, by length."""
    ratio: Annotated[float, Quantity("number")] = 1.0
    """Length of this rope per length of the one that it follows."""
    tension: Annotated[float | None, Positive("force")] = None
    """Tension that the winch keeps, at most with `speed` [N]: of one with a ``brake`` or ``tensions``."""

    @classmethod
    def made(cls, given: Any, targets: Targets, group: int) -> tuple[Action, ...]:
        """One for each rope."""
        ropes = targets.fitting("winch", given.winch, targets.ropes, "rope")
        cls.check_group(given, ropes)
        return tuple(_of_rope(rope, given, group) for rope in ropes)


def _of_rope(rope: str, given: Any, group: int) -> Action:
    if given.follow is not None:
        return WinchFollow(rope, given.follow, given.ratio)
    speed = given.speed or 0.0
    if given.tension is not None:
        return WinchTension(rope, given.tension, speed, given.dead_band)
    if given.length is not None:
        return WinchLength(rope, given.length, speed, given.ramp, **scaled_limits(given, 1))
    return winch_action(rope, given, group)
