"""What stands beside frames and shells in pictures of a scene: ropes, springs, joints, contacts, other bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.pictures.contacts import ContactParts
from heavylift.pipeline.pictures.render import Lines, Patch, Points
from heavylift.pipeline.pictures.triangles import drawn_triangles
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.joints.edges import expand_edge
from heavylift.solver.scene.connections import (
    GROUND,
    Between,
    EdgeJoint,
    Joint,
    RopePoint,
)
from heavylift.solver.scene.meshes import FrameBody, ShellBody
from heavylift.solver.scene.scene import FlexibleBody, RigidBody

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.pictures.meshes import MeshSkin
    from heavylift.pipeline.pictures.outer_surface import Surface
    from heavylift.solver.scene.scene import Scene

__all__ = ["Others", "Seen", "rope_line"]

_ROPE, _SPRING, _RIGID, _JOINT = "#7a4a12", "#2e7d32", "#5b6b7c", "#1d2733"
_CIRCLE = 32  # corners of a pulley
_TANGENTS = 12  # repetitions until tangents between pulleys are found
_FLOOR = 2.0  # surfaces of the ground are drawn up to so many times the size of the scene and its travel


class Seen(NamedTuple):
    """What is drawn in one colour each: lines, surfaces, marked points."""

    lines: tuple[Lines, ...] = ()
    patches: tuple[Patch, ...] = ()
    marks: tuple[Points, ...] = ()

    @property
    def points(self) -> NDArray[np.float64]:
        """All points, shape (m, 3), for the camera."""
        parts = [part.points for group in self for part in group]
        return np.concatenate(parts) if parts else np.empty((0, 3))


@dataclass(frozen=True, eq=False)
class _Place:
    """A point of a body: in its frame [m], of a mesh the index of the nearest point of its skin."""

    body: str
    point: NDArray[np.float64]
    index: NDArray[np.int64] | None = None


class Others:
    """Draws what is not a mesh at any record.

    Rigid bodies have no shape: they are drawn as rods from their centre of mass to whatever is attached to them.

    Parameters
    ----------
    scene
        What was simulated.
    skins
        Of its frames and shells, by name.
    coordinates
        Vectors of the nodes of a mesh at a record, by name and record.
    channel
        Recorded channel at a record, by name and record; None if it is not recorded.
    surfaces
        Of flexible bodies, in coordinates of their frame, by name; bodies without are left out.
    peak
        Largest force of any contact in the run [N], whose arrow is the longest one.
    size
        Of the scene [m], by which arrows are measured.
    travel
        How far bodies get from where they start [m]; surfaces of the ground are drawn up to twice size and travel.
    """

    def __init__(
        self,
        scene: Scene,
        skins: Mapping[str, MeshSkin],
        coordinates: Callable[[str, int], NDArray[np.float64]],
        channel: Callable[[str, int], NDArray[np.float64] | None],
        surfaces: Mapping[str, Surface] | None = None,
        *,
        peak: float = 0.0,
        size: float = 1.0,
        travel: float = 0.0,
    ) -> None:
        self._skins, self._coordinates, self._channel = skins, coordinates, channel
        self._bodies: dict[str, Any] = {body.name: body for body in scene.bodies}
        self._surfaces = dict(surfaces or {})
        self._ropes = [[(self._place(p.body, p.point), p) for p in rope.path] for rope in scene.ropes]
        self._springs = [
            (self._place(force.body_a, force.point_a), self._place(force.body_b, force.point_b))
            for force in scene.forces
            if isinstance(force, Between)
        ]
        self._joints = [
            (self._place(joint.body_a, joint.frame_a.point), self._place(joint.body_b, joint.frame_b.point))
            for joint in _single_joints(scene)
        ]
        pairs = [*self._joints, *self._springs]
        attached = [place for pair in pairs for place in pair]
        attached += [place for rope in self._ropes for place, _ in rope]
        self._rods = [
            (_Place(place.body, self._bodies[place.body].centre_of_mass), place)
            for place in attached
            if isinstance(self._bodies.get(place.body), RigidBody)
        ]
        self._centres = [
            _Place(name, body.centre_of_mass)
            for name, body in self._bodies.items()
            if isinstance(body, RigidBody)
        ]

        self._touching = [self._place(contact.body, contact.point) for contact in scene.contacts]
        self._solids = [
            (part.body, *drawn_triangles(part.surface)[:2])
            for part in scene.surfaces
            if part.surface is not None
            and (
                part.body != GROUND
                or np.linalg.norm(np.ptp(part.surface.bounds, axis=0)) <= _FLOOR * (size + travel)
            )
        ]
        drawn = {part.body for part in scene.surfaces}
        self._solids += [
            (hull.body, *drawn_triangles(hull.restoring)[:2])
            for hull in (() if scene.sea is None else scene.sea.hulls)
            if isinstance(hull.restoring, TriangleSurface) and hull.body not in drawn
        ]
        self._contacts = None
        if scene.contours:
            self._contacts = ContactParts(
                scene,
                self._pose,
                lambda number, record: self._position(self._touching[number], record),
                channel,
                peak=peak,
                size=size,
            )

    @property
    def empty(self) -> bool:
        """Whether there is nothing but meshes."""
        attached = self._ropes or self._springs or self._joints or self._contacts or self._solids
        return not (self._centres or self._surfaces or attached)

    def seen(self, record: int) -> Seen:
        """What is drawn at a record, lengths in metres."""
        lines = [
            self._segments(self._rods, record, _RIGID, 4.0),
            self._segments(self._springs, record, _SPRING, 2.0),
        ]
        for rope in self._ropes:
            centres = [self._position(place, record) for place, _ in rope]
            axes = [self._axis(place, stop, record) for place, stop in rope]
            radii = [stop.radius for _, stop in rope]
            path = rope_line(centres, radii, axes)
            order = np.arange(len(path))
            lines.append(Lines(path, np.column_stack([order[:-1], order[1:]]), colour=_ROPE, width=2.5))
            lines += [
                _circle(centre, radius, axis)
                for centre, radius, axis in zip(centres, radii, axes, strict=True)
                if radius > 0.0
            ]
        marks = []
        for places, colour, size in (
            ([joint[0] for joint in self._joints], _JOINT, 8.0),
            (self._centres, _RIGID, 14.0),
        ):
            if places:
                found = np.array([self._position(place, record) for place in places])
                marks.append(Points(found, colour=colour, size=size))
        patches = [self._patch(name, record) for name in self._surfaces]
        for name, points, triangles in self._solids:
            origin, R = self._pose(name, record)
            patches.append(Patch(origin + points @ R.T, triangles))
        if self._contacts is not None:
            contacts = self._contacts.seen(record)
            lines += contacts.lines
            patches += contacts.patches
            marks += contacts.marks
        return Seen(tuple(line for line in lines if len(line.ends)), tuple(patches), tuple(marks))

    def _place(self, body: str, point: NDArray[np.float64]) -> _Place:
        if body in self._skins:
            return _Place(body, point, self._skins[body].material_points(np.array([point])))
        return _Place(body, np.asarray(point, dtype=np.float64))

    def _pose(self, name: str, record: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Origin in the world and rotation to world axes of a body that is no mesh."""
        if name == GROUND:
            return np.zeros(3), np.eye(3)
        body = self._bodies[name]
        position = self._channel(f"{name}.position", record)
        orientation = self._channel(f"{name}.orientation", record)
        return (
            body.position if position is None else position,
            rotation_matrix(body.orientation if orientation is None else orientation),
        )

    def _position(self, place: _Place, record: int) -> NDArray[np.float64]:
        if place.index is not None:
            return self._skins[place.body].followed(self._coordinates(place.body, record), place.index)[0]
        origin, R = self._pose(place.body, record)
        body = self._bodies.get(place.body)
        point = place.point
        if isinstance(body, FlexibleBody):
            node = int(np.argmin(np.linalg.norm(body.reduced.nodes - point, axis=1)))
            point = point + self._deformation(body, record)[node]
        moved: NDArray[np.float64] = origin + R @ point
        return moved

    def _deformation(self, body: FlexibleBody, record: int) -> NDArray[np.float64]:
        modal = self._channel(f"{body.name}.modal_position", record)
        if modal is None:
            return np.zeros_like(body.reduced.nodes)
        return np.tensordot(np.atleast_1d(modal), body.reduced.mode_shapes, axes=1)

    def _patch(self, name: str, record: int) -> Patch:
        surface = self._surfaces[name]
        origin, R = self._pose(name, record)
        moved = surface.nodes + surface.pick(self._deformation(self._bodies[name], record))
        return Patch(origin + moved @ R.T, surface.triangles)

    def _segments(self, pairs: list[tuple[_Place, _Place]], record: int, colour: str, width: float) -> Lines:
        ends = [self._position(place, record) for pair in pairs for place in pair]
        points = np.array(ends).reshape(-1, 3)
        return Lines(points, np.arange(len(points)).reshape(-1, 2), colour=colour, width=width)

    def _axis(self, place: _Place, stop: RopePoint, record: int) -> NDArray[np.float64]:
        """Unit axis of a pulley in world axes; of one on a mesh as it was at the start."""
        on_mesh = isinstance(self._bodies.get(place.body), (FrameBody, ShellBody))
        R = np.eye(3) if on_mesh else self._pose(place.body, record)[1]
        axis: NDArray[np.float64] = R @ (stop.axis / np.linalg.norm(stop.axis))
        return axis


