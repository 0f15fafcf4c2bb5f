"""Time histories on disk: while they grow in numbered segments, each with the state to continue from; by name and unit.

A segment is one file, replaced in one step, that holds some records and the complete state after the last of them. So
whenever a process is killed, the segments on disk form a consistent prefix of the run and its last segment is the
checkpoint; there is nothing that could disagree with it. Histories are read from a finished run, or from what a stopped
one left.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import re
import zipfile
import zlib
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.numerics.units import Kind, parse_unit
from heavylift.numerics.words import nearest
from heavylift.pipeline.case.channel_names import (
    combination_of,
    combined_kind,
    fitting,
    patterns_in,
    split_name,
    substituted,
)
from heavylift.pipeline.results.mesh_results import MeshShape, read_meshes, write_meshes
from heavylift.pipeline.results.model_io import open_hdf5
from heavylift.pipeline.results.storage import (
    OutputFolder,
    StopError,
    digest_bytes,
    hdf5_stream,
    remove_left_over,
    replacing,
    sync_file,
)
from heavylift.pipeline.results.tables import data_frame, dataset

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case

__all__ = [
    "ChannelInfo",
    "Results",
    "Segment",
    "SegmentMark",
    "load_results",
    "merge_segments",
    "read_segments",
    "remove_segments",
    "write_segment",
]

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
    checksum
        Of all this, once it is on disk.
    """

    number: int
    header: dict[str, Any]
    times: NDArray[np.float64]
    records: NDArray[np.float64]
    state: dict[str, NDArray[Any]]
    checksum: str = ""

    @property
    def mark(self) -> SegmentMark:
        """By what it is known again."""
        return SegmentMark(len(self.times), self.checksum)


class SegmentMark(NamedTuple):
    """What a run remembers of a segment that it has written: how many records, and the checksum of all it holds."""

    records: int
    checksum: str


def segment_path(folder: Path, index: int) -> Path:
    """File of a segment."""
    return folder / f"segment_{index:06d}{SUFFIX}"


def write_segment(folder: Path, segment: Segment) -> SegmentMark:
    """Write one segment in one step.

    Returns
    -------
    SegmentMark
        By which `merge_segments` knows it again.

    Raises
    ------
    StopError
        If the disk is full; earlier segments are intact.
    """
    arrays = _arrays(segment)
    checksum = _checksum(arrays)
    with replacing(segment_path(folder, segment.number)) as temporary, temporary.open("wb") as stream:
        # before NumPy 2.2 a word on pickles would be an array of that name
        np.savez(stream, checksum=np.array(checksum), **arrays)  # type: ignore[arg-type]
    return SegmentMark(len(segment.times), checksum)


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


_ASIDE = ".damaged"
_NAME = re.compile(rf"^segment_(\d+){re.escape(SUFFIX)}$")


def numbers_on_disk(folder: Path) -> list[int]:
    """Numbers of the files of segments, whole or damaged, in order."""
    matches = [_NAME.match(path.name) for path in folder.glob(f"segment_*{SUFFIX}")]
    return sorted(int(match[1]) for match in matches if match)


def remove_segments(folder: Path, *, after: int = -1) -> None:
    """Remove the segments whose index exceeds `after`, the last one first, and files left over by a kill.

    The folder goes with the last of them, if nothing else is in it.
    """
    if not folder.is_dir():
        return
    for number in reversed(numbers_on_disk(folder)):
        if number > after:
            segment_path(folder, number).unlink()
    remove_left_over(folder, alone=True)
    if after < 0:
        for path in folder.glob(f"segment_*{SUFFIX}{_ASIDE}"):
            path.unlink()
        with contextlib.suppress(OSError):
            folder.rmdir()


def _arrays(segment: Segment) -> dict[str, NDArray[Any]]:
    return {
        "header": np.array(json.dumps({"number": segment.number, **segment.header})),
        "times": np.ascontiguousarray(segment.times),
        "records": np.ascontiguousarray(segment.records),
        **{f"{STATE_PREFIX}{key}": np.asarray(value) for key, value in segment.state.items()},
    }


