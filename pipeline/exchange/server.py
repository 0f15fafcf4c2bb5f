"""The server: connections over TCP or through the pipes of a parent, one loop, one simulation.

One thread does it all: requests are answered in the order in which they come, and a step is never disturbed. A client
that is slow, silent, wrong or gone holds nobody up: reads and writes do not wait, and what a connection may keep in
memory is bounded by one message each way.
"""

from __future__ import annotations

import contextlib
import os
import select
import signal
import socket
import threading
import time
from typing import TYPE_CHECKING, Any, Protocol

from heavylift.numerics.outcome import in_one_line
from heavylift.pipeline.exchange.protocol import (
    HEADER,
    LARGEST_HELLO,
    LARGEST_MESSAGE,
    LARGEST_QUESTION,
    FormatError,
    framed,
    msgpack_library,
    unpacked,
)
from heavylift.pipeline.exchange.service import Seat, error_answer

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from heavylift.pipeline.exchange.service import Service

__all__ = ["PipeChannel", "Server", "SocketChannel", "listening"]

HELLO_SECONDS = 10.0
"""Within which a client has to say who it is."""
PATIENCE_SECONDS = 20.0
"""For the rest of a message that has begun, and for an answer to be taken."""
FAREWELL_SECONDS = 2.0
"""Until a connection that is over is closed, so that its client can read why."""
LONG_SECONDS = 0.1
"""An answer that takes longer counts for none of these times."""
CLIENTS = 16
"""At once."""
BACKLOG = 128
"""Clients that may wait until they are accepted."""
PIECE = 2**16
"""Bytes of a read."""
SLOWEST = 2**20
"""Bytes a second that a client has to take or to send."""

_READ, _WRITE = select.POLLIN, select.POLLOUT
_NEVER = float("inf")
_LARGEST = {"": LARGEST_HELLO, "observer": LARGEST_QUESTION, "master": LARGEST_MESSAGE}


def _patience(size: int) -> float:
    """Seconds that a message of some bytes may take."""
    return PATIENCE_SECONDS + size / SLOWEST


class Channel(Protocol):
    """A connection: bytes in, bytes out, without waiting."""

    name: str
    trusted: bool

    @property
    def reads(self) -> int: ...
    @property
    def writes(self) -> int: ...
    def receive(self) -> bytes: ...
    def send(self, data: bytes | memoryview) -> int: ...
    def say_end(self) -> None: ...
    def close(self) -> None: ...


class SocketChannel:
    """A client over TCP."""

    trusted = False

    def __init__(self, connection: socket.socket, address: Any) -> None:
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        connection.setsockopt(
            socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1
        )  # a machine that is gone says nothing
        if hasattr(socket, "TCP_KEEPIDLE"):
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, 60)
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, 10)
        self.name = f"{address[0]}:{address[1]}"
        self.connection = connection
        self.reads = self.writes = connection.fileno()

    def receive(self) -> bytes:
        """What is there; empty if the client has gone."""
        return self.connection.recv(PIECE)

    def send(self, data: bytes | memoryview) -> int:
        """How many bytes are on their way."""
        return self.connection.send(data)

    def say_end(self) -> None:
        """No more answers follow."""
        with contextlib.suppress(OSError):
            self.connection.shutdown(socket.SHUT_WR)

    def close(self) -> None:
        """Forget it."""
        self.connection.close()


class PipeChannel:
    """The parent process, behind two pipes.

    Parameters
    ----------
    reads, writes
        Descriptors, which belong to this object from then on.
    """

    name, trusted = "the parent process", True

    def __init__(self, reads: int, writes: int) -> None:
        self.reads, self.writes = reads, writes
        self._open: tuple[int, ...] = (reads, writes)
        os.set_blocking(reads, False)
        os.set_blocking(writes, False)

    def receive(self) -> bytes:
        """What is there; empty if the parent has gone."""
        return os.read(self.reads, PIECE)

    def send(self, data: bytes | memoryview) -> int:
        """How many bytes are on their way."""
        return os.write(self.writes, data)

    def say_end(self) -> None:
        """No more answers follow."""

    def close(self) -> None:
        """Forget it."""
        open_ones, self._open = self._open, ()
        for descriptor in open_ones:
            os.close(descriptor)


class _Client:
    """A connection with what has come and what is to go."""

    def __init__(self, channel: Channel, now: float) -> None:
        self.channel = channel
        self.seat = Seat(channel.name, trusted=channel.trusted)
        self.incoming = bytearray()
        self.outgoing = memoryview(b"")
        self.deadline = _NEVER if channel.trusted else now + HELLO_SECONDS
        self.leaving = self.gone = self.ready = False

    def whole(self) -> int:
        """Bytes of the first message, its length included; 0 while it is not all there.

        Raises
        ------
        FormatError
            If it is longer than messages are.
        """
        data = self.incoming
        if len(data) < HEADER.size:
            return 0
        length = HEADER.unpack_from(data)[0]
        largest = _LARGEST[self.seat.role]
        if length > largest:
            raise FormatError(f"a message of {length} bytes, longer than {largest}")
        return HEADER.size + length if len(data) >= HEADER.size + length else 0


