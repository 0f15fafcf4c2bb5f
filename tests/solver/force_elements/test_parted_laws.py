"""What carries its elongation and has left it: ropes, tabulated springs and stops end the run, or are told."""

from __future__ import annotations

import math

import numpy as np
import pytest
from law_scenes import DOWN, NONE, G, body, eye, scene, slider, wire

from heavylift.numerics.outcome import Outcome
from heavylift.solver.force_elements.equalized import SharedLines
from heavylift.solver.forces.spring import Spring
from heavylift.solver.scene.connections import GROUND, Limits
from heavylift.solver.scene.scene import Scene
from heavylift.solver.simulation import Simulation


def swinging(length: float) -> Scene:
    """A load of 10 t on a rope, let go at an angle."""
    at = length * np.array([0.6, 0.0, -0.8])
    return scene([body("load", 1e4, at)], ropes=[wire(eye(GROUND), eye("load"), stiffness=1e8)])


def on_a_table(length: float) -> Scene:
    """The same on a spring of as much stiffness by a table."""
    stiffness = 1e8 / length
    spring = Spring(
        name="rope",
        body_a=GROUND,
        point_a=np.zeros(3),
        body_b="load",
        point_b=np.zeros(3),
        length=length,
        elongations=np.array([-1.0, 0.0, 1.0]),
        forces=np.array([-stiffness, 0.0, stiffness]),
    )
    return Scene((body("load", 1e4, length * np.array([0.6, 0.0, -0.8])),), (DOWN, spring))


def ran(scene: Scene, step: float, steps: int) -> tuple[Simulation, dict[str, np.ndarray]]:
    simulation = Simulation(scene, step)
    _, records = simulation.advance(steps)
    return simulation, {c.name: records[:, c.column] for c in simulation.channels}


@pytest.mark.parametrize("make", [swinging, on_a_table])
@pytest.mark.parametrize(("length", "share"), [(10.0, 1.0), (1.0, 1.0), (10.0, 1.0 / 3.0)])
def test_steps_like_the_period_end_the_run(make, length: float, share: float) -> None:
    """No record has a path that is longer than its force can make it, whose strain is 4e-3 at the very most."""
    period = 2.0 * math.pi * math.sqrt(length / G)
    simulation, found = ran(make(length), share * period, 300)
    assert simulation.outcome is Outcome.NOT_CLOSED
    assert "'rope': positions have left the integrated elongation" in simulation.message
    assert np.all(np.abs(found["rope.length"] - length) < 0.11 * max(1.0, length))


def test_a_sound_step_completes() -> None:
    simulation, found = ran(swinging(10.0), 0.01, 2000)
    assert simulation.outcome is Outcome.COMPLETED
    assert not simulation.warning
    assert found["monitor.carried_drift"].max() == np.abs(found["rope.drift"]).max()
    assert 0.0 < found["monitor.carried_drift"].max() < 1e-4


def stopped_block() -> Simulation:
    """A block on a slider that leans on a soft stop, whose carried value is some steps old."""
    axis = np.array([1.0, 0.0, 0.0])
    limits = Limits(lower=-10.0, upper=0.0, stiffness=1e4, damping=1e3)
    made = scene([body("block", 100.0, (0.0, 0.0, 0.0), axis)], joints=[slider(limits=limits)], field=NONE)
    simulation = Simulation(made, 1e-3)
    simulation.advance(20)
    assert not simulation.warning
    return simulation


@pytest.mark.parametrize(("shift", "outcome"), [(1e-3, Outcome.COMPLETED), (10.0, Outcome.NOT_CLOSED)])
def test_a_stop_that_left_its_joint_is_told_or_ends_the_run(shift: float, outcome: Outcome) -> None:
    simulation = stopped_block()
    kind = next(kind for kind in simulation._layout.joints if type(kind).__name__ == "ScalarLaws")
    kind.state["value"] += shift
    simulation.advance(5)
    assert simulation.outcome is outcome
    told = simulation.warning if outcome is Outcome.COMPLETED else simulation.message
    assert "'slide'" in told


def equalized(length: float) -> Scene:
    """A load that swings below two lines of one force, which no pulley reaches a stop of."""
    path = tuple(
        point for x in (-0.1, 0.1) for point in (eye(GROUND, (x, 0.0, 0.0)), eye("load", (x, 0.0, 0.0)))
    )
    lines = SharedLines(
        name="lines",
        path=path,
        lengths=np.full(2, length - 1.0),
        depth=1.0,
        up=0.9,
        down=5.0,
        axial_stiffness=1e8,
        rope_length=5.0,
        line_stiffness=1e8,
    )
    aside = 0.3 * length
    start = np.array([aside, 0.0, -1.0 - math.sqrt((length - 1.0) ** 2 - aside**2)])
    return scene([body("load", 1e4, start, (0.0, 1.0, 0.0))], ropes=[lines])


@pytest.mark.parametrize("share", [1.0, 1.0 / 3.0])
def test_depths_of_equalized_lines_that_leave_the_geometry_end_the_run(share: float) -> None:
    period = 2.0 * math.pi * math.sqrt(10.0 / G)
    simulation, _ = ran(equalized(10.0), share * period, 300)
    assert simulation.outcome is Outcome.NOT_CLOSED
    assert "rope 'lines': positions have left the integrated elongation" in simulation.message


def test_depths_of_equalized_lines_are_compared_with_the_geometry() -> None:
    simulation, found = ran(equalized(10.0), 0.01, 2000)
    assert simulation.outcome is Outcome.COMPLETED
    assert not simulation.warning
    assert 0.0 < found["monitor.carried_drift"].max() < 1e-4
    kind = next(kind for kind in simulation._layout.joints if type(kind).__name__ == "EqualizedLines")
    kind.line["depth"] += 1e-3
    simulation.advance(5)
    assert "'lines' has a recorded force" in simulation.warning
    kind.lines["largest_drift"] = 1e-4
    simulation.advance(5)
    assert simulation.outcome is Outcome.NOT_CLOSED
