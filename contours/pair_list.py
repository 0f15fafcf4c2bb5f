"""Lists of the triangles of two surfaces that may meet soon: the arrays, and what a list remembers of its making.

A list is made for the motion of surface B in the axes of A over an interval, with a margin, and stays right while no
point of B has left that path by more than the margin (Verlet, "Computer experiments on classical fluids", Physical
Review 159, 1967). How far points have moved is known from the corners of one box around B: the difference of two poses
is linear in the position.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.surface_layout import (
    BOX_HALF,
    BOX_WIDTH,
    FIRST_TRIANGLE,
    MOTION_WIDTH,
    PAIR_CAPACITY,
    PAIR_COUNT,
    PAIR_FIRST,
    PAIR_SURFACE_A,
    PAIR_SURFACE_B,
    PAIR_WIDTH,
    ROOT_NODE,
    TRIANGLE_COUNT,
)
from heavylift.contours.surface_tree import tree_depth
from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints1, Ints2
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Record, Records, Vector6, records

if TYPE_CHECKING:
    from collections.abc import Sequence

    from heavylift.contours.surface_pack import CollisionSurfaces

__all__ = [
    "FRAME_WIDTH",
    "ListMemory",
    "PairLists",
    "make_pair_lists",
]

FRAME_WIDTH = 12
"""A box of B in the axes of A: its centre, and its three half axes [m]."""

Frame = Annotated[NDArray[np.float64], (FRAME_WIDTH,)]


class ListMemory(Record):
    """What a list remembers of its making.

    Attributes
    ----------
    box
        Box around B in its own axes: centre and half lengths [m].
    start, path
        Where that box began its path in the axes of A, and how far it was to go [m].
    slack
        Distance within which all pairs are listed, without the radii [m].
    travel, travel_latest
        Ways that points had gone in refits when the list was made, and when it was last asked for [m].
    mean_size
        Of the smaller triangles [m].
    share
        Share of the margin that the capacity allows.
    """

    box: Vector6
    start: Frame
    path: Frame
    slack: float
    travel: float
    travel_latest: float
    mean_size: float
    share: float


LEAST_CAPACITY = 131072
PAIRS_PER_TRIANGLE = 24
"""Places of a list: enough for plates that lie on each other, and not more than there are pairs."""


class PairLists(Arrays):
    """Lists of triangle pairs, one for each pair of surfaces, and room for the search.

    Attributes
    ----------
    pairs
        Triangles of surface A and B, shape (capacity, 2); the lists of all pairs of surfaces one after another.
    table
        Shape (np, 6), see `surface_layout`.
    values
        What each list remembers of its making.
    stack, stack_boxes
        Nodes of A and B that are still to be compared, shape (m, 2), and the swept box of that of B, shape (m, 6).
    swept_boxes, swept_marks
        Swept boxes of triangles of B, shape (k, 6), and the search in which each was written, shape (k,).
    searches
        Number of searches so far, shape (1,).
    path
        Poses of B at the ends of the path that is searched, laid out as a motion, shape (24,).
    frames
        Box around B at both ends of the interval, shape (2, 12).
    """

    pairs: Ints2
    table: Ints2
    values: Records[ListMemory]
    stack: Ints2
    stack_boxes: Floats2
    swept_boxes: Floats2
    swept_marks: Ints1
    searches: Ints1
    path: Floats1
    frames: Floats2


def make_pair_lists(
    surfaces: CollisionSurfaces, pairs: Sequence[tuple[int, int]], capacity: int | None = None
) -> PairLists:
    """Empty lists for pairs of surfaces.

    Parameters
    ----------
    surfaces
        All surfaces of the scene.
    pairs
        Numbers of surface A and B. Work is done in the axes of A: lists last longest if A is the larger one.
    capacity
        Places of each list; default four for each triangle, at least 16384, and never more than there are pairs.

    Raises
    ------
    InputError
        For a surface that does not exist, a surface with itself, a capacity below 1.
    """
    count = len(surfaces.surfaces)
    if capacity is not None and capacity < 1:
        raise InputError(
            f"{capacity}", source="pair lists", key="capacity", expected="at least one place for each pair"
        )
    table = np.zeros((len(pairs), PAIR_WIDTH), dtype=np.int64)
    values = records(ListMemory, len(pairs))
    sizes = [_mean_size(surfaces, s) for s in range(count)]
    depths = [tree_depth(surfaces.nodes, int(row[ROOT_NODE])) for row in surfaces.surfaces]
    first = 0
    for i, (a, b) in enumerate(pairs):
        if not (0 <= a < count and 0 <= b < count and a != b):
            raise InputError(
                f"surfaces {a} and {b}",
                source="pair lists",
                key=f"pair {i + 1}",
                expected=f"two different numbers from 0 to {count - 1}",
            )
        rows = [int(surfaces.surfaces[s, TRIANGLE_COUNT]) for s in (a, b)]
        most = capacity or max(LEAST_CAPACITY, PAIRS_PER_TRIANGLE * sum(rows))
        most = min(most, rows[0] * rows[1])
        table[i, [PAIR_SURFACE_A, PAIR_SURFACE_B]] = a, b
        table[i, [PAIR_FIRST, PAIR_CAPACITY, PAIR_COUNT]] = first, most, -1
        values[i].mean_size = min(sizes[a], sizes[b])
        values[i].share = 1.0
        first += most
    # every pair of nodes taken from the stack puts at most two back, one level deeper
    deepest = max((depths[a] + depths[b] for a, b in pairs), default=0) + 2
    longest = max((int(surfaces.surfaces[b, TRIANGLE_COUNT]) for _, b in pairs), default=0)
    return PairLists(
        pairs=np.zeros((first, 2), dtype=np.int64),
        table=table,
        values=values,
        stack=np.zeros((deepest, 2), dtype=np.int64),
        stack_boxes=np.zeros((deepest, BOX_WIDTH)),
        swept_boxes=np.zeros((longest, BOX_WIDTH)),
        swept_marks=np.zeros(longest, dtype=np.int64),
        searches=np.zeros(1, dtype=np.int64),
        path=np.zeros(MOTION_WIDTH),
        frames=np.zeros((2, FRAME_WIDTH)),
    )


def _mean_size(surfaces: CollisionSurfaces, surface: int) -> float:
    """Mean diagonal of the boxes of the triangles of a surface, with its rounding [m]."""
    first = surfaces.surfaces[surface, FIRST_TRIANGLE]
    rows = slice(first, first + surfaces.surfaces[surface, TRIANGLE_COUNT])
    halves = surfaces.triangle_boxes[rows, BOX_HALF:]
    return float(2.0 * np.linalg.norm(halves, axis=1).mean() + 2.0 * surfaces.radii[surface])
