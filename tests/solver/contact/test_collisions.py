"""Bodies with surfaces of triangles that hit each other: closed forms of impacts, friction, compliance and rolling.

All scenes but the last group are of one kind, so what a run needs is compiled once.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from mesh_contact_scenes import (
    MASS,
    G,
    after_impulse,
    ball,
    body,
    irregular_floor,
    momenta,
    point_response,
    reversed_windings,
    run,
    scene,
    tilted,
    turn,
)

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.numerics.rotation import quaternion_product, rotation_matrix
from heavylift.preprocess.surfaces.primitives import (
    box_surface,
    capsule_surface,
    plane_surface,
    sphere_surface,
)
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.scene.bodies import Driven, Profile
from heavylift.solver.scene.contacts import HuntCrossleyLaw, LinearLaw, RigidLaw
from heavylift.solver.simulation import Simulation

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1800)]

CUBE, FLOOR = box_surface(1.0), plane_surface(60.0)
STEP = 0.01
WEIGHT = MASS * G
EVENTS = pytest.mark.parametrize("events", [True, False])


def standing(height: float = 0.0, **options: Any) -> list[Any]:
    """A cube of 1 m with its lower face at a height; its edges cross those of the floor's triangles."""
    return [(body("box", (0.13, 0.07, 0.5 + height), **options), CUBE)]


def two(bodies: list[Any], **options: Any) -> Any:
    """Two bodies in free flight."""
    return scene(bodies, None, [(bodies[0][0].name, bodies[1][0].name)], gravity=(0.0, 0.0, 0.0), **options)


# impacts


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_a_box_dropped_by_1_m_comes_back_to_e_squared(e: float) -> None:
    found = run(scene(standing(1.0), FLOOR, law=RigidLaw(restitution=e)), STEP, 0.9)
    z, v = found["box.position"][:, 2] - 0.5, found["box.velocity"][:, 2]
    flight = (found.times > 0.46) & (found.times < 0.55)
    np.testing.assert_allclose((z + v * v / (2.0 * G))[flight], e * e, atol=2e-8)
    assert z.min() > -1e-9
    row = int(np.argmax(found["floor-box.impacts"] > 0.0))
    impulse = MASS * (1.0 + e) * np.sqrt(2.0 * G)
    rests = WEIGHT * STEP if e == 0.0 else 0.0  # it bears its weight for the rest of the step
    assert impulse * (1.0 - 1e-8) <= found["floor-box.impulse"][row] <= impulse * (1.0 + 1e-8) + rests
    assert np.abs(found["box.angular_velocity"]).max() < 1e-8
    assert found.drift < 1e-11 * WEIGHT


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_without_events_the_impact_is_at_the_end_of_its_step(e: float) -> None:
    """It then has a speed that belongs to a time within that step: an error of the first order, never a gain."""
    for step in (0.01, 0.001):
        found = run(scene(standing(1.0), FLOOR, law=RigidLaw(restitution=e), events=False), step, 0.6)
        z, v = found["box.position"][:, 2] - 0.5, found["box.velocity"][:, 2]
        flight = (found.times > 0.47) & (found.times < 0.53)
        apex = (z + v * v / (2.0 * G))[flight]
        assert np.ptp(apex) < 1e-9
        assert e * e * (1.0 - 2.0 * step / np.sqrt(2.0 / G)) - 1e-9 <= apex[0] <= e * e + 1e-9
        assert z.min() > -1e-8
        assert found.drift < 1e-10 * WEIGHT  # what the floor gains by pushing the box out is no negative loss


@EVENTS
@pytest.mark.parametrize("friction", [0.0, 0.4])
@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_two_free_boxes_keep_their_momenta(e: float, friction: float, events: bool) -> None:
    """Off centre, turning; they fly apart, their energy falls, and what is lost is booked."""
    a = body("a", size=(1.0, 0.8, 0.6), spin=(0.3, -0.2, 0.5))
    b = body(
        "b",
        (1.5, 0.25, 0.17),
        mass=37.0,
        size=(0.5, 0.7, 0.4),
        velocity=(-3.0, 0.2, -0.1),
        orientation=turn((1.0, 2.0, 3.0), 0.7),
        spin=(-1.0, 0.5, 0.3),
    )
    hit = two(
        [(a, box_surface((1.0, 0.8, 0.6))), (b, box_surface((0.5, 0.7, 0.4)))],
        law=RigidLaw(restitution=e),
        friction=friction,
        events=events,
    )
    found = run(hit, STEP, 2.0)
    np.testing.assert_allclose(momenta(found, hit), momenta(found, hit)[:1].repeat(201, 0), atol=1e-11)
    energy = found["energy.kinetic"]
    assert energy.max() < energy[0] * (1.0 + 1e-5)
    assert found["a-b.impacts"][-1] > 0.0
    assert found["a-b.dissipated"][-1] > -1e-6 * energy[0]
    if e < 1.0 or friction > 0.0:
        assert found["a-b.dissipated"][-1] > 1e-3 * energy[0]
    assert found.drift < 1e-5 * energy[0]


