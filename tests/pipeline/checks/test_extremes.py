"""The largest tension of a run is that of all its steps, in checks, statistics and tables; windows are windows."""

from __future__ import annotations

import math
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.commands.verify import check_table, verify_case
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.histories import load_results
from heavylift.pipeline.results.statistics import chosen_columns, column_statistics, run_statistics
from heavylift.pipeline.stages.stages import load_changed_case

if TYPE_CHECKING:
    from heavylift.pipeline.commands.verify import CaseVerdict

CASE = Path(__file__).parents[3] / "cases" / "bouncing_rope"
WEIGHT, STIFFNESS, FALL = 1e4 * 9.81, 1e6, 2.0
PEAK = WEIGHT + math.sqrt(WEIGHT**2 + 2.0 * STIFFNESS * WEIGHT * FALL)


@pytest.fixture(scope="module")
def verified(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, CaseVerdict]:
    """Folder of a run with records at every 0.1 s, steps of 1 ms, and its verdict."""
    folder = tmp_path_factory.mktemp("extremes") / "bouncing_rope"
    shutil.copytree(CASE, folder, ignore=shutil.ignore_patterns("out*"))
    return folder, verify_case(folder, out=folder / "out", overrides=[], force=False, log=Log(quiet=True))


def test_a_check_of_a_peak_sees_every_step_and_says_so(verified: tuple[Path, CaseVerdict]) -> None:
    folder, verdict = verified
    check = next(check for check in verdict.checks if check.id == "peak_tension")
    assert check.value == pytest.approx(PEAK, rel=5e-6)
    assert check.seen == "largest of 10,000 steps"
    assert check.row()["seen"] == check.seen
    assert any("largest of 10,000 steps" in line for line in check_table(verdict))
    results = load_results(folder / "out" / "simulate" / "results.h5")
    assert results["spring.tension"].max() < PEAK * (1.0 - check.tolerance)  # records alone would fail
    quantities = Quantities(load_changed_case(folder, []), folder / "out")
    assert quantities.number("channel.spring.tension.min") == 0.0
    assert quantities.seen("channel.spring.tension.min") == "smallest of 10,000 steps"
    assert quantities.seen("channel.spring.length.max") == "largest of 101 records"
    assert quantities.seen("channel.spring.tension.mean") == ""


def test_statistics_of_a_window_see_its_steps(verified: tuple[Path, CaseVerdict]) -> None:
    """Of what begins after the first bounce; other channels have records."""
    results = load_results(verified[0] / "out" / "simulate" / "results.h5")
    (column,) = chosen_columns(results, ["spring.tension"])
    for begin in (0.0, 1.05, 1.25):
        found = column_statistics(column, [run_statistics(column, results, begin)])
        after = np.flatnonzero(results.time >= begin)[1:]
        assert found.records[0].maximum == results["spring.tension_max"][after].max()
        assert found.entry()["extremes_of"] == "steps"
    (column,) = chosen_columns(results, ["spring.length"])
    assert (
        column_statistics(column, [run_statistics(column, results, 0.0)]).entry()["extremes_of"] == "records"
    )
