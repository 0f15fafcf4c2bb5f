"""Wire ropes over sheaves with an efficiency: a tension a part, and sheaves over which the rope sticks or slides.

With the lengths ``L_k`` and tensions ``T_k`` of the parts, from the first end on, and the unstretched length l::

    T = sum w_k T_k,   w_k = L_k / L             tension of the elongation of the whole, as without friction
    f_j = T_j+1 - T_j                            friction of sheave j
    q_j = sum_(k>j) L_k' - W_j L' - W_j v + v_2,     W_j = sum_(k>j) w_k,     v = v_1 + v_2 = -l'

The rope runs over sheave j towards the last end at the speed q_j, if it stretches alike everywhere; v_1 and v_2 are the
speeds with which winches at its first and at its last end haul in. Virtual power says that these are conjugate: the
forces on the bodies are ``T L' + sum f_j (q_j + W_j v - v_2)``. So a rope is the row of its length, as any, and a row
for each of such sheaves with its dry friction::

    eta <= T_j+1 / T_j <= 1/eta,     q_j = 0 in between,     T_j+1 = T_j / eta if q_j > 0,  eta T_j if q_j < 0

A sheave that sticks is a rigid row, which begins with the force that it had: what rigid bodies leave open, the tensions
of a fall that stands still, stays as it was. Of one that slides the force is given, and found by iteration together
with the tensions: those are linear in the forces while none changes its state, so two rounds and their line (D. G.
Anderson, J. ACM 12, 1965) leave little; and what that line says of the answer of the tension serves the next step. The
power ``sum f_j q_j`` is lost, and each winch works against the tension of its own end: ``T v + sum f_j (v_2 - W_j v)``.
Bearings turn no bodies: tensions act at the tangent points (`find_parts`).

Values: Wire Rope Technical Board, Wire Rope Users Manual, 4th ed.: 1.04 for roller bearings, 1.09 for plain ones, of
the tension of a sheave over that before it. Over a sheave that is blocked, or a yoke, the rope slips, and the
efficiency follows from its wrap, ``exp(-mu wrap)`` (L. Euler, 1769).
"""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1, Floats2
from heavylift.numerics.jit import kernel
from heavylift.numerics.lanes import block_shape, subtract_rigid_rows
from heavylift.numerics.records import Record, Records
from heavylift.solver.extremes import Extremes, largest_of, note_value, smallest_of
from heavylift.solver.force_elements.rope_path import PlaceGradient, find_parts
from heavylift.solver.force_elements.rows import FREE_SOFTNESS, ROWS_A_BLOCK, law_impulse, put_residual
from heavylift.solver.force_elements.sheave_states import SheaveSearch, find_states
from heavylift.solver.force_elements.wire_rope import (
    Ropes,
    WinchRow,
    compare_length,
    compare_tension,
    end_tension,
    midpoint_rate,
    midpoint_tension,
    path_rate,
    put_places,
    put_rope,
    relinearise_ropes,
    rope_outputs,
    set_rope_targets,
    show_pulls,
    stiffness_of,
    table_state,
    update_ropes,
    watch_stretch,
    winch_state,
)
from heavylift.solver.interface import (
    Workspace,
    fill_rows,
    record_joints,
    relinearise,
    set_targets,
    update_rows,
    watch_joints,
)
from heavylift.solver.kinds import implement
from heavylift.solver.recording import part
from heavylift.solver.rows.structure import REGULARISATION, RowArrays
from heavylift.solver.scene.connections import SheaveParts

__all__ = ["Chain", "ChainState", "Sheave", "SheaveState", "SheavedRopes"]

FOUR, EIGHT = block_shape(4), block_shape(8)
"""Shapes of blocks with as many lanes."""

PLAIN_ROUNDS = 4
"""Rounds of the iteration in which a sheave changes its state if it is the only one that is contradicted."""

FIT_ROUNDS = 12
"""Rounds after which states are searched for though forces do not fit yet."""

BASE_ROUNDS = 12
"""Rounds in which all other laws are fitted to sheaves that are freed for a search, at most."""

ATTEMPTS = 4
"""Searches in one step; other laws may change their branches in between."""

FITTED, FREED, PUSHED = range(3)
"""Phases of a round: forces and states are fitted; sheaves are freed; one of them has been pushed."""

SAME_FLOW = 1e-10
"""Change of flows, relative to the largest, that counts as none."""

STUCK = 3e-10
"""Excess of a ratio of tensions up to which a sheave sticks: more than what rounding makes of one at its bound."""

SHARING, HOLDING = 1e-5, 1e-3
"""Compliance of a sheave that sticks, and of each of a rope that stands still, relative to that of the rope.

Velocities at rest are rounding of positions, and the stiffer rows are, the more of that they add up in long holds.
"""

END = 1e-3
"""Softness of a row that sticks in the projection, relative to that in the middle of the step.

A winch or a driven body may make flows that no bodies can take back: rigid rows would then push against each other with
impulses far above any friction, and what those do to the softness of guides is energy that nobody books.
"""

SMALL = 1e-8
"""Of a tension: what its force makes of a row that sticks counts as no flow."""

SETTLED = 1e-12
"""Miss of a friction relative to the tension that counts as fitted."""

