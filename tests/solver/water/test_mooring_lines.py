"""Mooring lines between bodies: forces, stiffness, energy and bookkeeping of the force kind."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.interface import (
    Workspace,
    add_forces,
    record_forces,
)
from heavylift.solver.joints.packing import MarkerBook
from heavylift.solver.scene.channels import ChannelBook
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.moorings import LineSection, SeabedSlope
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Sea, Water
from heavylift.solver.simulation import Simulation
from heavylift.solver.water.lines.catenary_line import solve_catenary
from heavylift.solver.water.lines.fenders import Fender
from heavylift.solver.water.lines.mooring_lines import (
    LINE_OVERSTRETCHED,
    MooringLine,
    MooringLines,
)
from heavylift.solver.water.lines.packing import line_markers, pack_mooring_lines

CHAIN = (LineSection(150.0, 1500.0, 5e8), LineSection(60.0, 300.0, 3e8))
HAWSER = (LineSection(90.0, 40.0, 4e6),)
ANCHOR = np.array([-160.0, 90.0, -60.0])
BOLLARD = np.array([12.0, -55.0, 6.0])
FALLING = SeabedSlope(math.radians(10.0), math.radians(200.0))
"""Falls by 10 degrees, 20 degrees off against x."""


def evaluate(kinds: tuple[Any, ...], work: Workspace, row: np.ndarray) -> None:
    """Forces, then a record of them."""
    add_forces(kinds, 0.0, work)
    record_forces(kinds, 0.0, work, row)


def on_seabed(**more: Any) -> MooringLine:
    given: dict[str, Any] = {"sections": CHAIN, "seabed": -60.0, "clumps": (4e3,)}
    return MooringLine(
        name="bow", body_a=GROUND, point_a=ANCHOR, body_b="barge", point_b=np.zeros(3), **(given | more)
    )


def in_air(**more: Any) -> MooringLine:
    given: dict[str, Any] = {"sections": HAWSER}
    return MooringLine(
        name="spring line",
        body_a="quay",
        point_a=BOLLARD,
        body_b="barge",
        point_b=np.zeros(3),
        **(given | more),
    )


def between_hulls(**more: Any) -> MooringLine:
    given: dict[str, Any] = {"sections": CHAIN, "seabed": -60.0, "clumps": (4e3,)}
    return MooringLine(
        name="tow", body_a="tug", point_a=np.zeros(3), body_b="barge", point_b=np.zeros(3), **(given | more)
    )


STERN = np.array([-110.0, 60.0, -2.0])


class Bench:
    """A kind with markers that are put where a test wants them."""

    def __init__(self, line: MooringLine, anchor: np.ndarray, fairlead: np.ndarray) -> None:
        book = MarkerBook()
        markers = line_markers(book, [line])
        record = ChannelBook()
        columns = [record.add("line", line.CHANNELS)]
        self.kind: MooringLines = pack_mooring_lines([line], markers, columns, [(anchor, fairlead)])
        self.work = Workspace.empty(0, book.count)
        self.row = np.zeros(record.width)

    def at(self, anchor: np.ndarray, fairlead: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Forces [N] on the anchor and on the fairlead at these places."""
        self.work.markers.view(float)[:] = 0.0
        self.work.sums.words[:] = 0.0
        self.work.markers[0].point[:], self.work.markers[1].point[:] = anchor, fairlead
        evaluate((self.kind,), self.work, self.row)
        return (
            self.work.markers[0].force.copy(),
            self.work.markers[1].force.copy(),
        )

    @property
    def stiffness(self) -> np.ndarray:
        """Tangent of the force on the fairlead [N/m], shape (3, 3)."""
        return self.kind.tangents[0].reshape(3, 3).copy()


def test_force_lies_in_the_vertical_plane_of_the_ends() -> None:
    fairlead = np.array([-20.0, 70.0, -4.0])
    bench = Bench(on_seabed(), ANCHOR, fairlead)
    on_anchor, on_fairlead = bench.at(ANCHOR, fairlead)
    r = fairlead - ANCHOR
    span = math.hypot(r[0], r[1])
    line = solve_catenary(CHAIN, span, r[2], clumps=(4e3,))
    expected = [-line.horizontal * r[0] / span, -line.horizontal * r[1] / span, -line.vertical]
    assert on_fairlead == pytest.approx(expected, rel=1e-10)
    assert np.all(on_anchor == 0.0)  # the ground has it
    assert bench.row == pytest.approx(
        [line.tension, line.anchor_tension, line.horizontal, line.on_seabed, line.tension, line.tension],
        rel=1e-9,
    )


