"""Material and finite element model: what the later stages need to know of a body's mechanics."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError, InputErrors

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.finite_elements.mesh import Mesh

__all__ = ["DENSITY_LIMIT", "WAVE_SPEEDS", "FEModel", "Material"]

WAVE_SPEEDS = (10.0, 30e3)
"""Longitudinal waves of all materials [m/s]: soft rubber to beyond diamond."""
DENSITY_LIMIT = 25e3
"""Above osmium [kg/m3]."""


@dataclass(frozen=True)
class Material:
    """Linear, isotropic, homogeneous material.

    Parameters
    ----------
    young_modulus
        E [Pa], positive.
    poisson_ratio
        nu [-], -1 < nu < 0.5.
    density
        rho [kg/m3], positive.

    Raises
    ------
    InputErrors
        Every property out of its range, at once.
    """

    young_modulus: float
    poisson_ratio: float
    density: float

    def __post_init__(self) -> None:
        errors = []
        for key, unit in (("young_modulus", "Pa"), ("density", "kg/m3")):
            value = getattr(self, key)
            if not (np.isfinite(value) and value > 0.0):
                errors.append(
                    InputError(
                        f"{value!r}", source="material", key=key, expected=f"a positive number of {unit}"
                    )
                )
        if not -1.0 < self.poisson_ratio < 0.5:
            errors.append(
                InputError(
                    f"{self.poisson_ratio!r}",
                    source="material",
                    key="poisson_ratio",
                    expected="a number between -1 and 0.5 (0.5, incompressible, makes K singular)",
                )
            )
        if errors:
            raise InputErrors(errors)

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + nu)) [Pa], the second Lame constant mu."""
        return self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))

    @property
    def lame_lambda(self) -> float:
        """First Lame constant lambda = E nu / ((1 + nu)(1 - 2 nu)) [Pa]."""
        nu = self.poisson_ratio
        return self.young_modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))

    def elasticity_matrix(self) -> NDArray[np.float64]:
        """Return D [Pa], shape (6, 6), order xx, yy, zz, xy, yz, zx, engineering shear strains."""
        D = np.zeros((6, 6))
        D[:3, :3] = self.lame_lambda
        D[np.arange(6), np.arange(6)] = self.shear_modulus
        D[np.arange(3), np.arange(3)] = self.lame_lambda + 2.0 * self.shear_modulus
        return D


@dataclass(frozen=True)
class FEModel:
    """Stiffness and mass of one flexible body.

    Degrees of freedom are node-major: x, y, z of node 0, x, y, z of node 1, ...

    Parameters
    ----------
    nodes
        Positions [m], shape (n, 3), body frame.
    stiffness
        K [N/m], sparse (3n, 3n), symmetric, free of boundary conditions. Rows of `fixed_nodes` may be zero.
    mass
        SCALAR mass matrix M_s [kg], sparse (n, n), diagonal when lumped. The mass matrix of all degrees of
        freedom is kron(M_s, I3).
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

    def __post_init__(self) -> None:
        source = self.name or "finite element model"
        object.__setattr__(self, "nodes", np.ascontiguousarray(self.nodes, dtype=np.float64))
        for key in ("fixed_nodes", "fixed_dofs"):
            object.__setattr__(self, key, np.unique(np.asarray(getattr(self, key), dtype=np.int64)))
        n = len(self.nodes)
        for key, matrix, size in (("stiffness", self.stiffness, 3 * n), ("mass", self.mass, n)):
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
        for key, held, size in (("fixed_nodes", self.fixed_nodes, n), ("fixed_dofs", self.fixed_dofs, 3 * n)):
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
    def total_mass(self) -> float:
        """Sum of the scalar mass matrix [kg]."""
        return float(self.mass.sum())

    @property
    def is_lumped(self) -> bool:
        """Whether the scalar mass matrix is diagonal."""
        coo = self.mass.tocoo()
        return bool((coo.row == coo.col).all())

    def full_mass(self) -> csr_array:
        """Mass matrix of all degrees of freedom, kron(M_s, I3) [kg], sparse (3n, 3n)."""
        from scipy.sparse import csr_array, identity, kron

        return csr_array(kron(self.mass, identity(3, format="csr"), format="csr"))
