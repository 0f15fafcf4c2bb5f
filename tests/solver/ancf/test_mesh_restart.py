"""Runs of frames and shells that are interrupted, repeated, recorded seldom or started with open joints."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from jointed_frames import DOWN, bar, rod

from heavylift.numerics.outcome import InputError
from heavylift.solver.joints.ball import Ball
from heavylift.solver.scene.connections import GROUND, JointFrame
from heavylift.solver.scene.mesh_shapes import rectangle
from heavylift.solver.scene.meshes import ShellBody, ShellSection
from heavylift.solver.scene.scene import Scene
from heavylift.solver.simulation import Simulation

pytestmark = pytest.mark.slow  # each scene compiles for half a minute


def scene(elasticity: str = "auto", gap: float = 0.0) -> Scene:
    """A pinned frame, a rod hung on its end, a plate hung on the rod; the pin may be open by a gap [m]."""
    ends = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)
    frame = bar("frame", *ends, 3, 1e8, elasticity=elasticity, drift_tolerance=1e-5)
    link = rod("link", (1.0, 0.0, 0.0), (1.0, 0.0, -0.5), 2.0)
    mesh = rectangle(0.8, 0.6, 2, 2)
    plate = ShellBody(
        name="plate",
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(ShellSection(0.004, 2700.0, 7e8, 0.3),),
        position=np.array([1.0, 0.0, -0.5]),
        elasticity=elasticity,
    )
    top, bottom = JointFrame(np.array([-0.25, 0.0, 0.0])), JointFrame(np.array([0.25, 0.0, 0.0]))
    joints = (
        Ball(name="pin", body_a=GROUND, body_b="frame", frame_a=JointFrame(np.array([0.0, 0.0, gap]))),
        Ball(
            name="hook",
            body_a="frame",
            body_b="link",
            frame_a=JointFrame(np.array([1.0, 0.0, 0.0])),
            frame_b=top,
        ),
        Ball(name="eye", body_a="link", body_b="plate", frame_a=bottom, frame_b=JointFrame(np.zeros(3))),
    )
    return Scene((frame, link, plate), (DOWN,), (), joints)


SCHEMES = ("carried", "energy-momentum", "auto", "explicit")
LONG, SHORT = 2e-3, 5e-6


def step_of(elasticity: str) -> float:
    return SHORT if elasticity == "explicit" else LONG


def test_the_scene_changes_over_on_its_way() -> None:
    """So that what is carried of the change is looked at below."""
    simulation = Simulation(scene("auto"), LONG)
    simulation.advance(200)
    assert "changed over" in simulation.warning


def test_a_drift_is_told_where_nothing_changes_over() -> None:
    """A tenth of what it takes is 20 MPa in steel: no stress is wrong by so much without a word."""
    simulation, heard = Simulation(scene("carried"), LONG), ""
    while "drifted" not in heard:
        simulation.advance(1)
        heard = simulation.warning
    assert "the integrated strains of" in heard
    assert "'energy-momentum'" in heard
    assert "changed over" not in heard


@pytest.mark.parametrize("elasticity", SCHEMES)
def test_restart_is_bit_for_bit(elasticity: str) -> None:
    """In the same object and in another one, wherever the run is cut."""
    step = step_of(elasticity)
    whole = Simulation(scene(elasticity), step)
    _, expected = whole.advance(200)
    for cut in (1, 77, 150):
        first = Simulation(scene(elasticity), step)
        _, before = first.advance(cut)
        state = first.state()
        other = Simulation(scene(elasticity), step)
        other.restore(state)
        _, after = other.advance(200 - cut)
        assert np.array_equal(np.vstack([before, after]), expected)
        first.advance(10)
        first.restore(state)
        assert np.array_equal(first.advance(200 - cut)[1], after)
        assert other.warning == whole.warning


def test_restart_with_a_tolerance_is_bit_for_bit() -> None:
    whole = Simulation(scene(), 0.01, tolerance=1e-4)
    _, expected = whole.advance(40)
    first = Simulation(scene(), 0.01, tolerance=1e-4)
    _, before = first.advance(15)
    other = Simulation(scene(), 0.01, tolerance=1e-4)
    other.restore(first.state())
    assert np.array_equal(np.vstack([before, other.advance(25)[1]]), expected)


@pytest.mark.parametrize("elasticity", SCHEMES)
def test_runs_repeat_and_rare_records_are_the_same(elasticity: str) -> None:
    step = step_of(elasticity)
    runs = [Simulation(scene(elasticity), step, record_every=every).advance(120) for every in (1, 1, 8)]
    assert [len(times) for times, _ in runs] == [120, 120, 15]
    assert np.array_equal(runs[0][1], runs[1][1])
    assert np.array_equal(runs[2][1], runs[0][1][7::8])
    assert np.array_equal(runs[2][0], runs[0][0][7::8])


def test_state_of_another_mesh_is_refused() -> None:
    state = Simulation(scene(), LONG).state()
    changed = scene()
    plate = changed.bodies[2]
    other = replace(plate, sections=(replace(plate.sections[0], thickness=0.005),))
    with pytest.raises(InputError, match="digest"):
        Simulation(replace(changed, bodies=(*changed.bodies[:2], other)), LONG).restore(state)


def test_open_joint_is_named() -> None:
    with pytest.raises(InputError, match="pin"):
        Simulation(scene(gap=0.01), LONG).record()


def test_open_joint_is_closed_on_demand() -> None:
    """By displacing what it may: the pin is closed and the motion that follows keeps it so."""
    simulation = Simulation(scene(gap=0.01), LONG, start="project")
    first = simulation.record()
    columns = {channel.name: channel.column for channel in simulation.channels}
    assert first[columns["monitor.violation"]] < 1e-9
    place = columns["frame.position"]
    np.testing.assert_allclose(first[place : place + 3], [0.0, 0.0, 0.01], atol=1e-8)
    _, rows = simulation.advance(100)
    assert rows[:, columns["monitor.violation"]].max() < 1e-4


def test_errors_of_a_linkage_fall_with_the_tolerance() -> None:
    """Against a hundred fixed steps an interval; a hundredth of the tolerance is at least five times better."""
    fine = Simulation(scene("energy-momentum"), 1e-4, record_every=100).advance(3000)[1]
    channel = next(c for c in Simulation(scene(), 0.01).channels if c.name == "link.position")
    errors = []
    for tolerance in (1e-3, 1e-5):
        simulation = Simulation(scene("energy-momentum"), 0.01, tolerance=tolerance)
        found = simulation.advance(30)[1]
        columns = slice(channel.column, channel.column + 3)
        errors.append(np.abs(found[:, columns] - fine[:, columns]).max())
    assert errors[1] < 0.2 * errors[0]
    assert errors[1] < 5e-5
