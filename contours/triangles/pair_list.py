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

from heavylift.contours.triangles.surface_layout import BoundingBox, PairList, RelativeMotion
from heavylift.contours.triangles.surface_tree import tree_depth
from heavylift.numerics.arrays import Arrays, Floats2, Ints1, Ints2
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Record, Records, records

if TYPE_CHECKING:
    from collections.abc import Sequence

    from heavylift.contours.triangles.surface_pack import CollisionSurfaces

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

    box: BoundingBox
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
        Of each pair of surfaces, shape (np,).
    values
        What each list remembers of its making.
    stack, stack_boxes
        Nodes of A and B that are still to be compared, shape (m, 2), and the swept box of that of B, shape (m,).
    swept_boxes, swept_marks
        Swept boxes of triangles of B, and the search in which each was written, shape (k,).
    searches
        Number of searches so far, shape (1,).
    path
        That is searched.
    frames
        Box around B at both ends of the interval, shape (2, 12).
    """

    pairs: Ints2
    table: Records[PairList]
    values: Records[ListMemory]
    stack: Ints2
    stack_boxes: Records[BoundingBox]
    swept_boxes: Records[BoundingBox]
    swept_marks: Ints1
    searches: Ints1
    path: RelativeMotion
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
    table = records(PairList, len(pairs))
    values = records(ListMemory, len(pairs))
    sizes = [_mean_size(surfaces, s) for s in range(count)]
    depths = [tree_depth(surfaces.nodes, int(row.root)) for row in surfaces.surfaces]
    first = 0
    for i, (a, b) in enumerate(pairs):
        if not (0 <= a < count and 0 <= b < count and a != b):
            raise InputError(
                f"surfaces {a} and {b}",
                source="pair lists",
                key=f"pair {i + 1}",
                expected=f"two different numbers from 0 to {count - 1}",
            )
        rows = [int(surfaces.surfaces[s].triangle_count) for s in (a, b)]
        most = capacity or max(LEAST_CAPACITY, PAIRS_PER_TRIANGLE * sum(rows))
        most = min(most, rows[0] * rows[1])
        table[i].surface_a, table[i].surface_b = a, b
        table[i].first, table[i].capacity, table[i].count = first, most, -1
        values[i].mean_size = min(sizes[a], sizes[b])
        values[i].share = 1.0
        first += most
    # every pair of nodes taken from the stack puts at most two back, one level deeper
    deepest = max((depths[a] + depths[b] for a, b in pairs), default=0) + 2
    longest = max((int(surfaces.surfaces[b].triangle_count) for _, b in pairs), default=0)
    return PairLists(
        pairs=np.zeros((first, 2), dtype=np.int64),
        table=table,
        values=values,
        stack=np.zeros((deepest, 2), dtype=np.int64),
        stack_boxes=records(BoundingBox, deepest),
        swept_boxes=records(BoundingBox, longest),
        swept_marks=np.zeros(longest, dtype=np.int64),
        searches=np.zeros(1, dtype=np.int64),
        path=RelativeMotion.one(),
        frames=np.zeros((2, FRAME_WIDTH)),
    )


def _mean_size(surfaces: CollisionSurfaces, surface: int) -> float:
    """Mean diagonal of the boxes of the triangles of a surface, with its rounding [m]."""
    first = surfaces.surfaces[surface].first_triangle
    rows = slice(first, first + surfaces.surfaces[surface].triangle_count)
    halves = surfaces.triangle_boxes["half"][rows]
    return float(2.0 * np.linalg.norm(halves, axis=1).mean() + 2.0 * surfaces.radii[surface])
