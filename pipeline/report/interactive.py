"""The interactive part of a report: the scene in time with all that is judged, from whatever stages have run."""

from __future__ import annotations

import json
import math
from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.drawn.build import case_scene
from heavylift.pipeline.page.page import Judged, PageContent, page_content
from heavylift.pipeline.report.criteria import criterion_cells, governing_words, result_words, used_words
from heavylift.pipeline.report.operation import operation_log, operation_tones, phase_bands
from heavylift.pipeline.results.model_io import open_hdf5
from heavylift.pipeline.results.signals import scaled_unit

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.criteria.results import CriterionResult
    from heavylift.pipeline.checks.quantities import CheckResult
    from heavylift.pipeline.drawn.scene import DrawnScene
    from heavylift.pipeline.report.document import Verdict
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = ["JudgedRun", "interactive_content", "recorded_scene", "start_content"]


def start_content(case: Case, stages: OutputFolder) -> PageContent:
    """Header and numbers of the page of a scene before its run, with names and markers; meshes and modes are made."""
    from heavylift.pipeline.assemble.scene import assemble_scene
    from heavylift.pipeline.case.places import in_case

    with in_case(case):
        drawn = case_scene(case, stages, assemble_scene(case, stages), None, marked=True)
    return page_content(case, drawn, None, verdict=("The scene before its run", None), labelled=True)


def recorded_scene(
    case: Case, stages: OutputFolder, results: Results | None, *, running: bool = False
) -> tuple[DrawnScene | None, str]:
    """What is drawn of a run that has ended or is running, or why nothing is."""
    from heavylift.pipeline.assemble.scene import assemble_scene

    try:
        return case_scene(case, stages, assemble_scene(case, stages), results, running=running), ""
    except InputError as error:
        reason = str(error)
    except KeyError as error:  # files of stages that are not those of this version
        reason = f"the output of the mesh and modes stages has no {error}; run them again with --force"
    return None, f"The scene can no longer be assembled and is not drawn: {reason}"


@dataclass(frozen=True)
class JudgedRun:
    """What the stages of a case have come to.

    Attributes
    ----------
    verdict
        One line.
    checks, open_checks, criteria, open_criteria
        Checks and criteria, and of those that cannot be evaluated why not.
    warnings
        What else is to be known.
    """

    verdict: Verdict
    checks: Sequence[CheckResult] = ()
    open_checks: Mapping[str, str] = field(default_factory=dict)
    criteria: Sequence[CriterionResult] = ()
    open_criteria: Mapping[str, str] = field(default_factory=dict)
    warnings: Sequence[str] = ()

    @property
    def passed(self) -> bool:
        """Whether no check and no criterion failed or is open."""
        failed = any(not one.passed for one in self.checks) or any(not one.passed for one in self.criteria)
        return not (failed or self.open_checks or self.open_criteria)


def interactive_content(
    case: Case,
    stages: OutputFolder,
    results: Results,
    judgement: JudgedRun,
    *,
    live: str = "",
    version_of_data: int = 0,
    running: bool = False,
) -> PageContent:
    """Header and numbers of the page of a run.

    Parameters
    ----------
    case, stages, results
        The case, its output folder and its time histories.
    judgement
        Its caption.
    live, version_of_data
        As of `page_content`.
    running
        Whether there will be more records.
    """
    drawn, problem = recorded_scene(case, stages, results, running=running)
    rows = [_criterion(case, results, one) for one in judgement.criteria]
    rows += [_open(name, reason) for name, reason in judgement.open_criteria.items()]
    rows += [_check(case, results, one) for one in judgement.checks]
    rows += [_open(name, reason) for name, reason in judgement.open_checks.items()]
    notes = [*judgement.warnings, *([problem] if problem else [])]
    return page_content(
        case,
        drawn,
        results,
        verdict=(judgement.verdict.text, judgement.verdict.passed),
        judged=rows,
        phases=phase_bands(results),
        events=_events(results, rows),
        tones=operation_tones(results),
        notes=notes,
        descriptions=_descriptions(results.source),
        live=live,
        version_of_data=version_of_data,
    )


def _open(name: str, reason: str) -> Judged:
    return Judged(name, "–", "–", "–", reason, "open", passed=None)


