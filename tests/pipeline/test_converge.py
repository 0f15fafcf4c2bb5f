"""Observed orders of errors whose order is known."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.pipeline.converge import observed_order


@pytest.mark.parametrize("order", [1.0, 2.0, 4.0])
def test_a_power_law_has_its_order(order):
    h = [0.8, 0.4, 0.2, 0.1]
    found, used = observed_order(h, [3.0 * x**order for x in h])
    assert found == pytest.approx(order, rel=1e-12)
    assert used == (0, 1, 2, 3)


def test_coarse_rows_and_rounding_are_left_out():
    h = [10.0, 1.0, 0.5, 0.25, 0.125, 0.0625]
    found, used = observed_order(h, [3e-2, 1e-2, 2.5e-3, 6.25e-4, 5e-4, 6e-4])
    assert found == pytest.approx(2.0, rel=1e-12)
    assert used == (1, 2, 3)


def test_a_growing_parameter_counts_inversely():
    count = [10, 20, 40]
    found, _ = observed_order(count, [x**-3.0 for x in count])
    assert found == pytest.approx(3.0)


@pytest.mark.parametrize("errors", [[1.0, 1.0], [1.0, 2.0, 3.0], [0.0, 0.0], [np.nan, 1.0]])
def test_errors_that_do_not_fall_have_no_order(errors):
    assert observed_order(list(range(1, len(errors) + 1))[::-1], errors) == (None, ())
