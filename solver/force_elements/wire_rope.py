"""Wire ropes through any number of bodies, and spring ropes: one row each, tension never below zero.

"Integrated simulation ... (2018)", eqs. 181-185 and 219 for the path, eq. 230 for the spring rope. A rope has one
tension T along its path of length s. With its unstretched length l(t), which a winch changes, it stores
``U = EA/(2 l) max(0, s - l)^2``. In a step, with ``s1 = s0 + h G v`` and the stiffness k from the mean of 1/l,
T is the discrete gradient of U (see `law_forces`), so that the energy is exact through slack and taut, and the
winch does the work ``-T dl + EA/2 mean(max(0, e)^2) d(1/l)``.

The stretch is carried with the row, ``s += h G v``, not taken from the geometry again, which would feed
vibrations the step does not resolve; it is the geometry as long as the rope is slack, and goes back to a
shorter one slowly.

Integrators that evaluate forces at an instant take ropes as forces on the markers of their places, with the tension
of the path there: ``T = max(0, EA (s/l - 1) + c (s' - l'))`` while it is taut. Bodies book ``-T s'`` as work of outer
forces; it is taken from there and booked as what it is, ``(T - T_el) (s' - l')`` of the damper and
``-T l' + EA/2 e^2 d(1/l)/dt`` of the winch.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import AsDrawn, Least, Positive, Quantity
from heavylift.numerics.records import Record, Records, records
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
from heavylift.solver.force_elements.line_forces import LineForce
from heavylift.solver.force_elements.rope_path import START_WRAP, PlaceGradient, RopePlace, path_length
from heavylift.solver.force_elements.rows import (
    RETURN,
    check_drift,
    fit_law,
    put_law,
    put_residual,
    row_rate,
)
from heavylift.solver.interface import (
    Workspace,
    add_forces,
    fill_rows,
    hold_turns,
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
from heavylift.solver.scene.connections import (
    ROPES,
    AlongPath,
    ControlOutputs,
    RopeOutputs,
    RopeParts,
    RopePoint,
    SheaveParts,
    Winch,
    check_path,
    controlled,
    rubbing_places,
)

__all__ = [
    "LARGEST_STRAIN",
    "PlaceMarkers",
    "Rope",
    "RopeEntry",
    "RopeState",
    "Ropes",
    "SpringRope",
    "WinchRow",
    "compare_length",
    "compare_tension",
    "end_tension",
    "midpoint_rate",
    "midpoint_tension",
    "path_rate",
    "put_places",
    "put_rope",
    "record_ropes",
    "relinearise_ropes",
    "rope_outputs",
    "set_rope_targets",
    "show_pulls",
    "start_length",
    "stiffness_of",
    "table_state",
    "update_ropes",
    "watch_stretch",
    "winch_state",
]

AT_LENGTH = 1e-12
"""Relative elongation up to which a rope is at its length, and slack: rounding decides on no damper."""

LARGEST_STRAIN = 0.02
"""Strain of a wire rope at the start above which it is refused: steel ropes break near it."""


@ROPES.describe("wire")
@dataclass(frozen=True, eq=False, kw_only=True)
class Rope(AlongPath):
    """A wire rope through any number of points, with one tension all along but for sheaves with an efficiency."""

    CHANNELS: ClassVar = (
        *RopeOutputs.CHANNELS,
        *RopeParts.CHANNELS,
        *SheaveParts.CHANNELS,
        *ControlOutputs.CHANNELS,
    )
    """What it records, in the order of its columns."""

    name: str
    path: Annotated[tuple[RopePoint, ...], Least(2)]
    """Two and more places, from end to end."""
    axial_stiffness: Annotated[float, Positive("force")]
    """EA [N]: modulus times area."""
    length: Annotated[float | None, Positive("length")] = None
    """Unstretched length at the start [m]; the initial geometric length if absent."""
    tension: Annotated[float | None, Positive("force")] = None
    """In place of `length`: tension at the start [N], without that of the damper, from which that follows; of a search
    for equilibrium that in the place of rest."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """Tension per rate of elongation [N s/m], while it is taut."""
    winch: Winch | None = None
    """How its length changes."""
    other_winch: Winch | None = None
    """A second winch, at the end that `winch` leaves; both have `speeds`."""

    @staticmethod
    def check(spec: Any) -> None:
        """Its ends are no pulleys; one thing says how long it is."""
        told = {
            "length": spec.length is not None,
            "tension": spec.tension is not None,
            "winch.lengths": spec.winch is not None and len(spec.winch.lengths) > 0,
        }
        given = [key for key, is_told in told.items() if is_told]
        if len(given) > 1:
            raise InputError(
                f"both {given[0]!r} and {given[1]!r}", key=given[1], expected="one of them defines its length"
            )
        for place in (0, len(spec.path) - 1):
            if spec.path[place].radius > 0.0:
                raise InputError(
                    "a pulley at an end", key=f"path.{place}.radius", expected="ends without 'radius'"
                )
            for key, rubs in (
                ("efficiency", spec.path[place].efficiency < 1.0),
                ("friction", spec.path[place].friction > 0.0),
            ):
                if rubs:
                    raise InputError(
                        f"an {key} at an end" if key == "efficiency" else f"{key} at an end",
                        key=f"path.{place}.{key}",
                        expected=f"{key!r} of places between the ends, over which the rope runs",
                    )
        check_path(spec.path)
        _check_other_winch(spec)
        if controlled(spec) and rubbing_places(spec):
            raise InputError(
                "a winch controlled by the tension, on a rope over places with an efficiency",
                key="winch.brake" if spec.winch.brake is not None else "winch.tensions",
                expected="a winch by 'speeds' or 'lengths', or no 'efficiency'",
            )

    def check_start(self, places: Sequence[NDArray[np.float64]], *, at_rest: bool) -> None:
        """Refuse a rope that is much shorter than its path through some places in the world [m], or has none.

        In a scene that comes to rest before time starts, how short it is shows there.

        Raises
        ------
        InputError
            If it is.
        """
        # every place where the rope touches a pulley is within its radius of the centre, so the path is no shorter
        path = float(sum(np.linalg.norm(q - p) for p, q in pairwise(places)))
        path -= 2.0 * sum(stop.radius for stop in self.path)
        if self.length is None:
            if path <= 0.0 and not any(stop.radius for stop in self.path):
                raise InputError(
                    "all its points coincide", key="path", expected="a path with a length, or 'length'"
                )
        elif not at_rest and (strain := path / self.length - 1.0) > LARGEST_STRAIN:
            raise InputError(
                f"{self.length:.6g} m is shorter than the path of at least {path:.6g} m by "
                f"{path - self.length:.6g} m, a strain of {100.0 * strain:.3g} % at the start",
                key="length",
                expected=f"a length of at least {path / (1.0 + LARGEST_STRAIN):.6g} m, none for the initial length, or"
                " start 'equilibrium', which finds where it hangs",
            )


@ROPES.describe("spring")
@dataclass(frozen=True, eq=False, kw_only=True)
class SpringRope(AlongPath):
    """A rope between two points that pulls like a spring and never pushes."""

    CHANNELS: ClassVar = (*RopeOutputs.CHANNELS, *RopeParts.CHANNELS)
    """What it records, in the order of its columns; it has one segment."""

    name: str
    path: tuple[RopePoint, RopePoint]
    """Its two ends."""
    stiffness: Annotated[float, Positive("stiffness")]
    """[N/m]."""
    length: Annotated[float, Quantity("length", minimum=0.0, closed=True), AsDrawn()]
    """Unloaded length [m]; the initial geometric length if absent."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """[N s/m], while it is taut."""

    @staticmethod
    def check(spec: Any) -> None:
        """It has no pulleys."""
        for place, stop in enumerate(spec.path):
            if stop.radius > 0.0:
                raise InputError(
                    "a pulley in a rope of type 'spring'", key=f"path.{place}.radius", expected="type 'wire'"
                )
            if stop.efficiency < 1.0:
                raise InputError(
                    "an efficiency in a rope of type 'spring'",
                    key=f"path.{place}.efficiency",
                    expected="type 'wire'",
                )
        check_path(spec.path)


def _check_other_winch(spec: Any) -> None:
    """Two winches are at two ends, and each says by itself how fast it hauls in."""
    if spec.other_winch is None:
        return
    if spec.winch is None:
        raise InputError(
            "'other_winch' without 'winch'", key="other_winch", expected="'winch' of a single one"
        )
    if spec.winch.end == "both":
        raise InputError(
            "a second winch beside drums at both ends", key="winch.end", expected="end = 'first' or 'last'"
        )
    for key, winch in (("winch", spec.winch), ("other_winch", spec.other_winch)):
        for told in ("lengths", "tensions", "follow", "brake"):
            value = getattr(winch, told)
            if value is not None and (isinstance(value, str | float) or len(value)):
                raise InputError(f"{told!r} of one of two winches", key=f"{key}.{told}", expected="'speeds'")
    if spec.other_winch.end != "first":
        raise InputError(
            f"end = {spec.other_winch.end!r}",
            key="other_winch.end",
            expected="none: it is at the end that 'winch' leaves",
        )


class RopeEntry(Record):
    """A rope.

    Attributes
    ----------
    block
        Number of its first block of rows, -1 if it is a force.
    attachments
        How many sides of blocks it has.
    first, places
        Its first place, and how many.
    winch, winch_rows
        First row of its winch, of two of both together, and how many.
    column, parts
        Of its `RopeOutputs`, and of its segments.
    shown
        Place in `Ropes.pulls` of its first place, -1 if nothing watches what it pulls with.
    axial_stiffness
        EA of a wire rope [N], or 0.
    stiffness
        Of a spring rope [N/m], or 0.
    damping
        [N s/m].
    start_length
        Unstretched length at the start [m].
    wanted
        Tension at the start [N]; 0 if none is given.
    largest_drift
        Of the carried stretch from the path, beyond which a run ends [m].
    """

    block: int
    attachments: int
    first: int
    places: int
    winch: int
    winch_rows: int
    column: int
    parts: RopeParts
    shown: int
    axial_stiffness: float
    stiffness: float
    damping: float
    start_length: float
    wanted: float
    largest_drift: float


rope_outputs = outputs_at(RopeOutputs)


class PlaceMarkers(Record):
    """Marker of a place, marker of its axis or -1, attachment or -1 on the ground."""

    marker: int
    axis: int
    attachment: int


class WinchRow(Record):
    """Time [s], speed [m/s], length hauled in since t = 0 [m], and jerk up to the next row [m/s3]."""

    time: float
    speed: float
    hauled: float
    jerk: float


class RopeState(Record):
    """What a rope carries.

    Attributes
    ----------
    fresh
        Whether no step has been made yet.
    paced
        Whether two have been made, so that `growth` is known.
    stretched
        Path length as carried [m].
    rest
        Unstretched length [m].
    rate, growth
        Of the path in the last step [m/s], and half its difference from that of the step before.
    drift
        Geometry less carried length [m].
    winch_work, loss
        Work of the winch, and what the damper took [J].
    next_rest, hauling
        Unstretched length [m] and speed of the winch [m/s] at the end of the step.
    tension
        At the end of the last step [N].
    extremes
        Of the tension.
    agreement
        Of the recorded tension with the elongation of the path.
    store
        Its elastic energy from step to step.
    """

    fresh: bool
    paced: bool
    stretched: float
    rest: float
    rate: float
    growth: float
    drift: float
    winch_work: float
    loss: float
    next_rest: float
    hauling: float
    tension: float
    extremes: Extremes
    agreement: Agreement
    store: Store


class Ropes(Arrays):
    """All ropes of a scene.

    Attributes
    ----------
    table
        The ropes.
    places
        Markers of the places of all ropes.
    winches
        Rows of all winches.
    path
        Places as `path_length` takes them.
    gradient
        Derivatives of the length by them.
    state
        What the ropes carry.
    wraps, held
        Wrap of the rope about each place [rad], shape (m,); that of the last state that stands, see `hold_turns`.
    pulls
        What ropes that are watched pull with, shared by all kinds of ropes and by what watches them.
    """

    carried_fields: ClassVar[tuple[str, ...]] = (
        "state",
        "wraps",
        "held",
    )
    COMMANDED: ClassVar[bool] = True
    """Whether a scenario may command their winches, connect and release them."""

    table: Records[RopeEntry]
    places: Records[PlaceMarkers]
    winches: Records[WinchRow]
    path: Records[RopePlace]
    gradient: Records[PlaceGradient]
    state: Records[RopeState]
    wraps: Floats1
    held: Floats1
    pulls: Records[LineForce]

    @property
    def given(self) -> NDArray[np.int64]:
        """Numbers of the ropes whose tension at the start is given."""
        return np.flatnonzero(self.table["wanted"] > 0.0)

    def tension_at_rest(self, rope: int) -> tuple[float, float]:
        """Of the path of the last evaluation [N], and minus its derivative by the unstretched length [N/m]."""
        entry = self.table[rope]
        path = start_length(self.path[entry.first : entry.first + entry.places])
        length, stiffness = entry.start_length, entry.axial_stiffness
        return max(0.0, stiffness * (path / length - 1.0)), stiffness * path / length**2

    def one_sided(
        self,
    ) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Block, sense, elongation and stiffness of what pulls only, at rest: see `solver.statics.forces.OneSided`."""
        rows = np.flatnonzero(self.table["block"] >= 0)
        table, rest = self.table[rows], self.state["rest"][rows]
        stiffness = np.where(table["stiffness"] > 0.0, table["stiffness"], table["axial_stiffness"] / rest)
        return table["block"], np.ones(len(rows)), self.state["stretched"][rows] - rest, stiffness

    def put_length(self, rope: int, length: float) -> None:
        """Give a rope another unstretched length [m] before time starts."""
        self.table[rope].start_length = self.state[rope].rest = length


