"""The process in which an FMU runs: what it does there, and what it is asked through a pipe.

An FMU is foreign code. It may crash, hang or print; here that harms nobody. Requests and answers are JSON: a request
names what is to be done, an answer has the values, or ``error``, and what the FMU has logged. When the process that
asks is gone this one ends at once, whatever the FMU is doing.
"""

from __future__ import annotations

import base64
import contextlib
import ctypes
import json
import os
import shutil
import sys
import threading
from multiprocessing.connection import Connection
from typing import Any

__all__ = ["Host", "main"]

MOST_LINES = 20
"""Of a log in one answer."""
LONGEST_LINE = 500
STATUSES = ("ok", "warning", "discard", "error", "fatal", "pending")


class FmuRefusalError(RuntimeError):
    """The FMU ended, or wants to end, what it was asked."""


class Host:
    """One instance of an FMU of FMI 2 or 3.

    Parameters
    ----------
    version, identifier, token, folder
        Of the FMU, and where it is unpacked.
    name
        Of the instance.
    inputs, outputs
        Value references and types (``"Real"``, ``"Float64"``, ``"Float32"``) of what is exchanged.
    """

    def __init__(
        self,
        version: int,
        identifier: str,
        token: str,
        folder: str,
        name: str,
        inputs: list[tuple[int, str]],
        outputs: list[tuple[int, str]],
    ) -> None:
        self.lines: list[str] = []
        self._version, self._inputs, self._outputs = version, inputs, outputs
        self._states: dict[int, Any] = {}
        self._count = 0
        given = {"guid": token, "modelIdentifier": identifier, "unzipDirectory": folder, "instanceName": name}
        if version == 2:
            from fmpy import fmi2
            from fmpy.logging import addLoggerProxy

            def log(_place: Any, _name: bytes, status: int, _category: bytes, message: bytes) -> None:
                self._log(status, message)

            callbacks = fmi2.fmi2CallbackFunctions()
            callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(log)
            callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
            callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
            addLoggerProxy(ctypes.byref(callbacks))  # puts the arguments of a message into it
            self._fmu: Any = fmi2.FMU2Slave(**given)
            self._fmu.instantiate(callbacks=callbacks)
        else:
            from fmpy import fmi3

            def tell(_place: Any, status: int, _category: bytes, message: bytes) -> None:
                self._log(status, message)

            self._fmu = fmi3.FMU3Slave(**given)
            self._fmu.instantiate(logMessage=tell)

    def _log(self, status: int, message: bytes | None) -> None:
        """Keep what the FMU warns of; of more than there is room for the last."""
        if status == 0:  # what it says all the time
            return
        label = STATUSES[status] if 0 <= status < len(STATUSES) else str(status)
        text = (message or b"").decode("utf-8", "replace").strip()[:LONGEST_LINE]
        self.lines = [*self.lines[1 - MOST_LINES :], f"{label}: {text}"]

    def start(self, parameters: list[tuple[int, str, Any]], values: list[float]) -> list[float]:
        """Begin at t = 0 with parameters and inputs; the outputs there."""
        fmu = self._fmu
        if self._version == 2:
            fmu.setupExperiment(startTime=0.0)
        for reference, kind, value in parameters:
            getattr(fmu, f"set{kind}")([reference], [value])
        fmu.enterInitializationMode()
        self._set(values)
        fmu.exitInitializationMode()
        return self._get()

    def _set(self, values: list[float]) -> None:
        for (reference, kind), value in zip(self._inputs, values, strict=True):
            getattr(self._fmu, f"set{kind}")([reference], [value])

    def _get(self) -> list[float]:
        return [float(getattr(self._fmu, f"get{kind}")([reference])[0]) for reference, kind in self._outputs]

    def step(
        self, time: float, dt: float, values: list[float], rates: list[float] | None, ends: list[float] | None
    ) -> list[float]:
        """Advance with inputs, and with their rates if the FMU takes them; the outputs then, of inputs at the end."""
        fmu = self._fmu
        self._set(values)
        if rates and self._inputs:
            references = [reference for reference, _ in self._inputs]
            fmu.setRealInputDerivatives(references, [1] * len(rates), rates)
        if self._version == 2:
            fmu.doStep(time, dt, 0)
        else:
            _, terminate, early, last = fmu.doStep(time, dt, False)
            if terminate:
                raise FmuRefusalError("it asks to end the simulation")
            if early and last < time + dt * (1.0 - 1e-9):
                raise FmuRefusalError(f"it returned early, at t = {last:.9g} s")
        if ends is not None:
            self._set(ends)
        return self._get()

    def save(self) -> int:
        """Number of a copy of the state."""
        self._count += 1
        self._states[self._count] = self._fmu.getFMUState()
        return self._count

    def restore(self, number: int) -> None:
        """Go back to a copy."""
        self._fmu.setFMUState(self._states[number])

    def free(self, number: int) -> None:
        """Forget a copy."""
        self._fmu.freeFMUState(self._states.pop(number))

    def serialize(self) -> str:
        """The state as bytes, in base 64."""
        state = self._fmu.getFMUState()
        try:
            return base64.b64encode(self._fmu.serializeFMUState(state)).decode()
        finally:
            self._fmu.freeFMUState(state)

    def deserialize(self, text: str) -> list[float]:
        """Go to a state that was written as bytes; the outputs there."""
        state = self._fmu.deserializeFMUState(base64.b64decode(text))
        try:
            self._fmu.setFMUState(state)
        finally:
            self._fmu.freeFMUState(state)
        return self._get()

    def end(self) -> None:
        """Terminate and free the instance."""
        for number in list(self._states):
            self.free(number)
        self._fmu.terminate()
        self._fmu.freeInstance()


def serve(pipe: Connection) -> None:
    """Answer requests until there are no more."""
    host: Host | None = None
    while True:
        try:
            request = json.loads(pipe.recv_bytes())
        except (EOFError, OSError):
            return
        do, given = request.pop("do"), request
        answer: dict[str, Any] = {}
        try:
            if do == "load":
                host = Host(**given)
            else:
                answer["value"] = getattr(host, do)(**given)
        except Exception as error:  # noqa: BLE001  whatever it is, it is told and ends the run there
            answer["error"] = str(error) or type(error).__name__
        if host is not None:
            answer["log"], host.lines = host.lines, []
        pipe.send_bytes(json.dumps(answer).encode())
        if do == "end":
            return


def main() -> None:
    """Serve the pipe whose number is the first argument; the second one tells by its end that nobody asks any more.

    The third argument is the folder of the FMU, which is removed then.
    """
    pipe, life, folder = Connection(int(sys.argv[1])), int(sys.argv[2]), sys.argv[3]

    def watch() -> None:
        with contextlib.suppress(OSError):
            os.read(life, 1)
        shutil.rmtree(folder, ignore_errors=True)  # nobody else may be there to do it
        os._exit(0)

    threading.Thread(target=watch, daemon=True).start()
    serve(pipe)
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(0)  # whatever the FMU leaves behind in this process


if __name__ == "__main__":
    main()
