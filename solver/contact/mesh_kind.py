"""The kind of pairs of surfaces of triangles that may touch: beside the contacts, which come and go."""

from __future__ import annotations

from typing import ClassVar

from heavylift.contours.pair_list import PairLists
from heavylift.contours.surface_pack import CollisionSurfaces
from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints1, Ints2
from heavylift.numerics.records import Records
from heavylift.solver.contact.kind import ContactState
from heavylift.solver.kinds import Table

__all__ = ["Clearing", "DeformingSurfaces", "SurfacePairs"]

# columns of `pairs`
FIRST, SECOND, FIRST_POSE, SECOND_POSE, PAIR_LAW, PAIR_FORCE_LAW, PAIR_EVENTS, METHOD, PAIR_COLUMN = range(9)
MOST, RECORDED, DEFORMS, PAIR_COLUMNS = 9, 10, 11, 12
"""Numbers of both surfaces, rows of their poses; law; force law; 1 to split steps; method of the search; first record
column; most contacts at once; contacts that are recorded; 1 if a surface deforms."""

# columns of `sides`: of both surfaces
SIDE_DOF, SIDE_WIDTH, SIDE_HOLDER = range(3)
SIDE_COLUMNS = 6

# columns of `pair_values` behind those of a contact
PATCH_COSINE, PATCH_SIZE, RADII, PAIR_REACH, PAIR_PATCHES = range(32, 37)
PAIR_VALUES = 37
"""Cosine of the angle between normals of one patch; its size [m]; sum of both roundings [m]; reach of the search in
the last step [m], and how many patches it made."""

# rows of `placed` behind the poses of the surfaces and the sums of pairs: a single one
COUNT_AT = 0

# columns of the sums of a pair in `placed`: of contacts that are gone
GONE_IMPULSE, GONE_LOSS, GONE_IMPACTS, GONE_PATH = range(4)
"""Normal impulses [N s], energy lost [J], impacts, slip path [m]."""

# columns of `found`: as in `heavylift.contours.feature_pairs`
FOUND_KIND, FOUND_FIRST, FOUND_SECOND, FOUND_HIT, FOUND_COLUMNS = range(5)

# columns of `found_values`
FOUND_TIME, FOUND_SIDE, FOUND_GAP, FOUND_NUMBERS = range(4)

# what `gap_of_features` leaves in `touch`
NORMAL_AT, POINT_AT, OTHER_AT, BESIDE_AT, TOUCH_NUMBERS = 0, 3, 6, 9, 10


class Clearing(Table):
    """Pairs whose distance is recorded, a kind or none."""


class DeformingSurfaces(Table):
    """The surfaces of triangles that deform, a kind or none."""


class SurfacePairs(Arrays):
    """Surfaces, pairs of them, and what their search needs; columns are named at the top of this file.

    Attributes
    ----------
    surfaces, lists
        Packed triangles with their trees, and lists of triangles that are near each other.
    pairs, sides, pair_values
        Of each pair, shapes (np, 12), (np, 6), (np, 37).
    relative
        Pose of the second surface in the axes of the first at the stage: rotation matrix and origin, shape (np, 12).
    motions
        The same at both ends of the step, shape (np, 24).
    found, found_values
        What the search of a pair has found: shapes (n, 4), (n, 3).
    touch
        Of one contact: normal, points on both features and how far they lie beside them, shape (10,).
    points, normals, depths, active, owners, patch_of
        Of the contacts of a pair, then of what was found beside them: place and normal in the axes of the first
        surface, gap [m], 1 if it is a contact already, its number in its own list, patch.
    keeps
        Of what was found: patch that it becomes a contact of, or -1.
    chosen, sums, grid
        Scratch of patches: shapes (n, 4), (n,) and as long as they need.
    slots, chains
        Table in which contacts are looked up by their features.
    kept
        Contacts found in a step that is taken back.
    clearances
        Pairs whose distance is recorded: one kind or none.
    facets
        Surfaces that deform: one kind or none.
    """

    kernel_modules: ClassVar[tuple[str, ...]] = (
        "heavylift.solver.contact.mesh_handover",
        "heavylift.solver.contact.mesh_record",
        "heavylift.solver.contact.mesh_search",
        "heavylift.solver.contact.mesh_slots",
        "heavylift.solver.contact.mesh_touch",
    )

    surfaces: CollisionSurfaces
    lists: PairLists
    pairs: Ints2
    sides: Ints2
    pair_values: Floats2
    relative: Floats2
    motions: Floats2
    found: Ints2
    found_values: Floats2
    touch: Floats1
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
    slots: Ints1
    chains: Ints1
    kept: Records[ContactState]
    clearances: Clearing
    facets: DeformingSurfaces
