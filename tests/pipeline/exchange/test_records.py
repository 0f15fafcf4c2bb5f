"""Arrays and records as maps, and a linearisation that comes from another process."""

from __future__ import annotations

import doctest

import numpy as np
import pytest

import heavylift as hl
from heavylift.pipeline.exchange import records
from heavylift.pipeline.exchange.records import as_map, of_map
from tests.pipeline.exchange.test_driven import CASE


def test_examples():
    assert doctest.testmod(records).failed == 0


@pytest.mark.parametrize(
    "array",
    [
        np.zeros((0, 3)),
        np.array(2.5),
        np.arange(6.0).reshape(2, 3).T,
        np.array([[1.0 + 2.0j, -0.0]]),
        np.array([np.nan]),
    ],
)
def test_arrays_keep_shape_type_and_bits(array):
    found = of_map(as_map(array))
    assert found.shape == array.shape
    assert found.dtype == array.dtype
    assert found.tobytes() == array.tobytes()
    found += 1.0  # it is nobody else's


def test_a_linearisation_comes_whole():
    pytest.importorskip("msgpack")
    outputs = ["load.position", "fall.tension"]
    here = hl.Simulation(CASE)
    own = here.linearise(outputs=outputs)
    with hl.open_child(CASE) as there:
        found = there.linearise(outputs=outputs)
        for name in ("A", "B", "C", "D", "eigenvalues", "vectors"):
            assert getattr(found, name).tobytes() == getattr(own, name).tobytes(), name
        assert found.states == own.states
        assert found.table() == own.table()
        assert there.time == 0.0
        with pytest.raises(hl.InputError, match="nothing"):
            there.linearise(outputs=["nothing.at_all"])
