"""Rigid bodies: closed forms, and clouds of points without modes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from point_masses import System, channels_of, make_cloud
from scenarios import GRAVITY, HARMONICS, RIGID, errors, loads_of, reference, simulate, start_of
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from scipy.special import ellipj

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.forces.point import PointForce
from heavylift.solver.joints.ball import Ball
from heavylift.solver.scene.scene import Fixed, Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

MOMENTS = np.array([1.0, 2.0, 2.5])


def scene_of(body: RigidBody, gravity: np.ndarray | None = None, force: np.ndarray | None = None) -> Scene:
    """One body with gravity and a point force, so that all scenes here share compiled code."""
    load = np.zeros(3) if force is None else force
    return Scene(
        (body,),
        (
            Gravity(np.zeros(3) if gravity is None else gravity),
            PointForce("load", body.name, np.zeros(3), np.zeros(1), load[None]),
        ),
    )


def body_spin(spin: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Spin of a free body by Jacobi's elliptic functions, (time, 3); starts at ``w2 = 0``.

    Notes
    -----
    Landau and Lifshitz, Mechanics, section 37, for ``I1 < I2 < I3`` and ``L^2 > 2 E I2``.
    """
    I1, I2, I3 = MOMENTS
    E2, L2 = MOMENTS @ spin**2, (MOMENTS * spin) @ (MOMENTS * spin)
    assert L2 > E2 * I2
    rate = math.sqrt((I3 - I2) * (L2 - E2 * I1) / (I1 * I2 * I3))
    m = (I2 - I1) * (E2 * I3 - L2) / ((I3 - I2) * (L2 - E2 * I1))
    sn, cn, dn, _ = ellipj(rate * time, m)
    return np.stack(
        [
            math.sqrt((E2 * I3 - L2) / (I1 * (I3 - I1))) * cn,
            math.sqrt((E2 * I3 - L2) / (I2 * (I3 - I2))) * sn,
            math.sqrt((L2 - E2 * I1) / (I3 * (I3 - I1))) * dn,
        ],
        axis=1,
    )


@pytest.mark.parametrize("turned", [False, True])
def test_free_top_follows_the_elliptic_functions_with_order_two(turned: bool) -> None:
    """Also with axes of the body that are not its principal ones."""
    axes = Rotation.from_rotvec([0.4, -1.2, 0.7]).as_matrix() if turned else np.eye(3)
    spin = np.array([1.0, 0.0, 3.0])
    body = RigidBody("top", 3.0, axes @ np.diag(MOMENTS) @ axes.T, angular_velocity=axes @ spin)
    duration, deviations = 5.0, []
    for step in (5e-3, 2.5e-3, 1.25e-3):
        simulation = Simulation(scene_of(body), step, record_every=round(0.1 / step))
        times, records = simulation.advance(round(duration / step))
        found = np.array([channels_of(simulation, row, "top")["angular_velocity"] for row in records]) @ axes
        deviations.append(np.abs(found - body_spin(spin, times)).max())
    assert deviations[-1] < 1e-4
    assert np.log2(deviations[0] / deviations[1]) > 1.95
    assert np.log2(deviations[1] / deviations[2]) > 1.95


def test_symmetric_top_turns_about_the_angular_momentum() -> None:
    """Closed form of the attitude: ``R = exp(t L/I1) exp(t (1/I3 - 1/I1) L3 e3)``."""
    I1, I3 = 2.0, 0.5
    spin = np.array([0.7, 0.0, 4.0])
    body = RigidBody("top", 1.0, np.diag([I1, I1, 0.5]), angular_velocity=spin)
    L = np.array([I1, I1, I3]) * spin
    duration, deviations = 2.0, []
    expected = Rotation.from_rotvec(duration * L / I1) * Rotation.from_rotvec(
        [0.0, 0.0, duration * (1 / I3 - 1 / I1) * L[2]]
    )
    for step in (2e-3, 1e-3):
        found = simulate(scene_of(body), step, duration=duration)["top.orientation"]
        turn = expected.inv() * Rotation.from_quat(found, scalar_first=True)
        deviations.append(turn.magnitude())
    assert deviations[1] < 1e-5
    assert np.log2(deviations[0] / deviations[1]) > 1.95


