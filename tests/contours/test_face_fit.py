"""Splines fitted to the nodes of unstructured faces."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.contours.splines.derivatives import evaluate_contour
from heavylift.contours.splines.face_fit import fitted_surface
from heavylift.numerics.outcome import InputError


def face(count: int = 400, seed: int = 3, height: float = 0.0, hole: float = 0.0):
    """Nodes at random on a face of 2 m by 1 m, turned in space, and material below it."""
    random = np.random.default_rng(seed)
    u = random.uniform(-1.0, 1.0, (count, 2)) * [1.0, 0.5]
    edge = np.linspace(-1.0, 1.0, 21)
    border = [np.stack([edge, np.full(21, y)], axis=1) for y in (-0.5, 0.5)]
    border += [np.stack([np.full(21, x), 0.5 * edge], axis=1) for x in (-1.0, 1.0)]
    u = np.concatenate([u, *border])
    u = u[np.hypot(*u.T) > hole]
    flat = np.column_stack([u, height * (1.0 - u[:, 0] ** 2)])
    below = flat - [0.0, 0.0, 0.2]
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    turn *= np.linalg.det(turn)
    return np.concatenate([flat, below]) @ turn.T, np.arange(len(flat)), turn, flat


def test_a_flat_face_and_a_bent_mode_are_met():
    """Cubic polynomials are splines: places and shapes of all nodes, and the normal out of the material."""
    nodes, members, turn, flat = face()
    shape = np.zeros((1, *nodes.shape))
    bend = flat[:, 0] ** 2 - 0.3 * flat[:, 1] ** 3 + flat[:, 0] * flat[:, 1]
    shape[0, members] = bend[:, np.newaxis] * turn[:, 2]
    fit = fitted_surface(nodes, members, shape)
    assert fit.distance < 1e-6
    deformed = type(fit.contour)(
        fit.contour.spaces, fit.contour.control + 0.1 * fit.contour.modal[0], fit.contour.modal, np.empty(0)
    )
    grid = np.stack(np.meshgrid(np.linspace(0.05, 0.95, 7), np.linspace(0.05, 0.95, 5)), axis=-1).reshape(
        -1, 2
    )
    at, bent = (evaluate_contour(one, grid) for one in (fit.contour, deformed))
    place = at[:, 0] @ turn
    expected = 0.1 * (place[:, 0] ** 2 - 0.3 * place[:, 1] ** 3 + place[:, 0] * place[:, 1])
    np.testing.assert_allclose((bent[:, 0] @ turn)[:, 2], expected, atol=1e-5)
    np.testing.assert_allclose(fit.normal, turn[:, 2], atol=1e-9)
    normal = np.cross(at[:, 1], at[:, 2])
    assert (normal @ turn[:, 2] > 0.99 * np.linalg.norm(normal, axis=1)).all()


def test_forces_on_control_points_are_forces_on_nodes():
    """Shares of each control point add up to one, and so do their moments: virtual work of rigid motions."""
    nodes, members, _, _ = face()
    fit = fitted_surface(nodes, members, np.zeros((0, *nodes.shape)))
    np.testing.assert_allclose(fit.shares.sum(axis=1), 1.0, atol=1e-6)
    np.testing.assert_allclose(fit.shares @ nodes[members], fit.contour.control, atol=1e-12)


def test_degrees_go_by_direction():
    """The first one along the longer side."""
    nodes, members, _, _ = face(height=0.1)
    fit = fitted_surface(nodes, members, np.zeros((0, *nodes.shape)), degrees=(4, 3))
    assert [space.degree for space in fit.contour.spaces] == [4, 3]
    assert fit.contour.spaces[0].count > fit.contour.spaces[1].count
    assert fit.distance < 1e-5  # a parabola


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"hole": 0.45}, "have no node"),
        ({"height": 1.5}, "material on both sides"),
        ({"count": 0}, "control points"),
    ],
)
def test_faces_that_no_spline_fits_are_refused(changes, problem):
    """With what to do instead."""
    nodes, members, _, _ = face(**changes)
    if changes == {"count": 0}:
        members = members[::12]
    with pytest.raises(InputError) as caught:
        fitted_surface(nodes, members, np.zeros((0, *nodes.shape)))
    assert problem in str(caught.value)
