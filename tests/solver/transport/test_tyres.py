"""Tyres with side slip: a tread alone, drift, scrub, cornering, sliding, standing, and a planar vehicle in SciPy."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from vehicles import FRONT, MASS, REAR, G, block, histories, scene, vehicle, yard

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.joints.planar import Planar
from heavylift.solver.scene.bodies import Driven, Harmonic, Profile
from heavylift.solver.scene.scenario import Condition, Phase, Scenario
from heavylift.solver.scene.scene import RigidBody
from heavylift.solver.scene.signals import Signal, Term
from heavylift.solver.scene.transport import Drive, HeightGrid, PathLeg, Tyres
from heavylift.solver.simulation import Simulation
from heavylift.solver.transport.decks import Deck
from heavylift.solver.transport.routes import make_route
from heavylift.solver.transport.transporters import Transporter
from heavylift.solver.transport.tyres import deflect

C, SIGMA, MU = 8.0, 0.3, 0.3
PLACES = np.array([(x, y) for lines in (FRONT, REAR) for y in (0.725, -0.725) for x in lines])
WIDE = yard(stations=np.array([-60.0, 60.0]), sides=np.array([-60.0, 60.0]))


def leg(*points, **more) -> PathLeg:
    """Of some points, at 0.5 m/s."""
    given = {"points": np.array(points, dtype=np.float64).reshape(-1, 2), "speed": 0.5, "acceleration": 0.1}
    return PathLeg(**(given | more))


def tyred(*legs: PathLeg, drive: Drive | None = None, tyres: Tyres | None = None, **more) -> Transporter:
    """R12 on tyres that slip, without rolling resistance."""
    given = {"bogie_mass": 0.0, "tyre_damping": 1.5e5, "line_damping": 2e4}
    return vehicle(
        legs=legs,
        drive=drive or Drive(rolling_resistance=0.0),
        tyres=tyres or Tyres(cornering=C),
        **(given | more),
    )


def low(**more) -> RigidBody:
    """The block with its centre of mass on the road: loads stay as they are, whatever happens in the plane."""
    return block(**({"centre_of_mass": np.zeros(3)} | more))


def canted(angle: float, **more) -> tuple[Deck, RigidBody]:
    """A deck that leans to the right, and the block on it."""
    c, s = math.cos(angle), math.sin(angle)
    half = np.array([math.cos(0.5 * angle), math.sin(0.5 * angle), 0.0, 0.0])
    deck = yard(
        stations=np.array([-60.0, 60.0]), sides=np.array([-60.0, 60.0]), normal=np.array([0.0, -s, c])
    )
    return deck, low(orientation=half, **more)


def balance(found: dict[str, np.ndarray]) -> np.ndarray:
    """Energy less the work of drives and with what is lost [J]."""
    names = ("kinetic", "potential", "elastic", "dissipated")
    return np.sum([found[f"energy.{name}"] for name in names], axis=0) - found["energy.drive_work"]


def test_a_deflection_is_what_an_integration_of_its_equation_gives() -> None:
    """Mean and end over a step, with the limit met on the way or not, and slopes by differences."""
    seen = 0
    for seed in range(60):
        e, d, a, limit = np.random.default_rng(seed).normal(size=4) * [0.01, 0.02, 1.0, 0.01]
        a, limit = abs(a) * (seed % 3 > 0), abs(limit) + 1e-3
        e = min(max(e, -limit), limit)
        mean, lag = (-math.expm1(-a) / a, (1.0 + math.expm1(-a) / a) / a) if a > 0.05 else (0.0, 0.0)
        if not mean:
            series = [(-a) ** k / math.factorial(k + 1) for k in range(12)]
            mean, lag = sum(series), sum((-a) ** k / math.factorial(k + 2) for k in range(12))

        def grows(_t: float, y: np.ndarray, a=a, d=d, limit=limit) -> list[float]:
            rate = d - a * y[0]
            return [0.0 if abs(y[0]) >= limit and rate * y[0] > 0.0 else rate, y[0]]

        def meets(_t: float, y: np.ndarray, limit=limit) -> float:
            return abs(y[0]) - limit

        meets.terminal, meets.direction = True, 1.0
        run = solve_ivp(grows, (0.0, 1.0), [e, 0.0], rtol=1e-12, atol=1e-15, events=meets)
        end, total = run.y[:, -1]
        total += (1.0 - run.t[-1]) * end
        seen += run.t[-1] < 1.0
        found = deflect(e, d, a, limit, mean, lag)
        np.testing.assert_allclose(found[:2], [total, end], atol=1e-12)
        step = 1e-7
        ahead, behind = (deflect(e, d + x, a, limit, mean, lag)[0] for x in (step, -step))
        assert found[2] == pytest.approx((ahead - behind) / (2.0 * step), abs=1e-5)
    assert 10 < seen < 50


def test_a_vehicle_drifts_down_a_cant_by_the_angle_of_its_tyres() -> None:
    """``tan(alpha) = tan(beta) / C``, heading and way as planned; what pushes it is what a driven path is pushed by."""
    beta = 0.02
    deck, body = canted(beta)
    _, times, found = histories(scene(tyred(leg([20, 0])), (deck,), body=body), 1e-2, 30.0, 50)
    steady = (times > 15.0) & (times < 30.0)
    alpha = math.atan(math.tan(beta) / C)
    np.testing.assert_allclose(found["spmt.slip_angle"][steady], -alpha, rtol=1e-6)
    place = found["block.position"][steady]
    across = place[:, 1] * math.cos(beta) + place[:, 2] * math.sin(beta)
    np.testing.assert_allclose(np.diff(across) / np.diff(place[:, 0]), -math.tan(alpha), rtol=1e-6)
    np.testing.assert_allclose(found["spmt.off_heading"], 0.0, atol=1e-9)
    driven = vehicle(legs=(leg([20, 0]),), bogie_mass=0.0, tyre_damping=1.5e5, line_damping=2e4)
    _, _, of_path = histories(scene(driven, (deck,), body=body), 1e-2, 30.0, 50)
    held = MASS * G * math.sin(beta)
    np.testing.assert_allclose(found["spmt.push_across"][steady], held, rtol=1e-6)
    # a driven one in the plan, which is level
    np.testing.assert_allclose(of_path["spmt.push_across"][steady], held / math.cos(beta), rtol=1e-6)
    np.testing.assert_allclose(found["spmt.path_way"], of_path["spmt.path_way"], atol=1e-9)


def test_a_carousel_with_errors_of_steering_scrubs() -> None:
    """Drag of bogie i by the way s it has rolled: ``C f tan(d) sin(d) (1 - exp(-s / sigma))``, to ``C f d^2``."""
    d = math.radians(2.0)
    turn = PathLeg(steering="carousel", turn=2.0, speed=0.15, acceleration=0.3)
    tyres = Tyres(cornering=C, damping_time=0.0, steering_errors=np.array([d]))
    radii = np.hypot(*PLACES.T)
    load = MASS * G / 12.0
    errors = []
    for step in (2e-2, 1e-2):
        _, times, found = histories(scene(tyred(turn, tyres=tyres), (WIDE,), body=low()), step, 40.0, 10)
        lag = 0.5 * step * 0.15  # demands are those of the middle of the step
        rolled = np.outer((found["spmt.path_way"] - lag) / radii.max(), radii)
        drag = C * load * math.tan(d) * math.sin(d) * (1.0 - np.exp(-rolled / SIGMA))
        expected = 12.0 * (drag @ radii) / (radii.sum() * math.cos(d))
        at_speed = (times > 0.8) & (times < 40.0)
        errors.append(np.abs(found["spmt.drive_demand"] / expected - 1.0)[at_speed].max())
    assert errors[0] < 1e-4
    assert errors[1] < 3e-5
    torque = expected[-1] / 12.0 * radii.sum() * math.cos(d)
    assert torque == pytest.approx(12.0 * C * load * d * d * radii.mean(), rel=5e-3)


def test_side_forces_turn_a_vehicle_round_a_bend() -> None:
    """On an arc of 15 m: they sum up to ``m v w``, by slip angles of ``v w / (g C)``, and ``v w = v^2 / R``."""
    speed, R = 1.5, 15.0
    around = leg([25, 0], [25, 60], radius=R, transition=8.0, speed=speed, acceleration=0.5)
    _, _, found = histories(scene(tyred(around), (WIDE,), body=low()), 1e-2, 19.0, 10)
    last = {name: history[-1] for name, history in found.items()}
    turns = np.linalg.norm(last["block.velocity"]) * last["block.angular_velocity"][2]
    assert turns == pytest.approx(speed**2 / R, rel=5e-3)
    assert math.hypot(last["spmt.push_along"], last["spmt.push_across"]) == pytest.approx(
        MASS * turns, rel=1e-4
    )
    sides = -C * last["spmt.wheel_load"] * np.tan(last["spmt.slip_angle"])
    np.testing.assert_allclose(last["spmt.side_force"], sides, rtol=1e-3)


def test_a_vehicle_that_slides_is_held_by_friction() -> None:
    """Sideways at 1 m/s with locked wheels on the level: ``v^2 / (2 mu g)``; on a steep cant ``g (sin - mu cos)``."""
    rest = leg([5, 0], pause=100.0)
    springs = Tyres(cornering=C, damping_time=0.0)
    _, times, found = histories(
        scene(tyred(rest, tyres=springs), (WIDE,), body=low(velocity=np.array([0.6, 0.8, 0.0]))), 5e-3, 2.0
    )
    # half of the deflection at the limit is won, as the force grows first
    way = found["block.position"][:, :2] @ [0.6, 0.8]
    assert way.max() == pytest.approx(1.0 / (2.0 * MU * G) + 0.5 * MU * SIGMA / C, rel=1e-4)
    assert np.abs(found["block.position"][:, :2] @ [0.8, -0.6]).max() < 1e-9
    slides = (times > 0.05) & (times < 0.25)
    deceleration = np.gradient(found["block.velocity"], times, axis=0)[slides]
    np.testing.assert_allclose(
        deceleration[:, :2], -MU * G * np.array([[0.6, 0.8]]).repeat(slides.sum(), 0), rtol=1e-6
    )
    beta = math.atan(0.4)
    deck, body = canted(beta)
    _, times, found = histories(scene(tyred(rest), (deck,), body=body), 5e-3, 2.0)
    speed = -found["block.velocity"] @ [0.0, math.cos(beta), math.sin(beta)]
    late = times > 0.5
    pressed = found["spmt.wheel_load"].sum(axis=1) / MASS  # it settles on its groups
    rate = G * math.sin(beta) - MU * pressed
    np.testing.assert_allclose(np.gradient(speed, times)[late][1:-1], rate[late][1:-1], rtol=2e-3)
    assert rate[-1] == pytest.approx(G * (math.sin(beta) - MU * math.cos(beta)), rel=1e-3)
    np.testing.assert_allclose(found["spmt.traction_used_max"][1:], 1.0, atol=1e-9)


def test_a_vehicle_stands_on_a_cant_and_does_not_creep() -> None:
    """Ten minutes with its brakes on, on a deck that leans to the side, and with a slope along it: 1e-9 m."""
    deck, body = canted(0.03)
    ramp = replace(deck, stations=np.array([-60.0, 60.0]), heights=np.array([-1.2, 1.2]))
    for road in (deck, ramp):
        transporter = tyred(leg([5, 0], pause=1e4), drive=Drive(bogies=(1, 4, 7, 10)))
        run, times, found = histories(scene(transporter, (road,), body=body), 2e-2, 600.0, 500)
        assert run.outcome is Outcome.COMPLETED
        late = times > 120.0
        moved = found["block.position"][late]
        assert np.ptp(moved, axis=0).max() < 1e-9


def planar(route, errors: np.ndarray, duration: float, *, delay: float):
    """Place and heading of twelve wheels with side slip under a plate, by SciPy: an independent vehicle in the plane.

    Its drive is the force that keeps the derivative of ``sum d_i . v_i = s' sum |r_i|``.
    """
    load = MASS * G / 12.0
    K, inertia = C * load / SIGMA, 6.0e6
    x, y = PLACES.T

    def wheels(s: float) -> tuple[np.ndarray, np.ndarray]:
        k = np.interp(s, route.nodes[:, 0], route.nodes[:, 6])
        ways = np.array([1.0 - k * y, k * x])
        size = np.hypot(*ways)
        c, sine = np.cos(errors), np.sin(errors)
        d = ways / size
        return np.array([c * d[0] - sine * d[1], sine * d[0] + c * d[1]]), size.sum()

    def plan(t: float) -> tuple[float, float, float]:
        return (0.05 * t * t, 0.1 * t, 0.1) if t < 5.0 else (1.25 + 0.5 * (t - 5.0), 0.5, 0.0)

    def rates(t: float, q: np.ndarray) -> np.ndarray:
        psi, u, v, w = q[2:6]
        s, speed, gain = plan(t)
        d, total = wheels(s)
        (ahead, far), (behind, near) = wheels(s + 1e-6), wheels(max(s - 1e-6, 0.0))
        span = 1e-6 + min(s, 1e-6)
        n = np.array([-d[1], d[0]])
        at = np.array([u - w * y, v + w * x])
        roll, slip = np.sum(d * at, axis=0), np.sum(n * at, axis=0)
        grows = slip - np.abs(roll) * q[6:] / SIGMA
        side = -K * (q[6:] + delay * grows) * n

        def accelerations(force: np.ndarray) -> np.ndarray:
            return np.array(
                [force[0].sum() / MASS, force[1].sum() / MASS, (x * force[1] - y * force[0]).sum() / inertia]
            )

        turn = np.array([w * v, -w * u, 0.0])
        row = np.array([d[0].sum(), d[1].sum(), (x * d[1] - y * d[0]).sum()])
        wanted = gain * total + speed**2 * (far - near) / span
        wanted -= speed * np.sum((ahead - behind) / span * at)
        without = accelerations(side) + turn
        with_one = accelerations(d)
        force = (wanted - row @ without) / (row @ with_one)
        c, sine = math.cos(psi), math.sin(psi)
        return np.concatenate([[c * u - sine * v, sine * u + c * v, w], without + force * with_one, grows])

    q = np.zeros(18)
    for begin, end in ((0.0, 5.0), (5.0, duration)):
        q = solve_ivp(rates, (begin, end), q, rtol=1e-10, atol=1e-13, max_step=0.02).y[:, -1]
    return q[:3]


@pytest.mark.slow
def test_a_vehicle_in_the_plane_goes_where_an_integration_in_scipy_takes_it() -> None:
    """Into a bend of 9 m with steering errors of a degree: place and heading of second order in the step."""
    errors = np.radians(np.random.default_rng(3).uniform(-1.0, 1.0, 12))
    around = leg([12, 0], [12, 30], radius=9.0, transition=4.0)
    route = make_route([around], PLACES, np.zeros(3))
    reference = planar(route, errors, 12.0, delay=0.02)
    tyres = Tyres(cornering=C, damping_time=0.02, steering_errors=errors)
    ends = []
    for step in (1e-2, 5e-3, 2.5e-3):
        _, _, found = histories(scene(tyred(around, tyres=tyres), (WIDE,), body=low()), step, 12.0, 10)
        q = found["block.orientation"][-1]
        ends.append(np.array([*found["block.position"][-1, :2], 2.0 * math.atan2(q[3], q[0])]))
        error = balance(found) - balance(found)[0]
        assert np.abs(error).max() < 1e-11 * found["energy.drive_work"].max()
    np.testing.assert_allclose(ends[-1], reference, atol=5e-8)
    assert np.linalg.norm(ends[0] - ends[1]) > 3.5 * np.linalg.norm(ends[1] - ends[2])
    assert found["spmt.off_path"][-1] > 1e-3  # errors show


def test_a_vehicle_on_a_barge_that_sways_is_held_by_its_treads() -> None:
    """At rest on it: it gives way by ``(a / g) sigma / C``; on a free barge what it does pushes that back."""
    omega, amplitude = 0.5, 0.4
    sway = Profile(harmonics=(Harmonic(amplitude=amplitude, frequency=omega / (2.0 * np.pi), phase=0.0),))
    barge = RigidBody("barge", 1e6, np.eye(3) * 1e8, motion=Driven(y=sway))
    deck = yard(body="barge", stations=np.array([-20.0, 20.0]), sides=np.array([-20.0, 20.0]))
    parked = tyred(leg([5, 0], pause=1e3))
    _, times, found = histories(
        scene(parked, (deck,), bodies=(barge, low(velocity=np.array([0.0, 0.2, 0.0])))), 1e-2, 40.0, 10
    )
    acceleration = -(omega**2) * amplitude * np.sin(omega * times)
    left = (found["block.position"] - found["barge.position"])[:, 1]
    late = times > 20.0
    np.testing.assert_allclose(left[late], (-acceleration / G * SIGMA / C)[late], atol=5e-6)
    middle = -(omega**2) * amplitude * np.sin(omega * (times - 5e-3))
    np.testing.assert_allclose(found["spmt.push_across"][late], MASS * middle[late], atol=1e-2 * MASS * 0.1)

    barge = RigidBody("barge", 4.0e5, np.diag([5e6, 5e7, 5e7]))
    wrong = Tyres(cornering=C, steering_errors=np.radians(np.linspace(-2.0, 3.0, 12)))
    bend = leg([5, 0], [5, 6], radius=3.5, transition=1.0)
    floats = Planar(name="water", body_a="ground", body_b="barge")
    made = scene(tyred(bend, tyres=wrong, drive=Drive()), (deck,), bodies=(barge, low()), joints=(floats,))
    _, _, found = histories(made, 5e-3, 6.0, 20)
    np.testing.assert_allclose(found["momentum.linear"][:, :2], 0.0, atol=1e-5)
    np.testing.assert_allclose(found["momentum.angular"][:, 2], 0.0, atol=2e-2)
    assert np.abs(found["block.velocity"]).max() > 0.3
    error = balance(found) - balance(found)[0]
    assert np.abs(error).max() < 1e-6 * found["energy.drive_work"].max()


def test_a_cross_fall_of_a_grid_pulls_as_a_cant_does() -> None:
    """A grid of heights that falls to the right by 0.02, on a level deck: the vehicle drifts by 0.02 / C."""
    fall = 0.02
    lines = np.array([-30.0, 30.0])
    grid = HeightGrid(stations=lines, offsets=lines, heights=fall * np.tile(lines, (2, 1)))
    road = Deck(name="yard", grid=grid)
    half = 0.5 * math.atan(fall)
    body = low(orientation=np.array([math.cos(half), math.sin(half), 0.0, 0.0]))
    _, times, found = histories(scene(tyred(leg([12, 0])), (road,), body=body), 1e-2, 20.0, 10)
    steady = times > 10.0
    np.testing.assert_allclose(found["spmt.slip_angle"][steady], -fall / C, rtol=1e-3)
    np.testing.assert_allclose(found["spmt.push_across"][steady], 0.0, atol=1e-3 * MASS * G * fall)


def test_a_vehicle_on_a_cant_starts_in_equilibrium() -> None:
    """Treads hold it there; so it stands at once."""
    deck, body = canted(0.03)
    made = scene(tyred(leg([5, 0], pause=1e3)), (deck,), body=body)
    run = Simulation(made, step=1e-2, integrator="dele2", start="equilibrium", record_every=10)
    _, records = run.advance(1000)
    places = next(c for c in run.channels if c.name == "block.position")
    assert np.ptp(records[:, places.column : places.column + 3], axis=0).max() < 1e-7


def test_scenes_with_a_scenario_have_the_same_tyres() -> None:
    """There carried states lie in one array: all that tyres look at is there."""
    made = scene(tyred(leg([5, 0]), drive=Drive()), (WIDE,))
    never = Condition(Signal((Term("block.position", "z"),)), 1e6)
    watched = replace(made, scenario=Scenario((Phase("rolls", until=(never,)),)))
    _, _, plain = histories(made, 1e-2, 6.0, 50)
    _, _, found = histories(watched, 1e-2, 6.0, 50)
    for name in ("spmt.drive_demand", "spmt.side_force", "spmt.off_path", "energy.dissipated"):
        np.testing.assert_array_equal(found[name], plain[name])


def test_a_drive_that_cannot_lets_the_plan_wait() -> None:
    """Up a slope with motors of 2 kN: what they leave accelerates it, and it arrives; 1 kN are too little to go on."""
    slope = 0.005
    ramp = yard(
        stations=np.array([-60.0, 60.0]), heights=slope * np.array([-60.0, 60.0]), sides=np.array([-9.0, 9.0])
    )
    drive = Drive(rolling_resistance=0.0, speeds=np.array([0.0, 2.0]), forces=np.array([2e3, 2e3]))
    run, times, found = histories(scene(tyred(leg([6, 0]), drive=drive), (ramp,), body=low()), 1e-2, 30.0, 10)
    rises = (times > 1.0) & (times < 3.0)
    gained = np.gradient(found["block.velocity"][:, 0], times)[rises]
    np.testing.assert_allclose(gained, 12 * 2e3 / MASS - G * slope, rtol=2e-3)
    assert found["spmt.path_way"][-1] == pytest.approx(6.0, abs=1e-6)
    assert found["block.position"][-1, 0] == pytest.approx(6.0, abs=1e-3)
    assert found["spmt.drive_used_max"].max() == pytest.approx(1.0, abs=1e-9)
    assert "'spmt' is slower than its plan" in run.warning
    assert found["energy.drive_work"][-1] == pytest.approx(MASS * G * slope * 6.0, rel=5e-2)
    weak = replace(drive, forces=np.array([500.0, 500.0]))
    _, _, found = histories(scene(tyred(leg([6, 0]), drive=weak), (ramp,), body=low()), 1e-2, 10.0, 10)
    assert found["spmt.path_way"].max() < 1e-3
    assert found["block.position"][-1, 0] < -0.1  # it rolls back: motors are not brakes


def test_no_wheel_has_more_than_its_friction() -> None:
    """Round a bend so fast that it slides off its path: drive and side force of each bogie are within ``mu f``."""
    around = leg([14, 0], [14, 40], radius=8.0, transition=4.0, speed=3.0, acceleration=1.0)
    slick = Drive(rolling_resistance=0.02, friction=0.08)
    run, _, found = histories(scene(tyred(around, drive=slick), (WIDE,), body=low()), 1e-2, 12.0, 5)
    assert run.outcome is Outcome.COMPLETED
    used = found["spmt.traction_used_max"]
    assert used.max() == pytest.approx(1.0, abs=1e-9)
    assert found["spmt.off_path"].max() > 0.2
    assert np.all(np.abs(found["spmt.side_force"]) <= 0.08 * found["spmt.wheel_load"] * (1.0 + 1e-9))
    error = balance(found) - balance(found)[0]
    assert np.abs(error).max() < 1e-6 * found["energy.drive_work"].max()
    assert "'spmt' slides" in run.warning


@pytest.mark.parametrize("driven", [tuple(range(1, 13)), (1, 3, 4, 6, 7, 9, 10, 12)])
def test_motors_push_with_all_friction(driven: tuple[int, ...]) -> None:
    """On a slope beyond that it goes back with ``g (sin - mu cos n/12)``, n bogies driven, and it is told."""
    angle, mu = 0.03, 0.02
    c, s = math.cos(angle), math.sin(angle)
    half = np.array([math.cos(0.5 * angle), 0.0, -math.sin(0.5 * angle), 0.0])
    slope = replace(WIDE, direction=np.array([c, 0.0, s]), normal=np.array([-s, 0.0, c]))
    icy = Drive(bogies=driven, rolling_resistance=0.0, friction=mu)
    made = scene(tyred(leg([5, 0]), drive=icy), (slope,), body=low(orientation=half))
    run, times, found = histories(made, 1e-2, 6.0, 10)
    late = times > 2.0
    speed = found["block.velocity"] @ [c, 0.0, s]
    pull = np.polyfit(times[late], speed[late], 1)[0]
    assert pull == pytest.approx(-G * (s - mu * c * len(driven) / 12), rel=1e-3)
    np.testing.assert_allclose(found["spmt.traction_used_max"][late], 1.0, atol=1e-9)
    assert "'spmt' slides" in run.warning


def test_a_vehicle_on_a_cant_as_steep_as_friction_starts() -> None:
    """Treads at the start are at their limit, as rounded: it slides while its groups settle, and is then in balance."""
    for mu in (0.3, 0.0404, 0.07):
        deck, body = canted(math.atan(mu))
        drive = Drive(friction=mu, rolling_resistance=0.0)
        run, _, found = histories(
            scene(tyred(leg([5, 0], pause=9.0), drive=drive), (deck,), body=body), 1e-2, 2.0, 10
        )
        assert run.outcome is Outcome.COMPLETED
        np.testing.assert_allclose(
            found["block.velocity"][-5:, 1], found["block.velocity"][-1, 1], rtol=1e-3, atol=1e-6
        )


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(40))
def test_any_vehicle_finds_its_forces(seed) -> None:
    """Random tyres, drives, steps, slopes and legs, many of which slide or stall: iterations end, energies balance."""
    g = np.random.default_rng(seed)
    mu, resistance = math.exp(g.uniform(math.log(0.03), math.log(0.7))), g.choice([0.0, 0.01, 0.02, 0.05])
    cant, slope, step = g.uniform(-0.04, 0.04), g.uniform(-0.04, 0.04), g.choice([5e-3, 1e-2, 2e-2, 5e-2])
    legs = (
        leg([12, 0], [12, 20], radius=9.0, transition=4.0, speed=g.uniform(0.05, 2.0)),
        PathLeg(
            steering="carousel", turn=g.uniform(-1.0, 1.0), centre=g.uniform(-2, 2, 2), speed=0.3, pause=1.0
        ),
        leg([3, 2], steering="crab"),
        leg([-6, 0]),
    )
    driven = tuple(int(i) + 1 for i in g.choice(12, g.integers(1, 12), replace=False))
    drive = Drive(
        bogies=driven, friction=mu, rolling_resistance=resistance, brake_force=g.choice([np.inf, 5e3, 4e4])
    )
    tyres = Tyres(
        cornering=g.uniform(1.0, 20.0),
        relaxation_length=math.exp(g.uniform(math.log(0.03), 0.0)),
        damping_time=g.choice([0.0, 0.01, 0.1]),
        steering_errors=np.radians(g.uniform(-3.0, 3.0, 12)),
    )
    deck, body = canted(cant)
    ends = np.array([-300.0, 300.0])
    road = replace(deck, stations=ends, heights=slope * ends, sides=ends)
    made = scene(
        tyred(*(legs[i] for i in g.permutation(4)[:2]), drive=drive, tyres=tyres), (road,), body=body
    )
    run, _, found = histories(made, step, 50.0, round(0.5 / step))
    assert run.outcome is Outcome.COMPLETED, run.message
    assert found["spmt.traction_used_max"].max() < 1.03 + resistance / mu
    scale = max(found[f"energy.{name}"].max() for name in ("drive_work", "dissipated", "kinetic"))
    error = balance(found) - balance(found)[0]
    assert np.abs(error).max() < 1e-3 * scale + 1.0


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"drive": None}, "'tyres' without 'a drive'"),
        ({"legs": (), "drive": None}, "'tyres' without 'legs'"),
        ({"tyres": {"steering_errors": np.radians([1.0, 2.0])}}, "2 angles of 12 bogies"),
        ({"tyres": {"steering_errors": np.radians([50.0])}}, "50 degrees"),
        ({"tyres": {"cornering": 0.0}}, "cornering"),
        ({"tyres": {"relaxation_length": -0.3}}, "relaxation_length"),
    ],
)
def test_tyres_that_make_no_sense_are_refused(more, words) -> None:
    """Each with its key."""
    given = {"legs": (leg([5, 0]),), "drive": Drive(), "bogie_mass": 0.0} | more
    given["tyres"] = Tyres(**({"cornering": C} | given.get("tyres", {})))
    with pytest.raises(InputError, match=words):
        Simulation(scene(vehicle(**given), (WIDE,)), step=5e-3)