TELLING, LARGEST_ANSWER = 1e-9, 0.9
"""Miss relative to the tension from which on a round says how tensions answer to friction, and what it may say."""

UNTOUCHED = 1.0 - 1e-6
"""Efficiency of a sheave that the rope does not touch: next to no friction is left, as the law wants it."""

LEAST_WRAP = 1e-3
"""Wrap about a blocked sheave [rad] below which its efficiency stays: some friction is left, as the law wants it."""


class Chain(Record):
    """Sheaves of a rope.

    Attributes
    ----------
    first, count
        Its first sheave with an efficiency, and how many.
    stride
        Blocks from one that has rows of it to the next.
    rows
        How many a block has, at most.
    flow
        Place in `SheavedRopes.flows` of the first of its rows.
    parts
        Where its records are, beside those of all ropes.
    winch_last
        Part of what the winch hauls in that the last end takes: 1 if its drum is there, a half of one at each end.
    drum, drum_rows
        First row in `SheavedRopes.drums` of a drum of its own at the last end, and how many.
    last
        Scratch: speed with which the last end hauls in, mean of the step or at its end [m/s].
    settling, asked, standing, largest, miss
        Scratch of the iteration: rounds since a sheave has changed its state, whether a search asks the rope, whether
        all sheaves stuck in the last step, the largest tension [N], and the square of the misses at first [N^2].
    """

    first: int
    count: int
    stride: int
    rows: int
    flow: int
    parts: SheaveParts
    winch_last: float
    drum: int
    drum_rows: int
    last: float
    settling: int
    asked: bool
    standing: bool
    largest: float
    miss: float


class ChainState(Record):
    """What a rope carries: how much of a miss of the frictions is left where they follow the tensions."""

    answer: float


class Sheave(Record):
    """A place with an efficiency.

    Attributes
    ----------
    place, block, lane, flow
        Its place in all paths, block and lane of its row, place of that in `SheavedRopes.flows`.
    efficiency
        Smaller over larger tension while the rope runs; of a blocked one that of its wrap, and nearly 1 where the rope
        does not touch.
    bearing
        The efficiency of one that turns, while the rope touches it.
    friction
        Coefficient of friction of one that is blocked, or 0.
    """

    place: int
    block: int
    lane: int
    flow: int
    efficiency: float
    bearing: float
    friction: float


class SheaveState(Record):
    """What a sheave carries.

    Attributes
    ----------
    branch
        0 if the rope sticks; 1 or -1, towards the last or the first end, if it slides.
    force, trend
        Tension beyond it less that before it [N], in the middle of the step, and its change since the last one [N/s].
    share
        W_j: of the length of the rope, what lies beyond.
    speed
        Of the rope at the end of the step [m/s].
    loss, work
        Energy lost here, and what the winch works for it [J].
    held
        `force` of the last step that stands: the row of one that sticks begins with it.
    stuck
        Whether it stuck in that step.
    acting
        State that the tensions follow: `branch`, or the sense of a row that holds more than friction can.
    other
        State that does not contradict them.
    stops
        Whether the row sticks at the end of the step.
    passed
        Speed at the end of the last step [m/s].
    squares, changes
        Sums over steps of the square of the speed at their ends, and of the square of its change [m2/s2].
    force_before, miss_before
        Scratch of the iteration: of the round before.
    """

    branch: int
    force: float
    trend: float
    share: float
    speed: float
    loss: float
    work: float
    held: float
    stuck: bool
    acting: int
    other: int
    stops: bool
    passed: float
    squares: float
    changes: float
    force_before: float
    miss_before: float


class SheavedRopes(Ropes):
    """All ropes of a scene that pass places with an efficiency below 1.

    Attributes
    ----------
    chains, chain_state
        Of each rope.
    sheaves, sheave_state
        Of all ropes.
    drums
        Rows of drums at last ends beside winches at first ones; the winch of the rope is both together.
    leaving
        Derivatives of the part behind each place.
    parts
        Length of the part behind each place [m].
    tension
        Of the part behind each place, in the middle of the last step [N].
    part_extremes
        Of these tensions at the ends of steps.
    slope
        Scratch: of the tension of the part behind each place by that of the first part.
    flows
        Scratch: minus ``G v`` of all rows, in blocks of `ROWS_A_BLOCK` [m/s].
    by_place, whole, beyond
        Scratch: derivatives of the length by each place as a row, their sum and that of what lies beyond a place, for
        each side of a rope.
    search
        For states, where those of the last step and what contradicts them do not lead to any.
    """

    carried_fields: ClassVar[tuple[str, ...]] = (
        "state",
        "wraps",
        "chain_state",
        "sheave_state",
        "tension",
        "part_extremes",
    )

    chains: Records[Chain]
    chain_state: Records[ChainState]
    sheaves: Records[Sheave]
    sheave_state: Records[SheaveState]
    drums: Records[WinchRow]
    leaving: Records[PlaceGradient]
    parts: Floats1
    tension: Floats1
    part_extremes: Records[Extremes]
    slope: Floats1
    flows: Floats1
    by_place: Floats2
    whole: Floats2
    beyond: Floats2
    search: SheaveSearch


