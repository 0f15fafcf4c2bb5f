"""Frames and shells that start at rest, through all stages: what loads act then, and what it costs."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heavylift.pipeline import load_case, load_results, run_case

CASE = """
title = "Cantilever"
[bodies.beam]
type = "frame"
geometry = { type = "line", start = [0, 0, 0], end = ["10 m", 0, 0], elements = 4 }
section = { density = 1000, young_modulus = "1 GPa", diameter = "1 m" }
supports = [{ at = "start", fix = "clamped" }]
loads = [{ force = [0, 0, "-2 N/m"], times = [-1, "1 s"], factors = [0.2, 0.8] }]
[simulate]
start = "equilibrium"
duration = 0
"""
DEFLECTION = 1.0 * 10.0**4 / (8.0 * 1e9 * math.pi / 64.0)
"""Of the tip under 1 N/m, the load at t = 0: ``q l^4 / 8 E I``."""


@pytest.mark.slow
@pytest.mark.parametrize("start", ["equilibrium", "relax"])
def test_the_equilibrium_is_that_of_the_load_at_the_start(tmp_path, start):
    (tmp_path / "case.toml").write_text(CASE)
    case = load_case(tmp_path, [f"simulate.start={start}"])
    report = run_case(case, stages=("simulate",))
    assert report.message == ""
    tip = load_results(case)["beam.position"].reshape(-1, 3)[-1]
    np.testing.assert_allclose(tip, [10.0, 0.0, -DEFLECTION], rtol=1e-5, atol=1e-8)
    details = report.stage("simulate").details
    # the search is a run, and compiling is not part of it
    assert details["cpu_s"] == details["start_s"] > 0.0
    assert load_results(case).metadata["cpu_s"] == details["cpu_s"]
    if start == "equilibrium":
        assert details["cpu_s"] < 1.0


@pytest.mark.slow
def test_a_run_that_goes_on_from_its_start_costs_both(tmp_path):
    """At rest the beam stays there; the search for the start counts once, whoever makes the steps."""
    (tmp_path / "case.toml").write_text(CASE)
    constant = "bodies.beam.loads=[{force=[0, 0, '-1 N/m']}]"
    steps = ["simulate.step=10 ms", "simulate.output_interval=50 ms", "simulate.duration=0.5 s"]
    case = load_case(tmp_path, [constant, *steps])
    report = run_case(case, stages=("simulate",))
    assert report.message == ""
    tips = load_results(case)["beam.position"].reshape(11, -1, 3)[:, -1]
    np.testing.assert_allclose(tips, np.broadcast_to([10.0, 0.0, -DEFLECTION], tips.shape), atol=1e-8)
    details = report.stage("simulate").details
    loop = 1e-6 * details["step_us"] * details["steps"]
    assert details["cpu_s"] == pytest.approx(details["start_s"] + loop)
    assert details["start_s"] > 0.0
