"""Boxes around what moves straight, against points that move."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from heavylift.contours.triangles.pair_list import PairLists, make_pair_lists
from heavylift.contours.triangles.pair_search import (
    longest_way,
    near,
    squared_gap,
    swept_box,
    swept_triangle,
)
from heavylift.contours.triangles.surface_layout import RelativeMotion, Triangle, pose_of
from heavylift.contours.triangles.surface_pack import CollisionSurfaces, pack_surfaces
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.records import copy_record, record_at, records
from heavylift.preprocess.surfaces.primitives import box_surface

motion_at = record_at(RelativeMotion)


@kernel
def boxes_of(path, box, points, triangles, distance, out):
    b = (box[0], box[1], box[2], box[3], box[4], box[5])
    motion = motion_at(path, 0)
    s = swept_box(motion, b)
    t = swept_triangle(motion, points, triangles, 0)
    for k in range(6):
        out[k] = s[k]
        out[6 + k] = t[k]
    return near(b, s, distance), squared_gap(b, s)


@pytest.mark.parametrize("seed", range(10))
def test_swept_boxes_hold_all_points_at_all_times_and_touch_the_outermost(seed):
    rng = np.random.default_rng(seed)
    poses = [(Rotation.from_rotvec(rng.normal(size=3)), rng.normal(size=3) * 3.0) for _ in range(2)]
    path = np.concatenate([np.concatenate([turn.as_matrix().ravel(), place]) for turn, place in poses])
    points = rng.normal(size=(3, 3))
    box = np.concatenate([rng.normal(size=3), rng.uniform(0.0, 2.0, 3)])
    triangles = records(Triangle, 1)
    triangles[0].corners[:] = [0, 1, 2]
    out = np.zeros(12)
    distance = 1.0
    is_near, gap2 = boxes_of(path, box, points, triangles, distance, out)

    signs = np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
    for swept, start in ((out[:6], box[:3] + signs * box[3:]), (out[6:], points)):
        first, last = (turn.apply(start) + place for turn, place in poses)
        low = np.minimum(first, last).min(axis=0)
        high = np.maximum(first, last).max(axis=0)
        np.testing.assert_allclose(swept[:3] - swept[3:], low, atol=1e-13)
        np.testing.assert_allclose(swept[:3] + swept[3:], high, atol=1e-13)

    gaps = np.maximum(0.0, np.abs(box[:3] - out[:3]) - box[3:] - out[3:6])
    assert gap2 == pytest.approx(gaps @ gaps, rel=1e-12)
    assert is_near == (gaps.max() <= distance)


@entry
def way_kernel(surfaces: CollisionSurfaces, lists: PairLists, motion: RelativeMotion) -> float:
    return longest_way(surfaces, lists, 0, motion)


@pytest.mark.parametrize("seed", range(3))
def test_no_point_goes_farther_than_the_longest_way(seed):
    """And of a box, whose corners are those of the box around it, one goes as far."""
    rng = np.random.default_rng(seed)
    skin = box_surface(rng.uniform(0.5, 2.0, 3))
    surfaces = pack_surfaces([box_surface(1.0), skin])
    motion, ends = RelativeMotion.one(), []
    for pose in (motion.start, motion.end):
        turn, place = Rotation.from_rotvec(rng.normal(size=3)), rng.normal(size=3)
        copy_record(pose, pose_of(turn.as_matrix(), place))
        ends.append(turn.apply(skin.points) + place)
    ways = np.linalg.norm(ends[1] - ends[0], axis=1)
    assert way_kernel(surfaces, make_pair_lists(surfaces, [(0, 1)]), motion) == pytest.approx(
        ways.max(), rel=1e-12
    )
