"""What a static problem offers to the searches for its equilibrium, and the linear algebra they share.

Unknowns are displacements from the present position, so rotations need no coordinates. With loads times a
factor ``f``, the rows ``G`` of rigid joints and their gaps ``g``::

    R = f P(x) - F(x) + G(x)^T l = 0,    g(x) = 0

Searches solve with the stiffness ``K = dF/dx - f dP/dx - d(G^T l)/dx`` and the rows, damped by a multiple of the
masses where the stiffness is not positive along what the joints allow.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass

__all__ = [
    "Balance",
    "Equilibrium",
    "Factor",
    "StaticProblem",
    "factorise",
    "measure",
    "scaled",
    "stability_shift",
    "unstable_count",
]

SOFTNESS = 1e-11
"""Of unit rows relative to the largest stiffness, so that redundant rows share."""

PENALTY = 1e3
"""Stiffness of unit rows relative to the largest, with which they are factored."""

ROUNDED_PIVOT = 1e-13
"""Relative to the largest stiffness: of a direction that nothing holds, along which multipliers find nothing."""

ROUNDS, MET, ENOUGH = 12, 1e-14, 1e-9
"""Of multipliers: most of them; relative miss that ends them; that from which the whole system is factored instead."""

NEUTRAL = 1e-8
"""Of the squared frequency that loads and size of a scene make: a stiffness below it is none."""

EPSILON = 2e-16
LEAST_FACTOR = 1e-3
"""Of the loads that residuals are compared with, however small the factor is."""

ROUNDING = 1e-14
"""Of the largest squared frequency: what rounding makes of a stiffness that is zero."""


class StaticProblem(Protocol):
    """Forces and stiffness at a position that can be displaced.

    Attributes
    ----------
    count
        Unknowns.
    mass
        Sparse and positive, shape (count, count).
    scale
        Displacement by unknown that is a large one: a part of the length of the scene [m] or of a radian; infinite
        for unknowns that do not count; shape (count,).
    positions
        Unknowns that are displacements [m].
    length
        Extent of the scene [m].
    heaviest
        Largest norm of internal forces and reactions seen so far: what stands for the loads where there are none, of
        ropes and springs that pull at each other.
    """

    count: int
    mass: Any
    scale: NDArray[np.float64]
    positions: NDArray[np.int64]
    length: float
    heaviest: float

    def snapshot(self) -> Any:
        """Position, for `restore`."""

    def restore(self, snapshot: Any) -> None:
        """Go back."""

    def move(self, increment: NDArray[np.float64]) -> None:
        """Displace by a vector of unknowns."""

    def advance(self, increment: NDArray[np.float64]) -> None:
        """Displace by a step of Newton's method; the next stiffness may be that which the step promises."""

    def internal_force(self) -> NDArray[np.float64]:
        """F, shape (count,)."""

    def external_force(self) -> NDArray[np.float64]:
        """P, shape (count,)."""

    def joints(self) -> tuple[Any, NDArray[np.float64]]:
        """G, sparse by rows, shape (rows, count), and the gaps, shape (rows,)."""

    def tangent(self, factor: float, multipliers: NDArray[np.float64]) -> Any:
        """K, sparse by columns."""


@dataclass(frozen=True)
class Equilibrium:
    """What was found.

    Attributes
    ----------
    residual
        Norm of the force that is left, relative to that of the loads.
    iterations
        Stiffness matrices that were made.
    moved
        Largest displacement of a body [m].
    stable
        Whether all other positions nearby have a higher potential, neutral ones apart; None if not known.
    text
        In a sentence.
    """

    residual: float
    iterations: int
    moved: float
    stable: bool | None
    text: str


@dataclass(frozen=True)
class Balance:
    """Forces at a position.

    Attributes
    ----------
    force
        R.
    load
        P.
    G, gap
        Of the joints.
    residual, gap_size
        Norm of R relative to that of the loads, largest gap relative to the length of the scene.
    weight
        Norm of the loads.
    """

    force: NDArray[np.float64]
    load: NDArray[np.float64]
    G: Any
    gap: NDArray[np.float64]
    residual: float
    gap_size: float
    weight: float


