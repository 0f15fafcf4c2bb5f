"""Files are whole or absent, whatever happens while they are written."""

from __future__ import annotations

import errno
import os

import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.results.storage import (
    StopError,
    digest_file,
    digest_json,
    read_json,
    replacing,
    write_json,
)


def names(folder):
    return [path.name for path in folder.iterdir()]


def test_a_file_is_replaced_in_one_step(tmp_path):
    path = tmp_path / "deep" / "file.txt"
    with replacing(path) as temporary:
        temporary.write_text("new")
        assert not path.exists()
    assert path.read_text() == "new"
    assert names(path.parent) == ["file.txt"]


def test_an_error_while_writing_leaves_the_old_file_and_no_other(tmp_path):
    path = tmp_path / "file.txt"
    path.write_text("old")

    def fail():
        with replacing(path) as temporary:
            temporary.write_text("half")
            raise RuntimeError("power")

    with pytest.raises(RuntimeError, match="power"):
        fail()
    assert path.read_text() == "old"
    assert names(tmp_path) == ["file.txt"]


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT])
def test_a_full_disk_is_an_outcome_and_loses_nothing(tmp_path, monkeypatch, number):
    path = tmp_path / "file.json"
    write_json(path, {"a": 1})

    def full(_descriptor):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(StopError, match="no space left") as caught:
        write_json(path, {"a": 2})
    assert caught.value.outcome is Outcome.DISK_FULL
    assert read_json(path) == {"a": 1}
    assert names(tmp_path) == ["file.json"]


def test_other_errors_of_the_system_keep_their_name(tmp_path):
    (tmp_path / "x").write_text("")
    with pytest.raises(FileExistsError):
        write_json(tmp_path / "x" / "y", {})


def test_damaged_json_counts_as_absent(tmp_path):
    path = tmp_path / "a.json"
    assert read_json(path) is None
    path.write_text('{"a": ')
    assert read_json(path) is None


def test_digests_tell_content_and_nothing_else(tmp_path):
    assert digest_json({"a": 1.0, "b": [1, 2]}) == digest_json({"b": [1, 2], "a": 1.0})
    assert digest_json({"a": 1.0}) != digest_json({"a": 1.0 + 2**-52})
    (tmp_path / "a").write_bytes(b"x" * 100_000)
    (tmp_path / "b").write_bytes(b"x" * 99_999 + b"y")
    assert digest_file(tmp_path / "a") != digest_file(tmp_path / "b")
