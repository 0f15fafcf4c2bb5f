"""`heavylift eigen`: tables, files, times, and what is refused."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from heavylift.pipeline.commands.cli import app
from heavylift.pipeline.stepping.simulation import Simulation

CASE = """
title = "a load on a rope"
sources = ["a test"]

[gravity]
acceleration = [0, 0, "-9.81 m/s^2"]

[bodies.load]
type = "rigid"
mass = "10 t"
inertia = [1e4, 1e4, 1e4]
frame = { motion = "free" }

[[ropes]]
name = "hoist"
axial_stiffness = "50 MN"
path = [{ body = "ground", point = [0, 0, "20 m"] }, { body = "load", point = [0, 0, 0] }]

[[inputs]]
type = "force"
name = "push"
body = "load"
point = [0, 0, 0]
direction = [1, 0, 0]

[simulate]
step = "10 ms"
output_interval = "100 ms"
duration = "2 s"
"""


@pytest.fixture
def case(tmp_path: Path) -> Path:
    (tmp_path / "case").mkdir()
    (tmp_path / "case" / "case.toml").write_text(CASE, encoding="utf-8")
    return tmp_path / "case"


def run(*words: object) -> int:
    code = app([str(word) for word in ("eigen", *words)], result_action="return_value")
    return int(code)


def test_files_and_table(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Table, JSON, CSV and matrices say one thing."""
    assert run(case, "--at", "rest", "--output", "hoist.tension", "--output", "load.position") == 0
    out = capsys.readouterr().out
    sway = np.sqrt(9.81 / (20.0 * (1.0 + 98.1e3 / 50e6))) / (2.0 * np.pi)
    assert f"{sway:8.4g} Hz" in out
    assert out.count("free") == 3
    folder = case / "out" / "eigen"
    document = json.loads((folder / "modes.json").read_text(encoding="utf-8"))
    assert document["modes"][3]["frequency"] == pytest.approx(sway, rel=1e-8)
    assert document["units"]["frequency"] == "Hz"
    assert document["outputs"][0] == {"name": "hoist.tension", "unit": "N"}
    with (folder / "modes.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert float(rows[3]["frequency_Hz"]) == pytest.approx(sway, rel=1e-8)
    with np.load(folder / "matrices.npz") as found:
        A, B, C = found["A"], found["B"], found["C"]
        states, outputs = found["states"].tolist(), found["outputs"].tolist()
        assert outputs == ["hoist.tension", *(f"load.position.{axis}" for axis in "xyz")]
        assert found["input_units"].tolist() == ["N"]
        assert B[states.index("load.velocity.x"), 0] == pytest.approx(1e-4, rel=1e-8)
        assert C[1, states.index("load.x")] == pytest.approx(1.0)
        assert A[states.index("load.velocity.x"), states.index("load.x")] == pytest.approx(
            -((2.0 * np.pi * sway) ** 2), rel=1e-8
        )
        assert found["displacements"].shape == (1, 6, 3)


def test_at_a_time_it_is_what_stepping_gives(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The state of the run there; a start that is not in balance is said to be none."""
    assert run(case, "--at", "1.5", "--json") == 0
    document = json.loads(capsys.readouterr().out)
    simulation = Simulation(case)
    simulation.step(1.5)
    expected = simulation.linearise()
    found = [mode["frequency"] for mode in document["modes"]]
    assert found == expected.frequencies.tolist()
    assert document["time"] == pytest.approx(1.5)
    assert "not in balance" in document["warnings"][0]


def test_a_page_of_a_mode(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The scene swings in it; its heading says in which."""
    assert run(case, "--at", "rest", "--draw", "4") == 0
    capsys.readouterr()
    page = (case / "out" / "eigen" / "mode_4.html").read_text(encoding="utf-8")
    assert "Mode 4: 0.1114 Hz, period 8.98 s, damping" in page


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--at", "1.234567"), "expected a multiple of 0.01 s"),
        (("--at", "3"), "expected start, rest, or a time from 0 to 2 s"),
        (("--at", "later"), "expected start, rest, or a time from 0 to 2 s"),
        (("--output", "hoist.tensoin"), "no output 'hoist.tensoin'; expected 'hoist.tension'"),
        (("--input", "pull"), "'pull' is no input"),
        (("--count", "0"), "0; expected 1 or more modes"),
        (("--draw", "7"), "7; expected a mode from 1 to 6"),
        (("--set", "simulate.integrator=thesis"), "thesis"),
    ],
)
def test_bad_input(
    case: Path, words: tuple[str, ...], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """One line each, and exit code 2."""
    assert run(case, *words) == 2
    said = capsys.readouterr().err
    assert message in said
    assert len(said.splitlines()) == 1
