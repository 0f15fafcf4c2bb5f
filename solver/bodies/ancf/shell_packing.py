"""Shells become numbers for the compiled elements: their unloaded shape, what is refused of them, material points."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.bodies.ancf.shell_data import (
    FUNCTIONS,
    LINE,
    POINTS,
    STRAINS_PER_LINE,
    STRESS_PLACES,
    ShellData,
    ShellLine,
    gauss_rule,
    hermite,
    tables,
)
from heavylift.solver.bodies.ancf.types import check_load, check_numbers, check_supports
from heavylift.solver.scene.meshes import SHELL_VECTORS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.scene.meshes import ShellBody, ShellSection

__all__ = [
    "FlatShape",
    "body_constants",
    "check_shell",
    "elastic_constants",
    "element_blocks",
    "element_data",
    "flat_shape",
    "grid",
    "load_integrals",
    "load_shape",
    "locate",
    "result_columns",
    "section_numbers",
    "shape_values",
    "shapes",
    "start_coordinates",
    "strain_counts",
    "vector_scales",
]


# ---- the unloaded shape, and the constant matrices that follow from it ----


MATRIX_POINTS = 8
"""Along each direction, for mass and bending: exact for all masses and for bending of parallelograms."""

ELASTIC = ("stretching", "poissons_ratio", "plate_stiffness", "thickness")
"""Fields of `ShellData` in the order of `elastic_constants`."""

EQUAL = 12
"""Decimals of the shape, in lengths of the element, by which elements count as equal."""


class FlatShape(NamedTuple):
    """Elements in their own planes.

    Attributes
    ----------
    origins
        Their first nodes [m], shape (e, 3).
    axes
        Orthonormal, the first along ``X_xi`` of the centre, the third along ``X_xi x X_eta``; shape (e, 3, 3),
        one a row.
    vectors
        Nodal vectors times the lengths they refer to, in plane axes [m], shape (e, 16, 2).
    off_plane
        Largest component of these vectors along the third axis [m], shape (e,).
    """

    origins: NDArray[np.float64]
    axes: NDArray[np.float64]
    vectors: NDArray[np.float64]
    off_plane: NDArray[np.float64]


def grid(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """All pairs of points along xi (slow) and eta (fast)."""
    xi, eta = np.meshgrid(points, points, indexing="ij")
    return xi.ravel(), eta.ravel()


def shapes(
    xi: NDArray[np.float64], eta: NDArray[np.float64], along_xi: int, along_eta: int
) -> NDArray[np.float64]:
    """Derivatives of the 16 shape functions of a unit square at points, shape (p, 16)."""
    left, right = hermite(np.atleast_1d(xi))[along_xi], hermite(np.atleast_1d(eta))[along_eta]
    i, j = np.array(FUNCTIONS).T
    return left[:, i] * right[:, j]


def vector_scales(lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """What turns nodal vectors into those of a unit square: 1, a, b, a b of each node; shape (e, 16)."""
    a, b = lengths[:, 0], lengths[:, 1]
    return np.tile(np.stack([np.ones_like(a), a, b, a * b], axis=1), 4)


def section_numbers(body: ShellBody) -> NDArray[np.int64]:
    """Section of each element."""
    if len(body.element_sections):
        return np.asarray(body.element_sections, dtype=np.int64)
    return np.zeros(len(body.elements), dtype=np.int64)


def flat_shape(body: ShellBody) -> FlatShape:
    """Look at each element in the plane of its centre."""
    nodal = np.concatenate([body.nodes[:, np.newaxis], body.slopes], axis=1)
    vectors = nodal[body.elements].reshape(len(body.elements), 16, 3)
    origins = vectors[:, 0].copy()
    vectors[:, ::4] -= origins[:, np.newaxis]
    vectors = vectors * vector_scales(body.lengths)[:, :, np.newaxis]
    middle = np.array([0.5])
    X_1 = np.einsum("n,enk->ek", shapes(middle, middle, 1, 0)[0], vectors)
    X_2 = np.einsum("n,enk->ek", shapes(middle, middle, 0, 1)[0], vectors)
    third = _unit(np.cross(X_1, X_2))
    first = _unit(X_1)
    axes = np.stack([first, np.cross(third, first), third], axis=1)
    local = np.einsum("enk,eak->ena", vectors, axes)
    return FlatShape(origins, axes, np.ascontiguousarray(local[:, :, :2]), np.abs(local[:, :, 2]).max(axis=1))


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.maximum(lengths, np.finfo(np.float64).tiny)


def elastic_constants(section: ShellSection) -> tuple[float, float, float, float]:
    """``E t/(1 - nu^2)`` [N/m], nu, ``E t^3/(12 (1 - nu^2))`` [N m], t [m]: plane stress."""
    t, nu = section.thickness, section.poissons_ratio
    plane = section.youngs_modulus / (1.0 - nu**2)
    return plane * t, nu, plane * t**3 / 12.0, t


class _Points(NamedTuple):
    """Points of elements: inverse ``d(xi, eta)/dx`` (e, p, a, x), areas (e, p), derivatives in orthonormal axes."""

    inverse: NDArray[np.float64]
    areas: NDArray[np.float64]
    first: NDArray[np.float64]  # (e, p, 2, 16): d/dx, d/dy
    second: NDArray[np.float64]  # (e, p, 3, 16): xx, yy, xy


def _points(vectors: NDArray[np.float64], xi: NDArray[np.float64], eta: NDArray[np.float64]) -> _Points:
    """First and second derivatives of the shape functions by orthonormal coordinates of the plane.

    The second covariant derivative is ``S_ab - Gamma^c_ab S_c``, ``Gamma^c_ab`` of the unloaded shape; where that is
    a rectangle it is the plain second derivative.
    """
    first = np.stack([shapes(xi, eta, 1, 0), shapes(xi, eta, 0, 1)])  # (a, p, 16)
    second = np.stack([shapes(xi, eta, *order) for order in ((2, 0), (0, 2), (1, 1))])  # (ab, p, 16)
    J = np.einsum("apn,enx->epxa", first, vectors)
    inverse = np.linalg.inv(J)
    bent = np.einsum("cpn,enx->epcx", second, vectors)
    christoffel = np.einsum("epax,epcx->epca", inverse, bent)
    covariant = np.moveaxis(second, 0, 1) - np.einsum("epca,apn->epcn", christoffel, first)
    turn = np.empty((*J.shape[:2], 3, 3))
    for row, (x, y) in enumerate(((0, 0), (1, 1), (0, 1))):
        for column, (a, b) in enumerate(((0, 0), (1, 1))):
            turn[..., row, column] = inverse[..., a, x] * inverse[..., b, y]
        turn[..., row, 2] = inverse[..., 0, x] * inverse[..., 1, y] + inverse[..., 1, x] * inverse[..., 0, y]
    return _Points(
        inverse,
        np.linalg.det(J),
        np.einsum("epax,apn->epxn", inverse, first),
        np.einsum("eprc,epcn->eprn", turn, covariant),
    )


@lru_cache(maxsize=16)
def element_blocks(body: ShellBody) -> list[NDArray[np.float64]]:
    """Data of each element, `heavylift.solver.bodies.ancf.shell_data`; equal elements share one array."""
    shape = flat_shape(body)
    sections = section_numbers(body)
    size = body.lengths.max(axis=1)
    key = np.concatenate(
        [
            np.round(shape.vectors.reshape(len(sections), -1) / size[:, np.newaxis], EQUAL) + 0.0,
            _rounded(body.lengths),
            sections[:, np.newaxis],
        ],
        axis=1,
    )
    _, chosen, which = np.unique(key, axis=0, return_index=True, return_inverse=True)
    blocks = _blocks(
        shape.vectors[chosen],
        body.lengths[chosen],
        [body.sections[s] for s in sections[chosen]],
        body.gauss_points,
    )
    return [blocks[i] for i in which.ravel()]


def _rounded(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """To a number of digits."""
    scale = 10.0 ** (EQUAL - np.floor(np.log10(values)))
    return np.round(values * scale) / scale


def _blocks(
    vectors: NDArray[np.float64],
    lengths: NDArray[np.float64],
    sections: list[ShellSection],
    gauss_points: int,
) -> list[NDArray[np.float64]]:
    count = len(sections)
    scales = vector_scales(lengths)
    elastic = np.array([elastic_constants(section) for section in sections])
    nu = elastic[:, 1]
    out = np.zeros((count, POINTS + LINE * gauss_points))
    numbers, lines = out[:, :POINTS].view(ShellData.layout)[:, 0], out[:, POINTS:].view(ShellLine.layout)

    points, weights = gauss_rule(MATRIX_POINTS)
    xi, eta = grid(points)
    at = _points(vectors, xi, eta)
    area = np.outer(weights, weights).ravel() * at.areas
    S = shapes(xi, eta, 0, 0)
    density = np.array([section.density * section.thickness for section in sections])
    mass = np.einsum("ep,pm,pn->emn", area, S, S, optimize=True) * density[:, np.newaxis, np.newaxis]
    xx, yy, xy = (at.second[:, :, c] for c in range(3))
    curved = np.stack([xx, yy, xy], axis=2)
    stress = np.stack(
        [
            xx + nu[:, np.newaxis, np.newaxis] * yy,
            yy + nu[:, np.newaxis, np.newaxis] * xx,
            2.0 * (1.0 - nu[:, np.newaxis, np.newaxis]) * xy,
        ],
        axis=2,
    )
    bending = np.einsum("ep,epcm,epcn->emn", area * elastic[:, 2:3], curved, stress, optimize=True)
    square = scales[:, :, np.newaxis] * scales[:, np.newaxis, :]
    for name, matrix in (("mass", mass), ("bending", bending)):
        numbers[name] = 0.5 * (matrix + np.swapaxes(matrix, 1, 2)) * square

    numbers["lengths"] = lengths
    for name, values in zip(ELASTIC, elastic.T, strict=True):
        numbers[name] = values
    middle = _points(vectors, np.array([0.5]), np.array([0.5]))
    rows = np.concatenate([middle.first, middle.second], axis=2)[:, 0]
    numbers["centre"] = rows * scales[:, np.newaxis, :]
    numbers["axes"] = _axes(vectors).reshape(count, STRESS_PLACES, STRESS_PLACES, 3)

    points, weights = gauss_rule(gauss_points)
    metric, moduli = _membrane(vectors, points, weights, elastic)
    for name, of_points in (("metric", metric), ("moduli", moduli)):
        by_line = of_points.reshape(count, gauss_points, gauss_points, -1)
        lines[name][..., :gauss_points] = np.swapaxes(by_line, 2, 3)
    out.flags.writeable = False
    return list(out)


def _axes(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """``|X_1|`` and ``X_2`` along and across ``X_1`` at the places of stress, shape (e, p, 3)."""
    xi, eta = grid(np.linspace(0.0, 1.0, STRESS_PLACES))
    X_1 = np.einsum("pn,enx->epx", shapes(xi, eta, 1, 0), vectors)
    X_2 = np.einsum("pn,enx->epx", shapes(xi, eta, 0, 1), vectors)
    length = np.linalg.norm(X_1, axis=-1)
    along = np.einsum("epx,epx->ep", X_1, X_2) / length
    across = (X_1[..., 0] * X_2[..., 1] - X_1[..., 1] * X_2[..., 0]) / length
    return np.stack([length, along, across], axis=-1)


def _membrane(
    vectors: NDArray[np.float64],
    points: NDArray[np.float64],
    weights: NDArray[np.float64],
    elastic: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Metric and moduli of all Gauss points, shapes (e, p, 3) and (e, p, 6)."""
    xi, eta = grid(points)
    X_1 = np.einsum("pn,enx->epx", shapes(xi, eta, 1, 0), vectors)
    X_2 = np.einsum("pn,enx->epx", shapes(xi, eta, 0, 1), vectors)
    metric = np.stack(
        [
            0.5 * np.einsum("epx,epx->ep", X_1, X_1),
            0.5 * np.einsum("epx,epx->ep", X_2, X_2),
            np.einsum("epx,epx->ep", X_1, X_2),
        ],
        axis=-1,
    )
    at = _points(vectors, xi, eta)
    G, nu = at.inverse, elastic[:, 1]
    T = np.empty((*at.areas.shape, 3, 3))  # E_xx, E_yy, 2 E_xy by E_11, E_22, 2 E_12
    for row, (x, y, factor) in enumerate(((0, 0, 1.0), (1, 1, 1.0), (0, 1, 2.0))):
        for a in range(2):
            T[..., row, a] = factor * G[..., a, x] * G[..., a, y]
        mixed = G[..., 0, x] * G[..., 1, y] + G[..., 1, x] * G[..., 0, y]
        T[..., row, 2] = 0.5 * factor * mixed
    C = np.zeros((len(elastic), 3, 3))
    C[:, 0, 0] = C[:, 1, 1] = 1.0
    C[:, 0, 1] = C[:, 1, 0] = nu
    C[:, 2, 2] = 0.5 * (1.0 - nu)
    area = np.outer(weights, weights).ravel() * at.areas * elastic[:, 0:1]
    D = np.einsum("ep,eprm,ers,epsn->epmn", area, T, C, T, optimize=True)
    return metric, np.stack(
        [D[..., r, c] for r, c in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))], axis=-1
    )


