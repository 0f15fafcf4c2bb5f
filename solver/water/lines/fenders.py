"""Fenders: one-sided springs along a direction that is fixed to a body."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import field
from itertools import pairwise
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats2
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Absent, BodyDirection, Positive, Quantity, Shape
from heavylift.numerics.records import Record, Records, records
from heavylift.solver.extremes import Extremes, Store, largest_of, note_stored, note_value, smallest_of
from heavylift.solver.force_elements.forces import mean_force, spring_force
from heavylift.solver.interface import (
    FORCES,
    Workspace,
    add_forces,
    record_forces,
    watch_forces,
)
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.recording import outputs_at
from heavylift.solver.ringing import steady_rate
from heavylift.solver.scene.connections import Between
from heavylift.solver.scene.descriptions import no_rows
from heavylift.solver.scene.drawn import At, Element, Pad
from heavylift.solver.scene.moorings import MOORINGS
from heavylift.solver.scene.outputs import Columns, Outputs, channel, largest, outputs, smallest

__all__ = ["Fender", "FenderOutputs", "Fenders", "fender_markers", "pack_fenders"]


@outputs
class FenderOutputs(Outputs):
    """What a fender records."""

    force: float = channel("force", "force of the fender along its normal")
    compression: float = channel("length", "compression of the fender, 0 while nothing presses it")
    force_max: float = largest("force", "force", seen="in the middles of all steps")
    force_min: float = smallest("force", "force", seen="in the middles of all steps")


@MOORINGS.describe("fenders")
@dataclass(frozen=True, eq=False, kw_only=True)
class Fender(Between):
    """A one-sided spring on a plane face, which pushes two bodies apart."""

    CHANNELS: ClassVar = FenderOutputs.CHANNELS
    SENTENCES: ClassVar = {
        "between": 'Body, or ``"ground"``, that it is mounted on, and the one that presses it.',
        "points": "Its tip when it is not compressed, and the point that presses it, in the coordinates of the "
        "geometries; of the ground in the world [m].",
    }

    direction: Annotated[NDArray[np.float64], BodyDirection()]
    """Outward normal of its face in the axes of the first body."""
    stiffness: Annotated[float, Positive("stiffness"), Absent()] = 0.0
    """[N/m]."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """[N s/m]; limited so that it never pulls."""
    compressions: Annotated[
        NDArray[np.float64], Quantity("length", minimum=0.0, closed=True), Shape((None,))
    ] = field(default_factory=no_rows)
    """In place of `stiffness`, a table from 0 on [m]."""
    forces: Annotated[NDArray[np.float64], Quantity("force", minimum=0.0, closed=True), Shape((None,))] = (
        field(default_factory=no_rows)
    )
    """[N], one a compression."""

    def drawn(self) -> Iterable[Element]:
        """A pad with its face at its tip."""
        at = At(self.body_a, np.asarray(self.point_a))
        yield Pad(name=self.name, role="fender", at=at, normal=np.asarray(self.direction))

    @staticmethod
    def check_sides(between: tuple[str, str]) -> None:
        """Two bodies, or a body and the ground."""
        if between[0] == between[1]:
            raise InputError(
                f"both sides are {between[0]!r}", expected="two bodies, or a body and the ground"
            )

    @staticmethod
    def check(spec: Any) -> None:
        """A stiffness, or a table."""
        if (spec.stiffness is None) == (len(spec.compressions) == 0):
            problem = "neither 'stiffness' nor 'compressions'" if spec.stiffness is None else "both"
            raise InputError(problem, expected="'stiffness', or a table of 'compressions' and 'forces'")
        rows = spec.compressions
        if len(rows) and (len(rows) != len(spec.forces) or any(b <= a for a, b in pairwise(rows))):
            raise InputError(
                f"{len(rows)} compressions and {len(spec.forces)} forces",
                key="compressions",
                expected="increasing compressions from 0, one force each",
            )


class FenderData(Record):
    """A fender.

    Attributes
    ----------
    tip, normal, point
        Markers of the tip, the normal and the point that presses.
    column
        First record column.
    first, count
        First row and rows of the curve.
    stiffness
        [N/m].
    damping
        [N s/m].
    """

    tip: int
    normal: int
    point: int
    column: int
    first: int
    count: int
    stiffness: float
    damping: float


class FenderState(Record):
    """What a fender remembers.

    Attributes
    ----------
    start_energy, started
        Energy at the start [J], and whether that is known.
    time, rate, force, energy
        Last evaluation [s]: how fast it was compressed [m/s], its force [N] and what it stores [J].
    mean_time, mean_rate, before_time, before_rate
        The same in the middles of the last step and the one before.
    steps
        How many of them are known, at most two.
    extremes
        Of the force.
    store
        What it stores in the middles of the steps.
    """

    start_energy: float
    started: bool
    time: float
    rate: float
    force: float
    energy: float
    mean_time: float
    mean_rate: float
    before_time: float
    before_rate: float
    steps: int
    extremes: Extremes
    store: Store


fender_outputs = outputs_at(FenderOutputs)


class Fenders(Arrays):
    """All fenders of a scene.

    Attributes
    ----------
    table
        Fenders.
    curves
        Rows (compression, force) of all tables, shape (m, 2).
    state
        Carried, of each.
    tangents, rate_tangents
        Stiffness [N/m] and damping [N s/m] of the force on b against the displacement and velocity of its point
        relative to the tip, world axes, row by row, symmetric and positive semidefinite; shape (n, 9).
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    table: Records[FenderData]
    curves: Floats2
    state: Records[FenderState]
    tangents: Floats2
    rate_tangents: Floats2


