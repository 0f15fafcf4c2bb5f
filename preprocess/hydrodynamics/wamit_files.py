"""Hydrodynamic databases from WAMIT: its numeric files, .1, .3 and .hst (of other panel codes too), and its listing.

WAMIT's conventions, and what is done about them:

* numbers are made non-dimensional with density, gravity and a length L (``ULEN``): added mass A / (rho L^k),
  damping B / (rho omega L^k), excitation X / (rho g L^m), restoring C / (rho g L^k'), with k = 3, 4, 5 and
  k' = 2, 3, 4 for no, one, two rotations, and m = 2, 3 for forces and moments;
* time runs as exp(+i omega t): excitation is conjugated. The phase is relative to a crest at the global
  origin, and headings are directions of propagation: both are ours;
* forces and motions are about the origin of each body, which `XBODY` places: these are the reference points;
* period -1 (or any below 0) stands for zero frequency and 0 for infinite frequency, if there are any;
* coefficients that are zero by symmetry are left out, the same at every period: what is there at one period and not at
  another is a file that was cut;
* restoring coefficients of a free body contain its weight, m = rho V: the terms of weight are taken out.

Source: WAMIT User Manual, versions 7.2 and 7.4, chapters 3 (definitions) and 5 (output files: 5.1 of the listing, 5.2
and 5.6 of the numeric files).
"""

from __future__ import annotations

import re
from dataclasses import field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.words import check_word
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
from heavylift.preprocess.hydrodynamics.repairs import repaired
from heavylift.preprocess.hydrodynamics.words import ExcitingForces, FirstColumn

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

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

SAME_VALUE = 1e-5
"""Of two values of the same coefficient, and of the modulus to the largest of all: digits of a file."""

COMPARED = 200
"""Rows of a table that the last one is compared with."""

FORMATTED = 3
"""Rows of one length that tell that numbers are written in one format."""

MODULUS = 0.01
"""Between a modulus and that of real and imaginary part."""


@dataclass
class WamitRows:
    """Non-dimensional coefficients as they are found: first by frequency, then by place."""

    source: Path
    added_mass: dict[float, dict[tuple[int, int], float]] = field(default_factory=dict)
    damping: dict[float, dict[tuple[int, int], float]] = field(default_factory=dict)
    excitation: dict[tuple[float, float], dict[int, complex]] = field(default_factory=dict)

    def add_radiation(self, omega: float, values: Sequence[float], path: Path, line: int) -> None:
        """A row of i, j, A, and B unless the frequency is zero or infinite."""
        at_wave = 0.0 < omega < np.inf
        if at_wave and len(values) != 4:
            raise _cut(path, line, "no damping at a finite period")
        place = (_mode(values[0], path, line), _mode(values[1], path, line))
        pairs = [(self.added_mass, values[2]), (self.damping, values[3] if len(values) == 4 else 0.0)]
        for table, value in pairs:
            _put(table.setdefault(omega, {}), place, value, path, line)

    def add_force(
        self, omega: float, heading: float, i: float, value: complex, path: Path, line: int
    ) -> None:
        """Force or moment i of a wave."""
        mode = _mode(abs(i), path, line)
        _put(self.excitation.setdefault((omega, heading), {}), mode, value, path, line)

    def check(self) -> None:
        """Refuse what is there at one frequency and not at another.

        Raises
        ------
        InputError
            Names frequency and coefficient.
        """
        waves = [w for w in self.added_mass if 0.0 < w < np.inf]
        union = set().union(*(self.added_mass[w].keys() for w in waves))
        diagonal = {place for place in union if place[0] == place[1]}
        for omega, entries in self.added_mass.items():
            whole = 0.0 < omega < np.inf or any(
                i != j for i, j in entries
            )  # limits are known by diagonals too
            lacking = (union if whole else diagonal) - entries.keys()
            if lacking:
                i, j = min(lacking)
                raise _incomplete(self.source, omega, f"no coefficient ({i + 1}, {j + 1})", len(lacking))
        forces = set().union(*(entries.keys() for entries in self.excitation.values()))
        for (omega, heading), found in self.excitation.items():
            missing = forces - found.keys()
            if missing:
                raise _incomplete(
                    self.source,
                    omega,
                    f"no force {min(missing) + 1} of the heading {heading:g} deg",
                    len(missing),
                )
        known = np.array(sorted(waves))
        close = np.flatnonzero(np.diff(known) < SAME_FREQUENCY * known[1:])
        if len(close):
            low, high = known[close[0]], known[close[0] + 1]
            raise InputError(
                f"periods {2.0 * np.pi / high:.8g} and {2.0 * np.pi / low:.8g} s are as good as the same",
                source=self.source,
                expected="each period once (are these two runs in one file?)",
            )


