"""What stands beside frames and shells in pictures of a scene: bodies, lines, springs, joints, contacts, water."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.pictures.contacts import ContactParts
from heavylift.pipeline.pictures.drawings import deformation_scale
from heavylift.pipeline.pictures.mooring_lines import draw_line
from heavylift.pipeline.pictures.parts import Seen
from heavylift.pipeline.pictures.render import Lines, Patch, Points
from heavylift.pipeline.pictures.roads import deck_strips, wheel_axes, wheel_centres
from heavylift.pipeline.pictures.shapes import box_corners, clip_lines, coil, inertia_box, pad
from heavylift.pipeline.pictures.triangles import clip_triangles, drawn_triangles
from heavylift.pipeline.results.rope_lines import rope_tangents
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.forces.spring import Spring
from heavylift.solver.joints.edges import expand_edge
from heavylift.solver.scene.bodies import Fixed
from heavylift.solver.scene.connections import (
    GROUND,
    MEASURES,
    Between,
    EdgeJoint,
    Joint,
    RopePoint,
)
from heavylift.solver.scene.contacts import PointShape
from heavylift.solver.scene.meshes import FrameBody, MeshBody, ShellBody
from heavylift.solver.scene.scenario import loose_ropes
from heavylift.solver.scene.scene import FlexibleBody, RigidBody

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.pictures.meshes import MeshSkin
    from heavylift.pipeline.pictures.outer_surface import Surface
    from heavylift.solver.scene.scene import Scene
    from heavylift.solver.water.waves.wave_trains import WaveTrains

__all__ = [
    "Others",
    "Solid",
    "elevations",
    "rigid_shapes",
    "rods",
    "rope_line",
    "shortest_tree",
    "single_joints",
]

_ROPE, _SPRING, _RIGID, _JOINT = "#7a4a12", "#2e7d32", "#5b6b7c", "#1d2733"
_LINE, _FENDER, _WATER, _SAND, _FLOORING = "#a0522d", "#ef8a17", "#4d8fc4", "#d9c9a3", "#e4e7ea"
_CIRCLE = 32  # corners of a pulley
# relative to the diagonal of the box that bodies move in:
_WIDE = 1.0  # surfaces of the ground up to this size are looked at as a whole
_GROUND_AROUND = 0.5  # wider surfaces of the ground are drawn so far
_WATER_AROUND = 1.5  # and water
_RIGGING = 3.0  # springs and joints so far away are looked at as well
_LINES = 2.0  # mooring lines are drawn so far
_SLIM, _SLIM_BESIDE = 0.015, 0.05  # radius of springs and fenders, and that beside the largest body
_SCATTERED = 30.0  # times the largest body: a scene so wide has a picture of that body alone
_FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 5, 7], [4, 7, 6]])  # two sides of a box of eight corners
_GLASS = 0.3  # opacity of boxes that hide other bodies
_EDGES = np.array(
    [(i, i | bit) for bit in (1, 2, 4) for i in range(8) if not i & bit]
)  # of a box of eight corners
_BESIDE = 0.02  # of the size of a surface: what is attached so near to it is attached to it
_APART = 0.01  # sides of a joint that are farther apart are joined by a line: distances, slides
_LOOKS = 24  # records by which it is seen where bodies get
_SMALL = 1.0e-2  # deformation relative to the scene below which it is drawn larger
_CELLS = 96  # of waves in each direction


class Solid(NamedTuple):
    """Triangles of a body, or of the ground: points in its frame [m], shape (n, 3), and corners, shape (m, 3)."""

    name: str
    body: str
    points: NDArray[np.float64]
    triangles: NDArray[np.int64]


def rigid_shapes(
    scene: Scene,
) -> tuple[list[Solid], dict[str, tuple[NDArray[np.float64], NDArray[np.int64]]]]:
    """Surfaces that bodies and the ground have, and of rigid bodies that have none the boxes of their inertia."""
    solids = [
        Solid(part.name, part.body, *drawn_triangles(part.surface)[:2])
        for part in scene.surfaces
        if part.surface is not None
    ]
    solids += [
        Solid(deck.name, *strip) for deck, strip in zip(scene.decks, deck_strips(scene.decks), strict=True)
    ]
    drawn = {part.body for part in scene.surfaces}
    for hull in () if scene.sea is None else scene.sea.hulls:
        if isinstance(hull.restoring, TriangleSurface) and hull.body not in drawn:
            solids.append(Solid(hull.body, hull.body, *drawn_triangles(hull.restoring)[:2]))
            drawn.add(hull.body)
    drawn |= {contact.body for contact in scene.contacts if not isinstance(contact.shape, PointShape)}
    drawn |= {contour.body for contour in scene.contours}
    boxes = {
        body.name: inertia_box(body.mass, body.inertia, body.centre_of_mass)
        for body in scene.bodies
        if isinstance(body, RigidBody) and body.name not in drawn
    }
    return solids, boxes


def _only_watches(force: Any) -> bool:
    """Whether it measures, and pulls at nothing that could be drawn."""
    return getattr(force, "FAMILY", None) is MEASURES


def shortest_tree(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Pairs of points that join all of them by lines of least length, shape (n - 1, 2)."""
    from scipy.sparse.csgraph import minimum_spanning_tree

    distance = np.linalg.norm(points[:, None] - points[None, :], axis=2)
    # a metre more of each changes no tree; without, points at one place would count as not joined
    tree = minimum_spanning_tree(distance + 1.0).tocoo()
    return np.column_stack([tree.row, tree.col]).astype(np.int64)


