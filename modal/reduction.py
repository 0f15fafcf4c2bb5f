"""From a set of vectors to a reduced body: rigid part out, Ritz step, shape integrals.

"Deformable bodies with complex geometries ... sliding contacts" (2014), section 2.3.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.modal.constraints import free_dofs
from heavylift.modal.eigen import orthogonality_error, signed
from heavylift.modal.flexibility import apply_mass, held_dofs, rigid_basis
from heavylift.modal.invariants import shape_integrals
from heavylift.modal.reduced import ReducedBody, check_orthonormal
from heavylift.numerics.outcome import InputError
from heavylift.numerics.threads import one_blas_thread

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from heavylift.modal.constraints import FreeDofs
    from heavylift.modal.invariants import ShapeIntegrals
    from heavylift.preprocess.finite_elements.model import FEModel

__all__ = ["Ritz", "mean_axis", "reduce_body", "ritz_vectors"]

_DEPENDENT = 1e-6
"""Part of a vector's length that must not lie in the span of those before it."""

_ROUNDING = 1e-14
"""Of the largest eigenvalue of a Gram matrix: more than rounding leaves of one that is zero."""

_TAKES_PART = 0.05
"""A vector takes part in a linear dependence from this factor on; the squares of all factors have the sum 1."""

_SAME = 0.95
"""A Ritz vector bears the name of a given vector if the cosine of their angle, in the mass metric, exceeds this."""

_MULTIPLE = 1e-6
"""Relative distance of Ritz values whose vectors are arbitrary within their common span."""

_CHUNK = 16  # vectors handled at once


class Ritz(NamedTuple):
    """Result of a Ritz step.

    Attributes
    ----------
    eigenvalues
        Ritz values [rad^2/s^2], ascending, shape (nf,).
    shapes
        Mass-orthonormal [kg^-1/2], shape (N, nf), with diagonal stiffness.
    labels
        Name of the given vector that each Ritz vector equals but for a little; each name once. A
        vector that mixes several is ``"Ritz vector 7"``, by its number from 1.
    dropped
        Names of the vectors that were not needed, with the reason.
    residuals
        ``||K phi - w2 M phi|| / (w2 ||M phi||)`` over the free degrees of freedom, shape (nf,).
    """

    eigenvalues: NDArray[np.float64]
    shapes: NDArray[np.float64]
    labels: tuple[str, ...]
    dropped: tuple[str, ...]
    residuals: NDArray[np.float64]


