"""Which contacts can share what they lose and gain: those of bodies that contacts, joints and ropes connect."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from contact_scenes import ball, surface, touch
from mesh_contact_scenes import body, scene

from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.solver.force_elements.wire_rope import SpringRope
from heavylift.solver.joints.ball import Ball
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.bodies import Driven, Harmonic, Profile
from heavylift.solver.scene.connections import JointFrame, RopePoint

BOXES = [(body(name, (2.0 * i, 0.0, 1.5)), box_surface(1.0)) for i, name in enumerate("abcd")]
FLOOR = plane_surface(60.0)
ON_FLOOR = [("floor", name) for name in "abcd"]


def islands(of):
    """Numbers of the islands, in order of their first contact or pair."""
    found = pack_scene(of, "dele2").systems[1].islands
    _, first, number = np.unique(found, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[number].tolist()


def test_the_ground_connects_nothing():
    assert islands(scene(BOXES, FLOOR, ON_FLOOR)) == [0, 1, 2, 3]


def test_what_may_touch_is_connected():
    assert islands(scene(BOXES, FLOOR, [*ON_FLOOR, ("a", "c"), ("c", "d")])) == [0, 1, 0, 0, 0, 0]


def test_a_moved_body_connects_nothing():
    swings = Driven(z=Profile(harmonics=(Harmonic(0.1, 1.0),)))
    moved = [(replace(BOXES[0][0], motion=swings), BOXES[0][1]), *BOXES[1:]]
    assert islands(scene(moved, FLOOR, [("a", "b"), ("a", "c"), ("c", "d"), ("floor", "d")])) == [0, 1, 1, 1]


@pytest.mark.parametrize("by", ["joint", "rope", "rope over a third body"])
def test_joints_and_ropes_connect(by):
    of = scene(BOXES[:3], FLOOR, ON_FLOOR[:3])
    if by == "joint":
        frames = (JointFrame(np.array([1.0, 0.0, 0.0])), JointFrame(np.array([-1.0, 0.0, 0.0])))
        joint = Ball(name="link", body_a="a", body_b="b", frame_a=frames[0], frame_b=frames[1])
        assert islands(replace(of, joints=(joint,))) == [0, 0, 1]
        return
    through = ["a", "b"] if by == "rope" else ["a", "b", "c"]
    path = tuple(RopePoint(name, np.zeros(3)) for name in through)
    rope = SpringRope(name="sling", path=path, length=9.0, stiffness=1e5)
    assert islands(replace(of, ropes=(rope,))) == ([0, 0, 1] if by == "rope" else [0, 0, 0])


def test_contours_and_triangles_are_of_one_graph():
    """A ball on a contour of a box, another on the ground; boxes on a floor."""
    of = scene(BOXES[:2], FLOOR, ON_FLOOR[:2])
    of = replace(
        of,
        bodies=(*of.bodies, ball((0.0, 0.0, 3.0)), ball((5.0, 0.0, 3.0), name="other")),
        contours=(surface(), surface(name="lid", body="b")),
        contacts=(touch(body="other", name="alone"), touch("lid")),
    )
    assert islands(of) == [0, 1, 2, 1]
