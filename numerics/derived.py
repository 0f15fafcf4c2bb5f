"""What follows from data alone is computed once: results kept under the digest of all that they depend on.

A function without side effects whose result depends on its arguments alone (seams of a surface, its tree, points of
stress of a model) is called by `derived`. Without a store that is the call itself. Within `keeping` a store is asked
first, under a name that holds the arguments, the sources of the function with all that they import, and the versions
of what they use: nothing is ever old, and nobody has to say what has changed. Whoever has no file of the result, or a
damaged one, computes it. Results are arrays and numbers, read back bit for bit.
"""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import json
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np

from heavylift.numerics.sources import closure_digest, edited_since_start

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

__all__ = ["Store", "derived", "keeping"]

T = TypeVar("T", bound="tuple[Any, ...]")

MAGIC = b"heavylift derived 1\n"
DIGEST_SIZE = 16
ALIGNED = 64
"""Bytes to whose multiples arrays begin in a file."""


class Store(Protocol):
    """Where results are kept."""

    @property
    def versions(self) -> str:
        """What results depend on besides sources and arguments, as words: versions of other packages, the processor."""

    def read(self, name: str) -> bytes | None:
        """What is kept under a name, None if nothing is."""

    def write(self, name: str, data: bytes) -> None:
        """Keep something under a name, if that is possible."""

    def refuse(self, name: str) -> None:
        """What is kept under a name is damaged."""


_STORE: ContextVar[Store | None] = ContextVar("store", default=None)


@contextlib.contextmanager
def keeping(store: Store | None) -> Iterator[None]:
    """Take results of `derived` from a store, and keep them there; None: compute all."""
    token = _STORE.set(store)
    try:
        yield
    finally:
        _STORE.reset(token)


def derived(result: type[T], make: Callable[..., T], *inputs: Any, rows: Sequence[type] = ()) -> T:
    """Result of a function, from the store of this run or computed.

    Parameters
    ----------
    result
        Class of the result, a named tuple of arrays and numbers.
    make
        What it returns depends on its arguments and on the sources of its module with all that this imports at its top
        alone; of what it sees otherwise a digest is among the arguments.
    inputs
        Its arguments: arrays, numbers, texts, None, and tuples and dataclasses of these.
    rows
        Classes of the records in the result.

    Raises
    ------
    TypeError
        With a store: something in the arguments or in the result that is no array, number or text.
    """
    store = _STORE.get()
    if store is None:
        return make(*inputs)
    module = make.__module__
    digest = hashlib.blake2b(digest_size=DIGEST_SIZE)
    digest.update(f"{store.versions} {closure_digest((module,))} {module} {make.__qualname__}".encode())
    _take_in(digest, inputs)
    name = f"{make.__name__.strip('_')}-{digest.hexdigest()}"
    kept = store.read(name)
    if kept is not None:
        found = _decoded(kept, result._fields, {one.__name__: one for one in rows})  # type: ignore[attr-defined]
        if found is not None:
            return result(**found)
        store.refuse(name)
    made = make(*inputs)
    unknown = {one.dtype.type for one in made if isinstance(one, np.ndarray) and one.dtype.names} - {*rows}
    if unknown:
        raise TypeError(
            f"records of {unknown.pop().__name__} in a result that is kept, but not among its rows"
        )
    if not edited_since_start((module,)):  # else what made it is not what is on the disk
        store.write(name, _encoded(made._asdict()))  # type: ignore[attr-defined]
    return made


def _take_in(digest: Any, value: Any) -> None:
    """Add a value with its type and shape to a digest."""
    if isinstance(value, np.ndarray):
        if value.dtype.hasobject:
            raise TypeError("an array of objects among the arguments of what is kept")
        digest.update(f"array {value.dtype.descr} {value.shape} ".encode())
        digest.update(np.ascontiguousarray(value).view(np.uint8).data if value.size else b"")
    elif isinstance(value, (tuple, list)):
        digest.update(f"tuple {len(value)} ".encode())
        for one in value:
            _take_in(digest, one)
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        digest.update(f"{type(value).__name__} ".encode())
        _take_in(digest, [getattr(value, field.name) for field in dataclasses.fields(value)])
    elif value is None or isinstance(value, (bool, int, float, str, np.number, np.bool_)):
        plain = value.item() if isinstance(value, np.generic) else value
        digest.update(f"{type(plain).__name__} {plain!r} ".encode())
    else:
        raise TypeError(f"{type(value).__name__} among the arguments of what is kept")


def _encoded(values: dict[str, Any]) -> bytes:
    """A file: a digest of what follows, a table of contents in JSON, the bytes of the arrays."""
    table, parts, place = {}, [], 0
    for name, value in values.items():
        if not isinstance(value, np.ndarray):
            if value is not None and not isinstance(value, (bool, int, float, str)):
                raise TypeError(f"{type(value).__name__} in a result that is kept")
            table[name] = {"value": value.hex() if isinstance(value, float) else value}
            table[name]["type"] = type(value).__name__
            continue
        row = value.dtype.names is not None
        if value.dtype.hasobject:
            raise TypeError("an array of objects in a result that is kept")
        data = np.ascontiguousarray(value).tobytes()
        table[name] = {
            "type": value.dtype.type.__name__ if row else value.dtype.str,
            "shape": value.shape,
            "place": place,
            "size": len(data),
        }
        gap = -len(data) % ALIGNED
        parts += [data, bytes(gap)]
        place += len(data) + gap
    head = json.dumps(table).encode()
    body = b"".join([len(head).to_bytes(8, "little"), head, *parts])
    return MAGIC + _digest(body) + body


def _digest(data: bytes | memoryview) -> bytes:
    return hashlib.blake2b(data, digest_size=DIGEST_SIZE).digest()


def _decoded(data: bytes, names: tuple[str, ...], rows: dict[str, type]) -> dict[str, Any] | None:
    """Arrays and numbers of a file, by name; None if it is not whole."""
    start = len(MAGIC) + DIGEST_SIZE
    body = memoryview(data)[start:]
    if not data.startswith(MAGIC) or data[len(MAGIC) : start] != _digest(body):
        return None
    first = 8 + int.from_bytes(body[:8], "little")
    table = json.loads(bytes(body[8:first]))
    if tuple(table) != names:
        return None
    return {name: _value(entry, body[first:], rows) for name, entry in table.items()}


def _value(entry: dict[str, Any], data: memoryview, rows: dict[str, type]) -> Any:
    """A number, or an array of its own memory."""
    if "place" not in entry:
        value = entry["value"]
        return float.fromhex(value) if entry["type"] == "float" else value
    content: NDArray[np.uint8] = np.frombuffer(data, np.uint8, entry["size"], entry["place"])
    if entry["type"] in rows:
        from heavylift.numerics.records import records

        made: Any = records(rows[entry["type"]], int(np.prod(entry["shape"])))
        made.view(np.uint8)[...] = content
        return made.reshape(entry["shape"])
    return content.copy().view(np.dtype(entry["type"])).reshape(entry["shape"])
