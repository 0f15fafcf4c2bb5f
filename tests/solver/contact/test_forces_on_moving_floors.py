"""Forces of contacts in records while what they stand on moves, against what the motion of the bodies asks for."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from mesh_contact_scenes import MASS, G, Run, body, run, scene

from heavylift.numerics.rotation import rotation_matrix
from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.forces.point import PointForce
from heavylift.solver.scene.bodies import Driven, Harmonic, Profile
from heavylift.solver.scene.contacts import LinearLaw, RigidLaw
from heavylift.solver.scene.scene import Gravity, Scene
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from numpy.typing import NDArray

CUBE = box_surface(1.0)
DECK = replace(box_surface((20.0, 20.0, 1.0)), points=box_surface((20.0, 20.0, 1.0)).points - (0.0, 0.0, 0.5))
AXIS, PIVOT = np.array([1.0, 2.0, 0.3]) / np.linalg.norm([1.0, 2.0, 0.3]), np.array([0.0, 0.0, -1.0])
ANGLE, FREQUENCY = np.radians(8.0), 0.2
RATE = 2.0 * np.pi * FREQUENCY
WEIGHT = MASS * G
EVENTS = pytest.mark.parametrize("events", [True, False], ids=["events", "no events"])


def turned(times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotations of the floor that rocks, shape (n, 3, 3)."""
    half = 0.5 * ANGLE * np.sin(RATE * times)
    return np.array([rotation_matrix(np.append(np.cos(a), np.sin(a) * AXIS)) for a in half])


def pile_on_rocking_floor(count: int, **options: Any) -> Scene:
    """Equal boxes flush on each other that begin with the motion of the floor."""
    deck = body("deck", mass=1e4, inertia=1e5)
    motion = Driven(
        angle=Profile(harmonics=(Harmonic(ANGLE, FREQUENCY),)), axis=tuple(AXIS), pivot=tuple(PIVOT)
    )
    spin = ANGLE * RATE * AXIS
    bodies = [(replace(deck, motion=motion), DECK)]
    for i in range(count):
        x = np.array([0.0, 0.0, 0.5 + i])
        bodies.append((body(f"b{i}", x, velocity=np.cross(spin, x - PIVOT), spin=spin), CUBE))
    names = ["deck", *(f"b{i}" for i in range(count))]
    return scene(bodies, None, pairwise(names), **{"friction": 0.6, **options})


def needed(found: Run, first: int, count: int) -> NDArray[np.float64]:
    """Force that carries the boxes from one on, if they ride on the floor, world axes, shape (n, 3) [N]."""
    a, rate, turning = (
        ANGLE * np.sin(RATE * found.times),
        ANGLE * RATE * np.cos(RATE * found.times),
        -ANGLE * RATE**2 * np.sin(RATE * found.times),
    )
    assert a.shape == rate.shape
    force = np.zeros((len(a), 3))
    for i in range(first, count):
        arm = turned(found.times) @ (np.array([0.0, 0.0, 0.5 + i]) - PIVOT)
        force += MASS * (
            turning[:, np.newaxis] * np.cross(AXIS, arm)
            + rate[:, np.newaxis] ** 2 * np.cross(AXIS, np.cross(AXIS, arm))
            + (0.0, 0.0, G)
        )
    return force


def rides(found: Run, count: int) -> None:
    """Boxes stay where they stand, and each contact bears what is above it in every record and every step."""
    R = turned(found.times)
    for i in range(count):
        own = np.einsum("nji,nj->ni", R, found[f"b{i}.position"] - PIVOT)
        np.testing.assert_allclose(own, np.broadcast_to((0.0, 0.0, 1.5 + i), own.shape), atol=2e-6)
    names = ["deck", *(f"b{i}" for i in range(count))]
    for i, (a, b) in enumerate(pairwise(names)):
        force, bound = needed(found, i, count), 2e-3 * (count - i) * WEIGHT
        normal = np.einsum("ni,ni->n", force, R[:, :, 2])
        later = slice(2, None)
        for channel in ("normal_force", "normal_force_max", "normal_force_min"):
            np.testing.assert_allclose(found[f"{a}-{b}.{channel}"][later], normal[later], atol=bound)
        np.testing.assert_allclose(found[f"{a}-{b}.force"][later], force[later], atol=2.0 * bound)
    assert not found.simulation.warning


