"""Inputs of a case that is advanced from Python: values and rates, logs and replays, states and copies."""

from __future__ import annotations

import io
import math

import numpy as np
import pytest

import heavylift as hl
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.log import Log

CASE = """
title = "A mass that is pushed"
bodies.cart = { type = "rigid", mass = 2, inertia = [1, 1, 1], frame = { motion = "free" } }
forces = [{ type = "point", name = "still", body = "cart", point = [0, 0, 0], force = [0, 0, 0] }]
simulate = { step = 0.01, output_interval = 0.05, duration = 4, integrator = "INTEGRATOR" }

[[inputs]]
type = "force"
name = "push"
body = "cart"
point = [0, 0, 0]
smallest = -100
largest = 100

[[inputs]]
type = "force"
name = "ramp"
body = "cart"
point = [0, 0, 0]
direction = [0, 1, 0]
interpolation = "linear"
"""


@pytest.fixture(params=["dele2", "accurate"])
def sim(request, tmp_path):
    text = CASE.replace("INTEGRATOR", request.param)
    if request.param == "accurate":
        text = text.replace("step = 0.01, output_interval = 0.05", "tolerance = 1e-9, output_interval = 0.05")
    (tmp_path / "case.toml").write_text(text)
    return hl.Simulation(tmp_path)


def test_held_and_linear_inputs_by_closed_forms(sim):
    """4 N for 1 s move 2 kg by 1 m; 0 to 6 N within 1 s move it by F t^2/6m = 0.5 m."""
    sim.step(1.0, {"push": 4.0, "ramp": 6.0})
    assert sim["cart.position"][:2] == pytest.approx([1.0, 0.5], rel=1e-4)
    assert (sim["push.value"], sim["ramp.value"]) == (4.0, 6.0)
    sim.step(1.0, {"push": (0.0, 2.0)})  # and a rate: v t + r t^3/6m; the ramp is held at its end
    assert sim["cart.position"][:2] == pytest.approx([1.0 + 2.0 + 1 / 6, 0.5 + 1.5 + 1.5], rel=1e-4)
    assert sim.inputs["push"].value == 2.0


def test_a_log_is_replayed_with_the_same_bits(sim, tmp_path):
    for k in range(8):
        sim.step(0.25, {"push": 10.0 * math.sin(k), "ramp": (0.0, 1.0) if k == 3 else 2.0 * k})
    sim.set("push", -3.0)
    sim.step(0.5)
    other = hl.Simulation(sim.case)
    other.replay(sim.input_log, until=sim.time)
    assert np.array_equal(other.row, sim.row)
    assert np.array_equal(other.results()["cart.velocity"], sim.results()["cart.velocity"])


def test_what_was_set_behind_a_state_is_forgotten_with_it(sim):
    sim.step(0.5, {"push": 1.0})
    sim.set("ramp", 0.0, rate=1.0, until=1.0)
    state = hl.State.from_bytes(sim.save().to_bytes())
    count = len(sim.input_log)
    sim.set("push", 7.0)
    sim.step(0.5)
    sim.restore(state)
    assert len(sim.input_log) == count
    assert sim.inputs["push"].value == 1.0
    sim.step(0.5)
    copy = sim.copy()
    other = hl.Simulation(sim.case)
    other.restore(state)
    other.step(0.5)
    assert np.array_equal(other.row, sim.row)
    for one in (sim, copy, other):
        one.step(0.5, {"push": 5.0})
    assert np.array_equal(copy.row, sim.row)
    assert np.array_equal(other.row, sim.row)


@pytest.mark.parametrize(
    ("inputs", "words"),
    [
        ({"push": math.nan}, "push"),
        ({"push": "much"}, "push"),
        ({"push": (1.0, 2.0, 3.0)}, "3 numbers; expected a value, or a value and its rate"),
        ({"ramp": 1.0, "push": 1e3}, "push"),
        ({"push": (90.0, 20.0)}, "push"),
        ({"pusch": 1.0}, "'pusch' is no input; expected one of: push"),
        ({"ramp": None}, "ramp"),
        ({3: 1.0}, "3 is no input"),
    ],
)
def test_settings_that_cannot_be_change_nothing(sim, inputs, words):
    sim.step(0.5, {"push": 1.0})
    before, log = sim.save().arrays, list(sim.input_log)
    with pytest.raises(hl.InputError) as error:
        sim.step(1.0, inputs)
    assert words in str(error.value)
    assert sim.input_log == log
    after = sim.save().arrays
    assert all(
        after[name].tobytes() == array.tobytes() for name, array in before.items() if name != "cpu_seconds"
    )


def test_nothing_is_set_behind_the_end(sim):
    sim.step(4.0)
    with pytest.raises(hl.InputError, match="the run has ended at t = 4 s; expected values before its end"):
        sim.set("push", 1.0)


