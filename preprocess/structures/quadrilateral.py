"""The quadrilateral shell of four nodes: bending, membrane and drilling of a flat facet, links to warped corners."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.preprocess.structures.shell_operators import (
    BENDING,
    MEMBRANE,
    SHEAR,
    ShellOperators,
    to_mid_surface,
    turned_to_axes,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["DRILLING_RATIO", "corner_jacobians", "facet_axes", "quadrilateral_operators"]

DRILLING_RATIO = 1e-3
"""Of the drilling stiffness at 2 x 2 points to that at the centre."""

_CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
_POINTS = _CORNERS / np.sqrt(3.0)
# middles of edges where the covariant shear is taken: of gamma_xi at eta = -1, 1, of gamma_eta at xi = -1, 1
_TYING = np.array([[0.0, -1.0], [0.0, 1.0], [-1.0, 0.0], [1.0, 0.0]])


def facet_axes(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Local axes of quadrilaterals (ne, 4, 3) as rows, shape (ne, 3, 3).

    The normal is that of both diagonals, so corners lie alternately above and below the mean plane; axis 1 runs between
    the middles of edges 4-1 and 2-3.
    """
    n = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    e1 = corners[:, 1] + corners[:, 2] - corners[:, 0] - corners[:, 3]
    e1 -= np.einsum("ei,ei->e", e1, n)[:, None] * n
    e1 /= np.linalg.norm(e1, axis=1, keepdims=True)
    return np.stack([e1, np.cross(n, e1), n], axis=1)


