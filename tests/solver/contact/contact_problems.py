"""Contact problems for tests and benchmarks, and checks of solutions that share nothing with the solver."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.records import Records, records
from heavylift.solver.contact.layout import (
    UNILATERAL,
    Problem,
    ProblemSize,
    RowKind,
    RowParameters,
    Solution,
)
from heavylift.solver.contact.solve.newton import NonsmoothNewton, solve_contacts
from heavylift.solver.contact.solve.problem import make_work

Array = NDArray[np.float64]


@dataclass(eq=False)
class ContactProblem:
    """Arrays of a problem; N and W in full for the checks."""

    kinds: Records[RowKind]
    parameters: Records[RowParameters]
    ends: NDArray[np.int64]
    blocks: Array
    y0: Array
    B: Array
    N: Array
    least_rate: float = 0.0

    @property
    def count(self) -> int:
        return len(self.kinds)

    @property
    def W(self) -> Array:
        return self.N @ self.B @ self.N.T

    def packed(self, on_rows: bool = False) -> Problem:
        """For the solver, on velocities or on the matrix of the rows; what it works on has no numbers yet."""
        size = 3 * self.count if on_rows else len(self.y0)
        work = make_work(self.count, size)
        for array in work:
            if isinstance(array, np.ndarray):
                array[:] = np.nan
        counts = ProblemSize.one()
        counts.number, counts.size, counts.least_rate = self.count, size, self.least_rate
        counts.free_rate = np.abs(self.N @ self.y0).max()
        return Problem(
            counts=counts,
            kinds=self.kinds,
            parameters=self.parameters,
            ends=self.ends[:0] if on_rows else self.ends,
            blocks=self.blocks[:0] if on_rows else self.blocks,
            start=self.N @ self.y0 if on_rows else self.y0,
            B=self.W if on_rows else self.B,
            head=np.zeros(0, dtype=np.int64),
            past=np.zeros(0, dtype=np.int64),
            p=np.zeros(3 * self.count),
            y=np.zeros(size),
            work=work,
            solution=Solution.one(),
        )

    def solve(self, start: Array | None = None) -> tuple[int, int, float, Array, Array]:
        """On velocities: status, iterations, residual, impulses and rates, (count, 3) each."""
        found = self._solve(False, start)
        rates = (self.N @ found.y).reshape(-1, 3)
        return *_ended(found), found.p.reshape(-1, 3), rates

    def solve_rows(self, start: Array | None = None) -> tuple[int, int, float, Array, Array]:
        """The same on the matrix of the rows."""
        found = self._solve(True, start)
        return *_ended(found), found.p.reshape(-1, 3), found.y.reshape(-1, 3)

    def _solve(self, on_rows: bool, start: Array | None) -> Problem:
        problem = self.packed(on_rows)
        if start is not None:
            problem.p[:] = start.ravel()
        solve_contacts((NonsmoothNewton(),), problem)
        return problem


def _ended(problem: Problem) -> tuple[int, int, float]:
    """Status, iterations, residual."""
    return problem.solution.status, problem.solution.iterations, problem.solution.residual


def violation(problem: ContactProblem, p: Array, w: Array) -> float:
    """Largest violation of the laws of unilateral contacts: rates relative to the largest rate."""
    parameters = problem.parameters
    mu, P = parameters["friction"], p + parameters["offset"]
    g = w + parameters["softness"] * p - parameters["target"]
    w0 = (problem.N @ problem.y0).reshape(-1, 3)
    scale = max(np.abs(w0).max(), np.abs(w - w0).max())
    d = problem.W.diagonal().reshape(-1, 3)
    tangent = d[:, 1:].mean(axis=1)
    normal = np.abs(np.minimum(P[:, 0] * d[:, 0], g[:, 0]))
    bound = mu * np.maximum(P[:, 0], 0.0)
    trial = P[:, 1:] - g[:, 1:] / tangent[:, None]
    size = np.hypot(trial[:, 0], trial[:, 1])
    cut = np.where(size > bound, bound / np.maximum(size, 1e-300), 1.0)
    slip = np.abs(P[:, 1:] - cut[:, None] * trial) * tangent[:, None]
    return float(max(normal.max(), slip.max()) / scale)


def frame_about(normal: Array) -> Array:
    """Rows: the unit normal and two tangents."""
    n = normal / np.linalg.norm(normal)
    t = np.cross(n, [1.0, 0.0, 0.0] if abs(n[0]) < 0.7 else [0.0, 1.0, 0.0])
    t /= np.linalg.norm(t)
    return np.array([n, t, np.cross(n, t)])


def skew(a: Array) -> Array:
    """Matrix of the vector product with a."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def rows_at(frame: Array, arm: Array) -> Array:
    """Rates along the axes of a frame of a point of a rigid body by its velocity and spin."""
    return np.hstack([frame, -frame @ skew(arm)])


