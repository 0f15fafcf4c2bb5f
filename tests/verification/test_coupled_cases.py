"""Coupled cases: two programs against a closed form and against one, a controller in C against its equation."""

from __future__ import annotations

import math
import shutil
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.commands.couple import couple
from heavylift.pipeline.commands.verify import verify_case
from heavylift.pipeline.coupled.coupling_file import load_coupling
from heavylift.pipeline.coupled.run import CoupledScenes
from heavylift.pipeline.log import Log

CASES = Path(__file__).parents[2] / "cases"


def exact(time: float) -> np.ndarray:
    """Displacements of the coupled masses [m]."""
    m1, k1, m2, k2, k, c = 1000.0, 40e3, 500.0, 20e3, 60e3, 400.0
    first = [-(k1 + k) / m1, -c / m1, k / m1, c / m1]
    second = [k / m2, c / m2, -(k2 + k) / m2, -c / m2]
    rates = np.array([[0, 1, 0, 0], first, [0, 0, 0, 1], second])
    return (expm(rates * time) @ [0.1, 0.0, 0.0, 0.0])[[0, 2]]


def error(method: str, interval: float, out: Path) -> float:
    """Largest error of both masses at the exchanges of the first second [m]."""
    worst = 0.0
    coupling = load_coupling(CASES / "coupled_masses", {"method": method, "interval": interval})
    with CoupledScenes(coupling, out) as coupled:
        for k in range(round(1.0 / interval)):
            coupled.master.step(k * interval, interval)
            found = [
                coupled.scenes["first"]["m1.position.x"],
                coupled.scenes["second"]["m2.position.x"] - 10.0,
            ]
            worst = max(worst, float(np.abs(found - exact((k + 1) * interval)).max()))
    return worst


@pytest.mark.slow
@pytest.mark.parametrize(
    ("method", "order"), [("held", 1), ("sequential", 1), ("extrapolated", 2), ("iterated", 2)]
)
def test_two_scenes_have_the_order_of_their_exchange(method: str, order: int, tmp_path: Path) -> None:
    errors = [error(method, interval, tmp_path) for interval in (5e-3, 2.5e-3, 1.25e-3)]
    found = [math.log2(a / b) for a, b in pairwise(errors)]
    assert found == pytest.approx([order, order], abs=0.2), errors


def test_coupled_masses_pass_their_checks(tmp_path: Path) -> None:
    assert couple(CASES / "coupled_masses", out=tmp_path, quiet=True) == 0


@pytest.mark.slow
def test_a_crane_and_its_barge_in_two_processes_are_one_scene(tmp_path: Path) -> None:
    """At 10 ms within a thousandth of what each channel changes."""
    folder = CASES / "crane_and_barge"
    whole = load_case(folder)
    assert run_case(whole, out=tmp_path / "whole", stages=("mesh", "simulate")).outcome is Outcome.COMPLETED
    assert couple(folder, out=tmp_path / "two", quiet=True) == 0
    one = load_results(whole, tmp_path / "whole")
    for scene, names in (
        ("crane", ("fall.tension", "load.position")),
        ("barge", ("tip.position", "barge.position")),
    ):
        found = load_results(load_case(folder / scene), tmp_path / "two" / scene)
        for name in names:
            off = np.abs(found[name] - one[name]).max() / np.ptp(one[name], axis=0).max()
            assert off < 1e-3, name


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_a_controller_in_c_damps_a_swing(tmp_path: Path) -> None:
    pytest.importorskip("fmpy")
    verdict = verify_case(
        CASES / "tagline_controller", out=tmp_path, overrides=(), force=False, log=Log(quiet=True)
    )
    assert verdict.outcome is Outcome.COMPLETED, verdict.message
    assert {one.id for one in verdict.checks} == {"position", "still", "energy"}
