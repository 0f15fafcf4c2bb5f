"""A small case that runs in a second, and a simulation that needs no compiler."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome


@pytest.fixture
def small_case(tmp_path: Path) -> Path:
    """Folder with a case of a clamped bar, eight bricks, three modes."""
    folder = tmp_path / "small_beam"
    folder.mkdir()
    shutil.copyfile(Path(__file__).parent / "small_beam.toml", folder / "case.toml")
    return folder


class FakeChannel(NamedTuple):
    name: str
    unit: str
    components: tuple[str, ...]
    column: int


class FakeSimulation:
    """Chaotic map with the interface of `heavylift.solver.simulation.Simulation`: any lost bit shows."""

    channels = (
        FakeChannel("a.position", "m", ("x", "y"), 0),
        FakeChannel("energy.balance", "J", ("",), 2),
    )

    def __init__(self, step: float = 0.5, record_every: int = 10) -> None:
        self.step, self.record_every = step, record_every
        self.step_index, self.cpu_seconds, self.ended = 0, 0.0, False
        self.outcome, self.message = Outcome.COMPLETED, ""
        self.x = np.array([0.1, 0.2, 0.3])
        self.diverge_at: int | None = None

    def record(self):
        return self.x.copy()

    def advance(self, steps):
        times, rows = [], []
        for _ in range(steps):
            if self.step_index == self.diverge_at:
                self.outcome, self.message = Outcome.NOT_FINITE, "body 'a' at step " + str(self.step_index)
                break
            self.x = 3.9 * self.x * (1.0 - self.x)
            self.step_index += 1
            if self.step_index % self.record_every == 0:
                times.append(self.step_index * self.step)
                rows.append(self.x.copy())
        self.cpu_seconds += 1e-6 * steps
        return np.array(times), np.array(rows).reshape(-1, 3)

    def state(self):
        return {"x": self.x.copy(), "n": np.array(self.step_index), "cpu": np.array(self.cpu_seconds)}

    def restore(self, state):
        self.x = state["x"].copy()
        self.step_index, self.cpu_seconds = int(state["n"]), float(state["cpu"])


@pytest.fixture
def fake_simulation():
    return FakeSimulation
