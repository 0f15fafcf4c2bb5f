"""Descriptions of components between bodies: joints, ropes, springs, drives and motors, in SI units.

Every joint has a *joint frame* on either side: a point and three axes, in the frame of the body (in
world axes on the ground). The joint is closed when the two frames fit, each type in its own way.
"""

from __future__ import annotations

from dataclasses import field
from enum import Enum
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import (
    Absent,
    BodyDirection,
    BodyPoint,
    NameOf,
    Positive,
    Quantity,
    Shape,
)
from heavylift.solver.scene.bodies import GROUND
from heavylift.solver.scene.descriptions import (
    XYZ,
    ChannelKind,
    Family,
    check_table,
    no_rows,
    upwards,
)
from heavylift.solver.scene.drawn import At, Axes, Element, Mark, RopeLine, Stop, Strut, Text
from heavylift.solver.scene.outputs import (
    Components,
    Outputs,
    Part,
    Parts,
    channel,
    largest,
    outputs,
    smallest,
)
from heavylift.solver.scene.speed_profiles import check_speeds, planned_moves, speed_pieces

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

__all__ = [
    "FORCES",
    "GROUND",
    "JOINTS",
    "MEASURES",
    "ROPES",
    "ROW_JOINTS",
    "ROW_WORDS",
    "AlongJoint",
    "AlongPath",
    "AngleOutputs",
    "Between",
    "ControlOutputs",
    "EdgeJoint",
    "ForceElement",
    "Joint",
    "JointFrame",
    "Limits",
    "OnBody",
    "PackedForce",
    "Place",
    "ReactionOutputs",
    "RopeOutputs",
    "RopeParts",
    "RopePoint",
    "Rows",
    "SheaveParts",
    "Stage",
    "ThrustOutputs",
    "TorqueOutputs",
    "TravelOutputs",
    "Winch",
    "as_joint",
    "axes_about",
    "check_path",
    "controlled",
    "rope_components",
    "rubbing_places",
]


class Place(Enum):
    """What a case file gives for where a joint is."""

    POINT = "point"
    """A point for both sides, or one each."""
    AXIS = "axis"
    """And an axis for both sides, or one each: z of the joint frames."""
    CROSS = "cross"
    """And a second axis for the other side."""
    APART = "apart"
    """Two points."""
    EDGE = "edge"
    """Edges of shells."""


Rows = tuple[tuple[str, ...], ...]
"""Words of rows, each with its directions, see `Joint.ROWS`."""

ROW_WORDS: Mapping[str, tuple[bool, ...]] = {
    "point": (False, False, False),
    "parallel": (True, True),
    "travel": (False,),
    "square": (True,),
}
"""Whether each of the rows that a word stands for is an angle."""
ROW_DIRECTIONS: Mapping[str, tuple[str, ...]] = {
    "point": (),
    "parallel": ("xyz",),
    "travel": ("xyzmn",),
    "square": ("xyz", "xyz"),
}
"""Directions that go with a word."""
ROW_JOINTS = "heavylift.solver.joints.row_joints"
"""Module of the kind of joints that are a list of rows."""


@outputs
class ReactionOutputs(Outputs):
    """What every joint records."""

    reaction_force: Components = channel("force", "force on side b, world axes", XYZ)
    reaction_moment: Components = channel(
        "moment or energy", "moment on side b at its point, world axes", XYZ
    )


@outputs
class AngleOutputs(Outputs):
    """What a joint records whose sides turn about one axis."""

    angle: float = channel("angle", "angle of side b to side a about the axis of the joint")
    angular_rate: float = channel("angular velocity", "rate of that angle")


@outputs
class TravelOutputs(Outputs):
    """What a joint records whose sides slide along one axis."""

    travel: float = channel("length", "travel of side b to side a along the axis of the joint")
    travel_rate: float = channel("velocity", "rate of that travel")


@outputs
class TorqueOutputs(Outputs):
    """Of what acts about the axis of a joint."""

    load: float = channel("moment or energy", "torque about the axis of the joint on its side b")


@outputs
class ThrustOutputs(Outputs):
    """Of what acts along the axis of a joint; kernels write it as `TorqueOutputs`."""

    load: float = channel("force", "force along the axis of the joint on its side b", by_owner=True)


