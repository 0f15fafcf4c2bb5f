"""Where to look from: a perspective that shows the part, fitted exactly to the picture."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from heavylift.pipeline.drawn.outer_surface import Surface

__all__ = ["Camera", "View", "choose_view", "fit_camera", "plane_view"]

_HALF_ANGLE = np.radians(11.0)  # half the vertical field of view: a mild perspective, parallels stay readable
_BEHIND = 1.0e-9
_FROM_BELOW = 0.6  # weight of views from below


@dataclass(frozen=True)
class View:
    """Direction of sight: unit vectors to the right, up and towards the observer, body frame."""

    right: tuple[float, float, float]
    up: tuple[float, float, float]
    towards: tuple[float, float, float]

    @classmethod
    def looking(cls, towards: ArrayLike, up: ArrayLike) -> View:
        """View with the observer in direction `towards` and `up` as near to vertical as possible."""
        back = np.asarray(towards, dtype=float) / np.linalg.norm(towards)
        right = np.cross(np.asarray(up, dtype=float), back)
        right /= np.linalg.norm(right)
        above = np.cross(back, right)
        triples = [tuple(float(value) for value in axis) for axis in (right, above, back)]
        return cls(*triples)  # type: ignore[arg-type]

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Rows right, up, towards; shape (3, 3)."""
        return np.array([self.right, self.up, self.towards])


@dataclass(frozen=True, eq=False)
class Camera:
    """Perspective camera; lengths in the unit of the points it was fitted to."""

    view: View
    position: NDArray[np.float64]
    half_angle: float
    aspect: float

    def project(self, points: ArrayLike) -> NDArray[np.float64]:
        """Picture coordinates: x, y from 0 (left, bottom) to 1, and the distance; shape (..., 3)."""
        local = (np.asarray(points, dtype=float) - self.position) @ self.view.matrix.T
        distance = -local[..., 2]
        scale = 0.5 / (np.tan(self.half_angle) * distance)
        return np.stack(
            [0.5 + local[..., 0] * scale / self.aspect, 0.5 + local[..., 1] * scale, distance], -1
        )


def fit_camera(view: View, points: ArrayLike, aspect: float, *, margin: float = 0.04) -> Camera:
    """Nearest camera in a given direction that has all points within the picture.

    Parameters
    ----------
    view
        Direction of sight.
    points
        What must be visible, shape (n, 3).
    aspect
        Width over height of the picture.
    margin
        Share of the width and of the height left free on each side.

    Notes
    -----
    With x, y, z the coordinates along right, up and towards, and the camera at (a, b, D), a point is visible
    when ``|x - a| <= t_x (D - z)``. So a lies between ``max(x + t_x z) - t_x D`` and
    ``min(x - t_x z) + t_x D``, which is possible from ``D = (max(x + t_x z) - min(x - t_x z)) / (2 t_x)`` on;
    the same holds for y and b.
    """
    matrix = view.matrix
    x, y, z = (np.asarray(points, dtype=float).reshape(-1, 3) @ matrix.T).T
    t_y = np.tan(_HALF_ANGLE) * (1.0 - 2.0 * margin)
    t_x = t_y * aspect
    span = max(np.ptp(x), np.ptp(y), np.ptp(z), _BEHIND)
    reach = [
        ((x + t_x * z).max() - (x - t_x * z).min()) / (2.0 * t_x),
        ((y + t_y * z).max() - (y - t_y * z).min()) / (2.0 * t_y),
        z.max() + 0.5 * span,
    ]
    distance = max(reach)
    a = 0.5 * ((x + t_x * z).max() + (x - t_x * z).min())
    b = 0.5 * ((y + t_y * z).max() + (y - t_y * z).min())
    return Camera(view, np.array([a, b, distance]) @ matrix, float(_HALF_ANGLE), aspect)


def plane_view(points: NDArray[np.float64], up: NDArray[np.float64], *, flat: float) -> View | None:
    """View across the plane that all points lie in; None if they do not.

    Parameters
    ----------
    points
        Shape (n, 3).
    up
        Direction that points up in the picture, unless the plane is across it: then y does, or z.
    flat
        Depth of the points relative to their extent that still counts as plane.
    """
    _, extents, axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    if len(extents) > 2 and extents[2] > flat * extents[0]:
        return None
    if len(extents) > 2 and extents[1] > 1.0e-6 * extents[0]:
        normal = axes[2]
    else:  # a line is seen from where `up` can point upwards
        normal = np.cross(axes[0], up)
        if np.linalg.norm(normal) < 1.0e-6 * np.linalg.norm(up):
            normal = np.cross(axes[0], np.eye(3)[np.argmin(np.abs(axes[0]))])
        normal /= np.linalg.norm(normal)
    if abs(normal @ up) > 0.5 * np.linalg.norm(up):
        up = np.array([0.0, 1.0, 0.0]) if abs(normal[1]) < 0.5 else np.array([0.0, 0.0, 1.0])
    view = View.looking(normal, up)
    right = np.array(view.right)
    return view if right[np.argmax(np.abs(right))] > 0.0 else View.looking(-normal, up)


