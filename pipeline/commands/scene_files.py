"""Files of a scene: its page before a run, and its motion for other programs."""

from __future__ import annotations

from importlib.metadata import version
from typing import TYPE_CHECKING

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.results.storage import OutputFolder, StopError, replacing

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from heavylift.pipeline.drawn.scene import DrawnScene
    from heavylift.pipeline.log import Log

__all__ = ["draw_case", "export_case"]


def draw_case(path: Path, *, out: Path | None, overrides: Sequence[str], log: Log) -> Path:
    """Write ``OUT/draw/scene.html``, the assembled scene at its start; meshes and modes are made if they are not there.

    Raises
    ------
    InputError
        If something is wrong with the case, or k3d is not installed.
    StopError
        If a stage stops by itself.
    """
    from heavylift.pipeline.page.packing import LibraryMissingError
    from heavylift.pipeline.page.page import page_html
    from heavylift.pipeline.report.interactive import start_content
    from heavylift.pipeline.stages.stages import load_changed_case, run_case

    case = load_changed_case(path, overrides)
    if not case.bodies:
        raise InputError("no bodies", source=case.file, key="bodies", expected="something to draw")
    result = run_case(case, out=out, stages=("mesh", "modes"), log=log)
    if result.outcome is not Outcome.COMPLETED:
        raise StopError(result.outcome, result.message)
    try:
        text = page_html(start_content(case, result.folder))
    except LibraryMissingError as error:
        raise InputError(str(error), source="draw", expected="the package k3d") from None
    file = result.folder.stage("draw") / "scene.html"
    file.parent.mkdir(parents=True, exist_ok=True)
    with replacing(file) as temporary:
        temporary.write_text(text, encoding="utf-8")
    log.say(f"draw: {file}")
    return file


def export_case(
    path: Path, kinds: Sequence[str], *, out: Path | None, overrides: Sequence[str], log: Log
) -> list[Path]:
    """Write the scene of a run in formats of other programs into ``OUT/export``.

    Parameters
    ----------
    path, out, overrides, log
        As of the commands.
    kinds
        ``"glb"``, ``"vtkhdf"``.

    Raises
    ------
    InputError
        If no format is asked for, or there are no results.
    """
    from heavylift.pipeline.assemble.scene import assemble_scene
    from heavylift.pipeline.case.places import in_case
    from heavylift.pipeline.drawn.build import case_scene
    from heavylift.pipeline.page.exchange import write_glb, write_vtkhdf
    from heavylift.pipeline.report.run import load_finite_results
    from heavylift.pipeline.stages.stages import load_changed_case

    if not kinds:
        raise InputError("no format", source="export", expected="--glb, --vtkhdf, or both")
    case = load_changed_case(path, overrides)
    stages = OutputFolder(case.output_folder if out is None else out)
    results, problem = load_finite_results(case, stages.root)
    if results is None or not len(results.time):
        raise InputError(
            problem.removeprefix("No time histories: ") or "no results",
            source=stages.root,
            expected="time histories; make them with `heavylift simulate CASE`",
        )
    if problem:
        log.say(f"export: {problem}")
    with in_case(case):
        drawn = case_scene(case, stages, assemble_scene(case, stages), results)

    def glb(file: Path, drawn: DrawnScene) -> list[str]:
        return write_glb(file, drawn, title=case.title, generator=f"heavylift {version('heavylift')}")

    writers: dict[str, Callable[[Path, DrawnScene], list[str]]] = {"glb": glb, "vtkhdf": write_vtkhdf}
    files = []
    for kind in kinds:
        file = stages.stage("export") / f"{case.name}.{kind}"
        file.parent.mkdir(parents=True, exist_ok=True)
        with replacing(file) as temporary:
            notes = writers[kind](temporary, drawn)
        size = file.stat().st_size / 1e6
        log.say(f"export: {file}, {size:.3g} MB{''.join(f'; {note}' for note in notes)}")
        files.append(file)
    return files
