"""Nodes that follow others: rigid links, averages and ties as one matrix from the free degrees of freedom."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.structures.group_motion import mean_motion, rigid_motion

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.structures.structure import Structure

__all__ = ["constraint_matrix", "node_words"]


class _Rows:
    """Degrees of freedom that follow others, with the part that makes each do so."""

    def __init__(self, structure: Structure, size: int) -> None:
        self.structure, self.size = structure, size
        self.owner = np.full(size, -1, dtype=np.int64)
        self.owners: list[str] = []
        self.rows: list[NDArray[np.int64]] = []
        self.columns: list[NDArray[np.int64]] = []
        self.values: list[NDArray[np.float64]] = []

    def add(
        self,
        owner: str,
        rows: NDArray[np.int64],
        columns: NDArray[np.int64],
        values: NDArray[np.float64],
        nodes: NDArray[np.int64],
    ) -> None:
        """Let rows (m,) follow columns (m, k) with values (m, k); `nodes` (m,) are those of the rows."""
        twice = np.flatnonzero(self.owner[rows] >= 0)
        if twice.size:
            other = self.owners[self.owner[rows[twice[0]]]]
            raise InputError(
                f"{node_words(self.structure, nodes[twice[0]])} follows in two ways, by {other} and by {owner}",
                source=self.structure.name or "structure",
                key=owner,
                expected="a degree of freedom that follows once: another node of the two, or fewer components",
            )
        self.owner[rows] = len(self.owners)
        self.owners.append(owner)
        self.rows.append(np.repeat(rows, columns.shape[1]))
        self.columns.append(columns.ravel())
        self.values.append(values.ravel())


def node_words(structure: Structure, node: int) -> str:
    """A node as messages name it: its number in its file, and its place."""
    number = int(structure.numbers[node]) if structure.numbers.size else int(node) + 1
    x, y, z = structure.nodes[node]
    return f"node {number} at ({x:.6g}, {y:.6g}, {z:.6g}) m"


def constraint_matrix(
    structure: Structure, rotation_dofs: NDArray[np.int64], size: int
) -> tuple[csr_array, NDArray[np.int64]] | None:
    """All degrees of freedom from those that are free, sparse (N, free), and which these are; None if none follows.

    Parameters
    ----------
    structure
        With its links, averages and ties.
    rotation_dofs
        First of the three rotations of every node, -1 for none, shape (n,).
    size
        N.

    Raises
    ------
    InputError
        A degree of freedom that follows twice, or itself through others; a group whose rotation is not known.

    Notes
    -----
    Links may follow from links: what a row follows is replaced by what that follows in turn until all of it is free.
    """
    from scipy.sparse import csr_array

    rows = _Rows(structure, size)
    _add_links(rows, structure, rotation_dofs)
    _add_averages(rows, structure, rotation_dofs)
    _add_ties(rows, structure, rotation_dofs)
    if not rows.owners:
        return None
    free = np.flatnonzero(rows.owner < 0)
    i = np.concatenate([*rows.rows, free])
    j = np.concatenate([*rows.columns, free])
    v = np.concatenate([*rows.values, np.ones(len(free))])
    once = csr_array((v, (i, j)), shape=(size, size))
    once.eliminate_zeros()
    _refuse_loops(rows, once)
    found = once
    while (rows.owner[found.indices] >= 0).any():
        found = csr_array(found @ once)
    return csr_array(found[:, free]), free


def _add_links(rows: _Rows, structure: Structure, rotation_dofs: NDArray[np.int64]) -> None:
    """Rigid links: ``u_d = u + theta x r``, ``theta_d = theta``."""
    for count, link in enumerate(structure.links):
        owner = f"rigid link {link.name or count + 1}"
        dependent = np.asarray(link.dependent, dtype=np.int64)
        motion = rigid_motion(structure.nodes[dependent] - structure.nodes[link.node])
        turn = rotation_dofs[link.node]
        columns = 3 * link.node + np.arange(3)
        if turn >= 0:
            columns = np.concatenate([columns, turn + np.arange(3)])
        for axis in np.flatnonzero(link.components[:3]):
            rows.add(
                owner,
                3 * dependent + axis,
                np.tile(columns, (len(dependent), 1)),
                motion[:, axis, : len(columns)],
                dependent,
            )
        turning = dependent[rotation_dofs[dependent] >= 0]
        if turn >= 0:
            for axis in np.flatnonzero(link.components[3:]):
                rows.add(
                    owner,
                    rotation_dofs[turning] + axis,
                    np.full((len(turning), 1), turn + axis),
                    np.ones((len(turning), 1)),
                    turning,
                )


def _add_averages(rows: _Rows, structure: Structure, rotation_dofs: NDArray[np.int64]) -> None:
    """Averages: the motion of a node is the mean of that of others."""
    for count, average in enumerate(structure.averages):
        owner = f"average {average.name or count + 1}"
        nodes = np.asarray(average.nodes, dtype=np.int64)
        turning = rotation_dofs[nodes] >= 0
        if np.any(np.asarray(average.weights) <= 0.0):
            raise InputError(
                f"weight {np.min(average.weights):g}",
                source=structure.name or "structure",
                key=owner,
                expected="positive weights",
            )
        forces, moments = mean_motion(
            structure.nodes[average.node],
            structure.nodes[nodes],
            average.weights,
            turning,
            source=structure.name or "structure",
            key=owner,
        )
        columns = (3 * nodes[:, None] + np.arange(3)).ravel()
        turned = (rotation_dofs[nodes[turning]][:, None] + np.arange(3)).ravel()
        columns = np.concatenate([columns, turned])
        values = np.concatenate([forces.reshape(-1, 6), moments[turning].reshape(-1, 6)]).T
        first = rotation_dofs[average.node]
        targets = np.concatenate(
            [3 * average.node + np.arange(3), np.full(3, -1) if first < 0 else first + np.arange(3)]
        )
        chosen = np.flatnonzero(np.asarray(average.components) & (targets >= 0))
        rows.add(
            owner,
            targets[chosen],
            np.tile(columns, (len(chosen), 1)),
            values[chosen],
            np.full(len(chosen), average.node),
        )


def _add_ties(rows: _Rows, structure: Structure, rotation_dofs: NDArray[np.int64]) -> None:
    """Ties: equal displacements, and equal rotations where both nodes have some."""
    for count, tie in enumerate(structure.ties):
        both = rotation_dofs[tie.node] >= 0 and rotation_dofs[tie.dependent] >= 0
        chosen = np.flatnonzero(np.asarray(tie.components) & np.repeat([True, both], 3))
        first, then = (
            np.concatenate([3 * node + np.arange(3), rotation_dofs[node] + np.arange(3)])[chosen]
            for node in (tie.node, tie.dependent)
        )
        rows.add(
            f"tie {tie.name or count + 1}",
            then,
            first[:, None],
            np.ones((len(then), 1)),
            np.full(len(then), tie.dependent),
        )


def _refuse_loops(rows: _Rows, once: csr_array) -> None:
    """Refuse degrees of freedom that follow themselves through others."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    coo = once.tocoo()
    between = (rows.owner[coo.row] >= 0) & (rows.owner[coo.col] >= 0)
    i, j = coo.row[between], coo.col[between]
    graph = csr_array((np.ones(len(i)), (i, j)), shape=once.shape)
    _, label = connected_components(graph, directed=True, connection="strong")
    inner = label[i] == label[j]
    if inner.any():
        of_loop = np.unique(rows.owner[i[inner][label[i[inner]] == label[i[inner][0]]]])
        names = [rows.owners[k] for k in of_loop]
        raise InputError(
            f"nodes follow themselves through {' and '.join(names[:4])}"
            + (" and others" if len(names) > 4 else ""),
            source=rows.structure.name or "structure",
            key=names[0],
            expected="chains that end at nodes that are free",
        )
