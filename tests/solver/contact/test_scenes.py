"""A rigid ball on a surface of the ground: impacts, rolling, sliding, force laws, restarts; one compiled scene."""

from __future__ import annotations

import numpy as np
import pytest
from contact_scenes import DOWN, MASS, RADIUS, G, ball, ball_on_floor, run, surface, tilted, touch
from scipy.integrate import solve_ivp
from scipy.interpolate import BSpline
from scipy.special import beta

from heavylift.contours.splines.neutral import neutral_surface
from heavylift.numerics.outcome import InputError
from heavylift.solver.contact import contour_packing
from heavylift.solver.scene.contacts import (
    BilateralLaw,
    Contour,
    HertzLaw,
    HuntCrossleyLaw,
    LinearLaw,
    PointShape,
    RigidLaw,
)
from heavylift.solver.scene.scene import Driven, Gravity, Profile, RigidBody, Scene
from heavylift.solver.simulation import Simulation

pytestmark = pytest.mark.slow  # the scene is compiled

STEP = 0.01
PULSE_STEPS = 20
REGULAR = 1e-6
"""Rows of contacts are regularised by 1e-7 of the inverse mass, which an impact shows in its end velocity."""


def apex(heights):
    """Highest point of the parabola through the three highest of equally spaced records in free flight."""
    k = int(np.argmax(heights))
    before, middle, after = heights[k - 1 : k + 2]
    return middle - (after - before) ** 2 / (8.0 * (after - 2.0 * middle + before))


@pytest.mark.parametrize("restitution", [0.5, 0.9, 1.0])
def test_ball_returns_to_restitution_squared_of_its_height(restitution):
    found = run(ball_on_floor(ball([0.1, 0.05, 1.0 + RADIUS]), RigidLaw(restitution)), STEP, 1.2)
    fall = np.sqrt(2.0 / G)
    flight = (found.times > fall + STEP) & (found.times < fall * (1.0 + 2.0 * restitution) - STEP)
    heights = found["ball.position"][flight, 2] - RADIUS
    assert abs(apex(heights) - restitution**2) < REGULAR
    energy = heights + found["ball.velocity"][flight, 2] ** 2 / (2.0 * G)
    assert np.abs(energy - restitution**2).max() < REGULAR
    assert found["touch.impacts"][flight][-1] == 1.0
    # the impulse of the impact, and what it has lost
    speed = np.sqrt(2.0 * G)
    assert np.isclose(found["touch.impulse"][flight][0], MASS * speed * (1.0 + restitution), rtol=REGULAR)
    lost = (1.0 - restitution**2) * MASS * G
    assert np.isclose(found["touch.dissipated"][flight][0], lost, rtol=REGULAR, atol=REGULAR * MASS * G)
    assert found.drift < 1e-8


def test_ball_without_restitution_rests_with_its_weight():
    found = run(ball_on_floor(ball([0.1, 0.05, 1.0 + RADIUS])), STEP, 1.5)
    rest = found.times > np.sqrt(2.0 / G) + 3.0 * STEP
    assert np.abs(found["ball.position"][rest, 2] - RADIUS).max() < 1e-9
    assert np.abs(found["touch.normal_force"][rest] - MASS * G).max() < 1e-8
    assert np.abs(found["touch.force"][rest] - [0.0, 0.0, MASS * G]).max() < 1e-8
    # at rest before and after: the sum of impulses is that of the weight
    assert np.isclose(found["touch.impulse"][-1], MASS * G * 1.5, rtol=1e-9)
    assert np.isclose(found["touch.dissipated"][-1], MASS * G, rtol=1e-8)
    assert found.drift < 1e-8


def test_bouncing_ball_comes_to_rest_within_its_geometric_series():
    restitution, height = 0.5, 1.0
    found = run(ball_on_floor(ball([0.1, 0.05, height + RADIUS]), RigidLaw(restitution)), STEP, 1.6)
    end = np.sqrt(2.0 * height / G) * (1.0 + restitution) / (1.0 - restitution)
    rest = found.times > end + 2.0 * STEP
    assert np.abs(found["ball.velocity"][rest]).max() < 1e-6
    assert np.abs(found["ball.position"][rest, 2] - RADIUS).max() < 1e-8
    assert np.isclose(found["touch.impulse"][-1], MASS * G * 1.6, rtol=1e-7)
    assert found.drift < 1e-7


