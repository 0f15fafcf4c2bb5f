"""Files that are either whole or absent: atomic replacement, checksums, the layout of an output folder."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import io
import json
import os
import re
from typing import TYPE_CHECKING, Any

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError, Outcome

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

__all__ = [
    "FULL",
    "OutputFolder",
    "StopError",
    "digest_bytes",
    "digest_file",
    "digest_json",
    "hdf5_stream",
    "read_json",
    "remove_left_over",
    "replacing",
    "stored",
    "unchanged",
    "write_json",
]

FULL = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})
"""Faults of a disk, quota or limit that is full."""


class StopError(RuntimeError):
    """A stage cannot continue, through no fault of the input; says how it ended and what to do."""

    def __init__(self, outcome: Outcome, message: str) -> None:
        self.outcome = outcome
        super().__init__(message)


@dataclass(frozen=True)
class OutputFolder:
    """Where each stage keeps its files.

    Attributes
    ----------
    root
        ``CASE/out`` or the folder chosen with ``--out``.
    """

    root: Path

    @property
    def folders(self) -> tuple[Path, ...]:
        """Where files are made, replaced and removed: the root, and what is below it, a folder before its parts."""
        stages = ("check", "derived", "mesh", "modes", "simulate", "stress", "report", "draw", "export")
        return (self.root, *(self.root / name for name in stages), self.segments)

    def stage(self, *names: str) -> Path:
        """Folder of a stage, of a command, or of a part of one, into which files may be written.

        Raises
        ------
        InputError
            If it, or one on the way to it, is a link: what it leads to belongs to someone.
        """
        path = self.root
        for name in names:
            path /= name
            if path.is_symlink() or (path.exists() and not path.is_dir()):
                raise InputError(
                    f"is {'a link' if path.is_symlink() else 'no folder'}: files in it are replaced and removed",
                    source=path,
                    expected="a folder, or nothing; the output folder itself may be a link, or choose another --out",
                )
        return path

    def manifest(self, stage: str) -> Path:
        """Manifest of a stage."""
        return self.root / stage / "manifest.json"

    @property
    def derived(self) -> Path:
        """Folder of what follows from inputs alone, see `heavylift.pipeline.results.derived_files`."""
        return self.root / "derived"

    def model(self, body: str) -> Path:
        """Finite-element model of a body."""
        return self.root / "mesh" / f"{body}.h5"

    def surface(self, name: str) -> Path:
        """Triangles of a surface."""
        return self.root / "mesh" / f"{name}.npz"

    @property
    def surface_manifest(self) -> Path:
        """Manifest of the surfaces."""
        return self.root / "mesh" / "surfaces.json"

    def database(self, name: str) -> Path:
        """Hydrodynamic database."""
        return self.root / "mesh" / f"{name}.nc"

    def memory(self, name: str) -> Path:
        """Exponentials of the memory of a hydrodynamic database."""
        return self.root / "mesh" / f"{name}.memory.npz"

    def refused_database(self, name: str) -> Path:
        """What was computed for a hydrodynamic database and cannot be one; beside it, as JSON, why."""
        return self.root / "mesh" / f"{name}.refused.nc"

    @property
    def database_manifest(self) -> Path:
        """Manifest of the hydrodynamic databases."""
        return self.root / "mesh" / "hydrodynamics.json"

    def reduced(self, body: str) -> Path:
        """Reduced body."""
        return self.root / "modes" / f"{body}.h5"

    def stress(self, body: str) -> Path:
        """Stress of a flexible body over the run."""
        return self.root / "stress" / f"{body}.h5"

    @property
    def results(self) -> Path:
        """Time histories of a finished simulation."""
        return self.root / "simulate" / "results.h5"

    @property
    def start(self) -> Path:
        """Equilibrium that a simulation started from."""
        return self.root / "simulate" / "start.npz"

    @property
    def segments(self) -> Path:
        """Time histories of a simulation that is not finished."""
        return self.root / "simulate" / "segments"

    @property
    def meshes(self) -> Path:
        """Shapes of the frames and shells of a simulation, finished or not."""
        return self.root / "simulate" / "meshes.h5"


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary path beside `path`; on success its file replaces `path` in one step.

    Whatever happens, `path` is the old file or the new one, complete and on disk.

    Raises
    ------
    StopError
        With `Outcome.DISK_FULL`, if there was no space; the old file is intact.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary.unlink(missing_ok=True)  # of a dead process, or a link that leads elsewhere
        yield temporary
        sync_file(temporary)
        temporary.replace(path)
        _sync_folder(path.parent)
    except OSError as error:
        if error.errno in FULL or "No space left" in str(error):
            raise StopError(
                Outcome.DISK_FULL, f"no space left to write {path}; earlier files are intact"
            ) from None
        raise
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


_LEFT_OVER = re.compile(r"^\..+\.(\d+)\.tmp$")


def remove_left_over(folder: Path, *, alone: bool = False) -> None:
    """Remove the temporary files of `replacing` in a folder whose processes have ended.

    Parameters
    ----------
    folder
        Nothing below it is looked at.
    alone
        Nobody else can be writing into this folder: a number of a process may have been given again.
    """
    for path in folder.glob(".*.tmp") if folder.is_dir() else ():
        match = _LEFT_OVER.match(path.name)
        if match and (alone or not _alive(int(match[1]))):
            path.unlink(missing_ok=True)


def _alive(process: int) -> bool:
    """Whether another process of this number runs."""
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    return process != os.getpid()


class _Stream(io.RawIOBase):
    """A file that HDF5 may write into: a fault is kept until HDF5 has closed it.

    A library whose write fails while it closes a file is left with half a file and ends the process; so it reports
    that all went well, and whoever opened the file hears of the fault.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.open("w+b", buffering=0)
        self._at = self._end = 0
        self.fault: OSError | None = None

    def reserve(self, size: int) -> None:
        """Take the space before anything is written; file systems that cannot are left alone."""
        try:
            os.posix_fallocate(self._file.fileno(), 0, size)
        except OSError as error:
            if error.errno in FULL:
                raise

    def seekable(self) -> bool:
        return True

    def readable(self) -> bool:
        return True

    def writable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        # the end is that of what was written: reserved space is no file to HDF5
        self._at = offset + {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self._end}[whence]
        return self._at

    def tell(self) -> int:
        return self._at

    def readinto(self, buffer: Any) -> int:
        found = os.pread(self._file.fileno(), len(buffer), self._at)
        memoryview(buffer).cast("B")[: len(found)] = found
        self._at += len(found)
        return len(found)

    def write(self, data: Any) -> int:
        view = memoryview(data).cast("B")
        count, done = len(view), 0
        try:
            while done < count and self.fault is None:
                done += os.pwrite(self._file.fileno(), view[done:], self._at + done)
        except OSError as error:
            self.fault = error
        self._at += count
        self._end = max(self._end, self._at)
        return count

    def truncate(self, size: int | None = None) -> int:
        end = self._at if size is None else size
        try:
            self._file.truncate(end)
        except OSError as error:
            self.fault = self.fault or error
        self._end = end
        return end

    def flush(self) -> None:
        """Nothing waits in memory."""

    def close(self) -> None:
        self._file.close()
        super().close()


