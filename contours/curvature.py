"""Curvature of surfaces, from one evaluation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.contours.sampling import sample_grid

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.neutral import NeutralContour

__all__ = ["principal_curvatures", "smallest_hollow_radius"]


def principal_curvatures(values: NDArray[np.float64], flip: bool = False) -> NDArray[np.float64]:
    """Principal curvatures, positive where the surface bends away from its normal as that of a ball does.

    Eigenvalues of the shape operator: roots of ``k^2 - 2 H k + K`` with the Gaussian curvature
    ``K = (L N - M^2) / (E G - F^2)`` and the mean curvature ``H = (E N - 2 F M + G L) / (2 (E G - F^2))``, where
    ``E, F, G`` are the products of the tangents, ``L, M, N`` those of the second derivatives and the normal.

    Parameters
    ----------
    values
        Evaluations S, S_u, S_v, S_uu, S_uv, S_vv, shape (..., 6, 3) [m].
    flip
        The normal is ``S_v x S_u``.

    Returns
    -------
    NDArray
        The larger and the smaller one [1/m], shape (..., 2).
    """
    su, sv, suu, suv, svv = (values[..., k, :] for k in range(1, 6))
    normal = np.cross(su, sv)
    normal *= (1.0 if flip else -1.0) / np.linalg.norm(normal, axis=-1, keepdims=True)
    E, F, G = (np.sum(a * b, axis=-1) for a, b in ((su, su), (su, sv), (sv, sv)))
    L, M, N = (np.sum(a * normal, axis=-1) for a in (suu, suv, svv))
    area = E * G - F * F
    mean = (E * N - 2.0 * F * M + G * L) / (2.0 * area)
    root = np.sqrt(np.maximum(mean * mean - (L * N - M * M) / area, 0.0))
    return np.stack([mean + root, mean - root], axis=-1)


def smallest_hollow_radius(contour: NeutralContour, flip: bool = False, per_piece: int = 4) -> float:
    """Radius of the tightest hollow [m]: a larger ball touches the surface in several places at once.

    Parameters
    ----------
    contour
        A surface.
    flip
        The normal is ``S_v x S_u``.
    per_piece
        Samples of a polynomial piece in each direction.

    Returns
    -------
    float
        Infinite if the surface has no hollow.
    """
    _, values = sample_grid(contour, per_piece)
    sharpest = float(np.min(principal_curvatures(values, flip)[..., 1]))
    return -1.0 / sharpest if sharpest < 0.0 else float("inf")
