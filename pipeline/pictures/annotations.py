"""What is written into a picture: axes triad, overall dimensions, colour bar, legend."""

from __future__ import annotations

from textwrap import shorten
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.pictures.drawings import INK, mark_colours

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.pictures.camera import Camera, View
    from heavylift.pipeline.pictures.render import Drawing

__all__ = [
    "GREY",
    "add_colour_bar",
    "add_dimensions",
    "add_heading",
    "add_legend",
    "add_scale_bar",
    "add_triad",
    "add_words",
    "emptiest_corner",
]

GREY = "#66707c"
_WHITE, _APART = 250, 12  # of 255: a pixel below is drawn; so far from the others it stands out
_COVERED = 0.1  # weight of what is drawn but does not stand out
_LEAST, _FEW = 10.0, 8  # size and number of letters of a heading
_AXES = ("#c62828", "#2e7d32", "#1565c0")


def add_colour_bar(
    figure: Any, left: float, drawing: Drawing, label: str, *, above: bool, below: bool = False
) -> None:
    """Add a bar at the right; `above` and `below` say that some values lie beyond its ends."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize

    mappable = ScalarMappable(Normalize(*drawing.limits), ListedColormap(drawing.colours))
    axes = figure.add_axes((left, 0.08, 0.022, 0.74))
    extend = {(False, False): "neither", (True, False): "max", (False, True): "min", (True, True): "both"}
    artist = figure.colorbar(mappable, cax=axes, extend=extend[above, below], extendfrac=0.04)
    bands = len(drawing.colours)
    # few bands: a tick at every border
    artist.set_ticks(np.linspace(*drawing.limits, bands + 1 if bands <= 16 else 6))
    artist.ax.yaxis.set_major_formatter(lambda value, _: f"{value:.4g}")
    artist.ax.tick_params(labelsize=11, colors=INK, length=3)
    artist.set_label(label, fontsize=11.5, color=INK)
    artist.outline.set_edgecolor(GREY)
    artist.outline.set_linewidth(0.6)


def emptiest_corner(pixels: NDArray[np.uint8]) -> tuple[int, int]:
    """Where in an image a triad hides least [pixels from the lower left corner]."""
    height, width = pixels.shape[:2]
    box = 150
    places = {
        (80, 62): pixels[height - box :, :box],
        (width - 80, 62): pixels[height - box :, width - box :],
        (80, height - 80): pixels[:box, :box],
        (width - 80, height - 80): pixels[:box, width - box :],
    }
    return min(places, key=lambda corner: _occupied(places[corner]))


def _occupied(pixels: NDArray[np.uint8]) -> float:
    """How much of a corner stands out from the rest of it; a floor or water behind a triad hardly counts."""
    background = np.median(pixels.reshape(-1, 3), axis=0)
    apart = np.abs(pixels - background).max(axis=2) > _APART
    return float(apart.mean() + _COVERED * (pixels.min(axis=2) < _WHITE).mean())


def add_heading(
    figure: Any, title: str, note: str, *, colour: str = INK, note_size: float = 12.5, taken: float = 0.0
) -> None:
    """Write a title and a line below it, smaller if they would not fit, beside `taken` pixels at the right."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    renderer = FigureCanvasAgg(figure).get_renderer()
    width, height = figure.get_size_inches() * figure.dpi
    room = width - 36.0 - taken
    for text, size, top, weight, ink in (
        (title, 17.0, 16.0, "bold", INK),
        (note, note_size, 51.0, "normal", colour),
    ):
        written = figure.text(
            18.0 / width,
            1.0 - top / height,
            text,
            fontsize=size,
            weight=weight,
            color=ink,
            va="top",
            parse_math=False,
        )
        # letters are whole pixels wide, so that a smaller size need not be as much narrower
        while (long := written.get_window_extent(renderer).width / room) > 1.0:
            smaller = min(written.get_fontsize() / long, written.get_fontsize() - 0.25)
            if smaller < _LEAST:
                kept = int(len(written.get_text()) / long) - 1
                written.set_text(shorten(text, max(kept, _FEW), placeholder=" ..."))
                if kept <= _FEW:
                    break
            written.set_fontsize(max(smaller, _LEAST))


