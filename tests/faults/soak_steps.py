"""Fixed steps from a hundred in the shortest period that moves to one, in eight kinds of scenes: right, or told.

Each scene runs once with the step and once with steps that are finer by as much as it takes, recorded at the same
instants. Right are paths within 15 % of their extent and largest forces within 10 %: twenty steps in a period turn the
phase by 0.05 rad a period. A run that completes without a word and is not right is a failure.
"""

from __future__ import annotations

import math
import sys
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.contours.splines.neutral import neutral_surface
from heavylift.numerics.outcome import Outcome
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.forces.point import PointForce
from heavylift.solver.forces.spring import Spring
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.slider import Slider
from heavylift.solver.scene.connections import GROUND, JointFrame, Limits, RopePoint, axes_about
from heavylift.solver.scene.contacts import Contact, Contour, LinearLaw, SphereShape
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, Sea, Water
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["KINDS", "run"]

G = 9.81
DOWN = Gravity(np.array([0.0, 0.0, -G]))
PATH, FORCE = 0.15, 0.10
"""Errors that are right: of paths over their extent, of largest forces over themselves."""
FINEST = 200.0
"""Steps in the shortest period of the run that is compared with, twice as many as the finest that is tried."""


@dataclass(frozen=True)
class Trial:
    """A scene to be stepped.

    Attributes
    ----------
    scene
        The scene.
    shortest
        Shortest period that moves [s].
    duration
        Of the run [s].
    paths, forces
        Channels to be compared: at records, and by their extremes over all steps.
    start
        As of a simulation.
    """

    scene: Scene
    shortest: float
    duration: float
    paths: tuple[str, ...]
    forces: tuple[str, ...] = ()
    start: Any = "check"


def _body(
    name: str, mass: float, position: Any, velocity: Any = (0.0, 0.0, 0.0), size: float = 1.0
) -> RigidBody:
    return RigidBody(
        name,
        mass,
        mass * size**2 * np.diag([0.3, 0.35, 0.4]),
        position=np.array(position, dtype=float),
        velocity=np.array(velocity, dtype=float),
    )


def _at(body: str, point: Any = (0.0, 0.0, 0.0)) -> RopePoint:
    return RopePoint(body, np.array(point, dtype=float))


def bounce(rng: np.random.Generator) -> Trial:
    """A load that falls into a rope and bounces."""
    mass, length, drop = 10.0 ** rng.uniform(2, 5), rng.uniform(2, 30), rng.uniform(0.1, 2.0)
    period = rng.uniform(0.1, 1.0)
    stiffness = mass * (2.0 * math.pi / period) ** 2
    rope = Rope(
        name="rope", path=(_at(GROUND), _at("load")), axial_stiffness=stiffness * length, length=length
    )
    load = _body("load", mass, (0.0, 0.0, drop - length))
    fall = math.sqrt(2.0 * drop / G)
    return Trial(
        Scene((load,), (DOWN,), ropes=(rope,)),
        period,
        2.0 * (2.0 * fall + 0.7 * period),
        ("load.position",),
        ("rope.tension",),
    )


def swing(rng: np.random.Generator) -> Trial:
    """A load that swings on a stiff rope, hung up in its weight."""
    mass, length, angle = 10.0 ** rng.uniform(2, 5), rng.uniform(2, 40), rng.uniform(0.1, 0.9)
    stiffness = mass * G * 10.0 ** rng.uniform(2.5, 4.5)
    stretched = length * (1.0 + mass * G * math.cos(angle) / stiffness)
    load = _body("load", mass, stretched * np.array([math.sin(angle), 0.0, -math.cos(angle)]))
    rope = Rope(name="rope", path=(_at(GROUND), _at("load")), axial_stiffness=stiffness, length=length)
    period = 2.0 * math.pi * math.sqrt(length / G)
    return Trial(
        Scene((load,), (DOWN,), ropes=(rope,)), period, 2.0 * period, ("load.position",), ("rope.tension",)
    )


