"""Joints that hold directions of a body with modes: right where the frame is the place, refused where modes turn it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.sparse import eye_array
from solid_beams import BENDING, LENGTH, beam, cantilever

from heavylift.modal.invariants import shape_integrals
from heavylift.numerics.outcome import InputError
from heavylift.solver.forces.point import PointForce
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.distance import Distance
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.guide import Guide
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.planar import Planar
from heavylift.solver.joints.slider import Slider
from heavylift.solver.joints.universal import Universal
from heavylift.solver.layout import Layout, pack_scene
from heavylift.solver.scene.connections import JointFrame, axes_about
from heavylift.solver.scene.scene import FlexibleBody, Free, Gravity, RigidBody, Scene, Sensor
from heavylift.solver.sensors.relative_motions import RelativeMotion
from heavylift.solver.simulation import Simulation

ROOT, TIP = np.zeros(3), np.array([LENGTH, 0.0, 0.0])
TURNING = (FixedJoint, Hinge, Slider, Planar, Guide)


def arm(at: Any) -> RigidBody:
    return RigidBody("arm", 2.0, 1e-3 * np.eye(3), position=np.array(at, dtype=float))


def packed(
    kind: Any, at: Any, body: FlexibleBody | None = None, *, first: bool = True, axis: Any = (0, 1, 0)
) -> Layout:
    """A rigid body at a place of the beam, by one joint."""
    frame = JointFrame(np.array(at, dtype=float), axes_about(np.array([0.0, 1.0, 0.0])))
    other = JointFrame(np.zeros(3), frame.axes)
    sides: dict[str, Any] = {"body_a": "beam", "frame_a": frame, "body_b": "arm", "frame_b": other}
    if not first:
        sides = {"body_b": "beam", "frame_b": frame, "body_a": "arm", "frame_a": other}
    return pack_scene(Scene((body or beam(cantilever()), arm(at)), joints=(kind(name="bolt", **sides),)))


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize("kind", TURNING)
def test_joint_that_holds_a_turning_direction_is_refused(kind: Any, first: bool) -> None:
    with pytest.raises(
        InputError, match=r"bolt.*\(1000, 0, 0\) mm.*modes turn it.*no moment.*'ball' joint and three rods"
    ):
        packed(kind, TIP, first=first)


@pytest.mark.parametrize("kind", TURNING)
def test_joint_where_the_frame_is_clamped_goes_on(kind: Any) -> None:
    packed(kind, ROOT)
    packed(kind, (0.0, 0.01, -0.005))  # off its nodes too


@pytest.mark.parametrize("kind", TURNING)
def test_no_place_of_a_free_body_is_its_frame(kind: Any) -> None:
    with pytest.raises(InputError, match="modes turn it"):
        packed(kind, ROOT, beam(cantilever(free=True), motion=Free()))


def test_joints_of_points_go_on() -> None:
    packed(Ball, TIP)
    frames = {"frame_a": JointFrame(TIP), "frame_b": JointFrame(np.array([0.1, 0.0, 0.0]))}
    rod = Distance(name="rod", body_a="beam", body_b="arm", **frames)
    pack_scene(Scene((beam(cantilever()), arm(TIP)), joints=(rod,)))


@pytest.mark.slow
def test_ball_and_three_rods_pass_the_moment() -> None:
    """An arm of 0.5 m with F at its end: tip F L^3 / 3 E I + F a L^2 / 2 E I, end a (F L^2 / 2 + F a L) / E I more."""
    corners = np.array([[LENGTH, -0.01, -0.01], [LENGTH, 0.01, -0.01], [LENGTH, 0.0, 0.01]])
    reduced = cantilever(points=tuple(map(tuple, corners.tolist())))
    weight = RigidBody("arm", 2.0, 1e-3 * np.eye(3), centre_of_mass=np.array([0.5, 0.0, 0.0]), position=TIP)
    ends = [(corners[1], (50.0, 0.0, 0.0)), (corners[1], (0.0, 0.0, -50.0)), (corners[2], (50.0, 0.0, 0.0))]
    joints: list[Any] = [
        Ball(
            name="ball",
            body_a="beam",
            body_b="arm",
            frame_a=JointFrame(corners[0]),
            frame_b=JointFrame(corners[0] - TIP),
        )
    ]
    for k, (place, along) in enumerate(ends):  # long rods, so that they turn by next to nothing
        frames = {"frame_a": JointFrame(place), "frame_b": JointFrame(place + np.array(along) - TIP)}
        joints.append(Distance(name=f"rod{k}", body_a="beam", body_b="arm", **frames))
    seen = (Sensor("tip", "beam", TIP), Sensor("load", "arm", np.array([0.5, 0.0, 0.0])))
    bodies = beam(reduced), weight
    pull = PointForce("pull", "arm", np.array([0.5, 0.0, 0.0]), force=np.array([0.0, 0.0, -19.62]))
    run = Simulation(Scene(bodies, (pull,), seen, tuple(joints)), 1e-4, start="equilibrium")
    row = run.record()
    height = {c.name: row[c.column + 2] for c in run.channels if c.name.endswith(".position")}
    force, a, L = 19.62, 0.5, LENGTH
    tip = -force * (L**3 / 3.0 + a * L**2 / 2.0) / BENDING
    np.testing.assert_allclose(height["tip.position"], tip, rtol=2e-3)
    load = tip - a * force * (L**2 / 2.0 + a * L) / BENDING
    np.testing.assert_allclose(height["load.position"], load, rtol=2e-3)


def test_universal_joint_at_the_tip_is_refused() -> None:
    frames = {
        "frame_a": JointFrame(TIP, axes_about(np.array([0.0, 1.0, 0.0]))),
        "frame_b": JointFrame(np.zeros(3), axes_about(np.array([0.0, 0.0, 1.0]))),
    }
    cross = Universal(name="bolt", body_a="beam", body_b="arm", **frames)
    with pytest.raises(InputError, match="modes turn it"):
        pack_scene(Scene((beam(cantilever()), arm(TIP)), joints=(cross,)))


def test_direction_that_no_mode_turns_is_kept() -> None:
    """With two bending modes in the plane x z, y stays y and x does not."""
    whole = cantilever()
    # the two lowest modes are any two across each other: their combination that does not move along y
    tip = whole.shapes_at(*whole.locate(TIP))[:2]
    across = np.array([tip[1, 1], -tip[0, 1]]) / np.hypot(*tip[:, 1])
    shape = np.tensordot(across, whole.mode_shapes[:2], axes=1)[None]
    flat = replace(
        whole,
        eigenvalues=whole.eigenvalues[:1],
        mode_shapes=shape,
        integrals=shape_integrals(whole.nodes, shape, eye_array(whole.node_count).tocsr()),
        labels=("bending",),
        residuals=np.zeros(1),
    )
    nodes, weights = flat.locate(TIP)
    assert not flat.turns(nodes, weights, (0.0, 1.0, 0.0))
    assert flat.turns(nodes, weights, (1.0, 0.0, 0.0))
    assert flat.turns(nodes, weights, (0.0, 0.0, 1.0))


def test_rotation_of_a_place_is_the_slope_of_the_beam() -> None:
    """Slope over deflection of the tip, Euler-Bernoulli: 1.37651 / L in the first mode, 4.78139 / L in the second."""
    body = cantilever(elements=40)
    nodes, weights = body.locate(TIP)
    turn, moved = body.turn_at(nodes, weights), body.shapes_at(nodes, weights)
    for mode, expected in ((0, 1.37651), (1, 1.37651), (2, 4.78139), (3, 4.78139)):
        # w' = - theta_y of z, + theta_z of y
        slope = np.array([turn[mode, 2], -turn[mode, 1]])
        np.testing.assert_allclose(slope, expected * moved[mode, 1:], rtol=0.02, atol=1e-6)
    assert np.abs(body.turn_at(*body.locate(ROOT))).max() == 0.0


def test_measures_take_the_axes_of_the_frame_and_say_so() -> None:
    seen = RelativeMotion(name="seen", body_a="ground", body_b="beam", point_a=np.zeros(3), point_b=TIP)
    layout = pack_scene(Scene((beam(cantilever()),), (Gravity(np.array([0.0, 0.0, -9.81])), seen)))
    assert any("'seen' on the flexible body 'beam' are those of its frame" in note for note in layout.notes)


def test_triangle_of_ball_joints_is_told() -> None:
    """Its sides cannot lengthen as linear modes lengthen them: a stiffness that no solid has."""
    places = np.array([[LENGTH, -0.01, -0.01], [LENGTH, 0.01, -0.01], [LENGTH, 0.0, 0.01]])
    joints = tuple(
        Ball(name=f"b{k}", body_a="beam", body_b="arm", frame_a=JointFrame(p), frame_b=JointFrame(p - TIP))
        for k, p in enumerate(places)
    )
    layout = pack_scene(Scene((beam(cantilever()), arm(TIP)), joints=joints))
    assert any("joints 'b0', 'b1', 'b2' hold points" in note for note in layout.notes)
    assert not pack_scene(Scene((beam(cantilever()), arm(TIP)), joints=joints[:1])).notes
