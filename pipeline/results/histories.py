"""Time histories on disk: while they grow in numbered segments, each with the state to go on from; by name and unit.

A segment is one file, replaced in one step, that holds some records and the complete state after the last of them. So
whenever a process is killed, the segments on disk form a consistent prefix of the run and its last segment is the
checkpoint; there is nothing that could disagree with it. Histories are read from a finished run, or from what a stopped
one left.
"""

from __future__ import annotations

import json
import zipfile
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import Kind, parse_unit
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
from heavylift.pipeline.results.storage import OutputFolder, digest_bytes, replacing

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case

__all__ = [
    "ChannelInfo",
    "Results",
    "Segment",
    "last_segment",
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
        """Array of a channel in SI: shape (nr,) for one number a record, else (nr, components).

        The name may be that of a combination of channels, see `heavylift.pipeline.case.channel_names`; a ratio is not a
        number at records where its second term is zero.
        """
        if name not in self._channels:
            return self._combined(name)[0]
        channel = self._channels[name]
        array: NDArray[np.float64] = self._columns[name]
        return array[:, 0] if len(channel.components) == 1 else array

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
            lambda owner: self._term(substituted(name, pattern, owner)),
        )
        return tuple(substituted(name, pattern, owner) for owner in owners)

    def _combined(self, name: str) -> tuple[NDArray[np.float64], ChannelInfo]:
        """Records of a combination, as `__getitem__` gives them, and what they are."""
        if name in self._combinations:
            return self._combinations[name]
        combination = combination_of(name)
        if combination is None:
            raise InputError(
                f"channel {name!r} does not exist",
                source=self.source,
                expected=f"one of: {', '.join(self._channels)}",
            )
        terms = [
            self._term(one)
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
                    source=self.source,
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

    def _term(self, name: str) -> tuple[NDArray[np.float64], ChannelInfo]:
        """Records of a channel, of a component of one, or of a combination."""
        *parts, last = split_name(name)
        whole = ".".join(parts)
        if name in self._channels or not whole or whole not in self:
            return self[name], self.channel(name)
        info = self.channel(whole)
        if last not in info.components:
            raise InputError(
                f"{name!r} does not exist",
                source=self.source,
                expected=f"a component: {', '.join(info.components[:20])}",
            )
        values = self[whole]
        column = values if values.ndim == 1 else values[:, info.components.index(last)]
        return column, info._replace(name=name, components=(last,))

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
        searched = name.rpartition(".")[2] == "gap"  # what is far away has a gap at records only
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


CHUNK, FEW = 65536, 256
"""Bytes of a channel that are stored together, and records for which there is always room: the file of a short run
would be much larger than its records."""

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
    if (path / "case.toml").is_file():
        path = path / "out"
    return OutputFolder(path).results


def _read_merged(file: Path) -> Results:
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
        for name in json.loads(content.attrs["channel_order"]):
            attributes = content["channels"][name].attrs
            components = tuple(json.loads(attributes["components"]))
            channels[name] = ChannelInfo(name, str(attributes["unit"]), components, int(attributes["column"]))
    return Results(file, time, channels, _Hdf5Columns(file), metadata, file)


_JSON_ATTRIBUTES = {"sources", "versions", "channel_order", "overrides", "scenario", "sea"}


def _plain(value: Any) -> Any:
    return value.item() if hasattr(value, "item") else value


def merge_segments(
    segments_folder: Path,
    file: Path,
    channels: Sequence[ChannelInfo],
    descriptions: Mapping[str, str],
    metadata: Mapping[str, Any],
    meshes: Sequence[MeshShape] = (),
) -> None:
    """Merge the segments of a run into one self-describing HDF5 file.

    Parameters
    ----------
    segments_folder
        Folder of the segments; they are read one after the other.
    file
        Replaced in one step.
    channels
        Channels of the records.
    descriptions
        What each channel is, in words, by its name.
    metadata
        Root attributes: title, digest, outcome, versions, sources, ...
    meshes
        Shapes of frames and shells.
    """
    import h5py

    segments = read_segments(segments_folder)
    first = next(segments, None)
    expected = 0 if first is None else len(first.times)
    with replacing(file) as temporary, h5py.File(temporary, "w") as target:
        target.attrs["format"] = FORMAT
        target.attrs["channel_order"] = json.dumps([channel.name for channel in channels])
        for key, value in metadata.items():
            target.attrs[key] = value if isinstance(value, (str, int, float)) else json.dumps(value)
        write_meshes(target, meshes)
        time = target.create_dataset("time", shape=(0,), maxshape=(None,), dtype="f8", chunks=(4096,))
        time.attrs["unit"] = "s"
        time.attrs["description"] = "simulated time of the records"
        group = target.create_group("channels")
        for channel in channels:
            width = len(channel.components)
            rows = max(1, min(CHUNK // (8 * width), max(expected, FEW)))
            dataset = group.create_dataset(
                channel.name, shape=(0, width), maxshape=(None, width), dtype="f8", chunks=(rows, width)
            )
            dataset.attrs["unit"] = channel.unit
            dataset.attrs["components"] = json.dumps(channel.components)
            dataset.attrs["column"] = channel.column
            dataset.attrs["description"] = descriptions[channel.name]
        count = 0
        for segment in () if first is None else chain((first,), segments):
            end = count + len(segment.times)
            time.resize(end, axis=0)
            time[count:end] = segment.times
            for channel in channels:
                dataset = group[channel.name]
                dataset.resize(end, axis=0)
                columns = slice(channel.column, channel.column + len(channel.components))
                dataset[count:end] = segment.records[:, columns]
            count = end
