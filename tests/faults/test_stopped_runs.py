"""Runs that are killed, interrupted, doubled or out of space lose nothing that was written."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline import load_results
from heavylift.pipeline.storage import OutputFolder

LONG = ("--set", "simulate.duration=40 ms")

SLOW = """
import time
from heavylift.pipeline import advance
advance.SEGMENT_SECONDS = 0.0
advance.FIRST_PIECE = 500
advance._next_piece = lambda piece, seconds: 500
from heavylift.solver.simulation import Simulation
real = Simulation.advance
def slow(self, steps):
    time.sleep(0.02)
    return real(self, steps)
Simulation.advance = slow
from heavylift.pipeline.cli import main
main()
"""
"""The command line, with a segment every 500 steps and twenty milliseconds."""


@pytest.fixture(scope="module")
def slow_run():
    """Start a slow `simulate` in a process of its own, and wait until it has written some segments."""
    running = []

    def start(folder):
        command = [sys.executable, "-c", SLOW, "simulate", str(folder), *LONG]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        running.append(process)
        segments = OutputFolder(folder / "out").segments
        for _ in range(6000):
            if process.poll() is not None or (segments.is_dir() and len(list(segments.glob("*.npz"))) > 3):
                break
            time.sleep(0.02)
        assert process.poll() is None, process.communicate()
        return process

    yield start
    for process in running:
        process.kill()
        process.communicate()


@pytest.fixture
def reference(heavylift, small_case):
    """Records of the same run, never interrupted."""
    assert heavylift("simulate", small_case, *LONG, "--quiet", "--out", small_case / "whole").code == 0
    return load_results(small_case / "whole")


def same(found, reference):
    assert np.array_equal(found.time, reference.time)
    for name in reference:
        assert np.array_equal(found[name], reference[name]), name


def test_sigkill(heavylift, small_case, reference, slow_run):
    process = slow_run(small_case)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate()
    kept = load_results(small_case)
    assert kept.outcome == "unfinished"
    assert len(kept.time) > 50
    for name in reference:
        assert np.array_equal(kept[name], reference[name][: len(kept.time)])
    result = heavylift("simulate", small_case, *LONG)
    assert result.code == 0
    assert "resumed from the checkpoint at t = " in result.out
    same(load_results(small_case), reference)
    assert not OutputFolder(small_case / "out").segments.exists()


def test_sigkill_and_other_inputs_afterwards(heavylift, small_case, slow_run):
    process = slow_run(small_case)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate()
    result = heavylift("simulate", small_case, "--set", "simulate.duration=2 ms")
    assert result.code == 0
    assert "restarted from t = 0" in result.out
    assert load_results(small_case).time[-1] == pytest.approx(2e-3)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_says_so_and_goes_on(heavylift, small_case, reference, slow_run, number):
    process = slow_run(small_case)
    process.send_signal(number)
    _, error = process.communicate(timeout=30)
    assert process.returncode == Outcome.INTERRUPTED
    assert signal.Signals(number).name in error
    assert "Traceback" not in error
    manifest = json.loads(OutputFolder(small_case / "out").manifest("simulate").read_text())
    assert manifest["outcome"] == "interrupted"
    result = heavylift("simulate", small_case, *LONG)
    assert result.code == 0
    assert "resumed" in result.out
    same(load_results(small_case), reference)


def test_two_runs_in_one_folder(heavylift, small_case, slow_run):
    process = slow_run(small_case)
    result = heavylift("simulate", small_case, *LONG)
    assert result.code == Outcome.LOCKED
    assert f"process {process.pid} on" in result.error
    assert len(result.error.splitlines()) == 1
    assert process.poll() is None
    assert heavylift("mesh", small_case, "--out", small_case / "other").code == 0
    result = heavylift("verify", small_case, "--json")
    assert result.code == 1
    assert json.loads(result.out)["cases"][0]["outcome"] == "locked"


def test_a_full_disk_while_simulating(heavylift, small_case, reference, monkeypatch):
    from heavylift.pipeline import advance

    monkeypatch.setattr(advance, "SEGMENT_SECONDS", 0.0)
    monkeypatch.setattr(advance, "_next_piece", lambda _piece, _seconds: 500)
    assert heavylift("modes", small_case, "--quiet").code == 0
    real, written = np.savez, []

    def savez(stream, *args, **kwargs):
        if len(written) == 5:
            stream.write(b"half")
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written.append(stream)
        real(stream, *args, **kwargs)

    monkeypatch.setattr(np, "savez", savez)
    result = heavylift("simulate", small_case, *LONG)
    assert result.code == Outcome.DISK_FULL
    assert "no space left" in result.error
    assert "5 segments" in result.error
    assert len(result.error.splitlines()) == 1
    kept = load_results(small_case)
    for name in reference:
        assert np.array_equal(kept[name], reference[name][: len(kept.time)])
    monkeypatch.setattr(np, "savez", real)
    result = heavylift("simulate", small_case, *LONG)
    assert result.code == 0
    assert "resumed" in result.out
    same(load_results(small_case), reference)


def test_a_full_disk_while_merging(heavylift, small_case, reference, monkeypatch):
    from heavylift.pipeline import storage

    real = storage.sync_file

    def sync(path):
        if "results.h5" in path.name:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        real(path)

    monkeypatch.setattr(storage, "sync_file", sync)
    result = heavylift("simulate", small_case, *LONG, "--json")
    assert result.code == Outcome.DISK_FULL
    assert json.loads(result.out)["outcome"] == "disk_full"
    same(load_results(small_case), reference)
    monkeypatch.setattr(storage, "sync_file", real)
    assert heavylift("simulate", small_case, *LONG).code == 0
    same(load_results(small_case), reference)


def test_a_full_disk_while_meshing_keeps_the_old_mesh(heavylift, small_case, monkeypatch):
    assert heavylift("mesh", small_case, "--quiet").code == 0
    file = OutputFolder(small_case / "out").model("beam")
    before = file.read_bytes()

    def full(_descriptor):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    result = heavylift("mesh", small_case, "--set", "bodies.beam.material.density=8000")
    assert result.code == Outcome.DISK_FULL
    assert "no space left" in result.error
    assert file.read_bytes() == before


def test_a_run_that_stops_by_itself_keeps_its_results_and_is_not_repeated(heavylift, small_case, monkeypatch):
    from heavylift.solver.simulation import Simulation

    real = Simulation.advance

    def diverging(self, steps):
        if self.step_index + steps <= 300:
            return real(self, steps)
        found = real(self, 300 - self.step_index)
        self.outcome, self.message = (
            Outcome.NOT_FINITE,
            "not finite at t = 0.0003 s, body 'beam'; try a smaller step",
        )
        return found

    monkeypatch.setattr(Simulation, "advance", diverging)
    result = heavylift("simulate", small_case, "--json")
    assert result.code == Outcome.NOT_FINITE
    assert json.loads(result.out)["outcome"] == "not_finite"
    assert "body 'beam'" in result.error
    results = load_results(small_case)
    assert results.outcome == "not_finite"
    assert results.time[-1] == pytest.approx(3e-4)
    monkeypatch.undo()
    again = heavylift("simulate", small_case)
    assert again.code == Outcome.NOT_FINITE
    assert "unchanged, skipped" in again.out
    assert "body 'beam'" in again.error
    assert heavylift("verify", small_case).code == 1
    assert heavylift("simulate", small_case, "--force").code == 0


def test_energies_beyond_all_numbers_are_no_json_errors(heavylift, small_case):
    result = heavylift(
        "simulate",
        small_case,
        "--set",
        "simulate.duration=1 ms",
        "--set",
        "bodies.beam.initial.modal_velocity=[1e300]",
        "--json",
    )
    document = json.loads(result.out, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
    assert document["energy_drift"] is None
