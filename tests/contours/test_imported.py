"""NURBS of other programs: domain, seams in three forms, what does not fit together."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline

from heavylift.contours.splines.derivatives import evaluate_contour
from heavylift.contours.splines.imported import imported_contour
from heavylift.numerics.outcome import InputError

RANDOM = np.random.default_rng(4)


def test_any_domain_becomes_zero_to_one() -> None:
    knots = np.array([2, 2, 2, 2, 3, 5, 5, 7, 7, 7, 7], float)
    control = RANDOM.normal(size=(7, 3))
    curve = imported_contour([knots], control, [3])
    u = np.linspace(0.0, 0.999, 20)
    values = evaluate_contour(curve, u)
    reference = BSpline(knots, control, 3)
    for row, order in ((0, 0), (1, 1), (3, 2)):
        expected = reference(2.0 + 5.0 * u, order) * 5.0**order
        assert values[:, row] == pytest.approx(expected, abs=1e-12 * np.max(np.abs(expected)))


def test_weights_all_alike_make_a_polynomial() -> None:
    control = RANDOM.normal(size=(4, 3))
    knots = [np.array([0, 0, 0, 0, 1, 1, 1, 1], float)]
    curve = imported_contour(knots, control, [3], weights=np.full(4, 2.0))
    assert curve.weights.size == 0
    assert np.array_equal(curve.control, control)


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_three_forms_of_a_closed_curve(degree: int) -> None:
    count = 8
    control = RANDOM.normal(size=(count, 3))
    weights = RANDOM.uniform(0.5, 2.0, count)
    knots = np.arange(count + 2 * degree + 1, dtype=float)
    once = imported_contour([knots], control, [degree], weights=weights, closed=[True])
    again = imported_contour(
        [knots],
        np.concatenate([control, control[:degree]]),
        [degree],
        weights=np.concatenate([weights, weights[:degree]]),
        closed=[True],
    )
    u = np.linspace(-0.5, 1.5, 40)
    values = evaluate_contour(once, u)
    assert np.array_equal(values, evaluate_contour(again, u))
    # an open clamped curve of which both ends meet: the same points, periodic or not
    inner = np.sort(RANDOM.uniform(size=5))
    clamped = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    ends = RANDOM.normal(size=(clamped.size - degree - 1, 3))
    ends[-1] = ends[0]
    u = np.linspace(0.0, 0.999, 40)
    opened = evaluate_contour(imported_contour([clamped], ends, [degree]), u)
    closed = evaluate_contour(imported_contour([clamped], ends, [degree], closed=[True]), u)
    assert closed == pytest.approx(opened, abs=1e-11 * np.max(np.abs(opened)))


def test_a_loop_of_one_piece_has_too_few_points_to_be_closed() -> None:
    ends = np.array([[0, 0, 0], [2, 1, 0], [-2, 1, 0], [0, 0, 0]], float)
    knots = np.array([0, 0, 0, 0, 1, 1, 1, 1], float)
    with pytest.raises(InputError, match=r"3 control points for degree 3"):
        imported_contour([knots], ends, [3], closed=[True])


def test_rational_surface_of_revolution_is_a_cylinder() -> None:
    corner = np.sqrt(0.5)
    square = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)], float)
    control = np.zeros((9, 2, 3))
    control[..., :2] = 0.4 * square[:, None, :]
    control[:, 1, 2] = 3.0
    weights = np.tile(np.array([1, corner, 1, corner, 1, corner, 1, corner, 1])[:, None], (1, 2))
    knots = [np.array([0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4], float), np.array([0, 0, 1, 1], float)]
    tube = imported_contour(knots, control, [2, 1], weights=weights, closed=[True, False])
    values = evaluate_contour(tube, RANDOM.uniform(size=(50, 2)))
    assert np.linalg.norm(values[:, 0, :2], axis=1) == pytest.approx(0.4, abs=1e-13)
    normal = np.cross(values[:, 1], values[:, 2])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    assert normal[:, :2] == pytest.approx(values[:, 0, :2] / 0.4, abs=1e-12)


KNOTS = np.array([0, 0, 0, 0, 1, 1, 1, 1], float)
NET = np.arange(12.0).reshape(4, 3) ** 2


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda: imported_contour([KNOTS[:-1]], NET, [3]),
            "7 knots for 4 control points of degree 3; expected 8",
        ),
        (lambda: imported_contour([KNOTS * 0.0], NET, [3]), "domain is 0 to 0"),
        (lambda: imported_contour([KNOTS], NET, [3, 3]), "1 knot vectors and 2 degrees"),
        (lambda: imported_contour([KNOTS], NET[:, :2], [3]), "shape"),
        (lambda: imported_contour([KNOTS], NET, [3], weights=np.ones(3)), "weights"),
        (lambda: imported_contour([KNOTS], NET, [3], weights=np.array([1, 0, 1, 1.0])), "positive"),
        (lambda: imported_contour([KNOTS], NET, [3], closed=[True]), "expected ends that meet"),
        (lambda: imported_contour([np.arange(8.0)], NET, [3], source="hook"), "hook: knots: .*not clamped"),
    ],
)
def test_what_does_not_fit_together(make, words: str) -> None:
    with pytest.raises(InputError, match=words):
        make()
