"""Shapes of what has none: boxes have the mass and inertia that they stand for, lines end at the box that cuts them."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from heavylift.pipeline.drawn.lines import clip_lines, coil
from heavylift.solver.scene.outlines import box_corners, inertia_box, pad


def second_moments(points, triangles, density):
    """Volume, centre and inertia about it of a closed surface, by tetrahedra from the origin."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    volumes *= np.sign(volumes.sum())
    volume = volumes.sum()
    centre = np.einsum("i,ij->j", volumes, a + b + c) / (4.0 * volume)
    total = a + b + c
    products = sum(np.einsum("i,ij,ik->jk", volumes, part, part) for part in (a, b, c, total)) / 20.0
    products -= volume * np.outer(centre, centre)
    return volume, centre, density * (np.trace(products) * np.eye(3) - products)


def test_a_box_has_the_inertia_that_it_is_drawn_for():
    """About any axes and centre; integrated over its surface."""
    turn = Rotation.from_rotvec([0.3, -0.8, 0.5]).as_matrix()
    mass, sides = 40.0, np.array([3.0, 1.0, 2.0])
    principal = mass / 12.0 * (np.sum(sides**2) - sides**2)
    inertia, centre = turn @ np.diag(principal) @ turn.T, np.array([4.0, -5.0, 6.0])
    points, triangles, _ = inertia_box(mass, inertia, centre)
    outward = second_moments(points, triangles, 1.0)
    assert outward[0] == pytest.approx(6.0, rel=1e-12)
    np.testing.assert_allclose(outward[1], centre, rtol=1e-12)
    np.testing.assert_allclose(second_moments(points, triangles, mass / 6.0)[2], inertia, atol=1e-10)


def test_a_rod_is_a_box_that_can_be_seen():
    points, *_ = inertia_box(12.0, np.diag([1e-9, 9.0, 9.0]), np.zeros(3))
    np.testing.assert_allclose(np.ptp(points, axis=0), [3.0, 0.06, 0.06], rtol=1e-6)


def test_lines_are_cut_at_a_box():
    box = np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]])
    points = np.array([[-1.0, 1, 1], [3, 1, 1], [0.2, 0.2, 0.2], [0.4, 0.2, 0.2], [-1, -1, 5], [2, 2, 5]])
    found, ends = clip_lines(points, np.array([[0, 1], [2, 3], [4, 5]]), box)
    np.testing.assert_allclose(found[ends[0]], [[0, 1, 1], [1, 1, 1]], atol=1e-15)
    np.testing.assert_allclose(found[ends[1]], points[2:4], atol=1e-15)
    assert len(ends) == 2  # the third one passes above


def test_a_coil_leads_from_end_to_end_around_its_axis():
    start, end = np.array([1.0, 2.0, 3.0]), np.array([1.0, 2.0, 7.0])
    points, ends = coil(start, end, 0.1)
    np.testing.assert_array_equal(points[[0, -1]], [start, end])
    assert len(ends) == len(points) - 1
    assert np.hypot(*(points[:, :2] - start[:2]).T).max() == pytest.approx(0.1, rel=1e-12)
    assert len(coil(start, start, 0.1)[1]) == 0


def test_the_face_of_a_fender_is_at_its_tip():
    tip, normal = np.array([1.0, 2.0, 3.0]), np.array([0.0, -2.0, 0.0])
    points, *_ = pad(tip, normal, 0.5)
    assert points[:, 1].min() == pytest.approx(2.0)
    assert points[:, 1].max() == pytest.approx(2.5)
    assert np.ptp(points[:, 0]) == pytest.approx(1.0)


def test_corners_of_a_box_around_points():
    corners = box_corners(np.array([[0.0, 5.0, 2.0], [1.0, 3.0, 2.0]]))
    assert len(corners) == 8
    np.testing.assert_array_equal([corners.min(axis=0), corners.max(axis=0)], [[0, 3, 2], [1, 5, 2]])
