"""A simulation in another process, with the methods of one in this process.

>>> import heavylift
>>> with heavylift.connect("127.0.0.1", 5000, token) as crane:  # doctest: +SKIP
...     crane.step(0.01, {"gust": 1e4}, outputs=["module.position.z"])
...     crane["module.position.z"]
"""

from __future__ import annotations

import contextlib
import math
import os
import socket
import subprocess
import weakref
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np

from heavylift.numerics.children import python_command
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.exchange.protocol import (
    HEADER,
    LARGEST_MESSAGE,
    PROTOCOL,
    FormatError,
    framed,
    msgpack_library,
    unpacked,
)
from heavylift.pipeline.exchange.records import of_map

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.stepping.simulation import InputInfo, OutputInfo
    from heavylift.solver.linearise.result import Linearisation

__all__ = ["ExchangeError", "RemoteEvent", "RemoteSimulation", "RemoteState", "connect", "open_child"]

TIMEOUT = 600.0
"""Until an answer must have come [s], unless another time is given: a first start may compile kernels."""
LONGEST_TIMEOUT = 1e8
"""[s]; a longer one is beyond what a system can wait."""
STOP_SECONDS = 60.0
"""That a child has to write its results and end."""
PIECE = 2**16
"""Bytes of a read."""


class ExchangeError(RuntimeError):
    """The other process refuses, has a fault, or is gone.

    Attributes
    ----------
    kind
        ``"refused"``, ``"internal"``, or ``"lost"`` if the connection cannot be used any more.
    """

    def __init__(self, kind: str, message: str) -> None:
        self.kind = kind
        super().__init__(message)


class RemoteEvent(NamedTuple):
    """A line of the log of a scenario: time [s], name of the phase, what sort of thing, and words for it."""

    time: float
    phase: str
    event: str
    what: str


class RemoteState:
    """A state that the other process keeps; it is forgotten there once this object is.

    Attributes
    ----------
    time
        Of the simulation in that state [s].
    """

    def __init__(self, owner: RemoteSimulation, handle: int, time: float) -> None:
        self._owner, self._handle, self.time = owner, handle, time
        weakref.finalize(self, owner._unused.append, handle)  # noqa: SLF001

    def to_bytes(self) -> bytes:
        """The state for another process, or for a file.

        Returns
        -------
        bytes
            What `heavylift.State.from_bytes` and `RemoteSimulation.restore` read.
        """
        return self._owner._ask("save", state=self._handle, bytes=True)["bytes"]  # noqa: SLF001


