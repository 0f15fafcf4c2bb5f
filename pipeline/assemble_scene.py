"""From a case and its reduced bodies to the scene that the solver integrates."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble import check_on_body
from heavylift.pipeline.model_io import read_header, read_model, read_reduced
from heavylift.solver import scene as s

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.modal.reduced import ReducedBody
    from heavylift.pipeline.case import Case
    from heavylift.pipeline.case_bodies import (
        Frame,
        InitialSection,
        ProfileSection,
        RigidBodySection,
        RigidInitialSection,
    )
    from heavylift.pipeline.case_sections import PointForceSection
    from heavylift.pipeline.storage import OutputFolder

__all__ = ["assemble_scene", "modal_coordinates"]


def assemble_scene(case: Case, folder: OutputFolder) -> s.Scene:
    """Scene of a case; the reduced bodies are read from its output folder."""
    bodies: list[s.FlexibleBody | s.RigidBody] = []
    origins: dict[str, NDArray[np.float64]] = {}
    for name, body in case.bodies.items():
        if body.type == "rigid":
            rigid, origins[name] = _rigid(name, body)
            bodies.append(rigid)
            continue
        path = folder.reduced(name)
        reduced = read_reduced(path)
        origins[name] = np.array(json.loads(read_header(path)["frame_origin"]))
        ratios = np.array(body.modes.damping_ratio)
        if len(ratios) not in {1, reduced.mode_count}:
            raise InputError(
                f"{len(ratios)} values",
                source=case.file,
                key=f"bodies.{name}.modes.damping_ratio",
                expected=f"1 or {reduced.mode_count}, one a vector of the basis",
            )
        _check_points(case, name, reduced.nodes + origins[name], folder)
        bodies.append(
            s.FlexibleBody(
                name=name,
                reduced=reduced,
                motion=_motion(body.frame),
                modal_position=modal_coordinates(case, name, reduced, body.initial, "modal_position"),
                modal_velocity=modal_coordinates(case, name, reduced, body.initial, "modal_velocity"),
                damping_ratio=np.broadcast_to(ratios, (reduced.mode_count,)).copy(),
                **_initial(body.initial, origins[name]),
            )
        )
    forces: list[s.Gravity | s.PointForce] = []
    if case.gravity is not None:
        forces.append(s.Gravity(np.array(case.gravity.acceleration)))
    forces += [_force(force, origins[force.body]) for force in case.forces]
    sensors = tuple(
        s.Sensor(sensor.name, sensor.body, np.array(sensor.point) - origins[sensor.body])
        for sensor in case.sensors
    )
    return s.Scene(tuple(bodies), tuple(forces), sensors)


def _check_points(case: Case, name: str, nodes: NDArray[np.float64], folder: OutputFolder) -> None:
    """Loaded points and sensors of a flexible body must lie on it, or the nearest node would be far away."""
    mesh, looked = None, False
    points = [(f"forces.{i}.point", force.body, force.point) for i, force in enumerate(case.forces)]
    points += [(f"sensors.{i}.point", sensor.body, sensor.point) for i, sensor in enumerate(case.sensors)]
    for key, owner, point in points:
        if owner != name:
            continue
        near = np.linalg.norm(nodes - np.array(point), axis=1).min()
        if not looked and near > 0.02 * np.ptp(nodes, axis=0).max() and folder.model(name).is_file():
            mesh, looked = read_model(folder.model(name)).mesh, True  # only where the elements decide
        elements = None if mesh is None else mesh.elements
        check_on_body(point, nodes, elements, source=case.file, key=key)


def modal_coordinates(
    case: Case, name: str, reduced: ReducedBody, initial: InitialSection, key: str
) -> NDArray[np.float64]:
    """Initial modal coordinates or speeds for mass-normalised shapes, shape (nf,).

    With scaling ``unit_max`` the case gives the motion of the largest component of each shape; that
    component of the mass-normalised shape, sign included, converts it.
    """
    given: Sequence[float] = getattr(initial, key)
    if len(given) > reduced.mode_count:
        raise InputError(
            f"{len(given)} values",
            source=case.file,
            key=f"bodies.{name}.initial.{key}",
            expected=f"at most {reduced.mode_count}, one a vector of the basis",
        )
    values = np.zeros(reduced.mode_count)
    values[: len(given)] = given
    if initial.modal_scaling == "unit_max":
        flat = reduced.mode_shapes.reshape(reduced.mode_count, -1)
        largest = np.take_along_axis(flat, np.abs(flat).argmax(axis=1)[:, np.newaxis], axis=1)[:, 0]
        values /= largest
    return values


def _rigid(name: str, body: RigidBodySection) -> tuple[s.RigidBody, NDArray[np.float64]]:
    centre = np.array(body.centre_of_mass)
    origin = centre if body.frame.origin == "centre_of_mass" else np.zeros(3)
    rigid = s.RigidBody(
        name=name,
        mass=body.mass,
        inertia=np.array(body.inertia),
        centre_of_mass=centre - origin,
        motion=_motion(body.frame),
        **_initial(body.initial, origin),
    )
    return rigid, origin


def _initial(initial: RigidInitialSection, origin: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Initial state of a frame; by default the body is where its geometry was drawn."""
    orientation = np.array([1.0, 0.0, 0.0, 0.0])
    if initial.orientation is not None:
        from heavylift.numerics.rotation import quaternion_from_rotation_vector

        axis: NDArray[np.float64] = np.array(initial.orientation.axis)
        orientation = quaternion_from_rotation_vector(initial.orientation.angle * axis / np.linalg.norm(axis))
    return {
        "position": origin.copy() if initial.position is None else np.array(initial.position),
        "orientation": orientation,
        "velocity": np.array(initial.velocity or (0.0, 0.0, 0.0)),
        "angular_velocity": np.array(initial.angular_velocity or (0.0, 0.0, 0.0)),
    }


def _motion(frame: Frame) -> s.Motion:
    if frame.motion == "free":
        return s.Free()
    if frame.motion == "fixed":
        return s.Fixed()
    return s.Driven(
        translation=(_profile(frame.x), _profile(frame.y), _profile(frame.z)),
        angle=_profile(frame.angle),
        axis=frame.axis,
        pivot=frame.pivot,
    )


def _profile(profile: ProfileSection[Any] | None) -> s.Profile | None:
    if profile is None:
        return None
    harmonics = tuple(s.Harmonic(h.amplitude, h.frequency, h.phase) for h in profile.harmonics)
    return s.Profile(np.array(profile.times, dtype=float), np.array(profile.values, dtype=float), harmonics)


def _force(force: PointForceSection, origin: NDArray[np.float64]) -> s.PointForce:
    constant = force.force is not None
    return s.PointForce(
        name=force.name,
        body=force.body,
        point=np.array(force.point) - origin,
        times=np.array([0.0]) if constant else np.array(force.times),
        forces=np.array([force.force]) if constant else np.array(force.forces),
        frame=force.frame,
    )
