"""Convergence studies: the error of one quantity against the CPU time that it costs."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.case.checks import QuantityReference, RunReference
from heavylift.pipeline.case.overrides import override_text
from heavylift.pipeline.checks.convergence import (
    ConvergenceRow,
    ConvergenceStudy,
    WorkPrecision,
    fitted_slope,
    observed_order,
    study_table,
)
from heavylift.pipeline.checks.judge import needed_stages
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.results.storage import OutputFolder, StopError, write_json
from heavylift.pipeline.stages.stages import run_case

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.checks import ConvergeSection
    from heavylift.pipeline.log import Log

__all__ = ["converge_case", "study_table"]


def converge_case(
    path: Path, *, out: Path | None, overrides: Sequence[str], force: bool, log: Log
) -> tuple[ConvergenceStudy | WorkPrecision, Path]:
    """Run a case for every value of its ``[converge]`` section, and write the study and its plot.

    Returns
    -------
    tuple
        The study, and the plot that was written.

    Raises
    ------
    InputError
        If the case has no study, or a value does not fit the parameter.
    StopError
        If a run does not complete; one of several series continues and tells so in its row.
    """
    from heavylift.pipeline.pictures.plots import plot_series, plot_study

    base = load_case(path, overrides)
    section = base.converge
    if section is None:
        raise InputError(
            "no [converge] section",
            source=base.file,
            expected="quantity, reference, and parameter and values or series",
        )
    root = out if out is not None else base.output_folder
    runner = _Runner(base, section, root, force=force, log=log)
    folder = OutputFolder(root).stage("converge")
    plot = folder / "converge.png"
    if section.series:
        # every case is read before the first run: a value that does not fit is known at once
        cases = [
            [
                _read(
                    path,
                    overrides,
                    {**series.set, series.parameter: value},
                    f"converge.series.{number}",
                    base,
                )
                for value in series.values
            ]
            for number, series in enumerate(section.series)
        ]
        studies = [
            runner.series(number, cases[number], series.parameter, series.name)
            for number, series in enumerate(section.series)
        ]
        several = WorkPrecision(base.name, section.quantity, section.relative, tuple(studies))
        write_json(folder / "converge.json", several.document())
        plot_series(several, plot)
        return several, plot
    assert section.parameter is not None
    assert section.values is not None
    runs = list(section.values)
    if isinstance(section.reference, RunReference):
        runs.append(section.reference.run)
    changed = [load_case(path, [*overrides, override_text(section.parameter, value)]) for value in runs]
    study = runner.study(changed, section.parameter)
    write_json(
        folder / "converge.json", {**study.document(), "quantity": study.quantity, "fitted": study.fitted}
    )
    plot_study(study, plot)
    return study, plot


def _read(path: Path, overrides: Sequence[str], changes: dict[str, Any], key: str, base: Case) -> Case:
    """The case of one run of a series; errors are reported with the series."""
    texts = [override_text(name, value) for name, value in changes.items()]
    try:
        return load_case(path, [*overrides, *texts])
    except InputError as error:
        raise InputError(
            f"{', '.join(texts)}: {error}",
            source=base.file,
            key=key,
            expected="changes that make a sound case",
        ) from None


@dataclass(frozen=True)
class _Run:
    """Value of the quantity and of its reference (None if it is not of the same run), cost, steps, why it stopped."""

    value: NDArray[np.float64] | None
    reference: NDArray[np.float64] | None
    cpu_s: float
    steps: int | None
    message: str = ""


class _Runner:
    """Runs cases of one study, each in its folder, and compares their quantities with the reference."""

    def __init__(self, base: Case, section: ConvergeSection, root: Path, *, force: bool, log: Log) -> None:
        self.base, self.section, self.root, self.force, self.log = base, section, root, force, log
        self.done: list[Path] = [root]
        texts = [section.quantity]
        if isinstance(section.reference, QuantityReference):
            texts.append(section.reference.quantity)
        self.stages = needed_stages(texts)

    def study(self, cases: Sequence[Case], parameter: str) -> ConvergenceStudy:
        """The study of a single parameter; a last case without a row of its own is the reference."""
        runs = [self._run(case, self._folder(str(i)), parameter, strict=True) for i, case in enumerate(cases)]
        assert self.section.values is not None
        count = len(self.section.values)
        return self._study(cases[:count], runs[:count], parameter, runs[-1].value)

    def series(self, number: int, cases: Sequence[Case], parameter: str, name: str) -> ConvergenceStudy:
        """One of several series; a run that does not complete leaves its row without an error."""
        place = f"series_{number}"
        self.log.say(f"converge: {name}")
        runs = [
            self._run(case, self._folder(place, str(i)), parameter, strict=False)
            for i, case in enumerate(cases)
        ]
        return self._study(cases, runs, parameter, None, name)

    def _folder(self, *names: str) -> Path:
        return OutputFolder(self.root).stage("converge", *names)

    def _run(self, case: Case, folder: Path, parameter: str, *, strict: bool) -> _Run:
        value = _parameter(case, parameter, raw=True)
        self.log.say(f"converge: {parameter} = {value}")
        repeated = self.section.runs > 1 and "simulate" in self.stages
        costs, report = [], None
        for turn in range(self.section.runs if repeated else 1):
            force = self.stages if self.force and not turn else (("simulate",) if repeated else ())
            report = run_case(
                case, out=folder, stages=self.stages, force=force, log=self.log, reuse=self.done
            )
            last = report.stage(self.stages[-1])
            costs.append(report.cpu_s if self.stages[-1] != "simulate" or last is None else last.cpu_s)
            if report.outcome is not Outcome.COMPLETED:
                break
        assert report is not None
        self.done.append(folder)
        last = report.stage("simulate")
        steps = None if last is None else last.details.get("steps")
        if report.outcome is not Outcome.COMPLETED:
            if strict or report.outcome in {Outcome.INTERRUPTED, Outcome.DISK_FULL, Outcome.LOCKED}:
                raise StopError(report.outcome, f"{parameter} = {value}: {report.message}")
            return _Run(None, None, median(costs), steps, report.message or report.outcome.text)
        quantities = Quantities(case, folder)
        reference = None
        if isinstance(self.section.reference, QuantityReference):
            reference = quantities.evaluate(self.section.reference.quantity)
        return _Run(quantities.evaluate(self.section.quantity), reference, median(costs), steps)

    def _study(
        self,
        cases: Sequence[Case],
        runs: Sequence[_Run],
        parameter: str,
        finest: NDArray[np.float64] | None,
        name: str = "",
    ) -> ConvergenceStudy:
        rows = tuple(
            ConvergenceRow(
                _parameter(case, parameter), self._error(run, finest), run.cpu_s, run.steps, run.message
            )
            for case, run in zip(cases, runs, strict=True)
        )
        fit = fitted_slope if parameter.rpartition(".")[2] == "tolerance" else observed_order
        order, fitted = fit([row.value for row in rows], [row.error for row in rows])
        section = self.section
        return ConvergenceStudy(
            self.base.name, parameter, section.quantity, section.relative, rows, order, fitted, name
        )

    def _error(self, run: _Run, finest: NDArray[np.float64] | None) -> float:
        """Norm of the difference to the reference, divided by the norm of the reference if it is to be relative."""
        if run.value is None:
            return float("nan")
        if isinstance(self.section.reference, float):
            reference = np.asarray(self.section.reference)
        else:
            found = run.reference if run.reference is not None else finest
            assert found is not None
            reference = found
        if run.value.shape != reference.shape:
            raise InputError(
                f"the quantity has shape {run.value.shape}, its reference {reference.shape}",
                source="converge",
                expected="a component, or a reference of the same shape",
            )
        scale = float(np.linalg.norm(reference)) if self.section.relative else 1.0
        if scale == 0.0:
            raise InputError("the reference is zero", source="converge", expected="relative = false")
        return float(np.linalg.norm(run.value - reference)) / scale


def _parameter(case: Case, path: str, *, raw: bool = False) -> Any:
    """Value of a dotted key in SI; the raw value if asked for, or if it is not part of the model under that name."""
    node: Any = case
    given: Any = case.document
    for key in path.split("."):
        given = given[int(key)] if isinstance(given, list) else given[key]
        if isinstance(node, (tuple, list)):
            node = node[int(key)]
        elif isinstance(node, dict):
            node = node.get(key)
        else:
            node = getattr(node, key, None)
    return given if raw or node is None else node
