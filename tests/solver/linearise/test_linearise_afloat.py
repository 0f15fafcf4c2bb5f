"""Modes of what floats: closed forms of a box, with added mass and with the memory of the water."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh, expm

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.solver.forces.spring import Spring
from heavylift.solver.linearise.linearise import linearise
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, Radiation, Sea, Water
from heavylift.solver.simulation import Simulation

FILE = Path(__file__).parents[3] / "cases" / "transport_barge" / "barge.nc"
LENGTH, BREADTH, HEIGHT, DRAFT, KG = 97.5, 36.0, 9.0, 4.5, 2.0  # KG above the water
G, RHO = 9.81, 1025.0
MASS = LENGTH * BREADTH * DRAFT * RHO
INERTIA = MASS * np.array([(0.35 * BREADTH) ** 2, (0.25 * LENGTH) ** 2, (0.26 * LENGTH) ** 2])


@cache
def database() -> Any:
    return read_netcdf(FILE)


def barge(*forces: Any, memory: Any = None, heave: float = 0.0) -> Scene:
    """A box that floats in the middle of its height; with a database and its memory, or alone."""
    body = RigidBody(
        "barge",
        MASS,
        np.diag(INERTIA),
        centre_of_mass=np.array([0.0, 0.0, KG]),
        position=np.array([0, 0, heave]),
    )
    hull = Hull(body="barge", restoring=box_surface((LENGTH, BREADTH, HEIGHT)))
    radiation = () if memory is None else (Radiation(bodies=("barge",), database=database(), memory=memory),)
    sea = Sea(water=Water(gravity=G, density=RHO), hulls=(hull,), radiation=radiation)
    return Scene((body,), (Gravity(np.array([0.0, 0.0, -G])), *forces), sea=sea)


def line(name: str, end: Any, start: Any, stiffness: float) -> Spring:
    """A horizontal spring without force."""
    length = float(np.linalg.norm(np.subtract(end, start)))
    return Spring(
        name=name, body_a=GROUND, point_a=np.array(start, dtype=float), body_b="barge",
        point_b=np.array(end, dtype=float), length=length, stiffness=stiffness,
    )  # fmt: skip


def test_heave_roll_and_pitch_of_a_box() -> None:
    """``rho g A / m`` and ``rho g V GM / I``; nothing holds surge, sway and yaw."""
    found = linearise(Simulation(barge(), 0.01))
    assert found.zeros == 6
    moment = -MASS * G * (0.5 * DRAFT + KG)
    stiffness = [
        RHO * G * LENGTH * BREADTH,
        RHO * G * LENGTH * BREADTH**3 / 12.0 + moment,
        RHO * G * BREADTH * LENGTH**3 / 12.0 + moment,
    ]
    expected = np.sqrt(np.array(stiffness) / np.array([MASS, *INERTIA[:2]])) / (2.0 * np.pi)
    assert found.frequencies[3:] == pytest.approx(np.sort(expected), rel=1e-8)
    assert found.water_states == 0


def test_moored_box_with_added_mass() -> None:
    """Six by six by hand, about the centre of the water plane, with the added mass of infinite frequency."""
    k, arm, x = 2e6, 200.0, 0.5 * LENGTH
    lines = [
        line("ahead", (x, 0, KG), (x + arm, 0, KG), k),
        line("astern", (-x, 0, KG), (-x - arm, 0, KG), k),
    ]
    lines += [line(f"{i}", (i, 0, KG), (i, arm, KG), k) for i in (x, -x)]
    simulation = Simulation(barge(*lines, memory="none"), 0.01)
    found = linearise(simulation)
    infinite = np.array(simulation.layout.bodies[0].added_mass)  # as it was extrapolated from the database
    M = np.diag([MASS, MASS, MASS, *(INERTIA + MASS * KG**2 * np.array([1.0, 1.0, 0.0]))])
    M[0, 4] = M[4, 0] = MASS * KG
    M[1, 3] = M[3, 1] = -MASS * KG
    moment = -MASS * G * (0.5 * DRAFT + KG)
    area = RHO * G * LENGTH * BREADTH
    K = np.diag([0.0, 0.0, area, area * BREADTH**2 / 12.0 + moment, area * LENGTH**2 / 12.0 + moment, 0.0])
    for one in lines:
        point, way = one.point_b, (one.point_a - one.point_b) / arm
        row = np.concatenate([way, np.cross(point, way)])
        K += k * np.outer(row, row)
    squares = eigh(K, M + infinite, eigvals_only=True)
    assert found.zeros == 0
    assert found.frequencies == pytest.approx(np.sqrt(squares) / (2.0 * np.pi), rel=1e-6)


def test_free_decay_with_memory() -> None:
    """The matrices give the heave that the run has: both have the same exponentials, and nothing else in common."""
    names = ["barge.position.z"]
    still = Simulation(barge(memory="exponentials"), 0.02)
    found = linearise(still, outputs=names)
    assert found.water_states > 0
    assert found.of_bodies.size < found.eigenvalues.size
    assert not found.unstable.size
    start, steps = 1e-3, 1000
    lifted = Simulation(barge(memory="exponentials", heave=start), 0.02, record_every=100)
    column = next(c.column for c in lifted.channels if c.name == "barge.position") + 2
    times, records = lifted.advance(steps)
    x = np.zeros(len(found.states))
    x[found.states.index("barge.z")] = start
    expected = np.array([(found.C @ expm(found.A * t) @ x)[0] for t in times])
    assert np.abs(expected).min() < 0.5 * start
    assert records[:, column] == pytest.approx(expected, abs=2e-3 * start)


def test_memory_by_convolution_is_refused() -> None:
    with pytest.raises(InputError, match="'barge' is a convolution over the past"):
        linearise(Simulation(barge(memory="direct"), 0.02))
