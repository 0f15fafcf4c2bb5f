"""Largest and smallest forces between records, over every step; and forces that do not fit their elongations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from law_scenes import Run, body, eye, pulley, run, scene, wire

from heavylift.solver.force_elements.wire_rope import SpringRope
from heavylift.solver.forces.spring import Spring
from heavylift.solver.scene.connections import GROUND, Winch
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from heavylift.solver.scene.scene import Scene

STEP, DURATION, EVERY = 2e-3, 4.0, 50


def hoist() -> Scene:
    """A block on a winch rope over a pulley, a load that bounces below it, and springs, linear and by a table."""
    ropes = (
        wire(
            eye(GROUND, (-3.0, 0.0, 0.0)),
            pulley(GROUND, (0.0, 0.0, 8.0), 0.3),
            eye("block"),
            name="hoist",
            damping=2e3,
            winch=Winch(np.array([0.0, 0.5, 2.0, 2.1]), np.array([0.0, 1.0, 1.0, 0.0])),
        ),
        SpringRope(name="sling", path=(eye("block"), eye("load")), length=2.0, stiffness=3e5, damping=500.0),
    )
    forces = (
        Spring(
            name="tail",
            body_a=GROUND,
            point_a=np.array([2.0, 0.0, -6.0]),
            body_b="load",
            point_b=np.zeros(3),
            length=3.0,
            stiffness=4e4,
            damping=300.0,
        ),
        Spring(
            name="stay",
            body_a=GROUND,
            point_a=np.array([0.0, 3.0, -3.0]),
            body_b="block",
            point_b=np.zeros(3),
            length=3.0,
            damping=100.0,
            elongations=np.array([-1.0, 0.0, 1.0]),
            forces=np.array([0.0, 0.0, 5e3]),
        ),
    )
    bodies = (body("block", 300.0, (0.3, 0.0, -3.0)), body("load", 1000.0, (0.3, 0.0, -4.0)))
    return scene(bodies, forces, (), ropes)


FORCES = {"hoist": "tension", "sling": "tension", "tail": "force", "stay": "force"}


@pytest.fixture(scope="module")
def sparse() -> Run:
    """With a record at every fiftieth step."""
    return run(hoist(), STEP, DURATION, record_every=EVERY)


@pytest.fixture(scope="module")
def dense() -> Run:
    """With a record at every step."""
    return run(hoist(), STEP, DURATION)


@pytest.mark.parametrize("owner", FORCES)
def test_records_show_the_extremes_of_all_steps_between_them(owner: str, sparse: Run, dense: Run) -> None:
    """Bit for bit those of a run that records every step, interval by interval."""
    name = f"{owner}.{FORCES[owner]}"
    every = dense[name]
    np.testing.assert_array_equal(sparse[name], every[::EVERY])
    intervals = every[1:].reshape(-1, EVERY)
    np.testing.assert_array_equal(sparse[f"{name}_max"][1:], intervals.max(axis=1))
    np.testing.assert_array_equal(sparse[f"{name}_min"][1:], intervals.min(axis=1))
    assert sparse[f"{name}_max"][0] == sparse[f"{name}_min"][0] == every[0]
    np.testing.assert_array_equal(dense[f"{name}_max"], every)
    seen = np.maximum(sparse[name][1:], sparse[name][:-1])
    assert np.any(sparse[f"{name}_max"][1:] > 1.1 * seen)  # records alone miss peaks
    assert sparse.simulation.warning == ""


def test_extremes_outlive_a_stop_between_records(sparse: Run) -> None:
    """A run that is stopped in the middle of an interval, looked at, and goes on elsewhere."""
    first = Simulation(hoist(), STEP, record_every=EVERY)
    first.record()
    first.advance(EVERY * 10 + 23)
    first.record()
    second = Simulation(hoist(), STEP, record_every=EVERY)
    second.restore(first.state())
    second.record()
    rows = second.advance(round(DURATION / STEP) - second.step_index)[1]
    np.testing.assert_array_equal(rows, sparse.records[11:])


def test_steps_of_their_own_length_are_all_seen() -> None:
    """With a tolerance a record is many steps: a rope that snaps taut between two records shows its peak."""
    free = run(hoist(), 0.5, 2.0, tolerance=1e-4)
    fine = run(hoist(), 5e-4, 2.0)
    assert free["sling.tension_max"].max() == pytest.approx(fine["sling.tension"].max(), rel=0.02)
    assert free["sling.tension"].max() < 0.9 * free["sling.tension_max"].max()


@pytest.mark.parametrize(("owner", "field"), [("hoist", "tension"), ("tail", "load"), ("stay", "load")])
def test_a_false_force_is_told(owner: str, field: str) -> None:
    """A record whose force is 1.6 times what the elongation says, which is kept: both numbers and the time."""
    simulation = Simulation(hoist(), STEP)
    simulation.advance(250)
    assert simulation.warning == ""
    layout = simulation._layout
    number = layout.block_names.index(owner)
    states: list[Any] = [
        kind.state[i]
        for kind in layout.joints
        for i, entry in enumerate(kind.table)
        if int(entry.block) == number
    ]
    (state,) = states
    right, row = state[field], np.empty(simulation.column_count)
    state[field] *= 1.6
    simulation._write(row)  # as a run writes its records; one that is asked for leaves no trace
    assert f"'{owner}' has a recorded force of {1.6 * right:.6g} at t = 0.5 s" in simulation.warning
    state[field] = right
    simulation._write(row)
    assert f"'{owner}'" in simulation.warning
