"""The accurate integrator: order of the method, closed forms, mechanisms in minimal coordinates, continuation."""

from __future__ import annotations

import math

import numpy as np
import pytest
from rods import HALF, G, channel, hinge, loads, parallelogram, rod
from scipy.integrate import solve_ivp
from scipy.special import ellipj

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.forces.motor import JointMotor
from heavylift.solver.forces.point import PointForce
from heavylift.solver.forces.spring import JointSpring, Spring
from heavylift.solver.integrate import integration
from heavylift.solver.integrate.accurate import Integration, make_integration, stiffness_seen
from heavylift.solver.integrate.dop853 import STAGES, write_end, write_stage
from heavylift.solver.integrate.trees import forest
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.connections import GROUND, JointFrame, RopePoint
from heavylift.solver.scene.scene import Driven, Gravity, Harmonic, Profile, RigidBody, Scene, Sensor
from heavylift.solver.simulation import Simulation

MOMENTS = np.array([1.0, 2.0, 2.5])
SPIN = np.array([1.0, 0.0, 3.0])


def body_spin(time: np.ndarray) -> np.ndarray:
    """Spin of the free body by Jacobi's elliptic functions, (time, 3): Landau and Lifshitz, Mechanics, section 37."""
    I1, I2, I3 = MOMENTS
    E2, L2 = MOMENTS @ SPIN**2, (MOMENTS * SPIN) @ (MOMENTS * SPIN)
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


@kernel
def fixed_steps(values: np.ndarray, moments: np.ndarray, h: float, count: int) -> None:
    """Euler's equations of a free body by steps of equal length."""
    size, last = 8, STAGES + 1
    for _ in range(count):
        for stage in range(1, STAGES + 1):
            if stage > 1:
                write_stage(values, size, last, stage, h)
            at, out = (last if stage > 1 else 0) * size, stage * size
            for k in range(3):
                i, j = (k + 1) % 3, (k + 2) % 3
                values[out + k] = (moments[i] - moments[j]) / moments[k] * values[at + i] * values[at + j]
        write_end(values, size, last, h)
        for i in range(size):
            values[i] = values[last * size + i]


@pytest.mark.slow
def test_the_method_is_of_order_eight() -> None:
    duration, deviations = 4.0, []
    for count in (16, 32, 64):
        values = np.zeros((STAGES + 2) * 8)
        values[:3] = SPIN
        fixed_steps(values, MOMENTS, duration / count, count)
        deviations.append(np.abs(values[:3] - body_spin(np.array([duration]))[0]).max())
    orders = np.log2(np.array(deviations[:-1]) / deviations[1:])
    assert np.all(orders > 7.5), orders
    assert deviations[-1] < 1e-8


