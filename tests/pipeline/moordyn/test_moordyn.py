"""Dynamic lines by MoorDyn: its input, its agreement with catenaries at rest and in slow motion, and its absence."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.moordyn.coupling import couple_moordyn
from heavylift.pipeline.moordyn.input_file import LineDynamics, moordyn_input
from heavylift.pipeline.moordyn.lines import quasi_static_force, run_moordyn
from heavylift.solver.forces.point import PointForce
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.moorings import LineSection, SeabedSlope
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Sea
from heavylift.solver.water.lines.catenary_line import solve_catenary
from heavylift.solver.water.lines.mooring_lines import MooringLine

if TYPE_CHECKING:
    from pathlib import Path

ANCHOR = np.array([10.0, -5.0, -58.0])
SECTIONS = (LineSection(80.0, 900.0, 4e8), LineSection(150.0, 250.0, 3e8), LineSection(40.0, 900.0, 4e8))
MASSES = (105.0, 30.0, 105.0)
E = np.array([0.8, 0.6, 0.0])


def three_sections(**more: Any) -> MooringLine:
    given: dict[str, Any] = {"sections": SECTIONS, "clumps": (10e3, -5e3), "seabed": -58.0}
    return MooringLine(
        name="bow line", body_a=GROUND, point_a=ANCHOR, body_b="barge", point_b=np.zeros(3), **(given | more)
    )


def chain() -> MooringLine:
    """80 kg/m in water 50 m deep."""
    return three_sections(sections=(LineSection(200.0, 685.0, 7e8),), clumps=())


def fairlead(span: float, height: float) -> np.ndarray:
    return ANCHOR + span * E + np.array([0.0, 0.0, height])


def table(text: str, heading: str) -> list[list[str]]:
    """Rows of a table of the input file, without its two lines of names and units."""
    blocks = text.split("----------------------")
    at = next(i for i, block in enumerate(blocks) if block.strip() == heading)
    return [row.split() for row in blocks[at + 1].strip().splitlines()[2:]]


def test_input_describes_the_line() -> None:
    text = moordyn_input(
        three_sections(),
        LineDynamics(MASSES, segment=7.0),
        ANCHOR,
        fairlead(230.0, 55.0),
        level=2.0,
        density=1025.0,
    )
    types, points, lines = (table(text, heading) for heading in ("LINE TYPES", "POINTS", "LINES"))
    for row, section, mass in zip(types, SECTIONS, MASSES, strict=True):
        diameter, density, EA = map(float, row[1:4])
        in_water = (density - 1025.0 * math.pi / 4 * diameter**2) * 9.80665
        assert (in_water, density, EA) == pytest.approx(
            (section.weight, mass, section.axial_stiffness), rel=1e-9
        )
    assert [row[1] for row in points] == ["Fixed", "Free", "Free", "Coupled"]
    places = np.array([[float(x) for x in row[2:5]] for row in points])
    assert places[0] == pytest.approx([10.0, -5.0, -60.0])
    assert places[-1] == pytest.approx(fairlead(230.0, 53.0))
    ways = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert np.all(ways < 1.001 * np.array([80.0, 150.0, 40.0]))
    assert float(points[1][5]) == pytest.approx(10e3 / 9.80665)
    assert float(points[2][6]) == pytest.approx(5e3 / 9.80665 / 1025.0)
    assert [(float(row[4]), int(row[5])) for row in lines] == [(80.0, 12), (150.0, 22), (40.0, 6)]
    assert [row[2:4] for row in lines] == [["1", "2"], ["2", "3"], ["3", "4"]]
    assert "60 WtrDpth" in text
    moving = moordyn_input(
        three_sections(seabed=None), LineDynamics(MASSES), ANCHOR, fairlead(230.0, 55.0), anchor_moves=True
    )
    assert table(moving, "POINTS")[0][1] == "Coupled"


def test_quasi_static_force_along_a_motion() -> None:
    way = np.array([fairlead(225.0 + 10.0 * math.sin(0.3 * i), 55.0 + math.cos(0.5 * i)) for i in range(30)])
    forces = quasi_static_force(three_sections(), np.tile(ANCHOR, (30, 1)), way)
    for place, force in zip(way, forces, strict=True):
        r = place - ANCHOR
        line = solve_catenary(SECTIONS, math.hypot(r[0], r[1]), r[2], clumps=(10e3, -5e3))
        assert force == pytest.approx([*(-line.horizontal * E[:2]), -line.vertical], rel=1e-9)


def test_bad_input_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="2 masses of 3 sections"):
        moordyn_input(three_sections(), LineDynamics((1.0, 2.0)), ANCHOR, fairlead(230.0, 55.0))
    with pytest.raises(
        InputError, match=r"masses.1: a mass of 10 kg/m weighs less in air .* more than 25.49"
    ):
        moordyn_input(three_sections(), LineDynamics((105.0, 10.0, 105.0)), ANCHOR, fairlead(230.0, 55.0))
    rigid = three_sections(sections=(LineSection(270.0, 900.0, math.inf),), clumps=())
    slope = three_sections(seabed_slope=SeabedSlope(0.1))
    with pytest.raises(InputError, match="bow line: seabed_slope: the seabed slopes"):
        moordyn_input(slope, LineDynamics(MASSES), ANCHOR, fairlead(230.0, 55.0))
    with pytest.raises(InputError, match="section 1 does not stretch"):
        moordyn_input(rigid, LineDynamics((105.0,)), ANCHOR, fairlead(230.0, 55.0))
    still = np.tile(fairlead(230.0, 55.0), (3, 1))
    with pytest.raises(InputError, match="increasing times"):
        run_moordyn(three_sections(), LineDynamics(MASSES), np.array([0.0, 1.0, 1.0]), still)
    monkeypatch.setitem(sys.modules, "moordyn", None)
    with pytest.raises(InputError, match=r"moordyn is not installed.*heavylift\[moordyn\]"):
        run_moordyn(three_sections(), LineDynamics(MASSES), np.array([0.0, 1.0, 2.0]), still)


@pytest.mark.slow
def test_at_rest_it_is_the_catenary(tmp_path: Path) -> None:
    """Tensions of three sections with clump and buoy within 1 % of the catenary; nodes where that is."""
    pytest.importorskip("moordyn")
    times = np.linspace(0.0, 40.0, 41)
    still = np.tile(fairlead(236.0, 55.0), (41, 1))
    result = run_moordyn(three_sections(), LineDynamics(MASSES, segment=4.0), times, still, folder=tmp_path)
    line = solve_catenary(SECTIONS, 236.0, 55.0, clumps=(10e3, -5e3))
    assert result.quasi_static[-1] == pytest.approx(line.tension, rel=1e-12)
    assert result.tension[-20:].mean() == pytest.approx(line.tension, rel=0.01)
    assert result.anchor_tension[-20:].mean() == pytest.approx(line.anchor_tension, rel=0.02)
    assert result.force[-20:].mean(axis=0)[:2] @ E[:2] == pytest.approx(-line.horizontal, rel=0.01)
    assert result.nodes[-1] == pytest.approx(fairlead(236.0, 55.0), abs=1e-6)
    assert result.nodes[0] == pytest.approx(ANCHOR, abs=1e-6)
    assert {file.suffix for file in tmp_path.iterdir()} >= {".txt", ".log"}


@pytest.mark.slow
def test_slow_motion_is_quasi_static_and_fast_motion_is_not() -> None:
    """Surge of 2 m over 100 s and heave of 3 m over 7 s."""
    pytest.importorskip("moordyn")
    for period, surge, heave in ((100.0, 2.0, 0.0), (7.0, 0.0, 3.0)):
        times = np.arange(0.0, max(period, 35.0), 0.25)
        angle = 2 * math.pi * times / period
        ramp = np.minimum(times / 10.0, 1.0)
        way = np.array(
            [
                fairlead(184.0 + r * surge * (1 - math.cos(a)) / 2, 50.0 + r * heave / 2 * math.sin(a))
                for a, r in zip(angle, ramp, strict=True)
            ]
        )
        result = run_moordyn(chain(), LineDynamics((80.0,), segment=10.0), times, way)
        late = times > 10.0
        difference = np.abs(result.tension / result.quasi_static - 1.0)[late].max()
        if heave:
            assert difference > 0.1
            assert result.amplification > 1.05
        else:
            assert difference < 0.03


def held_barge() -> Scene:
    """2,000 t that a chain and a constant force hold, 0.5 m from equilibrium."""
    line = chain()
    found = solve_catenary(line.sections, 186.0, 50.0)
    pull = np.array([*(found.horizontal * E[:2]), found.vertical])
    holding = PointForce("wind", "barge", np.zeros(3), np.zeros(1), pull[None])
    barge = RigidBody("barge", 2e6, 1e9 * np.eye(3), position=fairlead(186.0, 50.0) + 0.5 * E)
    return Scene((barge,), (Gravity(np.zeros(3)), holding), sea=Sea(lines=(line,)))


def test_coupling_refuses_what_it_cannot_do(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = held_barge()
    dynamics = {"bow line": LineDynamics((80.0,))}
    with pytest.raises(InputError, match=r"there is no line 'stern'.*bow line"):
        couple_moordyn(scene, {"stern": dynamics["bow line"]}, 0.05, 1.0)
    with pytest.raises(InputError, match=r"interval: 0.07 s between exchanges.*steps of 0.05 s"):
        couple_moordyn(scene, dynamics, 0.05, 1.0, interval=0.07)
    monkeypatch.setitem(sys.modules, "moordyn", None)
    with pytest.raises(InputError, match=r"heavylift\[moordyn\]"):
        couple_moordyn(scene, dynamics, 0.05, 1.0)


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_drag_of_a_coupled_line_takes_energy_from_the_barge() -> None:
    """Kinetic energy, that of the catenary and that of the constant force: kept without drag, lost with it."""
    pytest.importorskip("moordyn")
    scene = held_barge()
    pull = scene.forces[1].forces[0]  # type: ignore[union-attr]
    lost = []
    for drag in (0.0, 20.0, 60.0):
        run = couple_moordyn(scene, {"bow line": LineDynamics((80.0,), drag=drag)}, 0.05, 120.0, interval=0.1)
        assert run.simulation.outcome is Outcome.COMPLETED
        assert len(run.times) == len(run.records) == len(run.tension["bow line"]) == 1201
        column = {channel.name: channel.column for channel in run.channels}
        way = run.records[:, column["barge.position"] :][:, :3]
        energy = run.records[:, column["energy.kinetic"]] + run.records[:, column["energy.elastic"]]
        energy -= (way - way[0]) @ pull
        lost.append((energy[0] - energy[-1]) / run.records[:, column["energy.kinetic"]].max())
        # what is recorded is the catenary here and the difference of MoorDyn before
        own = run.records[:, column["bow line.tension"]]
        assert own[50:] == pytest.approx(run.tension["bow line"][50:], rel=0.01)
        difference = np.abs(run.tension["bow line"] / run.quasi_static["bow line"] - 1.0)
        assert difference.max() < 0.1
    assert abs(lost[0]) < 0.02
    assert 0.2 < lost[1] < lost[2] < 1.5
