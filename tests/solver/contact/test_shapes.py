"""Rings, convex primitives, balls and points on surfaces in whole scenes, against closed forms and integrations."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from contact_scenes import DOWN, G, Run, run
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from heavylift.contours.splines.neutral import neutral_surface
from heavylift.solver.scene.contacts import (
    BoxShape,
    CapsuleShape,
    CircleShape,
    Contact,
    Contour,
    CylinderShape,
    EllipsoidShape,
    LinearLaw,
    PointShape,
    RigidLaw,
    SphereShape,
)
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

Array = NDArray[np.float64]


def floor(
    height: Any = lambda x, y: 0.0 * x * y, half: float = 1.0, count: int = 7, degree: int = 3
) -> Contour:
    """Ground ``z = height(x, y)`` over a square; polynomials up to the degree are exact."""
    x, y = np.meshgrid(np.linspace(-half, half, count), np.linspace(-half, half, count), indexing="ij")
    points = np.stack([x, y, height(x, y)], axis=2)
    neutral = neutral_surface(points, degrees=(degree, degree), parametrisation="uniform")
    return Contour(name="floor", body="ground", neutral=neutral)


def turned(angle: float, axis: int) -> Array:
    """Quaternion of a turn about a coordinate axis."""
    q = np.zeros(4)
    q[0], q[1 + axis] = math.cos(0.5 * angle), math.sin(0.5 * angle)
    return q


def simulate(contour: Contour, body: RigidBody, step: float, time: float, **contact: Any) -> Run:
    """A body with one contact, under its weight."""
    touch = Contact(name="touch", contour="floor", body="body", **contact)
    scene = Scene(bodies=(body,), forces=(Gravity(DOWN),), contours=(contour,), contacts=(touch,))
    return run(scene, step, time)


SHAPES = {
    "capsule": (CapsuleShape(radius=0.05, length=0.6, axis=np.eye(3)[0]), 0.05),
    "box": (BoxShape(size=np.array([0.62, 0.42, 0.1]), rounding=0.01), 0.05),
    "cylinder": (
        CylinderShape(radius=0.31, length=0.1, rounding=0.01, axis=np.eye(3)[2]),
        0.05,
    ),
}
"""With the height of their centres over flat ground."""

DOME = 0.4
"""Radius of curvature at the top of the dome [m]: above the height of the centres, so they rest on it."""


def dome() -> Contour:
    return floor(lambda x, y: -(x * x + y * y) / (2.0 * DOME))


@pytest.mark.parametrize("name", SHAPES)
def test_dropped_primitive_rests_with_its_weight_on_a_dome(name: str) -> None:
    """All of the energy of the fall is lost by the impact, and the force then is the weight."""
    shape, height = SHAPES[name]
    drop = 0.05
    body = RigidBody(
        name="body", mass=2.0, inertia=np.diag([0.02, 0.05, 0.06]), position=np.array([0, 0, height + drop])
    )
    found = simulate(dome(), body, 0.01, 0.5, shape=shape, law=RigidLaw(0.0), friction=0.5)
    np.testing.assert_allclose(found["body.position"][:, 2][-20:], height, atol=1e-9)
    np.testing.assert_allclose(found["touch.normal_force"][-20:], 2.0 * G, rtol=1e-6)
    assert found["touch.dissipated"][-1] == pytest.approx(2.0 * G * drop, rel=1e-6)
    assert found["touch.impacts"][-1] == 1.0
    assert found.drift < 1e-7


def rocking(mass: float, inertia: float, h: float, tilt: float, times: Array) -> Array:
    """Horizontal position of the centre of a board that rolls over ``z = -x^2/(2 R)`` without sliding.

    With the tangent angle theta, the way s along the parabola from its top to the point of touch, and ``c = P + h n - s
    t`` of the centre, ``dc = -(h t + s n) dtheta``.
    """

    def way(angle: float) -> float:
        return -0.5 * DOME * (math.tan(angle) / math.cos(angle) + math.asinh(math.tan(angle)))

    def rates(_: float, y: Array) -> list[float]:
        angle, rate = y
        s = way(angle)
        slope = -DOME / math.cos(angle) ** 3
        pull = -mass * G * (h * math.sin(angle) + s * math.cos(angle))
        return [rate, -(mass * s * slope * rate**2 + pull) / (inertia + mass * (h * h + s * s))]

    angle = solve_ivp(
        rates, (0.0, times[-1]), [tilt, 0.0], method="DOP853", rtol=1e-11, atol=1e-12, t_eval=times
    ).y[0]
    return np.array([-DOME * math.tan(a) - h * math.sin(a) - way(a) * math.cos(a) for a in angle])


@pytest.mark.parametrize("name", ["capsule", "box"])
def test_board_rocks_on_a_dome_as_a_rolling_board(name: str) -> None:
    shape, h = SHAPES[name]
    tilt, mass, inertia = 0.2, 2.0, 0.05
    way = -0.5 * DOME * (math.tan(tilt) / math.cos(tilt) + math.asinh(math.tan(tilt)))
    x = -DOME * math.tan(tilt)
    centre = np.array([x, 0.0, -x * x / (2.0 * DOME)])
    centre += h * np.array([-math.sin(tilt), 0.0, math.cos(tilt)])
    centre -= way * np.array([math.cos(tilt), 0.0, math.sin(tilt)])
    body = RigidBody(
        name="body",
        mass=mass,
        inertia=np.diag([0.02, inertia, 0.06]),
        position=centre,
        orientation=turned(-tilt, 1),
    )
    errors = []
    for step in (0.004, 0.002):
        found = simulate(dome(), body, step, 1.2, shape=shape, law=RigidLaw(0.0), friction=2.0)
        wanted = rocking(mass, inertia, h, tilt, found.times)
        errors.append(np.abs(found["body.position"][:, 0] - wanted).max())
        assert np.abs(found["body.position"][:, 1]).max() < 1e-6
    assert np.ptp(wanted) > 0.02
    assert errors[1] < 2e-3 * np.ptp(wanted)
    assert errors[0] / errors[1] > 3.0


@pytest.mark.parametrize("rate", [0.0, 9.0], ids=["rocks", "rolls over"])
def test_ellipsoid_rolls_as_by_lagrange(rate: float) -> None:
    """One angle: height of the centre H, ``T = (I + m (H^2 + H'^2)) phi'^2 / 2``, ``x' = H phi'``."""
    a, c, mass, inertia, start = 0.3, 0.2, 2.0, 0.2 * 2.0 * (0.3**2 + 0.2**2), 0.5

    def height(phi: float) -> tuple[float, float, float]:
        H = math.sqrt(a * a * math.sin(phi) ** 2 + c * c * math.cos(phi) ** 2)
        first = (a * a - c * c) * math.sin(phi) * math.cos(phi) / H
        return H, first, ((a * a - c * c) * math.cos(2.0 * phi) - first * first) / H

    def rates(_: float, y: Array) -> list[float]:
        H, first, second = height(y[0])
        inert = inertia + mass * (H * H + first * first)
        return [
            y[1],
            -(mass * first * (H + second) * y[1] ** 2 + mass * G * first) / inert,
            H * y[1],
        ]

    H, first, _ = height(start)
    body = RigidBody(
        name="body",
        mass=mass,
        inertia=np.diag([0.1, inertia, 0.1]),
        position=np.array([-1.0, 0.0, H]),
        orientation=turned(start, 1),
        velocity=np.array([H * rate, 0.0, first * rate]),
        angular_velocity=np.array([0.0, rate, 0.0]),
    )
    shape = EllipsoidShape(half_axes=np.array([a, 0.25, c]))
    errors = []
    for step in (0.002, 0.001):
        found = simulate(floor(half=2.0), body, step, 0.8, shape=shape, law=RigidLaw(0.0), friction=2.0)
        motion = solve_ivp(
            rates,
            (0.0, 0.8),
            [start, rate, -1.0],
            method="DOP853",
            rtol=1e-11,
            atol=1e-12,
            t_eval=found.times,
        ).y
        errors.append(np.abs(found["body.position"][:, 0] - motion[2]).max())
        np.testing.assert_allclose(
            found["body.position"][:, 2], [height(phi)[0] for phi in motion[0]], atol=20.0 * step
        )
    assert errors[1] < 2e-3 * np.ptp(motion[2])
    assert errors[0] / errors[1] > 2.5


def test_hoop_rolls_down_a_slope_upright() -> None:
    """``a = g sin(slope) / 2`` of a thin hoop that does not slide."""
    slope, radius, mass = math.radians(15.0), 0.2, 1.5
    ground = floor(lambda x, y: -math.tan(slope) * x + 0.0 * y)
    down = np.array([math.cos(slope), 0.0, -math.sin(slope)])
    up = np.array([math.sin(slope), 0.0, math.cos(slope)])
    body = RigidBody(
        name="body",
        mass=mass,
        inertia=mass * radius**2 * np.diag([0.5, 1.0, 0.5]),
        position=-0.6 * down + radius * up,
    )
    shape = CircleShape(radius=radius, axis=np.array([0.0, 1.0, 0.0]))
    found = simulate(ground, body, 0.005, 0.8, shape=shape, law=RigidLaw(0.0), friction=0.5)
    centre = found["body.position"]
    np.testing.assert_allclose(centre @ down + 0.6, 0.25 * G * math.sin(slope) * found.times**2, atol=2e-4)
    np.testing.assert_allclose(centre @ up, radius, atol=1e-8)
    assert np.abs(centre[:, 1]).max() < 1e-8
    np.testing.assert_allclose(found["touch.normal_force"][5:], mass * G * math.cos(slope), rtol=1e-4)
    np.testing.assert_allclose(found["touch.friction_force"][5:], 0.5 * mass * G * math.sin(slope), rtol=1e-2)


def slide_off(speed: float, time: float, radius: float = 0.1) -> Run:
    """A smooth ball that slides over the border of a floor at x = 1."""
    body = RigidBody(
        name="body",
        mass=2.0,
        inertia=0.008 * np.eye(3),
        position=np.array([0.9, 0.1, radius]),
        velocity=np.array([speed, 0.0, 0.0]),
    )
    return simulate(floor(), body, 0.002, time, shape=SphereShape(radius), law=RigidLaw(0.0))


def test_fast_ball_leaves_the_border_on_a_parabola() -> None:
    """Above ``sqrt(g r)`` nothing touches behind the border: no impulse, no change of the level speed."""
    found = slide_off(2.0, 0.5)
    after = np.maximum(found.times - 0.05, 0.0)
    np.testing.assert_allclose(found["body.position"][:, 0], 0.9 + 2.0 * found.times, atol=1e-9)
    np.testing.assert_allclose(found["body.position"][:, 2], 0.1 - 0.5 * G * after**2, atol=5e-5)
    assert np.all(found["touch.normal_force"][found.times > 0.06] == 0.0)
    assert found["touch.dissipated"][-1] < 1e-6


def test_slow_ball_turns_about_the_border_until_it_leaves() -> None:
    """It leaves at ``cos(angle) = (v^2/(g r) + 2) / 3`` and keeps its energy."""
    speed, radius = 0.4, 0.1
    found = slide_off(speed, 0.75)
    leaving = (speed**2 / (G * radius) + 2.0) / 3.0
    x, z = found["body.position"][:, 0] - 1.0, found["body.position"][:, 2]
    touching = found["touch.normal_force"] > 0.0
    last = np.flatnonzero(touching)[-1]
    assert z[last] / math.hypot(x[last], z[last]) == pytest.approx(leaving, abs=0.02)
    np.testing.assert_allclose(np.hypot(x, z)[touching & (x > 0.0)], radius, atol=1e-5)
    assert found["touch.dissipated"][-1] < 1e-3 * 0.5 * 2.0 * speed**2
    assert found.drift < 1e-4
    assert z[-1] < -0.3


def test_point_lands_in_one_valley_and_slides_into_the_other() -> None:
    """Free flight over the hump of a W, landing, and the motion along the surface, by an independent integration."""

    def height(x: Any) -> Any:
        return 0.1 * (x * x - 1.0) ** 2

    def slope(x: float) -> float:
        return 0.4 * x * (x * x - 1.0)

    def bend(x: float) -> float:
        return 0.4 * (3.0 * x * x - 1.0)

    ground = floor(lambda x, y: height(x) + 0.0 * y, half=2.0, count=11, degree=4)
    x0, z0, speed = -0.3, 0.35, 2.0
    body = RigidBody(
        name="body",
        mass=2.0,
        inertia=0.01 * np.eye(3),
        position=np.array([x0, 0.2, z0]),
        velocity=np.array([speed, 0.0, 0.0]),
    )
    landing = brentq(lambda t: z0 - 0.5 * G * t * t - height(x0 + speed * t), 0.1, 0.5, xtol=1e-14)
    x = x0 + speed * landing
    along = (speed - slope(x) * G * landing) / (1.0 + slope(x) ** 2)  # x' after an impact without rebound

    def rates(_: float, y: Array) -> list[float]:
        x, v = y
        return [v, -slope(x) * (bend(x) * v * v + G) / (1.0 + slope(x) ** 2)]

    end = 2.6
    errors = []
    for step in (0.004, 0.002):
        found = simulate(ground, body, step, end, shape=PointShape(), law=RigidLaw(0.0))
        times = found.times[found.times > landing]
        motion = solve_ivp(
            rates, (landing, end), [x, along], method="DOP853", rtol=1e-11, atol=1e-12, t_eval=times
        ).y
        path = found["body.position"][:, 0][found.times > landing]
        errors.append(np.abs(path - motion[0]).max())
    assert motion[0].max() > 0.9, "it must have been in one valley"
    assert motion[0].min() < -0.5, "and then in the other"
    assert np.all(G + bend(0.0) * motion[1][np.abs(motion[0]) < 0.6] ** 2 > 0.0), "it must not take off"
    np.testing.assert_allclose(found["body.position"][:, 2][found.times > landing], height(path), atol=1e-5)
    assert found["touch.impacts"][-1] == 1.0
    assert errors[1] < 2e-3
    assert errors[0] / errors[1] > 2.5
    assert found["body.position"][:, 1][-1] == pytest.approx(0.2, abs=1e-8)


def test_primitive_pressed_in_deeper_than_its_rounding_stops_the_run() -> None:
    """A law too soft for the weight; the message names the contact and says what is wrong."""
    body = RigidBody(name="body", mass=2.0, inertia=0.05 * np.eye(3), position=np.array([0.0, 0.0, 0.0501]))
    scene = Scene(
        bodies=(body,),
        forces=(Gravity(DOWN),),
        contours=(dome(),),
        contacts=(
            Contact(name="touch", contour="floor", body="body", shape=SHAPES["box"][0], law=LinearLaw(100.0)),
        ),
    )
    simulation = Simulation(scene, 0.002)
    times, _ = simulation.advance(500)
    assert simulation.outcome != 0
    assert "'touch'" in simulation.message
    assert "rounding" in simulation.message
    # m z'' = -m g + k d reaches the rounding, 10 mm, at cos(w t) = 1 - k d / (m g), up to the fall through 0.1 mm
    frequency = math.sqrt(100.0 / 2.0)
    reached = math.acos(1.0 - 100.0 * 0.01 / (2.0 * G)) / frequency
    assert times[-1] == pytest.approx(reached + math.sqrt(2.0 * 1e-4 / G), abs=6e-3)
