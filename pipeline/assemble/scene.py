"""From a case and its reduced bodies to the scene that the solver integrates."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.connections import assemble_joints
from heavylift.pipeline.assemble.described import assemble_list
from heavylift.pipeline.assemble.frames import assemble_rigid, motion_of, start_of_frame
from heavylift.pipeline.assemble.sides import Side, start_sides
from heavylift.pipeline.assemble.water import has_sea
from heavylift.pipeline.case.bodies import FlexibleBodySection
from heavylift.pipeline.case.places import located
from heavylift.pipeline.results.model_io import read_header, read_reduced
from heavylift.solver.scene import scene as s
from heavylift.solver.scene.connections import EdgeJoint
from heavylift.solver.scene.meshes import FrameBody, ShellBody

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

    from heavylift.modal.reduced import ReducedBody
    from heavylift.pipeline.case.bodies import (
        InitialSection,
    )
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.solver.scene.collisions import Collision, CollisionSurface
    from heavylift.solver.scene.connections import Joint
    from heavylift.solver.scene.contacts import Contact, Contour
    from heavylift.solver.scene.scene import AnyBody
    from heavylift.solver.scene.sea import Sea

__all__ = [
    "MEASURED",
    "assemble_scene",
    "gravity_of",
    "modal_coordinates",
    "points_on",
]

MEASURED = ("relative_motions", "leads", "lugs", "hook_loads", "rope_groups")
"""Lists of tables of what only watches, as `heavylift.solver.scene.connections.MEASURES` describes it."""


def assemble_scene(case: Case, folder: OutputFolder) -> s.Scene:
    """Scene of a case; the reduced bodies are read from its output folder.

    Raises
    ------
    InputError
        If something does not fit: shapes, points, or a database and its hull.
    """
    bodies: list[s.FlexibleBody | s.RigidBody | FrameBody | ShellBody] = []
    origins: dict[str, NDArray[np.float64]] = {}
    for name, body in case.bodies.items():
        if body.type == "rigid":
            rigid, origins[name] = assemble_rigid(name, body)
            bodies.append(rigid)
            continue
        if not isinstance(body, FlexibleBodySection):
            origins[name] = np.zeros(3)
            from heavylift.pipeline.assemble.meshes import assemble_frame, assemble_shell

            start = start_of_frame(body.initial, origins[name])
            bodies.append(
                assemble_frame(case, name, body, start)
                if body.type == "frame"
                else assemble_shell(case, name, body, start)
            )
            continue
        path = folder.reduced(name)
        reduced = read_reduced(path)
        origins[name] = np.array(json.loads(read_header(path)["frame_origin"]))
        ratios = np.array(body.modes.damping_ratio)
        if len(ratios) not in {1, reduced.mode_count}:
            raise InputError(
                f"{len(ratios)} values",
                source=case.file,
                key=case.place(f"bodies.{name}.modes.damping_ratio"),
                expected=f"1 or {reduced.mode_count}, one a vector of the basis",
            )
        frequencies = np.sqrt(np.maximum(reduced.eigenvalues, 0.0))
        bodies.append(
            s.FlexibleBody(
                name=name,
                reduced=reduced,
                motion=motion_of(body.frame),
                modal_position=modal_coordinates(case, name, reduced, body.initial, "modal_position"),
                modal_velocity=modal_coordinates(case, name, reduced, body.initial, "modal_velocity"),
                damping_ratio=ratios + 0.5 * body.modes.stiffness_damping * frequencies,
                **start_of_frame(body.initial, origins[name]),
            )
        )
    sides = start_sides(bodies, origins)
    forces: list[Any] = [*gravity_of(case), *assemble_list(case, "forces", sides)]
    for key in MEASURED:
        forces += assemble_list(case, key, sides)
    joints, contacts = assemble_joints(case, sides), _contacts(case, sides)
    edges = _edges(case, joints, bodies)
    for made in bodies:
        if isinstance(made, s.FlexibleBody):
            points = points_on(case, joints, contacts, made.name, origins[made.name])
            points += [
                (place, part.frame_b.point + origins[made.name])
                for place, part in edges
                if part.body_b == made.name
            ]
            _check_points(case, points, made.reduced, origins[made.name])
        elif isinstance(made, (FrameBody, ShellBody)):
            from heavylift.pipeline.assemble.meshes import check_on_mesh, check_pulleys

            for key, point in points_on(case, joints, contacts, made.name, origins[made.name]):
                check_on_mesh(made, point, case.file, key)
            if isinstance(made, FrameBody):
                check_pulleys(case, made)
    scene = s.Scene(
        tuple(bodies),
        tuple(forces),
        tuple(assemble_list(case, "sensors", sides)),
        joints=joints,
        ropes=tuple(assemble_list(case, "ropes", sides)),
        decks=tuple(assemble_list(case, "decks", sides)),
        transporters=tuple(assemble_list(case, "transporters", sides)),
        contours=_contours(case, bodies, sides, folder),
        contacts=contacts,
        surfaces=_surfaces(case, sides, folder),
        collisions=_collisions(case),
        sea=_sea(case, sides, folder),
        scenario=case.operation,
        at_rest=case.begins_at_rest,
    )
    if case.databases:
        from heavylift.pipeline.assemble.afloat import check_afloat
        from heavylift.pipeline.case.places import in_case

        with in_case(case):
            check_afloat(case, scene)
    return scene


def gravity_of(case: Case) -> tuple[s.Gravity, ...]:
    """Gravity of a case as a force; none without."""
    return () if case.gravity is None else (s.Gravity(np.array(case.gravity.acceleration)),)


# cases import only what they have: most have no contours, surfaces or sea


def _contacts(case: Case, sides: Mapping[str, Side]) -> tuple[Contact, ...]:
    if not case.contacts:
        return ()
    from heavylift.pipeline.assemble.contacts import assemble_contacts

    return assemble_contacts(case, sides)


def _contours(
    case: Case, bodies: Sequence[AnyBody], sides: Mapping[str, Side], folder: OutputFolder
) -> tuple[Contour, ...]:
    if not case.contours:
        return ()
    from heavylift.pipeline.assemble.contacts import assemble_contours

    return assemble_contours(case, bodies, sides, folder)


def _surfaces(case: Case, sides: Mapping[str, Side], folder: OutputFolder) -> tuple[CollisionSurface, ...]:
    if not case.surfaces:
        return ()
    from heavylift.pipeline.assemble.collisions import assemble_surfaces

    return assemble_surfaces(case, sides, folder)


def _collisions(case: Case) -> tuple[Collision, ...]:
    if not case.collisions:
        return ()
    from heavylift.pipeline.assemble.collisions import assemble_collisions

    return assemble_collisions(case)


def _sea(case: Case, sides: Mapping[str, Side], folder: OutputFolder) -> Sea | None:
    if not has_sea(case):
        return None
    from heavylift.pipeline.assemble.sea import assemble_sea

    return assemble_sea(case, sides, folder)


def _edges(case: Case, joints: Sequence[Joint], bodies: Sequence[AnyBody]) -> list[tuple[str, Joint]]:
    """Dotted keys of sides b, and joints of all nodes of edges; refuses edges that cannot be joined."""
    found: list[tuple[str, Joint]] = []
    for index, (joint, made) in enumerate(zip(case.joints, joints, strict=True)):
        if isinstance(made, EdgeJoint):
            from heavylift.pipeline.assemble.meshes import joints_of_edge

            with located(case, f"joints.{index}"):
                place = case.place(f"joints.{index}.between.1")
                found += [(place, part) for part in joints_of_edge(joint, made, bodies)]
    return found


def points_on(
    case: Case,
    joints: Sequence[Joint | None],
    contacts: Sequence[Contact | None],
    name: str,
    origin: NDArray[np.float64],
) -> list[tuple[str, ArrayLike]]:
    """Points of a case that a body carries: dotted keys, and places in coordinates of its geometry [m].

    Parameters
    ----------
    case
        The case.
    joints, contacts
        Its joints and contacts, in their order; None for one that could not be assembled.
    name, origin
        The body, and the origin of its frame in the coordinates of its geometry [m], shape (3,).
    """
    found: list[tuple[str, str, ArrayLike]] = []
    for i, sensor in enumerate(case.sensors):
        found.append((f"sensors.{i}.point", sensor.body, sensor.point))
    force: Any
    both = [(f"forces.{i}", force) for i, force in enumerate(case.forces)]
    both += [(f"relative_motions.{i}", motion) for i, motion in enumerate(case.relative_motions)]
    both += [(f"leads.{i}", lead) for i, lead in enumerate(case.leads)]
    for place, force in both:
        if hasattr(force, "point"):
            found.append((f"{place}.point", force.body, force.point))
        elif hasattr(force, "points"):
            sides = zip(force.between, force.points, strict=True)
            found += [(f"{place}.points.{k}", side, point) for k, (side, point) in enumerate(sides)]
    for i, joint in enumerate(joints):
        if joint is None or isinstance(joint, EdgeJoint):
            continue
        at = getattr(case.joints[i], "at", None) is not None
        ends = ((joint.body_a, joint.frame_a), (joint.body_b, joint.frame_b))
        for k, (side, frame) in enumerate(ends):
            found.append((f"joints.{i}.{'at' if at else f'points.{k}'}", side, frame.point + origin))
    for i, rope in enumerate(case.ropes):
        found += [(f"ropes.{i}.path.{k}.point", stop.body, stop.point) for k, stop in enumerate(rope.path)]
    for i, contact in enumerate(contacts):
        if contact is None:
            continue
        key = "point" if case.contacts[i].at is None else "at"
        found.append((f"contacts.{i}.{key}", contact.body, contact.point + origin))
    return [(case.place(key), point) for key, owner, point in found if owner == name]


def _check_points(
    case: Case, points: Sequence[tuple[str, ArrayLike]], reduced: ReducedBody, origin: NDArray[np.float64]
) -> None:
    """Points that a flexible body carries must lie on it; they and the origin in coordinates of the geometry [m]."""
    for key, point in points:
        reduced.locate(np.asarray(point) - origin, source=case.file, key=key, origin=origin)


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
            key=case.place(f"bodies.{name}.initial.{key}"),
            expected=f"at most {reduced.mode_count}, one a vector of the basis",
        )
    values = np.zeros(reduced.mode_count)
    values[: len(given)] = given
    if initial.modal_scaling == "unit_max":
        flat = reduced.mode_shapes.reshape(reduced.mode_count, -1)
        largest = np.take_along_axis(flat, np.abs(flat).argmax(axis=1)[:, np.newaxis], axis=1)[:, 0]
        values /= largest
    return values