def _checksum(arrays: Mapping[str, NDArray[Any]]) -> str:
    parts: list[bytes | memoryview] = []
    for key in sorted(arrays):
        array = arrays[key]
        content = np.ascontiguousarray(array).reshape(-1).view(np.uint8)  # as it is, without a copy
        parts += [f"{key} {array.dtype.str} {array.shape}".encode(), content.data]
    return digest_bytes(*parts)


# what readers of NumPy, zip and its compression raise of a file with other bits
_DAMAGED = (
    OSError,
    ValueError,
    EOFError,
    KeyError,
    IndexError,
    NotImplementedError,
    RuntimeError,
    SyntaxError,
    TypeError,
    MemoryError,
)


def _read_segment(path: Path, index: int) -> Segment | None:
    if not path.is_file():
        return None
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            arrays = {key: file[key] for key in file.files}
    except (*_DAMAGED, zipfile.BadZipFile, zipfile.LargeZipFile):
        return None
    checksum = str(arrays.pop("checksum", ""))
    if checksum != _checksum(arrays):
        return None
    try:
        header = json.loads(str(arrays.pop("header")))
        times, records = arrays.pop("times"), arrays.pop("records")
        stated = header.pop("number"), header["first_record"], header["digest"], header["channels"]
    except (
        KeyError,
        ValueError,
        TypeError,
        AttributeError,
        RecursionError,
    ):  # no table, or not all that it says
        return None
    shaped = times.ndim == 1 and records.ndim == 2 and len(records) == len(times)
    if stated[0] != index or not shaped or {times.dtype.kind, records.dtype.kind} != {"f"}:
        return None
    state = {key.removeprefix(STATE_PREFIX): value for key, value in arrays.items()}
    return Segment(index, header, times, records, state, checksum)


FORMAT = "heavylift results 1"


class ChannelInfo(NamedTuple):
    """Where a channel lies in the records.

    Attributes
    ----------
    name, unit
        E.g. ``"beam.modal_position"``, ``"m kg^0.5"``.
    components
        Names of its columns; a single empty name makes a channel of plain numbers.
    column
        First column.
    """

    name: str
    unit: str
    components: tuple[str, ...]
    column: int


