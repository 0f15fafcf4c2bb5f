"""Contacts of two surfaces: which features, from which side, and that nothing passes through."""

from __future__ import annotations

import numpy as np
import pytest
from collision_kernels import box, contacts_kernel, contacts_of, hits_of, packed, plate, poses, surface
from collision_scenes import query, rotation

from heavylift.contours.triangles.feature_gap import EDGE_EDGE, FACE_VERTEX, VERTEX_FACE
from heavylift.contours.triangles.feature_pairs import POSITION_DIFFERENCE
from heavylift.contours.triangles.feature_report import make_contact_list
from heavylift.contours.triangles.overlap import find_overlap
from heavylift.contours.triangles.pair_list import make_pair_lists

UP = np.array([0.0, 0.0, 1.0])
ONE = np.eye(3)


def directions(contacts):
    """Different normals of contacts."""
    return {tuple(float(x) + 0.0 for x in n) for n in np.round(contacts.normals, 9)}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "vertex_face", "edges"),
    [
        ("bunny_bunny", 5, 13),
        ("bunny_plane", 8, 7),
        ("tank_plane", 1064, 46),
        ("tank_hull", 175, 426),
        ("tank_hull_tilted", 10, 14),
        ("far_apart", 0, 0),
    ],
)
def test_hits_of_the_models_are_those_of_a_reference_collision_library(name, vertex_face, edges):
    # counts of the same motions by the IPC Toolkit
    a, b, motion = query(name)
    kinds, _ = hits_of(packed(a, b), motion)
    assert np.count_nonzero(kinds <= FACE_VERTEX) == vertex_face
    assert np.count_nonzero(kinds == EDGE_EDGE) == edges


@pytest.mark.slow
def test_contacts_of_the_models_are_found_as_early_as_the_first_hit():
    for name in ("bunny_bunny", "bunny_plane", "tank_hull", "tank_hull_tilted"):
        a, b, motion = query(name)
        surfaces = packed(a, b)
        contacts = contacts_of(surfaces, motion)
        _, times = hits_of(surfaces, motion)
        assert contacts.times[contacts.hit].min() == pytest.approx(times.min(), abs=1e-9)


def test_box_near_a_plane_has_its_four_lower_corners():
    surfaces = packed(surface(plate(10.0, 10.0, 1, 1)), surface(box(1.0, 2.0, 0.5)))
    R = rotation((0.0, 0.0, 1.0), 0.3)
    near = contacts_of(surfaces, poses(R, [1.0, 0.2, 0.252], R, [1.0, 0.25, 0.251]), reach=0.01)
    corners = near.kinds == VERTEX_FACE
    assert np.count_nonzero(corners) == 4
    assert not near.hit.any()
    np.testing.assert_allclose(near.gaps, 0.001, atol=1e-12)
    np.testing.assert_allclose(near.normals, np.tile(UP, (len(near.gaps), 1)), atol=1e-12)
    assert len(set(near.features[corners, 1])) == 4
    # faster, the same corners are hit, at the time at which a falling point arrives
    hit = contacts_of(surfaces, poses(R, [1.0, 0.2, 0.252], R, [1.0, 0.25, 0.244]))
    corners = hit.kinds == VERTEX_FACE
    assert hit.hit.all()
    assert np.count_nonzero(corners) == 4
    np.testing.assert_allclose(hit.times, 0.25, atol=1e-9)
    np.testing.assert_allclose(hit.gaps, -0.006, atol=1e-12)


def test_corner_on_the_seam_of_coplanar_faces_is_one_contact():
    # the diagonal of the plate goes through the corners at (1, 1) and (-1, -1) of the box
    surfaces = packed(surface(plate(10.0, 10.0, 1, 1)), surface(box(2.0, 2.0, 0.5)))
    contacts = contacts_of(surfaces, poses(ONE, [0.0, 0.0, 0.26], ONE, [0.0, 0.0, 0.24]))
    assert np.count_nonzero(contacts.kinds == VERTEX_FACE) == 4
    pairs = {(k, *f) for k, f in zip(contacts.kinds, map(tuple, contacts.features), strict=True)}
    assert len(pairs) == len(contacts.kinds)