def crossed_beams(
    velocity: tuple[float, float, float], places: tuple[float, float] = (0.3, -0.2), angle: float = 1.1
) -> tuple[Any, Any, Any, Any, Any]:
    """A beam on its edge, another above it on its own; places along both where they will cross after 16.5 ms.

    Returns the two bodies at that time, their surface, the point, and the second one at the start.
    """
    length, width = 2.0, 0.2
    half = width / np.sqrt(2.0)
    roll = turn((1.0, 0.0, 0.0), np.pi / 4.0)
    q = quaternion_product(tuple(turn((0.0, 0.0, 1.0), angle)), tuple(roll))
    point = np.array([places[0], 0.0, half])
    along = np.array([np.cos(angle), np.sin(angle), 0.0])
    size = (length, width, width)
    lower = body("a", size=size, orientation=roll)
    above = point + np.array([0.0, 0.0, half]) - places[1] * along
    upper = body("b", above, mass=60.0, size=size, orientation=q, velocity=velocity)
    start = replace(upper, position=above - 0.0165 * np.array(velocity))
    return lower, upper, box_surface(size), point, start


def check_velocities(
    found: Any, row: int, expected: dict[str, Any], bodies: dict[str, Any], rel: float
) -> None:
    """Velocities, and angular momenta about the own centres, which free flight does not change."""
    for name, (velocity, spin) in expected.items():
        np.testing.assert_allclose(
            found[f"{name}.velocity"][row], velocity, atol=rel * np.linalg.norm(velocity)
        )
        R = rotation_matrix(found[f"{name}.orientation"][row])
        momentum = R @ bodies[name].inertia @ found[f"{name}.angular_velocity"][row]
        before = rotation_matrix(bodies[name].orientation) @ bodies[name].inertia @ spin
        np.testing.assert_allclose(momentum, before, atol=rel * max(np.linalg.norm(before), 1.0))


@pytest.mark.parametrize("e", [0.5, 1.0])
def test_edge_hits_edge_with_the_impulse_of_two_bodies(e: float) -> None:
    lower, upper, skin, point, start = crossed_beams((0.0, 0.0, -2.0))
    found = run(two([(lower, skin), (start, skin)], law=RigidLaw(restitution=e)), STEP, 0.1)
    response = point_response(lower, point) + point_response(upper, point)
    impulse = np.array([0.0, 0.0, (1.0 + e) * 2.0 / response[2, 2]])
    row = int(np.argmax(found["a-b.impacts"] > 0.0)) + 1
    assert found["a-b.impulse"][row] == pytest.approx(impulse[2], rel=1e-8)
    expected = {"a": after_impulse(lower, point, -impulse), "b": after_impulse(upper, point, impulse)}
    check_velocities(found, row, expected, {"a": lower, "b": upper}, 1e-7)


@pytest.mark.parametrize("e", [0.0, 0.5])
@pytest.mark.parametrize("across", [(4.0, 0.0), (2.5, -3.0)])
def test_edge_hits_edge_obliquely_with_the_friction_of_a_sliding_impact(
    e: float, across: tuple[float, float]
) -> None:
    """Over the middles of both: friction against the sliding velocity at the bound ``mu p_n``."""
    friction, velocity = 0.1, np.array([*across, -2.0])
    lower, upper, skin, point, start = crossed_beams(tuple(velocity), (0.0, 0.0), np.pi / 2.0)
    hit = two([(lower, skin), (start, skin)], law=RigidLaw(restitution=e), friction=friction)
    found = run(hit, 1e-4, 0.018)
    response = point_response(lower, point) + point_response(upper, point)
    slide = np.append(across, 0.0) / np.linalg.norm(across)
    push = np.array([0.0, 0.0, 1.0]) - friction * slide
    impulse = (1.0 + e) * 2.0 / (response[2] @ push) * push
    after = velocity + response @ impulse
    assert after @ slide > 0.5  # slides on all the time
    if (
        across[1] == 0.0
    ):  # and in the same direction, if the response is the same across: one direction at least
        assert abs(after[1]) < 1e-12
    row = int(np.argmax(found["a-b.impacts"] > 0.0))
    expected = {"a": after_impulse(lower, point, -impulse), "b": after_impulse(upper, point, impulse)}
    for name, (speed, _) in expected.items():
        scale = np.linalg.norm(impulse) / MASS
        tolerance = 1e-6 if across[1] == 0.0 else 2e-2  # Coulomb at the end of the impact, not along it
        np.testing.assert_allclose(found[f"{name}.velocity"][row], speed, atol=tolerance * scale)


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_a_plate_without_thickness_hits_with_its_edge(e: float) -> None:
    angle, width, speed = np.radians(30.0), 1.0, 2.0
    inertia = MASS * width**2 / 12.0
    plate = body(
        "plate",
        (0.0, 0.0, width / 2.0 * np.sin(angle) + 0.033),
        size=(width, 0.8, 0.0),
        orientation=turn((0.0, 1.0, 0.0), angle),
        velocity=(0.0, 0.0, -speed),
    )
    thin = plane_surface((width, 0.8))
    found = run(
        scene([(plate, thin)], FLOOR, gravity=(0.0, 0.0, 0.0), law=RigidLaw(restitution=e)), 1e-3, 0.02
    )
    lever = width / 2.0 * np.cos(angle)
    impulse = (1.0 + e) * speed / (1.0 / MASS + lever**2 / inertia)
    row = int(np.argmax(found["floor-plate.impacts"] > 0.0))
    assert found.times[row] == pytest.approx(0.017)
    np.testing.assert_allclose(
        found["plate.velocity"][row], [0, 0, impulse / MASS - speed], atol=1e-2 if e == 0 else 1e-7
    )
    np.testing.assert_allclose(
        found["plate.angular_velocity"][row],
        [0, -lever * impulse / inertia, 0],
        atol=1e-2 if e == 0 else 1e-7,
    )
    assert found["floor-plate.impacts"][row] == 2.0  # both corners of the edge