def test_results_tell_what_drove_them(sim, tmp_path):
    """They are those of the case, and said to be driven; by force it is simulated without."""
    sim.step(2.0, {"push": 4.0})
    sim.step(2.0, {"push": 0.0})
    assert sim.write_results(tmp_path / "out").outcome is hl.Outcome.COMPLETED
    case = load_case(sim.case.folder)
    assert load_results(case, tmp_path / "out")["push.value"].max() == 4.0
    told = io.StringIO()
    assert run_case(case, out=tmp_path / "out", stages=("simulate",), log=Log(stream=told)).stages[0].skipped
    assert (
        "unchanged, skipped; its inputs were driven from outside, --force simulates it without"
        in told.getvalue()
    )
    assert load_results(case, tmp_path / "out")["push.value"].max() == 4.0
    run_case(case, out=tmp_path / "out", stages=("simulate",), force=("simulate",))
    assert load_results(case, tmp_path / "out")["push.value"].max() == 0.0


def test_a_state_takes_its_own_past_along(sim):
    """Of two ways from one state: who goes back to the end of the first one has its records and its log."""
    begin = sim.save()
    sim.step(1.0, {"push": 4.0})
    first, records = sim.save(), sim.results()["cart.position"]
    sim.restore(begin)
    sim.step(1.0, {"push": -4.0})
    for restored in (sim, sim.copy()):
        restored.restore(first)
        assert np.array_equal(restored.results()["cart.position"], records)
        assert [row.value for row in restored.input_log] == [4.0]
    sim.restore(begin)
    sim.restore(first)
    assert np.array_equal(sim.results()["cart.position"], records)


def test_records_behind_a_written_state_are_those_of_a_run_that_was_driven_alike(sim):
    sim.step(1.0, {"push": 4.0})
    written = hl.State.from_bytes(sim.save().to_bytes())
    alike, other = sim.copy(), hl.Simulation(sim.case)
    alike.step(1.0, {"push": 1.0})
    alike.restore(written)
    assert np.array_equal(alike.results()["cart.position"], sim.results()["cart.position"])
    other.step(2.0, {"push": -4.0})
    other.restore(written)
    results = other.results()
    assert results.time.tolist() == [1.0]
    assert results["cart.position"][-1].tolist() == sim["cart.position"].tolist()
    unknown = sim.copy()
    unknown.restore(hl.State(written.arrays, case=written.case))
    assert unknown.results().time.tolist() == [1.0]


def test_results_behind_a_foreign_state_are_not_those_of_the_case(sim, tmp_path):
    """What drove the first half is not in the log of the second one, and yet it has driven."""
    sim.step(2.0, {"push": 4.0})
    other = hl.Simulation(sim.case)
    other.restore(hl.State.from_bytes(sim.save().to_bytes()))
    other.step(2.0)
    assert other.input_log == []
    other.write_results(tmp_path / "out")
    case = load_case(sim.case.folder)
    assert not run_case(case, out=tmp_path / "out", stages=("simulate",)).stages[0].skipped
    assert load_results(case, tmp_path / "out")["push.value"].max() == 0.0


def test_a_part_of_a_run_replaces_the_results_of_another_one(sim, tmp_path):
    case = load_case(sim.case.folder)
    run_case(case, out=tmp_path / "out", stages=("simulate",))
    sim.step(1.0, {"push": 4.0})
    assert sim.write_results(tmp_path / "out").outcome is hl.Outcome.INTERRUPTED
    assert load_results(case, tmp_path / "out").time[-1] == 1.0


def test_numbers_of_numpy_are_numbers(sim):
    other = sim.copy()
    sim.step(1.0, {"push": 4.0, "ramp": 6.0})
    other.step(1.0, {"push": np.array(4.0), "ramp": np.array(6.0)})
    assert np.array_equal(other.row, sim.row)


def test_without_a_history_nothing_is_kept(sim):
    lean = hl.Simulation(sim.case, history=False)
    for one in (sim, lean):
        one.step(1.0, {"push": 4.0})
    assert np.array_equal(lean.row, sim.row)
    assert lean.input_log == []
    with pytest.raises(hl.InputError, match="there are no records; expected a simulation with 'history'"):
        lean.results()
    sim.restore(hl.State.from_bytes(lean.save().to_bytes()))  # and yet it knows what drove it
    assert len(sim.results().time) == 21


def test_a_state_of_other_inputs_is_refused(sim, tmp_path):
    """The same body and as many inputs, in another order: the push would become the ramp."""
    sim.step(0.5, {"push": 4.0})
    text = sim.case.file.read_text()
    head, first, second = text.split("[[inputs]]")
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "case.toml").write_text(f"{head}[[inputs]]{second}[[inputs]]{first}")
    other = hl.Simulation(tmp_path / "other")
    with pytest.raises(hl.InputError, match="the state does not fit this case"):
        other.restore(sim.save())
    assert other.inputs["ramp"].value == 0.0
