"""Contacts whose shapes turn with a body with modes: their directions turn with the place."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from contact_scenes import surface, touch
from solid_beams import LENGTH, beam, cantilever

from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.contacts import BoxShape, LinearLaw, PointShape, SphereShape
from heavylift.solver.scene.scene import Scene

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
