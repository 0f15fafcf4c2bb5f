"""Plates from CAD on cranes and transporters: cases against statics, and runs that go on from where they were cut."""

from __future__ import annotations

import importlib.util
import shutil
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline import load_case, run_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.commands.verify import verify_case
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.simulation import Simulation
from tests.pipeline.judged import judged_criteria

CASES = Path(__file__).resolve().parents[2] / "cases"
SCRIPT = CASES / "cad_block_on_gantry" / "make_block.py"


def made_by_the_script():
    spec = importlib.util.spec_from_file_location("make_block", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    "name", ["cad_block_on_gantry", "cad_module_from_barge", "cad_module_on_transporters"]
)
def test_the_block_is_what_the_script_writes(name):
    script = made_by_the_script()
    assert (CASES / name / "block.stl").read_bytes() == script.stl(script.triangles())


def test_the_block_is_open_and_has_the_area_of_its_plates():
    corners = made_by_the_script().triangles()
    area = (
        0.5
        * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
    )
    walls = 2 * 12.0 * 4.0 + 3 * 8.0 * 4.0
    assert area == pytest.approx(
        12.0 * 8.0 + walls + (12.0 * 8.0 - 4.0 * 2.0) + 0.5 * 2 * (4.0 + 2.0), rel=1e-12
    )


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize(
    ("name", "count"),
    [("cad_block_on_gantry", 8), ("cad_module_from_barge", 7), ("cad_module_on_transporters", 8)],
)
def test_every_check_and_criterion_passes(name, count, tmp_path):
    """And none of them is missing."""
    if name == "cad_module_from_barge":
        pytest.importorskip("capytaine")
    verdict = verify_case(CASES / name, out=tmp_path, overrides=(), force=True, log=Log(quiet=True))
    assert verdict.outcome is Outcome.COMPLETED, (
        verdict.message,
        [c for c in verdict.checks if not c.passed],
    )
    assert len(verdict.checks) == count
    case = load_case(CASES / name)
    judged = judged_criteria(case, tmp_path)
    assert judged
    assert all(one.passed for one in judged), [one.name for one in judged if not one.passed]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "before"),
    [("cad_block_on_gantry", 2000), ("cad_module_from_barge", 2000), ("cad_module_on_transporters", 2500)],
)
def test_a_run_goes_on_from_the_middle_of_a_phase_bit_for_bit(name, before, tmp_path):
    """Contacts of plates, phases, winches and paths, memory of the water: all that a continuation has to carry."""
    if name == "cad_module_from_barge":
        pytest.importorskip("capytaine")
    folder = tmp_path / name
    shutil.copytree(CASES / name, folder, ignore=shutil.ignore_patterns("out"))
    case = load_case(folder)
    run_case(case, stages=("mesh",))
    options = {"start": case.simulate.start} if case.simulate.start != "check" else {}

    def made():
        scene = assemble_scene(case, OutputFolder(case.output_folder))
        return Simulation(scene, case.simulate.step, record_every=50, **options)

    whole, first, second = made(), made(), made()
    whole.record()
    first.record()
    rows = whole.advance(2 * before)[1]
    start = first.advance(before)[1]
    second.restore(first.state())
    np.testing.assert_array_equal(np.vstack([start, second.advance(before)[1]]), rows)


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_a_module_comes_to_rest_on_transporters_that_are_to_drive_at_once(tmp_path):
    """Moments of 110 t over two axles, and the weight of what stands loose; it goes on bit for bit from there."""
    folder = tmp_path / "case"
    shutil.copytree(CASES / "cad_module_on_transporters", folder, ignore=shutil.ignore_patterns("out"))
    case = load_case(folder)
    run_case(case, stages=("mesh",))
    scene = assemble_scene(case, OutputFolder(case.output_folder))

    def made():
        return Simulation(scene, case.simulate.step, record_every=10, start="equilibrium")

    whole, first, second = made(), made(), made()
    row = whole.record()
    column = {channel.name: channel.column for channel in whole.channels}
    x = 80.0 * 0.6 / 110.0
    axle = 110e3 * 9.81 / 24.0 * np.array([1.0 + x / 2.4, 1.0 - x / 2.4])
    forces = row[column["spmt.group_force"] + np.arange(4)]
    np.testing.assert_allclose(forces, np.repeat(axle, 2), rtol=5e-3)
    assert row[column["seat.normal_force"]] == pytest.approx(80e3 * 9.81, rel=1e-3)
    first.record()
    rows = whole.advance(200)[1]
    start = first.advance(100)[1]
    second.restore(first.state())
    np.testing.assert_array_equal(np.vstack([start, second.advance(100)[1]]), rows)
    later = rows[:, column["spmt.group_force"] + np.arange(4)]
    np.testing.assert_allclose(later, np.tile(forces, (len(rows), 1)), rtol=1e-3)
