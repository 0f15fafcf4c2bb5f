"""``heavylift database``: added mass, damping and excitation of the hulls of a case as pictures."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.commands.scene import check_databases, load_sea_case
from heavylift.pipeline.results.storage import replacing, write_json
from heavylift.preprocess.hydrodynamics.database import COORDINATES

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from heavylift.pipeline.log import Log
    from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase

__all__ = ["database_command", "database_entry"]


def database_command(
    path: Path, *, out: Path | None = None, overrides: Sequence[str] = (), log: Log
) -> tuple[dict[str, Any], list[str]]:
    """Read or compute the databases of a case and write pictures of them into ``database/``.

    Raises
    ------
    InputError
        If the case has no hulls or no databases, or one of them is wrong.
    """
    from heavylift.pipeline.pictures.hull_plots import database_plots
    from heavylift.pipeline.stages.lock import locked

    found = load_sea_case(path, out=out, overrides=overrides, log=log)
    check_databases(found)
    folder = found.folder.stage("database")
    entries, lines = [], [f"{found.case.name}: hydrodynamic databases", ""]
    with locked(found.folder.root):
        for name, radiation in zip(found.case.databases, found.sea.radiation, strict=True):
            database = radiation.database
            files = [folder / f"{name}.json"]
            entry = {"name": name, "hulls": list(radiation.bodies), **database_entry(database)}
            write_json(files[0], entry)
            for plot, png in database_plots(database).items():
                files.append(folder / f"{name}_{plot}.png")
                with replacing(files[-1]) as temporary:
                    temporary.write_bytes(png)
            entries.append({**entry, "files": [str(file) for file in files]})
            lines += [*_words(entry), "", *(f"  written: {file}" for file in files), ""]
    return {"case": found.case.name, "databases": entries}, lines[:-1]


def database_entry(database: HydrodynamicDatabase) -> dict[str, Any]:
    """What a database covers, and the mass of water at infinite frequency, SI units."""
    return {
        "source": database.source,
        "bodies": list(database.bodies),
        "omega": [float(database.omega[0]), float(database.omega[-1]), len(database.omega)],
        "headings": [*(float(angle) for angle in database.headings[[0, -1]]), len(database.headings)]
        if database.has_excitation
        else [],
        "repairs": list(database.repairs),
        "symmetric": database.symmetric,
        "drift": database.drift is not None,
        "density": database.density,
        "gravity": database.gravity,
        "depth": database.depth if math.isfinite(database.depth) else None,
        "reference_points": database.reference_points.tolist(),
        "added_mass_infinite": np.diag(database.added_mass_infinite).reshape(-1, 6).tolist(),
    }


def _words(entry: dict[str, Any]) -> list[str]:
    """For a person."""
    low, high, count = entry["omega"]
    waves = "no headings"
    if entry["headings"]:
        first, last, headings = entry["headings"]
        mirrored = ", mirrored about y = 0" if entry["symmetric"] else ""
        waves = (
            f"{headings} headings from {math.degrees(first):.4g} to {math.degrees(last):.4g} deg{mirrored}"
        )
    depth = "deep water" if entry["depth"] is None else f"depth {entry['depth']:g} m"
    drift = ", with mean drift" if entry["drift"] else ""
    lines = [
        f"  {entry['name']} of {', '.join(entry['hulls'])}: {entry['source']}",
        f"    {count} frequencies from {low:.4g} to {high:.4g} rad/s (periods down to {2 * math.pi / high:.3g} s)",
        f"    {waves}",
        *(f"    repaired: {sentence}" for sentence in entry["repairs"]),
        f"    {entry['density']:g} kg/m3, {entry['gravity']:g} m/s2, {depth}{drift}",
        f"    {'added mass at infinite frequency':<32s}" + "".join(f"{name:>12s}" for name in COORDINATES),
    ]
    for name, row in zip(entry["hulls"], entry["added_mass_infinite"], strict=True):
        lines.append(f"      {name:<30s}" + "".join(f"{value:>12.4g}" for value in row))
    return lines
