"""The public FE data of MBSim through the whole pipeline, where the data are at hand."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

import pytest

from heavylift.pipeline import load_case, run_case
from heavylift.pipeline.checks.quantities import Quantities

if TYPE_CHECKING:
    from pathlib import Path

CASE = """
title = "Four files"

[bodies.beam]
type = "flexible"
geometry = {{ type = "four_files", folder = "fe", {units} }}
modes = {{ {modes} }}
frame = {{ motion = "fixed" }}
initial = {{ modal_velocity = [{velocities}] }}

[simulate]
step = "{step}"
output_interval = "{interval}"
duration = "{duration}"
"""


def make_case(folder: Path, data: Path, **values: str) -> Path:
    folder.mkdir()
    shutil.copytree(data, folder / "fe")
    (folder / "case.toml").write_text(CASE.format(**values))
    return folder


def test_complex_beam_rings_at_the_frequencies_of_its_five_stored_modes(tmp_path, mbsim_data):
    folder = make_case(
        tmp_path / "beam",
        mbsim_data / "complex_beam",
        # a density in kg/m^3 and a modulus in Pa on lengths in mm
        units='length_unit = "1 mm", mass_unit = 1e-9, stiffness_unit = 1e-3',
        modes='basis = "stored"',
        velocities="0.2, 0.17, 0.14, 0.1, 0.05",
        step="0.1 us",
        interval="10 us",
        duration="20 ms",
    )
    case = load_case(folder)
    out = run_case(case, stages=("mesh", "modes", "simulate")).folder.root
    quantities = Quantities(case, out)
    # stored stiffness and masses projected on the five stored modes
    expected = (534.437, 1071.747, 2271.472, 3099.504, 6346.244)
    for number, frequency in enumerate(expected, start=1):
        assert quantities.number(f"modes.beam.frequency.{number}") == pytest.approx(frequency, abs=6e-4)
        assert quantities.number(f"ringdown.beam.{number}") == pytest.approx(frequency, rel=1e-5)


def test_sliding_beam_swings_at_its_first_frequency(tmp_path, mbsim_data):
    folder = make_case(
        tmp_path / "beam",
        mbsim_data / "sliding_beam",
        units='length_unit = "1 mm", mass_unit = "1 t", stiffness_unit = "1 N/mm"',
        modes="count = 3",
        velocities="0.001",
        step="1 ms",
        interval="10 ms",
        duration="5 s",
    )
    case = load_case(folder)
    out = run_case(case, stages=("mesh", "modes", "simulate")).folder.root
    assert Quantities(case, out).number("ringdown.beam.1") == pytest.approx(0.726, abs=5e-4)
