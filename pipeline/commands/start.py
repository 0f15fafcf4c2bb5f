"""The process of the ``heavylift`` command: how it begins, and how it ends whatever happens.

Nothing is imported here that takes time, so that a signal while modules load finds someone who answers it. What no
command has answered ends here: in one line, with an exit code, and, if the program is at fault, with a file that tells
where.
"""

from __future__ import annotations

import atexit
import contextlib
import errno
import gc
import os
import signal
import sys
import time
import warnings
from typing import TYPE_CHECKING, Any

from heavylift.pipeline.commands.endings import Terminated, interruption, out_of_memory

if TYPE_CHECKING:
    from pathlib import Path
    from types import FrameType, TracebackType

    from heavylift.numerics.outcome import Outcome

__all__ = ["main"]

YOUNG = 500_000
"""Objects made between two searches for cycles: a start makes fewer, and all of them stay."""

ASKED_AGAIN = 0.05
"""Seconds until a signal that came during an import is looked at again."""

CLOSED_PIPE = 141
"""Exit code of a command whose only product nobody reads any more, as a shell says it of SIGPIPE."""


def main() -> None:
    """Entry point of the ``heavylift`` command."""
    from heavylift.pipeline.commands.current_folder import distrust_current_folder
    from heavylift.pipeline.commands.requirements import remedy, troubles

    code = 0
    try:
        # the time loop and others that end well at their next step take the signal over
        with contextlib.suppress(ValueError):  # not in the main thread
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGALRM):
                signal.signal(number, _stop)
            sys.unraisablehook = _swallowed
            # whoever starts this process may hold a signal back until someone is there who answers it
            signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT, signal.SIGTERM})
        _open_streams()
        distrust_current_folder()
        # numbers that overflow are looked for where they matter; what NumPy says of them is no word for a user
        warnings.filterwarnings("ignore", category=RuntimeWarning)
        gc.set_threshold(YOUNG, 2, 2)
        # models of cases are ours alone; to find plugins for them Pydantic would read what all packages here bring
        os.environ["PYDANTIC_DISABLE_PLUGINS"] = "__all__"
        atexit.register(gc.freeze)  # the process ends as it is: what modules hold is not searched once more
        outside = [] if sys.argv[1:2] == ["doctor"] else troubles()
        if outside:  # they would fail anywhere, or compute something else
            from heavylift.numerics.outcome import Outcome

            code = _ended(f"{'; '.join(map(str, outside))}; {remedy(outside)}", Outcome.BAD_INPUT)
        else:
            from heavylift.pipeline.commands.cli import app

            _run(app)
        if sys.stdout is not None:
            sys.stdout.flush()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 0 if end.code is None else 2
        if isinstance(end.code, str):
            _say(end.code)
        if isinstance(end.__context__, BrokenPipeError):  # of what prints the help
            code = CLOSED_PIPE
        elif isinstance(end.__context__, KeyboardInterrupt):  # of a command that no other answers for
            code = _ending(end.__context__)
    except BrokenPipeError:  # the reader has enough, as in `heavylift schema | head`
        code = CLOSED_PIPE
    except BaseException as error:  # noqa: BLE001  the last place where it can be reported
        code = _ending(error)
    # a signal from here on would find nobody: the process is over but for what Python tidies up
    with contextlib.suppress(ValueError):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGALRM):
            signal.signal(number, signal.SIG_IGN)
    sys.exit(_closed(code))


def _run(app: Any) -> None:
    """Run the command of the command line; errors are printed with escapes in place of control characters.

    File names come from elsewhere too, as in ``heavylift run *``.
    """
    from heavylift.numerics.outcome import visible

    arguments = sys.argv[1:]
    shown = [visible(token) for token in arguments]
    if arguments == shown:
        app()
        return
    from cyclopts import CycloptsError

    try:
        app(arguments, exit_on_error=False, print_error=False)
    except CycloptsError:
        app(shown)


_WAITING: list[int] = []
"""Signal that waits for the end of an import."""


def _stop(number: int, frame: FrameType | None) -> None:
    """End what is being done; an import first comes to its end.

    Some libraries, VTK among them, are left half loaded by an exception while they load, and end the process then.
    """
    if number != signal.SIGALRM:
        _WAITING[:] = [number]
    if not _WAITING:
        return
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            signal.setitimer(signal.ITIMER_REAL, ASKED_AGAIN)
            return
        frame = frame.f_back
    number = _WAITING.pop()
    raise Terminated if number == signal.SIGTERM else KeyboardInterrupt


