"""A plate that falls on a floor that heaves, and bounces: against the instant of the impact in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mesh_contact_scenes import G, body, run, scene
from scipy.optimize import brentq

from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.solver.scene.bodies import Driven, Harmonic, Profile
from heavylift.solver.scene.contacts import RigidLaw

AMPLITUDE, FREQUENCY, HEIGHT, RESTITUTION, END = 0.15, 0.5, 0.8, 0.5, 0.6
RATE = 2.0 * np.pi * FREQUENCY


def floor(t):
    return AMPLITUDE * np.sin(RATE * t)


HIT = brentq(lambda t: HEIGHT - 0.5 * G * t * t - floor(t), 0.1, 0.5)


def height(t):
    """Of the lower side after the impact, before the next one [m]."""
    carried = AMPLITUDE * RATE * np.cos(RATE * HIT)
    leaves = carried + RESTITUTION * (G * HIT + carried)
    return floor(HIT) + leaves * (t - HIT) - 0.5 * G * (t - HIT) ** 2


def error(step, events):
    """Of the height at the last record before the end [m]."""
    motion = Driven(z=Profile(harmonics=(Harmonic(AMPLITUDE, FREQUENCY),)))
    deck = replace(body("deck", (0.0, 0.0, -0.5), mass=1e4, inertia=1e5), motion=motion)
    plate = body("plate", (0.0, 0.0, HEIGHT + 0.05), size=(1.0, 1.0, 0.1))
    bodies = [(deck, box_surface((20.0, 20.0, 1.0))), (plate, box_surface((1.0, 1.0, 0.1)))]
    law = RigidLaw(restitution=RESTITUTION)
    made = scene(bodies, None, [("deck", "plate")], friction=0.0, law=law, events=events)
    found = run(made, step, int(END / step) * step)
    return abs(found["plate.position"][-1, 2] - 0.05 - height(found.times[-1]))


def mean_error(count, events):
    """Over impacts in all parts of a step, whose length is about the time to the impact over a count."""
    return np.mean([error(HIT / (count + part), events) for part in (0.1, 0.3, 0.5, 0.7, 0.9)])


def test_impacts_that_are_found_are_exact_at_any_step():
    assert max(mean_error(count, True) for count in (37, 148)) < 1e-8


@pytest.mark.parametrize("count", [37, 148])
def test_without_events_their_error_is_of_first_order(count):
    """Impacts take place in the middle or at the end of a step, so a step of a quarter has a quarter of the error."""
    coarse, fine = mean_error(count, False), mean_error(4 * count, False)
    assert np.log2(coarse / fine) / 2.0 == pytest.approx(1.0, abs=0.05)
    assert coarse < 0.15 * HIT / count * G * HIT  # of the way of a step
