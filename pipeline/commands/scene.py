"""From a case to its packed scene with the sea, for commands that do not simulate."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.results.storage import StopError
from heavylift.pipeline.stages.stages import load_changed_case, run_case

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.solver.scene.scene import Scene
    from heavylift.solver.scene.sea import Hull, Sea

__all__ = ["SeaCase", "check_databases", "choose_hulls", "load_sea_case"]

_TABLES = {
    "hulls": "a table [hulls.NAME] for each rigid body that floats",
    "lines": "tables [[lines]] of mooring lines",
}


class SeaCase(NamedTuple):
    """A case with all that its scene needs."""

    case: Case
    folder: OutputFolder
    scene: Scene
    sea: Sea


def load_sea_case(
    path: Path,
    *,
    out: Path | None,
    overrides: Sequence[str],
    log: Log,
    needs: Literal["hulls", "lines"] = "hulls",
) -> SeaCase:
    """Read a case with a sea, make its meshes, modes, surfaces and databases if they are not there, and its scene.

    Parameters
    ----------
    path, out, overrides, log
        As of the commands.
    needs
        What the case must have.

    Raises
    ------
    InputError
        If something is wrong with the case, or it has no hulls (lines).
    StopError
        If a stage stops by itself.
    """
    from heavylift.pipeline.assemble.afloat import check_afloat
    from heavylift.pipeline.assemble.scene import assemble_scene
    from heavylift.pipeline.case.places import in_case

    case = load_changed_case(path, overrides)
    if not getattr(case, needs):  # before anything is made
        raise InputError(f"no {needs}", source=case.file, key=needs, expected=_TABLES[needs])
    result = run_case(case, out=out, stages=("mesh", "modes"), log=log)
    if result.outcome is not Outcome.COMPLETED:
        raise StopError(result.outcome, result.message)
    with in_case(case):
        scene = assemble_scene(case, result.folder)
        for note in check_afloat(case, scene):
            log.say(f"NOTE: {note}")
    assert scene.sea is not None
    return SeaCase(case, result.folder, scene, scene.sea)


def choose_hulls(case: SeaCase, names: Sequence[str]) -> tuple[Hull, ...]:
    """Hulls by name; all of them without names.

    Raises
    ------
    InputError
        If a name is unknown.
    """
    known = {hull.body: hull for hull in case.sea.hulls}
    for name in names:
        if name not in known:
            raise InputError(f"no hull {name!r}", source="--hull", expected=f"one of {', '.join(known)}")
    return tuple(known[name] for name in names or known)


def check_databases(case: SeaCase) -> None:
    """See that a hull has a database.

    Raises
    ------
    InputError
        If none has.
    """
    if not case.sea.radiation:
        raise InputError(
            "no databases",
            source=case.case.file,
            key="databases",
            expected="a table [databases.NAME] with 'file' or 'compute'",
        )