def test_a_line_in_air_is_in_equilibrium() -> None:
    """The forces on both ends and the weight: no resultant, and no moment about the bollard."""
    fairlead = np.array([70.0, -10.0, 9.0])
    bench = Bench(in_air(clumps=()), BOLLARD, fairlead)
    on_bollard, on_fairlead = bench.at(BOLLARD, fairlead)
    weight = 90.0 * 40.0
    assert on_bollard + on_fairlead == pytest.approx([0.0, 0.0, -weight], abs=1e-9 * weight)
    r = fairlead - BOLLARD
    moment = np.cross(r, on_fairlead)
    across = np.array([-r[1], r[0], 0.0]) / math.hypot(r[0], r[1])
    lever = moment @ across / weight  # of the weight, along the line
    assert moment - (moment @ across) * across == pytest.approx(np.zeros(3), abs=1e-8 * np.abs(moment).max())
    assert -1.0 * math.hypot(r[0], r[1]) < lever < math.hypot(r[0], r[1])


@pytest.mark.parametrize(
    ("line", "anchor", "fairlead"),
    [
        (on_seabed(), ANCHOR, np.array([-20.0, 70.0, -4.0])),
        (on_seabed(friction=0.6), ANCHOR, np.array([35.0, 60.0, -2.0])),
        (on_seabed(), ANCHOR, np.array([41.0, 90.0, -2.0])),  # taut
        (between_hulls(), STERN, np.array([20.0, 20.0, 1.0])),
        (between_hulls(friction=0.5), STERN, np.array([20.0, 20.0, 1.0])),
        (in_air(), BOLLARD, np.array([70.0, -10.0, 9.0])),
        (in_air(), BOLLARD, np.array([12.3, -55.2, -2.0])),  # both ends nearly above each other
    ],
)
def test_tangent_is_the_stiffness(line: MooringLine, anchor: np.ndarray, fairlead: np.ndarray) -> None:
    bench = Bench(line, anchor, fairlead)
    bench.at(anchor, fairlead)
    K = bench.stiffness
    assert np.array_equal(K, K.T)
    values = np.linalg.eigvalsh(K)
    assert values[0] > -1e-9 * values[-1]
    h = 1e-4
    moves = h * np.eye(3)
    differences = np.column_stack(
        [(bench.at(anchor, fairlead - d)[1] - bench.at(anchor, fairlead + d)[1]) / (2 * h) for d in moves]
    )
    differences = 0.5 * (differences + differences.T)
    assert np.abs(K - differences).max() < 2e-6 * values[-1]


