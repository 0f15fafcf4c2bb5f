"""Search for the triangles of two surfaces that may meet soon, and the test that a list of them still holds.

All is done in the axes of surface A, where its tree stands still; boxes of B are swept along the motion. Both trees are
descended together, the larger box first (Ericson, "Real-Time Collision Detection", 2005, section 6.3). Radii are added
to distances, not to boxes.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.box_sweep import (
    box_at,
    extent,
    is_larger,
    near,
    squared_gap,
    swept_box,
    swept_triangle,
    write_box,
)
from heavylift.contours.pair_list import FRAME_WIDTH
from heavylift.contours.surface_layout import (
    BOX_WIDTH,
    FIRST_TRIANGLE,
    MOTION_P0,
    MOTION_R0,
    MOTION_R1,
    NODE_COUNT,
    NODE_FIRST,
    NODE_LEFT,
    PAIR_CAPACITY,
    PAIR_COUNT,
    PAIR_FIRST,
    PAIR_SURFACE_A,
    PAIR_SURFACE_B,
    PAIR_TRAVERSALS,
    ROOT_NODE,
)
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.box_sweep import Box
    from heavylift.contours.pair_list import ListMemory, PairLists
    from heavylift.contours.surface_pack import CollisionSurfaces

__all__ = ["refresh_pairs"]

LEAST_MARGIN = 0.02
LARGEST_MARGIN = 0.25
"""Of the mean size of the smaller triangles."""

MARGIN_STEPS = 2.0
"""Margin over the motion in the interval; what points travel in refits has no path and counts `PATH_STEPS` times."""

LONGEST_PATH = 1.0
"""Of the mean size of the smaller triangles: what a list looks ahead beyond the interval."""

PATH_STEPS = 10.0
"""Path over the motion in the interval. A path ahead takes fewer pairs than a margin to all sides. Tried for a tank
that is lowered, rests or sways in a hold: longer paths and wider margins make longer lists, shorter ones more lists."""

LEAST_SHARE = 1e-3
"""Of margin and path ahead; a list that still has no room for all pairs is made for its interval only."""

ROUNDING = 1e-14
"""Of all lengths, by which boxes may be wrong."""


@kernel(internal=True)
def refresh_pairs(
    surfaces: CollisionSurfaces, lists: PairLists, pair: int, motion: NDArray[np.float64], reach: float
) -> int:
    """Make sure that a list holds all triangle pairs that can come within reach of each other during a motion.

    Parameters
    ----------
    surfaces, lists
        Of the scene.
    pair
        Row of the pair of surfaces in the table of the lists.
    motion
        Of surface B in the axes of A: ``R0`` (row by row), ``p0``, ``R1``, ``p1`` with ``x_A = R x_B + p`` [m] at the
        start and at the end, shape (24,). Points move straight between the two.
    reach
        Distance [m] beyond the radii.

    Returns
    -------
    int
        Number of pairs in the list, which begins at ``table[pair, PAIR_FIRST]``; -1 if it has no room for them.

    Notes
    -----
    The list is a superset: its swept boxes come that near. It is made anew only if the motion has used up its margin.
    A point of B at distance r from the origin of its axes leaves the straight line by up to ``r (1 - cos(theta / 2))``,
    about ``r theta^2 / 8``, if B turns about that origin by the angle theta: this counts as reach.
    """
    table = lists.table
    memory = lists.values[pair]
    frames = lists.frames
    a = table[pair, PAIR_SURFACE_A]
    b = table[pair, PAIR_SURFACE_B]
    travel = surfaces.travels[a] + surfaces.travels[b]
    root_a = surfaces.surfaces[a, ROOT_NODE]
    root_b = surfaces.surfaces[b, ROOT_NODE]
    boxes = surfaces.boxes
    need = reach + _chord_height(motion, surfaces.reaches[b])
    if table[pair, PAIR_COUNT] >= 0:
        _place_box(memory, motion, frames)
        moved = max(_off_path(memory, frames, 0), _off_path(memory, frames, 1))
        if moved + travel - memory.travel + need <= memory.slack:
            memory.travel_latest = travel
            return table[pair, PAIR_COUNT]

    for k in range(BOX_WIDTH):
        memory.box[k] = boxes[root_b, k]
    _place_box(memory, motion, frames)
    for k in range(FRAME_WIDTH):
        memory.start[k] = frames[0, k]
        memory.path[k] = frames[1, k] - frames[0, k]
    step = _farthest_corner(memory.path)
    refitted = travel - memory.travel_latest
    memory.travel = travel
    memory.travel_latest = travel
    size = memory.mean_size
    margin = min(MARGIN_STEPS * step + PATH_STEPS * refitted, LARGEST_MARGIN * size)
    margin = max(margin, LEAST_MARGIN * size)
    path = lists.path
    for k in range(MOTION_R1):
        path[k] = motion[k]
        path[MOTION_R1 + k] = motion[MOTION_R1 + k]
    root = swept_box(path, box_at(boxes, root_b))
    inner = surfaces.radii[a] + surfaces.radii[b] + ROUNDING * (extent(root) + extent(box_at(boxes, root_a)))
    gap = math.sqrt(squared_gap(root, box_at(boxes, root_a))) - inner
    if gap > need + margin:
        memory.slack = gap
        table[pair, PAIR_COUNT] = 0
        return 0

    ahead = min((PATH_STEPS - 1.0) * step, LONGEST_PATH * size) / step if step > 0.0 else 0.0
    share = memory.share
    table[pair, PAIR_TRAVERSALS] += 1
    while True:
        slack = need + share * margin
        longer = 1.0 + share * ahead
        for k in range(MOTION_R1):
            path[MOTION_R1 + k] = motion[k] + longer * (motion[MOTION_R1 + k] - motion[k])
        lists.searches[0] += 1
        count = _search(
            surfaces.points,
            surfaces.triangles,
            surfaces.nodes,
            boxes,
            surfaces.triangle_boxes,
            root_a,
            root_b,
            surfaces.surfaces[b, FIRST_TRIANGLE],
            path,
            inner + slack,
            lists.searches[0],
            lists.pairs,
            table[pair, PAIR_FIRST],
            table[pair, PAIR_CAPACITY],
            lists.stack,
            lists.stack_boxes,
            lists.swept_boxes,
            lists.swept_marks,
        )
        if count >= 0 or share == 0.0:
            break
        share = 0.5 * share if share > LEAST_SHARE else 0.0
    for k in range(FRAME_WIDTH):
        memory.path[k] *= longer
    memory.share = min(1.0, max(LEAST_SHARE, 2.0 * share))
    memory.slack = slack
    table[pair, PAIR_COUNT] = count
    return count


@kernel(internal=True)
def _search(
    points: NDArray[np.float64],
    triangles: NDArray[np.int64],
    nodes: NDArray[np.int64],
    boxes: NDArray[np.float64],
    triangle_boxes: NDArray[np.float64],
    root_a: int,
    root_b: int,
    first_b: int,
    path: NDArray[np.float64],
    distance: float,
    mark: int,
    # out
    pairs: NDArray[np.int64],
    place: int,
    capacity: int,
    # scratch
    stack: NDArray[np.int64],
    stack_boxes: NDArray[np.float64],
    swept_boxes: NDArray[np.float64],
    swept_marks: NDArray[np.int64],
) -> int:
    """List the triangles whose boxes, those of B swept, come within a distance; -1 if there are too many."""
    count = 0
    root = swept_box(path, box_at(boxes, root_b))
    top = 0
    if near(root, box_at(boxes, root_a), distance):
        top = _push(stack, stack_boxes, 0, root_a, root_b, root)
    while top > 0:
        top -= 1
        a = stack[top, 0]
        b = stack[top, 1]
        box_b = box_at(stack_boxes, top)
        box_a = box_at(boxes, a)
        left_a = nodes[a, NODE_LEFT]
        left_b = nodes[b, NODE_LEFT]
        if left_a >= 0 and (left_b < 0 or is_larger(box_a, box_at(boxes, b))):
            for child in range(left_a, left_a + 2):
                if near(box_b, box_at(boxes, child), distance):
                    top = _push(stack, stack_boxes, top, child, b, box_b)
        elif left_b >= 0:
            for child in range(left_b, left_b + 2):
                box = swept_box(path, box_at(boxes, child))
                if near(box, box_a, distance):
                    top = _push(stack, stack_boxes, top, a, child, box)
        else:
            first = nodes[a, NODE_FIRST]
            end = first + nodes[a, NODE_COUNT]
            for j in range(nodes[b, NODE_FIRST], nodes[b, NODE_FIRST] + nodes[b, NODE_COUNT]):
                local = j - first_b
                if swept_marks[local] != mark:
                    swept_marks[local] = mark
                    write_box(swept_boxes, local, swept_triangle(path, points, triangles, j))
                box = box_at(swept_boxes, local)
                if near(box, box_a, distance):
                    for i in range(first, end):
                        other = box_at(triangle_boxes, i)
                        if near(box, other, distance) and squared_gap(box, other) <= distance * distance:
                            if count == capacity:
                                return -1
                            pairs[place + count, 0] = i
                            pairs[place + count, 1] = j
                            count += 1
    return count


@kernel(internal=True)
def _chord_height(motion: NDArray[np.float64], radius: float) -> float:
    """Distance between arc and chord at a radius, ``r (1 - cos(theta / 2))`` [m]."""
    difference = 0.0
    for k in range(9):
        change = motion[MOTION_R1 + k] - motion[MOTION_R0 + k]
        difference += change * change
    # of two rotations apart by theta: 8 sin^2(theta / 2)
    sine2 = min(1.0, 0.125 * difference)
    return radius * sine2 / (1.0 + math.sqrt(1.0 - sine2))


@kernel(internal=True)
def _place_box(memory: ListMemory, motion: NDArray[np.float64], frames: NDArray[np.float64]) -> None:
    """Centre and half axes of the remembered box of B in the axes of A, at the start and at the end."""
    for end in range(2):
        start = MOTION_R1 * end
        for i in range(3):
            centre = motion[start + MOTION_P0 + i]
            for k in range(3):
                entry = motion[start + 3 * i + k]
                centre += entry * memory.box[k]
                frames[end, 3 + 3 * k + i] = entry * memory.box[3 + k]
            frames[end, i] = centre


@kernel(internal=True)
def _off_path(memory: ListMemory, frames: NDArray[np.float64], end: int) -> float:
    """Bound on how far points of B are from where they were at the nearest place of the remembered path [m]."""
    along = 0.0
    squared = 0.0
    for k in range(FRAME_WIDTH):
        way = memory.path[k]
        along += way * (frames[end, k] - memory.start[k])
        squared += way * way
    s = min(1.0, max(0.0, along / squared)) if squared > 0.0 else 0.0
    for k in range(FRAME_WIDTH):
        frames[end, k] -= memory.start[k] + s * memory.path[k]
    return _farthest_corner(frames[end])


@kernel(internal=True)
def _farthest_corner(frame: NDArray[np.float64]) -> float:
    """Longest of the vectors ``v +- u1 +- u2 +- u3`` [m], with v and the three u one after another."""
    vv = 0.0
    for k in range(3):
        vv += frame[k] * frame[k]
    longest = 0.0
    for signs in range(4):
        second = 1.0 if signs & 1 else -1.0
        third = 1.0 if signs & 2 else -1.0
        vw = 0.0
        ww = 0.0
        for k in range(3):
            w = frame[3 + k] + second * frame[6 + k] + third * frame[9 + k]
            vw += frame[k] * w
            ww += w * w
        longest = max(longest, ww + 2.0 * abs(vw))
    return math.sqrt(vv + longest)


@kernel(inline=True, internal=True)
def _push(
    stack: NDArray[np.int64], stack_boxes: NDArray[np.float64], top: int, a: int, b: int, box: Box
) -> int:
    """Put two nodes on the stack; returns its new height."""
    stack[top, 0] = a
    stack[top, 1] = b
    write_box(stack_boxes, top, box)
    return top + 1