def _mode(value: float, path: Path, line: int) -> int:
    """Number of a coordinate, from 0."""
    if value != int(value) or value < 1:
        raise InputError(
            f"mode {value:g}", source=path, key=f"line {line}", expected="a whole number from 1 on"
        )
    return int(value) - 1


def _put(table: dict[Any, Any], place: Any, value: complex, path: Path, line: int) -> None:
    """A coefficient, once; the same again may follow."""
    before = table.setdefault(place, value)
    if abs(before - value) > SAME_VALUE * max(abs(before), abs(value)):
        words = [f"{one:.6g}" for one in (before, value)]
        raise InputError(
            f"{words[1]} where the same coefficient was {words[0]} before",
            source=path,
            key=f"line {line}",
            expected="each period, heading and mode once (are these two runs in one file?)",
        )


def _cut(path: Path, line: int, problem: str) -> InputError:
    return InputError(
        problem, source=path, key=f"line {line}", expected="a whole row (is the file cut there?)"
    )


def _incomplete(path: Path, omega: float, problem: str, count: int) -> InputError:
    period = {0.0: "infinite", np.inf: "zero"}.get(omega) or f"{2.0 * np.pi / omega:.6g} s"
    more = f", and {count - 1} more" if count > 1 else ""
    return InputError(
        f"period {period}: {problem}{more}, which other periods have",
        source=path,
        expected="the same coefficients at every period (is the file cut there?)",
    )


def _refuse_short(rows: Sequence[tuple[int, str]], path: Path, *, ended: bool) -> None:
    """Refuse a last row whose last number has lost digits.

    Parameters
    ----------
    rows
        Number and text of the rows of a table with as many numbers as the last one.
    path
        The file.
    ended
        Whether the last row ends with its line. If not, it must not be the shortest; if so, rows or numbers that are
        all of one length tell.
    """
    *others, (number, last) = rows
    if not others:
        return
    lengths = {len(text.rstrip()) for _, text in others}
    digits = {len(text.split()[-1].lstrip("-+")) for _, text in others}
    short = len(last.rstrip()) < min(lengths) and (not ended or len(lengths) == 1)
    cut = len(digits) == 1 and len(last.split()[-1].lstrip("-+")) < min(digits)
    if (short or cut) and (not ended or len(others) >= FORMATTED):
        raise _cut(path, number, f"{last.strip()!r} is shorter than the rows before")


def text_lines(path: Path) -> list[str]:
    """Lines of a text file, an empty one last if it ends with a line."""
    if not path.is_file():
        raise InputError("no such file", source=path, expected="an output file of WAMIT")
    return path.read_text(encoding="utf-8", errors="replace").replace("\r\n", "\n").split("\n")


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
    rows.check()
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
    alone = [w for w in waves if not np.any(np.abs(omega - w) < SAME_FREQUENCY * w)]
    remarks: tuple[str, ...] = ()
    if alone:
        span = f"{min(alone):.4g} to {max(alone):.4g} rad/s"
        remarks = (
            f"exciting forces at {len(alone)} frequencies without radiation ({span}) left out: is it cut?",
        )
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
        repairs=remarks,
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
    rows = WamitRows(base)
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


