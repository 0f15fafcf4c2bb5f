"""Cases of transporters that take long, against their references."""

from __future__ import annotations

from pathlib import Path

import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.commands.verify import verify_case
from heavylift.pipeline.log import Log

CASES = Path(__file__).resolve().parents[2] / "cases"
pytestmark = [pytest.mark.slow, pytest.mark.timeout(1800)]


@pytest.mark.parametrize(("name", "count"), [("flexible_block", 8), ("spmt_bump", 7)])
def test_every_check_passes(name, count, tmp_path):
    """And none of them is missing."""
    verdict = verify_case(CASES / name, out=tmp_path, overrides=(), force=True, log=Log(quiet=True))
    assert verdict.outcome is Outcome.COMPLETED, (
        verdict.message,
        [c for c in verdict.checks if not c.passed],
    )
    assert len(verdict.checks) == count