def test_a_ball_hits_the_edge_of_a_box() -> None:
    """At 45 degrees without friction: it leaves horizontally with the speed it came with."""
    radius, drop = 0.3, 0.2
    beside = 0.5 + radius / np.sqrt(2.0)
    one = ball("ball", (beside, 0.05, beside + drop), radius, velocity=(0.0, 0.0, -1.0))
    found = run(scene([(one, sphere_surface(radius))], CUBE, law=RigidLaw(restitution=1.0)), STEP, 0.4)
    speed = np.sqrt(1.0 + 2.0 * G * drop)
    t = found.times - (speed - 1.0) / G
    later = t > 0.0
    place = np.column_stack(
        [beside + speed * t[later], np.full(later.sum(), 0.05), beside - 0.5 * G * t[later] ** 2]
    )
    np.testing.assert_allclose(found["ball.position"][later], place, atol=1e-8)
    assert found["floor-ball.impacts"][-1] == 1.0
    assert found.drift < 1e-9 * WEIGHT


# friction


@EVENTS
@pytest.mark.parametrize("excess", [-1e-3, -1e-6, 1e-6, 1e-3])
def test_a_box_on_an_incline_sticks_below_the_threshold_and_slides_above(excess: float, events: bool) -> None:
    friction = 0.5
    angle = np.arctan(friction * (1.0 + excess))
    found = run(scene(standing(), FLOOR, gravity=tilted(angle), friction=friction, events=events), STEP, 10.0)
    x = found["box.position"][:, 0] - 0.13
    slide = max(0.0, G * (np.sin(angle) - friction * np.cos(angle)))
    if slide > 0.0:
        assert x[-1] == pytest.approx(0.5 * slide * 100.0, rel=1e-6)
    else:
        assert np.abs(x).max() < 1e-9
        assert np.ptp(x[500:]) < 1e-9
    assert found["floor-box.normal_force"][-1] == pytest.approx(WEIGHT * np.cos(angle), rel=1e-12)
    np.testing.assert_allclose(found["box.orientation"][-1, 1:], 0.0, atol=1e-8)
    assert found.drift < 1e-10 * WEIGHT


@EVENTS
@pytest.mark.parametrize("speed", [1.0, 3.0])
def test_friction_stops_a_box_after_its_stopping_distance(speed: float, events: bool) -> None:
    friction = 0.3
    begin = standing(velocity=(speed, 0.0, 0.0))
    found = run(scene(begin, FLOOR, friction=friction, events=events), STEP, 2.0)
    x = found["box.position"][:, 0] - 0.13
    assert x[-1] == pytest.approx(speed**2 / (2.0 * friction * G), abs=0.5 * speed * STEP)
    assert np.ptp(x[-50:]) < 1e-12
    assert found["floor-box.dissipated"][-1] == pytest.approx(0.5 * MASS * speed**2, rel=1e-8)
    assert found.drift < 1e-9 * WEIGHT


@pytest.mark.parametrize("excess", [-1e-3, 1e-3])
def test_a_compliant_box_on_an_incline_sticks_and_slides(excess: float) -> None:
    friction, law = 0.5, LinearLaw(4e7, 4e4)
    angle = np.arctan(friction * (1.0 + excess))
    begin = standing(-WEIGHT * np.cos(angle) / law.stiffness)
    found = run(
        scene(begin, FLOOR, gravity=tilted(angle), friction=friction, law=law, patch_size=2.0), STEP, 10.0
    )
    x = found["box.position"][:, 0] - 0.13
    slide = max(0.0, G * (np.sin(angle) - friction * np.cos(angle)))
    if slide > 0.0:
        late = found.times > 5.0
        fit = np.polyfit(found.times[late], x[late], 2)
        assert 2.0 * fit[0] == pytest.approx(slide, rel=1e-4)
    else:
        assert np.abs(x).max() < 0.02  # the load comes at once: it swings, and slips a little
        assert np.ptp(x[500:]) < 1e-9


