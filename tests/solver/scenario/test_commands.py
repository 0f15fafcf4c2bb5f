"""What a phase tells to winches, drives and tanks, against closed forms; tracks; what is said from outside."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from law_scenes import G, body, eye, run, scene, slider, wire
from point_masses import System, make_cloud
from scenarios import start_of

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver import return_point, scene_checks
from heavylift.solver.forces.point import PointForce
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scenario.actions.connect import Connect
from heavylift.solver.scenario.actions.drive import DriveSpeed, DriveTo
from heavylift.solver.scenario.actions.release import Release
from heavylift.solver.scenario.actions.tank import TankRate
from heavylift.solver.scenario.actions.winch import (
    WinchBrake,
    WinchFollow,
    WinchHaul,
    WinchLength,
    WinchLevel,
    WinchSpeed,
    WinchTension,
)
from heavylift.solver.scene.actions import Action
from heavylift.solver.scene.ballast import Pump
from heavylift.solver.scene.bodies import Driven, Fixed, Harmonic, Profile
from heavylift.solver.scene.connections import GROUND, JointFrame, Winch, axes_about
from heavylift.solver.scene.scenario import Condition, Phase, Scenario, Track
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, LinearRestoring, Sea, Tank, Water
from heavylift.solver.scene.signals import Signal, Term
from heavylift.solver.simulation import Simulation

MASS, EA, REACH = 1e4, 1e8, 10.0
HEIGHT = Signal((Term("load.position", "z"),))
STANDING = Profile(times=np.zeros(1), speeds=np.zeros(1))


def after(time: float) -> tuple[Condition, ...]:
    return (Condition(None, time),)


def told(*actions: Action) -> tuple[Phase, ...]:
    return (Phase("go", actions),)


def arrived(*names: str) -> Condition:
    return Condition(Signal(tuple(map(Term, names)), "arrived"), 0.0)


def ends(simulation: Simulation) -> list[tuple[str, float]]:
    return [(line.phase, line.time) for line in simulation.operation.log if line.event == "done"]


def trapezoid(t: Any, way: float, most: float, ramp: float) -> Any:
    """Way of a move from rest to rest that reaches its speed."""
    whole = way / most + ramp
    t = np.clip(t, 0.0, whole)
    up, down = np.minimum(t, ramp), np.maximum(0.0, t - (whole - ramp))
    return most * (0.5 * up**2 / ramp + (t - up) - 0.5 * down**2 / ramp)


# winches


def hanging(*phases: Phase, ropes: Any = (), **more: Any) -> Scene:
    """A load at rest on a rope, and others."""
    given = {"stiffness": EA, "tension": MASS * G, "damping": 1e5} | more
    first = wire(eye(GROUND), eye("load"), **given)
    load = body("load", MASS, (0, 0, -REACH))
    return replace(scene([load], ropes=[first, *ropes]), scenario=Scenario(phases))


def slack_rope(name: str, **more: Any) -> Any:
    return wire(eye(GROUND, (0, 1.0, 0)), eye("load"), name=name, length=REACH + 5.0, **more)


def test_a_winch_hauls_a_length_with_a_limited_jerk() -> None:
    """From its present length; at rest after the time of the closed form, which a condition meets exactly."""
    haul = WinchHaul("rope", 2.0, 0.4, acceleration=0.2, jerk=0.4)
    phases = (Phase("haul", (haul,), (arrived("rope"),)), Phase("rest"))
    found = run(hanging(*phases), 0.01, 10.0)
    rest = found["rope.rest_length"]
    assert rest[0] - rest[-1] == pytest.approx(2.0, abs=1e-14)
    takes = 2.0 / 0.4 + 0.4 / 0.2 + 0.2 / 0.4
    assert ends(found.simulation) == [("haul", pytest.approx(takes, abs=1e-9))]
    t = found.times
    first = t <= 0.5
    np.testing.assert_allclose(rest[0] - rest[first], 0.4 * t[first] ** 3 / 6.0, rtol=0, atol=1e-14)


def test_a_load_is_hoisted_to_a_height() -> None:
    """By what it is below that when the phase begins: on a stiff rope it arrives there but for the stretch."""
    up = WinchHaul("rope", -8.5, 0.3, 1.0, HEIGHT)
    phases = (Phase("wait", until=after(0.37)), Phase("up", (up,), (arrived("rope"),)), Phase("rest"))
    found = run(hanging(*phases), 0.01, 15.0)
    stretched = MASS * G / EA
    assert found["load.position"][-1, 2] == pytest.approx(-8.5, abs=2.0 * stretched * 1.5)
    assert found["rope.rest_length"][0] - found["rope.rest_length"][-1] == pytest.approx(1.5, rel=1e-6)
    assert ends(found.simulation)[1][1] == pytest.approx(0.37 + 1.5 / 0.3 + 1.0, abs=1e-6)


def test_a_winch_follows_whatever_the_leader_is_told() -> None:
    """By length and with a ratio, from the phase on in which it is told so, until it is told something itself."""
    phases = (
        Phase("alone", (WinchSpeed("rope", 0.2, 0.5),), after(2.0)),
        Phase("both", (WinchSpeed("rope", 0.0), WinchFollow("other", "rope", -0.5)), after(1.0)),
        Phase("move", (WinchLength("rope", 9.0, 0.3, 0.7),), after(4.0)),
        Phase("apart", (WinchSpeed("other", 0.1), WinchSpeed("rope", -0.1)), after(1.0)),
    )
    found = run(hanging(*phases, ropes=[slack_rope("other")]), 0.01, 8.0)
    lead, other, t = found["rope.rest_length"], found["other.rest_length"], found.times
    assert np.all(other[t <= 2.0] == REACH + 5.0)
    together = (t >= 2.0) & (t <= 7.0)
    np.testing.assert_allclose(
        other[together] - (REACH + 5.0), -0.5 * (lead[together] - lead[200]), rtol=0, atol=1e-12
    )
    assert lead[700] == pytest.approx(9.0, rel=1e-15)
    assert other[-1] - other[700] == pytest.approx(-0.1, abs=1e-12)
    assert lead[-1] - lead[700] == pytest.approx(0.1, abs=1e-12)


def test_winches_that_follow_from_the_start_do_what_their_leader_is_told() -> None:
    table = Winch(np.array([0.0, 1.0]), np.array([0.0, 0.1]))
    other = slack_rope("other", winch=Winch(follow="rope", ratio=2.0))
    phases = (Phase("table", until=after(1.5)), Phase("stop", (WinchSpeed("rope", 0.0, 1.0),)))
    found = run(hanging(*phases, ropes=[other], winch=table), 0.01, 4.0)
    lead, follower = (found[f"{name}.rest_length"] for name in ("rope", "other"))
    np.testing.assert_allclose(follower - follower[0], 2.0 * (lead - lead[0]), rtol=0, atol=1e-12)
    assert lead[0] - lead[-1] == pytest.approx(0.05 + 0.05 + 0.05, rel=1e-9)


def test_a_winch_keeps_a_tension_from_a_phase_on() -> None:
    """A second rope takes a part of the load, within its dead band, and gives it back when it is told to pay out."""
    brake = Winch(brake=1e6)
    part = 0.3 * MASS * G
    phases = (
        Phase("wait", until=after(1.0)),
        Phase("keep", (WinchTension("tag", part, 0.2, 0.02),), after(40.0)),
        Phase("out", (WinchSpeed("tag", -0.2),)),
    )
    tag = wire(eye(GROUND, (0, 0, 20.0)), eye("load"), name="tag", length=30.5, damping=1e5, winch=brake)
    found = run(hanging(*phases, ropes=[tag]), 0.01, 60.0)
    t, tension = found.times, found["tag.tension"]
    assert np.all(tension[t <= 1.0] == 0.0)
    kept = (t > 35.0) & (t < 41.0)
    assert np.abs(tension[kept] / part - 1.0).max() < 0.0201
    np.testing.assert_allclose(found["rope.tension"][kept] + tension[kept], MASS * G, rtol=1e-3)
    assert np.abs(found["tag.paying_speed"]).max() <= 0.2 * (1.0 + 1e-12)
    assert tension[-1] == 0.0
    assert np.diff(found["tag.rest_length"][t > 42.0]).max() == pytest.approx(0.002, rel=1e-9)
    assert found.balance < 1e-9 * MASS * G * REACH


def four_ropes(*phases: Phase, wrong: float = 0.01) -> Scene:
    """A load on four ropes of which one is too short: it hangs on a diagonal."""
    corners = [(x, y) for x in (-3.0, 3.0) for y in (-2.0, 2.0)]
    lengths = [REACH - wrong, REACH, REACH, REACH - wrong]
    ropes = [
        wire(
            eye(GROUND, (x, y, 0)),
            eye("load", (x, y, 0)),
            name=f"rope_{i}",
            stiffness=EA,
            length=length,
            damping=1e5,
            winch=Winch(brake=1e6),
        )
        for i, ((x, y), length) in enumerate(zip(corners, lengths, strict=True))
    ]
    load = RigidBody("load", MASS, np.diag([4e4, 8e4, 1e5]), position=np.array([0.0, 0.0, -REACH]))
    return replace(scene([load], ropes=ropes), scenario=Scenario(phases))


def test_winches_level_a_load() -> None:
    """Four ropes share a load equally within the dead band, at rest and while they hoist in step; alone they do not."""
    names = [f"rope_{i}" for i in range(4)]
    level = tuple(WinchLevel(name, 1.0, 0.05, 0.01, 1) for name in names)
    hoist = tuple(WinchSpeed(name, 0.2, 2.0) for name in names)
    phases = (
        Phase("rest", until=after(5.0)),
        Phase("level", level, after(15.0)),
        Phase("hoist", hoist, after(10.0)),
        Phase("hold", tuple(WinchSpeed(name, 0.0, 2.0) for name in names), after(15.0)),
        Phase("alone", tuple(WinchLevel(name, 0.0) for name in names)),
    )
    found = run(four_ropes(*phases), 0.01, 46.0)
    t = found.times
    shares = np.array([found[f"{name}.tension"] for name in names]) / (MASS * G)
    assert np.abs(shares[:, t < 5.0][:, -1] - 0.25).max() > 0.2  # two slack ropes of four
    for begin, end in ((15.0, 20.0), (26.0, 30.0), (40.0, 45.0)):
        kept = (t > begin) & (t < end)
        assert np.abs(shares[:, kept] / shares[:, kept].sum(axis=0) - 0.25).max() < 0.25 * 0.0105
    assert found["load.position"][-1, 2] - found["load.position"][500, 2] == pytest.approx(2.0, abs=0.02)
    assert np.ptp([found[f"{name}.rest_length"][-1] for name in names]) < 1e-4  # as long as each other again
    assert found.balance < 1e-9 * MASS * G * REACH


def test_winches_that_level_follow_on() -> None:
    """What follows goes on as its leader is told, in step, while all keep equal loads."""
    names = [f"rope_{i}" for i in range(4)]
    others = tuple(WinchFollow(name, names[0]) for name in names[1:])
    level = tuple(WinchLevel(name, 1.0, 0.05, 0.01, 1) for name in names)
    phases = (
        Phase("level", others + level, after(2.0)),
        Phase("hoist", (WinchHaul(names[0], 0.5, 0.2, 1.0),)),
    )
    found = run(four_ropes(*phases, wrong=0.0), 0.01, 8.0)
    hauled = [found[f"{name}.rest_length"][0] - found[f"{name}.rest_length"][-1] for name in names]
    np.testing.assert_allclose(hauled, 0.5, rtol=0, atol=1e-3)


def test_shares_may_be_unequal() -> None:
    """Two ropes side by side, the first with twice the share of the other."""
    held = Winch(brake=1e6)
    ropes = [
        wire(eye(GROUND), eye("load"), name=name, stiffness=EA, damping=1e5, winch=held) for name in "ab"
    ]
    levels = (WinchLevel("a", 2.0, 0.05, 0.0, 1), WinchLevel("b", 1.0, 0.05, 0.0, 1))
    made = scene([body("load", MASS, (0, 0, -REACH))], ropes=ropes)
    found = run(replace(made, scenario=Scenario(told(*levels))), 0.01, 10.0)
    last = {name: found[f"{name}.tension"][-1] for name in "ab"}
    assert last["a"] / last["b"] == pytest.approx(2.0, rel=1e-3)
    assert last["a"] + last["b"] == pytest.approx(MASS * G, rel=1e-3)


def test_a_brake_is_set_and_let_off() -> None:
    """A drum whose brake is set rests; then it does what it is told again."""
    phases = (
        Phase("up", (WinchSpeed("rope", 0.2, 1.0),), after(2.0)),
        Phase("stop", (WinchSpeed("rope", 0.0, 1.0),), (arrived("rope"),)),
        Phase("set", (WinchBrake("rope", on=True),), after(1.0)),
        Phase("off", (WinchBrake("rope", on=False), WinchSpeed("rope", -0.2, 1.0)), after(1.0)),
    )
    found = run(hanging(*phases, winch=Winch(brake=2.0 * MASS * G)), 0.01, 5.0)
    rest, t = found["rope.rest_length"], found.times
    assert np.ptp(rest[(t >= 3.0) & (t <= 4.0)]) < 1e-14
    assert rest[-1] - rest[400] == pytest.approx(0.1, rel=1e-9)


def test_what_a_winch_that_answers_to_its_tension_does_goes_on_bit_for_bit() -> None:
    phases = (
        Phase("level", tuple(WinchLevel(f"rope_{i}", 1.0, 0.05, 0.01, 1) for i in range(4)), after(2.02)),
        Phase("keep", (WinchTension("rope_0", 2e4, 0.1),), after(1.1)),
        Phase("drop", (Release("rope_3"),), after(0.2)),
        Phase("catch", (Connect("rope_3", 0.0), WinchSpeed("rope_0", 0.1, 0.4))),
    )
    made = four_ropes(*phases)
    whole = Simulation(made, 0.01)
    whole.record()
    _, records = whole.advance(400)
    for cut in (150, 230, 320, 390):
        first = Simulation(made, 0.01)
        first.record()
        first.advance(cut)
        second = Simulation(made, 0.01)
        second.restore(first.state())
        _, tail = second.advance(400 - cut)
        np.testing.assert_array_equal(tail, records[cut:])
        assert second.operation.log == whole.operation.log


# drives


def sliding(*phases: Phase, drive: Profile = STANDING) -> Scene:
    block = body("block", 100.0, (0, 0, 0))
    return replace(scene([block], joints=[slider(drive=drive)]), scenario=Scenario(phases))


@pytest.mark.parametrize("step", [0.02, 0.03])
def test_a_slider_is_driven_to_a_place(step: float) -> None:
    """By the trapezoid from the time on at which the phase begins, and back by a distance."""
    phases = (
        Phase("wait", until=after(0.777)),
        Phase("there", (DriveTo("slide", 3.0, 0.8, 1.5),), (arrived("slide"),)),
        Phase("back", (DriveTo("slide", -1.0, 0.5, 0.5, by=True),), (arrived("slide"),)),
        Phase("rest"),
    )
    found = run(sliding(*phases), step, 12.0)
    t = found.times
    there = 3.0 / 0.8 + 1.5
    expected = trapezoid(t - 0.777, 3.0, 0.8, 1.5) - trapezoid(t - 0.777 - there, 1.0, 0.5, 0.5)
    np.testing.assert_allclose(found["slide.travel"], expected, rtol=0, atol=2e-9)
    np.testing.assert_allclose(found["block.position"][:, 0], expected, rtol=0, atol=2e-9)
    assert ends(found.simulation) == [
        ("wait", pytest.approx(0.777, abs=1e-9)),
        ("there", pytest.approx(0.777 + there, abs=1e-9)),
        ("back", pytest.approx(0.777 + there + 2.5, abs=1e-9)),
    ]
    assert found.balance < 2.0 * step**2 * found["energy.kinetic"].max()  # accelerations jump within steps


def test_a_table_is_left_where_it_is_then() -> None:
    """A drive that follows a table is stopped in the middle of it, with its speed, and goes on at another one."""
    table = Profile(times=np.array([0.0, 1.0, 9.0]), speeds=np.array([0.0, 0.5, 0.5]))
    phases = (Phase("table", until=after(3.0)), Phase("faster", (DriveSpeed("slide", 0.9, 2.0),)))
    found = run(sliding(*phases, drive=table), 0.01, 6.0)
    t = np.clip(found.times - 3.0, 0.0, None)
    gone = 0.5 * np.minimum(found.times, 1.0) ** 2 * 0.5 + 0.5 * np.clip(found.times - 1.0, 0.0, 2.0)
    on = np.where(t < 2.0, 0.5 * t + 0.1 * t**2, 0.5 * t + 0.4 + 0.4 * (t - 2.0))
    np.testing.assert_allclose(found["slide.travel"], gone + on, rtol=0, atol=1e-9)


def test_a_hinge_is_driven_round() -> None:
    axes = axes_about(np.array([0.0, 1.0, 0.0]))
    hinge = Hinge(
        name="mast",
        body_a=GROUND,
        body_b="arm",
        frame_a=JointFrame(np.zeros(3), axes),
        frame_b=JointFrame(np.zeros(3), axes),
        drive=STANDING,
    )
    arm = body("arm", 100.0, (0, 0, 0))
    phases = told(DriveSpeed("mast", 1.2, acceleration=0.4))
    found = run(replace(scene([arm], joints=[hinge]), scenario=Scenario(phases)), 0.01, 8.0)
    t = found.times
    expected = np.where(t < 3.0, 0.2 * t**2, 1.8 + 1.2 * (t - 3.0))
    np.testing.assert_allclose(found["mast.angle"], expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("motion", [Fixed(), Driven(y=STANDING)])
def test_swing_behind_a_trolley(motion: Any) -> None:
    """A load of length l behind a ramp t with the acceleration a swings with ``2 (a/g) l |sin(w t/2)|``."""
    length, ramp, speed = 20.0, 4.0, 0.2
    w = math.sqrt(G / length)
    trolley = body("trolley", 1e3, (0, 0, 0), motion=motion)
    load = body("load", MASS, (0, 0, -length))
    rope = wire(eye("trolley"), eye("load"), tension=MASS * G, stiffness=1e10)
    phases = (Phase("wait", until=after(1.0)), Phase("go", (DriveSpeed("trolley.x", speed, ramp),)))
    found = run(replace(scene([trolley, load], ropes=[rope]), scenario=Scenario(phases)), 0.01, 40.0)
    t = np.clip(found.times - 1.0, 0.0, None)
    x = np.where(t < ramp, 0.5 * speed / ramp * t**2, 0.5 * speed * ramp + speed * (t - ramp))
    np.testing.assert_allclose(found["trolley.position"][:, 0], x, rtol=0, atol=1e-12)
    left = found["load.position"][:, 0] - found["trolley.position"][:, 0]
    expected = 2.0 * (speed / ramp / G) * length * abs(math.sin(0.5 * w * ramp))
    assert np.abs(left[t > ramp + 1.0]).max() == pytest.approx(expected, rel=2e-3)


def test_drives_go_on_bit_for_bit() -> None:
    phases = (
        Phase("a", (DriveTo("slide", 2.0, 0.5, acceleration=0.3, jerk=0.2),), after(2.345)),
        Phase("b", (DriveSpeed("slide", -0.4, acceleration=0.5, jerk=1.0),)),
    )
    whole = Simulation(sliding(*phases), 0.01)
    whole.record()
    _, records = whole.advance(500)
    first = Simulation(sliding(*phases), 0.01)
    first.record()
    first.advance(250)
    second = Simulation(sliding(*phases), 0.01)
    second.restore(first.state())
    np.testing.assert_array_equal(second.advance(250)[1], records[250:])


# tanks

LENGTH, BREADTH, DRAFT, RHO = 100.0, 40.0, 4.0, 1025.0
AFLOAT = RHO * LENGTH * BREADTH * DRAFT


def barge(*phases: Phase, **tank: Any) -> Scene:
    """On still water, with a tank in its middle."""
    restoring = LinearRestoring(
        volume=LENGTH * BREADTH * DRAFT,
        centre_of_buoyancy=np.array([0.0, 0.0, -0.5 * DRAFT]),
        reference=np.zeros(3),
        area=LENGTH * BREADTH,
        second_moments=(BREADTH * LENGTH**3 / 12.0, LENGTH * BREADTH**3 / 12.0, 0.0),
    )
    hull = RigidBody("barge", AFLOAT, np.diag([4e9, 2e10, 2e10]), position=np.zeros(3))
    sea = Sea(
        water=Water(density=RHO, gravity=G),
        hulls=(Hull(body="barge", restoring=restoring, damping=np.diag([1e5, 1e5, 4e7, 1e9, 1e9, 1e8])),),
        tanks=(
            Tank(name="aft", hull="barge", **({"mass": 0.0, "point": np.zeros(3)} | tank)),
            Tank(name="bow", hull="barge", point=np.zeros(3), mass=0.0),
        ),
    )
    return Scene((hull,), (Gravity(np.array([0.0, 0.0, -G])),), sea=sea, scenario=Scenario(phases))


def test_pumps_fill_and_empty_tanks() -> None:
    """With a rate from the time of an event on, to a mass, and never below nothing; the hull sinks by it."""
    phases = (
        Phase("wait", until=after(3.33)),
        Phase("fill", (TankRate("aft", 5e3),), (Condition(Signal((Term("barge.ballast"),)), 1e5),)),
        Phase("both", (TankRate("aft", 2e3, 1.5e5), TankRate("bow", 1e3, 2e4)), (arrived("aft", "bow"),)),
        Phase("out", (TankRate("aft", -1e4),), (arrived("aft"),)),
        Phase("rest", until=after(200.0)),
    )
    found = run(barge(*phases), 0.1, 280.0)
    t, ballast = found.times, found["barge.ballast"]
    times = dict(ends(found.simulation))
    assert times["fill"] == pytest.approx(3.33 + 20.0, abs=1e-6)
    assert times["both"] == pytest.approx(times["fill"] + 25.0, abs=1e-6)
    assert times["out"] == pytest.approx(times["both"] + 15.0, abs=1e-6)
    filling = np.interp(t, [3.33, times["fill"], times["both"], times["out"]], [0.0, 1e5, 1.5e5, 0.0])
    bow = np.interp(t, [times["fill"], times["fill"] + 20.0], [0.0, 2e4])
    np.testing.assert_allclose(ballast, filling + bow, rtol=0, atol=1.0)
    z = found["barge.position"][:, 2]
    assert z[-1] == pytest.approx(-2e4 / (RHO * LENGTH * BREADTH), rel=1e-2)


def test_a_tank_is_not_told_more_than_it_holds() -> None:
    """Of 10 x 5 x 2 m with 0.9 of it for water: 92.25 t."""
    box = {"point": None, "floor": np.zeros(3), "size": np.array([10.0, 5.0, 2.0]), "permeability": 0.9}
    made = barge(*told(TankRate("aft", 1e3, 92.5e3)), **box)
    with pytest.raises(
        InputError, match=r"92500 kg, and 'aft' is full with 92250 kg; expected at most 92250 kg"
    ):
        Simulation(made, 0.1)
    Simulation(barge(*told(TankRate("aft", 1e3, 92.25e3)), **box), 0.1)


def test_a_tank_with_pumps_is_not_told() -> None:
    """Their water is counted beside the schedule that a scenario changes, and by controllers."""
    made = barge(*told(TankRate("bow", 1.0)))
    pump = Pump(name="main", source="bow", target="aft", rate=10.0)
    made = replace(made, sea=replace(made.sea, pumps=(pump,)))
    with pytest.raises(InputError, match="the pump 'main' fills or empties 'bow'"):
        Simulation(made, 0.1)


def test_a_schedule_ends_where_a_pump_is_told_something() -> None:
    table = {"mass": None, "times": np.array([0.0, 100.0]), "masses": np.array([0.0, 1e5])}
    phases = (Phase("table", until=after(20.05)), Phase("stop", (TankRate("aft", 0.0),)))
    found = run(barge(*phases, **table), 0.1, 40.0)
    np.testing.assert_allclose(
        found["barge.ballast"], 1e3 * np.minimum(found.times, 20.05), rtol=0, atol=1e-6
    )


# tracks, and what is said from outside


def test_tracks_go_on_beside_each_other() -> None:
    """Two loads, each with phases of its own, which do not wait for each other; one event in a step of the other."""
    loads = [body(name, MASS, (x, 0, -REACH)) for name, x in (("load", 0.0), ("other", 30.0))]
    ropes = [
        wire(eye(GROUND, (x, 0, 0)), eye(name), name=rope, tension=MASS * G, damping=1e5)
        for rope, name, x in (("rope", "load", 0.0), ("line", "other", 30.0))
    ]
    main = (
        Phase("up", (WinchSpeed("rope", 0.2, 1.0),), after(1.234)),
        Phase("drop", (Release("rope"),), after(0.5)),
    )
    side = (
        Phase("wait", until=after(1.237)),
        Phase("haul", (WinchLength("line", 9.0, 0.5, 0.5),), (arrived("line"),)),
    )
    made = replace(scene(loads, ropes=ropes), scenario=Scenario(main, (), True, (Track("crane", side),)))
    simulation = Simulation(made, 0.01)
    simulation.record()
    times, rows = simulation.advance(1000)
    found = dict(ends(simulation))
    rest = REACH / (1.0 + MASS * G / 1e8)
    assert found["up"] == pytest.approx(1.234, abs=1e-9)
    assert found["drop"] == pytest.approx(1.734, abs=1e-9)
    assert found["wait"] == pytest.approx(1.237, abs=1e-9)
    assert found["haul"] == pytest.approx(1.237 + (rest - 9.0) / 0.5 + 0.5, abs=1e-6)
    assert simulation.ended  # with the last of all tracks
    number = {c.name: rows[:, c.column] for c in simulation.channels}
    for name, first, second in (
        ("phase", found["up"], found["drop"]),
        ("track_phase", found["wait"], found["haul"]),
    ):
        expected = 1.0 + (times >= first - 1e-9) + (times >= second - 1e-9)
        np.testing.assert_array_equal(number[f"scenario.{name}"], expected)
    assert times[-1] == pytest.approx(found["haul"], abs=0.0101)


def test_what_is_said_from_outside() -> None:
    """'continue' ends a phase that waits for it, 'hold' keeps one from ending, 'stop' ends the run: all are logged."""
    waits = Condition(Signal((), "told"), 0.5)
    phases = (Phase("ask", until=(waits,)), Phase("next", until=after(1.0)), Phase("last", until=after(9.0)))
    simulation = Simulation(hanging(*phases), 0.01)
    simulation.record()
    simulation.advance(50)
    assert ends(simulation) == []
    simulation.operation.tell("continue", simulation.time)
    simulation.advance(50)
    assert ends(simulation) == [("ask", pytest.approx(0.5, abs=1e-6))]
    simulation.operation.tell("hold", simulation.time)
    simulation.advance(100)
    assert len(ends(simulation)) == 1  # it would have ended at 1.5 s
    simulation.operation.tell("continue", simulation.time)
    simulation.advance(10)
    assert ends(simulation)[1] == ("next", pytest.approx(2.0, abs=1e-6))
    kept = simulation.state()
    again = Simulation(hanging(*phases), 0.01)
    again.restore(kept)
    for one in (simulation, again):
        one.operation.tell("stop", one.time)
        one.advance(10)
        assert one.outcome is Outcome.LIMIT_REACHED
        assert "stop" in one.message
    spec = [(line.time, line.what) for line in simulation.operation.log if line.event == "operator command"]
    assert spec == [(0.5, "continue"), (1.0, "hold"), (2.0, "continue"), (2.1, "stop")]
    assert again.operation.log == simulation.operation.log


def test_what_was_said_is_not_forgotten_where_a_run_is_undone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps are repeated from behind the last word, however cheap they were: the log is the same."""
    monkeypatch.setattr(scene_checks, "check_object", lambda *_, **__: None)  # which refuses the table
    made = hanging(Phase("next", until=after(1.0)), Phase("last", until=after(9.0)))
    broken = PointForce(
        "broken",
        body="load",
        point=np.zeros(3),
        times=np.array([0.0, 2.0, 2.01, 3.0]),
        forces=np.array([[0.0] * 3] * 2 + [[np.nan] * 3] * 2),
    )
    made = replace(made, forces=(*made.forces, broken))
    seen = []
    for times in (0.0, np.inf):
        monkeypatch.setattr(return_point, "TIMES", times)
        simulation = Simulation(made, 0.01)
        simulation.advance(50)
        simulation.operation.tell("hold", simulation.time)
        for steps in (20, 80, 1000):
            simulation.advance(steps)
        assert simulation.outcome is Outcome.NOT_FINITE
        assert ends(simulation) == []
        seen.append((simulation.step_index, simulation.operation.log, simulation.record()))
    (index, log, record), (other_index, other_log, other_record) = seen
    assert (index, log) == (other_index, other_log)
    np.testing.assert_array_equal(record, other_record)
    assert [line.what for line in log if line.event == "operator command"] == ["hold"]


