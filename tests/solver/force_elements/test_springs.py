"""Springs and dampers between points: as rows of the default step, and as forces of the accurate integrator."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest
from law_scenes import NONE, G, body, run, scene
from scipy.integrate import solve_ivp

from heavylift.solver.forces.spring import Spring
from heavylift.solver.scene.connections import GROUND

if TYPE_CHECKING:
    from heavylift.solver.scene.scene import Scene

MASS, LENGTH, STIFFNESS, DAMPING = 2.0, 1.0, 200.0, 0.5


def pendulum() -> Scene:
    spring = Spring(
        name="spring",
        body_a=GROUND,
        point_a=np.zeros(3),
        body_b="ball",
        point_b=np.zeros(3),
        length=LENGTH,
        stiffness=STIFFNESS,
        damping=DAMPING,
    )
    return scene([body("ball", MASS, (1.2, 0, 0))], [spring])


def reference(times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions and tensions of a point on a spring by a Runge-Kutta method of order 8."""

    def tension(y: np.ndarray) -> float:
        distance = np.linalg.norm(y[:3])
        return STIFFNESS * (distance - LENGTH) + DAMPING * (y[:3] @ y[3:]) / distance

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        pull = tension(y) * y[:3] / np.linalg.norm(y[:3])
        return np.concatenate([y[3:], -pull / MASS - [0.0, 0.0, G]])

    y = solve_ivp(
        rates, (0, times[-1]), [1.2, 0, 0, 0, 0, 0], method="DOP853", t_eval=times, rtol=1e-11, atol=1e-11
    ).y
    return y[:3].T, np.array([tension(column) for column in y.T])


def test_spring_pendulum() -> None:
    errors = []
    for step in (1e-2, 5e-3):
        result = run(pendulum(), step, 3.0)
        position, tension = reference(result.times)
        errors.append(
            (np.abs(result["ball.position"] - position).max(), np.abs(result["spring.force"] - tension).max())
        )
    np.testing.assert_allclose(result["spring.length"], np.linalg.norm(result["ball.position"], axis=1))
    assert errors[1][0] < 1.3e-3
    for coarse, fine in zip(*errors, strict=True):
        assert coarse / fine == pytest.approx(4.0, rel=0.15)


@pytest.mark.slow
def test_accurate_integrator_takes_the_same_spring_as_a_force() -> None:
    result = run(pendulum(), 0.05, 3.0, "accurate", tolerance=1e-9)
    position, tension = reference(result.times)
    assert np.abs(result["ball.position"] - position).max() < 1e-7
    assert np.abs(result["spring.force"] - tension).max() < 1e-5
    assert result.balance < 1e-3


def test_damper_decay() -> None:
    """A damper alone: v = v0 exp(-c t/m), whatever c h/m is; all energy is booked."""
    for damping, step in ((3.0, 1e-2), (1e5, 1e-2)):
        damper = Spring(
            name="damper",
            body_a=GROUND,
            point_a=np.array([-5.0, 0, 0]),
            body_b="ball",
            point_b=np.zeros(3),
            length=5.0,
            damping=damping,
        )
        result = run(scene([body("ball", MASS, (0, 0, 0), (1, 0, 0))], [damper], field=NONE), step, 1.0)
        v = result["ball.velocity"][:, 0]
        factor = (1.0 - 0.5 * damping * step / MASS) / (1.0 + 0.5 * damping * step / MASS)
        np.testing.assert_allclose(v, factor ** np.arange(len(v)), atol=1e-4)
        assert result.balance < 1e-4  # the row is regularised
        if damping < 10.0:
            assert v[-1] == pytest.approx(math.exp(-damping / MASS), rel=1e-4)


def test_stiff_spring_is_stable_at_any_step() -> None:
    """omega h = 100: the trapezoidal rule neither grows nor decays; 1e-7 (omega h)^2/4 is the regularisation."""
    spring = Spring(
        name="spring",
        body_a=GROUND,
        point_a=np.array([-5.0, 0, 0]),
        body_b="ball",
        point_b=np.zeros(3),
        length=5.0,
        stiffness=2e8,
    )
    result = run(scene([body("ball", MASS, (0, 0, 0), (1, 0, 0))], [spring], field=NONE), 1e-2, 10.0)
    energy = result["energy.balance"]
    assert result.balance < 3e-4
    assert np.ptp(energy[-100:]) == pytest.approx(np.ptp(energy[:100]), rel=1e-3)
