"""A case may come from someone else: no file beside it is run as code, whatever it is called."""

from __future__ import annotations

import ast
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

import pytest

from heavylift.pipeline.commands import current_folder
from heavylift.pipeline.commands.cli import app

CASES, ROOT = Path(__file__).parents[1], Path(__file__).parents[3]
SOURCES = ("numerics", "preprocess", "modal", "contours", "solver", "pipeline")
NAMES = sorted(
    {name for name in sys.stdlib_module_names if name not in sys.builtin_module_names}
    | {name.partition(".")[0] for name in metadata.packages_distributions()}
    | {"heavylift", "sitecustomize", "usercustomize", "yaml", "readline"}
)
TRAP = "import os\nwith open({told!r}, 'a') as file:\n    file.write({name!r} + '\\n')\n"


class Folder(NamedTuple):
    """A case folder full of traps.

    Attributes
    ----------
    place
        Of the case.
    told
        File in which the traps write that they ran.
    script
        The command as `pip` installs it.
    """

    place: Path
    told: Path
    script: Path

    def command(self, *tokens: str) -> list[str]:
        """The command, as a shell would find it."""
        return [sys.executable, str(self.script), *tokens]

    def ran(self) -> str:
        """Names of the traps that ran."""
        return self.told.read_text() if self.told.exists() else ""


def trapped(tmp_path: Path, case: str) -> Folder:
    """A folder with a case, modules and packages of all names, and settings that tell when they are read."""
    place, told = tmp_path / "case", tmp_path / "told"
    place.mkdir()
    for number, name in enumerate(NAMES):
        if not name.isidentifier():
            continue
        file = place / f"{name}.py"
        if number % 2:
            (place / name).mkdir(exist_ok=True)
            file = place / name / "__init__.py"
        file.write_text(TRAP.format(told=str(told), name=name))
    (place / "matplotlibrc").write_text("no.such.setting : 1\n")
    (place / ".numba_config.yaml").write_text("[no: yaml\n")
    shutil.copyfile(CASES / case, place / "case.toml")
    script = tmp_path / "bin" / "heavylift"
    script.parent.mkdir()
    script.write_text("from heavylift.pipeline.commands.start import main\nmain()\n")
    return Folder(place, told, script)


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    """With a small clamped bar."""
    return trapped(tmp_path, "small_beam.toml")


