"""heavylift and the installed peers (Exudyn, MuJoCo, Pinocchio) on the same multibody problems.

    pip install heavylift[peers]
    python benchmarks/peers.py [problem ...] [--targets 1e-2 1e-4 1e-6] [--rounds 3] [--json]
    python benchmarks/peers.py --table     # all rows of docs/benchmarks.md, and the ratios for --check
    python benchmarks/peers.py --record    # these ratios alone
    python benchmarks/peers.py --check     # fails if one is a quarter worse than recorded: two minutes

For each problem and target error: CPU time of heavylift, of the cheapest peer, and how many times more the
peer takes. Errors are the largest distance of the marked point from the reference of the case over 101
samples. Every solver climbs a ladder of steps or tolerances; its cost for a target is interpolated, log over
log, between the two runs around it, and marked `<=` where its cheapest run already beats the target. Runs
around the targets are timed round robin through all programs in one process, with one thread. Building the
model and compiling are not timed. heavylift writes its records within the measured time; peers write nothing
in theirs, and where their steps do not meet the samples, they get cubic Hermite interpolation for nothing.

The check measures some problems, of the peers only the solvers that were the cheapest when the ratios were
recorded. What is worse is measured again, up to three times: it fails only if it is so each time.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import importlib.util
import json
import sys
from typing import TYPE_CHECKING, Any

import peers_heavylift
from peers_measure import Cost, Measured, cheapest, measure, ratio_text
from peers_problems import PROBLEMS, Problem, select_problems
from peers_table import (
    CHECKED,
    DOCUMENT,
    RECORDED,
    ROWS,
    cells_of,
    put_between,
    read_recorded,
    table_lines,
    worse,
    write_recorded,
)
from threadpoolctl import threadpool_limits

if TYPE_CHECKING:
    from collections.abc import Container, Sequence
    from types import ModuleType

PEERS = {"exudyn": "peers_exudyn", "mujoco": "peers_mujoco", "pinocchio": "peers_pinocchio"}
"""Package of each peer, and the module here that runs it."""
TARGETS = (1e-2, 1e-4, 1e-6)
ATTEMPTS = 3
"""Measurements of a problem before the check calls it slow."""


def log(text: str) -> None:
    """Say how it goes, where it does not mix with the tables."""
    print(text, file=sys.stderr, flush=True)


def installed_peers() -> list[ModuleType]:
    """Modules of the peers that can be imported; of the others, say so."""
    found = []
    for package, module in PEERS.items():
        if importlib.util.find_spec(package) is None:
            log(f"{package} is not installed")
            continue
        with contextlib.redirect_stdout(sys.stderr):  # some greet
            found.append(importlib.import_module(module))
    return found


def milliseconds(cost: Cost | None) -> str:
    """Cost for a table."""
    return "-" if cost is None else f"{'<=' if cost.bound else ''}{1e3 * cost.seconds:.3g}"


def compare(
    problem: Problem,
    programs: Sequence[ModuleType],
    targets: Sequence[float],
    rounds: int,
    only: Container[tuple[str, str]] | None = None,
) -> dict[str, Any]:
    """Measurements of one problem as a document; of the peers perhaps some solvers only, by program and name."""
    ladders = [
        ladder
        for program in programs
        for ladder in program.ladders(problem)
        if only is None or program is peers_heavylift or (ladder.program, ladder.solver) in only
    ]
    with threadpool_limits(1), contextlib.redirect_stdout(sys.stderr):  # peers complain there
        rows = measure(ladders, peers_heavylift.case_reference(problem), targets, rounds, log)
    own = [made for ladder, made in zip(ladders, rows, strict=True) if ladder.program == peers_heavylift.NAME]
    others = [
        made for ladder, made in zip(ladders, rows, strict=True) if ladder.program != peers_heavylift.NAME
    ]
    costs = [
        {"target": target, "heavylift": cheapest(own, target), "peer": cheapest(others, target)}
        for target in targets
    ]
    return {"problem": problem.name, "costs": costs, "runs": [row for made in rows for row in made]}


def print_table(study: dict[str, Any]) -> None:
    """Lines of one problem."""
    for row in study["costs"]:
        own, peer = row["heavylift"], row["peer"]
        print(
            f"{study['problem']:<11} {row['target']:<8.0e} {milliseconds(own):>9}  {own.solver if own else '':<9}"
            f"{milliseconds(peer):>10}  {f'{peer.program} {peer.solver}' if peer else '':<26}"
            f"{ratio_text(own, peer):>8}",
            flush=True,
        )


def check(programs: Sequence[ModuleType], versions: dict[str, str], rounds: int) -> None:
    """Measure what is recorded again.

    Raises
    ------
    SystemExit
        If a ratio has become worse, with all that have.
    """
    known, recorded = read_recorded(RECORDED)
    changed = [f"{name} {versions.get(name, 'not installed')} ({known[name]})" for name in known]
    log("now, and when the ratios were recorded: " + ", ".join(changed))
    failed = []
    for problem in (PROBLEMS[name] for name in dict.fromkeys(cell.problem for cell in recorded)):
        cells = [cell for cell in recorded if cell.problem == problem.name]
        solvers = {(cell.program, cell.solver) for cell in cells}
        targets = [cell.target for cell in cells]
        slow: list[Any] = []
        for _ in range(ATTEMPTS):
            now = cells_of([compare(problem, programs, targets, rounds, solvers)])
            for cell in now:
                print(f"{cell.problem:<11} {cell.target:<8.0e} {cell.ratio:.3g}", flush=True)
            slow = worse(cells, now)
            cells = [cell for cell, _ in slow]
            if not slow:
                break
            targets = [cell.target for cell in cells]
        failed += slow
    if failed:
        raise SystemExit(
            "slower against peers than recorded in "
            f"{RECORDED.name}: "
            + "; ".join(
                f"{cell.problem} at {cell.target:g}: {ratio:.3g}, recorded {cell.ratio:.3g}"
                for cell, ratio in failed
            )
        )


def as_json(value: object) -> Any:
    """Costs and runs as JSON."""
    if isinstance(value, Cost):
        return vars(value)
    assert isinstance(value, Measured)
    return {
        "program": value.program,
        "solver": value.solver,
        "setting": value.run.setting,
        "error": value.error,
        "cpu_s": value.cost,
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("problem", nargs="*", help=f"all if none is named: {', '.join(PROBLEMS)}")
    parser.add_argument("--targets", type=float, nargs="+", default=TARGETS, help="errors to reach [m]")
    parser.add_argument("--rounds", type=int, default=3, help="times that every run is measured")
    parser.add_argument("--json", action="store_true", help="print one JSON document with all runs")
    modes = parser.add_mutually_exclusive_group()
    modes.add_argument(
        "--table", action="store_true", help=f"write the table of {DOCUMENT.name}, and the ratios"
    )
    modes.add_argument("--record", action="store_true", help=f"write ratios into {RECORDED.name}")
    modes.add_argument("--check", action="store_true", help="compare with the recorded ratios")
    options = parser.parse_args()
    if options.problem and (options.table or options.record or options.check):
        parser.error("--table, --record and --check have problems of their own")
    names = list(ROWS) if options.table else list(CHECKED) if options.record else options.problem
    problems = select_problems(names)
    programs = [peers_heavylift, *installed_peers()]
    if (options.table or options.record or options.check) and len(programs) < 1 + len(PEERS):
        raise SystemExit("needs all peers: pip install heavylift[peers]")
    versions = {program.NAME: program.VERSION for program in programs}
    if options.check:
        check(programs, versions, options.rounds)
        return
    if not options.json:
        print("CPU ms for a target error: " + ", ".join(" ".join(pair) for pair in versions.items()))
        print(f"{'problem':<11} {'error':<8} {'heavylift':>9}  {'':<9}{'peer':>10}  {'':<26}{'ratio':>8}")
    studies = []
    for problem in problems:
        log(f"{problem.name} ...")
        studies.append(compare(problem, programs, options.targets, options.rounds))
        if not options.json:
            print_table(studies[-1])
    if options.table:
        text = DOCUMENT.read_text(encoding="utf-8")
        DOCUMENT.write_text(put_between(text, table_lines(studies)), encoding="utf-8")
    if options.table or options.record:
        write_recorded(RECORDED, versions, cells_of(studies))
    if options.json:
        print(json.dumps({"versions": versions, "problems": studies}, default=as_json, indent=1))


if __name__ == "__main__":
    main()
