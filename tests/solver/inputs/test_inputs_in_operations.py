"""Inputs beside a scenario, contacts that sleep, and a start in equilibrium."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from input_scenes import column, driven, hoist
from mesh_contact_scenes import MASS, G, body, scene

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.solver.inputs.force import ForceInput
from heavylift.solver.inputs.winches import WinchLengthInput, WinchSpeedInput
from heavylift.solver.scenario.actions.winch import WinchSpeed
from heavylift.solver.scene.connections import RopePoint
from heavylift.solver.scene.scenario import Condition, Phase, Scenario
from heavylift.solver.scene.scene import Scene
from heavylift.solver.scene.signals import Signal, Term
from heavylift.solver.simulation import Simulation

PUSH = ForceInput(name="push", body="load", point=np.zeros(3))
HAUL = WinchSpeedInput(name="haul", rope="hoist")


def two_ropes(*phases: Phase) -> Scene:
    """A second rope beside the first one, which the scenario commands."""
    first = hoist().ropes[0]
    path = (RopePoint("ground", np.array([2.0, 0.0, 10.0])), RopePoint("load", np.zeros(3)))
    other = replace(first, name="other", path=path, length=11.0)
    return replace(hoist(inputs=(PUSH, HAUL)), ropes=(first, other), scenario=Scenario(phases))


def test_a_scenario_waits_for_an_input_and_commands_beside_it() -> None:
    """The phase ends where the input, on a ramp, comes to a value within a step; both states go on."""
    waits = Phase("wait", until=(Condition(Signal((Term("push.value"),)), 0.4321),))
    goes = Phase("go", (WinchSpeed("other", 0.3),))
    scene = two_ropes(waits, goes)
    simulation = Simulation(scene, 0.01)
    settings: dict[int, tuple[Any, ...]] = {0: ("push", 0.0, 1.0, 1.0), 20: ("haul", 0.2)}
    records = driven(simulation, settings, 100)
    (done,) = [line for line in simulation.operation.log if line.event == "done"]
    np.testing.assert_allclose(done.time, 0.4321, atol=1e-9)
    times = 0.01 * np.arange(1, 101)
    rest = column(simulation, "hoist.rest_length", records)
    np.testing.assert_allclose(rest, 10.0 - 0.2 * np.maximum(times - 0.2, 0.0), rtol=1e-12)
    other = column(simulation, "other.rest_length", records)
    np.testing.assert_allclose(other, 11.0 - 0.3 * np.maximum(times - 0.4321, 0.0), rtol=1e-9)
    second = Simulation(scene, 0.01)
    second.advance(7)
    second.restore(simulation.state())
    np.testing.assert_array_equal(second.advance(30)[1], simulation.advance(30)[1])


def test_a_winch_is_not_commanded_and_driven() -> None:
    with pytest.raises(InputError, match=r"haul: inputs.1.rope: 'hoist' is commanded by the scenario too"):
        Simulation(two_ropes(Phase("go", (WinchSpeed("hoist", 0.3),))), 0.01)


@pytest.mark.parametrize("start", ["equilibrium", "relax"])
def test_a_start_at_rest_is_that_under_the_start_values(start: Any) -> None:
    """A sideways force of the weight hangs the load at 45 degrees, and it stays; a length begins with its rope."""
    push = replace(PUSH, value=2.0 * 9.81)
    length = WinchLengthInput(name="length", rope="hoist")
    simulation = Simulation(hoist(inputs=(push, length)), 0.01, start=start)
    records = np.concatenate([simulation.record()[None], simulation.advance(20)[1]])
    position = column(simulation, "load.position", records)
    np.testing.assert_allclose(position[:, 0], 10.0 - position[:, 2], rtol=1e-6)
    np.testing.assert_allclose(position, np.broadcast_to(position[0], position.shape), atol=1e-6)
    assert simulation.inputs.value("length")[0] == 10.0


def test_a_body_asleep_wakes_where_an_input_pushes_it() -> None:
    """A box that sleeps on a rough floor slides by what its force exceeds friction: x = (F/m - mu g) t^2/2."""
    box = body("load", (0.0, 0.0, 0.5))
    made = scene([(box, box_surface(1.0))], plane_surface(60.0), [("floor", "load")], friction=0.5)
    simulation = Simulation(replace(made, inputs=(PUSH,)), 0.01)
    simulation.advance(60)
    contacts = next(system for system in simulation._layout.systems if hasattr(system, "tally"))
    assert contacts.slept["island"].all()
    before = simulation.record()
    simulation.set_input("push", MASS * (0.5 * G + 1.0))
    records = simulation.advance(50)[1]
    assert not contacts.slept["island"].any()
    way = (
        column(simulation, "load.position", records)[:, 0]
        - column(simulation, "load.position", before[None])[:, 0]
    )
    np.testing.assert_allclose(way[[9, 49]], [0.5 * 0.1**2, 0.5 * 0.5**2], rtol=1e-3)
    simulation.set_input("push", 0.0)
    simulation.advance(200)
    assert contacts.slept["island"].all()
