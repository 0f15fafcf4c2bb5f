"""What inputs drive, against the same motion written as a table: drives, tanks, winds, set points."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from input_scenes import LOAD, column, driven, hoist

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.inputs.ballast import TankRateInput
from heavylift.solver.inputs.drives import (
    DrivePositionInput,
    DriveSpeedInput,
    FrameAngleInput,
    FramePositionInput,
    FrameSpeedInput,
    FrameTurnRateInput,
)
from heavylift.solver.inputs.winches import WinchLengthInput, WinchSpeedInput
from heavylift.solver.inputs.wind import FluidDirectionInput, FluidSpeedInput
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import Winch
from heavylift.solver.scene.scene import Driven, Fixed, Profile, Scene
from heavylift.solver.scene.sea import Sea, Water
from heavylift.solver.scene.wind_loads import CurrentField, DragElement, Veering, WindField
from heavylift.solver.simulation import Simulation

TIMES, SPEEDS = np.array([0.0, 0.3, 0.6, 1.0]), np.array([0.0, 0.4, 0.4, -0.2])
RAMPS = {0: (0.0, 0.4 / 0.3, 0.3), 30: (0.4,), 60: (0.4, -0.6 / 0.4, 1.0)}
STANDING = Profile(times=np.zeros(1), speeds=np.zeros(1))


def hinged(profile: Profile, **more: Any) -> Scene:
    """A body on a hinge with a drive."""
    hinge = Hinge(name="pin", body_a="ground", body_b="load", drive=profile)
    return Scene((LOAD,), joints=(hinge,), **more)


def test_the_speed_of_a_drive_moves_a_hinge_as_a_table_of_speeds() -> None:
    one = Simulation(hinged(Profile(times=TIMES, speeds=SPEEDS)), 0.01)
    other = Simulation(hinged(STANDING, inputs=(DriveSpeedInput(name="turn", joint="pin"),)), 0.01)
    expected = one.advance(120)[1]
    found = driven(other, {index: ("turn", *setting) for index, setting in RAMPS.items()}, 120)
    for name in ("pin.angle", "pin.angular_rate", "pin.reaction_moment"):
        np.testing.assert_allclose(
            column(other, name, found), column(one, name, expected), rtol=1e-9, atol=1e-12
        )
    assert other.inputs["turn"].unit == "rad/s"


def test_the_position_of_a_drive_is_reached_and_held() -> None:
    place = DrivePositionInput(name="turn", joint="pin", largest=1.0)
    simulation = Simulation(hinged(STANDING, inputs=(place,)), 0.01)
    simulation.set_input("turn", 0.0, 2.0, 0.25)
    records = simulation.advance(50)[1]
    angle = column(simulation, "pin.angle", records)
    np.testing.assert_allclose(angle[[9, 24, 49]], [0.2, 0.5, 0.5], rtol=1e-9)
    np.testing.assert_allclose(column(simulation, "turn.value", records), angle, rtol=1e-6)
    with pytest.raises(InputError, match=r"2 rad while it is at 0.5 rad, which would be a jump"):
        simulation.set_input("turn", 2.0)
    with pytest.raises(InputError, match=r"1.5 rad; expected at most 1 rad"):
        simulation.set_input("turn", 0.5, 10.0, 0.6)


@pytest.mark.parametrize("motion", [Fixed(), Driven(x=STANDING, angle=STANDING)])
def test_a_frame_moves_by_its_inputs(motion: Any) -> None:
    """One that is fixed in the case can be driven, as in a scenario; speeds and angles at the same time."""
    inputs = (
        FrameSpeedInput(name="go", body="load", axis="x"),
        FramePositionInput(name="lift", body="load", axis="z"),
        FrameAngleInput(name="turn", body="load"),
    )
    simulation = Simulation(Scene((replace(LOAD, motion=motion),), inputs=inputs), 0.01)
    simulation.set_input("lift", 0.0, 1.0, 0.5)
    simulation.set_input("turn", 0.0, 0.4, 1.0)
    found = driven(simulation, {index: ("go", *setting) for index, setting in RAMPS.items()}, 120)
    position, q = column(simulation, "load.position", found), column(simulation, "load.orientation", found)
    table = Driven(x=Profile(times=TIMES, speeds=SPEEDS))
    one = Simulation(Scene((replace(LOAD, motion=table),)), 0.01)
    expected = column(one, "load.position", one.advance(120)[1])
    np.testing.assert_allclose(position[:, 0], expected[:, 0], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(position[[24, 49, 119], 2], [0.25, 0.5, 0.5], rtol=1e-12)
    np.testing.assert_allclose(2.0 * np.arctan2(q[[49, 119], 3], q[[49, 119], 0]), [0.2, 0.4], rtol=1e-9)


def test_followers_of_a_winch_do_as_it_does() -> None:
    """By their ratio; the run ends where the first of them is used up."""
    leader = hoist(Winch(times=np.zeros(1), speeds=np.zeros(1))).ropes[0]
    follower = replace(leader, name="other", winch=Winch(follow="hoist", ratio=2.0))
    scene = replace(hoist(inputs=(WinchSpeedInput(name="haul", rope="hoist"),)), ropes=(leader, follower))
    simulation = Simulation(scene, 0.01)
    simulation.set_input("haul", -0.5)
    records = simulation.advance(100)[1]
    for rope, length in (("hoist", 10.5), ("other", 11.0)):
        np.testing.assert_allclose(column(simulation, f"{rope}.rest_length", records)[-1], length, rtol=1e-12)
    simulation.set_input("haul", 2.0)
    simulation.advance(1000)
    assert simulation.outcome is Outcome.LIMIT_REACHED
    assert "the winch of 'other' has hauled in" in simulation.message


def blown(speed: float, direction: Any, **more: Any) -> Scene:
    """A plate in the wind."""
    wind = WindField(speed=speed, direction=direction, gust=60.0)
    load = DragElement(
        name="drag", fluid="wind", body="load", point=np.array([0.0, 0.0, 20.0]), area=5.0, coefficient=1.2
    )
    return Scene(
        (replace(LOAD, mass=1e5, inertia=1e7 * np.eye(3)),),
        sea=Sea(water=Water(), fields=(wind,), loads=(load,)),
        **more,
    )


def test_a_wind_is_that_of_a_sea_with_its_speed_and_direction() -> None:
    """All that follows from the speed changes with it: the profile over the height, and the gust."""
    inputs = (FluidSpeedInput(name="blow"), FluidDirectionInput(name="veer"))
    simulation = Simulation(blown(5.0, 0.1, inputs=inputs), 0.1)
    assert (simulation.inputs.value("blow"), simulation.inputs.value("veer")) == ((5.0, 0.0), (0.1, 0.0))
    assert simulation.inputs["blow"].largest == 75.0
    simulation.set_input("blow", 15.0)
    simulation.set_input("veer", 0.7)
    one = Simulation(blown(15.0, 0.7), 0.1)
    np.testing.assert_array_equal(
        column(simulation, "drag.force", simulation.advance(3)[1]),
        column(one, "drag.force", one.advance(3)[1]),
    )
    simulation.set_input("veer", 0.7, 0.5, 0.5)
    records = simulation.advance(4)[1]
    np.testing.assert_allclose(
        column(simulation, "wind.direction", records), [0.75, 0.8, 0.8, 0.8], rtol=1e-12
    )
    with pytest.raises(InputError, match=r"80 m/s; expected 0 m/s or more, at most 75 m/s"):
        simulation.set_input("blow", 80.0)
    with pytest.raises(InputError, match=r"a rate of 1 m/s/s; expected rate 0"):
        simulation.set_input("blow", 5.0, 1.0, 1.0)


BAD: dict[str, tuple[Any, str]] = {
    "unknown rope": (WinchSpeedInput(name="a", rope="hist"), "'hist' is no rope; did you mean 'hoist'"),
    "unknown drive": (DriveSpeedInput(name="a", joint="pin"), "there is no joint 'pin'"),
    "unknown body": (FrameSpeedInput(name="a", body="lod", axis="x"), "there is no body 'lod'"),
    "free frame": (FrameSpeedInput(name="a", body="load", axis="x"), "'load.x' is no drive"),
    "unknown tank": (TankRateInput(name="a", tank="t"), "'t' is no tank"),
    "unknown wind": (FluidSpeedInput(name="a"), "'wind' is no wind or current"),
    "taken name": (WinchSpeedInput(name="load", rope="hoist"), "the name 'load' is taken"),
    "start": (WinchSpeedInput(name="a", rope="hoist", value=2.0, largest=1.0), "2 is above 'largest'"),
    "range": (WinchSpeedInput(name="a", rope="hoist", smallest=2.0, largest=1.0), "2 is above 'largest', 1"),
    "length": (WinchLengthInput(name="a", rope="hoist", largest=9.0), "10 m at the start; expected"),
}


@pytest.mark.parametrize("case", BAD)
def test_inputs_that_do_not_fit_a_scene_are_refused(case: str) -> None:
    one, words = BAD[case]
    with pytest.raises(InputError, match=words):
        Simulation(hoist(inputs=(one,)), 0.1).warm_up()


def test_two_inputs_of_one_winch_are_refused() -> None:
    inputs = (WinchSpeedInput(name="a", rope="hoist"), WinchLengthInput(name="b", rope="hoist"))
    with pytest.raises(InputError, match=r"b: inputs.1.rope: 'a' drives 'hoist' too"):
        Simulation(hoist(inputs=inputs), 0.1)


@pytest.mark.parametrize(
    ("winch", "words"),
    [
        ({"times": [0.0, 1.0], "speeds": [0.0, 1.0]}, "the winch of 'hoist' has 'speeds'"),
        ({"times": [0.0], "tensions": [20.0], "speed": 1.0}, "the winch of 'hoist' has 'tensions'"),
    ],
)
def test_a_winch_with_a_plan_of_its_own_is_refused(winch: dict[str, Any], words: str) -> None:
    arrays = {key: np.array(value) if isinstance(value, list) else value for key, value in winch.items()}
    scene = hoist(Winch(**arrays), inputs=(WinchSpeedInput(name="a", rope="hoist"),))
    with pytest.raises(InputError, match=words):
        Simulation(scene, 0.1)


def test_a_brake_slips_while_its_winch_is_driven() -> None:
    """Hauled in so fast that the brake gives rope: with the bits of a table, and more rope than the winch hauls in."""
    plan = Winch(times=np.array([0.0, 0.1, 0.2]), speeds=np.array([0.0, 0.0, 6.0]), brake=60.0)
    one = Simulation(hoist(plan), 0.01)
    driving = hoist(Winch(brake=60.0), inputs=(WinchSpeedInput(name="haul", rope="hoist"),))
    other = Simulation(driving, 0.01)
    expected = one.advance(100)[1]
    found = driven(other, {10: ("haul", 0.0, 6.0 / 0.1, 0.2)}, 60)
    third = Simulation(driving, 0.01)
    third.set_input("haul", -1.0)
    third.advance(2)
    third.restore(other.state())
    rest = other.advance(40)[1]
    np.testing.assert_array_equal(third.advance(40)[1], rest)
    for name in ("hoist.tension", "hoist.paid_out", "hoist.rest_length"):
        np.testing.assert_allclose(
            column(other, name, np.concatenate([found, rest])),
            column(one, name, expected),
            rtol=1e-9,
            atol=1e-9,
        )
    slipped = column(one, "hoist.paid_out", expected)[-1]
    assert slipped > 0.5
    times, records = other.advance(1000)
    assert other.outcome is Outcome.LIMIT_REACHED
    hauled = 0.3 + 6.0 * (times[-1] - 0.2)
    rope = column(other, "hoist.paid_out", records)[-1]
    np.testing.assert_allclose(
        column(other, "hoist.rest_length", records)[-1], 10.0 - hauled + rope, rtol=1e-9
    )
    assert 0.0 < 10.0 - hauled + rope < 3.0 * 6.0 * 0.01


def test_a_length_is_not_that_of_a_brake_that_slips() -> None:
    scene = hoist(Winch(brake=100.0), inputs=(WinchLengthInput(name="a", rope="hoist"),))
    with pytest.raises(InputError, match="the winch of 'hoist' has 'brake'"):
        Simulation(scene, 0.1)


def test_a_winch_is_no_faster_than_it_can() -> None:
    winch = Winch(times=np.zeros(1), speeds=np.zeros(1), fastest=0.5)
    simulation = Simulation(hoist(winch, inputs=(WinchSpeedInput(name="haul", rope="hoist"),)), 0.1)
    with pytest.raises(InputError, match=r"0.6 m/s; expected .*the winch does 0.5 m/s at most"):
        simulation.set_input("haul", 0.6)
    with pytest.raises(InputError, match=r"-0.6 m/s"):
        simulation.set_input("haul", 0.0, -1.0, 0.6)
    simulation = Simulation(hoist(winch, inputs=(WinchLengthInput(name="length", rope="hoist"),)), 0.1)
    length, _ = simulation.inputs.value("length")
    with pytest.raises(InputError, match=r"the winch would move with 0.6 m/s, and does 0.5 m/s at most"):
        simulation.set_input("length", length, -0.6, 1.0)
    simulation.set_input("length", length, 0.5, 1.0)


@pytest.mark.parametrize("integrator", ["accurate", "thesis"])
def test_what_only_one_integrator_follows_is_refused_elsewhere(integrator: str) -> None:
    scene = hinged(STANDING, inputs=(DriveSpeedInput(name="turn", joint="pin"),))
    with pytest.raises(InputError, match="drive"):
        Simulation(scene, 0.1, integrator)
    assert Simulation(scene, 0.1, "auto").integrator == "dele2"


@pytest.mark.parametrize("integrator", ["dele2", "accurate"])
def test_a_direction_that_veers_is_that_of_a_table(integrator: str) -> None:
    """Set where it begins to veer, in the middle of a run."""
    table = Veering(times=np.array([0.3, 0.8]), angles=np.array([0.1, 1.1]))
    one = Simulation(blown(20.0, table), 0.1, integrator)
    other = Simulation(blown(20.0, 0.1, inputs=(FluidDirectionInput(name="veer"),)), 0.1, integrator)
    expected, found = one.advance(12)[1], driven(other, {3: ("veer", 0.1, 2.0, 0.8)}, 12)
    for name in ("wind.direction", "drag.force", "load.velocity"):
        np.testing.assert_allclose(
            column(other, name, found), column(one, name, expected), rtol=1e-7, atol=1e-9
        )


def test_a_current_flows_as_fast_as_its_input() -> None:
    def scene(speed: float, **more: Any) -> Scene:
        load = DragElement(
            name="drag",
            fluid="current",
            body="load",
            point=np.array([0.0, 0.0, -5.0]),
            area=5.0,
            coefficient=1.2,
        )
        sea = Sea(water=Water(), fields=(CurrentField(speed=speed),), loads=(load,))
        return Scene((replace(LOAD, mass=1e5, inertia=1e7 * np.eye(3)),), sea=sea, **more)

    simulation = Simulation(scene(0.5, inputs=(FluidSpeedInput(name="flow", fluid="current"),)), 0.1)
    simulation.set_input("flow", 1.5)
    one = Simulation(scene(1.5), 0.1)
    np.testing.assert_array_equal(
        column(simulation, "drag.force", simulation.advance(5)[1]),
        column(one, "drag.force", one.advance(5)[1]),
    )
    other = Simulation(scene(0.5, inputs=(FluidSpeedInput(name="flow", fluid="current"),)), 0.1)
    other.restore(simulation.state())
    np.testing.assert_array_equal(other.advance(5)[1], simulation.advance(5)[1])
    assert simulation.inputs["flow"].largest == 10.0


def test_a_wind_that_fluctuates_or_veers_is_not_driven() -> None:
    table = Veering(times=np.array([0.3, 0.8]), angles=np.array([0.1, 1.1]))
    with pytest.raises(InputError, match=r"the direction of 'wind' is a table, or fluctuates"):
        Simulation(blown(20.0, table, inputs=(FluidDirectionInput(name="veer"),)), 0.1)


def test_a_frame_turns_at_the_rate_of_its_input() -> None:
    motion = Driven(axis=(0.0, 0.0, 1.0), angle=STANDING)
    turn = FrameTurnRateInput(name="turn", body="load", value=0.1)
    simulation = Simulation(Scene((replace(LOAD, motion=motion),), inputs=(turn,)), 0.01)
    found = driven(simulation, {50: ("turn", -0.4)}, 100)
    q = column(simulation, "load.orientation", found)
    np.testing.assert_allclose(2.0 * np.arctan2(q[[49, 99], 3], q[[49, 99], 0]), [0.05, -0.15], rtol=1e-9)
