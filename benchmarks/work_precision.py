"""heavylift alone: CPU time for a target error beside its limits, and the time of a step of `dele2`.

    python benchmarks/work_precision.py [problem ...] [--rounds 3] [--no-steps]

The limits are what the cheapest of Exudyn, MuJoCo and Pinocchio takes, or less where an earlier
implementation took less, on one thread of a shared 2-core Xeon. How costs are found: see `peers.py`.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import peers_heavylift
from peers import TARGETS, log, milliseconds
from peers_measure import cheapest, measure
from peers_problems import PROBLEMS, chain_problem, four_bars_problem, select_problems
from threadpoolctl import threadpool_limits

if TYPE_CHECKING:
    from peers_problems import Problem

LIMITS = {
    "A01": (0.38, 0.38, 0.56),
    "A02-1": (1.9, 3.3, 4.8),
    "A02-10": (9.0, 18.0, 20.0),
    "A02-40": (33.0, 69.0, 103.0),
    "A03": (3.0, 5.9, 9.3),
    "A04-square": (1.6, 4.6, 7.5),
    "A05": (1.3, 9.9, 97.0),
    "chain-10": (0.8, 2.2, 4.6),
    "chain-200": (13.0, 21.0, 62.0),
}
"""CPU time for each of `TARGETS` [ms]."""
LOOP_LIMIT, LINK_LIMIT = 2.0, 0.65
"""CPU time of a step for each loop of A02 and each link of the chain [us]."""
LOOPS = (1, 2, 5, 10, 20, 40)
LINKS = (10, 20, 50, 100, 200, 500, 1000, 2000)
LOOP_STEP, LINK_STEP = 1e-2, 1e-3
"""Steps that are timed [s]."""
STEP_COUNT = 200


def print_costs(problem: Problem, rounds: int) -> None:
    """One line: cost of each target, and its limit; a mark where it is above."""
    with threadpool_limits(1):
        reference = peers_heavylift.case_reference(problem)
        rows = measure(peers_heavylift.ladders(problem), reference, TARGETS, rounds, log)
    line = f"{problem.name:<11}"
    for number, target in enumerate(TARGETS):
        cost = cheapest(rows, target)
        limit = LIMITS.get(problem.name)
        above = limit is not None and (cost is None or 1e3 * cost.seconds > limit[number])
        text = f"{milliseconds(cost)}{'!' if above else ''}"
        line += f"{text:>10} /{limit[number] if limit else '-':>6} {cost.solver if cost else '':<9}"
    print(line, flush=True)


def print_steps(title: str, problems: dict[int, Problem], step: float, limit: float) -> None:
    """Time of a step against the size of the mechanism, and a line through it by least relative squares."""
    sizes = np.array(list(problems), dtype=float)
    with threadpool_limits(1):
        times = np.array(
            [
                peers_heavylift.step_microseconds(peers_heavylift.scene_of(problem), step, STEP_COUNT)
                for problem in problems.values()
            ]
        )
    for size, time in zip(sizes, times, strict=True):
        print(f"{title} {size:5.0f}  {time:10.2f} us/step  {time / size:6.3f} us each", flush=True)
    slope, offset = np.polyfit(sizes, times, 1, w=1.0 / times)
    off = np.abs((slope * sizes + offset) / times - 1.0).max()
    print(f"{title} line   {offset:.2f} us + {slope:.3f} us each (limit {limit}), within {100.0 * off:.0f} %")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "problem", nargs="*", help=f"those with limits if none is named; {', '.join(PROBLEMS)}"
    )
    parser.add_argument("--rounds", type=int, default=3, help="times that every run is measured")
    parser.add_argument("--no-steps", action="store_true", help="leave out the times of a step")
    options = parser.parse_args()
    problems = select_problems(options.problem or list(LIMITS))
    titles = "".join(f"{f'{target:.0e}':>10} / limit          " for target in TARGETS)
    print(f"CPU ms for a target error\n{'problem':<11}{titles}")
    for problem in problems:
        print_costs(problem, options.rounds)
    if not options.no_steps:
        print(f"dele2, Python {sys.version.split()[0]}, heavylift {peers_heavylift.VERSION}")
        print_steps("A02 loops  ", {n: four_bars_problem(n) for n in LOOPS}, LOOP_STEP, LOOP_LIMIT)
        # lengths without a reference of their own load with another one: step times compare nothing
        unused = ("reference.0.file=reference_10.csv",)
        chains = {
            n: replace(chain_problem(n), overrides=(*chain_problem(n).overrides, *unused)) for n in LINKS
        }
        print_steps("chain links", chains, LINK_STEP, LINK_LIMIT)


if __name__ == "__main__":
    main()
