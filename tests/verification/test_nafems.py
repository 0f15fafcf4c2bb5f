"""The NAFEMS benchmarks of solids meet their published targets, and come closer to exact values on finer meshes."""

from __future__ import annotations

from pathlib import Path

import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline import load_case
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.commands.verify import verify_case
from heavylift.pipeline.log import Log
from heavylift.pipeline.stages.stages import run_case

CASE = Path(__file__).resolve().parents[2] / "cases" / "nafems"


@pytest.mark.slow
def test_case_meets_its_references(tmp_path: Path) -> None:
    result = verify_case(CASE, out=tmp_path, overrides=(), force=True, log=Log(quiet=True))
    assert result.outcome is Outcome.COMPLETED, [check for check in result.checks if not check.passed]
    assert len(result.checks) == 23


@pytest.mark.slow
def test_simply_supported_plate_converges_to_the_exact_frequencies(tmp_path: Path) -> None:
    """Errors of the five bending frequencies fall at least with the square of the element, from above."""
    exact = {1: 45.971212, 2: 109.856862, 3: 109.856862, 6: 168.819294}
    errors = []
    for size in (1.0, 0.5):
        case = load_case(CASE, [f"bodies.fv52_navier.mesh.size={size}"])
        run_case(case, out=tmp_path / str(size), stages=("mesh", "modes"))
        found = Quantities(case, tmp_path / str(size))
        errors.append(
            [found.number(f"modes.fv52_navier.frequency.{k}") / value - 1.0 for k, value in exact.items()]
        )
    for coarse, fine in zip(*errors, strict=True):
        assert 0.0 < fine < coarse / 4.0
