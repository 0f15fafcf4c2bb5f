"""Equalizers (block loaders): n lines with the same force, by moving pulleys on one rope or without their masses.

"Integrated simulation ... (2018)", sections 2.4.7 and 2.7.3 (2). A beam hangs on a hook by a hinge, its axis vertical.
n moving pulleys with a line each slide on guides below it, n - 1 fixed sheaves between them, both ends of the rope on
the beam. All have one radius r and stand 2 r apart, so that all parts of the rope are vertical. With the depth z_i of a
pulley below the fixed sheaves and the tension T of the rope::

    sum 2 z_i + (2 n - 1) pi r = L,        F_i cos a_i = 2 T - m (g + z_i''),        needed travel  z_i - mean(z)

Sheaves with an efficiency eta hold tensions that differ: forces of two lines that follow each other have any ratio
from eta^2 to its inverse, and the ends of it while the rope runs past.

A pulley at a stop is an anchor: its line takes what balance gives. As ``massless`` all lines are one rope whose path
jumps from lug to lug, see `heavylift.solver.force_elements.equalized`, and with an efficiency
`heavylift.solver.force_elements.equalized_friction`.

Equal forces have their resultant in the centroid of the lugs: a load on one equalizer hangs on that point, and turns
over if its centre of mass lies above it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import (
    Absent,
    BodyPoint,
    Least,
    NameOf,
    Positive,
    Quantity,
    Shape,
    Square,
)
from heavylift.pipeline.equipment.parts import DOWN, EQUIPMENT, Equipment, heading, listed

if TYPE_CHECKING:
    from heavylift.pipeline.equipment.parts import Made, Places

__all__ = ["Equalizer"]

APART = 1e-6
"""Distance [m] within which lugs of two lines, or a lug and its pulley, are one point."""

OVERLAP = 0.02
"""Part of its length by which a load may be drawn lower than its lines reach, as that of the strain of ropes."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class EqualizerHook:
    """What an equalizer hangs on."""

    body: Annotated[str, NameOf("side")]
    """Body, or ``"ground"``."""
    point: Annotated[NDArray[np.float64], BodyPoint()]
    """Hinge of the beam [m], in the coordinates of the geometry of the body; of the ground in the world."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class EqualizerBeam:
    """The beam that carries guides and fixed sheaves."""

    mass: Annotated[float, Positive("mass")]
    """Mass, with the fixed sheaves [kg]."""
    inertia: Annotated[NDArray[np.float64] | None, Quantity("moment of inertia"), Square(3), Absent()] = None
    """About its centre of mass, x along the beam and z up [kg m^2]; that of a bar of its length if absent."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class EqualizerPulley:
    """The moving pulleys."""

    mass: Annotated[float, Positive("mass")]
    """Mass of each, with its shackle [kg]."""
    inertia: Annotated[NDArray[np.float64] | None, Quantity("moment of inertia"), Square(3), Absent()] = None
    """About its centre, y along its axis [kg m^2]; that of a disc if absent."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class EqualizerTravel:
    """How far pulleys move on their guides, from the place where all are at the same depth."""

    up: Annotated[float, Positive("length")]
    """Towards the fixed sheaves [m]."""
    down: Annotated[float, Positive("length")]
    """Away from them [m]."""
    stiffness: Annotated[float, Positive("stiffness")] = 5e7
    """Of the stops [N/m]."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """Of the stops [N s/m]."""
    at_stops: bool = False
    """Whether lines may differ by more than pulleys can travel, so that some begin at their stops."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class EqualizerRope:
    """The rope over all pulleys, or what all lines are made of."""

    axial_stiffness: Annotated[float, Positive("force")]
    """EA [N]."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """Tension per rate of elongation [N s/m], while it is taut."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class EqualizerLine:
    """A line from a moving pulley to the load."""

    body: Annotated[str, NameOf("body")]
    """The load."""
    point: Annotated[NDArray[np.float64], BodyPoint()]
    """Its lug [m], in the coordinates of the geometry of the load."""
    other_point: Annotated[NDArray[np.float64] | None, Quantity("length"), Shape((3,)), Absent()] = None
    """A second lug [m]: the line ends on an extension pulley, and a sling over it holds both lugs."""
    length: Annotated[float | None, Positive("length")] = None
    """Unstretched [m]; the initial geometric length if absent, from a pulley at the common depth."""
    count: Annotated[int, Interval(ge=1, le=100)] = 1
    """Number of lines to this lug, from as many pulleys beside each other."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class EqualizerExtension:
    """Extension pulleys, each under a line, with a sling to two lugs."""

    mass: Annotated[float, Positive("mass")]
    """Of each [kg]."""
    radius: Annotated[float, Positive("length")]
    """Of its sheave [m]; its line holds it two radii above the centre of the sheave."""
    sling_length: Annotated[float, Positive("length")]
    """Unstretched, from lug to lug [m]."""


@EQUIPMENT.describe("equalizers")
@dataclass(frozen=True, eq=False, kw_only=True)
class Equalizer(Equipment):
    """A block loader, whose lines have one force in all of them by moving pulleys on one rope."""

    ORDER: ClassVar = 4

    name: str
    model: Literal["pulleys", "massless"] = "pulleys"
    """``pulleys``: bodies on guides with stops; ``massless``: one row for all lines, or one each with an efficiency, no
    mass of pulleys, and stops that do not yield."""
    hook: EqualizerHook
    """What it hangs on, by a hinge with a vertical axis."""
    along: Annotated[tuple[float, float, float], Quantity("number")] = (1.0, 0.0, 0.0)
    """Horizontal direction of the beam at the start, in the world; any length. Lines follow each other along it."""
    sheave_radius: Annotated[float, Positive("length")]
    """Of moving pulleys and fixed sheaves [m]; moving pulleys are four radii apart."""
    sheave_depth: Annotated[float, Positive("length")] = 1.5
    """Of the fixed sheaves, and of the ends of the rope, below the hinge [m]."""
    part_length: Annotated[float, Positive("length")]
    """Unstretched length of a part of the rope with all pulleys at the same depth [m]: their depth below the fixed
    sheaves."""
    beam: EqualizerBeam
    """The beam, with its fixed sheaves."""
    pulley: EqualizerPulley | None = None
    """Moving pulleys; none if ``massless``."""
    travel: EqualizerTravel
    """How far they move."""
    rope: EqualizerRope
    """The rope over all pulleys."""
    line: EqualizerRope
    """What the lines are made of."""
    lines: Annotated[tuple[EqualizerLine, ...], Least(1)]
    """In their order along the beam, each from a moving pulley, or from `count` of them."""
    extension: EqualizerExtension | None = None
    """Extension pulleys, of lines with `other_point`."""
    friction: Annotated[float, Quantity("force", minimum=0.0, closed=True)] = 0.0
    """Of each pulley on its guide [N]."""
    efficiency: Annotated[float, Quantity("number", minimum=0.5, maximum=1.0, closed=True)] = 1.0
    """Of each sheave, moving, fixed or of an extension, as that of ropes: 0.98 on roller bearings, 0.96 on plain ones.
    The smallest force of n lines is then down to ``efficiency^(2 (n - 1))`` of the largest."""

    @staticmethod
    def check(spec: Any) -> None:
        """A model has what it needs; pulleys stay below the fixed sheaves; extension pulleys are there."""
        if (spec.pulley is None) == (spec.model == "pulleys"):
            raise InputError(
                "'pulley' is missing" if spec.pulley is None else "a pulley with model 'massless'",
                key="pulley",
                expected="'pulley' with model 'pulleys', and none with 'massless'",
            )
        extended = any(line.other_point is not None for line in spec.lines)
        for key, given in (("friction", spec.friction > 0.0), ("extension", extended)):
            if given and spec.model == "massless":
                raise InputError(f"{key!r} with model 'massless'", key=key, expected="model 'pulleys'")
        if spec.travel.up >= spec.part_length:
            raise InputError(
                f"{spec.travel.up:.6g} m upwards, and part_length = {spec.part_length:.6g} m: pulleys would "
                "come through the fixed sheaves",
                key="travel.up",
                expected=f"less than {spec.part_length:.6g} m",
            )
        if len(_entries(spec)) < 2:
            raise InputError("one line", key="lines", expected="at least two lines")
        if not any(spec.along):
            raise InputError("a direction of length zero", key="along", expected="a horizontal direction")
        heading(spec.along, "along")
        for i, line in enumerate(spec.lines):
            if line.other_point is not None and spec.extension is None:
                raise InputError(
                    "'other_point' without 'extension'",
                    key=f"lines.{i}.other_point",
                    expected="'extension' of the equalizer, with the mass and radius of extension pulleys",
                )

    @staticmethod
    def build(spec: Any, places: Places, made: Made) -> None:
        """Write the parts: beam, hinge, and pulleys, guides and ropes, or one rope of all lines."""
        layout = _Layout.of(spec, places)
        name, r, centre = spec.name, spec.sheave_radius, np.array([0.0, 0.0, -spec.sheave_depth])
        length = 4.0 * r * len(_entries(spec))
        inertia = spec.beam.inertia or [v * spec.beam.mass * length**2 / 12.0 for v in (0.01, 1.0, 1.0)]
        made.rigid(
            f"{name}_beam",
            spec.beam.mass,
            inertia,
            layout.hinge,
            layout.angle,
            key="beam",
            centre_of_mass=listed(centre),
        )
        hinge = {"name": f"{name}_hinge", "type": "hinge", "between": [spec.hook.body, f"{name}_beam"]}
        made.add("joints", hinge | {"at": listed(layout.hinge), "axis": [0.0, 0.0, 1.0]}, "hook")
        write = _add_pulleys if spec.model == "pulleys" else _add_massless
        write(spec, layout, places, made)


def _entries(spec: Any) -> list[int]:
    """Number of the entry of `lines` to which each pulley belongs."""
    return [i for i, line in enumerate(spec.lines) for _ in range(line.count)]


@dataclass(frozen=True, eq=False)
class _Layout:
    """Where an equalizer is at the start.

    Attributes
    ----------
    hinge, along, angle
        Place of the hinge in the world [m], direction of the beam, and its angle about the vertical [rad].
    offsets
        Of the guides along the beam [m], shape (n,).
    depths
        Of the pulleys below the fixed sheaves [m], shape (n,).
    ends
        Of the lines in the world [m]: lugs or extension pulleys, shape (n, 3).
    lengths
        Unstretched, of the lines [m], shape (n,).
    """

    hinge: NDArray[np.float64]
    along: NDArray[np.float64]
    angle: float
    offsets: NDArray[np.float64]
    depths: NDArray[np.float64]
    ends: NDArray[np.float64]
    lengths: NDArray[np.float64]

    @staticmethod
    def of(spec: Any, places: Places) -> _Layout:
        """Find it, or say what does not fit."""
        hinge = places.world(spec.hook.body, spec.hook.point)
        along, angle = heading(spec.along, "along")
        entries = _entries(spec)
        count = len(entries)
        offsets = (np.arange(count) - 0.5 * (count - 1)) * 4.0 * spec.sheave_radius
        outlets = hinge + np.outer(offsets, along) + spec.sheave_depth * DOWN
        ends = np.array([_end(spec, i, places) for i in entries])
        _check_lugs(spec, ends, places)
        way = ends - outlets
        below = way @ DOWN
        aside = np.linalg.norm(way - np.outer(below, DOWN), axis=1)
        lengths = np.hypot(aside, below - spec.part_length)
        reach = np.full(count, spec.part_length)
        for k, i in enumerate(entries):
            line = spec.lines[i]
            if below[k] <= spec.part_length and line.length is None:
                raise InputError(
                    f"the lug is {below[k]:.6g} m below the fixed sheaves, its pulley {spec.part_length:.6g} m",
                    key=f"lines.{i}.point",
                    expected="a lug below the pulley",
                )
            if line.length is None:
                continue
            lengths[k] = line.length
            if line.length <= aside[k]:
                raise InputError(
                    f"a line of {line.length:.6g} m, and the lug is {aside[k]:.6g} m aside from the guide",
                    key=f"lines.{i}.length",
                    expected="a line that reaches the lug",
                )
            reach[k] = below[k] - math.sqrt(line.length**2 - aside[k] ** 2)
        return _Layout(hinge, along, angle, offsets, _start_depths(spec, reach), ends, lengths)

    def pulley(self, i: int, depth: float, sheave_depth: float) -> NDArray[np.float64]:
        """Place of a pulley in the world [m]."""
        found: NDArray[np.float64] = self.hinge + self.offsets[i] * self.along + (sheave_depth + depth) * DOWN
        return found


def _end(spec: Any, i: int, places: Places) -> NDArray[np.float64]:
    """Where a line ends: its lug, or the place where it holds an extension pulley, in the world [m]."""
    line = spec.lines[i]
    lug = places.world(line.body, line.point)
    if line.other_point is None:
        return lug
    other = places.world(line.body, line.other_point)
    middle, half = 0.5 * (lug + other), 0.5 * float(np.linalg.norm(other - lug))
    r, sling = spec.extension.radius, spec.extension.sling_length
    if not half > r:
        raise InputError(
            f"its lugs are {2.0 * half:.6g} m apart, the extension pulley is {2.0 * r:.6g} m wide",
            key=f"lines.{i}.other_point",
            expected="lugs farther apart than the pulley is wide",
        )
    if sling <= 2.0 * half:
        raise InputError(
            f"a sling of {sling:.6g} m between lugs that are {2.0 * half:.6g} m apart",
            key="extension.sling_length",
            expected=f"more than {2.0 * half:.6g} m",
        )
    low, high = 0.0, sling  # height of the centre of the pulley above the lugs, by bisection
    for _ in range(100):
        height = 0.5 * (low + high)
        low, high = (height, high) if _sling_length(half, height, r) < sling else (low, height)
    return np.asarray(middle - (0.5 * (low + high) + 2.0 * r) * DOWN)


def _sling_length(half: float, height: float, r: float) -> float:
    """From lug to lug over a pulley in the middle above them [m]."""
    distance = math.hypot(half, height)
    if distance <= r:
        return 0.0
    straight = math.sqrt(distance**2 - r**2)
    return 2.0 * straight + r * 2.0 * (0.5 * math.pi + math.atan2(height, half) - math.atan2(straight, r))


def _check_lugs(spec: Any, ends: NDArray[np.float64], places: Places) -> None:
    """Lugs are apart; a load that hangs on this equalizer alone hangs below its lugs."""
    bodies = {line.body for line in spec.lines}
    entries = _entries(spec)
    for i, entry in enumerate(entries):
        for other, end in zip(entries[:i], ends[:i], strict=True):
            same_body = spec.lines[entry].body == spec.lines[other].body
            if other != entry and same_body and np.linalg.norm(ends[i] - end) < APART:
                raise InputError(
                    f"the lugs of lines {other + 1} and {entry + 1} coincide",
                    key=f"lines.{entry}.point",
                    expected="lugs apart from each other, or one with 'count'",
                )
    load = bodies.pop()
    centre = places.centre_of_mass(load)
    if bodies or centre is None or not places.hangs_alone(load):
        return
    lines = [spec.lines[i] for i in entries]
    lugs = [places.world(load, line.point) for line in lines]
    lugs += [
        places.world(load, line.other_point if line.other_point is not None else line.point) for line in lines
    ]
    height = float(np.mean(lugs, axis=0)[2] - centre[2])
    if height <= 0.0:
        raise InputError(
            f"the centroid of its lugs lies {-height:.6g} m below the centre of mass of {load!r}, which would turn "
            "over: one equalizer holds a load as one point does",
            key="lines",
            expected="lugs above the centre of mass, or more than one equalizer",
        )


def _start_depths(spec: Any, reach: NDArray[np.float64]) -> NDArray[np.float64]:
    """Depths of the pulleys below the fixed sheaves [m] at which the rope is as long as it is.

    `reach` are those at which the lines reach their lugs; all move by the same length until some come to their stops.
    """
    middle = spec.part_length
    low, high = middle - spec.travel.up, middle + spec.travel.down
    shift = float(reach.mean()) - middle
    least = min((line.length for line in spec.lines if line.length is not None), default=math.inf)
    if shift > OVERLAP * least:
        raise InputError(
            f"the load is drawn {shift:.6g} m lower than its lines reach",
            key="lines",
            expected="a load drawn higher, longer lines, or a longer 'part_length'",
        )
    travel = reach - shift - middle
    if not spec.travel.at_stops and (travel.min() < -spec.travel.up or travel.max() > spec.travel.down):
        key, needed = (
            ("up", -travel.min()) if travel.min() < -spec.travel.up else ("down", float(travel.max()))
        )
        line = int(np.argmin(travel) if key == "up" else np.argmax(travel))
        raise InputError(
            f"the lines differ by more than that: pulley {line + 1} needs {needed:.6g} m",
            key=f"travel.{key}",
            expected=f"at least {needed:.6g} m, or at_stops = true for pulleys that begin at their stops",
        )
    a, b = float(reach.min()) - high, float(reach.max()) - low
    for _ in range(200):  # the sum of the depths falls with the shift
        shift = 0.5 * (a + b)
        a, b = (shift, b) if np.clip(reach - shift, low, high).sum() > len(reach) * middle else (a, shift)
    return np.asarray(np.clip(reach - shift, low, high))


def _add_pulleys(spec: Any, layout: _Layout, places: Places, made: Made) -> None:
    """Moving pulleys on guides, the rope over all of them, and lines."""
    name, r, depth = spec.name, spec.sheave_radius, spec.sheave_depth
    entries = _entries(spec)
    count, mass = len(entries), spec.pulley.mass
    disc = [v * mass * r * r for v in (0.25, 0.5, 0.25)]
    stops = {
        "lower": -spec.travel.up,
        "upper": spec.travel.down,
        "stiffness": spec.travel.stiffness,
        "damping": spec.travel.damping,
    }
    path: list[dict[str, Any]] = [
        {"body": f"{name}_beam", "point": [float(layout.offsets[0]) - r, 0.0, -depth]}
    ]
    for i in range(count):
        pulley, x = f"{name}_pulley_{i + 1}", float(layout.offsets[i])
        place = layout.pulley(i, layout.depths[i], depth)
        made.rigid(pulley, mass, spec.pulley.inertia or disc, place, layout.angle, key="pulley")
        guide = {
            "name": f"{name}_guide_{i + 1}",
            "type": "slider",
            "between": [f"{name}_beam", pulley],
            "points": [[x, 0.0, -depth - spec.part_length], [0.0, 0.0, 0.0]],
            "axis": listed(DOWN),
            "limits": stops,
        }
        made.add("joints", guide | ({"friction": spec.friction} if spec.friction else {}), "travel")
        sheave = {"body": pulley, "point": [0.0, 0.0, 0.0], "radius": r, "axis": [0.0, -1.0, 0.0]}
        path.append(sheave | _rubs(spec))
        if i < count - 1:
            fixed = {"body": f"{name}_beam", "point": [x + 2.0 * r, 0.0, -depth]}
            path.append(fixed | {"radius": r, "axis": [0.0, 1.0, 0.0]} | _rubs(spec))
        _add_line(spec, i, entries[i], layout, places, made)
    path.append({"body": f"{name}_beam", "point": [float(layout.offsets[-1]) + r, 0.0, -depth]})
    rope = {
        "name": f"{name}_rope",
        "axial_stiffness": spec.rope.axial_stiffness,
        "damping": spec.rope.damping,
        "length": _rope_length(spec),
        "path": path,
    }
    made.add("ropes", rope, "rope")


def _rubs(spec: Any) -> dict[str, float]:
    """What a sheave says of its efficiency: nothing if it has no friction."""
    return {"efficiency": spec.efficiency} if spec.efficiency < 1.0 else {}


def _rope_length(spec: Any) -> float:
    """Unstretched length of the rope over all pulleys [m]."""
    count = len(_entries(spec))
    return float(2.0 * count * spec.part_length + (2 * count - 1) * math.pi * spec.sheave_radius)


def _add_line(spec: Any, i: int, entry: int, layout: _Layout, places: Places, made: Made) -> None:
    """A line from its pulley i to a lug, or to an extension pulley with a sling to two lugs."""
    name, line = spec.name, spec.lines[entry]
    end: dict[str, Any] = {"body": line.body, "point": list(line.point)}
    of_rope = {"axial_stiffness": spec.line.axial_stiffness, "damping": spec.line.damping}
    if line.other_point is not None:
        body, r, mass = f"{name}_extension_{i + 1}", spec.extension.radius, spec.extension.mass
        lugs = [places.world(line.body, point) for point in (line.point, line.other_point)]
        across = lugs[1] - lugs[0]
        angle = float(np.arctan2(across[1], across[0]))
        inertia = [v * mass * r * r for v in (0.25, 0.5, 0.25)]
        made.rigid(body, mass, inertia, layout.ends[i] + 2.0 * r * DOWN, angle, key="extension")
        sheave = {"body": body, "point": [0.0, 0.0, 0.0], "radius": r, "axis": [0.0, 1.0, 0.0]} | _rubs(spec)
        ends = [{"body": line.body, "point": list(point)} for point in (line.point, line.other_point)]
        sling = {"name": f"{name}_sling_{i + 1}", **of_rope, "length": spec.extension.sling_length}
        made.add("ropes", sling | {"path": [ends[0], sheave, ends[1]]}, f"lines.{entry}")
        end = {"body": body, "point": [0.0, 0.0, 2.0 * r]}
    start = {"body": f"{name}_pulley_{i + 1}", "point": [0.0, 0.0, 0.0]}
    rope = {"name": f"{name}_line_{i + 1}", **of_rope, "length": float(layout.lengths[i])}
    made.add("ropes", rope | {"path": [start, end]}, f"lines.{entry}")


def _add_massless(spec: Any, layout: _Layout, _places: Places, made: Made) -> None:
    """One rope whose path jumps from lug to lug."""
    path: list[dict[str, Any]] = []
    for x, i in zip(layout.offsets, _entries(spec), strict=True):
        line = spec.lines[i]
        path.append({"body": f"{spec.name}_beam", "point": [float(x), 0.0, -spec.sheave_depth]})
        path.append({"body": line.body, "point": list(line.point)})
    rope = {
        "name": f"{spec.name}_rope",
        "type": "equalized",
        "path": path,
        "lengths": listed(layout.lengths),
        "depth": spec.part_length,
        "up": spec.travel.up,
        "down": spec.travel.down,
        "axial_stiffness": spec.rope.axial_stiffness,
        "rope_length": _rope_length(spec),
        "line_stiffness": spec.line.axial_stiffness,
        "damping": spec.line.damping,
    } | _rubs(spec)
    made.add("ropes", rope, "lines")
