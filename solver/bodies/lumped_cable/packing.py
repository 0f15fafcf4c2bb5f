"""Cables of lumped masses of a scene become arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import records
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.bodies.lumped_cable.kind import CableData, LumpedCables
from heavylift.solver.bodies.lumped_cable.lumped_cable import (
    LumpedCable,
    LumpedCableOutputs,
    LumpedCableParts,
)
from heavylift.solver.body_places import BodyPlaces
from heavylift.solver.markers import BodyMarkers, pack_markers
from heavylift.solver.recording import placed

__all__ = ["pack"]

BESIDE = 1e-6
"""Distance of a point from the line that is none, of the length of the cable."""


def pack(bodies: Sequence[LumpedCable], places: BodyPlaces) -> LumpedCables:
    """Make the kind.

    Raises
    ------
    InputError
        If a point is beside its cable, or something holds a direction on one.
    """
    counts = [body.segments + 1 for body in bodies]
    total = sum(counts)
    table = records(CableData, len(bodies))
    position, velocity, mass = np.zeros((total, 3)), np.zeros((total, 3)), np.zeros(total)
    first, locate = 0, []
    for row, (body, dof, columns) in enumerate(zip(bodies, places.dofs, places.columns, strict=True)):
        cable, R = table[row], rotation_matrix(body.orientation / np.linalg.norm(body.orientation))
        cable.number, cable.dof = places.number + row, dof
        cable.first_node, cable.node_count = first, counts[row]
        cable.column, cable.parts = columns.at(LumpedCableOutputs), placed(LumpedCableParts, columns)
        cable.rest_length = body.rest_length
        cable.stiffness = body.axial_stiffness / body.rest_length
        cable.damping = body.damping_time * cable.stiffness
        cable.pushes = body.carries == "both"
        cable.mass, cable.size = body.mass, body.rest_length * body.segments
        own = slice(first, first + counts[row])
        arms = body.nodes @ R.T
        position[own] = body.position + arms
        velocity[own] = body.velocity + np.cross(R @ body.angular_velocity, arms)
        mass[own] = body.node_masses
        locate.append(_places_on(body, first))
        first += counts[row]
    for body, on_body in zip(bodies, places.markers, strict=True):
        _refuse_directions(body, on_body)
    constants: list[NDArray[np.float64]] = []
    markers = pack_markers(places.markers, locate, constants)
    sensors = pack_markers(places.sensors, locate, constants)
    return LumpedCables(
        table=table,
        constants=np.concatenate([np.zeros(0), *constants]),
        mass=mass,
        position=position,
        velocity=velocity,
        acceleration=np.zeros((total, 3)),
        mid_position=np.zeros((total, 3)),
        load=np.zeros((total, 3)),
        right=np.zeros((total, 3)),
        kept=np.zeros((total, 3)),
        tension=np.zeros(total),
        diagonal=np.zeros((total, 9)),
        coupling=np.zeros((total, 9)),
        markers=markers,
        sensors=sensors,
    )


def _refuse_directions(body: LumpedCable, markers: BodyMarkers) -> None:
    if any(markers.directions):
        raise InputError(
            f"a direction on {body.name!r}, a cable of lumped masses, which has none",
            source=body.name,
            expected="what holds or pulls at points of it alone: ball joints, distances, ropes, springs, forces",
        )


def _places_on(body: LumpedCable, first: int) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """Function from a point in the frame of a cable to its node among all, and the share of the next one."""
    nodes = body.nodes
    chords = np.diff(nodes, axis=0)
    squares = (chords * chords).sum(axis=1)
    allowed = BESIDE * body.rest_length * body.segments

    def place(point: NDArray[np.float64]) -> NDArray[np.float64]:
        given = np.asarray(point, dtype=np.float64)
        shares = np.clip(((given - nodes[:-1]) * chords).sum(axis=1) / squares, 0.0, 1.0)
        distances = np.linalg.norm(nodes[:-1] + shares[:, None] * chords - given, axis=1)
        segment = int(distances.argmin())
        if not distances[segment] <= allowed:
            raise InputError(
                f"point {given.tolist()} m is {distances[segment]:.4g} m beside the cable",
                source=body.name,
                expected="a point on its line at the start, in the frame of the body (are the units right?)",
            )
        return np.array([first + segment, shares[segment]])

    return place
