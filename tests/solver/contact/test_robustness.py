"""Random balls in a bowl: no stop, no tunnelling, no energy from nothing, no endless step."""

from __future__ import annotations

import numpy as np
import pytest
from contact_scenes import G, ball, ball_on_floor, run, surface
from robust_balls import FLOOR, complaints, random_scene

from heavylift.solver.scene.contacts import HertzLaw, RigidLaw

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("first", range(0, 200, 20))
def test_random_starts(first):
    wrong = {}
    for seed in range(first, first + 20):
        scene, step, text = random_scene(seed)
        found = complaints(scene, step, min(int(3.0 / step), 20000), every=1 if step > 1e-3 else 10)
        if found:
            wrong[text] = found
    assert not wrong


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_hundred_thousand_steps(restitution, friction):
    scene = ball_on_floor(ball([0.7, 0.2, 0.6]), RigidLaw(restitution), floor=FLOOR, friction=friction)
    assert not complaints(scene, 1e-2, 100_000, every=10)


@pytest.mark.parametrize("step", [1e-2, 1e-3, 1e-4, 1e-5])
def test_steps_over_three_decades(step):
    scene = ball_on_floor(ball([0.7, 0.2, 0.6]), RigidLaw(0.5), floor=FLOOR, friction=0.2)
    assert not complaints(scene, step, min(100_000, round(5.0 / step)), every=max(1, round(1e-3 / step)))


def bounces(mass):
    start = ball([0.7, 0.2, 0.6], mass=mass)
    return run(ball_on_floor(start, RigidLaw(0.3), floor=FLOOR, friction=0.2), 1e-3, 1.0)


@pytest.mark.parametrize("mass", [1e-3, 1e3])
def test_rigid_contact_on_the_ground_does_not_know_the_mass(mass):
    found, expected = bounces(mass), bounces(1.0)
    assert np.abs(found["ball.position"] - expected["ball.position"]).max() < 1e-6
    assert np.isclose(found["touch.impulse"][-1], mass * expected["touch.impulse"][-1], rtol=1e-5)


@pytest.mark.parametrize("law", [RigidLaw(1.0), HertzLaw(1e5)])
def test_ball_that_falls_past_the_border_is_not_caught_from_below(law):
    floor = surface(lambda x, y: 0.3 * (x * x + y * y), half=1.5, count=16)
    found = run(ball_on_floor(ball([0.15, -1.7, 1.2], [0.0, -0.4, 0.0]), law, floor=floor), 1e-2, 1.0)
    fall = np.outer(found.times, [0.0, 0.0, -G]) + np.array([0.0, -0.4, 0.0])
    assert np.abs(found["ball.velocity"] - fall).max() < 1e-9
    assert found["touch.gap"].min() > 0.0
    assert found["touch.impacts"][-1] == 0.0


def test_ball_that_rolls_over_the_border_falls():
    floor = surface(half=1.0)
    found = run(ball_on_floor(ball([0.8, 0.0, 0.1], [1.0, 0.0, 0.0]), floor=floor, friction=0.3), 5e-3, 1.0)
    assert found["ball.position"][-1, 2] < -0.5
    assert np.isclose(found["ball.velocity"][-1, 0], found["ball.velocity"][-20, 0])
    assert found.drift < 1e-3
