"""What a server answers, and clients that are wrong, silent, slow, many or gone."""

from __future__ import annotations

import contextlib
import math
import random
import socket
import struct
import threading
import time

import pytest

import heavylift as hl
from heavylift.pipeline.exchange import server as server_module
from heavylift.pipeline.exchange import service as service_module
from heavylift.pipeline.exchange.protocol import (
    HEADER,
    LARGEST_HELLO,
    LARGEST_MESSAGE,
    LARGEST_QUESTION,
    framed,
)

msgpack = pytest.importorskip("msgpack")

NAMES = ["load.position.x", "load.position.z", "fall.tension"]


def same_state(data: bytes, simulation: hl.Simulation) -> bool:
    """Whether bytes are the state of a simulation, to the bit, but for the time that it took."""
    found, own = hl.State.from_bytes(data).arrays, simulation.save().arrays
    return found.keys() == own.keys() and all(
        found[name].tobytes() == own[name].tobytes() for name in own if name != "cpu_seconds"
    )


def test_a_session_has_the_bits_of_the_simulation_itself(served, hoist):
    direct = hoist.copy()
    with served.client() as remote:
        assert remote.case == "hoist"
        assert (remote.step_size, remote.duration) == (direct.step_size, direct.duration)
        assert dict(remote.outputs) == dict(direct.outputs)
        for _ in range(5):
            remote.step(0.1, outputs=NAMES)
            direct.step(0.1)
            assert remote.time == direct.time
            assert [remote[name] for name in NAMES] == [direct[name] for name in NAMES]
        assert remote["load.position"].tolist() == direct["load.position"].tolist()
        state = remote.save()
        assert same_state(state.to_bytes(), direct)
        assert same_state(remote.save_bytes(), direct)
        remote.step(1.0)
        first = remote["load.position.z"]
        remote.restore(state)
        assert remote.time == direct.time
        remote.step(1.0)
        direct.step(1.0)
        assert remote["load.position.z"] == first == direct["load.position.z"]
        assert not remote.ended
        remote.step(direct.duration - direct.time)
        assert remote.ended
    served.thread.join(20)
    assert served.reason == "the master has ended the run"


def test_states_that_nobody_refers_to_are_forgotten(served):
    remote = served.client()
    for _ in range(5):
        remote.save()
    assert len(served.service.master.states) <= 2


def refused(answer: dict, kind: str, *words: str) -> None:
    assert answer["ok"] is False
    assert answer["error"]["kind"] == kind
    text = " ".join(map(str, answer["error"].values()))
    for word in words:
        assert word in text, text


@pytest.mark.parametrize(
    ("fields", "kind", "word"),
    [
        ({"token": "a-wrong-word"}, "refused", "wrong token"),
        ({"token": ""}, "refused", "wrong token"),
        ({"token": "\udcff"}, "refused", "wrong token"),
        ({"protocol": 2}, "refused", "speaks 1"),
        ({"role": "captain"}, "input", "master or observer"),
        ({"token": 5}, "input", "hello.token"),
    ],
)
def test_a_wrong_greeting_is_refused_and_the_connection_closed(served, fields, kind, word):
    wire = served.wire()
    if fields.get("token") == "\udcff":
        packed = msgpack.packb(
            {"id": 1, "do": "hello", "protocol": 1, "role": "master", "token": "\udcff"},
            unicode_errors="surrogatepass",
        )
        wire.send(framed(packed))
        answer = wire.answer()
        refused(answer, "refused")
    else:
        refused(wire.hello(**fields), kind, word)
    assert wire.closed()
    assert served.wire().hello()["ok"]


def test_the_error_for_a_wrong_token_says_so_to_python(served):
    with pytest.raises(hl.ExchangeError, match="wrong token"):
        hl.connect("127.0.0.1", served.port, "wrong")


def test_nothing_is_answered_before_a_greeting(served):
    wire = served.wire()
    refused(wire.ask("describe"), "refused", "hello")
    assert wire.closed()


def test_a_second_master_hears_who_is_the_first(served):
    first = served.client()
    with pytest.raises(hl.ExchangeError, match=r"127\.0\.0\.1:\d+ is the master already"):
        served.client()
    first.step()


def test_an_observer_reads_and_changes_nothing(served):
    master, observer = served.client(), served.client("observer")
    for number in range(1, 4):
        master.step(0.1, outputs=NAMES)
        assert observer["fall.tension"] == master["fall.tension"]
        assert observer.time == pytest.approx(0.1 * number, abs=1e-12)
    for call in (observer.step, observer.save, lambda: observer.set("gust", 1.0)):
        with pytest.raises(hl.ExchangeError, match="observer"):
            call()
    assert same_state(observer.save_bytes(), served.simulation)
    observer.close()
    master.step(0.1)
    assert served.thread.is_alive()


