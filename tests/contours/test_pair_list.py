"""Lists of triangle pairs against all pairs, tested one by one."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from heavylift.contours.triangles.pair_list import make_pair_lists
from heavylift.contours.triangles.pair_search import refresh_pairs
from heavylift.contours.triangles.surface_layout import RelativeMotion
from heavylift.contours.triangles.surface_pack import pack_surfaces
from heavylift.contours.triangles.surface_refit import refit_surface
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import record_at
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

motion_at = record_at(RelativeMotion)


@kernel
def refresh(surfaces, lists, pair, motion, reach):
    return refresh_pairs(surfaces, lists, pair, motion_at(motion, 0), reach)


@kernel
def refit(surfaces, surface):
    return refit_surface(surfaces, surface)


def soup(count, seed, size=0.4, spread=(1.0, 1.0, 1.0), radius=0.0):
    rng = np.random.default_rng(seed)
    corners = rng.normal(size=(count, 1, 3)) * spread + size * rng.normal(size=(count, 3, 3))
    return TriangleSurface(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3), radius)


def lone_points(count, seed, radius):
    points = np.random.default_rng(seed).normal(size=(count, 3))
    return TriangleSurface(points, np.repeat(np.arange(count), 3).reshape(-1, 3), radius)


def motion_between(start, end):
    """The array of a motion from two poses (rotation vector, position)."""
    return np.concatenate(
        [np.concatenate([Rotation.from_rotvec(turn).as_matrix().ravel(), p]) for turn, p in (start, end)]
    )


def random_pose(rng, angle, distance):
    return angle * rng.normal(size=3), distance * rng.normal(size=3)


def corners_of(surfaces, s):
    row = surfaces.surfaces[s]
    rows = surfaces.triangles[row.first_triangle : row.first_triangle + row.triangle_count]
    return surfaces.points[rows["corners"]]


def ends(motion, x):
    """Positions at the start and at the end in the axes of A."""
    return [x @ motion[k : k + 9].reshape(3, 3).T + motion[k + 9 : k + 12] for k in (0, 12)]


def listed(surfaces, lists, count, pair=0):
    a, b = lists.table[pair].surface_a, lists.table[pair].surface_b
    first = lists.table[pair].first
    rows = lists.pairs[first : first + count] - surfaces.surfaces["first_triangle"][[a, b]]
    found = np.zeros(tuple(surfaces.surfaces["triangle_count"][[a, b]]), dtype=int)
    np.add.at(found, (rows[:, 0], rows[:, 1]), 1)
    assert found.max(initial=0) <= 1  # no pair twice
    return found > 0


def pairs_of_boxes(surfaces, motion, distance, a=0, b=1):
    """Which boxes around the corners of triangles, those of B over the whole way, come within a distance."""
    still = corners_of(surfaces, a)
    moving = np.concatenate(ends(motion, corners_of(surfaces, b)), axis=1)
    lower = still.min(axis=1)[:, np.newaxis] - moving.max(axis=1)
    upper = moving.min(axis=1) - still.max(axis=1)[:, np.newaxis]
    gaps = np.maximum(0.0, np.maximum(lower, upper))
    return np.linalg.norm(gaps, axis=2) <= distance


def pairs_of_samples(surfaces, motion, distance, a=0, b=1, count=4, times=3):
    """Which triangles have points of a grid on both that come within a distance: a subset of those that do."""
    weights = (
        np.array([(i, j, count - i - j) for i in range(count + 1) for j in range(count + 1 - i)]) / count
    )
    p = np.einsum("wc,tck->twk", weights, corners_of(surfaces, a))
    start, end = ends(motion, np.einsum("wc,tck->twk", weights, corners_of(surfaces, b)))
    near = np.zeros((len(p), len(start)), dtype=bool)
    still = cKDTree(p.reshape(-1, 3))
    for t in np.linspace(0.0, 1.0, times):
        moving = cKDTree(((1.0 - t) * start + t * end).reshape(-1, 3))
        close = still.sparse_distance_matrix(moving, distance, output_type="ndarray")
        near[close["i"] // len(weights), close["j"] // len(weights)] = True
    return near


@pytest.mark.parametrize("seed", range(40))
def test_a_fresh_list_has_all_pairs_whose_swept_boxes_come_within_reach(seed):
    rng = np.random.default_rng(seed)
    radius = 0.1 * (seed % 3)
    spread = (1.0, 1.0, 0.05) if seed % 2 else (1.0, 2.0, 0.5)
    scene = [
        soup(150, seed, spread=spread, radius=radius),
        soup(90, seed + 100, size=0.2, radius=0.5 * radius),
    ]
    surfaces = pack_surfaces(scene)
    lists = make_pair_lists(surfaces, [(0, 1)])
    start = random_pose(rng, 1.0, 1.0)
    change = random_pose(rng, 10.0 ** -(seed % 4), 10.0 ** -(seed % 5))
    motion = motion_between(start, (start[0] + change[0], start[1] + change[1]))
    reach = (0.0, 0.05, 0.3)[seed % 3]
    count = refresh(surfaces, lists, 0, motion, reach)
    assert count >= 0
    needed = pairs_of_boxes(surfaces, motion, reach + 1.5 * radius)
    assert not (needed & ~listed(surfaces, lists, count)).any()


def test_round_shapes_are_listed_by_their_radii():
    surfaces = pack_surfaces([lone_points(60, 1, 0.15), lone_points(40, 2, 0.1)])
    lists = make_pair_lists(surfaces, [(0, 1)])
    motion = motion_between((np.zeros(3), np.zeros(3)), (np.zeros(3), np.array([0.01, 0.0, 0.0])))
    count = refresh(surfaces, lists, 0, motion, 0.02)
    distances = np.linalg.norm(
        corners_of(surfaces, 0)[:, :1] - corners_of(surfaces, 1)[np.newaxis, :, 0], axis=2
    )
    found = listed(surfaces, lists, count)
    assert found[distances <= 0.27].all()
    # with the margins of so short a motion, nothing far away
    assert not found[distances > 0.27 + 0.5].any()


@pytest.mark.parametrize("seed", range(6))
def test_a_list_that_is_kept_has_all_pairs_that_come_within_reach(seed):
    rng = np.random.default_rng(seed)
    surfaces = pack_surfaces([soup(60, seed, size=0.3), soup(40, seed + 50, size=0.3, radius=0.05)])
    lists = make_pair_lists(surfaces, [(0, 1)])
    turn, place = random_pose(rng, 1.0, 0.5)
    speed, spin = np.zeros(3), np.zeros(3)
    kept = 0
    scale = (0.002, 0.02)[seed % 2]
    for step in range(60):
        # a walk that keeps its direction for a while, stops and turns back
        speed = (0.9 * speed + 0.5 * scale * rng.normal(size=3)) * (step % 20 != 19)
        spin = (0.9 * spin + 0.5 * scale * rng.normal(size=3)) * (step % 20 != 19)
        turned = (Rotation.from_rotvec(spin) * Rotation.from_rotvec(turn)).as_rotvec()
        motion = motion_between((turn, place), (turned, place + speed))
        turn, place = turned, place + speed
        before = lists.table[0].traversals
        count = refresh(surfaces, lists, 0, motion, 0.03)
        kept += before == lists.table[0].traversals
        needed = pairs_of_samples(surfaces, motion, 0.03 + 0.05)
        assert needed.any()
        assert not (needed & ~listed(surfaces, lists, count)).any()
    assert kept >= 25


def walk(kind, rng):
    """Steps of a motion: rotation vector and displacement of each."""
    for step in range(80):
        match kind:
            case "straight":
                yield np.zeros(3), np.array([-0.03, 0.0, 0.0])
            case "turning":
                yield np.array([0.0, 0.004, 0.01]), np.zeros(3)
            case "screw":
                yield np.array([0.01, 0.0, 0.0]), np.array([-0.03, 0.002, 0.0])
            case "rocking":
                yield np.array([0.0, 0.004, 0.003]) * (1 if step % 9 < 5 else -1) * rng.normal(), np.zeros(3)
            case "faster":
                yield np.zeros(3), np.array([-0.0005 * 1.1**step, 0.0, 0.0])
            case "to and fro":
                yield np.zeros(3), np.array([-0.03 if step % 7 < 4 else 0.03, 0.0, 0.0])
            case _:
                yield 0.002 * rng.normal(size=3), 0.004 * rng.normal(size=3)


@pytest.mark.parametrize("distance", [1.0, 2.3])
@pytest.mark.parametrize(
    "kind", ["straight", "turning", "screw", "rocking", "faster", "to and fro", "random"]
)
def test_lists_of_points_have_all_that_come_within_reach(kind, distance):
    # boxes of points are points: a list that is kept a little too long is found out
    rng = np.random.default_rng(9)
    surfaces = pack_surfaces([lone_points(1000, 1, 0.06), lone_points(200, 2, 0.06)])
    lists = make_pair_lists(surfaces, [(0, 1)])
    turn, place = np.zeros(3), np.array([distance, 0.0, 0.0])
    kept = near = 0
    fixed, moving = corners_of(surfaces, 0)[:, 0], corners_of(surfaces, 1)[:, 0]
    for spin, speed in walk(kind, rng):
        turned = (Rotation.from_rotvec(spin) * Rotation.from_rotvec(turn)).as_rotvec()
        motion = motion_between((turn, place), (turned, place + speed))
        turn, place = turned, place + speed
        before = lists.table[0].traversals
        count = refresh(surfaces, lists, 0, motion, 0.01)
        kept += before == lists.table[0].traversals
        found = listed(surfaces, lists, count)
        start, end = ends(motion, moving)
        for t in (0.0, 0.5, 1.0):
            close = cKDTree(fixed).sparse_distance_matrix(
                cKDTree((1.0 - t) * start + t * end), 0.13, output_type="ndarray"
            )
            assert found[close["i"], close["j"]].all()
            near += len(close)
    assert near > 100
    assert kept > 20


@pytest.mark.parametrize("seed", range(12))
def test_a_list_is_kept_until_a_corner_of_the_box_has_used_up_the_margin(seed):
    rng = np.random.default_rng(seed)
    surfaces = pack_surfaces([soup(100, 1), soup(80, 2, spread=(1.0, 0.5, 0.2))])
    points = corners_of(surfaces, 1).reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    corners = np.array([np.where([k & 1, k & 2, k & 4], high, low) for k in range(8)])
    start = Rotation.from_rotvec(rng.normal(size=3)), rng.normal(size=3)
    at_rest = motion_between((start[0].as_rotvec(), start[1]), (start[0].as_rotvec(), start[1]))
    spin = rng.normal(size=3) if seed % 3 else np.zeros(3)
    shift = rng.normal(size=3) if seed % 2 else np.zeros(3)
    if seed % 6 == 0:
        shift = rng.normal(size=3)

    def moved(size):
        """Farthest way of a corner, and the pose, after a part of the motion."""
        turned, place = Rotation.from_rotvec(size * spin) * start[0], start[1] + size * shift
        way = turned.apply(corners) + place - start[0].apply(corners) - start[1]
        return np.linalg.norm(way, axis=1).max(), (turned.as_rotvec(), place)

    lists = make_pair_lists(surfaces, [(0, 1)])
    refresh(surfaces, lists, 0, at_rest, 0.01)
    margin = lists.values[0].slack - 0.01
    assert 0.001 < margin < 0.1
    for part, searches in ((0.999, 1), (1.001, 2)):
        size = brentq(lambda size, part=part: moved(size)[0] - part * margin, 0.0, 1.0)
        pose = moved(size)[1]
        refresh(surfaces, lists, 0, motion_between(pose, pose), 0.01)
        assert lists.table[0].traversals == searches


@pytest.mark.parametrize("gap", [0.005, 0.015, 0.03, 0.05, 0.1])
def test_surfaces_that_are_nearly_near_are_not_taken_for_far(gap):
    rng = np.random.default_rng(3)
    flat = rng.uniform(size=(300, 3)) * [1.0, 1.0, 0.0]
    rows = np.repeat(np.arange(300), 3).reshape(-1, 3)
    surfaces = pack_surfaces([TriangleSurface(flat, rows, 0.01), TriangleSurface(flat[::-1], rows, 0.01)])
    lists = make_pair_lists(surfaces, [(0, 1)])
    heights = np.linspace(0.02 + gap, 0.0, 40)
    for z0, z1 in itertools.pairwise(heights):
        motion = motion_between((np.zeros(3), np.array([0.0, 0, z0])), (np.zeros(3), np.array([0.0, 0, z1])))
        count = refresh(surfaces, lists, 0, motion, 0.01)
        distances = np.linalg.norm(
            corners_of(surfaces, 0)[:, :1] - corners_of(surfaces, 1)[:, 0] - [0.0, 0.0, z1], axis=2
        )
        assert listed(surfaces, lists, count)[distances <= 0.03].all()
    assert (distances <= 0.03).sum() >= 300


@pytest.mark.parametrize("seed", range(4))
def test_a_list_allows_for_points_that_move_in_the_axes_of_their_body(seed):
    rng = np.random.default_rng(seed)
    surfaces = pack_surfaces([soup(50, seed, size=0.3), soup(40, seed + 50, size=0.3)])
    lists = make_pair_lists(surfaces, [(0, 1)])
    still = motion_between((np.zeros(3), np.zeros(3)), (np.zeros(3), np.zeros(3)))
    modes = 0.3 * rng.normal(size=(2, *surfaces.points.shape))
    rest = surfaces.points.copy()
    kept = 0
    for step in range(40):
        phase = 0.02 * step
        surfaces.points[...] = rest + np.sin(phase) * modes[0] + np.sin(2.0 * phase) * modes[1]
        refit(surfaces, 0)
        refit(surfaces, 1)
        before = lists.table[0].traversals
        count = refresh(surfaces, lists, 0, still, 0.08)
        kept += before == lists.table[0].traversals
        needed = pairs_of_samples(surfaces, still, 0.08, times=1)
        assert needed.any()
        assert not (needed & ~listed(surfaces, lists, count)).any()
    assert kept > 5


def test_far_surfaces_are_compared_once_and_never_searched_before_they_are_near():
    surfaces = pack_surfaces([soup(100, 1), soup(100, 2)])
    lists = make_pair_lists(surfaces, [(0, 1)])
    heights = np.linspace(1000.0, 20.0, 400)
    for z0, z1 in itertools.pairwise(heights):
        motion = motion_between((np.zeros(3), np.array([0, 0, z0])), (np.zeros(3), np.array([0, 0, z1])))
        assert refresh(surfaces, lists, 0, motion, 0.1) == 0
        # the slack cannot exceed the distance in which nothing is
        lowest = ends(motion, corners_of(surfaces, 1))[1][..., 2].min()
        highest = corners_of(surfaces, 0)[..., 2].max()
        assert lists.values[0].slack <= 1000.0
        assert lowest - highest > 0.1
    assert lists.table[0].traversals == 0
    motion = motion_between((np.zeros(3), np.array([0.0, 0.0, 20.0])), (np.zeros(3), np.zeros(3)))
    count = refresh(surfaces, lists, 0, motion, 0.1)
    assert lists.table[0].traversals == 1
    assert not (pairs_of_boxes(surfaces, motion, 0.1) & ~listed(surfaces, lists, count)).any()


def test_a_body_at_rest_is_searched_once():
    surfaces = pack_surfaces([soup(100, 1), soup(100, 2)])
    lists = make_pair_lists(surfaces, [(0, 1)])
    motion = motion_between((np.ones(3), np.ones(3)), (np.ones(3), np.ones(3)))
    counts = {refresh(surfaces, lists, 0, motion, 0.01) for _ in range(20)}
    assert len(counts) == 1
    assert counts.pop() > 0
    assert lists.table[0].traversals == 1


def test_a_longer_reach_needs_a_new_list_and_a_shorter_one_does_not():
    surfaces = pack_surfaces([soup(100, 1, size=0.1), soup(100, 2, size=0.1)])
    lists = make_pair_lists(surfaces, [(0, 1)])
    motion = motion_between((np.ones(3), np.ones(3)), (np.ones(3), np.ones(3)))
    refresh(surfaces, lists, 0, motion, 0.1)
    refresh(surfaces, lists, 0, motion, 0.01)
    assert lists.table[0].traversals == 1
    count = refresh(surfaces, lists, 0, motion, 0.5)
    assert lists.table[0].traversals == 2
    assert not (pairs_of_boxes(surfaces, motion, 0.5) & ~listed(surfaces, lists, count)).any()


def test_a_turning_bar_is_listed_where_its_tip_passes_between_the_ends():
    # the tip of a bar of 10 m turns by 1 rad in one step: chord and arc are 10 (1 - cos 0.5) = 1.22 m apart
    x_axis = np.array([1.0, 0.0, 0.0])
    bar = TriangleSurface(
        np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [5.0, 0.1, 0.0]]), np.array([[0, 1, 2]])
    )
    corners = np.array([[-0.1, -0.1, -0.1], [0.1, 0.1, 0.1], [0.0, 0.1, 0.0]])
    on_arc = TriangleSurface(
        np.vstack([corners + x_axis * 10.0, corners - x_axis * 20.0]), np.array([[0, 1, 2], [3, 4, 5]])
    )
    surfaces = pack_surfaces([on_arc, bar])
    lists = make_pair_lists(surfaces, [(0, 1)])
    motion = motion_between((np.array([0, 0, -0.5]), np.zeros(3)), (np.array([0, 0, 0.5]), np.zeros(3)))
    count = refresh(surfaces, lists, 0, motion, 0.0)
    near = np.flatnonzero(corners_of(surfaces, 0)[:, 0, 0] > 0.0)
    assert listed(surfaces, lists, count)[near].all()


def test_a_list_without_room_has_less_margin_and_then_says_so():
    surfaces = pack_surfaces([soup(120, 1), soup(120, 2)])
    motion = motion_between((np.zeros(3), np.zeros(3)), (np.zeros(3), np.array([0.01, 0.0, 0.0])))
    wide = refresh(surfaces, make_pair_lists(surfaces, [(0, 1)]), 0, motion, 0.0)
    least = int(pairs_of_boxes(surfaces, motion, 0.0).sum())
    assert wide > 1.1 * least

    for capacity in np.linspace(1.1 * least, wide - 1, 4).astype(int):
        lists = make_pair_lists(surfaces, [(0, 1)], capacity=int(capacity))
        count = refresh(surfaces, lists, 0, motion, 0.0)
        if count >= 0:  # boxes of boxes that are turned hold a little more than `least`
            assert count <= capacity
            assert not (pairs_of_boxes(surfaces, motion, 0.0) & ~listed(surfaces, lists, count)).any()
    assert count > 0

    lists = make_pair_lists(surfaces, [(0, 1)], capacity=least - 1)
    assert refresh(surfaces, lists, 0, motion, 0.0) == -1
    assert refresh(surfaces, lists, 0, motion, 0.0) == -1  # and it is not taken for a list
    away = motion_between((np.zeros(3), np.full(3, 50.0)), (np.zeros(3), np.full(3, 50.0)))
    assert refresh(surfaces, lists, 0, away, 0.0) == 0


def test_lists_of_several_pairs_keep_to_their_places():
    surfaces = pack_surfaces([soup(40, 1), soup(30, 2), soup(20, 3)])
    numbers = [(0, 1), (0, 2), (2, 1)]
    lists = make_pair_lists(surfaces, numbers)
    rng = np.random.default_rng(5)
    motions, counts = [], []
    for pair in range(3):
        start = random_pose(rng, 1.0, 0.3)
        motions.append(motion_between(start, (start[0] + 0.01, start[1] + 0.02)))
        counts.append(refresh(surfaces, lists, pair, motions[-1], 0.05))
    for pair, (a, b) in enumerate(numbers):
        needed = pairs_of_boxes(surfaces, motions[pair], 0.05, a, b)
        assert not (needed & ~listed(surfaces, lists, counts[pair], pair)).any()


def test_positions_that_are_not_finite_make_an_empty_list():
    surfaces = pack_surfaces([soup(20, 1), soup(20, 2)])
    lists = make_pair_lists(surfaces, [(0, 1)])
    assert refresh(surfaces, lists, 0, np.full(24, np.nan), 0.0) == 0


@pytest.mark.parametrize(
    ("pairs", "capacity", "words"),
    [([(0, 2)], None, "surfaces 0 and 2"), ([(1, 1)], None, "two different"), ([(0, 1)], 0, "capacity")],
)
def test_bad_pairs_are_named(pairs, capacity, words):
    surfaces = pack_surfaces([soup(5, 1), soup(5, 2)])
    with pytest.raises(InputError, match=words):
        make_pair_lists(surfaces, pairs, capacity)