@contextlib.contextmanager
def _woken() -> Iterator[int]:
    """A descriptor that can be read once a signal has come; in the main thread alone."""
    ours, theirs = socket.socketpair()
    try:
        ours.setblocking(False)
        theirs.setblocking(False)
        before = None
        if threading.current_thread() is threading.main_thread():
            before = signal.set_wakeup_fd(theirs.fileno(), warn_on_full_buffer=False)
        try:
            yield ours.fileno()
        finally:
            if before is not None:
                signal.set_wakeup_fd(before)
    finally:
        ours.close()
        theirs.close()


class Server:
    """Serves a simulation until its master ends it, or stays away.

    Parameters
    ----------
    service
        Answers requests.
    listener
        Where clients connect; None if there is a parent alone.
    wait
        For a master [s], at the beginning and after one has gone; then the run ends.
    say
        Prints a line for the person who has started it.
    stop
        Asked after each request: whether someone wants the end.
    """

    def __init__(
        self,
        service: Service,
        listener: socket.socket | None = None,
        *,
        wait: float = 600.0,
        say: Callable[[str], None] = lambda _line: None,
        stop: Callable[[], object] = bool,
    ) -> None:
        self.service, self.listener, self.wait, self._say, self._stop = service, listener, wait, say, stop
        library = msgpack_library()
        self._library, self._pack = library, library.Packer(autoreset=True).pack
        self._clients: dict[int, _Client] = {}
        self._poll = select.poll()
        self._left = time.monotonic()
        self._ready: list[_Client] = []
        self._ending = False

    def add(self, channel: Channel) -> None:
        """A client that has connected."""
        client = _Client(channel, time.monotonic())
        self._clients[channel.reads] = client
        self._clients[channel.writes] = client
        self._poll.register(channel.reads, _READ)
        if len({*self._clients.values()}) > CLIENTS:
            self._refuse(client, f"{CLIENTS} clients are connected already")

    def run(self) -> str:
        """Answer until the end.

        Returns
        -------
        str
            Why it has ended, as ``"the master has ended the run"``; a word of `stop` if that was asked for.
        """
        with _woken() as signals:
            self._poll.register(signals, _READ)
            if self.listener is not None:
                self.listener.setblocking(False)
                self._poll.register(self.listener.fileno(), _READ)
            reason = "an error"
            try:
                while not (found := self._reason()):
                    for descriptor, event in self._poll.poll(self._patience()):
                        if descriptor == signals:  # `stop` knows what it means
                            os.read(signals, PIECE)
                        else:
                            self._serve(descriptor, event)
                    self._serve_ready()
                    self._give_up()
                reason = found
                return reason
            finally:
                self._farewell(reason)

    def _reason(self) -> str:
        """Why the run ends now; empty while it continues."""
        asked = self._stop()
        if asked:
            return str(asked)
        service = self.service
        if service.fault:
            return f"an internal error: {service.fault}"
        if service.over:
            return "the master has ended the run"
        if service.master is None and self.listener is None and not self._clients:
            return "the parent process has gone"
        if service.master is None and time.monotonic() - self._left >= self.wait:
            return f"no master for {self.wait:g} s"
        return ""

    def _patience(self) -> int | None:
        """Milliseconds until something has to be given up; None if nothing has."""
        if self._ready:
            return 0
        ends = [client.deadline for client in self._clients.values()]
        if self.service.master is None:
            ends.append(self._left + self.wait)
        end = min(ends, default=_NEVER)
        if end == _NEVER:
            return None
        return min(max(0, int(1e3 * (end - time.monotonic())) + 1), 3_600_000)

    def _serve(self, descriptor: int, event: int) -> None:
        if self.listener is not None and descriptor == self.listener.fileno():
            self._accept()
            return
        client = self._clients.get(descriptor)
        if client is None:  # it has gone meanwhile
            return
        if event & _WRITE or (client.outgoing and event & (select.POLLERR | select.POLLHUP)):
            self._send(client)
        if event & ~_WRITE and not client.gone and descriptor == client.channel.reads:
            self._receive(client)

    def _accept(self) -> None:
        assert self.listener is not None
        while True:
            try:
                channel = SocketChannel(*self.listener.accept())
            except BlockingIOError:
                return
            except ConnectionError:  # it has gone again
                continue
            except OSError as error:  # as without descriptors: whoever waits is accepted when there are some
                self._say(f"serve: a client is not accepted: {error.strerror}")
                time.sleep(LONG_SECONDS)
                return
            self.add(channel)

    def _receive(self, client: _Client) -> None:
        if client.ready:  # what it has sent already comes first
            return
        try:
            data = client.channel.receive()
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self._drop(client)
        elif not client.leaving:  # else nobody listens any more
            client.incoming += data
            self._answer_first(client)

    def _serve_ready(self) -> None:
        """One more message of each client that has sent several at once."""
        ready, self._ready = self._ready, []
        for client in ready:
            client.ready = False
            if not (client.gone or client.leaving or self._reason()):
                self._answer_first(client)

    def _answer_first(self, client: _Client) -> None:
        """Answer the first message if it is all there."""
        try:
            size = client.whole()
            if not size:
                if client.deadline == _NEVER and client.incoming:  # who sends a byte now and then is late too
                    client.deadline = time.monotonic() + _patience(LARGEST_MESSAGE)
                return
            with memoryview(client.incoming) as view, view[HEADER.size : size] as content:
                request = unpacked(self._library, content)
            del client.incoming[:size]
            begin = time.monotonic()
            answer = self.service.answer(request, client.seat)
            self._pardon(time.monotonic() - begin)
        except FormatError as error:
            self._refuse(client, str(error))
            return
        packed = self._pack(answer)
        if len(packed) > LARGEST_MESSAGE:
            words = f"an answer of {len(packed)} bytes, longer than {LARGEST_MESSAGE}"
            packed = self._pack(error_answer(answer["id"], "refused", words))
        if client.seat.closed:
            self._leave(client)
        self._begin_sending(client, framed(packed))

    def _pardon(self, seconds: float) -> None:
        """Give all clients the time in which nobody listened to them."""
        if seconds > LONG_SECONDS:
            self._left += seconds
            for client in {*self._clients.values()}:
                client.deadline += seconds

    def _begin_sending(self, client: _Client, data: bytes) -> None:
        try:
            sent = client.channel.send(data)
        except BlockingIOError:
            sent = 0
        except OSError:
            self._drop(client)
            return
        if sent == len(data):
            self._sent(client)
            return
        client.outgoing = memoryview(data)[sent:]
        client.deadline = time.monotonic() + _patience(len(data))
        self._poll.unregister(client.channel.reads)  # no further request before this answer is taken
        self._poll.register(client.channel.writes, _WRITE)

    def _send(self, client: _Client) -> None:
        """More of an answer that was not taken at once."""
        try:
            client.outgoing = client.outgoing[client.channel.send(client.outgoing) :]
        except BlockingIOError:
            return
        except OSError:
            self._drop(client)
            return
        if not client.outgoing:
            self._poll.unregister(client.channel.writes)
            self._poll.register(client.channel.reads, _READ)
            self._sent(client)

    def _sent(self, client: _Client) -> None:
        """An answer is on its way, all of it."""
        if client.leaving:
            client.channel.say_end()
            client.deadline = time.monotonic() + FAREWELL_SECONDS
            return
        client.deadline = _NEVER
        if client.incoming:
            client.ready = True
            self._ready.append(client)

    def _refuse(self, client: _Client, problem: str) -> None:
        """Say why, and close the connection."""
        if client.leaving or client.gone:
            return
        self._leave(client)
        if client.outgoing:  # it still has to take an answer
            return
        self._begin_sending(client, framed(self._pack(error_answer(None, "refused", in_one_line(problem)))))

    def _leave(self, client: _Client) -> None:
        """A client to which one answer more is sent."""
        client.leaving = True
        client.incoming.clear()
        self._forget(client, "has left")

    def _drop(self, client: _Client) -> None:
        """A connection that is no more."""
        if client.gone:
            return
        client.gone = True
        self._forget(client, "has gone")
        for descriptor in {client.channel.reads, client.channel.writes}:
            with contextlib.suppress(KeyError, OSError):
                self._poll.unregister(descriptor)
            self._clients.pop(descriptor, None)
        client.channel.close()

    def _forget(self, client: _Client, what: str) -> None:
        """What the service keeps for a client."""
        if client.seat is self.service.master:
            self._left = time.monotonic()
            if self.listener is not None and not (self._ending or self.service.over):
                at = f"t = {self.service.simulation.time:.9g} s"
                self._say(
                    f"serve: the master, {client.seat.name}, {what} at {at}; waits {self.wait:g} s for another"
                )
        self.service.leave(client.seat)

    def _give_up(self) -> None:
        """Close what has been silent for too long."""
        now = time.monotonic()
        for client in [client for client in self._clients.values() if client.deadline <= now]:
            if client.leaving or client.outgoing:
                self._drop(client)
            elif not client.gone:
                whole = "its greeting" if not client.seat.role else "the rest of a message"
                self._refuse(client, f"{whole} has not come in time")

    def _farewell(self, reason: str) -> None:
        """Tell all clients why it is over, let them read it, and close all connections."""
        self._ending = True
        end = time.monotonic() + FAREWELL_SECONDS
        for client in [*self._clients.values()]:
            self._refuse(client, f"the run has ended: {reason}")
            while client.outgoing and not client.gone and time.monotonic() < end:
                writing = select.poll()
                writing.register(client.channel.writes, _WRITE)
                writing.poll(max(1, int(1e3 * (end - time.monotonic()))))
                self._send(client)
            self._drop(client)


def listening(host: str, port: int) -> socket.socket:
    """A socket that waits for clients; port 0 takes a free one.

    Raises
    ------
    OSError
        If the address cannot be had.
    """
    family, _, _, _, address = socket.getaddrinfo(
        host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
    )[0]
    listener = socket.socket(family, socket.SOCK_STREAM)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen(BACKLOG)
    except OSError:
        listener.close()
        raise
    return listener
