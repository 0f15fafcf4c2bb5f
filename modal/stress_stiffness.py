"""Geometric stiffness by the stress of unit loads, and what it does to modes (`heavylift.modal.stiffening`)."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from heavylift.modal.flexibility import apply_mass
from heavylift.modal.stiffening import PRODUCTS, Stiffening
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.modal.bases import Loads
    from heavylift.modal.flexibility import Flexibility
    from heavylift.modal.reduced import ReducedBody
    from heavylift.preprocess.finite_elements.mesh import Mesh
    from heavylift.preprocess.finite_elements.model import FEModel, Material

__all__ = ["inertia_stiffening", "stress_stiffness", "with_loads"]

_BORNE = 1e-12  # of a load: what rounding leaves of it where it acts on what is held


def stress_stiffness(
    model: FEModel, *, formulation: str | None = None, key: str = "modes.stiffening"
) -> Callable[[NDArray[np.float64]], csr_array]:
    """Return a function from displacements (N,) to the geometric stiffness of all degrees of freedom, sparse (N, N).

    Raises
    ------
    InputError
        Of a body whose stress is not known: matrices without elements, or of several materials.
    """
    if model.structure is not None:
        from heavylift.preprocess.structures.geometric import geometric_stiffness

        return partial(geometric_stiffness, model.structure, model)
    if model.mesh is None or model.material is None:
        raise InputError(
            "its stress is not known: "
            + ("it has several materials" if model.mesh else "it has no elements"),
            source=model.name or "finite element model",
            key=key,
            expected="a body of blocks, STEP or a mesh with elements of one material",
        )
    return partial(_of_solid, model.mesh, model.material, formulation)


def _of_solid(
    mesh: Mesh, material: Material, formulation: str | None, displacements: NDArray[np.float64]
) -> csr_array:
    """Of a solid, of all degrees of freedom of its nodes."""
    from scipy.sparse import csr_array, identity, kron

    from heavylift.preprocess.finite_elements.geometric import geometric_stiffness

    scalar = geometric_stiffness(mesh, material, displacements.reshape(-1, 3), formulation=formulation)
    return csr_array(kron(scalar, identity(3, format="csr"), format="csr"))


def inertia_stiffening(
    flexibility: Flexibility,
    reduced: ReducedBody,
    stiffness_of: Callable[[NDArray[np.float64]], csr_array],
) -> Stiffening:
    """Stiffening by the inertia and the weight of a body.

    Parameters
    ----------
    flexibility
        Of the full model with what holds it in its frame; of a free one nothing does.
    reduced
        Its modes, with the nodes in its frame.
    stiffness_of
        From `stress_stiffness`.
    """
    model = flexibility.model
    x = (
        reduced.nodes
        if model.points is None
        else model.points.positions + (reduced.nodes[0] - model.nodes[0])
    )
    fields: list[NDArray[np.float64]] = []
    for k, l in PRODUCTS:
        C = np.zeros((3, 3))
        C[k, l] += 0.5
        C[l, k] += 0.5
        fields.append(x @ C)
    fields += [-np.cross(axis, x) for axis in np.eye(3)]
    fields += [-np.broadcast_to(axis, x.shape) for axis in np.eye(3)]
    loads = np.column_stack([_inertia(model, np.ascontiguousarray(field)) for field in fields])
    G = _projected(flexibility.solve(loads), reduced, stiffness_of)
    return Stiffening(G[:6], G[6:9], G[9:])


def _inertia(model: FEModel, field: NDArray[np.float64]) -> NDArray[np.float64]:
    """Loads (N,) of the mass with an acceleration at its nodes, or at the points where it is [m/s2], shape (n, 3)."""
    if model.points is None:
        return apply_mass(model.mass, field.ravel())
    return np.asarray(model.points.operator.T @ (model.points.masses[:, None] * field).ravel())


def with_loads(
    stiffening: Stiffening,
    flexibility: Flexibility,
    reduced: ReducedBody,
    stiffness_of: Callable[[NDArray[np.float64]], csr_array],
    loads: Loads,
    places: NDArray[np.float64],
) -> Stiffening:
    """Stiffening by forces at places too.

    Parameters
    ----------
    stiffening, flexibility, reduced, stiffness_of
        As of `inertia_stiffening`.
    loads
        Unit forces and moments, on all degrees of freedom of the model.
    places
        Where they act [m], frame of the body, shape (np, 3).

    Notes
    -----
    Loads that only press on supports are left out.
    """
    felt = np.abs(flexibility.dofs.gathered(loads.forces)[flexibility.unknowns]).max(axis=0, initial=0.0)
    kept = np.flatnonzero(felt > _BORNE * np.abs(loads.forces).max(axis=0, initial=0.0))
    forces = loads.forces[:, kept]
    n = reduced.node_count
    nodal = forces[: 3 * n].reshape(n, 3, len(kept))
    total = nodal.sum(axis=0)
    moment = np.cross(reduced.nodes[:, :, None], nodal, axis=1).sum(axis=0)
    moment += forces[3 * n :].reshape(-1, 3, len(kept)).sum(axis=0)
    return replace(
        stiffening,
        places=np.asarray(places, dtype=np.float64).reshape(-1, 3),
        labels=tuple(loads.labels[k] for k in kept),
        loads=_projected(flexibility.solve(forces), reduced, stiffness_of),
        generalised=np.vstack([total, moment, _shapes(reduced).T @ forces]).T,
    )


def _shapes(reduced: ReducedBody) -> NDArray[np.float64]:
    """Mode shapes with rotations, of all degrees of freedom, shape (N, nf)."""
    shapes = reduced.mode_shapes.reshape(reduced.mode_count, -1)
    if reduced.mode_rotations is None:
        return shapes.T
    turned = reduced.mode_rotations[:, reduced.rotating].reshape(reduced.mode_count, -1)
    return np.hstack([shapes, turned]).T


def _projected(
    answers: NDArray[np.float64],
    reduced: ReducedBody,
    stiffness_of: Callable[[NDArray[np.float64]], csr_array],
) -> NDArray[np.float64]:
    """``Phi^T K_g Phi`` of static answers (N, m), shape (m, nf, nf)."""
    Phi = _shapes(reduced)
    found = np.empty((answers.shape[1], reduced.mode_count, reduced.mode_count))
    for k, u in enumerate(answers.T):
        G = Phi.T @ (stiffness_of(u) @ Phi)
        found[k] = 0.5 * (G + G.T)
    return found
