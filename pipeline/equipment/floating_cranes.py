"""Floating cranes: a boom that luffs on a hull, with hooks on falls; with a table below it, it slews as well.

"Integrated simulation ... (2018)", sections 3.5, 3.6, 4.1.2: sheerlegs, two of them with four and eight hooks. The boom
is a rigid body, hinged at its foot. Either a drive turns it in the hinge, or a rope of n parts from the head of a back
stay holds it, whose winch is as fast as the boom is to turn. With the angle th of a boom of length L, the head of the
stay at (a, h) from the hinge, all that hangs at the head of the boom W and its own weight W_b at R_b::

    R = L cos th,   z = L sin th,        n T = (W R + W_b R_b)/arm,        d(stay)/d(th) = -arm

Crown j of a hook goes up by dz_j as the boom luffs, and away from its winch by dl_j; for a hook that keeps its height
the winch pays out ``n dz_j + dl_j``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Absent, Least, NameOf, Positive, Quantity, Shape
from heavylift.pipeline.equipment.falls import FallsRope, HookBlock, limit_winch, sheaves_aside, without_winch
from heavylift.pipeline.equipment.moves import Move, Turn, check_moves, positions_of, speeds_of, turned
from heavylift.pipeline.equipment.parts import EQUIPMENT, Equipment, given, heading, listed

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from heavylift.pipeline.equipment.parts import Made, Places

__all__ = ["FloatingCrane"]

PAUSE = 1e-6
"""Between two times [s] of a table of speeds that are one."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class Boom:
    """The boom: x of its axes from the foot to the head, y across it."""

    length: Annotated[float, Positive("length")]
    """From the hinge to the head [m]."""
    angle: Annotated[float, Quantity("angle", minimum=0.0, maximum=0.5 * np.pi)]
    """Above the deck at the start [rad]."""
    mass: Annotated[float, Positive("mass")]
    """Mass [kg]."""
    centre: Annotated[float | None, Positive("length")] = None
    """Of its mass, from the hinge [m]; half its length if absent."""
    width: Annotated[float, Positive("length")] = 10.0
    """Between its legs, for its inertia [m]; that of a bar along the boom with this breadth and half of it in depth."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class BoomStay:
    """The rope that holds and luffs the boom."""

    head: Annotated[NDArray[np.float64], Quantity("length"), Shape((3,))]
    """Head of the back stay [m], in the coordinates of the geometry of the hull."""
    parts: Annotated[int, Interval(ge=1)]
    """Parts of rope between it and the boom."""
    at: Annotated[float | None, Positive("length")] = None
    """Where it holds the boom, from the hinge [m]; at its head if absent."""
    rope: FallsRope
    """The rope; its length is the initial geometric length, or follows from its tension."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class BoomHook:
    """A hook at the head of the boom."""

    number: Annotated[int | None, Interval(ge=1), Absent()] = None
    """In the names of its falls, ``NAME_hook_5``; that of its place in the list if absent."""
    at: Annotated[tuple[float, float], Quantity("length")] = (0.0, 0.0)
    """Of its crown at the start [m]: ahead of the head of the boom, and to its left, in its height."""
    drop: Annotated[float, Positive("length")]
    """Height of the crown above the sheaves of the hook block at the start [m]."""
    parts: Annotated[int, Interval(ge=2)]
    """Parts of rope: an even number."""
    winch: Annotated[NDArray[np.float64] | None, Quantity("length"), Shape((3,)), Absent()] = None
    """Place of its drum [m], in the coordinates of the geometry of the hull; the winch is at the crown if absent."""
    tension: Annotated[float | None, Positive("force"), Absent()] = None
    """Of its rope at the start [N]; that of `rope` if absent, as of hooks on which the same hangs."""
    moves: tuple[Move, ...] = ()
    """How the hook is hoisted, upwards if positive."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class Slewing:
    """A table on the hull that turns with boom, stay and winches."""

    centre: Annotated[NDArray[np.float64], Quantity("length"), Shape((3,))]
    """On its axis [m], in the coordinates of the geometry of the hull; its centre of mass."""
    mass: Annotated[float, Positive("mass")]
    """Of table and back stay [kg]."""
    radius: Annotated[float, Positive("length")] = 10.0
    """For its inertia, that of a disc [m]."""
    moves: tuple[Turn, ...] = ()
    """How it turns."""
    driven: bool = False
    """Whether it has a drive without moves: at rest until a scenario commands the drive ``NAME_slewing``."""


@EQUIPMENT.describe("floating_cranes")
@dataclass(frozen=True, eq=False, kw_only=True)
class FloatingCrane(Equipment):
    """A boom on a hull that luffs, with hooks on falls."""

    ORDER: ClassVar = 2

    name: str
    hull: Annotated[str, NameOf("body")]
    """Body that carries it."""
    hinge: Annotated[NDArray[np.float64], Quantity("length"), Shape((3,))]
    """Foot of the boom [m], in the coordinates of the geometry of the hull."""
    along: Annotated[tuple[float, float, float], Quantity("number")] = (1.0, 0.0, 0.0)
    """Direction of the boom over the deck at the start, in the coordinates of the geometry of the hull, without z
    component; any length."""
    boom: Boom
    """The boom."""
    stay: BoomStay | None = None
    """What holds the boom; a drive of its hinge if absent."""
    luffing: tuple[Turn, ...] = ()
    """How the boom luffs, upwards if positive."""
    driven: bool = False
    """Whether the hinge of a boom without stay has a drive without luffing: it is at rest until a scenario
    tells the drive ``NAME_hinge``."""
    level: bool = False
    """Whether the winches of the falls pay out and haul in so that hooks keep their height as the boom luffs by
    ``luffing``."""
    slewing: Slewing | None = None
    """A table that slews; none if absent."""
    sheave_radius: Annotated[float, Positive("length")]
    """Of all sheaves of the falls [m]."""
    efficiency: Annotated[float, Quantity("number", minimum=0.5, maximum=1.0, closed=True)] = 1.0
    """Of each sheave of the falls, as that of ropes."""
    block: HookBlock
    """Each hook block."""
    rope: FallsRope
    """Ropes of all falls."""
    hooks: Annotated[tuple[BoomHook, ...], Least(1)]
    """Hooks."""

    @staticmethod
    def check(spec: Any) -> None:
        """Moves follow each other; the boom stays between the deck and upright, and in front of its stay."""
        heading(spec.along, "along")
        check_moves(turned(spec.luffing), "luffing")
        if spec.driven and spec.stay is not None:
            raise InputError(
                "a driven hinge under a boom that a stay holds",
                key="driven",
                expected="no 'stay'; or the winch of the stay, which a scenario tells as that of any rope",
            )
        if spec.slewing is not None:
            check_moves(turned(spec.slewing.moves), "slewing.moves")
        angles = spec.boom.angle + np.cumsum([0.0, *(turn.angle for turn in spec.luffing)])
        if angles.min() < 0.0 or angles.max() > 0.5 * np.pi:
            worst = float(angles[np.argmax(np.abs(angles - 0.25 * np.pi))])
            raise InputError(
                f"the boom comes to {np.degrees(worst):.6g} degrees",
                key="luffing",
                expected="between 0 and 90 degrees above the deck",
            )
        if (spec.boom.centre or 0.0) > spec.boom.length:
            raise InputError(
                f"{spec.boom.centre:.6g} m from the hinge of a boom of {spec.boom.length:.6g} m",
                key="boom.centre",
                expected=f"at most {spec.boom.length:.6g} m",
            )
        if spec.level and not spec.luffing:
            raise InputError(
                "no 'luffing', and winches know of no other",
                key="level",
                expected="'luffing'; where a scenario luffs the boom it tells the hooks, too",
            )
        for i, hook in enumerate(spec.hooks):
            check_moves(hook.moves, f"hooks.{i}.moves")
            lowest = spec.boom.length * (np.sin(angles.min()) - np.sin(spec.boom.angle))
            if spec.level and hook.drop + lowest <= 2.0 * spec.sheave_radius:
                raise InputError(
                    f"the boom comes down by {-float(lowest):.6g} m to a hook that keeps its height, {hook.drop:.6g} m "
                    "below it",
                    key=f"hooks.{i}.drop",
                    expected=f"more than {2.0 * spec.sheave_radius - float(lowest):.6g} m",
                )
        if spec.stay is not None:
            along, _ = heading(spec.along, "along")
            for angle in angles:
                point, head = _stay_ends(spec, along, float(angle))
                if point[0] * head[1] - point[1] * head[0] <= 0.0:
                    raise InputError(
                        f"at {np.degrees(float(angle)):.6g} degrees it does not pull the boom upwards",
                        key="stay.head",
                        expected="a head behind and above the line of the boom",
                    )

    @staticmethod
    def build(spec: Any, places: Places, made: Made) -> None:
        """Write the boom, what holds it, and falls."""
        name, carrier, boom = spec.name, spec.hull, spec.boom
        foot = places.world(spec.hull, spec.hinge)
        axes = np.array([places.world(spec.hull, row) for row in np.eye(3)]).T
        axes -= places.world(spec.hull, np.zeros(3))[:, None]  # of the hull in the world, in columns
        along, _ = heading(spec.along, "along")
        across = np.cross([0.0, 0.0, 1.0], along)
        frame = axes @ np.column_stack(
            [along, across, [0.0, 0.0, 1.0]]
        )  # ahead, left and up of the boom on its deck
        origin = np.zeros(3)
        if spec.slewing is not None:
            carrier, origin = f"{name}_table", np.array(spec.slewing.centre)
            _add_table(spec, places, made, axes)

        def on_carrier(point: Any) -> dict[str, Any]:
            return {"body": carrier, "point": listed(np.subtract(point, origin))}

        up = _lift(boom.angle)
        mass, a, b, c = boom.mass, boom.length, boom.width, 0.5 * boom.width
        entry = {
            "type": "rigid",
            "mass": mass,
            "inertia": [mass * (u * u + v * v) / 12.0 for u, v in ((b, c), (a, c), (a, b))],
            "centre_of_mass": [boom.centre or 0.5 * a, 0.0, 0.0],
            "frame": {"motion": "free"},
            "initial": {"position": listed(foot)} | _turn(frame @ up),
        }
        made.body(f"{name}_boom", entry, "boom")
        hinge: dict[str, Any] = {
            "name": f"{name}_hinge",
            "between": [carrier, f"{name}_boom"],
            "at": listed(foot),
        }
        if spec.stay is None and not (spec.luffing or spec.driven):
            made.add("joints", hinge | {"type": "fixed"}, "hinge")
        else:
            hinge |= {"type": "hinge", "axis": listed(-frame[:, 1])}
            if spec.stay is None:
                standing = {"times": [0.0], "speeds": [0.0]}
                hinge["drive"] = speeds_of(turned(spec.luffing)) if spec.luffing else standing
            made.add("joints", hinge, "hinge")
        if spec.stay is not None:
            _add_stay(spec, made, along, on_carrier)
        ahead = frame[:, 0] - np.array([0.0, 0.0, frame[2, 0]])  # horizontal in the world, as falls have it
        for i, hook in enumerate(spec.hooks):
            crown = np.array([boom.length, 0.0, 0.0]) + up.T @ [*hook.at, 0.0]
            falls: dict[str, Any] = {
                "name": f"{name}_hook_{hook.number or i + 1}",
                "crown": {"body": f"{name}_boom", "point": listed(crown)},
                "along": listed(ahead),
                "parts": hook.parts,
                "sheave_radius": spec.sheave_radius,
                "efficiency": spec.efficiency,
                "drop": hook.drop,
                "block": given(spec.block),
                "rope": given(spec.rope),
            }
            if hook.tension is not None:
                falls["rope"] |= {"tension": hook.tension}
            if hook.winch is not None:
                falls["drum"] = on_carrier(hook.winch)
            if spec.level and spec.luffing:
                drum = None
                if hook.winch is not None:
                    drum = np.column_stack([along, across, [0.0, 0.0, 1.0]]).T @ np.subtract(
                        hook.winch, spec.hinge
                    )
                falls["winch"] = _level(spec, hook, crown, drum)
            elif hook.moves:
                falls["moves"] = [given(move) for move in hook.moves]
            made.add("falls", falls, f"hooks.{i}")


def _lift(angle: float) -> NDArray[np.float64]:
    """Axes of a boom at an angle above its deck [rad]: columns along it, to its left and above it."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])


