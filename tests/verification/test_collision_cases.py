"""Cases of collisions against their references; where one case cannot show it all, the same scene with other keys."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.commands.verify import verify_case
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.histories import load_results
from heavylift.pipeline.stages.stages import load_changed_case

CASES = Path(__file__).resolve().parents[2] / "cases"
pytestmark = [pytest.mark.slow, pytest.mark.timeout(1800)]


def verdict(name: str, out: Path, *overrides: str):
    return verify_case(CASES / name, out=out, overrides=overrides, force=True, log=Log(quiet=True))


def histories(name: str, out: Path, *overrides: str):
    return load_results(load_changed_case(CASES / name, overrides), out)


@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("box_drop", 13),
        ("incline", 7),
        ("rocking_block", 4),
        ("unenclosed_box", 7),
        ("bunnies", 10),
        ("stack", 9),
        ("links_drop", 12),
        ("tank_in_hull", 16),
    ],
)
def test_case_meets_its_references(name: str, count: int, tmp_path: Path) -> None:
    result = verdict(name, tmp_path)
    assert result.outcome is Outcome.COMPLETED, (
        result.message,
        [check for check in result.checks if not check.passed],
    )
    assert len(result.checks) == count


def bouncing(step: str) -> tuple[str, ...]:
    """Keys of `box_drop` with the three rigid boxes alone judged, at another step."""
    names = ("e0", "e05", "e1")
    references, checks = [], []
    for name, apex in zip(names, (0.0, 0.25, 1.0), strict=True):
        for what, file, value in (("apex", "plate", apex), ("bounces", f"bounces_{name}", 0.0)):
            one = f"{what}_{name}"
            references.append(f'{{name="{one}",channel="{name}.position",file="{file}.csv",scale="1 m"}}')
            checks.append(
                f'{{id="{one}",quantity="deviation.{one}",reference={value},tolerance={{absolute=1e-4}},source="e^2"}}'
            )
    return (
        f"simulate.step={step}",
        "simulate.output_interval=10 ms",
        f"reference=[{','.join(references)}]",
        f"check=[{','.join(checks)}]",
    )


def test_apexes_at_a_step_in_which_a_box_falls_44_mm(tmp_path: Path) -> None:
    result = verdict("box_drop", tmp_path, *bouncing("10 ms"))
    assert result.outcome is Outcome.COMPLETED, (result.message, result.checks)


def test_impulses_of_falling_links_are_the_weight_times_the_time(tmp_path: Path) -> None:
    """What the links have got from the plate is what gravity gave them, less the momentum they still have.

    Energy only falls, and the links of every chain have come to lie on the plate in the end.
    """
    assert verdict("links_drop", tmp_path).outcome is Outcome.COMPLETED
    results = histories("links_drop", tmp_path)
    for tag, count in (("chain2_10", 2), ("chain2_30", 2), ("chain5_10", 5), ("chain5_30", 5)):
        impulse = sum(results[f"{tag}_blow{i}.impulse"][-1] for i in range(count))
        velocity = sum(results[f"{tag}_{i}.velocity"][-1, 2] for i in range(count))
        weight = 1000.0 * 9.81 * count * results.time[-1]
        assert impulse - 1000.0 * velocity == pytest.approx(weight, rel=1e-6)
        assert all(np.nanmin(results[f"{tag}_blow{i}.gap"]) > -1e-5 for i in range(count))
    energy = (results["energy.kinetic"] + results["energy.elastic"] + results["energy.potential"]).ravel()
    assert np.diff(energy).max() < 1e-6 * np.ptp(energy)


def test_a_tank_never_passes_a_chock(tmp_path: Path) -> None:
    """Both tanks stay over the tops of the chocks, and nothing pulls or throws: forces from 0 to 1.5 weights."""
    assert verdict("tank_in_hull", tmp_path).outcome is Outcome.COMPLETED
    results = histories("tank_in_hull", tmp_path)
    weight = 1.6e6 * 9.81
    for tag in ("upright", "tilted"):
        force = results[f"landing_{tag}.normal_force"].ravel()
        assert np.isfinite(force).all()
        assert force.min() >= 0.0
        assert force.max() < 1.5 * weight
        turn = results[f"tank_{tag}.orientation"]
        tilt = 2.0 * np.arctan2(turn[:, 2], turn[:, 0])
        low = results[f"tank_{tag}.position"][:, 2] - 12.0 * np.sin(np.abs(tilt)) - 8.0 * np.cos(tilt)
        assert low.min() > -8.0 - 1e-6
