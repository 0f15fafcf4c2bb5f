"""Which rows of closed loops to keep, so that all others follow from them.

A planar four-bar of three-dimensional hinges has three rows too many. Solved with all of them, the system has to be
softened, and much: in positions that are closed to the error of a step only, rows that follow from others contradict
them a little, and would lock the mechanism. A choice of independent rows needs a hundredth of that.

The choice is made in a nearby position, since mechanisms often start in a singular one, in which more rows depend on
each other than elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.start.diagnosis import (
    BodyGraph,
    ScaledRows,
    core_part,
    joint_graph,
    move_nearby,
    rank_of,
    scale_rows,
)
from heavylift.solver.start.rows import StartRows

__all__ = ["independent_rows"]

LARGEST = 800
"""Free velocities up to which rows are chosen, by dense matrices: about a second."""


def independent_rows(rows: StartRows, first: Sequence[int] = ()) -> NDArray[np.bool_] | None:
    """Rows to keep, the best conditioned ones first; None where no choice is known to hold.

    Parameters
    ----------
    rows
        The scene in a closed position, in which all rows are rigid; it is displaced and put back.
    first
        Blocks whose rows are all kept, being independent of each other.

    Returns
    -------
    ndarray
        Shape (rows,), for the rows in the order of `rows`. None with frames or shells, whose velocities are not all in
        the rows, and with loops that are too large, do not close nearby, or move to first order only.
    """
    if rows.mesh_bodies or not rows.rigid.all():
        return None
    rows.fill()
    scaled, lengths = scale_rows(rows)
    graph, _ = joint_graph(rows, scaled)
    if not graph.cores:
        return _kept(scaled, graph, first)
    ranks = [rank_of(*core_part(scaled, core), scaled.tolerance) for core in graph.cores]
    near = move_nearby(rows, scaled, lengths, graph, ranks, LARGEST)
    if (
        near is None
        or not near.closed
        or near.stuck
        or any(there < here for there, here in zip(near.ranks, ranks, strict=True))
    ):
        return None
    return _kept(near.scaled, graph, first)


def _kept(scaled: ScaledRows, graph: BodyGraph, first: Sequence[int]) -> NDArray[np.bool_]:
    """Rows that are independent in a position, each core and each bridge by itself."""
    from scipy.linalg import qr

    kept = np.zeros(scaled.matrix.shape[0], dtype=bool)
    parts: list[tuple[Sequence[int], Sequence[int]]] = [
        (bridge.blocks, bridge.bodies[1:]) for bridge in graph.bridges
    ]
    parts += [([block for pair in core.pairs for block in pair.blocks], core.bodies) for core in graph.cores]
    for blocks, bodies in parts:
        own, dense = scaled.rows(blocks), scaled.dense(blocks, bodies)
        early = np.isin(scaled.block[own], list(first))
        if early.any():
            kept[own[early]] = True
            spanned = np.linalg.qr(dense[early].T)[0]
            own, dense = own[~early], dense[~early] - dense[~early] @ spanned @ spanned.T
        if not own.size:
            continue
        _, R, order = qr(dense.T, mode="economic", pivoting=True)
        kept[own[order[: np.count_nonzero(np.abs(np.diag(R)) > scaled.tolerance)]]] = True
    return kept
