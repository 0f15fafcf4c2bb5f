"""Every experiment of the stability report is right, or stops where it is allowed to and names the part."""

from __future__ import annotations

import pytest
from experiments import EXPERIMENTS


@pytest.mark.slow
@pytest.mark.parametrize("name", EXPERIMENTS)
def test_experiment(name):
    rows = list(EXPERIMENTS[name]())
    assert rows
    wrong = [
        f"{row.setting}: {row.measure} {row.value:.2e}, limit {row.limit:.2e} {row.stopped}"
        for row in rows
        if not row.right
    ]
    assert not wrong
    for row in rows:
        if row.stopped:
            assert "body '" in row.stopped or "joint '" in row.stopped
