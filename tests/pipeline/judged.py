"""What a run says of the checks and criteria of a case, all of which can be evaluated."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from heavylift.numerics.outcome import InputError, InputErrors
from heavylift.pipeline.case.case_file import Case
from heavylift.pipeline.case.criteria.results import CriterionResult
from heavylift.pipeline.checks.judge import judge
from heavylift.pipeline.checks.quantities import CheckResult
from heavylift.pipeline.results.histories import Results

__all__ = ["judged_checks", "judged_criteria"]


def judged_checks(case: Case, out: Path) -> tuple[CheckResult, ...]:
    """Results of all checks; what is open is raised."""
    found = judge(case, out, criteria=False)
    _raise(found.open_checks)
    return found.checks


def judged_criteria(case: Case, out: Path, results: Results | None = None) -> tuple[CriterionResult, ...]:
    """Lines of all criteria; what is open is raised."""
    found = judge(case, out, results, checks=False)
    _raise(found.open_criteria)
    return found.criteria


def _raise(open_ones: Mapping[str, InputError]) -> None:
    found = [(name, one) for name, error in open_ones.items() for one in getattr(error, "errors", [error])]
    if found:
        raise InputErrors(
            [
                InputError(f"{name}: {one.problem}", source=one.source, expected=one.expected)
                for name, one in found
            ]
        )