def lift(rng: np.random.Generator) -> Trial:
    """A module on four slings below a hook on its hoist, at rest, and pushed aside."""
    mass, half, high = 10.0 ** rng.uniform(3, 5.5), rng.uniform(2, 8, 2), rng.uniform(5, 15)
    length, push = rng.uniform(10, 40), rng.uniform(0.05, 0.5)
    stiffness = mass * G * 10.0 ** rng.uniform(2.0, 3.5)
    module = RigidBody(
        "module",
        mass,
        mass / 3.0 * np.diag([half[1] ** 2 + 1.0, half[0] ** 2 + 1.0, half @ half]),
    )
    hook = _body("hook", 0.05 * mass, (0.0, 0.0, high))
    top = high + length
    period = 2.0 * math.pi * math.sqrt(top / G)
    ropes = [
        Rope(name="hoist", path=(_at(GROUND, (0.0, 0.0, top)), _at("hook")), axial_stiffness=2.0 * stiffness)
    ]
    ropes += [
        Rope(
            name=f"sling_{i}",
            path=(_at("hook"), _at("module", (x * half[0], y * half[1], 0.0))),
            axial_stiffness=stiffness,
        )
        for i, (x, y) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1)))
    ]
    grown = mass * G * push * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    wind = PointForce("wind", "module", np.zeros(3), times=period * np.array([0.0, 0.3, 0.6]), forces=grown)
    return Trial(
        Scene((module, hook), (DOWN, wind), ropes=tuple(ropes)),
        period / 2.5,  # the hook swings against the module
        1.5 * period,
        ("module.position", "hook.position"),
        ("hoist.tension",),
        "equilibrium",
    )


def links(rng: np.random.Generator) -> Trial:
    """Two rods on hinges that swing."""
    lengths, masses, angle = rng.uniform(0.5, 10, 2), 10.0 ** rng.uniform(1, 4, 2), rng.uniform(0.1, 0.8)
    along = np.array([math.sin(angle), 0.0, -math.cos(angle)])
    middle = [0.5 * lengths[0] * along, (lengths[0] + 0.5 * lengths[1]) * along]
    bodies = tuple(
        RigidBody(f"rod_{i}", masses[i], masses[i] * lengths[i] ** 2 / 12.0 * np.eye(3), position=middle[i])
        for i in range(2)
    )
    axes = axes_about(np.array([0.0, 1.0, 0.0]))
    ends = [(-0.5 * lengths[i] * along, 0.5 * lengths[i] * along) for i in range(2)]
    joints = (
        Hinge(
            name="top",
            body_a=GROUND,
            body_b="rod_0",
            frame_a=JointFrame(np.zeros(3), axes),
            frame_b=JointFrame(ends[0][0], axes),
        ),
        Hinge(
            name="knee",
            body_a="rod_0",
            body_b="rod_1",
            frame_a=JointFrame(ends[0][1], axes),
            frame_b=JointFrame(ends[1][0], axes),
        ),
    )
    slow = 2.0 * math.pi * math.sqrt(lengths.sum() / G)
    short = 2.0 * math.pi * math.sqrt(lengths.min() / G) / 2.0
    return Trial(Scene(bodies, (DOWN,), joints=joints), short, slow, ("rod_0.position", "rod_1.position"))


def spring(rng: np.random.Generator) -> Trial:
    """A load between springs, one of them by a table, in all directions."""
    mass, period = 10.0 ** rng.uniform(0, 5), 10.0 ** rng.uniform(-1, 1)
    stiffness = mass * (2.0 * math.pi / period) ** 2
    damping = rng.uniform(0.0, 0.05) * 2.0 * math.sqrt(stiffness * mass)
    load = _body("load", mass, (0.0, 0.0, 0.0), rng.normal(size=3) * 2.0 / period)
    forces: list[Any] = []
    for i, direction in enumerate(np.eye(3)):
        law: dict[str, Any] = {"stiffness": stiffness}
        if i == 0:
            knees = np.array([-1.0, 0.0, 1.0])
            law = {"elongations": knees, "forces": stiffness * np.array([-1.0, 0.0, 1.5])}
        forces.append(
            Spring(
                name=f"spring_{i}",
                body_a=GROUND,
                point_a=-5.0 * direction,
                body_b="load",
                point_b=np.zeros(3),
                length=5.0,
                damping=damping,
                **law,
            )
        )
    return Trial(
        Scene((load,), tuple(forces)),
        period,
        2.0 * period,
        ("load.position",),
        ("spring_0.force", "spring_1.force"),
    )


