"""Forces with corners on a distance, angle or travel: tabulated springs, stops, dry friction.

Each is one row with a law. Springs and stops take the discrete gradient of their energy over a carried
value ``q += h G v``, so no step gains energy from a corner. A friction row is either a
constant load against the motion, or sticks: then its rate is zero, in the middle of the step like a rigid
row, and at its end too, because the step would turn the last velocity round. It also sticks where the load
would reverse the motion within the step.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats2
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, Records
from heavylift.solver.extremes import Agreement, Extremes, Store, compare_force, note_stored, note_value
from heavylift.solver.force_elements.forces import mean_force, pull
from heavylift.solver.force_elements.rows import (
    RETURN,
    check_drift,
    fit_law,
    law_impulse,
    put_law,
    put_residual,
    put_stick,
    row_rate,
)
from heavylift.solver.forces.spring import (
    SpringEntry,
    compare_load,
    end_rate,
    put_spring,
    spring_load,
    stored_energy,
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
from heavylift.solver.joints.coordinate import (
    ANGLE,
    coordinate_row,
    coordinate_value,
)
from heavylift.solver.joints.row_writing import near_angle
from heavylift.solver.kinds import implement
from heavylift.solver.ringing import steady_rate
from heavylift.solver.rows.structure import RowArrays

__all__ = ["FRICTION", "SPRING", "STOP", "ScalarLaw", "ScalarLawState", "ScalarLaws"]

SPRING, STOP, FRICTION = range(3)
"""Laws. A spring has a rest value and a table, a stop lower and upper ends, friction its largest load."""

PLAIN_ROUNDS = 5
"""Rounds of the iteration after which a table is fitted by chords too: tangents alone can go to and fro."""


class ScalarLaw(SpringEntry):
    """A law; values in [m] or [rad], loads in [N] or [N m].

    A spring has a table and a damper, a stop the stiffness and damping of its ends.

    Attributes
    ----------
    law
        `SPRING`, `STOP` or `FRICTION`.
    lower, upper
        Ends of a stop.
    largest
        Load of friction that slides.
    largest_drift
        Of the carried value from the geometry, beyond which a run ends.
    """

    law: int
    lower: float
    upper: float
    largest: float
    largest_drift: float


class ScalarLawState(Record):
    """What a law carries.

    Attributes
    ----------
    fresh
        Whether no step has been made yet.
    paced
        Whether two have been made, so that `growth` is known.
    value
        Carried value [m] or [rad].
    loss
        Energy lost [J].
    rate, growth
        Of the last step, and half its difference from that of the step before.
    drift
        Distance of the carried value from the geometry.
    branch
        0 if friction sticks; -1 or 1, the sense in which it acts, if it slides.
    load, extremes
        Of a spring: force at the end of the last step [N, N m], and its extremes.
    agreement
        Of a spring or stop: of the force with the elongation.
    store
        Elastic energy of a spring or stop from step to step.
    last_rate, last_force, rounds
        Scratch of the iteration: of its last round, and how many there were.
    """

    fresh: bool
    paced: bool
    value: float
    loss: float
    rate: float
    growth: float
    drift: float
    branch: int
    load: float
    extremes: Extremes
    agreement: Agreement
    store: Store
    last_rate: float
    last_force: float
    rounds: int


class ScalarLaws(Arrays):
    """All tabulated springs, stops and friction of a scene.

    Attributes
    ----------
    table
        The laws.
    curves
        Rows (elongation, force) of all tables, shape (m, 2).
    state
        What they carry.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    table: Records[ScalarLaw]
    curves: Floats2
    state: Records[ScalarLawState]

    def one_sided(
        self,
    ) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Block, sense, elongation and stiffness of both ends of stops: see `solver.statics.forces.OneSided`."""
        stops = np.flatnonzero(self.table["law"] == STOP)
        table, value = self.table[stops], self.state["value"][stops]
        sense = np.repeat([1.0, -1.0], len(stops))
        elongation = np.concatenate([value - table["upper"], table["lower"] - value])
        return np.tile(table["block"], 2), sense, elongation, np.tile(table["stiffness"], 2)


@kernel(internal=True)
def _carry(kind: ScalarLaws, i: int, q: float) -> float:
    """Compare the carried value with the geometry; before the first step it is the geometry."""
    state = kind.state[i]
    if kind.table[i].coordinate == ANGLE:
        q = near_angle(q, state.value)
    if state.fresh:
        state.value = q
    state.drift = q - state.value
    return q


@kernel(internal=True)
def _law(kind: ScalarLaws, i: int, u: float, h: float) -> tuple[float, float, float]:
    """Conservative force, force, and its derivative by the rate u, mean over a step; positive ones hold q back."""
    law = kind.table[i]
    q = kind.state[i].value
    c = law.damping
    if law.law == SPRING:
        first, count, rest = law.first, law.count, law.rest
        elastic, slope = mean_force(kind.curves, first, count, 0.0, q - rest, q - rest + h * u)
        return elastic, elastic + c * u, h * slope + c
    k = law.stiffness
    high, above, slope = pull(q - law.upper, q - law.upper + h * u, k, c, h)
    low, below, other = pull(law.lower - q, law.lower - q - h * u, k, c, h)
    return high - low, above - below, h * (slope + other)


@implement(fill_rows, ScalarLaws)
@kernel(internal=True)
def fill_scalar_rows(kind: ScalarLaws, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows; drift of the carried values."""
    for i in range(kind.table.shape[0]):
        law = kind.table[i]
        q = coordinate_row(system, law.block, work, law.coordinate, law.a, law.b, law.c)
        if with_residual:
            put_residual(system, law.block, _carry(kind, i, q))


