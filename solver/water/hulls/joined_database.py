"""One hydrodynamic database of all bodies of a scene, from those of its hulls."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase, over_full_circle
from heavylift.solver.water.waves.spectra import dispersion
from heavylift.solver.water.waves.wave_transfer import excitation_at

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.solver.scene.sea import Radiation

__all__ = ["joined_database"]


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
