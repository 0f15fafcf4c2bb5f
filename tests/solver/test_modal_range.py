"""Deformations and spins beyond which modes do not hold are told, and end a run."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from solid_beams import BENDING, DENSITY, LENGTH, SIDE, beam, cantilever

from heavylift.modal.reduced import Interface
from heavylift.numerics.outcome import Outcome
from heavylift.solver.bodies.floating_frame.modal_range import ModalRange
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.scene.bodies import Driven, Free, Profile
from heavylift.solver.scene.connections import JointFrame
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

DOWN = Gravity(np.array([0.0, 0.0, -9.81]))


def hanging(share: float, **options: object) -> Simulation:
    """A cantilever so soft that its tip hangs down by a share of its length: w L^4 / 8 E I."""
    load = DENSITY * SIDE**2 * 9.81
    young = load * LENGTH**4 / (8.0 * share * LENGTH * SIDE**4 / 12.0)
    body = beam(cantilever(young=young), damping_ratio=np.full(8, 0.5))
    return Simulation(Scene((body,), (DOWN,)), 1e-3, start="equilibrium", **options)


@pytest.mark.parametrize(
    ("share", "outcome", "told"),
    [
        (0.08, Outcome.COMPLETED, False),
        (0.13, Outcome.COMPLETED, True),
        (0.17, Outcome.COMPLETED, True),
        (0.23, Outcome.MODES_LEFT, False),
        (30.0, Outcome.MODES_LEFT, False),
    ],
)
def test_deflection_at_rest(share: float, outcome: Outcome, told: bool) -> None:
    """Without a step, and with some."""
    run = hanging(share)
    found, message = run.verdict
    assert found is outcome
    assert ("deforms by" in run.warning) == told
    if outcome is Outcome.MODES_LEFT:
        assert "t = 0 s: body 'beam' deforms by" in message
        assert "'frame' or 'shell'" in message
    again = hanging(share)
    times, _ = again.advance(20)
    assert len(times) == (20 if outcome is Outcome.COMPLETED else 0)
    assert again.outcome is outcome
    assert ("deforms by" in again.warning) == told


@pytest.mark.parametrize(
    ("end", "told", "beyond"), [(0.03, False, False), (0.04, True, False), (0.07, True, True)]
)
def test_a_frame_that_follows_the_body_does_not_hide_how_far_it_bends(
    end: float, told: bool, beyond: bool
) -> None:
    """First mode of a free bar: w' / w = 4.6474 / L at its ends, so a tenth of its length would be half a radian."""
    reduced = cantilever(elements=40, free=True)
    run = Simulation(Scene((beam(reduced, motion=Free()),), ()), 1e-3)
    record = run.record()
    first = next(c.column for c in run.channels if c.name == "beam.modal_position")
    tip = np.linalg.norm(reduced.shapes_at(*reduced.locate(np.array([LENGTH, 0.0, 0.0])))[0])
    record[first] = end * LENGTH / tip
    seen = ModalRange((beam(reduced, motion=Free()),), run.channels)
    assert (seen.add(record[None]) == 0) == beyond
    np.testing.assert_allclose(seen.state[0, :2], [end, 4.6474 * end], rtol=0.02)
    assert ("turns by" in seen.warning) == told
    assert seen.left == beyond


def test_twist_of_a_shaft_is_no_large_bending() -> None:
    """Half a radian at the tip moves its corners by less than a hundredth of its length."""
    reduced = cantilever(modes=9)
    nodes, weights = reduced.locate(np.array([LENGTH, 0.0, 0.0]))
    turn = reduced.turn_at(nodes, weights)
    mode = int(np.abs(turn[:, 0] / np.linalg.norm(turn, axis=1).clip(1e-12)).argmax())
    assert abs(turn[mode, 0]) > 0.999 * np.linalg.norm(turn[mode])
    run = Simulation(Scene((beam(reduced),), ()), 1e-3)
    record = run.record()
    first = next(c.column for c in run.channels if c.name == "beam.modal_position")
    record[first + mode] = 0.5 / turn[mode, 0]
    seen = ModalRange((beam(reduced),), run.channels)
    assert seen.add(record[None]) == -1
    assert not seen.warning


@pytest.mark.parametrize(
    ("corners", "ratio", "tolerance"),
    [(1, 15.4182, 0.01), (3, 3.51602, 0.06)],
)
def test_frequency_of_a_free_bar_is_the_one_that_its_joints_leave(
    corners: int, ratio: float, tolerance: float
) -> None:
    """Pinned and free 15.418, clamped and free 3.516 sqrt(E I / m L^4): told from a third of that on.

    Three points of a face hold it some hundredths softer than the whole face.
    """
    places = np.array([[0.0, -0.01, -0.01], [0.0, 0.01, -0.01], [0.0, 0.0, 0.01]])[:corners]
    places = np.zeros((1, 3)) if corners == 1 else places
    reduced = cantilever(elements=40, points=tuple(map(tuple, places.tolist())), free=True)
    joints = tuple(
        Ball(name=f"b{k}", body_a="ground", body_b="beam", frame_a=JointFrame(p), frame_b=JointFrame(p))
        for k, p in enumerate(places)
    )
    body = beam(reduced, motion=Free())
    channels = Simulation(Scene((body,), ()), 1e-3).channels
    spin = next(c.column for c in channels if c.name == "beam.angular_velocity")
    record = np.zeros(1 + max(c.column + len(c.components) for c in channels))
    record[spin + 2] = 0.4 * ratio * np.sqrt(BENDING / (DENSITY * SIDE**2 * LENGTH**4))
    seen = ModalRange((body,), channels, joints)
    assert seen.add(record[None]) == -1
    assert seen.state[0, 2] == pytest.approx(0.4, rel=tolerance)
    assert "of its lowest frequency" in seen.warning