def start_length(path: Records[RopePlace]) -> float:
    """Length of a path in the world [m]."""
    return float(path_length(path, records(PlaceGradient, len(path)), np.full(len(path), START_WRAP)))


@kernel(internal=True)
def table_state(rows: Records[WinchRow], first: int, count: int, time: float) -> tuple[float, float]:
    """Length hauled in since t = 0 [m] and speed [m/s] by some rows; exact for speeds that are linear or quadratic."""
    low, high = first - 1, first + count
    while high - low > 1:
        middle = (low + high) // 2
        if rows[middle].time <= time:
            low = middle
        else:
            high = middle
    if low < first or high == first + count:  # held at its ends
        end = rows[max(low, first)]
        return end.hauled + end.speed * (time - end.time), end.speed
    a, b = rows[low], rows[high]
    t = time - a.time
    slope = (b.speed - a.speed) / (b.time - a.time)
    if a.jerk != 0.0:
        slope -= 0.5 * a.jerk * (b.time - a.time)
        speed = a.speed + t * (slope + 0.5 * a.jerk * t)
        return a.hauled + t * (a.speed + t * (0.5 * slope + a.jerk * t / 6.0)), speed
    return a.hauled + t * (a.speed + 0.5 * slope * t), a.speed + slope * t


@kernel(inline=True, internal=True)
def winch_state(kind: Ropes, i: int, time: float) -> tuple[float, float]:
    """Length that the winches of a rope have hauled in since t = 0 [m], and their speed [m/s]."""
    if kind.table[i].winch_rows == 0:
        return 0.0, 0.0
    return table_state(kind.winches, kind.table[i].winch, kind.table[i].winch_rows, time)


