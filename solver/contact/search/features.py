"""What kinds of contact a scene has: only their code is executed.

The table of features belongs to the contacts; `touch` and `weigh` walk it as the step walks the tables of a scene.
"""

from __future__ import annotations

from typing import ClassVar

from heavylift.numerics.arrays import Arrays
from heavylift.solver.contact.kind import ContactRows, Features
from heavylift.solver.interface import Bodies, Workspace
from heavylift.solver.kinds import optional

__all__ = [
    "Curves",
    "Deforming",
    "Footprints",
    "Primitives",
    "Rings",
    "SurfaceWeights",
    "Surfaces",
    "touch",
    "weigh",
]


class Surfaces(Arrays):
    """Points and balls on surfaces; how many."""

    kernel_modules: ClassVar[tuple[str, ...]] = ("heavylift.solver.contact.search.narrow_phase_surface",)

    members: int


class Curves(Arrays):
    """Beads on curves, points and balls on cylinders and bands; how many."""

    kernel_modules: ClassVar[tuple[str, ...]] = ("heavylift.solver.contact.search.narrow_phase_curve",)

    members: int


class Rings(Arrays):
    """Thin rings on surfaces; how many."""

    kernel_modules: ClassVar[tuple[str, ...]] = ("heavylift.solver.contact.search.narrow_phase_ring",)

    members: int


class Primitives(Arrays):
    """Convex primitives on surfaces; how many."""

    kernel_modules: ClassVar[tuple[str, ...]] = ("heavylift.solver.contact.search.narrow_phase_primitive",)

    members: int


class Deforming(Arrays):
    """Contours whose control points move in their own axes; how many."""

    kernel_modules: ClassVar[tuple[str, ...]] = ("heavylift.solver.contact.search.search_start",)

    members: int


class SurfaceWeights(Arrays):
    """Contacts of any shape on surfaces that deform; how many."""

    kernel_modules: ClassVar[tuple[str, ...]] = ("heavylift.solver.contact.search.surface_weights",)

    members: int


class Footprints(Arrays):
    """Contacts on surfaces whose gap and force are means over a disc; how many."""

    kernel_modules: ClassVar[tuple[str, ...]] = ("heavylift.solver.contact.laws.footprint",)

    members: int


@optional()
def touch(
    features: Features,
    contacts: ContactRows,
    bodies: Bodies,
    c: int,
    cold: bool,
    y1: float,
    y2: float,
    y3: float,
    work: Workspace,
) -> None:
    """Search for the touched point of a contact whose point lies at y in the axes of the contour [m].

    A cold search begins everywhere, at samples of the contour, which contours that deform put where they are first.
    Its gaps go into the state of the contact, directions of the rows, lever, arm and slopes into the scratch arrays.
    """


@optional()
def weigh(
    features: Features, contacts: ContactRows, bodies: Bodies, c: int, y1: float, y2: float, y3: float
) -> None:
    """Control points that the touched point is made of, and their weights, into the scratch arrays."""
