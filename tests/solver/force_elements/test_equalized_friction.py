"""Lines over sheaves with an efficiency: all states by trial, closed forms, pulleys of one gram, energy with loss."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest
from law_scenes import body, eye, scene

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.force_elements.equalized import SharedLines
from heavylift.solver.force_elements.equalized_friction import find_line_forces
from heavylift.solver.force_elements.sheave_states import make_search
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.simulation import Simulation


def by_trial(c, d, eta):
    """Forces of lines of all states of the 2 n - 1 sheaves that contradict nothing, by dense solves.

    Unknown are the tensions T of 2 n parts and the flows w of n - 1 fixed sheaves. Of the moving sheave i the flow is
    ``(w_i-1 + w_i)/2``, and ``(w_i-1 - w_i)/2 = d_i - c_i (T_2i-1 + T_2i)``.
    """
    n = len(c)
    m, size = 2 * n - 1, 3 * n - 1
    flow = np.zeros((m, size))  # of all sheaves by the unknowns
    for i in range(n - 1):
        flow[2 * i + 1, 2 * n + i] = 1.0
        flow[[2 * i, 2 * i + 2], 2 * n + i] += 0.5
    balance, right = np.zeros((n, size)), np.array(d)
    for i in range(n):
        balance[i, [2 * i, 2 * i + 1]] = c[i]
        if i > 0:
            balance[i, 2 * n + i - 1] += 0.5
        if i < n - 1:
            balance[i, 2 * n + i] -= 0.5
    found = []
    for states in itertools.product((-1, 0, 1), repeat=m):
        A, b = [*balance], [*right]
        for j, state in enumerate(states):
            row = flow[j].copy()
            if state:
                row[:] = 0.0
                row[j], row[j + 1] = -(eta**-state), 1.0
            A.append(row)
            b.append(0.0)
        x, *_ = np.linalg.lstsq(np.array(A), np.array(b), rcond=None)
        if np.abs(np.array(A) @ x - b).max() > 1e-9:
            continue
        # tensions that stick may be any within their bounds: what is not unique is chosen by a linear program
        from scipy.optimize import linprog

        T, w = np.eye(size)[: 2 * n], flow
        upper = []
        for j, state in enumerate(states):
            if state:
                upper.append(-state * w[j])
            else:
                upper += [T[j + 1] - T[j] / eta, T[j] - T[j + 1] / eta]
        free = [(0, None)] * (2 * n) + [(None, None)] * (n - 1)
        solved = linprog(
            np.zeros(size), np.array(upper), np.full(len(upper), 1e-9), np.array(A), np.array(b), free
        )
        if solved.status == 0:
            found.append(solved.x[0 : 2 * n : 2] + solved.x[1 : 2 * n : 2])
    return found


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("n", [2, 3])
def test_forces_are_those_of_all_states_tried(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    eta = rng.uniform(0.6, 0.99)
    c = rng.uniform(0.5, 2.0, n)
    d = c * rng.uniform(0.5, 1.5, n)
    search, force = make_search(2 * n - 1, 1), np.zeros(n)
    search.loss[:] = 1.0 - eta
    # sheaves that stick held what equal forces leave
    assert find_line_forces(search, n, c, d, force, np.zeros((2 * n - 1, 2 * n))) == 1
    found = by_trial(c, d, eta)
    assert found
    assert min(np.abs(force / other - 1.0).max() for other in found) < 1e-4


def hung(efficiency: float, name: str = "load", y: float = 0.0, **more):
    """A load that turns and swings on three lines, and what it hangs on."""
    stops = [(eye(GROUND, (x, y, 0.0)), eye(name, (x, 0.0, 1.0))) for x in (-1.5, 0.0, 1.5)]
    lines = SharedLines(
        name=f"{name}_lines",
        path=tuple(stop for pair in stops for stop in pair),
        lengths=np.array([9.0, 9.1, 8.9]),
        depth=2.0,
        up=1.5,
        down=3.0,
        axial_stiffness=1e8,
        rope_length=15.0,
        line_stiffness=1e8,
        damping=1e4,
        efficiency=efficiency,
        **more,
    )
    return body(
        name, 1e4, (0.1, y, -12.0), (0.2, 0.1, 0.0), angular_velocity=np.array([0.0, 0.3, 0.1])
    ), lines


def test_a_run_goes_on_where_it_was() -> None:
    """A checkpoint has all that friction remembers: the same bits."""
    load, lines = hung(0.95)
    first, second = (Simulation(scene([load], ropes=[lines]), 5e-3, "dele2") for _ in range(2))
    first.advance(150)
    second.restore(first.state())
    np.testing.assert_array_equal(first.advance(100)[1], second.advance(100)[1])
    assert first.outcome is Outcome.COMPLETED


def test_equalizers_of_one_scene_do_not_know_each_other() -> None:
    """Two that rub and one that does not, each as it is alone."""
    made = [hung(0.95), hung(1.0, "other", 20.0), hung(0.9, "third", 40.0)]
    together = Simulation(scene([m[0] for m in made], ropes=[m[1] for m in made]), 5e-3, "dele2")
    _, records = together.advance(200)
    for load, lines in made:
        alone = Simulation(scene([load], ropes=[lines]), 5e-3, "dele2")
        _, own = alone.advance(200)
        columns = {channel.name: channel for channel in together.channels}
        for channel in alone.channels:
            if channel.name.startswith(load.name):
                first, width = columns[channel.name].column, len(channel.components)
                np.testing.assert_allclose(
                    records[:, first : first + width],
                    own[:, channel.column : channel.column + width],
                    rtol=1e-8,
                    atol=1e-8,
                )
    F = np.array([records[-1, columns["load_lines.segment_tension"].column + k] for k in range(3)])
    assert np.ptp(F) > 0.0


def test_places_of_lines_have_no_efficiency_of_their_own() -> None:
    load, lines = hung(0.95)
    path = (dataclasses.replace(lines.path[0], efficiency=0.9), *lines.path[1:])
    with pytest.raises(InputError, match=r"0\.9 of a place of lines"):
        Simulation(scene([load], ropes=[dataclasses.replace(lines, path=path)]), 5e-3, "dele2")
