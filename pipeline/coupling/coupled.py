"""A simulation with FMUs beside it: a simulation like others, whose steps stop at sample times for an exchange.

Everything that advances a simulation advances this one: the simulate stage in pieces of any length, and whoever steps
it from outside. An exchange belongs to the beginning of the interval that follows; state and outputs of the FMUs are
part of the state, so that a run goes on from a checkpoint with the same bits.
"""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.case.simulate import multiple
from heavylift.pipeline.coupling.fmu_file import unit_factor
from heavylift.pipeline.coupling.fmu_process import FmuError, FmuProcess
from heavylift.pipeline.coupling.master import Link, Master, System, moves
from heavylift.pipeline.results.storage import StopError
from heavylift.solver.recorded_numbers import recorded_numbers
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.case.fmus import FmuSection
    from heavylift.pipeline.coupling.fmu_file import FmuFile
    from heavylift.solver.recorded_numbers import RecordedNumber
    from heavylift.solver.scene.scene import Scene

__all__ = ["CoupledSimulation"]

SCENE = "the scene"
"""Name of the simulation among the systems of its masters; no FMU has a blank in its name."""
KEPT = "fmus"
"""Name of what the state holds of FMUs."""


class _EndedError(Exception):
    """The scene does not reach the end of an interval that is tried."""


