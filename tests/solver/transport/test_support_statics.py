"""What groups carry, how fast a body moves on them, and which cannot hold it: closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial import ConvexHull
from vehicles import (
    BOGIE,
    FRONT,
    HEIGHT,
    INERTIA,
    MASS,
    OIL,
    REAR,
    TYRE,
    G,
    T,
    block,
    bump,
    groups_of,
    histories,
    scene,
    vehicle,
    yard,
)

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.joints.guide import Guide
from heavylift.solver.scene.bodies import Fixed
from heavylift.solver.scene.transport import BogieGroup, OilPump
from heavylift.solver.simulation import Simulation
from heavylift.solver.transport.decks import Deck
from heavylift.solver.transport.support_statics import (
    SupportStatics,
    _hull,
    even_loads,
    growth_rate,
    small_motions,
    tipping_angles,
)

K = OIL * TYRE / (OIL + TYRE)


def stand(number: int, *, forward: float = 0.0) -> SupportStatics:
    """R12 on its groups, the centre of mass forward of the middle [m]."""
    groups = groups_of(number)
    middles = np.array([group.bogies.mean(axis=0) for group in groups]) - [forward, 0.0, HEIGHT]
    counts = np.array([len(group.bogies) for group in groups])
    weight = MASS * G
    return SupportStatics("R12", middles, counts, np.full(len(groups), K), weight, MASS, np.diag(INERTIA))


def test_three_groups_carry_what_the_balance_says() -> None:
    """Static loads with the centre of mass 0.5 m forward: 78.2619, 47.3690, 47.3690 t a group."""
    given = stand(3, forward=0.5)
    resultants = given.counts * even_loads(given) / (T * G)
    np.testing.assert_allclose(resultants, [78.2619, 47.3690, 47.3690], atol=5e-5)
    front = 173.0 * (0.5 + 1.4) / 4.2  # about the rear groups
    np.testing.assert_allclose(resultants, [front, 0.5 * (173.0 - front), 0.5 * (173.0 - front)], rtol=1e-12)


def test_four_groups_carry_alike_along_both_diagonals() -> None:
    """The one number that the balance leaves open."""
    loads = even_loads(stand(4, forward=0.5))
    assert loads[0] - loads[1] - loads[2] + loads[3] == pytest.approx(0.0, abs=1e-6)
    assert loads[0] == pytest.approx(MASS * G / 12 * (1.0 + 0.5 / 2.1), rel=1e-12)


@pytest.mark.parametrize(("number", "frequencies"), [(4, (0.503, 0.719, 2.006)), (3, (0.328, 0.676, 2.006))])
def test_small_motions_have_the_published_frequencies(number, frequencies) -> None:
    """Of an independent linearisation, printed to three digits."""
    found = np.sqrt(small_motions(stand(number))) / (2.0 * np.pi)
    np.testing.assert_allclose(found, frequencies, atol=6e-4)


@pytest.mark.parametrize(
    ("middles", "height", "angle"),
    [
        ([(2.1, 0.725), (2.1, -0.725), (-2.1, 0.725), (-2.1, -0.725)], HEIGHT, 11.45),
        ([(2.8, 0.0), (-1.4, 0.725), (-1.4, -0.725)], HEIGHT, 7.58),
        ([(2.1, 3.0), (2.1, -3.0), (-2.1, 3.0), (-2.1, -3.0)], 5.746820809, 20.07),
        ([(2.1, 0.0), (-2.1, 3.0), (-2.1, -3.0)], 5.746820809, 11.99),
        ([(6.3, 10.0), (6.3, -10.0), (-6.3, 10.0), (-6.3, -10.0)], 9.931982942, 32.39),
        ([(6.3, 0.0), (-6.3, 10.0), (-6.3, -10.0)], 9.931982942, 21.52),
    ],
)
def test_vehicles_tip_over_at_the_published_angles(middles, height, angle) -> None:
    """R12, R24 and R144 in four and three groups; with what groups give way sooner, R12 in three at 2.85 degrees."""
    n = len(middles)
    places = np.column_stack([np.array(middles), np.full(n, -height)])
    # the front half of R24 and R144 is one group of three, of R12 the front third
    counts = np.array([6, 3, 3]) if n == 3 and height > HEIGHT else np.full(n, 12 // n)
    given = SupportStatics("R", places, counts, np.full(n, K), MASS * G, MASS, np.diag([1e6, 5e6, 6e6]))
    found = tipping_angles(given, np.full(n, MASS * G / 12))
    assert np.degrees(found.static) == pytest.approx(angle, abs=5e-3)
    assert 0.0 < found.compliant < found.static
    if height == HEIGHT and n == 3:
        # the foot moves by h b A, A = 1 / (1 - W h / K) across and 1.06 along; normal of a side of the triangle
        normal = np.array([0.725, 4.2]) / np.hypot(0.725, 4.2)
        stiffness = 12.0 * K * np.array([1.4 * 2.8, 0.725**2 * 2.0 / 3.0])
        leans = normal / (1.0 - MASS * G * HEIGHT / stiffness)
        assert np.tan(found.compliant) == pytest.approx(np.tan(found.static) / np.hypot(*leans), rel=1e-3)
        assert np.degrees(found.compliant) == pytest.approx(7.58 * (1.0 - 0.63), abs=0.06)


@pytest.mark.parametrize("number", [3, 4])
def test_a_run_swings_as_fast_as_its_linearisation(number) -> None:
    """Period of a small roll in the time domain, between its zeros."""
    body = block(angular_velocity=np.array([1e-5, 0.0, 0.0]))
    _, times, found = histories(scene(vehicle(groups=groups_of(number)), body=body), 2e-3, 8.0)
    roll = found["spmt.roll"]
    rises = np.flatnonzero((roll[:-1] < 0.0) & (roll[1:] >= 0.0))
    zeros = times[rises] - roll[rises] * (times[rises + 1] - times[rises]) / (roll[rises + 1] - roll[rises])
    frequency = np.mean(1.0 / np.diff(zeros))
    assert frequency == pytest.approx(np.sqrt(small_motions(stand(number))[0]) / (2.0 * np.pi), rel=2e-3)


def test_two_groups_are_refused_with_the_rate_of_their_fall() -> None:
    """Pitch of R12 on two groups, left and right: ``sqrt(W h / J)``; forced, it runs."""
    rate = np.sqrt(MASS * G * HEIGHT / INERTIA[1])
    assert growth_rate(stand(2)) == pytest.approx(rate, rel=1e-12)
    two = vehicle(groups=groups_of(2))
    with pytest.raises(InputError, match=rf"2 groups .*exp\(t {rate:.3g} 1/s\)"):
        Simulation(scene(two), step=5e-3)
    Simulation(scene(replace(two, accept_unstable=True)), step=5e-3)


def test_groups_in_a_line_and_soft_groups_are_refused() -> None:
    """Three in a line along x cannot hold the roll; four cannot with W h beyond their stiffness."""
    line = tuple(
        BogieGroup(f"g{i}", np.array([[x, y, 0.0] for y in (-0.7, 0.7)]), oil_stiffness=OIL)
        for i, x in enumerate((-2.0, 0.0, 2.0))
    )
    with pytest.raises(InputError, match="3 groups of bogies in a line"):
        Simulation(scene(vehicle(groups=line)), step=5e-3)
    with pytest.raises(InputError, match=r"too soft .* 3\.58 m over the road"):
        Simulation(scene(vehicle(groups=groups_of(4, oil=8e5))), step=5e-3)


def test_a_load_beyond_the_limit_is_refused() -> None:
    """14.5247 t a bogie with its own weight."""
    load = (MASS / 12 + BOGIE) * G
    assert load / (T * G) == pytest.approx(14.5247, rel=1e-5)
    Simulation(scene(vehicle(load_limit=1.001 * load)), step=5e-3)
    with pytest.raises(InputError, match=r"load_limit: 142487 N on each bogie of group 'group_1'"):
        Simulation(scene(vehicle(load_limit=0.999 * load)), step=5e-3)


def test_a_body_beside_its_groups_is_refused() -> None:
    """A centre of mass in front of all groups would need forces that pull; groups in a line cannot carry it at all."""
    ahead = block(centre_of_mass=np.array([2.5, 0.0, HEIGHT]))
    with pytest.raises(InputError, match="would have to pull"):
        Simulation(scene(vehicle(), body=ahead), step=5e-3)
    aside = block(centre_of_mass=np.array([0.3, 0.0, HEIGHT]))
    with pytest.raises(InputError, match=r"0\.3 m beside the line of its 2 groups"):
        Simulation(scene(vehicle(groups=groups_of(2), accept_unstable=True), body=aside), step=5e-3)


def test_a_pump_lifts_the_body_by_what_it_pumps() -> None:
    """All groups lifted by 50 mm: heave 50 mm, loads as before."""
    pump = OilPump(times=np.array([0.0, 20.0]), lifts=np.array([0.0, 0.05]))
    groups = tuple(replace(group, pump=pump) for group in groups_of(4))
    _, _, found = histories(
        scene(vehicle(groups=groups, tyre_damping=1.5e5, line_damping=2e4)), 1e-2, 25.0, 10
    )
    assert found["spmt.heave"][-1] == pytest.approx(0.05, rel=1e-3)
    work = found["energy.drive_work"][-1]
    assert work == pytest.approx(MASS * G * 0.05, rel=1e-3)


def test_gas_is_softer_than_oil() -> None:
    """Heave on accumulators: stiffness 1.4 f / L of a bogie, in series with the tyre."""
    load, length = MASS * G / 12, 0.6
    gas = tuple(BogieGroup(group.name, group.bogies, gas_length=length) for group in groups_of(4))
    wide = block(
        inertia=np.diag([8e6, 8e6, 8e6]), velocity=np.array([0.0, 0.0, 1e-4]), centre_of_mass=np.zeros(3)
    )
    _, times, found = histories(scene(vehicle(groups=gas), body=wide), 5e-3, 10.0)
    heave = found["spmt.heave"]
    k = 1.0 / (length / (1.4 * load) + 1.0 / TYRE)
    expected = 1e-4 / np.sqrt(12 * k / MASS) * np.sin(np.sqrt(12 * k / MASS) * times)
    np.testing.assert_allclose(heave, expected, atol=2e-3 * np.ptp(expected))


@pytest.mark.parametrize("pipe", [0.0, 2.0e4])
def test_a_search_for_equilibrium_finds_what_the_oil_carries(pipe) -> None:
    """Groups that push with a tenth more than the weight at the start: the body is lifted by 0.1 f / k."""
    load = MASS * G / 12
    groups = tuple(replace(group, load=1.1 * load) for group in groups_of(4))
    made = scene(
        vehicle(groups=groups, line_damping=pipe), joints=(Guide(name="g", body_a="ground", body_b="block"),)
    )
    run = Simulation(made, step=5e-3, integrator="dele2", start="equilibrium", record_every=10)
    _, records = run.advance(200)
    heave = next(c.column for c in run.channels if c.name == "spmt.heave")
    # the start of the heave is where the body was drawn
    np.testing.assert_allclose(records[:, heave], 0.1 * load / K, rtol=1e-6)


def test_a_run_goes_on_where_a_state_was_kept() -> None:
    """Bit for bit, with pipes, over a bump."""
    made = scene(
        vehicle(line_damping=2.0e4, tyre_damping=1.5e4, travel_speed=1.0),
        (yard(), bump(4.5, 2.0, (0.2, 1.5))),
    )
    run = Simulation(made, step=5e-3, integrator="dele2", record_every=10)
    run.advance(400)
    kept = run.state()
    expected = run.advance(200)[1]
    other = Simulation(made, step=5e-3, integrator="dele2", record_every=10)
    other.restore(kept)
    np.testing.assert_array_equal(other.advance(200)[1], expected)


def test_bogies_without_mass_need_the_default_integrator() -> None:
    """The others are refused by name."""
    for integrator in ("accurate", "thesis"):
        with pytest.raises(InputError, match="transporter 'spmt' rides on bogies without mass"):
            Simulation(scene(vehicle()), step=5e-3, integrator=integrator)


@pytest.mark.parametrize(
    ("vehicle_groups", "mass", "height", "inertia", "frequencies"),
    [
        ("R24", 346.0e3, 5.746820809, (6706311.503, 14016791.503), (0.635, 1.340, 2.006)),
    ],
)
def test_two_transporters_in_four_groups_have_the_published_frequencies(
    vehicle_groups, mass, height, inertia, frequencies
) -> None:
    """Two side by side, front and rear halves of each a group."""
    middles = np.array([(x, y, -height) for x in (2.1, -2.1) for y in (3.0, -3.0)])
    given = SupportStatics(
        vehicle_groups, middles, np.full(4, 6), np.full(4, K), mass * G, mass, np.diag([*inertia, 1.5e7])
    )
    np.testing.assert_allclose(np.sqrt(small_motions(given)) / (2.0 * np.pi), frequencies, atol=6e-4)


@pytest.mark.slow
@pytest.mark.parametrize("sigma", [0.01, 0.1, 0.6])
def test_loads_on_rough_roads_with_stops_are_those_of_a_bracketing_search(sigma) -> None:
    """A body that is held, wheels on random lanes: stops, wheels in the air, groups without pressure."""
    rng = np.random.default_rng(round(100 * sigma))
    low, high = -0.05, 0.08
    stations = np.concatenate([[-30.0, 4.0], np.arange(5.0, 60.0)])
    lanes = {}
    for name, sides in (("left", (0.1, 2.0)), ("right", (-2.0, -0.1))):
        heights = np.concatenate([[0.0, 0.0], sigma * rng.standard_normal(55)])
        lanes[name] = heights, Deck(name=name, sides=np.array(sides), stations=stations, heights=heights)
    made = scene(
        vehicle(bogie_mass=0.0, stroke_limits=np.array([low, high]), travel_speed=1.0),
        tuple(lane for _, lane in lanes.values()),
        body=block(motion=Fixed()),
    )
    run, times, found = histories(made, 0.05, 40.0, 4)
    assert run.outcome is Outcome.COMPLETED
    load, kappa = MASS * G / 12, OIL / 3
    seen = set()
    for i, time in enumerate(times):
        for g, (lines, lane) in enumerate(
            ((FRONT, "left"), (FRONT, "right"), (REAR, "left"), (REAR, "right"))
        ):
            r = np.interp(np.array(lines) + time, stations, lanes[lane][0]) + load / TYRE

            def strokes(p: float, r: np.ndarray = r) -> np.ndarray:
                return np.clip(r - p / TYRE, low, high)

            def miss(p: float, strokes=strokes) -> float:
                return max(0.0, load + kappa * strokes(p).sum()) - p

            p = brentq(miss, 0.0, 1e8, xtol=1e-7, rtol=1e-14) if miss(0.0) > 0.0 else 0.0
            expected = np.where(strokes(p) == r - p / TYRE, p, np.maximum(0.0, TYRE * (r - strokes(p))))
            np.testing.assert_allclose(
                found["spmt.wheel_load"][i, 3 * g : 3 * g + 3], expected, atol=1e-6 * load
            )
            np.testing.assert_allclose(found["spmt.group_force"][i, g], p, atol=1e-9 * load)
            seen |= {"air"} if expected.min() == 0.0 else set()
            seen |= {"stop"} if strokes(p).max() == high else set()
    assert sigma < 0.05 or seen == {"air", "stop"}


def test_corners_of_places_are_those_of_their_convex_hull():
    rng = np.random.default_rng(7)
    for count in (3, 4, 7, 40):
        points = rng.normal(size=(count, 2))
        expected = [int(number) for number in ConvexHull(points).vertices]
        found = _hull(points)
        first = expected.index(found[0])
        assert found == expected[first:] + expected[:first]
    grid = np.array([[x, y] for x in range(4) for y in range(3)], dtype=np.float64)
    assert {tuple(point) for point in grid[_hull(grid)]} == {(0, 0), (3, 0), (3, 2), (0, 2)}
