from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from heavylift.numerics.outcome import InputError
from heavylift.solver.forces.point import PointForce
from heavylift.solver.interface import (
    Forces,
    Workspace,
    add_forces,
    record_forces,
)
from heavylift.solver.joints.packing import MarkerBook
from heavylift.solver.scene.channels import ChannelBook
from heavylift.solver.scene.descriptions import check_object
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.scene.wind_loads import (
    CurrentField,
    CurrentProfile,
    DragElement,
    FluctuationRecord,
    Veering,
    WindField,
    fluctuation_record,
    fluctuation_records,
)
from heavylift.solver.simulation import Simulation
from heavylift.solver.water.wind.coefficients import CoefficientLoad
from heavylift.solver.water.wind.packing import add_fluid_channels, fluid_markers, pack_fluid_loads

ANGLES = np.radians(np.arange(-180.0, 180.0, 20.0))
COEFFICIENTS = np.column_stack(
    [
        np.cos(ANGLES) + 0.1,
        0.9 * np.sin(ANGLES) + 0.05 * np.cos(3.0 * ANGLES),
        0.08 * np.sin(2.0 * ANGLES) - 0.01,
    ]
)
AREAS = np.array([400.0, 1500.0, 1500.0 * 90.0])


def act(forces, time, work, row):
    add_forces(forces, time, work)
    record_forces(forces, time, work, row)


class Body:
    """A rigid body somewhere in the air: its points and directions with their rates, and what forces on them do."""

    def __init__(self, rng, *, tilt=0.4, height=30.0, speed=3.0):
        turn = Rotation.from_euler("zyx", [rng.uniform(-np.pi, np.pi), *rng.uniform(-tilt, tilt, 2)])
        self.R = turn.as_matrix()
        self.position = np.array([*rng.uniform(-50.0, 50.0, 2), height])
        self.velocity, self.spin = rng.uniform(-speed, speed, 3), rng.uniform(-0.2, 0.2, 3)

    def place(self, point):
        arm = self.R @ point
        return self.position + arm, self.velocity + np.cross(self.spin, arm)

    def turn(self, axis):
        direction = self.R @ axis
        return direction, np.cross(self.spin, direction)


def apply(body, fields, loads, time=0.0, **water):
    """Forces on the markers of each load, their power, and the record by channel."""
    book = MarkerBook()
    markers = fluid_markers(book, loads)
    outputs = ChannelBook()
    columns = add_fluid_channels(outputs, fields, loads)
    for one in fields:
        check_object(one)
    kind = pack_fluid_loads(fields, loads, markers, columns, **water)
    work = Workspace.empty(6, book.count)
    for load, (point, heading) in zip(loads, markers, strict=True):
        for marker, vectors in ((point, body.place(load.point)), (heading, body.turn(load.axis))):
            if marker >= 0:
                work.markers[marker].point[:], work.markers[marker].velocity[:] = vectors
    row = np.full(outputs.width, np.nan)
    act((kind,), time, work, row)
    forces = work.markers["force"]
    power = float(np.sum(forces * work.markers["velocity"]))
    record = {
        channel.name: row[channel.column : channel.column + len(channel.components)]
        for channel in outputs.channels
    }
    nothing = np.zeros(3)
    return [(forces[p], forces[h] if h >= 0 else nothing) for p, h in markers], power, record


def columns(values):
    return dict(zip(("cx", "cy", "cn"), np.transpose(values), strict=True))


def hull(**changes):
    return replace(
        CoefficientLoad(
            name="hull",
            body="barge",
            point=np.array([2.0, -1.0, 5.0]),
            angles=ANGLES,
            **columns(COEFFICIENTS),
            area_x=400.0,
            area_y=1500.0,
            length=90.0,
        ),
        **changes,
    )


def element(**changes):
    return replace(
        DragElement(name="jib", body="barge", point=np.array([10.0, 3.0, 40.0]), area=25.0, coefficient=1.3),
        **changes,
    )


