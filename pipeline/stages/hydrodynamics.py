"""The part of the mesh stage that reads or computes the hydrodynamic databases of a case."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.assemble.hulls import database_manifest, read_database_source, stored_database
from heavylift.pipeline.case.places import located
from heavylift.pipeline.results.provenance import database_digest, memory_digest, source_digest, versions
from heavylift.pipeline.results.storage import (
    hdf5_stream,
    read_json,
    replacing,
    stored,
    unchanged,
    write_json,
)
from heavylift.pipeline.stages.surfaces import reused, taken
from heavylift.preprocess.hydrodynamics.database import database_faults
from heavylift.preprocess.hydrodynamics.memory_fit import fit_memory, read_memory, write_memory
from heavylift.preprocess.hydrodynamics.netcdf_files import read_digest
from heavylift.preprocess.hydrodynamics.repairs import remedies, repaired

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.hulls import DatabaseSection
    from heavylift.pipeline.stages.work import Work
    from heavylift.preprocess.hydrodynamics.bem import BemInputs
    from heavylift.preprocess.hydrodynamics.database import Fault, HydrodynamicDatabase

__all__ = ["make_databases"]

_KEYS = {"omega": "frequencies", "panel size": "panel_size", "headings": "headings"}
"""Keys of a computation by what its errors call them."""


def make_databases(work: Work) -> tuple[bool, float, dict[str, Any]]:
    """Read or compute every database that is not current, and store it as netCDF.

    Returns
    -------
    tuple
        Whether all were there, CPU time that making them took, now or before [s], and by name what is in the manifest.
    """
    case, folder, log = work.case, work.folder, work.log
    manifest_file = folder.database_manifest
    if not case.databases and not manifest_file.is_file():
        return True, 0.0, {}
    items = {name: item for name, item in database_manifest(folder).items() if name in case.databases}
    skipped = True
    for name, section in case.databases.items():
        file, digest = folder.database(name), database_digest(case, section)
        item = items.get(name, {})
        if "mesh" not in work.force and item.get("digest") != digest:
            found = reused(work, manifest_file, name, digest, file)
            if found is not None:
                item = items[name] = found
                _take_memory(work, name)
                _write_manifest(manifest_file, case, items)
        if "mesh" not in work.force and item.get("digest") == digest:
            if unchanged(file, item):
                if item.get("memory_of") == memory_digest(case, section) and (
                    section.memory != "exponentials" or unchanged(folder.memory(name), item.get("memory", {}))
                ):
                    log.say(f"mesh: {name}: unchanged, skipped")
                    continue
                about = _properties(work, name, stored_database(case, name, folder))
                items[name] = {**item, **_memory_entry(work, name), "properties": about}
                log.say(f"mesh: {name}: unchanged, with another memory: {_words(about)}")
                _write_manifest(manifest_file, case, items)
                continue
            if file.is_file():
                log.say(f"mesh: {name}: {file} is damaged, computed again")
        skipped = False
        begin = time.process_time()
        with located(case, f"databases.{name}"):
            database = _made(work, name, section)
            properties = _properties(work, name, database)
        items[name] = {
            "digest": digest,
            **stored(file),
            "cpu_s": time.process_time() - begin,
            **_memory_entry(work, name),
            "properties": properties,
        }
        log.say(f"mesh: {name}: {_words(properties)}; {items[name]['cpu_s']:.2f} s CPU")
        for sentence in database.repairs:
            log.say(f"mesh: {name}: REPAIRED: {sentence}")
        _write_manifest(manifest_file, case, items)
    return skipped, sum(item["cpu_s"] for item in items.values()), items


def _memory_entry(work: Work, name: str) -> dict[str, Any]:
    """What the memory of a database was made of, and the file of its exponentials, for the manifest."""
    section, file = work.case.databases[name], work.folder.memory(name)
    entry = {"memory": stored(file)} if section.memory == "exponentials" else {}
    return {"memory_of": memory_digest(work.case, section), **entry}


def _take_memory(work: Work, name: str) -> None:
    """Exponentials of the same memory from another output folder."""
    key = memory_digest(work.case, work.case.databases[name])
    for other in work.reuse:
        if read_memory(other.memory(name), key) is not None:
            taken(other.memory(name), work.folder.memory(name))
            return


def _write_manifest(file: Path, case: Case, items: dict[str, Any]) -> None:
    write_json(
        file,
        {
            "stage": "hydrodynamics",
            "outcome": Outcome.COMPLETED.name.lower(),
            "case": case.name,
            "overrides": case.overrides,
            "sources_digest": source_digest("hydrodynamics"),
            "versions": versions("hydrodynamics"),
            "items": items,
        },
    )


def _made(work: Work, name: str, section: DatabaseSection) -> HydrodynamicDatabase:
    """Database from its file, or computed, after repairs.

    One from a file is stored with its repairs; what was computed as it was computed, also if it is refused.
    """
    if section.compute is None:
        read = read_database_source(work.case, section)
        _write(work.folder.database(name), read, "", checked=True)
        return read
    from heavylift.pipeline.assemble.hulls import bem_inputs
    from heavylift.preprocess.hydrodynamics.bem import capytaine_version, compute_database, expected_seconds
    from heavylift.preprocess.hydrodynamics.bem import database_digest as inputs_digest

    inputs = bem_inputs(
        work.case, section, work.folder, say=lambda text: work.log.say(f"mesh: {name}: {text}")
    )
    digest = inputs_digest(inputs)
    refused = work.folder.refused_database(name)
    database = None if "mesh" in work.force else _computed_before(work, name, inputs)
    if database is None:
        capytaine_version()  # before any message: without it nothing can be done
        count = sum(len(hull.panels) for hull in inputs.hulls)
        covers = sum(len(lid.panels) for lid in inputs.lids if lid is not None)
        seconds = expected_seconds(inputs, section.compute.processes)
        work.log.say(
            f"mesh: {name}: {count} panels and {covers} of lids, {len(inputs.omega)} frequencies, "
            f"{len(inputs.headings)} headings: {_duration(seconds)} by estimate"
        )
        found: list[HydrodynamicDatabase] = []
        with work.log.progress(f"mesh {name}", len(inputs.omega) + 1) as progress:
            try:
                database = compute_database(
                    inputs,
                    processes=section.compute.processes,
                    progress=progress,
                    warn=lambda text: work.log.say(f"mesh: {name}: WARNING: {text}"),
                    keep=found.append,
                    repair=section.repair,
                )
            except InputError as error:
                if found:
                    _write(refused, found[0], digest)
                    raise _explained(work, name, section, found[0], error) from None
                key = _KEYS.get(error.key)
                if key is None:
                    raise
                raise InputError(error.problem, key=f"compute.{key}", expected=error.expected) from None
        raw = found[0] if found else database
    else:
        work.log.say(f"mesh: {name}: the same panels, frequencies and headings: not computed again")
        raw = database
        try:
            database = repaired(database, section.repair)
        except InputError as error:
            raise _explained(work, name, section, raw, error) from None
    _write(work.folder.database(name), raw, digest)
    if not refused.is_file() or read_digest(refused) == digest:
        for file in (refused, refused.with_suffix(".json")):
            file.unlink(missing_ok=True)
    return database


def _duration(seconds: float) -> str:
    """An estimate to one digit, in the unit that suits it."""
    for unit, length in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 2.0 * length:
            return f"about {seconds / length:.0f} {unit}"
    return f"about {max(1.0, seconds):.0f} s"


def _computed_before(work: Work, name: str, inputs: BemInputs) -> HydrodynamicDatabase | None:
    """From the output folder, accepted or refused, if it has all that is wanted of the same panels."""
    from heavylift.preprocess.hydrodynamics.bem import database_digest as inputs_digest
    from heavylift.preprocess.hydrodynamics.bem import part_of
    from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf

    refused = work.folder.refused_database(name)
    accepted = database_manifest(work.folder).get(name, {}).get("properties", {})
    refusal = read_json(refused.with_suffix(".json")) or {}
    for file, about in ((work.folder.database(name), accepted), (refused, refusal)):
        digest = read_digest(file) if file.is_file() else ""
        if not digest:
            continue
        kept: HydrodynamicDatabase | None = read_netcdf(file, checked=False)
        assert kept is not None
        if digest != inputs_digest(inputs):
            same = digest == inputs_digest(replace(inputs, omega=kept.omega))
            kept = part_of(kept, inputs.omega) if same else None
        if kept is not None:
            return replace(kept, source=str(about.get("source", name)))
    return None


def _explained(
    work: Work,
    name: str,
    section: DatabaseSection,
    database: HydrodynamicDatabase,
    error: InputError,
) -> InputError:
    """What is wrong with what was computed, with every frequency, and what to set; as JSON beside it and in the log."""
    faults = database_faults(database, section.repair.limits)
    kept = work.folder.refused_database(name)
    sentences = [fault.words(database) for fault in faults] or [f"{error.key}: {error.problem}"]
    remedy = _remedy(section, database, faults)
    write_json(
        kept.with_suffix(".json"),
        {
            "file": kept.name,
            "digest": database_digest(work.case, section),
            "source": database.source,
            "problems": sentences,
            "faults": [
                {
                    "matrix": fault.key,
                    "omega": fault.omega if np.isfinite(fault.omega) else None,
                    "entries": list(fault.entries),
                    "share": fault.size,
                }
                for fault in faults
            ],
            "remedy": remedy,
        },
    )
    for sentence in sentences:
        work.log.say(f"mesh: {name}: REFUSED: {sentence}")
    work.log.say(f"mesh: {name}: the computed database is kept in {kept}")
    shown = "; ".join(sentences[:_SHOWN])
    if len(sentences) > _SHOWN:
        shown += f"; {len(sentences) - _SHOWN} more in {kept.with_suffix('.json').name}"
    return InputError(
        f"the computed database is impossible: {shown}", key="compute", expected=remedy or error.expected
    )


_SHOWN = 4
"""Frequencies that a message names."""


def _remedy(section: DatabaseSection, database: HydrodynamicDatabase, faults: Sequence[Fault]) -> str:
    """What to set against matrices that are not reciprocal, or drive."""
    compute = section.compute
    assert compute is not None
    if not faults:
        return ""
    words = [] if compute.lid else ["'compute.lid = true', which removes irregular frequencies"]
    words.append(f"a 'compute.panel_size' below {compute.panel_size:g} m")
    words += [
        f"{word}; nothing is computed again then" for word in remedies(database, faults, section.repair)
    ]
    limits = section.repair.limits
    return (
        f"a symmetric matrix within {limits.unsymmetric:.0%} and no damping below -{limits.negative:.0%} of the "
        f"largest: {'; or '.join(words)}"
    )


def _write(file: Path, database: HydrodynamicDatabase, digest: str, *, checked: bool = False) -> None:
    from heavylift.preprocess.hydrodynamics.netcdf_files import write_netcdf

    with replacing(file) as temporary, hdf5_stream(temporary) as stream:
        write_netcdf(stream, database, digest=digest, checked=checked)


def _properties(work: Work, name: str, database: HydrodynamicDatabase) -> dict[str, Any]:
    """Summary for manifest and report of a database, as plain values; its memory is fitted and stored."""
    section = work.case.databases[name]
    found: dict[str, Any] = {
        "source": database.source,
        "bodies": list(database.bodies),
        "hulls": list(section.hulls),
        "frequencies": len(database.omega),
        "frequency_range": [float(database.omega[0]), float(database.omega[-1])],
        "headings": len(database.headings),
        "heading_range": [float(angle) for angle in database.headings[[0, -1]]]
        if len(database.headings)
        else [],
        "symmetric": bool(database.symmetric),
        "density": database.density,
        "gravity": database.gravity,
        "depth": database.depth if np.isfinite(database.depth) else None,
        "reference_points": database.reference_points.tolist(),
        "volumes": None if database.volumes is None else [float(v) for v in database.volumes],
        "drift": database.drift is not None,
        "repairs": list(database.repairs),
    }
    if section.memory == "exponentials":
        fit = fit_memory(database, section.memory_length, tolerance=section.fit_error)
        with replacing(work.folder.memory(name)) as temporary:
            write_memory(temporary, fit, memory_digest(work.case, section))
        found["memory"] = {"length": fit.length, "poles": fit.pole_count, "error": float(fit.error)}
    return found


def _words(properties: dict[str, Any]) -> str:
    """A database in a line."""
    low, high = properties["frequency_range"]
    words = [
        f"{properties['frequencies']} frequencies from {low:.4g} to {high:.4g} rad/s",
        f"{properties['headings']} headings" if properties["headings"] else "no exciting forces",
        properties["source"],
    ]
    memory = properties.get("memory")
    if memory:
        words.append(
            f"memory of {memory['length']:.3g} s by {memory['poles']} poles to {memory['error']:.1e}"
        )
    return ", ".join(words)
