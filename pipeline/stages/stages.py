"""What is stale and what to run: the stages of a case, each skipped if its inputs are unchanged.

One run at a time works in an output folder.
"""

from __future__ import annotations

import contextlib
import importlib
import sys
import time
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from heavylift.numerics.classes import dataclass
from heavylift.numerics.derived import keeping
from heavylift.numerics.outcome import InputError, InputErrors, Outcome
from heavylift.numerics.side_by_side import SideBySide
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.derived_files import DerivedFiles
from heavylift.pipeline.results.provenance import (
    mesh_digest,
    modes_digest,
    simulate_digest,
    source_digest,
    versions,
)
from heavylift.pipeline.results.storage import (
    OutputFolder,
    StopError,
    read_json,
    remove_left_over,
    stored,
    unchanged,
    write_json,
)
from heavylift.pipeline.stages.lock import locked
from heavylift.pipeline.stages.work import StageReport, Work

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from collections.abc import Set as AbstractSet

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.flexible_bodies import FlexibleBodySection

__all__ = [
    "STAGES",
    "RunReport",
    "load_changed_case",
    "make_parts",
    "run_case",
]


STAGES = ("mesh", "modes", "simulate", "report")

MESHED_BY = ("heavylift.pipeline.assemble.finite_elements", "h5py", "meshio", "scipy.sparse.linalg", "skfem")
REDUCED_BY = ("heavylift.pipeline.assemble.modes", "h5py", "scipy.linalg", "scipy.sparse.linalg", "skfem")
"""Modules that do the work of a body; several processes share what has been loaded before they begin."""

NAMED = 5
"""Bodies that a message names one by one."""

REPORTED = {
    Outcome.BAD_INPUT,
    Outcome.NOT_FINITE,
    Outcome.STEP_TOO_LARGE,
    Outcome.NOT_CONVERGED,
    Outcome.NOT_CLOSED,
    Outcome.STEP_TOO_SMALL,
    Outcome.STRAINS_LOST,
    Outcome.TOO_MANY_CONTACTS,
    Outcome.LINE_OVERSTRETCHED,
    Outcome.OUTSIDE_DATABASE,
    Outcome.ENERGY_NOT_KEPT,
    Outcome.LIMIT_REACHED,
    Outcome.TIMED_OUT,
    Outcome.PHASES_LEFT,
    Outcome.OFF_ROAD,
    Outcome.MODES_LEFT,
}
"""Ends of a simulation that leave results worth a report; after the others there is no disk, or no wish."""


@dataclass(frozen=True)
class RunReport:
    """How the stages of a case ended.

    Attributes
    ----------
    folder
        Where the outputs are.
    stages
        The stages that ran or were skipped, in order.
    """

    folder: OutputFolder
    stages: tuple[StageReport, ...]

    @property
    def outcome(self) -> Outcome:
        """The first outcome that is not completed, or completed."""
        return next((s.outcome for s in self.stages if s.outcome is not Outcome.COMPLETED), Outcome.COMPLETED)

    @property
    def message(self) -> str:
        """Message of the stage that did not complete."""
        return next((s.message for s in self.stages if s.outcome is not Outcome.COMPLETED), "")

    @property
    def cpu_s(self) -> float:
        """CPU time of all stages [s]."""
        return sum(stage.cpu_s for stage in self.stages)

    def stage(self, name: str) -> StageReport | None:
        """Report of one stage, if it was reached."""
        return next((stage for stage in self.stages if stage.stage == name), None)


