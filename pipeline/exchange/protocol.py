"""Messages between a served simulation and its clients, described once.

A message is a length, four bytes with the highest first, and that many bytes of msgpack: one map. A client sends
requests ``{"id": n, "do": word, ...}``, and gets an answer with the same ``id`` to each, in order:
``{"id": n, "ok": true, ...}`` or ``{"id": n, "ok": false, "error": {"kind", "problem", "key", "expected"}}``. The
fields of each message are in `MESSAGES`; the server checks requests by that table, and the guide shows it. msgpack:
https://github.com/msgpack/msgpack/blob/master/spec.md.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any, NamedTuple

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from types import ModuleType

__all__ = [
    "ERROR_KINDS",
    "HEADER",
    "LARGEST_HELLO",
    "LARGEST_MESSAGE",
    "LARGEST_QUESTION",
    "MESSAGES",
    "PROTOCOL",
    "Field",
    "FormatError",
    "Message",
    "check_request",
    "framed",
    "message_tables",
    "msgpack_library",
    "unpacked",
]

PROTOCOL = 1
"""Version of this format: another number is another format."""
HEADER = struct.Struct(">I")
"""The length in front of each message."""
LARGEST_MESSAGE = 2**26
"""Bytes of a message; the state of a scene is the longest one."""
LARGEST_QUESTION = 2**20
"""Bytes of a request of an observer, who sends names alone."""
LARGEST_HELLO = 4096
"""Bytes of the first request, which comes from anyone."""

ERROR_KINDS = {
    "input": "The request is wrong; nothing has changed, and the connection stays.",
    "stopped": "The simulation has stopped by itself; `key` is how. `time` and `ended` are beside the error.",
    "refused": "The server does not do this for this client, or closes the connection.",
    "internal": "A fault of the program; the run ends, and what was computed is kept.",
}
"""What an error may be, and what follows."""


class FormatError(ValueError):
    """Bytes that are no message: what follows them has no meaning either."""


class Field(NamedTuple):
    """A field of a request or of an answer: its type is a key of `TYPES`."""

    name: str
    type: str
    sentence: str
    needed: bool = True


class Message(NamedTuple):
    """What a client may ask for."""

    do: str
    observers: bool
    """Whether clients that only watch may ask for it."""
    sentence: str
    fields: tuple[Field, ...]
    answer: tuple[Field, ...]


def _is_number(value: object) -> bool:
    return type(value) is float or type(value) is int


def _is_names(value: object) -> bool:
    return type(value) is list and all(type(name) is str for name in value)


def _is_inputs(value: object, most: int = 2) -> bool:
    if type(value) is not dict:
        return False
    for name, given in value.items():
        if type(name) is not str:
            return False
        if not _is_number(given) and not (
            type(given) is list and 2 <= len(given) <= most and all(map(_is_number, given))
        ):
            return False
    return True


TYPES = {
    "text": "text",
    "integer": "a whole number",
    "number": "a number",
    "flag": "true or false",
    "bytes": "bytes",
    "names": "a list of names",
    "inputs": "a map of names to a number, or to a list: value, rate",
    "changes": "a map of names to a number, or to a list: value, rate, until (optional)",
    "values": "a list of numbers, and of lists of numbers for channels of several",
    "lines": "a list of maps: time, phase, event, what",
    "input list": "a list of maps: name, unit, sentence, interpolation, value, smallest, largest",
    "record": "a map; in it arrays are maps: shape, complex, data (little-endian float64 by rows)",
    "output list": "a list of maps: name, unit, sentence",
}
"""Words for the types of fields."""

_CHECKS: dict[str, Callable[[Any], bool]] = {
    "text": lambda value: type(value) is str,
    "integer": lambda value: type(value) is int,
    "number": _is_number,
    "flag": lambda value: type(value) is bool,
    "bytes": lambda value: type(value) is bytes,
    "names": _is_names,
    "inputs": _is_inputs,
    "changes": lambda value: _is_inputs(value, 3),
}
"""Whether a value is of a type that fields of requests have."""

_TIME = Field("time", "number", "time of the simulation [s]")
_ENDED = Field("ended", "flag", "whether the simulation is at its end, by its duration or by its scenario")

MESSAGES = {
    message.do: message
    for message in (
        Message(
            "hello",
            True,
            "The first request of a connection; no other is answered before it.",
            (
                Field("protocol", "integer", f"version of the format: {PROTOCOL}"),
                Field("role", "text", "`master`, who drives the run, or `observer`, who watches it"),
                Field(
                    "token",
                    "text",
                    "the word that the server has printed; none is needed through a pipe",
                    needed=False,
                ),
            ),
            (
                Field("protocol", "integer", "version of the format"),
                Field("heavylift", "text", "version of the program"),
                Field("case", "text", "name of the case"),
                Field("role", "text", "as asked for"),
            ),
        ),
        Message(
            "describe",
            True,
            "What the simulation has.",
            (
                Field(
                    "outputs",
                    "flag",
                    "false: the list of outputs, which stays the same, is empty",
                    needed=False,
                ),
            ),
            (
                Field("inputs", "input list", "what may be set; a limit that there is none of is infinite"),
                Field(
                    "outputs",
                    "output list",
                    "what may be read: `OWNER.CHANNEL.COMPONENT`, `OWNER.CHANNEL` of one number",
                ),
                Field("step_size", "number", "time step [s]"),
                Field("duration", "number", "end of the run [s]"),
                Field("outcome", "text", "how it stands: `completed` as long as nothing is wrong"),
                Field("message", "text", "why it has stopped by itself"),
                _TIME,
                _ENDED,
            ),
        ),
        Message(
            "set",
            False,
            "Sets inputs from now on, all of them or none.",
            (
                Field(
                    "inputs",
                    "changes",
                    "values now, their rates [1/s], and times from which on they are held [s]",
                ),
            ),
            (_TIME,),
        ),
        Message(
            "step",
            False,
            "Advances by a time, a multiple of the time step, and answers with outputs at its end.",
            (
                Field("dt", "number", "how far [s]; without it one time step", needed=False),
                Field(
                    "inputs",
                    "inputs",
                    "held inputs act from now on, linear ones are reached at the end",
                    needed=False,
                ),
                Field("outputs", "names", "what to answer with", needed=False),
            ),
            (
                _TIME,
                Field("values", "values", "of `outputs`, in that order"),
                _ENDED,
                Field(
                    "events",
                    "lines",
                    "new lines of the log of the scenario; only if there are some",
                    needed=False,
                ),
            ),
        ),
        Message(
            "get",
            True,
            "Reads outputs; a channel of several numbers is a list.",
            (Field("outputs", "names", "what to read"),),
            (_TIME, Field("values", "values", "of `outputs`, in that order")),
        ),
        Message(
            "save",
            True,
            "Keeps the state with its inputs, or answers with it as bytes, for another process; for observers only so.",
            (
                Field("bytes", "flag", "whether to answer with bytes in place of a handle", needed=False),
                Field(
                    "state",
                    "integer",
                    "with `bytes`: a state that is kept, in place of the present one",
                    needed=False,
                ),
            ),
            (
                Field(
                    "state",
                    "integer",
                    "handle of the state, until `free` or the end of the connection",
                    needed=False,
                ),
                Field("bytes", "bytes", "the state", needed=False),
            ),
        ),
        Message(
            "restore",
            False,
            "Goes back, or over, to a state; one of both fields.",
            (
                Field("state", "integer", "handle of a state", needed=False),
                Field("bytes", "bytes", "a state of the same case", needed=False),
            ),
            (_TIME, _ENDED),
        ),
        Message(
            "linearise",
            False,
            "Matrices and modes of small motions about the state of now, which stays.",
            (
                Field("inputs", "names", "inputs that are driven; all without it", needed=False),
                Field("outputs", "names", "outputs of C and D; none without it", needed=False),
            ),
            (
                Field(
                    "linearisation",
                    "record",
                    "the fields of `heavylift.solver.linearise.result.Linearisation`",
                ),
            ),
        ),
        Message("free", False, "Forgets a state.", (Field("state", "integer", "its handle"),), ()),
        Message(
            "close",
            True,
            "The last request of a connection; that of the master ends the run.",
            (Field("end", "flag", "false: the run waits for another master", needed=False),),
            (),
        ),
    )
}
"""All requests by their word."""

_HEAD = frozenset({"id", "do"})
_FIELDS = {do: {field.name: field for field in message.fields} for do, message in MESSAGES.items()}


def msgpack_library() -> ModuleType:
    """The library msgpack.

    Raises
    ------
    InputError
        If it is not installed.
    """
    try:
        import msgpack
    except ImportError:
        raise InputError(
            "msgpack is not installed",
            source="exchange of messages",
            expected="the extra 'serve': pip install 'heavylift[serve]'",
        ) from None
    library: ModuleType = msgpack
    return library


def framed(packed: bytes) -> bytes:
    r"""A packed map with its length in front.

    >>> framed(b"\x80")
    b'\x00\x00\x00\x01\x80'
    """
    return HEADER.pack(len(packed)) + packed


def unpacked(library: ModuleType, data: bytes | bytearray | memoryview) -> dict[str, Any]:
    """The map of a message, without its length.

    Raises
    ------
    FormatError
        If the bytes are not one map of msgpack with names as keys. Lengths in it are bounded by that of the message,
        and its depth by the library.
    """
    try:
        message = library.unpackb(data)
    except Exception as error:  # noqa: BLE001  of which kind depends on the version of the library
        words = str(error) or type(error).__name__
        raise FormatError(f"{len(data)} bytes that are not msgpack: {words}") from None
    if type(message) is not dict:
        raise FormatError(f"a {type(message).__name__}, not a map")
    return message


def check_request(request: Mapping[Any, Any]) -> Message:
    """The message that a request is.

    Raises
    ------
    FormatError
        If it has no number or no word.
    InputError
        If the word is unknown, a field is missing, unknown or of another type.
    """
    if type(request.get("id")) is not int:
        raise FormatError("a request without 'id', a whole number")
    do = request.get("do")
    if type(do) is not str:
        raise FormatError("a request without 'do', a word")
    fields = _FIELDS.get(do)
    if fields is None:
        raise InputError(f"{do!r}", source="request", key="do", expected=f"one of {', '.join(MESSAGES)}")
    for name, value in request.items():
        field = fields.get(name)
        if field is None:
            if name in _HEAD:
                continue
            known = ", ".join(fields) or "no field"
            raise InputError(f"unknown field {name!r}", source="request", key=do, expected=known)
        if not _CHECKS[field.type](value):
            raise InputError(f"{value!r}", source="request", key=f"{do}.{name}", expected=_expected(field))
    for field in fields.values():
        if field.needed and field.name not in request:
            raise InputError(
                "is missing", source="request", key=f"{do}.{field.name}", expected=_expected(field)
            )
    return MESSAGES[do]


def _expected(field: Field) -> str:
    return f"{TYPES[field.type]}: {field.sentence}"


def message_tables() -> str:
    """Tables of all messages and errors in Markdown, as the guide shows them."""
    lines = ["| request | who | fields | answer |", "|---|---|---|---|"]
    for message in MESSAGES.values():
        who = "anyone" if message.observers else "master"
        words = f"`{message.do}`: {message.sentence}"
        lines.append(f"| {words} | {who} | {_listed(message.fields)} | {_listed(message.answer)} |")
    lines += ["", "| error | what follows |", "|---|---|"]
    lines += [f"| `{kind}` | {sentence} |" for kind, sentence in ERROR_KINDS.items()]
    return "\n".join(lines) + "\n"


def _listed(fields: tuple[Field, ...]) -> str:
    """Fields in a cell of a table."""
    words = [f"`{field.name}`{'' if field.needed else ' (optional)'}, {_expected(field)}" for field in fields]
    return "<br>".join(words) or "-"
