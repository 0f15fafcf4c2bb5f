"""What drives something fails, and works again: closed forms of where it stands, and what cannot be told meanwhile."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.scenario.actions.drive import DriveSpeed
from heavylift.solver.scenario.actions.fail import Fail
from heavylift.solver.scenario.actions.restore import Restore
from heavylift.solver.scenario.actions.tank import TankRate
from heavylift.solver.scenario.actions.winch import WinchFollow, WinchHaul, WinchSpeed
from heavylift.solver.scene.ballast import Controller, Pump
from heavylift.solver.scene.bodies import Fixed
from heavylift.solver.scene.connections import GROUND, RopePoint
from heavylift.solver.scene.scenario import Condition, Phase, Scenario
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, LinearRestoring, Sea, Tank, Water
from heavylift.solver.scene.signals import Signal, Term
from heavylift.solver.simulation import Simulation

G, STEP = 9.81, 1e-2


def phase(name: str, time: float, *actions: Any) -> Phase:
    """That takes a time [s]."""
    return Phase(name, actions, (Condition(None, time),))


def histories(made: Scene, duration: float) -> tuple[np.ndarray, dict[str, np.ndarray], Simulation]:
    """Of every step, the start included."""
    simulation = Simulation(made, STEP)
    first = simulation.record()
    times, records = simulation.advance(round(duration / STEP))
    assert simulation.outcome is Outcome.COMPLETED, simulation.message
    records = np.vstack([first, records])
    named = {c.name: records[:, c.column : c.column + len(c.components)] for c in simulation.channels}
    return np.append(0.0, times), {k: v[:, 0] if v.shape[1] == 1 else v for k, v in named.items()}, simulation


def hoisted(*phases: Phase) -> Scene:
    """Two loads on a rope each, and a mast that can be driven."""
    ropes = tuple(
        Rope(
            name=name,
            path=(RopePoint(GROUND, np.array([x, 0.0, 30.0])), RopePoint(f"load_{name}", np.zeros(3))),
            axial_stiffness=1e7,
            damping=2e4,
            tension=1e3 * G,
        )
        for name, x in (("a", 0.0), ("b", 10.0))
    )
    loads = [
        RigidBody(f"load_{name}", 1e3, np.eye(3), position=np.array([x, 0.0, 0.0]))
        for name, x in (("a", 0.0), ("b", 10.0))
    ]
    mast = RigidBody("mast", 1e3, np.eye(3), position=np.array([20.0, 0.0, 0.0]), motion=Fixed())
    return Scene(
        (*loads, mast), forces=(Gravity(np.array([0.0, 0.0, -G])),), ropes=ropes, scenario=Scenario(phases)
    )


def test_a_winch_that_fails_stands_and_so_does_what_follows_it() -> None:
    """At once, where it is: 0.3 m/s for 2 s; when it works again it stands until it is told something."""
    made = hoisted(
        phase("lift", 2.0, WinchFollow("b", "a", 2.0), WinchSpeed("a", 0.3), DriveSpeed("mast.x", 0.4)),
        phase("broken", 1.0, Fail("a", "winch"), Fail("mast.x", "drive")),
        phase("repaired", 1.0, Restore("a", "winch"), Restore("mast.x", "drive")),
        phase("on", 2.0, WinchHaul("a", -0.2, 0.2), DriveSpeed("mast.x", -0.1)),
    )
    times, found, run = histories(made, 6.0)
    hauled = np.interp(times, [0.0, 2.0, 4.0, 5.0, 6.0], [0.0, 0.6, 0.6, 0.4, 0.4])
    for name, ratio in (("a", 1.0), ("b", 2.0)):
        np.testing.assert_allclose(
            found[f"{name}.rest_length"][0] - found[f"{name}.rest_length"], ratio * hauled, atol=1e-12
        )
    moved = np.interp(times, [0.0, 2.0, 4.0, 6.0], [0.0, 0.8, 0.8, 0.6])
    np.testing.assert_allclose(found["mast.position"][:, 0] - 20.0, moved, atol=1e-12)
    assert [line.text for line in run.operation.log if "fail" in line.text or "again" in line.text]
    balance = found["energy.balance"]
    assert np.abs(balance - balance[0]).max() < 1e-6 * np.abs(found["energy.drive_work"]).max()


def test_a_winch_that_fails_has_not_arrived() -> None:
    """Who waits for it waits until it has been told anew; a run that goes on from a state in between is the same."""
    told = Signal((Term("a"),), "arrived")
    made = hoisted(
        Phase("lift", (WinchHaul("a", 1.0, 0.5),), (Condition(None, 1.0),)),
        Phase("broken", (Fail("a", "winch"),), (Condition(told, 0.0), Condition(None, 1.5)), ends_with="any"),
        Phase("on", (Restore("a", "winch"), WinchHaul("a", 0.5, 0.5)), (Condition(told, 0.0),)),
    )
    times, found, run = histories(made, 4.0)
    ends = [line.time for line in run.operation.log if line.event == "done"]
    np.testing.assert_allclose(ends, [1.0, 2.5, 3.5], atol=1e-9)
    np.testing.assert_allclose(found["a.rest_length"][0] - found["a.rest_length"][-1], 1.0, atol=1e-12)
    first, second = Simulation(made, STEP), Simulation(made, STEP)
    first.advance(170)
    second.restore(first.state())
    _, records = second.advance(230)
    column = next(c.column for c in second.channels if c.name == "a.rest_length")
    np.testing.assert_array_equal(records[:, column], found["a.rest_length"][171:])
    assert len(times) == 401


REFUSED = {
    "told while it has failed": (
        (Fail("a", "winch"), WinchSpeed("a", 0.1)),
        "the actuator of 'a' has failed",
    ),
    "followed while it has failed": (
        (Fail("a", "winch"), WinchFollow("b", "a")),
        "the actuator of 'a' has failed",
    ),
    "fails twice": ((Fail("a", "winch"), Fail("a", "winch")), "has failed already"),
    "works": ((Restore("a", "winch"),), "has not failed"),
    "is not there": ((Fail("c", "winch"),), "'c' is no rope"),
    "no such drive": ((Fail("mast.w", "drive"),), "'mast.w' is no drive"),
    "no such pump": ((Fail("p", "pump"),), "'p' is no pump"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_makes_no_sense_is_refused_before_the_run(what: str) -> None:
    """With the name of it."""
    actions, words = REFUSED[what]
    with pytest.raises(InputError, match=words):
        Simulation(hoisted(phase("p", 1.0, *actions)), STEP)


RHO, LENGTH, BREADTH, DRAFT = 1025.0, 97.5, 36.0, 4.5
AREA = LENGTH * BREADTH


def floating(*phases: Phase, controllers: tuple[Controller, ...], pumps: tuple[Pump, ...]) -> Scene:
    """A wall-sided barge with two tanks amidships, whose pumps keep its draft."""
    mass = RHO * AREA * DRAFT
    barge = RigidBody(
        "barge", mass, np.diag(mass * np.array([12.6, 24.4, 24.4]) ** 2), centre_of_mass=np.zeros(3)
    )
    restoring = LinearRestoring(
        volume=AREA * DRAFT,
        centre_of_buoyancy=np.array([0.0, 0.0, -0.5 * DRAFT]),
        reference=np.zeros(3),
        area=AREA,
        second_moments=(BREADTH * LENGTH**3 / 12.0, LENGTH * BREADTH**3 / 12.0, 0.0),
    )
    hull = Hull(body="barge", restoring=restoring, damping=np.diag([1e6, 1e6, 2e7, 2e9, 1e10, 1e9]))
    tanks = tuple(
        Tank(
            name=name,
            hull="barge",
            floor=np.array([0.0, 0.0, -4.0]),
            size=np.array([9.0, 9.0, 5.0]),
            mass=0.0,
        )
        for name in ("T", "U")
    )
    sea = Sea(
        water=Water(density=RHO, gravity=G), hulls=(hull,), tanks=tanks, pumps=pumps, controllers=controllers
    )
    return Scene((barge,), forces=(Gravity(np.array([0.0, 0.0, -G])),), sea=sea, scenario=Scenario(phases))


def pump(name: str, target: str, **more: Any) -> Pump:
    """From the sea, 100 kg/s at most."""
    return Pump(**({"name": name, "source": "sea", "target": target, "rate": 100.0} | more))


def test_a_pump_of_a_controller_fails_and_the_other_does_what_it_can() -> None:
    """Both are at their limit; the water of the one that has failed stays, the other one goes on alone."""
    keep = Controller(
        name="C",
        hull="barge",
        pumps=("P", "Q"),
        draft=DRAFT + 0.5,
        draft_at=np.zeros(3),
        gain=0.01,
        period=1.0,
    )
    made = floating(
        phase("both", 4.0),
        phase("one", 4.0, Fail("P", "pump")),
        phase("again", 4.0, Restore("P", "pump")),
        controllers=(keep,),
        pumps=(pump("P", "T"), pump("Q", "U")),
    )
    times, found, run = histories(made, 12.0)
    np.testing.assert_allclose(
        found["T.mass"], np.interp(times, [0.0, 4.0, 8.0, 12.0], [0.0, 400.0, 400.0, 800.0]), atol=1e-9
    )
    np.testing.assert_allclose(found["U.mass"], 100.0 * times, atol=1e-9)
    first, second = Simulation(made, STEP), Simulation(made, STEP)
    first.advance(600)
    second.restore(first.state())
    _, records = second.advance(600)
    column = next(c.column for c in second.channels if c.name == "T.mass")
    np.testing.assert_array_equal(records[:, column], found["T.mass"][601:])
    assert run.outcome is Outcome.COMPLETED


def test_a_pump_that_follows_its_own_plan_cannot_fail() -> None:
    """Its plan is known before the run."""
    planned = pump("P", "T", times=np.array([0.0, 1.0]), rates=np.array([10.0, 10.0]))
    with pytest.raises(InputError, match="follows its own plan"):
        Simulation(floating(phase("p", 1.0, Fail("P", "pump")), controllers=(), pumps=(planned,)), STEP)


def test_the_pump_of_a_tank_fails() -> None:
    """20 kg/s for 3 s, then nothing, then again."""
    made = floating(
        phase("fill", 3.0, TankRate("T", 20.0)),
        phase("broken", 2.0, Fail("T", "tank")),
        phase("on", 2.0, Restore("T", "tank"), TankRate("T", 10.0)),
        controllers=(),
        pumps=(),
    )
    times, found, _ = histories(made, 7.0)
    np.testing.assert_allclose(
        found["T.mass"], np.interp(times, [0.0, 3.0, 5.0, 7.0], [0.0, 60.0, 60.0, 80.0]), atol=1e-9
    )