def spun(axis: tuple[float, float, float] = (0.0, 0.0, 1.0), most: float = 1.2) -> tuple[Simulation, float]:
    """Driven about an axis through its clamp, in a second to a share of its first frequency."""
    reduced = cantilever()
    first = float(np.sqrt(reduced.eigenvalues[0]))
    speeds = Profile(times=np.array([0.0, 1.0]), speeds=np.array([0.0, most * first]))
    motion = Driven(angle=speeds, axis=axis)
    body = beam(reduced, motion=motion, damping_ratio=np.full(8, 0.01))
    return Simulation(Scene((body,), ()), 1e-3, record_every=10), first


def test_blade_ends_at_two_thirds_of_its_frequency() -> None:
    """The record with which it ends is the first beyond, and the last that is kept; a restart ends there too."""
    run, first = spun()
    times, records = run.advance(1000)
    assert run.outcome is Outcome.MODES_LEFT
    expected = np.ceil(100 * (2.0 / 3.0) / 1.2) / 100
    assert times[-1] == pytest.approx(expected)
    assert run.step_index == round(1000 * times[-1])
    assert f"t = {times[-1]:.9g} s: body 'beam' turns with 0.67" in run.message
    spin = next(c.column for c in run.channels if c.name == "beam.angular_velocity") + 2
    np.testing.assert_allclose(records[:, spin], 1.2 * first * times, rtol=1e-6)
    again, _ = spun()
    again.advance(300)
    assert "turns with 0.36 of its lowest frequency" in again.warning
    later, _ = spun()
    later.restore(again.state())
    _, rest = later.advance(700)
    assert later.outcome is Outcome.MODES_LEFT
    assert later.message == run.message
    np.testing.assert_array_equal(rest, records[30:])
    assert "0.36" not in later.warning


def test_slender_body_may_turn_about_its_axis() -> None:
    """Nothing pulls along it: rotors turn beyond their first frequency."""
    run, _ = spun((1.0, 0.0, 0.0), most=0.9)
    run.advance(1000)
    assert run.outcome is Outcome.COMPLETED
    assert "frequency" not in run.warning


@pytest.mark.parametrize("options", [{"integrator": "thesis"}, {"tolerance": 1e-5}])
def test_every_way_to_step_ends(options: dict[str, object]) -> None:
    """Records every 10 ms, by steps of 10 us and by steps that control themselves."""
    reduced = cantilever(modes=2)
    first = float(np.sqrt(reduced.eigenvalues[0]))
    motion = Driven(angle=Profile(times=np.array([0.0, 1.0]), speeds=np.array([0.0, 1.2 * first])))
    every = 1 if "tolerance" in options else 1000
    scene = Scene((beam(reduced, motion=motion),), ())
    run = Simulation(scene, 1e-2 / every, record_every=every, **options)
    times, _ = run.advance(100 * every)
    assert run.outcome is Outcome.MODES_LEFT
    assert times[-1] == pytest.approx(0.56)


def test_notes_on_a_scene_stand_beside_warnings_of_its_run() -> None:
    """Two ball joints that hold a chord, and a deflection of 13 %: one does not hide the other."""
    load = DENSITY * SIDE**2 * 9.81
    young = load * LENGTH**4 / (8.0 * 0.13 * LENGTH * SIDE**4 / 12.0)
    body = beam(cantilever(young=young), damping_ratio=np.full(8, 0.5))
    cap = RigidBody("cap", 1e-6, 1e-9 * np.eye(3), position=np.array([LENGTH, 0.0, 0.0]))
    places = [np.array([LENGTH, y, 0.0]) for y in (-0.01, 0.01)]
    balls = tuple(
        Ball(
            name=f"ball{k}",
            body_a="beam",
            body_b="cap",
            frame_a=JointFrame(place),
            frame_b=JointFrame(place - cap.position),
        )
        for k, place in enumerate(places)
    )
    run = Simulation(Scene((body, cap), (DOWN,), joints=balls), 1e-3, start="equilibrium")
    run.advance(1)
    assert "deforms by" in run.warning
    assert "joints 'ball0', 'ball1' hold points of the flexible body 'beam'" in run.warning


def test_the_rotation_of_a_place_that_a_joint_holds_is_watched() -> None:
    """A bracket on a short stub turns where no mode moves anything far."""
    reduced = cantilever()
    motion = reduced.motion_at((LENGTH, 0.0, 0.0))
    assert motion.rotation is not None
    none = np.zeros((0, 3, 6))
    point, nodes = np.array([0.5 * LENGTH, 0.0, 0.0]), np.zeros(0, dtype=np.int64)
    bracket = Interface(point, motion.displacement, 3.0 * motion.rotation, nodes, none, none)
    body = beam(replace(reduced, interfaces={"bracket": bracket}))
    run = Simulation(Scene((body,), ()), 1e-3)
    row = np.zeros((1, len(run.record())))
    first = next(c.column for c in run.channels if c.name == "beam.modal_position")
    row[0, first] = 0.2 / float(np.linalg.norm(3.0 * motion.rotation[0]))
    sides: dict[str, Any] = {"body_a": "beam", "body_b": "load", "frame_a": JointFrame(point)}
    for kind, expected in ((FixedJoint, 0.2), (Ball, 0.2 / 3.0)):
        seen = ModalRange((body,), run.channels, (kind(name="bolt", **sides),))
        seen.add(row)
        assert seen.state[0, 1] == pytest.approx(expected, rel=0.02)
