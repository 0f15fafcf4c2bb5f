"""Frames and shells of a run as they are drawn: smooth surfaces and tubes with the stress at every point."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.solver.bodies.ancf.stress import (
    FrameStresses,
    ShellStresses,
    frame_lengths,
    frame_stresses,
    largest_frame_stress,
    largest_shell_stress,
    shell_coordinates,
    shell_stresses,
)
from heavylift.solver.scene.meshes import FrameBody, ShellBody, ShellSide

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

__all__ = ["MeshRun", "MeshSkin", "Skin", "frame_radius", "rest_coordinates"]

_POINTS = 120_000  # of one body at most, if its elements are many
_AROUND = 16  # corners of the cross-section of a tube
# parts of an element along a side: so that every place is one of those where the largest stress is looked for
_PARTS = {"frame": (2, 3, 4, 6, 12), "shell": (2, 3, 6)}


@dataclass(frozen=True, eq=False)
class Skin:
    """What is drawn of a body at one instant.

    Attributes
    ----------
    points, normals, triangles
        Surface [m], shapes (m, 3), (m, 3) and (nt, 3).
    values
        Stress at the points [Pa], shape (m,): von Mises, of frames the axial stress with its sign.
    largest, where
        Stress of largest amount [Pa], which may lie between the points, and its element: as they are recorded.
    outline, edges
        Borders, and sides of elements: indices of points, shape (k, 2).
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    triangles: NDArray[np.int64]
    values: NDArray[np.float64]
    largest: float
    where: int
    outline: NDArray[np.int64]
    edges: NDArray[np.int64]


def rest_coordinates(body: FrameBody | ShellBody) -> NDArray[np.float64]:
    """Vectors of the nodes of the unloaded shape in body axes, shape (n, 2 or 4, 3)."""
    if isinstance(body, ShellBody):
        return shell_coordinates(body)
    return np.stack([body.nodes, body.tangents], axis=1)


def frame_radius(body: FrameBody) -> float:
    """Radius of the tube that stands for a frame [m]: the largest outer fibre, or that of a round bar."""
    return max(section.outer_fibre or float(np.sqrt(section.area / np.pi)) for section in body.sections)


