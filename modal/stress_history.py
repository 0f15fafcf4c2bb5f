"""Stress over the records of a run: largest values of groups at each record, and the envelope at each point.

Streamed in blocks of points and records, so that neither modal stresses nor stresses over time are ever all in memory.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.modal.stress_points import equivalent_stress
from heavylift.numerics.classes import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from heavylift.modal.stress_points import StressPoints

__all__ = ["Envelope", "GroupHistory", "PointGroup", "recover_stress", "stress_at_records"]

_POINTS = 256  # of a block
_VALUES = 1_000_000  # of a block: stresses of all layers and components


class PointGroup(NamedTuple):
    """Points whose largest stress is told.

    Attributes
    ----------
    name
        Of the group.
    points
        Numbers of points, sorted, shape (k,).
    strength
        Stress that is fully used at each of them [Pa], shape (k,); None if it is not known.
    """

    name: str
    points: NDArray[np.int64]
    strength: NDArray[np.float64] | None = None


@dataclass(frozen=True, eq=False)
class GroupHistory:
    """Largest stress of a group at each record.

    Attributes
    ----------
    largest
        Von Mises stress by side [Pa], shape (records, sides).
    point
        Where it is, by number of the point, shape (records, sides).
    utilisation
        Largest ratio to the strength, shape (records, sides); not that of the largest stress where strengths differ.
        None without strength.
    used_point
        Where that is, shape (records, sides); None without strength.
    """

    largest: NDArray[np.float32]
    point: NDArray[np.int32]
    utilisation: NDArray[np.float32] | None
    used_point: NDArray[np.int32] | None


@dataclass(frozen=True, eq=False)
class Envelope:
    """Extremes over all records at each point.

    Attributes
    ----------
    largest
        Von Mises stress by side [Pa], shape (m, sides).
    record
        Number of the record at which it is, shape (m, sides).
    highest, lowest
        Of the components of each layer [Pa], shape (m, layers, components), each by itself.
    """

    largest: NDArray[np.float32]
    record: NDArray[np.int32]
    highest: NDArray[np.float32]
    lowest: NDArray[np.float32]


def recover_stress(
    points: StressPoints,
    shapes: NDArray[np.float64],
    coordinates: NDArray[np.float64],
    groups: Sequence[PointGroup],
    *,
    progress: Callable[[float], object] | None = None,
) -> tuple[list[GroupHistory], Envelope]:
    """Largest stresses over time by modal superposition.

    Parameters
    ----------
    points
        Of one part of the body.
    shapes
        Mode shapes, and those of a static correction, shape (N, nf).
    coordinates
        Modal coordinates, and loads of the correction, shape (records, nf).
    groups
        Points whose largest stress is told.
    progress
        Told the share that is done, 0 to 1.

    Notes
    -----
    Von Mises stress is not linear: it is formed at each record and side. In single precision; the work is
    ``points x layers x components x nf`` multiplications a record.
    """
    records, count = len(coordinates), len(points)
    sides, layers = points.from_layers.shape
    q = np.ascontiguousarray(coordinates, dtype=np.float32)
    envelope = Envelope(
        np.full((count, sides), -1.0, dtype=np.float32),
        np.zeros((count, sides), dtype=np.int32),
        np.empty((count, layers, points.components), dtype=np.float32),
        np.empty((count, layers, points.components), dtype=np.float32),
    )
    found = [
        GroupHistory(
            np.full((records, sides), -1.0, dtype=np.float32),
            np.zeros((records, sides), dtype=np.int32),
            None if group.strength is None else np.full((records, sides), -1.0, dtype=np.float32),
            None if group.strength is None else np.zeros((records, sides), dtype=np.int32),
        )
        for group in groups
    ]
    for start in range(0, count, _POINTS):
        chosen = np.arange(start, min(start + _POINTS, count))
        modal = _columns(points, shapes, chosen)
        members = [_members(group, chosen) for group in groups]
        span = max(1, _VALUES // (len(chosen) * modal.shape[0] * modal.shape[1]))
        for first in range(0, records, span):
            part = slice(first, min(first + span, records))
            stress = np.matmul(q[part], modal)  # (layers, components, records, points)
            _take_extremes(envelope, stress, chosen, first=first == 0)
            for side, weights in enumerate(points.from_layers):
                mises = equivalent_stress(_combined(stress, weights))
                _take_envelope(envelope, mises, chosen, side, first)
                for history, member in zip(found, members, strict=True):
                    _take_group(history, mises, member, part, side)
        if progress is not None:
            progress(float(chosen[-1] + 1) / count)
    return found, envelope


def stress_at_records(
    points: StressPoints, shapes: NDArray[np.float64], coordinates: NDArray[np.float64]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Stress at some records as `recover_stress` finds it.

    Returns
    -------
    tuple
        Stresses of the layers [Pa], shape (records, m, layers, components); von Mises stress by side, shape
        (records, m, sides).
    """
    q = np.ascontiguousarray(coordinates, dtype=np.float32)
    sides, layers = points.from_layers.shape
    stress = np.empty((len(q), len(points), layers, points.components), dtype=np.float32)
    mises = np.empty((len(q), len(points), sides), dtype=np.float32)
    for start in range(0, len(points), _POINTS):
        chosen = np.arange(start, min(start + _POINTS, len(points)))
        now = np.matmul(q, _columns(points, shapes, chosen))
        stress[:, chosen] = now.transpose(2, 3, 0, 1)
        for side, weights in enumerate(points.from_layers):
            mises[:, chosen, side] = equivalent_stress(_combined(now, weights))
    return stress, mises


