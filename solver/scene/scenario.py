"""What a user says of an operation: phases in a row, what each of them does, waits for, and must not see."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "Action",
    "Condition",
    "Connect",
    "Limit",
    "Note",
    "Phase",
    "Release",
    "Scenario",
    "Signal",
    "Term",
    "WinchLength",
    "WinchSpeed",
    "check_scenario",
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
        Sum of the terms; the norm of a vector with these components; the largest or the smallest of them.
    text
        Its name in messages; made from the terms if empty.
    """

    terms: tuple[Term, ...]
    function: Literal["sum", "norm", "largest", "smallest"] = "sum"
    text: str = ""

    @property
    def name(self) -> str:
        """Words for it."""
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
        In SI.
    below
        Whether it is true below the value, not above.
    hold
        How long it has to be true without a break [s].
    """

    signal: Signal | None
    value: float
    below: bool = False
    hold: float = 0.0

    @property
    def text(self) -> str:
        """Words for it."""
        name = "time in the phase" if self.signal is None else self.signal.name
        held = f" for {self.hold:g} s" if self.hold else ""
        return f"{name} {'below' if self.below else 'above'} {self.value:.6g}{held}"


@dataclass(frozen=True)
class Limit:
    """What has to be so during a phase: a signal above or below a value.

    Attributes
    ----------
    signal, value, below
        As of a condition.
    stop
        Whether the run ends where it is not so; else it is told.
    """

    signal: Signal
    value: float
    below: bool = True
    stop: bool = True

    @property
    def text(self) -> str:
        """Words for it."""
        return f"{self.signal.name} {'below' if self.below else 'above'} {self.value:.6g}"


@dataclass(frozen=True)
class WinchSpeed:
    """From its present speed a winch comes to another one.

    Attributes
    ----------
    rope
        Name.
    speed
        [m/s], hauls in if positive.
    ramp
        Time that the change takes [s], the acceleration is constant; at once with 0.
    """

    rope: str
    speed: float
    ramp: float = 0.0

    @property
    def text(self) -> str:
        """Words for it."""
        return f"winch of {self.rope!r} to {self.speed:g} m/s" + (f" in {self.ramp:g} s" * bool(self.ramp))


@dataclass(frozen=True)
class WinchLength:
    """A winch hauls in or pays out until the rope has an unstretched length, and stops there.

    Attributes
    ----------
    rope
        Name.
    length
        Unstretched length in play [m].
    speed
        At most [m/s].
    ramp
        Time from rest to this speed, and back to rest [s]; at once with 0.
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
class Release:
    """A rope lets go: from now on it does nothing, and what it had stored is lost."""

    rope: str

    @property
    def text(self) -> str:
        """Words for it."""
        return f"release of {self.rope!r}"


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


Action: TypeAlias = WinchSpeed | WinchLength | Release | Connect | Note


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
    """

    phases: tuple[Phase, ...]
    prepared: tuple[str, ...] = ()
    stops_at_end: bool = False

    @property
    def signals(self) -> tuple[Signal, ...]:
        """All that is looked at, each once."""
        found: dict[Signal, None] = {}
        for phase in self.phases:
            waited = [condition.signal for condition in phase.until if condition.signal is not None]
            found |= dict.fromkeys([*waited, *(limit.signal for limit in phase.limits)])
        return tuple(found)


def check_scenario(scenario: Scenario, ropes: Sequence[Any]) -> None:
    """Refuse phases that cannot end, and actions on what is not there or is not as they need it.

    Parameters
    ----------
    scenario
        Phases.
    ropes
        Of the scene: of each its ``name``; a wire rope has an ``axial_stiffness``.

    Raises
    ------
    InputError
        The first thing that is wrong; the key says where in the scenario.
    """
    if not scenario.phases:
        raise InputError("no phases", key="phases", expected="one or more")
    known = {rope.name: rope for rope in ropes}
    loose = set()
    for index, name in enumerate(scenario.prepared):
        _wire(name, known, f"prepared.{index}")
        loose.add(name)
    names: set[str] = set()
    for index, phase in enumerate(scenario.phases):
        key = f"phases.{index}"
        if phase.name in names:
            raise InputError(
                f"{phase.name!r} is the name of two phases", key=f"{key}.name", expected="a name of its own"
            )
        names.add(phase.name)
        if not phase.until and not phase.timeout and index + 1 < len(scenario.phases):
            raise InputError(
                f"phase {phase.name!r} can never end: it has neither 'until' nor 'timeout'",
                key=key,
                expected="'until', or no phases behind it",
            )
        if not phase.until and scenario.stops_at_end and index + 1 == len(scenario.phases):
            raise InputError(
                f"the last phase {phase.name!r} has no 'until', with which the run could end",
                key=key,
                expected="'until', or 'then' of the scenario 'go_on'",
            )
        for number, action in enumerate(phase.actions):
            _check_action(action, known, loose, f"{key}.actions.{number}")


def _wire(name: str, known: dict[str, Any], key: str) -> None:
    """Refuse what is no rope of type 'wire'."""
    if name not in known:
        near = get_close_matches(name, known, 1)
        raise InputError(
            f"{name!r} is no rope" + (f"; did you mean {near[0]!r}?" if near else ""),
            key=key,
            expected=f"one of: {', '.join(known) or 'there are none'}",
        )
    word = getattr(known[name], "type", None) or known[name].WORD  # of a table of a case, or of an object
    if word != "wire":
        raise InputError(f"{name!r} is a rope of type {word!r}", key=key, expected="a rope of type 'wire'")


def _check_action(action: Action, known: dict[str, Any], loose: set[str], key: str) -> None:
    """See that an action finds what it needs, and change what is connected."""
    if isinstance(action, Note):
        return
    word = {Release: "release", Connect: "connect"}.get(type(action), "winch")
    _wire(action.rope, known, f"{key}.{word}")
    if isinstance(action, Release):
        if action.rope in loose:
            raise InputError(
                f"{action.rope!r} is not connected then", key=f"{key}.release", expected="a rope that is"
            )
        loose.add(action.rope)
    elif isinstance(action, Connect):
        if action.rope not in loose:
            raise InputError(
                f"{action.rope!r} is connected then",
                key=f"{key}.connect",
                expected="a rope that was released, or is in 'prepared'",
            )
        loose.discard(action.rope)
