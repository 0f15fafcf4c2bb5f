"""A scene to draw at any of its records as a renderer takes it: lines, surfaces, dots, with what is around them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.drawn.lines import clip_lines, coil
from heavylift.pipeline.drawn.moments import Moment
from heavylift.pipeline.drawn.roles import ROLES, WATER_COLOUR
from heavylift.pipeline.drawn.scales import deformation_scale
from heavylift.pipeline.pictures.parts import Seen, force_arrow
from heavylift.pipeline.pictures.render import Lines, Patch, Points
from heavylift.solver.scene.outlines import box_corners

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.drawn.scene import Disc, DrawnScene, Line, Surface

__all__ = ["SceneView", "sampled_records"]

_CIRCLE = 32  # corners of a pulley
# relative to the diagonal of the box that bodies move in:
_WATER_AROUND = 1.5  # water is drawn so far
_RIGGING = 3.0  # springs and joints so far away are looked at as well
_LINES = 2.0  # mooring lines are drawn so far
_SCATTERED = 30.0  # times the largest body: a scene so wide has a picture of that body alone
_FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 5, 7], [4, 7, 6]])  # two sides of a box of eight corners
_EDGES = np.array(
    [(i, i | bit) for bit in (1, 2, 4) for i in range(8) if not i & bit]
)  # of a box of eight corners
_APART = 0.01  # sides of a joint that are farther apart are joined by a line: distances, slides
_SAMPLES = 24  # records by which it is seen how far bodies move
_SMALL = 1.0e-2  # deformation relative to the scene below which it is drawn larger
_CELLS = 96  # of waves in each direction
_RIGGED = ("rod", "spring", "joint")  # roles of lines that may lead far away
_ARROW = 0.2  # length of the arrow of the largest force, relative to the scene


def sampled_records(count: int) -> NDArray[np.int64]:
    """A few of so many records, by which views and widths are chosen: the first and the last among them."""
    return np.unique(np.linspace(0, count - 1, min(_SAMPLES, count)).round().astype(np.int64))


class SceneView:
    """Draws a scene at any record.

    Around what moves are drawn the ground, water and mooring lines, as far as they are near.

    Parameters
    ----------
    scene
        Of the records that are wanted, all of its timelines alike: `heavylift.pipeline.drawn.build.EXACT`.
    """

    def __init__(self, scene: DrawnScene) -> None:
        self.scene = scene
        self._pose_of = {int(record): k for k, record in enumerate(scene.records)}
        roles = {line.role for line in scene.lines}
        self._factor = 1.0
        dots = any(dot.role != "centre" for dot in scene.dots)
        pads = any(one.role == "fender" for one in scene.surfaces)
        if not (roles - {"contour"} or dots or pads or scene.touches):
            self._factor = self._exaggerated()
        self._peak = max((one.largest for one in self._arrows), default=0.0)

    @property
    def boxes(self) -> int:
        """Bodies that are drawn as boxes of their inertia."""
        return sum(one.role == "box" for one in self.scene.surfaces)

    @property
    def centres(self) -> int:
        """Centres of mass that are marked."""
        return sum(dot.role == "centre" for dot in self.scene.dots)

    @property
    def factor(self) -> float:
        """How many times as large as they are deformations of bodies with modes are drawn."""
        return self._factor

    @property
    def reaches_far(self) -> bool:
        """Whether mooring lines reach beyond what `seen` shows of them."""
        window = self._window(_WATER_AROUND)
        ends = [line.local[0, [0, -1]] for line in self._moorings]
        return any(bool(np.any((end < window[0]) | (end > window[1]))) for end in ends)

    @property
    def empty(self) -> bool:
        """Whether there is nothing but frames and shells."""
        scene = self.scene
        surfaces = [one for one in scene.surfaces if len(one.triangles)]
        return not (surfaces or scene.lines or scene.discs or scene.dots or scene.water is not None)

    @property
    def scattered(self) -> bool:
        """Whether bodies are so far apart that a picture of all shows none of them."""
        if any(one.modes is not None or one.shapes is not None for one in self.scene.surfaces):
            return False
        largest = self.scene.largest
        return bool(np.isfinite(largest)) and self.scene.size > _SCATTERED * largest

    def seen(self, record: int, *, around: bool = True) -> Seen:
        """What is drawn at a record, lengths in metres; `around` adds ground, water and moorings."""
        now = self._moment(record)
        lines: list[Lines] = []
        far: list[Lines] = []
        for line in self._rigging(now):
            near = self._is_near(line)
            lines.append(_kept(line, near))
            far.append(_kept(line, ~near))
        lines += self._fixed(now)
        lines += [self._circle(now, disc) for disc in self.scene.discs]
        patches, glass = [], []
        for surface in self.scene.surfaces:
            if surface.background or not len(surface.triangles):
                continue
            patch = Patch(now.surface(surface), surface.triangles, **_paint(surface))
            patches.append(patch)
            if surface.role == "box" and surface.opacity < 1.0:
                glass.append(Lines(patch.points, _EDGES, ROLES["rod"].colour, 1.0))
        lines += glass
        lines += self._forces(now)
        more = self._around(now, far) if around else ()
        return Seen(
            tuple(line for line in lines if len(line.ends)), tuple(patches), tuple(self._dots(now)), more
        )

    def moorings(self, record: int) -> Seen:
        """The same with all of the mooring lines, for a camera that looks at them, and the bottom that they lie on."""
        seen, now = self.seen(record, around=False), self._moment(record)
        lines = tuple(self._plain(now, line) for line in self._moorings)
        whole = np.concatenate([seen.points, *(line.points for line in lines)])
        low, high = whole.min(axis=0), whole.max(axis=0)
        margin = 0.05 * (high - low)
        around: list[Lines | Patch] = []
        if levels := self._bottoms:
            around.append(_level(low - margin, high + margin, max(levels), ROLES["seabed"].colour))
        if self.scene.water is not None:
            around.append(self._water(now, low - margin, high + margin))
        return Seen((*seen.lines, *lines), seen.patches, seen.marks, tuple(around))

    def largest(self, record: int) -> Seen:
        """The largest rigid body alone, for a camera that looks at it."""
        sizes = self.scene.sizes
        name = max(sizes, key=lambda body: sizes[body])
        number = next(k for k, pose in enumerate(self.scene.poses) if pose.name == name)
        own = [one for one in self.scene.surfaces if one.body == number and one.role in {"body", "box"}]
        corners = box_corners(np.concatenate([one.points for one in own]))
        now = self._moment(record)
        pose = self.scene.poses[number]
        origin = now.value(0, pose.position)
        return Seen(patches=(Patch(origin + corners @ now.matrix(number).T, _FACES),))

    # parts

    def _moment(self, record: int) -> Moment:
        return Moment(self.scene, pose=self._pose_of[record], scale=self._factor)

    @property
    def _moorings(self) -> list[Line]:
        return [line for line in self.scene.lines if line.role == "mooring"]

    @property
    def _bottoms(self) -> list[float]:
        return [float(one.points[0, 2]) for one in self.scene.surfaces if one.role == "seabed"]

    @property
    def _arrows(self) -> list[Any]:
        """Forces at contours. Collisions, which have many, have pictures of their own."""
        return [one for one in self.scene.arrows if not one.collision]

    @staticmethod
    def _plain(now: Moment, line: Line) -> Lines:
        look = ROLES[line.role]
        points = now.line(line)
        width = look.width if len(line.on) < 3 or line.ends is None or _is_chain(line) else 1.2
        opacity = 1.0 if width == look.width else 0.8
        return Lines(points, line.segments, line.colour, width, opacity)

    def _rigging(self, now: Moment) -> Iterable[Lines]:
        """Rods, forces, joints whose sides are apart: each of these near or far as a whole or by its segments."""
        for role in _RIGGED:
            parts = [one for one in self.scene.lines if one.role == role and not one.coiled]
            points, ends = [np.empty((0, 3))], [np.empty((0, 2), dtype=np.int64)]
            for line in parts:
                ends.append(line.segments + sum(len(part) for part in points))
                points.append(now.line(line))
            together, pairs = np.concatenate(points), np.concatenate(ends)
            found = Lines(
                together[pairs].reshape(-1, 3), np.arange(2 * len(pairs)).reshape(-1, 2), *_pen(role)
            )
            if role == "joint":
                lengths = np.linalg.norm(found.points[1::2] - found.points[::2], axis=1)
                found = _kept(found, lengths > _APART * self.scene.size)
            yield found
            if role == "spring":
                for line in self.scene.lines:
                    if line.coiled:
                        start, end = now.line(line)
                        yield Lines(*coil(start, end, self.scene.slim), *_pen(role))

    def _fixed(self, now: Moment) -> Iterable[Lines]:
        """All other lines, as ropes and contours, which are always looked at."""
        for line in self.scene.lines:
            if line.role not in {*_RIGGED, "mooring"} and (
                line.loose is None or not now.value(0, line.loose)
            ):
                yield self._plain(now, line)

    @staticmethod
    def _circle(now: Moment, disc: Disc) -> Lines:
        """A wheel by its circle."""
        axis = now.matrix(disc.body) @ (disc.axis / np.linalg.norm(disc.axis))
        u = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
        u /= np.linalg.norm(u)
        turns = 2.0 * np.pi * np.arange(_CIRCLE) / _CIRCLE
        circle = np.outer(np.cos(turns), u) + np.outer(np.sin(turns), np.cross(axis, u))
        order = np.arange(_CIRCLE)
        ends = np.column_stack([order, np.roll(order, -1)])
        return Lines(now.point(disc) + disc.radius * circle, ends, ROLES["rope"].colour, 1.5)

    def _dots(self, now: Moment) -> Iterable[Points]:
        for role in sorted(dict.fromkeys(dot.role for dot in self.scene.dots), key="centre".__eq__):
            found = [now.point(dot) for dot in self.scene.dots if dot.role == role]
            if found:
                yield Points(np.array(found), ROLES[role].colour, ROLES[role].dot)

    def _forces(self, now: Moment) -> Iterable[Lines]:
        for one in self._arrows:
            for place, force in zip(now.value(3, one.place), now.value(3, one.force), strict=True):
                if np.any(force):
                    yield force_arrow(place, force * (_ARROW * self.scene.size / self._peak))

    def _around(self, now: Moment, far: Sequence[Lines]) -> tuple[Lines | Patch, ...]:
        """Ground, water, and what leads to places far away."""
        found: list[Lines | Patch] = [
            Patch(now.surface(one), one.triangles, ROLES["ground"].colour)
            for one in self.scene.surfaces
            if one.background and one.role == "ground"
        ]
        window = self._window(_LINES)
        for line in (*far, *(self._plain(now, line) for line in self._moorings)):
            points, ends = clip_lines(line.points, line.ends, window)
            if len(ends):
                found.append(Lines(points, ends, line.colour, line.width))
        low, high = self._window(_WATER_AROUND)
        found += [
            _level(low, high, z, ROLES["seabed"].colour) for z in self._bottoms if low[2] <= z <= high[2]
        ]
        if self.scene.water is not None:
            found.append(self._water(now, low, high))
        return tuple(found)

    def _water(self, now: Moment, low: NDArray[np.float64], high: NDArray[np.float64]) -> Patch:
        """The water, with the undisturbed waves if there are any, seen through."""
        water = self.scene.water
        assert water is not None
        if water.waves is None:
            return _level(low, high, water.level, WATER_COLOUR, 0.3)
        x, y = (np.linspace(low[axis], high[axis], _CELLS + 1) for axis in (0, 1))
        X, Y = np.meshgrid(x, y, indexing="ij")
        Z = water.level + water.elevations(x, y, float(now.value(0, self.scene.times[0])))
        number = np.arange(X.size).reshape(X.shape)
        a, b, c, d = (
            part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
        )
        triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
        points = np.column_stack([X.ravel(), Y.ravel(), Z.ravel()])
        return Patch(points, triangles, WATER_COLOUR, 0.45)

    def _is_near(self, line: Lines) -> NDArray[np.bool_]:
        """Which connected segments are near enough to be looked at."""
        window = self._window(_RIGGING)
        inside = np.all((line.points >= window[0]) & (line.points <= window[1]), axis=1)
        near = inside[line.ends].all(axis=1)
        connected = len(line.points) != 2 * len(line.ends)
        found: NDArray[np.bool_] = np.full_like(near, near.all()) if connected else near
        return found

    def _window(self, share: float) -> NDArray[np.float64]:
        """The box that bodies move in, wider on all sides by a share of its diagonal, shape (2, 3)."""
        widened: NDArray[np.float64] = self.scene.box + share * self.scene.size * np.array([[-1.0], [1.0]])
        return widened

    def _exaggerated(self) -> float:
        """Round factor for bodies of which neither motion nor deformation would be seen."""
        scene = self.scene
        samples = sampled_records(len(scene.records))
        moved = bent = 0.0
        for surface in scene.surfaces:
            if surface.modes is None or surface.role != "body":
                continue
            start = Moment(scene, pose=0).surface(surface)
            for k in samples:
                now = Moment(scene, pose=int(k))
                moved = max(moved, float(np.abs(now.surface(surface) - start).max(initial=0.0)))
                u = now.local(surface) - surface.points
                bent = max(bent, float(np.linalg.norm(u, axis=1).max(initial=0.0)))
        if not 0.0 < bent < _SMALL * scene.size or moved > _SMALL * scene.size:
            return 1.0
        return deformation_scale(np.array([[bent, 0.0, 0.0]]), scene.size)


def _pen(role: Any) -> tuple[str, float]:
    """Colour and width of a role."""
    look = ROLES[role]
    return look.colour, look.width


def _paint(surface: Surface) -> dict[str, Any]:
    """Colour and opacity: bodies are alike in pictures."""
    if surface.group in {"bodies", "ground"}:
        return {"opacity": surface.opacity}
    return {"colour": surface.colour, "opacity": surface.opacity}


def _is_chain(line: Line) -> bool:
    """Whether its segments are one line and no net."""
    return line.ends is None or len(line.ends) <= len(line.on)


def _kept(line: Lines, which: NDArray[np.bool_]) -> Lines:
    """Some of the segments, with their points alone."""
    used, ends = np.unique(line.ends[which], return_inverse=True)
    return replace(line, points=line.points[used], ends=ends.reshape(-1, 2))


def _level(
    low: NDArray[np.float64], high: NDArray[np.float64], height: float, colour: str, opacity: float = 1.0
) -> Patch:
    """A level rectangle."""
    corners = np.array([[x, y, height] for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], dtype=np.float64)
    corners[:, :2] = low[:2] + corners[:, :2] * (high - low)[:2]
    return Patch(corners, np.array([[0, 1, 2], [0, 2, 3]]), colour, opacity)
