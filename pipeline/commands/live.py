"""The page of a run while it continues: a child runs the case, this process serves what is on disk to this machine."""

from __future__ import annotations

import contextlib
import json
import secrets
import signal
import socket
import subprocess
import sys
import threading
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING, Any

from heavylift.numerics.children import python_command
from heavylift.numerics.outcome import InputError, Outcome, in_one_line
from heavylift.pipeline.log import say_on
from heavylift.pipeline.page.packing import LibraryMissingError, content_policy, live_content
from heavylift.pipeline.page.page import PageContent, page_content, page_html
from heavylift.pipeline.report.document import Verdict
from heavylift.pipeline.report.interactive import JudgedRun, interactive_content
from heavylift.pipeline.report.report import judged_run
from heavylift.pipeline.report.run import load_finite_results
from heavylift.pipeline.results.histories import numbers_on_disk
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.pipeline.results.words import number_words

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.results.histories import Results

__all__ = ["LiveRun", "serve", "view_case"]

HOST = "127.0.0.1"
IDLE_SECONDS = 20.0
"""Until a client must have asked, and then have taken the next piece of the answer."""
PIECE = 2**16
"""Bytes of an answer."""
CLIENTS = 64
"""At once; a browser takes six."""
SAFE_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}
"""No other page may show, read or embed this one."""
STOP_SECONDS = 60.0
"""That a run has to end once it is asked to."""


class LiveRun:
    """What is on disk of a run, as the page asks for it.

    Parameters
    ----------
    case
        The case.
    folder
        Its output folder.
    child
        The process that runs it; None to watch what another one does.
    """

    def __init__(self, case: Case, folder: OutputFolder, child: subprocess.Popen[bytes] | None) -> None:
        self.case, self.folder, self.child = case, folder, child
        self.token = secrets.token_urlsafe(16)
        self._lock = threading.Lock()
        self._known: tuple[Any, ...] | None = None
        self._version = 0
        self._results: Results | None = None
        self._problem = ""
        self._stopped = False

    @property
    def running(self) -> bool:
        """Whether the child still works."""
        return self.child is not None and self.child.poll() is None

    def progress(self) -> dict[str, Any]:
        """Version of the records on disk, how far they are, and whether the run continues."""
        with self._lock:
            self._look()
            return {"version": self._version, "running": self.running, "text": self._words()}

    def content(self) -> PageContent:
        """All of the page, from the records that there are."""
        with self._lock:
            self._look()
            live: dict[str, Any] = {"live": self.token, "version_of_data": self._version}
            if self._results is None or not len(self._results.time):
                verdict = ("The run has begun; its first records are awaited", None)
                if not self.running:
                    verdict = ("The run has ended without records", None)
                notes = [self._problem] if self._problem and not self.running else []
                return page_content(self.case, None, None, verdict=verdict, notes=notes, **live)
            if self.running:
                judgement = JudgedRun(Verdict("Running: checks and criteria follow at the end.", passed=None))
            else:
                judgement = judged_run(self.case, self.folder, self._results, self._problem)
            return interactive_content(
                self.case, self.folder, self._results, judgement, running=self.running, **live
            )

    def stop(self) -> None:
        """Ask the child to stop at its next step; what it has done is kept."""
        if self.running:
            assert self.child is not None
            self._stopped = True
            self.child.send_signal(signal.SIGINT)

    def _look(self) -> None:
        """Read the records again if there are others on disk."""
        found = self.folder.results
        status = found.stat() if found.exists() else None
        numbers = numbers_on_disk(self.folder.segments) if self.folder.segments.is_dir() else []
        known = (status and (status.st_mtime_ns, status.st_size), numbers[-1:], self.running)
        if known == self._known:
            return
        self._known = known
        self._version += 1
        self._results, self._problem = load_finite_results(self.case, self.folder.root)

    def _words(self) -> str:
        assert self.case.simulate is not None
        last = 0.0 if self._results is None or not len(self._results.time) else float(self._results.time[-1])
        whole = self.case.simulate.duration
        words = f"{number_words(last, 's')} of {number_words(whole, 's')}"
        if whole > 0.0:
            words += f", {100.0 * last / whole:.0f} %"
        if self.running:
            return f"stopping at {words}" if self._stopped else f"running: {words}"
        return f"ended: {words}"


