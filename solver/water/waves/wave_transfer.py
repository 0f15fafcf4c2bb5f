"""What a hydrodynamic database says at frequencies and headings between its own.

The excitation is taken relative to a crest at the reference point of each hull: only then does it vary slowly
enough with frequency and heading for cubic splines on its real and imaginary part. Amplitude and phase are never
interpolated apart: where an amplitude passes zero the phase jumps.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase, over_full_circle
from heavylift.solver.water.waves.spectra import dispersion
from heavylift.solver.water.waves.wave_trains import WaveTrains

__all__ = [
    "ENERGY_OUTSIDE",
    "HEADING_HOLD",
    "HeadingTable",
    "components_inside",
    "drift_table",
    "excitation_at",
    "excitation_table",
]

ENERGY_OUTSIDE = 0.01
"""Part of the variance of the elevation that may lie outside the range of a database; it is left out."""

HEADING_HOLD = np.deg2rad(5.0)
"""How far beyond the first and last heading of a database that does not go round its values are held [rad]."""

DEPTH_TOLERANCE = 0.02
"""Relative difference of wave numbers from which on the sea is not the one of the database."""

FINEST = np.deg2rad(2.5)
"""Of the uniform grid onto which unequally spaced headings are brought [rad]."""


@dataclass(frozen=True, eq=False)
class HeadingTable:
    """Cubic Hermite pieces over headings on a uniform grid: exactly the spline through equally spaced headings.

    Attributes
    ----------
    start, spacing
        First heading and distance of the next [rad].
    cells
        Number of pieces.
    span
        From the first to the last heading [rad]; zero for a single one.
    periodic
        Whether the last node is the first one, a full turn later.
    values, slopes
        At the nodes, slopes per spacing; shape (m, cells + 1, n), complex for excitation.
    """

    start: float
    spacing: float
    cells: int
    span: float
    periodic: bool
    values: NDArray[np.complex128]
    slopes: NDArray[np.complex128]

    def at(self, heading: ArrayLike) -> NDArray[np.complex128]:
        """Values at one heading [rad] for each of the m rows (or one for all), shape (m, n).

        Raises
        ------
        InputError
            If the headings do not go round and one lies more than 5 degrees outside.
        """
        beta = np.broadcast_to(np.asarray(heading, dtype=np.float64), (len(self.values),))
        offset = heading_offset(self, beta)
        if not self.periodic and np.any((offset < -HEADING_HOLD) | (offset > self.span + HEADING_HOLD)):
            raise InputError(
                f"a relative heading of {np.rad2deg(beta[np.argmax(np.abs(offset))]):.1f} deg",
                key="headings",
                expected=heading_words(self),
            )
        return self.with_rates(beta)[0]

    def with_rates(
        self, heading: NDArray[np.float64], columns: slice = slice(None)
    ) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Values and their rates over the heading [1/rad] at one heading for each row, held beyond the ends.

        Parameters
        ----------
        heading
            [rad], shape (m,).
        columns
            Of the n values.
        """
        offset = heading_offset(self, heading)
        place = np.clip(offset / self.spacing, 0.0, self.cells)
        cell = np.minimum(place.astype(np.int64), self.cells - 1)
        s = (place - cell)[:, None]
        rows = np.arange(len(heading))
        before, after = self.values[rows, cell, columns], self.values[rows, cell + 1, columns]
        slope, slope_after = self.slopes[rows, cell, columns], self.slopes[rows, cell + 1, columns]
        values = (
            (1.0 + 2.0 * s) * (1.0 - s) ** 2 * before
            + s * (1.0 - s) ** 2 * slope
            + s**2 * (3.0 - 2.0 * s) * after
            + s**2 * (s - 1.0) * slope_after
        )
        rates = (
            6.0 * s * (1.0 - s) * (after - before)
            + (1.0 - s) * (1.0 - 3.0 * s) * slope
            + s * (3.0 * s - 2.0) * slope_after
        ) / self.spacing
        held = (offset < 0.0) | (offset > self.span + 1e-12)
        return values, np.where(held[:, None], 0.0, rates)


def excitation_table(database: HydrodynamicDatabase, omega: ArrayLike) -> HeadingTable:
    """Excitation relative to the reference points, over all headings, at given frequencies.

    Parameters
    ----------
    database
        Coefficients.
    omega
        Within the range of the database [rad/s], shape (m,).

    Raises
    ------
    InputError
        If a frequency is outside, or there is no excitation.
    """
    if not database.has_excitation:
        raise InputError(
            "no exciting forces, radiation alone",
            source=database.source,
            key="excitation",
            expected="a database with exciting forces for motions in waves",
        )
    full = over_full_circle(database)
    return _table(
        full, full.excitation_at_reference_points(), np.atleast_1d(np.asarray(omega, dtype=np.float64))
    )


