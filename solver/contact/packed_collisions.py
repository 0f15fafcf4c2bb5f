"""What the collisions of a scene add to its contacts; nothing, in most scenes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.records import Records, records
from heavylift.solver.contact.kind import Colliding, ContactContour, ContourPose, Sleeper
from heavylift.solver.contact.triangles.facet_kind import FacetSurfaces
from heavylift.solver.contact.triangles.modal_kind import ModalSurfaces
from heavylift.solver.rows.structure import DIAGONAL, FACTORED, PRESCRIBED

__all__ = ["PackedCollisions", "moves_rigidly", "no_collisions"]


@dataclass(frozen=True, eq=False)
class PackedCollisions:
    """What the collisions add to the contacts.

    Attributes
    ----------
    meshes
        The kind; empty without collisions.
    facets, modal
        Surfaces that deform, as in `ContactRows`.
    contours, poses
        Rows for the surfaces, behind those of the contours.
    placed
        As in `ContactRows`.
    most
        Contacts at once.
    all_rigid
        Whether all surfaces are on what has six velocities or none.
    widest
        Velocities that a side of a contact sees at most.
    sides
        First velocity, number and holder of the bodies that collide.
    sleepers
        Those of them that may sleep.
    """

    meshes: Colliding
    facets: FacetSurfaces
    modal: ModalSurfaces
    contours: Records[ContactContour]
    poses: Records[ContourPose]
    placed: NDArray[np.float64]
    most: int
    all_rigid: bool
    widest: int = 6
    sides: Sequence[Any] = ()
    sleepers: Records[Sleeper] = field(default_factory=lambda: records(Sleeper, 0))


def moves_rigidly(side: Any) -> bool:
    """Whether what is attached has six velocities or none: rigid bodies, hulls with a database of their own, ground."""
    return side.holder in {DIAGONAL, PRESCRIBED} or (side.holder == FACTORED and side.width == 6)


def no_collisions() -> PackedCollisions:
    """Of scenes whose contacts are all with contours."""
    return PackedCollisions(
        Colliding(),
        FacetSurfaces.none(),
        ModalSurfaces.none(),
        records(ContactContour, 0),
        records(ContourPose, 0),
        np.zeros((1, 12)),
        0,
        False,
    )
