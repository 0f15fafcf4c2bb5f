"""An FMU in a process of its own: it is asked through a pipe, and what goes wrong there is one error here."""

from __future__ import annotations

import contextlib
import json
import math
import os
import shutil
import signal
import subprocess
import tempfile
import weakref
from multiprocessing import Pipe
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from heavylift.numerics.children import NEUTRAL_FOLDER, module_folders, python_command
from heavylift.numerics.outcome import InputError, in_one_line
from heavylift.pipeline.coupling.fmu_file import REALS, unpack_fmu

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from multiprocessing.connection import Connection
    from typing import BinaryIO

    from heavylift.pipeline.coupling.fmu_file import FmuFile, FmuVariable

__all__ = ["FmuError", "FmuProcess"]

KEPT_LINES = 20
"""Of what an FMU has logged, the last ones."""
PATIENCE = 5.0
"""Time [s] that an FMU has to end by itself."""
LOADING = 60.0
"""Time [s] that its process has to begin, at least."""
LOUDEST = 20_000
"""Bytes of what an FMU has printed that are looked at."""


class FmuError(RuntimeError):
    """An FMU has crashed, hangs, or refuses what it was asked."""


class FmuProcess:
    """One instance of an FMU, as a system of `heavylift.pipeline.coupling.master.Master`.

    Parameters
    ----------
    fmu
        Read and checked.
    name
        For messages and of the instance.
    inputs, outputs
        Names of variables that are set and read.
    parameters
        Values by name.
    timeout
        Longest time [s] of one call.

    Attributes
    ----------
    log
        The last lines that it has logged.

    Raises
    ------
    FmuError
        If it cannot be loaded or instantiated, and by all methods, if it crashes, takes longer than its time, returns
        an error or an output that is no finite number. The process is then gone.
    """

    def __init__(
        self,
        fmu: FmuFile,
        name: str,
        inputs: Sequence[str],
        outputs: Sequence[str],
        parameters: Mapping[str, Any],
        timeout: float,
    ) -> None:
        self.fmu, self.name, self.timeout = fmu, name, timeout
        self.log: list[str] = []
        self._inputs, self._outputs = tuple(inputs), tuple(outputs)
        self._parameters = [(fmu.variables[key], value) for key, value in parameters.items()]
        self._values = dict.fromkeys(self._inputs, 0.0)
        self._rates = dict.fromkeys(self._inputs, 0.0)
        self._found: dict[str, float] = {}
        self._saved = 0
        folder = Path(tempfile.mkdtemp(prefix="heavylift_fmu_"))
        try:
            try:
                unpack_fmu(fmu, folder)
            except InputError as error:
                raise FmuError(
                    f"FMU {name!r} ({fmu.title}): {error.problem}; expected {error.expected}"
                ) from None
            self._pipe, self._life, self._process, self._printed = _begin(folder)
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        self._close = weakref.finalize(
            self, _end, self._process, self._pipe, self._life, self._printed, folder
        )
        self._ask(
            "load",
            version=fmu.version,
            identifier=fmu.identifier,
            token=fmu.token,
            folder=str(folder),
            name=name,
            inputs=[_place(fmu.variables[one]) for one in self._inputs],
            outputs=[_place(fmu.variables[one]) for one in self._outputs],
        )

    def start(self, values: Mapping[str, float]) -> None:
        """Begin at t = 0 with its parameters and inputs there."""
        self._values.update(values)
        parameters = [
            (one.reference, _accessor(one, self.fmu.version), value) for one, value in self._parameters
        ]
        self._take("start", parameters=parameters, values=list(self._values.values()))

    def set(self, values: Mapping[str, float], rates: Mapping[str, float]) -> None:
        """Inputs from the present time on; see `heavylift.pipeline.coupling.master.System`."""
        self._values.update(values)
        self._rates.update(rates)

    def step(self, time: float, dt: float) -> None:
        """Advance with inputs that are constant or have rates.

        An FMU that does not interpolate gets the mean of each input over the interval, and then, for its outputs, the
        value at the end.
        """
        values, rates = list(self._values.values()), list(self._rates.values())
        ends = None
        if any(rates):
            ends = [value + rate * dt for value, rate in zip(values, rates, strict=True)]
            if not self.fmu.interpolates:
                values = [0.5 * (value + end) for value, end in zip(values, ends, strict=True)]
        told = rates if ends is not None and self.fmu.interpolates else None
        self._take("step", when=time, time=time, dt=dt, values=values, rates=told, ends=ends)

    def outputs(self) -> Mapping[str, float]:
        """Outputs at the present time, by the names of its variables."""
        return self._found

    def save(self) -> tuple[int, dict[str, float]]:
        """A copy of the state, which stays in the process until the next one is made."""
        before, self._saved = self._saved, int(self._ask("save"))
        if before:
            self._ask("free", number=before)
        return self._saved, dict(self._found)

    def restore(self, state: tuple[int, dict[str, float]]) -> None:
        """Go back to a copy."""
        self._ask("restore", number=state[0])
        self._found = dict(state[1])

    def serialize(self) -> str:
        """The state as text, which `deserialize` takes in any process with the same FMU."""
        return str(self._ask("serialize"))

    def deserialize(self, text: str, outputs: Mapping[str, float]) -> None:
        """Go to a state that was written, and to the outputs that it had."""
        self._ask("deserialize", text=text)
        self._found = dict(outputs)

    def close(self) -> None:
        """Terminate the instance and end the process; an FMU that is gone already is no error."""
        with contextlib.suppress(FmuError):
            if self._close.alive:
                self._ask("end", patience=min(PATIENCE, self.timeout))
        self._close()

    def _take(self, do: str, *, when: float | None = None, **given: Any) -> None:
        found = self._ask(do, when=when, **given)
        self._found = dict(zip(self._outputs, found, strict=True))
        for output, value in self._found.items():
            if not math.isfinite(value):
                self._fail(f"its output {output!r} is {value}", when)

    def _ask(self, do: str, *, when: float | None = None, patience: float | None = None, **given: Any) -> Any:
        """What the process answers to a request."""
        if not self._close.alive:
            self._fail("its process has ended", when)
        seconds = self.timeout if patience is None else patience
        if do == "load":
            seconds = max(seconds, LOADING)  # most of it is not the FMU's
        verb = {"load": "be loaded", "start": "start", "step": "make a step"}.get(do, do)
        try:
            self._pipe.send_bytes(json.dumps({"do": do, **given}).encode())
            if not self._pipe.poll(seconds):
                self._fail(f"has not answered for {seconds:g} s when asked to {verb}", when)
            answer = json.loads(self._pipe.recv_bytes())
        except ValueError:  # foreign code may write where it should not
            self._fail(f"gave an answer that cannot be read when asked to {verb}", when)
        except (EOFError, OSError):
            self._fail(f"{self._ending()} when asked to {verb}", when)
        self.log = [*self.log, *(in_one_line(line) for line in answer.get("log", ()))][-KEPT_LINES:]
        if "error" in answer:
            self._fail(f"cannot {verb}: {in_one_line(answer['error'])}", when)
        return answer.get("value")

    def _ending(self) -> str:
        """How the process has ended, in words."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(PATIENCE)
        code = self._process.returncode
        if code is not None and code < 0:
            with contextlib.suppress(ValueError):
                return f"crashed with {signal.Signals(-code).name}"
        return f"ended its process with exit code {code}"

    def _fail(self, problem: str, when: float | None) -> NoReturn:
        """End the process, and say what has happened and what the FMU said."""
        said = self.log[-3:] or self._last_printed()
        if self._close.alive:
            _kill(self._process)
        self._close()
        place = "" if when is None else f"t = {when:.9g} s: "
        words = f"; it said: {'; '.join(said)}" if said else ""
        raise FmuError(f"{place}FMU {self.name!r} ({self.fmu.title}): {problem}{words}")

    def _last_printed(self) -> list[str]:
        """Last line that was printed, of a file of which nobody knows how long it is."""
        if self._printed.closed:
            return []
        size = self._printed.seek(0, os.SEEK_END)
        self._printed.seek(max(0, size - LOUDEST))
        lines = self._printed.read().decode("utf-8", "replace").strip().splitlines()
        return [in_one_line(line) for line in lines[-1:]]


def _place(variable: FmuVariable) -> tuple[int, str]:
    return variable.reference, REALS[variable.type]


def _accessor(variable: FmuVariable, version: int) -> str:
    """End of the name of the function of FMPy that sets a variable."""
    if variable.type == "Enumeration":
        return "Integer" if version == 2 else "Int64"
    return variable.type


def _begin(folder: Path) -> tuple[Connection, int, subprocess.Popen[bytes], BinaryIO]:
    """Start the process; our end of its pipe, what it lives by, and what it prints."""
    ours, theirs = Pipe()
    life, alive = os.pipe()
    printed = (folder / "heavylift_printed.txt").open("w+b")
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(module_folders())}
    numbers = (theirs.fileno(), life)
    try:
        process = subprocess.Popen(  # noqa: S603
            python_command("-m", "heavylift.pipeline.coupling.fmu_host", *map(str, numbers), str(folder)),
            stdin=subprocess.DEVNULL,
            stdout=printed,
            stderr=subprocess.STDOUT,
            pass_fds=numbers,
            env=environment,
            cwd=NEUTRAL_FOLDER,
            start_new_session=True,  # keys of a terminal are for us, and what it starts ends with it
        )
    except BaseException:
        ours.close()
        os.close(alive)
        printed.close()
        raise
    finally:
        theirs.close()
        os.close(life)
    return ours, alive, process, printed


def _kill(process: subprocess.Popen[bytes]) -> None:
    """End a process and what it has started."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)


def _end(
    process: subprocess.Popen[bytes], pipe: Connection, life: int, printed: BinaryIO, folder: Path
) -> None:
    """Leave nothing behind: no process, no pipe, no folder."""
    pipe.close()
    os.close(life)
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(PATIENCE)
    _kill(process)
    process.wait()
    printed.close()
    shutil.rmtree(folder, ignore_errors=True)
