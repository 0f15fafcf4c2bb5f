"""The plate that is turned over as a shell: files of its generator, and shares of its loaders from moments."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.commands.verify import verify_case
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.histories import load_results

if TYPE_CHECKING:
    from types import ModuleType

CASE = Path(__file__).resolve().parents[2] / "cases" / "plate_turn_over"


@pytest.fixture
def scripts(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """`shares`, whose neighbour `make_case` it imports."""
    monkeypatch.syspath_prepend(str(CASE))
    for name in ("make_case", "shares"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    import shares

    yield shares
    for name in ("make_case", "shares"):
        sys.modules.pop(name, None)


def test_files_of_shells_are_what_the_generator_writes(scripts: ModuleType) -> None:
    make_case = sys.modules["make_case"]
    for name in make_case.PLATES:
        for word, elements in make_case.MESHES.items():
            stored = (CASE / f"{name}{word}.toml").read_text(encoding="utf-8")
            assert stored == make_case.shell_case(name, elements)


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("word", ["steel", "steel_12x8"])
def test_shares_are_those_of_moments(word: str, scripts: ModuleType, tmp_path: Path) -> None:
    """At rest at 0 to 85 degrees, with lines as they lean and hooks that swing, whatever the mesh."""
    make_case = sys.modules["make_case"]
    name, _, mesh = word.partition("_")
    log = Log(quiet=True)
    verdict = verify_case(CASE / f"{word}.toml", out=tmp_path, overrides=(), force=False, log=log)
    assert verdict.outcome is Outcome.COMPLETED, verdict
    assert all(check.passed for check in verdict.checks), verdict
    results = load_results(CASE / f"{word}.toml", tmp_path)
    elements = make_case.MESHES["_" + mesh if mesh else ""]
    found = [
        scripts.shares(results, name, elements, int(np.searchsorted(results.time, time - 1e-6)))
        for time in make_case.SHELL.moves()[2][:-1]
    ]
    for shares in found:
        assert shares.recorded == pytest.approx(shares.moving, abs=1e-3)
    # near upright the lean of the lines counts by the tangent of the angle
    assert found[-1].leaning - found[-1].vertical > 5e-3
