"""The hydrodynamic database of hulls by the boundary element method of Capytaine: what it is computed from, and how.

Capytaine is an optional package (``heavylift[hydro]``) and is imported here alone, when a database has
to be computed. Each frequency is one task: its matrices are assembled and factorised once for 6 N radiation
problems and all headings. Tasks run in as many processes as there are cores.

Source: Ancellin and Dias, "Capytaine: a Python-based linear potential flow solver", Journal of Open Source
Software 4(36), 1341 (2019); lid: Malenica and Chen, "On the irregular frequencies appearing in wave
diffraction-radiation solutions", IJOPE 8 (1998).
"""

from __future__ import annotations

import hashlib
import logging
import os
from dataclasses import field
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import (
    COORDINATES,
    NO_LID,
    HydrodynamicDatabase,
    at_frequencies,
    wave_numbers,
)
from heavylift.preprocess.hydrodynamics.hull_panels import hydrostatics
from heavylift.preprocess.hydrodynamics.repairs import repaired
from heavylift.preprocess.hydrodynamics.water_planes import moonpools, piston_frequency

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.hull_panels import HullPanels
    from heavylift.preprocess.hydrodynamics.repairs import Repair

__all__ = [
    "BemInputs",
    "capytaine_version",
    "compute_database",
    "database_digest",
    "expected_seconds",
    "input_warnings",
    "part_of",
]


# ---- what a database is computed from ----


PANELS_PER_WAVELENGTH = 6.0
FEWEST_PANELS_PER_WAVELENGTH = 2.0
LEAST_DEPTH = 0.15  # of k h: below, the Green function of finite depth has no series of exponentials
WIDEST_SPACING = np.deg2rad(10.0)
DIGEST_VERSION = 2


@dataclass(frozen=True, eq=False)
class BemInputs:
    """What a database depends on.

    Attributes
    ----------
    hulls
        Panels of each hull, all in the axes of the database (z = 0 the still water).
    omega
        (nw,) frequencies [rad/s], increasing, > 0.
    headings
        (nh,) directions of propagation [rad], increasing.
    reference_points
        (N, 3) [m].
    density, gravity, depth
        [kg/m^3], [m/s^2], [m] (``inf``: deep water).
    symmetric
        Hulls are symmetric about y = 0: headings of 0..pi are enough.
    lid
        Cover the water inside the hulls, which removes irregular frequencies.
    only_at_headings
        True: the database will be used at these headings alone, so their spacing does not matter.
    lids
        Panels of the lid of each hull, None for one that is under water; empty: rectangles that Capytaine lays.
    method
        Unknowns of the integral equation: ``indirect``, densities of sources; ``direct``, potentials.
        On round hulls the potentials have a sixth to a third of the error with the same panels, and matrices are
        nearer to reciprocal; at the edges of boxes sources are better.
    """

    hulls: tuple[HullPanels, ...]
    omega: NDArray[np.float64]
    headings: NDArray[np.float64]
    reference_points: NDArray[np.float64]
    density: float = 1025.0
    gravity: float = 9.81
    depth: float = float("inf")
    symmetric: bool = False
    lid: bool = True
    only_at_headings: bool = False
    lids: tuple[HullPanels | None, ...] = ()
    method: Literal["indirect", "direct"] = "indirect"


def database_digest(inputs: BemInputs) -> str:
    """A key that changes when anything changes that the database depends on (SHA-256, 64 hex digits)."""
    digest = hashlib.sha256(f"bem {DIGEST_VERSION}".encode())
    for hull in inputs.hulls:
        digest.update(hull.name.encode())
        digest.update(np.ascontiguousarray(hull.points, dtype=np.float64).tobytes())
        digest.update(np.ascontiguousarray(hull.panels, dtype=np.int64).tobytes())
    for values in (inputs.omega, inputs.headings, inputs.reference_points):
        array = np.ascontiguousarray(values, dtype=np.float64)
        digest.update(f"{array.shape}".encode())
        digest.update(array.tobytes())
    rest = (inputs.density, inputs.gravity, inputs.depth, inputs.symmetric, inputs.lid)
    digest.update(repr(rest).encode())
    if inputs.method != "indirect":
        digest.update(inputs.method.encode())
    for lid in inputs.lids:
        digest.update(b"lid" if lid is None else np.ascontiguousarray(lid.points, dtype=np.float64).tobytes())
        digest.update(b"" if lid is None else np.ascontiguousarray(lid.panels, dtype=np.int64).tobytes())
    return digest.hexdigest()


