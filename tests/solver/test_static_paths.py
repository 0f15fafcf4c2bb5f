"""Load steps, paths over limit points, settling and relaxation, against closed solutions of trusses."""

from __future__ import annotations

import numpy as np
import pytest
from trusses import Truss, apex_load, shallow_truss

from heavylift.solver.statics.arc_length import trace_path
from heavylift.solver.statics.load_steps import follow_load
from heavylift.solver.statics.newton import Progress, correct
from heavylift.solver.statics.relaxation import relax
from heavylift.solver.statics.settling import settle

HEIGHT = 0.2
LIMIT = apex_load(HEIGHT / np.sqrt(3.0))  # where dP/dz = EA (H^2 - 3 z^2)/L^3 vanishes


def start(rows: int = 0) -> Progress:
    return Progress(np.zeros(rows))


def chain(links: bool, upright: bool = False) -> Truss:
    """Six members of 1 m in a row from the origin, stiff bars or rigid links, 10 N downwards on each node."""
    n = 6
    along = np.arange(n + 1.0)
    nodes = np.column_stack([np.zeros(n + 1), along] if upright else [along, np.zeros(n + 1)])
    pairs = [[i, i + 1] for i in range(n)]
    load = np.tile([0.0, -10.0], n)
    return Truss(
        nodes, [] if links else pairs, 1e8, np.arange(2, 2 * n + 2), load, links=pairs if links else []
    )


def test_load_steps_reach_the_closed_solution_below_the_limit_load() -> None:
    for part in (0.2, 0.9, 0.999):
        truss, progress = shallow_truss(part * LIMIT), start()
        assert follow_load(truss, progress)
        z = truss.x[2, 1]
        assert z > HEIGHT / np.sqrt(3.0)  # not beyond the limit point
        assert apex_load(z) == pytest.approx(part * LIMIT, rel=1e-9)


def test_load_steps_stop_at_the_limit_load() -> None:
    truss, progress = shallow_truss(2.0 * LIMIT), start()
    assert not follow_load(truss, progress)
    assert 0.49 < progress.factor <= 0.5 * (1.0 + 1e-9)


def test_the_path_goes_over_both_limit_points_and_ends_on_the_stable_branch_beyond() -> None:
    truss, progress = shallow_truss(1.5 * LIMIT), start()
    path = trace_path(truss, progress, longest=0.05, observe=lambda: truss.x[2])
    assert path.reached
    assert progress.factor == 1.0
    z = np.array(path.observed)[:, 1]
    assert apex_load(z) == pytest.approx(1.5 * LIMIT * np.array(path.factors), abs=1e-7 * LIMIT)
    factors = 1.5 * np.array(path.factors)
    assert factors.max() == 1.5
    top = np.flatnonzero((factors[1:-1] > factors[:-2]) & (factors[1:-1] > factors[2:]))[0] + 1
    assert factors[top] == pytest.approx(1.0, abs=0.01)
    assert factors.min() == pytest.approx(-1.0, abs=0.01)
    # unstable between the limit points, where dP/dz changes its sign; the apex stays on the axis
    between = np.abs(z) < HEIGHT / np.sqrt(3.0)
    assert [count > 0 for count in path.unstable] == between.tolist()
    assert np.abs(np.array(path.observed)[:, 0]).max() < 1e-9


def test_settling_finds_the_stable_positions() -> None:
    below, above = shallow_truss(0.99 * LIMIT), shallow_truss(1.2 * LIMIT)
    assert settle(below, start())
    assert settle(above, start())
    assert below.x[2, 1] > HEIGHT / np.sqrt(3.0)
    assert above.x[2, 1] < -HEIGHT
    assert apex_load(below.x[2, 1]) == pytest.approx(0.99 * LIMIT, rel=1e-9)
    assert apex_load(above.x[2, 1]) == pytest.approx(1.2 * LIMIT, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("links", [False, True])
@pytest.mark.parametrize("upright", [False, True])
def test_a_chain_settles_hanging(links: bool, upright: bool) -> None:
    truss = chain(links, upright)
    progress = start(len(truss.links))
    assert settle(truss, progress)
    assert np.abs(truss.x[:, 0]).max() < 1e-7
    # each member carries what hangs below it: 60, 50, ... N; strains e of bars follow from EA e lambda = N
    weights = 10.0 * np.arange(6, 0, -1)
    if links:
        assert progress.multipliers == pytest.approx(-weights, rel=1e-7)
        assert truss.x[-1, 1] == pytest.approx(-6.0, abs=1e-9)
    else:
        assert truss.x[-1, 1] + 6.0 == pytest.approx(-np.sum(weights) / 1e8, rel=1e-5)


def test_a_column_falls_over_beyond_its_buckling_load() -> None:
    # two links of 1 m in a line, held at their joint by a spring k across: P = k l / 2 buckles them, and nothing
    # stops them then: k l^2 sin^2(t) / 2 - 2 P l (1 - cos t) falls all the way to where they hang
    stiffness = 1e3
    k = 2.0 * stiffness / 10.0  # two bars of 10 m across
    nodes = [[0.0, 0.0], [0.0, 1.0], [0.0, 2.0], [-10.0, 1.0], [10.0, 1.0]]
    for part, top in ((0.95, 2.0), (1.05, -2.0)):
        load = part * k / 2.0
        truss = Truss(
            nodes, [[3, 1], [1, 4]], stiffness, [2, 3, 5], [0.0, 0.0, -load], links=[[0, 1], [1, 2]]
        )
        progress = start(2)
        assert settle(truss, progress)
        assert truss.x[2, 1] == pytest.approx(top, abs=1e-9)
        assert progress.multipliers[1] == pytest.approx(load * np.sign(top))


def test_newton_converges_quadratically() -> None:
    truss = shallow_truss(0.5 * LIMIT)
    residuals = []
    for patience in range(1, 8):
        truss.x[2] = 0.0, HEIGHT
        progress = start()
        correct(truss, progress, 1.0, patience=patience)
        residuals.append(progress.residual)
    logs = -np.log10([r for r in residuals if r > 1e-14])
    assert np.all(logs[2:] > 1.7 * logs[1:-1])


def test_relaxation_comes_to_rest_where_the_energy_allows() -> None:
    # A load that acts at once carries the apex over the hill from 0.77 of the limit load on: there the energy
    # (1 - s^2)^2 = c 8/(3 sqrt 3) (1 - s), s = z/H, of the start suffices
    truss, progress = shallow_truss(0.5 * LIMIT), start()
    motion = relax(truss, progress)
    assert motion.at_rest
    assert motion.balance < 0.06
    assert truss.x[2, 1] > HEIGHT / np.sqrt(3.0)
    assert apex_load(truss.x[2, 1]) == pytest.approx(0.5 * LIMIT, rel=1e-9)
    # what was dissipated is at most what the potential lost
    lost = 0.5 * LIMIT * (HEIGHT - truss.x[2, 1]) - truss.energy()
    assert 0.0 < motion.dissipated < 1.2 * lost + 1e-9 or motion.stops > 1


@pytest.mark.slow
@pytest.mark.parametrize("links", [False, True])
def test_a_chain_relaxes_hanging(links: bool) -> None:
    truss = chain(links)
    progress = start(len(truss.links))
    motion = relax(truss, progress)
    assert motion.at_rest
    assert truss.x[-1] == pytest.approx([0.0, -6.0], abs=1e-5)
    if links:
        assert progress.multipliers == pytest.approx(-10.0 * np.arange(6, 0, -1), rel=1e-6)
