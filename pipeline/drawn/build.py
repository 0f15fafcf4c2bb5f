"""From what things answer to `drawn`, and records, to the scene to draw.

Rigid bodies move by their recorded pose, bodies with modes by modal coordinates and mode shapes, frames and shells by
the shapes that their recorded nodes give; all else is fixed to points of them.
"""

from __future__ import annotations

import re
from dataclasses import fields
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.drawn.contours import ContourShape, contour_shape
from heavylift.pipeline.drawn.hanging import hanging_line
from heavylift.pipeline.drawn.outer_surface import feature_edges, surface_of_model
from heavylift.pipeline.drawn.rods import rods
from heavylift.pipeline.drawn.roles import BODY_COLOURS, ROLES
from heavylift.pipeline.drawn.ropes import rope_points
from heavylift.pipeline.drawn.scales import deformation_scale, round_down
from heavylift.pipeline.drawn.scene import (
    HANGING,
    POSES,
    SHAPES,
    TOUCHES,
    Anchor,
    Arrows,
    Disc,
    Dot,
    DrawnScene,
    Label,
    Line,
    Pose,
    Surface,
    WaterShape,
)
from heavylift.pipeline.drawn.skins import MeshRun, MeshSkin, frame_radius
from heavylift.pipeline.drawn.triangles import clip_triangles, thinned
from heavylift.pipeline.results.mesh_motion import mesh_coordinates
from heavylift.pipeline.results.mesh_results import mesh_body
from heavylift.solver.joints.edges import expand_edge
from heavylift.solver.scene import drawn as d
from heavylift.solver.scene.bodies import Fixed
from heavylift.solver.scene.connections import GROUND, EdgeJoint
from heavylift.solver.scene.outlines import ball, box_corners, pad
from heavylift.solver.scene.scenario import loose_ropes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.drawn.outer_surface import Surface as OuterSurface
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.mesh_results import MeshShape
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.solver.scene.scene import Scene

__all__ = [
    "EXACT",
    "PAGE",
    "Detail",
    "Sources",
    "case_scene",
    "draw_scene",
    "elements",
    "mesh_run",
    "scene_up",
]


@dataclass(frozen=True)
class Detail:
    """How much of a run is drawn.

    Attributes
    ----------
    poses, shapes
        Records at which bodies are placed, and at which shapes are recorded, at most.
    shape_bytes, arrow_bytes
        Of recorded shapes and their stresses, and of forces at contacts, before compression.
    moorings
        Mooring lines times records at which their shape is found, at most.
    triangles
        Of the whole scene at most; surfaces with more are thinned.
    skin
        Points of a frame or shell, if its elements allow it; without any, it only carries what is attached.
    arc, hanging
        Points of a rope about a pulley, and of a mooring line.
    waves
        Components at most.
    splines
        Whether a contour on a body with modes moves by its own ones, not with the nearest points of the body.
    """

    poses: int = 12_001
    shapes: int = 400
    shape_bytes: int = 6_000_000
    arrow_bytes: int = 2_500_000
    moorings: int = 600
    triangles: int = 120_000
    skin: int = 6000
    arc: int = 9
    hanging: int = 40
    waves: int = 1200
    splines: bool = False


PAGE = Detail()
"""What a page can hold."""
_ALL = 2**40
EXACT = Detail(_ALL, _ALL, _ALL, _ALL, _ALL, _ALL, skin=0, arc=33, hanging=200, waves=_ALL, splines=True)
"""For pictures of a few records. Frames and shells have pictures of their own, by their stresses."""

_COARSE = 5000  # triangles of a surface while it is played on a slow machine
_EDGES = 60_000  # triangles up to which edges are drawn
_KINK = np.radians(30.0)
_RIGGING = 5.0  # ropes, springs and joints within so many sizes of the scene are looked at as well
_SAMPLES = 24  # records by which it is seen where bodies get
_GONE = 1.0e4  # a body so many sizes of the scene away from where it began has left it
_THIN = 4.0e-3  # radius of a frame relative to the scene below which it is drawn larger
_GLASS = 0.3  # opacity of boxes that hide other bodies
_BESIDE = 0.02  # of the size of a surface: what is attached so near to it is attached to it
_AXIS_COLOURS = ("#c62828", "#2e7d32", "#1565c0")
_CONTACT = re.compile(r"^(.+)\.contact_\d+\.normal$")


class Records(Protocol):
    """What is drawn of results: channels by name at the times of records."""

    @property
    def time(self) -> NDArray[np.float64]: ...
    @property
    def meshes(self) -> Mapping[str, MeshShape]: ...
    def __contains__(self, name: object, /) -> bool: ...
    def __getitem__(self, name: str, /) -> NDArray[np.float64]: ...
    def __iter__(self) -> Iterator[str]: ...


@dataclass(frozen=True)
class Sources:
    """Where what is not in the scene is found.

    Attributes
    ----------
    surface
        Of a body with modes, None if it has no elements; by its name. An `InputError` if they are lost.
    stresses
        Of a body by its name, at some records, shape (k,), of some nodes: [Pa], shape (k, n).
    runs
        Motion of frames and shells by name; that of the results if None.
    water
        Whether water is drawn: lines may hang in a scene without.
    """

    surface: Callable[[str], OuterSurface | None] = lambda _name: None
    stresses: Callable[[str, NDArray[np.int64], NDArray[np.int64]], NDArray[np.float64]] | None = None
    runs: Mapping[str, MeshRun] | None = None
    water: bool = False


def scene_up(case: Case) -> NDArray[np.float64] | None:
    """Direction against gravity, or out of the water; None without both."""
    if case.gravity is None or not any(case.gravity.acceleration):
        return None if case.sea is None else np.array([0.0, 0.0, 1.0])
    return -np.array(case.gravity.acceleration)


