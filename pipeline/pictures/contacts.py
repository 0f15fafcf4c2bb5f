"""Contours, what touches them, and the forces between them: as lines and surfaces, and as a picture of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.pictures.annotations import (
    add_heading,
    add_scale_bar,
    add_triad,
    add_words,
    emptiest_corner,
)
from heavylift.pipeline.pictures.camera import choose_view, fit_camera
from heavylift.pipeline.pictures.drawings import INK, round_down
from heavylift.pipeline.pictures.outer_surface import Surface, feature_edges
from heavylift.pipeline.pictures.parts import ROUND, Parts, chain, force_arrow, grid_triangles, shape_parts
from heavylift.pipeline.pictures.plots import figure_png
from heavylift.pipeline.pictures.render import Drawing, Lines, Patch, rgb
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.meshes import MeshBody
from heavylift.solver.scene.scene import FlexibleBody

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import ArrayLike, NDArray

    from heavylift.contours.splines.neutral import NeutralContour
    from heavylift.pipeline.pictures.camera import Camera
    from heavylift.pipeline.pictures.parts import Seen
    from heavylift.pipeline.pictures.render import Renderer
    from heavylift.solver.scene import contacts as c
    from heavylift.solver.scene.scene import Scene

    Pose = Callable[[str, int], tuple[NDArray[np.float64], NDArray[np.float64]]]
    Channel = Callable[[str, int], NDArray[np.float64] | None]

__all__ = [
    "ContactParts",
    "contour_parts",
    "kinks",
    "scene_size",
    "touch_camera",
    "touch_picture",
]

_CONTOUR, _GROUND = "#8e3b9c", "#dfe4ea"
_PIECES = 3  # samples of a polynomial piece of a contour
_LINES = 13  # lines of a contour in each direction at most
_ARROW = 0.2  # length of the arrow of the largest force, relative to the scene


class ContactParts:
    """Draws the contours and contacts of a scene at any record.

    Contours that are the shape of a frame or shell are drawn as that.

    Parameters
    ----------
    scene
        What was simulated.
    pose
        Origin and rotation of a body that is no mesh, or of the world, by name and record.
    position
        Place of a point of a body in the world, by the number of its contact and record.
    channel
        Recorded channel at a record, by name and record; None if it is not recorded.
    peak
        Largest force of any contact in the run [N], whose arrow is the longest one.
    size
        Of the scene [m].
    """

    def __init__(
        self,
        scene: Scene,
        pose: Pose,
        position: Callable[[int, int], NDArray[np.float64]],
        channel: Channel,
        *,
        peak: float = 0.0,
        size: float = 1.0,
    ) -> None:
        self._scene, self._pose, self._position, self._channel = scene, pose, position, channel
        self._peak, self._size = peak, size
        self._flexible = {body.name for body in scene.bodies if isinstance(body, FlexibleBody)}
        self._meshes = {body.name for body in scene.bodies if isinstance(body, MeshBody)}

    def seen(self, record: int) -> Parts:
        """What is drawn at a record, world axes [m]."""
        parts = [part for contour in self._scene.contours for part in self._contour(contour, record)]
        parts += [
            part
            for number, contact in enumerate(self._scene.contacts)
            for part in self._contact(number, contact, record)
        ]
        return Parts(
            tuple(line for part in parts for line in part.lines),
            tuple(patch for part in parts for patch in part.patches),
            tuple(mark for part in parts for mark in part.marks),
        )

    def _contour(self, contour: c.Contour, record: int) -> list[Parts]:
        if contour.neutral is None:
            return []
        modal = self._channel(f"{contour.body}.modal_position", record)
        deformed = contour.neutral if modal is None else contour.neutral.deformed(np.atleast_1d(modal))
        # on a body that is drawn itself the lines are enough
        parts = contour_parts(contour, deformed, filled=contour.body not in self._flexible)
        return [parts.placed(*self._pose(contour.body, record))]

    def _contact(self, number: int, contact: c.Contact, record: int) -> list[Parts]:
        place = self._position(number, record)
        R = np.eye(3) if contact.body in self._meshes else self._pose(contact.body, record)[1]
        parts = [shape_parts(contact.shape).placed(place, R)]
        force = self._channel(f"{contact.name}.force", record)
        touched = self._channel(f"{contact.name}.point", record)
        if force is not None and touched is not None and self._peak > 0.0 and np.any(force):
            arrow = force * (_ARROW * self._size / self._peak)
            parts.append(Parts(lines=(force_arrow(touched, arrow),)))
        return parts


def scene_size(scene: Scene) -> float:
    """Diagonal of the box around the bodies, contours and surfaces of bodies of a scene at the start [m]."""
    points: list[NDArray[np.float64]] = []
    frames = {GROUND: (np.zeros(3), np.eye(3))}
    for body in scene.bodies:
        frames[body.name] = body.position, rotation_matrix(body.orientation)
        nodes = np.zeros((1, 3))
        if isinstance(body, MeshBody):
            nodes = body.nodes
        elif isinstance(body, FlexibleBody):
            nodes = body.reduced.nodes
        points.append(body.position + nodes @ frames[body.name][1].T)
    for contour in scene.contours:
        if contour.neutral is not None:
            origin, R = frames[contour.body]
            points.append(origin + contour.neutral.control @ R.T)
    for part in scene.surfaces:
        if part.surface is not None and part.body != GROUND:
            origin, R = frames[part.body]
            points.append(origin + part.surface.points @ R.T)
    return float(np.linalg.norm(np.ptp(np.concatenate(points), axis=0))) or 1.0


def contour_parts(contour: c.Contour, neutral: NeutralContour, *, filled: bool) -> Parts:
    """A contour in the axes of its body, its spline already deformed; `filled` adds the surface to its lines."""
    from heavylift.contours.splines.derivatives import sample_grid

    _, values = sample_grid(neutral, _PIECES)
    points = values[..., 0, :]
    closed = [space.closed for space in neutral.spaces]
    if neutral.is_surface:
        lines = _net(points, closed)
        patch = (Patch(points.reshape(-1, 3), grid_triangles(points.shape[:2], closed), _GROUND),)
        return Parts((lines,), patch if filled else ())
    tangents = values[:, 1] / np.linalg.norm(values[:, 1], axis=1, keepdims=True)
    line = Lines(points, chain(len(points), closed[0]), _CONTOUR, 2.5)
    if contour.radius > 0.0:
        first = np.eye(3)[np.argmin(np.abs(tangents[0]))]
        across = _carried(tangents, first)
        turns = 2.0 * np.pi * np.arange(ROUND) / ROUND
        other = np.cross(tangents, across)
        rings = np.cos(turns)[:, None] * across[:, None] + np.sin(turns)[:, None] * other[:, None]
        tube = points[:, None] + contour.radius * rings
        return Parts(
            (line,), (Patch(tube.reshape(-1, 3), grid_triangles(tube.shape[:2], [closed[0], True]), _GROUND),)
        )
    if contour.width > 0.0:
        normals = np.cross(contour.sequencer, tangents)
        across = np.cross(tangents, normals / np.linalg.norm(normals, axis=1, keepdims=True))
        half = 0.5 * contour.width * across
        strip = np.stack([points - half, points, points + half], axis=1)
        return Parts(
            (line,),
            (Patch(strip.reshape(-1, 3), grid_triangles(strip.shape[:2], [closed[0], False]), _GROUND),),
        )
    return Parts((line,))


def _carried(tangents: NDArray[np.float64], sequencer: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit vectors across a curve that turn with its tangent and no more, shape (k, 3)."""
    found = np.empty_like(tangents)
    across = np.asarray(sequencer, dtype=np.float64)
    for k, tangent in enumerate(tangents):
        across = across - (across @ tangent) * tangent
        across = across / np.linalg.norm(across)
        found[k] = across
    return found


