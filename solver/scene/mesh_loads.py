"""What a user says of loads on frames and shells: each kind is a file of `frame_loads` or `shell_loads`. SI units."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import field
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import BodyDirection, Quantity, Shape
from heavylift.solver.scene.descriptions import Family, no_rows, upwards

if TYPE_CHECKING:
    from collections.abc import Sequence

    from heavylift.solver.scene.mesh_shapes import FrameMesh, ShellMesh
    from heavylift.solver.scene.meshes import DistributedLoad, FollowerLoad

__all__ = ["FRAME_LOADS", "SHELL_LOADS", "MeshLoad", "SpreadLoad", "Turning", "numbered"]

FRAME_LOADS: Family[Any] = Family("load", "heavylift.solver.scene.frame_loads", default="distributed")
"""Loads of frames, by their types in a case file."""
SHELL_LOADS: Family[Any] = Family("load", "heavylift.solver.scene.shell_loads", default="distributed")
"""Those of shells."""


def numbered(key: str, numbers: Sequence[int], count: int, what: str) -> NDArray[np.int64]:
    """Numbers of nodes or elements that a mesh has.

    Raises
    ------
    InputError
        With the key of the first that it has not.
    """
    for place, number in enumerate(numbers):
        if number >= count:
            raise InputError(
                f"there is no {what} {number}",
                key=f"{key}.{place}",
                expected=f"a number from 0 to {count - 1}",
            )
    return np.array(numbers, dtype=np.int64)


@FRAME_LOADS.part
@dataclass(frozen=True, eq=False, kw_only=True)
class MeshLoad(ABC):
    """What all loads have: a factor over time."""

    times: Annotated[NDArray[np.float64], Quantity("time"), Shape((None,))] = field(default_factory=no_rows)
    """Times of a table [s], increasing; constant without it."""
    factors: Annotated[NDArray[np.float64], Quantity("number"), Shape((None,))] = field(
        default_factory=no_rows
    )
    """What the load is multiplied by, linear in between, constant before and after."""

    @staticmethod
    def check(spec: Any) -> None:
        """A factor a time."""
        if len(spec.times) != len(spec.factors):
            problem = f"{len(spec.times)} times and {len(spec.factors)} factors"
            raise InputError(problem, expected="one factor a time")
        if any(b <= a for a, b in pairwise(spec.times)):
            raise InputError(f"times {list(spec.times)}", expected="increasing times")

    @property
    def table(self) -> dict[str, Any]:
        """Times and factors, if there are some."""
        return {"times": self.times, "factors": self.factors} if len(self.times) else {}

    @abstractmethod
    def load(self, mesh: FrameMesh | ShellMesh) -> DistributedLoad | FollowerLoad:
        """The load on a mesh.

        Raises
        ------
        InputError
            If it has no such element or node.
        """


@FRAME_LOADS.part
@dataclass(frozen=True, eq=False, kw_only=True)
class SpreadLoad(MeshLoad):
    """What loads on elements have."""

    elements: Annotated[tuple[int, ...], Interval(ge=0)] = ()
    """Numbers of the elements, from 0; all if empty."""

    def chosen(self, mesh: FrameMesh | ShellMesh) -> NDArray[np.int64] | None:
        """Elements that are loaded; None for all."""
        return numbered("elements", self.elements, len(mesh.elements), "element") if self.elements else None


@FRAME_LOADS.part
@dataclass(frozen=True, eq=False, kw_only=True)
class Turning:
    """What loads that turn with a frame have."""

    axis: Annotated[NDArray[np.float64], BodyDirection()] = field(default_factory=upwards)
    """World direction, any length; `normal` acts along ``axis x tangent``."""

    @staticmethod
    def check_load(spec: Any) -> None:
        """Something must act.

        Raises
        ------
        InputError
            If nothing does.
        """
        if not (spec.normal or spec.tangential):
            raise InputError("neither 'normal' nor 'tangential'", expected="one of them, or both")