def view_case(
    path: Path, *, port: int, out: Path | None, overrides: Sequence[str], force: bool, log: Log
) -> int:
    """Run a case in a child and serve its page until Ctrl-C; returns the exit code of the run.

    Raises
    ------
    InputError
        If the case is wrong or has no simulation, if the port cannot be had, or k3d is not installed.
    """
    from heavylift.pipeline.stages.stages import load_changed_case

    case = load_changed_case(path, overrides)
    if case.simulate is None:
        raise InputError("no [simulate] section", source=case.file, expected="something that runs")
    if not 0 <= port <= 65535:
        raise InputError(f"{port}", source="--port", expected="0 to 65535")
    folder = OutputFolder(case.output_folder if out is None else out)
    program = "from heavylift.pipeline.commands.start import main; main()"
    command = python_command("-c", program, "run", str(path), "--out", str(folder.root))
    for change in overrides:
        command += ["--set", change]
    command += ["--force"] * force
    live = LiveRun(case, folder, None)
    try:
        page_html(live.content())  # before anything runs: whether there is a page
        server = serve(live, port)
    except LibraryMissingError as error:
        raise InputError(str(error), source="view", expected="the package k3d") from None
    except OSError as error:
        raise InputError(
            f"{port}: {error.strerror}", source="--port", expected="a port that is free"
        ) from None
    try:
        with contextlib.suppress(ValueError):  # not in the main thread
            # the terminal is gone, and with it whoever would look: as Ctrl-C, but under nohup
            if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:
                signal.signal(signal.SIGHUP, signal.default_int_handler)
        # a group of its own: Ctrl-C reaches this process alone, which then asks the child once
        live.child = _started(command)
        log.say(f"view: http://{HOST}:{server.server_address[1]}/ until Ctrl-C")
        threading.Event().wait()
    except KeyboardInterrupt:
        log.say("view: ends" if not live.running else "view: asks the run to stop")
    finally:
        live.stop()
        server.shutdown()
        server.server_close()
        if live.child is not None:
            try:
                live.child.wait(STOP_SECONDS)
            except subprocess.TimeoutExpired:
                live.child.terminate()
    code = live.child.poll() if live.child is not None else None
    return int(Outcome.INTERRUPTED) if code is None or code < 0 else code


def _started(command: Sequence[str]) -> subprocess.Popen[bytes]:
    """A process that hears of a request to stop once it can answer it; Python, while it begins, would just fail."""
    held = {signal.SIGINT}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, held)
    try:
        return subprocess.Popen(command, start_new_session=True)  # noqa: S603
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _Server(ThreadingHTTPServer):
    """Serves a few clients at once, and reports errors in one line."""

    daemon_threads = True

    def __init__(self, *where: Any) -> None:
        self._places = threading.BoundedSemaphore(CLIENTS)
        super().__init__(*where)

    def process_request(self, request: Any, client_address: Any) -> None:
        """In a thread, unless there are too many already."""
        if self._places.acquire(blocking=False):
            super().process_request(request, client_address)
        else:
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """The thread of one client."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._places.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A client that leaves is no fault."""
        del request, client_address
        error = sys.exception()
        if error is not None and not isinstance(error, (ConnectionError, TimeoutError)):
            say_on(sys.stderr, f"view: {in_one_line(f'{type(error).__name__}: {error}')}")


def serve(live: LiveRun, port: int = 0) -> ThreadingHTTPServer:
    """A server of a page on this machine alone, at work in a thread of its own.

    Parameters
    ----------
    live
        What it shows.
    port
        0 takes a free one.
    """

    class Handler(BaseHTTPRequestHandler):
        """Answers ``/``, ``/data``, ``/progress`` and ``/stop``."""

        timeout = IDLE_SECONDS
        server_version, sys_version = "heavylift", ""

        def handle(self) -> None:
            # who sends a letter now and then is never idle
            self._patience = threading.Timer(IDLE_SECONDS, self._hang_up)
            self._patience.daemon = True
            self._patience.start()
            try:
                super().handle()
            finally:
                self._patience.cancel()

        def _hang_up(self) -> None:
            with contextlib.suppress(OSError):
                self.connection.shutdown(socket.SHUT_RDWR)

        def do_GET(self) -> None:
            if not self._is_ours():
                return
            if self.path == "/":
                text = page_html(live.content())
                self._answer(text.encode(), "text/html; charset=utf-8")
            elif self.path == "/data":
                content = live.content()
                self._answer(live_content(content.header, content.block), "application/octet-stream")
            elif self.path == "/progress":
                self._answer(json.dumps(live.progress()).encode(), "application/json")
            else:
                self.send_error(HTTPStatus.NOT_FOUND)

        def do_POST(self) -> None:
            if not self._is_ours():
                return
            sent = self.headers.get("X-Heavylift", "")
            if self.path != "/stop" or not secrets.compare_digest(sent.encode(), live.token.encode()):
                self.send_error(HTTPStatus.FORBIDDEN)
                return
            live.stop()
            self._answer(b"{}", "application/json")

        def _is_ours(self) -> bool:
            """Whether the page of this server asks, not one that leads its own name to this machine."""
            self._patience.cancel()  # it has asked
            own = {f"{name}:{self.server.server_address[1]}" for name in (HOST, "localhost")}  # type: ignore[index]
            if self.headers.get("Host") in own:
                return True
            self.send_error(HTTPStatus.FORBIDDEN)
            return False

        def _answer(self, content: bytes, kind: str) -> None:
            self.send_response(HTTPStatus.OK)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(content)))
            self.send_header("Cache-Control", "no-store")
            self.end_headers()
            for begin in range(0, len(content), PIECE):  # the time limit is one of each piece
                self.wfile.write(content[begin : begin + PIECE])

        def end_headers(self) -> None:
            for name, value in SAFE_HEADERS.items():
                self.send_header(name, value)
            self.send_header("Content-Security-Policy", content_policy())
            super().end_headers()

        def log_message(self, format: str, *args: Any) -> None:  # noqa: A002  the name is that of the library
            """Nothing: the terminal belongs to the run."""

    server = _Server((HOST, port), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return server