def test_continue_is_kept_while_another_track_goes_on() -> None:
    """It counts for the phase that waited when it was said, whatever begins elsewhere, and for none behind it."""
    waits = Condition(Signal((), "told"), 0.5)
    main = (Phase("ask", until=(waits, *after(2.0))), Phase("again", until=(waits,)))
    side = (Phase("one", until=after(1.0)), Phase("two", until=after(4.0)))
    made = hanging(*main)
    made = replace(made, scenario=replace(made.scenario, tracks=(Track("side", side),)))
    simulation = Simulation(made, 0.01)
    simulation.record()
    simulation.advance(50)
    simulation.operation.tell("continue", simulation.time)
    simulation.advance(350)
    assert [name for name, _ in ends(simulation)] == ["one", "ask"]
    assert ends(simulation)[1][1] == pytest.approx(2.0, abs=1e-6)


def test_a_timeout_does_not_count_what_is_held() -> None:
    """A phase that is held for longer than its time goes on for what is left of it."""
    far = Condition(HEIGHT, 100.0)
    simulation = Simulation(hanging(Phase("wait", until=(far,), timeout=1.0), Phase("last")), 0.01)
    simulation.record()
    simulation.advance(50)
    simulation.operation.tell("hold", simulation.time)
    simulation.advance(200)
    simulation.operation.tell("continue", simulation.time)
    times, _ = simulation.advance(100)
    assert simulation.outcome is Outcome.TIMED_OUT
    assert times[-1] == pytest.approx(3.0, abs=0.0101)


