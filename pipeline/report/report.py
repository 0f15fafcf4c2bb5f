"""The report of a case: verdict, inputs, checks, pictures and plots, as Markdown and as one HTML file."""

from __future__ import annotations

import contextlib
import importlib
import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from importlib.metadata import version
from typing import TYPE_CHECKING, NamedTuple

from heavylift.numerics.outcome import Outcome
from heavylift.numerics.side_by_side import SideBySide
from heavylift.pipeline.checks.hanging import hanging_warnings
from heavylift.pipeline.checks.judge import judge
from heavylift.pipeline.log import KeptLog, Log
from heavylift.pipeline.page.packing import LibraryMissingError, page_parts
from heavylift.pipeline.pictures.render import Renderer, RenderingUnavailableError, has_drawn
from heavylift.pipeline.report.bodies import body_sections
from heavylift.pipeline.report.collisions import collision_sections, surface_sections
from heavylift.pipeline.report.contacts import contact_sections
from heavylift.pipeline.report.criteria import (
    briefly,
    criteria_section,
    used_words,
    write_criteria,
)
from heavylift.pipeline.report.document import (
    Album,
    Document,
    Section,
    Table,
    Text,
    Verdict,
    to_html,
    to_markdown,
)
from heavylift.pipeline.report.fmus import fmu_sections
from heavylift.pipeline.report.inputs import described_sections, input_section, rigid_sections
from heavylift.pipeline.report.interactive import JudgedRun, interactive_content
from heavylift.pipeline.report.lift import lift_section
from heavylift.pipeline.report.meshes import edge_sections, mesh_sections
from heavylift.pipeline.report.operation import operation_section
from heavylift.pipeline.report.run import (
    history_section,
    load_finite_results,
    provenance_section,
    run_ending,
    run_section,
)
from heavylift.pipeline.report.scene import is_pictured, scene_sections, still_sections
from heavylift.pipeline.report.sea import sea_sections
from heavylift.pipeline.report.transport import transport_section
from heavylift.pipeline.results.storage import OutputFolder, replacing

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence
    from pathlib import Path

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.criteria.results import CriterionResult
    from heavylift.pipeline.checks.quantities import CheckResult
    from heavylift.pipeline.results.histories import Results

__all__ = ["judged_run", "write_report"]

_Make = Callable[[Album, "Log | None"], "list[Section]"]
"""Makes sections with pictures."""


class _Judged(NamedTuple):
    """How a run is judged, and the sections that tell it."""

    run: JudgedRun
    criteria: list[Section]
    lift: list[Section]


class _Plotted(NamedTuple):
    """Sections with plots."""

    transport: list[Section]
    sea: list[Section]
    history: list[Section]


class _Made(NamedTuple):
    """Sections that take long: of drawn parts in their order, of what is judged, of plots."""

    drawn: list[list[Section]]
    judged: _Judged
    plotted: _Plotted


