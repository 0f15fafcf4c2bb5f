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

__all__ = ["apply_overrides", "override_text"]


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
        ``key=value`` with a dotted key (list elements by index from 0) and a TOML value; a value that is
        no TOML is taken as text, so that a shell may swallow its quotes. ``key=`` without a value removes the key.
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
        _assign(document, key.strip().split("."), given, root, text)
        changed[key.strip()] = text
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


def _assign(document: dict[str, Any], keys: list[str], value: Any, root: type[BaseModel], text: str) -> None:
    """Set or remove one key, adding optional tables on the way."""
    node: Any = document
    sections = [root]
    for depth, key in enumerate(keys):
        last = depth == len(keys) - 1
        path = ".".join(keys[: depth + 1])
        if isinstance(node, list):
            if not key.isdecimal() or len(key) > 9 or int(key) >= len(node):
                raise InputError(
                    f"{path} does not exist",
                    source=f"--set {text}",
                    expected=f"an index from 0 to {len(node) - 1}",
                )
            if last and value is REMOVED:
                del node[int(key)]
            elif last:
                node[int(key)] = value
            else:
                node = node[int(key)]
            continue
        if not isinstance(node, dict):
            raise InputError(
                f"{path} does not exist",
                source=f"--set {text}",
                expected=f"{'.'.join(keys[:depth])} is a value",
            )
        if keys[0] == "repeat" and depth == 2:  # the tables of a block have the keys of those they stand for
            sections = [*sections, root]
        below = sections_below(sections, key)
        if key not in node and key not in known_keys(sections):
            near = nearest(key, [*node, *sorted(known_keys(sections))])
            hint = f"; did you mean {near!r}?" if near else ""
            raise InputError(
                f"{path} does not exist{hint}", source=f"--set {text}", expected="a key of the case"
            )
        sections = below or sections
        if value is REMOVED and (last or key not in node):
            node.pop(key, None)
            return
        if last:
            node[key] = value
        else:
            node = node.setdefault(key, {})
