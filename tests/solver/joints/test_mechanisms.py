"""One small mechanism for each type of joint, with its motion and reaction in closed form.

All of them stand side by side in one scene, so that one compilation serves them; each is computed at three
steps, and what it records must come nearer to the closed form with the square of the step.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.distance import Distance
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.planar import Planar
from heavylift.solver.joints.slider import Slider
from heavylift.solver.joints.slider_hinge import Cylindrical, SliderHinge
from heavylift.solver.joints.universal import Universal
from heavylift.solver.scene.connections import GROUND, Joint, JointFrame, axes_about
from heavylift.solver.scene.scene import Gravity, Profile, RigidBody, Scene
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from collections.abc import Callable

pytestmark = pytest.mark.slow

g = 9.81
X, Y, Z = np.eye(3)
DURATION = 0.8
STEPS = (50, 100, 200)
RAMP = Profile(np.array([0.0, 1.0]), np.array([0.0, 1.5]))
SLOPE = np.radians(30.0)
DOWNHILL = np.array([np.cos(SLOPE), 0.0, -np.sin(SLOPE)])
NORMAL = np.array([np.sin(SLOPE), 0.0, np.cos(SLOPE)])

M, I = 3.0, 0.2  # mass and spherical inertia of all bodies
LEG = 0.9  # of the pendulums: distance of the centre from the anchor [m]
START = 1.1  # and their angle from the vertical at the start [rad]
SHORT = 0.35  # leg below the trolley [m]
TILT, BEND = 0.5, np.radians(40.0)
SPIN = 10.0  # of the body on the cylindrical joint [rad/s]
OUT, DOWN = 0.4, 0.3  # of its centre from the anchor


def ramp(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Value, rate and acceleration of `RAMP`, the cubic from rest to rest."""
    return 1.5 * (3 * t**2 - 2 * t**3), 1.5 * (6 * t - 6 * t**2), 1.5 * (6 - 12 * t)


def frame(point: np.ndarray, axis: np.ndarray = Z, reference: np.ndarray | None = None) -> JointFrame:
    return JointFrame(np.asarray(point, dtype=np.float64), axes_about(axis, reference))


def body(name: str, position: np.ndarray, **motion: np.ndarray) -> RigidBody:
    return RigidBody(name, M, I * np.eye(3), position=np.asarray(position, dtype=np.float64), **motion)


def mechanisms() -> Scene:
    """All of them; the bodies start with world axes, so joint frames differ by a shift only."""
    bodies: list[RigidBody] = []
    joints: list[Joint] = []

    def add(kind: Callable[..., Joint], name: str, thing: RigidBody, at: np.ndarray, **k: Any) -> None:
        on = k.pop("on", GROUND)
        axis, reference = k.pop("axis", Z), k.pop("reference", None)
        holder = next((b.position for b in bodies if b.name == on), np.zeros(3))
        if thing not in bodies:
            bodies.append(thing)
        a = frame(at - holder, axis, reference)
        b = frame(k.pop("end", at) - thing.position, k.pop("axis_b", axis), reference)
        joints.append(kind(name=name, body_a=on, body_b=thing.name, frame_a=a, frame_b=b, **k))

    turning = np.sqrt(g / (LEG * np.cos(TILT))) * Z
    centre = LEG * np.array([np.sin(TILT), 0.0, -np.cos(TILT)])
    add(
        Ball,
        "conical",
        body("cone", centre, velocity=np.cross(turning, centre), angular_velocity=turning),
        np.zeros(3),
    )
    hanging = LEG * np.array([np.sin(START), 0.0, -np.cos(START)])
    add(Distance, "rod", body("bob", hanging), np.zeros(3), end=hanging, length=LEG)
    add(Hinge, "pin", body("plate", hanging + 0.2 * Y), np.zeros(3), axis=-Y, reference=-Z)
    slide = {"reference": -Z, "slide_axis": Y}  # y of the joint frame: along x of the world
    add(SliderHinge, "trolley", body("load", hanging * SHORT / LEG), np.zeros(3), axis=-Y, **slide)
    add(
        Cylindrical,
        "mast",
        body("ring", OUT * X - DOWN * Z, velocity=SPIN * OUT * Y, angular_velocity=SPIN * Z),
        np.zeros(3),
        reference=X,
    )
    add(Slider, "rail", body("sledge", 0.3 * NORMAL + 0.1 * Y), np.zeros(3), axis=DOWNHILL)
    add(
        Planar,
        "plane",
        body("puck", OUT * Y + DOWN * NORMAL, angular_velocity=SPIN * NORMAL),
        np.zeros(3),
        axis=NORMAL,
    )
    add(Slider, "hoist", body("weight", X), X, drive=RAMP)
    add(Hinge, "slew", body("crane", np.zeros(3)), np.zeros(3), reference=X, drive=RAMP)
    add(FixedJoint, "weld", body("tip", np.array([1.2, 0.3, 0.0])), np.array([1.0, 0.0, 0.0]), on="crane")
    out = np.array([np.cos(BEND), 0.0, np.sin(BEND)])
    add(Hinge, "input", body("shaft", -0.5 * X), np.zeros(3), axis=X, reference=Y, drive=RAMP)
    # the fork of the input shaft starts along y, that of the output shaft square to it and to its own axis
    add(
        Universal,
        "cross",
        body("output", 0.5 * out),
        np.zeros(3),
        on="shaft",
        axis=Y,
        axis_b=np.cross(out, Y),
    )
    add(Cylindrical, "bearing", bodies[-1], 0.5 * out, axis=out, reference=Y)
    return Scene(tuple(bodies), (Gravity(-g * Z),), joints=tuple(joints))


