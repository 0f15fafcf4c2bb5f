"""A point mass on a flexible plate whose frame is held: impacts, hard and compliant contact, a slider."""

from __future__ import annotations

import numpy as np
import pytest
from contact_scenes import run
from flexible_scenes import hit, plate
from scipy.integrate import solve_ivp

from heavylift.solver.scene.contacts import BilateralLaw, HertzLaw, RigidLaw

pytestmark = pytest.mark.slow

MASS, G = 0.7, 9.81


def test_slider_in_the_middle_swings_with_the_plate():
    """One more inertia m b b^T in the modal equations; second order."""
    body = plate()
    b, k = body.centre, body.cloud.stiffness
    damping = 0.04 * np.sqrt(k)
    weight = -G * (body.cloud.shapes[:, :, 2] @ body.cloud.masses + MASS * b)
    inertia = np.linalg.inv(np.eye(3) + MASS * np.outer(b, b))

    def rates(_, y):
        return np.concatenate([y[3:], inertia @ (weight - k * y[:3] - damping * y[3:])])

    errors, force_errors = [], []
    for step in (2e-3, 1e-3, 5e-4):
        scene = hit(body, 0.0, 0.0, BilateralLaw(), mass=MASS, gravity=G, damping=0.02)
        found = run(scene, step, 0.5)
        exact = solve_ivp(rates, (0.0, 0.5), np.zeros(6), t_eval=found.times, rtol=1e-10, atol=1e-13).y
        height = b @ exact[:3]
        force = MASS * (b @ np.array([rates(0.0, y)[3:] for y in exact.T]).T + G)
        errors.append(np.abs(found["ball.position"][:, 2] - height).max() / np.abs(height).max())
        force_errors.append(np.abs(found["touch.normal_force"] - force)[20:].max() / np.abs(force).max())
        assert np.abs(found["ball.position"][:, :2]).max() < 1e-9
        assert found.drift < 1e3 * step**2 * MASS * G * np.abs(height).max()
    assert errors[2] < 1e-3
    assert errors[0] / errors[1] > 3.4
    assert errors[1] / errors[2] > 3.4
    assert force_errors[2] < 0.02


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_impact_sees_the_inertia_of_all_shapes(restitution):
    """p = (1 + e) v / (1/m + b b), loss (1 - e^2) v^2 / 2 / (1/m + b b)."""
    body = plate()
    effective = 1.0 / (1.0 / MASS + body.centre @ body.centre)
    found = run(hit(body, 0.0105, 1.0, RigidLaw(restitution)), 1e-3, 0.011)
    impulse = (1.0 + restitution) * effective
    assert found["touch.impacts"][-1] == 1.0
    if restitution > 0.0:
        assert np.isclose(found["touch.impulse"][-1], impulse, rtol=2e-6)
        assert np.isclose(found["ball.velocity"][-1, 2], -1.0 + impulse / MASS, rtol=2e-6)
    lost = 0.5 * (1.0 - restitution**2) * effective
    assert np.isclose(found["touch.dissipated"][-1], lost, rtol=1e-6, atol=1e-6)
    assert found.drift < 1e-6


def hybrid(body, height, speed, duration):
    """Contact without restitution by phases: free, impact, together until the force ends."""
    b, k = body.centre, body.cloud.stiffness
    n = len(b)
    inverse = np.linalg.inv(np.eye(n) + MASS * np.outer(b, b))

    def free(_, y):  # z, z', q, q'
        return np.concatenate([[y[1], 0.0], y[2 + n :], -k * y[2 : 2 + n]])

    def together(_, y):
        return np.concatenate([y[n:], -inverse @ (k * y[:n])])

    def meets(_, y):
        return y[0] - b @ y[2 : 2 + n]

    def parts(_, y):
        return -b @ inverse @ (k * y[:n])  # acceleration of the mass: its force

    meets.terminal = parts.terminal = True
    meets.direction = parts.direction = -1.0
    time, y = 0.0, np.concatenate([[height, -speed], np.zeros(2 * n)])
    options = {"rtol": 1e-10, "atol": 1e-13, "max_step": 1e-3}
    phases = 0
    while True:
        step = solve_ivp(free, (time, duration), y, events=meets, **options)
        time, y = step.t[-1], step.y[:, -1]
        if step.status == 0:
            return y, phases
        phases += 1
        impulse = -(y[1] - b @ y[2 + n :]) / (1.0 / MASS + b @ b)
        q, qd = y[2 : 2 + n], y[2 + n :] - b * impulse
        step = solve_ivp(together, (time, duration), np.concatenate([q, qd]), events=parts, **options)
        time, q, qd = step.t[-1], step.y[:n, -1], step.y[n:, -1]
        y = np.concatenate([[b @ q + 1e-14, b @ qd], q, qd])
        assert step.status == 1