def test_bounces_without_events_lose_no_more_than_a_step():
    """Impacts at ends of steps: at most the way of one step is lost, and no energy is won."""
    found = run(ball_on_floor(ball([0.1, 0.05, 1.0 + RADIUS]), RigidLaw(1.0, events=False)), 1e-3, 1.0)
    total = found["energy.kinetic"] + found["energy.potential"]
    assert total.max() <= total[0] + 1e-9
    assert found["ball.position"][:, 2].min() > RADIUS - np.sqrt(2.0 * G) * 1.01e-3
    assert found["ball.position"][600:, 2].max() > RADIUS + 0.98


@pytest.mark.parametrize(
    ("friction", "acceleration", "force"),
    [
        (0.5, 5.0 / 7.0 * G * np.sin(0.3), 2.0 / 7.0 * MASS * G * np.sin(0.3)),
        (0.05, G * (np.sin(0.3) - 0.05 * np.cos(0.3)), 0.05 * MASS * G * np.cos(0.3)),
        (0.0, G * np.sin(0.3), 0.0),
    ],
    ids=["rolls", "slides", "frictionless"],
)
def test_ball_on_an_incline(friction, acceleration, force):
    scene = ball_on_floor(ball([-0.5, 0.05, RADIUS]), gravity=tilted(0.3), friction=friction)
    found = run(scene, STEP, 0.5)
    way = found["ball.position"][:, 0] + 0.5
    assert np.abs(way - 0.5 * acceleration * found.times**2).max() < 1e-8
    assert np.abs(found["touch.friction_force"][3:] - force).max() < 1e-6
    assert np.abs(found["touch.normal_force"][3:] - MASS * G * np.cos(0.3)).max() < 1e-8
    spin = 2.5 * force / (MASS * RADIUS) * found.times
    assert np.abs(found["ball.angular_velocity"][:, 1] - spin).max() < 1e-6
    slip = (acceleration * found.times - RADIUS * spin) if friction < 0.1 else np.zeros_like(way)
    assert np.abs(found["touch.slip"][3:] - slip[3:]).max() < 1e-6
    lost = np.trapezoid(force * slip, found.times)
    assert abs(found["touch.dissipated"][-1] - lost) < 1e-6
    assert found.drift < 1e-9


@pytest.mark.parametrize("share", [0.98, 1.02])
def test_rolling_needs_two_sevenths_of_the_slope(share):
    friction = share * 2.0 / 7.0 * np.tan(0.3)
    scene = ball_on_floor(ball([-0.5, 0.05, RADIUS]), gravity=tilted(0.3), friction=friction)
    slip = run(scene, STEP, 0.5)["touch.slip"][-1]
    # below the threshold the touching point runs away at g (sin - 7/2 mu cos)
    expected = max(0.0, G * (np.sin(0.3) - 3.5 * friction * np.cos(0.3))) * 0.5
    assert abs(slip - expected) < 1e-6
    assert (slip > 1e-3) == (share < 1.0)


@pytest.mark.parametrize("share", [0.98, 1.02])
def test_point_sticks_above_the_slope(share):
    friction = share * np.tan(0.3)
    scene = ball_on_floor(ball([-0.5, 0.05, 0.0]), gravity=tilted(0.3), friction=friction, shape=PointShape())
    found = run(scene, STEP, 0.5)
    expected = 0.5 * max(0.0, G * (np.sin(0.3) - friction * np.cos(0.3))) * 0.5**2
    assert abs(found["ball.position"][-1, 0] + 0.5 - expected) < 1e-7


