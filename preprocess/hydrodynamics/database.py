"""The hydrodynamic database of one hull or of several that interact: what it holds and what must be true.

Conventions. Axes of the database: z up, z = 0 the still water, x of the hull forward. A quantity
that oscillates is Re[X exp(-i omega t)]. A heading is the direction in which the wave TRAVELS, as an
angle from +x, anticlockwise seen from above. Coordinates of a body are surge, sway, heave, roll,
pitch, yaw about its reference point; those of N bodies follow each other, 6 N in all.

Source: Faltinsen, *Sea Loads on Ships and Offshore Structures* (1990), chapter 3; "Integrated
simulation ... ships and offshore structures" (2018), section 2.9.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = [
    "COORDINATES",
    "MIRROR_SIGNS",
    "PANEL_ACCURACY",
    "Fault",
    "HydrodynamicDatabase",
    "Limits",
    "at_frequencies",
    "check_axes",
    "check_bodies",
    "check_database",
    "check_phase",
    "check_shapes",
    "coordinate_name",
    "database_faults",
    "fault_error",
    "length_scales",
    "mass_scales",
    "over_full_circle",
    "wave_numbers",
]

COORDINATES = ("surge", "sway", "heave", "roll", "pitch", "yaw")

# what becomes of a force when the wave is mirrored about the plane y = 0 of a hull that has this symmetry
MIRROR_SIGNS = (1.0, -1.0, 1.0, -1.0, 1.0, -1.0)


class Limits(NamedTuple):
    """How far matrices may be from what they must be.

    Attributes
    ----------
    unsymmetric
        Difference of two entries that should be the same, as a share of the largest of all.
    negative
        Eigenvalue of damping below zero, as a share of the largest one.
    """

    unsymmetric: float
    negative: float


PANEL_ACCURACY = Limits(0.05, 0.02)
"""What no panel code needs: they are symmetric to about 1 %."""

DENSITIES = (100.0, 3000.0)
GRAVITIES = (5.0, 20.0)
ADDED_MASS_OF_DISPLACED = (0.01, 1000.0)
ROUND = 1e-9
LONG_WAVE = 1.5  # of k L, L the length of a bar that has the gyradius of the added mass
CLEARLY_IMAGINARY = 2.0


@dataclass(frozen=True, eq=False)
class HydrodynamicDatabase:
    """Frequency-domain coefficients of N hulls (n = 6 N coordinates), SI units.

    Attributes
    ----------
    bodies
        N names.
    omega
        (nw,) angular frequencies [rad/s], increasing, > 0, finite.
    headings
        (nh,) directions of propagation [rad], increasing, in the axes of the database.
    added_mass, damping
        (nw, 6N, 6N): row = coordinate of the force, column = coordinate of the motion
        [kg, kg m, kg m^2] and [kg/s, ...].
    added_mass_infinite
        (6N, 6N) limit for infinite frequency; NaN where a file has none, until `repairs.repaired` finds it.
    excitation
        (nw, nh, 6N) complex: force [N] or moment about the reference point [N m] per metre of wave
        amplitude; the phase is relative to a wave with its crest at the origin of the database at t = 0. A database
        of radiation alone has no headings, nh = 0: it serves motions in still water.
    reference_points
        (N, 3) [m] in the axes of the database.
    density, gravity, depth
        [kg/m^3], [m/s^2], [m] (``inf`` for deep water).
    source
        File or program from which the numbers come.
    symmetric
        True: hulls are symmetric about the plane y = 0 of the database, and headings within 0..pi stand
        for their mirror images too.
    drift
        (nw, nh, 6N) mean drift force per square of the amplitude [N/m^2, N/m], or None.
    volumes, centres_of_buoyancy
        (N,) [m^3] and (N, 3) [m] in the axes of the database, or None.
    hydrostatic_stiffness
        (N, 6, 6) about the reference points WITHOUT the terms of weight, or None: rho g times the integrals
        of the water plane, and rho g V (z_B - z_ref) in roll and pitch (the terms of weight,
        - m g (z_G - z_ref), come from the body itself).
    repairs
        Sentences about what was missing or wrong and has been repaired, see `repairs.repaired`.
    """

    bodies: tuple[str, ...]
    omega: NDArray[np.float64]
    headings: NDArray[np.float64]
    added_mass: NDArray[np.float64]
    damping: NDArray[np.float64]
    added_mass_infinite: NDArray[np.float64]
    excitation: NDArray[np.complex128]
    reference_points: NDArray[np.float64]
    density: float
    gravity: float
    depth: float
    source: str
    symmetric: bool = False
    drift: NDArray[np.float64] | None = None
    volumes: NDArray[np.float64] | None = None
    centres_of_buoyancy: NDArray[np.float64] | None = None
    hydrostatic_stiffness: NDArray[np.float64] | None = None
    repairs: tuple[str, ...] = ()

    @property
    def has_excitation(self) -> bool:
        """Whether it has exciting forces of waves, not radiation alone."""
        return len(self.headings) > 0

    @property
    def body_count(self) -> int:
        """Number of hulls, N."""
        return len(self.bodies)

    def body_index(self, name: str) -> int:
        """Place of the hull ``name``.

        Raises
        ------
        InputError
            There is no hull of this name.
        """
        if name not in self.bodies:
            raise InputError(
                f"no hull '{name}'",
                source=self.source,
                key="bodies",
                expected=f"one of {', '.join(self.bodies)}",
            )
        return self.bodies.index(name)

    def wave_numbers(self) -> NDArray[np.float64]:
        """(nw,) wave numbers [1/m] of the frequencies at this depth."""
        return wave_numbers(self.omega, self.gravity, self.depth)

    def excitation_at_reference_points(self) -> NDArray[np.complex128]:
        """(nw, nh, 6N) excitation whose phase is relative to a crest at the reference point of each hull.

        A crest at the origin at t = 0 is at the reference point x with the phase k . x: what is stored is
        X exp(i k . x), so this takes the factor away. What remains varies slowly with the heading.
        """
        k = self.wave_numbers()
        along = (
            np.stack([np.cos(self.headings), np.sin(self.headings)], axis=1) @ self.reference_points[:, :2].T
        )
        factor = np.exp(-1j * k[:, None, None] * along[None, :, :])
        return np.asarray(self.excitation * np.repeat(factor, 6, axis=2))


def wave_numbers(omega: NDArray[np.float64], gravity: float, depth: float) -> NDArray[np.float64]:
    """Wave numbers k [1/m] of omega^2 = g k tanh(k h), to the last digits.

    Newton from k0 / sqrt(tanh(k0 h)), k0 = omega^2 / g, which is within 5 % of the root at any depth
    (Eckart's approximation; Faltinsen, Sea Loads, table 2.1 for the relation itself).
    """
    deep = np.asarray(omega, dtype=np.float64) ** 2 / gravity
    if not np.isfinite(depth):
        return deep
    k = deep / np.sqrt(np.tanh(deep * depth))
    for _ in range(8):
        t = np.tanh(k * depth)
        k = k - (k * t - deep) / (t + k * depth * (1.0 - t * t))
    return k


def over_full_circle(database: HydrodynamicDatabase) -> HydrodynamicDatabase:
    """The same database with headings on the whole circle: those of 0..pi mirrored if it is symmetric.

    A database that already covers the circle is returned as it is (headings as given).
    """
    if not database.symmetric:
        return database
    signs = np.tile(MIRROR_SIGNS, database.body_count)
    inner = np.flatnonzero((database.headings > ROUND) & (database.headings < np.pi - ROUND))[::-1]
    headings = np.concatenate([database.headings, 2.0 * np.pi - database.headings[inner]])
    excitation = np.concatenate([database.excitation, database.excitation[:, inner] * signs], axis=1)
    drift = database.drift
    if drift is not None:
        drift = np.concatenate([drift, drift[:, inner] * signs], axis=1)
    return replace(database, headings=headings, excitation=excitation, drift=drift, symmetric=False)


def at_frequencies(
    database: HydrodynamicDatabase, at: NDArray[np.bool_] | NDArray[np.intp]
) -> HydrodynamicDatabase:
    """The same database at some of its frequencies: a mask, or their places."""
    return replace(
        database,
        omega=database.omega[at],
        added_mass=database.added_mass[at],
        damping=database.damping[at],
        excitation=database.excitation[at],
        drift=None if database.drift is None else database.drift[at],
    )


def length_scales(database: HydrodynamicDatabase) -> NDArray[np.float64]:
    """(6N,) factors that make rotations comparable with translations: 1 and 1 / (gyradius of added mass).

    Tolerances need one scale for kg, kg m and kg m^2; a length of the hull itself is the natural choice.
    """
    scales = np.ones(6 * database.body_count)
    infinite = np.diag(database.added_mass_infinite)
    if not np.isfinite(infinite).all():
        infinite = np.nanmean(np.diagonal(database.added_mass, axis1=1, axis2=2), axis=0)
    for body in range(database.body_count):
        diagonal = np.abs(infinite[6 * body : 6 * body + 6])
        translations, rotations = diagonal[:3].sum(), diagonal[3:].sum()
        if translations > 0.0 and rotations > 0.0:
            scales[6 * body + 3 : 6 * body + 6] = np.sqrt(translations / rotations)
    return scales


def check_database(database: HydrodynamicDatabase) -> None:
    """Refuse a database that cannot be right.

    Raises
    ------
    InputError
        The first of: shapes that do not fit, values that are not finite, frequencies or headings out of
        order, units that cannot be SI, reference points off the plane of symmetry, matrices that are not
        symmetric (5 % of the largest), a symmetry of the hulls that the matrices have not, damping that
        drives (an eigenvalue below -2 % of the largest).
    """
    check_shapes(database)
    _check_finite(database)
    check_axes(database)
    _check_units(database)
    faults = database_faults(database)
    if faults:
        raise fault_error(database, faults)
    scaling = np.outer(*[length_scales(database)] * 2)
    infinite = database.added_mass_infinite * scaling
    if database.symmetric:
        _check_mirror(database, np.concatenate([database.added_mass * scaling, infinite[None]]))
    lowest = np.linalg.eigvalsh(0.5 * (infinite + infinite.T))
    if lowest[0] < -PANEL_ACCURACY.negative * lowest[-1]:
        raise InputError(
            f"the smallest eigenvalue is {lowest[0] / lowest[-1]:.2%} of the largest",
            source=database.source,
            key="added_mass_infinite",
            expected="a positive definite matrix",
        )


def mass_scales(database: HydrodynamicDatabase) -> NDArray[np.float64]:
    """(6N,) masses and moments of inertia of the size of the hulls and the water with them [kg, kg m^2].

    That of the displaced water, if the database states its volume, and the largest added mass of the translations;
    rotations have it times the square of the gyradius of the added mass. An added mass of a coordinate, or what its
    damping does, is small if it is small against this.
    """
    diagonal = np.abs(np.diagonal(database.added_mass, axis1=1, axis2=2)).max(axis=0)
    mass = diagonal.reshape(-1, 6)[:, :3].max(axis=1)
    if database.volumes is not None:
        mass = mass + database.density * np.maximum(database.volumes, 0.0)
    return np.asarray(np.repeat(mass, 6) / length_scales(database) ** 2)


NO_LID = "no lid"
"""What the source of a database says that was computed without a lid."""


class Fault(NamedTuple):
    """What is wrong with a matrix at a frequency.

    Attributes
    ----------
    key
        ``added_mass``, ``added_mass_infinite`` or ``damping``.
    omega
        [rad/s]; infinite for the limit.
    entries
        Coordinates of a pair of entries that differ, or twice the one that moves most where damping drives.
    size
        Difference, or eigenvalue, as a share of the largest of all frequencies; negative where damping drives.
    """

    key: str
    omega: float
    entries: tuple[int, int]
    size: float

    def words(self, database: HydrodynamicDatabase) -> str:
        """For a person."""
        at = f"{self.omega:.4g} rad/s" if np.isfinite(self.omega) else "infinite frequency"
        names = [coordinate_name(database, i) for i in self.entries]
        if self.size < 0.0:
            return f"{at}: negative damping drives {names[0]}, {self.size:.1%} of the largest"
        return f"{at}: {self.key} of {names[0]} and {names[1]} differs by {self.size:.1%} of the largest"


def database_faults(database: HydrodynamicDatabase, limits: Limits = PANEL_ACCURACY) -> tuple[Fault, ...]:
    """Frequencies whose matrices are not symmetric or have damping that drives, beyond the limits; increasing."""
    scaling = np.outer(*[length_scales(database)] * 2)
    found: list[Fault] = []
    for key in ("added_mass_infinite", "added_mass", "damping"):
        values = getattr(database, key).reshape(-1, *scaling.shape) * scaling
        found += _unsymmetric(database, values, key, limits.unsymmetric)
    scaled = database.damping * scaling
    values, vectors = np.linalg.eigh(0.5 * (scaled + np.swapaxes(scaled, 1, 2)))
    largest = float(values.max())
    for w, lowest in enumerate(values[:, 0]):
        if lowest < -limits.negative * largest:
            i = int(np.argmax(np.abs(vectors[w, :, 0])))
            share = float(lowest) / largest if largest > 0.0 else -1.0
            found.append(Fault("damping", float(database.omega[w]), (i, i), share))
    return tuple(sorted(found, key=lambda fault: fault.omega))


def fault_error(
    database: HydrodynamicDatabase,
    faults: Sequence[Fault],
    limits: Limits = PANEL_ACCURACY,
    remedy: str = "",
) -> InputError:
    """The worst of several faults as an error, with a remedy: by default, what to compute instead."""
    worst = max(faults, key=lambda fault: abs(fault.size))
    remedy = remedy or _remedy(database)
    more = f" (the worst of {len(faults)} frequencies)" if len(faults) > 1 else ""
    wanted = (
        f"no damping below -{limits.negative:.0%}"
        if worst.size < 0.0
        else f"a symmetric matrix within {limits.unsymmetric:.0%}"
    )
    return InputError(
        worst.words(database) + more, source=database.source, key=worst.key, expected=f"{wanted}: {remedy}"
    )


def _remedy(database: HydrodynamicDatabase) -> str:
    """What to compute otherwise; a lid only where the source does not say that there was one."""
    panels = "finer panels, or without the frequencies at which the water between hulls resonates"
    if "lid" in database.source and NO_LID not in database.source:
        return panels
    return f"an irregular frequency, if it was computed without a lid on the water inside the hulls; else {panels}"


def check_phase(database: HydrodynamicDatabase) -> None:
    """Refuse excitation that is conjugated, or whose headings say where waves come from.

    In a wave long against the hull the horizontal force is the mass of the displaced water and the added mass
    times the acceleration of the water, -i omega^2 a in the direction of propagation: its imaginary part is
    negative in the convention exp(-i omega t). Where the longest wave is too short to tell, nothing is checked.

    Raises
    ------
    InputError
        The imaginary part is clearly positive.
    """
    if not database.has_excitation:
        return
    longest = float(database.wave_numbers()[0])
    smallest = float(length_scales(database).min())
    if not smallest > 0.0:  # moments of inertia beyond all numbers
        return
    gyradius = 1.0 / smallest
    if longest * gyradius * np.sqrt(12.0) > LONG_WAVE:
        return
    force = database.excitation_at_reference_points()[0]
    along = (
        np.cos(database.headings)[:, None] * force[:, 0::6]
        + np.sin(database.headings)[:, None] * force[:, 1::6]
    )
    total = complex(along.sum())
    if total.imag > CLEARLY_IMAGINARY * abs(total.real):
        raise InputError(
            f"in the longest wave, {2.0 * np.pi / longest:.3g} m, surge and sway are a quarter of a period from the "
            "acceleration of the water on the wrong side",
            source=database.source,
            key="excitation",
            expected="the time convention exp(-i omega t) and headings TOWARDS which waves travel (exp(+i omega t): "
            "conjugate; 'coming from': turn by 180 deg)",
        )


def check_shapes(database: HydrodynamicDatabase) -> None:
    """Arrays fit each other."""
    count, nw, nh = database.body_count, len(database.omega), len(database.headings)
    n = 6 * count
    wanted: dict[str, tuple[int, ...]] = {
        "omega": (nw,),
        "headings": (nh,),
        "added_mass": (nw, n, n),
        "damping": (nw, n, n),
        "added_mass_infinite": (n, n),
        "excitation": (nw, nh, n),
        "reference_points": (count, 3),
        "drift": (nw, nh, n),
        "volumes": (count,),
        "centres_of_buoyancy": (count, 3),
        "hydrostatic_stiffness": (count, 6, 6),
    }
    if count == 0 or nw == 0:
        raise InputError(
            f"{count} hulls, {nw} frequencies",
            source=database.source,
            expected="at least one of each",
        )
    if len(set(database.bodies)) != count:
        raise InputError(
            f"names {', '.join(database.bodies)}",
            source=database.source,
            key="bodies",
            expected="different names",
        )
    for key, shape in wanted.items():
        value = getattr(database, key)
        if value is not None and np.shape(value) != shape:
            raise InputError(
                f"shape {np.shape(value)}",
                source=database.source,
                key=key,
                expected=f"{shape} for {count} hulls, {nw} frequencies, {nh} headings",
            )


def check_bodies(database: HydrodynamicDatabase) -> None:
    """Every hull has an added mass at every frequency: what is cut, or of other hulls, leaves zeros.

    Raises
    ------
    InputError
        Names the hull and its coordinates, and a frequency if it has others.
    """
    for body, name in enumerate(database.bodies):
        own = slice(6 * body, 6 * body + 6)
        empty = ~np.any(database.added_mass[:, own, own] != 0.0, axis=(1, 2))
        if empty.any():
            at = "" if empty.all() else f" at {database.omega[empty][0]:.4g} rad/s"
            raise InputError(
                f"no added mass of {name!r}{at}, coordinates {6 * body + 1} to {6 * body + 6}",
                source=database.source,
                key="added_mass",
                expected="coefficients of every hull at every frequency (is the file cut, or of other hulls?)",
            )


def _check_finite(database: HydrodynamicDatabase) -> None:
    """Every number is a number: panel codes leave NaN where a problem failed."""
    for key in (
        "omega", "headings", "added_mass", "damping", "added_mass_infinite", "excitation", "reference_points",
        "drift", "volumes", "centres_of_buoyancy", "hydrostatic_stiffness",
    ):  # fmt: skip
        value = getattr(database, key)
        if value is not None and not np.all(np.isfinite(value)):
            bad = np.argwhere(~np.isfinite(value))[0]
            raise InputError(
                f"the entry {[int(i) for i in bad]} is {value[tuple(bad)]}",
                source=database.source,
                key=key,
                expected="finite numbers (a problem that failed leaves none: compute it again)",
            )


def check_axes(database: HydrodynamicDatabase) -> None:
    """Frequencies and headings are in order, and headings are angles in radians."""
    omega, headings = database.omega, database.headings
    if omega[0] <= 0.0 or np.any(np.diff(omega) <= 0.0):
        raise InputError(
            f"{omega[0]:g} .. {omega[-1]:g} rad/s is not increasing from above 0",
            source=database.source,
            key="omega",
            expected="frequencies [rad/s] in increasing order, none twice, without 0 and infinity",
        )
    if np.any(np.diff(headings) <= 0.0):
        raise InputError(
            "headings are not increasing",
            source=database.source,
            key="headings",
            expected="directions [rad] in increasing order, none twice",
        )
    if not database.has_excitation:
        return
    if headings[-1] - headings[0] > 2.0 * np.pi + 1e-6 or np.max(np.abs(headings)) > 2.0 * np.pi + 1e-6:
        raise InputError(
            f"{headings[0]:g} .. {headings[-1]:g}",
            source=database.source,
            key="headings",
            expected="radians, at most one turn (are these degrees?)",
        )
    if not database.symmetric:
        return
    if headings[0] < -1e-6 or headings[-1] > np.pi + 1e-6:
        raise InputError(
            f"{np.rad2deg(headings[0]):.0f} .. {np.rad2deg(headings[-1]):.0f} deg",
            source=database.source,
            key="headings",
            expected="0 .. 180 deg for hulls declared symmetric",
        )
    off = np.max(np.abs(database.reference_points[:, 1]))
    if off > 1e-6:
        raise InputError(
            f"a reference point is {off:g} m off the plane y = 0",
            source=database.source,
            key="reference_points",
            expected="points of that plane for hulls declared symmetric about it",
        )


def _check_units(database: HydrodynamicDatabase) -> None:
    """Orders of magnitude that only SI units have."""
    for key, value, (low, high) in (
        ("density", database.density, DENSITIES),
        ("gravity", database.gravity, GRAVITIES),
    ):
        if not low <= value <= high:
            unit = "kg/m^3" if key == "density" else "m/s^2"
            raise InputError(
                f"{value:g}", source=database.source, key=key, expected=f"{low:g} .. {high:g} {unit}"
            )
    if not database.depth > 0.0:
        raise InputError(
            f"{database.depth:g} m", source=database.source, key="depth", expected="> 0, inf for deep water"
        )
    if database.volumes is None:
        return
    for body, volume in enumerate(database.volumes):
        trace = float(
            np.trace(database.added_mass_infinite[6 * body : 6 * body + 3, 6 * body : 6 * body + 3])
        )
        low, high = ADDED_MASS_OF_DISPLACED
        if volume > 0.0 and not low <= trace / (database.density * volume) <= high:
            raise InputError(
                f"added mass of surge, sway and heave together is {trace:.3g} kg, displaced mass "
                f"{database.density * volume:.3g} kg",
                source=database.source,
                key="added_mass_infinite",
                expected=f"a ratio of {low:g} .. {high:g} (tonnes for kilograms?)",
            )


def _unsymmetric(
    database: HydrodynamicDatabase, scaled: NDArray[np.float64], key: str, limit: float
) -> list[Fault]:
    """The worst pair of entries of each matrix that is not its transpose (reciprocity)."""
    largest, found = float(np.max(np.abs(scaled))), []
    omega = [np.inf] if key == "added_mass_infinite" else database.omega
    for w, matrix in enumerate(scaled):
        difference = np.abs(matrix - matrix.T)
        i, j = (int(v) for v in np.unravel_index(int(np.argmax(difference)), difference.shape))
        if difference[i, j] > limit * largest:
            found.append(Fault(key, float(omega[w]), (i, j), float(difference[i, j] / largest)))
    return found


def coordinate_name(database: HydrodynamicDatabase, i: int) -> str:
    """Name of a coordinate, with that of the hull if there are several."""
    body = f"{database.bodies[i // 6]} " if database.body_count > 1 else ""
    return body + COORDINATES[i % 6]


def _check_mirror(database: HydrodynamicDatabase, scaled: NDArray[np.float64]) -> None:
    """Hulls symmetric about y = 0: surge, heave and pitch have no part in sway, roll and yaw."""
    signs = np.tile(MIRROR_SIGNS, database.body_count)
    crossing = np.abs(scaled) * (signs[:, None] != signs[None, :])
    largest = float(np.max(np.abs(scaled)))
    if crossing.max() > PANEL_ACCURACY.unsymmetric * largest:
        _, i, j = (int(v) for v in np.unravel_index(int(np.argmax(crossing)), crossing.shape))
        raise InputError(
            f"{COORDINATES[i % 6]} and {COORDINATES[j % 6]} are coupled, {crossing.max() / largest:.1%} of the largest",
            source=database.source,
            key="symmetric",
            expected="hulls symmetric about y = 0, or headings of the whole circle and no declared symmetry",
        )
