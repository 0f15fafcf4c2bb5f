"""A ball on a rope touches a wall: the rope stays taut, and the rebound is that of the ball alone."""

from __future__ import annotations

import numpy as np
import pytest
from contact_scenes import DOWN, MASS, RADIUS, G, ball, run, touch

from heavylift.contours.splines.neutral import neutral_surface
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.scene.connections import RopePoint
from heavylift.solver.scene.contacts import Contour, RigidLaw
from heavylift.solver.scene.scene import Gravity, Scene

pytestmark = pytest.mark.slow

LENGTH, STIFFNESS = 2.0, 1e7


def wall(x):
    """Vertical plane whose material lies beyond x [m]; it faces backwards along x."""
    y, z = np.meshgrid(np.linspace(-1.0, 1.0, 6), np.linspace(-3.0, 0.0, 6), indexing="ij")
    points = np.stack([np.full_like(y, x), y, z], -1)
    return Contour(name="wall", body="ground", neutral=neutral_surface(points), flip=True)


def swinging(angle, law, at=RADIUS):
    """From an angle [rad] on the near side, the rope already stretched by the weight."""
    rope = Rope(
        name="rope",
        path=(RopePoint("ground", np.zeros(3)), RopePoint("ball", np.zeros(3))),
        axial_stiffness=STIFFNESS,
        length=LENGTH,
        damping=200.0,
    )
    place = LENGTH * np.array([-np.sin(angle), 0.0, -np.cos(angle)])
    return Scene(
        bodies=(ball(place),),
        forces=(Gravity(DOWN),),
        ropes=(rope,),
        contours=(wall(at),),
        contacts=(touch("wall", law=law),),
    )


@pytest.mark.parametrize("restitution", [0.5, 1.0])
def test_rebound_from_a_wall_at_the_lowest_point(restitution):
    angle = 0.4
    found = run(swinging(angle, RigidLaw(restitution)), 1e-3, 2.4)
    x, _, z = found["ball.position"].T
    turned = np.arctan2(-x, -z)
    back = found.times > 1.0
    # one impact of the ball alone: energy e^2, which the next turn shows
    expected = np.arccos(1.0 - restitution**2 * (1.0 - np.cos(angle)))
    assert abs(turned[back].max() - expected) < 3e-3 * expected
    assert np.isclose(
        found["touch.impulse"][back][0],
        (1.0 + restitution) * MASS * np.sqrt(2.0 * G * LENGTH * (1.0 - np.cos(angle))),
        rtol=3e-3,
    )
    assert found["touch.gap"].min() > -1e-6
    assert found.drift < 1e-4 * MASS * G * LENGTH


def test_ball_leans_on_a_wall_with_the_force_of_its_rope():
    """Pressed off its plumb line: N = m g tan of the angle of the rope."""
    angle = 0.2
    law = RigidLaw()
    place = -LENGTH * np.sin(angle)
    scene = swinging(angle + 0.05, law, at=place + RADIUS)
    found = run(scene, 1e-3, 4.0)
    x, _, z = found["ball.position"][-1]
    assert abs(x - place) < 1e-6
    # swings up and down along the wall no more than the impact has left: the ball lies in the plane of the rope
    assert np.isclose(
        found["touch.normal_force"][-100:].mean(), MASS * G * np.tan(np.arctan2(-x, -z)), rtol=2e-2
    )
    assert found.drift < 1e-4 * MASS * G * LENGTH
