"""What a person sees while stages run: lines on a stream; progress as a bar on a terminal, else as lines.

Output need not be read: a pipe that is closed, as by ``| head -1``, or a disk that is full, as under
``> log.txt``, silences the stream and never ends the run that speaks.
"""

from __future__ import annotations

import contextlib
import errno
import os
import sys
import time
from typing import TYPE_CHECKING, TextIO

from heavylift.numerics.outcome import in_one_line, visible

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["KeptLog", "Log", "flush_output", "lost_output", "say_on"]

PROGRESS_SECONDS = 10.0
"""Wall time between two lines of progress where no bar can be drawn."""


_SILENCED: dict[TextIO, OSError] = {}
"""Streams of this process that take no more, and why; a closed pipe apart: its reader has enough."""
_LOST: list[OSError] = []
"""Why something was lost that was needed."""


def say_on(stream: TextIO | None, text: str, *, needed: bool = False) -> None:
    """Print a line; a stream that takes no more is silenced, and what it was to show is lost.

    Letters that the encoding of the stream does not have are written as escapes. What is `needed`, as a table that
    was asked for, is not lost without a trace: see `lost_output`. What a terminal would obey is written as escapes too.
    """
    text = visible(text)
    if stream is None:  # it was closed before the process began
        return
    try:
        try:
            print(text, file=stream, flush=True)
        except UnicodeEncodeError:
            known = getattr(stream, "encoding", None) or "ascii"
            print(text.encode(known, "backslashreplace").decode(known), file=stream, flush=True)
    except (OSError, ValueError) as error:  # a ValueError: closed by whoever opened it
        _lose(stream, error)
    if needed and stream in _SILENCED:
        _LOST.append(_SILENCED[stream])


def _lose(stream: TextIO, error: Exception) -> None:
    """Silence a stream that takes no more, and say so once, unless its reader has enough."""
    _silence(stream)
    if not isinstance(error, OSError) or error.errno in {errno.EPIPE, errno.ESHUTDOWN}:
        return
    first = not _SILENCED
    _SILENCED[stream] = error
    if first and stream is not sys.stderr:
        say_on(sys.stderr, f"output is lost: {error.strerror}; the run itself continues")


def flush_output() -> None:
    """Write what libraries have left in the buffers of this process, or lose it as `say_on` does."""
    for stream in (sys.stdout, sys.stderr):
        try:
            if stream is not None and not stream.closed:
                stream.flush()
        except (OSError, ValueError) as error:
            _lose(stream, error)


def lost_output() -> OSError | None:
    """Why something that was needed is lost; None if nothing was, or into a closed pipe."""
    return _LOST[0] if _LOST else None


def _silence(stream: TextIO) -> None:
    """Send what is still in the buffer of a stream, and all that follows, nowhere."""
    with contextlib.suppress(OSError, ValueError, AttributeError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        try:
            os.dup2(nowhere, stream.fileno())
        finally:
            os.close(nowhere)


class Log:
    """Prints messages, unless `quiet`.

    Parameters
    ----------
    quiet
        Print nothing.
    stream
        Where to; standard output by default. Commands that print a document choose standard error.
    """

    def __init__(self, *, quiet: bool = False, stream: TextIO | None = None) -> None:
        self.quiet = quiet
        self.stream: TextIO | None = stream or sys.stdout

    def say(self, text: str) -> None:
        """Print one line; what has more, as a message of another program, is indented from the second on."""
        if not self.quiet:
            say_on(self.stream, text.replace("\n", "\n  "))

    @contextlib.contextmanager
    def progress(
        self, title: str, total: float, start: float = 0.0
    ) -> Iterator[Callable[[float, str], None]]:
        """Give a function ``update(done, note)`` that shows how far the work is.

        On a terminal it draws a bar; elsewhere it prints a line on standard error every `PROGRESS_SECONDS`,
        so that a log file or a batch system shows that a long run continues, and standard output stays clean.
        """
        if self.quiet:
            yield lambda _done, _note: None
            return
        if self.stream is None or self.stream.closed or not self.stream.isatty():
            yield _PlainProgress(title, total, start)
            return
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

        columns = (
            TextColumn("{task.description}", markup=False),
            BarColumn(),
            TextColumn("{task.percentage:>3.0f} %"),
            TimeRemainingColumn(),
            TextColumn("{task.fields[note]}", markup=False),
        )
        with Progress(*columns, console=Console(file=self.stream), transient=True) as bar:
            task = bar.add_task(in_one_line(title), total=total, completed=int(start), note="")
            yield lambda done, note: bar.update(task, completed=done, note=in_one_line(note))


class KeptLog(Log):
    """Keeps lines for another one to say; progress is printed at once, as lines.

    Attributes
    ----------
    lines
        In order.
    """

    def __init__(self, *, quiet: bool = False) -> None:
        super().__init__(quiet=quiet)
        self.stream = None
        self.lines: list[str] = []

    def say(self, text: str) -> None:
        """Keep a line."""
        self.lines.append(text)


class _PlainProgress:
    """Prints a line on standard error from time to time."""

    def __init__(self, title: str, total: float, start: float) -> None:
        self._title, self._total, self._start = title, total, start
        self._begin = self._printed = time.monotonic()

    def __call__(self, done: float, note: str) -> None:
        now = time.monotonic()
        if now - self._printed < PROGRESS_SECONDS:
            return
        self._printed = now
        words = [f"{100.0 * done / self._total:.1f} %"]
        if done > self._start:
            left = (now - self._begin) * (self._total - done) / (done - self._start)
            words.append(f"about {_duration(left)} left")
        say_on(sys.stderr, f"{self._title}: {', '.join([note, *words])}")


def _duration(seconds: float) -> str:
    """Words for a span of time, e.g. ``"2 min 05 s"``."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"
