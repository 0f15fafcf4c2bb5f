"""Sheaves with an efficiency: closed forms of ropes that slide and stick, energy with loss, rest without creep."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from law_scenes import DOWN, G, body, eye, pulley, run, scene, slider, wire

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.scene.connections import GROUND, RopePoint, Winch
from heavylift.solver.scene.scene import Scene
from heavylift.solver.simulation import Simulation

TABLE = Path(__file__).parents[3] / "cases" / "pulleys_with_efficiency" / "accelerations.csv"


def rubbing(place: RopePoint, efficiency: float) -> RopePoint:
    return dataclasses.replace(place, efficiency=efficiency)


def pulleys(eta: float, **more: Any) -> Scene:
    path = [
        eye(GROUND),
        pulley("pulley_1", (0, 0, 0), 0.25, -1.0),
        pulley(GROUND, (0.75, 0, 0), 0.25),
        pulley("pulley_2", (0, 0, 0), 0.25, -1.0),
        pulley(GROUND, (1.75, 0, 0), 0.25),
        eye("box"),
    ]
    path[1:5] = [rubbing(place, eta) for place in path[1:5]]
    bodies = [
        body("pulley_1", 20.0, (0.25, 0, -5)),
        body("pulley_2", 20.0, (1.25, 0, -5)),
        body("box", 11.0, (2, 0, -3)),
    ]
    return scene(bodies, ropes=[wire(*path, stiffness=1e10, damping=1e6, tension=100.0, **more)])


@pytest.mark.parametrize("row", np.loadtxt(TABLE, delimiter=",", skiprows=2), ids=lambda row: f"{row[0]:g}")
def test_pulleys_follow_the_closed_form(row: np.ndarray) -> None:
    """Accelerations and tension of section 2.7.3 (1) with friction; what sticks is said; lost energy is booked."""
    eta, sticks, *accelerations, tension = row
    result = run(pulleys(eta), 1e-3, 1.0)
    found = [result[f"{name}.velocity"][-1, 2] for name in ("pulley_1", "pulley_2", "box")]
    np.testing.assert_allclose(found, accelerations, rtol=1e-6, atol=1e-8)
    assert result["rope.segment_tension"][-1, 4] == pytest.approx(tension, rel=1e-6)
    assert result["rope.tension"][-1] == result["rope.segment_tension"][-1].max()
    assert result.balance < 1e-9 * (result["energy.kinetic"].max() + result["energy.dissipated"][-1])
    if eta < 1.0:
        assert result["energy.dissipated"][-1] > 0.0
        states = result["rope.sheave_state"][-1]
        assert (0.0 in states[:2]) == bool(sticks)
        assert np.all(states[2:] == 1.0)
        ratio = result["rope.segment_tension"][1:, 1:] / result["rope.segment_tension"][1:, :-1]
        assert ratio.min() > eta * (1.0 - 1e-9)
        assert ratio.max() < (1.0 + 1e-9) / eta


def test_strain_is_the_mean_of_the_segments() -> None:
    """Of tensions over EA, by their lengths: a load that has sunk on its own segment, and the sheave sticks."""
    EA, mass = 1e7, 1000.0
    path = [eye(GROUND, (0, 0, -5)), rubbing(eye(GROUND), 0.8), eye("load")]
    rope = wire(*path, stiffness=EA, tension=0.9 * mass * G, damping=1e5)
    result = run(scene([body("load", mass, (0, 0, -5))], ropes=[rope]), 1e-3, 2.0)
    tensions, length = result["rope.segment_tension"][-1], result["rope.length"][-1]
    assert tensions[1] == pytest.approx(mass * G, rel=1e-6)
    assert tensions[0] < 0.99 * tensions[1]
    mean = (5.0 * tensions[0] + (length - 5.0) * tensions[1]) / length
    assert result["rope.strain"][-1] == pytest.approx(mean / EA, rel=1e-6)


def test_efficiency_of_one_is_no_friction() -> None:
    """The same bits as a rope that says nothing of it."""
    with_one = run(pulleys(1.0), 1e-3, 0.2)
    plain = pulleys(1.0)
    path = tuple(RopePoint(p.body, p.point, p.radius, p.axis) for p in plain.ropes[0].path)
    without = run(
        dataclasses.replace(plain, ropes=(dataclasses.replace(plain.ropes[0], path=path),)), 1e-3, 0.2
    )
    np.testing.assert_array_equal(with_one.records, without.records)


def atwood(masses: tuple[float, float], eta: float, stiffness: float = 1e10) -> Scene:
    """Two pulleys on one rope between two fixed ends and over a fixed sheave."""
    path = [
        eye(GROUND),
        rubbing(pulley("a", (0, 0, 0), 0.25, -1.0), eta),
        rubbing(pulley(GROUND, (0.75, 0, 0), 0.25), eta),
        rubbing(pulley("b", (0, 0, 0), 0.25, -1.0), eta),
        eye(GROUND, (1.5, 0, 0)),
    ]
    bodies = [body("a", masses[0], (0.25, 0, -5)), body("b", masses[1], (1.25, 0, -5))]
    rope = wire(*path, stiffness=stiffness, damping=1e5, tension=0.25 * G * sum(masses))
    return scene(bodies, ropes=[rope])


@pytest.mark.parametrize("eta", [0.98, 0.96])
def test_a_pair_of_pulleys_slides(eta: float) -> None:
    """``a = g (eta^2 m1 - m2)/(eta^2 m1 + m2)``: two sheaves move, of the third only the rope does."""
    result = run(atwood((200.0, 100.0), eta), 1e-3, 1.0)
    expected = G * (eta**2 * 200.0 - 100.0) / (eta**2 * 200.0 + 100.0)
    assert -result["a.velocity"][-1, 2] == pytest.approx(expected, rel=1e-6)
    assert result["b.velocity"][-1, 2] == pytest.approx(expected, rel=1e-6)
    assert result.balance < 1e-9 * result["energy.kinetic"].max()


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [1.0, 0.98**2 * 1.0001, 0.9999 / 0.98**2])
def test_a_pair_at_rest_does_not_creep(ratio: float) -> None:
    """An hour just inside of what friction holds: less than 1e-9 m; just outside it goes."""
    simulation = Simulation(atwood((200.0, 200.0 * ratio), 0.98, 1e8), 2e-2, "dele2")
    simulation.advance(500)
    before = simulation.record()
    simulation.advance(180_000)
    after = simulation.record()
    assert simulation.outcome is Outcome.COMPLETED
    columns = [c.column + 2 for c in simulation.channels if c.name in {"a.position", "b.position"}]
    assert np.abs(after[columns] - before[columns]).max() < 1e-9


def test_a_pair_goes_beyond_its_friction() -> None:
    result = run(atwood((200.0, 200.0 * 1.001 / 0.98**2), 0.98, 1e8), 1e-2, 5.0)
    expected = G * (0.98**2 * 200.2 / 0.98**2 - 200.0) / (0.98**2 * 200.2 / 0.98**2 + 200.0)
    assert result["a.velocity"][-1, 2] == pytest.approx(5.0 * expected, rel=1e-3)


def fall(parts: int, eta: float, speed: float, end: str) -> Scene:
    """A hook on a guide that hangs in some parts, the last of which goes over a sheave to the winch."""
    r, height, even = 0.3, 20.0, parts % 2 == 0
    stops = [eye(GROUND, (0, 0, height)) if even else eye("block")]
    for i in range(parts):
        lower = (i % 2 == 0) == even
        place = (
            ("block", (r * (2 * i + 1), 0, 0), r, -1.0)
            if lower
            else (GROUND, (r * (2 * i + 1), 0, height), r, 1.0)
        )
        stops.append(rubbing(pulley(*place), eta))
    stops.append(eye(GROUND, (2 * r * parts, 0, -5.0)))
    if end == "first":
        stops = [dataclasses.replace(s, axis=-s.axis) if s.radius else s for s in reversed(stops)]
    winch = Winch(np.array([0.0, 1.0]), np.array([0.0, parts * speed]), end=end)
    rope = wire(*stops, stiffness=1e9, damping=1e6, winch=winch, tension=1e5 * G / parts)
    return Scene((body("block", 1e5, (0, 0, 0)),), (DOWN,), (), (slider((0, 0, 1)),), (rope,))


@pytest.mark.parametrize("parts", [2, 3, 8, 24])
@pytest.mark.parametrize("K", [1.02, 1.09])
@pytest.mark.parametrize(("speed", "end"), [(0.05, "first"), (-0.05, "first"), (0.05, "last")])
def test_lead_line(parts: int, K: float, speed: float, end: str) -> None:
    """``T/W = K^N (K - 1)/(K^N - 1)`` (Wire Rope Users Manual: 0.309 for 4 parts, 1.09); lowering with 1/K."""
    result = run(fall(parts, 1.0 / K, speed, end), 1e-2, 4.0)
    k = K if speed > 0.0 else 1.0 / K
    lead = result["rope.segment_tension"][-1, 0 if end == "first" else -1]
    assert lead / (1e5 * G) == pytest.approx(k**parts * (k - 1.0) / (k**parts - 1.0), rel=1e-6)
    assert np.all(np.abs(result["rope.sheave_state"][-1]) == 1.0)
    # the work of the winch is that against its own end: what the load gains, and what friction takes
    assert result["energy.dissipated"][-1] > 0.01 * abs(result["energy.drive_work"][-1])
    assert result.balance < 2.0 * run(fall(parts, 1.0, speed, end), 1e-2, 4.0).balance


def test_a_fall_that_stops_keeps_its_tensions() -> None:
    """Friction at rest holds what there was: a hook that hangs on after hoisting has the tensions of hoisting."""
    raised = fall(4, 0.95, 0.05, "first")
    winch = Winch(np.array([0.0, 1.0, 2.0, 3.0]), np.array([0.0, 0.2, 0.2, 0.0]))
    raised = dataclasses.replace(raised, ropes=(dataclasses.replace(raised.ropes[0], winch=winch),))
    result = run(raised, 1e-2, 10.0)
    tension = result["rope.segment_tension"]
    at_speed, at_rest = tension[150], tension[-1]
    np.testing.assert_allclose(at_rest / at_rest[0], at_speed / at_speed[0], rtol=5e-2)
    assert np.abs(result["rope.sheave_speed"][-1]).max() < 1e-9


W = 1e5 * G


def two_drums(eta: float, winch: Winch, other: Winch | None) -> Scene:
    """A hook on a guide that hangs in four parts of a rope with a drum at both ends, each behind a sheave."""
    r, height = 0.3, 20.0
    stops = [eye(GROUND, (0, 0, -5.0))]
    for i in range(5):
        upper = i % 2 == 0
        place = (GROUND, (r * (2 * i + 1), 0, height)) if upper else ("block", (r * (2 * i + 1), 0, 0))
        stops.append(rubbing(pulley(*place, r, 1.0 if upper else -1.0), eta))
    stops.append(eye(GROUND, (10 * r, 0, -5.0)))
    rope = wire(*stops, stiffness=1e9, damping=1e6, winch=winch, other_winch=other, tension=0.25 * W)
    return Scene((body("block", 1e5, (0, 0, 0)),), (DOWN,), (), (slider((0, 0, 1)),), (rope,))


def hauls(speed: float, **more: Any) -> Winch:
    return Winch(np.array([0.0, 1.0]), np.array([0.0, speed]), **more)


@pytest.mark.parametrize("eta", [0.98, 0.9])
@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize(("v1", "v2"), [(0.25, 0.1), (-0.25, -0.1), (0.1, -0.02), (0.0, 0.1)])
def test_two_drums_share_a_fall(eta: float, swapped: bool, v1: float, v2: float) -> None:
    """Each part shortens by (v1 + v2)/4, so the speed over each sheave is known, and with its sense the ratio there."""
    winches = (hauls(v1), hauls(v2)) if not swapped else (hauls(v2, end="last"), hauls(v1))
    result = run(two_drums(eta, *winches), 1e-2, 6.0)
    speeds = -v1 + np.arange(5) * (v1 + v2) / 4
    ratio = eta ** -np.sign(speeds)
    found = result["rope.segment_tension"][-1]
    sliding = np.abs(speeds) > 0.0
    assert np.all(sliding[1:])
    tension = np.cumprod(np.append(1.0, ratio[1:]))
    # where a sheave sticks the mean tension goes on changing, and records are of the ends of steps
    exact = 1e-6 if sliding.all() else 1e-5
    np.testing.assert_allclose(found[1:], tension * W / tension[:4].sum(), rtol=exact)
    np.testing.assert_allclose((found[1:] / found[:-1])[sliding], ratio[sliding], rtol=1e-9)
    assert (
        eta * (1.0 - 1e-9) < found[1] / found[0] < (1.0 + 1e-9) / eta
    )  # a drum that stands may hold any of these
    strain = found.max() / 1e9
    np.testing.assert_allclose(result["rope.sheave_speed"][-1], speeds, atol=strain * np.abs(speeds).max())
    assert result["block.velocity"][-1, 2] == pytest.approx((v1 + v2) / 4, rel=strain)
    # each winch works against the tension of its own end
    tail = result.times > 5.0
    power = np.polyfit(result.times[tail], result["energy.drive_work"][tail], 1)[0]
    stored = 0.5 * found.mean() ** 2 / 1e9  # of a metre that comes in with its elongation
    assert power == pytest.approx(found[0] * v1 + found[-1] * v2 + stored * (v1 + v2), rel=2e-5)
    lost = np.polyfit(result.times[tail], result["energy.dissipated"][tail], 1)[0]
    assert lost == pytest.approx(np.sum(np.diff(found) * result["rope.sheave_speed"][-1]), rel=1e-5)
    after_start = result["energy.balance"][50:]
    assert np.ptp(after_start) < 1e-9 * np.ptp(result["energy.drive_work"][50:])


def test_a_rope_runs_through_while_its_load_stands_still() -> None:
    """One drum gives what the other takes: all that the winches bring is lost at the sheaves."""
    eta, v = 0.95, 0.2
    result = run(two_drums(eta, hauls(-v), hauls(v)), 1e-2, 3.0)
    tension = eta ** -np.arange(6.0)
    tension *= W / tension[1:5].sum()
    np.testing.assert_allclose(result["rope.segment_tension"][-1], tension, rtol=1e-6)
    assert abs(result["block.velocity"][-1, 2]) < 1e-9
    tail = result.times > 2.0
    work, lost = (
        np.polyfit(result.times[tail], result[f"energy.{name}"][tail], 1)[0]
        for name in ("drive_work", "dissipated")
    )
    assert work == pytest.approx((tension[-1] - tension[0]) * v, rel=1e-6)
    assert lost == pytest.approx(work, rel=1e-9)
    after_start = result["energy.balance"][50:]
    assert np.ptp(after_start) < 1e-9 * np.ptp(result["energy.dissipated"][50:])


def test_drums_at_both_ends_are_two_winches_of_half_the_speed() -> None:
    both = run(two_drums(0.95, hauls(0.4, end="both"), None), 1e-2, 2.0)
    two = run(two_drums(0.95, hauls(0.2), hauls(0.2)), 1e-2, 2.0)
    np.testing.assert_allclose(both.records, two.records, rtol=1e-7, atol=1e-6)


def test_two_winches_without_friction_are_one() -> None:
    """The same bits, where the sums of their speeds and lengths are exact."""
    two = run(two_drums(1.0, hauls(0.25), hauls(0.5)), 1e-2, 2.0)
    one = run(two_drums(1.0, hauls(0.75), None), 1e-2, 2.0)
    np.testing.assert_array_equal(two.records, one.records)


@pytest.mark.parametrize("eta", [1.0, 0.95])
def test_two_winches_take_the_sum_of_what_each_takes(eta: float) -> None:
    """Planned moves with jerk that begin at other times."""
    smooth = Winch(np.array([0.1, 1.4]), np.array([0.2, 0.0]), acceleration=0.5, jerk=2.0)
    linear = Winch(np.array([-1.0, 0.7, 1.1]), np.array([0.05, -0.1, 0.03]))
    hauled = []
    for winches in ((smooth, None), (linear, None), (smooth, linear), (linear, smooth)):
        length = run(two_drums(eta, *winches), 1e-2, 2.5)["rope.rest_length"]
        hauled.append(length[0] - length)
    np.testing.assert_allclose(hauled[2], hauled[0] + hauled[1], atol=1e-12)
    np.testing.assert_allclose(hauled[3], hauled[2], atol=1e-12)


@pytest.mark.parametrize(
    ("winches", "key"),
    [
        ((None, hauls(0.1)), "other_winch"),
        ((hauls(0.1, end="both"), hauls(0.1)), "winch.end"),
        ((Winch(np.array([0.0, 1.0]), lengths=np.array([90.0, 80.0])), hauls(0.1)), "winch.lengths"),
        ((hauls(0.1), Winch(brake=1e5)), "other_winch.brake"),
        ((hauls(0.1), hauls(0.1, end="last")), "other_winch.end"),
    ],
)
def test_two_winches_that_make_no_sense(winches: Any, key: str) -> None:
    with pytest.raises(InputError) as refused:
        Simulation(two_drums(0.95, *winches), 1e-2, "dele2")
    assert refused.value.key.endswith(key)


def over_a_yoke(mu: float, speed: float, sideways: float = 0.0) -> Scene:
    """A load on a rope that is hauled in over a sheave that does not turn, with a quarter of a turn about it."""
    r = 0.3
    yoke = dataclasses.replace(pulley(GROUND, (0, 0, 0), r), friction=mu)
    load = body("load", 1000.0, (r, 0, -4.0), (sideways, 0, 0))
    more = {"stiffness": 1e8, "damping": 1e5, "winch": hauls(speed), "tension": 1000.0 * G}
    return scene([load], ropes=[wire(eye(GROUND, (-8.0, 0, r)), yoke, eye("load"), **more)])


@pytest.mark.parametrize("speed", [0.1, -0.1])
def test_a_rope_slips_over_a_yoke(speed: float) -> None:
    """Capstan: ``T_1 = W exp(+-mu wrap)`` (Euler, 1769)."""
    result = run(over_a_yoke(0.12, speed), 1e-3, 3.0)
    tension = result["rope.segment_tension"][-1]
    assert tension[1] == pytest.approx(1000.0 * G, rel=1e-6)
    assert tension[0] / tension[1] == pytest.approx(
        math.exp(math.copysign(0.12, speed) * math.pi / 2), rel=1e-9
    )
    assert result.balance < 1e-9 * result["energy.dissipated"][-1]


def test_the_wrap_about_a_yoke_goes_with_the_load() -> None:
    """A load that swings: the ratio of tensions is that of the angle at which its rope hangs at the time."""
    result = run(over_a_yoke(0.12, 0.1, 1.5), 1e-3, 4.0)
    sliding = np.flatnonzero(result["rope.sheave_state"] == -1.0)[500:]
    way = result["load.position"][sliding][:, [0, 2]]
    # the rope leaves along the tangent from the circle of the sheave, at an angle to the vertical outwards
    outwards = np.arctan2(way[:, 0], -way[:, 1]) - np.arcsin(0.3 / np.linalg.norm(way, axis=1))
    T = result["rope.segment_tension"][sliding]
    np.testing.assert_allclose(T[:, 0] / T[:, 1], np.exp(0.12 * (0.5 * math.pi - outwards)), rtol=1e-4)
    assert np.ptp(T[:, 0] / T[:, 1]) > 0.03
    assert result.balance < 2.0 * run(over_a_yoke(0.0, 0.1, 1.5), 1e-3, 4.0).balance


def test_slack_and_taut_again() -> None:
    """A box that is thrown up lets the rope go slack on its sheaves and falls into it: nothing is lost unbooked."""
    path = (eye(GROUND, (-0.6, 0, -5.0)), rubbing(pulley(GROUND, (0, 0, 0), 0.3), 0.9), eye("load"))
    load = body("load", 100.0, (0.3, 0, -4.0), (0, 0, 3.0))
    result = run(scene([load], ropes=[wire(*path, stiffness=1e6, length=9.96)]), 1e-3, 3.0)
    assert result["rope.tension"].min() == 0.0
    assert result["rope.tension"].max() > 2.0 * 100.0 * G
    assert result.balance < 1e-9 * result["energy.kinetic"].max()


@pytest.mark.parametrize(("place", "integrator"), [(0, "dele2"), (1, "accurate")])
def test_what_an_efficiency_cannot_serve_is_refused(place: int, integrator: str) -> None:
    path = [eye(GROUND), pulley(GROUND, (1, 0, 5), 0.3), eye("load")]
    path[place] = rubbing(path[place], 0.9)
    rope = wire(*path)
    with pytest.raises(InputError, match=r"efficiency at an end|sticks and slides"):
        Simulation(scene([body("load", 1.0, (2, 0, 0))], ropes=[rope]), 1e-2, integrator)


@pytest.mark.parametrize(
    "made",
    [
        pulleys(0.96),
        fall(8, 0.95, 0.05, "first"),
        two_drums(0.95, hauls(0.2), hauls(-0.05)),
        over_a_yoke(0.2, 0.1, 1.0),
    ],
    ids=["pulleys", "fall", "two drums", "yoke"],
)
def test_a_run_goes_on_where_it_was(made: Scene) -> None:
    """A checkpoint has all that friction remembers: the same bits."""
    first, second = (Simulation(made, 1e-3, "dele2") for _ in range(2))
    first.advance(150)
    second.restore(first.state())
    np.testing.assert_array_equal(first.advance(100)[1], second.advance(100)[1])
