"""The kind of rigid bodies: centre of mass and principal axes inside, the user's frame outside.

In principal axes through the centre of mass the mass matrix is diagonal and constant. The step
carries the spatial angular momentum ``L = R I w``, so no gyroscopic torque is ever evaluated::

    xb, Rb  from half a step along an arc
    vb = v + h/2 F/m,           wb = I^-1 ( Rb^T L + h/2 t )
    x += h vb,  R := R exp(h wb),  v := 2 vb - v,  L := 2 Rb I wb - L,  w = I^-1 R^T L

Rb is predicted. Where it is off by an angle d, the momentum across the axis of a rod has the part d I2 w2 along it, and
the spin about the axis is wrong by d w2 I2/I1: a rod with I1 far below I2 would spin up by itself, and no step is small
enough. So a slender body carries the momentum about its first axis in its own axes, with the gyroscopic torque at the
predicted spin, which is small, for |I2 - I3| <= I1::

    I1 w1b = I1 w1 + h/2 ( (I2 - I3) w2* w3* + t1 ),      w1 := 2 w1b - w1

The spatial angular momentum then is kept to second order, not to rounding; the energy is ten to a hundred times better.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Quaternion, Records, Vector, records
from heavylift.numerics.rotation import quaternion_from_matrix, rotation_matrix
from heavylift.solver.bodies.frames.base import Frame, FrameBodies, FrameIndex, FrameMotion
from heavylift.solver.drive import DRIVEN, FIXED, FREE, pack_drive
from heavylift.solver.interface import Coordinates
from heavylift.solver.markers import BodyMarkers, pack_markers
from heavylift.solver.scene.bodies import Driven, Fixed, Free, RigidBody

__all__ = ["RigidBodies", "RigidFrame", "RigidFrames", "RigidIndex", "pack_rigid_bodies", "principal_frame"]


SLENDER = 0.05
"""Smallest moment of inertia over the next one, below which a body is slender: where the coupler of a spatial four-bar
has this ratio, errors are 1 to 3 % larger without an axial momentum of its own, and grow with the inverse of it."""


class RigidIndex(FrameIndex):
    """Where a rigid body is among the others.

    Attributes
    ----------
    state_place
        Of position and quaternion in a state vector of the accurate integrator.
    """

    state_place: int


class RigidFrame(Frame, whole_lines=True):
    """What is known of a rigid body. Its frame has the centre of mass as origin, and principal axes.

    Attributes
    ----------
    principal_inertia, inverse_mass, inverse_inertia
        Constants, and reciprocals of them and of the mass [kg, kg m2].
    centre, axes
        Centre of mass [m] and principal axes (quaternion) in the frame of the user.
    arc
        Share of ``h^2 a`` in the midpoint: 1/8 along an arc, 0 along a straight line.
    slender
        Whether the first moment of inertia is so much less than the others that the momentum about that axis is carried
        by itself.
    end
        Motion of a driven body at the end of the step; in records that of the frame of the user.
    """

    principal_inertia: Vector
    inverse_mass: float
    inverse_inertia: Vector
    centre: Vector
    axes: Quaternion
    arc: float
    slender: int
    end: FrameMotion


class RigidFrames(FrameBodies):
    """Base of the kinds of rigid bodies: marker data are points from the centre of mass and directions, principal axes.

    The reach of a body is the distance of what is attached from the centre of mass, at least the radius of gyration.
    """

    kernel_modules: ClassVar[tuple[str, ...]] = (
        *FrameBodies.kernel_modules,
        "heavylift.solver.bodies.rigid.contours",
        "heavylift.solver.bodies.rigid.record",
        "heavylift.solver.bodies.rigid.stage",
        "heavylift.solver.bodies.rigid.step",
    )

    largest_turn: ClassVar[float] = 1.0

    table: Records[RigidIndex]
    frame: Records[RigidFrame]

    def _inertia(self) -> NDArray[np.float64]:
        """Masses and principal inertias."""
        return np.hstack([np.repeat(self.frame["mass"][:, None], 3, axis=1), self.frame["principal_inertia"]])


class RigidBodies(RigidFrames):
    """All rigid bodies of a scene but those that float."""

    kernel_modules: ClassVar[tuple[str, ...]] = (
        *RigidFrames.kernel_modules,
        "heavylift.solver.bodies.rigid.accurate",
    )

    carried_fields: ClassVar[tuple[str, ...]] = ("frame",)

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
        one.slender = int(moments[0] < SLENDER * moments[1])
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
    return RigidBodies(
        table=table,
        constants=np.concatenate([np.zeros(0), *constants]),
        frame=frame,
        markers=marker_index,
        sensors=sensor_index,
        driven=bool((table["motion"] == DRIVEN).any()),
    )


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
