"""Pictures of bodies: mesh, mode shapes, stress. Pixels by VTK, everything written by matplotlib."""

from __future__ import annotations

from dataclasses import replace
from textwrap import shorten
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.drawn.scales import deformation_scale
from heavylift.pipeline.pictures.annotations import (
    GREY,
    add_colour_bar,
    add_dimensions,
    add_heading,
    add_legend,
    add_triad,
    emptiest_corner,
)
from heavylift.pipeline.pictures.camera import Camera, View, choose_view, fit_camera
from heavylift.pipeline.pictures.drawings import (
    INK,
    bounding_box,
    mesh_drawing,
    mode_drawing,
    stress_drawing,
    stress_unit,
)
from heavylift.pipeline.pictures.plots import few_colours, figure_png

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.drawn.outer_surface import Surface
    from heavylift.pipeline.pictures.render import Drawing, Renderer

__all__ = ["Painter"]

_DPI = 100
_LETTER = 10.0  # width in a legend [pixels]


class Painter:
    """Draws the pictures of one body in one view.

    Parameters
    ----------
    renderer
        Draws the pixels; may serve several painters.
    surface
        Of the body.
    view
        Direction of sight; chosen from the shape of the body when absent.
    size
        Width and height of a picture in pixels.
    """

    def __init__(
        self,
        renderer: Renderer,
        surface: Surface,
        *,
        view: View | None = None,
        size: tuple[int, int] = (1200, 760),
    ) -> None:
        self._renderer = renderer
        self._surface = surface
        self._view = view or choose_view(surface)
        self._size = size
        # millimetres up to ten metres, metres above
        self._scale, self._unit = (1.0e3, "mm") if surface.diagonal < 10.0 else (1.0, "m")

    @property
    def length_unit(self) -> str:
        """Unit of the lengths written into the pictures, ``"mm"`` or ``"m"``."""
        return self._unit

    def resized(self, width: int, height: int) -> Painter:
        """A painter of the same body in the same view for pictures of another size [pixels]."""
        return Painter(self._renderer, self._surface, view=self._view, size=(width, height))

    @property
    def has_outline(self) -> bool:
        """Whether pictures show edges of the body at rest; a bare cloud of nodes has none."""
        return bool(len(self._surface.feature_edges))

    @property
    def diagonal(self) -> float:
        """Diagonal of the bounding box of the body [m]."""
        return self._surface.diagonal

    def mesh(
        self, *, title: str, note: str = "", marks: Mapping[str, NDArray[np.int64]] | None = None
    ) -> bytes:
        """Mesh with its overall dimensions and marked node groups, as PNG."""
        groups = dict(marks or {})
        drawing = mesh_drawing(self._surface, groups, scale=self._scale)
        box = bounding_box(drawing.points.min(axis=0), drawing.points.max(axis=0))
        drawing = replace(drawing, lines=(*drawing.lines, box))
        labels = [f"{name} ({len(group)} nodes)" for name, group in groups.items()]
        figure, axes, camera = self._figure(
            drawing,
            title=title,
            note=note,
            margin=0.09,
            around=box.points,
            taken=_LETTER * max(map(len, labels), default=0) * -(-len(labels) // 3),
        )
        add_dimensions(axes, camera, box.points[0], box.points[-1], self._unit, self._image_size(bar=False))
        if groups:
            add_legend(figure, labels)
        return figure_png(figure)

    def mode(self, shape: NDArray[np.float64], *, title: str, note: str = "", share: float = 0.1) -> bytes:
        """One mode shape, shape (n, 3) in any unit, as PNG; its largest displacement `share` of the diagonal."""
        drawing = mode_drawing(self._surface, shape, scale=self._scale, share=share)
        bar = ("displacement / largest displacement [–]", False)
        return figure_png(self._figure(drawing, title=title, note=note, bar=bar)[0])

    def stress(
        self,
        displacement: NDArray[np.float64],
        stress: NDArray[np.float64],
        *,
        title: str,
        note: str = "",
        factor: float | None = None,
    ) -> bytes:
        """Equivalent stress on the deformed body, as PNG; deformation scale and maximum are stated.

        Parameters
        ----------
        displacement
            Of all nodes of the model [m], shape (n, 3).
        stress
            At all nodes of the model [Pa], shape (n,); not a number where it is not known.
        title, note
            First and second line of the heading.
        factor
            Deformation scale; a round number that shows the shape when absent.
        """
        if factor is None:
            factor = deformation_scale(displacement, self._surface.diagonal)
        largest = float(np.nanmax(stress, initial=0.0))
        divisor, unit = stress_unit(largest)
        drawing = stress_drawing(
            self._surface, displacement, stress, factor=factor, scale=self._scale, divisor=divisor
        )
        seen = self._surface.pick(stress) / divisor
        shown = float(np.nanmax(seen))
        place = self._surface.nodes[int(np.nanargmax(seen))] * self._scale
        where = ", ".join(f"{value:.4g}" for value in np.round(place, 6) + 0.0)
        facts = f"largest {shown:.4g} {unit} at ({where}) {self._unit}"
        if largest > divisor * shown * (1.0 + 1.0e-9):
            facts = f"largest {largest / divisor:.4g} {unit}, inside; on the surface {facts.removeprefix('largest ')}"
        facts += f" · deformation × {factor:g}"
        bar = (f"von Mises stress [{unit}]", shown > drawing.limits[1] * (1.0 + 1.0e-9))
        figure, _, _ = self._figure(
            drawing, title=title, note=" · ".join(part for part in (note, facts) if part), bar=bar
        )
        return figure_png(figure)

    def contact_sheet(
        self,
        shapes: Sequence[NDArray[np.float64]],
        labels: Sequence[str],
        *,
        columns: int = 5,
        title: str = "",
        share: float = 0.1,
    ) -> bytes:
        """All mode shapes on one sheet, each with its label, as PNG of 256 colours; `share` as for one mode."""
        from matplotlib.figure import Figure

        columns = max(1, min(columns, len(shapes)))
        rows = -(-len(shapes) // columns)
        tile = (300, 190)
        text, head = 26, 50 if title else 8
        width, height = columns * tile[0], head + rows * (tile[1] + text)
        figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI, facecolor="white")
        if title:
            figure.text(
                12 / width,
                1.0 - 12 / height,
                shorten(title, width // 13),
                fontsize=15,
                weight="bold",
                color=INK,
                va="top",
                parse_math=False,
            )
        for number, (shape, label) in enumerate(zip(shapes, labels, strict=True)):
            row, column = divmod(number, columns)
            drawing = mode_drawing(self._surface, shape, scale=self._scale, share=share)
            camera = self._camera(drawing, tile, margin=0.03)
            pixels = self._renderer.render(drawing, camera, tile)
            bottom = height - head - (row + 1) * (tile[1] + text)
            figure.figimage(pixels, column * tile[0], bottom + text, origin="upper")
            figure.text(
                (column + 0.5) * tile[0] / width,
                (bottom + 9) / height,
                label,
                fontsize=10.5,
                color=INK,
                ha="center",
            )
        return few_colours(figure_png(figure))

    def _image_size(self, *, bar: bool) -> tuple[int, int]:
        return self._size[0] - (130 if bar else 0), self._size[1] - 84

    def _camera(
        self,
        drawing: Drawing,
        size: tuple[int, int],
        margin: float,
        around: NDArray[np.float64] | None = None,
    ) -> Camera:
        rest = self._surface.nodes * self._scale if around is None else around
        return fit_camera(self._view, np.vstack([drawing.points, rest]), size[0] / size[1], margin=margin)

    def _figure(
        self,
        drawing: Drawing,
        *,
        title: str,
        note: str,
        margin: float = 0.05,
        bar: tuple[str, bool] | None = None,
        around: NDArray[np.float64] | None = None,
        taken: float = 0.0,
    ) -> tuple[Any, Any, Camera]:
        """Picture with heading, axes triad and colour bar; returns figure, axes over the image, camera."""
        from matplotlib.figure import Figure

        width, height = self._size
        size = self._image_size(bar=bar is not None)
        camera = self._camera(drawing, size, margin, around)
        pixels = self._renderer.render(drawing, camera, size)
        figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI, facecolor="white")
        figure.figimage(pixels, 0, 0, origin="upper")
        add_heading(figure, title, note, colour=GREY, note_size=11.5, taken=taken)
        axes = figure.add_axes((0.0, 0.0, size[0] / width, size[1] / height), facecolor="none", zorder=1)
        axes.set(xlim=(0, size[0]), ylim=(0, size[1]))
        axes.set_axis_off()
        add_triad(axes, self._view, emptiest_corner(pixels))
        if bar:
            add_colour_bar(figure, (size[0] + 12) / width, drawing, bar[0], above=bar[1])
        return figure, axes, camera
