"""Moves of hooks, trolleys, booms, cranes: a distance or an angle, with a speed that grows and falls along ramps."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Positive, Quantity
from heavylift.pipeline.equipment.parts import EQUIPMENT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["Move", "Turn", "check_moves", "positions_of", "speeds_of", "turned"]

ROWS = 40
"""Rows of a table of positions along a ramp: a spline through them leaves the way by less than 1e-4 of it."""

PAUSE = 8
"""Rows at either end of a pause: the spline swings less by a factor of 4 from each to the next."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class Move:
    """A move over a distance: from rest to a speed along a ramp, on, and to rest along another one."""

    start: Annotated[float, Quantity("time", minimum=0.0, closed=True)]
    """When it begins [s]."""
    distance: Annotated[float, Quantity("length")]
    """How far [m]; backwards or downwards if negative."""
    speed: Annotated[float, Positive("velocity")]
    """Largest speed [m/s]."""
    ramp: Annotated[float, Positive("time")] = 5.0
    """How long the speed grows, and falls [s]."""

    @staticmethod
    def check(spec: Any) -> None:
        """Both ramps fit into the distance."""
        _check_ramps(spec, "distance", spec.distance, "m")


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class Turn:
    """A turn through an angle: from rest to a speed along a ramp, on, and to rest along another one."""

    start: Annotated[float, Quantity("time", minimum=0.0, closed=True)]
    """When it begins [s]."""
    angle: Annotated[float, Quantity("angle")]
    """How far [rad]; a boom upwards, a table anticlockwise if positive."""
    speed: Annotated[float, Positive("angular velocity")]
    """Largest speed [rad/s]."""
    ramp: Annotated[float, Positive("time")] = 5.0
    """How long the speed grows, and falls [s]."""

    @staticmethod
    def check(spec: Any) -> None:
        """Both ramps fit into the angle."""
        _check_ramps(spec, "angle", spec.angle, "rad")


def turned(turns: Sequence[Any]) -> list[Any]:
    """Turns as moves, their angles as distances."""
    return [
        SimpleNamespace(start=turn.start, distance=turn.angle, speed=turn.speed, ramp=turn.ramp)
        for turn in turns
    ]


def _check_ramps(spec: Any, key: str, distance: float, unit: str) -> None:
    """Both ramps fit into a distance or an angle."""
    least = spec.speed * spec.ramp
    if abs(distance) < least * (1.0 - 1e-12):
        raise InputError(
            f"{distance:.6g} {unit}, and ramps of {spec.ramp:.6g} s to {spec.speed:.6g} {unit}/s take "
            f"{least:.6g} {unit}",
            key=key,
            expected=f"at least {least:.6g} {unit}, a lower speed or a shorter ramp",
        )


def duration_of(move: Any) -> float:
    """How long a move takes [s]."""
    return abs(float(move.distance)) / float(move.speed) + float(move.ramp)


def check_moves(moves: Sequence[Any], key: str) -> None:
    """Moves follow each other.

    Raises
    ------
    InputError
        If one begins before that before it has ended.
    """
    for i in range(1, len(moves)):
        end = moves[i - 1].start + duration_of(moves[i - 1])
        if moves[i].start < end * (1.0 - 1e-12):
            raise InputError(
                f"begins at {moves[i].start:.6g} s, the move before it ends at {end:.6g} s",
                key=f"{key}.{i}.start",
                expected="moves one after the other",
            )


def speeds_of(moves: Sequence[Any], factor: float = 1.0) -> dict[str, list[float]]:
    """Times [s] and speeds [m/s], linear between them, of a drive, or of a winch, which hauls `factor` times that."""
    times: list[float] = []
    speeds: list[float] = []
    for move in moves:
        speed = factor * move.speed * (1.0 if move.distance > 0.0 else -1.0)
        end = move.start + duration_of(move)
        for time, value in ((0.0, 0.0), (move.ramp, speed)):
            times.append(move.start + time)
            speeds.append(value)
        for time, value in ((move.ramp, speed), (0.0, 0.0)):
            if not times or end - time > times[-1] + 1e-9:
                times.append(end - time)
                speeds.append(value)
    return _joined(times, speeds)


def _joined(times: list[float], speeds: list[float]) -> dict[str, list[float]]:
    """Rows without those at one time, where a move follows another at once."""
    kept = [i for i in range(len(times)) if i == 0 or times[i] > times[i - 1] + 1e-9]
    return {"times": [times[i] for i in kept], "speeds": [speeds[i] for i in kept]}


def positions_of(moves: Sequence[Any]) -> dict[str, list[float]]:
    """Times [s] and distances gone [m], dense enough for the spline that goes through them."""
    times: list[float] = [0.0]
    gone: list[float] = [0.0]
    at = 0.0
    for move in moves:
        sign = 1.0 if move.distance > 0.0 else -1.0
        ramp, whole = float(move.ramp), duration_of(move)
        steady = np.arange(ramp, whole - ramp, ramp / ROWS)
        rows: NDArray[np.float64] = np.unique(
            np.concatenate(
                [np.linspace(0.0, ramp, ROWS + 1), steady, whole - np.linspace(0.0, ramp, ROWS + 1)]
            )
        )
        rows = rows[np.append(True, np.diff(rows) > 1e-6 * ramp)]
        for t in rows:
            along = _along(float(t), ramp, whole, float(move.speed))
            if move.start + t > times[-1] + 1e-9:
                times.append(float(move.start + t))
                gone.append(at + sign * along)
        at += float(move.distance)
    return _held(times, gone)


def _along(t: float, ramp: float, whole: float, speed: float) -> float:
    """Way [m] after a time of a move."""
    rest = whole - t
    if t <= ramp:
        return 0.5 * speed * t * t / ramp
    if rest <= ramp:
        return speed * (whole - ramp) - 0.5 * speed * rest * rest / ramp
    return speed * (t - 0.5 * ramp)


def _held(times: list[float], gone: list[float]) -> dict[str, list[float]]:
    """With rows in pauses as near to each other as those beside them."""
    found_t, found_x = [times[0]], [gone[0]]
    for i in range(1, len(times)):
        if gone[i] == gone[i - 1]:
            after = times[i + 1] - times[i] if i + 1 < len(times) else times[i] - times[i - 1]
            step = min(after, times[i] - times[i - 1])
            near = [times[i - 1] + step * k for k in range(1, PAUSE + 1)]
            near += [times[i] - step * k for k in range(1, PAUSE + 1)]
            for time in sorted(near):
                if found_t[-1] + 0.5 * step < time < times[i] - 0.5 * step:
                    found_t.append(time)
                    found_x.append(gone[i])
        found_t.append(times[i])
        found_x.append(gone[i])
    return {"times": found_t, "values": found_x}
