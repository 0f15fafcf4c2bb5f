"""Paths of transporters: curves and steering in closed form, runs on them, decks that move, what drives give."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from vehicles import BOGIE, FRONT, MASS, OIL, REAR, G, block, groups_of, histories, scene, vehicle, yard

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.scene.bodies import Driven, Harmonic, Profile
from heavylift.solver.scene.scenario import Condition, Phase, Scenario
from heavylift.solver.scene.scene import RigidBody
from heavylift.solver.scene.signals import Signal, Term
from heavylift.solver.scene.transport import BogieGroup, Drive, HeightGrid, PathLeg
from heavylift.solver.simulation import Simulation
from heavylift.solver.transport.decks import Deck
from heavylift.solver.transport.routes import make_route, rolling, steering_turns

PLACES = np.array([(x, y) for x in FRONT + REAR for y in (0.725, -0.725)])
LIMIT = math.radians(130.0)
WIDE = yard(stations=np.array([-60.0, 60.0]), sides=np.array([-60.0, 60.0]))


def leg(*points, **more) -> PathLeg:
    """Of some points, at 0.5 m/s."""
    given = {"points": np.array(points, dtype=np.float64).reshape(-1, 2), "speed": 0.5, "acceleration": 0.1}
    return PathLeg(**(given | more))


def angles(nodes: np.ndarray, places: np.ndarray = PLACES) -> np.ndarray:
    """Steering angles at rows of a route [rad]."""
    along, across = rolling(nodes, places)
    return np.arctan2(across, along)


def test_wheels_stand_square_to_the_instantaneous_centre() -> None:
    """Centre (0, 15): 13.776, 12.548 degrees, 14.698, 16.110 m; rear bogies mirror front ones; carousel 101.703."""
    route = make_route([leg([30, 0], [30, 30], radius=15.0)], PLACES, np.zeros(3))
    on_arc = np.flatnonzero((route.nodes[:-1, 6] > 0.0) & (route.nodes[1:, 6] > 0.0))
    found = angles(route.nodes[on_arc])
    expected = np.arctan2(PLACES[:, 0], 15.0 - PLACES[:, 1])
    np.testing.assert_allclose(np.degrees(found - expected), 0.0, atol=1e-9)
    np.testing.assert_allclose(np.degrees(expected[:2]), [13.776, 12.548], atol=5e-4)
    np.testing.assert_allclose(found[:, -2:], -found[:, :2], atol=1e-14)
    radii = np.hypot(*rolling(route.nodes[on_arc], PLACES)) * 15.0
    np.testing.assert_allclose(radii[:, :2] - [[14.698, 16.110]], 0.0, atol=5e-4)

    route = make_route([PathLeg(steering="carousel", turn=1.0, speed=0.1)], PLACES, np.zeros(3))
    np.testing.assert_allclose(np.degrees(angles(route.nodes)[:, 0]), 101.703, atol=5e-4)
    # those beyond 130 degrees roll the other way
    turns = steering_turns(route, PLACES, LIMIT)
    turned = np.degrees(angles(route.nodes)[0] + turns[0])
    assert turned[4] == pytest.approx(136.005 - 180.0, abs=1e-3)
    assert np.abs(turned).max() < 130.0


@pytest.mark.parametrize(("steering", "straight"), [("front", -3.5), ("rear", 3.5)])
def test_the_line_that_does_not_steer_stays_straight(steering, straight) -> None:
    """Its middle follows the curve, so the instantaneous centre is on the line across through it."""
    route = make_route([leg([20, 0], [20, 20], radius=9.0, steering=steering)], PLACES, np.zeros(3))
    bends = (route.nodes[:-1, 6] > 0.0) & (route.nodes[1:, 6] > 0.0)
    nodes = route.nodes[:-1][bends]
    expected = np.arctan2(PLACES[:, 0] - straight, 9.0 - PLACES[:, 1])
    np.testing.assert_allclose(angles(nodes), np.tile(expected, (len(nodes), 1)), atol=1e-14)
    # and the middle of the bogies is that far from it: at the end a quarter turn to the left of where it began
    x, y, yaw = route.nodes[-1, 1:4]
    np.testing.assert_allclose([x, y, yaw], [straight + 20.0, 20.0 - straight, 0.5 * np.pi], atol=1e-12)


def test_a_clothoid_is_what_an_integration_of_its_curvature_gives() -> None:
    """Corner of 70 degrees with transitions: pose at the end, and the way of a straight, two clothoids, an arc."""
    R, L, turn = 12.0, 4.0, math.radians(70.0)
    corner = np.array([25.0, 0.0])
    beyond = corner + 25.0 * np.array([math.cos(turn), math.sin(turn)])
    route = make_route([leg(corner, beyond, radius=R, transition=L)], PLACES, np.array([1.0, 2.0, 0.3]))
    arc = turn * R - L
    nodes = route.nodes
    first = nodes[np.flatnonzero(nodes[:, 6] != 0.0)[0] - 1, 0]  # where the straight ends

    def curvature(way: float) -> float:
        return float(np.interp(way - first, [0.0, L, L + arc, 2 * L + arc], [0.0, 1 / R, 1 / R, 0.0]))

    def rates(way: float, pose: np.ndarray) -> list[float]:
        return [math.cos(pose[2]), math.sin(pose[2]), curvature(way)]

    total = nodes[-1, 0]
    solved = solve_ivp(rates, (0.0, total), [1.0, 2.0, 0.3], rtol=1e-11, atol=1e-12, max_step=0.05)
    np.testing.assert_allclose(nodes[-1, 1:4], solved.y[:, -1], atol=1e-8)
    c, s = math.cos(0.3), math.sin(0.3)
    end = np.array([1.0, 2.0]) + np.array([[c, -s], [s, c]]) @ beyond
    np.testing.assert_allclose(nodes[-1, 1:3], end, atol=1e-9)


def test_a_smooth_curve_passes_its_points() -> None:
    """Points of a circle: curvature 1/20 within the error of the spline, and its length."""
    angle = np.linspace(0.1, 1.0, 10)
    points = 20.0 * np.column_stack([np.sin(angle), 1.0 - np.cos(angle)])
    nodes = make_route([leg(*points, curve="smooth")], PLACES, np.zeros(3)).nodes
    for point in points:
        assert np.hypot(*(nodes[:, 1:3] - point).T).min() < 1e-12
    assert nodes[-1, 0] == pytest.approx(20.0, abs=5e-4)
    inner = (nodes[:, 0] > 2.0) & (nodes[:, 0] < 12.0)
    np.testing.assert_allclose(nodes[inner, 6], 0.05, atol=2e-4)


def test_backwards_crab_and_pauses() -> None:
    """A leg behind the vehicle is driven backwards without turning the wheels; crab keeps the heading; rest between."""
    legs = [leg([-10, 0]), leg([0, 5], steering="crab", pause=3.0)]
    route = make_route(legs, PLACES, np.zeros(3))
    np.testing.assert_allclose(route.nodes[-1, 1:4], [-10.0, 5.0, 0.0], atol=1e-12)
    turns = steering_turns(route, PLACES, LIMIT)
    np.testing.assert_allclose(turns[0], -np.pi, rtol=1e-15)
    of_crab = angles(route.nodes[route.nodes[:, 12] == 1])
    np.testing.assert_allclose(of_crab, 0.5 * np.pi, rtol=1e-15)
    # 10 m at 0.5 m/s with 0.1 m/s2: 25 s, then 3 s and 15 s
    np.testing.assert_allclose(route.pieces[-1, :2], [25.0 + 3.0 + 15.0, 15.0], rtol=1e-12)


@pytest.mark.parametrize(
    ("legs", "more", "words"),
    [
        (
            [leg([30, 0], [30, 30], radius=5.0)],
            {"steering_limit": 0.5},
            r"bogie 1 would have to steer by 39.* leg 1",
        ),
        ([leg([5, 1])], {}, "leads 11.3099 degrees off"),
        ([leg([5, 0], [5, 5])], {}, "corner at point 1, of 90 degrees, has no radius"),
        ([leg([5, 0], [5, 5], radius=6.0)], {}, "corners take 6 m of the 5 m"),
        ([leg([15, 0], [15, 15], radius=2.0, transition=4.0)], {}, "is turned within 3.14159 m of an arc"),
        ([leg([15, 0], [0, 0.1], radius=2.0)], {}, "goes back"),
        (
            [leg([15, 0], [15, 15], radius=0.5)],
            {},
            r"radius: at 14\.5 m it turns about a point 0\.5 m to the left, between its own wheels",
        ),
        (
            [leg([5, 0], [5, -5], radius=2.0, transition=1.0), leg([3, 0], [3, -3], radius=0.7)],
            {},
            "to the right",
        ),
        ([leg([5, 0], [5, 0])], {}, "point 2 is where the piece to it begins"),
        ([PathLeg(steering="carousel", speed=0.1)], {}, "a carousel without turn"),
        ([leg([5, 0], turn=1.0)], {}, "'turn' with steering 'all'"),
        ([leg([5, 0])], {"travel_speed": 1.0}, "'travel_speed' with 'legs'"),
        ([leg([5, 0])], {"drive": Drive(bogies=(13,))}, "drive.bogies: bogie 13"),
        (
            [leg([15, 0], [15, 15], radius=5.0)],
            {"drive": Drive(speeds=np.array([0.0, 0.5]), forces=np.array([1e4, 1e4]))},
            "a driven wheel runs up to 0.671",
        ),
        ([], {"drive": Drive()}, "a 'drive' without 'legs'"),
    ],
)
def test_paths_that_do_not_fit_are_refused(legs, more, words) -> None:
    """Each with station, bogie and what was expected."""
    with pytest.raises(InputError, match=words):
        Simulation(scene(vehicle(legs=tuple(legs), **more), (WIDE,)), step=5e-3)


def test_a_vehicle_stays_on_its_path() -> None:
    """T14: 1e-6 m and 1e-8 rad of poses that are integrated apart from it; work of the drives is in the balance."""
    legs = (
        leg([10, 0], [10, 10], radius=8.0, transition=2.0),
        PathLeg(steering="carousel", turn=-0.5, centre=np.array([1.0, 0.5]), speed=0.3, acceleration=0.1),
        leg([3, 3], steering="crab"),
    )
    drive = Drive(bogies=(1, 2, 5, 6))
    made = scene(vehicle(legs=legs, drive=drive, bogie_mass=0.0), (WIDE,))
    run, _, found = histories(made, 1e-2, 65.0, 20)
    assert run.outcome is Outcome.COMPLETED
    assert found["spmt.off_path"].max() < 1e-6
    assert np.abs(found["spmt.off_heading"]).max() < 1e-8
    # the pose at the end, by hand: a quarter turn, a turn about the centre, then along its own diagonal
    x, y, yaw = 10.0, 10.0, 0.5 * np.pi
    centre = np.array([x, y]) + np.array([-0.5, 1.0])
    yaw -= 0.5
    turned = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    end = centre - turned @ [1.0, 0.5] + turned @ [3.0, 3.0]
    position, q = found["block.position"][-1], found["block.orientation"][-1]
    np.testing.assert_allclose(position[:2], end, atol=2e-4)
    heading = math.atan2(2.0 * (q[0] * q[3] + q[1] * q[2]), 1.0 - 2.0 * (q[2] ** 2 + q[3] ** 2))
    assert heading == pytest.approx(yaw, abs=1e-7)
    names = ("kinetic", "potential", "elastic", "dissipated")
    total = np.sum([found[f"energy.{name}"] for name in names], axis=0) - found["energy.drive_work"]
    np.testing.assert_allclose(total, total[0], atol=1e-3 * np.ptp(found["energy.kinetic"]))


def test_a_path_goes_over_from_one_moving_deck_to_another() -> None:
    """From ground to a deck that surges by 0.1 m: without a jump, and in the end along with the deck."""
    omega, amplitude = 0.5, 0.1
    surge = Profile(harmonics=(Harmonic(amplitude=amplitude, frequency=omega / (2.0 * np.pi), phase=0.0),))
    barge = RigidBody("barge", 1e6, np.eye(3) * 1e8, motion=Driven(x=surge, y=surge))
    decks = (
        yard(stations=np.array([-30.0, 8.0]), sides=np.array([-5.0, 5.0])),
        replace(yard(body="barge", stations=np.array([8.1, 40.0])), name="deck"),
    )
    transporter = vehicle(
        legs=(leg([20, 0], speed=0.4),), handover=6.0, bogie_mass=0.0, line_damping=2e4, wheel_radius=0.37
    )
    made = scene(transporter, decks, bodies=(barge, block()))
    run, times, found = histories(made, 1e-2, 110.0, 10)
    assert run.outcome is Outcome.COMPLETED
    assert found["spmt.off_path"].max() < 1e-6
    moved = amplitude * np.sin(omega * times)
    early, late = times < 8.0, times > 104.0  # 17 delays behind the last change of the load
    # the middle of the bogies: of the frame of the block, which is on the road below its centre of mass
    place = found["block.position"][:, :2]
    np.testing.assert_allclose(place[early][:, 1], 0.0, atol=1e-9)
    np.testing.assert_allclose(
        place[late] - moved[late, None], np.tile([20.0, 0.0], (late.sum(), 1)), atol=2e-4
    )
    # a jump of 0.1 m in a step of 10 ms would be 10 m/s
    sideways = found["block.velocity"][:, 1]
    assert np.abs(sideways).max() < 0.06
    assert np.abs(np.diff(sideways)).max() < 0.005


def test_what_a_deck_does_itself_is_no_work_of_the_drives() -> None:
    """Onto a deck that heaves by 20 mm: drives give rolling, and the rise of the wheels over edges, not the deck's own.

    Both sides of the sum are of the records: loads, and heights of the road under wheels on one deck. An edge that is
    higher by d than the deck before is climbed at first with the slope ``sqrt(2 R d - d^2)/(R - d)``.
    """
    radius, amplitude = 0.37, 0.02
    heave = Profile(harmonics=(Harmonic(amplitude=amplitude, frequency=0.3, phase=0.0),))
    barge = RigidBody("barge", 1e6, np.eye(3) * 1e8, motion=Driven(z=heave))
    decks = (
        yard(stations=np.array([-30.0, 5.0]), sides=np.array([-5.0, 5.0])),
        replace(yard(body="barge", stations=np.array([5.02, 40.0])), name="deck"),
    )
    transporter = vehicle(
        legs=(leg([10, 0], speed=0.1),),
        drive=Drive(speeds=np.array([0.0, 1.0]), forces=np.array([4e4, 4e4])),
        bogie_mass=0.0,
        line_damping=2e4,
        tyre_damping=1.5e4,
        wheel_radius=radius,
    )
    run, _, found = histories(scene(transporter, decks, bodies=(barge, block())), 1e-2, 102.0)
    assert run.outcome is Outcome.COMPLETED
    load, under = found["spmt.wheel_load"], found["spmt.road_under"]
    way, demand = np.diff(found["spmt.path_way"]), found["spmt.drive_demand"][1:]
    mean, rise = 0.5 * (load[1:] + load[:-1]), np.diff(under, axis=0)
    same = np.abs(rise) <= 2.0 * way[:, None]  # else it has gone over, and the heights are of two decks
    assert (~same).sum() < 40
    rolling, climbing = 0.02 * mean.sum(axis=1) * way, np.where(same, mean * rise, 0.0).sum(axis=1)
    assert float(demand @ way) == pytest.approx(float((rolling + climbing).sum()), rel=5e-3)
    edge = amplitude + 0.5e-3
    slope = math.sqrt(2.0 * radius * edge - edge**2) / (radius - edge)
    most = 0.02 * MASS * G + 2.0 * load.max() * slope
    moving = way > 0.99 * way.max()
    assert 0.3 * most < demand[moving].max() < 1.1 * most
    assert demand[moving].min() > -1.1 * most


def test_a_vehicle_pushes_its_deck_back() -> None:
    """On a free body that carries the road momentum is kept, whatever path the vehicle takes."""
    barge = RigidBody("barge", 4.0e5, np.diag([5e6, 5e7, 5e7]))
    deck = yard(body="barge", stations=np.array([-20.0, 20.0]), sides=np.array([-20.0, 20.0]))
    legs = (leg([5, 0], [5, 6], radius=3.5, transition=1.0),)
    transporter = vehicle(legs=legs, bogie_mass=0.0, tyre_damping=1.5e5, line_damping=2e4)
    _, _, found = histories(scene(transporter, (deck,), bodies=(barge, block())), 5e-3, 6.0, 20)
    np.testing.assert_allclose(found["momentum.linear"][:, :2], 0.0, atol=1e-5)
    assert np.abs(found["block.velocity"]).max() > 0.3
    np.testing.assert_allclose(found["momentum.angular"], 0.0, atol=2e-2)


def train(slope: float, *, tilted: bool) -> tuple[Deck, RigidBody, tuple[BogieGroup, ...]]:
    """144 bogies under 1,891.6 t on a slope, of the profile or of the whole deck."""
    x = 1.4 * (np.arange(18) - 8.5)
    y = [middle + side for middle in (-14.0, -6.0, 6.0, 14.0) for side in (-0.725, 0.725)]
    groups = tuple(
        BogieGroup(
            f"g{front}{left}",
            np.array([(a, b, 0.0) for a in x for b in y if (a > 0) == front and (b > 0) == left]),
            oil_stiffness=OIL,
        )
        for front in (True, False)
        for left in (True, False)
    )
    angle = math.atan(slope)
    q = np.array([math.cos(0.5 * angle), 0.0, -math.sin(0.5 * angle), 0.0])
    mass = 1891.6e3
    body = RigidBody(
        "block",
        mass,
        mass * np.diag([9.0, 16.0, 20.0]) * 4.0,
        centre_of_mass=np.array([0.0, 0.0, 9.93]),
        orientation=q,
    )
    if tilted:
        c, s = math.cos(angle), math.sin(angle)
        more = {"direction": np.array([c, 0.0, s]), "normal": np.array([-s, 0.0, c])}
        return yard(sides=np.array([-30.0, 30.0]), **more), body, groups
    heights = slope * np.array([-60.0, 60.0])
    return (
        yard(stations=np.array([-60.0, 60.0]), heights=heights, sides=np.array([-30.0, 30.0])),
        body,
        groups,
    )


@pytest.mark.slow
@pytest.mark.parametrize("tilted", [False, True])
@pytest.mark.parametrize(
    ("slope", "demand", "each"), [(0.0, 371.1e3, 5.2e3), (0.01, 556.7e3, 7.7e3), (0.02479, 831.3e3, 11.5e3)]
)
def test_drives_give_what_slope_and_rolling_ask_for(slope, demand, each, tilted) -> None:
    """T15: W (slope + 0.02), shared by 72 driven bogies; a slope of the road and one of its body alike."""
    deck, body, groups = train(slope, tilted=tilted)
    driven = tuple(range(1, 145, 2))
    transporter = vehicle(
        groups=groups,
        bogie_mass=0.0,
        line_damping=2e4,
        tyre_damping=1.5e4,
        legs=(leg([5, 0], speed=0.0694, acceleration=0.01),),
        drive=Drive(bogies=driven, speeds=np.array([0.0, 0.1, 1.0]), forces=np.array([4e4, 3e4, 1e4])),
    )
    _, times, found = histories(scene(transporter, (deck,), body=body), 1e-2, 40.0, 50)
    steady = (times > 20.0) & (times < 40.0)
    found_demand = found["spmt.drive_demand"][steady].mean()
    assert found_demand == pytest.approx(1891.6e3 * G * (slope + 0.02), rel=1e-3)
    assert found_demand == pytest.approx(demand, rel=1e-3)
    assert found["spmt.bogie_drive"][steady].mean() == pytest.approx(each, abs=60.0)
    capacity = 4e4 - 1e4 * 0.694
    np.testing.assert_allclose(
        found["spmt.drive_used_max"][steady], found["spmt.bogie_drive_max"][steady] / capacity, rtol=1e-3
    )
    loads = found["spmt.wheel_load"][:, ::2].min(axis=1)
    np.testing.assert_allclose(
        found["spmt.traction_used_max"][steady],
        found["spmt.bogie_drive_max"][steady] / (0.3 * loads[steady]),
        rtol=1e-2,
    )


def test_brakes_hold_at_rest_what_the_deck_pulls() -> None:
    """W sin of the slope over two driven bogies and what each can hold; rolling resistance is none at rest."""
    slope = 0.02
    angle = math.atan(slope)
    c, s = math.cos(angle), math.sin(angle)
    deck = yard(direction=np.array([c, 0.0, s]), normal=np.array([-s, 0.0, c]))
    body = block(orientation=np.array([math.cos(0.5 * angle), 0.0, -math.sin(0.5 * angle), 0.0]))
    drive = Drive(bogies=(1, 2), brake_force=40e3)
    legs = (leg([5, 0], pause=100.0),)
    transporter = vehicle(legs=legs, drive=drive, bogie_mass=0.0, tyre_damping=1.5e5, line_damping=2e4)
    run, _, found = histories(scene(transporter, (deck,), body=body), 1e-2, 20.0, 50)
    assert "its brakes" not in run.warning
    assert "would slip" not in run.warning
    held = MASS * G * slope
    assert found["spmt.push_along"][-1] == pytest.approx(held, rel=2e-3)
    assert found["spmt.brake_used_max"][-1] == pytest.approx(0.5 * held / 40e3, rel=5e-3)
    assert found["spmt.drive_used_max"].max() == 0.0
    weak = replace(transporter, drive=Drive(bogies=(1, 2), brake_force=10e3, friction=0.1))
    run, _, found = histories(scene(weak, (deck,), body=body), 1e-2, 20.0, 50)
    assert found["spmt.brake_used_max"][-1] == pytest.approx(0.5 * held / 10e3, rel=5e-3)
    traction = 0.5 * held / (0.1 * MASS * G / 12.0)
    assert found["spmt.traction_used_max"][-1] == pytest.approx(traction, rel=0.05)
    assert "'spmt' follows its path, and needs up to 1.2" in run.warning
    assert "times the friction that a driven bogie has: its wheels would slip" in run.warning
    assert f"{found['spmt.brake_used_max'].max():.3g} times the force of its brakes at rest" in run.warning


def test_a_wheel_at_an_edge_asks_for_nearly_its_load() -> None:
    """An edge of 100 mm for all wheels of the front line: 0.937 of their load where they touch it first."""
    plate = Deck(
        name="plate", sides=np.array([-2.0, 2.0]), stations=np.array([4.5, 4.6]), heights=np.array([0.1, 0.1])
    )
    legs = (leg([3, 0], speed=0.02),)
    drive = Drive(rolling_resistance=0.0)
    transporter = vehicle(groups=groups_of(3), legs=legs, drive=drive, wheel_radius=0.37, line_damping=2e4)
    _, _, found = histories(scene(transporter, (yard(), plate)), 5e-3, 60.0, 4)
    first = 4.5 - 0.253 - 3.5  # of the front line
    at = np.flatnonzero(found["spmt.path_way"] > first)[2]
    loads = found["spmt.wheel_load"][at, :2].sum() - 2.0 * BOGIE * G
    assert found["spmt.drive_demand"][at] == pytest.approx(0.937 * loads, rel=0.02)


def test_a_path_sees_its_bogies_in_a_scene_with_a_scenario() -> None:
    """There carried states are moved into one array: drives and shares of loads look at those, not at old ones."""
    made = scene(vehicle(legs=(leg([5, 0]),), drive=Drive()), (WIDE,))
    never = Condition(Signal((Term("block.position", "z"),)), 1e6)
    watched = replace(made, scenario=Scenario((Phase("rolls", until=(never,)),)))
    _, _, plain = histories(made, 1e-2, 6.0, 50)
    _, _, found = histories(watched, 1e-2, 6.0, 50)
    assert plain["spmt.drive_demand"][5] > 1e4
    np.testing.assert_array_equal(found["spmt.drive_demand"], plain["spmt.drive_demand"])


def test_wheels_that_turn_between_two_legs_ask_nothing_of_the_drives() -> None:
    """On ridges across the way wheels sink by some millimetres as they turn at rest: no slope that a drive climbs.

    Each triangle is as steep as 40 mm/m, so a wheel asks its drive for 4 % of its load at most: 0.2 of friction with
    two thirds of the bogies driven, as vehicles of this file have it, and what speeding up takes.
    """
    lines = np.arange(-12.0, 12.25, 0.5)
    ridges = np.where(np.arange(len(lines)) % 2, 0.02, 0.0)
    grid = HeightGrid(
        stations=lines, offsets=np.array([-12.0, 12.0]), heights=np.repeat(ridges[:, None], 2, 1)
    )
    legs = (leg([1.2, 0]), leg([0, 2], steering="crab"))
    driven = Drive(bogies=(1, 3, 4, 6, 7, 9, 10, 12), rolling_resistance=0.0)
    made = scene(vehicle(wheel_radius=0.37, legs=legs, drive=driven), (Deck(name="ridges", grid=grid),))
    _, _, found = histories(made, 1e-2, 14.0, 10)
    assert np.ptp(found["spmt.steering"][:, 0]) > 1.5
    assert found["spmt.traction_used_max"].max() < 0.3