@pytest.mark.parametrize(
    ("azimuth", "slope"),
    [(20.0, math.tan(math.radians(10.0))), (200.0, -math.tan(math.radians(10.0))), (110.0, 0.0)],
)
def test_of_a_sloping_bottom_counts_what_lies_in_the_plane_of_the_line(azimuth: float, slope: float) -> None:
    e = np.array([math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth)), 0.0])
    fairlead = ANCHOR + 160.0 * e + [0.0, 0.0, 80.0]
    bench = Bench(on_seabed(seabed_slope=FALLING, friction=0.2), ANCHOR, fairlead)
    _, on_fairlead = bench.at(ANCHOR, fairlead)
    line = solve_catenary(CHAIN, 160.0, 80.0, clumps=(4e3,), slope=slope, friction=0.2)
    assert on_fairlead == pytest.approx(-line.horizontal * e - [0.0, 0.0, line.vertical], rel=1e-8)
    assert bench.row[:4] == pytest.approx(
        [line.tension, line.anchor_tension, line.horizontal, line.on_seabed], rel=1e-8, abs=1e-6
    )
    assert line.on_seabed > 50.0
    # a point at which the height is given: the same bottom
    point = ANCHOR[:2] + np.array([30.0, -40.0])
    lower = math.tan(math.radians(10.0)) * (
        30.0 * math.cos(math.radians(200.0)) - 40.0 * math.sin(math.radians(200.0))
    )
    moved = SeabedSlope(FALLING.angle, FALLING.downhill, point)
    other = Bench(on_seabed(seabed_slope=moved, seabed=-60.0 - lower, friction=0.2), ANCHOR, fairlead)
    assert other.at(ANCHOR, fairlead)[1] == pytest.approx(on_fairlead, rel=1e-9)


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_line_between_two_hulls_lies_in_its_middle(friction: float) -> None:
    """The bottom carries what lies, and takes up the friction of that between the ends."""
    fairlead = np.array([20.0, 20.0, 1.0])
    bench = Bench(between_hulls(friction=friction), STERN, fairlead)
    on_stern, on_barge = bench.at(STERN, fairlead)
    line = solve_catenary(
        CHAIN, math.hypot(130.0, 40.0), 3.0, clumps=(4e3,), clearance=58.0, friction=friction
    )
    lying = bench.row[3]
    assert lying == pytest.approx(line.on_seabed, rel=1e-9)
    assert lying > 20.0
    weight = 150.0 * 1500.0 + 60.0 * 300.0 + 4e3
    lift = -(on_stern + on_barge)[2]  # the lying part is of the heavier section
    assert lift == pytest.approx(weight - 1500.0 * lying, rel=1e-9)
    e = np.array([130.0, -40.0]) / math.hypot(130.0, 40.0)
    assert (on_stern + on_barge)[:2] == pytest.approx(-friction * 1500.0 * lying * e, rel=1e-8, abs=1e-6)


def test_both_ends_over_a_slope_do_no_work_around_a_way() -> None:
    """Without friction, in a vertical plane, with the lower end moving too: work is the gain of energy."""
    slope = SeabedSlope(math.radians(6.0), 0.0, np.array([-90.0, 0.0]))
    a0, a1 = np.array([-90.0, 0.0, -3.0]), np.array([-88.0, 0.0, -9.0])
    b0, b1 = np.array([40.0, 0.0, 2.0]), np.array([47.0, 0.0, -4.0])
    bench = Bench(between_hulls(seabed_slope=slope), a0, b0)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    bench.at(a0, b0)
    assert bench.row[3] > 20.0
    work = 0.0
    for node, weight in zip(0.5 * (nodes + 1.0), 0.5 * weights, strict=True):
        on_a, on_b = bench.at(a0 + node * (a1 - a0), b0 + node * (b1 - b0))
        work -= weight * (on_a @ (a1 - a0) + on_b @ (b1 - b0))
    bench.at(a1, b1)
    assert bench.work.sums.elastic == pytest.approx(work, rel=1e-7)


def test_energy_is_the_work_of_both_ends() -> None:
    """Work on a line in air whose ends both move on a way, by Gauss points, is what its energy gains."""
    a0, a1 = BOLLARD, BOLLARD + np.array([3.0, 2.0, 4.0])
    b0, b1 = np.array([60.0, -10.0, 9.0]), np.array([86.0, -30.0, -7.0])
    bench = Bench(in_air(), a0, b0)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    work = 0.0
    bench.at(a0, b0)
    for node, weight in zip(0.5 * (nodes + 1.0), 0.5 * weights, strict=True):
        on_a, on_b = bench.at(a0 + node * (a1 - a0), b0 + node * (b1 - b0))
        work -= weight * (on_a @ (a1 - a0) + on_b @ (b1 - b0))
    bench.at(a1, b1)
    assert bench.work.sums.elastic == pytest.approx(work, rel=1e-8)
    assert bench.work.sums.external_work == bench.work.sums.elastic  # so the balance does not change
    bench.at(a0, b0)
    assert bench.work.sums.elastic == pytest.approx(0.0, abs=1e-9 * abs(work))


def test_a_slack_line_pulls_straight_down() -> None:
    fairlead = ANCHOR + np.array([30.0, 20.0, 55.0])
    bench = Bench(on_seabed(), ANCHOR, fairlead)
    _, force = bench.at(ANCHOR, fairlead)
    assert np.all(force[:2] == 0.0)
    assert force[2] == pytest.approx(-55.0 * 300.0, rel=1e-3)
    assert np.count_nonzero(bench.stiffness) == 1
    assert bench.row[1] == 0.0