def test_bad_requests_change_nothing_and_the_connection_stays(served, hoist):
    wire = served.wire()
    wire.hello()
    before = hoist.save().to_bytes()
    handle = wire.ask("save")["state"]
    damaged = bytearray(before)
    damaged[-1] ^= 1
    for do, fields, words in (
        ("jump", {}, ("jump", "describe")),
        ("step", {"dt": math.nan}, ("nan", "dt")),
        ("step", {"dt": math.inf}, ("inf", "dt")),
        ("step", {"dt": 0.0123}, ("0.0123", "0.01 s")),
        ("step", {"dt": -0.01}, ("-0.01",)),
        ("step", {"dt": 1e9}, ("ends at 20 s",)),
        ("step", {"dt": 0.01, "outputs": ["load.positio.z"]}, ("load.positio.z", "load.position.z")),
        ("get", {"outputs": ["nothing"]}, ("nothing",)),
        ("restore", {}, ("either",)),
        ("restore", {"state": handle, "bytes": before}, ("either",)),
        ("restore", {"state": 77}, ("77", "restore.state")),
        ("restore", {"bytes": b"nonsense"}, ("no state",)),
        ("restore", {"bytes": bytes(damaged)}, ("no state",)),
        ("free", {"state": 77}, ("77", "free.state")),
        ("save", {"state": handle}, ("bytes",)),
    ):
        refused(wire.ask(do, **fields), "input", *words)
        assert same_state(before, hoist), do
    refused(wire.hello(), "refused", "master already")
    assert wire.ask("free", state=handle)["ok"]
    assert wire.ask("step")["time"] == hoist.step_size


def test_malformed_bytes_get_one_error_and_end_the_connection_alone(served):
    master = served.client()
    good = msgpack.packb({"id": 1, "do": "hello", "protocol": 1, "role": "observer", "token": "x"})
    for data, word in (
        (b"\xff\xff\xff\xff", "4294967295"),
        (HEADER.pack(LARGEST_HELLO + 1), "longer"),
        (b"GET / HTTP/1.1\r\n\r\n", "longer"),
        (framed(b""), "not msgpack"),
        (framed(b"\x90"), "not a map"),
        (framed(b"\x91" * 3000), "not msgpack"),
        (framed(good[:-3]), "not msgpack"),
        (framed(good + b"\x00"), "not msgpack"),
        (framed(msgpack.packb({"do": "hello"})), "'id'"),
        (framed(msgpack.packb({"id": 1})), "'do'"),
    ):
        wire = served.wire()
        wire.send(data)
        answer = wire.answer()
        assert answer["id"] is None
        refused(answer, "refused", word)
        assert wire.closed()
    observer = served.wire()
    observer.hello("observer")
    observer.send(HEADER.pack(LARGEST_QUESTION + 1))
    refused(observer.answer(), "refused", "longer")
    assert observer.closed()
    master.step()
    master._connection.sendall(HEADER.pack(LARGEST_MESSAGE + 1))
    with pytest.raises(hl.ExchangeError, match="longer"):
        master.step()


def test_states_take_no_more_memory_than_is_said(served, monkeypatch):
    wire = served.wire()
    wire.hello()
    size = sum(array.nbytes for array in served.simulation.save().arrays.values())
    monkeypatch.setattr(service_module, "LARGEST_STATES", 3 * size + 1)
    handles = [wire.ask("save")["state"] for _ in range(3)]
    refused(wire.ask("save"), "refused", "3 states", "free")
    wire.ask("free", state=handles[0])
    assert wire.ask("save")["ok"]


def test_lists_of_outputs_are_not_remembered_for_ever(served, monkeypatch):
    monkeypatch.setattr(service_module, "KNOWN_LISTS", 3)
    monkeypatch.setattr(service_module, "KNOWN_NAMES", 4)
    wire = served.wire()
    wire.hello()
    for count in range(1, 8):
        assert len(wire.ask("get", outputs=NAMES[:1] * count)["values"]) == count
    assert 0 < len(served.service._columns) <= 3


