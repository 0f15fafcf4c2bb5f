"""Contours as they are drawn: their spline, and the surface that it stands for."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.solver.scene.outlines import ROUND, chain, grid_triangles

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.splines.neutral import NeutralContour
    from heavylift.solver.scene.contacts import Contour

    Faces = tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64] | None]

__all__ = ["ContourShape", "contour_shape"]

_PIECES = 3  # samples of a polynomial piece of a contour
_LINES = 13  # lines of a contour in each direction at most


class ContourShape(NamedTuple):
    """A contour in the axes of its body.

    Attributes
    ----------
    line, ends, line_modes
        Points of its lines [m], shape (p, 3), segments, shape (e, 2), and how they move, shape (nf, p, 3).
    points, triangles, modes
        Its surface, shapes (n, 3), (m, 3) and (nf, n, 3); empty if its lines are all there is.
    """

    line: NDArray[np.float64]
    ends: NDArray[np.int64]
    line_modes: NDArray[np.float64] | None
    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    modes: NDArray[np.float64] | None


def contour_shape(contour: Contour, *, carried: bool = False) -> ContourShape:
    """Lines and surface of a contour.

    Parameters
    ----------
    contour
        Not the shape of a frame or shell.
    carried
        Whether its body is drawn and deforms by modes. A surface is drawn by its lines then.

    Notes
    -----
    A spline is linear in its control points and these in the amplitudes of modes. What is drawn about a curve, a tube
    or a band, moves with it and is not turned.
    """
    assert contour.neutral is not None
    points, tangents = _sampled(contour.neutral)
    closed = [space.closed for space in contour.neutral.spaces]
    moved = None
    if carried and (count := len(contour.neutral.modal)):
        moved = np.array([_sampled(contour.neutral.deformed(one))[0] - points for one in np.eye(count)])
    none: Faces = np.empty((0, 3)), np.empty((0, 3), dtype=np.int64), None
    if contour.neutral.is_surface:
        used, ends = np.unique(_net(points.shape[:2], closed), return_inverse=True)
        surface: Faces = points.reshape(-1, 3), grid_triangles(points.shape[:2], closed), None
        line_modes = None if moved is None else moved.reshape(len(moved), -1, 3)[:, used]
        return ContourShape(
            points.reshape(-1, 3)[used], ends.reshape(-1, 2), line_modes, *(none if carried else surface)
        )
    tangents = tangents / np.linalg.norm(tangents, axis=1, keepdims=True)
    beside = None
    if contour.radius > 0.0:
        across = _carried(tangents, np.eye(3)[np.argmin(np.abs(tangents[0]))])
        turns = 2.0 * np.pi * np.arange(ROUND) / ROUND
        other = np.cross(tangents, across)
        rings = np.cos(turns)[:, None] * across[:, None] + np.sin(turns)[:, None] * other[:, None]
        beside, round_it = contour.radius * rings, True
    elif contour.width > 0.0:
        normals = np.cross(contour.director, tangents)
        across = np.cross(tangents, normals / np.linalg.norm(normals, axis=1, keepdims=True))
        half = 0.5 * contour.width * across
        beside, round_it = np.stack([-half, 0.0 * half, half], axis=1), False
    if beside is not None:
        grid = points[:, None] + beside
        surface = grid.reshape(-1, 3), grid_triangles(grid.shape[:2], [closed[0], round_it]), None
        if moved is not None:
            surface = (*surface[:2], np.repeat(moved, beside.shape[1], axis=1))
    return ContourShape(points, chain(len(points), closed[0]), moved, *(none if beside is None else surface))


def _sampled(neutral: NeutralContour) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points of a spline, shape (k, 3), or (k, l, 3) of a surface, and derivatives by its first parameter."""
    from heavylift.contours.splines.derivatives import sample_grid

    _, values = sample_grid(neutral, _PIECES)
    return values[..., 0, :], values[..., 1, :]


def _carried(tangents: NDArray[np.float64], across: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit vectors across a curve that turn with its tangent and no more, shape (k, 3)."""
    found = np.empty_like(tangents)
    for k, tangent in enumerate(tangents):
        across = across - (across @ tangent) * tangent
        across = across / np.linalg.norm(across)
        found[k] = across
    return found


def _net(shape: tuple[int, ...], closed: list[bool]) -> NDArray[np.int64]:
    """Segments along both directions of a grid of points, few of them, those at the borders always."""
    numbers = np.arange(shape[0] * shape[1]).reshape(shape)
    ends = []
    for axis in (0, 1):
        along = numbers if axis == 0 else numbers.T
        count = len(along.T) - (1 if closed[1 - axis] else 0)
        chosen = np.unique(np.linspace(0, count - 1, min(_LINES, count)).round().astype(int))
        steps = chain(len(along), closed[axis])
        ends += [along[steps, column] for column in chosen]
    return np.concatenate(ends)