def run_case(
    case: Case,
    *,
    out: Path | str | None = None,
    stages: Sequence[str] = STAGES,
    force: Sequence[str] = (),
    log: Log | None = None,
    reuse: Sequence[Path] = (),
) -> RunReport:
    """Run the stages of a case that are not current.

    Parameters
    ----------
    case
        From `heavylift.pipeline.load_case`.
    out
        Output folder; ``CASE/out`` by default.
    stages
        Stages to run, a part of `STAGES`; they are taken in that order.
    force
        Stages that are made again even if their inputs are unchanged.
    log
        Told what happens; quiet by default.
    reuse
        Other output folders of the same case, whose meshes, databases and modes are taken where their inputs agree.

    Returns
    -------
    RunReport
        A stage that stops by itself (diverged, interrupted, disk full) ends the run and says so here. A
        simulation that diverged still gets its report; the outcome of the run stays that of the simulation.

    Raises
    ------
    InputError
        Bad input, or an output folder that cannot be one.
    StopError
        If another run holds the folder.

    Examples
    --------
    >>> import heavylift as hl
    >>> report = hl.run_case(hl.load_case("cases/hoist"), stages=("mesh", "modes", "simulate"))
    >>> report.outcome.text, report.folder.results.name
    ('completed', 'results.h5')
    """
    from heavylift.pipeline.stages.report import report_stage
    from heavylift.pipeline.stages.simulate import simulate_stage

    runners: dict[str, Callable[[Work], StageReport]] = {
        "mesh": mesh_stage,
        "modes": modes_stage,
        "simulate": simulate_stage,
        "report": report_stage,
    }
    folder = OutputFolder(Path(out) if out is not None else case.output_folder)
    _check_folder(folder)
    work = Work(
        case=case,
        folder=folder,
        log=log or Log(quiet=True),
        force=frozenset(force),
        reuse=tuple(OutputFolder(path) for path in reuse),
    )
    sound = _check_scene(work, stages)
    done: list[StageReport] = []
    seconds: dict[str, float] = {}
    kept = DerivedFiles(folder, work.reuse, anew="mesh" in work.force)
    with locked(folder.root):
        for part in folder.folders:
            remove_left_over(part, alone=part == folder.segments)
        if sound:
            write_json(folder.manifest("check"), {"case": case.name, "digest": sound})
        for name in STAGES:
            if name not in stages or (name == "simulate" and case.simulate is None):
                continue
            begin = time.perf_counter()
            try:
                with keeping(kept):
                    done.append(runners[name](work))
            except StopError as error:
                done.append(StageReport(name, error.outcome, skipped=False, cpu_s=0.0, message=str(error)))
            except InputError as error:
                if not done or done[-1].outcome is Outcome.COMPLETED:
                    raise  # else it is the report of a run that stopped by itself, whose end matters more
                work.log.say(f"{name}: {error}")
                done.append(
                    StageReport(name, Outcome.BAD_INPUT, skipped=False, cpu_s=0.0, message=str(error))
                )
            last = done[-1]
            if not last.skipped:
                seconds[name] = time.perf_counter() - begin
            if last.outcome is not Outcome.COMPLETED and not (
                name == "simulate" and last.outcome in REPORTED
            ):
                break
        kept.clean()
    if len(seconds) > 1:
        spent = ", ".join(f"{name} {value:.1f} s" for name, value in seconds.items())
        work.log.say(f"run: {sum(seconds.values()):.1f} s: {spent}")
    return RunReport(folder, tuple(done))


def _check_scene(work: Work, stages: Sequence[str]) -> str:
    """See that the scene fits together, before a stage takes its time; returns a digest of what was found sound.

    Empty if that is known from an earlier run, or nothing is computed.
    """
    if not {"mesh", "modes", "simulate"} & set(stages):
        return ""
    digest = simulate_digest(work.case)
    if (read_json(work.folder.manifest("check")) or {}).get("digest") == digest:
        return ""
    from heavylift.pipeline.assemble.early_checks import scene_errors

    errors = scene_errors(work.case)
    if errors:
        raise errors[0] if len(errors) == 1 else InputErrors(errors)
    return digest


def make_parts(case: Case, folder: OutputFolder) -> None:
    """Make what a simulation needs from an output folder: meshes, modes, surfaces and databases that are not current.

    What is current in the output folder of the case itself is taken from there. A case without any leaves no file; it
    is seen that it fits together.

    Raises
    ------
    InputError
        Bad input.
    StopError
        If a stage stops.
    """
    if case.surfaces or case.databases or any(body.BODY.MODAL for body in case.bodies.values()):
        own = case.output_folder
        reuse = [own] if own.is_dir() and own.resolve() != folder.root.resolve() else []
        report = run_case(case, out=folder.root, stages=("mesh", "modes"), reuse=reuse)
        if report.outcome is not Outcome.COMPLETED:
            raise StopError(report.outcome, report.message)
        return
    from heavylift.pipeline.assemble.early_checks import scene_errors

    errors = scene_errors(case)
    if errors:
        raise errors[0] if len(errors) == 1 else InputErrors(errors)


