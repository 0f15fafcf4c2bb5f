"""Points of a body at which stress is recovered, and the stress there by modal coordinate."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import field
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.modal.stress import nodal_gradients
from heavylift.numerics.classes import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.finite_elements.mesh import Mesh
    from heavylift.preprocess.finite_elements.model import Material

__all__ = [
    "SURFACE",
    "SolidPoints",
    "StressPoints",
    "equivalent_stress",
    "largest_at_nodes",
    "solid_points",
]

SURFACE = "surface"
"""Side of points that have one stress only: of solids at their nodes, of beams at corners of the section."""


@dataclass(frozen=True, eq=False)
class StressPoints(ABC):
    """Points of one part of a body.

    Attributes
    ----------
    name
        Of the part: a plate group, a beam property, or the body.
    positions
        Body frame [m], shape (m, 3).
    nodes
        Node that each point belongs to, shape (m,).
    thickness
        Of the plate at each point [m], shape (m,); no numbers where there is none.
    sides
        What stress is told of at each point: `SURFACE`; or top, bottom, membrane and bending of a plate.
    from_layers
        Stress of each side from the linear ones that are recovered, shape (sides, layers).
    total
        Which sides are the whole stress of a material point, shape (sides,): not membrane and bending by themselves.
    axes
        Rows are the axes of the stress at each point, shape (m, 3, 3); None: those of the body.
    """

    name: str
    positions: NDArray[np.float64]
    nodes: NDArray[np.int64]
    thickness: NDArray[np.float64]
    sides: tuple[str, ...] = (SURFACE,)
    from_layers: NDArray[np.float64] = field(default_factory=lambda: np.ones((1, 1)))
    total: NDArray[np.bool_] = field(default_factory=lambda: np.ones(1, dtype=bool))
    axes: NDArray[np.float64] | None = None

    components = 6
    """Of the stress of a layer: `heavylift.modal.stress.VOIGT`; xx, yy, xy of a plate; the normal one of a beam."""

    def __len__(self) -> int:
        return len(self.positions)

    @abstractmethod
    def columns(self, shapes: NDArray[np.float64], part: Any) -> NDArray[np.float64]:
        """Stress of the layers at some points, one column a shape [Pa by unit coordinate].

        Parameters
        ----------
        shapes
            Displacements, and rotations of nodes that have some, in the layout of the model, shape (N, nf).
        part
            Slice or numbers of points.

        Returns
        -------
        NDArray
            Shape (m, layers, components, nf).
        """


@dataclass(frozen=True, eq=False)
class SolidPoints(StressPoints):
    """Nodes of a solid.

    Attributes
    ----------
    gradients
        Rows of `heavylift.modal.stress.nodal_gradients` for the nodes, three sparse matrices (m, n).
    elasticity
        D [Pa], shape (6, 6).
    """

    gradients: tuple[csr_array, ...] = ()
    elasticity: NDArray[np.float64] = field(default_factory=lambda: np.empty((6, 6)))

    def columns(self, shapes: NDArray[np.float64], part: Any) -> NDArray[np.float64]:
        """Stress at the nodes, as `heavylift.modal.stress.stress_modes` averages it."""
        n, count = self.gradients[0].shape[1], shapes.shape[1]
        moved = shapes[: 3 * n].reshape(n, 3 * count)
        # H[j][:, i] holds du_i/dx_j
        H = [np.asarray(gradient[part] @ moved).reshape(-1, 3, count) for gradient in self.gradients]
        strain = np.stack(
            [
                H[0][:, 0],
                H[1][:, 1],
                H[2][:, 2],
                H[1][:, 0] + H[0][:, 1],
                H[2][:, 1] + H[1][:, 2],
                H[0][:, 2] + H[2][:, 0],
            ],
            axis=1,
        )
        return np.matmul(self.elasticity, strain)[:, np.newaxis]


def solid_points(
    mesh: Mesh, material: Material, nodes: NDArray[np.int64] | None = None, *, name: str = "solid"
) -> SolidPoints:
    """Nodes of a solid body, all of them if none are named."""
    from scipy.sparse import csr_array

    chosen = np.arange(mesh.node_count) if nodes is None else np.unique(nodes)
    return SolidPoints(
        name=name,
        positions=mesh.nodes[chosen],
        nodes=chosen,
        thickness=np.full(len(chosen), np.nan),
        gradients=tuple(csr_array(gradient)[chosen] for gradient in nodal_gradients(mesh)),
        elasticity=material.elasticity_matrix(),
    )


def equivalent_stress(stress: NDArray[Any]) -> NDArray[Any]:
    """Von Mises stress [Pa] of stresses with their components first, shape (components, ...); shape (...).

    Six components are in the order of `heavylift.modal.stress.VOIGT`; three are those of plane stress, xx, yy, xy; one
    is a normal stress alone.
    """
    if len(stress) == 1:
        return np.abs(stress[0])
    if len(stress) == 3:
        xx, yy, xy = stress
        return np.sqrt(np.maximum(xx * xx - xx * yy + yy * yy + 3.0 * xy * xy, 0.0))
    xx, yy, zz, xy, yz, zx = stress
    a, b, c = xx - yy, yy - zz, zz - xx
    return np.sqrt(0.5 * (a * a + b * b + c * c) + 3.0 * (xy * xy + yz * yz + zx * zx))


def largest_at_nodes(
    parts: Sequence[StressPoints], mises: Sequence[NDArray[Any]], count: int
) -> NDArray[np.float64]:
    """Largest whole stress of the points at each node.

    Parameters
    ----------
    parts
        Points of a body.
    mises
        Von Mises stress of each part by side [Pa], shape (m, sides).
    count
        Number of nodes.

    Returns
    -------
    NDArray
        Shape (count,) [Pa]; not a number at nodes without points.
    """
    found = np.full(count, -1.0)
    for points, values in zip(parts, mises, strict=True):
        if points.total.any():
            np.maximum.at(found, points.nodes, values[:, points.total].max(axis=1))
    return np.where(found < 0.0, np.nan, found)
