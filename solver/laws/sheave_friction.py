"""Wire ropes over sheaves with an efficiency: a tension a part, and sheaves over which the rope sticks or slides.

With the lengths ``L_k`` and tensions ``T_k`` of the parts, from the first end on, and the unstretched length l::

    T = sum w_k T_k,   w_k = L_k / L             tension of the elongation of the whole, as without friction
    f_j = T_j+1 - T_j                            friction of sheave j
    q_j = sum_(k>j) L_k' - W_j L' + s_j l',      W_j = sum_(k>j) w_k

The rope runs over sheave j towards the last end at the speed q_j, if it stretches alike everywhere; ``s_j`` is W_j for
a winch at the first end and ``W_j - 1`` for one at the last. Virtual power says that these are conjugate: the forces on
the bodies are ``T L' + sum f_j (q_j - s_j l')``. So a rope is the row of its length, as any, and a row for each of such
sheaves with its dry friction::

    eta <= T_j+1 / T_j <= 1/eta,     q_j = 0 in between,     T_j+1 = T_j / eta if q_j > 0,  eta T_j if q_j < 0

A sheave that sticks is a rigid row, which begins with the force that it had: what rigid bodies leave open, the tensions
of a fall that stands still, stays as it was. Of one that slides the force is given, and found by iteration together
with the tensions: those are linear in the forces while none changes its state, so two rounds and their line (D. G.
Anderson, J. ACM 12, 1965) leave little. The power ``sum f_j q_j`` is lost, and the winch works against the tension of
its own end. Bearings turn no bodies: tensions act at the tangent points (`find_parts`).

Values: Wire Rope Technical Board, Wire Rope Users Manual, 4th ed.: 1.04 for roller bearings, 1.09 for plain ones, of
the tension of a sheave over that before it.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, Records
from heavylift.solver.extremes import largest_of, note_value, smallest_of
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
from heavylift.solver.laws.rope_path import PlaceGradient, find_parts
from heavylift.solver.laws.rows import FREE_SOFTNESS, ROWS_A_BLOCK, law_impulse, put_residual
from heavylift.solver.laws.sheave_states import SheaveSearch, find_states
from heavylift.solver.laws.wire_rope import (
    Ropes,
    compare_length,
    compare_tension,
    end_tension,
    midpoint_rate,
    midpoint_tension,
    path_rate,
    put_places,
    relinearise_ropes,
    set_rope_targets,
    show_pulls,
    stiffness_of,
    update_ropes,
    watch_stretch,
    winch_state,
)
from heavylift.solver.rows.structure import REGULARISATION, RowArrays

__all__ = ["Chain", "Sheave", "SheaveState", "SheavedRopes"]

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


class Chain(Record):
    """Sheaves of a rope.

    Attributes
    ----------
    first, count
        Its first sheave with an efficiency, and how many.
    stride
        Blocks from one that has rows of it to the next.
    winch_last
        1 if the drum is at the last end.
    settling, asked, standing, largest
        Scratch of the iteration: rounds since a sheave has changed its state, whether a search asks the rope, whether
        all sheaves stuck in the last step, and the largest tension [N].
    """

    first: int
    count: int
    stride: int
    winch_last: float
    settling: int
    asked: bool
    standing: bool
    largest: float


class Sheave(Record):
    """A place with an efficiency: its place in all paths, block and lane of its row, record column of its speed."""

    place: int
    block: int
    lane: int
    column: int
    efficiency: float


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
    force_before: float
    miss_before: float


class SheavedRopes(Ropes):
    """All ropes of a scene that pass places with an efficiency below 1.

    Attributes
    ----------
    chains
        Of each rope.
    sheaves, sheave_state
        Of all ropes.
    leaving
        Derivatives of the part behind each place.
    parts
        Length of the part behind each place [m].
    tension
        Of the part behind each place, in the middle of the last step [N].
    search
        For states, where those of the last step and what contradicts them do not lead to any.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state", "wraps", "sheave_state", "tension")

    chains: Records[Chain]
    sheaves: Records[Sheave]
    sheave_state: Records[SheaveState]
    leaving: Records[PlaceGradient]
    parts: Floats1
    tension: Floats1
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
    return length


