"""Moves of hooks, trolleys and cranes: a distance with a speed that grows and falls along ramps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Positive, Quantity
from heavylift.pipeline.equipment.parts import EQUIPMENT

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["Move", "check_moves", "speeds_of"]


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
    def check(said: Any) -> None:
        """Both ramps fit into the distance."""
        least = said.speed * said.ramp
        if abs(said.distance) < least * (1.0 - 1e-12):
            raise InputError(
                f"{said.distance:.6g} m, and ramps of {said.ramp:.6g} s to {said.speed:.6g} m/s take {least:.6g} m",
                key="distance",
                expected=f"at least {least:.6g} m, a lower speed or a shorter ramp",
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
