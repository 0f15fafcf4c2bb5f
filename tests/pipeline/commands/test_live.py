"""The server of a page that is watched: what it says to browsers, and clients that are slow, many or gone."""

from __future__ import annotations

import http.client
import os
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.commands import live as live_module
from heavylift.pipeline.commands.live import LiveRun, serve
from heavylift.pipeline.page.packing import content_policy
from heavylift.pipeline.results.storage import OutputFolder

if TYPE_CHECKING:
    from collections.abc import Iterator

CASES = Path(__file__).parents[3] / "cases"
MAIN = "from heavylift.pipeline.commands.start import main; main()"


@pytest.fixture
def live(tmp_path: Path) -> LiveRun:
    """What is watched: a run that has not begun."""
    return LiveRun(load_case(CASES / "hoist"), OutputFolder(tmp_path), None)


@pytest.fixture
def port(live: LiveRun, monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """Of a server with little patience."""
    monkeypatch.setattr(live_module, "IDLE_SECONDS", 0.4)
    server = serve(live)
    yield server.server_address[1]
    server.shutdown()
    server.server_close()


def asked(port: int, path: str, method: str = "GET", **headers: str) -> http.client.HTTPResponse:
    """The answer to a request."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=30)
    connection.request(method, path, headers=headers)
    answer = connection.getresponse()
    answer.read()
    connection.close()
    return answer


@pytest.mark.parametrize("path", ["/", "/data", "/progress", "/elsewhere"])
def test_no_other_page_may_show_or_read_this_one(port: int, path: str) -> None:
    answer = asked(port, path)
    assert answer.headers["X-Frame-Options"] == "DENY"
    assert answer.headers["X-Content-Type-Options"] == "nosniff"
    assert answer.headers["Cross-Origin-Resource-Policy"] == "same-origin"
    policy = dict(part.partition(" ")[::2] for part in answer.headers["Content-Security-Policy"].split("; "))
    assert policy["default-src"] == "'none'"
    assert policy["frame-ancestors"] == "'none'"
    assert policy["connect-src"] == "'self'"
    assert "unsafe-inline" not in policy["script-src"]
    assert "Python" not in answer.headers["Server"]
    refused = asked(port, path, Host=f"evil.example:{port}")
    assert refused.status == 403
    assert refused.headers["Content-Security-Policy"] == content_policy()


def closed_after(client: socket.socket) -> float:
    """Seconds until the server closes a connection."""
    begin = time.monotonic()
    client.settimeout(20.0)
    try:
        while client.recv(4096):
            pass
    except ConnectionError:
        pass
    return time.monotonic() - begin


def test_a_client_that_says_nothing_is_left(port: int) -> None:
    with socket.create_connection(("127.0.0.1", port)) as client:
        assert closed_after(client) < 10.0


def test_a_client_that_says_a_letter_now_and_then_is_left(port: int) -> None:
    with socket.create_connection(("127.0.0.1", port)) as client:
        client.sendall(b"GET /progress HTTP/1.0\r\n")

        def drip() -> None:
            for _ in range(100):
                time.sleep(0.1)
                try:
                    client.sendall(b"X: y\r\n")
                except OSError:
                    return

        dripping = threading.Thread(target=drip)
        dripping.start()
        assert closed_after(client) < 8.0
        dripping.join()


def test_a_client_that_leaves_leaves_no_word(
    live: LiveRun, port: int, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    asking = threading.Event()

    def progress() -> dict[str, Any]:
        asking.wait(10)
        return {"text": "x" * 10_000_000}

    monkeypatch.setattr(live, "progress", progress)
    for _ in range(3):
        with socket.create_connection(("127.0.0.1", port)) as client:
            client.sendall(f"GET /progress HTTP/1.0\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())
            time.sleep(0.1)
            client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # a reset
    asking.set()
    time.sleep(0.5)
    assert capfd.readouterr().err == ""
    assert asked(port, "/elsewhere").status == 404


def test_a_fault_while_answering_is_told_in_a_line(
    live: LiveRun, port: int, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def progress() -> None:
        raise ValueError("the file\nis gone")

    monkeypatch.setattr(live, "progress", progress)
    with pytest.raises((ConnectionError, http.client.HTTPException)):
        asked(port, "/progress")
    time.sleep(0.2)
    assert capfd.readouterr().err == "view: ValueError: the file\\nis gone\n"


def test_more_clients_than_places_are_turned_away(
    live: LiveRun, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    waiting = threading.Event()
    monkeypatch.setattr(live, "progress", lambda: waiting.wait(20) and {})
    clients = []
    try:
        for _ in range(live_module.CLIENTS + 1):
            clients.append(socket.create_connection(("127.0.0.1", port)))
            clients[-1].sendall(f"GET /progress HTTP/1.0\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())
        assert closed_after(clients[-1]) < 5.0
    finally:
        waiting.set()
        for client in clients:
            client.close()
    time.sleep(0.3)
    assert asked(port, "/progress").status == 200


@pytest.mark.slow
@pytest.mark.parametrize("ignored", [False, True])
def test_view_ends_with_its_terminal_and_its_run_too(tmp_path: Path, ignored: bool) -> None:
    """Unless it was told to outlive it, as by nohup."""
    folder, case = tmp_path / "out", str(CASES / "barge_decay")
    main, process = os.openpty()
    program = "import fcntl, termios; fcntl.ioctl(0, termios.TIOCSCTTY, 0); "
    program += "import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN); " * ignored + MAIN
    run = subprocess.Popen(
        [
            sys.executable,
            "-c",
            program,
            "view",
            case,
            "--out",
            str(folder),
            "--set",
            "simulate.duration=90000",
        ],
        stdin=process,
        stdout=process,
        stderr=process,
        start_new_session=True,
    )
    os.close(process)
    spec = b""
    while b"until Ctrl-C" not in spec:
        try:
            spec += os.read(main, 4096)
        except OSError:
            pytest.fail(spec.decode())
    port = int(spec.split(b"127.0.0.1:")[1].split(b"/")[0])
    if ignored:
        os.close(main)  # the terminal is gone
        time.sleep(1.0)
        assert asked(port, "/progress").status == 200
        run.send_signal(signal.SIGINT)
    else:
        os.close(main)
    assert run.wait(120) in {0, 5}
    with pytest.raises(ConnectionError):
        asked(port, "/progress")
    children = [
        int(entry.name)
        for entry in Path("/proc").iterdir()
        if entry.name.isdigit() and str(folder).encode() in _command(entry)
    ]
    assert not children


def _command(entry: Path) -> bytes:
    try:
        return (entry / "cmdline").read_bytes()
    except OSError:
        return b""