def _turn(axes: NDArray[np.float64]) -> dict[str, Any]:
    """Orientation of a body with these axes in the world, in columns."""
    from scipy.spatial.transform import Rotation

    vector = Rotation.from_matrix(axes).as_rotvec()
    angle = float(np.linalg.norm(vector))
    return {"orientation": {"axis": listed(vector / angle), "angle": angle}} if angle > 0.0 else {}


def _add_table(spec: Any, places: Places, made: Made, axes: NDArray[np.float64]) -> None:
    """The table that slews, and what turns it."""
    table, name = spec.slewing, f"{spec.name}_table"
    centre = places.world(spec.hull, table.centre)
    across = 0.25 * table.mass * table.radius**2
    entry = {
        "type": "rigid",
        "mass": table.mass,
        "inertia": [across, across, 2.0 * across],
        "frame": {"motion": "free"},
        "initial": {"position": listed(centre)} | _turn(axes),
    }
    made.body(name, entry, "slewing")
    joint: dict[str, Any] = {
        "name": f"{spec.name}_slewing",
        "between": [spec.hull, name],
        "at": listed(centre),
    }
    if table.moves or table.driven:
        drive = speeds_of(turned(table.moves)) if table.moves else {"times": [0.0], "speeds": [0.0]}
        joint |= {"type": "hinge", "axis": listed(axes[:, 2]), "drive": drive}
    else:
        joint["type"] = "fixed"
    made.add("joints", joint, "slewing")


