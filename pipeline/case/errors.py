"""Validation errors of a case file as lines that name file, key, value and what was expected."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, Literal, get_args, get_origin

from pydantic import BaseModel

from heavylift.numerics.outcome import InputError
from heavylift.numerics.words import nearest
from heavylift.pipeline.case.described import Chosen, Later
from heavylift.pipeline.case.fields import TAG

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from pydantic import ValidationError

__all__ = [
    "chosen_in",
    "group_errors",
    "input_errors",
    "is_chosen",
    "known_keys",
    "sections_below",
    "sections_in",
]

_MISSING = object()


def input_errors(
    error: ValidationError,
    document: dict[str, Any],
    root: type[BaseModel],
    file: Path | str,
    *,
    without: Collection[str] = (),
) -> list[InputError]:
    """Turn what pydantic found into one `InputError` a problem.

    Parameters
    ----------
    error
        All problems of one document.
    document
        The document that was validated.
    root
        Its model.
    file
        Its file, for the messages.
    without
        Types of pydantic errors that are left out.
    """
    found = []
    for item in _causes(
        [one for one in error.errors(include_url=False) if one["type"] not in without], document
    ):
        keys, value = _place(document, item)
        context = item.get("ctx", {})
        below = context.get("key", "") or getattr(context.get("error"), "key", "")
        path = ".".join([*(str(key) for key in keys), *filter(None, [below])])
        table = keys if item["type"] == "union_tag_not_found" else keys[:-1]
        problem, expected = _words(item, value, _candidates(root, document, table))
        found.append(InputError(problem, source=file, key=path or "case", expected=expected))
    return found


def _causes(items: Sequence[Any], document: dict[str, Any]) -> list[Any]:
    """The items without those that only follow from another one, so that one mistake is one line."""
    places = [tuple(item["loc"]) for item in items]
    above = {place[:length] for place in places for length in range(len(place))}
    last_repeated: dict[str, int] = {}
    last_missing: dict[tuple[Any, ...], int] = {}
    unknown: dict[tuple[Any, ...], list[str]] = {}
    for index, (item, place) in enumerate(zip(items, places, strict=True)):
        if item["type"] == "repeated":
            last_repeated[item["ctx"]["problem"]] = index
        elif item["type"] == "missing":
            last_missing[place[:-1]] = index
        elif item["type"] == "extra_forbidden":
            unknown.setdefault(place[:-1], []).append(str(place[-1]))
    kept = []
    for index, (item, place) in enumerate(zip(items, places, strict=True)):
        kind = item["type"]
        if kind == "too_short" and place in above:
            continue  # an entry that is wrong was not counted
        if kind == "repeated" and last_repeated[item["ctx"]["problem"]] != index:
            continue  # the last occurrence is reported
        if kind == "missing" and isinstance(_place(document, item)[1], list):
            if last_missing[place[:-1]] != index:
                continue  # the last missing entry says how many are needed
        elif kind == "missing" and get_close_matches(str(place[-1]), unknown.get(place[:-1], ()), 1):
            continue  # it is there, misspelt
        kept.append(item)
    return kept


def _place(document: Any, item: Mapping[str, Any]) -> tuple[list[str | int], Any]:
    """Keys of a problem without the names of union members that pydantic puts between them, and the value."""
    found = _walk(document, item)
    if item["type"] == "missing" and isinstance(item["loc"][-1], str) and found[1] is not _MISSING:
        for depth in reversed(
            range(len(item["loc"]) - 1)
        ):  # a union member may have the name of a key that is there
            other = _walk(document, item, depth)
            if other[1] is _MISSING:
                return other
    return found


def _walk(document: Any, item: Mapping[str, Any], member: int = -1) -> tuple[list[str | int], Any]:
    """The same, if the part of the place at a depth is the name of a union member."""
    loc, node = item["loc"], document
    keys: list[str | int] = []
    for depth, part in enumerate(loc):
        if depth == member:
            continue
        if _has(node, part):
            node = node[part]
        elif item["type"] == "missing" and isinstance(node, dict) and depth == len(loc) - 1:
            node = _MISSING  # a required key that is not there
        elif part == "[key]":
            node = keys[-1]  # a wrong key of a table, not its value
            continue
        else:
            continue
        keys.append(part)
    return keys, node


def _has(node: Any, key: str | int) -> bool:
    """Whether a table has a key, or a list an index."""
    if isinstance(node, list):
        return isinstance(key, int) and key < len(node)
    return isinstance(node, dict) and key in node


def _words(item: Mapping[str, Any], value: Any, candidates: Iterable[type[BaseModel]]) -> tuple[str, str]:
    """Say what is wrong and what was expected; `candidates` are sections that the table of the value may be."""
    kind, context = item["type"], item.get("ctx", {})
    if kind in {"case", "repeated"}:
        return context["problem"], context["expected"]
    if isinstance(context.get("error"), InputError):
        return context["error"].problem, context["error"].expected
    if kind == "missing" and isinstance(value, list) and isinstance(item["loc"][-1], int):
        return f"{value!r} has {len(value)} entries", f"at least {int(item['loc'][-1]) + 1}"
    if kind == "missing":
        return "is missing", "a value"
    if kind in {"model_type", "model_attributes_type", "dict_type"}:
        return f"{value!r} is not a table", "a table"
    if kind in {"tuple_type", "list_type"}:
        return f"{value!r} is not a list", "a list"
    if kind == "extra_forbidden":
        keys = known_keys(candidates)
        near = nearest(str(item["loc"][-1]), sorted(keys))
        hint = f"; did you mean {near!r}?" if near else ""
        return f"unknown key{hint}", f"one of: {', '.join(sorted(keys))}" if keys else "no such key"
    if kind == "union_tag_invalid":
        if context["tag"].startswith(TAG):  # a choice by `type_tag`
            if not isinstance(value, dict):
                return f"{value!r} is not a table", "a table"
            expected = context["expected_tags"].replace(f"'{TAG}", "'")
            return f"type = {context['tag'].removeprefix(TAG)!r}", f"one of {expected}"
        discriminator = context["discriminator"].strip("'")
        return f"{discriminator} = {context['tag']!r}", f"one of {context['expected_tags']}"
    if kind == "union_tag_not_found":
        if not isinstance(value, dict):
            return f"{value!r} is not a table", "a table"
        return f"key {context['discriminator']} is missing", f"one of {_choices(context, candidates)}"
    if kind == "literal_error":
        return f"{value!r}", context["expected"]
    if kind == "string_pattern_mismatch":
        words = "letters, digits, '_' and '-', beginning with a letter"
        return f"{value!r}", words if "[A-Za-z]" in context["pattern"] else f"text like {context['pattern']}"
    if kind == "greater_than_equal":
        return f"{value!r} is too small", f"a number >= {context['ge']}"
    if kind in {"int_type", "int_parsing", "int_from_float"}:
        return f"{value!r} is not an integer", "an integer"
    if kind in {"float_type", "float_parsing"}:
        return f"{value!r} is not a number", "a number"
    if kind in {"bool_type", "bool_parsing"}:
        return f"{value!r} is neither true nor false", "true or false"
    if kind == "string_type":
        return f"{value!r} is not a string", "a string"
    if kind in {"too_short", "too_long"} and isinstance(value, (list, dict)):
        limit = (
            f"at least {context['min_length']}" if kind == "too_short" else f"at most {context['max_length']}"
        )
        return f"has {len(value)} entries", limit
    shown = "" if value is _MISSING or isinstance(value, (dict, list)) else f"{value!r}"
    message = item["msg"].removesuffix(".")
    if message.startswith("Input should be "):
        return shown or "has a wrong value", message.removeprefix("Input should be ")
    if kind == "string_too_short":
        return shown, f"at least {context['min_length']} characters"
    if kind == "string_too_long":
        return shown, f"at most {context['max_length']} characters"
    return f"{shown}: {message[0].lower()}{message[1:]}" if shown else message, "another value"


def _choices(context: Mapping[str, Any], sections: Iterable[type[BaseModel]]) -> str:
    """Words by which the key that chooses between sections chooses them."""
    fields = (section.model_fields.get(context["discriminator"].strip("'")) for section in sections)
    return ", ".join(
        repr(word) for field in fields if field is not None for word in get_args(field.annotation)
    )


def known_keys(sections: Iterable[type[BaseModel]]) -> set[str]:
    """Keys that some sections accept, as they are written in the file."""
    return {field.alias or name for section in sections for name, field in section.model_fields.items()}


def _candidates(root: type[BaseModel], document: Any, keys: Sequence[str | int]) -> list[type[BaseModel]]:
    """Sections that the table at a key path may be."""
    sections, node = [root], document
    for key in keys:
        node = node[key] if _has(node, key) else _MISSING
        sections = sections_below(sections, key) or sections
        chosen = [section for section in sections if is_chosen(section, node)]
        sections = chosen or sections
    return sections


def sections_below(sections: Iterable[type[BaseModel]], key: str | int) -> list[type[BaseModel]]:
    """Sections found in the field `key` of some sections, each once; empty if none has such a field."""
    found: dict[type[BaseModel], None] = {}
    for section in sections:
        for name, field in section.model_fields.items():
            if key in {name, field.alias}:
                found |= dict.fromkeys(sections_in(field.annotation))
                for mark in field.metadata:  # of an annotation that is not within another one
                    found |= dict.fromkeys(sections_in(mark))
    return list(found)


def sections_in(annotation: Any) -> Iterable[type[BaseModel]]:
    """All section types inside a type annotation."""
    if isinstance(annotation, Chosen):
        yield from annotation.sections
    if isinstance(annotation, Later):
        yield from sections_in(annotation.sections)
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in get_args(annotation):
        yield from sections_in(argument)


def chosen_in(annotation: Any) -> Chosen | None:
    """What chooses the descriptions of the tables that a type annotation is of; None if sections stand in it."""
    if isinstance(annotation, Chosen):
        return annotation
    return next(filter(None, map(chosen_in, get_args(annotation))), None)


def is_chosen(section: type[BaseModel], node: Any) -> bool:
    """Whether a table's ``type``, ``motion`` or ``law`` says that it is this section."""
    for name in ("type", "motion", "law"):
        field = section.model_fields.get(name)
        if field is not None and get_origin(field.annotation) is Literal and isinstance(node, dict):
            return node.get(name, field.default) in get_args(field.annotation)
    return False


