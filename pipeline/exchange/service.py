"""What the messages of a client do to a simulation; knows no sockets."""

from __future__ import annotations

import itertools
import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import InputError, in_one_line
from heavylift.pipeline.exchange.protocol import PROTOCOL, FormatError, check_request
from heavylift.pipeline.exchange.records import as_map
from heavylift.pipeline.results.storage import StopError
from heavylift.pipeline.stepping.state import State

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from heavylift.pipeline.exchange.protocol import Message
    from heavylift.pipeline.stepping.simulation import Simulation
    from heavylift.solver.scenario.operation import LogLine

__all__ = ["RefusedError", "Seat", "Service", "error_answer"]

LARGEST_COUNT = 1000
"""States that the server keeps for a master."""
LARGEST_STATES = 2**30
"""Bytes of them."""
KNOWN_LISTS, KNOWN_NAMES = 100, 1000
"""Lists of outputs whose columns are remembered, and names of one: those that are asked for at each step."""


class RefusedError(RuntimeError):
    """The server does not do this for this client."""


class Seat:
    """One client: its role and what the server keeps for it.

    Attributes
    ----------
    name
        Words for it, as its address.
    role
        ``"master"`` or ``"observer"``; empty before it has said who it is.
    closed
        Whether its last request is answered.
    """

    def __init__(self, name: str, *, trusted: bool = False) -> None:
        self.name, self.role, self.closed, self.trusted = name, "", False, trusted
        self.states: dict[int, Any] = {}
        self.handles = itertools.count(1)


