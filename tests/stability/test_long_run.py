"""Ten million steps: time does not drift, and neither does anything else."""

from __future__ import annotations

import numpy as np
import pytest
from experiments import completed, run
from mechanisms import chain


@pytest.mark.slow
def test_ten_million_steps():
    result = run(chain((1.0,)), 1e-4, 1000.0)
    assert not completed(result)
    assert result.simulation.step_index == 10_000_000
    assert result.times[-1] == pytest.approx(1000.0, rel=1e-15)
    assert result.violation < 1e-11
    balance = result["energy.balance"][:, 0]
    assert np.abs(balance - balance[0]).max() < 1e-6 * result["energy.kinetic"].max()
    half = len(balance) // 2  # bounded, not growing
    assert np.abs(balance[half:] - balance[0]).max() < 2.0 * np.abs(balance[:half] - balance[0]).max() + 1e-9
