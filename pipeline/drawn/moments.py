"""Where all points of a scene to draw are at a time, or at a record."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.drawn.scene import POSES, SHAPES

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from heavylift.pipeline.drawn.scene import Anchor, Disc, Dot, DrawnScene, Line, Surface

__all__ = ["Moment", "between", "continued"]


def between(times: NDArray[np.float64], values: NDArray[np.float64], time: float) -> NDArray[np.float64]:
    """Values at a time, linear between those at some times."""
    j = int(np.clip(np.searchsorted(times, time), 1, max(len(times) - 1, 1)))
    if len(times) < 2:
        return values[0]
    i = j - 1
    gap = times[j] - times[i]
    w = float(np.clip((time - times[i]) / gap, 0.0, 1.0)) if gap > 0.0 else 0.0
    if w in {0.0, 1.0}:
        return values[j if w else i]
    found: NDArray[np.float64] = (1.0 - w) * values[i] + w * values[j]
    return found


def continued(quaternions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit quaternions whose signs do not jump, shape (k, 4)."""
    turned = np.sign(np.sum(quaternions[1:] * quaternions[:-1], axis=1))
    signs = np.concatenate([[1.0], np.cumprod(np.where(turned == 0.0, 1.0, turned))])
    return quaternions * signs[:, np.newaxis]


@dataclass(eq=False)
class Moment:
    """A scene at one instant.

    Attributes
    ----------
    scene
        What there is.
    time
        [s]; values are linear between records.
    pose
        In place of the time, which of the poses, of a scene whose timelines are all alike.
    scale
        Times as large as they are deformations by modes are drawn.
    """

    scene: DrawnScene
    time: float = 0.0
    pose: int | None = None
    scale: float = 1.0

    def value(self, timeline: int, values: NDArray[Any]) -> NDArray[Any]:
        """Of values on a timeline, shape (k, ...), those now."""
        if self.pose is not None:
            return values[min(self.pose, len(values) - 1)]
        return between(self.scene.times[timeline], values, self.time)

    def surface(self, surface: Surface) -> NDArray[np.float64]:
        """Points of a surface in the world [m], shape (n, 3)."""
        return self._placed(surface.body, self.local(surface))

    def line(self, line: Line) -> NDArray[np.float64]:
        """Points of a line in the world [m], shape (p, 3)."""
        local = line.local
        found = np.array(self.value(line.timeline, local) if local.ndim == 3 else local, dtype=np.float64)
        if line.surface is not None:
            assert line.vertex is not None
            for number in np.unique(line.surface[line.surface >= 0]):
                own = line.surface == number
                surface = self.scene.surfaces[int(number)]
                found[own] += self._moved(surface, line.vertex[own])
        for body in np.unique(line.on[line.on >= 0]):
            own = line.on == body
            found[own] = self._placed(int(body), found[own])
        return found

    def point(self, one: Disc | Dot) -> NDArray[np.float64]:
        """A dot, or the centre of a disc, in the world [m], shape (3,)."""
        offset = getattr(one, "offset", None)
        at = np.array(one.at, dtype=np.float64)
        if offset is not None:
            at = at + self.value(POSES, offset)
        return self._placed(one.body, at + self._carried(one.anchor))

    def matrix(self, body: int) -> NDArray[np.float64]:
        """Rotation from a body to the world, shape (3, 3)."""
        return np.eye(3) if body < 0 else self._frame(body)[1]

    def all(self, surfaces: Iterable[Surface], lines: Iterable[Line]) -> list[NDArray[np.float64]]:
        """Points of surfaces, and of lines behind them."""
        return [*map(self.surface, surfaces), *map(self.line, lines)]

    def local(self, surface: Surface) -> NDArray[np.float64]:
        """Points in the axes of the body."""
        points = surface.points
        if surface.modes is not None:
            assert surface.amplitudes is not None
            amplitudes = self.scale * self.value(POSES, surface.amplitudes)
            points = points + np.tensordot(amplitudes, surface.modes, axes=1)
        elif surface.shapes is not None:
            points = self.value(SHAPES, surface.shapes)
        if surface.size is not None:
            points = points * float(self.value(POSES, surface.size[:, np.newaxis])[0])
        if surface.at is not None:
            points = points + surface.at
        if surface.offset is not None:
            points = points + self.value(POSES, surface.offset)
        if surface.anchor is not None:
            points = points + self._carried(surface.anchor)
        return points

    def _carried(self, anchor: Anchor | None) -> NDArray[np.float64]:
        if anchor is None:
            return np.zeros(3)
        return self._moved(self.scene.surfaces[anchor.surface], np.array([anchor.point]))[0]

    def _moved(self, surface: Surface, points: NDArray[np.int64]) -> NDArray[np.float64]:
        """Displacements of some points of a surface that deforms, in axes of its body, shape (n, 3)."""
        if surface.modes is not None:
            assert surface.amplitudes is not None
            amplitudes = self.scale * self.value(POSES, surface.amplitudes)
            return np.tensordot(amplitudes, surface.modes[:, points], axes=1)
        if surface.shapes is not None:
            return self.value(SHAPES, surface.shapes[:, points]) - surface.points[points]
        return np.zeros((len(points), 3))

    def _placed(self, body: int, local: NDArray[np.float64]) -> NDArray[np.float64]:
        if body < 0:
            return local
        position, R = self._frame(body)
        found: NDArray[np.float64] = position + local @ R.T
        return found

    def _frame(self, body: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        if body not in self._frames:
            pose = self.scene.poses[body]
            q = pose.orientation if self.pose is not None else continued(pose.orientation)
            self._frames[body] = self.value(POSES, pose.position), rotation_matrix(self.value(POSES, q))
        return self._frames[body]

    @cached_property
    def _frames(self) -> dict[int, tuple[NDArray[np.float64], NDArray[np.float64]]]:
        return {}
