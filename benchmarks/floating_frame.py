"""CPU time of a step: floating frames by number of modes and of bodies, fixed frames, rigid bodies.

Run with ``python benchmarks/floating_frame.py``. Each number is the median of seven measurements of
process time, records excluded; set ``OMP_NUM_THREADS=1`` for comparable ones.
"""

from __future__ import annotations

import statistics
import time

import numpy as np
from scipy import sparse

from heavylift.modal.invariants import shape_integrals
from heavylift.modal.reduced import ReducedBody
from heavylift.solver.scene.scene import Fixed, FlexibleBody, Free, Motion, RigidBody, Scene
from heavylift.solver.simulation import Simulation

STEP = 1e-4
REPEATS = 7
SECONDS = 0.1  # of one measurement


def random_model(modes: int, count: int = 120) -> ReducedBody:
    """Random point masses with random mean-axis shapes of unit modal mass."""
    rng = np.random.default_rng(modes)
    nodes = rng.normal(size=(count, 3)) * [0.5, 0.2, 0.1]
    masses = np.full(count, 5.0 / count)
    rigid = np.zeros((3 * count, 6))
    for axis in range(3):
        rigid[axis::3, axis] = 1.0
        rigid[:, 3 + axis] = np.cross(np.eye(3)[axis], nodes).ravel()
    raw = rng.normal(size=(3 * count, modes))
    raw -= rigid @ np.linalg.lstsq(rigid, raw, rcond=None)[0]
    shapes = np.linalg.qr(raw)[0] / np.sqrt(masses[0])
    mode_shapes = np.ascontiguousarray(shapes.T.reshape(modes, count, 3))
    integrals = shape_integrals(nodes, mode_shapes, sparse.diags_array(masses).tocsr())
    frequencies = 2.0 * np.pi * np.linspace(20.0, 400.0, modes)
    labels = tuple(map(str, range(modes)))
    return ReducedBody(nodes, frequencies**2, mode_shapes, integrals, True, labels, np.zeros(modes), 0.0)


def flexible(name: str, reduced: ReducedBody, motion: Motion) -> FlexibleBody:
    rng = np.random.default_rng(1)
    return FlexibleBody(
        name,
        reduced,
        motion=motion,
        angular_velocity=np.array([3.0, -2.0, 4.0]),
        modal_velocity=0.01 * rng.normal(size=reduced.mode_count),
    )


def step_time(scene: Scene) -> float:
    """CPU time of a step [us]."""
    simulation = Simulation(scene, STEP, record_every=10**12)
    simulation.advance(10)
    count = 100
    while True:  # as many steps as fill the time of a measurement
        begin = time.process_time()
        simulation.advance(count)
        if time.process_time() - begin > SECONDS:
            break
        count *= 2
    measured = []
    for _ in range(REPEATS):
        begin = time.process_time()
        simulation.advance(count)
        measured.append((time.process_time() - begin) / count)
    assert not simulation.outcome, simulation.message
    return 1e6 * statistics.median(measured)


def report(title: str, rows: list[tuple[str, Scene, int]]) -> None:
    """Print one line a scene: time of a step, and of a step and body."""
    print(title)
    for label, scene, bodies in rows:
        us = step_time(scene)
        print(f"  {label:>12}  {us:9.2f} us/step  {us / bodies:8.2f} us/body")


def main() -> None:
    by_modes = [(n, random_model(n)) for n in (5, 20, 50, 100)]
    report(
        "one free floating frame",
        [(f"{n} modes", Scene((flexible("b", model, Free()),)), 1) for n, model in by_modes],
    )
    model = dict(by_modes)[20]
    report(
        "free floating frames of 20 modes, one model",
        [
            (f"{n} bodies", Scene(tuple(flexible(f"b{i}", model, Free()) for i in range(n))), n)
            for n in (1, 4, 16, 64)
        ],
    )
    report(
        "free floating frames of 20 modes, a model each",
        [
            (
                f"{n} bodies",
                Scene(tuple(flexible(f"b{i}", random_model(20), Free()) for i in range(n))),
                n,
            )
            for n in (4, 16, 64)
        ],
    )
    report("fixed frame", [("30 modes", Scene((flexible("b", random_model(30), Fixed()),)), 1)])
    inertia, spin = np.diag([1.0, 2.0, 2.5]), np.array([3.0, -2.0, 4.0])
    report(
        "free rigid bodies",
        [
            (
                f"{n} bodies",
                Scene(tuple(RigidBody(f"b{i}", 1.0, inertia, angular_velocity=spin) for i in range(n))),
                n,
            )
            for n in (1, 8, 64)
        ],
    )


if __name__ == "__main__":
    main()