@outputs
class RopeOutputs(Outputs):
    """What all ropes record, before `RopeParts`."""

    tension: float = channel("force", "tension of the rope, the largest of its segments")
    length: float = channel("length", "length of the rope along its path")
    rest_length: float = channel("length", "unstretched length of the rope")
    drift: float = channel(
        "length", "length of the rope along its path less the stretched length that its tension belongs to"
    )
    strain: float = channel(
        "number",
        "elastic strain of the rope, mean of its segments: that of its tension without damping; 0 if slack",
    )
    tension_max: float = largest("force", "tension")
    tension_min: float = smallest("force", "tension")


@outputs
class RopeParts(Parts):
    """What all ropes record of their segments."""

    segment_tension: Part = channel(
        "force", "tension of each segment of the rope, from its first end on", None
    )


@outputs
class SheaveParts(Parts):
    """Of wire ropes over places with an efficiency."""

    sheave_speed: Part = channel(
        "velocity",
        "speed at which the rope runs over each place with an efficiency, towards its last end",
        None,
    )
    sheave_state: Part = channel(
        "number",
        "of each place with an efficiency: 0 if the rope sticks there, 1 or -1 if it slides, towards its last or its"
        " first end",
        None,
    )
    segment_tension_max: Part = largest("force", "segment_tension", None)
    segment_tension_min: Part = smallest("force", "segment_tension", None)


@outputs
class ControlOutputs(Outputs):
    """Of wire ropes whose winch answers to their tension."""

    paid_out: float = channel(
        "length", "what a brake or a winch that keeps a tension has paid out beyond its plan"
    )
    paying_speed: float = channel("velocity", "rate of that, mean of the last step")


@dataclass(frozen=True, eq=False)
class JointFrame:
    """Point [m], shape (3,), and axes x, y, z as columns, shape (3, 3), in the frame of a body."""

    point: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    axes: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))


def axes_about(
    axis: NDArray[np.float64], reference: NDArray[np.float64] | None = None, *, source: str = "joint"
) -> NDArray[np.float64]:
    """Right-handed unit axes with z along `axis` and x as near to `reference` as possible, columns, shape (3, 3).

    Parameters
    ----------
    axis
        Any length, shape (3,).
    reference
        Shape (3,); chosen if None.
    source
        Name for the message.

    Raises
    ------
    InputError
        If the axis has length zero or is not finite, or the reference is parallel to it.
    """
    z = np.asarray(axis, dtype=np.float64)
    length = float(np.linalg.norm(z))
    if not (0.0 < length < np.inf):
        raise InputError(
            f"axis {z.tolist()}", source=source, key="axis", expected="a direction that is not zero"
        )
    z = z / length
    given = np.eye(3)[np.argmin(np.abs(z))] if reference is None else np.asarray(reference, dtype=np.float64)
    x = given - (given @ z) * z
    if not np.linalg.norm(x) > 1e-9 * np.linalg.norm(given):
        raise InputError(
            f"reference {given.tolist()} is parallel to the axis",
            source=source,
            key="reference",
            expected="a direction across the axis",
        )
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


