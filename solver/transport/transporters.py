"""Transporters: a body on bogies without mass, whose cylinders share their oil in groups; one row a group.

Bogie i of a group of n has the stroke s_i, the tyre of stiffness k carries its load f_i, and r_i is how high the road
lifts its wheel over its place under the body, from the start on, with the tyre as it is pressed then::

    f_i = k (r_i - s_i) >= 0 ,     s_low <= s_i <= s_high ,     p = F(sum s_i + l) >= 0

with the common force p of the cylinders and the oil l that is pumped in. A cylinder between its stops carries
``f_i = p + c s_i'``, c of its pipe; a tyre may have a damper too. For given p every stroke follows, falling with p, and
so does p itself: one monotone equation with one unknown a group, ``F(sum s_i(p) + l) = p``, which a Newton iteration
within brackets solves.
In a step in which r grows evenly and p is its mean, a damped stroke is an exponential of the relaxation time ``c/k``;
its mean and its end are exact, so pipes are stable at any step. Without pipes the strokes follow at once.

The load acts on the body and on the deck along the normal of the deck; what a slope takes along the road the drives of
the wheels give on the spot, as ``f r'`` into the work of drives. Loads of a group differ at stops, above the road and
by pipes. So the row of a group is ``sum w_i r_i'`` with the shares ``w_i = f_i n / sum f`` of the prediction, its law
is that of the mean load, and a deviation of the row from its prediction is shared by all bogies of the group. The sum
of r is carried over the step as an elongation of a rope is: where all loads are equal, of oil that is linear, the force
is the discrete gradient of the stored energy ``p^2 / 2 kappa + sum f^2 / 2 k`` and no step gains any.

Levelling looks at roll a and pitch b of the vehicle every now and then and lifts group k, whose middle is at (x_k, y_k)
from that of all, with the speed ``s (b x_k - a y_k) / T`` until it looks again; s <= 1 keeps all of them within what
their pumps can do. Where errors are within the dead angle they count as none.

Pipes and rubber so answer to what the bogies of a group do apart from each other by its prediction alone. A body with
modes moves apart in ways that no step resolves, which this would drive: where such a body has dampers, every bogie has
a row of its own, and the group only their common force.

A wheel is on the uppermost of several decks. Where that changes from one body to another one, as at the end of a link
beam, its load goes over little by little while it rolls on: in truth both decks carry it as long as the one gives way
and comes back. The force and the row then are a mean of both decks; what the wheel rises beside what this mean does is
the work of the road, so energies balance whatever the shares are.

The weight of bogies stands on the road, their inertia is left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import field
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints2
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.numerics.quantity import Absent, BodyDirection, Least, NameOf, Positive, Quantity, Shape
from heavylift.numerics.records import Record, Records
from heavylift.solver.extremes import Extremes, largest_of, note_value, smallest_of
from heavylift.solver.force_elements.rows import RETURN, fit_row_law, put_row_law, rate_of_row
from heavylift.solver.interface import (
    Workspace,
    fill_rows,
    record_joints,
    relinearise,
    set_targets,
    update_rows,
    watch_joints,
)
from heavylift.solver.joints.row_writing import (
    Vector,
    add_direction_row,
    dot,
    minus,
    rate,
    vector,
)
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at, part
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.connections import ForceElement
from heavylift.solver.scene.descriptions import forward
from heavylift.solver.scene.drawn import At, Element, Offset, Wheel
from heavylift.solver.scene.transport import (
    TRANSPORT,
    BogieGroup,
    BogieParts,
    Drive,
    DriveOutputs,
    Levelling,
    LevellingParts,
    PathLeg,
    PathOutputs,
    SteeringParts,
    TransporterOutputs,
    TyreParts,
    Tyres,
)
from heavylift.solver.transport.decks import NO_ROAD, STEEPEST, dilated_height, grid_height
from heavylift.solver.transport.lever_arms import PlaceData, add_place_row, place, place_rate

__all__ = [
    "GROUPS_A_BLOCK",
    "JOLT",
    "TIPPED",
    "WALL",
    "BogieData",
    "BogieState",
    "DeckData",
    "GroupData",
    "GroupState",
    "PumpRow",
    "Transporter",
    "Transporters",
    "VehicleData",
    "VehicleState",
]

OFF_ROAD = int(Outcome.OFF_ROAD)
STEP_TOO_LARGE = int(Outcome.STEP_TOO_LARGE)
LEFT, WALL, JOLT, TIPPED = 1, 2, 3, 4
"""Why a wheel stopped the run: there is no road below it, a step that it cannot meet, or one that throws it up; or its
vehicle lies on its side."""

UPRIGHT = 0.5
"""Cosine of the angle between vehicle and deck below which it has tipped over: no wheel stands on the road there."""

LARGEST_JOLT = 10.0
"""Load of a wheel in the mean of a step, beyond that before, over that at rest: what is thrown up by more within a step
is thrown anywhere, since how it meets the road is not seen."""

HANDOVER_WAY, HANDOVER_TIME = 0.05, 0.5
"""Way over the radius of a wheel, or time [s] if that is over sooner, in which a load goes over to another body."""

GAS_EXPONENT = 1.4
"""Of the gas of an accumulator, adiabatic."""

GROUPS_A_BLOCK = 4
"""Rows of groups of one vehicle in a block of the system: they are on the same bodies."""

ROUNDS = 100
"""Of the iteration for a pressure; brackets halve, so it ends before."""

PLAIN_ROUNDS = 5
"""Rounds of the iteration of the rows after which a law is fitted by chords too: tangents alone can go to and fro."""

ROUNDED = 1e-6
"""Of a load, below which its change is rounding."""

NEGLIGIBLE = 4e-15
"""Relative change of a pressure that ends its iteration: what the sum over a group is rounded by."""

INCLINE_WAY = 1e-3
"""To both sides, within which the slope under a wheel is taken [m]; farther if it rolls farther in a step."""


@TRANSPORT.describe("transporters")
@dataclass(frozen=True, eq=False, kw_only=True)
class Transporter(ForceElement):
    """A body that rolls over all decks, on wheels whose hydraulic cylinders share their oil in groups."""

    CHANNELS: ClassVar = (
        *TransporterOutputs.CHANNELS,
        *BogieParts.CHANNELS,
        *PathOutputs.CHANNELS,
        *SteeringParts.CHANNELS,
        *DriveOutputs.CHANNELS,
        *TyreParts.CHANNELS,
        *LevellingParts.CHANNELS,
    )
    """What it records, in the order of its columns."""

    name: str
    body: Annotated[str, NameOf("body")]
    """Body that rides on it: load and platform in one, or a platform to which fixed joints hold the load."""
    groups: Annotated[tuple[BogieGroup, ...], Least(1)]
    """Bogies, by the groups that share their oil."""
    direction: Annotated[NDArray[np.float64], BodyDirection()] = field(default_factory=forward)
    """Forward direction in the axes of the body: roll is about it, pitch about the direction across it."""
    wheel_radius: Annotated[float, Quantity("length", minimum=0.0, maximum=5.0, closed=True)]
    """[m]; 0 of a point that follows the road."""
    tyre_stiffness: Annotated[float, Positive("stiffness")]
    """Of all tyres of a bogie [N/m]."""
    tyre_damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """Of all tyres of a bogie [N s/m]."""
    line_damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """Force of a cylinder by the rate of its own stroke, of its pipe [N s/m]."""
    stroke_limits: Annotated[NDArray[np.float64] | None, Quantity("length"), Shape((2,))] = None
    """Lowest and highest stroke from that of the start [m]; there only the tyre deflects. None if absent."""
    bogie_mass: Annotated[float, Quantity("mass", minimum=0.0, closed=True)] = 0.0
    """Of a bogie [kg]: adds to the load on the road, not to the inertia. Only if all decks are of the ground: on others
    it belongs to the body that rides."""
    load_limit: Annotated[float, Positive("force"), Absent()] = np.inf
    """Largest load of a bogie at the start, on the road [N]."""
    travel_speed: Annotated[float | None, Quantity("velocity")] = None
    """The wheels travel along all decks at this speed from their places at the start on, wherever the body is [m/s]; if
    absent they are where the body takes them."""
    legs: tuple[PathLeg, ...] = ()
    """Legs of a path along which it is driven from its place at the start on, one after the other: its position and
    heading in the plane. On decks of several bodies it moves with them, by their shares in its load."""
    handover: Annotated[float, Positive("time")] = 5.0
    """Delay with which its path follows the shares of moving bodies in its load [s]."""
    steering_limit: Annotated[float, Quantity("angle", minimum=0.0, maximum=np.pi, closed=True)] = (
        2.268928027592628
    )
    """Largest steering angle of a bogie to both sides [rad]."""
    drive: Drive | None = None
    """Motors and brakes; with a path."""
    tyres: Tyres | None = None
    """With a path and a drive: side slip of its tyres. They hold the vehicle, which then leaves the path as far as they
    slip; absent, it follows its path whatever it takes."""
    levelling: Levelling | None = None
    """What keeps it level; it stays as it is pumped if absent."""
    accept_unstable: bool = False
    """Run although the groups cannot hold the body upright: fewer than three, three in a line, or too soft."""

    def packed_by(self, integrator: str) -> str:
        """All transporters and decks of a scene are packed together."""
        del integrator
        return "heavylift.solver.transport.packing"

    def drawn(self) -> Iterable[Element]:
        """Its wheels, as far up as the road has pushed them; none of points that follow the road."""
        if not self.wheel_radius > 0.0:
            return
        along = np.asarray(self.direction, dtype=np.float64)
        upwards = np.array([0.0, 0.0, 1.0]) - along[2] * along / float(along @ along)
        upwards /= np.linalg.norm(upwards)
        axle = np.cross(upwards, along)
        for number, bogie in enumerate(np.vstack([group.bogies for group in self.groups])):
            yield Wheel(
                name=self.name,
                role="wheel",
                at=At(self.body, bogie + self.wheel_radius * upwards),
                axis=axle / np.linalg.norm(axle),
                radius=self.wheel_radius,
                width=0.6 * self.wheel_radius,
                offset=Offset(f"{self.name}.stroke_of", number, upwards),
            )

    @staticmethod
    def check(spec: Any) -> None:
        """Strokes have a range; what drives it."""
        if spec.stroke_limits is not None:
            low, high = spec.stroke_limits
            if not low < 0.0 < high:
                raise InputError(
                    f"from {low:g} to {high:g} m", key="stroke_limits", expected="one below 0, one above"
                )
        if spec.legs and spec.travel_speed is not None:
            raise InputError("'travel_speed' with 'legs'", key="travel_speed", expected="one of them")
        if spec.drive is not None and not spec.legs:
            raise InputError(
                "a 'drive' without 'legs'", key="drive", expected="'legs' of a path along which it drives"
            )
        if spec.tyres is not None and (spec.drive is None or not spec.legs):
            raise InputError(
                f"'tyres' without {'legs' if not spec.legs else 'a drive'!r}",
                key="tyres",
                expected="'legs' along which it is steered, and a 'drive' with friction and brakes",
            )
        if spec.levelling is not None and any(group.constant_force for group in spec.groups):
            raise InputError(
                "'levelling' of constant forces", key="levelling", expected="groups of oil or gas"
            )

    @property
    def stops(self) -> tuple[float, float]:
        """Lowest and highest stroke [m]."""
        if self.stroke_limits is None:
            return -np.inf, np.inf
        return float(self.stroke_limits[0]), float(self.stroke_limits[1])

    @property
    def components(self) -> dict[str, tuple[str, ...]]:
        """Components of its channels, by channel."""
        bogies = tuple(str(i + 1) for i in range(sum(len(group.bogies) for group in self.groups)))
        groups = tuple(group.name for group in self.groups)
        absent = () if self.legs else PathOutputs.CHANNELS
        absent += () if self.drive else DriveOutputs.CHANNELS
        return {
            **{channel.name: () for channel in absent},
            **dict.fromkeys(("wheel_load", "road_under", "stroke_of"), bogies),
            **dict.fromkeys(("steering", "rolling_speed"), bogies if self.legs else ()),
            **dict.fromkeys(("side_force", "slip_angle"), bogies if self.tyres else ()),
            "group_force": groups,
            "levelled": groups if self.levelling else (),
        }


class DeckData(Record):
    """A deck.

    Attributes
    ----------
    origin, x, y, z
        Markers of its origin and axes.
    first, count, across
        Corners of its profile; or where its grid begins, its stations and offsets. The last is 0 of a profile.
    begin, end, right, left
        Its borders [m].
    """

    origin: int
    x: int
    y: int
    z: int
    first: int
    count: int
    across: int
    begin: float
    end: float
    right: float
    left: float


class VehicleData(Record):
    """A transporter.

    Attributes
    ----------
    first_group, groups, first_bogie, bogies
        Its groups and bogies.
    column, parts, levelling
        First record column, and where what is recorded of its bogies and of levelling is.
    x, y, z
        Markers of the axes of its body along, to the left, and upwards.
    radius, tyre, pipe, rubber, low, high
        Of its wheels, tyres, pipes, dampers of tyres, and stops.
    weight
        Of a bogie [N].
    driven, speed
        Whether its wheels travel by themselves, and how fast [m/s].
    tyred
        Whether it has tyres that slip, which ask for slopes.
    start_height
        Mean height of the places of its bogies at the start, along z of the world [m].
    rest
        Mean load of its bogies at the start [N].
    levels, period, rate, fastest, dead, roll, pitch
        Whether it has levelling; time between looks [s], 1/T [1/s], largest speed [m/s], dead angle, and angles that
        are kept [rad].
    """

    first_group: int
    groups: int
    first_bogie: int
    bogies: int
    column: int
    parts: BogieParts
    levelling: LevellingParts
    x: int
    y: int
    z: int
    radius: float
    tyre: float
    pipe: float
    rubber: float
    low: float
    high: float
    weight: float
    driven: bool
    speed: float
    tyred: bool
    start_height: float
    rest: float
    levels: bool
    period: float
    rate: float
    fastest: float
    dead: float
    roll: float
    pitch: float


class VehicleState(Record):
    """Looks of levelling so far, whether it has failed; extremes of the loads and strokes of a transporter."""

    looks: int
    failed: bool
    loads_high: Extremes
    loads_low: Extremes
    strokes_high: Extremes
    strokes_low: Extremes


class GroupData(Record):
    """A group.

    Attributes
    ----------
    vehicle
        Its transporter.
    first, count
        Its bogies.
    block, lane, attachments
        Of its row, or of the first of its rows.
    rows, apart
        1, or one a bogie; blocks from one to the next.
    stiffness
        Of oil, force of a cylinder by the sum of strokes [N/m].
    gas
        Length of the gas of an accumulator, by the sum of strokes [m]; 0 without.
    start_force
        Of a cylinder at the start [N].
    first_pump, pumps
        Rows of its pump.
    constant
        Whether its force is always that of the start.
    relief
        Force of a cylinder at which oil is lost [N].
    leak
        Rate of the sum of strokes by oil that leaks, over the force of a cylinder [m/(N s)].
    ahead, aside
        Middle of its bogies from that of all, along and to the left [m].
    """

    vehicle: int
    first: int
    count: int
    block: int
    lane: int
    attachments: int
    rows: int
    apart: int
    stiffness: float
    gas: float
    start_force: float
    first_pump: int
    pumps: int
    constant: bool
    relief: float
    leak: float
    ahead: float
    aside: float


class GroupState(Record):
    """What a group carries.

    Attributes
    ----------
    fresh
        Whether no step has been made yet.
    lift
        Carried sum of r [m].
    oil, next_oil
        Sum of lifts by the pump at the start and at the end of the step [m].
    levelled, since, pumping
        Sum of lifts by levelling at its last look [m], when that was [s], and the rate of the sum since [m/s].
    strokes
        Sum of strokes that makes the force of the start [m]: that of the start, and what oil was lost since.
    drift
        Of the sum of r from the geometry [m].
    force
        Of a cylinder [N].
    extra
        Rate by which every r of a group with one row grows beside its prediction [m/s].
    fitted, follows
        `extra` for which `force` was found last [m/s], and by how much the force grows with it [N s/m]; of a group with
        one row.
    at_force, at_extra, gone
        Force and `extra` for which the loads of its bogies are known, and `_relaxed` of that step.
    even
        Whether all loads and strokes grow alike with both: of a group with one row, no bogie of which is at a stop, or
        above the road.
    total, loads, by_force, falls, by_lift, lifts
        Sums of the mean strokes [m] and loads [N] then, and of their derivatives, as `_bogie` returns them: of loads
        and strokes by the force, of loads and strokes by a lift.
    least_load, least_stroke, most_stroke
        Among them; of strokes in the mean and at the end.
    predicted, body_rate
        As predicted: rate of the row, and of the sum of r without the road [m/s].
    road
        Sum of the ways by which the road lifts the wheels in the step [m].
    road_work, pump_work, loss
        [J].
    last_rate, last_force, rounds
        Scratch of the iteration.
    unasked
        How many times its row need not be written: at the end of a step, where it is not among those that hold, and at
        the start of the next one, where it is written once shares are known.
    """

    fresh: bool
    lift: float
    oil: float
    next_oil: float
    levelled: float
    since: float
    pumping: float
    strokes: float
    drift: float
    force: float
    extra: float
    fitted: float
    follows: float
    at_force: float
    at_extra: float
    gone: float
    even: bool
    total: float
    loads: float
    by_force: float
    falls: float
    by_lift: float
    lifts: float
    least_load: float
    least_stroke: float
    most_stroke: float
    predicted: float
    body_rate: float
    road: float
    road_work: float
    pump_work: float
    loss: float
    last_rate: float
    last_force: float
    rounds: int
    unasked: int


class BogieData(Record):
    """A bogie: its place, side of its row on which its body is, force of its cylinder at the start [N]."""

    place: PlaceData
    side: int
    start_force: float


class BogieState(Record):
    """What a bogie carries.

    Attributes
    ----------
    stroke
        At the end of the last step [m].
    deck
        On which it stands.
    left_deck, left_share
        On which it stood before, and what of its load is still on that.
    rolled
        Its way along its deck in the step [m]; 0 if that has changed.
    weight
        Share of its load in the mean of its group.
    height
        By which the road lifts it over height zero of its deck [m].
    middle, growth, extra
        r in the middle of the step [m] and its rate, as predicted; rate by which it grows beside that [m/s].
    road, climbed
        By how much the road lifts it in the step [m], and what it climbs as it rolls: decks may move themselves.
    load, mean, slope, load_p
        On the road at the end and in the mean of a step, without its own weight [N]; derivatives of the latter by a
        rate by which every r of its group grows [N s/m], and by the force of its cylinder.
    predicted, last_rate, last_mean
        Rate of r without the road, as predicted [m/s]; scratch of the iteration of a row of its own.
    end_stroke
        Stroke at the end of the step [m].
    incline_x, incline_y
        Slope of the road under it along and across its deck, for tyres that slip.
    failure, station, offset
        Why and where it stopped the run; of a jolt how large it is, over the load at rest.
    """

    stroke: float
    deck: int
    left_deck: int
    left_share: float
    rolled: float
    weight: float
    height: float
    middle: float
    growth: float
    extra: float
    road: float
    climbed: float
    load: float
    mean: float
    slope: float
    load_p: float
    predicted: float
    last_rate: float
    last_mean: float
    end_stroke: float
    incline_x: float
    incline_y: float
    failure: int
    station: float
    offset: float


class PumpRow(Record):
    """A row of a pump: time [s], and lift of all bogies of its group together [m]."""

    time: float
    lift: float


transporter_outputs = outputs_at(TransporterOutputs)


class Transporters(Arrays):
    """All transporters of a scene.

    Attributes
    ----------
    decks, vehicles, groups, bogies, pumps
        The description.
    corners, grids
        Profiles and grids of heights of all decks, see `heavylift.solver.transport.decks.corner_table`.
    deck_sides
        By group and deck: the side of the row of the group on which the body of the deck is, -1 of the ground.
    starts
        By bogie and deck: station and offset at the start [m], shape (bogies, 2 decks).
    steering
        By bogie: angle of its wheels to the left of the vehicle at the start of the step, and by how much it turns in
        the step [rad]; of vehicles with a path, where a deck asks for it. Shape (bogies, 2). Carried.
    vehicle_state, group_state, bogie_state
        Carried.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("steering", "vehicle_state", "group_state", "bogie_state")

    decks: Records[DeckData]
    vehicles: Records[VehicleData]
    groups: Records[GroupData]
    bogies: Records[BogieData]
    pumps: Records[PumpRow]
    corners: Floats2
    grids: Floats1
    deck_sides: Ints2
    starts: Floats2
    steering: Floats2
    vehicle_state: Records[VehicleState]
    group_state: Records[GroupState]
    bogie_state: Records[BogieState]


