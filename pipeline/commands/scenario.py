"""``heavylift scenario``: what the phases of a case do, how long its ropes will be, where hooks and drives go."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.assemble.operation_plan import (
    Range,
    check_hooks,
    check_plan,
    plan,
    routes_of,
    starts_of,
)
from heavylift.pipeline.results.storage import StopError
from heavylift.pipeline.stages.stages import load_changed_case, run_case
from heavylift.solver.scene.operations import RELEASE, RELEASE_JOINT

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from heavylift.pipeline.assemble.operation_plan import PlannedPhase
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.stages.operator_commands import OperatorCommand
    from heavylift.solver.scene.scenario import Phase

__all__ = ["scenario_command", "send_command"]


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
    from heavylift.solver.layout import pack_scene
    from heavylift.solver.scenario.operation import Operation

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
    operation = Operation(layout.sequencer, scenario, layout.channels)
    starts = starts_of(scene, operation)
    phases = plan(scenario, starts, routes_of(scene, operation))
    check_plan(case, phases, starts)
    check_hooks(case, scene)
    commanded = {name: starts[name] for row in phases for name in row[0].values}
    lines = [
        line for spec, row in zip(scenario.rows, phases, strict=True) for line in _table(spec, row, starts)
    ]
    lines += [_summary(case, name, phases, starts) for name in commanded]
    released = [one.name for one in scenario.commands if one.operation in (RELEASE, RELEASE_JOINT)]
    if released:
        lines.append(f"released: {', '.join(released)}")
    return _document(phases, commanded), lines


def send_command(
    path: Path, word: OperatorCommand, *, out: Path | None = None, overrides: Sequence[str] = ()
) -> str:
    """Send a command to the run in progress in the output folder of a case.

    Returns
    -------
    str
        Words for a person.

    Raises
    ------
    InputError
        If something is wrong with the case, it has no scenario, or no run is in progress.
    """
    from heavylift.pipeline.stages.operator_commands import send

    case = load_changed_case(path, overrides)
    if case.scenario is None:
        raise InputError("no scenario", source=case.file, key="scenario", expected="a case with one")
    send(case.output_folder if out is None else out, word)
    return f"{word}: sent; the run takes it within a second"


def _document(phases: Sequence[Sequence[PlannedPhase]], starts: Mapping[str, float]) -> dict[str, Any]:
    def values(found: Range) -> list[float | None]:
        return [value if math.isfinite(value) else None for value in (found.low, found.high)]

    rows = [
        [
            {
                "name": phase.name,
                "takes_s": values(phase.takes),
                "end": {name: values(value) for name, value in phase.values.items()},
                "largest_speed": dict(phase.speeds),
            }
            for phase in row
        ]
        for row in phases
    ]
    return {"start": dict(starts), "phases": rows[0], "tracks": rows[1:]}


def _table(spec: Sequence[Phase], phases: Sequence[PlannedPhase], starts: Mapping[str, float]) -> list[str]:
    """Table of the phases of a track for a person."""
    names = list(phases[0].values)
    header = ["phase", "takes [s]", *names, "does", "ends with"]
    rows = [["start", "", *(f"{starts[name]:.3f}" for name in names), "", ""]]
    for one, phase in zip(spec, phases, strict=True):
        joined = " or " if one.ends_with == "any" else " and "
        waits = joined.join(condition.text for condition in one.until) or "the end of the run"
        does = "; ".join(action.text for action in one.actions)
        rows.append([one.name, phase.takes.text, *(phase.values[name].text for name in names), does, waits])
    widths = [max(len(row[k]) for row in [header, *rows]) for k in range(len(header))]
    return [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in [header, *rows]
    ]


def _summary(
    case: Case, name: str, phases: Sequence[Sequence[PlannedPhase]], starts: Mapping[str, float]
) -> str:
    """Extremes of one thing that moves, against its limits, in a sentence."""
    own = [phase for row in phases if name in row[0].values for phase in row]
    fastest = max(phase.speeds[name] for phase in own)
    low, where = min((phase.values[name].low, phase.name) for phase in own)
    high, top = max((phase.values[name].high, phase.name) for phase in own)
    rope = next((rope for rope in case.ropes if rope.name == name), None)
    if rope is None:
        unit = "kg" if name in {tank.name for tank in case.tanks} else "m or rad"
        bounds = Range(min(low, starts[name]), max(high, starts[name]))
        return f"{name}: at most {fastest:.3g} a second, {bounds.text} {unit}"
    words = f"{name}: at most {fastest:.3g} m/s"
    most = getattr(rope.winch, "speed", None)
    words += f" of {most:g} m/s" if most is not None else ""
    if not math.isfinite(low):
        return (
            f"{words}, no least length is known from phase {where!r} on: it has no timeout, the rope is connected in"
            " it, or its winch is controlled otherwise"
        )
    words += f", shortest {low:.3f} m in phase {where!r}"
    if low <= 0.0:
        words = (
            f"{words.partition(', shortest')[0]}, hauled in whole if phase {where!r} takes as long as it may"
        )
    hook = next((one for one in case.falls if f"{one.name}_rope" == name), None)
    if hook is not None:
        up, down = (starts[name] - low) / hook.parts, (high - starts[name]) / hook.parts
        words += f"; hook at most {up:.3f} m above its start, {hook.drop - up:.3f} m below its crown"
        words += f", and {down:.3f} m below its start in phase {top!r}" if down > 0.0 else ""
    return words
