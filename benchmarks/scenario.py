"""Time of a step of 20 loads on ropes without a scenario, and with one phase that waits for 1 or 200 conditions.

python benchmarks/scenario.py
"""

from __future__ import annotations

import time

import numpy as np

from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.scene.connections import GROUND, RopePoint
from heavylift.solver.scene.scenario import Condition, Phase, Scenario
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.signals import Signal, Term
from heavylift.solver.simulation import Simulation

LOADS, STEPS, ROUNDS = 20, 20_000, 9
CHANNELS = (
    *((f"{kind}", axis) for kind in ("load_{}.position", "load_{}.velocity") for axis in "xyz"),
    ("load_{}.orientation", "q1"),
    ("load_{}.orientation", "q2"),
    ("rope_{}.tension", ""),
    ("rope_{}.rest_length", ""),
)


def scene(conditions: int) -> Scene:
    """Ropes side by side; the conditions never become true, each looks at a channel of its own."""
    bodies, ropes = [], []
    for i in range(LOADS):
        bodies.append(RigidBody(f"load_{i}", 1e4, 1e3 * np.eye(3), position=np.array([5.0 * i, 0.0, 0.0])))
        ends = (RopePoint(GROUND, np.array([5.0 * i, 0.0, 20.0])), RopePoint(f"load_{i}", np.zeros(3)))
        ropes.append(Rope(name=f"rope_{i}", path=ends, axial_stiffness=1e8))
    terms = [Term(channel.format(i), axis) for i in range(LOADS) for channel, axis in CHANNELS]
    waits = tuple(Condition(Signal((term,)), 1e12) for term in terms[:conditions])
    scenario = Scenario((Phase("wait", until=waits, ends_with="any"),)) if waits else None
    gravity = Gravity(np.array([0.0, 0.0, -9.81]))
    return Scene(tuple(bodies), forces=(gravity,), ropes=tuple(ropes), scenario=scenario)


def main() -> None:
    """Microseconds of CPU a step: medians of rounds in turn."""
    counts = (0, 1, 200)
    runs = [Simulation(scene(count), step=1e-2, record_every=STEPS) for count in counts]
    spent: list[list[float]] = [[] for _ in runs]
    for run in runs:
        run.advance(STEPS)
    for _ in range(ROUNDS):
        for took, run in zip(spent, runs, strict=True):
            begin = time.process_time()
            run.advance(STEPS)
            took.append((time.process_time() - begin) / STEPS * 1e6)
    medians = [float(np.median(took)) for took in spent]
    for count, median in zip(counts, medians, strict=True):
        print(f"{count} conditions: {median:.2f} us a step")
    print(f"199 more: {medians[2] - medians[1]:.2f} us a step")


if __name__ == "__main__":
    main()
