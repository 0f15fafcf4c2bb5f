"""A flexible plate that floats freely: a mass hits it, and it falls on the ground; momentum and energy."""

from __future__ import annotations

import numpy as np
import pytest
from contact_scenes import DOWN, G, run, surface
from flexible_scenes import CENTRE, FREE, PLATE_MASS, hit, plate
from scipy.spatial.transform import Rotation

from heavylift.solver.scene.contacts import Contact, PointShape, RigidLaw
from heavylift.solver.scene.scene import FlexibleBody, Gravity, Scene

pytestmark = pytest.mark.slow

MASS = 0.7


def momenta(found, body):
    """Linear and angular momentum of plate and mass, point mass by point mass, shape (n, 6)."""
    cloud = body.cloud
    out = np.zeros((len(found.times), 6))
    q, qd = found["plate.modal_position"], found["plate.modal_velocity"]
    for k in range(len(out)):
        R = Rotation.from_quat(found["plate.orientation"][k], scalar_first=True).as_matrix()
        u = cloud.deformed(q[k])
        w = found["plate.angular_velocity"][k]
        v = found["plate.velocity"][k] + (np.cross(w, u) + np.tensordot(qd[k], cloud.shapes, axes=1)) @ R.T
        r = found["plate.position"][k] + u @ R.T
        ball, speed = found["ball.position"][k], found["ball.velocity"][k]
        out[k, :3] = cloud.masses @ v + MASS * speed
        out[k, 3:] = cloud.masses @ np.cross(r, v) + MASS * np.cross(ball, speed)
    return out


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_hit_plate_keeps_all_momentum(friction):
    body = plate(free=True)
    scene = hit(
        body,
        0.0205,
        1.0,
        RigidLaw(0.5),
        motion=FREE,
        place=(0.17, -0.11),
        sideways=(0.5, 0.2),
        friction=friction,
    )
    found = run(scene, 1e-3, 0.3)
    assert found["touch.impacts"][-1] >= 1.0
    total = momenta(found, body)
    assert np.abs(total - total[0])[:, :3].max() < 1e-9
    assert np.abs(total - total[0])[:, 3:].max() < 1e-5
    assert np.abs(found["plate.angular_velocity"][-1]).max() > 0.05
    assert found["touch.dissipated"][-1] > 0.0
    assert found.drift < 1e-3 * 0.5 * MASS


def test_impact_on_a_free_plate_sees_frame_and_shapes():
    """p = (1 + e) v / (1/m + 1/M + r r / I + b b) at a place off the centre."""
    body = plate(free=True)
    node = CENTRE + 2  # two places along y
    place = body.cloud.nodes[node]
    b = body.cloud.shapes[:, node, 2]
    turn = body.cloud.masses @ body.cloud.nodes[:, 1] ** 2
    effective = 1.0 / (1.0 / MASS + 1.0 / PLATE_MASS + place[1] ** 2 / turn + b @ b)
    scene = hit(body, 0.0105, 1.0, RigidLaw(0.5), motion=FREE, place=(0.0, place[1]))
    found = run(scene, 1e-3, 0.011)
    assert np.isclose(found["touch.impulse"][-1], 1.5 * effective, rtol=1e-5)
    assert np.isclose(found["touch.dissipated"][-1], 0.375 * effective, rtol=1e-5)


def falling(law, height=0.3):
    """Four corners of the plate above the ground."""
    body = plate((20.0, 35.0, 50.0), free=True)
    corners = body.cloud.nodes[[0, 6, 42, 48]]
    flexible = FlexibleBody(
        "plate",
        body.cloud.reduced(),
        position=np.array([0.0, 0.0, height]),
        angular_velocity=np.array([0.2, -0.1, 0.0]),
        damping_ratio=np.full(3, 0.02),
    )
    return Scene(
        bodies=(flexible,),
        forces=(Gravity(DOWN),),
        contours=(surface(),),
        contacts=tuple(
            Contact(
                name=f"corner{i}",
                contour="floor",
                body="plate",
                point=x,
                shape=PointShape(),
                law=law,
                friction=0.3,
            )
            for i, x in enumerate(corners)
        ),
    )


def test_falling_plate_comes_to_rest_on_its_corners():
    found = run(falling(RigidLaw(0.3)), 1e-3, 2.0)
    names = [f"corner{i}" for i in range(4)]
    assert min(found[f"{name}.gap"].min() for name in names) > -1e-5
    lift = sum(found[f"{name}.impulse"][-1] for name in names)
    start, end = found["plate.velocity"][0, 2], found["plate.velocity"][-1, 2]
    # momentum: mean axes carry none by the shapes
    assert np.isclose(lift, PLATE_MASS * (G * 2.0 + end - start), rtol=1e-5)
    weight = sum(found[f"{name}.normal_force"][-200:].mean() for name in names)
    assert np.isclose(weight, PLATE_MASS * G, rtol=0.02)  # it still trembles
    energy = found["energy.kinetic"] + found["energy.potential"] + found["energy.elastic"]
    assert np.diff(energy).max() < 1e-4 * PLATE_MASS * G
    assert found.drift < 1e-3 * PLATE_MASS * G
