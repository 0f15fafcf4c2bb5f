"""Section forces of frames, stresses of frames and shells, anywhere on their elements, from the vectors of the nodes.

Plain numpy, for pictures and checks: it shares nothing with the compiled elements but the places at which these look
for the largest stress, so that pictures and records agree on it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.solver.bodies.ancf import frame_data, shell_data

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from heavylift.solver.scene.meshes import FrameBody, ShellBody, ShellSide

__all__ = [
    "FrameStresses",
    "ShellStresses",
    "cubic_shapes",
    "frame_lengths",
    "frame_stresses",
    "largest_frame_stress",
    "largest_shell_stress",
    "shell_coordinates",
    "shell_stresses",
    "von_mises",
]


# ---- frames ----


class FrameStresses(NamedTuple):
    """What frames carry at `p` places of each of `e` elements; leading axes are those of the coordinates.

    Attributes
    ----------
    places
        Positions [m], shape (..., e, p, 3), in the axes of the coordinates; so are all vectors.
    tangents
        Unit vectors, shape (..., e, p, 3).
    axial_force
        ``EA e``; with the strain of Green-Lagrange ``EA e |r'|``, conjugate to the length [N], shape (..., e, p).
    bending
        Change of the curvature vector [1/m], which points to the centre of curvature, shape (..., e, p, 3).
    axial_stress
        Axial force by the unloaded area [Pa], shape (..., e, p).
    fibre_stress
        Amplitude of the stress of bending at the outermost fibre, ``E |K| c`` [Pa], shape (..., e, p).
    """

    places: NDArray[np.float64]
    tangents: NDArray[np.float64]
    axial_force: NDArray[np.float64]
    bending: NDArray[np.float64]
    axial_stress: NDArray[np.float64]
    fibre_stress: NDArray[np.float64]

    @property
    def largest(self) -> NDArray[np.float64]:
        """Stress of the fibre that bears most, with its sign: ``N/A +- M c/I`` [Pa], shape (..., e, p)."""
        return self.axial_stress + np.where(self.axial_stress < 0.0, -1.0, 1.0) * self.fibre_stress


def cubic_shapes(places: ArrayLike) -> NDArray[np.float64]:
    """Cubic Hermite functions on the unit interval and their first two derivatives.

    Parameters
    ----------
    places
        From 0 to 1, shape (p,).

    Returns
    -------
    NDArray
        Shape (3, p, 4): derivative; place; value and slope at 0, value and slope at 1. Slopes are derivatives on
        the unit interval.
    """
    x = np.asarray(places, dtype=np.float64)
    one = np.ones_like(x)
    values = (1 - 3 * x**2 + 2 * x**3, x - 2 * x**2 + x**3, 3 * x**2 - 2 * x**3, x**3 - x**2)
    first = (6 * x**2 - 6 * x, 1 - 4 * x + 3 * x**2, 6 * x - 6 * x**2, 3 * x**2 - 2 * x)
    second = (12 * x - 6, 6 * x - 4 * one, 6 - 12 * x, 6 * x - 2 * one)
    return np.stack([np.stack(row, axis=-1) for row in (values, first, second)])


def frame_lengths(
    nodes: NDArray[np.float64], tangents: NDArray[np.float64], elements: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Arc length of each unloaded element [m], shape (e,): that by which its slopes are scaled.

    The shape depends on the length, so it is found by repetition; a straight element takes its chord at once.
    """
    places, weights = np.polynomial.legendre.leggauss(7)
    slope = cubic_shapes(0.5 + 0.5 * places)[1]
    ends, turned = nodes[elements], tangents[elements]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    for _ in range(60):
        vectors = _scaled(np.stack([ends, turned], axis=2), lengths)
        speed = np.linalg.norm(np.einsum("pk,ekj->epj", slope, vectors), axis=-1)
        before, lengths = lengths, 0.5 * speed @ weights
        if np.all(np.abs(lengths - before) <= 1e-15 * lengths):
            break
    return lengths


