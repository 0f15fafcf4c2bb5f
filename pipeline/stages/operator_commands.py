"""What someone outside says to a run: ``heavylift scenario CASE --send continue``.

Words are lines of a file in the output folder. A run reads it between two pieces of its loop and keeps, in a file
beside it, which word it took at which step; a run that goes on from a checkpoint behind which words were taken, or that
is made again since its results are gone, takes them at the same steps. So it ends as the one that received them.
"""

from __future__ import annotations

import contextlib
import errno
import os
import stat
from typing import TYPE_CHECKING, Any, Literal, get_args

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.results.storage import StopError, read_json, write_json
from heavylift.pipeline.stages.lock import locked

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["OperatorCommand", "OperatorCommands", "send", "words_there"]

OperatorCommand = Literal["continue", "hold", "stop"]
"""Commands: continue, wait in this phase, end the run."""

WORDS_FILE, TAKEN_FILE = "scenario_words.txt", "scenario_told.json"
LONGEST = 100_000
"""Characters of the file of words that are read."""


def send(root: Path, word: OperatorCommand) -> None:
    """Say something to the run in an output folder.

    Raises
    ------
    InputError
        If no run works there.
    """
    if root.is_dir():
        try:
            with locked(root):
                pass
        except StopError:
            _append(root / WORDS_FILE, f"{word}\n")
            return
    raise InputError(
        f"no run works in {root}", source=root, key="--send", expected="a run in progress, or another --out"
    )


def _append(path: Path, text: str) -> None:
    """Add to a file, that of no other name: a link would lead to one of someone."""
    flags = os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    try:
        handle = os.open(path, flags, 0o644)
    except OSError as error:
        if error.errno not in {errno.ELOOP, errno.ENXIO, errno.EISDIR}:
            raise
        handle = -1
    if handle >= 0:
        with open(handle, "a", encoding="utf-8") as file:  # noqa: PTH123  of a descriptor
            status = os.fstat(handle)
            if stat.S_ISREG(status.st_mode) and status.st_nlink == 1:
                file.write(text)
                return
    raise InputError(
        "is a link, the file of another name too, or no file",
        source=path,
        key="--send",
        expected="a file of heavylift, or none; move it away",
    )


def words_there(root: Path) -> int:
    """How many words are in the file of an output folder: those that are there before a run begins are not for it."""
    return len(_lines(root / WORDS_FILE))


def _lines(path: Path) -> list[str]:
    with contextlib.suppress(OSError), path.open(encoding="utf-8", errors="replace") as file:
        return [line.strip() for line in file.read(LONGEST).splitlines()]
    return []


class OperatorCommands:
    """Words for a run.

    Parameters
    ----------
    root
        Output folder.
    digest
        Of the inputs of the run; what was taken by one with other inputs is forgotten.
    operation
        The scenario on its way, which has been restored if it is to be.
    old
        How many words were there before the run began, as `words_there` tells.
    """

    def __init__(self, root: Path, digest: str, operation: Any, old: int) -> None:
        self._words, self._file, self._digest = root / WORDS_FILE, root / TAKEN_FILE, digest
        self._operation = operation
        kept = read_json(self._file) or {}
        taken = kept.get("taken") if kept.get("digest") == digest else None
        self._taken: list[tuple[int, str]] = []
        for entry in taken if isinstance(taken, list) else []:
            if isinstance(entry, list) and len(entry) == 2 and entry[1] in get_args(OperatorCommand):
                self._taken.append((int(entry[0]), str(entry[1])))
        self._done = operation.told_count
        self._read = old

    def take(self, step: int, time: float) -> int | None:
        """Say to the operation what is due at a step, and what is new; the step of the next word, if one is known."""
        while self._done < len(self._taken) and self._taken[self._done][0] <= step:
            self._operation.tell(self._taken[self._done][1], time)
            self._done += 1
        if self._done < len(self._taken):
            return self._taken[self._done][0]
        lines = _lines(self._words)
        new = [line for line in lines[self._read :] if line in get_args(OperatorCommand)]
        self._read = len(lines)
        for word in new:
            self._operation.tell(word, time)
            self._taken.append((step, word))
            self._done += 1
        if new:
            write_json(self._file, {"digest": self._digest, "taken": self._taken})
        return None

    @staticmethod
    def forget(root: Path) -> None:
        """Before a run that starts again: no commands."""
        for name in (WORDS_FILE, TAKEN_FILE):
            with contextlib.suppress(FileNotFoundError):
                (root / name).unlink()