def top_scene(times: np.ndarray | None = None, forces: np.ndarray | None = None) -> Scene:
    """A free body beside a rod on a vertical hinge, which stands still."""
    top = RigidBody("top", 2.0, np.diag(MOMENTS), angular_velocity=SPIN)
    arm = rod("arm", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    joint = hinge("h", GROUND, "arm", (0.0, 0.0, 0.0), tuple(-HALF))
    return Scene((top, arm), loads((0.0, 0.0, -G), "top", times, forces), (), (joint,))


def test_records_between_the_steps_are_as_good_as_the_tolerance() -> None:
    """Free top and free fall, 20 records a step."""
    for tolerance in (1e-4, 1e-7):
        simulation = Simulation(top_scene(), 0.01, "accurate", tolerance=tolerance)
        times, records = simulation.advance(1000)
        found = channel(simulation, records, "top.angular_velocity")
        assert np.abs(found - body_spin(times)).max() < 10.0 * tolerance
        fall = channel(simulation, records, "top.position")[:, 2]
        np.testing.assert_allclose(fall, -0.5 * G * times**2, rtol=1e-9)
        assert simulation.solver_steps < 200
        turn = channel(simulation, records, "top.orientation")
        assert np.abs(np.linalg.norm(turn, axis=1) - 1.0).max() < 1e-14


def test_steps_end_where_a_load_has_a_corner() -> None:
    """A force that rises, stays and falls linearly: positions are cubic in each part, works follow."""
    knots, forces = np.array([0.0, 0.31, 1.0, 1.7]), np.zeros((4, 3))
    forces[1:3, 0] = 8.0
    simulation = Simulation(top_scene(knots, forces), 0.05, "accurate", tolerance=1e-6)
    times, records = simulation.advance(40)
    x = channel(simulation, records, "top.position")[:, 0]
    pieces = solve_ivp(
        lambda t, y: [y[1], np.interp(t, knots, forces[:, 0]) / 2.0],
        (0.0, 2.0),
        [0.0, 0.0],
        t_eval=times,
        rtol=1e-12,
        atol=1e-14,
        max_step=0.01,
    )
    np.testing.assert_allclose(x, pieces.y[0], atol=1e-9)
    work = channel(simulation, records, "energy.external_work")[:, 0]
    np.testing.assert_allclose(work, pieces.y[1] ** 2, atol=1e-6)
    assert simulation.solver_steps < 60


def chain(count: int, **motion: object) -> Scene:
    """Level links of 1 m on hinges; the first moves as told."""
    links = [rod(f"l{i}", (i, 0.0, 0.0), (i + 1.0, 0.0, 0.0)) for i in range(count)]
    joints = [
        hinge(f"h{i}", f"l{i - 1}" if i else GROUND, f"l{i}", tuple(HALF) if i else (0.0,) * 3, tuple(-HALF))
        for i in range(count)
    ]
    if motion:
        links[0], joints = rod("l0", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), **motion), joints[1:]
    sensor = Sensor("tip", f"l{count - 1}", HALF)
    return Scene(tuple(links), loads((0.0, -G, 0.0), "l0"), (sensor,), tuple(joints))


def chain_tip(count: int, times: np.ndarray) -> np.ndarray:
    """Tip of the chain from absolute angles: ``M(th) th'' + C th'^2 + Q = 0``."""
    i = np.arange(count)
    A = (count - 1 - np.maximum(i[:, None], i)) + 0.5
    A[i, i] = (count - 1 - i) + 1.0 / 3.0

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        th, w = y[:count], y[count:]
        difference = th[:, None] - th
        load = (A * np.sin(difference)) @ w**2 + G * (count - i - 0.5) * np.cos(th)
        return np.concatenate([w, -np.linalg.solve(A * np.cos(difference), load)])

    y = solve_ivp(rates, (0.0, times[-1]), np.zeros(2 * count), "DOP853", times, rtol=1e-12, atol=1e-12).y[
        :count
    ]
    return np.stack([np.cos(y).sum(axis=0), np.sin(y).sum(axis=0)], axis=1)


def test_error_of_a_chain_follows_the_tolerance() -> None:
    deviations = []
    for tolerance in (1e-3, 1e-5, 1e-7, 1e-9):
        simulation = Simulation(chain(3), 0.02, "accurate", tolerance=tolerance)
        times, records = simulation.advance(100)
        tip = channel(simulation, records, "tip.position")[:, :2]
        deviations.append(np.abs(tip - chain_tip(3, times)).max())
        assert channel(simulation, records, "monitor.violation").max() < 10.0 * tolerance
    assert np.all(np.array(deviations) < [3e-3, 3e-5, 3e-7, 3e-9]), deviations
    assert deviations[0] > 1e4 * deviations[3]


