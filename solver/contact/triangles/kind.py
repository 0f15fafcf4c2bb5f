"""The kind of pairs of surfaces of triangles that may touch: beside the contacts, which come and go."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.triangles.feature_gap import FeatureTouch
from heavylift.contours.triangles.feature_report import ContactList
from heavylift.contours.triangles.surface_layout import RelativeMotion, RelativePose
from heavylift.contours.triangles.surface_pack import CollisionSurfaces
from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints1, Ints2
from heavylift.numerics.records import Record, Records, Vector, record_at
from heavylift.solver.contact.kind import ContactState, ContactValues
from heavylift.solver.extremes import Extremes
from heavylift.solver.kinds import Table

if TYPE_CHECKING:
    from heavylift.solver.contact.triangles.feature_search import FeatureSearches, FoundCount

__all__ = [
    "PLACED_WIDTH",
    "Clearing",
    "ContactHeader",
    "Fault",
    "GoneContacts",
    "PairSide",
    "SurfacePair",
    "SurfacePairs",
    "contact_header",
    "gone_contacts",
    "placed_pose",
]

BothInts = Annotated[NDArray[np.int64], (2,)]
BothFloats = Annotated[NDArray[np.float64], (2,)]


class SurfacePair(Record):
    """Two surfaces that may touch.

    Attributes
    ----------
    surfaces, poses
        Numbers of both, and rows of their poses.
    law, force_law
        Of their contacts.
    events
        Whether steps are split at impacts.
    method
        Of the search.
    column
        First record column.
    most
        Most contacts at once.
    first_recorded, recorded
        Those that are recorded: the first in `SurfacePairs.recorded_columns`, and how many.
    sleepers, followed
        Of both sides as in a contact; whether the rows of its contacts are those of where it sleeps.
    deforms, keeps
        Whether a surface deforms; whether a search is kept while the pair stands still.
    outside
        Of both surfaces: 1 if the other one began outside of its closed parts, -1 if within, 0 if nobody knows.
    patch_cosine, patch_size
        Cosine of the angle between normals of one patch, and its size [m].
    radii, border
        Sum of both roundings [m]; how far beyond the border of its face a contact is still on it [m].
    reach, patches
        Reach of the search in the last step [m], and how many patches it made.
    members, first_member, last_member
        How many contacts it has, in a search or record; the first and the last of them, -1 without, see
        `SurfacePairs.next_member`.
    measured
        Whether its clearance is asked for.
    force, borne, middle, gap, changed
        Sum of the normal forces, of those in the middle of the step, and of the forces there in the world [N], smallest
        gap [m] of its contacts, and whether others bear than in the step before, while those of a step are noted.
    """

    surfaces: BothInts
    poses: BothInts
    law: int
    force_law: int
    events: bool
    method: int
    column: int
    most: int
    first_recorded: int
    recorded: int
    sleepers: BothInts
    followed: bool
    deforms: bool
    keeps: bool
    outside: BothFloats
    patch_cosine: float
    patch_size: float
    radii: float
    border: float
    reach: float
    patches: int
    members: int
    first_member: int
    last_member: int
    measured: bool
    force: float
    borne: float
    middle: Vector
    gap: float
    changed: bool


class PairSide(Record):
    """First velocity, number of velocities and holder of the body of a surface, as in an attachment."""

    dof: int
    width: int
    holder: int


class Fault(Record):
    """Contacts that act as none can, of a pair.

    Attributes
    ----------
    count, first
        In how many steps some did, counted for each, and when the first one did [s].
    force
        Largest force of one [N]; of a contact without compliance that of whole steps.
    """

    count: int
    first: float
    force: float


class GoneContacts(Record):
    """Of a pair: sums over contacts that are gone, as of a contact: impulses, energy, number, slip path; and extremes.

    Attributes
    ----------
    impulse, impact_impulse, loss, impacts, slip_path
        Sums.
    jumps
        Of the pair: sum of what its contacts have stored less by jumps [J]. While it is positive it is lost, though it
        may come back; a negative one comes from nowhere, so it is no negative loss but stays in the balance.
    forces, gaps
        Extremes of the sum of the normal forces and of the smallest gap.
    middle
        Of the pair: sum of the forces in the middle of the last step, in the world [N].
    strongest
        Largest normal force of a contact since the start [N].
    pulls, turned, opposed
        Contacts that pulled; that pushed into a closed surface; of two at the ends of one edge that pushed it from both
        sides of one face.
    """

    impulse: float
    impact_impulse: float
    loss: float
    impacts: int
    slip_path: float
    jumps: float
    forces: Extremes
    gaps: Extremes
    middle: Vector
    strongest: float
    pulls: Fault
    turned: Fault
    opposed: Fault


class ContactHeader(Record):
    """How many contacts between triangles there are."""

    count: int


placed_pose, gone_contacts, contact_header = (
    record_at(RelativePose),
    record_at(GoneContacts),
    record_at(ContactHeader),
)
"""What rows of `placed` begin with: poses of the surfaces, then one row for each pair, then a single one."""

PLACED_WIDTH = max(one.layout.itemsize // 8 for one in (RelativePose, GoneContacts, ContactHeader))
"""Words in a row of `placed`."""


class Clearing(Table):
    """Pairs whose distance is recorded, a kind or none."""


class SurfacePairs(Arrays):
    """Surfaces, pairs of them, and what their search needs.

    Attributes
    ----------
    surfaces, searches
        Packed triangles with their trees, and what finds features that meet.
    pairs
        The pairs.
    sides
        Of each pair two.
    recorded_columns
        First record columns of the contacts that pairs record one by one, shape (r,).
    pair_values
        Constants of the contacts of each pair, as in `ContactRows.values`.
    relative
        Pose of the second surface in the axes of the first at the stage.
    motions
        The same at both ends of the step.
    found, counts
        What the search of a pair has found, and how many.
    touch
        Normal, points on both features and how far they lie beside them, of one contact.
    points, normals, depths, active, owners, patch_of
        Of the contacts of a pair, then of what was found beside them: place and normal in the axes of the first
        surface, gap [m], 1 if it is a contact already, its number in its own list, patch.
    keeps
        Of what was found: patch that it becomes a contact of, or -1.
    chosen, sums, grid
        Scratch of patches: shapes (n, 4), (n,) and as long as they need.
    next_member
        Contact of the same pair that follows each contact, -1 behind the last one.
    slots, chains, entered
        Table in which contacts are looked up by their features: first contact of each slot, -1 without, and the next
        one of each contact; how many have been entered since it was emptied, then their slots.
    kept
        Contacts found in a step that is taken back.
    outward, edge_outward
        Of triangles and edges, as in `ClosedParts`; no search reads them.
    clearances
        Pairs whose distance is recorded: one kind or none.
    """

    kernel_modules: ClassVar[tuple[str, ...]] = (
        "heavylift.solver.contact.triangles.load_transfer",
        "heavylift.solver.contact.triangles.record",
        "heavylift.solver.contact.triangles.search",
        "heavylift.solver.contact.triangles.slots",
        "heavylift.solver.contact.triangles.narrow_phase",
    )

    surfaces: CollisionSurfaces
    searches: FeatureSearches
    pairs: Records[SurfacePair]
    sides: Records[PairSide]
    recorded_columns: Ints1
    pair_values: Records[ContactValues]
    relative: Records[RelativePose]
    motions: Records[RelativeMotion]
    found: ContactList
    counts: FoundCount
    touch: FeatureTouch
    points: Floats2
    normals: Floats2
    depths: Floats1
    active: Ints1
    owners: Ints1
    patch_of: Ints1
    keeps: Ints1
    chosen: Ints2
    sums: Floats1
    grid: Ints1
    next_member: Ints1
    slots: Ints1
    chains: Ints1
    entered: Ints1
    kept: Records[ContactState]
    outward: Floats1
    edge_outward: Floats2
    clearances: Clearing