@dataclass(frozen=True)
class Limits:
    """Stops of an angle [rad] or travel [m]: a spring [N m/rad] or [N/m] and damper beyond each end."""

    lower: float = -np.inf
    upper: float = np.inf
    stiffness: float = 0.0
    damping: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Joint:
    """What all joints have. Each type is a subclass in a file of `heavylift.solver.joints`, see `JOINTS`.

    Attributes
    ----------
    name
        Prefix of its channels.
    body_a, body_b
        Names; one of them may be `GROUND`.
    frame_a, frame_b
        Joint frames on the two bodies.
    compliance
        Physical compliance of its rows (the ``epsilon`` of the thesis) [m/N] or [rad/(N m)]; 0 is rigid.
    relaxation
        Time in which a violation decays (its ``tau``) [s]; a compliant joint is damped by it.
    """

    WORD: ClassVar[str]
    """Its type in a case file."""
    PLACE: ClassVar[Place] = Place.POINT
    """What a case file gives for where it is."""
    ROWS: ClassVar[Rows] = ()
    """Its rows in order, if it is a list of them and needs no kernels of its own: ``("point",)``, ``p_b - p_a = 0``,
    three rows, which come first; ``("parallel", d)``, the axes d of both sides are, two rows; ``("travel", d)``,
    ``d_a . (p_b - p_a) = 0``; ``("square", d, e)``, ``d_a . e_b = 0``.
    Directions are the axes x, y, z of the joint frames, and of a travel m and n too: across that of the joint."""
    ROTATIONAL: ClassVar[tuple[bool, ...]] = ()
    """Whether each of its rows is an angle, not a length; follows from `ROWS`."""
    CHANNELS: ClassVar[tuple[ChannelKind, ...]] = ReactionOutputs.CHANNELS
    """What it records, in the order of its columns."""
    COORDINATE: ClassVar[Literal["", "angle", "travel"]] = ""
    """The one scalar on which springs, motors, stops and friction act, if it has one."""

    name: str
    body_a: str
    body_b: str
    frame_a: JointFrame = field(default_factory=JointFrame)
    frame_b: JointFrame = field(default_factory=JointFrame)
    compliance: float = 0.0
    relaxation: float = 0.0

    def __init_subclass__(cls) -> None:
        """Complete a description.

        Raises
        ------
        TypeError
            If there is no such row.
        """
        super().__init_subclass__()
        if "ROWS" not in vars(cls):
            return
        for place, (word, *axes) in enumerate(cls.ROWS):
            known = ROW_DIRECTIONS.get(word)
            fits = known is not None and len(axes) == len(known)
            if not fits or not all(a in of for a, of in zip(axes, known or (), strict=True)):
                raise TypeError(f"{cls.__qualname__}: no row is {' '.join((word, *axes))!r}")
            if word == "point" and place > 0:
                raise TypeError(f"{cls.__qualname__}: the rows of the point come first")
        cls.ROTATIONAL = tuple(turns for word, *_ in cls.ROWS for turns in ROW_WORDS[word])

    @property
    def kind_module(self) -> str:
        """Module with the function `pack` that makes the kind of such joints."""
        return ROW_JOINTS if self.ROWS else type(self).__module__

    @property
    def rotational(self) -> tuple[bool, ...]:
        """Whether each of its rows is an angle."""
        return self.ROTATIONAL

    @property
    def travel_axis(self) -> NDArray[np.float64]:
        """Direction of its travel in the joint frame of a, any length, shape (3,)."""
        return np.array([0.0, 0.0, 1.0])

    def drawn(self) -> Iterable[Element]:
        """A dot at its first side, a line to the other one, and its axes."""
        a, b = At(self.body_a, self.frame_a.point), At(self.body_b, self.frame_b.point)
        yield Strut(name=self.name, role="joint", ends=(a, b))
        yield Mark(name=self.name, role="joint", at=a)
        yield Axes(name=self.name, role="axes", at=a, axes=self.frame_a.axes)
        yield Text(name=self.name, role="joint", at=a, text=f"{self.name} ({self.WORD})")


def _no_nodes() -> NDArray[np.int64]:
    return np.zeros(0, dtype=np.int64)


@dataclass(frozen=True, eq=False, kw_only=True)
class EdgeJoint(Joint):
    """An edge of a shell on the ground, a body or the edge of another shell.

    All along the edge, not in its nodes alone: nodes and tangents of the edge are kept. It stays straight on a
    rigid or floating body, and bends with the edge of another shell. Joint frames are not used; what counts is
    how the bodies stand at the start. Reactions are those of each node: ``name.0``, ``name.1``, ...

    Attributes
    ----------
    nodes_a
        Numbers of nodes of the shell `body_a` along the edge, in order, shape (n,).
    nodes_b
        Those of `body_b` at the same places, if that is a shell.
    """

    PLACE: ClassVar = Place.EDGE

    nodes_a: NDArray[np.int64]
    nodes_b: NDArray[np.int64] = field(default_factory=_no_nodes)


JOINTS: Family[Joint] = Family("joint", "heavylift.solver.joints")
"""All joints, by their types in a case file."""


class Stage(Enum):
    """When a force element is packed: forces on a body are added up in this order."""

    LOADS = "loads"
    """First of all: given forces, gravity."""
    FORCES = "forces"
    """After the loads of wind and current: what acts on points alone, or only watches."""
    ROWS = "rows"
    """After joints: what has rows, or acts along a joint."""