def test_a_part_of_the_weight() -> None:
    """The tension of a rope that is hauled in from slack reaches 90 % of the weight of its load."""
    load = body("load", MASS, (0, 0, 0))
    ropes = [
        wire(eye(GROUND, (0, 0, z)), eye("load"), name=name, stiffness=1e7, **({"damping": 1e5} | more))
        for name, z, more in (
            ("below", 5.0, {"tension": MASS * G}),
            ("rope", 10.0, {"length": 10.2, "damping": 0.0}),
        )
    ]
    until = Condition(Signal((Term("rope.tension"),)), 0.9, weight_of=("load",))
    phases = (
        Phase("up", (WinchSpeed("rope", 0.05, 1.0),), (until,)),
        Phase("rest", (WinchSpeed("rope", 0.0),)),
    )
    found = run(replace(scene([load], ropes=ropes), scenario=Scenario(phases)), 0.01, 20.0)
    ((_, time),) = ends(found.simulation)
    assert np.interp(time, found.times, found["rope.tension"]) == pytest.approx(0.9 * MASS * G, rel=1e-3)


# what is refused

HELD = Winch(brake=1e6)
RATED = Winch(np.array([0.0]), np.array([0.0]), fastest=0.5)
BRAKED = Winch(brake=1e6, fastest=0.5)
SPEEDY = Winch(np.array([0.0]), tensions=np.array([1e4]), speed=0.5)


