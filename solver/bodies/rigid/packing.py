"""Rigid bodies of a scene become arrays: principal axes, markers, drives; what is refused of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.records import records
from heavylift.numerics.rotation import quaternion_from_matrix, rotation_matrix
from heavylift.solver.bodies.frames.base import SLENDER
from heavylift.solver.bodies.rigid.kind import RigidBodies, RigidFrame, RigidIndex
from heavylift.solver.body_places import BodyPlaces
from heavylift.solver.drive import DRIVEN, FIXED, FREE, pack_drive
from heavylift.solver.markers import BodyMarkers, pack_markers
from heavylift.solver.scene.bodies import Driven, Fixed, Free, HeldOutputs, RigidBody
from heavylift.solver.scene.outputs import Columns

__all__ = ["pack", "pack_rigid_bodies", "principal_frame"]


def pack(bodies: Sequence[RigidBody], places: BodyPlaces) -> RigidBodies:
    """Make the kind of some bodies of a scene."""
    return pack_rigid_bodies(
        bodies, places.number, places.dofs[0], places.columns, places.markers, places.sensors
    )


def pack_rigid_bodies(
    bodies: Sequence[RigidBody],
    first_number: int,
    first_dof: int,
    columns: Sequence[Columns],
    markers: Sequence[BodyMarkers],
    sensors: Sequence[BodyMarkers],
) -> RigidBodies:
    """Make the kind from what the user said."""
    table = records(RigidIndex, len(bodies))
    frame = records(RigidFrame, len(bodies))
    constants: list[NDArray[np.float64]] = []
    for row, (body, place) in enumerate(zip(bodies, columns, strict=True)):
        moments, axes = _principal_axes(body)
        one = frame[row]
        one.mass, one.inverse_mass = body.mass, 1.0 / body.mass
        one.principal_inertia[:], one.inverse_inertia[:] = moments, 1.0 / moments
        one.centre[:], one.axes[:] = body.centre_of_mass, quaternion_from_matrix(axes)
        one.arc = 0.125
        one.slender = int(moments[0] < SLENDER * moments[1])
        entry = table[row]
        entry.dof, entry.number = first_dof + 6 * row, first_number + row
        entry.motion = {Free: FREE, Fixed: FIXED, Driven: DRIVEN}[type(body.motion)]
        entry.drive = sum(map(len, constants))
        entry.column, entry.held = place, place.at(HeldOutputs)
        if isinstance(body.motion, Driven):
            constants.append(pack_drive(body.motion, body.position, body.orientation))
        R = rotation_matrix(body.orientation)
        arm = R @ body.centre_of_mass
        one.position[:] = body.position + arm
        one.orientation[:] = quaternion_from_matrix(R @ axes)
        if isinstance(body.motion, Free):
            one.velocity[:] = body.velocity + np.cross(R @ body.angular_velocity, arm)
            one.spin[:] = axes.T @ body.angular_velocity
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
    moments, axes = np.linalg.eigh(np.asarray(body.inertia, dtype=np.float64))
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