class ForceElement:
    """Base of what acts on bodies or between them, or only watches them: all there is beside bodies and joints.

    Its module has a function ``pack(things, context)``, which makes the kind of all of them in a scene; see
    `heavylift.solver.force_elements.packing.PackingContext`.
    """

    STAGE: ClassVar[Stage] = Stage.ROWS
    """When it is packed."""
    NOT_LINEAR: ClassVar[str] = ""
    """Why no stiffness and damping stand for its small motions, as words that follow its name; empty if they do."""

    def packed_by(self, integrator: str) -> str:
        """Name of the module with the `pack` of its kind, with an integrator."""
        del integrator
        return type(self).__module__

    def obstacle(self, integrator: str) -> str:
        """What about it an integrator cannot serve, as words that follow its name; empty if there is nothing."""
        del integrator
        return ""

    @property
    def watched_ropes(self) -> tuple[str, ...]:
        """Names of the ropes of which it wants to know what they pull with."""
        return ()


@dataclass(frozen=True, eq=False)
class OnBody(ForceElement):
    """What all have that is on one body.

    Attributes
    ----------
    name
        Its own name.
    body, point
        Name of the body, and point in its frame [m], shape (3,).
    """

    name: str
    body: Annotated[str, NameOf("body")]
    """Body that it is on."""
    point: Annotated[NDArray[np.float64], BodyPoint()]
    """Point in the coordinates of the geometry of the body [m]."""

    def drawn(self) -> Iterable[Element]:
        """Nothing."""
        return ()


@dataclass(frozen=True, eq=False, kw_only=True)
class Between(ForceElement):
    """What all have that is between two points.

    Attributes
    ----------
    name
        Prefix of its channels.
    body_a, point_a, body_b, point_b
        Ends: body (or `GROUND`) and point in its frame [m], shape (3,).
    """

    name: str
    body_a: str
    point_a: NDArray[np.float64]
    body_b: str
    point_b: NDArray[np.float64]

    @staticmethod
    def check_sides(between: tuple[str, str]) -> None:
        """Two sides are two different bodies, or a body and the world.

        Raises
        ------
        InputError
            If they are not.
        """
        if between == (GROUND, GROUND):
            raise InputError("both sides are the ground", expected="at least one body")
        if between[0] == between[1]:
            raise InputError(
                f"both sides are {between[0]!r}", expected="two different bodies, or a body and 'ground'"
            )

    @property
    def sides(self) -> tuple[At, At]:
        """Its two points."""
        return At(self.body_a, self.point_a), At(self.body_b, self.point_b)

    def drawn(self) -> Iterable[Element]:
        """A line between its points; of a measure, which pulls at nothing, its name alone."""
        if getattr(self, "FAMILY", None) is not MEASURES:
            yield Strut(name=self.name, role="spring", ends=self.sides)
        yield Text(name=self.name, role="spring", at=self.sides[0], text=self.name)


