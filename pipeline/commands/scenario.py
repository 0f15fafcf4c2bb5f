"""``heavylift scenario``: what the phases of a case do, and how long its ropes will be, without dynamics.

A phase that waits for a time or for the length of a rope takes a time that is known. One that waits for something else
takes anything up to its timeout, so lengths are between two values from there on, until a winch goes to a length.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.results.storage import StopError
from heavylift.pipeline.stages.stages import load_changed_case, run_case
from heavylift.solver.scene.scenario import Connect, Release, WinchLength, WinchSpeed

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from heavylift.pipeline.log import Log
    from heavylift.pipeline.stages.told import Word
    from heavylift.solver.scene.scenario import Phase, Scenario

__all__ = ["PlannedPhase", "plan", "scenario_command", "tell_command"]


@dataclass(frozen=True)
class Range:
    """Between two values [m], [s]; equal if it is known."""

    low: float
    high: float

    @property
    def text(self) -> str:
        """Words for it."""
        if not math.isfinite(self.high) and not math.isfinite(self.low):
            return "unknown"
        if self.high - self.low <= 1e-9 * max(1.0, abs(self.high)):
            return f"{self.high:.3f}"
        low = "any" if not math.isfinite(self.low) else f"{self.low:.3f}"
        return f"{low} to {'any' if not math.isfinite(self.high) else f'{self.high:.3f}'}"


@dataclass(frozen=True)
class PlannedPhase:
    """A phase as far as it is known before.

    Attributes
    ----------
    name
        Its name.
    takes
        How long [s].
    lengths
        Unstretched length at its end [m], of each rope whose winch is told what to do.
    speeds
        Of these winches [m/s].
    """

    name: str
    takes: Range
    lengths: Mapping[str, Range]
    speeds: Mapping[str, float]


@dataclass
class _Winch:
    """Length of a rope [m], speed of its winch at the start of a phase and towards which it goes [m/s], ramp [s]."""

    length: Range
    before: float = 0.0
    speed: float = 0.0
    ramp: float = 0.0

    def hauled(self, time: float) -> float:
        """Since the start of the phase [m]."""
        if math.isinf(time):
            return math.copysign(math.inf, self.speed) if self.speed else self.hauled(self.ramp)
        if time >= self.ramp:
            return 0.5 * (self.before + self.speed) * self.ramp + self.speed * (time - self.ramp)
        return time * (self.before + 0.5 * (self.speed - self.before) / self.ramp * time)

    def after(self, takes: Range) -> Range:
        """Length after a time between two values; speeds that change their sense do so in the ramp."""
        times = [takes.low, takes.high]
        if self.before * self.speed < 0.0:
            turn = self.ramp * self.before / (self.before - self.speed)
            times += [turn] * (takes.low < turn < takes.high)
        ways = [self.hauled(time) for time in times]
        return Range(self.length.low - max(ways), self.length.high - min(ways))


def plan(scenario: Scenario, lengths: Mapping[str, float]) -> list[PlannedPhase]:
    """Times and lengths of all phases.

    Parameters
    ----------
    scenario
        Checked.
    lengths
        Unstretched lengths of the ropes at the start [m].
    """
    told = [action for phase in scenario.phases for action in phase.actions]
    names = dict.fromkeys(a.rope for a in told if isinstance(a, (WinchSpeed, WinchLength)))
    winches = {name: _Winch(Range(lengths[name], lengths[name])) for name in names}
    found = []
    for phase in scenario.phases:
        targets: dict[str, WinchLength] = {}
        for action in phase.actions:
            if isinstance(action, WinchSpeed):
                winches[action.rope].speed, winches[action.rope].ramp = action.speed, action.ramp
            elif isinstance(action, WinchLength):
                targets[action.rope] = action
            elif isinstance(action, Connect) and action.rope in winches:
                winches[action.rope].length = Range(-math.inf, math.inf)  # that of its path then
        takes = _takes(phase, {name: winch for name, winch in winches.items() if name not in targets})
        speeds = {}
        for name, winch in winches.items():
            target = targets.get(name)
            if target is not None:
                way = winch.length.low - target.length
                winch.length = Range(target.length, target.length)
                winch.before = winch.speed = 0.0
                speeds[name] = math.copysign(target.speed, way)
                continue
            winch.length = _met(phase, name, winch, takes) or winch.after(takes)
            winch.before, winch.ramp = winch.speed, 0.0
            speeds[name] = winch.speed
        ends = {name: winch.length for name, winch in winches.items()}
        found.append(PlannedPhase(phase.name, takes, ends, speeds))
    return found


def _takes(phase: Phase, winches: Mapping[str, _Winch]) -> Range:
    """How long a phase may take [s]; of winches that go to lengths nothing is said here."""
    longest = phase.timeout or math.inf
    lows, highs = [], []
    for condition in phase.until:
        if condition.signal is None:
            lows.append(condition.value)
            highs.append(condition.value)
            continue
        low = condition.hold
        name = condition.signal.name.removesuffix(".rest_length")
        winch = winches.get(name)
        way = None
        if winch is not None and name != condition.signal.name and winch.length.low == winch.length.high:
            way = winch.length.low - condition.value
        if winch is not None and way is not None and winch.speed and way / winch.speed > 0.0:
            ramped = winch.hauled(winch.ramp)
            low += winch.ramp + (way - ramped) / winch.speed
            highs.append(low)
        else:
            highs.append(longest)
        lows.append(low)
    if not lows:
        return Range(0.0, longest)
    choose = min if phase.ends_with == "any" else max
    return Range(min(choose(lows), longest), min(choose(highs), longest))


def _met(phase: Phase, name: str, winch: _Winch, takes: Range) -> Range | None:
    """Length of a rope at the end of a phase that waits for it alone; None if it waits for something else."""
    if len(phase.until) != 1 or phase.until[0].signal is None or phase.until[0].hold:
        return None
    if phase.until[0].signal.name != f"{name}.rest_length" or takes.low != takes.high or not winch.speed:
        return None
    value = phase.until[0].value
    return Range(value, value)


def scenario_command(
    path: Path, *, out: Path | None = None, overrides: Sequence[str] = (), log: Log
) -> tuple[dict[str, Any], list[str]]:
    """Check the scenario of a case against its scene, and plan it.

    Returns
    -------
    tuple
        Document, and tables for a person.

    Raises
    ------
    InputError
        If something is wrong with the case, or it has no scenario.
    StopError
        If a stage before stops by itself.
    """
    from heavylift.pipeline.assemble.scene import assemble_scene
    from heavylift.pipeline.case.places import in_case
    from heavylift.solver.laws.wire_rope import Ropes
    from heavylift.solver.layout import pack_scene

    case = load_changed_case(path, overrides)
    if case.scenario is None or case.simulate is None:
        raise InputError(
            "no scenario", source=case.file, key="scenario", expected="tables [[scenario.phases]]"
        )
    result = run_case(case, out=out, stages=("mesh", "modes"), log=log)
    if result.outcome is not Outcome.COMPLETED:
        raise StopError(result.outcome, result.message)
    with in_case(case):
        scene = assemble_scene(case, result.folder)
        layout = pack_scene(scene)
    scenario = scene.scenario
    assert scenario is not None
    owners = {channel.column: channel.name.rpartition(".")[0] for channel in layout.channels}
    lengths = {
        owners[int(entry.column)]: float(entry.start_length)
        for kind in layout.joints
        if isinstance(kind, Ropes)
        for entry in kind.table
    }
    phases = plan(scenario, lengths)
    return _document(phases, lengths), _lines(scenario, phases, lengths)


def tell_command(path: Path, word: Word, *, out: Path | None = None, overrides: Sequence[str] = ()) -> str:
    """Say a word to the run that goes on in the output folder of a case.

    Returns
    -------
    str
        Words for a person.

    Raises
    ------
    InputError
        If something is wrong with the case, it has no scenario, or no run goes on.
    """
    from heavylift.pipeline.stages.told import tell

    case = load_changed_case(path, overrides)
    if case.scenario is None:
        raise InputError("no scenario", source=case.file, key="scenario", expected="a case with one")
    tell(case.output_folder if out is None else out, word)
    return f"{word}: told; the run takes it within a second"


def _document(phases: Sequence[PlannedPhase], lengths: Mapping[str, float]) -> dict[str, Any]:
    def values(found: Range) -> list[float | None]:
        return [value if math.isfinite(value) else None for value in (found.low, found.high)]

    return {
        "start": dict(lengths),
        "phases": [
            {
                "name": phase.name,
                "takes_s": values(phase.takes),
                "rest_length_m": {name: values(length) for name, length in phase.lengths.items()},
                "speed_m_s": dict(phase.speeds),
            }
            for phase in phases
        ],
    }


def _lines(scenario: Scenario, phases: Sequence[PlannedPhase], lengths: Mapping[str, float]) -> list[str]:
    """Tables for a person."""
    names = list(phases[0].lengths)
    header = ["phase", "takes [s]", *(f"{name} [m]" for name in names), "does", "ends with"]
    rows = [["start", "", *(f"{lengths[name]:.3f}" for name in names), "", ""]]
    for said, phase in zip(scenario.phases, phases, strict=True):
        joined = " or " if said.ends_with == "any" else " and "
        waits = joined.join(one.text for one in said.until) or "the end of the run"
        does = "; ".join(action.text for action in said.actions)
        ends = [phase.lengths[name].text for name in names]
        rows.append([said.name, phase.takes.text, *ends, does, waits])
    widths = [max(len(row[k]) for row in [header, *rows]) for k in range(len(header))]
    lines = [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in [header, *rows]
    ]
    for name in names:
        low, where = min(
            ((phase.lengths[name].low, phase.name) for phase in phases), default=(lengths[name], "start")
        )
        fastest = max(abs(phase.speeds[name]) for phase in phases)
        words = f"{name}: at most {fastest:.3g} m/s"
        if not math.isfinite(low):
            words += (
                f", no least length is known from phase {where!r} on: it has no timeout, or connects the rope"
            )
        elif low <= 0.0:
            words += f", hauled in whole if phase {where!r} takes as long as it may"
        else:
            words += f", shortest {low:.3f} m in phase {where!r}"
        lines.append(words)
    released = [a.rope for phase in scenario.phases for a in phase.actions if isinstance(a, Release)]
    if released:
        lines.append(f"released: {', '.join(released)}")
    return lines
