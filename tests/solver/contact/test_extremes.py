"""Largest and smallest forces and gaps of contacts between records, over every step; dampers beside what rings."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import mesh_contact_scenes as triangles
import numpy as np
import pytest
from contact_scenes import RADIUS, ball, ball_on_floor, run

from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.solver.forces.spring import Spring
from heavylift.solver.scene.contacts import LinearLaw, RigidLaw
from heavylift.solver.scene.scene import Scene

STEP, EVERY, DURATION = 1e-3, 25, 1.0


def bouncing(law: Any) -> Scene:
    """A ball that falls on a contour."""
    return ball_on_floor(ball((0.0, 0.0, 0.4)), law)


def landing(law: Any) -> Scene:
    """A cube that falls on a plate, both of triangles."""
    cube = (triangles.body("box", (0.13, 0.07, 0.5 + 0.1)), box_surface(1.0))
    return triangles.scene([cube], plane_surface(60.0), law=law, clearance=True)


SCENES = {
    "compliant contour": (bouncing, LinearLaw(2e5, 300.0), "touch"),
    "rigid contour": (bouncing, RigidLaw(restitution=0.5), "touch"),
    "compliant triangles": (landing, LinearLaw(2e6, 3e3), "floor-box"),
}


@pytest.mark.parametrize("scene", SCENES)
def test_records_show_the_extremes_of_all_steps_between_them(scene: str) -> None:
    """Bit for bit those of a run that records every step; gaps where it touches."""
    make, law, name = SCENES[scene]
    sparse = run(make(law), STEP, DURATION, record_every=EVERY)
    dense = run(make(law), STEP, DURATION)
    for side, extreme in (("max", np.max), ("min", np.min)):
        every = dense[f"{name}.normal_force_{side}"][1:].reshape(-1, EVERY)
        found = sparse[f"{name}.normal_force_{side}"]
        np.testing.assert_array_equal(found[1:], extreme(every, axis=1))
        if law is not SCENES["rigid contour"][1]:  # events: steps that end at an impact are no records
            np.testing.assert_array_equal(dense[f"{name}.normal_force_{side}"], dense[f"{name}.normal_force"])
    gaps = dense[f"{name}.gap_min"][1:].reshape(-1, EVERY).min(axis=1)
    touched = gaps < 1e-6
    assert np.any(touched)
    np.testing.assert_array_equal(sparse[f"{name}.gap_min"][1:][touched], gaps[touched])
    assert np.all(sparse[f"{name}.gap_min"][1:] >= gaps)
    if law is not SCENES["rigid contour"][1]:
        force = sparse[f"{name}.normal_force"]
        seen = np.maximum(force[1:], force[:-1])
        assert np.any(sparse[f"{name}.normal_force_max"][1:] > 1.1 * seen)  # records alone miss peaks


@pytest.mark.parametrize("step", [2e-3, 1e-3])
def test_a_damper_does_not_show_what_the_ball_rings_with(step: float) -> None:
    """A ball on a soft floor, on a spring to a mass above that no step resolves: its end velocity changes its sign.

    The force of the floor is that of the depth and of how it changes from record to record.
    """
    stiffness, damping = 2e5, 2e3
    lower = ball((0.0, 0.0, RADIUS), (0.0, 0.0, 0.0), mass=2.0)
    upper = ball((0.0, 0.0, RADIUS + 1.0), (0.0, 0.0, 0.3), name="upper", mass=200.0)
    stiff = Spring(
        name="stiff",
        body_a="ball",
        point_a=np.zeros(3),
        body_b="upper",
        point_b=np.zeros(3),
        length=1.0,
        stiffness=1e10,
    )
    scene = ball_on_floor(lower, LinearLaw(stiffness, damping))
    scene = replace(scene, bodies=(*scene.bodies, upper), forces=(*scene.forces, stiff))
    found = run(scene, step, 0.5)
    depth = -found["touch.gap"]
    ringing = np.abs(np.diff(found["ball.velocity"][:, 2])).max()
    assert ringing > 0.1
    rate = (depth[2:] - depth[:-2]) / (2.0 * step)
    expected = np.maximum(0.0, stiffness * depth[1:-1] + damping * rate)
    pressed = depth[1:-1] > 0.0
    error = np.abs(found["touch.normal_force"][1:-1] - expected)[pressed][5:]
    assert error.max() < 0.1 * damping * ringing
