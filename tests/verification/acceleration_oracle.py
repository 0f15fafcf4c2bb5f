"""A multibody program of its own, by accelerations: what random scenes are compared with.

Bodies have positions of their centres of mass and quaternions, all axes are those of the world, joints are rows of
points, directions and travels with their second rates in closed form, and forces are functions. In every evaluation

    [M  J^T] [a     ]   [f - gyroscopic]
    [J  0  ] [lambda] = [-rates of J   ]

is solved by least squares, which redundant rows do not mind, and `scipy.integrate.DOP853` goes on from there. Nothing
is shared with the solver: no midpoint, no impulse, no row of velocities.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

GROUND = -1


@dataclass(frozen=True)
class Body:
    """Mass [kg], inertia about the centre of mass in body axes [kg m^2], and where it starts."""

    mass: float
    inertia: NDArray[np.float64]
    position: NDArray[np.float64]
    rotation: NDArray[np.float64]
    """Body to world, shape (3, 3)."""
    velocity: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    spin: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    """World axes [rad/s]."""


@dataclass(frozen=True)
class Row:
    """One equation between two bodies.

    Attributes
    ----------
    sides
        Numbers of bodies, `GROUND` for the world.
    points
        In the axes of each body from its centre of mass; of the ground in the world.
    first, second
        A direction on a and one on b. ``"dot"``: they are perpendicular. ``"travel"``: the way from point a to
        point b has nothing along the first. ``"point"``: nor along this direction of the world, which is `first`.
    """

    kind: str
    sides: tuple[int, int]
    points: tuple[NDArray[np.float64], NDArray[np.float64]]
    first: NDArray[np.float64]
    second: NDArray[np.float64]


@dataclass(frozen=True)
class Pull:
    """Elastic rope between two points: tension ``max(0, EA (s/l - 1) + c s')`` while it is taut."""

    sides: tuple[int, int]
    points: tuple[NDArray[np.float64], NDArray[np.float64]]
    length: float
    axial_stiffness: float
    damping: float = 0.0


class State:
    """Poses and velocities of all bodies, unpacked."""

    def __init__(self, model: Model, y: NDArray[np.float64]) -> None:
        n = len(model.bodies)
        y = y.reshape(n, 13)
        self.x, self.v, self.w = y[:, :3], y[:, 7:10], y[:, 10:]
        q = y[:, 3:7] / np.linalg.norm(y[:, 3:7], axis=1)[:, None]
        self.q = q
        self.R = Rotation.from_quat(q, scalar_first=True).as_matrix()

    def place(self, body: int, point: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """Arm, place, velocity and centripetal acceleration of a point."""
        if body == GROUND:
            return np.zeros(3), point, np.zeros(3), np.zeros(3)
        r, w = self.R[body] @ point, self.w[body]
        across = np.cross(w, r)
        return r, self.x[body] + r, self.v[body] + across, np.cross(w, across)

    def along(self, body: int, direction: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """A direction, its rate and the part of its second rate that has no angular acceleration."""
        if body == GROUND:
            return direction, np.zeros(3), np.zeros(3)
        u, w = self.R[body] @ direction, self.w[body]
        rate = np.cross(w, u)
        return u, rate, np.cross(w, rate)


@dataclass(frozen=True)
class Model:
    """Bodies, rows, ropes, gravity [m/s^2], and further forces by functions of the state: shape (bodies, 6)."""

    bodies: Sequence[Body]
    rows: Sequence[Row] = ()
    pulls: Sequence[Pull] = ()
    gravity: NDArray[np.float64] = field(default_factory=lambda: np.array([0.0, 0.0, -9.81]))
    loads: Sequence[Callable[[State], NDArray[np.float64]]] = ()

    def start(self) -> NDArray[np.float64]:
        """Where it begins, shape (13 bodies,)."""
        return np.concatenate(
            [
                np.r_[
                    b.position,
                    Rotation.from_matrix(b.rotation).as_quat(scalar_first=True),
                    b.velocity,
                    b.spin,
                ]
                for b in self.bodies
            ]
        )

    def _row(self, row: Row, s: State) -> tuple[float, NDArray[np.float64], float]:
        """Residual, its row of J, shape (6 bodies,), and what its second rate has beside J a."""
        a, b = row.sides
        J = np.zeros((len(self.bodies), 6))
        ra, xa, va, ca = s.place(a, row.points[0])
        rb, xb, vb, cb = s.place(b, row.points[1])
        d, dd, cc = xb - xa, vb - va, cb - ca
        u, du, cu = s.along(a if row.kind != "point" else GROUND, row.first)
        if row.kind == "dot":
            w, dw, cw = s.along(b, row.second)
            value, beside = u @ w, cu @ w + 2.0 * du @ dw + u @ cw
            if a != GROUND:
                J[a, 3:] += np.cross(u, w)
            if b != GROUND:
                J[b, 3:] += np.cross(w, u)
            return float(value), J.ravel(), float(beside)
        value, beside = u @ d, cu @ d + 2.0 * du @ dd + u @ cc
        if a != GROUND:
            J[a, :3] -= u
            J[a, 3:] -= np.cross(ra, u)
            if row.kind == "travel":
                J[a, 3:] += np.cross(u, d)
        if b != GROUND:
            J[b, :3] += u
            J[b, 3:] += np.cross(rb, u)
        return float(value), J.ravel(), float(beside)

    def constraints(self, s: State) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Residuals, Jacobian, and second rates beside it."""
        if not self.rows:
            return np.zeros(0), np.zeros((0, 6 * len(self.bodies))), np.zeros(0)
        parts = [self._row(row, s) for row in self.rows]
        return (
            np.array([p[0] for p in parts]),
            np.array([p[1] for p in parts]),
            np.array([p[2] for p in parts]),
        )

    def tension(
        self, pull: Pull, s: State
    ) -> tuple[float, NDArray[np.float64], tuple[NDArray[np.float64], ...]]:
        """Tension, unit vector from a to b, and the arms of both ends."""
        ra, xa, va, _ = s.place(pull.sides[0], pull.points[0])
        rb, xb, vb, _ = s.place(pull.sides[1], pull.points[1])
        way = xb - xa
        length = float(np.linalg.norm(way))
        e = way / length
        stretch = length - pull.length
        if stretch <= 0.0:
            return 0.0, e, (ra, rb)
        return (
            max(0.0, pull.axial_stiffness * stretch / pull.length + pull.damping * float(e @ (vb - va))),
            e,
            (ra, rb),
        )

    def forces(self, s: State) -> NDArray[np.float64]:
        """Forces and moments about the centres of mass, world axes, shape (bodies, 6)."""
        f = np.zeros((len(self.bodies), 6))
        for i, body in enumerate(self.bodies):
            f[i, :3] = body.mass * self.gravity
        for pull in self.pulls:
            T, e, arms = self.tension(pull, s)
            for side, arm, sign in zip(pull.sides, arms, (1.0, -1.0), strict=True):
                if side != GROUND:
                    f[side, :3] += sign * T * e
                    f[side, 3:] += np.cross(arm, sign * T * e)
        for load in self.loads:
            f += load(s)
        return f

    def masses(self, s: State) -> NDArray[np.float64]:
        """Mass matrix in world axes."""
        n = len(self.bodies)
        M = np.zeros((6 * n, 6 * n))
        for i, body in enumerate(self.bodies):
            M[6 * i : 6 * i + 3, 6 * i : 6 * i + 3] = body.mass * np.eye(3)
            M[6 * i + 3 : 6 * i + 6, 6 * i + 3 : 6 * i + 6] = s.R[i] @ body.inertia @ s.R[i].T
        return M

    def rate(self, _time: float, y: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rates of the state."""
        s = State(self, y)
        n = len(self.bodies)
        M, f = self.masses(s), self.forces(s)
        for i in range(n):
            f[i, 3:] -= np.cross(s.w[i], M[6 * i + 3 : 6 * i + 6, 6 * i + 3 : 6 * i + 6] @ s.w[i])
        _, J, beside = self.constraints(s)
        acceleration = constrained(M, J, f.ravel(), -beside)[: 6 * n].reshape(n, 6)
        out = np.empty((n, 13))
        out[:, :3] = s.v
        q = y.reshape(n, 13)[:, 3:7]
        w = np.column_stack([np.zeros(n), s.w])
        out[:, 3:7] = 0.5 * _product(w, q)
        out[:, 7:] = acceleration
        return out.ravel()

    def consistent(self) -> NDArray[np.float64]:
        """The start with the velocities that are nearest, by kinetic energy, to those told."""
        y = self.start()
        s = State(self, y)
        n = len(self.bodies)
        M = self.masses(s)
        _, J, _ = self.constraints(s)
        u = np.hstack([s.v, s.w]).ravel()
        y = y.reshape(n, 13).copy()
        y[:, 7:] = constrained(M, J, M @ u, np.zeros(len(J)))[: 6 * n].reshape(n, 6)
        return y.ravel()

    def run(self, times: NDArray[np.float64], *, tolerance: float = 1e-10) -> NDArray[np.float64]:
        """States at the times, shape (times, bodies, 13)."""
        y = self.consistent()
        found = solve_ivp(
            self.rate, (0.0, float(times[-1])), y, "DOP853", times, rtol=tolerance, atol=1e-2 * tolerance
        )
        assert found.success, found.message
        return found.y.T.reshape(len(times), len(self.bodies), 13)

    def energy(self, y: NDArray[np.float64]) -> float:
        """Kinetic energy, that of the weights and that of the ropes [J]."""
        s = State(self, y.ravel())
        u = np.hstack([s.v, s.w]).ravel()
        total = 0.5 * float(u @ self.masses(s) @ u)
        total -= sum(b.mass * float(self.gravity @ s.x[i]) for i, b in enumerate(self.bodies))
        for pull in self.pulls:
            way = s.place(pull.sides[1], pull.points[1])[1] - s.place(pull.sides[0], pull.points[0])[1]
            stretch = max(0.0, float(np.linalg.norm(way)) - pull.length)
            total += 0.5 * pull.axial_stiffness / pull.length * stretch**2
        return total


def constrained(
    M: NDArray[np.float64], J: NDArray[np.float64], f: NDArray[np.float64], g: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Accelerations and multipliers of ``M a + J^T m = f``, ``J a = g``; of redundant rows the smallest multipliers."""
    if not len(J):
        return np.linalg.solve(M, f)
    scale = 1.0 / np.sqrt(
        np.diag(M)
    )  # rows and unknowns of one size, or the least squares see only the heavy ones
    inverse = scale[:, None] * np.linalg.inv(scale[:, None] * M * scale) * scale
    response = J @ inverse @ J.T
    size = 1.0 / np.sqrt(np.diag(response))
    S = size[:, None] * response * size
    m = size * np.linalg.lstsq(S, size * (J @ inverse @ f - g), rcond=1e-10)[0]
    return np.concatenate([inverse @ (f - J.T @ m), m])


def _product(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Products of quaternions, scalar first, shape (n, 4)."""
    v, w = a[:, 1:], b[:, 1:]
    scalar = a[:, 0] * b[:, 0] - (v * w).sum(axis=1)
    return np.column_stack([scalar, a[:, :1] * w + b[:, :1] * v + np.cross(v, w)])


def joint_rows(
    kind: str,
    sides: tuple[int, int],
    points: tuple[NDArray[np.float64], NDArray[np.float64]],
    axes: tuple[NDArray[np.float64], NDArray[np.float64]],
) -> list[Row]:
    """Rows of a joint whose frames have these axes, columns x, y, z, in the axes of each body."""
    A, B = axes
    x, y, z = np.eye(3)

    def point() -> list[Row]:
        return [Row("point", sides, points, e, e) for e in (x, y, z)]

    def travel(*which: int) -> list[Row]:
        return [Row("travel", sides, points, A[:, k], A[:, k]) for k in which]

    def square(*pairs: tuple[int, int]) -> list[Row]:
        return [Row("dot", sides, points, A[:, i], B[:, j]) for i, j in pairs]

    parallel = square((2, 0), (2, 1))
    return {
        "ball": point,
        "fixed": lambda: point() + parallel + square((0, 1)),
        "hinge": lambda: point() + parallel,
        "universal": lambda: point() + square((2, 2)),
        "cylindrical": lambda: travel(0, 1) + parallel,
        "slider": lambda: travel(0, 1) + parallel + square((0, 1)),
        "planar": lambda: travel(2) + parallel,
    }[kind]()