def rods(
    scene: Scene, points_of: Mapping[str, Sequence[NDArray[np.float64]]], boxes: Container[str]
) -> list[tuple[str, NDArray[np.float64], NDArray[np.int64]]]:
    """What ties points of rigid bodies together in a picture.

    A star from the centre of mass; of a body that holds a mesh the shortest tree, since a star in a rim would lie
    across the stresses of its shell. The centre is in that tree if the body is a box there.

    Parameters
    ----------
    scene
        Of the bodies.
    points_of
        What is attached, by body, in its frame [m].
    boxes
        Names of bodies that are drawn as boxes.

    Returns
    -------
    Of each rigid body its name, points, shape (n, 3), and pairs of them, shape (m, 2).
    """
    bodies = {body.name: body for body in scene.bodies}
    holding = set()
    for joint in scene.joints:
        for own, other in ((joint.body_a, joint.body_b), (joint.body_b, joint.body_a)):
            if isinstance(bodies.get(other), MeshBody):
                holding.add(own)
    found = []
    for name, given in points_of.items():
        body = bodies.get(name)
        if not isinstance(body, RigidBody):
            continue
        points = np.array([body.centre_of_mass, *given])
        count = len(given)
        if name not in holding:
            pairs = np.column_stack([np.zeros(count, dtype=np.int64), 1 + np.arange(count)])
        elif name in boxes:
            pairs = shortest_tree(points)
        else:
            points = points[1:]
            pairs = shortest_tree(points)
        found.append((name, points, pairs))
    return found


@dataclass(frozen=True, eq=False)
class _Place:
    """A point of a body: in its frame [m], of a mesh the index of the nearest point of its skin."""

    body: str
    point: NDArray[np.float64]
    index: NDArray[np.int64] | None = None


