"""Bodies of four files through the whole pipeline: the public FE data of MBSim, where they are at hand, and our own."""

from __future__ import annotations

import re
import shutil
from typing import TYPE_CHECKING

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, run_case
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.model_io import read_model, read_reduced
from heavylift.preprocess.finite_elements.exchange import write_four_files

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


@pytest.fixture
def written(tmp_path, small_case):
    """A clamped bar of 0.312 kg, meshed and reduced here, as another program would hand it over: in mm."""
    out = run_case(load_case(small_case), stages=("mesh", "modes")).folder
    model, reduced = read_model(out.model("beam")), read_reduced(out.reduced("beam"))
    folder = tmp_path / "files"
    write_four_files(
        folder / "fe", model, reduced.mode_shapes.reshape(reduced.mode_count, -1).T, length_unit=1e-3
    )
    (folder / "case.toml").write_text(
        CASE.format(
            units='length_unit = "1 mm"',
            modes="count = 3",
            velocities="0.1",
            step="1 us",
            interval="20 us",
            duration="1 ms",
        )
        + '\n[[sensors]]\nname = "tip"\nbody = "beam"\npoint = ["200 mm", "20 mm", "10 mm"]\n'
    )
    return folder


@pytest.mark.slow
def test_what_the_reader_found_in_the_files_is_said(written, capsys):
    case = load_case(written)
    run_case(case, log=Log())
    spec = capsys.readouterr().out
    assert re.search(r"mesh: beam: the body is 0\.2 x 0\.02 x 0\.01 m, 0\.312 kg, longitudinal waves", spec)
    report = (written / "out" / "report" / "report.md").read_text()
    assert "| of the file | the body is 0.2 x 0.02 x 0.01 m, 0.312 kg" in report
    assert "Nodes of the model of beam: matrices without elements" in report
    assert "Mesh of beam" not in report


@pytest.mark.parametrize("quantity", ["stress.tip.von_mises.max", "stress.beam.von_mises.max"])
def test_stress_of_a_body_without_elements_is_refused_before_it_is_simulated(written, quantity):
    file = written / "case.toml"
    check = f'id = "s"\nquantity = "{quantity}"\nreference = 1.0\ntolerance = {{ relative = 0.1 }}\nsource = "-"\n'
    file.write_text(f"{file.read_text()}\n[[check]]\n{check}")
    with pytest.raises(InputError, match=r"check\.0\.quantity: .* needs elements and a material"):
        load_case(written)