@lru_cache(maxsize=16)
def load_integrals(body: ShellBody) -> NDArray[np.float64]:
    """``int S dA`` of each element [m2 and times the lengths of slopes], shape (e, 16)."""
    points, weights = gauss_rule(MATRIX_POINTS)
    xi, eta = grid(points)
    vectors = flat_shape(body).vectors
    X_1 = np.einsum("pn,enx->epx", shapes(xi, eta, 1, 0), vectors)
    X_2 = np.einsum("pn,enx->epx", shapes(xi, eta, 0, 1), vectors)
    area = X_1[..., 0] * X_2[..., 1] - X_1[..., 1] * X_2[..., 0]
    weighted = np.outer(weights, weights).ravel() * area
    return weighted @ shapes(xi, eta, 0, 0) * vector_scales(body.lengths)


# ---- what is refused ----


FLAT = 1e-6
"""Largest distance of an unloaded element from its plane, by its length."""

SQUASHED = 1e-6
"""Smallest area of the map of an element at a point, by its lengths."""

SAME = 1e-9
"""Relative difference of lengths that count as equal."""

GAUSS_POINTS = (3, 7)


def check_shell(body: ShellBody) -> None:
    """Refuse a shell that cannot be packed.

    Raises
    ------
    InputError
        Names the body, the key with the number of the element, node or section, the value and what was expected.
    """
    _check_arrays(body)
    _check_sections(body)
    check_supports(body, SHELL_VECTORS)
    for number, load in enumerate(body.loads):
        check_load(body, number, load)
    _check_edges(body)
    _check_shape(body)


