"""Wave excitation of a group of hulls over time: summed for moving ones, tabulated for those that stay.

Coordinate j of hull b feels

    F_j(t) = Re sum_m a_m X_j(omega_m, beta_m - psi_b) exp(i (k_m . x_b) - i (omega_m t + eps_m))

with the low-passed position x_b of its reference point and its low-passed yaw psi_b, and X_j relative to a crest at
that point. "Integrated simulation ... ships and offshore structures" (2018), equation (224), keeps the amplitude of
X alone; its phase is part of the force and is kept here. Mean and slowly varying drift follow Newman (1974).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Floats2
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.records import Record, Records

__all__ = [
    "SeriesExcitation",
    "SummedExcitation",
    "YawTable",
    "catmull_rom",
    "fill_series",
    "interpolate_series",
    "ramp_factor",
    "sum_excitation",
]


class YawTable(Record):
    """Pieces of a table over the yaw of a hull.

    Attributes
    ----------
    first
        Yaw at which it begins [rad].
    inverse_spacing
        Pieces a radian [1/rad].
    cells
        Number of pieces.
    periodic
        Whether the yaw goes round.
    """

    first: float
    inverse_spacing: float
    cells: int
    periodic: bool


class SummedExcitation(Arrays):
    """Components of a sea and what they do to the hulls of a group; summed at every call.

    Attributes
    ----------
    omega, kx, ky, phase, amplitude
        Of the components: circular frequency [rad/s], wave number along x and y [1/m], eps [rad], [m]; shape (m,).
    table
        Amplitude times excitation at yaw angles of the hull: real and imaginary part of six coordinates, then their
        slopes over the yaw per spacing. Row (hull (cells + 1) + node) 24 + quantity, shape (N (cells + 1) 24, m): the
        two nodes about a yaw are read from end to end, whatever the directions of the waves.
    drift
        Amplitude times mean drift per amplitude squared, and slopes, twelve rows a node; no row without drift.
    yaws
        Pieces of the table of each hull, as many for all.
    ramp_start, ramp_length
        Of the ramp [s].
    cosine, sine
        Work space: of the components at one hull, shape (m,).
    """

    omega: Floats1
    kx: Floats1
    ky: Floats1
    phase: Floats1
    amplitude: Floats1
    table: Floats2
    drift: Floats2
    yaws: Records[YawTable]
    ramp_start: float
    ramp_length: float
    cosine: Floats1
    sine: Floats1


class SeriesExcitation(Arrays):
    """Excitation of hulls that keep place and heading, on a grid of times.

    Attributes
    ----------
    values
        Forces [N, N m] including the ramp, shape (rows, 6 N).
    begin
        Time of the first row [s].
    rate
        Rows a second [1/s].
    """

    values: Floats2
    begin: float
    rate: float


@kernel(inline=True, internal=True)
def _sine_cosine(angle: float) -> tuple[float, float]:
    """Sine and cosine without branches, so that loops over them use vector instructions; error below 1e-15.

    A quarter of the angle reduced to (-pi, pi) is small enough for the Taylor series; doubling it twice gives
    back the angle.
    """
    turns = np.floor(angle * 0.15915494309189535 + 0.5)
    # 2 pi in two parts, the first with 26 trailing zero bits: its product with up to 2^26 turns is exact
    x = 0.25 * ((angle - turns * 6.283185303211212) - turns * 3.968374318722162e-09)
    y = x * x
    s = x * (
        1.0
        + y * (-1.0 / 6.0 + y * (1.0 / 120.0 + y * (-1.0 / 5040.0 + y * (1.0 / 362880.0 + y * (
            -1.0 / 39916800.0 + y * (1.0 / 6227020800.0 + y * (-1.0 / 1307674368000.0)))))))
    )  # fmt: skip
    c = 1.0 + y * (-0.5 + y * (1.0 / 24.0 + y * (-1.0 / 720.0 + y * (1.0 / 40320.0 + y * (
        -1.0 / 3628800.0 + y * (1.0 / 479001600.0 + y * (-1.0 / 87178291200.0 + y / 20922789888000.0)))))))  # fmt: skip
    s2 = 2.0 * s * c
    c2 = 1.0 - 2.0 * s * s
    return 2.0 * s2 * c2, 1.0 - 2.0 * s2 * s2


@kernel(internal=True)
def _waves_at(excitation: SummedExcitation, time: float, x: float, y: float) -> None:
    """Cosine and sine of the phase of every component at a place."""
    omega, kx, ky, phase = excitation.omega, excitation.kx, excitation.ky, excitation.phase
    cosine, sine = excitation.cosine, excitation.sine
    for m in range(omega.shape[0]):
        s, c = _sine_cosine(kx[m] * x + ky[m] * y - omega[m] * time - phase[m])
        cosine[m] = c
        sine[m] = s


@kernel(inline=True, internal=True)
def _yaw_cell(yaws: YawTable, yaw: float) -> tuple[int, float]:
    """Piece of the table in which a yaw lies and the place in it, 0 to 1; NaN where the table has none."""
    offset = yaw - yaws.first
    if yaws.periodic:
        turn = 6.283185307179586
        offset -= turn * np.floor(offset / turn)
    place = offset * yaws.inverse_spacing
    last = yaws.cells
    if not (place > -1e-9 and place < last + 1e-9):  # also if the yaw is no number
        return 0, math.nan
    cell = min(max(np.floor(place), 0.0), last - 1.0)
    return int(cell), place - cell


@kernel(internal=True, reassociate=True)
def _sum_coordinate(
    table: NDArray[np.float64],
    cosine: NDArray[np.float64],
    sine: NDArray[np.float64],
    row: int,
    after: int,
    weights: tuple[float, float, float, float],
) -> float:
    """First-order force on one coordinate: cubic Hermite over the yaw, then the sum over the components.

    `row` and `after` are those of the real part at both nodes; the imaginary part is six rows on, slopes twelve.
    """
    v0, d0, v1, d1 = weights
    total = 0.0
    for m in range(cosine.shape[0]):
        re = v0 * table[row, m] + d0 * table[row + 12, m] + v1 * table[after, m] + d1 * table[after + 12, m]
        im = (
            v0 * table[row + 6, m]
            + d0 * table[row + 18, m]
            + v1 * table[after + 6, m]
            + d1 * table[after + 18, m]
        )
        total += re * cosine[m] - im * sine[m]
    return total


@kernel(internal=True, reassociate=True)
def _sum_envelope(
    amplitude: NDArray[np.float64], cosine: NDArray[np.float64], sine: NDArray[np.float64]
) -> tuple[float, float]:
    """Sum of amplitude times cosine, and times sine."""
    c = s = 0.0
    for m in range(cosine.shape[0]):
        c += amplitude[m] * cosine[m]
        s += amplitude[m] * sine[m]
    return c, s


@kernel(internal=True, reassociate=True)
def _sum_drift(
    drift: NDArray[np.float64],
    cosine: NDArray[np.float64],
    sine: NDArray[np.float64],
    row: int,
    after: int,
    weights: tuple[float, float, float, float],
    envelope: tuple[float, float],
) -> float:
    """Slowly varying drift of one coordinate.

    Notes
    -----
    Newman (1974) replaces the transfer function of two frequencies by the mean of those of each,
    ``T_mn = (D_m + D_n) / 2`` (Faltinsen, Sea Loads, equation 5.43), so that the double sum is a product of two:
    ``F = Re[conj(sum_m a_m e_m) sum_n a_n D_n e_n]``. It has difference frequencies alone, and the mean is
    sum a^2 D whatever the signs of D.
    """
    v0, d0, v1, d1 = weights
    c, s = envelope
    total = 0.0
    for m in range(cosine.shape[0]):
        D = v0 * drift[row, m] + d0 * drift[row + 6, m] + v1 * drift[after, m] + d1 * drift[after + 6, m]
        total += D * (c * cosine[m] + s * sine[m])
    return total


@kernel(internal=True)
def sum_excitation(
    excitation: SummedExcitation, time: float, place: NDArray[np.float64], out: NDArray[np.float64]
) -> None:
    """Wave forces on all hulls of a group at one time.

    Parameters
    ----------
    excitation
        Sea and hulls.
    time
        [s].
    place
        Low-passed x, y [m] of the reference points and yaw [rad], shape (N, 3), world.
    out
        Overwritten: forces [N] and moments [N m] about the reference points in the heading frames, shape (6 N,).
        NaN if a hull has turned to where the database has no headings, or if a place is not finite.
    """
    ramp = ramp_factor(time, excitation.ramp_start, excitation.ramp_length)
    cosine, sine = excitation.cosine, excitation.sine
    for hull in range(place.shape[0]):
        cell, s = _yaw_cell(excitation.yaws[hull], place[hull, 2])
        _waves_at(excitation, time, place[hull, 0], place[hull, 1])
        a = 1.0 - s
        weights = (1.0 + 2.0 * s) * a * a, s * a * a, s * s * (3.0 - 2.0 * s), -s * s * a
        node = hull * (excitation.yaws[hull].cells + 1) + cell
        for j in range(6):
            row = 24 * node + j
            out[6 * hull + j] = ramp * _sum_coordinate(excitation.table, cosine, sine, row, row + 24, weights)
        if excitation.drift.shape[0] > 0:
            envelope = _sum_envelope(excitation.amplitude, cosine, sine)
            for j in range(6):
                row = 12 * node + j
                out[6 * hull + j] += (
                    ramp * ramp * _sum_drift(excitation.drift, cosine, sine, row, row + 12, weights, envelope)
                )


@kernel(inline=True, internal=True)
def ramp_factor(time: float, start: float, length: float) -> float:
    """Zero at the start, one after the length, with a continuous rate: ``(1 - cos(pi s)) / 2``."""
    s = (time - start) / length if length > 0.0 else 1.0
    s = min(max(s, 0.0), 1.0)
    return 0.5 * (1.0 - math.cos(math.pi * s))


@entry
def fill_series(
    excitation: SummedExcitation,
    place: Floats2,
    first: float,
    step: float,
    buffer: Floats1,
    values: Floats2,
) -> None:
    """Sums at a fixed place, at the times ``first + row step``: rows of `values`, shape (rows, 6 N)."""
    for row in range(values.shape[0]):
        sum_excitation(excitation, first + row * step, place, buffer)
        for j in range(values.shape[1]):
            values[row, j] = buffer[j]


@kernel(inline=True)
def catmull_rom(s: float) -> tuple[float, float, float, float]:
    """Weights of the points before, at the begin, at the end and after an interval at the place s, 0 to 1."""
    return (
        0.5 * s * (-1.0 + s * (2.0 - s)),
        1.0 + 0.5 * s * s * (-5.0 + 3.0 * s),
        0.5 * s * (1.0 + s * (4.0 - 3.0 * s)),
        0.5 * s * s * (s - 1.0),
    )


@kernel(internal=True)
def interpolate_series(excitation: SeriesExcitation, time: float, out: NDArray[np.float64]) -> None:
    """Wave forces at one time by cubic Catmull-Rom interpolation.

    Parameters
    ----------
    excitation
        Series.
    time
        [s].
    out
        Overwritten: forces [N] and moments [N m], shape (6 N,); NaN outside the series.
    """
    values = excitation.values
    place = (time - excitation.begin) * excitation.rate
    if not (place >= 1.0 and place < values.shape[0] - 2.0):
        for j in range(values.shape[1]):
            out[j] = math.nan
        return
    row = int(place)
    w0, w1, w2, w3 = catmull_rom(place - row)
    for j in range(values.shape[1]):
        out[j] = (
            w0 * values[row - 1, j] + w1 * values[row, j] + w2 * values[row + 1, j] + w3 * values[row + 2, j]
        )