def add_triad(axes: Any, view: View, corner: tuple[int, int], length: float = 44.0) -> None:
    """Axes x, y and z in a corner of the image, see `emptiest_corner`."""
    x, y = corner
    order = np.argsort(view.matrix[2])  # those that point at the observer last
    for axis in order:
        dx, dy = length * view.matrix[:2, axis]
        axes.annotate(
            "",
            (x + dx, y + dy),
            (x, y),
            xycoords="data",
            arrowprops={"arrowstyle": "-|>", "color": _AXES[axis], "lw": 2.0, "shrinkA": 0, "shrinkB": 0},
        )
        reach = 1.0 + 13.0 / max(np.hypot(dx, dy), 13.0)
        axes.text(
            x + reach * dx,
            y + reach * dy,
            "xyz"[axis],
            color=_AXES[axis],
            fontsize=12,
            ha="center",
            va="center",
        )


def add_dimensions(
    axes: Any,
    camera: Camera,
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    unit: str,
    size: tuple[int, int],
) -> None:
    """Overall length along each axis, beside an edge of the bounding box on its silhouette."""
    middle = camera.project(0.5 * (low + high))[:2] * size
    faces = np.where(np.asarray(camera.view.towards) > 0.0, high, low)  # planes that face the observer
    for axis in range(3):
        i, j = [other for other in range(3) if other != axis]
        edges = []
        for hidden, facing in ((i, j), (j, i)):
            ends = np.array([low, high])
            ends[:, :] = np.where(np.arange(3) == axis, ends, faces)
            ends[:, hidden] = (low + high - faces)[hidden]
            ends[:, facing] = faces[facing]
            edges.append(camera.project(ends)[:, :2] * size)
        start, end = min(edges, key=lambda edge: edge[:, 1].mean() + 0.3 * edge[:, 0].mean())
        along = (end - start) / max(np.linalg.norm(end - start), 1.0e-9)
        out = np.array([-along[1], along[0]])
        out *= np.sign(out @ (0.5 * (start + end) - middle)) or 1.0
        a, b = start + 16 * out, end + 16 * out
        for foot, tip in ((start, a), (end, b)):
            axes.plot(*np.array([foot + 4 * out, tip + 5 * out]).T, color=GREY, lw=0.8)
        axes.annotate(
            "",
            a,
            b,
            arrowprops={"arrowstyle": "<|-|>", "color": GREY, "lw": 0.9, "shrinkA": 0, "shrinkB": 0},
        )
        x, y = 0.5 * (a + b) + 7 * out
        axes.text(
            x,
            y,
            f"{(high - low)[axis]:.4g} {unit}",
            color=INK,
            fontsize=11.5,
            ha="left" if out[0] > 0.15 else "right" if out[0] < -0.15 else "center",
            va="bottom" if out[1] > 0.35 else "top" if out[1] < -0.35 else "center",
        )


def add_legend(figure: Any, labels: list[str]) -> None:
    """Name the marked groups in the heading, where nothing is drawn."""
    from matplotlib.lines import Line2D

    handles = [Line2D([], [], color=colour, marker="o", lw=0, ms=7) for colour in mark_colours(len(labels))]
    look = {"frameon": False, "labelcolor": INK, "handletextpad": 0.2, "columnspacing": 1.2}
    figure.legend(handles, labels, loc="upper right", fontsize=11, ncols=-(-len(labels) // 3), **look)


def add_words(axes: Any, words: str, width: float, taken: float) -> None:
    """Write what colours mean at the right of the lower edge of axes in pixels, in two lines if it must be."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    written = axes.text(
        width - 18, 16, words, fontsize=11, color=GREY, ha="right", va="center", parse_math=False
    )
    renderer = FigureCanvasAgg(axes.figure).get_renderer()
    if written.get_window_extent(renderer).width > width - 18 - taken:
        parts = words.split(" · ")
        half = min(
            range(1, len(parts) + 1), key=lambda k: max(len(" · ".join(p)) for p in (parts[:k], parts[k:]))
        )
        written.set_text("\n".join(" · ".join(part) for part in (parts[:half], parts[half:]) if part))
        written.set_fontsize(10)


def add_scale_bar(axes: Any, length: float, width: float, unit: str) -> None:
    """Add a bar of a length in `unit` that is so many pixels wide to the lower edge of axes in pixels."""
    left, y = 18.0, 16.0
    axes.plot([left, left + width], [y, y], color=INK, lw=2.2, solid_capstyle="butt")
    for x in (left, left + width):
        axes.plot([x, x], [y - 5, y + 5], color=INK, lw=1.2)
    axes.text(left + width + 8, y, f"{length:g} {unit}", color=INK, fontsize=11.5, va="center")
