"""Spreader beams: forces of slings against statics, and what is refused."""

from __future__ import annotations

import math

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, load_results, run_case

G = 9.81

LIFT = """
title = "A module on a spreader beam"

[gravity]
acceleration = [0, 0, -9.81]

[bodies.module]
type = "rigid"
mass = "60 t"
inertia = ["300 t m^2", "800 t m^2", "900 t m^2"]
frame = { motion = "free" }
initial = { position = [0, 0, 10] }

[[spreaders]]
name = "spreader"
hook = { body = "ground", point = [0, 0, 30] }
beam = { mass = "5 t", length = 12 }
sling_length = 10
sling = { axial_stiffness = 1e9 }
line = { axial_stiffness = 1e9 }
lines = [
    { at = -6, body = "module", point = [-6, 0, 2] },
    { at = 6, body = "module", point = [6, 0, 2] },
]

[simulate]
start = "equilibrium"
step = 0.01
output_interval = 0.01
duration = 0.01
"""


def test_slings_and_lines_carry_what_statics_says(tmp_path):
    (tmp_path / "case.toml").write_text(LIFT)
    case = load_case(tmp_path)
    run_case(case, stages=("simulate",))
    results = load_results(case, case.output_folder)

    def tension(name):
        return float(results[f"{name}.tension"].ravel()[0])

    for i in (1, 2):
        assert tension(f"spreader_line_{i}") == pytest.approx(30e3 * G, rel=1e-6)
        # slings of 10 m with half the beam, 6 m: the sine of their angle is 0.8, but for their stretch
        sling = tension(f"spreader_sling_{i}")
        sine = math.sqrt(1.0 - (6.0 / (10.0 * (1.0 + sling / 1e9))) ** 2)
        assert sling == pytest.approx(32.5e3 * G / sine, rel=1e-6)
        assert float(results[f"spreader_line_{i}.rest_length"].ravel()[0]) == pytest.approx(30 - 8 - 1 - 12)
    assert results["spreader_beam.position"][0][2] == pytest.approx(30 - 8 - 0.5, abs=1e-2)


@pytest.mark.parametrize(
    ("change", "key", "words"),
    [
        (
            ("sling_length = 10", "sling_length = 6.5"),
            "spreaders.0.sling_length",
            "22.62 deg to the horizontal",
        ),
        (("sling_length = 10", "sling_length = 5"), "spreaders.0.sling_length", "too short"),
        (("at = 6", "at = 7"), "spreaders.0.lines.1.at", "7 m from the middle of a beam of 12 m"),
        (("[6, 0, 2]", "[6, 0, 12]"), "spreaders.0.lines.1.point", "the lug is 1 m above the beam"),
        (("beam = {", "along = [0, 0, 1]\nbeam = {"), "spreaders.0.along", "is not horizontal"),
    ],
)
def test_one_error_with_its_key(change, key, words, tmp_path):
    assert change[0] in LIFT
    (tmp_path / "case.toml").write_text(LIFT.replace(*change))
    with pytest.raises(InputError) as refused:
        load_case(tmp_path)
    (line,) = str(refused.value).splitlines()
    assert f"{key}: " in line
    assert words in line


def test_the_flattest_slings_are_those_of_thirty_degrees(tmp_path):
    least = 6.0 / math.cos(math.radians(30.0)) + 1e-9
    (tmp_path / "case.toml").write_text(LIFT.replace("sling_length = 10", f"sling_length = {least}"))
    assert "spreader_beam" in load_case(tmp_path).bodies
