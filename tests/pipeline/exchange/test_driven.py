"""Inputs of a served case: the bits of a run in one process, values in describe, states, and what is refused."""

from __future__ import annotations

import math
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import heavylift as hl
from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, load_results
from tests.pipeline.exchange.conftest import Served

msgpack = pytest.importorskip("msgpack")

CASE = Path(__file__).parent / "driven"
NAMES = ["load.position.x", "load.position.z", "fall.tension", "hoisting.value", "gust.value"]


@pytest.fixture(scope="module")
def made():
    simulation = hl.Simulation(CASE)
    return simulation, simulation.save()


@pytest.fixture
def driven(made):
    simulation, start = made
    simulation.restore(start)
    return simulation


@pytest.fixture
def served(driven):
    server = Served(driven)
    yield server
    server.end()


def drive(sim, number: int) -> list[float]:
    """A part of a run that uses all ways to set inputs; outputs at its end."""
    if number == 2:
        sim.set("gust", 2e5, rate=1e4, until=3.0)
    inputs = {"hoisting": 0.02 * number}
    if number % 3 == 1:
        inputs["gust"] = (1e5 * number, -2e4)
    sim.step(0.1, inputs, outputs=NAMES)
    return [sim[name] for name in NAMES]


def test_a_driven_run_has_the_bits_of_one_process(served, driven):
    direct = driven.copy()
    with served.client() as remote:
        for number in range(8):
            assert drive(remote, number) == drive(direct, number)
            assert dict(remote.inputs) == dict(direct.inputs)
        assert remote.inputs["hoisting"].value == pytest.approx(0.14, abs=1e-12)
        assert remote.inputs["gust"].largest == 1e6
        assert remote.inputs["gust"].smallest == -math.inf
        state = remote.save()
        after = [drive(remote, 8), drive(remote, 9)]
        remote.restore(state)
        assert [drive(remote, 8), drive(remote, 9)] == after
        direct.restore(hl.State.from_bytes(state.to_bytes()))
        assert [drive(direct, 8), drive(direct, 9)] == after


def test_a_state_with_its_inputs_goes_on_in_another_process(driven, tmp_path):
    for number in range(5):
        drive(driven, number)
    with hl.open_child(CASE, out=tmp_path / "out") as there:
        there.restore(driven.save())
        assert there.inputs["hoisting"].value == driven.inputs["hoisting"].value
        for number in range(5, 10):
            assert drive(there, number) == drive(driven, number)
    results = load_results(load_case(CASE), tmp_path / "out")
    assert results["gust.value"][-1] == driven["gust.value"]


@pytest.mark.parametrize(
    ("inputs", "words"),
    [
        ({"wind": 1.0}, ("wind", "gust")),
        ({"gusts": 1.0}, ("gusts", "gust")),
        ({"gust": math.nan}, ("gust", "nan")),
        ({"gust": math.inf}, ("gust", "inf")),
        ({"gust": 2e6}, ("gust", "2000000")),
        ({"gust": (9e5, 1e7)}, ("gust",)),
        ({"hoisting": 0.3}, ("hoisting", "0.3")),
        ({"gust": (1.0, math.nan)}, ("gust", "nan")),
        ({"gust": 1e5, "hoisting": 0.3}, ("hoisting",)),
        ({"gust": "100 kN"}, ("step.inputs", "a number")),
        ({"gust": [1.0]}, ("step.inputs", "a number")),
        ({"gust": None}, ("step.inputs", "a number")),
    ],
)
def test_a_wrong_input_is_told_and_nothing_changes(served, driven, inputs, words):
    with served.client() as remote:
        remote.step(0.1, {"gust": 5e4})
        before = driven.save().arrays
        with pytest.raises(InputError) as caught:
            remote.step(0.1, inputs)
        for word in words:
            assert word in str(caught.value)
        after = driven.save().arrays
        assert all(
            before[name].tobytes() == after[name].tobytes() for name in before if name != "cpu_seconds"
        )
        remote.step(0.1)
        assert remote["gust.value"] == 5e4


def test_several_inputs_are_set_all_or_none(served, driven):
    wire = served.wire()
    wire.hello()
    assert wire.ask("set", inputs={"gust": 1e5, "hoisting": 0.0})["ok"]
    log = list(driven.input_log)
    answer = wire.ask("set", inputs={"gust": 3e5, "hoisting": [0.0, math.inf]})
    assert answer["error"]["kind"] == "input"
    assert driven.inputs["gust"].value == 1e5
    assert driven.input_log == log


def test_an_observer_sees_what_the_master_sets(served):
    with served.client() as master:
        observer = served.client("observer")
        for number in range(3):
            master.step(0.1, {"gust": 1e3 * number}, outputs=NAMES)
            assert observer.inputs["gust"].value == 1e3 * number == master.inputs["gust"].value
            assert observer.time == master.time
            assert observer.get(NAMES) == master.get(NAMES)
        master.step(served.simulation.duration - master.time)
        assert observer.outcome is hl.Outcome.COMPLETED
        assert observer.ended


def test_numbers_of_numpy_are_numbers(served):
    with served.client() as remote:
        remote.step(np.float32(0.25), {"gust": np.int64(5)}, outputs=("gust.value",))
        assert (remote.time, remote["gust.value"]) == (0.25, 5.0)
        remote.set("gust", np.array(7.0))
        remote.step()
        assert remote["gust.value"] == 7.0


def test_nothing_is_set_after_the_end(served, driven):
    with served.client() as remote:
        remote.step(driven.duration)
        assert remote.ended
        for call in (lambda: remote.set("gust", 1.0), lambda: remote.step(0.01, {"gust": 1.0})):
            with pytest.raises(InputError, match="ended"):
                call()


CLIENT = """
import sys
import heavylift as hl
sim = hl.connect(token_file=sys.argv[1], role=sys.argv[2])
if sys.argv[2] == "master":
    for number in range(20):
        sim.step(0.1, {"gust": 1e4 * number}, outputs=["load.position.x"])
    print(sim["load.position.x"].hex())
    sim.close(end=False)
else:
    print(sim.time, sim["gust.value"])
    sim.close()
"""


@pytest.mark.slow
def test_two_clients_in_two_processes(served, driven, tmp_path):
    direct = driven.copy()
    for number in range(20):
        direct.step(0.1, {"gust": 1e4 * number})
    file = tmp_path / "token"
    file.write_text(f"127.0.0.1 {served.port} a-word\n", encoding="utf-8")
    said = []
    for role in ("master", "observer"):
        command = [sys.executable, "-P", "-c", CLIENT, str(file), role]
        said.append(subprocess.run(command, capture_output=True, text=True, check=True).stdout.split())
    assert said[0] == [direct["load.position.x"].hex()]
    assert [float(word) for word in said[1]] == [direct.time, 1.9e5]


@pytest.mark.slow
def test_a_state_of_another_scene_is_refused(served, tmp_path):
    other = tmp_path / "other"
    shutil.copytree(CASE, other)
    text = (other / "case.toml").read_text(encoding="utf-8")
    head, _, tail = text.partition('[[inputs]]\nname = "gust"')
    (other / "case.toml").write_text(head + tail[tail.index("[simulate]") :], encoding="utf-8")
    with served.client() as remote, hl.open_child(other) as there, pytest.raises(InputError, match="state"):
        there.restore(remote.save())
