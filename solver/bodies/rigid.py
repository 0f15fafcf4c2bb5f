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
from typing import Annotated, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Quaternion, Record, Records, Vector, Vector6, records
from heavylift.numerics.rotation import quaternion_from_matrix, rotation_matrix
from heavylift.solver.drive import DRIVEN, FIXED, FREE, pack_drive
from heavylift.solver.interface import Coordinates
from heavylift.solver.markers import BodyMarkers, PackedMarker, pack_markers
from heavylift.solver.scene_bodies import Driven, Fixed, Free, RigidBody

__all__ = [
    "RigidBodies",
    "RigidFrame",
    "RigidFrames",
    "RigidIndex",
    "RigidMotion",
    "pack_rigid_bodies",
    "principal_frame",
]


class RigidIndex(Record):
    """Where a rigid body is among the others.

    Attributes
    ----------
    dof
        First velocity.
    motion
        `FREE`, `FIXED` or `DRIVEN`.
    drive
        Start of its drive in the constants.
    column
        First record column.
    number
        Of the body.
    state_place
        Of position and quaternion in a state vector of the accurate integrator.
    """

    dof: int
    motion: int
    drive: int
    column: int
    number: int
    state_place: int


class RigidMotion(Record):
    """Motion of a principal frame, whose origin is the centre of mass.

    Attributes
    ----------
    position, velocity, acceleration
        Of the centre of mass, world axes [m, m/s, m/s2].
    orientation
        Quaternion of the principal axes.
    spin, spin_rate
        Angular velocity and acceleration in principal axes [rad/s, rad/s2].
    pose, twist
        Position and orientation; velocity and spin.
    """

    position: Vector
    orientation: Quaternion
    velocity: Vector
    spin: Vector
    acceleration: Vector
    spin_rate: Vector
    pose: Annotated[NDArray[np.float64], (7,), "position"]
    twist: Annotated[NDArray[np.float64], (6,), "velocity"]


class RigidFrame(RigidMotion, whole_lines=True):
    """What is known of a rigid body: its carried state, constants and the scratch of a step.

    Attributes
    ----------
    angular_momentum
        About the centre of mass, world axes [kg m2/s].
    external_work, drive_work
        Of forces and of the drive [J].
    mass, principal_inertia, inverse_mass, inverse_inertia
        Constants, and their reciprocals [kg, kg m2].
    centre, axes
        Centre of mass [m] and principal axes (quaternion) in the frame of the body.
    reach
        Distance of what is attached from the centre of mass, at least the radius of gyration [m].
    arc
        Share of ``h^2 a`` in the midpoint: 1/8 along an arc, 0 along a straight line.
    mid_position, mid_velocity, mid_spin, mid_rotation
        The stage in the middle of a step; rotation matrix, row by row.
    force, moment
        Resultant (world axes) and moment about the centre of mass (principal axes) of all marker forces.
    wrench
        Force and moment.
    drive_pose, drive_rates
        Pose, velocities and accelerations that a drive prescribes to the frame of the body.
    mean_twist
        Mean velocity and spin of a driven body over a step.
    end
        Motion of a driven body at the end of the step.
    joint_force
        Force and moment of the rows on a held body, as of a marker.
    """

    angular_momentum: Vector
    external_work: float
    drive_work: float
    mass: float
    principal_inertia: Vector
    inverse_mass: float
    inverse_inertia: Vector
    centre: Vector
    axes: Quaternion
    reach: float
    arc: float
    mid_position: Vector
    mid_velocity: Vector
    mid_spin: Vector
    force: Vector
    moment: Vector
    mid_rotation: Annotated[NDArray[np.float64], (9,)]
    wrench: Annotated[NDArray[np.float64], (6,), "force"]
    drive_pose: Annotated[NDArray[np.float64], (7,)]
    drive_rates: Annotated[NDArray[np.float64], (12,)]
    mean_twist: Vector6
    end: RigidMotion
    joint_force: Vector6


class RigidFrames(Protocol):
    """What kinds of rigid bodies share."""

    @property
    def table(self) -> Records[RigidIndex]:
        """As in `RigidBodies`."""

    @property
    def frame(self) -> Records[RigidFrame]:
        """As in `RigidBodies`."""


class RigidBodies(Arrays):
    """All rigid bodies of a scene.

    Attributes
    ----------
    table, frame
        What is known of each.
    constants
        Drives and marker data: points from the centre of mass and directions, in principal axes.
    markers, sensors
        As in the kind of floating frames.
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

    carried_fields: ClassVar[tuple[str, ...]] = ("frame",)

    table: Records[RigidIndex]
    constants: Floats1
    frame: Records[RigidFrame]
    markers: Records[PackedMarker]
    sensors: Records[PackedMarker]

    def place_coordinates(self, place: int) -> tuple[Records[Coordinates], int]:
        """Coordinates in a state vector of the accurate integrator, from a place on, and the place behind them."""
        table, found = self.table, records(Coordinates, len(self.table))
        table["state_place"] = place + 7 * np.arange(len(table))
        found["number"], found["motion"] = table["number"], table["motion"]
        found["place"], found["velocity"] = table["state_place"], table["dof"]
        found["reach"] = self.frame["reach"]
        return found, place + 7 * len(table)

    def write_state(self, values: Floats1) -> None:
        """Carried state into a state vector."""
        for one, frame in zip(self.table, self.frame, strict=True):
            values[one.dof : one.dof + 6] = frame.twist
            values[one.state_place : one.state_place + 7] = frame.pose


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
    table = records(RigidIndex, len(bodies))
    frame = records(RigidFrame, len(bodies))
    constants: list[NDArray[np.float64]] = []
    column = first_column
    for row, body in enumerate(bodies):
        moments, axes = _principal_axes(body)
        one = frame[row]
        one.mass, one.inverse_mass = body.mass, 1.0 / body.mass
        one.principal_inertia[:], one.inverse_inertia[:] = moments, 1.0 / moments
        one.centre[:], one.axes[:] = body.centre_of_mass, quaternion_from_matrix(axes)
        one.arc = 0.125
        motion = {Free: FREE, Fixed: FIXED, Driven: DRIVEN}[type(body.motion)]
        table[row] = first_dof + 6 * row, motion, sum(map(len, constants)), column, first_number + row, 0
        if isinstance(body.motion, Driven):
            constants.append(pack_drive(body.motion, body.position, body.orientation))
        R = rotation_matrix(body.orientation)
        arm = R @ body.centre_of_mass
        one.position[:] = body.position + arm
        one.orientation[:] = quaternion_from_matrix(R @ axes)
        if isinstance(body.motion, Free):
            one.velocity[:] = body.velocity + np.cross(R @ body.angular_velocity, arm)
            one.spin[:] = axes.T @ body.angular_velocity
        column += 13 if isinstance(body.motion, Free) else 19
    to_principal = [
        _marker_data(rotation_matrix(frame[row].axes), body.centre_of_mass) for row, body in enumerate(bodies)
    ]
    turned = [
        BodyMarkers(
            entry.numbers,
            tuple(
                rotation_matrix(frame[row].axes).T @ vector if direction else vector
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
        gyration = math.sqrt(frame[row].principal_inertia.max() / body.mass)
        frame[row].reach = max([gyration, *arms])
    marker_index = pack_markers(turned, to_principal, constants)
    sensor_index = pack_markers(sensors, to_principal, constants)
    return RigidBodies(table, np.concatenate([np.zeros(0), *constants]), frame, marker_index, sensor_index)


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
