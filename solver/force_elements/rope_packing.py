"""Ropes of a scene become one kind: checks of the input, markers, winch tables, start lengths."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, filled, records
from heavylift.solver.extremes import Extremes
from heavylift.solver.force_elements.rope_path import START_WRAP, PlaceGradient, RopePlace
from heavylift.solver.force_elements.rows import ROWS_A_BLOCK
from heavylift.solver.force_elements.wire_rope import (
    LARGEST_STRAIN,
    PlaceMarkers,
    RopeEntry,
    Ropes,
    RopeState,
    WinchRow,
    start_length,
)
from heavylift.solver.interface import FORCES, ROWS
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.recording import placed
from heavylift.solver.scene.channels import Channel
from heavylift.solver.scene.connections import (
    GROUND,
    ControlOutputs,
    JointFrame,
    RopeParts,
    RopePoint,
    SheaveParts,
    axes_about,
    controlled,
    rubbing_places,
)

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackingContext

__all__ = ["LARGEST_DRIFT", "LARGEST_SHARE", "check_strains_at_rest", "make_ropes", "pack", "start_path"]

LARGEST_DRIFT, LARGEST_SHARE = 1.0, 0.1
"""Of a carried stretch from the path [m], and relative to the length: the smaller one ends the run. Ropes break at a
strain of two hundredths."""


def pack(ropes: Sequence[Any], context: PackingContext) -> None:
    """Make a kind of ropes that are planned, one of those with sheaves that rub, and one of those with a control.

    The accurate integrator takes them as forces, which have no rows.

    Raises
    ------
    InputError
        If a rope has fewer than two points, ends on a pulley, has coincident neighbours, no stiffness, or is
        shorter than its path by more than it can stretch, unless the scene comes to rest before time starts.
    """
    groups: tuple[list[Any], list[Any], list[Any]] = [], [], []
    for rope in ropes:
        groups[1 if rubbing_places(rope) else 2 if controlled(rope) else 0].append(rope)
    for group in filter(None, groups):
        kind = make_ropes(group, context)
        if rubbing_places(group[0]):
            kind = _with_friction(kind, group, context)
        elif controlled(group[0]):
            kind = _with_control(kind, group, context)
        context.add_rows(kind)
        if context.integrator == "accurate":
            context.add_forces(kind)


def make_ropes(ropes: Sequence[Any], context: PackingContext) -> Ropes:
    """Ropes of one tension and their rows, from which other kinds of ropes may be made.

    They have a `path`, an `axial_stiffness` or a `stiffness`, a `damping`, and perhaps a `length`, `tension`, `winch`.
    """
    as_forces, leaders = context.integrator == "accurate", context.watched.ropes
    table: list[RopeEntry] = []
    places: list[PlaceMarkers] = []
    winches: list[WinchRow] = []
    paths: list[RopePlace] = []
    drawn: list[float] = []
    for rope in ropes:
        points, block, column = rope.path, context.next_block, context.column(rope)
        path = start_path(rope, context)
        rows = _rows_of_both(rope, leaders)
        length = _unstretched(rope, path, rows, at_rest=context.scene.at_rest)
        held = list(dict.fromkeys(point.body for point in points if point.body != GROUND))
        level = FORCES if rope.damping > 0.0 or as_forces else ROWS
        first = len(places)
        for point in points:
            side = -1 if point.body == GROUND else 2 * block + held.index(point.body)
            axis = -1
            if point.radius > 0.0:
                axis = context.direction(point.body, _axes(rope, point)[:, 2], level, at=point.point)
            marker = context.point(point.body, point.point, level)
            places.append(filled(PlaceMarkers, marker=marker, axis=axis, attachment=side))
        drawn.append(start_length(path))
        table.append(
            filled(
                RopeEntry,
                block=-1 if as_forces else block,
                attachments=len(held),
                first=first,
                places=len(points),
                winch=len(winches),
                winch_rows=len(rows),
                column=column,
                parts=placed(RopeParts, column),
                shown=context.watched.first.get(rope.name, -1),
                axial_stiffness=getattr(rope, "axial_stiffness", 0.0),
                stiffness=getattr(rope, "stiffness", 0.0),
                damping=rope.damping,
                start_length=length,
                wanted=getattr(rope, "tension", None) or 0.0,
                largest_drift=min(LARGEST_DRIFT, LARGEST_SHARE * max(length, drawn[-1])),
            )
        )
        winches += rows
        paths.extend(path)
        if as_forces:
            continue
        rows_left = 1 + len(rubbing_places(rope))
        most = _rows_a_block(rows_left)
        while rows_left > 0:
            context.block(rope.name, held, rows=min(rows_left, most))
            rows_left -= most
    entries, carried = records(RopeEntry, table), records(RopeState, len(table))
    carried["fresh"], carried["stretched"], carried["rest"] = True, drawn, entries["start_length"]
    return Ropes(
        entries,
        records(PlaceMarkers, places),
        records(WinchRow, winches),
        records(RopePlace, paths),
        records(PlaceGradient, len(places)),
        carried,
        np.full(len(places), START_WRAP),
        np.full(len(places), START_WRAP),
        context.watched.pulls,
    )


def _rows_a_block(count: int) -> int:
    """Rows in a block of a rope with some: as few blocks as can be, all alike, as the largest one decides for all."""
    return -(-count // -(-count // ROWS_A_BLOCK))


def _with_control(kind: Ropes, ropes: Sequence[Any], context: PackingContext) -> Ropes:
    """The kind of ropes whose winches answer to their tension."""
    from heavylift.solver.force_elements.winch_control import (
        PLANNED,
        TABLED,
        ControlledRopes,
        ControlState,
        TensionRow,
        WinchControl,
    )

    controls: list[WinchControl] = []
    rows: list[TensionRow] = []
    for rope in ropes:
        winch, count = rope.winch, len(rope.winch.tensions)
        controls.append(
            filled(
                WinchControl,
                first=len(rows),
                count=count,
                band=winch.dead_band,
                speed=winch.speed if count else math.inf,
                brake=math.inf if winch.brake is None else winch.brake,
                mode=TABLED if count else PLANNED,
                wanted=0.0,
                group=0,
                column=context.column(rope).at(ControlOutputs),
            )
        )
        if count:
            table = zip(winch.times, winch.tensions, strict=True)
            rows += [filled(TensionRow, time=time, tension=tension) for time, tension in table]
    return ControlledRopes(
        **{name: getattr(kind, name) for name in kind._fields},
        controls=records(WinchControl, controls),
        control_state=records(ControlState, len(ropes)),
        tensions=records(TensionRow, rows),
    )


def _with_friction(kind: Ropes, ropes: Sequence[Any], context: PackingContext) -> Ropes:
    """The kind of ropes over sheaves with an efficiency."""
    from heavylift.solver.force_elements.sheave_friction import (
        Chain,
        ChainState,
        Sheave,
        SheavedRopes,
        SheaveState,
    )
    from heavylift.solver.force_elements.sheave_states import make_search

    chains: list[Chain] = []
    sheaves: list[Sheave] = []
    drums: list[WinchRow] = []
    flow = 0
    for entry, rope in zip(kind.table, ropes, strict=True):
        rubbing = rubbing_places(rope)
        rows = _rows_a_block(1 + len(rubbing))
        stride = max(1, (entry.attachments + 1) // 2)
        winch = getattr(rope, "winch", None)
        winch_last = 0.0 if winch is None else {"first": 0.0, "both": 0.5, "last": 1.0}[winch.end]
        last: list[WinchRow] = []
        if rope.other_winch is not None:
            last = _winch_rows(rope, context.watched.ropes, "winch" if winch_last == 1.0 else "other_winch")
        chain = Chain.one()  # the rest is scratch
        chain.first, chain.count = len(sheaves), len(rubbing)
        chain.stride, chain.rows, chain.flow = stride, rows, flow
        chain["parts"] = placed(SheaveParts, context.column(rope))
        chain.winch_last, chain.drum, chain.drum_rows = winch_last, len(drums), len(last)
        chains.append(chain)
        drums += last
        for row, place in enumerate(rubbing, start=1):
            part, lane = divmod(row, rows)
            point = rope.path[place - 1]
            sheaves.append(
                filled(
                    Sheave,
                    place=entry.first + place - 1,
                    block=entry.block + part * stride,
                    lane=lane,
                    flow=flow + part * ROWS_A_BLOCK + lane,
                    efficiency=point.efficiency,
                    bearing=point.efficiency,
                    friction=point.friction,
                )
            )
        flow += (len(rubbing) // rows + 1) * ROWS_A_BLOCK
    places = len(kind.places)
    held = {stop.body for rope in ropes for stop in rope.path if stop.body != GROUND}
    widest = max(context.attachment(name).width for name in held)
    return SheavedRopes(
        **{name: getattr(kind, name) for name in kind._fields},
        chains=records(Chain, chains),
        chain_state=records(ChainState, len(chains)),
        sheaves=records(Sheave, sheaves),
        sheave_state=records(SheaveState, len(sheaves)),
        drums=records(WinchRow, drums),
        leaving=records(PlaceGradient, places),
        parts=np.zeros(places),
        tension=np.zeros(places),
        part_extremes=records(Extremes, places),
        slope=np.zeros(places),
        flows=np.zeros(flow),
        by_place=np.zeros((places, widest)),
        whole=np.zeros((int(kind.table["attachments"].max()), widest)),
        beyond=np.zeros((int(kind.table["attachments"].max()), widest)),
        search=make_search(len(sheaves), len(chains)),
    )


def _axes(rope: Any, point: RopePoint) -> NDArray[np.float64]:
    """Axes about that of a pulley, in the frame of its body."""
    return axes_about(point.axis, source=rope.name) if point.radius > 0.0 else np.eye(3)


def start_path(rope: Any, context: PackingContext) -> Records[RopePlace]:
    """Places in the world at the start; checked.

    Raises
    ------
    InputError
        If they make no path.
    """
    points = rope.path
    if len(points) < 2:
        raise _error(rope, f"{len(points)} points", "path", "two points or more")
    path = records(RopePlace, len(points))
    for i, point in enumerate(points):
        place = context.start_frames(
            FixedJoint(
                name=rope.name,
                body_a=GROUND,
                body_b=point.body,
                frame_b=JointFrame(np.asarray(point.point, dtype=np.float64), _axes(rope, point)),
            )
        )[1]
        path[i] = filled(RopePlace, centre=place.point, axis=place.axes[:, 2], radius=point.radius)
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


def _unstretched(rope: Any, path: Records[RopePlace], rows: Sequence[WinchRow], *, at_rest: bool) -> float:
    """Length at the start [m]; that of a wire rope is checked, unless `check_strains_at_rest` does it later."""
    drawn = start_length(path)
    tension, winch = getattr(rope, "tension", None), getattr(rope, "winch", None)
    if tension is not None:
        if tension > LARGEST_STRAIN * rope.axial_stiffness:
            raise _error(
                rope,
                f"{tension:.6g} N is a strain of {100.0 * tension / rope.axial_stiffness:.3g} %",
                "tension",
                f"at most {LARGEST_STRAIN * rope.axial_stiffness:.6g} N, {100.0 * LARGEST_STRAIN:g} % of EA",
            )
        return drawn / (1.0 + tension / rope.axial_stiffness)
    if winch is not None and len(winch.lengths):
        length = float(winch.lengths[0]) + (rows[0].hauled if winch.acceleration is None else 0.0)
    else:
        length = drawn if rope.length is None else float(rope.length)
    if hasattr(rope, "axial_stiffness") and not at_rest and drawn > length * (1.0 + LARGEST_STRAIN):
        raise _error(
            rope,
            f"the rope of {length:.6g} m is {drawn - length:.4g} m shorter than its path of {drawn:.6g} m:"
            f" a strain of {100.0 * (drawn / length - 1.0):.3g} %",
            "length",
            f"at least {drawn / (1.0 + LARGEST_STRAIN):.6g} m; or another start, or no length for"
            " the initial geometric length",
        )
    return length


def check_strains_at_rest(kinds: Iterable[Any], channels: Iterable[Channel]) -> None:
    """Refuse wire ropes that are stretched beyond what they bear where a scene has come to rest.

    Parameters
    ----------
    kinds
        Kinds of joints and forces; ropes are among them.
    channels
        Of the records, by whose columns ropes are known: those that are forces have no block.

    Raises
    ------
    InputError
        Names the rope that is strained most, with the strain.
    """
    worst, found = LARGEST_STRAIN, None
    for kind in kinds:
        if isinstance(kind, Ropes):
            for number in np.flatnonzero(kind.table["axial_stiffness"] > 0.0):
                strain = kind.tension_at_rest(int(number))[0] / kind.table[number].axial_stiffness
                if strain > worst:
                    worst, found = strain, kind.table[number]
    if found is not None:
        length = float(found.start_length)
        raise InputError(
            f"{length:.6g} m is shorter than the path of {length * (1.0 + worst):.6g} m at rest by"
            f" {length * worst:.4g} m, a strain of {100.0 * worst:.3g} %",
            source=next(one.name for one in channels if one.column == found.column).rpartition(".")[0],
            key="length",
            expected=f"at most {100.0 * LARGEST_STRAIN:g} % under the loads at rest: a longer or a stiffer rope",
        )


def _rows_of_both(rope: Any, leaders: Mapping[str, Any]) -> list[WinchRow]:
    """Rows of the winch of a rope, of two the sum of both: between all times of one of them both are smooth."""
    rows = _winch_rows(rope, leaders)
    if getattr(rope, "other_winch", None) is None:
        return rows
    both = (rows, _winch_rows(rope, leaders, "other_winch"))
    times = sorted({float(row.time) for table in both for row in table})
    found = [[_row_at(table, time) for table in both] for time in times]
    return [
        filled(
            WinchRow, time=a.time, speed=a.speed + b.speed, hauled=a.hauled + b.hauled, jerk=a.jerk + b.jerk
        )
        for a, b in found
    ]


def _row_at(rows: Sequence[WinchRow], time: float) -> WinchRow:
    """What a winch does from a time on: `heavylift.solver.force_elements.wire_rope.table_state`."""
    before = [row for row in rows if row.time <= time]
    start = before[-1] if before else rows[0]
    t, speed, jerk = time - start.time, start.speed, start.jerk
    if not before or len(before) == len(rows):
        return filled(WinchRow, time=time, speed=speed, hauled=start.hauled + speed * t, jerk=0.0)
    end = rows[len(before)]
    span = end.time - start.time
    slope = (end.speed - speed) / span - 0.5 * jerk * span
    way = t * (speed + t * (0.5 * slope + jerk * t / 6.0))
    return filled(
        WinchRow,
        time=time,
        speed=speed + t * (slope + 0.5 * jerk * t),
        hauled=start.hauled + way,
        jerk=jerk,
    )


def _winch_rows(rope: Any, leaders: Mapping[str, Any], key: str = "winch") -> list[WinchRow]:
    """Time, speed, length hauled in since t = 0, and jerk; of one that follows those of its leader."""
    winch = getattr(rope, key, None)
    if winch is None:
        return []
    if winch.follow is not None:
        leader = getattr(leaders.get(winch.follow), "winch", None)
        if leader is None or not (len(leader.speeds) or len(leader.lengths)):
            planned = ", ".join(
                name
                for name, other in leaders.items()
                if getattr(other, "winch", None) and (len(other.winch.speeds) or len(other.winch.lengths))
            )
            raise _error(
                rope,
                f"{winch.follow!r} is no rope with a winch by 'speeds' or 'lengths'",
                f"{key}.follow",
                f"one of: {planned or 'none'}",
            )
        own, ratio = _winch_rows(leaders[winch.follow], leaders), winch.ratio
        return [
            filled(
                WinchRow,
                time=row.time,
                speed=ratio * row.speed,
                hauled=ratio * row.hauled,
                jerk=ratio * row.jerk,
            )
            for row in own
        ]
    if not (len(winch.speeds) or len(winch.lengths)):
        return []
    if winch.acceleration is not None:
        return [
            filled(WinchRow, time=time, speed=speed, hauled=way, jerk=jerk)
            for time, way, speed, _, jerk in winch.plan.tolist()
        ]
    times, speeds = winch.profile
    hauled = np.concatenate([[0.0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * np.diff(times))])
    return [
        filled(WinchRow, time=t, speed=v, hauled=x, jerk=0.0)
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


def _error(rope: Any, problem: str, key: str, expected: str) -> InputError:
    return InputError(problem, source=rope.name, key=key, expected=expected)
