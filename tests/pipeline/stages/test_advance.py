"""A run that was stopped goes on bit for bit, from whatever is left on disk."""

from __future__ import annotations

import errno
import os

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.results.histories import read_segments, segment_path
from heavylift.pipeline.results.storage import StopError
from heavylift.pipeline.stages import advance
from heavylift.pipeline.stages.advance import Advancer, StopRequest

STEPS = 303
next_piece = advance.next_piece


def quiet(_done, _note):
    pass


def history(folder):
    found = list(read_segments(folder))
    return np.concatenate([s.times for s in found]), np.concatenate([s.records for s in found])


@pytest.fixture(autouse=True)
def many_segments(monkeypatch):
    monkeypatch.setattr(advance, "SEGMENT_SECONDS", 0.0)
    monkeypatch.setattr(advance, "FIRST_PIECE", 17)
    monkeypatch.setattr(advance, "next_piece", lambda _piece, _seconds, _growth: 31)


@pytest.fixture
def whole(tmp_path, fake_simulation):
    folder = tmp_path / "whole"
    outcome, message = Advancer(fake_simulation(), folder, "d", STEPS).run(StopRequest(), quiet)
    assert (outcome, message) == (Outcome.COMPLETED, "")
    return history(folder)


def test_records_are_all_multiples_of_the_interval_from_zero_on(whole):
    times, records = whole
    assert np.array_equal(times, 0.5 * np.arange(0, STEPS, 10))
    assert np.array_equal(records[0], [0.1, 0.2, 0.3])


@pytest.mark.parametrize("kept", [0, 1, 3])
def test_a_stopped_run_goes_on_bit_for_bit(tmp_path, fake_simulation, whole, kept):
    folder = tmp_path / "stopped"

    class Later(StopRequest):
        calls = 0

        def __bool__(self):
            Later.calls += 1
            return Later.calls > 6

    stop = Later("SIGTERM")
    outcome, message = Advancer(fake_simulation(), folder, "d", STEPS).run(stop, quiet)
    assert outcome is Outcome.INTERRUPTED
    assert "SIGTERM" in message
    written = list(read_segments(folder))
    assert len(written) > 3
    # a kill may leave any prefix, the next segment half written, and a temporary file
    for segment in written[kept:]:
        segment_path(folder, segment.number).unlink()
    segment_path(folder, kept).write_bytes(b"PK half a segment")
    (folder / ".segment_000009.npz.77.tmp").write_bytes(b"")
    second = Advancer(fake_simulation(), folder, "d", STEPS)
    done = second.resume()
    assert done == (written[kept - 1].header["step_index"] if kept else 0)
    assert second.restart_reason == ("" if kept else "the results of an earlier run are damaged")
    outcome, _ = second.run(StopRequest(), quiet)
    assert outcome is Outcome.COMPLETED
    times, records = history(folder)
    assert np.array_equal(times, whole[0])
    assert np.array_equal(records, whole[1])


def test_other_inputs_start_anew(tmp_path, fake_simulation, whole):
    folder = tmp_path / "run"
    Advancer(fake_simulation(), folder, "old", 500).run(StopRequest(), quiet)
    fresh = Advancer(fake_simulation(), folder, "d", STEPS)
    assert fresh.resume() == 0
    assert "other inputs" in fresh.restart_reason
    fresh.run(StopRequest(), quiet)
    assert np.array_equal(history(folder)[1], whole[1])


def test_a_diverging_run_keeps_what_came_before(tmp_path, fake_simulation):
    simulation = fake_simulation()
    simulation.diverge_at = 153
    outcome, message = Advancer(simulation, tmp_path, "d", STEPS).run(StopRequest(), quiet)
    assert outcome is Outcome.NOT_FINITE
    assert "step 153" in message
    assert len(history(tmp_path)[0]) == 16


def test_a_full_disk_keeps_the_earlier_segments_and_goes_on_later(
    tmp_path, fake_simulation, whole, monkeypatch
):
    folder = tmp_path / "run"
    calls, real = [], os.fsync

    def fsync(descriptor):
        calls.append(descriptor)
        if len(calls) >= 9:
            raise OSError(errno.ENOSPC, "No space left on device")
        real(descriptor)

    monkeypatch.setattr(os, "fsync", fsync)
    with pytest.raises(StopError, match="continues from there") as caught:
        Advancer(fake_simulation(), folder, "d", STEPS).run(StopRequest(), quiet)
    assert caught.value.outcome is Outcome.DISK_FULL
    monkeypatch.setattr(os, "fsync", real)
    kept = history(folder)
    assert np.array_equal(kept[1], whole[1][: len(kept[1])])
    again = Advancer(fake_simulation(), folder, "d", STEPS)
    assert again.resume() > 0
    again.run(StopRequest(), quiet)
    assert np.array_equal(history(folder)[1], whole[1])


def test_pieces_grow_towards_the_wanted_time():
    assert next_piece(100, 0.0) == 400
    assert next_piece(100, 0.5 * advance.PIECE_SECONDS) == 200
    assert next_piece(100, 10.0 * advance.PIECE_SECONDS) == 10
    assert next_piece(1, 100.0) == 1
