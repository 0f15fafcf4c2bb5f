"""Cases against their reference values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.case.checks import QuantityReference
from heavylift.pipeline.case.quantity_names import parse_quantity_name
from heavylift.pipeline.results.storage import StopError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.checks import CheckSection
    from heavylift.pipeline.checks.quantities import CheckResult
    from heavylift.pipeline.log import Log

__all__ = ["CaseVerdict", "check_table", "exit_code", "needed_stages", "verify_case", "verify_document"]


@dataclass(frozen=True)
class CaseVerdict:
    """How a case stands against its checks.

    Attributes
    ----------
    case
        Its name.
    outcome
        How its stages ended; `Outcome.CHECK_FAILED` if they completed and a check failed.
    cpu_s
        CPU time of its stages [s].
    checks
        Every check, if the case got to them.
    missed
        Every check with its unit, if it did not: they have no value and count as not passed.
    message
        Why, if it did not.
    """

    case: str
    outcome: Outcome
    cpu_s: float
    checks: tuple[CheckResult, ...] = ()
    missed: tuple[tuple[CheckSection, str], ...] = ()
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
        return {**row, "message": self.message} if self.message else row


def _missed_row(check: CheckSection, unit: str) -> dict[str, Any]:
    """A check that was not reached, with the keys of `CheckResult.row`."""
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
    }


def needed_stages(quantities: Sequence[str]) -> tuple[str, ...]:
    """Stages that must have run before some quantities can be computed."""
    order = ("mesh", "modes", "simulate")
    last = max((order.index(parse_quantity_name(text).stage) for text in quantities), default=-1)
    return order[: last + 1]


def verify_case(
    path: Path, *, out: Path | None, overrides: Sequence[str], force: bool, log: Log
) -> CaseVerdict:
    """Run what the checks of a case need, and evaluate them; whatever goes wrong is in the verdict."""
    from heavylift.pipeline.checks.quantities import evaluate_checks
    from heavylift.pipeline.stages.stages import load_changed_case, run_case

    name = path.resolve().parent.name if path.suffix == ".toml" else path.resolve().name
    cpu_s = 0.0
    missed: tuple[tuple[CheckSection, str], ...] = ()
    try:
        case = load_changed_case(path, overrides)
        missed = tuple((check, case.quantity(check.quantity).kind.unit) for check in case.check)
        stages = needed_stages(_quantities(case))
        report = run_case(case, out=out, stages=stages, force=stages if force else (), log=log)
        cpu_s = report.cpu_s
        if report.outcome is not Outcome.COMPLETED:
            return CaseVerdict(name, report.outcome, cpu_s, missed=missed, message=report.message)
        checks = tuple(evaluate_checks(case, report.folder.root))
    except InputError as error:
        return CaseVerdict(name, Outcome.BAD_INPUT, cpu_s, missed=missed, message=str(error))
    except StopError as error:
        return CaseVerdict(name, error.outcome, cpu_s, missed=missed, message=str(error))
    except OSError as error:
        message = f"{error.filename}: {error.strerror}"
        return CaseVerdict(name, Outcome.BAD_INPUT, cpu_s, missed=missed, message=message)
    passed = all(check.passed for check in checks)
    return CaseVerdict(name, Outcome.COMPLETED if passed else Outcome.CHECK_FAILED, cpu_s, checks)


def _quantities(case: Case) -> list[str]:
    """All quantities that the checks of a case name."""
    texts = []
    for check in case.check:
        texts.append(check.quantity)
        if isinstance(check.reference, QuantityReference):
            texts.append(check.reference.quantity)
    return texts


def verify_document(verdicts: Sequence[CaseVerdict]) -> dict[str, Any]:
    """The document that ``verify --json`` prints."""
    return {"cases": [verdict.row() for verdict in verdicts]}


def exit_code(verdicts: Sequence[CaseVerdict]) -> int:
    """Exit code of ``verify``: the largest code among the cases.

    0 only if every check of every case passed; 1 if all cases got to their checks and some failed; 2 if an input
    is bad; the code of its outcome, all above 2, for a case that stopped before it got to its checks.
    """
    return max((int(verdict.outcome) for verdict in verdicts), default=0)


def _ending(check: CheckResult) -> str:
    """Result of a check, which member of a group it is of, when, and what was seen."""
    words = [*([check.where] if check.where else []), *([check.seen] if check.seen else [])]
    return ("passed" if check.passed else "FAILED") + (f"  ({'; '.join(words)})" if words else "")


def check_table(verdict: CaseVerdict) -> list[str]:
    """Lines of a table for a person."""
    lines = [f"{verdict.case}: {verdict.outcome.text}, {verdict.cpu_s:.1f} s CPU"]
    if verdict.message:
        lines += [f"  {line}" for line in verdict.message.splitlines()]
    if not verdict.checks and not verdict.missed and verdict.outcome is Outcome.COMPLETED:
        lines.append("  no checks")
    lines += [f"  {check.id}: not reached, FAILED" for check, _ in verdict.missed]
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
    return lines
