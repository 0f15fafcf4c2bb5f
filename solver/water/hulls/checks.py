"""What hulls, tanks and water must fulfil to be packed; why a hull left what its database covers, in words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import records
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.interface import Bodies
from heavylift.solver.water.hulls.clipping import Clip, clip_surface_now

if TYPE_CHECKING:
    from heavylift.solver.scene.sea import FloatingBody, Hull, Radiation, Sea, Tank, Water

__all__ = [
    "check_hull_numbers",
    "check_places",
    "check_sea",
    "check_tank",
    "check_volume",
    "check_water",
    "left_because",
]


PLACE_SHARE, PLACE_TOLERANCE = 0.05, 0.5
"""How far interacting hulls may start from their places in the database: a share of their distance, and metres."""

YAW_TOLERANCE = np.radians(5.0)
"""How far they may be turned against each other."""

VOLUME_TOLERANCE = 0.1
"""Of the volume of a database, that a hull may displace more or less with its reference point where that is there."""

UNSYMMETRIC = 1e-6


def _finite(values: ArrayLike, shape: tuple[int, ...], source: str, key: str) -> NDArray[np.float64]:
    """An array of a shape, without holes."""
    given = np.asarray(values, dtype=np.float64)
    if given.shape != shape or not np.all(np.isfinite(given)):
        raise InputError(
            f"{given.tolist()}", source=source, key=key, expected=f"finite numbers, shape {shape}"
        )
    return given


def check_sea(sea: Sea) -> None:
    """Words and names of a sea.

    Raises
    ------
    InputError
        For a word that is no option, a name that is used twice, or waves that nothing feels.
    """
    check_water(sea.water)
    if sea.excitation not in {"summed", "series"}:
        raise InputError(f"{sea.excitation!r}", source="sea", key="excitation", expected="summed or series")
    if not 0.0 <= sea.ramp < np.inf:
        raise InputError(f"{sea.ramp:g} s", source="sea", key="ramp", expected="0 s or more")
    for radiation in sea.radiation:
        if radiation.memory not in {"exponentials", "direct", "none"}:
            raise InputError(
                f"{radiation.memory!r}",
                source=radiation.database.source,
                key="memory",
                expected="exponentials, direct or none",
            )
    names = [tank.name for tank in sea.tanks]
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise InputError(
            f"two tanks {twice[0]!r}", source="sea", key="tanks", expected="a name of its own for each"
        )
    with_waves = {name for radiation in sea.radiation for name in radiation.bodies}
    if sea.waves is not None and sea.hulls and not with_waves:
        raise InputError(
            f"no database for {sea.hulls[0].body!r}",
            source="sea",
            key="waves",
            expected="a database for at least one hull, or a sea without waves",
        )


def check_water(water: Water) -> None:
    """Refuse water that is none."""
    for key in ("density", "gravity", "depth"):
        value = getattr(water, key)
        if not (value > 0.0 and (np.isfinite(value) or key == "depth")):
            raise InputError(f"{value:g}", source="sea", key=key, expected="a positive number")
    _finite(water.level, (), "sea", "level")


def check_hull_numbers(hull: Hull) -> None:
    """Shapes and numbers of a hull, and damping that dissipates.

    Raises
    ------
    InputError
        If not.
    """
    _finite(hull.reference, (3,), hull.body, "reference")
    D = _finite(hull.damping, (6, 6), hull.body, "damping")
    quadratic = _finite(hull.quadratic_damping, (6,), hull.body, "quadratic_damping")
    size = float(np.abs(D).max())
    if np.abs(D - D.T).max() > UNSYMMETRIC * size or np.linalg.eigvalsh(D)[0] < -1e-9 * size:
        raise InputError(
            f"{D.tolist()}",
            source=hull.body,
            key="damping",
            expected="a symmetric matrix that dissipates in every direction",
        )
    if np.any(quadratic < 0.0):
        raise InputError(
            f"{quadratic.tolist()}", source=hull.body, key="quadratic_damping", expected="0 or more each"
        )
    if not 0.0 < hull.low_pass < np.inf:
        raise InputError(
            f"{hull.low_pass} rad/s", source=hull.body, key="low_pass", expected="a positive frequency"
        )


def check_tank(tank: Tank) -> None:
    """Refuse a tank without a place or a schedule.

    Raises
    ------
    InputError
        If a number is missing, times do not increase, or a mass or free surface is negative.
    """
    _finite(tank.point, (3,), tank.name, "point")
    surface = _finite(tank.free_surface, (2,), tank.name, "free_surface")
    if np.any(surface < 0.0):
        raise InputError(
            f"{surface.tolist()}", source=tank.name, key="free_surface", expected="0 or more about each axis"
        )
    times, masses = np.atleast_1d(tank.times).astype(float), np.atleast_1d(tank.masses).astype(float)
    good = times.ndim == 1 and times.shape == masses.shape and len(times) > 0
    if not (good and np.all(np.isfinite(times)) and np.all(np.diff(times) > 0.0) and np.all(masses >= 0.0)):
        raise InputError(
            f"times {times.tolist()}, masses {masses.tolist()}",
            source=tank.name,
            key="masses",
            expected="increasing times with one mass of 0 or more each",
        )
    _finite(masses, masses.shape, tank.name, "masses")


def check_places(radiation: Radiation, hulls: Sequence[FloatingBody]) -> None:
    """Coefficients of hulls that interact hold near the relative places and headings that they were computed for.

    Raises
    ------
    InputError
        If a hull starts elsewhere, or turned.
    """
    database = radiation.database
    yaws = []
    for body in hulls:
        R = rotation_matrix(body.orientation)
        yaws.append(np.arctan2(R[1, 0], R[0, 0]))
    c, s = np.cos(yaws[0]), np.sin(yaws[0])
    turned = np.array([[c, s], [-s, c]])
    starts = [body.position + rotation_matrix(body.orientation) @ body.hull.reference for body in hulls]
    for body, start, yaw, wanted in zip(hulls, starts, yaws, database.reference_points, strict=True):
        place = turned @ (start - starts[0])[:2]
        offset = wanted[:2] - database.reference_points[0, :2]
        if np.linalg.norm(place - offset) > PLACE_SHARE * np.linalg.norm(offset) + PLACE_TOLERANCE:
            raise InputError(
                f"{body.name!r} starts at {np.round(place, 3).tolist()} m from {hulls[0].name!r}",
                source=database.source,
                key="reference_points",
                expected=f"about {np.round(offset, 3).tolist()} m, for which the database was computed",
            )
        turn = np.angle(np.exp(1j * (yaw - yaws[0])))
        if abs(turn) > YAW_TOLERANCE:
            raise InputError(
                f"{body.name!r} starts turned by {np.degrees(turn):.3g} deg against {hulls[0].name!r}",
                source=database.source,
                key="hulls",
                expected="hulls along the axes of the database that they share",
            )


def check_volume(
    radiation: Radiation,
    row: int,
    body: FloatingBody,
    points: NDArray[np.float64],
    triangles: NDArray[np.int64],
    to_body: NDArray[np.float64],
    reference: NDArray[np.float64],
) -> None:
    """Upright, with its reference point where the database has it, a hull displaces what the database says.

    Parameters
    ----------
    radiation, row, body
        Database, place of the hull in it, the hull.
    points, triangles
        Surface in principal axes through the centre of mass [m].
    to_body
        Rotation from these axes to those of the body, shape (3, 3).
    reference
        Reference point in principal axes [m].

    Raises
    ------
    InputError
        If not: the reference point is another one, or the database is of another draught.
    """
    database = radiation.database
    if database.volumes is None:
        return
    out, height = records(Clip, 1), float(database.reference_points[row, 2] - (to_body @ reference)[2])
    clip_surface_now(points, triangles, np.ravel(to_body), height, np.zeros_like(points), out)
    wanted = float(database.volumes[row])
    if abs(out[0].volume - wanted) > VOLUME_TOLERANCE * wanted:
        raise InputError(
            f"{body.name!r} displaces {out[0].volume:.5g} m3 with its reference point at the height of the database",
            source=database.source,
            key="reference",
            expected=f"about {wanted:.5g} m3: the reference point and draught of the database",
        )


# ---- during a run ----


def left_because(bodies: Bodies, number: int) -> tuple[str, str]:
    """What happened, and what may help.

    Parameters
    ----------
    bodies
        Kinds of a scene after a step that was refused.
    number
        Of the hull.
    """
    for kind in bodies:
        if "hulls" not in kind._fields:
            continue
        for row in np.flatnonzero(kind.table["number"] == number):
            volume, least = kind.stage[row].clip.volume, kind.hulls[row].least_volume
            if np.isnan(kind.vectors.wave[6 * row : 6 * row + 6]).any():
                turned = math.degrees(kind.stage[row].heading)
                return (
                    f"no wave force is known at a heading of {turned:.3g} deg at this time",
                    "a database with more headings, or a longer series of waves",
                )
            if least > 0.0 and volume < least:
                return (
                    f"it displaces {volume:.3g} m3 and is as good as out of the water",
                    "lower waves, the right mass, or no database for a hull that leaves the water",
                )
            if least > 0.0:
                return (
                    "it is wholly under water",
                    "lower waves, more freeboard or stability, the right mass, or no database for a hull that sinks",
                )
    return "", "a database that covers the motion"
