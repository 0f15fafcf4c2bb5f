"""Segments on disk are a consistent prefix of the run, however it ended."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.pipeline.results.histories import (
    Segment,
    read_segments,
    remove_segments,
    segment_path,
    write_segment,
)


def segment(number: int, digest: str = "d") -> Segment:
    times = np.arange(5.0) + 5 * number
    records = np.column_stack([times, np.sin(times)])
    header = {"digest": digest, "first_record": 5 * number, "channels": []}
    return Segment(number, header, times, records, {"q": np.array([number, 0.1]), "n": np.array(3)})


def test_what_was_written_is_read_bit_for_bit(tmp_path):
    for number in range(3):
        write_segment(tmp_path, segment(number))
    found = list(read_segments(tmp_path))
    assert [item.number for item in found] == [0, 1, 2]
    for item in found:
        original = segment(item.number)
        assert np.array_equal(item.records, original.records)
        assert np.array_equal(item.state["q"], original.state["q"])
        assert item.state["n"].shape == ()
        assert item.header == original.header


@pytest.mark.parametrize("damage", ["truncate", "flip", "remove", "other inputs", "gap"])
def test_the_prefix_ends_before_what_does_not_fit(tmp_path, damage):
    for number in range(4):
        write_segment(tmp_path, segment(number, "other" if damage == "other inputs" and number == 2 else "d"))
    path = segment_path(tmp_path, 2)
    data = bytearray(path.read_bytes())
    if damage == "truncate":
        path.write_bytes(data[: len(data) // 2])
    elif damage == "flip":
        place = data.index(np.sin(11.0).tobytes())
        data[place] ^= 1
        path.write_bytes(data)
    elif damage == "remove":
        path.unlink()
    elif damage == "gap":
        write_segment(
            tmp_path, segment(2)._replace(header={"digest": "d", "first_record": 11, "channels": []})
        )
    assert [item.number for item in read_segments(tmp_path)] == [0, 1]
    assert list(read_segments(tmp_path))[-1].number == 1


def test_removal_keeps_what_is_asked_for(tmp_path):
    folder = tmp_path / "segments"
    for number in range(4):
        write_segment(folder, segment(number))
    (folder / ".segment_000004.npz.1.tmp").write_bytes(b"half")
    remove_segments(folder, after=1)
    assert sorted(path.name for path in folder.iterdir()) == ["segment_000000.npz", "segment_000001.npz"]
    remove_segments(folder)
    assert not folder.exists()
    remove_segments(folder)
