"""What a person sees while stages run: lines on a stream, a progress bar on a terminal."""

from __future__ import annotations

import contextlib
import sys
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["Log"]


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
        """Give a function ``update(done, note)`` that draws a bar, on a terminal only."""
        if self.quiet or not self.stream.isatty():
            yield lambda _done, _note: None
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
