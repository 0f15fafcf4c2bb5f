"""The example in the documentation of the sea is a case."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from heavylift.pipeline import load_case
from heavylift.pipeline.commands.ballast import ballast_command
from heavylift.pipeline.log import Log

ROOT = Path(__file__).resolve().parents[3]


def test_the_example_is_a_valid_case(tmp_path):
    """As it stands, beside the database that it names."""
    text = (ROOT / "docs" / "sea.md").read_text(encoding="utf-8")
    (tmp_path / "case.toml").write_text(text.split("```toml")[1].split("```")[0], encoding="utf-8")
    shutil.copy(ROOT / "cases" / "transport_barge" / "barge.nc", tmp_path)
    case = load_case(tmp_path)
    assert set(case.hulls) == {"barge"}
    assert [line.name for line in case.lines] == ["bow", "stern"]


@pytest.mark.slow
def test_the_example_of_ballast_has_a_plan(tmp_path):
    """Two tanks take the moment of the load, and its mass where no draft is said stays aboard."""
    text = (ROOT / "docs" / "sea.md").read_text(encoding="utf-8")
    example = next(block for block in text.split("```toml")[1:] if "[[pumps]]" in block)
    (tmp_path / "case.toml").write_text(example.split("```")[0], encoding="utf-8")
    case = load_case(tmp_path)
    assert [pump.target for pump in case.pumps] == ["aft", "fore"]
    found = ballast_command(tmp_path, out=tmp_path / "out", log=Log(quiet=True))[0]
    changes = found["stages"][1]["changes"]
    assert abs(changes["aft"] - changes["fore"] - 400e3 * 20.0 / 39.0) < 1.0
    assert abs(changes["aft"] + changes["fore"]) < 1.0
