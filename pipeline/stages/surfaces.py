"""The part of the mesh stage that makes the surfaces of triangles of a case."""

from __future__ import annotations

import os
import shutil
import sys
import time
from functools import partial
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import Outcome
from heavylift.numerics.side_by_side import SideBySide
from heavylift.pipeline.assemble.surfaces import (
    StoredSurface,
    magnitude_warnings,
    make_surface,
    read_surface_file,
    write_surface_file,
)
from heavylift.pipeline.results.provenance import source_digest, surface_digest, versions
from heavylift.pipeline.results.storage import read_json, replacing, stored, unchanged, write_json

if TYPE_CHECKING:
    from pathlib import Path

    from heavylift.pipeline.stages.work import Work

__all__ = ["make_surfaces", "reused", "taken"]


def make_surfaces(work: Work) -> tuple[bool, float, dict[str, Any]]:
    """Make the file of every surface that is not current; those of bodies that deform need none.

    Returns
    -------
    tuple
        Whether all were there, CPU time that making them took, now or before [s], and by name what is in the manifest.
    """
    case, folder, log = work.case, work.folder, work.log
    deforming = {name for name, body in case.bodies.items() if body.BODY.DEFORMS}
    wanted = {s.name: i for i, s in enumerate(case.surfaces) if s.body not in deforming}
    manifest_file = folder.surface_manifest
    if not wanted and not manifest_file.is_file():
        return True, 0.0, {}
    items = dict((read_json(manifest_file) or {}).get("items", {}))
    items = {name: item for name, item in items.items() if name in wanted}
    forced, digests, states = "mesh" in work.force, dict[str, str](), dict[str, bool | None]()
    for name, index in wanted.items():
        file, digests[name] = folder.surface(name), surface_digest(case, case.surfaces[index])
        current = not forced and items.get(name, {}).get("digest") == digests[name]
        states[name] = unchanged(file, items[name]) if current else None

    def make(name: str) -> tuple[StoredSurface, dict[str, Any]]:
        begin, file = time.process_time(), folder.surface(name)
        surface = make_surface(case, wanted[name])
        write_surface_file(file, surface)
        seconds = time.process_time() - begin
        return surface, {
            "digest": digests[name],
            **stored(file),
            "cpu_s": seconds,
            "properties": surface.report,
        }

    makes = {name: partial(make, name) for name in wanted if not states[name]}
    # shapes take less than a process; what another folder may have is looked for first, one after the other
    read = {name: each for name, each in makes.items() if case.surfaces[wanted[name]].file is not None}
    several = read if not work.reuse or forced else {}
    skipped, made = True, dict[str, StoredSurface]()
    with SideBySide(list(several.values()), alone="gmsh" in sys.modules) as processes:
        results = processes.results()
        for name in wanted:
            if states[name]:
                log.say(f"mesh: {name}: unchanged, skipped")
                continue
            file = folder.surface(name)
            if states[name] is False and file.is_file():
                log.say(f"mesh: {name}: {file} is damaged, read again")
            skipped = False
            found = None if forced else reused(work, manifest_file, name, digests[name], file)
            if found is None:
                made[name], found = next(results) if name in several else makes[name]()
                log.say(f"mesh: {name}: {_words(found['properties'])}; {found['cpu_s']:.2f} s CPU")
            items[name] = found
            write_json(
                manifest_file,
                {
                    "stage": "surfaces",
                    "outcome": Outcome.COMPLETED.name.lower(),
                    "case": case.name,
                    "overrides": case.overrides,
                    "sources_digest": source_digest("surfaces"),
                    "versions": versions("surfaces"),
                    "items": items,
                },
            )
    surfaces = {name: made.get(name) or read_surface_file(folder.surface(name)) for name in wanted}
    for warning in magnitude_warnings(case, surfaces):
        log.say(f"mesh: WARNING: {warning}")
    return skipped, sum(item["cpu_s"] for item in items.values()), items


def _words(report: dict[str, Any]) -> str:
    """Counts of a surface in a line."""
    if not report["edges"]:
        return f"round, radius {report['radius']:.6g} m"
    words = [f"{report['triangles']} triangles", f"{report['points']} points"]
    words.append("watertight" if report["watertight"] else f"{report['open_edges']} open edges")
    if report["reversed_triangles"]:
        words.append(f"{report['reversed_triangles']} wound against their neighbours")
    if report["excluded"]:
        words.append(f"{report['excluded']} more are excluded")
    return ", ".join(words)


def reused(work: Work, manifest: Path, name: str, digest: str, file: Path) -> dict[str, Any] | None:
    """Take a file of a stage from another output folder: its entry in the manifest, None if no folder has it.

    Parameters
    ----------
    work
        Names the folders.
    manifest, file
        Where both are in the folder of this run.
    name, digest
        Of the entry.
    """
    root = work.folder.root
    for other in work.reuse:
        entries = read_json(other.root / manifest.relative_to(root)) or {}
        item = entries.get("items", {}).get(name, {})
        source = other.root / file.relative_to(root)
        if item.get("digest") != digest or not unchanged(source, item):
            continue
        taken(source, file)
        work.log.say(f"{file.parent.name}: {name}: unchanged, taken from {other.root}")
        return dict(item)
    return None


def taken(source: Path, file: Path) -> None:
    """The same file in another place: files are replaced, never changed, so they may be shared."""
    with replacing(file) as temporary:
        try:
            os.link(source, temporary)
        except OSError:
            shutil.copyfile(source, temporary)