class Service:
    """Answers requests.

    Parameters
    ----------
    simulation
        What is served.
    token
        What a client has to know, unless its seat is trusted.

    Attributes
    ----------
    master
        Who drives the run; None while nobody does.
    over
        Whether the master has ended the run.
    fault
        Words for an internal fault, after which the simulation is not to be trusted.
    """

    def __init__(self, simulation: Simulation, token: str = "") -> None:
        self.simulation, self.token = simulation, token
        self.master: Seat | None = None
        self.over = False
        self.fault = ""
        self._events: list[dict[str, Any]] = []
        self._columns: dict[tuple[str, ...], NDArray[np.int64] | None] = {}
        if simulation.case.scenario is not None:
            simulation.on_event(self._note)
        self._work: dict[str, Callable[[dict[str, Any], Seat], dict[str, Any]]] = {
            "hello": self._hello,
            "describe": self._describe,
            "set": self._set,
            "step": self._step,
            "get": self._get,
            "save": self._save,
            "restore": self._restore,
            "linearise": self._linearise,
            "free": self._free,
            "close": self._close,
        }

    def answer(self, request: dict[str, Any], seat: Seat) -> dict[str, Any]:
        """The answer to a request; a refused greeting closes the seat.

        Raises
        ------
        FormatError
            If the request has no number or no word: the connection has to be closed.
        """
        number = request.get("id")
        try:
            message = check_request(request)
            if message.do != "hello":
                self._check_seat(message, seat)
            fields = self._work[message.do](request, seat)
        except FormatError:
            raise
        except InputError as error:
            seat.closed = seat.closed or not seat.role
            return error_answer(number, "input", error.problem, error.key, error.expected)
        except RefusedError as error:
            seat.closed = seat.closed or not seat.role
            return error_answer(number, "refused", str(error))
        except StopError as error:
            told = error_answer(number, "stopped", str(error), error.outcome.name.lower())
            return {**told, "time": self.simulation.time, "ended": self.simulation.ended}
        except Exception as error:  # noqa: BLE001  a client has to hear of it, whatever it is
            self.fault = in_one_line(f"{type(error).__name__}: {error}")
            return error_answer(number, "internal", f"an internal error: {self.fault}")
        return {"id": number, "ok": True, **fields}

    def leave(self, seat: Seat) -> None:
        """A client has gone: what was kept for it is forgotten."""
        seat.states.clear()
        if seat is self.master:
            self.master = None

    def _check_seat(self, message: Message, seat: Seat) -> None:
        if not seat.role:
            raise RefusedError("the first request is 'hello'")
        if not message.observers and seat is not self.master:
            raise RefusedError(f"an observer cannot ask for {message.do!r}")

    def _hello(self, request: dict[str, Any], seat: Seat) -> dict[str, Any]:
        if seat.role:
            raise RefusedError(f"this connection is that of the {seat.role} already")
        if not seat.trusted and not _same(request.get("token", ""), self.token):
            raise RefusedError("wrong token: take the one that the server has printed")
        if request["protocol"] != PROTOCOL:
            raise RefusedError(f"protocol {request['protocol']}: this server speaks {PROTOCOL}")
        role = request["role"]
        if role not in {"master", "observer"}:
            raise InputError(f"{role!r}", key="hello.role", expected="master or observer")
        if role == "master":
            if self.master is not None:
                raise RefusedError(f"{self.master.name} is the master already; an observer may join")
            self.master = seat
        seat.role = role
        from importlib.metadata import version

        return {
            "protocol": PROTOCOL,
            "heavylift": version("heavylift"),
            "case": self.simulation.case.name,
            "role": role,
        }

    def _describe(self, request: dict[str, Any], seat: Seat) -> dict[str, Any]:
        del seat
        simulation = self.simulation
        listed = simulation.outputs.values() if request.get("outputs", True) else ()
        return {
            "inputs": [asdict(port) for port in simulation.inputs.values()],
            "outputs": [asdict(port) for port in listed],
            "step_size": simulation.step_size,
            "duration": simulation.duration,
            "outcome": simulation.outcome.name.lower(),
            "message": simulation.message,
            "time": simulation.time,
            "ended": simulation.ended,
        }

    def _set(self, request: dict[str, Any], seat: Seat) -> dict[str, Any]:
        del seat
        simulation, inputs = self.simulation, request["inputs"]
        before = simulation.save() if len(inputs) > 1 else None
        try:
            for name, given in inputs.items():
                value, rate, until = (*given, math.inf)[:3] if type(given) is list else (given, 0.0, math.inf)
                simulation.set(name, value, rate=rate, until=until)
        except InputError:
            if before is not None:  # all of them or none
                simulation.restore(before)
            raise
        return {"time": simulation.time}

    def _step(self, request: dict[str, Any], seat: Seat) -> dict[str, Any]:
        del seat
        simulation = self.simulation
        names = tuple(request.get("outputs", ()))
        columns = self._places(names)  # before anything moves
        simulation.step(request.get("dt"), request.get("inputs"))
        answer: dict[str, Any] = {
            "time": simulation.time,
            "values": self._values(names, columns),
            "ended": simulation.ended,
        }
        if self._events:
            answer["events"], self._events = self._events, []
        return answer

    def _get(self, request: dict[str, Any], seat: Seat) -> dict[str, Any]:
        del seat
        names = tuple(request["outputs"])
        return {"time": self.simulation.time, "values": self._values(names, self._places(names))}

    def _places(self, names: tuple[str, ...]) -> NDArray[np.int64] | None:
        """Columns of outputs in a record, found once; None if one is a channel of several numbers."""
        if names not in self._columns:
            simulation = self.simulation
            single = all(isinstance(simulation[name], float) for name in names)
            columns = simulation.columns(names) if single else None
            if len(names) > KNOWN_NAMES:
                return columns
            if len(self._columns) >= KNOWN_LISTS:
                self._columns.clear()
            self._columns[names] = columns
        return self._columns[names]

    def _values(self, names: Sequence[str], columns: NDArray[np.int64] | None) -> list[Any]:
        simulation = self.simulation
        if columns is not None:
            values: list[Any] = simulation.row[columns].tolist()
            return values
        found = (simulation[name] for name in names)
        return [value if isinstance(value, float) else value.tolist() for value in found]

    def _note(self, line: LogLine) -> None:
        self._events.append({"time": line.time, "phase": line.phase, "event": line.event, "what": line.what})

    def _save(self, request: dict[str, Any], seat: Seat) -> dict[str, Any]:
        number = request.get("state")
        as_bytes = request.get("bytes", False)
        if number is not None and not as_bytes:
            raise InputError(f"{number}", key="save.state", expected="'bytes' with it")
        if as_bytes:
            state = self.simulation.save() if number is None else self._state(number, seat, "save.state")
            return {"bytes": state.to_bytes()}
        if seat is not self.master:
            raise RefusedError("the server keeps no states for observers: ask for bytes")
        state = self.simulation.save()
        size = sum(array.nbytes for array in state.arrays.values())
        if len(seat.states) >= min(LARGEST_COUNT, max(1, LARGEST_STATES // size)):
            raise RefusedError(f"{len(seat.states)} states of {size} bytes are kept already: free some")
        handle = next(seat.handles)
        seat.states[handle] = state
        return {"state": handle}

    def _restore(self, request: dict[str, Any], seat: Seat) -> dict[str, Any]:
        if ("state" in request) == ("bytes" in request):
            raise InputError("both or none", key="restore", expected="either 'state' or 'bytes'")
        if "state" in request:
            state = self._state(request["state"], seat, "restore.state")
        else:
            state = State.from_bytes(request["bytes"])
        self.simulation.restore(state)
        self._events.clear()
        return {"time": self.simulation.time, "ended": self.simulation.ended}

    def _linearise(self, request: dict[str, Any], seat: Seat) -> dict[str, Any]:
        del seat
        found = self.simulation.linearise(request.get("inputs"), request.get("outputs"))
        return {"linearisation": as_map(found)}

    def _free(self, request: dict[str, Any], seat: Seat) -> dict[str, Any]:
        self._state(request["state"], seat, "free.state")
        del seat.states[request["state"]]
        return {}

    def _state(self, handle: int, seat: Seat, key: str) -> Any:
        if handle not in seat.states:
            raise InputError(f"{handle}", key=key, expected="the handle of a state that is kept")
        return seat.states[handle]

    def _close(self, request: dict[str, Any], seat: Seat) -> dict[str, Any]:
        seat.closed = True
        if seat is self.master:
            self.over = request.get("end", True)
        return {}


def _same(given: str, token: str) -> bool:
    """Whether two texts are the same, in a time that does not depend on where they differ."""
    import secrets

    return secrets.compare_digest(given.encode("utf-8", "surrogatepass"), token.encode())


def error_answer(
    number: object, kind: str, problem: str, key: str = "", expected: str = ""
) -> dict[str, Any]:
    """The answer to a request that was not done, or to bytes that are none (`number` is None)."""
    error = {"kind": kind, "problem": problem, "key": key, "expected": expected}
    return {"id": number, "ok": False, "error": error}
