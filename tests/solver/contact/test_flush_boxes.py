"""Boxes of one size, flush with each other: sides in one plane do not face each other, and hold nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mesh_contact_scenes import MASS, G, body, run, scene, turn

from heavylift.numerics.rotation import rotation_matrix
from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.solver.forces.point import PointForce

CUBE = box_surface(1.0)
PUSH = 4.0 * MASS
BEGIN, RISEN, END = 0.1, 0.12, 0.4


def pushed(boxes, loaded, way, mu, step, duration=END, at=-0.5, force=PUSH, yaw=0.0, origin=(0.0, 0.0, 0.0)):
    """Boxes by their first positions; one is pushed at a height, from `BEGIN` on and fully from `RISEN` on.

    All of it is turned about the vertical [rad] and moved [m].
    """
    orientation = turn((0.0, 0.0, 1.0), yaw)
    R = rotation_matrix(orientation)
    bodies = [
        (body(name, origin + R @ position, orientation=orientation), CUBE) for name, position in boxes.items()
    ]
    times, way = np.array([0.0, BEGIN, RISEN]), R @ way
    forces = np.outer([0.0, 0.0, force], way)
    push = PointForce("push", loaded, np.array([0.0, 0.0, at]), times=times, forces=forces)
    floor = [("floor", name) for name, position in boxes.items() if position[2] == 0.5]
    made = scene(bodies, plane_surface((2000.0, 2000.0)), [*floor, tuple(boxes)], friction=mu)
    return run(replace(made, forces=[*made.forces, push]), step, duration)


def speed(mu, normal, end=END):
    """Of a body that slides from the instant on in which a force that grows linearly exceeds its friction [m/s]."""
    slips = BEGIN + (RISEN - BEGIN) * mu * normal / PUSH
    at_risen = 0.5 * PUSH / (RISEN - BEGIN) * (RISEN - slips) ** 2
    return (at_risen + (PUSH - mu * normal) * (end - RISEN)) / MASS


@pytest.mark.parametrize("step", [0.01, 0.002])
@pytest.mark.parametrize(("mu", "way"), [(0.2, (0, -1, 0)), (0.2, (1, 0, 0)), (0.0, (0, 1, 0))])
def test_a_box_slides_off_the_one_below(mu, way, step):
    """It is pushed at its base: no corner of its side is held by the side below, which is in the same plane."""
    found = pushed({"low": (0, 0, 0.5), "top": (0, 0, 1.5)}, "top", way, mu, step)
    expected = np.multiply(way, speed(mu, MASS * G))
    np.testing.assert_allclose(found["top.velocity"][-1], expected, atol=2e-3)  # half a step of the ramp
    np.testing.assert_allclose(found["low.velocity"][-1], 0.0, atol=1e-9)
    assert "wrong side" not in found.simulation.warning


@pytest.mark.parametrize("yaw", [0.3, 1.2])
@pytest.mark.parametrize(
    "boxes", [{"rest": (0, 0, 0.5), "b": (0, 0, 1.5)}, {"rest": (0, 0, 0.5), "b": (1, 0, 0.5)}]
)
def test_it_slides_wherever_it_stands(boxes, yaw):
    """Turned and far from the origin, on the other and beside it."""
    found = pushed(boxes, "b", (0, 1, 0), 0.2, 0.005, yaw=yaw, origin=(300.0, -210.0, 0.0))
    expected = rotation_matrix(turn((0.0, 0.0, 1.0), yaw)) @ (0.0, speed(0.2, MASS * G), 0.0)
    np.testing.assert_allclose(found["b.velocity"][-1], expected, atol=2e-3)
    np.testing.assert_allclose(found["rest.velocity"][-1], 0.0, atol=1e-6)


@pytest.mark.parametrize("gap", [0.0, 1e-6])
def test_a_box_slides_along_its_neighbour(gap):
    """Between both there is no force, so friction there holds nothing."""
    found = pushed({"a": (0, 0, 0.5), "b": (1 + gap, 0, 0.5)}, "b", (0, 1, 0), 0.2, 0.01)
    np.testing.assert_allclose(found["b.velocity"][-1], [0.0, speed(0.2, MASS * G), 0.0], atol=2e-3)
    np.testing.assert_allclose(found["a.velocity"][-1], 0.0, atol=1e-9)


def test_a_box_is_lifted_from_beside_its_neighbour():
    """Once the force is the weight, it rises freely."""
    force = 1.05 * MASS * G
    found = pushed({"a": (0, 0, 0.5), "b": (1, 0, 0.5)}, "b", (0, 0, 1), 0.2, 0.01, at=0.5, force=force)
    leaves = BEGIN + (RISEN - BEGIN) / 1.05
    rise = (0.5 * force / (RISEN - BEGIN) * (RISEN - leaves) ** 2 + 0.05 * MASS * G * (END - RISEN)) / MASS
    np.testing.assert_allclose(found["b.velocity"][-1], [0.0, 0.0, rise], atol=2e-3)
    np.testing.assert_allclose(found["a.velocity"][-1], 0.0, atol=1e-9)


@pytest.mark.parametrize("options", [{}, {"tolerance": 1e-5}], ids=["steps", "tolerance"])
def test_the_first_record_has_the_forces_of_rest(options):
    """Also where steps vary in length and the first one is short."""
    bodies = [(body(name, (0, 0, 0.5 + k)), CUBE) for k, name in enumerate(("low", "mid", "top"))]
    made = scene(
        bodies, plane_surface(40.0), [("floor", "low"), ("low", "mid"), ("mid", "top")], friction=0.5
    )
    found = run(made, 0.05, 0.2, **options)
    for carried, pair in ((3, "floor-low"), (2, "low-mid"), (1, "mid-top")):
        np.testing.assert_allclose(found[f"{pair}.normal_force"], carried * MASS * G, rtol=1e-6)
        np.testing.assert_allclose(found[f"{pair}.normal_force_min"][1:], carried * MASS * G, rtol=1e-6)
