"""Frames and shells in the accurate integrator, and the longest steps of the explicit scheme."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from frame_oracle import OracleElement
from frame_oracle import Section as OracleSection
from scipy.integrate import solve_ivp

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.solver.bodies.ancf.elements import add_elastic_forces
from heavylift.solver.bodies.ancf.kind import POINT_MARKER, TANGENT_MARKER, TRIAD_MARKER, VECTOR_MARKER
from heavylift.solver.bodies.ancf.step import SHARE
from heavylift.solver.forces.spring import Spring
from heavylift.solver.integrate.accurate import make_integration
from heavylift.solver.interface import begin_stage
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.connections import GROUND, JointFrame
from heavylift.solver.scene.mesh_shapes import rectangle
from heavylift.solver.scene.meshes import (
    DistributedLoad,
    FrameBody,
    FrameSection,
    MeshBody,
    ShellBody,
    ShellSection,
    Support,
)
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

LENGTH, AREA, DENSITY, INERTIA = 1.2, 0.0018, 5540.0, 1.215e-8
G = 9.81


def frame(count: int, **more: Any) -> FrameBody:
    """The straight frame of the flexible pendulum of Berzeri and Shabana along x."""
    x = np.linspace(0.0, LENGTH, count + 1)
    section = FrameSection(
        density=DENSITY, youngs_modulus=more.pop("modulus", 0.7e6), area=AREA, second_moment=INERTIA
    )
    return FrameBody(
        name="frame",
        nodes=np.column_stack([x, 0.0 * x, 0.0 * x]),
        tangents=np.tile([1.0, 0.0, 0.0], (count + 1, 1)),
        elements=np.column_stack([np.arange(count), np.arange(1, count + 1)]),
        sections=(section,),
        **more,
    )


def shell(count: tuple[int, int] = (2, 2), **more: Any) -> ShellBody:
    mesh = rectangle(1.0, 0.8, *count)
    return ShellBody(
        name="shell",
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(ShellSection(thickness=0.01, density=1000.0, youngs_modulus=1e6, poissons_ratio=0.3),),
        **more,
    )


def pinned(count: int, **more: Any) -> Scene:
    held = (Support(np.array([0]), {"position": "xyz"}),)
    return Scene(bodies=(frame(count, supports=held, **more),), forces=(Gravity(np.array([0.0, -G, 0.0])),))


def channel(simulation: Simulation, records: np.ndarray, name: str) -> np.ndarray:
    found = next(c for c in simulation.channels if c.name == name)
    return records[:, found.column : found.column + len(found.components)]


def accurately(scene: Scene, interval: float, count: int, tolerance: float) -> tuple[Simulation, np.ndarray]:
    simulation = Simulation(scene, interval, "accurate", tolerance=tolerance)
    _, records = simulation.advance(count)
    assert simulation.outcome is Outcome.COMPLETED, simulation.message
    return simulation, records


def ends(first: str, a: Any, second: str, b: Any) -> dict[str, Any]:
    """Of a joint between two points."""
    frames = {
        "frame_a": JointFrame(np.array(a, dtype=float)),
        "frame_b": JointFrame(np.array(b, dtype=float)),
    }
    return {"body_a": first, "body_b": second, **frames}


def weld(name: str, *points: Any) -> FixedJoint:
    return FixedJoint(name=name, **ends(*points))


def tip(simulation: Simulation, records: np.ndarray) -> np.ndarray:
    return channel(simulation, records, "frame.position")[:, -3:]


def oracle_tip(count: int, exact: bool, times: np.ndarray) -> np.ndarray:
    """Of the pendulum, by elements of complex arithmetic and the method of another library."""
    length = LENGTH / count
    section = OracleSection(EA=0.7e6 * AREA, EI=0.7e6 * INERTIA, mass=DENSITY * AREA)
    reference = np.array([[0.0, 0, 0], [1, 0, 0], [length, 0, 0], [1, 0, 0]])
    element = OracleElement(reference, section, exact)
    size = 6 * (count + 1)
    M = np.zeros((size, size))
    for e in range(count):
        own = slice(6 * e, 6 * e + 12)
        M[own, own] += np.kron(element.mass_matrix(), np.eye(3))
    unit = np.tile([0.0, -G, 0.0, 0.0, 0.0, 0.0], count + 1)
    weight = M @ unit
    inverse = np.zeros((size, size))
    inverse[3:, 3:] = np.linalg.inv(M[3:, 3:])
    q0 = np.tile([0.0, 0, 0, 1, 0, 0], count + 1)
    q0[::6] = length * np.arange(count + 1)

    def rate(_: float, state: np.ndarray) -> np.ndarray:
        q, force = state[:size], weight.copy()
        for e in range(count):
            own = slice(6 * e, 6 * e + 12)
            force[own] -= element.forces(q[own], element.strains(q[own]))
            if not exact:
                force[own] -= np.kron(element.bending_matrix(), np.eye(3)) @ q[own]
        return np.concatenate([state[size:], inverse @ force])

    found = solve_ivp(
        rate, (0.0, times[-1]), np.concatenate([q0, 0.0 * q0]), "DOP853", times, rtol=1e-10, atol=1e-10
    )
    return found.y[size - 6 : size - 3].T


@pytest.mark.slow
def test_the_pendulum_falls_as_independent_elements_do() -> None:
    interval, count = 0.03, 10
    expected = oracle_tip(2, exact=True, times=interval * np.arange(1, count + 1))
    deviations = []
    for tolerance in (1e-5, 1e-8):
        found = accurately(pinned(2, model="exact"), interval, count, tolerance)
        deviations.append(np.abs(tip(*found) - expected).max())
    assert deviations[0] < 1e-5, deviations
    assert deviations[1] < 1e-8, deviations


@pytest.mark.slow
def test_errors_follow_the_tolerance_and_energy_stays() -> None:
    scene = pinned(8)
    best = tip(*accurately(scene, 0.05, 12, 1e-12))
    errors = []
    for tolerance in (1e-5, 1e-7, 1e-9):
        simulation, records = accurately(scene, 0.05, 12, tolerance)
        errors.append(np.abs(tip(simulation, records) - best).max())
        balance = channel(simulation, records, "energy.balance")
        kinetic = channel(simulation, records, "energy.kinetic").max()
        assert np.ptp(balance) < 30.0 * tolerance / 1e-5 * kinetic * 1e-5
        assert errors[-1] < tolerance
    assert errors[2] < 1e-2 * errors[0]


@pytest.mark.slow
def test_loads_and_dampers_are_in_the_balance() -> None:
    load = DistributedLoad(
        np.array([3.0, 0.0, 5.0]), times=np.array([0.0, 0.1, 0.2]), factors=np.array([0.0, 1, 0])
    )
    scene = pinned(3, loads=(load,), viscous_damping=2.0, stiffness_damping=1e-3)
    simulation, records = accurately(scene, 0.02, 15, 1e-9)
    assert channel(simulation, records, "energy.dissipated")[-1] > 0.1
    assert abs(channel(simulation, records, "energy.external_work")[-1]) > 0.01
    assert np.ptp(channel(simulation, records, "energy.balance")) < 1e-6


@pytest.mark.slow
def test_the_energy_momentum_scheme_comes_to_the_same_with_its_order() -> None:
    best = tip(*accurately(pinned(3), 0.02, 10, 1e-11))
    errors = []
    for step in (2e-3, 1e-3, 5e-4):
        every = round(0.02 / step)
        simulation = Simulation(pinned(3, elasticity="energy-momentum"), step, record_every=every)
        _, records = simulation.advance(10 * every)
        errors.append(np.abs(tip(simulation, records) - best).max())
    assert np.all(np.abs(np.log2(np.array(errors[:-1]) / errors[1:]) - 2.0) < 0.1), errors


def rod_and_frame(elasticity: str = "auto") -> Scene:
    """A rigid rod on a hinge, a frame on a ball at its end, square to it, and a spring from the ground to the frame."""
    rod = RigidBody(
        name="rod", mass=1.0, inertia=np.diag([1e-3, 0.02, 0.02]), position=np.array([-0.25, 0.0, 0.0])
    )
    body = frame(3, elasticity=elasticity, orientation=np.array([math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0]))
    joints = (
        Hinge(name="hinge", **ends(GROUND, (-0.5, 0, 0), "rod", (-0.25, 0, 0))),
        Ball(name="ball", **ends("rod", (0.25, 0, 0), "frame", (0, 0, 0))),
    )
    spring = Spring(
        name="spring",
        body_a=GROUND,
        point_a=np.array([0.0, 0.5, -0.9]),
        body_b="frame",
        point_b=np.array([0.9, 0.0, 0.0]),
        length=0.4,
        stiffness=20.0,
    )
    return Scene(bodies=(rod, body), joints=joints, forces=(Gravity(np.array([0.0, -G, 0.0])), spring))


@pytest.mark.slow
def test_joints_and_forces_act_through_material_points() -> None:
    """The scheme of second order, extrapolated, and the energy; the ball stays closed."""
    simulation, records = accurately(rod_and_frame(), 0.02, 10, 1e-10)
    found = tip(simulation, records)
    rough = []
    for step in (1e-3, 5e-4):
        every = round(0.02 / step)
        other = Simulation(rod_and_frame("energy-momentum"), step, record_every=every)
        _, others = other.advance(10 * every)
        assert other.outcome is Outcome.COMPLETED, other.message
        rough.append(tip(other, others))
    coarse, fine = (np.abs(part - found).max() for part in rough)
    assert fine < 1e-4
    assert coarse / fine == pytest.approx(4.0, rel=0.05)
    assert np.abs((4.0 * rough[1] - rough[0]) / 3.0 - found).max() < 0.01 * fine
    assert np.ptp(channel(simulation, records, "energy.balance")) < 1e-7
    assert channel(simulation, records, "monitor.violation").max() < 1e-12


@kernel
def elastic_forces(kind: Any) -> None:
    add_elastic_forces(kind, 0, kind.position, kind.external_force, 1.0)


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["green-lagrange", "exact", "curved"])
def test_forces_in_one_pass_are_those_of_independent_elements(shape: str) -> None:
    rng = np.random.default_rng(5)
    turn = 0.7 if shape == "curved" else 0.0
    slopes = np.array([[1.0, 0.0, 0.0], [math.cos(turn), math.sin(turn), 0.0]])
    nodes = np.array([[0.0, 0.0, 0.0], [0.5, 0.5 * math.tan(0.5 * turn), 0.0]])
    body = replace(
        frame(1, model="green-lagrange" if shape == "green-lagrange" else "exact"),
        nodes=nodes,
        tangents=slopes,
    )
    kind = pack_scene(Scene(bodies=(body,))).bodies[0]
    places = np.array([0, 1, 2, 3, 4, 5, 8, 9, 10, 11, 12, 13])
    kind.position[places] += 0.1 * rng.normal(size=12)
    q = kind.position[places].copy()
    kind.external_force[:] = 0.0
    elastic_forces(kind)
    reference = np.stack([nodes[0], slopes[0], nodes[1], slopes[1]])
    section = OracleSection(EA=0.7e6 * AREA, EI=0.7e6 * INERTIA, mass=DENSITY * AREA)
    oracle = OracleElement(reference, section, shape != "green-lagrange", curved=shape == "curved")
    expected = oracle.forces(q, oracle.strains(q))
    if shape == "green-lagrange":
        expected += np.kron(oracle.bending_matrix(), np.eye(3)) @ q
    np.testing.assert_allclose(
        kind.external_force[places], expected, rtol=0.0, atol=1e-11 * np.abs(expected).max()
    )


def begin(bodies: Any, values: np.ndarray, work: Any) -> None:
    begin_stage(bodies, 0.0, values, 0, work)


@pytest.mark.slow
def test_second_rates_of_directions_are_those_of_differences() -> None:
    joints = (
        weld("a", GROUND, (0.3, 0.3, 0.0), "shell", (0.3, 0.3, 0.0)),
        weld("b", GROUND, (0.5, 0, 0), "frame", (0.5, 0, 0)),
    )
    layout = pack_scene(Scene(bodies=(frame(2), shell()), joints=joints), "accurate")
    integration = make_integration(layout.bodies, layout.joints, layout.systems, layout.work)
    rng = np.random.default_rng(3)
    types = set()
    states, step = {}, 1e-5
    for kind in layout.bodies:
        place, count = kind.table[0].state_place, kind.position.shape[0]
        states[place] = (kind.position + 0.1 * rng.normal(size=count), rng.normal(size=count))
        types |= set(kind.markers["type"])
        slope = kind.markers["type"] == VECTOR_MARKER  # the same vector, of unit length
        kind.markers["type"][slope] = TANGENT_MARKER
        kind.markers["data"][slope] = kind.table[0].base_step  # where a -1 stands
    assert types == {POINT_MARKER, VECTOR_MARKER, TRIAD_MARKER}

    def markers(time: float) -> np.ndarray:
        for place, (q, v) in states.items():
            integration.vectors[place : place + len(q)] = q + time * v
            integration.vectors[place + len(q) : place + 2 * len(q)] = v
        begin(layout.bodies, integration.vectors, layout.work)
        return layout.work.markers.copy()

    centre, before, after = markers(0.0), markers(-step), markers(step)
    for value, rate in (("point", "velocity"), ("velocity", "bias")):
        slope = (after[value] - before[value]) / (2.0 * step)
        largest = np.abs(slope).max()
        assert largest > 0.1
        np.testing.assert_allclose(centre[rate], slope, atol=1e-7 * max(1.0, largest))


@pytest.mark.parametrize(("count", "expected"), [(10, 2.218e-3), (20, 1.083e-3)])
def test_the_explicit_scheme_knows_its_longest_step(count: int, expected: float) -> None:
    """Of eigenvalues of the dense matrices at rest."""
    simulation = Simulation(pinned(count, elasticity="explicit"), 1e-4)
    simulation.warm_up()
    limit = simulation._layout.bodies[0].body[0].step_limit
    assert limit == pytest.approx(SHARE * expected, rel=0.02)
    body = pinned(count).bodies[0]
    assert isinstance(body, MeshBody)
    assert 0.5 * expected < 2.0 / body.highest_rate < expected


def test_a_longer_explicit_step_is_refused() -> None:
    simulation = Simulation(pinned(10, elasticity="explicit"), 1.7e-3)
    simulation.advance(3)
    assert simulation.outcome is Outcome.STEP_TOO_LARGE
    assert "frame" in simulation.message


def test_auto_is_accurate_only_where_elements_are_slow() -> None:
    soft, stiff = (Simulation(pinned(4, modulus=modulus), 0.01, "auto") for modulus in (0.7e6, 2.1e11))
    assert soft.integrator == "accurate"
    assert stiff.integrator == "dele2"
    assert "vibrate" in stiff.choice


@pytest.mark.slow
def test_a_shell_on_a_hinge_and_a_fixed_joint() -> None:
    """Accelerations of directions matter: energy is kept and the scheme of second order comes to the same."""

    def scene(elasticity: str) -> Scene:
        plate = RigidBody(
            name="bar", mass=1.0, inertia=np.diag([0.01, 0.02, 0.02]), position=np.array([1.2, 0.4, 0.0])
        )
        joints = (
            Hinge(name="hinge", **ends(GROUND, (0, 0.4, 0), "shell", (0, 0.4, 0))),
            weld("weld", "shell", (1.0, 0.4, 0), "bar", (-0.2, 0, 0)),
        )
        gravity = Gravity(np.array([0.0, -1.0, -3.0]))
        return Scene(bodies=(shell(elasticity=elasticity), plate), joints=joints, forces=(gravity,))

    simulation, records = accurately(scene("auto"), 0.02, 10, 1e-9)
    found = channel(simulation, records, "bar.position")
    rough = []
    for step in (1e-3, 5e-4):
        every = round(0.02 / step)
        other = Simulation(scene("energy-momentum"), step, record_every=every)
        _, others = other.advance(10 * every)
        rough.append(channel(other, others, "bar.position"))
    coarse, fine = (np.abs(part - found).max() for part in rough)
    assert coarse / fine == pytest.approx(4.0, rel=0.1)
    assert np.ptp(channel(simulation, records, "energy.balance")) < 1e-6
    assert channel(simulation, records, "monitor.violation").max() < 1e-10
