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
from heavylift.pipeline.results.storage import OutputFolder

LONG = ("--set", "simulate.duration=40 ms")

SLOW = """
import time
from heavylift.pipeline.stages import advance
advance.SEGMENT_SECONDS = 0.0
advance.FIRST_PIECE = 500
advance.next_piece = lambda piece, seconds, growth: 500
from heavylift.solver.simulation import Simulation
real = Simulation.advance
def slow(self, steps):
    time.sleep(0.02)
    return real(self, steps)
Simulation.advance = slow
from heavylift.pipeline.commands.start import main
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


def not_reached(row, outcome):
    """A verdict on a case that did not get to its two checks."""
    assert row["outcome"] == outcome
    assert [check["id"] for check in row["checks"]] == ["mass", "ringdown_1"]
    for check in row["checks"]:
        assert list(check) == ["id", "value", "reference", "error", "tolerance", "unit", "source", "passed"]
        assert check["value"] is None
        assert check["passed"] is False


@pytest.mark.slow
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


@pytest.mark.slow
def test_sigkill_and_other_inputs_afterwards(heavylift, small_case, slow_run):
    process = slow_run(small_case)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate()
    result = heavylift("simulate", small_case, "--set", "simulate.duration=2 ms")
    assert result.code == 0
    assert "restarted from t = 0" in result.out
    assert load_results(small_case).time[-1] == pytest.approx(2e-3)


@pytest.mark.slow
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


@pytest.mark.slow
def test_two_runs_in_one_folder(heavylift, small_case, slow_run):
    process = slow_run(small_case)
    result = heavylift("simulate", small_case, *LONG)
    assert result.code == Outcome.LOCKED
    assert f"process {process.pid} on" in result.error
    assert len(result.error.splitlines()) == 1
    assert process.poll() is None
    assert heavylift("mesh", small_case, "--out", small_case / "other").code == 0
    result = heavylift("verify", small_case, "--json")
    assert result.code == Outcome.LOCKED
    not_reached(json.loads(result.out)["cases"][0], "locked")


@pytest.mark.slow
def test_a_full_disk_while_simulating(heavylift, small_case, reference, monkeypatch):
    from heavylift.pipeline.stages import advance

    monkeypatch.setattr(advance, "SEGMENT_SECONDS", 0.0)
    monkeypatch.setattr(advance, "next_piece", lambda _piece, _seconds, _growth: 500)
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


@pytest.mark.slow
def test_a_full_disk_while_merging(heavylift, small_case, reference, monkeypatch):
    from heavylift.pipeline.results import storage

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


@pytest.mark.slow
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
    result = heavylift("verify", small_case, "--json")
    assert result.code == Outcome.NOT_FINITE
    not_reached(json.loads(result.out)["cases"][0], "not_finite")
    result = heavylift("verify", small_case)
    assert result.out.count("not reached, FAILED") == 2
    result = heavylift("run", small_case)
    assert result.code == Outcome.NOT_FINITE
    assert "body 'beam'" in result.error
    assert "Stopped: a value is not finite" in report_text(small_case)
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


def report_text(folder):
    return (folder / "out" / "report" / "report.md").read_text()


@pytest.mark.slow
def test_the_report_of_a_killed_run_is_made_anew_when_the_run_is_whole(heavylift, small_case, slow_run):
    process = slow_run(small_case)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate()
    assert heavylift("report", small_case, *LONG).code == 0
    assert "unfinished" in report_text(small_case)
    assert "unchanged" in heavylift("report", small_case, *LONG).out
    assert heavylift("simulate", small_case, *LONG).code == 0
    assert "unchanged" not in heavylift("report", small_case, *LONG).out
    assert "completed" in report_text(small_case)
    assert "unfinished" not in report_text(small_case)
    assert heavylift("run", small_case, *LONG).out.count("unchanged, skipped") == 4


def test_a_run_killed_before_its_first_segment_says_that_it_restarts(heavylift, small_case, monkeypatch):
    from heavylift.solver.simulation import Simulation

    class KilledError(BaseException):
        """Ends a process where it stands, as far as the disk is concerned."""

    def killed(*_arguments):
        raise KilledError

    for method in ("warm_up", "advance"):
        monkeypatch.setattr(Simulation, method, killed)
        with pytest.raises(KilledError):
            heavylift("simulate", small_case)
        monkeypatch.undo()
        result = heavylift("simulate", small_case, "--set", "simulate.duration=1 ms")
        assert result.code == 0
        assert "simulate: restarted from t = 0: nothing had been written" in result.out
    result = heavylift("simulate", small_case, "--set", "simulate.duration=2 ms")
    assert "restarted" not in result.out  # the run before was whole, this is another one


@pytest.mark.slow
def test_a_run_that_stops_before_its_first_step_has_no_speed_and_no_drift(heavylift, small_case, monkeypatch):
    from heavylift.solver.simulation import Simulation

    def nothing(self, _steps):
        self.outcome, self.message = Outcome.NOT_FINITE, "not finite at t = 0 s, body 'beam'"
        return np.empty(0), np.empty((0, self.column_count))

    monkeypatch.setattr(Simulation, "advance", nothing)
    result = heavylift("simulate", small_case, "--json")
    document = json.loads(result.out)
    assert result.code == Outcome.NOT_FINITE
    assert (document["steps"], document["step_us"], document["energy_drift"]) == (0, None, None)
    assert "0 steps, " in result.error
    assert "us a step" not in result.error
    assert "drift" not in result.error
    result = heavylift("run", small_case)
    assert result.code == Outcome.NOT_FINITE
    assert "Stopped: a value is not finite" in report_text(small_case)


def test_a_report_that_cannot_be_made_does_not_hide_how_the_run_ended(heavylift, small_case, monkeypatch):
    from heavylift.numerics.outcome import InputError
    from heavylift.pipeline.report import report
    from heavylift.solver.simulation import Simulation

    def nothing(self, _steps):
        self.outcome, self.message = Outcome.NOT_FINITE, "not finite at t = 0 s, body 'beam'"
        return np.empty(0), np.empty((0, self.column_count))

    def refused(*_arguments, **_more):
        raise InputError("no picture of this")

    monkeypatch.setattr(Simulation, "advance", nothing)
    monkeypatch.setattr(report, "write_report", refused)
    result = heavylift("run", small_case)
    assert result.code == Outcome.NOT_FINITE
    assert "body 'beam'" in result.error
    assert "report: no picture of this" in result.out
