"""Beads on wires, balls in rings and on cylinders: contacts with curves of the ground."""

from __future__ import annotations

import numpy as np
import pytest
from contact_scenes import DOWN, MASS, RADIUS, G, ball, ring, run, tilted, touch
from scipy.integrate import solve_ivp

from heavylift.contours.splines.neutral import neutral_curve
from heavylift.solver.scene.contacts import BilateralLaw, Contact, Contour, RigidLaw
from heavylift.solver.scene.scene import Gravity, Scene

pytestmark = pytest.mark.slow

BOTTOM = -0.5 * np.pi
POINTS = 96


def exact(rates, start, times):
    return solve_ivp(rates, (0.0, times[-1]), start, t_eval=times, rtol=1e-11, atol=1e-12).y


def place(angle, radius):
    """On a circle about the origin, at an angle to its lowest point."""
    return radius * np.array([np.sin(angle), 0.0, -np.cos(angle)])


def bead(step, duration=3.0, angle=0.5, friction=0.0, speed=0.0, gravity=DOWN, seam=0.0, count=POINTS):
    start = ball(place(angle, 1.0), speed * np.array([np.cos(angle), 0.0, np.sin(angle)]), mass=1.0)
    scene = Scene(
        bodies=(start,),
        forces=(Gravity(gravity),),
        contours=(ring(count=count, start=seam),),
        contacts=(Contact(name="slide", contour="ring", body="ball", law=BilateralLaw(), friction=friction),),
    )
    return run(scene, step, duration)


def angle_of(found):
    x, _, z = found["ball.position"].T
    return np.arctan2(x, -z)


def test_bead_swings_as_a_pendulum_with_second_order():
    errors = []
    for step in (0.02, 0.01, 0.005):
        found = bead(step)
        swing = exact(lambda _, y: [y[1], -G * np.sin(y[0])], [0.5, 0.0], found.times)
        errors.append(np.abs(angle_of(found) - swing[0]).max())
        assert np.abs(np.linalg.norm(found["ball.position"], axis=1) - 1.0).max() < 1e-8 + 0.02 * step**2
        force = G * np.cos(swing[0]) + swing[1] ** 2
        # the interpolated circle has a curvature that waves by (2 pi / n)^2 / 12
        assert np.abs(found["slide.normal_force"] - force)[5:].max() < 0.04 * step / 0.02 * G
        assert found.drift < 2e-3 * step**2 / 0.02**2
    assert errors[2] < 5e-4
    assert 3.5 < errors[0] / errors[1] < 4.5
    assert 3.5 < errors[1] / errors[2] < 4.5


def test_bead_with_friction_before_it_turns():
    friction = 0.1

    def rates(_, y):
        return [y[1], -G * np.sin(y[0]) - friction * abs(G * np.cos(y[0]) + y[1] ** 2) * np.sign(y[1])]

    errors = []
    for step in (0.02, 0.01, 0.005):
        found = bead(step, duration=0.8, angle=-0.5, friction=friction, speed=0.5)
        angle, speed = exact(rates, [-0.5, 0.5], found.times)
        errors.append(np.abs(angle_of(found) - angle).max())
        before = 0.5 * 0.5**2 + G * (1.0 - np.cos(0.5))
        lost = before - 0.5 * speed[-1] ** 2 - G * (1.0 - np.cos(angle[-1]))
        assert abs(found["slide.dissipated"][-1] / lost - 1.0) < 0.05 * (step / 0.02)
    assert errors[2] < 2e-4
    assert errors[0] / errors[1] > 3.0
    assert errors[1] / errors[2] > 3.0


def test_bead_sticks_where_the_wire_is_flat_enough():
    """It rests where the slope of the wire is below the coefficient, and slides where it is above."""
    assert np.abs(angle_of(bead(0.01, duration=1.0, angle=0.28, friction=0.3)) - 0.28).max() < 1e-6
    assert angle_of(bead(0.01, duration=1.0, angle=0.32, friction=0.3))[-1] < 0.3


def test_bead_goes_round_the_seam_at_constant_speed():
    found = bead(0.005, duration=4.0, angle=0.3, speed=5.0, gravity=np.zeros(3))
    assert np.abs(np.linalg.norm(found["ball.velocity"], axis=1) - 5.0).max() < 1e-3
    turned = np.unwrap(angle_of(found)) - 0.3
    assert turned[-1] > 3.0 * 2.0 * np.pi
    assert np.abs(turned - 5.0 * found.times).max() < 5e-3
    # m v^2 / R, and the waves of the curvature
    assert np.abs(found["slide.normal_force"][5:] / 25.0 - 1.0).max() < 3e-3


def rolling(step, seam=0.0, friction=0.5, duration=3.0, angle=0.5):
    way = 1.0 - RADIUS
    ground = ring(count=POINTS, start=seam, width=0.2, director=np.array([0.0, 1.0, 0.0]), flip=True)
    scene = Scene(
        bodies=(ball(place(angle, way)),),
        forces=(Gravity(DOWN),),
        contours=(ground,),
        contacts=(touch("ring", friction=friction),),
    )
    return run(scene, step, duration)


