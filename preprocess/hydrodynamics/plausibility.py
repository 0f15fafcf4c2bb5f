"""Relations between the numbers of a database that hold whatever the hull: what contradicts them is refused.

Each relation sees some errors and not others:

* The added mass of a coordinate is positive at most frequencies. It may be negative where water between or within hulls
  resonates, so a single negative value gives no information; a sign that is turned is seen.
* What changes from one frequency to its neighbours by the same factor in all coordinates is a factor on that frequency.
  A resonance changes the coordinates by different factors, so it is none; an error of one coordinate alone is not seen,
  nor one at the first two and the last two frequencies.
* Haskind's relation: the waves that a motion radiates carry the energy that its damping takes, and excite it as much,

      B_ii = k / (8 pi rho g c_g) int |X_i|^2 d(heading),        c_g the group velocity.

  It sees a factor on excitation or damping and forces that stand for other coordinates, and no error of a phase. With
  headings all around it holds exactly, as long as they resolve how fast the forces change with the heading: |X|^2 of a
  hull of length L has harmonics up to about k L, and n headings integrate those below n. With a few of them the
  integral is estimated in long waves, in which a force goes like the slope of the wave along its coordinate, or is the
  same for all headings (heave).
* In long waves a hull feels the water's weight and acceleration: heave is in phase with the wave (or opposite, below
  the water), surge and sway a quarter of a period apart, and heave is rho g times the water plane. It sees a phase that
  is turned, and nothing if the database has no wave that is long. Weight and acceleration are opposite: columns on
  pontoons have small heave forces already in long waves, so heave is not judged where the acceleration counts.

Source: Faltinsen, *Sea Loads on Ships and Offshore Structures* (1990), chapter 3; Newman, "The exciting forces on fixed
bodies in waves", J. Ship Res. 6 (1962).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import (
    coordinate_name,
    length_scales,
    mass_scales,
    over_full_circle,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase

__all__ = [
    "check_long_waves",
    "check_plausibility",
    "group_velocity",
    "haskind_damping",
    "outlying_frequencies",
]

FELT = 0.01
"""Of the mass of the hull and the water with it: an added mass below it has no sign that counts."""
MOST = 0.5
"""Share of the frequencies at which an added mass may be negative."""

FACTOR = 1.6
"""Of all coordinates at one frequency against its neighbours."""
SAME, STEADY = 1.12, 1.3
"""How far the factors of coordinates, and the values on both sides from those further away, may differ."""
COORDINATES_TOGETHER = 3
SEEN = 0.03
"""Of the largest of all frequencies: smaller values are not compared."""

WIDEST_STEP = np.deg2rad(46.0)
"""Between headings that stand for all around."""
HARMONICS = 3
"""Of |X|^2 beyond k L, which headings have to resolve too."""
SHORT = 8.0 * np.pi
"""Of k L: a quarter of the length of the hull; in shorter waves panels do not give forces and damping well."""
HASKIND = 2.0
"""Factor between damping and that of the excitation; as a median over the frequencies."""
RADIATING = 0.1
"""Of the largest damping of a coordinate: where there is less, panels do not give it well."""

LONG, LONGER = 1.5, 0.6
"""Of k L, L the length of a bar with the gyradius of the added mass: the shape of forces, and their phases."""
SLOPE = 1.0
"""Ratio of the wrong to the right part of a force in a long wave: half a right angle."""
WATER_PLANE = 2.0
"""Factor between heave in a long wave and the stiffness of the water plane."""
ACCELERATION = 0.5
"""Share of that stiffness which the acceleration of hull and water may take for heave to be judged."""


def check_plausibility(database: HydrodynamicDatabase) -> None:
    """Refuse numbers that contradict each other.

    Raises
    ------
    InputError
        The first of: added mass of the wrong sign, a factor on one frequency, excitation that does not belong to the
        damping, phases or sizes in long waves that no hull has.
    """
    _check_signs(database)
    _check_outliers(database)
    if database.has_excitation and np.any(database.excitation):
        _check_haskind(database)
        check_long_waves(database)


def _check_signs(database: HydrodynamicDatabase) -> None:
    own = np.diagonal(database.added_mass, axis1=1, axis2=2)
    negative = (own < -FELT * mass_scales(database)).mean(axis=0)
    worst = int(np.argmax(negative))
    if negative[worst] > MOST:
        raise InputError(
            f"of {coordinate_name(database, worst)} it is negative at {negative[worst]:.0%} of the frequencies",
            source=database.source,
            key="added_mass",
            expected="a positive one, but where water resonates (is its sign turned?)",
        )


def outlying_frequencies(
    omega: NDArray[np.float64], values: NDArray[np.float64], largest: NDArray[np.float64]
) -> list[tuple[int, float]]:
    """Frequencies at which all that is large differs from its neighbours by the same factor.

    Parameters
    ----------
    omega
        Shape (nw,).
    values
        Not negative, shape (nw, m).
    largest
        What a value is small or large against, shape (m,).

    Returns
    -------
    list
        Place and factor of each; the first and the last two frequencies have no neighbours to tell.
    """
    found = []
    positive = np.log(np.maximum(values, np.finfo(np.float64).tiny))

    def between(low: int, high: int, at: int) -> NDArray[np.float64]:
        share = np.log(omega[at] / omega[low]) / np.log(
            omega[high] / omega[low]
        )  # exact for powers, as in long waves
        return np.asarray((1.0 - share) * positive[low] + share * positive[high])

    for at in range(2, len(omega) - 2):
        around = [at - 2, at - 1, at + 1, at + 2]
        near, far = between(at - 1, at + 1, at), between(at - 2, at + 2, at)
        # what is large around, and changes so little that its neighbours say what it is
        seen = (
            (values[around].min(axis=0) > SEEN * largest)
            & (values[at] > 0.0)
            & (np.abs(near - far) < np.log(STEADY))
        )
        if seen.sum() < COORDINATES_TOGETHER:
            continue
        factors = (positive[at] - near)[seen]
        factor = float(np.median(factors))
        if np.abs(factors - factor).max() < np.log(SAME) and abs(factor) > np.log(FACTOR):
            found.append((at, float(np.exp(factor))))
    return found


def _check_outliers(database: HydrodynamicDatabase) -> None:
    count = len(database.omega)
    kinds = {
        "added_mass": np.abs(np.diagonal(database.added_mass, axis1=1, axis2=2)),
        "damping": np.abs(np.diagonal(database.damping, axis1=1, axis2=2)),
        "excitation": np.abs(database.excitation).reshape(count, -1),
    }
    for key, values in kinds.items():
        largest = values.max(axis=0)
        if (
            key == "excitation" and largest.size
        ):  # of a coordinate over all headings: across the wave there is none
            largest = np.tile(
                largest.reshape(-1, values.shape[1] // database.headings.size).max(axis=0),
                len(database.headings),
            )
        for at, factor in outlying_frequencies(database.omega, values, largest):
            omega = database.omega[at]
            raise InputError(
                f"at {omega:.4g} rad/s all of it is {factor:.2g} times the value of the adjacent frequencies",
                source=database.source,
                key=key,
                expected=f"one that changes steadily; 'leave_out = [{omega:.4g}]' if that is all that is wrong",
            )


def group_velocity(database: HydrodynamicDatabase) -> NDArray[np.float64]:
    """(nw,) velocity [m/s] with which the energy of waves travels at this depth."""
    k = database.wave_numbers()
    depth = k * database.depth
    with np.errstate(over="ignore"):
        shallow = np.where(depth < 300.0, 2.0 * depth / np.sinh(np.minimum(2.0 * depth, 600.0)), 0.0)
    return np.asarray(0.5 * database.omega / k * (1.0 + shallow))


def haskind_damping(database: HydrodynamicDatabase) -> NDArray[np.float64]:
    """(nw, 6N) damping of each coordinate by Haskind's relation; NaN where the headings do not tell.

    With headings all around it is the integral over them, in waves whose forces they resolve; else in long waves that
    of the shape that the force has there: cos^2 of surge and pitch, sin^2 of sway and roll, the same for all headings
    of heave.
    """
    k = database.wave_numbers()
    scale = k / (8.0 * np.pi * database.density * database.gravity * group_velocity(database))
    whole = over_full_circle(database)
    headings = np.mod(whole.headings, 2.0 * np.pi)
    order = np.argsort(headings)
    headings = headings[order]
    squares = np.abs(whole.excitation[:, order]) ** 2
    kept = np.concatenate([[True], np.diff(headings) > 1e-9])  # 0 and 360 degrees are one
    headings, squares = headings[kept], squares[:, kept]
    gaps = (
        np.diff(np.append(headings, headings[0] + 2.0 * np.pi))
        if len(headings) > 1
        else np.array([2.0 * np.pi])
    )
    if gaps.max() <= WIDEST_STEP:
        weights = 0.5 * (gaps + np.roll(gaps, 1))
        found = scale[:, None] * np.einsum("h,whi->wi", weights, squares)
        resolved = min(2.0 * np.pi / gaps.max() - HARMONICS, SHORT)
        found[k * (_length(database) + _widest(database)) > resolved] = np.nan
        return np.asarray(found)
    cosine, sine = np.cos(headings) ** 2, np.sin(headings) ** 2
    shapes = np.stack([cosine, sine, np.ones_like(cosine), sine, cosine, 0.0 * cosine], axis=1)
    shapes = np.tile(shapes, database.body_count)
    integrals = np.tile([np.pi, np.pi, 2.0 * np.pi, np.pi, np.pi, np.nan], database.body_count)
    best = np.argmax(shapes, axis=0)
    at_best = shapes[best, np.arange(len(best))]
    found = np.where(at_best > 0.5, squares[:, best, np.arange(len(best))] / np.maximum(at_best, 0.5), np.nan)
    found = scale[:, None] * found * integrals
    found[k * _length(database) > LONG] = np.nan
    return np.asarray(found)


def _length(database: HydrodynamicDatabase) -> float:
    """Length of a bar that has the largest gyradius of the added mass [m]."""
    smallest = float(length_scales(database).min())
    return np.inf if not smallest > 0.0 else float(np.sqrt(12.0) / smallest)


def _widest(database: HydrodynamicDatabase) -> float:
    """Largest distance between the reference points of hulls [m]."""
    points = database.reference_points[:, :2]
    return float(np.linalg.norm(points[:, None] - points[None], axis=2).max())


def _check_haskind(database: HydrodynamicDatabase) -> None:
    own = np.diagonal(database.damping, axis1=1, axis2=2)
    by_waves = haskind_damping(database)
    # a coordinate that makes hardly any waves against those of its hull gives no information, as yaw of a round one
    scales = length_scales(database) ** 2
    largest = (own * scales).max(axis=0)
    of_hull = np.repeat(largest.reshape(-1, 6).max(axis=1), 6)
    for i in range(own.shape[1]):
        if not largest[i] > FELT * of_hull[i]:
            continue
        usable = np.isfinite(by_waves[:, i]) & (own[:, i] > RADIATING * own[:, i].max())
        if usable.sum() < COORDINATES_TOGETHER:
            continue
        ratio = float(np.median(by_waves[usable, i] / own[usable, i]))
        if not 1.0 / HASKIND <= ratio <= HASKIND:
            raise InputError(
                f"of {coordinate_name(database, i)}: the waves that it would radiate by Haskind's relation take "
                f"{ratio:.2g} times the damping of the database",
                source=database.source,
                key="excitation",
                expected=f"excitation and damping that belong together (a factor {np.sqrt(ratio):.2g} on the forces, "
                "coordinates that are exchanged, another amplitude?)",
            )


def check_long_waves(database: HydrodynamicDatabase) -> None:
    """Refuse forces in the longest wave of a phase, or of a size against the water plane, that no hull has.

    Nothing is checked where that wave is not long against the hulls, nor without exciting forces.

    Raises
    ------
    InputError
        Names hull, wave and what is expected.
    """
    if not (database.has_excitation and np.any(database.excitation)):
        return
    k = float(database.wave_numbers()[0])
    if k * _length(database) > LONGER:
        return
    force = database.excitation_at_reference_points()[0]
    along = (
        np.cos(database.headings)[:, None] * force[:, 0::6]
        + np.sin(database.headings)[:, None] * force[:, 1::6]
    )
    for body, name in enumerate(database.bodies):
        heave = complex(force[:, 6 * body + 2].sum())
        horizontal = complex(along[:, body].sum())
        of_hull = f" of {name!r}" if database.body_count > 1 else ""
        plane = 0.0
        if database.hydrostatic_stiffness is not None:
            plane = float(database.hydrostatic_stiffness[body, 2, 2])
        inertia = float(database.omega[0] ** 2 * mass_scales(database)[6 * body + 2])
        little = (
            inertia > ACCELERATION * plane > 0.0
        )  # weight and acceleration of the water leave little heave
        for what, wrong, right, usable in (
            ("heave", abs(heave.imag), abs(heave.real), not little),
            ("the force along the wave", abs(horizontal.real), abs(horizontal.imag), True),
        ):
            if usable and wrong > SLOPE * right:
                raise InputError(
                    f"in the longest wave, {2.0 * np.pi / k:.3g} m, {what}{of_hull} is "
                    f"{np.rad2deg(np.arctan2(wrong, right)):.0f} deg off the phase that a small hull has",
                    source=database.source,
                    key="excitation",
                    expected="phases relative to a crest at the origin of the database: heave in phase with the wave, "
                    "surge and sway a quarter of a period from it",
                )
        size = float(np.abs(force[:, 6 * body + 2]).mean())
        if plane > 0.0 and not little and not 1.0 / WATER_PLANE <= size / plane <= WATER_PLANE:
            raise InputError(
                f"in the longest wave, {2.0 * np.pi / k:.3g} m, heave{of_hull} is {size:.4g} N/m, "
                f"{size / plane:.2g} times the stiffness of the water plane, {plane:.4g} N/m",
                source=database.source,
                key="excitation",
                expected="about as much: rho g times the water plane",
            )
