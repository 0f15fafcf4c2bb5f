"""A case that is advanced from Python: the bits of the run of its stage, states, copies, events, what is refused."""

from __future__ import annotations

import doctest
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import heavylift as hl
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.stepping import simulation as module
from heavylift.pipeline.stepping import state as state_module

ROOT = Path(__file__).parents[3]
HOIST = ROOT / "cases" / "hoist"


@pytest.fixture(scope="module")
def sim():
    return hl.Simulation(HOIST)


@pytest.fixture(autouse=True)
def at_start(request):
    if "sim" in request.fixturenames:
        made = request.getfixturevalue("sim")
        start = START.get("start") or made.save()
        START.update(start=start)
        made.restore(start)


START: dict = {}


@pytest.mark.parametrize("steps", [1, 7])
def test_steps_have_the_bits_of_a_run(sim, tmp_path, steps):
    """Records do not depend on how the time is cut."""
    case = load_case(HOIST)
    run_case(case, out=tmp_path, stages=("simulate",))
    whole = load_results(case, tmp_path)
    while sim.time < 2.0 - 1e-9:
        sim.step(steps * sim.step_size)
    results = sim.results()
    count = len(results.time)
    assert count == 11
    for name in whole.names:
        if name != "energy.balance":
            assert np.array_equal(results[name], whole[name][:count]), name
    assert results.unit("fall.tension") == "N"


def test_to_look_at_a_run_leaves_no_trace():
    """A record after each step, that the run has not: of vehicles and barges it rounds what steps begin with."""
    watched = hl.Simulation(ROOT / "cases" / "load_out_level")
    alone = watched.copy()
    for _ in range(400):
        watched.step()
    alone.step(400 * alone.step_size)
    found, expected = (one.save().arrays for one in (watched, alone))
    for name, array in expected.items():
        assert name == "cpu_seconds" or found[name].tobytes() == array.tobytes(), name
    restored = watched.copy()
    restored.restore(hl.State(found, case=watched.save().case))
    for name, array in restored.save().arrays.items():
        assert name == "cpu_seconds" or array.tobytes() == found[name].tobytes(), name


def test_a_state_goes_on_in_another_process(sim, tmp_path):
    sim.step(0.5)
    (tmp_path / "state").write_bytes(sim.save().to_bytes())
    sim.step(0.5)
    code = (
        "import sys, heavylift as hl; sim = hl.Simulation(sys.argv[1]);"
        "sim.restore(hl.State.from_bytes(open(sys.argv[2], 'rb').read())); sim.step(0.5);"
        "sys.stdout.buffer.write(sim.row.tobytes())"
    )
    told = subprocess.run(
        [sys.executable, "-c", code, HOIST, tmp_path / "state"], capture_output=True, check=True
    )
    assert np.array_equal(np.frombuffer(told.stdout), sim.row)


def test_a_copy_goes_its_own_way(sim):
    sim.step(0.3)
    other = sim.copy()
    other.step(0.7)
    assert (sim.time, other.time) == pytest.approx((0.3, 1.0))
    sim.step(0.7)
    assert np.array_equal(sim.row, other.row)
    assert np.array_equal(sim.results()["fall.tension"], other.results()["fall.tension"])


def test_a_restored_state_takes_its_history_back(sim):
    sim.step(0.6)
    state, count = sim.save(), len(sim.results().time)
    sim.step(1.0)
    later = sim.row.copy()
    sim.restore(state)
    assert len(sim.results().time) == count
    assert sim.results().time[-1] == pytest.approx(0.6)
    sim.step(1.0)
    assert np.array_equal(sim.row, later)


def test_records_are_not_changed_by_who_reads_them(sim):
    sim.step(0.4)
    results = sim.results()
    names = ("load.position", "fall.tension", "sum(fall.tension, fall.tension)")
    for array in (sim.row, *(results[name] for name in names)):
        with pytest.raises(ValueError, match="read-only"):
            np.multiply(array, 2.0, out=array)


def test_outputs_by_name(sim):
    info = sim.outputs["load.position.z"]
    assert (info.name, info.unit) == ("load.position.z", "m")
    assert info.sentence
    position = sim["load.position"]
    assert position[2] == sim["load.position.z"] == sim.row[sim.columns(["load.position.z"])][0]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (
            lambda sim: sim.step(0.0123),
            "dt: 0.0123 s is no multiple of 0.01 s; expected a whole number of steps",
        ),
        (lambda sim: sim.step(float("nan")), "dt: nan s is no multiple"),
        (lambda sim: sim.step(-0.01), "dt: -0.01 s is no multiple"),
        (lambda sim: sim.step("x"), "dt: 'x' s is no multiple"),
        (lambda sim: sim.step("0.1"), "dt: '0.1' s is no multiple"),
        (lambda sim: sim.step(1e4), "the run ends at 20 s; expected a shorter time, or a longer 'duration'"),
        (
            lambda sim: sim["load.positon.z"],
            "no output 'load.positon.z'; expected one of 'outputs'; the nearest",
        ),
        (lambda sim: sim[3], "there is no output 3"),
        (lambda sim: sim.columns(["load.position"]), "has 3 components; expected one of: load.position.x"),
        (lambda sim: sim.on_event(print), "has no scenario; expected the table"),
        (lambda _: hl.State.from_bytes(b"PK"), "2 bytes that are no state"),
        (lambda _: hl.Simulation(3), "case: int 3; expected the folder of a case"),
        (
            lambda _: hl.Simulation(load_case(HOIST), overrides=("simulate.duration=1",)),
            "expected the folder",
        ),
        (
            lambda _: hl.Simulation(ROOT / "cases" / "nafems"),
            "has no time to simulate; expected the table",
        ),
        (lambda sim: sim.restore(hl.State({})), "checkpoint: "),
    ],
)
def test_what_cannot_be_is_refused(sim, call, words):
    before = sim.save()
    with pytest.raises(hl.InputError) as error:
        call(sim)
    assert words in str(error.value)
    after = sim.save().arrays
    assert all(
        after[name].tobytes() == array.tobytes()
        for name, array in before.arrays.items()
        if name != "cpu_seconds"
    )


