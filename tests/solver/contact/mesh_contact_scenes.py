"""Rigid bodies with surfaces of triangles that hit each other: scenes, runs, and closed forms of impacts."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.rotation import rotation_matrix
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.contacts import RigidLaw
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

G = 9.81
DOWN = (0.0, 0.0, -G)
MASS = 100.0


@dataclass(frozen=True, eq=False)
class Run:
    """Records of a run that went to its end, the start included."""

    times: NDArray[np.float64]
    records: NDArray[np.float64]
    simulation: Simulation

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Channel over time, shape (n,) or (n, components)."""
        for channel in self.simulation.channels:
            if channel.name == name:
                first = channel.column
                found = self.records[:, first : first + len(channel.components)]
                return found[:, 0] if found.shape[1] == 1 else found
        names = ", ".join(channel.name for channel in self.simulation.channels)
        raise KeyError(f"{name}: one of {names}")

    @property
    def drift(self) -> float:
        """Largest change of the energy balance [J]."""
        balance = self["energy.balance"]
        return float(np.abs(balance - balance[0]).max())

    @property
    def cpu(self) -> float:
        """CPU time of a step [s]."""
        return self.simulation.cpu_seconds / self.simulation.step_index


def run(scene: Scene, step: float, duration: float, **options: Any) -> Run:
    """Simulate from the start; the first record is that of the start."""
    simulation = Simulation(scene, step, **options)
    first = simulation.record()
    times, records = simulation.advance(round(duration / step))
    assert not simulation.outcome, simulation.message
    return Run(np.append(0.0, times), np.vstack([first, records]), simulation)


def turn(axis: Sequence[float], angle: float) -> NDArray[np.float64]:
    """Quaternion of a rotation."""
    n = np.asarray(axis, dtype=float)
    return np.append(np.cos(angle / 2.0), np.sin(angle / 2.0) * n / np.linalg.norm(n))


def body(
    name: str = "box",
    position: Sequence[float] = (0.0, 0.0, 0.0),
    *,
    mass: float = MASS,
    size: Sequence[float] | float = 1.0,
    inertia: Sequence[float] | float | None = None,
    velocity: Sequence[float] = (0.0, 0.0, 0.0),
    orientation: Sequence[float] = (1.0, 0.0, 0.0, 0.0),
    spin: Sequence[float] = (0.0, 0.0, 0.0),
) -> RigidBody:
    """With the inertia of a box of a size [m], or given principal moments [kg m2]."""
    x, y, z = np.broadcast_to(np.asarray(size, dtype=float) ** 2, 3)
    moments = mass / 12.0 * np.array([y + z, x + z, x + y]) if inertia is None else inertia
    return RigidBody(
        name=name,
        mass=mass,
        inertia=np.diag(np.broadcast_to(np.asarray(moments, dtype=float), 3)),
        position=np.array(position, dtype=float),
        velocity=np.array(velocity, dtype=float),
        orientation=np.array(orientation, dtype=float),
        angular_velocity=np.array(spin, dtype=float),
    )


def ball(name: str, position: Sequence[float], radius: float, **options: Any) -> RigidBody:
    """A solid ball."""
    mass = options.pop("mass", MASS)
    return body(name, position, mass=mass, inertia=0.4 * mass * radius**2, **options)


def scene(
    bodies: Iterable[tuple[RigidBody, TriangleSurface]],
    ground: TriangleSurface | None = None,
    pairs: Iterable[tuple[str, str]] | None = None,
    *,
    gravity: Sequence[float] = DOWN,
    swap: bool = False,
    events: bool = True,
    **options: Any,
) -> Scene:
    """Bodies with a surface each, named as they are, and one of the ground named "floor".

    All bodies hit the floor if no pairs are given, and the collision of two is named ``"<a>-<b>"``.
    """
    both = list(bodies)
    surfaces = [CollisionSurface(name=one.name, body=one.name, surface=skin) for one, skin in both]
    if ground is not None:
        surfaces.insert(0, CollisionSurface(name="floor", body="ground", surface=ground))
    wanted = [("floor", one.name) for one, _ in both] if pairs is None else list(pairs)
    options = {"law": RigidLaw(), **options}
    if isinstance(options["law"], RigidLaw):
        options["law"] = replace(options["law"], events=events)
    return Scene(
        bodies=tuple(one for one, _ in both),
        forces=(Gravity(np.array(gravity, dtype=float)),),
        surfaces=tuple(surfaces),
        collisions=tuple(
            Collision(name=f"{a}-{b}", surfaces=(b, a) if swap else (a, b), **options) for a, b in wanted
        ),
    )


