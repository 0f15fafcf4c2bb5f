"""A joint that is a list of rows is a description alone: nothing that exists knows it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from heavylift.solver.scene.connections import GROUND, Joint, TravelOutputs
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sliding_joints import SlidingOutputs
from heavylift.solver.simulation import Simulation


@dataclass(frozen=True, eq=False, kw_only=True)
class OnLine(Joint):
    """The point of b stays on z of a, and x of b across it."""

    ROWS: ClassVar = (("travel", "x"), ("travel", "y"), ("square", "z", "x"))
    CHANNELS: ClassVar = SlidingOutputs.CHANNELS


def test_a_list_of_rows_is_a_joint() -> None:
    """A body with a constant pull in x, y and z slides along z alone, and its line bears the rest."""
    pull, mass, duration, count = np.array([3.0, -2.0, 1.5]), 2.0, 0.5, 100
    joint = OnLine(name="line", body_a=GROUND, body_b="ring")
    scene = Scene((RigidBody("ring", mass, np.eye(3)),), (Gravity(pull),), joints=(joint,))
    simulation = Simulation(scene, duration / count, record_every=count)
    _, rows = simulation.advance(count)
    found = {c.name: rows[-1, c.column : c.column + len(c.components)].squeeze() for c in simulation.channels}
    assert [name for name in found if name.startswith("line.travel")] == [
        f"line.{channel.name}" for channel in TravelOutputs.CHANNELS
    ]
    np.testing.assert_allclose(found["line.travel"], 0.5 * pull[2] * duration**2, rtol=1e-12)
    np.testing.assert_allclose(found["line.travel_rate"], pull[2] * duration, rtol=1e-12)
    np.testing.assert_allclose(
        found["line.reaction_force"], [-mass * pull[0], -mass * pull[1], 0.0], atol=1e-12
    )
    np.testing.assert_allclose(found["line.reaction_moment"], 0.0, atol=1e-12)


def test_angles_among_the_rows_follow_from_their_words() -> None:
    assert OnLine.ROTATIONAL == (False, False, True)
    assert OnLine(name="j", body_a=GROUND, body_b="b").rotational == OnLine.ROTATIONAL


@pytest.mark.parametrize(
    ("rows", "problem"),
    [
        ((("along", "x"),), "no row is 'along x'"),
        ((("travel", "w"),), "no row is 'travel w'"),
        ((("square", "z"),), "no row is 'square z'"),
        ((("parallel", "m"),), "no row is 'parallel m'"),
        ((("travel", "x"), ("point",)), "the rows of the point come first"),
    ],
)
def test_what_is_no_row_is_refused(rows: tuple[tuple[str, ...], ...], problem: str) -> None:
    with pytest.raises(TypeError, match=problem):
        type("Wrong", (Joint,), {"ROWS": rows})
