"""What hulls, tanks and water must fulfil to be packed; why a hull left what its database covers, in words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import rotation_matrix
from heavylift.numerics.words import check_word
from heavylift.solver.interface import Bodies
from heavylift.solver.scene.ballast import check_ballast
from heavylift.solver.scene.sea import Excitation, Memory

if TYPE_CHECKING:
    from heavylift.solver.scene.sea import FloatingBody, Radiation, Sea, Water

__all__ = [
    "check_places",
    "check_sea",
    "check_water",
    "left_because",
]


PLACE_SHARE, PLACE_TOLERANCE = 0.05, 0.5
"""How far interacting hulls may start from their places in the database: a share of their distance, and metres."""

YAW_TOLERANCE = np.radians(5.0)
"""How far they may be turned against each other."""


def check_sea(sea: Sea) -> None:
    """Words and names of a sea.

    Raises
    ------
    InputError
        For a word that is no option, a name that is used twice, or waves that nothing feels.
    """
    check_water(sea.water)
    check_word(sea.excitation, Excitation, source="sea", key="excitation")
    if not 0.0 <= sea.ramp < np.inf:
        raise InputError(f"{sea.ramp:g} s", source="sea", key="ramp", expected="0 s or more")
    for radiation in sea.radiation:
        check_word(radiation.memory, Memory, source=radiation.database.source, key="memory")
        if sea.waves is not None and not radiation.database.has_excitation:
            raise InputError(
                f"waves for {', '.join(radiation.bodies)}, of whose database there is radiation alone",
                source=radiation.database.source,
                key="waves",
                expected="a database with exciting forces, or a sea without waves",
            )
    check_ballast(sea)
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
    if not np.isfinite(water.level):
        raise InputError(f"{water.level}", source="sea", key="level", expected="a finite height")


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
        if not kind.FLOATS:
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
                    f"it displaces {volume:.3g} m3 and is almost out of the water",
                    "lower waves, the right mass, or no database for a hull that leaves the water",
                )
            if least > 0.0:
                return (
                    "it is completely submerged",
                    "lower waves, more freeboard or stability, the right mass, or no database for a hull that sinks",
                )
    return "", "a database that covers the motion"
