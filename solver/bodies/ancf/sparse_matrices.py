"""Matrices of all meshes of a kind over their free coordinates, as scipy knows them: for work before time starts."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.bodies.ancf.kind import FRAME_PAIRS, SHELL_PAIRS, Meshes

__all__ = ["MeshMatrices", "mesh_matrices"]

DEPENDENT = 1e-12
"""Eigenvalue, relative to the largest, of bases that are held or depend on others."""

KEPT = 8
_FOUND: dict[int, tuple[NDArray[np.float64], MeshMatrices]] = {}


def mesh_matrices(kind: Meshes) -> MeshMatrices:
    """Matrices of a kind, made once."""
    key = id(kind.constants)
    if key not in _FOUND or _FOUND[key][0] is not kind.constants:
        while len(_FOUND) >= KEPT:
            _FOUND.pop(next(iter(_FOUND)))
        _FOUND[key] = (kind.constants, MeshMatrices(kind))
    return _FOUND[key][1]


class MeshMatrices:
    """Free coordinates and the constant matrices over them.

    Parameters
    ----------
    kind
        Frames or shells.

    Attributes
    ----------
    places
        Of the free coordinates in a nodal vector.
    vector, axis
        Of each: number of the nodal vector, 0 for positions; axis of the body.
    body
        Of each: row of `table`.
    mass, bending
        Sparse by columns.
    bases
        J: bases by free coordinates, sparse by rows, shape (3 bases, places).
    dofs
        First velocity of each base in the workspace.
    """

    def __init__(self, kind: Meshes) -> None:
        self.lanes, self.rows = len(kind.shape[1]), len(kind.shape[0])
        self.vectors = self.rows // 3
        self.nodes = len(kind.ends)
        self.pairs = FRAME_PAIRS if self.nodes == 2 else SHELL_PAIRS
        self._size = kind.position.shape[0]
        own = []
        for line in kind.table:
            nodes = np.arange(line.first_node, line.first_node + line.node_count)
            own.append((nodes[:, None] * self.lanes + np.arange(self.rows)).ravel())
        all_places = np.concatenate(own)
        body = np.repeat(np.arange(len(own)), [len(part) for part in own])
        free = kind.free[all_places] != 0.0
        self.places, self.body = all_places[free], body[free]
        self.all_places = all_places
        slot = self.places % self.lanes
        self.vector, self.axis = slot // 3, slot % 3
        self._number = np.full(self._size, -1)
        self._number[self.places] = np.arange(len(self.places))
        self.mass, self.bending = self._constant(kind, 0), self._constant(kind, 1)
        self._bending_full = self._full_bending(kind)
        self.bases, self.dofs = self._bases(kind)
        self._pattern = self._blocks(kind)

    def _vector_places(self, kind: Meshes) -> NDArray[np.int64]:
        """Places of the nodal vectors of each element, shape (elements, nodes vectors)."""
        nodes = kind.elements["nodes"][:, : self.nodes]
        return (nodes[:, :, None] + 3 * np.arange(self.vectors)).reshape(len(nodes), -1)

    def _scalar(
        self, kind: Meshes, which: int
    ) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
        """Mass (0) or bending (1) matrices of the elements over places of vectors."""
        places = self._vector_places(kind)
        count = places.shape[1]
        begin = kind.elements["data"] + which * count * count
        values = kind.constants[begin[:, None] + np.arange(count * count)]
        row, column = np.repeat(places, count, axis=1), np.tile(places, (1, count))
        return row.ravel(), column.ravel(), values.ravel()

    def _constant(self, kind: Meshes, which: int) -> Any:
        """A matrix of the elements times the unit matrix, over free coordinates."""
        from scipy.sparse import csc_array

        row, column, value = self._scalar(kind, which)
        parts = [(self._number[row + k], self._number[column + k], value) for k in range(3)]
        row, column, value = (np.concatenate(part) for part in zip(*parts, strict=True))
        kept = (row >= 0) & (column >= 0)
        shape = (len(self.places), len(self.places))
        return csc_array((value[kept], (row[kept], column[kept])), shape=shape)

    def _full_bending(self, kind: Meshes) -> Any:
        """Bending matrix from all coordinates to the free ones."""
        from scipy.sparse import csr_array

        row, column, value = self._scalar(kind, 1)
        parts = [(self._number[row + k], column + k, value) for k in range(3)]
        row, column, value = (np.concatenate(part) for part in zip(*parts, strict=True))
        kept = row >= 0
        return csr_array((value[kept], (row[kept], column[kept])), shape=(len(self.places), self._size))

    def bending_force(self, q: NDArray[np.float64]) -> NDArray[np.float64]:
        """``K_b q`` of some coordinates, over the free ones."""
        return self._bending_full @ q

    def _bases(self, kind: Meshes) -> tuple[Any, NDArray[np.int64]]:
        from scipy.sparse import csr_array

        dofs = np.zeros(len(kind.bases), dtype=np.int64)
        for line in kind.table:
            own = np.arange(line.base_count)
            dofs[line.first_base + own] = line.dof + 3 * own
        fixed = kind.bases["element"] >= 0  # the others are points that contacts move
        bases, dofs = kind.bases[fixed], dofs[fixed]
        count = len(bases)
        places = self._vector_places(kind)[bases["element"]]
        width = places.shape[1]
        shape = kind.constants[bases["shape_values"][:, None] + np.arange(width)]
        parts = []
        for k in range(3):
            row = np.repeat(3 * np.arange(count) + k, width)
            parts.append((row, self._number[places + k].ravel(), shape.ravel()))
        row, column, value = (np.concatenate(part) for part in zip(*parts, strict=True))
        kept = (column >= 0) & (value != 0.0)
        found = csr_array((value[kept], (row[kept], column[kept])), shape=(3 * count, len(self.places)))
        return found, dofs

    def _blocks(self, kind: Meshes) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
        """Places in a set of blocks, row indices and column pointers of a sparse matrix with the same entries."""
        from scipy.sparse import csc_array

        place, swap, first, second = [], [], [], []
        for p, (i, j) in enumerate(self.pairs):
            place.append(kind.elements["blocks"][:, p, 0])
            swap.append(kind.elements["blocks"][:, p, 1])
            first.append(kind.elements["nodes"][:, i])
            second.append(kind.elements["nodes"][:, j])
        places, unique = np.unique(np.concatenate(place), return_index=True)
        swaps, a, b = (np.concatenate(part)[unique] for part in (swap, first, second))
        ci, cj = (c.ravel() for c in np.meshgrid(np.arange(self.rows), np.arange(self.rows), indexing="ij"))
        row, column = a[:, None] + ci, b[:, None] + cj
        inside = np.where(swaps[:, None] == 0, cj * self.lanes + ci, ci * self.lanes + cj)
        source = places[:, None] + inside
        off = a != b
        rows = np.concatenate([row.ravel(), column[off].ravel()])
        columns = np.concatenate([column.ravel(), row[off].ravel()])
        sources = np.concatenate([source.ravel(), source[off].ravel()])
        rows, columns = self._number[rows], self._number[columns]
        kept = (rows >= 0) & (columns >= 0)
        shape = (len(self.places), len(self.places))
        order = csc_array((np.arange(1, kept.sum() + 1), (rows[kept], columns[kept])), shape=shape)
        order.sort_indices()
        sources = sources[kept][order.data - 1]
        order.data[:] = np.arange(1, len(sources) + 1)
        bending = self.bending.tocoo()
        self._bending_data = np.zeros(len(sources))
        self._bending_data[order[bending.coords] - 1] = bending.data
        return sources, order.indices, order.indptr

    def number(self, places: NDArray[np.int64]) -> NDArray[np.int64]:
        """Numbers of the free coordinates at some places, -1 for others."""
        return self._number[places]

    def load_bodies(self, kind: Meshes) -> NDArray[np.int64]:
        """Row of `table` of each load."""
        return np.repeat(np.arange(len(kind.table)), kind.table["load_count"])

    def base_changes(self) -> NDArray[np.float64]:
        """``M^-1 J^T (J M^-1 J^T)^-1``: smallest changes of the free coordinates by component of a base.

        Bases that are held, or that depend on others, move as far as they can.
        """
        from scipy.sparse.linalg import splu

        J = self.bases
        if not J.shape[0] or not J.shape[1]:
            return np.zeros((J.shape[1], J.shape[0]))
        X = splu(self.mass.tocsc(), permc_spec="MMD_AT_PLUS_A").solve(J.T.toarray())
        W = J @ X
        # bases are positions and slopes: unit diagonals make their eigenvalues comparable
        root = np.sqrt(np.maximum(np.diag(W), 1e-300))
        values, vectors = np.linalg.eigh(W / root[:, None] / root[None, :])
        good = values > DEPENDENT * values.max(initial=0.0)
        inverse = (vectors[:, good] / values[good]) @ vectors[:, good].T
        return X @ (inverse / root[:, None] / root[None, :])

    def stiffness(self, blocks: NDArray[np.float64]) -> Any:
        """A set of blocks and the bending matrix as one sparse matrix by columns."""
        from scipy.sparse import csc_array

        sources, indices, pointers = self._pattern
        shape = (len(self.places), len(self.places))
        return csc_array((blocks[sources] + self._bending_data, indices, pointers), shape=shape)