def test_hard_contact_against_its_phases():
    body = plate((4.0,))
    exact, phases = hybrid(body, 0.01, 1.0, 0.25)
    assert phases == 1
    for step, limit in ((5e-3, 1e-3), (2e-3, 1e-5), (5e-4, 4e-6)):
        found = run(hit(body, 0.01, 1.0, RigidLaw()), step, 0.25)
        assert abs(found["ball.velocity"][-1, 2] - exact[1]) < limit * abs(exact[1])
        assert found["touch.impacts"][-1] == 1.0
        assert found["touch.gap"].min() > -1e-6
        assert found.drift < 1e-8


def test_hard_contact_on_many_modes_converges():
    body = plate()
    exact, _ = hybrid(body, 0.01, 1.0, 0.25)
    errors = []
    for step in (1e-3, 5e-4, 2.5e-4):
        found = run(hit(body, 0.01, 1.0, RigidLaw()), step, 0.25)
        errors.append(abs(found["ball.velocity"][-1, 2] - exact[1]))
    assert errors[2] < 5e-5 * abs(exact[1])
    assert errors[0] > 4.0 * errors[2]


def test_hertz_law_against_its_differential_equation():
    body = plate()
    b, k, stiffness = body.centre, body.cloud.stiffness, 1e6

    def rates(_, y):
        force = stiffness * max(0.0, b @ y[2:5] - y[0]) ** 1.5
        return np.concatenate([[y[1], force / MASS], y[5:], -k * y[2:5] - b * force])

    exact = solve_ivp(
        rates,
        (0.0, 0.05),
        [0.001, -1.0, *np.zeros(6)],
        rtol=1e-10,
        atol=1e-13,
        max_step=2e-5,
        method="DOP853",
    ).y[:, -1]
    errors = []
    for step in (1e-4, 5e-5, 2.5e-5):
        found = run(hit(body, 0.001, 1.0, HertzLaw(stiffness)), step, 0.05)
        errors.append(abs(found["ball.velocity"][-1, 2] - exact[1]))
        assert found.drift < 1e-6
    assert errors[2] < 1e-3
    assert errors[0] / errors[2] > 6.0


def test_sliding_point_keeps_the_energy_of_plate_and_mass():
    """Without friction nothing is lost while the contact lasts, though the surface moves and turns under it."""
    body = plate()
    drifts, lost = [], []
    for step in (1e-3, 5e-4):
        scene = hit(body, 0.0, 0.0, BilateralLaw(), gravity=G, place=(-0.3, 0.1), sideways=(0.6, -0.1))
        found = run(scene, step, 0.8)
        assert np.abs(found["touch.gap"]).max() < 1e-5
        assert found["ball.position"][-1, 0] > 0.0
        drifts.append(found.drift)
        lost.append(abs(found["touch.dissipated"][-1]))
    kinetic = 0.5 * MASS * 0.37
    assert drifts[1] < 1e-3 * kinetic
    assert 3.0 < drifts[0] / drifts[1] < 6.0
    assert max(lost) < 1e-12


def test_rubbing_point_loses_what_friction_takes():
    body = plate()
    scene = hit(
        body, 0.0, 0.0, BilateralLaw(), gravity=G, place=(-0.3, 0.0), sideways=(0.8, 0.0), friction=0.1
    )
    found = run(scene, 5e-4, 0.5)
    path = np.trapezoid(found["touch.friction_force"] * found["touch.slip"], found.times)
    assert np.isclose(found["touch.dissipated"][-1], path, rtol=2e-2)
    assert (
        np.abs(found["touch.friction_force"] - 0.1 * np.abs(found["touch.normal_force"]))[5:].max() < 0.02 * G
    )
    assert found.drift < 1e-3 * found["touch.dissipated"][-1]
