"""Runs of several seeds: what stops by itself is a row, and criteria judge the worst of all."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.case.criteria.results import CriterionResult
from heavylift.pipeline.checks.judge import Judged
from heavylift.pipeline.commands import statistics as seeds_module
from heavylift.pipeline.commands.criteria import criteria_document, criteria_table, judge_case
from heavylift.pipeline.commands.statistics import SeedRun, reported_stops, simulate_seeds
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.statistics import gumbel_fit
from heavylift.pipeline.results.storage import StopError
from heavylift.pipeline.stages import stages
from heavylift.pipeline.stages.stages import load_changed_case

CASES = Path(__file__).parents[3] / "cases"
SEA = CASES / "irregular_sea"


@pytest.fixture
def ends(monkeypatch):
    """Ends of the runs by the names of their folders; the others are completed at once."""
    found: dict[str, Outcome] = {}

    def run_case(_case, *, out, stages, **_options):
        outcome = found.get(out.name, Outcome.COMPLETED) if "simulate" in stages else Outcome.COMPLETED
        return SimpleNamespace(outcome=outcome, message=f"{outcome.text}\nmore" if outcome else "")

    monkeypatch.setattr(stages, "run_case", run_case)
    return found


def runs_of(folder, count=5):
    case = load_changed_case(SEA, ())
    return simulate_seeds(case, folder, SEA, (), count, lambda _, at: at.name, Log(quiet=True))


def test_a_run_that_stops_is_a_row_and_the_others_go_on(ends, tmp_path):
    names = [run.found for run in runs_of(tmp_path)]
    ends[names[1]] = Outcome.LIMIT_REACHED
    runs = runs_of(tmp_path)
    assert [run.found for run in runs] == [names[0], None, *names[2:]]
    assert runs[1].row() == {
        "seed": runs[0].seed + 1,
        "outcome": "limit_reached",
        "message": f"{Outcome.LIMIT_REACHED.text}\nmore",
    }
    words = reported_stops(runs)
    assert "1 of 5 runs stopped by themselves" in words[0]
    assert words[1].strip() == f"seed {runs[1].seed}: {Outcome.LIMIT_REACHED.text}"


def test_an_interrupt_ends_all(ends, tmp_path):
    ends[runs_of(tmp_path)[1].found] = Outcome.INTERRUPTED
    with pytest.raises(StopError):
        runs_of(tmp_path)


def result(value, limit=10.0, side="<=", **more):
    return CriterionResult("hook", "limit", "load", value, limit, "N", side, **more)


@pytest.fixture
def judged(monkeypatch):
    def judge(values, stopped=(), side="<="):
        runs = [
            SeedRun(7 + k, Outcome.TIMED_OUT, "too long", None)
            if k in stopped
            else SeedRun(
                7 + k,
                Outcome.COMPLETED,
                "",
                Judged(criteria=(result(value, side=side), result(1.0, where="other"))),
            )
            for k, value in enumerate(values)
        ]
        monkeypatch.setattr(seeds_module, "simulate_seeds", lambda *_, **__: runs)
        return judge_case(
            CASES / "floating_crane_lift",
            out=None,
            overrides=(),
            force=False,
            seeds=len(values),
            log=Log(quiet=True),
        )

    return judge


def test_criteria_of_seeds_judge_the_worst(judged):
    values = np.array([7.0, 9.5, 8.0, 8.4, 7.7])
    found = judged(values)
    line, other = found.results
    fit = gumbel_fit(values / 10.0)
    assert (found.outcome, line.value, line.where) == (Outcome.COMPLETED, 9.5, "seed 8")
    assert "the worst of 5 seeds" in line.note
    assert f"{100.0 * fit.quantile(0.9):.4g} % with 90 % probability" in line.note
    assert (other.where, "Gumbel" in other.note) == ("other, seed 7", False)  # all runs have the same
    found = judged([7.0, 11.0, 8.0])
    assert (found.outcome, found.results[0].value) == (Outcome.CHECK_FAILED, 11.0)


def test_the_worst_of_what_must_be_large_is_the_smallest(judged):
    assert judged([17.0, 12.5, 18.0], side=">=").results[0].value == 12.5
    assert judged([17.0, float("nan"), 18.0], side=">=").results[0].where == "seed 8"


def test_a_run_that_stopped_has_passed_nothing(judged):
    found = judged([7.0, 9.5, 8.0], stopped=(1,))
    assert found.outcome is Outcome.TIMED_OUT
    assert found.results[0].value == 8.0
    assert "seed 8: too long" in criteria_document(found)["message"]
    assert any("1 of 3 runs stopped" in line for line in criteria_table(found))