def case_scene(
    case: Case,
    stages: OutputFolder,
    scene: Scene,
    results: Results | None,
    *,
    detail: Detail = PAGE,
    records: NDArray[np.int64] | None = None,
    marked: bool = False,
    running: bool = False,
) -> DrawnScene:
    """Everything that is drawn of a case, at its records, or as it is put together if there are none.

    Parameters
    ----------
    case, stages
        The case and its output folder.
    scene
        What was simulated, or will be.
    results
        Its time histories; finite, or None.
    detail
        How much.
    records
        Numbers of records; as many as `detail` allows if None.
    marked
        Whether joints, sensors, ropes and contacts have labels too, as before a run.
    running
        Whether there will be more records: stresses are those of the modes alone until then.
    """

    def surface(name: str) -> OuterSurface | None:
        from heavylift.pipeline.results.model_io import read_model

        model = read_model(stages.model(name))
        return surface_of_model(model.mesh, model.structure)

    def stresses(name: str, chosen: NDArray[np.int64], nodes: NDArray[np.int64]) -> NDArray[np.float64]:
        from heavylift.pipeline.checks.body_stress import body_stress
        from heavylift.pipeline.checks.stresses import SolidStresses

        assert results is not None
        asked = case.bodies[name].stress is not None and not running
        stress = body_stress(case, name, stages, results) if asked else None
        solid = SolidStresses(name, stages, case.file, stress)
        return solid.fields(solid.coordinates(results)[chosen], nodes)

    sources = Sources(surface, stresses if detail.skin else None, water=case.sea is not None)
    return draw_scene(
        scene, results, up=scene_up(case), sources=sources, detail=detail, records=records, marked=marked
    )


def draw_scene(
    scene: Scene,
    results: Records | None = None,
    *,
    up: NDArray[np.float64] | None = None,
    sources: Sources | None = None,
    detail: Detail = PAGE,
    records: NDArray[np.int64] | None = None,
    marked: bool = False,
) -> DrawnScene:
    """As `case_scene`, of a scene that need not come from a case; `up` is the direction against gravity."""
    return _Builder(scene, results, up, sources or Sources(), detail, records, marked=marked).build()


def elements(scene: Scene) -> list[d.Element]:
    """What all things of a scene answer; along an edge one joint a node."""
    joints = [
        part
        for joint in scene.joints
        for part in (expand_edge(joint, scene.bodies) if isinstance(joint, EdgeJoint) else (joint,))
    ]
    sea = scene.sea
    afloat, at_sea = ((), ()) if sea is None else (sea.hulls, (*sea.fenders, *sea.lines, *sea.tanks))
    things = (
        *scene.bodies,
        *scene.surfaces,
        *scene.decks,
        *afloat,
        *scene.contours,
        *scene.contacts,
        *scene.ropes,
        *scene.forces,
        *joints,
        *scene.transporters,
        *at_sea,
        *scene.sensors,
        *scene.inputs,
    )
    return [element for thing in things for element in getattr(thing, "drawn", tuple)()]


def mesh_run(shape: MeshShape, results: Records) -> MeshRun:
    """A recorded frame or shell, as it is drawn."""

    def coordinates(record: int) -> NDArray[np.float64]:
        return mesh_coordinates(shape, results, slice(record, record + 1))[0]  # type: ignore[arg-type]

    lengths = shape.lengths[:, 0] if shape.type == "frame" else None
    return MeshRun(mesh_body(shape), coordinates, lengths)


