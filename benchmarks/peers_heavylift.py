"""heavylift: the cases themselves, by `dele2` with fixed steps and by `accurate` with tolerances."""

from __future__ import annotations

import csv
import statistics
import time
from functools import lru_cache, partial
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from peers_measure import SAMPLES, History, Ladder, Reference

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.case.case_file import Case, load_case
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from peers_problems import Problem

    from heavylift.solver.scene.scene import Scene

__all__ = ["NAME", "VERSION", "case_reference", "ladders", "scene_of", "step_microseconds"]

NAME = "heavylift"
VERSION = version("heavylift")

CASES = Path(__file__).resolve().parents[1] / "cases"
STEPS = (100, 200, 300, 500, 1000, 2000, 5000, 10000, 20000, 50000, 100000)
"""Steps of `dele2`, a multiple of the output intervals."""
TOLERANCES = tuple(10.0 ** (-0.5 * k) for k in range(25))
"""Of `accurate`."""


@lru_cache
def _case(problem: Problem) -> Case:
    return load_case(CASES / problem.case, problem.overrides)


@lru_cache
def scene_of(problem: Problem) -> Scene:
    """Scene of a rigid case; nothing has to be computed or read for it."""
    case = _case(problem)
    return assemble_scene(case, OutputFolder(case.output_folder))


def case_reference(problem: Problem) -> Reference:
    """The recorded history that a case is compared with.

    Raises
    ------
    SystemExit
        If the case has none, or other samples or another end than the benchmark.
    """
    case = _case(problem)
    if not case.reference or case.simulate is None or case.simulate.duration != problem.duration:
        raise SystemExit(f"{case.file}: needs a [[reference]], and a duration of {problem.duration} s")
    section = case.reference[0]
    with (case.folder / section.file).open(encoding="utf-8", newline="") as stream:
        header, *rows = csv.reader(stream)
    table = np.array(rows, dtype=float)
    if len(table) != SAMPLES or header[0] != "time":
        raise SystemExit(f"{case.folder / section.file}: needs {SAMPLES} rows of time and components")
    components = tuple("xyz".index(name) for name in header[1:])
    return Reference(table[:, 0], table[:, 1:], components, section.scale or 1.0)


def ladders(problem: Problem) -> list[Ladder]:
    """Both integrators, from cheap to dear."""
    dele2 = Ladder(NAME, "dele2", tuple(partial(_Run, problem, steps=steps) for steps in STEPS))
    accurate = Ladder(
        NAME, "accurate", tuple(partial(_Run, problem, tolerance=value) for value in TOLERANCES)
    )
    return [dele2, accurate]


class _Run:
    """A number of equal steps of `dele2`, or a tolerance of `accurate`; records at the samples."""

    def __init__(self, problem: Problem, *, steps: int = 0, tolerance: float | None = None) -> None:
        scene, case = scene_of(problem), _case(problem)
        assert case.simulate is not None
        self.setting = f"{steps} steps" if tolerance is None else f"tolerance {tolerance:g}"
        self._steps = steps if tolerance is None else SAMPLES - 1
        self._simulation = Simulation(
            scene,
            problem.duration / self._steps,
            "dele2" if tolerance is None else "accurate",
            record_every=self._steps // (SAMPLES - 1),
            tolerance=tolerance,
            start=case.simulate.start,
        )
        self._simulation.warm_up()
        self._start = self._simulation.state()
        channel = f"{case.reference[0].channel}"
        self._column = next(entry.column for entry in self._simulation.channels if entry.name == channel)

    def reset(self) -> None:
        self._simulation.restore(self._start)

    def go(self) -> None:
        self._advance()

    def _advance(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        times, records = self._simulation.advance(self._steps)
        if self._simulation.outcome is not Outcome.COMPLETED:
            raise RuntimeError(self._simulation.message)
        return times, records

    def history(self) -> History:
        self.reset()
        columns = slice(self._column, self._column + 3)
        first = self._simulation.record()[columns]
        times, records = self._advance()
        return History(np.concatenate([[0.0], times]), np.vstack([first, records[:, columns]]))


def step_microseconds(scene: Scene, step: float, count: int, repeats: int = 7) -> float:
    """CPU time of a step of `dele2` [us]: median over runs of a number of steps from the start, without records."""
    simulation = Simulation(scene, step, "dele2", record_every=count + 1)
    simulation.warm_up()
    start = simulation.state()
    seconds = []
    for _ in range(repeats + 1):
        simulation.restore(start)
        begin = time.process_time()
        simulation.advance(count)
        seconds.append(time.process_time() - begin)
        if simulation.outcome is not Outcome.COMPLETED:
            raise RuntimeError(simulation.message)
    return 1e6 * statistics.median(seconds[1:]) / count
