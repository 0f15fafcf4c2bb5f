"""Packages out of range are told in a line before anything of them is used."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from heavylift.pipeline.commands import doctor
from heavylift.pipeline.commands.requirements import Requirement, remedy, requirements, troubles

ROOT = Path(__file__).parents[3]
MAIN = "from heavylift.pipeline.commands.start import main; main()"


@pytest.mark.parametrize(
    ("version", "fits"),
    [
        ("0.61.0", False),
        ("0.61.99", False),
        ("0.62.0", True),
        ("0.62", True),
        ("0.68.1.post2", True),
        ("0.62.0rc1", True),
        ("0.69", False),
        ("0.69.0", False),
        ("0.100", False),
        ("1.0", False),
        ("1!0.65", True),
        (None, False),
    ],
)
def test_versions_are_compared_number_by_number(version: str | None, fits: bool) -> None:
    one = Requirement("numba", ">=0.62,<0.69", version)
    assert one.fits is fits
    assert troubles([one]) == ([] if fits else [one])


def test_what_is_needed_is_read_off_the_metadata() -> None:
    lines = ["numba<0.69,>=0.62", "no-such-package", "Pillow (>=1)", 'capytaine>=3.0; extra == "hydro"']
    numba, missing, pillow = requirements(lines)
    assert (numba.name, numba.range) == ("numba", ">=0.62,<0.69")
    assert missing == ("no-such-package", "", None)
    assert str(missing) == "no-such-package is not installed, expected any version"
    assert pillow.fits
    assert remedy([numba, missing]) == "pip install 'numba>=0.62,<0.69' 'no-such-package'"


def test_all_that_is_installed_here_fits() -> None:
    assert troubles() == []


def test_the_oldest_versions_that_are_tested_are_those_that_are_allowed() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    tested = dict(line.split("==") for line in (ROOT / "tests" / "oldest.txt").read_text().split())
    allowed = {}
    extras = project["optional-dependencies"]
    for line in [
        *project["dependencies"],
        *(line for key in ("data", "fmi", "serve") for line in extras[key]),
    ]:
        name, least = re.match(r"([\w-]+)>=([\d.]+)", line).groups()
        allowed[name] = least
    assert tested.keys() == allowed.keys()
    for name, least in allowed.items():
        assert (tested[name] + ".0.0").startswith(f"{least}."), name


@pytest.fixture
def other_numba(tmp_path: Path) -> dict[str, str]:
    """Environment in which a Numba that is too old comes first, and ends whoever imports it."""
    (tmp_path / "numba-0.61.0.dist-info").mkdir()
    (tmp_path / "heavylift-9.dist-info").mkdir()
    metadata = "Name: heavylift\nVersion: 9\nRequires-Dist: numba<0.69,>=0.62\n\nRequires-Dist: nonsense\n"
    (tmp_path / "heavylift-9.dist-info" / "METADATA").write_text(metadata)
    (tmp_path / "numba.py").write_text("raise ImportError('imported')\n")
    return {**os.environ, "PYTHONPATH": str(tmp_path)}


def test_a_version_out_of_range_is_one_line(other_numba: dict[str, str], tmp_path: Path) -> None:
    for tokens in (["run", "."], ["run", ".", "--json"], ["--version"]):
        done = subprocess.run(
            [sys.executable, "-c", MAIN, *tokens],
            check=False,
            env=other_numba,
            cwd=tmp_path,
            capture_output=True,
            text=True,
        )
        line = "numba 0.61.0, expected >=0.62,<0.69; pip install 'numba>=0.62,<0.69'"
        assert (done.returncode, done.stderr) == (2, line + "\n")
        if "--json" in tokens:
            assert json.loads(done.stdout)["error"] == line
    assert not list(tmp_path.glob("heavylift-fault*"))


def test_doctor_tells_what_is_out_of_range(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = [Requirement("numba", ">=0.62,<0.69", "0.61.0"), Requirement("rich", ">=13.6", None)]
    monkeypatch.setattr(doctor, "requirements", lambda: [*wrong, Requirement("numpy", ">=2.0", "2.1")])
    monkeypatch.setattr(doctor, "_attempt", lambda _code: {"works": True, "detail": "1.0", "remedy": ""})
    monkeypatch.setattr(doctor, "_blas", None)  # what needs packages is not asked
    found = doctor.diagnosis()
    assert not found["ready"]
    lines = "\n".join(doctor.diagnosis_lines(json.loads(json.dumps(found))))
    assert "OUT OF RANGE: numba 0.61.0, expected >=0.62,<0.69" in lines
    assert "OUT OF RANGE: rich is not installed, expected >=13.6" in lines
    assert "pip install 'numba>=0.62,<0.69' 'rich>=13.6'" in lines
    assert "numpy           2.1" in lines
    assert "NOT ready" in lines
