"""The kind of rigid bodies: centre of mass and principal axes inside, the user's frame outside.

In principal axes through the centre of mass the mass matrix is diagonal and constant. The step
carries the spatial angular momentum ``L = R I w``, so no gyroscopic torque is ever evaluated::

    xb, Rb  from half a step along an arc
    vb = v + h/2 F/m,           wb = I^-1 ( Rb^T L + h/2 t )
    x += h vb,  R := R exp(h wb),  v := 2 vb - v,  L := 2 Rb I wb - L,  w = I^-1 R^T L
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints2
from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import quaternion_from_matrix, rotation_matrix
from heavylift.solver.drive import DRIVEN, FIXED, FREE, pack_drive
from heavylift.solver.markers import BodyMarkers, pack_markers
from heavylift.solver.scene_bodies import Driven, Fixed, Free, RigidBody

__all__ = ["RigidBodies", "RigidFrames", "pack_rigid_bodies", "principal_frame"]

# columns of `table`
DOF, MOTION, DRIVE, COLUMN, NUMBER = range(5)

# columns of `frame`: the carried state of the principal frame ...
POSITION, ORIENTATION, VELOCITY, SPIN, ACCELERATION, SPIN_RATE = 0, 3, 7, 10, 13, 16
ANGULAR_MOMENTUM = 19  # spatial, about the centre of mass [kg m2/s]
WORK = 22  # of external forces and of the drive [J]
# ... constants: mass [kg], principal inertias [kg m2], centre of mass [m] and principal axes (quaternion)
# in the body frame ...
MASS, PRINCIPAL, CENTRE, AXES = 24, 25, 28, 31
# ... and the scratch of a step
MID_POSITION, MID_VELOCITY, MID_SPIN, FORCE, MOMENT, PRESCRIBED, POSE = 35, 38, 41, 44, 47, 50, 62
MID_ROTATION = 69  # rotation matrix of the stage, row by row
REACH = (
    78  # constant: distance of what is attached from the centre of mass, at least the radius of gyration [m]
)
INVERSE_MASS, INVERSE_PRINCIPAL = 79, 80  # reciprocals of mass and principal inertias
MEAN = 83  # mean velocity and spin of a driven body over a step
END = 89  # its pose, velocities and accelerations at the end of the step
JOINT_FORCE = 108  # force and moment of the rows on a held body, as of a marker
ARC = 114  # constant: share of h^2 a in the midpoint, 1/8 along an arc, 0 along a straight line
FRAME_WIDTH = 120  # whole cache lines


class RigidFrames(Protocol):
    """What kinds of rigid bodies share: the columns named above."""

    @property
    def table(self) -> NDArray[np.int64]:
        """As in `RigidBodies`."""

    @property
    def frame(self) -> NDArray[np.float64]:
        """As in `RigidBodies`."""


class RigidBodies(Arrays):
    """All rigid bodies of a scene; columns are named at the top of this file.

    Attributes
    ----------
    table
        First velocity, motion, start of the drive, first record column, number; shape (nb, 5).
    constants
        Drives and marker data: points from the centre of mass and directions, in principal axes.
    frame
        State, constants and scratch of the step, shape (nb, 120).
    markers, sensors
        As in the kind of floating frames, shapes (m, 5).
    """

    kernel_modules: ClassVar[tuple[str, ...]] = (
        "heavylift.solver.bodies.rigid_accurate",
        "heavylift.solver.bodies.rigid_configuration",
        "heavylift.solver.bodies.rigid_contours",
        "heavylift.solver.bodies.rigid_joints",
        "heavylift.solver.bodies.rigid_record",
        "heavylift.solver.bodies.rigid_stage",
        "heavylift.solver.bodies.rigid_step",
    )

    table: Ints2
    constants: Floats1
    frame: Floats2
    markers: Ints2
    sensors: Ints2


def pack_rigid_bodies(
    bodies: Sequence[RigidBody],
    first_number: int,
    first_dof: int,
    first_column: int,
    markers: Sequence[BodyMarkers],
    sensors: Sequence[BodyMarkers],
) -> RigidBodies:
    """Make the kind from what the user said.

    Raises
    ------
    InputError
        If a mass is not positive, or an inertia is not that of a body (triangle rule).
    """
    index = np.zeros((len(bodies), 5), dtype=np.int64)
    frame = np.zeros((len(bodies), FRAME_WIDTH))
    constants: list[NDArray[np.float64]] = []
    column = first_column
    for row, body in enumerate(bodies):
        moments, axes = _principal_axes(body)
        frame[row, MASS : AXES + 4] = (
            body.mass,
            *moments,
            *body.centre_of_mass,
            *quaternion_from_matrix(axes),
        )
        frame[row, ARC] = 0.125
        frame[row, INVERSE_MASS : INVERSE_PRINCIPAL + 3] = 1.0 / frame[row, MASS : PRINCIPAL + 3]
        motion = {Free: FREE, Fixed: FIXED, Driven: DRIVEN}[type(body.motion)]
        index[row] = first_dof + 6 * row, motion, sum(map(len, constants)), column, first_number + row
        if isinstance(body.motion, Driven):
            constants.append(pack_drive(body.motion, body.position, body.orientation))
        R = rotation_matrix(body.orientation)
        arm = R @ body.centre_of_mass
        frame[row, POSITION : POSITION + 3] = body.position + arm
        frame[row, ORIENTATION : ORIENTATION + 4] = quaternion_from_matrix(R @ axes)
        if isinstance(body.motion, Free):
            frame[row, VELOCITY : VELOCITY + 3] = body.velocity + np.cross(R @ body.angular_velocity, arm)
            frame[row, SPIN : SPIN + 3] = axes.T @ body.angular_velocity
        column += 13 if isinstance(body.motion, Free) else 19
    to_principal = [
        _marker_data(rotation_matrix(frame[row, AXES : AXES + 4]), body.centre_of_mass)
        for row, body in enumerate(bodies)
    ]
    turned = [
        BodyMarkers(
            entry.numbers,
            tuple(
                rotation_matrix(frame[row, AXES : AXES + 4]).T @ vector if direction else vector
                for vector, direction in zip(entry.vectors, entry.directions, strict=True)
            ),
            entry.directions,
            entry.levels,
        )
        for row, entry in enumerate(markers)
    ]
    for row, body in enumerate(bodies):
        arms = [
            float(np.linalg.norm(vector - body.centre_of_mass))
            for vector, direction in zip(markers[row].vectors, markers[row].directions, strict=True)
            if not direction
        ]
        gyration = math.sqrt(frame[row, PRINCIPAL : PRINCIPAL + 3].max() / body.mass)
        frame[row, REACH] = max([gyration, *arms])
    marker_index = pack_markers(turned, to_principal, constants)
    sensor_index = pack_markers(sensors, to_principal, constants)
    return RigidBodies(index, np.concatenate([np.zeros(0), *constants]), frame, marker_index, sensor_index)


def principal_frame(body: RigidBody) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Centre of mass [m] and principal axes, as columns, of a body in its own frame, as the kind has them."""
    axes = rotation_matrix(quaternion_from_matrix(_principal_axes(body)[1]))
    return np.asarray(body.centre_of_mass, dtype=np.float64), axes


def _principal_axes(body: RigidBody) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Principal inertias [kg m2] and right-handed axes (columns, body frame)."""
    if not body.mass > 0.0:
        raise InputError(f"mass {body.mass} kg", source=body.name, key="mass", expected="a positive mass")
    tensor = np.asarray(body.inertia, dtype=np.float64)
    if not np.allclose(tensor, tensor.T, rtol=1e-12, atol=0.0):
        raise InputError("not symmetric", source=body.name, key="inertia", expected="a symmetric tensor")
    moments, axes = np.linalg.eigh(tensor)
    if moments[0] <= 0.0 or moments[0] + moments[1] < moments[2] * (1.0 - 1e-12):
        raise InputError(
            f"principal inertias {moments} kg m2",
            source=body.name,
            key="inertia",
            expected="positive ones, none larger than the sum of the others",
        )
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] *= -1.0
    return moments, axes


def _marker_data(
    axes: NDArray[np.float64], centre: NDArray[np.float64]
) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """Return a function from a body-frame point to its principal coordinates."""

    def principal(point: NDArray[np.float64]) -> NDArray[np.float64]:
        return axes.T @ (np.asarray(point) - centre)

    return principal
