"""The page on FMUs: its unit is written and stepped, and its piece of a case is one."""

import shutil
import sys
from pathlib import Path

import pytest

from heavylift.pipeline.assemble.early_checks import scene_errors
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.commands.cli import app

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests" / "pipeline" / "coupling"))
sys.path.insert(0, str(Path(__file__).parent))

pytest.importorskip("fmpy")
pytest.importorskip("msgpack")

from made_fmus import library, make_fmu  # noqa: E402
from test_guides import DOCS, blocks  # noqa: E402


def block(language):
    (found,) = [one.text for one in blocks(DOCS / "fmi.md") if one.language == language]
    return found


def test_the_piece_of_a_case_fits_the_lift_of_the_package(tmp_path):
    lift = (ROOT / "pipeline" / "templates" / "lift" / "case.toml").read_text(encoding="utf-8")
    (tmp_path / "case.toml").write_text(f"{lift}\n{block('toml')}", encoding="utf-8")
    make_fmu(tmp_path / "controller.fmu", 2, library(tmp_path, 2))
    case = load_case(tmp_path)
    assert case.fmus[0].writes == {"force": "pull"}
    assert scene_errors(case) == []


@pytest.mark.slow
def test_the_unit_of_the_page_prints_what_the_page_shows(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    shutil.copytree(
        ROOT / "cases" / "hoist", tmp_path / "cases" / "hoist", ignore=shutil.ignore_patterns("out")
    )
    words = block("sh").split()
    assert words[0] == "heavylift"
    assert app(words[1:], result_action="return_value") == 0
    capsys.readouterr()
    exec(compile(block("python"), "fmi.md", "exec"), {})  # noqa: S102
    assert capsys.readouterr().out == block("text")