def fender_markers(book: MarkerBook, fenders: Sequence[Fender]) -> list[tuple[int, int, int]]:
    """Markers of tip, normal and pressing point of each fender.

    Raises
    ------
    InputError
        If a normal has length zero or is not finite.
    """
    markers = []
    for fender in fenders:
        direction = np.asarray(fender.direction, dtype=np.float64)
        length = float(np.linalg.norm(direction))
        if not 0.0 < length < np.inf:
            raise InputError(
                f"direction {direction.tolist()}",
                source=fender.name,
                key="direction",
                expected="the outward normal of its face",
            )
        markers.append(
            (
                book.point(fender.body_a, fender.point_a, FORCES),
                book.direction(fender.body_a, direction / length, FORCES, at=fender.point_a),
                book.point(fender.body_b, fender.point_b, FORCES),
            )
        )
    return markers


def pack_fenders(
    fenders: Sequence[Fender], markers: Sequence[tuple[int, int, int]], columns: Sequence[Columns]
) -> Fenders:
    """Make the kind from the scene, markers of `fender_markers`, and the first record column of each.

    Raises
    ------
    InputError
        If a fender has neither stiffness nor table or both, a negative number, or a table that does not rise from
        zero.
    """
    count = len(fenders)
    table, curves = records(FenderData, count), []
    first = 0
    for entry, fender, places, column in zip(table, fenders, markers, columns, strict=True):
        curve = _check_law(fender)
        entry.tip, entry.normal, entry.point = places
        entry.column = column.at(FenderOutputs)
        entry.first, entry.count = first, len(curve)
        entry.stiffness, entry.damping = fender.stiffness, fender.damping
        curves.append(curve)
        first += len(curve)
    return Fenders(
        table,
        np.vstack([np.zeros((0, 2)), *curves]),
        records(FenderState, count),
        np.zeros((count, 9)),
        np.zeros((count, 9)),
    )


def _check_law(fender: Fender) -> NDArray[np.float64]:
    """Rows of the table of a fender, shape (m, 2); none if it has a stiffness."""
    e = np.asarray(fender.compressions, dtype=np.float64)
    f = np.asarray(fender.forces, dtype=np.float64)
    if e.shape != f.shape or e.ndim != 1:
        raise InputError(
            f"{e.size} compressions and {f.size} forces",
            source=fender.name,
            key="compressions",
            expected="one force [N] a compression [m]",
        )
    for key, value in (("stiffness", fender.stiffness), ("damping", fender.damping)):
        if not 0.0 <= value < np.inf:
            raise InputError(
                f"{key} is {value:g}", source=fender.name, key=key, expected="a finite value, 0 or more"
            )
    if (fender.stiffness > 0.0) == (len(e) > 0):
        raise InputError(
            "a stiffness and a table" if len(e) else "neither stiffness nor table",
            source=fender.name,
            key="stiffness",
            expected="one of the two",
        )
    if len(e) == 0:
        return np.zeros((0, 2))
    rises = (
        len(e) > 1 and e[0] == 0.0 and f[0] == 0.0 and np.all(np.diff(e) > 0.0) and np.all(np.diff(f) >= 0.0)
    )
    if not (rises and np.all(np.isfinite(e)) and np.all(np.isfinite(f))):
        raise InputError(
            f"compressions {e.tolist()}, forces {f.tolist()}",
            source=fender.name,
            key="compressions",
            expected="two or more rows from (0, 0), compressions increasing, forces not falling",
        )
    return np.column_stack([e, f])


