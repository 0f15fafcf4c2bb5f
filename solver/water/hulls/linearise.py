"""A scene with hulls, linearised about its equilibrium: the matrices of the frequency domain.

Stiffness is that of the packed scene itself: difference quotients of all forces at rest, so buoyancy of clipped hulls,
free surfaces, weight, catenaries, springs and ropes are in it as the time domain has them. Joints become linear
constraints; bodies that do not float enter with their mass. The databases of its hulls become one of all its bodies.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import rotation_matrix
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase, over_full_circle
from heavylift.solver.scene.scene import Scene
from heavylift.solver.water.hulls.frequency_domain import LinearHulls, linear_hulls, rigid_body_mass
from heavylift.solver.water.waves.spectra import dispersion
from heavylift.solver.water.waves.wave_transfer import excitation_at

if TYPE_CHECKING:
    from collections.abc import Sequence

    from heavylift.solver.scene.sea import Radiation, Sea

__all__ = [
    "LinearScene",
    "hull_transform",
    "joined_database",
    "linear_group",
    "linearise",
]


# ---- one database of all hulls ----


def joined_database(
    radiation: Sequence[Radiation],
    bodies: Sequence[str],
    headings: NDArray[np.float64],
    points: NDArray[np.float64],
    *,
    level: float = 0.0,
) -> HydrodynamicDatabase:
    """One database of all bodies of a scene, from those of its hulls; other bodies feel no water.

    Parameters
    ----------
    radiation
        Databases and their hulls.
    bodies
        K names; the first is a hull of the first database.
    headings
        Of the bodies [rad], shape (K,).
    points
        Reference points in the world [m], shape (K, 3).
    level
        Of the water [m].

    Returns
    -------
    HydrodynamicDatabase
        Its origin is the reference point of the first body in the water plane, its x axis the heading of that body.
        Without headings, if one of the databases has no exciting forces.
        Frequencies are those of the first database within the range of all.

    Raises
    ------
    InputError
        If the databases have no frequencies in common, or not the headings that another hull needs.
    """
    bodies = tuple(bodies)
    first = radiation[0].database
    low = max(one.database.omega[0] for one in radiation)
    high = min(one.database.omega[-1] for one in radiation)
    omega = first.omega[(first.omega >= low) & (first.omega <= high)]
    if not len(omega):
        raise InputError(
            f"no frequencies between {low:.3g} and {high:.3g} rad/s, which all databases have",
            source=first.source,
            key="omega",
            expected="databases over the same frequencies",
        )
    beta = over_full_circle(first).headings
    if not all(
        one.database.has_excitation for one in radiation
    ):  # of what waves do to some of them nothing is known
        beta = beta[:0]
    n, m = 6 * len(bodies), len(omega)
    c, s = math.cos(headings[0]), math.sin(headings[0])
    places = points - points[0]
    places = np.column_stack(
        [c * places[:, 0] + s * places[:, 1], c * places[:, 1] - s * places[:, 0], points[:, 2]]
    )
    places[:, 2] -= level
    added, damping = np.zeros((m, n, n)), np.zeros((m, n, n))
    infinite = np.zeros((n, n))
    excitation = np.zeros((m, len(beta), n), dtype=np.complex128)
    k = dispersion(omega, first.depth, first.gravity)
    ways = np.stack([np.cos(beta), np.sin(beta)])
    for one in radiation:
        rows = np.array([bodies.index(name) for name in one.bodies])
        own = (6 * rows[:, None] + np.arange(6)).ravel()
        at = np.ix_(np.arange(m), own, own)
        added[at] = _at_frequencies(one.database, one.database.added_mass, omega)
        damping[at] = _at_frequencies(one.database, one.database.damping, omega)
        infinite[np.ix_(own, own)] = one.database.added_mass_infinite
        for j, row in enumerate(rows):
            turned = headings[0] - headings[row]
            phase = np.exp(1j * np.multiply.outer(k, places[row, :2] @ ways))
            for b, heading in enumerate(beta):
                X = excitation_at(one.database, omega, float(heading + turned))
                excitation[:, b, 6 * row : 6 * row + 6] = X[:, 6 * j : 6 * j + 6] * phase[:, b, None]
    return HydrodynamicDatabase(
        bodies=bodies,
        omega=omega,
        headings=beta,
        added_mass=added,
        damping=damping,
        added_mass_infinite=infinite,
        excitation=excitation,
        reference_points=places,
        density=first.density,
        gravity=first.gravity,
        depth=first.depth,
        source=", ".join(dict.fromkeys(one.database.source for one in radiation)),
    )


def _at_frequencies(
    database: HydrodynamicDatabase, values: NDArray[np.float64], omega: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Coefficients over frequency; between those of the database by a cubic spline."""
    from scipy.interpolate import CubicSpline

    place = np.minimum(np.searchsorted(database.omega, omega), len(database.omega) - 1)
    if np.array_equal(database.omega[place], omega):
        return values[place]
    return np.asarray(CubicSpline(database.omega, values, axis=0)(omega))