def _table(path: Path, columns: tuple[int, ...]) -> Iterator[tuple[int, list[float]]]:
    """Numbers of lines with their rows of numbers; a first line of words is passed over."""
    lines = text_lines(path)
    _refuse_cut(lines, path)
    for number, line in enumerate(lines, start=1):
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
        yield number, values


def _refuse_cut(lines: Sequence[str], path: Path, pattern: str = "") -> None:
    """Refuse a file whose last row is cut within its last number; of a listing, rows that fit a pattern."""
    last = max((i for i, line in enumerate(lines) if line.strip()), default=-1)
    if last < 0 or not re.match(pattern, lines[last]):
        return
    width = len(lines[last].split())
    rows: list[tuple[int, str]] = []
    for i in range(last, max(last - COMPARED, -1), -1):  # rows of another table end it
        line = lines[i]
        if len(line.split()) != width or not re.match(pattern, line) or not _are_numbers(line):
            break
        rows.insert(0, (i + 1, line))
    if rows:
        _refuse_short(rows, path, ended=last < len(lines) - 1)


def _are_numbers(line: str) -> bool:
    return not re.search(r"[^-+.\deEdD\s]", line)


def _frequency(value: float, first_column: FirstColumn) -> float:
    """Angular frequency [rad/s] of the first column."""
    if first_column == "frequency":
        return INFINITE_FREQUENCY if value < 0.0 else value
    if value < 0.0:
        return ZERO_FREQUENCY
    return INFINITE_FREQUENCY if value == 0.0 else 2.0 * np.pi / value


def _read_radiation(path: Path, rows: WamitRows, first_column: FirstColumn) -> None:
    """Period, i, j, A, and B where the frequency is neither zero nor infinite."""
    for line, values in _table(path, (4, 5)):
        rows.add_radiation(_frequency(values[0], first_column), values[1:], path, line)


def _read_excitation(path: Path, rows: WamitRows, first_column: FirstColumn) -> None:
    """Period, heading [deg], i, modulus, phase [deg], real and imaginary part."""
    table = list(_table(path, (7,)))
    _check_moduli([(line, values[3], complex(*values[5:])) for line, values in table], path)
    for line, values in table:
        omega = _frequency(values[0], first_column)
        rows.add_force(omega, values[1], values[2], complex(*values[5:]), path, line)


