"""The time loop's outside: advance a simulation piece by piece, and keep what it has done on disk."""

from __future__ import annotations

import contextlib
import signal
import threading
import time
from dataclasses import field
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.results.histories import (
    Segment,
    SegmentMark,
    numbers_on_disk,
    read_segments,
    remove_segments,
    write_segment,
)
from heavylift.pipeline.results.storage import StopError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path
    from types import FrameType

    from numpy.typing import NDArray

    from heavylift.pipeline.stages.operator_commands import OperatorCommands

__all__ = ["FIRST_PIECE", "Advancer", "StopRequest", "next_piece", "stop_requests"]

PIECE_SECONDS = 0.2
"""Wall time of one call of the compiled loop, which nothing can interrupt."""
FIRST_PIECE = 100
"""Steps of the first call."""
SEGMENT_SECONDS = 5.0
"""Largest wall time between writes to disk."""
FIRST_SEGMENT_SECONDS = 0.25
"""The same for the first time, and twice as much each time after: most runs are shorter than `SEGMENT_SECONDS`."""
WRITING_SHARE = 0.05
"""Part of the time that may be spent on writing what is not needed for its size."""
SEGMENT_BYTES = 32 * 2**20
"""Size of the records in memory after which they go to disk."""


class SimulationLike(Protocol):
    """What is needed of `heavylift.solver.simulation.Simulation`."""

    step: float
    record_every: int
    step_index: int
    outcome: Outcome
    message: str
    ended: bool
    cpu_seconds: float
    stop_asked: Callable[[], object]

    @property
    def channels(self) -> Sequence[Any]: ...
    def record(self) -> NDArray[np.float64]: ...
    def advance(self, steps: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def state(self) -> dict[str, NDArray[Any]]: ...
    def restore(self, state: dict[str, NDArray[Any]]) -> None: ...


@dataclass
class StopRequest:
    """Whether someone asked the run to stop, and how."""

    signal_name: str = ""

    def __bool__(self) -> bool:
        return bool(self.signal_name)


@contextlib.contextmanager
def stop_requests() -> Iterator[StopRequest]:
    """Turn Ctrl-C and SIGTERM into a request that the time loop sees between two pieces."""
    request = StopRequest()
    if threading.current_thread() is not threading.main_thread():
        yield request
        return

    def note(number: int, _frame: FrameType | None) -> None:
        request.signal_name = signal.Signals(number).name

    before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield request
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@dataclass
class Advancer:
    """Advances a simulation to its end and writes its segments.

    Attributes
    ----------
    simulation
        At its start, or at any state that `resume` replaces.
    folder
        Folder of the segments.
    digest
        Digest of the inputs; segments with another one are not continued.
    step_count
        Steps of the whole run.
    adaptive
        Whether a step is an interval between records, whose cost nothing tells before the first one.
    restart_reason
        Set by `resume`: why it could not continue the results of an earlier run in the folder; empty if it did, or
        if nothing is there.
    commands
        What someone outside says to the run, if it has a scenario.
    loss
        Set by `resume`: what of an earlier run is computed again, because segments before it are missing or damaged.
    begins_again
        Why no run of this simulation can go on from a checkpoint; empty if it can.
    segments
        Those of this run that are on disk, in order.
    """

    simulation: SimulationLike
    folder: Path
    digest: str
    step_count: int
    adaptive: bool = False
    restart_reason: str = ""
    loss: str = ""
    begins_again: str = ""
    commands: OperatorCommands | None = None
    segments: list[SegmentMark] = field(default_factory=list)
    _written_steps: int = 0
    _times: list[NDArray[np.float64]] = field(default_factory=list)
    _records: list[NDArray[np.float64]] = field(default_factory=list)

    def resume(self) -> int:
        """Restore the last consistent state if it belongs to the same inputs; else remove what is there.

        Returns
        -------
        int
            Steps that are already done.
        """
        last, marks = None, []
        for last in read_segments(self.folder):
            marks.append(last.mark)
        if last is None or last.header["digest"] != self.digest or self.begins_again:
            if last is not None and last.header["digest"] == self.digest:
                self.restart_reason = self.begins_again
            elif last is not None:
                self.restart_reason = "the results of an earlier run belong to other inputs"
            elif self.folder.is_dir() and any(self.folder.glob("segment_*")):
                self.restart_reason = "the results of an earlier run are damaged"
            elif self.folder.is_dir():
                self.restart_reason = "nothing had been written"
            remove_segments(self.folder)
            return 0
        lost = [number for number in numbers_on_disk(self.folder) if number > last.number]
        if lost:
            damaged = last.number + 1
            what = "damaged" if lost[0] == damaged else "missing"
            after = len(lost) - (lost[0] == damaged)
            self.loss = f"segment {damaged} is {what}; it is computed again, and {after} behind it"
        remove_segments(self.folder, after=last.number)
        self.simulation.restore(last.state)
        self.segments = marks
        self._written_steps = self.simulation.step_index
        return self._written_steps

    def run(self, stop: StopRequest, progress: Callable[[float, str], None]) -> tuple[Outcome, str]:
        """Advance to the end, or until the simulation or someone stops it.

        Returns
        -------
        tuple
            How it ended, and a message if it did not complete.

        Raises
        ------
        StopError
            If the disk is full; the segments written before are intact, and the state in memory is lost.
        """
        simulation = self.simulation
        simulation.stop_asked = stop.__bool__
        if not any(mark.records for mark in self.segments):
            self.keep(np.array([simulation.step_index * simulation.step]), simulation.record()[np.newaxis, :])
        piece, growth = (1, FIRST_PIECE) if self.adaptive else (FIRST_PIECE, 4)
        flushed, wait = time.monotonic(), min(FIRST_SEGMENT_SECONDS, SEGMENT_SECONDS)
        while (
            simulation.step_index < self.step_count
            and simulation.outcome is Outcome.COMPLETED
            and not simulation.ended
            and not stop
        ):
            begin = time.monotonic()
            last = self.step_count
            if self.commands is not None:
                at = simulation.step_index
                last = min(last, self.commands.take(at, at * simulation.step) or last)
            self.keep(*simulation.advance(min(piece, last - simulation.step_index)))
            now = time.monotonic()
            piece = next_piece(piece, now - begin, growth)
            if now - flushed > wait or sum(r.nbytes for r in self._records) > SEGMENT_BYTES:
                self.write()
                flushed = time.monotonic()
                wait = min(SEGMENT_SECONDS, max(2.0 * wait, (flushed - now) / WRITING_SHARE))
            done = simulation.step_index
            progress(done, f"t = {done * simulation.step:.4g} s")
        self.write()
        if simulation.outcome is not Outcome.COMPLETED:
            return simulation.outcome, simulation.message
        if simulation.step_index < self.step_count and not simulation.ended:
            reached = simulation.step_index * simulation.step
            onward = "continues from there"
            if self.begins_again:
                onward = f"begins again at t = 0: {self.begins_again}"
            return (
                Outcome.INTERRUPTED,
                f"{stop.signal_name} at t = {reached:.9g} s; the same command {onward}",
            )
        return Outcome.COMPLETED, ""

    def keep(self, times: NDArray[np.float64], records: NDArray[np.float64]) -> None:
        """Take records for the next segment."""
        if len(times):
            self._times.append(times)
            self._records.append(records)

    def write(self) -> None:
        """Write what is in memory as the next segment."""
        simulation = self.simulation
        if simulation.step_index == self._written_steps and not self._times:
            return
        width = sum(len(channel.components) for channel in simulation.channels)
        times = np.concatenate([np.empty(0), *self._times])
        records = np.concatenate([np.empty((0, width)), *self._records])
        header = {
            "digest": self.digest,
            "channels": [[c.name, c.unit, list(c.components), c.column] for c in simulation.channels],
            "first_record": sum(mark.records for mark in self.segments),
            "step": simulation.step,
            "record_every": simulation.record_every,
            "step_index": simulation.step_index,
            "cpu_s": simulation.cpu_seconds,
        }
        try:
            segment = Segment(len(self.segments), header, times, records, simulation.state())
            self.segments.append(write_segment(self.folder, segment))
        except StopError as error:
            if error.outcome is Outcome.DISK_FULL:
                kept = (
                    f"the first {len(self.segments)} segments are"
                    if self.segments
                    else "nothing was written yet; the inputs are"
                )
                raise StopError(
                    Outcome.DISK_FULL,
                    f"{error}: {kept} kept. Free some space and give the same command: it continues from there",
                ) from None
            raise
        self._written_steps = simulation.step_index
        self._times.clear()
        self._records.clear()


def next_piece(piece: int, seconds: float, growth: float = 4.0) -> int:
    """Steps of the next piece, so that it takes about `PIECE_SECONDS`; at most `growth` times as many."""
    return max(1, int(piece * min(growth, PIECE_SECONDS / max(seconds, 1e-6))))
