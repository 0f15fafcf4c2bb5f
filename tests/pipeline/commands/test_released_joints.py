"""A weld that a phase of a case lets go: plan, run, checks, report, and what is refused."""

# ruff: noqa: E501

from __future__ import annotations

import html
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, InputErrors, Outcome
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.commands.scenario import scenario_command
from heavylift.pipeline.log import Log
from tests.pipeline.judged import judged_checks

CASE = """
title = "A load on two welds, one to a lug that stays with it"

[gravity]
acceleration = [0, 0, -9.81]

[bodies.load]
type = "rigid"
mass = "2 t"
inertia = [500, 500, 500]
frame = { motion = "free" }
initial = { position = [0, 0, -2] }

[bodies.lug]
type = "rigid"
mass = "100 kg"
inertia = [5, 5, 5]
frame = { motion = "free" }
initial = { position = [0, 0, -1] }

[[joints]]
name = "weld_top"
type = "fixed"
between = ["ground", "lug"]
at = [0, 0, 0]

[[joints]]
name = "weld_lug"
type = "fixed"
between = ["lug", "load"]
at = [0, 0, -1]

[[scenario.phases]]
name = "hold"
until = { time = "0.5 s" }

[[scenario.phases]]
name = "let_go"
actions = [{ release = "weld_top" }]

[simulate]
step = "10 ms"
output_interval = "50 ms"
duration = "1.5 s"

[[check]]
id = "fall"
quantity = "channel.load.position.z.end"
reference = "-6.905 m"
tolerance = { absolute = 1e-8 }
source = "-2 m - g 1 s^2 / 2"

[[check]]
id = "lug"
quantity = "channel.weld_lug.reaction_force.z.max"
reference = "19620 N"
tolerance = { relative = 1e-9 }
source = "weight of the load, up to the release"

[[check]]
id = "energy_drift"
quantity = "drift.energy"
reference = 0.0
tolerance = { absolute = 1e-9 }
source = "rigid rows have stored nothing, but for the softness of 1e-7 that lets redundant ones share"
"""


def test_a_weld_of_a_case_lets_go(tmp_path: Path) -> None:
    """The lug falls with the load, on the weld that holds on."""
    (tmp_path / "case.toml").write_text(CASE)
    case = load_case(tmp_path)
    _, lines = scenario_command(tmp_path, log=Log(quiet=True))
    assert "released: weld_top" in lines
    assert run_case(case, stages=("simulate",)).outcome is Outcome.COMPLETED
    results = load_results(tmp_path)
    late = results.time > 0.51
    np.testing.assert_allclose(results["weld_lug.reaction_force"][late], 0.0, atol=1e-6)
    np.testing.assert_allclose(
        results["load.position"] - results["lug.position"], [[0, 0, -1]] * len(late), atol=1e-9
    )
    assert all(check.passed for check in judged_checks(case, case.output_folder))


@pytest.mark.slow
def test_a_report_of_a_released_weld(tmp_path: Path) -> None:
    """Its phases are in it."""
    (tmp_path / "case.toml").write_text(CASE)
    assert run_case(load_case(tmp_path)).outcome is Outcome.COMPLETED
    report = (tmp_path / "out" / "report" / "report.html").read_text(encoding="utf-8")
    assert "release of joint 'weld_top'" in html.unescape(report)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"weld_top" }', '"weld_tip" }', r"phases.1.actions.0.release: 'weld_tip' is no rope or joint; did you mean 'weld_top'"),
        ('type = "fixed"\nbetween = ["ground"', 'type = "hinge"\naxis = [0, 1, 0]\nfriction = 5\nbetween = ["ground"', "'weld_top' has stops or friction"),
        ('{ release = "weld_top" }', '{ release = "weld_top" }, { release = "weld_*" }', r"phases.1.actions.1.release: 'weld_top' is released then"),
        ('{ release = "weld_top" }', '{ connect = "weld_top" }', "'weld_top' is no rope"),
    ],
)  # fmt: skip
def test_what_cannot_be_released_is_refused(tmp_path: Path, old: str, new: str, words: str) -> None:
    """When the case is read, with the key."""
    assert old in CASE
    (tmp_path / "case.toml").write_text(CASE.replace(old, new))
    with pytest.raises((InputError, InputErrors)) as refused:
        load_case(tmp_path)
    assert words in str(refused.value)