@EVENTS
def test_a_ball_rolls_down_an_incline(events: bool) -> None:
    """``5/7 g sin`` with enough friction; with less, it slides and turns by what friction there is."""
    radius, angle, t = 0.3, np.radians(20.0), 3.0
    one = [(ball("ball", (0.0, 0.0, radius), radius), sphere_surface(radius))]
    rolls = run(scene(one, FLOOR, gravity=tilted(angle), friction=0.5, events=events), STEP, t)
    speed = 5.0 / 7.0 * G * np.sin(angle) * t
    assert rolls["ball.position"][-1, 0] == pytest.approx(0.5 * speed * t, rel=1e-10)
    np.testing.assert_allclose(rolls["ball.angular_velocity"][-1], [0.0, speed / radius, 0.0], atol=1e-8)
    assert np.abs(rolls["ball.position"][:, 2] - radius).max() < 1e-11
    assert rolls["floor-ball.slip"].max() < 1e-12
    slides = run(scene(one, FLOOR, gravity=tilted(angle), friction=0.1, events=events), STEP, t)
    slide = G * (np.sin(angle) - 0.1 * np.cos(angle))
    turning = 2.5 * 0.1 * G * np.cos(angle) / radius
    assert slides["ball.position"][-1, 0] == pytest.approx(0.5 * slide * t * t, rel=1e-10)
    assert slides["ball.angular_velocity"][-1, 1] == pytest.approx(turning * t, rel=1e-9)


@EVENTS
def test_a_capsule_rolls_down_an_incline(events: bool) -> None:
    radius, angle, t = 0.3, np.radians(20.0), 3.0
    one = body("roll", (0.0, 0.0, radius), inertia=0.5 * MASS * radius**2)
    down = scene(
        [(one, capsule_surface(radius, 1.0, (0.0, 1.0, 0.0)))],
        FLOOR,
        gravity=tilted(angle),
        friction=0.5,
        events=events,
    )
    found = run(down, STEP, t)
    assert found["roll.position"][-1, 0] == pytest.approx(G * np.sin(angle) * t * t / 3.0, rel=1e-9)
    np.testing.assert_allclose(found["roll.position"][:, 1], 0.0, atol=1e-9)
    np.testing.assert_allclose(found["roll.orientation"][:, [1, 3]], 0.0, atol=1e-9)
    assert found.drift < 1e-9 * WEIGHT


# rest


@EVENTS
def test_a_box_at_rest_stays_for_a_minute(events: bool) -> None:
    found = run(scene(standing(), FLOOR, friction=0.5, events=events), STEP, 60.0)
    drift = found["box.position"][10:] - found["box.position"][10]
    assert np.abs(drift).max() < 1e-10
    assert found["floor-box.normal_force"][-1] == pytest.approx(WEIGHT, rel=1e-12)


@EVENTS
@pytest.mark.parametrize("gap", [0.0, 0.01])
@pytest.mark.parametrize("count", [10, 30])
def test_a_stack_stands(count: int, gap: float, events: bool) -> None:
    """Boxes beside each other by a few centimetres; each bears the weight of those above it."""
    random = np.random.default_rng(1)
    bodies, pairs = [], []
    for i in range(count):
        x, y = np.array([0.13, 0.07]) + 0.05 * random.standard_normal(2)
        bodies.append((body(f"b{i}", (x, y, 0.5 + i + gap * (i + 1))), CUBE))
        pairs.append(("floor" if i == 0 else f"b{i - 1}", f"b{i}"))
    options = {"friction": 0.5, "events": events, "most_contacts": 64, "recorded": 0}
    found = run(scene(bodies, FLOOR, pairs, **options), STEP, 5.0)
    for i, (a, b) in enumerate(pairs):
        assert found[f"{a}-{b}.normal_force"][-1] == pytest.approx((count - i) * WEIGHT, rel=1e-9)
        assert np.nanmin(found[f"{a}-{b}.gap"]) > -1e-6
    top = found[f"b{count - 1}.position"]
    assert top[-1, 2] == pytest.approx(count - 0.5, abs=1e-8)
    np.testing.assert_allclose(top[-1, :2], top[0, :2], atol=1e-7)
    assert np.ptp(top[-100:], axis=0).max() < 1e-12
    assert found.drift < 1e-6 * count * WEIGHT


@pytest.mark.parametrize("stiffness", [1e5, 1e8])
@pytest.mark.parametrize("floor", ["two triangles", "many triangles"])
def test_the_depth_of_a_patch_is_the_weight_over_its_stiffness(stiffness: float, floor: str) -> None:
    """However many features touch."""
    ground = irregular_floor(3.0, 20) if floor == "many triangles" else FLOOR
    law = LinearLaw(stiffness, 2.0 * np.sqrt(stiffness * MASS))
    found = run(scene(standing(), ground, law=law, patch_size=2.0), STEP, 10.0)
    assert found["floor-box.patches"][-1] == 1.0
    assert 0.5 - found["box.position"][-1, 2] == pytest.approx(WEIGHT / stiffness, rel=1e-6)
    assert found["floor-box.normal_force"][-1] == pytest.approx(WEIGHT, rel=1e-6)
    np.testing.assert_allclose(found["box.orientation"][-1, 1:], 0.0, atol=1e-9)


