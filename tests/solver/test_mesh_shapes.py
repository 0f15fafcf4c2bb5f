"""Meshes in simple shapes: positions, slopes that fit, numbering, edges, what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.mesh_shapes import (
    FrameMesh,
    ShellMesh,
    arc,
    grid,
    line,
    quadrilateral,
    rectangle,
    spline,
)

CORNERS = np.array([[0.0, 0.0, 1.0], [4.0, 0.5, 1.0], [3.5, 2.5, 1.0], [-0.5, 2.0, 1.0]])


def surface(mesh: ShellMesh, element: int, x: float, y: float) -> np.ndarray:
    """Position on an element by its nodal vectors: cubic Hermite along both directions."""

    def cubic(z: float, length: float) -> np.ndarray:
        return np.array(
            [
                [1 - 3 * z**2 + 2 * z**3, length * (z - 2 * z**2 + z**3)],
                [3 * z**2 - 2 * z**3, length * (z**3 - z**2)],
            ]
        )

    a, b = mesh.lengths[element]
    total = np.zeros(3)
    for node, (i, j) in zip(mesh.elements[element], ((0, 0), (1, 0), (1, 1), (0, 1)), strict=True):
        u, v = cubic(x, a)[i], cubic(y, b)[j]
        vectors = [mesh.nodes[node], *mesh.slopes[node]]
        total += sum(
            f * r for f, r in zip((u[0] * v[0], u[1] * v[0], u[0] * v[1], u[1] * v[1]), vectors, strict=True)
        )
    return total


def test_a_rectangle_has_unit_slopes_and_equal_elements() -> None:
    mesh = rectangle(6.0, 2.0, 3, 2)
    np.testing.assert_allclose(
        mesh.slopes, np.tile([[1, 0, 0], [0, 1, 0], [0, 0, 0]], (12, 1, 1)), atol=1e-14
    )
    np.testing.assert_allclose(mesh.lengths, np.tile([2.0, 1.0], (6, 1)), rtol=1e-14)
    np.testing.assert_allclose(
        mesh.nodes[mesh.corners], [[0, 0, 0], [6, 0, 0], [6, 2, 0], [0, 2, 0]], atol=1e-14
    )
    for nodes in mesh.elements:
        x = mesh.nodes[nodes] - mesh.nodes[nodes[0]]
        np.testing.assert_allclose(x, [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], atol=1e-14)


@pytest.mark.parametrize(("nx", "ny"), [(5, 2), (2, 5), (3, 3)])
def test_numbers_run_along_the_short_side_first(nx: int, ny: int) -> None:
    mesh = rectangle(1.0, 1.0, nx, ny)
    apart = max(abs(int(i) - int(j)) for nodes in mesh.elements for i in nodes for j in nodes)
    assert apart == min(nx, ny) + 2
    assert sorted(set(mesh.elements.ravel().tolist())) == list(range((nx + 1) * (ny + 1)))


@pytest.mark.parametrize(("nx", "ny"), [(4, 2), (2, 4)])
def test_edges_are_where_their_names_say(nx: int, ny: int) -> None:
    mesh = rectangle(4.0, 3.0, nx, ny)
    for name, axis, value, count in (
        ("x_min", 0, 0.0, ny), ("x_max", 0, 4.0, ny), ("y_min", 1, 0.0, nx), ("y_max", 1, 3.0, nx),
    ):  # fmt: skip
        at = mesh.nodes[mesh.edges[name]]
        assert len(at) == count + 1
        assert np.all(at[:, axis] == value)
        assert np.all(np.diff(at[:, 1 - axis]) > 0.0)


def test_a_quadrilateral_is_met_everywhere() -> None:
    mesh = quadrilateral(CORNERS, 3, 2)
    size = np.array([3, 2])
    for element in range(6):
        i, j = divmod(element, 2)
        for x, y in ((0.0, 0.0), (0.3, 0.8), (1.0, 0.5), (0.5, 0.5)):
            u, v = (np.array([i + x, j + y])) / size
            expected = np.array([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v]) @ CORNERS
            np.testing.assert_allclose(surface(mesh, element, x, y), expected, atol=1e-13)
    np.testing.assert_allclose(mesh.nodes[mesh.corners], CORNERS, atol=1e-14)


def curved(n: int) -> ShellMesh:
    u = np.linspace(0.0, 1.0, n + 1)
    x, y = np.meshgrid(u, u**1.5, indexing="ij")
    return grid(np.stack([x + 0.1 * np.sin(3 * y), y + 0.1 * np.cos(2 * x), 0 * x], axis=-1))


def test_a_curved_grid_is_smooth_across_edges() -> None:
    mesh, h = curved(4), 1e-5
    mesh_elements = {tuple(nodes[[0, 1]].tolist()): e for e, nodes in enumerate(mesh.elements)}
    for e, nodes in enumerate(mesh.elements):
        upper = mesh_elements.get((int(nodes[3]), int(nodes[2])))
        if upper is None:
            continue
        for x in (0.0, 0.4):
            below = (surface(mesh, e, x, 1.0) - surface(mesh, e, x, 1.0 - h)) / (h * mesh.lengths[e, 1])
            above = (surface(mesh, upper, x, h) - surface(mesh, upper, x, 0.0)) / (h * mesh.lengths[upper, 1])
            np.testing.assert_allclose(below, above, atol=1e-3)  # one-sided differences


def test_slopes_of_a_curved_grid_converge_with_its_spacing() -> None:
    # slopes of parabolas err by h^2 r'''/6 within and h^2 r'''/3 at the ends,
    # the middle of an element by h/8 of their difference
    errors = []
    for n in (8, 16, 32):
        mesh, worst = curved(n), 0.0
        for e in range(0, n * n, max(1, n * n // 60)):
            i, j = divmod(e, n)
            found = surface(mesh, e, 0.0, 0.5)
            y = np.linspace((j / n) ** 1.5, ((j + 1) / n) ** 1.5, 2001)
            true = np.stack([i / n + 0.1 * np.sin(3 * y), y + 0.1 * np.cos(2 * i / n), 0 * y], axis=-1)
            worst = max(worst, np.linalg.norm(true - found, axis=1).min())
        assert worst < 2.7 * (1.5 / n) ** 3 / 12.0
        errors.append(worst)
    assert errors[0] / errors[2] > 2.0**5


@pytest.mark.parametrize(
    ("make", "key"),
    [
        (lambda: rectangle(0.0, 1.0, 1, 1), "length_x"),
        (lambda: rectangle(1.0, np.inf, 1, 1), "length_y"),
        (lambda: rectangle(1.0, 1.0, 0, 1), "nx"),
        (lambda: rectangle(1.0, 1.0, 1, 1.5), "ny"),  # type: ignore[arg-type]
        (lambda: quadrilateral(CORNERS[:3], 1, 1), "corners"),
        (lambda: quadrilateral(CORNERS[[0, 0, 2, 3]], 1, 1), "points"),
        (lambda: grid(np.zeros((2, 3))), "points"),
        (lambda: grid(np.full((2, 2, 3), np.nan)), "points"),
        (lambda: line([0, 0, 0], [0, 0, 0], 1), "end"),
        (lambda: line([0, 0], [1, 0, 0], 1), "start"),
        (lambda: line([0, 0, 0], [1, 0, 0], 0), "n"),
        (lambda: arc([0, 0, 0], -1.0, 0.0, 1.0, 2), "radius"),
        (lambda: arc([0, 0, 0], 1.0, 1.0, 1.0, 2), "end_angle"),
        (lambda: arc([0, 0, 0], 1.0, 0.0, 1.0, 2, ((1, 0, 0), (2, 0, 0))), "axes"),
        (lambda: spline([[0, 0, 0]]), "points"),
        (lambda: spline([[0, 0, 0], [0, 0, 0]]), "points"),
    ],
)
def test_shapes_that_cannot_be_are_refused(make: Any, key: str) -> None:
    with pytest.raises(InputError) as error:
        make()
    assert error.value.key == key


def check_chain(mesh: FrameMesh, count: int) -> None:
    assert mesh.elements.tolist() == [[i, i + 1] for i in range(count)]
    assert mesh.nodes.shape == mesh.tangents.shape == (count + 1, 3)
    np.testing.assert_allclose(np.linalg.norm(mesh.tangents, axis=1), 1.0, rtol=1e-14)


def test_a_line_is_divided_equally() -> None:
    mesh = line([1.0, 2.0, 3.0], [1.0, 5.0, 7.0], 5)
    check_chain(mesh, 5)
    np.testing.assert_allclose(np.diff(mesh.nodes, axis=0), np.tile([0.0, 0.6, 0.8], (5, 1)), atol=1e-14)
    np.testing.assert_allclose(mesh.tangents, np.tile([0.0, 0.6, 0.8], (6, 1)), atol=1e-14)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_an_arc_lies_on_its_circle(way: float) -> None:
    centre, start = np.array([1.0, 2.0, 3.0]), 0.4
    mesh = arc(centre, 2.5, start, start + way * 2.0, 8, ((0.0, 3.0, 0.0), (0.0, 1.0, 2.0)))
    check_chain(mesh, 8)
    radii = mesh.nodes - centre
    np.testing.assert_allclose(np.linalg.norm(radii, axis=1), 2.5, rtol=1e-14)
    np.testing.assert_allclose(np.sum(radii * mesh.tangents, axis=1), 0.0, atol=1e-14)
    np.testing.assert_allclose(
        np.cross(radii, mesh.tangents), np.tile([2.5 * way, 0.0, 0.0], (9, 1)), atol=1e-13
    )
    np.testing.assert_allclose(radii[0], 2.5 * np.array([0.0, np.cos(start), np.sin(start)]), atol=1e-14)


def test_a_spline_passes_its_points_and_divides_its_length_equally() -> None:
    angles = np.linspace(0.0, 2.0, 15)
    points = np.stack([np.cos(angles), np.sin(angles), 0.5 * angles], axis=1)
    through = spline(points)
    check_chain(through, 14)
    np.testing.assert_allclose(through.nodes, points, atol=1e-14)
    helix = np.stack([-np.sin(angles), np.cos(angles), 0.5 + 0 * angles], axis=1) / np.sqrt(1.25)
    np.testing.assert_allclose(through.tangents, helix, atol=5e-4)
    even = spline(points, 6)
    check_chain(even, 6)
    # equal arc length on a helix is equal angle
    np.testing.assert_allclose(
        np.unwrap(np.arctan2(even.nodes[:, 1], even.nodes[:, 0])), np.linspace(0, 2, 7), atol=1e-5
    )
    np.testing.assert_array_equal(even.nodes[[0, -1]], points[[0, -1]])


def test_two_points_make_a_straight_spline() -> None:
    mesh = spline([[0.0, 0.0, 0.0], [3.0, 4.0, 0.0]], 4)
    check_chain(mesh, 4)
    np.testing.assert_allclose(mesh.tangents, np.tile([0.6, 0.8, 0.0], (5, 1)), atol=1e-14)
    np.testing.assert_allclose(mesh.nodes[:, 0], np.linspace(0, 3, 5), atol=1e-13)
