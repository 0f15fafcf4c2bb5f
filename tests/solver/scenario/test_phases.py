"""Phases against closed forms: when they end, what winches and ropes do then, how a run ends."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from law_scenes import G, body, eye, pulley, run, scene, slider, wire

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.numerics.records import records
from heavylift.solver.force_elements.equalized import SharedLines
from heavylift.solver.scenario.actions.connect import Connect
from heavylift.solver.scenario.actions.note import Note
from heavylift.solver.scenario.actions.release import Release
from heavylift.solver.scenario.actions.winch import WinchFollow, WinchLength, WinchSpeed
from heavylift.solver.scenario.moves import MOVE_ROWS, MoveRow, plan_move
from heavylift.solver.scene.connections import GROUND, Winch
from heavylift.solver.scene.scenario import Condition, Limit, Phase, Scenario, Track, loose_ropes
from heavylift.solver.scene.signals import Signal, Term
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from heavylift.solver.scene.scene import Scene

MASS, EA, REACH = 1e4, 1e8, 10.0
HEIGHT = Signal((Term("load.position", "z"),))
TENSION = Signal((Term("rope.tension"),))
STRETCH = MASS * G / EA * REACH
"""Of the rope with an unstretched length of `REACH`, at rest."""


def never() -> tuple[Condition, ...]:
    return (Condition(HEIGHT, 1e6),)


def falling(*phases: Phase) -> Scene:
    """A load without ropes, dropped from the origin."""
    return replace(scene([body("load", MASS, (0, 0, 0))]), scenario=Scenario(phases))


def hanging(*phases: Phase, prepared: tuple[str, ...] = (), stops: bool = False, **rope: Any) -> Scene:
    """A load at rest on a rope."""
    spec = {"length": REACH, "stiffness": EA} | rope
    ropes = [wire(eye(GROUND), eye("load"), **spec)]
    load = body("load", MASS, (0, 0, -REACH - STRETCH))
    return replace(scene([load], ropes=ropes), scenario=Scenario(phases, prepared, stops))


def ends(simulation: Simulation) -> list[float]:
    return [line.time for line in simulation.operation.log if line.event == "done"]


@pytest.mark.parametrize("step", [0.08, 0.04, 0.02, 0.01])
def test_time_of_a_trigger(step: float) -> None:
    """A chord misses a parabola by g h^2 / 8 at most, so the time by that over the speed; it is always too early."""
    heights = -np.linspace(1.0, 6.0, 11)
    found = []
    for z in heights:
        simulation = run(
            falling(Phase("fall", until=(Condition(HEIGHT, z, below=True),))), step, 1.28
        ).simulation
        found += ends(simulation)
    times = np.sqrt(-2.0 * heights / G)
    early = times - found
    bound = G * step**2 / 8.0 / (G * (times - step))
    assert np.all(early > -1e-12)
    assert np.all(early < bound)
    assert early.max() > 0.25 * bound.min()  # it is that bound that is met, not a smaller order


def test_the_steps_stay_of_second_order() -> None:
    """A load is hoisted, stopped by its height and dropped: where it is after that."""

    def height(step: float) -> float:
        hoist = Phase("hoist", (WinchSpeed("rope", 0.5, 1.0),), (Condition(HEIGHT, -8.03),))
        stop = Phase("stop", (WinchSpeed("rope", 0.0, 1.0),), (Condition(None, 2.0),))
        operation = hanging(hoist, stop, Phase("drop", (Release("rope"),)), stiffness=1e6, damping=1e5)
        return float(run(operation, step, 8.0)["load.position"][-1, 2])

    exact = height(6.25e-5 * 5)
    errors = [abs(height(step) - exact) for step in (0.02, 0.01, 0.005, 0.0025)]
    assert errors[0] < 1e-6
    assert all(b < a / 3.0 for a, b in pairwise(errors))  # by four, but for where events fall in their steps


@pytest.mark.parametrize("step", [0.03, 0.01])
def test_release_is_followed_by_a_free_fall(step: float) -> None:
    """The time is met exactly, the energy of the rope is lost, and nothing else."""
    operation = hanging(Phase("hang", until=(Condition(None, 1.0),)), Phase("fall", (Release("rope"),)))
    found = run(operation, step, 1.5)
    t = np.maximum(0.0, found.times - 1.0)
    np.testing.assert_allclose(
        found["load.position"][:, 2], -REACH - STRETCH - 0.5 * G * t**2, rtol=0, atol=1e-9
    )
    np.testing.assert_allclose(found["load.velocity"][:, 2], -G * t, rtol=0, atol=1e-8)
    lost = 0.5 * MASS * G * STRETCH
    assert found["energy.dissipated"][-1] == pytest.approx(lost, rel=1e-9)
    assert found.balance < 1e-12 * found["energy.kinetic"].max()
    assert found.simulation.operation.log[-1].value == pytest.approx(lost, rel=1e-9)
    assert np.all(found["rope.tension"][found.times > 1.0] == 0.0)
    assert found["energy.elastic"][-1] == 0.0


def test_connecting_changes_no_velocity() -> None:
    """A falling load gets a rope with slack: it falls on as before until the slack is used up."""
    slack, at = 0.5, -2.0
    catch = Phase("catch", (Connect("rope", slack),))
    operation = hanging(Phase("fall", until=(Condition(HEIGHT, at, below=True),)), catch, prepared=("rope",))
    operation = replace(
        operation,
        bodies=(body("load", MASS, (0, 0, -1.0)),),
        ropes=(wire(eye(GROUND), eye("load"), stiffness=EA),),
    )
    found = run(operation, 0.01, 0.55)
    line = found.simulation.operation.log[-1]
    assert line.value == pytest.approx(-at + slack, abs=1e-4)
    free = found.times < math.sqrt(2.0 * (-at + slack - 1.0) / G) - 0.011
    assert np.count_nonzero(free) > 45
    np.testing.assert_allclose(found["load.velocity"][free, 2], -G * found.times[free], rtol=0, atol=1e-11)
    taut = found["rope.tension"] > 0.0
    assert not np.any(taut & free)
    assert found["rope.rest_length"][-1] == line.value
    assert found.balance < 1e-12 * found["energy.kinetic"].max()


def test_a_rope_connected_too_short_by_less_than_two_percent_is_tight() -> None:
    """Its energy comes from its winch; beyond 2 % it is refused by an end of the run."""

    def connected(slack: float) -> Simulation:
        operation = hanging(
            Phase("wait", until=(Condition(None, 0.1),)),
            Phase("tight", (Connect("tag", slack),)),
        )
        tag = wire(eye(GROUND, (0, 0, -30.0)), eye("load"), name="tag", stiffness=1e5)
        assert operation.scenario is not None
        operation = replace(
            operation, ropes=(*operation.ropes, tag), scenario=replace(operation.scenario, prepared=("tag",))
        )
        simulation = Simulation(operation, 0.01)
        simulation.record()
        simulation.advance(20)
        return simulation

    path = 30.0 - REACH - STRETCH
    simulation = connected(-0.01 * path)
    row, column = simulation.record(), {c.name: c.column for c in simulation.channels}
    assert simulation.outcome is Outcome.COMPLETED
    assert row[column["tag.rest_length"]] == pytest.approx(0.99 * path, rel=1e-9)
    assert row[column["energy.drive_work"]] == pytest.approx(
        0.5 * 1e5 * (0.01 * path) ** 2 / (0.99 * path), rel=1e-6
    )
    simulation = connected(-0.03 * path)
    assert simulation.outcome is Outcome.LIMIT_REACHED
    assert "connection of 'tag'" in simulation.message


@pytest.mark.parametrize("length", [7.0, 9.9, 12.0])
@pytest.mark.parametrize("ramp", [0.0, 1.0, 4.0])
def test_a_length_is_met_exactly(length: float, ramp: float) -> None:
    """And at the time of the trapezoid, or of the triangle where the way is short."""
    most = 0.5
    operation = hanging(Phase("go", (WinchLength("rope", length, most, ramp),)), damping=1e5)
    found = run(operation, 0.01, 12.0)
    assert found["rope.rest_length"][-1] == pytest.approx(length, rel=1e-15)
    way = abs(length - REACH)
    takes = way / most + ramp if way >= most * ramp else 2.0 * math.sqrt(way * ramp / most)
    moving = np.abs(found["rope.rest_length"] - length) > 1e-12
    assert found.times[moving][-1] == pytest.approx(takes, abs=0.0101)
    assert np.abs(np.diff(found["rope.rest_length"])).max() < most * 0.01 * (1.0 + 1e-9)


@pytest.mark.parametrize("jerk", [0.0, 0.05, 3.0])
@pytest.mark.parametrize("seed", range(50))
def test_plan_of_a_move(seed: int, jerk: float) -> None:
    """It begins as it was, ends at rest at its target, is never too fast or too quick, and its rows fit each other."""
    rng = np.random.default_rng(seed)
    value, target = rng.uniform(-5.0, 5.0, 2)
    most, ramp = rng.uniform(0.1, 1.0), rng.uniform(0.2, 5.0)
    speed, quick = rng.uniform(-1.5, 1.5) * most, most / ramp
    present = rng.uniform(-1.0, 1.0) * quick if jerk else 0.0
    rows = records(MoveRow, MOVE_ROWS)
    count = plan_move(value, speed, present, target, most, quick, jerk, rows)
    rows = rows[:count]
    first, last = rows[0], rows[-1]
    assert (first.time, first.value, first.speed) == (0.0, value, speed)
    assert (last.speed, last.acceleration, last.value) == (0.0, 0.0, target)
    h = np.diff(rows["time"])
    assert np.all(h >= 0.0)
    x, v, a, j = (rows[name][:-1] for name in ("value", "speed", "acceleration", "jerk"))
    np.testing.assert_allclose(x + h * (v + h * (a / 2 + h * j / 6)), rows["value"][1:], rtol=0, atol=1e-10)
    np.testing.assert_allclose(v + h * (a + h * j / 2), rows["speed"][1:], rtol=0, atol=1e-10)
    settled = (
        0.5 * present**2 / jerk if jerk else 0.0
    )  # by what the present acceleration still changes the speed
    assert np.abs(rows["speed"]).max() <= max(most, abs(speed) + settled) * (1.0 + 1e-9)
    assert np.abs(a).max() <= max(quick, abs(present)) * (1.0 + 1e-9)
    assert np.abs(j).max(initial=0.0) <= jerk * (1.0 + 1e-9)
    if jerk:
        assert first.acceleration == present
        np.testing.assert_allclose(a + h * j, rows["acceleration"][1:], rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("way", "takes"),
    [(10.0, 10.0 / 0.5 + 0.5 / 0.25 + 0.25 / 0.5), (1e-3, 4.0 * (1e-3 / 0.5 / 2.0) ** (1 / 3))],
)
def test_a_move_with_a_limited_jerk_takes_the_time_of_the_closed_form(way: float, takes: float) -> None:
    """Three ramps and a stretch between; and one so short that neither acceleration nor speed is reached."""
    rows = records(MoveRow, MOVE_ROWS)
    count = plan_move(0.0, 0.0, 0.0, way, 0.5, 0.25, 0.5, rows)
    assert rows["time"][count - 1] == pytest.approx(takes, rel=1e-12)


def test_a_condition_has_to_hold() -> None:
    """A load that bounces on its rope: its tension is above twice the weight for a part of each period only."""
    soft = 2e5  # EA; static stretch 4.905 m
    stretch = MASS * G / soft * REACH
    w = math.sqrt(soft / REACH / MASS)
    load = body("load", MASS, (0, 0, -REACH))
    ropes = (wire(eye(GROUND), eye("load"), stiffness=soft, length=REACH),)

    def ended(hold: float) -> list[float]:
        waiting = Phase("wait", until=(Condition(TENSION, 1.5 * MASS * G, hold=hold),))
        operation = replace(hanging(waiting), bodies=(load,), ropes=ropes)
        return ends(run(operation, 0.005, 10.0).simulation)

    # T = W (1 - cos wt) is above 1.5 W from 2 pi/3 to 4 pi/3
    first, lasts = 2.0 * math.pi / 3.0 / w, 2.0 * math.pi / 3.0 / w
    assert stretch == pytest.approx(4.905)
    assert ended(0.0) == pytest.approx([first], abs=1e-4)
    assert ended(0.9 * lasts) == pytest.approx([first + 0.9 * lasts], abs=1e-4)
    assert ended(1.1 * lasts) == []


def test_all_and_any() -> None:
    fast, far = Condition(HEIGHT, -1.0, below=True), Condition(None, 1.0)
    for which, time in (("all", 1.0), ("any", math.sqrt(2.0 / G))):
        operation = falling(Phase("fall", until=(fast, far), ends_with=which))  # type: ignore[arg-type]
        assert ends(run(operation, 0.01, 1.2).simulation) == pytest.approx([time], abs=1e-4)


def test_sums_and_norms() -> None:
    speed = Signal((Term("load.velocity"),), "norm")
    weighted = Signal((Term("load.position", "z", -2.0), Term("load.position", "x", 3.0)))
    slope = falling(
        Phase("a", until=(Condition(speed, 5.0),)), Phase("b", until=(Condition(weighted, 10.0),))
    )
    slope = replace(slope, bodies=(body("load", MASS, (0, 0, 0), (3.0, 0, 0)),))
    t = ends(run(slope, 0.001, 1.0).simulation)
    first = 4.0 / G  # 3, 4, 5
    second = (-9.0 + math.sqrt(81.0 + 40.0 * G)) / (2.0 * G)  # g t^2 + 9 t = 10
    assert t == pytest.approx([first, second], abs=1e-5)


def test_limits_stop_and_warn() -> None:
    high = Limit(HEIGHT, -2.0, below=False)
    warned = falling(Phase("fall", limits=(replace(high, stop=False),)))
    found = run(warned, 0.01, 1.0)
    assert [line.event for line in found.simulation.operation.log] == ["begins", "limit passed"]
    simulation = Simulation(falling(Phase("fall", limits=(high,))), 0.01)
    times, _ = simulation.advance(100)
    at = math.sqrt(4.0 / G)
    assert simulation.outcome is Outcome.LIMIT_REACHED
    assert simulation.time == pytest.approx(at, abs=0.0101)
    assert simulation.time > at
    assert times[-1] == simulation.time  # what is kept goes to where it ended
    assert "load.position.z above -2 is -2.0" in simulation.message
    assert simulation.advance(10)[0].size == 0


def test_timeout_and_what_is_left() -> None:
    simulation = Simulation(falling(Phase("fall", until=never(), timeout=0.5)), 0.01)
    simulation.advance(100)
    assert simulation.outcome is Outcome.TIMED_OUT
    assert simulation.time == 0.5
    assert "'fall'" in simulation.message
    left = run(falling(Phase("fall", until=never()), Phase("last")), 0.01, 0.5).simulation
    assert "phase 'fall', number 1 of 2" in left.operation.unfinished
    assert run(falling(Phase("last")), 0.01, 0.5).simulation.operation.unfinished == ""


def test_the_run_may_end_with_its_scenario() -> None:
    operation = hanging(Phase("wait", until=(Condition(None, 0.355),)), stops=True)
    simulation = Simulation(operation, 0.01)
    simulation.advance(50)
    assert (simulation.outcome, simulation.ended) == (Outcome.COMPLETED, True)
    assert simulation.time == pytest.approx(0.36)
    assert simulation.operation.unfinished == ""


def test_a_run_that_ends_goes_on_to_its_next_record() -> None:
    """Also in pieces that end in between, and from a checkpoint there."""
    operation = hanging(Phase("wait", until=(Condition(None, 0.355),)), stops=True)
    simulation = Simulation(operation, 0.01, record_every=10)
    simulation.advance(37)
    assert not simulation.ended
    again = Simulation(operation, 0.01, record_every=10)
    again.restore(simulation.state())
    assert not again.ended
    for one in (simulation, again):
        times, _ = one.advance(63)
        assert one.ended
        assert times.tolist() == pytest.approx([0.4])
        assert one.time == pytest.approx(0.4)
    last = Simulation(operation, 0.01, record_every=10)
    last.restore(simulation.state())
    assert last.ended


def test_a_rope_is_never_hauled_in_whole() -> None:
    operation = hanging(Phase("haul", (WinchSpeed("rope", 4.0, 1.0),)), damping=1e6)
    simulation = Simulation(operation, 0.01)
    simulation.advance(500)
    assert simulation.outcome is Outcome.LIMIT_REACHED
    assert "winch of 'rope'" in simulation.message
    row, column = simulation.record(), {c.name: c.column for c in simulation.channels}
    assert 0.0 < row[column["rope.rest_length"]] < 0.1


def operation_of_all_sorts() -> Scene:
    phases = (
        Phase("hoist", (Note("go"), WinchSpeed("rope", 0.5, 0.5)), (Condition(HEIGHT, -9.333),)),
        Phase("lower", (WinchLength("rope", 9.5, 0.4, 0.3),), (Condition(None, 1.234),)),
        Phase("drop", (Release("rope"),), (Condition(None, 0.1),)),
        Phase("catch", (Connect("rope", 0.05),), limits=(Limit(HEIGHT, 0.0, stop=False),)),
    )
    return hanging(*phases, damping=1e5)


@pytest.mark.parametrize("cut", [120, 230, 333, 345])
def test_restart_is_the_same_bit_for_bit(cut: int) -> None:
    """Through changes of the phase, in the middle of a ramp, behind a release."""
    whole = Simulation(operation_of_all_sorts(), 0.01)
    whole.record()
    _, records = whole.advance(400)
    first = Simulation(operation_of_all_sorts(), 0.01)
    first.record()
    _, head = first.advance(cut)
    kept = first.state()
    first.advance(3)
    second = Simulation(operation_of_all_sorts(), 0.01)
    second.restore(kept)
    _, tail = second.advance(400 - cut)
    np.testing.assert_array_equal(np.vstack([head, tail]), records)
    assert second.operation.log == whole.operation.log
    assert [line.event for line in whole.operation.log].count("done") == 3
    pieces = Simulation(operation_of_all_sorts(), 0.01, record_every=5)
    for _ in range(40):
        pieces.advance(10)
    assert pieces.operation.log == whole.operation.log
    # extremes are those of another interval
    alike = [c.column for c in whole.channels if c.name not in {"rope.tension_max", "rope.tension_min"}]
    np.testing.assert_array_equal(pieces.record()[alike], whole.record()[alike])


def test_who_only_watches_changes_nothing() -> None:
    """Bit for bit: a winch by a table, with a scenario that waits for ever and without one."""
    winch = Winch(np.array([0.0, 1.0, 4.0, 5.0]), np.array([0.0, 0.5, 0.5, 0.0]))
    load = body("load", MASS, (0.3, 0, -REACH))
    plain = scene([load], ropes=[wire(eye(GROUND), eye("load"), damping=1e4, winch=winch)])
    watched = replace(plain, scenario=Scenario((Phase("wait", until=never()),)))
    a, b = run(plain, 0.01, 6.0), run(watched, 0.01, 6.0)
    assert a.simulation.operation is None
    for name in a.columns:
        np.testing.assert_array_equal(a[name], b[name])
    assert a.simulation.solver_steps == b.simulation.solver_steps


def test_ropes_of_both_kinds() -> None:
    """One over a sheave that rubs, one without: each is told for itself, and the energy is booked."""
    over = replace(pulley("load", (0, 0, 0), 0.5, -1.0), efficiency=0.95)
    rubbing = wire(
        eye(GROUND, (-0.5, 0, 0)), over, eye(GROUND, (0.5, 0, 0)), name="fall", stiffness=1e7, damping=1e4
    )
    plain = wire(eye(GROUND, (0, 0, -12.0)), eye("load"), name="tag", stiffness=1e5)
    phases = (
        Phase(
            "haul",
            (WinchLength("fall", 20.0, 0.5, 1.0), WinchSpeed("tag", -0.3, 0.5)),
            (Condition(None, 6.0),),
        ),
        Phase("part", (Release("fall"), WinchSpeed("tag", 0.0)), (Condition(None, 0.2),)),
        Phase("again", (Connect("fall", 0.05), Release("tag")), (Condition(None, 1.0),)),
    )
    load = body("load", MASS, (0, 0, -REACH))
    operation = replace(scene([load], ropes=[rubbing, plain]), scenario=Scenario(phases))
    found = run(operation, 0.005, 8.0)
    at = {
        name: found.times > time
        for name, time in zip(("haul", "part", "again"), ends(found.simulation), strict=True)
    }
    hauled = ~at["haul"] & (found.times > 5.0)
    np.testing.assert_allclose(found["fall.rest_length"][hauled], 20.0, rtol=1e-15)
    lost = found.times[at["haul"] & ~at["part"]]
    assert np.all(found["fall.tension"][at["haul"] & ~at["part"]] == 0.0)
    assert len(lost) > 30
    assert found["tag.rest_length"][-1] == pytest.approx(2.0 + 0.3 * (6.0 - 0.25), rel=1e-12)
    assert np.all(found["tag.tension"][at["part"]] == 0.0)
    assert found["fall.tension"][-1] > 0.0
    assert found.balance < 1e-11 * found["energy.kinetic"].max()


def test_an_adaptive_step_ends_at_events_too() -> None:
    operation = hanging(Phase("hang", until=(Condition(None, 0.777),)), Phase("fall", (Release("rope"),)))
    found = run(operation, 0.1, 1.5, tolerance=1e-6)
    t = max(0.0, 1.5 - 0.777)
    assert ends(found.simulation) == pytest.approx([0.777], abs=1e-9)
    assert found["load.position"][-1, 2] == pytest.approx(-REACH - STRETCH - 0.5 * G * t**2, abs=1e-8)


def test_on_a_slider() -> None:
    """A block on a slider is let go at a time: it slides down."""
    block = body("block", 100.0, (0, 0, 0))
    rope = wire(eye(GROUND, (-5.0, 0, 0)), eye("block"), stiffness=1e7)
    incline = slider((math.cos(0.5), 0.0, -math.sin(0.5)))
    phases = (Phase("held", until=(Condition(None, 0.505),)), Phase("slides", (Release("rope"),)))
    operation = replace(scene([block], joints=[incline], ropes=[rope]), scenario=Scenario(phases))
    found = run(operation, 0.01, 1.0, start="equilibrium")
    t = 1.0 - 0.505
    travel = found["slide.travel"]
    assert travel[-1] - travel[0] == pytest.approx(0.5 * G * math.sin(0.5) * t**2, rel=1e-6)


@pytest.mark.parametrize(
    ("phases", "prepared", "words"),
    [
        ((Phase("a", (Release("rop"),)),), (), "'rop' is no rope; did you mean 'rope'"),
        ((Phase("a"), Phase("b")), (), "phase 'a' can never end"),
        ((Phase("a", until=never()), Phase("a")), (), "is the name of two phases"),
        ((Phase("a", (Connect("rope"),)),), (), "'rope' is connected then"),
        ((Phase("a", (Release("rope"),)),), ("rope",), "'rope' is not connected then"),
        ((Phase("a", until=(Condition(HEIGHT, -20.0),)),), (), "is over before it begins: load.position.z above -20"),
        ((Phase("a", until=(Condition(Signal((Term("load.positon", "z"),)), 0.0),)),), (), "are: load.position"),
        ((Phase("a", until=(Condition(Signal((Term("load.position", "w"),)), 0.0),)),), (), "has no component 'w'"),
        ((Phase("a", until=(Condition(Signal((Term("load.position"),)), 0.0),)),), (), "has 3 components"),
        ((Phase("a", (Connect("rope", -1.0),)),), ("rope",), "longer than"),
        ((), (), "no phases"),
    ],
)  # fmt: skip
def test_refused(phases: tuple[Phase, ...], prepared: tuple[str, ...], words: str) -> None:
    with pytest.raises(InputError) as error:
        Simulation(hanging(*phases, prepared=prepared), 0.01).record()
    assert words in str(error.value)


def test_ropes_whose_winch_answers_to_its_tension_beside_others() -> None:
    tense = Winch(np.array([0.0]), tensions=np.array([1e4]), speed=0.5)
    operation = hanging(Phase("go", (WinchLength("rope", 9.0, 0.5, 1.0),)), damping=1e5)
    tag = wire(eye(GROUND, (0, 0, -30.0)), eye("load"), name="tag", stiffness=1e6, winch=tense, damping=1e4)
    found = run(replace(operation, ropes=(tag, *operation.ropes)), 0.01, 6.0)
    assert found["rope.rest_length"][-1] == pytest.approx(9.0, rel=1e-15)
    assert found["tag.tension"][-1] == pytest.approx(1e4, rel=0.2)
    assert found.simulation.operation.log[-1].what == "winch of 'rope' to 9 m at 0.5 m/s"


def test_which_ropes_hang_loose() -> None:
    phases = (Phase("a", (Connect("x"),)), Phase("b", (Release("y"), Note("."))), Phase("c", (Release("x"),)))
    operation = Scenario(phases, prepared=("x",))
    assert [loose_ropes(operation, [n]) for n in range(5)] == [{"x"}, set(), {"y"}, {"x", "y"}, {"x", "y"}]
    beside = replace(operation, tracks=(Track("t", (Phase("d"), Phase("e", (Release("z"),)))),))
    assert [loose_ropes(beside, [1, n]) for n in range(4)] == [set(), set(), {"z"}, {"z"}]


def test_other_integrators_have_no_scenarios() -> None:
    for name in ("accurate", "thesis"):
        with pytest.raises(InputError, match="scenario"):
            Simulation(falling(Phase("a")), 0.01, name)
    assert Simulation(falling(Phase("a")), 0.01, "auto").integrator == "dele2"


def beside(*phases: Phase, others: tuple[str, ...] = (), efficiency: float = 1.0) -> Scene:
    """A load on a rope over a sheave, and ropes of other kinds that hold another one, named before and behind it."""
    sheave = replace(pulley(GROUND, (0.0, 0.0, 0.0), 0.3), efficiency=efficiency)
    path = (eye(GROUND, (-3.0, 0.0, -1.0)), sheave, eye("load"))
    hauled = replace(wire(*path, stiffness=EA, damping=1e4), name="rope")
    spots = [(x, 0.0, z) for x in (-0.5, 0.5) for z in (0.0, -REACH)]
    held = [eye(("other", GROUND)[z == 0.0], (x, y, z if z == 0.0 else 0.0)) for x, y, z in spots]
    made = {
        "equalized": SharedLines(
            name="equalized",
            path=tuple(held),
            lengths=np.full(2, REACH - 1.0),
            depth=1.0,
            up=0.9,
            down=2.0,
            axial_stiffness=EA,
            rope_length=5.0,
            line_stiffness=EA,
        ),
        "rubbing": replace(
            wire(
                eye(GROUND, (2.0, 0.0, 0.0)),
                replace(eye(GROUND, (5.0, 0.0, 0.0)), efficiency=0.9),
                eye("other"),
            ),
            name="rubbing",
        ),
    }
    loads = [body("load", MASS, (0.3, 0.0, -REACH)), body("other", MASS, (0.0, 0.0, -REACH))]
    ropes = [made[name] for name in others] + [hauled]
    return replace(scene(loads, ropes=ropes), scenario=Scenario(phases))


@pytest.mark.parametrize("others", [("equalized",), ("rubbing",), ("equalized", "rubbing")])
def test_a_winch_is_told_beside_ropes_of_other_kinds(others: tuple[str, ...]) -> None:
    """The load goes as it does alone: the right rope is hauled in, whatever else holds other loads."""
    phases = (
        Phase("hoist", (WinchSpeed("rope", 0.2, 0.5),), (Condition(None, 2.0),)),
        Phase("drop", (Release("rope"),), (Condition(None, 0.2),)),
        Phase("catch", (Connect("rope", 0.1),), (Condition(None, 1.0),)),
        Phase("stop", (WinchLength("rope", 12.0, 0.2, 0.5),)),
    )
    alone, found = (run(beside(*phases, others=names), 2e-3, 5.0) for names in ((), others))
    np.testing.assert_allclose(found["load.position"], alone["load.position"], atol=1e-9)
    np.testing.assert_allclose(found["rope.rest_length"], alone["rope.rest_length"], atol=1e-9)
    assert np.ptp(found["rope.rest_length"]) > 0.3


def test_a_winch_of_a_rope_over_sheaves_with_an_efficiency_is_told() -> None:
    """A part of the tension is lost on the way up, as where the winch has a table of its own."""
    winch = Winch(np.array([0.5, 1.5]), np.array([0.0, 0.2]))
    phases = (
        Phase("wait", (), (Condition(None, 0.5),)),
        Phase("hoist", (WinchSpeed("rope", 0.2, 1.0),)),
    )
    told = beside(*phases, efficiency=0.95)
    tabled = replace(told, scenario=None, ropes=(replace(told.ropes[0], winch=winch),))
    found, expected = (run(one, 2e-3, 3.0) for one in (told, tabled))
    np.testing.assert_allclose(found["load.position"], expected["load.position"], atol=1e-9)
    parts = found["rope.segment_tension"][-1]
    assert parts[1] / parts[0] == pytest.approx(0.95, rel=1e-6)


@pytest.mark.parametrize("action", [WinchSpeed("rope", 0.2), WinchFollow("rubbing", "rope")])
def test_a_rope_with_two_winches_is_not_told(action: Any) -> None:
    told = beside(Phase("hoist", (action,)), others=("rubbing",))
    still = Winch(np.array([0.0]), np.array([0.0]))
    ropes = tuple(
        replace(rope, winch=still, other_winch=still) if rope.name == "rope" else rope for rope in told.ropes
    )
    with pytest.raises(InputError, match="'rope' has two winches"):
        Simulation(replace(told, ropes=ropes), 1e-3)


def test_equalized_lines_have_no_winch() -> None:
    with pytest.raises(
        InputError, match=r"phases.0.actions.0.winch.*'equalized' is a rope of type 'equalized'"
    ):
        Simulation(beside(Phase("hoist", (WinchSpeed("equalized", 0.2),)), others=("equalized",)), 1e-3)
