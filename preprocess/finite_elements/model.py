"""The finite element model: what the later stages need to know of a body's mechanics."""

from __future__ import annotations

from dataclasses import field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.material import DENSITY_LIMIT, WAVE_SPEEDS, Material

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.finite_elements.mesh import Mesh
    from heavylift.preprocess.structures.structure import Structure

__all__ = ["DENSITY_LIMIT", "WAVE_SPEEDS", "FEModel", "MassPoints", "Material"]


@dataclass(frozen=True, eq=False)
class MassPoints:
    """Masses that move with the degrees of freedom of a model: plates with thickness, sections of beams, offsets.

    With them the mass matrix ``B^T diag(m) B`` and all inertia integrals of the body follow from the same sums over
    points, rotary inertia included. A second moment of inertia about a node may be that of points with negative masses.

    Attributes
    ----------
    positions
        [m], shape (np, 3), in the frame of the model.
    masses
        [kg], shape (np,).
    operator
        B: displacements of the points from the degrees of freedom of the model, sparse (3 np, N), point-major.
    """

    positions: NDArray[np.float64]
    masses: NDArray[np.float64]
    operator: csr_array

    def matrix(self) -> csr_array:
        """Mass matrix of all degrees of freedom, sparse (N, N)."""
        from scipy.sparse import csr_array, diags_array

        weighted = diags_array(np.repeat(self.masses, 3)) @ self.operator
        return csr_array(self.operator.T @ weighted)


