"""Sets of nodes that pairs join: the connected components of a graph."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["joined"]


def joined(count: int, pairs: ArrayLike) -> NDArray[np.int64]:
    """Number of the set of each node, in the order of the lowest nodes of the sets, shape (count,).

    Parameters
    ----------
    count
        Number of nodes.
    pairs
        Nodes of each pair, shape (n, 2).

    Notes
    -----
    Sets hang the roots of their neighbours below their own where these are higher, and nodes are hung to their roots,
    until no pair joins two sets: Y. Shiloach and U. Vishkin, "An O(log n) parallel connectivity algorithm", Journal of
    Algorithms 3, 1982. It is as `scipy.sparse.csgraph.connected_components` numbers them, whose import takes longer
    than most scenes to begin.

    Examples
    --------
    >>> joined(5, [(4, 0), (1, 3)])
    array([0, 1, 2, 1, 0])
    """
    root = np.arange(count, dtype=np.int64)
    a, b = np.asarray(pairs, dtype=np.int64).reshape(-1, 2).T
    while True:
        ends = root[a], root[b]
        apart = ends[0] != ends[1]
        if not apart.any():
            break
        low, high = np.minimum(*ends)[apart], np.maximum(*ends)[apart]
        np.minimum.at(root, high, low)
        a, b = a[apart], b[apart]
        above = root[root]
        while not np.array_equal(above, root):
            root, above = above, above[above]
    return np.unique(root, return_inverse=True)[1].reshape(-1).astype(np.int64)
