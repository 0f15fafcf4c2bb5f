"""What contacts ask of pairs of surfaces of triangles: operations, all of them optional."""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.solver.contact.kind import Colliding, ContactRows
from heavylift.solver.contact.triangles.kind import Clearing, SurfacePairs
from heavylift.solver.interface import Bodies, Workspace
from heavylift.solver.kinds import optional
from heavylift.solver.scene.collisions import CollisionOutputs

__all__ = [
    "keep_found",
    "place_surfaces",
    "pose_surfaces",
    "record_clearance",
    "record_pairs",
    "search_surfaces",
    "touch_triangles",
    "watch_clearance",
    "watch_pairs",
]


@optional()
def pose_surfaces(meshes: Colliding, contacts: ContactRows) -> None:
    """Pose of the second surface of each pair in the axes of the first, from the poses of the stage.

    What follows from the points of surfaces that deform comes first.
    """


@optional()
def touch_triangles(
    meshes: Colliding, contacts: ContactRows, bodies: Bodies, c: int, work: Workspace
) -> None:
    """Gap, directions and rows of a contact at the stage."""


@optional("search")
def search_surfaces(
    meshes: Colliding, contacts: ContactRows, bodies: Bodies, work: Workspace, step: float, first: bool
) -> None:
    """Contacts at the end of the step: those whose features have met on the way or are near, with gaps and rows.

    The first search, before time starts, has both ends of the step at the start.
    """


@optional()
def keep_found(meshes: Colliding, contacts: ContactRows, before: bool) -> None:
    """Contacts found in a step that is taken back outlive it: called before the state is restored, and after."""


@optional()
def place_surfaces(meshes: Colliding, contacts: ContactRows) -> None:
    """When a step stands: poses of the surfaces at its end, where the next one begins.

    Contacts that are far away again go, and leave their sums to their pair.
    """


@optional()
def watch_pairs(meshes: Colliding, contacts: ContactRows, work: Workspace) -> None:
    """When a step stands: extremes of forces and gaps of pairs since the last record; contacts that act as none can."""


@optional()
def watch_clearance(
    clearances: Clearing, meshes: SurfacePairs, contacts: ContactRows, pair: int, interval: int
) -> None:
    """Smallest distance of a pair in an interval between records, where it is more than the search reaches."""


@optional("record")
def record_clearance(
    clearances: Clearing, meshes: SurfacePairs, contacts: ContactRows, pair: int, out: CollisionOutputs
) -> None:
    """Distance of the surfaces of a pair into its record, where it is more than the search reaches."""


@optional("record")
def record_pairs(meshes: Colliding, contacts: ContactRows, work: Workspace, row: Floats1) -> None:
    """Channels of pairs into a record, and what their contacts have stored and lost into the sums of energy."""