@kernel(inline=True, internal=True)
def _length_in_play(kind: Ropes, i: int, hauled: float) -> float:
    """Unstretched length that is not hauled in [m]; not a number once there is none."""
    length = kind.table[i].start_length - hauled
    return length if length > 0.0 or kind.table[i].stiffness > 0.0 else math.nan


@kernel(inline=True, internal=True)
def stiffness_of(kind: Ropes, i: int, inverse_length: float) -> float:
    """Force per elongation [N/m]."""
    k = kind.table[i].stiffness
    return k if k > 0.0 else kind.table[i].axial_stiffness * inverse_length


@kernel(inline=True, internal=True)
def put_places(kind: Ropes, i: int, work: Workspace) -> None:
    """Places of the path from the markers."""
    first = kind.table[i].first
    last = first + kind.table[i].places
    for p in range(first, last):
        marker, axis = kind.places[p].marker, kind.places[p].axis
        for k in range(3):
            kind.path[p].centre[k] = work.markers[marker].point[k]
            if axis >= 0:
                kind.path[p].axis[k] = work.markers[axis].point[k]


@kernel(internal=True)
def _find_path(kind: Ropes, i: int, work: Workspace) -> float:
    """Length of the path from the markers [m]; its derivatives and wraps are kept."""
    put_places(kind, i, work)
    first = kind.table[i].first
    last = first + kind.table[i].places
    return path_length(kind.path[first:last], kind.gradient[first:last], kind.wraps[first:last])


