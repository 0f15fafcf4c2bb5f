"""What the collisions of a scene add to its contacts; nothing, in most scenes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.records import Records, records
from heavylift.solver.contact.kind import Colliding, ContactContour, ContourPose
from heavylift.solver.contact.triangles.facet_kind import FacetSurfaces

__all__ = ["PackedCollisions", "no_collisions"]


@dataclass(frozen=True, eq=False)
class PackedCollisions:
    """What the collisions add to the contacts.

    Attributes
    ----------
    meshes
        The kind; empty without collisions.
    facets
        Surfaces that deform.
    contours, poses
        Rows for the surfaces, behind those of the contours.
    placed
        As in `ContactRows`.
    most
        Contacts at once.
    all_rigid
        Whether all surfaces are on rigid bodies, hulls apart, or the ground.
    widest
        Velocities that a side of a contact sees at most.
    """

    meshes: Colliding
    facets: FacetSurfaces
    contours: Records[ContactContour]
    poses: Records[ContourPose]
    placed: NDArray[np.float64]
    most: int
    all_rigid: bool
    widest: int = 6


def no_collisions() -> PackedCollisions:
    """Of scenes whose contacts are all with contours."""
    return PackedCollisions(
        Colliding(),
        FacetSurfaces.none(),
        records(ContactContour, 0),
        records(ContourPose, 0),
        np.zeros((1, 12)),
        0,
        False,
    )