@pytest.mark.parametrize(
    ("phases", "more", "words"),
    [
        (told(WinchBrake("rope", on=True)), {}, "the winch of 'rope' has no brake"),
        (told(WinchBrake("rope", on=True), WinchSpeed("rope", -0.1)), {"winch": HELD}, "the brake of 'rope' is set"),
        (told(WinchSpeed("rope", -0.1), WinchBrake("rope", on=True)), {"winch": HELD}, "while its winch moves at -0"),
        (told(WinchTension("rope", 1e4, 0.1)), {}, "is not controlled by its tension"),
        (told(WinchLevel("rope", 1.0, 0.1)), {}, "is not controlled by its tension"),
        (told(WinchTension("rope", 3e6, 0.1)), {"winch": HELD}, "is a strain of 0.03"),
        (told(WinchTension("rope", 1.2e6, 0.1)), {"winch": HELD}, "the brake of 'rope' slips at 1e+06 N"),
        (told(WinchSpeed("rope", 0.6)), {"winch": SPEEDY, "tension": None}, "at most 0.5 m/s"),
        (told(WinchSpeed("rope", -0.6)), {"winch": RATED}, "0.6 m/s, and the winch of 'rope' has at most 0.5 m/s"),
        (told(WinchFollow("rope", "lead", 2.0)), {"winch": RATED, "ropes": [slack_rope("lead")]}, "with any speed"),
        (told(WinchFollow("rope", "lead", 2.0)), {"winch": RATED, "ropes": [slack_rope("lead", winch=RATED)]},
         "that of 'lead' leads it with 1 m/s"),
        (told(WinchSpeed("rope", 0.3), WinchLevel("rope", 1.0, 0.3)), {"winch": BRAKED},
         "0.3 m/s commanded to the winch of 'rope' and 0.3 m/s to keep its level; expected at most 0.5 m/s together"),
        ((Phase("a", (WinchLevel("rope", 1.0, 0.3),), after(1.0)), Phase("b", (WinchLength("rope", 9.0, 0.3),))),
         {"winch": BRAKED}, "at most 0.5 m/s together"),
        (told(WinchFollow("rope", "rope")), {}, "follows itself"),
        (told(WinchFollow("rope", "rop")), {}, "'rop' is no rope; did you mean 'rope'"),
        (told(DriveSpeed("slide", 0.1)), {}, "'slide' is no drive"),
        (told(DriveSpeed("load.x", 0.1)), {}, "'load.x' is no drive"),
        (told(TankRate("aft", 1.0)), {}, "'aft' is no tank"),
        ((Phase("a", until=(arrived("rope"),)), Phase("b")), {}, "'rope' has no commanded position"),
        ((Phase("a", (WinchSpeed("rope", 0.1),), (Condition(Signal((Term("rope.rest_length"),)), 12.0),)), Phase("b")),
         {}, "hauls in with 0.1 m/s, and it waits for rope.rest_length above 12"),
        ((Phase("a", (Release("rope"),), (Condition(Signal((Term("rope.tension"),)), 1e3),)), Phase("b")),
         {}, "'rope' is not connected, and has no tension"),
        (told(WinchHaul("rope", 1.0, 0.1, 0.0, Signal((Term("x.position", "z"),)))), {}, "'x.position' in"),
        ((Phase("a", until=(Condition(HEIGHT, 0.9, weight_of=("crane",)),)), Phase("b")), {}, "'crane' is no body"),
    ],
)  # fmt: skip
def test_refused(phases: tuple[Phase, ...], more: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError) as error:
        Simulation(hanging(*phases, **more), 0.01).record()
    assert words in str(error.value)