def _fail(body: ShellBody, key: str, problem: str, expected: str) -> None:
    raise InputError(problem, source=body.name, key=key, expected=expected)


def _check_arrays(body: ShellBody) -> None:
    n, e = len(body.nodes), len(body.elements)
    if n == 0 or e == 0:
        _fail(body, "elements", f"{n} nodes and {e} elements", "one element or more")
    wanted: list[tuple[str, Any, tuple[int, ...]]] = [
        ("nodes", body.nodes, (n, 3)),
        ("slopes", body.slopes, (n, 3, 3)),
        ("elements", body.elements, (e, 4)),
        ("lengths", body.lengths, (e, 2)),
    ]
    for key, values, shape in wanted:
        array = np.asarray(values)
        if array.shape != shape:
            _fail(body, key, f"shape {array.shape}", f"{shape}")
        bad = np.argwhere(~np.isfinite(array))
        if len(bad):
            _fail(body, f"{key}[{bad[0][0]}]", f"{array[tuple(bad[0])]}", "finite numbers")
    if np.asarray(body.elements).dtype.kind not in "iu":
        _fail(body, "elements", f"numbers of type {np.asarray(body.elements).dtype}", "whole numbers")
    for number, nodes in enumerate(body.elements):
        if not (np.all(nodes >= 0) and np.all(nodes < n)):
            _fail(body, f"elements[{number}]", f"nodes {nodes.tolist()}", f"numbers from 0 to {n - 1}")
        if len(set(nodes.tolist())) < 4:
            _fail(body, f"elements[{number}]", f"nodes {nodes.tolist()}", "four different nodes")
    loose = np.setdiff1d(np.arange(n), body.elements)
    if len(loose):
        _fail(body, f"nodes[{loose[0]}]", "it belongs to no element", "nodes of elements only")
    short = np.flatnonzero(~np.all(body.lengths > 0.0, axis=1))
    if len(short):
        _fail(body, f"lengths[{short[0]}]", f"{body.lengths[short[0]].tolist()}", "positive lengths")
    low, high = GAUSS_POINTS
    if not isinstance(body.gauss_points, int) or body.gauss_points not in range(low, high + 1):
        _fail(body, "gauss_points", f"{body.gauss_points}", f"a whole number from {low} to {high}")


