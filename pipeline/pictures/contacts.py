"""Picture of all that is seen of a scene at one record, with its own scale and legend."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.pipeline.drawn.outer_surface import Surface, feature_edges
from heavylift.pipeline.drawn.scales import round_down
from heavylift.pipeline.pictures.annotations import (
    add_heading,
    add_scale_bar,
    add_triad,
    add_words,
    emptiest_corner,
)
from heavylift.pipeline.pictures.camera import choose_view, fit_camera
from heavylift.pipeline.pictures.drawings import INK
from heavylift.pipeline.pictures.plots import figure_png
from heavylift.pipeline.pictures.render import Drawing, Lines, Patch, rgb

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from heavylift.pipeline.pictures.camera import Camera
    from heavylift.pipeline.pictures.parts import Seen
    from heavylift.pipeline.pictures.render import Renderer

__all__ = [
    "kinks",
    "touch_camera",
    "touch_picture",
]

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
        From `heavylift.pipeline.pictures.scene_view.SceneView`, lengths in metres; not all empty.
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
        From `heavylift.pipeline.pictures.scene_view.SceneView`, lengths in metres.
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
