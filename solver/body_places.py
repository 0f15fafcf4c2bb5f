"""Where the bodies of a kind are among those of a scene: what their packing is given beside the bodies themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import TYPE_CHECKING, Any

from heavylift.numerics.classes import dataclass
from heavylift.solver.markers import BodyMarkers
from heavylift.solver.scene.outputs import Columns

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


__all__ = ["BodyPlaces", "SeaPlaces"]


@dataclass(frozen=True, eq=False)
class SeaPlaces:
    """What hulls are packed with.

    Attributes
    ----------
    sea
        A `heavylift.solver.scene.sea.Sea`.
    tangents, rate_tangents
        Arrays in which lines and fenders leave their stiffness and damping, shapes (n, 9).
    line_ends
        Body, marker and row of `tangents` of each end of a line that is on a hull.
    columns
        First record columns of tanks and pumps, by name.
    step
        Length of all steps [s], 0 if they vary.
    notes
        Receives what the user should know.
    """

    sea: Any
    tangents: NDArray[np.float64]
    rate_tangents: NDArray[np.float64]
    line_ends: Sequence[tuple[str, int, int]]
    columns: Mapping[str, Columns]
    step: float
    notes: list[str]


@dataclass(frozen=True, eq=False)
class BodyPlaces:
    """Of the bodies of one kind, in their order.

    Attributes
    ----------
    number
        Of the first in the scene; the others follow.
    dofs
        First velocity of each in the workspace.
    columns
        Where each is in a record.
    markers, sensors
        Points and directions of each, and points of it that are recorded.
    moving
        Number of the points of each that contacts move over it.
    sea
        For hulls.
    """

    number: int
    dofs: Sequence[int]
    columns: Sequence[Columns]
    markers: Sequence[BodyMarkers]
    sensors: Sequence[BodyMarkers]
    moving: Sequence[int] = field(default=())
    sea: SeaPlaces | None = None
