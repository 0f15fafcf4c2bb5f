"""Joints on flexible bodies, whose frames are free, driven or fixed."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from jointed_clouds import GROUND as WORLD
from jointed_clouds import Mechanism, Pin, Square, world_node
from point_masses import Array, Cloud, Start, System, channels_of, make_cloud, matrix
from scenarios import HARMONICS
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import GROUND, Joint, JointFrame, axes_about
from heavylift.solver.scene.scene import Fixed, FlexibleBody, Gravity, RigidBody, Scene, Sensor
from heavylift.solver.simulation import Simulation

DURATION = 0.4
FIELD = np.array([0.5, -1.0, -9.81])
Z = np.zeros(3)
AXES = axes_about(np.array([0.0, 1.0, 0.0]))
"""Of the hinge, in the axes of both bodies."""

pytestmark = pytest.mark.slow  # scenes of three kinds of bodies take most of a minute to compile


def at_rest(position: Array, modes: int) -> Start:
    return Start(position, np.array([1.0, 0.0, 0.0, 0.0]), Z, Z, np.zeros(modes), np.zeros(modes))


def carried_by(holder: System, node: int, cloud: Cloud, own: int) -> Start:
    """Start of a cloud that moves with a node of a held frame like one body with it."""
    _, R, v, w, _, _ = holder.prescribed(0.0)
    J = holder.cloud.jacobians(R, holder.start.q)[node, :, :6]
    at = J @ np.concatenate([v, w])
    orientation = Rotation.from_matrix(R).as_quat(scalar_first=True)
    position = world_node(holder, node) - R @ cloud.nodes[own]
    velocity = at - R @ np.cross(w, cloud.nodes[own])
    return Start(position, orientation, velocity, w, np.zeros(0), np.zeros(0))


@cache
def mechanism() -> Mechanism:
    """Three side by side, so that one compilation serves them.

    A closed loop of a flexible and a rigid body, pinned to the ground at both ends; a driven frame that carries a
    rigid pendulum by a hinge; a fixed frame that carries one by a ball joint.
    """
    cloud, bob = make_cloud(seed=6), make_cloud(modes=0, seed=12)
    soft = System(cloud, at_rest(-cloud.nodes[4], 5), gravity=FIELD)
    link = System(bob, at_rest(world_node(soft, 9) - bob.nodes[2], 0), gravity=FIELD)
    driven = System(
        make_cloud(seed=16, rigid_part=1.0), at_rest(np.array([3.0, 0.0, 0.0]), 5), HARMONICS, gravity=FIELD
    )
    swing = make_cloud(modes=0, seed=22)
    swung = System(swing, carried_by(driven, 7, swing, 3), gravity=FIELD)
    fixed = System(
        make_cloud(seed=26, rigid_part=1.0),
        at_rest(np.array([-3.0, 0.0, 0.0]), 5),
        Fixed(),
        damping_ratio=np.full(5, 0.05),
        gravity=FIELD,
    )
    weight = make_cloud(modes=0, seed=32)
    hung = System(weight, at_rest(world_node(fixed, 11) - weight.nodes[5], 0), gravity=FIELD)
    systems = {"soft": soft, "link": link, "driven": driven, "swung": swung, "fixed": fixed, "hung": hung}
    rows: list[Pin | Square] = [
        Pin(WORLD, world_node(soft, 4), "soft", 4),
        Pin("soft", 9, "link", 2),
        Pin(WORLD, world_node(link, 17), "link", 17),
        Pin("fixed", 11, "hung", 5),
        Pin("driven", 7, "swung", 3),
        Square("driven", AXES[:, 2], "swung", AXES[:, 0]),
        Square("driven", AXES[:, 2], "swung", AXES[:, 1]),
    ]
    return Mechanism(systems, rows)


def scene_of(mechanism: Mechanism) -> Scene:
    """The same for the solver; each pin is a joint by the name of its node on b."""
    systems = mechanism.systems
    bodies = [
        (system.scene if system.cloud.mode_count else system.rigid_scene)(name).bodies[0]
        for name, system in systems.items()
    ]
    hinged = {(row.body_a, row.body_b) for row in mechanism.rows if isinstance(row, Square)}
    joints: list[Joint] = []
    for row in mechanism.rows:
        if isinstance(row, Pin):
            hinge = (row.body_a, row.body_b) in hinged
            axes = AXES if hinge else np.eye(3)
            on_ground = row.body_a == WORLD
            a = row.node_a if on_ground else systems[row.body_a].cloud.nodes[row.node_a]
            joints.append(
                (Hinge if hinge else Ball)(
                    name=f"{row.body_b} {row.node_b}",
                    body_a=GROUND if on_ground else row.body_a,
                    body_b=row.body_b,
                    frame_a=JointFrame(a, axes),
                    frame_b=JointFrame(systems[row.body_b].cloud.nodes[row.node_b], axes),
                )
            )
    return Scene(tuple(bodies), (Gravity(FIELD),), joints=tuple(joints))


def padded(scene: Scene) -> Scene:
    """A scene with a weight on a fixed frame and a door beside it: scenes with the same kinds share compiled code."""
    reference = scene_of(mechanism())
    door = RigidBody("door", 1.0, 0.1 * np.eye(3), position=np.array([0.5, 9.0, 0.0]))
    sides = [JointFrame(np.array([x, y, 0.0]), AXES) for x, y in ((0.0, 9.0), (-0.5, 0.0))]
    hinge = Hinge(name="post", body_a=GROUND, body_b="door", frame_a=sides[0], frame_b=sides[1])
    added = tuple(body for body in reference.bodies if body.name in {"fixed", "hung"})
    hung = tuple(joint for joint in reference.joints if joint.name == "hung 5")
    return replace(scene, bodies=(*scene.bodies, *added, door), joints=(*scene.joints, *hung, hinge))


def run(scene: Scene, step: float, duration: float = DURATION) -> tuple[dict[str, Array], Array, Array]:
    """Channels at the end, and energy balance and joint gap over time."""
    steps = round(duration / step)
    simulation = Simulation(scene, step, record_every=steps // 20)
    rows = [simulation.record()]
    rows.extend(simulation.advance(steps)[1])
    assert not simulation.outcome, simulation.message
    all_channels = [channels_of(simulation, row, "") for row in rows]
    end = {
        key: matrix(value) if key.endswith(".orientation") else value
        for key, value in all_channels[-1].items()
    }
    balance = np.array([row["energy.balance"][0] for row in all_channels])
    return end, balance - balance[0], np.array([row["monitor.violation"][0] for row in all_channels])


@cache
def runs() -> list[tuple[dict[str, Array], Array, Array]]:
    return [run(scene_of(mechanism()), step) for step in (1e-3, 5e-4)]


def test_every_channel_converges_to_the_point_masses() -> None:
    """Of loop, driven and fixed frame; reactions of joints and of held frames too."""
    reference = mechanism()
    expected = reference.channels(DURATION, reference.solve(DURATION))
    (coarse, _, _), (fine, _, _) = runs()
    assert {"soft 4.reaction_force", "driven.reaction_moment", "fixed.modal_position"} <= expected.keys()
    for name, value in expected.items():
        scale = max(1.0, float(np.abs(value).max()))
        limit = (4.0 * fine[name] - coarse[name]) / 3.0
        np.testing.assert_allclose(limit, value, atol=1e-5 * scale, err_msg=name)
        errors = [np.abs(end[name] - value).max() for end in (coarse, fine)]
        assert errors[1] <= 0.3 * errors[0] + 1e-9 * scale, (name, errors)


def test_work_of_joints_drives_and_dampers_balances_the_energy() -> None:
    """To second order; the gap of the joints is of third."""
    (_, coarse, coarse_gap), (_, fine, fine_gap) = runs()
    assert np.ptp(fine) < 0.3 * np.ptp(coarse) < 0.01
    assert fine_gap.max() < 0.16 * coarse_gap.max() < 1e-6


def test_a_body_without_modes_is_a_rigid_body_to_rounding() -> None:
    """On a hinge, with a rod on a ball joint; frame in the centre of mass: the same numbers, computed in two ways."""
    cloud = make_cloud(modes=0, seed=3, centred=True)
    node, other = cloud.nodes[4], cloud.nodes[9]
    axes = axes_about(np.array([0.0, 1.0, 0.3]))
    along = np.array([0.6, 0.1, 0.2])
    system = System(cloud, at_rest(-node, 0))
    bodies: list[FlexibleBody | RigidBody] = []
    joints: list[Joint] = []
    sensors = []
    for name, scene in (("flexible", system.scene("flexible")), ("rigid", system.rigid_scene("rigid"))):
        rod = f"{name} rod"
        bodies += [
            scene.bodies[0],
            RigidBody(rod, 2.0, np.diag([0.02, 0.05, 0.06]), position=other - node + 0.5 * along),
        ]
        a, b = JointFrame(Z, axes), JointFrame(node, axes)
        joints.append(Hinge(name=f"{name} hinge", body_a=GROUND, body_b=name, frame_a=a, frame_b=b))
        a, b = JointFrame(other, np.eye(3)), JointFrame(-0.5 * along, np.eye(3))
        joints.append(Ball(name=f"{name} ball", body_a=name, body_b=rod, frame_a=a, frame_b=b))
        sensors.append(Sensor(f"{name} tip", rod, 0.5 * along))
    gravity = Gravity(np.array([0.0, 0.0, -9.81]))
    end, _, _ = run(padded(Scene(tuple(bodies), (gravity,), tuple(sensors), tuple(joints))), 2e-3)
    for name in (
        ".position",
        ".orientation",
        " tip.velocity",
        " hinge.reaction_moment",
        " ball.reaction_force",
    ):
        np.testing.assert_allclose(end[f"flexible{name}"], end[f"rigid{name}"], rtol=1e-8, atol=1e-9)


def bar(frequency: float) -> Cloud:
    """Slender body of 5 kg and 1.5 m along x, mean-axis shapes of about a frequency [Hz]; its first node is an end."""
    x = np.linspace(0.0, 1.5, 11)
    ring = 0.05 * np.array([[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    nodes = np.array([[u, *side] for u in x for side in ring])
    masses = np.full(len(nodes), 5.0 / len(nodes))
    raw = np.zeros((len(nodes), 3, 4))
    for i, (power, axis) in enumerate(((2, 1), (2, 2), (3, 1), (3, 2))):
        raw[:, axis, i] = (nodes[:, 0] / 1.5) ** power
    raw = raw.reshape(-1, 4)
    rigid = np.zeros((3 * len(nodes), 6))
    for axis in range(3):
        rigid[axis::3, axis] = 1.0
        rigid[:, 3 + axis] = np.cross(np.eye(3)[axis], nodes).ravel()
    M = np.repeat(masses, 3)[:, None]
    raw = raw - rigid @ np.linalg.solve(rigid.T @ (M * rigid), rigid.T @ (M * raw))
    L = np.linalg.cholesky(raw.T @ (M * raw))
    shapes = np.linalg.solve(L, raw.T).reshape(4, len(nodes), 3)
    stiffness = (2.0 * np.pi * frequency * np.arange(1, 5)) ** 2
    return Cloud(masses, nodes, np.ascontiguousarray(shapes), stiffness)


def test_a_stiff_bar_on_a_hinge_is_a_compound_pendulum() -> None:
    """Modes of kilohertz, far beyond the step, follow statically and move the tip by micrometres."""
    cloud = bar(3e3)
    m, tip = cloud.masses, cloud.nodes[-5]
    inertia, moment = m @ (cloud.nodes[:, 0] ** 2 + cloud.nodes[:, 2] ** 2), m @ cloud.nodes[:, 0]
    exact = solve_ivp(
        lambda _, y: [y[1], moment * 9.81 * np.cos(y[0]) / inertia],
        (0.0, 2.0),
        [0.0, 0.0],
        rtol=1e-11,
        atol=1e-11,
    ).y[0, -1]
    axes = axes_about(np.array([0.0, 1.0, 0.0]))
    side = JointFrame(cloud.nodes[0], axes)
    scene = Scene(
        (FlexibleBody("bar", cloud.reduced()),),
        (Gravity(np.array([0.0, 0.0, -9.81])),),
        (Sensor("tip", "bar", tip),),
        (Hinge(name="pin", body_a=GROUND, body_b="bar", frame_a=side, frame_b=side),),
    )
    expected = 1.5 * np.array([np.cos(exact), 0.0, -np.sin(exact)])
    errors = []
    for step in (4e-3, 2e-3):
        end, balance, gap = run(padded(scene), step, 2.0)
        errors.append(np.abs(end["tip.position"] - expected).max())
        assert np.ptp(balance) < 0.02
        assert gap.max() < 1e-6
    assert errors[1] < 0.3 * errors[0] < 3e-5


@pytest.mark.slow
def test_energy_of_a_soft_bar_between_a_rod_and_the_air() -> None:
    """Ground, ball, rod of 2 kg, ball, bar, over 3 s: bounded, and falling with the step; the joints stay closed."""
    cloud = bar(8.0)
    rod = RigidBody("rod", 2.0, np.diag([1e-3, 0.042, 0.042]), position=np.array([0.25, 0.0, 0.0]))
    beam = FlexibleBody("bar", cloud.reduced(), position=np.array([0.5, 0.0, 0.0]))
    ends = [JointFrame(np.array([s * 0.25, 0.0, 0.0]), np.eye(3)) for s in (-1.0, 1.0)]
    joints = (
        Ball(name="top", body_a=GROUND, body_b="rod", frame_a=JointFrame(Z, np.eye(3)), frame_b=ends[0]),
        Ball(
            name="middle",
            body_a="rod",
            body_b="bar",
            frame_a=ends[1],
            frame_b=JointFrame(cloud.nodes[0], np.eye(3)),
        ),
    )
    gravity = Gravity(np.array([0.0, 0.0, -9.81]))
    scene = Scene((beam, rod), (gravity,), (Sensor("tip", "bar", cloud.nodes[-5]),), joints)
    drifts, gaps, tips = [], [], []
    for step in (4e-3, 2e-3, 1e-3, 5e-4):
        end, balance, gap = run(padded(scene), step, 3.0)
        drifts.append(np.ptp(balance))
        gaps.append(gap.max())
        tips.append(end["tip.position"])
    assert max(drifts[1:]) < 0.05  # of 65 J
    assert np.all(np.array(drifts[1:]) < 0.35 * np.array(drifts[:-1]))
    assert np.all(np.array(gaps[1:]) < 0.2 * np.array(gaps[:-1]))
    steps = [np.abs(b - a).max() for a, b in pairwise(tips)]
    assert steps[2] < 0.4 * steps[1] < 0.4**2 * steps[0]


def test_adaptive_steps_keep_the_tolerance() -> None:
    """A tenth of the tolerance brings every position nearer to the point masses."""
    reference = mechanism()
    expected = reference.channels(DURATION, reference.solve(DURATION))
    errors = []
    for tolerance in (1e-4, 1e-6):
        simulation = Simulation(scene_of(reference), DURATION / 4, tolerance=tolerance)
        end = channels_of(simulation, simulation.advance(4)[1][-1], "")
        assert not simulation.outcome, simulation.message
        names = [name for name in expected if name.endswith(".position")]
        errors.append(max(np.abs(end[name] - expected[name]).max() for name in names))
    assert errors[0] < 1e-2
    assert errors[1] < 0.1 * errors[0]


def test_bodies_beside_joints_move_as_if_alone() -> None:
    """A free flexible body that no joint holds; only the first prediction of its acceleration is another."""
    alone = System(
        make_cloud(seed=41), replace(at_rest(Z, 5), spin=np.array([1.0, -2.0, 3.0])), gravity=FIELD
    )
    scene = scene_of(mechanism())
    body = alone.scene("alone").bodies[0]
    together, _, _ = run(replace(scene, bodies=(*scene.bodies, body)), 1e-3, 0.1)
    single, _, _ = run_alone(Scene((body,), scene.forces), 1e-3, 0.1)
    for key in ("position", "velocity", "angular_velocity", "modal_position", "modal_velocity"):
        np.testing.assert_allclose(together[f"alone.{key}"], single[f"alone.{key}"], atol=1e-7)


def run_alone(scene: Scene, step: float, duration: float) -> tuple[dict[str, Array], None, None]:
    """`run` without joints."""
    simulation = Simulation(scene, step, record_every=round(duration / step))
    return channels_of(simulation, simulation.advance(round(duration / step))[1][-1], ""), None, None
