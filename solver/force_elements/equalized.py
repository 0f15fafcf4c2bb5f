"""Lines of one force: an equalizer whose moving pulleys have no mass, as one row for all its lines.

Pulley i slides along a guide from its outlet A in the direction d, and a line of the length l leads from it to a lug B.
With ``w = B - A`` the line reaches the lug at the depth ::

    z = w . d - sqrt(l^2 - p^2),        p^2 = |w|^2 - (w . d)^2

All pulleys are on one rope, so ``sum z = Z``, and each is pulled up by twice its tension, which lines at the angle a to
the guide balance with ``F_i = 2 T / cos a_i``. That is one row: ``e = sum z - Z``, its force 2 T = K max(0, e), and the
stretch of lines and rope its compliance ``1/K = sum 1/k_i + 1/k_r`` ("Integrated simulation ... (2018)", section 2.4.7;
k_i = EA cos^2 a/l as drawn, k_r = 4 EA/L of the rope).

A pulley at a stop leaves that row and its line gets one of its own, ``F cos a = k_i max(0, z - stop)``: at the lower
stop the line takes whatever comes, at the upper one it goes slack. Rows change between steps, where both say the same,
so nothing jumps; the energy by which they miss that is booked as lost. Depths are carried with the rates of the rows,
as the lengths of ropes are (`heavylift.solver.force_elements.wire_rope`), and forces are discrete gradients of the
energy.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Least, Positive, Quantity, Shape
from heavylift.numerics.records import Record, Records
from heavylift.numerics.records import Vector as VectorField
from heavylift.solver.extremes import Agreement, Extremes, compare_force, largest_of, note_value, smallest_of
from heavylift.solver.force_elements.forces import pull
from heavylift.solver.force_elements.line_forces import LineForce
from heavylift.solver.force_elements.rows import RETURN, check_drift, fit_law, put_law, put_residual, row_rate
from heavylift.solver.interface import (
    Workspace,
    fill_rows,
    record_joints,
    relinearise,
    set_targets,
    update_rows,
    watch_joints,
)
from heavylift.solver.joints.row_writing import add_direction_row
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at, part
from heavylift.solver.ringing import steady_rate
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.connections import ROPES, AlongPath, RopePoint
from heavylift.solver.scene.outputs import Outputs, Part, Parts, channel, largest, outputs, smallest

__all__ = [
    "EqualizedEntry",
    "EqualizedLine",
    "EqualizedLines",
    "EqualizedState",
    "LineState",
    "SharedLines",
    "aim_lines",
    "all_lines",
    "carry_lines",
    "compare_depth",
    "depth_of_stop",
    "energy_of",
    "find_depth",
    "fit_lines",
    "force_of_all",
    "force_of_one",
    "line_force",
    "rate_of",
    "record_equalized",
    "watch_equalized",
]

SETTLING = 50
"""Rounds in which stops are found; each but the last sends a pulley to a stop or takes it off."""


@outputs
class EqualizedOutputs(Outputs):
    """What lines of one force record together, before `EqualizedParts`."""

    tension: float = channel("force", "tension of the rope over all pulleys")
    tension_max: float = largest("force", "tension")
    tension_min: float = smallest("force", "tension")


@outputs
class EqualizedParts(Parts):
    """What each line records, as a segment of a rope."""

    segment_tension: Part = channel("force", "tension of each line, from the first one on", None)
    segment_tension_max: Part = largest("force", "segment_tension", None)
    segment_tension_min: Part = smallest("force", "segment_tension", None)
    stop: Part = channel(
        "number", "of each line: -1 if its pulley is at the upper stop, 1 at the lower one, else 0", None
    )
    stopped_time: Part = channel("time", "of each line: how long so far its pulley has been at a stop", None)


@ROPES.describe("equalized")
@dataclass(frozen=True, eq=False, kw_only=True)
class SharedLines(AlongPath):
    """Lines of one force: an equalizer without the masses of its pulleys, as `[[equalizers]]` writes it."""

    CHANNELS: ClassVar = (*EqualizedOutputs.CHANNELS, *EqualizedParts.CHANNELS)
    """What it records, in the order of its columns; of segments the lines."""

    SEGMENT_NAME: ClassVar = "line"
    """What a segment is called."""

    name: str
    path: Annotated[tuple[RopePoint, ...], Least(4)]
    """An outlet and a lug for each line in turn; all outlets are on one body."""
    lengths: Annotated[NDArray[np.float64], Positive("length"), Shape((None,))]
    """Unstretched lengths of the lines [m]."""
    direction: Annotated[tuple[float, float, float], Quantity("number")] = (0.0, 0.0, -1.0)
    """Of all guides, in the coordinates of the geometry of that body; any length."""
    depth: Annotated[float, Positive("length")]
    """Mean of the depths of all pulleys below their outlets, without elongation [m]."""
    up: Annotated[float, Positive("length")]
    """Travel of a pulley from that depth towards its outlet [m]."""
    down: Annotated[float, Positive("length")]
    """Travel of a pulley from that depth away from its outlet [m]."""
    axial_stiffness: Annotated[float, Positive("force")]
    """EA of the rope over all pulleys [N]."""
    rope_length: Annotated[float, Positive("length")]
    """Unstretched length of that rope [m]."""
    line_stiffness: Annotated[float, Positive("force")]
    """EA of the lines [N]."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """Of each line: tension per rate of elongation [N s/m], while it is taut."""
    efficiency: Annotated[float, Quantity("number", minimum=0.5, maximum=1.0, closed=True)] = 1.0
    """Of all sheaves, moving and fixed, as that of a place in the path of a rope."""

    @staticmethod
    def check(spec: Any) -> None:
        """A length a line, eyes alone, one body with all outlets, travel within the depth."""
        if len(spec.path) != 2 * len(spec.lengths):
            raise InputError(
                f"{len(spec.path)} places and {len(spec.lengths)} lengths",
                key="lengths",
                expected="two places, outlet and lug, a length",
            )
        for place, stop in enumerate(spec.path):
            if stop.radius > 0.0:
                raise InputError("a pulley", key=f"path.{place}.radius", expected="places without 'radius'")
            if stop.efficiency < 1.0:
                raise InputError(
                    f"{stop.efficiency:.6g} of a place of lines",
                    key=f"path.{place}.efficiency",
                    expected="the 'efficiency' of the equalizer",
                )
        if len({stop.body for stop in spec.path[::2]}) > 1:
            raise InputError("outlets on several bodies", key="path", expected="all outlets on one body")
        if spec.up >= spec.depth:
            raise InputError(
                f"{spec.up:.6g} m at a depth of {spec.depth:.6g} m",
                key="up",
                expected=f"less than {spec.depth:.6g} m",
            )

    def packed_by(self, integrator: str) -> str:
        """Over sheaves with an efficiency they are another kind."""
        del integrator
        return "heavylift.solver.force_elements.equalized_packing"

    @property
    def segment_count(self) -> int:
        """How many tensions it records beside that of the rope."""
        return len(self.path) // 2

    @property
    def components(self) -> dict[str, tuple[str, ...]]:
        """Components of the channels that have one a line."""
        lines = tuple(str(i + 1) for i in range(self.segment_count))
        return {kind.name: lines for kind in EqualizedParts.CHANNELS}

    @property
    def legs(self) -> list[tuple[RopePoint, ...]]:
        """Pieces of the path as they are drawn."""
        return [(self.path[k], self.path[k + 1]) for k in range(0, len(self.path), 2)]


class EqualizedEntry(Record):
    """An equalizer.

    Attributes
    ----------
    block
        Number of the first block of the row of all lines.
    attachments
        How many sides it has.
    first, count
        Its first line, and how many.
    column, parts
        Of its `EqualizedOutputs`, and of its lines.
    shown
        Place in `EqualizedLines.pulls` of its first outlet, -1 if nothing watches what it pulls with.
    total
        Z, sum of the depths of the pulleys [m].
    compliance
        1/k_r of the rope [m/N].
    damping
        Of the row of all lines [N s/m].
    """

    block: int
    attachments: int
    first: int
    count: int
    column: int
    parts: EqualizedParts
    shown: int
    total: float
    compliance: float
    damping: float


equalized_outputs = outputs_at(EqualizedOutputs)


class EqualizedLine(Record):
    """A line.

    Attributes
    ----------
    outlet, lug, guide
        Markers of two points and a direction.
    block, attachments
        Number of the block of its own row, and how many sides that has.
    own_outlet, own_lug, all_outlet, all_lug
        Attachments of both ends in its own row and in that of all lines, -1 on the ground.
    length, stiffness
        Unstretched [m]; EA cos^2 a/l [N/m].
    low, high
        Depths of the pulley at its stops [m].
    damping
        Of its own row [N s/m].
    largest_drift
        Of the carried depth from the geometry that ends a run [m].
    """

    outlet: int
    lug: int
    guide: int
    block: int
    attachments: int
    own_outlet: int
    own_lug: int
    all_outlet: int
    all_lug: int
    length: float
    stiffness: float
    low: float
    high: float
    damping: float
    largest_drift: float


class LineState(Record):
    """What a line carries.

    Attributes
    ----------
    depth
        At which it reaches its lug unstretched, as carried [m].
    drift
        Geometry less carried depth [m].
    stop
        -1 if its pulley is at the upper stop, 1 at the lower one, else 0.
    rate
        Of its own row in the last step [m/s].
    by_lug, by_guide
        Derivatives of the depth by lug and guide; by the outlet minus that by the lug.
    cosine
        Of its angle to the guide.
    force
        Along the guide at the end of the last step [N].
    extremes
        Of the tension of the line [N].
    stopped
        How long its pulley has been at a stop [s].
    """

    depth: float
    drift: float
    stop: int
    rate: float
    by_lug: VectorField
    by_guide: VectorField
    cosine: float
    force: float
    extremes: Extremes
    stopped: float


class EqualizedState(Record):
    """What an equalizer carries.

    Attributes
    ----------
    fresh, paced
        Whether no step has been made yet; whether two have.
    rate, growth
        Of the row of all lines in the last step [m/s], and half its difference from that of the step before.
    loss
        What dampers and stops took [J].
    tension
        Of the rope at the end of the last step [N].
    extremes
        Of the tension.
    agreement
        Of twice the recorded tension with the depths of the geometry.
    rubbed
        Whether sheaves with an efficiency have made forces differ in the last step.
    """

    fresh: bool
    paced: bool
    rate: float
    growth: float
    loss: float
    tension: float
    extremes: Extremes
    agreement: Agreement
    rubbed: bool


class EqualizedLines(Arrays):
    """All equalizers of a scene without masses of pulleys.

    Attributes
    ----------
    table, lines
        The equalizers, and the lines of all of them.
    state, line
        What they carry.
    pulls
        What ropes that are watched pull with, shared by all kinds of ropes and by what watches them.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state", "line")

    table: Records[EqualizedEntry]
    lines: Records[EqualizedLine]
    state: Records[EqualizedState]
    line: Records[LineState]
    pulls: Records[LineForce]

    @property
    def given(self) -> NDArray[np.int64]:
        """Numbers of the ropes whose tension at the start is given: none."""
        return np.zeros(0, dtype=np.int64)

    def one_sided(
        self,
    ) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Block, sense, elongation and stiffness of rows that act, at rest: see `solver.statics.forces.OneSided`."""
        block, elongation, stiffness = [], [], []
        for entry in self.table:
            lines = slice(entry.first, entry.first + entry.count)
            line, depth, stop = self.lines[lines], self.line["depth"][lines], self.line["stop"][lines]
            at = np.where(stop > 0, line["high"], line["low"])
            block += [entry.block, *line["block"][stop != 0]]
            elongation += [np.where(stop == 0, depth, at).sum() - entry.total, *(depth - at)[stop != 0]]
            compliance = entry.compliance + (1.0 / line["stiffness"][stop == 0]).sum()
            stiffness += [1.0 / compliance, *line["stiffness"][stop != 0]]
        return np.array(block, dtype=np.int64), np.ones(len(block)), np.array(elongation), np.array(stiffness)


@kernel(internal=True)
def find_depth(kind: EqualizedLines, k: int, work: Workspace) -> float:
    """Depth at which a line reaches its lug [m]; its derivatives are kept. No number beyond its length."""
    entry, state = kind.lines[k], kind.line[k]
    w0 = work.markers[entry.lug].point[0] - work.markers[entry.outlet].point[0]
    w1 = work.markers[entry.lug].point[1] - work.markers[entry.outlet].point[1]
    w2 = work.markers[entry.lug].point[2] - work.markers[entry.outlet].point[2]
    d0 = work.markers[entry.guide].point[0]
    d1 = work.markers[entry.guide].point[1]
    d2 = work.markers[entry.guide].point[2]
    below = w0 * d0 + w1 * d1 + w2 * d2
    p0, p1, p2 = w0 - below * d0, w1 - below * d1, w2 - below * d2
    root = math.sqrt(entry.length * entry.length - (p0 * p0 + p1 * p1 + p2 * p2))
    state.by_lug[0], state.by_lug[1], state.by_lug[2] = d0 + p0 / root, d1 + p1 / root, d2 + p2 / root
    turn = 1.0 - below / root
    state.by_guide[0], state.by_guide[1], state.by_guide[2] = turn * w0, turn * w1, turn * w2
    state.cosine = root / entry.length
    return below - root


@kernel(inline=True, internal=True)
def depth_of_stop(kind: EqualizedLines, k: int) -> float:
    """Depth of the stop at which a pulley is [m]."""
    return kind.lines[k].high if kind.line[k].stop > 0 else kind.lines[k].low


@kernel(internal=True)
def all_lines(kind: EqualizedLines, i: int) -> tuple[float, float]:
    """Excess e of the depths [m] and stiffness K [N/m] of the row of all lines whose pulleys are at no stop."""
    entry = kind.table[i]
    excess, compliance = -entry.total, entry.compliance
    for k in range(entry.first, entry.first + entry.count):
        if kind.line[k].stop == 0:
            excess += kind.line[k].depth
            compliance += 1.0 / kind.lines[k].stiffness
        else:
            excess += depth_of_stop(kind, k)
    return excess, 1.0 / compliance


@kernel(internal=True)
def energy_of(kind: EqualizedLines, i: int) -> float:
    """Elastic energy [J]."""
    excess, stiffness = all_lines(kind, i)
    energy = 0.5 * stiffness * max(0.0, excess) ** 2
    for k in range(kind.table[i].first, kind.table[i].first + kind.table[i].count):
        if kind.line[k].stop != 0:
            energy += (
                0.5 * kind.lines[k].stiffness * max(0.0, kind.line[k].depth - depth_of_stop(kind, k)) ** 2
            )
    return energy


@kernel(internal=True)
def _settle(kind: EqualizedLines, i: int) -> None:
    """Send pulleys to their stops and take them off, until all agree: Newton's method on a broken line."""
    entry = kind.table[i]
    for _ in range(SETTLING):
        excess, stiffness = all_lines(kind, i)
        force, changed = stiffness * max(0.0, excess), False
        for k in range(entry.first, entry.first + entry.count):
            line, state = kind.lines[k], kind.line[k]
            stop = state.stop
            if stop == 0:
                depth = state.depth - force / line.stiffness
                stop = 1 if depth > line.high else (-1 if depth < line.low else 0)
            else:
                own = line.stiffness * max(0.0, state.depth - depth_of_stop(kind, k))
                if (stop > 0 and own < force) or (stop < 0 and own > force):
                    stop = 0
            if stop != state.stop:
                state.stop, changed = stop, True
        if not changed:
            return


