"""Speeds over time with limits of acceleration and jerk, and tables of values, as cubics in time.

A change of speed by dv at most as quick as an acceleration a and a jerk J allow is an S-curve: the jerk is J for
``t_j = a/J``, then nothing for ``|dv|/a - t_j``, then -J for t_j; a change below ``a^2/J`` does not reach a and takes
``2 sqrt(|dv|/J)`` (L. Biagiotti and C. Melchiorri, "Trajectory Planning for Automatic Machines and Robots", 2008,
chapter 3). So the way is a cubic in each phase: position, speed and acceleration are exact at all times.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError

__all__ = [
    "FOREVER",
    "check_speeds",
    "overshoot",
    "planned_moves",
    "profile_cubics",
    "ramp_phases",
    "speed_pieces",
]

FOREVER = 1e7
"""Time behind the last row for which a drive continues at its last speed [s]."""

OVERSHOOT = 1e-3
"""Of the range of a table, by how much a smooth curve may leave two neighbours without being told."""


def ramp_phases(change: float, acceleration: float, jerk: float | None) -> list[tuple[float, float, float]]:
    """Duration, acceleration at the begin and jerk of the phases of a change of speed.

    Parameters
    ----------
    change
        Of the speed [m/s] or [rad/s].
    acceleration, jerk
        Limits; None for a jump of the acceleration.
    """
    if change == 0.0:
        return []
    sense, size = math.copysign(1.0, change), abs(change)
    if jerk is None:
        return [(size / acceleration, sense * acceleration, 0.0)]
    peak = min(acceleration, math.sqrt(size * jerk))
    rise = peak / jerk
    level = size / peak - rise
    phases = [(rise, 0.0, sense * jerk), (level, sense * peak, 0.0), (rise, sense * peak, -sense * jerk)]
    return [phase for phase in phases if phase[0] > 1e-12 * rise]


def speed_pieces(
    times: Sequence[float] | NDArray[np.float64],
    speeds: Sequence[float] | NDArray[np.float64],
    acceleration: float | None = None,
    jerk: float | None = None,
) -> NDArray[np.float64]:
    """Time, way since t = 0, speed, acceleration and jerk where each piece begins; shape (n, 5).

    Parameters
    ----------
    times, speeds
        Without acceleration the speed is linear between the times, and held before and behind them. With one they are
        targets: a drive at rest begins to change to a speed at its time.
    acceleration, jerk
        Limits.

    Notes
    -----
    The first piece reaches backwards for ever, and the last one forwards.
    """
    t, v = (np.asarray(values, dtype=np.float64) for values in (times, speeds))
    rows: list[tuple[float, float, float]] = []  # time, acceleration, jerk
    reached: dict[
        int, float
    ] = {}  # rows that begin with a speed that was said, whatever rounding leaves of it
    if acceleration is None:
        begin = float(v[0])
        slopes = np.diff(v) / np.diff(t)
        rows = [(float(at), float(slope), 0.0) for at, slope in zip(t, slopes, strict=False)]
        rows.append((float(t[-1]), 0.0, 0.0))
    else:
        begin, before = 0.0, 0.0
        for at, speed in zip(t, v, strict=True):
            now = float(at)
            for duration, start, rate in ramp_phases(float(speed) - before, acceleration, jerk):
                if (
                    rows and rows[-1][0] >= now * (1.0 - 1e-12) - 1e-12
                ):  # the last ramp ends where this one begins
                    now = rows.pop()[0]
                rows.append((now, start, rate))
                now += duration
            if rows and rows[-1][0] >= now:
                rows.pop()
            reached[len(rows)] = float(speed)
            rows.append((now, 0.0, 0.0))
            before = float(speed)
    pieces = np.zeros((len(rows) + 1, 5))
    pieces[0] = rows[0][0] - 1.0, -begin, begin, 0.0, 0.0
    way, speed = 0.0, begin
    for i, (at, start, rate) in enumerate(rows):
        speed = reached.get(i, speed)
        pieces[i + 1] = at, way, speed, start, rate
        if i + 1 < len(rows):
            s = rows[i + 1][0] - at
            way += s * (speed + s * (start / 2.0 + s * rate / 6.0))
            speed += s * (start + s * rate / 2.0)
    i = max(int(np.searchsorted(pieces[:, 0], 0.0, side="right")) - 1, 0)
    s = -pieces[i, 0]
    at_zero = pieces[i, 1] + s * (pieces[i, 2] + s * (pieces[i, 3] / 2.0 + s * pieces[i, 4] / 6.0))
    pieces[:, 1] -= at_zero
    return pieces


def planned_moves(
    times: Sequence[float], places: Sequence[float], speed: float, acceleration: float, jerk: float | None
) -> tuple[list[float], list[float]]:
    """Times and target speeds, for `speed_pieces`, of moves from rest to rest that begin at the times.

    Parameters
    ----------
    times, places
        When each move begins, and where it ends; the first place is where all begins.
    speed, acceleration, jerk
        Limits. A short move does not reach its speed: then ``v T(v) = way``, with the time T of a ramp.

    Raises
    ------
    InputError
        If a move is not done when the next one begins.
    """
    at: list[float] = []
    speeds: list[float] = []
    for i, (time, before, after) in enumerate(zip(times[1:], places[:-1], places[1:], strict=True)):
        way = after - before
        if way == 0.0:
            continue
        size = abs(way)
        if jerk is None:
            peak = math.sqrt(acceleration * size)
        else:
            peak = (0.25 * size**2 * jerk) ** (1.0 / 3.0)
            if peak > acceleration**2 / jerk:
                half = 0.5 * acceleration**2 / jerk
                peak = math.sqrt(half**2 + acceleration * size) - half
        peak = min(speed, peak)
        ramp = sum(duration for duration, _, _ in ramp_phases(peak, acceleration, jerk))
        cruise = max(0.0, size / peak - ramp)
        end = time + 2.0 * ramp + cruise
        if i + 2 < len(times) and end > times[i + 2] * (1.0 + 1e-12):
            raise InputError(
                f"the move to {after:g} at {time:g} s takes {end - time:.6g} s, and the next one begins at"
                f" {times[i + 2]:g} s",
                key=f"times.{i + 2}",
                expected=f"{end:.6g} s or later, or larger limits",
            )
        at += [time, time + ramp + cruise]
        speeds += [math.copysign(peak, way), 0.0]
    return at, speeds


def check_speeds(spec: Any) -> None:
    """Limits of acceleration and jerk belong to speeds, each of which is reached before the next one begins.

    Raises
    ------
    InputError
        If not.
    """
    if spec.acceleration is None:
        if spec.jerk is not None:
            raise InputError("'jerk' without 'acceleration'", key="jerk", expected="'acceleration' as well")
        return
    if not len(spec.speeds):
        raise InputError(
            "'acceleration' without 'speeds'",
            key="acceleration",
            expected="'times' and 'speeds', its targets",
        )
    before = 0.0
    for i, (time, speed) in enumerate(zip(spec.times, spec.speeds, strict=True)):
        phases = ramp_phases(speed - before, spec.acceleration, spec.jerk)
        needed = sum(duration for duration, _, _ in phases)
        if i + 1 < len(spec.times) and time + needed > spec.times[i + 1] * (1.0 + 1e-12):
            raise InputError(
                f"the change to {speed:g} at {time:g} s takes {needed:.6g} s, and the next one begins at"
                f" {spec.times[i + 1]:g} s",
                key=f"times.{i + 1}",
                expected=f"{time + needed:.6g} s or later, or a larger acceleration",
            )
        before = speed


def profile_cubics(profile: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Breaks and coefficients by falling power, shape (n - 1, 4), of the table or the speeds of a function of time."""
    if len(profile.speeds):
        pieces = speed_pieces(profile.times, profile.speeds, profile.acceleration, profile.jerk)
        if pieces[0, 0] > 0.0 and pieces[0, 2] != 0.0:  # the function is held before its first break
            pieces[0, 1] -= pieces[0, 0] * pieces[0, 2]
            pieces[0, 0] = 0.0
        breaks = np.append(pieces[:, 0], pieces[-1, 0] + FOREVER)
        return breaks, pieces[:, [4, 3, 2, 1]] / np.array([6.0, 2.0, 1.0, 1.0])
    if profile.interpolation == "monotone":
        from scipy.interpolate import CubicHermiteSpline

        steps = np.diff(profile.times)
        means = np.diff(profile.values) / steps
        slopes = np.zeros(len(profile.times))
        same = means[:-1] * means[1:] > 0.0
        first, second = 2.0 * steps[1:] + steps[:-1], steps[1:] + 2.0 * steps[:-1]
        first, second, before, after = (x[same] for x in (first, second, means[:-1], means[1:]))
        slopes[1:-1][same] = (first + second) / (first / before + second / after)
        return np.asarray(profile.times), CubicHermiteSpline(profile.times, profile.values, slopes).c.T
    from scipy.interpolate import CubicSpline

    return np.asarray(profile.times), CubicSpline(profile.times, profile.values, bc_type="clamped").c.T


def overshoot(profile: Any) -> tuple[float, float]:
    """By how much a curve leaves the values at both ends of an interval at most, and when [s]; (0, 0) if not."""
    if not len(profile.values):
        return 0.0, 0.0
    breaks, cubics = profile_cubics(profile)
    values = np.asarray(profile.values, dtype=np.float64)
    found = (0.0, 0.0)
    for i, cubic in enumerate(cubics):
        step = breaks[i + 1] - breaks[i]
        roots = np.roots(np.polyder(cubic))
        for s in roots[np.isreal(roots)].real:
            if 0.0 < s < step:
                value = float(np.polyval(cubic, s))
                beyond = max(value - max(values[i], values[i + 1]), min(values[i], values[i + 1]) - value)
                found = max(found, (beyond, float(breaks[i] + s)))
    return found if found[0] > OVERSHOOT * float(np.ptp(values)) else (0.0, 0.0)
