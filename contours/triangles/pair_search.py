"""Search for the triangles of two surfaces that may meet soon, and the test that a list of them still holds.

All is done in the axes of surface A, where its tree stands still; boxes of B are swept along the motion. Both trees are
descended together, the larger box first (Ericson, "Real-Time Collision Detection", 2005, section 6.3). Radii are added
to distances, not to boxes.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.triangles.feature_gap import copy_pose
from heavylift.contours.triangles.pair_list import FRAME_WIDTH
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.triangles.pair_list import ListMemory, PairLists
    from heavylift.contours.triangles.surface_layout import BoundingBox, RelativeMotion, Triangle
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces
    from heavylift.numerics.records import Records

__all__ = [
    "Box",
    "list_holds",
    "longest_way",
    "near",
    "refresh_pairs",
    "squared_gap",
    "swept_box",
    "swept_triangle",
]

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

Box = tuple[float, float, float, float, float, float]
"""Centre and half lengths [m]."""


@kernel(internal=True)
def list_holds(
    surfaces: CollisionSurfaces, lists: PairLists, pair: int, motion: RelativeMotion, reach: float
) -> bool:
    """Whether a list has all triangle pairs that can come within reach of each other during a motion.

    The parameters are those of `refresh_pairs`, which makes it anew if it does not: trees, boxes and points must then
    be those of the present.
    """
    listed, memory, frames = lists.table[pair], lists.values[pair], lists.frames
    if listed.count < 0:
        return False
    travel = surfaces.travels[listed.surface_a] + surfaces.travels[listed.surface_b]
    need = reach + _chord_height(motion, surfaces.reaches[listed.surface_b])
    _place_box(memory, motion, frames)
    moved = max(_off_path(memory, frames, 0), _off_path(memory, frames, 1))
    return moved + travel - memory.travel + need <= memory.slack


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
    if list_holds(surfaces, lists, pair, motion, reach):
        memory.travel_latest = travel
        return listed.count

    need = reach + _chord_height(motion, surfaces.reaches[b])
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
def longest_way(surfaces: CollisionSurfaces, lists: PairLists, pair: int, motion: RelativeMotion) -> float:
    """Bound on how far points of B go in the axes of A [m]: none goes farther than a corner of the box around B."""
    box, frame = surfaces.boxes[surfaces.surfaces[lists.table[pair].surface_b].root], lists.frames[0]
    for i in range(3):
        way = motion.end.origin[i] - motion.start.origin[i]
        for k in range(3):
            change = motion.end.rotation[3 * i + k] - motion.start.rotation[3 * i + k]
            way += change * box.centre[k]
            frame[3 + 3 * k + i] = change * box.half[k]
        frame[i] = way
    return _farthest_corner(frame)


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


@kernel(inline=True, internal=True)
def box_at(boxes: Records[BoundingBox], row: int) -> Box:
    """Centre and half lengths."""
    centre, half = boxes[row].centre, boxes[row].half
    return centre[0], centre[1], centre[2], half[0], half[1], half[2]


@kernel(inline=True, internal=True)
def write_box(boxes: Records[BoundingBox], row: int, box: Box) -> None:
    """Centre and half lengths."""
    centre, half = boxes[row].centre, boxes[row].half
    centre[0], centre[1], centre[2], half[0], half[1], half[2] = box


@kernel(inline=True, internal=True)
def near(p: Box, q: Box, distance: float) -> bool:
    """Whether two boxes come within a distance along every axis."""
    return (
        abs(p[0] - q[0]) <= p[3] + q[3] + distance
        and abs(p[1] - q[1]) <= p[4] + q[4] + distance
        and abs(p[2] - q[2]) <= p[5] + q[5] + distance
    )


@kernel(inline=True, internal=True)
def squared_gap(p: Box, q: Box) -> float:
    """Squared distance between two boxes [m^2]."""
    x = max(0.0, abs(p[0] - q[0]) - p[3] - q[3])
    y = max(0.0, abs(p[1] - q[1]) - p[4] - q[4])
    z = max(0.0, abs(p[2] - q[2]) - p[5] - q[5])
    return x * x + y * y + z * z


@kernel(inline=True, internal=True)
def is_larger(p: Box, q: Box) -> bool:
    """Whether a box has the longer edges."""
    return p[3] + p[4] + p[5] >= q[3] + q[4] + q[5]


@kernel(inline=True, internal=True)
def extent(box: Box) -> float:
    """Bound on the coordinates of a box [m]."""
    return max(abs(box[0]) + box[3], abs(box[1]) + box[4], abs(box[2]) + box[5])


@kernel(inline=True, internal=True)
def swept_box(path: RelativeMotion, box: Box) -> Box:
    """Box in the axes of A around a box of B that moves straight from the start to the end of a path."""
    x, half_x = _swept_axis(path, 0, box)
    y, half_y = _swept_axis(path, 1, box)
    z, half_z = _swept_axis(path, 2, box)
    return x, y, z, half_x, half_y, half_z


@kernel(inline=True, internal=True)
def _swept_axis(path: RelativeMotion, i: int, box: Box) -> tuple[float, float]:
    """Middle and half length of a swept box along one axis of A."""
    R, Q = path.start.rotation, path.end.rotation
    r0, r1, r2 = R[3 * i], R[3 * i + 1], R[3 * i + 2]
    q0, q1, q2 = Q[3 * i], Q[3 * i + 1], Q[3 * i + 2]
    start = path.start.origin[i] + r0 * box[0] + r1 * box[1] + r2 * box[2]
    end = path.end.origin[i] + q0 * box[0] + q1 * box[1] + q2 * box[2]
    half_start = abs(r0) * box[3] + abs(r1) * box[4] + abs(r2) * box[5]
    half_end = abs(q0) * box[3] + abs(q1) * box[4] + abs(q2) * box[5]
    low = min(start - half_start, end - half_end)
    high = max(start + half_start, end + half_end)
    return 0.5 * (low + high), 0.5 * (high - low)


@kernel(inline=True, internal=True)
def swept_triangle(
    path: RelativeMotion, points: NDArray[np.float64], triangles: Records[Triangle], triangle: int
) -> Box:
    """Box in the axes of A around the corners of a triangle of B on the way: tighter than its box in B, swept."""
    a = triangles[triangle].corners[0]
    b = triangles[triangle].corners[1]
    c = triangles[triangle].corners[2]
    x, half_x = _swept_corners(path, 0, points, a, b, c)
    y, half_y = _swept_corners(path, 1, points, a, b, c)
    z, half_z = _swept_corners(path, 2, points, a, b, c)
    return x, y, z, half_x, half_y, half_z


@kernel(inline=True, internal=True)
def _swept_corners(
    path: RelativeMotion, i: int, points: NDArray[np.float64], a: int, b: int, c: int
) -> tuple[float, float]:
    """Middle and half length of what three points pass along one axis of A."""
    low = math.inf
    high = -math.inf
    for end in range(2):
        pose = path.start if end == 0 else path.end
        R = pose.rotation
        r0, r1, r2 = R[3 * i], R[3 * i + 1], R[3 * i + 2]
        at_a = r0 * points[a, 0] + r1 * points[a, 1] + r2 * points[a, 2]
        at_b = r0 * points[b, 0] + r1 * points[b, 1] + r2 * points[b, 2]
        at_c = r0 * points[c, 0] + r1 * points[c, 1] + r2 * points[c, 2]
        origin = pose.origin[i]
        low = min(low, origin + min(at_a, at_b, at_c))
        high = max(high, origin + max(at_a, at_b, at_c))
    return 0.5 * (low + high), 0.5 * (high - low)
