"""Hydrodynamic databases from WAMIT: its numeric files, .1, .3 and .hst (of other panel codes too), and its listing.

WAMIT's conventions, and what is done about them:

* numbers are made non-dimensional with density, gravity and a length L (``ULEN``): added mass A / (rho L^k),
  damping B / (rho omega L^k), excitation X / (rho g L^m), restoring C / (rho g L^k'), with k = 3, 4, 5 and
  k' = 2, 3, 4 for no, one, two rotations, and m = 2, 3 for forces and moments;
* time runs as exp(+i omega t): excitation is conjugated. The phase is relative to a crest at the global
  origin, and headings are directions of propagation: both are ours;
* forces and motions are about the origin of each body, which `XBODY` places: these are the reference points;
* period -1 (or any below 0) stands for zero frequency and 0 for infinite frequency, if there are any;
* coefficients that are zero by symmetry are left out;
* restoring coefficients of a free body contain its weight, m = rho V: the terms of weight are taken out.

Source: WAMIT User Manual, versions 7.2 and 7.4, chapters 3 (definitions) and 5 (output files: 5.1 of the listing, 5.2
and 5.6 of the numeric files).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.numerics.words import check_word
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
from heavylift.preprocess.hydrodynamics.repairs import repaired
from heavylift.preprocess.hydrodynamics.words import ExcitingForces, FirstColumn

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike, NDArray

    from heavylift.preprocess.hydrodynamics.repairs import Repair

__all__ = [
    "INFINITE_FREQUENCY",
    "ZERO_FREQUENCY",
    "WamitRows",
    "read_wamit",
    "read_wamit_out",
    "restoring_scale",
    "text_lines",
    "wamit_database",
    "without_weight",
]


INFINITE_FREQUENCY, ZERO_FREQUENCY = np.inf, 0.0

SAME_FREQUENCY = 1e-4
"""Of a frequency: files of one run are rounded differently."""


@dataclass
class WamitRows:
    """Non-dimensional coefficients as they are found: first by frequency, then by place."""

    added_mass: dict[float, dict[tuple[int, int], float]] = field(default_factory=dict)
    damping: dict[float, dict[tuple[int, int], float]] = field(default_factory=dict)
    excitation: dict[tuple[float, float], dict[int, complex]] = field(default_factory=dict)


def text_lines(path: Path) -> list[str]:
    """Lines of a text file."""
    if not path.is_file():
        raise InputError("no such file", source=path, expected="an output file of WAMIT")
    return path.read_text(encoding="utf-8", errors="replace").splitlines()


def restoring_scale(length: float) -> NDArray[np.float64]:
    """(6, 6) powers of the length that belong to rho g."""
    rotation = np.array([0, 0, 0, 1, 1, 1])
    return np.asarray(length ** (2.0 + rotation[:, None] + rotation[None, :]))


def without_weight(
    whole: NDArray[np.float64], weight: float, centre_of_gravity: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Restoring less the terms of weight: C44 and C55 have - m g z_G, C46 m g x_G, C56 m g y_G."""
    x, y, z = centre_of_gravity
    matrix = whole.copy()
    matrix[3, 3] += weight * z
    matrix[4, 4] += weight * z
    matrix[3, 5] -= weight * x
    matrix[4, 5] -= weight * y
    return matrix


def wamit_database(
    rows: WamitRows,
    *,
    source: str,
    references: NDArray[np.float64],
    names: tuple[str, ...],
    scales: tuple[float, float, float, float],
    symmetric: bool,
) -> HydrodynamicDatabase:
    """Arrays in SI units, frequencies and headings in increasing order, excitation conjugated.

    What is not there is NaN: excitation of a frequency or heading, the limit of infinite frequency.
    """
    length, density, gravity, depth = scales
    count = len(references)
    n = 6 * count
    omega = np.array(sorted(w for w in rows.added_mass if 0.0 < w < np.inf))
    if not len(omega):
        raise InputError(
            "no added mass and damping at finite frequencies",
            source=source,
            expected="a run with several periods",
        )
    degrees = sorted({heading for w, heading in rows.excitation if 0.0 < w < np.inf})
    waves = np.array(sorted({w for w, _ in rows.excitation if 0.0 < w < np.inf}))
    kinds = (np.arange(n) % 6 >= 3).astype(int)
    mass_scale = density * length ** (3.0 + kinds[:, None] + kinds[None, :])
    force_scale = density * gravity * length ** (2.0 + kinds)
    mass, damping = np.zeros((len(omega), n, n)), np.zeros((len(omega), n, n))
    for index, w in enumerate(omega):
        mass[index] = _matrix(rows.added_mass[float(w)], n, source) * mass_scale
        damping[index] = _matrix(rows.damping[float(w)], n, source) * mass_scale * w
    excitation = np.full((len(omega), len(degrees), n), np.nan, dtype=np.complex128)
    for index, w in enumerate(omega):
        near = waves[np.abs(waves - w) < SAME_FREQUENCY * w]
        for h, heading in enumerate(degrees):
            values = rows.excitation.get((float(near[0]), heading)) if len(near) else None
            if values is None:
                continue
            excitation[index, h] = 0.0
            for i, value in values.items():
                if i >= n:
                    raise InputError(f"mode {i + 1}", source=source, expected=f"1 .. {n} for {count} bodies")
                excitation[index, h, i] = value.conjugate() * force_scale[i]
    infinite = np.full((n, n), np.nan)
    if INFINITE_FREQUENCY in rows.added_mass:
        infinite = _matrix(rows.added_mass[INFINITE_FREQUENCY], n, source) * mass_scale
    if names and len(names) != count:
        raise InputError(f"{len(names)} names", source=source, key="bodies", expected=f"{count}")
    return HydrodynamicDatabase(
        bodies=names or tuple(f"body{i + 1}" for i in range(count)),
        omega=omega,
        headings=np.deg2rad(degrees),
        added_mass=mass,
        damping=damping,
        added_mass_infinite=infinite,
        excitation=excitation,
        reference_points=references,
        density=density,
        gravity=gravity,
        depth=depth,
        source=source,
        symmetric=symmetric,
    )


