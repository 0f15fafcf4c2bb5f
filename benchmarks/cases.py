"""Every case of `cases/`, simulated a second time: what the CPU does beside stepping.

    python benchmarks/cases.py                        # all cases, an hour; a stopped run goes on where it was
    python benchmarks/cases.py hoist 'mbs_*'          # some, by name or pattern
    python benchmarks/cases.py --table                # writes what has been measured to docs/benchmarks.md
    python benchmarks/cases.py --profile hoist        # where the time of one goes, by function

A case is first run as far as needed: all kernels compiled, meshes, modes, surfaces and databases made. Measured
are then processes ``heavylift simulate CASE --force``, from the start of Python to the end of the process, the median
of three by the share that is not stepping; of a case that takes longer than half a minute, one. Their CPU time [s] is
split into

* *Python*: the interpreter, imports, end of the process;
* *read*: the case file read and checked, digests, whether meshes, modes, surfaces and databases are current;
* *scene*: bodies, surfaces, contacts, hulls from files to packed arrays;
* *start*: kernels loaded; equilibrium, paths, consistent start, diagnosis;
* *steps*: `Simulation.advance`, with the records it returns;
* *files*: segments, result file, manifest, and what is said of the run.

A process reports these itself (`cases_process.py`); time belongs to the innermost of what is watched.
Measurements are kept in ``--out``, one file a case, and are made anew if a source or the case has changed.
"""

from __future__ import annotations

import argparse
import functools
import hashlib
import json
import os
import re
import resource
import statistics
import subprocess
import sys
from dataclasses import asdict, dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cases_process import PARTS, REPORT
from installed import environment

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

ROOT = Path(__file__).resolve().parent.parent
CASES = ROOT / "cases"
PAGE = ROOT / "docs" / "benchmarks.md"
BEGIN, END = "<!-- begin: python benchmarks/cases.py --table -->", "<!-- end: benchmarks/cases.py -->"

LIMIT = 0.5
"""Share of a warm run that need not be steps."""
RUNS = 3
LONG = 30.0
"""CPU time [s] of a run that is measured once."""
SHORT = 0.1
"""Steps [s] in less than which no start can be half of a run."""
PROCESS = Path(__file__).with_name("cases_process.py")
"""What a measured process runs."""


# ---- cases ----


@dataclass(frozen=True)
class Row:
    """One case.

    Attributes
    ----------
    name
        Its folder, and its file if that is not ``case.toml``.
    sources
        Digest of the program and of the case when it was measured.
    runs
        How many processes.
    seconds
        CPU time [s] by part, of the process in the middle.
    start_s, compile_s
        What the run itself says of equilibrium and consistent start, and of kernels [s].
    steps
        How many.
    outcome
        How it ended.
    """

    name: str
    sources: str
    runs: int
    seconds: dict[str, float]
    start_s: float
    compile_s: float
    steps: int
    outcome: str

    @property
    def total(self) -> float:
        """CPU time of the process [s]."""
        return sum(self.seconds.values())

    @property
    def beside(self) -> float:
        """Share of the time that is not stepping."""
        return 1.0 - self.seconds["steps"] / self.total


def case_files() -> Iterator[tuple[str, Path]]:
    """Cases by name: those with a simulation."""
    for file in sorted(CASES.glob("*/*.toml")):
        text = file.read_text(encoding="utf-8")  # some are parts of a case, to be put together
        if re.search(r"^title = ", text, re.MULTILINE) and re.search(r"^\[simulate\]", text, re.MULTILINE):
            yield (file.parent.name if file.name == "case.toml" else f"{file.parent.name}/{file.stem}"), file


def sources_digest(case: Path) -> str:
    """Digest of the sources of the program and of the files of a case."""
    digest = hashlib.blake2b(digest_size=16)
    digest.update(_program_digest())
    digest.update(case.read_bytes())
    return digest.hexdigest()


@functools.cache
def _program_digest() -> bytes:
    import heavylift

    digest = hashlib.blake2b(digest_size=16)
    for top in sorted(Path(heavylift.__path__[0]).iterdir()):
        for file in sorted(top.rglob("*.py")):
            digest.update(file.read_bytes())
    return digest.digest()


def simulate(file: Path, out: Path, *words: str, mode: str) -> tuple[float, subprocess.CompletedProcess[str]]:
    """One process; its CPU time [s] with that of its children, and what it printed."""
    path = file.parent if file.name == "case.toml" else file
    command = [sys.executable, "-P", str(PROCESS), mode, "simulate", str(path), "--out", str(out), *words]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done


