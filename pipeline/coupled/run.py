"""Runs coupled scenes: what they exchange fits, the exchange is stable, all of them end together."""

from __future__ import annotations

import contextlib
import json
import math
from operator import itemgetter
from typing import TYPE_CHECKING, Any, Self

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.numerics.units import parse_unit
from heavylift.pipeline.coupled.scene_system import SceneSystem
from heavylift.pipeline.coupled.stability import EXCHANGES, GROWS, exchange_stability
from heavylift.pipeline.coupling.master import Link, Master
from heavylift.pipeline.exchange.client import ExchangeError, connect, open_child
from heavylift.pipeline.results.storage import OutputFolder, StopError, read_json, write_json
from heavylift.pipeline.stages.advance import stop_requests
from heavylift.pipeline.stepping.simulation import Simulation

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from heavylift.pipeline.coupled.coupling_file import Coupling
    from heavylift.pipeline.coupled.stability import ExchangeStability
    from heavylift.pipeline.exchange.client import RemoteSimulation
    from heavylift.pipeline.log import Log

__all__ = ["CoupledReport", "CoupledScenes", "coupled_document", "run_coupled"]

WHOLE = 1e-9
"""Of a step, by which a time may be off a whole number of steps."""
SOON = 1.2
"""Growth in an exchange that needs no second look."""
GROWN = 10.0
"""Growth of deviations over a run, from which on its results are in doubt."""
COARSE = 0.1
"""Of the largest value of a link, by which what is told of the end of an interval may be off without a word."""
HALVINGS = 12
"""Of an interval, in which a stable one is looked for."""


@dataclass(frozen=True)
class CoupledReport:
    """How coupled scenes ended.

    Attributes
    ----------
    outcome, message
        Of the whole.
    time
        Reached [s].
    exchanges, repetitions
        Intervals, and how often one was repeated in the mean.
    stability
        Of the exchange at the start; None if a scene stopped while it was looked at.
    folders
        Results of each scene, but of those that are served: they are with their servers.
    cpu_s
        CPU time of the steps of each scene, as far as its manifest tells [s].
    warning
        What the user should know of the exchange; empty if nothing.
    """

    outcome: Outcome
    message: str
    time: float
    exchanges: int
    repetitions: float
    stability: ExchangeStability | None
    folders: Mapping[str, Path]
    cpu_s: Mapping[str, float]
    warning: str = ""