def _net(points: NDArray[np.float64], closed: list[bool]) -> Lines:
    """Lines along both directions of a grid of points, few of them, those at the borders always."""
    numbers = np.arange(points.shape[0] * points.shape[1]).reshape(points.shape[:2])
    ends = []
    for axis in (0, 1):
        along = numbers if axis == 0 else numbers.T
        count = len(along.T) - (1 if closed[1 - axis] else 0)
        chosen = np.unique(np.linspace(0, count - 1, min(_LINES, count)).round().astype(int))
        steps = chain(len(along), closed[axis])
        ends += [along[steps, column] for column in chosen]
    return Lines(points.reshape(-1, 3), np.concatenate(ends), _CONTOUR, 1.2, 0.8)


SIZE = (1200, 760)
"""Width and height of a picture [pixels]."""
_DPI = 100
_HEAD, _FOOT = 84, 48  # pixels above and below the image
_LABEL = 90  # pixels of the length beside a scale bar
_KINK = np.radians(30.0)  # between two triangles whose edge is drawn
_EDGES = 60_000  # triangles up to which edges are drawn


def kinks(part: Patch) -> Lines:
    """Edges at which a surface has corners, or ends; none of a very fine one."""
    if len(part.triangles) > _EDGES:
        return Lines(part.points, np.empty((0, 2), dtype=np.int64))
    return Lines(part.points, feature_edges(part.points, part.triangles, _KINK, wound=False), INK, 0.8, 0.6)


class _Solid(NamedTuple):
    """What is opaque of a scene: points, triangles and their colours, and all lines."""

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    hues: NDArray[np.uint8]
    lines: tuple[Lines, ...]


