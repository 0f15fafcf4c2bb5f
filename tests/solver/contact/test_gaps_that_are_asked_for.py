"""Distances of surfaces that are out of reach: measured for whoever asks for them, and no number for nobody."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mesh_contact_scenes import body, run, scene

from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.solver.scene.bodies import Driven, Harmonic, Profile
from heavylift.solver.scene.collisions import CollisionSurface
from heavylift.solver.scene.scenario import Condition, Phase, Scenario
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.scene.signals import Signal, Term
from heavylift.solver.simulation import Simulation

STEP, EVERY, HEIGHT = 1e-2, 50, 3.0
AMPLITUDE, FREQUENCY = 0.7, 0.83
"""Of a floor that heaves below a box at rest: its highest places lie between records."""


def hovering(**options) -> Scene:
    """A box over a floor that heaves, without gravity."""
    heave = Profile(harmonics=(Harmonic(amplitude=AMPLITUDE, frequency=FREQUENCY, phase=0.0),))
    floor = RigidBody("raft", 1e3, np.eye(3), motion=Driven(z=heave))
    made = scene(
        [(body("box", (0.0, 0.0, HEIGHT + 0.5)), box_surface(1.0))], gravity=(0.0, 0.0, 0.0), pairs=[]
    )
    surfaces = (CollisionSurface(name="floor", body="raft", surface=plane_surface(20.0)), *made.surfaces)
    pair = scene([(body("box"), box_surface(1.0))], plane_surface(20.0), **options).collisions
    return replace(made, bodies=(floor, *made.bodies), surfaces=surfaces, collisions=pair)


def gap_at(times: np.ndarray) -> np.ndarray:
    """In closed form [m]."""
    return HEIGHT - AMPLITUDE * np.sin(2.0 * np.pi * FREQUENCY * times)


@pytest.mark.parametrize("turn", [False, True])
def test_a_gap_that_is_asked_for_is_the_distance_in_records_and_in_all_steps(turn: bool) -> None:
    """At records, and the smallest of all steps between them, which records do not show."""
    found = run(hovering(clearance=True, swap=turn), STEP, 6.0, record_every=EVERY)
    np.testing.assert_allclose(found["floor-box.gap"], gap_at(found.times), atol=1e-12)
    steps = gap_at(STEP * np.arange(1, 601)).reshape(-1, EVERY).min(axis=1)
    np.testing.assert_allclose(found["floor-box.gap_min"][1:], steps, atol=1e-12)
    assert np.any(found["floor-box.gap"][1:] > found["floor-box.gap_min"][1:] + 0.1)


def test_a_gap_that_nobody_asks_for_is_no_number_and_changes_nothing_else() -> None:
    """The reach of the search is no distance."""
    plain, asked = (run(hovering(clearance=c), STEP, 2.0, record_every=EVERY) for c in (False, True))
    assert np.isnan(plain["floor-box.gap"]).all()
    assert np.isnan(plain["floor-box.gap_min"]).all()
    for name in ("box.position", "raft.position", "floor-box.normal_force", "energy.balance"):
        np.testing.assert_array_equal(plain[name], asked[name])


def test_a_phase_waits_for_the_distance() -> None:
    """A floor that sinks: the gap is above a value when sin(w t) is below, which nobody had to ask for otherwise."""
    value = HEIGHT + 0.5 * AMPLITUDE
    signal = Signal((Term("floor-box.gap"),))
    phases = (Phase("wait", until=(Condition(signal, value),)),)
    made = replace(hovering(), scenario=Scenario(phases))
    found = run(made, STEP, 3.0, record_every=EVERY)
    (end,) = [line.time for line in found.simulation.operation.log if line.event == "done"]
    expected = (np.pi + np.pi / 6.0) / (2.0 * np.pi * FREQUENCY)
    assert end == pytest.approx(expected, abs=STEP**2)
    np.testing.assert_allclose(found["floor-box.gap"], gap_at(found.times), atol=1e-12)


def test_restart_keeps_the_smallest_distance() -> None:
    """Bit for bit, from a state in the middle of an interval between records."""
    made = hovering(clearance=True)
    whole = run(made, STEP, 2.0, record_every=EVERY)
    first, second = (Simulation(made, STEP, record_every=EVERY) for _ in range(2))
    first.advance(75)
    second.restore(first.state())
    _, records = second.advance(125)
    np.testing.assert_array_equal(records, whole.records[2:])
