"""Lines of one equalizer over sheaves with an efficiency: a force a line, without masses of pulleys.

The equalizer is that of "Integrated simulation ... (2018)", section 2.4.7, as in
`heavylift.solver.force_elements.equalized`; friction, which is not there, follows from the balance of each pulley
and from rope that is not lost.

Between the parts of the rope over n moving pulleys are 2 n - 1 sheaves, the moving ones and the fixed ones in turn.
With the tensions T_k of the parts, K_i of a line in a row with its share of the rope, and y_i, half of the rope that
hangs at a pulley, as long as it is unstretched::

    F_i = T_2i-1 + T_2i = K_i (z_i - y_i),              sum y_i = Z
    y_i' = (w_i-1 - w_i) / 2,     q_2i = w_i,     q_2i-1 = (w_i-1 + w_i) / 2,     w_0 = w_n = 0

w_i runs over fixed sheave i towards the last line. Each sheave holds or passes its part of the tension as that of a
rope (`heavylift.solver.force_elements.sheave_friction`). In the middle of a step all of this is linear while no
sheave changes its state. So forces of lines follow from the depths of all of them by one small system, with the
states of the last step or, if they contradict it, those of a search
(`heavylift.solver.force_elements.sheave_states`). A line is then a row of its own whose force is found by iteration,
as stiff as if its pulley did not move, which is more than any sheave allows.

A pulley at a stop holds its two parts of rope as a line of their share alone would, and its line is that of a stop.
Rope that is slack rubs on nothing: if one line is slack, all are, since no ratio of tensions is beyond that of the
sheaves. Then, at the start and in a search for equilibrium all forces are equal. The power ``sum f_j q_j`` is lost,
which is ``sum F_i y_i'``.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1, Floats2
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, Records
from heavylift.solver.extremes import compare_force
from heavylift.solver.force_elements.equalized import (
    EqualizedLines,
    aim_lines,
    all_lines,
    carry_lines,
    depth_of_stop,
    energy_of,
    fit_lines,
    force_of_one,
    line_force,
    rate_of,
    record_equalized,
    watch_equalized,
)
from heavylift.solver.force_elements.rows import RETURN, fit_law, put_law
from heavylift.solver.force_elements.sheave_states import SheaveSearch, find_states
from heavylift.solver.interface import (
    Workspace,
    record_joints,
    relinearise,
    set_targets,
    update_rows,
    watch_joints,
)
from heavylift.solver.kinds import implement
from heavylift.solver.rows.structure import RowArrays

__all__ = ["HeldLine", "LineSheave", "RubbingEntry", "RubbingLines", "find_line_forces"]

SHARING = 1e-5
"""Compliance of a sheave that sticks, relative to that of a line: what tells how many of them share."""

STUCK, SMALL = 3e-10, 1e-8
"""As those of sheaves of ropes: excess of a ratio of tensions at which a sheave sticks, and what counts as no flow."""


class RubbingEntry(Record):
    """An equalizer with friction.

    Attributes
    ----------
    sheave
        Its first sheave.
    share
        Compliance of the rope at one pulley [m/N].
    loss
        One less the efficiency.
    acting
        Scratch: whether it rubs in this step.
    """

    sheave: int
    share: float
    loss: float
    acting: bool


class HeldLine(Record):
    """What a line carries beside `LineState`.

    Attributes
    ----------
    content
        y [m].
    stretching, force
        Of the last step: rate of its elongation with the rope at its pulley [m/s], and F in its middle [N].
    """

    content: float
    stretching: float
    force: float


class LineSheave(Record):
    """What a sheave carries: its state, as that of a rope, and its friction in the middle of the last step [N]."""

    branch: int
    held: float


class RubbingLines(EqualizedLines):
    """All equalizers of a scene without masses of pulleys whose sheaves have an efficiency.

    Attributes
    ----------
    rubs
        Of each equalizer.
    held
        Of each line.
    sheaves
        Of all equalizers.
    compliance, way
        Scratch: of the lines of one, c_i and d_i in ``y_i' h = d_i - c_i F_i`` [m/N], [m].
    line_force
        Scratch: F_i [N].
    matrix
        Scratch: a row for each sheave, its friction, and a right side.
    search
        For states, with all that is known of the sheaves of one.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state", "line", "held", "sheaves")

    rubs: Records[RubbingEntry]
    held: Records[HeldLine]
    sheaves: Records[LineSheave]
    compliance: Floats1
    way: Floats1
    line_force: Floats1
    matrix: Floats2
    search: SheaveSearch


