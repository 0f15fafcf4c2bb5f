"""Balls of any mass, law and speed in a bumpy bowl: what must hold whatever the numbers are."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from contact_scenes import RADIUS, Run, ball, ball_on_floor, surface

from heavylift.solver.scene.contacts import HertzLaw, HuntCrossleyLaw, LinearLaw, RigidLaw
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from heavylift.solver.scene.scene import Scene


def bowl(x: Any, y: Any) -> Any:
    return 0.3 * (x * x + y * y) + 0.02 * np.sin(5.0 * x) * np.cos(4.0 * y)


FLOOR = surface(bowl, half=1.5, count=16)


def random_scene(seed: int) -> tuple[Scene, float, str]:
    """Scene, step [s] from 10 us to 10 ms, and its numbers as a text; masses from 1 g to 1 t."""
    random = np.random.default_rng(seed)
    x, y = random.uniform(-0.9, 0.9, 2)
    velocity = random.normal(size=3) * random.uniform(0.0, 2.0)
    restitution, friction = (
        float(random.choice([0.0, 0.3, 0.5, 0.8, 1.0])),
        float(random.choice([0.0, 0.1, 0.5, 1.5])),
    )
    step, mass = 10.0 ** random.uniform(-5.0, -2.0), 10.0 ** random.uniform(-3.0, 3.0)
    start = ball([x, y, bowl(x, y) + 1.8 * RADIUS + random.uniform(0.0, 0.5)], velocity, mass=mass)
    start = replace(start, angular_velocity=random.normal(size=3) * random.uniform(0.0, 20.0))
    laws = [
        RigidLaw(restitution),
        RigidLaw(restitution),
        RigidLaw(restitution, rest_speed=1e-3),
        HertzLaw(1e5 * mass),
        HuntCrossleyLaw(1e5 * mass, 1.5, max(restitution, 0.1)),
        LinearLaw(1e4 * mass, 20.0 * mass),
    ]
    law = laws[random.integers(len(laws))]
    text = f"seed {seed}: {law}, friction {friction}, mass {mass:.3g} kg, step {step:.3g} s"
    return ball_on_floor(start, law, floor=FLOOR, friction=friction), step, text


def complaints(scene: Scene, step: float, steps: int, every: int = 1) -> list[str]:
    """What is wrong with a run; empty if nothing."""
    simulation = Simulation(scene, step, record_every=every)
    first = simulation.record()
    times, records = simulation.advance(steps)
    found = Run(np.append(0.0, times), np.vstack([first, records]), simulation)
    wrong = [simulation.message] if simulation.outcome else []
    if not np.all(np.isfinite(found.records)):
        return [*wrong, "not finite"]
    energy = found["energy.kinetic"] + found["energy.potential"] + found["energy.elastic"]
    scale = found["energy.kinetic"].max() + np.ptp(found["energy.potential"])
    rigid = isinstance(scene.contacts[0].law, RigidLaw)
    # the force of a law acts along the normal of the middle of the step: steps of a quarter of a pulse show that
    if energy.max() > energy[0] + (1e-6 + (0.0 if rigid else step**2)) * scale:
        wrong.append(f"energy grows by {(energy.max() - energy[0]) / scale:.2g}")
    if found.drift > (1e-4 + step) * scale:
        wrong.append(f"energy account open by {found.drift / scale:.2g}")
    # soft laws may press in by half the radius at these speeds
    if found["touch.gap"].min() < -(1e-3 if rigid else 0.5) * RADIUS:
        wrong.append(f"{-found['touch.gap'].min():.2g} m inside")
    if simulation.cpu_seconds > 2e-4 * steps + 1.0:
        wrong.append(f"{1e6 * simulation.cpu_seconds / steps:.0f} us a step")
    return wrong
