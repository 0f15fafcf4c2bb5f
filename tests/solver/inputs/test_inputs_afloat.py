"""Water of tanks and set points of controllers that are set from outside, against what pumps can do."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from input_scenes import column, driven

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.inputs.ballast import HeightTargetInput, TankRateInput, TiltTargetInput
from heavylift.solver.scene.ballast import Controller, Pump
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, LinearRestoring, Sea, Tank, Water
from heavylift.solver.simulation import Simulation

RHO, G, LENGTH, BREADTH, DRAFT = 1025.0, 9.81, 97.5, 36.0, 4.5
AREA = LENGTH * BREADTH
CAPACITY = RHO * 9.0 * 9.0 * 5.0
"""Mass of a full tank [kg]."""


def barge(*inputs: Any, mass: float = 1000.0, **more: Any) -> Scene:
    """A wall-sided barge on still water with two tanks amidships."""
    weight = RHO * AREA * DRAFT
    body = RigidBody(
        "barge",
        weight - mass,
        np.diag(weight * np.array([12.6, 24.4, 24.4]) ** 2),
        centre_of_mass=np.zeros(3),
    )
    restoring = LinearRestoring(
        volume=AREA * DRAFT,
        centre_of_buoyancy=np.array([0.0, 0.0, -0.5 * DRAFT]),
        reference=np.zeros(3),
        area=AREA,
        second_moments=(BREADTH * LENGTH**3 / 12.0, LENGTH * BREADTH**3 / 12.0, 0.0),
    )
    hull = Hull(body="barge", restoring=restoring, damping=np.diag([1e6, 1e6, 2e7, 2e9, 1e10, 1e9]))
    box = {"floor": np.array([0.0, 0.0, -4.0]), "size": np.array([9.0, 9.0, 5.0])}
    tanks = (Tank(name="T", hull="barge", mass=mass, **box), Tank(name="U", hull="barge", mass=0.0, **box))
    sea = Sea(water=Water(density=RHO, gravity=G), hulls=(hull,), tanks=tanks, **more)
    return Scene((body,), forces=(Gravity(np.array([0.0, 0.0, -G])),), sea=sea, inputs=inputs)


FILL = TankRateInput(name="fill", tank="T")


def test_a_tank_is_filled_and_emptied_at_the_rates_of_its_input() -> None:
    """It stops where it is empty; a state goes on elsewhere with the levels that were written."""
    simulation = Simulation(barge(FILL), 0.1)
    settings = {10: ("fill", 500.0), 30: ("fill", -1000.0), 60: ("fill", 200.0)}
    records = driven(simulation, settings, 80)
    times = 0.1 * np.arange(1, 81)
    expected = np.interp(times, [1.0, 3.0, 5.0, 6.0, 8.0], [1000.0, 2000.0, 0.0, 0.0, 400.0])
    np.testing.assert_allclose(column(simulation, "T.mass", records), expected, atol=1e-9)
    assert simulation.inputs["fill"].unit == "kg/s"
    other = Simulation(barge(FILL), 0.1)
    other.set_input("fill", -50.0)
    other.advance(3)
    other.restore(simulation.state())
    np.testing.assert_array_equal(other.advance(20)[1], simulation.advance(20)[1])


def test_a_run_ends_where_a_tank_is_full() -> None:
    simulation = Simulation(barge(FILL, mass=CAPACITY - 1000.0), 0.1)
    simulation.set_input("fill", 400.0)
    times, records = simulation.advance(100)
    assert (times[-1], simulation.outcome) == (2.5, Outcome.LIMIT_REACHED)
    assert simulation.message == "stopped at t = 2.5 s: tank 'T' is full"
    np.testing.assert_allclose(column(simulation, "T.mass", records)[-1], CAPACITY, rtol=1e-12)


def kept(*inputs: Any) -> Scene:
    """A barge whose draft at its waterline is kept by a pump of 100 kg/s, looking once a second."""
    keep = Controller(
        name="C", hull="barge", pumps=("P",), draft=0.0, draft_at=np.zeros(3), gain=0.01, period=1.0
    )
    pump = Pump(name="P", source="sea", target="T", rate=100.0)
    made = barge(mass=0.0, pumps=(pump,), controllers=(keep,))
    assert made.sea is not None
    return replace(made, inputs=inputs)


def test_a_set_point_acts_at_the_next_look_of_its_controller() -> None:
    """The draft is right until it is set half a metre deeper at 3.5 s; from 4 s on the pump does what it can."""
    scene = kept(HeightTargetInput(name="draft", controller="C", keeps="draft", largest=6.0))
    simulation = Simulation(scene, 0.1)
    assert simulation.inputs.value("draft") == (0.0, 0.0)
    records = driven(simulation, {35: ("draft", 0.5)}, 80)
    times = 0.1 * np.arange(1, 81)
    np.testing.assert_allclose(
        column(simulation, "T.mass", records), np.interp(times, [4.0, 8.0], [0.0, 400.0]), atol=1e-6
    )
    other = Simulation(scene, 0.1)
    other.restore(simulation.state())
    assert other.inputs.value("draft") == (0.5, 0.0)
    np.testing.assert_array_equal(other.advance(30)[1], simulation.advance(30)[1])
    with pytest.raises(InputError, match=r"7 m; expected at most 6 m"):
        simulation.set_input("draft", 7.0)


@pytest.mark.parametrize(
    ("one", "words"),
    [
        (
            TiltTargetInput(name="a", controller="C", keeps="heel"),
            r"'C' does not keep 'heel'; expected one of: draft",
        ),
        (
            HeightTargetInput(name="a", controller="D", keeps="draft"),
            r"'D' is no controller; expected one of: C",
        ),
        (FILL, r"the pump 'P' fills or empties 'T'"),
    ],
)
def test_what_is_not_there_or_is_pumped_is_refused(one: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        Simulation(kept(one), 0.1)
