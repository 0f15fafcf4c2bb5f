"""Fits: exact through their points, polynomials reproduced, order of convergence, what cannot be fitted."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, make_interp_spline

from heavylift.contours.splines.derivatives import evaluate_contour
from heavylift.contours.splines.interpolation import (
    basis_matrix,
    control_points,
    interpolation_space,
    parameters_along,
    parameters_averaged,
)
from heavylift.contours.splines.neutral import NeutralContour, neutral_curve, neutral_surface
from heavylift.contours.splines.spaces import SplineSpace
from heavylift.numerics.outcome import InputError

WAYS = ["chord", "centripetal", "uniform"]


def parameters_of(points, degree, closed, way="chord"):
    return interpolation_space(parameters_along(points, way, closed), degree, closed)[1]


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5, 6])
def test_curve_passes_through_its_points(degree: int, closed: bool, way: str) -> None:
    angle = np.sort(np.random.default_rng(3).uniform(0.0, 2.0 * np.pi, 12))
    points = np.column_stack([2.0 * np.cos(angle), np.sin(angle), 0.1 * np.sin(3.0 * angle)])
    curve = neutral_curve(points, degree=degree, closed=closed, parametrisation=way)
    at = evaluate_contour(curve, parameters_of(points, degree, closed, way))
    assert at[:, 0] == pytest.approx(points, abs=1e-12)


def test_chord_lengths_of_a_known_polygon() -> None:
    points = np.array([[0, 0, 0], [3, 0, 0], [3, 4, 0], [3, 4, 1]], float)
    assert parameters_along(points) == pytest.approx([0.0, 3 / 8, 7 / 8, 1.0])
    roots = np.cumsum([0.0, np.sqrt(3.0), 2.0, 1.0])
    assert parameters_along(points, "centripetal") == pytest.approx(roots / roots[-1])
    assert parameters_along(points, "uniform") == pytest.approx([0.0, 1 / 3, 2 / 3, 1.0])
    around = 8.0 + np.sqrt(26.0)
    assert parameters_along(points, closed=True) == pytest.approx(np.array([0.0, 3, 7, 8]) / around)


def test_averaged_knots_of_the_nurbs_book() -> None:
    # example 9.1 of The NURBS Book: parameters 0, 5/17, 9/17, 14/17, 1 give the inner knot 28/51
    space, _ = interpolation_space(np.array([0.0, 5 / 17, 9 / 17, 14 / 17, 1.0]), 3)
    assert space.knots == pytest.approx([0, 0, 0, 0, 28 / 51, 1, 1, 1, 1])


def test_parameters_of_a_grid_are_means_over_its_lines() -> None:
    lines = np.zeros((3, 3, 3))
    lines[0, :, 0] = [0.0, 1.0, 4.0]
    lines[1, :, 0] = [0.0, 6.0, 8.0]
    assert parameters_averaged(lines) == pytest.approx([0.0, 0.5 * (0.25 + 0.75), 1.0])  # the pole has no say


def test_even_points_on_a_polynomial_give_the_polynomial() -> None:
    x = np.linspace(0.0, 1.0, 9)
    for degree in (3, 4, 5):
        points = np.column_stack([x, x**degree - x, 2.0 - x**2])
        curve = neutral_curve(points, degree=degree, parametrisation="uniform")
        u = np.linspace(0.0, 1.0, 31)
        values = evaluate_contour(curve, u)
        exact = np.column_stack([u, u**degree - u, 2.0 - u**2])
        slope = np.column_stack([np.ones(31), degree * u ** (degree - 1) - 1.0, -2.0 * u])
        assert values[:, 0] == pytest.approx(exact, abs=1e-12)
        assert values[:, 1] == pytest.approx(slope, abs=1e-11)


def test_open_cubic_against_scipy_on_the_same_knots() -> None:
    points = np.random.default_rng(2).normal(size=(10, 3))
    curve = neutral_curve(points)
    u = parameters_of(points, 3, False)
    reference = make_interp_spline(u, points, k=3, t=curve.spaces[0].knots)
    assert curve.control == pytest.approx(reference.c, abs=1e-12 * np.max(np.abs(reference.c)))


def test_closed_cubic_is_the_periodic_spline() -> None:
    points = np.random.default_rng(5).normal(size=(11, 3))
    curve = neutral_curve(points, closed=True)
    u = parameters_of(points, 3, True)
    reference = CubicSpline(np.append(u, 1.0), np.vstack([points, points[:1]]), bc_type="periodic")
    at = np.linspace(0.0, 1.0, 80, endpoint=False)
    values = evaluate_contour(curve, at)
    for row, order in ((0, 0), (1, 1), (3, 2)):
        theirs = reference(at, order)
        assert values[:, row] == pytest.approx(theirs, abs=1e-11 * np.max(np.abs(theirs)))


@pytest.mark.parametrize(("degree", "least"), [(3, 3.9), (5, 5.8)])
def test_closed_fit_of_a_circle_converges_with_its_order(degree: int, least: float) -> None:
    errors = []
    for count in (12, 24):
        angle = 2.0 * np.pi * np.arange(count) / count
        points = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(count)])
        curve = neutral_curve(points, degree=degree, closed=True)
        radius = np.linalg.norm(evaluate_contour(curve, np.linspace(0.0, 1.0, 500))[:, 0], axis=1)
        errors.append(np.max(np.abs(radius - 1.0)))
    assert np.log2(errors[0] / errors[1]) > least


def fitted_torus(
    degrees: tuple[int, int] = (3, 3), modes: int = 2
) -> tuple[NeutralContour, np.ndarray, np.ndarray]:
    a = 2.0 * np.pi * np.arange(12) / 12
    b = 2.0 * np.pi * np.arange(9) / 9
    ring = 3.0 + np.cos(b)[None, :]
    points = np.stack(
        [np.cos(a)[:, None] * ring, np.sin(a)[:, None] * ring, np.tile(np.sin(b), (12, 1))], axis=-1
    )
    shapes = np.random.default_rng(1).normal(size=(modes, 12, 9, 3))
    surface = neutral_surface(points, degrees=degrees, closed=(True, True), mode_shapes=shapes)
    return surface, points, shapes


@pytest.mark.parametrize("degrees", [(3, 3), (5, 4), (2, 3)])
def test_closed_surface_passes_through_deformed_points(degrees: tuple[int, int]) -> None:
    surface, points, shapes = fitted_torus(degrees)
    q = np.array([0.3, -0.7])
    deformed = points + np.tensordot(q, shapes, axes=1)
    u = parameters_of(points[:, 0], degrees[0], True)
    v = parameters_of(points[0], degrees[1], True)  # a torus: the same on every line
    at = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
    values = evaluate_contour(surface, at, q)[:, 0].reshape(points.shape)
    assert values == pytest.approx(deformed, abs=1e-12 * 10)


def test_position_from_coordinates_equals_a_refit_of_the_deformed_points() -> None:
    random = np.random.default_rng(8)
    x, y = np.meshgrid(np.linspace(0.0, 2.0, 8), np.linspace(0.0, 1.0, 6), indexing="ij")
    points = np.stack([x + 0.02 * random.normal(size=x.shape), y, 0.2 * np.sin(3.0 * x)], axis=-1)
    shapes = random.normal(size=(4, 8, 6, 3))
    surface = neutral_surface(points, mode_shapes=shapes)
    q = random.normal(size=4)
    deformed = points + np.tensordot(q, shapes, axes=1)
    # the refit solves both directions anew, with the same parameters
    u = parameters_averaged(points.transpose(1, 0, 2))
    v = parameters_averaged(points)
    for space, parameters, axis in ((surface.spaces[0], u, 0), (surface.spaces[1], v, 1)):
        deformed = control_points(space, parameters, deformed, axis)
    moved = surface.control + np.tensordot(q, surface.modal, axes=1)
    assert moved == pytest.approx(deformed.reshape(-1, 3), abs=1e-12 * np.max(np.abs(deformed)))


def test_curve_of_a_body_moves_linearly_through_its_deformed_points() -> None:
    random = np.random.default_rng(8)
    points = np.column_stack([np.linspace(0.0, 1.0, 9) ** 1.5, np.zeros(9), random.uniform(size=9)])
    shapes = random.normal(size=(3, 9, 3))
    curve = neutral_curve(points, mode_shapes=shapes)
    assert curve.modal.shape == (3, 9, 3)
    q = np.array([0.1, 2.0, -0.4])
    values = evaluate_contour(curve, parameters_of(points, 3, False), q)
    assert values[:, 0] == pytest.approx(points + np.tensordot(q, shapes, axes=1), abs=1e-12)


def test_rigid_motions_of_the_points_move_the_contour_rigidly() -> None:
    surface, points, _ = fitted_torus()
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    shapes = np.stack([np.ones_like(points) * [0.0, 0.0, 1.0], points @ (turn - np.eye(3)).T])
    moving = neutral_surface(points, closed=(True, True), mode_shapes=shapes)
    at = np.random.default_rng(0).uniform(size=(9, 2))
    rest = evaluate_contour(surface, at)
    moved = evaluate_contour(moving, at, np.array([2.0, 1.0]))
    expected = rest @ turn.T
    expected[:, 0, 2] += 2.0
    assert moved == pytest.approx(expected, abs=1e-11)


def test_basis_is_a_partition_of_unity() -> None:
    for closed in (False, True):
        space, _ = interpolation_space(np.linspace(0.0, 1.0, 10, endpoint=not closed), 4, closed)
        matrix = basis_matrix(space, np.linspace(0.0, 1.0, 23))
        assert np.sum(matrix, axis=1) == pytest.approx(np.ones(23), abs=1e-14)
        assert np.min(matrix) >= 0.0


POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 2, 0]], float)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: neutral_curve(POINTS[:3]), "3 points for degree 3; expected at least 4 points"),
        (lambda: neutral_curve(POINTS[[0, 1, 1, 2, 3]]), "points 2 and 3 are both at"),
        (lambda: neutral_curve(POINTS[[0, 1, 2, 3, 0]], closed=True), "without its first point again"),
        (lambda: neutral_curve(POINTS, degree=8), "degree 8"),
        (lambda: neutral_curve(POINTS, parametrisation="arc"), "'chord', 'centripetal', 'uniform'"),
        (lambda: neutral_curve(POINTS[:, :2]), r"shape \(5, 2\)"),
        (lambda: neutral_curve(POINTS * np.nan), "not finite"),
        (lambda: neutral_curve(POINTS, mode_shapes=np.zeros((2, 4, 3))), r"expected shape \(modes, 5, 3\)"),
        (lambda: neutral_surface(POINTS), r"expected shape \(a, b, 3\)"),
        (lambda: neutral_surface(np.zeros((5, 5, 3))), "in one place"),
        (lambda: neutral_surface(np.tile(POINTS, (3, 1, 1))), "3 points for degree 3"),
        (
            lambda: neutral_surface(np.tile(POINTS, (5, 1, 1)), source="deck"),
            "deck, first direction: all points",
        ),
        (
            lambda: neutral_surface(np.stack([POINTS + np.array([0, 0, z]) for z in (0, 1, 1, 2, 3)])),
            "lines 2 and 3 of points lie on each other",
        ),
    ],
)
def test_what_cannot_be_fitted(make, words: str) -> None:
    with pytest.raises(InputError, match=words):
        make()


@pytest.mark.parametrize(
    ("degree", "knots", "count", "closed", "words"),
    [
        (0, [0, 1], 1, False, "degree 0"),
        (3, [0, 0, 0, 0, 1, 1, 1], 3, False, "3 control points for degree 3"),
        (2, [0, 0, 0, 1, 1], 3, False, "5 knots for 3 control points of degree 2; expected 6"),
        (2, [0, 0, 0, 0.7, 0.4, 1, 1, 1], 5, False, "knot 5 .0.4. is below knot 4 .0.7."),
        (2, [0, 0, 0, 2, 2, 2], 3, False, "the domain is 0 to 2"),
        (1, [-1, 0, 0.5, 1, 1], 3, False, "not clamped"),
        (2, [0, 0, 0, 0.5, 0.5, 0.5, 1, 1, 1], 6, False, "knot 0.5 stands 3 times"),
        (1, [-0.4, 0, 0.5, 1, 1.5], 2, True, "do not repeat"),
    ],
)
def test_knots_that_make_no_space(degree, knots, count, closed, words: str) -> None:
    with pytest.raises(InputError, match=words):
        SplineSpace(degree, np.array(knots, float), count, closed)
