"""The shape of frames and shells as a spline, against the shape functions of the elements."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.interpolate import BSpline

from heavylift.numerics.outcome import InputError
from heavylift.solver.bodies.ancf.mesh_contour import control_vectors, mesh_contour, start_control
from heavylift.solver.bodies.ancf.types import type_of
from heavylift.solver.scene.mesh_shapes import arc, grid, line, rectangle, spline
from heavylift.solver.scene.meshes import FrameBody, FrameSection, ShellBody, ShellSection

if TYPE_CHECKING:
    from heavylift.contours.splines.spaces import SplineSpace

SECTION = FrameSection(density=1000.0, youngs_modulus=1e7, area=1e-3, second_moment=1e-7)
SHEET = ShellSection(0.01, 1000.0, 1e7, 0.3)
POINTS = [[0.0, 0.0, 0.0], [0.4, 0.1, 0.0], [1.3, 0.3, 0.2], [1.5, 0.5, 0.3]]


def frame(mesh: Any, elements: Any = None) -> FrameBody:
    return FrameBody(
        name="cable",
        nodes=mesh.nodes,
        tangents=mesh.tangents,
        elements=mesh.elements if elements is None else np.asarray(elements),
        sections=(SECTION,),
        model="exact",
    )


def shell(mesh: Any) -> ShellBody:
    return ShellBody(
        name="sheet",
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(SHEET,),
    )


def ring(count: int) -> FrameBody:
    mesh = arc([0.0, 0.0, 0.0], 0.5, 0.0, 2.0 * np.pi, count)
    elements = mesh.elements.copy()
    elements[-1, 1] = 0
    return replace(frame(mesh), nodes=mesh.nodes[:-1], tangents=mesh.tangents[:-1], elements=elements)


def shuffled() -> FrameBody:
    """Elements and nodes of a curve in any order."""
    body = frame(spline(POINTS))
    order, nodes = np.array([2, 0, 1]), np.array([3, 1, 0, 2])
    place = np.argsort(nodes)
    return replace(
        body, nodes=body.nodes[nodes], tangents=body.tangents[nodes], elements=place[body.elements][order]
    )


def uneven_grid(flip: bool) -> ShellBody:
    x, y = np.array([0.0, 0.3, 0.9, 1.1]), np.array([0.0, 0.5, 0.6])
    if flip:
        x, y = y, x
    return shell(grid(np.stack([*np.meshgrid(x, y, indexing="ij"), np.zeros((len(x), len(y)))], axis=-1)))


def basis(space: SplineSpace, u: float, derivative: int = 0) -> np.ndarray:
    """Functions of SciPy, those of a closed spline added up on their control points."""
    functions = len(space.knots) - 4
    found = np.zeros(space.count)
    for i in range(functions):
        one = BSpline(space.knots, np.eye(functions)[i], 3)
        found[i % space.count] += one(u) if derivative == 0 else one.derivative(derivative)(u)
    return found


@pytest.mark.parametrize(
    "body",
    [frame(line([0, 0, 0], [1, 2, 0], 1)), frame(spline(POINTS)), shuffled(), ring(2), ring(3), ring(7)],
    ids=["one", "curve", "shuffled", "ring of two", "ring of three", "ring"],
)
def test_curve_is_the_frame(body: FrameBody) -> None:
    """Deformed at random: positions and tangents, up to the ends of the elements."""
    rng = np.random.default_rng(1)
    made = mesh_contour(body)
    q = rng.normal(size=(2 * len(body.nodes), 3))
    control = np.einsum("nk,nkx->nx", made.factors, q[made.vectors])
    assert len(control) == made.spaces[0].count
    vectors = control_vectors(body)
    lengths = vectors.lengths[0]
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    values = type_of(body).shape_values
    for number, element in enumerate(vectors.elements):
        nodal = q[(2 * body.elements[element][:, None] + np.arange(2)).ravel()]
        for xi in (1e-9, *rng.random(3), 1.0 - 1e-9):
            u = (starts[number] + xi * lengths[number]) / starts[-1]
            at = values(body, int(element), (xi,), 0) @ nodal
            np.testing.assert_allclose(basis(made.spaces[0], u) @ control, at, atol=1e-12)
        for xi in (
            1e-9,
            1.0 - 1e-9,
        ):  # at nodes arc length is the parameter, and the slope is that of the node
            u = (starts[number] + xi * lengths[number]) / starts[-1]
            slope = values(body, int(element), (round(xi),), 1) @ nodal
            found = basis(made.spaces[0], u, 1) @ control / starts[-1]
            np.testing.assert_allclose(found, slope, atol=1e-6 * np.abs(nodal).max() / lengths.min())
    start = type_of(body).start_coordinates(body).reshape(-1, 3)
    np.testing.assert_array_equal(
        start_control(body, made), np.einsum("nk,nkx->nx", made.factors, start[made.vectors])
    )


@pytest.mark.parametrize(
    "body",
    [
        shell(rectangle(1.0, 0.6, 1, 1)),
        shell(rectangle(1.0, 0.6, 3, 2)),
        uneven_grid(False),
        uneven_grid(True),
    ],
    ids=["one", "rectangle", "uneven", "other way round"],
)
def test_surface_is_the_shell(body: ShellBody) -> None:
    """Deformed at random: positions everywhere."""
    rng = np.random.default_rng(1)
    made, vectors = mesh_contour(body), control_vectors(body)
    q = rng.normal(size=(4 * len(body.nodes), 3))
    control = np.einsum("nk,nkx->nx", made.factors, q[made.vectors])
    ends = [np.concatenate([[0.0], np.cumsum(lengths)]) for lengths in vectors.lengths]
    assert made.spaces[0].count * made.spaces[1].count == len(control)
    for (i, j), element in np.ndenumerate(vectors.elements):
        local = rng.random(2)
        nodal = q[(4 * body.elements[element][:, None] + np.arange(4)).ravel()]
        shape = type_of(body).shape_values(body, int(element), tuple(local), 0)
        weights = [
            basis(space, float(end[k] + x * (end[k + 1] - end[k])) / end[-1])
            for space, end, k, x in zip(made.spaces, ends, (i, j), local, strict=True)
        ]
        np.testing.assert_allclose(np.outer(*weights).ravel() @ control, shape @ nodal, atol=1e-12)


def test_what_makes_no_line_is_refused() -> None:
    """Branches, two lines, elements that run against each other."""
    mesh = line([0, 0, 0], [3, 0, 0], 3)
    for elements, word in (
        ([[0, 1], [1, 2], [1, 3]], "begin at node 1"),
        ([[0, 1], [2, 3]], "1 of 2 elements"),
        ([[0, 1], [2, 1], [2, 3]], "at node"),
    ):
        with pytest.raises(InputError, match=word) as caught:
            mesh_contour(frame(mesh, elements))
        assert caught.value.key == "elements"


def test_what_makes_no_rectangle_is_refused() -> None:
    """A corner that is missing; a hole."""
    for count, missing in ((2, 3), (3, 4)):
        mesh = rectangle(1.0, 1.0, count, count)
        body = shell(mesh)
        kept = np.arange(len(mesh.elements)) != missing
        with pytest.raises(InputError, match=r"elements that make no rectangle|rows and columns begin"):
            mesh_contour(replace(body, elements=body.elements[kept], lengths=body.lengths[kept]))
