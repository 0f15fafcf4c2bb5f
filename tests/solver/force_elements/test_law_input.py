"""One clear error for each thing that is wrong with a rope, spring, stop or motor."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from law_scenes import body, eye, pulley, scene, slider, wire

from heavylift.numerics.outcome import InputError
from heavylift.solver.force_elements.wire_rope import SpringRope
from heavylift.solver.forces.motor import JointMotor
from heavylift.solver.forces.spring import JointSpring, Spring
from heavylift.solver.joints.ball import Ball
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.connections import GROUND, Limits, RopePoint, Winch
from heavylift.solver.simulation import Simulation

LOAD = body("block", 1.0, (0, 0, -10.0))


def refused(message: str, **parts: Any) -> None:
    with pytest.raises(InputError, match=message):
        pack_scene(scene([LOAD], **parts))


def spring(**more: Any) -> Spring:
    values = {"length": 10.0, "stiffness": 1.0, "point_b": np.zeros(3)} | more
    return Spring(name="spring", body_a=GROUND, point_a=np.zeros(3), body_b="block", **values)


def test_rope_shorter_than_its_path_says_by_how_much() -> None:
    refused(
        r"rope of 9 m is 1 m shorter than its path of 10 m.*11.1 %.*at least 9.80392 m",
        ropes=[wire(eye(GROUND), eye("block"), length=9.0)],
    )
    pack_scene(scene([LOAD], ropes=[wire(eye(GROUND), eye("block"), length=9.9)]))  # 1 % is a stretch


def test_a_rope_that_comes_to_rest_first_is_judged_there() -> None:
    """Drawn with a strain of 11 %, it hangs with ``m g / EA``; one that holds two fixed points apart is too short."""
    hanging = scene([LOAD], ropes=[wire(eye(GROUND), eye("block"), length=9.0)])
    simulation = Simulation(hanging, 1e-3, start="equilibrium")
    row = simulation.record()
    column = {channel.name: channel.column for channel in simulation.channels}
    stiffness = hanging.ropes[0].axial_stiffness
    assert row[column["block.position"] + 2] == pytest.approx(-9.0 * (1.0 + 9.81 / stiffness), rel=1e-9)
    with pytest.raises(InputError, match=r"shorter than its path of 10 m"):
        Simulation(hanging, 1e-3)
    below = wire(eye(GROUND, (0, 0, -20.0)), eye("block"), name="below", length=10.0)
    pulled = scene([LOAD], ropes=[*hanging.ropes, below])  # 19 m of rope for 20 m
    with pytest.raises(
        InputError, match=r"length: .* shorter than the path of .* at rest .* a strain of 5\.26"
    ):
        Simulation(pulled, 1e-3, start="equilibrium").record()
    # the ropes of the second are forces, without rows
    for integrator, tolerance in (("dele2", None), ("accurate", 1e-6)):
        with pytest.raises(InputError) as caught:
            Simulation(pulled, 1e-3, start="equilibrium", integrator=integrator, tolerance=tolerance).record()
        assert caught.value.source in {"rope", "below"}


@pytest.mark.parametrize(
    ("rope", "message"),
    [
        (wire(eye("block")), "1 points.*two points or more"),
        (wire(eye(GROUND), eye("hook")), "there is no body 'hook'"),
        (wire(eye(GROUND), eye(GROUND, (1, 0, 0)), eye("block")), None),
        (wire(eye(GROUND), eye(GROUND), eye("block")), "points 1 and 2 coincide"),
        (
            wire(eye(GROUND), eye(GROUND, (1, 0, 0))),
            "path: all its points are on the ground.*a point on a body",
        ),
        (wire(eye(GROUND), eye("block"), stiffness=0.0), "axial_stiffness: 0.0 is too small.*a force > 0 N"),
        (wire(eye(GROUND), eye("block"), stiffness=-1.0), "axial_stiffness"),
        (wire(eye(GROUND), eye("block"), damping=-1.0), "damping"),
        (wire(eye(GROUND), eye("block"), length=0.0), "length"),
        (wire(pulley(GROUND, (0, 0, 0), 0.1), eye("block")), r"path\.0\.radius: a pulley at an end"),
        (wire(eye(GROUND), pulley(GROUND, (0, 0, -0.2), 0.3), eye("block")), "inside the circle"),
        (wire(eye(GROUND), pulley(GROUND, (1, 0, 0), 0.3, 0.0), eye("block")), "axis"),
        (
            wire(eye(GROUND), eye("block"), winch=Winch(np.array([0.0, 0.0]), np.array([1.0, 1.0]))),
            "winch.times: times.*increasing times",
        ),
    ],
)
def test_ropes(rope: Any, message: str | None) -> None:
    if message is None:
        pack_scene(scene([LOAD], ropes=[wire(eye(GROUND), eye(GROUND, (1, 0, 0)), eye("block"))]))
    else:
        refused(message, ropes=[rope])


def test_spring_rope_needs_a_stiffness() -> None:
    ends = {"path": (RopePoint(GROUND, np.zeros(3)), RopePoint("block", np.zeros(3)))}
    refused("stiffness", ropes=[SpringRope(name="sling", length=5.0, stiffness=0.0, **ends)])
    pack_scene(scene([LOAD], ropes=[SpringRope(name="sling", length=5.0, stiffness=1.0, **ends)]))


@pytest.mark.parametrize(
    ("force", "message"),
    [
        (spring(stiffness=0.0), None),  # the first of a sweep
        (spring(stiffness=-1.0), "stiffness"),
        (spring(length=-1.0), "length"),
        (spring(point_b=np.array([0, 0, 10.0])), "0 m apart at the start"),
        (
            spring(elongations=np.array([0.0, 1.0]), forces=np.array([0.0, 1.0])),
            "both 'stiffness' and a table",
        ),
        (
            spring(stiffness=0.0, elongations=np.array([0, 1, 2.0]), forces=np.array([0, 5, 4.0])),
            "the force falls from 5 to 4 between 1 and 2",
        ),
        (
            spring(stiffness=0.0, elongations=np.array([0, 0.0]), forces=np.array([0, 5.0])),
            "increasing elongations",
        ),
        (JointSpring(name="spring", joint="slide", stiffness=1.0), None),
        (
            JointSpring(name="spring", joint="ball", stiffness=1.0),
            "a Ball, which has no single angle or travel",
        ),
        (
            JointMotor(name="motor", joint="slide", times=np.array([1.0, 0.0]), loads=np.zeros(2)),
            "increasing times",
        ),
    ],
)
def test_forces(force: Any, message: str | None) -> None:
    joints = [slider(), Ball(name="ball", body_a=GROUND, body_b="block")]
    if message is None:
        pack_scene(scene([LOAD], [force], joints))
    else:
        refused(message, forces=[force], joints=joints)


def test_limits_and_friction() -> None:
    refused("lower below upper", joints=[slider(limits=Limits(1.0, -1.0))])
    refused("limits.damping", joints=[slider(limits=Limits(-1.0, 1.0, damping=-1.0))])
    refused("friction", joints=[slider(friction=-1.0)])