# ---- the law of a group ----


@kernel(internal=True)
def _oil_force(group: GroupData, grown: float) -> tuple[float, float]:
    """Force of a cylinder [N] and its derivative, where the sum of strokes and oil has grown since the start [m]."""
    if group.constant:
        return group.start_force, 0.0
    force, stiffness = _closed_force(group, grown)
    return (force, stiffness) if force < group.relief else (group.relief, 0.0)


@kernel(internal=True)
def _closed_force(group: GroupData, grown: float) -> tuple[float, float]:
    """As `_oil_force`, of oil that is not lost."""
    if group.gas > 0.0:
        left = 1.0 - grown / group.gas
        if not left > 1e-6:
            left = 1e-6  # hardly any gas is left: as good as a wall
        force = group.start_force * left**-GAS_EXPONENT
        return force, GAS_EXPONENT * force / (group.gas * left)
    force = group.start_force + group.stiffness * grown
    return (force, group.stiffness) if force > 0.0 else (0.0, 0.0)


@kernel(inline=True, internal=True)
def _relaxed(vehicle: VehicleData, h: float) -> float:
    """Share of the way to its aim that a damped stroke goes in a step; 1 without pipes, or at an instant."""
    damping = vehicle.pipe + vehicle.rubber
    return -math.expm1(-h * vehicle.tyre / damping) if damping > 0.0 and h > 0.0 else 1.0


