"""Trees in joint coordinates beside the same joints as rows, in the accurate integrator.

    python benchmarks/joint_trees.py [problem ...]

For each problem, by rows and by trees: evaluations of a run without records in between, CPU time of one with its
share of the steps, that of a body in it, and CPU time of a record more. The two are timed in turn, and the least of
several runs counts. Problems are those of `peers.py`; where loops need more rows than trees take, both are rows.
"""

from __future__ import annotations

import argparse
import time
from typing import TYPE_CHECKING

import peers_heavylift
from peers_problems import select_problems
from threadpoolctl import threadpool_limits

from heavylift.solver.integrate.dop853 import STAGES
from heavylift.solver.integrate.integration import carried
from heavylift.solver.integrate.trees import forest
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from peers_problems import Problem

TOLERANCE, SAMPLES, REPEATS = 1e-4, 100, 9
WAYS = {"rows": False, "trees": True}


def run_of(problem: Problem, trees: bool, records: int) -> Simulation:
    """A run with its kernels, and records at equal intervals."""
    forest.SERVED = trees
    scene = peers_heavylift.scene_of(problem)
    made = Simulation(scene, problem.duration / records, "accurate", tolerance=TOLERANCE, start="project")
    made.warm_up()
    return made


def least_seconds(runs: list[Simulation], records: list[int]) -> list[float]:
    """CPU time of each run from its start, the least of several."""
    starts, best = [run.state() for run in runs], [float("inf")] * len(runs)
    for _ in range(REPEATS):
        for i, (run, start) in enumerate(zip(runs, starts, strict=True)):
            run.restore(start)
            begin = time.thread_time()
            run.advance(records[i])
            best[i] = min(best[i], time.thread_time() - begin)
    return best


def print_problem(problem: Problem) -> None:
    """Two lines."""
    runs = [run_of(problem, trees, records) for trees in WAYS.values() for records in (1, SAMPLES)]
    best = least_seconds(runs, [1, SAMPLES] * len(WAYS))
    for i, way in enumerate(WAYS):
        run, (one, many) = runs[2 * i], best[2 * i : 2 * i + 2]
        systems = run._layout.systems  # noqa: SLF001
        found = way if way == "rows" or any(isinstance(kind, forest.Forest) for kind in systems) else "rows"
        count = STAGES * run.solver_steps + (STAGES - 1) * int(carried(systems, 0).progress.rejections)
        bodies = sum(len(kind.table) for kind in run._layout.bodies)  # noqa: SLF001
        print(
            f"{problem.name:<11} {found:<6} {count:>6} {1e6 * one / count:>9.3f} {1e6 * one / count / bodies:>9.3f}"
            f" {1e6 * (many - one) / (SAMPLES - 1):>9.2f}",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("problem", nargs="*", help="all that are rigid if none is named")
    print(f"{'':<11} {'':<6} {'evalu-':>6} {'us each':>9} {'a body':>9} {'us a':>9}")
    print(f"{'problem':<11} {'joints':<6} {'ations':>6} {'':>9} {'':>9} {'record':>9}")
    with threadpool_limits(1):
        for problem in select_problems(parser.parse_args().problem):
            print_problem(problem)


if __name__ == "__main__":
    main()
