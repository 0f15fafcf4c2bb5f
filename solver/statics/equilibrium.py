"""Static equilibrium: where a scene comes to rest.

Newton's method on the positions with the stiffness of all forces, reactions included, tangent to the joints
and damped by a multiple of the mass (K. Levenberg, Q. Appl. Math. 2, 1944)::

    [ K + mu M   -G^T ] [ dx ]   [ F ]
    [ G           0   ] [ dl ] = [ -g ],        F = Q + G^T l

F is what the joints do not carry. Steps go downhill (``F . dx > 0``) and stop short of the next hill, without
asking for a potential, so the result is a stable position, if one is in reach. At a position of balance that is
not stable, e.g. a pendulum upside down, the softest direction gives a push, and the search continues.

Ropes, lines and stops do not push, and which of them are taut changes on the way. So a step goes to the balance of
the scene that is linear but for them: with their elongations e and rows u a minimum of ::

    1/2 dx . (K + mu M) dx - f . dx + sum k/2 max(0, e + u . dx)^2,        G dx = 0

which Newton's method finds with the same matrices, each step to where the downhill way ends. K is made with the
tensions that the step promises: a fall that hangs slack at the start holds its block upright once it carries, which
only its tension says (stresses as unknowns: D. Magisano, L. Leonetti, G. Garcea, Int. J. Numer. Meth. Eng. 109, 2017).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.threads import numpy_on_one_thread, one_blas_thread
from heavylift.solver.start.consistent_start import close_positions, close_velocities, project_start
from heavylift.solver.start.rows import StartRows
from heavylift.solver.statics.forces import OneSided, StaticForces
from heavylift.solver.statics.problem import Equilibrium

__all__ = ["find_equilibrium"]

BALANCED = 1e-8
"""Residual force relative to the loads that counts as equilibrium; steps continue below it while they help."""

POLISHED = 1e-12
ITERATIONS = 400
LONGEST_MOVE, LONGEST_TURN = 0.3, 0.4
"""Of a body in a step, relative to the size of the scene and in radians."""

RUNAWAY = 20.0
"""Distance from the start, in sizes of the scene, beyond which nothing seems to hold a body."""

LOOSE = 1e-9
"""How well joints are closed after each step, relative to the size of the scene; Newton's method closes the rest."""

PUSHES = 8
PUSH = 0.03
"""Of an unstable position, in units of the longest step."""

STIFFENED_ROUNDS = 20
STIFFENED = 1e-9
"""Change of forces of joints that stiffen bodies with modes, relative to the largest, in a round of the search."""

DENSE = 600
"""Velocities up to which stability is read from all eigenvalues."""

PROMISED, RENEWALS = 0.3, 3
"""Change of the tensions in a step, relative to those at its end, from which the stiffness is made anew with these, and
how often."""

AIMS = 60
"""Most rounds of the search for what is taut at the end of a step; what they leave to do is another step's."""

FARTHEST_CORNER = 1e6
"""Part of a direction beyond which nobody asks for ropes that go taut."""

DEPENDENT = 1e-7
"""Of a row of unit length, what is along no other one, below which it says nothing new."""

NOTHING = 1e-9
"""Stiffness relative to the largest which is a rounded zero."""

CIRCULATORY = 1e-8
"""Asymmetry of a stiffness, relative to its largest entry, that is one."""

AIMED = 1e-12
"""Part of the work of the forces along a step that ends the rounds."""


def find_equilibrium(rows: StartRows) -> Equilibrium:
    """Bring a scene to rest in a stable equilibrium, with the reactions that belong to it.

    Parameters
    ----------
    rows
        The scene. Its joints are closed first; driven bodies and drives stay as they are at the start.

    Raises
    ------
    InputError
        If the joints cannot be closed, or no equilibrium is found; says what is left over.
    """
    if any(kind.NODAL for kind in rows.layout.bodies):
        from heavylift.solver.statics.mesh_statics import find_mesh_equilibrium

        return one_blas_thread(find_mesh_equilibrium)(rows)
    if rows.small:
        with numpy_on_one_thread():
            return _find(rows)
    return one_blas_thread(_find)(rows)