def drift_table(database: HydrodynamicDatabase, omega: ArrayLike) -> HeadingTable | None:
    """Mean drift per amplitude squared over all headings at given frequencies, or None; see `excitation_table`."""
    full = over_full_circle(database)
    if full.drift is None:
        return None
    return _table(full, full.drift.astype(np.complex128), np.atleast_1d(np.asarray(omega, dtype=np.float64)))


def excitation_at(
    database: HydrodynamicDatabase, omega: ArrayLike, heading: ArrayLike
) -> NDArray[np.complex128]:
    """Excitation per metre of amplitude relative to a crest at the reference point of each hull.

    Parameters
    ----------
    database
        Coefficients.
    omega
        Frequencies [rad/s], shape (m,).
    heading
        Direction of propagation relative to the hulls [rad], one or shape (m,).

    Returns
    -------
    NDArray
        [N, N m], shape (m, 6 N).

    Raises
    ------
    InputError
        If a frequency or heading is outside the database.
    """
    return excitation_table(database, omega).at(heading)


def components_inside(
    database: HydrodynamicDatabase, trains: WaveTrains, yaws: ArrayLike
) -> NDArray[np.bool_]:
    """Which components of a sea the database covers; the others are left out if they carry no energy.

    Parameters
    ----------
    database
        Coefficients.
    trains
        Sea.
    yaws
        Of the hulls [rad], shape (N,).

    Returns
    -------
    NDArray
        Shape (m,). Outside lies at most 1 % of the variance.

    Raises
    ------
    InputError
        If more lies outside the frequencies or the headings of the database, or if its wave numbers are of
        another depth.
    """
    energy = 0.5 * trains.amplitude**2
    total = float(np.sum(energy))
    low, high = float(database.omega[0]), float(database.omega[-1])
    inside = (trains.omega >= low * (1.0 - 1e-9)) & (trains.omega <= high * (1.0 + 1e-9))
    lost = float(np.sum(energy[~inside])) / total
    if lost > ENERGY_OUTSIDE:
        periods = 2.0 * np.pi / trains.omega
        raise InputError(
            f"{lost:.1%} of the energy of the waves ({trains.description}; {periods.min():.3g} to {periods.max():.3g} s"
            f", {trains.omega.min():.3g} to {trains.omega.max():.3g} rad/s) lies outside the frequencies",
            source=database.source,
            key="omega",
            expected=f"waves of {2.0 * np.pi / high:.3g} to {2.0 * np.pi / low:.3g} s ({low:.3g} to {high:.3g} rad/s), "
            f"a database that covers them, or a frequency_range of the sea; {ENERGY_OUTSIDE:.0%} may be left out",
        )
    other = dispersion(trains.omega, database.depth, database.gravity)
    worst = float(np.max(np.where(inside, np.abs(other / trains.wavenumber - 1.0), 0.0)))
    if worst > DEPTH_TOLERANCE:
        raise InputError(
            f"its wave numbers (depth {database.depth:g} m) differ by {worst:.0%} from those of the sea "
            f"(depth {trains.depth:g} m)",
            source=database.source,
            key="depth",
            expected="a database of the same water depth",
        )
    table = _table(over_full_circle(database), None, database.omega[:1])
    if not table.periodic:
        reached = np.ones(len(inside), dtype=np.bool_)
        for yaw in np.atleast_1d(np.asarray(yaws, dtype=np.float64)):
            offset = heading_offset(table, trains.direction - yaw)
            reached &= (offset >= -HEADING_HOLD) & (offset <= table.span + HEADING_HOLD)
        lost = float(np.sum(energy[~reached])) / total
        if lost > ENERGY_OUTSIDE:
            relative = np.rad2deg(trains.direction[~reached][0] - np.atleast_1d(yaws))
            raise InputError(
                f"{lost:.1%} of the energy of the waves meets a hull from a heading outside "
                f"(e.g. {', '.join(f'{one:.1f}' for one in relative)} deg)",
                source=database.source,
                key="headings",
                expected=heading_words(table),
            )
        inside &= reached
    return np.asarray(inside)


