"""Clutches against closed forms: they pass momentum while they slip, and hold without creep while they stick."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from law_scenes import DOWN, run

from heavylift.numerics.outcome import InputError
from heavylift.solver.force_elements.clutch import Clutch
from heavylift.solver.forces.motor import JointMotor
from heavylift.solver.integrate.choice import choose_integrator
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.slider import Slider
from heavylift.solver.scene.connections import GROUND, JointFrame
from heavylift.solver.scene.descriptions import check_object
from heavylift.solver.scene.scenario import Condition, Phase, Scenario
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.scene.signals import Signal, Term
from heavylift.solver.simulation import Simulation

ONE, TWO = 20.0, 30.0


def wheel(name: str, inertia: float, height: float, speed: float = 0.0) -> RigidBody:
    return RigidBody(
        name,
        10.0,
        inertia * np.eye(3),
        position=np.array([0.0, 0.0, height]),
        angular_velocity=np.array([0.0, 0.0, speed]),
    )


def shaft(*forces: Any, speeds: tuple[float, float] = (0.0, 0.0)) -> Scene:
    """Two wheels about z: the first on the ground, the second on the first one."""
    above = JointFrame(np.array([0.0, 0.0, 1.0]))
    return Scene(
        (wheel("one", ONE, 0.0, speeds[0]), wheel("two", TWO, 1.0, speeds[1])),
        forces=forces,
        joints=(
            Hinge(name="foot", body_a=GROUND, body_b="one"),
            Hinge(name="between", body_a="one", body_b="two", frame_a=above),
        ),
    )


@pytest.mark.parametrize("torque", [30.0, 60.0, 240.0])
@pytest.mark.parametrize("speeds", [(4.0, -1.0), (-2.0, 3.0)])
def test_two_inertias_become_one(torque: float, speeds: tuple[float, float]) -> None:
    """It slips for ``dw/(M (1/I1 + 1/I2))``; then both have the speed of their momentum; the heat is none of M."""
    w1, w2 = speeds
    found = run(shaft(Clutch(name="clutch", joint="between", torque=torque), speeds=speeds), 1e-3, 3.0)
    t, slipping = found.times, found["clutch.slipping"]
    duration = abs(w1 - w2) / (torque * (1.0 / ONE + 1.0 / TWO))
    together = (ONE * w1 + TWO * w2) / (ONE + TWO)
    during, after = (t > 0.0) & (t < duration - 1e-3), t > duration + 1e-3
    sense = np.sign(w2 - w1)
    assert np.all(slipping[during] == sense)
    assert np.all(slipping[after] == 0.0)
    np.testing.assert_allclose(found["clutch.torque"][during], -sense * torque, rtol=1e-12)
    np.testing.assert_allclose(found["clutch.torque"][after], 0.0, atol=1e-8)
    exact = np.where(
        t < duration, w1 - sense * (w1 - w2) * sense * t / duration * TWO / (ONE + TWO), together
    )
    np.testing.assert_allclose(found["foot.angular_rate"], exact, atol=1e-9)
    np.testing.assert_allclose(found["clutch.slip_rate"][after], 0.0, atol=1e-12)
    np.testing.assert_allclose(found["clutch.slipped"][-1], 0.5 * abs(w1 - w2) * duration, rtol=1e-9)
    heat = 0.5 * ONE * TWO / (ONE + TWO) * (w1 - w2) ** 2
    np.testing.assert_allclose(found["clutch.heat"][-1], heat, rtol=1e-10)
    np.testing.assert_allclose(found["energy.dissipated"][-1], heat, rtol=1e-10)
    assert found.balance < 1e-9


def test_below_its_limit_it_holds_without_creep() -> None:
    """99 % of the limit for 1000 s: the angle of the first step is that of the last one."""
    forces = (
        Clutch(name="brake", joint="foot", torque=100.0),
        Clutch(name="clutch", joint="between", torque=100.0),
        JointMotor(name="motor", joint="between", load=99.0),
    )
    found = run(shaft(*forces), 1e-2, 1000.0, record_every=1000)
    assert np.ptp(found["between.angle"]) < 1e-9
    assert np.ptp(found["between.angle"][1:]) < 1e-12
    np.testing.assert_allclose(found["clutch.torque"][1:], -99.0, rtol=1e-9)
    assert np.all(found["clutch.slipped"] == 0.0)


def test_it_breaks_away_at_its_limit() -> None:
    """A torque of 10 t N m exceeds 60 N m at 6 s; from then on the wheel has what is beyond, ``5 (t - 6)^2/I``."""
    forces = (
        Clutch(name="brake", joint="foot", torque=60.0),
        Clutch(name="clutch", joint="between", torque=1e3),
        JointMotor(name="motor", joint="foot", times=np.array([0.0, 10.0]), loads=np.array([0.0, 100.0])),
    )
    found = run(shaft(*forces), 1e-3, 8.0, record_every=10)
    rate = 5.0 * np.maximum(0.0, found.times - 6.0) ** 2 / (ONE + TWO)
    np.testing.assert_allclose(found["foot.angular_rate"], rate, atol=1e-6)
    assert np.all(found["clutch.slipping"] == 0.0)
    both = ONE + TWO
    carried = np.where(found.times < 6.0, 0.0, TWO / both * (10.0 * found.times - 60.0))
    np.testing.assert_allclose(found["clutch.torque"][2:], carried[2:], atol=1e-2)


def test_a_table_opens_and_closes_it() -> None:
    """Open it passes nothing; pressed on linearly it passes the integral of its torque."""
    clutch = Clutch(name="clutch", joint="between", times=np.array([1.0, 2.0]), torques=np.array([0.0, 60.0]))
    found = run(shaft(clutch, speeds=(4.0, -1.0)), 1e-3, 3.0)
    passed = np.clip(found.times - 1.0, 0.0, 1.0) ** 2 * 30.0 + np.clip(found.times - 2.0, 0.0, None) * 60.0
    expected = np.maximum(4.0 - passed / ONE, 1.0)
    np.testing.assert_allclose(found["foot.angular_rate"], expected, atol=1e-9)
    np.testing.assert_allclose(found["clutch.heat"][-1], 150.0, rtol=1e-10)


def test_a_clutch_that_sticks_makes_two_links_one() -> None:
    """A pendulum of two links, thrown about, moves as with a fixed joint between them."""
    angular = np.array([0.0, 1.5, 0.0])

    def links(joint: Any, *forces: Any) -> Scene:
        bodies = [
            RigidBody(
                name,
                5.0,
                np.diag([0.5, 0.6, 0.2]),
                position=np.array([0.0, 0.0, z]),
                velocity=np.cross(angular, [0.0, 0.0, z]),
                angular_velocity=angular,
            )
            for name, z in (("upper", -1.0), ("lower", -3.0))
        ]
        return Scene(tuple(bodies), (DOWN, *forces), joints=(pivot, joint))

    across = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    pivot = Hinge(
        name="pivot",
        body_a=GROUND,
        body_b="upper",
        frame_a=JointFrame(np.zeros(3), across),
        frame_b=JointFrame(np.array([0.0, 0.0, 1.0]), across),
    )
    sides = {
        "name": "knee",
        "body_a": "upper",
        "body_b": "lower",
        "frame_a": JointFrame(np.array([0.0, 0.0, -1.0]), across),
        "frame_b": JointFrame(np.array([0.0, 0.0, 1.0]), across),
    }
    stuck = run(links(Hinge(**sides), Clutch(name="clutch", joint="knee", torque=1e4)), 1e-3, 4.0)
    rigid = run(links(FixedJoint(**sides)), 1e-3, 4.0)
    np.testing.assert_allclose(stuck["lower.position"], rigid["lower.position"], atol=1e-6)
    assert np.abs(stuck["knee.angle"]).max() < 1e-8
    # the moment of the fixed joint about y is what the clutch carries
    moment = rigid["knee.reaction_moment"][:, 1]
    np.testing.assert_allclose(
        np.abs(stuck["clutch.torque"][5:]), np.abs(moment[5:]), atol=2e-4 * np.abs(moment).max()
    )


def test_a_run_goes_on_from_what_a_clutch_carries() -> None:
    """A step that is taken back, or a checkpoint, has the grip, the sense of the slip and the heat."""
    scene = shaft(Clutch(name="clutch", joint="between", torque=60.0), speeds=(4.0, -1.0))
    whole = run(scene, 1e-3, 1.5)
    first = Simulation(scene, 1e-3)
    first.advance(700)
    second = Simulation(scene, 1e-3)
    second.restore(first.state())
    rest = second.advance(800)[1]
    np.testing.assert_array_equal(rest, whole.records[701:])


def test_in_a_part_of_a_step_it_holds_as_well() -> None:
    """A scenario ends phases within steps, the last one where the clutch begins to stick, found to 1e-9 s."""
    near = Condition(Signal((Term("clutch.slip_rate"),)), -1e-7)
    phases = (
        Phase("wait", until=(Condition(None, 0.1234567891),)),
        Phase("engage", until=(near,)),
        Phase("on"),
    )
    forces = (
        Clutch(name="clutch", joint="between", torque=60.0),
        Clutch(name="brake", joint="axle", torque=60.0),
        JointMotor(name="motor", joint="axle", load=59.0),
    )
    two = shaft(*forces, speeds=(4.0, -1.0))
    axle = Hinge(name="axle", body_a=GROUND, body_b="drum", frame_a=JointFrame(np.array([0.0, 0.0, 3.0])))
    scene = replace(
        two,
        bodies=(*two.bodies, wheel("drum", 40.0, 3.0)),
        joints=(*two.joints, axle),
        scenario=Scenario(phases),
    )
    found = run(scene, 1e-3, 1.5, record_every=10)
    ends = [line.time for line in found.simulation.operation.log if line.event == "done"]
    np.testing.assert_allclose(ends, [0.1234567891, 1.0], atol=1e-7)
    np.testing.assert_allclose(found["foot.angular_rate"][-1], 1.0, rtol=1e-9)
    assert np.abs(found["axle.angle"]).max() < 1e-9
    assert np.all(found["brake.slipped"] == 0.0)
    np.testing.assert_allclose(found["clutch.heat"][-1], 150.0, rtol=1e-8)
    assert found.balance < 1e-8


def test_only_the_default_integrator_serves_it() -> None:
    scene = shaft(Clutch(name="clutch", joint="between", torque=60.0))
    for name, more in (("accurate", {"tolerance": 1e-6}), ("thesis", {})):
        with pytest.raises(InputError, match=f"{name!r}, but clutch 'clutch' sticks and slips"):
            run(scene, 1e-3, 1e-2, name, **more)
    assert choose_integrator(scene, 0.1) == ("dele2", "dele2, because clutch 'clutch' sticks and slips")


def test_what_makes_no_clutch_is_refused() -> None:
    joint = Slider(name="rail", body_a=GROUND, body_b="one")
    scene = Scene(
        (wheel("one", ONE, 0.0),), forces=(Clutch(name="clutch", joint="rail", torque=1.0),), joints=(joint,)
    )
    with pytest.raises(InputError, match="joint 'rail' is a Slider, which has no single angle"):
        run(scene, 1e-3, 1e-2)
    table = {"times": np.array([0.0, 1.0]), "torques": np.array([1.0])}
    for keys, message in (
        ({}, "not exactly one of 'torque' and a table"),
        ({"torque": -1.0}, "torques: -1.0 is too small; expected a moment or energy >= 0 N m"),
        (table, "2 times and 1 torques"),
    ):
        with pytest.raises(InputError, match=message):
            check_object(Clutch(name="clutch", joint="between", **keys))