def input_warnings(inputs: BemInputs) -> tuple[str, ...]:
    """Refuse inputs that cannot give a database; sentences for what makes it less exact.

    Raises
    ------
    InputError
        No hull, frequencies out of order, headings more than 10 deg apart, panels longer than half of
        the shortest wave, a hull that reaches the bottom of the sea.
    """
    omega = np.asarray(inputs.omega, dtype=np.float64)
    headings = np.asarray(inputs.headings, dtype=np.float64)
    if not inputs.hulls:
        raise InputError("no hulls", source="hydrodynamics", expected="panels of at least one")
    if omega.size == 0 or not np.all(np.isfinite(omega)) or omega[0] <= 0.0 or np.any(np.diff(omega) <= 0.0):
        raise InputError(
            "frequencies are not increasing from above 0",
            source="hydrodynamics",
            key="omega",
            expected="[rad/s]; the limit of infinite frequency is computed by itself",
        )
    if (
        headings.size == 0
        or np.any(np.diff(headings) <= 0.0)
        or np.max(np.abs(headings)) > 2.0 * np.pi + 1e-9
    ):
        raise InputError(
            "headings are not increasing within one turn",
            source="hydrodynamics",
            key="headings",
            expected="directions of propagation [rad]",
        )
    spacing = float(np.max(np.diff(headings), initial=0.0))
    if spacing > WIDEST_SPACING * (1.0 + 1e-9) and not inputs.only_at_headings:
        raise InputError(
            f"headings are {np.rad2deg(spacing):.3g} deg apart",
            source="hydrodynamics",
            key="headings",
            expected="at most 10 deg: cubic interpolation over 15 deg errs by 1 % where the hull is one "
            "wavelength long and by 25 % at two",
        )
    if np.shape(inputs.reference_points) != (len(inputs.hulls), 3):
        raise InputError(
            f"shape {np.shape(inputs.reference_points)}",
            source="hydrodynamics",
            key="reference_points",
            expected=f"({len(inputs.hulls)}, 3)",
        )
    for hull in inputs.hulls:
        if hull.points[:, 2].max() > 1e-6:
            raise InputError(
                "panels reach above the water", source=hull.name, expected="z <= 0: clip the hull"
            )
        if hull.points[:, 2].min() <= -inputs.depth:
            raise InputError(
                f"the draft is {-hull.points[:, 2].min():g} m",
                source=hull.name,
                expected=f"less than the depth of the water, {inputs.depth:g} m",
            )
    _check_depth(inputs, omega)
    return (
        *_resolution_warnings(inputs, omega),
        *_irregular_warnings(inputs, omega),
        *_moonpool_warnings(inputs, omega),
    )


def _check_depth(inputs: BemInputs, omega: NDArray[np.float64]) -> None:
    """Waves are not too long for the depth."""
    if not np.isfinite(inputs.depth):
        return
    longest = float(wave_numbers(omega[:1], inputs.gravity, inputs.depth)[0]) * inputs.depth
    if longest < LEAST_DEPTH:
        lowest = np.sqrt(inputs.gravity * LEAST_DEPTH / inputs.depth * np.tanh(LEAST_DEPTH))
        raise InputError(
            f"at {omega[0]:.4g} rad/s the wave number times the depth is {longest:.3g}",
            source="hydrodynamics",
            key="omega",
            expected=f"at least {LEAST_DEPTH}: frequencies from {lowest:.3g} rad/s in {inputs.depth:g} m of water",
        )


