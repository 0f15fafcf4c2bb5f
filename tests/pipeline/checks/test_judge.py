"""Checks and criteria, each judged by itself, and how commands end."""

from __future__ import annotations

import json

import pytest

from heavylift.pipeline.commands.cli import app

SHORT = ("--set", "simulate.duration=1 ms")
OPEN = """
[[check]]
id = "vector"
quantity = "modes.beam.frequency.3"
maximum = "1 MHz"
[[check]]
id = "late"
quantity = "channel.beam.modal_position.1.max"
after = "1 s"
maximum = 1.0
"""
LIMITS = """
[[criteria]]
name = "mass"
type = "limit"
quantity = "mesh.beam.mass"
maximum = "{maximum}"
[[criteria]]
name = "fitted"
type = "limit"
quantity = "frequency.beam.modal_position.3"
maximum = "1 MHz"
"""


@pytest.fixture
def run(capsys):
    def command(*tokens):
        capsys.readouterr()
        code = app([str(token) for token in tokens], result_action="return_value")
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return command


def appended(folder, text):
    with (folder / "case.toml").open("a") as file:
        file.write(text)


def test_one_check_that_cannot_be_evaluated_hides_no_other(run, small_case):
    appended(small_case, OPEN)
    code, out, _ = run("verify", small_case, *SHORT)
    assert code == 1
    assert "not reached" not in out
    assert "late: not evaluated, FAILED: " in out
    assert "there is no record from 1 s" in out
    code, out, _ = run("verify", small_case, *SHORT, "--json")
    (row,) = json.loads(out)["cases"]
    checks = {check["id"]: check for check in row["checks"]}
    assert [name for name, check in checks.items() if not check["passed"]] == ["late"]
    assert (checks["late"]["value"], "no record" in checks["late"]["message"]) == (None, True)
    assert checks["vector"]["value"] > 0.0
    assert (code, row["outcome"]) == (1, "check_failed")


@pytest.mark.parametrize(("maximum", "passed"), [("1 kg", True), ("0.1 kg", False)])
def test_verify_judges_criteria_too(run, small_case, maximum, passed):
    """The bar has 0.312 kg: 7800 kg/m^3 in 4e-5 m^3."""
    appended(small_case, LIMITS.format(maximum=maximum).partition('[[criteria]]\nname = "fitted"')[0])
    code, out, _ = run("verify", small_case, *SHORT, "--json")
    (row,) = json.loads(out)["cases"]
    (criterion,) = row["criteria"]
    assert criterion["value"] == pytest.approx(7800.0 * 4e-5, rel=1e-9)
    assert (code, criterion["passed"], row["not_evaluated"]) == (0 if passed else 1, passed, {})
    assert all(check["passed"] for check in row["checks"])
    code, out, _ = run("criteria", small_case, *SHORT)
    assert code == (0 if passed else 1)


def test_criteria_are_judged_each_by_itself(run, small_case):
    appended(small_case, LIMITS.format(maximum="1 kg"))
    for command in ("criteria", "verify"):
        code, out, _ = run(command, small_case, *SHORT)
        assert code == 1, command
        assert "fitted: not evaluated, FAILED: " in out
        assert "mesh.beam.mass" in out
    code, out, _ = run("criteria", small_case, *SHORT, "--json")
    document = json.loads(out)
    assert [one["name"] for one in document["criteria"]] == ["mass"]
    assert list(document["not_evaluated"]) == ["fitted"]


def test_criteria_that_a_run_did_not_reach_are_not_passed(run, small_case):
    appended(small_case, LIMITS.format(maximum="1 kg"))
    code, out, _ = run(
        "verify", small_case, *SHORT, "--set", "simulate.step=5 ms", "--set", "simulate.duration=10 ms"
    )
    assert code >= 2
    assert out.count("not reached, FAILED") >= 2 or "bad input" in out


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("", 0, ""),
        (LIMITS.format(maximum="1 kg").partition('[[criteria]]\nname = "fitted"')[0], 0, ""),
        (LIMITS.format(maximum="0.1 kg"), 1, "Failed: 1 of 2 criteria (mass); not evaluated: fitted."),
        (LIMITS.format(maximum="1 kg"), 1, "Open: 1 of 2 criteria (fitted) could not be evaluated."),
        (OPEN, 1, "Open: 1 of 4 checks (late) could not be evaluated."),
    ],
)
def test_a_run_ends_as_it_is_judged(run, small_case, text, code, words):
    """Also when all its stages are there; its stages by themselves, and the report, have done what was asked."""
    appended(small_case, text)
    for _ in range(2):
        ended, _, error = run("run", small_case, *SHORT)
        assert ended == code
        assert words in error
    ended, out, _ = run("run", small_case, *SHORT, "--json")
    assert (ended, json.loads(out)["outcome"]) == (code, "check_failed" if code else "completed")
    for command in ("simulate", "report"):
        assert run(command, small_case, *SHORT)[0] == 0
