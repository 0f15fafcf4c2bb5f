"""One run at a time in an output folder."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import socket
import time
from typing import TYPE_CHECKING

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.results.storage import StopError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = ["locked"]

LOCK_FILE = ".lock"


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the lock of an output folder.

    The operating system releases it when the process ends in whatever way, so a lock is never stale;
    the content of the lock file is for messages only.

    Raises
    ------
    StopError
        With `Outcome.LOCKED`, if another process holds it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / LOCK_FILE
    with path.open("a+", encoding="utf-8") as stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno in {errno.ENOLCK, errno.ENOSYS, errno.ENOTSUP}:
                yield  # a file system without locks: better to run than to refuse
                return
            stream.seek(0)
            holder = stream.read().strip() or "another process"
            raise StopError(
                Outcome.LOCKED,
                f"{folder}: {holder} works in this folder; wait for it, stop it, or choose another --out",
            ) from None
        stream.seek(0)
        stream.truncate()
        started = time.strftime("%Y-%m-%d %H:%M:%S")
        stream.write(f"process {os.getpid()} on {socket.gethostname()}, started {started},")
        stream.flush()
        try:
            yield
        finally:
            stream.seek(0)
            stream.truncate()
