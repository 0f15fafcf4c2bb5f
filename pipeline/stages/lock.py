"""One run at a time works in an output folder: a lock that ends with its process."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import socket
import stat
import time
from io import FileIO
from typing import TYPE_CHECKING

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.results.storage import StopError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = ["locked"]

LOCK_FILE = ".lock"
_LOCK_BYTES = 4096
_LOCK_WORD = "process "


def _lock_file(path: Path) -> FileIO:
    """The lock file, open to read and write; anything else of that name is refused as it is."""
    problem, expected = "", "a lock file of heavylift, or none; move it away, or choose another --out"
    try:
        # a pipe would wait for its other end, a link lead to another file
        handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC, 0o644)
    except OSError as error:
        if error.errno not in {errno.ELOOP, errno.ENXIO, errno.EISDIR}:
            raise
        problem = "is a link" if error.errno == errno.ELOOP else "is no file"
        raise InputError(problem, source=path, expected=expected) from None
    stream = FileIO(handle, "r+")
    status = os.fstat(handle)
    if not stat.S_ISREG(status.st_mode):
        problem = "is no file"
    elif status.st_nlink > 1:
        problem = "is the file of another name too"
    elif status.st_size and not (
        status.st_size < _LOCK_BYTES and (stream.read(_LOCK_BYTES) or b"").startswith(_LOCK_WORD.encode())
    ):
        problem = "has another content"
    if problem:
        stream.close()
        raise InputError(problem, source=path, expected=expected)
    return stream


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the lock of an output folder.

    The operating system releases it when the process ends in whatever way, so a lock is never stale;
    the content of the lock file is for messages only.

    Raises
    ------
    StopError
        With `Outcome.LOCKED`, if another process holds it.
    InputError
        If what has its name is no lock file, but a link, a pipe or a file of someone.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / LOCK_FILE
    with _lock_file(path) as stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno in {errno.ENOLCK, errno.ENOSYS, errno.ENOTSUP}:
                yield  # a file system without locks: better to run than to refuse
                return
            stream.seek(0)
            text = stream.read(_LOCK_BYTES) or b""
            holder = text.decode("utf-8", errors="replace").strip() or "another process"
            raise StopError(
                Outcome.LOCKED,
                f"{folder}: {holder} works in this folder; wait for it, stop it, or choose another --out",
            ) from None
        started = time.strftime("%Y-%m-%d %H:%M:%S")
        holder = f"{_LOCK_WORD}{os.getpid()} on {socket.gethostname()}, started {started},"
        with contextlib.suppress(OSError):  # on a full disk the lock holds without its text
            stream.truncate(0)
            os.pwrite(stream.fileno(), holder.encode(), 0)
        try:
            yield
        finally:
            with contextlib.suppress(OSError):
                stream.truncate(0)
