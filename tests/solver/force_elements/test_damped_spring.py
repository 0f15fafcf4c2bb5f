"""A damped spring that turns, and steps that must end where a load changes: against an ODE."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from heavylift.solver.forces.point import PointForce
from heavylift.solver.forces.spring import Spring
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.scene import RigidBody, Scene, Sensor
from heavylift.solver.simulation import Simulation

STIFFNESS, DAMPING, LENGTH, MASS = 400.0, 6.0, 1.0, 2.0
TIMES, PUSH = np.array([0.0, 0.5, 0.5 + 1e-6, 2.0]), 5.0


def scene() -> Scene:
    """A load that flies around an anchor on a spring with a damper, and is pushed from 0.5 s on."""
    load = RigidBody("load", MASS, np.eye(3), position=np.array([1.2, 0, 0]), velocity=np.array([0, 2.0, 0]))
    spring = Spring(
        name="spring",
        body_a=GROUND,
        point_a=np.zeros(3),
        body_b="load",
        point_b=np.zeros(3),
        length=LENGTH,
        stiffness=STIFFNESS,
        damping=DAMPING,
    )
    forces = np.array([[0.0, 0, 0], [0, 0, 0], [PUSH, 0, 0], [PUSH, 0, 0]])
    push = PointForce("push", "load", np.zeros(3), TIMES, forces)
    return Scene((load,), (spring, push), (Sensor("tip", "load", np.zeros(3)),))


def expected(times: np.ndarray) -> np.ndarray:
    def rates(t, y):
        r, v = y[:2], y[2:]
        distance = np.hypot(*r)
        tension = STIFFNESS * (distance - LENGTH) + DAMPING * (r @ v) / distance
        push = np.interp(t, TIMES, [0.0, 0.0, PUSH, PUSH])
        return np.r_[v, (-tension * r / distance + [push, 0.0]) / MASS]

    state, found = np.array([1.2, 0.0, 0.0, 2.0]), []
    for begin, end in ((0.0, 0.5), (0.5, TIMES[2]), (TIMES[2], times[-1])):
        inside = times[(times > begin) & (times <= end)]
        at = np.union1d(inside, [end])
        part = solve_ivp(rates, (begin, end), state, "DOP853", at, rtol=1e-11, atol=1e-12)
        state = part.y[:, -1]
        found += [part.y[:2, i] for i, time in enumerate(at) if time in inside]
    return np.array(found)


def error(simulation: Simulation, count: int) -> float:
    column = next(c.column for c in simulation.channels if c.name == "tip.position")
    times, rows = simulation.advance(count)
    return float(np.abs(rows[:, column : column + 2] - expected(times)).max())


@pytest.mark.slow
def test_a_damped_spring_is_of_second_order():
    errors = [
        error(Simulation(scene(), step, record_every=round(0.05 / step)), round(1.0 / step))
        for step in (2e-3, 1e-3)
    ]
    assert errors[1] < 2e-5
    assert np.log2(errors[0] / errors[1]) > 1.8


def test_adaptive_steps_end_at_corners_that_are_output_times():
    for interval in (0.05, 0.1, 0.3):
        simulation = Simulation(scene(), interval, tolerance=1e-6)
        assert error(simulation, round(0.9 / interval)) < 1e-3
        assert simulation.solver_steps < 5000


def test_the_first_record_of_a_damper_is_of_second_order_too() -> None:
    """A mass of 1 kg at 1 m/s on a damper and spring: force after the first step against the closed form."""
    errors = []
    for step in (1e-2, 5e-3):
        mass = RigidBody(
            "mass", 1.0, np.eye(3), position=np.array([1.0, 0.0, 0.0]), velocity=np.array([1.0, 0.0, 0.0])
        )
        spring = Spring(
            name="spring", body_a="ground", point_a=np.zeros(3), body_b="mass", point_b=np.zeros(3),
            length=1.0, stiffness=40.0, damping=20.0,
        )  # fmt: skip
        simulation = Simulation(Scene((mass,), (spring,)), step)
        row = simulation.advance(1)[1][0]
        column = {channel.name: channel.column for channel in simulation.channels}["spring.force"]
        a, w = 10.0, math.sqrt(100.0 - 40.0)  # x = exp(-a t) sinh(w t) / w
        decay, s, c = math.exp(-a * step), math.sinh(w * step), math.cosh(w * step)
        place, speed = decay * s / w, decay * (c - a * s / w)
        errors.append(abs(row[column] - 40.0 * place - 20.0 * speed))
    assert errors[0] / errors[1] > 3.0