def damping_ratio(e: float) -> float:
    """Of a linear spring and damper that never pulls: ``e = exp(-z theta / s)``, theta = atan2(2 z s, 2 z^2 - 1)."""
    low, high = 0.0, 1.0
    for _ in range(200):
        z = 0.5 * (low + high)
        s = np.sqrt(1.0 - z * z)
        low, high = (z, high) if np.exp(-z * np.arctan2(2.0 * z * s, 2.0 * z * z - 1.0) / s) > e else (low, z)
    return low


@pytest.mark.parametrize("shape", ["ball", "box"])
@pytest.mark.parametrize("e", [0.8, 0.5, 0.2])
@pytest.mark.parametrize("law", ["hunt-crossley", "linear"])
def test_compliant_restitution_at_twenty_steps_a_pulse(law: str, e: float, shape: str) -> None:
    """``omega h = pi / 20``; the face of the box has four corners, which share its stiffness and its damper."""
    stiffness = 1e6
    omega = np.sqrt(stiffness / MASS)
    step = np.pi / omega / 20.0
    rule: Any = HuntCrossleyLaw(stiffness, 1.0, e)
    if law == "linear":
        rule = LinearLaw(stiffness, 2.0 * damping_ratio(e) * np.sqrt(stiffness * MASS))
    for phase in (0.0, 0.37, 0.61):
        above = (5.0 + phase) * step
        one = body("b", (0.0, 0.0, 0.5 + above), velocity=(0.0, 0.0, -1.0))
        skin = CUBE
        if shape == "ball":
            one, skin = (
                ball("b", (0.0, 0.0, 0.3 + above), 0.3, velocity=(0.0, 0.0, -1.0)),
                sphere_surface(0.3),
            )
        hit = scene([(one, skin)], FLOOR, gravity=(0.0, 0.0, 0.0), law=rule, patch_size=2.0)
        found = run(hit, step, 80.0 * step)
        # the linear damper begins with a jump of the force: of first order in the step for a heavy one
        limit = 3e-3 if law == "hunt-crossley" or e >= 0.5 else 8e-3
        assert found["b.velocity"][-1, 2] == pytest.approx(e, rel=limit)
        assert found.drift < 1e-12 * MASS
        assert np.abs(found["b.angular_velocity"]).max() < 1e-9


# meshes


def test_a_box_slides_over_many_triangles_as_over_two() -> None:
    """No ghost hits at inner edges, whatever the windings."""
    begin = [(body("box", (-2.987, -1.0, 0.5), velocity=(3.0, 1.2, 0.0)), CUBE)]
    smooth = run(scene(begin, plane_surface(12.0), friction=0.2), STEP, 2.0)
    for events in (True, False):
        rough = run(scene(begin, irregular_floor(6.0, 40), friction=0.2, events=events), STEP, 2.0)
        np.testing.assert_allclose(rough["box.position"], smooth["box.position"], atol=1e-9)
        np.testing.assert_allclose(rough["box.orientation"], smooth["box.orientation"], atol=1e-9)
        assert rough["floor-box.impacts"][-1] <= rough["floor-box.contacts"].max()


@EVENTS
def test_a_spinning_box_slides_over_many_triangles_without_friction(events: bool) -> None:
    """A corner of it meets hundreds of edges; it goes straight on and keeps its spin."""
    begin = [(body("box", (-2.987, -1.0, 0.5), velocity=(3.0, 1.2, 0.0), spin=(0.0, 0.0, 2.0)), CUBE)]
    found = run(scene(begin, irregular_floor(6.0, 40), events=events), STEP, 1.5)
    expected = begin[0][0].position + np.outer(found.times, (3.0, 1.2, 0.0))
    np.testing.assert_allclose(found["box.position"], expected, atol=1e-9)
    np.testing.assert_allclose(found["box.angular_velocity"][-1], [0.0, 0.0, 2.0], atol=1e-9)


def tumbling(**options: Any) -> list[Any]:
    return [
        (
            body(
                "box",
                (-2.987, -1.0, 1.2),
                velocity=(3.0, 1.2, 0.0),
                spin=(1.0, 2.0, 1.0),
                orientation=turn((1.0, 2.0, 0.3), 0.4),
            ),
            options.get("skin", CUBE),
        )
    ]


