"""Joints that hold directions of a body with modes: these turn with their places, and moments bend the body."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse import eye_array
from solid_beams import BENDING, DENSITY, LENGTH, SIDE, YOUNG, beam, cantilever

from heavylift.modal.invariants import shape_integrals
from heavylift.modal.reduced import ReducedBody
from heavylift.solver.forces.point import PointForce
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.distance import Distance
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.guide import Guide
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.planar import Planar
from heavylift.solver.joints.slider import Slider
from heavylift.solver.joints.universal import Universal
from heavylift.solver.layout import Layout, pack_scene
from heavylift.solver.markers import MarkerBook, pack_markers
from heavylift.solver.scene.connections import GROUND, JointFrame, axes_about
from heavylift.solver.scene.scene import FlexibleBody, Free, Gravity, RigidBody, Scene, Sensor
from heavylift.solver.sensors.relative_motions import RelativeMotion
from heavylift.solver.simulation import Simulation
from heavylift.solver.start.rows import StartRows

Array = NDArray[np.float64]

ROOT, TIP = np.zeros(3), np.array([LENGTH, 0.0, 0.0])
DOWN = Gravity(np.array([0.0, 0.0, -9.81]))
SIDES = ("name", "body_a", "body_b", "frame_a", "frame_b")
TURNING = (FixedJoint, Hinge, Slider, Planar, Guide)


def arm(at: Any) -> RigidBody:
    return RigidBody("arm", 2.0, 1e-3 * np.eye(3), position=np.array(at, dtype=float))


def heights(run: Simulation) -> dict[str, float]:
    """Of all positions at the start."""
    row = run.record()
    return {c.name: float(row[c.column + 2]) for c in run.channels if c.name.endswith(".position")}


def packed(
    kind: Any, at: Any, body: FlexibleBody | None = None, *, first: bool = True, axis: Any = (0, 1, 0)
) -> Layout:
    """A rigid body at a place of the beam, by one joint."""
    frame = JointFrame(np.array(at, dtype=float), axes_about(np.array([0.0, 1.0, 0.0])))
    other = JointFrame(np.zeros(3), frame.axes)
    sides: dict[str, Any] = {"body_a": "beam", "frame_a": frame, "body_b": "arm", "frame_b": other}
    if not first:
        sides = {"body_b": "beam", "frame_b": frame, "body_a": "arm", "frame_a": other}
    return pack_scene(Scene((body or beam(cantilever()), arm(at)), joints=(kind(name="bolt", **sides),)))


def turned(layout: Layout) -> set[bool]:
    """Of the directions of the beam: whether modes turn them."""
    markers = layout.bodies[0].markers
    return set(markers["turned"][markers["direction"]].tolist())


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize("kind", TURNING)
def test_directions_turn_with_their_place(kind: Any, first: bool) -> None:
    """At the tip of a cantilever; not where it is clamped, nor beside the nodes there; at either end if it is free."""
    assert turned(packed(kind, TIP, first=first)) == {True}
    assert turned(packed(kind, ROOT, first=first)) == {False}
    assert turned(packed(kind, (0.0, 0.01, -0.005), first=first)) == {False}
    assert turned(packed(kind, ROOT, beam(cantilever(free=True), motion=Free()), first=first)) == {True}


def displaced(rows: StartRows, increment: Array) -> Array:
    """Violations of all rows after a displacement, which is taken back."""
    before = rows.snapshot()
    rows.move(increment)
    rows.fill()
    found = rows.residual.copy()
    rows.restore(before)
    return found


def test_rows_are_the_derivatives_of_what_they_hold() -> None:
    """Of every joint that holds directions, on a free body whose places turn by 0.2 rad and more; fourth order."""
    places = [(LENGTH, 0.0, 0.0), (0.4, 0.01, 0.0), (0.7, 0.0, 0.0), (0.0, 0.0, 0.0), (0.31, 0.002, 0.003)]
    kinds = [*TURNING[:4], Universal]
    reduced = cantilever(modes=10, free=True)
    arms, joints = [], []
    for k, (place, kind) in enumerate(zip(places, kinds, strict=True)):
        a = axes_about(np.array([0.3, 1.0, -0.2]))
        b = axes_about(np.cross(a[:, 2], [1.0, 0.0, 0.0])) if kind is Universal else a
        arms.append(replace(arm(place), name=f"arm{k}"))
        frames = {"frame_a": JointFrame(np.array(place), a), "frame_b": JointFrame(np.zeros(3), b)}
        joints.append(kind(name=f"bolt{k}", body_a="beam", body_b=f"arm{k}", **frames))
    layout = pack_scene(Scene((beam(reduced, motion=Free()), *arms), joints=tuple(joints)))
    rows = StartRows(layout)
    rng = np.random.default_rng(1)
    size = np.where(np.arange(len(rows.inertia)) < 6, 0.3, 0.1)
    tip = reduced.motion_at(TIP).rotation
    assert tip is not None
    start = size * rng.normal(size=len(size))
    start[6 : 6 + reduced.mode_count] *= 0.3 / np.linalg.norm(start[6 : 6 + reduced.mode_count] @ tip)
    rows.move(start)
    rows.fill()
    G = rows.jacobian().toarray()
    step = 1e-3
    for _ in range(4):
        along = size * rng.normal(size=len(size))
        along[6 : 6 + reduced.mode_count] *= 1.0 / np.linalg.norm(along[6 : 6 + reduced.mode_count] @ tip)
        a, b, c, d = (displaced(rows, k * step * along) for k in (-2, -1, 1, 2))
        np.testing.assert_allclose(G @ along, (a - 8.0 * b + 8.0 * c - d) / (12.0 * step), atol=1e-9)


def test_joints_of_points_go_on() -> None:
    packed(Ball, TIP)
    frames = {"frame_a": JointFrame(TIP), "frame_b": JointFrame(np.array([0.1, 0.0, 0.0]))}
    rod = Distance(name="rod", body_a="beam", body_b="arm", **frames)
    pack_scene(Scene((beam(cantilever()), arm(TIP)), joints=(rod,)))


@pytest.mark.slow
def test_ball_and_three_rods_pass_the_moment() -> None:
    """An arm of 0.5 m with F at its end: tip F L^3 / 3 E I + F a L^2 / 2 E I, end a (F L^2 / 2 + F a L) / E I more."""
    corners = np.array([[LENGTH, -0.01, -0.01], [LENGTH, 0.01, -0.01], [LENGTH, 0.0, 0.01]])
    reduced = cantilever(points=tuple(map(tuple, corners.tolist())))
    weight = RigidBody("arm", 2.0, 1e-3 * np.eye(3), centre_of_mass=np.array([0.5, 0.0, 0.0]), position=TIP)
    ends = [(corners[1], (50.0, 0.0, 0.0)), (corners[1], (0.0, 0.0, -50.0)), (corners[2], (50.0, 0.0, 0.0))]
    joints: list[Any] = [
        Ball(
            name="ball",
            body_a="beam",
            body_b="arm",
            frame_a=JointFrame(corners[0]),
            frame_b=JointFrame(corners[0] - TIP),
        )
    ]
    for k, (place, along) in enumerate(ends):  # long rods, so that they turn by next to nothing
        frames = {"frame_a": JointFrame(place), "frame_b": JointFrame(place + np.array(along) - TIP)}
        joints.append(Distance(name=f"rod{k}", body_a="beam", body_b="arm", **frames))
    seen = (Sensor("tip", "beam", TIP), Sensor("load", "arm", np.array([0.5, 0.0, 0.0])))
    bodies = beam(reduced), weight
    pull = PointForce("pull", "arm", np.array([0.5, 0.0, 0.0]), force=np.array([0.0, 0.0, -19.62]))
    run = Simulation(Scene(bodies, (pull,), seen, tuple(joints)), 1e-4, start="equilibrium")
    height = heights(run)
    force, a, L = 19.62, 0.5, LENGTH
    tip = -force * (L**3 / 3.0 + a * L**2 / 2.0) / BENDING
    np.testing.assert_allclose(height["tip.position"], tip, rtol=2e-3)
    load = tip - a * force * (L**2 / 2.0 + a * L) / BENDING
    np.testing.assert_allclose(height["load.position"], load, rtol=2e-3)


def test_direction_that_no_mode_turns_is_kept() -> None:
    """With two bending modes in the plane x z, y stays y and x does not."""
    whole = cantilever()
    # the two lowest modes are any two across each other: their combination that does not move along y
    tip = whole.shapes_at(*whole.locate(TIP))[:2]
    across = np.array([tip[1, 1], -tip[0, 1]]) / np.hypot(*tip[:, 1])
    shape = np.tensordot(across, whole.mode_shapes[:2], axes=1)[None]
    flat = replace(
        whole,
        eigenvalues=whole.eigenvalues[:1],
        mode_shapes=shape,
        integrals=shape_integrals(whole.nodes, shape, eye_array(whole.node_count).tocsr()),
        labels=("bending",),
        residuals=np.zeros(1),
    )
    rotation = flat.motion_at(TIP).rotation
    assert rotation is not None
    assert not flat.turns(rotation, (0.0, 1.0, 0.0))
    assert flat.turns(rotation, (1.0, 0.0, 0.0))
    assert flat.turns(rotation, (0.0, 0.0, 1.0))


def test_rotation_of_a_place_is_the_slope_of_the_beam() -> None:
    """Slope over deflection of the tip, Euler-Bernoulli: 1.37651 / L in the first mode, 4.78139 / L in the second."""
    body = cantilever(elements=40)
    nodes, weights = body.locate(TIP)
    turn, moved = body.turn_at(nodes, weights), body.shapes_at(nodes, weights)
    for mode, expected in ((0, 1.37651), (1, 1.37651), (2, 4.78139), (3, 4.78139)):
        # w' = - theta_y of z, + theta_z of y
        slope = np.array([turn[mode, 2], -turn[mode, 1]])
        np.testing.assert_allclose(slope, expected * moved[mode, 1:], rtol=0.02, atol=1e-6)
    assert np.abs(body.turn_at(*body.locate(ROOT))).max() == 0.0


def test_measures_turn_with_their_place() -> None:
    """The tip of a cantilever under a moment M turns by M L / E I, and moves by M L^2 / 2 E I."""
    seen = RelativeMotion(name="seen", body_a="ground", body_b="beam", point_a=np.zeros(3), point_b=TIP)
    reduced = cantilever(held=(tuple(TIP.tolist()),))
    moment = 0.5
    pulls = [  # a couple at the end of an arm without weight
        PointForce(f"pull{k}", "arm", np.array([0.0, 0.0, z]), force=np.array([s * moment, 0.0, 0.0]))
        for k, (z, s) in enumerate(((0.5, 1.0), (-0.5, -1.0)))
    ]
    sides = {
        "body_a": "beam",
        "frame_a": JointFrame(TIP),
        "body_b": "arm",
        "frame_b": JointFrame(np.zeros(3)),
    }
    joints = (FixedJoint(name="bolt", **sides),)
    scene = Scene((beam(reduced), arm(TIP)), (*pulls, seen), joints=joints)
    run = Simulation(scene, 1e-4, start="equilibrium")
    row = run.record()
    values = {c.name: row[c.column : c.column + len(c.components)] for c in run.channels}
    angle = moment * LENGTH / BENDING
    np.testing.assert_allclose(values["seen.rotation"], [0.0, angle, 0.0], rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(values["seen.position"][2], -0.5 * angle * LENGTH, rtol=1e-4)
    np.testing.assert_allclose(values["bolt.reaction_moment"], [0.0, -moment, 0.0], rtol=1e-3, atol=1e-6)


def test_a_weight_at_the_end_of_a_rigid_arm_bends_the_beam_that_it_is_built_into() -> None:
    """Tip F L^3 / 3 E I + F a L^2 / 2 E I; the load a (F L^2 / 2 + F a L) / E I lower. Without forces of inertia."""
    reduced = cantilever(elements=40, modes=10, density=1.0, held=(tuple(TIP.tolist()),))
    a, F, L = 0.5, 19.62, LENGTH
    weight = RigidBody("arm", 2.0, 1e-3 * np.eye(3), np.array([a, 0.0, 0.0]), position=TIP)
    built = FixedJoint(name="built_in", body_a="beam", body_b="arm", frame_a=JointFrame(TIP))
    seen = (Sensor("tip", "beam", TIP), Sensor("load", "arm", np.array([a, 0.0, 0.0])))
    scene = Scene((beam(reduced), weight), (DOWN,), seen, (built,))
    height = heights(Simulation(scene, 1e-4, start="equilibrium"))
    tip = -F * (L**3 / 3.0 + a * L**2 / 2.0) / BENDING
    load = tip - a * F * (L**2 / 2.0 + a * L) / BENDING
    np.testing.assert_allclose([height["tip.position"], height["load.position"]], [tip, load], rtol=2e-4)


def test_a_free_beam_that_a_joint_builds_in_is_a_cantilever() -> None:
    """``w L^4 / 8 E I`` under its own weight, and of shear ``w L^2 / 2 (5/6) G A``; the moment of that."""
    reduced = cantilever(elements=40, modes=20, free=True, held=((0.0, 0.0, 0.0),))
    built = FixedJoint(name="built_in", body_a=GROUND, body_b="beam")
    scene = Scene((beam(reduced, motion=Free()),), (DOWN,), (Sensor("tip", "beam", TIP),), (built,))
    run = Simulation(scene, 1e-4, start="equilibrium")
    w = DENSITY * SIDE**2 * 9.81
    shear = 0.5 * w * LENGTH**2 / (5.0 / 6.0 * 0.5 * YOUNG * SIDE**2)
    expected = -(w * LENGTH**4 / (8.0 * BENDING) + shear)
    np.testing.assert_allclose(heights(run)["tip.position"], expected, rtol=1e-4)
    row = run.record()
    at = next(c.column for c in run.channels if c.name == "built_in.reaction_moment")
    np.testing.assert_allclose(row[at : at + 3], [0.0, -0.5 * w * LENGTH**2, 0.0], rtol=1e-4, atol=1e-6)


def test_triangle_of_ball_joints_is_told() -> None:
    """Its sides cannot lengthen as linear modes lengthen them: a stiffness that no solid has."""
    places = np.array([[LENGTH, -0.01, -0.01], [LENGTH, 0.01, -0.01], [LENGTH, 0.0, 0.01]])
    joints = tuple(
        Ball(name=f"b{k}", body_a="beam", body_b="arm", frame_a=JointFrame(p), frame_b=JointFrame(p - TIP))
        for k, p in enumerate(places)
    )
    layout = pack_scene(Scene((beam(cantilever()), arm(TIP)), joints=joints))
    assert any("joints 'b0', 'b1', 'b2' hold points" in note for note in layout.notes)
    welds = tuple(FixedJoint(**{key: getattr(ball, key) for key in SIDES}) for ball in joints[:2])
    layout = pack_scene(Scene((beam(cantilever()), arm(TIP)), joints=welds))
    assert any("joints 'b0', 'b1' hold points" in note for note in layout.notes)
    assert not pack_scene(Scene((beam(cantilever()), arm(TIP)), joints=joints[:1])).notes


def test_directions_of_vehicles_are_those_of_the_frame() -> None:
    """Their bogies stand beside the body: no place of it is looked for."""
    book = MarkerBook()
    book.direction("beam", np.array([1.0, 0.0, 0.0]), at=np.array([0.0, 0.0, -5.0]), turning=False)
    constants: list[Array] = []

    def place(*_: Array) -> Array:
        raise AssertionError

    markers = pack_markers(book.of(["beam"]), [place], constants, [place])
    assert markers["direction"].tolist() == [True]
    assert markers["turned"].tolist() == [False]
    np.testing.assert_array_equal(constants[0], [1.0, 0.0, 0.0])


def test_a_joint_on_a_line_of_nodes_is_told() -> None:
    """Nodes without elements along x have no rotation about x; four that span a plane do."""
    x = np.linspace(0.0, 1.0, 30)
    for offset, told in ((0.0, True), (0.05, False)):
        nodes = np.stack([x, offset * (np.arange(30) % 2), np.zeros(30)], axis=1)
        shape = np.zeros((1, 30, 3))
        shape[0, :, 2] = x**2
        mass = (eye_array(30) / float(np.sum(x**4))).tocsr()
        integrals = shape_integrals(nodes, shape, mass)
        wire = ReducedBody(nodes, np.ones(1), shape, integrals, False, ("bent",), np.zeros(1), 0.0)
        notes = packed(FixedJoint, (1.0, nodes[-1, 1], 0.0), beam(wire)).notes
        assert any("'bolt' holds directions" in note and "on a line" in note for note in notes) == told
