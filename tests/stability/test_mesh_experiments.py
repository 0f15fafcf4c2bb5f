"""Every experiment with frames and shells is right, or stops and names the part, or is warned of."""

from __future__ import annotations

import pytest
from mesh_experiments import MESH_EXPERIMENTS, random_meshes, random_scenes


def wrong(rows):
    """Rows that are not right, as text."""
    rows = list(rows)
    assert rows
    return [
        f"{row.setting}: {row.measure} {row.value:.2e}, limit {row.limit:.2e} {row.stopped}"
        for row in rows
        if not row.right
    ]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["steel pendulum", "change of scheme"])
def test_experiment(name):
    assert not wrong(MESH_EXPERIMENTS[name]())


@pytest.mark.slow
def test_free_flight():
    assert not wrong(MESH_EXPERIMENTS["free flight"]())


@pytest.mark.slow
def test_a_part_of_the_random_meshes_of_the_report():
    assert not wrong(random_meshes(0.2))


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["carried", "auto", "explicit"])
@pytest.mark.parametrize(
    ("what", "count", "steps"), [("frames", 15, 1000), pytest.param("shells", 5, 300, marks=pytest.mark.slow)]
)
def test_some_random_meshes(what, count, steps, scheme):
    """Others than those of the report."""
    assert not wrong(random_scenes(what, scheme, range(1000, 1000 + count), steps))
