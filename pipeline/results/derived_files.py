"""What follows from surfaces, decks and databases alone, kept in the output folder for the runs to come.

`heavylift.numerics.derived` says what is kept and under which name; here are its files. A file is whole or absent, and
read by its name alone: a case folder may be moved or copied, and what an edit has made old is not found any more. What
cannot be written is computed again by the next run.
"""

from __future__ import annotations

import contextlib
import os
from functools import cached_property
from typing import TYPE_CHECKING

from heavylift.numerics.processors import processor_type
from heavylift.pipeline.results.provenance import versions
from heavylift.pipeline.results.storage import StopError, replacing

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from heavylift.pipeline.results.storage import OutputFolder

__all__ = ["DerivedFiles"]

SPARE = 64 * 2**20
"""Bytes that files may take which the last run has not used."""

SUFFIX = ".bin"


class DerivedFiles:
    """Files of results that follow from inputs alone; a `heavylift.numerics.derived.Store`.

    Parameters
    ----------
    folder
        Output folder of the run.
    others
        Output folders of the same case, in which a result may be too.
    anew
        Whether all is computed again: what is there is replaced.
    """

    def __init__(
        self, folder: OutputFolder, others: Sequence[OutputFolder] = (), *, anew: bool = False
    ) -> None:
        self._folder, self._others, self._anew = folder, others, anew
        self._used: set[str] = set()

    @cached_property
    def versions(self) -> str:
        """Of the packages that compute, and the processor, whose instructions may round otherwise."""
        return repr((versions("derived"), processor_type()))

    def read(self, name: str) -> bytes | None:
        """A file of this folder, or of another one; None if there is none that can be read."""
        if self._anew and name not in self._used:
            return None
        for folder in (self._folder, *self._others):
            path = _path(folder, name)
            try:
                # a pipe would wait for a writer
                data = path.read_bytes() if path.is_file() and not path.is_symlink() else None
            except OSError:
                continue
            if data is None:
                continue
            self._used.add(name)
            if folder is self._folder:
                with contextlib.suppress(OSError):  # so that it is known to be in use
                    os.utime(path)
            else:
                self.write(name, data)
            return data
        return None

    def write(self, name: str, data: bytes) -> None:
        """Keep a file, if this folder can be written into."""
        if self._folder.derived.is_symlink():  # what it leads to belongs to someone
            return
        self._used.add(name)
        with contextlib.suppress(OSError, StopError), replacing(_path(self._folder, name)) as temporary:
            temporary.write_bytes(data)

    def refuse(self, name: str) -> None:
        """Remove a file that is damaged."""
        if not self._folder.derived.is_symlink():
            with contextlib.suppress(OSError):
                _path(self._folder, name).unlink(missing_ok=True)

    def clean(self) -> None:
        """Remove what was not used for longest, until the rest is at most as large again as what was used, and `SPARE`.

        A stage calls it at its end; without use nothing is removed.
        """
        folder = self._folder.derived
        if not self._used or folder.is_symlink() or not folder.is_dir():
            return
        used, rest = 0, []
        for path in folder.glob(f"*{SUFFIX}"):
            with contextlib.suppress(OSError):
                status = path.lstat()
                if path.stem in self._used:
                    used += status.st_size
                else:
                    rest.append((status.st_mtime_ns, path, status.st_size))
        left = used + SPARE
        for _, path, size in sorted(rest, reverse=True):
            left -= size
            if left < 0:
                with contextlib.suppress(OSError):
                    path.unlink(missing_ok=True)


def _path(folder: OutputFolder, name: str) -> Path:
    return folder.derived / f"{name}{SUFFIX}"