class Others:
    """Draws what is not a mesh at any record.

    Rigid bodies without a surface are boxes of the same mass and moments of inertia. Rods lead from centres of mass to
    whatever is attached, or along what holds a mesh. Around what moves are drawn the ground, water and mooring lines,
    as far as they are near.

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
    times
        Of the records [s], shape (nr,).
    water
        Whether there is a sea.
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
        times: NDArray[np.float64] | None = None,
        water: bool = False,
    ) -> None:
        self._skins, self._coordinates, self._channel = skins, coordinates, channel
        self._times = np.zeros(1) if times is None or not len(times) else times
        self._sea = scene.sea
        self._has_water = water and scene.sea is not None
        self._bodies: dict[str, Any] = {body.name: body for body in scene.bodies}
        self._surfaces = dict(surfaces or {})
        legs = [(rope.name, leg) for rope in scene.ropes for leg in getattr(rope, "legs", [rope.path])]
        self._ropes = [[(self._place(p.body, p.point), p) for p in leg] for _, leg in legs]
        self._rope_names, self._scenario = [name for name, _ in legs], scene.scenario
        self._springs, self._pulls = (
            [
                (self._place(force.body_a, force.point_a), self._place(force.body_b, force.point_b))
                for force in scene.forces
                if isinstance(force, Between)
                and isinstance(force, Spring) == coiled
                and not _only_watches(force)
            ]
            for coiled in (True, False)
        )
        lines, fenders = ((), ()) if scene.sea is None else (scene.sea.lines, scene.sea.fenders)
        self._lines = [
            (line, self._place(line.body_a, line.point_a), self._place(line.body_b, line.point_b))
            for line in lines
        ]
        self._fenders = [(self._place(part.body_a, part.point_a), part.direction) for part in fenders]
        self._joints = [
            (self._place(joint.body_a, joint.frame_a.point), self._place(joint.body_b, joint.frame_b.point))
            for joint in single_joints(scene)
        ]
        pairs = [*self._joints, *self._springs, *self._pulls]
        attached = [place for pair in pairs for place in pair]
        attached += [place for rope in self._ropes for place, _ in rope]
        attached += [place for _, *places in self._lines for place in places]
        solids, self._boxes = rigid_shapes(scene)
        self._rods = self._rods_to(scene, attached)
        self._centres = [
            _Place(name, body.centre_of_mass)
            for name, body in self._bodies.items()
            if isinstance(body, RigidBody)
        ]

        self._touching = [self._place(contact.body, contact.point) for contact in scene.contacts]
        self._solids = [(part.body, part.points, part.triangles) for part in solids]
        self._vehicles = [vehicle for vehicle in scene.transporters if vehicle.wheel_radius > 0.0]
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
        self._factor = 1.0
        self._box = self._moved_box()
        ridden = {vehicle.body for vehicle in self._vehicles}
        self._glass = any(self._encloses(name) or name in ridden for name in self._boxes)
        self._wide = [solid for solid in self._solids if self._is_wide(*solid[:2])]
        self._solids = [solid for solid in self._solids if not self._is_wide(*solid[:2])]
        # a surface holds what is attached to it: a rod would lie across its deck, or hang over it
        near = [(body, *_grown_box(points)) for body, points, _ in self._solids]
        self._rods = [
            (centre, place)
            for centre, place in self._rods
            if not any(
                body == place.body and np.all((place.point >= low) & (place.point <= high))
                for body, low, high in near
            )
        ]
        if not (attached or self._touching or self._fenders or scene.collisions):
            self._factor = self._exaggerated()

    @property
    def boxes(self) -> int:
        """Bodies that are drawn as boxes of their inertia."""
        return len(self._boxes)

    @property
    def centres(self) -> int:
        """Centres of mass that are marked."""
        return len(self._centres)

    @property
    def factor(self) -> float:
        """How many times as large as they are deformations of bodies with modes are drawn."""
        return self._factor

    @property
    def reaches_far(self) -> bool:
        """Whether lines reach beyond what `seen` shows of them."""
        if not self._lines:
            return False
        window = self._window(_WATER_AROUND)
        return any(
            bool(np.any((end < window[0]) | (end > window[1])))
            for _, *places in self._lines
            for end in (self._position(place, 0) for place in places)
        )

    @property
    def empty(self) -> bool:
        """Whether there is nothing but meshes."""
        attached = (
            self._ropes or self._springs or self._pulls or self._joints or self._contacts or self._solids
        )
        return not (
            self._centres or self._surfaces or attached or self._lines or self._fenders or self._has_water
        )

    def _loose(self, record: int) -> set[str]:
        """Names of ropes that are not connected at a record."""
        if self._scenario is None:
            return set()
        keys = ("scenario.phase", "scenario.track_phase")[: 1 + bool(self._scenario.tracks)]
        known = [numbers for key in keys if (numbers := self._channel(key, record)) is not None]
        if len(known) < len(keys):
            return set()
        return loose_ropes(self._scenario, [int(number) for numbers in known for number in np.ravel(numbers)])

    def seen(self, record: int, *, around: bool = True) -> Seen:
        """What is drawn at a record, lengths in metres; `around` adds ground, water and moorings."""
        lines: list[Lines] = []
        far: list[Lines] = []
        for line in (
            self._segments(self._rods, record, _RIGID, 4.0),
            self._segments(self._pulls, record, _SPRING, 2.0),
            *self._coils(record),
            self._joint_lines(record),
        ):
            near = self._is_near(line)
            lines.append(_kept(line, near))
            far.append(_kept(line, ~near))
        for name, rope in zip(self._rope_names, self._ropes, strict=True):
            if name in self._loose(record):
                continue
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
        for vehicle in self._vehicles:
            origin, R = self._pose(vehicle.body, record)
            axle, _ = wheel_axes(vehicle)
            wheels = wheel_centres(vehicle, self._channel(f"{vehicle.name}.stroke_of", record))
            lines += [_circle(origin + R @ wheel, vehicle.wheel_radius, R @ axle) for wheel in wheels]
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
        for name, (points, triangles) in self._boxes.items():
            origin, R = self._pose(name, record)
            box = Patch(origin + points @ R.T, triangles)
            if self._glass:
                box = replace(box, opacity=_GLASS)
                lines.append(Lines(box.points, _EDGES, _RIGID, 1.0))
            patches.append(box)
        for place, normal in self._fenders:
            R = self._pose(place.body, record)[1]
            patches.append(Patch(*pad(self._position(place, record), R @ normal, self._slim), _FENDER))
        if self._contacts is not None:
            contacts = self._contacts.seen(record)
            lines += contacts.lines
            patches += contacts.patches
            marks += contacts.marks
        more = self._around(record, far) if around else ()
        return Seen(tuple(line for line in lines if len(line.ends)), tuple(patches), tuple(marks), more)

    def moorings(self, record: int) -> Seen:
        """The same with all of the mooring lines, for a camera that looks at them, and the bottom that they lie on."""
        seen = self.seen(record, around=False)
        lines = tuple(self._catenary(*line, record) for line in self._lines)
        whole = np.concatenate([seen.points, *(line.points for line in lines)])
        low, high = whole.min(axis=0), whole.max(axis=0)
        margin = 0.05 * (high - low)
        around: list[Lines | Patch] = []
        bottoms = [line.seabed for line, *_ in self._lines if line.seabed is not None]
        if bottoms:
            around.append(Patch(*_plane(low - margin, high + margin, max(bottoms)), _SAND))
        if self._has_water:
            around.append(self._water(record, low - margin, high + margin))
        return Seen((*seen.lines, *lines), seen.patches, seen.marks, tuple(around))

    def _rods_to(self, scene: Scene, attached: Sequence[_Place]) -> list[tuple[_Place, _Place]]:
        """As `rods` has them."""
        points_of: dict[str, list[NDArray[np.float64]]] = {}
        for place in attached:
            points_of.setdefault(place.body, []).append(place.point)
        return [
            (_Place(name, points[a]), _Place(name, points[b]))
            for name, points, pairs in rods(scene, points_of, self._boxes)
            for a, b in pairs.tolist()
        ]

    def _joint_lines(self, record: int) -> Lines:
        """From one side of a joint to the other, where they are apart."""
        found = self._segments(self._joints, record, _JOINT, 1.5)
        lengths = np.linalg.norm(found.points[1::2] - found.points[::2], axis=1)
        return _kept(found, lengths > _APART * self._span)

    def _is_near(self, line: Lines) -> NDArray[np.bool_]:
        """Which connected segments are near enough to be looked at."""
        window = self._window(_RIGGING)
        inside = np.all((line.points >= window[0]) & (line.points <= window[1]), axis=1)
        near = inside[line.ends].all(axis=1)
        connected = len(line.points) != 2 * len(line.ends)
        found: NDArray[np.bool_] = np.full_like(near, near.all()) if connected else near
        return found

    def _coils(self, record: int) -> list[Lines]:
        """Springs."""
        found = []
        for pair in self._springs:
            start, end = (self._position(place, record) for place in pair)
            found.append(Lines(*coil(start, end, self._slim), colour=_SPRING, width=2.0))
        return found

    def _around(self, record: int, far: Sequence[Lines]) -> tuple[Lines | Patch, ...]:
        """Ground, water, and what leads to places far away."""
        found: list[Lines | Patch] = []
        window = self._window(_GROUND_AROUND)
        for _, points, triangles in self._wide:
            near, kept, _ = clip_triangles(points, triangles, window)
            if len(kept):
                found.append(Patch(near, kept, _FLOORING))
        window = self._window(_LINES)
        for line in (*far, *(self._catenary(*line, record) for line in self._lines)):
            points, ends = clip_lines(line.points, line.ends, window)
            if len(ends):
                found.append(Lines(points, ends, line.colour, line.width))
        low, high = self._window(_WATER_AROUND)
        bottoms = {line.seabed for line, *_ in self._lines if line.seabed is not None}
        found += [Patch(*_plane(low, high, z), _SAND) for z in bottoms if low[2] <= z <= high[2]]
        if self._has_water:
            found.append(self._water(record, low, high))
        return tuple(found)

    def _catenary(self, line: Any, anchor: _Place, fairlead: _Place, record: int) -> Lines:
        """A mooring line where it hangs; straight if it has no equilibrium between these ends."""
        ends = self._position(anchor, record), self._position(fairlead, record)
        try:
            points = draw_line(line, *ends).points
        except InputError:
            points = np.array(ends)
        order = np.arange(len(points))
        return Lines(points, np.column_stack([order[:-1], order[1:]]), _LINE, 2.5)

    def _water(self, record: int, low: NDArray[np.float64], high: NDArray[np.float64]) -> Patch:
        """The water, with the undisturbed waves if there are any, seen through."""
        sea = self._sea
        assert sea is not None
        if sea.waves is None:
            return Patch(*_plane(low, high, sea.water.level), _WATER, 0.3)
        x, y = (np.linspace(low[axis], high[axis], _CELLS + 1) for axis in (0, 1))
        X, Y = np.meshgrid(x, y, indexing="ij")
        Z = sea.water.level + elevations(sea.waves, x, y, float(self._times[record]))
        number = np.arange(X.size).reshape(X.shape)
        a, b, c, d = (
            part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
        )
        triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
        return Patch(np.column_stack([X.ravel(), Y.ravel(), Z.ravel()]), triangles, _WATER, 0.45)

    @property
    def scattered(self) -> bool:
        """Whether bodies are so far apart that a picture of all shows none of them."""
        if self._surfaces or self._skins or not self._sizes:
            return False
        return self._span > _SCATTERED * max(self._sizes.values())

    def largest(self, record: int) -> Seen:
        """The largest rigid body alone, for a camera that looks at it."""
        name = max(self._sizes, key=lambda body: self._sizes[body])
        points = [part for body, part, _ in self._solids if body == name]
        points += [self._boxes[name][0]] if name in self._boxes else []
        origin, R = self._pose(name, record)
        corners = origin + box_corners(np.concatenate(points)) @ R.T
        return Seen(patches=(Patch(corners, _FACES),))

    @property
    def _sizes(self) -> dict[str, float]:
        """Diagonals of rigid bodies [m]."""
        solids = [(name, points) for name, points, _ in self._solids if name != GROUND]
        solids += [(name, points) for name, (points, _) in self._boxes.items()]
        return {name: float(np.linalg.norm(np.ptp(points, axis=0))) for name, points in solids}

    @property
    def _slim(self) -> float:
        """Radius of springs and fenders, slender beside the scene and beside bodies that stand far apart [m]."""
        return min(_SLIM * self._span, _SLIM_BESIDE * max(self._sizes.values(), default=np.inf))

    @property
    def _span(self) -> float:
        """Diagonal of the box that bodies move in [m]."""
        return float(np.linalg.norm(self._box[1] - self._box[0])) or 1.0

    def _window(self, share: float) -> NDArray[np.float64]:
        """The box that bodies move in, wider on all sides by a share of its diagonal, shape (2, 3)."""
        widened: NDArray[np.float64] = self._box + share * self._span * np.array([[-1.0], [1.0]])
        return widened

    def _encloses(self, name: str) -> bool:
        """Whether the box of a body hides others at the start: its inertia may be that of a much larger thing."""
        points, _ = self._boxes[name]
        origin, R = self._pose(name, 0)
        sides = points[[4, 2, 1]] - points[0]
        for other, body in self._bodies.items():
            if other == name:
                continue
            if other in self._skins:
                places = self._coordinates(other, 0)[:, 0]
            elif other in self._surfaces:
                places = self._patch(other, 0).points
            else:
                places = self._position(_Place(other, getattr(body, "centre_of_mass", np.zeros(3))), 0)[
                    np.newaxis
                ]
            local = (places - origin) @ R - points[0]
            shares = (local @ sides.T) / np.sum(sides**2, axis=1)
            if np.any(np.all((shares > 0.0) & (shares < 1.0), axis=1)):
                return True
        return False

    def _is_wide(self, name: str, points: NDArray[np.float64]) -> bool:
        """Whether a surface of the ground would make all else small."""
        return name == GROUND and float(np.linalg.norm(np.ptp(points, axis=0))) > _WIDE * self._span

    def _looks(self) -> list[int]:
        last = len(self._times) - 1
        return [int(k) for k in np.unique(np.linspace(0, last, min(_LOOKS, last + 1)).round())]

    def _moved_box(self) -> NDArray[np.float64]:
        """Lowest and highest corner of where bodies get that are free to move; of all bodies if none is."""
        moving = [
            name
            for name, body in self._bodies.items()
            if not isinstance(getattr(body, "motion", None), Fixed)
        ]
        parts: list[NDArray[np.float64]] = []
        corners = {name: [points] for name, (points, _) in self._boxes.items()}
        for name, points, _ in self._solids:
            if name != GROUND:
                corners.setdefault(name, []).append(box_corners(points))
        for name in moving or self._bodies:
            for record in self._looks():
                if name in self._skins:
                    parts.append(self._coordinates(name, record)[:, 0])
                    continue
                origin, R = self._pose(name, record)
                parts += [origin + points @ R.T for points in corners.get(name, ())]
                if name in self._surfaces:
                    parts.append(self._patch(name, record).points)
                parts.append(origin[np.newaxis])
        points = np.concatenate(parts) if parts else np.zeros((1, 3))
        return np.array([points.min(axis=0), points.max(axis=0)])

    def _exaggerated(self) -> float:
        """Round factor for bodies of which neither motion nor deformation would be seen."""
        moved = bent = 0.0
        for name in self._surfaces:
            start = self._patch(name, 0).points
            for record in self._looks():
                moved = max(moved, float(np.abs(self._patch(name, record).points - start).max()))
                u = self._deformation(self._bodies[name], record)
                bent = max(bent, float(np.linalg.norm(u, axis=1).max()))
        if not 0.0 < bent < _SMALL * self._span or moved > _SMALL * self._span:
            return 1.0
        return deformation_scale(np.array([[bent, 0.0, 0.0]]), self._span)

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
        return self._factor * np.tensordot(np.atleast_1d(modal), body.reduced.mode_shapes, axes=1)

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


def _grown_box(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lowest and highest corner of a box around points, and a little more."""
    low, high = points.min(axis=0), points.max(axis=0)
    more = _BESIDE * float(np.linalg.norm(high - low))
    return low - more, high + more