def _find(rows: StartRows) -> Equilibrium:
    """`find_equilibrium` of a scene without meshes."""
    project_start(rows)
    rows.put_velocity(np.zeros(len(rows.inertia)))
    begin = rows.survey()[0]
    search = _Search(rows)
    search.run()
    stiffened = [kind for kind in rows.layout.bodies if hasattr(kind, "take_reactions")]
    for _ in range(STIFFENED_ROUNDS if stiffened else 0):
        pull = search.forces.matrix().T @ search.look().reaction
        if max(kind.take_reactions(pull) for kind in stiffened) <= STIFFENED:
            break
        search.run()
    rows.start()
    reaction = search.look().reaction
    close_velocities(rows)
    rows.put_reactions(reaction)
    moved = float(np.linalg.norm(rows.survey()[0][:, 1:4] - begin[:, 1:4], axis=1).max())
    kind = {True: "stable ", False: "unstable ", None: ""}[search.stable]
    return Equilibrium(
        search.residual,
        search.iterations,
        moved,
        search.stable,
        f"{kind}equilibrium after {search.iterations} iterations, bodies moved by up to {moved:.3g} m,"
        f" {search.residual:.1e} of the loads is left",
    )


@dataclass(frozen=True)
class _Place:
    """A position, with what acts there.

    Attributes
    ----------
    force
        That is left (dof_count).
    reaction
        Of all rows (rows).
    one_sided, G
        What pulls only, and its rows over the free velocities.
    """

    force: NDArray[np.float64]
    reaction: NDArray[np.float64]
    one_sided: OneSided
    G: Any

    def stiffness(self, elongation: NDArray[np.float64]) -> Any:
        """Of what is taut at some elongations."""
        taut = elongation > 0.0
        rows = self.G[taut] * np.sqrt(self.one_sided.stiffness[taut])[:, None]
        return _by_columns(rows.T @ rows)