def measure(problem: StaticProblem, factor: float, multipliers: NDArray[np.float64]) -> Balance:
    """Forces at the present position."""
    inner, load = problem.internal_force(), problem.external_force()
    G, gap = problem.joints()
    pull = G.T @ multipliers
    force = factor * load - inner + pull
    inverse = 1.0 / problem.mass.diagonal()

    def norm(values: NDArray[np.float64]) -> float:
        return float(np.sqrt(np.sum(inverse * values * values)))

    weight = max(abs(factor), LEAST_FACTOR) * norm(load)
    problem.heaviest = max(problem.heaviest, norm(pull), norm(inner))
    if weight == 0.0:
        weight = problem.heaviest
    residual = norm(force) / weight if weight > 0.0 else 0.0
    return Balance(
        force, load, G, gap, residual, float(np.abs(gap).max(initial=0.0)) / problem.length, weight
    )


def rounding_floor(problem: StaticProblem, K: Any, weight: float) -> float:
    """Residual relative to the loads that rounding leaves: forces are differences of far larger ones."""
    reference = np.where(np.isfinite(problem.scale), 1.0, 1.0 / problem.length)
    reference[problem.positions] = problem.length
    force = abs(K) @ reference
    noise = EPSILON * float(np.sqrt(np.sum(force * force / problem.mass.diagonal())))
    return noise / weight if weight > 0.0 else 0.0


def stability_shift(problem: StaticProblem, K: Any, weight: float) -> float:
    """Squared frequency [1/s2] below which a stiffness counts as zero."""
    diagonal = problem.mass.diagonal()
    heavy = np.sqrt(float(diagonal[problem.positions].sum()))
    natural = weight / max(heavy, 1e-300) / problem.length
    return max(NEUTRAL * natural, ROUNDING * float(np.abs(K.diagonal() / diagonal).max(initial=0.0)), 1e-300)


def scaled(K: Any, inverse: NDArray[np.float64], damping: float) -> Any:
    """``D K D + damping`` with a diagonal matrix D, sparse by columns."""
    from scipy.sparse import csc_array, eye_array

    data = K.data * inverse[K.indices]
    data *= np.repeat(inverse, np.diff(K.indptr))
    A = csc_array((data, K.indices, K.indptr), shape=K.shape)
    return (A + damping * eye_array(K.shape[0], format="csc")).tocsc() if damping > 0.0 else A


