"""Connected sets, against SciPy's."""

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from heavylift.numerics.joined import joined

CASES = {
    "nothing": (4, np.zeros((0, 2), dtype=np.int64)),
    "chain from its end": (2000, np.column_stack([np.arange(1999, 0, -1), np.arange(1998, -1, -1)])),
    "star about its highest": (500, np.column_stack([np.full(499, 499), np.arange(499)])),
    "zigzag": (600, np.column_stack([np.arange(300), np.r_[599:299:-1]])),
}


@pytest.mark.parametrize("name", [*CASES, "random"])
def test_sets_are_numbered_as_by_scipy(name: str) -> None:
    random = np.random.default_rng(3)
    few = [
        (count, random.integers(0, count, (pairs, 2))) for count, pairs in ((300, 90), (300, 160), (300, 500))
    ]
    for count, pairs in few if name == "random" else [CASES[name]]:
        graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
        np.testing.assert_array_equal(joined(count, pairs), connected_components(graph, directed=False)[1])