class _Search:
    """State of the iteration."""

    def __init__(self, rows: StartRows) -> None:
        self.rows, self.forces = rows, StaticForces(rows, dense=True)
        self.iterations, self.residual = 0, np.inf
        self.stable: bool | None = None
        self.damping = self.natural = 0.0
        self._begin = rows.survey()[0][:, 1:4]
        free = rows.free
        kind = free - rows.owner_starts[np.searchsorted(rows.owner_starts, free, side="right") - 1]
        self._moves, self._turns = kind < 3, (kind >= 3) & (kind < 6)

    def run(self) -> None:
        """Continue until nothing is left."""
        forces = self.forces
        place = self.look()
        forces.size = max(forces.size, self._slack(place))
        if forces.weight == 0.0:
            self.residual = 0.0
            return
        pushes = 0
        while True:
            before = self.residual
            forces.keep()
            # nothing acts any more where a spring or stop has just let go
            self.residual = forces.norm(place.force) / forces.weight if forces.weight > 0.0 else 0.0
            done = self.residual <= POLISHED or (self.residual <= BALANCED and self.residual > 0.3 * before)
            if self.iterations >= ITERATIONS or self._is_gone() or not np.isfinite(self.residual):
                raise self._failure(place.force)
            K, G = self._stiffness(place, place.reaction), self._tangent()
            if self.natural == 0.0:
                self._start_damping(place.force, K + place.stiffness(place.one_sided.elongation))
            if done:
                lowest, direction = self._softest(K + place.stiffness(place.one_sided.elongation), G)
                self.stable = None if lowest is None else lowest > -1e-6 * self.natural
                if self.stable is not False:
                    return
                if pushes == PUSHES:
                    raise self._unstable(direction)
                pushes += 1
                self.residual = np.inf
                self.damping = max(self.damping, 0.1 * self.natural)
                self._displace(PUSH * pushes * self._limited(direction, shorten=False)[0])
                place = self.look()
                continue
            place = self._step(place, K, G)

    def look(self) -> _Place:
        """What acts at the present position."""
        rows, forces = self.rows, self.forces
        load, G, soft = forces.evaluate()
        rigid, force = forces.balance(load, G)
        one_sided = forces.one_sided(soft)
        own = G[one_sided.row][:, rows.free] * (one_sided.sense[:, None] / forces.root[None, :])
        return _Place(force, rigid + soft, one_sided, own if isinstance(own, np.ndarray) else own.tocsr())

    def _slack(self, place: _Place) -> float:
        """How far ropes are from being taut [m]: scenes sink that far, however small their bodies."""
        G, one_sided = self.forces.matrix(), place.one_sided
        ways = [
            -e
            for row, e in zip(one_sided.row, one_sided.elongation, strict=True)
            if -np.inf < e < 0.0 and self.rows.unit(int(row), G) == "m"
        ]
        return max(ways, default=0.0)

    def _stiffness(self, place: _Place, reaction: NDArray[np.float64]) -> Any:
        """``M^-1/2 K M^-1/2`` of everything but the stretch of what pulls only, with its tensions."""
        self.iterations += 1
        inverse = 1.0 / self.forces.root
        K = self.forces.stiffness(reaction, place.one_sided.row)
        return _by_columns(K * inverse[:, None] * inverse[None, :])

    def _is_gone(self) -> bool:
        """Whether a body is too far away from its start."""
        moved = self.rows.survey()[0][:, 1:4] - self._begin
        return not float(np.abs(moved).max()) <= RUNAWAY * self.forces.size

    def _tangent(self) -> Any:
        """Rigid rows of unit length over velocities scaled by the root of the mass."""
        rows = self.rows
        G = self.forces.matrix()[rows.rigid][:, rows.free] * (1.0 / self.forces.root)[None, :]
        norm = np.sqrt(np.asarray((G * G).sum(axis=1)).ravel())
        return _by_columns(G * (1.0 / np.where(norm > 0.0, norm, 1.0))[:, None])

    def _start_damping(self, force: NDArray[np.float64], K: Any) -> None:
        """Such that the first step would be of the longest length if there was no stiffness."""
        f = force[self.rows.free] / self.forces.root
        length = self._length(f / self.forces.root)
        diagonal = np.abs(K.diagonal())
        counts = diagonal > NOTHING * diagonal.max(initial=0.0)
        floor = 1e-6 * float(np.median(diagonal[counts])) if counts.any() else 1.0
        self.natural = self.damping = max(length, floor)

    def _length(self, increment: NDArray[np.float64]) -> float:
        """Largest displacement of a body in units of the longest that is allowed."""
        moved = np.abs(increment[self._moves]).max(initial=0.0) / (LONGEST_MOVE * self.forces.size)
        turned = np.abs(increment[self._turns]).max(initial=0.0) / LONGEST_TURN
        return float(max(moved, turned))

    def _limited(
        self, scaled: NDArray[np.float64], *, shorten: bool = True
    ) -> tuple[NDArray[np.float64], float]:
        """A direction as displacements (free velocities), brought to the longest step if it is longer."""
        increment = scaled / self.forces.root
        length = self._length(increment)
        return (increment / length if length > 1.0 or not shorten else increment), length

    def _displace(self, increment: NDArray[np.float64]) -> bool:
        """Move along the free velocities and close the joints."""
        full = np.zeros(len(self.rows.inertia))
        full[self.rows.free] = increment
        self.rows.move(full)
        return close_positions(self.rows, LOOSE, quick=True) if self.rows.rigid.any() else True

    def _step(self, place: _Place, K: Any, G: Any) -> _Place:
        """One step downhill; returns what acts there."""
        rows, forces = self.rows, self.forces
        f = place.force[rows.free] / forces.root
        before = rows.snapshot()
        small = 1e-9 * self.natural
        one_sided, tension = place.one_sided, place.one_sided.tension
        renewals = 0
        while True:
            xi = self._aim(place, K, G, f)
            slope = float(f @ xi)
            if np.isfinite(slope) and slope > 0.0:
                elongation = one_sided.elongation + place.G @ xi
                promised = replace(one_sided, elongation=elongation).tension
                change = np.linalg.norm(promised - tension)
                if renewals < RENEWALS and change > PROMISED * np.linalg.norm(promised):
                    K, tension, renewals = self._renewed(place, promised), promised, renewals + 1
                    continue
                increment, length = self._limited(xi)
                if length <= 1.0 or self.damping > small:
                    break
            self.damping = max(8.0 * self.damping, 1e-3 * self.natural)
            if self.damping > 1e12 * self.natural:
                raise self._failure(place.force)
        part = 1.0
        for _ in range(12):
            closed = self._displace(part * increment)
            there = self.look()
            ahead = float(there.force[rows.free] / forces.root @ xi) / slope
            near = self.residual < 1e-5 and forces.norm(there.force) < forces.norm(place.force)
            if closed and (ahead > -0.5 or near):
                break
            part *= min(0.5, max(0.1, 1.0 / (1.0 - ahead))) if closed and np.isfinite(ahead) else 0.25
            rows.restore(before)
        if part < 1.0:
            self.damping *= 2.0
        elif length <= 1.0:
            self.damping = max(self.damping * (0.1 if ahead < 0.5 else 0.25), small)
        return there

    def _renewed(self, place: _Place, tension: NDArray[np.float64]) -> Any:
        """The stiffness with other tensions of what pulls only, and the reactions of rigid rows that belong to them."""
        forces = self.forces
        load, G, soft = forces.evaluate()
        other = place.one_sided.put(tension, soft)
        rigid, _ = forces.balance(load + G.T @ (other - soft), G)
        return self._stiffness(place, rigid + other)

    def _aim(self, place: _Place, K: Any, G: Any, f: NDArray[np.float64]) -> NDArray[np.float64]:
        """Way to the balance of what is linear but for ropes, lines and stops, which go slack and taut on it."""
        stiffness, begin = place.one_sided.stiffness, place.one_sided.elongation
        x, e, r = np.zeros(len(f)), begin, f
        for _ in range(AIMS):
            d = _solver(K + place.stiffness(e), G, self.damping)(r)
            rate = place.G @ d
            if np.array_equal(e + rate > 0.0, e > 0.0):
                return x + d
            work = float(r @ d)
            if not work > AIMED * float(f @ x):
                return x if x.any() else d
            curvature = float(d @ (K @ d)) + self.damping * float(d @ d)
            x = x + _end_of_slope(work, curvature, stiffness, e, rate) * d
            e = begin + place.G @ x
            pull = stiffness * (np.maximum(0.0, e) - np.maximum(0.0, begin))
            r = f - K @ x - self.damping * x - place.G.T @ pull
        return x

    def _softest(self, K: Any, G: Any) -> tuple[float | None, NDArray[np.float64]]:
        """Smallest eigenvalue of the stiffness along what the joints allow [1/s2], and its direction.

        Notes
        -----
        Drag and forces that turn with a body have no potential, and no symmetric stiffness. Its symmetric part says
        only when a position is certainly stable; else the eigenvalue of the stiffness with the smallest real part
        tells whether something leaves it (H. Ziegler, Principles of Structural Stability, 1968).
        """
        count = K.shape[0]
        shift = 1e-6 * self.natural
        if count > DENSE and _is_positive(K, G, shift):
            return 0.0, np.zeros(count)
        if count <= DENSE:
            rows = G if isinstance(G, np.ndarray) else G.toarray()
            _, stretches, across = np.linalg.svd(rows)
            basis = across[np.count_nonzero(stretches > DEPENDENT) :].T
            if not basis.shape[1]:
                return 0.0, np.zeros(count)
            reduced = basis.T @ (K @ basis)
            values, vectors = np.linalg.eigh(0.5 * (reduced + reduced.T))
            if values[0] >= -shift:
                return float(values[0]), basis @ vectors[:, 0]
            basis = _null_space(rows)
            reduced = basis.T @ (K @ basis)
            values, vectors = np.linalg.eigh(0.5 * (reduced + reduced.T))
            if _is_circulatory(reduced):
                values, vectors = np.linalg.eig(reduced)
                first = int(np.argmin(values.real))
                direction = vectors[:, first].real
                return float(values[first].real), basis @ (direction / np.linalg.norm(direction))
            return float(values[0]), basis @ vectors[:, 0]
        from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs, eigsh

        start = np.random.default_rng(1).normal(size=count)
        inverse = LinearOperator((count, count), matvec=_solver(K, G, shift), dtype=np.float64)
        circulatory = _is_circulatory(K)
        try:  # of the inverse: a negative eigenvalue stands at the lower end, however small it is
            if circulatory:
                values, vectors = eigs(inverse, k=1, which="SR", tol=1e-1, v0=start, maxiter=50)
                direction = vectors[:, 0].real
                return (0.0 if values[0].real >= 0.0 else -np.inf), direction / np.linalg.norm(direction)
            _, vectors = eigsh(inverse, k=1, which="SA", tol=1e-1, v0=start, maxiter=50)
            return -np.inf, vectors[:, 0]
        except ArpackNoConvergence:
            return (None if circulatory else -np.inf), inverse @ start

    def _unstable(self, direction: NDArray[np.float64]) -> InputError:
        """What leaves all positions of balance that were found."""
        rows = self.rows
        full = np.zeros(len(rows.inertia))
        full[rows.free] = direction  # per root of the mass: squares are energies
        worst = int(np.argmax(np.bincount(rows.owner, weights=full**2)))
        return InputError(
            f"no stable equilibrium found after {self.iterations} iterations: all loads are carried, but"
            f" {rows.layout.body_names[worst]!r} leaves each equilibrium position after a disturbance",
            source="simulation",
            key="start",
            expected="joints, springs or ropes that hold it, or a start nearer to a stable equilibrium",
        )

    def _failure(self, force: NDArray[np.float64]) -> InputError:
        """Where a force is left over, and in which direction."""
        rows = self.rows
        places = rows.survey()[0]
        firsts = places[:, 0].astype(np.int64)
        pull = force[firsts[:, None] + np.arange(3)]
        largest = rows.inertia[firsts[:, None] + np.arange(3, 6)].max(axis=1)
        gyration = np.sqrt(largest / np.maximum(rows.inertia[firsts], 1e-300))
        turn = force[firsts[:, None] + np.arange(3, 6)] / np.maximum(gyration, 1e-300)[:, None]
        worst = int(np.argmax(np.linalg.norm(pull, axis=1) + np.linalg.norm(turn, axis=1)))
        name = rows.layout.body_names[worst]
        if np.linalg.norm(pull[worst]) >= np.linalg.norm(turn[worst]):
            size = float(np.linalg.norm(pull[worst]))
            direction = pull[worst] / size if size else pull[worst]
            left = f"{size:.4g} N on {name!r} along ({', '.join(f'{x:.3g}' for x in direction)})"
        else:
            moment = force[firsts[worst] + 3 : firsts[worst] + 6]
            left = f"a moment of {float(np.linalg.norm(moment)):.4g} N m on {name!r}"
        rolls = any("bogie_state" in kind._fields for kind in rows.layout.joints)
        on_deck = (
            "a path or a guide of what rolls on a deck, with tyres a pause before its first leg, " * rolls
        )
        return InputError(
            f"no static equilibrium found after {self.iterations} iterations: nothing holds {left}",
            source="simulation",
            key="start",
            expected=f"joints, springs or ropes that carry all loads, {on_deck}a start nearer to the equilibrium, or "
            "start = 'relax', which lets the bodies come to rest",
        )