class MeshSkin:
    """Makes the skin of one frame or shell at any coordinates of its nodes.

    Elements are divided evenly and drawn with their own shape functions, so that a coarse mesh is as smooth as it
    is in the computation. Stresses are those of each element; they jump where elements meet as they do there.

    Parameters
    ----------
    body
        Frame or shell.
    lengths
        Of the unloaded elements of a frame [m], shape (e,); found if None.
    side
        Of a shell whose stress is shown.
    widening
        Tubes are drawn with so many times their radius.
    most
        Points at most, if its elements allow it.
    """

    def __init__(
        self,
        body: FrameBody | ShellBody,
        *,
        lengths: NDArray[np.float64] | None = None,
        side: ShellSide = "largest",
        widening: float = 1.0,
        most: int = _POINTS,
    ) -> None:
        self.body = body
        self.widening = widening
        if lengths is None and isinstance(body, FrameBody):  # once, not at every record
            lengths = frame_lengths(body.nodes, body.tangents, body.elements)
        self._lengths, self._side = lengths, side
        count = len(body.elements)
        if isinstance(body, ShellBody):
            fit = int(np.sqrt(most / count)) - 1
            self._places = _places(fit, "shell")
            self._triangles, self._sides = _grid_triangles(count, len(self._places))
            self._outline = self._sides[_lonely(body.elements)].reshape(-1, 2)
        else:
            fit = most // (_AROUND * count) - 3
            self._places = _places(fit, "frame")
            self._triangles = _tube_triangles(count, len(self._places))

    @property
    def is_shell(self) -> bool:
        """Whether the body is a shell."""
        return isinstance(self.body, ShellBody)

    @property
    def rest(self) -> NDArray[np.float64]:
        """Vectors of the nodes of the unloaded shape in body axes, shape (n, 2 or 4, 3)."""
        return rest_coordinates(self.body)

    def material_points(self, points: NDArray[np.float64]) -> NDArray[np.int64]:
        """Indices, for `followed`, of the drawn points nearest to points of the unloaded shape, shape (k, 3)."""
        drawn = self._stresses(rest_coordinates(self.body)).places.reshape(-1, 3)
        return np.array([int(np.argmin(np.linalg.norm(drawn - point, axis=1))) for point in points])

    def followed(self, coordinates: NDArray[np.float64], indices: NDArray[np.int64]) -> NDArray[np.float64]:
        """Where points of the body have got [m], shape (k, 3)."""
        return self._stresses(coordinates).places.reshape(-1, 3)[indices]

    def lines(self, coordinates: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Border of a shell or centre line of a frame: points, shape (m, 3), and segments, shape (k, 2)."""
        places = self._stresses(coordinates).places
        if self.is_shell:
            return places.reshape(-1, 3), self._outline
        count, along = places.shape[:2]
        starts = (np.arange(count)[:, np.newaxis] * along + np.arange(along - 1)).ravel()
        return places.reshape(-1, 3), np.column_stack([starts, starts + 1])

    def skin(self, coordinates: NDArray[np.float64], drawn: NDArray[np.float64] | None = None) -> Skin:
        """Skin at the vectors of the nodes in world axes, shape (n, 2 or 4, 3).

        With `drawn` it has the shape of these, e.g. of larger displacements, and the stress of `coordinates`.
        """
        found = self._stresses(coordinates)
        shown = found if drawn is None else self._stresses(drawn)
        if isinstance(self.body, FrameBody):
            assert isinstance(found, FrameStresses)
            assert isinstance(shown, FrameStresses)
            return self._tube(
                found, shown, largest_frame_stress(self.body, coordinates, lengths=self._lengths)
            )
        assert isinstance(found, ShellStresses)
        assert isinstance(shown, ShellStresses)
        return self._surface(found, shown, largest_shell_stress(self.body, coordinates, self._side))

    def _stresses(self, coordinates: NDArray[np.float64]) -> FrameStresses | ShellStresses:
        if isinstance(self.body, ShellBody):
            return shell_stresses(self.body, coordinates, self._places, self._places)
        return frame_stresses(self.body, coordinates, self._places, lengths=self._lengths)

    def _surface(self, found: ShellStresses, shown: ShellStresses, largest: NDArray[np.float64]) -> Skin:
        values = found.von_mises(self._side)
        where = int(np.argmax(largest))
        return Skin(
            points=shown.places.reshape(-1, 3),
            normals=shown.normals.reshape(-1, 3),
            triangles=self._triangles,
            values=values.ravel(),
            largest=float(largest[where]),
            where=where,
            outline=self._outline,
            edges=self._sides.reshape(-1, 2),
        )

    def _tube(self, found: FrameStresses, shown: FrameStresses, largest: NDArray[np.float64]) -> Skin:
        assert isinstance(self.body, FrameBody)
        across, other = _transported(shown.tangents)
        angles = 2.0 * np.pi * np.arange(_AROUND) / _AROUND
        out = (
            np.cos(angles)[:, np.newaxis] * across[..., np.newaxis, :]
            + np.sin(angles)[:, np.newaxis] * other[..., np.newaxis, :]
        )
        radius = self.widening * frame_radius(self.body)
        rings = shown.places[..., np.newaxis, :] + radius * out
        # a fibre on the side of the centre of curvature is compressed
        length = np.linalg.norm(found.bending, axis=-1, keepdims=True)
        direction = found.bending / np.maximum(length, np.finfo(np.float64).tiny)
        bent = np.einsum("epk,epak->epa", direction, out) * found.fibre_stress[..., np.newaxis]
        values = found.axial_stress[..., np.newaxis] - bent
        # closed at both ends by a disc: its ring once more, with the tangent as normal, and its centre
        points, normals, stress = [rings], [out], [values]
        for end, sign in ((0, -1.0), (-1, 1.0)):
            points.append(rings[:, [end]])
            normals.append(
                np.broadcast_to(sign * shown.tangents[:, [end], np.newaxis], rings[:, [end]].shape)
            )
            stress.append(values[:, [end]])
        where = int(np.argmax(np.abs(largest)))
        none = np.empty((0, 2), dtype=np.int64)
        return Skin(
            points=np.concatenate(points, axis=1).reshape(-1, 3),
            normals=np.concatenate(normals, axis=1).reshape(-1, 3),
            triangles=self._triangles,
            values=np.concatenate(stress, axis=1).ravel(),
            largest=float(largest[where]),
            where=where,
            outline=none,
            edges=none,
        )


def _places(fit: int, kind: str) -> NDArray[np.float64]:
    """Places along an element of about so many parts."""
    return np.linspace(0.0, 1.0, max([parts for parts in _PARTS[kind] if parts <= fit], default=2) + 1)


def _grid_triangles(count: int, side: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Triangles of square grids of points, and segments along their four sides, shape (count, 4, side - 1, 2)."""
    grid = np.arange(side * side).reshape(side, side)
    a, b, c, d = (part.ravel() for part in (grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]))
    one = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    lines = [grid[:, 0], grid[-1], grid[:, -1], grid[0]]  # between nodes 0-1, 1-2, 2-3, 3-0
    sides = np.array([np.column_stack([line[:-1], line[1:]]) for line in lines])
    starts = side * side * np.arange(count)
    triangles = (one + starts[:, np.newaxis, np.newaxis]).reshape(-1, 3)
    return triangles, sides + starts[:, np.newaxis, np.newaxis, np.newaxis]


