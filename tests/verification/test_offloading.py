"""The off-loading of a block in six seas: what its generator writes, and its checks against linear theory."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.commands.verify import verify_case
from heavylift.pipeline.log import Log

CASE = Path(__file__).resolve().parents[2] / "cases" / "block_offloading"


def test_files_are_what_the_generator_writes() -> None:
    spec = importlib.util.spec_from_file_location("make_case_block_offloading", CASE / "make_case.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    stored = {file.name: file.read_text(encoding="utf-8") for file in CASE.glob("*.toml")}
    assert stored == module.files()


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize("name", ["held_2", "small_2", "small_4", "wave_1", "wave_4", "constant_2"])
def test_strokes_and_verdicts(name: str, tmp_path: Path) -> None:
    """All together by linear theory 2 %, hulls alone by a prototype 3 %, whole crossings and their verdicts."""
    verdict = verify_case(CASE / f"{name}.toml", out=tmp_path, overrides=(), force=False, log=Log(quiet=True))
    assert verdict.checks
    assert all(check.passed for check in verdict.checks), verdict
    assert not verdict.missed
    passed = all(line.passed for line in verdict.criteria)
    assert verdict.outcome is (Outcome.COMPLETED if passed else Outcome.CHECK_FAILED), verdict
