"""Time histories by name and unit, from a finished run or from what a stopped one left."""

from __future__ import annotations

import json
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.results.mesh_results import MeshShape, read_meshes, write_meshes
from heavylift.pipeline.results.model_io import open_hdf5
from heavylift.pipeline.results.segments import read_segments
from heavylift.pipeline.results.storage import OutputFolder, replacing

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case

__all__ = ["ChannelInfo", "Results", "load_results", "merge_segments"]

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

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Array of a channel in SI: shape (nr,) for one number a record, else (nr, components)."""
        channel = self.channel(name)
        array: NDArray[np.float64] = self._columns[name]
        return array[:, 0] if len(channel.components) == 1 else array

    def __iter__(self) -> Iterator[str]:
        return iter(self._channels)

    def __len__(self) -> int:
        return len(self._channels)

    def __contains__(self, name: object) -> bool:
        return name in self._channels

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all channels."""
        return tuple(self._channels)

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
        """Unit and components of a channel; an unknown name is an `InputError`."""
        if name not in self._channels:
            raise InputError(
                f"channel {name!r} does not exist",
                source=self.source,
                expected=f"one of: {', '.join(self._channels)}",
            )
        return self._channels[name]

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


_JSON_ATTRIBUTES = {"sources", "versions", "channel_order", "overrides", "sea"}


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