def write_report(
    case: Case,
    folder: Path,
    out: Path,
    log: Log | None = None,
    *,
    tell: Callable[[JudgedRun], object] | None = None,
) -> list[Path]:
    """Write ``report.md``, ``report.html`` and their pictures from whatever stages have run.

    Parameters
    ----------
    case
        The case.
    folder
        Folder of the report; made if absent. Pictures of an earlier report that are not made anew are removed.
    out
        Output folder of the case, with a folder for each stage that has run.
    log
        Told the verdict, and how far an animation is.
    tell
        Told how the run is judged.

    Returns
    -------
    list[Path]
        All files of the report, ``report.html`` first.

    Notes
    -----
    A missing stage leaves its sections out and is named in the report. So is a machine that cannot draw; plots
    are made even there.
    """
    stages = OutputFolder(out)
    album = Album(folder)
    folder.mkdir(parents=True, exist_ok=True)
    before = _linked_pictures(folder / "report.md")
    results, problem = load_finite_results(case, out)
    flexible = {name: body for name, body in case.bodies.items() if body.BODY.MODAL}
    moved = results is not None and bool(results.meshes) and len(results.time) > 0
    touching = results is not None and bool(case.contacts or case.collisions) and len(results.time) > 0
    pictured = results is not None and len(results.time) > 0 and is_pictured(case)
    renderer, remedy = _renderer() if flexible or moved or touching or pictured else (None, "")
    drawn: list[_Make] = [
        partial(still_sections, case, stages, results, renderer),
        *(
            partial(body_sections, case, name, body, stages, results, renderer)
            for name, body in flexible.items()
        ),
        partial(scene_sections, case, stages, results, renderer),
        lambda album, _log: contact_sections(case, stages, results, renderer, album),
        lambda album, _log: collision_sections(case, stages, results, renderer, album),
    ]

    def judged_part(album: Album) -> _Judged:
        judgement = judged_run(case, stages, results, problem)
        found, missing = judgement.criteria, judgement.open_criteria
        of_criteria = criteria_section(case, out, results, found, missing, album)
        return _Judged(judgement, [*of_criteria], [*lift_section(case, results, album)])

    def plotted_part(album: Album) -> _Plotted:
        return _Plotted(
            [*transport_section(case, stages, results, album)],
            [*sea_sections(case, stages, results)],
            [*history_section(case, stages, results, album)],
        )

    # stress over the run is made where it is drawn, and criteria are judged by it
    first = not any(getattr(body, "stress", None) for body in flexible.values())
    try:
        made, spoken = _side_by_side(
            drawn, judged_part, plotted_part, album, log, alone=renderer is None, judge_first=first
        )
        if made is None:
            pictured_sections = [make(album, None if spoken else log) for make in drawn]
            made = _Made(pictured_sections, judged_part(album), plotted_part(album))
    finally:
        if renderer is not None:
            renderer.close()
    stills, *pictured_sections, touches, colliding = made.drawn
    judgement = made.judged.run
    if tell is not None:
        tell(judgement)
    judged, open_criteria, verdict = judgement.criteria, judgement.open_criteria, judgement.verdict
    warnings = [Text(text, warning=True) for text in (*judgement.warnings, remedy) if text]
    document = Document(
        title=case.title,
        subtitle=f"case {case.name} · heavylift {version('heavylift')}",
        sections=(
            Section("", (verdict, *warnings)),
            *made.judged.criteria,
            *made.judged.lift,
            *([_check_section(judgement.checks, judgement.open_checks)] if case.check else []),
            *stills,
            input_section(case),
            *run_section(case, stages, results),
            *operation_section(results),
            *fmu_sections(case, results),
            *made.plotted.transport,
            *surface_sections(case, stages),
            *made.plotted.sea,
            *rigid_sections(case),
            *described_sections(case),
            *mesh_sections(case, results),
            *(section for sections in pictured_sections for section in sections),
            *edge_sections(case, results),
            *touches,
            *colliding,
            *made.plotted.history,
            *provenance_section(case, stages),
        ),
    )
    if log is not None:
        log.say(f"report: {verdict.text}")
    interactive = ("", "")
    if results is not None and len(results.time):
        try:
            content = interactive_content(case, stages, results, judgement)
            interactive = page_parts(content.header, content.block)
        except LibraryMissingError as error:
            missing = Text(f"No interactive scene: {error}", warning=True)
            document = replace(
                document, sections=(Section("", (verdict, *warnings, missing)), *document.sections[1:])
            )
    files = []
    if case.criteria:
        ended = "not simulated" if results is None else results.outcome
        files = write_criteria(folder, case, judged, open_criteria, ended)
    for name, text in (
        ("report.html", to_html(document, album.pictures, interactive)),
        ("report.md", to_markdown(document)),
    ):
        with replacing(folder / name) as temporary:
            temporary.write_text(text, encoding="utf-8")
        files.append(folder / name)
    files = [*files[-2:], *files[:-2]]
    for name in before - set(album.pictures):
        (folder / name).unlink(missing_ok=True)
    return files + [folder / name for name in album.pictures]


def _side_by_side(
    drawn: Sequence[_Make],
    judge_all: Callable[[Album], _Judged],
    plot_all: Callable[[Album], _Plotted],
    album: Album,
    log: Log | None,
    *,
    alone: bool,
    judge_first: bool,
) -> tuple[_Made | None, bool]:
    """Sections whose bodies are drawn by other processes, while this one plots; None if it is to do all by itself.

    So it is where no other may, and where two parts have pictures of one name, which follow each other then. What is to
    be said of what is drawn has been said already in that case, as the second value tells.
    """
    parts = [partial(_drawn_part, make, album.folder, log) for make in drawn]
    with SideBySide(parts, alone=alone or has_drawn()) as processes:
        if processes.count == 1:
            return None, False
        for module in ("pyvista", "matplotlib.pyplot"):  # once, not in each process
            with contextlib.suppress(ImportError):
                importlib.import_module(module)
        processes.begin(processes.count - 1)
        of_judged, of_plotted = Album(album.folder), Album(album.folder)
        judged = judge_all(of_judged) if judge_first else None
        plotted = plot_all(of_plotted)
        found = []
        for sections, pictures, lines in processes.results():
            found.append((sections, pictures))
            for line in lines:
                (log or Log(quiet=True)).say(line)
    judged = judged or judge_all(of_judged)
    contents = [*(pictures for _, pictures in found), of_judged.pictures, of_plotted.pictures]
    for content in contents:
        album.pictures.update(content)
    if len(album.pictures) < sum(map(len, contents)):
        album.pictures.clear()
        return None, True
    return _Made([sections for sections, _ in found], judged, plotted), True


