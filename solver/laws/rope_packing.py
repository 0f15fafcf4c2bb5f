"""Ropes of a scene become one kind: checks of what the user said, markers, winch tables, start lengths."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, records
from heavylift.solver.interface import FORCES, ROWS
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.packing import start_frames
from heavylift.solver.laws.rope_path import START_WRAP, PlaceGradient, RopePlace, path_length
from heavylift.solver.laws.system import LawBlock
from heavylift.solver.laws.wire_rope import PlaceMarkers, RopeEntry, Ropes, RopeState, WinchRow
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows.structure import Attachment
from heavylift.solver.scene.connections import GROUND, JointFrame, Rope, RopePoint, SpringRope, axes_about
from heavylift.solver.scene.scene import AnyBody

__all__ = ["LARGEST_STRAIN", "pack_ropes", "start_length"]

LARGEST_STRAIN = 0.02
"""Strain of a wire rope at the start above which it is refused: steel ropes break near it."""


def pack_ropes(
    ropes: Sequence[Rope | SpringRope],
    columns: Sequence[int],
    first_block: int,
    book: MarkerBook,
    attachment: Callable[[str], Attachment],
    scales: Callable[[str], tuple[float, float]],
    bodies: Sequence[AnyBody],
) -> tuple[Ropes, list[LawBlock]]:
    """Make the kind and its rows.

    Raises
    ------
    InputError
        If a rope has fewer than two points, ends on a pulley, has coincident neighbours, no stiffness, or is
        shorter than its path by more than it can stretch.
    """
    table: list[tuple[float, ...]] = []
    places: list[tuple[int, int, int]] = []
    winches: list[tuple[float, float, float]] = []
    paths: list[tuple[Any, ...]] = []
    blocks: list[LawBlock] = []
    state: list[tuple[float, ...]] = []
    block = first_block
    for rope, column in zip(ropes, columns, strict=True):
        points = _points(rope)
        path = start_path(rope, bodies)
        length = _unstretched(rope, path)
        held = list(dict.fromkeys(point.body for point in points if point.body != GROUND))
        if not held:
            raise InputError("no body", source=rope.name, key="path", expected="one point on a body at least")
        level = FORCES if rope.damping > 0.0 else ROWS
        first = len(places)
        for point in points:
            side = -1 if point.body == GROUND else 2 * block + held.index(point.body)
            axis = -1
            if point.radius > 0.0:
                axis = book.direction(point.body, _axes(rope, point)[:, 2], level, at=point.point)
            places.append((book.point(point.body, point.point, level), axis, side))
        rows = _winch_rows(rope) if isinstance(rope, Rope) else []
        stiffness = (rope.axial_stiffness, 0.0) if isinstance(rope, Rope) else (0.0, rope.stiffness)
        numbers = (block, len(held), first, len(points), len(winches), len(rows), column)
        table.append((*numbers, *stiffness, rope.damping, length))
        winches += rows
        paths += [(place.centre, place.axis, place.radius) for place in path]
        state.append((True, start_length(path), length, 0.0, 0.0, 0.0, 0.0, 0.0))
        blocks.append(
            LawBlock(
                rope.name,
                tuple(attachment(name) for name in held),
                sum(scales(name)[0] for name in held),
            )
        )
        block += blocks[-1].block_count
    kind = Ropes(
        records(RopeEntry, table),
        records(PlaceMarkers, places),
        records(WinchRow, winches),
        records(RopePlace, paths),
        records(PlaceGradient, len(places)),
        records(RopeState, state),
        np.full(len(places), START_WRAP),
    )
    return kind, blocks


def start_length(path: Records[RopePlace]) -> float:
    """Length of a path in the world [m]."""
    return float(path_length(path, records(PlaceGradient, len(path)), np.full(len(path), START_WRAP)))


def _axes(rope: Rope | SpringRope, point: RopePoint) -> NDArray[np.float64]:
    """Axes about that of a pulley, in the frame of its body."""
    return axes_about(point.axis, source=rope.name) if point.radius > 0.0 else np.eye(3)


def _points(rope: Rope | SpringRope) -> tuple[RopePoint, ...]:
    if isinstance(rope, Rope):
        return tuple(rope.path)
    return RopePoint(rope.body_a, rope.point_a), RopePoint(rope.body_b, rope.point_b)


def start_path(rope: Rope | SpringRope, bodies: Sequence[AnyBody]) -> Records[RopePlace]:
    """Places in the world at the start; checked.

    Raises
    ------
    InputError
        If they make no path.
    """
    points = _points(rope)
    if len(points) < 2:
        raise _error(rope, f"{len(points)} points", "path", "two points or more")
    path = records(RopePlace, len(points))
    for i, point in enumerate(points):
        if not 0.0 <= point.radius < math.inf or (point.radius > 0.0 and i in (0, len(points) - 1)):
            raise _error(
                rope,
                f"radius {point.radius} m of point {i + 1}",
                "path",
                "0 at the ends, 0 or more in between",
            )
        place = start_frames(
            FixedJoint(
                name=rope.name,
                body_a=GROUND,
                body_b=point.body,
                frame_b=JointFrame(np.asarray(point.point, dtype=np.float64), _axes(rope, point)),
            ),
            bodies,
        )[1]
        path[i] = (place.point, place.axes[:, 2], point.radius)
    for i, step in enumerate(np.linalg.norm(np.diff(path["centre"], axis=0), axis=1)):
        if not step > 1e-9 * (1.0 + float(np.abs(path["centre"]).max())):
            raise _error(rope, f"points {i + 1} and {i + 2} coincide", "path", "points apart from each other")
    if not math.isfinite(start_length(path)):
        raise _error(
            rope,
            "a point of the path lies inside the circle of the pulley next to it",
            "path",
            "neighbours of a pulley outside its radius",
        )
    return path


def _unstretched(rope: Rope | SpringRope, path: Records[RopePlace]) -> float:
    """Length at the start [m]; stiffness and damping are checked."""
    drawn = start_length(path)
    key, stiffness = (
        ("axial_stiffness", rope.axial_stiffness) if isinstance(rope, Rope) else ("stiffness", rope.stiffness)
    )
    if not 0.0 < stiffness < math.inf:
        raise _error(rope, f"{stiffness}", key, "a positive number")
    if not 0.0 <= rope.damping < math.inf:
        raise _error(rope, f"{rope.damping} N s/m", "damping", "0 or more")
    length = drawn if rope.length is None else float(rope.length)
    smallest = 0.0 if isinstance(rope, Rope) else -1e-300
    if not smallest < length < math.inf:
        raise _error(rope, f"{length} m", "length", "a positive length")
    if isinstance(rope, Rope) and drawn > length * (1.0 + LARGEST_STRAIN):
        raise _error(
            rope,
            f"the rope of {length:.6g} m is {drawn - length:.4g} m shorter than its path of {drawn:.6g} m:"
            f" a strain of {100.0 * (drawn / length - 1.0):.3g} %",
            "length",
            f"at least {drawn / (1.0 + LARGEST_STRAIN):.6g} m; or another start, or no length for one as drawn",
        )
    return length


def _winch_rows(rope: Rope) -> list[tuple[float, float, float]]:
    """Time, speed and length hauled in since t = 0."""
    if rope.winch is None:
        return []
    winch = rope.winch
    times, speeds = (np.atleast_1d(np.asarray(v, dtype=np.float64)) for v in (winch.times, winch.speeds))
    good = times.ndim == 1 and times.shape == speeds.shape and len(times) > 0
    if not (
        good and np.all(np.diff(times) > 0.0) and np.all(np.isfinite(times)) and np.all(np.isfinite(speeds))
    ):
        raise _error(
            rope,
            f"{times.size} times and {speeds.size} speeds",
            "winch",
            "one finite speed a time, times increasing",
        )
    hauled = np.concatenate([[0.0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * np.diff(times))])
    return [
        (float(t), float(v), float(x))
        for t, v, x in zip(times, speeds, hauled - _at_zero(times, speeds, hauled), strict=True)
    ]


def _at_zero(times: NDArray[np.float64], speeds: NDArray[np.float64], hauled: NDArray[np.float64]) -> float:
    """Integral of the speed from the first row to t = 0."""
    if times[0] >= 0.0:
        return float(-speeds[0] * times[0])
    if times[-1] <= 0.0:
        return float(hauled[-1] - speeds[-1] * times[-1])
    i = int(np.searchsorted(times, 0.0, side="right")) - 1
    t = -times[i]
    slope = (speeds[i + 1] - speeds[i]) / (times[i + 1] - times[i])
    return float(hauled[i] + t * (speeds[i] + 0.5 * slope * t))


def _error(rope: Rope | SpringRope, problem: str, key: str, expected: str) -> InputError:
    return InputError(problem, source=rope.name, key=key, expected=expected)
