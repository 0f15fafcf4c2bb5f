"""Motions of moored hulls in the frequency domain: response operators, response spectra, natural periods.

    [-omega^2 (M + A(omega)) - i omega (B(omega) + B_extra) + C] xi = X(omega, beta)

for groups of N hulls, 6 N coordinates about their reference points, time factor exp(-i omega t). Joints between hulls
are linear constraints ``G xi = 0`` with Lagrange multipliers. Source: Faltinsen, *Sea Loads on Ships and Offshore
Structures* (1990), chapter 3.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
from heavylift.solver.water.waves.spectra import dispersion
from heavylift.solver.water.waves.wave_transfer import excitation_at

__all__ = [
    "LinearHulls",
    "MotionOperators",
    "NaturalMode",
    "ResponseStatistics",
    "linear_hulls",
    "motion_operators",
    "natural_modes",
    "resonant_frequencies",
    "rigid_body_mass",
]


NO_STIFFNESS = 1e-9
"""Of the largest eigenvalue: a mode with less is none."""

PIECES = 40
"""Between two frequencies of a database, in which modes are looked for where they have no order."""


@dataclass(frozen=True, eq=False)
class LinearHulls:
    """A group of hulls with linear coefficients.

    Attributes
    ----------
    database
        Added mass, damping and excitation.
    mass
        Of the bodies about their reference points, shape (6N, 6N).
    stiffness
        Hydrostatic with the terms of weight, plus moorings: shape (6N, 6N).
    damping
        Beside the wave damping, shape (6N, 6N).
    constraint_jacobian
        Rows G of ``G xi = 0``, shape (c, 6N); c may be zero.
    """

    database: HydrodynamicDatabase
    mass: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    damping: NDArray[np.float64]
    constraint_jacobian: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class MotionOperators:
    """Response amplitude operators.

    Attributes
    ----------
    omega
        [rad/s], shape (nw,).
    headings
        Directions of propagation relative to the hulls [rad], shape (nh,).
    motion
        Complex motion per metre of wave amplitude [m/m, rad/m], shape (nw, nh, 6N); phases are relative to a crest at
        the reference point of the first hull.
    constraint_force
        Lagrange multipliers per metre of wave amplitude, shape (nw, nh, c): ``G^T lambda`` acts on the hulls.
    bodies
        N names.
    """

    omega: NDArray[np.float64]
    headings: NDArray[np.float64]
    motion: NDArray[np.complex128]
    constraint_force: NDArray[np.complex128]
    bodies: tuple[str, ...]

    @property
    def amplitude(self) -> NDArray[np.float64]:
        """Magnitude [m/m, rad/m], shape (nw, nh, 6N)."""
        return np.abs(self.motion)

    @property
    def phase(self) -> NDArray[np.float64]:
        """Lag behind the crest [rad], -pi to pi: the motion is ``amplitude cos(omega t - phase)``.

        With the time factor exp(-i omega t) this is the angle of the complex number.
        """
        return np.angle(self.motion)


@dataclass(frozen=True, eq=False)
class NaturalMode:
    """An undamped free oscillation.

    Attributes
    ----------
    period
        [s].
    shape
        Amplitudes of the coordinates, the largest scaled to one after weighing by mass; shape (6N,).
    coordinate
        Index of that coordinate.
    """

    period: float
    shape: NDArray[np.float64]
    coordinate: int


@dataclass(frozen=True, eq=False)
class ResponseStatistics:
    """Response to an irregular sea, one value a coordinate, shape (6N,).

    Attributes
    ----------
    omega
        Grid of the spectra [rad/s], shape (k,).
    density
        Response spectra S |RAO|^2 [m^2 s/rad, rad^2 s/rad], shape (k, 6N).
    standard_deviation
        [m, rad].
    significant
        Mean of the highest third of the amplitudes, twice the standard deviation [m, rad].
    mean_period
        2 pi sqrt(m0 / m2) [s], between upcrossings of zero.
    """

    omega: NDArray[np.float64]
    density: NDArray[np.float64]
    standard_deviation: NDArray[np.float64]
    significant: NDArray[np.float64]
    mean_period: NDArray[np.float64]


def rigid_body_mass(mass: float, centre: ArrayLike, inertia: ArrayLike) -> NDArray[np.float64]:
    """Mass matrix of a rigid body about a reference point.

    Parameters
    ----------
    mass
        [kg].
    centre
        Centre of gravity from the reference point [m], shape (3,).
    inertia
        About the centre of gravity [kg m^2], shape (3, 3).

    Returns
    -------
    NDArray
        Shape (6, 6).
    """
    x, y, z = np.asarray(centre, dtype=np.float64)
    S = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    matrix = np.zeros((6, 6))
    matrix[:3, :3] = mass * np.eye(3)
    matrix[:3, 3:] = -mass * S
    matrix[3:, :3] = mass * S
    matrix[3:, 3:] = np.asarray(inertia, dtype=np.float64) - mass * S @ S
    return matrix


def linear_hulls(
    database: HydrodynamicDatabase,
    mass: ArrayLike,
    stiffness: ArrayLike,
    *,
    damping: ArrayLike | None = None,
    constraint_jacobian: ArrayLike | None = None,
) -> LinearHulls:
    """Check and gather the matrices of a group; see `LinearHulls`.

    Raises
    ------
    InputError
        If a shape does not fit, a value is not finite, the mass is not positive definite or constraints repeat.
    """
    n = 6 * database.body_count
    G = np.zeros((0, n)) if constraint_jacobian is None else np.asarray(constraint_jacobian, dtype=np.float64)
    arrays = {
        "mass": np.asarray(mass, dtype=np.float64),
        "stiffness": np.asarray(stiffness, dtype=np.float64),
        "damping": np.zeros((n, n)) if damping is None else np.asarray(damping, dtype=np.float64),
    }
    for key, value in arrays.items():
        if value.shape != (n, n) or not np.all(np.isfinite(value)):
            raise InputError(f"shape {value.shape} or a value that is not finite", source=database.source, key=key,
                             expected=f"({n}, {n}), finite")  # fmt: skip
    if np.min(np.linalg.eigvalsh(0.5 * (arrays["mass"] + arrays["mass"].T))) <= 0.0:
        raise InputError("the mass matrix is not positive definite", source=database.source, key="mass",
                         expected="masses and moments of inertia > 0")  # fmt: skip
    if G.ndim != 2 or G.shape[1] != n or (len(G) and np.linalg.matrix_rank(G) < len(G)):
        raise InputError(f"constraint rows of shape {G.shape}, rank {np.linalg.matrix_rank(G) if G.size else 0}",
                         source=database.source, key="constraint_jacobian",
                         expected=f"independent rows of {n} columns")  # fmt: skip
    return LinearHulls(database, arrays["mass"], arrays["stiffness"], arrays["damping"], G)


def motion_operators(
    hulls: LinearHulls, *, headings: ArrayLike, omega: ArrayLike | None = None
) -> MotionOperators:
    """Solve for the motion in waves of one metre amplitude.

    Parameters
    ----------
    hulls
        Group.
    headings
        Directions of propagation relative to the hulls [rad], shape (nh,); none of a database of radiation alone.
    omega
        Frequencies [rad/s] within the database, by default its own; coefficients between them by cubic splines.

    Raises
    ------
    InputError
        If a frequency or heading is outside the database, or a response is infinite.

    Notes
    -----
    With joints the system is ``[Z, -G^T; G, 0] [xi; lambda] = [X; 0]``; rows and columns are scaled before the
    solution, because newtons and newton metres differ by orders of magnitude.
    """
    database = hulls.database
    w = database.omega if omega is None else np.atleast_1d(np.asarray(omega, dtype=np.float64))
    beta = np.atleast_1d(np.asarray(headings, dtype=np.float64))
    n, c = 6 * database.body_count, len(hulls.constraint_jacobian)
    A, B = _over_frequency(database, database.added_mass, w), _over_frequency(database, database.damping, w)
    Z = (
        -(w**2)[:, None, None] * (hulls.mass + A)
        - 1j * w[:, None, None] * (B + hulls.damping)
        + hulls.stiffness
    )
    X = np.zeros((len(w), n, len(beta)), dtype=np.complex128)
    for h, one in enumerate(beta):
        X[:, :, h] = _group_excitation(database, w, float(one))
    scale = 1.0 / np.sqrt(np.diag(hulls.mass))
    G = hulls.constraint_jacobian * scale
    rows = np.linalg.norm(G, axis=1)
    system = np.zeros((len(w), n + c, n + c), dtype=np.complex128)
    system[:, :n, :n] = scale[:, None] * Z * scale
    system[:, :n, n:] = -(G / rows[:, None]).T
    system[:, n:, :n] = G / rows[:, None]
    right = np.zeros((len(w), n + c, len(beta)), dtype=np.complex128)
    right[:, :n] = scale[:, None] * X
    try:
        solution = np.linalg.solve(system, right)
    except np.linalg.LinAlgError as error:
        raise InputError("a response is infinite: no damping at a natural frequency", source=database.source,
                         key="damping", expected="damping, or other frequencies") from error  # fmt: skip
    motion = np.swapaxes(scale[:, None] * solution[:, :n], 1, 2)
    force = np.swapaxes(solution[:, n:] / rows[:, None], 1, 2)
    return MotionOperators(w, beta, motion, force, database.bodies)


def natural_modes(hulls: LinearHulls, *, iterations: int = 50) -> list[NaturalMode]:
    """Undamped natural periods, longest first; the added mass of each mode is that of its own frequency.

    Parameters
    ----------
    hulls
        Group.
    iterations
        At most, for each mode.

    Returns
    -------
    list
        Modes with stiffness; those without (surge, sway, yaw of hulls that are not moored) are left out.

    Notes
    -----
    ``C x = omega^2 (M + A(omega)) x`` in the null space of the joints; the mode is followed by its order while its
    frequency is put into A until it changes by less than 1e-10. Beyond the frequencies of the database the added mass
    of the nearest is held. Where M + A is indefinite, see `resonant_frequencies`, modes have no order: they are the
    frequencies at which an eigenvalue of C - omega^2 (M + A) falls through zero.
    """
    from scipy.linalg import eigh

    database = hulls.database
    scale, free = _free_coordinates(hulls)
    low, high = database.omega[0], database.omega[-1]
    C = _reduced(hulls.stiffness, scale, free)

    def solve(w: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        A = _over_frequency(database, database.added_mass, np.array([min(max(w, low), high)]))[0]
        values, vectors = eigh(C, _reduced(hulls.mass + A, scale, free))
        return values, vectors

    try:
        resonant = len(resonant_frequencies(hulls)) > 0
        found = [] if resonant else _followed_modes(solve, math.sqrt(low * high), iterations)
    except np.linalg.LinAlgError:  # not positive definite between the frequencies of the database
        resonant = True
    if resonant:
        found = _crossed_modes(hulls, C, scale, free)
    modes = []
    for w, vector in found:
        weighed = free @ vector
        largest = int(np.argmax(np.abs(weighed)))
        shape = scale * weighed
        if w > 0.0:
            modes.append(NaturalMode(2.0 * math.pi / w, np.asarray(shape / shape[largest]), largest))
    return sorted(modes, key=lambda mode: -mode.period)


def resonant_frequencies(hulls: LinearHulls) -> NDArray[np.float64]:
    """Frequencies of the database [rad/s] at which mass and added mass together are not positive definite.

    Water between hulls, or within one, resonates there: its added mass is negative and larger than the mass.
    """
    scale, free = _free_coordinates(hulls)
    A = 0.5 * (hulls.database.added_mass + np.swapaxes(hulls.database.added_mass, 1, 2))
    lowest = [np.linalg.eigvalsh(_reduced(hulls.mass + one, scale, free))[0] for one in A]
    return hulls.database.omega[np.array(lowest) <= 0.0]


def _free_coordinates(hulls: LinearHulls) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Scales of the coordinates by their masses, shape (n,), and what joints leave free of them, shape (n, m)."""
    from scipy.linalg import null_space

    scale = 1.0 / np.sqrt(np.diag(hulls.mass))
    if not len(hulls.constraint_jacobian):
        return scale, np.eye(len(scale))
    return scale, np.asarray(null_space(hulls.constraint_jacobian * scale))


