"""Overrides of single keys of a case: ``--set simulate.step="0.1 us"``."""

from __future__ import annotations

import copy
import tomllib
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import InputError
from heavylift.numerics.words import nearest
from heavylift.pipeline.case.errors import known_keys, sections_below

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pydantic import BaseModel

__all__ = ["REMOVED", "apply_overrides", "assign", "entry_index", "override_text"]


REMOVED = object()
"""In place of a value: the key is to be removed."""


def apply_overrides(
    document: dict[str, Any], overrides: Sequence[str], root: type[BaseModel]
) -> tuple[dict[str, Any], dict[str, str]]:
    """Copy of a document with some keys set.

    Parameters
    ----------
    document
        As read from TOML.
    overrides
        ``key=value`` with a dotted key (list elements by index from 0, or by their name) and a TOML value; a value
        that is no TOML is taken as text, so that a shell may swallow its quotes. ``key=`` without a value removes the
        key.
    root
        Model of the document, which knows the keys that may be added.

    Returns
    -------
    tuple
        The new document, and the text of the override by the key it set.

    Raises
    ------
    InputError
        If an override has no ``=`` or its key leads nowhere.
    """
    document, changed = copy.deepcopy(document), {}
    for text in overrides:
        key, sign, value = text.partition("=")
        if not sign or not key.strip():
            raise InputError(f"{text!r}", source="--set", expected='key=value, e.g. simulate.step="0.1 us"')
        given = _value(value.strip()) if value.strip() else REMOVED
        changed[assign(document, key.strip().split("."), given, root, f"--set {text}")] = text
    return document, changed


def override_text(key: str, value: Any) -> str:
    """The override that sets a key to a value of a TOML document, or removes it if the value is the empty text."""
    return f"{key}={value}" if isinstance(value, str) else f"{key}={_toml(value)}"


def _toml(value: Any) -> str:
    """A value as it is written in a TOML file, on one line."""
    import json

    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {_toml(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(entry) for entry in value) + "]"
    return repr(value) if isinstance(value, float) else json.dumps(value)


def _value(text: str) -> Any:
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError):  # no TOML
        return text


def entry_index(entries: list[Any], key: str) -> int | None:
    """Index of an entry of a list by a part of a dotted key: its index from 0, or its name; None if there is none."""
    if key.isdecimal():
        return int(key) if len(key) <= 9 and int(key) < len(entries) else None
    return next((index for index, entry in enumerate(entries) if key and _name(entry) == key), None)


def _name(entry: Any) -> Any:
    """Name of an entry of a list, if it has one."""
    return entry.get("name", entry.get("id")) if isinstance(entry, dict) else None


def assign(
    document: dict[str, Any], keys: Sequence[str], value: Any, root: type[BaseModel], source: str
) -> str:
    """Set or remove one key of a document in place, adding optional tables on the way.

    Parameters
    ----------
    document
        As read from TOML.
    keys
        Parts of the dotted key; of an element of a list its index from 0, or its name.
    value
        In its place; `REMOVED` takes it away.
    root
        Model of the document, which knows the keys that may be added.
    source
        Who wants it so, for the messages.

    Returns
    -------
    str
        The dotted key with indices in place of names.

    Raises
    ------
    InputError
        If the key leads nowhere.
    """
    node: Any = document
    sections = [root]
    places: list[str] = []
    for depth, key in enumerate(keys):
        last = depth == len(keys) - 1
        path = ".".join(keys[: depth + 1])
        if isinstance(node, list):
            index = entry_index(node, key)
            if index is None:
                names = [name for name in map(_name, node) if isinstance(name, str)]
                near = nearest(key, names)
                hint = f"; did you mean {near!r}?" if near else ""
                named = f", or one of: {', '.join(names)}" if names else ""
                raise InputError(
                    f"{path} does not exist{hint}",
                    source=source,
                    expected=f"an index from 0 to {len(node) - 1}{named}" if node else "a list with entries",
                )
            places.append(str(index))
            if last and value is REMOVED:
                del node[index]
            elif last:
                node[index] = value
            else:
                node = node[index]
            continue
        if not isinstance(node, dict):
            raise InputError(
                f"{path} does not exist", source=source, expected=f"{'.'.join(keys[:depth])} is a value"
            )
        places.append(key)
        if keys[0] == "repeat" and depth == 2:  # the tables of a block have the keys of those they stand for
            sections = [*sections, root]
        below = sections_below(sections, key)
        if key not in node and key not in known_keys(sections):
            near = nearest(key, [*node, *sorted(known_keys(sections))])
            hint = f"; did you mean {near!r}?" if near else ""
            raise InputError(f"{path} does not exist{hint}", source=source, expected="a key of the case")
        sections = below or sections
        if value is REMOVED and (last or key not in node):
            node.pop(key, None)
            break
        if last:
            node[key] = value
        else:
            node = node.setdefault(key, {})
    return ".".join(places)