def test_energy_and_reaction_of_a_pendulum() -> None:
    """Radial reaction of a rod of 1 kg: ``m g (5 sin(th) + ...)/2`` from energy and acceleration."""
    simulation = Simulation(chain(1), 0.02, "accurate", tolerance=1e-8)
    _, records = simulation.advance(500)
    assert np.ptp(channel(simulation, records, "energy.balance")) < 1e-7
    tip = channel(simulation, records, "tip.position")
    sine, cosine = -tip[:, 1], tip[:, 0]  # of the angle below the horizon
    radial, tangential = 2.5 * G * sine, 0.25 * G * cosine  # w^2 = 3 g sine, w' = 1.5 g cosine
    force = channel(simulation, records, "h0.reaction_force")
    np.testing.assert_allclose(force[:, 0], -radial * cosine + tangential * sine, atol=1e-5)
    np.testing.assert_allclose(force[:, 1], radial * sine + tangential * cosine, atol=1e-5)


@pytest.mark.parametrize("loops", [1, 2])
def test_redundant_loops_pass_their_singular_positions(loops: int) -> None:
    """Cranks in parallel are one degree of freedom; ten passages in 10 s, each over an unstable top."""
    inertia, arm = (loops + 1) / 3 + loops, (loops + 1) / 2 + loops

    def rates(_: float, y: np.ndarray) -> list[float]:
        return [y[1], G * arm / inertia * math.sin(y[0])]

    deviations = []
    for tolerance in (1e-4, 1e-7):
        simulation = Simulation(parallelogram(loops), 0.1, "accurate", tolerance=tolerance)
        times, records = simulation.advance(100)
        phi = solve_ivp(rates, (0.0, 10.0), [0.0, 1.0], "DOP853", times, rtol=1e-12, atol=1e-12).y[0]
        tip = channel(simulation, records, "tip.position")
        expected = np.stack([np.sin(phi), np.cos(phi), 0.0 * phi], axis=1)
        deviations.append(np.linalg.norm(tip - expected, axis=1).max())
    assert deviations[0] < 2e-2, deviations
    assert deviations[1] < 1e-5, deviations


def test_a_driven_body_swings_a_pendulum_and_its_work_is_counted() -> None:
    """Pivot that moves up and down: ``J th'' = -(m/2) (g + z'') cos th`` for a rod."""
    drive = Driven(y=Profile(harmonics=(Harmonic(0.1, 1.5),)))
    simulation = Simulation(chain(2, motion=drive), 0.02, "accurate", tolerance=1e-8)
    times, records = simulation.advance(150)
    omega = 3.0 * math.pi

    def rates(t: float, y: np.ndarray) -> list[float]:
        return [y[1], -1.5 * (G - 0.1 * omega**2 * math.sin(omega * t)) * math.cos(y[0])]

    start = [0.0, 0.0]
    simulation_tip = channel(simulation, records, "tip.position")
    speed = 0.1 * omega  # of the pivot at the start: the free rod begins at rest and is brought to it
    start[1] = -1.5 * speed
    th = solve_ivp(rates, (0.0, 3.0), start, "DOP853", times, rtol=1e-12, atol=1e-12).y[0]
    expected = np.stack([1.0 + np.cos(th), 0.1 * np.sin(omega * times) + np.sin(th)], axis=1)
    np.testing.assert_allclose(simulation_tip[:, :2], expected, atol=1e-7)
    balance = channel(simulation, records, "energy.balance")[:, 0]
    assert np.ptp(balance) < 5e-5  # works are interpolated to a lower degree than positions
    assert np.ptp(channel(simulation, records, "energy.drive_work")) > 1.0


def test_a_run_goes_on_bit_for_bit() -> None:
    """The integrator is ahead of the records; what it carries is part of the state."""
    whole = Simulation(chain(3), 0.013, "accurate", tolerance=1e-6)
    whole.advance(23)
    state = whole.state()
    expected = whole.advance(40)[1]
    again = Simulation(chain(3), 0.013, "accurate", tolerance=1e-6)
    again.restore(state)
    parts = [again.advance(count)[1] for count in (1, 13, 26)]
    np.testing.assert_array_equal(np.vstack(parts), expected)


