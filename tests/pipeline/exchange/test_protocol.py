"""The table of messages: requests are checked by it."""

from __future__ import annotations

import doctest

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.exchange import protocol
from heavylift.pipeline.exchange.protocol import (
    MESSAGES,
    TYPES,
    FormatError,
    check_request,
    message_tables,
    unpacked,
)

msgpack = pytest.importorskip("msgpack")


def test_examples():
    assert doctest.testmod(protocol).failed == 0


def test_all_fields_have_a_type_and_all_requests_one_that_is_checked():
    for message in MESSAGES.values():
        for field in (*message.fields, *message.answer):
            assert field.type in TYPES, (message.do, field)
        assert {field.type for field in message.fields} <= set(protocol._CHECKS), message.do


@pytest.mark.parametrize(
    ("request_", "key"),
    [
        ({"do": "jump"}, "do"),
        ({"do": "get"}, "get.outputs"),
        ({"do": "get", "outputs": "load.position.z"}, "get.outputs"),
        ({"do": "get", "outputs": ["a", 1]}, "get.outputs"),
        ({"do": "step", "dt": "1 s"}, "step.dt"),
        ({"do": "step", "dt": True}, "step.dt"),
        ({"do": "step", "inputs": {"gust": [1.0, 2.0, 3.0]}}, "step.inputs"),
        ({"do": "step", "inputs": {"gust": None}}, "step.inputs"),
        ({"do": "step", "inputs": {1: 1.0}}, "step.inputs"),
        ({"do": "step", "far": 1.0}, "step"),
        ({"do": "free", "state": 1.0}, "free.state"),
        ({"do": "describe", b"x": 1}, "describe"),
    ],
)
def test_a_wrong_request_names_the_field(request_, key):
    with pytest.raises(InputError) as caught:
        check_request({"id": 1, **request_})
    assert caught.value.key == key
    assert caught.value.expected


@pytest.mark.parametrize("request_", [{}, {"id": "1", "do": "get"}, {"id": True, "do": "get"}, {"id": 1}])
def test_a_request_without_number_or_word_has_no_answer(request_):
    with pytest.raises(FormatError):
        check_request(request_)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\x81",  # a map that ends
        b"\x80\x80",  # two maps
        b"\x90",  # a list
        b"\xc1",  # never used
        b"\xdf\xff\xff\xff\xff",  # four thousand million entries
        b"\xdd\xff\xff\xff\xff" * 3,
        b"\x81\x01\x01",  # a number as a key
        b"\x91" * 100_000,  # deeper than the library goes
        b"\x81\xa1x\xc7\x01\x05\x00",  # a type that nobody knows, within a map: read, and refused as a field
    ],
)
def test_bytes_that_are_no_message(data):
    try:
        message = unpacked(msgpack, data)
    except FormatError:
        return
    with pytest.raises(FormatError):
        check_request(message)


def test_the_tables_name_everything():
    text = message_tables()
    for message in MESSAGES.values():
        assert f"`{message.do}`" in text
        for field in (*message.fields, *message.answer):
            assert field.sentence in text
    for kind in protocol.ERROR_KINDS:
        assert f"| `{kind}` |" in text
