"""Hydrodynamic databases from the numeric files of WAMIT, .1, .3 and .hst (other panel codes write them too).

Conventions and their conversion: `heavylift.preprocess.hydrodynamics.wamit_coefficients`.

Source: WAMIT User Manual, versions 7.2 and 7.4, sections 5.2 and 5.6.
"""

from __future__ import annotations

from dataclasses import replace
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

    from numpy.typing import ArrayLike, NDArray

__all__ = ["read_wamit"]


def read_wamit(
    path: Path | str,
    *,
    length: float = 1.0,
    density: float,
    gravity: float,
    depth: float,
    reference_points: ArrayLike = ((0.0, 0.0, 0.0),),
    bodies: tuple[str, ...] = (),
    volumes: ArrayLike | None = None,
    centres_of_buoyancy: ArrayLike | None = None,
    centres_of_gravity: ArrayLike | None = None,
    first_column: str = "period",
    symmetric: bool = False,
) -> HydrodynamicDatabase:
    """Read the numeric files ``path.1``, ``path.3`` and, if they are there, ``path.hst`` and ``path.9`` or ``path.8``.

    These files do not say what made them non-dimensional: it has to be given. The mean drift is that of the run:
    of hulls that moved (or did not) as they did there. ``.9`` is from pressure, ``.8`` from momentum (surge, sway and
    yaw of all bodies together: read for one body alone).

    Parameters
    ----------
    path
        The files without their ending (an ending .1, .3, .8, .9 or .hst is dropped).
    length
        `ULEN` [m].
    density, gravity, depth
        [kg/m^3], [m/s^2], [m] (``inf`` for deep water).
    reference_points
        (N, 3) origins of the bodies in global axes [m] (`XBODY`).
    bodies
        Names; numbered if none are given.
    volumes, centres_of_buoyancy
        (N,) [m^3], (N, 3) [m, global axes], for the database.
    centres_of_gravity
        (N, 3) [m], relative to the reference points, that WAMIT was given. Where they are not all zero the
        restoring of ``.hst`` has terms of weight, rho V g, which need ``volumes`` to be taken out.
    first_column
        ``"period"`` [s], or ``"omega"`` [rad/s] (`IPEROUT` = 2; then 0 is zero and -1 infinite frequency).
    symmetric
        Hulls are symmetric about y = 0 and headings cover 0..180 deg only.

    Raises
    ------
    InputError
        A file is missing or not as WAMIT writes it, no infinite frequency, frequencies that differ between
        files, volumes needed and not given, or what `check_database` and `check_phase` refuse.
    """
    base = Path(path)
    if base.suffix in {".1", ".3", ".8", ".9", ".hst"}:
        base = base.with_suffix("")
    if first_column not in {"period", "omega"}:
        raise InputError(repr(first_column), source=base, key="first_column", expected="'period' or 'omega'")
    rows = WamitRows()
    _read_radiation(base.with_name(base.name + ".1"), rows, first_column)
    _read_excitation(base.with_name(base.name + ".3"), rows, first_column)
    references = np.asarray(reference_points, dtype=np.float64).reshape(-1, 3)
    database = wamit_database(
        rows,
        source=str(base),
        references=references,
        names=bodies,
        scales=(length, density, gravity, depth),
        symmetric=symmetric,
    )
    count = len(references)
    volume = None if volumes is None else np.asarray(volumes, dtype=np.float64).reshape(count)
    centres = (
        None
        if centres_of_buoyancy is None
        else np.asarray(centres_of_buoyancy, dtype=float).reshape(count, 3)
    )
    stiffness = None
    restoring = base.with_name(base.name + ".hst")
    if restoring.is_file():
        gravity_arms = np.zeros((count, 3))
        if centres_of_gravity is not None:
            gravity_arms = np.asarray(centres_of_gravity, dtype=np.float64).reshape(count, 3)
        if np.any(gravity_arms != 0.0) and volume is None:
            raise InputError(
                "the restoring coefficients contain the weight",
                source=restoring,
                key="volumes",
                expected="displaced volumes [m^3]: the weight is that of the displaced water",
            )
        whole = _read_restoring(restoring, count) * restoring_scale(length) * density * gravity
        stiffness = np.array(
            [
                without_weight(
                    whole[b], 0.0 if volume is None else density * gravity * volume[b], gravity_arms[b]
                )
                for b in range(count)
            ]
        )
    database = replace(
        database,
        drift=_drift(base, database, length, first_column),
        volumes=volume,
        centres_of_buoyancy=centres,
        hydrostatic_stiffness=stiffness,
    )
    check_database(database)
    check_phase(database)
    return database


