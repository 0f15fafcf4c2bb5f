"""Running a model from Python, and its results: records, criteria, plots, the interactive page."""

from __future__ import annotations

import html
import os
import shutil
import tempfile
import weakref
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.model.components import told
from heavylift.pipeline.results.histories import ChannelInfo, Results
from heavylift.pipeline.results.storage import StopError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.criteria.results import CriterionResult
    from heavylift.pipeline.checks.quantities import CheckResult
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.page.page import PageContent
    from heavylift.pipeline.report.interactive import JudgedRun
    from heavylift.pipeline.stages.stages import RunReport

__all__ = ["Run", "run_model"]

_STAGES = ("mesh", "modes", "simulate")
PAGE_HEIGHT = 720
"""Of the page in a cell of a notebook [pixels]."""


class Run(Results):
    """Results of a run: its records as arrays, and how it is judged.

    ``run["hoist.tension"]`` is an array of a value for each time of ``run.time``, ``run["load.position"]`` one of
    three; ``run.unit(name)`` and ``run.components(name)`` say what they are.

    Attributes
    ----------
    case
        What was run.
    report
        How the stages ended, see `heavylift.pipeline.stages.stages.RunReport`.
    out
        Output folder; a temporary one goes with the last reference to the run.

    Examples
    --------
    >>> import heavylift as hl
    >>> run = hl.load("cases/hoist").run()
    >>> run.completed, run.passed, run["fall.tension"].shape
    (True, True, (101,))
    >>> print(run.verdict)
    Passed: all 5 criteria, of which crane uses most, 77.2 %; all 3 checks.
    """

    def __init__(
        self,
        case: Case,
        report: RunReport,
        results: Results | None,
        problem: str = "",
    ) -> None:
        found = results or Results(
            report.folder.root, np.empty(0), {}, {}, {"outcome": report.outcome.name.lower()}
        )
        channels: dict[str, ChannelInfo] = {name: found.channel(name) for name in found}
        super().__init__(found.source, found.time, channels, _Columns(found), found.metadata, found.mesh_file)
        self.case, self.report, self._problem = case, report, problem

    @property
    def out(self) -> Path:
        """Output folder."""
        return self.report.folder.root

    @property
    def told_as(self) -> object:
        """What messages call it."""
        return f"Run of {self.case.title!r}"

    @property
    def message(self) -> str:
        """Why it did not complete; empty if it did."""
        return self.report.message

    @property
    def completed(self) -> bool:
        """Whether it came to its end."""
        return self.report.outcome is Outcome.COMPLETED

    @cached_property
    def judged(self) -> JudgedRun:
        """Checks, criteria and verdict, as the report has them."""
        from heavylift.pipeline.report.report import judged_run

        return judged_run(self.case, self.report.folder, self if len(self.time) else None, self._problem)

    @property
    def verdict(self) -> str:
        """One line: how it ended, and which checks and criteria passed."""
        return self.judged.verdict.text

    @property
    def passed(self) -> bool:
        """Whether it completed, and no check and no criterion failed or could not be evaluated."""
        return self.completed and self.judged.passed

    @property
    def checks(self) -> Mapping[str, CheckResult]:
        """Checks that could be evaluated, by id: ``value``, ``reference``, ``error``, ``tolerance``, ``passed``, ..."""
        return {one.id: one for one in self.judged.checks}

    @property
    def criteria(self) -> Mapping[str, Sequence[CriterionResult]]:
        """Criteria that could be evaluated, by name: lines with ``value``, ``limit``, ``passed``, ..."""
        found: dict[str, list[CriterionResult]] = {}
        for one in self.judged.criteria:
            found.setdefault(one.name, []).append(one)
        return found

    @property
    def open(self) -> Mapping[str, str]:
        """Checks and criteria that could not be evaluated, and why."""
        return {**self.judged.open_checks, **self.judged.open_criteria}

    @property
    def warning(self) -> str:
        """What else is to be known of it: values that are not finite, doubts about its energy, slack at rest."""
        return " ".join(self.judged.warnings)

    def plot(self, *names: str, title: str = "") -> Any:
        """Histories of channels over time, in the style of a report.

        Parameters
        ----------
        names
            Channels, components of channels, combinations, and patterns: ``"hoist.tension"``, ``"load.position.z"``,
            ``"sling_*.tension"``. What has a unit of its own has axes of its own.
        title
            Heading; by default the names.

        Returns
        -------
        matplotlib.figure.Figure
            Which a notebook shows; ``figure.savefig("tension.png")`` writes it, ``figure.axes`` are to be added to.

        Raises
        ------
        InputError
            If a channel does not exist, or there is no record.
        """
        from heavylift.pipeline.pictures.plots import Series, history_figure

        if not names:
            raise InputError("no channel", source=self.told_as, key="plot", expected="the name of a channel")
        if not len(self.time):
            raise InputError(
                "there are no records", source=self.told_as, key="plot", expected="a run with a record"
            )
        curves = [
            (unit, Series(label, column))
            for name in names
            for one in self.fitting(name)
            for unit, label, column in self._curves(one)
        ]
        groups = {unit: [curve for own, curve in curves if own == unit] for unit, _ in curves}
        return history_figure(self.time, list(groups.items()), title=title or ", ".join(names))

    def _curves(self, name: str) -> Iterator[tuple[str, str, NDArray[np.float64]]]:
        """A channel, or a component of one, as curves with units and labels."""
        values, info = self.term(name)
        if values.ndim == 1:
            yield info.unit, name, values
        else:
            yield from ((info.unit, f"{name}.{one}", values[:, i]) for i, one in enumerate(info.components))

    def page(self) -> str:
        """The interactive page as the text of one HTML file: the scene in time, channels, criteria.

        Raises
        ------
        InputError
            If there are no records, or k3d is not installed.
        """
        from heavylift.pipeline.report.interactive import interactive_content

        if not len(self.time):
            raise InputError(
                "there are no records", source=self.told_as, key="page", expected="a run with a first record"
            )
        return _html_of(interactive_content(self.case, self.report.folder, self, self.judged), self.told_as)

    def _repr_html_(self) -> str:
        """The page in a cell of a notebook."""
        if not len(self.time):
            return f"<p>{html.escape(self.verdict)}</p>"
        return in_cell(self.page())

    def __repr__(self) -> str:
        return f"<Run of {self.case.title!r}: {self.report.outcome.text}, {len(self.time)} records>"