def test_sliding_ball_ends_up_rolling_with_five_sevenths():
    """Thrown without spin: friction turns it until it rolls, at 5/7 of its speed whatever the friction."""
    friction, speed = 0.3, 1.0
    scene = ball_on_floor(ball([-0.9, 0.0, RADIUS], [speed, 0.0, 0.0]), friction=friction)
    found = run(scene, 2e-3, 0.5)
    until = 2.0 / 7.0 * speed / (friction * G)
    slides = found.times < until - 4e-3
    assert (
        np.abs(found["ball.velocity"][slides, 0] - (speed - friction * G * found.times[slides])).max() < 1e-9
    )
    rolls = found.times > until + 4e-3
    assert np.abs(found["ball.velocity"][rolls, 0] - 5.0 / 7.0 * speed).max() < 1e-9
    assert np.isclose(found["touch.dissipated"][-1], MASS * speed**2 / 7.0, rtol=2e-2)
    assert found.drift < 1e-9


def test_oblique_impact_with_friction_obeys_coulomb():
    """Slides through the impact: tangential impulse mu (1 + e) m v_n; sticks: 2/7 of the tangential momentum."""
    for friction, kept in [(0.1, 2.0 - 0.1 * 1.5 * 2.0), (2.0, 2.0 * 5.0 / 7.0)]:
        start = ball([-0.5, 0.0, RADIUS + 0.1], [2.0, 0.0, -2.0])
        found = run(ball_on_floor(start, RigidLaw(0.5), gravity=np.zeros(3), friction=friction), STEP, 0.2)
        assert np.allclose(found["ball.velocity"][-1], [kept, 0.0, 1.0], atol=1e-6)
        assert found.drift < 1e-6


def impact(law, pulse, speed=1.0, steps=PULSE_STEPS, duration=None):
    """Speed of return, duration of the touch from the ways before and after it, and the run."""
    step = pulse / steps
    before = 3.3 * step
    start = ball([0.1, 0.05, RADIUS + speed * before], [0.0, 0.0, -speed])
    found = run(ball_on_floor(start, law, gravity=np.zeros(3)), step, duration or 3.0 * pulse)
    back = found["ball.velocity"][-1, 2]
    touched = found.times[-1] - (found["ball.position"][-1, 2] - RADIUS) / back - before
    return back, touched, found


def hertz_pulse(stiffness, speed=1.0):
    depth = (5.0 * MASS * speed**2 / (4.0 * stiffness)) ** 0.4
    return 0.8 * beta(0.4, 0.5) * depth / speed, stiffness * depth**1.5


@pytest.mark.parametrize("stiffness", [1e5, 1e9])
def test_hertz_contact_time_peak_and_restitution(stiffness):
    pulse, peak = hertz_pulse(stiffness)
    back, touched, found = impact(HertzLaw(stiffness), pulse)
    assert abs(back - 1.0) < 1e-9
    assert abs(touched / pulse - 1.0) < 5e-3
    assert abs(found["touch.normal_force"].max() / peak - 1.0) < 5e-3
    assert np.isclose(found["touch.impulse"][-1], 2.0 * MASS, rtol=1e-9)
    assert found.drift < 1e-9


@pytest.mark.parametrize("restitution", [0.2, 0.5, 0.8, 1.0])
@pytest.mark.parametrize("exponent", [1.0, 1.5])
def test_hunt_crossley_returns_its_restitution(restitution, exponent):
    law = HuntCrossleyLaw(1e6, exponent, restitution)
    pulse = hertz_pulse(1e6)[0] if exponent == 1.5 else np.pi * np.sqrt(MASS / 1e6)
    back, _, found = impact(law, pulse, duration=8.0 * pulse)
    assert abs(back - restitution) < 3e-3 * restitution
    assert np.isclose(found["touch.dissipated"][-1], 0.5 * MASS * (1.0 - back**2), rtol=1e-7, atol=1e-9)
    assert found.drift < 1e-9


