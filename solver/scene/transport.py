"""Where roads and the vehicles on them are described, and the parts that both are made of, in SI units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Absent, BodyPoint, Least, Positive, Quantity, Shape, TableFile
from heavylift.solver.scene.descriptions import Family, check_table, named, no_rows
from heavylift.solver.scene.outputs import Outputs, Part, Parts, channel, largest, outputs, smallest

__all__ = [
    "TRANSPORT",
    "BogieGroup",
    "BogieParts",
    "Bump",
    "Drive",
    "DriveOutputs",
    "HeightGrid",
    "Levelling",
    "LevellingParts",
    "OilPump",
    "PathLeg",
    "PathOutputs",
    "SteeringParts",
    "TransporterOutputs",
    "TyreParts",
    "Tyres",
]

TRANSPORT: Family[Any] = Family("table", "heavylift.solver.transport", typed=False)
"""Decks and transporters, by the lists of a case file in which they stand."""

CHORDS = 512
"""Of a bump."""


@TRANSPORT.part
@dataclass(frozen=True)
class Bump:
    """A bump across a deck."""

    start: Annotated[float, Quantity("length")]
    """Station at which it begins [m]."""
    length: Annotated[float, Positive("length")]
    """L, along the deck [m]."""
    height: Annotated[float, Quantity("length")]
    """h, of its middle [m]; negative of a dip."""
    shape: Literal["cosine", "smooth"] = "cosine"
    """``h sin^2(pi x / L)``, whose curvature begins at once and makes what passes ring; or ``h sin^4(pi x / L)``, whose
    curvature begins gently."""

    def profile(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Stations and heights [m], near enough that chords are off by 2e-5 of the height at most."""
        share = np.linspace(0.0, 1.0, CHORDS + 1)
        height = np.sin(np.pi * share) ** (2 if self.shape == "cosine" else 4)
        return self.start + self.length * share, self.height * height


@dataclass(frozen=True)
class _GridFile(TableFile):
    """A table whose rows are the points of a grid, one line of it after the other."""

    may_repeat: ClassVar[bool] = True
    """Whether the first column may keep its value from row to row."""

    @staticmethod
    def check(columns: Sequence[Sequence[float]]) -> None:
        """Refuse what is no grid."""
        _unfold(*(np.array(column, dtype=np.float64) for column in columns))


Array = NDArray[np.float64]


def _unfold(stations: Array, offsets: Array, heights: Array) -> tuple[Array, Array, Array]:
    """Stations, offsets and heights of a grid, of shapes (n,), (m,) and (n, m), from those of its points.

    Raises
    ------
    InputError
        If points are missing, too many, or not in their order.
    """
    begins = np.flatnonzero(np.diff(stations, prepend=-np.inf) > 0.0)
    count = int(begins[1]) if len(begins) > 1 else len(stations)
    line = offsets[:count]
    for first, last in zip(begins, [*begins[1:], len(stations)], strict=True):
        if last - first != count or np.any(offsets[first:last] != line):
            raise InputError(
                f"station {stations[first]:g} m has other offsets than the {count} of station {stations[0]:g} m",
                expected="a rectangle: all offsets at every station, in one order",
            )
    _check_lines(stations[begins], line)
    return stations[begins], line, heights.reshape(len(begins), count)


def _check_lines(stations: Sequence[float] | Array, offsets: Sequence[float] | Array) -> None:
    """Two or more of both, increasing."""
    for key, line in (("stations", stations), ("offsets", offsets)):
        if len(line) < 2:
            raise InputError(f"{len(line)} {key}", key=key, expected="two or more")
        fall = next((i for i in range(1, len(line)) if not line[i] > line[i - 1]), 0)
        if fall:
            raise InputError(
                f"{line[fall]:g} follows {line[fall - 1]:g}",
                key=f"{key}.{fall}",
                expected=f"{key} that increase",
            )