@kernel(inline=True, internal=True)
def _bogie(
    vehicle: VehicleData, r: float, growth: float, stroke: float, p: float, h: float, gone: float
) -> tuple[float, float, float, float, float, float, float]:
    """A bogie in a step.

    Parameters
    ----------
    vehicle
        Its transporter.
    r, growth
        In the middle of the step [m], with the tyre's compression at the start, and its rate [m/s].
    stroke
        At the start of the step [m].
    p
        Force of its cylinder [N].
    h
        Step [s]; 0 for what holds at an instant, without pipe.
    gone
        `_relaxed` of the step.

    Returns
    -------
    load, mean, end
        Mean load on the road [N], mean stroke, and stroke at the end of the step [m].
    load_p, stroke_p
        Derivatives of load and mean stroke by p.
    load_r, stroke_r
        By a rate x that lifts r by ``h x / 2`` in the middle, over that lift.
    """
    k, pipe, c = vehicle.tyre, vehicle.pipe, vehicle.rubber
    if pipe + c == 0.0 or h == 0.0:
        s = r - p / k
        if s > vehicle.high:
            return k * (r - vehicle.high), vehicle.high, vehicle.high, 0.0, 0.0, k, 0.0
        if s < vehicle.low:
            load = k * (r - vehicle.low)
            return max(load, 0.0), vehicle.low, vehicle.low, 0.0, 0.0, (k if load > 0.0 else 0.0), 0.0
        return p, s, s, 1.0, -1.0 / k, 0.0, 1.0
    delay, lag = (pipe + c) / k, pipe / k
    mean_left = gone * delay / h
    aim = r - p / k
    off = stroke - aim + (0.5 * h + lag) * growth
    s = aim - lag * growth + off * mean_left
    end = aim + (0.5 * h - lag) * growth + off * (1.0 - gone)
    load = p + pipe * (end - stroke) / h
    if load < 0.0:  # above the road: the cylinder pushes the wheel down as fast as its pipe lets it
        end = min(max(stroke - p * h / pipe, vehicle.low), vehicle.high)
        s = 0.5 * (stroke + end)
        moves = vehicle.low < end < vehicle.high
        return 0.0, s, end, 0.0, (-0.5 * h / pipe if moves else 0.0), 0.0, 0.0
    if not vehicle.low <= s <= vehicle.high:
        stop = vehicle.high if s > vehicle.high else vehicle.low
        load = k * (r - stop) + c * growth
        by_r = k + 2.0 * c / h
        return max(load, 0.0), stop, stop, 0.0, 0.0, (by_r if load > 0.0 else 0.0), 0.0
    end = min(max(end, vehicle.low), vehicle.high)
    follows = 1.0 - 2.0 * lag / h * (1.0 - mean_left)
    by_r = 2.0 * pipe / h * (1.0 - lag * gone / h)
    return load, s, end, 1.0 - lag * gone / h, -(1.0 - mean_left) / k, by_r, follows


