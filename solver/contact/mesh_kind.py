"""The kind of pairs of surfaces of triangles that may touch: beside the contacts, which come and go."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Meshes"]

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


class Meshes(NamedTuple):
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
        Contacts found in a step that is taken back, shape (nc, STATE_WIDTH).
    clearances
        Pairs whose distance is recorded, a tuple of one kind or none.
    facets
        Surfaces that deform, a tuple of one kind or none.
    """

    surfaces: Any
    lists: Any
    pairs: NDArray[np.int64]
    sides: NDArray[np.int64]
    pair_values: NDArray[np.float64]
    relative: NDArray[np.float64]
    motions: NDArray[np.float64]
    found: NDArray[np.int64]
    found_values: NDArray[np.float64]
    touch: NDArray[np.float64]
    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    depths: NDArray[np.float64]
    active: NDArray[np.int64]
    owners: NDArray[np.int64]
    patch_of: NDArray[np.int64]
    keeps: NDArray[np.int64]
    chosen: NDArray[np.int64]
    sums: NDArray[np.float64]
    grid: NDArray[np.int64]
    slots: NDArray[np.int64]
    chains: NDArray[np.int64]
    kept: NDArray[np.float64]
    clearances: Any
    facets: Any
