"""Types of the package for editors and checkers: ``heavylift/__init__.pyi``, written from the sections of a case."""

from __future__ import annotations

import keyword
import textwrap
from typing import TYPE_CHECKING, Any

import heavylift
from heavylift.pipeline.case.schema import section_schema
from heavylift.pipeline.model.components import component_class, component_names
from heavylift.pipeline.model.words import words_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

__all__ = ["stub_text"]

_HEAD = '''"""Names of the package with their types, for editors and type checkers.

Written by `heavylift schema --python`; do not edit. The module itself imports each name when it is first used.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Literal, Required, TypedDict

from numpy.typing import NDArray
'''
_ALIASES = '''
Quantity = float | str
"""A number in SI, or a text with a unit: ``"95 mm"``."""
Numbers = Sequence[Quantity] | NDArray[Any]
"""Several of them."""
'''
WIDTH = 106


def stub_text() -> str:
    """The text of the stub."""
    tables = _Tables()
    classes = [line for name in component_names() for line in _component(name, tables)]
    known: Mapping[str, str] = vars(heavylift)["_HOMES"]
    homes: dict[str, list[str]] = {}
    for name, home in known.items():
        homes.setdefault(f"heavylift.{home}", []).append(f"{name} as {name}")
    imports = [f"from {home} import {', '.join(sorted(names))}" for home, names in sorted(homes.items())]
    names = sorted({*known, *component_names()})
    listed = textwrap.wrap(
        ", ".join(f'"{name}"' for name in names), WIDTH, initial_indent="    ", subsequent_indent="    "
    )
    parts = [
        _HEAD.rstrip(),
        *imports,
        "",
        "__all__ = [",
        *listed,
        "]",
        _ALIASES.rstrip(),
        *tables.lines,
        *classes,
    ]
    return "\n".join(parts) + "\n"


def _component(name: str, tables: _Tables) -> Iterator[str]:
    """Lines of a class of components."""
    component: Any = component_class(name)
    schema = section_schema(component.SECTION)
    definitions, needed = schema.get("$defs", {}), set(schema.get("required", ()))
    label, own = component.TABLE.label, words_of(component.SECTION)
    types = {
        key: tables.type_of(node, definitions)
        for key, node in schema.get("properties", {}).items()
        if key not in own and key != label
    }
    yield ""
    yield f"class {name}(Component):"
    yield from _docstring(component.__doc__, "    ")
    named = bool(label) or component.TABLE.form == "named"
    first = ["        name: str,", "        /,"] if named else []
    keys = [key for key in sorted(types, key=lambda key: key not in needed) if _is_name(key)]
    yield ""
    yield "    def __init__("
    yield "        self,"
    yield from first
    if keys:
        yield "        *,"
    yield from (f"        {key}: {types[key]}{'' if key in needed else ' = ...'}," for key in keys)
    if len(keys) < len(types):
        yield "        **keys: Any,"
    yield "    ) -> None: ..."
    yield from (f"    {key}: {types[key]}" for key in keys)


def _docstring(text: str, indent: str) -> Iterator[str]:
    """Lines of a docstring."""
    text = text.replace("\\", "\\\\").replace('"""', "'''")
    if len(text) <= WIDTH and "\n" not in text and not text.endswith('"'):
        yield f'{indent}"""{text}"""'
        return
    lines = text.split("\n") if "\n" in text else textwrap.wrap(text, WIDTH)
    yield f'{indent}"""{lines[0]}'
    yield from (f"{indent}{line}".rstrip() for line in lines[1:])
    yield f'{indent}"""'


def _is_name(key: str) -> bool:
    return key.isidentifier() and not keyword.iskeyword(key)


class _Tables:
    """Types of the tables within components, each once."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._names: dict[str, str] = {}  # by their text

    def type_of(self, node: Mapping[str, Any], definitions: Mapping[str, Any]) -> str:
        """Type of a value in a program."""
        parts = list(dict.fromkeys(self._types(node, definitions)))
        if "Any" in parts:
            return "Any"
        if "int" in parts and "float" in parts:
            parts.remove("int")
        if {"float", "str"} <= set(parts):
            parts = ["Quantity", *(part for part in parts if part not in {"float", "str"})]
        return " | ".join(sorted(parts, key=lambda part: part == "None"))

    def _types(self, node: Mapping[str, Any], definitions: Mapping[str, Any]) -> Iterator[str]:
        if "$ref" in node:
            name = node["$ref"].rpartition("/")[2]
            found = definitions[name]
            if "properties" in found:
                yield self._table(name, found, definitions)
                yield "Mapping[str, Any]"
            else:
                yield from self._types(found, definitions)
            return
        choices = [*node.get("anyOf", ()), *node.get("oneOf", ())]
        if choices:
            for choice in choices:
                yield from self._types(choice, definitions)
        elif "const" in node:
            yield f"Literal[{node['const']!r}]".replace("'", '"')
        elif "enum" in node:
            yield f"Literal[{', '.join(map(repr, node['enum']))}]".replace("'", '"')
        elif "prefixItems" in node or "items" in node:
            entries = [
                *node.get("prefixItems", ()),
                *([node["items"]] if isinstance(node.get("items"), dict) else []),
            ]
            inner = self.type_of({"anyOf": entries}, definitions)
            yield "Numbers" if inner == "Quantity" else f"Sequence[{inner}]"
            if inner in {"float", "int", "Numbers"}:
                yield "NDArray[Any]"
        elif node.get("type") == "object":
            below = [*node.get("patternProperties", {}).values(), node.get("additionalProperties")]
            inner = self.type_of(
                {"anyOf": [one for one in below if isinstance(one, dict)] or [{}]}, definitions
            )
            yield f"Mapping[str, {inner}]"
        else:
            words = {"string": "str", "boolean": "bool", "integer": "int", "number": "float", "null": "None"}
            yield words.get(str(node.get("type")), "Any")

    def _table(self, name: str, schema: Mapping[str, Any], definitions: Mapping[str, Any]) -> str:
        """Name of the type of a table, which is written if it is new."""
        title = f"{name.rpartition('__')[2].removesuffix('Section')}Table"
        needed = set(schema.get("required", ()))
        types = {}
        for key, node in schema["properties"].items():
            inner = self.type_of(node, definitions)
            types[key] = f"Required[{inner}]" if key in needed else inner
        if all(map(_is_name, types)):
            body = [f"    {key}: {inner}" for key, inner in types.items()]
            sentence = " ".join(str(schema.get("description", "")).split())
            lines = ["(TypedDict, total=False):", *_docstring(sentence or "A table.", "    "), *body]
            begin = "class {}"
        else:
            pairs = ", ".join(f'"{key}": {inner}' for key, inner in types.items())
            lines, begin = [f'", {{{pairs}}}, total=False)'], '{0} = TypedDict("{0}'
        text = "\n".join([begin, *lines])
        if text not in self._names:
            taken = set(self._names.values())
            own = next(one for one in (title, *(f"{title}{i}" for i in range(2, 99))) if one not in taken)
            self._names[text] = own
            self.lines += ["", begin.format(own) + lines[0], *lines[1:]]
        return self._names[text]