@pytest.mark.slow
@pytest.mark.parametrize(("stiffness", "damping", "stiff"), [(1e2, 1.0, False), (1e6, 4e4, True)])
def test_a_stiff_damper_is_seen(stiffness: float, damping: float, stiff: bool) -> None:
    """Time constant of 25 us, 400 times shorter than a record interval."""
    body = RigidBody("m", 1.0, 0.1 * np.eye(3), position=np.array([1.0, 0.0, 0.0]))
    ends = {"body_a": GROUND, "point_a": np.zeros(3), "body_b": "m", "point_b": np.zeros(3)}
    spring = Spring(name="s", length=1.0, stiffness=stiffness, damping=damping, **ends)
    scene = Scene((body,), (Gravity(np.array([0.0, -G, 0.0])), spring))
    simulation = Simulation(scene, 0.01, "accurate", tolerance=1e-6)
    simulation.advance(20)
    assert stiffness_seen(simulation._layout.systems[-1]) is stiff


def test_a_compliant_joint_is_refused() -> None:
    layout = pack_scene(chain(1))
    joints = tuple(layout.joints)
    table = layout.systems[0].rows.copy()
    table[0].compliance[0] = 1e-6
    soft = layout.systems[0]._replace(rows=table)
    with pytest.raises(InputError, match="'dele2'"):
        make_integration(layout.bodies, joints, (soft,), layout.work)
    made = make_integration(layout.bodies, joints, layout.systems, layout.work)
    assert isinstance(made, Integration)


def _gyroscope() -> Scene:
    """A rotor with 80 rad/s in two heavy gimbals whose axes meet; its centre of mass is beside them."""
    tilt = 1.2217304763960306
    turned = np.array([math.cos(0.5 * tilt), math.sin(0.5 * tilt), 0.0, 0.0])
    across = np.array([0.0, 0.5 * math.sin(tilt), 0.5 * math.cos(tilt)])
    spin = across + np.array([0.0, 0.0, 80.0])
    bodies = (
        RigidBody("outer", 1.0, np.diag([1.0, 1.0, 0.02]), angular_velocity=np.array([0.0, 0.0, 0.5])),
        RigidBody("inner", 1.0, np.diag([0.012, 0.015, 0.01]), orientation=turned, angular_velocity=across),
        RigidBody(
            "rotor", 4.0, np.diag([0.05, 0.05, 0.09]), np.array([0.0, 0.0, 0.03]),
            orientation=turned, angular_velocity=spin,
        ),
    )  # fmt: skip
    about_z, about_x = JointFrame(), JointFrame(axes=np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]]))
    joints = tuple(
        Hinge(name=name, body_a=a, body_b=b, frame_a=frame, frame_b=frame)
        for name, a, b, frame in (
            ("azimuth", GROUND, "outer", about_z),
            ("tilt", "outer", "inner", about_x),
            ("spin", "inner", "rotor", about_z),
        )
    )
    return Scene(bodies, (Gravity(np.array([0.0, 0.0, -9.81])),), joints=joints)


def test_a_coarse_tolerance_keeps_the_energy_of_a_fast_rotor() -> None:
    """Estimates of steps in which a body turns by two radians tell nothing: they passed while half of it went."""
    simulation = Simulation(_gyroscope(), 0.04, "accurate", tolerance=1e-3)
    first = simulation.record()
    rows = simulation.advance(100)[1]
    column = {channel.name: channel.column for channel in simulation.channels}["energy.balance"]
    assert np.abs(rows[:, column] / first[column] - 1.0).max() < 1e-7
    assert simulation.warning == ""


def test_energy_that_steps_lose_is_told() -> None:
    """0.8 radians a step of the default integrator."""
    simulation = Simulation(_gyroscope(), 0.01)
    simulation.record()
    simulation.advance(400)
    assert "J of energy (6" in simulation.warning
    assert "were lost that nothing dissipates" in simulation.warning


