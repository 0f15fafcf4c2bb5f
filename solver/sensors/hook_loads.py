"""Load of a hook: what the ropes that carry it pull it up with, less its own weight and inertia.

With the forces F_p of the ropes on a body of the mass m, and e against gravity g::

    rope_load = sum F_p . e        hook_load = rope_load - m (g + z'')        z = e . (centre of mass)

so it is what all else pulls the body down with: slings, an equalizer, a spreader. z'' is that of the path, which has no
velocities that ring (`heavylift.solver.ringing`). From the mean velocities u of steps of the lengths h, with a at the
time between two of them, the acceleration at the end is the line through the last two::

    a_k = (u_k - u_(k-1)) / ((h_k + h_(k-1)) / 2)        z'' = a_k + h_k (a_k - a_(k-1)) / h_(k-1)

but a_k alone where its slope changes its sign with every step, and in the second step behind a jump, which spreads over
two slopes. It is of second order where the motion is resolved. What is cut to less than `SHORTEST`
of the step before, as where a phase of an operation ends, is no step: height differences over it are rounding. It is
taken with the next one, and the acceleration stays.

It acts on nothing. The ropes leave their forces at the end of every step
(`heavylift.solver.force_elements.line_forces`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Ints1
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Least, NameOf
from heavylift.numerics.records import Record, Records, filled, records
from heavylift.numerics.records import Vector as VectorField
from heavylift.numerics.vectors import dot, vector
from heavylift.solver.extremes import Extremes
from heavylift.solver.force_elements.line_forces import LineForce
from heavylift.solver.force_elements.watched import WatchesRopes
from heavylift.solver.interface import (
    FORCES,
    Bodies,
    Workspace,
    add_forces,
    record_forces,
    watch_motions,
)
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at, zeros_of
from heavylift.solver.scene.bodies import Free
from heavylift.solver.scene.connections import MEASURES
from heavylift.solver.scene.outputs import (
    Outputs,
    channel,
    largest_of_all,
    nested,
    outputs,
    smallest_of_all,
)
from heavylift.solver.sensors.seen import extremes_of, note_seen, put_seen

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackingContext

__all__ = ["HookLoad", "HookLoadEntry", "HookLoads", "HookState", "pack"]

SHORTEST = 0.1
"""Part of the step before, below which a step is taken with the next one."""

JUMP, ALIKE = 0.1, 1.5
"""Of the slope of a step: that before it, below which it begins with a jump, and that behind it, which a smooth motion
that turns there has twice as large."""


@outputs
class HookSeen(Outputs):
    """What is seen of a hook."""

    hook_load: float = channel(
        "force",
        "what all but the ropes pulls the body down with, without its own weight; at t = 0 as if it stood",
    )
    rope_load: float = channel("force", "what the ropes pull the body up with, against gravity")


@outputs
class HookOutputs(Outputs):
    """What a hook records."""

    seen: HookSeen = nested(HookSeen)
    largest: HookSeen = largest_of_all(HookSeen)
    smallest: HookSeen = smallest_of_all(HookSeen)


@MEASURES.describe("hook_loads")
@dataclass(frozen=True, eq=False, kw_only=True)
class HookLoad(WatchesRopes):
    """What hangs on a rigid body that ropes carry: on a hook block on its falls."""

    CHANNELS: ClassVar = HookOutputs.CHANNELS
    """What it records, in the order of its columns."""

    STEPS: ClassVar = True

    body: Annotated[str, NameOf("body")]
    """Rigid body with a free frame: the hook block, or a spreader."""
    ropes: Annotated[tuple[str, ...], NameOf("ropes"), Least(1)]
    """Ropes that carry it, by names or patterns; what else is on the body hangs on it."""

    @property
    def watched_ropes(self) -> tuple[str, ...]:
        """The ropes."""
        return self.ropes


class HookLoadEntry(Record):
    """A hook.

    Attributes
    ----------
    first, count
        Its first place in `HookLoads.places`, and how many.
    centre
        Marker of its centre of mass.
    mass
        [kg].
    column
        First record column.
    """

    first: int
    count: int
    centre: int
    mass: float
    column: int


hook_outputs = outputs_at(HookOutputs)


class HookState(Record):
    """Motion of a centre of mass against gravity, as carried.

    Attributes
    ----------
    steps
        How many have been made, up to 2.
    height, speed
        At the end of the last step [m]; mean of the last step, at first that of the start [m/s].
    length
        Of the last step [s].
    waiting
        Length of what was too short to be a step [s].
    change, slope, slope_before
        Acceleration between the last two steps [m/s^2], its slope, and that of the step before [m/s^3].
    acceleration
        At the end of the last step [m/s^2].
    """

    steps: int
    height: float
    speed: float
    length: float
    waiting: float
    change: float
    slope: float
    slope_before: float
    acceleration: float


class HookLoads(Arrays):
    """All hooks of a scene.

    Attributes
    ----------
    table, state
        The hooks, and what they carry.
    places
        Numbers of the pulls on the bodies.
    pulls
        What ropes pull with, which they write.
    extremes
        Of what is seen of each.
    seen
        Of one of them; scratch.
    up
        Against gravity, shape (3,).
    gravity
        [m/s^2].
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state", "extremes")

    table: Records[HookLoadEntry]
    state: Records[HookState]
    places: Ints1
    pulls: Records[LineForce]
    extremes: Records[Extremes]
    seen: HookSeen
    up: Floats1
    gravity: float


