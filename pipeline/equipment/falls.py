"""Falls of n parts: a rope between sheaves of a crown and those of a hook block, from one winch or two.

All sheaves of the crown turn about one axis, those of the block about another one below it; the rope turns the same way
over all of them, so that its parts run straight down on one side and up, by one sheave aside, on the other. With the
modulus EA, the distance H of the axes and the rest of the rope, arcs and lead, l::

    k = n^2 EA / (n H + l),        speed of the rope = n times that of the hook

"Integrated simulation ... (2018)", eq. (219), with the arcs of true tangents. Parts at a distance a from the middle
hold the block against turning about the vertical: sum T a^2/H. It does not tilt, as it hangs below its sheaves.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Absent, BodyPoint, NameOf, Positive, Quantity, Square
from heavylift.pipeline.equipment.moves import Move, check_moves, speeds_of
from heavylift.pipeline.equipment.parts import DOWN, EQUIPMENT, Equipment, given, heading, listed
from heavylift.solver.scene.connections import Winch

if TYPE_CHECKING:
    from heavylift.pipeline.equipment.parts import Made, Places

__all__ = ["Falls", "FallsRope", "HookBlock", "limit_winch", "sheaves_aside", "without_winch"]


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class FallsCrown:
    """Where a part of the falls is on what carries it."""

    body: Annotated[str, NameOf("side")]
    """Body, or ``"ground"``."""
    point: Annotated[NDArray[np.float64], BodyPoint()]
    """Middle of the axis of the crown, or place of a drum [m], in the coordinates of the geometry of the body; of the
    ground in the world."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class FallsRope:
    """The rope of falls."""

    axial_stiffness: Annotated[float, Positive("force")]
    """EA [N]."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """Tension per rate of elongation [N s/m], while it is taut."""
    tension: Annotated[float | None, Positive("force"), Absent()] = None
    """Tension at the start [N], in an equilibrium that at rest; the rope is unstretched at first if absent."""
    brake: Annotated[float | None, Positive("force")] = None
    """Tension at which the brake of its winch slips [N]: a scenario can let such a winch keep a tension, or hooks a
    load level."""
    fastest: Annotated[float | None, Positive("velocity")] = None
    """What its winch can do [m/s], as `fastest` of the winch of a rope: of falls as many times the speed of the hook as
    there are parts."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class HookBlock:
    """The hook block: sheaves about y of its axes, and the hook below them."""

    mass: Annotated[float, Positive("mass")]
    """Mass [kg]; its centre is half way from the sheaves to the hook."""
    inertia: Annotated[NDArray[np.float64] | None, Quantity("moment of inertia"), Square(3), Absent()] = None
    """About its centre of mass [kg m^2]; that of a box as deep as the hook and as wide as the sheaves if absent."""
    hook_depth: Annotated[float, Positive("length")] = 1.5
    """Of the hook below the axis of the sheaves [m]: what hangs on it is at ``[0, 0, -hook_depth]``."""


