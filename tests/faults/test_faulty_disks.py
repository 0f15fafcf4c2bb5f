"""Files of a run that vanish, change or find no space: nothing is whole that only says so, nothing good is removed."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
import time
from itertools import pairwise

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline import load_results
from heavylift.pipeline.results import histories
from heavylift.pipeline.results.histories import (
    ChannelInfo,
    Segment,
    merge_segments,
    numbers_on_disk,
    read_segments,
    segment_path,
    write_segment,
)
from heavylift.pipeline.results.storage import OutputFolder, StopError, read_json
from heavylift.pipeline.stages import advance

SHORT = ("--set", "simulate.duration=6 ms")


@pytest.fixture
def reference(heavylift, small_case):
    """Records of the same run, on a sound disk."""
    assert heavylift("simulate", small_case, *SHORT, "--quiet", "--out", small_case / "whole").code == 0
    return load_results(small_case / "whole")


@pytest.fixture
def often(monkeypatch):
    """A segment every 500 steps."""
    monkeypatch.setattr(advance, "SEGMENT_SECONDS", 0.0)
    monkeypatch.setattr(advance, "FIRST_PIECE", 500)
    monkeypatch.setattr(advance, "next_piece", lambda _piece, _seconds, _growth: 500)


def same(found, reference):
    assert np.array_equal(found.time, reference.time)
    assert list(found) == list(reference)
    for name in reference:
        assert np.array_equal(found[name], reference[name]), name


def damage(path, how, folder):
    """What can happen to a file of a run."""
    data = bytearray(path.read_bytes())
    if how == "removed":
        path.unlink()
    elif how == "a bit":
        place = data.index(b"records.npy") + 400  # behind the header of this array
        data[place] ^= 1
        path.write_bytes(data)
    elif how == "shorter":
        path.write_bytes(data[:-100])
    elif how == "another":  # whole in itself, with records that this run has not written
        found = next(s for s in read_segments(folder) if segment_path(folder, s.number) == path)
        write_segment(folder, found._replace(records=found.records + 1.0))
    elif how == "a pipe":
        path.unlink()
        os.mkfifo(path)


@pytest.mark.slow
@pytest.mark.parametrize("how", ["removed", "a bit", "shorter", "another", "a pipe"])
def test_a_segment_that_changes_while_the_run_goes_on(
    heavylift, small_case, reference, often, monkeypatch, how
):
    from heavylift.solver.simulation import Simulation

    real, folder = Simulation.advance, OutputFolder(small_case / "out")
    done = []

    def advancing(self, steps):
        if not done and len(numbers_on_disk(folder.segments)) == 6:
            damage(segment_path(folder.segments, 2), how, folder.segments)
            done.append(self.step_index)
        return real(self, steps)

    monkeypatch.setattr(Simulation, "advance", advancing)
    result = heavylift("simulate", small_case, *SHORT)
    assert done
    assert result.code == Outcome.INTERRUPTED
    (line,) = result.error.splitlines()
    assert str(segment_path(folder.segments, 2)) in line
    assert "the same command continues" in line
    assert not folder.results.exists()
    assert read_json(folder.manifest("simulate"))["finished"] is False
    assert set(numbers_on_disk(folder.segments)) >= {0, 1, 3, 4, 5, 6, 7}
    kept = load_results(small_case)
    assert kept.outcome == "unfinished"
    assert np.array_equal(kept.time, reference.time[: len(kept.time)])
    result = heavylift("simulate", small_case, *SHORT)
    assert result.code == 0
    assert "resumed from the checkpoint" in result.out
    assert "WARNING: segment 2 is missing" in result.out
    same(load_results(small_case), reference)
    assert not folder.segments.exists()


@pytest.mark.parametrize("how", ["removed", "a bit", "shorter"])
def test_a_segment_that_changes_after_a_kill(heavylift, small_case, reference, often, monkeypatch, how):
    from heavylift.pipeline.stages import simulate

    class KilledError(BaseException):
        """Ends a process where it stands, as far as the disk is concerned."""

    def killed(*_arguments, **_keywords):
        raise KilledError

    monkeypatch.setattr(simulate, "merge_segments", killed)
    with pytest.raises(KilledError):
        heavylift("simulate", small_case, *SHORT)
    monkeypatch.setattr(simulate, "merge_segments", merge_segments)
    folder = OutputFolder(small_case / "out").segments
    damage(segment_path(folder, 7), how, folder)
    result = heavylift("simulate", small_case, *SHORT)
    assert result.code == 0
    state = "missing" if how == "removed" else "damaged"
    assert f"WARNING: segment 7 is {state}; it is computed again, and 4 behind it" in result.out
    same(load_results(small_case), reference)


def test_a_merged_file_that_reads_back_otherwise(heavylift, small_case, reference, often, monkeypatch):
    real, folder = histories.sync_file, OutputFolder(small_case / "out")

    def faulty(path):
        real(path)
        data = bytearray(path.read_bytes())
        place = data.index(np.ascontiguousarray(reference["beam.modal_position"]).tobytes()[800:900])
        data[place] ^= 4
        path.write_bytes(data)

    monkeypatch.setattr(histories, "sync_file", faulty)
    result = heavylift("simulate", small_case, *SHORT)
    assert result.code == Outcome.INTERRUPTED
    assert "read back" in result.error
    assert len(result.error.splitlines()) == 1
    assert not folder.results.exists()
    assert len(numbers_on_disk(folder.segments)) == 12
    monkeypatch.setattr(histories, "sync_file", real)
    assert heavylift("simulate", small_case, *SHORT).code == 0
    same(load_results(small_case), reference)


@pytest.mark.slow
@pytest.mark.parametrize(
    "place", ["mesh/beam.h5", "modes/beam.h5", "simulate/results.h5", "report/report.md"]
)
def test_a_stored_file_of_the_same_size_with_another_content_is_made_anew(heavylift, small_case, place):
    short = ("--set", "simulate.duration=1 ms")
    command = "run" if place.startswith("report") else "simulate"
    assert heavylift(command, small_case, *short).code == 0
    file, stage = small_case / "out" / place, place.partition("/")[0]
    before, results = file.read_bytes(), load_results(small_case)
    changed = bytearray(before)
    changed[len(changed) // 2] ^= 16
    file.write_bytes(changed)
    result = heavylift(command, small_case, *short)
    assert result.code == 0
    lines = [line for line in result.out.splitlines() if line.startswith(f"{stage}: ")]
    assert not [line for line in lines if "unchanged, skipped" in line], lines
    assert file.read_bytes() != bytes(changed)
    same(load_results(small_case), results)
    skipped = 4 if command == "run" else 3
    assert heavylift(command, small_case, *short).out.count("unchanged, skipped") == skipped


def test_a_bit_that_is_wrong_later_is_an_error_of_whoever_reads_it(heavylift, small_case):
    assert heavylift("simulate", small_case, "--set", "simulate.duration=1 ms").code == 0
    file = OutputFolder(small_case / "out").results
    data = bytearray(file.read_bytes())
    values = load_results(small_case)["beam.modal_position"]
    data[data.index(np.ascontiguousarray(values).tobytes())] ^= 1
    file.write_bytes(data)
    from heavylift.numerics.outcome import InputError

    with pytest.raises(InputError, match="is damaged") as caught:
        load_results(small_case)["beam.modal_position"]
    assert "--force" in str(caught.value)


LIMITED = """
import resource, sys
from heavylift.pipeline.stages import advance
advance.SEGMENT_SECONDS = 0.0
advance.FIRST_PIECE = 500
advance.next_piece = lambda piece, seconds, growth: 500
from heavylift.pipeline.commands.start import main
limit = int(sys.argv.pop(1))
resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
main()
"""
"""The command line with a limit of the size of files, and with segments that are small."""


def limited(limit, *tokens):
    command = [sys.executable, "-c", LIMITED, str(limit), *map(str, tokens)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_no_space_for_the_merged_file(heavylift, small_case, reference):
    assert heavylift("modes", small_case).code == 0
    done = limited(70_000, "simulate", small_case, *SHORT)
    assert done.returncode == Outcome.DISK_FULL, done.stderr
    (line,) = done.stderr.splitlines()
    assert "results.h5" in line
    folder = OutputFolder(small_case / "out")
    assert len(numbers_on_disk(folder.segments)) == 12
    assert not list(folder.stage("simulate").glob(".*.tmp"))
    assert read_json(folder.manifest("simulate"))["outcome"] == "disk_full"
    assert heavylift("simulate", small_case, *SHORT).code == 0
    same(load_results(small_case), reference)


@pytest.mark.slow
@pytest.mark.parametrize("limit", [0, 100, 3_000, 20_000, 60_000])
def test_no_space_in_any_stage_is_told_as_such(small_case, limit):
    done = limited(limit, "run", small_case, "--set", "simulate.duration=1 ms", "--json")
    assert done.returncode == Outcome.DISK_FULL, done.stderr
    assert "Traceback" not in done.stderr
    assert "no space left" in done.stderr
    assert json.loads(done.stdout)["outcome"] == "disk_full"


@pytest.mark.slow
@pytest.mark.parametrize(("asked", "outcome"), [(["mesh"], 0), (["schema", "ropes"], int(Outcome.DISK_FULL))])
def test_standard_output_that_is_full(small_case, asked, outcome):
    """A run does not mind that its log is lost; a table that was asked for is."""
    with open("/dev/full", "w") as full:  # noqa: PTH123
        folder = [str(small_case)] if asked == ["mesh"] else []
        command = [sys.executable, "-c", LIMITED, "-1", *asked, *folder]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == outcome, done.stderr
    assert "Traceback" not in done.stderr
    assert len(done.stderr.splitlines()) == 1


def segments_of(folder, records, channels, width, count=3):
    """Random records in some segments, their channels, and the marks."""
    infos = [
        ChannelInfo(f"body{i // 20}.channel{i % 20}", "m", tuple("xyz"[:width]), i * width)
        for i in range(channels)
    ]
    values = np.random.default_rng(1).random((records, channels * width))
    marks, bounds = [], np.linspace(0, records, count + 1).astype(int)
    for number, (first, end) in enumerate(pairwise(bounds)):
        header = {"digest": "d", "channels": [], "first_record": int(first), "step_index": int(end)}
        part = Segment(number, header, 0.1 * np.arange(first, end), values[first:end], {"a": np.zeros(3)})
        marks.append(write_segment(folder, part))
    return infos, values, marks


def merged(folder, infos, marks):
    words = {info.name: "a sentence about what this channel holds" for info in infos}
    merge_segments(folder / "segments", folder / "results.h5", infos, words, {"title": "t"}, expected=marks)
    return folder / "results.h5"


@pytest.mark.slow
@pytest.mark.parametrize(("records", "channels", "width"), [(301, 400, 3), (7, 300, 1), (6001, 20, 3)])
def test_the_merged_file_is_hardly_larger_than_its_records(tmp_path, records, channels, width):
    infos, values, marks = segments_of(tmp_path / "segments", records, channels, width)
    file = merged(tmp_path, infos, marks)
    raw = 8 * records * (1 + channels * width)
    assert file.stat().st_size < raw + 700 * channels + 20_000
    found = load_results(file)
    assert np.array_equal(found.time, 0.1 * np.arange(records))
    for info in infos:
        columns = values[:, info.column : info.column + width]
        assert np.array_equal(found[info.name].reshape(records, width), columns)


def test_batches_and_pieces_do_not_change_what_is_merged(tmp_path, monkeypatch):
    monkeypatch.setattr(histories, "BATCH", 5_000)
    monkeypatch.setattr(histories, "CHUNK", 1_000)
    infos, values, marks = segments_of(tmp_path / "segments", 503, 4, 3, count=11)
    found = load_results(merged(tmp_path, infos, marks))
    for info in infos:
        assert np.array_equal(found[info.name], values[:, info.column : info.column + 3])


@pytest.mark.slow
@pytest.mark.parametrize("fault", [errno.ENOSPC, errno.EFBIG, errno.EDQUOT])
def test_a_write_that_fails_anywhere_while_merging(tmp_path, monkeypatch, fault):
    infos, values, marks = segments_of(tmp_path / "segments", 40, 100, 3)
    real, calls = os.pwrite, []

    def pwrite(handle, data, offset):
        calls.append(offset)
        if len(calls) > allowed:
            raise OSError(fault, os.strerror(fault))
        return real(handle, data, offset)

    monkeypatch.setattr(os, "pwrite", pwrite)
    allowed = 10**9
    merged(tmp_path, infos, marks)
    count = len(calls)
    assert count > 100
    (tmp_path / "results.h5").unlink()
    for allowed in (0, 1, 2, 10, count // 2, count - 2, count - 1):  # noqa: B007
        calls.clear()
        with pytest.raises(StopError, match="no space left") as caught:
            merged(tmp_path, infos, marks)
        assert caught.value.outcome is Outcome.DISK_FULL
        assert [path.name for path in tmp_path.iterdir()] == ["segments"]
    monkeypatch.undo()
    found = load_results(merged(tmp_path, infos, marks))
    assert np.array_equal(found[infos[-1].name], values[:, -3:])


def test_space_is_taken_before_the_first_write(tmp_path, monkeypatch):
    infos, _, marks = segments_of(tmp_path / "segments", 40, 30, 3)
    asked = []

    def full(_handle, offset, size):
        asked.append((offset, size))
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "posix_fallocate", full)
    monkeypatch.setattr(os, "pwrite", lambda *_arguments: pytest.fail("written"))
    with pytest.raises(StopError, match="no space left"):
        merged(tmp_path, infos, marks)
    ((offset, size),) = asked
    assert offset == 0
    assert size >= 8 * 40 * 91


def test_short_runs_have_checkpoints(heavylift, small_case, monkeypatch):
    from heavylift.solver.simulation import Simulation

    assert heavylift("modes", small_case).code == 0
    real, folder = Simulation.advance, OutputFolder(small_case / "out")
    begin, seen = [], []

    def slow(self, steps):
        begin.append(time.monotonic())
        seen.append((begin[-1] - begin[0], len(numbers_on_disk(folder.segments))))
        time.sleep(0.1)
        return real(self, steps)

    monkeypatch.setattr(Simulation, "advance", slow)
    monkeypatch.setattr(advance, "next_piece", lambda _piece, _seconds, _growth: 300)
    assert heavylift("simulate", small_case, *SHORT).code == 0
    assert max(count for at, count in seen if at < 1.5) >= 1
    assert max(count for _, count in seen) <= 5  # and no more than they are worth


def test_what_dead_processes_left_is_removed(heavylift, small_case):
    assert heavylift("mesh", small_case).code == 0
    process = subprocess.Popen(["true"])
    process.wait()
    folder = small_case / "out" / "mesh"
    left = folder / f".beam.h5.{process.pid}.tmp"
    used = folder / f".beam.h5.{os.getppid()}.tmp"
    own = folder / ".notes.tmp"
    for path in (left, used, own):
        path.write_bytes(b"half")
    assert heavylift("mesh", small_case).code == 0
    assert not left.exists()
    assert used.exists()
    assert own.exists()


def test_a_run_that_was_killed_when_all_was_done_leaves_no_segments(
    heavylift, small_case, often, monkeypatch
):
    from heavylift.pipeline.stages import simulate

    monkeypatch.setattr(simulate, "remove_segments", lambda *_arguments: None)
    assert heavylift("simulate", small_case, *SHORT).code == 0
    monkeypatch.undo()
    segments = OutputFolder(small_case / "out").segments
    assert segments.exists()
    assert "unchanged, skipped" in heavylift("simulate", small_case, *SHORT).out
    assert not segments.exists()


@pytest.mark.parametrize("kept", [0, 1, 3])
def test_a_write_that_fails_while_a_model_is_written(tmp_path, monkeypatch, kept):
    from heavylift.pipeline.results.model_io import replacing_hdf5

    file = tmp_path / "model.h5"
    file.write_bytes(b"the old one")
    real, calls = os.pwrite, []

    def pwrite(handle, data, offset):
        calls.append(offset)
        if len(calls) > kept:
            raise OSError(errno.EFBIG, os.strerror(errno.EFBIG))
        return real(handle, data, offset)

    monkeypatch.setattr(os, "pwrite", pwrite)

    def write():
        with replacing_hdf5(file) as target:
            for number in range(40):  # far more than HDF5 keeps in memory, and read again while it writes
                target.create_dataset(f"a{number}", data=np.arange(200_000.0))
                assert target[f"a{number // 2}"].shape == (200_000,)
                target.flush()

    with pytest.raises(StopError, match="no space left"):
        write()
    assert len(calls) > kept
    assert file.read_bytes() == b"the old one"
    assert list(tmp_path.iterdir()) == [file]