def _check_folder(folder: OutputFolder) -> None:
    """See that an output folder is a folder or can become one, and leads nowhere else below itself."""
    root = folder.root
    for path in (root, *root.parents):
        if path.is_dir():
            break
        if path.exists():
            raise InputError(
                f"{path} is a file",
                source="output folder",
                key=str(root) if path != root else "",
                expected="a folder, or a path where one can be made; choose another --out",
            )
    for path in folder.folders[1:]:
        folder.stage(*path.relative_to(root).parts)


def load_changed_case(path: Path | str, overrides: Sequence[str] = ()) -> Case:
    """Read a case as `heavylift.pipeline.load_case` does, and say so if an override made it inconsistent.

    An override can be right by itself and contradict another key; the error then stands at that other key or
    at the whole case. Overrides without which the case would be sound are named as its source.
    """
    from heavylift.pipeline.case.case_file import load_case

    def further(case: Case) -> list[InputError]:
        from heavylift.pipeline.assemble.early_checks import scene_errors

        return scene_errors(case)

    try:
        return load_case(path, overrides, further=further)
    except InputErrors as error:
        if not overrides or all(part.source.startswith("--set") for part in error.errors):
            raise
        guilty = [
            text
            for index, text in enumerate(overrides)
            if _loads(path, (*overrides[:index], *overrides[index + 1 :]))
        ]
        if not guilty and _loads(path, ()):
            guilty = list(overrides)
        if not guilty:
            raise
        raise InputErrors(
            [
                part
                if part.source.startswith("--set")
                else InputError(
                    part.problem,
                    source=_with_overrides(part.source, guilty),
                    key=part.key,
                    expected=part.expected,
                )
                for part in error.errors
            ]
        ) from None


def _loads(path: Path | str, overrides: Sequence[str]) -> bool:
    from heavylift.pipeline.case.case_file import load_case

    try:
        load_case(path, overrides)
    except InputError:
        return False
    return True


def _with_overrides(source: object, overrides: Sequence[str]) -> str:
    """Source of an error: a case file, and what was changed of it."""
    return " ".join([str(source), *(["with"] if overrides else []), *(f"--set {text}" for text in overrides)])


def mesh_stage(work: Work) -> StageReport:
    """Geometry to finite-element models, one a flexible body, to surfaces, and to hydrodynamic databases."""

    def make(name: str, body: FlexibleBodySection, header: dict[str, Any]) -> dict[str, Any]:
        from heavylift.pipeline.assemble.finite_elements import assemble_model, model_properties, write_vtu
        from heavylift.pipeline.results.model_io import write_model

        model = assemble_model(work.case, name, body)
        write_model(work.folder.model(name), model, header)
        write_vtu(work.folder.model(name).with_suffix(".vtu"), model)
        work.models[name] = model
        return model_properties(model)

    if work.case.meshes:
        names = list(work.case.meshes)
        some = ", ".join(names[:NAMED]) + (f" and {len(names) - NAMED} more" if len(names) > NAMED else "")
        work.log.say(f"mesh: {some}: frames and shells, whose elements are simulated themselves, skipped")
    report = _body_stage(work, "mesh", work.folder.model, mesh_digest, make, MESHED_BY, {"gmsh"})
    if work.case.surfaces:
        from heavylift.pipeline.stages.surfaces import make_surfaces

        report = _joined(report, *make_surfaces(work))
    if work.case.databases:
        from heavylift.pipeline.stages.hydrodynamics import make_databases

        report = _joined(report, *make_databases(work))
    return report


def _joined(report: StageReport, skipped: bool, cpu_s: float, items: dict[str, Any]) -> StageReport:
    """A report with that of another part of the stage."""
    return replace(
        report,
        skipped=report.skipped and skipped,
        cpu_s=report.cpu_s + cpu_s,
        details={**report.details, **items},
    )


def modes_stage(work: Work) -> StageReport:
    """Finite-element models to reduced bodies."""

    def make(name: str, body: FlexibleBodySection, header: dict[str, Any]) -> dict[str, Any]:
        from heavylift.pipeline.assemble.modes import reduce_model, reduced_properties
        from heavylift.pipeline.results.model_io import read_model, write_reduced

        model = work.models.pop(name, None) or read_model(work.folder.model(name))
        found = reduce_model(work.case, body, model, work.folder)
        header = {**header, "frame_origin": found.origin}
        write_reduced(work.folder.reduced(name), found.body, header, found.states)
        return reduced_properties(found)

    alone = {"sksparse", "pypardiso"}
    return _body_stage(work, "modes", work.folder.reduced, modes_digest, make, REDUCED_BY, alone)