@kernel(internal=True)
def _weigh(kind: Transporters, g: int, h: float, p: float) -> None:
    """Loads and strokes of the bogies of a group at a force of its cylinders; their sums."""
    group, state = kind.groups[g], kind.group_state[g]
    vehicle = kind.vehicles[group.vehicle]
    gone = _relaxed(vehicle, h)
    off = -state.drift / group.count
    even = group.rows == 1
    total = loads = by_force = falls = by_lift = lifts = 0.0
    least_load = least_stroke = math.inf
    most_stroke = -math.inf
    for i in range(group.first, group.first + group.count):
        bogie = kind.bogie_state[i]
        if group.rows == 1:
            bogie.extra = state.extra
        tyre, x = kind.bogies[i].start_force / vehicle.tyre, bogie.extra
        load, s, end, load_p, stroke_p, load_r, stroke_r = _bogie(
            vehicle, bogie.middle + tyre + 0.5 * h * x + off, bogie.growth + x, bogie.stroke, p, h, gone
        )
        bogie.mean, bogie.end_stroke = load, end
        bogie.slope, bogie.load_p = load_r, load_p
        total += s
        loads += load
        by_force += load_p
        falls += stroke_p
        by_lift += load_r
        lifts += stroke_r
        even = even and load_p > 0.0
        least_load = min(least_load, load)
        least_stroke, most_stroke = min(least_stroke, s, end), max(most_stroke, s, end)
    state.at_force, state.at_extra, state.gone, state.even = p, state.extra, gone, even
    state.total, state.loads, state.by_force, state.falls = total, loads, by_force, falls
    state.by_lift, state.lifts = by_lift, lifts
    state.least_load, state.least_stroke, state.most_stroke = least_load, least_stroke, most_stroke


@kernel(inline=True, internal=True)
def _even_changes(
    vehicle: VehicleData, group: GroupData, state: GroupState, h: float, p: float
) -> tuple[float, float, float]:
    """By how much load, mean stroke and stroke at the end of any bogie of an even group have changed since `_weigh`."""
    n, k = group.count, vehicle.tyre
    dp, x = p - state.at_force, state.extra - state.at_extra
    load = (state.by_force * dp + state.by_lift * 0.5 * h * x) / n
    s = (state.falls * dp + state.lifts * 0.5 * h * x) / n
    if vehicle.pipe + vehicle.rubber == 0.0 or h == 0.0:
        return load, s, s
    return load, s, (h - vehicle.pipe / k * state.gone) * x - state.gone / k * dp


@kernel(inline=True, internal=True)
def _stays_even(vehicle: VehicleData, group: GroupData, state: GroupState, h: float, p: float) -> bool:
    """Whether a group is even, and none of its bogies comes to a stop or leaves the road at a force."""
    if not state.even:
        return False
    load, s, end = _even_changes(vehicle, group, state, h, p)
    moved = max(abs(s), abs(end))
    return (
        state.least_load + load > ROUNDED * state.least_load
        and state.least_stroke - moved > vehicle.low
        and state.most_stroke + moved < vehicle.high
    )


@kernel(internal=True)
def _settle(kind: Transporters, g: int, h: float) -> None:
    """Tell the bogies of an even group what `_fit_group` has found; those of others know it."""
    group, state = kind.groups[g], kind.group_state[g]
    if not state.even or (state.force == state.at_force and state.extra == state.at_extra):
        return
    load, s, end = _even_changes(kind.vehicles[group.vehicle], group, state, h, state.force)
    for i in range(group.first, group.first + group.count):
        bogie = kind.bogie_state[i]
        bogie.mean += load
        bogie.end_stroke += end
        bogie.extra = state.extra
    moved = max(abs(s), abs(end))
    state.total += group.count * s
    state.loads += group.count * load
    state.least_load += load
    state.least_stroke -= moved
    state.most_stroke += moved
    state.at_force, state.at_extra = state.force, state.extra


@kernel(internal=True)
def _fit_group(kind: Transporters, g: int, h: float) -> tuple[float, float, float]:
    """Loads of the bogies of a group. Those of an even one are set by `_settle`: sums suffice for its row.

    Parameters
    ----------
    kind
        Carried; what `extra` makes of its bogies, and the forces of its cylinders, are found.
    g
        The group.
    h
        Step [s]; 0 for what holds at an instant.

    Returns
    -------
    force, mean, slope
        Force of a cylinder [N]; mean load [N] and its derivative by a rate that all bogies have beside `extra`.
    """
    group, state = kind.groups[g], kind.group_state[g]
    vehicle = kind.vehicles[group.vehicle]
    n = group.count
    oil = 0.5 * (state.oil + state.next_oil) if h > 0.0 else state.oil
    low, high = 0.0, math.inf
    extra = state.extra if group.rows == 1 else kind.bogie_state[group.first].extra
    p = max(state.force + state.follows * (extra - state.fitted), 0.0)
    stiffness = mean = 0.0
    for _ in range(ROUNDS):
        if not _stays_even(vehicle, group, state, h, p):
            _weigh(kind, g, h, p)
        load, s, _ = _even_changes(vehicle, group, state, h, p)
        mean = state.loads / n + load
        force, stiffness = _oil_force(group, state.total + n * s + oil - state.strokes)
        miss = force - p
        if abs(miss) <= NEGLIGIBLE * (p + force):
            break
        if miss > 0.0:
            low = p
        else:
            high = p
        after = p - miss / (stiffness * state.falls - 1.0)
        if not low <= after <= high:
            after = 0.5 * (low + high) if high < math.inf else 2.0 * low + 1.0
        if abs(after - p) <= NEGLIGIBLE * p:
            break
        p = after
    p_r = stiffness * state.lifts / (1.0 - stiffness * state.falls)
    if group.rows == 1:
        state.fitted, state.follows = extra, 0.5 * h * p_r
    else:
        for i in range(group.first, group.first + n):
            bogie = kind.bogie_state[i]
            bogie.slope = 0.5 * h * (bogie.slope + bogie.load_p * p_r)
    state.force = p
    return p, mean, 0.5 * h * (state.by_lift + state.by_force * p_r) / n


@kernel(internal=True)
def _oil_in(kind: Transporters, g: int, time: float) -> float:
    """Sum of the lifts that pump and levelling of a group have made at a time [m]."""
    state = kind.group_state[g]
    return _planned(kind, g, time) + state.levelled + state.pumping * (time - state.since)


@kernel(internal=True)
def _planned(kind: Transporters, g: int, time: float) -> float:
    """Sum of the lifts by the plan of a pump [m]."""
    first, count = kind.groups[g].first_pump, kind.groups[g].pumps
    if count == 0:
        return 0.0
    if time <= kind.pumps[first].time:
        return kind.pumps[first].lift
    for i in range(first, first + count - 1):
        a, b = kind.pumps[i], kind.pumps[i + 1]
        if time < b.time:
            return a.lift + (b.lift - a.lift) * (time - a.time) / (b.time - a.time)
    return kind.pumps[first + count - 1].lift


@kernel(internal=True)
def _tilt(vehicle: VehicleData, work: Workspace) -> tuple[float, float]:
    """Roll and pitch of a vehicle [rad]."""
    x, y, z = vector(work, vehicle.x), vector(work, vehicle.y), vector(work, vehicle.z)
    return math.atan2(y[2], z[2]), -math.asin(min(max(x[2], -1.0), 1.0))


