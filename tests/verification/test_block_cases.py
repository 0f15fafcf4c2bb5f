"""The block of plates and stiffeners on a crane: against moments, another program and its own drawing."""

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

BLOCK = Path(__file__).resolve().parents[2] / "cases" / "stiffened_block"


def test_the_case_is_what_the_script_writes(tmp_path):
    shutil.copytree(BLOCK, tmp_path / "block", ignore=shutil.ignore_patterns("out"))
    spec = importlib.util.spec_from_file_location("make_block_case", tmp_path / "block" / "make_case.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    (tmp_path / "block" / "case.toml").unlink()
    script.write_case()
    assert (tmp_path / "block" / "case.toml").read_text() == (BLOCK / "case.toml").read_text()


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_every_check_and_criterion_passes(tmp_path):
    """And none of them is missing."""
    verdict = verify_case(BLOCK, out=tmp_path, overrides=(), force=True, log=Log(quiet=True))
    assert verdict.outcome is Outcome.COMPLETED, (
        verdict.message,
        [c for c in verdict.checks if not c.passed],
    )
    assert len(verdict.checks) == 10
    judged = judged_criteria(load_case(BLOCK), tmp_path)
    assert [one.name for one in judged if one.passed] == ["yield"]


@pytest.mark.slow
def test_a_run_goes_on_bit_for_bit(tmp_path):
    folder = tmp_path / "block"
    shutil.copytree(BLOCK, folder, ignore=shutil.ignore_patterns("out"))
    case = load_case(folder)
    run_case(case, stages=("mesh", "modes"))
    scene = assemble_scene(case, OutputFolder(case.output_folder))

    def made():
        return Simulation(scene, case.simulate.step, record_every=50, start="equilibrium")

    whole, first, second = made(), made(), made()
    whole.record()
    first.record()
    rows = whole.advance(2000)[1]
    start = first.advance(1000)[1]
    second.restore(first.state())
    np.testing.assert_array_equal(np.vstack([start, second.advance(1000)[1]]), rows)
