"""The unloaded shape of shell elements, and the constant matrices that follow from it."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.solver.bodies.ancf.shell_data import (
    FUNCTIONS,
    LINE,
    POINTS,
    ShellData,
    ShellLine,
    gauss_rule,
    hermite,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.scene.meshes import ShellBody, ShellSection

__all__ = [
    "FlatShape",
    "elastic_constants",
    "element_blocks",
    "flat_shape",
    "grid",
    "load_integrals",
    "section_numbers",
    "shapes",
    "vector_scales",
]

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

    points, weights = gauss_rule(gauss_points)
    metric, moduli = _membrane(vectors, points, weights, elastic)
    for name, of_points in (("metric", metric), ("moduli", moduli)):
        by_line = of_points.reshape(count, gauss_points, gauss_points, -1)
        lines[name][..., :gauss_points] = np.swapaxes(by_line, 2, 3)
    out.flags.writeable = False
    return list(out)


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
