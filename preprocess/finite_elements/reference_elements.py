"""The three solid elements: node numbering, faces, shape functions and the rules that integrate their volume.

They are numbered as in VTK and meshio:

* ``hex8``: corners (-1,-1,-1), (1,-1,-1), (1,1,-1), (-1,1,-1), then the same four at zeta = +1;
* ``hex20`` (serendipity): the same, then the middles of the edges 01, 12, 23, 30, 45, 56, 67, 74, 04, 15, 26, 37;
* ``tet10``: corners (0,0,0), (1,0,0), (0,1,0), (0,0,1), then the middles of the edges 01, 12, 02, 03, 13, 23.

Faces list their nodes anticlockwise seen from outside: corners first, then the middle nodes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "FACES",
    "FACE_CORNER_COUNT",
    "FACE_TRIANGLES",
    "HEX_EDGES",
    "NODE_COUNT",
    "REFERENCE_NODES",
    "TET_EDGES",
    "jacobians",
    "shape_functions",
    "shape_gradients",
    "volume_rule",
]

NODE_COUNT = {"hex8": 8, "tet10": 10, "hex20": 20}
FACE_CORNER_COUNT = {"hex8": 4, "tet10": 3, "hex20": 4}
HEX_EDGES = np.array(
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]]
)

FACES: dict[str, NDArray[np.int64]] = {
    "hex8": np.array(
        [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]], dtype=np.int64
    ),
    "tet10": np.array(
        [[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [0, 3, 2, 7, 9, 6]], dtype=np.int64
    ),
    "hex20": np.array(
        [
            [0, 3, 2, 1, 11, 10, 9, 8],
            [4, 5, 6, 7, 12, 13, 14, 15],
            [0, 1, 5, 4, 8, 17, 12, 16],
            [1, 2, 6, 5, 9, 18, 13, 17],
            [2, 3, 7, 6, 10, 19, 14, 18],
            [3, 0, 4, 7, 11, 16, 15, 19],
        ],
        dtype=np.int64,
    ),
}
# triangles of one face, as positions within a row of FACES
FACE_TRIANGLES: dict[str, NDArray[np.int64]] = {
    "hex8": np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int64),
    "tet10": np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]], dtype=np.int64),
    "hex20": np.array([[0, 4, 7], [4, 1, 5], [5, 2, 6], [6, 3, 7], [4, 5, 7], [5, 6, 7]], dtype=np.int64),
}

TET_EDGES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])
_TET_CORNERS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
REFERENCE_NODES: dict[str, NDArray[np.float64]] = {
    "hex8": np.array(
        [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]],
        dtype=np.float64,
    ),
    "tet10": np.vstack([_TET_CORNERS, _TET_CORNERS[TET_EDGES].mean(axis=1)]),
}
REFERENCE_NODES["hex20"] = np.vstack(
    [REFERENCE_NODES["hex8"], REFERENCE_NODES["hex8"][HEX_EDGES].mean(axis=1)]
)


def shape_functions(element_type: str, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the shape functions N at reference points.

    Parameters
    ----------
    element_type
        ``"hex8"``, ``"hex20"`` or ``"tet10"``.
    points
        Reference coordinates, shape (nq, 3).

    Returns
    -------
    NDArray
        Shape (nq, nodes per element).
    """
    if element_type == "hex8":
        # N_a = (1 + xi_a xi)(1 + eta_a eta)(1 + zeta_a zeta) / 8
        factors = 1.0 + points[:, None, :] * REFERENCE_NODES["hex8"]
        return factors.prod(axis=2) / 8.0
    if element_type == "hex20":
        return _serendipity(points)[0]
    L = np.column_stack([1.0 - points.sum(axis=1), points])
    corners = L * (2.0 * L - 1.0)
    edges = 4.0 * L[:, TET_EDGES[:, 0]] * L[:, TET_EDGES[:, 1]]
    return np.hstack([corners, edges])


