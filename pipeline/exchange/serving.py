"""A case that is served: from its file to the end of the run, and to its results."""

from __future__ import annotations

import contextlib
import ipaddress
import math
import os
import secrets
import select
import signal
import sys
import threading
from typing import TYPE_CHECKING

from heavylift.numerics.outcome import InputError, Outcome, in_one_line
from heavylift.pipeline.exchange.protocol import framed, msgpack_library
from heavylift.pipeline.exchange.server import PipeChannel, Server, listening
from heavylift.pipeline.exchange.service import Service, error_answer
from heavylift.pipeline.log import say_on
from heavylift.pipeline.results.storage import StopError
from heavylift.pipeline.stages.advance import stop_requests
from heavylift.pipeline.stages.lock import locked

if TYPE_CHECKING:
    import socket
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from heavylift.pipeline.log import Log
    from heavylift.pipeline.stepping.simulation import Simulation

__all__ = ["serve_case"]

TOKEN_BYTES = 32
"""Of the token, before it is written in letters."""


def serve_case(
    path: Path,
    *,
    port: int | None,
    pipe: bool,
    host: str = "127.0.0.1",
    token_file: Path | None = None,
    wait: float = 600.0,
    out: Path | None = None,
    overrides: Sequence[str] = (),
    log: Log,
) -> int:
    """Serve a case until its master ends the run; returns the exit code.

    Parameters
    ----------
    path
        Case folder, or its case.toml.
    port, host, token_file
        Where clients connect, and a file that says so with the token.
    pipe
        Speak with the parent process in place of that.
    wait
        For a master [s].
    out
        Folder in which the results are kept.
    overrides
        As ``--set``.
    log
        For the person who has started it.

    Raises
    ------
    InputError
        If the case or an option is wrong.
    """
    if pipe == (port is not None):
        raise InputError(
            "both '--port' and '--pipe'" if pipe else "neither '--port' nor '--pipe'",
            source="serve",
            expected="one of them",
        )
    if pipe and token_file is not None:
        raise InputError("with '--pipe'", source="--token-file", expected="'--port': a parent needs no token")
    if pipe:
        return _serve_parent(path, out, overrides)
    assert port is not None
    if not 0 <= port <= 65535:
        raise InputError(f"{port}", source="--port", expected="0 to 65535")
    if not wait > 0.0:
        raise InputError(f"{wait}", source="--wait", expected="more than 0 s, or inf")
    if log.quiet and token_file is None:
        raise InputError(
            "without '--token-file'", source="--quiet", expected="a file for the token that is not printed"
        )
    msgpack_library()
    _hear_hangups()
    with _listener(host, port) as listener:
        simulation, reserved = _simulation(path, out, overrides)
        token, number = secrets.token_urlsafe(TOKEN_BYTES), listener.getsockname()[1]
        service = Service(simulation, token)
        with stop_requests() as stop, _written(token_file, f"{host} {number} {token}\n"):
            simulation.stop_asked = lambda: stop.signal_name
            server = Server(service, listener, wait=wait, say=log.say, stop=simulation.stop_asked)
            log.say(f"serve: {simulation.case.name} at {host} port {number}, token {token}")
            if math.isfinite(wait):
                log.say(f"serve: waits {wait:g} s for a master")
            reason = server.run()
            log.say(f"serve: ends at t = {simulation.time:.9g} s: {reason}")
            return _ending(service, out, reserved)


def _serve_parent(path: Path, out: Path | None, overrides: Sequence[str]) -> int:
    """Serve the process that has started this one, until it ends the run or is gone."""
    if sys.stdin is None or sys.stdin.isatty():
        raise InputError(
            "a terminal",
            source="--pipe",
            expected="pipes of a program that starts 'heavylift serve CASE --pipe'",
        )
    library = msgpack_library()
    writes = os.dup(1)
    os.dup2(2, 1)  # whatever libraries print goes elsewhere
    reads = os.dup(0)
    parent = _Parent(0)
    with contextlib.closing(PipeChannel(reads, writes)) as channel:
        try:
            simulation, reserved = _simulation(path, out, overrides)
        except BaseException as error:
            parent.serving = True
            told, outcome = _start_error(error)
            try:
                channel.send(framed(library.packb(told)))
            except OSError:
                raise error from None
            if outcome is None:
                raise
            return int(outcome)  # the parent knows
        with stop_requests() as stop:
            parent.serving = True
            service = Service(simulation)
            simulation.stop_asked = lambda: stop.signal_name or parent.gone
            server = Server(service, wait=math.inf, stop=lambda: stop.signal_name)
            server.add(channel)
            server.run()
            return _ending(service, out, reserved)


