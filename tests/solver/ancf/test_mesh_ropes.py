"""Ropes, springs and point forces on frames and shells, and frames clamped to shells; one compiled step for all."""

from __future__ import annotations

import numpy as np
import pytest
from jointed_frames import DOWN, HOLD, Run, bar, run
from jointed_shells import sheet
from scipy.spatial.transform import Rotation

from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.forces.point import PointForce
from heavylift.solver.forces.spring import Spring
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.scene.connections import GROUND, JointFrame, RopePoint
from heavylift.solver.scene.mesh_shapes import rectangle
from heavylift.solver.scene.meshes import Support
from heavylift.solver.scene.scene import Scene

pytestmark = pytest.mark.slow

SIDE = rectangle(1.0, 0.6, 2, 2)
WEIGHT = 0.6 * 0.01 * 7850.0 * 9.81
MAST_MASS = 4e-4 * 7850.0
STIFFNESS, STRETCH = 3e3, 0.02
SPIN, PUSH = 3.0, np.array([20.0, 10.0, 0.0])
TURN = Rotation.from_euler("z", 0.7)


@pytest.fixture(scope="module")
def moving() -> Run:
    """Everything side by side, far from each other."""
    hung = sheet(
        "hung",
        SIDE,
        0.01,
        2.1e9,
        position=np.array([0.0, -5.0, 0.0]),
        viscous_damping=5.0,
        stiffness_damping=2e-3,
    )
    # as free as a rigid plate without weight: gravity is made up for by a force in its middle
    spinning = sheet(
        "spinning",
        SIDE,
        0.01,
        2.1e11,
        position=np.array([5.0, 0.0, 0.0]) - TURN.apply([0.5, 0.3, 0.0]),
        orientation=TURN.as_quat(scalar_first=True),
        velocity=-np.cross([0.0, 0.0, SPIN], TURN.apply([0.5, 0.3, 0.0])),
        angular_velocity=np.array([0.0, 0.0, SPIN]),
    )
    every = np.arange(len(SIDE.nodes))
    table = sheet(
        "table",
        SIDE,
        0.01,
        2.1e11,
        position=np.array([0.0, 5.0, 0.0]),
        supports=(Support(every, {"position": "xyz", "slope_x": "xyz", "slope_y": "xyz", "twist": "xyz"}),),
    )
    upright = Rotation.from_euler("y", -0.5)
    axes = upright.as_matrix()
    mast = bar(
        "mast",
        np.zeros(3),
        [1.0, 0.0, 0.0],
        4,
        2.1e9,
        position=np.array([0.3, 5.2, 0.0]),
        orientation=upright.as_quat(scalar_first=True),
    )
    like = bar(
        "like",
        np.zeros(3),
        [1.0, 0.0, 0.0],
        4,
        2.1e9,
        position=np.array([0.3, 9.2, 0.0]),
        orientation=upright.as_quat(scalar_first=True),
        supports=(Support(np.array([0]), HOLD),),
    )
    bob = bar("bob", [0.0, 15.0, 0.0], [0.0, 15.0, -1.0], 3, 2.1e11)
    joints = (
        FixedJoint(
            name="foot",
            body_a="table",
            body_b="mast",
            frame_a=JointFrame(np.array([0.3, 0.2, 0.0]), axes),
            frame_b=JointFrame(),
        ),
    )
    ropes = tuple(
        Rope(
            name=f"rope{i}",
            path=(
                RopePoint(GROUND, np.array([x + 0.2 * (1 - 2 * i), -5.0, 1.0])),
                RopePoint("hung", np.array([x, 0.0, 0.0])),
            ),
            axial_stiffness=1e6,
            damping=50.0,
        )
        for i, x in enumerate((0.0, 1.0))
    )
    weightless = PointForce(
        "hold", "spinning", np.array([0.5, 0.3, 0.0]), np.zeros(1), np.array([[0.0, 0.0, WEIGHT]])
    )
    forces = (
        DOWN,
        weightless,
        PointForce("push", "spinning", np.array([0.5, 0.3, 0.0]), np.zeros(1), PUSH[None], "body"),
        PointForce(
            "lift",
            "bob",
            np.array([0.0, 15.0, -1.0]),
            np.zeros(1),
            np.array([[0.0, 0.0, 0.5 * MAST_MASS * 9.81]]),
        ),
        Spring(
            name="spring",
            body_a=GROUND,
            point_a=np.array([0.0, 15.0, 1.0]),
            body_b="bob",
            point_b=np.array([0.0, 15.0, 0.0]),
            length=1.0 - STRETCH,
            stiffness=STIFFNESS,
        ),
    )
    bodies = (hung, spinning, table, mast, like, bob)
    return run(Scene(bodies, forces, joints=joints, ropes=ropes), 2e-3, 4.0)


def test_plate_hangs_on_two_ropes(moving: Run) -> None:
    """From level to upright, at rest: each carries half the weight over the cosine of its angle."""
    nodes = moving.nodes("hung")
    assert np.abs(nodes[-1] - nodes[-100]).max() < 2e-3
    for i, corner in enumerate((SIDE.corners[0], SIDE.corners[1])):
        anchor = np.array([(0.0, 1.0)[i] + 0.2 * (1 - 2 * i), -5.0, 1.0])
        line = anchor - nodes[-1, corner]
        expected = 0.5 * WEIGHT / (line[2] / np.linalg.norm(line))
        assert moving[f"rope{i}.tension"][-1] == pytest.approx(expected, rel=5e-3)


def test_frame_clamped_to_a_shell_is_a_cantilever(moving: Run) -> None:
    """On a point inside an element that does not move, with a tangent that is not square to the plate."""
    mast, like = moving.nodes("mast"), moving.nodes("like") - [0.0, 4.0, 0.0]
    assert np.ptp(like[:, -1], axis=0).max() > 0.05
    np.testing.assert_allclose(mast, like, atol=1e-6)


def test_following_force_turns_with_the_shell(moving: Run) -> None:
    """A stiff plate spins evenly, so its middle goes by two integrals of a turning force."""
    t = moving.times
    mass, phase = WEIGHT / 9.81, 0.7
    force = PUSH[0] + 1j * PUSH[1]
    path = -force * np.exp(1j * phase) / (mass * SPIN**2) * (np.exp(1j * SPIN * t) - 1.0 - 1j * SPIN * t)
    middle = int(np.argmin(np.linalg.norm(SIDE.nodes - [0.5, 0.3, 0.0], axis=1)))
    found = moving.nodes("spinning")[:, middle] - [5.0, 0.0, 0.0]
    np.testing.assert_allclose(found[:, 0], path.real, atol=2e-3 * np.abs(path).max())
    np.testing.assert_allclose(found[:, 1], path.imag, atol=2e-3 * np.abs(path).max())


def test_frame_swings_on_a_spring(moving: Run) -> None:
    """A stiff frame along the line of the spring is its mass; a force on its other end carries half the weight."""
    z = moving.nodes("bob")[:, 0, 2]
    rate = np.sqrt(STIFFNESS / MAST_MASS)
    sag = 0.5 * MAST_MASS * 9.81 / STIFFNESS - STRETCH
    np.testing.assert_allclose(z, -sag * (1.0 - np.cos(rate * moving.times)), atol=0.05 * abs(sag))
