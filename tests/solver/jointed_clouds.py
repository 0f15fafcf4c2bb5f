"""Independent reference for jointed flexible bodies: clouds of point masses under D'Alembert's principle and rows.

The equations of each cloud are those of `point_masses`; joints are rows on points and directions, with their
second derivatives in the accelerations and multipliers as unknowns::

    M U' - G^T lambda = Q,    G U' = -gamma

integrated by DOP853 to 1e-11, at which the rows stay closed to far less than any step of the solver.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from point_masses import Array, System, matrix
from scipy.integrate import solve_ivp

GROUND = ""


@dataclass(frozen=True, eq=False)
class Pin:
    """A point of one cloud is a point of another: numbers of nodes; on the ground a world point [m]."""

    body_a: str
    node_a: Any
    body_b: str
    node_b: int


@dataclass(frozen=True, eq=False)
class Square:
    """A direction of one frame is square to a direction of another; body axes, world axes on the ground."""

    body_a: str
    direction_a: Array
    body_b: str
    direction_b: Array


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Clouds by name and rows between them."""

    systems: dict[str, System]
    rows: list[Pin | Square] = field(default_factory=list)

    def _states(self, time: float, y: Array) -> dict[str, tuple[Array, ...]]:
        """Position, rotation, velocity, body spin, q, q' of each."""
        out, at = {}, 0
        for name, system in self.systems.items():
            n = 13 + 2 * system.cloud.mode_count
            out[name] = system.unpack(time, y[at : at + n])
            at += n
        return out

    def starts(self) -> dict[str, int]:
        """First velocity of each."""
        widths = [6 + system.cloud.mode_count for system in self.systems.values()]
        return dict(zip(self.systems, np.concatenate([[0], np.cumsum(widths)]).tolist(), strict=False))

    @property
    def dof_count(self) -> int:
        return sum(6 + system.cloud.mode_count for system in self.systems.values())

    def velocity(self, time: float, y: Array) -> Array:
        """All U."""
        return np.concatenate([np.concatenate(s[2:4] + s[5:6]) for s in self._states(time, y).values()])

    def _vector(self, states: Any, body: str, what: Any, point: bool) -> tuple[Array, Array, Array, Array]:
        """Vector, rate, Jacobian over all U, second rate without accelerations."""
        J = np.zeros((3, self.dof_count))
        if body == GROUND:
            return np.asarray(what, dtype=float), np.zeros(3), J, np.zeros(3)
        x, R, v, w, q, qd = states[body]
        cloud, first = self.systems[body].cloud, self.starts()[body]
        window = slice(first, first + 6 + cloud.mode_count)
        if point:
            J[:, window] = cloud.jacobians(R, q)[what]
            place = x + R @ cloud.deformed(q)[what]
            bias = cloud.quadratic_accelerations(R, w, q, qd)[what]
            return place, J[:, window] @ np.concatenate([v, w, qd]), J, bias
        J[:, first + 3 : first + 6] = R @ np.cross(np.eye(3), what).T
        return R @ what, R @ np.cross(w, what), J, R @ np.cross(w, np.cross(w, what))

    def constraints(self, time: float, y: Array) -> tuple[Array, Array, Array]:
        """Residuals, Jacobian, second derivatives without accelerations."""
        states = self._states(time, y)
        g, G, gamma = [], [], []
        for row in self.rows:
            if isinstance(row, Pin):
                a = self._vector(states, row.body_a, row.node_a, True)
                b = self._vector(states, row.body_b, row.node_b, True)
                g.append(b[0] - a[0])
                G.append(b[2] - a[2])
                gamma.append(b[3] - a[3])
            else:
                a = self._vector(states, row.body_a, row.direction_a, False)
                b = self._vector(states, row.body_b, row.direction_b, False)
                g.append(np.array([a[0] @ b[0]]))
                G.append((a[0] @ b[2] + b[0] @ a[2])[None])
                gamma.append(np.array([a[0] @ b[3] + b[0] @ a[3] + 2.0 * a[1] @ b[1]]))
        return np.concatenate(g), np.concatenate(G), np.concatenate(gamma)

    def accelerations(self, time: float, y: Array) -> tuple[Array, Array]:
        """All U', and the multipliers."""
        count = self.dof_count
        M, Q, held, given = np.zeros((count, count)), np.zeros(count), np.zeros(count, bool), np.zeros(count)
        states = self._states(time, y)
        for (name, system), first in zip(self.systems.items(), self.starts().values(), strict=True):
            _, R, _, w, q, qd = states[name]
            cloud = system.cloud
            window = slice(first, first + 6 + cloud.mode_count)
            J = cloud.jacobians(R, q)
            M[window, window] = np.einsum("j,jai,jak->ik", cloud.masses, J, J)
            rest = system.gravity - cloud.quadratic_accelerations(R, w, q, qd)
            Q[window] = np.einsum("jai,j,ja->i", J, cloud.masses, rest)
            Q[first + 6 : window.stop] -= cloud.stiffness * q + system.damping * qd
            if system.motion is not None:
                held[first : first + 6] = True
                given[first : first + 6] = np.concatenate(system.prescribed(time)[4:])
        _, G, gamma = self.constraints(time, y)
        free = ~held
        rows = len(gamma)
        K = np.zeros((free.sum() + rows,) * 2)
        K[: -rows or None, : -rows or None] = M[np.ix_(free, free)]
        K[-rows:, : free.sum()] = G[:, free]
        K[: free.sum(), -rows:] = -G[:, free].T
        rhs = np.concatenate(
            [Q[free] - M[np.ix_(free, held)] @ given[held], -gamma - G[:, held] @ given[held]]
        )
        found = np.linalg.solve(K, rhs)
        out = given
        out[free] = found[: free.sum()]
        return out, found[free.sum() :]

    def derivative(self, time: float, y: Array) -> Array:
        """Of all state vectors."""
        rates, _ = self.accelerations(time, y)
        out = []
        for (name, state), first in zip(self._states(time, y).items(), self.starts().values(), strict=True):
            _, _, v, w, _, qd = state
            n = self.systems[name].cloud.mode_count
            at = sum(len(part) for part in out)
            q0, *vector = y[at + 3 : at + 7]
            turn = 0.5 * np.array([-np.dot(vector, w), *(q0 * w + np.cross(vector, w))])
            out.append(
                np.concatenate([v, turn, rates[first : first + 6], qd, rates[first + 6 : first + 6 + n]])
            )
        return np.concatenate(out)

    def start_vector(self) -> Array:
        """State at time zero."""
        return np.concatenate([system.start_vector()[:-3] for system in self.systems.values()])

    def solve(self, duration: float) -> Array:
        """State at the end."""
        return solve_ivp(
            self.derivative, (0.0, duration), self.start_vector(), method="DOP853", rtol=1e-10, atol=1e-11
        ).y[:, -1]

    def channels(self, time: float, y: Array) -> dict[str, Array]:
        """What the solver records: of the bodies, the reactions of those that are held, the forces of the pins."""
        out: dict[str, Array] = {}
        rates, multipliers = self.accelerations(time, y)
        joint_forces = self.constraints(time, y)[1].T @ multipliers
        at = 0
        for row in self.rows:
            if isinstance(row, Pin):
                out[f"{row.body_b} {row.node_b}.reaction_force"] = multipliers[at : at + 3]
            at += 3 if isinstance(row, Pin) else 1
        for name, (x, R, v, w, q, qd) in self._states(time, y).items():
            system, first = self.systems[name], self.starts()[name]
            cloud = system.cloud
            out |= {f"{name}.position": x, f"{name}.orientation": R, f"{name}.velocity": v}
            out |= {f"{name}.angular_velocity": w, f"{name}.modal_position": q, f"{name}.modal_velocity": qd}
            if system.motion is not None:
                own = rates[first : first + 6 + cloud.mode_count]
                accelerations = cloud.jacobians(R, q) @ own + cloud.quadratic_accelerations(R, w, q, qd)
                missing = cloud.masses[:, None] * (accelerations - system.gravity)
                moment = np.cross(cloud.deformed(q) @ R.T, missing).sum(axis=0)
                out[f"{name}.reaction_force"] = missing.sum(axis=0) - joint_forces[first : first + 3]
                out[f"{name}.reaction_moment"] = moment - R @ joint_forces[first + 3 : first + 6]
        return {name: values for name, values in out.items() if values.size}


def world_node(system: System, node: int) -> Array:
    """A node in the world at the start [m]."""
    start = system.start
    x, R = (
        (start.position, matrix(start.orientation)) if system.motion is None else system.prescribed(0.0)[:2]
    )
    return x + R @ system.cloud.deformed(start.q)[node]