def mean_axis(model: FEModel, vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vectors (N, nv) minus their mass-weighted rigid part: no linear or angular momentum is left.

    For small deformation this is only another choice of the body frame, which now follows the mean
    motion of the body instead of its support; strains are the same. Such shapes leave
    ``modal_translation = 0`` and ``I_tf = 0`` in the undeformed state.
    """
    return _without(vectors, rigid_basis(model, np.empty(0, dtype=np.int64)), model)


def ritz_vectors(
    model: FEModel,
    vectors: NDArray[np.float64],
    labels: Sequence[str],
    *,
    fixed_nodes: Sequence[int] | NDArray[np.int64] = (),
    mean_axis: bool,
) -> Ritz:
    """Solve the eigenproblem in the span of some vectors.

    Parameters
    ----------
    model
        Finite element model.
    vectors
        Displacements, node-major, shape (N, nv), zero at clamped nodes.
    labels
        One name a vector.
    fixed_nodes
        Clamped nodes besides the nodes and directions that the model holds itself.
    mean_axis
        Take all six rigid motions out. Otherwise only those that the supports leave are: the
        floating frame carries them.

    Raises
    ------
    InputError
        Arrays that do not fit, vectors that move what is held, or none that is left.

    Notes
    -----
    Stiffness is evaluated with the vectors as given, inertia with the vectors without their rigid
    part. So the stiffness may have lost its rows at clamped nodes and need not be free of penalties.
    """
    V = np.array(vectors, dtype=np.float64)
    held = held_dofs(model, fixed_nodes)
    source = model.name or "finite element model"
    if V.ndim != 2 or V.shape != (model.dof_count, len(labels)) or not np.all(np.isfinite(V)):
        raise InputError(
            f"vectors of shape {V.shape} with {len(labels)} labels",
            source=source,
            key="basis",
            expected=f"finite numbers of shape ({model.dof_count}, number of labels)",
        )
    if np.abs(V[held]).max(initial=0.0) > 1e-9 * np.abs(V).max(initial=0.0):
        raise InputError(
            "a vector moves what is held",
            source=source,
            key="basis",
            expected="vectors of the same supports",
        )
    supports = np.empty(0, dtype=np.int64) if mean_axis else held
    rigid = rigid_basis(model, supports, stored_energy=not mean_axis)
    dropped: list[str] = []
    V /= np.maximum(np.sqrt(_squares(model, V)), np.finfo(float).tiny)
    W = _without(V, rigid, model)
    gram = given = _product(W, lambda part: apply_mass(model.mass, part))
    kept, C = _independent(gram, labels, dropped)
    if not kept:
        raise InputError(
            "no vector deforms the body", source=source, key="basis", expected="independent deformations"
        )
    total = np.eye(len(gram))
    for repeat in (False, True):  # the repeat removes rounding that nearly dependent vectors amplified
        if repeat:
            gram = _product(W, lambda part: apply_mass(model.mass, part))
            C = _inverse_root(gram)
        stiffness = C.T @ _product(V, lambda part: model.stiffness @ part) @ C
        # upper triangle: the reduction starts at the large end, so that small eigenvalues keep their digits
        values, axes = np.linalg.eigh(0.5 * (stiffness + stiffness.T), UPLO="U")
        C = C @ axes
        total = total @ C
        V = V @ C
        W = _without(W @ C, rigid, model) if rigid.shape[1] else V
    shapes = signed(W)
    V *= np.where(np.einsum("ij,ij->j", W, shapes) < 0.0, -1.0, 1.0)
    return Ritz(
        values,
        shapes,
        _matched(given @ total / np.sqrt(np.diag(given))[:, None].clip(_DEPENDENT), values, kept, labels),
        tuple(dropped),
        _residuals(model, values, V, shapes, free_dofs(model, held)),
    )


@one_blas_thread
def reduce_body(
    model: FEModel,
    vectors: NDArray[np.float64],
    labels: Sequence[str],
    *,
    fixed_nodes: Sequence[int] | NDArray[np.int64] = (),
    origin: ArrayLike = (0.0, 0.0, 0.0),
    mean_axis: bool,
) -> ReducedBody:
    """Reduce a finite element model to the span of some vectors.

    Parameters
    ----------
    model, vectors, labels, fixed_nodes, mean_axis
        See `ritz_vectors`. A body on a frame that moves freely needs ``mean_axis=True``.
    origin
        Origin of the body frame in the frame of the model [m]; the axes are parallel.

    Raises
    ------
    InputError
        See `ritz_vectors`; an origin that is not three finite numbers; shapes that rounding leaves without unit mass.
    """
    shift = np.asarray(origin, dtype=np.float64)
    if shift.shape != (3,) or not np.all(np.isfinite(shift)):
        raise InputError(
            f"origin {origin!r}", source=model.name, key="origin", expected="three finite coordinates [m]"
        )
    ritz = ritz_vectors(model, vectors, labels, fixed_nodes=fixed_nodes, mean_axis=mean_axis)
    nodes, count = model.nodes - shift, 3 * model.node_count
    orthogonality = orthogonality_error(model, ritz.shapes)
    check_orthonormal(orthogonality, ritz.eigenvalues, model.name or "finite element model")
    shapes = np.ascontiguousarray(ritz.shapes[:count].T).reshape(len(ritz.eigenvalues), model.node_count, 3)
    rotations = None
    if model.rotating.size:
        rotations = np.zeros_like(shapes)
        rotations[:, model.rotating] = ritz.shapes[count:].T.reshape(len(shapes), -1, 3)
    return ReducedBody(
        nodes=nodes,
        eigenvalues=ritz.eigenvalues,
        mode_shapes=shapes,
        integrals=_integrals(model, ritz.shapes, shift, shapes),
        mean_axis=mean_axis,
        labels=ritz.labels,
        residuals=ritz.residuals,
        orthogonality=orthogonality,
        dropped=ritz.dropped,
        mesh=None if model.mesh is None else replace(model.mesh, nodes=nodes, node_groups={}),
        structure=None if model.structure is None else replace(model.structure, nodes=nodes),
        mode_rotations=rotations,
        rotating=model.rotating,
    )


def _integrals(
    model: FEModel, vectors: NDArray[np.float64], shift: NDArray[np.float64], shapes: NDArray[np.float64]
) -> ShapeIntegrals:
    """Shape integrals about a shifted origin: over the nodes, or over the points that have mass."""
    from scipy.sparse import diags_array

    points = model.points
    if points is None:
        return shape_integrals(model.nodes - shift, shapes, model.mass)
    moved = np.ascontiguousarray((points.operator @ vectors).T).reshape(len(shapes), -1, 3)
    return shape_integrals(points.positions - shift, moved, diags_array(points.masses).tocsr())


def _of_unknowns(free: FreeDofs, vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Forces on the unknowns, zero elsewhere, shape (N, m)."""
    result = np.zeros_like(vectors)
    result[free.unknowns] = free.gathered(vectors)[free.unknowns]
    return result


def _without(vectors: NDArray[np.float64], rigid: NDArray[np.float64], model: FEModel) -> NDArray[np.float64]:
    """Vectors minus their mass-weighted projection on mass-orthonormal rigid motions."""
    inertia = apply_mass(model.mass, rigid)
    result = vectors
    for _ in range(2):  # twice: the first difference may cancel most digits
        result = result - rigid @ (inertia.T @ result)
    return result


def _squares(model: FEModel, vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """``v^T M v`` of every column."""
    result = np.empty(vectors.shape[1])
    for first in range(0, vectors.shape[1], _CHUNK):
        part = vectors[:, first : first + _CHUNK]
        result[first : first + _CHUNK] = np.einsum("ij,ij->j", part, apply_mass(model.mass, part))
    return result


def _product(vectors: NDArray[np.float64], apply) -> NDArray[np.float64]:  # type: ignore[no-untyped-def]
    """``V^T (A V)``, symmetric, without storing all of ``A V``."""
    result = np.empty((vectors.shape[1], vectors.shape[1]))
    for first in range(0, vectors.shape[1], _CHUNK):
        part = slice(first, first + _CHUNK)
        result[:, part] = vectors.T @ apply(vectors[:, part])
    return 0.5 * (result + result.T)


def _independent(
    gram: NDArray[np.float64], labels: Sequence[str], dropped: list[str]
) -> tuple[list[int], NDArray[np.float64]]:
    """Orthonormal combinations of vectors of length one or less; those that add nothing are named in `dropped`.

    Returns the numbers of the vectors kept and the combinations C, (nv, nf), with ``C^T gram C = 1``.

    Notes
    -----
    The number of independent ones follows from the eigenvalues of the Gram matrix: with vectors taken one after the
    other, rounding of a dependent one grows with each near dependence before it, until it looks like a vector of its
    own.
    """
    values, axes = np.linalg.eigh(gram)
    lengths = np.sqrt(np.maximum(np.diag(gram), 0.0))
    rank = int(np.count_nonzero(values > max(_DEPENDENT**2, _ROUNDING * values[-1])))
    if rank < len(gram):
        null = axes[:, : len(gram) - rank]
        lacking = _most_dependent(null, lengths <= _DEPENDENT)
        for j in lacking:  # of a vector that had length one before its rigid part was removed
            rigid = lengths[j] <= _DEPENDENT
            dropped.append(f"{labels[j]}: {'a rigid motion' if rigid else 'a combination of the others'}")
        kept = [j for j in range(len(gram)) if j not in lacking]
        return kept, axes[:, len(gram) - rank :] / np.sqrt(values[len(gram) - rank :])
    C = np.zeros_like(gram)
    for j in range(len(gram)):
        column = np.zeros(len(gram))
        column[j] = 1.0 / lengths[j]
        found = C[:, :j]
        for _ in range(2):
            column -= found @ (found.T @ (gram @ column))
        C[:, j] = column / np.sqrt(float(column @ gram @ column))
    return list(range(len(gram))), C


def _most_dependent(null: NDArray[np.float64], rigid: NDArray[np.bool_]) -> list[int]:
    """As many vectors as the null space, shape (nv, d), has dimensions, without which the others are independent.

    Vectors that vanish come first, then the last ones that take part.
    """
    chosen: list[int] = []
    rest = null.copy()
    candidates = [*np.flatnonzero(rigid), *np.flatnonzero(~rigid)[::-1]]
    for share in (_TAKES_PART, 0.0):  # in a large set all factors may be small
        for j in candidates:
            length = float(np.linalg.norm(rest[j]))
            if j in chosen or length <= share or len(chosen) == null.shape[1]:
                continue
            chosen.append(int(j))
            direction = rest[j] / length
            rest = rest - np.outer(rest @ direction, direction)
    return sorted(chosen)


def _inverse_root(gram: NDArray[np.float64]) -> NDArray[np.float64]:
    """Symmetric ``gram^-1/2`` of a matrix close to the identity: changes the vectors least."""
    values, axes = np.linalg.eigh(gram)
    return (axes / np.sqrt(values)) @ axes.T


def _matched(
    cosines: NDArray[np.float64], values: NDArray[np.float64], kept: list[int], labels: Sequence[str]
) -> tuple[str, ...]:
    """Name each Ritz vector after the given vector that it is, or by its number if it is a mixture.

    Given vectors are assigned so that the squared cosines, shape (nv, nf), are largest in sum. Vectors of
    equal Ritz values may be turned among each other: a given vector counts as found if it lies in their span.
    """
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(cosines[kept] ** 2, maximize=True)
    names = [f"Ritz vector {number}" for number in range(1, len(kept) + 1)]
    for row, column in zip(rows, columns, strict=True):
        equal = np.abs(values - values[column]) <= _MULTIPLE * np.abs(values[column])
        if np.linalg.norm(cosines[kept[row], equal]) > _SAME:
            names[column] = labels[kept[row]]
    return tuple(names)


def _residuals(
    model: FEModel,
    values: NDArray[np.float64],
    V: NDArray[np.float64],
    shapes: NDArray[np.float64],
    free: FreeDofs,
) -> NDArray[np.float64]:
    """Relative residuals; elastic forces from the vectors as given, inertia from the final shapes."""
    result = np.empty(len(values))
    for first in range(0, len(values), _CHUNK):
        part = slice(first, first + _CHUNK)
        force = model.stiffness @ V[:, part]
        inertia = apply_mass(model.mass, shapes[:, part]) * values[part]
        force, inertia = (_of_unknowns(free, vectors) for vectors in (force, inertia))
        scale = np.maximum(np.linalg.norm(inertia, axis=0), np.finfo(float).tiny)
        result[part] = np.linalg.norm(force - inertia, axis=0) / scale
    return result
