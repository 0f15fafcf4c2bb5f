"""Trees in joint coordinates: reactions by a dense system of Newton and Euler, and the same motion as by rows."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from heavylift.numerics.outcome import Outcome
from heavylift.solver.forces.point import PointForce
from heavylift.solver.forces.spring import Spring
from heavylift.solver.integrate.trees import forest
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.distance import Distance
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.slider import Slider
from heavylift.solver.joints.slider_hinge import Cylindrical
from heavylift.solver.scene.connections import GROUND, Joint, JointFrame
from heavylift.solver.scene.scene import Fixed, Gravity, RigidBody, Scene, Sensor
from heavylift.solver.simulation import Simulation

GRAVITY = np.array([0.0, -3.0, -9.0])
TYPES = (Hinge, Slider, Ball, FixedJoint, Distance)

Pose = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Rotation matrix, origin, its velocity and the spin, all in world axes."""

HELD: Pose = (np.eye(3), np.zeros(3), np.zeros(3), np.zeros(3))


def drawn_frame(rng: np.random.Generator) -> JointFrame:
    return JointFrame(rng.normal(size=3), Rotation.random(rng=rng).as_matrix())


def hang(kind: type[Joint], above: Pose, a: JointFrame, b: JointFrame, rng: np.random.Generator) -> Pose:
    """A pose and velocities that a joint with drawn coordinates allows to b on a."""
    R, x, v, w = above
    A = R @ a.axes
    p = x + R @ a.point
    speed = v + np.cross(w, R @ a.point)
    turn, spin = np.eye(3), w
    if kind in (Hinge, Cylindrical):
        turn = Rotation.from_rotvec([0.0, 0.0, rng.uniform(-3.0, 3.0)]).as_matrix()
        spin = w + rng.normal() * A[:, 2]
    elif kind in (Ball, Distance):
        turn, spin = Rotation.random(rng=rng).as_matrix(), rng.normal(size=3)
    Q = A @ turn @ b.axes.T
    if kind in (Slider, Cylindrical):
        travel, rate = rng.normal(size=2)
        speed = speed + np.cross(w, travel * A[:, 2]) + rate * A[:, 2]
        p = p + travel * A[:, 2]
    elif kind is Distance:
        arm = rng.normal(size=3)
        p, speed = p + arm, speed + np.cross(rng.normal(size=3), arm)
    return Q, p - Q @ b.point, speed - np.cross(spin, Q @ b.point), spin


def drawn_scene(
    seed: int,
    count: int,
    *,
    floating: bool,
    types: tuple[type[Joint], ...] = TYPES,
    loops: int = 0,
    at_centre: bool = False,
) -> Scene:
    """A tree of bodies on joints of all types, with springs and forces; every second joint is told from below.

    Ball joints between its last bodies and the first one close loops where they stand. The last body may hang at its
    centre of mass.
    """
    rng = np.random.default_rng(seed)
    poses: list[Pose] = []
    bodies, joints = [], []
    for i in range(count):
        name, centre = f"body_{i}", rng.normal(size=3)
        if i == 0 and floating:
            poses.append((Rotation.random(rng=rng).as_matrix(), *rng.normal(size=(3, 3))))
        else:
            above = int(rng.integers(i)) if i else -1
            a, b, kind = drawn_frame(rng), drawn_frame(rng), types[i % len(types)]
            if at_centre and i == count - 1:
                b = JointFrame(centre, b.axes)
            pose = hang(kind, poses[above] if i else HELD, a, b, rng)
            on = f"body_{above}" if i else GROUND
            names = {"body_a": on, "body_b": name, "frame_a": a, "frame_b": b}
            # the joint frame of a slider moves along z of a: told from below it is the same line
            if i % 2 and kind is not Distance:
                names = {"body_a": name, "body_b": on, "frame_a": b, "frame_b": a}
            joints.append(kind(name=f"joint_{i}", **names))
            poses.append(pose)
        R, x, v, w = poses[-1]
        J = rng.normal(size=(3, 3))
        bodies.append(
            RigidBody(
                name,
                rng.uniform(0.5, 5.0),
                np.trace(J @ J.T) * np.eye(3) - J @ J.T,
                centre,
                position=x,
                orientation=Rotation.from_matrix(R).as_quat(scalar_first=True),
                velocity=v,
                angular_velocity=R.T @ w,
            )
        )
    for k in range(loops):
        place = rng.normal(size=3)
        ends = (poses[0], poses[count - 1 - k])
        a, b = (JointFrame(R.T @ (place - x)) for R, x, _, _ in ends)
        names = {"body_a": "body_0", "body_b": f"body_{count - 1 - k}", "frame_a": a, "frame_b": b}
        joints.append(Ball(name=f"loop_{k}", **names))
    force = rng.normal(size=(1, 3))
    ends = {"body_a": GROUND, "point_a": np.ones(3), "body_b": "body_0", "point_b": rng.normal(size=3)}
    forces = (
        Gravity(GRAVITY),
        PointForce("push", f"body_{count - 1}", rng.normal(size=3), np.zeros(1), force),
        Spring(name="spring", **ends, stiffness=20.0, damping=0.5, length=1.0),
    )
    sensors = (Sensor("tip", f"body_{count - 1}", rng.normal(size=3)),)
    return Scene(tuple(bodies), forces, sensors, tuple(joints))