@kernel(internal=True)
def _level(kind: Transporters, v: int, time: float, work: Workspace) -> None:
    """Look at a vehicle if it is time, and tell its pumps how fast until the next look."""
    vehicle, state = kind.vehicles[v], kind.vehicle_state[v]
    first, last = vehicle.first_group, vehicle.first_group + vehicle.groups
    count = math.floor(time / vehicle.period + 1e-9)
    if not vehicle.levels or kind.group_state[first].fresh or count < state.looks:
        return
    state.looks = count + 1
    if state.failed:
        return
    roll, pitch = _tilt(vehicle, work)
    roll, pitch = roll - vehicle.roll, pitch - vehicle.pitch
    roll = roll if abs(roll) > vehicle.dead else 0.0
    pitch = pitch if abs(pitch) > vehicle.dead else 0.0
    most = 0.0
    for g in range(first, last):
        group, carried = kind.groups[g], kind.group_state[g]
        carried.levelled += carried.pumping * (time - carried.since)
        carried.since = time
        speed = vehicle.rate * (pitch * group.ahead - roll * group.aside)
        carried.pumping = group.count * speed
        most = max(most, abs(speed))
    if most > vehicle.fastest:
        for g in range(first, last):
            kind.group_state[g].pumping *= vehicle.fastest / most


# ---- wheels on decks ----


@kernel(inline=True, internal=True)
def _along(work: Workspace, axis: int, off: Vector, moving: Vector) -> tuple[float, float]:
    """Coordinate of a place along an axis of a deck [m] and its rate [m/s], from its origin and against that."""
    e = vector(work, axis)
    return dot(off, e), dot(moving, e) + dot(off, rate(work, axis))


@kernel(inline=True, internal=True)
def _beyond(a: float, b: float, low: float, high: float, radius: float) -> bool:
    """Whether a wheel touches nothing between two borders on its way from a to b."""
    return (a < low - radius and b < low - radius) or (a > high + radius and b > high + radius)


@kernel(internal=True)
def _height(kind: Transporters, d: int, vehicle: VehicleData, x: float, y: float) -> float:
    """Height of a wheel at a place on a deck with a profile [m]; `NO_ROAD` where there is none."""
    deck = kind.decks[d]
    if not deck.right <= y <= deck.left:
        return NO_ROAD
    return dilated_height(kind.corners, deck.first, deck.count, vehicle.radius, x)


@kernel(internal=True)
def _height_on_grid(
    kind: Transporters,
    work: Workspace,
    i: int,
    d: int,
    vehicle: VehicleData,
    x: float,
    y: float,
    share: float,
) -> float:
    """As `_height` on a grid, a share of the step after its start.

    Wheels that travel by themselves do so along stations, others roll as they are steered.
    """
    deck = kind.decks[d]
    cx, cy = 1.0, 0.0
    if not vehicle.driven:
        angle = kind.steering[i, 0] + share * kind.steering[i, 1]
        c, s = math.cos(angle), math.sin(angle)
        f, g = vector(work, vehicle.x), vector(work, vehicle.y)
        u, v = vector(work, deck.x), vector(work, deck.y)
        cx, cy = c * dot(f, u) + s * dot(g, u), c * dot(f, v) + s * dot(g, v)
        size = math.hypot(cx, cy)
        cx, cy = cx / size, cy / size
    return grid_height(kind.grids, deck.first, deck.count, deck.across, vehicle.radius, x, y, cx, cy)


@kernel(internal=True)
def _stand(
    kind: Transporters, work: Workspace, i: int, vehicle: VehicleData, travelled: float
) -> tuple[int, float, float]:
    """Uppermost deck under a wheel now.

    Parameters
    ----------
    kind, work, i, vehicle
        Wheel and its transporter.
    travelled
        Way of wheels that travel by themselves [m].

    Returns
    -------
    deck, r
        -1 and 0 if there is none; by how much it lifts the wheel over its place under the body [m].
    height
        Of the road for the wheel over that of the deck [m].
    """
    p = place(work, kind.bogies[i].place)
    found, best, above = -1, NO_ROAD, 0.0
    with_grids = kind.grids.shape[0] > 0
    for d in range(kind.decks.shape[0]):
        deck = kind.decks[d]
        off = minus(p, vector(work, deck.origin))
        x = kind.starts[i, 2 * d] + travelled if vehicle.driven else dot(off, vector(work, deck.x))
        if _beyond(x, x, deck.begin, deck.end, vehicle.radius):
            continue
        y = kind.starts[i, 2 * d + 1] if vehicle.driven else dot(off, vector(work, deck.y))
        if _beyond(y, y, deck.right, deck.left, vehicle.radius):
            continue
        z = dot(off, vector(work, deck.z))
        if with_grids and deck.across > 0:
            height = _height_on_grid(kind, work, i, d, vehicle, x, y, 0.0)
        else:
            height = _height(kind, d, vehicle, x, y)
        if height > NO_ROAD and (found < 0 or height - z > best):
            found, best, above = d, height - z, height
    return found, (best if found >= 0 else 0.0), above


@kernel(internal=True)
def _roll(
    kind: Transporters, work: Workspace, i: int, vehicle: VehicleData, time: float, h: float
) -> tuple[int, float, float, float, float, float, float, float]:
    """Uppermost decks under a wheel at both ends of a step, from its middle along the velocities there.

    Parameters
    ----------
    kind, work, i, vehicle
        Wheel and its transporter.
    time, h
        At which the step begins, and its length [s].

    Returns
    -------
    deck, before, after
        At the end, -1 if there is none; by how much it and that at the start lift the wheel over its place under the
        body [m], 0 where there is none.
    up
        Rate of the height of that place over the deck at the end [m/s].
    moved, station, offset
        Way along, on a grid in any direction, and place at the end, on that deck; or on the one on which it stood
        before [m].
    climbed
        By how much it rises over these decks because it rolls [m]: what they rise or sink themselves is none of it.
    """
    p, v = place(work, kind.bogies[i].place), place_rate(work, kind.bogies[i].place)
    first, found = -1, -1
    before, after = NO_ROAD, NO_ROAD
    rises = moved = station = offset = 0.0
    climb_before = climb_after = 0.0
    end_before, start_after = NO_ROAD, NO_ROAD
    with_grids = kind.grids.shape[0] > 0
    for d in range(kind.decks.shape[0]):
        deck, own = kind.decks[d], d == kind.bogie_state[i].deck
        off, moving = minus(p, vector(work, deck.origin)), minus(v, rate(work, deck.origin))
        x, along = _along(work, deck.x, off, moving)
        x0, x1 = x - 0.5 * h * along, x + 0.5 * h * along
        if vehicle.driven:
            x0 = kind.starts[i, 2 * d] + vehicle.speed * time
            x1 = kind.starts[i, 2 * d] + vehicle.speed * (time + h)
        if not own and _beyond(x0, x1, deck.begin, deck.end, vehicle.radius):
            continue
        y, across = _along(work, deck.y, off, moving)
        y0, y1 = y - 0.5 * h * across, y + 0.5 * h * across
        if vehicle.driven:
            y0 = y1 = kind.starts[i, 2 * d + 1]
        if not own and _beyond(y0, y1, deck.right, deck.left, vehicle.radius):
            continue
        z, up = _along(work, deck.z, off, moving)
        if own and found < 0:
            station, offset = x1, y1
        if with_grids and deck.across > 0:
            h0 = _height_on_grid(kind, work, i, d, vehicle, x0, y0, 0.0)
            h1 = _height_on_grid(kind, work, i, d, vehicle, x1, y1, 1.0)
            way = math.hypot(x1 - x0, y1 - y0)
        else:
            h0, h1, way = _height(kind, d, vehicle, x0, y0), _height(kind, d, vehicle, x1, y1), x1 - x0
        start = h0 - (z - 0.5 * h * up) if h0 > NO_ROAD else NO_ROAD
        end = h1 - (z + 0.5 * h * up) if h1 > NO_ROAD else NO_ROAD
        if h0 > NO_ROAD and (first < 0 or start > before):
            first, before, end_before, climb_before = d, start, end, h1 - h0
        if h1 > NO_ROAD and (found < 0 or end > after):
            found, after, start_after, climb_after = d, end, start, h1 - h0
            rises, moved, station, offset = up, way, x1, y1
    before = before if first >= 0 else 0.0
    after = after if found >= 0 else 0.0
    climbed = climb_after
    if first < 0 or found < 0:
        climbed = 0.0
    elif first != found:
        climbed = _climbed_over(before, end_before, climb_before, start_after, after, climb_after)
    return found, before, after, rises, moved, station, offset, climbed


