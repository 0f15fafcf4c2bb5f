"""The first-order scheme of the 2018 thesis on a frame: its order, and its kinship with the leapfrog."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.solver.scene.mesh_shapes import line
from heavylift.solver.scene.meshes import FrameBody, FrameSection, Support
from heavylift.solver.scene.scene import Gravity, Scene
from heavylift.solver.simulation import Simulation

pytestmark = pytest.mark.slow  # two integrators compile


def pendulum(elasticity: str = "carried") -> Scene:
    """A soft pendulum of four elements that falls from rest."""
    mesh = line([0.0, 0.0, 0.0], [1.2, 0.0, 0.0], 4)
    body = FrameBody(
        name="beam",
        nodes=mesh.nodes,
        tangents=mesh.tangents,
        elements=mesh.elements,
        sections=(FrameSection(5540.0, 0.7e6, 0.0018, 1.215e-8),),
        supports=(Support(np.array([0]), {"position": "xyz"}),),
        elasticity=elasticity,  # type: ignore[arg-type]
    )
    return Scene(bodies=(body,), forces=(Gravity(np.array([0.0, -9.81, 0.0])),))


def positions(step: float, integrator: str, elasticity: str = "carried") -> np.ndarray:
    """Nodes after every hundredth of a second, shape (30, 15)."""
    simulation = Simulation(pendulum(elasticity), step, integrator, record_every=round(0.01 / step))
    _, records = simulation.advance(round(0.3 / step))
    assert simulation.outcome is Outcome.COMPLETED, simulation.message
    channel = next(c for c in simulation.channels if c.name == "beam.position")
    return records[:, channel.column : channel.column + 15]


def test_thesis_is_of_first_order_and_the_leapfrog_of_second() -> None:
    fine = positions(2.5e-6, "dele2", "explicit")
    steps = (2e-4, 1e-4, 5e-5)
    for integrator, order in (("thesis", 1.0), ("dele2", 2.0)):
        errors = [np.abs(positions(h, integrator, "explicit") - fine).max() for h in steps]
        observed = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
        np.testing.assert_allclose(observed, order, atol=0.15, err_msg=integrator)


def test_thesis_shares_its_recurrence_with_the_leapfrog() -> None:
    """``q_{k+1} - 2 q_k + q_{k-1} = h^2 M^-1 F(q_k)``: from the same two positions on they are the same, eq. 12."""
    h = 1e-4
    thesis = Simulation(pendulum(), h, "thesis")
    thesis.advance(1)
    leapfrog = Simulation(pendulum("explicit"), h, "dele2")
    leapfrog.warm_up()
    # the leapfrog takes its forces in the middles of its steps, which are the positions of the thesis
    own, other = thesis._layout.bodies[0], leapfrog._layout.bodies[0]
    other.velocity[:] = own.velocity
    other.position[:] = own.position - 0.5 * h * own.velocity
    _, a = thesis.advance(200)
    _, b = leapfrog.advance(200)
    place = {channel.name: channel.column for channel in thesis.channels}
    at, v = place["beam.position"], place["beam.velocity"]
    np.testing.assert_allclose(
        b[:, at : at + 15] + 0.5 * h * b[:, v : v + 15], a[:, at : at + 15], rtol=0.0, atol=1e-11
    )


def test_an_explicit_step_beyond_its_limit_blows_up_and_stops() -> None:
    simulation = Simulation(pendulum(), 2e-2, "thesis")
    simulation.advance(200)
    assert simulation.outcome is not Outcome.COMPLETED
    assert "body 'beam', element" in simulation.message
