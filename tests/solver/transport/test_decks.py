"""Heights of wheels on decks against closed forms and brute force, and roads that no wheel can follow."""

from __future__ import annotations

import numpy as np
import pytest
from vehicles import MASS, OIL, TYRE, G, block, bump, groups_of, histories, scene, vehicle, yard

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.joints.guide import Guide
from heavylift.solver.scene.bodies import Driven, Fixed, Harmonic, Profile
from heavylift.solver.scene.scene import RigidBody
from heavylift.solver.scene.transport import BogieGroup, HeightGrid, PathLeg
from heavylift.solver.simulation import Simulation
from heavylift.solver.stop_message import stop_message
from heavylift.solver.transport.decks import NO_ROAD, Deck, grid_heights, wheel_heights
from heavylift.solver.transport.packing import vehicle_tipping
from heavylift.solver.transport.transporters import WALL

R = 0.37


def height(corners, x: float, radius: float = R) -> float:
    """Height of a wheel."""
    table = np.array(corners, dtype=np.float64)
    return float(wheel_heights(table, 0, len(table), radius, [x])[0])


@pytest.mark.parametrize(("width", "dip"), [(0.1, 0.0033939), (0.2, 0.0137697), (0.3, 0.0317693)])
def test_a_wheel_dips_into_a_gap(width, dip) -> None:
    """``R - sqrt(R^2 - b^2/4)`` between two edges."""
    deep = [(-5, 0), (-0.5 * width, 0), (-0.5 * width, -3), (0.5 * width, -3), (0.5 * width, 0), (5, 0)]
    assert height(deep, 0.0) == pytest.approx(-dip, abs=1e-6)


@pytest.mark.parametrize(
    ("rise", "before", "slope"), [(0.02, 0.120, 0.343), (0.05, 0.186, 0.580), (0.1, 0.253, 0.937)]
)
def test_a_wheel_meets_an_edge_before_it(rise, before, slope) -> None:
    """First touch ``sqrt(2 R H - H^2)`` before the edge, slope there ``sqrt(2 R H - H^2) / (R - H)``."""
    step = [(-5, 0), (0, 0), (0, rise), (5, rise)]
    touch = np.sqrt(2.0 * R * rise - rise * rise)
    assert touch == pytest.approx(before, abs=6e-4)
    assert height(step, -touch - 1e-6) == 0.0
    assert height(step, -touch + 1e-6) == pytest.approx(1e-6 * slope, rel=1e-3)
    assert height(step, -1e-12) == pytest.approx(rise, abs=1e-9)
    assert height([(-x, h) for x, h in reversed(step)], touch - 1e-6) == pytest.approx(1e-6 * slope, rel=1e-3)


def test_a_ramp_is_met_by_r_tan_of_half_its_angle_earlier() -> None:
    """10 degrees: 32 mm; above it the slope is that of the ramp."""
    tangent = np.tan(np.radians(10.0))
    ramp = [(-5, 0), (0, 0), (0.1 / tangent, 0.1), (5, 0.1)]
    early = R * np.tan(np.radians(5.0))
    assert early == pytest.approx(0.032, abs=5e-4)
    assert height(ramp, -early - 1e-9) == 0.0
    assert height(ramp, 0.2) == pytest.approx(tangent * (0.2 + early), rel=1e-12)


