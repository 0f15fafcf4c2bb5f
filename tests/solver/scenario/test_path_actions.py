"""A transporter that stops, waits and goes on along its path as phases tell it, against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from vehicles import groups_of, scene, vehicle

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.assemble.operation_plan import plan, routes_of, starts_of
from heavylift.solver.scenario.actions.path import PathGoOn, PathSpeed
from heavylift.solver.scene.scenario import Condition, Phase, Scenario
from heavylift.solver.scene.scene import Scene
from heavylift.solver.scene.signals import Signal, Term
from heavylift.solver.scene.transport import Drive, PathLeg
from heavylift.solver.simulation import Simulation

AHEAD = PathLeg(points=np.array([[10.0, 0.0]]), speed=0.5, acceleration=0.05)
TURN = PathLeg(steering="carousel", turn=0.5, speed=0.2, acceleration=0.05, pause=3.0)
PLACE = Signal((Term("block.position", "x"),))
ARRIVED = Condition(Signal((Term("spmt"),), "arrived"), 0.0)


def operation(*phases: Phase, **more) -> Scene:
    """A vehicle whose path is straight for 10 m, and turns then."""
    given = {"wheel_radius": 0.37, "line_damping": 2e4, "tyre_damping": 1.5e5, "legs": (AHEAD, TURN)}
    return scene(vehicle(**(given | more)), scenario=Scenario(phases, stops_at_end=True))


def after(time: float) -> tuple[Condition, ...]:
    return (Condition(None, time),)


WAITS = (
    Phase("wait", (PathSpeed("spmt", 0.0),), after(5.0)),
    Phase("go", (PathSpeed("spmt", 0.4, ramp=4.0),), (Condition(PLACE, 3.0),)),
    Phase("pause", (PathSpeed("spmt", 0.0, acceleration=0.1),), after(10.0)),
    Phase("on", (PathGoOn("spmt"),), (ARRIVED,)),
)


def expected(t):
    """Way and speed: 0.1 m/s2 to 0.4 m/s, 3 m at 14.5 s, at rest 0.8 m on, at 24.5 s on as planned, 6.2 m in 22.4 s."""
    times = [0.0, 5.0, 9.0, 14.5, 18.5, 24.5, 34.5, 36.9, 46.9, 49.9, 53.9]
    accelerations = [0.0, 0.1, 0.0, -0.1, 0.0, 0.05, 0.0, -0.05, 0.0, 0.05, 0.0]
    reach = 0.5 * np.hypot(3.5, 0.725)
    times.append(53.9 + (reach - 0.8) / 0.2)
    accelerations.append(-0.05)
    way = speed = 0.0
    for i, begin in enumerate(times):
        d = min(t, times[i + 1] if i + 1 < len(times) else begin + 4.0) - begin
        if d <= 0.0:
            break
        way, speed = way + d * (speed + 0.5 * d * accelerations[i]), speed + d * accelerations[i]
    return way, speed


def histories(made: Scene, step: float, duration: float, every: int = 1):
    run = Simulation(made, step=step, integrator="dele2", record_every=every)
    times, records = run.advance(round(duration / step))
    return run, times, {c.name: records[:, c.column : c.column + len(c.components)] for c in run.channels}


def test_a_leg_waits_pauses_and_goes_on_without_a_jump_of_its_speed() -> None:
    """Way by closed forms, held until a place is reached; the next leg begins its own pause later."""
    run, times, found = histories(operation(*WAITS), 1e-2, 80.0, 10)
    assert run.outcome is Outcome.COMPLETED
    ways = np.array([expected(t) for t in times])
    np.testing.assert_allclose(found["spmt.path_way"][:, 0], ways[:, 0], atol=2e-6)
    np.testing.assert_allclose(found["spmt.off_path"], 0.0, atol=1e-6)
    straight = times < 46.0
    np.testing.assert_allclose(
        found["spmt.rolling_speed"][straight], ways[straight, 1:] + np.zeros(12), atol=1e-6
    )
    assert times[-1] == pytest.approx(57.9 + (0.5 * np.hypot(3.5, 0.725) - 0.8) / 0.2, abs=0.11)
    log = [(line.phase, line.event, line.time) for line in run.operation.log if line.event == "done"]
    assert [line[0] for line in log] == ["wait", "go", "pause", "on"]
    assert [line[2] for line in log[:3]] == pytest.approx([5.0, 14.5, 24.5], abs=1e-6)
    parts = [found[f"energy.{name}"] for name in ("kinetic", "potential", "elastic", "dissipated")]
    total = np.sum(parts, axis=0) - found["energy.drive_work"]
    assert np.ptp(total) < 1e-5 * np.ptp(found["energy.kinetic"])


def test_a_speed_leads_to_the_end_of_the_leg_and_no_further() -> None:
    """The next leg waits until it is told; what would not stop before the end brakes harder."""
    run, times, found = histories(
        operation(
            Phase("go", (PathSpeed("spmt", 1.0, ramp=5.0),), (Condition(PLACE, 9.0),)),
            Phase("stop", (PathSpeed("spmt", 0.0, acceleration=1e-3),), (ARRIVED,)),
            Phase("rest", (), after(5.0)),
            Phase("turn", (PathSpeed("spmt", 0.1),), (ARRIVED,)),
        ),
        1e-2,
        60.0,
        10,
    )
    assert run.outcome is Outcome.COMPLETED
    way, speed = found["spmt.path_way"][:, 0], found["spmt.rolling_speed"][:, 0]
    done = {line.phase: line.time for line in run.operation.log if line.event == "done"}
    # 5 s to 1 m/s over 2.5 m; braked from 7.5 m on at 0.2, what is left there is 1 m at sqrt(0.4) m/s
    peak = np.sqrt(0.4)
    assert done["go"] == pytest.approx(5.0 + 5.0 + (1.0 - peak) / 0.2, abs=1e-5)
    assert done["stop"] == pytest.approx(done["go"] + peak / 0.2, abs=1e-5)
    resting = (times > done["stop"] + 0.1) & (times < done["rest"] - 0.1)
    np.testing.assert_allclose(way[resting], 10.0, atol=1e-9)
    np.testing.assert_allclose(speed[resting], 0.0, atol=1e-9)
    assert np.abs(np.diff(speed)).max() < 0.2 * 0.1 + 1e-6
    assert way[-1] == pytest.approx(10.0 + 0.5 * np.hypot(3.5, 0.725), abs=1e-9)


def test_a_run_that_was_cut_off_goes_on_bit_for_bit() -> None:
    """A checkpoint holds the pieces of the path."""
    whole = Simulation(operation(*WAITS), step=2e-2, record_every=50)
    _, records = whole.advance(2000)
    first = Simulation(operation(*WAITS), step=2e-2, record_every=50)
    first.advance(1000)
    second = Simulation(operation(*WAITS), step=2e-2, record_every=50)
    second.restore(first.state())
    _, rest = second.advance(1000)
    np.testing.assert_array_equal(rest, records[-len(rest) :])


def test_the_plan_before_the_run_has_times_and_ways() -> None:
    """What waits for a place is open; a timeout bounds it. After an arrival all is known."""
    known = (
        Phase("wait", (PathSpeed("spmt", 0.0),), after(5.0)),
        Phase("go", (PathSpeed("spmt", 0.4, ramp=4.0),), after(9.5)),
        *WAITS[2:],
    )
    for phases, ways in (
        (known, [(0.0, 0.0), (3.0, 3.0), (3.8, 3.8), (10.0 + 0.5 * np.hypot(3.5, 0.725),) * 2]),
        (
            WAITS,
            [
                (0.0, 0.0),
                (0.0, 10.0),
                (0.0, 10.0 + 0.5 * np.hypot(3.5, 0.725)),
                (10.0 + 0.5 * np.hypot(3.5, 0.725),) * 2,
            ],
        ),
    ):
        made = operation(*phases)
        run = Simulation(made, step=1e-2)
        (row,) = plan(made.scenario, starts_of(made, run.operation), routes_of(made, run.operation))
        assert [(one.values["spmt"].low, one.values["spmt"].high) for one in row] == [
            pytest.approx(w) for w in ways
        ]
    assert row[1].takes.low == 0.0
    (row,) = plan(operation(*known).scenario, {"spmt": 0.0}, routes_of(made, run.operation))
    assert sum(one.takes.low for one in row) == pytest.approx(57.9 + (0.5 * np.hypot(3.5, 0.725) - 0.8) / 0.2)


@pytest.mark.parametrize(
    ("phase", "more", "words"),
    [
        (Phase("a", (PathSpeed("spnt", 0.1),)), {}, "'spnt' is no transporter with 'legs'; did you mean 'spmt'"),
        (Phase("a", (PathGoOn("spmt"),)), {"legs": (), "groups": groups_of(4)}, "'spmt' is no transporter with 'legs'"),
        (
            Phase("a", (PathSpeed("spmt", 0.6),)),
            {"drive": Drive(friction=0.5, speeds=np.array([0.0, 0.7]), forces=np.array([1e5, 1e5]))},
            "0.6 m/s, and the drives of 'spmt' are planned for 0.5 m/s",
        ),
        (Phase("a", (), (ARRIVED,)), {}, "'spmt' has not been told to go anywhere"),
    ],
)  # fmt: skip
def test_what_cannot_be_told_is_refused(phase, more, words) -> None:
    """With what was expected."""
    with pytest.raises(InputError, match=words):
        Simulation(operation(replace(phase, until=phase.until or after(1.0)), **more), step=1e-2)