def test_sliding_over_the_seams_of_a_plate_meets_no_resistance():
    rng = np.random.default_rng(1)
    surfaces = packed(surface(plate(6.0, 6.0, 12, 12), rng), surface(box(1.0, 1.0, 0.5), rng))
    for angle in (0.0, 0.4, np.pi / 4.0):
        R = rotation((0.0, 0.0, 1.0), angle)
        for x in np.arange(-2.0, 2.0, 0.13):
            for depth in (1e-3, 0.0):
                motion = poses(R, [x, 0.0, 0.25 + depth], R, [x + 0.13, 0.02, 0.25 - 1e-4])
                contacts = contacts_of(surfaces, motion, reach=0.3)
                assert len(contacts.kinds) >= 4
                assert directions(contacts) == {(0.0, 0.0, 1.0)}


def test_box_pressed_into_a_plate_keeps_its_corners_over_all_seams():
    rng = np.random.default_rng(8)
    surfaces = packed(surface(plate(6.0, 6.0, 12, 12), rng), surface(box(1.0, 1.0, 0.5), rng))
    R = rotation((0.0, 0.0, 1.0), 0.3)
    for depth in (1e-7, 1e-6, 1e-5):
        for x in np.arange(-2.0, 2.0, 0.13):
            z = 0.25 - depth
            contacts = contacts_of(surfaces, poses(R, [x, 0.0, z], R, [x + 1e-6, 1e-7, z]), reach=0.01)
            corners = contacts.kinds == VERTEX_FACE
            assert len(set(contacts.features[corners, 1])) == 4
            np.testing.assert_allclose(contacts.gaps[corners], -depth, atol=1e-12)
            np.testing.assert_allclose(
                contacts.normals[corners], np.tile(UP, (np.count_nonzero(corners), 1)), atol=1e-9
            )


def test_hook_below_the_rim_of_a_plate_is_not_taken_for_one_that_came_through():
    # a strip that leads down beside the rim and back below the plate, its corners 5 mm under it
    points = np.array(
        [[1.1, y, z] for y in (-0.2, 0.2) for z in (0.5, -0.3)] + [[0.9, y, -0.005] for y in (-0.2, 0.2)]
    )
    triangles = np.array([[0, 1, 2], [1, 3, 2], [1, 4, 3], [3, 4, 5]])
    surfaces = packed(surface(plate(2.0, 2.0, 3, 3)), surface((points, triangles)))
    contacts = contacts_of(surfaces, poses(ONE, [0.0, 0.0, 0.0], ONE, [0.0, 0.0, 0.001]), reach=0.02)
    assert len(contacts.kinds) > 0
    assert directions(contacts) == {(0.0, 0.0, -1.0)}
    assert (contacts.gaps > 0.0).all()


@pytest.mark.parametrize("way", [-0.01, 0.0, 0.01])
@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.3, 0.2), (1e-4, 0.0)])
def test_box_exactly_on_a_box_is_held_upwards_only(shift, way):
    # of the same size: corners lie in the planes of the sides too
    rng = np.random.default_rng(2)
    surfaces = packed(surface(box(1.0, 1.0, 1.0), rng), surface(box(1.0, 1.0, 1.0), rng))
    for reach in (0.0, 0.05):
        contacts = contacts_of(surfaces, poses(ONE, [*shift, 1.0], ONE, [*shift, 1.0 + way]), reach)
        assert directions(contacts) == {(0.0, 0.0, 1.0)}
        assert contacts.hit.all()
        np.testing.assert_allclose(contacts.gaps, way, atol=1e-12)
        # the points of contact span the common square
        for axis in range(2):
            np.testing.assert_allclose(np.ptp(contacts.points_b[:, axis]), 1.0 - shift[axis], atol=1e-9)


