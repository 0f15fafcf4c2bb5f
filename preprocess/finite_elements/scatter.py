"""Element matrices into sparse global matrices, block by block and in bounded memory.

The pattern of node pairs is found once; element matrices are then added chunk by chunk straight into the
value array of the result. A list of 900 triplets an element (10 nodes) would take several times the memory
of the matrix.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

__all__ = ["BlockMatrix", "NodePattern", "ScalarMatrix"]


class NodePattern:
    """Which pairs of nodes share an element.

    Parameters
    ----------
    elements
        Node indices, shape (ne, nodes per element).
    node_count
        Number of nodes n.

    Attributes
    ----------
    indptr, indices
        Compressed rows of the symmetric pattern, n rows, sorted.
    slots
        Position in `indices` of every node pair of every element, shape (ne, nodes per element squared).
    """

    def __init__(self, elements: NDArray[np.int64], node_count: int) -> None:
        keys = (elements[:, :, None] * node_count + elements[:, None, :]).reshape(len(elements), -1)
        pairs, slots = np.unique(keys, return_inverse=True)
        self.node_count = node_count
        # 32-bit indices: half the memory, and what the sparse solvers take
        self.slots = slots.reshape(keys.shape).astype(np.int32)
        self.indices = (pairs % node_count).astype(np.int32)
        counts = np.bincount(pairs // node_count, minlength=node_count)
        self.indptr = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)


class BlockMatrix:
    """A (3n, 3n) matrix under assembly, made of 3 x 3 blocks on a `NodePattern`."""

    def __init__(self, pattern: NodePattern) -> None:
        self.pattern = pattern
        # one contiguous array a component, because np.add.at is fast on those only
        self._values = np.zeros((3, 3, len(pattern.indices)))

    def add(self, start: int, matrices: NDArray[np.float64]) -> None:
        """Add element matrices (m, 3 nodes, 3 nodes), node-major, of elements start, start + 1, ..."""
        m, size, _ = matrices.shape
        nn = size // 3
        slots = self.pattern.slots[start : start + m].ravel()
        blocks = matrices.reshape(m, nn, 3, nn, 3)
        for a in range(3):
            for b in range(3):
                np.add.at(self._values[a, b], slots, blocks[:, :, a, :, b].ravel())

    def tocsr(self) -> csr_array:
        """Return the matrix, node-major x, y, z."""
        from scipy.sparse import bsr_array

        p = self.pattern
        size = 3 * p.node_count
        data = np.ascontiguousarray(self._values.transpose(2, 0, 1))
        matrix = bsr_array((data, p.indices, p.indptr), shape=(size, size)).tocsr()
        matrix.sort_indices()
        return matrix


class ScalarMatrix:
    """An (n, n) matrix under assembly on a `NodePattern`."""

    def __init__(self, pattern: NodePattern) -> None:
        self.pattern = pattern
        self._values = np.zeros(len(pattern.indices))

    def add(self, start: int, matrices: NDArray[np.float64]) -> None:
        """Add the element matrices (m, nodes, nodes) of elements start, start + 1, ..."""
        slots = self.pattern.slots[start : start + len(matrices)].ravel()
        np.add.at(self._values, slots, matrices.ravel())

    def tocsr(self) -> csr_array:
        """Return the matrix."""
        from scipy.sparse import csr_array

        p = self.pattern
        return csr_array((self._values, p.indices, p.indptr), shape=(p.node_count, p.node_count))