class _Columns(dict[str, Any]):
    """Channels of other results, as columns, read when they are asked for."""

    def __init__(self, results: Results) -> None:
        self._results = results

    def __missing__(self, name: str) -> Any:
        values = self._results[name]
        self[name] = values.reshape(len(values), -1) if values.ndim == 1 else values
        return self[name]


def in_cell(page: str) -> str:
    """A page as a cell of a notebook shows it: by itself, without a way to the notebook."""
    return (
        f'<iframe srcdoc="{html.escape(page)}" sandbox="allow-scripts allow-downloads" '
        f'style="width: 100%; height: {PAGE_HEIGHT}px; border: 0"></iframe>'
    )


def _html_of(content: PageContent, told_as: object) -> str:
    """Text of a page."""
    from heavylift.pipeline.page.packing import LibraryMissingError
    from heavylift.pipeline.page.page import page_html

    try:
        return page_html(content)
    except LibraryMissingError as error:
        raise InputError(str(error), source=told_as, key="page", expected="the package k3d") from None


def start_page(case: Case, located: Callable[[InputError], InputError]) -> str:
    """The page of a scene before its run; see `heavylift.pipeline.model.model.Model.page`."""
    from heavylift.pipeline.report.interactive import start_content
    from heavylift.pipeline.stages.stages import run_case

    with tempfile.TemporaryDirectory(prefix="heavylift-") as folder, told(located):
        report = run_case(case, out=folder, stages=("mesh", "modes"))
        if report.outcome is not Outcome.COMPLETED:
            raise StopError(report.outcome, report.message)
        return _html_of(start_content(case, report.folder), f"Model({case.title!r})")


def run_model(
    case: Case,
    located: Callable[[InputError], InputError],
    *,
    out: Path | str | None,
    log: Log,
    reuse: Sequence[Path],
) -> Run:
    """Run the case of a model, which says where errors are; see `heavylift.pipeline.model.model.Model.run`."""
    if out is not None:
        return _run_in(Path(out), case, located, log, reuse)
    folder = Path(tempfile.mkdtemp(prefix="heavylift-"))
    try:
        run = _run_in(folder, case, located, log, reuse)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    weakref.finalize(run, _remove, folder, os.getpid())
    return run


def _remove(folder: Path, process: int) -> None:
    """Remove the folder of a run that is gone; a copy in a process that was forked goes without it."""
    if os.getpid() == process:
        shutil.rmtree(folder, ignore_errors=True)


def _run_in(
    folder: Path,
    case: Case,
    located: Callable[[InputError], InputError],
    log: Log,
    reuse: Sequence[Path],
) -> Run:
    from heavylift.pipeline.report.run import load_finite_results
    from heavylift.pipeline.stages.stages import run_case

    others = [path for path in reuse if path.resolve() != folder.resolve()]
    with told(located):
        report = run_case(case, out=folder, stages=_STAGES, log=log, reuse=others)
    results, problem = load_finite_results(case, folder)
    if report.outcome is not Outcome.COMPLETED and (results is None or not len(results.time)):
        raise StopError(report.outcome, report.message)
    return Run(case, report, results, problem)