def stop(rng: np.random.Generator) -> Trial:
    """A block on a slider between two stops."""
    mass, period, gap = 10.0 ** rng.uniform(0, 4), 10.0 ** rng.uniform(-1.5, 0.5), rng.uniform(0.2, 2.0)
    stiffness, speed = mass * (2.0 * math.pi / period) ** 2, rng.uniform(0.5, 5.0)
    frame = JointFrame(np.zeros(3), axes_about(np.array([1.0, 0.0, 0.0])))
    limits = Limits(lower=-gap, upper=gap, stiffness=stiffness)
    joint = Slider(name="slide", body_a=GROUND, body_b="block", frame_a=frame, frame_b=frame, limits=limits)
    block = _body("block", mass, (0.0, 0.0, 0.0), (speed, 0.0, 0.0))
    once = 4.0 * gap / speed + period
    return Trial(Scene((block,), joints=(joint,)), period, 1.5 * once, ("block.position",))


def barge(rng: np.random.Generator) -> Trial:
    """A box that floats, out of its position of rest."""
    length, draft = rng.uniform(30, 120), rng.uniform(1.5, 6)
    breadth = length * rng.uniform(0.25, 0.5)
    density, height = 1025.0, 2.0 * draft
    mass = density * length * breadth * draft
    centre = np.array([0.0, 0.0, draft])
    box = box_surface((length, breadth, height))
    surface = type(box)(box.points + np.array([0.0, 0.0, 0.5 * height - draft]), box.triangles, name="box")
    body = RigidBody(
        "barge",
        mass,
        mass * np.diag([(0.35 * breadth) ** 2, (0.25 * length) ** 2, (0.25 * length) ** 2]),
        centre_of_mass=0.3 * centre,
        position=np.array([0.0, 0.0, rng.uniform(0.1, 0.3) * draft]),
    )
    damping = np.diag(mass * np.array([0.0, 0.0, 0.05, 0.0, 0.0, 0.0]))
    sea = Sea(
        water=Water(density=density, gravity=G),
        hulls=(Hull(body="barge", restoring=surface, damping=damping),),
    )
    period = 2.0 * math.pi * math.sqrt(draft / G)
    return Trial(Scene((body,), (DOWN,), sea=sea), period, 2.5 * period, ("barge.position",))


def ball(rng: np.random.Generator) -> Trial:
    """A ball that falls on a floor that gives way, and bounces."""
    mass, radius, drop = 10.0 ** rng.uniform(0, 3), rng.uniform(0.1, 0.5), rng.uniform(0.1, 1.0)
    period = 10.0 ** rng.uniform(-2, -0.5)
    stiffness = mass * (2.0 * math.pi / period) ** 2
    grid = np.stack(
        [*np.meshgrid(np.linspace(-2, 2, 5), np.linspace(-2, 2, 5), indexing="ij"), np.zeros((5, 5))], 2
    )
    body = RigidBody(
        "ball", mass, 0.4 * mass * radius**2 * np.eye(3), position=np.array([0.0, 0.0, radius + drop])
    )
    touch = Contact(
        name="touch",
        contour="floor",
        body="ball",
        shape=SphereShape(radius),
        law=LinearLaw(stiffness, 0.02 * math.sqrt(stiffness * mass)),
        friction=0.0,
    )
    floor = Contour(name="floor", body="ground", neutral=neutral_surface(grid))
    once = 2.0 * math.sqrt(2.0 * drop / G) + period
    return Trial(
        Scene((body,), (DOWN,), contours=(floor,), contacts=(touch,)),
        period,
        1.2 * once,
        ("ball.position",),
        ("touch.normal_force",),
    )