def _drawn_part(
    make: _Make, folder: Path, log: Log | None
) -> tuple[list[Section], dict[str, bytes], list[str]]:
    """Sections, their pictures and what is to be said of them."""
    album, said = Album(folder), KeptLog(quiet=log is None or log.quiet)
    return make(album, said), album.pictures, said.lines


def judged_run(case: Case, stages: OutputFolder, results: Results | None, problem: str = "") -> JudgedRun:
    """Checks, criteria and verdict of whatever stages have run.

    Parameters
    ----------
    case, stages, results
        The case, its output folder, and its finite time histories if there are any.
    problem
        What is wrong with them.
    """
    found = judge(case, stages.root, results)
    checks, judged = list(found.checks), list(found.criteria)
    open_checks = {name: briefly(error) for name, error in found.open_checks.items()}
    open_criteria = {name: briefly(error) for name, error in found.open_criteria.items()}
    judgement = str(results.metadata.get("warning", "")) if results is not None else ""
    outcome, message = run_ending(stages, results) if case.simulate is not None else (None, "")
    failed = tuple(dict.fromkeys(f"criterion {one.name}" for one in judged if not one.passed))
    verdict = _stopped(outcome, message, checks, failed) or _verdict(
        case, checks, open_checks, simulated=results is not None, judged=judged, open_criteria=open_criteria
    )
    hanging = [] if results is None else hanging_warnings(case, results)
    warnings = tuple(
        f"{text}." if text != problem else text for text in (problem, judgement, *hanging) if text
    )
    return JudgedRun(verdict, checks, open_checks, judged, open_criteria, warnings)


def _renderer() -> tuple[Renderer | None, str]:
    """Something that draws, or why there is nothing."""
    try:
        return Renderer(), ""
    except RenderingUnavailableError as error:
        return None, f"No pictures of bodies: {error}"
    except ImportError as error:
        return None, f"No pictures of bodies: pyvista cannot be imported ({error})"


def _linked_pictures(report: Path) -> set[str]:
    """File names of the pictures and animations that an earlier report shows."""
    try:
        return set(re.findall(r"\]\(([A-Za-z0-9_-]+\.(?:png|gif|mp4))\)", report.read_text(encoding="utf-8")))
    except (OSError, UnicodeDecodeError):
        return set()


def _stopped(
    outcome: Outcome | None, message: str, checks: list[CheckResult], criteria: tuple[str, ...] = ()
) -> Verdict | None:
    """Verdict on a simulation that did not reach its end; None for one that did, or has not run."""
    if outcome is None or outcome is Outcome.COMPLETED:
        return None
    failed = [*criteria, *(_with_place(check) for check in checks if not check.passed)]
    words = [outcome.text.removeprefix("stopped: "), message, "The results are those up to there"]
    if failed:
        words.append(f"Failed besides: {', '.join(failed)}")
    text = ". ".join(word.strip().rstrip(".") for word in words if word.strip())
    # an interrupted run can continue; one that stopped by itself has failed
    return Verdict(f"Stopped: {text}.", passed=None if outcome is Outcome.INTERRUPTED else False)