def _reduced(
    matrix: NDArray[np.float64], scale: NDArray[np.float64], free: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Symmetric part of a matrix in the scaled coordinates that are free."""
    symmetric = 0.5 * (matrix + matrix.T)
    return np.asarray(free.T @ (scale[:, None] * symmetric * scale) @ free)


def _followed_modes(
    solve: Callable[[float], tuple[NDArray[np.float64], NDArray[np.float64]]], begin: float, iterations: int
) -> list[tuple[float, NDArray[np.float64]]]:
    """Frequencies [rad/s] and vectors of modes that are followed by their order."""
    found = []
    start = solve(begin)[0]
    threshold = NO_STIFFNESS * float(np.max(np.abs(start)))
    for k in np.flatnonzero(start > threshold):
        w = math.sqrt(start[k])
        for iteration in range(iterations):
            values, vectors = solve(w)
            after = math.sqrt(max(values[k], 0.0))
            if abs(after - w) < 1e-10 * after:
                break
            w = after if iteration < 10 else 0.5 * (w + after)  # damped where plain iteration swings
        found.append((w, vectors[:, k]))
    return found


def _crossed_modes(
    hulls: LinearHulls, C: NDArray[np.float64], scale: NDArray[np.float64], free: NDArray[np.float64]
) -> list[tuple[float, NDArray[np.float64]]]:
    """The same where M + A may be indefinite: where an eigenvalue of C - omega^2 (M + A) falls through zero.

    Where one rises through zero, omega^2 A falls so fast that a free oscillation would have negative energy: such
    roots are no modes of the hulls.
    """
    database = hulls.database
    low, high = float(database.omega[0]), float(database.omega[-1])

    def dynamic(w: float) -> NDArray[np.float64]:
        A = _over_frequency(database, database.added_mass, np.array([min(max(w, low), high)]))[0]
        return C - w * w * _reduced(hulls.mass + A, scale, free)

    def below(w: float) -> int:
        return int(np.count_nonzero(np.linalg.eigvalsh(dynamic(w)) < 0.0))

    largest = float(np.abs(np.linalg.eigvalsh(C)).max(initial=0.0))
    if not largest > 0.0:
        return []
    first, last = math.sqrt(NO_STIFFNESS * largest), 2.0 * max(high, math.sqrt(largest))
    inner = np.linspace(low, high, PIECES * len(database.omega))
    grid = np.concatenate(
        [
            np.geomspace(min(first, 0.5 * low), low, PIECES, endpoint=False),
            inner,
            np.geomspace(high, max(last, 2.0 * high), PIECES)[1:],
        ]
    )
    counts = [below(w) for w in grid]
    found = []
    for left, right, few, many in zip(grid[:-1], grid[1:], counts[:-1], counts[1:], strict=True):
        for wanted in range(few + 1, many + 1):
            a, b = float(left), float(right)
            while b - a > 1e-12 * b:
                middle = 0.5 * (a + b)
                if not a < middle < b:
                    break
                a, b = (a, middle) if below(middle) >= wanted else (middle, b)
            found.append((b, np.linalg.eigh(dynamic(b))[1][:, wanted - 1]))  # the one that falls through zero
    return found


def _group_excitation(
    database: HydrodynamicDatabase, w: NDArray[np.float64], beta: float
) -> NDArray[np.complex128]:
    """Excitation relative to a crest at the first reference point, shape (nw, 6N)."""
    X = excitation_at(database, w, beta)
    k = dispersion(w, database.depth, database.gravity)
    between = database.reference_points[:, :2] - database.reference_points[0, :2]
    along = between @ np.array([math.cos(beta), math.sin(beta)])
    return np.asarray(X * np.repeat(np.exp(1j * np.multiply.outer(k, along)), 6, axis=1))


def _over_frequency(
    database: HydrodynamicDatabase, values: NDArray[np.float64], w: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Symmetric parts of coefficients between the frequencies of the database, by cubic splines."""
    from scipy.interpolate import CubicSpline

    low, high = database.omega[0], database.omega[-1]
    if np.any(w < low * (1.0 - 1e-9)) or np.any(w > high * (1.0 + 1e-9)):
        raise InputError(
            f"frequencies from {w.min():.3g} to {w.max():.3g} rad/s",
            source=database.source,
            key="omega",
            expected=f"{low:.3g} to {high:.3g} rad/s ({2 * np.pi / high:.3g} to {2 * np.pi / low:.3g} s)",
        )
    if len(database.omega) == 1:
        return np.repeat(0.5 * (values + np.swapaxes(values, 1, 2)), len(w), axis=0)
    found = np.asarray(CubicSpline(database.omega, values, axis=0)(np.clip(w, low, high)))
    # theory says that both are symmetric; panels leave 15 to 20 % between surge and pitch of a box
    return 0.5 * (found + np.swapaxes(found, 1, 2))
