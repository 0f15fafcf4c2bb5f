"""What stands on a hull at the start: its own mass, and those of all free bodies that joints connect to it.

Of a body that a joint holds at p and that lies with a line bearing at q on something else, as a link beam, the bearing
carries ``m (c - p) . d / |d|^2`` of its mass m with the centre c, d the horizontal way from p to q. That acts at q, the
rest at p.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.assemble.frames import assemble_rigid, start_of_frame
from heavylift.pipeline.case.connectivity import connected_to_hull, shared_with_hulls
from heavylift.solver.force_elements.line_bearing import LineBearing
from heavylift.solver.joints.packing import start_frames
from heavylift.solver.scene.connections import GROUND, MEASURES, as_joint
from heavylift.solver.scene.connectivity import connected_bodies, shared_bodies
from heavylift.solver.scene.scene import Free, RigidBody

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.solver.scene.connections import Joint
    from heavylift.solver.scene.scene import Scene

__all__ = ["Loading", "case_loading", "pulling", "scene_loading", "sides_of"]


@dataclass(frozen=True, eq=False)
class Loading:
    """What a hull carries at the start, without its tanks.

    Attributes
    ----------
    mass, centre
        [kg]; centre of gravity in the frame of the hull [m], shape (3,).
    bodies
        Names of the bodies that are joined to the hull, beside itself.
    left_out
        Words for what holds or loads the hull and is not counted.
    parts
        Of bodies that are counted in part: mass [kg], and where it acts in the frame of the hull [m], by name.
    """

    mass: float
    centre: NDArray[np.float64]
    bodies: tuple[str, ...]
    left_out: tuple[str, ...]
    parts: Mapping[str, tuple[float, NDArray[np.float64]]]


@dataclass(frozen=True, eq=False)
class _Load:
    """A body at the start: mass [kg], None if nobody counts it, and centre of mass in the world [m], shape (3,)."""

    name: str
    mass: float | None
    place: NDArray[np.float64]
    why_not: str = ""
    partial: bool = False


class _Tie(NamedTuple):
    """What connects two bodies, or one and the ground, and where in the world [m]: a joint, or a line bearing.

    Of a bearing the first side carries.
    """

    sides: tuple[str, str]
    place: NDArray[np.float64]


def scene_loading(scene: Scene, hulls: Iterable[str], name: str) -> Loading:
    """Of a hull of a scene, with the names of all hulls.

    Notes
    -----
    Bodies hang together by joints of any kind; they are taken where they are at the start, as if rigidly fixed. Other
    hulls are carried by their own water, and what they carry with this one is left out: shares are not known.
    """
    free = {body.name for body in scene.bodies if isinstance(getattr(body, "motion", Free()), Free)}
    pairs = [(joint.body_a, joint.body_b) for joint in scene.joints]
    group, beyond = connected_bodies(name, free, pairs, set(hulls))
    shared = shared_bodies(name, free, pairs, list(hulls))
    hull: Any = next(body for body in scene.bodies if body.name == name)
    joints = [_Tie(pair, _place(joint, scene)) for pair, joint in zip(pairs, scene.joints, strict=True)]
    resting = (force for force in scene.forces if isinstance(force, LineBearing))
    bearings = [_Tie((one.body_a, one.body_b), _place(as_joint(one), scene)) for one in resting]
    loads = [_of_body(body) for body in scene.bodies if body.name in free]
    carried, unknown = _carried(loads, group, joints, bearings)
    return _sum(hull, carried, beyond, shared, unknown)


def pulling(scene: Scene) -> list[Any]:
    """Ropes and forces of a scene that load bodies and are not counted by `scene_loading`.

    What only watches loads nothing, and what a line bearing carries is counted.
    """
    return [
        one
        for one in (*scene.ropes, *scene.forces)
        if getattr(type(one), "FAMILY", None) is not MEASURES and not isinstance(one, LineBearing)
    ]


def sides_of(one: Any) -> set[str]:
    """Bodies on which a rope, a force or a line acts."""
    path = getattr(one, "path", None)
    if path is not None:
        return {stop.body for stop in path}
    sides = (getattr(one, key, None) for key in ("body", "body_a", "body_b"))
    return {side for side in sides if isinstance(side, str)}


def _place(joint: Joint, scene: Scene) -> NDArray[np.float64]:
    """Of the point of side b of a joint, in the world at the start [m]."""
    return start_frames(joint, scene.bodies)[1].point


def _carried(
    loads: Sequence[_Load], group: Collection[str], joints: Sequence[_Tie], bearings: Sequence[_Tie]
) -> tuple[list[_Load], list[str]]:
    """Loads on a group of bodies, of what lies on something else or on the group in part; words for unknown parts."""
    found = {load.name: load for load in loads if load.name in group}
    unknown: list[str] = []
    for (carrier, name), q in bearings:
        load = next((load for load in loads if load.name == name), None)
        if load is None or load.mass is None or (carrier in group) == (name in group):
            continue
        held = [tie.place for tie in joints if name in tie.sides]
        way = q - held[0] if len(held) == 1 else np.zeros(3)
        way[2] = 0.0
        if not way @ way > 0.0:
            if name in group:
                unknown.append(f"what {carrier!r} carries of {name} (it has not one joint)")
            continue
        part = min(max(float((load.place - held[0]) @ way / (way @ way)), 0.0), 1.0)
        mass, place = (load.mass * part, q) if carrier in group else (load.mass * (1.0 - part), held[0])
        found[name] = _Load(name, mass, place, partial=True)
    return list(found.values()), unknown


def case_loading(case: Case, name: str, folder: OutputFolder) -> Loading:
    """The same before there is a scene, as databases need it: flexible bodies from meshes, with what hangs on it."""
    group, beyond = connected_to_hull(case, name)
    section = case.bodies[name]
    hull, _ = assemble_rigid(name, section)
    lying = {force.between[1] for force in case.forces if force.type == "line_bearing"}
    loads = [_of_section(case, other, folder) for other in case.bodies if other in group | lying]
    joints = [
        _Tie(joint.between, place) for joint in case.joints if (place := _drawn(case, joint)) is not None
    ]
    bearings = [
        _Tie(force.between, place)
        for force in case.forces
        if force.type == "line_bearing" and (place := _drawn(case, force)) is not None
    ]
    loads, unknown = _carried(loads, group, joints, bearings)
    hanging = case.hulls[name].hanging if name in case.hulls else None
    if hanging is not None:
        origin = np.array(section.drawn_origin)
        place = hull.position + rotation_matrix(hull.orientation) @ (np.array(hanging.point) - origin)
        loads.append(_Load("what hangs on ropes", hanging.mass, place))
    return _sum(hull, loads, beyond, shared_with_hulls(case, name), unknown)


def _drawn(case: Case, tie: Any) -> NDArray[np.float64] | None:
    """Where a joint or bearing of a case is in the world [m]; None if it is not on a rigid body."""
    if getattr(tie, "at", None) is not None:
        return np.array(tie.at, dtype=np.float64)
    section = case.bodies.get(tie.between[1])
    if getattr(tie, "points", None) is None or (
        tie.between[1] != GROUND and (section is None or section.BODY.DEFORMS)
    ):
        return None
    point = np.array(tie.points[1], dtype=np.float64)
    if section is None or section.BODY.DEFORMS:
        return point
    body, origin = assemble_rigid(tie.between[1], section)
    return body.position + rotation_matrix(body.orientation) @ (point - origin)


def _sum(
    hull: RigidBody,
    loads: Iterable[_Load],
    beyond: Iterable[str],
    shared: Mapping[str, Sequence[str]],
    unknown: Sequence[str],
) -> Loading:
    """One mass in the frame of the hull."""
    axes = rotation_matrix(hull.orientation)
    total, moment, counted, left, parts = 0.0, np.zeros(3), [], [*unknown], {}
    for load in loads:
        if load.name in shared:
            left.append(f"{load.name} ({' and '.join(map(repr, shared[load.name]))} carries a part of it)")
            continue
        if load.name != hull.name:
            counted.append(load.name)
        if load.mass is None:
            left.append(f"{load.name} ({load.why_not})")
            continue
        place = axes.T @ (load.place - hull.position)
        if load.partial:
            parts[load.name] = load.mass, place
        total += load.mass
        moment += load.mass * place
    left += [f"joints to {other}" for other in sorted(beyond)]
    return Loading(total, moment / total, tuple(sorted(counted)), tuple(left), parts)


def _of_body(body: Any) -> _Load:
    known = body.mass_properties
    if known is None:
        return _Load(body.name, None, np.zeros(3), body.NOUN)
    mass, centre = known[0], np.asarray(known[1], dtype=np.float64)
    return _Load(body.name, mass, body.position + rotation_matrix(body.orientation) @ centre)


def _of_section(case: Case, name: str, folder: OutputFolder) -> _Load:
    section = case.bodies[name]
    if not section.BODY.MODAL:
        return _of_body(section.assembly.start_body(case, name, section)[0])
    if not folder.model(name).is_file():
        return _Load(name, None, np.zeros(3), "flexible, without a mesh in this folder")
    from heavylift.pipeline.results.model_io import read_model

    model = read_model(folder.model(name))
    shares = model.mass @ np.ones(len(model.nodes))
    centre = shares @ model.nodes / shares.sum()
    origin = centre if section.frame.origin == "centre_of_mass" else np.zeros(3)
    start = start_of_frame(section.initial, origin)
    place = start["position"] + rotation_matrix(start["orientation"]) @ (centre - origin)
    return _Load(name, float(shares.sum()), place)
