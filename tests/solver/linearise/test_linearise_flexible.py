"""Modes of what bends: reduced bodies, frames and cables."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from point_masses import System, make_cloud
from scenarios import start_of
from scipy.linalg import eigh

from heavylift.solver.bodies.lumped_cable.lumped_cable import LumpedCable
from heavylift.solver.joints.ball import Ball
from heavylift.solver.linearise.linearise import linearise
from heavylift.solver.scene.connections import GROUND, JointFrame
from heavylift.solver.scene.mesh_shapes import line
from heavylift.solver.scene.meshes import FrameBody, FrameSection, Support
from heavylift.solver.scene.scene import Fixed, Scene
from heavylift.solver.simulation import Simulation

STEEL, DENSITY = 2.1e11, 7850.0
LENGTH, AREA, SECOND_MOMENT = 2.0, 1e-4, 8e-10


def test_modes_of_a_body_whose_frame_is_fixed() -> None:
    """Those of its shapes, which are orthonormal by the masses."""
    system = System(make_cloud(seed=8), start_of(8), Fixed())
    scene = system.scene()
    found = linearise(Simulation(scene, 1e-3))
    squares = np.sort(system.cloud.stiffness)
    assert found.frequencies == pytest.approx(np.sqrt(squares) / (2.0 * np.pi), rel=1e-6)
    assert found.participation[scene.bodies[0].name][:, 2] == pytest.approx(1.0)


def test_modes_of_a_free_body() -> None:
    """Six motions are free; the others are those of its points, ``K x = w2 J^T m J x``."""
    start = start_of(3)
    still = {name: np.zeros_like(value) for name, value in vars(start).items() if name != "orientation"}
    system = System(make_cloud(seed=3), replace(start, **still))
    found = linearise(Simulation(system.scene(), 1e-3))
    cloud, n = system.cloud, system.cloud.mode_count
    J = cloud.jacobians(np.eye(3), np.zeros(n))
    M = np.einsum("j,jai,jak->ik", cloud.masses, J, J)
    K = np.diag(np.concatenate([np.zeros(6), cloud.stiffness]))
    expected = np.sqrt(np.maximum(eigh(K, M, eigvals_only=True)[6:], 0.0)) / (2.0 * np.pi)
    assert found.zeros == 12
    assert found.frequencies[6:] == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("model", ["green-lagrange", "exact"])
def test_cantilever_of_a_frame(model: str) -> None:
    """Euler and Bernoulli, both ways across, up to what twenty cubic elements miss."""
    mesh = line((0.0, 0.0, 0.0), (LENGTH, 0.0, 0.0), 20)
    body = FrameBody(
        name="beam", nodes=mesh.nodes, tangents=mesh.tangents, elements=mesh.elements,
        sections=(FrameSection(DENSITY, STEEL, AREA, SECOND_MOMENT),), model=model,
        supports=(Support(np.array([0]), {"position": "xyz", "tangent": "xyz"}),),
    )  # fmt: skip
    found = linearise(Simulation(Scene((body,)), 1e-3))
    numbers = np.repeat([1.875104068712, 4.694091132974, 7.854757438238], 2)
    omega = (numbers / LENGTH) ** 2 * np.sqrt(STEEL * SECOND_MOMENT / (DENSITY * AREA))
    assert found.frequencies[:6] == pytest.approx(omega / (2.0 * np.pi), rel=4e-4)
    assert found.states[0].startswith("beam.node.2.")


def test_taut_cable() -> None:
    """A string of equal masses: ``2 sqrt(T/(m a)) sin(k pi / 2 n)`` across, twice each."""
    n, length, mass, stiffness, strain = 10, 20.0, 100.0, 2e6, 1e-3
    points = np.array([[0, 0, 0], [length, 0, 0]])
    cable = LumpedCable(
        name="cable", points=points, segments=n, mass=mass, axial_stiffness=stiffness,
        length=length / (1.0 + strain),
    )  # fmt: skip
    unit = np.eye(3)
    joints = tuple(
        Ball(
            name=f"end_{i}", body_a=GROUND, body_b="cable",
            frame_a=JointFrame(point, unit), frame_b=JointFrame(point, unit),
        )
        for i, point in enumerate(points)
    )  # fmt: skip
    found = linearise(Simulation(Scene((cable,), (), (), joints), 1e-3))
    k = np.repeat(np.arange(1, n), 2)
    omega = 2.0 * np.sqrt(stiffness * strain / (mass / n * length / n)) * np.sin(k * np.pi / (2 * n))
    assert found.frequencies[: 2 * n - 2] == pytest.approx(omega / (2.0 * np.pi), rel=1e-7)
