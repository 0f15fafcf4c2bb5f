"""A case that someone else advances: inputs, steps, outputs, states, copies."""

from __future__ import annotations

import math
import shutil
import tempfile
import time as clock
import weakref
from contextlib import nullcontext
from difflib import get_close_matches
from functools import cached_property
from numbers import Real
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.case.places import in_case
from heavylift.pipeline.log import Log
from heavylift.pipeline.model.components import told
from heavylift.pipeline.results.storage import OutputFolder, StopError
from heavylift.pipeline.stages.advance import FIRST_PIECE, next_piece
from heavylift.pipeline.stages.prepared import compile_parts, new_simulation, prepare_run, release
from heavylift.pipeline.stages.stages import load_changed_case, make_parts
from heavylift.pipeline.stepping.past import InputChange, Past
from heavylift.pipeline.stepping.state import State
from heavylift.solver.recorded_numbers import recorded_numbers

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.stages.work import StageReport
    from heavylift.solver.linearise.result import Linearisation
    from heavylift.solver.scenario.operation import LogLine
    from heavylift.solver.simulation import Simulation as Solver

__all__ = ["InputChange", "InputInfo", "OutputInfo", "Simulation", "SimulationStopped"]

WHOLE = 1e-9
"""Of a step, by which a time may be off a whole number of steps."""


class SimulationStopped(StopError):
    """A simulation has stopped by itself; what it has computed is kept.

    Attributes
    ----------
    outcome
        How it ended, an `heavylift.Outcome`.
    """


@dataclass(frozen=True)
class InputInfo:
    """What may be driven from outside.

    Attributes
    ----------
    name, unit, sentence
        Name, SI unit, and what it is.
    interpolation
        ``"held"``: a value acts from the moment at which it is set; ``"linear"``: it is reached at the end of the step;
        ``"constant"``: as held, and it takes no rate.
    value
        Now.
    smallest, largest
        Limits; infinite without.
    """

    name: str
    unit: str
    sentence: str
    interpolation: str
    value: float
    smallest: float
    largest: float


@dataclass(frozen=True)
class OutputInfo:
    """A number that is recorded: name ``OWNER.CHANNEL.COMPONENT`` or ``OWNER.CHANNEL``, SI unit, what it is."""

    name: str
    unit: str
    sentence: str


class _Scratch:
    """A temporary folder, which is removed with the last that refers to it."""

    def __init__(self) -> None:
        self.path = Path(tempfile.mkdtemp(prefix="heavylift-"))
        weakref.finalize(self, shutil.rmtree, self.path, ignore_errors=True)