@kernel(inline=True, internal=True)
def _panel(kind: SheavedRopes, system: RowArrays, i: int, row: int, side: int) -> int:
    """Place in the panels of a row on one of the bodies of a rope."""
    block = kind.table[i].block + row // ROWS_A_BLOCK * kind.chains[i].stride
    return system.attachments[2 * block + side].panel + row % ROWS_A_BLOCK


@kernel(internal=True)
def _add_part(
    kind: SheavedRopes,
    i: int,
    p: int,
    row: int,
    behind: bool,
    before: bool,
    work: Workspace,
    system: RowArrays,
) -> None:
    """Add the derivatives of the part behind a place, of that before it, or of both, to a row."""
    marker, axis, side = kind.places[p].marker, kind.places[p].axis, kind.places[p].attachment
    if side < 0:
        return
    side += 2 * (row // ROWS_A_BLOCK * kind.chains[i].stride)
    lane = row % ROWS_A_BLOCK
    g, after = kind.gradient[p], kind.leaving[p]
    whole = 1.0 if before else 0.0
    part = (1.0 if behind else 0.0) - whole
    x = whole * g.centre[0] + part * after.centre[0]
    y = whole * g.centre[1] + part * after.centre[1]
    z = whole * g.centre[2] + part * after.centre[2]
    add_direction_row(system, side, lane, work, marker, (x, y, z))
    if axis >= 0:
        x = whole * g.axis[0] + part * after.axis[0]
        y = whole * g.axis[1] + part * after.axis[1]
        z = whole * g.axis[2] + part * after.axis[2]
        add_direction_row(system, side, lane, work, axis, (x, y, z))


@implement(fill_rows, SheavedRopes)
@kernel(internal=True)
def fill_sheaved_rows(kind: SheavedRopes, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """The row of the length, then those of the flows without what a winch brings.

    Each place adds to the rows of the two parts that meet there only; sums over all parts beyond are taken of rows.
    """
    lanes = system.lanes
    for i in range(kind.table.shape[0]):
        length = _find_shares(kind, i, work)
        first_sheave, count = kind.chains[i].first, kind.chains[i].count
        sides, width_of = kind.table[i].attachments, 2 * kind.table[i].block
        for row in range(count + 1):
            for side in range(sides):
                panel = _panel(kind, system, i, row, side)
                for k in range(system.attachments[width_of + side].width):
                    system.panels[panel + k * lanes] = 0.0
        row = 0
        for p in range(kind.table[i].first, kind.table[i].first + kind.table[i].places):
            if row < count and kind.sheaves[first_sheave + row].place == p:
                _add_part(kind, i, p, row, False, True, work, system)
                row += 1
                _add_part(kind, i, p, row, True, False, work, system)
            else:
                _add_part(kind, i, p, row, True, True, work, system)
        for side in range(sides):
            width = system.attachments[width_of + side].width
            for r in range(count - 1, -1, -1):
                panel, beyond = _panel(kind, system, i, r, side), _panel(kind, system, i, r + 1, side)
                for k in range(width):
                    system.panels[panel + k * lanes] += system.panels[beyond + k * lanes]
            whole = _panel(kind, system, i, 0, side)
            for r in range(count):
                panel, share = _panel(kind, system, i, r + 1, side), kind.sheave_state[first_sheave + r].share
                for k in range(width):
                    system.panels[panel + k * lanes] -= share * system.panels[whole + k * lanes]
        if with_residual:
            compare_length(kind, i, length)
            put_residual(system, kind.table[i].block, length - kind.state[i].rest)


@kernel(internal=True)
def _flow(
    kind: SheavedRopes, i: int, s: int, hauling: float, velocity: NDArray[np.float64], system: RowArrays
) -> float:
    """Speed of the rope over a sheave [m/s] while its winch hauls in at a speed [m/s]."""
    lanes, lane = system.lanes, kind.sheaves[s].lane
    first = 2 * kind.sheaves[s].block
    q = (kind.chains[i].winch_last - kind.sheave_state[s].share) * hauling
    for side in range(first, first + kind.table[i].attachments):
        dof, panel = system.attachments[side].dof, system.attachments[side].panel + lane
        for k in range(system.attachments[side].width):
            q += system.panels[panel + k * lanes] * velocity[dof + k]
    return q


@kernel(inline=True, internal=True)
def _hauling(kind: SheavedRopes, i: int, step: float) -> float:
    """Mean speed of the winch in the step [m/s]."""
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
    prescribed = (kind.chains[i].winch_last - kind.sheave_state[s].share) * hauling
    row.softness[lane] = softness
    row.target[lane] = softness * held - prescribed


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
    s, last = kind.chains[i].first, kind.chains[i].first + kind.chains[i].count
    start = 0.0
    for turn in range(2):  # the first one finds T_1
        a, b = (1.0, 0.0) if turn == 0 else (0.0, start)
        sum_a = sum_b = total = 0.0
        j = s
        for part in range(parts):
            if part > 0 and j < last and kind.sheaves[j].place == first + part:
                state = kind.sheave_state[j]
                if state.acting == 0:
                    b += state.force
                else:
                    ratio = kind.sheaves[j].efficiency
                    ratio = 1.0 / ratio if state.acting > 0 else ratio
                    a, b = a * ratio, b * ratio
                j += 1
            length = kind.parts[first + part]
            total += length
            sum_a += length * a
            sum_b += length * b
            kind.tension[first + part] = b
        start = (mean * total - sum_b) / sum_a if turn == 0 else start
    largest = 0.0
    for part in range(parts):
        largest = max(largest, kind.tension[first + part])
    return largest


@implement(set_targets, SheavedRopes)
@kernel(internal=True)
def set_sheaved_targets(
    kind: SheavedRopes, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """First guess: rates, states and forces of the last step.

    At its end sheaves stick as in the middle, and where the step has turned the flow round.
    """
    set_rope_targets(kind, time, step, at_midpoint, work, system)
    if at_midpoint:
        counts = kind.search.counts
        counts.phase = counts.rounds = counts.attempts = 0
    for i in range(kind.table.shape[0]):
        chain, rope = kind.chains[i], kind.state[i]
        if at_midpoint:
            chain.asked, chain.settling, chain.standing = False, 0, not rope.fresh
            for s in range(chain.first, chain.first + chain.count):
                chain.standing = chain.standing and kind.sheave_state[s].stuck
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
            state.speed = _flow(kind, i, s, rope.hauling, work.velocity, system)
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
    kind: SheavedRopes, i: int, mean: float, largest: float, step: float, work: Workspace, system: RowArrays
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
            flow = _flow(kind, i, s, hauling, work.velocity, system) + creep * (state.held - state.force)
            if state.branch * flow < -SMALL * creep * largest:
                state.other = 0
        if state.other != state.branch:
            found += 1
    return found


@kernel(internal=True)
def _fit_friction(kind: SheavedRopes, i: int, largest: float) -> bool:
    """Bring the forces of sheaves that slide nearer to the tensions beside them; whether they did not fit."""
    chain = kind.chains[i]
    miss = along = square = 0.0
    for s in range(chain.first, chain.first + chain.count):
        state, p = kind.sheave_state[s], kind.sheaves[s].place
        if state.branch != 0:
            F = kind.tension[p] - kind.tension[p - 1] - state.force
            miss = max(miss, abs(F))
            along += F * (F - state.miss_before)
            square += (F - state.miss_before) ** 2
    if miss <= SETTLED * largest:
        return False
    theta = along / square if chain.settling > 0 and square > 0.0 else 0.0
    for s in range(chain.first, chain.first + chain.count):
        state, p = kind.sheave_state[s], kind.sheaves[s].place
        if state.branch != 0:
            x, F = state.force, kind.tension[p] - kind.tension[p - 1] - state.force
            state.force = x + F - theta * (x - state.force_before + F - state.miss_before)
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
    for k in range(counts.sheaves):
        i, s = search.rope[k], search.number[k]
        q = _flow(kind, i, s, _hauling(kind, i, step), work.velocity, system)
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
    for j in range(counts.sheaves):
        i = search.rope[j]
        q = _flow(kind, i, search.number[j], _hauling(kind, i, step), work.velocity, system)
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
        _, mean, _, _, _ = midpoint_tension(kind, i, midpoint_rate(kind, i, work, system), step)
        for s in range(chain.first, chain.first + chain.count):
            if kind.sheave_state[s].branch == 0:
                kind.sheave_state[s].force = -2.0 / step * _impulse(kind, s, system)
        chain.largest = _find_tensions(kind, i, mean)
        others = _find_others(kind, i, mean, chain.largest, step, work, system)
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
                _, mean, _, _, _ = midpoint_tension(kind, i, midpoint_rate(kind, i, work, system), step)
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
        for s in range(chain.first, chain.first + chain.count):
            state = kind.sheave_state[s]
            state.force = -2.0 / step * _impulse(kind, s, system)
            change = 0.0 if kind.state[i].fresh else state.force - state.held
            state.trend = 2.0 / (step + work.control.last_step) * change
            state.held, state.stuck = state.force, state.branch == 0
            state.loss += step * state.force * _flow(kind, i, s, hauling, work.velocity, system)
            state.work += step * state.force * (chain.winch_last - state.share) * hauling
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
        for s in range(chain.first, chain.first + chain.count):
            state, P = kind.sheave_state[s], _impulse(kind, s, system)
            before = state.speed
            if state.stops:
                state.branch, state.stops = 0, False
            state.speed = _flow(kind, i, s, rope.hauling, work.velocity, system)
            state.loss -= 0.5 * P * (before + state.speed)
            state.work -= P * (chain.winch_last - state.share) * rope.hauling
        rate = midpoint_rate(kind, i, work, system) if kind.table[i].damping > 0.0 else 0.0
        rope.tension = end_tension(kind, i, rope.hauling, rate)
        note_value(rope.extremes, work.control.interval, _end_tensions(kind, i, rope.tension))
        _show_parts(kind, i)
        watch_stretch(kind, i, work)


@implement(record_joints, SheavedRopes)
@kernel(internal=True)
def record_sheaved_ropes(
    kind: SheavedRopes, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """As a rope, with tensions of the parts, and speed and state of each sheave."""
    for i in range(kind.table.shape[0]):
        rope, chain, column = kind.state[i], kind.chains[i], kind.table[i].column
        length = _find_shares(kind, i, work)
        compare_length(kind, i, length)
        first, parts = kind.table[i].first, kind.table[i].places - 1
        largest = 0.0
        if rope.fresh:  # what friction does is not known before the first step
            hauling = winch_state(kind, i, time)[1]
            largest = end_tension(kind, i, hauling, path_rate(kind, i, work))
        elif rope.paced:
            compare_tension(kind, i, time, length, rope.tension)
        for part in range(parts):
            tension = largest if rope.fresh else kind.tension[first + part]
            largest = max(largest, tension)
            row[column + 6 + part] = tension
        if rope.fresh:
            show_pulls(kind, i, largest)
        else:
            _show_parts(kind, i)
        e = max(0.0, rope.stretched - rope.rest)
        work.sums.elastic += 0.5 * stiffness_of(kind, i, 1.0 / rope.rest) * e * e
        work.sums.drift = max(work.sums.drift, abs(rope.drift))
        row[column] = largest
        row[column + 1] = length
        row[column + 2] = rope.rest
        row[column + 3] = rope.drift
        row[column + 4] = largest_of(rope.extremes, work.control.interval, largest)
        row[column + 5] = smallest_of(rope.extremes, work.control.interval, largest)
        work.sums.drive_work += rope.winch_work
        work.sums.dissipated += rope.loss
        for s in range(chain.first, chain.first + chain.count):
            state = kind.sheave_state[s]
            row[kind.sheaves[s].column] = state.speed if state.branch != 0 else 0.0  # else that of compliance
            row[kind.sheaves[s].column + chain.count] = float(state.branch)
            work.sums.drive_work += state.work
            work.sums.dissipated += state.loss
