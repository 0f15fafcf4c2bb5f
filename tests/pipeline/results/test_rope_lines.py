"""Points of a rope at a pulley that it does not touch lie on the straight line between its neighbours."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.pipeline.results.rope_lines import rope_tangents


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_rope_runs_straight_past_what_it_does_not_touch(sense: float) -> None:
    """At two times: the pulley out of the way, then 0.1 m in it, with tangents of ``d^2 - r^2``, squared."""
    ends = [np.array([[-10.0, 0, 0], [-10.0, 0, 0]]), np.array([[10.0, 0, 0], [10.0, 0, 0]])]
    centre = np.array([[1.0, 0, -0.8 * sense], [0.0, 0, -0.4 * sense]])
    axis = np.array([0.0, sense, 0.0])
    arrive, leave = rope_tangents([ends[0], centre, ends[1]], [0.0, 0.5, 0.0], [axis, axis, axis])
    np.testing.assert_allclose(arrive[1][0], [1.0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(leave[1][0], [1.0, 0, 0], atol=1e-12)
    length = np.sqrt(100.0 + 0.16 - 0.25)
    assert np.linalg.norm(arrive[1][1] - ends[0][1]) == pytest.approx(length, rel=1e-12)
    assert np.linalg.norm(arrive[1][1] - centre[1]) == pytest.approx(0.5, rel=1e-12)
    assert arrive[1][1][0] < 0.0 < leave[1][1][0]