@pytest.mark.parametrize("integrator", ["dele2", "thesis"])
def test_fall_and_steady_turn_are_exact(integrator: str) -> None:
    """Constant acceleration, and spin about a principal axis: no error at any step with the default."""
    v, g, spin = np.array([1.0, 2.0, 3.0]), np.array([0.0, 0.5, -9.81]), np.array([0.0, 2.0, 0.0])
    force = np.array([4.0, 0.0, 2.0])
    body = RigidBody("body", 2.0, np.diag(MOMENTS), velocity=v, angular_velocity=spin)
    step, count = 0.05, 40
    end = simulate(scene_of(body, g, force), step, integrator, duration=step * count)
    time, a = step * count, g + force / 2.0
    early = 0.0 if integrator == "dele2" else 0.5 * step * time  # its path is half a step ahead
    np.testing.assert_allclose(end["position"], v * time + a * (0.5 * time**2 + early), rtol=1e-13)
    np.testing.assert_allclose(end["velocity"], v + a * time, rtol=1e-13)
    np.testing.assert_allclose(end["orientation"], Rotation.from_rotvec(time * spin).as_matrix(), atol=1e-13)
    np.testing.assert_allclose(end["energy.external_work"], force @ end["position"], rtol=1e-13)
    if integrator == "dele2":
        assert end["energy.balance"][0] < 1e-11


@pytest.mark.slow
@pytest.mark.parametrize("name", RIGID)
def test_every_channel_converges_to_the_point_masses(name: str) -> None:
    """Offset centre of mass, skew principal axes, loads in world and body axes, driven and fixed frames."""
    system = RIGID[name]
    coarse, fine = (simulate(system.rigid_scene(), h) for h in (1e-3, 5e-4))
    limit = {key: (4.0 * fine[key] - coarse[key]) / 3.0 for key in fine}
    left = errors(limit, reference(system))
    del left["energy.balance"]
    assert set(left) >= {"position", "angular_velocity", "sensor.velocity", "energy.kinetic"}
    assert {key: error for key, error in left.items() if error > 1e-6} == {}
    if system.motion is not None:
        assert {"reaction_force", "reaction_moment"} <= set(left)


def test_momenta_of_a_free_body_over_ten_thousand_steps() -> None:
    """To rounding, while the energy error stays bounded."""
    system = System(make_cloud(modes=0, seed=16), start_of(16, 0, spin=20.0))
    simulation = Simulation(system.rigid_scene(), 2e-3, record_every=100)
    first = channels_of(simulation, simulation.record())
    rows = [channels_of(simulation, row) for row in simulation.advance(10_000)[1]]
    for name in ("momentum.linear", "momentum.angular"):
        drift = max(np.linalg.norm(row[name] - first[name]) for row in rows)
        assert drift < 1e-10 * np.linalg.norm(first[name])
    energy = np.array([row["energy.balance"][0] for row in rows]) / first["energy.balance"][0] - 1.0
    assert np.abs(energy).max() < 2e-3
    assert np.abs(energy[:50]).max() > 0.2 * np.abs(energy[50:]).max(), "it must not grow"


def test_the_origin_of_the_body_frame_is_a_convention() -> None:
    """The same body described from another origin moves alike, and its fixture holds it alike."""
    shift = np.array([0.3, -2.0, 1.0])
    start = start_of(17, 0)
    R = Rotation.from_quat(start.orientation, scalar_first=True).as_matrix()
    ends = []
    for offset in (np.zeros(3), shift):
        body = RigidBody(
            "body",
            4.0,
            np.diag(MOMENTS),
            centre_of_mass=np.array([0.1, 0.2, 0.3]) - offset,
            position=start.position + R @ offset,
            orientation=start.orientation,
            velocity=start.velocity + R @ np.cross(start.spin, offset),
            angular_velocity=start.spin,
        )
        ends.append(simulate(scene_of(body, GRAVITY), 1e-3))
    np.testing.assert_allclose(ends[0]["orientation"], ends[1]["orientation"], atol=1e-12)
    np.testing.assert_allclose(
        ends[0]["position"] + ends[0]["orientation"] @ shift, ends[1]["position"], atol=1e-11
    )
    for name in ("momentum.linear", "momentum.angular", "energy.kinetic"):
        np.testing.assert_allclose(ends[0][name], ends[1][name], rtol=1e-11)


def test_a_fixed_body_stands_still_on_its_weight() -> None:
    """Force ``-m g``, moment about the origin of the frame ``-c x m g``."""
    centre = np.array([0.5, -0.2, 0.1])
    body = RigidBody("body", 4.0, np.diag(MOMENTS), centre, motion=Fixed(), velocity=np.ones(3))
    end = simulate(scene_of(body, GRAVITY), 1e-2)
    np.testing.assert_array_equal(end["velocity"], 0.0)
    np.testing.assert_array_equal(end["position"], 0.0)
    np.testing.assert_allclose(end["reaction_force"], -4.0 * GRAVITY)
    np.testing.assert_allclose(end["reaction_moment"], -np.cross(centre, 4.0 * GRAVITY))