def _solid(seen: Seen) -> _Solid:
    opaque = [part for part in seen.patches if part.opacity == 1.0]
    starts = np.cumsum([0, *(len(part.points) for part in opaque)])
    triangles = [part.triangles + start for part, start in zip(opaque, starts[:-1], strict=True)]
    hues = [np.tile(rgb(part.colour), (len(part.triangles), 1)) for part in opaque]
    edges = [kinks(part) for part in opaque]
    return _Solid(
        np.concatenate([np.empty((0, 3)), *(part.points for part in opaque)]),
        np.concatenate([np.empty((0, 3), dtype=np.int64), *triangles]),
        np.concatenate([np.empty((0, 3), dtype=np.uint8), *hues]),
        (*seen.lines, *edges),
    )


def touch_camera(
    scenes: Sequence[Seen], *, up: ArrayLike | None = None, size: tuple[int, int] = SIZE
) -> Camera:
    """Camera that sees all of one or more records, from where most outlines of the last one are visible.

    Parameters
    ----------
    scenes
        From `heavylift.pipeline.pictures.attached.Others`, lengths in metres; not all empty.
    up
        Direction against gravity, shape (3,), if there is gravity.
    size
        Width and height of the picture [pixels].
    """
    solid = _solid(scenes[-1])
    nodes, edges = [solid.points], [np.empty((0, 2), dtype=np.int64)]
    for line in solid.lines:
        edges.append(line.ends + sum(len(part) for part in nodes))
        nodes.append(line.points)
    together, outline = np.concatenate(nodes), np.concatenate(edges)
    surface = Surface(together, np.arange(len(together)), solid.triangles, outline, outline)
    points = np.concatenate([seen.points for seen in scenes])
    return fit_camera(choose_view(surface, up=up), points, size[0] / (size[1] - _HEAD - _FOOT), margin=0.06)


def touch_picture(
    renderer: Renderer,
    seen: Seen,
    *,
    title: str,
    note: str = "",
    words: str = "violet: contours · ochre: what touches · red: force on it",
    up: ArrayLike | None = None,
    size: tuple[int, int] = SIZE,
    camera: Camera | None = None,
    corner: tuple[int, int] | None = None,
    measured: NDArray[np.float64] | None = None,
) -> bytes | None:
    """All that is seen at one record, true to scale, as PNG; None if it is neither surface nor line.

    Parameters
    ----------
    renderer
        Draws the pixels.
    seen
        From `heavylift.pipeline.pictures.attached.Others`, lengths in metres.
    title, note
        First and second line of the heading.
    words
        What the colours are.
    up
        Direction against gravity, shape (3,), if there is gravity.
    size
        Width and height of the picture [pixels].
    camera, corner
        Of pictures that belong together: from `touch_camera`, and where the axes are drawn; chosen if absent.
    measured
        Points in whose middle the scale is that of the bar, shape (m, 3) [m]; all but what is around if absent.
    """
    from matplotlib.figure import Figure

    if not (seen.patches or seen.lines):
        return None
    solid = _solid(seen)
    camera = camera or touch_camera([seen], up=up, size=size)
    width, height = size
    image = (width, height - _HEAD - _FOOT)
    drawing = Drawing(
        solid.points
        if len(solid.points)
        else seen.points[:1],  # without triangles points are drawn: one, on a line
        solid.triangles,
        triangle_colours=solid.hues,
        lines=(*solid.lines, *(part for part in seen.around if isinstance(part, Lines))),
        marks=seen.marks,
        patches=tuple(part for part in seen.patches if part.opacity < 1.0)
        + tuple(part for part in seen.around if isinstance(part, Patch)),
    )
    pixels = renderer.render(drawing, camera, image)
    figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI, facecolor="white")
    figure.figimage(pixels, 0, _FOOT, origin="upper")
    add_heading(figure, title, note)
    axes = figure.add_axes((0.0, _FOOT / height, 1.0, image[1] / height), facecolor="none", zorder=1)
    axes.set(xlim=(0, image[0]), ylim=(0, image[1]))
    axes.set_axis_off()
    add_triad(axes, camera.view, corner or emptiest_corner(pixels))
    foot = figure.add_axes((0.0, 0.0, 1.0, _FOOT / height), facecolor="none")
    foot.set(xlim=(0, width), ylim=(0, _FOOT))
    foot.set_axis_off()
    measured = seen.points if measured is None else measured
    middle = 0.5 * (measured.min(axis=0) + measured.max(axis=0))
    ends = camera.project([middle, middle + camera.view.matrix[0]])
    per_metre = float(ends[1, 0] - ends[0, 0]) * image[0]
    length = round_down(0.2 * image[0] / per_metre)
    unit, factor = ("mm", 1.0e3) if length < 0.1 else ("m", 1.0)
    add_scale_bar(foot, length * factor, length * per_metre, unit)
    add_words(foot, words, width, 18.0 + length * per_metre + _LABEL)
    return figure_png(figure)
