"""Flexible pendulum of Berzeri and Shabana: order in the step, convergence of the mesh, adaptive steps.

M. Berzeri, A. A. Shabana, J. Sound Vib. 235, 2000: a soft beam on a pin, released from horizontal.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heavylift.solver.scene.mesh_shapes import line
from heavylift.solver.scene.meshes import FrameBody, FrameSection, Support
from heavylift.solver.scene.scene import Gravity, Scene
from heavylift.solver.simulation import Simulation

DATA = Path(__file__).parent / "data"
SCHEMES = ("carried", "energy-momentum")


def scene(
    count: int, modulus: float, elasticity: str, model: str = "green-lagrange", g: float = 9.81
) -> Scene:
    mesh = line(np.zeros(3), (1.2, 0.0, 0.0), count)
    body = FrameBody(
        name="beam",
        nodes=mesh.nodes,
        tangents=mesh.tangents,
        elements=mesh.elements,
        sections=(FrameSection(5540.0, modulus, 0.0018, 1.215e-8),),
        supports=(Support(np.array([0]), {"position": "xyz"}),),
        model=model,
        elasticity=elasticity,
    )
    return Scene((body,), (Gravity(np.array([0.0, -g, 0.0])),))


def tip(simulation: Simulation, records: np.ndarray) -> np.ndarray:
    """Place of the last node [m], shape (records, 2)."""
    channel = next(c for c in simulation.channels if c.name == "beam.position")
    last = channel.column + len(channel.components) - 3
    return records[:, last : last + 2]


def path(scene: Scene, step: float, interval: float, count: int) -> np.ndarray:
    """Tip after each of `count` intervals."""
    simulation = Simulation(scene, step, record_every=round(interval / step))
    _, records = simulation.advance(count * simulation.record_every)
    return tip(simulation, records)


def largest(difference: np.ndarray) -> float:
    return float(np.linalg.norm(difference, axis=1).max())


@pytest.mark.parametrize("elasticity", SCHEMES)
@pytest.mark.parametrize(("modulus", "step"), [(0.7e9, 4e-4), (2.1e11, 1e-5)])
def test_resolved_motion_is_of_second_order(modulus: float, step: float, elasticity: str) -> None:
    """Steps that follow the waves of four elements, against steps of an eighth of the finest of the other scheme."""
    count, interval = 100, 5.0 * step
    other = SCHEMES[1 - SCHEMES.index(elasticity)]
    fine = path(scene(4, modulus, other), step / 32.0, interval, count)
    errors = [
        largest(path(scene(4, modulus, elasticity), step / part, interval, count) - fine)
        for part in (1, 2, 4)
    ]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all(orders > 1.75), (errors, orders)
    assert np.all(orders < 2.3), (errors, orders)


@pytest.mark.parametrize("elasticity", SCHEMES)
def test_steps_that_skip_the_waves_are_right_in_the_large(elasticity: str) -> None:
    """Engineering steps, up to a hundred times too long for the waves along the beam: tip over one second."""
    fine = path(scene(10, 0.7e9, "energy-momentum"), 1e-4, 1e-2, 100)
    for step, limit in ((5e-3, 2e-3), (1e-3, 1.5e-4)):
        assert largest(path(scene(10, 0.7e9, elasticity), step, 1e-2, 100) - fine) < limit


def reference(g: str, columns: tuple[int, int]) -> np.ndarray:
    return np.loadtxt(DATA / f"flexible_pendulum_g{g}.csv", delimiter=",", skiprows=4)[1:, list(columns)]


def mesh_errors(g: str, model: str, counts: tuple[int, ...], elasticity: str) -> list[float]:
    """Distances of the tip from the reference for several numbers of elements [m]."""
    expected = reference(g, (1, 2) if model == "green-lagrange" else (4, 5))
    interval, step = {"9.81": (12e-3, 2e-4), "50": (4e-3, 1e-4)}[g]
    return [
        largest(path(scene(n, 0.7e6, elasticity, model, float(g)), step, interval, len(expected)) - expected)
        for n in counts
    ]


def test_soft_pendulum_converges_with_the_mesh() -> None:
    """Strains of up to 0.5, where models differ; 1e-3 m with 40 elements up to 0.8 s, 5e-4 m with 80 at g = 50 m/s2."""
    errors = mesh_errors("9.81", "green-lagrange", (10, 20, 40, 80), "energy-momentum")
    assert errors == sorted(errors, reverse=True)
    assert errors[2] < 1e-3
    assert errors[3] < 2.5e-4
    assert mesh_errors("50", "green-lagrange", (80,), "energy-momentum")[0] < 5e-4


def test_carried_strains_converge_to_the_same() -> None:
    assert mesh_errors("9.81", "green-lagrange", (40,), "carried")[0] < 1e-3
    assert mesh_errors("50", "green-lagrange", (80,), "carried")[0] < 5e-4


def test_exact_model_converges_with_the_mesh() -> None:
    errors = mesh_errors("9.81", "exact", (20, 40, 80), "carried")
    assert errors == sorted(errors, reverse=True)
    assert errors[1] < 2e-3
    assert errors[2] < 3e-4
    assert mesh_errors("50", "exact", (80,), "carried")[0] < 5e-4


@pytest.mark.parametrize("elasticity", ["auto", "energy-momentum"])
def test_errors_follow_the_tolerance(elasticity: str) -> None:
    """Steps chosen by the tolerance: their number grows with its cube root, errors fall with it."""
    fine = path(scene(10, 0.7e9, "energy-momentum"), 2.5e-5, 1e-2, 50)
    errors, steps = [], []
    for tolerance in (1e-3, 1e-4, 1e-5, 1e-6):
        simulation = Simulation(scene(10, 0.7e9, elasticity), 1e-2, tolerance=tolerance)
        _, records = simulation.advance(50)
        errors.append(largest(tip(simulation, records) - fine))
        steps.append(simulation.solver_steps)
    assert errors == sorted(errors, reverse=True)
    assert steps == sorted(steps)
    # at second order ten times less tolerance is 2.15 times the steps and 4.6 times less error
    assert errors[0] < 3e-3
    assert 0.1 * errors[0] > errors[2]
    assert errors[3] < 5e-5
    assert 5.0 < steps[3] / steps[0] < 20.0
