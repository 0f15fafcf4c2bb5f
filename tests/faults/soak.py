"""Faults by the hundred, by hand: `python tests/faults/soak.py PART --count 200 --seed 1`.

A part is a module `soak_PART.py` beside this file. The first line of its docstring says what it does to whom; its
function `run(count, seed)` does that `count` times, the same for the same `seed`, and returns counts by their names:
how often what happened. What may never happen is counted as `"failures"`, and then the exit code is 1; a part prints a
line for each of them, with what repeats it. Small counts of the parts are slow tests.
"""

from __future__ import annotations

import argparse
import importlib
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import ModuleType

HERE = Path(__file__).resolve().parent


def parts() -> dict[str, ModuleType]:
    """The parts by their names."""
    if str(HERE) not in sys.path:
        sys.path.insert(0, str(HERE))
    names = sorted(path.stem for path in HERE.glob("soak_*.py"))
    return {name.removeprefix("soak_"): importlib.import_module(name) for name in names}


def main() -> int:
    """Run one part and print its counts."""
    found = parts()
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(dest="part", required=True)
    for name, module in found.items():
        command = commands.add_parser(name, help=(module.__doc__ or "").splitlines()[0])
        command.add_argument("--count", type=int, default=200)
        command.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args()
    begin = time.monotonic()
    counts = found[chosen.part].run(chosen.count, chosen.seed)
    width = max(len(name) for name in counts)
    for name, count in counts.items():
        sys.stdout.write(f"{name:{width}}  {count}\n")
    sys.stdout.write(
        f"{chosen.part} --count {chosen.count} --seed {chosen.seed}: {time.monotonic() - begin:.0f} s\n"
    )
    return 1 if counts.get("failures") else 0


if __name__ == "__main__":
    sys.exit(main())
