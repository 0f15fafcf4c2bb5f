"""Joints as a user says them: which start is refused and how, which file serves which joint."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from joint_scenes import CLOSED, LEAD, LENGTH, RESIDUALS, Pose, make_joint, turn

from heavylift.numerics.outcome import InputError
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.distance import Distance
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.packing import JointPlace, MarkerBook, start_frames, travel_direction
from heavylift.solver.joints.registry import joint_module
from heavylift.solver.joints.screw import Screw
from heavylift.solver.joints.slider_hinge import SliderHinge
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.connections import GROUND, Joint, JointFrame
from heavylift.solver.scene.scene import Driven, Fixed, Harmonic, Profile, RigidBody, Scene

NAMES = sorted(RESIDUALS)


def body(name: str = "b", **given: Any) -> RigidBody:
    return RigidBody(name, 1.0, np.eye(3), **given)


def closed(name: str, error: np.ndarray | None = None) -> Joint:
    """A joint on the ground whose side b is turned away from its closed pose in its own frame."""
    point, rotation = CLOSED[name]
    axes = turn(np.array([0.3, -0.2, 0.9]))
    given = np.eye(3) if error is None else turn(error)
    b = JointFrame(axes @ point, axes @ turn(rotation) @ given)
    return make_joint(name, GROUND, "b", JointFrame(np.zeros(3), axes), b)


def refused(joint: Joint, *bodies: RigidBody) -> InputError:
    with pytest.raises(InputError) as caught:
        pack_scene(Scene(bodies or (body(),), joints=(joint,)))
    assert caught.value.source == joint.name
    return caught.value


@pytest.mark.parametrize("name", NAMES)
def test_closed_start_is_taken(name: str) -> None:
    """Also one that is off by a little; the record has a reaction and what the joint leaves free."""
    for error in (np.zeros(3), np.array([0.02, -0.03, 0.01])):
        layout = pack_scene(Scene((body(),), joints=(closed(name, error),)))
        assert len(layout.joints) == 1
    channels = [channel.name for channel in layout.channels if channel.name.startswith(f"{name}.")]
    expected = ["reaction_force", "reaction_moment"]
    if "hinge" in name or name in {"cylindrical", "screw"}:
        expected += ["angle", "angular_rate"]
    if "slider" in name or name in {"cylindrical", "guide", "screw"}:
        expected += ["travel", "travel_rate"]
    if name == "screw":
        expected += ["thread_force"]
    assert channels == [f"{name}.{quantity}" for quantity in expected]


@pytest.mark.parametrize(
    ("name", "axis"),
    [
        *[(name, 0) for name in ("hinge", "driven_hinge", "cylindrical", "slider_hinge", "planar")],
        *[(name, k) for name in ("slider", "driven_slider", "fixed") for k in range(3)],
    ],
)
def test_start_with_opposite_axes_is_refused(name: str, axis: int) -> None:
    """All inner products of the rows vanish there too: half a turn about an axis of the joint."""
    joint = closed(name, np.pi * np.eye(3)[axis])
    a, b = start_frames(joint, [body()])
    residual = RESIDUALS[name](Pose(a.point, a.axes), Pose(b.point, b.axes), 0.0)
    np.testing.assert_allclose(residual[:5], 0.0, atol=1e-12)
    error = refused(joint)
    assert "180 deg apart" in str(error)
    assert error.key == "axes"


def test_universal_joint_with_parallel_axes_is_refused() -> None:
    error = refused(closed("universal", np.array([np.pi / 2, 0.0, 0.0])))
    assert error.key == "axes"
    assert "perpendicular" in error.expected


def test_distance_without_direction_is_refused() -> None:
    joint = closed("distance")
    together = replace(joint, frame_b=joint.frame_a)
    assert refused(together).key == "points"
    assert refused(replace(together, length=None)).key == "points"
    assert refused(replace(joint, length=0.0)).key == "length"
    assert refused(replace(joint, length=-1.0)).key == "length"
    assert refused(replace(joint, length=np.nan)).key == "length"


def test_distance_of_the_start_is_kept_if_none_is_given() -> None:
    """Between the points as they start, the body turned and shifted."""
    thing = body(position=np.array([1.0, 2.0, 2.0]), orientation=np.array([0.0, 0.0, 0.0, 1.0]))
    joint = Distance(name="d", body_a=GROUND, body_b="b", frame_b=JointFrame(np.array([1.0, 2.0, 3.0])))
    frames = start_frames(joint, [thing])
    kind = joint_module(joint).pack([joint], [JointPlace(0, 0, frames)], MarkerBook())
    np.testing.assert_allclose(
        kind.table["length"], 5.0, rtol=1e-14
    )  # half a turn about z: from (0, 0, 5) to the ground
    kind = joint_module(joint).pack([closed("distance")], [JointPlace(0, 0, frames)], MarkerBook())
    np.testing.assert_allclose(kind.table["length"], LENGTH)


def test_driven_body_holds_a_joint_where_its_drive_starts() -> None:
    """The pose of a driven body is that for zero displacement; the drive may begin elsewhere."""
    lift = Profile(harmonics=(Harmonic(0.5, 1.0, np.pi / 2),))
    thing = body(motion=Driven(z=lift), position=np.array([1.0, 0.0, 0.0]))
    joint = Ball(name="j", body_a=GROUND, body_b="b", frame_b=JointFrame(np.array([0.0, 1.0, 0.0])))
    np.testing.assert_allclose(start_frames(joint, [thing])[1].point, [1.0, 1.0, 0.5])


def test_unknown_body_is_refused() -> None:
    joint = Ball(name="j", body_a=GROUND, body_b="ghost")
    with pytest.raises(InputError) as caught:
        pack_scene(Scene((body(),), joints=(joint,)))
    assert "ghost" in str(caught.value)


def test_joint_that_holds_nothing_free_is_refused() -> None:
    assert refused(Ball(name="j", body_a=GROUND, body_b="b"), body(motion=Fixed())).key == "between"


@pytest.mark.parametrize("axis", [np.zeros(3), np.array([np.nan, 0.0, 1.0])])
def test_slide_axis_without_direction_is_refused(axis: np.ndarray) -> None:
    joint = SliderHinge(name="j", body_a=GROUND, body_b="b", slide_axis=axis)
    assert refused(joint).key == "slide_axis"


def test_slide_axis_may_have_any_length() -> None:
    joint = SliderHinge(name="j", body_a=GROUND, body_b="b", slide_axis=np.array([0.0, -3.0, 4.0]))
    np.testing.assert_allclose(travel_direction(joint), [0.0, -0.6, 0.8])


def test_unknown_type_is_refused() -> None:
    assert refused(Joint(name="j", body_a=GROUND, body_b="b")).key == "type"


def test_drive_chooses_another_file_with_a_row_more() -> None:
    """And the same channels."""
    still, driven = closed("hinge"), closed("driven_hinge")
    assert isinstance(still, Hinge)
    assert isinstance(driven, Hinge)
    assert joint_module(driven) is not joint_module(still)
    assert driven.rotational == (*still.rotational, True)
    assert driven.CHANNELS == still.CHANNELS
    still, driven = closed("slider"), closed("driven_slider")
    assert joint_module(driven) is not joint_module(still)
    assert driven.rotational == (*still.rotational, False)


def test_a_screw_needs_a_lead() -> None:
    for lead in (0.0, np.nan, np.inf):
        joint = Screw(name="j", body_a=GROUND, body_b="b", lead=lead)
        assert refused(joint).key == "lead"


@pytest.mark.parametrize("key", ["compliance", "relaxation"])
def test_a_screw_is_rigid(key: str) -> None:
    """A soft thread would slip to another turn, and nobody could tell."""
    assert refused(replace(closed("screw"), **{key: 1e-6})).key == key


@pytest.mark.parametrize("turns", [-3, 1, 2])
def test_a_screw_starts_on_the_turn_of_its_angle(turns: int) -> None:
    joint = closed("screw")
    away = replace(
        joint,
        frame_b=replace(joint.frame_b, point=joint.frame_b.point - turns * LEAD * joint.frame_b.axes[:, 2]),
    )
    error = refused(away)
    assert error.key == "points"
    assert "turns" in error.problem
