"""Time histories on disk while they grow: numbered segments, each with the state to go on from.

A segment is one file, replaced in one step, that holds some records and the complete state after the
last of them. So whenever a process is killed, the segments on disk form a consistent prefix of the run
and its last segment is the checkpoint; there is nothing that could disagree with it.
"""

from __future__ import annotations

import json
import zipfile
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.pipeline.results.storage import digest_bytes, replacing

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["Segment", "last_segment", "read_segments", "remove_segments", "write_segment"]

SUFFIX = ".npz"
STATE_PREFIX = "state."


class Segment(NamedTuple):
    """Some records of a run.

    Attributes
    ----------
    number
        Position in the run, from 0.
    header
        Plain values: digest of the inputs, channels, ``first_record``, ``step_index`` reached, ``cpu_s`` so far.
    times
        [s], shape (nr,).
    records
        Shape (nr, number of columns), SI.
    state
        State of the simulation after the last step of this segment.
    """

    number: int
    header: dict[str, Any]
    times: NDArray[np.float64]
    records: NDArray[np.float64]
    state: dict[str, NDArray[Any]]


def segment_path(folder: Path, index: int) -> Path:
    """File of a segment."""
    return folder / f"segment_{index:06d}{SUFFIX}"


def write_segment(folder: Path, segment: Segment) -> None:
    """Write one segment in one step.

    Raises
    ------
    StopError
        If the disk is full; earlier segments are intact.
    """
    arrays = _arrays(segment)
    checksum = _checksum(arrays)
    with replacing(segment_path(folder, segment.number)) as temporary, temporary.open("wb") as stream:
        np.savez(stream, allow_pickle=False, checksum=np.array(checksum), **arrays)


def read_segments(folder: Path) -> Iterator[Segment]:
    """All segments of the consistent prefix, in order.

    A segment that is missing, damaged or does not continue its predecessor ends the prefix.
    """
    index, records, digest = 0, 0, None
    while True:
        segment = _read_segment(segment_path(folder, index), index)
        if segment is None or segment.header["first_record"] != records:
            return
        if digest is not None and segment.header["digest"] != digest:
            return
        yield segment
        digest = segment.header["digest"]
        records += len(segment.times)
        index += 1


def last_segment(folder: Path) -> Segment | None:
    """Last segment of the consistent prefix: the checkpoint; None if there is none."""
    last = None
    for segment in read_segments(folder):
        last = segment
    return last


def remove_segments(folder: Path, *, after: int = -1) -> None:
    """Remove the segments whose index exceeds `after`, the last one first, and files left over by a kill."""
    if not folder.is_dir():
        return
    paths = sorted(folder.glob(f"segment_*{SUFFIX}"), reverse=True)
    for path in paths:
        if int(path.stem.rpartition("_")[2]) > after:
            path.unlink()
    for path in folder.glob(".*.tmp"):
        path.unlink()
    if after < 0:
        folder.rmdir()


def _arrays(segment: Segment) -> dict[str, NDArray[Any]]:
    return {
        "header": np.array(json.dumps({"number": segment.number, **segment.header})),
        "times": np.ascontiguousarray(segment.times),
        "records": np.ascontiguousarray(segment.records),
        **{f"{STATE_PREFIX}{key}": np.asarray(value) for key, value in segment.state.items()},
    }


def _checksum(arrays: Mapping[str, NDArray[Any]]) -> str:
    parts = []
    for key in sorted(arrays):
        array = arrays[key]
        parts += [f"{key} {array.dtype.str} {array.shape}".encode(), array.tobytes()]
    return digest_bytes(*parts)


def _read_segment(path: Path, index: int) -> Segment | None:
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            arrays = {key: file[key] for key in file.files}
    except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile, zipfile.LargeZipFile):
        return None
    if str(arrays.pop("checksum", "")) != _checksum(arrays):
        return None
    header = json.loads(str(arrays.pop("header")))
    if header.pop("number") != index:
        return None
    times, records = arrays.pop("times"), arrays.pop("records")
    state = {key.removeprefix(STATE_PREFIX): value for key, value in arrays.items()}
    return Segment(index, header, times, records, state)
