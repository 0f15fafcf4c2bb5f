"""What stands on a hull at the start: its own mass, and those of all free bodies that joints connect to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.case.joined import joined_to_hull, shared_with_hulls
from heavylift.solver.scene.joined import joined_bodies, shared_bodies
from heavylift.solver.scene.scene import FlexibleBody, Free, RigidBody

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.solver.scene.scene import Scene

__all__ = ["Loading", "case_loading", "scene_loading"]


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
    """

    mass: float
    centre: NDArray[np.float64]
    bodies: tuple[str, ...]
    left_out: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class _Load:
    """A body at the start: mass [kg], None if nobody counts it, and centre of mass in the world [m], shape (3,)."""

    name: str
    mass: float | None
    place: NDArray[np.float64]
    why_not: str = ""


def scene_loading(scene: Scene, hulls: Iterable[str], name: str) -> Loading:
    """Of a hull of a scene, with the names of all hulls.

    Notes
    -----
    Bodies hang together by joints of any kind; they are taken where they are at the start, as if rigidly fixed. Other
    hulls are carried by their own water, and what they carry with this one is left out: shares are not known.
    """
    free = {body.name for body in scene.bodies if isinstance(getattr(body, "motion", Free()), Free)}
    pairs = [(joint.body_a, joint.body_b) for joint in scene.joints]
    group, beyond = joined_bodies(name, free, pairs, set(hulls))
    shared = shared_bodies(name, free, pairs, list(hulls))
    hull = next(body for body in scene.bodies if body.name == name)
    assert isinstance(hull, RigidBody)
    return _sum(hull, [_of_body(body) for body in scene.bodies if body.name in group], beyond, shared)


def case_loading(case: Case, name: str, folder: OutputFolder) -> Loading:
    """The same before there is a scene, as databases need it: flexible bodies from meshes, with what hangs on it."""
    from heavylift.pipeline.assemble.scene import assemble_rigid

    group, beyond = joined_to_hull(case, name)
    section = case.bodies[name]
    assert section.type == "rigid"
    hull, _ = assemble_rigid(name, section)
    loads = [_of_section(case, other, folder) for other in case.bodies if other in group]
    hanging = case.hulls[name].hanging if name in case.hulls else None
    if hanging is not None:
        origin = np.array(section.centre_of_mass) if section.frame.origin == "centre_of_mass" else np.zeros(3)
        place = hull.position + rotation_matrix(hull.orientation) @ (np.array(hanging.point) - origin)
        loads.append(_Load("what hangs on ropes", hanging.mass, place))
    return _sum(hull, loads, beyond, shared_with_hulls(case, name))


def _sum(
    hull: RigidBody, loads: Iterable[_Load], beyond: Iterable[str], shared: Mapping[str, Sequence[str]]
) -> Loading:
    """One mass in the frame of the hull."""
    axes = rotation_matrix(hull.orientation)
    total, moment, counted, left = 0.0, np.zeros(3), [], []
    for load in loads:
        if load.name in shared:
            left.append(f"{load.name} ({' and '.join(map(repr, shared[load.name]))} carries a part of it)")
            continue
        if load.name != hull.name:
            counted.append(load.name)
        if load.mass is None:
            left.append(f"{load.name} ({load.why_not})")
            continue
        total += load.mass
        moment += load.mass * (axes.T @ (load.place - hull.position))
    left += [f"joints to {other}" for other in sorted(beyond)]
    return Loading(total, moment / total, tuple(sorted(counted)), tuple(left))


MESHES = "frame or shell"


def _of_body(body: Any) -> _Load:
    if isinstance(body, RigidBody):
        mass, centre = body.mass, np.asarray(body.centre_of_mass, dtype=np.float64)
    elif isinstance(body, FlexibleBody):
        integrals = body.reduced.integrals
        mass = float(integrals.mass)
        centre = np.asarray(integrals.first_moment, dtype=np.float64) / mass
    else:
        return _Load(body.name, None, np.zeros(3), MESHES)
    return _Load(body.name, mass, body.position + rotation_matrix(body.orientation) @ centre)


def _of_section(case: Case, name: str, folder: OutputFolder) -> _Load:
    from heavylift.pipeline.assemble.scene import assemble_rigid, start_of_frame

    section = case.bodies[name]
    if section.type == "rigid":
        return _of_body(assemble_rigid(name, section)[0])
    if section.type != "flexible":
        return _Load(name, None, np.zeros(3), MESHES)
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
