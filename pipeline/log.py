"""What a person sees while stages run: lines on a stream; progress as a bar on a terminal, else as lines."""

from __future__ import annotations

import contextlib
import sys
import time
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["Log"]

PROGRESS_SECONDS = 10.0
"""Wall time between two lines of progress where no bar can be drawn."""


class Log:
    """Prints messages, unless told to be quiet.

    Parameters
    ----------
    quiet
        Print nothing.
    stream
        Where to; standard output by default. Commands that print a document choose standard error.
    """

    def __init__(self, *, quiet: bool = False, stream: TextIO | None = None) -> None:
        self.quiet = quiet
        self.stream = stream or sys.stdout

    def say(self, text: str) -> None:
        """Print one line."""
        if not self.quiet:
            print(text, file=self.stream, flush=True)

    @contextlib.contextmanager
    def progress(
        self, title: str, total: float, start: float = 0.0
    ) -> Iterator[Callable[[float, str], None]]:
        """Give a function ``update(done, note)`` that shows how far the work is.

        On a terminal it draws a bar; elsewhere it prints a line on standard error every `PROGRESS_SECONDS`,
        so that a log file or a batch system shows that a long run goes on, and standard output stays clean.
        """
        if self.quiet:
            yield lambda _done, _note: None
            return
        if not self.stream.isatty():
            yield _PlainProgress(title, total, start)
            return
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.percentage:>3.0f} %"),
            TimeRemainingColumn(),
            TextColumn("{task.fields[note]}"),
        )
        with Progress(*columns, console=Console(file=self.stream), transient=True) as bar:
            task = bar.add_task(title, total=total, completed=int(start), note="")
            yield lambda done, note: bar.update(task, completed=done, note=note)


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
        sys.stderr.write(f"{self._title}: {', '.join([note, *words])}\n")
        sys.stderr.flush()


def _duration(seconds: float) -> str:
    """Words for a span of time, e.g. ``"2 min 05 s"``."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"
