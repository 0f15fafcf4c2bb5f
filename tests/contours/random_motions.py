"""Random pairs of moving features in three regimes, in the world and, on a lattice, in the axes of body 1."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from exact_collision import edges_meet, origin_meets_triangle
from scipy.spatial.transform import Rotation

from heavylift.contours.triangles.swept import swept_edges, swept_face_vertex, swept_vertex_face
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import vector_at

Array = np.ndarray[Any, Any]

KINDS = ("vertex-face", "face-vertex", "edges")
REGIMES = ("free", "rigid", "common")
LATTICE = 2.0**-20
"""Coordinates in the axes of body 1 are multiples of this, so that integers hold them exactly."""

FIXED_POINTS = {"vertex-face": 3, "face-vertex": 1, "edges": 2}
COMMON_TRANSLATION = 4.0
"""Three times the mean length of an edge between points of a cube of side 2."""


@dataclass(frozen=True)
class Pairs:
    """Pairs of one kind.

    Attributes
    ----------
    kind
        Of `KINDS`; the first feature is of body 1.
    fixed
        Points of body 1 in its axes, in units of the lattice, int64 (n, k, 3).
    moving
        Points of body 2 at both times in the axes of body 1, int64 (n, 4 - k, 2, 3).
    rotations, origins
        Of body 1 at both times, (n, 2, 3, 3) and (n, 2, 3) [m].
    """

    kind: str
    fixed: Array
    moving: Array
    rotations: Array
    origins: Array

    def truth(self) -> tuple[Array, int]:
        """Contacts by exact arithmetic, and how many pairs needed it."""
        return exact(self.kind, self.fixed, self.moving)

    def rows(self, scale: float = LATTICE, offset: float = 0.0) -> Array:
        """Arguments of the swept tests [m]."""
        count = len(self.fixed)
        fixed = self.fixed.reshape(count, -1)
        moving = self.moving.reshape(count, -1)
        first, second = (moving, fixed) if self.kind == "vertex-face" else (fixed, moving)
        return np.concatenate((first, second), axis=1) * scale + offset

    def world(self) -> Array:
        """Positions in the world as the position difference method wants them, (n, 24)."""
        both = np.repeat(self.fixed[:, :, None], 2, axis=2)
        order = (self.moving, both) if self.kind == "vertex-face" else (both, self.moving)
        local = np.concatenate(order, axis=1) * LATTICE
        turned = np.einsum("ntij,nktj->nkti", self.rotations, local) + self.origins[:, None]
        return np.ascontiguousarray(turned.reshape(len(local), 24))


def exact(kind: str, fixed: Array, moving: Array) -> tuple[Array, int]:
    """Contacts of fixed (n, k, 3) and moving (n, 4 - k, 2, 3) points with integer coordinates."""
    if kind == "vertex-face":
        return origin_meets_triangle(fixed[:, :, None] - moving)
    if kind == "face-vertex":
        return origin_meets_triangle(moving - fixed[:, :, None])
    end = np.repeat(fixed[:, 1:, None], 2, axis=2)
    return edges_meet(np.concatenate((end, moving), axis=1) - fixed[:, :1, None])


def random_pairs(kind: str, regime: str, count: int, seed: int) -> Pairs:
    """Random points in a cube of side 2; motion up to 0.7 and 0.2 rad an axis."""
    random = np.random.default_rng(seed)
    k = FIXED_POINTS[kind]
    fixed = np.round(random.uniform(-1.0, 1.0, (count, k, 3)) / LATTICE)
    start = random.uniform(-1.0, 1.0, (count, 4 - k, 3))
    rotations = np.broadcast_to(np.eye(3), (count, 2, 3, 3)).copy()
    origins = np.zeros((count, 2, 3))
    if regime == "free":
        end = start + random.uniform(-0.7, 0.7, start.shape)
    else:
        turn = Rotation.from_rotvec(random.uniform(-0.2, 0.2, (count, 3))).as_matrix()
        end = np.einsum("nij,nkj->nki", turn, start) + random.uniform(-0.7, 0.7, (count, 1, 3))
        rotations[:, 1] = Rotation.from_rotvec(random.uniform(-0.2, 0.2, (count, 3))).as_matrix()
        origins[:, 1] = random.uniform(-0.7, 0.7, (count, 3))
    if regime == "common":
        direction = random.normal(size=(count, 3))
        shift = COMMON_TRANSLATION * direction / np.linalg.norm(direction, axis=1)[:, None]
        end += shift[:, None]
        origins[:, 1] += shift
    seen = np.einsum("nij,nkj->nki", rotations[:, 1].transpose(0, 2, 1), end - origins[:, None, 1])
    moving = np.round(np.stack((start, seen), axis=2) / LATTICE)
    return Pairs(kind, fixed.astype(np.int64), moving.astype(np.int64), rotations, origins)


@kernel
def run_swept(kind: int, rows: Array, hits: Array, times: Array) -> None:
    """Swept tests of many pairs: kind is a place in `KINDS`."""
    for i in range(len(rows)):
        r = rows[i]
        if kind == 0:
            hits[i], times[i] = swept_vertex_face(
                vector_at(r, 0), vector_at(r, 3), vector_at(r, 6), vector_at(r, 9), vector_at(r, 12)
            )
        elif kind == 1:
            hits[i], times[i] = swept_face_vertex(
                vector_at(r, 0),
                vector_at(r, 3),
                vector_at(r, 6),
                vector_at(r, 9),
                vector_at(r, 12),
                vector_at(r, 15),
                vector_at(r, 18),
            )
        else:
            hits[i], times[i] = swept_edges(
                vector_at(r, 0),
                vector_at(r, 3),
                vector_at(r, 6),
                vector_at(r, 9),
                vector_at(r, 12),
                vector_at(r, 15),
            )


def swept(kind: str, rows: Array) -> tuple[Array, Array]:
    """Contacts and times by the project's tests."""
    hits = np.zeros(len(rows), dtype=np.bool_)
    times = np.zeros(len(rows))
    run_swept(KINDS.index(kind), np.ascontiguousarray(rows), hits, times)
    return hits, times