@kernel(inline=True, internal=True)
def _rate(kind: ScalarLaws, i: int, work: Workspace, system: RowArrays) -> float:
    """Rate of a row at the velocity of the stage."""
    first = 2 * kind.table[i].block
    return row_rate(system, first, first + 2, work.velocity)


@kernel(internal=True)
def _put_friction(kind: ScalarLaws, i: int, h: float, system: RowArrays) -> None:
    """Row of the present branch."""
    block, branch = kind.table[i].block, kind.state[i].branch
    if branch == 0:
        put_stick(system, block)
    else:
        put_law(system, block, h, 0.0, branch * kind.table[i].largest, 0.0)


@implement(set_targets, ScalarLaws)
@kernel(internal=True)
def set_scalar_targets(
    kind: ScalarLaws, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """First guess: rate and branch of the last step. At its end friction sticks as in the middle."""
    for i in range(kind.table.shape[0]):
        block, state = kind.table[i].block, kind.state[i]
        if kind.table[i].law != FRICTION:
            if at_midpoint:
                _, force, slope = _law(kind, i, state.rate, step)
                put_law(system, block, step, state.rate, force, slope)
                state.last_rate, state.last_force, state.rounds = state.rate, force, 0
        elif at_midpoint:
            state.rounds = 0
            _put_friction(kind, i, step, system)
        elif not state.fresh and state.branch * _rate(kind, i, work, system) <= 0.0:
            state.branch = 0
            put_stick(system, block)


@implement(relinearise, ScalarLaws)
@kernel(internal=True)
def relinearise_scalar_laws(
    kind: ScalarLaws, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Fit the laws to the rates found."""
    for i in range(kind.table.shape[0]):
        block, state = kind.table[i].block, kind.state[i]
        u = _rate(kind, i, work, system)
        if kind.table[i].law == FRICTION:
            P, limit = law_impulse(system, block), 0.5 * step * kind.table[i].largest
            branch = state.branch
            state.rounds += 1
            if state.rounds > PLAIN_ROUNDS and work.control.changed > 0:
                continue  # rows that change together can go in circles; the first of them alone cannot
            if branch == 0 and abs(P) > limit * (1.0 + 1e-10):
                state.branch = -1 if P > 0.0 else 1
            elif branch * u < 0.0:
                state.branch = 0
            if state.branch != branch:
                _put_friction(kind, i, step, system)
                work.control.changed += 1
                work.status.block = block
            continue
        _, force, slope = _law(kind, i, u, step)
        state.rounds += 1
        if state.rounds > PLAIN_ROUNDS and u != state.last_rate:
            slope = max(slope, (force - state.last_force) / (u - state.last_rate))
        state.last_rate, state.last_force = u, force
        fit_law(system, block, step, u, force, slope, work)


@implement(update_rows, ScalarLaws)
@kernel(internal=True)
def update_scalar_laws(
    kind: ScalarLaws, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Carry the values over the step; energy lost."""
    for i in range(kind.table.shape[0]):
        block, state = kind.table[i].block, kind.state[i]
        u = _rate(kind, i, work, system)
        if kind.table[i].law == FRICTION:
            state.loss -= 2.0 * law_impulse(system, block) * u
        else:
            elastic, force, _ = _law(kind, i, u, step)
            state.loss += step * (force - elastic) * u
        state.value += step * u
        if kind.table[i].law != FRICTION and _law(kind, i, 0.0, step)[0] * state.drift <= 0.0:
            state.value += RETURN * state.drift
        state.growth = step / (step + work.control.last_step) * (u - state.rate)
        state.rate, state.paced = u, not state.fresh
        state.fresh = False


@kernel(inline=True, internal=True)
def _beyond(law: ScalarLaw, q: float) -> float:
    """How far a value is beyond its stop."""
    return max(0.0, q - law.upper, law.lower - q)


@kernel(inline=True, internal=True)
def _stored(kind: ScalarLaws, law: ScalarLaw, q: float) -> float:
    """Elastic energy of a spring or stop at a value [J]."""
    if law.law == SPRING:
        return stored_energy(kind.curves, law, q - law.rest)
    beyond = _beyond(law, q)
    return 0.5 * law.stiffness * beyond * beyond


@implement(watch_joints, ScalarLaws)
@kernel(internal=True)
def watch_scalar_laws(kind: ScalarLaws, work: Workspace, system: RowArrays) -> None:
    """Forces of springs at the end of the step; values that have left the geometry end the run."""
    for i in range(kind.table.shape[0]):
        law, state = kind.table[i], kind.state[i]
        if law.law != FRICTION:  # whose value makes no force
            check_drift(law.block, state.drift, law.largest_drift, work)
            note_stored(state.store, _stored(kind, law, state.value))
        if law.law != SPRING:
            continue
        rate = 0.0
        if law.damping > 0.0:
            rate = _rate(kind, i, work, system)
            if state.paced:
                rate = steady_rate(state.rate, state.growth, rate)
        state.load = spring_load(kind.curves, law, state.value - law.rest, rate)
        note_value(state.extremes, work.control.interval, state.load)


@implement(record_joints, ScalarLaws)
@kernel(internal=True)
def record_scalar_laws(
    kind: ScalarLaws, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Force of a tabulated spring, length of one between points; energies of all laws."""
    for i in range(kind.table.shape[0]):
        law, state = kind.table[i], kind.state[i]
        geometric = _carry(kind, i, coordinate_value(work, law.coordinate, law.a, law.b, law.c))
        q = state.value
        work.sums.dissipated += state.loss
        if law.law != FRICTION:
            work.sums.drift = max(work.sums.drift, abs(state.drift))
            work.sums.elastic += _stored(kind, law, q)
        if law.law == SPRING:
            e = q - law.rest
            load = state.load
            if state.fresh:
                load = spring_load(kind.curves, law, e, end_rate(law, work))
            elif state.paced:
                at = geometric - law.rest
                compare_load(state.agreement, kind.curves, law, time, at, state.rate, state.growth, load)
            put_spring(row, law, state.extremes, work.control.interval, load, geometric)
        elif law.law == STOP:
            expected = law.stiffness * _beyond(law, geometric)
            compare_force(state.agreement, time, law.stiffness * _beyond(law, q), expected, expected)
