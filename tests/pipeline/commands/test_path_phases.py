"""Phases that tell a transporter on its path something, from a case file: plan, run, log, checks and bad input."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.commands.scenario import scenario_command
from heavylift.pipeline.log import Log
from tests.pipeline.judged import judged_checks

CASE = Path(__file__).resolve().parents[3] / "cases" / "spmt_warp"
PHASES = """
[scenario]
at_end = "stop"

[[scenario.phases]]
name = "wait"
actions = [{ path = "spmt", speed = 0 }]
until = { time = "2 s" }

[[scenario.phases]]
name = "creep"
actions = [{ path = "spmt", speed = "0.2 m/s", ramp = "4 s" }]
until = { quantity = "spmt.path_way", above = "1.4 m" }
timeout = { after = "20 s" }

[[scenario.phases]]
name = "look"
actions = [{ path = "spmt", speed = 0, acceleration = "0.1 m/s^2" }]
until = { arrived = "spmt", hold = "3 s" }

[[scenario.phases]]
name = "on"
actions = [{ path = "spmt", planned = true }]
until = { arrived = "spmt" }

[[check]]
id = "way"
quantity = "channel.spmt.path_way.end"
reference = "16 m"
tolerance = { absolute = 1e-9 }
source = "the leg"

"""


def case_with(folder: Path, phases: str = PHASES):
    """The case with a scenario and no checks of its own."""
    text = (CASE / "case.toml").read_text(encoding="utf-8")
    (folder / "case.toml").write_text(text[: text.index("[[check]]")] + phases, encoding="utf-8")
    shutil.copy(CASE / "road.csv", folder)
    return load_case(folder)


def test_phases_of_a_path_from_a_case(tmp_path) -> None:
    """Stops at 2 s, 1.4 m at 11 s, at rest on 1.6 m at 13 s, goes on at 16 s as its leg says: 14.4 m in 44 s."""
    case = case_with(tmp_path)
    document, words = scenario_command(tmp_path, log=Log())
    assert [phase["end"]["spmt"] for phase in document["phases"]] == [
        [0.0, 0.0],
        [0.0, 3.6],
        [0.0, 16.0],
        [16.0, 16.0],
    ]
    assert document["phases"][3]["largest_speed"]["spmt"] == pytest.approx(0.4)
    assert any("'spmt' along its leg at 0.2 m/s in 4 s" in line for line in words)
    assert run_case(case, stages=("simulate",)).outcome is Outcome.COMPLETED
    results = load_results(tmp_path)
    log = results.metadata["scenario"]["log"]
    assert [line[0] for line in log if line[2] == "done"] == pytest.approx([2.0, 11.0, 16.0, 60.0], abs=1e-5)
    (check,) = judged_checks(case, case.output_folder)
    assert check.passed


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('path = "spmt", planned', 'path = "spmd", planned', r"phases\.3\.actions\.0\.path: 'spmd' is no transporter"),
        ("planned = true", "planned = false", r"phases\.3\.actions\.0\.planned"),
        ("planned = true", "planned = true, ramp = 1", r"ramp: 'ramp' beside 'planned'; expected the values"),
        ("speed = 0 }", 'speed = "-1 m/s" }', r"phases\.0\.actions\.0\.speed: -1 m/s; expected a speed of 0 or more"),
        ("speed = 0 }", "ramp = 1 }", r"actions\.0\.speed: a path without 'speed'; expected 'speed', 0 to stop"),
        ("speed = 0 }", 'speed = "1 rad/s" }', r"actions\.0\.speed"),
        ("speed = 0 }", "distance = 1 }", r"actions\.0\.distance: 'distance' of 'path'"),
        ('{ time = "2 s" }', '{ arrived = "spnt" }', r"until.*'spnt' is no rope, hook, tank, drive or transporter"),
    ],
)  # fmt: skip
def test_bad_phases_of_a_path_are_one_error_each(tmp_path, old: str, new: str, words: str) -> None:
    """With the key."""
    assert old in PHASES
    with pytest.raises(InputError, match=words) as error:
        case_with(tmp_path, PHASES.replace(old, new, 1))
    assert str(error.value).count("expected") == 1
