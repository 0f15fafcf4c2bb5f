"""Sheaves that a taut rope leaves and comes back to: its length, its tension, no force on what it does not touch."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from law_scenes import eye, wire

from heavylift.numerics.records import records
from heavylift.solver.force_elements.rope_path import START_WRAP, PlaceGradient, RopePlace, path_length
from heavylift.solver.scene.bodies import Driven, Profile
from heavylift.solver.scene.connections import GROUND, RopePoint
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.simulation import Simulation

SPAN, RADIUS, STIFFNESS, TENSION = 10.0, 0.5, 1e6, 2e4


def bent(height: float) -> float:
    """Length over a sheave below the middle of a straight line of 20 m, whose centre is at a height [m]."""
    far = math.hypot(SPAN, height)
    straight = math.sqrt(far**2 - RADIUS**2)
    deflection = math.asin(RADIUS / far) - math.asin(height / far)
    return 2.0 * (straight + RADIUS * deflection) if deflection > 0.0 else 2.0 * SPAN


def scene(path: tuple[float, float], efficiency: float = 1.0) -> Scene:
    """A sheave that presses a rope down from z = path[0], goes up by path[1] in 4 s and comes back."""
    motion = Driven(z=Profile(times=np.array([0.0, 4.0, 8.0]), values=np.array([0.0, path[1], 0.0])))
    sheave = RigidBody("sheave", 100.0, np.eye(3), position=np.array([0.0, 0.0, path[0]]), motion=motion)
    over = RopePoint("sheave", np.zeros(3), RADIUS, np.array([0.0, -1.0, 0.0]), efficiency=efficiency)
    rope = wire(
        eye(GROUND, (-SPAN, 0, 0)), over, eye(GROUND, (SPAN, 0, 0)), stiffness=STIFFNESS, tension=TENSION
    )
    return Scene(bodies=(sheave,), ropes=(rope,))


def line_of(places: np.ndarray, touched: tuple[int, ...]) -> float | None:
    """Length of a path in the plane y = 0 over some of its pulleys, if it is taut and passes the others by."""
    route = [0, *touched, len(places) - 1]
    tangents = []
    for a, b in itertools.pairwise(route):
        (p, sa, ra), (q, sb, rb) = ((places[i][[0, 2]], places[i][4], places[i][6]) for i in (a, b))
        d = q - p
        far, gap = np.linalg.norm(d), sb * rb - sa * ra  # centres lie right of the line by these
        if far <= abs(gap):
            return None
        c, s = math.sqrt(1.0 - (gap / far) ** 2), gap / far
        u = d / far
        way = np.array([c * u[0] - s * u[1], s * u[0] + c * u[1]])
        left = np.array([-way[1], way[0]])
        tangents.append((p + sa * ra * left, way, c * far))
    total = sum(length for *_, length in tangents)
    for place, before, behind in zip(touched, tangents[:-1], tangents[1:], strict=True):
        turn = math.atan2(before[1][0] * behind[1][1] - before[1][1] * behind[1][0], before[1] @ behind[1])
        wrap = -places[place][4] * turn
        if wrap < 0.0:
            return None
        total += places[place][6] * wrap
    for (a, b), (start, way, _) in zip(itertools.pairwise(route), tangents, strict=True):
        for i in range(a + 1, b):
            above = way[0] * (places[i][2] - start[1]) - way[1] * (places[i][0] - start[0])
            if -places[i][4] * above < places[i][6] * (1.0 - 1e-12):
                return None
    return total


@pytest.mark.parametrize("seed", range(30))
def test_a_taut_rope_touches_what_stands_in_its_way(seed: int) -> None:
    """Against all choices of pulleys, of which one is taut and passes the others by on the right side."""
    rng = np.random.default_rng(seed)
    count = 6
    places = np.zeros((count, 7))
    places[:, 0] = 4.0 * np.arange(count)
    places[:, 2] = rng.uniform(-0.6, 0.6, count)
    places[:, 4] = rng.choice([-1.0, 1.0], count)
    places[1:-1, 6] = rng.uniform(0.1, 0.5, count - 2)
    inner = range(1, count - 1)
    chosen = [set_ for n in range(count - 1) for set_ in itertools.combinations(inner, n)]
    lengths = [(length, set_) for set_ in chosen if (length := line_of(places, set_)) is not None]
    assert len(lengths) == 1
    path = records(RopePlace, count)
    path.view(np.float64)[:] = places.ravel()
    gradient, wraps = records(PlaceGradient, count), np.full(count, START_WRAP)
    assert path_length(path, gradient, wraps) == pytest.approx(lengths[0][0], rel=1e-12)
    assert {i for i in inner if wraps[i] >= 0.0} == set(lengths[0][1])
    for i in set(inner) - set(lengths[0][1]):
        assert not gradient[i].centre.any()


@pytest.mark.parametrize("efficiency", [1.0, 0.95])
def test_a_sheave_that_leaves_its_rope_bears_nothing(efficiency: float) -> None:
    """20 m between the ends, 19,949 N; the same again from a checkpoint on its way; back as it was."""
    simulation = Simulation(scene((0.4, 1.0), efficiency), 5e-3, record_every=20)
    column = {channel.name: channel.column for channel in simulation.channels}
    start = simulation.record()
    first = simulation.advance(600)[1]
    kept = simulation.state()
    rest = simulation.advance(1000)[1]
    rows = np.vstack([start, first, rest])
    unstretched = bent(0.4) / (1.0 + TENSION / STIFFNESS)
    heights = rows[:, column["sheave.position"] + 2]
    expected = [STIFFNESS * (bent(height) / unstretched - 1.0) for height in heights]
    np.testing.assert_allclose(rows[:, column["rope.tension"]], expected, rtol=2e-6)
    assert expected[40] == pytest.approx(19949.0, abs=0.1)
    simulation.restore(kept)
    np.testing.assert_array_equal(simulation.advance(1000)[1], rest)


def test_a_sheave_that_is_not_touched_at_the_start_takes_no_turn() -> None:
    """It hangs below the rope, on its other side: 20 m, until it comes up to it."""
    places = records(RopePlace, 3)
    places["centre"] = [(-SPAN, 0, 0), (0, 0, 0), (SPAN, 0, 0)]
    places["axis"], places["radius"] = (0.0, 1.0, 0.0), (0.0, RADIUS, 0.0)
    for height, length in [(-1.0, 20.0), (-0.5 - 1e-9, 20.0), (0.3, bent(-0.3))]:
        places[1].centre[2] = height
        found = path_length(places, records(PlaceGradient, 3), np.full(3, START_WRAP))
        assert found == pytest.approx(length, rel=1e-12)
