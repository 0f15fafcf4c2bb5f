"""Cases against their reference values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.case.checks import QuantityReference
from heavylift.pipeline.results.storage import StopError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.checks import CheckSection
    from heavylift.pipeline.case.criteria.results import CriterionResult
    from heavylift.pipeline.checks.judge import Judged
    from heavylift.pipeline.checks.quantities import CheckResult
    from heavylift.pipeline.log import Log

__all__ = [
    "CaseVerdict",
    "Missed",
    "check_table",
    "exit_code",
    "judged_verdict",
    "verify_case",
    "verify_document",
]


class Missed(NamedTuple):
    """A check that has no value: its unit, and why, if the reason is its own."""

    check: CheckSection
    unit: str
    reason: str = ""


@dataclass(frozen=True)
class CaseVerdict:
    """How a case stands against its checks.

    Attributes
    ----------
    case
        Its name.
    outcome
        How its stages ended; `Outcome.CHECK_FAILED` if they completed and a check or criterion failed or could not be
        evaluated.
    cpu_s
        CPU time of its stages [s].
    checks
        Every check that could be evaluated, if the case got to them.
    missed
        Every check with its unit and why it has no value, if there is a reason of its own: all of a case that did not
        get to them, and those that could not be evaluated. They count as not passed.
    criteria, open_criteria
        Lines of the criteria, and of those that could not be evaluated by name why not.
    message
        Why, if it did not.
    """

    case: str
    outcome: Outcome
    cpu_s: float
    checks: tuple[CheckResult, ...] = ()
    missed: tuple[Missed, ...] = ()
    criteria: tuple[CriterionResult, ...] = ()
    open_criteria: tuple[tuple[str, str], ...] = ()
    message: str = ""

    def row(self) -> dict[str, Any]:
        """The verdict as plain values, as in the ``verify --json`` document."""
        row: dict[str, Any] = {
            "case": self.case,
            "outcome": self.outcome.name.lower(),
            "cpu_s": self.cpu_s,
            "checks": [
                *(check.row() for check in self.checks),
                *(_missed_row(*entry) for entry in self.missed),
            ],
        }
        if self.criteria or self.open_criteria:
            row["criteria"] = [one.row() for one in self.criteria]
            row["not_evaluated"] = dict(self.open_criteria)
        return {**row, "message": self.message} if self.message else row


def _missed_row(check: CheckSection, unit: str, reason: str) -> dict[str, Any]:
    """A check that has no value, with the keys of `CheckResult.row`."""
    tolerance = check.tolerance
    limits = {} if tolerance is not None else {"maximum": check.maximum, "minimum": check.minimum}
    allowed = None
    if tolerance is not None:
        allowed = tolerance.relative if tolerance.relative is not None else tolerance.absolute
    return {
        "id": check.id,
        "value": None,
        "reference": None if isinstance(check.reference, QuantityReference) else check.reference,
        "error": None,
        "tolerance": allowed,
        "unit": unit,
        "source": check.source or "",
        "passed": False,
        **limits,
        **({"message": reason} if reason else {}),
    }


def verify_case(
    path: Path, *, out: Path | None, overrides: Sequence[str], force: bool, log: Log
) -> CaseVerdict:
    """Run what checks and criteria of a case need, and evaluate them; whatever goes wrong is in the verdict."""
    from heavylift.pipeline.checks.judge import judge, judging_stages
    from heavylift.pipeline.stages.stages import load_changed_case, run_case

    name = path.resolve().parent.name if path.suffix == ".toml" else path.resolve().name
    cpu_s = 0.0
    missed: tuple[Missed, ...] = ()
    not_reached: tuple[tuple[str, str], ...] = ()
    outcome: Outcome
    try:
        case = load_changed_case(path, overrides)
        missed = tuple(_missed(case, check) for check in case.check)
        not_reached = tuple((one.name, "") for one in case.criteria)
        stages = judging_stages(case)
        report = run_case(case, out=out, stages=stages, force=stages if force else (), log=log)
        cpu_s = report.cpu_s
        if report.outcome is not Outcome.COMPLETED:
            outcome, message = report.outcome, report.message
        else:
            return judged_verdict(name, case, judge(case, report.folder.root, log=log), cpu_s)
    except InputError as error:
        outcome, message = Outcome.BAD_INPUT, str(error)
    except StopError as error:
        outcome, message = error.outcome, str(error)
    except OSError as error:
        outcome, message = Outcome.BAD_INPUT, f"{error.filename}: {error.strerror}"
    return CaseVerdict(name, outcome, cpu_s, missed=missed, open_criteria=not_reached, message=message)


def judged_verdict(name: str, case: Case, found: Judged, cpu_s: float) -> CaseVerdict:
    """Verdict of a case whose run has been judged.

    Parameters
    ----------
    name, case
        The case.
    found
        Its checks and criteria.
    cpu_s
        CPU time of its stages [s].
    """
    return CaseVerdict(
        name,
        Outcome.COMPLETED if found.passed else Outcome.CHECK_FAILED,
        cpu_s,
        found.checks,
        tuple(
            _missed(case, check, str(found.open_checks[check.id]))
            for check in case.check
            if check.id in found.open_checks
        ),
        found.criteria,
        tuple((one, str(error)) for one, error in found.open_criteria.items()),
    )


def _missed(case: Case, check: CheckSection, reason: str = "") -> Missed:
    return Missed(check, case.quantity(check.quantity).kind.unit, reason.replace("\n", "; "))


def verify_document(verdicts: Sequence[CaseVerdict]) -> dict[str, Any]:
    """The document that ``verify --json`` prints."""
    return {"cases": [verdict.row() for verdict in verdicts]}


def exit_code(verdicts: Sequence[CaseVerdict]) -> int:
    """Exit code of ``verify``: the largest code among the cases.

    0 only if every check and criterion of every case passed; 1 if all cases got to them and some failed or could not be
    evaluated; 2 if an input is bad; the code of its outcome, all above 2, for a case that stopped before.
    """
    return max((int(verdict.outcome) for verdict in verdicts), default=0)


def _ending(check: CheckResult) -> str:
    """Result of a check, which member of a group it is of, when, and what was seen."""
    words = [word for word in (check.where, check.seen, check.note) if word]
    return ("passed" if check.passed else "FAILED") + (f"  ({'; '.join(words)})" if words else "")


def check_table(verdict: CaseVerdict) -> list[str]:
    """Lines of a table for a person."""
    from heavylift.pipeline.commands.criteria import criteria_lines

    lines = [f"{verdict.case}: {verdict.outcome.text}, {verdict.cpu_s:.1f} s CPU"]
    if verdict.message:
        lines += [f"  {line}" for line in verdict.message.splitlines()]
    judged = (verdict.checks, verdict.missed, verdict.criteria, verdict.open_criteria)
    if not any(judged) and verdict.outcome is Outcome.COMPLETED:
        lines.append("  no checks")
    for name, reason in (*((one.check.id, one.reason) for one in verdict.missed), *verdict.open_criteria):
        lines.append(f"  {name}: {f'not evaluated, FAILED: {reason}' if reason else 'not reached, FAILED'}")
    width = max((len(check.id) for check in verdict.checks), default=0)
    compared = [check for check in verdict.checks if not check.has_limits]
    if compared:
        lines.append(
            f"  {'check':{width}}  {'value':>16} {'reference':>16} {'unit':8} {'error':>9} {'tolerance':>9}"
        )
    for check in compared:
        lines.append(
            f"  {check.id:{width}}  {check.value:16.9g} {check.reference:16.9g} {check.unit:8} "
            f"{check.error:9.2e} {check.tolerance:9.2e}  {_ending(check)}"
        )
    limited = [check for check in verdict.checks if check.has_limits]
    if limited:
        lines.append(f"  {'check':{width}}  {'value':>16} {'limit':>16} {'unit':8} {'used':>9} {'margin':>9}")
    for check in limited:
        side, limit = check.governing
        used = "-" if check.utilisation is None else f"{100.0 * check.utilisation:.1f} %"
        lines.append(
            f"  {check.id:{width}}  {check.value:16.9g} {'<=' if side == 'maximum' else '>='} {limit:13.9g} "
            f"{check.unit:8} {used:>9} {check.margin:9.3g}  {_ending(check)}"
        )
    return lines + criteria_lines(verdict.criteria)