@kernel(internal=True)
def compare_depth(kind: EqualizedLines, i: int, k: int, depth: float) -> None:
    """Take the geometry before the first step and while a line is slack; measure the drift."""
    state = kind.line[k]
    if kind.state[i].fresh:
        state.depth = depth
    elif state.stop == 0:
        excess, _ = all_lines(kind, i)
        if excess <= 0.0:
            state.depth = min(depth, state.depth - excess)  # a drift must not make tension
    elif state.depth <= depth_of_stop(kind, k):
        state.depth = min(depth, depth_of_stop(kind, k))
    state.drift = depth - state.depth


@kernel(inline=True, internal=True)
def _clear(system: RowArrays, block: int, count: int) -> None:
    for side in range(2 * block, 2 * block + count):
        panel = system.attachments[side].panel
        for k in range(system.attachments[side].width):
            system.panels[panel + k * system.lanes] = 0.0


@kernel(internal=True)
def _add_line(
    kind: EqualizedLines, k: int, outlet: int, lug: int, work: Workspace, system: RowArrays
) -> None:
    """Add ``dz/dB . (J_B - J_A) + dz/dd . J_d`` to a row with these attachments."""
    entry, state = kind.lines[k], kind.line[k]
    g = (state.by_lug[0], state.by_lug[1], state.by_lug[2])
    if lug >= 0:
        add_direction_row(system, lug, 0, work, entry.lug, g)
    if outlet >= 0:
        add_direction_row(system, outlet, 0, work, entry.outlet, (-g[0], -g[1], -g[2]))
        turn = (state.by_guide[0], state.by_guide[1], state.by_guide[2])
        add_direction_row(system, outlet, 0, work, entry.guide, turn)