@contextlib.contextmanager
def hdf5_stream(path: Path, size: int = 0) -> Iterator[Any]:
    """Give what `h5py.File` writes a file into, so that a full disk is an `OSError` and not the end of the process.

    Parameters
    ----------
    path
        The file.
    size
        Bytes that it will have at least; their space is taken before anything is written.

    Raises
    ------
    OSError
        The first fault of the file, also if HDF5 has stumbled over what followed.
    """
    stream = _Stream(path)
    try:
        if size:
            stream.reserve(size)
        yield stream
    except Exception:
        if stream.fault is not None:
            raise stream.fault from None
        raise
    finally:
        stream.close()
    if stream.fault is not None:
        raise stream.fault


def sync_file(path: Path) -> None:
    """Wait until the content of a file is on the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _sync_folder(folder: Path) -> None:
    """Wait until a renaming is on the disk; file systems that cannot are left alone."""
    with contextlib.suppress(OSError):
        sync_file(folder)


def write_json(path: Path, document: Any) -> None:
    """Replace a JSON file."""
    text = json.dumps(document, indent=2, sort_keys=False, default=_plain) + "\n"
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def read_json(path: Path) -> dict[str, Any] | None:
    """Table of a JSON file, or None if it is absent, damaged, no file or holds something else.

    Of a manifest only those items are there that say what every stage says of what it has made.
    """
    try:
        if not path.is_file():
            return None
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    if not isinstance(found, dict):
        return None
    items = found.get("items")
    if items is not None:
        known = items.items() if isinstance(items, dict) else ()
        found["items"] = {name: item for name, item in known if _says_all(item)}
    return found


def _says_all(item: Any) -> bool:
    """Whether an item of a manifest has its digest, its size and what it took."""
    return (
        isinstance(item, dict)
        and isinstance(item.get("digest"), str)
        and isinstance(item.get("size"), int)
        and isinstance(item.get("cpu_s"), (int, float))
    )


def _plain(value: Any) -> Any:
    """JSON form of NumPy scalars and paths."""
    return value.item() if hasattr(value, "item") else str(value)


def digest_bytes(*parts: bytes | memoryview) -> str:
    """Hexadecimal digest of some bytes."""
    digest = hashlib.blake2b(digest_size=16)
    for part in parts:
        digest.update(part)
    return digest.hexdigest()


def digest_json(document: Any) -> str:
    """Hexadecimal digest of a document of plain values; the order of keys does not matter."""
    return digest_bytes(json.dumps(document, sort_keys=True, default=_plain).encode())


def digest_file(path: Path) -> str:
    """Hexadecimal digest of the content of a file."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, lambda: hashlib.blake2b(digest_size=16)).hexdigest()


def stored(path: Path) -> dict[str, Any]:
    """Name, size [bytes] and digest of a file, as manifests keep them for `unchanged`."""
    return {"file": path.name, "size": path.stat().st_size, "content": digest_file(path)}


def unchanged(path: Path, entry: Mapping[str, Any]) -> bool:
    """Whether a file has the content that its entry in a manifest tells."""
    return (
        path.is_file()
        and path.stat().st_size == entry.get("size")
        and digest_file(path) == entry.get("content")
    )