@kernel(internal=True)
def compare_length(kind: Ropes, i: int, length: float) -> None:
    """Take the geometry while the rope is slack and before the first step; measure the drift."""
    state = kind.state[i]
    if state.fresh:
        state.stretched = length
    elif state.stretched <= state.rest:
        state.stretched = min(length, state.rest)  # a drift must not make tension
    state.drift = length - state.stretched


@implement(fill_rows, Ropes)
@kernel(internal=True)
def fill_rope_rows(kind: Ropes, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """``dl/dc . J + dl/dn . J_n`` of every place on the side of its body."""
    lanes = system.lanes
    for i in range(kind.table.shape[0]):
        block, count, first = kind.table[i].block, kind.table[i].attachments, kind.table[i].first
        if block < 0:
            continue
        length = _find_path(kind, i, work)
        for side in range(2 * block, 2 * block + count):
            panel = system.attachments[side].panel
            for k in range(system.attachments[side].width):
                system.panels[panel + k * lanes] = 0.0
        for p in range(first, first + kind.table[i].places):
            marker, axis, side = kind.places[p].marker, kind.places[p].axis, kind.places[p].attachment
            if side < 0:
                continue
            g = kind.gradient[p]
            add_direction_row(system, side, 0, work, marker, (g.centre[0], g.centre[1], g.centre[2]))
            if axis >= 0:
                add_direction_row(system, side, 0, work, axis, (g.axis[0], g.axis[1], g.axis[2]))
        if with_residual:
            compare_length(kind, i, length)
            put_residual(system, block, length - kind.state[i].rest)


@kernel(internal=True)
def midpoint_tension(kind: Ropes, i: int, u: float, h: float) -> tuple[float, float, float, float, float]:
    """Elastic tension, tension, its derivative by the rate u; elongations before and after."""
    l0, l1 = kind.state[i].rest, kind.state[i].next_rest
    k = stiffness_of(kind, i, 0.5 / l0 + 0.5 / l1)
    e0 = kind.state[i].stretched - l0
    e1 = e0 - (l1 - l0) + h * u  # in this order: the last term alone changes in the iteration
    elastic, tension, slope = pull(e0, e1, k, kind.table[i].damping, h)
    return elastic, tension, h * slope, e0, e1


@implement(set_targets, Ropes)
@kernel(internal=True)
def set_rope_targets(
    kind: Ropes, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """First guess: the rate of the last step."""
    if not at_midpoint:
        return
    for i in range(kind.table.shape[0]):
        if kind.table[i].block < 0:
            continue
        state = kind.state[i]
        u = state.rate
        hauled, state.hauling = winch_state(kind, i, time + step)
        state.next_rest = _length_in_play(kind, i, hauled)
        _, tension, slope, _, _ = midpoint_tension(kind, i, u, step)
        put_law(system, kind.table[i].block, step, u, tension, slope)


@kernel(inline=True, internal=True)
def midpoint_rate(kind: Ropes, i: int, work: Workspace, system: RowArrays) -> float:
    """Rate of the path in the middle of the step [m/s]."""
    first = 2 * kind.table[i].block
    return row_rate(system, first, first + kind.table[i].attachments, work.velocity)


@implement(relinearise, Ropes)
@kernel(internal=True)
def relinearise_ropes(kind: Ropes, time: float, step: float, work: Workspace, system: RowArrays) -> None:
    """Fit the tensions to the rates found."""
    for i in range(kind.table.shape[0]):
        if kind.table[i].block < 0:
            continue
        u = midpoint_rate(kind, i, work, system)
        _, tension, slope, _, _ = midpoint_tension(kind, i, u, step)
        fit_law(system, kind.table[i].block, step, u, tension, slope, work)


@implement(update_rows, Ropes)
@kernel(internal=True)
def update_ropes(kind: Ropes, time: float, step: float, work: Workspace, system: RowArrays) -> None:
    """Carry the stretch over the step; works of winch and damper."""
    for i in range(kind.table.shape[0]):
        state = kind.state[i]
        u = midpoint_rate(kind, i, work, system)
        elastic, tension, _, e0, e1 = midpoint_tension(kind, i, u, step)
        l0, l1 = state.rest, state.next_rest
        if l1 != l0:
            squares = max(0.0, e0) ** 2 + max(0.0, e1) ** 2
            state.winch_work -= tension * (l1 - l0)
            if kind.table[i].stiffness == 0.0:
                state.winch_work += 0.25 * kind.table[i].axial_stiffness * squares * (1.0 / l1 - 1.0 / l0)
        state.loss += (tension - elastic) * (e1 - e0)
        state.stretched += step * u + RETURN * min(0.0, state.drift)
        state.rest = l1
        state.growth = step / (step + work.control.last_step) * (u - state.rate)
        state.rate, state.paced = u, not state.fresh
        state.fresh = False


@kernel(internal=True)
def path_rate(kind: Ropes, i: int, work: Workspace) -> float:
    """Rate of the path from the rates of the markers [m/s]."""
    rate = 0.0
    first = kind.table[i].first
    for p in range(first, first + kind.table[i].places):
        marker, axis = kind.places[p].marker, kind.places[p].axis
        for k in range(3):
            rate += kind.gradient[p].centre[k] * work.markers[marker].velocity[k]
            if axis >= 0:
                rate += kind.gradient[p].axis[k] * work.markers[axis].velocity[k]
    return rate


@kernel(internal=True)
def end_tension(kind: Ropes, i: int, hauling: float, rate: float) -> float:
    """Tension at the end of a step [N] that hauls in at a speed, where the path grows at a rate [m/s]."""
    state = kind.state[i]
    e = state.stretched - state.rest
    if e <= 0.0:
        return 0.0
    tension = stiffness_of(kind, i, 1.0 / state.rest) * e
    if kind.table[i].damping > 0.0:
        stretching = steady_rate(state.rate, state.growth, rate) if state.paced else rate
        tension = max(0.0, tension + kind.table[i].damping * (stretching + hauling))
    return tension


@kernel(internal=True)
def _tension_now(
    kind: Ropes, i: int, time: float, work: Workspace
) -> tuple[float, float, float, float, float]:
    """Of a rope that is a force: elastic tension and tension [N], rate of its path, speed of its winch, length."""
    length, rate = _find_path(kind, i, work), path_rate(kind, i, work)
    hauled, hauling = winch_state(kind, i, time)
    rest = _length_in_play(kind, i, hauled)
    elastic = tension = 0.0
    if not length <= rest * (1.0 + AT_LENGTH):  # a length that is no number stops the run
        elastic = stiffness_of(kind, i, 1.0 / rest) * (length - rest)
        tension = max(0.0, elastic + kind.table[i].damping * (rate + hauling))
    kind.state[i].rest = rest
    return elastic, tension, rate, hauling, length


@implement(add_forces, Ropes)
@kernel(internal=True)
def add_ropes(kind: Ropes, time: float, work: Workspace) -> None:
    """Tensions on the markers; their power, which bodies count as that of outer forces, as that of winch and damper."""
    for i in range(kind.table.shape[0]):
        elastic, tension, rate, hauling, length = _tension_now(kind, i, time, work)
        if tension == 0.0 and elastic == 0.0:
            continue
        first = kind.table[i].first
        for p in range(first, first + kind.table[i].places):
            marker, axis = kind.places[p].marker, kind.places[p].axis
            for k in range(3):
                work.markers[marker].force[k] -= tension * kind.gradient[p].centre[k]
                if axis >= 0:
                    work.markers[axis].force[k] -= tension * kind.gradient[p].axis[k]
        rest = kind.state[i].rest
        work.sums.external_work += tension * rate
        work.sums.dissipated += (tension - elastic) * (rate + hauling)
        work.sums.drive_work += tension * hauling
        if kind.table[i].stiffness == 0.0:
            e = length - rest
            work.sums.drive_work += 0.5 * kind.table[i].axial_stiffness * (e / rest) ** 2 * hauling


@implement(hold_turns, Ropes)
@kernel(internal=True)
def hold_wraps(kind: Ropes, back: bool) -> None:
    """Wraps, which are those nearest to the ones before."""
    for i in range(kind.wraps.shape[0]):
        if back:
            kind.wraps[i] = kind.held[i]
        else:
            kind.held[i] = kind.wraps[i]


@kernel(internal=True)
def watch_stretch(kind: Ropes, i: int, work: Workspace) -> None:
    """What a rope stores at the end of the step; whether its path has left the stretch that it carries."""
    state = kind.state[i]
    e = max(0.0, state.stretched - state.rest)
    note_stored(state.store, 0.5 * stiffness_of(kind, i, 1.0 / state.rest) * e * e)
    check_drift(kind.table[i].block, state.drift, kind.table[i].largest_drift, work)


@kernel(internal=True)
def show_pulls(kind: Ropes, i: int, tension: float) -> None:
    """What a rope of one tension pulls its places with, by the last derivatives of its path."""
    shown, first, count = kind.table[i].shown, kind.table[i].first, kind.table[i].places
    if shown < 0:
        return
    for p in range(count):
        out, by_centre = kind.pulls[shown + p], kind.gradient[first + p].centre
        out.tension = tension if p < count - 1 else 0.0
        for k in range(3):
            out.force[k] = -tension * by_centre[k]


@implement(watch_joints, Ropes)
@kernel(internal=True)
def watch_ropes(kind: Ropes, work: Workspace, system: RowArrays) -> None:
    """Tensions at the end of the step; paths that have left what is carried end the run."""
    for i in range(kind.table.shape[0]):
        state = kind.state[i]
        if kind.table[i].block < 0:
            continue
        rate = midpoint_rate(kind, i, work, system) if kind.table[i].damping > 0.0 else 0.0
        state.tension = end_tension(kind, i, state.hauling, rate)
        note_value(state.extremes, work.control.interval, state.tension)
        show_pulls(kind, i, state.tension)
        watch_stretch(kind, i, work)


@kernel(internal=True)
def compare_tension(kind: Ropes, i: int, time: float, length: float, tension: float) -> None:
    """A tension is that of the elongation of the path and, of the damper, of the mean rates of the last two steps."""
    state = kind.state[i]
    e = length - state.rest
    low = high = 0.0
    if e > 0.0:
        elastic = stiffness_of(kind, i, 1.0 / state.rest) * e
        damper, change = state.rate + state.hauling, abs(state.growth)
        low = max(0.0, elastic + kind.table[i].damping * (damper - change))
        high = max(0.0, elastic + kind.table[i].damping * (damper + change))
    compare_force(state.agreement, time, tension, low, high)


@kernel(internal=True)
def put_rope(out: RopeOutputs, kind: Ropes, i: int, interval: int, tension: float, length: float) -> None:
    """What all ropes record, with the tension and the length of the path of the record."""
    state = kind.state[i]
    taut = state.stretched > state.rest > 0.0 and stiffness_of(kind, i, 1.0 / state.rest) > 0.0
    out.tension = tension
    out.length = length
    out.rest_length = state.rest
    out.drift = state.drift
    out.strain = (state.stretched - state.rest) / state.rest if taut else 0.0
    out.tension_max = largest_of(state.extremes, interval, tension)
    out.tension_min = smallest_of(state.extremes, interval, tension)


@implement(record_joints, Ropes)
@kernel(internal=True)
def record_ropes(
    kind: Ropes, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Tension, length of the path, unstretched length, drift, extremes, tension of each straight part."""
    for i in range(kind.table.shape[0]):
        entry, state = kind.table[i], kind.state[i]
        if entry.block < 0:
            _, tension, _, _, length = _tension_now(kind, i, time, work)
            state.stretched = length
        else:
            length, tension = _find_path(kind, i, work), state.tension
            compare_length(kind, i, length)
            if state.fresh:
                tension = end_tension(kind, i, winch_state(kind, i, time)[1], path_rate(kind, i, work))
            elif state.paced:
                compare_tension(kind, i, time, length, tension)
            work.sums.drift = max(work.sums.drift, abs(state.drift))
        e = max(0.0, state.stretched - state.rest)
        work.sums.elastic += 0.5 * stiffness_of(kind, i, 1.0 / state.rest) * e * e
        put_rope(rope_outputs(row, entry.column), kind, i, work.control.interval, tension, length)
        segments = part(row, entry.parts.segment_tension)
        for k in range(segments.shape[0]):
            segments[k] = tension
        show_pulls(kind, i, tension)
        work.sums.drive_work += state.winch_work
        work.sums.dissipated += state.loss