def test_a_winch_that_has_arrived_may_keep_a_level_with_all_its_speed() -> None:
    """Or one that was told to stop, in the next phase."""
    full = (WinchLevel("rope", 1.0, 0.5),)
    for move, until in (
        (WinchLength("rope", 9.0, 0.4), (arrived("rope"),)),
        (WinchSpeed("rope", 0.0, 2.0), after(2.0)),
    ):
        phases = (
            Phase("a", (WinchSpeed("rope", 0.4),), after(1.0)),
            Phase("b", (move,), until),
            Phase("c", full),
        )
        Simulation(hanging(*phases, winch=BRAKED), 0.01)


@pytest.mark.parametrize("order", [("b", "a"), ("a", "b")])
def test_a_winch_that_follows_is_followed_by_none(order: tuple[str, str]) -> None:
    """Whichever is told first, in one phase or another track; one that was told something else since may be."""
    leaders = {"a": "rope", "b": "a"}
    chain = tuple(WinchFollow(name, leaders[name]) for name in order)
    ropes = [slack_rope(name) for name in "ab"]
    with pytest.raises(InputError, match="follow"):
        Simulation(hanging(*told(*chain), ropes=ropes), 0.01)
    made = hanging(*told(chain[0]), ropes=ropes)
    aside = replace(made, scenario=replace(made.scenario, tracks=(Track("t", (Phase("x", (chain[1],)),)),)))
    with pytest.raises(InputError, match="follow"):
        Simulation(aside, 0.01)
    from_the_start = [slack_rope("a"), slack_rope("b", winch=Winch(follow="a"))]
    with pytest.raises(InputError, match="the winch of 'b' follows that of 'a'"):
        Simulation(hanging(*told(WinchFollow("a", "rope")), ropes=from_the_start), 0.01)
    Simulation(hanging(*told(chain[0], WinchSpeed(order[0], 0.0), chain[1]), ropes=ropes), 0.01)


