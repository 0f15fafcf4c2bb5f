"""CPU time of setting inputs between steps, beside that of the steps.

A load hangs on a winch. Each number is the median of some repetitions, of a call from Python: a step alone, settings
alone, and a step with a new setting, which the accurate integrator takes as a corner.

python benchmarks/inputs.py
"""

from __future__ import annotations

import statistics
import time
from typing import TYPE_CHECKING

import numpy as np

from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.inputs.force import ForceInput
from heavylift.solver.inputs.winches import WinchSpeedInput
from heavylift.solver.scene.connections import RopePoint
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from collections.abc import Callable

CALLS, TIMES, STEP = 1000, 5, 0.01


def hoist() -> Scene:
    """A load of 2 kg on a rope of 10 m, whose winch and a force on it are inputs."""
    load = RigidBody("load", mass=2.0, inertia=np.diag([0.3, 0.4, 0.5]))
    path = (RopePoint("ground", np.array([0.0, 0.0, 10.0])), RopePoint("load", np.zeros(3)))
    rope = Rope(name="rope", path=path, axial_stiffness=2e4, damping=50.0, length=10.0)
    inputs = (
        ForceInput(name="push", body="load", point=np.zeros(3)),
        WinchSpeedInput(name="haul", rope="rope"),
    )
    return Scene((load,), (Gravity(np.array([0.0, 0.0, -9.81])),), ropes=(rope,), inputs=inputs)


def microseconds(call: Callable[[int], object]) -> float:
    """CPU time of a call, its number given [us]."""
    found = []
    for _ in range(TIMES):
        begin = time.process_time()
        for number in range(CALLS):
            call(number)
        found.append(1e6 * (time.process_time() - begin) / CALLS)
    return statistics.median(found)


def main() -> None:
    """A line for each integrator."""
    for integrator in ("dele2", "accurate"):
        simulation = Simulation(hoist(), STEP, integrator)
        simulation.warm_up()

        def step(_number: int, simulation: Simulation = simulation) -> None:
            simulation.advance(1)

        def push(number: int, simulation: Simulation = simulation) -> None:
            simulation.set_input("push", 1e-3 * (1 + number % 2))

        def haul(number: int, simulation: Simulation = simulation) -> None:
            simulation.set_input("haul", 1e-6 * (-1) ** number)

        def ramp(number: int, simulation: Simulation = simulation) -> None:
            now = simulation.time
            simulation.set_input("push", 1e-3, 0.1 * (-1) ** number, now + STEP)
            simulation.advance(1)

        def both(number: int, simulation: Simulation = simulation) -> None:
            push(number, simulation)
            simulation.advance(1)

        print(
            f"{integrator:9s} step {microseconds(step):6.1f} us; set a force {microseconds(push):5.1f},"
            f" a winch {microseconds(haul):5.1f} us; step with a force held {microseconds(both):6.1f},"
            f" with a rate {microseconds(ramp):6.1f} us"
        )


if __name__ == "__main__":
    main()