@kernel(internal=True)
def _compression(kind: Fenders, i: int, work: Workspace) -> tuple[float, float]:
    """How far the point of b is behind the tip [m], and how fast it goes there [m/s]."""
    fender = kind.table[i]
    a, n, b = fender.tip, fender.normal, fender.point
    depth = rate = 0.0
    for k in range(3):
        r = work.markers[b].point[k] - work.markers[a].point[k]
        v = work.markers[b].velocity[k] - work.markers[a].velocity[k]
        depth -= r * work.markers[n].point[k]
        rate -= v * work.markers[n].point[k] + r * work.markers[n].velocity[k]
    return depth, rate


@kernel(internal=True)
def _push(kind: Fenders, i: int, depth: float, rate: float) -> tuple[float, float, float]:
    """Force of a fender [N], its stiffness [N/m] and damping [N s/m] at present."""
    if not depth > 0.0:
        return 0.0, 0.0, 0.0
    fender = kind.table[i]
    first, count, stiffness, damping = fender.first, fender.count, fender.stiffness, fender.damping
    force = spring_force(kind.curves, first, count, stiffness, depth)
    if count > 0:  # half the mean over nothing is the slope
        stiffness = 2.0 * mean_force(kind.curves, first, count, stiffness, depth, depth)[1]
    if force + damping * rate <= 0.0:
        return 0.0, 0.0, 0.0
    return force + damping * rate, stiffness, damping


@kernel(internal=True)
def _stored(kind: Fenders, i: int, depth: float) -> float:
    """What a fender stores at a depth [J]."""
    fender, pressed = kind.table[i], max(depth, 0.0)
    return pressed * mean_force(kind.curves, fender.first, fender.count, fender.stiffness, 0.0, pressed)[0]


@implement(add_forces, Fenders)
@kernel(internal=True)
def add_fenders(kind: Fenders, time: float, work: Workspace) -> None:
    """Force on both sides, and stiffness.

    Notes
    -----
    The power of a force f is ``f d/dt ((b - a) . n)``: f n on the point of b, -f n on the tip, and f (b - a) on the
    direction n, which moves the force on a from the tip to where b presses.
    """
    for i in range(kind.table.shape[0]):
        a, n, b = kind.table[i].tip, kind.table[i].normal, kind.table[i].point
        depth, rate = _compression(kind, i, work)
        force, stiffness, damping = _push(kind, i, depth, rate)
        kind.state[i].time, kind.state[i].rate, kind.state[i].force = time, rate, force
        kind.state[i].energy = _stored(kind, i, depth)
        n1, n2, n3 = work.markers[n].point[0], work.markers[n].point[1], work.markers[n].point[2]
        normal = (n1, n2, n3)
        for j in range(3):
            for k in range(3):
                kind.tangents[i, 3 * j + k] = stiffness * normal[j] * normal[k]
                kind.rate_tangents[i, 3 * j + k] = damping * normal[j] * normal[k]
        if force > 0.0:
            for k in range(3):
                r = work.markers[b].point[k] - work.markers[a].point[k]
                work.markers[b].force[k] += force * normal[k]
                work.markers[a].force[k] -= force * normal[k]
                work.markers[n].force[k] += force * r


@implement(watch_forces, Fenders)
@kernel(internal=True)
def watch_fenders(kind: Fenders, work: Workspace) -> None:
    """Forces and rates that were found in the middle of the step."""
    for i in range(kind.table.shape[0]):
        state = kind.state[i]
        note_value(state.extremes, work.control.interval, state.force)
        note_stored(state.store, state.energy)
        state.before_time, state.before_rate = state.mean_time, state.mean_rate
        state.mean_time, state.mean_rate = state.time, state.rate
        state.steps = min(state.steps + 1, 2)


@kernel(internal=True)
def _end_rate(state: FenderState, time: float, rate: float) -> float:
    """How fast a fender is compressed at the end of a step, without what rings, from the rate by its velocities."""
    if state.steps < 2:
        return rate
    slope = (state.mean_rate - state.before_rate) / (state.mean_time - state.before_time)
    return steady_rate(state.mean_rate, slope * (time - state.mean_time), rate)


@implement(record_forces, Fenders)
@kernel(internal=True)
def record_fenders(kind: Fenders, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """Force and compression; the stored energy moves from the work of outer forces to its own."""
    for i in range(kind.table.shape[0]):
        state, out = kind.state[i], fender_outputs(row, kind.table[i].column)
        depth, rate = _compression(kind, i, work)
        force = _push(kind, i, depth, _end_rate(state, time, rate))[0]
        depth = max(depth, 0.0)
        out.force, out.compression = force, depth
        out.force_max = largest_of(state.extremes, work.control.interval, force)
        out.force_min = smallest_of(state.extremes, work.control.interval, force)
        energy = _stored(kind, i, depth)
        if not state.started:
            state.start_energy, state.started = energy, True
        work.sums.elastic += energy
        work.sums.external_work += energy - state.start_energy