def test_what_was_lost_before_a_stop_is_told_after_it() -> None:
    """The watch begins with the start, however rare the records are, and goes on with a state."""
    whole = Simulation(_gyroscope(), 0.01, record_every=400)
    whole.advance(400)
    first = Simulation(_gyroscope(), 0.01, record_every=100)
    first.advance(300)
    second = Simulation(_gyroscope(), 0.01, record_every=100)
    second.restore(first.state())
    second.advance(100)
    for simulation in (whole, second):
        assert "J of energy (61.8%) were lost" in simulation.warning


def on_a_coil(*forces: PointForce) -> Scene:
    """Two links that hang; a coiled spring at the upper hinge."""
    along_y = JointFrame(np.zeros(3), np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]))
    end = JointFrame(np.array([1.0, 0.0, 0.0]), along_y.axes)
    bodies = tuple(
        RigidBody(name, mass, 0.3 * np.eye(3), 0.5 * end.point, position=x * end.point)
        for name, mass, x in (("upper", 2.0, 0.0), ("lower", 1.0, 1.0))
    )
    joints = (
        Hinge(name="top", body_a=GROUND, body_b="upper", frame_a=along_y, frame_b=along_y),
        Hinge(name="middle", body_a="lower", body_b="upper", frame_a=along_y, frame_b=end),
    )
    coil = JointSpring(name="coil", joint="top", stiffness=20.0, damping=2.0)
    return Scene(bodies, (Gravity(np.array([0.0, 0.0, -9.81])), coil, *forces), joints=joints)