def tilted(angle: float) -> NDArray[np.float64]:
    """Gravity of a plane that falls along x."""
    return G * np.array([np.sin(angle), 0.0, -np.cos(angle)])


def irregular_floor(half: float, count: int, seed: int = 1, *, reverse: float = 0.5) -> TriangleSurface:
    """Plane z = 0 in 2 count^2 triangles of random shapes, a share of them wound the other way."""
    random = np.random.default_rng(seed)
    line = np.linspace(-half, half, count + 1)
    x, y = np.meshgrid(line, line, indexing="ij")
    shake = 0.3 * (line[1] - line[0]) * random.uniform(-1.0, 1.0, (2, count + 1, count + 1))
    shake[:, [0, -1], :] = shake[:, :, [0, -1]] = 0.0
    points = np.stack([x + shake[0], y + shake[1], np.zeros_like(x)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(count), np.arange(count), indexing="ij")
    a = (i * (count + 1) + j).ravel()
    b, c, d = a + count + 1, a + count + 2, a + 1
    slash = random.random(len(a)) < 0.5
    first = np.where(slash[:, None], np.stack([a, b, c], 1), np.stack([a, b, d], 1))
    second = np.where(slash[:, None], np.stack([a, c, d], 1), np.stack([b, c, d], 1))
    triangles = np.vstack([first, second])
    turned = random.random(len(triangles)) < reverse
    triangles[turned] = triangles[turned][:, ::-1]
    return TriangleSurface(points, triangles[random.permutation(len(triangles))], 0.0, "floor")


def reversed_windings(surface: TriangleSurface) -> TriangleSurface:
    """The same triangles, wound the other way round."""
    return TriangleSurface(
        surface.points, np.ascontiguousarray(surface.triangles[:, ::-1]), surface.radius, surface.name
    )


def momenta(found: Run, scene: Scene) -> NDArray[np.float64]:
    """Momentum and angular momentum about the origin of all bodies over time, shape (n, 6)."""
    total = np.zeros((len(found.times), 6))
    for one in scene.bodies:
        p = one.mass * found[f"{one.name}.velocity"]
        spin = found[f"{one.name}.angular_velocity"]
        for i, q in enumerate(found[f"{one.name}.orientation"]):
            R = rotation_matrix(q)
            total[i, 3:] += R @ one.inertia @ spin[i]
        total[:, :3] += p
        total[:, 3:] += np.cross(found[f"{one.name}.position"], p)
    return total


def point_response(one: RigidBody, point: Sequence[float]) -> NDArray[np.float64]:
    """Velocity of a point [m, world] by an impulse in it, 3 x 3 [1/kg]: 1/m + [r]^T J^-1 [r]."""
    R = rotation_matrix(one.orientation)
    r = np.asarray(point) - one.position
    cross = np.array([[0.0, -r[2], r[1]], [r[2], 0.0, -r[0]], [-r[1], r[0], 0.0]])
    return np.eye(3) / one.mass - cross @ R @ np.linalg.inv(one.inertia) @ R.T @ cross


def after_impulse(
    one: RigidBody, point: Sequence[float], impulse: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Velocity in the world and angular velocity in the body after an impulse [N s] in a point."""
    R = rotation_matrix(one.orientation)
    moment = np.cross(np.asarray(point) - one.position, impulse)
    return one.velocity + impulse / one.mass, one.angular_velocity + np.linalg.solve(
        one.inertia, R.T @ moment
    )
