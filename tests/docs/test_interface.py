"""The guide on other programs that drive a case: its programs print what it shows, its tables are those of the code."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
from where import ROOT

from heavylift.numerics.children import python_command
from heavylift.pipeline.exchange.protocol import message_tables

PAGE = (ROOT / "docs" / "interface.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
COMMAND = python_command("-c", "from heavylift.pipeline.commands.start import main; main()")


def test_the_tables_of_messages_are_those_of_the_server():
    assert message_tables() in PAGE


def heavylift(command: str) -> list[str]:
    """A command of the page, run by this interpreter."""
    program, *arguments = shlex.split(command)
    assert program == "heavylift"
    return [*COMMAND, *arguments]


@contextmanager
def served(command: str):
    """A server as the page starts it, once its token is there; it ends by itself."""
    server = subprocess.Popen(heavylift(command), stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    end = time.monotonic() + 100.0
    while not Path("demo.token").exists() and server.poll() is None and time.monotonic() < end:
        time.sleep(0.02)
    yield
    assert server.communicate(timeout=60)[1] == b""
    assert server.returncode == 0


def printed(program: str, folder: Path) -> str:
    """What a program in Python prints, run as a user does."""
    (folder / "program.py").write_text(program, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-P", folder / "program.py"], capture_output=True, text=True, check=True
    )
    return done.stdout


@pytest.mark.slow
def test_the_messages_that_are_shown_have_the_answers_that_are_shown(tmp_path, monkeypatch):
    from heavylift import Simulation
    from heavylift.pipeline.exchange.service import Seat, Service

    monkeypatch.chdir(tmp_path)
    new, _, _ = (text for language, text in BLOCKS if language == "sh")
    subprocess.run(heavylift(new), check=True, capture_output=True)
    with (tmp_path / "demo" / "case.toml").open("a", encoding="utf-8") as file:
        file.write("\n" + next(text for language, text in BLOCKS if language == "toml"))
    service, seat = Service(Simulation("demo"), "..."), Seat("a reader")
    messages = [json.loads(line) for line in BLOCKS[-1][1].splitlines()]
    for request, shown in zip(messages[::2], messages[1::2], strict=True):
        answer = service.answer(request, seat)
        assert answer.keys() == shown.keys()
        assert {key: answer[key] for key in shown if key not in {"values", "heavylift"}} == {
            key: shown[key] for key in shown if key not in {"values", "heavylift"}
        }
        assert answer.get("values", []) == pytest.approx(shown.get("values", []), rel=1e-6)


@pytest.mark.slow
def test_the_programs_print_what_the_page_shows(tmp_path, monkeypatch):
    pytest.importorskip("msgpack")
    monkeypatch.chdir(tmp_path)
    of = {language: [text for found, text in BLOCKS if found == language] for language, _ in BLOCKS}
    new, serve, where = of["sh"]
    subprocess.run(heavylift(new), check=True, capture_output=True)
    with (tmp_path / "demo" / "case.toml").open("a", encoding="utf-8") as file:
        file.write("\n" + of["toml"][0])
    shown = of["text"]
    with served(serve):
        assert printed(of["python"][0], tmp_path) == shown[0]
    assert (tmp_path / "demo" / "out" / "simulate" / "segments").is_dir()
    assert printed(of["python"][1], tmp_path) == shown[1]
    if shutil.which("cc") is None:
        pytest.skip("no C compiler")
    client = Path(printed(re.search(r'"(.*)"', where)[1].replace("; ", "\n"), tmp_path).strip())
    (tmp_path / "demo.c").write_text(of["c"][0], encoding="utf-8")
    command = [
        "cc",
        "-std=c99",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-I",
        client.parent,
        "demo.c",
        "-o",
        "demo_client",
    ]
    subprocess.run(command, check=True)
    with served(serve):
        done = subprocess.run(["./demo_client", "demo.token"], capture_output=True, text=True, check=True)
    assert done.stdout == shown[2]
    assert shown[2].splitlines()[1:] == shown[0].splitlines()[1:]