@dataclass(frozen=True)
class FEModel:
    """Stiffness and mass of one flexible body.

    Degrees of freedom are node-major: x, y, z of node 0, x, y, z of node 1, ...; after those of all nodes come the
    rotations x, y, z of each of the nodes that have some, N in all.

    Parameters
    ----------
    nodes
        Positions [m], shape (n, 3), body frame.
    stiffness
        K [N/m, N, N m], sparse (N, N), symmetric, free of boundary conditions. Rows of `fixed_nodes` may be zero.
    mass
        Without `points` the SCALAR mass matrix M_s [kg], sparse (n, n), diagonal when lumped: the mass matrix of all
        degrees of freedom is kron(M_s, I3). With them the mass matrix of all degrees of freedom, sparse (N, N).
    mesh, material
        What the matrices were assembled from; None when they were read from files.
    node_groups
        Named, sorted node indices.
    fixed_nodes
        Sorted indices of nodes clamped by the data itself; usually empty.
    fixed_dofs
        Sorted degrees of freedom that are held besides, one by one, as symmetry planes and sliding supports do.
    name
        Where the model comes from, for messages.
    notes
        What its reader found, chose and left out, one sentence each.
    rotating
        Sorted nodes that have rotations.
    points
        Where the mass is, of structures of plates and beams; None: the nodes of the scalar mass matrix.
    constraint
        Of nodes that follow others: all degrees of freedom from those that are free, sparse (N, free); None if none
        does. A free one is a degree of freedom of the model too: its column has a 1 in its own row, the others follow.
    structure
        Plates, beams and solids that the matrices were assembled from; None when there are none, or in `mesh`.

    Raises
    ------
    InputError
        Shapes that do not fit together, entries that are not finite, a total mass that is not positive.
    """

    nodes: NDArray[np.float64]
    stiffness: csr_array
    mass: csr_array
    mesh: Mesh | None = None
    material: Material | None = None
    node_groups: dict[str, NDArray[np.int64]] = field(default_factory=dict)
    fixed_nodes: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    fixed_dofs: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    name: str = ""
    notes: tuple[str, ...] = ()
    rotating: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    points: MassPoints | None = None
    constraint: csr_array | None = None
    structure: Structure | None = None

    def __post_init__(self) -> None:
        source = self.name or "finite element model"
        object.__setattr__(self, "nodes", np.ascontiguousarray(self.nodes, dtype=np.float64))
        for key in ("fixed_nodes", "fixed_dofs", "rotating"):
            object.__setattr__(self, key, np.unique(np.asarray(getattr(self, key), dtype=np.int64)))
        n = len(self.nodes)
        inertial = n if self.points is None else self.dof_count
        if self.rotating.size and self.points is None:
            raise InputError(
                f"{len(self.rotating)} nodes with rotations and a scalar mass matrix",
                source=source,
                key="points",
                expected="mass points of a model with rotations",
            )
        for key, matrix, size in (
            ("stiffness", self.stiffness, self.dof_count),
            ("mass", self.mass, inertial),
        ):
            if matrix.shape != (size, size):
                raise InputError(
                    f"matrix of shape {matrix.shape}",
                    source=source,
                    key=key,
                    expected=f"({size}, {size}) for {n} nodes",
                )
            if not np.isfinite(matrix.data).all():
                raise InputError(
                    "has entries that are not finite", source=source, key=key, expected="finite numbers"
                )
        if self.constraint is not None and self.constraint.shape[0] != self.dof_count:
            raise InputError(
                f"matrix of shape {self.constraint.shape}",
                source=source,
                key="constraint",
                expected=f"{self.dof_count} rows, one a degree of freedom",
            )
        for key, held, size in (
            ("fixed_nodes", self.fixed_nodes, n),
            ("fixed_dofs", self.fixed_dofs, self.dof_count),
            ("rotating", self.rotating, n),
        ):
            if held.size and (held[0] < 0 or held[-1] >= size):
                raise InputError(
                    f"indices {held[0]} to {held[-1]}",
                    source=source,
                    key=key,
                    expected=f"zero-based indices below {size}",
                )
        if not self.total_mass > 0.0:
            raise InputError(
                f"total mass {self.total_mass} kg", source=source, key="mass", expected="a positive mass"
            )

    @property
    def node_count(self) -> int:
        """Number of nodes."""
        return len(self.nodes)

    @property
    def elements(self) -> Mesh | Structure | None:
        """What is between the nodes; None if that is not known."""
        return self.mesh if self.mesh is not None else self.structure

    @property
    def dof_count(self) -> int:
        """Number N of degrees of freedom: three displacements a node, and three rotations of nodes that have some."""
        return 3 * (len(self.nodes) + len(self.rotating))

    @cached_property
    def rotation_dofs(self) -> NDArray[np.int64]:
        """First of the three rotations of every node, -1 for none, shape (n,)."""
        first = np.full(len(self.nodes), -1, dtype=np.int64)
        first[self.rotating] = 3 * (len(self.nodes) + np.arange(len(self.rotating)))
        return first

    def node_dofs(self, nodes: NDArray[np.int64]) -> NDArray[np.int64]:
        """Sorted degrees of freedom of some nodes: displacements, and rotations of those that have some."""
        turning = self.rotation_dofs[nodes]
        first = np.concatenate([3 * np.asarray(nodes, dtype=np.int64), turning[turning >= 0]])
        return np.sort((first[:, None] + np.arange(3)).ravel())

    @cached_property
    def dof_nodes(self) -> NDArray[np.int64]:
        """Node of every degree of freedom, shape (N,)."""
        return np.repeat(np.concatenate([np.arange(len(self.nodes)), self.rotating]), 3)

    @property
    def total_mass(self) -> float:
        """Mass of the body [kg]."""
        return float(self.mass.sum() if self.points is None else self.points.masses.sum())

    @property
    def centre_of_mass(self) -> NDArray[np.float64]:
        """Centre of mass [m], shape (3,)."""
        if self.points is not None:
            return self.points.masses @ self.points.positions / self.points.masses.sum()
        row_sum = np.asarray(self.mass.sum(axis=0)).ravel()
        return row_sum @ self.nodes / row_sum.sum()

    @property
    def is_lumped(self) -> bool:
        """Whether no mass couples one node with another."""
        coo = self.mass.tocoo()
        if self.points is not None:
            return bool((self.dof_nodes[coo.row] == self.dof_nodes[coo.col]).all())
        return bool((coo.row == coo.col).all())

    def full_mass(self) -> csr_array:
        """Mass matrix of all degrees of freedom [kg, kg m, kg m2], sparse (N, N)."""
        from scipy.sparse import csr_array, identity, kron

        if self.points is not None:
            return self.mass
        return csr_array(kron(self.mass, identity(3, format="csr"), format="csr"))