def test_ball_in_a_ring_rolls_as_a_pendulum():
    way = 1.0 - RADIUS
    errors = []
    for step in (0.01, 0.005):
        found = rolling(step)
        swing = exact(lambda _, y: [y[1], -5.0 / 7.0 * G / way * np.sin(y[0])], [0.5, 0.0], found.times)[0]
        errors.append(np.abs(angle_of(found) - swing).max())
        force = MASS * G * (17.0 * np.cos(swing) - 10.0 * np.cos(0.5)) / 7.0
        assert np.abs(found["touch.normal_force"] - force)[5:].max() < 0.02 * MASS * G * step / 0.01
        grip = 2.0 / 7.0 * MASS * G * np.abs(np.sin(swing))
        assert np.abs(found["touch.friction_force"] - grip)[5:].max() < 0.02 * MASS * G * step / 0.01
        assert found["touch.impacts"][-1] == 0.0
        assert found["touch.slip"][5:].max() < 1e-6
    assert errors[1] < 5e-4
    assert errors[0] / errors[1] > 3.0


def test_nothing_tells_where_the_seam_of_a_ring_is():
    """A ring of equal pieces is the same turned by a piece: seam below the ball, and where it never comes."""
    below, away = (rolling(0.005, seam=start) for start in (BOTTOM, BOTTOM + np.pi))
    assert np.any(np.abs(np.diff(below["touch.coordinate"][:, 0])) > 0.5)
    assert not np.any(np.abs(np.diff(away["touch.coordinate"][:, 0])) > 0.5)
    assert np.abs(below["ball.position"] - away["ball.position"]).max() < 1e-9
    force = away["touch.normal_force"]
    assert np.abs(below["touch.normal_force"] - force).max() < 1e-6 * force.max()


def test_ball_dropped_into_a_ring_keeps_its_energy_account():
    ground = ring(count=POINTS, width=0.2, director=np.array([0.0, 1.0, 0.0]), flip=True)
    scene = Scene(
        bodies=(ball([0.35, 0.0, 0.1]),),
        forces=(Gravity(DOWN),),
        contours=(ground,),
        contacts=(touch("ring", friction=0.2, law=RigidLaw(0.6)),),
    )
    found = run(scene, 0.005, 4.0)
    assert found["touch.impacts"][-1] > 3
    assert found["touch.gap"].min() > -1e-3 * RADIUS
    assert np.abs(found["ball.position"][:, 1]).max() < 1e-9
    energy = found["energy.kinetic"] + found["energy.potential"]
    assert np.diff(energy).max() < 1e-4 * MASS * G
    assert found.drift < 1e-4 * MASS * G


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_ball_rolls_along_a_cylinder(friction):
    """Down the crest of an inclined cylinder: 5/7 g sin with grip, g sin without."""
    line = np.stack([np.linspace(-2.0, 2.0, 9), np.zeros(9), np.zeros(9)], axis=1)
    pipe = Contour(name="pipe", body="ground", neutral=neutral_curve(line), radius=0.3)
    scene = Scene(
        bodies=(ball([-1.0, 0.0, 0.3 + RADIUS]),),
        forces=(Gravity(tilted(0.2)),),
        contours=(pipe,),
        contacts=(touch("pipe", friction=friction),),
    )
    found = run(scene, 0.005, 0.5)
    share = 5.0 / 7.0 if friction else 1.0
    way = 0.5 * share * G * np.sin(0.2) * found.times**2
    assert np.abs(found["ball.position"][:, 0] + 1.0 - way).max() < 1e-7
    assert np.abs(found["touch.normal_force"][3:] - MASS * G * np.cos(0.2)).max() < 1e-5
    assert found.drift < 1e-7


def test_ball_leaves_a_cylinder_at_two_thirds_of_its_height():
    """Frictionless from the crest of a horizontal cylinder: it leaves where cos is 2/3 of that at the start."""
    line = np.stack([np.zeros(9), np.linspace(-1.0, 1.0, 9), np.zeros(9)], axis=1)
    pipe = Contour(name="pipe", body="ground", neutral=neutral_curve(line), radius=0.5)
    way, angle = 0.5 + RADIUS, 0.1
    start = ball(way * np.array([np.sin(angle), 0.0, np.cos(angle)]))
    scene = Scene(bodies=(start,), forces=(Gravity(DOWN),), contours=(pipe,), contacts=(touch("pipe"),))
    found = run(scene, 1e-3, 1.0)
    last = int(np.nonzero(found["touch.normal_force"] > 0.0)[0][-1])
    x, _, z = found["ball.position"][last]
    assert abs(z / np.hypot(x, z) - 2.0 / 3.0 * np.cos(angle)) < 5e-3
    assert found["touch.gap"][-1] > 0.01
    energy = found["energy.kinetic"] + found["energy.potential"]
    assert np.abs(energy - energy[0]).max() < 1e-5 * MASS * G