@TRANSPORT.part
@dataclass(frozen=True, eq=False)
class HeightGrid:
    """Heights over a rectangle of a deck, whose first and last stations and offsets are its borders.

    Each cell of the grid is four plane triangles about its middle, which is as high as the mean of its corners. From
    the surface that is linear in both directions (bilinear) they differ by a sixteenth of ``h00 - h10 - h01 + h11`` at
    most.
    """

    file: Annotated[
        str | None, _GridFile((("station", "offset", "height"),), ("stations", "offsets", "heights"))
    ] = None
    """Comma-separated with the header ``station,offset,height`` [m] and a row for each point: all offsets, increasing,
    at the first station, then the same offsets at the next one, and so on."""
    stations: Annotated[Array, Quantity("length"), Shape((None,))] = field(default_factory=no_rows)
    """In place of `file`: along the deck [m], increasing."""
    offsets: Annotated[Array, Quantity("length"), Shape((None,))] = field(default_factory=no_rows)
    """To the left of the line of the origin [m], increasing."""
    heights: Annotated[Array, Quantity("length"), Shape((None, None))] = field(default_factory=no_rows)
    """[m], a row for each station, in it a number for each offset."""

    @staticmethod
    def check(spec: Any) -> None:
        """A rectangle."""
        inline = len(spec.stations) + len(spec.offsets) + len(spec.heights) > 0
        if inline == (spec.file is not None):
            problem = "both 'file' and 'stations'" if inline else "neither 'file' nor 'stations'"
            raise InputError(problem, key="file", expected="a grid of heights: one of them")
        if not inline:
            return
        _check_lines(spec.stations, spec.offsets)
        if len(spec.heights) != len(spec.stations):
            raise InputError(
                f"{len(spec.heights)} rows of heights at {len(spec.stations)} stations",
                key="heights",
                expected="a row for each station",
            )
        for i, row in enumerate(spec.heights):
            if len(row) != len(spec.offsets):
                raise InputError(
                    f"{len(row)} heights at {len(spec.offsets)} offsets",
                    key=f"heights.{i}",
                    expected="a height for each offset",
                )

    def __post_init__(self) -> None:
        """A file has a row for each point."""
        rows = np.asarray(self.heights, dtype=np.float64)
        if rows.ndim == 1:
            unfolded = (
                _unfold(self.stations, self.offsets, rows)
                if len(rows)
                else (*self.table[:2], np.zeros((0, 0)))
            )
            for key, value in zip(("stations", "offsets", "heights"), unfolded, strict=True):
                object.__setattr__(self, key, value)

    @property
    def table(self) -> tuple[Array, Array, Array]:
        """Stations, offsets and heights [m], of shapes (n,), (m,) and (n, m)."""
        x, y, heights = (np.asarray(v, dtype=np.float64) for v in (self.stations, self.offsets, self.heights))
        return x, y, heights

    @cached_property
    def numbers(self) -> Array:
        """`table` in one line."""
        return np.concatenate([part.ravel() for part in self.table])


@TRANSPORT.part
@dataclass(frozen=True, eq=False)
class OilPump:
    """Oil that is pumped into a group, as the lift of all bogies of the group."""

    times: Annotated[NDArray[np.float64], Quantity("time"), Shape((None,)), Least(1)]
    """[s], increasing."""
    lifts: Annotated[NDArray[np.float64], Quantity("length"), Shape((None,))]
    """[m], linear between the times, held before the first and after the last."""

    @staticmethod
    def check(spec: Any) -> None:
        """A lift a time."""
        check_table("times", spec.times, "lifts", spec.lifts)


@TRANSPORT.part
@dataclass(frozen=True)
class Levelling:
    """Pumps that keep a vehicle level: they sample its tilt at intervals, and lift and lower its groups."""

    speed: Annotated[float, Positive("velocity")]
    """At which a pump lifts the bogies of a group at most [m/s]: its flow over the area of all their cylinders."""
    time_constant: Annotated[float, Positive("time")] = 10.0
    """In which a tilt is to fall to ``1/e`` [s]; it is faster as the vehicle leans more than its groups. Too short a
    one drives the vehicle, which is refused."""
    period: Annotated[float, Positive("time")] = 0.1
    """Between two samples [s], at the ends of steps; speeds are constant in between."""
    dead_angle: Annotated[float, Quantity("angle", minimum=0.0, closed=True)] = 0.0
    """Tilts that are left alone [rad]."""
    roll: Annotated[float, Quantity("angle")] = 0.0
    """That is kept [rad]: rise of the left side."""
    pitch: Annotated[float, Quantity("angle")] = 0.0
    """That is kept [rad]: dip of the front."""