@EVENTS
@pytest.mark.parametrize("count", [1, 2])
def test_boxes_ride_on_a_floor_that_rocks(count: int, events: bool) -> None:
    rides(run(pile_on_rocking_floor(count, events=events), 0.01, 3.2), count)


@pytest.mark.slow
@EVENTS
def test_four_equal_boxes_ride_on_a_floor_that_rocks(events: bool) -> None:
    rides(run(pile_on_rocking_floor(4, events=events), 0.01, 10.0), 4)


@EVENTS
def test_boxes_ride_on_a_floor_that_heaves(events: bool) -> None:
    """``N = m (g + z'')``, with z'' of 0.8 g."""
    amplitude, rate = 0.2, 2.0 * np.pi
    heave = Driven(z=Profile(harmonics=(Harmonic(amplitude, 1.0, -0.5 * np.pi),)))
    deck = replace(body("deck", mass=1e4, inertia=1e5), motion=heave)
    bodies = [(deck, DECK), *((body(f"b{i}", (0.0, 0.0, 0.5 + i - amplitude)), CUBE) for i in range(2))]
    found = run(scene(bodies, None, [("deck", "b0"), ("b0", "b1")], friction=0.5, events=events), 0.005, 1.5)
    a = G + amplitude * rate**2 * np.cos(rate * found.times[2:])
    np.testing.assert_allclose(found["b0-b1.normal_force"][2:], MASS * a, atol=2e-3 * WEIGHT)
    np.testing.assert_allclose(found["deck-b0.normal_force"][2:], 2.0 * MASS * a, atol=4e-3 * WEIGHT)
    np.testing.assert_allclose(found["deck-b0.normal_force_min"][2:], 2.0 * MASS * a, atol=4e-3 * WEIGHT)


@EVENTS
def test_a_box_leaves_a_floor_that_heaves_and_lands_on_it(events: bool) -> None:
    """Nothing in flight; from the step of the landing on again ``m (g + z'')``, whatever is left of that step."""
    amplitude, rate = 0.4, 2.0 * np.pi
    heave = Driven(z=Profile(harmonics=(Harmonic(amplitude, 1.0, -0.5 * np.pi),)))
    deck = replace(body("deck", mass=1e4, inertia=1e5), motion=heave)
    box = body("b0", (0.0, 0.0, 0.5 - amplitude))
    found = run(
        scene([(deck, DECK), (box, CUBE)], None, [("deck", "b0")], friction=0.5, events=events), 0.005, 2.0
    )
    height = found["b0.position"][:, 2] - 0.5 - found["deck.position"][:, 2]
    needed = MASS * (G + amplitude * rate**2 * np.cos(rate * found.times))
    flies = height > 1e-6
    landing = ~flies & np.append(False, flies[:-1])
    force = found["deck-b0.normal_force"]
    assert flies.sum() > 200
    assert landing.sum() == 2
    assert not force[flies].any()
    rests = ~flies & (needed > 0.0)
    rests[0] = False
    if not events:  # the row that has stopped it tells no force of that step
        assert not force[landing].any()
        rests &= ~landing
    np.testing.assert_allclose(force[rests], needed[rests], atol=4e-3 * WEIGHT)
    assert found["deck-b0.normal_force_max"].max() < needed.max() + 4e-3 * WEIGHT


@pytest.mark.parametrize("step", [0.01, 0.005])
def test_friction_is_whole_while_corners_share_it_anew_in_each_step(step: float) -> None:
    """A box is pushed harder and harder until it slides: friction is the push, then its bound; the load is the weight.

    Above 0.44 of the weight some corners are at their bounds, and which ones of the others bear the rest changes from
    step to step.
    """
    forces = np.array([[0.0, 0.0, 0.0], [0.6 * WEIGHT, 0.0, 0.0]])
    push = PointForce("push", "b", np.zeros(3), np.array([0.0, 2.0]), forces)
    made = scene([(body("b", (0.0, 0.0, 0.5)), CUBE)], plane_surface(9.0), [("floor", "b")], friction=0.5)
    found = run(replace(made, forces=(Gravity(np.array([0.0, 0.0, -G])), push)), step, 1.8)
    borne = np.minimum(0.3 * found.times, 0.5) * WEIGHT
    steady = np.abs(found.times - 0.5 / 0.3) > 2.0 * step
    np.testing.assert_allclose(found["floor-b.force"][steady, 0], -borne[steady], atol=2e-3 * WEIGHT)
    np.testing.assert_allclose(found["floor-b.force"][2:, 2], WEIGHT, atol=2e-3 * WEIGHT)
    assert found["b.position"][-1, 0] > 1e-3


