"""Joints that hold directions of flexible bodies whose modes turn the places, beside clouds of point masses."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from jointed_clouds import GROUND as WORLD
from jointed_clouds import Mechanism, Pin, Square, world_node
from point_masses import Array, Cloud, Start, System, channels_of, make_cloud, matrix
from scenarios import HARMONICS
from scipy.spatial.transform import Rotation

from heavylift.modal.reduced import Interface, ReducedBody
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import GROUND, Joint, JointFrame, axes_about
from heavylift.solver.scene.scene import Fixed, Gravity, Scene
from heavylift.solver.simulation import Simulation

pytestmark = pytest.mark.slow  # scenes of three kinds of bodies take most of a minute to compile

DURATION = 0.3
FIELD = np.array([0.5, -1.0, -9.81])
Z = np.zeros(3)
AXES = axes_about(np.array([0.0, 1.0, 0.0]))
STIFF = (6.0, 18.0)
"""Lowest and highest frequency [Hz]: deformations stay below a tenth of the size."""
STEP = 1e-3
"""Of the differences by which directions are derived, times a rotation of order one."""


@dataclass(frozen=True, eq=False)
class Held(Mechanism):
    """A mechanism in which the directions of a body turn with its modes: rotations (nf, 3) by name."""

    rotations: dict[str, Array] = field(default_factory=dict)

    def _vector(self, states: Any, body: str, what: Any, point: bool) -> tuple[Array, Array, Array, Array]:
        if point or body not in self.rotations:
            return super()._vector(states, body, what, point)
        _, R, _, w, q, qd = states[body]
        psi, first = self.rotations[body], self.starts()[body]

        def turned(coordinates: Array) -> Array:
            return Rotation.from_rotvec(coordinates @ psi).apply(what)

        def along(direction: Array) -> list[Array]:
            return [turned(q + k * STEP * direction) for k in (-2, -1, 0, 1, 2)]

        def slope(direction: Array) -> Array:
            a, b, _, d, e = along(direction)
            return (a - 8.0 * b + 8.0 * d - e) / (12.0 * STEP)

        a, b, c, d, e = along(qd)
        curve = (-a + 16.0 * b - 30.0 * c + 16.0 * d - e) / (12.0 * STEP**2)
        J = np.zeros((3, self.dof_count))
        J[:, first + 3 : first + 6] = R @ np.cross(np.eye(3), c).T
        J[:, first + 6 : first + 6 + len(q)] = R @ np.array([slope(unit) for unit in np.eye(len(q))]).T
        rate, turning = slope(qd), np.cross(w, c)
        bias = np.cross(w, turning) + 2.0 * np.cross(w, rate) + curve
        return R @ c, R @ (turning + rate), J, R @ bias


def at_rest(position: Array, modes: int, spin: Array = Z) -> Start:
    return Start(position, np.array([1.0, 0.0, 0.0, 0.0]), Z, spin, np.zeros(modes), np.zeros(modes))


def hinge_rows(a: str, b: str) -> list[Pin | Square]:
    return [Square(a, AXES[:, 2], b, AXES[:, 0]), Square(a, AXES[:, 2], b, AXES[:, 1])]


def fixed_rows(a: str, b: str) -> list[Pin | Square]:
    return [*hinge_rows(a, b), Square(a, AXES[:, 0], b, AXES[:, 1])]


NODES = {"soft": 4, "driven": 7, "fixed": 11}
"""Place of each flexible body that is held."""


@cache
def mechanism() -> Held:
    """Three side by side, so that one compilation serves them.

    A flexible body on a hinge in the ground; a driven frame that carries a rigid body by a fixed joint; a fixed frame
    that carries one by a hinge.
    """
    soft = System(make_cloud(seed=6, frequencies=STIFF), at_rest(Z, 5), gravity=FIELD)
    soft = replace(soft, start=at_rest(-soft.cloud.nodes[4], 5))
    driven = System(
        make_cloud(seed=16, rigid_part=1.0, frequencies=STIFF),
        at_rest(np.array([3.0, 0.0, 0.0]), 5),
        HARMONICS,
        gravity=FIELD,
    )
    load = make_cloud(modes=0, seed=22)
    carried = System(load, carried_by(driven, 7, load, 3), gravity=FIELD)
    fixed = System(
        make_cloud(seed=26, rigid_part=1.0, frequencies=STIFF),
        at_rest(np.array([-3.0, 0.0, 0.0]), 5),
        Fixed(),
        damping_ratio=np.full(5, 0.05),
        gravity=FIELD,
    )
    weight = make_cloud(modes=0, seed=32)
    hung = System(weight, at_rest(world_node(fixed, 11) - weight.nodes[5], 0), gravity=FIELD)
    rng = np.random.default_rng(3)
    return Held(
        {"soft": soft, "driven": driven, "carried": carried, "fixed": fixed, "hung": hung},
        [
            Pin(WORLD, world_node(soft, 4), "soft", 4),
            *hinge_rows(WORLD, "soft"),
            Pin("driven", 7, "carried", 3),
            *fixed_rows("driven", "carried"),
            Pin("fixed", 11, "hung", 5),
            *hinge_rows("fixed", "hung"),
        ],
        {name: 0.4 * rng.normal(size=(5, 3)) for name in NODES},
    )


def carried_by(holder: System, node: int, cloud: Cloud, own: int) -> Start:
    """Start of a cloud that moves with a node of a driven frame like one body with it."""
    _, R, v, w, _, _ = holder.prescribed(0.0)
    at = holder.cloud.jacobians(R, holder.start.q)[node, :, :6] @ np.concatenate([v, w])
    orientation = Rotation.from_matrix(R).as_quat(scalar_first=True)
    position = world_node(holder, node) - R @ cloud.nodes[own]
    return Start(position, orientation, at - R @ np.cross(w, cloud.nodes[own]), w, np.zeros(0), np.zeros(0))


def turning(cloud: Cloud, node: int, rotation: Array) -> ReducedBody:
    """What the solver is given: a node is an interface with a rotation of its own."""
    none = np.zeros((0, 3, 6))
    place = Interface(
        cloud.nodes[node], cloud.shapes[:, node], rotation, np.zeros(0, dtype=np.int64), none, none
    )
    return replace(cloud.reduced(), continuum=True, interfaces={"place": place})


def scene_of(mechanism: Held) -> Scene:
    systems = mechanism.systems
    bodies: list[Any] = []
    for name, system in systems.items():
        scene = system.scene if system.cloud.mode_count else system.rigid_scene
        body: Any = scene(name).bodies[0]
        if name in NODES:
            body = replace(body, reduced=turning(system.cloud, NODES[name], mechanism.rotations[name]))
        bodies.append(body)
    joints: list[Joint] = []
    for row in mechanism.rows:
        if not isinstance(row, Pin):
            continue
        on_ground = row.body_a == WORLD
        a = row.node_a if on_ground else systems[row.body_a].cloud.nodes[row.node_a]
        b = systems[row.body_b].cloud.nodes[row.node_b]
        frames = {"frame_a": JointFrame(a, AXES), "frame_b": JointFrame(b, AXES)}
        of_type = FixedJoint if row.body_b == "carried" else Hinge
        sides = {"body_a": GROUND if on_ground else row.body_a, "body_b": row.body_b}
        joints.append(of_type(name=f"{row.body_b} {row.node_b}", **sides, **frames))
    return Scene(tuple(bodies), (Gravity(FIELD),), joints=tuple(joints))


@cache
def runs() -> list[tuple[dict[str, Array], Array, Array]]:
    """Channels at the end, energy balance and gap of the joints over time, of two steps."""
    found = []
    for step in (5e-4, 2.5e-4):
        steps = round(DURATION / step)
        simulation = Simulation(scene_of(mechanism()), step, record_every=steps // 20)
        rows = [simulation.record(), *simulation.advance(steps)[1]]
        assert not simulation.outcome, simulation.message
        channels = [channels_of(simulation, row, "") for row in rows]
        end = {
            name: matrix(value) if name.endswith(".orientation") else value
            for name, value in channels[-1].items()
        }
        balance = np.array([row["energy.balance"][0] for row in channels])
        found.append((end, balance - balance[0], np.array([row["monitor.violation"][0] for row in channels])))
    return found


def test_every_channel_converges_to_the_point_masses() -> None:
    """To second order, reactions of joints and of held frames too; places turn by up to a fifth of a radian."""
    reference = mechanism()
    state = reference.solve(DURATION)
    expected = reference.channels(DURATION, state)
    (coarse, _, _), (fine, _, _) = runs()
    turned = {
        name: float(np.linalg.norm(expected[f"{name}.modal_position"] @ rotation))
        for name, rotation in reference.rotations.items()
    }
    assert turned["driven"] > 0.05, turned
    assert {"soft 4.reaction_force", "driven.reaction_moment", "fixed.modal_position"} <= expected.keys()
    for name, value in expected.items():
        scale = max(1.0, float(np.abs(value).max()))
        limit = (4.0 * fine[name] - coarse[name]) / 3.0
        np.testing.assert_allclose(limit, value, atol=1e-5 * scale, err_msg=name)
        errors = [np.abs(end[name] - value).max() for end in (coarse, fine)]
        assert errors[1] <= 0.3 * errors[0] + 1e-8 * scale, (name, errors)


def test_work_balances_the_energy_and_joints_stay_closed() -> None:
    """To second order; the gap of the joints is of third."""
    (_, coarse, coarse_gap), (_, fine, fine_gap) = runs()
    assert np.ptp(fine) < 0.3 * np.ptp(coarse) < 0.01
    assert fine_gap.max() < 0.16 * coarse_gap.max() < 1e-6


def test_adaptive_steps_keep_the_tolerance() -> None:
    """A hundredth of the tolerance brings every position and orientation nearer to the point masses."""
    reference = mechanism()
    expected = reference.channels(DURATION, reference.solve(DURATION))
    names = [name for name in expected if name.endswith((".position", ".orientation"))]
    errors = []
    for tolerance in (1e-4, 1e-6):
        simulation = Simulation(scene_of(reference), DURATION / 4, tolerance=tolerance)
        end = channels_of(simulation, simulation.advance(4)[1][-1], "")
        assert not simulation.outcome, simulation.message
        found = {name: matrix(end[name]) if name.endswith(".orientation") else end[name] for name in names}
        errors.append(max(np.abs(found[name] - expected[name]).max() for name in names))
    assert errors[0] < 1e-2
    assert errors[1] < 0.1 * errors[0]