class Simulation:
    """A case that is advanced step by step.

    Parameters
    ----------
    case
        Folder of a case, a case that has been loaded, or a model built in Python.
    out
        Folder for meshes, modes and databases, which are taken from there if they are current; a temporary one
        by default.
    overrides
        Changes of the case, as those of ``--set``; with a folder only.
    history
        Whether it keeps its records, for `results`, and what was set, for `input_log`; a long run needs memory for it.

    Attributes
    ----------
    case
        What is simulated.
    stop_asked
        Asked several times a second while it steps: whether to stop there, as a signal may want.

    Raises
    ------
    InputError
        If the case is wrong, or says nothing of a simulation.

    Examples
    --------
    >>> import heavylift as hl
    >>> sim = hl.Simulation("cases/hoist")
    >>> before = sim.save()
    >>> sim.step(0.5)
    >>> print(f"{sim.time:g} s, load at {sim['load.position.z']:.3f} m")
    0.5 s, load at -49.446 m
    >>> sim.restore(before)
    >>> sim.time
    0.0
    """

    def __init__(
        self,
        case: Case | Path | str | Any,
        *,
        out: Path | str | None = None,
        overrides: Sequence[str] = (),
        history: bool = True,
    ) -> None:
        self.case: Case = _case_of(case, overrides)
        if self.case.simulate is None:
            raise InputError(
                "has no time to simulate",
                source=self.case.file,
                key="simulate",
                expected="the table [simulate]",
            )
        self._scratch = _Scratch() if out is None else None
        self._folder = OutputFolder(Path(out) if self._scratch is None else self._scratch.path)  # type: ignore[arg-type]
        with told(getattr(case, "located", None)):
            make_parts(self.case, self._folder)
            run = prepare_run(self.case, self._folder, Log(quiet=True))
        self._scene, self._meshes = run.scene, run.meshes
        self._begin(run.simulation)
        self._past = Past(object(), history).recorded(0, np.zeros(1), self.row[np.newaxis])

    @cached_property
    def _case_digest(self) -> str:
        """Of the case, but for its duration."""
        from heavylift.pipeline.results.provenance import simulate_digest

        section = self.case.simulate
        assert section is not None
        alike = section.model_copy(update={"duration": section.output_interval})
        return simulate_digest(self.case.model_copy(update={"simulate": alike}))

    def _begin(self, solver: Solver) -> None:
        """Take a simulation that has not started."""
        self._solver = solver
        compile_parts(solver, Log(quiet=True))
        with in_case(self.case):
            solver.warm_up()
        self._columns = _columns_of(solver)
        self._callbacks: list[Callable[[LogLine], None]] = []
        self._told = 0
        self.stop_asked: Callable[[], object] = bool
        self.row = solver.record()

    @property
    def row(self) -> NDArray[np.float64]:
        """All outputs now, SI, in the order of the columns of a record; read-only."""
        return self._row

    @row.setter
    def row(self, row: NDArray[np.float64]) -> None:
        self._row = row.view()
        self._row.flags.writeable = False  # it may be one of the records

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._solver.time

    @property
    def step_size(self) -> float:
        """Time that every step is a multiple of [s].

        With a tolerance, where the integrator chooses its steps, it is the time between records.
        """
        return self._solver.step

    @property
    def duration(self) -> float:
        """End of the case [s]."""
        assert self.case.simulate is not None
        return float(self.case.simulate.duration)

    @property
    def ended(self) -> bool:
        """Whether time goes no further: the end of the case, of its scenario, or a run that has stopped by itself."""
        solver = self._solver
        return (
            solver.ended
            or solver.outcome is not Outcome.COMPLETED
            or self.time >= self.duration - WHOLE * self.step_size
        )

    @property
    def outcome(self) -> Outcome:
        """How it stands; `Outcome.COMPLETED` as long as nothing is wrong."""
        return self._end[0]

    @property
    def message(self) -> str:
        """Why it stopped by itself; empty if it did not."""
        return self._end[1]

    @property
    def _end(self) -> tuple[Outcome, str]:
        solver = self._solver
        if solver.outcome is not Outcome.COMPLETED or not self.ended:
            return solver.outcome, solver.message
        return solver.verdict

    @property
    def warning(self) -> str:
        """What the user should know of a run that went well otherwise; empty if nothing."""
        return self._solver.warning

    @property
    def inputs(self) -> Mapping[str, InputInfo]:
        """What may be driven from outside, by name."""
        ports = self._solver.inputs
        return MappingProxyType(
            {
                name: InputInfo(
                    name,
                    ports[name].unit,
                    ports[name].sentence,
                    ports[name].interpolation,
                    ports.value(name)[0],
                    ports[name].smallest,
                    ports[name].largest,
                )
                for name in ports
            }
        )

    @property
    def outputs(self) -> Mapping[str, OutputInfo]:
        """All numbers that are recorded, by name."""
        numbers = recorded_numbers(self._solver.channels)
        return MappingProxyType(
            {name: OutputInfo(name, one.unit, one.sentence) for name, one in numbers.items()}
        )

    def columns(self, names: Sequence[str]) -> NDArray[np.int64]:
        """Places of some outputs in `row`: ``sim.row[sim.columns(names)]`` reads them at once.

        Raises
        ------
        InputError
            If there is no such output, or it has several components.
        """
        found = []
        for name in names:
            place = self._place(name)
            if isinstance(place, slice):
                raise InputError(
                    f"{name!r} has {place.stop - place.start} components",
                    source="simulation",
                    key="outputs",
                    expected=f"one of: {', '.join(self._parts(name))}",
                )
            found.append(place)
        return np.array(found, dtype=np.int64)

    def __getitem__(self, name: str) -> Any:
        """An output now, SI: a number, or an array of the components of a channel."""
        place = self._place(name)
        return self.row[place].copy() if isinstance(place, slice) else float(self.row[place])

    def _place(self, name: str) -> int | slice:
        try:
            return self._columns[name]
        except (KeyError, TypeError):
            raise InputError(
                f"there is no output {name!r}",
                source="simulation",
                key="outputs",
                expected="one of 'outputs'; the nearest are: "
                + (", ".join(get_close_matches(str(name), self._columns, 3, 0.4)) or "none"),
            ) from None

    def _parts(self, name: str) -> list[str]:
        return [one for one in self._columns if one.rpartition(".")[0] == name]

    def get(self, outputs: Sequence[str]) -> list[Any]:
        """Several outputs now, SI: numbers, or arrays of the components of channels.

        Raises
        ------
        InputError
            If there is no such output.
        """
        return [self[name] for name in outputs]

    def set(self, name: str, value: float, *, rate: float = 0.0, until: float = math.inf) -> None:
        """Drive an input from now on.

        Parameters
        ----------
        name
            Of the input.
        value, rate
            Now, and its change in a second; SI.
        until
            Time from which on it is held [s].

        Raises
        ------
        InputError
            If there is no such input, or the value is not possible; nothing has changed then.
        """
        if self.ended:
            raise InputError(
                f"the run has ended at t = {self.time:.9g} s",
                source="inputs",
                key=str(name),
                expected="values before its end",
            )
        self._set([(name, value, rate, until)])

    def _set(self, settings: list[tuple[str, Any, Any, float]]) -> None:
        """Set inputs from now on, all of them or none, and note it."""
        solver = self._solver
        solver.set_inputs(settings)
        self._past = self._past.changed(
            InputChange(solver.time, name, float(value), float(rate), float(until))
            for name, value, rate, until in settings
        )

    @property
    def input_log(self) -> list[InputChange]:
        """Changes of inputs since the start, for `replay`."""
        return self._past.log

    def step(
        self,
        dt: float | None = None,
        inputs: Mapping[str, float | tuple[float, float]] | None = None,
        outputs: Sequence[str] = (),
    ) -> None:
        """Advance.

        Parameters
        ----------
        dt
            Time [s], a multiple of `step_size`; one step by default.
        inputs
            Values by name; a held one acts from now on, a linear one is reached at the end. Two numbers are a value
            now and its rate until the end.
        outputs
            What is read next: of a simulation in another process they come with the same message.

        Raises
        ------
        InputError
            If the time is no multiple or goes beyond the end of the case, or an input is not possible; nothing
            has changed then.
        SimulationStopped
            If the simulation stops by itself; state and history are those of the last good step.
        """
        del outputs  # all of them are here
        solver = self._solver
        count = 1 if dt is None else self._count(dt)
        first = solver.step_index
        if self.ended or (first + count) * solver.step > self.duration + WHOLE * solver.step:
            raise InputError(
                f"{count * solver.step:.9g} s from t = {solver.time:.9g} s, and the run "
                + ("has ended" if self.ended else f"ends at {self.duration:.9g} s"),
                source="simulation",
                key="dt",
                expected="a shorter time, or a longer 'duration' in [simulate]",
            )
        if inputs:
            self._drive(inputs, count)
        solver.stop_asked = self.stop_asked
        piece, last = 1 if solver.tolerance > 0.0 else FIRST_PIECE, first + count
        while True:
            begin = clock.monotonic()
            times, rows = solver.advance(min(piece, last - solver.step_index))
            index = solver.step_index
            self._past = self._past.recorded(index, times, rows)
            if index >= last or solver.ended or solver.outcome is not Outcome.COMPLETED or self.stop_asked():
                break
            piece = next_piece(piece, clock.monotonic() - begin)
        self.row = rows[-1] if len(rows) and index % solver.record_every == 0 else solver.record()
        if self._callbacks:
            self._tell()
        if solver.outcome is not Outcome.COMPLETED:
            raise SimulationStopped(solver.outcome, solver.message)
        if index < last and not solver.ended:
            raise SimulationStopped(
                Outcome.INTERRUPTED, f"interrupted at t = {self.time:.9g} s, within a step"
            )

    def _count(self, dt: float) -> int:
        """Steps in a time."""
        step = self._solver.step
        try:
            count = round(float(dt) / step) if _is_number(dt) else 0
        except (TypeError, ValueError, OverflowError):
            count = 0
        if count < 1 or abs(count * step - dt) > WHOLE * step * max(1.0, count * 1e-3):
            adaptive = self._solver.tolerance > 0.0
            raise InputError(
                f"{dt!r} s is no multiple of {step:.9g} s",
                source="simulation",
                key="dt",
                expected="a whole number of "
                + ("times between records: 'output_interval' in [simulate]" if adaptive else "steps"),
            )
        return count

    def _drive(self, inputs: Mapping[str, Any], count: int) -> None:
        """Set the inputs of a step; all of them or none."""
        solver, end = self._solver, (self._solver.step_index + count) * self._solver.step
        ports, wanted = solver.inputs, []
        for name, value in inputs.items():
            if isinstance(value, (tuple, list)):
                if len(value) != 2:
                    raise InputError(
                        f"{len(value)} numbers",
                        source="inputs",
                        key=str(name),
                        expected="a value, or a value and its rate",
                    )
                wanted.append((name, value[0], value[1], end))
            elif name in ports and ports[name].interpolation == "linear" and _is_number(value):
                now = ports.value(name)[0]
                wanted.append((name, now, (float(value) - now) / (count * solver.step), end))
            else:
                wanted.append((name, value, 0.0, math.inf))
        self._set(wanted)

    def linearise(
        self, inputs: Sequence[str] | None = None, outputs: Sequence[str] | None = None
    ) -> Linearisation:
        """Matrices and modes of small motions about the state now, which stays as it is.

        Parameters
        ----------
        inputs
            Names; all by default.
        outputs
            Names of outputs or of whole channels; none by default.

        Raises
        ------
        InputError
            If something of the scene has no linear motion, or a name is unknown.

        Examples
        --------
        >>> import heavylift as hl
        >>> modes = hl.Simulation("cases/hoist").linearise()
        >>> print(f"{modes.frequencies[-1]:.3f} Hz")
        1.007 Hz
        """
        from heavylift.solver.linearise.linearise import linearise

        with in_case(self.case):
            return linearise(self._solver, inputs, outputs)

    def save(self) -> State:
        """The state now, inputs included."""
        return State(self._solver.state(), self._past.driven, self._case_digest, self._past)

    def restore(self, state: State) -> None:
        """Go on from a state of this simulation, of a copy, or of another process with the same case.

        Raises
        ------
        InputError
            If the state belongs to another case; only the duration may be another one.
        """
        if state.case != self._case_digest:
            raise InputError(
                "the state does not fit this case",
                source="checkpoint",
                key="case",
                expected="a state of the same case; its duration may be another one",
            )
        reached = self._solver.step_index
        self._solver.restore(state.arrays)
        self.row = self._solver.record()
        self._past = self._past_of(state, reached)
        if self._callbacks:
            self._told = self._logged

    def _past_of(self, state: State, reached: int) -> Past:
        """What is behind a state that was just restored; of a state that was written or of another run, what is known.

        Without its records those of this run stand for them, if it was driven alike and had `reached` that step.
        """
        if state.past is not None and state.past.run is self._past.run:
            return state.past
        index, driven = self._solver.step_index, state.digest
        if index <= reached:
            same = self._past.until(index, self.time, driven, 0.5 * self.step_size)
            if same is not None:
                return same
        past = Past(self._past.run, self._past.keeps, index, driven, driven)
        if index % self._solver.record_every:
            return past
        return past.recorded(index, np.array([self.time]), self.row[np.newaxis])

    def copy(self) -> Simulation:
        """Another simulation in the same state, with the same history, which goes its own way."""
        other = object.__new__(type(self))
        other.case, other._folder, other._scratch = self.case, self._folder, self._scratch
        other._scene, other._meshes = self._scene, self._meshes
        other._begin(new_simulation(self.case, self._folder, self._scene))
        other._solver.restore(self._solver.state())
        other._past = self._past
        other.row = self.row.copy()
        return other

    def close(self) -> None:
        """End the processes of its FMUs now, and not when nobody refers to it any more; what was computed stays."""
        release(self._solver)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def replay(self, log: Sequence[InputChange], until: float | None = None) -> None:
        """Advance with the inputs of a log, as they were set in another run.

        Parameters
        ----------
        log
            Changes in the order of their times, which are whole steps.
        until
            Time at the end [s]; that of the case by default.
        """
        end = self.duration if until is None else until
        ahead = [row for row in log if row.time >= self.time - WHOLE * self.step_size]
        for change in [*ahead, None]:
            at = end if change is None else change.time
            if at > self.time + WHOLE * self.step_size:
                self.step(at - self.time)
            if change is not None and change.time < end:
                self.set(change.name, change.value, rate=change.rate, until=change.until)

    def on_event(self, callback: Callable[[LogLine], None]) -> None:
        """Call a function with each line that the log of the scenario gets from now on, after the step that wrote it.

        Raises
        ------
        InputError
            If the case has no scenario.
        """
        if self._solver.operation is None:
            raise InputError(
                "has no scenario", source=self.case.file, key="scenario", expected="the table [scenario]"
            )
        if not self._callbacks:
            self._told = self._logged
        self._callbacks.append(callback)

    @property
    def _logged(self) -> int:
        assert self._solver.operation is not None
        return int(self._solver.operation.sequencer.state.logged)

    def _tell(self) -> None:
        """Lines of the log that nobody was told."""
        if self._logged == self._told:
            return
        assert self._solver.operation is not None
        lines = self._solver.operation.log[self._told :]
        self._told = self._logged
        for line in lines:
            for callback in self._callbacks:
                callback(line)

    def results(self) -> Results:
        """Histories so far, as `heavylift.load_results` gives them.

        After a state of another process they begin at its time.

        Raises
        ------
        InputError
            If there is no record: none is kept without `history`.
        """
        from heavylift.pipeline.results.histories import ChannelInfo, Results

        times, rows = (np.concatenate(part) for part in zip(*self._pieces, strict=True))
        channels = {
            c.name: ChannelInfo(c.name, c.unit, tuple(c.components), c.column) for c in self._solver.channels
        }
        columns = {
            name: rows[:, info.column : info.column + len(info.components)] for name, info in channels.items()
        }
        metadata = {"title": self.case.title, "case": self.case.name, "outcome": self.outcome.name.lower()}
        return Results(self.case.file, times, channels, columns, metadata)

    @property
    def _pieces(self) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
        """All records.

        Raises
        ------
        InputError
            If there are none.
        """
        pieces = self._past.pieces
        if not pieces:
            raise InputError(
                "there are no records",
                source="simulation",
                key="history",
                expected="a record since the state that was restored"
                if self._past.keeps
                else "a simulation with 'history'",
            )
        return pieces

    def write_results(self, folder: Path | str, *, lock: bool = True) -> StageReport:
        """Write the histories so far into an output folder, as the stage simulate does, for `report` and `verify`.

        Commands take the results of a run that has ended for those of the case, and say so if something drove its
        inputs; with ``--force`` they simulate it without. A run that has not ended yet is left as one that was
        interrupted, which `simulate` continues if nothing drove its inputs. Records that begin with a state of another
        process are never taken for those of a whole run.

        Parameters
        ----------
        folder
            The output folder.
        lock
            False: the caller holds the lock of the folder.

        Raises
        ------
        InputError
            If there is no record.
        StopError
            If the disk is full, or another run works in the folder.
        """
        from heavylift.pipeline.results.histories import remove_segments
        from heavylift.pipeline.results.mesh_results import save_meshes
        from heavylift.pipeline.results.provenance import simulate_digest
        from heavylift.pipeline.results.storage import digest_json
        from heavylift.pipeline.stages.advance import Advancer
        from heavylift.pipeline.stages.lock import locked
        from heavylift.pipeline.stages.simulate import conclude, provenance
        from heavylift.pipeline.stages.work import Work

        solver, work = self._solver, Work(self.case, OutputFolder(Path(folder)), Log(quiet=True))
        pieces, past = self._pieces, self._past
        digest = simulate_digest(self.case)
        if past.driven or past.begin:
            digest = digest_json([digest, past.driven.hex(), past.begin])
        with locked(work.folder.root) if lock else nullcontext():
            work.folder.results.unlink(missing_ok=True)  # of an earlier run
            remove_segments(work.folder.segments)
            advancer = Advancer(solver, work.folder.segments, digest, solver.step_index)
            for times, rows in pieces:
                advancer.keep(times, rows)
            advancer.write()
            save_meshes(work.folder.meshes, self._meshes)
            about = provenance(self._scene, solver, work.log)
            if past.driven and not past.begin:
                about |= {"driven": simulate_digest(self.case)}
            outcome, message = self._end
            if not self.ended:
                outcome, message = Outcome.INTERRUPTED, f"left at t = {self.time:.9g} s"
            return conclude(
                work,
                solver,
                advancer.segments,
                digest,
                outcome,
                message,
                about,
                self._meshes,
                solver.compile_seconds,
            )


def _is_number(value: Any) -> bool:
    """Whether it is a number of Python or of NumPy, as an array of no dimension is."""
    return isinstance(value, Real) or (isinstance(value, np.ndarray) and value.shape == ())


def _case_of(case: Any, overrides: Sequence[str]) -> Case:
    """A case from where it is."""
    from heavylift.pipeline.case.case_file import Case

    if isinstance(case, (str, Path)):
        return load_changed_case(Path(case), tuple(overrides))
    if overrides:
        raise InputError(
            "overrides of a case that has been loaded",
            source="simulation",
            key="overrides",
            expected="the folder of a case",
        )
    if isinstance(case, Case):
        return case
    if hasattr(case, "case"):
        made: Case = case.case()
        return made
    raise InputError(
        f"{type(case).__name__} {case!r}",
        source="simulation",
        key="case",
        expected="the folder of a case, a case, or a model",
    )


def _columns_of(solver: Solver) -> dict[str, int | slice]:
    """Columns of a record by the names of outputs and channels."""
    found: dict[str, int | slice] = {
        channel.name: slice(channel.column, channel.column + len(channel.components))
        for channel in solver.channels
    }
    return found | {name: one.column for name, one in recorded_numbers(solver.channels).items()}
