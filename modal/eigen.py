"""Natural frequencies and mode shapes of a finite element model, supported or free.

"Deformable bodies with complex geometries ... sliding contacts" (2014), section 2.2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.modal.flexibility import Flexibility, apply_mass
from heavylift.modal.lanczos import BLOCK, block_lanczos
from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.threads import one_blas_thread

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.modal.constraints import FreeDofs
    from heavylift.preprocess.finite_elements.model import FEModel

__all__ = [
    "Modes",
    "ModesNotConvergedError",
    "eigenmodes",
    "orthogonality_error",
    "relative_residuals",
    "signed",
]

RESIDUAL_LIMIT = 1e-5
"""Accepted ``||K phi - w2 M phi|| / (w2 ||M phi||)``; the error of w2 is of its square.

Rounding alone gives 1e-16 times the ratio of the mesh's largest eigenvalue to w2: 1e-8 to 1e-6.
"""

ORTHOGONALITY_LIMIT = 1e-8

_KRYLOV_TOLERANCE = 1e-8
_REFINEMENTS = 4  # of modes that converged as eigenvalues, but not yet as shapes
_DENSE_UNKNOWNS = 500  # below, the dense solver is as fast
_DENSE_LIMIT = 6000  # above, a dense matrix is no alternative even if most modes are wanted


class ModesNotConvergedError(RuntimeError):
    """The eigenvalue iteration ended without the accuracy that was asked for.

    Attributes
    ----------
    residuals
        Relative residuals of the modes found.
    orthogonality
        ``max |Phi^T M Phi - 1|``.
    """

    def __init__(self, problem: str, residuals: NDArray[np.float64], orthogonality: float) -> None:
        self.residuals = residuals
        self.orthogonality = orthogonality
        worst = float(residuals.max()) if residuals.size else float("nan")
        super().__init__(
            f"{problem}: largest relative residual {worst:.2e}, orthogonality {orthogonality:.2e}"
        )


@dataclass(frozen=True, eq=False)
class Modes:
    """Flexible eigenmodes of a model; rigid modes are removed.

    Attributes
    ----------
    eigenvalues
        Squared angular frequencies [rad^2/s^2], ascending, shape (nf,).
    shapes
        Mass-normalised mode shapes [kg^-1/2], node-major, shape (N, nf); zero at clamped nodes; the
        component of largest magnitude is positive.
    residuals
        ``||K phi - w2 M phi|| / (w2 ||M phi||)`` over the free degrees of freedom, shape (nf,).
    orthogonality
        ``max |Phi^T M Phi - 1|``.
    rigid_count
        Rigid modes that were removed: 6 for a free body.
    backend
        Factorisation used; ``"dense"`` for small problems.
    """

    eigenvalues: NDArray[np.float64]
    shapes: NDArray[np.float64]
    residuals: NDArray[np.float64]
    orthogonality: float
    rigid_count: int
    backend: str

    @property
    def frequencies(self) -> NDArray[np.float64]:
        """Natural frequencies [Hz], shape (nf,)."""
        return np.sqrt(self.eigenvalues) / (2.0 * np.pi)


@one_blas_thread
def eigenmodes(
    model: FEModel,
    count: int,
    *,
    up_to: float | None = None,
    fixed_nodes: Sequence[int] | NDArray[np.int64] = (),
    backend: str = "auto",
    flexibility: Flexibility | None = None,
) -> Modes:
    """Lowest flexible eigenmodes of ``K phi = w2 M phi``.

    Parameters
    ----------
    model
        Finite element model with a consistent or lumped mass.
    count
        Number of flexible modes. With `up_to` the largest number, 0 for any.
    up_to
        Only modes up to this frequency [Hz].
    fixed_nodes
        Clamped nodes besides the nodes and directions that the model holds itself. None at all: a free body,
        whose six rigid modes are found analytically and removed, as are those that supports leave.
    backend
        Factorisation, see `heavylift.modal.factor.factorise`.
    flexibility
        Factorised stiffness of the same model and supports, if at hand; makes `fixed_nodes` and
        `backend` superfluous.

    Raises
    ------
    InputError
        More modes than flexible degrees of freedom, none, none up to the frequency, or a model that is not one
        supported or free elastic body.
    ModesNotConvergedError
        If residuals or orthogonality miss the limits.

    Notes
    -----
    Shift-invert Lanczos at zero in blocks (`heavylift.modal.lanczos`) on the flexibility
    (`heavylift.modal.flexibility`), which is the pseudo-inverse of K: rigid modes are not iterated
    for and no shift has to be guessed. The start block is a fixed pseudo-random load, so results
    do not change from run to run.
    """
    body = flexibility or Flexibility(model, fixed_nodes, backend=backend)
    available = len(body.unknowns) - body.rigid_count
    highest = None if up_to is None else (2.0 * np.pi * up_to) ** 2
    if highest is not None and count == 0:
        count = available
    if not 1 <= count <= available:
        raise InputError(
            f"{count} modes requested",
            source=model.name or "finite element model",
            key="modes",
            expected=f"1 to {available}, the number of flexible degrees of freedom",
        )
    dense = len(body.unknowns) <= _DENSE_UNKNOWNS or (
        highest is None and 6 * count > len(body.unknowns) and len(body.unknowns) <= _DENSE_LIMIT
    )
    try:
        values, shapes = _dense(body, count, highest) if dense else _iterative(body, count, highest)
    except np.linalg.LinAlgError as error:
        raise InputError(
            f"no modes are found: {str(error).lower()}",
            source=model.name or "finite element model",
            key="modes",
            expected="sizes, densities and moduli whose products a computer can hold",
        ) from None
    if highest is not None:
        if values[0] > highest:
            raise InputError(
                f"no mode up to {up_to:.9g} Hz",
                source=model.name or "finite element model",
                key="up_to",
                expected=f"at least the first frequency, {np.sqrt(values[0]) / (2.0 * np.pi):.6g} Hz",
            )
        values, shapes = values[values <= highest], shapes[:, values <= highest]
    shapes = signed(shapes)
    residuals = relative_residuals(model, values, shapes, free=body.dofs)
    for _ in range(_REFINEMENTS):
        if np.all(residuals <= RESIDUAL_LIMIT):
            break
        values, shapes = _refined(body, shapes)
        residuals = relative_residuals(model, values, shapes, free=body.dofs)
    orthogonality = orthogonality_error(model, shapes)
    if not (np.all(residuals <= RESIDUAL_LIMIT) and orthogonality <= ORTHOGONALITY_LIMIT):
        raise ModesNotConvergedError(
            "modes are too inaccurate, as if supports left a mechanism or elements were far too thin",
            residuals,
            orthogonality,
        )
    return Modes(
        values, shapes, residuals, orthogonality, body.rigid_count, "dense" if dense else body.factor.backend
    )


def relative_residuals(
    model: FEModel,
    eigenvalues: NDArray[np.float64],
    shapes: NDArray[np.float64],
    *,
    free: FreeDofs,
) -> NDArray[np.float64]:
    """``||K phi - w2 M phi|| / (w2 ||M phi||)`` of each column of shapes (N, nf), over free degrees of freedom."""
    result = np.empty(len(eigenvalues))
    for first in range(0, len(eigenvalues), BLOCK):
        part = slice(first, first + BLOCK)
        inertia = free.gathered(apply_mass(model.mass, shapes[:, part]) * eigenvalues[part])[free.unknowns]
        force = free.gathered(model.stiffness @ shapes[:, part])[free.unknowns]
        scale = np.maximum(np.linalg.norm(inertia, axis=0), np.finfo(float).tiny)
        result[part] = np.linalg.norm(force - inertia, axis=0) / scale
    return result


def orthogonality_error(model: FEModel, shapes: NDArray[np.float64]) -> float:
    """``max |Phi^T M Phi - 1|`` of shapes (N, nf)."""
    gram = shapes.T @ apply_mass(model.mass, shapes)
    return float(np.abs(gram - np.eye(len(gram))).max(initial=0.0))


def signed(shapes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Shapes (N, nf) with the component of largest magnitude positive; the first of nearly equal ones."""
    magnitude = np.abs(shapes)
    # symmetric bodies have several largest components: rounding must not choose between them
    first = np.argmax(magnitude >= (1.0 - 1e-6) * magnitude.max(axis=0), axis=0)
    signs = np.sign(shapes[first, np.arange(shapes.shape[1])])
    return shapes * np.where(signs == 0.0, 1.0, signs)


