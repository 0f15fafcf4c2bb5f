"""Flexible bodies on free, driven and fixed frames."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from point_masses import Array, Cloud, Load, Start, System, channels_of, make_cloud
from scenarios import FLEXIBLE, GRAVITY, HARMONICS, errors, loads_of, reference, simulate, start_of
from solid_beams import beam, cantilever

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.primitives import plane_surface, sphere_surface
from heavylift.solver.forces.point import PointForce
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.scene import Driven, Fixed, Free, Gravity, Profile, RigidBody, Scene, Sensor
from heavylift.solver.simulation import Simulation

QUIET = (Gravity(np.zeros(3)), PointForce("none", "body", np.zeros(3), np.zeros(1), np.zeros((1, 3))))


@pytest.mark.parametrize("name", FLEXIBLE)
def test_every_channel_converges_to_the_point_masses(name: str) -> None:
    """With the leading error h^2 extrapolated away, what is left is far below any missing term."""
    system = FLEXIBLE[name]
    coarse, fine = (simulate(system.scene(), h) for h in (5e-4, 2.5e-4))
    limit = {key: (4.0 * fine[key] - coarse[key]) / 3.0 for key in fine}
    left = errors(limit, reference(system))
    del left["energy.balance"]  # the largest of a run, its order is tested elsewhere
    assert set(left) >= {"position", "orientation", "modal_position", "sensor.velocity", "momentum.angular"}
    assert {key: error for key, error in left.items() if error > 1e-4} == {}
    if system.motion is not None:
        assert {"reaction_force", "reaction_moment"} <= set(left)


def test_momenta_and_energy_of_a_free_body_over_ten_thousand_steps() -> None:
    """Momenta to rounding, also with modes far beyond the step; energy to 1e-4 with resolved modes."""
    start = replace(start_of(21, 8, spin=8.0), q=np.zeros(8))
    stiff = System(make_cloud(modes=8, seed=21, frequencies=(20.0, 3000.0)), start)
    _momenta_are_kept(stiff, 1e-3)
    soft = System(make_cloud(modes=8, seed=21), start_of(21, 8, spin=8.0))
    first, rows = _momenta_are_kept(soft, 1e-3)
    energy = [row["energy.balance"][0] / first["energy.balance"][0] - 1.0 for row in rows]
    assert np.abs(energy).max() < 1e-4


def _momenta_are_kept(system: System, step: float) -> tuple[dict[str, Array], list[dict[str, Array]]]:
    simulation = Simulation(system.scene(), step, record_every=200)
    first = channels_of(simulation, simulation.record())
    _, records = simulation.advance(10_000)
    rows = [channels_of(simulation, row) for row in records]
    for name in ("momentum.linear", "momentum.angular"):
        drift = max(np.linalg.norm(row[name] - first[name]) for row in rows)
        assert drift < 1e-10 * np.linalg.norm(first[name])
    assert len(rows) == 50
    return first, rows


@pytest.mark.parametrize("integrator", ["dele2", "thesis"])
@pytest.mark.parametrize("motion", [Fixed(), Driven()])
def test_a_mode_on_a_resting_frame_follows_the_trapezoidal_rule(integrator: str, motion: object) -> None:
    """Closed form for any step: ``q_n = q_0 cos(n theta)``, ``theta = 2 atan(w h / 2)``."""
    cloud = make_cloud(frequencies=(5.0, 200.0))
    start = replace(start_of(3), qd=np.zeros(5))
    h = 2e-3
    omega = np.sqrt(cloud.stiffness)
    theta = 2.0 * np.arctan(0.5 * omega * h)
    if integrator == "thesis":  # its rates belong to the middle of the step before
        start = replace(start, qd=0.5 * h * cloud.stiffness * start.q / (1.0 + 0.25 * (omega * h) ** 2))
    simulation = Simulation(System(cloud, start, motion).scene(), h, integrator)
    _, records = simulation.advance(400)
    for n in (1, 2, 17, 400):
        found = channels_of(simulation, records[n - 1])["modal_position"]
        np.testing.assert_allclose(found, start.q * np.cos(n * theta), atol=1e-11)


def test_static_deflection_under_gravity_and_a_load() -> None:
    """Critically damped modes come to rest where ``k q = S^T g + Phi^T f``; the reaction is the weight."""
    cloud = make_cloud(seed=4, rigid_part=1.0)
    start = replace(start_of(4), q=np.zeros(5), qd=np.zeros(5), orientation=np.array([1.0, 0.0, 0.0, 0.0]))
    force = np.array([3.0, -5.0, 8.0])
    load = Load(7, np.zeros(1), force[None])
    system = System(cloud, start, Fixed(), damping_ratio=np.ones(5), gravity=GRAVITY, loads=(load,))
    end = simulate(system.scene(), 1e-3, duration=4.0)
    modal = np.einsum("j,ijk,k->i", cloud.masses, cloud.shapes, GRAVITY) + cloud.shapes[:, 7] @ force
    np.testing.assert_allclose(end["modal_position"], modal / cloud.stiffness, rtol=1e-9)
    np.testing.assert_allclose(end["reaction_force"], -(5.0 * GRAVITY + force), rtol=1e-9)


def test_a_body_without_modes_moves_like_a_rigid_body() -> None:
    system = System(make_cloud(modes=0), start_of(5, 0), gravity=GRAVITY, loads=loads_of(5))
    flexible, rigid = simulate(system.scene(), 1e-3), simulate(system.rigid_scene(), 1e-3)
    fine = simulate(system.rigid_scene(), 1e-4)
    for name in ("position", "orientation", "angular_velocity", "sensor.velocity"):
        np.testing.assert_allclose(flexible[name], rigid[name], atol=2e-3)
        np.testing.assert_allclose(flexible[name], fine[name], atol=2e-3)


@pytest.mark.parametrize("motion", [None, Fixed(), HARMONICS])
def test_quaternions_of_any_length_are_accepted(motion: object) -> None:
    start = start_of(6)
    long = replace(start, orientation=3.0 * start.orientation)
    ends = [simulate(System(make_cloud(), s, motion).scene(), 1e-3, duration=0.05) for s in (start, long)]
    for name, value in ends[0].items():
        np.testing.assert_allclose(value, ends[1][name], atol=1e-12)


def test_recording_does_not_change_the_motion() -> None:
    """Not by a bit, although a record evaluates inertia and forces in the same workspace."""
    system = FLEXIBLE["free, loads and dampers"]
    ends = []
    for every in (1, 7, 350):
        simulation = Simulation(system.scene(), 1e-3, record_every=every)
        ends.append(simulation.advance(350)[1][-1])
    np.testing.assert_array_equal(ends[0], ends[1])
    np.testing.assert_array_equal(ends[0], ends[2])


def test_bodies_that_share_a_reduced_model_do_not_touch_each_other() -> None:
    """Two bodies, one model, different motions and mode counts beside them: each moves as if alone."""
    cloud, other = make_cloud(), make_cloud(modes=3, seed=9)
    starts = [start_of(7), start_of(8), start_of(9, 3)]
    systems = [
        System(cloud, starts[0], loads=loads_of(7), gravity=GRAVITY),
        System(other, starts[2], HARMONICS, gravity=GRAVITY),
        System(cloud, starts[1], gravity=GRAVITY),
    ]
    scenes = [system.scene(name) for system, name in zip(systems, "abc", strict=True)]
    bodies = [scene.bodies[0] for scene in scenes]
    shared = replace(bodies[2], reduced=bodies[0].reduced)  # type: ignore[type-var]
    forces = (Gravity(GRAVITY), *(force for force in scenes[0].forces if isinstance(force, PointForce)))
    together = Simulation(Scene((bodies[0], bodies[1], shared), forces), 1e-3)
    row = together.advance(100)[1][-1]
    for name, scene in zip("abc", scenes, strict=True):
        alone = Simulation(scene, 1e-3)
        expected = channels_of(alone, alone.advance(100)[1][-1], name)
        found = channels_of(together, row, name)
        for key in ("position", "orientation", "velocity", "modal_position", "modal_velocity"):
            np.testing.assert_array_equal(found[key], expected[key])


def test_a_sensor_sits_on_the_nearest_node() -> None:
    system = System(make_cloud(), start_of(10))
    scene = system.scene()
    node = system.cloud.nodes[system.sensor]
    near = replace(scene, sensors=(Sensor("sensor", "body", node + 1e-4),))
    rows = []
    for chosen in (scene, near):
        simulation = Simulation(chosen, 1e-3)
        rows.append(simulation.record())
    np.testing.assert_array_equal(*rows)


@pytest.mark.slow
def test_a_free_frame_needs_inertia_of_its_own() -> None:
    """Shapes that move almost rigidly make the step explode; a held frame may have them."""
    cloud = make_cloud(rigid_part=10.0)
    with pytest.raises(InputError, match=r"body: reduced: .* inertia is left .* mean-axis modes"):
        Simulation(System(cloud, start_of(1)).scene(), 1e-3)
    for motion in (Fixed(), HARMONICS):
        end = simulate(System(cloud, start_of(1), motion).scene(), 1e-3)
        expected = System(cloud, start_of(1), motion).solve(0.4)
        np.testing.assert_allclose(end["modal_position"], expected["modal_position"], atol=5e-3)


def test_the_share_of_inertia_depends_on_neither_units_nor_frame() -> None:
    """A body of 50 t whose shapes keep a small rigid part is as good as one of 5 kg."""
    cloud = make_cloud(rigid_part=0.5)
    heavy = replace(
        cloud,
        masses=1e4 * cloud.masses,
        shapes=1e-2 * cloud.shapes,
        nodes=cloud.nodes + np.array([100.0, 0.0, 0.0]),
    )
    Simulation(System(heavy, start_of(1)).scene(), 1e-3)


def test_a_drive_that_stands_still_is_a_fixed_frame() -> None:
    still = Driven(angle=Profile(np.array([0.0, 1.0]), np.array([0.0, 0.0])))
    ends = []
    for motion in (Fixed(), still):
        system = System(
            make_cloud(seed=12, rigid_part=1.0), start_of(12), motion, gravity=GRAVITY, loads=loads_of(12)
        )
        ends.append(simulate(system.scene(), 1e-3))
    for name in ends[0]:
        np.testing.assert_allclose(ends[0][name], ends[1][name], atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(("thickness", "limit"), [(0.03, 5e-5), (0.01, 1.2e-4)])
def test_slender_bodies_do_not_spin_up(thickness: float, limit: float) -> None:
    """A bar of point masses with bending modes, pushed at a node: second order, also if its axial inertia is 2e-3."""
    x = np.linspace(0.0, 1.0, 12)
    corners = [(1, 1), (1, -1), (-1, 1), (-1, -1)]
    nodes = np.concatenate(
        [np.column_stack([x, a * thickness + 0.0 * x, b * thickness + 0.0 * x]) for a, b in corners]
    )
    masses = np.full(len(nodes), 1.0 / len(nodes))
    bending = np.tile(np.sin(np.pi * x) - 2.0 / np.pi, 4)
    shapes = np.zeros((2, len(nodes), 3))
    shapes[0, :, 2] = shapes[1, :, 1] = bending
    shapes /= np.sqrt(masses @ bending**2)
    bar = Cloud(masses, nodes, shapes, (2.0 * np.pi * np.array([20.0, 20.0])) ** 2)
    zeros = np.zeros(2)
    start = Start(
        np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3), np.array([0.0, -1.0, 2.0]), zeros, zeros
    )
    pushes = np.array([[0.0, 0.0, 0.0], [0.0, 3.0, 5.0], [0.0, 0.0, 0.0]])
    load = Load(3, np.array([0.0, 0.2, 0.4]), pushes)
    system = System(bar, start, gravity=np.array([0.0, 0.0, -9.81]), loads=(load,))
    exact = system.solve(0.4)
    found = [errors(simulate(system.scene(), step), exact) for step in (0.004, 0.002)]
    assert found[0]["orientation"] < limit
    assert found[0]["angular_velocity"] < 6.0 * limit
    for name in ("orientation", "angular_velocity"):
        assert found[0][name] > 3.5 * found[1][name]


def test_a_slender_body_keeps_its_spin_about_its_axis_when_contacts_start():
    """Its momentum about the axis is known before the first step."""
    bar = beam(cantilever(modes=4, free=True), motion=Free(), angular_velocity=np.array([2.0, 0.1, 0.3]))
    floor = CollisionSurface(name="floor", body="ground", surface=plane_surface((4.0, 4.0)))
    ball = RigidBody("ball", 1.0, np.eye(3), position=np.array([0.0, 0.0, 5.0]))
    round_ = CollisionSurface(name="round", body="ball", surface=sphere_surface(0.1))
    scene = Scene(
        bodies=(bar, ball),
        surfaces=(floor, round_),
        collisions=(Collision(name="touch", surfaces=("floor", "round")),),
    )
    simulation = Simulation(scene, 1e-3)
    row = simulation.record()
    (column,) = (one.column for one in simulation.channels if one.name == "beam.angular_velocity")
    np.testing.assert_allclose(row[column : column + 3], [2.0, 0.1, 0.3], rtol=1e-12)