class Results:
    """Named arrays of one simulation.

    Parameters
    ----------
    source
        File or folder they come from.
    time
        Times of the records [s], shape (nr,).
    channels
        Name, unit and components of every channel.
    columns
        Reads the array of a channel, shape (nr, components), by name.
    metadata
        Outcome, step, digests, versions and sources.
    meshes
        File with the shapes of frames and shells, if there may be one.

    Examples
    --------
    >>> import heavylift as hl
    >>> results = hl.load("cases/hoist").run()
    >>> results["load.position"].shape, results.components("load.position"), results.unit("load.position")
    ((101, 3), ('x', 'y', 'z'), 'm')
    """

    def __init__(
        self,
        source: Path,
        time: NDArray[np.float64],
        channels: Mapping[str, ChannelInfo],
        columns: Mapping[str, Any],
        metadata: Mapping[str, Any],
        meshes: Path | None = None,
    ) -> None:
        self.source = source
        self._mesh_file = meshes
        self.time = time
        self.metadata = dict(metadata)
        self._channels = dict(channels)
        self._columns = columns
        self._combinations: dict[str, tuple[NDArray[np.float64], ChannelInfo]] = {}

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Array of a channel in SI: shape (nr,) for one number a record, else (nr, components); read-only.

        The name may be that of a combination of channels, see `heavylift.pipeline.case.channel_names`; a ratio is not a
        number at records where its second term is zero.
        """
        if name not in self._channels:
            found = self._combined(name)[0].view()
        else:
            array: NDArray[np.float64] = self._columns[name]
            found = array[:, 0] if len(self._channels[name].components) == 1 else array[:]
        found.flags.writeable = False  # checks and criteria judge the same numbers
        return found

    def __iter__(self) -> Iterator[str]:
        return iter(self._channels)

    def __len__(self) -> int:
        return len(self._channels)

    def __contains__(self, name: object) -> bool:
        if name in self._channels or not isinstance(name, str) or "(" not in name:
            return name in self._channels
        try:
            self._combined(name)
        except InputError:
            return False
        return True

    def fitting(self, name: str) -> tuple[str, ...]:
        """Channels whose owners fit the pattern in a name, in the order of the records; the name itself without one.

        Raises
        ------
        InputError
            If there are none, or it has several patterns.
        """
        patterns = patterns_in(name)
        if not patterns:
            return (name,)
        if len(patterns) > 1:
            raise InputError(f"{name!r} has {len(patterns)} patterns", expected="one, also several times")
        (pattern,) = patterns
        owners = fitting(
            name,
            pattern,
            (channel.partition(".")[0] for channel in self._channels),
            lambda owner: self.term(substituted(name, pattern, owner)),
        )
        return tuple(substituted(name, pattern, owner) for owner in owners)

    def _combined(self, name: str) -> tuple[NDArray[np.float64], ChannelInfo]:
        """Records of a combination, as `__getitem__` gives them, and what they are."""
        if name in self._combinations:
            return self._combinations[name]
        combination = combination_of(name)
        if combination is None:
            near = nearest(name, self._channels)
            hint = f"; did you mean {near!r}?" if near else ""
            raise InputError(
                f"channel {name!r} does not exist{hint}",
                source=self.told_as,
                expected=f"one of: {', '.join(self._channels)}",
            )
        terms = [
            self.term(one)
            for term in combination.terms
            for one in (self.fitting(term) if combination.function == "sum" else (term,))
        ]
        kinds = [Kind("", info.unit, parse_unit(info.unit)[1]) for _, info in terms]
        unit = combined_kind(name, combination.function, kinds).unit
        first, components = terms[0][0], terms[0][1].components
        for values, info in terms[1:]:
            if values.shape != first.shape or (values.ndim > 1 and info.components != components):
                raise InputError(
                    f"{name!r} combines {len(components)} components with {len(info.components)}",
                    source=self.told_as,
                    expected="channels with the same components, or one component of each",
                )
        values = first
        if combination.function == "sum":
            values = np.sum([one for one, _ in terms], axis=0)
        elif combination.function == "difference":
            values = first - terms[1][0]
        else:
            second = terms[1][0]
            values = np.full(first.shape, np.nan)
            np.divide(first, second, out=values, where=second != 0.0)
        columns = components if values.ndim > 1 else (combination.function,)
        self._combinations[name] = values, ChannelInfo(name, unit, columns, 0)
        return self._combinations[name]

    def term(self, name: str) -> tuple[NDArray[np.float64], ChannelInfo]:
        """Records of a channel, of a component of one, or of a combination."""
        *parts, last = split_name(name)
        whole = ".".join(parts)
        if name in self._channels or not whole or whole not in self:
            return self[name], self.channel(name)
        info = self.channel(whole)
        if last not in info.components:
            raise InputError(
                f"{name!r} does not exist",
                source=self.told_as,
                expected=f"a component: {', '.join(info.components[:20])}",
            )
        values = self[whole]
        column = values if values.ndim == 1 else values[:, info.components.index(last)]
        return column, info._replace(name=name, components=(last,))

    @property
    def told_as(self) -> object:
        """What messages call it: where it comes from."""
        return self.source

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all channels."""
        return tuple(self._channels)

    def extremes(self, name: str, side: str) -> tuple[NDArray[np.float64], str]:
        """What the largest or smallest value of a channel is looked for in, and in words of how many.

        Parameters
        ----------
        name
            Of the channel.
        side
            ``"max"`` or ``"min"``.

        Returns
        -------
        history
            Of every interval between records the extreme over all its steps, where the channel has one beside it
            and the integrator sees every step; else the records. As of the channel itself.
        words
            E.g. ``"40,000 steps"``, ``"401 records"``.
        """
        beside = f"{name}_{side}"
        if beside not in self or not self.metadata.get("sees_every_step", False):
            return self[name], f"{len(self.time):,} records"
        if np.isnan(self[beside]).any():  # nobody asked for it
            return self[name], f"{len(self.time):,} records"
        owner, _, last = name.rpartition(".")
        # what is far from a contour has a gap at records only; surfaces are measured in all steps
        searched = last == "gap" and f"{owner}.contacts" not in self
        near = f" where it was near enough to be searched, and {len(self.time):,} records" if searched else ""
        return self[beside], f"{int(self.metadata['steps']):,} steps{near}"

    @cached_property
    def meshes(self) -> dict[str, MeshShape]:
        """Shapes of the frames and shells of the scene, by name; empty if it has none."""
        if self._mesh_file is None or not self._mesh_file.is_file():
            return {}
        with open_hdf5(self._mesh_file, _REMEDY) as file:
            return read_meshes(file)

    @property
    def mesh_file(self) -> Path | None:
        """The file `meshes` is read from."""
        return self._mesh_file

    @property
    def outcome(self) -> str:
        """How the run ended, e.g. ``"completed"``; ``"unfinished"`` if it was cut off."""
        return str(self.metadata.get("outcome", "unfinished"))

    def to_xarray(self, *names: str) -> Any:
        """Channels, all without names, as an `xarray.Dataset` over ``time``, with units and components.

        See `heavylift.pipeline.results.tables.dataset`; needs the extra ``data``.
        """
        return dataset(self, names or self.names)

    def to_pandas(self, *names: str) -> Any:
        """Channels, all without names, as a `pandas.DataFrame`: a column for each component, the index is the time [s].

        See `heavylift.pipeline.results.tables.data_frame`; needs the extra ``data``.
        """
        return data_frame(self, names or self.names)

    def channel(self, name: str) -> ChannelInfo:
        """Unit and components of a channel or combination; an unknown name is an `InputError`."""
        return self._channels[name] if name in self._channels else self._combined(name)[1]

    def unit(self, name: str) -> str:
        """Unit of a channel, e.g. ``"m/s"``."""
        return self.channel(name).unit

    def components(self, name: str) -> tuple[str, ...]:
        """Names of the columns of a channel."""
        return self.channel(name).components