def test_box_in_the_corner_of_a_room_touches_floor_and_walls():
    s = 2.0
    points = np.array(
        [[0, 0, 0], [s, 0, 0], [s, s, 0], [0, s, 0], [0, 0, s], [s, 0, s], [0, s, s]], dtype=float
    )
    quads = ((0, 1, 2, 3), (0, 1, 5, 4), (0, 3, 6, 4))
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    surfaces = packed(surface((points, triangles)), surface(box(1.0, 1.0, 1.0)))
    contacts = contacts_of(surfaces, poses(ONE, [0.501, 0.502, 0.503], ONE, [0.499, 0.499, 0.499]))
    assert directions(contacts) == {(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)}


def test_rims_of_crossed_plates_push_along_the_common_normal():
    upright = rotation((1.0, 0.0, 0.0), np.pi / 2.0)
    standing = (plate(1.0, 1.0, 2, 2)[0] @ upright.T, plate(1.0, 1.0, 2, 2)[1])
    surfaces = packed(surface(standing), surface(standing))
    R = rotation((0.0, 0.0, 1.0), 1.2)
    motion = poses(R, [0.1, 0.0, 1.03], R, [0.1, 0.0, 0.97])
    contacts = contacts_of(surfaces, motion)
    assert contacts.kinds.tolist() == [EDGE_EDGE]
    np.testing.assert_allclose(contacts.normals[0], UP, atol=1e-9)
    assert contacts.times[0] == pytest.approx(0.5)
    assert contacts.gaps[0] == pytest.approx(-0.03)


def random_shape(rng, k):
    if k == 0:
        return rng.normal(size=(4, 3)), np.array([(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)])
    return box(*rng.uniform(0.2, 1.2, 3)) if k == 1 else plate(1.0, 0.8, 2 * k - 3, 2)


