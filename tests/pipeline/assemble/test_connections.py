"""Joints, ropes and loads arrive in body frames: two ways to describe one place give the same place."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import numpy as np
import pytest

from heavylift.pipeline import load_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.force_elements.wire_rope import Rope, SpringRope
from heavylift.solver.forces.motor import JointMotor
from heavylift.solver.forces.spring import JointSpring, Spring
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.slider import Slider


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "linkage"
    folder.mkdir()
    shutil.copyfile(Path(__file__).parents[1] / "linkage.toml", folder / "case.toml")
    return folder


def scene_of(folder, *overrides):
    return assemble_scene(load_case(folder, overrides), OutputFolder(folder / "out"))


def world_frame(scene, joint, side):
    """Point and axes of a joint frame in the world, from the pose the body starts with."""
    name, frame = (joint.body_a, joint.frame_a) if side == "a" else (joint.body_b, joint.frame_b)
    if name == "ground":
        return frame.point, frame.axes
    body = next(body for body in scene.bodies if body.name == name)
    w, x, y, z = body.orientation
    R = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    return body.position + R @ frame.point, R @ frame.axes


def test_a_place_in_the_world_is_the_same_on_both_sides(folder):
    scene = scene_of(folder)
    hinge = scene.joints[0]
    assert isinstance(hinge, Hinge)
    for side in "ab":
        point, axes = world_frame(scene, hinge, side)
        np.testing.assert_allclose(point, 0.0, atol=1e-15)
        np.testing.assert_allclose(axes[:, 2], [0, 0, 1], atol=1e-15)
        np.testing.assert_allclose(axes[:, 0], [0, 1, 0], atol=1e-15)
    # the foot of the arm lies half a metre from its centre of mass, where its frame is
    np.testing.assert_allclose(hinge.frame_b.point, [-0.5, 0, 0], atol=1e-15)
    assert (hinge.limits.lower, hinge.limits.upper) == (-math.pi / 6, math.pi / 6)
    assert (hinge.limits.stiffness, hinge.limits.damping, hinge.friction) == (1e6, 1e4, 10.0)


def test_points_and_axes_of_bodies_are_in_coordinates_of_their_geometry(folder):
    scene = scene_of(folder)
    rail = scene.joints[1]
    assert isinstance(rail, Slider)
    np.testing.assert_allclose(rail.frame_a.point, [0.5, 0, 0], atol=1e-15)  # less the centre of mass
    for side in "ab":
        point, axes = world_frame(scene, rail, side)
        np.testing.assert_allclose(point, [0, 0, 1], atol=1e-15)
        np.testing.assert_allclose(axes[:, 2], [0, 1, 0], atol=1e-15)
        np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(world_frame(scene, rail, "a")[1], world_frame(scene, rail, "b")[1], atol=1e-15)
    assert rail.limits.lower == -np.inf
    np.testing.assert_array_equal(rail.drive.values, [0.0, 0.1])


@pytest.mark.parametrize(
    ("kind", "keys"),
    [
        ("ball", {}),
        ("fixed", {}),
        ("cylindrical", {"axis": [1, 2, 3]}),
        ("planar", {"axis": [1, 2, 3]}),
        ("hinge", {"axis": [1, 2, 3]}),
        ("slider", {"axis": [1, 2, 3]}),
        ("universal", {"axis": [0, 0, 1], "second_axis": [0, 3, 0]}),
        ("slider_hinge", {"axis": [0, 0, 1], "slide_axis": [2, 1, 0]}),
    ],
)
def test_every_type_of_joint_fits_at_the_start_whatever_the_pose(folder, kind, keys):
    text = ", ".join(f"{key} = {value}" for key, value in keys.items())
    joint = (
        f'joints=[{{type="{kind}", name="j", between=["arm", "trolley"], at=[0.1, 0.2, 0.3]'
        f'{", " if text else ""}{text}, compliance="1e-9 m/N", relaxation="10 ms"}}]'
    )
    turn = "bodies.trolley.initial.orientation={axis=[1, 1, 0], angle=0.7}"
    scene = scene_of(folder, joint, turn, "forces=[]")
    (found,) = scene.joints
    (point_a, axes_a), (point_b, axes_b) = (world_frame(scene, found, side) for side in "ab")
    np.testing.assert_allclose(point_a, [0.1, 0.2, 0.3], atol=1e-15)
    np.testing.assert_allclose(point_b, point_a, atol=1e-15)
    assert (found.compliance, found.relaxation) == (1e-9, 1e-2)
    if kind == "universal":
        np.testing.assert_allclose(axes_a[:, 2], [0, 0, 1], atol=1e-15)
        np.testing.assert_allclose(axes_b[:, 2], [0, 1, 0], atol=1e-15)
        return
    np.testing.assert_allclose(axes_a, axes_b, atol=1e-15)
    if "axis" in keys:
        axis = np.array(keys["axis"]) / np.linalg.norm(keys["axis"])
        np.testing.assert_allclose(axes_a[:, 2], axis, atol=1e-15)
    if kind == "slider_hinge":
        slide = axes_a @ found.slide_axis
        np.testing.assert_allclose(slide, [2, 1, 0], atol=1e-14)


def test_a_driven_body_is_where_it_is_driven_at_the_start(folder):
    frame = (
        'bodies.arm.frame={motion="driven", axis=[1, 0, 0], pivot=[0, 1, 0], '
        'angle={times=[0, 1], values=["90 deg", 0]}, x={harmonics=[{amplitude=2, frequency=1, phase="30 deg"}]}}'
    )
    place = "bodies.arm.initial={position=[0, 3, 0]}"
    joints = 'joints=[{type="ball", name="j", between=["ground", "arm"], at=[1, 1, 3]}]'
    (joint,) = scene_of(folder, frame, place, joints, "forces=[]").joints
    # (0, 3, 0) turned by 90 degrees about x through (0, 1, 0) is (0, 1, 2); the sine begins at 2 sin 30 degrees
    np.testing.assert_allclose(joint.frame_b.point, [0, 1, 0], atol=1e-14)


def test_ropes_run_through_body_points(folder):
    scene = scene_of(folder)
    fall, tag = scene.ropes
    assert isinstance(fall, Rope)
    assert [stop.body for stop in fall.path] == ["ground", "trolley", "load"]
    assert fall.path[1].radius == 0.2
    np.testing.assert_array_equal(fall.path[1].axis, [1, 0, 0])
    assert (fall.axial_stiffness, fall.damping, fall.length) == (1e6, 1e4, None)
    np.testing.assert_array_equal(fall.winch.speeds, [0, 0.05])
    assert isinstance(tag, SpringRope)
    assert tag.length == 10.0  # as drawn
    assert tag.stiffness == 1e3


def test_loads_between_and_along(folder):
    scene = scene_of(folder)
    _, push, spring, detent, motor = scene.forces
    np.testing.assert_array_equal(push.forces, [[1.0, 0, 0]])
    assert isinstance(spring, Spring)
    assert spring.length == 3.0  # as drawn
    assert (spring.stiffness, spring.damping) == (2.0, 3.0)
    assert isinstance(detent, JointSpring)
    assert detent.rest == pytest.approx(math.pi / 18)
    np.testing.assert_array_equal(detent.loads, [-5.0, 5.0])
    assert isinstance(motor, JointMotor)
    np.testing.assert_array_equal(motor.loads, [20.0])


def test_units_along_a_joint_follow_the_joint(folder):
    along = 'forces=[{type="joint_spring", name="s", joint="%s", rest="%s", stiffness="%s", damping="%s"}]'
    slides = scene_of(folder, along % ("rail", "1 cm", "2 kN/m", "3 N s/m")).forces[-1]
    assert (slides.rest, slides.stiffness, slides.damping) == (0.01, 2e3, 3.0)
    turns = scene_of(folder, along % ("foot", "180 deg", "2 kN m/rad", "3 N m s/rad")).forces[-1]
    assert (turns.rest, turns.stiffness, turns.damping) == (math.pi, 2e3, 3.0)
