"""The command ``serve``: processes that begin and end, files they leave, and options that are wrong."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import heavylift as hl
from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, load_results
from heavylift.pipeline.exchange import client as client_module
from heavylift.pipeline.exchange.serving import serve_case
from heavylift.pipeline.log import Log
from tests.pipeline.exchange.processes import COMMAND, HOIST, gone, started, until

msgpack = pytest.importorskip("msgpack")

NAMES = ["load.position.x", "load.position.z", "fall.tension"]


def test_a_state_goes_on_in_another_process_with_the_same_bits(tmp_path):
    here = hl.Simulation(HOIST)
    here.step(1.0)
    with hl.open_child(HOIST, out=tmp_path / "out") as there:
        there.restore(here.save())
        assert there.time == here.time
        for _ in range(3):
            here.step(0.4)
            there.step(0.4, outputs=NAMES)
            assert [there[name] for name in NAMES] == [here[name] for name in NAMES]
        child = there._child
    assert child.returncode == 0
    kept = load_results(load_case(HOIST), tmp_path / "out")
    assert kept.time[-1] == pytest.approx(2.2, abs=1e-12)
    assert kept["fall.tension"][-1] == here["fall.tension"]


def test_a_wrong_case_is_told_through_the_pipe(tmp_path, capfd):
    (tmp_path / "case.toml").write_text("[simulate]\nduration = 5\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"simulate\.output_interval: is missing"):
        hl.open_child(tmp_path)
    with pytest.raises(InputError, match=r"simulate\.speed"):
        hl.open_child(HOIST, overrides=["simulate.speed=1"])
    assert capfd.readouterr().err == ""  # it is told once


@pytest.fixture
def long_case(tmp_path):
    """The hoist for eleven days."""
    folder = tmp_path / "long"
    folder.mkdir()
    head = (HOIST / "case.toml").read_text(encoding="utf-8").partition("[[reference]]")[0]
    rest = '[simulate]\nstep = "1 ms"\noutput_interval = "1000 s"\nduration = "1e6 s"\n'
    (folder / "case.toml").write_text(head + rest, encoding="utf-8")
    return folder


@pytest.mark.parametrize(
    "number",
    [
        signal.SIGTERM,
        *(pytest.param(each, marks=pytest.mark.slow) for each in (signal.SIGINT, signal.SIGHUP)),
    ],
)
def test_a_signal_ends_the_run_and_its_results_are_kept(tmp_path, number):
    server, file = started(HOIST, tmp_path / "token", "--out", str(tmp_path / "out"))
    assert file.stat().st_mode & 0o777 == 0o600
    master, observer = hl.connect(token_file=file), hl.connect(token_file=file, role="observer")
    master.step(1.0, outputs=NAMES)
    tension = master["fall.tension"]
    server.send_signal(number)
    said, complained = server.communicate(timeout=60)
    assert server.returncode == int(hl.Outcome.INTERRUPTED)
    assert complained == b""
    assert b"ends at t = 1 s: SIG" in said
    assert not file.exists()
    for client in (master, observer):
        with pytest.raises(hl.ExchangeError, match="the run has ended"):
            client.get(["load.velocity.x"])
    results = load_results(load_case(HOIST), tmp_path / "out")
    assert results.time[-1] == 1.0
    assert results["fall.tension"][-1] == tension


def test_a_signal_ends_a_long_step(tmp_path, long_case):
    server, file = started(long_case, tmp_path / "token")
    connect = f"import heavylift as hl\nmaster = hl.connect(token_file={str(file)!r})\n"
    code = connect + "print('connected', flush=True)\nmaster.step(9e5)\n"
    client = subprocess.Popen(
        [sys.executable, "-P", "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert client.stdout.readline() == b"connected\n"
    time.sleep(1.0)  # it is on its way
    server.send_signal(signal.SIGTERM)
    assert server.communicate(timeout=60)[1] == b""
    assert server.returncode == int(hl.Outcome.INTERRUPTED)
    assert b"SimulationStopped: interrupted at t = " in client.communicate(timeout=60)[1]


PARENT = """
import sys, time
import heavylift as hl
sim = hl.open_child(sys.argv[1])
print(sim.child_id, flush=True)
if sys.argv[2] == "steps":
    sim.step(9e5)