def frame_stresses(
    body: FrameBody,
    coordinates: NDArray[np.float64],
    places: ArrayLike,
    *,
    lengths: NDArray[np.float64] | None = None,
) -> FrameStresses:
    """Stresses of a frame at the same places of all its elements.

    Parameters
    ----------
    body
        The frame: its unloaded shape, model and sections count.
    coordinates
        ``r`` [m] and ``r'`` [1] of the nodes in any axes, shape (..., n, 2, 3).
    places
        From 0 to 1 along an element, shape (p,).
    lengths
        Of the unloaded elements [m], shape (e,); `frame_lengths` if None.

    Notes
    -----
    Strain ``e`` of the axis as the model of the frame has it: ``(|r'|^2 - 1)/2`` or ``|r'| - 1``, and the strain in
    the given shape on top; curvature ``K = r' x r'' / |r'|^2``, material ("Integrated simulation ...
    (2018)", section 2.2), both by the arc length of the unloaded shape. The unloaded curvature is taken off in its
    amount, because the model knows of no twist.
    """
    l = frame_lengths(body.nodes, body.tangents, body.elements) if lengths is None else lengths
    shapes = cubic_shapes(places)
    rest = np.stack([body.nodes, body.tangents], axis=1)
    _, X_s, X_ss = _frame_derivatives(shapes, rest[body.elements], l)
    r, r_s, r_ss = _frame_derivatives(shapes, np.asarray(coordinates)[..., body.elements, :, :], l)
    speed = np.linalg.norm(X_s, axis=-1)  # of the arc length, nearly 1
    stretch = np.linalg.norm(r_s, axis=-1) / speed
    exact = body.model == "exact"
    strain = stretch - 1.0 if exact else 0.5 * (stretch**2 - 1.0)
    if len(body.axial_strains):
        strain = strain + body.axial_strains[:, np.newaxis]
    if not exact:
        strain = strain * stretch
    tangents = r_s / np.maximum(stretch * speed, _TINY)[..., np.newaxis]
    curvature = _material_curvature(r_s, r_ss) / speed[..., np.newaxis]
    amount = np.linalg.norm(curvature, axis=-1)
    amount_0 = np.linalg.norm(_material_curvature(X_s, X_ss), axis=-1) / speed
    change = np.where(amount > 0.0, 1.0 - amount_0 / np.maximum(amount, _TINY), 0.0)
    which = body.element_sections if len(body.element_sections) else np.zeros(len(body.elements), np.int64)
    E, A, c = (
        np.array([getattr(section, key) for section in body.sections])[which][:, np.newaxis]
        for key in ("youngs_modulus", "area", "outer_fibre")
    )
    bending = change[..., np.newaxis] * curvature
    return FrameStresses(
        places=r,
        tangents=tangents,
        axial_force=E * A * strain,
        bending=bending,
        axial_stress=E * strain,
        fibre_stress=E * c * np.abs(amount - amount_0),
    )


def largest_frame_stress(
    body: FrameBody, coordinates: NDArray[np.float64], *, lengths: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """Stress of largest amount of each element of a frame, with its sign [Pa], shape (..., e): as it is recorded.

    Parameters
    ----------
    body, coordinates, lengths
        As in `frame_stresses`.
    """
    places = np.linspace(0.0, 1.0, frame_data.STRESS_PLACES)
    largest = frame_stresses(body, coordinates, places, lengths=lengths).largest
    at = np.argmax(np.abs(largest), axis=-1)[..., np.newaxis]
    return np.take_along_axis(largest, at, axis=-1)[..., 0]


_TINY = np.finfo(np.float64).tiny


def _scaled(vectors: NDArray[np.float64], lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Factors of the shape functions, (..., e, 4, 3), from vectors of the nodes of elements, (..., e, 2, 2, 3)."""
    scale = np.ones((len(lengths), 1, 2, 1))
    scale[:, 0, 1, 0] = lengths
    return (vectors * scale).reshape(*vectors.shape[:-3], 4, 3)


def _frame_derivatives(
    shapes: NDArray[np.float64], vectors: NDArray[np.float64], lengths: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Position, and its derivatives by the unloaded arc length."""
    factors = _scaled(vectors, lengths)
    by = lengths[:, np.newaxis, np.newaxis]
    # sums over four functions: a matrix product is much faster than einsum here
    return shapes[0] @ factors, shapes[1] @ factors / by, shapes[2] @ factors / by**2


def _material_curvature(r_s: NDArray[np.float64], r_ss: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vector to the centre of curvature of the length ``|r' x r''| / |r'|^2``."""
    square = np.maximum(np.sum(r_s * r_s, axis=-1, keepdims=True), _TINY)
    along = np.sum(r_s * r_ss, axis=-1, keepdims=True) / square
    # the part of r'' across the tangent has the length |r' x r''| / |r'|
    return (r_ss - along * r_s) / np.sqrt(square)


# ---- shells ----


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

    def von_mises(self, side: ShellSide = "largest") -> NDArray[np.float64]:
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
    X_1, X_2 = _shell_derivatives(shapes, _factors(body, shell_coordinates(body)), ((1, 0), (0, 1)))
    r, r_1, r_2, r_11, r_22, r_12 = _shell_derivatives(
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


def largest_shell_stress(
    body: ShellBody, coordinates: NDArray[np.float64], side: ShellSide = "largest"
) -> NDArray[np.float64]:
    """Largest von Mises stress of each element of a shell [Pa], shape (..., e): as it is recorded.

    Parameters
    ----------
    body, coordinates
        As in `shell_stresses`.
    side
        One of the three, or the largest of them.
    """
    places = np.linspace(0.0, 1.0, shell_data.STRESS_PLACES)
    values: NDArray[np.float64] = (
        shell_stresses(body, coordinates, places, places).von_mises(side).max(axis=(-2, -1))
    )
    return values


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


def _shell_derivatives(
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