@pytest.mark.parametrize("step", [0.01, 0.002])
def test_a_box_falls_on_one_that_rests_without_events(step: float) -> None:
    """What meets without restitution stays together; its impulse is m sqrt(2 g h), and half of it stays in no jump."""
    bodies = [(body("a", (0.0, 0.0, 0.5)), CUBE), (body("b", (0.0, 0.0, 2.5)), CUBE)]
    floor = TriangleSurface(
        np.array([[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [9.0, 9.0, 0.0], [-9.0, 9.0, 0.0]]),
        np.array([[0, 1, 2], [0, 2, 3]]),
        0.0,
        "floor",
    )
    pile = scene(bodies, floor, [("floor", "a"), ("a", "b")], law=RigidLaw(), friction=0.5, events=False)
    found = run(pile, step, 0.9)
    speed = np.sqrt(2.0 * G)
    np.testing.assert_allclose(found["a.position"][:, 2], 0.5, atol=1e-6)
    after = found.times > speed / G + 2.0 * step
    np.testing.assert_allclose(found["b.position"][after, 2], 1.5, atol=1e-6)
    # within a step nobody knows what of its impulse is weight
    assert found["a-b.impact_impulse"][-1] == pytest.approx(MASS * speed, abs=1.5 * WEIGHT * step)
    assert found["energy.dissipated"][-1] == pytest.approx(WEIGHT, rel=1e-3 if step < 0.005 else 2e-2)
    assert found["floor-a.normal_force"][-1] == pytest.approx(2.0 * WEIGHT, rel=1e-6)


def test_a_stop_while_contacts_change_leaves_no_trace() -> None:
    """The corners of the lower box pass the seam of two faces of the floor at 2.56 s."""
    pile = pile_on_rocking_floor(2)
    whole = Simulation(pile, 0.01)
    whole.advance(240)
    states, expected = [], []
    for _ in range(40):
        states.append(whole.state())
        expected.append(whole.advance(1)[1])
    for i in (0, 14, 15, 16, 17, 39):
        again = Simulation(pile, 0.01)
        again.restore(states[i])
        np.testing.assert_array_equal(again.advance(40 - i)[1], np.vstack(expected[i:]))


def test_a_box_rides_on_a_floor_that_rocks_with_a_compliant_law() -> None:
    """Patches sink by a fraction of a millimetre and bear the same."""
    found = run(pile_on_rocking_floor(1, law=LinearLaw(4e6, 4e4)), 0.002, 1.0)
    normal = np.einsum("ni,ni->n", needed(found, 0, 1), turned(found.times)[:, :, 2])
    later = slice(200, None)
    np.testing.assert_allclose(found["deck-b0.normal_force"][later], normal[later], atol=5e-3 * WEIGHT)
    np.testing.assert_allclose(found["deck-b0.normal_force_min"][later], normal[later], atol=5e-3 * WEIGHT)


def test_boxes_that_press_each_other_sideways_weigh_what_they_weigh() -> None:
    """Three boxes flush in a row: what they press each other with changes in each step, with friction at its bound."""
    deck, spin = pile_on_rocking_floor(0).bodies[0], ANGLE * RATE * AXIS
    places = {f"b{i}": np.array([i - 1.0, 0.0, 0.5]) for i in range(3)}
    boxes = [
        (body(name, x, velocity=np.cross(spin, x - PIVOT), spin=spin), CUBE) for name, x in places.items()
    ]
    pairs = [*(("deck", name) for name in places), ("b0", "b1"), ("b1", "b2")]
    found = run(scene([(deck, DECK), *boxes], None, pairs, friction=0.6), 0.01, 1.0)
    a = ANGLE * np.sin(RATE * found.times)[:, np.newaxis]
    rate, turning = ANGLE * RATE * np.cos(RATE * found.times)[:, np.newaxis], -(RATE**2) * a
    expected = np.zeros((len(a), 3))
    for x in places.values():
        arm = turned(found.times) @ (x - PIVOT)
        tangential = turning * np.cross(AXIS, arm)
        expected += MASS * (tangential + rate**2 * np.cross(AXIS, np.cross(AXIS, arm)) + (0.0, 0.0, G))
    total = sum(found[f"deck-{name}.force"] for name in places)
    np.testing.assert_allclose(total[2:], expected[2:], atol=2e-3 * 3.0 * WEIGHT)
