"""Cases to begin with: each is written, runs, passes its checks, and shows a picture; what is refused."""

import os
import re
import resource
import subprocess
import sys
from pathlib import Path

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.commands.cli import app
from heavylift.pipeline.commands.new_case import new_case, template_kinds

KINDS = ("barge", "contact", "flexible-body", "lift")


def test_there_is_a_kind_for_each_subject() -> None:
    assert tuple(template_kinds()) == KINDS


@pytest.mark.parametrize("kind", KINDS)
def test_a_case_is_sound_and_says_what_it_means(kind: str, tmp_path: Path) -> None:
    case_file, readme = new_case(kind, tmp_path / "mine")
    case = load_case(case_file.parent)
    assert case.simulate is not None
    assert len(case.check) >= 3
    for check in case.check:  # its README says where each reference comes from
        assert f"`{check.id}`" in readme.read_text()
    lines = case_file.read_text().splitlines()
    assert sum("#" in line for line in lines) >= 10
    # what README and comments point to is there
    for name in re.findall(r"docs/\w+\.md", readme.read_text() + case_file.read_text()):
        assert (Path(__file__).parents[3] / name).is_file(), name


def run(*words: str) -> int:
    return int(app(list(words), exit_on_error=False, result_action="return_value"))


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_new_case_runs_and_passes_and_shows_the_scene(
    kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "mine"
    assert run("new", kind, str(folder)) == 0
    assert f"heavylift run {folder}" in capsys.readouterr().out
    assert run("run", str(folder)) == 0
    spec = capsys.readouterr().out
    assert re.search(r"Passed: all \d checks", spec)
    assert run("verify", str(folder)) == 0
    if "no pictures" not in (folder / "out" / "report" / "report.md").read_text().lower():
        picture = "beam_stress_mode_1.png" if kind == "flexible-body" else "scene_end.png"
        assert (folder / "out" / "report" / picture).stat().st_size > 5000


@pytest.mark.slow
def test_a_first_lift_compiles_what_it_needs_and_no_more(tmp_path: Path) -> None:
    """With an empty cache: the kinds of the scene, in less than a minute of one processor."""
    environment = {**os.environ, "HEAVYLIFT_CACHE_DIR": str(tmp_path / "cache")}
    main = "from heavylift.pipeline.commands.start import main; main()"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    for words in (("new", "lift", "demo"), ("run", "demo")):
        command = [sys.executable, "-c", main, *words]
        done = subprocess.run(
            command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True
        )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    (compiled,) = re.findall(r"compiling \d+ parts that are used for the first time: (.*)", done.stdout)
    assert set(compiled.split(", ")) == {
        "RigidBodies",
        "Ropes",
        "RowSystem1",
        "StepCounts",
        "UniformGravity",
        "the time loop",
    }
    assert "report: Passed: all 4 checks." in done.stdout
    assert (tmp_path / "demo" / "out" / "report" / "scene_end.png").is_file()
    assert after.ru_utime - before.ru_utime < 60.0


def test_without_a_kind_there_is_a_list(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("new") == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == list(KINDS)


def test_what_is_there_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match="expected a new or empty folder"):
        new_case("lift", tmp_path)
    with pytest.raises(InputError, match="is a file"):
        new_case("lift", tmp_path / "notes.txt")
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_an_unknown_kind_is_one_line_with_all_kinds(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        new_case("lft", tmp_path / "mine")
    assert str(caught.value) == f"new: kind: 'lft', perhaps 'lift'; expected one of {', '.join(KINDS)}"
    assert not (tmp_path / "mine").exists()


def test_package_data_names_what_the_templates_hold() -> None:
    """What is not named is not installed: only in a checkout would the command work."""
    import tomllib

    root = Path(__file__).parents[3]
    data = tomllib.loads((root / "pyproject.toml").read_text())["tool"]["setuptools"]["package-data"]
    folder = root / "pipeline" / "templates"
    named = {path for pattern in data["heavylift.pipeline.templates"] for path in folder.glob(pattern)}
    assert named == {
        path for path in folder.glob("*/*") if path.is_file() and "__pycache__" not in path.parts
    }
