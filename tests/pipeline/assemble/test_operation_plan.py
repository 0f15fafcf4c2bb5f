"""What is planned before a run against what the run does: when phases end, where winches and drives are then."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.assemble.operation_plan import plan, routes_of, starts_of
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.case.places import in_case
from heavylift.solver.layout import pack_scene
from heavylift.solver.scenario.operation import Operation
from heavylift.solver.scene.scenario import Condition, Scenario

CASES = Path(__file__).resolve().parents[3] / "cases"


@pytest.mark.parametrize(
    ("name", "known"),
    [
        ("staged_lift/case.toml", {"look", "hold", "release"}),
        pytest.param(
            "gantry_lift/by_phases.toml", {"hold", "hoist", "trolleys", "release"}, marks=pytest.mark.slow
        ),
    ],
)
def test_a_run_goes_as_it_was_planned(name: str, known: set[str], tmp_path: Path) -> None:
    """Within the bounds of the plan; and where the plan is given how long phases took, it is where the run is."""
    case = load_case(CASES / name)
    report = run_case(case, out=tmp_path, stages=("mesh", "modes", "simulate"))
    assert report.outcome is Outcome.COMPLETED, report.message
    with in_case(case):
        scene = assemble_scene(case, report.folder)
    layout = pack_scene(scene)
    scenario = scene.scenario
    assert scenario is not None
    operation = Operation(layout.sequencer, scenario, layout.channels)
    starts, routes = starts_of(scene, operation), routes_of(scene, operation)
    results = load_results(case, tmp_path)
    done = [line for line in results.metadata["scenario"]["log"] if line[2] == "done"]
    ends, took = {line[1]: line[0] for line in done}, {line[1]: line[4] for line in done}
    assert len(ends) == len(scenario.phases)

    def found(actuator: str, phase: str) -> float:
        owner, _, axis = actuator.rpartition(".")
        if not owner:
            history = results[f"{actuator}.rest_length"]
        else:
            history = results[f"{owner}.position"][:, "xyz".index(axis)]
            history = history - history[0]
        # the parabola of the last records within the phase: at its end speeds may jump
        last = int(np.searchsorted(results.time, ends[phase] + 1e-9, side="right"))
        times = results.time[last - 3 : last] - ends[phase]
        return float(np.polyfit(times, history.ravel()[last - 3 : last], 2)[-1])

    (bounds,) = plan(scenario, starts, routes)
    for phase in bounds:
        assert phase.takes.low - 1e-9 <= took[phase.name] <= phase.takes.high + 1e-9
        for actuator, value in phase.values.items():
            assert value.low - 1e-7 <= found(actuator, phase.name) <= value.high + 1e-7
    assert known <= {phase.name for phase in bounds if phase.takes.known}

    timed = tuple(
        replace(phase, until=(Condition(None, took[phase.name]),), ends_with="all", timeout=0.0)
        for phase in scenario.phases
    )
    (replayed,) = plan(Scenario(timed, scenario.prepared), starts, routes)
    compared = [
        (value.low, found(actuator, phase.name))
        for phase in replayed
        for actuator, value in phase.values.items()
        if value.known
    ]
    assert len(compared) >= len(scenario.phases)
    np.testing.assert_allclose(*np.transpose(compared), rtol=0.0, atol=1e-7)
