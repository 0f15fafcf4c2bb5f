"""What loads a hull beside its mass, tanks and joints, so that its draught at the start is not known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from heavylift.pipeline.assemble.afloat import _other_loads
from heavylift.solver.forces.point import PointForce
from heavylift.solver.forces.spring import Spring
from heavylift.solver.scene.scene import Gravity, Scene
from heavylift.solver.scene.sea import Sea, Water
from heavylift.solver.sensors.relative_motions import RelativeMotion

GROUP = {"hull", "tower"}
EMPTY = Scene((), (Gravity(np.array([0.0, 0.0, -9.81])),), sea=Sea(water=Water(1025.0, 9.81)))
HERE = {"point_a": np.zeros(3), "point_b": np.zeros(3)}


def between(a: str, b: str) -> Spring:
    return Spring(name="spring", body_a=a, body_b=b, length=1.0, stiffness=1.0, **HERE)


@pytest.mark.parametrize(
    ("one", "found"),
    [
        (RelativeMotion(name="seen", body_a="ground", body_b="hull", **HERE), []),
        (between("hull", "tower"), []),
        (between("load", "ground"), []),
        (between("hull", "ground"), ["forces"]),
        (between("load", "tower"), ["forces"]),
        (PointForce(name="push", body="tower", point=np.zeros(3), force=np.ones(3)), ["forces"]),
    ],
)
def test_what_only_watches_or_acts_within_loads_nothing(one, found) -> None:
    assert _other_loads(replace(EMPTY, forces=(*EMPTY.forces, one)), GROUP) == found
