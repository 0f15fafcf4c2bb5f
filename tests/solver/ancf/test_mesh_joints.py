"""Mechanics of frames on joints: clamps, welds, a four-bar linkage, a bridge; one compiled step for all."""

from __future__ import annotations

import numpy as np
import pytest
from jointed_frames import (
    DOWN,
    SHIFT,
    TURN,
    Run,
    bar,
    bridge,
    cantilevers,
    clamp,
    four_bar,
    plumb_weld,
    rod,
    run,
    scene,
)
from scipy.spatial.transform import Rotation

from heavylift.numerics.outcome import InputError
from heavylift.solver.bodies.ancf.kind import FrameMeshes
from heavylift.solver.forces.spring import JointSpring
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.universal import Universal
from heavylift.solver.layout import pack_scene, scene_corners
from heavylift.solver.scene.connections import GROUND, JointFrame, Limits, axes_about
from heavylift.solver.scene.meshes import DistributedLoad
from heavylift.solver.scene.scene import Scene
from heavylift.solver.simulation import Simulation

SOFT, STEEL = 2.1e9, 2.1e11
LENGTH, MASS = 1.5, 7850.0 * 4e-4


@pytest.fixture(scope="module")
def falling() -> Run:
    """Linkage and cantilevers released from rest."""
    return run(scene(four_bar(STEEL), cantilevers(SOFT)), 1e-2, 1.0)


@pytest.mark.slow
def test_clamp_by_joint_is_a_clamp_by_supports(falling: Run) -> None:
    """Those that leave |r'| free as well."""
    supported, jointed = falling.nodes("supported"), falling.nodes("jointed") - SHIFT
    assert np.ptp(supported[:, -1], axis=0).max() > 0.3
    np.testing.assert_allclose(jointed, supported, atol=1e-8)


@pytest.mark.slow
def test_weld_makes_one_frame_of_two(falling: Run) -> None:
    """The second runs towards the first, its joint frame is turned about the tangent; stretch is free at the weld."""
    supported = falling.nodes("supported") - SHIFT
    near, far = (falling.nodes(name) - 3 * SHIFT for name in ("near", "far"))
    np.testing.assert_allclose(near, supported[:, :4], atol=1e-3)
    np.testing.assert_allclose(far[:, ::-1], supported[:, 3:], atol=1e-3)


@pytest.mark.slow
def test_reaction_of_a_clamp_carries_weight_and_moment() -> None:
    """A damped cantilever rests on m g and m g times the lever of its centre of mass; axial waves last longer."""
    part = cantilevers(STEEL, viscous_damping=40.0, stiffness_damping=1e-3)
    resting = run(scene(four_bar(STEEL), part), 1e-2, 3.0)
    force, moment = resting["wall.reaction_force"][-1], resting["wall.reaction_moment"][-1]
    weight = MASS * LENGTH * np.array([0.0, 0.0, -9.81])
    np.testing.assert_allclose(force, -weight, atol=1e-3 * np.linalg.norm(weight))
    nodes = resting.nodes("jointed")[-1] - 2 * SHIFT
    middle = np.average(nodes, axis=0, weights=[0.5, 1, 1, 1, 1, 1, 0.5])
    np.testing.assert_allclose(moment, -np.cross(middle, weight), atol=1e-3 * np.linalg.norm(moment))


@pytest.mark.slow
def test_joints_stay_closed(falling: Run) -> None:
    """The monitor, and the ends of the frame at the rods."""
    assert falling["monitor.violation"].max() < 1e-5
    for name, end, point in (("left", 0, 0.5), ("right", -1, -0.5)):
        rods = next(b for b in four_bar(STEEL)[0] if b.name == name)
        length = 2.0 * np.sqrt(3.0 * rods.inertia[1, 1] / rods.mass)
        q = falling[f"{name}.orientation"]
        tip = falling[f"{name}.position"] + point * length * Rotation.from_quat(q, scalar_first=True).apply(
            [1, 0, 0]
        )
        np.testing.assert_allclose(falling.nodes("beam")[:, end], tip, atol=1e-5)


@pytest.mark.slow
def test_linkage_is_of_second_order() -> None:
    """Against a step four times finer than the finest; damping takes axial waves away, which no such step resolves."""
    parts = four_bar(1e9, stiffness_damping=1e-3), cantilevers(SOFT)
    steps = (2e-3, 1e-3, 5e-4)
    fine, *others = (run(scene(*parts), h, 0.4) for h in (steps[-1] / 4, *steps))
    errors = [np.abs(other.nodes("beam") - fine.nodes("beam")).max() for other in others]
    assert errors[0] < 5e-4
    assert errors[0] / errors[2] > 9.0


@pytest.mark.slow
def test_energy_of_the_linkage_stays_bounded() -> None:
    """Ten seconds, steps a hundred times the explicit limit."""
    carried = {"elasticity": "carried"}
    long = run(scene(four_bar(STEEL, **carried), cantilevers(SOFT, **carried)), 1e-2, 10.0)
    assert long["energy.kinetic"].max() > 5.0
    assert long.energy_change() < 0.01 * long["energy.kinetic"].max()


@pytest.mark.slow
def test_energy_momentum_scheme_with_joints_conserves_energy() -> None:
    """Large rotations and strains; rows on points are linear, so what is left is the softness of rigid rows."""
    how = {"elasticity": "energy-momentum"}
    simulation = Simulation(scene(bridge(**how), plumb_weld(**how)), 5e-3)
    system = simulation._layout.systems[0]
    system.rows["hold"] *= 0.01
    swinging = Run(simulation, *simulation.advance(400))
    assert not simulation.message
    assert swinging.energy_change() < 1e-9 * swinging["energy.kinetic"].max()
    kind = next(k for k in simulation._layout.bodies if isinstance(k, FrameMeshes))
    assert kind.body["iterations"].max() <= 15


