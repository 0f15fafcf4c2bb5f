"""Hydrodynamic databases from the listing of WAMIT, .out.

Conventions and their conversion: `heavylift.preprocess.hydrodynamics.wamit_coefficients`.

Source: WAMIT User Manual, versions 7.2 and 7.4, section 5.1.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase, check_database, check_phase
from heavylift.preprocess.hydrodynamics.wamit_coefficients import (
    INFINITE_FREQUENCY,
    ZERO_FREQUENCY,
    WamitRows,
    restoring_scale,
    text_lines,
    wamit_database,
    without_weight,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

__all__ = ["read_wamit_out"]


@dataclass(frozen=True)
class _Body:
    """What a listing says about one body."""

    origin: tuple[float, float, float]
    volume: float
    centre_of_buoyancy: tuple[float, float, float]
    centre_of_gravity: tuple[float, float, float]
    restoring: NDArray[np.float64]


def read_wamit_out(
    path: Path | str,
    *,
    density: float,
    bodies: tuple[str, ...] = (),
    symmetric: bool = False,
    forces: str = "diffraction",
) -> HydrodynamicDatabase:
    """Read the listing ``.out``: it states gravity, length, depth, bodies and restoring, but seldom the density.

    Phases in a listing are rounded to a degree, which is an error of up to 1 % of the force: prefer the ``.3`` file
    where there is one.

    Parameters
    ----------
    path
        The listing.
    density
        Of the water [kg/m^3]; compared with the listing where that states one.
    bodies
        Names; numbered if none are given.
    symmetric
        Hulls are symmetric about y = 0 and headings cover 0..180 deg only.
    forces
        ``"diffraction"`` or ``"haskind"``: which of the two sets of exciting forces.

    Raises
    ------
    InputError
        Not such a listing, a body turned in the plane (`PHIBODY`), no infinite frequency, another density,
        or what `check_database` and `check_phase` refuse.
    """
    path = Path(path)
    if forces not in {"diffraction", "haskind"}:
        raise InputError(repr(forces), source=path, key="forces", expected="'diffraction' or 'haskind'")
    lines = text_lines(path)
    gravity, length, depth = _stated_scales(lines, path, density)
    listed = list(_listed_bodies(lines, path))
    if not listed:
        raise InputError("no body (XBODY)", source=path, expected="a listing of WAMIT")
    rows = WamitRows()
    _read_listing(lines, path, rows, forces)
    references = np.array([body.origin for body in listed])
    database = wamit_database(
        rows,
        source=str(path),
        references=references,
        names=bodies,
        scales=(length, density, gravity, depth),
        symmetric=symmetric,
    )
    stiffness = [
        without_weight(
            body.restoring * restoring_scale(length) * density * gravity,
            density * gravity * body.volume,
            np.array(body.centre_of_gravity),
        )
        for body in listed
    ]
    database = replace(
        database,
        volumes=np.array([body.volume for body in listed]),
        centres_of_buoyancy=np.array([body.centre_of_buoyancy for body in listed]) + references,
        hydrostatic_stiffness=np.array(stiffness),
    )
    check_database(database)
    check_phase(database)
    return database


def _number_after(pattern: str, lines: list[str]) -> float | None:
    """The number that follows a pattern in the first line that has it ("infinite" is one)."""
    for line in lines:
        found = re.search(pattern + r"\s*([-+.\deE]+|infinite)", line)
        if found:
            return np.inf if found.group(1) == "infinite" else float(found.group(1))
    return None


def _stated_scales(lines: list[str], path: Path, density: float) -> tuple[float, float, float]:
    """Gravity, length and depth of a listing; the density, if stated, must be the one given."""
    gravity, length, depth, stated = (
        _number_after(pattern, lines)
        for pattern in (r"Gravity\s*:", r"Length scale\s*:", r"Water depth\s*:", r"Water density\s*:")
    )
    if gravity is None or length is None or depth is None:
        raise InputError(
            "no gravity, length scale or water depth", source=path, expected="a listing of WAMIT"
        )
    if stated is not None and abs(stated - density) > 1e-3 * density:
        raise InputError(
            f"{density:g} kg/m^3", source=path, key="density", expected=f"what the listing states, {stated:g}"
        )
    return gravity, length, depth


def _numbers(line: str) -> list[float]:
    """Numbers after the last colon of a line."""
    return [float(v) for v in line.rsplit(":", 1)[-1].split()]


def _listed_bodies(lines: list[str], path: Path) -> Iterator[_Body]:
    """Bodies in the order of the listing."""
    starts = [i for i, line in enumerate(lines) if "XBODY" in line and "PHIBODY" in line]
    for start, end in zip(starts, [*starts[1:], len(lines)], strict=True):
        x, y, z, turn = (float(v) for v in re.findall(r"=\s*([-+.\dEe]+)", lines[start]))
        if turn != 0.0:
            raise InputError(
                f"PHIBODY = {turn:g} deg",
                source=path,
                key=f"line {start + 1}",
                expected="bodies along the global axes",
            )
        volume, buoyancy, gravity_centre = 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        restoring = np.zeros((6, 6))
        for line in lines[start + 1 : min(end, start + 40)]:
            if "Wave period" in line:
                break
            if "Volumes (" in line:
                volume = float(np.median(_numbers(line)))
            elif "Center of Buoyancy" in line:
                buoyancy = _point(line)
            elif "Center of Gravity" in line:
                gravity_centre = _point(line)
            elif re.search(r"C\(\d,\d\)", line):
                for (i, j), value in zip(re.findall(r"C\((\d),(\d)\)", line), _numbers(line), strict=True):
                    restoring[int(i) - 1, int(j) - 1] = value
        for i, j in ((2, 3), (2, 4), (3, 4)):
            restoring[j, i] = restoring[i, j]
        yield _Body((x, y, z), volume, buoyancy, gravity_centre, restoring)


def _point(line: str) -> tuple[float, float, float]:
    """Three coordinates."""
    x, y, z = _numbers(line)
    return x, y, z


def _read_listing(lines: list[str], path: Path, rows: WamitRows, forces: str) -> None:
    """Coefficients of every period of a listing."""
    omega = np.nan
    heading = np.nan
    table = ""
    for number, line in enumerate(lines, start=1):
        period = re.search(r"Wave period\s*(?:\(sec\))?\s*=\s*(\S+)", line)
        if period:
            word = period.group(1)
            special = {"infinite": ZERO_FREQUENCY, "zero": INFINITE_FREQUENCY}
            omega = special[word] if word in special else 2.0 * np.pi / float(word)
            table = ""
        elif "ADDED-MASS" in line:
            table = "radiation"
            rows.added_mass.setdefault(omega, {})
            rows.damping.setdefault(omega, {})
        elif "EXCITING FORCES AND MOMENTS" in line:
            table = "excitation" if forces.upper() in line else ""
        elif "Wave Heading (deg)" in line:
            heading = _numbers(line)[0]
        elif re.match(r"\s*[A-Z]{4,}[ \-]", line):
            table = ""
        elif table and re.match(r"\s*-?\d+\s", line):
            values = _row(line, path, number)
            if table == "radiation" and len(values) in {3, 4}:
                place = (int(values[0]) - 1, int(values[1]) - 1)
                rows.added_mass[omega][place] = values[2]
                rows.damping[omega][place] = values[3] if len(values) == 4 else 0.0
            elif table == "excitation" and len(values) == 3:
                turned = values[1] * np.exp(1j * np.deg2rad(values[2]))
                rows.excitation.setdefault((omega, heading), {})[abs(int(values[0])) - 1] = complex(turned)


def _row(line: str, path: Path, number: int) -> list[float]:
    """Numbers of one row of a table."""
    try:
        return [float(part) for part in line.split()]
    except ValueError:
        raise InputError(repr(line.strip()), source=path, key=f"line {number}", expected="numbers") from None