@TRANSPORT.part
@dataclass(frozen=True, eq=False)
class BogieGroup:
    """Bogies whose cylinders share their oil: one pressure."""

    name: str
    bogies: Annotated[NDArray[np.float64], BodyPoint(), Shape((None, 3)), Least(1)]
    """Where the wheels of each bogie touch the road at the start, in the coordinates of the geometry of the body that
    rides on them [m]."""
    oil_stiffness: Annotated[float, Positive("stiffness"), Absent()] = 0.0
    """Of oil and hoses [N/m]: force of a bogie by its stroke if all bogies of the group move together."""
    gas_length: Annotated[float, Positive("length"), Absent()] = 0.0
    """In place of `oil_stiffness`, a gas accumulator: its gas volume at the start, over the area of a cylinder and the
    number of bogies [m]."""
    constant_force: bool = False
    """In place of both, cylinders that push with the force of the start whatever their strokes: unlike oil, and
    unstable alone."""
    relief_force: Annotated[float, Positive("force"), Absent()] = np.inf
    """Of a cylinder at which the relief valve opens [N]: oil beyond it is lost."""
    leak_speed: Annotated[float, Quantity("velocity", minimum=0.0, closed=True)] = 0.0
    """Rate at which all its bogies sink by leaking oil at the force of the start [m/s]; proportional to the force."""
    load: Annotated[float, Quantity("force", minimum=0.0, closed=True), Absent()] = np.nan
    """Force of a bogie at the start [N]; without it the groups carry the weight of the body, all bogies as evenly as
    the balance allows."""
    pump: OilPump | None = None
    """How its oil changes."""

    @staticmethod
    def check(spec: Any) -> None:
        """Oil, or gas, or a constant force."""
        given = [key for key in ("oil_stiffness", "gas_length") if getattr(spec, key) is not None]
        given += ["constant_force"] * bool(spec.constant_force)
        if len(given) != 1:
            problem = (
                f"{' and '.join(map(repr, given))}" if given else "no 'oil_stiffness' and no 'gas_length'"
            )
            raise InputError(problem, key="oil_stiffness", expected="one of 'oil_stiffness' and 'gas_length'")
        if spec.constant_force:
            more = {
                "relief_force": spec.relief_force,
                "leak_speed": spec.leak_speed or None,
                "pump": spec.pump,
            }
            key = next((key for key, value in more.items() if value is not None), "")
            if key:
                raise InputError(f"{key!r} with a constant force", key=key, expected="oil or gas")