def test_ends_above_each_other() -> None:
    """A line in air straight below its fairlead has no plane of its own, and no side force."""
    bench = Bench(in_air(), BOLLARD, BOLLARD + np.array([0.0, 0.0, 30.0]))
    low, high = bench.at(BOLLARD, BOLLARD + np.array([0.0, 0.0, 30.0]))
    assert np.all(np.isfinite(bench.kind.tangents))
    assert np.all(high[:2] == 0.0)
    # the loop hangs from both ends: (L + z)/2 from the upper one, (L - z)/2 from the lower one
    assert high[2] == pytest.approx(-40.0 * 60.0, rel=1e-3)
    assert low[2] == pytest.approx(-40.0 * 30.0, rel=1e-3)


def test_result_depends_on_places_and_state_only() -> None:
    """Taken up again from its state in the middle of a motion, a line has the same bits."""
    way = [np.array([-20.0 + 60 * math.sin(0.2 * i), 70.0, -4.0 + math.cos(0.7 * i)]) for i in range(60)]
    first = Bench(on_seabed(friction=0.5), ANCHOR, way[0])
    forces = [first.at(ANCHOR, place)[1] for place in way[:30]]
    second = Bench(on_seabed(friction=0.5), ANCHOR, way[0])
    second.kind.state[:] = first.kind.state
    for place in way[30:]:
        forces.append(first.at(ANCHOR, place)[1])
        assert np.array_equal(second.at(ANCHOR, place)[1], forces[-1])
    before = first.kind.state.copy()
    assert np.array_equal(first.at(ANCHOR, way[-1])[1], forces[-1])  # looking twice changes nothing
    assert np.array_equal(first.kind.state, before)
    cold = [Bench(on_seabed(friction=0.5), ANCHOR, way[0]).at(ANCHOR, place)[1] for place in way]
    assert np.abs(np.array(forces) - cold).max() < 1e-9 * np.abs(cold).max()


def test_an_overstretched_line_stops_the_simulation() -> None:
    bench = Bench(in_air(strain_limit=0.05), BOLLARD, BOLLARD + np.array([80.0, 0.0, 0.0]))
    _, force = bench.at(BOLLARD, BOLLARD + np.array([94.0, 0.0, 0.0]))  # strain 0.044
    assert bench.work.status.outcome == 0
    assert force[0] == pytest.approx(-4e6 * 4.0 / 90.0, rel=1e-3)
    _, force = bench.at(BOLLARD, BOLLARD + np.array([95.0, 0.0, 0.0]))
    assert bench.work.status.outcome == LINE_OVERSTRETCHED
    assert bench.work.status.body == 0
    assert np.all(np.isfinite(force))
    lost = Bench(in_air(), BOLLARD, BOLLARD + np.array([80.0, 0.0, 0.0]))
    lost.at(BOLLARD, BOLLARD + np.array([math.nan, 0.0, 0.0]))
    assert lost.work.status.outcome == LINE_OVERSTRETCHED


@pytest.mark.parametrize(
    ("line", "fairlead", "words"),
    [
        (
            in_air(),
            BOLLARD + np.array([120.0, 0, 0]),
            r"spring line: sections: the line of 90 m is shorter than its span of 120",
        ),
        (
            in_air(sections=(LineSection(90.0, 40.0, math.inf),)),
            BOLLARD + np.array([91.0, 0, 0]),
            r"the line of 90 m is shorter than its span of 91 m",
        ),
        (
            on_seabed(seabed=-50.0),
            np.zeros(3),
            r"bow: points: the anchor at height -60 m is 10 m below the seabed",
        ),
        (
            on_seabed(),
            np.array([-20.0, 70.0, -61.0]),
            r"bow: points: the fairlead starts at height -61 m, 1 m below the seabed",
        ),
        (
            on_seabed(seabed_slope=SeabedSlope(math.radians(30.0), math.radians(180.0))),
            np.array([-20.0, 70.0, -4.0]),
            r"bow: points: the fairlead starts at height -4 m, 24.829 m below the seabed",
        ),
        (
            on_seabed(seabed=-70.0, clumps=(-1e3,)),
            np.array([-20.0, 70.0, -4.0]),
            r"bow: clumps.0: a buoy of 1000 N on a line that hangs over a seabed by both ends",
        ),
        (on_seabed(strain_limit=0.0), np.zeros(3), r"strain_limit is 0"),
        (on_seabed(friction=-1.0), np.zeros(3), r"bow: friction: friction is -1"),
        (on_seabed(sections=()), np.zeros(3), r"bow: sections: no sections"),
    ],
)
def test_lines_that_cannot_be_are_refused(line: MooringLine, fairlead: np.ndarray, words: str) -> None:
    anchor = ANCHOR if line.name == "bow" else BOLLARD
    with pytest.raises(InputError, match=words):
        Bench(line, anchor, fairlead)


