"""Reduced bodies for other programs: four files, standard input data, netCDF."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from pathlib import Path

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = ["NODES", "export_bodies"]

NODES = 2000
"""Of a body without interfaces, up to which standard input data list them all."""


def export_bodies(case: Case, folder: OutputFolder, target: Path, log: Log) -> dict[str, list[str]]:
    """Write the reduced bodies of a case, whose modes are made, to ``TARGET/BODY``.

    Parameters
    ----------
    case
        The case.
    folder
        Its output folder.
    target
        Made if missing; files of the same names are replaced.
    log
        Says what is written, and what a format can not hold.

    Returns
    -------
    dict
        Names of the files of each body.

    Raises
    ------
    InputError
        A case without a body of ``type = "flexible"``; damping ratios that do not fit.
    """
    from heavylift.modal.standard_input import standard_input
    from heavylift.pipeline.assemble.flexible import damping_ratios
    from heavylift.pipeline.results.model_io import read_header, read_model, read_reduced
    from heavylift.pipeline.results.reduced_netcdf import write_reduced_netcdf
    from heavylift.pipeline.results.sid_files import write_sid
    from heavylift.preprocess.finite_elements.exchange import (
        MASS_FILE,
        MODE_FILE,
        NODE_FILE,
        STIFFNESS_FILE,
        write_four_files,
    )

    bodies = {name: body for name, body in case.bodies.items() if body.BODY.MODAL}
    if not bodies:
        raise InputError(
            "no body with modes", source=case.file, key="--export", expected='a body of type = "flexible"'
        )
    written: dict[str, list[str]] = {}
    for name, section in bodies.items():
        reduced = read_reduced(folder.reduced(name))
        origin = json.loads(read_header(folder.reduced(name))["frame_origin"])
        ratios = np.broadcast_to(damping_ratios(case, name, section, reduced), reduced.mode_count)
        place = target / name
        place.mkdir(parents=True, exist_ok=True)
        write_reduced_netcdf(place / f"{name}.nc", reduced, name=name, origin=origin, damping_ratio=ratios)
        files = [f"{name}.nc"]
        if reduced.interfaces or reduced.node_count <= NODES:
            write_sid(place / f"{name}.SID_FEM", standard_input(reduced, ratios), name)
            files.append(f"{name}.SID_FEM")
        else:
            log.say(
                f"export: {name}: standard input data are not written: without interfaces they list all of its "
                f"{reduced.node_count} nodes, which is for up to {NODES}; they need [bodies.{name}.interfaces.NAME]"
            )
        model = read_model(folder.model(name))
        shapes = reduced.mode_shapes.transpose(1, 2, 0).reshape(3 * reduced.node_count, -1)
        try:
            write_four_files(place, replace(model, nodes=reduced.nodes, mesh=None), shapes)
            files += [NODE_FILE, MASS_FILE, STIFFNESS_FILE, MODE_FILE]
        except InputError as error:
            log.say(
                f"export: {name}: four files are not written: {error.problem}; they need {error.expected}"
            )
        written[name] = files
        log.say(f"export: {name}: {', '.join(files)} in {place}")
    return written