def group_errors(document: dict[str, Any], file: Path) -> list[InputError]:
    """Groups that reductions, supports and loads name but geometries do not have.

    Works on the plain document, so that these errors are found besides all others. Groups of mesh
    files and decks are known only once the file is read; the modes stage checks those.
    """
    found = []
    bodies = document.get("bodies")
    for name, body in bodies.items() if isinstance(bodies, dict) else ():
        geometry, modes = (body.get(key) if isinstance(body, dict) else None for key in ("geometry", "modes"))
        if not isinstance(geometry, dict) or not isinstance(modes, dict):
            continue
        if geometry.get("type") in ("mesh", "matrices"):  # perhaps no text
            continue
        tables = [geometry.get(key, {}) for key in ("groups", "plates", "stiffeners", "lugs")]
        groups = [group for table in tables if isinstance(table, dict) for group in table]
        for key, group in _named_groups(body):
            if group not in groups:
                near = get_close_matches(group, groups, 1)
                hint = f"; did you mean {near[0]!r}?" if near else ""
                found.append(
                    InputError(
                        f"group {group!r} does not exist{hint}",
                        source=file,
                        key=f"bodies.{name}.{key}",
                        expected=f"a group of the geometry: {', '.join(groups) or 'none'}",
                    )
                )
    return found


def _named_groups(body: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Keys of a flexible body that name a group, and the groups."""
    lists = [(f"modes.{key}", body["modes"].get(key)) for key in ("clamp", "interface", "static_groups")]
    interfaces = body.get("interfaces")
    for name, interface in interfaces.items() if isinstance(interfaces, dict) else ():
        group = interface.get("group") if isinstance(interface, dict) else None
        if isinstance(group, str):
            yield f"interfaces.{name}.group", group
    rows = [("supports", body.get("supports"))]
    cases = body.get("static")
    for index, row in enumerate(cases if isinstance(cases, list) else ()):
        rows.append((f"static.{index}.loads", row.get("loads") if isinstance(row, dict) else None))
    for key, entries in rows:
        for index, row in enumerate(entries if isinstance(entries, list) else ()):
            on = row.get("on") if isinstance(row, dict) else None
            if isinstance(on, str):
                yield f"{key}.{index}.on", on
            lists.append((f"{key}.{index}.on", on))
    for key, names in lists:
        for index, group in enumerate(names if isinstance(names, list) else ()):
            if isinstance(group, str):
                yield f"{key}.{index}", group
