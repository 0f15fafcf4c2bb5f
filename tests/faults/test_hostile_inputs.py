"""Inputs that end a program which reads them naively: long numbers, denormal ones, damaged files, many copies."""

from __future__ import annotations

import json
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

from heavylift.numerics import hdf5_files
from heavylift.numerics.outcome import InputError, InputErrors
from heavylift.pipeline import load_case
from heavylift.pipeline.case.columns import finite_rows
from heavylift.pipeline.results.histories import Segment, _arrays, _checksum, read_segments, segment_path
from heavylift.preprocess.finite_elements.named_files import refuse_foreign_files

DATABASE = Path(__file__).parents[2] / "cases" / "sphere_decay" / "sphere.nc"


def test_a_cell_longer_than_a_table_reader_takes(heavylift, small_case):
    """Python's reader of tables stops at 131,072 characters with an error of its own."""
    (small_case / "r.csv").write_text("time,x,y,z\n0," + "1" * 200_000 + ",0,0\n1,0,0,0\n")
    with (small_case / "case.toml").open("a") as file:
        file.write('[[reference]]\nname = "a"\nchannel = "beam.position"\nfile = "r.csv"\n')
    result = heavylift("mesh", small_case)
    assert result.code == 2
    assert "r.csv: line 2" in result.error
    assert len(result.error) < 2000
    with pytest.raises(InputError, match="4 finite numbers"):
        list(finite_rows([(2, '0,"' + "1" * 200_000)], 4, small_case / "r.csv"))


@pytest.mark.parametrize("step", ["5e-324", "1e-310", "1e-300", '"1e-320 s"'])
def test_a_step_that_no_number_counts(heavylift, small_case, step):
    changes = (f"simulate.step={step}", f"simulate.output_interval={step}")
    result = heavylift("simulate", small_case, *(word for one in changes for word in ("--set", one)))
    assert result.code == 2
    assert "steps of" in result.error
    assert "at most 1e+15" in result.error


def segment(folder, change):
    """A segment with a checksum that fits whatever is in it."""
    header = {"first_record": 0, "digest": "d", "channels": []}
    arrays = _arrays(Segment(0, header, np.zeros(2), np.zeros((2, 1)), {}))
    arrays = {key: value for key, value in {**arrays, **change}.items() if value is not None}
    with segment_path(folder, 0).open("wb") as stream:
        np.savez(stream, checksum=np.array(_checksum(arrays)), **arrays)
    return list(read_segments(folder))


@pytest.mark.parametrize(
    "change",
    [
        {"header": np.array("no JSON")},
        {"header": np.array("[" * 100_000)},
        {"header": np.array("[]")},
        {"header": np.array("7")},
        {"header": np.array(json.dumps({"number": 0}))},
        {"header": None},
        {"times": None},
        {"records": None},
        {"times": np.zeros(3)},
        {"times": np.array(["a", "b"])},
        {"records": np.zeros(2)},
    ],
)
def test_a_segment_that_says_something_else_ends_the_run_before_it(tmp_path, change):
    assert len(segment(tmp_path, {})) == 1
    assert segment(tmp_path, change) == []


def test_no_file_of_a_case_is_opened_before_another_process_has_read_it(monkeypatch, tmp_path):
    """The library in C may crash on a damaged file, or raise errors of any type."""
    path = tmp_path / "b.nc"
    path.write_bytes(DATABASE.read_bytes())

    def refused(*_arguments, **_more):
        raise AssertionError("opened in this process")

    monkeypatch.setattr(h5py, "File", refused)
    for program in (
        "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)",
        "raise TypeError",
        hdf5_files.SURVEY,
    ):
        monkeypatch.setattr(hdf5_files, "SURVEY", program)
        hdf5_files._survey.cache_clear()
        refuse_foreign_files(path, tmp_path)  # the reader tells what is wrong
    hdf5_files._survey.cache_clear()


@pytest.mark.slow
def test_flipped_bits_of_a_database_are_refused_or_harmless(heavylift, tmp_path):
    """From the case file on: each bit of the first tables of the file in turn, at random."""
    content, rng = DATABASE.read_bytes(), np.random.default_rng(4)
    path = tmp_path / "b.nc"
    for at in rng.integers(0, 3000, 40):
        damaged = bytearray(content)
        damaged[at] ^= 1 << int(rng.integers(8))
        path.write_bytes(damaged)
        refuse_foreign_files(path, tmp_path)


TABLES = """
[[repeat]]
count = {count}
[[repeat.ropes]]
name = "{name}"
"""


@pytest.mark.parametrize("name", ["a{i}", "a"])
def test_errors_of_copies_are_told_in_a_time_that_grows_with_their_number(small_case, name):
    text, seconds = (small_case / "case.toml").read_text(), []
    for count in (1000, 4000):
        (small_case / "case.toml").write_text(text + TABLES.format(count=count, name=name))
        begin = time.process_time()
        with pytest.raises(InputErrors) as caught:
            load_case(small_case)
        seconds.append(time.process_time() - begin)
        assert "repeat.0.ropes.0.path: is missing (i = 0)" in str(caught.value)
        assert len(caught.value.errors) <= 3
    assert seconds[1] < 9.0 * seconds[0]  # 4 times as many; 16 times as long if each looks at all others


def test_blocks_count_together(small_case):
    """Each block may have 100,000 copies; a hundred such blocks are ten million tables."""
    with (small_case / "case.toml").open("a") as file:
        file.writelines(TABLES.format(count=100_000, name=f"r{k}_{{i}}") for k in range(100))
    begin = time.process_time()
    with pytest.raises(
        InputErrors, match=r"repeat\.2\.count: .* 300,000 tables in all; expected at most 200,000"
    ):
        load_case(small_case)
    assert time.process_time() - begin < 10.0


def test_large_tables_count_by_what_is_in_them(small_case):
    with (small_case / "case.toml").open("a") as file:
        file.write(TABLES.format(count=50_000, name="r{i}") + f"length = {json.dumps('x' * 20_000)}\n")
    with pytest.raises(InputErrors, match=r"repeat\.0\.count: .* keys and values in all"):
        load_case(small_case)


@pytest.mark.slow
def test_numbers_at_the_ends_of_a_machine(monkeypatch):
    import sys

    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    sys.modules.pop("soak_numbers", None)
    from soak_numbers import run

    lines = []
    counts = run(60, 5, lines.append)
    assert not counts["failures"], lines
    assert counts["refused"] > 10
