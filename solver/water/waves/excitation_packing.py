"""Prepare wave excitation: a sea and a hydrodynamic database become arrays for the kernels of `excitation`."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from heavylift.numerics.derived import derived
from heavylift.numerics.jit import in_python
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import filled_rows
from heavylift.numerics.small import aligned
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
from heavylift.solver.water.waves.excitation import (
    SeriesExcitation,
    SummedExcitation,
    YawTable,
    catmull_rom,
    fill_series,
)
from heavylift.solver.water.waves.wave_trains import WaveTrains
from heavylift.solver.water.waves.wave_transfer import (
    HEADING_HOLD,
    HeadingTable,
    components_inside,
    drift_table,
    excitation_table,
    heading_offset,
)

__all__ = ["SERIES_ERROR", "catmull_rom_error", "pack_series", "pack_summed", "series_step"]

SERIES_ERROR = 2e-4
"""Error of the interpolated series, as part of the standard deviation of each coordinate."""

NARROWEST = 1e-3
"""Range of a table over the yaw [rad] at least."""


def pack_summed(
    trains: WaveTrains,
    database: HydrodynamicDatabase,
    *,
    yaws: ArrayLike,
    ramp: float = 0.0,
    ramp_start: float = 0.0,
    with_drift: bool = False,
    turning: bool = True,
) -> SummedExcitation:
    """Prepare the excitation of hulls that move or yaw.

    Parameters
    ----------
    trains
        Sea.
    database
        Coefficients of the group.
    yaws
        Of the hulls at the start [rad], shape (N,); a database that does not go round must cover them.
    ramp
        Time [s] over which the forces rise from zero with the factor (1 - cos) / 2; one or two peak periods keep
        the start from shaking the hulls. With 0 the full forces act at once.
    ramp_start
        [s]; before it the forces are zero if there is a ramp.
    with_drift
        Add the slowly varying drift of the database.
    turning
        Tabulate over all yaw angles that the database covers; otherwise at the start alone.

    Raises
    ------
    InputError
        If the database does not cover the sea, has no drift, or the number of hulls differs.

    Notes
    -----
    Components outside the range of the database carry at most 1 % of the variance and are left out. The table is over
    the yaw of the hull with half the spacing of the headings, not over headings: then all components, whatever their
    directions, lie in the same piece of it.
    """
    start = np.atleast_1d(np.asarray(yaws, dtype=np.float64))
    if len(start) != database.body_count:
        raise InputError(f"{len(start)} yaw angles for {database.body_count} hulls", source=database.source,
                         key="yaws", expected="one a hull")  # fmt: skip
    if not (ramp >= 0.0 and math.isfinite(ramp)):
        raise InputError(f"ramp of {ramp:g} s", key="ramp", expected=">= 0 s")
    found = derived(_YawTables, _yaw_tables, trains, database, start, with_drift, turning)
    inside = found.inside
    omega, direction = trains.omega[inside], trains.direction[inside]
    wavenumber = trains.wavenumber[inside]
    yaw_rows = filled_rows(
        YawTable,
        first=found.first,
        inverse_spacing=1.0 / found.spacing,
        cells=np.full(len(found.first), found.cells),
        periodic=found.periodic,
    )
    return SummedExcitation(
        omega=_aligned_copy(omega),
        kx=_aligned_copy(wavenumber * np.cos(direction)),
        ky=_aligned_copy(wavenumber * np.sin(direction)),
        phase=_aligned_copy(trains.phase[inside]),
        amplitude=_aligned_copy(trains.amplitude[inside]),
        table=_aligned_copy(found.table),
        drift=_aligned_copy(found.drift),
        yaws=yaw_rows,
        ramp_start=ramp_start,
        ramp_length=ramp,
        cosine=aligned((len(omega),)),
        sine=aligned((len(omega),)),
    )


class _YawTables(NamedTuple):
    """Excitation of each component over the yaw of the hulls.

    Attributes
    ----------
    inside
        Components that the database covers, shape (m,).
    first, spacing, cells, periodic
        Yaw angles of the tables: the first and the spacing of each hull [rad], their number, 1 if they go round.
    table, drift
        Rows of `SummedExcitation`; no rows without drift.
    """

    inside: NDArray[np.bool_]
    first: NDArray[np.float64]
    spacing: NDArray[np.float64]
    cells: int
    periodic: NDArray[np.float64]
    table: NDArray[np.float64]
    drift: NDArray[np.float64]


def _yaw_tables(
    trains: WaveTrains,
    database: HydrodynamicDatabase,
    start: NDArray[np.float64],
    with_drift: bool,
    turning: bool,
) -> _YawTables:
    inside = components_inside(database, trains, start)
    omega = np.clip(trains.omega[inside], database.omega[0], database.omega[-1])
    direction, amplitude = trains.direction[inside], trains.amplitude[inside]
    table = excitation_table(database, omega)
    first, widths, cells_of, periodic = np.array(
        [_yaw_row(table, direction, yaw, turning) for yaw in start]
    ).T
    cells = int(np.max(cells_of))  # one number for all hulls
    spacing = widths / cells
    values, slopes = _over_yaws(table, direction, amplitude, first, spacing, cells)
    packed = np.concatenate([values.real, values.imag, slopes.real, slopes.imag], axis=2)
    drift = np.zeros((0, len(omega)))
    if with_drift:
        over_heading = drift_table(database, omega)
        if over_heading is None:
            raise InputError(
                "has no mean drift",
                source=database.source,
                key="drift",
                expected="a database with drift coefficients, or a scene without drift",
            )
        values, slopes = _over_yaws(over_heading, direction, amplitude, first, spacing, cells)
        drift = np.concatenate([values.real, slopes.real], axis=2).reshape(-1, len(omega))
    return _YawTables(inside, first, spacing, cells, periodic, packed.reshape(-1, len(omega)), drift)


def pack_series(
    trains: WaveTrains,
    database: HydrodynamicDatabase,
    *,
    places: ArrayLike,
    duration: float,
    start: float = 0.0,
    ramp: float = 0.0,
    with_drift: bool = False,
    step: float | None = None,
) -> SeriesExcitation:
    """Prepare the excitation of hulls that keep their place and heading: sums once, interpolates in the steps.

    Parameters
    ----------
    trains, database, ramp, with_drift
        As in `pack_summed`; the ramp begins at the start.
    places
        x, y [m] and yaw [rad] of the hulls, shape (N, 3).
    duration
        Time [s] that the series must cover; beyond it the interpolation gives NaN, which stops a run.
    start
        First time [s].
    step
        Of the grid [s]; by default the longest with an error of 2e-4 of the standard deviation of every
        coordinate, at most 0.1 s.

    Raises
    ------
    InputError
        As `pack_summed`, or if the duration or step is not positive.
    """
    place = np.ascontiguousarray(np.asarray(places, dtype=np.float64).reshape(-1, 3))
    if not (duration > 0.0 and math.isfinite(duration)) or (step is not None and not step > 0.0):
        raise InputError(f"duration {duration:g} s, step {step} s", key="duration", expected="> 0 s")
    summed = pack_summed(
        trains, database, yaws=place[:, 2], ramp=ramp, ramp_start=start, with_drift=with_drift, turning=False
    )
    interval = step
    if interval is None:
        interval = derived(_Interval, _series_interval, trains, database, place[:, 2]).step
    first = start - 2.0 * interval
    rows = math.ceil(duration / interval) + 6
    values = aligned((rows, 6 * database.body_count))
    fill_series(summed, place, first, interval, np.zeros(values.shape[1]), values)
    return SeriesExcitation(values, first, 1.0 / interval)


def series_step(trains: WaveTrains, database: HydrodynamicDatabase, yaws: ArrayLike) -> float:
    """Longest step [s] at which the Catmull-Rom error of every coordinate is 2e-4 of its standard deviation.

    Notes
    -----
    Errors of the components are independent, so their squares add. Halving the step divides the error by eight.
    """
    inside = components_inside(database, trains, yaws)
    omega = trains.omega[inside]
    table = excitation_table(database, np.clip(omega, database.omega[0], database.omega[-1]))
    power = np.concatenate(
        [
            np.abs(table.at(trains.direction[inside] - yaw)[:, 6 * body : 6 * body + 6]) ** 2
            for body, yaw in enumerate(np.atleast_1d(np.asarray(yaws, dtype=np.float64)))
        ],
        axis=1,
    ) * trains.amplitude[inside, None] ** 2  # fmt: skip
    total = np.sum(power, axis=0)
    active = total > 1e-12 * np.max(total, initial=0.0)
    step = 0.1
    while True:
        error = catmull_rom_error(omega * step) ** 2 @ power[:, active]
        if np.all(error <= SERIES_ERROR**2 * total[active]) or step < 1e-3:
            return step
        step *= 0.8


class _Interval(NamedTuple):
    step: float


def _series_interval(trains: WaveTrains, database: HydrodynamicDatabase, yaws: ArrayLike) -> _Interval:
    return _Interval(float(series_step(trains, database, yaws)))


def catmull_rom_error(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """RMS error of Catmull-Rom interpolation of exp(i w t), over all places between the points.

    Parameters
    ----------
    angle
        w h, phase from one point to the next [rad], shape (m,).
    """
    s = (np.arange(16) + 0.5) / 16.0
    weights = np.array([in_python(catmull_rom)(float(one)) for one in s]).T
    e = np.exp(1j * np.multiply.outer(angle, np.array([-1.0, 0.0, 1.0, 2.0])))
    interpolated = e @ weights
    return np.asarray(
        np.sqrt(np.mean(np.abs(interpolated - np.exp(1j * np.multiply.outer(angle, s))) ** 2, axis=1))
    )


def _yaw_row(table: HeadingTable, direction: NDArray[np.float64], yaw: float, turning: bool) -> list[float]:
    """First yaw [rad], range [rad], cells, and 1 if it goes round, of the table of one hull."""
    if not turning:
        return [yaw, NARROWEST, 1.0, 0.0]
    if table.periodic:
        return [0.0, 2.0 * math.pi, 2.0 * table.cells, 1.0]
    # as far as the headings of all components stay within those of the database
    offset = heading_offset(table, direction - yaw)
    right = float(np.min(table.span + HEADING_HOLD - offset))
    left = float(np.min(offset + HEADING_HOLD))
    finest = 0.5 * min(table.spacing, HEADING_HOLD)
    width = max(right + left, NARROWEST)
    return [yaw - right, width, float(math.ceil(width / finest)), 0.0]


def _over_yaws(
    table: HeadingTable,
    direction: NDArray[np.float64],
    amplitude: NDArray[np.float64],
    starts: NDArray[np.float64],
    spacings: NDArray[np.float64],
    cells: int,
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Amplitude times values, and slopes per spacing, at the yaw angles: shape (N, cells + 1, 6, m)."""
    shape = (len(starts), cells + 1, 6, len(direction))
    values, slopes = np.empty(shape, dtype=np.complex128), np.empty(shape, dtype=np.complex128)
    for hull, (first, spacing) in enumerate(zip(starts, spacings, strict=True)):
        for node in range(shape[1]):
            v, r = table.with_rates(direction - (first + spacing * node), slice(6 * hull, 6 * hull + 6))
            values[hull, node] = (v * amplitude[:, None]).T
            slopes[hull, node] = (-spacing * r * amplitude[:, None]).T  # headings fall as the yaw grows
    return values, slopes


def _aligned_copy(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same numbers, beginning at a cache line."""
    copy = aligned(values.shape)
    copy[...] = values
    return copy
