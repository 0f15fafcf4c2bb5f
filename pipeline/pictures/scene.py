"""Pictures of scenes at any record: stress of frames and shells, or bodies that keep their shape; scale bar, time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.pipeline.drawn.outer_surface import Surface
from heavylift.pipeline.drawn.scales import deformation_scale, round_down
from heavylift.pipeline.drawn.skins import MeshRun, MeshSkin, Skin, frame_radius
from heavylift.pipeline.pictures.annotations import (
    GREY,
    add_colour_bar,
    add_heading,
    add_scale_bar,
    add_triad,
    emptiest_corner,
)
from heavylift.pipeline.pictures.camera import Camera, View, choose_view, fit_camera, plane_view
from heavylift.pipeline.pictures.contacts import SIZE, kinks, touch_camera, touch_picture
from heavylift.pipeline.pictures.drawings import INK, stress_unit
from heavylift.pipeline.pictures.meshes import Exaggeration, Scale, Shot, join, stress_scale
from heavylift.pipeline.pictures.parts import Seen
from heavylift.pipeline.pictures.plots import figure_png
from heavylift.pipeline.pictures.render import Drawing, Lines, Patch
from heavylift.pipeline.pictures.scene_view import sampled_records
from heavylift.pipeline.results.signals import scaled_unit

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

    from heavylift.pipeline.pictures.render import Renderer
    from heavylift.pipeline.pictures.scene_view import SceneView

__all__ = ["ScenePainter", "SolidPainter"]

_DPI = 100
_HEAD, _FOOT, _BAR = 84, 34, 130  # pixels above, below and beside the image
_LEFT = (80, 62)  # place of the axes in moving pictures [pixels], lower left
_THIN = 4.0e-3  # radius of a tube relative to the scene below which it is widened
_SMALL = 1.0e-2  # displacement relative to the scene below which it is drawn larger
_VALUES = 2_000_000  # stresses that a common scale is chosen by
_WEIGHT = 4  # of lines beside borders of shells in the choice of the view
_EDGES = 1600  # elements at most whose sides are drawn
_FLAT = {True: 1.0e-6, False: 1.0e-3}  # relative depth of a scene with or without shells that counts as plane


class ScenePainter:
    """Draws the frames and shells of one run, and what is attached to them, always from the same side.

    Frames alone are coloured by their axial stress at each fibre, tension and compression; beside shells by its
    amount, which is their von Mises stress.

    Parameters
    ----------
    renderer
        Draws the pixels.
    meshes
        By name; at least one.
    times
        Of the records [s], shape (nr,).
    others
        What is drawn beside them.
    up
        Direction against gravity, shape (3,), if there is gravity.
    side
        Of shells whose stress is shown.
    size
        Width and height of a picture [pixels].
    """

    def __init__(
        self,
        renderer: Renderer,
        meshes: Mapping[str, MeshRun],
        times: NDArray[np.float64],
        *,
        others: SceneView | None = None,
        up: ArrayLike | None = None,
        side: str = "largest",
        size: tuple[int, int] = (1200, 760),
        skins: Mapping[str, MeshSkin] | None = None,
    ) -> None:
        self._renderer, self._meshes, self._times = renderer, dict(meshes), times
        self._others, self._up, self._side, self._size = others, up, side, size
        self._skins = dict(skins or {}) or {
            name: MeshSkin(run.body, lengths=run.lengths, side=side)  # type: ignore[arg-type]
            for name, run in meshes.items()
        }
        self._shells = any(skin.is_shell for skin in self._skins.values())
        self._looks = [int(record) for record in sampled_records(len(times))]
        self._exaggeration = self._exaggerate()
        for name, factor in self._exaggeration.radius.items():
            self._skins[name].widening = factor
        self._view = self._choose_view()

    @property
    def exaggeration(self) -> Exaggeration:
        """What is drawn larger than it is."""
        return self._exaggeration

    @property
    def view(self) -> View:
        """Direction of sight, world axes."""
        return self._view

    @property
    def quantity(self) -> str:
        """What the colours mean, for the colour bar."""
        if not self._shells:
            return "axial stress N/A ± M c/I"
        return "von Mises stress" + (" / |axial stress|" if self._frames else "")

    @property
    def details(self) -> str:
        """What the colours of shells and frames mean, in a sentence of a caption."""
        tubes = "the axial stress of each fibre, N/A ± M c/I"
        if not self._shells:
            return f"Colours: {tubes}"
        sides = {"largest": "the largest of top, middle and bottom"}.get(
            self._side, f"that of the {self._side}"
        )
        sides += ", of each element without an average over neighbours"
        beams = f"; of frames the amount of {tubes}" if self._frames else ""
        return f"Colours: von Mises stress of shells, {sides}{beams}"

    def resized(self, width: int, height: int) -> ScenePainter:
        """A painter of the same scene for pictures of another size [pixels]."""
        other = object.__new__(ScenePainter)
        other.__dict__ |= {**self.__dict__, "_size": (width, height)}
        return other

    def scale(self, records: Sequence[int]) -> Scale:
        """Colours that suit all of some records."""
        peak = 0.0
        values: list[NDArray[np.float64]] = []
        for record in records:
            skin = self._skin(record)
            peak = max(peak, abs(skin.largest))
            thinned = 1 + len(records) * len(skin.values) // _VALUES
            values += [skin.values[::thinned], np.array([skin.largest])]
        return stress_scale(np.concatenate(values), peak, signed=not self._shells)

    def shot(self, records: Sequence[int]) -> Shot:
        """Camera that sees all of some records."""
        return self._fit([self._positions(record) for record in records])

    def picture(self, record: int, *, title: str, note: str = "") -> bytes:
        """One record with its own colours, as PNG."""
        parts = self._parts(record)
        skin = join(list(parts.values()))
        scale = stress_scale(skin.values, abs(skin.largest), signed=not self._shells)
        shot = self._fit([skin.points, self._seen(record).points])
        drawing = self._drawing(record, skin, scale)
        pixels = self._renderer.render(drawing, shot.camera, self._image)
        words = [self.when(record), note, self._largest(parts)]
        return self._figure(
            pixels,
            drawing,
            shot,
            scale,
            title=title,
            note=" · ".join(part for part in words if part),
            corner=emptiest_corner(pixels),
        )

    def images(self, records: Sequence[int], *, title: str) -> Iterator[bytes]:
        """Iterator of PNG pictures of some records, all with the same camera and colours."""
        scale, shot = self.scale(records), self.shot(records)
        corner = self._common_corner(records, shot)
        for record in records:
            drawing = self._drawing(record, self._skin(record), scale)
            pixels = self._renderer.render(drawing, shot.camera, self._image)
            yield self._figure(
                pixels, drawing, shot, scale, title=title, note=self.when(record), corner=corner
            )

    def when(self, record: int) -> str:
        """Time of a record in words, with as many decimals as the records need."""
        return time_words(self._times, record)

    @property
    def _frames(self) -> list[str]:
        return [name for name, skin in self._skins.items() if not skin.is_shell]

    @property
    def _image(self) -> tuple[int, int]:
        return self._size[0] - _BAR, self._size[1] - _HEAD - _FOOT

    def _positions(self, record: int) -> NDArray[np.float64]:
        """Points of the nodes, and of all that is beside them, as drawn."""
        nodes = [self._drawn(name, record)[:, 0] for name in self._meshes]
        if self._others is not None:
            nodes.append(self._others.seen(record, around=False).points)
        return np.concatenate(nodes)

    def _drawn(self, name: str, record: int) -> NDArray[np.float64]:
        run, factor = self._meshes[name], self._exaggeration.displacement
        now = run.coordinates(record)
        return now if factor == 1.0 else run.rest + factor * (now - run.rest)

    def _parts(self, record: int) -> dict[str, Skin]:
        exact = self._exaggeration.displacement == 1.0
        return {
            name: self._skins[name].skin(
                run.coordinates(record), None if exact else self._drawn(name, record)
            )
            for name, run in self._meshes.items()
        }

    def _skin(self, record: int) -> Skin:
        return join(list(self._parts(record).values()))

    def _seen(self, record: int, *, around: bool = True) -> Seen:
        return self._others.seen(record, around=around) if self._others is not None else Seen()

    def _exaggerate(self) -> Exaggeration:
        """Round factors; displacements are drawn larger only if nothing is attached to the meshes."""
        rest = {name: run.rest[:, 0] for name, run in self._meshes.items()}
        everything = [*rest.values()]
        moved = 0.0
        for record in self._looks:
            for name, run in self._meshes.items():
                now = run.coordinates(record)[:, 0]
                everything.append(now)
                moved = max(moved, float(np.linalg.norm(now - rest[name], axis=1).max()))
            everything.append(self._seen(record, around=False).points)
        size = float(np.linalg.norm(np.ptp(np.concatenate(everything), axis=0)))
        displacement = 1.0
        if (self._others is None or self._others.empty) and 0.0 < moved < _SMALL * size:
            displacement = deformation_scale(np.array([[moved, 0.0, 0.0]]), size)
        radius = {}
        for name in self._frames:
            share = frame_radius(self._meshes[name].body) / size  # type: ignore[arg-type]
            radius[name] = 1.0 if share >= _THIN else max(1.0, round_down(1.5 * _THIN / share))
        return Exaggeration(displacement, radius)

    def _choose_view(self) -> View:
        """Across the plane of a scene that is plane, else from where most outlines are seen."""
        points = np.concatenate(
            [
                *(self._positions(record) for record in self._looks),
                *(run.rest[:, 0] for run in self._meshes.values()),
            ]
        )
        up = np.array([0.0, 0.0, 1.0]) if self._up is None else np.asarray(self._up, dtype=float)
        across = plane_view(points, up, flat=_FLAT[self._shells])
        if across is not None:
            return across
        record = self._looks[-1]
        skin = self._skin(record)
        nodes, edges = [skin.points], [skin.outline]
        lines = [self._skins[name].lines(self._drawn(name, record)) for name in self._frames]
        lines += [(line.points, line.ends) for line in self._seen(record, around=False).lines]
        # repeated, so that a short rope is seen as well as the long border of a shell
        for points, ends in lines:
            edges.append(np.tile(ends + sum(len(part) for part in nodes), (_WEIGHT, 1)))
            nodes.append(points)
        together = np.concatenate(nodes)
        surface = Surface(
            nodes=together,
            node_indices=np.arange(len(together)),
            triangles=skin.triangles,
            element_edges=skin.edges,
            feature_edges=np.concatenate(edges),
        )
        return choose_view(surface, up=up)

    def _fit(self, parts: list[NDArray[np.float64]]) -> Shot:
        rest = [run.rest[:, 0] for run in self._meshes.values()]
        points = np.concatenate([*parts, *rest])
        camera = fit_camera(self._view, points, self._image[0] / self._image[1], margin=0.06)
        return Shot(camera, 0.5 * (points.min(axis=0) + points.max(axis=0)))

    def _drawing(self, record: int, skin: Skin, scale: Scale) -> Drawing:
        rest = []
        for name, run in self._meshes.items():
            points, ends = self._skins[name].lines(run.rest)
            rest.append(Lines(points, ends, colour="#8a949f", width=1.4, opacity=0.9))
        seen = self._seen(record)
        elements = sum(len(run.body.elements) for run in self._meshes.values())
        sides = skin.edges if elements <= _EDGES else skin.edges[:0]
        values = skin.values if scale.signed else np.abs(skin.values)
        return Drawing(
            skin.points,
            skin.triangles,
            values=values / scale.divisor,
            limits=scale.limits,
            colours=scale.colours,
            normals=skin.normals,
            lines=(
                *rest,
                Lines(skin.points, sides, colour=INK, width=0.8, opacity=0.35),
                Lines(skin.points, skin.outline, colour=INK, width=1.5, opacity=0.85),
                *seen.lines,
                *(kinks(part) for part in seen.patches if part.opacity == 1.0),
                *(part for part in seen.around if isinstance(part, Lines)),
            ),
            marks=seen.marks,
            patches=(*seen.patches, *(part for part in seen.around if isinstance(part, Patch))),
        )

    def _largest(self, parts: Mapping[str, Skin]) -> str:
        """Largest stress of a record and where it is."""
        name, skin = max(parts.items(), key=lambda item: abs(item[1].largest))
        value = abs(skin.largest) if self._shells else skin.largest
        divisor, unit = stress_unit(abs(value))
        return f"largest {value / divisor:.4g} {unit} in {name}, element {skin.where}"

    def _common_corner(self, records: Sequence[int], shot: Shot) -> tuple[int, int]:
        """Corner of the triad that is free in a few pictures spread over all."""
        few = [records[k] for k in np.unique(np.linspace(0, len(records) - 1, 6).round().astype(int))]
        points = np.concatenate([self._skin(record).points for record in few])
        place = shot.camera.project(points)[:, :2] * self._image
        width, height = self._image
        covered = np.full((height, width, 1), 255, dtype=np.uint8)
        columns, rows = np.clip(place.astype(int), 0, [width - 1, height - 1]).T
        covered[height - 1 - rows, columns] = 0
        return emptiest_corner(covered)

    def _figure(
        self,
        pixels: NDArray[np.uint8],
        drawing: Drawing,
        shot: Shot,
        scale: Scale,
        *,
        title: str,
        note: str,
        corner: tuple[int, int],
    ) -> bytes:
        from matplotlib.figure import Figure

        width, height = self._size
        image = self._image
        figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI, facecolor="white")
        figure.figimage(pixels, 0, _FOOT, origin="upper")
        add_heading(figure, title, note)
        axes = figure.add_axes(
            (0.0, _FOOT / height, image[0] / width, image[1] / height), facecolor="none", zorder=1
        )
        axes.set(xlim=(0, image[0]), ylim=(0, image[1]))
        axes.set_axis_off()
        add_triad(axes, self._view, corner)
        foot = figure.add_axes((0.0, 0.0, 1.0, _FOOT / height), facecolor="none")
        foot.set(xlim=(0, width), ylim=(0, _FOOT))
        foot.set_axis_off()
        length, pixels_wide, unit = self._scale_bar(shot)
        add_scale_bar(foot, length, pixels_wide, unit)
        side = f"stress of the {self._side}" if self._shells and self._side != "largest" else ""
        boxes = "boxes: same mass and inertia" if self._others is not None and self._others.boxes else ""
        words = [side, self._exaggeration.words, boxes, "grey: unloaded shape"]
        foot.text(
            width - 18,
            16,
            " · ".join(part for part in words if part),
            fontsize=11,
            color=GREY,
            ha="right",
            va="center",
            parse_math=False,
        )
        values = drawing.values
        assert values is not None
        low, high = drawing.limits
        slack = 1e-9 * (high - low)
        add_colour_bar(
            figure,
            (image[0] + 12) / width,
            drawing,
            f"{self.quantity} [{scale.unit}]",
            above=bool(values.max() > high + slack),
            below=bool(values.min() < low - slack),
        )
        return figure_png(figure)

    def _scale_bar(self, shot: Shot) -> tuple[float, float, str]:
        """Round length, its pixels in the middle of what is drawn, and its unit."""
        camera, view = shot.camera, shot.camera.view.matrix
        ends = camera.project([shot.middle, shot.middle + view[0]])
        per_metre = float(ends[1, 0] - ends[0, 0]) * self._image[0]
        length = round_down(0.2 * self._image[0] / per_metre)
        unit, factor = ("mm", 1.0e3) if length < 0.1 else ("m", 1.0)
        return length * factor, length * per_metre, unit


def time_words(times: NDArray[np.float64], record: int) -> str:
    """Time of one of some records, shape (nr,) [s], with as many decimals as all of them need."""
    unit = scaled_unit("s", [times])
    steps = np.diff(times)
    step = float(steps.min()) / unit.divisor if len(steps) else 0.0
    digits = int(np.clip(np.ceil(-np.log10(step * 1.001)), 0, 6)) if step > 0.0 else 3
    return f"t = {times[record] / unit.divisor:.{digits}f} {unit.text}"


class SolidPainter:
    """Draws a run of a scene without frames and shells, always with the same camera.

    Parameters
    ----------
    renderer
        Draws the pixels.
    others
        What there is.
    times
        Of the records [s], shape (nr,).
    words
        What the colours are.
    up
        Direction against gravity, shape (3,), if there is gravity.
    size
        Width and height of a picture [pixels].
    """

    def __init__(
        self,
        renderer: Renderer,
        others: SceneView,
        times: NDArray[np.float64],
        *,
        words: str,
        up: ArrayLike | None = None,
        size: tuple[int, int] = SIZE,
    ) -> None:
        self._renderer, self._others, self._times = renderer, others, times
        self._words, self._up, self._size = words, up, size
        looked = sampled_records(len(times))
        self._seen = [self._others.seen(int(record), around=False) for record in looked]
        self.empty = not any(each.patches or each.lines for each in self._seen)
        self._camera: Camera | None = None

    @property
    def details(self) -> str:
        """What the colours are, for a caption."""
        return self._words[:1].upper() + self._words[1:].replace(" · ", ", ")

    def resized(self, width: int, height: int) -> SolidPainter:
        """A painter of the same run for pictures of another size [pixels]."""
        other = object.__new__(SolidPainter)
        other.__dict__ |= {**self.__dict__, "_size": (width, height), "_camera": None}
        return other

    def picture(self, record: int, *, title: str, note: str = "") -> bytes:
        """One record, as PNG."""
        words = [note, time_words(self._times, record)]
        return self._drawn(record, title, ", ".join(filter(None, words)), None)

    def moorings(self, record: int, *, title: str, note: str = "") -> bytes:
        """One record with all of its mooring lines, as PNG."""
        return self._looking(record, title, note, self._others.moorings(record), None)

    def close(self, record: int, *, title: str, note: str = "") -> bytes:
        """One record of which the largest body fills the picture, as PNG."""
        return self._looking(record, title, note, self._others.seen(record), self._others.largest(record))

    def _looking(self, record: int, title: str, note: str, seen: Seen, at: Seen | None) -> bytes:
        content = touch_picture(
            self._renderer,
            seen,
            title=title,
            note=f"{note}, {time_words(self._times, record)}",
            words=self._words,
            up=self._up,
            size=self._size,
            camera=None if at is None else touch_camera([at], up=self._up, size=self._size),
            measured=None if at is None else at.points,
        )
        assert content is not None
        return content

    def images(self, records: Sequence[int], *, title: str) -> Iterator[bytes]:
        """Iterator of PNG pictures of some records."""
        for record in records:
            yield self._drawn(record, title, time_words(self._times, record), _LEFT)

    def _drawn(self, record: int, title: str, note: str, corner: tuple[int, int] | None) -> bytes:
        self._camera = self._camera or touch_camera(self._seen, up=self._up, size=self._size)
        content = touch_picture(
            self._renderer,
            self._others.seen(record),
            title=title,
            note=note,
            words=self._words,
            size=self._size,
            camera=self._camera,
            corner=corner,
        )
        assert content is not None
        return content