@TRANSPORT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class PathLeg:
    """A leg of the path of a transporter, from rest to rest, in the plan of the ground and the decks at the start."""

    steering: Literal["all", "front", "rear", "crab", "carousel"] = "all"
    """All bogies steer, and their middle follows the curve; or all but the last line, or all but the first,
    whose own middle follows it; or all are parallel and the vehicle does not turn; or it turns about `centre`."""
    points: Annotated[NDArray[np.float64], Quantity("length"), Shape((None, 2))] = field(
        default_factory=no_rows
    )
    """Where the curve goes, ahead of and to the left of what follows it [m], in the axes of the vehicle as it stands
    where the leg begins; the begin itself, [0, 0], is none of them."""
    curve: Literal["corners", "smooth"] = "corners"
    """Straight between the points, with arcs of `radius` at them; or a smooth curve through them."""
    radius: Annotated[float, Positive("length"), Absent()] = 0.0
    """Of the arcs at corners [m]."""
    transition: Annotated[float, Quantity("length", minimum=0.0, closed=True)] = 0.0
    """Way within which the curvature grows to that of an arc, and falls again behind it [m]: a clothoid. Without it
    wheels would have to steer at once."""
    turn: Annotated[float, Quantity("angle"), Absent()] = 0.0
    """Of a carousel, to the left [rad]."""
    centre: Annotated[NDArray[np.float64], Quantity("length"), Shape((2,))] = field(
        default_factory=lambda: np.zeros(2)
    )
    """About which it turns, ahead of and to the left of the middle of its bogies [m]."""
    speed: Annotated[float, Positive("velocity")]
    """[m/s]; in a carousel of the bogie farthest from the centre."""
    acceleration: Annotated[float, Positive("acceleration")] = 0.05
    """With which it reaches its speed and stops again [m/s2]."""
    pause: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """Before it [s]."""

    @staticmethod
    def check(spec: Any) -> None:
        """A curve, or a turn."""
        carousel = spec.steering == "carousel"
        if carousel and not spec.turn:
            raise InputError("a carousel without turn", key="turn", expected="the angle by which it turns")
        if carousel == (len(spec.points) > 0):
            problem = "a carousel with 'points'" if carousel else "no points"
            raise InputError(
                problem, key="points", expected="'points' of all but a carousel, which has a 'turn'"
            )
        if not carousel and (spec.turn or (named(spec, "centre") and np.any(spec.centre))):
            key = "turn" if spec.turn else "centre"
            raise InputError(
                f"a {key!r} with steering {spec.steering!r}", key=key, expected="steering 'carousel'"
            )
        if spec.curve == "smooth" and (spec.radius or spec.transition):
            raise InputError("a smooth curve with a 'radius'", key="radius", expected="one of them")


@TRANSPORT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class Drive:
    """Motors and brakes: all driven bogies push with one force, as hydraulic motors in parallel do."""

    bogies: tuple[int, ...] = ()
    """Numbers of the driven bogies, from 1 on in the order of the groups; all if absent."""
    rolling_resistance: Annotated[float, Quantity("number", minimum=0.0, closed=True)] = 0.02
    """Over the load of a bogie."""
    friction: Annotated[float, Positive("number")] = 0.3
    """Of tyres on the road: a bogie can push and brake with that share of its load."""
    speeds: Annotated[NDArray[np.float64], Quantity("velocity", minimum=0.0, closed=True), Shape((None,))] = (
        field(default_factory=no_rows)
    )
    """Of a wheel, increasing from 0 [m/s], up to its fastest."""
    forces: Annotated[NDArray[np.float64], Quantity("force", minimum=0.0), Shape((None,))] = field(
        default_factory=no_rows
    )
    """Largest force of a driven bogie [N], one a speed, linear between them; without a table it is not limited."""
    brake_force: Annotated[float, Positive("force"), Absent()] = np.inf
    """With which the brakes of a driven bogie hold at rest [N]."""

    @staticmethod
    def check(spec: Any) -> None:
        """Numbers of bogies, once each; a table from rest on."""
        if any(number < 1 for number in spec.bogies) or len(set(spec.bogies)) < len(spec.bogies):
            raise InputError(f"{list(spec.bogies)}", key="bogies", expected="numbers from 1 on, each once")
        check_table("speeds", spec.speeds, "forces", spec.forces)
        if len(spec.speeds) and spec.speeds[0] != 0.0:
            raise InputError(
                f"they begin at {spec.speeds[0]:g} m/s", key="speeds", expected="speeds from 0 on"
            )


@TRANSPORT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class Tyres:
    """Tyres with side slip, all alike: side forces by the angle between rolling direction and velocity of a bogie."""

    cornering: Annotated[float, Positive("number")]
    """C: side force of a bogie over its load and the tangent of its slip angle; 5 to 10."""
    relaxation_length: Annotated[float, Positive("length")] = 0.3
    """sigma, way in which the side force comes up to ``1 - 1/e`` [m]. A tread that does not roll has the stiffness
    ``C f / sigma``."""
    damping_time: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.01
    """tau: damping of a tread over its stiffness [s]; it does not change steady forces."""
    steering_errors: Annotated[NDArray[np.float64], Quantity("angle"), Shape((None,))] = field(
        default_factory=no_rows
    )
    """By which bogies are off their steering, to the left [rad]: one for all, or one each, as groups list them."""

    @staticmethod
    def check(spec: Any) -> None:
        """Errors that are none of a wheel that stands across."""
        worst = max((abs(float(error)) for error in spec.steering_errors), default=0.0)
        if worst >= 0.25 * np.pi:
            raise InputError(
                f"{np.degrees(worst):.6g} degrees", key="steering_errors", expected="less than 45 degrees"
            )