class _Hdf5Columns(dict[str, Any]):
    """Channels of an HDF5 file, read when they are first asked for."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __missing__(self, name: str) -> NDArray[np.float64]:
        with open_hdf5(self.path, _REMEDY) as file:
            try:
                array: NDArray[np.float64] = file["channels"][name][:]
            except OSError as error:
                raise InputError(
                    f"is damaged: {error}", source=self.path, key=name, expected=f"a whole file; {_REMEDY}"
                ) from None
        self[name] = array
        return array


CHUNK = 2**20
"""Bytes of a channel that are stored together at most; a channel that is smaller is one piece of its own size."""
BATCH = 2**27
"""Bytes of records that are merged, or read back, at once."""

_REMEDY = "make it again with `heavylift simulate CASE --force`"


def load_results(source: Case | Path | str, out: Path | str | None = None) -> Results:
    """Read the time histories of a case.

    Parameters
    ----------
    source
        A case, a case folder, an output folder, or a ``results.h5``.
    out
        Output folder, if it is not the case's own.

    Raises
    ------
    InputError
        If there are no results, or the file is truncated; the message says how to make them.

    Examples
    --------
    >>> import heavylift as hl
    >>> report = hl.run_case(hl.load_case("cases/hoist"), stages=("simulate",))
    >>> print(f"{hl.load_results('cases/hoist')['fall.tension'][0]:.0f} N")
    4905000 N
    """
    file = _results_file(source, out)
    folder = OutputFolder(file.parent.parent)
    if file.exists():
        return _read_merged(file)
    segments = list(read_segments(folder.segments))
    if not segments:
        raise InputError(
            "no results",
            source=file.parent,
            expected="time histories; make them with `heavylift simulate CASE`",
        )
    header = segments[-1].header
    channels = {row[0]: ChannelInfo(row[0], row[1], tuple(row[2]), row[3]) for row in header["channels"]}
    records = np.concatenate([segment.records for segment in segments])
    columns = {
        name: records[:, info.column : info.column + len(info.components)] for name, info in channels.items()
    }
    metadata = {key: value for key, value in header.items() if key not in {"channels", "first_record"}}
    times = np.concatenate([segment.times for segment in segments])
    return Results(folder.segments, times, channels, columns, metadata, folder.meshes)


def _results_file(source: Case | Path | str, out: Path | str | None) -> Path:
    """Path where the merged results of a case or folder are."""
    if out is not None:
        return OutputFolder(Path(out)).results
    if not isinstance(source, (str, Path)):
        return OutputFolder(source.output_folder).results
    path = Path(source)
    if path.suffix == ".h5":
        return path
    if path.name == "case.toml":
        path = path.parent
    elif path.suffix == ".toml":
        path = path.parent / "out" / path.stem
    if (path / "case.toml").is_file():
        path = path / "out"
    return OutputFolder(path).results


def _read_merged(file: Path) -> Results:
    import h5py

    with open_hdf5(file, _REMEDY) as content:
        if content.attrs.get("format") != FORMAT:
            raise InputError("is not a result file", source=file, expected=f"format {FORMAT!r}; {_REMEDY}")
        metadata = {
            key: json.loads(value) if key in _JSON_ATTRIBUTES else _plain(value)
            for key, value in content.attrs.items()
        }
        try:
            time = content["time"][:]
        except OSError as error:
            raise InputError(
                f"is damaged: {error}", source=file, expected=f"a whole file; {_REMEDY}"
            ) from None
        channels = {}
        group = content["channels"].id
        for name in json.loads(content.attrs["channel_order"]):
            place = h5py.h5d.open(group, name.encode())
            unit, components, column = _attributes(place)
            channels[name] = ChannelInfo(name, unit, tuple(json.loads(components)), column)
    return Results(file, time, channels, _Hdf5Columns(file), metadata, file)


_JSON_ATTRIBUTES = {"sources", "versions", "channel_order", "overrides", "scenario", "sea", "tipping"}


def _plain(value: Any) -> Any:
    return value.item() if hasattr(value, "item") else value


def merge_segments(
    segments_folder: Path,
    file: Path,
    channels: Sequence[ChannelInfo],
    descriptions: Mapping[str, str],
    metadata: Mapping[str, Any],
    meshes: Sequence[MeshShape] = (),
    *,
    expected: Sequence[SegmentMark] | None = None,
) -> Results:
    """Merge the segments of a run into one self-describing HDF5 file, and read it back.

    Parameters
    ----------
    segments_folder
        Folder of the segments, which are left there; they are read one after the other.
    file
        Replaced in one step, once what is on the disk has been compared with what was merged.
    channels
        Channels of the records.
    descriptions
        What each channel is, in words, by its name.
    metadata
        Root attributes: title, digest, outcome, versions, sources, ...
    meshes
        Shapes of frames and shells.
    expected
        Segments that the run has written; None takes the consistent prefix.

    Returns
    -------
    Results
        What is in the file; of its channels each is read when it is asked for.

    Raises
    ------
    StopError
        If a segment is not there as it was written, if the disk is full, or holds something else than was written.
        The old file and all segments are left.
    """
    import h5py

    if expected is None:
        expected = [segment.mark for segment in read_segments(segments_folder)]
    count = sum(mark.records for mark in expected)
    width = sum(len(channel.components) for channel in channels)
    sums = dict.fromkeys((channel.name for channel in channels), 0)
    of_times, whole = 0, np.empty(count)
    with replacing(file) as temporary:
        # the records, and for each channel its name, texts and address
        size = 8 * count * (1 + width) + sum(256 + len(descriptions[channel.name]) for channel in channels)
        with (
            hdf5_stream(temporary, size) as stream,
            h5py.File(stream, "w", libver=("v110", "v110")) as target,
        ):
            target.attrs["format"] = FORMAT
            target.attrs["channel_order"] = json.dumps([channel.name for channel in channels])
            for key, value in metadata.items():
                target.attrs[key] = value if isinstance(value, (str, int, float)) else json.dumps(value)
            write_meshes(target, meshes)
            time = target.create_dataset("time", shape=(count,), dtype="f8", **_chunks(count))
            time.attrs["unit"] = "s"
            time.attrs["description"] = "simulated time of the records"
            group = target.create_group("channels")
            new = _NewChannels(group.id, count)
            first = 0
            for times, records in _batches(segments_folder, expected, width):
                rows = slice(first, first + len(times))
                time[rows] = whole[rows] = times
                of_times = _sum(times, of_times)
                for channel in channels:
                    # a channel is made when its first records are there: HDF5 then writes it once
                    if not first:
                        made = new.make(channel, descriptions[channel.name])
                    else:
                        made = h5py.h5d.open(group.id, channel.name.encode())
                    values = np.ascontiguousarray(
                        records[channel.column : channel.column + len(channel.components)].T
                    )
                    _put(made, first, values, count)
                    sums[channel.name] = _sum(values, sums[channel.name])
                first = rows.stop
        _read_back(temporary, of_times, sums)
    named = {channel.name: channel for channel in channels}
    return Results(file, whole, named, _Hdf5Columns(file), metadata, file)


class _NewChannels:
    """Makes data sets of channels by the calls of the library itself: there may be thousands.

    Parameters
    ----------
    group
        Where they are made.
    count
        Records.
    """

    def __init__(self, group: Any, count: int) -> None:
        import h5py

        self._group, self._count = group, count
        # each handle of the library takes its time: what all channels share is made once
        self._link = h5py.h5p.create(h5py.h5p.LINK_CREATE)
        self._link.set_create_intermediate_group(True)
        self._scalar, self._text = h5py.h5s.create(h5py.h5s.SCALAR), h5py.string_dtype()
        self._text_type, self._object = h5py.h5t.py_create(self._text, logical=True), _text_in_memory()
        self._shapes: dict[int, tuple[Any, Any]] = {}

    def make(self, channel: ChannelInfo, description: str) -> Any:
        """An empty data set with unit, components, description and column."""
        import h5py

        creation, space = self._shape(len(channel.components))
        name = channel.name.encode()
        made = h5py.h5d.create(self._group, name, h5py.h5t.IEEE_F64LE, space, creation, self._link)
        texts = {
            b"unit": channel.unit,
            b"components": json.dumps(channel.components),
            b"description": description,
        }
        for key, value in texts.items():
            attribute = h5py.h5a.create(made, key, self._text_type, self._scalar)
            attribute.write(np.array(value, dtype=self._text), self._object)
        column = h5py.h5a.create(made, b"column", h5py.h5t.STD_I64LE, self._scalar)
        column.write(np.array(channel.column, dtype=np.int64), h5py.h5t.NATIVE_INT64)
        return made

    def _shape(self, width: int) -> tuple[Any, Any]:
        """How channels of a width are stored, and their extent."""
        import h5py

        if width not in self._shapes:
            creation = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
            pieces = _chunks(self._count, width)
            if pieces:
                creation.set_chunk(pieces["chunks"])
                creation.set_fletcher32()
            self._shapes[width] = creation, h5py.h5s.create_simple((self._count, width))
        return self._shapes[width]


def _put(place: Any, first: int, values: NDArray[np.float64], count: int) -> None:
    """Write rows of a data set of `count` rows, from the first on."""
    import h5py

    if values.size and len(values) == count:
        place.write(h5py.h5s.ALL, h5py.h5s.ALL, values, h5py.h5t.NATIVE_DOUBLE)
    elif values.size:
        space = place.get_space()
        space.select_hyperslab((first, 0), values.shape)
        place.write(h5py.h5s.create_simple(values.shape), space, values)


def _attributes(place: Any) -> tuple[str, str, int]:
    """Unit, components and column of a data set, by the calls of the library itself."""
    import h5py

    texts, column = np.empty(2, dtype=object), np.empty((), dtype=np.int64)
    for index, key in enumerate((b"unit", b"components")):
        h5py.h5a.open(place, key).read(texts[index : index + 1].reshape(()), _text_in_memory())
    h5py.h5a.open(place, b"column").read(column, h5py.h5t.NATIVE_INT64)
    unit, components = (text.decode() if isinstance(text, bytes) else str(text) for text in texts)
    return unit, components, int(column)


@cache
def _text_in_memory() -> Any:
    """Type of texts in Python, made once: each handle of the library takes its time."""
    import h5py

    return h5py.h5t.py_create(h5py.string_dtype())


def _chunks(count: int, *width: int) -> dict[str, Any]:
    """Pieces of a channel: as few as `CHUNK` allows and all as large as the last, so that none is half empty."""
    if not count:
        return {}
    bytes_of_record = 8 * math.prod(width)
    pieces = -(-count * bytes_of_record // CHUNK)
    # each piece has a checksum, so that a bit that is wrong later is an error of whoever reads it
    return {"chunks": (max(1, -(-count // pieces)), *width), "fletcher32": True}


def _batches(
    folder: Path, expected: Sequence[SegmentMark], width: int
) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Times, and records column by column, of some segments together; at least once, also without records."""
    times, records, size, last = [np.empty(0)], [np.empty((0, width))], 0, len(expected) - 1
    for number, mark in enumerate(expected):
        path = segment_path(folder, number)
        segment = _read_segment(path, number)
        if segment is None or segment.mark != mark:
            first = sum(one.records for one in expected[:number])
            there = path.exists()
            if there:  # also one that is whole in itself: no later run shall continue from it
                path.replace(path.with_name(path.name + _ASIDE))
            raise StopError(
                Outcome.INTERRUPTED,
                f"{path} is {'damaged, and was put aside' if there else 'not there'}: something else has changed the "
                f"files of this run; the records from number {first} on are incomplete, so nothing was merged and "
                "nothing removed; the same command continues from what is before them",
            )
        times.append(segment.times)
        records.append(segment.records)
        size += segment.records.nbytes
        if size > BATCH and number < last:
            yield np.concatenate(times), _columns(records)
            times, records, size = [], [], 0
    if times:
        yield np.concatenate(times), _columns(records)


