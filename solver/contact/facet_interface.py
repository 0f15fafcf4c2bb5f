"""What collisions ask of surfaces that deform, and those of the frames and shells under them.

All verbs are optional.
"""

from __future__ import annotations

from heavylift.contours.surface_pack import CollisionSurfaces
from heavylift.numerics.arrays import Floats2
from heavylift.solver.contact.facet_kind import FacetSurfaces
from heavylift.solver.contact.kind import ContactRows, DeformingSurfaces
from heavylift.solver.contact.mesh_kind import SurfacePairs
from heavylift.solver.interface import Bodies, Workspace
from heavylift.solver.kinds import optional

__all__ = [
    "bound_facets",
    "bound_surface_points",
    "form_facets",
    "form_surface_points",
    "put_surface_rows",
    "take_slots",
    "touch_facets",
]


# ---- of the surfaces ----


@optional()
def form_facets(facets: DeformingSurfaces, surfaces: CollisionSurfaces, bodies: Bodies) -> None:
    """Points, normals, edges and trees from the coordinates of the stage."""


@optional()
def bound_facets(facets: DeformingSurfaces, contacts: ContactRows, bodies: Bodies, step: float) -> None:
    """How far any of their points moves in the step at the velocity of the stage, into the poses."""


@optional()
def take_slots(facets: DeformingSurfaces, meshes: SurfacePairs, contacts: ContactRows, contact: int) -> None:
    """Moving points for a new contact of its pair; -1 if all of them are taken."""


@optional()
def touch_facets(
    facets: DeformingSurfaces,
    meshes: SurfacePairs,
    contacts: ContactRows,
    bodies: Bodies,
    work: Workspace,
    contact: int,
) -> None:
    """Rows of a contact of which a side deforms, after `meshes.touch` and the directions have been found."""


# ---- of bodies ----


@optional("contact")
def form_surface_points(bodies: Bodies, facets: FacetSurfaces, row: int, first: int, points: Floats2) -> None:
    """Points of a surface, which begin at row `first` of `points`, from the coordinates of the stage."""


@optional("contact")
def bound_surface_points(
    bodies: Bodies, facets: FacetSurfaces, row: int, contacts: ContactRows, step: float
) -> None:
    """`bound_facets` of one surface."""


@optional("contact")
def put_surface_rows(
    bodies: Bodies,
    facets: FacetSurfaces,
    row: int,
    slot: int,
    contacts: ContactRows,
    attachment: int,
    sign: float,
    work: Workspace,
) -> None:
    """Aim a moving point at the touched point of a contact, and put the rows of one side on its velocities.

    The touched point is the sum of the points in `facets.corners` times `facets.shares`; directions stand in the
    scratch of the contacts. The velocity of the point at the carried state goes into the workspace, so that rates are
    known at once at the end of a step; `settle_points` finds those of the middle.
    """
