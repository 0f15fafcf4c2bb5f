"""Verdicts on cases: exit codes."""

from __future__ import annotations

import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.commands.verify import CaseVerdict, exit_code


@pytest.mark.parametrize(
    ("outcomes", "code"),
    [
        ([], 0),
        (["COMPLETED", "COMPLETED"], 0),
        (["COMPLETED", "CHECK_FAILED"], 1),
        (["BAD_INPUT", "CHECK_FAILED"], 2),
        (["NOT_FINITE"], 3),
        (["LOCKED", "COMPLETED"], 7),
        (["NOT_FINITE", "BAD_INPUT", "LOCKED"], 7),
    ],
)
def test_the_largest_code_counts(outcomes, code):
    assert exit_code([CaseVerdict("case", Outcome[name], 0.0) for name in outcomes]) == code
