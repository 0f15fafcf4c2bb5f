"""All that can be wrong with the scene of a case before anything is computed, found in one pass.

Finite elements, surfaces of CAD files and databases take time. What needs none of them is assembled here, part by part:
bodies where they are at the start, joints, ropes, forces, sensors, contours of rigid bodies, contacts, waves and lines.
What hangs on a flexible body is left out if its frame begins at a centre of mass that is computed later, unless it
starts at its initial position.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError, InputErrors
from heavylift.pipeline.assemble.connections import assemble_joint
from heavylift.pipeline.assemble.described import assemble
from heavylift.pipeline.assemble.frames import assemble_rigid, motion_of, start_of_frame
from heavylift.pipeline.assemble.scene import (
    MEASURED,
    gravity_of,
    points_on,
)
from heavylift.pipeline.assemble.sides import start_sides
from heavylift.pipeline.case.bodies import FlexibleBodySection
from heavylift.pipeline.case.fields import GROUND
from heavylift.pipeline.case.places import in_case, located
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.scene.connections import EdgeJoint
from heavylift.solver.scene.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from numpy.typing import ArrayLike, NDArray

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


@dataclass(frozen=True, eq=False)
class _Started:
    """A flexible body as far as it is known before it has a mesh: where its frame is at the start."""

    name: str
    motion: Any
    position: NDArray[np.float64]
    orientation: NDArray[np.float64]


class _Scene:
    """What of a scene is known so far, and the errors that were found on the way."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.errors: list[InputError] = []
        self.bodies: dict[str, Any] = {}
        self.origins: dict[str, NDArray[np.float64]] = {}
        for name in case.bodies:
            with self.part(f"bodies.{name}"):
                started = _started(case, name)
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
        return isinstance(self.case.bodies.get(body), FlexibleBodySection)


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
    if not scene.errors and _takes_time(case):
        _pack(scene, made, joints)
    return list({str(error): error for error in scene.errors}.values())


def _started(case: Case, name: str) -> tuple[Any, NDArray[np.float64]] | None:
    """A body at the start, and the origin of its frame in coordinates of its geometry [m]; None if not yet known."""
    body = case.bodies[name]
    if body.type == "rigid":
        return assemble_rigid(name, body)
    origin = np.zeros(3)
    if not isinstance(body, FlexibleBodySection):
        from heavylift.pipeline.assemble.meshes import assemble_frame, assemble_shell

        start = start_of_frame(body.initial, origin)
        if body.type == "frame":
            return assemble_frame(case, name, body, start), origin
        return assemble_shell(case, name, body, start), origin
    _check_numbers_of_modes(body)
    computed = getattr(body.frame, "origin", "geometry") == "centre_of_mass"
    if computed and (body.initial.position is not None or body.initial.orientation is not None):
        return None
    start = start_of_frame(body.initial, origin)
    return _Started(name, motion_of(body.frame), start["position"], start["orientation"]), origin


def _check_numbers_of_modes(body: FlexibleBodySection) -> None:
    """Damping and initial motion of modes have no more entries than the basis has vectors."""
    count = body.modes.vector_count
    if count is None:
        return
    if len(body.modes.damping_ratio) not in {1, count}:
        raise InputError(
            f"{len(body.modes.damping_ratio)} values",
            key="modes.damping_ratio",
            expected=f"1 or {count}, one a vector of the basis",
        )
    for key in ("modal_position", "modal_velocity"):
        values = getattr(body.initial, key)
        if len(values) > count:
            raise InputError(
                f"{len(values)} values",
                key=f"initial.{key}",
                expected=f"at most {count}, one a vector of the basis",
            )


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
        if section.type == "rigid" or (section.type == "flexible" and section.geometry.type != "blocks"):
            continue
        for key, point in points_on(case, joints, contacts, name, scene.origins[name]):
            with scene.part(key):
                if section.type == "flexible":
                    _check_on_blocks(case, section, point, key)
                else:
                    from heavylift.pipeline.assemble.meshes import check_on_mesh

                    check_on_mesh(body, point, case.file, key)
        if section.type == "frame":
            from heavylift.pipeline.assemble.meshes import check_pulleys

            with scene.part(f"bodies.{name}"):
                check_pulleys(case, body)


def _check_on_blocks(case: Case, body: FlexibleBodySection, point: ArrayLike, key: str) -> None:
    """Refuse a point farther from all blocks than from a mesh of them."""
    from heavylift.preprocess.finite_elements.mesh import BESIDE

    geometry = body.geometry
    assert geometry.type == "blocks"
    place = np.asarray(point, dtype=np.float64)
    low, high = (np.array([getattr(block, side) for block in geometry.add]) for side in ("lower", "upper"))
    distance = np.linalg.norm(np.maximum(np.maximum(low - place, place - high), 0.0), axis=1).min()
    extent = float((high.max(axis=0) - low.min(axis=0)).max())
    if distance > BESIDE * extent:
        words = ", ".join(f"{1e3 * value:.6g}" for value in place)
        raise InputError(
            f"point ({words}) mm is not on the body: it is {1e3 * distance:.6g} mm away from its blocks",
            source=case.file,
            key=key,
            expected=f"a point on the body, to {BESIDE:.0%} of its largest extent of {1e3 * extent:.6g} mm, in the "
            "coordinates of the geometry (are the units right?)",
        )


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
        any(isinstance(body, FlexibleBodySection) for body in case.bodies.values())
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