@kernel(internal=True)
def _find_shares(kind: SheavedRopes, i: int, work: Workspace) -> float:
    """Length of the path from the markers [m]; derivatives of its parts, and W of its sheaves, are kept."""
    put_places(kind, i, work)
    first = kind.table[i].first
    last = first + kind.table[i].places
    length = find_parts(
        kind.path[first:last],
        kind.gradient[first:last],
        kind.leaving[first:last],
        kind.parts[first:last],
        kind.wraps[first:last],
    )
    beyond, p = 0.0, last - 1
    for s in range(kind.chains[i].first + kind.chains[i].count - 1, kind.chains[i].first - 1, -1):
        while p > kind.sheaves[s].place:
            p -= 1
            beyond += kind.parts[p]
        kind.sheave_state[s].share = beyond / length
        wrap = kind.wraps[kind.sheaves[s].place]
        if kind.sheaves[s].friction > 0.0:
            kind.sheaves[s].efficiency = math.exp(-kind.sheaves[s].friction * max(LEAST_WRAP, wrap))
        else:
            kind.sheaves[s].efficiency = kind.sheaves[s].bearing if wrap >= 0.0 else UNTOUCHED
    return length


@kernel(inline=True, internal=True)
def _add_direction(
    out: NDArray[np.float64], width: int, J: NDArray[np.float64], c: NDArray[np.float64]
) -> None:
    """Add ``c . J`` to derivatives."""
    x, y, z = c[0], c[1], c[2]
    if (
        x == 0.0 and y == 0.0 and z == 0.0
    ):  # as derivatives by axes are while ropes run in the planes of sheaves
        return
    if width == 6:
        for k in range(6):
            out[k] += x * J[0, k] + y * J[1, k] + z * J[2, k]
        return
    for k in range(width):
        out[k] += x * J[0, k] + y * J[1, k] + z * J[2, k]


@kernel(internal=True)
def _add_place(
    kind: SheavedRopes,
    p: int,
    by: PlaceGradient,
    out: NDArray[np.float64],
    width: int,
    work: Workspace,
) -> None:
    """Add derivatives by a place to a row of its body."""
    _add_direction(out, width, work.jacobian[kind.places[p].marker], by.centre)
    if kind.places[p].axis >= 0:
        _add_direction(out, width, work.jacobian[kind.places[p].axis], by.axis)


@kernel(internal=True)
def _sum_places(kind: SheavedRopes, i: int, work: Workspace, system: RowArrays) -> None:
    """Derivatives of the length by each place, and their sum on each side."""
    block = kind.table[i].block
    for side in range(kind.table[i].attachments):
        whole, beyond = kind.whole[side], kind.beyond[side]
        for k in range(system.attachments[2 * block + side].width):
            whole[k] = beyond[k] = 0.0
    for p in range(kind.table[i].first, kind.table[i].first + kind.table[i].places):
        side = kind.places[p].attachment
        if side < 0:
            continue
        width, whole, out = system.attachments[side].width, kind.whole[side - 2 * block], kind.by_place[p]
        for k in range(width):
            out[k] = 0.0
        _add_place(kind, p, kind.gradient[p], out, width, work)
        for k in range(width):
            whole[k] += out[k]


@kernel(internal=True)
def _put_row(
    kind: SheavedRopes, i: int, block: int, lane: int, of_beyond: float, of_whole: float, system: RowArrays
) -> None:
    """Write a row: a part of what lies beyond a place, and of the whole."""
    lanes = system.lanes
    for side in range(kind.table[i].attachments):
        whole, beyond = kind.whole[side], kind.beyond[side]
        panel = system.attachments[2 * block + side].panel + lane
        for k in range(system.attachments[2 * block + side].width):
            system.panels[panel + k * lanes] = of_beyond * beyond[k] + of_whole * whole[k]