def simulate(scene: Scene, trees: bool, monkeypatch: pytest.MonkeyPatch, tolerance: float) -> Simulation:
    monkeypatch.setattr(forest, "SERVED", trees)
    made = Simulation(scene, 0.05, "accurate", tolerance=tolerance)
    assert any(isinstance(kind, forest.Forest) for kind in made._layout.systems) == trees
    return made


def assert_same(scene: Scene, count: int, tolerance: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """All channels by rows and by trees, but the pivots of a system that is not there."""
    found = []
    for trees in (False, True):
        simulation = simulate(scene, trees, monkeypatch, 1e-10)
        first = simulation.record()
        found.append(np.vstack([first, simulation.advance(count)[1]]))
        assert simulation.outcome is Outcome.COMPLETED, simulation.message
    by_rows, by_trees = found
    for channel in simulation.channels:
        if channel.name in ("monitor.pivot", "monitor.violation"):
            continue
        columns = slice(channel.column, channel.column + len(channel.components))
        scale = np.abs(by_rows[:, columns]).max() + 1.0
        distance = np.abs(by_rows[:, columns] - by_trees[:, columns]).max()
        assert distance < tolerance * scale, (channel.name, distance, scale)


@pytest.mark.parametrize("floating", [False, True])
def test_trees_move_as_rows_hold_them(floating: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each type of joint twice or more, on both sides."""
    assert_same(drawn_scene(5 + floating, 12, floating=floating), 6, 2e-8, monkeypatch)


@pytest.mark.parametrize("types", [(Hinge, Slider, Ball), (Hinge, Distance, Distance)])
def test_a_body_may_hang_at_its_centre(
    types: tuple[type[Joint], ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its turning is then that of a body alone."""
    assert_same(drawn_scene(7, 6, floating=False, types=types, at_centre=True), 4, 2e-8, monkeypatch)


def test_other_joints_hold_trees_together(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two loops that ball joints close, and a joint that no tree has; rows are as many as it takes."""
    types = (Hinge, Ball, Cylindrical, Hinge, Slider)
    assert_same(drawn_scene(9, 8, floating=False, types=types, loops=2), 4, 1e-7, monkeypatch)


def test_trees_stand_on_bodies_that_are_held(monkeypatch: pytest.MonkeyPatch) -> None:
    """The held body feels what its joints carry; one of them is told from the tree's side."""
    rng = np.random.default_rng(2)
    turn, place = Rotation.random(rng=rng), rng.normal(size=3)
    held: Pose = (turn.as_matrix(), place, np.zeros(3), np.zeros(3))
    bodies = [
        RigidBody(
            "base", 3.0, np.diag([1.0, 2.0, 2.5]), rng.normal(size=3), position=place,
            orientation=turn.as_quat(scalar_first=True), motion=Fixed(),
        )
    ]  # fmt: skip
    joints = []
    for i, kind in enumerate((Hinge, Slider, Distance)):
        a, b = drawn_frame(rng), drawn_frame(rng)
        R, x, v, w = hang(kind, held, a, b, rng)
        bodies.append(
            RigidBody(
                f"body_{i}", 1.0, np.diag([0.2, 0.3, 0.4]), rng.normal(size=3), position=x,
                orientation=Rotation.from_matrix(R).as_quat(scalar_first=True), velocity=v, angular_velocity=R.T @ w,
            )
        )  # fmt: skip
        names = {"body_a": "base", "body_b": f"body_{i}", "frame_a": a, "frame_b": b}
        if kind is Slider:
            names = {"body_a": f"body_{i}", "body_b": "base", "frame_a": b, "frame_b": a}
        joints.append(kind(name=f"joint_{i}", **names))
    assert_same(Scene(tuple(bodies), (Gravity(GRAVITY),), (), tuple(joints)), 4, 2e-8, monkeypatch)


@pytest.mark.parametrize(("start", "speed", "told_from_below"), [(3.0, 40.0, False), (-3.1, -25.0, True)])
def test_whole_turns_are_counted(start: float, speed: float, told_from_below: bool) -> None:
    """A wheel turns on at its speed: the angle is that of the start, within half a turn, plus speed times time."""
    turn = Rotation.from_rotvec([0.0, 0.0, start])
    wheel = RigidBody(
        "wheel", 2.0, np.diag([0.2, 0.3, 0.5]), orientation=turn.as_quat(scalar_first=True),
        angular_velocity=np.array([0.0, 0.0, speed]),
    )  # fmt: skip
    ends = ("wheel", GROUND) if told_from_below else (GROUND, "wheel")
    frames = {"frame_a": JointFrame(np.zeros(3)), "frame_b": JointFrame(np.zeros(3))}
    axle = Hinge(name="axle", body_a=ends[0], body_b=ends[1], **frames)
    simulation = Simulation(Scene((wheel,), (), (), (axle,)), 0.02, "accurate", tolerance=1e-8)
    records = np.vstack([simulation.record(), simulation.advance(50)[1]])
    column = {channel.name: channel.column for channel in simulation.channels}
    sign = -1.0 if told_from_below else 1.0
    exact = sign * (start + speed * 0.02 * np.arange(51))
    np.testing.assert_allclose(records[:, column["axle.angle"]], exact, rtol=0.0, atol=1e-7)
    np.testing.assert_allclose(records[:, column["axle.angular_rate"]], sign * speed, rtol=1e-9)


@pytest.mark.parametrize("loops", [0, 1])
def test_trees_go_on_bit_for_bit(loops: int) -> None:
    types = (Hinge, Ball, Distance, Hinge)
    scene = drawn_scene(3, 5, floating=True, types=types, loops=loops)
    whole = Simulation(scene, 0.02, "accurate", tolerance=1e-5)
    rows = whole.advance(20)[1]
    of_factor = next(channel.column for channel in whole.channels if channel.name == "monitor.pivot")
    for stop in (1, 11):
        begun = Simulation(scene, 0.02, "accurate", tolerance=1e-5)
        begun.advance(stop)
        state = begun.state()
        again = Simulation(scene, 0.02, "accurate", tolerance=1e-5)
        again.restore(state)
        same = np.arange(rows.shape[1]) != of_factor  # which no state carries
        np.testing.assert_array_equal(again.record()[same], rows[stop - 1, same])
        np.testing.assert_array_equal(again.advance(20 - stop)[1], rows[stop:])


def hanging(masses: list[float], spread: float = 0.0) -> Scene:
    """A chain of level rods of 1 m from the ground, on hinges about y."""
    bodies, joints = [], []
    axes = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]).T
    for i, mass in enumerate(masses):
        inertia = mass * np.diag([0.01, 1 / 12 + spread, 1 / 12 + spread])
        bodies.append(RigidBody(f"rod_{i}", mass, inertia, position=np.array([i + 0.5, 0.0, 0.0])))
        a = JointFrame(np.array([0.5 if i else 0.0, 0.0, 0.0]), axes)
        b = JointFrame(np.array([-0.5, 0.0, 0.0]), axes)
        names = {"body_a": f"rod_{i - 1}" if i else GROUND, "body_b": f"rod_{i}", "frame_a": a, "frame_b": b}
        joints.append(Hinge(name=f"hinge_{i}", **names))
    return Scene(tuple(bodies), (Gravity(np.array([0.0, 0.0, -9.81])),), (), tuple(joints))


@pytest.mark.parametrize("masses", [[1.0, 1e-8, 1.0], [1e-8, 1.0, 1e8], [1e8, 1.0, 1e-8]])
def test_mass_ratios_of_a_hundred_million(masses: list[float]) -> None:
    simulation = Simulation(hanging(masses), 0.05, "accurate", tolerance=1e-8)
    records = np.vstack([simulation.record(), simulation.advance(20)[1]])
    assert simulation.outcome is Outcome.COMPLETED, simulation.message
    column = {channel.name: channel.column for channel in simulation.channels}
    turned_over = np.abs(records[:, column["energy.kinetic"]]).max()
    assert np.ptp(records[:, column["energy.balance"]]) < 1e-7 * turned_over
    assert records[:, column["monitor.violation"]].max() < 1e-12


@pytest.mark.slow
def test_a_chain_of_two_thousand() -> None:
    """What depends on all joints at once: energy, and the force on the ground is that of the momentum."""
    simulation = Simulation(hanging([1.0] * 2000), 0.02, "accurate", tolerance=1e-6)
    records = simulation.advance(5)[1]
    assert simulation.outcome is Outcome.COMPLETED, simulation.message
    column = {channel.name: channel.column for channel in simulation.channels}
    assert np.ptp(records[:, column["energy.balance"]]) < 1e-6 * records[-1, column["energy.kinetic"]]
    assert records[:, column["monitor.violation"]].max() < 1e-9


def test_a_mechanism_may_start_where_its_rows_depend_on_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    """A parallel four-bar that lies flat and is turned: there a row more follows from others than anywhere else."""

    def rod(name: str, middle: tuple[float, ...], velocity: float, spin: float) -> RigidBody:
        inertia = np.diag([0.01, 1 / 12, 1 / 12])
        moving = {"velocity": np.array([0.0, velocity, 0.0]), "angular_velocity": np.array([0.0, 0.0, spin])}
        return RigidBody(name, 1.0, inertia, position=np.array(middle), **moving)

    def pin(name: str, a: str, b: str, at_a: float, at_b: float) -> Hinge:
        frames = {
            "frame_a": JointFrame(np.array([at_a, 0.0, 0.0])),
            "frame_b": JointFrame(np.array([at_b, 0.0, 0.0])),
        }
        return Hinge(name=name, body_a=a, body_b=b, **frames)

    rods = (
        rod("left", (0.5, 0.0, 0.0), 0.5, 1.0),
        rod("over", (2.0, 0.0, 0.0), 1.0, 0.0),
        rod("right", (2.5, 0.0, 0.0), 0.5, 1.0),
    )
    pins = (
        pin("a", GROUND, "left", 0.0, -0.5),
        pin("b", "left", "over", 0.5, -1.0),
        pin("c", "over", "right", 1.0, 0.5),
        pin("d", GROUND, "right", 2.0, -0.5),
    )
    gravity = Gravity(np.array([0.0, -9.81, 0.0]))
    simulation = simulate(Scene(rods, (gravity,), (), pins), True, monkeypatch, 1e-8)
    records = np.vstack([simulation.record(), simulation.advance(40)[1]])
    assert simulation.outcome is Outcome.COMPLETED, simulation.message
    channels = {channel.name: channel for channel in simulation.channels}

    def rates(_: float, y: np.ndarray) -> list[float]:
        """Two cranks of 1/3 kg m2, with a rod of 1 kg that moves along a circle of 1 m."""
        return [y[1], -9.81 * 2.0 * np.cos(y[0]) / (5.0 / 3.0)]

    times = 0.05 * np.arange(41)
    exact = solve_ivp(rates, (0.0, 2.0), [0.0, 1.0], t_eval=times, rtol=1e-11, atol=1e-12, method="DOP853").y[
        0
    ]
    place = channels["over.position"].column
    middle = np.stack([1.0 + np.cos(exact), np.sin(exact)], axis=1)
    assert np.abs(records[:, place : place + 2] - middle).max() < 1e-5