@EVENTS
def test_a_tumbling_box_comes_to_rest_on_many_triangles(events: bool) -> None:
    """Flat on the floor, on one of its faces, with its weight on it; no energy is made."""
    rough = scene(
        tumbling(), irregular_floor(8.0, 40), law=RigidLaw(restitution=0.3), friction=0.3, events=events
    )
    found = run(rough, STEP, 4.0)
    assert found["box.position"][-1, 2] == pytest.approx(0.5, abs=1e-6)
    assert found["floor-box.normal_force"][-1] == pytest.approx(WEIGHT, rel=1e-6)
    assert np.abs(found["box.velocity"][-1]).max() < 1e-9
    corners = found["box.position"][:, 2, None] + np.array(
        [(rotation_matrix(q) @ CUBE.points.T)[2] for q in found["box.orientation"]]
    )
    assert corners.min() > (-1e-6 if events else -2e-3)
    energy = found["energy.kinetic"] + found["energy.potential"]
    assert (energy - energy[0]).max() < 1e-6 * energy[0]
    # unsplit, what was not foreseen is inside by its way in a step, and pushed out
    assert found.drift < (1e-3 if events else 3e-2) * energy[0]


@EVENTS
def test_windings_do_not_matter(events: bool) -> None:
    """Until the first impact and through it: an exact mirror of numbers would need the order of edges as well."""
    mixed = TriangleSurface(
        CUBE.points, np.array([t if k % 2 else t[::-1] for k, t in enumerate(CUBE.triangles)]), 0.0, "mixed"
    )
    runs = []
    for floor, skin in (
        (FLOOR, CUBE),
        (reversed_windings(FLOOR), CUBE),
        (FLOOR, reversed_windings(CUBE)),
        (FLOOR, mixed),
    ):
        law = RigidLaw(restitution=0.6)
        runs.append(run(scene(tumbling(skin=skin), floor, law=law, friction=0.3, events=events), STEP, 0.7))
    assert runs[0]["floor-box.impacts"][-1] >= 1.0
    for other in runs[1:]:
        np.testing.assert_allclose(other["box.position"], runs[0]["box.position"], atol=1e-9)
        np.testing.assert_allclose(other["box.orientation"], runs[0]["box.orientation"], atol=1e-9)


@EVENTS
def test_the_order_of_the_surfaces_changes_the_sign_of_the_force_alone(events: bool) -> None:
    law = RigidLaw(restitution=0.6)
    one, other = (
        run(scene(tumbling(), FLOOR, law=law, friction=0.3, events=events, swap=swap), STEP, 0.7)
        for swap in (False, True)
    )
    assert one["floor-box.impacts"][-1] >= 1.0
    np.testing.assert_allclose(other["box.position"], one["box.position"], atol=1e-9)
    np.testing.assert_allclose(other["floor-box.force"], -one["floor-box.force"], atol=1e-4 * WEIGHT)
    np.testing.assert_allclose(other["floor-box.impulse"], one["floor-box.impulse"], rtol=1e-7)


# going on, stopping


@pytest.mark.parametrize(
    "options",
    [
        {"law": RigidLaw(restitution=0.3)},
        {"law": RigidLaw(restitution=0.3), "events": False},
        {"law": LinearLaw(1e6, 1e3)},
    ],
    ids=["events", "no events", "compliant"],
)
def test_a_saved_run_goes_on_bit_for_bit(options: dict[str, Any], tmp_path: Any) -> None:
    """In flight, near the floor, after impacts: contacts and lists are those of an unbroken run."""
    rough = scene(tumbling(), irregular_floor(6.0, 12), friction=0.3, **options)
    whole = Simulation(rough, STEP)
    _, expected = whole.advance(120)
    for cut in (5, 43, 47, 60, 90):
        first = Simulation(rough, STEP)
        first.advance(cut)
        np.savez(tmp_path / "state.npz", **first.state())
        first.advance(7)
        with np.load(tmp_path / "state.npz") as saved:
            state = dict(saved)
        for simulation in (first, Simulation(rough, STEP)):
            simulation.restore(state)
            _, tail = simulation.advance(120 - cut)
            np.testing.assert_array_equal(tail, expected[cut:])


@pytest.mark.parametrize("friction", [0.5, 0.0])
@pytest.mark.parametrize("step", [1e-3, 2.5e-4])
def test_what_is_crushed_is_told_to_give_way(friction: float, step: float) -> None:
    """A plate that is driven into boxes on the floor: no step and no friction help, a compliant law does."""
    down = Driven(z=Profile(times=np.array([0.0, 1.0]), values=np.array([0.0, -0.1])))
    boxes = [(body(f"box {i}", (1.3 * i, 0.0, 0.5)), CUBE) for i in range(3)]
    plate = (replace(body("plate", (1.3, 0.0, 1.26)), motion=down), box_surface((6.0, 2.0, 0.5)))
    pairs = [(other, one.name) for one, _ in boxes for other in ("floor", "plate")]
    options: dict[str, Any] = {"friction": friction, "pairs": pairs}
    crushed = Simulation(scene([*boxes, plate], FLOOR, law=RigidLaw(), **options), step)
    crushed.advance(round(0.5 / step))
    assert "a compliant law ('linear')" in crushed.message + crushed.warning
    assert "stops and ropes" not in crushed.message + crushed.warning
    gives = Simulation(scene([*boxes, plate], FLOOR, law=LinearLaw(1e8, 1e5), **options), step)
    gives.advance(round(0.5 / step))
    assert not gives.message + gives.warning


