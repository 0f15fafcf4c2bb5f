"""Time of a whole step of the hanging steel plate, factorisation included, over the size of its mesh.

    python benchmarks/ancf_step.py

30 x 20 m, 5 mm, held by two corners and dropped from horizontal, step 20 ms, one thread, medians of CPU time.
"""

from __future__ import annotations

import math
import statistics

import numpy as np

from heavylift.numerics.outcome import Outcome
from heavylift.solver.scene.mesh_shapes import rectangle
from heavylift.solver.scene.meshes import ShellBody, ShellSection, Support
from heavylift.solver.scene.scene import Gravity, Scene
from heavylift.solver.simulation import Simulation

MESHES = ((6, 4), (12, 8), (24, 16), (48, 32), (60, 40))
REPEATS = 7


def plate(nx: int, ny: int, elasticity: str) -> Scene:
    """The plate with its two corners at x = 0 held."""
    mesh = rectangle(30.0, 20.0, nx, ny)
    edge = mesh.edges["x_min"]
    body = ShellBody(
        name="plate",
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(ShellSection(0.005, 7850.0, 2.1e11, 0.3),),
        supports=(Support(np.array([edge[0], edge[-1]]), {"position": "xyz"}),),
        elasticity=elasticity,  # type: ignore[arg-type]
    )
    return Scene((body,), (Gravity(np.array([0.0, 0.0, -9.81])),))


def step_time(nx: int, ny: int, elasticity: str) -> float:
    """Median CPU time of a step [s]."""
    simulation = Simulation(plate(nx, ny, elasticity), 0.02)
    count = max(2, 2400 // (nx * ny))
    simulation.advance(count)
    times = []
    for _ in range(REPEATS):
        before = simulation.cpu_seconds
        simulation.advance(count)
        times.append((simulation.cpu_seconds - before) / count)
    if simulation.outcome is not Outcome.COMPLETED:
        raise SystemExit(simulation.message)
    return statistics.median(times)


def main() -> None:
    """Print a table of both schemes with the exponent of the time over the number of nodes."""
    for elasticity in ("carried", "energy-momentum"):
        print(f"{elasticity}: elements, nodes, ms a step, exponent")
        last: tuple[int, float] | None = None
        for nx, ny in MESHES:
            nodes, time = (nx + 1) * (ny + 1), step_time(nx, ny, elasticity)
            exponent = math.log(time / last[1]) / math.log(nodes / last[0]) if last else math.nan
            print(f"  {nx:3d} x {ny:2d} {nodes:6d} {1e3 * time:9.3f} {exponent:6.2f}", flush=True)
            last = nodes, time


if __name__ == "__main__":
    main()