class RemoteSimulation:
    """A simulation that another process computes: made by `connect` or `open_child`.

    Its methods are those of `heavylift.Simulation`, with the same errors. Within ``with`` it is closed at the end. It
    belongs to one thread at a time.

    Attributes
    ----------
    case
        Name of its case.
    role
        ``"master"`` or ``"observer"``.
    time, ended
        Where it stands [s], and whether time goes no further; of an observer after the last answer.
    step_size, duration
        Its step and its end [s].

    Examples
    --------
    >>> import heavylift as hl
    >>> with hl.open_child("cases/hoist") as crane:
    ...     begin = crane.save()
    ...     answer = crane.step(1.0)
    ...     crane.restore(begin)
    ...     print(crane.case, crane.role, crane.time)
    hoist master 0.0
    """

    def __init__(
        self,
        connection: socket.socket,
        name: str,
        *,
        role: str,
        token: str,
        child: subprocess.Popen[bytes] | None = None,
    ) -> None:
        library = msgpack_library()
        self._library, self._pack = library, library.Packer(autoreset=True).pack
        self._connection, self._name, self._child = connection, name, child
        self._number, self._incoming = 0, b""
        self.time, self.ended = 0.0, False
        self._unused: list[int] = []
        self._values: dict[str, Any] = {}
        self._callbacks: list[Callable[[RemoteEvent], None]] = []
        self._end = weakref.finalize(self, _ended, connection, child)
        self._inputs: dict[str, InputInfo] | None = None
        try:
            greeting = self._ask("hello", protocol=PROTOCOL, role=role, token=token)
            self.case, self.role = greeting["case"], greeting["role"]
            self._outputs = self._describe()
        except BaseException:
            self._end()
            raise

    @property
    def child_id(self) -> int | None:
        """Number of the process that `open_child` has started; None of one that was there."""
        return None if self._child is None else self._child.pid

    @property
    def inputs(self) -> Mapping[str, InputInfo]:
        """What may be set, with the values of now."""
        if self._inputs is None or self.role == "observer":
            self._refresh()
        assert self._inputs is not None
        return self._inputs

    @property
    def outcome(self) -> Outcome:
        """How it stands; `Outcome.COMPLETED` as long as nothing is wrong."""
        return Outcome[self._refresh()["outcome"].upper()]

    @property
    def message(self) -> str:
        """Why it has stopped by itself; empty if it has not."""
        return str(self._refresh()["message"])

    @property
    def outputs(self) -> Mapping[str, OutputInfo]:
        """What may be read."""
        return self._outputs

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
        self._changed(self._ask("set", inputs=_plain({name: (value, rate, until)})))

    def step(
        self,
        dt: float | None = None,
        inputs: Mapping[str, Any] | None = None,
        outputs: Sequence[str] = (),
    ) -> None:
        """Advance by `dt` [s], a multiple of the step; one step without it.

        Parameters
        ----------
        dt
            How far [s].
        inputs
            Held inputs act from now on, linear ones are reached at the end.
        outputs
            What is fetched with the same message: reading it afterwards costs nothing.

        Raises
        ------
        InputError
            If the call is wrong; nothing has changed then.
        SimulationStopped
            If the simulation has stopped by itself, with outcome and message; what was computed is kept.
        """
        fields: dict[str, Any] = {}
        if dt is not None:
            fields["dt"] = _number(dt)
        if inputs:
            fields["inputs"] = _plain(inputs)
        if outputs:
            fields["outputs"] = outputs
        answer = self._ask("step", **fields)
        self._changed(answer)
        self._values = dict(zip(outputs, answer["values"], strict=True))
        for line in answer.get("events", ()):
            for callback in self._callbacks:
                callback(RemoteEvent(**line))

    def get(self, outputs: Sequence[str]) -> list[float | NDArray[np.float64]]:
        """Values of several outputs, by one message for all that are not known yet."""
        missing = [name for name in outputs if name not in self._values]
        if missing:
            answer = self._ask("get", outputs=missing)
            if answer["time"] != self.time:  # an observer: the master has stepped meanwhile
                self._changed(answer)
                missing = list(outputs)
                answer = self._ask("get", outputs=missing)
            self._values.update(zip(missing, answer["values"], strict=True))
        values = [self._values[name] for name in outputs]
        return [np.array(value) if type(value) is list else value for value in values]

    def __getitem__(self, name: str) -> float | NDArray[np.float64]:
        """Value of an output; an array for a channel of several numbers."""
        if self.role == "observer":
            self._values.clear()
        return self.get([name])[0]

    def save(self) -> RemoteState:
        """The state, inputs included; it stays in the other process.

        Raises
        ------
        ExchangeError
            If this is an observer: see `save_bytes`.
        """
        while self._unused:
            self._ask("free", state=self._unused.pop())
        return RemoteState(self, self._ask("save")["state"], self.time)

    def save_bytes(self) -> bytes:
        """The state for another process, or for a file."""
        return self._ask("save", bytes=True)["bytes"]

    def restore(self, state: Any) -> None:
        """Go back to a state of this simulation, or over to one of another that runs the same case.

        Parameters
        ----------
        state
            A `RemoteState`, a `heavylift.State`, or the bytes of one.

        Raises
        ------
        InputError
            If it is not one of the same case.
        """
        if isinstance(state, RemoteState) and state._owner is self:  # noqa: SLF001
            self._changed(self._ask("restore", state=state._handle))  # noqa: SLF001
            return
        self._changed(self._ask("restore", bytes=state if isinstance(state, bytes) else state.to_bytes()))

    def linearise(
        self, inputs: Sequence[str] | None = None, outputs: Sequence[str] | None = None
    ) -> Linearisation:
        """Matrices and modes of small motions about the state now, which stays as it is.

        Parameters
        ----------
        inputs, outputs
            Names of inputs, all by default, and of outputs, none by default.

        Raises
        ------
        InputError
            If something of the scene has no linear motion, or a name is unknown.
        """
        from heavylift.solver.linearise.result import BodyShape, Linearisation

        wanted = {"inputs": inputs, "outputs": outputs}
        chosen = {key: list(names) for key, names in wanted.items() if names is not None}
        found = of_map(self._ask("linearise", **chosen)["linearisation"])
        found["shapes"] = {name: BodyShape(**shape) for name, shape in found["shapes"].items()}
        return Linearisation(**found)

    def on_event(self, callback: Callable[[RemoteEvent], None]) -> None:
        """Call a function with each line of the log of the scenario, once a step has passed it."""
        self._callbacks.append(callback)

    def close(self, *, end: bool = True) -> None:
        """End the run if this is its master, and the connection.

        Parameters
        ----------
        end
            False: the run stays, and waits for another master. A child ends in any case.
        """
        if not self._end.alive:
            return
        try:
            with contextlib.suppress(ExchangeError):  # it has ended by itself
                self._ask("close", **({} if end else {"end": False}))
        finally:
            self._end()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _describe(self) -> dict[str, OutputInfo]:
        """What never changes; the outputs of it."""
        from heavylift.pipeline.stepping.simulation import OutputInfo

        answer = self._ask("describe")
        self.step_size, self.duration = answer["step_size"], answer["duration"]
        self.time, self.ended = answer["time"], answer["ended"]
        return {each["name"]: OutputInfo(**each) for each in answer["outputs"]}

    def _refresh(self) -> dict[str, Any]:
        """What changes."""
        from heavylift.pipeline.stepping.simulation import InputInfo

        answer = self._ask("describe", outputs=False)
        if answer["time"] != self.time:
            self._changed(answer)
        self.ended = answer["ended"]
        self._inputs = {each["name"]: InputInfo(**each) for each in answer["inputs"]}
        return answer

    def _changed(self, answer: Mapping[str, Any]) -> None:
        self.time = answer["time"]
        self.ended = answer.get("ended", self.ended)
        self._inputs = None
        self._values = {}

    def _ask(self, do: str, **fields: Any) -> dict[str, Any]:
        if not self._end.alive:
            raise ExchangeError("lost", f"{self._name}: the connection is closed")
        self._number += 1
        try:
            packed = self._pack({"id": self._number, "do": do, **fields})
        except (TypeError, ValueError, OverflowError) as error:
            raise InputError(
                str(error), source=self._name, key=do, expected="numbers, names, lists and maps"
            ) from None
        with contextlib.suppress(OSError):  # it may have said why it is gone
            self._connection.sendall(framed(packed))
        try:
            answer = self._received()
        except BaseException:  # what comes later would be taken for the answer to another request
            self._end()
            raise
        if answer.get("id") == self._number and answer.get("ok") is True:
            return answer
        if answer.get("id") != self._number:
            self._end()
        told = answer.get("error")
        if not isinstance(told, dict):
            raise ExchangeError("lost", f"{self._name}: an answer to something else")
        if told.get("kind") == "stopped" and "time" in answer:
            self._changed(answer)
        raise self._error(told)

    def _error(self, told: Mapping[str, Any]) -> Exception:
        kind, problem, key = str(told.get("kind")), str(told.get("problem")), str(told.get("key"))
        if kind == "input":
            return InputError(problem, source=self._name, key=key, expected=str(told.get("expected")))
        if kind == "stopped" and key.upper() in Outcome.__members__:
            from heavylift.pipeline.stepping.simulation import SimulationStopped

            return SimulationStopped(Outcome[key.upper()], problem)
        return ExchangeError(kind, f"{self._name}: {problem}")

    def _received(self) -> dict[str, Any]:
        self._read(HEADER.size)
        size = HEADER.size + HEADER.unpack_from(self._incoming)[0]
        if size > HEADER.size + LARGEST_MESSAGE:
            raise ExchangeError("lost", f"{self._name}: not a server of heavylift")
        self._read(size)
        data, self._incoming = self._incoming[HEADER.size : size], self._incoming[size:]
        try:
            return unpacked(self._library, data)
        except FormatError:
            raise ExchangeError("lost", f"{self._name}: not a server of heavylift") from None

    def _read(self, size: int) -> None:
        """Wait until at least so many bytes have come."""
        while len(self._incoming) < size:
            try:
                more = self._connection.recv(max(PIECE, size - len(self._incoming)))
            except TimeoutError:
                seconds = self._connection.gettimeout()
                raise ExchangeError("lost", f"{self._name}: no answer within {seconds:g} s") from None
            except ConnectionResetError:
                more = b""
            except OSError as error:
                raise ExchangeError("lost", f"{self._name}: {error.strerror}") from None
            if not more:
                raise ExchangeError("lost", f"{self._name}: has closed the connection{self._fate()}")
            self._incoming = self._incoming + more if self._incoming else more

    def _fate(self) -> str:
        """What has become of the child."""
        if self._child is None:
            return ""
        try:
            code = self._child.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            return ""
        return f": the process has ended with code {code}"


