"""Moving points of frames and shells become arrays, and what the control points of their shape are made of."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.block_pattern import BlockPattern
from heavylift.numerics.records import Records, records
from heavylift.numerics.small import aligned
from heavylift.solver.bodies.ancf.kind import MeshPlaces, MovingPoint, MovingPoints, PointsOfBody
from heavylift.solver.bodies.ancf.mesh_contour import control_vectors
from heavylift.solver.scene.meshes import MeshBody

__all__ = ["pack_moving"]


def pack_moving(
    bodies: Sequence[MeshBody], table: Records[MeshPlaces], pattern: BlockPattern, lanes: int, per_node: int
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
    rows = records(PointsOfBody, len(bodies))
    points: list[tuple[int, int, int, int, int, bool, int, bool]] = []
    places: list[NDArray[np.int64]] = []
    factors: list[NDArray[np.float64]] = []
    entries = vectors = paths = compliance = controls = count = 0
    for row, body, line in zip(rows, bodies, table, strict=True):
        moving = int(line.moving_count)
        row.first_point, row.compliance, row.first_control = count, compliance, controls
        if moving == 0:
            continue
        entries_each = int(line.node_count) * per_node
        vectors_each = 3 * int(line.node_count + line.base_node_count) * lanes
        path_each = int(line.last_column - line.first_column)
        for _ in range(moving):
            points.append((entries, 0, vectors, paths, 0, False, -1, False))
            entries, vectors, paths = entries + entries_each, vectors + vectors_each, paths + path_each
        compliance += (3 * moving) ** 2
        count += moving
        made = control_vectors(body)
        node, vector = made.vectors // per_node, made.vectors % per_node
        places.append((line.first_node + node) * lanes + 3 * vector)
        factors.append(made.factors)
        controls += len(made.factors)
    nodes = int((table["node_count"] + table["base_node_count"]).sum())
    column_of = np.full(nodes, -1, dtype=np.int64)
    column_of[pattern.columns["node"]] = np.arange(len(pattern.columns))
    return MovingPoints(
        bodies=rows,
        points=records(MovingPoint, points),
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