def as_joint(spring: Between) -> Joint:
    """What is between two points as a joint that frees everything: its two sides and points."""
    return Joint(
        name=spring.name,
        body_a=spring.body_a,
        body_b=spring.body_b,
        frame_a=JointFrame(np.asarray(spring.point_a, dtype=np.float64)),
        frame_b=JointFrame(np.asarray(spring.point_b, dtype=np.float64)),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class AlongJoint(ForceElement):
    """What all loads have on the angle of a hinge [rad] or the travel of a slider [m].

    Attributes
    ----------
    name, joint
        Its own name and that of the joint.
    """

    CHANNEL_BY_COORDINATE: ClassVar = {
        "angle": TorqueOutputs.CHANNELS[0],
        "travel": ThrustOutputs.CHANNELS[0],
    }
    """What it records, by the coordinate of its joint; one with `CHANNELS` records these."""

    name: str
    joint: Annotated[str, NameOf("joint")]
    """A hinge, whose angle [rad] counts, or a slider, whose travel [m] counts."""

    def drawn(self) -> Iterable[Element]:
        """Nothing beside its joint."""
        return ()


class PackedForce(ForceElement):
    """Base of forces on points without rows, and of what only watches, beside one of the places above.

    Its kind implements `add_forces` and `record_forces`.
    """

    STAGE: ClassVar[Stage] = Stage.FORCES
    CHANNELS: ClassVar[tuple[ChannelKind, ...]]
    """What it records, in the order of its columns."""

    name: str


FORCES: Family[Any] = Family(
    "force", "heavylift.solver.forces", "heavylift.solver.force_elements", default="point"
)
"""All forces on bodies, between two points and along joints, by their types in a case file; those that are
rows with a law stand among the laws."""


MEASURES: Family[Any] = Family("table", "heavylift.solver.sensors", typed=False)
"""What only watches several bodies, by the list of a case file in which it stands; packed as forces are."""


ROPES: Family[Any] = Family("rope", "heavylift.solver.force_elements", default="wire")
"""All ropes, by their types in a case file; each has a `path`, and a stiffness of its own or of its length."""


@ROPES.part
@dataclass(frozen=True, eq=False)
class RopePoint:
    """A place the rope passes: an end, an eye, or a pulley."""

    body: Annotated[str, NameOf("side")]
    """Body that carries it, or ``"ground"``."""
    point: Annotated[NDArray[np.float64], BodyPoint()]
    """The place, of a pulley its centre [m], in the coordinates of the geometry of the body, or the name of an
    interface of it; of the ground in the world."""
    radius: Annotated[float, Quantity("length", minimum=0.0, closed=True)] = 0.0
    """Of the pulley [m]; 0 for an end or an eye."""
    axis: Annotated[NDArray[np.float64], BodyDirection(), Absent()] = field(default_factory=upwards)
    """Of the pulley, in the coordinates of the geometry of the body; of the ground in the world. The rope runs about
    the pulley in the sense of a turn about this axis."""
    efficiency: Annotated[float, Quantity("number", minimum=0.5, maximum=1.0, closed=True)] = 1.0
    """Of a pulley or an eye, the smaller over the larger tension of the rope on its two sides while it runs; at rest
    any ratio from this to its inverse holds it. 0.98 of sheaves on roller bearings, 0.96 on plain ones."""
    friction: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0, closed=True)] = 0.0
    """In place of `efficiency`, of a sheave that does not turn, or a yoke: coefficient of friction of the rope that
    slips over it, of steel 0.1 to 0.2. The efficiency is ``exp(-friction wrap)``, with the wrap as it is."""

    @staticmethod
    def check(spec: Any) -> None:
        """A pulley has an axis, an eye has none; friction needs a wrap, and says the efficiency."""
        if spec.radius > 0.0 and spec.axis is None:
            raise InputError(
                "a pulley without 'axis'", key="axis", expected="the direction about which the rope turns"
            )
        if spec.radius == 0.0 and spec.axis is not None:
            raise InputError(
                "'axis' without 'radius'", key="axis", expected="'radius' and 'axis' of a pulley, or neither"
            )
        if spec.friction > 0.0 and spec.radius == 0.0:
            raise InputError(
                "'friction' without 'radius'", key="friction", expected="'radius' and 'axis', or 'efficiency'"
            )
        if spec.friction > 0.0 and spec.efficiency < 1.0:
            raise InputError(
                "both 'friction' and 'efficiency'",
                key="friction",
                expected="one of them: it follows from friction",
            )


class AlongPath:
    """Base of ropes, which run along a path or several legs.

    A rope has `name`, `path`, and `legs` of its own if it is several lines.
    """

    @property
    def legs(self: Any) -> Sequence[tuple[RopePoint, ...]]:
        """Places of each line, from end to end."""
        return (self.path,)

    def drawn(self: Any) -> Iterable[Element]:
        """A rope along each leg about its pulleys."""
        several = len(self.legs) > 1
        for number, leg in enumerate(self.legs):
            stops = tuple(Stop(At(stop.body, stop.point), stop.radius, stop.axis) for stop in leg)
            yield RopeLine(
                name=self.name,
                role="rope",
                stops=stops,
                tension=f"{self.name}.{'segment_tension' if several else 'tension'}",
                component=number if several else None,
            )
        for k, stop in enumerate(self.legs[0]):
            text = self.name if k == 0 else f"{self.name}, {k + 1}"
            yield Text(name=self.name, role="rope", at=At(stop.body, stop.point), text=text)


