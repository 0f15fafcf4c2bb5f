"""Inputs of a case that is advanced from Python: values and rates, logs and replays, states and copies."""

from __future__ import annotations

import math

import numpy as np
import pytest

import heavylift as hl
from heavylift.pipeline import load_case, load_results, run_case

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
    state = sim.save()
    count = len(sim.input_log)
    sim.set("push", 7.0)
    sim.step(0.5)
    sim.restore(state)
    assert len(sim.input_log) == count
    assert sim.inputs["push"].value == 1.0
    sim.step(0.5)
    copy = sim.copy()
    other = hl.Simulation(sim.case)
    other.restore(hl.State.from_bytes(state.to_bytes()))
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
    """They are not taken for those of a run that nothing drives."""
    sim.step(2.0, {"push": 4.0})
    sim.step(2.0, {"push": 0.0})
    assert sim.write_results(tmp_path / "out").outcome is hl.Outcome.COMPLETED
    case = load_case(sim.case.folder)
    assert load_results(case, tmp_path / "out")["push.value"].max() == 4.0
    assert not run_case(case, out=tmp_path / "out", stages=("simulate",)).stages[0].skipped
    assert load_results(case, tmp_path / "out")["push.value"].max() == 0.0


def test_histories_are_those_of_what_led_to_the_state(sim):
    """Also of a state on a branch that was left, and of one that comes from elsewhere."""
    sim.step(0.5, {"push": 1.0})
    fork = sim.save()
    sim.step(0.5, {"push": 2.0})
    left, row = sim.save(), sim.row.copy()
    sim.restore(fork)
    sim.step(1.0, {"push": -3.0})
    assert sim.results()["push.value"][-1] == -3.0
    sim.restore(left)
    assert np.array_equal(sim.row, row)
    results = sim.results()
    assert results.time == pytest.approx(np.arange(21) * 0.05)
    assert [change.value for change in sim.input_log] == [1.0, 2.0]
    held = np.where(
        results.time < 0.5 - 1e-9, 1.0, 2.0
    )  # the record at 0.5 s was made before it was set again
    assert results["push.value"][1:11] == pytest.approx(1.0)
    assert results["push.value"][11:] == pytest.approx(held[11:])
    sim.restore(hl.State.from_bytes(left.to_bytes()))
    sim.step(0.5)
    assert sim.results().time == pytest.approx(1.0 + np.arange(11) * 0.05)
    assert sim.input_log == []


def test_results_that_begin_elsewhere_are_none_of_the_whole_run(sim, tmp_path):
    """Nothing was set, but what came before is not here: simulate makes the run anew."""
    there = hl.Simulation(sim.case)
    there.step(2.0)
    sim.restore(hl.State.from_bytes(there.save().to_bytes()))
    sim.step(2.0)
    report = sim.write_results(tmp_path / "out")
    assert report.outcome is hl.Outcome.COMPLETED
    kept = load_results(load_case(tmp_path), tmp_path / "out")
    assert (kept.time[0], kept.time[-1]) == pytest.approx((2.0, 4.0))
    again = run_case(load_case(tmp_path), out=tmp_path / "out", stages=("simulate",))
    assert not again.stages[-1].skipped
    assert load_results(load_case(tmp_path), tmp_path / "out").time[0] == 0.0