def _end_of_slope(
    work: float,
    curvature: float,
    stiffness: NDArray[np.float64],
    elongation: NDArray[np.float64],
    rate: NDArray[np.float64],
) -> float:
    """Part of a direction after which the way is no longer downhill.

    Parameters
    ----------
    work
        Of the force that is left along the direction.
    curvature
        Along it, of everything but what pulls only.
    stiffness, elongation, rate
        Of what pulls only, and how far the direction stretches it.
    """

    def left(part: float) -> float:
        change = np.maximum(0.0, elongation + part * rate) - np.maximum(0.0, elongation)
        return work - part * curvature - float(np.sum(stiffness * change * rate))

    with np.errstate(divide="ignore", invalid="ignore"):
        corners = -elongation / rate
    low = 0.0
    for high in np.sort(corners[(corners > 0.0) & (corners < FARTHEST_CORNER)]):
        if left(high) <= 0.0:
            break
        low = high
    else:
        high = low + 1.0
    a, b = left(low), left(high)
    return float(low + (high - low) * a / (a - b)) if a > b else 1.0


@one_blas_thread
def _null_space(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Orthonormal directions along rows of unit length, shape (columns, directions)."""
    from scipy.linalg import qr

    if not rows.shape[0]:
        return np.eye(rows.shape[1])
    q, triangle, _ = qr(rows.T, pivoting=True)
    found: NDArray[np.float64] = q[:, np.count_nonzero(np.abs(np.diag(triangle)) > DEPENDENT) :]
    return found


def _by_columns(A: Any) -> Any:
    """A dense matrix as it is, a sparse one by columns."""
    return A if isinstance(A, np.ndarray) else A.tocsc()


def _is_circulatory(K: Any) -> bool:
    """Whether a stiffness is farther from a symmetric one than difference quotients make it."""
    return bool(abs(K - K.T).max() > CIRCULATORY * abs(K).max())


def _is_positive(K: Any, G: Any, shift: float) -> bool:
    """Whether the shifted stiffness is positive along what the joints allow.

    Notes
    -----
    That of ``K + shift + p G^T G`` for large p, read from the pivots of a factor without exchange.
    """
    from scipy.sparse import eye_array
    from scipy.sparse.linalg import splu

    size = float(np.abs(K.diagonal()).max())
    A = 0.5 * (K + K.T) + shift * eye_array(K.shape[0]) + 1e3 * size * (G.T @ G)
    factor = splu(
        A.tocsc(), diag_pivot_thresh=0.0, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}
    )
    return bool(np.all(factor.U.diagonal() > 0.0))


def _solver(K: Any, G: Any, damping: float) -> Any:
    """A function that solves the damped system for a force; the joints stay closed to first order.

    What it finds is no number if the system is singular to the last digit: then more damping is asked for.
    """
    count, rows = K.shape[0], G.shape[0]
    if isinstance(K, np.ndarray):
        size = float(np.abs(K.diagonal() + damping).max())
        whole = np.zeros((count + rows, count + rows))
        whole[:count, :count], whole[:count, count:], whole[count:, :count] = K, -size * G.T, size * G
        whole[range(count), range(count)] += damping
        whole[range(count, count + rows), range(count, count + rows)] = 1e-11 * size

        def at_once(force: NDArray[np.float64]) -> NDArray[np.float64]:
            try:
                return np.linalg.solve(whole, np.concatenate([np.ravel(force), np.zeros(rows)]))[:count]
            except np.linalg.LinAlgError:
                return np.full(count, np.nan)

        return at_once
    from scipy.sparse import block_array, eye_array
    from scipy.sparse.linalg import splu

    A = (K + damping * eye_array(count, format="csc")).tocsc()
    if rows:
        size = float(np.abs(A.diagonal()).max())
        soft = 1e-11 * size * eye_array(rows, format="csc")
        A = block_array([[A, -size * G.T], [size * G, soft]], format="csc")
    try:
        solve = splu(A).solve
    except RuntimeError:  # exactly singular
        return lambda _: np.full(count, np.nan)

    def along(force: NDArray[np.float64]) -> NDArray[np.float64]:
        return solve(np.concatenate([np.ravel(force), np.zeros(rows)]))[:count]

    return along