@kernel(inline=True, internal=True)
def _climbed_over(
    before: float,
    end_before: float,
    climb_before: float,
    start_after: float,
    after: float,
    climb_after: float,
) -> float:
    """What a wheel climbs that goes from one deck over to another one within a step [m].

    It is on the first one as long as that lifts it higher, by the lifts at both ends of the step of both; `NO_ROAD`
    where a deck has begun or ended meanwhile.
    """
    if end_before > NO_ROAD and start_after > NO_ROAD:
        over, under = before - start_after, after - end_before
        share = over / (over + under) if over + under > 0.0 else 0.5
        return share * climb_before + (1.0 - share) * climb_after
    if end_before > NO_ROAD:  # up the edge with which the other one begins
        return climb_before + after - end_before
    return climb_after if start_after > NO_ROAD else 0.0


@kernel(internal=True)
def _look_down(kind: Transporters, work: Workspace, i: int, vehicle: VehicleData, h: float) -> None:
    """Slope of the road under a wheel over its way in a step."""
    bogie = kind.bogie_state[i]
    deck = kind.decks[bogie.deck]
    at = kind.bogies[i].place
    off = minus(place(work, at), vector(work, deck.origin))
    moving = minus(place_rate(work, at), rate(work, deck.origin))
    x, along = _along(work, deck.x, off, moving)
    y, across = _along(work, deck.y, off, moving)
    reach = max(0.5 * h * abs(along), INCLINE_WAY)
    if deck.across == 0:
        behind = _height(kind, bogie.deck, vehicle, x - reach, y)
        ahead = _height(kind, bogie.deck, vehicle, x + reach, y)
        bogie.incline_x, bogie.incline_y = _slope(behind, ahead, reach), 0.0
        return
    behind = _height_on_grid(kind, work, i, bogie.deck, vehicle, x - reach, y, 0.5)
    ahead = _height_on_grid(kind, work, i, bogie.deck, vehicle, x + reach, y, 0.5)
    bogie.incline_x = _slope(behind, ahead, reach)
    reach = max(0.5 * h * abs(across), INCLINE_WAY)
    behind = _height_on_grid(kind, work, i, bogie.deck, vehicle, x, y - reach, 0.5)
    ahead = _height_on_grid(kind, work, i, bogie.deck, vehicle, x, y + reach, 0.5)
    bogie.incline_y = _slope(behind, ahead, reach)


@kernel(inline=True, internal=True)
def _slope(behind: float, ahead: float, reach: float) -> float:
    """Of heights at both sides; 0 at a border."""
    return 0.5 * (ahead - behind) / reach if behind > NO_ROAD and ahead > NO_ROAD else 0.0


@kernel(internal=True)
def _stop(kind: Transporters, g: int, i: int, failure: int, x: float, y: float, work: Workspace) -> None:
    """End the run because of a wheel."""
    bogie = kind.bogie_state[i]
    bogie.failure, bogie.station, bogie.offset = failure, x, y
    work.status.outcome = OFF_ROAD
    work.status.block = kind.groups[g].block


@kernel(internal=True)
def _go_over(kind: Transporters, g: int, i: int, deck: int) -> None:
    """Set a wheel on a deck. Its load stays for the moment where it was, if that is another body."""
    bogie = kind.bogie_state[i]
    if deck == bogie.deck:
        return
    if bogie.left_share > 0.0 and deck == bogie.left_deck:
        bogie.left_share = 1.0 - bogie.left_share
    else:
        bogie.left_share = 1.0 if kind.deck_sides[g, deck] != kind.deck_sides[g, bogie.deck] else 0.0
    bogie.left_deck, bogie.deck = bogie.deck, deck


@kernel(internal=True)
def _look_ahead(kind: Transporters, g: int, time: float, h: float, work: Workspace) -> None:
    """Where the road is under the wheels of a group at the start and at the end of a step, from its middle."""
    group, state = kind.groups[g], kind.group_state[g]
    vehicle = kind.vehicles[group.vehicle]
    start = state.road = state.body_rate = 0.0
    for i in range(group.first, group.first + group.count):
        bogie = kind.bogie_state[i]
        deck, r0, r1, up, moved, x1, y1, bogie.climbed = _roll(kind, work, i, vehicle, time, h)
        if deck < 0:
            _stop(kind, g, i, LEFT, x1, y1, work)
            continue
        # decks that move differently are level where a wheel goes over, not at the same rate
        if abs(r1 - r0 + h * up) > (STEEPEST + 0.5) * abs(moved) + 0.02 * vehicle.radius + 1e-6:
            _stop(kind, g, i, WALL, x1, y1, work)
        bogie.rolled = abs(moved) if deck == bogie.deck else 0.0
        _go_over(kind, g, i, deck)
        if dot(vector(work, vehicle.z), vector(work, kind.decks[deck].z)) < UPRIGHT:
            _stop(kind, g, i, TIPPED, x1, y1, work)
        if vehicle.tyred:
            _look_down(kind, work, i, vehicle, h)
        if bogie.left_share > 0.0:
            left, at = kind.decks[bogie.left_deck], kind.bogies[i].place
            off = minus(place(work, at), vector(work, left.origin))
            _, other = _along(work, left.z, off, minus(place_rate(work, at), rate(work, left.origin)))
            up += bogie.left_share * (other - up)
        bogie.predicted = -up
        bogie.road = r1 - r0 + h * up
        bogie.middle, bogie.growth = 0.5 * (r0 + r1), (r1 - r0) / h
        start += r0
        state.road += bogie.road
        state.body_rate -= up
    if state.fresh:
        state.lift = start
    state.drift = start - state.lift


@kernel(internal=True)
def _look_here(kind: Transporters, g: int, time: float, work: Workspace) -> None:
    """Where the road is under the wheels of a group now; loads and forces at this instant."""
    group, state = kind.groups[g], kind.group_state[g]
    vehicle = kind.vehicles[group.vehicle]
    total = 0.0
    for i in range(group.first, group.first + group.count):
        bogie = kind.bogie_state[i]
        deck, r, height = _stand(kind, work, i, vehicle, vehicle.speed * time)
        if deck >= 0:
            _go_over(kind, g, i, deck)
            bogie.middle, bogie.height = r, height
            if vehicle.tyred and state.fresh:
                _look_down(kind, work, i, vehicle, 0.0)
        total += bogie.middle
    if state.fresh:
        state.lift = total
    state.drift = total - state.lift
    state.oil = _oil_in(kind, g, time)
    if vehicle.pipe + vehicle.rubber == 0.0 or state.fresh:
        _put_extra(kind, g, 0.0)
        state.follows, state.even = 0.0, False
        _fit_group(kind, g, 0.0)
        _settle(kind, g, 0.0)
        for i in range(group.first, group.first + group.count):
            bogie = kind.bogie_state[i]
            bogie.load, bogie.stroke = bogie.mean, bogie.end_stroke
        return
    total = 0.0
    for i in range(group.first, group.first + group.count):
        total += kind.bogie_state[i].stroke
    p = state.force = _oil_force(group, total + state.oil - state.strokes)[0]
    for i in range(group.first, group.first + group.count):
        bogie = kind.bogie_state[i]
        pressed = bogie.middle - state.drift / group.count - bogie.stroke
        elastic = vehicle.tyre * pressed + kind.bogies[i].start_force
        if vehicle.low < bogie.stroke < vehicle.high:  # tyre and pipe give way together
            damper = elastic + vehicle.rubber * bogie.growth - p
            bogie.load = max(p + vehicle.pipe * damper / (vehicle.pipe + vehicle.rubber), 0.0)
        else:
            bogie.load = max(elastic + vehicle.rubber * bogie.growth, 0.0)