def test_a_stop_names_the_collision() -> None:
    full = Simulation(scene(standing(0.1), FLOOR, most_contacts=2, recorded=0), STEP)
    full.advance(100)
    assert full.outcome is Outcome.TOO_MANY_CONTACTS
    assert "collision 'floor-box'" in full.message
    assert "try a larger 'most_contacts'" in full.message
    assert full.time == pytest.approx(0.14, abs=0.011)  # the last good step before it lands at 0.143 s


def test_a_start_deep_inside_is_refused() -> None:
    with pytest.raises(InputError, match=r"floor-box: between: .* 0\.1 m deep"):
        Simulation(scene(standing(-0.1), FLOOR), STEP).advance(1)


@EVENTS
def test_a_start_a_little_inside_is_pushed_out(events: bool) -> None:
    found = run(scene(standing(-5e-5), FLOOR, events=events), STEP, 2.0)
    z = found["box.position"][:, 2] - 0.5
    assert z.min() > -5.1e-5
    assert z[-1] == pytest.approx(0.0, abs=1e-5)
    assert np.abs(found["box.velocity"]).max() < 0.01
    assert found["floor-box.normal_force"][-1] == pytest.approx(WEIGHT, rel=1e-6)


@pytest.mark.parametrize("start", ["check", "equilibrium"])
def test_what_stands_bears_from_the_start(start: str) -> None:
    """The record at t = 0 has the forces, so the smallest of a block at rest is its weight; steps are as before."""

    def first(of: Any, name: str) -> float:
        simulation = Simulation(of, STEP, start=start)
        row = simulation.record()
        (column,) = (channel.column for channel in simulation.channels if channel.name == f"floor-box.{name}")
        return float(row[column])

    stands = scene(standing(0.0), FLOOR)
    for name in ("normal_force", "normal_force_min", "normal_force_max"):
        assert first(stands, name) == pytest.approx(WEIGHT, rel=1e-9)
    assert first(stands, "impulse") == first(stands, "impacts") == 0.0
    if start == "check":
        hits = scene(
            [(body("box", (0.0, 0.0, 0.5), velocity=(0.0, 0.0, -1.0)), CUBE)], FLOOR, law=RigidLaw(0.5)
        )
        assert first(hits, "normal_force") == 0.0


def rolling_ball() -> Any:
    """A ball in a trough of flat strips, the collision "floor-ball".

    A ball that comes onto the next strip is inside it by its way in a step, and is pushed out: more energy than the
    blow at the ridge takes at 10 ms, in the balance as a gain. It falls with the square of the step at least.
    """
    radius, inner, strips = 2.0, 0.3, 60
    angles = np.linspace(-0.5 * np.pi, 0.5 * np.pi, strips + 1)
    rim = np.array([[radius * np.sin(a), 0.0, radius * (1.0 - np.cos(a))] for a in angles])
    width = np.array([0.0, 3.0, 0.0])
    points = np.vstack([rim - width, rim + width])
    triangles = [[i, i + 1, strips + 2 + i] for i in range(strips)]
    triangles += [[i, strips + 2 + i, strips + 1 + i] for i in range(strips)]
    trough = TriangleSurface(points, np.array(triangles))
    start = (radius - inner) * np.array([np.sin(0.8), 0.0, -np.cos(0.8)]) + [0.0, 0.0, radius + 2e-3]
    return scene([(ball("ball", start, inner), sphere_surface(inner))], trough, friction=0.4)


def beside(one: Any, other: Any) -> Any:
    """A scene and one on a floor of its own, "plane", which have nothing to do with each other."""
    return replace(
        one,
        bodies=(*one.bodies, *other.bodies),
        surfaces=(*one.surfaces, replace(other.surfaces[0], name="plane"), *other.surfaces[1:]),
        collisions=(
            *one.collisions,
            *(replace(hit, name="other", surfaces=("plane", hit.surfaces[1])) for hit in other.collisions),
        ),
    )


@pytest.mark.slow
@pytest.mark.parametrize("step", [0.01, 0.002])
def test_what_contacts_gain_is_no_negative_dissipation(step: float) -> None:
    """A ball rolls to and fro in a trough of flat strips: what has been lost never falls, and what is won is told."""
    found = run(rolling_ball(), step, 10.0)
    lost, balance = found["floor-ball.dissipated"], found["energy.balance"]
    assert np.diff(lost).min() >= -1e-12 * lost[-1]
    np.testing.assert_allclose(
        balance, found["energy.kinetic"] + found["energy.potential"] + lost, rtol=0.0, atol=1e-9
    )
    gained = balance[-1] - balance[0]
    if step == 0.01:
        assert gained > 0.02 * found["energy.kinetic"].max()
        assert "energy grew by" in found.simulation.warning
    else:
        assert abs(gained) < 1e-3 * found["energy.kinetic"].max()