def test_linear_law_against_its_differential_equation():
    stiffness, damping = 1e6, 800.0
    pulse = np.pi * np.sqrt(MASS / stiffness)

    def force(d, rate):
        return max(0.0, stiffness * d + damping * rate) if d > 0.0 else 0.0

    def rates(_, y):
        return [y[1], -force(y[0], y[1]) / MASS]

    def parts(_, y):
        return y[0] + 1e-15

    parts.terminal, parts.direction = True, -1.0
    exact = solve_ivp(
        rates, (0.0, 3.0 * pulse), [0.0, 1.0], events=parts, rtol=1e-10, atol=1e-14, max_step=pulse / 200
    )
    expected, lasts = -exact.y_events[0][0, 1], exact.t_events[0][0]
    errors = []
    for steps in (20, 40):
        back, touched, found = impact(LinearLaw(stiffness, damping), pulse, steps=steps)
        errors.append(abs(back / expected - 1.0))
        assert abs(touched / lasts - 1.0) < 2e-2
        assert found.drift < 1e-9
    assert errors[0] < 5e-3
    assert errors[1] < 3e-3


def test_ball_rests_on_a_spring_law_at_its_static_depth():
    """Released at the depth that carries it, it stays there."""
    stiffness = 1e5
    depth = (MASS * G / stiffness) ** (2.0 / 3.0)
    found = run(ball_on_floor(ball([0.1, 0.05, RADIUS - depth]), HertzLaw(stiffness)), 1e-3, 0.5)
    assert np.abs(found["touch.gap"] + depth).max() < 1e-9 * RADIUS
    assert np.abs(found["touch.normal_force"][1:] - MASS * G).max() < 1e-6


def test_start_inside_is_refused():
    simulation = Simulation(ball_on_floor(ball([0.1, 0.05, 0.5 * RADIUS])), STEP)
    with pytest.raises(InputError, match="inside its contour"):
        simulation.advance(1)


def test_approach_at_the_start_is_an_impact_at_once():
    found = run(ball_on_floor(ball([0.1, 0.05, RADIUS], [0.0, 0.0, -2.0]), RigidLaw(0.5)), STEP, 0.1)
    assert np.abs(found["ball.velocity"][:, 2] - (1.0 - G * found.times)).max() < REGULAR


def test_restart_across_contacts_is_bit_for_bit():
    def bowl(x, y):
        return 0.2 * (x * x + y * y)

    scene = ball_on_floor(
        ball([0.4, 0.1, 0.6], [0.3, -0.2, 0.0]), RigidLaw(0.5), floor=surface(bowl, count=12), friction=0.2
    )
    whole = Simulation(scene, STEP)
    _, expected = whole.advance(200)
    first = Simulation(scene, STEP)
    for stop in (33, 34, 80):  # in flight, about an impact, while it rolls
        first.advance(stop - first.step_index)
        second = Simulation(scene, STEP)
        second.restore(first.state())
        _, records = second.advance(200 - stop)
        assert np.array_equal(records, expected[stop:]), stop


def test_steps_chosen_by_tolerance_meet_the_same_impacts():
    scene = ball_on_floor(ball([0.1, 0.05, 1.0 + RADIUS]), RigidLaw(0.8))
    found = run(scene, 0.02, 0.9, tolerance=1e-6)
    fall = np.sqrt(2.0 / G)
    flight = (found.times > fall + 0.02) & (found.times < fall * 2.6 - 0.02)
    energy = found["ball.position"][flight, 2] - RADIUS + found["ball.velocity"][flight, 2] ** 2 / (2.0 * G)
    assert np.abs(energy - 0.64).max() < REGULAR
    assert found.drift < 1e-7


def test_tolerance_finds_a_stiff_pulse_that_the_interval_would_jump_over():
    pulse, _ = hertz_pulse(1e6)
    start = ball([0.1, 0.05, RADIUS + 0.01], [0.0, 0.0, -1.0])
    found = run(
        ball_on_floor(start, HertzLaw(1e6), gravity=np.zeros(3)),
        20.0 * pulse,
        20.0 * pulse * 3,
        tolerance=1e-6,
    )
    assert abs(found["ball.velocity"][-1, 2] - 1.0) < 1e-6
    way = 0.01 + found.times[-1] - 0.02 - pulse  # back at the start height, then on
    assert abs(found["ball.position"][-1, 2] - RADIUS - way) < 0.02 * pulse