def test_a_wheel_is_the_upper_envelope_of_circles() -> None:
    """Rough polygons with steps, against the definition on a fine grid."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        x = np.sort(rng.uniform(-2.0, 2.0, 15))
        x[6] = x[7]
        h = 0.05 * rng.standard_normal(15)
        grid = np.linspace(x[0], x[-1], 400_001)
        values = np.interp(grid, np.concatenate([x[:7], [x[7] + 1e-9], x[8:]]), h)
        for at in rng.uniform(-1.5, 1.5, 20):
            near = np.abs(grid - at) <= R
            if not np.any(near):
                assert height(list(zip(x, h, strict=True)), at) == NO_ROAD
                continue
            u = grid[near] - at
            expected = np.max(values[near] + np.sqrt(R * R - u * u)) - R
            assert height(list(zip(x, h, strict=True)), at) == pytest.approx(
                expected, abs=2e-5
            )  # of the grid


def test_a_wheel_on_a_step_is_never_in_the_air() -> None:
    """100 mm at 0.0694 m/s: smallest load above 5 t of 14.5."""
    step = Deck(
        name="plate", sides=np.array([0.2, 1.5]), stations=np.array([4.0, 5.0]), heights=np.array([0.1, 0.1])
    )
    made = scene(vehicle(wheel_radius=R, travel_speed=0.0694, line_damping=2e4), (yard(), step))
    run, _, found = histories(made, 1e-2, 160.0, 10)
    assert run.outcome is Outcome.COMPLETED
    assert found["spmt.road_under"][:, 0].max() == pytest.approx(0.1)
    assert found["spmt.load_min"].min() > 5.0 * 9810.0


@pytest.mark.parametrize(
    ("decks", "words"),
    [
        ((yard(stations=np.array([-30.0, 2.0])),), r"no deck is below bogie 1, at \(3\.5, 0\.725, 0\)"),
        ((yard(sides=np.array([-10.0, 0.5])),), "no deck is below bogie 1"),
        (
            (yard(stations=np.array([-30.0, 5, 5, 60.0]), heights=np.array([0, 0, 0.4, 0.4])),),
            "yard: stations: a rise of 0.4 m within 0 m at station 5 m, too steep",
        ),
        ((yard(heights=np.array([-0.5, -0.5])),), "is 0.5 m above deck 'yard', more than its stroke"),
        ((yard(sides=np.array([1.0, -1.0])),), "right border, left border"),
        ((yard(normal=np.array([0.0, 0.0, -1.0])),), r"yard: normal: \[0\.0, 0\.0, -1\.0\] points down"),
        ((yard(direction=np.array([1.0, 0.0, 0.2])),), "at a right angle to 'normal'"),
        ((yard(stations=np.array([3.0, -3.0])),), "stations that do not fall"),
        ((yard(body="nobody"),), "there is no body 'nobody'"),
        ((Deck(name="d", sides=np.array([-1.0, 1.0])),), "no 'stations' and no 'bump'"),
    ],
)
def test_roads_that_no_wheel_can_stand_on_are_refused(decks, words) -> None:
    """Each with its name and what was expected."""
    limits = np.array([-0.35, 0.35])
    with pytest.raises(InputError, match=words):
        Simulation(scene(vehicle(wheel_radius=R, stroke_limits=limits), decks), step=5e-3)


def _rough(lines: tuple[int, int] = (9, 7)) -> HeightGrid:
    """Heights at random over lines at random."""
    rng = np.random.default_rng(1)
    x, y = (np.sort(rng.uniform(-2.0, 2.0, count)) for count in lines)
    return HeightGrid(stations=x, offsets=y, heights=0.1 * rng.standard_normal(lines))


def _surface(grid: HeightGrid, px, py):
    """Cells of four plane triangles, by similar triangles along the ray from the middle of a cell to its border."""
    x, y, h = grid.stations, grid.offsets, grid.heights
    i = np.clip(np.searchsorted(x, px, side="right") - 1, 0, len(x) - 2)
    k = np.clip(np.searchsorted(y, py, side="right") - 1, 0, len(y) - 2)
    p, q = 2.0 * (px - x[i]) / (x[i + 1] - x[i]) - 1.0, 2.0 * (py - y[k]) / (y[k + 1] - y[k]) - 1.0
    a, b, c, d = h[i, k], h[i + 1, k], h[i + 1, k + 1], h[i, k + 1]
    far = np.maximum(np.maximum(np.abs(p), np.abs(q)), 1e-300)
    s, t = 0.5 * (p / far + 1.0), 0.5 * (q / far + 1.0)
    across = np.where(p > 0.0, b + (c - b) * t, a + (d - a) * t)
    along = np.where(q > 0.0, d + (c - d) * s, a + (b - a) * s)
    middle = 0.25 * (a + b + c + d)
    return middle + far * (np.where(np.abs(p) >= np.abs(q), across, along) - middle)


def test_a_wheel_on_a_grid_is_the_upper_envelope_of_circles_along_its_heading() -> None:
    """Against the definition on a fine cut, in all directions, along lines of the grid too; over all borders."""
    rng, grid = np.random.default_rng(2), _rough()
    fine = R * np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 20_001))  # close where the circle is steep
    seen = 0
    for turn in [*rng.uniform(0.0, 2.0 * np.pi, 150), *0.5 * np.pi * rng.integers(0, 4, 50)]:
        px, py = rng.uniform(-2.3, 2.3, 2)
        qx, qy = px + fine * np.cos(turn), py + fine * np.sin(turn)
        on = (qx >= grid.stations[0]) & (qx <= grid.stations[-1])
        on &= (qy >= grid.offsets[0]) & (qy <= grid.offsets[-1])
        (found,) = grid_heights(grid, R, px, py, turn)
        if not np.any(on):
            assert found == NO_ROAD
            continue
        seen += 1
        circles = _surface(grid, qx[on], qy[on]) + np.sqrt(R * R - fine[on] ** 2)
        assert found == pytest.approx(circles.max() - R, abs=1e-4 if np.all(on) else 2e-3)
        assert found >= circles.max() - R - 1e-12
    assert seen > 100


def test_a_point_follows_the_triangles_of_a_grid() -> None:
    """Radius 0, whatever its heading; a triangle differs from the bilinear surface by a sixteenth of the twist."""
    rng, grid = np.random.default_rng(3), _rough()
    x = rng.uniform(grid.stations[0], grid.stations[-1], 1000)
    y = rng.uniform(grid.offsets[0], grid.offsets[-1], 1000)
    for heading in (0.0, 1.0, -2.5):
        np.testing.assert_allclose(grid_heights(grid, 0.0, x, y, heading), _surface(grid, x, y), atol=1e-15)
    saddle = HeightGrid(
        stations=np.array([0.0, 1.0]),
        offsets=np.array([0.0, 1.0]),
        heights=np.array([[1.0, 0.0], [0.0, 0.0]]),
    )
    x, y = rng.uniform(0.0, 1.0, (2, 4000))
    off = np.abs(grid_heights(saddle, 0.0, x, y) - (1.0 - x) * (1.0 - y)).max()
    assert 0.95 / 16.0 < off <= 1.0 / 16.0


@pytest.mark.parametrize("heading", [0.0, np.pi])
def test_a_grid_of_one_profile_is_that_profile(heading: float) -> None:
    """Along stations, 1e-12; off them the profile is longer by the cosine of the heading."""
    rng, grid = np.random.default_rng(4), _rough()
    profile = 0.1 * rng.standard_normal(len(grid.stations))
    same = HeightGrid(stations=grid.stations, offsets=grid.offsets, heights=np.repeat(profile[:, None], 7, 1))
    x = rng.uniform(-2.2, 2.2, 500)
    y = rng.uniform(grid.offsets[0], grid.offsets[-1], 500)
    corners = np.column_stack([grid.stations, profile])
    expected = wheel_heights(corners, 0, len(corners), R, x)
    np.testing.assert_allclose(grid_heights(same, R, x, y, heading), expected, rtol=0.0, atol=1e-12)
    middle = np.full(20, 0.5 * (grid.offsets[0] + grid.offsets[-1]))
    corners[:, 0] /= np.cos(0.6)
    found = grid_heights(same, R, x[:20], middle, heading + 0.6)
    expected = wheel_heights(corners, 0, len(corners), R, x[:20] / np.cos(0.6))
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12)


def _table(sides: tuple[float, float], **more) -> Deck:
    """The smooth bump of 2 m and 100 mm at 4.5 m as a table, over part of the road."""
    stations, heights = bump(4.5, 2.0, sides, "smooth").profile
    offsets = np.linspace(*sides, 4)
    grid = HeightGrid(stations=stations, offsets=offsets, heights=np.repeat(heights[:, None], 4, 1))
    return Deck(name="bump", grid=grid, **more)


@pytest.mark.parametrize("travels", [True, False])
def test_a_table_under_the_left_wheels_is_the_bump_under_them(travels: bool) -> None:
    """All channels as those of the deck with the profile; wheels that travel by themselves, or that the body takes."""
    found = []
    for deck in (_table((0.2, 1.5)), bump(4.5, 2.0, (0.2, 1.5), "smooth")):
        more = {"travel_speed": 1.0} if travels else {}
        body = block() if travels else block(velocity=np.array([1.0, 0.0, 0.0]))
        made = scene(
            vehicle(wheel_radius=R, line_damping=2e4, tyre_damping=1.5e4, **more), (yard(), deck), body
        )
        found.append(histories(made, 5e-3, 6.0, 10)[2])
    assert found[0]["spmt.roll"].max() > 5e-3
    assert found[0]["spmt.road_under"][:, 3:6].max() == 0.0
    for name in found[0]:
        scale = max(np.abs(found[1][name]).max(), 1e-6)
        np.testing.assert_allclose(found[0][name], found[1][name], rtol=0.0, atol=1e-9 * scale, err_msg=name)


def test_steered_wheels_roll_along_their_own_cut_of_a_grid() -> None:
    """A crab leg at 30 degrees and one that bends: each wheel stands on the envelope along the way it rolls."""
    rng = np.random.default_rng(5)
    lines = np.linspace(-12.0, 12.0, 41)
    grid = HeightGrid(stations=lines, offsets=lines, heights=0.03 * rng.standard_normal((41, 41)))
    tan = np.tan(np.radians(30.0))
    legs = (
        PathLeg(steering="crab", points=np.array([[3.0, 3.0 * tan]]), speed=0.5, acceleration=0.5),
        PathLeg(steering="carousel", turn=0.5, speed=0.5, acceleration=0.5),
    )
    made = scene(
        vehicle(wheel_radius=R, line_damping=2e5, tyre_damping=1.5e5, legs=legs),
        (Deck(name="field", grid=grid),),
    )
    run, times, found = histories(made, 2e-3, 13.0, 100)
    assert run.outcome is Outcome.COMPLETED
    places = np.vstack([group.bogies for group in made.transporters[0].groups])
    turned = 0
    for n in range(len(times)):
        turn = found["block.orientation"][n]
        w, x, y, z = turn
        axes = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )
        world = found["block.position"][n] + places @ axes.T
        wheels = np.column_stack([np.cos(found["spmt.steering"][n]), np.sin(found["spmt.steering"][n])])
        ahead = np.column_stack([wheels, np.zeros(12)]) @ axes.T
        expected = grid_heights(grid, R, world[:, 0], world[:, 1], np.arctan2(ahead[:, 1], ahead[:, 0]))
        np.testing.assert_allclose(found["spmt.road_under"][n], expected, rtol=0.0, atol=1e-9)
        turned += np.ptp(found["spmt.steering"][n]) > 0.5
    assert turned > 10
    parts = [found[f"energy.{name}"] for name in ("kinetic", "potential", "elastic", "dissipated")]
    total = np.sum(parts, axis=0) - found["energy.drive_work"]
    assert np.ptp(total) < 0.02 * found["energy.dissipated"][-1]


@pytest.mark.parametrize(
    ("decks", "words"),
    [
        ((Deck(name="d", grid=_rough(), sides=np.array([-1.0, 1.0])),), "d: sides: 'sides' of a deck with a 'grid'"),
        ((_table((0.2, 1.5), bump=bump(0.0, 1.0, (0, 1)).bump),), "bump: stations: 'bump' and 'grid'"),
        ((Deck(name="d", grid=HeightGrid()),), "grid.file: neither 'file' nor 'stations'"),
        ((_table((0.2, 1.5)),), "no deck is below bogie 1"),
        (
            (yard(), Deck(name="d", grid=HeightGrid(
                stations=np.array([0.0, 1.0, 1.1, 9.0]), offsets=np.array([0.0, 9.0]),
                heights=np.array([[0, 0], [0, 0], [1, 0], [0, 0]]),
            ))),
            "d: grid: a rise of 1 m within 0.1 m at offset 0 m, station 1 m",
        ),
        (
            (yard(), Deck(name="d", grid=HeightGrid(
                stations=np.array([0.0, 1.0]), offsets=np.array([0.0, 1.0]), heights=np.zeros((3, 2))
            ))),
            "d: grid.heights: 3 rows of heights at 2 stations",
        ),
    ],
)  # fmt: skip
def test_grids_that_are_none_are_refused(decks, words) -> None:
    """Each with its name and what was expected."""
    with pytest.raises(InputError, match=words):
        Simulation(scene(vehicle(wheel_radius=R), decks), step=5e-3)


def test_a_grid_over_a_deck_of_another_body_at_one_height_is_refused() -> None:
    """A level table over the yard; a hump on it does not hide that."""
    beam = RigidBody("beam", 1e5, np.eye(3) * 1e6, motion=Fixed())
    heights = np.zeros((5, 5))
    heights[2, 2] = 0.1
    lines = np.linspace(-2.0, 2.0, 5)

    def start(rise: float) -> None:
        grid = HeightGrid(stations=20.0 + lines, offsets=lines, heights=heights + rise)
        made = scene(
            vehicle(bogie_mass=0.0),
            (yard(), Deck(name="link", body="beam", grid=grid)),
            bodies=(beam, block()),
        )
        Simulation(made, step=5e-3)

    with pytest.raises(InputError, match="link: stations: it overlaps deck 'yard'"):
        start(0.0)
    start(0.02)


def test_a_wheel_leaves_a_grid_over_any_of_its_borders() -> None:
    """Sideways in a crab leg, by the radius beyond its border; a wall in it stops the run by its name."""
    lines, leg = np.linspace(-5.0, 5.0, 11), PathLeg(
        steering="crab", points=np.array([[0.0, 6.0]]), speed=0.5, acceleration=1.0
    )  # fmt: skip
    level = HeightGrid(stations=lines, offsets=lines, heights=np.zeros((11, 11)))
    run, times, _ = histories(
        scene(vehicle(wheel_radius=R, legs=(leg,)), (Deck(name="d", grid=level),)), 5e-3, 12.0
    )
    assert run.outcome is Outcome.OFF_ROAD
    assert "bogie 1 " in run.message
    assert "offset 5.3" in run.message
    assert times[-1] == pytest.approx(0.25 + (5.0 + R - 0.725) / 0.5, abs=0.02)
    wall = Deck(
        name="wall",
        grid=HeightGrid(stations=lines, offsets=np.array([3.0, 4.0]), heights=np.full((11, 2), 0.6)),
    )
    decks = (Deck(name="d", grid=level), wall)
    run, _, _ = histories(scene(vehicle(wheel_radius=R, legs=(leg,)), decks), 5e-3, 12.0)
    assert run.outcome is Outcome.OFF_ROAD
    assert "meets a step that it cannot climb" in run.message


def _link(height: float, begin: float) -> Deck:
    """A deck of a body, over the end of the yard."""
    sides = np.array([-4.0, 4.0])
    return Deck(
        name="link", body="beam", sides=sides, stations=np.array([begin, 20.0]), heights=np.full(2, height)
    )


def test_a_deck_that_overlaps_one_of_another_body_is_refused() -> None:
    """At one height a wheel would stand on either; above it, or beside it, it is clear where."""
    beam = RigidBody("beam", 1e5, np.eye(3) * 1e6, motion=Fixed())
    ground = yard(stations=np.array([-30.0, 10.0]))

    def start(link: Deck) -> Simulation:
        made = scene(vehicle(bogie_mass=0.0), (ground, link), bodies=(beam, block()))
        return Simulation(made, step=5e-3)

    with pytest.raises(
        InputError, match=r"link: stations: it overlaps deck 'yard' .* from station 9.8 to 10 m"
    ):
        start(_link(0.0, 9.8))
    start(_link(0.0, 10.0))
    start(_link(0.02, 9.8))


def test_a_wheel_that_leaves_the_road_is_named_with_time_and_place() -> None:
    """The front left bogie at the end of the yard; the run stops."""
    made = scene(vehicle(wheel_radius=R, travel_speed=1.0), (yard(stations=np.array([-30.0, 4.0])),))
    run, times, _ = histories(made, 5e-3, 3.0)
    assert run.outcome is Outcome.OFF_ROAD
    assert times[-1] == pytest.approx(0.5 + R, abs=0.02)
    assert "bogie 1 has no deck below it, at station 4.3" in run.message
    assert "transporter 'spmt'" in run.message
    # the number is that of a row that was written after the wheel had ended the run
    run._layout.work.status.outcome, run._layout.work.status.block = int(Outcome.OFF_ROAD), 10**6
    (suspension,) = (kind for kind in run._layout.joints if "bogie_state" in kind._fields)
    suspension.bogie_state["failure"][1] = WALL
    assert "transporter 'spmt': bogie 2 meets a step" in stop_message(run._layout, "t = 1 s")


@pytest.mark.parametrize("begin", [0.0, 30.0])
def test_a_wheel_that_meets_a_wall_between_decks_is_named(begin: float) -> None:
    """A deck 0.6 m high across the road, wherever its stations begin."""
    wall = Deck(
        name="wall",
        origin=np.array([begin, 0.0, 0.0]),
        sides=np.array([-5.0, 5.0]),
        stations=np.array([6.0, 8.0]) - begin,
        heights=np.array([0.6, 0.6]),
    )
    run, _, _ = histories(scene(vehicle(wheel_radius=R, travel_speed=1.0), (yard(), wall)), 5e-3, 4.0)
    assert run.outcome is Outcome.OFF_ROAD
    assert "meets a step that it cannot climb" in run.message


def test_a_vehicle_that_tips_over_is_told() -> None:
    """A blow from the side that lifts its centre of mass over its wheels: the run ends as it lies down."""
    # to 4.9 m over the wheels from 3.58 m would need far less than half of J w^2
    thrown = block(angular_velocity=np.array([1.0, 0.0, 0.0]))
    run, times, found = histories(scene(vehicle(wheel_radius=R), (yard(),), thrown), 5e-3, 20.0, 5)
    assert run.outcome is Outcome.OFF_ROAD
    assert 0.1 < times[-1] < 20.0
    assert "tipped over" in run.message
    assert "'spmt'" in run.message
    assert np.isfinite(found["spmt.roll"]).all()


def test_a_deck_that_heaves_takes_the_vehicle_along() -> None:
    """A driven body carries the road: the vehicle follows it slowly, as the sum of its weight and inertia says."""
    amplitude, omega = 0.05, 0.5
    rise = Profile(harmonics=(Harmonic(amplitude=amplitude, frequency=omega / (2.0 * np.pi), phase=0.0),))
    barge = RigidBody("barge", 1e6, np.eye(3) * 1e8, motion=Driven(z=rise))
    made = scene(
        vehicle(bogie_mass=0.0, tyre_damping=1.5e4, line_damping=2e4),
        (yard(body="barge"),),
        bodies=(barge, block(velocity=np.array([0.0, 0.0, amplitude * omega]))),
    )
    _, times, found = histories(made, 1e-2, 30.0, 10)
    late = times > 15.0
    expected = amplitude * np.sin(omega * times) / (1.0 - (omega / (2.0 * np.pi * 2.006)) ** 2)
    np.testing.assert_allclose(found["spmt.heave"][late], expected[late], atol=2e-4)
    # what the deck does is work of the drive of the barge
    parts = [found[f"energy.{name}"] for name in ("kinetic", "potential", "elastic", "dissipated")]
    total = np.sum(parts, axis=0) - found["energy.drive_work"] - found["energy.external_work"]
    np.testing.assert_allclose(total, total[0], atol=1e-4 * MASS * G * amplitude)


def test_a_deck_on_a_free_body_carries_what_stands_on_it() -> None:
    """Both fall in step without gravity acting between them: momentum is kept, each by its share of the mass."""
    barge = RigidBody("barge", 4.0e5, np.diag([5e6, 5e7, 5e7]), velocity=np.array([0.0, 0.0, 0.2]))
    deck = yard(body="barge", stations=np.array([-20.0, 20.0]))
    made = scene(
        vehicle(bogie_mass=0.0, tyre_damping=1.5e5, line_damping=2e4), (deck,), bodies=(barge, block())
    )
    _, times, found = histories(made, 5e-3, 6.0, 20)
    momentum = found["momentum.linear"][:, 2] + 573.0e3 * 9.81 * times
    np.testing.assert_allclose(momentum, 4.0e5 * 0.2, rtol=1e-9)
    np.testing.assert_allclose(found["momentum.linear"][:, :2], 0.0, atol=1e-6)
    angular = found["momentum.angular"]
    np.testing.assert_allclose(angular, 0.0, atol=1e-3)


def test_strokes_over_a_kink_are_those_of_a_line_through_the_middles_of_groups() -> None:
    """Middle of the vehicle on a kink of 0.01: every stroke is the road less that line, steeper by W h."""
    phi, ahead = 0.01, 4.2
    kinked = yard(stations=np.array([-30.0, ahead, 60.0]), heights=np.array([0.0, 0.0, (60.0 - ahead) * phi]))
    made = scene(vehicle(travel_speed=0.02), (kinked,))
    _, times, found = histories(made, 1e-2, ahead / 0.02, 100)
    assert times[-1] == pytest.approx(ahead / 0.02)
    x = np.array([3.5, 2.1, 0.7, -0.7, -2.1, -3.5])
    road = phi * np.maximum(x, 0.0)
    front, rear = road[:3].mean(), road[3:].mean()
    stiffness = 12.0 * 2.1**2 * OIL * TYRE / (OIL + TYRE)
    line = 0.5 * (front + rear) + (front - rear) / 4.2 * x / (1.0 - MASS * G * 3.579190751 / stiffness)
    loads = found["spmt.wheel_load"][-1] - found["spmt.wheel_load"][0]
    strokes = found["spmt.stroke_of"][-1] + loads / TYRE
    for side in ([0, 1, 2, 6, 7, 8], [3, 4, 5, 9, 10, 11]):
        np.testing.assert_allclose(strokes[side], road - line, atol=1e-4)


def test_a_cant_unloads_a_side_where_the_compliance_says() -> None:
    """R12 in four groups: a side of it is empty at ``atan(b/h) (1 - W h/K)``, not at ``atan(b/h)``; slowly tilted."""
    lever = MASS * G * 3.579190751 / (12.0 * 0.725**2 * OIL * TYRE / (OIL + TYRE))
    static = np.arctan(0.725 / 3.579190751)
    assert np.degrees(static) == pytest.approx(11.45, abs=5e-3)
    limit = static * (1.0 - lever)
    tilt = Profile(times=np.array([0.0, 60.0]), values=np.array([0.0, 0.97 * limit]))
    body = RigidBody(
        "tilted", 1e6, np.eye(3) * 1e8, motion=Driven(axis=np.array([1.0, 0.0, 0.0]), angle=tilt)
    )
    guide = Guide(name="guide", body_a="tilted", body_b="block")
    transporter = vehicle(bogie_mass=0.0, tyre_damping=1.5e5, line_damping=2e4)
    made = scene(transporter, (yard(body="tilted"),), bodies=(body, block()), joints=(guide,))
    run, _, found = histories(made, 1e-2, 70.0, 100)
    assert run.outcome is Outcome.COMPLETED
    # of the vehicle against the deck, the foot moves by h tan(cant) / (1 - W h / K); small angles within 1 %
    share = found["spmt.least_share"][-1]
    assert share == pytest.approx(0.25 * (1.0 - 0.97), abs=0.25 * 0.015)


ROWS = 1.4 * (np.arange(18) - 8.5)


@pytest.mark.parametrize(
    ("stations", "heights", "largest"),
    [
        ((-60.0, 0.0, 60.0), (0.0, 0.0, 0.6), 3.681 * 0.01),  # a kink of 0.01, wherever the vehicle is on it
        ((-60.0, 0.0, 0.2, 60.0), (0.0, 0.0, 0.05, 0.05), 0.840 * 0.05),  # a step, between two rows
        pytest.param((-60.0, 0.0, 6.0, 60.0), (0.0, 0.0, 0.05, 0.05), 0.572 * 0.05, marks=pytest.mark.slow),
        ((-60.0, 0.0, 10.0, 60.0), (0.0, 0.0, 0.05, 0.05), 0.368 * 0.05),  # over a link of 10 m
        pytest.param((-60.0, 0.0, 12.0, 60.0), (0.0, 0.0, 0.05, 0.05), 0.307 * 0.05, marks=pytest.mark.slow),
    ],
)
def test_strokes_of_eighteen_rows_over_kinks_and_steps(stations, heights, largest) -> None:
    """T11: oil and tyres that hardly give way, centre of mass on the road: the platform goes through mean heights."""
    groups = tuple(
        BogieGroup(
            f"g{front}{side}",
            np.array([(x, side, 0.0) for x in ROWS if (x > 0.0) == front]),
            oil_stiffness=1e10,
        )
        for front in (True, False)
        for side in (-1.0, 1.0)
    )
    road = yard(stations=np.array(stations), heights=np.array(heights))
    transporter = vehicle(groups=groups, tyre_stiffness=1e10, travel_speed=0.2)
    body = block(centre_of_mass=np.zeros(3), position=np.array([-14.0, 0.0, 0.0]))
    _, _, found = histories(scene(transporter, (road,), body=body), 2e-2, 140.0, 100)
    strokes = max(found["spmt.stroke_max"].max(), -found["spmt.stroke_min"].min())
    assert strokes == pytest.approx(largest, abs=1e-4)
    assert strokes == pytest.approx(largest, rel=2e-3)


def test_a_tilt_along_the_worst_direction_takes_a_corner_its_load() -> None:
    """T16: at the angle that is told before the run, 6.55 degrees of R12 in four groups, in a slow tilt test."""
    a, b = 2.1, 0.725
    k = 12.0 * OIL * TYRE / (OIL + TYRE)
    lever = MASS * G * 3.579190751
    leans = np.array([1.0 / (1.0 - lever / (k * a * a)) / a, 1.0 / (1.0 - lever / (k * b * b)) / b])
    limit = vehicle_tipping(scene(vehicle()))["spmt"].compliant
    assert np.tan(limit) == pytest.approx(1.0 / (3.579190751 * np.hypot(*leans)), rel=1e-9)
    down = leans / np.hypot(*leans)
    tilt = Profile(times=np.array([0.0, 60.0]), values=np.array([0.0, 0.97 * limit]))
    axis = np.array([-down[1], down[0], 0.0])
    body = RigidBody("tilted", 1e6, np.eye(3) * 1e8, motion=Driven(axis=axis, angle=tilt))
    guide = Guide(name="guide", body_a="tilted", body_b="block")
    transporter = vehicle(bogie_mass=0.0, tyre_damping=1.5e5, line_damping=2e4)
    made = scene(transporter, (yard(body="tilted"),), bodies=(body, block()), joints=(guide,))
    _, _, found = histories(made, 1e-2, 70.0, 100)
    assert found["spmt.least_share"][-1] == pytest.approx(0.25 * 0.03, abs=0.25 * 0.01)


def test_a_driven_vehicle_follows_its_guide_over_a_bump() -> None:
    """Position of the driven point within 1e-6 m of speed times time; energy balance with the drive."""
    guide = Guide(name="guide", body_a="ground", body_b="block", speed=0.5)
    decks = (yard(), bump(4.5, 2.0, (0.2, 1.5), "smooth"))
    made = scene(vehicle(), decks, body=block(velocity=np.array([0.5, 0.0, 0.0])), joints=(guide,))
    _, times, found = histories(made, 5e-3, 20.0, 20)
    np.testing.assert_allclose(found["guide.travel"], 0.5 * times, atol=1e-6)
    np.testing.assert_allclose(found["block.position"][:, :2] - np.outer(0.5 * times, [1, 0]), 0.0, atol=1e-6)
    assert found["spmt.roll"].max() > 0.01
    names = ("kinetic", "potential", "elastic", "dissipated")
    total = np.sum([found[f"energy.{name}"] for name in names], axis=0) - found["energy.drive_work"]
    np.testing.assert_allclose(total, total[0], atol=1e-3 * np.ptp(found["energy.drive_work"]))


@pytest.mark.parametrize(("stiffness", "step"), [(3e8, 2e-2), (3e10, 2e-3)])
def test_what_is_thrown_up_within_a_step_stops_the_run(stiffness, step) -> None:
    """Hard oil and tyres over an edge of 0.2 m: the vehicle ended 0.3 to 50 m up, with a wrong energy at best."""
    high = Deck(
        name="high", sides=np.array([-5.0, 5.0]), stations=np.array([4.0, 4.0, 30.0]),
        heights=np.array([0.0, 0.2, 0.2]),
    )  # fmt: skip
    low = yard(stations=np.array([-30.0, 4.0]))
    transporter = vehicle(
        groups=groups_of(4, oil=3.0 * stiffness), wheel_radius=R, tyre_stiffness=stiffness, travel_speed=0.5
    )
    run, _, found = histories(scene(transporter, (low, high)), step, 17.0)
    assert run.outcome is Outcome.STEP_TOO_LARGE
    assert "'spmt': the load of bogie " in run.message
    assert "times that at rest within a step; try a smaller step, softer oil or tyres" in run.message
    assert found["spmt.heave"].max() < 0.25
