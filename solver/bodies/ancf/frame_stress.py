"""Section forces and stresses of frames anywhere on their elements, from the vectors of the nodes.

Plain numpy, for pictures and checks: it shares nothing with the compiled elements.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from heavylift.solver.scene.meshes import FrameBody

__all__ = ["FrameStresses", "cubic_shapes", "frame_lengths", "frame_stresses"]


class FrameStresses(NamedTuple):
    """What frames carry at `p` places of each of `e` elements; leading axes are those of the coordinates.

    Attributes
    ----------
    places
        Positions [m], shape (..., e, p, 3), in the axes of the coordinates; so are all vectors.
    tangents
        Unit vectors, shape (..., e, p, 3).
    axial_force
        ``EA e`` [N], shape (..., e, p).
    bending
        Change of the curvature vector [1/m], which points to the centre of curvature, shape (..., e, p, 3).
    axial_stress
        ``E e`` [Pa], shape (..., e, p).
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
    Strain ``e`` of the axis as the model of the frame has it: ``(|r'|^2 - |X'|^2)/2`` or ``|r'| - |X'|``, and the
    strain in the given shape on top; curvature ``K = r' x r'' / |r'|^2``, material ("Integrated simulation ...
    (2018)", section 2.2, with the curvature by arc length of the unloaded shape). The unloaded curvature is
    taken off in its amount, because the model knows of no twist.
    """
    l = frame_lengths(body.nodes, body.tangents, body.elements) if lengths is None else lengths
    shapes = cubic_shapes(places)
    rest = np.stack([body.nodes, body.tangents], axis=1)
    _, X_s, X_ss = _derivatives(shapes, rest[body.elements], l)
    r, r_s, r_ss = _derivatives(shapes, np.asarray(coordinates)[..., body.elements, :, :], l)
    stretch, stretch_0 = np.linalg.norm(r_s, axis=-1), np.linalg.norm(X_s, axis=-1)
    exact = body.model == "exact"
    strain = stretch - stretch_0 if exact else 0.5 * (stretch**2 - stretch_0**2)
    if len(body.axial_strains):
        strain = strain + body.axial_strains[:, np.newaxis]
    tangents = r_s / np.maximum(stretch, _TINY)[..., np.newaxis]
    curvature = _material_curvature(r_s, r_ss)
    amount = np.linalg.norm(curvature, axis=-1)
    amount_0 = np.linalg.norm(_material_curvature(X_s, X_ss), axis=-1)
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


_TINY = np.finfo(np.float64).tiny


def _scaled(vectors: NDArray[np.float64], lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Factors of the shape functions, (..., e, 4, 3), from vectors of the nodes of elements, (..., e, 2, 2, 3)."""
    scale = np.ones((len(lengths), 1, 2, 1))
    scale[:, 0, 1, 0] = lengths
    return (vectors * scale).reshape(*vectors.shape[:-3], 4, 3)


def _derivatives(
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
