"""Wave excitation of a group of hulls over time: summed for moving ones, tabulated for those that stay.

Coordinate j of hull b feels

    F_j(t) = Re sum_m a_m X_j(omega_m, beta_m - psi_b) exp(i (k_m . x_b) - i (omega_m t + eps_m))

with the low-passed position x_b of its reference point and its low-passed yaw psi_b, and X_j relative to a crest at
that point. "Integrated simulation ... ships and offshore structures" (2018), equation (224), keeps the amplitude of
X alone; its phase is part of the force and is kept here. Mean and slowly varying drift follow Newman (1974).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.marine.wave_transfer import HEADING_HOLD

__all__ = [
    "SeriesExcitation",
    "SummedExcitation",
    "catmull_rom",
    "fill_series",
    "interpolate_series",
    "ramp_factor",
    "sum_excitation",
]

_OMEGA, _KX, _KY, _PHASE, _DIRECTION, _AMPLITUDE = range(6)
_START, _INVERSE_SPACING, _CELLS, _PERIODIC, _SPAN, _RAMP_START, _RAMP = range(7)


class SummedExcitation(NamedTuple):
    """Components of a sea and what they do to the hulls of a group; summed at every call.

    Attributes
    ----------
    components
        omega [rad/s], kx, ky [1/m], eps [rad], direction [rad], amplitude [m]: shape (6, m).
    table
        Amplitude times excitation: real and imaginary part of six coordinates, then their slopes over heading per
        spacing; row (hull (cells + 1) + node) m + component, shape (N (cells + 1) m, 24): waves of one direction
        read one piece of it.
    drift
        Amplitude times mean drift per amplitude squared, and slopes, in the same rows, shape (.., 12); no row without.
    settings
        First heading [rad], 1 / spacing, cells, 1 if the headings go round, span [rad], start of the ramp [s],
        length of the ramp [s]: shape (7,).
    waves
        Work space: cosine and sine of the components at one hull, shape (2, m).
    """

    components: NDArray[np.float64]
    table: NDArray[np.float64]
    drift: NDArray[np.float64]
    settings: NDArray[np.float64]
    waves: NDArray[np.float64]


class SeriesExcitation(NamedTuple):
    """Excitation of hulls that keep place and heading, on a grid of times.

    Attributes
    ----------
    values
        Forces [N, N m] including the ramp, shape (rows, 6 N).
    settings
        Time of the first row [s], 1 / step [1/s]: shape (2,).
    """

    values: NDArray[np.float64]
    settings: NDArray[np.float64]


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
    components, waves = excitation.components, excitation.waves
    for m in range(components.shape[1]):
        s, c = _sine_cosine(
            components[_KX, m] * x
            + components[_KY, m] * y
            - components[_OMEGA, m] * time
            - components[_PHASE, m]
        )
        waves[0, m] = c
        waves[1, m] = s


@kernel(inline=True, internal=True)
def _heading_cell(settings: NDArray[np.float64], heading: float) -> tuple[int, float]:
    """Piece in which a heading lies and the place in it (0 to 1); NaN if the table does not cover it."""
    turn = 6.283185307179586
    shift = 0.0 if settings[_PERIODIC] > 0.0 else 0.5 * (turn - settings[_SPAN])
    offset = heading - settings[_START] + shift
    offset -= turn * np.floor(offset * 0.15915494309189535) + shift
    place = offset * settings[_INVERSE_SPACING]
    cells = settings[_CELLS]
    outside = settings[_PERIODIC] == 0.0 and (
        offset < -HEADING_HOLD or offset > settings[_SPAN] + HEADING_HOLD
    )
    place = min(max(place, 0.0), cells)
    cell = min(np.floor(place), cells - 1.0)
    return int(cell), math.nan if outside else place - cell


@kernel(internal=True)
def _sum_hull(
    excitation: SummedExcitation, hull: int, yaw: float
) -> tuple[float, float, float, float, float, float]:
    """First-order force of one hull from the cosines and sines of the components."""
    components, table, waves, settings = (
        excitation.components, excitation.table, excitation.waves, excitation.settings,
    )  # fmt: skip
    count = components.shape[1]
    nodes = int(settings[_CELLS]) + 1
    f0 = f1 = f2 = f3 = f4 = f5 = 0.0
    for m in range(count):
        cell, s = _heading_cell(settings, components[_DIRECTION, m] - yaw)
        row = (hull * nodes + cell) * count + m
        # cubic Hermite: values and slopes at both ends of the piece
        a = 1.0 - s
        v0, v1 = (1.0 + 2.0 * s) * a * a, s * s * (3.0 - 2.0 * s)
        d0, d1 = s * a * a, -s * s * a
        c, i = waves[0, m], -waves[1, m]
        vc, vi, dc, di = v0 * c, v0 * i, d0 * c, d0 * i
        wc, wi, ec, ei = v1 * c, v1 * i, d1 * c, d1 * i
        p, q = table[row], table[row + count]
        # fmt: off
        f0 += (vc * p[0] + vi * p[6] + dc * p[12] + di * p[18]
               + wc * q[0] + wi * q[6] + ec * q[12] + ei * q[18])
        f1 += (vc * p[1] + vi * p[7] + dc * p[13] + di * p[19]
               + wc * q[1] + wi * q[7] + ec * q[13] + ei * q[19])
        f2 += (vc * p[2] + vi * p[8] + dc * p[14] + di * p[20]
               + wc * q[2] + wi * q[8] + ec * q[14] + ei * q[20])
        f3 += (vc * p[3] + vi * p[9] + dc * p[15] + di * p[21]
               + wc * q[3] + wi * q[9] + ec * q[15] + ei * q[21])
        f4 += (vc * p[4] + vi * p[10] + dc * p[16] + di * p[22]
               + wc * q[4] + wi * q[10] + ec * q[16] + ei * q[22])
        f5 += (vc * p[5] + vi * p[11] + dc * p[17] + di * p[23]
               + wc * q[5] + wi * q[11] + ec * q[17] + ei * q[23])
        # fmt: on
    return f0, f1, f2, f3, f4, f5


@kernel(internal=True)
def _add_drift(
    excitation: SummedExcitation, hull: int, yaw: float, factor: float, out: NDArray[np.float64]
) -> None:
    """Add the slowly varying drift of one hull.

    Notes
    -----
    Newman (1974) replaces the transfer function of two frequencies by the mean of those of each,
    ``T_mn = (D_m + D_n) / 2`` (Faltinsen, Sea Loads, equation 5.43), so that the double sum is a product of two:
    ``F = Re[conj(sum_m a_m e_m) sum_n a_n D_n e_n]``. It has difference frequencies alone, and the mean is
    sum a^2 D whatever the signs of D.
    """
    components, table, waves, settings = (
        excitation.components, excitation.drift, excitation.waves, excitation.settings,
    )  # fmt: skip
    count = components.shape[1]
    nodes = int(settings[_CELLS]) + 1
    sum_c = sum_s = 0.0
    for m in range(count):
        sum_c += components[_AMPLITUDE, m] * waves[0, m]
        sum_s += components[_AMPLITUDE, m] * waves[1, m]
    for m in range(count):
        cell, s = _heading_cell(settings, components[_DIRECTION, m] - yaw)
        row = (hull * nodes + cell) * count + m
        a = 1.0 - s
        both = factor * (sum_c * waves[0, m] + sum_s * waves[1, m])
        v0, v1 = both * (1.0 + 2.0 * s) * a * a, both * s * s * (3.0 - 2.0 * s)
        d0, d1 = both * s * a * a, -both * s * s * a
        for j in range(6):
            out[6 * hull + j] += (
                v0 * table[row, j]
                + d0 * table[row, 6 + j]
                + v1 * table[row + count, j]
                + d1 * table[row + count, 6 + j]
            )


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
    ramp = ramp_factor(time, excitation.settings[_RAMP_START], excitation.settings[_RAMP])
    for hull in range(place.shape[0]):
        if not math.isfinite(place[hull, 0] + place[hull, 1] + place[hull, 2]):
            for j in range(6):  # a heading that is no number would be no row of the table
                out[6 * hull + j] = math.nan
            continue
        _waves_at(excitation, time, place[hull, 0], place[hull, 1])
        f0, f1, f2, f3, f4, f5 = _sum_hull(excitation, hull, place[hull, 2])
        out[6 * hull] = ramp * f0
        out[6 * hull + 1] = ramp * f1
        out[6 * hull + 2] = ramp * f2
        out[6 * hull + 3] = ramp * f3
        out[6 * hull + 4] = ramp * f4
        out[6 * hull + 5] = ramp * f5
        if excitation.drift.shape[0] > 0:
            _add_drift(excitation, hull, place[hull, 2], ramp * ramp, out)


@kernel(inline=True, internal=True)
def ramp_factor(time: float, start: float, length: float) -> float:
    """Zero at the start, one after the length, with a continuous rate: ``(1 - cos(pi s)) / 2``."""
    s = (time - start) / length if length > 0.0 else 1.0
    s = min(max(s, 0.0), 1.0)
    return 0.5 * (1.0 - math.cos(math.pi * s))


@kernel
def fill_series(
    excitation: SummedExcitation,
    place: NDArray[np.float64],
    first: float,
    step: float,
    buffer: NDArray[np.float64],
    values: NDArray[np.float64],
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
    place = (time - excitation.settings[0]) * excitation.settings[1]
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