def build(
    contacts: list[list[tuple[int, Array]]], y0: Array, B: Array, mu: float, softness: float = 1e-7
) -> ContactProblem:
    """Unilateral contacts from the blocks of their ends, softness relative to W."""
    count, size = len(contacts), len(y0)
    kinds, parameters = records(RowKind, count), records(RowParameters, count)
    ends, blocks, N = (
        np.zeros((count, 4), np.int64),
        np.full((count, 36), np.nan),
        np.zeros((3 * count, size)),
    )
    kinds["kind"], parameters["friction"] = UNILATERAL, mu
    for c, parts in enumerate(contacts):
        for end, (first, block) in enumerate(parts):
            width = block.shape[1]
            ends[c, 2 * end : 2 * end + 2] = first, width
            blocks[c, 18 * end : 18 * end + 18].reshape(3, 6)[:, :width] = block
            N[3 * c : 3 * c + 3, first : first + width] += block
    d = (N @ B @ N.T).diagonal().reshape(-1, 3)
    parameters["softness"][:, 0] = softness * d[:, 0]
    parameters["softness"][:, 1] = parameters["softness"][:, 2] = softness * d[:, 1:].mean(axis=1)
    return ContactProblem(kinds, parameters, ends, blocks, y0, B, N)


def inverse_masses(masses: Array, half: Array) -> Array:
    """Of boxes with half edges, 6 velocities each."""
    square = half**2
    inertia = np.array([square[1] + square[2], square[0] + square[2], square[0] + square[1]]) / 3.0
    return np.diag(np.concatenate([[1.0 / m] * 3 + list(1.0 / (m * inertia)) for m in masses]))


UP = frame_about(np.array([0.0, 0.0, 1.0]))
BOX = np.array([1.0, 0.15, 0.15])


def stack(count: int, rng: np.random.Generator, push: float, mu: float = 0.3) -> ContactProblem:
    """Boxes of 1 t upon each other, four corner contacts between them, gravity of 10 ms and random pushes [m/s]."""
    contacts = []
    for i in range(count):
        for x in (-1.0, 1.0):
            for y in (-1.0, 1.0):
                parts = [(6 * i, rows_at(UP, BOX * [x, y, -1.0]))]
                if i > 0:
                    parts.append((6 * i - 6, -rows_at(UP, BOX * [x, y, 1.0])))
                contacts.append(parts)
    y0 = push * rng.normal(size=6 * count)
    y0[2::6] -= 0.0981
    return build(contacts, y0, inverse_masses(np.full(count, 1000.0), BOX), mu)


def chain(count: int, rng: np.random.Generator, push: float, mu: float = 0.3) -> ContactProblem:
    """Boxes of 1 t in a row on the ground, joined by balls (B is singular), four corner contacts each."""
    free = inverse_masses(np.full(count, 1000.0), BOX)
    G = np.zeros((3 * (count - 1), 6 * count))
    arm = np.array([1.0, 0.0, 0.0])
    for i in range(count - 1):
        G[3 * i : 3 * i + 3, 6 * i : 6 * i + 6] = rows_at(np.eye(3), arm)
        G[3 * i : 3 * i + 3, 6 * i + 6 : 6 * i + 12] = -rows_at(np.eye(3), -arm)
    lost = free @ G.T
    B = free - lost @ np.linalg.solve(G @ lost, lost.T)
    contacts = [
        [(6 * i, rows_at(UP, BOX * [x, y, -1.0]))]
        for i in range(count)
        for x in (-1.0, 1.0)
        for y in (-1.0, 1.0)
    ]
    y0 = push * rng.normal(size=6 * count)
    y0[2::6] -= 0.0981
    y0 = B @ np.linalg.solve(free, y0)  # joints stay closed
    return build(contacts, y0, 0.5 * (B + B.T), mu)


def wall(
    courses: int,
    width: int,
    rng: np.random.Generator,
    noise: float,
    mu: float = 0.5,
    step: float = 1e-3,
) -> ContactProblem:
    """Bricks of 2 x 1 x 1 m and 100 kg in half bond, four points where two meet, gravity of half a step.

    Targets are noise [m/s], which no rigid motion fits; residuals are measured by 1 mm a step at least.
    """
    half, contacts = np.array([1.0, 0.5, 0.5]), []
    places = [(2.0 * i + course % 2, course) for course in range(courses) for i in range(width)]
    for k, (x, course) in enumerate(places):
        below = [(i, y) for i, (y, other) in enumerate(places) if other == course - 1 and abs(x - y) < 1.5]
        for i, y in below or [(None, x)]:
            for point in (max(x, y) - 1.0, min(x, y) + 1.0):
                for depth in (-0.5, 0.5):
                    parts = [(6 * k, rows_at(UP, np.array([point - x, depth, -0.5])))]
                    if i is not None:
                        parts.append((6 * i, -rows_at(UP, np.array([point - y, depth, 0.5]))))
                    contacts.append(parts)
    y0 = np.zeros(6 * len(places))
    y0[2::6] = -0.5 * step * 9.81
    found = build(contacts, y0, inverse_masses(np.full(len(places), 100.0), half), mu, 1e-9)
    found.parameters["target"][:] = noise * rng.normal(size=found.parameters["target"].shape)
    found.least_rate = 1e-3 / step
    return found


