"""The example in the documentation of the sea is a case."""

from __future__ import annotations

import shutil
from pathlib import Path

from heavylift.pipeline import load_case

ROOT = Path(__file__).resolve().parents[3]


def test_the_example_is_a_valid_case(tmp_path):
    """As it stands, beside the database that it names."""
    text = (ROOT / "docs" / "sea.md").read_text(encoding="utf-8")
    (tmp_path / "case.toml").write_text(text.split("```toml")[1].split("```")[0], encoding="utf-8")
    shutil.copy(ROOT / "cases" / "transport_barge" / "barge.nc", tmp_path)
    case = load_case(tmp_path)
    assert set(case.hulls) == {"barge"}
    assert [line.name for line in case.lines] == ["bow", "stern"]
