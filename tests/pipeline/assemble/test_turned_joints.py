"""A case whose joint holds a direction that modes turn is refused at its joint, by every way that simulates it."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.case.places import in_case
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.pipeline.stages.stages import run_case
from heavylift.solver.layout import pack_scene

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


@pytest.mark.parametrize(("place", "refused"), [("200 mm", True), ("0 mm", False)])
def test_joint_at_the_tip_and_at_the_clamp(tmp_path: Path, place: str, refused: bool) -> None:
    folder = folder_of(tmp_path, place)
    run_case(load_case(folder), stages=("mesh", "modes"))
    case = load_case(folder)
    with in_case(case):
        if not refused:
            pack_scene(assemble_scene(case, OutputFolder(folder / "out")))
            return
        with pytest.raises(InputError) as caught, in_case(case):
            pack_scene(assemble_scene(case, OutputFolder(folder / "out")))
    assert caught.value.source == str(folder / "case.toml")
    assert caught.value.key == "joints.0"
    assert "(200, 0, 0) mm" in caught.value.problem
    assert "'ball' joint and three rods" in caught.value.expected


def test_a_body_that_hangs_down_far_ends_with_its_own_code(tmp_path: Path) -> None:
    """Rubber under a weight that steel hardly feels; the report says so."""
    shutil.copyfile(Path(__file__).parents[1] / "small_beam.toml", tmp_path / "case.toml")
    soft = ("bodies.beam.material.young_modulus='1 MPa'", "gravity.acceleration=[0, 0, -9.81]")
    still = ("simulate.start='equilibrium'", "simulate.duration='10 ms'")
    report = run_case(load_case(tmp_path, (*soft, *still)))
    assert report.outcome is Outcome.MODES_LEFT
    assert "body 'beam' deforms by" in report.message
    assert (tmp_path / "out" / "report" / "report.html").is_file()