def _resolution_warnings(inputs: BemInputs, omega: NDArray[np.float64]) -> tuple[str, ...]:
    """Panels against the shortest wave, frequencies against the waves a box would shut in."""
    warnings: list[str] = []
    shortest = 2.0 * np.pi / float(wave_numbers(omega[-1:], inputs.gravity, inputs.depth)[0])
    for hull in inputs.hulls:
        size = hull.characteristic_size
        if size * FEWEST_PANELS_PER_WAVELENGTH > shortest:
            raise InputError(
                f"panels of {size:.3g} m, waves of {shortest:.3g} m at {omega[-1]:.3g} rad/s",
                source=hull.name,
                key="panel size",
                expected=f"at most a sixth of the shortest wave, {shortest / PANELS_PER_WAVELENGTH:.3g} m",
            )
        if size * PANELS_PER_WAVELENGTH > shortest:
            resolved = np.sqrt(
                inputs.gravity
                * (k := 2.0 * np.pi / (PANELS_PER_WAVELENGTH * size))
                * (np.tanh(k * inputs.depth) if np.isfinite(inputs.depth) else 1.0)
            )
            warnings.append(
                f"{hull.name}: panels of {size:.3g} m are a sixth of a wave up to {resolved:.3g} rad/s; "
                f"above it, to {omega[-1]:.3g} rad/s, the coefficients are less exact"
            )
    return tuple(warnings)


def _irregular_warnings(inputs: BemInputs, omega: NDArray[np.float64]) -> tuple[str, ...]:
    """The lowest frequency at which water shut in the hull would slosh, omega^2 = g k coth(k T) of its box.

    There, and in a band about it, integral equations without a lid have no unique solution (Faltinsen, Sea Loads,
    chapter 4, "irregular frequencies").
    """
    if inputs.lid:
        return ()
    warnings = []
    for hull in inputs.hulls:
        length, breadth, draft = np.ptp(hull.points, axis=0)
        k = np.pi * np.hypot(1.0 / length, 1.0 / breadth)
        irregular = float(np.sqrt(inputs.gravity * k / np.tanh(k * draft)))
        if omega[-1] > 0.9 * irregular:
            warnings.append(
                f"{hull.name}: without a lid the first irregular frequency is near {irregular:.3g} rad/s; "
                "coefficients about it and above it are wrong in places"
            )
    return tuple(warnings)


def _moonpool_warnings(inputs: BemInputs, omega: NDArray[np.float64]) -> tuple[str, ...]:
    """Frequencies at which the water in a moonpool resonates, where nothing but radiated waves dampens it."""
    warnings = []
    for hull in inputs.hulls:
        try:
            pools = moonpools(hull)
        except InputError:
            continue  # ambiguous rims: no result
        for pool in pools:
            natural = piston_frequency(pool, inputs.gravity)
            near = omega[(omega >= PISTON_BAND[0] * natural) & (omega <= PISTON_BAND[1] * natural)]
            if near.size == 0:
                continue
            shown = ", ".join(f"{value:.4g}" for value in near)
            warnings.append(
                f"{hull.name}: the water in its moonpool, {pool.length:.3g} x {pool.breadth:.3g} m and "
                f"{pool.draft:.3g} m deep, goes up and down with a natural frequency near {natural:.3g} rad/s; "
                "potential theory, without eddies at the edges, gives several times the motion and force that "
                f"are measured there; 'leave_out = [{shown}]' interpolates over it"
            )
    return tuple(warnings)


PISTON_BAND = (0.95, 1.15)
"""Of the estimate, which is that of a very wide hull: one three times as wide as its moonpool is 7 % higher."""


# ---- how long it takes ----

DEEP, SHALLOW = 3.3e-7, 1.4e-6
"""Seconds for a pair of panels: Green function and double layer, in deep water and in water of finite depth."""
FACTOR = 3e-11
"""Seconds for a triple of panels: factors of the matrix."""
SOLUTION = 2e-9
"""Seconds for a pair of panels and a right-hand side. All on one core at about 3 GHz, by Capytaine 3.0."""