def measure(name: str, file: Path, out: Path, runs: int) -> Row:
    """Run a case as far as needed, then measure it.

    Raises
    ------
    RuntimeError
        If it does not run, with what it said.
    """
    folder, report = out / name, out / f"{name.replace('/', '_')}.parts"
    os.environ[REPORT] = str(report)
    simulate(file, folder, "--quiet", mode="--measured")  # nothing, if it has been simulated by these sources
    found: list[tuple[dict[str, float], dict[str, Any]]] = []
    while not found or (len(found) < runs and sum(found[-1][0].values()) < LONG):
        total, done = simulate(file, folder, "--force", "--json", mode="--measured")
        try:
            told = json.loads(done.stdout)
            told["steps"], told["start_s"]
        except (json.JSONDecodeError, KeyError):
            raise RuntimeError(f"{name}: {done.stdout}{done.stderr}") from None
        parts = json.loads(report.read_text(encoding="utf-8"))
        parts["Python"] += total - sum(parts.values())
        found.append((parts, told))
    report.unlink()
    beside = [sum(parts.values()) - parts["steps"] for parts, _ in found]
    parts, told = found[beside.index(statistics.median_low(beside))]
    return Row(
        name,
        sources_digest(file),
        len(found),
        parts,
        told["start_s"],
        told["compile_s"],
        told["steps"],
        told["outcome"],
    )


def kept(out: Path) -> dict[str, Row]:
    """What has been measured."""
    rows = (Row(**json.loads(file.read_text(encoding="utf-8"))) for file in sorted(out.glob("*.json")))
    return {row.name: row for row in rows}


# ---- words ----


def table(rows: Sequence[Row]) -> list[str]:
    """Lines of a table in Markdown, the largest share beside the steps first."""
    lines = [
        f"| case | {' | '.join(PARTS)} | all | not stepping |",
        "|---|" + "---|" * (len(PARTS) + 2),
    ]
    for row in sorted(rows, key=lambda row: -row.beside):
        cells = [f"{row.seconds[part]:.2f}" for part in PARTS]
        share = f"{100 * row.beside:.0f} %"
        ended = "" if row.outcome == "completed" else f" ({row.outcome.replace('_', ' ')})"
        lines.append(f"| `{row.name}`{ended} | {' | '.join(cells)} | {row.total:.2f} | {share} |")
    return lines


def summary(rows: Sequence[Row]) -> str:
    """How many cases keep the limit."""
    within = [row for row in rows if row.beside <= LIMIT]
    brief = [row for row in rows if row.beside > LIMIT and row.seconds["steps"] < SHORT]
    least = min((row.total - row.seconds["steps"] for row in rows), default=0.0)
    others = len(rows) - len(within) - len(brief)
    return (
        f"{len(rows)} cases: {len(within)} step for half of their time or more; {len(brief)} step for less than "
        f"{SHORT:g} s in all; {others} others do not. The least that a process takes beside its steps is {least:.2f} s."
    )


def write_table(rows: Sequence[Row]) -> None:
    """Put the table between its marks in the page of benchmarks."""
    text = PAGE.read_text(encoding="utf-8")
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not (begin and end):
        raise SystemExit(f"{PAGE}: expected the lines {BEGIN!r} and {END!r}")
    lines = "\n".join([BEGIN, "", summary(rows), "", *table(rows), "", END])
    PAGE.write_text(before + lines + after, encoding="utf-8")


def main() -> None:
    """Cases that are asked for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("case", nargs="*", help="names or patterns; all if none is given")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "cases", help="folder of results")
    parser.add_argument("--runs", type=int, default=RUNS, help=f"processes a case; {RUNS} by default")
    parser.add_argument("--again", action="store_true", help="measure what is kept, too")
    parser.add_argument(
        "--table", action="store_true", help=f"write {PAGE.relative_to(ROOT)}; measure nothing"
    )
    parser.add_argument("--profile", action="store_true", help="functions of a warm run of each case")
    options = parser.parse_args()
    every = dict(case_files())
    patterns = options.case or ["*"]
    chosen = [name for name in every if any(fnmatchcase(name, pattern) for pattern in patterns)]
    if not chosen:
        parser.error(f"{' '.join(patterns)}: no such case")
    options.out.mkdir(parents=True, exist_ok=True)
    rows = kept(options.out)
    if options.profile:
        for name in chosen:
            _, done = simulate(every[name], options.out / name, "--force", mode="--profiled")
            print(done.stdout, done.stderr)
        return
    if options.table:
        write_table([rows[name] for name in chosen if name in rows])
        return
    for name in chosen:
        row = rows.get(name)
        if row is None or options.again or row.sources != sources_digest(every[name]):
            try:
                row = measure(name, every[name], options.out, options.runs)
            except RuntimeError as error:
                print(error, file=sys.stderr, flush=True)
                continue
            text = json.dumps(asdict(row), indent=2)
            (options.out / f"{name.replace('/', '_')}.json").write_text(text, encoding="utf-8")
            rows[name] = row
        print(table([row])[-1], flush=True)
    print("\n".join(["", *table([rows[name] for name in chosen if name in rows])]))


if __name__ == "__main__":
    main()
