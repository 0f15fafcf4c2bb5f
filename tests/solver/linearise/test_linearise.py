"""Modes of scenes about a state, against closed forms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh, expm
from start_scenes import joint, linkage, parallelograms, rod

from heavylift.numerics.outcome import InputError
from heavylift.solver.force_elements.maxwell_rope import MaxwellRope
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.forces.spring import Spring
from heavylift.solver.inputs.drives import DriveSpeedInput, FramePositionInput, FrameSpeedInput
from heavylift.solver.inputs.force import ForceInput
from heavylift.solver.inputs.winches import WinchLengthInput, WinchSpeedInput
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.slider import Slider
from heavylift.solver.linearise.linearise import linearise
from heavylift.solver.linearise.result import Linearisation
from heavylift.solver.scene.connections import GROUND, RopePoint, Winch
from heavylift.solver.scene.scene import Fixed, Gravity, Profile, RigidBody, Scene
from heavylift.solver.simulation import Simulation

G = 9.81
DOWN = Gravity(np.array([0.0, 0.0, -G]))
EA = 5e7
MASS, INERTIA = 1e4, np.array([2e4, 5e4, 6e4])


def of(scene: Scene, **more: Any) -> Linearisation:
    return linearise(Simulation(scene, 0.01, **more))


def rope(name: str, start: Any, body: str, point: Any, tension: float, above: str = GROUND) -> Rope:
    """A rope with a tension at the start; points of bodies in their own axes."""
    path = (RopePoint(above, np.array(start, dtype=float)), RopePoint(body, np.array(point, dtype=float)))
    return Rope(name=name, path=path, axial_stiffness=EA, tension=tension)


def slung(lugs: Sequence[Any], hooks: Sequence[Any], tensions: Sequence[float]) -> Scene:
    """A load at the origin, its lugs hanging on ropes from points in the world."""
    load = RigidBody("load", MASS, np.diag(INERTIA))
    ropes = [
        rope(f"s{i}", hook, "load", lug, T)
        for i, (lug, hook, T) in enumerate(zip(lugs, hooks, tensions, strict=True))
    ]
    return Scene((load,), (DOWN,), (), (), tuple(ropes))


def slung_frequencies(lugs: Sequence[Any], hooks: Sequence[Any], tensions: Sequence[float]) -> np.ndarray:
    """Of small motions [Hz], from the second variation of the energy.

    A rope of tension T, length s and stiffness k along n gives a displacement of its lug ``k n n^T + T/s (1 - n
    n^T)``; its force f at r resists a turn t by ``(f . r) t^2 - (f . t)(r . t)`` more.
    """
    K = np.zeros((6, 6))
    for lug, hook, T in zip(lugs, hooks, tensions, strict=True):
        r, way = np.array(lug, dtype=float), np.array(hook, dtype=float) - np.array(lug, dtype=float)
        s = np.linalg.norm(way)
        n = way / s
        rest = s / (1.0 + T / EA)
        k = EA / rest * np.outer(n, n) + T / s * (np.eye(3) - np.outer(n, n))
        J = np.hstack([np.eye(3), -np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])])
        K += J.T @ k @ J
        f = T * n
        K[3:, 3:] += (f @ r) * np.eye(3) - 0.5 * (np.outer(f, r) + np.outer(r, f))
    squares = eigh(K, np.diag([MASS, MASS, MASS, *INERTIA]), eigvals_only=True)
    return np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi)


def test_load_on_a_single_rope() -> None:
    """Swing and nod in two planes, bounce; nothing holds its yaw."""
    d, s = 1.5, 20.0
    lugs, hooks = [(0, 0, d)], [(0, 0, d + s)]
    found = of(slung(lugs, hooks, [MASS * G]))
    assert found.zeros == 2
    assert found.frequencies[0] == 0.0
    assert found.frequencies[1:] == pytest.approx(slung_frequencies(lugs, hooks, [MASS * G])[1:], rel=1e-8)
    swing = [0, 0]
    for plane, I in enumerate((INERTIA[1], INERTIA[0])):
        # (g/s)(x - d t) = w2 x,  m g d t + m g d/s (d t - x) = w2 I t
        a, b, c = I / MASS * s / G, -(I / MASS + d * d + d * s), d * G
        swing[plane] = np.sqrt((-b - np.sqrt(b * b - 4 * a * c)) / (2 * a)) / (2 * np.pi)
    assert found.frequencies[1:3] == pytest.approx(sorted(swing), rel=1e-8)
    assert found.frequencies[-1] == pytest.approx(
        np.sqrt(EA * (1.0 + MASS * G / EA) / s / MASS) / (2 * np.pi), rel=1e-9
    )
    assert np.abs(found.damping).max() < 1e-7
    assert found.residual < 1e-9
    assert found.warnings == ()


def test_two_point_sling() -> None:
    """Vertical ropes: the yaw has ``w2 = m g a2 / (I s)``."""
    a, d, s = 4.0, 1.0, 12.0
    lugs = [(a, 0, d), (-a, 0, d)]
    hooks = [(a, 0, d + s), (-a, 0, d + s)]
    found = of(slung(lugs, hooks, [0.5 * MASS * G] * 2))
    assert found.frequencies == pytest.approx(slung_frequencies(lugs, hooks, [0.5 * MASS * G] * 2), rel=1e-7)
    yaw = np.abs(found.shapes["load"].rotation[:, 2]).argmax()
    expected = np.sqrt(MASS * G * a * a / (INERTIA[2] * s)) / (2 * np.pi)
    assert found.frequencies[yaw] == pytest.approx(expected, rel=1e-8)
    assert np.abs(found.shapes["load"].rotation[yaw]) == pytest.approx([0, 0, 1], abs=1e-6)


def test_trifilar_pendulum_and_inclined_slings() -> None:
    """Yaw on three ropes, ``w2 = m g r2 / (I s)``; four inclined slings against the second variation."""
    r, s = 3.0, 9.0
    corners = [(r * np.cos(t), r * np.sin(t)) for t in np.radians([90, 210, 330])]
    lugs, hooks = [(x, y, 0.5) for x, y in corners], [(x, y, 0.5 + s) for x, y in corners]
    found = of(slung(lugs, hooks, [MASS * G / 3] * 3))
    yaw = np.abs(found.shapes["load"].rotation[:, 2]).argmax()
    expected = np.sqrt(MASS * G * r * r / (INERTIA[2] * s)) / (2 * np.pi)
    assert found.frequencies[yaw] == pytest.approx(expected, rel=1e-8)
    lugs = [(5.0 * a, 3.0 * b, 1.0) for a in (1, -1) for b in (1, -1)]
    hooks = [(1.0 * a, 0.5 * b, 9.0) for a in (1, -1) for b in (1, -1)]
    way = np.array(hooks[0]) - lugs[0]
    T = MASS * G / 4 * np.linalg.norm(way) / way[2]
    found = of(slung(lugs, hooks, [T] * 4))
    assert found.frequencies == pytest.approx(slung_frequencies(lugs, hooks, [T] * 4), rel=1e-7)


def test_hook_block_and_load_are_a_double_pendulum() -> None:
    """Masses on two ropes through their centres; frequencies come in pairs, their shapes span both planes."""
    m1, m2, s1, s2 = 2e3, 8e3, 15.0, 6.0
    hook = RigidBody("hook", m1, 10.0 * np.eye(3), position=np.array([0, 0, s2]))
    load = RigidBody("load", m2, np.diag(INERTIA))
    ropes = (
        rope("hoist", (0, 0, s1 + s2), "hook", (0, 0, 0), (m1 + m2) * G),
        rope("sling", (0, 0, 0), "load", (0, 0, 0), m2 * G, above="hook"),
    )
    found = of(Scene((hook, load), (DOWN,), (), (), ropes))
    t1, t2 = (m1 + m2) * G / s1, m2 * G / s2
    squares = eigh(np.array([[t1 + t2, -t2], [-t2, t2]]), np.diag([m1, m2]), eigvals_only=True)
    first = np.sqrt(squares) / (2 * np.pi)
    assert found.zeros == 12  # nothing holds the rotations
    assert found.frequencies[:6] == pytest.approx(np.zeros(6), abs=0.0)
    assert found.frequencies[6:8] == pytest.approx([first[0]] * 2, rel=1e-8)
    assert found.frequencies[8:10] == pytest.approx([first[1]] * 2, rel=1e-8)
    sway = found.shapes["load"].displacement[6:8, :2]
    assert abs(np.linalg.det(sway / np.linalg.norm(sway, axis=1)[:, None])) > 0.1


def test_hinged_rod_hanging_and_upside_down() -> None:
    """``w2 = 3 g / (2 L)``; upside down it falls as ``exp(w t)``."""
    for up, other in ((-1.0, False), (1.0, True)):
        found = of(linkage([(0, 0, 0), (0, up, 0)], closed=False), start="check")
        assert len(found.states) == 2
        rate = np.sqrt(1.5 * G)
        if other:
            assert sorted(found.eigenvalues.real) == pytest.approx([-rate, rate], rel=1e-8)
            assert list(found.unstable) == [int(found.eigenvalues.real.argmax())]
        else:
            assert found.eigenvalues == pytest.approx([1j * rate], rel=1e-8)
            assert not found.unstable.size


def test_redundant_loops() -> None:
    """Coupled parallelograms upright: four cranks of m L2/3 turn, three bars of m go along."""
    found = of(parallelograms(3))
    assert len(found.states) == 2
    rate = np.sqrt((4 * 0.5 + 3) * G / (4 / 3 + 3))
    assert sorted(found.eigenvalues.real) == pytest.approx([-rate, rate], rel=1e-7)


def test_damper() -> None:
    """A mass on a spring with a damper, and one on a damper alone; nothing holds the rest."""
    m, k, c = 50.0, 2000.0, 120.0
    point = np.zeros(3)
    for stiffness in (k, 0.0):
        body = RigidBody("mass", m, np.eye(3), position=np.array([0.0, 0.0, 2.0]))
        spring = Spring(
            name="spring", body_a=GROUND, point_a=point, body_b="mass", point_b=point, length=2.0,
            stiffness=stiffness, damping=c,
        )  # fmt: skip
        found = of(Scene((body,), (spring,)))
        if stiffness:
            expected = -c / (2 * m) + 1j * np.sqrt(k / m - (c / (2 * m)) ** 2)
            assert found.zeros == 10
            assert found.eigenvalues[-1] == pytest.approx(expected, rel=1e-8)
            assert found.damping[-1] == pytest.approx(c / (2 * np.sqrt(k * m)), rel=1e-8)
        else:
            assert found.zeros == 11
            assert found.eigenvalues[-1] == pytest.approx(-c / m, rel=1e-8)
        assert np.all(found.eigenvalues[:-1] == 0.0)


@pytest.mark.parametrize("spin", [20.0, 5.0])
def test_sleeping_top(spin: float) -> None:
    """``A s2 - i C w s - m g l = 0`` of the tilt: stable if it spins fast."""
    m, l, A, C = 2.0, 0.3, 0.03, 0.02
    body = RigidBody(
        "top", m, np.diag([A, A, C]), position=np.array([0, 0, l]), angular_velocity=np.array([0, 0, spin])
    )
    scene = Scene((body,), (DOWN,), (), (joint(Ball, "tip", None, body, (0, 0, 0)),))
    found = of(scene)
    about = A + m * l * l
    roots = np.roots([about, -1j * C * spin, -m * G * l])
    roots = np.where(roots.imag < 0.0, roots.conj(), roots)
    assert found.states[:3] == (
        "top.x",
        "top.y",
        "top.rotation.1",
    )  # its own axes turn, those of the world do not
    tilt = found.eigenvalues[found.eigenvalues != 0.0]
    assert np.sort_complex(tilt) == pytest.approx(np.sort_complex(roots), rel=1e-6)
    assert found.unstable.size == (0 if (C * spin) ** 2 > 4.0 * about * m * G * l else 1)
    assert "moves" in found.warnings[0]


def test_free_symmetric_body_spins() -> None:
    """In its own axes the spin of a free body goes round at ``(C - A) w / A``."""
    A, C, spin = 3.0, 5.0, 2.0
    body = RigidBody("disc", 10.0, np.diag([A, A, C]), angular_velocity=np.array([0, 0, spin]))
    found = of(Scene((body,)))
    assert found.zeros == 8
    assert found.eigenvalues[4:] == pytest.approx([1j * (C - A) / A * spin, 1j * spin], rel=1e-8)


def test_a_run_goes_on_as_if_nothing_had_been_asked() -> None:
    """Bit for bit; and the state of a moving scene is said to move."""
    lugs, hooks = [(1, 0, 1.0), (-1, 0, 1.0)], [(1, 0, 8.0), (-1, 0, 8.0)]
    scene = slung(lugs, hooks, [0.4 * MASS * G, 0.6 * MASS * G])
    one, other = Simulation(scene, 0.01), Simulation(scene, 0.01)
    one.advance(50)
    other.advance(50)
    found = linearise(one)
    assert found.time == pytest.approx(0.5)
    assert "not in balance" in found.warnings[0]
    before, after = one.state(), other.state()
    assert before.keys() == after.keys()
    assert all(before[name].tobytes() == after[name].tobytes() for name in before if name != "cpu_seconds")
    assert one.advance(50)[1].tobytes() == other.advance(50)[1].tobytes()


def test_corner_of_a_rope_at_its_length() -> None:
    """A rope that has just no tension pulls on one side only."""
    scene = slung([(0, 0, 1.0)], [(0, 0, 8.0)], [1.0])
    held = Spring(
        name="held", body_a=GROUND, point_a=np.array([0, 0, -5.0]), body_b="load", point_b=np.zeros(3),
        length=5.0, stiffness=1e5,
    )  # fmt: skip
    ropes = (replace(scene.ropes[0], tension=None),)
    found = of(replace(scene, forces=(held,), ropes=ropes))
    assert any("forwards" in words and "'load.z'" in words for words in found.warnings)


def test_unknown_output() -> None:
    scene = slung([(0, 0, 1.0)], [(0, 0, 8.0)], [MASS * G])
    simulation = Simulation(scene, 0.01)
    with pytest.raises(InputError, match=r"no output 'load.positon'.*'load.position'"):
        linearise(simulation, outputs=["load.positon"])
    with pytest.raises(
        InputError, match=r"'s0.tension_max' is an extreme over a time; expected 's0.tension'"
    ):
        linearise(simulation, outputs=["s0.tension_max"])
    found = linearise(simulation, outputs=["s0.tension", "load.position.z"])
    assert found.output_units == ("N", "m")
    k = EA * (1.0 + MASS * G / EA) / 7.0
    assert found.C[0, found.states.index("load.z")] == pytest.approx(-k, rel=1e-8)
    assert found.C[1, found.states.index("load.z")] == pytest.approx(1.0, rel=1e-9)


def hoisted(*inputs: Any, damping: float = 0.0) -> Scene:
    """A load on a vertical rope of 10 m with inputs."""
    scene = slung([(0, 0, 0.0)], [(0, 0, 10.0)], [MASS * G])
    winched = replace(scene.ropes[0], winch=Winch(times=np.zeros(1), speeds=np.zeros(1)), damping=damping)
    return replace(scene, ropes=(winched,), inputs=inputs)


def test_transfer_from_a_force() -> None:
    """A mass on a spring with a damper: ``1 / (k - m w2 + i c w)``; its acceleration is no output, its reaction is."""
    m, k, c = 50.0, 2000.0, 120.0
    point = np.zeros(3)
    body = RigidBody("mass", m, np.eye(3), position=np.array([0.0, 0.0, 2.0]))
    spring = Spring(
        name="spring", body_a=GROUND, point_a=point, body_b="mass", point_b=point, length=2.0,
        stiffness=k, damping=c,
    )  # fmt: skip
    push = ForceInput(name="push", body="mass", point=point, direction=np.array([0.0, 0.0, 1.0]))
    simulation = Simulation(Scene((body,), (spring,), inputs=(push,)), 0.01)
    found = linearise(simulation, outputs=["mass.position.z", "spring.force"])
    assert (found.inputs, found.input_units, found.output_units) == (("push",), ("N",), ("m", "N"))
    omega = np.array([0.5, 6.0, 40.0])
    expected = 1.0 / (k - m * omega**2 + 1j * c * omega)
    assert found.transfer(omega)[:, 0, 0] == pytest.approx(expected, rel=1e-7)
    assert np.abs(found.transfer(omega)[:, 1, 0]) == pytest.approx(
        np.abs((k + 1j * c * omega) * expected), rel=1e-7
    )
    assert found.transfer(6.0).shape == (2, 1)
    for omega in (0.0, np.nan):  # nothing holds the mass across the spring
        with pytest.raises(InputError, match="no answer at"):
            found.transfer(omega)


def test_speed_and_length_of_a_winch() -> None:
    """``m z'' = -(EA s/l2) (z + hauled) - c (z' + speed)``; a length does the opposite of what is hauled in."""
    c, rest = 2e4, 10.0 / (1.0 + MASS * G / EA)
    stiffness = EA / rest
    by_length = EA * 10.0 / rest**2
    for one in (WinchSpeedInput(name="winch", rope="s0"), WinchLengthInput(name="winch", rope="s0")):
        found = of(hoisted(one, damping=c))
        speed = found.states.index("load.velocity.z")
        assert found.A[speed, found.states.index("load.z")] == pytest.approx(-stiffness / MASS, rel=1e-7)
        if isinstance(one, WinchSpeedInput):
            place = found.states.index("winch.place")
            assert found.inputs == ("winch", "winch.rate")
            assert found.input_units == ("m/s", "m/s2")
            assert found.A[speed, place] == pytest.approx(by_length / MASS, rel=1e-7)
            assert found.B[speed] == pytest.approx([c / MASS, 0.0], rel=1e-6, abs=1e-6)
            assert found.B[place] == pytest.approx([1.0, 0.0], abs=0.0)
        else:
            assert found.input_units == ("m", "m/s")
            assert found.B[speed] == pytest.approx([-by_length / MASS, -c / MASS], rel=1e-6)
        assert found.zeros == 6  # it holds at the centre, about which it may turn


def test_step_response_of_a_driven_trolley() -> None:
    """A load on a rope below a frame whose speed is an input: the matrices against the run itself."""
    trolley = RigidBody("trolley", 500.0, np.eye(3), position=np.array([0, 0, 12.0]), motion=Fixed())
    load = RigidBody("load", MASS, np.diag(INERTIA))
    hoist = rope("hoist", (0, 0, 0), "load", (0, 0, 1.0), MASS * G, above="trolley")
    travel = FrameSpeedInput(name="travel", body="trolley", axis="x")
    push = ForceInput(name="push", body="load", point=np.zeros(3), direction=np.array([0.0, 1.0, 0.0]))
    scene = Scene((trolley, load), (DOWN,), (), (), (hoist,), inputs=(travel, push))
    simulation = Simulation(scene, 2e-3)
    names = ["load.position.x", "load.position.y", "load.velocity.x", "hoist.tension"]
    found = linearise(simulation, outputs=names)
    u = np.zeros(len(found.inputs))
    u[found.inputs.index("travel")], u[found.inputs.index("push")] = 1e-4, 0.5
    simulation.set_inputs([("travel", 1e-4, 0.0, np.inf), ("push", 0.5, 0.0, np.inf)])
    n = len(found.states)
    held = expm(3.0 * np.block([[found.A, (found.B @ u)[:, None]], [np.zeros((1, n + 1))]]))
    expected = found.C @ held[:n, n] + found.D @ u
    before = simulation.record()
    after = simulation.advance(1500)[1][-1]
    columns = {f"{c.name}.{k}": c.column + i for c in simulation.channels for i, k in enumerate(c.components)}
    columns |= {c.name: c.column for c in simulation.channels if len(c.components) == 1}
    moved = np.array([(after - before)[columns[name]] for name in names])
    assert moved[:3] == pytest.approx(expected[:3], rel=2e-5)
    assert abs(expected[3]) < 1e-6 * MASS * G


def test_inputs_without_columns() -> None:
    """Places of drives are refused by name, and left out with a word where all inputs are taken."""
    trolley = RigidBody("trolley", 500.0, np.eye(3), position=np.array([0, 0, 12.0]), motion=Fixed())
    load = RigidBody("load", MASS, np.diag(INERTIA))
    hoist = rope("hoist", (0, 0, 0), "load", (0, 0, 1.0), MASS * G, above="trolley")
    place = FramePositionInput(name="place", body="trolley", axis="x")
    simulation = Simulation(Scene((trolley, load), (DOWN,), (), (), (hoist,), inputs=(place,)), 0.01)
    with pytest.raises(InputError, match="'place' is a place of a drive"):
        linearise(simulation, inputs=["place"])
    with pytest.raises(InputError, match=r"'plaec' is no input.*place"):
        linearise(simulation, inputs=["plaec"])
    found = linearise(simulation)
    assert found.inputs == ()
    assert any("'place'" in words for words in found.warnings)


def test_joints_that_leave_no_motion() -> None:
    body = RigidBody("block", 1.0, np.eye(3))
    scene = Scene((body,), (DOWN,), (), (joint(FixedJoint, "weld", None, body, (0, 0, 0)),))
    with pytest.raises(InputError, match="the joints leave no motion"):
        of(scene)


@pytest.mark.parametrize("integrator", ["dele2", "accurate"])
def test_a_swinging_rod_at_a_time_of_its_run(integrator: str) -> None:
    """``x = sin t / 2, t'' = -3 g/2 sin t`` in the x of the centre of a rod of 1 m; the run keeps its bits."""
    scene = linkage([(0, 0, 0), (1, 0, 0)], closed=False)
    simulation, other = (Simulation(scene, 0.01, integrator) for _ in range(2))
    simulation.advance(40)
    other.advance(40)
    columns = {channel.name: channel.column for channel in simulation.channels}
    row = simulation.record()
    other.record()
    found = linearise(simulation)
    assert found.states == ("r0.x", "r0.velocity.x")
    assert "not in balance" in found.warnings[0]

    def acceleration(x: complex, speed: complex) -> complex:
        turn = np.arcsin(2.0 * x)
        rate = 2.0 * speed / np.cos(turn)
        return -0.75 * G * np.sin(turn) * np.cos(turn) - 0.5 * np.sin(turn) * rate**2

    x, speed = row[columns["r0.position"]], row[columns["r0.velocity"]]
    assert x > 0.1
    tiny = 1e-20
    expected = [
        acceleration(x + 1j * tiny, speed).imag / tiny,
        acceleration(x, speed + 1j * tiny).imag / tiny,
    ]
    assert found.A[1] == pytest.approx(expected, rel=1e-5)
    assert found.A[0] == pytest.approx([0.0, 1.0], abs=1e-9)
    assert simulation.advance(20)[1].tobytes() == other.advance(20)[1].tobytes()


def test_what_has_no_linear_motion_is_refused() -> None:
    """All reasons at once, by name."""
    scene = linkage([(0, 0, 0), (0, -1, 0)], closed=False)
    rubbing = replace(scene.joints[0], friction=2.0)
    places = (RopePoint("r0", np.zeros(3)), RopePoint(GROUND, np.array([2.0, 0.0, 0.0])))
    strap = MaxwellRope(name="strap", path=places, stiffness=1e6, viscosity=1e7)
    over = (places[0], RopePoint(GROUND, np.array([1.0, 0.0, 0.0]), efficiency=0.97), places[1])
    fall = Rope(name="fall", path=over, axial_stiffness=1e6)
    bad = replace(scene, joints=(rubbing,), ropes=(strap, fall))
    with pytest.raises(InputError) as caught:
        of(bad)
    for words in ("'strap' creeps", "'fall' sticks and slides on its sheaves", "'h0' has dry friction"):
        assert words in caught.value.problem


def test_outputs_after_steps_are_those_of_the_start() -> None:
    """What springs, ropes and joints carry from step to step hides no rate and no elongation."""
    rod_below = linkage([(0, 0, 0), (0, -1, 0)], closed=False)
    spring = Spring(
        name="spring", body_a=GROUND, point_a=np.array([2.0, -0.5, 0.0]), body_b="r0", point_b=np.zeros(3),
        length=2.0, stiffness=300.0, damping=20.0,
    )  # fmt: skip
    names = ["spring.force", "h0.reaction_force", "h0.angle"]
    for integrator in ("dele2", "accurate"):
        simulation = Simulation(replace(rod_below, forces=(*rod_below.forces, spring)), 0.01, integrator)
        before = linearise(simulation, outputs=names)
        x, v = (before.states.index(name) for name in ("r0.x", "r0.velocity.x"))
        # the spring pushes the rod at its centre: m L2/3 t'' = -m g L/2 t - (k x + c x') L/2
        restoring = np.array([1.5 * G + 0.75 * 300.0, 0.75 * 20.0])
        assert -before.A[1, [x, v]] == pytest.approx(restoring, rel=1e-7)
        assert np.abs(before.C[0, [x, v]]) == pytest.approx([300.0, 20.0], rel=1e-7)
        expected = -restoring + [300.0, 20.0]  # m x'' = R - k x - c x'
        assert np.abs(before.C[1, [x, v]]) == pytest.approx(np.abs(expected), rel=1e-6)
        assert np.abs(before.C[4, [x, v]]) == pytest.approx([2.0, 0.0], rel=1e-6, abs=1e-9)
        simulation.advance(20)
        after = linearise(simulation, outputs=names)
        np.testing.assert_allclose(after.C, before.C, rtol=1e-6, atol=1e-5)


def test_tension_of_a_damped_rope_after_steps() -> None:
    """``EA/l z + c z'``."""
    simulation = Simulation(hoisted(damping=2e4), 0.01)
    simulation.advance(20)
    found = linearise(simulation, outputs=["s0.tension"])
    place, speed = (found.states.index(name) for name in ("load.z", "load.velocity.z"))
    k = EA * (1.0 + MASS * G / EA) / 10.0
    assert found.C[0, [place, speed]] == pytest.approx([-k, -2e4], rel=1e-6)


def test_inputs_are_left_as_they_are() -> None:
    """Tables of drives, winches and loads, in the middle of what they do: the run goes on with the same bits."""
    trolley = RigidBody("trolley", 500.0, np.eye(3), position=np.array([0, 0, 12.0]), motion=Fixed())
    load = RigidBody("load", MASS, np.diag(INERTIA))
    arm = RigidBody("arm", 100.0, 50.0 * np.eye(3), position=np.array([5.0, 0, 12.0]))
    winch = Winch(times=np.zeros(1), speeds=np.zeros(1))
    hoist = replace(rope("hoist", (0, 0, 0), "load", (0, 0, 1.0), MASS * G, above="trolley"), winch=winch)
    still = Profile(times=np.zeros(1), speeds=np.zeros(1))
    pin = replace(joint(Hinge, "pin", None, arm, (5.0, 0, 12.0)), drive=still)
    inputs = (
        FrameSpeedInput(name="travel", body="trolley", axis="x"),
        WinchSpeedInput(name="haul", rope="hoist"),
        DriveSpeedInput(name="turn", joint="pin"),
        ForceInput(name="push", body="load", point=np.zeros(3), direction=np.array([0.0, 1.0, 0.0])),
    )
    scene = Scene((trolley, load, arm), (DOWN,), (), (pin,), (hoist,), inputs=inputs)
    one, other = Simulation(scene, 0.01), Simulation(scene, 0.01)
    for simulation in (one, other):
        simulation.set_inputs(
            [
                ("travel", 0.1, 0.2, 0.5),
                ("haul", 0.05, 0.0, np.inf),
                ("turn", 0.3, -0.1, 2.0),
                ("push", 9.0, 1.0, 3.0),
            ]
        )
        simulation.advance(30)
    found = linearise(one)
    assert found.inputs == ("travel", "travel.rate", "haul", "haul.rate", "turn", "turn.rate", "push")
    assert one.advance(60)[1].tobytes() == other.advance(60)[1].tobytes()
    before, after = one.state(), other.state()
    assert all(before[name].tobytes() == after[name].tobytes() for name in before if name != "cpu_seconds")


def test_rate_of_a_drive_with_joints() -> None:
    """A rod of 1 m hinged to a driven cart: ``x'' = p''/4 - 3 g/2 (x - p)`` of its centre."""
    cart = RigidBody("cart", 3.0, np.eye(3))
    beam = rod("rod", (0, 0, 0), (0, -1, 0))
    rail = replace(
        joint(Slider, "rail", None, cart, (0, 0, 0), (1, 0, 0)),
        drive=Profile(times=np.zeros(1), speeds=np.zeros(1)),
    )
    pin = joint(Hinge, "pin", cart, beam, (0, 0, 0))
    down = Gravity(np.array([0.0, -G, 0.0]))
    drive = DriveSpeedInput(name="drive", joint="rail")
    found = of(Scene((cart, beam), (down,), (), (rail, pin), inputs=(drive,)))
    place = found.states.index("drive.place")
    assert found.states[0] == "rod.x"
    expected = [-1.5 * G, 1.5 * G, 0.25]
    assert [found.A[1, 0], found.A[1, place], found.B[1, 1]] == pytest.approx(expected, rel=1e-6)
    assert found.B[1, 0] == pytest.approx(0.0, abs=1e-6)
    assert found.B[place] == pytest.approx([1.0, 0.0], abs=0.0)


@pytest.mark.parametrize("integrator", ["dele2", "accurate"])
def test_a_body_that_nothing_holds_has_six_free_motions(integrator: str) -> None:
    """Without rows the systems of the accurate integrator are its own state alone."""
    body = RigidBody("body", mass=MASS, inertia=np.diag(INERTIA))
    found = of(Scene((body,)), integrator=integrator)
    assert np.abs(found.eigenvalues).max() < 1e-6
    assert found.A.shape == (12, 12)
