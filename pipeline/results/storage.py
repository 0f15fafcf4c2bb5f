"""Files that are either whole or absent: atomic replacement, checksums, the layout of an output folder."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import Outcome

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = [
    "FULL",
    "OutputFolder",
    "StopError",
    "digest_bytes",
    "digest_file",
    "digest_json",
    "read_json",
    "replacing",
    "write_json",
]

FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
"""Errors of the operating system that mean: no space left."""


class StopError(RuntimeError):
    """A stage cannot go on, through no fault of the input; says how it ended and what to do."""

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

    def stage(self, name: str) -> Path:
        """Folder of a stage."""
        return self.root / name

    def manifest(self, stage: str) -> Path:
        """Manifest of a stage."""
        return self.root / stage / "manifest.json"

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

    @property
    def results(self) -> Path:
        """Time histories of a finished simulation."""
        return self.root / "simulate" / "results.h5"

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
        yield temporary
        sync_file(temporary)
        temporary.replace(path)
        _sync_folder(path.parent)
    except OSError as error:
        if error.errno in FULL or "No space left" in str(error):
            raise StopError(
                Outcome.DISK_FULL, f"no space left to write {path}; what was written before is intact"
            ) from None
        raise
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


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


def digest_bytes(*parts: bytes) -> str:
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
