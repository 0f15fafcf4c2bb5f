"""Sparse rows, against dense ones."""

import numpy as np

from heavylift.numerics.sparse_rows import SparseRows


def test_parts_and_unit_rows_are_those_of_the_dense_matrix() -> None:
    random = np.random.default_rng(2)
    rows, columns, values = random.integers(0, 7, 30), random.integers(0, 9, 30), random.normal(size=30)
    values[:3] = 0.0
    rows[rows == 4] = 5  # one row is empty
    dense = np.zeros((7, 9))
    np.add.at(dense, (rows, columns), values)
    sparse = SparseRows(values, rows, columns, dense.shape)
    np.testing.assert_allclose(sparse.toarray(), dense, atol=1e-15)
    assert all(
        np.all(np.diff(sparse.indices[a:b]) > 0)
        for a, b in zip(sparse.indptr, sparse.indptr[1:], strict=False)
    )
    chosen = np.array([5, 0, 4]), np.array([8, 2, 3, 1])
    np.testing.assert_array_equal(sparse.part(*chosen).toarray(), sparse.toarray()[np.ix_(*chosen)])
    length = np.linalg.norm(dense, axis=1, keepdims=True)
    unit = sparse.unit_rows()
    np.testing.assert_allclose(
        unit.toarray(), dense / np.where(length == 0.0, 1.0, length), rtol=1e-14, atol=1e-15
    )
    assert np.all(unit.data != 0.0)
    assert SparseRows(values[:0], rows[:0], columns[:0], (3, 0)).toarray().shape == (3, 0)