def test_one_track_for_one_winch() -> None:
    made = hanging(*told(WinchSpeed("rope", 0.1)))
    both = replace(
        made, scenario=replace(made.scenario, tracks=(Track("b", (Phase("x", (Release("rope"),)),)),))
    )
    with pytest.raises(InputError, match="'rope' is commanded by another sequence"):
        Simulation(both, 0.01)


def test_a_drive_with_harmonics_is_not_told() -> None:
    swell = replace(STANDING, harmonics=(Harmonic(0.1, 0.2),))
    with pytest.raises(InputError, match="harmonics are added to 'slide'"):
        Simulation(sliding(*told(DriveSpeed("slide", 0.1)), drive=swell), 0.01)


def test_movers_are_in_the_order_of_their_actions() -> None:
    """Whatever the process: what is carried of each is restored by its number."""
    axes = ("y", "angle", "x", "z")
    trolley = RigidBody("trolley", 1e3, np.eye(3) * 1e3, motion=Fixed())
    phases = told(*(DriveTo(f"trolley.{axis}", 1.0 + i, 0.5) for i, axis in enumerate(axes)))
    simulation = Simulation(replace(scene([trolley]), scenario=Scenario(phases)), 0.01)
    simulation.record()
    np.testing.assert_allclose(simulation.operation.sequencer.actuator_state["arrives"], [2.0, 4.0, 6.0, 8.0])