def expected_seconds(inputs: BemInputs, processes: int = 0) -> float:
    """An estimate of how long the computation takes on this machine [s], right within a factor of two or three.

    Assembling grows with the square of the number of panels, lids included, factors with its cube. Of hulls that are
    mirrored panel by panel two problems of half the size are solved.
    """
    count = sum(len(hull.panels) for hull in inputs.hulls)
    if inputs.lid:
        count += sum(len(lid.panels) for lid in inputs.lids if lid is not None)
    share = 0.5 if _mirrored(inputs) else 1.0
    pair = DEEP if np.isinf(inputs.depth) else SHALLOW
    sides = 6 * len(inputs.hulls) + len(inputs.headings)
    each = share * (pair + SOLUTION * sides) * count**2 + share**2 * FACTOR * count**3
    tasks = len(inputs.omega) + 1
    return float(each * np.ceil(tasks / min(_workers(processes), tasks)))


def _workers(processes: int) -> int:
    return processes if processes > 0 else (os.cpu_count() or 1)


def _mirrored(inputs: BemInputs) -> bool:
    """Whether hulls and lids are mirrored panel by panel."""
    parts = [*inputs.hulls, *(lid for lid in inputs.lids if inputs.lid and lid is not None)]
    return inputs.symmetric and all(_half(part).size > 0 for part in parts)


SAME_PLACE = 1e-7  # of the size of a hull


class _Task(NamedTuple):
    """Coefficients at one frequency."""

    number: int
    added_mass: NDArray[np.float64]
    damping: NDArray[np.float64]
    excitation: NDArray[np.complex128]


@dataclass(frozen=True)
class _Sea:
    """What is common to all tasks."""

    headings: tuple[float, ...]
    density: float
    gravity: float
    depth: float
    method: str
    coordinates: tuple[str, ...] = field(default=())


def capytaine_version() -> str:
    """Version of Capytaine.

    Raises
    ------
    InputError
        It is not installed.
    """
    return str(_capytaine().__version__)


def compute_database(
    inputs: BemInputs,
    *,
    processes: int = 0,
    progress: Callable[[float, str], None] = lambda _done, _note: None,
    warn: Callable[[str], None] = lambda _text: None,
    keep: Callable[[HydrodynamicDatabase], None] = lambda _database: None,
    repair: Repair | None = None,
) -> HydrodynamicDatabase:
    """Coefficients of all frequencies, of infinite frequency, and of all headings.

    Parameters
    ----------
    inputs
        See `BemInputs`.
    processes
        How many work side by side; 0: one for each core.
    progress
        Called with the number of finished frequencies (of ``len(omega) + 1``) and a note.
    warn
        Called with each sentence of `input_warnings`.
    keep
        Called with what was computed, before it is checked.
    repair
        What of it may be repaired.

    Raises
    ------
    InputError
        Capytaine is missing, inputs that `input_warnings` refuses, or a result that `repaired` refuses.
    """
    for sentence in input_warnings(inputs):
        warn(sentence)
    capytaine = _capytaine()
    body, coordinates = _body(capytaine, inputs)
    sea = _Sea(
        tuple(float(h) for h in inputs.headings),
        inputs.density,
        inputs.gravity,
        inputs.depth,
        inputs.method,
        coordinates,
    )
    omega = np.asarray(inputs.omega, dtype=np.float64)
    n, nw, nh = len(coordinates), len(omega), len(sea.headings)
    added_mass, damping = np.zeros((nw, n, n)), np.zeros((nw, n, n))
    excitation = np.zeros((nw, nh, n), dtype=np.complex128)
    infinite = np.zeros((n, n))
    frequencies = [float("inf"), *(float(w) for w in omega)]
    for done, task in enumerate(_results(body, sea, frequencies, processes), start=1):
        if task.number == 0:
            infinite = task.added_mass
        else:
            added_mass[task.number - 1] = task.added_mass
            damping[task.number - 1] = task.damping
            excitation[task.number - 1] = task.excitation
        progress(done, f"frequency {done} of {nw + 1}")
    still = [
        hydrostatics(hull, inputs.density, inputs.gravity, inputs.reference_points[i])
        for i, hull in enumerate(inputs.hulls)
    ]
    count = sum(len(hull.panels) for hull in inputs.hulls)
    of = ", potentials" if inputs.method == "direct" else ""
    database = HydrodynamicDatabase(
        bodies=tuple(hull.name for hull in inputs.hulls),
        omega=omega,
        headings=np.asarray(inputs.headings, dtype=np.float64),
        added_mass=added_mass,
        damping=damping,
        added_mass_infinite=infinite,
        excitation=excitation,
        reference_points=np.asarray(inputs.reference_points, dtype=np.float64),
        density=inputs.density,
        gravity=inputs.gravity,
        depth=inputs.depth,
        source=f"Capytaine {capytaine.__version__}, {count} panels, {_lid_words(inputs)}{of}",
        symmetric=inputs.symmetric,
        volumes=np.array([each.volume for each in still]),
        centres_of_buoyancy=np.array([each.centre_of_buoyancy for each in still]),
        hydrostatic_stiffness=np.array([each.stiffness for each in still]),
    )
    keep(database)
    return repaired(database, repair)