def resting(rng: np.random.Generator, count: int = 20) -> ContactProblem:
    """Boxes of masses over six decades on the ground and on each other, redundant contacts, pushed and spun."""
    bodies = int(rng.integers(1, 6))
    half = np.array([1.0, 0.4, 0.3])
    contacts = []
    for i in range(count):
        k = i % bodies
        arm = rng.choice([-1.0, 1.0], 3) if rng.random() < 0.7 else rng.uniform(-1.0, 1.0, 3)
        arm = half * [arm[0], arm[1], -1.0]
        parts = [(6 * k, rows_at(UP, arm))]
        if k > 0 and rng.random() < 0.6:
            parts.append((6 * k - 6, -rows_at(UP, arm * [1.0, 1.0, -1.0])))
        contacts.append(parts)
    y0 = 10.0 ** rng.uniform(-3.0, 0.0) * rng.normal(size=6 * bodies)
    y0[2::6] -= 0.0981
    B = inverse_masses(10.0 ** rng.uniform(-3.0, 3.0, bodies), half)
    return build(contacts, y0, B, rng.choice([0.1, 0.3, 0.6, 1.0]), 10.0 ** rng.uniform(-8.0, -5.0))


def wedged(rng: np.random.Generator) -> ContactProblem:
    """Up to three bodies of masses over six decades, contacts in all directions, much friction, some overlaps."""
    bodies, count = int(rng.integers(1, 4)), int(rng.integers(1, 21))
    masses = 10.0 ** rng.uniform(-3.0, 3.0, bodies)
    B = np.diag(np.concatenate([[1.0 / m] * 3 + list(1.0 / (m * rng.uniform(0.05, 1.0, 3))) for m in masses]))
    contacts = []
    for _ in range(count):
        frame = frame_about(rng.normal(size=3)) if rng.random() < 0.5 else UP
        first, second = rng.integers(bodies, size=2)
        parts = [(6 * int(first), rows_at(frame, rng.uniform(-1.0, 1.0, 3)))]
        if first != second and rng.random() < 0.5:
            parts.append((6 * int(second), -rows_at(frame, rng.uniform(-1.0, 1.0, 3))))
        contacts.append(parts)
    problem = build(contacts, rng.normal(size=6 * bodies), B, 10.0 ** rng.uniform(-2.0, 0.3))
    if rng.random() < 0.3:
        problem.parameters["friction"] = rng.uniform(0.0, 1.5, count)
    if rng.random() < 0.3:
        problem.parameters["target"][:, 0] = 0.3 * rng.normal(size=count)
    return problem


def tank_in_hull(
    rng: np.random.Generator, count: int = 601, stiffness: float = 1e9, slide: float = 0.02
) -> ContactProblem:
    """Two bodies (1,000 and 10,000 t), contacts in 50 patches, most of them upright; softness of steps of 10 ms."""
    h, damping = 0.01, 0.02
    half = np.array([10.0, 5.0, 4.0])
    B = inverse_masses(np.array([1e6, 1e7]), half)
    contacts, gaps = [], np.zeros(count)
    places = [(x, y) for x in np.linspace(-9.0, 9.0, 10) for y in np.linspace(-4.5, 4.5, 5)]
    for c in range(count):
        arm = np.array([*places[c % 50], -4.0]) + rng.uniform(-0.2, 0.2, 3) * [1.0, 1.0, 0.0]
        tilt = 0.5 if rng.random() < 0.1 else 0.02
        frame = frame_about(np.array([*(tilt * rng.normal(size=2)), 1.0]))
        contacts.append([(0, rows_at(frame, arm)), (6, -rows_at(frame, arm + 8.0 * UP[0]))])
        gaps[c] = 1e-4 * rng.normal()
    y0 = np.zeros(12)
    y0[:3] = slide * rng.normal(), slide * rng.normal(), -0.15
    y0[3:6] = 0.002 * rng.normal(size=3)
    problem = build(contacts, y0, B, 0.3)
    weight = 1.0 / (1.0 + 4.0 * damping / h)
    problem.parameters["softness"][:, 0] = 4.0 * weight / (stiffness * h * h)
    problem.parameters["softness"][:, 1:3] = 1.5 * problem.parameters["softness"][:, :1]
    problem.parameters["target"][:, 0] = np.where(gaps > 0.0, -gaps / h, -4.0 * weight / h * gaps)
    return problem