# ---- the scene ----


INDEPENDENT = 1e-9
"""Part of a row, relative to the largest, that must not be a combination of other rows."""


@dataclass(frozen=True, eq=False)
class LinearScene:
    """Small motions of a scene about its equilibrium, in hydrodynamic coordinates.

    Attributes
    ----------
    bodies
        K names: hulls with databases first, in their order, then the other bodies.
    headings
        Of the coordinates of each body [rad], shape (K,): those of hulls; other bodies have that of the first hull.
    points
        World places of the reference points [m], shape (K, 3); of other bodies their centres of mass.
    mass, stiffness, damping
        Shape (6K, 6K); without that of the water, and without the radiation damping.
    jacobian
        Independent rows of the rigid joints, shape (c, 6K).
    row_names
        Joint of each row.
    asymmetry
        Largest difference of the stiffness and its transpose, relative to the largest entries of their diagonal: zero
        in equilibrium up to round-off and forces that follow a body.
    text
        What was done to find the equilibrium.
    notes
        Of hulls that lie there at another draught than in their databases, and are not refused.
    """

    bodies: tuple[str, ...]
    headings: NDArray[np.float64]
    points: NDArray[np.float64]
    mass: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    damping: NDArray[np.float64]
    jacobian: NDArray[np.float64]
    row_names: tuple[str, ...]
    asymmetry: float
    text: str
    notes: tuple[str, ...] = ()


def linearise(scene: Scene) -> LinearScene:
    """Find the equilibrium of a scene and its matrices there.

    Parameters
    ----------
    scene
        With hulls, at least one of them with a database. Waves are left out; of wind and current the mean acts, at
        its full strength; contacts are left out.

    Raises
    ------
    InputError
        If no hull has a database, a free body is not rigid, there is no equilibrium, or a database is of another
        water, hull or draught.

    Notes
    -----
    Damping is that of `Hull.damping` and of linear spring dampers; drag and quadratic damping are not linear. Free
    surfaces and tanks are those at the start of time.
    """
    from heavylift.solver.layout import pack_scene
    from heavylift.solver.layout_sea import floating_hulls
    from heavylift.solver.start.rows import StartRows
    from heavylift.solver.statics.equilibrium import find_equilibrium
    from heavylift.solver.statics.forces import StaticForces
    from heavylift.solver.water.hulls.database_fit import check_databases, check_rest

    _check(scene)
    assert scene.sea is not None
    hulls = floating_hulls(scene)
    check_databases(hulls, scene.sea)
    still = replace(
        scene,
        sea=_without_waves(scene.sea),
        contacts=(),
        contours=(),
        surfaces=(),
        collisions=(),
        at_rest=True,
    )
    layout = pack_scene(still, "dele2", 0.0)
    rows = StartRows(layout)
    text = find_equilibrium(rows).text
    notes = check_rest(layout.bodies, layout.body_names, hulls, scene.sea, scene.scenario)
    forces = StaticForces(rows)
    load, G, _ = forces.evaluate()
    reaction, _ = forces.balance(load, G)
    rows.fill()
    G = rows.jacobian()
    K = np.zeros((len(rows.inertia), len(rows.inertia)))
    K[np.ix_(rows.free, rows.free)] = forces.stiffness(reaction).toarray()
    forces.evaluate()

    parts = _parts(layout, scene)
    columns = np.concatenate([np.arange(part.dof, part.dof + 6) for part in parts])
    n = 6 * len(parts)
    inverse = np.zeros((n, n))  # U = T^-1 u
    mass, damping = np.zeros((n, n)), np.zeros((n, n))
    for row, part in enumerate(parts):
        at = slice(6 * row, 6 * row + 6)
        inverse[at, at] = np.linalg.inv(part.transform)
        mass[at, at] = part.mass
        damping[at, at] = part.damping
    stiffness = inverse.T @ K[np.ix_(columns, columns)] @ inverse
    jacobian = G[:, columns].toarray() @ inverse
    damping += _spring_damping(rows, jacobian)
    scale = 1.0 / np.sqrt(np.diag(mass))
    scaled = scale[:, None] * stiffness * scale
    largest = np.abs(np.diag(scaled)).max(initial=1e-300)
    rigid = np.flatnonzero(rows.rigid)
    kept = rigid[_independent(jacobian[rigid] * scale)]
    return LinearScene(
        bodies=tuple(part.name for part in parts),
        headings=np.array([part.heading for part in parts]),
        points=np.array([part.point for part in parts]),
        mass=mass,
        stiffness=0.5 * (stiffness + stiffness.T),
        damping=damping,
        jacobian=jacobian[kept],
        row_names=tuple(rows.names[rows.block[row]] for row in kept),
        asymmetry=float(np.abs(scaled - scaled.T).max() / largest),
        text=text,
        notes=tuple(notes),
    )