def throws(count, seed):
    """Random closed and open shapes thrown at boxes and plates, clear of them at the start."""
    rng = np.random.default_rng(seed)
    targets = [box(2.0, 1.5, 1.0), plate(3.0, 2.0, 3, 2), box(1.0, 1.0, 1.0), plate(2.0, 2.0, 1, 1)]
    scenes = [
        packed(surface(targets[k % 4], rng), surface(random_shape(rng, k // 4 % 4), rng)) for k in range(32)
    ]
    while count > 0:
        R0 = rotation(rng.normal(size=3), rng.uniform(0.0, 3.0))
        R1 = rotation(rng.normal(size=3), rng.uniform(0.0, 0.4)) @ R0
        p0 = rng.normal(size=3)
        p0 *= rng.uniform(1.2, 2.5) / np.linalg.norm(p0)
        surfaces = scenes[count % 32]
        if find_overlap(surfaces, 0, 1, R0, p0).triangle_a < 0:
            count -= 1
            yield surfaces, poses(R0, p0, R1, rng.uniform(-1.0, 1.0, 3) - 0.6 * p0)


def test_no_hit_is_left_out_before_the_first_contact_of_a_random_throw():
    thrown = 0
    for surfaces, motion in throws(600, 3):
        _, times = hits_of(surfaces, motion)
        contacts = contacts_of(surfaces, motion)
        assert contacts.hit.any() == bool(len(times))
        if len(times):
            thrown += 1
            assert contacts.times[contacts.hit].min() == pytest.approx(times.min(), abs=1e-9)
    assert thrown > 300


def edges_through(edges, faces):
    """Whether any of the edges (n, 2, 3) goes through any of the triangles (m, 3, 3), by signed volumes."""

    def volume(a, b, c, d):
        return np.einsum("...i,...i", np.cross(b - a, c - a), d - a)

    p, q = edges[:, None, 0], edges[:, None, 1]
    a, b, c = faces[None, :, 0], faces[None, :, 1], faces[None, :, 2]
    across = volume(a, b, c, p) * volume(a, b, c, q) < 0.0
    u, v, w = volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)
    inside = ((u > 0.0) & (v > 0.0) & (w > 0.0)) | ((u < 0.0) & (v < 0.0) & (w < 0.0))
    return bool((across & inside).any())


def test_surfaces_meet_no_earlier_than_the_first_contact():
    # independent: intersection of all edges and triangles at many times of the same motion
    met = 0
    for surfaces, motion in throws(40, 4):
        contacts = contacts_of(surfaces, motion)
        first = contacts.times[contacts.hit].min() if contacts.hit.any() else np.inf
        n = surfaces.surfaces[1].first_point
        split = surfaces.surfaces[1].first_triangle
        of_b = surfaces.edges["ends"][:, 0] >= n
        for t in np.linspace(0.0, 1.0, 101):
            x = surfaces.points.copy()
            ends = [
                surfaces.points[n:] @ motion[k : k + 9].reshape(3, 3).T + motion[k + 9 : k + 12]
                for k in (0, 12)
            ]
            x[n:] = (1.0 - t) * ends[0] + t * ends[1]
            edges, faces = x[surfaces.edges["ends"]], x[surfaces.triangles["corners"]]
            if edges_through(edges[of_b], faces[:split]) or edges_through(edges[~of_b], faces[split:]):
                assert first <= t
                met += 1
                break
    assert met > 20


def test_turning_triangles_over_changes_nothing():
    rng = np.random.default_rng(5)
    for _ in range(3):
        shapes = plate(3.0, 2.0, 3, 2), box(1.0, 0.8, 0.6)
        R = rotation(rng.normal(size=3), 0.7)
        p = np.array([0.1, 0.2, 0.25 + np.abs(box(1.0, 0.8, 0.6)[0] @ R.T)[:, 2].max()])
        motion = poses(R, p, R, p - [0.05, 0.0, 0.4])
        found = []
        for turned in (None, rng, rng):
            surfaces = packed(*(surface(shape, turned) for shape in shapes))
            contacts = contacts_of(surfaces, motion, reach=0.1)
            geometry = np.column_stack(
                [contacts.kinds, contacts.times, contacts.gaps, contacts.normals, contacts.points_b]
            )
            found.append(geometry[np.lexsort(np.round(geometry, 7).T)])
        assert len(found[0]) > 0
        np.testing.assert_allclose(found[1], found[0], atol=1e-9)
        np.testing.assert_allclose(found[2], found[0], atol=1e-9)


def test_side_of_plates_that_lie_on_each_other_from_the_start():
    # no neighbour tells: a flat plate on the roof of a box; the middles of the surfaces do
    surfaces = packed(surface(box(2.0, 2.0, 1.0)), surface(plate(1.0, 1.0, 2, 2)))
    for height, way in ((0.5, 1.0), (-0.5, -1.0)):
        motion = poses(ONE, [0.1, 0.1, height], ONE, [0.1, 0.1, height - 0.01 * way])
        contacts = contacts_of(surfaces, motion)
        assert directions(contacts) == {(0.0, 0.0, way)}
        np.testing.assert_allclose(contacts.gaps, -0.01, atol=1e-12)


ROUND = (np.zeros((1, 3)), np.array([[0, 0, 0]]))
ROD = (np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]), np.array([[0, 1, 1]]))


