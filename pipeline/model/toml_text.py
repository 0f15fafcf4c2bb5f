"""Case files written for people: tables in the order of a case, short ones on a line, comments of the file kept."""

from __future__ import annotations

import json
import tomllib
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.model.components import TABLES_OF_CASE

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

__all__ = ["case_text", "changed_text"]

_FIRST = ("title", "sources", "parameters", "gravity", "sea")
"""Of a case, what people write first; the rest is in the order of its tables."""
WIDTH = 110
"""Characters of a line, beyond which a list has a line for each entry and a table a heading of its own."""


def case_text(document: Mapping[str, Any]) -> str:
    """Text of a case file.

    Parameters
    ----------
    document
        As it would be read from TOML; its tables are written in the order of a case, their keys as they stand.

    Raises
    ------
    InputError
        If the library that writes TOML is not installed.
    """
    return "\n".join(_document(document)) + "\n"


def _document(document: Mapping[str, Any]) -> Iterator[str]:
    known = (*_FIRST, *TABLES_OF_CASE)
    ordered = {key: document[key] for key in dict.fromkeys((*known, *document)) if key in document}
    lines = list(_table("", ordered))
    yield from lines[1:] if lines and not lines[0] else lines


def _table(path: str, table: Mapping[str, Any]) -> Iterator[str]:
    """Keys of a table on lines, then what has headings of its own."""
    below: dict[str, Any] = {}
    for key, value in table.items():
        if _has_heading(path, key, value):
            below[key] = value
        else:
            yield from _lines(key, value)
    for key, value in below.items():
        inner = f"{path}.{_key(key)}" if path else _key(key)
        if isinstance(value, list):
            for entry in value:
                yield from ("", f"[[{inner}]]")
                yield from _table(inner, entry)
        elif _is_named(path, key, value):
            for name, entry in value.items():
                yield from ("", f"[{inner}.{_key(name)}]")
                yield from _table(f"{inner}.{_key(name)}", entry)
        else:
            yield from ("", f"[{inner}]")
            yield from _table(inner, value)


def _is_named(path: str, key: str, value: dict[str, Any]) -> bool:
    """Whether it is tables by name, each with a heading: ``[bodies.NAME]``."""
    named = path in {"", "repeat"} and key in TABLES_OF_CASE and TABLES_OF_CASE[key].form == "named"
    return named and all(isinstance(entry, dict) for entry in value.values())


def _has_heading(path: str, key: str, value: Any) -> bool:
    """Whether a value is a table, or a list of tables, with headings."""
    tables = [value] if isinstance(value, dict) else value if isinstance(value, list) else []
    if not tables or not all(isinstance(entry, dict) for entry in tables):
        return False
    if path in {"", "repeat"} and (key in TABLES_OF_CASE or key == "parameters"):
        return True
    if isinstance(value, dict):
        return len(f"{_key(key)} = {_inline(value)}") > WIDTH
    return any(len(_inline(entry)) > WIDTH - 5 for entry in tables)


def _lines(key: str, value: Any) -> Iterator[str]:
    """A key and its value: on a line, or a line for each entry of a long list."""
    line = f"{_key(key)} = {_inline(value)}"
    if len(line) <= WIDTH or not isinstance(value, list) or not _is_long(value):
        yield line
        return
    yield f"{_key(key)} = ["
    yield from (f"    {_inline(entry)}," for entry in value)
    yield "]"


def _is_long(value: list[Any]) -> bool:
    """Whether entries of a list fill lines of their own."""
    return any(isinstance(entry, (dict, list)) for entry in value) or len(_inline(value)) > WIDTH


def _inline(value: Any) -> str:
    """A value on one line."""
    if isinstance(value, dict):
        pairs = ", ".join(f"{_key(key)} = {_inline(entry)}" for key, entry in value.items())
        return f"{{ {pairs} }}" if pairs else "{}"
    if isinstance(value, list):
        return f"[{', '.join(map(_inline, value))}]"
    text: str = _library().item(value).as_string()
    return text


def _key(key: str) -> str:
    text: str = _library().key([key]).as_string()
    return text


def _library() -> Any:
    try:
        import tomlkit
    except ImportError:
        raise InputError(
            "the package tomlkit is not installed",
            key="save",
            expected="tomlkit, which writes TOML: `pip install tomlkit`",
        ) from None
    return tomlkit


def changed_text(text: str, document: Mapping[str, Any]) -> str:
    """Text of a case file with another content, and the comments and the layout that it had as far as they still fit.

    Parameters
    ----------
    text
        Of the case file.
    document
        What it shall contain.
    """
    before = tomllib.loads(text)
    if _same(before, document):
        return text
    library = _library()
    parsed = library.parse(text)
    try:
        _change(parsed, before, document, "")
        changed: str = library.dumps(parsed)
        if _same(tomllib.loads(changed), document):
            return changed
    except (ValueError, TypeError, KeyError, IndexError, AttributeError):
        pass  # what the library cannot do in place is written anew
    return case_text(document)


def _same(one: Any, other: Any) -> bool:
    """Whether two values are written alike; 1, 1.0 and true are equal in Python, and not in a file."""
    return json.dumps(one, sort_keys=True, default=repr) == json.dumps(other, sort_keys=True, default=repr)


def _change(node: Any, before: Mapping[str, Any], after: Mapping[str, Any], path: str) -> None:
    """Make a parsed table what it shall be, one key after the other."""
    for key in [key for key in before if key not in after]:
        del node[key]
    for key, value in after.items():
        inner = f"{path}.{key}" if path else key
        old = before.get(key)
        if key in before and _same(old, value):
            continue
        if isinstance(old, dict) and isinstance(value, dict):
            _change(node[key], old, value, inner)
        elif _named_tables(old) and _named_tables(value):
            _change_list(node[key], old or [], value, inner)
        elif key not in before and _has_heading(path, key, value):
            node[key] = _parsed(path, {key: value})
        else:
            node[key] = _library().parse(f"x = {_inline(value)}")["x"]


def _change_list(node: Any, before: list[Any], after: list[Any], path: str) -> None:
    """The same of a list of tables with names: those that stay are changed, others go or come at its end."""
    wanted = {_label(entry): entry for entry in after}
    for index in reversed(range(len(before))):
        if _label(before[index]) not in wanted:
            del node[index]
    kept = [entry for entry in before if _label(entry) in wanted]
    for index, entry in enumerate(kept):
        _change(node[index], entry, wanted.pop(_label(entry)), path)
    for entry in wanted.values():
        made = _parsed(path.rpartition(".")[0], {path.rpartition(".")[2]: [entry]})
        node.append(made[0])


def _parsed(path: str, table: Mapping[str, Any]) -> Any:
    """A new table, or list of tables, as the library has those that it has read."""
    (key,) = table
    node = _library().parse("\n".join(_table(path, table)) + "\n")
    for part in (*filter(None, path.split(".")), key):
        node = node[part]
    return node


def _named_tables(value: Any) -> bool:
    """Whether it is a list of tables with names, each once."""
    if not isinstance(value, list) or not all(isinstance(entry, dict) for entry in value):
        return False
    labels = [_label(entry) for entry in value]
    return all(isinstance(label, str) for label in labels) and len({*labels}) == len(labels)


def _label(entry: Mapping[str, Any]) -> Any:
    return entry.get("name", entry.get("id"))
