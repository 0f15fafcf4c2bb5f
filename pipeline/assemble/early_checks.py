"""All that can be wrong with the scene of a case before anything is computed, found in one pass.

Finite elements, surfaces of CAD files and databases take time. What needs none of them is assembled here, part by part:
bodies where they are at the start, joints, ropes, forces, sensors, contours of rigid bodies, contacts, waves and lines.
What hangs on a flexible body is left out if its frame begins at a centre of mass that is computed later, unless it
starts at its initial position.
"""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import InputError, InputErrors
from heavylift.pipeline.assemble.connections import assemble_joint
from heavylift.pipeline.assemble.described import assemble
from heavylift.pipeline.assemble.scene import (
    MEASURED,
    gravity_of,
    points_on,
)
from heavylift.pipeline.assemble.sides import start_sides
from heavylift.pipeline.case.fields import GROUND
from heavylift.pipeline.case.places import in_case, located
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.scene.connections import EdgeJoint
from heavylift.solver.scene.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    import numpy as np
    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case

__all__ = ["scene_errors"]

DESCRIBED = (
    "forces",
    "sensors",
    *MEASURED,
    "ropes",
    "tanks",
    "pumps",
    "controllers",
    "fluid_loads",
    "fenders",
    "decks",
    "transporters",
)
"""Lists of tables that `heavylift.pipeline.assemble.described.assemble` takes as they are."""