def _lid_words(inputs: BemInputs) -> str:
    if not inputs.lid:
        return NO_LID
    covers = sum(len(lid.panels) for lid in inputs.lids if lid is not None)
    return f"lid of {covers} panels" if inputs.lids else "lid at z = 0"


def part_of(database: HydrodynamicDatabase, omega: NDArray[np.float64]) -> HydrodynamicDatabase | None:
    """The database at some of its frequencies; None if it does not have all of them."""
    at = np.searchsorted(database.omega, omega)
    if at.max() >= len(database.omega) or np.any(database.omega[at] != omega):
        return None
    return at_frequencies(database, at)


def _capytaine() -> Any:
    """The package, or the error that says how to get it."""
    try:
        import capytaine
    except ImportError:
        raise InputError(
            "Capytaine is not installed, and a hydrodynamic database has to be computed",
            source="hydrodynamics",
            expected="pip install 'heavylift[hydro]', or a database in a file",
        ) from None
    logging.getLogger("capytaine").setLevel(logging.ERROR)
    return capytaine


def _body(capytaine: Any, inputs: BemInputs) -> tuple[Any, tuple[str, ...]]:
    """The hulls as Capytaine has them, and the names of their 6 N coordinates in order."""
    bodies = []
    names: list[str] = []
    # of hulls that are mirrored panel by panel the method needs one side: less than half of the time
    sides = _mirrored(inputs)
    lids = inputs.lids if inputs.lid else ()
    for number, (hull, reference) in enumerate(zip(inputs.hulls, inputs.reference_points, strict=True)):
        kept = _half(hull) if sides else np.arange(len(hull.panels))
        mesh = capytaine.Mesh(vertices=hull.points, faces=hull.panels[kept], name=f"hull{number}")
        if len(kept) < len(hull.panels):
            mesh = capytaine.ReflectionSymmetricMesh(mesh, plane="xOz", name=f"hull{number}")
        lid = mesh.generate_lid(z=0.0) if inputs.lid and not lids else None
        cover = lids[number] if lids else None
        if cover is not None:
            kept = _half(cover) if sides else np.arange(len(cover.panels))
            lid = capytaine.Mesh(vertices=cover.points, faces=cover.panels[kept], name=f"lid{number}")
            if sides:
                lid = capytaine.ReflectionSymmetricMesh(lid, plane="xOz", name=f"lid{number}")
        body = capytaine.FloatingBody(
            mesh=mesh,
            lid_mesh=lid,
            dofs=capytaine.rigid_body_dofs(rotation_center=tuple(float(v) for v in reference)),
            name=f"hull{number}",
        )
        bodies.append(body)
        prefix = f"hull{number}__" if len(inputs.hulls) > 1 else ""
        names += [prefix + coordinate.capitalize() for coordinate in COORDINATES]
    return (bodies[0] if len(bodies) == 1 else capytaine.Multibody(bodies)), tuple(names)