def top(rng: np.random.Generator) -> Trial:
    """A heavy top that spins on its point."""
    mass, length, spin = 10.0 ** rng.uniform(-1, 2), rng.uniform(0.1, 1.0), rng.uniform(5.0, 40.0)
    inertia = mass * length**2 * np.diag([0.3, 0.3, 0.2])
    tilt = rng.uniform(0.2, 1.0)
    turn = np.array([math.cos(0.5 * tilt), math.sin(0.5 * tilt), 0.0, 0.0])
    up = length * np.array([0.0, -math.sin(tilt), math.cos(tilt)])
    body = RigidBody(
        "top",
        mass,
        inertia,
        position=up,
        orientation=turn,
        angular_velocity=np.array([0.0, -math.sin(tilt), math.cos(tilt)]) * spin,
    )
    body = RigidBody(**{**body.__dict__, "velocity": np.cross(body.angular_velocity, up)})
    point = Ball(
        name="point",
        body_a=GROUND,
        body_b="top",
        frame_a=JointFrame(np.zeros(3)),
        frame_b=JointFrame(np.array([0.0, 0.0, -length])),
    )
    nutation = 2.0 * math.pi * (1.3 * mass * length**2) / (0.2 * mass * length**2 * spin)
    slow = 2.0 * math.pi * (0.2 * mass * length**2 * spin) / (mass * G * length)
    period = min(nutation, 2.0 * math.pi / spin)
    return Trial(
        Scene((body,), (DOWN,), joints=(point,)), period, min(slow, 20.0 * period), ("top.position",)
    )


KINDS: tuple[Callable[[np.random.Generator], Trial], ...] = (
    bounce,
    swing,
    lift,
    links,
    spring,
    stop,
    barge,
    ball,
    top,
)


def _histories(
    trial: Trial, step: float, every: int, records: int
) -> tuple[Simulation, dict[str, np.ndarray]]:
    simulation = Simulation(trial.scene, step, record_every=every, start=trial.start)
    rows = [simulation.record()[None], simulation.advance(records * every)[1]]
    table = np.vstack(rows)
    return simulation, {
        c.name: table[:, c.column : c.column + len(c.components)] for c in simulation.channels
    }


def errors(trial: Trial, step: float) -> tuple[Simulation, float, float]:
    """A run with a step [s], error of its paths over their extent, of its largest forces over themselves."""
    records = max(3, math.ceil(trial.duration / step))
    simulation, found = _histories(trial, step, 1, records)
    if simulation.outcome is not Outcome.COMPLETED:
        return simulation, math.inf, math.inf
    finer = max(2, math.ceil(step / (trial.shortest / FINEST)))
    reference, known = _histories(trial, step / finer, finer, records)
    assert reference.outcome is Outcome.COMPLETED, reference.message
    path = force = 0.0
    for name in trial.paths:
        extent = np.linalg.norm(np.ptp(known[name], axis=0))
        path = max(path, float(np.linalg.norm(found[name] - known[name], axis=1).max() / extent))
    for name in trial.forces:
        largest = known[f"{name}_max"].max()
        force = max(force, float(abs(found[f"{name}_max"].max() - largest) / largest))
    return simulation, path, force


def run(count: int, seed: int) -> dict[str, int]:
    """Step `count` scenes, as many of each kind; counts by what came of them."""
    counts: Counter[str] = Counter(
        dict.fromkeys(("right", "right, warned", "wrong, warned", "stopped", "failures"), 0)
    )
    for number in range(count):
        kind = KINDS[number % len(KINDS)]
        rng = np.random.default_rng([seed, number])
        trial = kind(rng)
        coarser = 10.0 ** rng.uniform(0.0, 2.0)
        simulation, path, force = errors(trial, coarser * trial.shortest / 100.0)
        right = path <= PATH and force <= FORCE
        if simulation.outcome is not Outcome.COMPLETED or simulation.verdict[0] is not Outcome.COMPLETED:
            word = "stopped"
        elif simulation.warning:
            word = "right, warned" if right else "wrong, warned"
        else:
            word = "right" if right else "failures"
        if word == "failures":
            sys.stdout.write(
                f"{kind.__name__} {number} of seed {seed}, {100.0 / coarser:.3g} steps in the period: paths off by"
                f" {path:.2g}, forces by {force:.2g}, no word of it\n"
            )
        counts[word] += 1
        counts[f"{kind.__name__}: {word}"] += 1
    return dict(counts)