def _plain(inputs: Mapping[str, Any]) -> dict[str, Any]:
    """Inputs as numbers of Python; what is none stays for the server to refuse."""
    return {name: _number(value) for name, value in inputs.items()}


def _number(value: Any) -> Any:
    if type(value) is float:
        return value
    if isinstance(value, (tuple, list)):
        return [_number(each) for each in value]
    return value.tolist() if isinstance(value, (np.generic, np.ndarray)) else value


def _ended(connection: socket.socket, child: subprocess.Popen[bytes] | None) -> None:
    """Close a connection; a child ends then, by itself or by force."""
    connection.close()
    if child is not None:
        try:
            child.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()


def connect(
    host: str = "127.0.0.1",
    port: int | None = None,
    token: str = "",
    *,
    token_file: str | os.PathLike[str] | None = None,
    role: str = "master",
    timeout: float | None = TIMEOUT,
) -> RemoteSimulation:
    """Connect to a simulation that ``heavylift serve CASE --port N`` offers.

    Parameters
    ----------
    host, port, token
        As the server has printed them.
    token_file
        A file that the server has written (``--token-file``), in place of them.
    role
        ``"master"`` drives the run, and there is one; an ``"observer"`` watches it.
    timeout
        Until an answer must have come [s]; None: never.

    Raises
    ------
    InputError
        If the file cannot be read, or msgpack is not installed.
    ExchangeError
        If nobody is there, the token is wrong, or there is a master already.

    Examples
    --------
    >>> import heavylift
    >>> crane = heavylift.connect(token_file="crane.token")  # doctest: +SKIP
    >>> crane.step(0.5, {"gust": 2e4}, outputs=["module.position"])  # doctest: +SKIP
    """
    msgpack_library()  # before anything begins
    _check_timeout(timeout)
    if token_file is not None:
        host, port, token = _address(Path(token_file))
    if port is None:
        raise InputError(
            "is missing", source="connect", key="port", expected="the port of the server, or token_file"
        )
    name = f"{host}:{port}"
    try:
        connection = socket.create_connection((host, port), timeout)
    except (OSError, OverflowError) as error:
        words = (error.strerror if isinstance(error, OSError) else "") or str(error)
        raise ExchangeError("lost", f"{name}: {words}") from None
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return RemoteSimulation(connection, name, role=role, token=token)