def test_a_frame_of_a_body_with_modes_is_driven() -> None:
    """As one that follows tables of the same speeds: modes, reactions and work, beside bodies of other kinds."""
    cloud = make_cloud(seed=8)
    speeds = {
        "x": Profile(times=np.array([0.0, 0.1, 0.2, 0.3, 0.4]), speeds=np.array([0.0, 0.0, 0.5, 0.5, 0.0])),
        "angle": Profile(times=np.array([0.0, 0.2, 0.3]), speeds=np.array([0.0, 0.0, 0.6])),
    }
    phases = (
        Phase("wait", until=after(0.1)),
        Phase("go", (DriveTo("body.x", 0.1, 0.5, 0.1),), after(0.1)),
        Phase("turn", (DriveSpeed("body.angle", 0.6, 0.1),)),
    )
    load = body("load", MASS, (0, 0, -REACH))
    still = Driven(x=STANDING, angle=STANDING)
    tabled, told = (
        System(cloud, start_of(8), motion=motion, gravity=np.array([0.0, 0.0, -G])).scene()
        for motion in (Driven(**speeds), still)
    )
    tabled, told = (replace(one, bodies=(*one.bodies, load)) for one in (tabled, told))
    expected, found = (run(one, 1e-3, 0.5) for one in (tabled, replace(told, scenario=Scenario(phases))))
    corners = np.isin(np.round(found.times, 6), [0.1, 0.2, 0.3, 0.4])  # where accelerations have two values
    for name in ("position", "orientation", "modal_position", "reaction_force"):
        one, other = (run[f"body.{name}"][~corners] for run in (found, expected))
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-9 * np.abs(other).max())
    assert np.ptp(found["body.position"][:, 0]) > 0.09