def test_random_bytes_never_end_the_server(served):
    master = served.client()
    random_ = random.Random(20)  # noqa: S311
    good = framed(
        msgpack.packb({"id": 1, "do": "hello", "protocol": 1, "role": "observer", "token": "a-word"})
    )
    then = framed(msgpack.packb({"id": 2, "do": "get", "outputs": NAMES}))
    for number in range(300):
        data = bytearray(good + then)
        if number % 3 == 0:
            data = bytearray(random_.randbytes(random_.randrange(1, 200)))
        else:
            for _ in range(random_.randrange(1, 5)):
                data[random_.randrange(len(data))] = random_.randrange(256)
            if number % 3 == 2:
                del data[random_.randrange(len(data)) :]
        wire = served.wire()
        wire.send(bytes(data))
        wire.close()
    master.step(outputs=NAMES)
    assert served.thread.is_alive()
    assert not served.service.fault


def test_a_message_that_comes_byte_by_byte_and_two_at_once_are_answered(served):
    wire = served.wire()
    wire.hello()
    request = framed(msgpack.packb({"id": 7, "do": "step", "dt": 0.01}))
    for k in range(len(request)):
        wire.send(request[k : k + 1])
    assert wire.answer()["id"] == 7
    wire.send(request * 50)
    times = [wire.answer()["time"] for _ in range(50)]
    assert times == sorted(times)
    assert times[-1] == pytest.approx(0.51, abs=1e-12)


def test_many_requests_at_once_with_long_answers_are_answered_in_order(served):
    wire = served.wire()
    wire.hello()
    names = [*served.simulation.outputs] * 100
    count = 100

    def ask() -> None:
        for number in range(count):
            wire.send(framed(msgpack.packb({"id": number, "do": "get", "outputs": names})))

    asking = threading.Thread(target=ask)
    asking.start()
    time.sleep(0.2)  # the buffers of both sides are full
    answers = [wire.answer() for _ in range(count)]
    asking.join()
    assert [answer["id"] for answer in answers] == list(range(count))
    assert all(answer["values"] == answers[0]["values"] for answer in answers)


def test_what_is_sent_faster_than_it_is_done_stays_with_who_sends_it(served):
    wire, peak = served.wire(), []
    wire.hello()
    client = next(iter(served.server._clients.values()))
    request = framed(msgpack.packb({"id": 1, "do": "get", "outputs": []}))

    def ask() -> None:
        with contextlib.suppress(OSError):  # until the connection is closed
            for _ in range(200):
                wire.send(request * 1000)

    asking = threading.Thread(target=ask)
    asking.start()
    for _ in range(300):
        peak.append(len(client.incoming))
        time.sleep(1e-3)
    wire.socket.shutdown(socket.SHUT_RDWR)
    asking.join()
    assert 0 < max(peak) <= 2 * server_module.PIECE


def test_a_long_step_costs_nobody_his_time(served, hoist, monkeypatch):
    monkeypatch.setattr(server_module, "HELLO_SECONDS", 0.4)
    master, late = served.client(), served.wire()
    step = type(hoist).step
    monkeypatch.setattr(type(hoist), "step", lambda *given: (time.sleep(1.0), step(*given))[1])
    stepping = threading.Thread(target=master.step)
    stepping.start()
    time.sleep(0.2)
    assert late.hello("observer")["ok"]  # it was said in time
    stepping.join()


def test_clients_that_say_nothing_or_not_all_are_left(served, monkeypatch):
    monkeypatch.setattr(server_module, "HELLO_SECONDS", 0.3)
    monkeypatch.setattr(server_module, "PATIENCE_SECONDS", 0.3)
    monkeypatch.setattr(server_module, "SLOWEST", 2**40)
    silent, half = served.wire(), served.wire()
    half.hello("observer")
    half.send(b"\x00\x00\x00\x10abc")
    begin = time.monotonic()
    refused(silent.answer(), "refused", "greeting")
    refused(half.answer(), "refused", "rest of a message")
    assert silent.closed()
    assert half.closed()
    assert time.monotonic() - begin < 10.0


def test_a_client_that_does_not_read_is_left(served, monkeypatch):
    monkeypatch.setattr(server_module, "PATIENCE_SECONDS", 0.3)
    monkeypatch.setattr(server_module, "SLOWEST", 2**40)
    wire = served.wire()
    wire.hello("observer")
    names = [*served.simulation.outputs] * 200
    request = framed(msgpack.packb({"id": 1, "do": "get", "outputs": names}))
    try:
        for _ in range(400):
            wire.send(request)
    except OSError:  # the buffers are full, and then the connection is gone
        pass
    begin = time.monotonic()
    while wire.socket.fileno() >= 0 and time.monotonic() - begin < 10.0:
        try:
            if not wire.socket.recv(2**16):
                break
        except ConnectionError:
            break
    served.client().step()


