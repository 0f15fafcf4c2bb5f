"""Search for the triangles of two surfaces that may meet soon, and the test that a list of them still holds.

All is done in the axes of surface A, where its tree stands still; boxes of B are swept along the motion. Both trees are
descended together, the larger box first (Ericson, "Real-Time Collision Detection", 2005, section 6.3). Radii are added
to distances, not to boxes.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.triangles.box_sweep import (
    box_at,
    extent,
    is_larger,
    near,
    squared_gap,
    swept_box,
    swept_triangle,
    write_box,
)
from heavylift.contours.triangles.feature_gap import copy_pose
from heavylift.contours.triangles.pair_list import FRAME_WIDTH
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.triangles.box_sweep import Box
    from heavylift.contours.triangles.pair_list import ListMemory, PairLists
    from heavylift.contours.triangles.surface_layout import BoundingBox, RelativeMotion
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces
    from heavylift.numerics.records import Records

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
    surfaces: CollisionSurfaces, lists: PairLists, pair: int, motion: RelativeMotion, reach: float
) -> int:
    """Make sure that a list holds all triangle pairs that can come within reach of each other during a motion.

    Parameters
    ----------
    surfaces, lists
        Of the scene.
    pair
        Row of the pair of surfaces in the table of the lists.
    motion
        Of surface B in the axes of A.
    reach
        Distance [m] beyond the radii.

    Returns
    -------
    int
        Number of pairs in the list, which begins at ``table[pair].first``; -1 if it has no room for them.

    Notes
    -----
    The list is a superset: its swept boxes come that near. It is made anew only if the motion has used up its margin.
    A point of B at distance r from the origin of its axes leaves the straight line by up to ``r (1 - cos(theta / 2))``,
    about ``r theta^2 / 8``, if B turns about that origin by the angle theta: this counts as reach.
    """
    listed = lists.table[pair]
    memory = lists.values[pair]
    frames = lists.frames
    a = listed.surface_a
    b = listed.surface_b
    travel = surfaces.travels[a] + surfaces.travels[b]
    root_a = surfaces.surfaces[a].root
    root_b = surfaces.surfaces[b].root
    boxes = surfaces.boxes
    need = reach + _chord_height(motion, surfaces.reaches[b])
    if listed.count >= 0:
        _place_box(memory, motion, frames)
        moved = max(_off_path(memory, frames, 0), _off_path(memory, frames, 1))
        if moved + travel - memory.travel + need <= memory.slack:
            memory.travel_latest = travel
            return listed.count

    for k in range(3):
        memory.box.centre[k] = boxes[root_b].centre[k]
        memory.box.half[k] = boxes[root_b].half[k]
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
    copy_pose(motion.start, path.start)
    copy_pose(motion.end, path.end)
    root = swept_box(path, box_at(boxes, root_b))
    inner = surfaces.radii[a] + surfaces.radii[b] + ROUNDING * (extent(root) + extent(box_at(boxes, root_a)))
    gap = math.sqrt(squared_gap(root, box_at(boxes, root_a))) - inner
    if gap > need + margin:
        memory.slack = gap
        listed.count = 0
        return 0

    ahead = min((PATH_STEPS - 1.0) * step, LONGEST_PATH * size) / step if step > 0.0 else 0.0
    share = memory.share
    listed.traversals += 1
    while True:
        slack = need + share * margin
        longer = 1.0 + share * ahead
        _extend(motion.start.rotation, motion.end.rotation, longer, path.end.rotation)
        _extend(motion.start.origin, motion.end.origin, longer, path.end.origin)
        lists.searches[0] += 1
        count = _search(surfaces, lists, pair, inner + slack)
        if count >= 0 or share == 0.0:
            break
        share = 0.5 * share if share > LEAST_SHARE else 0.0
    for k in range(FRAME_WIDTH):
        memory.path[k] *= longer
    memory.share = min(1.0, max(LEAST_SHARE, 2.0 * share))
    memory.slack = slack
    listed.count = count
    return count


@kernel(internal=True)
def _search(surfaces: CollisionSurfaces, lists: PairLists, pair: int, distance: float) -> int:
    """List the triangles whose boxes, those of B swept, come within a distance; -1 if there are too many."""
    nodes, boxes, triangle_boxes = surfaces.nodes, surfaces.boxes, surfaces.triangle_boxes
    stack, stack_boxes, pairs, path = lists.stack, lists.stack_boxes, lists.pairs, lists.path
    swept_boxes, swept_marks, mark = lists.swept_boxes, lists.swept_marks, lists.searches[0]
    place, capacity = lists.table[pair].first, lists.table[pair].capacity
    root_a = surfaces.surfaces[lists.table[pair].surface_a].root
    root_b = surfaces.surfaces[lists.table[pair].surface_b].root
    first_b = surfaces.surfaces[lists.table[pair].surface_b].first_triangle
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
        left_a = nodes[a].left
        left_b = nodes[b].left
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
            first = nodes[a].first
            end = first + nodes[a].count
            for j in range(nodes[b].first, nodes[b].first + nodes[b].count):
                local = j - first_b
                if swept_marks[local] != mark:
                    swept_marks[local] = mark
                    write_box(
                        swept_boxes, local, swept_triangle(path, surfaces.points, surfaces.triangles, j)
                    )
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


@kernel(inline=True, internal=True)
def _extend(
    start: NDArray[np.float64], end: NDArray[np.float64], factor: float, out: NDArray[np.float64]
) -> None:
    """``start + factor (end - start)``."""
    for k in range(out.shape[0]):
        out[k] = start[k] + factor * (end[k] - start[k])


@kernel(internal=True)
def _chord_height(motion: RelativeMotion, radius: float) -> float:
    """Distance between arc and chord at a radius, ``r (1 - cos(theta / 2))`` [m]."""
    difference = 0.0
    for k in range(9):
        change = motion.end.rotation[k] - motion.start.rotation[k]
        difference += change * change
    # of two rotations apart by theta: 8 sin^2(theta / 2)
    sine2 = min(1.0, 0.125 * difference)
    return radius * sine2 / (1.0 + math.sqrt(1.0 - sine2))


@kernel(internal=True)
def _place_box(memory: ListMemory, motion: RelativeMotion, frames: NDArray[np.float64]) -> None:
    """Centre and half axes of the remembered box of B in the axes of A, at the start and at the end."""
    for end in range(2):
        pose = motion.start if end == 0 else motion.end
        for i in range(3):
            centre = pose.origin[i]
            for k in range(3):
                entry = pose.rotation[3 * i + k]
                centre += entry * memory.box.centre[k]
                frames[end, 3 + 3 * k + i] = entry * memory.box.half[k]
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
    stack: NDArray[np.int64], stack_boxes: Records[BoundingBox], top: int, a: int, b: int, box: Box
) -> int:
    """Put two nodes on the stack; returns its new height."""
    stack[top, 0] = a
    stack[top, 1] = b
    write_box(stack_boxes, top, box)
    return top + 1
