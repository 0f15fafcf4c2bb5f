"""Displacements from forces: the inverse of the stiffness, apart from rigid motions.

For a body that is not held the inverse is that of inertia relief: loads are balanced by the inertia of
the rigid motion they cause, and the rigid part of the displacement is removed in the mass metric
(R. R. Craig, A. J. Kurdila, "Fundamentals of Structural Dynamics", component modes: inertia-relief attachment
modes).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.modal.constraints import following, free_dofs
from heavylift.modal.factor import NotPositiveDefiniteError, factorise
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray
    from scipy.sparse import sparray, spmatrix

    from heavylift.preprocess.finite_elements.model import FEModel

__all__ = ["Flexibility", "apply_mass", "held_dofs", "held_nodes", "rigid_basis", "rigid_motions"]

_RIGID_ENERGY = 1e-10  # of that of the stiffest node moving alone: below it a motion stores no energy


def rigid_motions(
    nodes: NDArray[np.float64], rotating: NDArray[np.int64] | None = None
) -> NDArray[np.float64]:
    """Three translations and three small rotations about the mean of the nodes.

    Parameters
    ----------
    nodes
        Positions [m], shape (n, 3).
    rotating
        Nodes that have rotations.

    Returns
    -------
    NDArray
        Displacements, node-major, and the rotations of the nodes that have some, shape (N, 6); rotations
        scaled by the size of the body, so that all columns are of the same order.
    """
    n = len(nodes)
    r = nodes - nodes.mean(axis=0)
    size = np.sqrt(np.mean(np.sum(r**2, axis=1))) if n > 1 else 0.0
    r = r / (size or 1.0)
    motions = np.zeros((n, 3, 6))
    motions[:, [0, 1, 2], [0, 1, 2]] = 1.0
    for k in range(3):
        motions[:, :, 3 + k] = np.cross(np.eye(3)[k], r)
    if rotating is None or not len(rotating):
        return motions.reshape(3 * n, 6)
    turns = np.zeros((len(rotating), 3, 6))
    turns[:, [0, 1, 2], [3, 4, 5]] = 1.0 / (size or 1.0)
    return np.concatenate([motions.reshape(3 * n, 6), turns.reshape(-1, 6)])


def apply_mass(mass: sparray | spmatrix, vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mass matrix of all degrees of freedom times vectors (N,) or (N, m).

    Of a scalar mass matrix (n, n) this is ``kron(M_s, I3) @ vectors`` without forming the product matrix.
    """
    n = mass.shape[0]
    if n == len(vectors):
        return np.asarray(mass @ vectors)
    return np.asarray(mass @ vectors.reshape(n, -1)).reshape(vectors.shape)


def held_nodes(model: FEModel, fixed_nodes: Sequence[int] | NDArray[np.int64]) -> NDArray[np.int64]:
    """Sorted nodes clamped by the caller or by the model itself; InputError if one does not exist."""
    chosen = np.asarray(fixed_nodes, dtype=np.int64).ravel()
    wrong = chosen[(chosen < 0) | (chosen >= model.node_count)]
    if wrong.size:
        raise InputError(
            f"node {wrong[0]} does not exist",
            source=model.name or "finite element model",
            key="fixed_nodes",
            expected=f"0 to {model.node_count - 1}",
        )
    return np.union1d(chosen, model.fixed_nodes).astype(np.int64)


def held_dofs(model: FEModel, fixed_nodes: Sequence[int] | NDArray[np.int64]) -> NDArray[np.int64]:
    """Sorted degrees of freedom that do not move: all of clamped nodes, and those that the model holds one by one."""
    of_nodes = model.node_dofs(held_nodes(model, fixed_nodes))
    return np.union1d(of_nodes, model.fixed_dofs).astype(np.int64)


def rigid_basis(
    model: FEModel, held: NDArray[np.int64], *, stored_energy: bool = False
) -> NDArray[np.float64]:
    """Mass-orthonormal rigid motions of a body with some degrees of freedom held.

    Parameters
    ----------
    model
        Finite element model.
    held
        Degrees of freedom that do not move.
    stored_energy
        Leave out motions that the stiffness resists, as elastic supports inside it do.

    Returns
    -------
    NDArray
        Shape (N, r) [kg^-1/2], r = 0 ... 6.

    Raises
    ------
    InputError
        If a rigid motion moves no mass.
    """
    motions = rigid_motions(model.nodes, model.rotating)
    resisted = motions[held]
    expansion = following(model)
    if expansion is not None:  # nodes that are tied at a distance do not turn with the body
        resisted = np.concatenate([resisted, motions - expansion @ motions])
    if resisted.size:
        _, singular, right = np.linalg.svd(resisted, full_matrices=len(resisted) < 6)
        stopped = np.zeros(6, dtype=bool)
        stopped[: len(singular)] = singular > 1e-9 * max(singular[0], 1.0)
        motions = motions @ right[~stopped].T
        motions[held] = 0.0
    if not motions.shape[1]:
        return motions
    if stored_energy:
        motions = np.linalg.qr(motions)[0]
        energy, axes = np.linalg.eigh(motions.T @ (model.stiffness @ motions))
        motions = motions @ axes[:, energy <= _RIGID_ENERGY * model.stiffness.diagonal().max()]
        motions[held] = 0.0  # but for rounding they were
    if not motions.shape[1]:
        return motions
    weight, axes = np.linalg.eigh(motions.T @ apply_mass(model.mass, motions))
    if weight[0] <= 1e-14 * max(weight[-1], 0.0):
        raise InputError(
            "a rigid motion moves no mass",
            source=model.name or "finite element model",
            key="mass",
            expected="mass off the axis of every rotation that the supports leave",
        )
    return motions @ (axes / np.sqrt(weight))


