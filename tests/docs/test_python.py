"""The guide on Python: its examples print what it shows; what it documents is what there is, with examples that run."""

from __future__ import annotations

import doctest
import re
import shutil
import subprocess
import sys
from enum import IntEnum

import pytest
from where import ROOT

import heavylift as hl
from heavylift.pipeline.model.components import component_names

PAGE = ROOT / "docs" / "python.md"
SECTIONS = re.split(r"^(?=## )", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
CASES = ("hoist", "irregular_sea", "complex_beam")
SLOW = {6}  # a fine mesh
TABLES = {8}  # xarray and pandas


class Guide:
    """Runs examples of the page in its order, each once, in one program and one folder."""

    def __init__(self) -> None:
        self.names: dict[str, object] = {}
        self.done = 0

    def run(self, number: int, capsys: pytest.CaptureFixture[str]) -> int:
        """Texts that an example shows, each of which is what it prints."""
        shown, printed = 0, ""
        for language, text in re.findall(
            r"^```(\w+)\n(.*?)^```", SECTIONS[number - 1], re.MULTILINE | re.DOTALL
        ):
            if language == "python":
                capsys.readouterr()
                exec(compile(text, "python.md", "exec"), self.names)  # noqa: S102
                printed = capsys.readouterr().out
            else:
                assert language == "text"
                assert printed == text
                shown += 1
        return shown


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with the cases that the page names."""
    made = tmp_path_factory.mktemp("python")
    for name in CASES:
        shutil.copytree(ROOT / "cases" / name, made / "cases" / name, ignore=shutil.ignore_patterns("out"))
    return made


@pytest.fixture(scope="module")
def guide():
    return Guide()


@pytest.mark.parametrize(
    "number",
    [pytest.param(n, marks=pytest.mark.slow) if n in SLOW else n for n in range(1, len(SECTIONS) + 1)],
)
def test_an_example_prints_what_it_shows(number, guide, folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    if number in TABLES:
        pytest.importorskip("xarray")
        pytest.importorskip("pandas")
    if number in SLOW:
        alone = Guide()
        exec("import heavylift as hl\nimport numpy as np", alone.names)  # noqa: S102
        assert alone.run(number, capsys) == 1
        return
    for earlier in range(guide.done + 1, number):
        if earlier not in SLOW | TABLES:
            guide.run(earlier, capsys)
    shown = guide.run(number, capsys)
    assert shown >= 1 or number == 9
    guide.done = number


def test_there_are_ten_examples():
    assert [re.match(r"## (\d+)\. ", section)[1] for section in SECTIONS] == [str(n) for n in range(1, 11)]


def test_what_is_public_is_documented():
    table = re.findall(r"^\| (`[^|]+) \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    named = {name for row in table for name in re.findall(r"`(\w+)`", row)}
    assert named == set(vars(hl)["_HOMES"])
    used = set(re.findall(r"\bhl\.(\w+)", PAGE.read_text(encoding="utf-8")))
    assert used <= {*named, *component_names()}


@pytest.mark.parametrize(
    "name",
    [  # another process takes its time to begin
        pytest.param(name, marks=pytest.mark.slow) if "exchange" in home else name
        for name, home in vars(hl)["_HOMES"].items()
    ],
)
def test_what_is_public_has_an_example_that_runs(name, folder, monkeypatch):
    monkeypatch.chdir(folder)
    if "exchange" in vars(hl)["_HOMES"][name]:
        pytest.importorskip("msgpack")
    found = getattr(hl, name)
    finder = doctest.DocTestFinder(exclude_empty=False)
    tests = [one for one in finder.find(found, name, module=False) if one.examples]
    assert found.__doc__.strip()
    assert tests or issubclass(found, (Exception, IntEnum)), f"{name} has no example"
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    for one in tests:
        one.globs = {}
        runner.run(one)
    assert runner.failures == 0


@pytest.mark.slow
def test_the_examples_have_the_types_that_editors_see(tmp_path):
    pytest.importorskip("mypy")
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    program, wrong = tmp_path / "guide.py", tmp_path / "wrong.py"
    program.write_text("\n".join(blocks), encoding="utf-8")
    wrong.write_text(
        'import heavylift as hl\n\nhl.Rope("hoist", pth=[], axial_stiffness="1 MN")\n', encoding="utf-8"
    )
    command = [sys.executable, "-m", "mypy", str(program), str(wrong)]
    found = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    errors = [line for line in found.stdout.splitlines() if ": error:" in line]
    assert len(errors) == 1, found.stdout + found.stderr
    assert 'Unexpected keyword argument "pth" for "Rope"; did you mean "path"?' in errors[0]