MASS, G = 2000.0, 9.81
FENDER_HEIGHT, FENDER_STIFFNESS = -22.0, 5e5
HELD = np.array([-30.0, 0.0, 0.0]), np.array([25.0, 15.0, 3.0])
HOLDING = (
    (LineSection(36.0, 60.0, 4e6),),
    (LineSection(20.0, 150.0, 8e6), LineSection(14.0, 40.0, 3e6)),
)


def hung_ball(strain_limit: float = 0.1) -> Scene:
    """A ball of 2 t between two hanging lines, above a fender."""
    lines = tuple(
        MooringLine(
            name=f"line {i}",
            body_a=GROUND,
            point_a=HELD[i],
            body_b="ball",
            point_b=np.zeros(3),
            sections=HOLDING[i],
            strain_limit=strain_limit,
        )
        for i in range(2)
    )
    fender = Fender(
        name="fender",
        body_a=GROUND,
        point_a=np.array([0.0, 0.0, FENDER_HEIGHT]),
        body_b="ball",
        point_b=np.zeros(3),
        direction=np.array([0.0, 0.0, 1.0]),
        stiffness=FENDER_STIFFNESS,
    )
    return Scene(
        (RigidBody("ball", MASS, 200.0 * np.eye(3), position=np.array([0.0, 2.0, -18.0])),),
        (Gravity(np.array([0.0, 0.0, -G])),),
        sea=Sea(water=Water(gravity=G), lines=lines, fenders=(fender,)),
    )


