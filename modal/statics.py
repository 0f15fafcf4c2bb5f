"""Static load cases of a finite element model: forces on faces, displacements, what the supports bear.

Linear elasticity, small displacements: ``K u = f`` with the supports of the model.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.modal.contact_vectors import face_rule
from heavylift.numerics.outcome import InputError
from heavylift.numerics.threads import one_blas_thread

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from heavylift.modal.flexibility import Flexibility
    from heavylift.preprocess.finite_elements.model import FEModel

__all__ = ["StaticState", "face_area", "face_forces", "solve_static"]

_BALANCED = 1e-8  # cosine between the load and a rigid motion that the supports leave
_SOLVED = 1e-6  # of the load: forces that may be left at what is not held


class StaticState(NamedTuple):
    """Equilibrium under a load case.

    Attributes
    ----------
    name
        Of the load case.
    displacements
        Of all nodes [m], shape (n, 3).
    reaction
        Resultant of the forces of all supports on the body [N], shape (3,): minus that of the loads.
    residual
        Largest force that is left at a free degree of freedom, by the largest nodal force or reaction.
    rotations
        Of all nodes [rad], shape (n, 3), zero for nodes that have none; None if no node has any.
    buckling_factor
        By which the load may grow until the body buckles; None if it was not asked for.
    """

    name: str
    displacements: NDArray[np.float64]
    reaction: NDArray[np.float64]
    residual: float
    rotations: NDArray[np.float64] | None = None
    buckling_factor: float | None = None


def face_area(model: FEModel, faces: NDArray[np.int64]) -> float:
    """Area of element faces from `heavylift.modal.contact_vectors.outer_faces` [m2]."""
    normals, weights = _normals(model, faces)[1:]
    return float(np.sum(weights * np.linalg.norm(normals, axis=2)))


def face_forces(
    model: FEModel, faces: NDArray[np.int64], *, pressure: float = 0.0, traction: ArrayLike = (0.0, 0.0, 0.0)
) -> NDArray[np.float64]:
    """Consistent nodal forces ``integral of N_i (t - p n) dA`` [N], node-major, shape (N,).

    Parameters
    ----------
    model
        Finite element model with its elements.
    faces
        From `heavylift.modal.contact_vectors.outer_faces`.
    pressure
        p against the outward normal [Pa].
    traction
        t by area, in body axes [Pa].
    """
    N, normals, weights = _normals(model, faces)
    lengths = np.linalg.norm(normals, axis=2, keepdims=True)
    density = weights[:, np.newaxis] * (lengths * np.asarray(traction, dtype=np.float64) - pressure * normals)
    forces = np.zeros(model.dof_count)
    np.add.at(forces[: 3 * model.node_count].reshape(-1, 3), faces, np.einsum("qa,fqk->fak", N, density))
    return forces


def _normals(
    model: FEModel, faces: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Shape functions at the points of faces, shape (q, a), normals times areas (f, q, 3) and weights (q,)."""
    N, (along_a, along_b), rule = face_rule(faces.shape[1], 1)
    x = model.nodes[faces]
    return N, np.cross(along_a @ x, along_b @ x), rule


@one_blas_thread
def solve_static(flexibility: Flexibility, forces: NDArray[np.float64], name: str) -> StaticState:
    """Equilibrium under nodal forces [N, N m], node-major, shape (N,).

    Raises
    ------
    InputError
        If the load pushes along a rigid motion that the supports leave, or rounding leaves too much of it.

    Notes
    -----
    One step of iterative refinement: the residual is that of the unfactorised stiffness.
    """
    model = flexibility.model
    for motion in flexibility.rigid.T:
        if abs(motion @ forces) > _BALANCED * np.linalg.norm(motion) * np.linalg.norm(forces):
            raise InputError(
                f"the supports leave {flexibility.rigid_count} rigid motion(s), and the load pushes along one",
                source=model.name or "finite element model",
                key=name,
                expected="supports that hold the body against its loads",
            )
    u = flexibility.solve(forces)
    u += flexibility.solve(forces - model.stiffness @ u)
    unbalanced = model.stiffness @ u - forces
    rest = flexibility.dofs.gathered(unbalanced)
    held = np.ones(len(rest), dtype=bool)
    held[flexibility.unknowns] = False
    scale = max(float(np.abs(forces).max(initial=0.0)), float(np.abs(rest).max()), np.finfo(float).tiny)
    residual = float(np.abs(rest[~held]).max(initial=0.0)) / scale
    if not residual <= _SOLVED:
        raise InputError(
            f"{residual:.1e} of the load is left at free nodes",
            source=model.name or "finite element model",
            key=name,
            expected="supports without mechanisms, elements that are not far too thin",
        )
    if (
        model.constraint is not None
    ):  # what follows bears forces of supports too, and of what it follows, in balance
        held[:] = True
    count = 3 * model.node_count
    reaction = np.where(held, unbalanced, 0.0)[:count].reshape(-1, 3).sum(axis=0)
    rotations = None
    if model.rotating.size:
        rotations = np.zeros((model.node_count, 3))
        rotations[model.rotating] = u[count:].reshape(-1, 3)
    return StaticState(name, u[:count].reshape(-1, 3), reaction, residual, rotations)