class Flexibility:
    """Factorised stiffness of a body with some nodes or directions held, whether or not it can still move rigidly.

    Parameters
    ----------
    model
        Finite element model.
    fixed_nodes
        Clamped nodes, besides the nodes and directions that the model holds itself.
    backend
        See `heavylift.modal.factor.factorise`.

    Attributes
    ----------
    dofs
        What is neither held nor follows others.
    rigid
        Rigid motions that are left, mass-orthonormal [kg^-1/2], shape (N, r); r = 6 for a free body,
        0 for a supported one, 1 if only a hinge axis is held.

    Raises
    ------
    InputError
        No free node, no mass, or a stiffness that leaves more motions free than rigid ones.

    Notes
    -----
    A free body is solved with *inertia relief*: the rigid motions R (``R^T M R = 1``) absorb the
    resultant of the load, ``f - M R R^T f``, by accelerating. The self-equilibrated rest needs no
    support, so r well placed degrees of freedom (pivots of a QR factorisation of R^T) are held
    without reaction, and the displacement is made mass-orthogonal to R. Hence the operator is the
    pseudo-inverse ``G = P K^-1 P^T``, ``P = 1 - R R^T M``: exact at zero frequency, no shift.
    """

    def __init__(
        self,
        model: FEModel,
        fixed_nodes: Sequence[int] | NDArray[np.int64] = (),
        *,
        backend: str = "auto",
    ) -> None:
        self.model = model
        held = held_dofs(model, fixed_nodes)
        self.dofs = free_dofs(model, held)
        moving = np.zeros(model.dof_count, dtype=bool)
        moving[self.dofs.unknowns] = True
        # whole triples are factorised: displacements of a node, or its rotations
        triples = np.flatnonzero(moving.reshape(-1, 3).any(axis=1))
        if not triples.size:
            raise InputError(
                f"all {model.node_count} nodes are clamped",
                source=model.name or "finite element model",
                key="fixed_nodes",
                expected="at least one free node",
            )
        # directions of theirs that do not move by themselves stay in the matrix without coupling
        self._rows = (3 * triples[:, None] + np.arange(3)).ravel()
        self._held = np.flatnonzero(~moving[self._rows])
        self.rigid = rigid_basis(model, held, stored_energy=True)
        self._rigid_inertia = apply_mass(model.mass, self.rigid)
        stiffness = self._held_stiffness()
        places = model.dof_nodes[3 * triples]
        try:
            self.factor = factorise(stiffness, backend=backend, coordinates=model.nodes[places])
        except NotPositiveDefiniteError as error:
            raise InputError(
                f"the stiffness of {len(np.unique(places))} free nodes is not positive definite ({error})",
                source=model.name or "finite element model",
                key="stiffness",
                expected="one connected body without mechanisms: only rigid motions cost no energy",
            ) from error

    @property
    def unknowns(self) -> NDArray[np.int64]:
        """Degrees of freedom that are neither held nor follow others, sorted."""
        return self.dofs.unknowns

    @property
    def rigid_count(self) -> int:
        """Number of rigid motions that the supports leave."""
        return self.rigid.shape[1]

    def solve(self, forces: NDArray[np.float64]) -> NDArray[np.float64]:
        """Displacements [m, rad] from forces [N, N m], both (N,) or (N, m); zero at clamped nodes."""
        loads = self.dofs.gathered(self.equilibrated(np.asarray(forces, dtype=np.float64)))[self._rows]
        loads[self._pinned] = 0.0  # where nothing is held rounding only: the loads are in equilibrium
        result = np.zeros(np.shape(forces))
        result[self._rows] = self.factor.solve(loads)
        return self.without_rigid(self.dofs.expanded(result))

    def equilibrated(self, forces: NDArray[np.float64]) -> NDArray[np.float64]:
        """Forces minus the inertia forces of the rigid acceleration they cause; a copy."""
        if not self.rigid_count:
            return forces.copy()
        return forces - self._rigid_inertia @ (self.rigid.T @ forces)

    def without_rigid(self, displacements: NDArray[np.float64]) -> NDArray[np.float64]:
        """Displacements minus their mass-weighted rigid part."""
        if not self.rigid_count:
            return displacements
        return displacements - self.rigid @ (self._rigid_inertia.T @ displacements)

    def _held_stiffness(self) -> sparray:
        """Stiffness of the free nodes, with what is held of them, and r more directions if r rigid motions are left."""
        from scipy.linalg import qr
        from scipy.sparse import csr_array

        stiffness = self.dofs.condensed(self.model.stiffness)
        if len(self._rows) < self.model.dof_count:
            stiffness = stiffness[self._rows][:, self._rows]
        self._pinned = self._held
        if self.rigid_count:
            motions = self.rigid[self._rows]
            motions[self._held] = 0.0
            pivots = qr(motions.T, mode="r", pivoting=True)[1]
            self._pinned = np.union1d(self._held, pivots[: self.rigid_count]).astype(np.int64)
        if self._pinned.size:
            held = np.zeros(len(self._rows), dtype=bool)
            held[self._pinned] = True
            keep = np.where(held, 0.0, 1.0)
            data = stiffness.data * keep[stiffness.indices] * np.repeat(keep, np.diff(stiffness.indptr))
            diagonal = stiffness.diagonal()
            stiffness = csr_array((data, stiffness.indices, stiffness.indptr), shape=stiffness.shape)
            stiffness.setdiag(np.where(held, diagonal.mean(), diagonal))
        return stiffness
