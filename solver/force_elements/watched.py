"""Ropes that something watches: which they are, and where they leave what they pull with."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, records
from heavylift.solver.force_elements.line_forces import LineForce
from heavylift.solver.scene.connections import PackedForce

if TYPE_CHECKING:
    from heavylift.solver.scene.scene import Scene

__all__ = ["WatchedRopes", "WatchesRopes", "watch_ropes_of"]


@dataclass(frozen=True, eq=False, kw_only=True)
class WatchesRopes(PackedForce):
    """Base of measures of ropes: they say which, and find them in the `WatchedRopes` of the packing context."""

    STEPS: ClassVar[bool] = False
    """Whether it follows from step to step, as `dele2` makes them, and is refused with another integrator."""

    name: str


@dataclass(frozen=True, eq=False)
class WatchedRopes:
    """Ropes that something watches.

    Attributes
    ----------
    pulls
        What they pull with at all places of their paths, one rope after the other.
    first
        Place in `pulls` of the first place of each, by its name.
    ropes, bodies
        All ropes and bodies of the scene, by name.
    gravity
        Acceleration [m/s^2], shape (3,).
    """

    pulls: Records[LineForce]
    first: Mapping[str, int]
    ropes: Mapping[str, Any]
    bodies: Mapping[str, Any]
    gravity: NDArray[np.float64]

    def places_on(self, rope: str, body: str) -> list[int]:
        """Numbers, from 0 on, of the places of a rope that are on a body."""
        return [k for k, stop in enumerate(self.ropes[rope].path) if stop.body == body]

    def members(self, rope: str) -> list[list[int]]:
        """Places in `pulls` that have the tensions of the parts of a rope; of lines of one force, of each line."""
        first, thing = self.first[rope], self.ropes[rope]
        if len(thing.legs) > 1:
            lengths = [len(leg) for leg in thing.legs]
            starts = np.cumsum([0, *lengths[:-1]])
            return [[first + int(s)] for s in starts]
        return [[first + k for k in range(len(thing.path) - 1)]]


def watch_ropes_of(scene: Scene, integrator: str) -> WatchedRopes:
    """Give the ropes that something watches their places.

    Raises
    ------
    InputError
        If one does not exist, or a measure follows steps that the integrator does not make.
    """
    by_name = {rope.name: rope for rope in scene.ropes}
    first: dict[str, int] = {}
    count = 0
    measure: Any
    for measure in scene.forces:
        if getattr(measure, "STEPS", False) and integrator != "dele2":
            raise InputError(
                f"it follows the steps of 'dele2', and the integrator is {integrator!r}",
                source=measure.name,
                expected="integrator = 'dele2', or a case without it",
            )
        for name in measure.watched_ropes:
            if name not in by_name:
                raise InputError(
                    f"there is no rope {name!r}",
                    source=measure.name,
                    key="rope" if hasattr(measure, "rope") else "ropes",
                    expected=f"one of: {', '.join(by_name) or 'none'}",
                )
            if name not in first:
                first[name] = count
                count += len(by_name[name].path)
    bodies = {body.name: body for body in scene.bodies}
    return WatchedRopes(records(LineForce, count), first, by_name, bodies, scene.gravity)