def _check_moduli(rows: Sequence[tuple[int, float, complex]], path: Path) -> None:
    """Refuse rows whose modulus is not that of real and imaginary part."""
    largest = max((modulus for _, modulus, _ in rows), default=0.0)
    for line, modulus, value in rows:
        if abs(abs(value) - modulus) > MODULUS * modulus + SAME_VALUE * largest:
            raise InputError(
                f"modulus {modulus:.6g} of {value.real:.6g} and {value.imag:.6g}",
                source=path,
                key=f"line {line}",
                expected="real and imaginary part that belong to it (is a number cut, or in another column?)",
            )


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
    table = list(_table(path, (8,)))
    _check_moduli([(line, abs(values[4]), complex(*values[6:])) for line, values in table], path)
    entries: dict[tuple[float, float], dict[int, complex]] = {}
    for line, values in table:
        if values[1] != values[2]:
            continue
        omega, i = _frequency(values[0], first_column), _mode(abs(values[3]), path, line)
        _put(entries.setdefault((omega, values[1]), {}), i, values[6], path, line)
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
    modes = set().union(*(own.keys() for own in entries.values()))
    for (omega, heading), own in entries.items():
        if modes - own.keys():
            missing = modes - own.keys()
            problem = f"no mean drift {min(missing) + 1} of the heading {heading:g} deg"
            raise _incomplete(path, omega, problem, len(missing))
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
    entries: dict[tuple[int, int], complex] = {}
    for line, values in _table(path, (3,)):
        i, j = _mode(values[0], path, line), _mode(values[1], path, line)
        _put(entries, (i, j), values[2], path, line)
        if not (0 <= i < 6 * count and 0 <= j < 6 * count):
            raise InputError(f"coefficient ({i + 1}, {j + 1})", source=path, expected=f"1 .. {6 * count}")
        if i // 6 == j // 6:
            whole[i // 6, i % 6, j % 6] = values[2]
    _check_restoring(entries, count, path)
    for matrix in whole:
        for i, j in ((2, 3), (2, 4), (3, 4)):
            if matrix[j, i] == 0.0:
                matrix[j, i] = matrix[i, j]
    return whole


def _check_restoring(entries: Mapping[tuple[int, int], complex], count: int, path: Path) -> None:
    """Refuse a table that ends early: without diagonals, without the rest of a half, or with halves that differ."""
    lacking = [6 * b + i for b in range(count) for i in (2, 3, 4) if (6 * b + i, 6 * b + i) not in entries]
    both = {(i, j) for i, j in entries if i != j and (j, i) in entries}
    if len(both) > 2 * HALVES * count:  # a table of all: each entry has its counterpart
        lacking += [j for i, j in entries if (j, i) not in entries]
    if lacking:
        raise InputError(
            f"{len(entries)} coefficients, without those of mode {min(lacking) + 1}",
            source=path,
            expected="restoring coefficients of all modes (is the file cut?)",
        )
    largest = max((abs(value) for value in entries.values()), default=0.0)
    for i, j in both:
        of_water = max(i % 6, j % 6) < 5
        if of_water and abs(entries[i, j] - entries[j, i]) > MODULUS * largest:
            raise InputError(
                f"C({i + 1},{j + 1}) is {entries[i, j]:.6g}, C({j + 1},{i + 1}) {entries[j, i]:.6g}",
                source=path,
                expected="a symmetric table (is a number cut?)",
            )


HALVES = 3
"""Couplings of heave, roll and pitch of a body: more that are given twice are a table of all entries."""


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
        Of the water [kg/m^3]; compared with the listing where that states one in these units (1 is none).
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
    if sum("Gravity:" in line for line in lines) > 1:
        raise InputError(
            "two listings in one file", source=path, expected="the listing of one run, in a file of its own"
        )
    _refuse_cut(lines, path, r"\s*-?\d+\s+[-+.\d]")
    gravity, length, depth = _stated_scales(lines, path, density)
    listed = list(_listed_bodies(lines, path))
    if not listed:
        raise InputError("no body (XBODY)", source=path, expected="a listing of WAMIT")
    rows = WamitRows(path)
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
    begun = sum(bool(_BEGUN.match(line)) for line in lines)
    there = len(rows.added_mass)
    remarks = (f"the listing begins with {begun} periods and has {there} of them",) if there < begun else ()
    database = replace(
        database,
        repairs=(*database.repairs, *remarks),
        volumes=np.array([body.volume for body in listed]),
        centres_of_buoyancy=np.array([body.centre_of_buoyancy for body in listed]) + references,
        hydrostatic_stiffness=np.array(stiffness),
    )
    return repaired(database, repair)


_BEGUN = re.compile(r"\s*-?\d+\.\d+\s+\d\d:\d\d:\d\d\s")
"""Rows of a listing, a period and the time at which it was begun."""


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
    # its numbers have no dimension: without a density WAMIT writes 1, and others write tonnes
    scaled = stated is not None and min(abs(stated - 1.0), abs(stated - 1e-3 * density)) < 1e-3
    if stated is not None and not scaled and abs(stated - density) > 1e-3 * density:
        raise InputError(
            f"{density:g} kg/m^3", source=path, key="density", expected=f"what the listing states, {stated:g}"
        )
    return gravity, length, depth


def _numbers(line: str, count: int, path: Path, number: int) -> list[float]:
    """So many numbers after the last colon of a line."""
    try:
        found = [float(v) for v in line.rsplit(":", 1)[-1].split()]
    except ValueError:
        found = []
    if len(found) != count:
        raise _cut(path, number, f"{line.strip()!r}, where {count} numbers should be")
    return found


def _listed_bodies(lines: list[str], path: Path) -> Iterator[_Body]:
    """Bodies in the order of the listing."""
    starts = [i for i, line in enumerate(lines) if "XBODY" in line and "PHIBODY" in line]
    for start, end in zip(starts, [*starts, len(lines)][1:], strict=True):
        placed = re.findall(r"=\s*([-+.\dEe]+)", lines[start])
        if len(placed) != 4:
            raise _cut(path, start + 1, f"{lines[start].strip()!r}, where 4 numbers should be")
        x, y, z, turn = map(float, placed)
        if turn != 0.0:
            raise InputError(
                f"PHIBODY = {turn:g} deg",
                source=path,
                key=f"line {start + 1}",
                expected="bodies along the global axes",
            )
        volume, buoyancy, gravity_centre = 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        restoring = np.zeros((6, 6))
        found: set[str] = set()
        for number, line in enumerate(lines[start + 1 : min(end, start + 40)], start=start + 2):
            if "Wave period" in line:
                break
            if "Volumes (" in line:
                volume = float(np.median(_numbers(line, 3, path, number)))
                found.add("volumes")
            elif "Center of Buoyancy" in line:
                buoyancy = _point(line, path, number)
            elif "Center of Gravity" in line:
                gravity_centre = _point(line, path, number)
                found.add("centre of gravity")
            elif re.search(r"C\(\d,\d\)", line):
                places = re.findall(r"C\((\d),(\d)\)", line)
                found |= {f"C({i},{j})" for i, j in places}
                for (i, j), value in zip(places, _numbers(line, len(places), path, number), strict=True):
                    restoring[int(i) - 1, int(j) - 1] = value
        lacking = [
            word
            for word in ("volumes", "C(3,3)", "C(4,4)", "C(5,5)", "centre of gravity")
            if word not in found
        ]
        if lacking:
            raise InputError(
                f"no {', '.join(lacking)} of the body",
                source=path,
                key=f"line {start + 1}",
                expected="volumes, restoring coefficients and centre of gravity (is the file cut?)",
            )
        for i, j in ((2, 3), (2, 4), (3, 4)):
            restoring[j, i] = restoring[i, j]
        yield _Body((x, y, z), volume, buoyancy, gravity_centre, restoring)


def _point(line: str, path: Path, number: int) -> tuple[float, float, float]:
    """Three coordinates."""
    x, y, z = _numbers(line, 3, path, number)
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
        elif "EXCITING FORCES AND MOMENTS" in line:
            table = "excitation" if forces.upper() in line else ""
        elif "Wave Heading (deg)" in line:
            heading = _numbers(line, 1, path, number)[0]
        elif re.match(r"\s*[A-Z]{4,}[ \-]", line):
            table = ""
        elif table and re.match(r"\s*-?\d+\s", line):
            values = _row(line, path, number)
            if table == "radiation" and len(values) in {3, 4}:
                rows.add_radiation(omega, values, path, number)
            elif table == "excitation" and len(values) == 3:
                turned = values[1] * np.exp(1j * np.deg2rad(values[2]))
                rows.add_force(omega, heading, values[0], complex(turned), path, number)
            else:
                raise _cut(path, number, f"{len(values)} numbers: {line.strip()!r}")


def _row(line: str, path: Path, number: int) -> list[float]:
    """Numbers of one row of a table."""
    try:
        return [float(part) for part in line.split()]
    except ValueError:
        raise InputError(repr(line.strip()), source=path, key=f"line {number}", expected="numbers") from None
