"""The reduced body as a data structure."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.modal.invariants import shape_integrals
from heavylift.modal.reduced import ReducedBody
from heavylift.numerics.outcome import InputError


@pytest.fixture
def body(brick_beam):
    n = brick_beam.node_count
    shapes = np.random.default_rng(9).standard_normal((2, n, 3))
    return ReducedBody(
        nodes=brick_beam.nodes,
        eigenvalues=np.array([(2 * np.pi * 3.0) ** 2, (2 * np.pi * 8.0) ** 2]),
        mode_shapes=shapes,
        integrals=shape_integrals(brick_beam.nodes, shapes, brick_beam.mass),
        mean_axis=False,
        labels=("a", "b"),
        residuals=np.zeros(2),
        orthogonality=0.0,
    )


def test_frequencies_and_displacements(body):
    np.testing.assert_allclose(body.frequencies, [3.0, 8.0], rtol=1e-14)
    expected = 0.5 * body.mode_shapes[0] - 2.0 * body.mode_shapes[1]
    np.testing.assert_allclose(body.displacement([0.5, -2.0]), expected, atol=1e-14)


def test_bad_arguments_are_named(body):
    with pytest.raises(InputError, match=r"modal coordinates of shape \(3,\)"):
        body.displacement(np.zeros(3))


@pytest.mark.parametrize(
    ("key", "value"), [("eigenvalues", np.zeros(3)), ("labels", ("a",)), ("mode_shapes", np.zeros((2, 5, 3)))]
)
def test_fields_must_fit(body, key, value):
    fields = {name: getattr(body, name) for name in body.__dataclass_fields__} | {key: value}
    with pytest.raises(InputError, match="reduced body"):
        ReducedBody(**fields)


def test_residuals_count_for_eigenmodes_only(body):
    fields = {name: getattr(body, name) for name in body.__dataclass_fields__}
    mixed = ReducedBody(**fields | {"residuals": np.array([3e-9, 0.8])})
    assert mixed.eigenmode_mask.tolist() == [True, False]
    none = ReducedBody(**fields | {"residuals": np.array([0.02, np.nan])})
    assert none.eigenmode_mask.tolist() == [False, False]
