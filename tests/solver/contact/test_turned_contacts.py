"""Contacts whose shapes turn with a body with modes: their directions turn with the place."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from contact_scenes import surface, touch
from solid_beams import LENGTH, beam, cantilever

from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.connections import JointFrame
from heavylift.solver.scene.contacts import BoxShape, LinearLaw, PointShape, SphereShape
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.sensors.relative_motions import RelativeMotion
from heavylift.solver.simulation import Simulation

ROOT, TIP = np.zeros(3), np.array([LENGTH, 0.0, 0.0])


@pytest.mark.parametrize(
    ("shape", "friction", "directed"),
    [
        (SphereShape(0.01), 0.0, False),
        (SphereShape(0.01), 0.3, True),
        (PointShape(), 0.3, False),
        (BoxShape((0.1, 0.1, 0.02), rounding=0.001), 0.0, True),
    ],
)
def test_contacts_with_a_lever_turn_with_their_place(shape: Any, friction: float, directed: bool) -> None:
    """Friction on a ball, and all that presses on a box, makes a moment about its middle."""
    law = LinearLaw(stiffness=1e6)

    def made(at: Any) -> Scene:
        place = np.array(at, dtype=float)
        contact = touch(body="beam", shape=shape, point=place, friction=friction, law=law)
        return Scene(
            (beam(cantilever(), position=np.array([0.0, 0.0, 0.1])),),
            contours=(surface(half=2.0),),
            contacts=(contact,),
        )

    for place, turned in ((ROOT, False), (TIP, True)):
        markers = pack_scene(made(place)).bodies[0].markers
        directions = markers[markers["direction"]]
        assert directions["turned"].tolist() == [turned] * 3 * directed


@pytest.mark.slow
def test_a_ball_with_friction_bends_the_place_that_carries_it() -> None:
    """A ball of 0.1 m at the tip rubs along a floor: as one on a tiny body that a fixed joint holds there."""
    reach, sunk = 0.1, 2e-4
    reduced = cantilever(held=(tuple(TIP.tolist()),))
    start = {"position": np.array([0.0, 0.0, reach - sunk])}
    rest = {"damping_ratio": np.full(reduced.mode_count, 0.02)}
    # the tip swings along y, and rubs
    rest["modal_velocity"] = 0.2 * np.eye(reduced.mode_count)[0] + 0.1 * np.eye(reduced.mode_count)[1]
    law = LinearLaw(stiffness=2e4)
    tiny = RigidBody("tiny", 1e-3, 1e-6 * np.eye(3), position=TIP + start["position"])
    bolt = FixedJoint(name="bolt", body_a="beam", body_b="tiny", frame_a=JointFrame(TIP))
    seen = RelativeMotion(name="seen", body_a="ground", body_b="beam", point_a=ROOT, point_b=TIP)
    found = []
    for body, point in (("beam", TIP), ("tiny", ROOT)):
        contact = touch(body=body, radius=reach, point=point, friction=0.5, law=law)
        scene = Scene(
            (beam(reduced, **start, **rest), tiny),
            (seen,),
            joints=(bolt,),
            contours=(surface(half=2.0),),
            contacts=(contact,),
        )
        run = Simulation(scene, 5e-5, record_every=20)
        rows = run.advance(2000)[1]
        assert not run.outcome, run.message
        at = next(c.column for c in run.channels if c.name == "seen.rotation")
        found.append(rows[:, at : at + 3])
    assert np.abs(found[0][:, 0]).max() > 1e-4  # twist: friction times the radius
    np.testing.assert_allclose(found[0], found[1], atol=1e-2 * np.abs(found[0]).max())