def test_there_is_an_end_to_how_many_clients_there_are(served, monkeypatch):
    monkeypatch.setattr(server_module, "CLIENTS", 3)
    first = [served.client("observer") for _ in range(3)]
    with pytest.raises(hl.ExchangeError, match="3 clients"):
        served.client("observer")
    first[0].close()
    assert first[1].time == 0.0


def test_a_master_that_vanishes_leaves_the_run_to_another_one(serve):
    served = serve(wait=600.0)
    first = served.client()
    first.step(0.5)
    first.save()
    first._end()  # no farewell
    second = None
    for _ in range(100):  # the server hears of it in its own time
        try:
            second = served.client()
            break
        except hl.ExchangeError:
            time.sleep(0.02)
    assert second is not None
    assert second.time == 0.5
    second.step(0.1)
    assert "has gone at t = 0.5 s; waits 600 s" in served.lines[0]
    second.close(end=False)
    third = served.client()
    assert third.time == pytest.approx(0.6, abs=1e-12)


@pytest.mark.parametrize("cut", [0, 3])
def test_a_master_that_vanishes_within_a_message(served, hoist, cut):
    """A whole message is done, with nobody to answer; a part of one is none."""
    wire = served.wire()
    wire.hello()
    request = framed(msgpack.packb({"id": 2, "do": "step", "dt": 2.0}))
    wire.send(request[: len(request) - cut])
    wire.socket.setsockopt(
        socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0)
    )  # a reset, no farewell
    wire.close()
    observer = served.client("observer")
    deadline = time.monotonic() + 20.0
    while served.service.master is not None and time.monotonic() < deadline:
        observer.get(NAMES)
    assert served.service.master is None
    if cut:
        assert hoist.time == 0.0
    assert hoist.time in (0.0, 2.0)  # the reset may overtake the message
    served.client().step(0.1)


def test_without_a_master_the_run_ends_after_a_while(serve):
    served = serve(wait=0.3)
    observer = served.client("observer")
    served.thread.join(20)
    assert served.reason == "no master for 0.3 s"
    with pytest.raises(hl.ExchangeError, match=r"the run has ended: no master for 0\.3 s"):
        observer.get(NAMES)


def test_a_fault_is_told_and_ends_the_run(served, monkeypatch):
    remote = served.client()
    monkeypatch.setattr(type(served.simulation), "step", lambda *_: 1 // 0)
    with pytest.raises(hl.ExchangeError, match="ZeroDivisionError"):
        remote.step()
    served.thread.join(20)
    assert "ZeroDivisionError" in served.reason


def test_a_run_that_stops_by_itself_is_told_and_stays(served, monkeypatch):
    remote = served.client()

    def stop(*_: object) -> None:
        raise hl.SimulationStopped(hl.Outcome.STEP_TOO_LARGE, "at t = 1 s: too large")

    with monkeypatch.context() as patched:
        patched.setattr(type(served.simulation), "step", stop)
        with pytest.raises(hl.SimulationStopped, match="too large") as caught:
            remote.step()
    assert caught.value.outcome is hl.Outcome.STEP_TOO_LARGE
    remote.step()


def test_a_client_whose_server_is_gone_says_so(served):
    remote = served.client()
    served.stop("an end")
    with pytest.raises(hl.ExchangeError, match="the run has ended: an end"):
        remote.step()
    with pytest.raises(hl.ExchangeError, match="closed"):
        remote.step()
    with pytest.raises(hl.ExchangeError, match=str(served.port)):
        hl.connect("127.0.0.1", served.port, "x")


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (b"HTTP/1.1 400 Bad Request\r\n\r\n", "not a server of heavylift"),
        (framed(b"\x90"), "not a server of heavylift"),
        (framed(b"\xc1"), "not a server of heavylift"),
        (framed(msgpack.packb({"id": 1, "ok": False})), "an answer to something else"),
        (framed(msgpack.packb({"id": 5, "ok": True})), "an answer to something else"),
        (framed(msgpack.packb({"id": 1, "ok": True}))[:-1], "has closed the connection"),
        (b"", "has closed the connection"),
        (None, r"no answer within 0\.2 s"),
    ],
)
def test_a_server_of_something_else(answer, words):
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def serve() -> None:
            connection, _ = listener.accept()
            with connection:
                if answer is not None:
                    connection.recv(1000)
                    connection.sendall(answer)
                else:
                    connection.recv(1000)
                    connection.recv(1000)  # until the client gives up

        thread = threading.Thread(target=serve)
        thread.start()
        with pytest.raises(hl.ExchangeError, match=words):
            hl.connect(
                "127.0.0.1", listener.getsockname()[1], "x", timeout=5.0 if answer is not None else 0.2
            )
        thread.join()
