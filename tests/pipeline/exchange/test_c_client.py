"""The client in C: without warnings, without undefined behaviour, and with the bits of the client in Python."""

from __future__ import annotations

import random
import shutil
import socket
import subprocess
import threading
from pathlib import Path

import pytest

import heavylift as hl
from heavylift.pipeline.exchange.protocol import framed
from tests.pipeline.exchange.processes import COMMAND, HOIST, gone, started, until

msgpack = pytest.importorskip("msgpack")

SOURCES = Path(hl.__file__).parents[1] / "pipeline" / "exchange"
WARNINGS = ("-Wall", "-Wextra", "-Werror", "-pedantic", "-Wconversion", "-Wshadow")
CLEAN = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g")
NAMES = ["load.position.x", "load.position.z", "fall.tension"]


def compiled(source: Path, program: Path) -> Path:
    """A program, with checks of addresses and of undefined behaviour where the compiler has them."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("no C compiler")
    command = [compiler, "-std=c99", *WARNINGS, "-I", str(SOURCES), str(source), "-o", str(program)]
    clean = subprocess.run([*command, *CLEAN], capture_output=True, text=True, check=False)
    if clean.returncode:
        subprocess.run([*command, "-O2"], check=True)
    return program


@pytest.fixture(scope="session")
def session(tmp_path_factory):
    return compiled(Path(__file__).parent / "session.c", tmp_path_factory.mktemp("c") / "session")


def said(session, *arguments, code=0):
    """Lines of a session; one with an error of memory has another exit code."""
    done = subprocess.run([session, *arguments], capture_output=True, text=True, check=False, timeout=100)
    assert (done.returncode, done.stderr) == (code, "")
    return done.stdout.splitlines()


def expected() -> list[list[float]]:
    """Times and outputs of a session, by a simulation in this process."""
    sim = hl.Simulation(HOIST)

    def row() -> list[float]:
        return [sim.time, *(sim[name] for name in NAMES)]

    rows = []
    for _ in range(6):
        sim.step(0.1)
        rows.append(row())
    sim.step(sim.duration - sim.time)
    return [*rows, row()]


def test_a_session_in_c_has_the_bits_of_python_and_its_errors(session):
    lines = said(session, "child", *COMMAND, str(HOIST), "--pipe", "--quiet")
    *rows, last = expected()
    sim = hl.Simulation(HOIST)
    first = next(iter(sim.outputs.values()))
    words = lines[0].split()
    assert words[:4] == ["0", "inputs,", str(len(sim.outputs)), "outputs,"]
    assert [float.fromhex(words[5]), float.fromhex(words[8])] == [sim.step_size, sim.duration]
    assert lines[0].endswith(f"{first.name} [{first.unit}]: {first.sentence}")
    assert [[float.fromhex(word) for word in line.split()] for line in lines[1:7]] == rows
    assert lines[7:9] == ["restored: same bits", "from bytes: same bits"]
    errors = lines[9:-2]
    for line, words in zip(
        errors,
        (
            ("damaged: 1", "no state"),
            ("restore: 1", "restore.state: 1; expected the handle of a state that is kept"),
            ("step: 1", "nan s is no multiple of 0.01 s"),
            ("step: 1", "ends at 20 s"),
            ("get: 1", "load.speed"),
            ("get: 1", "load.position: not one number"),
        ),
        strict=True,
    ):
        for word in words:
            assert word in line
    assert [float.fromhex(word) for word in lines[-2].split()] == last
    assert lines[-1] == "ended"


def test_over_tcp_and_what_is_refused(session, tmp_path):
    server, file = started(HOIST, tmp_path / "token")
    host, port, token = file.read_text(encoding="utf-8").split()
    wrong = said(session, "tcp", host, port, "a-wrong-word", code=1)
    assert wrong == ["open: 3 wrong token: take the one that the server has printed"]
    observer = said(session, "file", str(file), "observer")
    assert [line for line in observer if line.startswith("step: 3 an observer cannot")]
    over_tcp = said(session, "tcp", host, port, token)
    assert server.wait(60) == 0
    server.communicate()
    assert over_tcp == said(session, "child", *COMMAND, str(HOIST), "--pipe", "--quiet")
    (line,) = said(session, "tcp", host, port, token, code=1)
    assert line.startswith("open: 5 127.0.0.1: Connection refused")
    assert said(session, "file", str(file), "master", code=1)[0].startswith(f"open: 1 {file}: not a file")


def test_a_command_that_is_none_and_a_case_that_is_wrong(session, tmp_path):
    (line,) = said(session, "child", "/no/such/command", code=1)
    assert line == "open: 5 /no/such/command: No such file or directory"
    (line,) = said(session, "child", "/bin/true", code=1)
    assert line == "open: 5 the other process has closed the connection"
    done = subprocess.run(
        [session, "child", *COMMAND, str(tmp_path), "--pipe"], capture_output=True, text=True, check=False
    )
    assert done.stdout.startswith("open: 1 ")
    assert "does not exist" in done.stdout


@pytest.mark.slow
def test_a_child_ends_when_its_host_in_c_is_killed(tmp_path):
    source = tmp_path / "host.c"
    source.write_text(
        "#define _POSIX_C_SOURCE 200809L\n"
        '#include "heavylift_client.c"\n'
        "int main(int argc, char **argv)\n{\n    hl_client *c;\n"
        "    if (argc < 2 || hl_open_child(&c, (const char *const *)(argv + 1), 100.0)) return 1;\n"
        '    printf("%d\\n", (int)c->child);\n    fflush(stdout);\n    pause();\n    return 0;\n}\n',
        encoding="utf-8",
    )
    program = compiled(source, tmp_path / "host")
    host = subprocess.Popen([program, *COMMAND, str(HOIST), "--pipe", "--quiet"], stdout=subprocess.PIPE)
    child = int(host.stdout.readline())
    assert not gone(child)
    host.kill()
    host.communicate()  # closes the pipe too
    until(lambda: gone(child), 20.0)


def test_answers_that_are_none_never_harm_the_client(session):
    """A server that changes bytes of its answers, cuts them off, or sends anything."""
    random_ = random.Random(7)  # noqa: S311
    port = {
        "name": "a.b",
        "unit": "m",
        "sentence": "words",
        "interpolation": "held",
        "value": 1,
        "smallest": -1.5,
    }
    answers = [
        {"id": 1, "ok": True, "role": "master"},
        {"id": 2, "ok": True, "inputs": [port], "outputs": [port] * 3, "step_size": 0.01, "time": 0.0},
        {"id": 3, "ok": True, "time": 0.1, "values": [1.0, 2, -3], "ended": False},
        {
            "id": 4,
            "ok": False,
            "error": {"kind": "input", "problem": "x" * 500, "key": "k" * 300, "expected": ""},
        },
    ]
    good = b"".join(framed(msgpack.packb(answer)) for answer in answers)
    rounds = 60
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def serve() -> None:
            for number in range(rounds):
                connection, _ = listener.accept()
                data = bytearray(good)
                for _ in range(number and random_.randrange(1, 6)):
                    data[random_.randrange(len(data))] = random_.randrange(256)
                if number % 4 == 3:
                    data = data[: random_.randrange(len(data))]
                if number % 10 == 9:
                    data = bytearray(framed(random_.randbytes(300)) * 3)
                with connection:
                    try:
                        connection.sendall(data)
                        connection.shutdown(socket.SHUT_WR)
                        while connection.recv(65536):
                            pass
                    except OSError:
                        pass

        thread = threading.Thread(target=serve)
        thread.start()
        for _ in range(rounds):
            where = ("127.0.0.1", str(listener.getsockname()[1]), "x")
            done = subprocess.run([session, "tcp", *where], capture_output=True, check=False, timeout=30)
            assert done.returncode in (0, 1), done.stderr.decode()
            assert done.stderr == b""
        thread.join()