def test_ball_rolls_in_a_bowl_as_a_pendulum():
    """In a hollow of radius R a rolling ball swings with 7/5 (R - r) phi'' = -g sin phi."""
    hollow, angle = 2.0, 0.4
    way = hollow - RADIUS

    def bowl(x, y):
        return hollow - np.sqrt(hollow**2 - x * x - y * y)

    start = ball([way * np.sin(angle), 0.0, hollow - way * np.cos(angle)])
    scene = ball_on_floor(start, floor=surface(bowl, count=24), friction=0.5)
    errors, drifts = [], []
    for step in (0.02, 0.01):
        found = run(scene, step, 6.0)
        swing = solve_ivp(
            lambda _, y: [y[1], -5.0 / 7.0 * G / way * np.sin(y[0])],
            (0.0, 6.0),
            [angle, 0.0],
            t_eval=found.times,
            rtol=1e-10,
            atol=1e-12,
        ).y[0]
        x, _, z = found["ball.position"].T
        errors.append(np.abs(np.arctan2(x, hollow - z) - swing).max())
        drifts.append(found.drift)
    assert errors[1] < 5e-4
    assert 3.5 < errors[0] / errors[1] < 4.5
    assert 3.3 < drifts[0] / drifts[1] < 8.0
    assert drifts[1] < 1e-4 * MASS * G * way * (1.0 - np.cos(angle))


def slide_over_waves(degree, step, monkeypatch):
    """A frictionless point at 1 m/s across the knots of a wavy surface; force and curvature along its normal."""
    x, y = np.meshgrid(np.linspace(-1.0, 1.0, 21), np.linspace(-0.3, 0.3, 6), indexing="ij")
    neutral = neutral_surface(np.stack([x, y, 0.3 * np.cos(2.0 * x)], -1), degrees=(degree, degree))
    floor = Contour(name="floor", body="ground", neutral=neutral)
    line = BSpline(neutral.spaces[0].knots, neutral.control.reshape(21, 6, 3)[:, 3], degree)
    # heights do not depend on y: every row of control points has the same profile
    start, along = line(0.1), line(0.1, 1) / np.linalg.norm(line(0.1, 1))
    scene = ball_on_floor(
        ball(start, along, mass=1.0), BilateralLaw(), gravity=np.zeros(3), floor=floor, shape=PointShape()
    )
    if degree < 3:
        with pytest.raises(InputError, match="degree 2"):
            Simulation(scene, step)
        monkeypatch.setattr(contour_packing, "_neutral", lambda contour, _: contour.neutral)
    found = run(scene, step, 1.5)
    u = found["touch.coordinate"][:, 0]

    def curvature(at):
        first, second = line(at, 1), line(at, 2)
        cross = first[..., 0] * second[..., 2] - first[..., 2] * second[..., 0]
        return cross / np.linalg.norm(first, axis=-1) ** 3

    tangent = line(u, 1) / np.linalg.norm(line(u, 1), axis=1)[:, None]
    force = found["touch.force"][:, 2] * tangent[:, 0] - found["touch.force"][:, 0] * tangent[:, 2]
    crossings = [
        (float(knot), int(np.searchsorted(u, knot)))
        for knot in neutral.spaces[0].knots[degree + 1 : -degree - 1]
        if u[10] < knot < u[-10]
    ]
    assert len(crossings) > 8
    assert np.abs(np.linalg.norm(found["ball.velocity"], axis=1) - 1.0).max() < 1e-6
    return found, u, force, curvature, crossings


def test_force_on_a_contour_of_degree_two_jumps_with_its_curvature(monkeypatch):
    _, _, force, curvature, crossings = slide_over_waves(2, 1e-3, monkeypatch)
    for knot, k in crossings:
        jump = curvature(np.array(knot + 1e-9)) - curvature(np.array(knot - 1e-9))
        assert abs(jump) > 0.04
        assert abs(force[k + 3] - force[k - 2] - jump) < 0.02 * abs(jump)  # m v^2 = 1