def run(folder: Folder, *tokens: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a command in the folder; neither a trap nor a file of settings is read."""
    done = subprocess.run(
        folder.command(*tokens),
        cwd=folder.place,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=500,
        check=False,
    )
    assert folder.ran() == "", tokens
    assert "no.such.setting" not in done.stderr
    assert "Numba config" not in done.stderr
    assert done.returncode != 70, done.stderr
    return done


COMMANDS = {
    "mesh": (".",),
    "modes": (".",),
    "simulate": (".",),
    "report": (".",),
    "run": (".", "--force"),
    "verify": (".",),
    "criteria": (".",),
    "converge": (".",),
    "scenario": (".",),
    "schema": ("simulate",),
    "new": ("lift", "made"),
    "draw": (".",),
    "export": (".",),
    "statistics": (".",),
    "hydrostatics": (".",),
    "database": (".",),
    "lines": (".",),
    "rao": (".",),
    "ballast": (".",),
    "eigen": (".",),
    "serve": (".", "--pipe"),
    "fmu": (".",),
    "couple": (".",),
    "doctor": (),
    "compile": ("RowJoints", "PointForces", "UniformGravity", "--force"),
}
"""Tokens of every command; `view` has a test of its own."""


def test_every_command_is_in_the_list() -> None:
    known = {name for name in app if not name.startswith("-")}
    assert known == {*COMMANDS, "view"}


@pytest.mark.slow
def test_no_command_runs_what_stands_beside_a_case(folder: Folder) -> None:
    ended = {name: run(folder, name, *tokens).returncode for name, tokens in COMMANDS.items()}
    for name in ("mesh", "modes", "simulate", "report", "run", "schema", "new", "draw", "compile", "doctor"):
        assert ended[name] == 0, name


@pytest.mark.slow
@pytest.mark.parametrize("case", ["sea.toml", "collisions.toml"])
def test_no_stage_runs_what_stands_beside_a_case(tmp_path: Path, case: str) -> None:
    folder = trapped(tmp_path, case)
    for name in ("run", "hydrostatics", "database", "lines", "rao", "statistics", "export"):
        run(folder, name, ".")


@pytest.mark.slow
def test_view_and_the_run_that_it_starts(folder: Folder) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    child = subprocess.Popen(
        folder.command("view", ".", "--port", str(port)), cwd=folder.place, stdout=subprocess.DEVNULL
    )
    try:
        results = folder.place / "out"
        for _ in range(1200):
            time.sleep(0.25)
            try:
                page = urllib.request.urlopen(f"http://127.0.0.1:{port}/progress", timeout=10).read()
            except urllib.error.URLError:
                continue
            if b'"running": false' in page and results.is_dir():
                break
        urllib.request.urlopen(f"http://127.0.0.1:{port}/data", timeout=10).read()
    finally:
        child.send_signal(signal.SIGINT)
        assert child.wait(60) == 0
    assert folder.ran() == ""
    assert (folder.place / "out" / "report").is_dir()


SPAWNS = """
import multiprocessing
from heavylift.pipeline.commands.current_folder import distrust_current_folder

def double(number):
    return 2 * number

if __name__ == "__main__":
    distrust_current_folder()
    for way in ("spawn", "forkserver"):
        with multiprocessing.get_context(way).Pool(1) as pool:
            print(pool.map(double, [1, 2]))
"""


def test_processes_that_libraries_start(folder: Folder) -> None:
    folder.script.write_text(SPAWNS)
    done = run(folder)
    assert done.stdout == "[2, 4]\n[2, 4]\n", done.stderr


def test_settings_of_libraries_are_not_read_from_the_current_folder(folder: Folder) -> None:
    folder.script.write_text(
        "import os\n"
        "from heavylift.pipeline.commands.current_folder import distrust_current_folder\n"
        "distrust_current_folder()\n"
        "before = os.getcwd()\n"
        "import matplotlib, heavylift.numerics.small, numba, numpy\n"
        "assert os.getcwd() == before\n"
        "print(matplotlib.matplotlib_fname() and numba.njit(lambda x: x + 1)(1))\n"
    )
    assert run(folder).stdout == "2\n"


@pytest.mark.skipif(not hasattr(os, "O_PATH"), reason="no way to hold a folder that cannot be listed")
def test_settings_are_not_read_from_a_folder_that_cannot_be_listed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its files can be read by name all the same; the user who tests may be one to whom no folder is closed."""
    opened = os.open

    def closed(path: str, flags: int) -> int:
        if not flags & os.O_PATH:
            raise PermissionError(13, "Permission denied", path)
        return opened(path, flags)

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(current_folder.os, "open", closed)
    with current_folder._neutral_folder():
        assert Path.cwd() == Path(os.sep)
    assert Path.cwd() == tmp_path


def test_an_empty_entry_in_the_path_of_modules_is_no_way_in_for_children(folder: Folder) -> None:
    folder.script.write_text(
        "import subprocess, sys\n"
        "from heavylift.numerics.children import NEUTRAL_FOLDER, python_command\n"
        "import os; os.environ['PYTHONPATH'] = os.pathsep\n"
        "subprocess.run(python_command('-c', 'import json, numpy'), cwd=NEUTRAL_FOLDER, check=True)\n"
    )
    run(folder)


def test_every_process_is_started_by_the_one_command() -> None:
    """No other place of the sources names the interpreter in a command."""
    found = []
    for file in [file for name in SOURCES for file in (ROOT / name).rglob("*.py")]:
        for node in ast.walk(ast.parse(file.read_text())):
            first = node.elts[:1] if isinstance(node, (ast.List, ast.Tuple)) else []
            if first and ast.unparse(first[0]) in {"sys.executable", "'python'", "'python3'"}:
                found.append(file.name)
    assert found == ["children.py"]
