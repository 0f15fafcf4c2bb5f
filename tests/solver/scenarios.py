"""The motions on which the solver is measured against the point masses."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from point_masses import Array, Load, Start, System, channels_of, make_cloud

from heavylift.solver.scene.scene import Driven, Fixed, Harmonic, Profile
from heavylift.solver.simulation import Simulation

DURATION = 0.4
GRAVITY = np.array([0.5, -1.0, -9.81])
DAMPING = np.array([0.02, 0.05, 0.01, 0.1, 0.0])


def start_of(seed: int, modes: int = 5, spin: float = 4.0) -> Start:
    """Random pose, speed about 1 m/s, spin about 4 rad/s, deflections of a few per cent of the size."""
    rng = np.random.default_rng(seed)
    orientation = rng.normal(size=4)
    return Start(
        rng.normal(size=3),
        orientation / np.linalg.norm(orientation),
        0.7 * rng.normal(size=3),
        spin * np.array([0.6, -0.5, 0.7]),
        0.02 * rng.normal(size=modes),
        0.5 * rng.normal(size=modes),
    )


def loads_of(seed: int) -> tuple[Load, Load]:
    """Two tables of forces of about 10 N: in world axes and following the body."""
    rng = np.random.default_rng(seed)
    times = np.array([0.0, 0.1, 0.24, 0.4])
    return (
        Load(2, times, 10.0 * rng.normal(size=(4, 3))),
        Load(5, times, 10.0 * rng.normal(size=(4, 3)), "body"),
    )


HARMONICS = Driven(
    x=Profile(harmonics=(Harmonic(0.1, 2.0, 0.3),)),
    angle=Profile(harmonics=(Harmonic(0.3, 1.5, 0.2), Harmonic(0.05, 4.0))),
    axis=(1.0, 2.0, -1.0),
    pivot=(0.5, 0.2, -0.3),
)
"""About an inclined axis that does not pass through the body, and along x."""

TABLES = Driven(
    y=Profile(np.array([0.0, 0.1, 0.2, 0.4]), np.array([0.0, 0.05, 0.02, 0.1])),
    z=Profile(np.array([0.1, 0.3]), np.array([0.0, 0.04]), (Harmonic(0.02, 1.0),)),
    angle=Profile(np.array([0.0, 0.2, 0.4]), np.array([0.0, 0.5, 0.8]), (Harmonic(0.1, 1.5, 0.2),)),
    axis=(0.0, -3.0, 1.0),
    pivot=(-0.5, 1.0, 0.4),
)
"""Spline tables, one of them shorter than the run, with harmonics on top."""

FLEXIBLE = {
    "free": System(make_cloud(seed=1), start_of(1)),
    "free, frame in the centre of mass, falling": System(
        make_cloud(seed=2, centred=True), start_of(2), gravity=GRAVITY
    ),
    "free, loads": System(make_cloud(seed=3), start_of(3), gravity=GRAVITY, loads=loads_of(3)),
    "free, loads and dampers": System(
        make_cloud(seed=4), start_of(4), gravity=GRAVITY, loads=loads_of(4), damping_ratio=DAMPING
    ),
    "free, shapes with rigid parts": System(
        make_cloud(seed=5, rigid_part=1.0),
        start_of(5),
        gravity=GRAVITY,
        loads=loads_of(5),
        damping_ratio=DAMPING,
    ),
    "driven by harmonics": System(make_cloud(seed=6), start_of(6), HARMONICS),
    "driven by tables, shapes with rigid parts": System(
        make_cloud(seed=7, rigid_part=1.0),
        start_of(7),
        TABLES,
        gravity=GRAVITY,
        loads=loads_of(7),
        damping_ratio=DAMPING,
    ),
    "fixed, shapes with rigid parts": System(
        make_cloud(seed=8, rigid_part=1.0),
        start_of(8),
        Fixed(),
        gravity=GRAVITY,
        loads=loads_of(8),
        damping_ratio=DAMPING,
    ),
}
"""All that can act on a flexible body."""

RIGID = {
    "free": System(make_cloud(modes=0, seed=11), start_of(11, 0)),
    "free, loads": System(make_cloud(modes=0, seed=12), start_of(12, 0), gravity=GRAVITY, loads=loads_of(12)),
    "driven by harmonics, loads": System(
        make_cloud(modes=0, seed=13), start_of(13, 0), HARMONICS, gravity=GRAVITY, loads=loads_of(13)
    ),
    "driven by tables, loads": System(
        make_cloud(modes=0, seed=14), start_of(14, 0), TABLES, gravity=GRAVITY, loads=loads_of(14)
    ),
    "fixed, loads": System(
        make_cloud(modes=0, seed=15), start_of(15, 0), Fixed(), gravity=GRAVITY, loads=loads_of(15)
    ),
}
"""All that can act on a rigid body: clouds without modes."""


@cache
def reference(system: System) -> dict[str, Array]:
    """Channels of the point masses at the end."""
    return system.solve(DURATION)


def simulate(
    scene: Any, step: float, integrator: str = "dele2", duration: float = DURATION
) -> dict[str, Array]:
    """Channels of the solver at the end; ``energy.balance`` is its largest change in the run."""
    steps = round(duration / step)
    simulation = Simulation(scene, step, integrator, record_every=steps // 20)
    before = channels_of(simulation, simulation.record())
    _, records = simulation.advance(steps)
    assert not simulation.outcome, simulation.message
    rows = [channels_of(simulation, row) for row in records]
    drift = max(abs(row["energy.balance"][0] - before["energy.balance"][0]) for row in rows)
    return rows[-1] | {"energy.balance": np.array([drift])}


def errors(found: dict[str, Array], expected: dict[str, Array]) -> dict[str, float]:
    """Largest deviation by channel, relative to the size of the channel where that is more than 1."""
    out = {"energy.balance": float(abs(found["energy.balance"][0]))}
    for name in found.keys() & expected.keys():
        scale = max(1.0, float(np.abs(expected[name]).max(initial=0.0)))
        out[name] = float(np.abs(found[name] - expected[name]).max(initial=0.0)) / scale
    return out