def test_sphere_on_the_face_the_edge_and_the_corner_of_a_box():
    surfaces = packed(surface(box(2.0, 2.0, 2.0)), surface(ROUND, radius=0.25))
    for direction in ((0.0, 0.0, 1.0), (0.0, 1.0, 1.0), (1.0, 1.0, 1.0)):
        on = np.array([0.3, 0.2, 0.0]) * (np.array(direction) == 0.0) + direction
        d = np.array(direction) / np.linalg.norm(direction)
        motion = poses(ONE, on + 0.30 * d, ONE, on + 0.22 * d)
        contacts = contacts_of(surfaces, motion)
        assert len(contacts.kinds) == 1
        assert contacts.hit[0]
        assert contacts.times[0] == pytest.approx(0.05 / 0.08)
        assert contacts.gaps[0] == pytest.approx(-0.03)
        np.testing.assert_allclose(contacts.normals[0], d, atol=1e-12)
        near = contacts_of(surfaces, poses(ONE, on + 0.30 * d, ONE, on + 0.26 * d), reach=0.02)
        assert near.gaps == pytest.approx([0.01])
        assert not near.hit.any()


def test_capsules_touch_along_their_axes_and_at_their_ends():
    surfaces = packed(surface(ROD, radius=0.1), surface(ROD, radius=0.2))
    R = rotation((0.0, 0.0, 1.0), np.pi / 2.0)
    for p0, p1, gap, normal in (
        ([0.2, 0.3, 0.4], [0.2, 0.3, 0.25], -0.05, (0.0, 0.0, 1.0)),  # crossed
        ([0.5, 1.5, 0.0], [0.5, 1.28, 0.0], -0.02, (0.0, 1.0, 0.0)),  # end on side
        ([1.4, 1.3, 0.0], [1.1, 1.2, 0.0], np.hypot(0.1, 0.2) - 0.3, (0.1 / 0.05**0.5, 0.2 / 0.05**0.5, 0.0)),
    ):
        contacts = contacts_of(surfaces, poses(R, p0, R, p1))
        assert len(contacts.kinds) == 1
        assert contacts.hit[0]
        assert contacts.gaps[0] == pytest.approx(gap)
        np.testing.assert_allclose(contacts.normals[0], normal, atol=1e-9)


def test_fast_sphere_does_not_pass_a_plate():
    surfaces = packed(surface(plate(2.0, 2.0, 4, 4)), surface(ROUND, radius=0.01))
    contacts = contacts_of(surfaces, poses(ONE, [0.1, 0.2, 5.0], ONE, [0.3, 0.1, -5.0]))
    assert contacts.hit.any()
    assert contacts.times.min() == pytest.approx(4.99 / 10.0)
    np.testing.assert_allclose(contacts.normals[0], UP, atol=1e-12)


def test_position_difference_finds_vertex_hits_of_a_translation_too():
    rng = np.random.default_rng(6)
    surfaces = packed(surface(plate(3.0, 3.0, 3, 3)), surface(box(1.0, 0.7, 0.5)))
    for _ in range(10):
        R = rotation(rng.normal(size=3), rng.uniform(0.0, 3.0))
        motion = poses(R, [*rng.uniform(-0.5, 0.5, 2), 1.2], R, [*rng.uniform(-0.5, 0.5, 2), -1.2])
        kinds, _ = hits_of(surfaces, motion)
        by_difference, _ = hits_of(surfaces, motion, POSITION_DIFFERENCE)
        assert np.count_nonzero(kinds == VERTEX_FACE) == np.count_nonzero(by_difference == VERTEX_FACE) > 0
        assert contacts_of(surfaces, motion, method=POSITION_DIFFERENCE).hit.any()


def test_more_contacts_than_there_is_room_for_are_said():
    surfaces = packed(surface(plate(6.0, 6.0, 12, 12)), surface(plate(5.0, 5.0, 20, 20)))
    lists = make_pair_lists(surfaces, [(0, 1)])
    motion = poses(ONE, [0.01, 0.02, 0.01], ONE, [0.01, 0.02, -0.01])
    found = make_contact_list(64)
    assert contacts_kernel(surfaces, lists, 0, motion, 0.0, 0, True, found) == -2
    few = make_pair_lists(surfaces, [(0, 1)], capacity=1)
    assert contacts_kernel(surfaces, few, 0, motion, 0.0, 0, True, found) == -1