@pytest.mark.slow
def test_energy_momentum_and_carried_strains_agree_on_a_linkage() -> None:
    """Two schemes of second order."""
    one, other = (
        run(scene(four_bar(1e9, elasticity=how), cantilevers(SOFT, elasticity=how)), 6.25e-4, 0.5)
        for how in ("carried", "energy-momentum")
    )
    np.testing.assert_allclose(one.nodes("beam"), other.nodes("beam"), atol=2e-4)


def refused(*joints: object, forces: tuple[object, ...] = ()) -> InputError:
    """The error of a scene with two frames, along x and along y, and a rod."""
    bodies = (
        bar("f", np.zeros(3), [1.0, 0.0, 0.0], 2, SOFT),
        bar("g", np.zeros(3), [0.0, 1.0, 0.0], 2, SOFT),
        rod("rod", np.zeros(3), [1.0, 0.0, 0.0], 1.0),
    )
    with pytest.raises(InputError) as caught:
        pack_scene(Scene(bodies, (DOWN, *forces), joints=joints))  # type: ignore[arg-type]
    return caught.value


ALONG = JointFrame(axes=axes_about(np.array([1.0, 0.0, 0.0])))
SLOPING = JointFrame(axes=axes_about(np.array([1.0, 1.0, 0.0])))


def test_frames_at_an_angle_need_a_body_between() -> None:
    error = refused(FixedJoint(name="corner", body_a="f", body_b="g"))
    assert error.source == "corner"
    assert "rigid body between" in error.expected
    error = refused(Hinge(name="pin", body_a="f", body_b="g"))
    assert error.source == "pin"
    assert "rigid body between" in error.expected


def test_hinge_needs_an_axis_along_a_frame_or_across() -> None:
    error = refused(Hinge(name="pin", body_a=GROUND, body_b="f", frame_a=SLOPING, frame_b=SLOPING))
    assert (error.source, error.key) == ("pin", "axis")
    assert "45 deg" in error.problem


def test_joints_that_need_more_than_a_tangent_name_themselves() -> None:
    error = refused(Universal(name="cross", body_a="f", body_b="rod", frame_b=ALONG))
    assert (error.source, error.key) == ("cross", "axis")
    assert "'f'" in error.problem


def test_joint_off_the_frame_names_itself() -> None:
    off = JointFrame(np.array([0.5, 0.1, 0.0]))
    error = refused(Ball(name="beside", body_a="f", body_b="rod", frame_a=off))
    assert error.source == "beside"
    assert "'f'" in error.problem


def test_hinge_on_a_frame_has_no_angle() -> None:
    hinge = {"name": "pin", "body_a": GROUND, "body_b": "f"}
    assert refused(Hinge(**hinge, limits=Limits(-1.0, 1.0))).key == "limits"  # type: ignore[arg-type]
    assert refused(Hinge(**hinge, friction=1.0)).key == "friction"  # type: ignore[arg-type]
    spring = JointSpring(name="coil", joint="pin", stiffness=1.0)
    assert refused(Hinge(**hinge), forces=(spring,)).source == "coil"  # type: ignore[arg-type]


def test_tangent_on_the_wrong_side_is_refused() -> None:
    back = JointFrame(axes=np.diag([-1.0, -1.0, 1.0]))
    error = refused(FixedJoint(name="wall", body_a=GROUND, body_b="f", frame_b=back))
    assert (error.source, error.key) == ("wall", "axes")
    assert "180 deg" in error.problem


@pytest.mark.slow
def test_joint_frames_turn_with_the_body() -> None:
    """A turned frame clamped with turned axes fits; the same with the world axes does not."""
    turned = bar("f", np.zeros(3), [1.0, 0.0, 0.0], 2, SOFT, orientation=TURN.as_quat(scalar_first=True))
    layout = pack_scene(Scene((turned,), (DOWN,), joints=(clamp("wall", "f", np.zeros(3)),)))
    assert layout.block_names == ("wall",)


@pytest.mark.slow
@pytest.mark.parametrize("modulus", [1e7, 2.1e11])
def test_schemes_can_be_mixed_across_a_joint(modulus: float) -> None:
    """Strains that are carried follow the velocities that joints to an iterated frame leave."""
    bars = (
        bar("a", (0, 0, 0), (1, 0, 0), 4, modulus, elasticity="carried"),
        bar("b", (1, 0, 0), (2, 0, 0), 4, modulus, elasticity="energy-momentum"),
    )
    ball = {
        "frame_a": JointFrame(np.array([1.0, 0.0, 0.0])),
        "frame_b": JointFrame(np.array([1.0, 0.0, 0.0])),
    }
    pin = Ball(name="pin", body_a=GROUND, body_b="a", frame_a=JointFrame(np.zeros(3)))
    mixed = Scene(bars, forces=(DOWN,), joints=(pin, Ball(name="link", body_a="a", body_b="b", **ball)))
    long = run(mixed, 5e-3, 2.0)
    assert long.energy_change() < 1e-6 * long["energy.kinetic"].max()


def test_tables_of_mesh_loads_are_corners_for_adaptive_steps() -> None:
    """A step must not pass over a short load."""
    load = DistributedLoad(
        np.array([0.0, 0.0, 1.0]), times=np.array([0.37, 0.3705, 0.371]), factors=np.array([0.0, 1.0, 0.0])
    )
    scene_ = Scene((bar("a", (0, 0, 0), (1, 0, 0), 2, 1e9, loads=(load,)),))
    np.testing.assert_array_equal(scene_corners(scene_), [0.37, 0.3705, 0.371])
