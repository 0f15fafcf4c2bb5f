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

from heavylift.numerics.arrays import Floats1  # noqa: TC001  the entry needs it
from heavylift.numerics.objects import entry
from heavylift.solver.contact.layout import Problem  # noqa: TC001  the entry needs it
from heavylift.solver.contact.solve.newton import ContactSolvers, NonsmoothNewton, solve_contacts

if TYPE_CHECKING:
    from numpy.typing import NDArray

REPEATS = 41
MANY, SOME = 2000, 10  # solutions in a measurement, of the small problems and of the others


@entry
def repeat(times: int, start: Floats1, solvers: ContactSolvers, problem: Problem) -> None:
    """Solve several times from the same impulses."""
    for _ in range(times):
        for i in range(start.shape[0]):
            problem.p[i] = start[i]
        solve_contacts(solvers, problem)


def time_of(
    problem: problems.ContactProblem, on_rows: bool, warm: bool, start: NDArray[np.float64] | None, times: int
) -> str:
    """Time of a solution, on the matrix of the rows or on the velocities."""
    solvers, packed = ContactSolvers((NonsmoothNewton(),)), problem.packed(on_rows)
    begin_with = np.zeros(3 * problem.count)
    if start is not None:
        begin_with[:] = start
    repeat(1, begin_with, solvers, packed)
    if warm:
        begin_with[:] = packed.p * (1.0 + 1e-4)
    measured = []
    for _ in range(REPEATS):
        begin = time.process_time()
        repeat(times, begin_with, solvers, packed)
        measured.append((time.process_time() - begin) / times)
    median, found = 1e6 * statistics.median(measured), packed.solution
    return f"{median:10.3f} us  status {found.status}, {found.iterations:3d} iterations, {found.residual:.0e}"


def rows(problem: problems.ContactProblem, warm: bool) -> str:
    """Time on the matrix of the rows."""
    return time_of(problem, True, warm, None, MANY)


def reduced(problem: problems.ContactProblem, start: NDArray[np.float64] | None = None) -> str:
    """Time on the velocities."""
    return time_of(problem, False, False, start, SOME)


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