def wrench(a: np.ndarray, alpha: np.ndarray, arm: np.ndarray) -> dict[str, np.ndarray]:
    """Reaction of the only joint of a body, from its accelerations and the arm from the anchor to its centre."""
    force = M * (a + g * Z)
    return {"reaction_force": force, "reaction_moment": I * alpha + np.cross(arm, force)}


def swing(
    t: np.ndarray, inertia: Callable[[float], float], slope: Callable[[float], float], leg: float = LEG
) -> np.ndarray:
    """Angle, rate, acceleration of ``inertia(q) q'' + 1/2 slope(q) q'^2 = -M g l sin q``, shape (3, time)."""

    def acceleration(q: float, v: float) -> float:
        return (-M * g * leg * np.sin(q) - 0.5 * slope(q) * v * v) / inertia(q)

    found = solve_ivp(
        lambda _, y: [y[1], acceleration(*y)], (0.0, t[-1]), [START, 0.0], "DOP853", t, rtol=1e-12, atol=1e-12
    )
    return np.array([*found.y, [acceleration(*y) for y in found.y.T]])


def circle(q: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Unit vectors that turn from the first to the second direction, shape (time, 3)."""
    return np.outer(np.cos(q), first) + np.outer(np.sin(q), second)


def on_circle(q: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Accelerations of `circle` from angle, rate and acceleration."""
    return q[2][:, None] * circle(q[0], second, -first) - (q[1] ** 2)[:, None] * circle(q[0], first, second)


def closed_forms(t: np.ndarray) -> dict[str, np.ndarray]:
    """What is recorded, by channel."""
    out: dict[str, np.ndarray] = {}

    def put(name: str, **channels: np.ndarray) -> None:
        out.update({f"{name}.{key}": np.reshape(value, (len(t), -1)) for key, value in channels.items()})

    none, ones = np.zeros((len(t), 3)), np.ones((len(t), 1))
    turning = np.sqrt(g / (LEG * np.cos(TILT)))
    put("conical", **wrench(-(turning**2) * LEG * np.sin(TILT) * circle(turning * t, X, Y), none, none))
    out["conical.reaction_moment"] = none

    q = swing(t, lambda _: M * LEG**2, lambda _: 0.0)
    put("rod", reaction_force=M * (LEG * on_circle(q, -Z, X) + g * Z), reaction_moment=none)
    q = swing(t, lambda _: I + M * LEG**2, lambda _: 0.0)
    arm = LEG * circle(q[0], -Z, X) + 0.2 * Y
    put("pin", angle=q[0] - START, angular_rate=q[1])
    put("pin", **wrench(LEG * on_circle(q, -Z, X), np.outer(q[2], -Y), arm))
    q = swing(t, lambda q: I + M * (SHORT * np.sin(q)) ** 2, lambda q: M * SHORT**2 * np.sin(2 * q), SHORT)
    lift = SHORT * (np.sin(q[0]) * q[2] + np.cos(q[0]) * q[1] ** 2)
    put("trolley", angle=q[0] - START, angular_rate=q[1])
    put("trolley", travel=SHORT * (np.sin(START) - np.sin(q[0])), travel_rate=-SHORT * np.cos(q[0]) * q[1])
    put("trolley", reaction_force=np.outer(M * (g + lift), Z), reaction_moment=none)

    e = circle(SPIN * t, X, Y)
    put("mast", angle=SPIN * t, angular_rate=SPIN * ones, travel=-0.5 * g * t**2, travel_rate=-g * t)
    put("mast", **wrench(-(SPIN**2) * OUT * e - g * Z, none, OUT * e - DOWN * Z))
    sliding = g * np.sin(SLOPE) * DOWNHILL * ones
    put("rail", travel=0.5 * g * np.sin(SLOPE) * t**2, travel_rate=g * np.sin(SLOPE) * t)
    put("rail", **wrench(sliding, none, (0.3 * NORMAL + 0.1 * Y) * ones))
    put("plane", **wrench(sliding, none, OUT * circle(SPIN * t, Y, np.cross(NORMAL, Y)) + DOWN * NORMAL))

    phi = np.array(ramp(t))
    put("hoist", travel=phi[0], travel_rate=phi[1], **wrench(np.outer(phi[2], Z), none, none))
    work = M * g * phi[0] + 0.5 * M * phi[1] ** 2
    centre, arm = np.array([1.2, 0.3, 0.0]), np.array([0.2, 0.3, 0.0])
    outwards, sideways = np.array([centre, arm]), np.array([np.cross(Z, centre), np.cross(Z, arm)])
    weld = wrench(
        on_circle(phi, outwards[0], sideways[0]),
        np.outer(phi[2], Z),
        circle(phi[0], outwards[1], sideways[1]),
    )
    put("weld", **weld)
    lever = np.cross(circle(phi[0], outwards[0], sideways[0]), weld["reaction_force"])
    put("slew", angle=phi[0], angular_rate=phi[1], reaction_force=weld["reaction_force"] + M * g * Z)
    put("slew", reaction_moment=2.0 * I * np.outer(phi[2], Z) + lever)
    work += 0.5 * (2.0 * I + M * centre @ centre) * phi[1] ** 2

    # Hooke's joint: tan(output) = tan(input) cos(bend)
    size = np.cos(phi[0]) ** 2 + (np.sin(phi[0]) * np.cos(BEND)) ** 2
    ratio = np.cos(BEND) / size
    bent = np.arctan2(np.sin(phi[0]) * np.cos(BEND), np.cos(phi[0]))
    slope = np.cos(BEND) * np.sin(2 * phi[0]) * np.sin(BEND) ** 2 / size**2
    rate, acceleration = ratio * phi[1], ratio * phi[2] + slope * phi[1] ** 2
    put("bearing", angle=bent, angular_rate=rate, travel=0.0 * t, travel_rate=0.0 * t)
    put("cross", torque=I * acceleration)
    put("input", torque=I * phi[2] + I * acceleration * ratio)
    put("energy", drive_work=work + 0.5 * I * (phi[1] ** 2 + rate**2))
    return out


AXES = {"cross.torque": np.array([np.cos(BEND), 0.0, np.sin(BEND)]), "input.torque": X}
"""Directions along which a reaction moment is told by the motion alone: Hooke's joint holds more than it needs."""

NAMES = tuple(closed_forms(np.array([0.1, 0.2])))


def recorded(simulation: Simulation, records: np.ndarray) -> dict[str, np.ndarray]:
    """What `closed_forms` names, each of shape (time, components)."""
    columns = {c.name: slice(c.column, c.column + len(c.components)) for c in simulation.channels}
    out = {}
    for name in NAMES:
        if name in AXES:
            moment = columns[name.replace("torque", "reaction_moment")]
            out[name] = (records[:, moment] @ AXES[name])[:, None]
        else:
            out[name] = records[:, columns[name]]
    return out


@pytest.fixture(scope="module")
def errors() -> dict[str, list[float]]:
    """Largest error after the first quarter by channel, for each number of steps."""
    found: dict[str, list[float]] = {}
    scene = mechanisms()
    for count in STEPS:
        simulation = Simulation(scene, DURATION / count)
        simulation.record()
        t, records = simulation.advance(count)
        assert simulation.message == ""
        expected = closed_forms(t)
        for name, values in recorded(simulation, records).items():
            off = np.abs(values - expected[name])[count // 4 :].max()
            found.setdefault(name, []).append(float(off / max(1.0, np.abs(expected[name]).max())))
    return found


@pytest.mark.parametrize("name", NAMES)
def test_motion_and_reaction_converge_to_the_closed_form(errors: dict[str, list[float]], name: str) -> None:
    """Of second order, or exact."""
    coarse, _, fine = errors[name]
    assert fine < 3e-3
    assert fine < 1e-9 or np.log2(coarse / fine) / 2 > 1.8


def test_continued_run_counts_turns_and_work_like_one_without_a_break() -> None:
    """Whole turns and the work of drives are carried; bit for bit."""
    straight = Simulation(mechanisms(), DURATION / 50)
    first = Simulation(mechanisms(), DURATION / 50)
    straight.record()
    first.record()
    _, expected = straight.advance(50)
    first.advance(45)
    second = Simulation(mechanisms(), DURATION / 50)
    second.restore(first.state())
    _, rest = second.advance(5)
    turns = next(c.column for c in second.channels if c.name == "mast.angle")
    assert rest[-1, turns] > 2.0 * np.pi
    np.testing.assert_array_equal(rest, expected[45:])


def test_whole_turns_are_counted_between_rare_records() -> None:
    """More than a turn from one record to the next."""
    rare = Simulation(mechanisms(), DURATION / 50, record_every=50)
    rare.record()
    _, records = rare.advance(50)
    column = next(c.column for c in rare.channels if c.name == "mast.angle")
    assert records[-1, column] == pytest.approx(SPIN * DURATION, rel=1e-2)


def test_accurate_integrator_agrees_to_many_digits() -> None:
    """Closed quadratic velocity terms and prescribed accelerations: nothing else of the joints is in these numbers."""
    simulation = Simulation(mechanisms(), DURATION / 40, "accurate", tolerance=1e-9)
    simulation.record()
    t, records = simulation.advance(40)
    assert simulation.message == ""
    for name, values in recorded(simulation, records).items():
        expected = closed_forms(t)[name]
        np.testing.assert_allclose(
            values, expected, atol=1e-6 * max(1.0, np.abs(expected).max()), err_msg=name
        )