def linear_group(scene: Scene, linear: LinearScene) -> LinearHulls:
    """The linearised scene with what its databases say, for `frequency_domain.motion_operators`.

    Headings of waves are then relative to the first hull, and its reference point is that of the phases.
    """
    assert scene.sea is not None
    database = joined_database(
        scene.sea.radiation, linear.bodies, linear.headings, linear.points, level=scene.sea.water.level
    )
    return linear_hulls(
        database,
        linear.mass,
        linear.stiffness,
        damping=linear.damping,
        constraint_jacobian=linear.jacobian,
    )


def hull_transform(
    rotation: NDArray[np.float64], reference: NDArray[np.float64], heading: float
) -> NDArray[np.float64]:
    """``u = T U``: velocities of a reference point in heading axes from those of a body.

    Parameters
    ----------
    rotation
        Body (principal) axes to the world, shape (3, 3).
    reference
        From the centre of mass in these axes [m], shape (3,).
    heading
        [rad].

    Returns
    -------
    NDArray
        Shape (6, 6); U is the world velocity of the centre of mass and the spin in body axes.
    """
    c, s = math.cos(heading), math.sin(heading)
    Q = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    P = Q @ rotation
    x, y, z = reference
    T = np.zeros((6, 6))
    T[:3, :3] = Q
    T[:3, 3:] = -P @ np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    T[3:, 3:] = P
    return T


@dataclass(frozen=True, eq=False)
class _Part:
    """One free body."""

    name: str
    dof: int
    heading: float
    point: NDArray[np.float64]
    transform: NDArray[np.float64]
    mass: NDArray[np.float64]
    damping: NDArray[np.float64]


def _check(scene: Scene) -> None:
    """See that there is something to do, and that it can be done."""
    sea = scene.sea
    if sea is None or not sea.hulls or not sea.radiation:
        what = "hulls" if sea is None or not sea.hulls else "databases"
        raise InputError(
            f"there are no {what}",
            source="scene",
            key="sea",
            expected="hulls with a hydrodynamic database, which have response operators",
        )
    soft = [body.name for body in scene.bodies if body.DEFORMS and _moves(body)]
    if soft:
        raise InputError(
            f"{soft[0]!r} is no rigid body",
            source="scene",
            key="bodies",
            expected="rigid bodies; stiff ones in place of flexible ones for the frequency domain",
        )
    for one in (*scene.ropes, *scene.forces):
        reason = getattr(one, "NOT_LINEAR", "")
        if reason:
            raise InputError(
                f"{one.name!r} {reason}",
                source="scene",
                key="ropes" if one in scene.ropes else "forces",
                expected="springs and dampers in its place for the frequency domain",
            )


