"""Picture of two surfaces that touch at one record: bodies, excluded triangles, forces at the points of contact."""

from __future__ import annotations

from dataclasses import replace
from textwrap import shorten
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.pipeline.drawn.outer_surface import feature_edges, surface_from_triangles
from heavylift.pipeline.drawn.scales import round_down
from heavylift.pipeline.drawn.triangles import clip_triangles, welded
from heavylift.pipeline.pictures.annotations import (
    GREY,
    add_heading,
    add_scale_bar,
    add_triad,
    emptiest_corner,
)
from heavylift.pipeline.pictures.camera import choose_view, fit_camera
from heavylift.pipeline.pictures.parts import force_arrow
from heavylift.pipeline.pictures.plots import figure_png
from heavylift.pipeline.pictures.render import Drawing, Lines, Patch, Points, rgb

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from heavylift.pipeline.pictures.camera import Camera
    from heavylift.pipeline.pictures.render import Renderer

__all__ = ["COLOURS", "Touching", "TouchingSurface", "collision_picture"]

COLOURS = ("#9fb6cc", "#d9b25f")
"""Of the first and the second surface."""
_EXCLUDED, _CONTACT, _EDGE = "#c9c9c9", "#c62828", "#3a4653"

_DPI = 100
_HEAD, _FOOT = 84, 48  # pixels above and below the image
_ARROW = 0.16  # length of the largest arrow, relative to the size of the smaller surface
_AROUND = 0.35  # of the larger surface, so much of the size of the smaller one is shown round it,
_FAR = 5.0  # and so much at most if it is far away
_FLAT = 1.0e-6  # relative depth
_SEEN_THROUGH = 0.22  # opacity of what encloses the other surface
_KINK = np.radians(30.0)  # between two triangles whose edge is drawn
_EDGES = 60_000  # triangles up to which edges are drawn