def _verdict(
    case: Case,
    checks: list[CheckResult],
    missing: dict[str, str],
    *,
    simulated: bool,
    judged: Sequence[CriterionResult] = (),
    open_criteria: Mapping[str, str] | None = None,
) -> Verdict:
    """One line: what passed, what failed, what is not known."""
    broken = dict.fromkeys(one.name for one in judged if not one.passed)
    failed = [_with_place(check) for check in checks if not check.passed]
    count, criteria = len(case.check), len(case.criteria)
    if failed or broken:
        parts = [_share(broken, criteria, "criteria")] if broken else []
        parts += [_share(failed, count, "checks")] if failed else []
        unknown = [*(open_criteria or ()), *missing]
        parts += [f"not evaluated: {', '.join(unknown)}"] if unknown else []
        return Verdict(f"Failed: {'; '.join(parts)}.", passed=False)
    if missing or open_criteria:
        parts = [_share(open_criteria, criteria, "criteria")] if open_criteria else []
        parts += [_share(missing, count, "checks")] if missing else []
        return Verdict(f"Open: {' and '.join(parts)} could not be evaluated.", passed=None)
    if case.simulate is not None and not simulated:
        return Verdict("Open: the case has not been simulated.", passed=None)
    if not count and not criteria:
        return Verdict("No verdict: the case has no checks.", passed=None)
    used = max((check for check in checks if check.utilisation is not None), key=_used, default=None)
    most = f"; at most {100.0 * _used(used):.3g} % of a limit is used, {_with_place(used)}" if used else ""
    parts = [_all_of(criteria, "criterion", "criteria")] if criteria else []
    # a factor is near its limit in every lift: one that hardly moves uses 1 of 1.1
    used_up = [one for one in judged if one.type != "dynamic_factor"]
    worst = max(used_up, key=lambda one: one.utilisation or 0.0, default=None)
    if worst is not None and worst.utilisation is not None:
        parts[0] += f", of which {worst.name} uses most, {100.0 * worst.utilisation:.3g} %"
    parts += [_all_of(count, "check", "checks") + most] if count else []
    return Verdict(f"Passed: {'; '.join(parts)}.", passed=True)


def _share(names: Collection[str], count: int, what: str) -> str:
    return f"{len(names)} of {count} {what} ({', '.join(names)})"


def _all_of(count: int, one: str, several: str) -> str:
    return f"the only {one}" if count == 1 else f"all {count} {several}"


def _used(check: CheckResult) -> float:
    return check.utilisation or 0.0


def _with_place(check: CheckResult) -> str:
    """Id of a check; of a group its worst member, of an extreme when it was."""
    return f"{check.id}: {check.where}" if check.where else check.id


def _check_section(checks: Sequence[CheckResult], missing: Mapping[str, str]) -> Section:
    tables = []
    compared = [check for check in checks if not check.has_limits]
    limited = [check for check in checks if check.has_limits]
    if compared or missing:
        rows = [_compared_row(check) for check in compared]
        rows += [(name, "–", "–", "–", "–", "–", reason, "open") for name, reason in missing.items()]
        marks = (*(check.passed for check in compared), *(None for _ in missing))
        header = ("check", "value", "reference", "unit", "error", "tolerance", "source", "result")
        tables.append(Table(header, tuple(rows), frozenset({1, 2, 4, 5}), marks))
    if limited:
        tables.append(
            Table(
                ("check", "value", "limit", "unit", "used", "margin", "where", "source", "result"),
                tuple(_limit_row(check) for check in limited),
                frozenset({1, 2, 4, 5}),
                tuple(check.passed for check in limited),
            )
        )
    return Section("Checks", tuple(tables))


def _compared_row(check: CheckResult) -> tuple[str, ...]:
    """A check with its reference."""
    kind = "rel." if check.relative else check.unit
    return (
        check.id,
        f"{check.value:.8g}",
        f"{check.reference:.8g}",
        _unit(check),
        f"{check.error:.2e} {kind}",
        f"{check.tolerance:.2e} {kind}",
        _source(check, check.where, check.seen),
        _result(check),
    )


def _limit_row(check: CheckResult) -> tuple[str, ...]:
    """A check with limits: the nearest one."""
    side, limit = check.governing
    return (
        check.id,
        f"{check.value:.6g}",
        f"{'≤' if side == 'maximum' else '≥'} {limit:.6g}",
        _unit(check),
        used_words(check) or "–",
        f"{check.margin:.4g}",
        check.where or "–",
        _source(check, check.seen, check.note) or "–",
        _result(check),
    )


def _unit(check: CheckResult) -> str:
    return check.unit if check.unit != "1" else "–"


def _source(check: CheckResult, *more: str) -> str:
    """Source of a reference or limit, with further words in parentheses."""
    words = "; ".join(filter(None, more))
    return f"{check.source} ({words})".strip() if words else check.source


def _result(check: CheckResult) -> str:
    return "passed" if check.passed else "FAILED"