def pack(hooks: Sequence[HookLoad], context: PackingContext) -> None:
    """Make the kind.

    Raises
    ------
    InputError
        Without gravity, of a body that is not rigid and free, or of a rope that is not on it.
    """
    watched = context.watched
    g = float(np.linalg.norm(watched.gravity))
    rows: list[HookLoadEntry] = []
    places: list[int] = []
    for hook in hooks:
        body = watched.bodies[hook.body]
        if g == 0.0:
            raise InputError("no weight without gravity", source=hook.name, key="body", expected="[gravity]")
        if body.DEFORMS or not isinstance(body.motion, Free):
            raise InputError(
                f"{hook.body!r} is no rigid body with a free frame",
                source=hook.name,
                key="body",
                expected="the body of a hook, which ropes carry",
            )
        first = len(places)
        for rope in hook.ropes:
            on_body = watched.places_on(rope, hook.body)
            if not on_body:
                raise InputError(
                    f"{rope!r} has no place on {hook.body!r}",
                    source=hook.name,
                    key="ropes",
                    expected="ropes that carry this body",
                )
            places += [watched.first[rope] + place for place in on_body]
        centre = context.point(hook.body, np.asarray(body.centre_of_mass, dtype=np.float64), FORCES)
        rows.append(
            filled(
                HookLoadEntry,
                first=first,
                count=len(places) - first,
                centre=centre,
                mass=body.mass,
                column=context.column(hook),
            )
        )
    kind = HookLoads(
        records(HookLoadEntry, rows),
        records(HookState, len(rows)),
        np.array(places, dtype=np.int64),
        watched.pulls,
        extremes_of(HookSeen, len(rows)),
        zeros_of(HookSeen),
        -watched.gravity / g,
        g,
    )
    context.add_forces(kind)


@implement(add_forces, HookLoads)
@kernel(internal=True)
def add_no_forces(kind: HookLoads, time: float, work: Workspace) -> None:
    """It only watches."""


@kernel(inline=True, internal=True)
def _upwards(kind: HookLoads, v: VectorField) -> float:
    """Component against gravity."""
    return dot((kind.up[0], kind.up[1], kind.up[2]), vector(v))


@kernel(internal=True)
def _look(kind: HookLoads, i: int, standing: bool) -> None:
    """Both loads at the end of the last step, or of a hook that stands."""
    entry, load = kind.table[i], 0.0
    for p in range(entry.first, entry.first + entry.count):
        load += _upwards(kind, kind.pulls[kind.places[p]].force)
    kind.seen.rope_load = load
    if standing:
        kind.seen.hook_load = max(0.0, load - entry.mass * kind.gravity)
    else:
        kind.seen.hook_load = load - entry.mass * (kind.gravity + kind.state[i].acceleration)


@kernel(internal=True)
def _follow(kind: HookLoads, i: int, height: float, h: float, next_step: float) -> None:
    """Acceleration at the end of a step of the length h [s] that ends at a height [m]; the next one is known, too."""
    state = kind.state[i]
    h += state.waiting
    if h < SHORTEST * (state.length if state.steps > 0 else next_step):
        state.waiting = h
        return
    state.waiting = 0.0
    speed = (height - state.height) / h
    if state.steps == 0:  # that of the start is one of an instant
        change = 2.0 * (speed - state.speed) / h
        state.acceleration = change
    else:
        change = (speed - state.speed) / (0.5 * (h + state.length))
        slope = (change - state.change) / (state.length if state.steps > 1 else 0.75 * state.length)
        turns = state.steps > 1 and slope * state.slope < 0.0
        # a jump is in two slopes on end, as steep as each other, and in none before
        jumped = abs(state.slope_before) < JUMP * abs(state.slope) and abs(slope) < ALIKE * abs(state.slope)
        jumped = jumped and state.steps > 1
        state.acceleration = change if turns or jumped else change + h * slope
        state.slope_before = state.slope if state.steps > 1 else slope
        state.slope = slope
    state.height, state.speed, state.length, state.change = height, speed, h, change
    state.steps = min(2, state.steps + 1)


@implement(watch_motions, HookLoads)
@kernel(internal=True)
def watch_hook_loads(kind: HookLoads, bodies: Bodies, work: Workspace) -> None:
    """Accelerations, and extremes at the ends of steps."""
    for i in range(kind.table.shape[0]):
        height = _upwards(kind, work.markers[kind.table[i].centre].point)
        _follow(kind, i, height, work.control.last_step, work.control.next_step)
        _look(kind, i, False)
        note_seen(kind.extremes, i, work.control.interval, kind.seen.words)


@implement(record_forces, HookLoads)
@kernel(internal=True)
def record_hook_loads(kind: HookLoads, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """Both loads, then the largest and smallest values of both."""
    interval = work.control.interval
    for i in range(kind.table.shape[0]):
        out, state = hook_outputs(row, kind.table[i].column), kind.state[i]
        if state.steps == 0 and time == 0.0:  # where it starts from
            centre = work.markers[kind.table[i].centre]
            state.height, state.speed = _upwards(kind, centre.point), _upwards(kind, centre.velocity)
        _look(kind, i, state.steps == 0)
        put_seen(
            kind.extremes, i, interval, kind.seen.words, out.seen.words, out.largest.words, out.smallest.words
        )
