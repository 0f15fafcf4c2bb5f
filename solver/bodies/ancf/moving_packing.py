"""Moving points of frames and shells become arrays, and what the control points of their shape are made of."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.block_pattern import NODE, BlockPattern
from heavylift.numerics.small import aligned
from heavylift.solver.bodies.ancf.kind import (
    BASE_NODES,
    COMPLIANCE,
    CURRENT,
    ENTRIES,
    FIRST_COLUMN,
    FIRST_CONTROL,
    FIRST_NODE,
    FIRST_POINT,
    LAST_COLUMN,
    MESH_COLUMNS,
    MOVING,
    NODES,
    PATH,
    POINT_COLUMNS,
    VECTORS,
    MovingPoints,
)
from heavylift.solver.bodies.ancf.mesh_contour import control_vectors
from heavylift.solver.meshes import MeshBody

__all__ = ["pack_moving"]


def pack_moving(
    bodies: Sequence[MeshBody], table: NDArray[np.int64], pattern: BlockPattern, lanes: int, per_node: int
) -> MovingPoints:
    """All moving points of a kind of meshes, none of them aimed at anything.

    Parameters
    ----------
    bodies, table
        Bodies, and their rows in the table of the kind.
    pattern
        Of the factor.
    lanes, per_node
        Places and vectors of a node.

    Raises
    ------
    InputError
        If a body with moving points is no line and no rectangle of elements.
    """
    rows = np.zeros((len(bodies), MESH_COLUMNS), dtype=np.int64)
    points: list[NDArray[np.int64]] = []
    places: list[NDArray[np.int64]] = []
    factors: list[NDArray[np.float64]] = []
    entries = vectors = paths = compliance = controls = count = 0
    for row, body, line in zip(rows, bodies, table, strict=True):
        moving = int(line[MOVING])
        row[[FIRST_POINT, COMPLIANCE, FIRST_CONTROL]] = count, compliance, controls
        if moving == 0:
            continue
        own = np.zeros((moving, POINT_COLUMNS), dtype=np.int64)
        steps = (
            (ENTRIES, int(line[NODES]) * per_node, entries),
            (VECTORS, 3 * int(line[NODES] + line[BASE_NODES]) * lanes, vectors),
            (PATH, int(line[LAST_COLUMN] - line[FIRST_COLUMN]), paths),
        )
        for column, size, first in steps:
            own[:, column] = first + size * np.arange(moving)
        own[:, CURRENT] = -1
        points.append(own)
        entries, vectors, paths = (first + size * moving for _, size, first in steps)
        compliance += (3 * moving) ** 2
        count += moving
        made = control_vectors(body)
        node, vector = made.vectors // per_node, made.vectors % per_node
        places.append((line[FIRST_NODE] + node) * lanes + 3 * vector)
        factors.append(made.factors)
        controls += len(made.factors)
    nodes = int((table[:, NODES] + table[:, BASE_NODES]).sum())
    column_of = np.full(nodes, -1, dtype=np.int64)
    column_of[pattern.columns[:, NODE]] = np.arange(len(pattern.columns))
    return MovingPoints(
        bodies=rows,
        points=np.vstack([np.zeros((0, POINT_COLUMNS), dtype=np.int64), *points]),
        entries=np.zeros(entries, dtype=np.int64),
        factors=np.zeros(entries),
        vectors=aligned(vectors),
        paths=np.zeros(paths, dtype=np.int64),
        compliance=np.zeros(compliance),
        column_of=column_of,
        marks=np.zeros(nodes, dtype=np.int64),
        control_places=np.vstack([np.zeros((0, 4), dtype=np.int64), *places]),
        control_factors=np.vstack([np.zeros((0, 4)), *factors]),
    )
