"""Rows of loops that are left out because they follow from others, and that come back where they do not."""

from __future__ import annotations

import numpy as np
import pytest
from rods import channel, parallelogram

from heavylift.solver.layout import pack_scene
from heavylift.solver.simulation import Simulation
from heavylift.solver.start.independent_rows import independent_rows
from heavylift.solver.start.rows import StartRows


@pytest.mark.parametrize("level", [False, True])
@pytest.mark.parametrize("loops", [1, 3])
def test_planar_loops_keep_all_rows_but_three_each(loops: int, level: bool) -> None:
    """``6 n - 1`` rows are independent in a mechanism of one degree of freedom, also where its start is singular."""
    layout = pack_scene(parallelogram(loops, level=level), "accurate", 0.0)
    rows = StartRows(layout)
    kept = independent_rows(rows)
    assert kept is not None
    assert len(kept) == 5 * (3 * loops + 1)
    assert kept.sum() == 6 * (2 * loops + 1) - 1
    sigma = np.linalg.svd(rows.jacobian().toarray()[kept], compute_uv=False)
    if not level:
        assert sigma[-1] > 0.05


def test_a_row_that_was_left_out_wrongly_comes_back() -> None:
    """Without a row that it needs a loop would open by metres; with all of them its motion is that of the right one."""
    found = []
    for wrong in (False, True):
        simulation = Simulation(parallelogram(20), 0.1, "accurate", tolerance=1e-5)
        simulation.warm_up()
        integration = simulation._layout.systems[-1]
        assert integration.progress.chosen
        if wrong:
            rows = StartRows(simulation._layout)
            kept = np.ones(len(rows.places), dtype=bool)
            kept[rows.block == 7] = False
            integration.keep_rows(rows.places, kept)
        _, records = simulation.advance(20)
        assert bool(integration.progress.chosen) is not wrong
        assert channel(simulation, records, "monitor.violation").max() < 1e-4
        found.append(channel(simulation, records, "tip.position"))
    assert np.abs(found[1] - found[0]).max() < 1e-3