@implement(fill_rows, EqualizedLines)
@kernel(internal=True)
def fill_equalized_rows(
    kind: EqualizedLines, with_residual: bool, work: Workspace, system: RowArrays
) -> None:
    """Row of all lines whose pulleys are at no stop, and a row of each line."""
    for i in range(kind.table.shape[0]):
        entry = kind.table[i]
        for k in range(entry.first, entry.first + entry.count):
            depth = find_depth(kind, k, work)
            if with_residual:
                compare_depth(kind, i, k, depth)
        if with_residual and kind.state[i].fresh:
            _settle(kind, i)
        _clear(system, entry.block, entry.attachments)
        for k in range(entry.first, entry.first + entry.count):
            line = kind.lines[k]
            _clear(system, line.block, line.attachments)
            _add_line(kind, k, line.own_outlet, line.own_lug, work, system)
            if kind.line[k].stop == 0:
                _add_line(kind, k, line.all_outlet, line.all_lug, work, system)
            if with_residual:
                put_residual(system, line.block, kind.line[k].depth - depth_of_stop(kind, k))
        if with_residual:
            put_residual(system, entry.block, all_lines(kind, i)[0])


@kernel(internal=True)
def force_of_all(kind: EqualizedLines, i: int, u: float, h: float) -> tuple[float, float, float]:
    """Elastic force, force, and its derivative by the rate u, mean over a step."""
    excess, stiffness = all_lines(kind, i)
    elastic, force, slope = pull(excess, excess + h * u, stiffness, kind.table[i].damping, h)
    return elastic, force, h * slope