class TouchingSurface(NamedTuple):
    """A surface at one record, world axes.

    Attributes
    ----------
    points
        [m], shape (n, 3).
    triangles
        That take part, shape (m, 3).
    excluded
        That do not, shape (k, 3).
    label
        What it is called.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    excluded: NDArray[np.int64]
    label: str


class Touching(NamedTuple):
    """Two surfaces and what is recorded of their contacts.

    Attributes
    ----------
    surfaces
        First and second one.
    places
        Points of contact [m], shape (c, 3).
    arrows
        Along the forces on the second surface, the largest of the run of length 1, shape (c, 3).
    """

    surfaces: tuple[TouchingSurface, TouchingSurface]
    places: NDArray[np.float64]
    arrows: NDArray[np.float64]


def collision_picture(
    renderer: Renderer,
    seen: Touching,
    *,
    title: str,
    note: str = "",
    words: str = "red: force on the second surface",
    up: ArrayLike | None = None,
    size: tuple[int, int] = (1200, 760),
) -> bytes | None:
    """Both surfaces true to scale, as PNG; None if there is nothing to be drawn.

    Parameters
    ----------
    renderer
        Draws the pixels.
    seen
        What is drawn.
    title, note
        First and second line of the heading.
    words
        What the arrows are.
    up
        Direction against gravity, shape (3,), if there is gravity.
    size
        Width and height of the picture [pixels].

    Notes
    -----
    Of a surface much larger than the other, as a floor, only the surroundings of the other are drawn. One that encloses
    the other is seen through. Arrows are never hidden: they are moved towards the observer along the lines of sight.
    """
    from matplotlib.figure import Figure

    boxes = [_bounds(surface.points[surface.triangles.ravel()]) for surface in seen.surfaces]
    lengths = [float(np.linalg.norm(box[1] - box[0])) for box in boxes]
    small = int(np.argmin(lengths))
    scale = lengths[small] or lengths[1 - small] or 1.0
    apart = np.maximum(np.maximum(boxes[0][0] - boxes[1][1], boxes[1][0] - boxes[0][1]), 0.0)
    margin = np.clip(1.3 * float(np.linalg.norm(apart)), _AROUND * scale, _FAR * scale)
    window = _widened(boxes[small], seen.places, float(margin))
    parts = [_part(surface, window) for surface in seen.surfaces]
    if not len(parts[small].triangles):
        return None
    together = np.concatenate([part.points for part in parts])
    joined = np.concatenate([parts[0].triangles, parts[1].triangles + len(parts[0].points)])
    view = choose_view(surface_from_triangles(together, joined), up=up)
    width, height = size
    image = (width, height - _HEAD - _FOOT)
    arrows = [
        force_arrow(place, _ARROW * scale * arrow)
        for place, arrow in zip(seen.places, seen.arrows, strict=True)
        if np.any(arrow)
    ]
    everything = np.concatenate([together, *(arrow.points for arrow in arrows)])
    camera = fit_camera(view, everything, image[0] / image[1], margin=0.05)
    glass = _encloses(boxes[1 - small], boxes[small]) and not _is_flat(parts[1 - small].points)
    drawing = _drawing(parts, glass=1 - small if glass else -1)
    drawing = replace(
        drawing,
        lines=(
            *drawing.lines,
            *(Lines(_before(a.points, camera, together), a.ends, _CONTACT, 3.0) for a in arrows),
        ),
        marks=(Points(_before(seen.places, camera, together), _CONTACT, 6.0),) if len(seen.places) else (),
    )
    pixels = renderer.render(drawing, camera, image)
    figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI, facecolor="white")
    figure.figimage(pixels, 0, _FOOT, origin="upper")
    add_heading(figure, title, note)
    axes = figure.add_axes((0.0, _FOOT / height, 1.0, image[1] / height), facecolor="none", zorder=1)
    axes.set(xlim=(0, image[0]), ylim=(0, image[1]))
    axes.set_axis_off()
    add_triad(axes, view, emptiest_corner(pixels))
    foot = figure.add_axes((0.0, 0.0, 1.0, _FOOT / height), facecolor="none")
    foot.set(xlim=(0, width), ylim=(0, _FOOT))
    foot.set_axis_off()
    _add_scale(foot, camera, together, image[0])
    _add_legend(foot, seen, words, width)
    return figure_png(figure)


class _Part(NamedTuple):
    """What is drawn of a surface: points, triangles, and which of these are excluded."""

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    excluded: NDArray[np.bool_]


def _part(surface: TouchingSurface, window: NDArray[np.float64]) -> _Part:
    """Part of a surface within a box."""
    faces = np.concatenate([surface.triangles, surface.excluded])
    excluded = np.arange(len(faces)) >= len(surface.triangles)
    points, triangles, source = clip_triangles(surface.points, faces, window)
    # cut triangles have points of their own; what lies in one place becomes one again
    points, triangles, whole = welded(points, triangles, 1e-9 * float(np.ptp(window, axis=0).max()))
    return _Part(points, triangles, excluded[source][whole])


def _drawing(parts: list[_Part], *, glass: int) -> Drawing:
    """Both surfaces in their colours with their edges; the one of number `glass` is seen through."""
    points: list[NDArray[np.float64]] = []
    triangles: list[NDArray[np.int64]] = []
    hues: list[NDArray[np.uint8]] = []
    edges: list[Lines] = []
    patches: list[Patch] = []
    for number, (places, faces, excluded) in enumerate(parts):
        if number == glass:
            for mask, colour in ((~excluded, COLOURS[number]), (excluded, _EXCLUDED)):
                patches.append(Patch(places, faces[mask], colour, _SEEN_THROUGH))
        else:
            triangles.append(faces + sum(len(part) for part in points))
            points.append(places)
            hues.append(np.where(excluded[:, None], rgb(_EXCLUDED), rgb(COLOURS[number])))
        if 0 < len(faces) <= _EDGES:
            ends = feature_edges(places, faces, _KINK, wound=False)
            edges.append(Lines(places, ends, _EDGE, 0.8, 0.25 if number == glass else 0.6))
    return Drawing(
        np.concatenate(points),
        np.concatenate(triangles),
        triangle_colours=np.concatenate(hues),
        lines=tuple(edges),
        patches=tuple(patches),
    )


def _bounds(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.array([points.min(axis=0), points.max(axis=0)])


def _widened(box: NDArray[np.float64], places: NDArray[np.float64], margin: float) -> NDArray[np.float64]:
    """A box with what touches in it, widened on all sides."""
    both = np.concatenate([box, places]) if len(places) else box
    return _bounds(both) + margin * np.array([[-1.0], [1.0]])


def _encloses(outer: NDArray[np.float64], inner: NDArray[np.float64]) -> bool:
    """Whether more than half of a box lies in another one."""
    low, high = np.maximum(outer[0], inner[0]), np.minimum(outer[1], inner[1])
    common = np.prod(np.maximum(high - low, 0.0))
    return bool(common > 0.5 * np.prod(inner[1] - inner[0]) > 0.0)


def _is_flat(points: NDArray[np.float64]) -> bool:
    """Whether points lie in a plane, as those of an inclined floor whose box is not flat."""
    if not len(points):
        return True
    extents = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[1]
    return bool(extents[-1] <= _FLAT * extents[0])


def _before(points: NDArray[np.float64], camera: Camera, hidden: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points on the same lines of sight, nearer to the observer than anything that could hide them."""
    nearest = float(camera.project(hidden)[:, 2].min())
    share = 0.95 * nearest / float(camera.project(points)[:, 2].max())
    moved: NDArray[np.float64] = camera.position + min(share, 1.0) * (points - camera.position)
    return moved


def _add_scale(foot: Any, camera: Camera, points: NDArray[np.float64], pixels: int) -> None:
    """Scale bar for the depth of the middle of the scene."""
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    ends = camera.project([middle, middle + camera.view.matrix[0]])
    per_metre = float(ends[1, 0] - ends[0, 0]) * pixels
    length = round_down(0.15 * pixels / per_metre)
    unit, factor = ("mm", 1.0e3) if length < 0.1 else ("m", 1.0)
    add_scale_bar(foot, length * factor, length * per_metre, unit)


def _add_legend(foot: Any, seen: Touching, words: str, width: int) -> None:
    """Names of the surfaces in their colours, from the right."""
    from matplotlib.lines import Line2D

    shown = [(surface.label, colour) for surface, colour in zip(seen.surfaces, COLOURS, strict=True)]
    if any(len(surface.excluded) for surface in seen.surfaces):
        shown.append(("excluded", _EXCLUDED))
    handles = [Line2D([], [], color=colour, marker="s", lw=0, ms=9) for _, colour in shown]
    handles.append(Line2D([], [], color=_CONTACT, marker="o", lw=0, ms=6))
    labels = [shorten(label, 40) for label, _ in shown] + [words]
    foot.legend(
        handles,
        labels,
        loc="center right",
        bbox_to_anchor=(1.0 - 8 / width, 0.35),
        ncols=len(labels),
        frameon=False,
        fontsize=10.5,
        labelcolor=GREY,
        handletextpad=0.2,
        columnspacing=1.2,
        borderpad=0.0,
    )