def _matrix(entries: dict[tuple[int, int], float], n: int, source: str) -> NDArray[np.float64]:
    """A full matrix of the entries that are not zero by symmetry."""
    matrix = np.zeros((n, n))
    for (i, j), value in entries.items():
        if not (0 <= i < n and 0 <= j < n):
            raise InputError(f"coefficient ({i + 1}, {j + 1})", source=source, expected=f"1 .. {n}")
        matrix[i, j] = value
    return matrix


# ---- numeric files ----


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
    first_column: FirstColumn = "period",
    symmetric: bool = False,
    repair: Repair | None = None,
) -> HydrodynamicDatabase:
    """Read the numeric files ``path.1`` and, if they are there, ``path.3``, ``path.hst`` and ``path.9`` or ``path.8``.

    Without ``path.3`` there are no exciting forces: such a database serves motions in still water.
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
        See `words.FirstColumn`.
    symmetric
        Hulls are symmetric about y = 0 and headings cover 0..180 deg only.
    repair
        What may be repaired.

    Raises
    ------
    InputError
        A file is missing or not as WAMIT writes it, volumes needed and not given, or what `repaired` refuses.
    """
    base = Path(path)
    if base.suffix in {".1", ".3", ".8", ".9", ".hst"}:
        base = base.with_suffix("")
    check_word(first_column, FirstColumn, source=base, key="first_column")
    rows = WamitRows()
    _read_radiation(base.with_name(base.name + ".1"), rows, first_column)
    forces = base.with_name(base.name + ".3")
    if forces.is_file():
        _read_excitation(forces, rows, first_column)
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
    return repaired(database, repair)


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


def _frequency(value: float, first_column: FirstColumn) -> float:
    """Angular frequency [rad/s] of the first column."""
    if first_column == "frequency":
        return INFINITE_FREQUENCY if value < 0.0 else value
    if value < 0.0:
        return ZERO_FREQUENCY
    return INFINITE_FREQUENCY if value == 0.0 else 2.0 * np.pi / value


def _read_radiation(path: Path, rows: WamitRows, first_column: FirstColumn) -> None:
    """Period, i, j, A, and B where the frequency is neither zero nor infinite."""
    for values in _table(path, (4, 5)):
        omega = _frequency(values[0], first_column)
        place = (int(values[1]) - 1, int(values[2]) - 1)
        rows.added_mass.setdefault(omega, {})[place] = values[3]
        rows.damping.setdefault(omega, {})[place] = values[4] if len(values) == 5 else 0.0


def _read_excitation(path: Path, rows: WamitRows, first_column: FirstColumn) -> None:
    """Period, heading [deg], i, modulus, phase [deg], real and imaginary part."""
    for values in _table(path, (7,)):
        key = (_frequency(values[0], first_column), values[1])
        rows.excitation.setdefault(key, {})[abs(int(values[2])) - 1] = complex(values[5], values[6])


def _drift(
    base: Path, database: HydrodynamicDatabase, length: float, first_column: FirstColumn
) -> NDArray[np.float64] | None:
    """(nw, nh, 6N) mean drift per square of the amplitude: F / (rho g L), M / (rho g L^2); None without a file."""
    if not database.has_excitation:
        return None
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


# ---- the listing ----


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
    forces: ExcitingForces = "diffraction",
    repair: Repair | None = None,
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
        See `words.ExcitingForces`.
    repair
        What may be repaired.

    Raises
    ------
    InputError
        Not such a listing, a body turned in the plane (`PHIBODY`), another density, or what `repaired` refuses.
    """
    path = Path(path)
    check_word(forces, ExcitingForces, source=path, key="forces")
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
    return repaired(database, repair)


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
