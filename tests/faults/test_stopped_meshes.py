"""Frames and shells that cannot be in equilibrium, or are stepped too boldly: named by body, element and motion."""

from __future__ import annotations

import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline import load_case, load_results, run_case

CASE = """
title = "Cantilever"
[gravity]
acceleration = [0, 0, "-9.81 m/s^2"]
[bodies.beam]
type = "frame"
geometry = { type = "line", start = [0, 0, 0], end = ["10 m", 0, 0], elements = 4 }
section = { density = 1000, young_modulus = "1 GPa", diameter = "1 m" }
supports = [{ at = "start", fix = "clamped" }]
[simulate]
step = "1 ms"
output_interval = "10 ms"
duration = "0.2 s"
"""
STATICS = ("simulate.start=equilibrium", "simulate.duration=0")


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize(
    ("elasticity", "step", "remedy"),
    [
        # waves of c = sqrt(E/rho) = 1000 m/s cross an element of 2.5 m in 2.5 ms: no explicit step may be longer
        ("explicit", "10 ms", "try a step below "),
        ("carried", "0.5 s", "try a smaller step"),
    ],
)
def test_a_bold_step_names_the_body_and_leaves_a_report(folder, elasticity, step, remedy):
    change = [f"bodies.beam.elasticity={elasticity}", f"simulate.step={step}", "simulate.output_interval=1 s"]
    soft = ["bodies.beam.section.young_modulus=1 MPa"] if elasticity == "carried" else []
    case = load_case(folder, [*change, *soft, "simulate.duration=100 s"])
    report = run_case(case)
    assert report.outcome is not Outcome.COMPLETED
    assert " at t = " in report.message
    assert "body 'beam', element " in report.message
    assert remedy in report.message
    if elasticity == "explicit":
        limit = float(report.message.partition(remedy)[2].partition(" s,")[0])
        assert 1e-4 < limit < 2.5e-3
    assert report.stage("report").outcome is Outcome.COMPLETED
    text = (report.folder.stage("report") / "report.md").read_text()
    assert "Stopped: " in text
    assert "body 'beam'" in text
    assert "## Frame beam" in text
    assert load_results(case).outcome == report.outcome.name.lower()
    again = run_case(case)
    assert again.message == report.message
    assert again.stages[-1].skipped


@pytest.mark.parametrize(
    ("supports", "motion"),
    [
        ("", "'beam' can move"),
        ('[{at="start", fixed={position="xy", tangent="xyz"}}]', "'beam' can slide along z"),
    ],
)
def test_a_load_on_a_free_motion_has_no_equilibrium(folder, supports, motion):
    case = load_case(folder, [*STATICS, f"bodies.beam.supports={supports}"])
    with pytest.raises(InputError) as caught:
        run_case(case)
    (line,) = str(caught.value).splitlines()
    assert f"{folder / 'case.toml'}: simulate.start: there is no static equilibrium: " in line
    assert motion in line
    assert "expected supports, joints, springs or ropes that hold all bodies" in line