class _Scene:
    """What of a scene is known so far, and the errors that were found on the way."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.errors: list[InputError] = []
        self.bodies: dict[str, Any] = {}
        self.origins: dict[str, NDArray[np.float64]] = {}
        for name in case.bodies:
            with self.part(f"bodies.{name}"):
                section = case.bodies[name]
                started = section.assembly.start_body(case, name, section)
                if started is not None:
                    self.bodies[name], self.origins[name] = started
        self.sides = start_sides(list(self.bodies.values()), self.origins)

    @contextlib.contextmanager
    def part(self, key: str) -> Iterator[None]:
        """Keep the errors of a part, with its place in the case file."""
        try:
            with located(self.case, key):
                yield
        except InputErrors as error:
            self.errors += error.errors
        except InputError as error:
            self.errors.append(error)

    def parts(self, key: str, make: Callable[[Any], Any]) -> list[Any]:
        """What entries of a list of tables make; None for one that is wrong or hangs on a body not yet known."""
        found: list[Any] = []
        for index, section in enumerate(getattr(self.case, key)):
            made = None
            if _sides_of(section) <= set(self.sides):
                with self.part(f"{key}.{index}"):
                    made = make(section)
            found.append(made)
        return found

    def is_solid(self, body: str) -> bool:
        """Whether a body has a finite element model."""
        section = self.case.bodies.get(body)
        return section is not None and section.BODY.MODAL


def scene_errors(case: Case) -> list[InputError]:
    """Errors of a scene, each with its place in the case file; empty if nothing is wrong so far."""
    scene = _Scene(case)
    sides = scene.sides
    rests = case.begins_at_rest
    made = {
        key: scene.parts(key, lambda section: assemble(section, sides, case.folder, "", rests))
        for key in DESCRIBED
    }
    joints = scene.parts("joints", lambda section: assemble_joint(case, section, sides))
    contacts: list[Any] = []
    if case.contacts:
        from heavylift.pipeline.assemble.contacts import assemble_contact

        contacts = scene.parts("contacts", lambda section: assemble_contact(section, sides, case.folder))
    if case.lines:
        from heavylift.pipeline.assemble.lines import assemble_line

        deep = (
            case.sea is None or case.sea.depth is None
        )  # lines on a missing bottom are reported with the case
        scene.parts(
            "lines",
            lambda line: None if deep and line.on_seabed else assemble_line(case, line, sides),
        )
    _check_points(scene, joints, contacts)
    _check_edges(scene, joints)
    _check_contours(scene)
    if case.sea is not None:
        from heavylift.pipeline.assemble.sea import make_waves

        with scene.part("sea"):
            make_waves(case)
    if case.fmus:
        from heavylift.pipeline.coupling.fmus import check_fmu

        scene.parts("fmus", lambda section: check_fmu(section, case.folder))
    if not scene.errors and _takes_time(case):
        _pack(scene, made, joints)
    return list({str(error): error for error in scene.errors}.values())


def _sides_of(section: Any) -> set[str]:
    """Bodies that an entry refers to; of contacts the second one is a contour."""
    if hasattr(section, "path"):
        return {stop.body for stop in section.path}
    if hasattr(section, "between"):
        return set(section.between[:1] if hasattr(section, "shape") else section.between)
    name = getattr(section, "body", getattr(section, "hull", None))
    return set() if name is None else {name}


def _check_points(scene: _Scene, joints: list[Any], contacts: list[Any]) -> None:
    """Points lie on frames, shells, and on flexible bodies of parametric blocks."""
    case = scene.case
    for name, body in scene.bodies.items():
        section = case.bodies[name]
        points = points_on(case, joints, contacts, name, scene.origins[name])
        with scene.part(f"bodies.{name}"):
            for key, error in section.assembly.check_drawn_points(case, section, body, points):
                with scene.part(key):
                    raise error


def _check_edges(scene: _Scene, joints: list[Any]) -> None:
    """Joints of all nodes of edges can be made, if the other side is no solid."""
    for index, (section, made) in enumerate(zip(scene.case.joints, joints, strict=True)):
        if isinstance(made, EdgeJoint) and not any(map(scene.is_solid, section.between)):
            from heavylift.pipeline.assemble.meshes import joints_of_edge

            with scene.part(f"joints.{index}"):
                joints_of_edge(section, made, list(scene.bodies.values()))


def _check_contours(scene: _Scene) -> None:
    """Contours of what is no solid."""
    case = scene.case
    folder = OutputFolder(
        case.output_folder
    )  # of which nothing is read: only contours of solids have nodes of models
    for name, section in case.contours.items():
        if section.body in scene.sides and not scene.is_solid(section.body):
            from heavylift.pipeline.assemble.contacts import assemble_contours

            alone = case.model_copy(update={"contours": {name: section}})
            with scene.part(f"contours.{name}"):
                assemble_contours(alone, list(scene.bodies.values()), scene.sides, folder)


def _takes_time(case: Case) -> bool:
    """Whether there is much to compute before the solver sees the scene."""
    return (
        any(body.BODY.MODAL for body in case.bodies.values())
        or any(database.compute is not None for database in case.databases.values())
        or any(surface.file is not None for surface in case.surfaces)
    )


def _pack(scene: _Scene, made: Mapping[str, list[Any]], joints: list[Any]) -> None:
    """Refuse what the solver refuses of all that hangs on no solid, as axes that disagree or sides that cannot move.

    What is packed has the gravity of the whole scene. What is left out (solids and all that hangs on them, surfaces,
    contacts, the sea, the operation) must not be needed by what stays: that is left out too.
    """
    case = scene.case
    bodies = [body for name, body in scene.bodies.items() if not scene.is_solid(name)]
    names = {body.name for body in bodies} | {GROUND}

    def known(key: str, entries: list[Any]) -> list[Any]:
        pairs = zip(getattr(case, key), entries, strict=True)
        return [entry for section, entry in pairs if entry is not None and _sides_of(section) <= names]

    if not bodies:
        return
    held = known("joints", joints)
    along = {joint.name for joint in held}
    forces: list[Any] = [*gravity_of(case)]
    forces += [
        force for force in known("forces", made["forces"]) if getattr(force, "joint", None) in {None, *along}
    ]
    ropes = known("ropes", made["ropes"])
    pulling = {rope.name for rope in ropes}
    for key in MEASURED:
        watching = known(key, made[key])
        forces += [one for one in watching if pulling.issuperset(getattr(one, "watched_ropes", ()))]
    decks, transporters = known("decks", made["decks"]), known("transporters", made["transporters"])
    road_known = len(decks) == len(case.decks)
    from heavylift.solver.layout import pack_scene

    with scene.part("case"), in_case(case):
        pack_scene(
            Scene(
                tuple(bodies),
                tuple(forces),
                tuple(known("sensors", made["sensors"])),
                joints=tuple(held),
                ropes=tuple(ropes),
                decks=tuple(decks),
                transporters=tuple(transporters) if road_known else (),
                at_rest=case.begins_at_rest,
            ),
            "dele2",
            0.0,
        )
