"""Prescribed motion of a frame: four functions of time, as cubics in time and harmonics, in one flat array.

A driven frame is displaced by ``d(t)`` (world axes) and turned by the angle ``phi(t)`` about a fixed
axis through a pivot::

    x(t) = c + d(t) + Q(phi(t)) (x0 - c),    R(t) = Q(phi(t)) R0

Velocities and accelerations follow by differentiation; rotation about a fixed axis: A. A. Shabana,
"Dynamics of Multibody Systems", chapter 2.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import exponential_quaternion, quaternion_product, rotate_by_quaternion
from heavylift.numerics.vectors import cross
from heavylift.solver.scene.bodies import Driven, Profile
from heavylift.solver.scene.speed_profiles import profile_cubics

__all__ = [
    "DRIVEN",
    "DRIVE_HEAD",
    "FIXED",
    "FREE",
    "drive_pose",
    "drive_velocity",
    "pack_drive",
    "pack_profile",
    "profile_value",
]

FREE, FIXED, DRIVEN = range(3)
"""How a frame moves, in the tables of kinds."""

DRIVE_HEAD = 17
"""Numbers before the profiles: axis 3, pivot 3, start position 3, start quaternion 4, profile starts 4."""


def pack_drive(
    drive: Driven, position: NDArray[np.float64], orientation: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Flatten a driven motion for the kernels below.

    Parameters
    ----------
    drive
        Axis, pivot and profiles.
    position, orientation
        Pose of the frame for zero displacement and zero angle: [m], shape (3,); quaternion, shape (4,).

    Raises
    ------
    InputError
        If the axis is zero although an angle is given.
    """
    axis = np.asarray(drive.axis, dtype=np.float64)
    length = float(np.linalg.norm(axis))
    if not length > 0.0 and drive.angle is not None:
        raise InputError(
            "the axis has length zero", source="driven frame", key="axis", expected="a direction"
        )
    profiles = [pack_profile(profile) for profile in drive.profiles]
    starts = DRIVE_HEAD + np.concatenate([[0], np.cumsum([len(block) for block in profiles])])[:4]
    axis = axis / length if length > 0.0 else axis
    start = np.asarray(orientation, dtype=np.float64) / np.linalg.norm(orientation)
    head = np.concatenate([axis, drive.pivot, position, start, starts])
    return np.concatenate([head, *profiles])


def pack_profile(profile: Profile | None) -> NDArray[np.float64]:
    """Breaks, coefficients by falling power, then (amplitude, angular frequency, phase) of each harmonic."""
    if profile is None:
        return np.zeros(2)
    harmonics = np.array(
        [(h.amplitude, 2.0 * math.pi * h.frequency, h.phase) for h in profile.harmonics], dtype=np.float64
    ).ravel()
    if len(profile.times) == 0:
        return np.concatenate([[0.0, len(profile.harmonics)], harmonics])
    breaks, cubics = profile_cubics(profile)
    return np.concatenate([[len(breaks), len(profile.harmonics)], breaks, cubics.ravel(), harmonics])


@kernel
def profile_value(data: NDArray[np.float64], start: int, time: float) -> tuple[float, float, float]:
    """Value, first and second time derivative of a packed profile; a table holds its ends outside its range."""
    count = int(data[start])
    harmonic_count = int(data[start + 1])
    breaks = start + 2
    value = rate = acceleration = 0.0
    end = breaks
    if count > 0:
        t = min(max(time, data[breaks]), data[breaks + count - 1])
        low, high = 0, count - 1
        while high - low > 1:
            middle = (low + high) // 2
            if data[breaks + middle] <= t:
                low = middle
            else:
                high = middle
        c = breaks + count + 4 * low
        s = t - data[breaks + low]
        value = ((data[c] * s + data[c + 1]) * s + data[c + 2]) * s + data[c + 3]
        if t == time:
            rate = (3.0 * data[c] * s + 2.0 * data[c + 1]) * s + data[c + 2]
            acceleration = 6.0 * data[c] * s + 2.0 * data[c + 1]
        end = breaks + count + 4 * (count - 1)
    for i in range(harmonic_count):
        amplitude, omega, phase = data[end + 3 * i], data[end + 3 * i + 1], data[end + 3 * i + 2]
        angle = omega * time + phase
        value += amplitude * math.sin(angle)
        rate += amplitude * omega * math.cos(angle)
        acceleration -= amplitude * omega * omega * math.sin(angle)
    return value, rate, acceleration


@entry
def drive_pose(drive: Floats1, time: float, pose: Floats1) -> None:
    """Write position [m] and unit quaternion of a driven frame into ``pose``, shape (7,)."""
    angle = profile_value(drive, int(drive[16]), time)[0]
    turn = exponential_quaternion(angle * drive[0], angle * drive[1], angle * drive[2])
    arm = rotate_by_quaternion(turn, drive[6] - drive[3], drive[7] - drive[4], drive[8] - drive[5])
    for i in range(3):
        pose[i] = drive[3 + i] + profile_value(drive, int(drive[13 + i]), time)[0] + arm[i]
    q = quaternion_product(turn, (drive[9], drive[10], drive[11], drive[12]))
    for i in range(4):
        pose[3 + i] = q[i]


@kernel
def drive_velocity(drive: NDArray[np.float64], time: float, motion: NDArray[np.float64]) -> None:
    """Write velocity [m/s], body-axis spin [rad/s], acceleration and spin rate into ``motion``, shape (12,)."""
    angle, rate, rate2 = profile_value(drive, int(drive[16]), time)
    turn = exponential_quaternion(angle * drive[0], angle * drive[1], angle * drive[2])
    arm = rotate_by_quaternion(turn, drive[6] - drive[3], drive[7] - drive[4], drive[8] - drive[5])
    side = cross(drive, arm)
    inward = cross(drive, side)
    # the axis is its own image under Q, so in body axes it is R0^T axis at all times
    axis = rotate_by_quaternion((drive[9], -drive[10], -drive[11], -drive[12]), drive[0], drive[1], drive[2])
    for i in range(3):
        _, velocity, acceleration = profile_value(drive, int(drive[13 + i]), time)
        motion[i] = velocity + rate * side[i]
        motion[3 + i] = rate * axis[i]
        motion[6 + i] = acceleration + rate2 * side[i] + rate * rate * inward[i]
        motion[9 + i] = rate2 * axis[i]
