"""Criteria of a case: run what they need, evaluate them, show their utilisation."""

from __future__ import annotations

import math
import textwrap
from dataclasses import field, replace
from functools import partial
from typing import TYPE_CHECKING, Any

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError, Outcome

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.criteria.results import CriterionResult
    from heavylift.pipeline.log import Log

__all__ = ["JudgedCase", "criteria_document", "criteria_lines", "criteria_table", "judge_case"]

_WIDTH = 110


@dataclass(frozen=True)
class JudgedCase:
    """How a case stands against its criteria.

    Attributes
    ----------
    case
        Its name.
    outcome
        How its stages ended; `Outcome.CHECK_FAILED` if they completed and a criterion failed or could not be evaluated.
    results
        Lines of the table, if it got to its criteria.
    missing
        Of criteria that could not be evaluated by name why not.
    message
        Why not, if it did not; of several runs which stopped by themselves.
    """

    case: str
    outcome: Outcome
    results: tuple[CriterionResult, ...] = ()
    missing: dict[str, str] = field(default_factory=dict)
    message: str = ""


def judge_case(
    path: Path,
    *,
    out: Path | None,
    overrides: Sequence[str],
    force: bool,
    log: Log,
    seeds: int | None = None,
) -> JudgedCase:
    """Run what the criteria of a case need, and evaluate them: of its run, or the worst of runs with so many seeds.

    Raises
    ------
    InputErrors
        If the case is wrong, or has no criteria.
    """
    from heavylift.pipeline.checks.judge import judge, judging_stages
    from heavylift.pipeline.stages.stages import load_changed_case, run_case

    case = load_changed_case(path, overrides)
    if not case.criteria:
        raise InputError("no criteria", source=case.file, expected="[[criteria]] with name and type")
    if seeds is not None:
        return _judge_seeds(case, path, out, overrides, seeds, force=force, log=log)
    stages = judging_stages(case, checks=False)
    report = run_case(case, out=out, stages=stages, force=stages if force else (), log=log)
    if report.outcome is not Outcome.COMPLETED:
        return JudgedCase(case.name, report.outcome, message=report.message)
    found = judge(case, report.folder.root, checks=False, log=log)
    return JudgedCase(
        case.name,
        Outcome.COMPLETED if found.passed else Outcome.CHECK_FAILED,
        found.criteria,
        {name: str(error) for name, error in found.open_criteria.items()},
    )


def _judge_seeds(
    case: Case,
    path: Path,
    out: Path | None,
    overrides: Sequence[str],
    seeds: int,
    *,
    force: bool,
    log: Log,
) -> JudgedCase:
    """The worst of several runs, line by line; one that stopped by itself has passed nothing."""
    from heavylift.pipeline.checks.judge import judge
    from heavylift.pipeline.commands.statistics import reported_stops, simulate_seeds

    root = case.output_folder if out is None else out
    runs = simulate_seeds(case, root, path, overrides, seeds, partial(judge, checks=False), log, force=force)
    judged = [(run.seed, run.found) for run in runs if run.found is not None]
    missing: dict[str, str] = {}
    for seed, found in judged:
        for name, error in found.open_criteria.items():
            missing.setdefault(name, f"seed {seed}: {error}")
    results: tuple[CriterionResult, ...] = ()
    if judged:
        every = ([one for one in found.criteria if one.name not in missing] for _, found in judged)
        results = tuple(_worst([seed for seed, _ in judged], line) for line in zip(*every, strict=True))
    passed = not missing and all(result.passed for result in results)
    outcome = Outcome.COMPLETED if passed else Outcome.CHECK_FAILED
    stopped = [run.outcome for run in runs if run.found is None]
    message = "\n".join(line.strip() for line in reported_stops(runs))
    return JudgedCase(case.name, stopped[0] if stopped else outcome, results, missing, message)


def _worst(seeds: Sequence[int], line: Sequence[CriterionResult]) -> CriterionResult:
    """The run in which a line of the table has the least margin, relative to its limit, and what all runs use of it."""
    from heavylift.pipeline.results.statistics import LEAST_RUNS, PROBABILITY, at_extreme, gumbel_fit

    def room(result: CriterionResult) -> float:
        scaled = result.margin / (abs(result.limit) or 1.0)
        return scaled if math.isfinite(scaled) else -math.inf

    place = min(range(len(line)), key=lambda one: (line[one].passed, room(line[one])))
    worst, words = line[place], [f"the worst of {len(line)} seeds"]
    used = [result.utilisation for result in line]
    known = [value for value in used if value is not None]
    if len(known) == len(line) >= LEAST_RUNS and not at_extreme(known):
        fit = gumbel_fit(known)
        low, high = fit.band(PROBABILITY)
        expected, most = 100.0 * fit.mean, 100.0 * fit.quantile(PROBABILITY)
        words.append(
            f"expected utilisation {expected:.4g} %; {most:.4g} % with {100.0 * PROBABILITY:g} % probability "
            f"(Gumbel, between {100.0 * low:.4g} and {100.0 * high:.4g} % with 90 % confidence)"
        )
    return replace(
        worst,
        where=", ".join(filter(None, (worst.where, f"seed {seeds[place]}"))),
        note="; ".join(filter(None, (worst.note, *words))),
        warns=any(result.warns for result in line),
    )


def criteria_document(judged: JudgedCase) -> dict[str, Any]:
    """The document that ``criteria --json`` prints."""
    document: dict[str, Any] = {
        "case": judged.case,
        "outcome": judged.outcome.name.lower(),
        "criteria": [result.row() for result in judged.results],
        **({"not_evaluated": judged.missing} if judged.missing else {}),
    }
    return {**document, "message": judged.message} if judged.message else document


def criteria_table(judged: JudgedCase) -> list[str]:
    """Lines of a table for a person: two a result, and one of its sources and factors."""
    outcome = "a criterion failed" if judged.outcome is Outcome.CHECK_FAILED else judged.outcome.text
    lines = [f"{judged.case}: {outcome}"]
    if judged.message:
        lines += [f"  {line}" for line in judged.message.splitlines()]
    lines += [f"  {name}: not evaluated, FAILED: {reason}" for name, reason in judged.missing.items()]
    return lines + criteria_lines(judged.results)


def criteria_lines(results: Sequence[CriterionResult]) -> list[str]:
    """Lines of some results for a person."""
    from heavylift.pipeline.report.criteria import criterion_cells, governing_words, result_words, used_words

    lines: list[str] = []
    width = max((len(result.name) for result in results), default=0)
    for result in results:
        value, limit, margin = criterion_cells(result)
        used = used_words(result) or "-"
        lines.append(
            f"  {result.name:{width}}  {value:>12} {limit:>14}  used {used:>8}  margin {margin:>11}  "
            f"{result_words(result)}"
        )
        words = [
            result.what,
            governing_words(result),
            f"of {result.seen}" if result.seen else "",
            result.note,
        ]
        factors = ", ".join(factor.text for factor in result.factors)
        for text in ("; ".join(filter(None, words)), "; ".join(filter(None, (result.source, factors)))):
            lines += textwrap.wrap(text, _WIDTH, initial_indent="    ", subsequent_indent="      ")
    return lines