def columns(simulation: Simulation, name: str) -> slice:
    channel = next(channel for channel in simulation.channels if channel.name == name)
    return slice(channel.column, channel.column + len(channel.components))


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_ball_between_two_lines() -> None:
    """Against DOP853 on textbook forces of the same lines: second order, and the energy is that of the lines."""

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        force = np.array([0.0, 0.0, -MASS * G + FENDER_STIFFNESS * max(0.0, FENDER_HEIGHT - y[2])])
        for anchor, sections in zip(HELD, HOLDING, strict=True):
            r = y[:3] - anchor
            span = math.hypot(r[0], r[1])
            line = solve_catenary(sections, span, r[2], seabed=False)
            force -= [line.horizontal * r[0] / span, line.horizontal * r[1] / span, line.vertical]
        return np.concatenate([y[3:], force / MASS])

    times = 0.05 * np.arange(1, 61)
    start = [0.0, 2.0, -18.0, 0.0, 0.0, 0.0]
    reference = solve_ivp(rates, (0, 3.0), start, method="DOP853", t_eval=times, rtol=1e-9, atol=1e-9).y[:3].T
    errors, lost = [], []
    for step in (5e-3, 2.5e-3):
        simulation = Simulation(hung_ball(), step, record_every=round(0.05 / step))
        first = simulation.record()
        _, records = simulation.advance(round(3.0 / step))
        assert simulation.outcome is Outcome.COMPLETED
        errors.append(np.abs(records[:, columns(simulation, "ball.position")] - reference).max())
        lost.append(np.abs(records[:, columns(simulation, "energy.external_work")]).max())
        assert np.ptp(np.vstack([first, records])[:, columns(simulation, "energy.balance")]) < 1e-6
    assert errors[0] < 2e-3
    assert 2.5 < errors[0] / errors[1] < 6.0
    kinetic = records[:, columns(simulation, "energy.kinetic")].max()
    assert lost[1] < 2e-4 * kinetic  # all work is stored in the lines, up to the error of the step
    assert 2.5 < lost[0] / lost[1] < 6.0


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_two_balls_with_a_line_that_lies_between_them() -> None:
    """Two bodies and one line over a sloping bottom: energy stays in the lines up to the error of the step."""
    balls, lines = [], []
    for i, x in enumerate((0.0, 45.0)):
        name, shift = f"ball {i}", np.array([x, 0.0, 0.0])
        balls.append(
            RigidBody(name, MASS, 200.0 * np.eye(3), position=np.array([x + 1.0 - 2.0 * i, 0.0, -18.0]))
        )
        for k, (end, sections) in enumerate(zip(([-30.0, 0.0, 0.0], [25.0, 0.0, 3.0]), HOLDING, strict=True)):
            lines.append(
                MooringLine(
                    name=f"line {i}{k}", body_a=GROUND, point_a=shift + end, body_b=name, point_b=np.zeros(3),
                    sections=sections,
                )
            )  # fmt: skip
    slope = SeabedSlope(math.radians(3.0), 0.0, np.zeros(2))
    lines.append(
        MooringLine(
            name="link", body_a="ball 0", point_a=np.zeros(3), body_b="ball 1", point_b=np.zeros(3),
            sections=(LineSection(62.0, 80.0, 2e6),), seabed=-28.0, seabed_slope=slope,
        )
    )  # fmt: skip
    scene = Scene(
        tuple(balls),
        (Gravity(np.array([0.0, 0.0, -G])),),
        sea=Sea(water=Water(gravity=G), lines=tuple(lines)),
    )
    lost = []
    for step in (5e-3, 2.5e-3):
        simulation = Simulation(scene, step, record_every=round(0.05 / step))
        _, records = simulation.advance(round(2.0 / step))
        assert simulation.outcome is Outcome.COMPLETED
        lying = records[:, columns(simulation, "link.seabed_length")]
        assert lying.min() > 5.0
        assert np.ptp(lying) > 0.5
        lost.append(np.abs(records[:, columns(simulation, "energy.external_work")]).max())
        assert np.ptp(records[:, columns(simulation, "energy.balance")]) < 1e-6
    kinetic = records[:, columns(simulation, "energy.kinetic")].max()
    assert lost[1] < 2e-4 * kinetic
    assert 2.5 < lost[0] / lost[1] < 6.0


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_moored_scene_continues_bit_for_bit() -> None:
    first = Simulation(hung_ball(), 0.01)
    first.advance(100)
    second = Simulation(hung_ball(), 0.01)
    second.restore(first.state())
    assert np.array_equal(first.advance(100)[1], second.advance(100)[1])


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_scene_stops_where_a_line_is_overstretched() -> None:
    simulation = Simulation(hung_ball(strain_limit=0.0345), 0.01)
    simulation.advance(1000)
    assert simulation.outcome is Outcome.LINE_OVERSTRETCHED
    assert "'line " in simulation.message


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_tensions_of_steps_between_records_are_kept() -> None:
    """The largest one is that of a run that records every step, but for the half step between middle and end."""
    runs = []
    for every in (1, 40):
        simulation = Simulation(hung_ball(), 0.01, record_every=every)
        runs.append((simulation, np.vstack([simulation.record(), simulation.advance(400)[1]])))
    for channel in runs[0][0].channels:
        if not channel.name.endswith(".tension"):
            continue
        at = channel.column
        (_, dense), (_, sparse) = runs
        np.testing.assert_array_equal(sparse[:, at], dense[::40, at])
        ends = np.stack([dense[i : i + 41, at] for i in range(0, 400, 40)])
        assert np.all(sparse[1:, at + 4] >= 0.998 * ends[:, 1:].max(axis=1))
        assert np.all(sparse[1:, at + 4] <= 1.002 * ends.max(axis=1))
        assert np.all(sparse[1:, at + 5] <= 1.002 * ends[:, 1:].min(axis=1))
        assert np.all(sparse[1:, at + 5] >= 0.998 * ends.min(axis=1))
        seen = np.maximum(sparse[1:, at], sparse[:-1, at])
        assert np.any(sparse[1:, at + 4] > 1.5 * seen)  # records alone miss peaks
