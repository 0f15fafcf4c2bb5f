"""Observed orders of errors whose order is known."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.checks.convergence import (
    ConvergenceRow,
    cost_of_error,
    fitted_slope,
    observed_order,
    study_table,
)
from heavylift.pipeline.commands import converge
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.pipeline.stages.stages import RunReport
from heavylift.pipeline.stages.work import StageReport


@pytest.mark.parametrize("order", [1.0, 2.0, 4.0])
def test_a_power_law_has_its_order(order):
    h = [0.8, 0.4, 0.2, 0.1]
    found, used = observed_order(h, [3.0 * x**order for x in h])
    assert found == pytest.approx(order, rel=1e-12)
    assert used == (0, 1, 2, 3)


def test_coarse_rows_and_rounding_are_left_out():
    h = [10.0, 1.0, 0.5, 0.25, 0.125, 0.0625]
    found, used = observed_order(h, [3e-2, 1e-2, 2.5e-3, 6.25e-4, 5e-4, 6e-4])
    assert found == pytest.approx(2.0, rel=1e-12)
    assert used == (1, 2, 3)


def test_a_growing_parameter_counts_inversely():
    count = [10, 20, 40]
    found, _ = observed_order(count, [x**-3.0 for x in count])
    assert found == pytest.approx(3.0)


@pytest.mark.parametrize("errors", [[1.0, 1.0], [1.0, 2.0, 3.0], [0.0, 0.0], [np.nan, 1.0]])
def test_errors_that_do_not_fall_have_no_order(errors):
    assert observed_order(list(range(1, len(errors) + 1))[::-1], errors) == (None, ())


def test_the_slope_over_a_tolerance_is_taken_from_all_rows():
    tolerance = [1e-3, 1e-5, 1e-7]
    slope, used = fitted_slope(tolerance, [2.0 * x**0.8 for x in tolerance])
    assert slope == pytest.approx(0.8, rel=1e-12)
    assert used == (0, 1, 2)
    assert fitted_slope(tolerance, [1e-2, float("nan"), float("nan")]) == (None, ())


def test_the_cost_of_an_error_lies_between_the_rows_around_it():
    # error = cost^-2: an error of 1e-3 costs 10^1.5
    rows = [ConvergenceRow(h, cost**-2.0, cost) for h, cost in ((1.0, 1.0), (0.1, 10.0), (0.01, 100.0))]
    assert cost_of_error(rows, 1e-3) == pytest.approx(10.0**1.5, rel=1e-12)
    assert cost_of_error(rows, 1.0) == 1.0
    assert cost_of_error(rows, 1e-5) is None
    stopped = ConvergenceRow(2.0, float("nan"), 0.5, message="stopped")
    assert cost_of_error([stopped, *rows], 2.0) == 1.0


SERIES = """
[converge]
quantity = "deviation.hook"
reference = 0.0
relative = false
runs = 3

[[converge.series]]
name = "second order"
parameter = "simulate.step"
values = ["10 ms", "5 ms", "2.5 ms"]

[[converge.series]]
name = "by tolerance"
set = { "simulate.integrator" = "accurate", "simulate.step" = "" }
parameter = "simulate.tolerance"
values = [1e-2, 1e-4, 1e-6]
"""


@pytest.fixture
def study(tmp_path, monkeypatch):
    """A study whose runs cost and err as laws say: step^2 at 1/step, tolerance at -log(tolerance); one stops."""
    import shutil
    from pathlib import Path

    folder = tmp_path / "linkage"
    folder.mkdir()
    text = (Path(__file__).parents[1] / "linkage.toml").read_text()
    history = '[[reference]]\nname = "hook"\nchannel = "hook.position"\nfile = "history.csv"\n'
    (folder / "case.toml").write_text(text + history + SERIES)
    (folder / "history.csv").write_text("time,x\n0,0\n1,1\n")
    shutil.copyfile(folder / "history.csv", folder / "other.csv")
    calls: list[str] = []

    def run(case, *, out, **_options):
        settings = case.simulate
        calls.append(settings.integrator)
        step, tolerance = settings.step, settings.solver_tolerance
        cpu_s = 1.0 / step if step else -np.log(tolerance)
        cpu_s *= (5.0, 1.0, 2.0)[len(calls) % 3]  # the median is twice the law
        outcome = Outcome.NOT_FINITE if tolerance == 1e-2 else Outcome.COMPLETED
        stage = StageReport("simulate", outcome, False, cpu_s, "a value is not finite", {"steps": 7})
        return RunReport(OutputFolder(out), (stage,))

    class Laws:
        def __init__(self, case, _folder):
            self.settings = case.simulate

        def evaluate(self, _text):
            return np.array(self.settings.step**2 if self.settings.step else 3.0 * self.settings.tolerance)

    monkeypatch.setattr(converge, "run_case", run)
    monkeypatch.setattr(converge, "Quantities", Laws)
    found, plot = converge.converge_case(folder, out=None, overrides=(), force=False, log=Log(quiet=True))
    return found, plot, calls


def test_several_series_are_run_and_compared(study):
    found, plot, calls = study
    assert calls == ["dele2"] * 9 + ["accurate"] * 7  # a run that stops is not repeated
    first, second = found.series
    assert [row.value for row in first.rows] == [1e-2, 5e-3, 2.5e-3]
    assert first.order == pytest.approx(2.0, rel=1e-9)
    assert [row.cpu_s for row in first.rows] == pytest.approx([200.0, 400.0, 800.0])
    assert second.order == pytest.approx(1.0, rel=1e-9)
    assert np.isnan(second.rows[0].error)
    assert second.rows[0].message == "a value is not finite"
    document = found.document()
    assert [series["name"] for series in document["series"]] == ["second order", "by tolerance"]
    assert "order" in document["series"][0]
    assert "slope" in document["series"][1]
    assert document["series"][1]["rows"][1]["steps"] == 7
    assert document["series"][0]["cpu_s_of_error"] == {
        "0.01": pytest.approx(200.0),
        "0.0001": pytest.approx(200.0),
        "1e-06": None,
    }
    assert plot.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert (plot.parent / "converge.json").is_file()


def test_the_table_says_what_is_an_order_and_what_a_slope(study):
    text = "\n".join(study_table(study[0]))
    assert "observed order: 2.00" in text
    assert "slope of log error over log tolerance: 1.00" in text
    assert "a value is not finite" in text
    assert "1e-06: not reached" in text