def _swallowed(what: sys.UnraisableHookArgs) -> None:
    """Ask again where Python cannot raise, as while it destroys an object; other messages are printed as usual."""
    if isinstance(what.exc_value, KeyboardInterrupt):
        _WAITING[:] = [signal.SIGTERM if isinstance(what.exc_value, Terminated) else signal.SIGINT]
        signal.setitimer(signal.ITIMER_REAL, ASKED_AGAIN)
    else:
        sys.__unraisablehook__(what)


def _open_streams() -> None:
    """Streams for messages.

    Where a descriptor was closed before the process began, the next file that is opened would get its number, and
    whatever libraries print would be written into that file. Names of folders need not be UTF-8.
    """
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


def _closed(code: int) -> int:
    """The exit code, once all output is written; lost output is not a success."""
    from heavylift.pipeline.log import flush_output, lost_output

    flush_output()
    if code == 0 and lost_output() is not None:
        from heavylift.numerics.outcome import Outcome

        return int(Outcome.DISK_FULL)
    return code


def _ending(error: BaseException) -> int:
    """Report an unhandled error in one line; returns the exit code."""
    from heavylift.numerics.outcome import Outcome

    if isinstance(error, KeyboardInterrupt):
        line, outcome = interruption(error), Outcome.INTERRUPTED
    elif isinstance(error, MemoryError):
        line, outcome = out_of_memory(error), Outcome.OUT_OF_MEMORY
    elif isinstance(error, OSError) and error.errno in {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}:
        line, outcome = f"output is lost: {error.strerror}", Outcome.DISK_FULL
    else:
        line, outcome = _fault(error), Outcome.FAULT
    return _ended(line, outcome)


def _ended(line: str, outcome: Outcome) -> int:
    """Report how a command ended if nothing else does; returns the exit code."""
    _say(line)
    if "--json" in sys.argv:
        import json

        document = {"error": line, "outcome": outcome.name.lower(), "details": []}
        _say(json.dumps(document, indent=2), sys.stdout)
    return int(outcome)


def _fault(error: BaseException) -> str:
    """A line about an internal error, whose traceback goes to a file."""
    import traceback
    from pathlib import Path

    from heavylift.numerics.outcome import in_one_line

    reason = in_one_line(f"{type(error).__name__}: {error}" if str(error) else type(error).__name__)
    frames = traceback.extract_tb(error.__traceback__)
    where = f" in {Path(frames[-1].filename).name}, line {frames[-1].lineno}" if frames else ""
    try:
        file = _write_traceback(error, error.__traceback__)
    except OSError:
        return f"an internal error, not an error of the input: {reason}{where}"
    return f"an internal error, not an error of the input: {reason}{where}; {file} has the traceback"


def _write_traceback(error: BaseException, trace: TracebackType | None) -> Path:
    """File with all that is known, in the current folder or, if that cannot be written, the one of temporary files."""
    import platform
    import tempfile
    import traceback
    from importlib import metadata
    from pathlib import Path

    from heavylift.numerics.outcome import visible

    name = f"heavylift-fault-{time.strftime('%Y%m%d-%H%M%S')}-{os.getpid()}.txt"
    text = [
        f"heavylift {metadata.version('heavylift')}, Python {platform.python_version()}, {platform.platform()}",
        f"command: {sys.argv!r}",
        f"folder: {os.environ.get('PWD', '')!r}",
        "",
        *traceback.format_exception(type(error), error, trace),
    ]
    content = visible("\n".join(text)).encode("utf-8", "backslashreplace")
    try:
        file = Path.cwd() / name
        _write_new(file, content)
    except OSError:  # perhaps the folder is gone
        file = Path(tempfile.gettempdir()) / name
        _write_new(file, content)
    return file


def _write_new(file: Path, content: bytes) -> None:
    """Write a file that is not there, nor a link of its name."""
    with file.open("xb") as stream:
        stream.write(content)


def _say(line: str, stream: object = None) -> None:
    from heavylift.pipeline.log import say_on

    say_on(stream or sys.stderr, line)  # type: ignore[arg-type]