def test_turning_too_far_in_a_step_stops_before_it_happens() -> None:
    body = RigidBody("wheel", 1.0, np.diag(MOMENTS), angular_velocity=np.array([0.0, 0.0, 120.0]))
    simulation = Simulation(scene_of(body), 1e-2)
    assert len(simulation.advance(5)[0]) == 0
    assert simulation.outcome is Outcome.STEP_TOO_LARGE
    assert "'wheel'" in simulation.message
    assert "smaller step" in simulation.message


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mass": 0.0}, r"body: mass: 0.0 is too small; expected a mass > 0 kg"),
        ({"mass": -1.0}, r"body: mass: -1.0 is too small"),
        ({"mass": math.nan}, r"body: mass: nan is not finite"),
        ({"inertia": np.diag([1.0, 1.0, 2.1])}, r"body: inertia: .*exceeds the sum of the others"),
        ({"inertia": np.diag([0.0, 1.0, 1.0])}, r"body: inertia: .*not positive definite"),
        ({"inertia": np.diag([-1.0, 1.0, 1.0])}, r"body: inertia: .*not positive definite"),
        ({"inertia": np.eye(3) + np.eye(3, k=1)}, r"body: inertia: entries 01 and 10 differ"),
        ({"inertia": np.ones(3)}, r"body: inertia: .*shape \(3, 3\)"),
        ({"position": np.array([0.0, math.nan, 0.0])}, r"body: position: .*finite numbers, shape \(3,\)"),
        ({"velocity": np.zeros(2)}, r"body: velocity: .*shape \(3,\)"),
        ({"orientation": np.zeros(4)}, r"body: orientation: length zero"),
        ({"centre_of_mass": np.full(3, math.inf)}, r"body: centre_of_mass: "),
    ],
)
def test_bad_bodies(changes: dict, message: str) -> None:
    given = {"mass": 1.0, "inertia": np.eye(3)} | changes
    with pytest.raises(InputError, match=message):
        Simulation(scene_of(RigidBody("body", **given)), 1e-3)


def test_flat_and_thin_bodies_are_bodies() -> None:
    """A plate meets the triangle rule with equality."""
    Simulation(scene_of(RigidBody("plate", 1.0, np.diag([1.0, 1.0, 2.0]))), 1e-3)


def test_driven_body_moves_and_holds_like_the_flexible_one() -> None:
    system = System(make_cloud(modes=0, seed=18), start_of(18, 0), HARMONICS, loads=loads_of(18))
    rigid, flexible = simulate(system.rigid_scene(), 1e-3), simulate(system.scene(), 1e-3)
    for name in ("position", "velocity", "angular_velocity", "reaction_force", "reaction_moment"):
        np.testing.assert_allclose(rigid[name], flexible[name], atol=1e-11)
    np.testing.assert_allclose(rigid["energy.drive_work"], flexible["energy.drive_work"], atol=1e-3)


def test_a_rod_on_a_ball_joint_does_not_spin_up() -> None:
    """A spherical pendulum, of second order however thin it is, and near a thick one; its axial spin stays zero.

    Oracle: the direction n of the axis of a rod with the moment of inertia I about the pivot,
    ``n'' = -|n'|^2 n + m c / I (g - n.g n)``, by an integrator of SciPy.
    """
    mass, arm, across = 1.0, 0.75, 0.4375  # I = 1 about the pivot
    g, n0, rate = np.array([0.0, 0.0, -9.81]), np.array([1.0, 0.0, 0.0]), np.array([0.0, 2.0, 1.0])

    def pendulum(_t: float, y: np.ndarray) -> np.ndarray:
        n, u = y[:3], y[3:]
        return np.concatenate([u, mass * arm * (g - n @ g * n) - u @ u * n])

    exact = solve_ivp(pendulum, (0.0, 2.0), np.concatenate([n0, rate]), rtol=1e-11, atol=1e-12).y[:3, -1]

    def error(ratio: float, step: float) -> float:
        rod = RigidBody(
            "rod", mass, np.diag([ratio * across, across, across]), np.array([arm, 0.0, 0.0]),
            angular_velocity=np.cross(n0, rate),
        )  # fmt: skip
        pivot = Ball(name="pivot", body_a="ground", body_b="rod")
        simulation = Simulation(Scene((rod,), (Gravity(g),), joints=(pivot,)), step)
        times, rows = simulation.advance(round(2.0 / step))
        assert simulation.outcome is Outcome.COMPLETED
        assert times[-1] == pytest.approx(2.0)
        end = channels_of(simulation, rows[-1])
        spins = np.array([channels_of(simulation, row)["rod.angular_velocity"] for row in rows])
        if ratio < 1e-3:
            assert np.abs(spins[:, 0]).max() < 1e-5  # rounding of the momentum over the moment of inertia
        w, x, y, z = end["rod.orientation"]
        found: float = np.linalg.norm(Rotation.from_quat([x, y, z, w]).apply(n0) - exact)
        return found

    for ratio in (6e-5, 1e-6):
        coarse, fine = error(ratio, 0.01), error(ratio, 0.005)
        assert coarse / fine > 3.5
        assert coarse < 1.5 * error(0.3, 0.01)