class _Builder:
    """Collects the parts; see `case_scene`."""

    def __init__(
        self,
        scene: Scene,
        results: Records | None,
        up: NDArray[np.float64] | None,
        sources: Sources,
        detail: Detail,
        records: NDArray[np.int64] | None,
        *,
        marked: bool,
    ) -> None:
        self.scene, self.sources, self.detail, self.marked = scene, sources, detail, marked
        self.results = results if results is not None and len(results.time) else None
        count = 1 if self.results is None else len(self.results.time)
        self.records = _spread(count, detail.poses) if records is None else records
        times = np.zeros(1) if self.results is None else self.results.time[self.records]
        axis = np.eye(3)[2] if up is None else np.eye(3)[int(np.argmax(np.abs(up)))]
        self.drawn = DrawnScene(
            [times] * 4,
            axis if up is None else np.sign(up @ axis) * axis,
            self.records,
            touches=scene.touches,
        )
        if records is None and len(self.records) < count:
            self.drawn.notes.append(
                f"Bodies are placed at {len(self.records):,} of {count:,} records; between them they are interpolated."
            )
        self.index: dict[str, int] = {GROUND: -1}
        self.deformed: dict[str, int] = {}  # surface of a body whose points move
        self.nodes: dict[str, Callable[[int], NDArray[np.float64]]] = {}  # of frames and shells at a record
        self.contours: dict[str, ContourShape] = {}  # on bodies with modes
        self.splines: dict[str, int] = {}  # first point of their lines in the surface that carries them
        self.held: dict[tuple[str, tuple[float, ...]], tuple[int, NDArray[np.float64]]] = {}
        self.bodies: dict[str, Any] = {body.name: body for body in scene.bodies}
        self.elements = elements(scene)

    def build(self) -> DrawnScene:
        """The whole scene."""
        self._poses()
        self._deformable()
        solids, boxes = self._rigid_elements()
        self._find_box(solids, boxes)
        self._leave()
        self._rigid(solids, boxes)
        adders: dict[type[d.Element], Callable[[Any], None]] = {
            d.Segments: self._segments,
            d.Strut: self._strut,
            d.Mark: self._mark,
            d.RopeLine: self._rope,
            d.NodalShape: self._nodal_line,
            d.Wheel: self._wheel,
            d.Pad: self._pad,
            d.Filling: self._filling,
            d.Spline: self._spline,
            d.Solid: self._attached_solid,
        }
        if self.marked:
            adders |= {d.Axes: self._axes, d.Text: self._text}
        self.loose = self._loose()
        for element in self.elements:
            if (add := adders.get(type(element))) is not None:
                add(element)
        self._rods(solids, boxes)
        self._sea()
        self._forces()
        self._widen()
        self._thin()
        self._name()
        self._scale()
        return self.drawn

    def _of(self, *kinds: type[Any]) -> list[Any]:
        return [element for element in self.elements if isinstance(element, kinds)]

    # what records say

    def _values(self, name: str, records: NDArray[np.int64] | None = None) -> NDArray[np.float64] | None:
        """A channel at the poses, or at some records, shape (k, c); None if it is not recorded."""
        if self.results is None or name not in self.results:
            return None
        values = self.results[name]
        return values.reshape(len(values), -1)[self.records if records is None else records]

    def _poses(self) -> None:
        count = len(self.records)
        in_world = {element.name for element in self._of(d.Skin, d.NodalShape)}
        centres = {mark.at.body: mark.at.point for mark in self._of(d.Mark) if mark.role == "centre"}
        for body in self.scene.bodies:
            if body.name in in_world:
                self.index[body.name] = -1
                continue
            position = self._values(f"{body.name}.position")
            orientation = self._values(f"{body.name}.orientation")
            if position is None or orientation is None:
                position, orientation = np.atleast_2d(body.position), np.atleast_2d(body.orientation)
                position, orientation = (np.repeat(part, count, axis=0) for part in (position, orientation))
            centre = np.asarray(centres.get(body.name, np.zeros(3)), dtype=np.float64)
            self.index[body.name] = len(self.drawn.poses)
            self.drawn.poses.append(Pose(body.name, np.array(position), np.array(orientation), centre))

    def _leave(self) -> None:
        """Bodies that are farther away than any scene are not drawn from then on."""
        for pose in self.drawn.poses:
            far = np.linalg.norm(pose.position - pose.position[0], axis=1)
            gone = ~(far < _GONE * self.drawn.size)
            if gone.any():
                first = int(np.argmax(gone))
                pose.position[first:] = np.nan
                self.drawn.notes.append(
                    f"{pose.name} has left: from t = {self.drawn.times[POSES][first]:.6g} s on it is more than "
                    f"{_GONE:,.0f} sizes of the scene away, and is not drawn."
                )

    # bodies that deform

    def _points_on(self, body: str) -> NDArray[np.float64]:
        """Points of a body at which something is attached, in its frame, shape (n, 3)."""
        found = {
            tuple(map(float, at.point)): None
            for element in self.elements
            if self.marked or not isinstance(element, (d.Text, d.Axes))
            for at in _places(element)
            if at.body == body
        }
        return np.array(list(found), dtype=np.float64).reshape(-1, 3)

    def _carry(
        self, body: str, points: NDArray[np.float64], vertices: Sequence[int], places: NDArray[np.float64]
    ) -> None:
        """Note which points of the surface of a body carry what is attached to it, and where that is drawn at rest."""
        for point, vertex, place in zip(points, vertices, places, strict=True):
            self.held[body, tuple(map(float, point))] = int(vertex), place

    def _deformable(self) -> None:
        surfaces: dict[str, Any] = {}
        modal, skinned, nodal = (self._of(kind) for kind in (d.ModalShape, d.Skin, d.NodalShape))
        for element in modal:
            try:
                surface = self.sources.surface(element.name)
            except InputError as error:
                self.drawn.notes.append(f"{element.name} is not drawn: {error.problem}.")
                continue
            if surface is None:
                self.drawn.notes.append(f"{element.name} has no elements and is not drawn.")
                continue
            surfaces[element.name] = surface
        runs = {element.name: self._run(element) for element in skinned}
        fine: dict[str, Any] = {"most": self.detail.skin} if self.detail.skin else {}
        skins = {
            name: MeshSkin(
                run.body if run else self.bodies[name], lengths=run.lengths if run else None, **fine
            )
            for name, run in runs.items()
        }
        points = 0
        if self.detail.skin:
            points = sum(len(skin.skin(skin.rest).points) for skin in skins.values())
        points += sum(len(element.points) for element in nodal)
        values = points * 7 + sum(len(surface.nodes) for surface in surfaces.values())
        most = int(np.clip(self.detail.shape_bytes // max(values, 1), 20, self.detail.shapes))
        self.shapes = (
            self.records if most >= len(self.records) else self.records[_spread(len(self.records), most)]
        )
        if self.results is not None:
            self.drawn.times[SHAPES] = self.results.time[self.shapes]
        if values and len(self.shapes) < len(self.records):
            what = "shapes and stresses" if points else "stresses"
            count = len(self.results.time) if self.results else 1
            self.drawn.notes.append(
                f"Recorded {what} are those of {len(self.shapes):,} of {count:,} records."
            )
        self.drawn.signed = bool(skins) and not modal and not any(skin.is_shell for skin in skins.values())
        for element in modal:
            self._modal(element, surfaces.get(element.name))
        for element in skinned:
            self._skin(element, skins[element.name], runs[element.name])
        for element in nodal:
            self._nodal(element)

    def _run(self, element: d.Skin) -> MeshRun | None:
        if self.sources.runs is not None:
            return self.sources.runs.get(element.name)
        shape = None if self.results is None else self.results.meshes.get(element.name)
        return None if shape is None else mesh_run(shape, self.results)  # type: ignore[arg-type]

    def _add_deformed(self, element: d.Element, **more: Any) -> Surface:
        self.deformed[element.name] = len(self.drawn.surfaces)
        surface = Surface(
            name=element.name, role=element.role, body=self.index[element.name],
            colour=self._colour(element.name), **more,
        )  # fmt: skip
        self.drawn.surfaces.append(surface)
        return surface

    def _modal(self, element: d.ModalShape, surface: Any) -> None:
        none, stress = np.empty(0, dtype=np.int64), None
        nodes, triangles, chosen, edges = np.empty((0, 3)), none.reshape(0, 3), none, none.reshape(0, 2)
        if surface is not None:
            nodes, chosen = element.nodes[surface.node_indices], surface.node_indices
            triangles, kept = thinned(nodes, surface.triangles, self.detail.triangles // 2)
            edges = surface.feature_edges
            if len(kept) < len(nodes):
                self._note_thinned(element.name, len(surface.triangles), len(triangles))
                nodes, chosen = nodes[kept], chosen[kept]
                edges = feature_edges(nodes, triangles, _KINK, wound=False)
        amplitudes = self._values(element.amplitudes)
        if amplitudes is None:
            amplitudes = np.repeat(np.atleast_2d(element.start), len(self.records), axis=0)
        held = self._points_on(element.name)
        nearest = [int(np.argmin(np.linalg.norm(element.nodes - point, axis=1))) for point in held]
        parts = [(nodes, element.shapes[:, chosen])]
        for one in self._of(d.Spline):
            if one.contour.body == element.name:
                shape = self.contours[one.name] = contour_shape(one.contour, carried=True)
                if shape.line_modes is not None and self.detail.splines:
                    self.splines[one.name] = sum(len(points) for points, _ in parts)
                    parts.append((shape.line, shape.line_modes))
        # a node within the body has no point of the surface to which things can be fixed
        vertex_of = {int(node): k for k, node in enumerate(chosen)}
        inside = [node for node in dict.fromkeys(nearest) if node not in vertex_of]
        first = sum(len(points) for points, _ in parts)
        vertex_of |= {node: first + k for k, node in enumerate(inside)}
        parts.append((element.nodes[inside], element.shapes[:, inside]))
        self._carry(element.name, held, [vertex_of[node] for node in nearest], held)
        points = np.concatenate([points for points, _ in parts])
        now = self._values(element.amplitudes, self.shapes)
        if now is not None and self.sources.stresses is not None and len(chosen):
            try:
                stress = self.sources.stresses(element.name, self.shapes, chosen)
            except InputError as error:
                self.drawn.notes.append(f"No stresses of {element.name}: {error.problem}.")
            else:
                none_known = np.full((len(stress), len(points) - len(nodes)), np.nan)
                stress = np.hstack([stress, none_known])
        self._add_deformed(
            element,
            points=points,
            triangles=triangles,
            edges=edges,
            modes=np.concatenate([modes for _, modes in parts], axis=1),
            amplitudes=amplitudes,
            stress=stress,
        )

    def _skin(self, element: d.Skin, skin: MeshSkin, run: MeshRun | None) -> None:
        body = self.bodies[element.name]
        rest = skin.rest @ rotation_matrix(body.orientation).T
        rest[:, 0] += body.position
        held = self._points_on(element.name)
        followed = skin.material_points(held) if len(held) else np.empty(0, dtype=np.int64)
        if not skin.is_shell and self.detail.skin:
            span = float(np.linalg.norm(np.ptp(rest[:, 0], axis=0)))
            share = frame_radius(body) / span if span > 0.0 else 1.0
            if share < _THIN:
                skin.widening = max(1.0, round_down(1.5 * _THIN / share))
                self.drawn.notes.append(
                    f"{body.name} is drawn with {skin.widening:g} times its radius, to be seen."
                )
        none = np.empty((0, 2), dtype=np.int64)
        first = skin.skin(rest) if self.detail.skin else None

        def together(at: NDArray[np.float64], seen: Any) -> NDArray[np.float64]:
            carried = skin.followed(at, followed) if len(held) else np.empty((0, 3))
            return carried if seen is None else np.concatenate([seen.points, carried])

        shapes, stress = None, None
        if run is not None:
            self.nodes[element.name] = run.coordinates
            taken, values = [], []
            for record in self.shapes:
                at = run.coordinates(int(record))
                seen = skin.skin(at) if self.detail.skin else None
                taken.append(together(at, seen))
                if seen is not None:
                    values.append(np.concatenate([seen.values, np.full(len(held), np.nan)]))
            shapes, stress = np.array(taken), np.array(values) if values else None
        else:
            self.nodes[element.name] = lambda _record: rest
        points = together(rest, first)
        start = len(points) - len(held)
        self._carry(element.name, held, range(start, len(points)), points[start:])
        self._add_deformed(
            element,
            points=points,
            triangles=none.reshape(0, 3) if first is None else first.triangles,
            edges=None if first is None or not len(first.outline) else first.outline,
            shapes=shapes,
            stress=stress,
        )

    def _nodal(self, element: d.NodalShape) -> None:
        def places(record: int) -> NDArray[np.float64]:
            values = self._values(element.positions, np.array([record]))
            assert values is not None
            return values[0].reshape(-1, 3)

        recorded = self._values(element.positions, self.shapes)
        shapes = None if recorded is None else recorded.reshape(len(recorded), -1, 3)
        attached = self._points_on(element.name)
        held = self._world_at_rest(element.name, attached)
        nearest = [int(np.argmin(np.linalg.norm(element.points - point, axis=1))) for point in held]
        triangles = np.empty((0, 3), dtype=np.int64) if element.triangles is None else element.triangles
        self._add_deformed(
            element,
            points=np.array(element.points, dtype=np.float64),
            triangles=triangles,
            edges=np.empty((0, 2), dtype=np.int64) if len(triangles) else None,
            shapes=shapes,
        )
        self._carry(element.name, attached, nearest, held)
        self.nodes[element.name] = (
            (lambda _record: element.points[:, np.newaxis])
            if recorded is None
            else (lambda record: places(record)[:, np.newaxis])
        )

    def _world_at_rest(self, name: str, points: NDArray[np.float64]) -> NDArray[np.float64]:
        body = self.bodies[name]
        if not hasattr(body, "orientation"):
            return points
        found: NDArray[np.float64] = body.position + points @ rotation_matrix(body.orientation).T
        return found

    def _colour(self, name: str) -> str:
        names = list(self.bodies)
        return (
            ROLES["ground"].colour if name == GROUND else BODY_COLOURS[names.index(name) % len(BODY_COLOURS)]
        )

    # rigid bodies

    def _rigid_elements(self) -> tuple[list[d.Solid], dict[str, d.Solid]]:
        """Surfaces that bodies and the ground have, and of rigid bodies that have none the boxes of their inertia."""
        solids = [one for one in self._of(d.Solid) if one.at is None]
        found = [one for one in solids if one.role not in {"box", "hull"}]
        seen = {one.body for one in found if one.role != "deck"}
        for one in solids:
            if one.role == "hull" and one.body not in seen:
                found.append(one)
                seen.add(one.body)
        seen |= {one.body for one in self._of(d.Solid) if one.role == "touch"}
        seen |= {one.at.body for one in self._of(d.Segments)}
        seen |= {one.contour.body for one in self._of(d.Spline)}
        boxes = {one.body: one for one in solids if one.role == "box" and one.body not in seen}
        return found, boxes

    def _rigid(self, solids: Sequence[d.Solid], boxes: dict[str, d.Solid]) -> None:
        span = self.drawn.size
        window = self.drawn.box + 0.5 * span * np.array([[-1.0], [1.0]])
        for part in solids:
            points, triangles, name, wide = part.points, part.triangles, part.body, False
            if part.body == GROUND:
                name = part.name
                wide = float(np.linalg.norm(np.ptp(points, axis=0))) > span
                if wide:
                    points, triangles, _ = clip_triangles(points, triangles, window)
                    self.drawn.notes.append(f"{name} is drawn as far as bodies get near it.")
            role: d.Drawn = "ground" if part.body == GROUND else "body"
            self._add(name, role, part.body, points, triangles, edges=part.edges, background=wide)
        ridden = {wheel.at.body for wheel in self._of(d.Wheel) if wheel.role == "wheel"}
        hides = any(name in ridden or self._encloses(name, one) for name, one in boxes.items())
        for name, one in boxes.items():
            self._add(name, "box", name, one.points, one.triangles, opacity=_GLASS if hides else 1.0)
        if boxes:
            self.drawn.notes.append(
                f"Boxes of the same mass and inertia stand for {_some(list(boxes))}, without a surface."
            )

    def _encloses(self, name: str, box: d.Solid) -> bool:
        """Whether the box of a body hides others at the start: its inertia may be that of a much larger thing."""
        pose = self.drawn.poses[self.index[name]]
        origin, R = pose.position[0], pose.matrix(0)
        sides = box.points[[4, 2, 1]] - box.points[0]
        for other in self.bodies:
            if other == name:
                continue
            if other in self.deformed and self.index[other] < 0:
                places = self.nodes[other](int(self.records[0]))[:, 0]
            elif other in self.deformed:
                surface, own = self.drawn.surfaces[self.deformed[other]], self.drawn.poses[self.index[other]]
                places = own.position[0] + surface.points @ own.matrix(0).T
            else:
                own = self.drawn.poses[self.index[other]]
                places = own.world(own.centre)[:1]
            shares = ((places - origin) @ R - box.points[0]) @ sides.T / np.sum(sides**2, axis=1)
            if np.any(np.all((shares > 0.0) & (shares < 1.0), axis=1)):
                return True
        return False

    def _add(
        self,
        name: str,
        role: d.Drawn,
        body: str,
        points: NDArray[np.float64],
        triangles: NDArray[np.int64],
        *,
        colour: str = "",
        edges: bool = True,
        **more: Any,
    ) -> None:
        if not len(triangles):
            return
        own = self._colour(body) if role in {"body", "box", "ground"} else ROLES[role].colour
        self.drawn.surfaces.append(
            Surface(
                name=name,
                role=role,
                body=self.index[body],
                points=np.asarray(points, dtype=np.float64),
                triangles=np.asarray(triangles, dtype=np.int64),
                colour=colour or own,
                edges=np.empty((0, 2), dtype=np.int64) if edges else None,
                **more,
            )
        )

    def _find_box(self, solids: Sequence[d.Solid], boxes: dict[str, d.Solid]) -> None:
        """Where bodies get that move or deform; all bodies if none does. What leaves the scene does not count."""
        moving = {
            name
            for name, body in self.bodies.items()
            if name in self.deformed or not isinstance(getattr(body, "motion", None), Fixed)
        } or set(self.bodies)
        corners: dict[str, list[NDArray[np.float64]]] = {}
        for part in solids:
            if part.body != GROUND and len(part.points):
                corners.setdefault(part.body, []).append(box_corners(part.points))
        for name, one in boxes.items():
            corners.setdefault(name, []).append(one.points)
        for name, number in self.deformed.items():
            if len(points := self.drawn.surfaces[number].points):
                corners.setdefault(name, []).append(box_corners(points))
        self.drawn.sizes = {
            name: float(np.linalg.norm(np.ptp(np.concatenate(own), axis=0))) for name, own in corners.items()
        }
        samples = _spread(len(self.records), _SAMPLES)
        parts: list[tuple[NDArray[np.float64], NDArray[np.float64]]] = []
        begins: list[int] = []  # parts at the first record
        for pose in self.drawn.poses:
            if pose.name not in moving:
                continue
            own = np.concatenate([pose.centre[np.newaxis], *corners.get(pose.name, ())])
            begins.append(len(parts))
            with np.errstate(all="ignore"):
                for k in samples:
                    at = pose.position[k] + own @ pose.matrix(int(k)).T
                    parts.append((at.min(axis=0), at.max(axis=0)))
        for name, number in self.deformed.items():
            surface = self.drawn.surfaces[number]
            if self.index[name] >= 0:
                continue
            if len(surface.triangles):
                shapes = () if surface.shapes is None else surface.shapes
                taken: list[NDArray[np.float64]] = [surface.points, *shapes]
            else:
                nodes = self.nodes[name]
                taken = [nodes(int(self.records[k]))[:, 0] for k in samples]
            begins.append(len(parts))
            parts += [(points.min(axis=0), points.max(axis=0)) for points in taken]
        if not parts:
            return
        lows, highs = np.array([low for low, _ in parts]), np.array([high for _, high in parts])
        start = np.abs(np.concatenate([lows[begins], highs[begins]]))
        usual = float(np.median(np.abs(np.concatenate([lows, highs])))) + float(start.max()) + 1.0
        good = np.all(np.isfinite(lows) & np.isfinite(highs), axis=1)
        good &= np.all((np.abs(lows) < 100.0 * usual) & (np.abs(highs) < 100.0 * usual), axis=1)
        if good.any():
            low, high = lows[good].min(axis=0), highs[good].max(axis=0)
            if np.linalg.norm(high - low) < 1e-9:
                low, high = low - 0.5, high + 0.5
            self.drawn.box = np.array([low, high])
        self.drawn.reached = (
            np.stack([lows, highs], axis=1)[good] if good.any() else self.drawn.box[np.newaxis]
        )

    # what is fixed to bodies

    def _attach(self, places: Sequence[d.At]) -> dict[str, Any]:
        """Body, point in its axes, and the point of a surface that carries it, of some places."""
        on, local, surface, vertex = [], [], [], []
        for body, point in places:
            at, number, carrier = np.asarray(point, dtype=np.float64), self.deformed.get(body, -1), -1
            if number >= 0:
                known = self.held.get((body, tuple(map(float, at))))
                if known is None:  # the end of an axis: as what is next to it
                    at = at if self.index[body] >= 0 else self._world_at_rest(body, at)
                    points = self.drawn.surfaces[number].points
                    carrier = int(np.argmin(np.linalg.norm(points - at, axis=1)))
                else:
                    carrier, at = known
            on.append(self.index[body])
            local.append(at)
            surface.append(number)
            vertex.append(carrier)
        found: dict[str, Any] = {
            "on": np.array(on, dtype=np.int64),
            "local": np.array(local, dtype=np.float64).reshape(-1, 3),
        }
        if max(surface, default=-1) >= 0:
            found |= {
                "surface": np.array(surface, dtype=np.int64),
                "vertex": np.array(vertex, dtype=np.int64),
            }
        return found

    def _anchored(self, at: d.At) -> tuple[NDArray[np.float64], Anchor | None]:
        """A place in axes of its body, and what carries it."""
        placed = self._attach([at])
        carried = "surface" in placed
        return placed["local"][0], (
            Anchor(int(placed["surface"][0]), int(placed["vertex"][0])) if carried else None
        )

    def _world(self, at: d.At) -> NDArray[np.float64]:
        """Where a point of a body is at the poses [m], shape (k, 3)."""
        point, anchor = self._anchored(at)
        local = np.repeat(point[np.newaxis], len(self.records), axis=0)
        if anchor is not None:
            surface = self.drawn.surfaces[anchor.surface]
            if surface.modes is not None:
                assert surface.amplitudes is not None
                local = local + surface.amplitudes @ surface.modes[:, anchor.point]
            elif surface.shapes is not None:
                moved = surface.shapes[:, anchor.point] - surface.points[anchor.point]
                times = self.drawn.times
                if len(self.shapes) < len(self.records):
                    moved = np.column_stack(
                        [np.interp(times[POSES], times[SHAPES], moved[:, axis]) for axis in range(3)]
                    )
                local = local + moved
        number = self.index[at.body]
        return local if number < 0 else self.drawn.poses[number].world(local)

    def _line(self, element: d.Element, places: Sequence[d.At], **more: Any) -> None:
        self.drawn.lines.append(Line(name=element.name, role=element.role, **self._attach(places), **more))

    def _attached_solid(self, element: d.Solid) -> None:
        if element.at is None:
            return  # see `_rigid`
        at, anchor = self._anchored(d.At(element.body, element.at))
        self._add(
            element.name, element.role, element.body, at + element.points, element.triangles, anchor=anchor,
            edges=element.edges,
        )  # fmt: skip

    def _segments(self, element: d.Segments) -> None:
        """Points about one that carries all of them."""
        placed = self._attach([element.at] * len(element.points))
        placed["local"] = placed["local"] + element.points
        self.drawn.lines.append(Line(name=element.name, role=element.role, ends=element.ends, **placed))

    def _strut(self, element: d.Strut) -> None:
        if element.role == "joint":
            self._line(_whole_name(element), element.ends, ends=np.array([[0, 1]]))
        else:
            share = 0.6 if element.coiled else 1.0
            self._line(element, element.ends, radius=share * self.drawn.radius, coiled=element.coiled)

    def _mark(self, element: d.Mark) -> None:
        at, anchor = self._anchored(element.at)
        body, one = self.index[element.at.body], _whole_name(element)
        self.drawn.dots.append(Dot(name=one.name, role=one.role, body=body, at=at, anchor=anchor))

    def _axes(self, element: d.Axes) -> None:
        body, origin = element.at.body, np.asarray(element.at.point, dtype=np.float64)
        for axis, colour in zip(np.asarray(element.axes).T, _AXIS_COLOURS, strict=True):
            ends = [element.at, d.At(body, origin + 0.05 * self.drawn.size * axis)]
            self._line(_whole_name(element), ends, colour=colour, radius=0.5 * self.drawn.radius)

    def _text(self, element: d.Text) -> None:
        at, _ = self._anchored(element.at)
        self.drawn.labels.append(Label(element.name, self.index[element.at.body], at, element.text))

    def _rope(self, element: d.RopeLine) -> None:
        values = self._values(element.tension)
        if values is not None:
            values = values.max(axis=1) if element.component is None else values[:, element.component]
        more: dict[str, Any] = {
            "tension": values,
            "loose": self.loose.get(element.name),
            "radius": self.drawn.radius,
        }
        if not any(stop.radius > 0.0 for stop in element.stops):
            self._line(element, [stop.at for stop in element.stops], **more)
            return
        self.drawn.lines.append(
            Line(name=element.name, role=element.role, **self._reeved(element.stops), **more)
        )
        for stop in element.stops:
            if stop.radius > 0.0:
                at, anchor = self._anchored(stop.at)
                self.drawn.discs.append(
                    Disc(
                        name=element.name,
                        role="sheave",
                        body=self.index[stop.at.body],
                        at=at,
                        axis=np.asarray(stop.axis, dtype=np.float64),
                        radius=stop.radius,
                        width=0.25 * stop.radius,
                        anchor=anchor,
                    )
                )

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

    def _reeved(self, stops: Sequence[d.Stop]) -> dict[str, Any]:
        """A rope about pulleys: its points at every pose, in the axes of the bodies that carry them."""
        centres = [self._world(stop.at) for stop in stops]
        axes = []
        for stop in stops:
            axis = np.asarray(stop.axis, dtype=np.float64)
            unit = axis / (np.linalg.norm(axis) or 1.0)
            number = self.index[stop.at.body]
            turned = np.broadcast_to(unit, centres[0].shape)
            axes.append(
                turned if number < 0 else np.einsum("kij,j->ki", self.drawn.poses[number].matrices, unit)
            )
        on: list[int] = []
        local: list[NDArray[np.float64]] = []
        found = rope_points(centres, [stop.radius for stop in stops], axes, arc=self.detail.arc)
        for stop, points in zip(stops, found, strict=True):
            number = self.index[stop.at.body]
            on += [number] * points.shape[1]
            local.append(points if number < 0 else self.drawn.poses[number].local(points))
        return {"on": np.array(on, dtype=np.int64), "local": np.concatenate(local, axis=1)}

    def _nodal_line(self, element: d.NodalShape) -> None:
        """A line through the points of a surface without triangles."""
        if element.triangles is not None:
            return
        count, tension = len(element.points), self._values(element.tension) if element.tension else None
        self.drawn.lines.append(
            Line(
                name=element.name,
                role=element.role,
                on=np.full(count, -1, dtype=np.int64),
                local=np.array(element.points, dtype=np.float64),
                surface=np.full(count, self.deformed[element.name], dtype=np.int64),
                vertex=np.arange(count, dtype=np.int64),
                radius=element.radius or self.drawn.radius,
                tension=None if tension is None else tension.max(axis=1),
            )
        )

    def _wheel(self, element: d.Wheel) -> None:
        at, anchor = self._anchored(element.at)
        moved = element.offset
        values = None if moved is None else self._values(moved.channel)
        offset = None
        if moved is not None and values is not None and moved.component < values.shape[1]:
            offset = values[:, [moved.component]] * moved.direction
        self.drawn.discs.append(
            Disc(
                name=element.name,
                role=element.role,
                body=self.index[element.at.body],
                at=at,
                axis=element.axis,
                radius=element.radius,
                width=element.width,
                anchor=anchor,
                offset=offset,
            )
        )

    def _pad(self, element: d.Pad) -> None:
        at, anchor = self._anchored(element.at)
        outline = pad(at, element.normal, self.drawn.slim)
        self._add(
            element.name, element.role, element.at.body, outline.points, outline.triangles, edges=False,
            anchor=anchor,
        )  # fmt: skip

    def _filling(self, element: d.Filling) -> None:
        mass = np.interp(self.drawn.times[POSES], element.times, element.masses)
        density = element.density
        if density is None:
            assert self.scene.sea is not None
            density = self.scene.sea.water.density
        at, anchor = self._anchored(element.at)
        outline = ball(np.ones(3))
        note = "Balls stand for the water in tanks: as much as they hold, about its centre."
        self.drawn.notes += [note] * (note not in self.drawn.notes)
        self._add(
            element.name, element.role, element.at.body, outline.points, outline.triangles, edges=False, at=at,
            size=np.cbrt(3.0 * mass / (4.0 * np.pi * density)), anchor=anchor,
        )  # fmt: skip

    def _spline(self, element: d.Spline) -> None:
        """The lines of a contour and its surface; of one on a body with modes the surface of a tube or band alone."""
        contour = element.contour
        number, on = self.deformed.get(contour.body, -1), self.index[contour.body]
        shape = self.contours.get(element.name) or contour_shape(contour)
        modes = shape.modes if self.detail.splines else None
        if len(shape.triangles):
            self._add(
                element.name, element.role, contour.body, shape.points, shape.triangles, edges=False,
                colour=ROLES["ground"].colour, modes=modes,
                amplitudes=None if modes is None else self.drawn.surfaces[number].amplitudes,
            )  # fmt: skip
        count, first = len(shape.line), self.splines.get(element.name)
        if first is None:
            placed = self._attach([d.At(contour.body, point) for point in shape.line])
        else:
            placed = {
                "on": np.full(count, on, dtype=np.int64),
                "local": shape.line,
                "surface": np.full(count, number, dtype=np.int64),
                "vertex": np.arange(first, first + count, dtype=np.int64),
            }
        self.drawn.lines.append(Line(name=element.name, role=element.role, ends=shape.ends, **placed))

    def _rods(self, solids: Sequence[d.Solid], boxes: Mapping[str, d.Solid]) -> None:
        """From centres of mass to what is attached; none to what is attached to a surface."""
        near = [(part.body, *_grown_box(part.points)) for part in solids]
        hubs = {mark.at.body: mark.at.point for mark in self._of(d.Mark) if mark.role == "centre"}
        held = [at for one in self._of(d.Strut, d.RopeLine, d.Hanging) for at in _places(one)]
        skins = {one.name for one in self._of(d.Skin)}
        joints = [{at.body for at in one.ends} for one in self._of(d.Strut) if one.role == "joint"]
        holding = {name for pair in joints if pair & skins for name in pair}
        for owner, points, pairs in rods(hubs, held, holding, boxes):
            free = [
                pair
                for pair in pairs.tolist()
                if not any(
                    body == owner and np.all((points[pair[1]] >= low) & (points[pair[1]] <= high))
                    for body, low, high in near
                )
            ]
            if free:
                rod = d.Element(name=owner, role="rod")
                self._line(rod, [d.At(owner, point) for point in points], ends=np.array(free))

    # sea

    def _sea(self) -> None:
        sea = self.scene.sea
        if sea is None:
            return
        drawn, span = self.drawn, self.drawn.size
        low, high = drawn.box[0] - 1.5 * span, drawn.box[1] + 1.5 * span
        waves = None
        if sea.waves is not None:
            train = sea.waves
            chosen = np.argsort(-train.amplitude)[: self.detail.waves]
            if len(chosen) < len(train.amplitude):
                left = 1.0 - float(np.sum(train.amplitude[chosen] ** 2) / np.sum(train.amplitude**2))
                drawn.notes.append(
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
            drawn.notes.append("The water has the incident waves, undisturbed by hulls.")
        if self.sources.water:
            drawn.water = WaterShape(low, high, sea.water.level, waves)
        self._moorings(self._of(d.Hanging))

    def _moorings(self, hanging: Sequence[d.Hanging]) -> None:
        drawn = self.drawn
        chosen = _spread(len(self.records), max(2, self.detail.moorings // max(1, len(hanging))))
        drawn.times[HANGING] = drawn.times[POSES][chosen]
        if hanging and len(chosen) < len(self.records):
            drawn.notes.append(f"Shapes of mooring lines are those of {len(chosen):,} records.")
        bottoms: dict[float, list[NDArray[np.float64]]] = {}
        for element in hanging:
            ends = [self._world(at)[chosen] for at in element.ends]
            shapes = []
            for anchor, fairlead in zip(*ends, strict=True):
                try:
                    points = hanging_line(element.line, anchor, fairlead).points
                except InputError:  # no equilibrium between these ends
                    points = np.array([anchor, fairlead])
                shapes.append(_resampled(points, self.detail.hanging))
            local = np.array(shapes)
            if element.line.seabed is not None:
                bottoms.setdefault(float(element.line.seabed), []).append(local.reshape(-1, 3))
            tension = self._values(element.tension)
            drawn.lines.append(
                Line(
                    name=element.name,
                    role=element.role,
                    on=np.full(local.shape[1], -1, dtype=np.int64),
                    local=local,
                    radius=drawn.radius,
                    timeline=HANGING,
                    tension=None if tension is None else tension.max(axis=1),
                )
            )
        for number, (level, parts) in enumerate(bottoms.items()):
            low, high = np.min(np.concatenate(parts), axis=0), np.max(np.concatenate(parts), axis=0)
            more = 0.05 * (high - low).max()
            x, y = (low[0] - more, high[0] + more), (low[1] - more, high[1] + more)
            plane = np.array([[x[i], y[j], level] for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))])
            name = "seabed" if number == 0 else f"seabed {number + 1}"
            triangles = np.array([[0, 1, 2], [0, 2, 3]])
            self._add(name, "seabed", GROUND, plane, triangles, edges=False, background=True)

    # forces

    def _forces(self) -> None:
        if self.results is None:
            return
        found: list[Arrows] = []
        every = np.arange(len(self.results.time))
        for contact in self.scene.contacts:
            force, point = (self._values(f"{contact.name}.{key}", every) for key in ("force", "point"))
            if force is not None and point is not None and force.shape[1] == 3:
                found.append(self._arrows(contact.name, point[:, np.newaxis], force[:, np.newaxis]))
        for name in dict.fromkeys(m[1] for m in map(_CONTACT.match, self.results) if m):
            points, forces = [], []
            number = 1
            while f"{name}.contact_{number}.normal" in self.results:
                prefix = f"{name}.contact_{number}"
                number += 1
                normal, force, point = (
                    self._values(f"{prefix}.{key}", every) for key in ("normal", "force", "point")
                )
                if normal is not None and force is not None and point is not None:
                    points.append(point)
                    forces.append(normal * force)
            if points:
                place, forces_of = np.stack(points, axis=1), np.stack(forces, axis=1)
                found.append(self._arrows(name, place, forces_of, collision=True))
        arrows = [one for one in found if one.force.shape[1]]
        most = self.detail.arrow_bytes // (12 * max(1, sum(one.force.shape[1] for one in arrows)))
        chosen = _spread(len(self.records), max(50, most))
        self.drawn.times[TOUCHES] = self.drawn.times[POSES][chosen]
        if arrows and len(chosen) < len(self.records):
            self.drawn.notes.append(f"Forces at contacts are those of {len(chosen):,} records.")
        for one in arrows:
            one.place, one.force = one.place[chosen], one.force[chosen]
        self.drawn.arrows = arrows

    def _arrows(
        self, name: str, place: NDArray[np.float64], force: NDArray[np.float64], *, collision: bool = False
    ) -> Arrows:
        """Forces at all records, of which those are kept that are ever there, at the poses."""
        force = np.where(np.isfinite(force), force, 0.0)
        largest = float(np.linalg.norm(force, axis=2).max(initial=0.0))
        place, force = place[self.records], force[self.records]
        used = np.any(force != 0.0, axis=(0, 2))
        return Arrows(
            name=name, role="touch", place=place[:, used], force=force[:, used], largest=largest,
            collision=collision,
        )  # fmt: skip

    # at the end

    def _note_thinned(self, name: str, before: int, after: int) -> None:
        self.drawn.notes.append(f"The surface of {name} is drawn with {after:,} of its {before:,} triangles.")

    def _widen(self) -> None:
        """Ropes, springs and joints that are near are seen with the bodies."""
        box = self.drawn.box
        reach = box + _RIGGING * self.drawn.size * np.array([[-1.0], [1.0]])
        samples = _spread(len(self.records), _SAMPLES)
        for line in self.drawn.lines:
            if line.group not in {"ropes", "forces", "joints"}:
                continue
            for k in samples:
                local = line.local[k] if line.local.ndim == 3 else line.local
                at = np.array(
                    [
                        point
                        if number < 0
                        else self.drawn.poses[number].position[k]
                        + self.drawn.poses[number].matrix(int(k)) @ point
                        for number, point in zip(line.on, local, strict=True)
                    ]
                )
                at = at[np.all((at >= reach[0]) & (at <= reach[1]), axis=1)]
                if len(at):
                    box = np.array([np.minimum(box[0], at.min(axis=0)), np.maximum(box[1], at.max(axis=0))])
        self.drawn.view_box = box

    def _thin(self) -> None:
        """Fewer triangles of surfaces that are too fine, and the edges of all."""
        rigid = [one for one in self.drawn.surfaces if one.modes is None and one.shapes is None]
        left = self.detail.triangles - sum(
            len(one.triangles) for one in self.drawn.surfaces if one not in rigid
        )
        total = sum(len(one.triangles) for one in rigid)
        carrying = {self.deformed[body] for body, _ in self.held}
        for number, surface in enumerate(self.drawn.surfaces):
            if surface not in rigid or number in carrying:
                continue
            most = max(200, int(left * len(surface.triangles) / max(total, 1)))
            if total > left and len(surface.triangles) > most:
                triangles, kept = thinned(surface.points, surface.triangles, most)
                self._note_thinned(surface.name, len(surface.triangles), len(triangles))
                surface.points, surface.triangles = surface.points[kept], triangles
            if len(surface.triangles) > _COARSE:
                coarse, kept = thinned(surface.points, surface.triangles, _COARSE)
                surface.coarse = kept[coarse]
            if surface.edges is not None:
                few = len(surface.triangles) <= _EDGES
                surface.edges = (
                    feature_edges(surface.points, surface.triangles, _KINK, wound=False) if few else None
                )

    def _name(self) -> None:
        names = [Label(pose.name, self.index[pose.name], pose.centre, pose.name) for pose in self.drawn.poses]
        for name, number in self.deformed.items():
            if self.index[name] < 0:
                points = self.drawn.surfaces[number].points
                if len(points):
                    names.append(Label(name, -1, points[len(points) // 2], name))
        self.drawn.labels[:0] = names

    def _scale(self) -> None:
        """Deformations that would not be seen are drawn larger, if nothing is fixed to what deforms."""
        fixed = any(line.surface is not None and np.any(line.surface >= 0) for line in self.drawn.lines)
        if fixed or not self.deformed or self.drawn.arrows:
            return
        moved = 0.0
        for number in self.deformed.values():
            surface = self.drawn.surfaces[number]
            if surface.modes is not None and surface.amplitudes is not None:
                for k in _spread(len(self.records), _SAMPLES):
                    u = np.tensordot(surface.amplitudes[k], surface.modes, axes=1)
                    moved = max(moved, float(np.linalg.norm(u, axis=1).max(initial=0.0)))
            elif surface.shapes is not None:
                far = np.linalg.norm(surface.shapes - surface.points, axis=2)
                moved = max(moved, float(far.max(initial=0.0)))
        size = self.drawn.view_size
        if 0.0 < moved < 1.0e-2 * size:
            self.drawn.scale = deformation_scale(np.array([[moved, 0.0, 0.0]]), size)
            self.drawn.notes.append(
                f"Deformations are drawn {self.drawn.scale:g} times as large as they are, until another scale is "
                "chosen."
            )


def _places(element: d.Element) -> Iterable[d.At]:
    """Points of bodies that an element refers to; a contour is attached where its points are."""
    for field in fields(element):
        value = getattr(element, field.name)
        if isinstance(value, d.At):
            yield value
        elif field.name == "ends" and isinstance(value, tuple):
            yield from value
        elif field.name == "stops":
            yield from (stop.at for stop in value)
    if isinstance(element, d.Solid) and element.at is not None:
        yield d.At(element.body, element.at)


def _whole_name(element: d.Element) -> d.Element:
    """An element by the name of the joint whose part it is along an edge."""
    whole, _, number = element.name.rpartition(".")
    return d.Element(name=whole if number.isdigit() else element.name, role=element.role)


def _grown_box(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lowest and highest corner of a box around points, and a little more."""
    low, high = points.min(axis=0), points.max(axis=0)
    more = _BESIDE * float(np.linalg.norm(high - low))
    return low - more, high + more


def _spread(count: int, most: int) -> NDArray[np.int64]:
    """Indices of at most so many records, the first and the last among them."""
    return np.unique(np.linspace(0, max(count - 1, 0), min(count, most)).round().astype(np.int64))


def _resampled(points: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """So many points along a polyline."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    at = np.linspace(0.0, along[-1], count)
    return np.column_stack([np.interp(at, along, points[:, axis]) for axis in range(3)])


def _some(names: list[str]) -> str:
    return ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