def corner_jacobians(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Determinants of the Jacobian at the corners of quadrilaterals (ne, 4, 3), mean planes [m2], shape (ne, 4)."""
    local = np.matmul(corners - corners.mean(axis=1, keepdims=True), facet_axes(corners).transpose(0, 2, 1))
    found: NDArray[np.float64] = np.linalg.det(_jacobians(local, _CORNERS))
    return found


def quadrilateral_operators(
    corners: NDArray[np.float64], offset: NDArray[np.float64], poisson_ratio: float
) -> ShellOperators:
    """Strains of quadrilaterals at 2 x 2 points, in the order of the corners.

    Parameters
    ----------
    corners
        Positions of the nodes [m], shape (ne, 4, 3), anticlockwise seen from the side of the normal.
    offset
        From the nodes to the mid-surface along the normal [m], shape (ne,).
    poisson_ratio
        Of the plates: incompatible modes are condensed with it.

    Notes
    -----
    *Bending and shear*: MITC4, K.-J. Bathe and E. N. Dvorkin, Int. J. Numer. Meth. Engng 21 (1985) 367: rotations are
    bilinear, the covariant shear is taken at the middles of the edges and interpolated between them.

    *Membrane*: QM6, R. L. Taylor, P. J. Beresford, E. L. Wilson, Int. J. Numer. Meth. Engng 10 (1976) 1211: modes
    1 - xi^2 and 1 - eta^2 are added with gradients ``(det J0 / det J) J0^-1 d/dxi``, J0 at the centre, and condensed.

    *Drilling*: T. J. R. Hughes and F. Brezzi, Comput. Meth. Appl. Mech. Engng 72 (1989) 105:
    ``gamma t int (theta_z - (v,x - u,y)/2)^2 dA`` with gamma = G by one point at the centre, which does not lock on
    curved shells and carries twist over warped ones, and `DRILLING_RATIO` of it at the 2 x 2 points, which holds the
    patterns that the centre does not see.
    """
    ne = len(corners)
    axes = facet_axes(corners)
    local = np.matmul(corners - corners.mean(axis=1, keepdims=True), axes.transpose(0, 2, 1))
    shape, slopes = _shape(_POINTS)
    J = _jacobians(local, _POINTS)
    detJ: NDArray[np.float64] = np.linalg.det(J)
    inverse = np.asarray(np.linalg.inv(J), dtype=np.float64)
    G = np.matmul(inverse, slopes)  # d/dx and d/dy of N, (ne, 4, 2, 4)
    J0 = _jacobians(local, np.zeros((1, 2)))[:, 0]
    det0: NDArray[np.float64] = np.linalg.det(J0)
    inverse0 = np.asarray(np.linalg.inv(J0), dtype=np.float64)

    B = np.zeros((ne, 4, 8, 4, 6))
    B[:, :, MEMBRANE] = _membrane(G, detJ, det0, inverse0, poisson_ratio)
    bending = B[:, :, BENDING]  # beta_x = theta_y, beta_y = -theta_x
    bending[:, :, 0, :, 4] = G[:, :, 0]
    bending[:, :, 1, :, 3] = -G[:, :, 1]
    bending[:, :, 2, :, 4] = G[:, :, 1]
    bending[:, :, 2, :, 3] = -G[:, :, 0]
    B[:, :, SHEAR] = _shear(local, inverse)
    to_mid_surface(B, offset[:, None] - local[..., 2])

    middle, middle_slopes = _shape(np.zeros((1, 2)))
    G0 = np.matmul(inverse0[:, None], middle_slopes)
    drilling = np.zeros((ne, 5, 4, 6))
    all_shape, all_G = np.concatenate([middle, shape]), np.concatenate([G0, G], axis=1)
    drilling[..., 5] = all_shape
    drilling[..., 0] = 0.5 * all_G[:, :, 1]
    drilling[..., 1] = -0.5 * all_G[:, :, 0]
    to_mid_surface(drilling, offset[:, None] - local[..., 2])
    return ShellOperators(
        strain=turned_to_axes(B.reshape(ne, 32, 4, 6), axes).reshape(ne, 4, 8, 24),
        area=detJ,
        drilling=turned_to_axes(drilling, axes),
        drilling_area=np.concatenate([4.0 * det0[:, None], DRILLING_RATIO * detJ], axis=1),
        axes=axes,
        local=local,
        shape=shape,
        gradient=G.transpose(0, 1, 3, 2),
    )


def _shape(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Bilinear N (m, 4) and its derivatives (m, 2, 4) at reference points."""
    factors = 1.0 + points[:, None, :] * _CORNERS
    slopes = np.stack([_CORNERS[:, 0] * factors[..., 1], _CORNERS[:, 1] * factors[..., 0]], axis=1)
    return 0.25 * factors.prod(axis=2), 0.25 * slopes


def _jacobians(local: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rows x,xi y,xi and x,eta y,eta, shape (ne, points, 2, 2)."""
    return np.matmul(_shape(points)[1], local[:, None, :, :2])


def _membrane(
    G: NDArray[np.float64],
    detJ: NDArray[np.float64],
    det0: NDArray[np.float64],
    inverse0: NDArray[np.float64],
    nu: float,
) -> NDArray[np.float64]:
    """Membrane strains with condensed incompatible modes, shape (ne, points, 3, 4, 6)."""
    ne = len(G)
    B = np.zeros((ne, 4, 3, 4, 6))
    B[:, :, 0, :, 0] = B[:, :, 2, :, 1] = G[:, :, 0]
    B[:, :, 1, :, 1] = B[:, :, 2, :, 0] = G[:, :, 1]
    # gradient of mode k at a point: (det J0 / det J) (-2 xi_k) J0^-1[:, k]
    modes = (det0[:, None] / detJ)[..., None, None] * inverse0[:, None] * (-2.0 * _POINTS[:, None, :])
    A = np.zeros((ne, 4, 3, 2, 2))  # strain, mode, direction
    A[:, :, 0, :, 0] = A[:, :, 2, :, 1] = modes[:, :, 0]
    A[:, :, 1, :, 1] = A[:, :, 2, :, 0] = modes[:, :, 1]
    C = np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]])
    alpha, plain = A.reshape(ne, 4, 3, 4), B[..., :2].reshape(ne, 4, 3, 8)
    weighted = np.matmul(C, alpha) * detJ[..., None, None]
    weighted = weighted.reshape(ne, 12, 4).transpose(0, 2, 1)
    condensed = np.linalg.solve(
        np.matmul(weighted, alpha.reshape(ne, 12, 4)), np.matmul(weighted, plain.reshape(ne, 12, 8))
    )
    B[..., :2] = (plain - np.matmul(alpha, condensed[:, None])).reshape(ne, 4, 3, 4, 2)
    return B


def _shear(local: NDArray[np.float64], inverse: NDArray[np.float64]) -> NDArray[np.float64]:
    """Transverse shear xz, yz by tying, shape (ne, points, 2, 4, 6)."""
    N, slopes = _shape(_TYING)
    J = _jacobians(local, _TYING)
    direction = np.array([0, 0, 1, 1])
    along = J[:, np.arange(4), direction]  # x and y by the natural coordinate, (ne, 4, 2)
    # gamma_xi = w,xi + beta_x x,xi + beta_y y,xi
    covariant = np.zeros((len(local), 4, 4, 6))
    covariant[..., 2] = slopes[np.arange(4), direction]
    covariant[..., 4] = N * along[..., :1]
    covariant[..., 3] = -N * along[..., 1:]
    xi, eta = _POINTS.T
    # the nearer middle counts more: gamma_xi between eta = -1 and 1, gamma_eta between xi = -1 and 1
    between = np.zeros((4, 2, 4))
    between[:, 0, 0], between[:, 0, 1] = 0.5 * (1.0 - eta), 0.5 * (1.0 + eta)
    between[:, 1, 2], between[:, 1, 3] = 0.5 * (1.0 - xi), 0.5 * (1.0 + xi)
    weights = np.matmul(inverse, between)  # (ne, points, 2, 4)
    return np.matmul(weights, covariant.reshape(-1, 1, 4, 24)).reshape(-1, 4, 2, 4, 6)
