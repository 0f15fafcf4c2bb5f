"""Joints that a phase lets go: free fall, free flight, what else holds then, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from law_scenes import DOWN, G, body, eye, run, wire

from heavylift.numerics.outcome import InputError
from heavylift.solver.forces.spring import JointSpring
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.distance import Distance
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scenario.actions.release import ReleaseJoint
from heavylift.solver.scene.connections import JointFrame, Limits
from heavylift.solver.scene.scenario import Condition, Phase, Scenario
from heavylift.solver.scene.scene import Scene
from heavylift.solver.simulation import Simulation

MASS = 2e3


def scene(joints, *phases: Phase, bodies=None, forces=(), ropes=()) -> Scene:
    """Bodies under their weight."""
    return Scene(
        tuple(bodies or (body("load", MASS, (0, 0, -2)),)), (DOWN, *forces), (), tuple(joints), tuple(ropes),
        scenario=Scenario(phases),
    )  # fmt: skip


def after(time: float, *actions: ReleaseJoint) -> tuple[Phase, Phase]:
    """Nothing for a time that is no multiple of a step, then the actions."""
    return Phase("hold", until=(Condition(None, time),)), Phase("go", actions)


def weld(**more) -> FixedJoint:
    frame = JointFrame(np.array([0.0, 0.0, -2.0]))
    return FixedJoint(name="weld", body_a="ground", body_b="load", frame_a=frame, **more)


def energies(found, names=("kinetic", "potential", "elastic", "dissipated")):
    return np.sum([found[f"energy.{name}"] for name in names], axis=0)


def test_a_weld_that_lets_go_drops_its_load() -> None:
    """At rest up to the event, in free fall from there on, without a force of the joint; no energy is lost."""
    found = run(scene([weld()], *after(0.5033, ReleaseJoint("weld"))), 0.01, 2.0)
    late = np.maximum(found.times - 0.5033, 0.0)
    np.testing.assert_allclose(found["load.position"][:, 2], -2.0 - 0.5 * G * late**2, atol=1e-9)
    np.testing.assert_allclose(found["load.velocity"][:, 2], -G * late, atol=1e-9)
    force = found["weld.reaction_force"]
    np.testing.assert_allclose(np.abs(force[found.times < 0.5, 2]), MASS * G, rtol=1e-9)
    np.testing.assert_allclose(force[found.times > 0.51], 0.0, atol=1e-9)
    total = energies(found)
    np.testing.assert_allclose(total, total[0], atol=1e-12 * np.ptp(found["energy.potential"]))
    np.testing.assert_array_equal(found["energy.dissipated"], 0.0)


@pytest.mark.parametrize("relaxation", [0.0, 0.01])
def test_what_a_joint_that_gives_way_has_stored_is_lost(relaxation: float) -> None:
    """An oscillator up to the event, a fall from there on, and ``k z^2 / 2`` on the books."""
    stiffness, event, step = 1e5, 0.2533, 1e-3
    frame = JointFrame(np.array([0.0, 0.0, -2.0]))
    joint = Ball(name="eye", body_a="ground", body_b="load", frame_a=frame,
                 compliance=1.0 / stiffness, relaxation=relaxation)  # fmt: skip
    found = run(scene([joint], *after(event, ReleaseJoint("eye"))), step, 0.5)
    frequency, damping = np.sqrt(stiffness / MASS), 0.5 * relaxation * stiffness / MASS
    damped, drop = np.sqrt(frequency**2 - damping**2), MASS * G / stiffness
    fade, c, s = np.exp(-damping * event), np.cos(damped * event), np.sin(damped * event)
    z = -drop * (1.0 - fade * (c + damping / damped * s))
    v = -drop * fade * frequency**2 / damped * s
    total, late = energies(found), found.times[-1] - event
    size = 0.5 * stiffness * z**2
    np.testing.assert_allclose(total, total[0], rtol=0.0, atol=1e-9 * size)
    np.testing.assert_allclose(found["load.velocity"][-1, 2], v - G * late, rtol=0.0, atol=1e-4)
    np.testing.assert_allclose(found["energy.elastic"][-1], 0.0, atol=1e-12)
    i = np.searchsorted(found.times, event)
    booked = found["energy.dissipated"][i + 1] - found["energy.dissipated"][i - 1]
    np.testing.assert_allclose(booked, size, rtol=2e-3 if relaxation == 0.0 else 2e-2)


def test_a_pendulum_that_is_let_go_flies_on() -> None:
    """A parabola and an even turn from the event on; the rest of the scene swings on as it would alone."""

    def swinging(*names: str):
        hinge = [
            Hinge(
                name=f"hinge_{name}",
                body_a="ground",
                body_b=name,
                frame_a=JointFrame(np.array([x, 0.0, 0.0])),
                frame_b=JointFrame(np.array([-1.0, 0.0, 0.0])),
            )
            for name, x in (("one", 0.0), ("two", 9.0))
            if name in names
        ]
        turned = [
            JointFrame(j.frame_a.point, np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]).T) for j in hinge
        ]
        hinge = [
            Hinge(
                name=j.name,
                body_a="ground",
                body_b=j.body_b,
                frame_a=t,
                frame_b=JointFrame(j.frame_b.point, t.axes),
            )
            for j, t in zip(hinge, turned, strict=True)
        ]
        places = {"one": (1.0, 0.0, 0.0), "two": (10.0, 0.0, 0.0)}
        return [body(name, MASS, places[name]) for name in names], hinge

    bodies, hinges = swinging("one", "two")
    found = run(scene(hinges, *after(0.4, ReleaseJoint("hinge_one")), bodies=bodies), 2e-3, 2.0)
    late = found.times > 0.401
    t, p, v = found.times[late], found["one.position"][late], found["one.velocity"][late]
    spin = found["one.angular_velocity"][late]
    d = (t - t[0])[:, None]
    fall = np.array([0.0, 0.0, -0.5 * G])
    assert np.abs(spin[0]).max() > 1.0
    np.testing.assert_allclose(p, p[0] + d * v[0] + d * d * fall, atol=1e-9)
    np.testing.assert_allclose(spin - spin[0], 0.0, atol=1e-9)
    total = energies(found)
    np.testing.assert_allclose(total, total[0], atol=1e-5 * np.ptp(found["energy.kinetic"]))
    bodies, hinges = swinging("two")
    alone = run(
        scene(hinges, Phase("hold", until=(Condition(None, 0.4),)), Phase("go"), bodies=bodies), 2e-3, 2.0
    )
    np.testing.assert_allclose(found["two.position"], alone["two.position"], atol=1e-9)


def test_a_rope_takes_over_from_a_ball() -> None:
    """The load falls into it, and hangs at rest on it in the end."""
    ball = Ball(name="pin", body_a="ground", body_b="load", frame_a=JointFrame(np.array([0.0, 0.0, -2.0])))
    rope = wire(eye("ground"), eye("load"), length=2.05, stiffness=1e7, damping=5e4)
    found = run(scene([ball], *after(0.2, ReleaseJoint("pin")), ropes=[rope]), 2e-3, 6.0)
    assert found["rope.tension"][found.times < 0.2].max() == 0.0
    assert found["rope.tension"][-1] == pytest.approx(MASS * G, rel=1e-3)
    assert found["load.position"][-1, 2] == pytest.approx(-2.05 * (1.0 + MASS * G / 1e7), abs=1e-5)


def test_a_run_that_was_cut_off_behind_a_release_goes_on_bit_for_bit() -> None:
    """What a joint is then stands in the state of its rows."""

    def made() -> Simulation:
        return Simulation(scene([weld()], *after(0.5033, ReleaseJoint("weld"))), 0.01)

    whole, first, second = made(), made(), made()
    _, records = whole.advance(100)
    first.advance(60)
    second.restore(first.state())
    _, rest = second.advance(40)
    np.testing.assert_array_equal(rest, records[-len(rest) :])


@pytest.mark.parametrize(
    ("joint", "forces", "action", "words"),
    [
        (weld(), (), ReleaseJoint("wed"), "'wed' is no joint; did you mean 'weld'"),
        (
            Distance(name="bar", body_a="ground", body_b="load", length=2.0),
            (),
            ReleaseJoint("bar"),
            "'bar' is a joint of type 'distance'; expected a joint of type ball, cylindrical, fixed",
        ),
        (
            Hinge(name="pin", body_a="ground", body_b="load", frame_a=JointFrame(np.array([0.0, 0.0, -2.0])),
                  limits=Limits(-1.0, 1.0, 1e6)),
            (),
            ReleaseJoint("pin"),
            "'pin' has stops or friction",
        ),
        (
            Hinge(name="pin", body_a="ground", body_b="load", frame_a=JointFrame(np.array([0.0, 0.0, -2.0]))),
            (JointSpring(name="coil", joint="pin", stiffness=1.0),),
            ReleaseJoint("pin"),
            "'pin' has 'coil' along it",
        ),
    ],
)  # fmt: skip
def test_what_is_more_than_rows_is_refused(joint, forces, action, words) -> None:
    """With the reason, and what can be released."""
    with pytest.raises(InputError, match=words):
        Simulation(scene([joint], *after(0.5, action), forces=forces), 0.01)
    with pytest.raises(InputError, match="'weld' is released then"):
        Simulation(scene([weld()], *after(0.5, ReleaseJoint("weld"), ReleaseJoint("weld"))), 0.01)
