"""Collisions beside joints, a rope, and a contact with a contour: one kind of scene, compiled once."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from mesh_contact_scenes import DOWN, MASS, G, ball, body, run, turn

from heavylift.contours.splines.neutral import neutral_surface
from heavylift.numerics.rotation import rotation_matrix
from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.joints.ball import Ball
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.connections import JointFrame, RopePoint, Winch
from heavylift.solver.scene.contacts import Contact, Contour, LinearLaw, RigidLaw, SphereShape
from heavylift.solver.scene.scene import Gravity, Scene
from heavylift.solver.simulation import Simulation

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1800)]

STEP = 0.01
WEIGHT = MASS * G
LENGTH, WIDTH, LINK = 2.0, 0.2, 50.0
TILT = np.radians(20.0)
STIFFNESS = 1e6
"""EA of the rope [N]."""


def roof(drop: float) -> tuple[Any, Any]:
    """Two links that lean on each other, joined at the ridge; their feet are at a height [m]."""
    left = body("left", size=(LENGTH, WIDTH, WIDTH), mass=LINK, orientation=turn((0.0, 1.0, 0.0), -TILT))
    right = body("right", size=(LENGTH, WIDTH, WIDTH), mass=LINK, orientation=turn((0.0, 1.0, 0.0), TILT))
    to_ridge = rotation_matrix(left.orientation) @ np.array([LENGTH / 2.0, 0.0, 0.0])
    skin = box_surface((LENGTH, WIDTH, WIDTH)).points
    lowest = (skin @ rotation_matrix(left.orientation).T)[:, 2].min()
    ridge = np.array([-3.0, 0.0, drop - lowest + to_ridge[2]])
    mirrored = to_ridge * (-1.0, 1.0, 1.0)
    return replace(left, position=ridge - to_ridge), replace(right, position=ridge - mirrored)


def site(law: Any = None, events: bool = True, left_over: float = 0.5) -> Scene:
    """A box is set down by a winch until a part of its weight hangs on the rope; a roof falls; a ball bounces.

    The floor is of triangles but for the ball, which falls on a spline.
    """
    law = law or RigidLaw()
    box, (left, right) = body("box", (5.0, 0.0, 0.7)), roof(0.3)
    hung = 6.0 - 1.2
    stretched = 1.0 + WEIGHT / STIFFNESS
    lowered = (hung + 0.2) / (1.0 + left_over * WEIGHT / STIFFNESS) - hung / stretched
    speed = 0.1
    rope = Rope(
        name="rope",
        path=(RopePoint("ground", np.array([5.0, 0.0, 6.0])), RopePoint("box", np.array([0.0, 0.0, 0.5]))),
        axial_stiffness=STIFFNESS,
        length=hung / stretched,
        damping=2e4,
        winch=Winch(
            np.array([0.0, 0.5, lowered / speed, 0.5 + lowered / speed]), np.array([0.0, -speed, -speed, 0.0])
        ),
    )
    x, y = np.meshgrid(np.linspace(-2.0, 2.0, 6), np.linspace(3.0, 7.0, 6), indexing="ij")
    spline = Contour(name="spline", body="ground", neutral=neutral_surface(np.stack([x, y, 0.0 * x], -1)))
    ridge = (
        JointFrame(point=np.array([LENGTH / 2.0, 0.0, 0.0])),
        JointFrame(point=np.array([-LENGTH / 2.0, 0.0, 0.0])),
    )
    skin = box_surface((LENGTH, WIDTH, WIDTH))
    surfaces = {"floor": plane_surface(20.0), "box": box_surface(1.0), "left": skin, "right": skin}
    return Scene(
        bodies=(box, left, right, ball("ball", (0.0, 5.0, 0.5), 0.3)),
        forces=(Gravity(np.array(DOWN)),),
        joints=(Ball(name="ridge", body_a="left", body_b="right", frame_a=ridge[0], frame_b=ridge[1]),),
        ropes=(rope,),
        contours=(spline,),
        contacts=(
            Contact(
                name="bounce",
                contour="spline",
                body="ball",
                shape=SphereShape(0.3),
                law=RigidLaw(restitution=0.5),
            ),
        ),
        surfaces=tuple(
            CollisionSurface(name=f"{name}_skin", body="ground" if name == "floor" else name, surface=surface)
            for name, surface in surfaces.items()
        ),
        collisions=tuple(
            Collision(
                name=f"{name}_lands",
                surfaces=("floor_skin", f"{name}_skin"),
                law=replace(law, events=events) if isinstance(law, RigidLaw) else law,
                friction=0.5,
            )
            for name in ("box", "left", "right")
        ),
    )


def ends_meet(found: Any) -> float:
    """Largest distance of the two points of the ridge [m]."""
    ends = []
    for name, x in (("left", LENGTH / 2.0), ("right", -LENGTH / 2.0)):
        R = np.array([rotation_matrix(q) for q in found[f"{name}.orientation"]])
        ends.append(found[f"{name}.position"] + x * R[:, :, 0])
    return float(np.abs(ends[0] - ends[1]).max())


@pytest.mark.parametrize(
    ("law", "events"),
    [
        pytest.param(RigidLaw(), True, id="rigid"),
        pytest.param(RigidLaw(restitution=0.5), True, id="bouncing"),
        pytest.param(RigidLaw(), False, id="no events"),
        pytest.param(LinearLaw(1e6, 2e4), True, id="compliant"),
    ],
)
def test_rope_and_floor_share_the_weight_and_joined_links_stand(law: Any, events: bool) -> None:
    found = run(site(law, events), STEP, 8.0)
    tension, force = found["rope.tension"][-1], found["box_lands.force"][-1, 2]
    if isinstance(law, RigidLaw):
        assert tension == pytest.approx(0.5 * WEIGHT, rel=1e-6)
    assert 0.1 * WEIGHT < tension < 0.9 * WEIGHT
    assert tension + force == pytest.approx(WEIGHT, rel=1e-6)
    links = found["left_lands.force"][-1] + found["right_lands.force"][-1]
    np.testing.assert_allclose(links, [0.0, 0.0, 2.0 * LINK * G], atol=1e-6 * WEIGHT)
    for name in ("box", "left", "right"):
        assert np.abs(found[f"{name}.velocity"][-1]).max() < 1e-6
    assert ends_meet(found) < 5e-3
    energy = found["energy.balance"]
    assert energy.max() - energy[0] < 1e-3 * WEIGHT


def test_the_ball_on_the_spline_does_not_care_for_the_collisions() -> None:
    found = run(site(), STEP, 0.5)
    z, v = found["ball.position"][:, 2] - 0.3, found["ball.velocity"][:, 2]
    flight = (found.times > 0.22) & (found.times < 0.4)
    np.testing.assert_allclose((z + v * v / (2.0 * G))[flight], 0.25 * 0.2, atol=1e-8)


def test_feet_of_a_roof_stop_it_with_the_impulse_of_its_one_coordinate() -> None:
    """Without friction, e = 0: both feet then slide apart while the ridge sinks; one coordinate by symmetry.

    Velocity ``q`` of a foot outwards; the foot stays on the floor. With a body that falls with v before, Gauss'
    principle of least change gives ``q = - v dz_c/dq m / M_qq`` for the height of the centre over q.
    """
    speed = np.sqrt(2.0 * G * 0.3)
    scene = site()
    without = tuple(replace(one, friction=0.0) for one in scene.collisions)
    found = run(replace(scene, collisions=without), 1e-3, 0.26)
    row = int(np.argmax(found["left_lands.impacts"] > 0.0))
    start = next(one for one in scene.bodies if one.name == "left")
    R = rotation_matrix(start.orientation)
    to_ridge = R @ np.array([LENGTH / 2.0, 0.0, 0.0])
    corners = box_surface((LENGTH, WIDTH, WIDTH)).points @ R.T
    foot = corners[np.argmin(corners[:, 2])]
    # unknowns of the left link: x and z velocity of its centre, turning w about y; the ridge moves in z alone
    turns = lambda r: np.array([r[2], -r[0]])  # noqa: E731  velocity in x and z of a point by w = 1
    inertia = start.inertia[1, 1]
    rows = np.array(
        [[1.0, 0.0, turns(to_ridge)[0]], [0.0, 1.0, turns(foot)[1]]]
    )  # ridge: v_x = 0; foot: v_z = 0
    mass = np.diag([LINK, LINK, inertia])
    before = np.array([0.0, -speed, 0.0])
    inverse = np.linalg.inv(mass)
    impulses = np.linalg.solve(rows @ inverse @ rows.T, rows @ before)
    after = before - inverse @ rows.T @ impulses
    t = found.times[row] - np.sqrt(2.0 * 0.3 / G)
    assert 0.0 <= t <= 1e-3
    np.testing.assert_allclose(found["left.velocity"][row, [0, 2]], after[:2], atol=0.02)
    np.testing.assert_allclose(found["left.angular_velocity"][row, 1], after[2], atol=0.02)
    assert found["left_lands.impulse"][row] == pytest.approx(-impulses[1], rel=2e-2)
    assert found["right_lands.impulse"][row] == pytest.approx(found["left_lands.impulse"][row], rel=1e-6)


@pytest.mark.parametrize("events", [True, False])
def test_a_saved_run_goes_on_bit_for_bit(events: bool) -> None:
    scene = site(RigidLaw(restitution=0.3), events)
    whole = Simulation(scene, STEP)
    _, expected = whole.advance(200)
    for cut in (25, 50, 130):
        first = Simulation(scene, STEP)
        first.advance(cut)
        state = first.state()
        first.advance(5)
        for simulation in (first, Simulation(scene, STEP)):
            simulation.restore(state)
            np.testing.assert_array_equal(simulation.advance(200 - cut)[1], expected[cut:])
