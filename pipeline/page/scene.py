"""The scene of a case as the interactive page, and files for other programs, show it: what is drawn and how it moves.

Rigid bodies move by their recorded pose, bodies with modes by modal coordinates and mode shapes, frames and shells by
the shapes that their recorded nodes give; all else is fixed to points of them. What is drawn where comes from the same
places as in pictures (`heavylift.pipeline.pictures.attached`).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.pictures.attached import rigid_shapes, rods, single_joints
from heavylift.pipeline.pictures.camera import plane_view
from heavylift.pipeline.pictures.contacts import contour_parts
from heavylift.pipeline.pictures.drawings import deformation_scale, round_down
from heavylift.pipeline.pictures.meshes import MeshSkin, frame_radius, rest_coordinates, stress_scale
from heavylift.pipeline.pictures.mooring_lines import draw_line
from heavylift.pipeline.pictures.outer_surface import feature_edges, surface_from_mesh
from heavylift.pipeline.pictures.parts import shape_parts
from heavylift.pipeline.pictures.roads import wheel_axes, wheel_centres
from heavylift.pipeline.pictures.shapes import coil, pad
from heavylift.pipeline.pictures.triangles import clip_triangles
from heavylift.pipeline.results.mesh_motion import mesh_coordinates
from heavylift.pipeline.results.rope_lines import rope_tangents
from heavylift.solver.forces.spring import Spring
from heavylift.solver.scene.bodies import Fixed
from heavylift.solver.scene.connections import GROUND, Between
from heavylift.solver.scene.contacts import CylinderShape, SphereShape
from heavylift.solver.scene.meshes import FrameBody, ShellBody
from heavylift.solver.scene.scenario import loose_ropes
from heavylift.solver.scene.scene import FlexibleBody, RigidBody

if TYPE_CHECKING:
    from collections.abc import Container, Sequence

    from numpy.typing import ArrayLike, NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.solver.scene.scene import Scene

__all__ = ["Arrows", "Line", "SceneMotion", "Surface", "WaterShape", "scene_motion", "scene_up"]

POSES = 12_001
"""Records at which bodies are placed, at most."""
SHAPE_BYTES = 6_000_000
"""Of recorded shapes and their stresses, before compression."""
ARROW_BYTES = 2_500_000
"""Of forces at contacts, before compression."""
SHAPES = 400
"""Records at which shapes are recorded, at most."""
MOORINGS = 600
"""Mooring lines times records at which their shape is found, at most."""
TRIANGLES = 120_000
"""Drawn of the whole scene at most; surfaces with more are thinned."""

_COARSE = 5000  # triangles of a surface while it is played on a slow machine
_EDGES = 60_000  # triangles up to which edges are drawn
_KINK = np.radians(30.0)
_RIGGING = 5.0  # ropes, springs and joints within so many sizes of the scene are looked at as well
_LOOKS = 24  # records by which it is seen where bodies get
_GONE = 1.0e4  # a body so many sizes of the scene away from where it began has left it
_THIN = 4.0e-3  # radius of a frame relative to the scene below which it is drawn larger
_SKIN = 6000  # points of one frame or shell, if its elements allow it
_ARC = 9  # points of a rope about a pulley
_CELLS = 56  # of the water in each direction
_WAVES = 1200  # components of the waves at most
_COLOURS = ("#9fb6cc", "#d3b98a", "#a9c3a4", "#c4a9bf", "#b7bcc4", "#d2a79a", "#93bfc0", "#c9c391")
_GROUND, _ROPE, _LINE, _SPRING, _JOINT = "#e4e7ea", "#7a4a12", "#a0522d", "#2e7d32", "#1d2733"
_FENDER, _TOUCH, _FORCE, _SAND, _BALLAST, _WHEEL = (
    "#ef8a17",
    "#c9a227",
    "#c62828",
    "#d9c9a3",
    "#3a7bb0",
    "#4a5560",
)
_CONTACT = re.compile(r"^(.+)\.contact_\d+\.normal$")


@dataclass(eq=False)
class Pose:
    """Motion of the frame of a body: position [m], shape (k, 3), unit quaternion, shape (k, 4), centre of mass.

    What has left the scene is no number.
    """

    name: str
    position: NDArray[np.float64]
    orientation: NDArray[np.float64]
    centre: NDArray[np.float64]

    @property
    def matrices(self) -> NDArray[np.float64]:
        """Rotations to world axes, shape (k, 3, 3)."""
        q = self.orientation / np.linalg.norm(self.orientation, axis=1, keepdims=True)
        w, x, y, z = q.T
        rows = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
        return np.moveaxis(np.array(rows), -1, 0)

    def matrices_at(self, k: int) -> NDArray[np.float64]:
        """Rotation to world axes at one of the poses, shape (3, 3)."""
        return rotation_matrix(self.orientation[k])

    def world(self, local: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points of the body, shape (3,) or (k, 3), in the world, shape (k, 3)."""
        found: NDArray[np.float64] = self.position + np.einsum(
            "kij,kj->ki", self.matrices, np.broadcast_to(local, self.position.shape)
        )
        return found

    def local(self, world: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points of the world, shape (k, ..., 3), in axes of the body."""
        shape = (len(self.position),) + (1,) * (world.ndim - 2) + (3,)
        return np.einsum("kji,k...j->k...i", self.matrices, world - self.position.reshape(shape))


@dataclass(eq=False)
class Surface:
    """Triangles in the axes of a body, or of the world if `body` is -1, rigid or with a shape that changes.

    Attributes
    ----------
    name, group
        What it belongs to, and of what sort that is.
    points, triangles, edges
        [m], shape (n, 3); corners, shape (m, 3); kinks, shape (e, 2).
    coarse
        Corners of fewer triangles between the same points, for a machine that is slow, shape (m', 3).
    modes, amplitudes
        Displacements, shape (nf, n, 3), and how much of each at the poses, shape (k, nf).
    shapes
        Points at the shapes' records, shape (k2, n, 3).
    stress
        [Pa], of frames alone with sign, shape (k2, n).
    anchor
        Surface and point whose displacement carries it.
    offset, size
        Displacement in axes of the body, shape (k, 3), and scale about the origin, shape (k,), at the poses.
    at
        Where it stands in axes of the body.
    """

    name: str
    group: str
    body: int
    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    colour: str
    opacity: float = 1.0
    edges: NDArray[np.int64] | None = None
    coarse: NDArray[np.int64] | None = None
    modes: NDArray[np.float64] | None = None
    amplitudes: NDArray[np.float64] | None = None
    shapes: NDArray[np.float64] | None = None
    stress: NDArray[np.float64] | None = None
    anchor: tuple[int, int] | None = None
    offset: NDArray[np.float64] | None = None
    size: NDArray[np.float64] | None = None
    at: NDArray[np.float64] | None = None


@dataclass(eq=False)
class Line:
    """Points fixed to bodies, or moving in their axes, in a row; or joined by segments.

    Attributes
    ----------
    on
        Body of each point, -1 for the world, shape (p,).
    local
        In its axes [m], shape (p, 3), or (k, p, 3) on the timeline.
    surface, vertex
        Surface and point whose displacement is added, -1 for none, shape (p,).
    radius
        Of the tube [m]; 0 for thin segments.
    ends
        Points of the segments, shape (e, 2).
    timeline
        Of `local`: 0 the poses, 2 that of mooring lines.
    tension, loose
        Force [N] and whether it is not there, at the poses, shape (k,).
    coiled
        Whether it is a spring between its two points.
    """

    name: str
    group: str
    on: NDArray[np.int64]
    local: NDArray[np.float64]
    colour: str
    surface: NDArray[np.int64] | None = None
    vertex: NDArray[np.int64] | None = None
    radius: float = 0.0
    ends: NDArray[np.int64] | None = None
    timeline: int = 0
    tension: NDArray[np.float64] | None = None
    loose: NDArray[np.bool_] | None = None
    coiled: bool = False
    hidden: bool = False


@dataclass(eq=False)
class Arrows:
    """Forces at points of the world on the last timeline: [m] and [N], both of shape (k, c, 3)."""

    name: str
    place: NDArray[np.float64]
    force: NDArray[np.float64]


@dataclass(eq=False)
class WaterShape:
    """A window on the water, with its undisturbed waves by components."""

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    level: float
    waves: dict[str, NDArray[np.float64]] | None


@dataclass(eq=False)
class SceneMotion:
    """All that is drawn of a scene and how it moves.

    Attributes
    ----------
    times
        Four timelines [s]: of poses, of shapes, of mooring lines, of forces at contacts.
    box
        Lowest and highest corner of where bodies get [m], shape (2, 3).
    largest
        Diagonal of the largest body [m].
    scale
        How many times as large as they are deformations are drawn at first.
    labels
        Name, body, point and text.
    notes
        What was left out or drawn otherwise than it is.
    """

    times: list[NDArray[np.float64]]
    up: NDArray[np.float64]
    poses: list[Pose] = field(default_factory=list)
    surfaces: list[Surface] = field(default_factory=list)
    lines: list[Line] = field(default_factory=list)
    arrows: list[Arrows] = field(default_factory=list)
    water: WaterShape | None = None
    box: NDArray[np.float64] = field(default_factory=lambda: np.array([[-1.0] * 3, [1.0] * 3]))
    view: NDArray[np.float64] = field(default_factory=lambda: np.array([0.55, -0.75, 0.36]))
    largest: float = np.inf
    scale: float = 1.0
    signed: bool = False
    labels: list[tuple[str, int, NDArray[np.float64], str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    @property
    def size(self) -> float:
        """Diagonal of the box [m]."""
        return float(np.linalg.norm(self.box[1] - self.box[0])) or 1.0

    @property
    def radius(self) -> float:
        """Of tubes that stand for ropes, slender beside the scene and beside bodies that stand far apart [m]."""
        return min(2.0e-3 * self.size, 0.02 * self.largest)


def scene_up(case: Case) -> NDArray[np.float64] | None:
    """Direction against gravity, or out of the water; None without both."""
    if case.gravity is None or not any(case.gravity.acceleration):
        return None if case.sea is None else np.array([0.0, 0.0, 1.0])
    return -np.array(case.gravity.acceleration)


def scene_motion(
    case: Case, stages: OutputFolder, scene: Scene, results: Results | None, *, marked: bool = False
) -> SceneMotion:
    """Everything that is drawn of a scene, at its records, or as it is put together if there are none.

    Parameters
    ----------
    case, stages
        The case and its output folder.
    scene
        What was simulated, or will be.
    results
        Its time histories; finite, or None.
    marked
        Whether joints, sensors, ropes and contacts have labels too, as before a run.
    """
    return _Builder(case, stages, scene, results, marked=marked).build()


class _Builder:
    """Collects the parts; see `scene_motion`."""

    def __init__(
        self, case: Case, stages: OutputFolder, scene: Scene, results: Results | None, *, marked: bool
    ) -> None:
        self.case, self.stages, self.scene, self.marked = case, stages, scene, marked
        self.results = results if results is not None and len(results.time) else None
        count = 1 if self.results is None else len(self.results.time)
        self.records = _spread(count, POSES)
        times = np.zeros(1) if self.results is None else self.results.time[self.records]
        up = scene_up(case)
        axis = np.eye(3)[2] if up is None else np.eye(3)[int(np.argmax(np.abs(up)))]
        self.motion = SceneMotion(
            [times, times, times, times], axis if up is None else np.sign(up @ axis) * axis
        )
        if len(self.records) < count:
            self.motion.notes.append(
                f"Bodies are placed at {len(self.records):,} of {count:,} records; between them they are interpolated."
            )
        self.index: dict[str, int] = {GROUND: -1}
        self.deformed: dict[str, int] = {}  # surface of a body whose points move
        self.bodies: dict[str, Any] = {body.name: body for body in scene.bodies}

    def build(self) -> SceneMotion:
        """The whole scene."""
        self._poses()
        self._deformable()
        solids, boxes = rigid_shapes(self.scene)
        self._find_box(solids, boxes)
        self._leave()
        self._rigid(solids, boxes)
        self._contours()
        self._ropes()
        self._connections(boxes)
        self._vehicles()
        self._sea()
        self._forces()
        self._widen()
        self._thin()
        self._name()
        self._scale()
        return self.motion

    # what records say

    def _values(self, name: str, records: NDArray[np.int64] | None = None) -> NDArray[np.float64] | None:
        """A channel at the poses, or at some records, shape (k, c); None if it is not recorded."""
        if self.results is None or name not in self.results:
            return None
        values = self.results[name]
        return values.reshape(len(values), -1)[self.records if records is None else records]

    def _poses(self) -> None:
        count = len(self.records)
        for body in self.scene.bodies:
            if isinstance(body, (FrameBody, ShellBody)):
                self.index[body.name] = -1
                continue
            position = self._values(f"{body.name}.position")
            orientation = self._values(f"{body.name}.orientation")
            if position is None or orientation is None:
                position, orientation = np.atleast_2d(body.position), np.atleast_2d(body.orientation)
                position, orientation = (np.repeat(part, count, axis=0) for part in (position, orientation))
            centre = np.asarray(getattr(body, "centre_of_mass", np.zeros(3)), dtype=np.float64)
            self.index[body.name] = len(self.motion.poses)
            self.motion.poses.append(Pose(body.name, np.array(position), np.array(orientation), centre))

    def _leave(self) -> None:
        """Bodies that are farther away than any scene are not drawn from then on."""
        for pose in self.motion.poses:
            far = np.linalg.norm(pose.position - pose.position[0], axis=1)
            gone = ~(far < _GONE * self.motion.size)
            if gone.any():
                first = int(np.argmax(gone))
                pose.position[first:] = np.nan
                self.motion.notes.append(
                    f"{pose.name} has left: from t = {self.motion.times[0][first]:.6g} s on it is more than "
                    f"{_GONE:,.0f} sizes of the scene away, and is not drawn."
                )

    # bodies

    def _deformable(self) -> None:
        bodies = [body for body in self.scene.bodies if not isinstance(body, RigidBody)]
        modal = [body for body in bodies if isinstance(body, FlexibleBody)]
        surfaces: dict[str, Any] = {}
        for body in modal:
            try:
                mesh = read_mesh(self.stages, body.name)
            except InputError as error:
                self.motion.notes.append(f"{body.name} is not drawn: {error.problem}.")
                continue
            if mesh is None:
                self.motion.notes.append(f"{body.name} has no elements and is not drawn.")
                continue
            surfaces[body.name] = surface_from_mesh(mesh)
        meshes = [body for body in bodies if isinstance(body, (FrameBody, ShellBody))]
        skins = {body.name: self._skin(body) for body in meshes}
        points = sum(len(skin.skin(rest_coordinates(skin.body)).points) for skin in skins.values())
        values = points * 7 + sum(len(surface.nodes) for surface in surfaces.values())
        most = int(np.clip(SHAPE_BYTES // max(values, 1), 20, SHAPES))
        shown = self.records[_spread(len(self.records), most)]
        self.shapes = shown
        if self.results is not None:
            self.motion.times[1] = self.results.time[shown]
        if values and len(shown) < len(self.records):
            what = "shapes and stresses" if points else "stresses"
            self.motion.notes.append(
                f"Recorded {what} are those of {len(shown):,} of {len(self.results.time) if self.results else 1:,} "
                "records."
            )
        self.motion.signed = bool(meshes) and not modal and all(isinstance(b, FrameBody) for b in meshes)
        for body in modal:
            if body.name in surfaces:
                self._modal(body, surfaces[body.name])
        for mesh_body in meshes:
            self._mesh(mesh_body, skins[mesh_body.name])

    @staticmethod
    def _skin(body: FrameBody | ShellBody) -> MeshSkin:
        return MeshSkin(body, most=_SKIN)

    def _modal(self, body: FlexibleBody, surface: Any) -> None:
        nodes = body.reduced.nodes[surface.node_indices]
        triangles, kept = _thinned(nodes, surface.triangles, TRIANGLES // 2)
        if len(kept) < len(nodes):
            self._say_thinned(body.name, len(surface.triangles), len(triangles))
            nodes, chosen = nodes[kept], surface.node_indices[kept]
            edges = feature_edges(nodes, triangles, _KINK, wound=False)
        else:
            chosen, edges = surface.node_indices, surface.feature_edges
        amplitudes = self._values(f"{body.name}.modal_position")
        if amplitudes is None:
            amplitudes = np.repeat(np.atleast_2d(body.modal_position), len(self.records), axis=0)
        stress = None
        now = self._values(f"{body.name}.modal_position", self.shapes)
        if now is not None:
            from heavylift.pipeline.checks.stresses import SolidStresses

            try:
                stress = SolidStresses(body.name, self.stages, self.case.file).fields(now, chosen)
            except InputError as error:
                self.motion.notes.append(f"No stresses of {body.name}: {error.problem}.")
        self.deformed[body.name] = len(self.motion.surfaces)
        self.motion.surfaces.append(
            Surface(
                body.name,
                "bodies",
                self.index[body.name],
                nodes,
                triangles,
                self._colour(body.name),
                edges=edges,
                modes=body.reduced.mode_shapes[:, chosen],
                amplitudes=amplitudes,
                stress=stress,
            )
        )

    def _mesh(self, body: FrameBody | ShellBody, skin: MeshSkin) -> None:
        rest = rest_coordinates(body) @ rotation_matrix(body.orientation).T
        rest[:, 0] += body.position
        shapes, stress = None, None
        shape = None if self.results is None else self.results.meshes.get(body.name)
        if isinstance(body, FrameBody):
            span = float(np.linalg.norm(np.ptp(rest[:, 0], axis=0)))
            share = frame_radius(body) / span if span > 0.0 else 1.0
            if share < _THIN:
                skin.widening = max(1.0, round_down(1.5 * _THIN / share))
                self.motion.notes.append(
                    f"{body.name} is drawn with {skin.widening:g} times its radius, to be seen."
                )
        if shape is not None:
            assert self.results is not None
            found = []
            for record in self.shapes:
                nodes = mesh_coordinates(shape, self.results, slice(int(record), int(record) + 1))[0]
                found.append(skin.skin(nodes))
            shapes = np.array([one.points for one in found])
            stress = np.array([one.values for one in found])
        first = skin.skin(rest)
        self.deformed[body.name] = len(self.motion.surfaces)
        edges = first.outline if len(first.outline) else None
        self.motion.surfaces.append(
            Surface(
                body.name,
                "bodies",
                -1,
                first.points,
                first.triangles,
                self._colour(body.name),
                edges=edges,
                shapes=shapes,
                stress=stress,
            )
        )

    def _colour(self, name: str) -> str:
        names = [body.name for body in self.scene.bodies]
        return _GROUND if name == GROUND else _COLOURS[names.index(name) % len(_COLOURS)]

    def _rigid(self, solids: Sequence[Any], boxes: dict[str, Any]) -> None:
        span = self.motion.size
        window = self.motion.box + 0.5 * span * np.array([[-1.0], [1.0]])
        for part in solids:
            points, triangles, name = part.points, part.triangles, part.body
            if part.body == GROUND:
                name = part.name
                if float(np.linalg.norm(np.ptp(points, axis=0))) > span:
                    points, triangles, _ = clip_triangles(points, triangles, window)
                    self.motion.notes.append(f"{name} is drawn as far as bodies get near it.")
            self._add(name, "ground" if part.body == GROUND else "bodies", part.body, points, triangles)
        around = {name: self._world_box(name, points) for name, (points, _) in boxes.items()}
        for name, (points, triangles) in boxes.items():
            opacity = 1.0
            low, high = around[name]
            for pose in self.motion.poses:
                at = pose.world(pose.centre)[0]
                if pose.name != name and np.all((at > low) & (at < high)):
                    opacity = 0.35
            self._add(name, "bodies", name, points, triangles, opacity=opacity)
        if boxes:
            self.motion.notes.append(
                f"Boxes of the same mass and inertia stand for {_some(list(boxes))}, without a surface."
            )

    def _world_box(self, name: str, points: NDArray[np.float64]) -> tuple[Any, Any]:
        pose = self.motion.poses[self.index[name]]
        at = pose.position[0] + points @ pose.matrices[0].T
        return at.min(axis=0), at.max(axis=0)

    def _add(
        self,
        name: str,
        group: str,
        body: str,
        points: NDArray[np.float64],
        triangles: NDArray[np.int64],
        *,
        colour: str = "",
        opacity: float = 1.0,
        edges: bool = True,
        **more: Any,
    ) -> None:
        if not len(triangles):
            return
        self.motion.surfaces.append(
            Surface(
                name,
                group,
                self.index[body],
                np.asarray(points, dtype=np.float64),
                np.asarray(triangles, dtype=np.int64),
                colour or self._colour(body),
                opacity,
                edges=np.empty((0, 2), dtype=np.int64) if edges else None,
                **more,
            )
        )

    def _find_box(self, solids: Sequence[Any], boxes: dict[str, Any]) -> None:
        """Where bodies get that move or deform; all bodies if none does. What leaves the scene does not count."""
        moving = {
            name
            for name, body in self.bodies.items()
            if name in self.deformed or not isinstance(getattr(body, "motion", None), Fixed)
        } or set(self.bodies)
        corners: dict[str, list[NDArray[np.float64]]] = {}
        for part in solids:
            if part.body != GROUND and len(part.points):
                corners.setdefault(part.body, []).append(_corners(part.points))
        for name, (points, _) in boxes.items():
            corners.setdefault(name, []).append(points)
        for name, number in self.deformed.items():
            corners.setdefault(name, []).append(_corners(self.motion.surfaces[number].points))
        sizes = [float(np.linalg.norm(np.ptp(np.concatenate(own), axis=0))) for own in corners.values()]
        self.motion.largest = max((size for size in sizes if size > 0.0), default=np.inf)
        looks = _spread(len(self.records), _LOOKS)
        parts: list[tuple[NDArray[np.float64], NDArray[np.float64]]] = []
        for pose in self.motion.poses:
            if pose.name not in moving:
                continue
            own = np.concatenate([pose.centre[np.newaxis], *corners.get(pose.name, ())])
            with np.errstate(all="ignore"):
                for k in looks:
                    at = pose.position[k] + own @ pose.matrices_at(k).T
                    parts.append((at.min(axis=0), at.max(axis=0)))
        for name, number in self.deformed.items():
            surface = self.motion.surfaces[number]
            if self.index[name] >= 0:
                continue
            taken = surface.shapes if surface.shapes is not None else ()
            parts += [(points.min(axis=0), points.max(axis=0)) for points in (surface.points, *taken)]
        if not parts:
            return
        lows, highs = np.array([low for low, _ in parts]), np.array([high for _, high in parts])
        start = np.abs(np.concatenate([lows[:1], highs[:1]]))
        usual = float(np.median(np.abs(np.concatenate([lows, highs])))) + float(start.max()) + 1.0
        good = np.all(np.isfinite(lows) & np.isfinite(highs), axis=1)
        good &= np.all((np.abs(lows) < 100.0 * usual) & (np.abs(highs) < 100.0 * usual), axis=1)
        if good.any():
            low, high = lows[good].min(axis=0), highs[good].max(axis=0)
            if np.linalg.norm(high - low) < 1e-9:
                low, high = low - 0.5, high + 0.5
            self.motion.box = np.array([low, high])
        ends = np.stack([lows, highs], axis=1)[good] if good.any() else self.motion.box[np.newaxis]
        # all corners of the boxes: lowest and highest ones alone may lie in a plane that nothing else lies in
        across = plane_view(np.concatenate([_corners(pair) for pair in ends]), self.motion.up, flat=1e-3)
        if across is not None:
            self.motion.view = np.array(across.towards)
        elif self.motion.up[1] != 0.0:
            self.motion.view = np.array([0.45, 0.36 * self.motion.up[1], 0.8])
        elif self.motion.up[0] != 0.0:
            self.motion.view = np.array([0.36 * self.motion.up[0], 0.55, 0.75])
        else:
            self.motion.view = np.array([0.55, -0.75, 0.36 * self.motion.up[2]])

    # what is fixed to them

    def _attach(self, places: Sequence[tuple[str, ArrayLike]]) -> dict[str, NDArray[Any]]:
        """Body, point in its axes, and the point of a surface that carries it, of some places."""
        on, local, surface, vertex = [], [], [], []
        for body, point in places:
            at = np.asarray(point, dtype=np.float64)
            number = self.deformed.get(body, -1)
            nearest = -1
            if number >= 0:
                made = self.bodies[body]
                if self.index[body] < 0:  # a frame or shell, whose points are those of the world
                    at = made.position + rotation_matrix(made.orientation) @ at
                nearest = int(np.argmin(np.linalg.norm(self.motion.surfaces[number].points - at, axis=1)))
            on.append(self.index[body])
            local.append(at)
            surface.append(number)
            vertex.append(nearest)
        found: dict[str, NDArray[Any]] = {
            "on": np.array(on, dtype=np.int64),
            "local": np.array(local, dtype=np.float64).reshape(-1, 3),
        }
        if max(surface, default=-1) >= 0:
            found |= {
                "surface": np.array(surface, dtype=np.int64),
                "vertex": np.array(vertex, dtype=np.int64),
            }
        return found

    def _world(self, body: str, point: ArrayLike) -> NDArray[np.float64]:
        """Where a point of a body is at the poses [m], shape (k, 3)."""
        placed = self._attach([(body, point)])
        local = np.repeat(placed["local"], len(self.records), axis=0)
        if "surface" in placed and placed["surface"][0] >= 0:
            surface, vertex = self.motion.surfaces[int(placed["surface"][0])], int(placed["vertex"][0])
            if surface.modes is not None:
                assert surface.amplitudes is not None
                local = local + surface.amplitudes @ surface.modes[:, vertex]
            elif surface.shapes is not None:
                moved = surface.shapes[:, vertex] - surface.points[vertex]
                times = self.motion.times
                local = local + np.column_stack(
                    [np.interp(times[0], times[1], moved[:, axis]) for axis in range(3)]
                )
        number = int(placed["on"][0])
        return local if number < 0 else self.motion.poses[number].world(local)

    def _tension(self, name: str, line: int | None = None) -> NDArray[np.float64] | None:
        """Of a rope, or of one of its lines of one force."""
        values = self._values(f"{name}.tension" if line is None else f"{name}.segment_tension")
        if values is None:
            return None
        return values.max(axis=1) if line is None else values[:, line]

    def _ropes(self) -> None:
        loose = self._loose()
        for rope in self.scene.ropes:
            lines = hasattr(rope, "legs")
            for number, leg in enumerate(getattr(rope, "legs", [rope.path])):
                placed = self._attach([(stop.body, stop.point) for stop in leg])
                if any(stop.radius > 0.0 for stop in leg):
                    placed = self._reeved(leg)
                self.motion.lines.append(
                    Line(
                        rope.name,
                        "ropes",
                        colour=_ROPE,
                        radius=self.motion.radius,
                        tension=self._tension(rope.name, number if lines else None),
                        loose=loose.get(rope.name),
                        **placed,  # type: ignore[arg-type]
                    )
                )
                for stop in leg:
                    if stop.radius > 0.0:
                        self._sheave(rope.name, stop)

    def _loose(self) -> dict[str, NDArray[np.bool_]]:
        """When each rope is not connected, of those that ever are not."""
        scenario = self.scene.scenario
        if scenario is None:
            return {}
        keys = ["scenario.phase", "scenario.track_phase"][: 1 + bool(scenario.tracks)]
        known = [np.zeros((len(self.records), 1)) if (v := self._values(key)) is None else v for key in keys]
        numbers = [tuple(map(int, row)) for row in np.nan_to_num(np.hstack(known))]
        found = {row: loose_ropes(scenario, row) for row in set(numbers)}
        names = set().union(*found.values()) if found else set()
        return {name: np.array([name in found[row] for row in numbers]) for name in names}

    def _reeved(self, leg: Sequence[Any]) -> dict[str, NDArray[Any]]:
        """A rope about pulleys: its points at every pose, in the axes of the bodies that carry them."""
        centres = [self._world(stop.body, stop.point) for stop in leg]
        axes = []
        for stop in leg:
            axis = np.asarray(stop.axis, dtype=np.float64)
            unit = axis / (np.linalg.norm(axis) or 1.0)
            number = self.index[stop.body]
            turned = np.broadcast_to(unit, centres[0].shape)
            axes.append(
                turned if number < 0 else np.einsum("kij,j->ki", self.motion.poses[number].matrices, unit)
            )
        radii = [stop.radius for stop in leg]
        with np.errstate(all="ignore"):
            arrive, leave = rope_tangents(centres, radii, axes)
        on: list[int] = []
        local: list[NDArray[np.float64]] = []
        for stop, first, last, centre, axis in zip(leg, arrive, leave, centres, axes, strict=True):
            points = first[:, np.newaxis]
            if stop.radius > 0.0:
                u = (first - centre) / stop.radius
                v = np.cross(axis, u)
                out = last - centre
                angle = np.arctan2(np.sum(out * v, axis=1), np.sum(out * u, axis=1)) % (2.0 * np.pi)
                turns = np.linspace(0.0, 1.0, _ARC) * angle[:, np.newaxis]
                points = centre[:, np.newaxis] + stop.radius * (
                    np.cos(turns)[..., np.newaxis] * u[:, np.newaxis]
                    + np.sin(turns)[..., np.newaxis] * v[:, np.newaxis]
                )
            number = self.index[stop.body]
            on += [number] * points.shape[1]
            local.append(points if number < 0 else self.motion.poses[number].local(points))
        return {"on": np.array(on, dtype=np.int64), "local": np.concatenate(local, axis=1)}

    def _sheave(self, name: str, stop: Any) -> None:
        axis = np.asarray(stop.axis, dtype=np.float64)
        shape = CylinderShape(stop.radius, 0.25 * stop.radius, 0.0, axis)
        (patch,) = shape_parts(shape).patches
        placed = self._attach([(stop.body, stop.point)])
        anchor = _anchor(placed)
        points = placed["local"][0] + 0.97 * patch.points
        self._add(
            name, "ropes", stop.body, points, patch.triangles, colour=_WHEEL, edges=False, anchor=anchor
        )

    def _fixed(self, name: str, group: str, places: Sequence[tuple[str, ArrayLike]], **more: Any) -> None:
        self.motion.lines.append(Line(name, group, **{**self._attach(places), **more}))

    def _connections(self, boxes: Container[str]) -> None:
        radius = self.motion.radius
        for force in self.scene.forces:
            if isinstance(force, Between):
                ends = [(force.body_a, force.point_a), (force.body_b, force.point_b)]
                name = getattr(force, "name", "force")
                coiled = isinstance(force, Spring)
                self._fixed(
                    name,
                    "forces",
                    ends,
                    colour=_SPRING,
                    radius=radius * (0.6 if coiled else 1.0),
                    coiled=coiled,
                )
        ball, triangles = _ball(2.4 * radius)
        one = np.array([[0, 1]])
        used: dict[str, list[NDArray[np.float64]]] = {}
        for joint in single_joints(self.scene):
            name = joint.name.rpartition(".")[0] if joint.name.rpartition(".")[2].isdigit() else joint.name
            ends = [(joint.body_a, joint.frame_a.point), (joint.body_b, joint.frame_b.point)]
            for body, point in ends:
                used.setdefault(body, []).append(np.asarray(point))
            self._fixed(name, "joints", ends, colour=_JOINT, ends=one)
            placed = self._attach(ends[:1])
            anchor = _anchor(placed)
            points = placed["local"][0] + ball
            self._add(
                name, "joints", joint.body_a, points, triangles, colour=_JOINT, edges=False, anchor=anchor
            )
            if self.marked:
                self._axes(name, joint)
        for rope in self.scene.ropes:
            for leg in getattr(rope, "legs", [rope.path]):
                for stop in leg:
                    used.setdefault(stop.body, []).append(np.asarray(stop.point))
        for owner, tied, pairs in rods(self.scene, used, boxes):
            self._fixed(owner, "rods", [(owner, point) for point in tied], colour="#5b6b7c", ends=pairs)

    def _axes(self, name: str, joint: Any) -> None:
        """Axes of the joint frame on the first body."""
        axes = np.asarray(joint.frame_a.axes, dtype=np.float64)
        origin = np.asarray(joint.frame_a.point, dtype=np.float64)
        for axis, colour in zip(axes.T, ("#c62828", "#2e7d32", "#1565c0"), strict=True):
            ends = [(joint.body_a, origin), (joint.body_a, origin + 0.05 * self.motion.size * axis)]
            self._fixed(name, "joint axes", ends, colour=colour, radius=0.5 * self.motion.radius)

    def _contours(self) -> None:
        for contour in self.scene.contours:
            if contour.neutral is None:  # the own shape of a frame or shell
                continue
            flexible = isinstance(self.bodies.get(contour.body), FlexibleBody)
            parts = contour_parts(contour, contour.neutral, filled=not flexible)
            name = getattr(contour, "name", contour.body)
            for patch in parts.patches:
                self._add(
                    name, "contact surfaces", contour.body, patch.points, patch.triangles, edges=False,
                    colour=_GROUND,
                )  # fmt: skip
            for line in parts.lines:
                places = [(contour.body, point) for point in line.points]
                self._fixed(name, "contact surfaces", places, colour=line.colour, ends=line.ends)
        for contact in self.scene.contacts:
            placed = self._attach([(contact.body, contact.point)])
            anchor = _anchor(placed)
            parts = shape_parts(contact.shape)
            at = placed["local"][0]
            for patch in parts.patches:
                self._add(
                    contact.name, "contact surfaces", contact.body, at + patch.points, patch.triangles,
                    colour=_TOUCH, anchor=anchor,
                )  # fmt: skip
            for line in parts.lines:
                places = [(contact.body, contact.point + point) for point in line.points]
                self._fixed(contact.name, "contact surfaces", places, colour=_TOUCH, ends=line.ends)
            if parts.marks:
                ball, triangles = _ball(3.0 * self.motion.radius)
                self._add(
                    contact.name, "contact surfaces", contact.body, at + ball, triangles, colour=_TOUCH,
                    edges=False, anchor=anchor,
                )  # fmt: skip

    def _vehicles(self) -> None:
        for vehicle in self.scene.transporters:
            if not vehicle.wheel_radius > 0.0:
                continue
            axle, up = wheel_axes(vehicle)
            (patch,) = shape_parts(
                CylinderShape(vehicle.wheel_radius, 0.6 * vehicle.wheel_radius, 0.0, axle)
            ).patches
            strokes = self._values(f"{vehicle.name}.stroke_of")
            for number, centre in enumerate(wheel_centres(vehicle, None)):
                offset = None
                if strokes is not None and number < strokes.shape[1]:
                    offset = strokes[:, [number]] * up
                self._add(
                    vehicle.name, "transporters", vehicle.body, centre + patch.points, patch.triangles,
                    colour=_WHEEL, edges=False, offset=offset,
                )  # fmt: skip

    # sea

    def _sea(self) -> None:
        sea = self.scene.sea
        if sea is None:
            return
        motion, span = self.motion, self.motion.size
        low, high = motion.box[0] - 1.5 * span, motion.box[1] + 1.5 * span
        waves = None
        if sea.waves is not None:
            train = sea.waves
            chosen = np.argsort(-train.amplitude)[:_WAVES]
            if len(chosen) < len(train.amplitude):
                left = 1.0 - float(np.sum(train.amplitude[chosen] ** 2) / np.sum(train.amplitude**2))
                motion.notes.append(
                    f"The drawn waves are the {len(chosen)} largest of {len(train.amplitude)} components; "
                    f"{100 * left:.2g} % of the variance is left out."
                )
            waves = {
                "kx": (train.wavenumber * np.cos(train.direction))[chosen],
                "ky": (train.wavenumber * np.sin(train.direction))[chosen],
                "omega": train.omega[chosen],
                "amplitude": train.amplitude[chosen],
                "phase": train.phase[chosen],
            }
            motion.notes.append("The water has the incident waves, undisturbed by hulls.")
        if self.case.sea is not None:  # lines may hang in a scene without water
            motion.water = WaterShape(low, high, sea.water.level, waves)
        for fender in sea.fenders:
            points, triangles = pad(np.asarray(fender.point_a), np.asarray(fender.direction), 0.015 * span)
            name = getattr(fender, "name", "fender")
            self._add(name, "fenders", fender.body_a, points, triangles, colour=_FENDER, edges=False)
        self._moorings(sea)
        (ball,) = shape_parts(SphereShape(1.0)).patches
        for tank in sea.tanks:
            times, masses = tank.schedule
            mass = np.interp(motion.times[0], times, masses)
            density = sea.water.density if tank.density is None else tank.density
            size = np.cbrt(3.0 * mass / (4.0 * np.pi * density))
            self._add(
                tank.name, "tanks", tank.hull, ball.points, ball.triangles, colour=_BALLAST, edges=False,
                size=size, at=np.asarray(tank.point, dtype=np.float64),
            )  # fmt: skip
        if sea.tanks:
            motion.notes.append("Balls stand for the water in tanks: as much as they hold, about its centre.")

    def _moorings(self, sea: Any) -> None:
        motion = self.motion
        chosen = _spread(len(self.records), max(2, MOORINGS // max(1, len(sea.lines))))
        motion.times[2] = motion.times[0][chosen]
        if sea.lines and len(chosen) < len(self.records):
            motion.notes.append(f"Shapes of mooring lines are those of {len(chosen):,} records.")
        bottoms: dict[float, list[NDArray[np.float64]]] = {}
        for line in sea.lines:
            anchor = self._world(line.body_a, line.point_a)[chosen]
            fairlead = self._world(line.body_b, line.point_b)[chosen]
            shapes = []
            for ends in zip(anchor, fairlead, strict=True):
                try:
                    points = draw_line(line, *ends).points
                except InputError:  # no equilibrium between these ends
                    points = np.array(ends)
                shapes.append(_resampled(points, 40))
            local = np.array(shapes)
            if line.seabed is not None:
                bottoms.setdefault(float(line.seabed), []).append(local.reshape(-1, 3))
            motion.lines.append(
                Line(
                    line.name,
                    "mooring lines",
                    np.full(local.shape[1], -1, dtype=np.int64),
                    local,
                    _LINE,
                    radius=motion.radius,
                    timeline=2,
                    tension=self._tension(line.name),
                )
            )
        for number, (level, parts) in enumerate(bottoms.items()):
            low, high = np.min(np.concatenate(parts), axis=0), np.max(np.concatenate(parts), axis=0)
            more = 0.05 * (high - low).max()
            x, y = (low[0] - more, high[0] + more), (low[1] - more, high[1] + more)
            plane = np.array([[x[i], y[j], level] for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))])
            name = "seabed" if number == 0 else f"seabed {number + 1}"
            self._add(
                name, "ground", GROUND, plane, np.array([[0, 1, 2], [0, 2, 3]]), colour=_SAND, edges=False
            )

    # forces

    def _forces(self) -> None:
        if self.results is None:
            return
        found: list[tuple[str, NDArray[np.float64], NDArray[np.float64]]] = []
        for contact in self.scene.contacts:
            force, point = self._values(f"{contact.name}.force"), self._values(f"{contact.name}.point")
            if force is not None and point is not None and force.shape[1] == 3:
                found.append((contact.name, point[:, np.newaxis], force[:, np.newaxis]))
        names = dict.fromkeys(m[1] for m in map(_CONTACT.match, self.results) if m)
        for name in names:
            points, forces = [], []
            number = 1
            while f"{name}.contact_{number}.normal" in self.results:
                prefix = f"{name}.contact_{number}"
                normal, force = self._values(f"{prefix}.normal"), self._values(f"{prefix}.force")
                point = self._values(f"{prefix}.point")
                number += 1
                if normal is not None and force is not None and point is not None:
                    points.append(point)
                    forces.append(normal * force)
            if points:
                found.append((name, np.stack(points, axis=1), np.stack(forces, axis=1)))
        arrows = []
        for name, place, forces_of in found:
            force = np.where(np.isfinite(forces_of), forces_of, 0.0)
            used = np.any(force != 0.0, axis=(0, 2))
            if used.any():
                arrows.append(Arrows(name, place[:, used], force[:, used]))
        most = ARROW_BYTES // (12 * max(1, sum(one.force.shape[1] for one in arrows)))
        chosen = _spread(len(self.records), max(50, most))
        self.motion.times[3] = self.motion.times[0][chosen]
        if arrows and len(chosen) < len(self.records):
            self.motion.notes.append(f"Forces at contacts are those of {len(chosen):,} records.")
        self.motion.arrows = [Arrows(one.name, one.place[chosen], one.force[chosen]) for one in arrows]

    # at the end

    def _say_thinned(self, name: str, before: int, after: int) -> None:
        self.motion.notes.append(
            f"The surface of {name} is drawn with {after:,} of its {before:,} triangles."
        )

    def _widen(self) -> None:
        """Ropes, springs and joints that are near are seen with the bodies."""
        box = self.motion.box
        reach = box + _RIGGING * self.motion.size * np.array([[-1.0], [1.0]])
        for line in self.motion.lines:
            if line.group not in {"ropes", "forces", "joints"}:
                continue
            for k in _spread(len(self.records), _LOOKS):
                local = line.local[k] if line.local.ndim == 3 else line.local
                at = np.array(
                    [
                        point
                        if number < 0
                        else self.motion.poses[number].position[k]
                        + self.motion.poses[number].matrices_at(k) @ point
                        for number, point in zip(line.on, local, strict=True)
                    ]
                )
                at = at[np.all((at >= reach[0]) & (at <= reach[1]), axis=1)]
                if len(at):
                    box = np.array([np.minimum(box[0], at.min(axis=0)), np.maximum(box[1], at.max(axis=0))])
        self.motion.box = box

    def _thin(self) -> None:
        """Fewer triangles of surfaces that are too fine, and the edges of all."""
        rigid = [one for one in self.motion.surfaces if one.modes is None and one.shapes is None]
        left = TRIANGLES - sum(len(one.triangles) for one in self.motion.surfaces if one not in rigid)
        total = sum(len(one.triangles) for one in rigid)
        carried = {one.anchor[0] for one in self.motion.surfaces if one.anchor is not None}
        for number, surface in enumerate(self.motion.surfaces):
            if surface not in rigid or number in carried:
                continue
            most = max(200, int(left * len(surface.triangles) / max(total, 1)))
            if total > left and len(surface.triangles) > most:
                triangles, kept = _thinned(surface.points, surface.triangles, most)
                self._say_thinned(surface.name, len(surface.triangles), len(triangles))
                surface.points, surface.triangles = surface.points[kept], triangles
            if len(surface.triangles) > _COARSE:
                coarse, kept = _thinned(surface.points, surface.triangles, _COARSE)
                surface.coarse = kept[coarse]
            if surface.edges is not None:
                few = len(surface.triangles) <= _EDGES
                surface.edges = (
                    feature_edges(surface.points, surface.triangles, _KINK, wound=False) if few else None
                )

    def _name(self) -> None:
        labels = self.motion.labels
        for pose in self.motion.poses:
            labels.append((pose.name, self.index[pose.name], pose.centre, pose.name))
        for name, number in self.deformed.items():
            if self.index[name] < 0:
                points = self.motion.surfaces[number].points
                labels.append((name, -1, points[len(points) // 2], name))
        if not self.marked:
            return
        places: list[tuple[str, str, ArrayLike, str]] = []
        places += [
            (joint.name, joint.body_a, joint.frame_a.point, f"{joint.name} ({joint.WORD})")
            for joint in single_joints(self.scene)
        ]
        places += [
            (sensor.name, sensor.body, sensor.point, f"{sensor.name} (sensor)")
            for sensor in self.scene.sensors
        ]
        for rope in self.scene.ropes:
            stops = next(iter(getattr(rope, "legs", [rope.path])))
            places += [
                (rope.name, stop.body, stop.point, rope.name if k == 0 else f"{rope.name}, {k + 1}")
                for k, stop in enumerate(stops)
            ]
        for contact in self.scene.contacts:
            places.append((contact.name, contact.body, contact.point, f"{contact.name} (contact)"))
        for force in self.scene.forces:
            if isinstance(force, Between):
                places.append((force.name, force.body_a, force.point_a, force.name))
        for line in () if self.scene.sea is None else self.scene.sea.lines:
            places.append((line.name, line.body_b, line.point_b, line.name))
        for name, body, point, text in places:
            placed = self._attach([(body, point)])
            labels.append((name, int(placed["on"][0]), placed["local"][0], text))

    def _scale(self) -> None:
        """Deformations that would not be seen are drawn larger, if nothing is fixed to what deforms."""
        fixed = any(line.surface is not None and np.any(line.surface >= 0) for line in self.motion.lines)
        if fixed or not self.deformed or self.motion.arrows:
            return
        moved = 0.0
        for number in self.deformed.values():
            surface = self.motion.surfaces[number]
            if surface.modes is not None and surface.amplitudes is not None:
                for k in _spread(len(self.records), _LOOKS):
                    u = np.tensordot(surface.amplitudes[k], surface.modes, axes=1)
                    moved = max(moved, float(np.linalg.norm(u, axis=1).max(initial=0.0)))
            elif surface.shapes is not None:
                far = np.linalg.norm(surface.shapes - surface.points, axis=2)
                moved = max(moved, float(far.max(initial=0.0)))
        if 0.0 < moved < 1.0e-2 * self.motion.size:
            self.motion.scale = deformation_scale(np.array([[moved, 0.0, 0.0]]), self.motion.size)
            self.motion.notes.append(
                f"Deformations are drawn {self.motion.scale:g} times as large as they are, until another scale is "
                "chosen."
            )


def _anchor(placed: dict[str, NDArray[Any]]) -> tuple[int, int] | None:
    """Surface and point that carry the first of some places."""
    if "surface" not in placed or placed["surface"][0] < 0:
        return None
    return int(placed["surface"][0]), int(placed["vertex"][0])


def stress_colours(motion: SceneMotion) -> Any:
    """Colours that suit the stresses of all surfaces; None if there are none."""
    parts = [one.stress for one in motion.surfaces if one.stress is not None]
    if not parts:
        return None
    values = np.concatenate([part[np.isfinite(part)].ravel() for part in parts])
    thinned = values[:: 1 + len(values) // 2_000_000]
    peak = float(np.abs(values).max(initial=0.0))
    return stress_scale(thinned, peak, signed=motion.signed)


def read_mesh(stages: OutputFolder, name: str) -> Any:
    """Mesh of a flexible body; None if its model has none."""
    from heavylift.pipeline.results.model_io import read_model

    return read_model(stages.model(name)).mesh


def unit_coil() -> NDArray[np.float64]:
    """Points of a coil of length and radius one along z, shape (n, 3)."""
    points, _ = coil(np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.125)
    return points * np.array([8.0, 8.0, 1.0])


def _spread(count: int, most: int) -> NDArray[np.int64]:
    """Indices of at most so many records, the first and the last among them."""
    return np.unique(np.linspace(0, max(count - 1, 0), min(count, most)).round().astype(np.int64))


def _corners(points: NDArray[np.float64]) -> NDArray[np.float64]:
    low, high = points.min(axis=0), points.max(axis=0)
    return np.array([np.where([i & 4, i & 2, i & 1], high, low) for i in range(8)])


def _ball(radius: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """An octahedron."""
    points = radius * np.array(
        [[1.0, 0, 0], [-1.0, 0, 0], [0, 1.0, 0], [0, -1.0, 0], [0, 0, 1.0], [0, 0, -1.0]]
    )
    triangles = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
    return points, np.array(triangles)


def _resampled(points: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """So many points along a polyline."""
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    at = np.linspace(0.0, way[-1], count)
    return np.column_stack([np.interp(at, way, points[:, axis]) for axis in range(3)])


def _thinned(
    points: NDArray[np.float64], triangles: NDArray[np.int64], most: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Triangles between fewer points, and which of the points these are.

    Points in one cell of a grid become the first of them (Rossignac and Borrel, 1993); the grid is made coarser until
    there are few enough triangles.
    """
    if len(triangles) <= most:
        return triangles, np.arange(len(points))
    low = points.min(axis=0)
    span = float(np.ptp(points, axis=0).max()) or 1.0
    cells = max(4, int(np.sqrt(most)))
    while True:
        # one whole number for a cell, and for a triangle: to sort rows takes ten times as long
        i, j, k = np.floor((points - low) / span * cells).astype(np.int64).T
        _, first, cell = np.unique(
            (i * (cells + 1) + j) * (cells + 1) + k, return_index=True, return_inverse=True
        )
        joined = cell[triangles]
        a, b, c = joined.T
        joined = joined[(a != b) & (b != c) & (c != a)]
        a, b, c = np.sort(joined, axis=1).T
        _, pair = np.unique(a * len(first) + b, return_inverse=True)
        _, once = np.unique(pair * len(first) + c, return_index=True)
        joined = joined[np.sort(once)]
        if len(joined) <= most or cells <= 4:
            used, compact = np.unique(joined, return_inverse=True)
            return compact.reshape(-1, 3), first[used]
        cells = max(4, int(0.8 * cells))


def _some(names: list[str]) -> str:
    return ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
