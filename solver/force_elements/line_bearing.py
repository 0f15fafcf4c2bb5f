"""Line bearings: a line of one body lies loose on a plane of another one, slides with friction and lifts off.

Each end of the line is a point on the plane with three rows: its height q over the plane, along its normal n, and its
two ways along the plane. The normal force is that of a spring and damper which pushes only, ``N = k max(0, -q)``, as
the discrete gradient of its energy over a carried q (O. Gonzalez, J. Nonlinear Sci. 6, 1996), so that no step gains
energy where it lifts off or comes back.

Friction is elastic up to a limit that follows the load: a displacement e of the point against what it sticks to, as
stiff as the bearing, ``|k e| <= mu N``. In a step the point moves by d along the plane. It sticks until e reaches the
limit, for the share t of the step, and slides for the rest; the friction is the mean of both::

    F = t k (e + t d/2) + (1 - t) mu N m ,       F . d = change of k e^2/2 + (1 - t) mu N m . d

m the mean direction of e while it slides, which turns towards d. The last term is what is lost, and never negative.
So a point that sticks is held by a spring, and several bearings beside each other are never overconstrained.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.numerics.quantity import Absent, BodyDirection, Positive, Quantity
from heavylift.numerics.records import Record, Records, filled, records
from heavylift.numerics.records import Vector as VectorField
from heavylift.solver.extremes import (
    Agreement,
    Extremes,
    Store,
    compare_force,
    largest_of,
    note_stored,
    note_value,
    smallest_of,
)
from heavylift.solver.force_elements.forces import pull
from heavylift.solver.force_elements.rows import (
    FITTED,
    RETURN,
    check_drift,
    fit_row_law,
    put_row_law,
    rate_of_row,
)
from heavylift.solver.interface import (
    ROWS,
    Workspace,
    fill_rows,
    record_joints,
    relinearise,
    set_targets,
    update_rows,
    watch_joints,
)
from heavylift.solver.joints.row_writing import residuals, travel, travel_row
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.ringing import steady_rate
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.connections import FORCES, Between, as_joint
from heavylift.solver.scene.descriptions import upwards
from heavylift.solver.scene.outputs import (
    Components,
    Outputs,
    channel,
    largest,
    outputs,
    smallest,
)

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackingContext

__all__ = ["BearingEnd", "BearingState", "LineBearing", "LineBearings", "pack", "rub"]

NOT_CLOSED = int(Outcome.NOT_CLOSED)

DEEPEST = 0.05
"""By which the line may be below the plane at the start [m]."""

LARGEST_DRIFT = 0.05
"""Of a carried height from the geometry [m], beyond which a run ends."""

ENDS = ("left", "right")

NEGLIGIBLE = 1e-9
"""Miss of a component of friction that counts as fitted, over the largest friction."""

KEPT = 0.01
"""Change of a slope of friction over the inertia of its row, up to which the factor of the last slope serves: a round
then gains two digits, as it does anyhow where friction follows the load."""

PLAIN_ROUNDS = 5
"""Rounds of the iteration after which laws are fitted by chords too: tangents alone can go to and fro."""


@outputs
class BearingOutputs(Outputs):
    """What a line bearing records."""

    force: float = channel("force", "normal force on the line, of both its ends together")
    force_max: float = largest("force", "force")
    force_min: float = smallest("force", "force")
    force_at: Components = channel("force", "normal force at each end of the line", ENDS)
    friction: Components = channel(
        "force", "friction on the line, of both its ends: along the deck and to its left", ("along", "across")
    )
    lift_off: Components = channel(
        "length", "height of each end of the line over the plane, below 0 pressed", ENDS
    )
    overlap: float = channel("length", "from the border of the deck to the nearer end of the line")
    slip_path: Components = channel("length", "distance that each end of the line has slid so far", ENDS)


@FORCES.describe("line_bearing")
@dataclass(frozen=True, eq=False, kw_only=True)
class LineBearing(Between):
    """A line of a body lies loose on a plane of another one: with both ends it pushes, slides and lifts off."""

    CHANNELS: ClassVar = BearingOutputs.CHANNELS
    """What it records, in the order of its columns."""
    SENTENCES: ClassVar = {
        "between": 'Body, or ``"ground"``, whose plane carries, and the body whose line lies on it.',
        "points": "Where the deck begins, a point of the plane, and the middle of the line, in the coordinates of the "
        "geometries; of the ground in the world [m].",
    }

    inward: Annotated[NDArray[np.float64], BodyDirection()]
    """From its border onto the deck, in the axes of the first body: the line lies across it at the start."""
    normal: Annotated[NDArray[np.float64], BodyDirection()] = field(default_factory=upwards)
    """Of the plane, away from it, in the axes of the first body, at a right angle to `inward`."""
    deck_length: Annotated[float, Positive("length"), Absent()] = np.inf
    """From its border to its other one [m]; it has none if absent. An end of the line that leaves the deck stops the
    run."""
    length: Annotated[float, Positive("length")]
    """Of the line [m]."""
    stiffness: Annotated[float, Positive("stiffness")]
    """Of each end [N/m], upwards and while it sticks."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """Of each end, upwards [N s/m]; limited so that it never pulls."""
    friction: Annotated[float, Quantity("number", minimum=0.0, closed=True)] = 0.0
    """Coefficient."""

    def obstacle(self, integrator: str) -> str:
        """Its force has corners."""
        return "" if integrator == "dele2" else "opens and closes"

    @staticmethod
    def check(spec: Any) -> None:
        """A plane has a normal and a direction in it."""
        for key, direction in (("inward", spec.inward), ("normal", spec.normal)):
            if not any(direction):
                raise InputError("a direction of length zero", key=key, expected="a direction")
        onto, up = (np.asarray(v, dtype=np.float64) for v in (spec.inward, spec.normal))
        if abs(float(onto @ up)) > 1e-9 * float(np.linalg.norm(onto) * np.linalg.norm(up)):
            raise InputError(
                f"{onto.tolist()} leans against the normal {up.tolist()}",
                key="inward",
                expected="a direction at a right angle to 'normal'",
            )


class BearingEnd(Record):
    """An end of a line.

    Attributes
    ----------
    block, column
        Of its rows; first record column of the bearing.
    left
        Whether it is the left one, which is followed by the right one.
    deck, normal, inward, across
        Markers of the border of the deck and of the directions of the plane.
    point
        Marker of the end.
    stiffness, damping, friction
        [N/m], [N s/m], coefficient.
    deck_length
        [m].
    largest_drift
        As in `ScalarLaw`.
    """

    block: int
    column: int
    left: bool
    deck: int
    normal: int
    inward: int
    across: int
    point: int
    stiffness: float
    damping: float
    friction: float
    deck_length: float
    largest_drift: float


bearing_outputs = outputs_at(BearingOutputs)


class BearingState(Record):
    """What an end carries.

    Attributes
    ----------
    fresh, paced
        Whether no step has been made yet; whether two have been made, so that `growth` is known.
    value, drift
        Carried height over the plane [m], and how far it is from the geometry.
    along, across
        Displacement of the point against what it sticks to [m].
    rate, growth, along_rate, across_rate
        Of the last step [m/s]; of the height also half its difference from that of the step before.
    loss, slid
        Energy lost [J]; way that it has slid [m].
    load, extremes
        Normal force at the end of the step [N]; extremes of that of both ends, at the left one.
    overlap
        From the nearer border of the deck [m].
    agreement, store
        Of the normal force with the height; elastic energy from step to step.
    last_rate, last_force, rounds
        Scratch of the iteration, by row.
    """

    fresh: bool
    paced: bool
    value: float
    drift: float
    along: float
    across: float
    rate: float
    growth: float
    along_rate: float
    across_rate: float
    loss: float
    slid: float
    load: float
    extremes: Extremes
    overlap: float
    agreement: Agreement
    store: Store
    last_rate: VectorField
    last_force: VectorField
    rounds: int


class LineBearings(Arrays):
    """All line bearings of a scene, by their ends: the left one, the right one.

    Attributes
    ----------
    table
        The ends.
    state
        What they carry.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    table: Records[BearingEnd]
    state: Records[BearingState]

    def one_sided(
        self,
    ) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Block, sense, elongation and stiffness of all ends: see `solver.statics.forces.OneSided`."""
        return (
            self.table["block"].copy(),
            np.full(len(self.table), -1.0),
            -self.state["value"],
            self.table["stiffness"].copy(),
        )


def pack(bearings: Sequence[LineBearing], context: PackingContext) -> None:
    """Make the kind and its rows.

    Raises
    ------
    InputError
        If an end is not on the deck at the start, or below its plane.
    """
    rows, overlaps = [], []
    for bearing in bearings:
        onto, normal = (np.asarray(v, dtype=np.float64) for v in (bearing.inward, bearing.normal))
        onto, normal = onto / np.linalg.norm(onto), normal / np.linalg.norm(normal)
        across = np.cross(normal, onto)
        deck, line = context.start_frames(as_joint(bearing))
        # the line in the axes of the second body: where it lies across the deck at the start
        half = 0.5 * bearing.length * (line.axes.T @ deck.axes @ across)
        a, b = bearing.body_a, bearing.body_b
        point_a = np.asarray(bearing.point_a, dtype=np.float64)
        point_b = np.asarray(bearing.point_b, dtype=np.float64)
        border = context.point(a, point_a, ROWS)
        directions = [context.direction(a, v, ROWS, at=point_a) for v in (normal, onto, across)]
        place = deck.axes.T @ (line.point - deck.point)
        _check_place(bearing, float(normal @ place), float(onto @ place))
        for left in (True, False):
            block = context.block(bearing.name, (a, b), rows=3)
            rows.append(
                filled(
                    BearingEnd,
                    block=block,
                    column=context.column(bearing),
                    left=left,
                    deck=border,
                    normal=directions[0],
                    inward=directions[1],
                    across=directions[2],
                    point=context.point(b, point_b + half if left else point_b - half, ROWS),
                    stiffness=bearing.stiffness,
                    damping=bearing.damping,
                    friction=bearing.friction,
                    deck_length=bearing.deck_length,
                    largest_drift=LARGEST_DRIFT,
                )
            )
            overlaps.append(float(onto @ place))
    state = records(BearingState, len(rows))
    state["fresh"], state["overlap"] = True, overlaps
    context.add_rows(LineBearings(records(BearingEnd, rows), state))


def _check_place(bearing: LineBearing, height: float, overlap: float) -> None:
    """Refuse a line that is not on its deck at the start."""
    if not 0.0 < overlap < bearing.deck_length:
        before = overlap <= 0.0
        raise InputError(
            f"its line is {-overlap if before else overlap - bearing.deck_length:.6g} m "
            f"{'before the border' if before else 'behind the end'} of the deck at the start",
            source=bearing.name,
            key="points",
            expected="a line on the deck: a longer body, or another place",
        )
    if height < -DEEPEST:
        raise InputError(
            f"its line is {-height:.6g} m below the plane at the start",
            source=bearing.name,
            key="points",
            expected=f"at most {DEEPEST:g} m: on the plane, or over it",
        )


@kernel(internal=True)
def rub(
    ex: float, ey: float, dx: float, dy: float, k: float, limit: float
) -> tuple[float, float, float, float, float, float, float]:
    """Friction on a point that moves along a plane, mean over a step.

    Parameters
    ----------
    ex, ey
        Its displacement against what it sticks to, at the start of the step [m].
    dx, dy
        Its way in the step [m].
    k, limit
        Stiffness while it sticks [N/m]; largest friction [N].

    Returns
    -------
    fx, fy
        Force against the way [N].
    along, across
        Displacement at the end of the step [m].
    lost
        Energy [J].
    slope_x, slope_y
        Derivatives of the force by the way [N/m]; without those by the other component.
    """
    lost, radius = 0.0, limit / k
    size = math.sqrt(ex * ex + ey * ey)
    if size > radius:  # the load has become less
        lost = 0.5 * k * (size * size - radius * radius)
        ex, ey = ex * radius / size, ey * radius / size
    bx, by = ex + dx, ey + dy
    size, a = math.sqrt(bx * bx + by * by), dx * dx + dy * dy
    if size <= radius or (a == 0.0 and radius > 0.0):  # one on the circle is beyond it by rounding
        return k * (ex + 0.5 * dx), k * (ey + 0.5 * dy), bx, by, lost, 0.5 * k, 0.5 * k
    if radius == 0.0:
        return 0.0, 0.0, 0.0, 0.0, lost, 0.0, 0.0
    b, c = ex * dx + ey * dy, max(radius * radius - ex * ex - ey * ey, 0.0)
    root = math.sqrt(b * b + a * c)
    t = min((c / (b + root) if b > 0.0 else (root - b) / a), 1.0)
    mx, my = (ex + t * dx) / radius + bx / size, (ey + t * dy) / radius + by / size
    norm = math.sqrt(mx * mx + my * my)
    mx, my = mx / norm, my / norm
    fx = t * k * (ex + 0.5 * t * dx) + (1.0 - t) * limit * mx
    fy = t * k * (ey + 0.5 * t * dy) + (1.0 - t) * limit * my
    lost += max((1.0 - t) * limit * (mx * dx + my * dy), 0.0)
    way = math.sqrt(a)
    ux, uy = dx / way, dy / way
    with_it = max(limit - fx * ux - fy * uy, 0.0) / way
    turning = min(limit / size, 0.5 * k)
    slope_x = min(with_it, 0.5 * k) * ux * ux + turning * uy * uy
    slope_y = min(with_it, 0.5 * k) * uy * uy + turning * ux * ux
    return fx, fy, bx * radius / size, by * radius / size, lost, slope_x, slope_y


@kernel(internal=True)
def _pushed(kind: LineBearings, i: int, u: float, h: float) -> tuple[float, float, float]:
    """Elastic and whole normal force of an end in a step, and its derivative by the rate u of its height."""
    end, q = kind.table[i], kind.state[i].value
    elastic, force, slope = pull(-q, -q - h * u, end.stiffness, end.damping, h)
    return elastic, force, h * slope


@kernel(inline=True, internal=True)
def _rate(kind: LineBearings, i: int, row: int, work: Workspace, system: RowArrays) -> float:
    """Rate of a row of an end at the velocity of the stage."""
    first = 2 * kind.table[i].block
    return rate_of_row(system, first, first + 2, row, work.velocity)


@implement(fill_rows, LineBearings)
@kernel(internal=True)
def fill_bearing_rows(kind: LineBearings, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Height over the plane, ways along it; drift of the carried heights."""
    for i in range(kind.table.shape[0]):
        end, state = kind.table[i], kind.state[i]
        q = travel_row(system, end.block, 0, work, end.deck, end.point, end.normal)
        x = travel_row(system, end.block, 1, work, end.deck, end.point, end.inward)
        travel_row(system, end.block, 2, work, end.deck, end.point, end.across)
        if with_residual:
            if state.fresh:
                state.value = q
            state.drift = q - state.value
            state.overlap = min(x, end.deck_length - x)
            found = residuals(system, end.block)
            found[0], found[1], found[2] = state.drift, 0.0, 0.0


