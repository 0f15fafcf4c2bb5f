"""Times of events of a lift against an independent integration: their errors fall with the square of the step."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from heavylift.pipeline import load_case, load_results, run_case

pytestmark = pytest.mark.slow

CASE = Path(__file__).resolve().parents[3] / "cases" / "staged_lift" / "case.toml"
MASS, EA, DAMPING, SPEED, LENGTH, REACH = 350e3, 6e9, 118e3, 0.02, 60.05, 60.0
WEIGHT = MASS * 9.81
LOADS = np.linspace(3000e3, 30e3, 12)
"""On the floor, while the rope tightens [N]."""
GAPS = np.linspace(0.15e-3, 1.5e-3, 12)
"""Under the block [m]."""


def tension(t: float, z: float, w: float) -> float:
    """Of the rope with the block at a height and a speed."""
    rest = LENGTH - SPEED * t
    return EA * ((REACH - z) / rest - 1.0) + DAMPING * (SPEED - w)


def reference() -> np.ndarray:
    """When the floor bears each of the loads, and when the block has each of the gaps [s]."""
    begin = (LENGTH - REACH) / SPEED
    tightened = [
        brentq(lambda t, n=n: tension(t, 0.0, 0.0) - WEIGHT + n, begin, 9.0, xtol=1e-14) for n in LOADS
    ]
    off = brentq(lambda t: tension(t, 0.0, 0.0) - WEIGHT, begin, 9.0, xtol=1e-14)
    rising = solve_ivp(
        lambda t, y: [y[1], tension(t, *y) / MASS - 9.81],
        (off, off + 0.3),
        [0.0, 0.0],
        method="DOP853",
        rtol=1e-12,
        atol=1e-15,
        dense_output=True,
    ).sol
    risen = [brentq(lambda t, z=z: rising(t)[0] - z, off + 1e-3, off + 0.3, xtol=1e-14) for z in GAPS]
    return np.array([*tightened, *risen])


def times(folder: Path, step: float) -> np.ndarray:
    """The same of a run: a phase for each."""
    text = CASE.read_text()
    words = [f'until = {{ quantity = "support.normal_force", below = {n!r} }}' for n in LOADS.tolist()]
    words += [f'until = {{ quantity = "block.position.z", above = {z!r} }}' for z in GAPS.tolist()]
    actions = 'actions = [{ winch = "fall", speed = "0.02 m/s" }]\n'
    phases = [
        f'[[scenario.phases]]\nname = "p{i}"\n{"" if i else actions}{until}\n'
        for i, until in enumerate(words)
    ]
    simulate = f'[simulate]\nstep = {step!r}\noutput_interval = "0.1 s"\nduration = "5 s"\n'
    folder.mkdir()
    (folder / "case.toml").write_text(text[: text.index("[scenario]")] + "".join(phases) + simulate)
    case = load_case(folder)
    run_case(case, stages=("mesh", "simulate"))
    log = load_results(case, case.output_folder).metadata["scenario"]["log"]
    return np.array([line[0] for line in log if line[2] == "done"])


def test_lift_off_and_clearance(tmp_path: Path) -> None:
    exact = reference()
    errors = np.array(
        [np.abs(times(tmp_path / f"{i}", step) - exact) for i, step in enumerate((0.02, 0.01, 0.005, 0.0025))]
    )
    tightened, risen = errors[:, :12].max(axis=1), errors[:, 12:].max(axis=1)
    assert tightened[0] < 2e-7
    assert all(b < 0.3 * a for a, b in pairwise(tightened)), tightened
    # at some steps the block leaves the floor nearer to the end of one than at others
    assert risen[0] < 3e-3
    assert all(b < a for a, b in pairwise(risen)), risen
    assert risen[-1] < risen[0] / 40.0, risen