def test_force_on_a_contour_of_degree_three_does_not_jump(monkeypatch):
    """It is m v^2 times the curvature; across a knot it changes with the step, as the curvature does."""
    changes = []
    for step in (1e-3, 5e-4):
        found, u, force, curvature, crossings = slide_over_waves(3, step, monkeypatch)
        assert np.abs(force - curvature(u))[5:].max() < 0.5 * step
        changes.append(np.array([abs(force[k + 3] - force[k - 2]) for _, k in crossings]))
        assert found["touch.impacts"][-1] == 0.0
        assert found.drift < 1e-7
    assert changes[0].max() < 0.01
    assert np.all(np.abs(changes[0] / changes[1] - 2.0) < 0.4)


def test_table_carries_a_ball_by_friction():
    """Of the way of a table a rolling ball takes 2/7; the drive does the work that the ball has."""
    times = np.linspace(0.0, 1.0, 11)
    way = Profile(times, 0.1 * (1.0 - np.cos(np.pi * times)))
    table = RigidBody(
        name="table",
        mass=1.0,
        inertia=np.eye(3),
        motion=Driven(x=way),
        position=np.zeros(3),
    )
    scene = Scene(
        bodies=(table, ball([0.1, 0.0, RADIUS])),
        forces=(Gravity(DOWN),),
        contours=(surface(body="table"),),
        contacts=(touch(friction=0.5),),
    )
    found = run(scene, 0.005, 1.0)
    moved = found["table.position"][:, 0]
    assert abs(moved[-1] - 0.2) < 1e-6
    assert np.abs(found["ball.position"][:, 0] - 0.1 - 2.0 / 7.0 * moved).max() < 1e-6
    assert np.abs(found["touch.normal_force"][3:] - MASS * G).max() < 1e-6
    assert found["touch.slip"][3:].max() < 1e-5
    speed = found["ball.velocity"][:, 0]
    spin = found["ball.angular_velocity"][:, 1]
    gained = 0.5 * MASS * (speed**2 + 0.4 * RADIUS**2 * spin**2)
    assert gained.max() > 1e-3
    assert found.drift < 1e-3 * gained.max()


@pytest.mark.parametrize("tilt", [0.0, 1e-9, 1e-6])
@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_table_lands_on_all_four_feet(tilt, restitution):
    """Feet that meet the floor at once, or nearly: all obey the law, and the account of energy knows it."""
    feet = [np.array([x, y, -0.1]) for x in (-0.2, 0.2) for y in (-0.3, 0.3)]
    body = RigidBody(
        name="ball",
        mass=MASS,
        inertia=MASS * np.diag([0.04, 0.03, 0.05]),
        position=np.array([0.0, 0.0, 0.6]),
        orientation=np.array([1.0, 0.5 * tilt, 0.3 * tilt, 0.0]),
    )
    scene = Scene(
        bodies=(body,),
        forces=(Gravity(DOWN),),
        contours=(surface(),),
        contacts=tuple(
            touch(name=f"foot{i}", point=point, shape=PointShape(), law=RigidLaw(restitution))
            for i, point in enumerate(feet)
        ),
    )
    found = run(scene, STEP, np.round(np.sqrt(1.0 / G) + 0.05, 2))
    height, speed = found["ball.position"][-1, 2] - 0.1, found["ball.velocity"][-1, 2]
    energy = height + speed**2 / (2.0 * G)
    if tilt == 0.0:  # one after the other they leave another motion, however small the tilt
        assert abs(energy - 0.5 * restitution**2) < 1e-6
    lost = sum(found[f"foot{i}.dissipated"][-1] for i in range(4))
    total = found["energy.kinetic"] + found["energy.potential"]
    assert abs(total[0] - total[-1] - lost) < 1e-6 * MASS * G
    assert found.drift < 1e-6 * MASS * G