def _half(hull: HullPanels) -> NDArray[np.int64]:
    """Numbers of the panels with y > 0 if those with y < 0 are their mirror images; none otherwise."""
    from scipy.spatial import KDTree

    corners = hull.points[hull.panels]
    size = float(np.ptp(hull.points, axis=0).max())
    left = np.flatnonzero(corners[:, :, 1].min(axis=1) > -SAME_PLACE * size)
    right = np.flatnonzero(corners[:, :, 1].max(axis=1) < SAME_PLACE * size)
    if len(left) + len(right) != len(corners) or len(left) != len(right):
        return np.zeros(0, dtype=np.int64)
    area = 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    panels = np.hstack([corners.mean(axis=1), area / size])  # area divided by a length: compared as lengths
    mirror = np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0])
    distance, partner = KDTree(panels[right] * mirror).query(panels[left])
    mirrored = np.all(distance < SAME_PLACE * size) and len(np.unique(partner)) == len(left)
    return left if mirrored else np.zeros(0, dtype=np.int64)


def _results(body: Any, sea: _Sea, frequencies: list[float], processes: int) -> Iterator[_Task]:
    """Results in any number of processes, in the order of the frequencies."""
    jobs = min(_workers(processes), len(frequencies))
    if jobs > 1:
        try:
            import joblib
        except ImportError:
            jobs = 1
    if jobs == 1:
        for number, omega in enumerate(frequencies):
            yield _solve(body, sea, number, omega)
        return
    # tasks are equal: they are handed out one by one
    with joblib.parallel_config(backend="loky", inner_max_num_threads=1):
        yield from joblib.Parallel(n_jobs=jobs, return_as="generator", batch_size=1)(
            joblib.delayed(_solve)(body, sea, number, omega) for number, omega in enumerate(frequencies)
        )


@lru_cache(maxsize=1)
def _solver() -> Any:
    """One for each process: it reads a table of the Green function when it is made."""
    import capytaine

    return capytaine.BEMSolver()


def _solved(problem: Any, method: str) -> Any:
    """Solution of one problem; a failure is an error here, not NaN in a table."""
    from capytaine.green_functions.abstract_green_function import GreenFunctionEvaluationError

    try:
        return _solver().solve(problem, method=method, keep_details=False, _check_wavelength=False)
    except GreenFunctionEvaluationError as error:
        raise InputError(
            f"{error}", source="Capytaine", expected="a depth, frequencies and panels it can compute"
        ) from None


def _solve(body: Any, sea: _Sea, number: int, omega: float) -> _Task:
    """All problems of one frequency; any that fails raises (batch solvers would leave NaN)."""
    capytaine = _capytaine()
    from capytaine.bem.airy_waves import froude_krylov_force

    common = {"body": body, "omega": omega, "water_depth": sea.depth, "rho": sea.density, "g": sea.gravity}
    n = len(sea.coordinates)
    task = _Task(number, np.zeros((n, n)), np.zeros((n, n)), np.zeros((len(sea.headings), n), np.complex128))
    for j, radiating in enumerate(sea.coordinates):
        problem = capytaine.RadiationProblem(radiating_dof=radiating, **common)
        result = _solved(problem, sea.method)
        task.added_mass[:, j] = [result.added_mass[i] for i in sea.coordinates]
        task.damping[:, j] = [result.radiation_damping[i] for i in sea.coordinates]
    if np.isfinite(omega):
        for h, heading in enumerate(sea.headings):
            wave = capytaine.DiffractionProblem(wave_direction=heading, **common)
            result = _solved(wave, sea.method)
            incident = froude_krylov_force(wave)
            task.excitation[h] = [result.forces[i] + incident[i] for i in sea.coordinates]
    for values in task[1:]:
        if not np.all(np.isfinite(values)):
            raise InputError(
                f"a coefficient at {omega:.4g} rad/s is not finite",
                source="Capytaine",
                expected="panels that do not touch or cross each other",
            )
    return task