# ---- rows ----


@kernel(inline=True, internal=True)
def _block(group: GroupData, i: int) -> int:
    """Block of the row in which a bogie is."""
    return group.block if group.rows == 1 else group.block + group.apart * (i - group.first)


@kernel(internal=True)
def _write_row(kind: Transporters, g: int, work: Workspace, system: RowArrays) -> None:
    """``sum w_i d/dt ( - n . (p_i - o) )`` on the sides of the body and of the decks."""
    group, lanes, lane = kind.groups[g], system.lanes, kind.groups[g].lane
    for row in range(group.rows):
        first = 2 * (group.block + group.apart * row)
        for side in range(first, first + group.attachments):
            panel = system.attachments[side].panel + lane
            for k in range(system.attachments[side].width):
                system.panels[panel + k * lanes] = 0.0
    for d in range(kind.decks.shape[0]):
        n, o = vector(work, kind.decks[d].z), vector(work, kind.decks[d].origin)
        shares, a, b, c = 0.0, 0.0, 0.0, 0.0
        for i in range(group.first, group.first + group.count):
            bogie, w = kind.bogie_state[i], kind.bogie_state[i].weight
            if bogie.deck == d:
                w -= w * bogie.left_share
            elif bogie.left_deck == d:
                w *= bogie.left_share
            else:
                continue
            if w == 0.0:
                continue
            at = kind.bogies[i].place
            add_place_row(system, kind.bogies[i].side, lane, work, at, (-w * n[0], -w * n[1], -w * n[2]))
            p = minus(place(work, at), o)
            shares, a, b, c = shares + w, a + w * p[0], b + w * p[1], c + w * p[2]
            if group.rows > 1:
                _add_deck(kind, g, d, _block(group, i), shares, (a, b, c), work, system)
                shares, a, b, c = 0.0, 0.0, 0.0, 0.0
        if shares > 0.0:
            _add_deck(kind, g, d, group.block, shares, (a, b, c), work, system)


@kernel(internal=True)
def _add_deck(
    kind: Transporters,
    g: int,
    d: int,
    block: int,
    w: float,
    arms: Vector,
    work: Workspace,
    system: RowArrays,
) -> None:
    """Add what stands on a deck to a row: weights and weighted arms from its origin, summed."""
    deck, lane, side = kind.decks[d], kind.groups[g].lane, kind.deck_sides[g, d]
    if side < 0:
        return
    side += 2 * (block - kind.groups[g].block)
    n = vector(work, deck.z)
    add_direction_row(system, side, lane, work, deck.origin, (w * n[0], w * n[1], w * n[2]))
    add_direction_row(system, side, lane, work, deck.z, (-arms[0], -arms[1], -arms[2]))


@implement(fill_rows, Transporters)
@kernel(internal=True)
def fill_transporter_rows(
    kind: Transporters, with_residual: bool, work: Workspace, system: RowArrays
) -> None:
    """Rows with the shares that are known; drift."""
    for g in range(kind.groups.shape[0]):
        group, state = kind.groups[g], kind.group_state[g]
        if state.unasked == (2 if with_residual else 1):
            state.unasked -= 1
        else:
            _write_row(kind, g, work, system)
        if with_residual:
            for row in range(group.rows):
                residual = system.rows[group.block + group.apart * row].residual
                residual[group.lane] = state.drift / group.rows


