"""Flexible bodies that joints hold with their directions: bodies in a row, free flight, torsion, continuation."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import eigh, null_space
from solid_beams import BENDING, DENSITY, LENGTH, SIDE, YOUNG, beam, cantilever, model

from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility
from heavylift.numerics.rotation import quaternion_from_rotation_vector
from heavylift.solver.bodies.floating_frame.packing import frame_inertia
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.forces.motor import JointMotor
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.universal import Universal
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.connections import GROUND, Joint, JointFrame, RopePoint, axes_about
from heavylift.solver.scene.scene import FlexibleBody, Free, Gravity, RigidBody, Scene, Sensor
from heavylift.solver.sensors.relative_motions import RelativeMotion
from heavylift.solver.simulation import Simulation
from heavylift.solver.start.rows import StartRows

Array = NDArray[np.float64]
ROOT, TIP = np.zeros(3), np.array([LENGTH, 0.0, 0.0])
ENDS = (tuple(ROOT.tolist()), tuple(TIP.tolist()))
DOWN = Gravity(np.array([0.0, 0.0, -9.81]))


def channels(run: Simulation) -> dict[str, Array]:
    row = run.record()
    return {c.name: row[c.column : c.column + len(c.components)] for c in run.channels}


def held(name: str, at: Array, **more: Any) -> FlexibleBody:
    """A free beam of 1 m with attachment modes at both ends."""
    return replace(
        beam(cantilever(free=True, modes=20, held=ENDS), motion=Free()), name=name, position=at, **more
    )


def joined(name: str, a: str, b: str, place_a: Array = TIP, place_b: Array = ROOT) -> FixedJoint:
    return FixedJoint(name=name, body_a=a, body_b=b, frame_a=JointFrame(place_a), frame_b=JointFrame(place_b))


def test_two_beams_in_a_row_have_the_frequencies_of_one() -> None:
    """Two free beams of 1 m and one of 2 m with the same elements: rigid motions, bending, torsion, extension."""
    bodies = (held("first", ROOT), held("second", TIP))
    rows = StartRows(pack_scene(Scene(bodies, joints=(joined("weld", "first", "second"),))))
    rows.fill()
    reduced = bodies[0].reduced
    n = 6 + reduced.mode_count
    M, K = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, 2 * n))
    inertia, coupling = frame_inertia(reduced.integrals)
    for first in (0, n):
        own = slice(first, first + n)
        M[own, own] = np.block([[inertia, coupling], [coupling.T, np.eye(n - 6)]])
        K[own, own] = np.diag([*np.zeros(6), *reduced.eigenvalues])
    Z = null_space(rows.jacobian().toarray())
    assert Z.shape[1] == 2 * n - 6
    found = np.sqrt(eigh(Z.T @ K @ Z, Z.T @ M @ Z, eigvals_only=True).clip(0.0)) / (2.0 * np.pi)
    whole = model(40, length=2.0 * LENGTH)
    expected = eigenmodes(whole, 8, flexibility=Flexibility(whole, ())).frequencies
    assert np.all(found[:6] < 1e-3 * expected[0])
    np.testing.assert_allclose(found[6:14], expected, rtol=1e-4)


def test_two_beams_in_a_row_hang_down_like_one() -> None:
    """``w L^4 / 8 E I`` of 2 m and ``w L^2 / 2 (5/6) G A``; the weld bears what the outer half weighs."""
    first = replace(beam(cantilever(elements=20, modes=20, held=(ENDS[1],))), name="first")
    bodies = (first, held("second", TIP))
    scene = Scene(bodies, (DOWN,), (Sensor("tip", "second", TIP),), (joined("weld", "first", "second"),))
    values = channels(Simulation(scene, 1e-4, start="equilibrium"))
    w, L = DENSITY * SIDE**2 * 9.81, 2.0 * LENGTH
    sag = w * L**4 / (8.0 * BENDING) + 0.5 * w * L**2 / (5.0 / 6.0 * 0.5 * YOUNG * SIDE**2)
    np.testing.assert_allclose(values["tip.position"][2], -sag, rtol=1e-3)
    np.testing.assert_allclose(values["weld.reaction_moment"][1], -0.5 * w * LENGTH**2, rtol=1e-3)


@cache
def corner() -> Scene:
    """Two soft beams welded at a right angle, tumbling in free flight."""
    turned = quaternion_from_rotation_vector(np.array([0.0, 0.0, 0.5 * np.pi]))
    soft = cantilever(free=True, modes=6, held=ENDS, young=2e9)
    spin = np.array([3.0, 2.0, 5.0])
    first = replace(beam(soft, motion=Free()), name="first", angular_velocity=spin)
    second = replace(
        beam(soft, motion=Free()),
        name="second",
        position=TIP,
        orientation=turned,
        velocity=np.cross(spin, TIP),
        angular_velocity=np.array([spin[1], -spin[0], spin[2]]),
    )
    axes = axes_about(np.array([0.0, 0.0, 1.0]))
    back = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    weld = FixedJoint(
        name="weld",
        body_a="first",
        body_b="second",
        frame_a=JointFrame(TIP, axes),
        frame_b=JointFrame(ROOT, back @ axes),
    )
    return Scene((first, second), (), (), (weld,))


@pytest.mark.slow
def test_a_welded_corner_tumbles_with_its_energy_and_momenta() -> None:
    """Over two turns: energy and angular momentum to second order in the step, the weld closed to third."""
    drifts, gaps, turns = [], [], []
    for step in (4e-4, 2e-4):
        run = Simulation(corner(), step, record_every=round(2e-2 / step))
        rows = np.array([run.record(), *run.advance(round(2.0 / step))[1]])
        assert not run.outcome, run.message
        at = {c.name: slice(c.column, c.column + len(c.components)) for c in run.channels}
        linear, angular = (rows[:, at[f"momentum.{name}"]] for name in ("linear", "angular"))
        assert np.abs(linear - linear[0]).max() < 1e-10 * np.abs(linear).max()
        turns.append(float(np.abs(angular - angular[0]).max() / np.abs(angular).max()))
        energy = rows[:, at["energy.kinetic"]] + rows[:, at["energy.elastic"]]
        drifts.append(float(np.ptp(energy) / energy[0, 0]))
        gaps.append(float(rows[:, at["monitor.violation"]].max()))
        assert rows[:, at["energy.elastic"]].max() > 1e-3 * energy[0, 0]
    assert drifts[1] < 0.3 * drifts[0] < 1e-3
    assert gaps[1] < 0.2 * gaps[0] < 1e-5
    assert turns[1] < 0.3 * turns[0] < 1e-6


def test_a_shaft_of_bricks_behind_a_universal_joint_is_twisted() -> None:
    """Torque T about a shaft at an angle b to the beam: the cross passes a moment square to both of its pins.

    With the pin on the beam across both shafts that is T about the shaft: T cos b twists the beam and T sin b bends it.
    The twist is that of the finite element model, whose attachment modes have all its compliance; the bending that of a
    beam.
    """
    b, torque = np.radians(30.0), 2.0
    held_tip = cantilever(held=(ENDS[1],))
    along = np.array([np.cos(b), np.sin(b), 0.0])
    shaft = RigidBody("shaft", 1.0, 1e-3 * np.eye(3), position=TIP)
    pin = np.array([0.0, 0.0, 1.0])  # on the beam, across both
    other = np.cross(pin, along)
    joints: tuple[Joint, ...] = (
        Universal(
            name="cross",
            body_a="beam",
            body_b="shaft",
            frame_a=JointFrame(TIP, axes_about(pin)),
            frame_b=JointFrame(ROOT, axes_about(other)),
        ),
        Hinge(
            name="bearing",
            body_a=GROUND,
            body_b="shaft",
            frame_a=JointFrame(TIP + along, axes_about(along)),
            frame_b=JointFrame(along, axes_about(along)),
        ),
    )
    turn = RelativeMotion(name="seen", body_a=GROUND, body_b="beam", point_a=ROOT, point_b=TIP)
    push = JointMotor(name="push", joint="bearing", load=torque)
    run = Simulation(Scene((beam(held_tip), shaft), (push, turn), joints=joints), 1e-4, start="equilibrium")
    values = channels(run)
    moment = values["cross.reaction_moment"]
    rotation = held_tip.motion_at(TIP).rotation
    assert rotation is not None
    compliance = float(np.sum(rotation[:, 0] ** 2 / held_tip.eigenvalues))
    np.testing.assert_allclose(moment, -torque * along, rtol=1e-3, atol=1e-3)
    np.testing.assert_allclose(values["seen.rotation"][0], torque * np.cos(b) * compliance, rtol=1e-3)
    bent = torque * np.sin(b) * LENGTH / (4.0 * BENDING)  # the shaft holds the tip
    np.testing.assert_allclose(values["seen.rotation"][1], bent, rtol=2e-2)


def test_a_continuation_has_the_same_bits() -> None:
    """Half of the steps, a state, and the other half by another simulation."""
    whole = Simulation(corner(), 4e-4, record_every=50)
    expected = whole.advance(200)[1]
    first = Simulation(corner(), 4e-4, record_every=50)
    first.advance(100)
    second = Simulation(corner(), 4e-4, record_every=50)
    second.restore(first.state())
    np.testing.assert_array_equal(second.advance(100)[1], expected[-2:])


def test_the_torque_of_a_motor_bends_the_beam() -> None:
    """Of a hinge that holds the tip of a cantilever: it turns by T L / 4 E I."""
    torque = 3.0
    axes = axes_about(np.array([0.0, 1.0, 0.0]))
    arm = RigidBody("arm", 1.0, 1e-3 * np.eye(3), position=TIP)
    sides = {"frame_a": JointFrame(TIP, axes), "frame_b": JointFrame(ROOT, axes)}
    joints: tuple[Joint, ...] = (
        Hinge(name="pin", body_a="beam", body_b="arm", **sides),
        joined("stand", GROUND, "arm", TIP, ROOT),
    )
    push = JointMotor(name="push", joint="pin", load=torque)
    turn = RelativeMotion(name="seen", body_a=GROUND, body_b="beam", point_a=ROOT, point_b=TIP)
    bodies = beam(cantilever(elements=40, held=(ENDS[1],))), arm
    values = channels(Simulation(Scene(bodies, (push, turn), joints=joints), 1e-4, start="equilibrium"))
    np.testing.assert_allclose(values["seen.rotation"][1], -torque * LENGTH / (4.0 * BENDING), rtol=1e-3)
    np.testing.assert_allclose(values["seen.position"], TIP, atol=1e-9)


@pytest.mark.slow
def test_a_rope_over_a_sheave_turns_the_place_that_carries_it() -> None:
    """A weight swings on a rope over a sheave at the tip, out of its plane: the energy balances to second order."""
    reduced = cantilever(held=(ENDS[1],), young=15e9)
    weight = RigidBody("weight", 0.2, 1e-4 * np.eye(3), position=np.array([1.05, 0.1, -0.6]))
    path = (
        RopePoint(GROUND, np.array([0.4, 0.1, 0.4])),
        RopePoint("beam", TIP, radius=0.05, axis=np.array([0.0, 1.0, 0.2])),
        RopePoint("weight", ROOT),
    )
    rope = Rope(name="rope", path=path, axial_stiffness=2e4)
    drifts = []
    for step in (2e-3, 1e-3):
        scene = Scene((beam(reduced), weight), (DOWN,), ropes=(rope,))
        run = Simulation(scene, step, record_every=round(2e-2 / step))
        rows = np.array([run.record(), *run.advance(round(1.0 / step))[1]])
        assert not run.outcome, run.message
        balance = rows[:, next(c.column for c in run.channels if c.name == "energy.balance")]
        drifts.append(float(np.ptp(balance)))
    assert drifts[1] < 0.3 * drifts[0] < 1e-6
