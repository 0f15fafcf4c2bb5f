"""Independent reference for flexible bodies: point masses that ride on a moving frame.

A body is a cloud of point masses at ``r_j = x + R (X_j + Phi_j q)``. Its equations of motion are
D'Alembert's principle, summed over the points one by one::

    sum_j J_j^T ( m_j r''_j - f_j - m_j g ) + ( 0, 0, k q + d q' ) = 0

with ``r'_j = J_j U``, ``r''_j = J_j U' + quadratic part``. No inertia shape integral, no mass matrix
of a floating frame and no momentum form is used. Integrated by DOP853 to 1e-11.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache, lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from heavylift.modal.invariants import shape_integrals
from heavylift.modal.reduced import ReducedBody
from heavylift.solver.forces.point import PointForce
from heavylift.solver.scene.scene import (
    Driven,
    Fixed,
    FlexibleBody,
    Gravity,
    Profile,
    RigidBody,
    Scene,
    Sensor,
)

Array = NDArray[np.float64]


def matrix(quaternion: Array) -> Array:
    """Rotation matrix of a quaternion, scalar first, of any length."""
    return Rotation.from_quat(quaternion, scalar_first=True).as_matrix()


@dataclass(frozen=True, eq=False)
class Cloud:
    """Point masses [kg], shape (n,), places [m], shape (n, 3), shapes (nf, n, 3), stiffness (nf,)."""

    masses: Array
    nodes: Array
    shapes: Array
    stiffness: Array

    @property
    def mode_count(self) -> int:
        return len(self.stiffness)

    def reduced(self) -> ReducedBody:
        """What the solver is given."""
        mass = sparse.diags_array(self.masses).tocsr()
        integrals = shape_integrals(self.nodes, self.shapes, mass)
        coupling = np.abs(integrals.modal_translation).max(initial=0.0)
        labels = tuple(f"vector {i + 1}" for i in range(self.mode_count))
        return ReducedBody(
            self.nodes,
            self.stiffness,
            self.shapes,
            integrals,
            bool(coupling < 1e-9),
            labels,
            np.zeros(self.mode_count),
            0.0,
            continuum=False,
        )

    def deformed(self, q: Array) -> Array:
        """Places in the body frame [m], shape (n, 3)."""
        return self.nodes + np.tensordot(q, self.shapes, axes=1)

    def jacobians(self, R: Array, q: Array) -> Array:
        """Derivatives of the world velocities of the points by (v, w, q'), shape (n, 3, 6 + nf)."""
        u = self.deformed(q)
        J = np.zeros((len(u), 3, 6 + self.mode_count))
        J[:, :, :3] = np.eye(3)
        for axis in range(3):
            J[:, :, 3 + axis] = np.cross(np.eye(3)[axis], u) @ R.T
        J[:, :, 6:] = np.einsum("ab,ijb->jai", R, self.shapes)
        return J

    def quadratic_accelerations(self, R: Array, w: Array, q: Array, qd: Array) -> Array:
        """World accelerations of the points while (v', w', q'') = 0, shape (n, 3)."""
        u, ud = self.deformed(q), np.tensordot(qd, self.shapes, axes=1)
        return (np.cross(w, np.cross(w, u)) + 2.0 * np.cross(w, ud)) @ R.T

    def mass_matrix(self, R: Array, q: Array) -> Array:
        """Of (v, w, q'), shape (6 + nf, 6 + nf)."""
        J = self.jacobians(R, q)
        return np.einsum("j,jai,jak->ik", self.masses, J, J)


def make_cloud(
    *,
    modes: int = 5,
    count: int = 24,
    seed: int = 1,
    rigid_part: float = 0.0,
    centred: bool = False,
    frequencies: tuple[float, float] = (3.0, 12.0),
) -> Cloud:
    """Random body of 5 kg and half a metre with mass-normalised random shapes.

    Parameters
    ----------
    modes, count, seed
        Numbers of shapes and of points; seed of the generator.
    rigid_part
        How much rigid motion is left in the shapes: 0 makes them mean-axis shapes.
    centred
        Whether the frame origin is the centre of mass.
    frequencies
        Lowest and highest natural frequency [Hz] with the frame held.
    """
    rng = np.random.default_rng(seed)
    nodes = rng.normal(size=(count, 3)) * [0.5, 0.2, 0.1] + [0.3, 0.1, -0.05]
    masses = rng.uniform(0.5, 1.5, count)
    masses *= 5.0 / masses.sum()
    if centred:
        nodes = nodes - masses @ nodes / masses.sum()
    raw = rng.normal(size=(3 * count, modes))
    rigid = np.zeros((3 * count, 6))
    for axis in range(3):
        rigid[axis::3, axis] = 1.0
        rigid[:, 3 + axis] = np.cross(np.eye(3)[axis], nodes).ravel()
    M = np.repeat(masses, 3)[:, None]
    share = np.linalg.solve(rigid.T @ (M * rigid), rigid.T @ (M * raw))
    raw = raw - (1.0 - rigid_part) * rigid @ share
    L = np.linalg.cholesky(raw.T @ (M * raw))
    shapes = np.linalg.solve(L, raw.T).reshape(modes, count, 3)
    stiffness = (2.0 * np.pi * np.linspace(*frequencies, modes)) ** 2
    return Cloud(masses, nodes, np.ascontiguousarray(shapes), stiffness)


@dataclass(frozen=True, eq=False)
class Load:
    """Force on a point, linear between the rows of a table; in world axes or those of the frame."""

    node: int
    times: Array
    forces: Array
    frame: str = "world"

    def __call__(self, time: float) -> Array:
        return np.array([np.interp(time, self.times, self.forces[:, k]) for k in range(3)])


@cache
def _spline(profile: Profile) -> list[CubicSpline]:
    spline = CubicSpline(profile.times, profile.values, bc_type="clamped")
    return [spline, spline.derivative(1), spline.derivative(2)]


def profile_values(profile: Profile | None, time: float) -> Array:
    """Value, rate and second rate of a profile: scipy's clamped spline plus the harmonics."""
    out = np.zeros(3)
    if profile is None:
        return out
    if len(profile.times):
        inside = profile.times[0] <= time <= profile.times[-1]
        held = float(np.clip(time, profile.times[0], profile.times[-1]))
        value, rate, rate2 = (float(part(held)) for part in _spline(profile))
        out += [value, rate * inside, rate2 * inside]
    for h in profile.harmonics:
        omega = 2.0 * np.pi * h.frequency
        s, c = np.sin(omega * time + h.phase), np.cos(omega * time + h.phase)
        out += h.amplitude * np.array([s, omega * c, -omega * omega * s])
    return out


@dataclass(frozen=True, eq=False)
class Start:
    """Start state; the frame of a fixed or driven body gets its velocities from its motion."""

    position: Array
    orientation: Array
    velocity: Array
    spin: Array
    q: Array
    qd: Array


@dataclass(frozen=True, eq=False)
class System:
    """A cloud with damping [1/s], gravity [m/s2], loads, and a prescribed motion if it is not free."""

    cloud: Cloud
    start: Start
    motion: Any = None
    damping_ratio: Array = field(default_factory=lambda: np.zeros(0))
    gravity: Array = field(default_factory=lambda: np.zeros(3))
    loads: tuple[Load, ...] = ()
    sensor: int = 3
    tolerance: float = 1e-11

    @property
    def damping(self) -> Array:
        if not self.damping_ratio.size:
            return np.zeros(self.cloud.mode_count)
        return 2.0 * self.damping_ratio * np.sqrt(self.cloud.stiffness)

    def prescribed(self, time: float) -> tuple[Array, Array, Array, Array, Array, Array]:
        """Position, rotation matrix, velocity, body spin, acceleration, body spin rate of a held frame."""
        return _prescribed(self, time)

    def unpack(self, time: float, y: Array) -> tuple[Array, ...]:
        """Position, rotation, velocity, body spin, q, q' from a state vector."""
        n = self.cloud.mode_count
        q, qd = y[13 : 13 + n], y[13 + n : 13 + 2 * n]
        if self.motion is None:
            return y[:3], matrix(y[3:7]), y[7:10], y[10:13], q, qd
        x, R, v, w, _, _ = self.prescribed(time)
        return x, R, v, w, q, qd

    def node_forces(self, time: float, R: Array) -> Array:
        """Forces of the loads on the points, world axes [N], shape (n, 3)."""
        forces = np.zeros_like(self.cloud.nodes)
        for load in self.loads:
            forces[load.node] += load(time) if load.frame == "world" else R @ load(time)
        return forces

    def accelerations(self, time: float, y: Array) -> tuple[Array, Array, Array]:
        """U' = (v', w', q''), accelerations of the points, and the forces of the loads on them."""
        cloud = self.cloud
        _, R, _, w, q, qd = self.unpack(time, y)
        J = cloud.jacobians(R, q)
        M = np.einsum("j,jai,jak->ik", cloud.masses, J, J)
        quadratic = cloud.quadratic_accelerations(R, w, q, qd)
        forces = self.node_forces(time, R)
        given = forces + cloud.masses[:, None] * (self.gravity - quadratic)
        rhs = np.einsum("jai,ja->i", J, given)
        rhs[6:] -= cloud.stiffness * q + self.damping * qd
        if self.motion is None:
            rates = np.linalg.solve(M, rhs)
        else:
            frame = np.concatenate(self.prescribed(time)[4:])
            rates = np.concatenate([frame, np.linalg.solve(M[6:, 6:], rhs[6:] - M[6:, :6] @ frame)])
        return rates, J @ rates + quadratic, forces

    def reaction(self, time: float, y: Array) -> tuple[Array, Array]:
        """Force and moment about the frame origin, world axes, that the holder of the frame exerts."""
        _, R, _, _, q, _ = self.unpack(time, y)
        _, accelerations, forces = self.accelerations(time, y)
        missing = self.cloud.masses[:, None] * (accelerations - self.gravity) - forces
        return missing.sum(axis=0), np.cross(self.cloud.deformed(q) @ R.T, missing).sum(axis=0)

    def velocities(self, time: float, y: Array) -> tuple[Array, Array]:
        """World positions and velocities of the points, shape (n, 3) each."""
        x, R, v, w, q, qd = self.unpack(time, y)
        return x + self.cloud.deformed(q) @ R.T, self.cloud.jacobians(R, q) @ np.concatenate([v, w, qd])

    def energies(self, time: float, y: Array) -> tuple[float, float, float]:
        """Kinetic, elastic and potential energy [J]."""
        positions, velocities = self.velocities(time, y)
        q = self.unpack(time, y)[4]
        m = self.cloud.masses
        return (
            float(0.5 * m @ np.sum(velocities**2, axis=1)),
            float(0.5 * self.cloud.stiffness @ q**2),
            float(-m @ positions @ self.gravity),
        )

    def derivative(self, time: float, y: Array) -> Array:
        """Of (x, quaternion, v, w, q, q', external work, drive work, dissipated energy)."""
        n = self.cloud.mode_count
        rates, _, forces = self.accelerations(time, y)
        _, R, v, w, _, qd = self.unpack(time, y)
        _, velocities = self.velocities(time, y)
        q0, *vector = y[3:7]
        out = np.zeros_like(y)
        out[:3] = v
        out[3] = -0.5 * np.dot(vector, w)
        out[4:7] = 0.5 * (q0 * w + np.cross(vector, w))
        out[7:13] = rates[:6]
        out[13 : 13 + n] = qd
        out[13 + n : 13 + 2 * n] = rates[6:]
        out[-3] = np.sum(forces * velocities)
        if self.motion is not None:
            force, moment = self.reaction(time, y)
            out[-2] = force @ v + moment @ (R @ w)
        out[-1] = self.damping @ qd**2
        return out

    def start_vector(self) -> Array:
        """State vector at time zero."""
        s = self.start
        y = np.concatenate([s.position, s.orientation, s.velocity, s.spin, s.q, s.qd, np.zeros(3)])
        if self.motion is not None:
            x, R, v, w, _, _ = self.prescribed(0.0)
            y[:3], y[3:7] = x, Rotation.from_matrix(R).as_quat(scalar_first=True)
            y[7:10], y[10:13] = v, w
        return y

    def solve(self, duration: float) -> dict[str, Array]:
        """Channels at the end by name, without the name of the body: the kinks of tables are step ends."""
        kinks = {0.0, duration}
        tables = [load.times for load in self.loads]
        if isinstance(self.motion, Driven):
            tables += [p.times for p in self.motion.profiles if p is not None]
        for times in tables:
            kinks |= {float(t) for t in times if 0.0 < t < duration}
        edges = sorted(kinks)
        y = self.start_vector()
        for begin, end in pairwise(edges):
            y = solve_ivp(
                self.derivative, (begin, end), y, method="DOP853", rtol=self.tolerance, atol=1e-12
            ).y[:, -1]
        return self.channels(duration, y)

    def channels(self, time: float, y: Array) -> dict[str, Array]:
        """All quantities that the solver records as well."""
        x, R, v, w, q, qd = self.unpack(time, y)
        positions, velocities = self.velocities(time, y)
        kinetic, elastic, potential = self.energies(time, y)
        impulse = self.cloud.masses[:, None] * velocities
        force, moment = self.reaction(time, y)
        return {
            "position": x,
            "orientation": R,
            "velocity": v,
            "angular_velocity": w,
            "modal_position": q,
            "modal_velocity": qd,
            "sensor.position": positions[self.sensor],
            "sensor.velocity": velocities[self.sensor],
            "energy.kinetic": np.array([kinetic]),
            "energy.elastic": np.array([elastic]),
            "energy.potential": np.array([potential]),
            "energy.external_work": y[-3:-2],
            "energy.drive_work": y[-2:-1],
            "energy.dissipated": y[-1:],
            "momentum.linear": impulse.sum(axis=0),
            "momentum.angular": np.cross(positions, impulse).sum(axis=0),
            "reaction_force": force,
            "reaction_moment": moment,
        }

    def scene(self, name: str = "body") -> Scene:
        """Return the same system for the solver; gravity and loads are always there, so that scenes share code."""
        start = self.start
        motion = {} if self.motion is None else {"motion": self.motion}
        body = FlexibleBody(
            name,
            self.cloud.reduced(),
            position=start.position,
            orientation=start.orientation,
            velocity=start.velocity,
            angular_velocity=start.spin,
            modal_position=start.q,
            modal_velocity=start.qd,
            damping_ratio=self.damping_ratio,
            **motion,
        )
        return self._scene(body)

    def rigid_scene(self, name: str = "body") -> Scene:
        """Return a cloud without modes as a rigid body."""
        start, cloud = self.start, self.cloud
        mass, centre = cloud.masses.sum(), cloud.masses @ cloud.nodes / cloud.masses.sum()
        arms = cloud.nodes - centre
        inertia = np.diag(np.full(3, cloud.masses @ np.sum(arms**2, axis=1))) - arms.T @ (
            cloud.masses[:, None] * arms
        )
        motion = {} if self.motion is None else {"motion": self.motion}
        body = RigidBody(
            name,
            float(mass),
            0.5 * (inertia + inertia.T),
            centre,
            position=start.position,
            orientation=start.orientation,
            velocity=start.velocity,
            angular_velocity=start.spin,
            **motion,
        )
        return self._scene(body)

    def _scene(self, body: FlexibleBody | RigidBody) -> Scene:
        loads = self.loads or (Load(0, np.zeros(1), np.zeros((1, 3))),)
        points = tuple(
            PointForce(f"load {i}", body.name, self.cloud.nodes[p.node], p.times, p.forces, p.frame)  # type: ignore[arg-type]
            for i, p in enumerate(loads)
        )
        sensor = Sensor("sensor", body.name, self.cloud.nodes[self.sensor])
        return Scene((body,), (Gravity(self.gravity), *points), (sensor,))


@lru_cache(maxsize=64)
def _prescribed(system: System, time: float) -> tuple[Array, Array, Array, Array, Array, Array]:
    """Position, rotation matrix, velocity, body spin, acceleration, body spin rate of a held frame."""
    x0, R0 = system.start.position, matrix(system.start.orientation)
    zero = np.zeros(3)
    if isinstance(system.motion, Fixed):
        return x0, R0, zero, zero, zero, zero
    axis = np.asarray(system.motion.axis, dtype=float)
    axis = axis / np.linalg.norm(axis)
    pivot = np.asarray(system.motion.pivot, dtype=float)
    phi, rate, rate2 = profile_values(system.motion.angle, time)
    moved = np.array([profile_values(profile, time) for profile in system.motion.profiles[:3]])
    Q = Rotation.from_rotvec(phi * axis).as_matrix()
    arm = Q @ (x0 - pivot)
    R = Q @ R0
    spin, spin_rate = rate * axis, rate2 * axis
    acceleration = moved[:, 2] + np.cross(spin_rate, arm) + np.cross(spin, np.cross(spin, arm))
    return (
        pivot + moved[:, 0] + arm,
        R,
        moved[:, 1] + np.cross(spin, arm),
        R.T @ spin,
        acceleration,
        R.T @ spin_rate,
    )


def channels_of(simulation: Any, row: Array, body: str = "body") -> dict[str, Array]:
    """Channels of one record by name, without the name of the body; the quaternion as a matrix."""
    out = {}
    for channel in simulation.channels:
        values = row[channel.column : channel.column + len(channel.components)]
        name = channel.name.removeprefix(f"{body}.")
        out[name] = matrix(values) if name == "orientation" else values
    return out


__all__ = [
    "Array",
    "Cloud",
    "Load",
    "Start",
    "System",
    "channels_of",
    "make_cloud",
    "matrix",
    "profile_values",
]