def _check_sections(body: ShellBody) -> None:
    if not body.sections:
        _fail(body, "sections", "there are none", "one section or more")
    for number, section in enumerate(body.sections):
        key = f"sections[{number}]"
        for name in ("thickness", "density", "youngs_modulus"):
            value = getattr(section, name)
            if not 0.0 < value < np.inf:
                _fail(body, f"{key}.{name}", f"{value}", "a positive number")
        if not -1.0 < section.poissons_ratio < 0.5:
            _fail(
                body, f"{key}.poissons_ratio", f"{section.poissons_ratio}", "more than -1 and less than 0.5"
            )
    given = len(body.element_sections)
    if given not in (0, len(body.elements)):
        _fail(
            body,
            "element_sections",
            f"{given} numbers",
            f"one for each of {len(body.elements)} elements, or none",
        )
    if given:
        check_numbers(
            body, "element_sections", np.asarray(body.element_sections), len(body.sections), "section"
        )
    numbers = section_numbers(body)
    bad = np.flatnonzero((numbers < 0) | (numbers >= len(body.sections)))
    if len(bad):
        last = len(body.sections) - 1
        _fail(body, f"element_sections[{bad[0]}]", f"{numbers[bad[0]]}", f"a number from 0 to {last}")


def _check_edges(body: ShellBody) -> None:
    """Slopes of a node serve all its elements, so edges in common have one direction and length."""
    known: dict[tuple[int, int], tuple[int, int, float]] = {}
    for number, ((n0, n1, n2, n3), (a, b)) in enumerate(
        zip(body.elements.tolist(), body.lengths.tolist(), strict=True)
    ):
        for start, end, direction, length in ((n0, n1, 0, a), (n3, n2, 0, a), (n0, n3, 1, b), (n1, n2, 1, b)):
            other, along, before = known.setdefault((start, end), (number, direction, length))
            if (end, start) in known:
                other, along, _ = known[end, start]
                along = 1 - direction  # runs the other way: as wrong as another direction
            if along != direction:
                _fail(
                    body,
                    f"elements[{number}]",
                    f"its edge of nodes {start} and {end} runs otherwise in element {other}",
                    "the same direction and sense of the mesh on both sides",
                )
            if abs(length - before) > SAME * before:
                _fail(
                    body,
                    f"lengths[{number}]",
                    f"{length} m on the edge of nodes {start} and {end}, {before} m in element {other}",
                    "the same length on both sides: the slopes of the nodes refer to it",
                )


