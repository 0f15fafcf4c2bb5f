"""Largest and smallest forces and gaps of contacts between records, over every step; dampers beside what rings."""

from __future__ import annotations

from typing import Any

import mesh_contact_scenes as triangles
import numpy as np
import pytest
from contact_scenes import G, ball, ball_on_floor, run, touch

from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.solver.forces.spring import Spring
from heavylift.solver.scene.contacts import LinearLaw, RigidLaw
from heavylift.solver.scene.scene import Gravity, Scene

STEP, EVERY, DURATION = 1e-3, 25, 1.0


def bouncing(law: Any) -> Scene:
    """A ball that falls on a contour."""
    return ball_on_floor(ball((0.0, 0.0, 0.4)), law)


def landing(law: Any) -> Scene:
    """A cube that falls on a plate, both of triangles."""
    cube = (triangles.body("box", (0.13, 0.07, 0.5 + 0.1)), box_surface((1.0, 1.0, 1.0)))
    return triangles.scene([cube], box_surface((4.0, 4.0, 1.0), (0.0, 0.0, -0.5)), law=law)


SCENES = {
    "compliant contour": (bouncing, LinearLaw(2e5, 300.0), "touch"),
    "rigid contour": (bouncing, RigidLaw(restitution=0.5), "touch"),
    "compliant triangles": (landing, LinearLaw(2e6, 3e3), "ground-box"),
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
        seen = sparse[f"{name}.normal_force"].max()
        assert sparse[f"{name}.normal_force_max"].max() > 1.1 * seen  # records alone miss the peak
