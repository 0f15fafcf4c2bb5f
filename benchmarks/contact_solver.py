"""CPU time of the contact solver: single contacts, stacks, and many contacts on two bodies.

Run with ``python benchmarks/contact_solver.py``. Each number is the median of measurements of process time; iterations
and residual are those of the solution.
"""

from __future__ import annotations

import statistics
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

sys.path.append(str(Path(__file__).resolve().parent.parent / "tests" / "solver" / "contact"))

import contact_problems as problems

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.newton import solve_contacts, solve_contacts_reduced, workspace_length

if TYPE_CHECKING:
    from numpy.typing import NDArray

REPEATS = 41
MANY = 2000  # of the small problems


@kernel
def repeat_rows(times, count, kinds, parameters, w0, W, start, p, w, workspace):  # type: ignore[no-untyped-def]
    status, iterations, residual = 0, 0, 0.0
    for _ in range(times):
        for i in range(3 * count):
            p[i] = start[i]
        status, iterations, residual = solve_contacts(count, kinds, parameters, w0, W, p, w, workspace)
    return status, iterations, residual


def rows(problem: problems.ContactProblem, warm: bool) -> str:
    """Time on the matrix of the rows."""
    n = 3 * problem.count
    start, p, w = np.zeros(n), np.zeros(n), np.zeros(n)
    workspace = np.zeros(workspace_length(problem.count, n))
    arguments = (problem.count, problem.kinds, problem.parameters, problem.N @ problem.y0, problem.W)
    repeat_rows(1, *arguments, start, p, w, workspace)
    if warm:
        start[:] = p * (1.0 + 1e-4)
    times = []
    for _ in range(REPEATS):
        begin = time.process_time()
        result = repeat_rows(MANY, *arguments, start, p, w, workspace)
        times.append((time.process_time() - begin) / MANY)
    return report(times, result)


def reduced(problem: problems.ContactProblem, start: NDArray[np.float64] | None = None) -> str:
    """Time on the velocities."""
    size = len(problem.y0)
    p, y = np.zeros(3 * problem.count), np.zeros(size)
    workspace = np.zeros(workspace_length(problem.count, size))
    times = []
    for _ in range(REPEATS):
        p[:] = 0.0 if start is None else start
        begin = time.process_time()
        result = solve_contacts_reduced(
            problem.count,
            problem.kinds,
            problem.parameters,
            problem.ends,
            problem.blocks,
            size,
            problem.y0,
            problem.B,
            p,
            y,
            workspace,
        )
        times.append(time.process_time() - begin)
    return report(times, result)


def report(times: list[float], result: tuple[int, int, float]) -> str:
    status, iterations, residual = result
    return f"{1e6 * statistics.median(times):10.3f} us  status {status}, {iterations:3d} iterations, {residual:.0e}"


def small(count: int, mu: float, slip: float) -> problems.ContactProblem:
    """Corners of one box on the ground."""
    arms = [problems.BOX * [x, y, -1.0] for x in (-1.0, 1.0) for y in (-1.0, 1.0)][:count]
    contacts = [[(0, problems.rows_at(problems.UP, arm))] for arm in arms]
    y0 = np.array([slip, 0.3 * slip, -0.1, 0.0, 0.0, 0.0])
    return problems.build(contacts, y0, problems.inverse_masses(np.array([1000.0]), problems.BOX), mu)


def main() -> None:
    print("rows, cold and warm")
    for count in (1, 2, 3):
        for words, mu, slip in (
            ("closed, no friction", 0.0, 0.1),
            ("sticks", 0.5, 0.001),
            ("slips", 0.5, 1.0),
        ):
            problem = small(count, mu, slip)
            print(f"  {count} {words:24s} {rows(problem, False)}")
            print(f"  {'':26s} {rows(problem, True)}")
    print("velocities")
    for count, push in ((10, 0.003), (10, 0.03), (10, 0.1), (30, 0.003), (30, 0.03), (30, 0.1)):
        problem = problems.stack(count, np.random.default_rng(1), push)
        print(f"  stack of {count}, push {push:5.3f}   {reduced(problem)}")
        p = problem.solve()[3].ravel()
        problem.y0 *= 1.001
        print(f"  {'warm':26s} {reduced(problem, p)}")
    for stiffness in (1e9, 1e10, 1e11):
        problem = problems.tank_in_hull(np.random.default_rng(1), stiffness=stiffness)
        print(f"  601 contacts, k {stiffness:.0e}    {reduced(problem)}")
        p = problem.solve()[3].ravel()
        problem.y0 *= 1.001
        print(f"  {'warm':26s} {reduced(problem, p)}")
        problem.parameters["friction"] = 0.0
        print(f"  {'without friction':26s} {reduced(problem)}")


if __name__ == "__main__":
    main()
