"""Forces, ropes, sensors and joints between the nodes of a body with modes act where they are."""

from __future__ import annotations

import numpy as np
import pytest
from solid_beams import BENDING, LENGTH, SIDE, beam, cantilever, model

from heavylift.modal.bases import place_loads
from heavylift.numerics.outcome import InputError
from heavylift.solver.forces.point import PointForce
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.scene import Scene, Sensor
from heavylift.solver.simulation import Simulation

FORCE = 100.0


def channel(run: Simulation, name: str) -> np.ndarray:
    found = next(c for c in run.channels if c.name == name)
    return run.record()[found.column : found.column + len(found.components)]


@pytest.mark.parametrize("at", [0.525, 0.733, 0.95, 0.999])
def test_force_bends_the_beam_where_it_acts(at: float) -> None:
    """F a^3 / 3 E I at the force, F a^2 (3 L - a) / 6 E I at the tip; the nodes are 50 mm apart."""
    body = beam(cantilever(elements=20, modes=8, points=((at, 0.0, 0.0),)))
    push = PointForce("push", "beam", np.array([at, 0.0, 0.0]), force=np.array([0.0, 0.0, -FORCE]))
    sensors = (
        Sensor("under", "beam", np.array([at, 0.0, 0.0])),
        Sensor("tip", "beam", np.array([LENGTH, 0.0, 0.0])),
    )
    run = Simulation(Scene((body,), (push,), sensors), 1e-3, start="equilibrium")
    # a brick has constant curvature: an element carries h^2 / 4 a^2 less, and straight lines lie between nodes
    np.testing.assert_allclose(
        channel(run, "under.position")[2], -FORCE * at**3 / (3.0 * BENDING), rtol=0.006
    )
    tip = -FORCE * at**2 * (3.0 * LENGTH - at) / (6.0 * BENDING)
    np.testing.assert_allclose(channel(run, "tip.position")[2], tip, rtol=0.006)
    np.testing.assert_allclose(channel(run, "under.position")[0], at, atol=1e-9)


def test_force_between_nodes_does_the_work_of_its_shares() -> None:
    """A place moves as the linear field that its nodes have, and loads at it are the transpose of that."""
    reduced, bar = cantilever(), model()
    point = np.array([0.333, 0.004, -0.007])
    nodes, weights = reduced.locate(point)
    np.testing.assert_allclose(weights @ reduced.nodes[nodes], point, atol=1e-12)
    loads = place_loads(bar, [point]).forces
    flat = reduced.mode_shapes.reshape(reduced.mode_count, -1)
    np.testing.assert_allclose(flat @ loads, reduced.shapes_at(nodes, weights), atol=1e-12)


def test_points_on_nodes_are_those_nodes() -> None:
    reduced = cantilever()
    nodes, weights = reduced.locate(reduced.nodes[17] + 1e-11)
    assert (nodes.tolist(), weights.tolist()) == ([17], [1.0])


@pytest.mark.parametrize(("off", "fits"), [(0.0099, True), (0.0101, False)])
def test_a_point_may_be_a_hundredth_of_the_size_away(off: float, fits: bool) -> None:
    point = np.array([0.52, 0.0, SIDE / 2 + off])
    scene = Scene((beam(cantilever()),), (), (Sensor("seen", "beam", point),))
    if fits:
        pack_scene(scene)
        return
    with pytest.raises(
        InputError, match=r"beam: point: point \(520, 0, 20\.1\) mm is not on.*10\.1 mm away.*1%"
    ):
        pack_scene(scene)
