"""From a case and its reduced bodies to the scene that the solver integrates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.assemble.connections import assemble_joints
from heavylift.pipeline.assemble.described import assemble_list
from heavylift.pipeline.assemble.sides import Side, start_sides
from heavylift.pipeline.assemble.water import has_sea
from heavylift.pipeline.case.places import located
from heavylift.solver.scene import scene as s
from heavylift.solver.scene.connections import EdgeJoint

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

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
    bodies: list[AnyBody] = []
    origins: dict[str, NDArray[np.float64]] = {}
    for name, body in case.bodies.items():
        made, origins[name] = body.assembly.assemble_body(case, name, body, folder)
        bodies.append(made)
    sides = start_sides(bodies, origins)
    forces: list[Any] = [*gravity_of(case), *assemble_list(case, "forces", sides)]
    for key in MEASURED:
        forces += assemble_list(case, key, sides)
    joints, contacts = assemble_joints(case, sides), _contacts(case, sides)
    edges = _edges(case, joints, bodies)
    for made in bodies:
        points = points_on(case, joints, contacts, made.name, origins[made.name])
        points += [
            (place, part.frame_b.point + origins[made.name])
            for place, part in edges
            if part.body_b == made.name and not made.SEEN_AT_POINTS
        ]
        case.bodies[made.name].assembly.check_points(case, made, origins[made.name], points)
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
        surfaces=_surfaces(case, bodies, sides, folder),
        collisions=_collisions(case),
        sea=_sea(case, sides, folder),
        scenario=case.operation,
        at_rest=case.begins_at_rest,
        inputs=tuple(assemble_list(case, "inputs", sides)),
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


def _surfaces(
    case: Case, bodies: Sequence[AnyBody], sides: Mapping[str, Side], folder: OutputFolder
) -> tuple[CollisionSurface, ...]:
    if not case.surfaces:
        return ()
    from heavylift.pipeline.assemble.collisions import assemble_surfaces

    return assemble_surfaces(case, bodies, sides, folder)


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
    both += [(f"inputs.{i}", one) for i, one in enumerate(case.inputs)]
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
