"""Curves and surfaces against scipy, geomdl, closed forms and each other."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline, NdBSpline

from heavylift.contours.splines.basis import wrap
from heavylift.contours.splines.derivatives import fill_curve, fill_surface
from heavylift.contours.splines.evaluate import (
    SCRATCH,
    Evaluation,
    curve_weights,
    surface_weights,
)
from heavylift.contours.splines.imported import imported_contour
from heavylift.contours.splines.neutral import NeutralContour, packed
from heavylift.contours.splines.packed_contour import PackedContour
from heavylift.contours.splines.spaces import SplineSpace, clamped_space, closed_space
from heavylift.numerics.arrays import Floats1, Ints1
from heavylift.numerics.objects import entry
from heavylift.numerics.records import records

EPS = 1e-12


@entry
def surface_sums(
    contour: PackedContour,
    knots: Floats1,
    weights: Floats1,
    u: float,
    v: float,
    scratch: Floats1,
    controls: Ints1,
    w: Floats1,
) -> int:
    return surface_weights(contour, knots, weights, u, v, scratch, controls, w)


@entry
def curve_sums(
    contour: PackedContour,
    knots: Floats1,
    weights: Floats1,
    u: float,
    scratch: Floats1,
    controls: Ints1,
    w: Floats1,
) -> int:
    return curve_weights(contour, knots, weights, u, scratch, controls, w)


@entry
def wrapped(u: float, closed: int) -> float:
    return wrap(u, closed)


def space_of(degree: int, count: int, closed: bool, seed: int = 0) -> SplineSpace:
    """Uneven knots, one of them double."""
    random = np.random.default_rng(seed)
    if closed:
        inner = np.sort(random.uniform(0.02, 0.98, count - 1))
        return closed_space(degree, np.concatenate([[0.0], inner]))
    inner = np.sort(random.uniform(0.02, 0.98, count - degree - 1))
    if degree > 1 and inner.size > 3:
        inner[2] = inner[1]
    return clamped_space(degree, inner)


def surface_of(spaces: tuple[SplineSpace, SplineSpace], rational: bool, seed: int = 1) -> NeutralContour:
    random = np.random.default_rng(seed)
    count = spaces[0].count * spaces[1].count
    weights = random.uniform(0.5, 2.0, count) if rational else np.empty(0)
    return NeutralContour(spaces, random.normal(size=(count, 3)), np.zeros((0, count, 3)), weights)


def evaluate_surface(contour: NeutralContour, uv: np.ndarray) -> np.ndarray:
    # second in the packed arrays, so that every offset counts
    table, knots, weights, net = packed([surface_of((space_of(2, 4, False),) * 2, True), contour])
    out = records(Evaluation, len(uv))
    out.view(np.float64)[:] = np.nan
    fill_surface(table[1], knots, weights, net, uv, np.zeros(SCRATCH), out)
    return out.view(np.float64).reshape(-1, 6, 3)


def evaluate_curve(contour: NeutralContour, u: np.ndarray) -> np.ndarray:
    table, knots, weights, net = packed([contour])
    out = records(Evaluation, len(u))
    fill_curve(table[0], knots, weights, net, u[:, None].copy(), np.zeros(SCRATCH), out)
    return np.stack([out["position"], out["tangent_u"], out["derivative_uu"]], axis=1)


def control_of_functions(space: SplineSpace, control: np.ndarray, axis: int) -> np.ndarray:
    return np.take(control, np.arange(space.functions) % space.count, axis=axis)


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5, 7])
def test_curve_against_scipy(degree: int, closed: bool) -> None:
    space = space_of(degree, 11, closed)
    control = np.random.default_rng(degree).normal(size=(space.count, 3))
    contour = NeutralContour((space,), control, np.zeros((0, space.count, 3)), np.empty(0))
    u = np.linspace(0.0, 0.999, 60)
    ours = evaluate_curve(contour, u)
    spline = BSpline(space.knots, control_of_functions(space, control, 0), degree, extrapolate=False)
    for order in range(3):
        theirs = spline(u, nu=order)
        assert ours[:, order] == pytest.approx(theirs, abs=EPS * (1.0 + np.max(np.abs(theirs))))


@pytest.mark.parametrize("degrees", [(1, 2), (2, 3), (3, 3), (4, 3), (5, 4)])
@pytest.mark.parametrize("closed", [(False, False), (True, False), (True, True)])
def test_surface_against_scipy(degrees: tuple[int, int], closed: tuple[bool, bool]) -> None:
    spaces = (space_of(degrees[0], 9, closed[0], 2), space_of(degrees[1], 8, closed[1], 3))
    contour = surface_of(spaces, False)
    uv = np.random.default_rng(4).uniform(size=(40, 2))
    uv[0] = 0.0
    ours = evaluate_surface(contour, uv)
    net = contour.control.reshape(9, 8, 3)
    net = control_of_functions(spaces[1], control_of_functions(spaces[0], net, 0), 1)
    spline = NdBSpline((spaces[0].knots, spaces[1].knots), net, degrees)
    for which, orders in enumerate([(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]):
        theirs = spline(uv, nu=orders)
        assert ours[:, which] == pytest.approx(theirs, abs=EPS * (1.0 + np.max(np.abs(theirs))))


@pytest.mark.parametrize("rational", [False, True])
@pytest.mark.parametrize("degrees", [(1, 3), (3, 3), (2, 5)])
def test_surface_against_geomdl(degrees: tuple[int, int], rational: bool) -> None:
    geomdl = pytest.importorskip("geomdl")
    from geomdl import NURBS
    from geomdl import BSpline as Plain

    assert geomdl.__version__
    spaces = (space_of(degrees[0], 9, False, 5), space_of(degrees[1], 8, False, 6))
    contour = surface_of(spaces, rational)
    surface = NURBS.Surface(normalize_kv=False) if rational else Plain.Surface(normalize_kv=False)
    surface.degree_u, surface.degree_v = degrees
    if rational:
        homogeneous = np.column_stack([contour.control * contour.weights[:, None], contour.weights])
        surface.set_ctrlpts(homogeneous.tolist(), 9, 8)
    else:
        surface.set_ctrlpts(contour.control.tolist(), 9, 8)
    surface.knotvector_u, surface.knotvector_v = spaces[0].knots.tolist(), spaces[1].knots.tolist()
    uv = np.random.default_rng(7).uniform(size=(15, 2))
    ours = evaluate_surface(contour, uv)
    for i, (u, v) in enumerate(uv):
        theirs = surface.derivatives(u, v, order=2)
        for which, (a, b) in enumerate([(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]):
            reference = np.array(theirs[a][b])
            scale = 1.0 + np.max(np.abs(reference))
            assert ours[i, which] == pytest.approx(reference, abs=10 * EPS * scale)


def test_curve_against_geomdl_rational() -> None:
    pytest.importorskip("geomdl")
    from geomdl import NURBS

    space = space_of(4, 9, False, 8)
    random = np.random.default_rng(9)
    control, weights = random.normal(size=(9, 3)), random.uniform(0.5, 2.0, 9)
    contour = NeutralContour((space,), control, np.zeros((0, 9, 3)), weights)
    curve = NURBS.Curve(normalize_kv=False)
    curve.degree = 4
    curve.ctrlpts = control.tolist()
    curve.weights = weights.tolist()
    curve.knotvector = space.knots.tolist()
    u = np.linspace(0.0, 1.0, 23)
    ours = evaluate_curve(contour, u)
    for i, value in enumerate(u):
        theirs = np.array(curve.derivatives(value, order=2))
        assert ours[i] == pytest.approx(theirs, abs=EPS * (1.0 + np.max(np.abs(theirs))))


def test_rational_circle_is_round_and_its_curvature_right() -> None:
    corner = np.sqrt(0.5)
    square = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)], float)
    control = 2.5 * np.column_stack([square, np.zeros(9)])
    weights = np.array([1, corner, 1, corner, 1, corner, 1, corner, 1])
    knots = np.array([0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4], float)
    for closed in (False, True):
        circle = imported_contour((knots,), control, (2,), weights=weights, closed=(closed,))
        values = evaluate_curve(circle, np.linspace(-0.3 if closed else 0.0, 1.0, 101))
        position, slope, second = values[:, 0], values[:, 1], values[:, 2]
        assert np.linalg.norm(position, axis=1) == pytest.approx(2.5, abs=EPS)
        speed = np.linalg.norm(slope, axis=1)
        curvature = np.linalg.norm(np.cross(slope, second), axis=1) / speed**3
        assert curvature == pytest.approx(1.0 / 2.5, abs=1e-11)


@pytest.mark.parametrize("rational", [False, True])
@pytest.mark.parametrize("closed", [False, True])
def test_weights_add_up_to_points(rational: bool, closed: bool) -> None:
    contour = surface_of((space_of(3, 9, closed, 2), space_of(2, 8, closed, 3)), rational)
    table, knots, weights, _ = packed([contour])
    scratch, controls, w = np.zeros(SCRATCH), np.zeros(12, dtype=np.int64), np.zeros(36)
    for u, v in np.random.default_rng(0).uniform(size=(20, 2)):
        stride = surface_sums(table[0], knots, weights, u, v, scratch, controls, w)
        assert stride == 12
        assert len(set(controls.tolist())) == stride
        assert np.sum(w[:stride]) == pytest.approx(1.0, abs=EPS)
        expected = evaluate_surface(contour, np.array([[u, v]]))[0, :3]
        sums = w.reshape(3, stride) @ contour.control[controls]
        assert sums == pytest.approx(expected, abs=EPS * (1.0 + np.max(np.abs(expected))))


@pytest.mark.parametrize("rational", [False, True])
def test_curve_weights_add_up_to_points(rational: bool) -> None:
    space = space_of(3, 9, True, 2)
    random = np.random.default_rng(1)
    given = random.uniform(0.5, 2.0, 9) if rational else np.empty(0)
    contour = NeutralContour((space,), random.normal(size=(9, 3)), np.zeros((0, 9, 3)), given)
    table, knots, weights, _ = packed([contour])
    scratch, controls, w = np.zeros(SCRATCH), np.zeros(4, dtype=np.int64), np.zeros(12)
    for u in random.uniform(size=10):
        assert curve_sums(table[0], knots, weights, u, scratch, controls, w) == 4
        expected = evaluate_curve(contour, np.array([u]))[0]
        sums = w.reshape(3, 4) @ contour.control[controls]
        assert sums[:2] == pytest.approx(expected[:2], abs=EPS * (1.0 + np.max(np.abs(expected))))
        assert not np.any(sums[2])


def test_closed_directions_wrap_and_open_ones_end() -> None:
    contour = surface_of((space_of(3, 9, True, 2), space_of(3, 8, False, 3)), False)
    at = evaluate_surface(contour, np.array([[0.25, 1.0], [1.25, 1.0], [-2.75, 1.7], [0.25, 2.0]]))
    assert at[1] == pytest.approx(at[0], abs=1e-10)
    assert at[2] == pytest.approx(at[0], abs=1e-10)
    assert np.array_equal(at[3], at[0])
    assert wrapped(-1e-20, 1) == 0.0
    assert wrapped(1.0, 1) == 0.0
    assert wrapped(1.0, 0) == 1.0


def test_seam_of_a_closed_cubic_is_smooth_to_second_order() -> None:
    space = space_of(3, 9, True, 2)
    control = np.random.default_rng(1).normal(size=(9, 3))
    contour = NeutralContour((space,), control, np.zeros((0, 9, 3)), np.empty(0))
    below, above = evaluate_curve(contour, np.array([1.0 - 1e-15, 0.0]))
    assert below == pytest.approx(above, abs=1e-9)


def test_spans_of_knots_that_crowd_at_one_end() -> None:
    # graded by ten orders of magnitude: the guessed span is far off, the search by halves must find it
    for inner in (np.logspace(-10, -0.1, 60), 1.0 - np.logspace(-0.1, -10, 60)):
        space = clamped_space(3, inner)
        control = np.random.default_rng(1).normal(size=(space.count, 3))
        contour = NeutralContour((space,), control, np.zeros((0, space.count, 3)), np.empty(0))
        u = np.concatenate([inner, inner[:-1] + 0.5 * np.diff(inner), [0.0, 1.0]])
        theirs = BSpline(space.knots, control, 3)(u)
        assert evaluate_curve(contour, u)[:, 0] == pytest.approx(theirs, abs=1e-11)


def test_not_a_number_stays_visible() -> None:
    contour = surface_of((space_of(3, 9, True, 2), space_of(3, 8, False, 3)), False)
    assert np.all(np.isnan(evaluate_surface(contour, np.array([[np.nan, 0.5]]))))
