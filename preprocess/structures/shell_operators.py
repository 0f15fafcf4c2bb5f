"""Strains of plates from the motion of their nodes: what stiffness, stress and buckling of shells are made of."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.preprocess.finite_elements.material import Material

__all__ = [
    "BENDING",
    "MEMBRANE",
    "SHEAR",
    "ShellOperators",
    "plane_stress",
    "shell_stiffness",
    "to_mid_surface",
    "turned_to_axes",
]

MEMBRANE, BENDING, SHEAR = slice(0, 3), slice(3, 6), slice(6, 8)
"""Rows of the strains of a shell: xx, yy, xy of the mid-surface; curvatures of them; transverse shear xz, yz."""


class ShellOperators(NamedTuple):
    """Strains of many shells of one kind at their integration points.

    Attributes
    ----------
    strain
        From displacements and rotations of the nodes along the axes of the structure, node-major, six a node; shape
        (ne, points, 8, 6 nodes); curvatures are positive where the side of the normal is stretched.
    area
        Weights of the points [m2], shape (ne, points).
    drilling
        Rotation about the normal less that of the mid-surface, shape (ne, m, 6 nodes); m may be zero.
    drilling_area
        Weights of its rows [m2], to be taken times G t, shape (ne, m).
    axes
        Rows are the axes 1 and 2 in the plane of the element and its normal, shape (ne, 3, 3).
    local
        Places of the nodes along the axes from their mean [m], shape (ne, nodes, 3); the third is the warp.
    shape
        Shape functions at the points, shape (points, nodes).
    gradient
        Of the shape functions along axes 1 and 2 at the points [1/m], shape (ne, points, nodes, 2).
    """

    strain: NDArray[np.float64]
    area: NDArray[np.float64]
    drilling: NDArray[np.float64]
    drilling_area: NDArray[np.float64]
    axes: NDArray[np.float64]
    local: NDArray[np.float64]
    shape: NDArray[np.float64]
    gradient: NDArray[np.float64]


def plane_stress(material: Material) -> NDArray[np.float64]:
    """D of plane stress [Pa], shape (3, 3), order xx, yy, xy with engineering shear strain."""
    E, nu = material.young_modulus, material.poisson_ratio
    return E / (1.0 - nu**2) * np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]])


def shell_stiffness(
    operators: ShellOperators,
    material: Material,
    thickness: NDArray[np.float64],
    *,
    bending_factor: float,
    shear_factor: float,
) -> NDArray[np.float64]:
    """Stiffness matrices of shells (ne, 6 nodes, 6 nodes) [N/m, N, N m], node-major.

    Parameters
    ----------
    operators
        Strains.
    material
        Of the plates.
    thickness
        [m], shape (ne,).
    bending_factor
        Ratio of the bending stiffness to that of a homogeneous plate; 0 for a membrane.
    shear_factor
        Ratio of the thickness that carries transverse shear.
    """
    ne, points, _, columns = operators.strain.shape
    C = plane_stress(material)
    D = np.zeros((8, 8))
    D[MEMBRANE, MEMBRANE] = C
    D[BENDING, BENDING] = bending_factor * C
    D[SHEAR, SHEAR] = shear_factor * material.shear_modulus * np.eye(2)
    height = np.stack([thickness] * 3 + [thickness**3 / 12.0] * 3 + [thickness] * 2, axis=1)
    weighted = np.matmul(D, operators.strain)
    weighted *= (operators.area[:, :, None] * height[:, None, :])[..., None]
    rows = operators.strain.reshape(ne, points * 8, columns)
    K = np.matmul(rows.transpose(0, 2, 1), weighted.reshape(ne, points * 8, columns))
    if operators.drilling.shape[1]:
        factor = material.shear_modulus * thickness[:, None] * operators.drilling_area
        K += np.matmul(operators.drilling.transpose(0, 2, 1), operators.drilling * factor[..., None])
    K += K.transpose(0, 2, 1).copy()
    K *= 0.5
    return K


def to_mid_surface(rows: NDArray[np.float64], distance: NDArray[np.float64]) -> None:
    """Let displacements of the mid-surface be those of the nodes, which rigid links join to it.

    ``u_mid = u + theta x (0, 0, r)``, that is ``u + r theta_y`` and ``v - r theta_x``: six rigid motions are without
    strain however much a quadrilateral is warped, and offsets are links too.

    Parameters
    ----------
    rows
        Operators, changed in place, shape (ne, ..., nodes, 6), local axes.
    distance
        r from the nodes to the mid-surface along the normal [m], shape (ne, nodes).
    """
    ne, nodes = distance.shape
    r = distance.reshape(ne, *([1] * (rows.ndim - 3)), nodes)
    rows[..., 4] += r * rows[..., 0]
    rows[..., 3] -= r * rows[..., 1]


def turned_to_axes(rows: NDArray[np.float64], axes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Operators on displacements and rotations along local axes (ne, m, nodes, 6), along those of the structure."""
    ne, m, nodes, _ = rows.shape
    return np.matmul(rows.reshape(ne, m * nodes * 2, 3), axes).reshape(ne, m, nodes * 6)