def _kept(line: Lines, which: NDArray[np.bool_]) -> Lines:
    """Some of the segments, with their points alone."""
    used, ends = np.unique(line.ends[which], return_inverse=True)
    return replace(line, points=line.points[used], ends=ends.reshape(-1, 2))


def elevations(
    waves: WaveTrains, x: NDArray[np.float64], y: NDArray[np.float64], time: float
) -> NDArray[np.float64]:
    """Elevation [m] on a grid of coordinates x, shape (n,), and y, shape (m,), [m]: shape (n, m).

    A component is the product of a function of x and one of y, so that a grid is a product of two matrices.
    """
    kx, ky = waves.wavenumber * np.cos(waves.direction), waves.wavenumber * np.sin(waves.direction)
    amplitudes = waves.amplitude * np.exp(-1j * (waves.omega * time + waves.phase))
    along, across = np.exp(1j * np.outer(x, kx)), np.exp(1j * np.outer(ky, y))
    found: NDArray[np.float64] = ((along * amplitudes) @ across).real
    return found


def _plane(
    low: NDArray[np.float64], high: NDArray[np.float64], height: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """A level rectangle: points and triangles."""
    corners = np.array([[x, y, height] for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], dtype=np.float64)
    corners[:, :2] = low[:2] + corners[:, :2] * (high - low)[:2]
    return corners, np.array([[0, 1, 2], [0, 2, 3]])


def rope_line(
    centres: Sequence[NDArray[np.float64]], radii: Sequence[float], axes: Sequence[NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Line of a rope along its tangents and about its pulleys, shape (m, 3).

    Parameters
    ----------
    centres, radii, axes
        Of the pulleys in the order of the rope, ends and eyes with radius zero: [m], [m], unit vectors about which
        the rope turns.
    """
    arrive, leave = rope_tangents(centres, radii, axes)
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


def _circle(centre: NDArray[np.float64], radius: float, axis: NDArray[np.float64]) -> Lines:
    """Circle about the axis of a pulley."""
    u = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    u /= np.linalg.norm(u)
    turns = 2.0 * np.pi * np.arange(_CIRCLE) / _CIRCLE
    circle = np.outer(np.cos(turns), u) + np.outer(np.sin(turns), np.cross(axis, u))
    order = np.arange(_CIRCLE)
    ends = np.column_stack([order, np.roll(order, -1)])
    return Lines(centre + radius * circle, ends, colour=_ROPE, width=1.5)


def single_joints(scene: Scene) -> list[Joint]:
    """Joints at points: along an edge one a node."""
    return [
        part
        for joint in scene.joints
        for part in (expand_edge(joint, scene.bodies) if isinstance(joint, EdgeJoint) else (joint,))
    ]
