"""Work and precision of the flexible pendulum of Berzeri and Shabana (E = 0.7 MPa, 1.2 m, g = 9.81 m/s2, 1 s).

Run with ``python benchmarks/ancf_pendulum.py [repeats]``. For frames of 10, 20 and 40 elements of both models: error of
the tip against a run of the accurate integrator with a far smaller tolerance on the same mesh (time integration only),
largest over 20 times, and CPU time of the integration in one thread, median of the repeats. For each integrator the
fastest run that reaches 1e-2, 1e-4 and 1e-6 m is printed; with ``--all`` every run.
"""

from __future__ import annotations

import statistics
import sys
from typing import Any

import numpy as np

from heavylift.numerics.outcome import Outcome
from heavylift.solver.scene.meshes import FrameBody, FrameSection, Support
from heavylift.solver.scene.scene import Gravity, Scene
from heavylift.solver.simulation import Simulation

LEVELS = (1e-2, 1e-4, 1e-6)
DURATION, SAMPLES = 1.0, 20
STEPS = (1e-2, 5e-3, 2.5e-3, 1e-3, 5e-4, 2.5e-4, 1e-4, 5e-5)
TOLERANCES = (1e-2, 1e-3, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7)
SLOWEST = 2.0
"""CPU time of a run [s] after which no smaller step is tried."""


def pendulum(count: int, model: Any, elasticity: Any) -> Scene:
    """A straight frame along x, pinned at its first node."""
    x = np.linspace(0.0, 1.2, count + 1)
    body = FrameBody(
        name="beam",
        nodes=np.column_stack([x, 0.0 * x, 0.0 * x]),
        tangents=np.tile([1.0, 0.0, 0.0], (count + 1, 1)),
        elements=np.column_stack([np.arange(count), np.arange(1, count + 1)]),
        sections=(FrameSection(density=5540.0, youngs_modulus=0.7e6, area=0.0018, second_moment=1.215e-8),),
        supports=(Support(np.array([0]), {"position": "xyz"}),),
        model=model,
        elasticity=elasticity,
    )
    return Scene(bodies=(body,), forces=(Gravity(np.array([0.0, -9.81, 0.0])),))


def run(scene: Scene, count: int, *, step: float = 0.0, tolerance: float = 0.0) -> tuple[Any, float]:
    """Positions of the tip at the samples, None if the run stopped, and CPU time [s]."""
    interval = DURATION / SAMPLES
    if tolerance:
        simulation, steps = Simulation(scene, interval, "accurate", tolerance=tolerance), SAMPLES
    else:
        every = round(interval / step)
        simulation, steps = Simulation(scene, step, record_every=every), SAMPLES * every
    _, records = simulation.advance(steps)
    if simulation.outcome is not Outcome.COMPLETED:
        return None, simulation.cpu_seconds
    column = next(c.column for c in simulation.channels if c.name == "beam.position")
    return records[:, column + 3 * count : column + 3 * count + 3], simulation.cpu_seconds


def measure(count: int, model: str, repeats: int, *, everything: bool) -> None:
    """One mesh."""
    best, _ = run(pendulum(count, model, "auto"), count, tolerance=1e-12)
    print(f"{model}, {count} elements: ms for errors of {', '.join(f'{level:.0e}' for level in LEVELS)} m")
    schemes: dict[str, list[dict[str, float]]] = {
        name: [{"step": step} for step in STEPS] for name in ("carried", "energy-momentum", "explicit")
    }
    schemes["accurate"] = [{"tolerance": tolerance} for tolerance in TOLERANCES]
    for name, settings in schemes.items():
        found = []
        for setting in settings:
            scene = pendulum(count, model, "auto" if name == "accurate" else name)
            tip, first = run(scene, count, **setting)
            if tip is None:
                continue
            error = float(np.abs(tip - best).max())
            times = [first] + [run(scene, count, **setting)[1] for _ in range(repeats - 1)]
            found.append((error, 1e3 * statistics.median(times)))
            if everything:
                ((key, value),) = setting.items()
                print(f"    {name:16s} {key} {value:8.1e}  error {error:.1e} m  {found[-1][1]:8.1f} ms")
            if first > SLOWEST or error < LEVELS[-1]:
                break
        cells = []
        for level in LEVELS:
            fitting = [time for error, time in found if error <= level]
            cells.append(f"{min(fitting):8.1f}" if fitting else "       -")
        print(f"  {name:16s} {' '.join(cells)}", flush=True)


if __name__ == "__main__":
    arguments = [word for word in sys.argv[1:] if word != "--all"]
    for chosen in ("exact", "green-lagrange"):
        for elements in (10, 20, 40):
            measure(elements, chosen, int(arguments[0]) if arguments else 5, everything="--all" in sys.argv)
