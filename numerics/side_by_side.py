"""Independent parts of a stage, made in several processes at once; what comes out is as if one process had made all.

Processes are copies of this one (``fork``), so a part sees what this process has read and begins at once. They take
parts in order and hand over pickled results; nothing else of them is seen. A part that fails there is made here, in its
place, and fails as it would have: errors, and their order, are those of one process. So it is with a process that the
system has ended, for want of memory.

A copy of a process has one thread of it. Libraries whose threads would be missed in the copy must not have started
them: whoever has parts says whether one may have, and then all parts are made here.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import pickle
import signal
import struct
import sys
import threading
import time
import warnings
from typing import TYPE_CHECKING, Any, Self

from heavylift.numerics.memory import available_memory
from heavylift.numerics.processors import PROCESSES, processors

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from types import TracebackType

__all__ = ["SideBySide", "cpu_seconds"]

MEMORY_EACH = 4e9
"""Memory [bytes] that must be available for each process."""
NUMBER = struct.Struct("<H")
"""Number of a part in a pipe; a pipe takes and gives it whole."""
MOST = 2**14
"""Parts whose numbers fit into a pipe."""
PATIENCE = 2.0
"""Time [s] that a process has to end by itself."""
_DIES_WITH_PARENT = 1  # PR_SET_PDEATHSIG


def cpu_seconds() -> float:
    """CPU time [s] of this process and of those that it has started and that have ended."""
    children = os.times()
    return time.process_time() + children.children_user + children.children_system


class SideBySide:
    """Parts of a stage; to be used as a context, at whose end no process is left.

    Parameters
    ----------
    parts
        Functions without parameters, whose results can be pickled. They may write files, each its own.
    alone
        All parts are made here: a library that they use does not bear a copy of the process.
    """

    def __init__(self, parts: Sequence[Callable[[], Any]], *, alone: bool = False) -> None:
        self._parts = parts
        self._results: list[int] = []  # files in memory
        self._numbers = self._done = self._tell = -1
        self._processes: set[int] = set()
        self.count = self._most() if 1 < len(parts) <= MOST and not alone else 1
        """Processes at once."""

    def _most(self) -> int:
        """Processes that may work at once."""
        if sys.platform != "linux" or threading.active_count() > 1:
            return 1
        return min(len(self._parts), processors(), max(1, int(available_memory() / MEMORY_EACH)))

    def __enter__(self) -> Self:
        if self.count > 1:
            self._numbers, hand_out = os.pipe()
            self._done, self._tell = os.pipe()
            self._results = [os.memfd_create(f"part {number}") for number in range(len(self._parts))]
            os.write(hand_out, b"".join(map(NUMBER.pack, range(len(self._parts)))))
            os.close(hand_out)
        return self

    def begin(self, count: int) -> None:
        """Let so many processes work from now on, if there may be several; all of them if results are asked for."""
        while self.count > 1 and len(self._processes) < min(count, self.count):
            sys.stdout.flush()
            sys.stderr.flush()
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DeprecationWarning)  # of threads, which libraries answer for
                process = os.fork()
            if process == 0:
                self._serve()
            self._processes.add(process)

    def results(self) -> Iterator[Any]:
        """Results in the order of the parts, each as soon as those before it are there."""
        self.begin(self.count)
        if self.count > 1:
            os.close(self._tell)  # so that the pipe ends with the processes
            self._tell = -1
        ready: set[int] = set()
        for number, part in enumerate(self._parts):
            while self.count > 1 and number not in ready:
                told = os.read(self._done, NUMBER.size)
                if not told:  # all processes have ended
                    break
                ready.add(NUMBER.unpack(told)[0])
            content = self._content(number) if number in ready else b""
            yield pickle.loads(content) if content else part()  # noqa: S301  our own process wrote it

    def _content(self, number: int) -> bytes:
        file = self._results[number]
        size, content = os.fstat(file).st_size, bytearray()
        while len(content) < size:
            content += os.pread(file, size - len(content), len(content))
        os.ftruncate(file, 0)
        return bytes(content)

    def _serve(self) -> None:
        """What a copy does: it never returns, and says nothing of errors."""
        try:
            with contextlib.suppress(OSError, AttributeError):
                ctypes.CDLL(None).prctl(_DIES_WITH_PARENT, signal.SIGTERM)
            os.environ[PROCESSES] = "1"  # what it does is not divided again
            while told := os.read(self._numbers, NUMBER.size):
                (number,) = NUMBER.unpack(told)
                try:
                    content = pickle.dumps(self._parts[number](), protocol=pickle.HIGHEST_PROTOCOL)
                    with open(self._results[number], "wb", closefd=False) as stream:
                        stream.write(content)
                except Exception:  # noqa: BLE001  it fails again where all can see it
                    os.ftruncate(self._results[number], 0)  # half a result is none
                sys.stdout.flush()
                sys.stderr.flush()
                os.write(self._tell, told)
        finally:
            os._exit(0)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for process in self._processes:
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGTERM)
        end = time.monotonic() + PATIENCE
        for process in self._processes:
            while os.waitpid(process, os.WNOHANG) == (0, 0):
                if time.monotonic() > end:
                    os.kill(process, signal.SIGKILL)
                time.sleep(0.001)
        self._processes.clear()
        for file in (self._numbers, self._done, self._tell, *self._results):
            with contextlib.suppress(OSError):
                os.close(file)
