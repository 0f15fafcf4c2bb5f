"""What a scenario did, in words: its log, what it still waits for, why it ended the run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.scenario.sequencer import (
    ACTION,
    BEGUN,
    DONE,
    LIMIT_STOP,
    LIMIT_WARNING,
    NOT_CONNECTED,
    ROPE_USED_UP,
    TIMED_OUT,
    TOLD,
    WORDS,
    Sequencer,
)
from heavylift.solver.scene.channels import Channel
from heavylift.solver.scene.scenario import Phase, Scenario

__all__ = ["LogLine", "Operation"]

EVENTS = {
    BEGUN: "begins",
    ACTION: "action",
    DONE: "done",
    LIMIT_WARNING: "limit passed",
    LIMIT_STOP: "limit passed, stop",
    TIMED_OUT: "timed out, stop",
    ROPE_USED_UP: "rope hauled in, stop",
    NOT_CONNECTED: "rope too short, stop",
    TOLD: "operator command",
}
"""Words of the events of the log."""


@dataclass(frozen=True)
class LogLine:
    """Something that happened.

    Attributes
    ----------
    time
        [s].
    phase, event, what
        Name of the phase, what sort of thing, and words for it.
    value
        Of the signal of a limit; of an action its command: speed [m/s], length [m], energy that a rope lost [J],
        its unstretched length [m]; of a phase that is done how long it took [s].
    tone
        Frequency that is heard of an action [Hz]; 0 is none.
    """

    time: float
    phase: str
    event: str
    what: str
    value: float
    tone: float = 0.0

    @property
    def text(self) -> str:
        """All of it in a line."""
        what = f": {self.what}" if self.what else ""
        value = (
            f" ({self.value:.6g})" if self.event not in {EVENTS[BEGUN], EVENTS[ACTION], EVENTS[TOLD]} else ""
        )
        return f"t = {self.time:.6g} s, {self.phase}: {self.event}{what}{value}"


class Operation:
    """A scenario on its way.

    Parameters
    ----------
    sequencer
        The kind.
    scenario
        From which it was made.
    channels
        Of the record.

    Attributes
    ----------
    heard
        Words from outside that this object was told.
    """

    def __init__(self, sequencer: Sequencer, scenario: Scenario, channels: Sequence[Channel]) -> None:
        self.sequencer, self.scenario = sequencer, scenario
        self.heard = 0
        owners = {channel.column: channel.name.rpartition(".")[0] for channel in channels}
        kinds = (sequencer.ropes, sequencer.rubbing, sequencer.held)
        self._ropes = tuple(owners[int(entry.column)] for kind in kinds for entry in kind.table)

    @property
    def log(self) -> list[LogLine]:
        """What happened so far."""
        phases, actions = self.scenario.all_phases, self.scenario.actions
        limits = [limit.text for phase in phases for limit in phase.limits]
        words = {
            ACTION: [action.text for action in actions],
            LIMIT_WARNING: limits,
            LIMIT_STOP: limits,
            ROPE_USED_UP: [f"winch of {name!r}" for name in self._ropes],
            NOT_CONNECTED: [f"connection of {name!r}" for name in self._ropes],
            TOLD: WORDS,
        }
        found = []
        for line in self.sequencer.log[: int(self.sequencer.state.logged)]:
            event, phase = int(line.event), phases[int(line.phase)]
            what = words[event][int(line.item)] if event in words else ""
            if event == DONE:
                what = _waits_for(phase)
            tone = actions[int(line.item)].tone() if event == ACTION else 0.0
            found.append(LogLine(float(line.time), phase.name, EVENTS[event], what, float(line.value), tone))
        return found

    @property
    def rope_lengths(self) -> dict[str, float]:
        """Unstretched lengths of the wire ropes at the start [m], by name."""
        kinds = (self.sequencer.ropes, self.sequencer.rubbing, self.sequencer.held)
        lengths = [float(entry.start_length) for kind in kinds for entry in kind.table]
        return dict(zip(self._ropes, lengths, strict=True))

    @property
    def told_count(self) -> int:
        """How many words came from outside so far."""
        return int(np.count_nonzero(self.sequencer.log["event"][: int(self.sequencer.state.logged)] == TOLD))

    @property
    def unfinished(self) -> str:
        """What it still waits for, as words; empty if the last phase is done, or waits for nothing."""
        for phases, track in zip(self.scenario.rows, self.sequencer.track_state, strict=True):
            number = int(track.phase)
            if number > len(phases) or (number == len(phases) and not phases[-1].until):
                continue
            phase = phases[number - 1]
            waits = _waits_for(phase) or "its timeout"
            return f"phase {phase.name!r}, number {number} of {len(phases)}, still waits for {waits}"
        return ""

    def tell(self, word: Literal["continue", "hold", "stop"], time: float) -> None:
        """Let someone outside say something: go on, or wait in this phase, or end the run.

        Parameters
        ----------
        word
            "continue" ends what "hold" began; else it is what a phase waits for, if any does.
        time
            Now [s].
        """
        sequencer = self.sequencer
        state = sequencer.state
        self.heard += 1
        if word == "stop" and int(state.outcome) == 0:
            state.outcome = int(Outcome.LIMIT_REACHED)
        elif word == "hold":
            state.held = True
        elif word == "continue":
            if not state.held:
                state.continued = time
            state.held = False
        number = min(int(sequencer.track_state[0].phase), len(self.scenario.phases)) - 1
        if int(state.logged) < len(sequencer.log):
            line = sequencer.log[int(state.logged)]
            line.time, line.event, line.phase, line.item, line.value = (
                time,
                TOLD,
                number,
                WORDS.index(word),
                0.0,
            )
            state.logged += 1

    @property
    def end(self) -> tuple[Outcome, str]:
        """Outcome with which it ended the run, and a message; completed if that was as planned, or it did not."""
        why = int(self.sequencer.state.outcome)
        if why <= 0:
            return Outcome.COMPLETED, ""
        outcome, last = Outcome(why), self.log[-1]
        if last.event == EVENTS[TOLD]:
            return outcome, f"stopped by the operator at t = {last.time:.9g} s, phase {last.phase!r}"
        what = f": {last.what} is {last.value:.6g}" if last.what else f" after {last.value:.6g} s"
        return outcome, f"{outcome.text} at t = {last.time:.9g} s, phase {last.phase!r}{what}"

    def check_begun(self) -> None:
        """Refuse a first phase that is over before time starts, or that stops there.

        Raises
        ------
        InputError
            Names the phase and what is true already.
        """
        if int(self.sequencer.state.outcome):
            last = self.log[-1]
            raise InputError(
                f"{last.what}: its path is longer than {last.value:.6g} m by more than 2 %",
                source="scenario",
                key="phases.0.actions",
                expected="more slack",
            )
        first = 0
        for number, phases in enumerate(self.scenario.rows):
            phase = phases[0]
            met = [self._is_met(first + i) for i in range(len(phase.until))]
            if phase.until and (any(met) if phase.ends_with == "any" else all(met)):
                raise InputError(
                    f"phase {phase.name!r} is over before it begins: {phase.until[met.index(True)].text} at the start",
                    source="scenario",
                    key=f"tracks.{number - 1}.phases.0.until" if number else "phases.0.until",
                    expected="a condition that is not true at the start",
                )
            first += sum(len(one.until) for one in phases)

    def _is_met(self, number: int) -> bool:
        """Whether a condition is true as things are, and need not be so for a time."""
        condition = self.sequencer.conditions[number]
        if int(condition.signal) < 0 or float(condition.hold) > 0.0:
            return False
        x = float(self.sequencer.values[int(condition.signal)])
        return bool(x <= condition.value if condition.below else x >= condition.value)


def _waits_for(phase: Phase) -> str:
    """Conditions of a phase, as words."""
    joined = " or " if phase.ends_with == "any" else " and "
    return joined.join(one.text for one in phase.until)
