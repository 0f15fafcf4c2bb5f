"""Whether the databases of a scene are those of its water and of its hulls; one place for all that use them.

A database is compared with the hull as it lies there: upright, with its reference point where the database has it. Its
own hydrostatics are compared if it states any: volume, centre of buoyancy, area, centre and second moments of the water
plane. Otherwise what every database tells of its hull:

* heave in long waves is rho g times the area of the water plane;
* hulls that are symmetric about y = 0 in the database are so;
* the added mass of heave acts near the centre of the water plane, at x = - A35 / A33, y = A34 / A33;
* a hull that is much longer one way resists turns about the other axis more, and so does the water with it.

Source: Faltinsen, *Sea Loads on Ships and Offshore Structures* (1990), chapter 3: (3.49) and (3.50) for the stiffness.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import records
from heavylift.preprocess.hydrodynamics.plausibility import check_long_waves
from heavylift.solver.scene.operations import MOVES
from heavylift.solver.scene.sea import LinearRestoring, RestoringOfSurface
from heavylift.solver.water.hulls.checks import check_places
from heavylift.solver.water.hulls.clipping import Clip, clip_surface_now

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
    from heavylift.solver.scene.scenario import Scenario
    from heavylift.solver.scene.sea import FloatingBody, Sea

__all__ = ["check_databases", "check_rest", "weight_words"]

TOLD = 0.05
"""Difference from which on there is a warning: of a volume, area or second moment, of a length against the gyradius of
the water plane."""
REFUSED = 0.2
"""Difference that is refused."""
VOLUME_REFUSED = 0.1
"""Of the displaced volume, of which draughts follow."""

ROUND = 1e-6
"""Of a size: less is written as zero."""

CENTRE_TOLD, CENTRE_REFUSED = 0.2, 0.4
"""The same for the centre of the added mass of heave, which lies near that of the water plane."""

SLENDER = 2.0
"""Ratio of second moments, and of added moments of inertia, that tells which way a hull is longer."""


class _Plane(NamedTuple):
    """Volume [m^3], its centre (3,) [m] and water plane of a hull, horizontally from the reference point.

    Heights are those above the water. Moments: area [m^2], then integrals of x, y [m^3], x^2, y^2 [m^4].
    """

    volume: float
    centre: NDArray[np.float64]
    area: float
    x: float
    y: float
    xx: float
    yy: float

    @property
    def gyradii(self) -> tuple[float, float]:
        """Of the water plane along x and y about its centre [m]; of a hull without one, that of its volume."""
        if not self.area > 0.0:
            return (self.volume ** (1.0 / 3.0),) * 2
        return (
            float(np.sqrt(max(self.xx / self.area - (self.x / self.area) ** 2, 0.0))),
            float(np.sqrt(max(self.yy / self.area - (self.y / self.area) ** 2, 0.0))),
        )


class _Difference(NamedTuple):
    """What differs, by how much (1: as much as is refused), what the hull and the database have."""

    what: str
    size: float
    hull: str
    database: str


def check_databases(bodies: Sequence[FloatingBody], sea: Sea) -> list[str]:
    """Refuse databases of another water or other hulls.

    Parameters
    ----------
    bodies
        Hulls of a scene as they start; others may be among them.
    sea
        With its databases.

    Returns
    -------
    list
        Sentences about what differs and is not refused.

    Raises
    ------
    InputError
        If density, gravity or depth are those of another water, hulls that interact start elsewhere or turned against
        each other, or a hull is another one, turned, with another reference point or of another draught.
    """
    by_name = {body.name: body for body in bodies}
    notes: list[str] = []
    for radiation in sea.radiation:
        hulls = [by_name[name] for name in radiation.bodies]
        _check_water(radiation.database, sea)
        check_places(radiation, hulls)
        for row, body in enumerate(hulls):
            notes += _check_hull(radiation.database, row, body)
    return notes


def _check_water(database: HydrodynamicDatabase, sea: Sea) -> None:
    """A database was computed for a water, which must be that of the scene."""
    water = sea.water
    same = np.isclose(database.density, water.density, rtol=0.01) and np.isclose(
        database.gravity, water.gravity, rtol=5e-3
    )
    depths = 1.0 / np.array([database.depth, water.depth])
    if not (same and abs(depths[0] - depths[1]) <= 0.05 * max(depths)):
        raise InputError(
            f"density {database.density:g} kg/m3, gravity {database.gravity:g} m/s2, depth {database.depth:g} m",
            source=database.source,
            key="density, gravity, depth",
            expected=f"those of the sea: {water.density:g}, {water.gravity:g}, {water.depth:g}",
        )


def _check_hull(database: HydrodynamicDatabase, row: int, body: FloatingBody) -> list[str]:
    hull = _plane_of_hull(database, row, body)
    if hull is None:
        return []
    words = f"{body.name!r}, upright and with its reference point where the database has it"
    of_numbers = _in_numbers(body)
    if not hull.volume > 0.0:
        dry = f"{words}, is out of the water"
        if of_numbers:
            return [f"{dry} ({database.source})"]
        raise InputError(
            dry,
            source=database.source,
            key="reference",
            expected="the reference point and draught of the database",
        )
    stated = _plane_of_database(database, row)
    found = _differences(database, row, hull, stated)
    if _stiffness(database, row) is None:
        found += _by_added_mass(database, row, hull)
    hint = _hint(hull, stated, found)
    worst = max(found, key=lambda one: one.size, default=None)
    if worst is not None and worst.size > 1.0 and not of_numbers:
        raise InputError(
            f"{words}, has {worst.what} {worst.hull}",
            source=database.source,
            key="reference",
            expected=f"about {worst.database}, as in the database: its hull, heading, reference point and draught"
            f"{hint}",
        )
    notes = [
        f"{words}, has {one.what} {one.hull}, its database ({database.source}) {one.database}{hint}"
        for one in found
    ]
    if _stiffness(database, row) is None and hull.area > 0.0:
        try:
            check_long_waves(_with_plane(database, row, hull))
        except InputError as error:
            if not of_numbers:
                raise
            notes.append(str(error))
    return notes


def _in_numbers(body: FloatingBody) -> bool:
    """Whether buoyancy is given in numbers, without a surface: differences are reported, never refused."""
    restoring = body.hull.restoring
    return isinstance(restoring, LinearRestoring) and not isinstance(restoring, RestoringOfSurface)


def _plane_of_hull(database: HydrodynamicDatabase, row: int, body: FloatingBody) -> _Plane | None:
    """Of a hull as it lies in the database; None without buoyancy."""
    restoring, reference = body.hull.restoring, np.asarray(body.hull.reference, dtype=np.float64)
    height = float(database.reference_points[row, 2] - reference[2])  # of the frame above the water
    if restoring is None:
        return None
    x, y = float(reference[0]), float(reference[1])
    if isinstance(restoring, LinearRestoring):
        A, Sx, Sy, Ixx, Iyy, _ = restoring.waterplane
        px, py, pz = np.asarray(restoring.reference, dtype=np.float64)
        rise = -height - float(pz)  # of the water over the float plane
        volume = restoring.volume + A * rise
        moment = restoring.volume * np.asarray(restoring.centre_of_buoyancy, dtype=np.float64)
        moment = moment + rise * np.array([Sx + A * px, Sy + A * py, A * (pz + 0.5 * rise)])
        centre = moment / volume if volume > 0.0 else np.asarray(restoring.centre_of_buoyancy)
        # from the point of the float plane to the origin of the frame
        Ixx, Iyy = Ixx + 2.0 * px * Sx + A * px * px, Iyy + 2.0 * py * Sy + A * py * py
        Sx, Sy = Sx + A * px, Sy + A * py
        centre = centre + np.array([0.0, 0.0, height])
    else:
        out = records(Clip, 1)
        points = np.ascontiguousarray(restoring.points, dtype=np.float64)
        triangles = np.ascontiguousarray(restoring.triangles, dtype=np.int64)
        clip_surface_now(points, triangles, np.eye(3).ravel(), height, np.zeros_like(points), out)
        clip = out[0]
        volume = float(clip.volume)
        centre = np.asarray(clip.moment) / volume if volume > 0.0 else np.zeros(3)
        A, Sx, Sy, Ixx, Iyy = clip.plane_area, clip.plane_x, clip.plane_y, clip.plane_xx, clip.plane_yy
    return _Plane(
        volume=float(volume),
        centre=centre - np.array([x, y, 0.0]),
        area=float(A),
        x=float(Sx - A * x),
        y=float(Sy - A * y),
        xx=float(Ixx - 2.0 * x * Sx + A * x * x),
        yy=float(Iyy - 2.0 * y * Sy + A * y * y),
    )


def _stiffness(database: HydrodynamicDatabase, row: int) -> NDArray[np.float64] | None:
    """Of a hull, by rho g; None if the database has none, or zeros."""
    if database.hydrostatic_stiffness is None:
        return None
    C = database.hydrostatic_stiffness[row] / (database.density * database.gravity)
    return C if C[2, 2] > 0.0 else None


def _plane_of_database(database: HydrodynamicDatabase, row: int) -> _Plane:
    """What a database states; NaN for what it does not."""
    volume, centre = np.nan, np.full(3, np.nan)
    if database.volumes is not None and database.volumes[row] > 0.0:
        volume = float(database.volumes[row])
        if database.centres_of_buoyancy is not None:
            centre = database.centres_of_buoyancy[row] - database.reference_points[row] * [1.0, 1.0, 0.0]
    C = _stiffness(database, row)
    if C is None:
        return _Plane(volume, centre, *[np.nan] * 5)
    arm = volume * (centre[2] - database.reference_points[row, 2])
    return _Plane(volume, centre, C[2, 2], -C[2, 4], C[2, 3], C[4, 4] - arm, C[3, 3] - arm)


def _differences(database: HydrodynamicDatabase, row: int, hull: _Plane, stated: _Plane) -> list[_Difference]:
    """Of the hydrostatics that a database states, and of its symmetry."""
    along = hull.gyradii
    found: list[_Difference] = []

    def compare(what: str, unit: str, own: float, other: float, size: float, limit: float = REFUSED) -> None:
        share = abs(own - other) / size if size > 0.0 else np.inf
        if np.isfinite(other) and share > TOLD:
            has, wanted = (f"{0.0 if abs(one) < ROUND * size else one:.4g} {unit}" for one in (own, other))
            found.append(_Difference(what, share / limit, has, wanted))

    compare("a displaced volume of", "m3", hull.volume, stated.volume, stated.volume, VOLUME_REFUSED)
    compare("a water plane of", "m2", hull.area, stated.area, stated.area)
    for axis, word, own, other in ((0, "x", hull.x, stated.x), (1, "y", hull.y, stated.y)):
        compare(
            f"its centre of buoyancy at {word} =", "m from that point", hull.centre[axis], stated.centre[axis],
            along[axis],
        )  # fmt: skip
        if hull.area > 0.0:
            compare(
                f"the centre of its water plane at {word} =", "m from that point", own / hull.area,
                other / stated.area, along[axis],
            )  # fmt: skip
    draught = hull.volume / hull.area if hull.area > 0.0 else hull.volume ** (1.0 / 3.0)
    compare("its centre of buoyancy at z =", "m from the water", hull.centre[2], stated.centre[2], draught)
    if np.isfinite(stated.xx):
        whole = "a second moment of its water plane about the {} axis of"
        compare(whole.format("longitudinal"), "m4", hull.yy, stated.yy, hull.yy)
        compare(whole.format("transverse"), "m4", hull.xx, stated.xx, hull.xx)
    else:  # what its numbers have of weight and buoyancy is the same in roll and pitch
        C = _stiffness(database, row)
        if C is not None:
            compare(
                "second moments of its water plane about the transverse and longitudinal axes that differ by",
                "m4", hull.xx - hull.yy, C[4, 4] - C[3, 3], hull.xx + hull.yy,
            )  # fmt: skip
    if database.symmetric:
        middle = hull.y / hull.area if hull.area > 0.0 else 0.0
        for what, off in (("displaced volume", hull.centre[1]), ("water plane", middle)):
            compare(f"the middle of its {what} at y =", "m from that point", off, 0.0, along[1])
    return found


def _by_added_mass(database: HydrodynamicDatabase, row: int, hull: _Plane) -> list[_Difference]:
    """What the added mass at infinite frequency tells of a hull whose hydrostatics are not stated."""
    block = slice(6 * row, 6 * row + 6)
    A = database.added_mass_infinite[block, block]
    found: list[_Difference] = []
    if not (A[2, 2] > 0.0 and hull.area > 0.0):
        return found
    centres = (-0.5 * (A[2, 4] + A[4, 2]) / A[2, 2], 0.5 * (A[2, 3] + A[3, 2]) / A[2, 2])
    for axis, own in enumerate((hull.x / hull.area, hull.y / hull.area)):
        share = abs(own - centres[axis]) / hull.gyradii[axis]
        if share > CENTRE_TOLD:
            word = "xy"[axis]
            found.append(
                _Difference(
                    f"the centre of its water plane at {word} =",
                    share / CENTRE_REFUSED,
                    f"{own:.4g} m from that point",
                    f"{centres[axis]:.4g} m, where the added mass of heave acts",
                )
            )
    pitch, roll = A[4, 4], A[3, 3]
    longer = (hull.xx > SLENDER * hull.yy, hull.yy > SLENDER * hull.xx)
    heavier = (pitch > SLENDER * roll, roll > SLENDER * pitch)
    if min(pitch, roll) > 0.0 and (longer == heavier[::-1]) and any(longer):
        found.append(
            _Difference(
                "a water plane that is longer along",
                np.inf,
                "x" if longer[0] else "y",
                f"that of a hull longer along {'y' if longer[0] else 'x'}, by the added mass of roll and pitch",
            )
        )
    return found


def _hint(hull: _Plane, stated: _Plane, found: Sequence[_Difference]) -> str:
    """A likely reason."""
    moments = [one for one in found if "second moment" in one.what or "longer along" in one.what]
    if not moments:
        return ""
    if any("longer along" in one.what for one in moments):
        return " (is it turned by 90 degrees?)"
    own, other = hull.gyradii, stated.gyradii
    if np.allclose(own, other[::-1], rtol=REFUSED) and not np.allclose(own, other, rtol=REFUSED):
        return " (is it turned by 90 degrees?)"
    return ""


def _with_plane(database: HydrodynamicDatabase, row: int, hull: _Plane) -> HydrodynamicDatabase:
    """The part of one hull, with the stiffness in heave of its water plane."""
    own = slice(6 * row, 6 * row + 6)
    stiffness = np.zeros((1, 6, 6))
    stiffness[0, 2, 2] = database.density * database.gravity * hull.area
    return replace(
        database,
        bodies=(database.bodies[row],),
        added_mass=database.added_mass[:, own, own],
        damping=database.damping[:, own, own],
        added_mass_infinite=database.added_mass_infinite[own, own],
        excitation=database.excitation[:, :, own],
        drift=None,
        reference_points=database.reference_points[row : row + 1],
        volumes=np.array([hull.volume]),
        centres_of_buoyancy=None,
        hydrostatic_stiffness=stiffness,
    )


# ---- weight ----


def _volume(database: HydrodynamicDatabase, row: int, body: FloatingBody) -> float:
    """What a hull displaces in its database [m^3]; NaN if nothing tells."""
    stated = _plane_of_database(database, row).volume
    if np.isfinite(stated):
        return stated
    hull = _plane_of_hull(database, row, body)
    return hull.volume if hull is not None and hull.volume > 0.0 else np.nan


def weight_words(
    bodies: Sequence[FloatingBody],
    sea: Sea,
    name: str,
    volume: float,
    *,
    unknown: str = "",
    at: str = "at rest",
    scenario: Scenario | None = None,
) -> str:
    """Warning if a hull displaces at rest another volume than its database; empty if they agree.

    Parameters
    ----------
    bodies, sea
        See `check_databases`.
    name
        Of a hull.
    volume
        That it displaces at rest [m^3].
    unknown
        What loads it and is not counted in that volume: nothing is refused then.
    at
        Words for the state of which the volume is.
    scenario
        Of the scene: what it tells tanks changes the draught.

    Raises
    ------
    InputError
        If it is another draught.
    """
    radiation = next((one for one in sea.radiation if name in one.bodies), None)
    if radiation is None:
        return ""
    body, row = next(one for one in bodies if one.name == name), radiation.bodies.index(name)
    wanted = _volume(radiation.database, row, body)
    if not wanted > 0.0 or body.hull.restoring is None:
        return ""
    share = volume / wanted - 1.0
    if not abs(share) > (REFUSED if unknown else TOLD):
        return ""
    more = f"{abs(share):.0%} {'more' if share > 0.0 else 'less'}"
    problem = f"{name!r} displaces {volume:.5g} m3 {at}, {more} than the {wanted:.5g} m3 of its database"
    if abs(share) > REFUSED and not (unknown or _in_numbers(body) or _pumped(sea, name, scenario)):
        raise InputError(
            problem,
            source=radiation.database.source,
            key="mass",
            expected="a database of this draught, within 20 %; or the mass, tanks and loads that it was computed for",
        )
    return f"{problem} ({radiation.database.source})" + (f"; not counted: {unknown}" if unknown else "")


def _pumped(sea: Sea, name: str, scenario: Scenario | None) -> bool:
    """Whether tanks of a hull fill or empty, so that its draught at the start is not that of the database."""
    of_pumps = {end for pump in sea.pumps for end in (pump.source, pump.target)}
    if scenario is not None:
        of_pumps |= {
            one.name for one in scenario.commands if one.actuates == "tank" and one.operation in MOVES
        }
    return any(
        tank.hull == name and (tank.name in of_pumps or len(tank.schedule[0]) > 1) for tank in sea.tanks
    )


def check_rest(
    kinds: Iterable[Any],
    names: Sequence[str],
    bodies: Sequence[FloatingBody],
    sea: Sea,
    scenario: Scenario | None = None,
) -> list[str]:
    """Compare what hulls displace in an equilibrium, with all that loads them, with their databases.

    Parameters
    ----------
    kinds
        Of the bodies of a packed scene that is at rest.
    names
        Of its bodies, by number.
    bodies, sea
        See `check_databases`.
    scenario
        Of the scene.

    Returns
    -------
    list
        Sentences about what differs and is not refused.

    Raises
    ------
    InputError
        If a hull lies at another draught than in its database.
    """
    found = []
    for kind in kinds:
        if not kind.FLOATS:
            continue
        for row, table in enumerate(kind.table):
            volume = float(kind.stage[row].lift[2]) / kind.water.weight
            found.append(weight_words(bodies, sea, names[table.number], volume, scenario=scenario))
    return [words for words in found if words]
