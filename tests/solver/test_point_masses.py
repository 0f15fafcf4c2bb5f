"""The reference itself: its accelerations are second derivatives of its positions, its energy is kept."""

from __future__ import annotations

import numpy as np
import pytest
from point_masses import System, make_cloud
from scenarios import FLEXIBLE, HARMONICS, TABLES, reference, start_of
from scipy.spatial.transform import Rotation


def test_quadratic_accelerations_are_second_derivatives_of_positions() -> None:
    """Frame with constant body spin, modes with constant rates: nothing but quadratic terms is left."""
    cloud = make_cloud(rigid_part=1.0)
    start = start_of(1)
    R, w, q, qd = Rotation.from_quat(start.orientation).as_matrix(), start.spin, start.q, start.qd

    def positions(time: float) -> np.ndarray:
        return cloud.deformed(q + time * qd) @ (R @ Rotation.from_rotvec(time * w).as_matrix()).T

    h = 1e-3
    values = [positions(k * h) for k in (-2, -1, 0, 1, 2)]
    second = (-values[0] + 16 * values[1] - 30 * values[2] + 16 * values[3] - values[4]) / (12 * h * h)
    np.testing.assert_allclose(cloud.quadratic_accelerations(R, w, q, qd), second, atol=1e-8)
    first = (values[0] - 8 * values[1] + 8 * values[3] - values[4]) / (12 * h)
    velocities = cloud.jacobians(R, q) @ np.concatenate([np.zeros(3), w, qd])
    np.testing.assert_allclose(velocities, first, atol=1e-9)


@pytest.mark.parametrize("motion", [HARMONICS, TABLES])
@pytest.mark.parametrize("time", [0.05, 0.22, 0.38])
def test_prescribed_motion_is_consistent(motion: object, time: float) -> None:
    system = System(make_cloud(modes=0), start_of(2, 0), motion)
    h = 1e-4
    before, now, after = (system.prescribed(t) for t in (time - h, time, time + h))
    np.testing.assert_allclose(now[2], (after[0] - before[0]) / (2 * h), atol=1e-5)
    np.testing.assert_allclose(now[4], (after[2] - before[2]) / (2 * h), atol=1e-3)
    turn = Rotation.from_matrix(before[1].T @ after[1]).as_rotvec()
    np.testing.assert_allclose(now[3], turn / (2 * h), atol=1e-5)
    np.testing.assert_allclose(now[5], (after[3] - before[3]) / (2 * h), atol=1e-3)


@pytest.mark.parametrize("name", FLEXIBLE)
def test_energy_of_the_reference_is_balanced(name: str) -> None:
    """Stored energy changes by the works of loads and drive less what the dampers took, to 1e-9."""
    system = FLEXIBLE[name]
    end = reference(system)
    change = sum(end[f"energy.{part}"][0] for part in ("kinetic", "elastic", "potential")) - sum(
        system.energies(0.0, system.start_vector())
    )
    work = end["energy.external_work"] + end["energy.drive_work"] - end["energy.dissipated"]
    assert change == pytest.approx(work[0], abs=1e-8)
