"""Cases whose joints hold directions that modes turn: their moments are recorded, judged, and the same on the way."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.results.histories import load_results
from heavylift.pipeline.stages.stages import run_case
from tests.pipeline.judged import judged_checks, judged_criteria

ARM = """
[bodies.arm]
type = "rigid"
mass = "1 kg"
inertia = [1e-3, 1e-3, 1e-3]
frame = { motion = "free" }
initial = { position = ["PLACE", 0, 0] }

[[joints]]
type = "fixed"
name = "bolt"
between = ["beam", "arm"]
at = ["PLACE", 0, 0]
"""


def folder_of(tmp_path: Path, place: str) -> Path:
    text = (Path(__file__).parents[1] / "small_beam.toml").read_text(encoding="utf-8")
    (tmp_path / "case.toml").write_text(text + ARM.replace("PLACE", place), encoding="utf-8")
    return tmp_path


def test_a_weight_that_is_bolted_to_the_tip_bends_the_beam(tmp_path: Path) -> None:
    """1 kg, 0.1 m beyond the tip: M = F a on the bolt, which a criterion watches, and F (L + a) on the clamp."""
    folder = folder_of(tmp_path, "200 mm")
    at_rest = (
        "gravity.acceleration=[0, 0, -9.81]",
        "bodies.arm.centre_of_mass=['100 mm', '10 mm', '5 mm']",
        "bodies.beam.material.density='1 kg/m^3'",
        "bodies.beam.modes.static_points=[['200 mm', '10 mm', '5 mm']]",
        "simulate.start='equilibrium'",
        "simulate.duration=0",
        "joints.0.at=['200 mm', '10 mm', '5 mm']",
        "bodies.arm.initial.position=['200 mm', 0, 0]",
    )
    ours = """
[[check]]
id = "moment"
quantity = "channel.bolt.reaction_moment.y.end"
reference = "-0.981 N m"
tolerance = { relative = 1e-3 }
source = "F a"

[[check]]
id = "clamp"
quantity = "channel.beam.reaction_moment.y.end"
reference = "-2.943 N m"
tolerance = { relative = 1e-3 }
source = "F (L + a)"

[[criteria]]
type = "limit"
name = "bolt"
quantity = "channel.bolt.reaction_moment.y.end"
minimum = "-2 N m"
"""
    text = (folder / "case.toml").read_text(encoding="utf-8")
    head = text[: text.index("[converge]")] + text[text.index("[bodies.arm]") :]
    (folder / "case.toml").write_text(head + ours, encoding="utf-8")
    report = run_case(load_case(folder, at_rest))
    assert not report.outcome, report.message
    case = load_case(folder, at_rest)
    verdicts = {check.id: check for check in judged_checks(case, folder / "out")}
    assert all(verdicts[name].passed for name in ("moment", "clamp")), verdicts
    (limit,) = judged_criteria(case, folder / "out")
    assert limit.value == pytest.approx(-0.981, rel=1e-3)
    assert limit.passed


LUG = """
title = "A weight on a lug above the end of a cantilever"
[gravity]
acceleration = [0, 0, -9.81]
[bodies.beam]
type = "flexible"
material = { young_modulus = "210 GPa", poisson_ratio = 0.0, density = "1 kg/m^3" }
frame = { motion = "fixed" }
[bodies.beam.geometry]
type = "blocks"
add = [{ name = "beam", from = [0, "-10 mm", "-10 mm"], to = ["1 m", "10 mm", "10 mm"] }]
groups = { root = { plane = "x", at = 0 }, tip = { plane = "x", at = "1 m" } }
[bodies.beam.mesh]
element = "hex8"
divisions = { x = [20], y = [2], z = [2] }
[bodies.beam.modes]
count = 4
clamp = ["root"]
[bodies.beam.interfaces.LUG]
at = ["1 m", 0, "100 mm"]
group = "tip"
[bodies.weight]
type = "rigid"
mass = "2 kg"
inertia = [1e-3, 1e-3, 1e-3]
frame = { motion = "free" }
initial = { position = ["1 m", 0, "100 mm"] }
[[joints]]
type = "TYPE"
name = "pin"
between = ["beam", "weight"]
points = ["LUG", [0, 0, 0]]
AXIS
[[sensors]]
name = "lug"
body = "beam"
point = "LUG"
[[relative_motions]]
name = "seen"
between = ["ground", "beam"]
points = [[0, 0, 0], "LUG"]
[simulate]
start = "equilibrium"
duration = 0
"""


@pytest.mark.parametrize("joint", ["fixed", "hinge"])
def test_the_name_of_an_interface_is_its_place_beside_the_body(tmp_path: Path, joint: str) -> None:
    """The lug sinks by F L^3 / 3 E I, turns by F L^2 / 2 E I, and moves forwards by that times its height."""
    text = LUG.replace("TYPE", joint).replace("AXIS", "axis = [1, 0, 0]" if joint == "hinge" else "")
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    case = load_case(tmp_path)
    report = run_case(case, stages=("mesh", "modes", "simulate"))
    assert not report.outcome, report.message
    results = load_results(case)
    force, bending = 2.0 * 9.81, 210e9 * 0.02**4 / 12.0
    turn = force / (2.0 * bending)
    moved = results["lug.position"][-1] - [1.0, 0.0, 0.1]
    np.testing.assert_allclose(moved, [0.1 * turn, 0.0, -2.0 / 3.0 * turn], rtol=5e-3, atol=1e-7)
    np.testing.assert_allclose(results["seen.rotation"][-1], [0.0, turn, 0.0], rtol=5e-3, atol=1e-7)
    np.testing.assert_allclose(results["pin.reaction_force"][-1], [0.0, 0.0, force], rtol=1e-6, atol=1e-4)


def test_a_body_that_hangs_down_far_ends_with_its_own_code(tmp_path: Path) -> None:
    """Rubber under a weight that steel hardly feels; the report says so."""
    shutil.copyfile(Path(__file__).parents[1] / "small_beam.toml", tmp_path / "case.toml")
    soft = ("bodies.beam.material.young_modulus='1 MPa'", "gravity.acceleration=[0, 0, -9.81]")
    still = ("simulate.start='equilibrium'", "simulate.duration='10 ms'")
    report = run_case(load_case(tmp_path, (*soft, *still)))
    assert report.outcome is Outcome.MODES_LEFT
    assert "body 'beam' deforms by" in report.message
    assert (tmp_path / "out" / "report" / "report.html").is_file()