def test_a_damaged_state_is_none(sim):
    data = bytearray(sim.save().to_bytes())
    data[len(data) // 2] ^= 0xFF
    with pytest.raises(hl.InputError, match="no state"):
        hl.State.from_bytes(bytes(data))


def test_time_ends_with_the_case():
    sim = hl.Simulation(ROOT / "cases" / "tugger")
    assert not sim.ended
    sim.step(1.8)
    assert sim.ended
    assert (sim.outcome, sim.message) == (hl.Outcome.COMPLETED, "")
    with pytest.raises(hl.InputError, match="the run has ended"):
        sim.step()


SPINNING = """
title = "A wheel that turns too far in a step"
bodies.wheel = { type = "rigid", mass = 1, inertia = [1, 1, 1], frame = { motion = "free" } }
forces = [{ type = "point", name = "push", body = "wheel", point = [0, 1, 0], force = [-1, 0, 0], frame = "body" }]
simulate = { step = 0.5, output_interval = 0.5, duration = 50, integrator = "dele2" }
"""


def test_a_run_that_stops_keeps_what_it_has(tmp_path):
    """The torque of 1 N m turns the wheel by more than a step may turn it from some time on: ``w h = t h``."""
    (tmp_path / "case.toml").write_text(SPINNING)
    sim = hl.Simulation(tmp_path)
    with pytest.raises(hl.SimulationStopped) as stopped:
        sim.step(sim.duration)
    assert stopped.value.outcome is sim.outcome is not hl.Outcome.COMPLETED
    assert sim.ended
    assert sim.message
    assert sim.results().time[-1] == pytest.approx(sim.time)


def test_events_are_told_after_the_step_that_brought_them():
    sim, told = hl.Simulation(ROOT / "cases" / "staged_lift"), []
    sim.on_event(lambda line: told.append((line.time, sim.time)))
    for _ in range(400):
        sim.step(10 * sim.step_size)
    assert told
    assert all(now - 10 * sim.step_size - 1e-9 <= at <= now + 1e-9 for at, now in told)


def test_results_are_written_as_by_the_stage(tmp_path):
    """A whole run is taken for that of the stage, a part is continued by it."""
    sim, case = hl.Simulation(ROOT / "cases" / "tugger"), load_case(ROOT / "cases" / "tugger")
    sim.step(0.5)
    assert sim.write_results(tmp_path / "part").outcome is hl.Outcome.INTERRUPTED
    sim.step(1.3)
    assert sim.write_results(tmp_path / "whole").outcome is hl.Outcome.COMPLETED
    stages = [
        run_case(case, out=tmp_path / name, stages=("simulate",)).stages[0] for name in ("part", "whole")
    ]
    assert [stage.skipped for stage in stages] == [False, True]
    part, whole = (load_results(case, tmp_path / name) for name in ("part", "whole"))
    for name in whole.names:
        assert np.array_equal(part[name], whole[name]), name
        assert np.array_equal(sim.results()[name], whole[name]), name


@pytest.mark.parametrize(
    "change", ["simulate.step=5 ms", "bodies.load.mass=900 t", "gravity.acceleration.2=-9.7"]
)
def test_a_state_of_another_case_is_refused(sim, change):
    """Time is a count of steps; forces and gravity are no part of a state."""
    sim.step(1.0)
    other = hl.Simulation(HOIST, overrides=(change,))
    before = other.save().arrays
    with pytest.raises(hl.InputError, match="a state of the same case"):
        other.restore(sim.save())
    assert all(other.save().arrays[name].tobytes() == array.tobytes() for name, array in before.items())


def test_a_state_goes_on_in_a_longer_case():
    """Only the duration may differ."""
    tugger = ROOT / "cases" / "tugger"
    short, longer = hl.Simulation(tugger), hl.Simulation(tugger, overrides=("simulate.duration=5",))
    short.step(1.8)
    longer.restore(hl.State.from_bytes(short.save().to_bytes()))
    longer.step(0.1)
    assert longer.time == pytest.approx(1.9)


@pytest.mark.parametrize("one", [module, state_module])
def test_examples(one, monkeypatch):
    monkeypatch.chdir(ROOT)
    found = doctest.testmod(one)
    assert found.attempted
    assert not found.failed


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_what_is_closed_has_no_processes_and_keeps_its_results():
    pytest.importorskip("fmpy")
    with hl.Simulation(ROOT / "cases" / "tagline_controller") as sim:
        (process,) = sim._solver.processes.values()
        sim.step(0.5)
        assert process._process.poll() is None
    assert process._process.poll() is not None
    assert len(sim.results().time) == 6
    with pytest.raises(hl.SimulationStopped, match=r"FMU 'controller' .*: its process has ended"):
        sim.step(0.5)
    with hl.Simulation(HOIST) as other:  # nothing to end
        other.step(0.1)
