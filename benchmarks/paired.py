"""Two installations of heavylift beside each other: what has become slower, row by row.

    python benchmarks/paired.py OLD_PYTHON NEW_PYTHON [benchmark ...] [--rounds 3]

A benchmark is a script of this folder, with options in the same word: ``"work_precision.py A01 --no-steps"``. Both
interpreters run it in turn, each that of its own sources if there are any, once to compile what is missing and then in
rounds. Numbers of a row that vary from run to run are times: printed is the median over the rounds of new over old,
with the range over the rounds, and a mark where all of it is beyond `TOLD`. Numbers that are the same in all rounds of
each are results: they are printed where old and new differ. Rows are those with the same words before their first
number, in order.
"""

from __future__ import annotations

import argparse
import re
import shlex
import statistics
import subprocess
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
BENCHMARKS = (
    "work_precision.py",
    "floating_frame.py",
    "ancf_step.py",
    "contact_solver.py",
    "collision_queries.py",
    "sea.py",
    "transporters.py",
)
TOLD = 0.03
"""Share by which a time may differ unmarked."""
NUMBER = re.compile(r"(?<![\w.-])-?\d+(?:\.\d*)?(?:e[-+]?\d+)?(?!\w)")


def rows_of(output: str) -> dict[str, tuple[str, list[float]]]:
    """Words and numbers of each line, by its words before the first number, counted: marks of times may follow."""
    rows: dict[str, tuple[str, list[float]]] = {}
    seen: dict[str, int] = {}
    for line in output.splitlines():
        words = " ".join(NUMBER.split(line, maxsplit=1)[0].split())
        seen[words] = seen.get(words, 0) + 1
        rows[f"{words} [{seen[words]}]"] = (
            " ".join(NUMBER.sub("#", line).split()),
            [float(text) for text in NUMBER.findall(line)],
        )
    return rows


def compared(old: list[list[float]], new: list[list[float]]) -> str:
    """Numbers of a row in the rounds of both, as words; empty if there is nothing to say.

    Parameters
    ----------
    old, new
        Of each round the numbers of the row.
    """
    words = []
    for place in range(min(map(len, old + new))):
        before, now = [row[place] for row in old], [row[place] for row in new]
        if len(set(before)) == len(set(now)) == 1:
            if before[0] != now[0]:
                words.append(f"{before[0]:g} is {now[0]:g}")
            continue
        ratios = [b / a for a, b in zip(before, now, strict=True) if a > 0.0]
        if not ratios:
            continue
        low, high = min(ratios), max(ratios)
        mark = "!" if low > 1.0 + TOLD or high < 1.0 - TOLD else ""
        words.append(f"{statistics.median(ratios):.3f} ({low:.2f}..{high:.2f}){mark}")
    return ", ".join(words)


def label(words: str, rows: list[list[float]]) -> str:
    """Words of a row with the numbers that are the same in all runs: these say what it is about."""
    columns = [set(numbers) for numbers in zip(*rows, strict=False)]
    texts = iter([f"{min(column):g}" if len(column) == 1 else "#" for column in columns])
    return re.sub("#", lambda _: next(texts, "#"), words)


def folder_of(python: str) -> Path:
    """Folder with the benchmarks of an installation: its own if it is one of sources, whose internals they call."""
    words = [python, "-P", "-c", "import heavylift; print(heavylift.__path__[0])"]
    made = subprocess.run(words, capture_output=True, text=True, check=True)
    own = Path(made.stdout.strip()).parent / FOLDER.name
    return own if own.is_dir() else FOLDER


def run(python: str, benchmark: str) -> dict[str, tuple[str, list[float]]]:
    """Rows of a benchmark by one interpreter.

    Raises
    ------
    SystemExit
        If it fails, with what it said.
    """
    script, *options = shlex.split(benchmark)
    made = subprocess.run(
        [python, str(folder_of(python) / script), *options], capture_output=True, text=True, check=False
    )
    if made.returncode:
        raise SystemExit(f"{python} {benchmark}: {made.stderr.strip()[-2000:]}")
    return rows_of(made.stdout)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("old", help="Python of the old installation")
    parser.add_argument("new", help="Python of the new one")
    parser.add_argument("benchmark", nargs="*", default=BENCHMARKS, help=f"else {', '.join(BENCHMARKS)}")
    parser.add_argument("--rounds", type=int, default=3, help="times that each of both runs a benchmark")
    options = parser.parse_args()
    for benchmark in options.benchmark:
        print(benchmark, flush=True)
        runs: dict[str, list[dict[str, tuple[str, list[float]]]]] = {options.old: [], options.new: []}
        for number in range(options.rounds + 1):
            order = (options.old, options.new)[:: 1 if number % 2 else -1]
            for python in order:
                print(f"{benchmark}, round {number}: {python}", file=sys.stderr, flush=True)
                found = run(python, benchmark)
                if number:
                    runs[python].append(found)
        old, new = runs[options.old], runs[options.new]
        for key, (words, _) in old[0].items():
            if not all(key in rows for rows in old + new):
                print(f"  {words}: not in all runs")
                continue
            before, now = [rows[key][1] for rows in old], [rows[key][1] for rows in new]
            told = compared(before, now)
            if told:
                print(f"  {label(words, before + now)}: {told}", flush=True)


if __name__ == "__main__":
    main()
