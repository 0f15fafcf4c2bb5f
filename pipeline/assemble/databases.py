"""Hydrodynamic databases of a case: from their files or the output folder to what the solver integrates."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.water import water_of
from heavylift.pipeline.case.places import located
from heavylift.pipeline.results.provenance import database_digest
from heavylift.pipeline.results.storage import read_json

if TYPE_CHECKING:
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.hulls import DatabaseSection
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
    from heavylift.solver.scene.sea import Radiation

__all__ = [
    "assemble_radiation",
    "database_manifest",
    "read_database_source",
    "stored_database",
]


def assemble_radiation(case: Case, folder: OutputFolder) -> tuple[Radiation, ...]:
    """Databases of a case."""
    from heavylift.solver.scene.sea import Radiation

    found = []
    for name, section in case.databases.items():
        with located(case, f"databases.{name}"):
            database = stored_database(case, name, folder)
            if database.body_count != len(section.hulls):
                raise InputError(
                    f"{len(section.hulls)} hulls for a database of {database.body_count}",
                    key="hulls",
                    expected=f"one for each of {', '.join(database.bodies)}",
                )
        found.append(
            Radiation(
                bodies=section.hulls,
                database=database,
                memory=section.memory,
                memory_length=section.memory_length,
                fit_error=section.fit_error,
                drift=section.drift,
            )
        )
    return tuple(found)


def database_manifest(folder: OutputFolder) -> dict[str, Any]:
    """What the mesh stage says of the databases, by name; empty if it has not run."""
    return dict((read_json(folder.database_manifest) or {}).get("items", {}))


def stored_database(case: Case, name: str, folder: OutputFolder) -> HydrodynamicDatabase:
    """Database of a case as its output folder has it; one of a file is read anew if it is absent or of other inputs.

    Raises
    ------
    InputError
        If one that has to be computed is not there, or a file cannot be read.
    """
    from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf

    section, file = case.databases[name], folder.database(name)
    item = database_manifest(folder).get(name, {})
    if file.is_file() and item.get("digest") == database_digest(case, section):
        return replace(read_netcdf(file), source=str(item["properties"]["source"]))
    if section.file is not None:
        return read_database_source(case, section)
    raise InputError(
        "has not been computed for these inputs",
        key="compute",
        expected="a database in the output folder; make it with `heavylift mesh CASE`",
    )


def read_database_source(case: Case, section: DatabaseSection) -> HydrodynamicDatabase:
    """Database from the file that a case names, called by this name, wherever the case folder is.

    Raises
    ------
    InputError
        If the file cannot be read, or is no database that can be true.
    """
    return replace(_read(case, section), source=str(section.file))


def _read(case: Case, section: DatabaseSection) -> HydrodynamicDatabase:
    """The same by the name that its reader gives it."""
    assert section.file is not None
    path = case.folder / section.file
    points = None if section.reference_points is None else np.array(section.reference_points)
    if section.file_format == "netcdf":
        from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf

        return read_netcdf(path, time_convention=section.time_convention or "", reference_points=points)
    if section.file_format == "bemio":
        from heavylift.preprocess.hydrodynamics.bemio_files import read_bemio

        return read_bemio(path, reference_points=points, symmetric=bool(section.symmetric))
    water = water_of(case)
    if section.file_format == "wamit-out":
        from heavylift.preprocess.hydrodynamics.wamit_files import read_wamit_out

        return read_wamit_out(
            path,
            density=water.density,
            bodies=section.hulls,
            symmetric=bool(section.symmetric),
            forces=section.forces or "diffraction",
        )
    from heavylift.preprocess.hydrodynamics.wamit_files import read_wamit

    return read_wamit(
        path,
        length=section.length_scale or 1.0,
        density=water.density,
        gravity=water.gravity,
        depth=water.depth,
        reference_points=np.zeros((len(section.hulls), 3)) if points is None else points,
        bodies=section.hulls,
        first_column=section.first_column or "period",
        symmetric=bool(section.symmetric),
    )
