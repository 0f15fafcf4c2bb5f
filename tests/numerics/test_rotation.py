"""Rotations against scipy, which shares no code with them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from heavylift.numerics.rotation import (
    exponential_quaternion,
    quaternion_from_matrix,
    quaternion_from_rotation_vector,
    quaternion_product,
    rotate_by_exponential,
    rotate_by_quaternion,
    rotation_matrix,
    turned_by,
    write_rotation_matrix,
)

ANGLES = [0.0, 1e-300, 1e-160, 1e-12, 1e-8, 1e-4, 0.1, 0.1999999, 0.2, 0.2000001, 1.0, 3.0, math.pi - 1e-9]
RNG = np.random.default_rng(5)
AXES = [np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, -1.0]), *RNG.normal(size=(4, 3))]


def scipy_quaternion(vector: np.ndarray) -> np.ndarray:
    return Rotation.from_rotvec(vector).as_quat(canonical=True, scalar_first=True)


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("axis", AXES)
def test_exponential(angle: float, axis: np.ndarray) -> None:
    vector = angle * axis / np.linalg.norm(axis)
    quaternion = quaternion_from_rotation_vector(vector)
    np.testing.assert_allclose(quaternion, scipy_quaternion(vector), rtol=0, atol=2e-16)
    assert abs(np.linalg.norm(quaternion) - 1.0) < 4e-16


def test_series_and_closed_form_agree_at_the_switch() -> None:
    """Both branches just beside 0.2 rad against the closed form."""
    for angle in (0.2 * (1.0 - 1e-15), 0.2 * (1.0 + 1e-15)):
        q = np.array(exponential_quaternion(angle, 0.0, 0.0))
        np.testing.assert_allclose(q, [math.cos(angle / 2), math.sin(angle / 2), 0.0, 0.0], atol=1.2e-16)


def test_product_is_the_product_of_matrices() -> None:
    for a, b in Rotation.random(20, random_state=1).as_quat(scalar_first=True).reshape(10, 2, 4):
        both = rotation_matrix(quaternion_product(tuple(a), tuple(b)))
        np.testing.assert_allclose(both, rotation_matrix(a) @ rotation_matrix(b), atol=1e-15)
        expected = Rotation.from_quat(a, scalar_first=True) * Rotation.from_quat(b, scalar_first=True)
        np.testing.assert_allclose(both, expected.as_matrix(), atol=1e-15)


def test_a_vector_turned_by_quaternions_of_any_length() -> None:
    q = Rotation.random(10, random_state=3).as_quat(scalar_first=True)
    expected = Rotation.from_quat(q, scalar_first=True).apply(AXES[-1])
    np.testing.assert_allclose(turned_by(3.0 * q, AXES[-1]), expected, atol=2e-15)


def test_matrix_of_any_length_and_vector_rotation() -> None:
    for q in Rotation.random(10, random_state=2).as_quat(scalar_first=True):
        R = Rotation.from_quat(q, scalar_first=True).as_matrix()
        np.testing.assert_allclose(rotation_matrix(7.0 * q), R, atol=1e-15)
        rows = np.empty(9)
        write_rotation_matrix(tuple(q), rows)
        np.testing.assert_allclose(rows.reshape(3, 3), R, atol=1e-15)
        v = RNG.normal(size=3)
        np.testing.assert_allclose(rotate_by_quaternion(tuple(q), *v), R @ v, atol=1e-15)


def test_body_axis_rotations_are_appended_on_the_right() -> None:
    q = Rotation.random(random_state=3)
    v = np.array([0.3, -0.8, 0.5])
    turned = rotate_by_exponential(tuple(q.as_quat(scalar_first=True)), *v)
    expected = (q * Rotation.from_rotvec(v)).as_matrix()
    np.testing.assert_allclose(rotation_matrix(turned), expected, atol=1e-15)


def test_many_small_turns_keep_unit_length() -> None:
    q = (1.0, 0.0, 0.0, 0.0)
    for _ in range(10_000):
        q = rotate_by_exponential(q, 1e-3, 2e-3, -1e-3)
    assert abs(np.linalg.norm(q) - 1.0) < 1e-15
    expected = Rotation.from_rotvec(10_000 * np.array([1e-3, 2e-3, -1e-3])).as_matrix()
    np.testing.assert_allclose(rotation_matrix(q), expected, atol=1e-11)


@pytest.mark.parametrize("largest", range(4))
def test_quaternion_from_matrix_in_every_branch(largest: int) -> None:
    rng = np.random.default_rng(largest)
    for _ in range(20):
        q = rng.uniform(-0.4, 0.4, size=4)
        q[largest] = 1.0
        q /= np.linalg.norm(q)
        q *= -1.0 if q[0] < 0.0 else 1.0
        R = Rotation.from_quat(q, scalar_first=True).as_matrix()
        np.testing.assert_allclose(quaternion_from_matrix(R), q, atol=1e-15)


@pytest.mark.parametrize("axis", range(3))
def test_quaternion_from_the_matrix_of_half_a_turn(axis: int) -> None:
    diagonal = -np.ones(3)
    diagonal[axis] = 1.0
    quaternion = quaternion_from_matrix(np.diag(diagonal))
    assert abs(quaternion[1 + axis]) == pytest.approx(1.0)
    np.testing.assert_allclose(rotation_matrix(quaternion), np.diag(diagonal), atol=1e-15)
