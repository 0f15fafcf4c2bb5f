"""What a user says of an operation: phases in a row, what each of them does, waits for, and must not see."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.operation_state import Movable, OperationState
from heavylift.solver.scene.operations import CONNECT, RELEASE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from heavylift.solver.scene.actions import Action
    from heavylift.solver.scene.commands import Command
    from heavylift.solver.scene.signals import Signal

__all__ = ["Condition", "Limit", "Phase", "Scenario", "Track", "check_scenario", "loose_ropes"]


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
            return f"{name} at rest at its commanded position{held}"
        return f"{name} {'below' if self.below else 'above'} {_value(self)}{held}"


@dataclass(frozen=True)
class Limit:
    """What has to be so during a phase: a signal above or below a value.

    Attributes
    ----------
    signal, value, below, weight_of
        As of a condition.
    stop
        Whether the run ends where the limit is violated; else there is a warning.
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
    def commands(self) -> tuple[Command, ...]:
        """What all of these give to actuators."""
        return tuple(action.command() for action in self.actions)

    @property
    def signals(self) -> tuple[Signal, ...]:
        """All that is looked at, each once."""
        found: dict[Signal, None] = {}
        for phase in self.all_phases:
            waited = [condition.signal for condition in phase.until if condition.signal is not None]
            commands = [action.command() for action in phase.actions]
            asked = [one.signal for one in commands if one.signal is not None]
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
                command = action.command()
                if command.operation == RELEASE:
                    loose.add(command.name)
                elif command.operation == CONNECT:
                    loose.discard(command.name)
    return loose


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
    start = OperationState(movable, (), ())
    for index, name in enumerate(scenario.prepared):
        start.rope(name, f"prepared.{index}")
    names: set[str] = set()
    for row, phases in enumerate(scenario.rows):
        others = (phase for other in scenario.rows if other is not phases for phase in other)
        state = OperationState(
            movable, scenario.prepared, (action.command() for phase in others for action in phase.actions)
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
                place = f"{key}.actions.{number}"
                state.check_command(action.command(), place)
                action.check(state, place)
            _can_end(phase, state, f"{key}.until")
            state.end_phase(_waited_for(phase))


def _can_end(phase: Phase, state: OperationState, key: str) -> None:
    """Refuse conditions of a phase that cannot become true."""
    reasons = [_why_never(one, state) for one in phase.until]
    never = all(reasons) if phase.ends_with == "any" else any(reasons)
    if reasons and never:
        reason, expected = next(one for one in reasons if one)
        raise InputError(f"phase {phase.name!r} can never end: {reason}", key=key, expected=expected)


def _waited_for(phase: Phase) -> list[str]:
    """Names of what has arrived when a phase ends."""
    if phase.ends_with == "any" and len(phase.until) > 1:
        return []
    signals = [one.signal for one in phase.until if one.signal is not None]
    return [term.channel for signal in signals if signal.function == "arrived" for term in signal.terms]


def _why_never(condition: Condition, state: OperationState) -> tuple[str, str] | None:
    """Why a condition cannot become true, and what could; None if nothing is known against it."""
    signal, value = condition.signal, condition.value
    if signal is None:
        if value + condition.hold > state.movable.duration * (1.0 + 1e-12):
            problem = (
                f"it waits for {value + condition.hold:g} s, and the run takes {state.movable.duration:g} s"
            )
            return problem, "a shorter time, or a longer duration"
        return None
    if signal.function == "arrived":
        idle = [term.channel for term in signal.terms if term.channel not in state.arriving | state.elsewhere]
        if idle:
            return f"{idle[0]!r} has no commanded position", "an earlier action with a position"
        return None
    owner, _, kind = signal.terms[0].channel.rpartition(".") if signal.terms else ("", "", "")
    if len(signal.terms) != 1 or owner not in state.movable.ropes or signal.terms[0].weight != 1.0:
        return None
    if owner in state.elsewhere:
        return None
    if kind == "tension" and not condition.below and value > 0.0 and owner in state.loose:
        return f"{owner!r} is not connected, and has no tension", "a rope that is connected"
    if kind == "rest_length" and owner in state.lengths:
        length = state.lengths[owner]
        if value < length if condition.below else value > length:
            return (
                f"the winch of {owner!r} stops at {length:g} m, and it waits for {condition.text}",
                "a length that it reaches",
            )
        return None
    if kind == "rest_length":
        speed = state.planned.get(owner, 0.0)
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
