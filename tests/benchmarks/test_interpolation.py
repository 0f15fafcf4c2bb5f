"""What the benchmark against peers computes by itself: costs, samples, and mechanisms that are closed."""

from __future__ import annotations

import importlib
import math
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


def load(name):
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(BENCHMARKS)
        return importlib.import_module(name)


m = load("peers_measure")
problems = load("peers_problems")


def measured(pairs):
    """Runs of one solver from pairs of cost [s] and error."""
    return [m.Measured("program", "solver", None, error, [seconds]) for seconds, error in pairs]


@pytest.mark.parametrize("order", [1.0, 2.0, 8.0])
def test_cost_follows_a_power_law_exactly(order):
    """A method of order p has error = c cost^-p, which is a line in logarithms."""
    runs = measured((cost, 3.0 * cost**-order) for cost in (1.0, 2.0, 5.0, 20.0))
    cost = m.cost_of(runs, 3.0 * 7.0**-order)
    assert cost.seconds == pytest.approx(7.0, rel=1e-12)
    assert not cost.bound


def test_cheapest_run_that_beats_the_target_is_only_a_bound():
    cost = m.cost_of(measured([(0.5, 1e-3), (1.0, 1e-5)]), 1e-2)
    assert (cost.seconds, cost.bound) == (0.5, True)


def test_target_that_no_run_reaches_has_no_cost():
    """Nothing is extrapolated."""
    assert m.cost_of(measured([(1.0, 1e-2), (2.0, 1e-3)]), 1e-6) is None
    assert m.cost_of([], 1.0) is None


def test_exact_run_costs_what_the_dearest_neighbour_costs_at_most():
    cost = m.cost_of(measured([(1.0, 1e-2), (2.0, 0.0)]), 1e-4)
    assert 1.0 < cost.seconds < 2.0


def test_tighter_run_that_costs_less_counts():
    """Step size control may stumble at a loose tolerance."""
    runs = measured([(3.0, 1e-1), (4.0, 1e-3), (2.0, 1e-6)])
    assert m.cost_of(runs, 1e-2).seconds == 2.0
    assert m.cost_of(runs, 1e-2).bound


def test_cheapest_solver_depends_on_the_target():
    low = measured((cost, cost**-1.0) for cost in (1.0, 1e2, 1e4, 1e6))
    high = measured((10.0 * cost, cost**-4.0) for cost in (1.0, 1e2))
    for row in high:
        row.solver = "high order"
    assert m.cheapest([low, high], 0.1).solver == "solver"
    assert m.cheapest([low, high], 1e-5).solver == "high order"


def test_ratio_says_which_side_is_a_bound():
    exact, bound = (m.Cost(seconds, flag, "", "") for seconds, flag in ((2.0, False), (1.0, True)))
    assert m.ratio_text(exact, bound) == "<=0.5"
    assert m.ratio_text(bound, exact) == ">=2"
    assert m.ratio_text(exact, None) == "-"


def test_samples_of_a_cubic_are_exact():
    times = np.array([0.0, 0.7, 1.0, 2.0])
    a = np.array([[1.0, -2.0, 0.5]])
    t = times[:, np.newaxis]
    history = m.History(times, a * (t**3 - t), a * (3.0 * t**2 - 1.0))
    wanted = np.linspace(0.0, 2.0, 101)
    s = wanted[:, np.newaxis]
    assert m.at_samples(history, wanted) == pytest.approx(a * (s**3 - s), abs=1e-14)


def test_samples_are_the_positions_where_times_agree():
    times = np.linspace(0.0, 1.0, 101)
    positions = np.random.default_rng(0).normal(size=(101, 3))
    assert m.at_samples(m.History(times, positions), times) is positions


def test_error_is_the_largest_distance_in_the_compared_components():
    times = np.linspace(0.0, 1.0, 101)
    reference = m.Reference(times, np.zeros((101, 2)), (0, 2), scale=0.5)
    positions = np.zeros((101, 3))
    positions[40] = [0.03, 9.0, 0.04]
    assert m.largest_error(m.History(times, positions), reference) == pytest.approx(0.1)
    positions[50, 0] = math.nan
    assert m.largest_error(m.History(times, positions), reference) == math.inf


def test_history_that_ends_early_has_no_error():
    reference = m.Reference(np.linspace(0.0, 1.0, 101), np.zeros((101, 1)), (0,))
    short = m.History(np.linspace(0.0, 0.9, 31), np.zeros((31, 3)), np.zeros((31, 3)))
    assert m.largest_error(short, reference) == math.inf


@pytest.mark.parametrize("name", sorted(problems.PROBLEMS))
def test_loops_are_closed_at_the_start(name):
    mechanism = problems.PROBLEMS[name].mechanism()
    poses = [*mechanism.start_poses(), (np.eye(3), np.zeros(3))]  # the ground is -1
    for closure in mechanism.closures:
        first, second = (
            poses[link][1] + poses[link][0] @ point
            for link, point in zip(closure.links, closure.points, strict=True)
        )
        assert first == pytest.approx(second, abs=1e-15)


def test_problem_is_chosen_by_its_first_part():
    assert [problem.name for problem in problems.select_problems(["A04", "A01"])] == [
        "A04-square",
        "A04-thin",
        "A01",
    ]
    with pytest.raises(SystemExit, match="A99"):
        problems.select_problems(["A99"])
