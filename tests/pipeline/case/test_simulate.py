"""What a case says of time integration reaches the solver, and what the solver says of itself reaches the user."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline import load_case, run_case
from heavylift.pipeline.case.places import in_case
from heavylift.pipeline.log import Log
from heavylift.solver import simulation as solver

ADAPTIVE = ("simulate.step=",)


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "linkage"
    folder.mkdir()
    shutil.copyfile(Path(__file__).parents[1] / "linkage.toml", folder / "case.toml")
    return folder


@pytest.mark.parametrize(
    ("overrides", "step", "every", "count", "tolerance"),
    [
        ((), 1e-3, 10, 1000, None),
        (("simulate.integrator=thesis",), 1e-3, 10, 1000, None),
        ((*ADAPTIVE, "simulate.tolerance=1e-4"), 1e-2, 1, 100, 1e-4),
        ((*ADAPTIVE, "simulate.integrator=accurate"), 1e-2, 1, 100, 1e-7),
        ((*ADAPTIVE, "simulate.integrator=accurate", "simulate.tolerance=1e-9"), 1e-2, 1, 100, 1e-9),
        ((*ADAPTIVE, "simulate.integrator=auto"), 1e-2, 1, 100, 1e-5),
        (("simulate.integrator=auto",), 1e-3, 10, 1000, None),
    ],
)
def test_with_a_tolerance_the_solver_counts_output_intervals(
    folder, overrides, step, every, count, tolerance
):
    section = load_case(folder, overrides).simulate
    assert (section.solver_step, section.record_every) == (step, every)
    assert section.interval_count * section.record_every == count
    assert section.solver_tolerance == tolerance


class Recorded:
    """Stands for the solver: notes how it was made, and tells what the contract lets it tell."""

    made: ClassVar[list] = []

    def __init__(self, scene, step, integrator, **options):
        self.made.append((scene, step, integrator, options))
        self.step, self.record_every = step, options["record_every"]
        self.integrator, self.choice = "dele2", "auto chose dele2: the springs are stiff."
        self.start_text, self.warning = "joints were closed by 1 mm", "another integrator is faster"
        self.diagnosis = SimpleNamespace(
            degrees_of_freedom=1, redundant=tuple(f"joint 'j{i}'" for i in range(7)), free_motions=()
        )
        self.step_index = self.solver_steps = 0
        self.compile_seconds = self.cpu_seconds = 0.0
        self.start_seconds, self.energy_drift = 0.25, 0.0
        self.outcome, self.message = Outcome.COMPLETED, ""
        self.operation, self.ended, self.energy_drift, self.periods = None, False, 0.0, ""
        names = ("kinetic", "elastic", "balance")
        self.channels = [
            SimpleNamespace(name=f"energy.{name}", unit="J", components=(name,), column=i, sentence="")
            for i, name in enumerate(names)
        ]

    @property
    def verdict(self):
        return self.outcome, self.message

    def missing_units(self):
        return ()

    def warm_up(self):
        pass

    def record(self):
        return np.array([1.0, 0.0, 1.0])

    def advance(self, steps):
        first = self.step_index
        self.step_index += steps
        self.solver_steps += 3 * steps
        self.cpu_seconds += 3e-6 * steps
        return self.step * np.arange(first + 1, first + steps + 1), np.tile(self.record(), (steps, 1))

    def state(self):
        return {"step_index": np.array(self.step_index)}


def test_the_stage_passes_on_what_is_used_and_reports_what_it_is_told(folder, monkeypatch, capsys):
    monkeypatch.setattr(solver, "Simulation", Recorded)
    case = load_case(folder, [*ADAPTIVE, "simulate.integrator=auto", "simulate.start=project"])
    report = run_case(case, stages=("simulate",), log=Log())
    scene, step, integrator, options = Recorded.made.pop()
    assert len(scene.joints) == 3
    assert (step, integrator) == (1e-2, "auto")
    assert options == {"record_every": 1, "tolerance": 1e-5, "start": "project"}
    details = report.stage("simulate").details
    assert details["steps"] == 300
    assert details["step_us"] == pytest.approx(1.0)
    assert (details["start_s"], details["cpu_s"]) == pytest.approx((0.25, 0.25 + 300e-6))
    assert (details["integrator"], details["degrees_of_freedom"]) == ("dele2", 1)
    manifest = json.loads((folder / "out" / "simulate" / "manifest.json").read_text())
    assert manifest["details"]["redundant"][6] == "joint 'j6'"
    text = capsys.readouterr().out
    assert "auto chose dele2: the springs are stiff." in text
    assert "1 degree of freedom; redundant: joint 'j0', joint 'j1', " in text
    assert "and 2 more" in text
    assert "joints were closed by 1 mm" in text
    assert "another integrator is faster" in text
    assert "300 steps" in text


def test_without_new_keys_the_solver_is_called_as_before(folder, monkeypatch):
    monkeypatch.setattr(solver, "Simulation", Recorded)
    run_case(load_case(folder), stages=("simulate",))
    assert Recorded.made.pop()[1:] == (1e-3, "dele2", {"record_every": 10})


def test_an_error_of_the_solver_names_the_place_in_the_file(folder):
    case = load_case(folder)
    for error, key in (
        (InputError("0.1 m off", source="stay", key="length", expected="a closed joint"), "joints.2.length"),
        (InputError("0.1 m off", source="scene", key="fall", expected="a longer rope"), "ropes.0"),
        (InputError("too small", source="simulation", key="step", expected="more"), "simulate.step"),
    ):
        with pytest.raises(InputError) as caught, in_case(case):
            raise error
        assert str(caught.value).startswith(f"{folder / 'case.toml'}: {key}: ")
        assert caught.value.expected == error.expected


@pytest.mark.parametrize(
    ("overrides", "key"),
    [
        (("simulate.step=1e-300",), "simulate.step"),
        (
            (*ADAPTIVE, "simulate.integrator=accurate", "simulate.output_interval=1e-300"),
            "simulate.output_interval",
        ),
    ],
)
def test_more_steps_than_are_counted(folder, overrides, key):
    """Beyond 2^63 their number would be another one, or none."""
    with pytest.raises(InputError, match=rf"{key}: 1e\+30\d steps") as caught:
        load_case(folder, overrides)
    assert "at most 1e+15" in str(caught.value)