class _Members(NamedTuple):
    """Points of a group in a block: places in the block, numbers, and strengths."""

    places: NDArray[np.int64]
    numbers: NDArray[np.int64]
    strength: NDArray[np.float32] | None


def _members(group: PointGroup, chosen: NDArray[np.int64]) -> _Members:
    low, high = np.searchsorted(group.points, (chosen[0], chosen[-1] + 1))
    numbers = group.points[low:high]
    strength = None if group.strength is None else group.strength[low:high].astype(np.float32)
    return _Members(numbers - chosen[0], numbers, strength)


def _columns(
    points: StressPoints, shapes: NDArray[np.float64], chosen: NDArray[np.int64]
) -> NDArray[np.float32]:
    """Modal stresses of some points, shape (layers, components, nf, points)."""
    modal = points.columns(shapes, chosen)
    return np.ascontiguousarray(modal.transpose(1, 2, 3, 0), dtype=np.float32)


def _combined(stress: NDArray[np.float32], weights: NDArray[np.float64]) -> NDArray[np.float32]:
    """Stress of a side from those of the layers, shape (components, records, points)."""
    used = np.flatnonzero(weights)
    total: Any = (
        stress[used[0]] if weights[used[0]] == 1.0 else np.float32(weights[used[0]]) * stress[used[0]]
    )
    for layer in used[1:]:
        total = total + np.float32(weights[layer]) * stress[layer]
    found: NDArray[np.float32] = total
    return found


def _take_extremes(
    envelope: Envelope, stress: NDArray[np.float32], chosen: NDArray[np.int64], *, first: bool
) -> None:
    high, low = stress.max(axis=2).transpose(2, 0, 1), stress.min(axis=2).transpose(2, 0, 1)
    envelope.highest[chosen] = high if first else np.maximum(envelope.highest[chosen], high)
    envelope.lowest[chosen] = low if first else np.minimum(envelope.lowest[chosen], low)


def _take_envelope(
    envelope: Envelope, mises: NDArray[np.float32], chosen: NDArray[np.int64], side: int, first: int
) -> None:
    record = mises.argmax(axis=0)
    value = mises[record, np.arange(len(chosen))]
    higher = value > envelope.largest[chosen, side]
    envelope.largest[chosen[higher], side] = value[higher]
    envelope.record[chosen[higher], side] = first + record[higher]


def _take_group(
    history: GroupHistory, mises: NDArray[np.float32], member: _Members, part: slice, side: int
) -> None:
    if not len(member.places):
        return
    whole = len(member.places) == mises.shape[1]
    own = mises if whole else mises[:, member.places]
    _raise(history.largest[part, side], history.point[part, side], own, member.numbers)
    if member.strength is not None and history.utilisation is not None and history.used_point is not None:
        used = own / member.strength
        _raise(history.utilisation[part, side], history.used_point[part, side], used, member.numbers)


def _raise(
    largest: NDArray[np.float32],
    where: NDArray[np.int32],
    values: NDArray[np.float32],
    numbers: NDArray[np.int64],
) -> None:
    """Put what is larger in its place, record by record."""
    best = values.argmax(axis=1)
    value = values[np.arange(len(values)), best]
    higher = value > largest
    largest[higher] = value[higher]
    where[higher] = numbers[best[higher]]