def heading_offset(table: HeadingTable, heading: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angle from the first heading [rad]: 0 to 2 pi if they go round, else on the side that is nearer."""
    shift = 0.0 if table.periodic else 0.5 * (2.0 * np.pi - table.span)
    return np.asarray(np.mod(heading - table.start + shift, 2.0 * np.pi) - shift)


def heading_words(table: HeadingTable) -> str:
    """The range of a table, for messages."""
    if table.periodic:
        return "any heading"
    first, last = np.rad2deg(table.start), np.rad2deg(table.start + table.span)
    beyond = np.rad2deg(HEADING_HOLD)
    return f"headings from {first:.1f} to {last:.1f} deg (up to {beyond:.0f} deg beyond), or more of them in the file"


def _table(
    full: HydrodynamicDatabase, quantity: NDArray[np.complex128] | None, omega: NDArray[np.float64]
) -> HeadingTable:
    """Splines over frequency, then over headings; without a quantity only the grid of headings.

    Short waves push on the end of a hull that they meet, so that relative to the middle the phase turns by
    ``omega L / g`` times the spacing of the frequencies from one to the next. Splines need that below one radian where
    the waves have energy: for 100 m at 0.05 rad/s up to 2 rad/s.
    """
    from scipy.interpolate import CubicSpline

    order, headings, periodic = _ordered(full.headings)
    if quantity is None:
        values = np.zeros((len(omega), len(headings), 1), dtype=np.complex128)
    else:
        low, high = full.omega[0], full.omega[-1]
        if np.any(omega < low * (1.0 - 1e-9)) or np.any(omega > high * (1.0 + 1e-9)):
            raise InputError(
                f"a frequency of {omega.min():.3g} to {omega.max():.3g} rad/s",
                source=full.source,
                key="omega",
                expected=f"{low:.3g} to {high:.3g} rad/s ({2 * np.pi / high:.3g} to {2 * np.pi / low:.3g} s)",
            )
        if len(full.omega) == 1:
            values = np.repeat(quantity, len(omega), axis=0)[:, order]
        else:
            values = np.asarray(
                CubicSpline(full.omega, quantity[:, order], axis=0)(np.clip(omega, low, high))
            )
    if len(headings) == 1:
        both = np.repeat(values, 2, axis=1)
        return HeadingTable(float(headings[0]), 1.0, 1, 0.0, False, both, np.zeros_like(both))
    nodes = np.append(headings, headings[0] + 2.0 * np.pi) if periodic else headings
    if periodic:
        values = np.concatenate([values, values[:, :1]], axis=1)
    spline = CubicSpline(nodes, values, axis=1, bc_type="periodic" if periodic else "not-a-knot")
    gaps = np.diff(nodes)
    span = float(nodes[-1] - nodes[0])
    if np.ptp(gaps) > 1e-6 * span:
        finest = max(float(gaps.min()), FINEST)
        cells = max(1, int(np.ceil(span / finest - 1e-6)))
    else:
        cells = len(gaps)
    spacing = span / cells
    grid = nodes[0] + spacing * np.arange(cells + 1)
    grid[-1] = nodes[-1]
    return HeadingTable(
        float(nodes[0]),
        spacing,
        cells,
        span,
        periodic,
        np.asarray(spline(grid)),
        spacing * np.asarray(spline(grid, 1), dtype=np.complex128),
    )


def _ordered(headings: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.float64], bool]:
    """Order of the headings after the largest gap, increasing without jumps; whether they go round."""
    wrapped = np.mod(headings, 2.0 * np.pi)
    wrapped[wrapped > 2.0 * np.pi - 1e-6] = 0.0  # 0 and 360 degrees are one
    order = np.argsort(wrapped, kind="stable")
    sorted_ones = wrapped[order]
    different = np.append(True, np.diff(sorted_ones) > 1e-6)
    order, sorted_ones = order[different], sorted_ones[different]
    if len(order) == 1:
        return order, headings[order], False
    gaps = np.diff(np.append(sorted_ones, sorted_ones[0] + 2.0 * np.pi))
    widest = int(np.argmax(gaps))
    periodic = len(order) >= 4 and gaps[widest] < 1.5 * np.max(np.delete(gaps, widest))
    if periodic:
        return order, sorted_ones, True
    first = (widest + 1) % len(order)
    order = np.roll(order, -first)
    values = np.unwrap(np.roll(sorted_ones, -first))
    if values[0] > np.pi:
        values = values - 2.0 * np.pi
    return order, values, False
