"""Write the stability report: ``python tests/stability/report.py > docs/stability.md``."""

# ruff: noqa: T201  a script that prints

from __future__ import annotations

import inspect
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent))

from experiments import EXPERIMENTS
from mesh_experiments import MESH_EXPERIMENTS


def main() -> None:
    """Run all experiments and print a table of each."""
    print("# Numerical stability\n")
    print(
        "Made by `python tests/stability/report.py`; the same experiments are tests. A value is right up to its\n"
        "limit; where a setting asks for the impossible, a run may stop by itself and name the part."
    )
    for name, experiment in {**EXPERIMENTS, **MESH_EXPERIMENTS}.items():
        print(f"\n## {name.capitalize()}\n\n{inspect.cleandoc(experiment.__doc__ or '')}\n")
        print("| setting | measure | value | limit |\n|---|---|---|---|")
        for row in experiment():
            value = f"{row.value:.1e}" if not row.stopped else row.stopped
            print(f"| {row.setting} | {row.measure} | {value} | {row.limit:.1e} |", flush=True)


if __name__ == "__main__":
    main()