def _check_shape(body: ShellBody) -> None:
    shape = flat_shape(body)
    size = body.lengths.max(axis=1)
    smallest = _smallest_areas(shape, body.gauss_points) / body.lengths.prod(axis=1)
    inverted = np.flatnonzero(~(smallest > SQUASHED))
    if len(inverted):
        first = inverted[0]
        _fail(
            body,
            f"elements[{first}]",
            f"it is inverted or has no area somewhere: {smallest[first]:.3g} of its lengths",
            "nodes in the order origin, along x, opposite, along y, corners below 180 degrees, slopes that fit",
        )
    bent = np.flatnonzero(~(shape.off_plane <= FLAT * size))
    if len(bent):
        first = bent[0]
        _fail(
            body,
            f"elements[{first}]",
            f"it is not flat: {shape.off_plane[first]:.3g} m off its plane",
            "nodes and slopes of an unloaded element in one plane",
        )


def _smallest_areas(shape: FlatShape, gauss_points: int) -> NDArray[np.float64]:
    """Smallest area of the map from the unit square, at Gauss points and corners, shape (e,)."""
    points = np.concatenate([gauss_rule(gauss_points)[0], gauss_rule(8)[0], [0.0, 1.0]])
    xi, eta = grid(points)
    X_1 = np.einsum("pn,enx->epx", shapes(xi, eta, 1, 0), shape.vectors)
    X_2 = np.einsum("pn,enx->epx", shapes(xi, eta, 0, 1), shape.vectors)
    return (X_1[..., 0] * X_2[..., 1] - X_1[..., 1] * X_2[..., 0]).min(axis=1)


