"""What kinds of contact a scene has: only their code is compiled.

The tuple of features belongs to the contacts; `touch` and `weigh` walk it as the step walks the kinds of a scene.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from heavylift.solver.interface import Workspace
from heavylift.solver.kinds import optional

__all__ = [
    "Curves",
    "Deforming",
    "Footprints",
    "Primitives",
    "Rings",
    "SurfaceWeights",
    "Surfaces",
    "sample",
    "touch",
    "weigh",
]


class Surfaces(NamedTuple):
    """Points and balls on surfaces; how many."""

    members: int


class Curves(NamedTuple):
    """Beads on curves, points and balls on cylinders and bands; how many."""

    members: int


class Rings(NamedTuple):
    """Thin rings on surfaces; how many."""

    members: int


class Primitives(NamedTuple):
    """Convex primitives on surfaces; how many."""

    members: int


class Deforming(NamedTuple):
    """Contours whose control points move in their own axes; how many."""

    members: int


class SurfaceWeights(NamedTuple):
    """Contacts of any shape on surfaces that deform; how many."""

    members: int


class Footprints(NamedTuple):
    """Contacts on surfaces whose gap and force are means over a disc; how many."""

    members: int


@optional
def sample(features: Any, contacts: Any, bodies: Any, contour: int) -> None:
    """Before a search from everywhere: control points and samples of a contour where it is now."""


@optional
def touch(
    features: Any,
    contacts: Any,
    bodies: Any,
    c: int,
    cold: bool,
    y1: float,
    y2: float,
    y3: float,
    work: Workspace,
) -> None:
    """Search for the touched point of a contact whose point lies at y in the axes of the contour [m].

    Its gaps go into the state of the contact, directions of the rows, lever, arm and slopes into the scratch arrays.
    """


@optional
def weigh(features: Any, contacts: Any, bodies: Any, c: int, y1: float, y2: float, y3: float) -> None:
    """Control points that the touched point is made of, and their weights, into the scratch arrays."""
