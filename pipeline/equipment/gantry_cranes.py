"""Gantry cranes: a girder that travels on rails, trolleys that run on it, and hoists on the trolleys.

"Integrated simulation ... (2018)", sections 1.2.1 and 4.1.1: an upper trolley with two hoists and a lower one that
passes under it. The crane runs along its rails, y, trolleys along the girder, x. Girder and trolleys are driven:
they go where their moves say, and what that takes is recorded. Each hook is one of `Falls`.

A load on a rope of length l that is accelerated by a for the time t of a ramp swings on with the amplitude
``2 (a/g) l |sin(w t/2)|``, w = sqrt(g/l): a ramp of one period leaves none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from annotated_types import Interval

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import InWorld, Least, Positive, Quantity
from heavylift.pipeline.equipment.falls import FallsRope, HookBlock
from heavylift.pipeline.equipment.moves import Move, check_moves, speeds_of
from heavylift.pipeline.equipment.parts import EQUIPMENT, Equipment, given, listed

if TYPE_CHECKING:
    from heavylift.pipeline.equipment.parts import Made, Places

__all__ = ["GantryCrane"]


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class Hoist:
    """A hoist on a trolley, and its hook."""

    at: Annotated[tuple[float, float], Quantity("length")] = (0.0, 0.0)
    """Of the crown along and across the girder, from the middle of the trolley [m]."""
    drop: Annotated[float, Positive("length")]
    """Height of the crown above the sheaves of the hook block at the start [m]."""
    parts: Annotated[int, Interval(ge=2)]
    """Parts of rope: an even number."""
    moves: tuple[Move, ...] = ()
    """How the hook is hoisted, upwards if positive."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class Trolley:
    """A trolley on the girder."""

    mass: Annotated[float, Positive("mass")] = 1e5
    """Mass [kg]; it counts in the force that drives it."""
    position: Annotated[float, Quantity("length")] = 0.0
    """Of its middle from that of the girder at the start [m]."""
    moves: tuple[Move, ...] = ()
    """How it runs along the girder."""
    hoists: Annotated[tuple[Hoist, ...], Least(1)]
    """Its hoists."""


@EQUIPMENT.describe("gantry_cranes")
@dataclass(frozen=True, eq=False, kw_only=True)
class GantryCrane(Equipment):
    """A girder on legs that travels on rails, with trolleys and hoists."""

    ORDER: ClassVar = 1

    name: str
    position: Annotated[tuple[float, float, float], Quantity("length"), InWorld()] = (0.0, 0.0, 0.0)
    """Middle between the rails at the start, in the world [m]; the girder lies along x."""
    span: Annotated[float, Positive("length")]
    """Between the rails [m]: trolleys stay within it."""
    girder_height: Annotated[float, Positive("length")]
    """Of the crowns of all hoists above the rails [m]."""
    mass: Annotated[float, Positive("mass")] = 3e6
    """Of girder and legs [kg]; it counts in the force that drives it."""
    moves: tuple[Move, ...] = ()
    """How it travels along its rails, y."""
    trolleys: Annotated[tuple[Trolley, ...], Least(1)]
    """On the girder."""
    sheave_radius: Annotated[float, Positive("length")]
    """Of all sheaves [m]."""
    efficiency: Annotated[float, Quantity("number", minimum=0.5, maximum=1.0, closed=True)] = 1.0
    """Of each sheave, as that of ropes."""
    block: HookBlock
    """Each hook block."""
    rope: FallsRope
    """Ropes of all falls."""

    @staticmethod
    def check(spec: Any) -> None:
        """Moves follow each other, trolleys stay on the girder, hooks above the rails."""
        check_moves(spec.moves, "moves")
        for i, trolley in enumerate(spec.trolleys):
            check_moves(trolley.moves, f"trolleys.{i}.moves")
            at = trolley.position + np.cumsum([0.0, *(move.distance for move in trolley.moves)])
            if np.abs(at).max() > 0.5 * spec.span:
                raise InputError(
                    f"it comes {float(np.abs(at).max()):.6g} m from the middle of a girder of {spec.span:.6g} m",
                    key=f"trolleys.{i}.{'moves' if trolley.moves else 'position'}",
                    expected=f"at most {0.5 * spec.span:.6g} m",
                )
            for k, hoist in enumerate(trolley.hoists):
                lowest = hoist.drop - np.cumsum([0.0, *(move.distance for move in hoist.moves)]).min()
                if lowest + spec.block.hook_depth >= spec.girder_height:
                    raise InputError(
                        f"the hook comes {float(lowest) + spec.block.hook_depth:.6g} m below a girder that is "
                        f"{spec.girder_height:.6g} m high",
                        key=f"trolleys.{i}.hoists.{k}.drop",
                        expected="a hook above the rails",
                    )

    @staticmethod
    def build(spec: Any, _places: Places, made: Made) -> None:
        """Write girder, trolleys and falls."""
        name = spec.name
        middle = np.array(spec.position) + np.array([0.0, 0.0, spec.girder_height])
        along = {"y": speeds_of(spec.moves)} if spec.moves else {}
        size = (spec.span, 6.0, 6.0)
        _driven(made, f"{name}_girder", spec.mass, size, middle, along, "mass")
        for i, trolley in enumerate(spec.trolleys):
            body, key = f"{name}_trolley_{i + 1}", f"trolleys.{i}"
            place = middle + np.array([trolley.position, 0.0, 0.0])
            frame = along | ({"x": speeds_of(trolley.moves)} if trolley.moves else {})
            reach = 2.0 * np.abs([hoist.at for hoist in trolley.hoists]).max(axis=0)
            _driven(made, body, trolley.mass, (reach[0] + 4.0, reach[1] + 4.0, 2.0), place, frame, key)
            for k, hoist in enumerate(trolley.hoists):
                falls: dict[str, Any] = {
                    "name": f"{name}_hook_{i + 1}_{k + 1}",
                    "crown": {"body": body, "point": [*hoist.at, 0.0]},
                    "parts": hoist.parts,
                    "sheave_radius": spec.sheave_radius,
                    "efficiency": spec.efficiency,
                    "drop": hoist.drop,
                    "block": given(spec.block),
                    "rope": given(spec.rope),
                    "moves": [given(move) for move in hoist.moves],
                }
                made.add("falls", falls, f"{key}.hoists.{k}")


def _driven(
    made: Made, name: str, mass: float, size: Any, place: Any, tables: dict[str, Any], key: str
) -> None:
    """A body that goes where its tables say, or stays where it is: a box of a size [m]."""
    a, b, c = (mass * float(x) ** 2 / 12.0 for x in size)
    entry = {
        "type": "rigid",
        "mass": mass,
        "inertia": [b + c, a + c, a + b],
        "frame": {"motion": "driven", **tables} if tables else {"motion": "fixed"},
        "initial": {"position": listed(place)},
    }
    made.body(name, entry, key)