# ---- what packing asks of shells ----


FOUND = 1e-6
"""Largest distance of a material point from the mesh, by the size of the mesh."""

NEWTON_STEPS = 40


def element_data(body: ShellBody) -> list[NDArray[np.float64]]:
    """Mass matrix, bending matrix and numbers of each element; equal elements share one array."""
    return element_blocks(body)


def body_constants(body: ShellBody) -> NDArray[np.float64]:
    """Functions at the Gauss points."""
    return tables(body.gauss_points)


def strain_counts(body: ShellBody) -> NDArray[np.int64]:
    """Places of strains of each element: eight lanes of three strains for each line of Gauss points."""
    return np.full(len(body.elements), STRAINS_PER_LINE * body.gauss_points, dtype=np.int64)


def start_coordinates(body: ShellBody) -> NDArray[np.float64]:
    """``r``, ``r_x``, ``r_y`` and ``r_xy`` of the nodes of the unloaded shape, shape (n, 4, 3)."""
    return np.concatenate([body.nodes[:, np.newaxis], body.slopes], axis=1)


def shape_values(body: ShellBody, element: int, local: tuple[float, ...], vector: int) -> NDArray[np.float64]:
    """Share of each nodal vector of an element in a vector at a point of it, shape (16,).

    Parameters
    ----------
    body, element
        The shell, number of its element.
    local
        Place along its two directions, from 0 to 1.
    vector
        0: position, 1: ``r_x``, 2: ``r_y``, 3: ``r_xy``.
    """
    along_x, along_y = ((0, 0), (1, 0), (0, 1), (1, 1))[vector]
    a, b = body.lengths[element]
    values = _unit_shapes(local[0], local[1], along_x, along_y)
    return values * vector_scales(body.lengths[element : element + 1])[0] / (a**along_x * b**along_y)