@implement(set_targets, Transporters)
@kernel(internal=True)
def set_transporter_targets(
    kind: Transporters, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """Road and loads as predicted, with them the shares of the row; at the end of a step what holds there."""
    if not at_midpoint:
        for v in range(kind.vehicles.shape[0]):
            _level(kind, v, time, work)
    for g in range(kind.groups.shape[0]):
        group, state = kind.groups[g], kind.group_state[g]
        if not at_midpoint:
            _look_here(kind, g, time, work)
            continue
        if state.fresh:
            _look_here(kind, g, time, work)
        _look_ahead(kind, g, time, step, work)
        state.oil, state.next_oil = _oil_in(kind, g, time), _oil_in(kind, g, time + step)
        _put_extra(kind, g, 0.0)
        state.follows, state.even = 0.0, False
        _, mean, slope = _fit_group(kind, g, step)
        _settle(kind, g, step)
        state.predicted = 0.0
        for i in range(group.first, group.first + group.count):
            bogie = kind.bogie_state[i]
            bogie.last_rate, bogie.last_mean = bogie.predicted, bogie.mean
            bogie.weight = 1.0 if group.rows > 1 else bogie.mean / mean if mean > 0.0 else 1.0
            state.predicted += bogie.weight * bogie.predicted
        _write_row(kind, g, work, system)
        state.rounds = 0
        if group.rows > 1:
            for i in range(group.first, group.first + group.count):
                bogie = kind.bogie_state[i]
                put_row_law(system, _block(group, i), 0, step, bogie.predicted, bogie.mean, bogie.slope)
            continue
        put_row_law(system, group.block, group.lane, step, state.predicted, mean, slope / group.count)
        state.last_rate, state.last_force = state.predicted, mean


@kernel(inline=True, internal=True)
def _rate(group: GroupData, row: int, work: Workspace, system: RowArrays) -> float:
    """Rate of a row of a group in the middle of the step [m/s]."""
    first = 2 * (group.block + group.apart * row)
    return rate_of_row(system, first, first + group.attachments, group.lane, work.velocity)


@kernel(internal=True)
def _put_extra(kind: Transporters, g: int, x: float) -> None:
    """Set the rate by which every r of a group grows beside its prediction [m/s]."""
    kind.group_state[g].extra = x
    for i in range(kind.groups[g].first, kind.groups[g].first + kind.groups[g].count):
        kind.bogie_state[i].extra = x


@kernel(internal=True)
def _find_extra(kind: Transporters, g: int, work: Workspace, system: RowArrays) -> float:
    """Find by how much more every r of a group grows; rate of its row if it has one [m/s]."""
    group, state = kind.groups[g], kind.group_state[g]
    if group.rows == 1:
        u = _rate(group, 0, work, system)
        state.extra = (u - state.predicted) / group.count
        return u
    for i in range(group.first, group.first + group.count):
        bogie = kind.bogie_state[i]
        bogie.extra = _rate(group, i - group.first, work, system) - bogie.predicted
    return 0.0


@kernel(inline=True, internal=True)
def _chord(slope: float, u: float, force: float, last_rate: float, last_force: float) -> float:
    """The slope, or that of the chord from the last iterate if it is steeper."""
    return slope if u == last_rate else max(slope, (force - last_force) / (u - last_rate))


@implement(relinearise, Transporters)
@kernel(internal=True)
def relinearise_transporters(
    kind: Transporters, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Fit the mean loads to the rates found."""
    for g in range(kind.groups.shape[0]):
        group, state = kind.groups[g], kind.group_state[g]
        u = _find_extra(kind, g, work, system)
        _, mean, slope = _fit_group(kind, g, step)
        state.rounds += 1
        if group.rows > 1:
            for i in range(group.first, group.first + group.count):
                bogie = kind.bogie_state[i]
                u, slope = bogie.predicted + bogie.extra, bogie.slope
                if state.rounds > PLAIN_ROUNDS:
                    slope = _chord(slope, u, bogie.mean, bogie.last_rate, bogie.last_mean)
                bogie.last_rate, bogie.last_mean = u, bogie.mean
                fit_row_law(system, _block(group, i), 0, step, u, bogie.mean, slope, work)
            continue
        slope /= group.count
        if state.rounds > PLAIN_ROUNDS:
            slope = _chord(slope, u, mean, state.last_rate, state.last_force)
        state.last_rate, state.last_force = u, mean
        fit_row_law(system, group.block, group.lane, step, u, mean, slope, work)


@implement(update_rows, Transporters)
@kernel(internal=True)
def update_transporters(
    kind: Transporters, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Carry strokes and lifts over the step; works of road, pump and pipes."""
    for g in range(kind.groups.shape[0]):
        group, state = kind.groups[g], kind.group_state[g]
        vehicle = kind.vehicles[group.vehicle]
        u = _find_extra(kind, g, work, system)
        if group.rows > 1 or u != state.last_rate:  # else it was fitted to that last
            _fit_group(kind, g, step)
        _settle(kind, g, step)
        p = state.force
        grown = 0.0
        for i in range(group.first, group.first + group.count):
            bogie = kind.bogie_state[i]
            if not abs(bogie.mean - bogie.load) <= LARGEST_JOLT * vehicle.rest:
                bogie.failure, bogie.station = JOLT, abs(bogie.mean - bogie.load) / vehicle.rest
                work.status.outcome = STEP_TOO_LARGE
                work.status.block = group.block
            grown += bogie.extra
            state.road_work += bogie.mean * bogie.road
            moved = bogie.end_stroke - bogie.stroke
            if vehicle.pipe + vehicle.rubber > 0.0 and bogie.mean > 0.0:
                # mean force of the pipe by the stroke, and of the rubber by what the tyre gives way
                gave = step * (bogie.growth + bogie.extra) - moved
                state.loss += (vehicle.pipe * moved * moved + vehicle.rubber * gave * gave) / step
            bogie.stroke = bogie.end_stroke
            if bogie.left_share > 0.0:
                gone = max(step / HANDOVER_TIME, bogie.rolled / max(HANDOVER_WAY * vehicle.radius, 1e-9))
                bogie.left_share = max(bogie.left_share - gone, 0.0)
        state.road_work += p * RETURN * state.drift
        state.pump_work += p * (state.next_oil - state.oil)
        state.lift += state.road + step * (state.body_rate + grown) + RETURN * state.drift
        _lose_oil(kind, g, p, step)
        state.oil = state.next_oil
        state.fresh = False
        state.unasked = 2


@kernel(internal=True)
def _lose_oil(kind: Transporters, g: int, p: float, step: float) -> None:
    """Oil that leaks in a step at the force p of its middle, or that a relief valve lets go."""
    group, state = kind.groups[g], kind.group_state[g]
    if group.leak == 0.0 and group.relief == math.inf:
        return
    lost = step * group.leak * p
    if p >= group.relief:
        total = state.next_oil
        vehicle = kind.vehicles[group.vehicle]
        for i in range(group.first, group.first + group.count):
            bogie = kind.bogie_state[i]
            total += bogie.stroke
            if vehicle.pipe + vehicle.rubber == 0.0 and vehicle.low < bogie.stroke < vehicle.high:
                total += 0.5 * step * (bogie.growth + bogie.extra)  # without pipes it is that of the middle
        lost += max(total - state.strokes - lost - _growth_to(group, group.relief), 0.0)
    state.strokes += lost
    state.loss += p * lost


@kernel(internal=True)
def _growth_to(group: GroupData, force: float) -> float:
    """By how much the sum of strokes and oil grows from the start up to a force of a cylinder [m]."""
    if group.gas > 0.0:
        return group.gas * (1.0 - (group.start_force / force) ** (1.0 / GAS_EXPONENT))
    return (force - group.start_force) / group.stiffness


# ---- records ----


@kernel(internal=True)
def _extremes(kind: Transporters, v: int) -> tuple[float, float, float, float]:
    """Largest and smallest load [N] and stroke [m] of a transporter."""
    vehicle = kind.vehicles[v]
    most_load = most_stroke = -math.inf
    least_load = least_stroke = math.inf
    for i in range(vehicle.first_bogie, vehicle.first_bogie + vehicle.bogies):
        load, stroke = kind.bogie_state[i].load + vehicle.weight, kind.bogie_state[i].stroke
        most_load, least_load = max(most_load, load), min(least_load, load)
        most_stroke, least_stroke = max(most_stroke, stroke), min(least_stroke, stroke)
    return most_load, least_load, most_stroke, least_stroke


@implement(watch_joints, Transporters)
@kernel(internal=True)
def watch_transporters(kind: Transporters, work: Workspace, system: RowArrays) -> None:
    """Extremes at the end of the step."""
    interval = work.control.interval
    for v in range(kind.vehicles.shape[0]):
        state = kind.vehicle_state[v]
        most_load, least_load, most_stroke, least_stroke = _extremes(kind, v)
        note_value(state.loads_high, interval, most_load)
        note_value(state.loads_low, interval, least_load)
        note_value(state.strokes_high, interval, most_stroke)
        note_value(state.strokes_low, interval, least_stroke)


@kernel(internal=True)
def _record_pose(kind: Transporters, vehicle: VehicleData, work: Workspace, out: TransporterOutputs) -> None:
    """Heave, roll and pitch."""
    height = 0.0
    for i in range(vehicle.first_bogie, vehicle.first_bogie + vehicle.bogies):
        height += place(work, kind.bogies[i].place)[2]
    out.heave = height / vehicle.bogies - vehicle.start_height
    out.roll, out.pitch = _tilt(vehicle, work)


@implement(record_joints, Transporters)
@kernel(internal=True)
def record_transporters(
    kind: Transporters, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Pose, loads, strokes, forces; energies."""
    interval = work.control.interval
    for v in range(kind.vehicles.shape[0]):
        vehicle, state = kind.vehicles[v], kind.vehicle_state[v]
        out = transporter_outputs(row, vehicle.column)
        _record_pose(kind, vehicle, work, out)
        most_load, least_load, most_stroke, least_stroke = _extremes(kind, v)
        out.load_max = largest_of(state.loads_high, interval, most_load)
        out.load_min = smallest_of(state.loads_low, interval, least_load)
        out.stroke_max = largest_of(state.strokes_high, interval, most_stroke)
        out.stroke_min = smallest_of(state.strokes_low, interval, least_stroke)
        forces, lifts = part(row, vehicle.parts.group_force), part(row, vehicle.levelling.levelled)
        loads, heights = part(row, vehicle.parts.wheel_load), part(row, vehicle.parts.road_under)
        strokes = part(row, vehicle.parts.stroke_of)
        total, least = 0.0, math.inf
        for g in range(vehicle.first_group, vehicle.first_group + vehicle.groups):
            group, carried = kind.groups[g], kind.group_state[g]
            forces[g - vehicle.first_group] = carried.force
            if vehicle.levels:
                lifted = carried.levelled + carried.pumping * (time - carried.since)
                lifts[g - vehicle.first_group] = lifted / group.count
            load = 0.0
            for i in range(group.first, group.first + group.count):
                bogie = kind.bogie_state[i]
                load += bogie.load
                loads[i - vehicle.first_bogie] = bogie.load + vehicle.weight
                heights[i - vehicle.first_bogie] = bogie.height
                strokes[i - vehicle.first_bogie] = bogie.stroke
                work.sums.elastic += 0.5 * vehicle.tyre * _pressed(kind, g, i) ** 2
            total += load
            least = min(least, load)
            work.sums.elastic += _oil_energy(kind, g)
            work.sums.drive_work += carried.road_work + carried.pump_work
            work.sums.dissipated += carried.loss
        out.least_share = least / total if total > 0.0 else 0.0


@kernel(internal=True)
def _pressed(kind: Transporters, g: int, i: int) -> float:
    """By how much the tyre of a bogie is pressed [m]; 0 above the road."""
    bogie, tyre = kind.bogie_state[i], kind.vehicles[kind.groups[g].vehicle].tyre
    lift = bogie.middle - kind.group_state[g].drift / kind.groups[g].count
    return max(lift + kind.bogies[i].start_force / tyre - bogie.stroke, 0.0)


@kernel(internal=True)
def _oil_energy(kind: Transporters, g: int) -> float:
    """Stored in oil or gas at the force of a cylinder [J]; of gas and of a constant force against that of the start."""
    group, force = kind.groups[g], kind.group_state[g].force
    if group.constant:
        grown = -kind.group_state[g].strokes
        for i in range(group.first, group.first + group.count):
            grown += kind.bogie_state[i].stroke
        return group.start_force * grown
    if group.gas == 0.0:
        return 0.5 * force * force / group.stiffness
    left = (group.start_force / force) ** (1.0 / GAS_EXPONENT) if force > 0.0 else math.inf
    grown = left ** (1.0 - GAS_EXPONENT) - 1.0 if left < math.inf else -1.0
    return group.start_force * group.gas / (GAS_EXPONENT - 1.0) * grown