def _moves(body: Any) -> bool:
    from heavylift.solver.scene.scene import Fixed

    return not isinstance(getattr(body, "motion", None), Fixed)


def _without_waves(sea: Sea) -> Sea:
    """Still water, with the mean of wind and current from the start on."""
    from heavylift.solver.scene.wind_loads import WindField

    fields = tuple(
        replace(one, fluctuation=None) if isinstance(one, WindField) else one for one in sea.fields
    )
    return replace(
        sea, waves=None, ramp=0.0, fields=fields, radiation=()
    )  # at rest databases give no information


def _parts(layout: Any, scene: Scene) -> list[_Part]:
    """Free bodies in the order of the coordinates."""
    from heavylift.solver.bodies.rigid.kind import RigidFrame
    from heavylift.solver.drive import FREE

    sea = scene.sea
    assert sea is not None
    hulls: dict[str, _Part] = {}
    others: list[tuple[str, int, RigidFrame]] = []
    for kind in layout.bodies:
        for row, table in enumerate(kind.table):
            name = layout.body_names[table.number]
            if kind.FLOATS:
                hulls[name] = _hull_part(kind, row, name, sea)
            elif table.motion == FREE:
                others.append((name, int(table.dof), kind.frame[row]))
    with_water = [name for one in sea.radiation for name in one.bodies]
    order = [*with_water, *(name for name in hulls if name not in with_water)]
    parts = [hulls[name] for name in order]
    heading = parts[0].heading
    for name, dof, frame in others:
        R = rotation_matrix(frame.orientation)
        T = hull_transform(R, np.zeros(3), heading)
        P = T[3:, 3:]
        inertia = P @ np.diag(frame.principal_inertia) @ P.T
        point = frame.position.copy()
        mass = rigid_body_mass(frame.mass, np.zeros(3), inertia)
        parts.append(_Part(name, dof, heading, point, T, mass, np.zeros((6, 6))))
    return parts


def _hull_part(kind: Any, row: int, name: str, sea: Sea) -> _Part:
    frame, hull = kind.frame[row], kind.hulls[row]
    R = rotation_matrix(frame.orientation)
    forward = R @ hull.axis_x
    heading = math.atan2(forward[1], forward[0])
    reference = hull.reference.copy()
    T = hull_transform(R, reference, heading)
    P = T[3:, 3:]
    inertia = P @ np.diag(frame.principal_inertia) @ P.T
    mass = rigid_body_mass(frame.mass, -P @ reference, inertia)
    for tank in kind.tanks[hull.first_tank : hull.last_tank]:
        arm = P @ (tank.point - reference)
        mass = mass + rigid_body_mass(tank.mass, arm, np.zeros((3, 3)))
    damping = next(one.damping for one in sea.hulls if one.body == name)
    point = frame.position + R @ reference
    return _Part(
        name, int(kind.table[row].dof), heading, point, T, mass, np.asarray(damping, dtype=np.float64)
    )


def _spring_damping(rows: Any, jacobian: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of rows with a compliance 1/k and a relaxation time c/k: ``G^T c G``."""
    compliance, relaxation = rows.column("compliance"), rows.column("relaxation")
    c = np.where(compliance > 0.0, relaxation / np.where(compliance > 0.0, compliance, 1.0), 0.0)
    return np.asarray(jacobian.T @ (c[:, None] * jacobian))


def _independent(rows: NDArray[np.float64]) -> NDArray[np.int64]:
    """Numbers of rows that span the others, in order."""
    from scipy.linalg import qr

    if not len(rows):
        return np.zeros(0, dtype=np.int64)
    length = np.linalg.norm(rows, axis=1)
    unit = rows / np.where(length > 0.0, length, 1.0)[:, None]
    R, pivots = qr(unit.T, mode="r", pivoting=True)
    diagonal = np.abs(np.diag(R))
    return np.sort(pivots[: np.count_nonzero(diagonal > INDEPENDENT * max(diagonal[0], 1e-300))])
