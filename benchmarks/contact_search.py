"""Time of one contact search on a bicubic surface of 21 x 11 control points, warm and cold, one thread.

    python benchmarks/contact_search.py

Medians of CPU time over batches of random points up to a tenth of the surface's size away from it. A warm search starts
where the point was before it moved; all end with parameters to 1e-12.
"""

from __future__ import annotations

import statistics
import time
from typing import TYPE_CHECKING

import numpy as np

from heavylift.contours.splines.convex import (
    BOX,
    CAPSULE,
    CYLINDER,
    ELLIPSOID,
    RING,
    shape_row,
)
from heavylift.contours.splines.evaluate import SCRATCH, Evaluation, surface_point
from heavylift.contours.splines.packed_contour import PackedContour, PackedDirection
from heavylift.contours.splines.sample_packing import pack_samples
from heavylift.contours.splines.samples import sample_points
from heavylift.contours.splines.search import closest_on_surface, open_window
from heavylift.contours.splines.search_circle import ring_cold, ring_on_surface, start_ring
from heavylift.contours.splines.search_cold import closest_point_cold
from heavylift.contours.splines.search_shape import closest_shape_cold, closest_shape_on_surface
from heavylift.contours.splines.search_step import CONVERGED, ContourSearch, start_search
from heavylift.contours.splines.spaces import clamped_space
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import filled, records

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

COUNT = 2000
REPEATS = 21


@kernel
def evaluate(contour, knots, weights, net, starts, scratch, points, normals, out):
    for i in range(starts.shape[0]):
        surface_point(contour, knots, weights, net, starts[i, 0], starts[i, 1], scratch, out)
        for k in range(3):
            points[i, k] = out.position[k]
            a, b = (k + 1) % 3, (k + 2) % 3
            normals[i, k] = out.tangent_u[a] * out.tangent_v[b] - out.tangent_u[b] * out.tangent_v[a]


@kernel
def warm_points(contour, knots, weights, net, points, starts, scratch, result, found):
    failed = 0
    for i in range(points.shape[0]):
        open_window(result)
        start_search(contour, starts[i, 0], starts[i, 1], result)
        at = (points[i, 0], points[i, 1], points[i, 2])
        status = closest_on_surface(contour, knots, weights, net, at, scratch, result)
        failed += status != CONVERGED
        found[i, 0], found[i, 1], found[i, 2] = result.u, result.v, result.iterations
    return failed


@kernel
def cold_points(contour, knots, weights, net, points, samples, scratch, result, found):
    failed = 0
    for i in range(points.shape[0]):
        at = (points[i, 0], points[i, 1], points[i, 2])
        status = closest_point_cold(
            contour, knots, weights, net, at, samples, samples.grids[0], scratch, result
        )
        failed += status != CONVERGED
        found[i, 0], found[i, 1], found[i, 2] = result.u, result.v, result.iterations
    return failed


@kernel
def warm_shapes(contour, knots, weights, net, kind, shape, points, starts, scratch, result, found):
    failed = 0
    for i in range(points.shape[0]):
        for k in range(3):
            shape.centre[k] = points[i, k]
        open_window(result)
        start_search(contour, starts[i, 0], starts[i, 1], result)
        status = closest_shape_on_surface(contour, knots, weights, net, kind, shape, scratch, result)
        failed += status != CONVERGED
        found[i, 0], found[i, 1], found[i, 2] = result.u, result.v, result.iterations
    return failed


@kernel
def cold_shapes(contour, knots, weights, net, kind, shape, points, samples, scratch, result, found):
    failed = 0
    for i in range(points.shape[0]):
        for k in range(3):
            shape.centre[k] = points[i, k]
        status = closest_shape_cold(
            contour, knots, weights, net, kind, shape, samples, samples.grids[0], scratch, result
        )
        failed += status != CONVERGED
        found[i, 0], found[i, 1], found[i, 2] = result.u, result.v, result.iterations
    return failed


@kernel
def warm_rings(contour, knots, weights, net, shape, points, starts, scratch, result, found):
    failed = 0
    for i in range(points.shape[0]):
        for k in range(3):
            shape.centre[k] = points[i, k]
        open_window(result)
        start_ring(contour, starts[i, 0], starts[i, 1], starts[i, 2], result)
        status = ring_on_surface(contour, knots, weights, net, shape, scratch, result)
        failed += status != CONVERGED
        found[i, 0], found[i, 1], found[i, 2] = result.u, result.v, result.ring.evaluations
        found[i, 3] = result.ring.angle
    return failed


@kernel
def cold_rings(contour, knots, weights, net, shape, points, samples, scratch, result, found):
    failed = 0
    for i in range(points.shape[0]):
        for k in range(3):
            shape.centre[k] = points[i, k]
        status = ring_cold(contour, knots, weights, net, shape, samples, samples.grids[0], scratch, result)
        failed += status != CONVERGED
        found[i, 0], found[i, 1], found[i, 2] = result.u, result.v, result.ring.evaluations
        found[i, 3] = result.ring.angle
    return failed