def current(depths=(0.0, 5.0), speeds=(1.0, 0.5)):
    return CurrentField(speed=CurrentProfile(np.array(depths), np.array(speeds)))


def log_wind(z, speed):
    return speed * (1.0 + 0.0573 * np.sqrt(1.0 + 0.15 * speed) * np.log(z / 10.0))


@pytest.mark.parametrize("seed", range(10))
def test_coefficient_loads_against_plain_numpy(seed):
    rng = np.random.default_rng(seed)
    body, going = Body(rng), rng.uniform(-np.pi, np.pi)
    (pair,), _, record = apply(body, [WindField(speed=14.0, direction=going)], [hull()])
    where, velocity = body.place(hull().point)
    flow = log_wind(where[2], 14.0) * np.array([np.cos(going), np.sin(going)]) - velocity[:2]
    ahead = (body.R @ [1.0, 0.0, 0.0])[:2]
    heading = np.arctan2(ahead[1], ahead[0])
    attack = np.arctan2(flow[1], flow[0]) - heading
    spline = CubicSpline(
        np.append(ANGLES, np.pi),
        np.vstack([COEFFICIENTS, COEFFICIENTS[0]]),
        bc_type="periodic",
        extrapolate="periodic",
    )
    x, y, moment = 0.5 * 1.225 * flow @ flow * spline(attack) * AREAS
    c, s = np.cos(heading), np.sin(heading)
    np.testing.assert_allclose(pair[0], [c * x - s * y, s * x + c * y, 0.0], rtol=1e-11, atol=1e-6)
    # couple: d x f about the vertical is the moment
    direction = body.R @ [1.0, 0.0, 0.0]
    assert np.cross(direction, pair[1])[2] == pytest.approx(moment, rel=1e-11)
    np.testing.assert_allclose(record["hull.force"], pair[0])
    assert record["hull.yaw_moment"][0] == pytest.approx(moment, rel=1e-11)


@pytest.mark.parametrize("seed", range(5))
def test_the_power_of_the_yaw_moment_is_moment_times_yaw_rate(seed):
    rng = np.random.default_rng(seed)
    body = Body(rng, tilt=1.0)
    (pair,), _, record = apply(body, [WindField(speed=20.0)], [hull()])
    direction, rate = body.turn(np.array([1.0, 0.0, 0.0]))
    yaw_rate = (direction[0] * rate[1] - direction[1] * rate[0]) / (direction[0] ** 2 + direction[1] ** 2)
    assert pair[1] @ rate == pytest.approx(record["hull.yaw_moment"][0] * yaw_rate, rel=1e-12)


def test_the_couple_of_a_heading_that_points_up_stays_finite():
    body = Body(np.random.default_rng(0))
    body.R = Rotation.from_euler("y", -90.0, degrees=True).as_matrix()
    (pair,), _, record = apply(body, [WindField(speed=20.0)], [hull()])
    assert np.all(np.abs(pair[1]) <= 10.0 * abs(record["hull.yaw_moment"][0]))


