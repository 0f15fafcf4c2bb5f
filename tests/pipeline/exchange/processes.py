"""Processes that serve the hoist, for tests that start and end them."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path

from heavylift.numerics.children import python_command

HOIST = Path(__file__).parents[3] / "cases" / "hoist"
COMMAND = python_command("-c", "from heavylift.pipeline.commands.start import main; main()", "serve")


def until(condition, seconds: float = 60.0) -> None:
    """Wait for something that another process does."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def gone(pid: int) -> bool:
    """Whether a process that this one has not started has ended."""
    stat = Path(f"/proc/{pid}/stat")
    return not stat.exists() or stat.read_text(encoding="utf-8").rpartition(")")[2].split()[0] == "Z"


def started(case: Path, file: Path, *options: str) -> tuple[subprocess.Popen[bytes], Path]:
    """A server, once it waits for clients, and the file with its address."""
    command = [*COMMAND, str(case), "--port", "0", "--token-file", str(file), *options]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
    until(lambda: file.exists() or server.poll() is not None)
    return server, file