@pytest.mark.slow
def test_what_stores_more_on_other_facets_is_a_gain() -> None:
    """The same ball with a compliant law: contacts that go over to the next strip store what nothing has paid for.

    What dampers and friction take does not hang on the step, which the gain does.
    """
    of, gained, lost = rolling_ball(), [], []
    of = replace(of, collisions=(replace(of.collisions[0], law=LinearLaw(1e6, 1e3)),))
    for step in (0.01, 0.005, 0.002):
        found = run(of, step, 10.0)
        dissipated, energy = (
            found["floor-ball.dissipated"],
            found["energy.kinetic"] + found["energy.potential"],
        )
        assert np.diff(dissipated).min() >= -1e-12 * dissipated[-1]
        balance = energy + found["energy.elastic"] + dissipated
        np.testing.assert_allclose(found["energy.balance"], balance, rtol=0.0, atol=1e-9)
        gained.append((balance[-1] - balance[0]) / found["energy.kinetic"].max())
        lost.append(dissipated[-1])
        assert "energy grew by" in found.simulation.warning
    assert gained[0] > 0.1
    assert gained[0] > gained[1] > gained[2] > 0.02
    np.testing.assert_allclose(lost, lost[-1], rtol=0.25)


def test_a_gain_is_not_hidden_by_what_rubs_elsewhere() -> None:
    """A box slides on a floor of its own and loses more in each step than the ball can gain."""
    box = body("box", (0.0, 10.0, 0.5), mass=1.0, velocity=(22.0, 0.0, 0.0))
    slides = scene([(box, box_surface(1.0))], plane_surface(400.0), friction=0.3)
    alone, both = (run(one, 0.01, 7.0) for one in (rolling_ball(), beside(rolling_ball(), slides)))
    gained = alone["energy.balance"][-1] - alone["energy.balance"][0]
    assert gained > 0.02 * alone["energy.kinetic"].max()
    assert both["energy.balance"][-1] - both["energy.balance"][0] == pytest.approx(gained, rel=1e-3)
    assert "energy grew by" in both.simulation.warning
    travel = both["box.position"][-1, 0]
    assert both["other.dissipated"][-1] == pytest.approx(0.3 * 1.0 * G * travel, rel=1e-3)


@pytest.mark.parametrize(("step", "gap"), [(2e-6, 0.0), (1e-4, 1e-9), (1e-3, 0.0)])
def test_a_box_at_rest_makes_no_energy_worth_a_word(step: float, gap: float) -> None:
    """It settles by a part of what gaps are found to, 1e-10 of its size; its kinetic energy is nothing beside that."""
    found = run(scene(standing(gap), FLOOR), step, 200 * step)
    assert np.ptp(found["box.position"][:, 2]) <= gap + 1e-10
    assert not found.simulation.warning


def told(simulation: Simulation) -> str:
    """What is told of the steps that contacts have taken without impacts of their own."""
    return next(part for part in simulation.warning.split("; ") if "without end" in part)


def test_what_is_counted_goes_on_with_a_run() -> None:
    """Steps whose impacts have no end: those before a checkpoint count, those after it count once."""
    whole = Simulation(rolling_ball(), STEP)
    whole.advance(400)
    first = Simulation(rolling_ball(), STEP)
    first.advance(200)
    state, before = first.state(), told(first)
    first.advance(100)
    assert before != told(first) != told(whole)
    for simulation in (first, Simulation(rolling_ball(), STEP)):
        simulation.restore(state)
        assert told(simulation) == before
        simulation.advance(200)
        assert told(simulation) == told(whole)


def test_a_run_that_stops_counts_its_steps_once() -> None:
    """The good steps before a stop are taken again."""
    falls = (body("box", (0.13, 10.0, 40.0)), CUBE)
    stopping = beside(rolling_ball(), scene([falls], FLOOR, most_contacts=2, recorded=0))
    stopped = Simulation(stopping, STEP)
    stopped.advance(400)
    assert stopped.outcome is Outcome.TOO_MANY_CONTACTS
    good = Simulation(stopping, STEP)
    good.advance(stopped.step_index)
    assert good.outcome is Outcome.COMPLETED
    assert told(stopped) == told(good)


@pytest.mark.parametrize("step", [1e-3, 2.5e-4])
def test_the_largest_force_of_a_box_that_tips_over_is_its_weight(step: float) -> None:
    """It lands on a corner and comes to lie on a face: blows have impulses, and steps that they cut have no forces."""
    cube = body("box", (0.0, 0.0, 0.9), orientation=turn((0.3, 1.0, 0.0), 0.5))
    found = run(scene([(cube, box_surface(1.0))], FLOOR, friction=0.4), step, 2.0)
    assert found["floor-box.normal_force_max"].max() < 1.1 * WEIGHT
    assert found["floor-box.normal_force"][-1] == pytest.approx(WEIGHT, rel=1e-6)
