"""A transporter over a bump against an independent integration, and what a step keeps."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from vehicles import BOGIE, DATA, MASS, OIL, G, block, bump, groups_of, histories, scene, vehicle, yard

from heavylift.numerics.outcome import Outcome
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