@EQUIPMENT.describe("falls")
@dataclass(frozen=True, eq=False, kw_only=True)
class Falls(Equipment):
    """A hook block on a rope of n parts, which a winch hauls in."""

    ORDER: ClassVar = 3
    OWN_NAME: ClassVar = False
    """The hook load that it writes has its name."""

    name: str
    crown: FallsCrown
    """Upper sheaves."""
    along: Annotated[tuple[float, float, float], Quantity("number")] = (1.0, 0.0, 0.0)
    """Horizontal direction in the planes of the sheaves at the start, in the world; any length. With a drum its parts
    run down on the side that is farther from it."""
    parts: Annotated[int, Interval(ge=2)]
    """Parts of rope that carry the block: an even number."""
    sheave_radius: Annotated[float, Positive("length")]
    """Of all sheaves [m]."""
    sheave_spacing: Annotated[float | None, Positive("length")] = None
    """Of sheaves beside each other [m]; a quarter of their radius if absent."""
    efficiency: Annotated[float, Quantity("number", minimum=0.5, maximum=1.0, closed=True)] = 1.0
    """Of each sheave, as that of ropes: 0.98 on roller bearings, 0.96 on plain ones."""
    drop: Annotated[float, Positive("length")]
    """Height of the axis of the crown above that of the block at the start [m]."""
    block: HookBlock
    """The hook block."""
    rope: FallsRope
    """The rope; its length is the initial geometric length, or follows from its tension."""
    drum: FallsCrown | None = None
    """First drum; the rope begins at the crown if absent."""
    other_drum: FallsCrown | None = None
    """Second drum; the rope ends at the crown if absent. Both haul in together."""
    moves: tuple[Move, ...] = ()
    """How the hook is hoisted, upwards if positive: distances and speeds of the hook, one move after the other."""
    winch: Winch | None = None
    """In place of `moves`, how the rope is hauled in, n times as fast as the hook moves."""

    @staticmethod
    def check(spec: Any) -> None:
        """The rope ends at the crown; the block is below it; moves follow each other."""
        if spec.parts % 2:
            raise InputError(f"{spec.parts} parts", key="parts", expected="an even number")
        heading(spec.along, "along")
        if spec.drop <= 2.0 * spec.sheave_radius:
            raise InputError(
                f"{spec.drop:.6g} m with sheaves of {spec.sheave_radius:.6g} m",
                key="drop",
                expected=f"more than {2.0 * spec.sheave_radius:.6g} m",
            )
        if spec.moves and spec.winch is not None:
            raise InputError("both 'moves' and 'winch'", key="winch", expected="one of them, or neither")
        check_moves(spec.moves, "moves")
        highest = np.cumsum([move.distance for move in spec.moves]).max(initial=0.0)
        if spec.drop - highest <= 2.0 * spec.sheave_radius:
            raise InputError(
                f"hoisted by {highest:.6g} m, and the block is {spec.drop:.6g} m below its crown",
                key="moves",
                expected=f"less than {spec.drop - 2.0 * spec.sheave_radius:.6g} m",
            )

    @staticmethod
    def build(spec: Any, places: Places, made: Made) -> None:
        """Write block, rope, what hangs on the hook, and the place of the block below its crown."""
        name, r, count = spec.name, spec.sheave_radius, spec.parts // 2
        along, angle = heading(spec.along, "along")
        across = np.cross(-DOWN, along)
        crown = places.world(spec.crown.body, spec.crown.point)
        aside = sheaves_aside(spec.parts, r, spec.sheave_spacing)
        spacing = spec.sheave_spacing or 0.25 * r
        depth, mass, width = spec.block.hook_depth, spec.block.mass, count * spacing
        box = [mass * (a * a + b * b) / 12.0 for a, b in ((width, depth), (2 * r, depth), (2 * r, width))]
        place = crown + spec.drop * DOWN
        centre = [0.0, 0.0, -0.5 * depth]
        inertia = spec.block.inertia or box
        made.rigid(f"{name}_block", mass, inertia, place, angle, key="block", centre_of_mass=centre)

        def on_crown(x: float, y: float) -> dict[str, Any]:
            point = places.local(spec.crown.body, crown + x * along + y * across)
            return {"body": spec.crown.body, "point": listed(point)}

        rubs = {"efficiency": spec.efficiency} if spec.efficiency < 1.0 else {}

        def sheave(y: float) -> dict[str, Any]:
            start = places.local(spec.crown.body, crown)
            axis = places.local(spec.crown.body, crown + across) - start
            return on_crown(0.0, y) | {"radius": r, "axis": listed(axis)} | rubs

        path = [on_crown(r, float(aside[0]))]
        if spec.drum is not None:
            path = [_drum(spec, "drum", crown, along, places), sheave(float(aside[0]))]
        for k in range(count):
            lower = {"body": f"{name}_block", "point": [0.0, float(aside[k]), 0.0]}
            path.append(lower | {"radius": r, "axis": [0.0, 1.0, 0.0]} | rubs)
            if k < count - 1:
                path.append(sheave(0.5 * float(aside[k] + aside[k + 1])))
        if spec.other_drum is None:
            path.append(on_crown(-r, float(aside[-1])))
        else:
            path += [sheave(float(aside[-1])), _drum(spec, "other_drum", crown, -along, places)]
        rope = {"name": f"{name}_rope", "path": path} | without_winch(spec.rope)
        if spec.moves:
            rope["winch"] = speeds_of(spec.moves, float(spec.parts))
        elif spec.winch is not None:
            rope["winch"] = given(spec.winch)
        if spec.other_drum is not None and (spec.drum is None or spec.efficiency < 1.0):
            end = "last" if spec.drum is None else "both"
            rope["winch"] = rope.get("winch", {"times": [0.0], "speeds": [0.0]}) | {"end": end}
        if spec.rope.brake is not None and spec.efficiency < 1.0:
            raise InputError(
                "a brake that answers to the tension, on a rope over sheaves with an efficiency",
                key="rope.brake",
                expected="no 'brake', or an efficiency of 1",
            )
        limit_winch(rope, spec.rope)
        made.add("ropes", rope, "rope")
        if places.has_steps():
            load = {"name": name, "body": f"{name}_block", "ropes": [f"{name}_rope"]}
            made.add("hook_loads", load, "block")
        middle = places.local(spec.crown.body, crown)
        lead = {"name": f"{name}_lead", "between": [spec.crown.body, f"{name}_block"]}
        lead |= {
            key: listed(places.local(spec.crown.body, crown + way) - middle)
            for key, way in (("axis", DOWN), ("normal", across))
        }
        made.add("leads", lead | {"points": [list(spec.crown.point), [0.0, 0.0, 0.0]]}, "crown")


def sheaves_aside(parts: int, radius: float, spacing: float | None) -> NDArray[np.float64]:
    """Places of the sheaves of a block along their axis [m], shape (parts / 2,)."""
    count = parts // 2
    return np.asarray((np.arange(count) - 0.5 * (count - 1)) * (spacing or 0.25 * radius))


def limit_winch(rope: dict[str, Any], spec: Any) -> None:
    """Give the winch of a rope that is written its brake and the speed that it can do."""
    if spec.brake is not None:
        rope["winch"] = rope.get("winch", {}) | {"brake": spec.brake}
    if spec.fastest is not None:
        rope["winch"] = rope.get("winch", {"times": [0.0], "speeds": [0.0]}) | {"fastest": spec.fastest}


def without_winch(rope: Any) -> dict[str, Any]:
    """What is given of a rope beside its winch."""
    return {key: value for key, value in given(rope).items() if key not in {"brake", "fastest"}}


def _drum(
    spec: Any, key: str, crown: NDArray[np.float64], along: NDArray[np.float64], places: Places
) -> dict[str, Any]:
    """Place of a drum, on the side from which its lead comes over the crown."""
    drum = getattr(spec, key)
    place = places.world(drum.body, drum.point) - crown
    if place @ along > -spec.sheave_radius:
        raise InputError(
            f"it is {float(place @ along):.6g} m from the crown along 'along'",
            key=f"{key}.point",
            expected=f"less than {-spec.sheave_radius:.6g} m: the lead comes over the crown from that side"
            if key == "drum"
            else f"less than {-spec.sheave_radius:.6g} m the other way: the lead leaves over the crown on that side",
        )
    return {"body": drum.body, "point": list(drum.point)}
