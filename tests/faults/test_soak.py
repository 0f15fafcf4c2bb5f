"""The program of faults by the hundred finds its parts, and each says what it does."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

PROGRAM = Path(__file__).with_name("soak.py")


def _part(name):
    spec = importlib.util.spec_from_file_location(f"soak_{name}", PROGRAM.with_name(f"soak_{name}.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_every_part_can_be_asked_for():
    names = [path.stem.removeprefix("soak_") for path in PROGRAM.parent.glob("soak_*.py")]
    done = subprocess.run(
        [sys.executable, str(PROGRAM), "--help"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    for name in names:
        assert f"\n    {name} " in done.stdout


def test_a_bit_and_a_missing_array_are_differences(tmp_path):
    kills = _part("kills")
    (tmp_path / "simulate").mkdir()
    (tmp_path / "mesh").mkdir()
    found = []
    for values in ({"a": 1.0, "b": 2.0}, {"a": np.nextafter(1.0, 2.0)}):
        with h5py.File(tmp_path / "simulate" / "results.h5", "w") as file:
            for name, value in values.items():
                file[name] = value
        found.append(kills.content(tmp_path))
    assert kills._differences(*found) == [
        "simulate/results.h5: a is not the same",
        "simulate/results.h5: b is not there",
    ]
    assert kills._differences(found[0], found[0]) == []


@pytest.mark.slow
def test_runs_that_are_killed_leave_nothing_else_than_others():
    done = subprocess.run(
        [sys.executable, str(PROGRAM), "kills", "--count", "20"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"^kills +20$", done.stdout, re.MULTILINE)
