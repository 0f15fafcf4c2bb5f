"""Stresses of shells anywhere on their elements, from the vectors of the nodes.

Plain numpy, for pictures and checks: it shares nothing with the compiled elements.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from heavylift.solver.bodies.ancf.frame_stress import cubic_shapes

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from heavylift.solver.scene.meshes import ShellBody

__all__ = ["ShellStresses", "shell_coordinates", "shell_stresses", "von_mises"]

Side = Literal["top", "middle", "bottom", "largest"]


class ShellStresses(NamedTuple):
    """Stresses of a shell at `p` x `q` places of each of `e` elements; leading axes are those of the coordinates.

    Attributes
    ----------
    places
        Positions [m], shape (..., e, p, q, 3), in the axes of the coordinates.
    normals
        Unit vectors along ``r_x x r_y``, the top side, shape (..., e, p, q, 3).
    membrane
        Stress of the middle surface [Pa], shape (..., e, p, q, 3): xx, yy and xy in orthonormal material axes, the
        first along the lines of the mesh direction x.
    bending
        What the top has on top of that, and the bottom less; shape (..., e, p, q, 3).
    """

    places: NDArray[np.float64]
    normals: NDArray[np.float64]
    membrane: NDArray[np.float64]
    bending: NDArray[np.float64]

    def von_mises(self, side: Side = "largest") -> NDArray[np.float64]:
        """Equivalent stress of a side [Pa], shape (..., e, p, q); ``"largest"`` of top, middle and bottom."""
        factors = {"top": (1.0,), "middle": (0.0,), "bottom": (-1.0,), "largest": (1.0, 0.0, -1.0)}[side]
        parts = [von_mises(self.membrane + factor * self.bending) for factor in factors]
        return np.maximum.reduce(parts)


def von_mises(stress: NDArray[np.float64]) -> NDArray[np.float64]:
    """Equivalent stress of plane stress: shape (..., 3) of xx, yy and xy to (...)."""
    xx, yy, xy = stress[..., 0], stress[..., 1], stress[..., 2]
    return np.sqrt(np.maximum(xx**2 - xx * yy + yy**2 + 3.0 * xy**2, 0.0))


def shell_coordinates(body: ShellBody) -> NDArray[np.float64]:
    """Vectors of the nodes of the unloaded shape, shape (n, 4, 3)."""
    return np.concatenate([body.nodes[:, np.newaxis], body.slopes], axis=1)


def shell_stresses(
    body: ShellBody, coordinates: NDArray[np.float64], x: ArrayLike, y: ArrayLike
) -> ShellStresses:
    """Stresses of a shell on the same grid of places of all its elements.

    Parameters
    ----------
    body
        The shell: its unloaded shape and sections count.
    coordinates
        ``r`` [m], ``r_x``, ``r_y`` [1] and ``r_xy`` [1/m] of the nodes in any axes, shape (..., n, 4, 3).
    x, y
        Lines of the grid from 0 to 1 along the two directions of an element, shapes (p,) and (q,).

    Notes
    -----
    Covariant components by the parameters of the element: strain ``(r_a.r_b - X_a.X_b)/2``, curvature
    ``n.r_ab``, both turned into orthonormal axes of the flat unloaded shape. A fibre at the height z has the
    strain of the middle less z times the curvature; plane stress with the modulus E/(1 - nu^2)
    ("Integrated simulation ... (2018)", section 2.3, with the strain of Green-Lagrange). Second covariant
    derivatives differ from ``r_ab`` by vectors along the surface, which the product with n drops.
    """
    shapes = cubic_shapes(x), cubic_shapes(y)
    X_1, X_2 = _derivatives(shapes, _factors(body, shell_coordinates(body)), ((1, 0), (0, 1)))
    r, r_1, r_2, r_11, r_22, r_12 = _derivatives(
        shapes,
        _factors(body, np.asarray(coordinates)),
        ((0, 0), (1, 0), (0, 1), (2, 0), (0, 2), (1, 1)),
    )
    n = np.cross(r_1, r_2)
    n /= np.maximum(np.linalg.norm(n, axis=-1, keepdims=True), np.finfo(np.float64).tiny)
    strain = np.stack(
        [
            0.5 * (_dot(r_1, r_1) - _dot(X_1, X_1)),
            0.5 * (_dot(r_2, r_2) - _dot(X_2, X_2)),
            0.5 * (_dot(r_1, r_2) - _dot(X_1, X_2)),
        ],
        axis=-1,
    )
    curvature = np.stack([_dot(n, r_11), _dot(n, r_22), _dot(n, r_12)], axis=-1)
    turn = _to_orthonormal(X_1, X_2)
    which = body.element_sections if len(body.element_sections) else np.zeros(len(body.elements), np.int64)
    E, nu, t = (
        np.array([getattr(section, key) for section in body.sections])[which][:, np.newaxis, np.newaxis]
        for key in ("youngs_modulus", "poissons_ratio", "thickness")
    )
    return ShellStresses(
        places=r,
        normals=n,
        membrane=_stress(turn(strain), E, nu),
        bending=_stress(turn(-0.5 * t[..., np.newaxis] * curvature), E, nu),
    )


def _dot(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.einsum("...k,...k->...", a, b)


def _factors(body: ShellBody, coordinates: NDArray[np.float64]) -> NDArray[np.float64]:
    """Factors of the products of cubic functions along x and y, shape (..., e, 4, 4, 3)."""
    vectors = coordinates[..., body.elements, :, :]
    a, b = body.lengths[:, 0], body.lengths[:, 1]
    scale = np.stack([np.ones_like(a), a, b, a * b], axis=-1)[:, np.newaxis, :, np.newaxis]
    scaled = vectors * scale
    out = np.empty((*coordinates.shape[:-3], len(body.elements), 4, 4, 3))
    for node, (i, j) in enumerate(((0, 0), (2, 0), (2, 2), (0, 2))):
        for vector, (k, m) in enumerate(((0, 0), (1, 0), (0, 1), (1, 1))):
            out[..., i + k, j + m, :] = scaled[..., node, vector, :]
    return out


def _derivatives(
    shapes: tuple[NDArray[np.float64], NDArray[np.float64]],
    factors: NDArray[np.float64],
    orders: tuple[tuple[int, int], ...],
) -> list[NDArray[np.float64]]:
    """Derivatives of given orders along the two directions of the elements, each of shape (..., e, p, q, 3)."""
    along_x, along_y = shapes
    *lead, _, _, _ = factors.shape
    flat = factors.reshape(*lead, 4, 12)
    lines = {i: (along_x[i] @ flat).reshape(*lead, -1, 4, 3) for i in {order[0] for order in orders}}
    return [along_y[j] @ lines[i] for i, j in orders]


def _to_orthonormal(
    X_1: NDArray[np.float64], X_2: NDArray[np.float64]
) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """Function that turns covariant components 11, 22, 12 into those in orthonormal axes, the first along ``X_1``.

    With ``X_1 = p t_1`` and ``X_2 = q t_1 + s t_2``, the matrix of the components is multiplied by the inverse of
    ``[[p, 0], [q, s]]`` from both sides.
    """
    p = np.sqrt(_dot(X_1, X_1))
    q = _dot(X_1, X_2) / p
    s = np.sqrt(np.maximum(_dot(X_2, X_2) - q**2, np.finfo(np.float64).tiny))

    def turn(covariant: NDArray[np.float64]) -> NDArray[np.float64]:
        c_11, c_22, c_12 = covariant[..., 0], covariant[..., 1], covariant[..., 2]
        xx = c_11 / p**2
        xy = (c_12 - q / p * c_11) / (p * s)
        yy = (c_22 - 2.0 * q / p * c_12 + (q / p) ** 2 * c_11) / s**2
        return np.stack([xx, yy, xy], axis=-1)

    return turn


def _stress(
    strain: NDArray[np.float64], E: NDArray[np.float64], nu: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Plane stress xx, yy, xy [Pa] of tensor strains, shape (..., 3)."""
    plane = E / (1.0 - nu**2)
    xx, yy, xy = strain[..., 0], strain[..., 1], strain[..., 2]
    return np.stack([plane * (xx + nu * yy), plane * (yy + nu * xx), plane * (1.0 - nu) * xy], axis=-1)