@kernel(internal=True)
def force_of_one(kind: EqualizedLines, k: int, u: float, h: float) -> tuple[float, float, float]:
    """The same of a line whose pulley is at a stop."""
    line, e = kind.lines[k], kind.line[k].depth - depth_of_stop(kind, k)
    elastic, force, slope = pull(e, e + h * u, line.stiffness, line.damping, h)
    return elastic, force, h * slope


@kernel(internal=True)
def aim_lines(kind: EqualizedLines, i: int, step: float, system: RowArrays) -> None:
    """Rows of an equalizer by the rates of the last step."""
    entry, u = kind.table[i], kind.state[i].rate
    _, force, slope = force_of_all(kind, i, u, step)
    put_law(system, entry.block, step, u, force, slope)
    for k in range(entry.first, entry.first + entry.count):
        u = kind.line[k].rate
        force = slope = 0.0
        if kind.line[k].stop != 0:
            _, force, slope = force_of_one(kind, k, u, step)
        put_law(system, kind.lines[k].block, step, u, force, slope)


@implement(set_targets, EqualizedLines)
@kernel(internal=True)
def set_equalized_targets(
    kind: EqualizedLines, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """First guess: rates of the last step."""
    if not at_midpoint:
        return
    for i in range(kind.table.shape[0]):
        aim_lines(kind, i, step, system)


@kernel(inline=True, internal=True)
def rate_of(system: RowArrays, block: int, attachments: int, work: Workspace) -> float:
    """Rate of a row in the middle of the step [m/s]."""
    return row_rate(system, 2 * block, 2 * block + attachments, work.velocity)


@kernel(internal=True)
def fit_lines(kind: EqualizedLines, i: int, step: float, work: Workspace, system: RowArrays) -> None:
    """Fit the forces of an equalizer to the rates found."""
    entry = kind.table[i]
    u = rate_of(system, entry.block, entry.attachments, work)
    _, force, slope = force_of_all(kind, i, u, step)
    fit_law(system, entry.block, step, u, force, slope, work)
    for k in range(entry.first, entry.first + entry.count):
        if kind.line[k].stop == 0:
            continue
        line = kind.lines[k]
        u = rate_of(system, line.block, line.attachments, work)
        _, force, slope = force_of_one(kind, k, u, step)
        fit_law(system, line.block, step, u, force, slope, work)


@implement(relinearise, EqualizedLines)
@kernel(internal=True)
def relinearise_equalized(
    kind: EqualizedLines, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Fit the forces to the rates found."""
    for i in range(kind.table.shape[0]):
        fit_lines(kind, i, step, work, system)


@kernel(internal=True)
def carry_lines(kind: EqualizedLines, i: int, step: float, work: Workspace, system: RowArrays) -> None:
    """Carry the depths of an equalizer over a step; what dampers took; stops."""
    entry, state = kind.table[i], kind.state[i]
    u = rate_of(system, entry.block, entry.attachments, work)
    elastic, force, _ = force_of_all(kind, i, u, step)
    state.loss += (force - elastic) * step * u
    for k in range(entry.first, entry.first + entry.count):
        line, own = kind.lines[k], kind.line[k]
        rate = rate_of(system, line.block, line.attachments, work)
        if own.stop != 0:
            elastic, force, _ = force_of_one(kind, k, rate, step)
            state.loss += (force - elastic) * step * rate
        own.depth += step * rate + RETURN * min(0.0, own.drift)
        own.rate = rate
    before = energy_of(kind, i)
    _settle(kind, i)
    state.loss += before - energy_of(kind, i)
    state.growth = step / (step + work.control.last_step) * (u - state.rate)
    state.rate, state.paced = u, not state.fresh
    state.fresh = False


@implement(update_rows, EqualizedLines)
@kernel(internal=True)
def update_equalized(
    kind: EqualizedLines, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Carry the depths over the step; what dampers took; stops."""
    for i in range(kind.table.shape[0]):
        carry_lines(kind, i, step, work, system)


@kernel(internal=True)
def _end_force(kind: EqualizedLines, i: int, rate: float) -> float:
    """Twice the tension of the rope at the end of a step [N], where the row of all lines grows at a rate [m/s]."""
    state = kind.state[i]
    excess, stiffness = all_lines(kind, i)
    if excess <= 0.0:
        return 0.0
    stretching = steady_rate(state.rate, state.growth, rate) if state.paced else rate
    return max(0.0, stiffness * excess + kind.table[i].damping * stretching)


@kernel(internal=True)
def line_force(kind: EqualizedLines, i: int, k: int) -> float:
    """Force of a line along its guide at the end of a step [N]."""
    line, own = kind.lines[k], kind.line[k]
    if own.stop == 0:
        return 2.0 * kind.state[i].tension
    e = own.depth - depth_of_stop(kind, k)
    return max(0.0, line.stiffness * e + line.damping * own.rate) if e > 0.0 else 0.0


@kernel(internal=True)
def _end_lines(kind: EqualizedLines, i: int, rate: float) -> None:
    """Tension and forces of the lines at the end of a step, where the row of all lines grows at a rate [m/s]."""
    kind.state[i].tension = 0.5 * _end_force(kind, i, rate)
    for k in range(kind.table[i].first, kind.table[i].first + kind.table[i].count):
        kind.line[k].force = line_force(kind, i, k)


@kernel(internal=True)
def _show_lines(kind: EqualizedLines, i: int) -> None:
    """What each line pulls its outlet and its lug with."""
    entry = kind.table[i]
    if entry.shown < 0:
        return
    for k in range(entry.count):
        own = kind.line[entry.first + k]
        force = own.force
        outlet, lug = kind.pulls[entry.shown + 2 * k], kind.pulls[entry.shown + 2 * k + 1]
        outlet.tension, lug.tension = force / own.cosine, 0.0
        for j in range(3):
            outlet.force[j], lug.force[j] = force * own.by_lug[j], -force * own.by_lug[j]


@implement(watch_joints, EqualizedLines)
@kernel(internal=True)
def watch_equalized(kind: EqualizedLines, work: Workspace, system: RowArrays) -> None:
    """Tensions at the end of the step; depths that have left what is carried end the run."""
    for i in range(kind.table.shape[0]):
        entry, state = kind.table[i], kind.state[i]
        for k in range(entry.first, entry.first + entry.count):
            check_drift(kind.lines[k].block, kind.line[k].drift, kind.lines[k].largest_drift, work)
        rate = rate_of(system, entry.block, entry.attachments, work) if entry.damping > 0.0 else 0.0
        if not state.rubbed:
            _end_lines(kind, i, rate)
        note_value(state.extremes, work.control.interval, state.tension)
        for k in range(entry.first, entry.first + entry.count):
            own = kind.line[k]
            note_value(own.extremes, work.control.interval, own.force / own.cosine)
            if own.stop != 0:
                own.stopped += work.control.last_step
        _show_lines(kind, i)


@kernel(internal=True)
def _compare_force(kind: EqualizedLines, i: int, time: float) -> None:
    """The force of all lines is that of the geometry and, of the damper, of the mean rates of the last two steps."""
    entry, state = kind.table[i], kind.state[i]
    excess, stiffness = all_lines(kind, i)
    for k in range(entry.first, entry.first + entry.count):
        if kind.line[k].stop == 0:
            excess += kind.line[k].drift
    low = high = 0.0
    if excess > 0.0:
        elastic, change = stiffness * excess, abs(state.growth)
        low = max(0.0, elastic + entry.damping * (state.rate - change))
        high = max(0.0, elastic + entry.damping * (state.rate + change))
    compare_force(state.agreement, time, 2.0 * state.tension, low, high)


@implement(record_joints, EqualizedLines)
@kernel(internal=True)
def record_equalized(
    kind: EqualizedLines, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Tension of the rope, its extremes, tensions of the lines, theirs, and stops."""
    for i in range(kind.table.shape[0]):
        entry, state = kind.table[i], kind.state[i]
        for k in range(entry.first, entry.first + entry.count):
            compare_depth(kind, i, k, find_depth(kind, k, work))
            work.sums.drift = max(work.sums.drift, abs(kind.line[k].drift))
        if state.fresh:
            _settle(kind, i)
            _end_lines(kind, i, 0.0)
        elif state.paced and not state.rubbed:
            _compare_force(kind, i, time)
        out, parts, interval = equalized_outputs(row, entry.column), entry.parts, work.control.interval
        out.tension = state.tension
        out.tension_max = largest_of(state.extremes, interval, state.tension)
        out.tension_min = smallest_of(state.extremes, interval, state.tension)
        for k in range(entry.count):
            own = kind.line[entry.first + k]
            tension = own.force / own.cosine
            part(row, parts.segment_tension)[k] = tension
            part(row, parts.segment_tension_max)[k] = largest_of(own.extremes, interval, tension)
            part(row, parts.segment_tension_min)[k] = smallest_of(own.extremes, interval, tension)
            part(row, parts.stop)[k] = float(own.stop)
            part(row, parts.stopped_time)[k] = own.stopped
        _show_lines(kind, i)
        work.sums.elastic += energy_of(kind, i)
        work.sums.dissipated += state.loss
