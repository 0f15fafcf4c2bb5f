"""A scenario becomes a kind: names of channels become columns, those of ropes numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Record, Records, records
from heavylift.solver.laws.pulls import RopePull
from heavylift.solver.laws.rope_path import PlaceGradient, RopePlace
from heavylift.solver.laws.wire_rope import PlaceMarkers, RopeEntry, Ropes, RopeState, WinchRow
from heavylift.solver.scenario.director import (
    CONNECT,
    FUNCTIONS,
    NOTE,
    RELEASE,
    WINCH_LENGTH,
    WINCH_ROWS,
    WINCH_SPEED,
    ActionEntry,
    ConditionEntry,
    Director,
    DirectorState,
    GivenRope,
    LimitEntry,
    LogEntry,
    PhaseEntry,
    SignalEntry,
    TermEntry,
    Timer,
    Worst,
)
from heavylift.solver.scene.channels import Channel
from heavylift.solver.scene.scenario import (
    Action,
    Connect,
    Note,
    Release,
    Scenario,
    Signal,
    Term,
    WinchLength,
    WinchSpeed,
    check_scenario,
)

__all__ = ["pack_scenario", "reserve_winches"]


def reserve_winches(
    joints: Sequence[Any], scenario: Scenario, channels: Sequence[Channel]
) -> tuple[Any, ...]:
    """Kinds of joints in which winches that are told what to do have room for it.

    Parameters
    ----------
    joints
        Kinds.
    scenario
        What the user said.
    channels
        Of the record, those of the ropes among them.
    """
    told = {
        channel.column
        for name in _told(scenario)
        for channel in channels
        if channel.name == f"{name}.tension"
    }
    made = []
    for kind in joints:
        if not isinstance(kind, Ropes):
            made.append(kind)
            continue
        rows: list[Any] = []
        for entry in kind.table:
            own = list(kind.winches[entry.winch : entry.winch + entry.winch_rows])
            if int(entry.column) in told:
                own = own or [WinchRow.one()]
                own += [own[-1]] * (WINCH_ROWS - len(own))
            entry.winch, entry.winch_rows = len(rows), len(own)
            rows += own
        winches = records(WinchRow, len(rows))
        for place, row in zip(winches, rows, strict=True):
            place.words[:] = row.words
        made.append(kind._replace(winches=winches))
    return tuple(made)


def _told(scenario: Scenario) -> set[str]:
    """Names of ropes whose winches are told what to do."""
    actions = [action for phase in scenario.phases for action in phase.actions]
    return {action.rope for action in actions if isinstance(action, (WinchSpeed, WinchLength))}


def pack_scenario(
    scenario: Scenario,
    ropes: Sequence[Any],
    joints: Sequence[Any],
    channels: Sequence[Channel],
    column: int,
    width: int,
    carried: Any,
) -> Director:
    """Make the kind.

    Parameters
    ----------
    scenario
        What the user said.
    ropes
        Of the scene.
    joints
        Kinds, among them that of the ropes.
    channels
        Of the whole record.
    column, width
        Of its own channel, and of a record.
    carried
        What a step changes, of which it is to keep a copy; empty if contacts do.

    Raises
    ------
    InputError
        If a channel is not there, or an action does not fit.
    """
    check_scenario(scenario, ropes)
    # winches that answer to a tension have no length to be told
    kinds = [kind for kind in joints if isinstance(kind, Ropes) and "controls" not in kind._fields]
    first, second = (*kinds, _no_ropes(), _no_ropes())[:2]
    known = {channel.name: channel for channel in channels}
    columns = {known[f"{rope.name}.tension"].column: rope.name for rope in ropes}
    told = _told(scenario)
    given: list[tuple[Any, ...]] = []
    numbers: dict[str, int] = {}
    for kind in (first, second):
        for i, entry in enumerate(kind.table):
            name = columns[int(entry.column)]
            numbers[name] = len(given)
            given.append((kind is second, i, entry.axial_stiffness, entry.damping, name in told))
            if name in scenario.prepared:
                entry.axial_stiffness = entry.damping = 0.0
    signals = scenario.signals
    terms: list[tuple[int, float]] = []
    signal_rows: list[tuple[int, int, int]] = []
    for signal in signals:
        parts = [found for term in signal.terms for found in _columns(term, signal, known)]
        signal_rows.append((len(terms), len(parts), FUNCTIONS.index(signal.function)))
        terms += parts
    place = {signal: i for i, signal in enumerate(signals)}
    phases: list[tuple[Any, ...]] = []
    conditions: list[tuple[Any, ...]] = []
    limits: list[tuple[Any, ...]] = []
    actions: list[tuple[Any, ...]] = []
    for phase in scenario.phases:
        begin = (len(actions), len(phase.actions), len(conditions), len(phase.until))
        timeout = phase.timeout or math.inf
        phases.append((*begin, len(limits), len(phase.limits), phase.ends_with == "any", timeout))
        actions += [_action(action, numbers) for action in phase.actions]
        for condition in phase.until:
            number = -1 if condition.signal is None else place[condition.signal]
            conditions.append((number, condition.below, condition.value, condition.hold))
        limits += [(place[one.signal], one.below, one.value, one.stop) for one in phase.limits]
    timers = records(Timer, len(conditions))
    timers["since"] = timers["trial"] = math.nan
    return Director(
        phases=_table(PhaseEntry, phases),
        conditions=_table(ConditionEntry, conditions),
        limits=_table(LimitEntry, limits),
        actions=_table(ActionEntry, actions),
        signals=_table(SignalEntry, signal_rows),
        terms=_table(TermEntry, terms),
        given=_table(GivenRope, given),
        ropes=first,
        others=second,
        rope_table=first.table,
        winches=first.winches,
        other_table=second.table,
        other_winches=second.winches,
        state=DirectorState.one(),
        timers=timers,
        passed=records(Worst, len(limits)),
        values=np.zeros(len(signals)),
        log=records(LogEntry, 2 * len(phases) + len(actions) + len(limits) + 2),
        trial=np.zeros(len(signals)),
        row=np.zeros(width),
        column=column,
        stops_at_end=scenario.stops_at_end,
        carried=carried,
        saved=np.zeros_like(carried),
    )


def _table(of: type[Record], rows: Sequence[tuple[Any, ...]]) -> Records[Any]:
    """Records of some rows, of none too."""
    return records(of, rows) if rows else records(of, 0)


def _no_ropes() -> Ropes:
    """The kind of a scene without ropes."""
    return Ropes(
        records(RopeEntry, 0),
        records(PlaceMarkers, 0),
        records(WinchRow, 0),
        records(RopePlace, 0),
        records(PlaceGradient, 0),
        records(RopeState, 0),
        np.zeros(0),
        records(RopePull, 0),
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


def _action(action: Action, numbers: Mapping[str, int]) -> tuple[int, int, float, float, float]:
    """Entry of an action."""
    if isinstance(action, Note):
        return NOTE, -1, 0.0, 0.0, 0.0
    rope = numbers[action.rope]
    if isinstance(action, WinchSpeed):
        return WINCH_SPEED, rope, action.speed, 0.0, action.ramp
    if isinstance(action, WinchLength):
        return WINCH_LENGTH, rope, action.length, action.speed, action.ramp
    if isinstance(action, Release):
        return RELEASE, rope, 0.0, 0.0, 0.0
    assert isinstance(action, Connect)
    return CONNECT, rope, action.slack, 0.0, 0.0