def rope_line(
    centres: Sequence[NDArray[np.float64]], radii: Sequence[float], axes: Sequence[NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Line of a rope along its tangents and about its pulleys, shape (m, 3).

    Parameters
    ----------
    centres, radii, axes
        Of the pulleys in the order of the rope, ends and eyes with radius zero: [m], [m], unit vectors about which
        the rope turns.

    Notes
    -----
    A tangent from a point at the distance L touches a circle of radius r at the angle ``arccos(r / L)`` from the
    point, ahead of it where the rope arrives and behind it where it leaves. Two pulleys in a row find their common
    tangent by repetition. What lies outside the plane of a pulley counts by its projection.
    """
    arrive, leave = [np.array(c) for c in centres], [np.array(c) for c in centres]
    for _ in range(_TANGENTS):
        for k, (centre, radius, axis) in enumerate(zip(centres, radii, axes, strict=True)):
            if radius > 0.0 and 0 < k < len(centres) - 1:
                arrive[k] = _tangent_point(centre, radius, axis, leave[k - 1], 1.0)
                leave[k] = _tangent_point(centre, radius, axis, arrive[k + 1], -1.0)
    points = []
    for first, last, centre, radius, axis in zip(arrive, leave, centres, radii, axes, strict=True):
        points.append(first)
        if radius > 0.0:
            u = (first - centre) / radius
            v = np.cross(axis, u)
            angle = float(np.arctan2((last - centre) @ v, (last - centre) @ u)) % (2.0 * np.pi)
            turns = np.linspace(0.0, angle, 2 + int(_CIRCLE * angle / (2.0 * np.pi)))[1:]
            points += [centre + radius * (np.cos(t) * u + np.sin(t) * v) for t in turns]
    return np.array(points)


def _tangent_point(
    centre: NDArray[np.float64],
    radius: float,
    axis: NDArray[np.float64],
    point: NDArray[np.float64],
    side: float,
) -> NDArray[np.float64]:
    """Where the tangent from a point touches a circle."""
    w = point - centre
    w = w - (w @ axis) * axis
    length = float(np.linalg.norm(w))
    if length <= radius:
        return centre + radius * w / max(length, np.finfo(np.float64).tiny)
    toward = w / length
    cosine = radius / length
    e = cosine * toward + side * np.sqrt(1.0 - cosine**2) * np.cross(axis, toward)
    touched: NDArray[np.float64] = centre + radius * e
    return touched


def _circle(centre: NDArray[np.float64], radius: float, axis: NDArray[np.float64]) -> Lines:
    """Circle about the axis of a pulley."""
    u = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    u /= np.linalg.norm(u)
    turns = 2.0 * np.pi * np.arange(_CIRCLE) / _CIRCLE
    circle = np.outer(np.cos(turns), u) + np.outer(np.sin(turns), np.cross(axis, u))
    order = np.arange(_CIRCLE)
    ends = np.column_stack([order, np.roll(order, -1)])
    return Lines(centre + radius * circle, ends, colour=_ROPE, width=1.5)


def _single_joints(scene: Scene) -> list[Joint]:
    """Joints at points: along an edge one a node."""
    return [
        part
        for joint in scene.joints
        for part in (expand_edge(joint, scene.bodies) if isinstance(joint, EdgeJoint) else (joint,))
    ]