class _Parent:
    """Whether the parent process is still there, watched while this one computes.

    Parameters
    ----------
    reads
        Descriptor of the pipe or socket from it, whose other end closes with it.
    """

    def __init__(self, reads: int) -> None:
        self.gone = ""
        self.serving = False
        self._reads = reads
        threading.Thread(target=self._watch, daemon=True).start()

    def _watch(self) -> None:
        ends = select.poll()
        ends.register(self._reads, 0)  # of its end alone, not of what there is to read
        ends.poll()
        self.gone = "the parent process has gone"
        if not self.serving:  # what prepares a run answers to a signal
            os.kill(os.getpid(), signal.SIGTERM)


def _simulation(
    path: Path, out: Path | None, overrides: Sequence[str]
) -> tuple[Simulation, contextlib.ExitStack]:
    """The simulation of a case, and the lock of the folder of its results, which nobody else may write to meanwhile."""
    from heavylift.pipeline.stepping.simulation import Simulation

    simulation = Simulation(path, out=out, overrides=overrides, history=out is not None)
    reserved = contextlib.ExitStack()
    if out is not None:
        reserved.enter_context(locked(out))
    return simulation, reserved


def _ending(service: Service, out: Path | None, reserved: contextlib.ExitStack) -> int:
    """Write the results if they are asked for; the exit code."""
    simulation = service.simulation
    with reserved:
        if out is not None:
            simulation.write_results(out, lock=False)
    if service.fault:
        raise StopError(Outcome.FAULT, f"an internal error, not an error of the input: {service.fault}")
    if simulation.outcome is not Outcome.COMPLETED:
        raise StopError(simulation.outcome, simulation.message)
    return int(Outcome.COMPLETED if service.over else Outcome.INTERRUPTED)


def _start_error(error: BaseException) -> tuple[dict[str, object], Outcome | None]:
    """What a parent hears if the run cannot begin, and how the process ends; None if there is more to say of it."""
    if isinstance(error, InputError):
        key = ": ".join(part for part in (error.source, error.key) if part)
        problem = error.problem.replace("\n", "; ")
        return error_answer(None, "input", problem, key, error.expected), Outcome.BAD_INPUT
    if isinstance(error, StopError):
        return error_answer(None, "stopped", str(error), error.outcome.name.lower()), error.outcome
    if isinstance(error, OSError) and error.filename is not None:
        return error_answer(None, "input", str(error.strerror), str(error.filename)), Outcome.BAD_INPUT
    if isinstance(error, KeyboardInterrupt):
        return error_answer(None, "refused", "interrupted"), None
    return error_answer(None, "internal", in_one_line(f"{type(error).__name__}: {error}")), None


def _hear_hangups() -> None:
    """Take a terminal that is closed as a request to stop, but under nohup."""
    with contextlib.suppress(ValueError):  # not in the main thread
        if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:
            signal.signal(signal.SIGHUP, lambda *_: signal.raise_signal(signal.SIGTERM))


def _listener(host: str, port: int) -> socket.socket:
    """Where clients connect; with a warning if others than this machine can.

    Raises
    ------
    InputError
        If the address cannot be had.
    """
    try:
        listener = listening(host, port)
    except (OSError, UnicodeError) as error:
        words = (error.strerror if isinstance(error, OSError) else "") or str(error)
        raise InputError(
            f"{host} port {port}: {words}",
            source="serve",
            expected="an address of this machine and a free port",
        ) from None
    address = listener.getsockname()[0]
    if not ipaddress.ip_address(address.partition("%")[0]).is_loopback:
        say_on(
            sys.stderr,
            f"serve: WARNING: others than this machine reach {address}; nothing is encrypted, and who hears the token "
            "can drive the run. A tunnel (ssh -L) to 127.0.0.1 is safe",
        )
    return listener


@contextlib.contextmanager
def _written(path: Path | None, text: str) -> Iterator[None]:
    """A file of a text that this user alone can read, whole or absent, while the server is there.

    Raises
    ------
    InputError
        If a folder is there, or it cannot be written.
    """
    if path is None:
        yield
        return
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        temporary.unlink(missing_ok=True)
        handle = os.open(
            temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600
        )
        with open(handle, "w", encoding="utf-8") as file:  # noqa: PTH123  of a descriptor
            file.write(text)
        temporary.replace(path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise InputError(
            f"{path}: {error.strerror}", source="--token-file", expected="a file that can be written"
        ) from None
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            if path.read_text(encoding="utf-8") == text:  # not that of another server
                path.unlink()