class _Scene:
    """A simulation as a system of a master.

    Parameters
    ----------
    simulation
        The simulation.
    every
        Steps of an interval.
    columns
        Of its outputs in a record, by name.
    tries
        Whether a step is made at once, to be taken back perhaps; else it is only prepared.
    """

    def __init__(
        self, simulation: CoupledSimulation, every: int, columns: Mapping[str, int], *, tries: bool
    ) -> None:
        self._simulation, self._every, self._columns, self._tries = simulation, every, columns, tries
        self._values: Mapping[str, float] = {}
        self._rates: Mapping[str, float] = {}
        self.start: dict[str, NDArray[Any]] = {}
        self.piece: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None

    def set(self, values: Mapping[str, float], rates: Mapping[str, float]) -> None:
        """Inputs of the next step."""
        self._values, self._rates = values, rates

    def step(self, _time: float, dt: float) -> None:
        """Set the inputs, and advance if it is a trial.

        Held inputs have their values from now on; those that cannot jump arrive at the end of the step.
        """
        self.put(dt)
        if not self._tries:
            return
        self.piece = self._simulation.try_steps(self._every)
        if self.piece is None:
            raise _EndedError

    def put(self, dt: float) -> None:
        """Set the inputs in the simulation."""
        simulation = self._simulation
        until = (simulation.step_index + self._every) * simulation.step
        settings = []
        for name, value in self._values.items():
            rate = self._rates[name]
            port = simulation.inputs[name]
            if moves(port.interpolation, port.unit):
                present, _ = simulation.inputs.value(name)
                settings.append((name, present, (value + rate * dt - present) / dt, until))
            elif port.interpolation == "constant":
                settings.append((name, value + 0.5 * rate * dt, 0.0, math.inf))
            else:
                settings.append((name, value, rate, until if rate else math.inf))
        if settings:
            simulation.put_inputs(settings)

    def outputs(self) -> Mapping[str, float]:
        """What the record of the present state shows."""
        row = self._simulation.record()
        return {name: float(row[column]) for name, column in self._columns.items()}

    def save(self) -> dict[str, NDArray[Any]]:
        """State of the simulation alone."""
        self.start = self._simulation.own_state()
        return self.start

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go back to a state."""
        self._simulation.go_back(state)


class _Group(NamedTuple):
    """FMUs that exchange at the same times, every so many steps."""

    every: int
    master: Master
    scene: _Scene


class CoupledSimulation(Simulation):
    """A simulation with FMUs.

    Parameters
    ----------
    scene, step, integrator, options
        As of a `heavylift.solver.simulation.Simulation`.
    fmus
        Entries of ``[[fmus]]`` with their files, as `heavylift.pipeline.coupling.fmus.check_fmu` has read them.

    Attributes
    ----------
    processes
        The FMUs by name.
    exchanges, iterations
        How often FMUs and scene have exchanged, and how often intervals were repeated for it.

    Raises
    ------
    InputError
        If an FMU cannot be loaded, a channel or input does not exist, or units do not fit.
    """

    def __init__(
        self,
        scene: Scene,
        step: float,
        integrator: str = "dele2",
        *,
        fmus: Sequence[tuple[FmuSection, FmuFile]],
        **options: Any,
    ) -> None:
        super().__init__(scene, step, integrator, **options)
        self.processes: dict[str, FmuProcess] = {}
        self.exchanges = 0
        self._driven = {entry: section.name for section, _ in fmus for entry in section.writes.values()}
        self._begun = self._failed = False
        columns = recorded_numbers(self.channels)
        links: dict[str, list[Link]] = {}
        intervals: dict[tuple[int, str], list[str]] = {}
        for section, file in fmus:
            links[section.name] = self._links(section, file, columns)
            every = multiple(section.sample_time, self.step)
            if every is None:
                raise InputError(
                    f"{section.sample_time:g} s, and the integrator that was chosen stops every {self.step:g} s only",
                    source=section.name,
                    key="sample_time",
                    expected=f"a multiple of {self.step:g} s",
                )
            intervals.setdefault((every, section.coupling), []).append(section.name)
        try:
            for section, file in fmus:
                self.processes[section.name] = FmuProcess(
                    file,
                    section.name,
                    list(section.reads),
                    list(section.writes),
                    section.parameters,
                    section.timeout,
                )
        except FmuError as error:
            self.close()
            raise InputError(
                str(error),
                source=section.name,
                key="file",
                expected="an FMU that can be loaded on this machine",
            ) from None
        self._groups: list[_Group] = []
        for (every, coupling), names in intervals.items():
            between = [link for name in names for link in links[name]]
            read = {link.output: columns[link.output].column for link in between if link.source == SCENE}
            tries = coupling == "iterated"
            system = _Scene(self, every, read, tries=tries)
            systems: dict[str, System] = {**{name: self.processes[name] for name in names}, SCENE: system}
            self._groups.append(
                _Group(every, Master(systems, between, "iterated" if tries else "sequential"), system)
            )
        self._done = [-1] * len(self._groups)

    def _links(self, section: FmuSection, file: FmuFile, columns: Mapping[str, RecordedNumber]) -> list[Link]:
        """What an FMU and the scene exchange."""
        name, found = section.name, []
        for variable, channel in section.reads.items():
            key = f"reads.{variable}"
            if channel not in columns:
                inside = [one for one in columns if one.startswith(f"{channel}.")]
                owner = [one for one in columns if one.startswith(channel.partition(".")[0] + ".")]
                expected = ", ".join((inside or owner or list(columns))[:20])
                raise InputError(
                    f"{channel!r} is no number of a record",
                    source=name,
                    key=key,
                    expected=f"one of: {expected}",
                )
            factor = self._factor(file, variable, columns[channel].unit, name, key)
            found.append(Link(SCENE, channel, name, variable, factor))
        for variable, entry in section.writes.items():
            factor = self._factor(file, variable, self.inputs[entry].unit, name, f"writes.{variable}")
            found.append(Link(name, variable, SCENE, entry, 1.0 / factor))
        return found

    def _factor(self, file: FmuFile, variable: str, unit: str, name: str, key: str) -> float:
        try:
            return unit_factor(file.variables[variable], unit)
        except InputError as error:
            raise InputError(error.problem, source=name, key=key, expected=error.expected) from None

    def set_inputs(self, settings: Sequence[tuple[str, float, float, float]]) -> None:
        """Set inputs that no FMU writes; see `heavylift.solver.simulation.Simulation`.

        Raises
        ------
        InputError
            As there, and for an input that an FMU writes.
        """
        for name, *_ in settings:
            if name in self._driven:
                raise InputError(
                    f"{name!r} is written by FMU {self._driven[name]!r}",
                    source="inputs",
                    key=name,
                    expected="an input that no FMU writes",
                )
        self.put_inputs(settings)

    def put_inputs(self, settings: Sequence[tuple[str, float, float, float]]) -> None:
        """Set inputs for the FMUs."""
        super().set_inputs(settings)

    @property
    def not_kept(self) -> str:
        """Why the run cannot go on from a checkpoint; empty if it can."""
        mute = [name for name, process in self.processes.items() if not process.fmu.serializes]
        return f"FMU {', '.join(map(repr, mute))} cannot write its state" if mute else ""

    @property
    def iterations(self) -> int:
        """How often intervals were made, if their exchange is iterated."""
        return sum(group.master.iterations for group in self._groups)

    @property
    def warning(self) -> str:
        """What the user should know of a run that went well otherwise, and what FMUs warned of."""
        said = [
            f"FMU {name!r} said: {process.log[-1]}" for name, process in self.processes.items() if process.log
        ]
        return "; ".join(filter(None, [super().warning, *said]))

    def close(self) -> None:
        """End the FMUs and their processes."""
        for process in self.processes.values():
            process.close()

    def advance(self, steps: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Make a number of steps, with exchanges at sample times; see `heavylift.solver.simulation.Simulation`."""
        last = self.step_index + steps
        pieces: list[tuple[NDArray[np.float64], NDArray[np.float64]]] = []
        while self.step_index < last and self.outcome is Outcome.COMPLETED and not self.ended:
            before = self.step_index
            pieces.append(self._exchange(last) or super().advance(self._next(last) - before))
            if self.step_index == before or self.stop_asked():
                break
        if not pieces:
            return super().advance(0)
        return np.concatenate([times for times, _ in pieces]), np.concatenate([rows for _, rows in pieces])

    def _next(self, last: int) -> int:
        """End of the piece that can be made without an exchange."""
        if self.outcome is not Outcome.COMPLETED:
            return self.step_index
        at = self.step_index
        return min([last, *(at - at % group.every + group.every for group in self._groups)])

    def _exchange(self, last: int) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
        """Exchange where it is due; the steps of the interval if they have been made with it, and none too many."""
        at, piece = self.step_index, None
        try:
            self._begin()
            for k, group in enumerate(self._groups):
                if at % group.every or self._done[k] == at:
                    continue
                dt = group.every * self.step
                group.scene.piece = None
                try:
                    group.master.step(self.time, dt)
                except _EndedError:
                    piece = None  # it ends in the same way when it is made
                else:
                    piece = group.scene.piece
                if self.step_index != at and (piece is None or last < at + group.every):
                    self.go_back(group.scene.start)
                    group.scene.put(dt)
                    piece = None
                self._done[k] = at
                self.exchanges += 1
        except (FmuError, StopError, InputError) as error:
            if self.step_index != at:
                self.go_back(group.scene.start)
            self._fail(error)
            return None
        return piece

    def _fail(self, error: Exception) -> None:
        """End the run: what was computed stays."""
        self._failed = True
        self.outcome = error.outcome if isinstance(error, StopError) else Outcome.BAD_INPUT
        text = str(error)
        self.message = text if text.startswith("t = ") else f"t = {self.time:.9g} s: {text}"

    def _begin(self) -> None:
        """Start the FMUs with what they read at the present time, if they have not begun."""
        if self._begun:
            return
        self._begun = True
        row, columns = self.record(), recorded_numbers(self.channels)
        for group in self._groups:
            for name, process in self.processes.items():
                links = [link for link in group.master.links if link.target == name]
                if links or any(link.source == name for link in group.master.links):
                    process.start(
                        {link.input: row[columns[link.output].column] * link.factor for link in links}
                    )

    def try_steps(self, count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
        """Make steps that are taken back perhaps, whoever wants it to stop; None if it ends before the last of them."""
        asked, last = self.stop_asked, self.step_index + count
        self.stop_asked = bool
        try:
            piece = super().advance(count)
        finally:
            self.stop_asked = asked
        good = self.step_index == last and self.outcome is Outcome.COMPLETED and not self.ended
        return piece if good else None

    def own_state(self) -> dict[str, NDArray[Any]]:
        """State without that of the FMUs."""
        return super().state()

    def go_back(self, state: dict[str, NDArray[Any]]) -> None:
        """Go back to a state, and keep what it has cost."""
        spent = self.cpu_seconds
        super().restore(state)
        self.cpu_seconds = spent

    def state(self) -> dict[str, NDArray[Any]]:
        """Everything that a bitwise identical continuation needs, with the states of FMUs if they can write them."""
        arrays = super().state()
        if self.not_kept or self._failed:
            return arrays
        try:
            self._begin()
            fmus = {
                name: {
                    "token": process.fmu.token,
                    "state": process.serialize(),
                    "outputs": dict(process.outputs()),
                }
                for name, process in self.processes.items()
            }
        except FmuError as error:
            self._fail(error)
            return arrays
        kept = {
            "fmus": fmus,
            "masters": [group.master.memory for group in self._groups],
            "every": [group.every for group in self._groups],
            "done": self._done,
            "exchanges": self.exchanges,
        }
        arrays[KEPT] = np.frombuffer(json.dumps(kept).encode(), np.uint8)
        return arrays

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Continue from what `state` returned, in this process or another one.

        Raises
        ------
        InputError
            If the state belongs to another scene, or has none of the FMUs.
        """
        fmus, masters, done, exchanges = self._kept_of(state)
        super().restore(state)
        try:
            self._begin()
            for name, process in self.processes.items():
                process.deserialize(fmus[name]["state"], fmus[name]["outputs"])
        except FmuError as error:
            self._fail(error)
            return
        for group, memory in zip(self._groups, masters, strict=True):
            group.master.memory = memory
        self._failed, self._done, self.exchanges = False, done, exchanges

    def _kept_of(self, state: Mapping[str, Any]) -> tuple[dict[str, Any], list[list[float]], list[int], int]:
        """What a state has of FMUs, masters, and exchanges.

        Raises
        ------
        InputError
            If it has none, or that of other FMUs or sample times.
        """
        expected = self.not_kept or f"that of {', '.join(self.processes)}"
        try:
            kept = json.loads(bytes(state[KEPT]))
            fmus = {name: kept["fmus"][name] for name in self.processes}
            every = kept["every"]
            masters, done, exchanges = (
                list(kept["masters"]),
                [int(k) for k in kept["done"]],
                int(kept["exchanges"]),
            )
            sound = all(
                isinstance(one["state"], str) and isinstance(one["outputs"], dict) for one in fmus.values()
            )
            same = all(one["token"] == self.processes[name].fmu.token for name, one in fmus.items())
        except (KeyError, ValueError, TypeError):
            raise InputError(
                "has no state of the FMUs", source="checkpoint", key=KEPT, expected=expected
            ) from None
        if not (sound and same and every == [group.every for group in self._groups]):
            raise InputError(
                "is the state of other FMUs or sample times", source="checkpoint", key=KEPT, expected=expected
            )
        return fmus, masters, done, exchanges
