"""A transporter over a bump against an independent integration, and what a step keeps."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from vehicles import (
    BOGIE,
    DATA,
    HEIGHT,
    INERTIA,
    MASS,
    OIL,
    TYRE,
    G,
    block,
    bump,
    groups_of,
    histories,
    scene,
    vehicle,
    yard,
)

from heavylift.contours.splines.neutral import neutral_surface
from heavylift.numerics.outcome import Outcome
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.forces.spring import JointSpring
from heavylift.solver.joints.guide import Guide
from heavylift.solver.joints.slider_hinge import SliderHinge
from heavylift.solver.scene.connections import JointFrame, RopePoint, axes_about
from heavylift.solver.scene.contacts import CircleShape, Contact, Contour, LinearLaw
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.transport import BogieGroup
from heavylift.solver.transport.decks import Deck

SIDES = {"both": (-5.0, 5.0), "left": (0.2, 1.5)}


@pytest.mark.parametrize("side", ["both", "left"])
def test_histories_of_a_bump_at_1_m_per_s_are_those_of_an_independent_integration(side) -> None:
    """Within 0.6 % of their range; the bump is a tenth as high, as the reference is linear in the tilts.

    The reference has bogies of 108 kg, which ring at 26 Hz on their tyres.
    """
    reference = np.genfromtxt(
        DATA / f"bump_r12_dynamic_{side}.csv", delimiter=",", names=True, skip_header=1
    )[1:]
    made = scene(
        vehicle(tyre_damping=1.5e4, line_damping=2.0e4, travel_speed=1.0),
        (yard(), bump(4.5, 2.0, SIDES[side], height=0.01)),
    )
    run, times, found = histories(made, 5e-3, reference["t"][-1], 16)
    assert run.outcome is Outcome.COMPLETED
    np.testing.assert_allclose(times, reference["t"], atol=1e-12)
    mine = {
        "heave": found["spmt.heave"],
        "roll": found["spmt.roll"],
        "pitch": found["spmt.pitch"],
        "load_first_left": found["spmt.wheel_load"][:, 0],
        "load_last_right": found["spmt.wheel_load"][:, 11],
        "stroke_first_left": found["spmt.stroke_of"][:, 0],
    }
    rest = (MASS / 12 + BOGIE) * G
    for name, history in mine.items():
        start = rest if name.startswith("load") else 0.0
        expected = 0.1 * (reference[name] - start)
        if np.ptp(expected) > 1e-9:  # both sides: no roll
            np.testing.assert_allclose(history - start, expected, atol=6e-3 * np.ptp(expected), err_msg=name)


def test_forces_are_of_second_order() -> None:
    """Differences of halved steps fall by four."""
    ends = []
    for step in (2e-2, 1e-2, 5e-3):
        made = scene(
            vehicle(tyre_damping=1.5e4, line_damping=2.0e4, travel_speed=1.0),
            (yard(), bump(4.5, 2.0, SIDES["left"], "smooth")),
        )
        _, _, found = histories(made, step, 4.0, round(0.1 / step))
        ends.append(np.column_stack([found["spmt.pitch"], found["spmt.roll"]]))
    first, second = (np.abs(a - b).max() for a, b in itertools.pairwise(ends))
    assert 3.0 < first / second < 5.5


def test_work_of_the_drives_is_what_the_body_and_its_oil_have() -> None:
    """Energy balance without dampers; the drives do about 10 kJ. Loads of a group are equal."""
    made = scene(vehicle(travel_speed=1.0), (yard(), bump(4.5, 2.0, SIDES["left"])))
    _, _, found = histories(made, 5e-3, 10.0, 20)
    names = ("kinetic", "potential", "elastic")
    total = sum(found[f"energy.{name}"] for name in names) - found["energy.drive_work"]
    work = np.ptp(found["energy.drive_work"])
    assert work > 1e3
    np.testing.assert_allclose(total, total[0], atol=1e-6 * work)
    np.testing.assert_array_equal(found["energy.dissipated"], 0.0)
    loads = found["spmt.wheel_load"].reshape(len(total), 4, 3)
    np.testing.assert_allclose(loads, loads[:, :, :1] + np.zeros(3), rtol=1e-12)


def test_dampers_take_what_the_drives_do() -> None:
    """With pipes and rubber: dissipation grows, and the balance closes with the square of the step."""
    misses = []
    for step in (1e-2, 5e-3):
        made = scene(
            vehicle(tyre_damping=1.5e4, line_damping=2.0e4, travel_speed=1.0),
            (yard(), bump(4.5, 2.0, SIDES["left"], "smooth")),
        )
        _, _, found = histories(made, step, 10.0, round(0.1 / step))
        parts = [found[f"energy.{name}"] for name in ("kinetic", "potential", "elastic", "dissipated")]
        total = np.sum(parts, axis=0) - found["energy.drive_work"]
        assert np.all(np.diff(found["energy.dissipated"]) >= 0.0)
        misses.append(np.ptp(total) / found["energy.dissipated"][-1])
    assert misses[1] < 0.02
    assert misses[0] / misses[1] > 3.0


@pytest.mark.parametrize("count", [3, 4])
@pytest.mark.parametrize("side", ["both", "left"])
def test_a_slow_passage_is_quasi_static(count, side) -> None:
    """Rows of `bump_quasistatic.csv`: heave, tilts and strokes within 0.5 %, loads within 1 % of their change.

    A bump of 2.8 m whose curvature begins gently, at 20 mm/s: at 69 mm/s inertia is 3 % of the change of loads with
    both sides on the bump. The extremes are those of one line on top, whatever the shape.
    """
    rows = np.genfromtxt(
        DATA / "bump_quasistatic.csv", delimiter=",", names=True, skip_header=1, dtype=None, encoding=None
    )
    (row,) = (
        r for r in rows if (r["vehicle"], r["groups"], r["side"], r["bump"]) == ("R12", count, side, "1.2")
    )
    made = scene(
        vehicle(groups=groups_of(count), travel_speed=0.02), (yard(), bump(3.6, 2.8, SIDES[side], "smooth"))
    )
    _, _, found = histories(made, 2e-2, 486.0, 10)
    degrees = 180.0 / np.pi
    for name, value in (
        ("heave_max_m", found["spmt.heave"].max()),
        ("pitch_min_deg", degrees * found["spmt.pitch"].min()),
        ("pitch_max_deg", degrees * found["spmt.pitch"].max()),
        ("stroke_min_m", found["spmt.stroke_min"].min()),
        ("stroke_max_m", found["spmt.stroke_max"].max()),
    ):
        assert value == pytest.approx(row[name], rel=5e-3), name
    if side == "left":
        assert degrees * found["spmt.roll"].max() == pytest.approx(row["roll_max_deg"], rel=5e-3)
    static = 14.5247
    for name, channel in (("load_min_t", "spmt.load_min"), ("load_max_t", "spmt.load_max")):
        value = (found[channel].min() if "min" in name else found[channel].max()) / 9810.0
        assert value - static == pytest.approx(row[name] - static, rel=1e-2), name


def _with_inertia(groups, side: str, speed: float, start: float, duration: float) -> dict[str, np.ndarray]:
    """Heave, roll, pitch, strokes and loads over static ones of a body on groups, linear in all of them, by SciPy.

    The middle of group k is z_k - (heave + y_k roll - x_k pitch) off the road, each of its n bogies bears that by the
    stiffness of oil and tyre in a row, and the weight W at the height h turns the body by W h roll and W h pitch.
    """
    places = np.vstack([group.bogies for group in groups])
    owner = np.repeat(np.arange(len(groups)), [len(group.bogies) for group in groups])
    mean = np.array([owner == k for k in range(len(groups))]) / np.bincount(owner)[:, None]
    shapes = np.column_stack([np.ones(len(places)), places[:, 1], -places[:, 0]])
    stiffness = OIL * TYRE / (OIL + TYRE)
    masses = np.array([MASS, *INERTIA[:2]])
    turning = MASS * G * HEIGHT * np.array([0.0, 1.0, 1.0])
    raised = (places[:, 1] > 0.0) | (side == "both")

    def road(t: float) -> np.ndarray:
        share = np.clip((places[:, 0] + speed * t - start) / 2.8, 0.0, 1.0)
        return 0.1 * np.sin(np.pi * share) ** 4 * raised

    def loads(t: float, q: np.ndarray) -> np.ndarray:
        return stiffness * (mean @ (road(t) - shapes @ q))[owner]

    def rate(t: float, state: np.ndarray) -> np.ndarray:
        q, v = state[:3], state[3:]
        return np.concatenate([v, (shapes.T @ loads(t, q) + turning * q) / masses])

    times = np.linspace(0.0, duration, 2001)
    solved = solve_ivp(
        rate, (0.0, duration), np.zeros(6), "DOP853", times, rtol=1e-7, atol=1e-9, max_step=0.5
    )
    q = solved.y[:3].T
    carried = np.array([loads(t, x) for t, x in zip(times, q, strict=True)])
    under = np.array([road(t) for t in times])
    return {"q": q, "strokes": under - carried / TYRE - q @ shapes.T, "loads": carried}


@pytest.mark.parametrize("count", [3, 4])
@pytest.mark.parametrize("side", ["both", "left"])
def test_a_passage_at_a_quarter_of_a_kilometre_an_hour_is_quasi_static_but_for_inertia(count, side) -> None:
    """T5 at 69.4 mm/s in steps of 5 ms: tilts and strokes 0.5 %, loads 1 % of their change.

    The rows of `bump_quasistatic.csv` have no inertia. By an independent integration it takes heave, pitch and strokes
    0.01 to 0.2 % off them, on three groups a roll of 0.3 Hz 0.8 %, and loads 0.2 to 2.7 % of their change: what is
    within a tolerance of the rows is compared with these, all with the integration.
    """
    rows = np.genfromtxt(
        DATA / "bump_quasistatic.csv", delimiter=",", names=True, skip_header=1, dtype=None, encoding=None
    )
    (row,) = (
        r for r in rows if (r["vehicle"], r["groups"], r["side"], r["bump"]) == ("R12", count, side, "1.2")
    )
    speed, start, duration = 0.0694, 3.6, 145.0
    groups = groups_of(count)
    made = scene(
        vehicle(groups=groups, travel_speed=speed), (yard(), bump(start, 2.8, SIDES[side], "smooth"))
    )
    _, _, found = histories(made, 5e-3, duration, 10)
    moving = _with_inertia(groups, side, speed, start, duration)
    heave, roll, pitch = moving["q"].T
    degrees, static = 180.0 / np.pi, 14.5247
    table = [
        ("heave_max_m", 0.0, found["spmt.heave"].max(), heave.max()),
        ("pitch_min_deg", 0.0, degrees * found["spmt.pitch"].min(), degrees * pitch.min()),
        ("pitch_max_deg", 0.0, degrees * found["spmt.pitch"].max(), degrees * pitch.max()),
        ("stroke_min_m", 0.0, found["spmt.stroke_min"].min(), moving["strokes"].min()),
        ("stroke_max_m", 0.0, found["spmt.stroke_max"].max(), moving["strokes"].max()),
        (
            "load_min_t",
            static,
            found["spmt.load_min"].min() / 9810.0,
            static + moving["loads"].min() / 9810.0,
        ),
        (
            "load_max_t",
            static,
            found["spmt.load_max"].max() / 9810.0,
            static + moving["loads"].max() / 9810.0,
        ),
    ]
    if side == "left":
        table.append(("roll_max_deg", 0.0, degrees * found["spmt.roll"].max(), degrees * roll.max()))
    compared = 0
    for name, rest, value, with_inertia in table:
        part = 1e-2 if name.startswith("load") else 5e-3
        assert value - rest == pytest.approx(with_inertia - rest, rel=part), name
        if abs((with_inertia - row[name]) / (row[name] - rest)) < 0.8 * part:
            compared += 1
            assert value - rest == pytest.approx(row[name] - rest, rel=part), name
    assert compared == {"both": 5, "left": 5 if count == 3 else 8}[side]


@pytest.mark.slow
@pytest.mark.parametrize("count", [3, 4])
@pytest.mark.parametrize("obstacle", ["ramp10", "step", "cos2"])
def test_two_transporters_side_by_side_pass_slowly(count, obstacle) -> None:
    """The other rows of `bump_quasistatic.csv`: 300 t on R24, ramps of 10 degrees, a step, a bump; as above.

    At 5 mm/s, as edges begin at once, with tyres that let no ringing last.
    """
    rows = np.genfromtxt(
        DATA / "bump_quasistatic.csv", delimiter=",", names=True, skip_header=1, dtype=None, encoding=None
    )
    (row,) = (r for r in rows if (r["vehicle"], r["groups"], r["bump"]) == ("R24", count, obstacle))
    lines = {"front": (3.5, 2.1, 0.7), "rear": (-0.7, -2.1, -3.5)}
    trains = {"left": (3.725, 2.275), "right": (-2.275, -3.725)}
    both = (*trains["left"], *trains["right"])
    places = [("front", both)] if count == 3 else [("front", trains["left"]), ("front", trains["right"])]
    places += [("rear", trains["left"]), ("rear", trains["right"])]
    groups = tuple(
        BogieGroup(
            f"group_{i}", np.array([(x, y, 0.0) for x in lines[end] for y in sides]), oil_stiffness=OIL
        )
        for i, (end, sides) in enumerate(places)
    )
    body = block(
        mass=2.0 * MASS,
        centre_of_mass=np.array([0.0, 0.0, 5.746820809]),
        inertia=np.diag([6706311.503, 14016791.503, 1.5e7]),
    )
    across = np.array([-5.0, 5.0])
    run_up = 0.1 / np.tan(np.radians(10.0))
    corners = {"ramp10": [0.0, run_up, run_up + 1.0, 2.0 * run_up + 1.0], "step": [0.0, 0.0, 1.0, 1.0]}
    if obstacle == "cos2":
        over = bump(4.5, 2.0, (-5.0, 5.0))
    else:
        stations = 4.5 + np.array([-1.0, *corners[obstacle], 4.0])
        heights = np.array([0.0, 0.0, 0.1, 0.1, 0.0, 0.0])
        over = Deck(name="over", sides=across, stations=stations, heights=heights)
    made = scene(
        vehicle(
            groups=groups,
            travel_speed=0.005,
            tyre_damping=1.5e5,
            wheel_radius=0.0 if obstacle == "cos2" else 0.37,
        ),
        (yard(), over),
        body,
    )
    _, _, found = histories(made, 4e-2, 2400.0, 25)
    degrees = 180.0 / np.pi
    for name, value in (
        ("heave_max_m", found["spmt.heave"].max()),
        ("pitch_min_deg", degrees * found["spmt.pitch"].min()),
        ("pitch_max_deg", degrees * found["spmt.pitch"].max()),
        ("stroke_min_m", found["spmt.stroke_min"].min()),
        ("stroke_max_m", found["spmt.stroke_max"].max()),
    ):
        assert value == pytest.approx(row[name], rel=5e-3), name
    for name, channel in (("load_min_t", "spmt.load_min"), ("load_max_t", "spmt.load_max")):
        value = (found[channel].min() if "min" in name else found[channel].max()) / 9810.0
        assert value - 14.5247 == pytest.approx(row[name] - 14.5247, rel=1e-2), name


@pytest.mark.slow
def test_the_whole_passage_of_a_bump_is_that_of_an_independent_solution() -> None:
    """Every place of `bump_r12_groups4_left_curve.csv`, by the way of the vehicle: 0.5 % of the range, loads 1 %.

    At 10 mm/s, with tyres that let no ringing last; the reference has no inertia.
    """
    reference = np.genfromtxt(
        DATA / "bump_r12_groups4_left_curve.csv", delimiter=",", names=True, skip_header=1
    )
    speed, start = 0.01, 9.0
    made = scene(
        vehicle(travel_speed=speed, tyre_damping=1.5e5),
        (yard(), bump(start, 1.2, (0.2, 1.5))),
    )
    _, times, found = histories(made, 2.5e-2, 1400.0, 40)
    way = speed * times - start
    inside = (reference["x"] > way[0]) & (reference["x"] < way[-1])
    assert np.count_nonzero(inside) > 200
    mine = {
        "heave": found["spmt.heave"],
        "roll": found["spmt.roll"],
        "pitch": found["spmt.pitch"],
        "stroke_first_left": found["spmt.stroke_of"][:, 0],
        "load_front_left": found["spmt.wheel_load"][:, 0],
        "load_front_right": found["spmt.wheel_load"][:, 3],
        "load_rear_left": found["spmt.wheel_load"][:, 6],
        "load_rear_right": found["spmt.wheel_load"][:, 9],
    }
    for name, history in mine.items():
        expected = reference[name][inside]
        near = np.interp(reference["x"][inside], way, history)
        part = 1e-2 if name.startswith("load") else 5e-3
        np.testing.assert_allclose(near, expected, atol=part * np.ptp(expected), err_msg=name)


def _towed_with_bodies(radius: float = 0.12, deep: float = 3.0) -> Scene:
    """R12 as a mechanism: bogies are bodies on slider hinges, whose rims touch a ground with the bump.

    A rope through an eye of the block far below each bogie of a group, up to the bogie and down again, has one tension
    T along it: it pushes all of them down by 2 T, and is as much longer as twice the sum of their strokes.
    """
    rest = (MASS / 12.0 + BOGIE) * G
    axle, forwards = radius - rest / TYRE, np.array([1.0, 0.0, 0.0])
    x, across = np.linspace(-8.0, 25.0, 661), np.array([-3.0, -1.0, 1.0, 3.0])
    heights = np.where((x > 4.5) & (x < 6.5), 0.05 * (1.0 - np.cos(np.pi * (x - 4.5))), 0.0)
    points = np.stack([*np.meshgrid(x, across, indexing="ij"), np.repeat(heights[:, None], 4, 1)], axis=2)
    road = Contour(name="road", body="ground", neutral=neutral_surface(points, degrees=(3, 3)))
    hinge = axes_about(np.array([0.0, 1.0, 0.0]))
    bodies = [block(centre_of_mass=np.zeros(3), position=np.array([0.0, 0.0, HEIGHT]), velocity=forwards)]
    joints: list = [
        Guide(
            name="tow",
            body_a="ground",
            body_b="block",
            frame_a=JointFrame(np.array([0.0, 0.0, HEIGHT])),
            speed=1.0,
        )
    ]
    forces: list = [Gravity(np.array([0.0, 0.0, -G]))]
    contacts, ropes = [], []
    for group in groups_of(4):
        path, length = [], 2.0 * deep * len(group.bogies) + np.ptp(group.bogies[:, 0])
        for place in group.bogies:
            number = len(bodies)
            at = place + np.array([0.0, 0.0, axle])
            body = RigidBody(f"bogie_{number}", BOGIE, 2.0 * np.eye(3), position=at, velocity=forwards)
            on_block = at - np.array([0.0, 0.0, HEIGHT])
            joints.append(
                SliderHinge(
                    name=f"slide_{number}",
                    body_a="block",
                    body_b=body.name,
                    frame_a=JointFrame(on_block, hinge),
                    frame_b=JointFrame(np.zeros(3), hinge),
                    slide_axis=hinge.T @ np.array([0.0, 0.0, 1.0]),
                )
            )
            forces.append(
                JointSpring(
                    name=f"pipe_{number}", joint=f"slide_{number}", coordinate="travel", damping=2.0e4
                )
            )
            rim = CircleShape(radius, np.array([0.0, 1.0, 0.0]))
            law = LinearLaw(TYRE, 1.5e4)
            contacts.append(
                Contact(name=f"tyre_{number}", contour="road", body=body.name, shape=rim, law=law)
            )
            eye = RopePoint("block", on_block - np.array([0.0, 0.0, deep]))
            path += [eye, RopePoint(body.name, np.zeros(3)), eye]
            bodies.append(body)
        tension, stiffness = 0.5 * MASS / 12.0 * G, 0.25 * OIL / len(group.bogies)
        modulus = stiffness * (length - tension / stiffness)
        ropes.append(Rope(name=group.name, path=tuple(path), axial_stiffness=modulus, tension=tension))
    return Scene(
        tuple(bodies),
        joints=tuple(joints),
        forces=tuple(forces),
        ropes=tuple(ropes),
        contours=(road,),
        contacts=tuple(contacts),
    )


@pytest.mark.slow
def test_a_vehicle_with_bogies_as_bodies_towed_over_a_bump() -> None:
    """T6: `bump_r12_towed.csv` within 2.5 % of the range, heave 3 %.

    The reference has small tilts: its heave lacks what the block bounces at 2 Hz on oil and tyres as ``h (1 - cos
    pitch)`` lowers its centre of mass, up to 3.5 % of the range, and is 3.1 % off without.
    """
    reference = np.genfromtxt(DATA / "bump_r12_towed.csv", delimiter=",", names=True, skip_header=1)
    at = reference["t"]
    run, times, found = histories(_towed_with_bodies(), 5e-3, at[-1], 4)
    assert run.outcome is Outcome.COMPLETED
    np.testing.assert_allclose(times, at[1:], atol=1e-9)
    lowered = CubicSpline(at, HEIGHT * (1.0 - np.cos(reference["pitch"])))
    omega = np.sqrt(12.0 * OIL * TYRE / (OIL + TYRE) / MASS)
    loss = 12.0 * (1.5e4 * (OIL / (OIL + TYRE)) ** 2 + 2.0e4 * (TYRE / (OIL + TYRE)) ** 2) / MASS
    bounce = solve_ivp(
        lambda t, y: [y[1], lowered(t, 2) - loss * y[1] - omega**2 * y[0]],
        (0.0, at[-1]),
        [0.0, 0.0],
        t_eval=at,
        rtol=1e-8,
        atol=1e-10,
    ).y[0]
    turn = found["block.orientation"]
    for name, history, expected, part in (
        ("heave", found["block.position"][:, 2] - HEIGHT, reference["heave"] + bounce, 3e-2),
        ("pitch", 2.0 * np.arctan2(turn[:, 2], turn[:, 0]), reference["pitch"], 2.5e-2),
        ("load", found["tyre_1.normal_force"], reference["load_first_left"], 2.5e-2),
        ("stroke", found["slide_1.travel"], reference["stroke_first_left"], 2.5e-2),
        ("group", 2.0 * found["group_1.tension"], reference["group_force_front_left"], 2.5e-2),
    ):
        np.testing.assert_allclose(
            history, expected[1:], atol=part * np.ptp(expected), rtol=0.0, err_msg=name
        )
    # the rope of a group knows the sum of its strokes alone
    strokes = np.sum([found[f"slide_{i}.travel"] for i in (1, 2, 3)], axis=0)
    grown = (2.0 * found["group_1.tension"] - MASS / 12.0 * G) / (OIL / 3.0)
    np.testing.assert_allclose(grown, strokes, atol=1e-6)