@kernel(internal=True)
def _respond(search: SheaveSearch, n: int, c: NDArray[np.float64], d: NDArray[np.float64]) -> float:
    """Flows and first tension without friction, and their derivatives by frictions; the sum of the c_i."""
    m = 2 * n - 1
    total = way = 0.0
    for i in range(n):
        total += c[i]
        way += d[i]
    first = 0.5 * way / total
    search.tension[0] = first
    w = 0.0
    for i in range(n):
        after = w - 2.0 * (d[i] - 2.0 * c[i] * first)
        search.flow[2 * i] = 0.5 * (w + after)
        if i < n - 1:
            search.flow[2 * i + 1] = after
        w = after
    for j in range(m):
        weighted = 0.0
        for i in range(j // 2, n):
            weighted += c[i] * (1.0 if 2 * i == j else (2.0 if j < 2 * i else 0.0))
        by = -0.5 * weighted / total
        search.stiffness[0, j] = by
        w = 0.0
        for i in range(n):
            of_line = (1.0 if 2 * i == j else (2.0 if j < 2 * i else 0.0)) + 2.0 * by
            after = w + 2.0 * c[i] * of_line
            search.response[2 * i, j] = 0.5 * (w + after)
            if i < n - 1:
                search.response[2 * i + 1, j] = after
            w = after
    return total


@kernel(internal=True)
def _solve_states(search: SheaveSearch, n: int, matrix: NDArray[np.float64], scale: float) -> bool:
    """Frictions, with the states as they are: Gauss with exchange of rows; false if that has no solution."""
    m = 2 * n - 1
    for j in range(m):
        if search.branch[j] == 0:
            for k in range(m):
                matrix[j, k] = scale * search.response[j, k]
            matrix[j, j] -= scale * search.creep[j]
            matrix[j, m] = -scale * (search.flow[j] + search.creep[j] * search.held[j])
            continue
        eta = 1.0 - search.loss[j]
        ratio = 1.0 / eta - 1.0 if search.branch[j] > 0 else eta - 1.0
        for k in range(m):
            matrix[j, k] = -ratio * (search.stiffness[0, k] + (1.0 if k < j else 0.0))
        matrix[j, j] += 1.0
        matrix[j, m] = ratio * search.tension[0]
    for k in range(m):
        best = k
        for j in range(k + 1, m):
            if abs(matrix[j, k]) > abs(matrix[best, k]):
                best = j
        if not abs(matrix[best, k]) > 0.0:
            return False
        if best != k:
            for l in range(k, m + 1):
                matrix[k, l], matrix[best, l] = matrix[best, l], matrix[k, l]
        for j in range(k + 1, m):
            factor = matrix[j, k] / matrix[k, k]
            if factor != 0.0:
                for l in range(k, m + 1):
                    matrix[j, l] -= factor * matrix[k, l]
    for k in range(m - 1, -1, -1):
        value = matrix[k, m]
        for l in range(k + 1, m):
            value -= matrix[k, l] * search.force[l]
        search.force[k] = value / matrix[k, k]
    return True


@kernel(internal=True)
def _first_tension(search: SheaveSearch, m: int) -> float:
    first = search.tension[0]
    for k in range(m):
        first += search.stiffness[0, k] * search.force[k]
    return first


@kernel(internal=True)
def _is_contradicted(search: SheaveSearch, m: int) -> bool:
    """Whether a sheave that sticks holds too much, or one that slides runs the other way."""
    before = _first_tension(search, m)
    for j in range(m):
        f = search.force[j]
        largest = max(before, before + f)
        if search.branch[j] == 0:
            if abs(f) > (search.loss[j] + STUCK) * largest:
                return True
        else:
            flow = search.flow[j] + search.creep[j] * (search.held[j] - f)
            for k in range(m):
                flow += search.response[j, k] * search.force[k]
            if search.branch[j] * flow < -SMALL * search.creep[j] * largest:
                return True
        before += f
    return False


@kernel
def find_line_forces(
    search: SheaveSearch,
    n: int,
    compliance: NDArray[np.float64],
    way: NDArray[np.float64],
    force: NDArray[np.float64],
    matrix: NDArray[np.float64],
) -> int:
    """Forces of the lines of one equalizer in the middle of a step.

    Parameters
    ----------
    search
        With `held`, `loss` and the states to begin with of its 2 n - 1 sheaves; receives states and frictions.
    n
        Lines.
    compliance, way
        c_i [m/N] and d_i [m], shape (n,).
    force
        Receives F_i [N], shape (n,).
    matrix
        Scratch, shape (2 n - 1, 2 n).

    Returns
    -------
    int
        1 if it is found, 0 if the rope is slack, -1 if no states fit.
    """
    m = 2 * n - 1
    search.counts.sheaves = m
    total = _respond(search, n, compliance, way)
    if not search.tension[0] > 0.0:
        return 0
    for j in range(m):
        search.creep[j] = SHARING * total / n
    scale = n / total
    if not _solve_states(search, n, matrix, scale) or _is_contradicted(search, m):
        for j in range(m):
            search.force[j], search.rope[j], search.share[j] = 0.0, 0, 0.0
        if not find_states(search):
            return -1
        _respond(search, n, compliance, way)
        if not _solve_states(search, n, matrix, scale):
            return -1
    before = _first_tension(search, m)
    for i in range(n):
        beyond = before + search.force[2 * i]
        if not (before > 0.0 and beyond > 0.0):
            return 0
        force[i] = before + beyond
        if i < n - 1:
            before = beyond + search.force[2 * i + 1]
    return 1


@kernel(inline=True, internal=True)
def _top(kind: RubbingLines, k: int) -> float:
    """Depth to which the rope at a pulley is pulled [m]: where its line reaches its lug, or that of its stop."""
    return kind.line[k].depth if kind.line[k].stop == 0 else depth_of_stop(kind, k)


@kernel(inline=True, internal=True)
def _stiffness(kind: RubbingLines, i: int, k: int) -> float:
    """K_i: of the rope at a pulley, and of its line unless it is at a stop [N/m]."""
    if kind.line[k].stop != 0:
        return 1.0 / kind.rubs[i].share
    return 1.0 / (kind.rubs[i].share + 1.0 / kind.lines[k].stiffness)


@kernel(inline=True, internal=True)
def _damping(kind: RubbingLines, k: int) -> float:
    return kind.lines[k].damping if kind.line[k].stop == 0 else 0.0


@kernel(internal=True)
def _rubbing_energy(kind: RubbingLines, i: int) -> float:
    """Elastic energy of lines whose forces differ [J]."""
    energy = 0.0
    for k in range(kind.table[i].first, kind.table[i].first + kind.table[i].count):
        energy += 0.5 * _stiffness(kind, i, k) * max(0.0, _top(kind, k) - kind.held[k].content) ** 2
        if kind.line[k].stop != 0:
            e = max(0.0, kind.line[k].depth - depth_of_stop(kind, k))
            energy += 0.5 * kind.lines[k].stiffness * e * e
    return energy


@kernel(internal=True)
def _find_forces(
    kind: RubbingLines, i: int, step: float, last: bool, work: Workspace, system: RowArrays
) -> int:
    """`find_line_forces` by the rates of a step, or those of the last one."""
    entry, first = kind.table[i], kind.rubs[i].sheave
    for k in range(entry.first, entry.first + entry.count):
        K, place = _stiffness(kind, i, k), k - entry.first
        c = 1.0 / (0.5 * K + _damping(kind, k) / step)
        way = c * K * (_top(kind, k) - kind.held[k].content)
        if kind.line[k].stop == 0:
            u = kind.line[k].rate
            if not last:
                u = rate_of(system, kind.lines[k].block, kind.lines[k].attachments, work)
            way += step * u
        kind.compliance[place], kind.way[place] = c, way
    for j in range(2 * entry.count - 1):
        kind.search.held[j], kind.search.loss[j] = kind.sheaves[first + j].held, kind.rubs[i].loss
        kind.search.branch[j] = kind.sheaves[first + j].branch
    found = find_line_forces(
        kind.search, entry.count, kind.compliance, kind.way, kind.line_force, kind.matrix
    )
    if found > 0:
        for j in range(2 * entry.count - 1):
            kind.sheaves[first + j].branch = kind.search.branch[j]
    return found


@kernel(internal=True)
def _aim(kind: RubbingLines, i: int, step: float, work: Workspace, system: RowArrays) -> bool:
    """Rows by the rates of the last step, if the rope is taut."""
    entry = kind.table[i]
    for k in range(entry.first, entry.first + entry.count):
        if not _top(kind, k) > kind.held[k].content:
            return False
    if _find_forces(kind, i, step, True, work, system) <= 0:
        return False
    put_law(system, entry.block, step, 0.0, 0.0, 0.0)
    for k in range(entry.first, entry.first + entry.count):
        u, place = kind.line[k].rate, k - entry.first
        force, slope = kind.line_force[place], step / kind.compliance[place]
        if kind.line[k].stop != 0:
            _, force, slope = force_of_one(kind, k, u, step)
        put_law(system, kind.lines[k].block, step, u, force, slope)
    return True


@implement(set_targets, RubbingLines)
@kernel(internal=True)
def set_rubbing_targets(
    kind: RubbingLines, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """First guess: rates and states of the last step. Where the rope is slack, or at the start, forces are equal."""
    if not at_midpoint:
        return
    for i in range(kind.table.shape[0]):
        if not (kind.state[i].fresh or kind.state[i].rubbed):
            _level(kind, i)
        kind.rubs[i].acting = not kind.state[i].fresh and _aim(kind, i, step, work, system)
        if not kind.rubs[i].acting:
            aim_lines(kind, i, step, system)


@implement(relinearise, RubbingLines)
@kernel(internal=True)
def relinearise_rubbing_lines(
    kind: RubbingLines, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Fit the forces to the rates found; a rope that goes slack in the step rubs no more in it."""
    for i in range(kind.table.shape[0]):
        entry = kind.table[i]
        if not kind.rubs[i].acting:
            fit_lines(kind, i, step, work, system)
            continue
        found = _find_forces(kind, i, step, False, work, system)
        if found <= 0:
            work.control.changed += 1
            work.status.block = entry.block
            if found == 0:
                kind.rubs[i].acting = False
                aim_lines(kind, i, step, system)
            continue
        for k in range(entry.first, entry.first + entry.count):
            line, place = kind.lines[k], k - entry.first
            u = rate_of(system, line.block, line.attachments, work)
            force, slope = kind.line_force[place], step / kind.compliance[place]
            if kind.line[k].stop != 0:
                _, force, slope = force_of_one(kind, k, u, step)
            fit_law(system, line.block, step, u, force, slope, work)


@kernel(internal=True)
def _level(kind: RubbingLines, i: int) -> None:
    """Rope at the pulleys such that all forces are equal, as they are."""
    entry = kind.table[i]
    excess, stiffness = all_lines(kind, i)
    for k in range(entry.first, entry.first + entry.count):
        e = stiffness * excess / _stiffness(kind, i, k) if excess > 0.0 else excess / entry.count
        kind.held[k].content = _top(kind, k) - e
        kind.held[k].stretching = 0.0
    for j in range(kind.rubs[i].sheave, kind.rubs[i].sheave + 2 * entry.count - 1):
        kind.sheaves[j].branch, kind.sheaves[j].held = 0, 0.0


@kernel(internal=True)
def _settle_rubbing(kind: RubbingLines, i: int) -> None:
    """Send pulleys to their stops and take them off: none of it changes what another one does."""
    for k in range(kind.table[i].first, kind.table[i].first + kind.table[i].count):
        line, own = kind.lines[k], kind.line[k]
        force = _stiffness(kind, i, k) * max(0.0, _top(kind, k) - kind.held[k].content)
        if own.stop == 0:
            depth = own.depth - force / line.stiffness
            own.stop = 1 if depth > line.high else (-1 if depth < line.low else 0)
        else:
            pulled = line.stiffness * max(0.0, own.depth - depth_of_stop(kind, k))
            if (own.stop > 0 and pulled < force) or (own.stop < 0 and pulled > force):
                own.stop = 0


@kernel(internal=True)
def _carry(kind: RubbingLines, i: int, step: float, work: Workspace, system: RowArrays) -> None:
    """Carry depths and rope over a step in which it rubs."""
    entry, state = kind.table[i], kind.state[i]
    _find_forces(kind, i, step, False, work, system)
    for j in range(2 * entry.count - 1):
        kind.sheaves[kind.rubs[i].sheave + j].held = kind.search.force[j]
    for k in range(entry.first, entry.first + entry.count):
        line, own, held, place = kind.lines[k], kind.line[k], kind.held[k], k - entry.first
        rate = rate_of(system, line.block, line.attachments, work)
        force = kind.line_force[place]
        change = kind.way[place] - kind.compliance[place] * force
        held.stretching = -change / step
        if own.stop == 0:
            held.stretching += rate
            e = own.depth - held.content
            elastic = _stiffness(kind, i, k) * (e + 0.5 * step * held.stretching)
            state.loss += (force - elastic) * step * held.stretching
        else:
            elastic, pulled, _ = force_of_one(kind, k, rate, step)
            state.loss += (pulled - elastic) * step * rate
        state.loss += force * change
        held.content += change
        held.force = force
        own.depth += step * rate + RETURN * min(0.0, own.drift)
        own.rate = rate
    before = _rubbing_energy(kind, i)
    _settle_rubbing(kind, i)
    state.loss += before - _rubbing_energy(kind, i)
    u = rate_of(system, entry.block, entry.attachments, work)
    state.growth = step / (step + work.control.last_step) * (u - state.rate)
    state.rate, state.paced = u, True


@implement(update_rows, RubbingLines)
@kernel(internal=True)
def update_rubbing_lines(
    kind: RubbingLines, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Carry the depths over the step; what dampers, sheaves and stops took."""
    for i in range(kind.table.shape[0]):
        state = kind.state[i]
        if kind.rubs[i].acting:
            _carry(kind, i, step, work, system)
        else:
            if state.rubbed:  # forces come to be equal, and what that sets free is lost
                state.loss += _rubbing_energy(kind, i) - energy_of(kind, i)
            carry_lines(kind, i, step, work, system)
            _level(kind, i)
        state.rubbed = kind.rubs[i].acting


@kernel(internal=True)
def _end_total(kind: RubbingLines, i: int, with_drift: bool) -> float:
    """Sum of the F_i at the end of a step [N], with the depths that are carried or those of the geometry."""
    total = 0.0
    for k in range(kind.table[i].first, kind.table[i].first + kind.table[i].count):
        e = _top(kind, k) - kind.held[k].content
        if with_drift and kind.line[k].stop == 0:
            e += kind.line[k].drift
        total += _stiffness(kind, i, k) * e + _damping(kind, k) * kind.held[k].stretching
    return max(0.0, total)


@kernel(internal=True)
def _end_rubbing(kind: RubbingLines, i: int) -> None:
    """Forces of the lines and largest tension of the rope at the end of a step, with the ratios of its middle."""
    entry, first = kind.table[i], kind.rubs[i].sheave
    tension = largest = relative = middle = 0.0
    for j in range(2 * entry.count):
        if j > 0:
            tension += kind.sheaves[first + j - 1].held
        largest = max(largest, tension)
        relative += tension
    for k in range(entry.first, entry.first + entry.count):
        middle += kind.held[k].force
    ratio = _end_total(kind, i, False) / middle
    kind.state[i].tension = ratio * (largest + (middle - relative) / (2 * entry.count))
    for k in range(entry.first, entry.first + entry.count):
        own = kind.line[k]
        own.force = ratio * kind.held[k].force if own.stop == 0 else line_force(kind, i, k)


@implement(watch_joints, RubbingLines)
@kernel(internal=True)
def watch_rubbing_lines(kind: RubbingLines, work: Workspace, system: RowArrays) -> None:
    """Forces at the end of the step; depths that have left what is carried end the run."""
    for i in range(kind.table.shape[0]):
        if kind.state[i].rubbed:
            _end_rubbing(kind, i)
    watch_equalized(kind, work, system)


@implement(record_joints, RubbingLines)
@kernel(internal=True)
def record_rubbing_lines(
    kind: RubbingLines, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """As lines of one force, with forces that differ."""
    record_equalized(kind, time, work, system, row)
    for i in range(kind.table.shape[0]):
        if not kind.state[i].rubbed:
            continue
        work.sums.elastic += _rubbing_energy(kind, i) - energy_of(kind, i)
        found, expected = _end_total(kind, i, False), _end_total(kind, i, True)
        compare_force(kind.state[i].agreement, time, found, expected, expected)