@kernel(internal=True)
def _forces(
    kind: LineBearings, i: int, rates: tuple[float, float, float], h: float
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Forces of the rows of an end against their rates, and their derivatives."""
    end, state = kind.table[i], kind.state[i]
    u, v, w = rates
    _, push, slope = _pushed(kind, i, u, h)
    fx, fy, _, _, _, sx, sy = rub(state.along, state.across, h * v, h * w, end.stiffness, end.friction * push)
    return (-push, fx, fy), (slope, h * sx, h * sy)


@implement(set_targets, LineBearings)
@kernel(internal=True)
def set_bearing_targets(
    kind: LineBearings, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """First guess: the rates of the last step, of the height that to which the last two lead."""
    if not at_midpoint:
        return
    for i in range(kind.table.shape[0]):
        state = kind.state[i]
        ahead = state.rate + 2.0 * state.growth if state.paced else state.rate
        rates = ahead, state.along_rate, state.across_rate
        forces, slopes = _forces(kind, i, rates, step)
        for r in range(3):
            put_row_law(system, kind.table[i].block, r, step, rates[r], forces[r], slopes[r])
            state.last_rate[r], state.last_force[r] = rates[r], forces[r]
        state.rounds = 0


@kernel(inline=True, internal=True)
def _rates(kind: LineBearings, i: int, work: Workspace, system: RowArrays) -> tuple[float, float, float]:
    """Rates of all rows of an end."""
    return (
        _rate(kind, i, 0, work, system),
        _rate(kind, i, 1, work, system),
        _rate(kind, i, 2, work, system),
    )


@implement(relinearise, LineBearings)
@kernel(internal=True)
def relinearise_bearings(
    kind: LineBearings, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Fit pushes and friction to the rates found."""
    for i in range(kind.table.shape[0]):
        state, k = kind.state[i], kind.table[i].stiffness
        rates = _rates(kind, i, work, system)
        forces, slopes = _forces(kind, i, rates, step)
        block, limit = kind.table[i].block, -kind.table[i].friction * forces[0]
        rows = system.rows[block]
        state.rounds += 1
        steepest = 0.5 * step * k + kind.table[i].damping, 0.5 * step * k, 0.5 * step * k
        for r in range(3):
            u, force, slope = rates[r], forces[r], slopes[r]
            if state.rounds > PLAIN_ROUNDS and u != state.last_rate[r]:
                chord = (force - state.last_force[r]) / (u - state.last_rate[r])
                slope = max(slope, min(chord, steepest[r]))
            state.last_rate[r], state.last_force[r] = u, force
            miss = abs(rows.impulse[r] + 0.5 * step * force)
            if r > 0 and miss <= NEGLIGIBLE * 0.5 * step * limit:
                continue  # of both components of friction together
            off = abs(0.5 * step * slope - 1.0 / rows.softness[r]) * rows.scale[r]
            if r > 0 and slope > 0.0 and off <= KEPT and state.rounds <= PLAIN_ROUNDS:
                _fit_as_factored(system, block, r, step, u, force, work)
            else:
                fit_row_law(system, block, r, step, u, force, slope, work)


@kernel(internal=True)
def _fit_as_factored(
    system: RowArrays, block: int, r: int, h: float, u: float, force: float, work: Workspace
) -> None:
    """As `fit_row_law`, by the softness that is there."""
    rows = system.rows[block]
    softness, old = rows.softness[r], rows.target[r]
    if abs(rows.impulse[r] + 0.5 * h * force) <= FITTED * (0.5 * h * abs(force) + abs(u) / softness):
        return
    rows.target[r] = u - 0.5 * h * force * softness
    if abs(rows.target[r] - old) > FITTED * (abs(old) + abs(u)):
        work.control.changed += 1
        work.status.block = block


@implement(update_rows, LineBearings)
@kernel(internal=True)
def update_bearings(kind: LineBearings, time: float, step: float, work: Workspace, system: RowArrays) -> None:
    """Carry heights and displacements over the step; energy lost."""
    for i in range(kind.table.shape[0]):
        end, state = kind.table[i], kind.state[i]
        u, v, w = _rates(kind, i, work, system)
        elastic, force, _ = _pushed(kind, i, u, step)
        limit = end.friction * force
        _, _, ax, ay, lost, _, _ = rub(state.along, state.across, step * v, step * w, end.stiffness, limit)
        state.loss += step * (elastic - force) * u + lost
        slid_x, slid_y = step * v - (ax - state.along), step * w - (ay - state.across)
        if force > 0.0:
            state.slid += math.sqrt(slid_x * slid_x + slid_y * slid_y)
        state.along, state.across, state.along_rate, state.across_rate = ax, ay, v, w
        before = state.value
        state.value += step * u
        if before >= 0.0 and state.value >= 0.0 and state.value + state.drift >= 0.0:
            state.value += state.drift  # nothing pushes: it may be where it is
        elif state.drift > 0.0:
            state.value += RETURN * state.drift
        state.growth = step / (step + work.control.last_step) * (u - state.rate)
        state.rate, state.paced = u, not state.fresh
        state.fresh = False


@implement(watch_joints, LineBearings)
@kernel(internal=True)
def watch_bearings(kind: LineBearings, work: Workspace, system: RowArrays) -> None:
    """Forces at the end of the step; a line that leaves its deck ends the run."""
    for i in range(kind.table.shape[0]):
        end, state = kind.table[i], kind.state[i]
        check_drift(end.block, state.drift, end.largest_drift, work)
        if not state.overlap > 0.0:
            work.status.outcome = NOT_CLOSED
            work.status.block = end.block
        note_stored(state.store, _stored(kind, i))
        rate = 0.0
        if end.damping > 0.0:
            rate = _rate(kind, i, 0, work, system)
            if state.paced:
                rate = steady_rate(state.rate, state.growth, rate)
        state.load = _normal(kind, i, state.value, rate)
        if not end.left:
            note_value(kind.state[i - 1].extremes, work.control.interval, state.load + kind.state[i - 1].load)


@kernel(inline=True, internal=True)
def _normal(kind: LineBearings, i: int, q: float, rate: float) -> float:
    """Normal force of an end at a height and its rate [N]."""
    return max(-kind.table[i].stiffness * q - kind.table[i].damping * rate, 0.0) if q < 0.0 else 0.0


@kernel(inline=True, internal=True)
def _stored(kind: LineBearings, i: int) -> float:
    """Elastic energy of an end [J]."""
    state = kind.state[i]
    pressed = min(state.value, 0.0)
    moved = state.along * state.along + state.across * state.across
    return 0.5 * kind.table[i].stiffness * (pressed * pressed + moved)


@implement(record_joints, LineBearings)
@kernel(internal=True)
def record_bearings(
    kind: LineBearings, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Forces, gaps, slip; energies."""
    for i in range(kind.table.shape[0]):
        end, state = kind.table[i], kind.state[i]
        side = 0 if end.left else 1
        out = bearing_outputs(row, end.column)
        gap = travel(work, end.deck, end.point, end.normal)
        if state.fresh:
            state.load = _normal(kind, i, state.value, 0.0)
        elif state.paced:
            low = _normal(kind, i, gap, state.rate + abs(state.growth))
            high = _normal(kind, i, gap, state.rate - abs(state.growth))
            compare_force(state.agreement, time, state.load, low, high)
        work.sums.dissipated += state.loss
        work.sums.elastic += _stored(kind, i)
        work.sums.drift = max(work.sums.drift, abs(state.drift))
        if side == 0:
            out.force = out.friction[0] = out.friction[1] = 0.0
            out.overlap = state.overlap
        out.force += state.load
        out.force_at[side] = state.load
        out.friction[0] -= end.stiffness * state.along
        out.friction[1] -= end.stiffness * state.across
        out.lift_off[side] = gap
        out.overlap = min(out.overlap, state.overlap)
        out.slip_path[side] = state.slid
        if side == 1:
            extremes, interval = kind.state[i - 1].extremes, work.control.interval
            out.force_max = largest_of(extremes, interval, out.force)
            out.force_min = smallest_of(extremes, interval, out.force)
