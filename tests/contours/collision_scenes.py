"""Pairs of surfaces on a short way into each other: what tests and benchmarks of collision detection ask.

Each pair moves by a few centimetres at most, from a gap of millimetres (13.6 m for the one far apart). The models are
those of the cases bunnies and tank_in_hull.
"""

from __future__ import annotations

import importlib.util
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface, clean

if TYPE_CHECKING:
    from types import ModuleType

    from numpy.typing import NDArray

CASES = Path(__file__).resolve().parents[2] / "cases"
NAMES = ("bunny_bunny", "bunny_plane", "tank_plane", "tank_hull", "tank_hull_tilted", "far_apart")
PLANE_SIZE = 400.0  # m


class Query(NamedTuple):
    """Two surfaces, and the motion of B in the axes of A: R0 (9), p0 (3), R1 (9), p1 (3), x_A = R x_B + p."""

    a: TriangleSurface
    b: TriangleSurface
    motion: NDArray[np.float64]  # (24,)


class Pose(NamedTuple):
    """Body to world."""

    rotation: NDArray[np.float64]
    position: NDArray[np.float64]


def models(case: str) -> ModuleType:
    """Generator of the models of a case."""
    spec = importlib.util.spec_from_file_location(f"make_models_{case}", CASES / case / "make_models.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def corners(name: str) -> NDArray[np.float64]:
    """Corners of all triangles of "tank", "hull", "bunny" or "plane", none shared [m], shape (n, 3, 3)."""
    if name == "bunny":
        points, triangles = models("bunnies").make_bunny()
        return points[triangles]
    if name == "plane":
        s = 0.5 * PLANE_SIZE
        square = np.array([[-s, -s, 0.0], [s, -s, 0.0], [s, s, 0.0], [-s, s, 0.0]])
        return square[[[0, 1, 2], [0, 2, 3]]]
    return getattr(models("tank_in_hull"), f"make_{name}")()


@cache
def surface(name: str) -> TriangleSurface:
    """Welded surface of "tank", "hull", "bunny" or "plane"."""
    soup = corners(name).reshape(-1, 3)
    return clean(soup, np.arange(len(soup)).reshape(-1, 3), name=name)[0]


def rotation(axis: tuple[float, float, float], angle: float) -> NDArray[np.float64]:
    """Rotation about an axis of any length by an angle [rad] (Rodrigues)."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * (k @ k)


def relative_motion(a0: Pose, a1: Pose, b0: Pose, b1: Pose) -> NDArray[np.float64]:
    """Motion of B in the axes of A, shape (24,)."""
    parts = []
    for a, b in ((a0, b0), (a1, b1)):
        parts += [(a.rotation.T @ b.rotation).ravel(), a.rotation.T @ (b.position - a.position)]
    return np.concatenate(parts)


def _pose(turn: NDArray[np.float64], *position: float) -> Pose:
    return Pose(turn, np.array(position))


def _over_ground(name: str, turn: NDArray[np.float64], gap: float) -> float:
    """Height of the origin at which the lowest point has the gap to z = 0."""
    return gap - float((surface(name).points @ turn.T)[:, 2].min())


@cache
def query(name: str) -> Query:
    """One of the pairs of `NAMES`."""
    still = _pose(np.eye(3), 0.0, 0.0, 0.0)
    if name == "bunny_bunny":
        a1 = _pose(rotation((0, 0, 1), 0.02), 0.004, 0.0, 0.0)
        b0 = _pose(rotation((1, 2, 3), 0.40), 0.196, 0.01, 0.0)
        b1 = _pose(rotation((1, 2, 3), 0.43), 0.186, 0.012, 0.0)
        return Query(surface("bunny"), surface("bunny"), relative_motion(still, a1, b0, b1))
    if name in {"bunny_plane", "tank_plane"}:
        body = name.removesuffix("_plane")
        if body == "bunny":
            turns, gap, way = (rotation((1, 0, 0), 0.30), rotation((1, 0, 0), 0.31)), 1e-3, 0.01
        else:
            turns, gap, way = (rotation((1, 0.3, 0), 2e-3), rotation((1, 0.3, 0), 1.5e-3)), 2e-3, 0.03
        height = _over_ground(body, turns[0], gap)
        b0, b1 = _pose(turns[0], 0.0, 0.0, height), _pose(turns[1], 0.0, 0.0, height - way)
        return Query(surface("plane"), surface(body), relative_motion(still, still, b0, b1))
    # the hull rolls a little, the tank sets down
    a1 = _pose(rotation((1, 0, 0), 2e-4), 0.0, 1e-3, 2e-3)
    if name == "tank_hull":
        b0 = _pose(np.eye(3), 0.03, 0.0, 0.010)
        b1 = _pose(rotation((0, 1, 0), 1e-4), 0.032, 0.004, -0.010)
    elif name == "tank_hull_tilted":
        tilt = rotation((0, 1, 0), np.radians(20.0))
        b0, b1 = _pose(tilt, 0.0, 0.0, 3.2673), _pose(tilt, 0.01, 0.001, 3.2473)
    elif name == "far_apart":
        b0, b1 = _pose(np.eye(3), 0.0, 0.0, 30.0), _pose(np.eye(3), 0.0, 0.0, 29.99)
    else:
        raise ValueError(name)
    return Query(surface("hull"), surface("tank"), relative_motion(still, a1, b0, b1))