class CoupledScenes:
    """Scenes that are coupled as a file says, at their start.

    Parameters
    ----------
    coupling
        From `heavylift.pipeline.coupled.coupling_file.load_coupling`.
    out
        Folder for the results, one a scene.

    Attributes
    ----------
    scenes
        By name.
    master
        That advances them.

    Raises
    ------
    InputError
        If a scene is wrong, what is linked does not fit together, or the exchange is not stable.
    """

    def __init__(self, coupling: Coupling, out: Path) -> None:
        self.coupling = coupling
        self.folders = {
            name: out / name for name, section in coupling.scenes.items() if section.process != "served"
        }
        self._open = contextlib.ExitStack()
        self.scenes: dict[str, Any] = {}
        try:
            for name in coupling.scenes:
                self.scenes[name] = self._opened(name)
            self.links = self._links()
            self.systems = {
                name: SceneSystem(name, scene, [link.output for link in self.links if link.source == name])
                for name, scene in self.scenes.items()
            }
            self.interval = coupling.exchange.interval
            self.duration = self._duration()
            self._check_steps()
            self._place_links()
            exchange = coupling.exchange
            self.stability: ExchangeStability | None = self._stability(self.interval)
            self._refuse_unstable()
            self.master = Master(self.systems, self.links, exchange.method, tolerance=exchange.tolerance)
        except ExchangeError as error:  # of a scene that is gone
            self.close()
            raise StopError(Outcome.INTERRUPTED, str(error)) from None
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the processes of scenes that run elsewhere, those of FMUs, and connections."""
        self._open.close()

    def _opened(self, name: str) -> Any:
        """A scene, here, in a process of its own, or at an address."""
        section, coupling = self.coupling.scenes[name], self.coupling
        folder, out = coupling.folder / section.case, self.folders.get(name)
        scene: Simulation | RemoteSimulation
        try:
            if section.process == "same":
                scene = Simulation(folder, out=out, overrides=section.set)
            elif section.process == "own":
                scene = open_child(folder, out=out, overrides=section.set)
            else:
                assert section.token_file is not None
                scene = connect(token_file=coupling.folder / section.token_file)
        except ExchangeError as error:
            raise self._error(str(error), f"scenes.{name}", "a process that answers") from None
        self._open.callback(scene.close)
        return scene

    def _error(self, problem: str, key: str, expected: str) -> InputError:
        return InputError(problem, source=self.coupling.file, key=key, expected=expected)

    def _links(self) -> list[Link]:
        """The links of the file, of which both ends are there and have one dimension."""
        found = []
        for index, link in enumerate(self.coupling.links):
            (source, output), (target, name) = link.source, link.target
            outputs, inputs = self.scenes[source].outputs, self.scenes[target].inputs
            if output not in outputs:
                raise self._error(
                    f"{source!r} has no output {output!r}", f"links.{index}.output", _near(output, outputs)
                )
            if name not in inputs:
                raise self._error(
                    f"{target!r} has no input {name!r}", f"links.{index}.input", _near(name, inputs)
                )
            units = outputs[output].unit, inputs[name].unit
            dimensions = [parse_unit(unit)[1] for unit in units]
            if abs(link.factor) == 1.0 and dimensions[0] != dimensions[1]:
                raise self._error(
                    f"{link.output!r} is in {units[0]}, and {link.input!r} in {units[1]}",
                    f"links.{index}.input",
                    "two ends of one quantity, or a 'factor' between them",
                )
            if inputs[name].unit in {"m/s", "rad/s"} and inputs[name].interpolation == "held":
                raise self._error(
                    f"the speed {link.input!r} jumps at exchanges, and nobody feels what that takes",
                    f"links.{index}.input",
                    f'interpolation = "linear" of the input {name!r}',
                )
            offset = 0.0 if link.offset == "start" else float(link.offset)
            found.append(Link(source, output, target, name, link.factor, offset))
        return found

    def _duration(self) -> float:
        """Of the whole run [s]."""
        shortest = min(self.scenes, key=lambda name: self.scenes[name].duration)
        end: float = self.scenes[shortest].duration
        wanted = self.coupling.exchange.duration
        if wanted is None:
            return end
        if wanted > end * (1.0 + WHOLE):
            raise self._error(
                f"{wanted:g} s, and {shortest!r} ends at {end:g} s", "exchange.duration", f"at most {end:g} s"
            )
        return wanted

    def _check_steps(self) -> None:
        """The interval is a multiple of the steps of all scenes, and the duration one of the interval."""
        whole = [
            ("exchange.interval", self.interval, scene.step_size, f"the step of {name!r}")
            for name, scene in self.scenes.items()
        ]
        whole.append(("exchange.duration", self.duration, self.interval, "the interval"))
        for key, length, part, what in whole:
            if abs(length / part - round(length / part)) > WHOLE * max(
                1.0, length / part
            ) or length < part * (1 - WHOLE):
                raise self._error(
                    f"{length:g} s is {length / part:.6g} times {what}, {part:g} s",
                    key,
                    f"a multiple of {part:g} s",
                )

    def _place_links(self) -> None:
        """Links whose offset is "start" begin with what their inputs are."""
        for index, (link, section) in enumerate(zip(self.links, self.coupling.links, strict=True)):
            if section.offset == "start":
                value = self.scenes[link.source][link.output]
                start = self.scenes[link.target].inputs[link.input].value
                self.links[index] = link._replace(offset=start - link.factor * value)

    def _stability(self, interval: float) -> ExchangeStability | None:
        """Of the exchange at the start; None if a scene stops while it is looked at."""
        saved = {name: system.save() for name, system in self.systems.items()}
        whole = int((self.duration + WHOLE * interval) / interval)
        try:
            found = self._looked_at(interval, max(8, min(EXCHANGES, whole)))
            if GROWS < found.growth < SOON and whole > EXCHANGES:
                # what begins to move grows too; what is not stable goes on to grow
                found = self._looked_at(interval, min(4 * EXCHANGES, whole))
        except StopError:
            for name, system in self.systems.items():
                system.restore(saved[name])
            return None
        return found

    def _looked_at(self, interval: float, count: int) -> ExchangeStability:
        """Stability over some exchanges."""
        method = self.coupling.exchange.method
        return exchange_stability(self.systems, self.links, method, 0.0, interval, count=count)

    def _refuse_unstable(self) -> None:
        """Say what would be stable: a shorter interval, or another method."""
        if self.stability is None or self.stability.stable:
            return
        steps = max(scene.step_size for scene in self.scenes.values())
        found = ""
        for halving in range(1, HALVINGS):
            count = round(self.interval / 2**halving / steps)
            if count < 1:
                break
            shorter = self._stability(count * steps)
            if shorter is not None and shorter.stable:
                found = f"at most {count * steps:g} s"
                break
        others = (
            "method 'iterated'"
            if self.coupling.exchange.method != "iterated"
            else "a scene with a larger mass at the joint"
        )
        raise self._error(
            f"{self.coupling.exchange.method!r} is {self.stability.text}",
            "exchange.interval",
            " or ".join(filter(None, [found, others])),
        )


def run_coupled(coupling: Coupling, out: Path, log: Log) -> CoupledReport:
    """Run coupled scenes to their common end, and keep what each of them has.

    Parameters
    ----------
    coupling
        From `heavylift.pipeline.coupled.coupling_file.load_coupling`.
    out
        Folder for the results, one a scene, and for ``coupling.json``.
    log
        Told what happens.

    Raises
    ------
    InputError
        If a scene is wrong, what is linked does not fit together, or the exchange is not stable.
    """
    with CoupledScenes(coupling, out) as coupled:
        told = coupled.stability
        words = "stability is not known: a scene stops while it is looked at" if told is None else told.text
        log.say(f"couple: {coupling.exchange.method}: {words}")
        master, interval = coupled.master, coupled.interval
        count = round(coupled.duration / interval)
        outcome, message, done = Outcome.COMPLETED, "", 0
        with stop_requests() as stop, log.progress("couple", count) as progress:
            try:
                while done < count and not stop:
                    master.step(done * interval, interval)
                    done += 1
                    progress(done, f"t = {done * interval:.4g} s")
            except StopError as error:
                outcome, message = error.outcome, str(error)
            except ExchangeError as error:  # of a scene that is gone
                outcome, message = Outcome.INTERRUPTED, str(error)
        if stop and outcome is Outcome.COMPLETED:
            outcome, message = Outcome.INTERRUPTED, f"{stop.signal_name} at t = {done * interval:.9g} s"
        warning = _doubts(coupled, master, done)
        if warning:
            log.say(f"couple: WARNING: {warning}")
        repetitions = master.iterations / done if done and master.iterations else 1.0
        for name, scene in coupled.scenes.items():
            if isinstance(scene, Simulation):  # others write what they have when they are closed
                details = scene.write_results(coupled.folders[name]).details
                if details.get("warning"):
                    log.say(f"couple: {name}: WARNING: {details['warning']}")
    report = CoupledReport(
        outcome,
        message,
        done * interval,
        done,
        repetitions,
        coupled.stability,
        coupled.folders,
        {name: _cpu_seconds(folder) for name, folder in coupled.folders.items()},
        warning,
    )
    write_json(out / "coupling.json", coupled_document(coupling, report))
    log.say(f"couple: {outcome.text}: {done} exchanges of {interval:g} s, {repetitions:.3g} passes each")
    return report


def _doubts(coupled: CoupledScenes, master: Master, done: int) -> str:
    """Why the results of an exchange may be wrong: it may be unstable slowly, or too coarse; empty if neither."""
    words = []
    stability = coupled.stability
    if stability is not None and done * math.log(max(stability.growth, 1.0)) > math.log(GROWN):
        times = math.exp(min(done * math.log(stability.growth), 700.0))
        words.append(
            f"deviations that grow {stability.growth:.4f} times in an exchange have grown up to {times:.1g} times in "
            f"{done}: compare with a shorter interval, or with method 'iterated'"
        )
    missed = max(zip(master.misses, master.links, strict=True), key=itemgetter(0))
    if missed[0] > COARSE:
        link = missed[1]
        words.append(
            f"{link.output!r} of {link.source!r} changes by up to {100.0 * missed[0]:.0f} % of its largest value in an "
            "exchange more than is told of it: the interval is long for what moves there"
        )
    return "; ".join(words)


def _cpu_seconds(folder: Path) -> float:
    """What the manifest of a run says."""
    manifest = read_json(OutputFolder(folder).manifest("simulate")) or {}
    return float((manifest.get("details") or {}).get("cpu_s", 0.0))


def coupled_document(coupling: Coupling, report: CoupledReport) -> dict[str, Any]:
    """The report as plain values."""
    stability = report.stability
    return {
        "title": coupling.title,
        "exchange": json.loads(coupling.exchange.model_dump_json()),
        "outcome": report.outcome.name.lower(),
        "message": report.message,
        "time": report.time,
        "exchanges": report.exchanges,
        "passes_each": report.repetitions,
        "warning": report.warning,
        "growth": stability.growth if stability is not None and math.isfinite(stability.growth) else None,
        "loop_gain": None if stability is None else stability.gain,
        "scenes": {name: str(folder) for name, folder in report.folders.items()},
    }


def _near(name: str, known: Mapping[str, Any]) -> str:
    """The nearest names."""
    from difflib import get_close_matches

    near = get_close_matches(name, known, 3, 0.4) or list(known)[:3]
    return f"one of its own: {', '.join(near) or 'it has none'}"