@ROPES.part
@dataclass(frozen=True, eq=False)
class Winch:
    """How a winch hauls in: its speed, the length or the tension of the rope, at some times; or as another one."""

    times: Annotated[NDArray[np.float64], Quantity("time"), Shape((None,))] = field(default_factory=no_rows)
    """[s], increasing."""
    speeds: Annotated[NDArray[np.float64], Quantity("velocity"), Shape((None,))] = field(
        default_factory=no_rows
    )
    """[m/s], linear between the times, held before the first and after the last; hauls in if positive."""
    lengths: Annotated[NDArray[np.float64], Positive("length"), Shape((None,))] = field(
        default_factory=no_rows
    )
    """In place of `speeds`, unstretched lengths of the rope [m]: it begins and ends at rest, its speed has no jumps,
    and its length between two times is between those at them."""
    speed: Annotated[float | None, Positive("velocity")] = None
    """With `tensions` the largest one. With `lengths` and `acceleration` that of moves from rest to rest, which begin
    at the times; the first length is that at the start."""
    acceleration: Annotated[float | None, Positive("acceleration")] = None
    """Of all changes of the speed: `speeds` are then targets, to which a winch, at rest at first, begins to change at
    the times."""
    jerk: Annotated[float | None, Positive("jerk")] = None
    """Of all changes of the acceleration, which jumps without."""
    tensions: Annotated[NDArray[np.float64], Positive("force"), Shape((None,))] = field(
        default_factory=no_rows
    )
    """In place of `speeds`, tensions that it keeps [N], linear between the times: it pays out above them and hauls in
    below them, at most with `speed`."""
    dead_band: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0)] = 0.05
    """Part of the tension by which it may deviate before the winch moves."""
    brake: Annotated[float | None, Positive("force")] = None
    """Tension at which the brake slips [N]: the drum holds, or follows its commands, below it, and pays out at it."""
    follow: Annotated[str | None, NameOf("rope")] = None
    """Name of a rope whose winch this one copies, by length."""
    ratio: Annotated[float, Quantity("number")] = 1.0
    """Length of this rope per length of the one that it follows; negative pays out while that one hauls in."""
    fastest: Annotated[float | None, Positive("velocity")] = None
    """Largest speed [m/s]: it cannot be commanded, here or in a scenario, to haul in or to pay out faster; a brake that
    slips does."""
    end: Literal["first", "last", "both"] = "first"
    """End of the path with the drum: where sheaves have an efficiency, the rope runs over them from or to there. Of
    drums at both ends each hauls in half."""

    @staticmethod
    def check(spec: Any) -> None:
        """A speed or a length a time, none beyond what the winch can do."""
        _check_winch_keys(spec)
        if spec.fastest is None:
            return
        if spec.follow is not None:
            raise InputError("both 'follow' and 'fastest'", key="fastest", expected="one of them")
        if spec.speed is not None:
            asked, key = spec.speed, "speed"
        else:
            key = "lengths" if len(spec.lengths) else "speeds"
            asked = float(np.abs(_given_speeds(spec)[1]).max()) if len(spec.times) else 0.0
        if asked > spec.fastest * (1.0 + 1e-12):
            raise InputError(
                f"{asked:g} m/s, above the largest speed of the winch, {spec.fastest:g} m/s",
                key=key,
                expected=f"at most {spec.fastest:g} m/s",
            )

    @property
    def plan(self) -> NDArray[np.float64]:
        """Time, length hauled in since t = 0, speed, acceleration and jerk where each piece begins, shape (n, 5)."""
        if not (len(self.speeds) or len(self.lengths)):
            return np.column_stack([self.times, np.zeros((len(self.times), 4))])
        if self.acceleration is None:
            return speed_pieces(*self.profile)[1:]
        times, speeds = self.times, self.speeds
        if self.speed is not None:
            lengths = [-float(length) for length in self.lengths]
            moves = planned_moves(list(self.times), lengths, self.speed, self.acceleration, self.jerk)
            times, speeds = (np.array(values) for values in moves)
            if not len(times):
                return np.zeros((1, 5))
        return speed_pieces(times, speeds, self.acceleration, self.jerk)

    @property
    def profile(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Times [s] and speeds [m/s], between which the speed is linear."""
        return _given_speeds(self)


def _check_winch_keys(spec: Any) -> None:
    """A winch has one table of commands."""
    given = [key for key in ("speeds", "lengths", "tensions") if len(getattr(spec, key))]
    if spec.follow is not None:
        if given or spec.acceleration is not None or spec.speed is not None:
            other = given[0] if given else "acceleration" if spec.acceleration is not None else "speed"
            raise InputError(f"both 'follow' and {other!r}", key=other, expected="one of them")
    elif spec.ratio != 1.0:
        raise InputError("'ratio' without 'follow'", key="ratio", expected="'follow', a rope to follow")
    if len(given) > 1:
        raise InputError(f"both {given[0]!r} and {given[1]!r}", expected="one of them")
    if not given and spec.follow is None and (spec.brake is None or len(spec.times)):
        raise InputError("neither 'speeds' nor 'lengths'", expected="one of them")
    if given:
        check_table("times", spec.times, given[0], getattr(spec, given[0]))
    if given == ["tensions"]:
        if spec.speed is None:
            raise InputError(
                "'tensions' without 'speed'", key="speed", expected="the largest speed of the winch"
            )
        for key in ("brake", "acceleration", "jerk"):
            if getattr(spec, key) is not None:
                raise InputError(f"both 'tensions' and {key!r}", key=key, expected="one of them")
        return
    if (spec.speed is not None) != (len(spec.lengths) > 0 and spec.acceleration is not None):
        raise InputError(
            "'speed' is the limit of moves to 'lengths' with an 'acceleration'",
            key="speed" if spec.speed is not None else "acceleration",
            expected="'lengths', 'speed' and 'acceleration'; 'speeds' and 'acceleration'; or a table alone",
        )
    if spec.speed is not None:
        planned_moves(spec.times, spec.lengths, spec.speed, spec.acceleration, spec.jerk)
    else:
        check_speeds(spec)


def _given_speeds(winch: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Times [s] and speeds [m/s] of a winch, between which the speed is linear.

    Notes
    -----
    Of lengths: a quadratic spline with a knot in the middle of each interval (L. L. Schumaker, SIAM J. Numer. Anal.
    20, 1983). Speeds at the times are harmonic means of those of the intervals beside them, none where these have
    opposite signs, so none is more than twice one beside it, and that in the middle never turns back.
    """
    times, speeds = (np.atleast_1d(np.asarray(v, dtype=np.float64)) for v in (winch.times, winch.speeds))
    if len(speeds):
        return times, speeds
    steps = np.diff(times)
    means = -np.diff(np.asarray(winch.lengths, dtype=np.float64)) / steps
    at = np.zeros(len(times))
    before, after = means[:-1], means[1:]
    same = before * after > 0.0
    at[1:-1][same] = 2.0 * before[same] * after[same] / (before[same] + after[same])
    middle = 2.0 * means - 0.5 * (at[:-1] + at[1:])
    all_times, all_speeds = np.empty(2 * len(times) - 1), np.empty(2 * len(times) - 1)
    all_times[::2], all_times[1::2] = times, times[:-1] + 0.5 * steps
    all_speeds[::2], all_speeds[1::2] = at, middle
    return all_times, all_speeds


def controlled(rope: Any) -> bool:
    """Whether the winch of a rope answers to its tension."""
    winch = getattr(rope, "winch", None)
    return winch is not None and (len(winch.tensions) > 0 or winch.brake is not None)


def rubbing_places(rope: Any) -> list[int]:
    """Numbers in the path of a rope, from 1 on, of the places with an efficiency below 1."""
    return [
        number + 1
        for number, stop in enumerate(getattr(rope, "path", ()))
        if stop.efficiency < 1.0 or stop.friction > 0.0
    ]


def rope_components(rope: Any) -> dict[str, tuple[str, ...]]:
    """Components of the channels of a rope: its segments, its places that rub; none of what it does not have."""
    segments = tuple(str(i + 1) for i in range(len(rope.path) - 1))
    rubbing = tuple(str(place) for place in rubbing_places(rope))
    found = {channel.name: rubbing for channel in SheaveParts.CHANNELS}
    found |= dict.fromkeys(("segment_tension_max", "segment_tension_min"), segments if rubbing else ())
    if not controlled(rope):
        found |= {channel.name: () for channel in ControlOutputs.CHANNELS}
    return {"segment_tension": segments, **found}


def check_path(path: Sequence[Any]) -> None:
    """Refuse a path of a rope that no body is on.

    Raises
    ------
    InputError
        If it is.
    """
    if all(stop.body == GROUND for stop in path):
        raise InputError("all its points are on the ground", key="path", expected="a point on a body")
