"""Served cases of all sorts: events of a scenario, states that go on elsewhere, results that other commands read."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import heavylift as hl
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.exchange.service import Seat, Service
from tests.pipeline.exchange.processes import COMMAND, HOIST

msgpack = pytest.importorskip("msgpack")

CASES = HOIST.parent
PHASES = Path(__file__).parents[1] / "phases.toml"


@pytest.fixture
def phases(tmp_path):
    folder = tmp_path / "phases"
    folder.mkdir()
    shutil.copyfile(PHASES, folder / "case.toml")
    return folder


def test_events_of_a_scenario_come_with_the_steps_that_pass_them(phases):
    direct, expected = hl.Simulation(phases), []
    direct.on_event(lambda line: expected.append((line.time, line.phase, line.event, line.what)))
    found = []
    with hl.open_child(phases) as remote:
        remote.on_event(lambda line: found.append(tuple(line)))
        while not remote.ended:
            before = len(found)
            remote.step(0.1)
            direct.step(0.1)
            assert found == expected
            assert all(remote.time - 0.1 - 1e-9 <= line[0] <= remote.time + 1e-9 for line in found[before:])
        assert remote.time == direct.time < remote.duration
        assert remote.outcome is hl.Outcome.COMPLETED
    assert {line[1] for line in found} == {"hoist", "hold", "drop"}


def test_a_limit_of_a_scenario_stops_the_run(phases):
    text = (phases / "case.toml").read_text(encoding="utf-8").replace('below = "200 kN"', 'below = "99 kN"')
    (phases / "case.toml").write_text(text, encoding="utf-8")
    with hl.open_child(phases, out=phases / "out") as remote:
        with pytest.raises(hl.SimulationStopped, match="t = ") as caught:
            remote.step(5.0)
        assert caught.value.outcome is remote.outcome is hl.Outcome.LIMIT_REACHED
        assert remote.message == str(caught.value)
        assert remote.ended
        child = remote._child
    assert child.returncode == int(hl.Outcome.LIMIT_REACHED)
    assert (phases / "out" / "simulate" / "results.h5").is_file()


def drive(case: Path, out: Path) -> None:
    """The whole run, by a parent."""
    with hl.open_child(case, out=out) as remote:
        remote.step(remote.duration)


@pytest.mark.slow
@pytest.mark.parametrize("command", ["report", "verify", "statistics", "criteria"])
def test_results_of_a_driven_run_are_read_by_other_commands(command, tmp_path):
    case = tmp_path / "hoist"
    shutil.copytree(HOIST, case, ignore=shutil.ignore_patterns("out"))
    drive(case, case / "out")
    before = (case / "out" / "simulate" / "results.h5").read_bytes()
    done = subprocess.run([*COMMAND[:-1], command, str(case)], capture_output=True, text=True, check=False)
    if command in {"report", "verify"}:
        assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    assert (case / "out" / "simulate" / "results.h5").read_bytes() == before  # nothing is computed again


@pytest.mark.slow
def test_simulate_continues_what_a_master_has_left(tmp_path):
    """With the bits of a run in one go, since nothing was driven."""
    case = load_case(HOIST)
    with hl.open_child(HOIST, out=tmp_path / "left") as remote:
        remote.step(7.0)
    assert load_results(case, tmp_path / "left").time[-1] == 7.0
    whole = {}
    for name in ("left", "fresh"):
        report = run_case(case, out=tmp_path / name, stages=("simulate",)).stages[-1]
        assert report.outcome is hl.Outcome.COMPLETED
        whole[name] = load_results(case, tmp_path / name)
    for channel in whole["fresh"]:
        assert whole["left"][channel].tobytes() == whole["fresh"][channel].tobytes(), channel
    assert whole["left"].time.tobytes() == whole["fresh"].time.tobytes()


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "belt_sliding",  # frames, friction
        "box_drop",  # collisions
        "flexible_pendulum",  # modes
        "floating_crane_lift",  # hulls, mooring, sea, equipment
        "hanging_cable",
        "irregular_sea",
        "module_erection",  # a scenario
    ],
)
def test_a_state_of_any_case_goes_on_in_another_process(name):
    with hl.open_child(CASES / name) as there:
        there.step(5 * there.step_size)
        here = hl.Simulation(CASES / name)
        here.restore(hl.State.from_bytes(there.save_bytes()))
        names = list(here.outputs)
        there.step(5 * there.step_size, outputs=names)
        here.step(5 * here.step_size)
        ours = np.array([here[each] for each in names])
        theirs = np.array([there[each] for each in names])
        assert ours.tobytes() == theirs.tobytes()


def test_a_service_needs_no_socket(phases):
    """What a message does is independent of how it came."""
    service, seat = Service(hl.Simulation(phases)), Seat("a test", trusted=True)
    assert service.answer({"id": 1, "do": "hello", "protocol": 1, "role": "master"}, seat)["ok"]
    answer = service.answer({"id": 2, "do": "step", "dt": 1.5, "outputs": ["load.position.z"]}, seat)
    assert answer["time"] == 1.5
    assert {"hoist", "hold"} == {event["phase"] for event in answer["events"]}
    assert service.answer({"id": 3, "do": "close"}, seat) == {"id": 3, "ok": True}
    assert service.over
