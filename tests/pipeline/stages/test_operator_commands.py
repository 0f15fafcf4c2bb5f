"""Words to a run from outside: taken between pieces, kept with their steps, taken again at the same steps."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.stages import advance
from heavylift.pipeline.stages.lock import locked
from heavylift.pipeline.stages.operator_commands import WORDS_FILE, send

if TYPE_CHECKING:
    from heavylift.pipeline.results.histories import Results

PHASES = Path(__file__).resolve().parents[1] / "phases.toml"
WAITS = 'until = { any = [{ user = "continue" }, { time = "5 s" }] }\n'


def prepared(folder: Path) -> Path:
    """A case whose second phase waits for someone to say so."""
    folder.mkdir()
    text = PHASES.read_text()
    begin, _, rest = text.partition('until = { all = [{ time = "1 s" }')
    (folder / "case.toml").write_text(begin + WAITS + rest[rest.index("\n") :])
    return folder


def told(folder: Path, monkeypatch: pytest.MonkeyPatch, words: dict[int, str], stop_at: int = 0) -> Outcome:
    """Run a case; say words before some of the pieces of its loop, of 40 steps each; perhaps kill it before one."""
    case = load_case(folder)
    pieces = [0]

    def next_piece(*_: float) -> int:
        pieces[0] += 1
        if pieces[0] in words:
            with pytest.raises(InputError, match="no run works"):
                send(folder / "elsewhere", "hold")
            send(case.output_folder, words[pieces[0]])  # type: ignore[arg-type]
        if pieces[0] == stop_at:
            raise KeyboardInterrupt
        return 40

    monkeypatch.setattr(advance, "next_piece", next_piece)
    monkeypatch.setattr(advance, "FIRST_PIECE", 40)
    monkeypatch.setattr(advance, "FIRST_SEGMENT_SECONDS", 0.0)
    monkeypatch.setattr(advance, "SEGMENT_SECONDS", 0.0)
    if stop_at:
        with pytest.raises(KeyboardInterrupt):
            run_case(case, stages=("mesh", "simulate"))
        return Outcome.INTERRUPTED
    return run_case(case, stages=("mesh", "simulate")).outcome


def results(folder: Path) -> Results:
    case = load_case(folder)
    return load_results(case, case.output_folder)


@pytest.mark.slow
def test_words_are_taken_and_logged_and_taken_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that is told something, killed and gone on with, and one that is made anew, end as it did."""
    folder = prepared(tmp_path / "whole")
    words = {3: "hold", 5: "continue", 6: "continue"}
    assert told(folder, monkeypatch, words) is Outcome.COMPLETED
    first = results(folder)
    log = first.metadata["scenario"]["log"]
    assert [(line[0], line[3]) for line in log if line[2] == "operator command"] == [
        (1.2, "hold"),
        (2.0, "continue"),
        (2.4, "continue"),
    ]
    done = {line[1]: line[0] for line in log if line[2] == "done"}
    assert done["hoist"] == pytest.approx(2.0, abs=1e-5)  # it was due at 1.2693 s, and held
    assert done["hold"] == pytest.approx(2.4, abs=1e-5)
    # killed behind the last word, and gone on with: a checkpoint before some of the words would take them again
    cut = prepared(tmp_path / "cut")
    told(cut, monkeypatch, words, stop_at=7)
    assert told(cut, monkeypatch, {}) is Outcome.COMPLETED
    # made anew without its checkpoints, with the words that were taken
    again = tmp_path / "again"
    shutil.copytree(folder, again)
    shutil.rmtree(again / "out" / "simulate")
    assert told(again, monkeypatch, {}) is Outcome.COMPLETED
    for one in (cut, again):
        other = results(one)
        assert other.metadata["scenario"]["log"] == log
        np.testing.assert_array_equal(other["load.position"], first["load.position"])


def test_stop_ends_a_run_and_old_words_are_not_for_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = prepared(tmp_path / "case")
    (folder / "out").mkdir()
    (folder / "out" / WORDS_FILE).write_text("stop\n")
    assert told(folder, monkeypatch, {4: "stop"}) is Outcome.LIMIT_REACHED
    assert "stopped by the operator at t = 1.6 s" in results(folder).metadata["message"]


def test_only_a_run_that_goes_on_is_told_something(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no run works in"):
        send(tmp_path, "stop")
    with locked(tmp_path):
        send(tmp_path, "stop")
    assert (tmp_path / WORDS_FILE).read_text() == "stop\n"
