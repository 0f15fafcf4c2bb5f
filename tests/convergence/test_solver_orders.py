"""Observed orders of both integrators against point masses integrated by DOP853 to 1e-11."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parents[1] / "solver"))

from scenarios import FLEXIBLE, RIGID, errors, reference, simulate

CASES = {f"flexible, {name}": (system, system.scene) for name, system in FLEXIBLE.items()}
CASES |= {f"rigid, {name}": (system, system.rigid_scene) for name, system in RIGID.items()}

ROUNDING = 1e-9
"""Relative errors below this show no order: momenta, prescribed motions."""


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_default_is_second_order_in_every_channel(case: str) -> None:
    system, scene = CASES[case]
    coarse, fine = (errors(simulate(scene(), h), reference(system)) for h in (5e-4, 1.25e-4))
    orders = {
        name: 0.5 * np.log2(coarse[name] / fine[name])
        for name in fine
        if max(fine[name], coarse[name]) > ROUNDING
    }
    assert {name: order for name, order in orders.items() if order < 1.9} == {}
    assert max(fine.values()) < 1e-3


@pytest.mark.parametrize("case", CASES)
def test_thesis_is_first_order(case: str) -> None:
    system, scene = CASES[case]
    totals = []
    for h in (5e-4, 2.5e-4):
        found = errors(simulate(scene(), h, "thesis"), reference(system))
        totals.append(np.linalg.norm(list(found.values())))
    if max(totals) > ROUNDING:
        assert 0.8 < np.log2(totals[0] / totals[1]) < 1.3
