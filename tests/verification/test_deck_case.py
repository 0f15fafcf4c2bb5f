"""A body from a deck of plates, bars, masses and rigid elements: mass and forces by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.commands.verify import verify_case
from heavylift.pipeline.log import Log

CASES = Path(__file__).resolve().parents[2] / "cases"


@pytest.mark.slow
def test_a_block_of_a_deck_hangs_on_four_ropes(tmp_path):
    result = verify_case(CASES / "nastran_block", out=tmp_path, overrides=(), force=True, log=Log(quiet=True))
    assert result.outcome is Outcome.COMPLETED, (result.message, result.checks)
    assert [check.id for check in result.checks if not check.passed] == []
    assert len(result.checks) == 5