@implement(fill_rows, SheavedRopes)
@kernel(internal=True)
def fill_sheaved_rows(kind: SheavedRopes, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """The row of the length, then those of the flows without what winches bring, from the last end on."""
    for i in range(kind.table.shape[0]):
        length, block = _find_shares(kind, i, work), kind.table[i].block
        _sum_places(kind, i, work, system)
        _put_row(kind, i, block, 0, 0.0, 1.0, system)
        first, s = kind.table[i].first, kind.chains[i].first + kind.chains[i].count - 1
        for p in range(first + kind.table[i].places - 1, first - 1, -1):
            side = kind.places[p].attachment
            width = system.attachments[side].width if side >= 0 else 0
            beyond = kind.beyond[max(0, side - 2 * block)]
            out = kind.by_place[p]
            if s >= kind.chains[i].first and kind.sheaves[s].place == p:
                if width > 0:  # the part behind it counts, that before it does not
                    for k in range(width):
                        out[k] += beyond[k]
                    _add_place(kind, p, kind.leaving[p], beyond, width, work)
                _put_row(
                    kind,
                    i,
                    kind.sheaves[s].block,
                    kind.sheaves[s].lane,
                    1.0,
                    -kind.sheave_state[s].share,
                    system,
                )
                s -= 1
                for k in range(width):
                    beyond[k] = out[k]
                continue
            for k in range(width):
                beyond[k] += out[k]
        if with_residual:
            compare_length(kind, i, length)
            put_residual(system, block, length - kind.state[i].rest)


@kernel(internal=True)
def _find_flows(kind: SheavedRopes, i: int, velocity: NDArray[np.float64], system: RowArrays) -> None:
    """``G v`` of all rows of a rope."""
    chain, lanes = kind.chains[i], system.lanes
    for piece in range(chain.count // chain.rows + 1):
        out = chain.flow + piece * ROWS_A_BLOCK
        for r in range(ROWS_A_BLOCK):
            kind.flows[out + r] = 0.0
        first = 2 * (kind.table[i].block + piece * chain.stride)
        for side in range(first, first + kind.table[i].attachments):
            dof, panel = system.attachments[side].dof, system.attachments[side].panel
            width = system.attachments[side].width
            if width == 6 and lanes == 8:
                subtract_rigid_rows(EIGHT, kind.flows, out, system.panels, panel, velocity, dof)
            elif width == 6 and lanes == 4:
                subtract_rigid_rows(FOUR, kind.flows, out, system.panels, panel, velocity, dof)
            else:
                for k in range(width):
                    for r in range(min(lanes, ROWS_A_BLOCK)):
                        kind.flows[out + r] -= system.panels[panel + k * lanes + r] * velocity[dof + k]


@kernel(inline=True, internal=True)
def _winched(kind: SheavedRopes, i: int, s: int, hauling: float) -> float:
    """What winches that haul in with a speed make of the speed over a sheave [m/s]."""
    return kind.chains[i].last - kind.sheave_state[s].share * hauling


@kernel(inline=True, internal=True)
def _flow(kind: SheavedRopes, i: int, s: int, hauling: float) -> float:
    """Speed of the rope over a sheave [m/s] while its winches haul in at a speed [m/s], by the flows found."""
    return _winched(kind, i, s, hauling) - kind.flows[kind.sheaves[s].flow]


@kernel(inline=True, internal=True)
def _hauling(kind: SheavedRopes, i: int, step: float) -> float:
    """Mean speed of the winches in the step [m/s]."""
    return (kind.state[i].rest - kind.state[i].next_rest) / step


@kernel(inline=True, internal=True)
def _held_softness(kind: SheavedRopes, i: int, s: int, step: float, system: RowArrays) -> float:
    """Of the row of a sheave that sticks in the middle of a step: a part of what its rope stretches.

    Rigid rows leave open how the frictions of many sheaves share; what they are would be rounding in short steps.
    """
    lane = kind.sheaves[s].lane
    if kind.table[i].axial_stiffness == 0.0:  # it was let go
        return FREE_SOFTNESS * system.rows[kind.sheaves[s].block].scale[lane]
    sharing = HOLDING if kind.chains[i].standing else SHARING
    compliance = sharing / stiffness_of(kind, i, 1.0 / kind.state[i].rest)
    return REGULARISATION * system.rows[kind.sheaves[s].block].scale[lane] + 4.0 * compliance / (step * step)


@kernel(internal=True)
def _stick(
    kind: SheavedRopes, i: int, s: int, hauling: float, softness: float, held: float, system: RowArrays
) -> None:
    """A row without flow but for its softness, whose impulse begins with one."""
    row, lane = system.rows[kind.sheaves[s].block], kind.sheaves[s].lane
    row.softness[lane] = softness
    row.target[lane] = softness * held - _winched(kind, i, s, hauling)


@kernel(internal=True)
def _slide(kind: SheavedRopes, s: int, step: float, system: RowArrays) -> None:
    """A row whose force is given."""
    row, lane = system.rows[kind.sheaves[s].block], kind.sheaves[s].lane
    softness = FREE_SOFTNESS * row.scale[lane]
    row.softness[lane] = softness
    row.target[lane] = -0.5 * step * kind.sheave_state[s].force * softness


@kernel(inline=True, internal=True)
def _impulse(kind: SheavedRopes, s: int, system: RowArrays) -> float:
    return system.rows[kind.sheaves[s].block].impulse[kind.sheaves[s].lane]


@kernel(internal=True)
def _put_sheave(kind: SheavedRopes, i: int, s: int, step: float, system: RowArrays) -> None:
    """Row in the middle of a step, by the state."""
    if kind.table[i].axial_stiffness == 0.0:
        kind.sheave_state[s].force = kind.sheave_state[s].held = 0.0
    if kind.sheave_state[s].branch == 0:
        held, softness = -0.5 * step * kind.sheave_state[s].held, _held_softness(kind, i, s, step, system)
        _stick(kind, i, s, _hauling(kind, i, step), softness, held, system)
    else:
        _slide(kind, s, step, system)


@kernel(internal=True)
def _spread_tension(kind: SheavedRopes, i: int, mean: float) -> float:
    """Tensions of the parts from their mean, the ratios at sheaves that slide and the forces of those that stick.

    Each is linear in the first one, ``T_k = a_k T_1 + b_k``. The largest is returned.
    """
    first, parts = kind.table[i].first, kind.table[i].places - 1
    j, last = kind.chains[i].first, kind.chains[i].first + kind.chains[i].count
    a, b = 1.0, 0.0
    sum_a = sum_b = total = 0.0
    for p in range(first, first + parts):
        if p > first and j < last and kind.sheaves[j].place == p:
            state = kind.sheave_state[j]
            if state.acting == 0:
                b += state.force
            else:
                ratio = kind.sheaves[j].efficiency
                ratio = 1.0 / ratio if state.acting > 0 else ratio
                a, b = a * ratio, b * ratio
            j += 1
        length = kind.parts[p]
        total += length
        sum_a += length * a
        sum_b += length * b
        kind.slope[p], kind.tension[p] = a, b
    start = (mean * total - sum_b) / sum_a
    largest = 0.0
    for p in range(first, first + parts):
        kind.tension[p] += start * kind.slope[p]
        largest = max(largest, kind.tension[p])
    return largest


@kernel(internal=True)
def _haul_last_ends(kind: SheavedRopes, time: float, step: float, at_midpoint: bool) -> None:
    """Speeds with which last ends haul in: means of a step, or those at a time."""
    for i in range(kind.table.shape[0]):
        chain = kind.chains[i]
        if chain.drum_rows > 0:
            way, speed = table_state(kind.drums, chain.drum, chain.drum_rows, time)
            if at_midpoint:
                speed = (table_state(kind.drums, chain.drum, chain.drum_rows, time + step)[0] - way) / step
            chain.last = speed
        else:
            chain.last = chain.winch_last * (
                _hauling(kind, i, step) if at_midpoint else kind.state[i].hauling
            )


@implement(set_targets, SheavedRopes)
@kernel(internal=True)
def set_sheaved_targets(
    kind: SheavedRopes, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """First guess: rates, states and forces of the last step.

    At its end sheaves stick as in the middle, and where the step has turned the flow round.
    """
    set_rope_targets(kind, time, step, at_midpoint, work, system)
    _haul_last_ends(kind, time, step, at_midpoint)
    if at_midpoint:
        counts = kind.search.counts
        counts.phase = counts.rounds = counts.attempts = 0
    for i in range(kind.table.shape[0]):
        chain, rope = kind.chains[i], kind.state[i]
        if at_midpoint:
            chain.asked, chain.settling, chain.standing = False, 0, not rope.fresh
            for s in range(chain.first, chain.first + chain.count):
                chain.standing = chain.standing and kind.sheave_state[s].stuck
        else:
            _find_flows(kind, i, work.velocity, system)
        for s in range(chain.first, chain.first + chain.count):
            state = kind.sheave_state[s]
            if at_midpoint:
                if (
                    rope.fresh
                ):  # a search for equilibrium asks at places of any kind, and leaves nothing behind
                    state.branch = 0
                state.force = state.held
                if state.branch != 0:
                    state.force += 0.5 * (step + work.control.last_step) * state.trend
                _put_sheave(kind, i, s, step, system)
                continue
            state.speed = _flow(kind, i, s, rope.hauling)
            state.stops = False
            if rope.fresh or rope.stretched <= rope.rest:
                continue
            # what counts as no flow stops: else sheaves at their bounds change their states in each step at rest;
            # records ask as well, and must leave the state as it is
            least = SMALL * chain.largest * _creep(kind, i, s, step, system)
            state.stops = state.branch * state.speed <= least
            if state.stops:
                softness = END * _held_softness(kind, i, s, step, system)
                _stick(kind, i, s, rope.hauling, softness, 0.0, system)


@kernel(internal=True)
def _find_tensions(kind: SheavedRopes, i: int, mean: float) -> float:
    """Tensions of the parts; a sheave whose row sticks with more than friction can hold acts as one that slides.

    Else a row that is far beyond its friction, because others contradict it, would make tensions of any size.
    """
    chain = kind.chains[i]
    for s in range(chain.first, chain.first + chain.count):
        kind.sheave_state[s].acting = kind.sheave_state[s].branch
    while True:
        largest = _spread_tension(kind, i, mean)
        again = False
        for s in range(chain.first, chain.first + chain.count):
            state, p = kind.sheave_state[s], kind.sheaves[s].place
            if state.acting == 0:
                bound = (1.0 - kind.sheaves[s].efficiency + STUCK) * max(kind.tension[p - 1], kind.tension[p])
                if abs(state.force) > max(bound, 0.0) or mean <= 0.0:
                    state.acting = 1 if state.force > 0.0 else -1
                    again = True
        if not again:
            return largest


@kernel(inline=True, internal=True)
def _creep(kind: SheavedRopes, i: int, s: int, step: float, system: RowArrays) -> float:
    """Flow per force of a row that sticks [m/s/N]."""
    return 0.5 * step * _held_softness(kind, i, s, step, system)


@kernel(internal=True)
def _find_others(
    kind: SheavedRopes, i: int, mean: float, largest: float, step: float, system: RowArrays
) -> int:
    """States that do not contradict tensions and flows; how many are others than those it has."""
    chain, hauling, found = kind.chains[i], _hauling(kind, i, step), 0
    for s in range(chain.first, chain.first + chain.count):
        state = kind.sheave_state[s]
        state.other = state.acting
        if state.branch != 0 and mean > 0.0:
            creep = _creep(
                kind, i, s, step, system
            )  # of a row that sticks: so both states agree on what is none
            flow = _flow(kind, i, s, hauling) + creep * (state.held - state.force)
            if state.branch * flow < -SMALL * creep * largest:
                state.other = 0
        if state.other != state.branch:
            found += 1
    return found


@kernel(internal=True)
def _fit_friction(kind: SheavedRopes, i: int, largest: float) -> bool:
    """Bring the forces of sheaves that slide nearer to the tensions beside them; whether they did not fit."""
    chain, carried = kind.chains[i], kind.chain_state[i]
    miss = along = square = of_both = of_one = 0.0
    for s in range(chain.first, chain.first + chain.count):
        state, p = kind.sheave_state[s], kind.sheaves[s].place
        if state.branch != 0:
            F, F0 = kind.tension[p] - kind.tension[p - 1] - state.force, state.miss_before
            miss = max(miss, abs(F))
            along += F * (F - F0)
            square += (F - F0) ** 2
            of_both += F * F0
            of_one += F * F
    if chain.settling == 1 and chain.miss > (TELLING * largest) ** 2:
        left = of_both / chain.miss
        answer = left + carried.answer * (1.0 - left)
        carried.answer = answer if abs(answer) < LARGEST_ANSWER else 0.0
    if miss <= SETTLED * largest:
        return False
    theta, scale = 0.0, 1.0
    if chain.settling > 0:
        theta = along / square if square > 0.0 else 0.0
    else:
        scale, chain.miss = 1.0 / (1.0 - carried.answer), of_one
    for s in range(chain.first, chain.first + chain.count):
        state, p = kind.sheave_state[s], kind.sheaves[s].place
        if state.branch != 0:
            x, F = state.force, kind.tension[p] - kind.tension[p - 1] - state.force
            state.force = x + scale * F - theta * (x - state.force_before + F - state.miss_before)
            state.force_before, state.miss_before = x, F
    chain.settling += 1
    return True


@kernel(inline=True, internal=True)
def _mean_tension(kind: SheavedRopes, i: int, step: float, system: RowArrays) -> float:
    """Of the row of the length [N]."""
    return -2.0 / step * law_impulse(system, kind.table[i].block)


@kernel(internal=True)
def _begin_search(kind: SheavedRopes, step: float, system: RowArrays) -> None:
    """Free the sheaves of all ropes whose states were contradicted, at the forces of the last step."""
    search = kind.search
    counts = search.counts
    counts.phase, counts.rounds, counts.sheaves = FREED, 0, 0
    for i in range(kind.table.shape[0]):
        chain = kind.chains[i]
        if not chain.asked:
            continue
        for s in range(chain.first, chain.first + chain.count):
            m, state = counts.sheaves, kind.sheave_state[s]
            state.force = state.held
            search.number[m], search.rope[m] = s, i
            search.flow[m] = np.inf
            _slide(kind, s, step, system)
            counts.sheaves = m + 1


@kernel(internal=True)
def _measure_base(kind: SheavedRopes, step: float, work: Workspace, system: RowArrays) -> None:
    """Once flows stay as they are, so all other laws fit, take them down and push the first sheave."""
    search, moved, largest = kind.search, 0.0, 0.0
    counts = search.counts
    for i in range(kind.table.shape[0]):
        _find_flows(kind, i, work.velocity, system)
    for k in range(counts.sheaves):
        i, s = search.rope[k], search.number[k]
        q = _flow(kind, i, s, _hauling(kind, i, step))
        moved, largest = max(moved, abs(q - search.flow[k])), max(largest, abs(q))
        search.flow[k] = q
    counts.rounds += 1
    if moved > SAME_FLOW * largest and counts.rounds < BASE_ROUNDS:
        return
    for i in range(kind.table.shape[0]):
        search.tension[i] = _mean_tension(kind, i, step, system)
    for k in range(counts.sheaves):
        i, s = search.rope[k], search.number[k]
        state = kind.sheave_state[s]
        search.force[k], search.held[k], search.share[k] = state.force, state.held, state.share
        search.loss[k], search.creep[k] = 1.0 - kind.sheaves[s].efficiency, _creep(kind, i, s, step, system)
        search.push[k] = search.loss[k] * max(search.tension[i], 1.0)
    counts.phase, counts.pushed = PUSHED, 0
    _push(kind, 0, 1.0, step, system)


@kernel(inline=True, internal=True)
def _push(kind: SheavedRopes, k: int, sense: float, step: float, system: RowArrays) -> None:
    """Change the force of a sheave of the search, or take that back."""
    s = kind.search.number[k]
    kind.sheave_state[s].force = kind.search.force[k] + sense * kind.search.push[k]
    _slide(kind, s, step, system)


@kernel(internal=True)
def _measure_response(kind: SheavedRopes, step: float, work: Workspace, system: RowArrays) -> None:
    """What the sheave that was pushed does to all flows and tensions; the next one, or the states that follow."""
    search = kind.search
    counts = search.counts
    k = counts.pushed
    per_force = 1.0 / search.push[k]
    for i in range(kind.table.shape[0]):
        _find_flows(kind, i, work.velocity, system)
    for j in range(counts.sheaves):
        i = search.rope[j]
        q = _flow(kind, i, search.number[j], _hauling(kind, i, step))
        search.response[j, k] = per_force * (q - search.flow[j])
    for i in range(kind.table.shape[0]):
        search.stiffness[i, k] = per_force * (_mean_tension(kind, i, step, system) - search.tension[i])
    _push(kind, k, 0.0, step, system)
    counts.pushed += 1
    if counts.pushed < counts.sheaves:
        _push(kind, counts.pushed, 1.0, step, system)
        return
    counts.phase, counts.rounds = FITTED, 1
    counts.attempts += 1
    if not find_states(search):
        counts.attempts = ATTEMPTS
        return
    for j in range(counts.sheaves):
        i, s = search.rope[j], search.number[j]
        state = kind.sheave_state[s]
        state.branch, state.force = search.branch[j], search.force[j]
        kind.chains[i].settling = 0
        _put_sheave(kind, i, s, step, system)


@kernel(internal=True)
def _judge_states(kind: SheavedRopes, step: float, work: Workspace, system: RowArrays) -> int:
    """Tensions of all ropes, and states that do not contradict them: how many sheaves have others."""
    count = 0
    for i in range(kind.table.shape[0]):
        chain = kind.chains[i]
        _find_flows(kind, i, work.velocity, system)
        _, mean, _, _, _ = midpoint_tension(kind, i, -kind.flows[chain.flow], step)
        for s in range(chain.first, chain.first + chain.count):
            if kind.sheave_state[s].branch == 0:
                kind.sheave_state[s].force = -2.0 / step * _impulse(kind, s, system)
        chain.largest = _find_tensions(kind, i, mean)
        others = _find_others(kind, i, mean, chain.largest, step, system)
        chain.asked = chain.asked or others > 0
        count += others
    return count


@kernel(internal=True)
def _change_one(kind: SheavedRopes, step: float, work: Workspace, system: RowArrays) -> None:
    """The only sheave that is contradicted takes its other state."""
    for i in range(kind.table.shape[0]):
        chain = kind.chains[i]
        for s in range(chain.first, chain.first + chain.count):
            state = kind.sheave_state[s]
            if state.other != state.branch:
                state.branch, chain.settling = state.other, 0
                _, mean, _, _, _ = midpoint_tension(kind, i, -kind.flows[chain.flow], step)
                chain.largest = _find_tensions(kind, i, mean)
                _put_sheave(kind, i, s, step, system)
                work.control.changed += 1


@kernel(internal=True)
def _fit_sheaves(kind: SheavedRopes, before: int, step: float, work: Workspace, system: RowArrays) -> None:
    """Fit forces of all sheaves to tensions, and states to tensions and flows: of one at once, of more by a search.

    Many that change together make forces of any size, and velocities from which nothing comes back.
    """
    counts = kind.search.counts
    counts.rounds += 1
    others = _judge_states(kind, step, work, system)
    if others > 1 or (others == 1 and counts.rounds > PLAIN_ROUNDS):
        work.control.changed += 1
        work.status.block = kind.table[0].block
        if counts.attempts < ATTEMPTS and (counts.rounds == 1 or counts.rounds > FIT_ROUNDS):
            _begin_search(kind, step, system)
            return
    elif others == 1:
        _change_one(kind, step, work, system)
    for i in range(kind.table.shape[0]):
        chain = kind.chains[i]
        if _fit_friction(kind, i, chain.largest):
            for s in range(chain.first, chain.first + chain.count):
                _put_sheave(kind, i, s, step, system)
            work.control.changed += 1
            work.status.block = kind.table[i].block
    if others > 0 and work.control.changed == before + 1 and counts.attempts < ATTEMPTS:
        _begin_search(kind, step, system)  # all forces fit, but states do not
    elif work.control.changed == before:
        counts.rounds = counts.attempts = 0


@implement(relinearise, SheavedRopes)
@kernel(internal=True)
def relinearise_sheaved_ropes(
    kind: SheavedRopes, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Fit the tensions to the rates found, then states and forces of the sheaves to the tensions."""
    before = work.control.changed
    if kind.search.counts.phase == PUSHED:
        _measure_response(kind, step, work, system)
        work.control.changed += 1
        return
    relinearise_ropes(kind, time, step, work, system)
    if kind.search.counts.phase == FREED:
        _measure_base(kind, step, work, system)
        work.control.changed += 1
        return
    _fit_sheaves(kind, before, step, work, system)


@implement(update_rows, SheavedRopes)
@kernel(internal=True)
def update_sheaved_ropes(
    kind: SheavedRopes, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Carry the stretch over the step; works of winch, damper and friction."""
    for i in range(kind.table.shape[0]):
        chain, hauling = kind.chains[i], _hauling(kind, i, step)
        _find_flows(kind, i, work.velocity, system)
        for s in range(chain.first, chain.first + chain.count):
            state = kind.sheave_state[s]
            state.force = -2.0 / step * _impulse(kind, s, system)
            change = 0.0 if kind.state[i].fresh else state.force - state.held
            state.trend = 2.0 / (step + work.control.last_step) * change
            state.held, state.stuck = state.force, state.branch == 0
            state.loss += step * state.force * _flow(kind, i, s, hauling)
            state.work += step * state.force * _winched(kind, i, s, hauling)
    update_ropes(kind, time, step, work, system)


@kernel(internal=True)
def _end_tensions(kind: SheavedRopes, i: int, mean: float) -> float:
    """Largest tension at the end of a step; `tension` are those of the parts, with the ratios of the middle."""
    first, parts = kind.table[i].first, kind.table[i].places - 1
    middle = total = 0.0
    for p in range(first, first + parts):
        total += kind.parts[p]
        middle += kind.parts[p] * kind.tension[p]
    ratio = mean * total / middle if middle > 0.0 else 0.0
    largest = 0.0
    for p in range(first, first + parts):
        kind.tension[p] = ratio * kind.tension[p] if middle > 0.0 else mean
        largest = max(largest, kind.tension[p])
    return largest


@kernel(internal=True)
def _show_parts(kind: SheavedRopes, i: int) -> None:
    """What a rope pulls its places with, by the tensions of its parts on both sides of each."""
    shown, first, count = kind.table[i].shown, kind.table[i].first, kind.table[i].places
    if shown < 0:
        return
    before = 0.0
    for p in range(count):
        out, whole, leaving = kind.pulls[shown + p], kind.gradient[first + p], kind.leaving[first + p]
        out.tension = kind.tension[first + p] if p < count - 1 else 0.0
        for k in range(3):
            part = leaving.centre[k]
            out.force[k] = -before * (whole.centre[k] - part) - out.tension * part
        before = out.tension


@implement(watch_joints, SheavedRopes)
@kernel(internal=True)
def watch_sheaved_ropes(kind: SheavedRopes, work: Workspace, system: RowArrays) -> None:
    """Tensions at the end of the step; what its projection took from those that stick."""
    for i in range(kind.table.shape[0]):
        chain, rope = kind.chains[i], kind.state[i]
        _find_flows(kind, i, work.velocity, system)
        for s in range(chain.first, chain.first + chain.count):
            state, P = kind.sheave_state[s], _impulse(kind, s, system)
            before = state.speed
            if state.stops:
                state.branch, state.stops = 0, False
            state.speed = _flow(kind, i, s, rope.hauling)
            if state.squares > 0.0:
                state.changes += (state.speed - state.passed) ** 2
            state.passed, state.squares = state.speed, state.squares + state.speed * state.speed
            state.loss -= 0.5 * P * (before + state.speed)
            state.work -= P * _winched(kind, i, s, rope.hauling)
        rate = midpoint_rate(kind, i, work, system) if kind.table[i].damping > 0.0 else 0.0
        rope.tension = end_tension(kind, i, rope.hauling, rate)
        note_value(rope.extremes, work.control.interval, _end_tensions(kind, i, rope.tension))
        for p in range(kind.table[i].first, kind.table[i].first + kind.table[i].places - 1):
            note_value(kind.part_extremes[p], work.control.interval, kind.tension[p])
        _show_parts(kind, i)
        watch_stretch(kind, i, work)


@implement(record_joints, SheavedRopes)
@kernel(internal=True)
def record_sheaved_ropes(
    kind: SheavedRopes, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """As a rope, with tensions of the parts and their extremes, and speed and state of each sheave."""
    for i in range(kind.table.shape[0]):
        rope, chain, entry = kind.state[i], kind.chains[i], kind.table[i]
        length = _find_shares(kind, i, work)
        compare_length(kind, i, length)
        largest, interval = 0.0, work.control.interval
        segments = part(row, entry.parts.segment_tension)
        highest = part(row, chain.parts.segment_tension_max)
        lowest = part(row, chain.parts.segment_tension_min)
        if rope.fresh:  # what friction does is not known before the first step
            hauling = winch_state(kind, i, time)[1]
            largest = end_tension(kind, i, hauling, path_rate(kind, i, work))
        elif rope.paced:
            compare_tension(kind, i, time, length, rope.tension)
        for k in range(segments.shape[0]):
            tension = largest if rope.fresh else kind.tension[entry.first + k]
            largest = max(largest, tension)
            segments[k] = tension
            highest[k] = largest_of(kind.part_extremes[entry.first + k], interval, tension)
            lowest[k] = smallest_of(kind.part_extremes[entry.first + k], interval, tension)
        if rope.fresh:
            show_pulls(kind, i, largest)
        else:
            _show_parts(kind, i)
        e = max(0.0, rope.stretched - rope.rest)
        work.sums.elastic += 0.5 * stiffness_of(kind, i, 1.0 / rope.rest) * e * e
        work.sums.drift = max(work.sums.drift, abs(rope.drift))
        put_rope(rope_outputs(row, entry.column), kind, i, interval, largest, length)
        work.sums.drive_work += rope.winch_work
        work.sums.dissipated += rope.loss
        speeds, states = part(row, chain.parts.sheave_speed), part(row, chain.parts.sheave_state)
        for k in range(chain.count):
            state = kind.sheave_state[chain.first + k]
            speeds[k] = state.speed if state.branch != 0 else 0.0  # else that of compliance
            states[k] = float(state.branch)
            work.sums.drive_work += state.work
            work.sums.dissipated += state.loss
