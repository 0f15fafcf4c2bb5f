"""The triangular shell of three nodes: discrete shear gaps in bending, an optimal membrane with drilling rotations."""

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

__all__ = ["triangle_axes", "triangle_operators"]

_SHAPE = np.array([[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]])
_LUMPING = 1.5  # alpha_b of the optimal triangle
_BETA = np.array([1.0, 2.0, 1.0, 0.0, 1.0, -1.0, -1.0, -1.0, -2.0])
_LEAST_BETA = 0.01  # beta_0, which vanishes at nu = 1/2
_STABILISATION = 0.1  # of the shear, in squares of the longest edge over that of the thickness


def triangle_axes(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Local axes of triangles (ne, 3, 3) as rows, shape (ne, 3, 3); axis 1 is along edge 1-2."""
    e1 = corners[:, 1] - corners[:, 0]
    n = np.cross(e1, corners[:, 2] - corners[:, 0])
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    e1 /= np.linalg.norm(e1, axis=1, keepdims=True)
    return np.stack([e1, np.cross(n, e1), n], axis=1)


def triangle_operators(
    corners: NDArray[np.float64],
    offset: NDArray[np.float64],
    poisson_ratio: float,
    thickness: NDArray[np.float64],
) -> ShellOperators:
    """Strains of triangles at the middles of edges 1-2, 2-3 and 3-1.

    Parameters
    ----------
    corners
        Positions of the nodes [m], shape (ne, 3, 3), anticlockwise seen from the side of the normal.
    offset
        From the nodes to the mid-surface along the normal [m], shape (ne,).
    poisson_ratio
        Of the plates, which sets the weight of the higher strains of the membrane.
    thickness
        [m], shape (ne,), which sets the stabilisation of the shear.

    Notes
    -----
    *Bending*: DSG3, K.-U. Bletzinger, M. Bischoff, E. Ramm, Comput. Struct. 75 (2000) 321, as the mean of the shear
    gaps from each of the nodes, so that the order of the nodes does not matter; the shear stiffness is taken times
    ``t^2 / (t^2 + 0.1 l^2)``, l the longest edge.

    *Membrane*: OPT, C. A. Felippa, Comput. Meth. Appl. Mech. Engng 192 (2003) 2125: basic strains by lumping
    (alpha_b = 3/2) and, at the middles of the edges, ``3/2 sqrt(beta_0)`` times the deviatoric strains of the
    rotations of the corners relative to the mean one; ``beta_0 = (1 - 4 nu^2)/2``. Rotations are true ones.
    """
    ne = len(corners)
    axes = triangle_axes(corners)
    local = np.matmul(corners - corners.mean(axis=1, keepdims=True), axes.transpose(0, 2, 1))
    x, y = local[..., 0], local[..., 1]
    nxt, last = [1, 2, 0], [2, 0, 1]
    # x_ij = x_i - x_j; of node i: the edge opposite, from the next to the last node
    edge_x, edge_y = x[:, last] - x[:, nxt], y[:, last] - y[:, nxt]
    twice = edge_x[:, 0] * edge_y[:, 1] - edge_x[:, 1] * edge_y[:, 0]
    G = np.stack([-edge_y, edge_x], axis=1) / twice[:, None, None]  # d/dx and d/dy of N, (ne, 2, 3)

    B = np.zeros((ne, 3, 8, 3, 6))
    B[:, :, MEMBRANE][..., [0, 1, 5]] = _membrane(x, y, G, 0.5 * twice, poisson_ratio)
    bending = B[:, :, BENDING]
    bending[:, :, 0, :, 4] = G[:, None, 0]
    bending[:, :, 1, :, 3] = -G[:, None, 1]
    bending[:, :, 2, :, 4] = G[:, None, 1]
    bending[:, :, 2, :, 3] = -G[:, None, 0]
    longest = (edge_x**2 + edge_y**2).max(axis=1)
    reduced = np.sqrt(thickness**2 / (thickness**2 + _STABILISATION * longest))
    B[:, :, SHEAR] = (_shear(x, y, G) * reduced[:, None, None, None])[:, None]
    to_mid_surface(B, np.repeat(offset[:, None], 3, axis=1))
    return ShellOperators(
        strain=turned_to_axes(B.reshape(ne, 24, 3, 6), axes).reshape(ne, 3, 8, 18),
        area=np.repeat(twice[:, None] / 6.0, 3, axis=1),
        drilling=np.empty((ne, 0, 18)),
        drilling_area=np.empty((ne, 0)),
        axes=axes,
        local=local,
        shape=_SHAPE,
        gradient=np.repeat(G.transpose(0, 2, 1)[:, None], 3, axis=1),
    )


def _membrane(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    G: NDArray[np.float64],
    area: NDArray[np.float64],
    nu: float,
) -> NDArray[np.float64]:
    """Membrane strains of u, v and the rotation at the middles of the edges, shape (ne, 3, 3, 3, 3)."""
    ne = len(x)

    def dx(i: int, j: int) -> NDArray[np.float64]:
        return x[:, i - 1] - x[:, j - 1]

    def dy(i: int, j: int) -> NDArray[np.float64]:
        return y[:, i - 1] - y[:, j - 1]

    basic = np.zeros((ne, 3, 3, 3))  # strain, node, u v theta
    basic[:, 0, :, 0] = basic[:, 2, :, 1] = G[:, 0]
    basic[:, 1, :, 1] = basic[:, 2, :, 0] = G[:, 1]
    for node, (i, j, k) in enumerate(((1, 2, 3), (2, 3, 1), (3, 1, 2))):
        # rows of L for the rotation of node i, over twice the area: j follows i, k follows j
        factor = _LUMPING / 6.0 / (2.0 * area)
        basic[:, 0, node, 2] = factor * dy(j, k) * (dy(i, k) - dy(j, i))
        basic[:, 1, node, 2] = factor * dx(k, j) * (dx(k, i) - dx(i, j))
        basic[:, 2, node, 2] = 2.0 * factor * (dx(k, i) * dy(i, k) - dx(i, j) * dy(j, i))

    # rotations of the corners less the mean one
    hierarchical = np.zeros((ne, 3, 3, 3))
    for node, (j, k) in enumerate(((2, 3), (3, 1), (1, 2))):
        hierarchical[:, :, node, 0] = (dx(k, j) / (4.0 * area))[:, None]
        hierarchical[:, :, node, 1] = (dy(k, j) / (4.0 * area))[:, None]
        hierarchical[:, node, node, 2] = 1.0

    squares = np.stack(
        [dx(2, 1) ** 2 + dy(2, 1) ** 2, dx(3, 2) ** 2 + dy(3, 2) ** 2, dx(1, 3) ** 2 + dy(1, 3) ** 2], 1
    )
    # Cartesian strains from natural ones along edges 12, 23, 31
    natural = np.stack(
        [
            np.stack([dy(2, 3) * dy(1, 3), dy(3, 1) * dy(2, 1), dy(1, 2) * dy(3, 2)], axis=1),
            np.stack([dx(2, 3) * dx(1, 3), dx(3, 1) * dx(2, 1), dx(1, 2) * dx(3, 2)], axis=1),
            np.stack(
                [
                    dy(2, 3) * dx(3, 1) + dx(3, 2) * dy(1, 3),
                    dy(3, 1) * dx(1, 2) + dx(1, 3) * dy(2, 1),
                    dy(1, 2) * dx(2, 3) + dx(2, 1) * dy(3, 2),
                ],
                axis=1,
            ),
        ],
        axis=1,
    )
    natural *= squares[:, None] / (4.0 * area**2)[:, None, None]
    b = _BETA
    corner = np.array(
        [
            [[b[0], b[1], b[2]], [b[3], b[4], b[5]], [b[6], b[7], b[8]]],
            [[b[8], b[6], b[7]], [b[2], b[0], b[1]], [b[5], b[3], b[4]]],
            [[b[4], b[5], b[3]], [b[7], b[8], b[6]], [b[1], b[2], b[0]]],
        ]
    )
    middle = 0.5 * (corner + corner[[1, 2, 0]])  # between corners 1-2, 2-3, 3-1
    Q = (2.0 / 3.0) * area[:, None, None, None] * middle / squares[:, None, :, None]
    beta = max(0.5 * (1.0 - 4.0 * nu**2), _LEAST_BETA)
    higher = (
        1.5 * np.sqrt(beta) * np.matmul(natural[:, None], np.matmul(Q, hierarchical.reshape(ne, 1, 3, 9)))
    )
    return basic[:, None] + higher.reshape(ne, 3, 3, 3, 3)


def _shear(x: NDArray[np.float64], y: NDArray[np.float64], G: NDArray[np.float64]) -> NDArray[np.float64]:
    """Transverse shear xz, yz, constant, shape (ne, 2, 3, 6)."""
    B = np.zeros((len(x), 2, 3, 6))
    for start in range(3):
        for end in range(3):
            if start == end:
                continue
            # gap w_end - w_start + half of (beta_start + beta_end) . (x_end - x_start), a third from each start
            slope = G[:, :, end] / 3.0
            B[:, :, end, 2] += slope
            B[:, :, start, 2] -= slope
            for node in (start, end):
                B[:, :, node, 4] += 0.5 * slope * (x[:, end] - x[:, start])[:, None]
                B[:, :, node, 3] -= 0.5 * slope * (y[:, end] - y[:, start])[:, None]
    return B
