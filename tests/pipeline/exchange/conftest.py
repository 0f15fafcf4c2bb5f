"""A hoist that a server in this process offers to clients over TCP."""

from __future__ import annotations

import socket
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import heavylift as hl
from heavylift.pipeline.exchange.client import RemoteSimulation, connect
from heavylift.pipeline.exchange.protocol import HEADER, framed, msgpack_library
from heavylift.pipeline.exchange.server import Server, listening
from heavylift.pipeline.exchange.service import Service

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

msgpack = pytest.importorskip("msgpack")

CASES = Path(__file__).parents[3] / "cases"
HOIST = CASES / "hoist"
TOKEN = "a-word"  # noqa: S105


class Wire:
    """A client that may send anything."""

    def __init__(self, port: int) -> None:
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=20)
        self.number = 0

    def send(self, data: bytes) -> None:
        self.socket.sendall(data)

    def ask(self, do: object, **fields: Any) -> dict[str, Any]:
        self.number += 1
        self.send(framed(msgpack_library().packb({"id": self.number, "do": do, **fields})))
        return self.answer()

    def hello(self, role: str = "master", **fields: Any) -> dict[str, Any]:
        return self.ask("hello", **{"protocol": 1, "role": role, "token": TOKEN, **fields})

    def answer(self) -> dict[str, Any]:
        (length,) = HEADER.unpack(self._read(HEADER.size))
        found: dict[str, Any] = msgpack_library().unpackb(self._read(length))
        return found

    def closed(self) -> bool:
        """Whether the other side has closed the connection, with no further answer."""
        try:
            return self.socket.recv(1) == b""
        except ConnectionError:
            return True

    def close(self) -> None:
        self.socket.close()

    def _read(self, size: int) -> bytes:
        data = b""
        while len(data) < size:
            more = self.socket.recv(size - len(data))
            if not more:
                raise EOFError
            data += more
        return data


class Served:
    """A server at work in a thread."""

    def __init__(self, simulation: hl.Simulation, wait: float = 600.0) -> None:
        self.simulation = simulation
        self.lines: list[str] = []
        self.reason = ""
        self._stop = ""
        self.listener = listening("127.0.0.1", 0)
        self.port = self.listener.getsockname()[1]
        self.service = Service(simulation, TOKEN)
        self.server = Server(
            self.service, self.listener, wait=wait, say=self.lines.append, stop=lambda: self._stop
        )
        self._clients: list[Any] = []
        self.thread = threading.Thread(target=self._run)
        self.thread.start()

    def _run(self) -> None:
        self.reason = self.server.run()

    def wire(self) -> Wire:
        self._clients.append(Wire(self.port))
        return self._clients[-1]

    def client(self, role: str = "master", **options: Any) -> RemoteSimulation:
        self._clients.append(connect("127.0.0.1", self.port, TOKEN, role=role, timeout=20, **options))
        return self._clients[-1]

    def stop(self, reason: str) -> None:
        self._stop = reason
        if self.thread.is_alive():  # it looks up once somebody comes
            Wire(self.port).close()
        self.thread.join(20)
        assert not self.thread.is_alive()
        self.listener.close()

    def end(self) -> None:
        self.stop("a test is over")
        for client in self._clients:
            client.close()


@pytest.fixture(scope="session")
def _hoist() -> tuple[hl.Simulation, bytes]:
    simulation = hl.Simulation(HOIST)
    return simulation, simulation.save().to_bytes()


@pytest.fixture
def hoist(_hoist: tuple[hl.Simulation, bytes]) -> hl.Simulation:
    """At its start."""
    simulation, start = _hoist
    simulation.restore(hl.State.from_bytes(start))
    return simulation


@pytest.fixture
def serve(hoist: hl.Simulation) -> Iterator[Callable[..., Served]]:
    """Makes servers of the hoist."""
    made: list[Served] = []

    def make(**options: Any) -> Served:
        made.append(Served(hoist, **options))
        return made[-1]

    yield make
    for server in made:
        server.end()


@pytest.fixture
def served(serve: Callable[..., Served]) -> Served:
    """A server of the hoist."""
    return serve()
