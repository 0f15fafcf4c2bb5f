"""Stability of an exchange against the spectral radii of the recursions, written down by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heavylift.pipeline.coupled.stability import exchange_stability
from heavylift.pipeline.coupling.master import Link, Master


class Mass:
    """``m x'' = F``, exact for a force that is linear over an interval."""

    def __init__(self, mass, x=1e-3):
        self.mass, self.state, self.told = mass, (x, 0.0), (0.0, 0.0)

    def set(self, values, rates):
        self.told = values["F"], rates["F"]

    def step(self, _time, dt):
        (x, v), (f, rate) = self.state, self.told
        self.state = (
            x + v * dt + (f * dt**2 / 2 + rate * dt**3 / 6) / self.mass,
            v + (f * dt + rate * dt**2 / 2) / self.mass,
        )

    def outputs(self):
        return {"x": self.state[0], "v": self.state[1]}

    def save(self):
        return self.state

    def restore(self, state):
        self.state = state


class Spring:
    """``F = -k x - c v``, without a state."""

    def __init__(self, k, c, x=1e-3):
        self.k, self.c, self.force = k, c, -k * x

    def set(self, values, rates):
        self.told = values, rates

    def step(self, _time, dt):
        x, v = (self.told[0][key] + dt * self.told[1][key] for key in ("x", "v"))
        self.force = -self.k * x - self.c * v

    def outputs(self):
        return {"F": self.force}

    def save(self):
        return self.force

    def restore(self, state):
        self.force = state


LINKS = [Link("mass", "x", "spring", "x"), Link("mass", "v", "spring", "v"), Link("spring", "F", "mass", "F")]


def systems(m, k, c):
    return {"spring": Spring(k, c), "mass": Mass(m)}


@pytest.mark.parametrize("damping", [10.0, 30.0, 150.0])
def test_forces_that_are_held_take_damping(damping):
    """The force of x and v at the beginning: det = 1 - c H/m + k H^2/2m, a little damping and much are not enough."""
    m, k, h = 2.0, 1000.0, 0.05
    found = exchange_stability(systems(m, k, damping), LINKS, "sequential", 0.0, h)
    matrix = np.array(
        [[1 - k * h**2 / (2 * m), h - damping * h**2 / (2 * m)], [-k * h / m, 1 - damping * h / m]]
    )
    radius = abs(np.linalg.eigvals(matrix)).max()
    assert found.growth == pytest.approx(radius, rel=2e-2)
    assert found.stable == (radius <= 1.0)
    assert ("unstable" in found.text) != found.stable


def test_repeated_exchanges_are_stable_where_others_are_not():
    m, k, h = 2.0, 1000.0, 0.05
    found = {
        method: exchange_stability(systems(m, k, 10.0), LINKS, method, 0.0, h)
        for method in ("held", "extrapolated", "iterated")
    }
    assert not found["held"].stable
    assert not found["extrapolated"].stable
    assert found["iterated"].stable


def test_the_loop_gain_is_that_of_one_interval():
    """A force that grows to F moves the mass by F H^2/6m, and F H/2m; the spring gives back k and c times that."""
    m, k, c, h = 2.0, 1000.0, 10.0, 0.05
    gain = k * h**2 / (6 * m) + c * h / (2 * m)
    assert exchange_stability(systems(m, k, c), LINKS, "iterated", 0.0, h).gain == pytest.approx(
        gain, rel=1e-6
    )


@pytest.mark.parametrize("method", ["held", "sequential", "extrapolated", "iterated"])
def test_what_is_told_is_what_happens(method):
    """The growth that was told, against that of a run of the master from a deviation."""
    m, k, c, h = 2.0, 1000.0, 10.0, 0.04
    parts = systems(m, k, c)
    told = exchange_stability(parts, LINKS, method, 0.0, h, count=80)
    assert parts["mass"].state == (1e-3, 0.0)
    master, seen = Master(parts, LINKS, method), []
    for n in range(200):
        master.step(n * h, h)
        x, v = parts["mass"].state
        seen.append(math.hypot(x, v / math.sqrt(k / m)))
    grown = (max(seen[170:]) / max(seen[70:100])) ** (1 / 100)
    assert told.growth == pytest.approx(grown, rel=1e-2)
