"""Runs of a case with other seeds of its waves and winds, for the statistics of extremes."""

from __future__ import annotations

import os
import shutil
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.results.statistics import LEAST_RUNS
from heavylift.pipeline.results.storage import OutputFolder, StopError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.results.histories import Results

__all__ = ["seed_keys", "simulate_seeds"]


def seed_keys(case: Case) -> dict[str, int]:
    """Dotted keys of the seeds in the [sea] of a case file, and their values."""
    found: dict[str, int] = {}

    def walk(value: Any, written: Any, key: str) -> None:
        if isinstance(value, dict):
            for name, entry in value.items():
                if name == "seed" and isinstance(entry, int):
                    found[f"{key}.seed"] = entry
                else:
                    walk(entry, written.get(name) if isinstance(written, dict) else None, f"{key}.{name}")
        elif isinstance(value, (list, tuple)):
            for index, entry in enumerate(value):
                # a single table may stand for a list of one
                inside = written[index] if isinstance(written, list) else written
                walk(entry, inside, f"{key}.{index}" if isinstance(written, list) else key)

    if case.sea is not None:
        walk(case.sea.model_dump(), case.document.get("sea"), "sea")
    return found


def simulate_seeds(
    case: Case, root: Path, path: Path, overrides: Sequence[str], count: int, log: Log
) -> tuple[list[int], list[Results]]:
    """Runs of several seeds, each in a folder of its own below ``seeds``; those that are there are not repeated."""
    from heavylift.pipeline.results.histories import load_results
    from heavylift.pipeline.stages.stages import load_changed_case, run_case

    keys = seed_keys(case)
    if count < LEAST_RUNS:
        raise InputError(f"{count}", source="--seeds", expected=f"{LEAST_RUNS} runs or more, better 10 to 20")
    if not keys:
        raise InputError(
            "nothing has a seed",
            source=case.file,
            key="sea",
            expected="irregular waves, or wind with turbulence",
        )
    if case.simulate is None:
        raise InputError(
            "no [simulate] section", source=case.file, expected="step or tolerance, output_interval, duration"
        )
    made = run_case(case, out=root, stages=("mesh", "modes"), log=log)
    if made.outcome is not Outcome.COMPLETED:
        raise StopError(made.outcome, made.message)
    main = OutputFolder(root)
    runs, first = [], min(keys.values())
    for number in range(count):
        changes = [*overrides, *(f"{key}={seed + number}" for key, seed in keys.items())]
        varied = load_changed_case(path, changes)
        folder = root / "seeds" / f"seed_{first + number}"
        for stage in ("mesh", "modes"):  # the same for all seeds: surfaces and databases too
            _link(main.stage(stage), folder / stage)
        log.say(f"statistics: seed {first + number}, run {number + 1} of {count}")
        done = run_case(varied, out=folder, stages=("mesh", "modes", "simulate"), log=log)
        if done.outcome is not Outcome.COMPLETED:
            raise StopError(done.outcome, f"seed {first + number}: {done.message}")
        runs.append(load_results(varied, folder))
    return [first + number for number in range(count)], runs


def _link(source: Path, target: Path) -> None:
    """The files of a stage in another folder; files are replaced, never changed, so they may be shared."""
    if not source.is_dir():
        return
    for file in source.rglob("*"):
        place = target / file.relative_to(source)
        if file.is_dir() or place.exists() or file.name.startswith("."):
            continue
        place.parent.mkdir(parents=True, exist_ok=True)
        try:
            os.link(file, place)
        except OSError:
            shutil.copyfile(file, place)