def _stay_ends(
    spec: Any, along: NDArray[np.float64], angle: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Ends of the stay from the hinge in the plane of the boom, ahead and up [m]: on the boom, and on the back stay."""
    reach = spec.stay.at or spec.boom.length
    way = np.subtract(spec.stay.head, spec.hinge)
    return reach * np.array([np.cos(angle), np.sin(angle)]), np.array([float(way @ along), float(way[2])])


def _add_stay(spec: Any, made: Made, along: NDArray[np.float64], on_carrier: Callable[[Any], Any]) -> None:
    """The rope that holds the boom."""
    stay, parts = spec.stay, spec.stay.parts
    ends = (
        on_carrier(stay.head),
        {"body": f"{spec.name}_boom", "point": [stay.at or spec.boom.length, 0.0, 0.0]},
    )
    rope: dict[str, Any] = {
        "name": f"{spec.name}_stay",
        "path": [ends[k % 2] for k in range(parts + 1)],
    } | without_winch(stay.rope)
    if spec.luffing:
        aside = float(np.subtract(stay.head, spec.hinge) @ np.cross([0.0, 0.0, 1.0], along))

        def length(angle: float) -> float:
            point, head = _stay_ends(spec, along, angle)
            return parts * float(np.hypot(np.linalg.norm(point - head), aside))

        times = _times(turned(spec.luffing))
        rope["winch"] = {"times": times, "speeds": [-rate for rate in _rates(spec, times, length)]}
    limit_winch(rope, stay.rope)
    made.add("ropes", rope, "stay")


def _level(
    spec: Any, hook: Any, crown: NDArray[np.float64], drum: NDArray[np.float64] | None
) -> dict[str, Any]:
    """Winch of a hook that follows its commands and not the boom; `drum` from the hinge: ahead, left, up [m].

    The lead touches the sheave of the crown where its tangent does, wraps it to its far side, and leaves straight down.
    The other end is at the crown, beside its axis, and turns with the boom.
    """
    r = float(spec.sheave_radius)
    first = float(sheaves_aside(hook.parts, r, None)[0])

    def needed(angle: float) -> float:
        place = _lift(angle) @ crown
        height = hook.parts * float(place[2])
        if drum is None:  # both ends turn with the boom, one up and one down
            return height
        ahead, left, up = drum - place - [0.0, first, 0.0]
        away = float(np.hypot(ahead, up))
        lead = float(np.sqrt(away**2 - r**2 + left**2))
        wrap = float(np.arctan2(up, ahead)) % (2.0 * np.pi) - float(np.arccos(r / away))
        return height + lead + r * (wrap - float(np.sin(angle - spec.boom.angle)))

    times = _times(turned(spec.luffing))
    own = speeds_of(hook.moves, float(hook.parts)) if hook.moves else {"times": [0.0], "speeds": [0.0]}
    times = sorted({*times, *own["times"]})
    times = [time for i, time in enumerate(times) if i == 0 or time > times[i - 1] + PAUSE]
    hoisting = np.interp(times, own["times"], own["speeds"])
    rates = _rates(spec, times, needed)
    return {"times": times, "speeds": [float(v) - rate for v, rate in zip(hoisting, rates, strict=True)]}


def _times(moves: Sequence[Any]) -> list[float]:
    """Times at which the displacement of moves is tabulated [s]: dense during moves."""
    return list(positions_of(moves)["times"])


def _rates(spec: Any, times: Sequence[float], length: Callable[[float], float]) -> list[float]:
    """Rate [m/s] of a length that depends on the angle of the boom, at some times.

    Notes
    -----
    Speeds of the boom are linear between the times, and so is this rate but for its curvature over the angle of a
    piece of a ramp.
    """
    moves = turned(spec.luffing)
    way, speeds = positions_of(moves), speeds_of(moves, 1.0)
    gone = np.interp(times, way["times"], way["values"]) + spec.boom.angle
    rates, small = np.interp(times, speeds["times"], speeds["speeds"]), 1e-5
    slopes = [(length(float(at) + small) - length(float(at) - small)) / (2.0 * small) for at in gone]
    return [float(slope * rate) for slope, rate in zip(slopes, rates, strict=True)]