def _check_timeout(timeout: float | None) -> None:
    if timeout is not None and not 0.0 < timeout < LONGEST_TIMEOUT:
        raise InputError(
            f"{timeout}",
            key="timeout",
            expected=f"seconds, more than 0 and less than {LONGEST_TIMEOUT:g}, or None",
        )


def _address(path: Path) -> tuple[str, int, str]:
    """Host, port and token of a file that a server has written."""
    try:
        host, port, token = path.read_text(encoding="utf-8").split()
        return host, int(port), token
    except (OSError, ValueError) as error:
        problem = error.strerror if isinstance(error, OSError) and error.strerror else "not one"
        raise InputError(
            problem, source=path, expected="a file that 'heavylift serve CASE --token-file' has written"
        ) from None


def open_child(
    case: str | os.PathLike[str],
    *,
    out: str | os.PathLike[str] | None = None,
    overrides: Sequence[str] = (),
    timeout: float | None = TIMEOUT,
) -> RemoteSimulation:
    """Start another process that simulates a case, and drive it through a pipe; it ends with this one.

    Parameters
    ----------
    case
        Case folder, or its ``case.toml``.
    out
        Folder in which the results of the run are kept; None: they are not.
    overrides
        As ``--set``: ``"simulate.step='1 ms'"``.
    timeout
        Until an answer must have come [s], the first one too, for which kernels may have to be compiled.

    Raises
    ------
    InputError
        If the case is wrong.
    ExchangeError
        If the process does not answer.

    Examples
    --------
    >>> import heavylift as hl
    >>> with hl.open_child("cases/hoist") as crane:
    ...     answer = crane.step(0.5)
    ...     print(f"{crane.time:g} s, load at {crane['load.position.z']:.3f} m")
    0.5 s, load at -49.446 m
    """
    msgpack_library()  # before anything begins
    _check_timeout(timeout)
    command = python_command(
        "-c",
        "from heavylift.pipeline.commands.start import main; main()",
        "serve",
        os.fspath(case),
        "--pipe",
        "--quiet",
    )
    if out is not None:
        command += ["--out", os.fspath(out)]
    for change in overrides:
        command += ["--set", change]
    ours, theirs = socket.socketpair()
    try:
        # a session of its own: Ctrl-C reaches this process alone, with whose end the child ends
        child = subprocess.Popen(  # noqa: S603
            command, stdin=theirs.fileno(), stdout=theirs.fileno(), start_new_session=True
        )
    except BaseException:
        ours.close()
        raise
    finally:
        theirs.close()
    ours.settimeout(timeout)
    return RemoteSimulation(ours, f"child for {os.fspath(case)}", role="master", token="", child=child)