@lru_cache(maxsize=4096)
def _unit_shapes(xi: float, eta: float, along_xi: int, along_eta: int) -> NDArray[np.float64]:
    """`shapes` at one point; surfaces ask for the same ones in each element."""
    values = shapes(np.array([xi]), np.array([eta]), along_xi, along_eta)[0]
    values.flags.writeable = False
    return values


def load_shape(body: ShellBody, element: int) -> NDArray[np.float64]:
    """``int S dA`` over the unloaded area of an element, shape (16,)."""
    return load_integrals(body)[element]


def locate(
    body: ShellBody, point: NDArray[np.float64], source: str, key: str
) -> tuple[int, tuple[float, float]]:
    """The element at a point of the unloaded shape, and the place on it.

    Parameters
    ----------
    body
        The shell.
    point
        In its frame [m], shape (3,).
    source, key
        What to call the point in an error.

    Raises
    ------
    InputError
        If the point is farther from the shell than a millionth of its size.
    """
    point = np.asarray(point, dtype=np.float64)
    shape = flat_shape(body)
    relative = np.einsum("ek,eak->ea", point - shape.origins, shape.axes)
    middle = np.array([0.5])
    centres = np.einsum("n,enx->ex", shapes(middle, middle, 0, 0)[0], shape.vectors)
    offsets = np.hypot(np.linalg.norm(relative[:, :2] - centres, axis=1), relative[:, 2])
    size = float(np.linalg.norm(np.ptp(body.nodes, axis=0)))
    reach = body.lengths.max() + np.linalg.norm(np.ptp(shape.vectors[:, ::4], axis=1), axis=1).max()
    best = (np.inf, 0, (0.0, 0.0))
    for element in np.argsort(offsets, kind="stable"):
        if not offsets[element] <= offsets.min() + reach:
            break
        local = _inverse(shape, int(element), relative[element, :2])
        at = shapes(local[:1], local[1:], 0, 0)[0] @ shape.vectors[element]
        distance = float(np.hypot(np.linalg.norm(relative[element, :2] - at), relative[element, 2]))
        if distance < best[0]:
            best = (distance, int(element), (float(local[0]), float(local[1])))
        if distance <= 1e-3 * FOUND * size:
            break
    if not best[0] <= FOUND * size:
        raise InputError(
            f"the point {np.round(point, 9).tolist()} is {best[0]:.6g} m away from the shell {body.name!r}",
            source=source,
            key=key,
            expected=f"a point of its middle surface, to {FOUND * size:.3g} m",
        )
    return best[1], best[2]


def _inverse(shape: FlatShape, element: int, point: NDArray[np.float64]) -> NDArray[np.float64]:
    """Place of a point of the plane on an element, by Newton's method from its centre; the nearest if outside."""
    vectors = shape.vectors[element]
    local = np.array([0.5, 0.5])
    for _ in range(NEWTON_STEPS):
        x, y = local[:1], local[1:]
        rest = point - shapes(x, y, 0, 0)[0] @ vectors
        J = np.stack([shapes(x, y, 1, 0)[0] @ vectors, shapes(x, y, 0, 1)[0] @ vectors], axis=1)
        step = np.linalg.lstsq(J, rest, rcond=None)[0]
        before, local = local, np.clip(local + step, -0.25, 1.25)
        if np.all(np.abs(local - before) <= 1e-14):
            break
    return np.clip(local, 0.0, 1.0)


def result_columns(body: ShellBody) -> dict[str, tuple[str, ...]]:
    """Components of what is recorded of all elements: forces and moments at their centres, the largest stress.

    Axes are those of the surface, the first along the lines of the mesh direction x; moments are those of
    curvatures along ``n = r_x x r_y``, whose side is the top.
    """
    elements = range(len(body.elements))
    parts = tuple(f"{e}.{axes}" for e in elements for axes in ("xx", "yy", "xy"))
    sides = tuple(f"{e}.{side}" for e in elements for side in ("top", "middle", "bottom"))
    return {"membrane_force": parts, "bending_moment": parts, "von_mises": sides}
