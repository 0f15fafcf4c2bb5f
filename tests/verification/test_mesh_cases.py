"""Cases of frames and shells against their references, and what steps do to the plate that swings."""

from __future__ import annotations

from pathlib import Path

import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.commands.verify import verify_case
from heavylift.pipeline.log import Log

CASES = Path(__file__).resolve().parents[2] / "cases"


def verdict(name: str, out: Path, *overrides: str):
    return verify_case(CASES / name, out=out, overrides=overrides, force=True, log=Log(quiet=True))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("beam_static", 60),
        ("plate_static", 96),
        ("heavy_membrane", 11),
        ("flexible_pendulum", 3),
        ("flexible_pendulum_g50", 3),
        ("flexible_pendulum_stiff", 3),
        ("flexible_pendulum_30s", 1),
        ("hanging_plate", 4),
        ("thin_plate_lift", 5),
    ],
)
def test_case_meets_its_references(name: str, count: int, tmp_path: Path) -> None:
    result = verdict(name, tmp_path)
    assert result.outcome is Outcome.COMPLETED, (
        result.message,
        [check for check in result.checks if not check.passed],
    )
    assert len(result.checks) == count


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["carried", "energy-momentum"])
@pytest.mark.parametrize("damping", ["0 s", "10 ms"])
def test_swinging_plate_keeps_its_energy_with_large_steps(scheme: str, damping: str, tmp_path: Path) -> None:
    """20 ms is 130 times the largest step of an explicit scheme."""
    changes = [
        text
        for body in ("plate", "block")
        for text in (
            f"bodies.{body}.elasticity={scheme}",
            f"bodies.{body}.damping.stiffness={damping}",
        )
    ]
    result = verdict("hanging_plate", tmp_path, "simulate.step=20 ms", *changes)
    values = {check.id: check.error for check in result.checks}
    assert values["invariant"] <= 1e-10


@pytest.mark.slow
def test_stress_of_the_swinging_plate_converges_with_second_order(tmp_path: Path) -> None:
    errors = []
    for step in ("10 ms", "5 ms", "2.5 ms"):
        result = verdict("hanging_plate", tmp_path / step.split()[0], f"simulate.step={step}")
        errors.append(next(check.error for check in result.checks if check.id == "stress"))
    assert errors[0] / errors[1] > 3.0
    assert errors[1] / errors[2] > 3.0
