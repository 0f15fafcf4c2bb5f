"""CPU time of contours: points with derivatives, weights of control points, Jacobians, the fit; beside other programs.

Run with ``python benchmarks/nurbs.py``. Times are medians on one thread, at random places of a contour of 21 x 11
control points; scipy and geomdl are measured where they are installed.
"""

from __future__ import annotations

import statistics
import time
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.contours.splines.evaluate import (
    SCRATCH,
    Evaluation,
    curve_point,
    surface_point,
    surface_weights,
)
from heavylift.contours.splines.modal_sums import modal_data, modal_points, modal_shapes
from heavylift.contours.splines.neutral import NeutralContour, neutral_surface, packed
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    from collections.abc import Callable

COUNTS = (21, 11)
PLACES = 2000
SECONDS = 0.5  # of one measurement
MODES = (20, 100)


@kernel
def points(contour, knots, weights, net, uv, scratch, out):  # type: ignore[no-untyped-def]
    total = 0.0
    for i in range(uv.shape[0]):
        surface_point(contour, knots, weights, net, uv[i, 0], uv[i, 1], scratch, out)
        total += out.position[0] + out.derivative_vv[2]
    return total


@kernel
def points_of_curve(contour, knots, weights, net, uv, scratch, out):  # type: ignore[no-untyped-def]
    total = 0.0
    for i in range(uv.shape[0]):
        curve_point(contour, knots, weights, net, uv[i, 0], scratch, out)
        total += out.position[0] + out.derivative_uu[2]
    return total


@kernel
def sums(contour, knots, weights, uv, scratch, controls, w):  # type: ignore[no-untyped-def]
    total = 0.0
    for i in range(uv.shape[0]):
        stride = surface_weights(contour, knots, weights, uv[i, 0], uv[i, 1], scratch, controls, w)
        total += w[0] + controls[stride - 1]
    return total


@kernel
def jacobians(contour, knots, weights, net, uv, scratch, out, controls, w, data, q, jacobian):  # type: ignore[no-untyped-def]
    """Control points from the coordinates, the point from them, and its Jacobian: all that a contact needs."""
    total = 0.0
    n = q.shape[0]
    for i in range(uv.shape[0]):
        stride = surface_weights(contour, knots, weights, uv[i, 0], uv[i, 1], scratch, controls, w)
        modal_points(data, 0, n, q, 0, controls, stride, net, 0)
        surface_point(contour, knots, weights, net, uv[i, 0], uv[i, 1], scratch, out)
        modal_shapes(data, 0, n, controls, stride, w, 0, jacobian, 0)
        total += out.position[0] + jacobian[n]
    return total


def measured(run: Callable[..., object], arguments: tuple[Any, ...], repeats: int) -> float:
    """Median CPU time of one of the repeats within a run [s]."""
    run(*arguments)
    times: list[float] = []
    end = time.perf_counter() + SECONDS
    while time.perf_counter() < end or len(times) < 3:
        begin = time.thread_time()
        run(*arguments)
        times.append((time.thread_time() - begin) / repeats)
    return statistics.median(times)


def grid() -> np.ndarray:
    x, y = np.meshgrid(*(np.linspace(0.0, 1.0, count) for count in COUNTS), indexing="ij")
    return np.stack([x, y, 0.1 * np.sin(5.0 * x) * np.cos(4.0 * y)], axis=-1)


def tell(what: str, seconds: float) -> None:
    print(f"{what:66s} {1e6 * seconds:9.3f} us")


def measure_kernels() -> None:
    random = np.random.default_rng(1)
    uv = random.uniform(size=(PLACES, 2))
    scratch, out = np.zeros(SCRATCH), Evaluation.one()
    controls, w = np.zeros(64, dtype=np.int64), np.zeros(192)
    for degree in (2, 3, 4, 5):
        for rational in (False, True):
            plain = neutral_surface(grid(), degrees=(degree, degree))
            given = random.uniform(0.5, 2.0, len(plain.control)) if rational else np.empty(0)
            surface = NeutralContour(plain.spaces, plain.control, plain.modal, given)
            table, knots, weights, net = packed([surface])
            kind = f"degree {degree}, {'rational' if rational else 'polynomial'}"
            run = (table[0], knots, weights, net, uv, scratch, out)
            tell(f"{kind}: point, tangents, second derivatives", measured(points, run, PLACES))
            tell(f"{kind}: curve", measured(points_of_curve, run, PLACES))
            run_sums = (table[0], knots, weights, uv, scratch, controls, w)
            tell(f"{kind}: weights of control points", measured(sums, run_sums, PLACES))
    for modes in MODES:
        shapes = random.normal(size=(modes, *COUNTS, 3))
        surface = neutral_surface(grid(), mode_shapes=shapes)
        table, knots, weights, net = packed([surface])
        q, jacobian = random.normal(size=modes), np.zeros(3 * modes)
        full = (
            table[0],
            knots,
            weights,
            net,
            uv,
            scratch,
            out,
            controls,
            w,
            modal_data(surface),
            q,
            jacobian,
        )
        kind = f"degree 3, {modes} modes: 16 control points, point, Jacobian"
        tell(kind, measured(jacobians, full, PLACES))
        tell(f"fit of the surface and {modes} modes, once", measured(fit, (shapes,), 1))


def fit(shapes: np.ndarray) -> NeutralContour:
    return neutral_surface(grid(), mode_shapes=shapes)


def measure_others() -> None:
    surface = neutral_surface(grid())
    spaces = surface.spaces
    try:
        from scipy.interpolate import NdBSpline

        spline = NdBSpline((spaces[0].knots, spaces[1].knots), surface.control.reshape(*COUNTS, 3), 3)

        def derivatives(at: np.ndarray) -> list[np.ndarray]:
            return [spline(at, nu=order) for order in ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))]

        many = np.random.default_rng(1).uniform(size=(PLACES, 2))
        tell("scipy NdBSpline, the same at one place", measured(derivatives, (many[:1],), 1))
        tell("scipy NdBSpline, each of many places at once", measured(derivatives, (many,), PLACES))
    except ImportError:
        print("scipy has no NdBSpline here")
    try:
        from geomdl import BSpline  # type: ignore[import-untyped, import-not-found, unused-ignore]
    except ImportError:
        print("geomdl is not installed")
        return
    other = BSpline.Surface(normalize_kv=False)
    other.degree_u = other.degree_v = 3
    other.set_ctrlpts(surface.control.tolist(), *COUNTS)
    other.knotvector_u, other.knotvector_v = spaces[0].knots.tolist(), spaces[1].knots.tolist()
    tell("geomdl, derivatives to order 2", measured(other.derivatives, (0.3, 0.6, 2), 1))


if __name__ == "__main__":
    measure_kernels()
    measure_others()