def _columns(records: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Records with a row a column; each part is released as it is copied."""
    found = np.empty((records[-1].shape[1], sum(len(part) for part in records)))
    first = 0
    while records:
        part = records.pop(0)
        rows = slice(first, first + len(part))
        for column in range(0, len(found), 64):  # blocks that the cache holds in both orders
            found[column : column + 64, rows] = part[:, column : column + 64].T
        first = rows.stop
    return found


def _sum(values: NDArray[np.float64], before: int = 0) -> int:
    """Checksum of numbers, continuing from that of those before them."""
    return zlib.crc32(np.ascontiguousarray(values).ravel().data, before)


def _sum_on_disk(dataset: Any) -> int:
    """Checksum of a data set of HDF5, some of its rows at a time."""
    import h5py

    count, *width = dataset.shape
    most = max(1, BATCH // (8 * math.prod(width)))
    found = 0
    if 0 < count <= most:
        values = np.empty((count, *width))
        dataset.read(h5py.h5s.ALL, h5py.h5s.ALL, values, h5py.h5t.NATIVE_DOUBLE)
        return _sum(values)
    for first in range(0, count, most):
        values = np.empty((min(most, count - first), *width))
        space = dataset.get_space()
        space.select_hyperslab((first, *(0 for _ in width)), values.shape)
        dataset.read(h5py.h5s.create_simple(values.shape), space, values)
        found = _sum(values, found)
    return found


def _read_back(path: Path, of_times: int, sums: Mapping[str, int]) -> None:
    """Compare a file with what was written into it, from the disk as far as the system allows."""
    import h5py

    sync_file(path)
    with path.open("rb") as stream, contextlib.suppress(OSError):
        os.posix_fadvise(stream.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)
    wrong = ""
    try:
        with h5py.File(path, "r") as found:
            group = found["channels"].id
            for name, place, expected in (
                ("time", found.id, of_times),
                *((name, group, expected) for name, expected in sums.items()),
            ):
                # the calls of the library itself: there may be thousands of channels
                if _sum_on_disk(h5py.h5d.open(place, name.encode())) != expected:
                    wrong = f"{name} is not what was written"
                    break
    except (OSError, KeyError, RuntimeError) as error:
        wrong = str(error)
    if wrong:
        raise StopError(
            Outcome.INTERRUPTED,
            f"{path}: read back after merging: {wrong}. The disk or its memory is faulty; nothing was removed, and "
            "the same command merges again",
        )