def _body_stage(
    work: Work,
    stage: str,
    file_of: Callable[[str], Path],
    digest_of: Callable[[Case, FlexibleBodySection], str],
    make: Callable[[str, FlexibleBodySection, dict[str, Any]], dict[str, Any]],
    modules: Sequence[str],
    alone: AbstractSet[str],
) -> StageReport:
    """Make the file of every flexible body that is not current, by some modules; several if nothing alone is loaded."""
    from heavylift.pipeline.stages.surfaces import reused

    manifest = read_json(work.folder.manifest(stage)) or {}
    items, skipped = dict(manifest.get("items", {})), True
    items = {name: item for name, item in items.items() if name in work.flexible}
    digests = {name: digest_of(work.case, body) for name, body in work.flexible.items()}
    forced = stage in work.force
    kept = {
        name: not forced and item.get("digest") == digests[name] and unchanged(file_of(name), item)
        for name, item in items.items()
    }

    def made(name: str, body: FlexibleBodySection) -> dict[str, Any]:
        begin = time.process_time()
        header = {"case": work.case.name, "body": name, "digest": digests[name], "versions": versions(stage)}
        with _located(work.case, name):
            properties = make(name, body, header)
        return {
            "digest": digests[name],
            **stored(file_of(name)),
            "cpu_s": time.process_time() - begin,
            "properties": properties,
        }

    wanted = {name: partial(made, name, body) for name, body in work.flexible.items() if not kept.get(name)}
    # what another folder may have is looked for first, one after the other
    several = wanted if not work.reuse or forced else {}
    with SideBySide(list(several.values()), alone=bool(alone & sys.modules.keys())) as processes:
        if processes.count > 1:
            for module in modules:
                importlib.import_module(module)
        results = processes.results() if processes.count > 1 else None
        for name in work.flexible:
            file = file_of(name)
            if kept.get(name):
                work.log.say(f"{stage}: {name}: unchanged, skipped")
                continue
            if not forced and items.get(name, {}).get("digest") == digests[name] and file.is_file():
                work.log.say(f"{stage}: {name}: {file} is damaged, computed again")
            skipped = False
            found = None if forced else reused(work, work.folder.manifest(stage), name, digests[name], file)
            if found is not None:
                items[name] = found
            else:
                items[name] = next(results) if results is not None else wanted[name]()
                properties = items[name]["properties"]
                words = ", ".join(
                    f"{key} {_short(value)}"
                    for key, value in properties.items()
                    if value is not None and key != "notes"
                )
                for note in properties.get("notes", []):
                    work.log.say(f"{stage}: {name}: {note}")
                work.log.say(f"{stage}: {name}: {words}; {items[name]['cpu_s']:.2f} s CPU")
            write_json(
                work.folder.manifest(stage),
                {
                    "stage": stage,
                    "outcome": Outcome.COMPLETED.name.lower(),
                    "case": work.case.name,
                    "overrides": work.case.overrides,
                    "sources_digest": source_digest(stage),
                    "versions": versions(stage),
                    "items": items,
                },
            )
    cpu_s = sum(item["cpu_s"] for item in items.values())
    return StageReport(stage, Outcome.COMPLETED, skipped=skipped, cpu_s=cpu_s, details=items)


def _short(value: Any) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(_short(entry) for entry in value[:5]) + (", ...]" if len(value) > 5 else "]")
    return f"{value:.6g}" if isinstance(value, float) else str(value)


@contextlib.contextmanager
def _located(case: Case, name: str) -> Any:
    """Add the case file and body to errors that know neither; name a solver that gave up."""
    from heavylift.modal.eigen import ModesNotConvergedError

    try:
        yield
    except ModesNotConvergedError as error:
        raise StopError(Outcome.NOT_CONVERGED, f"{case.file}: bodies.{name}: {error}") from None
    except InputError as error:
        if str(case.folder) in str(error):
            raise
        raise InputError(
            str(error).removesuffix(f"; expected {error.expected}"),
            source=_with_overrides(
                case.file, [text for text in case.overrides if text.startswith(f"bodies.{name}.")]
            ),
            key=case.place(f"bodies.{name}"),
            expected=error.expected,
        ) from None
