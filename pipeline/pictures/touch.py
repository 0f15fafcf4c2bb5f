"""Picture of a scene of rigid and flexible bodies at one record: contours, what touches them, and the forces."""

from __future__ import annotations

from textwrap import shorten
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.pictures.annotations import GREY, add_scale_bar, add_triad, emptiest_corner
from heavylift.pipeline.pictures.camera import choose_view, fit_camera
from heavylift.pipeline.pictures.drawings import INK, round_down
from heavylift.pipeline.pictures.outer_surface import Surface
from heavylift.pipeline.pictures.png import figure_png
from heavylift.pipeline.pictures.render import Drawing

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from heavylift.pipeline.pictures.attached import Seen
    from heavylift.pipeline.pictures.render import Renderer

__all__ = ["touch_picture"]

_DPI = 100
_HEAD, _FOOT = 84, 48  # pixels above and below the image


def _rgb(colour: str) -> NDArray[np.uint8]:
    """Red, green and blue of ``"#rrggbb"``."""
    return np.frombuffer(bytes.fromhex(colour[1:]), dtype=np.uint8)


def touch_picture(
    renderer: Renderer,
    seen: Seen,
    *,
    title: str,
    note: str = "",
    up: ArrayLike | None = None,
    size: tuple[int, int] = (1200, 760),
) -> bytes | None:
    """All that is seen at one record, true to scale, as PNG; None if nothing of it is a surface.

    Parameters
    ----------
    renderer
        Draws the pixels.
    seen
        From `heavylift.pipeline.pictures.attached.Others`, lengths in metres.
    title, note
        First and second line of the heading.
    up
        Direction against gravity, shape (3,), if there is gravity.
    size
        Width and height of the picture [pixels].
    """
    from matplotlib.figure import Figure

    if not seen.patches:
        return None
    starts = np.cumsum([0, *(len(part.points) for part in seen.patches)])
    solid = np.concatenate([part.points for part in seen.patches])
    triangles = np.concatenate(
        [part.triangles + start for part, start in zip(seen.patches, starts[:-1], strict=True)]
    )
    nodes, edges = [solid], [np.empty((0, 2), dtype=np.int64)]
    for line in seen.lines:
        edges.append(line.ends + sum(len(part) for part in nodes))
        nodes.append(line.points)
    together = np.concatenate(nodes)
    outline = np.concatenate(edges)
    surface = Surface(together, np.arange(len(together)), triangles, outline, outline)
    view = choose_view(surface, up=up)
    width, height = size
    image = (width, height - _HEAD - _FOOT)
    camera = fit_camera(view, seen.points, image[0] / image[1], margin=0.06)
    hues = [np.tile(_rgb(part.colour), (len(part.triangles), 1)) for part in seen.patches]
    drawing = Drawing(
        solid, triangles, triangle_colours=np.concatenate(hues), lines=seen.lines, marks=seen.marks
    )
    pixels = renderer.render(drawing, camera, image)
    figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI, facecolor="white")
    figure.figimage(pixels, 0, _FOOT, origin="upper")
    look: dict[str, Any] = {"color": INK, "va": "top", "parse_math": False}
    heading = shorten(title, width // 15)
    figure.text(18 / width, 1.0 - 16 / height, heading, fontsize=17, weight="bold", **look)
    figure.text(18 / width, 1.0 - 50 / height, shorten(note, width // 8), fontsize=12.5, **look)
    axes = figure.add_axes((0.0, _FOOT / height, 1.0, image[1] / height), facecolor="none", zorder=1)
    axes.set(xlim=(0, image[0]), ylim=(0, image[1]))
    axes.set_axis_off()
    add_triad(axes, view, emptiest_corner(pixels))
    foot = figure.add_axes((0.0, 0.0, 1.0, _FOOT / height), facecolor="none")
    foot.set(xlim=(0, width), ylim=(0, _FOOT))
    foot.set_axis_off()
    middle = 0.5 * (together.min(axis=0) + together.max(axis=0))
    ends = camera.project([middle, middle + view.matrix[0]])
    per_metre = float(ends[1, 0] - ends[0, 0]) * image[0]
    length = round_down(0.2 * image[0] / per_metre)
    unit, factor = ("mm", 1.0e3) if length < 0.1 else ("m", 1.0)
    add_scale_bar(foot, length * factor, length * per_metre, unit)
    words = "violet: contours · ochre: what touches · red: force on it"
    foot.text(width - 18, 16, words, fontsize=11, color=GREY, ha="right", va="center", parse_math=False)
    return figure_png(figure)
