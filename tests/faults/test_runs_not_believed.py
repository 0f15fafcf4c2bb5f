"""Completed runs whose energy balance is not credible: exit codes, and where they are reported."""

from __future__ import annotations

import json

import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline import load_results

CASE = """title = "A load on a spring"

[bodies.load]
type = "rigid"
mass = "10 kg"
inertia = ["1 kg m^2", "1 kg m^2", "1 kg m^2"]
frame = { motion = "free" }
initial = { position = ["1 m", 0, 0], velocity = [0, "1 m/s", 0] }

[gravity]
acceleration = [0, 0, "-9.81 m/s^2"]

[[forces]]
type = "spring"
name = "spring"
between = ["ground", "load"]
points = [[0, 0, 0], [0, 0, 0]]
length = "1 m"
stiffness = "1 kN/m"

[simulate]
integrator = "dele2"
step = "0.2 s"
output_interval = "0.2 s"
duration = "40 s"

[[check]]
id = "drift"
quantity = "drift.energy"
reference = 0.0
tolerance = { absolute = 1.0 }
source = "conservation of energy"
"""


@pytest.fixture
def case(tmp_path):
    folder = tmp_path / "load"
    folder.mkdir()
    (folder / "case.toml").write_text(CASE)
    return folder


def test_a_run_that_loses_most_of_its_energy_has_an_exit_code(heavylift, case):
    """Three steps in its period: most is lost, whatever the tolerance of a check."""
    result = heavylift("simulate", case)
    assert result.code == Outcome.ENERGY_NOT_KEPT == 15
    assert "energy balance not" in result.error
    assert "were lost that nothing dissipates" in result.error
    results = load_results(case)
    assert results.outcome == "energy_not_kept"
    assert len(results.time) == 201
    again = heavylift("simulate", case)
    assert again.code == 15
    assert "unchanged, skipped; it ended: energy balance not" in again.out
    verdict = heavylift("verify", case, "--json")
    assert verdict.code == 15
    assert json.loads(verdict.out)["cases"][0]["checks"][0]["passed"] is False
    assert heavylift("run", case).code == 15
    assert "energy balance not" in (case / "out" / "report" / "report.md").read_text()


@pytest.mark.slow
def test_a_warning_is_told_wherever_the_results_are(heavylift, case):
    result = heavylift("simulate", case, "--set", "simulate.step=50 ms", "--json")
    document = json.loads(result.out)
    assert result.code == 0
    assert f"energy ({document['energy_drift']:.1%}) were lost" in document["warning"]
    assert 0.02 < document["energy_drift"] < 0.5
    assert load_results(case).metadata["warning"] == document["warning"]
    again = heavylift("run", case, "--set", "simulate.step=50 ms")
    assert "simulate: unchanged, skipped\nsimulate: WARNING: 13.4 J of energy" in again.out
    assert "were lost that nothing dissipates" in (case / "out" / "report" / "report.md").read_text()
    assert heavylift("verify", case, "--set", "simulate.step=50 ms").code == 0


def test_a_sound_step_says_nothing(heavylift, case):
    result = heavylift("simulate", case, "--set", "simulate.step=2 ms", "--json")
    assert (result.code, json.loads(result.out)["warning"]) == (0, "")


def test_one_measure_of_the_drift_serves_words_check_and_verdict(heavylift, case):
    words = heavylift("simulate", case, "--set", "simulate.step=50 ms").out
    check = json.loads(heavylift("verify", case, "--set", "simulate.step=50 ms", "--json").out)["cases"][0]
    assert f"energy drift {check['checks'][0]['value']:.1e}" in words
    assert f"({check['checks'][0]['value']:.1%}) were lost" in words


def test_energies_that_are_no_numbers_are_no_success(heavylift, small_case):
    speed = "bodies.beam.initial.modal_velocity=[1e300]"
    result = heavylift("simulate", small_case, "--set", "simulate.duration=1 ms", "--set", speed)
    assert result.code == Outcome.NOT_FINITE
    assert "energies or momenta of records" in result.error