def _lonely(elements: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Sides of elements that no other element has, shape (e, 4)."""
    sides = np.sort(np.stack([elements, np.roll(elements, -1, axis=1)], axis=-1), axis=-1).reshape(-1, 2)
    _, inverse, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    return (count[inverse.ravel()] == 1).reshape(-1, 4)


def _tube_triangles(count: int, along: int) -> NDArray[np.int64]:
    """Triangles of tubes of `along` rings and two more that close them."""
    ring = np.arange(_AROUND)
    following = (ring + 1) % _AROUND
    parts = []
    for k in range(along - 1):
        low, high = k * _AROUND, (k + 1) * _AROUND
        parts.append(np.column_stack([low + ring, low + following, high + following]))
        parts.append(np.column_stack([low + ring, high + following, high + ring]))
    fan = np.column_stack([np.zeros(_AROUND - 2, dtype=np.int64), ring[1:-1], ring[2:]])
    parts.append(fan[:, ::-1] + along * _AROUND)
    parts.append(fan + (along + 1) * _AROUND)
    one = np.concatenate(parts)
    starts = (along + 2) * _AROUND * np.arange(count)
    return (one + starts[:, np.newaxis, np.newaxis]).reshape(-1, 3)


def _transported(
    tangents: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two unit vectors across the tangents, shape (e, p, 3), that do not turn about them along an element."""
    least = np.argmin(np.abs(tangents[:, 0]), axis=1)
    across = np.empty_like(tangents)
    before = np.eye(3)[least]
    for place in range(tangents.shape[1]):
        t = tangents[:, place]
        now = before - np.sum(before * t, axis=1, keepdims=True) * t
        across[:, place] = before = now / np.maximum(np.linalg.norm(now, axis=1, keepdims=True), 1e-300)
    return across, np.cross(tangents, across)


@dataclass(frozen=True, eq=False)
class MeshRun:
    """A frame or shell and its motion.

    Attributes
    ----------
    body
        Unloaded shape, sections, and the pose of its frame, which stands still.
    coordinates
        Vectors of the nodes in world axes at a record, shape (n, 2 or 4, 3).
    lengths
        Of the unloaded elements of a frame [m], shape (e,); found if None.
    """

    body: FrameBody | ShellBody
    coordinates: Callable[[int], NDArray[np.float64]]
    lengths: NDArray[np.float64] | None = None

    @property
    def rest(self) -> NDArray[np.float64]:
        """Vectors of the nodes of the unloaded shape in world axes, shape (n, 2 or 4, 3)."""
        from heavylift.numerics.rotation import rotation_matrix

        moved = rest_coordinates(self.body) @ rotation_matrix(self.body.orientation).T
        moved[:, 0] += self.body.position
        return moved