class Factor:
    """Solves ``(K + damping diag M) dx - G^T dl = f, G dx = g``.

    Attributes
    ----------
    positive
        Whether the damped stiffness is positive along what the joints allow; None if it was not asked for.

    Notes
    -----
    With ``A`` the damped stiffness and ``H`` the rows, both scaled, and a large ``p``, one factor of ``A + p H^T H``,
    made symmetric, tells by its pivots whether A is positive along the rows, and solves for both: each round of the
    method of multipliers (M. R. Hestenes, J. Optim. Theory Appl. 4, 1969) takes the residuals of the whole system, that
    of a stiffness that is not symmetric too, and leaves some thousandths of them. Where that does not come to an
    end, the whole system is factored, whose fill is five times larger.
    """

    def __init__(self, problem: StaticProblem, K: Any, G: Any, damping: float, *, check: bool) -> None:
        from scipy.sparse import csr_array
        from scipy.sparse.linalg import splu

        self._root = np.sqrt(problem.mass.diagonal())
        A = scaled(K, 1.0 / self._root, damping)
        self._count, rows = problem.count, G.shape[0]
        self._size = float(np.abs(A.diagonal()).max(initial=1e-300))
        self.positive: bool | None = None
        if not rows:
            self._norm = np.zeros(0)
            factor = splu(
                A, diag_pivot_thresh=0.0 if check else 0.1, permc_spec="MMD_AT_PLUS_A",
                options={"SymmetricMode": True},
            )  # fmt: skip
            if check:
                self.positive = bool(np.all(factor.U.diagonal() > 0.0))
            self._solve: Callable[[NDArray[np.float64]], NDArray[np.float64]] = factor.solve
            return
        line, scaled_rows = np.repeat(np.arange(rows), np.diff(G.indptr)), G.data / self._root[G.indices]
        self._norm = np.sqrt(np.bincount(line, weights=scaled_rows * scaled_rows, minlength=rows))
        self._norm[self._norm == 0.0] = 1.0
        self._A = A
        self._H = csr_array((scaled_rows / self._norm[line], G.indices, G.indptr), shape=G.shape)
        self._HT = self._H.T.tocsr()
        self._whole: Callable[[NDArray[np.float64]], NDArray[np.float64]] | None = None
        penalised = (0.5 * (A + A.T) + PENALTY * self._size * (self._HT @ self._H)).tocsc()
        try:
            factor = splu(
                penalised, diag_pivot_thresh=0.0, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}
            )
        except RuntimeError:  # exactly singular
            if check:
                raise
            self._solve = self._factor_whole()
            return
        pivots = factor.U.diagonal()
        if check:
            self.positive = bool(np.all(pivots > 0.0))
        self._penalised = factor.solve
        neutral = float(np.abs(pivots).min()) <= ROUNDED_PIVOT * self._size
        self._solve = self._factor_whole() if neutral and self.positive is not False else self._by_multipliers

    def _factor_whole(self) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
        """That of the system with its multipliers."""
        from scipy.sparse import block_array, eye_array
        from scipy.sparse.linalg import splu

        size, H = self._size, self._H
        soft = -SOFTNESS * size * eye_array(H.shape[0])
        whole = block_array([[self._A, size * self._HT], [size * H, soft]], format="csc")
        found: Callable[[NDArray[np.float64]], NDArray[np.float64]] = splu(whole).solve
        return found

    def _by_multipliers(self, right: NDArray[np.float64]) -> NDArray[np.float64]:
        """Displacements and multipliers, in the units of the whole system."""
        if self._whole is not None:
            return self._whole(right)
        size, count, H, HT = self._size, self._count, self._H, self._HT
        force, rate = right[:count], right[count:] / size
        x, pull = np.zeros(count), np.zeros(len(rate))
        left, gap = force, rate
        scale = float(np.linalg.norm(force)) + size * float(np.linalg.norm(rate))
        last = np.inf
        for _ in range(ROUNDS):
            change = self._penalised(left + PENALTY * size * (HT @ gap))
            x = x + change
            pull = pull + PENALTY * size * (H @ change - gap)
            left = force - self._A @ x - HT @ pull
            gap = rate - H @ x + SOFTNESS / size * pull
            far = float(np.linalg.norm(x)) + float(np.linalg.norm(rate))
            miss = float(np.linalg.norm(left)) / scale if scale > 0.0 else 0.0
            miss = max(miss, float(np.linalg.norm(gap)) / far if far > 0.0 else 0.0)
            if not (miss > MET and miss < 0.5 * last):
                break
            last = miss
        if not min(miss, last) <= ENOUGH:
            try:
                self._whole = self._factor_whole()
            except RuntimeError:  # exactly singular: the answer is no number
                return np.full(len(right), np.nan)
            return self._whole(right)
        return np.concatenate([x, pull / size])

    def solve(
        self, force: NDArray[np.float64], rate: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Displacements and multipliers."""
        both = self._solve(np.concatenate([force / self._root, self._size * rate / self._norm]))
        return both[: self._count] / self._root, -self._size * both[self._count :] / self._norm


def factorise(problem: StaticProblem, K: Any, G: Any, damping: float, *, check: bool = True) -> Factor | None:
    """A factor, or None if the matrix is singular, or not positive where that is asked for."""
    try:
        factor = Factor(problem, K, G, damping, check=check)
    except RuntimeError:  # exactly singular
        return None
    return None if factor.positive is False else factor


def unstable_count(problem: StaticProblem, K: Any, G: Any, shift: float) -> int:
    """Directions along what the joints allow in which the stiffness is negative.

    Notes
    -----
    From the signs of the pivots of a factor without exchange, by Sylvester's law of inertia.
    """
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import splu

    inverse = 1.0 / np.sqrt(problem.mass.diagonal())
    A = scaled(K, inverse, shift)
    A = 0.5 * (A + A.T)
    if G.shape[0]:
        H = G @ diags_array(inverse)
        norm = np.sqrt(np.asarray((H * H).sum(axis=1)).ravel())
        H = diags_array(1.0 / np.where(norm > 0.0, norm, 1.0)) @ H
        A = A + PENALTY * float(np.abs(A.diagonal()).max()) * (H.T @ H)
    try:
        factor = splu(
            A.tocsc(), diag_pivot_thresh=0.0, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}
        )
    except RuntimeError:
        return 1
    return int(np.count_nonzero(factor.U.diagonal() < 0.0))
