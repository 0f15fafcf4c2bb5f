"""Lines over sheaves with an efficiency: all states by trial, closed forms, pulleys of one gram, energy with loss."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from heavylift.solver.laws.equalized_friction import find_line_forces
from heavylift.solver.laws.sheave_states import make_search


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
