"""Prescribed motion: values against closed forms and scipy, rates against difference quotients."""

from __future__ import annotations

import numpy as np
import pytest
from scenarios import HARMONICS, TABLES, start_of
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from heavylift.numerics.outcome import InputError
from heavylift.solver.drive import DRIVE_HEAD, drive_pose, drive_velocity, pack_drive, profile_value
from heavylift.solver.scene.descriptions import check_object
from heavylift.solver.scene.scene import Driven, Harmonic, Profile

TIMES, VALUES = np.array([0.5, 1.0, 1.7, 2.0, 3.0]), np.array([1.0, -2.0, 0.5, 0.5, 4.0])


def packed(profile: Profile | None) -> np.ndarray:
    """A drive whose first profile starts behind the head."""
    drive = pack_drive(Driven(x=profile), np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
    return np.ascontiguousarray(drive)


def test_no_profile_is_zero() -> None:
    assert profile_value(packed(None), DRIVE_HEAD, 0.7) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("time", [0.5, 0.6, 1.0, 1.3, 1.7, 1.99, 2.0, 2.4, 3.0])
def test_table_is_the_clamped_spline(time: float) -> None:
    spline = CubicSpline(TIMES, VALUES, bc_type="clamped")
    expected = [spline(time), spline(time, 1), spline(time, 2)]
    np.testing.assert_allclose(
        profile_value(packed(Profile(TIMES, VALUES)), DRIVE_HEAD, time), expected, atol=1e-12
    )


@pytest.mark.parametrize(("time", "value"), [(-5.0, 1.0), (0.4999, 1.0), (3.0001, 4.0), (50.0, 4.0)])
def test_table_is_held_beyond_its_ends(time: float, value: float) -> None:
    assert profile_value(packed(Profile(TIMES, VALUES)), DRIVE_HEAD, time) == (pytest.approx(value), 0.0, 0.0)


def test_two_rows_are_a_smooth_step() -> None:
    """Clamped cubic from rest to rest: ``3 s^2 - 2 s^3``."""
    data = packed(Profile(np.array([1.0, 3.0]), np.array([0.0, 2.0])))
    for s in (0.0, 0.25, 0.5, 1.0):
        expected = (2 * (3 * s**2 - 2 * s**3), 6 * s - 6 * s**2, 3 - 6 * s)
        np.testing.assert_allclose(profile_value(data, DRIVE_HEAD, 1.0 + 2.0 * s), expected, atol=1e-12)


def test_harmonics_add_to_the_table() -> None:
    both = packed(Profile(TIMES, VALUES, (Harmonic(0.3, 2.0, 0.4), Harmonic(1.0, 0.5))))
    table = profile_value(packed(Profile(TIMES, VALUES)), DRIVE_HEAD, 1.2)
    w1, w2 = 4 * np.pi, np.pi
    a, b = w1 * 1.2 + 0.4, w2 * 1.2
    expected = np.array(
        [
            0.3 * np.sin(a) + np.sin(b),
            0.3 * w1 * np.cos(a) + w2 * np.cos(b),
            -0.3 * w1**2 * np.sin(a) - w2**2 * np.sin(b),
        ]
    )
    np.testing.assert_allclose(profile_value(both, DRIVE_HEAD, 1.2), table + expected, atol=1e-11)


@pytest.mark.parametrize("driven", [HARMONICS, TABLES])
@pytest.mark.parametrize("time", [0.03, 0.15, 0.25, 0.37])
def test_velocities_and_accelerations_are_derivatives_of_the_pose(driven: Driven, time: float) -> None:
    start = start_of(1)
    drive = pack_drive(driven, start.position, start.orientation)

    def pose(t: float) -> tuple[np.ndarray, Rotation]:
        out = np.empty(7)
        drive_pose(drive, t, out)
        return out[:3], Rotation.from_quat(out[3:], scalar_first=True)

    def motion(t: float) -> np.ndarray:
        out = np.empty(12)
        drive_velocity(drive, t, out)
        return out

    h = 1e-4
    (x0, R0), (x1, R1) = pose(time - h), pose(time + h)
    now = motion(time)
    np.testing.assert_allclose(now[:3], (x1 - x0) / (2 * h), atol=2e-6)
    np.testing.assert_allclose(now[3:6], (R0.inv() * R1).as_rotvec() / (2 * h), atol=2e-6)
    np.testing.assert_allclose(now[6:], (motion(time + h) - motion(time - h))[:6] / (2 * h), atol=2e-4)


def test_the_pivot_stays_where_it_is() -> None:
    """A quarter turn about a vertical axis through (1, 0, 0), and an axis that is no unit vector."""
    quarter = Profile(np.array([0.0, 1.0]), np.array([0.0, np.pi / 2]))
    driven = Driven(angle=quarter, axis=(0.0, 0.0, 8.0), pivot=(1.0, 0.0, 5.0))
    out = np.empty(7)
    for x0, x1 in [((1.0, 0.0, 2.0), (1.0, 0.0, 2.0)), ((3.0, 0.0, 0.0), (1.0, 2.0, 0.0))]:
        drive_pose(pack_drive(driven, np.array(x0), np.array([1.0, 0, 0, 0])), 1.0, out)
        np.testing.assert_allclose(out[:3], x1, atol=1e-15)
        np.testing.assert_allclose(out[3:], [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)], atol=1e-15)


def test_bad_drives() -> None:
    turn = Profile(harmonics=(Harmonic(1.0, 1.0),))
    pose = np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])
    with pytest.raises(InputError, match="driven frame: axis: the axis has length zero"):
        pack_drive(Driven(angle=turn, axis=(0.0, 0.0, 0.0)), *pose)
    pack_drive(Driven(x=turn, axis=(0.0, 0.0, 0.0)), *pose)  # needs no axis


@pytest.mark.parametrize(
    ("times", "values", "words"),
    [
        ([0.0], [1.0], "angle: a table of 1 rows; expected 2 or more"),
        ([0.0, 1.0], [1.0], "angle.values: 2 times and 1 values"),
        ([0.0, 0.0], [1.0, 2.0], "angle.times: .*increasing"),
        ([1.0, 0.0], [1.0, 2.0], "angle.times: .*increasing"),
        ([0.0, np.nan], [1.0, 2.0], "angle.times: nan is not finite"),
        ([0.0, 1.0], [1.0, np.nan], r"angle.values: nan is not finite; expected an angle \[rad\]"),
        ([], [], "angle: an empty profile"),
    ],
)
def test_bad_tables(times: list[float], values: list[float], words: str) -> None:
    with pytest.raises(InputError, match=f"platform: {words}"):
        check_object(Driven(angle=Profile(np.array(times), np.array(values))), source="platform")