def _check(case: Case, results: Results, one: CheckResult) -> Judged:
    name = case.quantity(one.member or one.quantity)
    time = one.time
    if time is None and name.statistic == "end" and len(results.time):
        time = float(results.time[-1])
    series = None
    if name.family in {"channel", "frequency", "angular_frequency", "growth"} and name.item in results:
        series = (name.item, name.component)
    elif name.family == "stress" and f"{name.owner}.von_mises" in results:
        series = (f"{name.owner}.von_mises", "")
    bound = tuple(
        (side, limit)
        for side, limit in (("maximum", one.maximum), ("minimum", one.minimum))
        if limit is not None
    )
    if one.has_limits:
        side, limit = one.governing
        limit_words = f"{'≤' if side == 'maximum' else '≥'} {_scaled(limit, one, limit)}"
        used = used_words(one)
    else:
        assert one.error is not None
        assert one.tolerance is not None
        limit_words = _scaled(one.reference or 0.0, one, one.reference or 0.0)
        used = f"{one.error / one.tolerance:.2g} of tol." if one.tolerance > 0.0 else ""
    owners = [name.owner, *(part.partition(".")[0] for part in name.item.replace("(", " ").split())]
    return Judged(
        one.id,
        _scaled(one.value, one, one.governing[1] if one.has_limits else one.reference or 0.0),
        limit_words,
        used,
        one.where or name.text,
        "passed" if one.passed else "FAILED",
        one.passed,
        time,
        series,
        _places(case, results, [one.where.partition(" at ")[0], *owners]),
        bound,
    )


def _scaled(number: float, one: CheckResult, limit: float) -> str:
    """A number of a check in a unit that suits its value and its limit."""
    finite = [part for part in (one.value, limit) if math.isfinite(part)]
    if one.unit == "1" or not finite:
        return f"{number:.6g}"
    unit = scaled_unit(one.unit, [np.array(finite)])
    if unit.text.startswith("10^"):
        return f"{number:.6g} {one.unit}"
    return f"{number / unit.divisor:.6g} {unit.text}".strip()


def _criterion(case: Case, results: Results, one: CriterionResult) -> Judged:
    value, limit, _ = criterion_cells(one)
    names = _places(case, results, [*one.where.replace(",", " ").split(), one.where])
    series = next(
        (
            (channel, "")
            for place in names
            for channel in (f"{place}.tension", f"{place}.reaction_force")
            if channel in results
        ),
        None,
    )
    if one.where in results:
        series = (one.where, "")
    bound = (("maximum" if one.side == "<=" else "minimum", one.limit),)
    drawn = series is not None and one.unit == results.unit(series[0]) and not one.factors
    return Judged(
        f"{one.name}: {one.what}",
        value,
        limit,
        used_words(one),
        "; ".join(filter(None, (governing_words(one), one.note))),
        result_words(one),
        one.passed,
        one.time,
        series,
        names,
        bound if drawn else (),
    )


def _places(case: Case, results: Results, words: Sequence[str]) -> tuple[str, ...]:
    """Names of bodies, ropes, sensors (by the body that carries them), ... among some words."""
    sensors = {sensor.name: sensor.body for sensor in case.sensors}
    owners = {channel.partition(".")[0] for channel in results} | set(case.bodies)
    found: list[str] = []
    for word in words:
        for part in (word, word.partition(".")[0]):
            if part in sensors:
                found.append(sensors[part])
            elif part in owners:
                found.append(part)
    return tuple(dict.fromkeys(found))


def _events(results: Results, rows: Sequence[Judged]) -> list[tuple[float, str]]:
    """What happened when: phases, what was done in them, limits that were passed, and where criteria govern."""
    _, log = operation_log(results)
    events = [(float(time), f"{phase}: {event} {words}".strip()) for time, phase, event, words, *_ in log]
    events += [(row.time, f"{row.name} governs") for row in rows if row.time is not None]
    last = float(results.time[-1])
    return [event for event in dict.fromkeys(events) if 0.0 <= event[0] <= last * (1.0 + 1e-9)]


def _descriptions(source: Path) -> dict[str, str]:
    """What each channel is, from the file of a finished run; of others none."""
    if source.suffix != ".h5":
        return {}
    with open_hdf5(source, "") as file:
        order = json.loads(file.attrs["channel_order"])
        return {name: str(file["channels"][name].attrs.get("description", "")) for name in order}
