"""CPU of a step with ten outputs: the solver alone, from Python, through a pipe, and over TCP, of both sides.

OPENBLAS_NUM_THREADS=1 python benchmarks/exchange.py [CASE]
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

import heavylift
from heavylift.numerics.children import python_command
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.pipeline.stages.prepared import prepare_run
from heavylift.pipeline.stages.stages import make_parts

STEPS, ROUNDS, OUTPUTS = 1000, 9, 10


def cpu(process: int) -> float:
    """CPU time of a process [s], to the nanosecond (Linux)."""
    return 1e-9 * int(Path(f"/proc/{process}/schedstat").read_text(encoding="ascii").split()[0])


def solver_alone(case: Path) -> Any:
    """One call of the solver a step, as little as Python can do."""
    from heavylift.pipeline.log import Log

    loaded = load_case(case)
    folder = OutputFolder(Path(tempfile.mkdtemp()))
    make_parts(loaded, folder)
    solver = prepare_run(loaded, folder, Log(quiet=True)).simulation
    solver.warm_up()
    start = solver.state()

    def run() -> tuple[float, float]:
        solver.restore(start)
        begin = time.thread_time()
        for _ in range(STEPS):
            solver.advance(1)
        return time.thread_time() - begin, 0.0

    return run


def driven(sim: Any, server: int | None) -> Any:
    """Steps of a simulation here or elsewhere."""
    start, dt = sim.save(), sim.step_size
    names = list(sim.outputs)[:OUTPUTS]

    def run() -> tuple[float, float]:
        sim.restore(start)
        begin, there = time.thread_time(), cpu(server) if server else 0.0
        for _ in range(STEPS):
            sim.step(dt, outputs=names)
            sim.get(names)
        return time.thread_time() - begin, cpu(server) - there if server else 0.0

    return run


def main() -> None:
    """Medians of rounds in turn."""
    case = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "cases" / "hoist"
    token = Path(tempfile.mkdtemp()) / "token"
    code = "from heavylift.pipeline.commands.start import main; main()"
    command = python_command(
        "-c", code, "serve", str(case), "--port", "0", "--quiet", "--token-file", str(token)
    )
    with subprocess.Popen(command) as server:
        while not token.exists() and server.poll() is None:
            time.sleep(0.1)
        child, remote = heavylift.open_child(case), heavylift.connect(token_file=token)
        runs = {
            "solver alone": solver_alone(case),
            "from Python": driven(heavylift.Simulation(case), None),
            "through a pipe": driven(child, child.child_id),
            "over TCP": driven(remote, server.pid),
        }
        spent: dict[str, list[tuple[float, float]]] = {name: [] for name in runs}
        for _ in range(ROUNDS):
            for name, run in runs.items():
                spent[name].append(run())
        child.close()
        remote.close()
    alone = float(np.median(spent["solver alone"], axis=0)[0])
    for name, times in spent.items():
        here, there = np.median(times, axis=0) * 1e6 / STEPS
        beside = here + there - 1e6 * alone / STEPS
        print(f"{name:15} {here:6.1f} us here, {there:6.1f} us there, {beside:6.1f} us beside the solver")


if __name__ == "__main__":
    main()