def _iterative(
    body: Flexibility, count: int, highest: float | None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Eigenvalues and mass-normalised shapes (N, count) by block Lanczos."""
    mass = body.model.mass
    generator = np.random.default_rng(20140623)
    loads = np.zeros((body.model.dof_count, BLOCK))
    loads[body.unknowns] = generator.standard_normal((len(body.unknowns), BLOCK))
    # one solve makes the random loads smooth, two suppress what the lowest modes do not need
    start = body.solve(apply_mass(mass, body.solve(loads)))
    pairs = block_lanczos(
        lambda block: body.solve(apply_mass(mass, block)),
        lambda block: apply_mass(mass, block),
        start,
        count,
        tolerance=_KRYLOV_TOLERANCE,
        limit=min(len(body.unknowns), 6 * count + 30 * BLOCK),
        down_to=0.0 if highest is None else 1.0 / highest,
    )
    if not pairs.converged or np.any(pairs.values <= 0.0):
        raise ModesNotConvergedError(
            f"{len(pairs.values)} modes did not converge in a Krylov space of {pairs.dimension} vectors",
            pairs.errors,
            np.nan,
        )

    return 1.0 / pairs.values, pairs.vectors


def _refined(
    body: Flexibility, shapes: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Eigenvalues and shapes in the span of ``K^-1 M`` times the shapes: each has less of the higher modes."""
    from scipy.linalg import eigh

    V = body.solve(apply_mass(body.model.mass, shapes))
    values, axes = eigh(V.T @ (body.model.stiffness @ V), V.T @ apply_mass(body.model.mass, V))
    return values, signed(V @ axes)


def _dense(
    body: Flexibility, count: int, highest: float | None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The same by the dense solver, on the complement of the rigid motions."""
    from scipy.linalg import eigh, qr

    model, free = body.model, body.unknowns
    K = body.dofs.condensed(model.stiffness)[free][:, free].toarray()
    M = body.dofs.condensed(model.full_mass())[free][:, free].toarray()
    complement = np.eye(len(free))
    if body.rigid_count:
        inertia = body.dofs.gathered(apply_mass(model.mass, body.rigid))[free]
        complement = qr(inertia)[0][:, body.rigid_count :]  # no momentum: x^T M R = 0
        K, M = complement.T @ K @ complement, complement.T @ M @ complement
    # M x = mu K x: the mass may be singular (massless nodes), the stiffness is not
    size = len(K)
    mu, x = eigh(M, 0.5 * (K + K.T), subset_by_index=[size - count, size - 1])
    mu, x = mu[::-1], x[:, ::-1]
    massive = int(np.count_nonzero(mu > 1e-15 * mu[0]))
    if highest is not None:
        count = min(massive, count)
        mu, x = mu[:count], x[:, :count]
    if massive < count:
        raise InputError(
            f"{count} modes requested",
            source=model.name or "finite element model",
            key="modes",
            expected=f"at most {massive}, the number of degrees of freedom that have mass",
        )
    shapes = np.zeros((model.dof_count, count))
    shapes[free] = complement @ (x / np.sqrt(mu))
    return 1.0 / mu, body.dofs.expanded(shapes)