@pytest.mark.parametrize("in_trees", [True, False])
def test_what_begins_at_rest_on_a_coiled_spring_stays_there(
    in_trees: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Accelerations that are rounding tell nothing of the first step: one of months would wind the spring up."""
    monkeypatch.setattr(forest, "SERVED", in_trees)
    still = PointForce("push", "lower", np.zeros(3), np.zeros(1), np.zeros((1, 3)))
    simulation = Simulation(on_a_coil(still), 0.02, "accurate", tolerance=1e-9, start="equilibrium")
    start = simulation.record()
    _, records = simulation.advance(500)
    assert not simulation.outcome, simulation.message
    for name in ("top.angle", "middle.angle"):
        angle = channel(simulation, records, name)
        np.testing.assert_allclose(angle, channel(simulation, start[None], name)[0, 0], atol=1e-7)


@pytest.mark.parametrize("in_trees", [True, False])
def test_steps_that_are_rejected_do_not_wind_a_spring_up(
    in_trees: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Steps at rest are long, so the first ones behind a jump of a force turn links many times, and are rejected."""
    monkeypatch.setattr(forest, "SERVED", in_trees)
    times = np.array([0.0, 30.0, 30.0001, 60.0])
    values = np.outer([0.0, 0.0, 300.0, 300.0], [0.0, 0.0, 1.0])
    push = PointForce("push", "lower", np.array([1.0, 0.0, 0.0]), times, values)
    ends = []
    for tolerance in (1e-4, 1e-9):
        simulation = Simulation(on_a_coil(push), 0.02, "accurate", tolerance=tolerance, start="equilibrium")
        _, records = simulation.advance(1530)
        assert not simulation.outcome, simulation.message
        ends.append(channel(simulation, records, "top.angle")[-1, 0])
    assert ends[0] == pytest.approx(ends[1], abs=2e-3)


@pytest.mark.parametrize("in_trees", [True, False])
def test_steps_that_are_rejected_do_not_wind_a_rope_up(
    in_trees: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As above: an arm on a rope about a drum."""
    monkeypatch.setattr(forest, "SERVED", in_trees)
    along_y = JointFrame(np.zeros(3), np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]))
    drum = RigidBody("drum", 50.0, 20.0 * np.eye(3))
    arm = RigidBody("arm", 20.0, 10.0 * np.eye(3), np.array([0.5, 0.0, -0.5]))
    joints = tuple(
        Hinge(name=f"axle of {name}", body_a=GROUND, body_b=name, frame_a=along_y, frame_b=along_y)
        for name in ("drum", "arm")
    )
    path = (
        RopePoint(GROUND, np.array([3.0, 0.0, -0.5])),
        RopePoint("drum", np.zeros(3), radius=0.5, axis=np.array([0.0, 1.0, 0.0])),
        RopePoint("arm", np.array([-1.5, 0.0, 1.0])),
    )
    rope = Rope(name="rope", path=path, axial_stiffness=1e5, damping=1e3)
    times, loads = np.array([0.0, 30.0, 30.0001, 60.0]), np.outer([0.0, 0.0, 1.0, 1.0], [3000.0, 0.0, 0.0])
    push = PointForce("push", "arm", np.array([0.0, 0.0, 1.0]), times, loads)
    forces = (Gravity(np.array([0.0, 0.0, -9.81])), push)
    scene = Scene((drum, arm), forces, ropes=(rope,), joints=joints)
    ends = []
    for tolerance in (1e-4, 1e-8):
        simulation = Simulation(scene, 0.02, "accurate", tolerance=tolerance, start="equilibrium")
        _, records = simulation.advance(1530)
        assert not simulation.outcome, simulation.message
        ends.append(channel(simulation, records, "axle of arm.angle")[-1, 0])
    assert ends[0] == pytest.approx(ends[1], abs=1e-4)
    assert abs(ends[1]) < 1.0  # the rope holds the arm


@pytest.mark.parametrize("integrator", ["accurate", "accurate by rows", "dele2"])
def test_work_of_motors_and_dampers_is_that_of_drives_and_losses(
    integrator: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A motor of 8 N m on a rotor with a damper: ``w = M/c (1 - exp(-c t/J))``; a weight on a damped spring."""
    monkeypatch.setattr(forest, "SERVED", integrator != "accurate by rows")
    inertia, torque, damping, mass, stiffness, loss = 2.0, 8.0, 3.0, 4.0, 100.0, 5.0
    rotor = RigidBody("rotor", 1.0, inertia * np.eye(3))
    weight = RigidBody(
        "weight", mass, np.eye(3), position=np.array([3.0, 0.0, 0.0]), velocity=np.array([1.5, 0.0, 0.0])
    )
    ends = {
        "body_a": GROUND,
        "point_a": np.array([1.0, 0.0, 0.0]),
        "body_b": "weight",
        "point_b": np.zeros(3),
    }
    scene = Scene(
        (rotor, weight),
        (
            JointMotor(name="motor", joint="axle", load=torque),
            JointSpring(name="brake", joint="axle", damping=damping),
            Spring(name="spring", length=2.0, stiffness=stiffness, damping=loss, **ends),
        ),
        joints=(Hinge(name="axle", body_a=GROUND, body_b="rotor"),),
    )
    step = 0.001 if integrator == "dele2" else 0.1
    options = {"record_every": 100} if integrator == "dele2" else {"tolerance": 1e-9}
    simulation = Simulation(scene, step, integrator.split(maxsplit=1)[0], **options)
    times, records = simulation.advance(round(2.0 / step))
    rate = damping / inertia
    speed = torque / damping * (1.0 - np.exp(-rate * times))
    driven = torque * (torque / damping * times - speed / rate)
    # x'' + 2 d x' + k/m x = 0 from x = 0
    d = 0.5 * loss / mass
    beat = np.sqrt(stiffness / mass - d * d)
    x = 1.5 / beat * np.exp(-d * times) * np.sin(beat * times)
    v = 1.5 * np.exp(-d * times) * np.cos(beat * times) - d * x
    lost = driven - 0.5 * inertia * speed**2 + 0.5 * mass * (1.5**2 - v**2) - 0.5 * stiffness * x**2
    near = 1e-4 if integrator == "dele2" else 1e-6
    for name, expected in (("drive_work", driven), ("dissipated", lost), ("external_work", 0.0 * times)):
        found = channel(simulation, records, f"energy.{name}")[:, 0]
        np.testing.assert_allclose(found, expected, atol=near * driven[-1])


def test_a_run_that_creeps_ends_with_a_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(integration, "MOST_STEPS", 50)
    simulation = Simulation(chain(1), 1e3, "accurate", tolerance=1e-8)
    times, _ = simulation.advance(2)
    assert not len(times)
    assert simulation.outcome is Outcome.STEP_TOO_SMALL
    assert "50 steps since the last record, the last one of 0.0" in simulation.message


def test_a_long_way_between_records_can_be_ended_and_goes_on_with_the_same_bits() -> None:
    """Some 40,000 steps from one record to the next: the integrator asks in between."""
    whole, again = (Simulation(chain(1), 2e3, "accurate", tolerance=1e-8) for _ in range(2))
    expected = whole.advance(2)[1]
    asked = [0]

    def stop() -> bool:
        asked[0] += 1
        return asked[0] == 1

    again.stop_asked = stop
    assert len(again.advance(2)[0]) == 0
    assert again.outcome is Outcome.COMPLETED
    third = Simulation(chain(1), 2e3, "accurate", tolerance=1e-8)
    third.restore(again.state())
    for simulation in (again, third):
        np.testing.assert_array_equal(simulation.advance(2)[1], expected)


@pytest.mark.parametrize("in_trees", [True, False])
def test_a_rope_at_its_length_is_slack_whatever_the_last_bit(
    in_trees: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its damper would pull at once, where the length of its path is rounded up."""
    monkeypatch.setattr(forest, "SERVED", in_trees)
    rng = np.random.default_rng(3)
    for _ in range(6):
        end = rng.normal(size=3)
        body = RigidBody(
            "arm", 1.0, np.eye(3), position=0.5 * end, angular_velocity=np.array([0.0, 0.0, 1.0])
        )
        ends = RopePoint(GROUND, rng.normal(size=3)), RopePoint("arm", 0.5 * end)
        length = (1.0 - 1e-15) * float(np.linalg.norm(end - ends[0].point))
        rope = Rope(name="rope", path=ends, axial_stiffness=1e3, damping=1e3, length=length)
        axle = Hinge(name="axle", body_a=GROUND, body_b="arm", frame_b=JointFrame(-0.5 * end))
        simulation = Simulation(
            Scene((body,), ropes=(rope,), joints=(axle,)), 0.1, "accurate", start="project"
        )
        assert channel(simulation, simulation.record()[None], "rope.tension")[0, 0] == 0.0


@pytest.mark.parametrize("offset", [0.0, 1e-5])
def test_hinges_that_contradict_each_other_are_told(offset: float) -> None:
    """A door on two hinges whose axes are parallel but not one: strictly it cannot move."""
    door = RigidBody("door", 20.0, np.diag([7.0, 2.0, 5.0]), position=np.array([0.5, 0.0, 1.0]))
    upper = JointFrame(np.array([0.0, offset, 1.8])), JointFrame(np.array([-0.5, offset, 0.8]))
    lower = JointFrame(np.array([0.0, 0.0, 0.2])), JointFrame(np.array([-0.5, 0.0, -0.8]))
    joints = tuple(
        Hinge(name=name, body_a=GROUND, body_b="door", frame_a=a, frame_b=b)
        for name, (a, b) in (("upper", upper), ("lower", lower))
    )
    push = PointForce("push", "door", np.zeros(3), np.zeros(1), np.array([[0.0, 10.0, 0.0]]))
    simulation = Simulation(Scene((door,), (push,), joints=joints), 0.05, "accurate")
    simulation.advance(20)
    assert ("joints of a loop contradict each other" in simulation.warning) is (offset > 0.0)