def median_time(work: Callable[[], object], count: int) -> float:
    """Median CPU time of one of `count` items [us]; compiled before."""
    work()
    times = []
    for _ in range(REPEATS):
        before = time.thread_time()
        work()
        times.append(time.thread_time() - before)
    return 1e6 * statistics.median(times) / count


def line(name: str, microseconds: float, found: NDArray[np.float64] | None, failed: object) -> None:
    evaluations = "" if found is None else f"{np.mean(found[:, 2]):8.2f}"
    print(f"{name:44s} {microseconds:8.2f} us {evaluations:>8s} {failed or ''}")


def main() -> None:
    """Print a table: search, time, evaluations of the last Newton iteration, how many did not converge."""
    generator = np.random.default_rng(1)
    spaces = clamped_space(3, np.arange(1, 18) / 18), clamped_space(3, np.arange(1, 8) / 8)
    su, sv = spaces
    x, y = np.meshgrid(np.linspace(0.0, 1.0, su.count), np.linspace(0.0, 0.5, sv.count), indexing="ij")
    net = np.stack([x, y, 0.05 * np.sin(9.0 * x) * np.cos(7.0 * y)], -1).reshape(-1, 3)
    along = filled(PackedDirection, degree=3, count=su.count, closed=False, first_knot=0)
    across = filled(PackedDirection, degree=3, count=sv.count, closed=False, first_knot=su.knots.size)
    table = records(
        PackedContour, [filled(PackedContour, u=along, v=across, first_control=0, first_weight=-1)]
    )
    contour = table[0]
    arrays = contour, np.concatenate([su.knots, sv.knots]), np.zeros(0), np.ascontiguousarray(net)
    scratch, result = np.zeros(SCRATCH), ContourSearch.one()
    feet = 0.05 + 0.9 * generator.random((COUNT, 2))
    points, normals = np.zeros((COUNT, 3)), np.zeros((COUNT, 3))
    out = Evaluation.one()
    print(f"{'':44s} {'time':>11s} {'evaluations':>8s} not converged")
    line(
        "evaluation",
        median_time(lambda: evaluate(*arrays, feet, scratch, points, normals, out), COUNT),
        None,
        0,
    )
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    points += generator.uniform(-0.02, 0.05, (COUNT, 1)) * normals
    found = np.zeros((COUNT, 4))
    for move in (1e-4, 1e-3, 1e-2):
        starts = feet + move / np.sqrt(2.0) * generator.standard_normal((COUNT, 2))
        args = (*arrays, points, starts, scratch, result, found)
        failed = warm_points(*args)
        line(
            f"point, moved by {move:g}",
            median_time(lambda args=args: warm_points(*args), COUNT),
            found,
            failed,
        )

    samples = pack_samples([spaces], table, arrays[2], arrays[3], [False])
    grid = samples.grids[0]
    values = (contour, arrays[2], arrays[3], samples, grid)
    count = grid.count_u * grid.count_v
    line(f"positions of {count} samples", median_time(lambda: sample_points(*values), 1), None, 0)
    failed = cold_points(*arrays, points, samples, scratch, result, found)
    time_taken = median_time(lambda: cold_points(*arrays, points, samples, scratch, result, found), COUNT)
    line("point, cold", time_taken, found, failed)

    tilt = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    above = points + 0.08 * normals
    for name, kind, sizes in (
        ("ellipsoid", ELLIPSOID, (0.06, 0.04, 0.03)),
        ("capsule", CAPSULE, (0.05,)),
        ("rounded box", BOX, (0.03, 0.02, 0.02)),
        ("rounded cylinder", CYLINDER, (0.03, 0.03)),
    ):
        shape = shape_row(kind, sizes, 0.0 if kind == ELLIPSOID else 0.02)
        shape.axes[:] = tilt
        args = (*arrays, kind, shape, above, samples, scratch, result, found)
        failed = cold_shapes(*args)
        starts = found[:, :2] + 1e-3 / np.sqrt(2.0) * generator.standard_normal((COUNT, 2))
        cold = median_time(lambda args=args: cold_shapes(*args), COUNT)
        line(f"{name}, cold", cold, found, failed)
        args = (*arrays, kind, shape, above, starts, scratch, result, found)
        failed = warm_shapes(*args)
        line(
            f"{name}, moved by 0.001", median_time(lambda args=args: warm_shapes(*args), COUNT), found, failed
        )

    shape = shape_row(RING, (0.06,))
    shape.axes[:] = tilt
    args = (*arrays, shape, above, samples, scratch, result, found)
    failed = cold_rings(*args)
    starts = found[:, [0, 1, 3]] + 1e-3 * generator.standard_normal((COUNT, 3))
    line("ring, cold", median_time(lambda: cold_rings(*args), COUNT), found, failed)
    args_warm = (*arrays, shape, above, starts, scratch, result, found)
    failed = warm_rings(*args_warm)
    line("ring, moved by 0.001", median_time(lambda: warm_rings(*args_warm), COUNT), found, failed)


if __name__ == "__main__":
    main()
