"""Carried strains that drift: measured by the strains that are there, however small these are."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.scene.bodies import Driven, Profile
from heavylift.solver.scene.mesh_shapes import line
from heavylift.solver.scene.meshes import FrameBody, FrameSection
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.simulation import Simulation

LENGTH, SPIN, RAMP = 10.0, 6.0, 15.0
DENSITY, MODULUS, AREA = 1.2, 2.8e7, 1.0
EXTENSION = DENSITY * SPIN**2 * LENGTH**3 / (3.0 * MODULUS)
"""Of a rod that turns steadily about its end, ``rho w^2 L^3 / 3 E``: 0.514 mm at a largest strain of 7.7e-5."""


def spun(elasticity: str, step: float) -> tuple[float, Simulation]:
    """J. C. Simo and L. Vu-Quoc, J. Applied Mechanics 53, 1986: mean extension after the spin-up [m]."""
    times = np.linspace(0.0, RAMP, 121)
    speeds = SPIN / RAMP * (times - RAMP / (2.0 * np.pi) * np.sin(2.0 * np.pi * times / RAMP))
    root = RigidBody("root", 1.0, np.eye(3), motion=Driven(angle=Profile(times=times, speeds=speeds)))
    mesh = line([0.0, 0.0, 0.0], [LENGTH, 0.0, 0.0], 8)
    rod = FrameBody(
        name="rod",
        nodes=mesh.nodes,
        tangents=mesh.tangents,
        elements=mesh.elements,
        sections=(FrameSection(DENSITY, MODULUS, AREA, 5e-4),),
        elasticity=elasticity,
    )
    joint = FixedJoint(name="root_joint", body_a="root", body_b="rod")
    simulation = Simulation(Scene(bodies=(root, rod), joints=(joint,)), step, record_every=10)
    simulation.advance(round(18.0 / step))
    rows = simulation.advance(round(2.0 / step))[1]
    column = next(channel.column for channel in simulation.channels if channel.name == "rod.position")
    tip = rows[:, column + 24 : column + 27]
    return float(np.mean(np.linalg.norm(tip, axis=1)) - LENGTH), simulation


@pytest.mark.parametrize("step", [5e-3, 2e-3])
def test_a_small_strain_is_not_lost_in_the_drift_of_carried_ones(step: float) -> None:
    """By default the body changes over; with carried strains throughout it is told how wrong they are."""
    extension, simulation = spun("auto", step)
    assert extension == pytest.approx(EXTENSION, rel=2e-3)
    assert "changed over to the energy-momentum scheme" in simulation.warning
    extension, simulation = spun("carried", step)
    assert extension > 1.2 * EXTENSION
    assert "of the largest strain: its stresses are wrong" in simulation.warning
