"""Cases of contacts on flexible bodies against their references, and what the basis and the step do to them."""

from __future__ import annotations

from pathlib import Path

import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.commands.verify import verify_case
from heavylift.pipeline.log import Log

CASES = Path(__file__).resolve().parents[2] / "cases"
pytestmark = [pytest.mark.slow, pytest.mark.timeout(1800)]


def verdict(name: str, out: Path, *overrides: str):
    return verify_case(CASES / name, out=out, overrides=overrides, force=True, log=Log(quiet=True))


@pytest.mark.parametrize(
    ("name", "count"),
    [("point_mass_on_beam", 10), ("ball_on_beam", 14), ("ball_on_ring", 9), ("belt_sliding", 5)],
)
def test_case_meets_its_references(name: str, count: int, tmp_path: Path) -> None:
    result = verdict(name, tmp_path)
    assert result.outcome is Outcome.COMPLETED, (
        result.message,
        [check for check in result.checks if not check.passed],
    )
    assert len(result.checks) == count


def test_eigenmodes_alone_lose_the_energy_of_every_touch(tmp_path: Path) -> None:
    """25 mm/s and more are missing from the end velocity, whatever their number; the other checks stay as they are."""
    changes = ("attach=", "patches=", "count=40")
    plain = [f"bodies.hard_beam_{k}.modes.{change}" for k in "AB" for change in changes]
    result = verdict("point_mass_on_beam", tmp_path, *plain)
    checks = {check.id: check for check in result.checks}
    for name in ("reduction_A", "reduction_B"):
        assert 0.025 < checks[name].reference - checks[name].value < 0.045
    assert checks["v_end_A"].passed
    assert checks["v_end_B"].passed


def test_energy_of_the_rolling_ball_closes_with_second_order(tmp_path: Path) -> None:
    errors = []
    for step in ("0.5 ms", "0.25 ms", "0.125 ms"):
        result = verdict("ball_on_ring", tmp_path / step.split()[0], f"simulate.step={step}")
        errors.append(next(check.error for check in result.checks if check.id == "energy_drift"))
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.1)