time.sleep(600)
"""


@pytest.mark.parametrize("what", ["waits", "steps"])
def test_a_child_ends_when_its_parent_is_killed(what, long_case):
    parent = subprocess.Popen(
        [sys.executable, "-P", "-c", PARENT, str(long_case), what], stdout=subprocess.PIPE
    )
    child = int(parent.stdout.readline())
    assert not gone(child)
    if what == "steps":
        time.sleep(0.5)  # it is on its way
    parent.kill()
    parent.communicate()
    until(lambda: gone(child), 20.0)


def test_a_child_that_is_killed_is_told_and_leaves_nothing():
    with hl.open_child(HOIST) as remote:
        os.kill(remote.child_id, signal.SIGKILL)
        with pytest.raises(
            hl.ExchangeError, match="has closed the connection: the process has ended with code -9"
        ):
            remote.step()
    assert gone(remote.child_id)


@pytest.mark.slow
def test_a_child_that_hangs_is_told_after_the_time_that_is_given(monkeypatch):
    monkeypatch.setattr(client_module, "STOP_SECONDS", 0.1)
    remote = hl.open_child(HOIST)
    remote._connection.settimeout(0.3)
    os.kill(remote.child_id, signal.SIGSTOP)
    with pytest.raises(hl.ExchangeError, match=r"no answer within 0\.3 s"):
        remote.step()
    assert gone(remote.child_id)


def test_a_child_that_starts_ends_when_its_parent_is_gone():
    child = subprocess.Popen(
        [*COMMAND, str(HOIST), "--pipe", "--quiet"], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    child.communicate(timeout=60)
    assert child.returncode == int(hl.Outcome.INTERRUPTED)


@pytest.mark.parametrize(
    ("options", "key", "word"),
    [
        ({"port": None, "pipe": False}, "serve", "neither"),
        ({"port": 5000, "pipe": True}, "serve", "both"),
        ({"port": None, "pipe": True, "token_file": Path("token")}, "--token-file", "--pipe"),
        ({"port": 70000, "pipe": False}, "--port", "70000"),
        ({"port": 0, "pipe": False, "wait": 0.0}, "--wait", "more than 0"),
        ({"port": 0, "pipe": False, "wait": float("nan")}, "--wait", "nan"),
        ({"port": 0, "pipe": False, "host": "no.such.host.invalid"}, "serve", "no.such.host.invalid"),
        ({"port": 0, "pipe": False, "log": Log(quiet=True)}, "--quiet", "--token-file"),
    ],
)
def test_wrong_options(options, key, word):
    with pytest.raises(InputError, match=word) as caught:
        serve_case(HOIST, **{"log": Log(), **options})
    assert caught.value.source == key


def test_a_port_that_is_taken_and_a_file_that_cannot_be_written(served, tmp_path):
    with pytest.raises(InputError, match=f"port {served.port}: Address already in use"):
        serve_case(HOIST, port=served.port, pipe=False, log=Log())
    with pytest.raises(InputError, match="--token-file"):
        serve_case(HOIST, port=0, pipe=False, token_file=tmp_path / "no" / "token", log=Log())
    assert os.listdir(tmp_path) == []  # noqa: PTH208


@pytest.mark.slow
def test_a_folder_that_is_taken_is_refused_before_the_run(tmp_path):
    out = tmp_path / "out"
    with hl.open_child(HOIST, out=out) as first:
        with pytest.raises(hl.SimulationStopped, match="works in this folder") as caught:
            hl.open_child(HOIST, out=out)
        assert caught.value.outcome is hl.Outcome.LOCKED
        first.step()
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="File exists"):
        hl.open_child(HOIST, out=tmp_path / "file")


def test_another_host_is_warned_of(capfd, tmp_path):
    folder = tmp_path / "a_folder"
    folder.mkdir()
    with pytest.raises(InputError, match="a_folder"):
        serve_case(HOIST, port=0, pipe=False, host="0.0.0.0", token_file=folder, log=Log())  # noqa: S104
    assert "nothing is encrypted" in capfd.readouterr().err


def test_what_is_no_address_file(tmp_path):
    for text in ("", "127.0.0.1 5000", "127.0.0.1 port token"):
        (tmp_path / "token").write_text(text, encoding="utf-8")
        with pytest.raises(InputError, match="--token-file"):
            hl.connect(token_file=tmp_path / "token")
    with pytest.raises(InputError, match="No such file"):
        hl.connect(token_file=tmp_path / "nothing")
    with pytest.raises(InputError, match="port"):
        hl.connect("127.0.0.1", token="x")  # noqa: S106


@pytest.mark.parametrize("begin", [lambda: hl.connect(port=1, token="x"), lambda: hl.open_child(HOIST)])  # noqa: S106
def test_without_the_library_nothing_begins(begin, monkeypatch):
    monkeypatch.setitem(sys.modules, "msgpack", None)
    monkeypatch.setattr(subprocess, "Popen", lambda *_, **__: pytest.fail("a process was started"))
    with pytest.raises(InputError, match=r"pip install 'heavylift\[serve\]'"):
        begin()
    with pytest.raises(InputError, match=r"heavylift\[serve\]"):
        serve_case(HOIST, port=0, pipe=False, log=Log())


@pytest.mark.parametrize("timeout", [0.0, -1.0, float("nan"), float("inf")])
def test_times_that_nobody_can_wait(timeout):
    with pytest.raises(InputError, match="timeout"):
        hl.open_child(HOIST, timeout=timeout)
    with pytest.raises(InputError, match="timeout"):
        hl.connect(port=1, token="x", timeout=timeout)  # noqa: S106