def _table(path: Path, columns: tuple[int, ...]) -> Iterator[list[float]]:
    """Rows of numbers; a first line of words is passed over."""
    for number, line in enumerate(text_lines(path), start=1):
        parts = line.replace("D", "E").replace("d", "e").split()
        if not parts:
            continue
        try:
            values = [float(part) for part in parts]
        except ValueError:
            if number == 1:
                continue
            raise InputError(
                repr(line.strip()), source=path, key=f"line {number}", expected="numbers"
            ) from None
        if len(values) not in columns:
            raise InputError(
                f"{len(values)} columns",
                source=path,
                key=f"line {number}",
                expected=" or ".join(str(c) for c in columns),
            )
        yield values


def _frequency(value: float, first_column: str) -> float:
    """Angular frequency [rad/s] of the first column."""
    if first_column == "omega":
        return INFINITE_FREQUENCY if value < 0.0 else value
    if value < 0.0:
        return ZERO_FREQUENCY
    return INFINITE_FREQUENCY if value == 0.0 else 2.0 * np.pi / value


def _read_radiation(path: Path, rows: WamitRows, first_column: str) -> None:
    """Period, i, j, A, and B where the frequency is neither zero nor infinite."""
    for values in _table(path, (4, 5)):
        omega = _frequency(values[0], first_column)
        place = (int(values[1]) - 1, int(values[2]) - 1)
        rows.added_mass.setdefault(omega, {})[place] = values[3]
        rows.damping.setdefault(omega, {})[place] = values[4] if len(values) == 5 else 0.0


def _read_excitation(path: Path, rows: WamitRows, first_column: str) -> None:
    """Period, heading [deg], i, modulus, phase [deg], real and imaginary part."""
    for values in _table(path, (7,)):
        key = (_frequency(values[0], first_column), values[1])
        rows.excitation.setdefault(key, {})[abs(int(values[2])) - 1] = complex(values[5], values[6])


def _drift(
    base: Path, database: HydrodynamicDatabase, length: float, first_column: str
) -> NDArray[np.float64] | None:
    """(nw, nh, 6N) mean drift per square of the amplitude: F / (rho g L), M / (rho g L^2); None without a file."""
    path = base.with_name(base.name + ".9")
    if not path.is_file():
        path = base.with_name(base.name + ".8")
        if not path.is_file() or database.body_count > 1:
            return None
    n = 6 * database.body_count
    scale = database.density * database.gravity * length ** (1.0 + (np.arange(n) % 6 >= 3))
    drift = np.zeros((len(database.omega), len(database.headings), n))
    found = np.zeros(drift.shape[:2], dtype=bool)
    # period, two headings [deg], i, modulus, phase, real and imaginary part; of two headings that differ we have no use
    for values in _table(path, (8,)):
        if values[1] != values[2]:
            continue
        omega, i = _frequency(values[0], first_column), abs(int(values[3])) - 1
        w = int(np.argmin(np.abs(database.omega - omega)))
        h = int(np.argmin(np.abs(database.headings - np.deg2rad(values[1]))))
        near = abs(database.omega[w] - omega) < 1e-4 * omega
        if not near or abs(np.rad2deg(database.headings[h]) - values[1]) > 1e-3 or i >= n:
            raise InputError(
                f"a row of {values[0]:g}, {values[1]:g} deg, mode {i + 1}",
                source=path,
                expected="frequencies, headings and modes of the exciting forces",
            )
        drift[w, h, i] = values[6] * scale[i]
        found[w, h] = True
    if not found.all():
        w, h = (int(v) for v in np.argwhere(~found)[0])
        raise InputError(
            f"no mean drift at {database.omega[w]:.4g} rad/s, {np.rad2deg(database.headings[h]):g} deg",
            source=path,
            expected="every period with every heading",
        )
    return drift


def _read_restoring(path: Path, count: int) -> NDArray[np.float64]:
    """(N, 6, 6) from rows i, j, C; both halves are given, or the upper one."""
    whole = np.zeros((count, 6, 6))
    for values in _table(path, (3,)):
        i, j = int(values[0]) - 1, int(values[1]) - 1
        if not (0 <= i < 6 * count and 0 <= j < 6 * count):
            raise InputError(f"coefficient ({i + 1}, {j + 1})", source=path, expected=f"1 .. {6 * count}")
        if i // 6 == j // 6:
            whole[i // 6, i % 6, j % 6] = values[2]
    for matrix in whole:
        for i, j in ((2, 3), (2, 4), (3, 4)):
            if matrix[j, i] == 0.0:
                matrix[j, i] = matrix[i, j]
    return whole
