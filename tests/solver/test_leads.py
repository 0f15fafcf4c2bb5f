"""Leads of ropes against angles from another library."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.descriptions import check_object
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.sensors.fleet_angles import FleetAngle
from heavylift.solver.simulation import Simulation

SPIN = np.array([0.2, -0.4, 0.9])
A, B = np.array([0.5, 1.0, -0.5]), np.array([3.0, 2.0, -7.0])


def leads_of(scene: Scene):
    run = Simulation(scene, step=0.01, record_every=1)
    times, records = run.advance(100)
    return times, {c.name: records[:, c.column] for c in run.channels if c.name.startswith("seen.")}


def test_of_a_crown_that_turns():
    """A ball that spins about a fixed axis, with the crown at a point of it; the block stands still."""
    axis, normal = np.array([0.3, 0.0, -2.0]), np.array([2.0, 5.0, 0.3])
    ball = RigidBody("ball", 2.0, 3.0 * np.eye(3), angular_velocity=SPIN)
    lead = FleetAngle(
        name="seen", body_a="ball", point_a=A, body_b=GROUND, point_b=B, axis=axis, normal=normal
    )
    times, found = leads_of(Scene((ball,), forces=(lead,)))
    turn = Rotation.from_rotvec(np.outer(times, SPIN))
    r = turn.inv().apply(B - turn.apply(A))
    t, n = axis / np.linalg.norm(axis), normal / np.linalg.norm(normal)
    flat = r - np.outer(r @ n, n)
    off = np.arccos(flat @ t / np.linalg.norm(flat, axis=1)) * np.sign(flat @ np.cross(t, n))
    assert found["seen.off_lead"] == pytest.approx(off, abs=1e-7)
    assert found["seen.side_lead"] == pytest.approx(np.arcsin(r @ n / np.linalg.norm(r, axis=1)), abs=1e-9)
    assert found["seen.lead_angle"] == pytest.approx(np.arccos(r @ t / np.linalg.norm(r, axis=1)), abs=1e-7)


def test_of_a_block_aside_from_below_its_crown():
    block = RigidBody("block", 1.0, np.eye(3), position=np.array([1.0, 2.0, -10.0]))
    zero = np.zeros(3)
    lead = FleetAngle(name="seen", body_a=GROUND, point_a=zero, body_b="block", point_b=zero)
    _, found = leads_of(Scene((block,), forces=(lead,)))
    assert found["seen.off_lead"][0] == pytest.approx(math.atan2(1.0, 10.0))  # along x with the default axes
    assert found["seen.side_lead"][0] == pytest.approx(math.asin(2.0 / math.sqrt(105.0)))


def test_axis_and_normal_are_square():
    zero = np.zeros(3)
    lead = FleetAngle(
        name="seen", body_a=GROUND, point_a=zero, body_b="b", point_b=A, normal=np.array([0.0, 1.0, 0.1])
    )
    with pytest.raises(InputError, match="is not perpendicular to axis"):
        check_object(lead)
