"""A small part of the mutants and hostile files of `soak_mutants`; the large one is run by hand."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

import soak_mutants

pytestmark = pytest.mark.slow


def test_mutants_end_as_cases_or_as_lines_with_a_place():
    told: list[str] = []
    counts = soak_mutants.run_loader(150, 3, told.append)
    assert not told
    assert counts["refused"] > 75  # they are mutants
    assert counts["ok"] > 5  # and still cases
    assert sum(counts.values()) == 150


def test_mutants_that_are_cases_end_as_runs():
    told: list[str] = []
    counts = soak_mutants.run_simulations(3, 3, told.append)
    assert not told
    assert sum(counts.values()) == 3


def test_hostile_files_end_no_process():
    told: list[str] = []
    counts = soak_mutants.run_hostile(15, 3, told.append)
    assert not told
    assert counts["refused"] > 0


def test_a_traceback_a_crash_and_a_hang_would_be_seen(monkeypatch):
    import os
    import signal

    def fails() -> None:
        raise KeyError("nodes")

    assert soak_mutants._read_apart(fails)[0] == "failures"
    how, words = soak_mutants._read_apart(lambda: os.kill(os.getpid(), signal.SIGKILL))
    assert (how, words) == ("failures", "ended by SIGKILL")
    from heavylift.pipeline.stages import stages

    monkeypatch.setattr(stages, "load_changed_case", lambda _folder: fails())
    assert soak_mutants.run_loader(1, 1, lambda _words: None) == {"failures": 1}