def shape_gradients(element_type: str, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return dN/dxi at reference points, shape (nq, nodes per element, 3); arguments as `shape_functions`."""
    if element_type == "hex8":
        signs = REFERENCE_NODES["hex8"]
        factors = 1.0 + points[:, None, :] * signs
        gradients = np.empty((len(points), 8, 3))
        for k in range(3):
            others = [axis for axis in range(3) if axis != k]
            gradients[:, :, k] = signs[:, k] * factors[:, :, others].prod(axis=2) / 8.0
        return gradients
    if element_type == "hex20":
        return _serendipity(points)[1]
    L = np.column_stack([1.0 - points.sum(axis=1), points])
    dL = np.vstack([-np.ones(3), np.eye(3)])
    corners = (4.0 * L - 1.0)[:, :, None] * dL
    first, second = TET_EDGES[:, 0], TET_EDGES[:, 1]
    edges = 4.0 * (L[:, first, None] * dL[second] + L[:, second, None] * dL[first])
    return np.concatenate([corners, edges], axis=1)


def _serendipity(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Shape functions and gradients of the 20-node brick (Zienkiewicz, *The Finite Element Method*)."""
    signs = REFERENCE_NODES["hex20"]
    N, gradients = np.empty((len(points), 20)), np.empty((len(points), 20, 3))
    # corners: (1 + xi_a xi)(1 + eta_a eta)(1 + zeta_a zeta)(xi_a xi + eta_a eta + zeta_a zeta - 2) / 8
    products = points[:, None, :] * signs[:8]
    factors = 1.0 + products
    last = products.sum(axis=2) - 2.0
    N[:, :8] = factors.prod(axis=2) * last / 8.0
    for k in range(3):
        others = [axis for axis in range(3) if axis != k]
        rest = factors[:, :, others].prod(axis=2)
        gradients[:, :8, k] = signs[:8, k] * rest * (last + factors[:, :, k]) / 8.0
    # middles, with xi_a = 0: (1 - xi^2)(1 + eta_a eta)(1 + zeta_a zeta) / 4
    across = signs[8:] == 0.0
    factors = np.where(across, 1.0 - points[:, None, :] ** 2, 1.0 + points[:, None, :] * signs[8:])
    slopes = np.where(across, -2.0 * points[:, None, :], signs[8:])
    N[:, 8:] = factors.prod(axis=2) / 4.0
    for k in range(3):
        others = [axis for axis in range(3) if axis != k]
        gradients[:, 8:, k] = slopes[:, :, k] * factors[:, :, others].prod(axis=2) / 4.0
    return N, gradients


def volume_rule(element_type: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points (nq, 3) and weights (nq,) that integrate det J exactly, for curved elements too.

    Bricks: 2 x 2 x 2 Gauss points, 3 x 3 x 3 with 20 nodes. Tetrahedra: the five-point rule of degree 3
    (Zienkiewicz, *The Finite Element Method*, table of tetrahedral rules); its negative weight is harmless for a
    volume.
    """
    if element_type == "hex8":
        return REFERENCE_NODES["hex8"] / np.sqrt(3.0), np.ones(8)
    if element_type == "hex20":
        gauss, weight = np.polynomial.legendre.leggauss(3)
        points = np.stack(np.meshgrid(gauss, gauss, gauss, indexing="ij"), axis=-1).reshape(-1, 3)
        return points, np.einsum("i,j,k->ijk", weight, weight, weight).ravel()
    inner = np.full((4, 3), 1.0 / 6.0)
    inner[np.arange(3), np.arange(3)] = 0.5
    points = np.vstack([np.full((1, 3), 0.25), inner])
    return points, np.array([-4.0 / 5.0, 9.0 / 20.0, 9.0 / 20.0, 9.0 / 20.0, 9.0 / 20.0]) / 6.0


def jacobians(corners: NDArray[np.float64], gradients: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return J_ij = dx_i/dxi_j of many elements at many reference points.

    Parameters
    ----------
    corners
        Node positions of the elements [m], shape (ne, nodes per element, 3).
    gradients
        dN/dxi from `shape_gradients`, shape (nq, nodes per element, 3).

    Returns
    -------
    NDArray
        Shape (ne, nq, 3, 3) [m].
    """
    # (ne, 1, 3, nn) @ (nq, nn, 3): matmul is several times faster here than einsum
    return np.matmul(corners.transpose(0, 2, 1)[:, None], gradients)
