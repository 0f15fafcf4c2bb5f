"""Checks and criteria of a run, each judged by itself: what cannot be evaluated says why and hides no other."""

from __future__ import annotations

from dataclasses import field
from functools import partial
from typing import TYPE_CHECKING, TypeVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.checks import QuantityReference
from heavylift.pipeline.case.quantity_names import parse_quantity_name
from heavylift.pipeline.checks.criteria import evaluate_criterion
from heavylift.pipeline.checks.quantities import Quantities, evaluate_check

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.criteria.results import CriterionResult
    from heavylift.pipeline.checks.quantities import CheckResult
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.results.histories import Results

__all__ = ["Judged", "judge", "judging_stages", "needed_stages"]

T = TypeVar("T")


@dataclass(frozen=True)
class Judged:
    """How a run stands against its checks and criteria.

    Attributes
    ----------
    checks, criteria
        Results of those that can be evaluated, in the order of the case; a criterion may have several lines.
    open_checks, open_criteria
        Of the others by id and name why not.
    """

    checks: tuple[CheckResult, ...] = ()
    open_checks: dict[str, InputError] = field(default_factory=dict)
    criteria: tuple[CriterionResult, ...] = ()
    open_criteria: dict[str, InputError] = field(default_factory=dict)

    @property
    def passed(self) -> bool:
        """Whether all of them passed; what cannot be evaluated has not."""
        failed = any(not one.passed for one in self.checks) or any(not one.passed for one in self.criteria)
        return not (failed or self.open_checks or self.open_criteria)


def judge(
    case: Case,
    out: Path,
    results: Results | None = None,
    *,
    checks: bool = True,
    criteria: bool = True,
    log: Log | None = None,
) -> Judged:
    """Evaluate the checks and criteria of a case from the files of its stages, each by itself.

    Parameters
    ----------
    case
        The case.
    out
        Its output folder.
    results
        Its records, if they have been read.
    checks, criteria
        Whether they are asked for.
    log
        Told how far what takes its time is.
    """
    quantities = Quantities(case, out, log)
    if results is not None:
        quantities.__dict__["results"] = results
    found: list[CheckResult] = []
    lines: list[CriterionResult] = []
    open_checks: dict[str, InputError] = {}
    open_criteria: dict[str, InputError] = {}
    for check in case.check if checks else ():
        one = _evaluated(partial(evaluate_check, case, quantities, check))
        if isinstance(one, InputError):
            open_checks[check.id] = one
        else:
            found.append(one)
    for criterion in case.criteria if criteria else ():
        several = _evaluated(partial(evaluate_criterion, case, quantities, criterion))
        if isinstance(several, InputError):
            open_criteria[criterion.name] = several
        else:
            lines += several
    return Judged(tuple(found), open_checks, tuple(lines), open_criteria)


def _evaluated(evaluate: Callable[[], T]) -> T | InputError:
    """What is found, or why nothing is."""
    try:
        return evaluate()
    except InputError as error:
        return error
    except (IndexError, ValueError):  # statistics of a run that stopped before its first record
        return InputError("cannot be evaluated from the records that there are")


def judging_stages(case: Case, *, checks: bool = True) -> tuple[str, ...]:
    """Stages that must have run before the criteria of a case, and its checks, can be evaluated."""
    if case.criteria and case.simulate is not None:
        return ("mesh", "modes", "simulate")
    limits = [text for one in case.criteria for text in one.quantities().values()]
    return needed_stages([*(_quantities(case) if checks else ()), *limits])


def needed_stages(quantities: Sequence[str]) -> tuple[str, ...]:
    """Stages that must have run before some quantities can be computed."""
    order = ("mesh", "modes", "simulate")
    last = max((order.index(parse_quantity_name(text).stage) for text in quantities), default=-1)
    return order[: last + 1]


def _quantities(case: Case) -> list[str]:
    """All quantities that the checks of a case name."""
    texts = []
    for check in case.check:
        texts.append(check.quantity)
        if isinstance(check.reference, QuantityReference):
            texts.append(check.reference.quantity)
    return texts