def choose_view(surface: Surface, *, up: ArrayLike | None = None) -> View:
    """Direction from which most feature edges are seen, relative to the size of the picture.

    A part with a pocket is shown with the pocket open to the observer. Without `up` the z axis points up,
    unless y up shows clearly more.

    Notes
    -----
    Visibility by a coarse depth buffer of points sampled on the triangles: what is nearest counts, points on
    feature edges that lie behind it are hidden.
    """
    ups = [np.asarray(up, dtype=float)] if up is not None else [np.array([0.0, 0, 1]), np.array([0.0, 1, 0])]
    extent = np.ptp(surface.nodes, axis=0)
    sampled = _samples(surface)
    best_of_each = []
    for axis in ups:
        views = _candidates(axis, extent)
        # seen from below things look strange: only if that shows much more
        scores = [
            _visible_length(view, *sampled) * (1.0 if np.dot(view.towards, axis) > 0.0 else _FROM_BELOW)
            for view in views
        ]
        winner = int(np.argmax(scores))
        best_of_each.append((scores[winner], views[winner]))
    chosen = best_of_each[0]
    for other in best_of_each[1:]:
        if other[0] > 1.2 * chosen[0]:
            chosen = other
    return chosen[1]


def _candidates(up: NDArray[np.float64], extent: NDArray[np.float64]) -> list[View]:
    """Eight slanted views around the vertical; a long horizontal axis is seen nearly from its side."""
    vertical = int(np.argmax(np.abs(up)))
    a, b = [axis for axis in range(3) if axis != vertical]
    if extent[b] > extent[a]:
        a, b = b, a
    along = 0.75 if extent[a] < 1.5 * extent[b] else 0.5
    views = []
    # observers at the front (negative side of the second axis for z up) come first: they win ties
    for sign_b, sign_a, height in product((-1.0, 1.0), (1.0, -1.0), (0.55, -0.35)):
        towards = height * up / np.linalg.norm(up)
        towards[a] += along * sign_a
        towards[b] += 0.85 * sign_b
        views.append(View.looking(towards, up))
    return views


def _samples(
    surface: Surface, count: int = 12000
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Points spread over the triangles; points along the feature edges and the length each stands for."""
    generator = np.random.default_rng(0)
    corner = surface.nodes[surface.triangles]
    if len(corner):
        area = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
        chosen = corner[generator.choice(len(corner), count, p=area / area.sum())]
        weights = generator.dirichlet(np.ones(3), count)
        points = np.einsum("ik,ikj->ij", weights, chosen)
    else:
        points = surface.nodes
    ends = surface.nodes[surface.feature_edges]
    places = np.array([1.0, 3.0, 5.0]) / 6.0
    on_edge = ends[:, :1] + places[:, None] * (ends[:, 1:] - ends[:, :1])
    length = np.repeat(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / len(places), len(places))
    return points, on_edge.reshape(-1, 3), length


def _visible_length(
    view: View,
    samples: NDArray[np.float64],
    edge_points: NDArray[np.float64],
    edge_weights: NDArray[np.float64],
    cells: int = 48,
) -> float:
    """Share of the feature edges' length seen by a distant observer, times the scale that fits the part."""
    local = samples @ view.matrix.T
    low, high = local.min(axis=0), local.max(axis=0)
    size = max((high - low)[:2].max() / cells, np.finfo(float).tiny)
    width = int((high - low)[0] / size) + 1

    def cell(points: NDArray[np.float64]) -> NDArray[np.int64]:
        place = np.clip(((points[:, :2] - low[:2]) / size).astype(np.int64), 0, cells)
        return place[:, 1] * width + np.minimum(place[:, 0], width - 1)

    depth = np.full((cells + 1) * (width + 1), -np.inf)
    np.maximum.at(depth, cell(local), local[:, 2])
    if not len(edge_points):
        return float((depth > -np.inf).sum())
    edge_local = edge_points @ view.matrix.T
    visible = edge_local[:, 2] > depth[cell(edge_local)] - 2.5 * size
    scale = 1.0 / max((high - low)[0] / 1.5, (high - low)[1])
    return float(edge_weights[visible].sum() * scale)