@pytest.mark.parametrize("seed", range(5))
def test_a_symmetric_table_is_its_mirror_image(seed):
    rng = np.random.default_rng(seed)
    angles = np.linspace(0.0, np.pi, 10)
    table = np.column_stack(
        [np.cos(angles), np.sin(angles) * (1.1 + 0.2 * angles), 0.1 * np.sin(2.0 * angles)]
    )
    load = hull(angles=angles, **columns(table), symmetric=True, point=np.zeros(3))
    body, going = Body(rng, tilt=0.0), rng.uniform(0.0, np.pi)
    body.R, body.velocity, body.spin = np.eye(3), np.zeros(3), np.zeros(3)
    (port, turn), (starboard, back) = (
        apply(body, [WindField(speed=9.0, direction=angle)], [load])[0][0] for angle in (going, -going)
    )
    np.testing.assert_allclose(starboard, port * [1.0, -1.0, 1.0], rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(back[1], -turn[1], rtol=1e-12)
    whole = np.vstack([table[:0:-1] * [1.0, -1.0, -1.0], table])
    whole[[0, -1], 1:] = 0.0
    full = hull(
        angles=np.concatenate([-angles[:0:-1], angles]),
        **columns(whole),
        point=np.zeros(3),
    )
    np.testing.assert_allclose(
        apply(body, [WindField(speed=9.0, direction=going)], [full])[0][0][0], port, rtol=1e-12
    )


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("vertical", [False, True])
def test_drag_elements_against_plain_numpy(seed, vertical):
    rng = np.random.default_rng(seed)
    body, going = Body(rng), rng.uniform(-np.pi, np.pi)
    wind = WindField(speed=14.0, direction=going, profile="power")
    loads = [element(vertical=vertical), element(name="house", area=(30.0, 70.0, 50.0), vertical=vertical)]
    forces, _, record = apply(body, [wind], loads)
    where, velocity = body.place(loads[0].point)
    flow = 14.0 * (where[2] / 10.0) ** 0.11 * np.array([np.cos(going), np.sin(going), 0.0]) - velocity
    if not vertical:
        flow[2] = 0.0
    speed = np.linalg.norm(flow)
    np.testing.assert_allclose(forces[0][0], 0.5 * 1.225 * 1.3 * 25.0 * speed * flow, rtol=1e-12)
    ahead = (body.R @ [1.0, 0.0, 0.0]) * [1.0, 1.0, 0.0]
    ahead /= np.linalg.norm(ahead)
    along = abs(flow @ ahead), abs(flow @ np.cross([0.0, 0.0, 1.0], ahead)), abs(flow[2])
    area = np.array(along) / speed @ [30.0, 70.0, 50.0]  # of the shadow of a box
    np.testing.assert_allclose(forces[1][0], 0.5 * 1.225 * 1.3 * area * speed * flow, rtol=1e-12)
    np.testing.assert_allclose(record["house.force"], forces[1][0])


def test_a_body_that_moves_with_the_wind_feels_nothing_and_any_other_one_is_carried_along():
    rng = np.random.default_rng(4)
    wind = WindField(speed=11.0, direction=0.7, profile="uniform")
    velocity = 11.0 * np.array([np.cos(0.7), np.sin(0.7), 0.0])
    loads = [hull(), element(vertical=True), element(area=(3.0, 4.0, 5.0), vertical=True)]
    body = Body(rng)
    body.velocity, body.spin = velocity, np.zeros(3)
    for pair in apply(body, [wind], loads)[0]:
        np.testing.assert_allclose(pair, 0.0, atol=1e-9)
    for _ in range(20):
        body = Body(rng, speed=30.0)
        body.spin = np.zeros(3)
        power = apply(body, [wind], loads[1:])[1]
        work_of_wind = sum(pair[0] @ velocity for pair in apply(body, [wind], loads[1:])[0])
        assert power <= work_of_wind  # the rest heats the air
    body.velocity = np.array([0.0, 0.0, 0.0])
    assert apply(body, [replace(wind, speed=0.0)], loads[1:])[1] == 0.0
    body.velocity = np.array([1.0, -2.0, 0.5])
    assert apply(body, [replace(wind, speed=0.0)], loads[1:])[1] < 0.0


def speed_at(wind, time=0.0, **water):
    body = Body(np.random.default_rng(0))
    record = apply(body, [wind], [], time, **water)[2]
    return record[f"{wind.name}.speed"][0], record[f"{wind.name}.direction"][0]


def force_at(wind, height, **water):
    """Speed at a height, from the force on an element at rest."""
    body = Body(np.random.default_rng(0), height=height)
    body.velocity, body.spin = np.zeros(3), np.zeros(3)
    fluid = element(point=np.zeros(3), area=1.0, coefficient=1.0, fluid=wind.name)
    force = apply(body, [wind], [fluid], **water)[0][0][0]
    density = wind.density if isinstance(wind, WindField) else water.get("water_density", 1025.0)
    return np.sqrt(np.linalg.norm(force) / (0.5 * density))


def test_profiles_and_gusts_of_iso_19901_1():
    # table of the standard's formulae for a one-hour mean of 10 m/s at 10, 50 and 100 m
    log, power = (10.0, 11.4581, 12.0861), (10.0, 11.9368, 12.8825)
    ten_minutes, three_seconds = (1.06303, 1.04424, 1.03798), (1.24941, 1.17504, 1.15029)
    for i, z in enumerate((10.0, 50.0, 100.0)):
        assert force_at(WindField(speed=10.0), z) == pytest.approx(log[i], rel=1e-5)
        assert force_at(WindField(speed=10.0, profile="power"), z) == pytest.approx(power[i], rel=1e-5)
        assert force_at(WindField(speed=10.0, profile="uniform"), z) == pytest.approx(10.0, rel=1e-12)
        gust = force_at(WindField(speed=10.0, gust=3.0), z)
        assert gust == pytest.approx(log[i] * three_seconds[i], rel=2e-5)
        mean = force_at(WindField(speed=10.0 * ten_minutes[0], averaging_time=600.0), z)
        assert mean == pytest.approx(log[i], rel=1e-5)
    assert force_at(WindField(speed=10.0, profile="uniform", gust=3.0), 50.0) == pytest.approx(
        12.4941, rel=1e-5
    )
    assert force_at(WindField(speed=10.0), 17.0, level=7.0) == pytest.approx(10.0, rel=1e-12)


def test_wind_acts_above_the_water_and_current_below():
    profile = CurrentProfile(np.array([0.0, 10.0, 20.0]), np.array([1.2, 0.8, 0.2]))
    current = CurrentField(speed=profile, direction=np.pi)
    assert force_at(WindField(speed=10.0), -1e-9) == force_at(current, 1e-9) == 0.0
    for depth, speed in ((0.5, 1.18), (5.0, 1.0), (15.0, 0.5), (40.0, 0.2)):
        assert force_at(current, -depth) == pytest.approx(speed, rel=1e-12)
        assert force_at(current, 3.0 - depth, level=3.0, water_density=1000.0) == pytest.approx(
            speed, rel=1e-12
        )
    assert force_at(CurrentField(speed=0.7), -3.0) == pytest.approx(0.7, rel=1e-12)


def test_of_a_piece_that_the_water_cuts_each_side_has_its_part():
    body = Body(np.random.default_rng(0), height=1.0)
    body.velocity, body.spin = np.zeros(3), np.zeros(3)
    column = element(point=np.zeros(3), area=12.0, coefficient=1.0, extent=6.0)
    fields = [
        WindField(speed=10.0),
        CurrentField(speed=CurrentProfile(np.array([0.0, 10.0]), np.array([1.0, 0.0]))),
    ]
    (air, _), (water, _) = apply(body, fields, [column, replace(column, name="wet", fluid="current")])[0]
    assert air[0] == pytest.approx(0.5 * 1.225 * 8.0 * log_wind(2.0, 10.0) ** 2, rel=1e-12)
    assert water[0] == pytest.approx(0.5 * 1025.0 * 4.0 * 0.9**2, rel=1e-12)
    body.position[2] = 3.0  # just out of the water
    assert np.all(apply(body, fields, [replace(column, fluid="current")])[0][0][0] == 0.0)


def test_fluctuations_follow_their_record_directions_their_table_and_all_of_it_the_ramp():
    smooth = 0.1 * np.arange(200)
    wind = WindField(
        speed=10.0,
        direction=Veering(np.array([0.0, 10.0]), np.array([0.1, 0.5])),
        fluctuation=FluctuationRecord(0.1, np.sin(smooth)),
    )
    for time in (0.0, 0.05, 3.3, 7.777, 12.0):
        speed, direction = speed_at(wind, time)
        assert speed == pytest.approx(10.0 + np.sin(time), abs=2e-5)  # cubics through values 0.1 s apart
        assert direction == pytest.approx(0.1 + 0.04 * min(time, 10.0), rel=1e-12)
    assert speed_at(wind, 100.0)[0] == pytest.approx(10.0 + np.sin(smooth[-1]), rel=1e-12)
    for time, part in ((0.0, 0.0), (2.0, 0.25), (3.0, 0.5), (6.0, 1.0), (7.0, 1.0)):
        assert speed_at(wind, time, ramp=6.0)[0] == pytest.approx(part * (10.0 + np.sin(time)), abs=1e-4)


def test_a_record_of_the_spectrum_is_interpolated_between_its_values():
    record = fluctuation_record(10.0, 60.0, seed=5)
    fine = fluctuation_record(10.0, 60.0, seed=5, step=0.025)
    wind = WindField(speed=10.0, fluctuation=record)
    found = [speed_at(wind, 0.025 * i)[0] - 10.0 for i in range(400, 460)]
    assert np.max(np.abs(found - fine.values[400:460])) < 1e-3 * 0.8714
    assert record.duration >= 60.0
    assert record.values[600] == pytest.approx(fine.values[2400], abs=1e-9)
    assert np.array_equal(record.values, fluctuation_record(10.0, 60.0, seed=5).values)


def test_two_winds_with_coherent_records_act_on_their_own_loads():
    points = np.array([[0.0, 0.0, 10.0], [0.0, 30.0, 10.0]])
    records = fluctuation_records(10.0, 30.0, points, seed=2)
    winds = [WindField(name=n, speed=10.0, fluctuation=r) for n, r in zip("ab", records, strict=True)]
    body = Body(np.random.default_rng(0), height=10.0)
    body.velocity, body.spin = np.zeros(3), np.zeros(3)
    pieces = [element(name=f"at {n}", point=np.zeros(3), area=1.0, coefficient=1.0, fluid=n) for n in "ab"]
    for (force, _), record in zip(apply(body, winds, pieces, 7.0)[0], records, strict=True):
        assert force[0] == pytest.approx(0.5 * 1.225 * (10.0 + record.values[70]) ** 2, rel=1e-9)
    assert not np.allclose(records[0].values, records[1].values)


def test_records_that_miss_their_highest_frequency_are_refused():
    with pytest.raises(InputError, match=r"step 0\.5 s; expected at most 0\.4 s"):
        fluctuation_record(10.0, 60.0, seed=1, step=0.5)
    with pytest.raises(InputError, match="duration -1"):
        fluctuation_record(10.0, -1.0, seed=1)


def test_loads_of_one_name_are_recorded_as_their_sum():
    body = Body(np.random.default_rng(2))
    loads = [element(name="deck"), element(name="deck", area=7.0), hull(name="deck")]
    pairs, _, record = apply(body, [WindField(speed=10.0)], loads)
    np.testing.assert_allclose(record["deck.force"], sum(pair[0] for pair in pairs), rtol=1e-12)
    book = ChannelBook()
    add_fluid_channels(book, [], loads)
    assert [channel.name for channel in book.channels] == ["deck.force", "deck.yaw_moment"]


@pytest.mark.parametrize(
    ("fields", "loads", "message"),
    [
        ([WindField(speed=90.0)], [], r'wind: speed: 90 m/s.*in knots "90 knot" is 46\.3 m/s'),
        ([CurrentField(speed=15.0)], [], "current: speed: 15 m/s.*knots"),
        ([current(depths=[5.0, 0.0])], [], "current: speed.depths: .*increasing depths"),
        ([current(depths=[-5.0, 0.0])], [], "current: speed.depths: -5.0 is too small"),
        ([current(speeds=[1.0, 20.0])], [], "current: speed.speeds: 20 m/s.*in knots"),
        ([current(speeds=[1.0])], [], "current: speed.speeds: 2 depths and 1 speeds"),
        (
            [WindField(speed=9.0, direction=223.0)],
            [],
            'wind: direction: 223 rad is more than a turn.*"223 deg"',
        ),
        ([WindField(speed=9.0, averaging_time=7200.0)], [], "wind: averaging_time: 7200 s.*up to an hour"),
        ([WindField(speed=9.0, exponent=0.2)], [], "wind: exponent: .*profile 'power'"),
        ([WindField(speed=9.0, profile="linear")], [], "log, power or uniform"),
        (
            [WindField(speed=9.0, gust=3.0, fluctuation=FluctuationRecord(0.1, np.zeros(9)))],
            [],
            "one of them",
        ),
        ([WindField(speed=9.0), WindField(speed=8.0)], [], "two fields named 'wind'"),
        ([], [element()], "there is no field 'wind'"),
        ([WindField(speed=9.0)], [hull(angles=np.degrees(ANGLES))], "are these degrees"),
        (
            [WindField(speed=9.0)],
            [hull(angles=ANGLES[:9], **columns(COEFFICIENTS[:9]))],
            "symmetric = true",
        ),
        ([WindField(speed=9.0)], [hull(symmetric=True)], "0 to pi for a symmetric body"),
        (
            [WindField(speed=9.0)],
            [hull(symmetric=True, angles=np.linspace(0.0, np.pi, 5), **columns(np.ones((5, 3))))],
            "C_y or C_n of 1 at 0 or pi",
        ),
        (
            [WindField(speed=9.0)],
            [hull(angles=np.linspace(0.0, 2.0 * np.pi, 5), **columns(np.eye(5)[:, :3]))],
            "the same numbers in the first and the last row",
        ),
        ([WindField(speed=9.0)], [hull(area_x=-4.0)], "hull: area_x: -4 m2"),
        ([WindField(speed=9.0)], [element(area=(1.0, -2.0, 0.0))], "jib: area"),
        ([WindField(speed=9.0)], [element(extent=-1.0)], "jib: extent"),
        ([WindField(speed=9.0)], [hull(axis=np.zeros(3))], "a direction that is not zero"),
    ],
)
def test_bad_input_is_refused(fields, loads, message):
    with pytest.raises(InputError, match=message):
        apply(Body(np.random.default_rng(0)), fields, loads)


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("integrator", ["dele2", "accurate"])
def test_a_free_body_drifts_off_as_the_closed_form_says(integrator):
    """``m w' = -rho C A w |w| / 2`` of the wind relative to the body: ``w = w0 / (1 + k w0 t)``."""
    mass, area, speed = 800.0, 10.0, 15.0
    body = RigidBody("box", mass, 50.0 * np.eye(3), position=np.array([0.0, 0.0, 10.0]))
    follow = PointForce("none", "box", np.zeros(3), np.zeros(1), np.zeros((1, 3)), frame="body")
    simulation = Simulation(Scene(bodies=(body,), forces=(follow,)), 0.05, integrator)
    layout = simulation._layout
    loads = [element(body="box", point=np.zeros(3), area=area, coefficient=1.0)]
    fields = [WindField(speed=speed)]
    # the scene has no columns for them: they write where the totals stand, which are written last
    before = [one for one in layout.channels if not one.name.startswith(("energy.", "momentum."))]
    columns = add_fluid_channels(ChannelBook(before), fields, loads)
    kind = pack_fluid_loads(fields, loads, [(0, 1)], columns)
    simulation._layout = replace(layout, forces=Forces((*layout.forces, kind)))
    times, records = simulation.advance(400)
    k = 0.5 * 1.225 * area / mass
    column = next(c.column for c in simulation.channels if c.name == "box.velocity")
    expected = speed - speed / (1.0 + k * speed * times)
    np.testing.assert_allclose(records[:, column], expected, atol=2e-4 * speed)
    at = next(c.column for c in simulation.channels if c.name == "box.position")
    travelled = speed * times - np.log(1.0 + k * speed * times) / k
    np.testing.assert_allclose(records[:, at], travelled, atol=2e-3)