# ---- what a transporter records, in this order ----

OF_WHEELS = "of all wheels, at the ends of all steps"
OF_BOGIES = "of all bogies, at the ends of all steps"
OF_MIDDLES = "of the middles of all steps"


@outputs
class TransporterOutputs(Outputs):
    """Of every transporter."""

    heave: float = channel("length", "rise since the start of the middle of the places of all bogies")
    roll: float = channel(
        "angle", "rise of the left side of the vehicle since the start, against the horizontal"
    )
    pitch: float = channel("angle", "dip of the front of the vehicle since the start, against the horizontal")
    least_share: float = channel("number", "smallest load of a group over that of all")
    load_max: float = largest("force", "load", seen=OF_WHEELS)
    load_min: float = smallest("force", "load", seen=OF_WHEELS)
    stroke_max: float = largest("length", "stroke", seen=OF_BOGIES)
    stroke_min: float = smallest("length", "stroke", seen=OF_BOGIES)


@outputs
class BogieParts(Parts):
    """Of each group and each bogie."""

    group_force: Part = channel("force", "force of a cylinder of each group", None)
    wheel_load: Part = channel("force", "load of each bogie on the road, with its own weight", None)
    road_under: Part = channel("length", "height of the road for each wheel over that of its deck", None)
    stroke_of: Part = channel("length", "stroke of each bogie from its place at the start, up", None)


@outputs
class PathOutputs(Outputs):
    """Of a transporter with a path."""

    path_way: float = channel("length", "distance along its path")
    off_path: float = channel("length", "distance of the middle of its bogies from its path")
    off_heading: float = channel("angle", "by which its heading is off its path, to the left")
    push_along: float = channel("force", "on it in the plane, forwards, from drives and brakes")
    push_across: float = channel("force", "on it in the plane, to the left, from its wheels")
    push_turning: float = channel(
        "moment or energy", "on it in the plane, to the left, about the middle of its bogies"
    )


@outputs
class SteeringParts(Parts):
    """Of each bogie of a transporter with a path."""

    steering: Part = channel("angle", "of each bogie, to the left", None)
    rolling_speed: Part = channel("velocity", "of the wheels of each bogie", None)


@outputs
class DriveOutputs(Outputs):
    """Of a transporter with a drive."""

    drive_demand: float = channel(
        "force", "of all driven bogies, along the path, in the middle of the last step"
    )
    bogie_drive: float = channel("force", "of each driven bogie in the middle of the last step")
    bogie_drive_max: float = largest("force", "bogie_drive", seen=OF_MIDDLES)
    bogie_drive_min: float = smallest("force", "bogie_drive", seen=OF_MIDDLES)
    traction_used_max: float = channel(
        "number",
        "force of a driven bogie over what friction allows, largest of all bogies and steps since the last record; "
        "with `tyres` of any bogie, with its side force",
    )
    drive_used_max: float = channel(
        "number", "over what its drive can at its speed, largest since the last record"
    )
    brake_used_max: float = channel(
        "number", "at rest, over what its brakes hold, largest since the last record"
    )


@outputs
class TyreParts(Parts):
    """Of each bogie of a transporter with tyres that slip."""

    side_force: Part = channel(
        "force", "of the tyres of each bogie, to the left of its wheels, in the last step", None
    )
    slip_angle: Part = channel("angle", "of each bogie: its velocity is left of its wheels by that", None)


@outputs
class LevellingParts(Parts):
    """Of each group of a transporter with levelling."""

    levelled: Part = channel("length", "by which levelling has lifted the bogies of each group", None)
