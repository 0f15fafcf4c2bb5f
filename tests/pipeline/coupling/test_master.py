"""Orders of couplings of two masses, against the exact solution of both together."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import expm

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.coupling.master import Link, Master
from heavylift.pipeline.results.storage import StopError

MASS = (1000.0, 500.0)  # [kg]
SPRING = (40e3, 20e3)  # to the ground [N/m]
BETWEEN, DAMPING = 20e3, 400.0  # [N/m], [N s/m]
START = np.array([0.1, 0.0, 0.0, 0.0])  # x1 [m], v1 [m/s], x2, v2
DURATION = 2.0


class Mass:
    """A mass on a spring, by the classical Runge-Kutta method in steps that are much shorter than the exchange."""

    def __init__(self, start, inputs):
        self.state, self.inputs = np.array(start), dict(inputs)
        self.rates = dict.fromkeys(inputs, 0.0)

    def set(self, values, rates):
        self.inputs, self.rates = dict(values), dict(rates)

    def step(self, _time, dt, count=8):
        h = dt / count

        def f(t, y):
            return np.array([y[1], self.force(y, {k: u + self.rates[k] * t for k, u in self.inputs.items()})])

        for i in range(count):
            t, y = i * h, self.state
            a = f(t, y)
            b = f(t + h / 2, y + h / 2 * a)
            c = f(t + h / 2, y + h / 2 * b)
            d = f(t + h, y + h * c)
            self.state = y + h / 6 * (a + 2 * b + 2 * c + d)
        self.inputs = {k: u + self.rates[k] * dt for k, u in self.inputs.items()}
        self.rates = dict.fromkeys(self.inputs, 0.0)

    def save(self):
        return self.state.copy(), dict(self.inputs)

    def restore(self, state):
        self.state, self.inputs = state[0].copy(), dict(state[1])


class First(Mass):
    """A force in, position and speed out."""

    def force(self, y, u):
        return (u["force"] - SPRING[0] * y[0]) / MASS[0]

    def outputs(self):
        return {"x": self.state[0], "v": self.state[1]}


class Second(Mass):
    """Position and speed of the other mass in, the force on it out; the spring between both is here."""

    def between(self, y, u):
        return BETWEEN * (y[0] - u["x"]) + DAMPING * (y[1] - u["v"])

    def force(self, y, u):
        return (-SPRING[1] * y[0] - self.between(y, u)) / MASS[1]

    def outputs(self):
        return {"force": self.between(self.state, self.inputs)}


LINKS = (
    Link("first", "x", "second", "x"),
    Link("first", "v", "second", "v"),
    Link("second", "force", "first", "force"),
)


def error(method, interval):
    """Largest error of the first mass [m]."""
    (m, n), (k, l), b, c = MASS, SPRING, BETWEEN, DAMPING
    both = np.array(
        [
            [0, 1, 0, 0],
            [-(k + b) / m, -c / m, b / m, c / m],
            [0, 0, 0, 1],
            [b / n, c / n, -(l + b) / n, -c / n],
        ]
    )
    first = First(START[:2], {"force": -BETWEEN * START[0]})
    second = Second(START[2:], {"x": START[0], "v": START[1]})
    master = Master({"first": first, "second": second}, LINKS, method)
    onward, exact, worst = expm(both * interval), START, 0.0
    for i in range(round(DURATION / interval)):
        master.step(i * interval, interval)
        exact = onward @ exact
        worst = max(worst, abs(first.state[0] - exact[0]))
    return worst


@pytest.mark.parametrize(
    ("method", "order"), [("held", 1), ("sequential", 1), ("extrapolated", 2), ("iterated", 2)]
)
def test_each_method_has_its_order(method, order):
    errors = [error(method, interval) for interval in (0.01, 0.005, 0.0025)]
    found = [math.log2(a / b) for a, b in pairwise(errors)]
    assert found == pytest.approx([order, order], abs=0.2), errors


class Times:
    """Gives a multiple of what it gets, and one more."""

    def __init__(self, factor):
        self.factor, self.value = factor, 1.0

    def set(self, values, rates):
        self.told = values["u"], rates["u"]

    def step(self, _time, dt):
        self.value = self.factor * (self.told[0] + self.told[1] * dt) + 1.0

    def outputs(self):
        return {"y": self.value}

    def save(self):
        return self.value

    def restore(self, state):
        self.value = state


BOTH = [Link("a", "y", "b", "u"), Link("b", "y", "a", "u")]


@pytest.mark.parametrize("factor", [0.5, -2.0, -30.0])
def test_an_exchange_settles_whatever_comes_back(factor):
    """``a = f b + 1, b = f a + 1``: a = b = 1/(1 - f), by what was measured of the loop within a few repetitions."""
    systems = {"a": Times(factor), "b": Times(factor)}
    master = Master(systems, BOTH, "iterated")
    for k in range(5):
        master.step(0.1 * k, 0.1)
        assert [one.value for one in systems.values()] == pytest.approx([1.0 / (1.0 - factor)] * 2, abs=4e-9)
    assert master.iterations <= 10
    other = Master(systems, BOTH, "iterated")
    other.memory = master.memory
    assert other.memory == master.memory
    other.step(0.5, 0.1)
    assert other.iterations <= 2


def test_an_exchange_that_does_not_settle_ends_with_its_link():
    """``a = b + 1, b = a + 1`` has no solution."""
    with pytest.raises(StopError, match=r"'[ab]' gives to '[ab]' \(y to u\) still changes") as stop:
        Master({"a": Times(1.0), "b": Times(1.0)}, BOTH, "iterated").step(0.0, 0.1)
    assert stop.value.outcome is Outcome.NOT_CONVERGED


def test_an_output_that_is_no_number_is_named():
    first = First([math.nan, 0.0], {"force": 0.0})
    second = Second([0.0, 0.0], {"x": 0.0, "v": 0.0})
    with pytest.raises(StopError, match="output 'x' of 'first' is nan"):
        Master({"first": first, "second": second}, LINKS, "held").step(0.0, 0.1)
