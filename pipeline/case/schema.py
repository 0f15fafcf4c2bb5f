"""Schema of case files: as JSON Schema for editors, and as tables of all keys, a page a table in docs/case_keys."""

from __future__ import annotations

import ast
import importlib.util
import inspect
import json
import re
import sys
import textwrap
from difflib import get_close_matches
from functools import cache, partial
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic.json_schema import GenerateJsonSchema

from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import quantity_schema
from heavylift.numerics.units import KINDS
from heavylift.pipeline.case.case_file import Case
from heavylift.pipeline.case.channel_kinds import OF_THE_SCENE
from heavylift.pipeline.case.described import Later
from heavylift.pipeline.case.fields import NoDefault
from heavylift.solver.scene.collisions import Collision
from heavylift.solver.scene.descriptions import described_fields

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from pydantic.json_schema import JsonSchemaValue
    from pydantic_core import core_schema

    from heavylift.pipeline.case.fields import Section
    from heavylift.solver.scene.descriptions import ChannelKind

__all__ = [
    "KeyWords",
    "case_schema",
    "channel_schema",
    "key_pages",
    "key_tables",
    "section_keys",
    "section_schema",
    "section_tables",
]


def case_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of ``case.toml``; quantities are numbers in SI or strings with a unit."""
    schema = Case.model_json_schema(mode="validation", schema_generator=_Described)
    # bodies may all come from blocks
    schema["required"] = [key for key in schema["required"] if key != "bodies"]
    schema["anyOf"] = [{"required": ["bodies"]}, {"required": ["repeat"]}]
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "heavylift case",
        **{key: value for key, value in schema.items() if key != "title"},
    }


def section_schema(section: type[Section]) -> dict[str, Any]:
    """JSON Schema of a section alone, as that of a case has it; sections below it are its ``$defs``."""
    return section.model_json_schema(mode="validation", schema_generator=_Described)


class KeyWords(NamedTuple):
    """A key of a section in words: what it may be, its default if it has one, its sentence."""

    key: str
    value: str
    default: str
    sentence: str
    needed: bool


def section_keys(section: type[Section]) -> tuple[str, list[KeyWords], list[dict[str, Any]]]:
    """Sentence, keys and channels of a section."""
    schema = section_schema(section)
    titles = {name: name.rpartition("__")[2].removesuffix("Section") for name in schema.get("$defs", {})}
    needed = set(schema.get("required", ()))
    keys = [
        KeyWords(
            key,
            _plain(_words(node, titles)),
            "" if key in needed else _plain(_default(node)),
            _plain(_sentence(node.get("description", ""))),
            key in needed,
        )
        for key, node in schema.get("properties", {}).items()
    ]
    return _plain(_sentence(schema.get("description", ""))), keys, schema.get("channels", [])


def channel_schema(owner: str, channels: Sequence[ChannelKind]) -> list[dict[str, Any]]:
    """Channels of an owner: name, unit, components or None where the scene decides, and what each is in words."""
    return [
        {
            "name": f"{owner}.{channel.name}",
            "unit": channel.unit,
            "components": None if channel.components is None else list(channel.components),
            "sentence": channel.sentence,
        }
        for channel in channels
    ]


class _Described(GenerateJsonSchema):
    """Describes keys by the docstrings of their fields, read from the sources here because only a schema needs them."""

    def field_title_should_be_set(self, schema: Any) -> bool:
        """Tables have no titles, also those whose sections are imported when they are needed."""
        function = schema.get("function")
        owner = getattr(function.get("function"), "__self__", None) if isinstance(function, dict) else None
        return not isinstance(owner, Later) and super().field_title_should_be_set(schema)

    def model_schema(self, schema: core_schema.ModelSchema) -> JsonSchemaValue:
        """Schema of a table, with descriptions of its keys."""
        found = super().model_schema(schema)
        section = schema["cls"]
        docs: dict[str, str] = {}
        for base in reversed(section.__mro__):
            docs |= _attribute_docs(base)
        channels = channel_schema("NAME", section.CHANNELS)
        if section.CHANNELS == Collision.CHANNELS:
            channels += channel_schema("NAME.contact_1", Collision.CONTACT_CHANNELS)
        if channels:
            found["channels"] = channels
        described_by = (vars(base).get("DESCRIBED") for base in reversed(section.__mro__))
        for described in (*filter(None, described_by), *getattr(section, "KINDS", ())):
            own = {field.name for field in described_fields(described)}
            for base in reversed(described.__mro__):
                docs |= {name: text for name, text in _attribute_docs(base).items() if name in own}
            docs |= getattr(described, "SENTENCES", {})
        for name, field in section.model_fields.items():
            key = field.alias or name
            if docs.get(name) and key in found.get("properties", {}):
                found["properties"][key]["description"] = docs[name]
            if any(isinstance(mark, NoDefault) for mark in field.metadata):
                found["properties"][key].pop("default", None)
        return found


def _attribute_docs(section: type) -> Mapping[str, str]:
    """Annotated names of a class and the docstrings below them, which may be empty.

    None for a table for one type of values, made from that for any.
    """
    name = section.__module__
    if not name.startswith("heavylift."):
        return {}
    # of a kind only the description may have been executed: its module, with kernels, is not imported for its words
    file = getattr(sys.modules.get(name), "__file__", None)
    if file is None:
        spec = importlib.util.find_spec(name)
        file = None if spec is None else spec.origin
    return {} if file is None else _docs_in(file).get(section.__qualname__, {})


@cache
def _docs_in(file: str) -> dict[str, dict[str, str]]:
    """Docstrings of attributes by the classes of a file, by their qualified names."""
    found: dict[str, dict[str, str]] = {}
    waiting: list[tuple[str, ast.AST]] = [("", ast.parse(Path(file).read_text(encoding="utf-8")))]
    while waiting:
        outer, node = waiting.pop()
        for part in ast.iter_child_nodes(node):
            if isinstance(part, ast.ClassDef):
                found[outer + part.name] = _docs_below(part)
                waiting.append((f"{outer}{part.name}.", part))
            elif isinstance(part, (ast.If, ast.Try, ast.With)):
                waiting.append((outer, part))
    return found


def _docs_below(tree: ast.ClassDef) -> dict[str, str]:
    """Annotated names of a class and the docstrings below them."""
    found: dict[str, str] = {}
    for field, after in zip(tree.body, [*tree.body[1:], ast.Pass()], strict=True):
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name):
            text = after.value if isinstance(after, ast.Expr) else None
            found[field.target.id] = (
                inspect.cleandoc(str(text.value)) if isinstance(text, ast.Constant) else ""
            )
    return found


INDEX, SCENE_CHANNELS = "README.md", "Channels of the whole scene"
NUMBER = quantity_schema()["anyOf"][1]["pattern"]
HEAD = """# Keys of case.toml

Written by `heavylift schema --tables`; do not edit. A quantity is a number in the unit given, or a string with another
unit of the same dimension: `"95 mm"`. A vector is a list. A key without a default is required, unless the default is
"none".
"""


class _Found(NamedTuple):
    """A section: where it stands, and what chooses it there."""

    path: str
    choice: str
    schema: Mapping[str, Any]

    @property
    def title(self) -> str:
        return f"{self.path}, {self.choice}" if self.choice else self.path


def key_tables() -> str:
    """One table a section, in the order in which they are met."""
    order, titles = _sections()
    return "\n".join([HEAD, *(_table(section, titles) for section in order), "", *_channels_of_the_scene()])


def _channels_of_the_scene() -> Iterator[str]:
    scene = (channel_schema(owner, channels) for owner, channels in OF_THE_SCENE.items())
    yield f"## {SCENE_CHANNELS}\n"
    yield from _channels(chain.from_iterable(scene))


def key_pages() -> dict[str, str]:
    """The same by the names of files: a page for each table of a case, and an index.

    Notes
    -----
    The index has the keys of the file itself, whose links lead to the pages.
    """
    order, titles = _sections()
    pages: dict[str, list[_Found]] = {}
    for section in order:
        pages.setdefault(_page(section), []).append(section)
    made = {
        page: [
            f"# {page.removesuffix('.md')}",
            *_contents(sections),
            *(_table(one, titles) for one in sections),
        ]
        for page, sections in pages.items()
    }
    made[INDEX] = [HEAD, *(_table(section, titles) for section in pages[INDEX])]
    made[INDEX] += ["", f"What every run records besides: [{SCENE_CHANNELS.lower()}](channels.md)."]
    made["channels.md"] = [f"# {SCENE_CHANNELS}\n", *list(_channels_of_the_scene())[1:]]
    places = {_anchor(section.title): page for page, sections in pages.items() for section in sections}

    def link(found: re.Match[str], page: str) -> str:
        other = places[found[1]]
        return f"](#{found[1]})" if other == page else f"]({other}#{found[1]})"

    return {
        page: re.sub(r"\]\(#([^)]+)\)", partial(link, page=page), "\n".join(lines)) + "\n"
        for page, lines in made.items()
    }


def _page(section: _Found) -> str:
    """File of the page that a section stands on."""
    return INDEX if section.path == "case.toml" else f"{section.path.partition('.')[0]}.md"


def _contents(sections: Sequence[_Found]) -> list[str]:
    """List of the sections of a page, if they are several."""
    if len(sections) == 1:
        return []
    return ["", *(f"* [{section.title}](#{_anchor(section.title)})" for section in sections)]


def section_tables(name: str, width: int) -> str:
    """Keys of the tables of one name, for a terminal.

    Parameters
    ----------
    name
        ``"ropes"``, a table below it as ``"ropes.winch"``, one of several as ``"joints.hinge"``; ``"case"`` is the
        file itself. ``NAME`` in a path may be left out.
    width
        Characters of a line.

    Raises
    ------
    InputError
        If there is no such section.
    """
    order, titles = _sections()
    wanted = name.removesuffix(".toml").replace(".NAME", "").strip(".[]")
    own = [section for section in order if wanted in (_short_path(section), _chosen_path(section))]
    if not own:
        tops = list(dict.fromkeys(path for path in map(_short_path, order) if "." not in path))
        near = get_close_matches(wanted, [*tops, *map(_chosen_path, order)], 1)
        raise InputError(
            f"{name!r}{f', perhaps {near[0]!r}' if near else ''}",
            source="schema",
            key="section",
            expected=f"one of {', '.join(tops)}",
        )
    top = {_short_path(section) for section in own}
    parts = [section for section in order if any(_short_path(section).startswith(f"{path}.") for path in top)]
    if wanted == "case":
        parts = []
    further: list[str] = []
    if len(own) + len(parts) > _SHOWN:
        further = list(dict.fromkeys(_short_path(section) for section in parts))
        parts = []
    lines = [line for section in (*own, *parts) for line in _terminal_table(section, titles, width)]
    if further:
        lines += textwrap.wrap(f"Tables below: {', '.join(further)}", width)
    return "\n".join(lines).strip("\n")


_SHOWN = 8
"""Tables that are shown together at most."""


def _short_path(section: _Found) -> str:
    """Path of a section as a user calls it."""
    return section.path.removesuffix(".toml").replace(".NAME", "")


def _chosen_path(section: _Found) -> str:
    """Path of a section with the word that chooses it, as in ``joints.hinge``."""
    word = re.search(r'= "([^"]+)"$', section.choice)
    return f"{_short_path(section)}.{word[1]}" if word else ""


def _terminal_table(section: _Found, titles: Mapping[str, str], width: int) -> Iterator[str]:
    """A section as columns: key, value with its default, sentence."""
    yield from ("", section.title.replace("case.toml", "case.toml, the file itself"))
    yield from _wrapped(_plain(_sentence(section.schema.get("description", ""))), width)
    yield ""
    needed = set(section.schema.get("required", ()))
    rows = []
    for key, node in section.schema.get("properties", {}).items():
        default = _default(node)
        default = "needed" if key in needed else "" if default == "none" else f"default {default}"
        value = "; ".join(filter(None, (_short_words(node, titles), default)))
        rows.append((key, _plain(value), _plain(_sentence(node.get("description", "")))))
    first = max((len(key) for key, _, _ in rows), default=0)
    second = min(max((len(value) for _, value, _ in rows), default=0), max(24, (width - first - 4) // 3))
    for key, value, words in rows:
        left = textwrap.wrap(value, second) or [""]
        right = textwrap.wrap(words, max(24, width - first - second - 6)) or [""]
        for index in range(max(len(left), len(right))):
            value_part, words_part = (part[index] if index < len(part) else "" for part in (left, right))
            yield f"  {key if index == 0 else '':{first}}  {value_part:{second}}  {words_part}".rstrip()
    names = [channel["name"] for channel in section.schema.get("channels", ())]
    if names:
        yield from ("", *_wrapped(f"Channels: {', '.join(names)}", width))


def _short_words(node: Mapping[str, Any], titles: Mapping[str, str]) -> str:
    """What a value may be; of several sections in one place only the words that choose them."""
    parts = [titles[name].partition(", ") for name in dict.fromkeys(name for name, _ in _references(node))]
    chosen = [found for _, _, choice in parts if (found := re.search(r'^(\w+) = "([^"]+)"$', choice))]
    if len(parts) < 2 or len({path for path, _, _ in parts}) > 1 or len(chosen) < len(parts):
        return _words(node, titles)
    holder = _words(node, titles).partition(":")[0]
    return f"{holder}: {parts[0][0]}, {chosen[0][1]} {', '.join(found[2] for found in chosen)}"


def _wrapped(text: str, width: int) -> list[str]:
    """Lines of a text, indented."""
    return textwrap.wrap(text, width, initial_indent="  ", subsequent_indent="  ")


def _plain(text: str) -> str:
    """Markdown without its marks."""
    return re.sub(r"\[([^\]]*)\]\(#[^)]*\)", r"\1", text).replace("`", "")


@cache
def _sections() -> tuple[list[_Found], dict[str, str]]:
    """All sections in the order in which they are met, and their titles by the names of their definitions."""
    schema = case_schema()
    definitions = schema["$defs"]
    found = {"": _Found("case.toml", "", schema)}
    order: list[_Found] = []
    waiting = [""]
    while waiting:  # depth first, so that a section stands below the one that holds it
        section = found[waiting.pop(0)]
        order.append(section)
        below = []
        for key, value in section.schema.get("properties", {}).items():
            path = key if section.schema is schema else f"{section.path}.{key}"
            several = len({reference for reference, _ in _references(value)}) > 1
            for reference, suffix in _references(value):
                if reference not in found:
                    definition = definitions[reference]
                    made = _Found(path + suffix, _choice(definition) if several else "", definition)
                    if any(made.title == other.title for other in found.values()):
                        made = made._replace(choice=f"in a table with {section.choice or section.path}")
                    found[reference] = made
                    below.append(reference)
        waiting = below + waiting
    return order, {name: section.title for name, section in found.items()}


def _choice(definition: Mapping[str, Any]) -> str:
    """What says that one of several sections is meant: a key that has one value only."""
    for key, node in definition.get("properties", {}).items():
        if "const" in node:
            return f'{key} = "{node["const"]}"'
    return f"with {definition['required'][0]}" if definition.get("required") else ""


def _references(node: Any, suffix: str = "") -> Iterator[tuple[str, str]]:
    """Sections that a value may be, and how their paths continue."""
    if isinstance(node, list):
        for entry in node:
            yield from _references(entry, suffix)
    if not isinstance(node, dict):
        return
    if "$ref" in node:
        yield node["$ref"].rpartition("/")[2], suffix
    for key in ("anyOf", "oneOf", "items", "prefixItems"):
        yield from _references(node.get(key), suffix)
    for key in ("patternProperties", "additionalProperties"):
        entries = node.get(key)
        if isinstance(entries, dict):
            values = list(entries.values()) if key == "patternProperties" else [entries]
            yield from _references(values, f"{suffix}.NAME")


def _table(section: _Found, titles: Mapping[str, str]) -> str:
    lines = [f"\n## {section.title}\n"] if section.path != "case.toml" else [""]
    words = _sentence(section.schema.get("description", ""))
    if words and section.path != "case.toml":
        lines += [words, ""]
    needed = set(section.schema.get("required", ()))
    lines += ["| key | value | default | |", "|---|---|---|---|"]
    for key, node in section.schema.get("properties", {}).items():
        default = "" if key in needed else _default(node)
        cells = (f"`{key}`", _words(node, titles), default, _sentence(node.get("description", "")))
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    if "channels" in section.schema:
        lines += ["", *_channels(section.schema["channels"])]
    return "\n".join(lines)


def _channels(channels: Iterable[Mapping[str, Any]]) -> Iterator[str]:
    yield from ("| channel | unit | components | |", "|---|---|---|---|")
    for channel in channels:
        names = channel["components"]
        components = "several" if names is None else ", ".join(f"`{name}`" for name in names)
        yield f"| `{channel['name']}` | {channel['unit']} | {components} | {channel['sentence']} |"


def _sentence(text: str) -> str:
    """A docstring on one line."""
    return " ".join(text.split()).replace("``", "`")


def _default(node: Mapping[str, Any]) -> str:
    value = node.get("default")
    if value is None or value in ([], {}, ""):
        return "none"
    return f"`{json.dumps(value)}`"


def _words(node: Mapping[str, Any], titles: Mapping[str, str]) -> str:
    """What a value may be."""
    sections = list(dict.fromkeys(reference for reference, _ in _references(node)))
    if sections:
        holder = "list of tables" if "items" in node or "prefixItems" in node else "table"
        holder = "tables by name" if "patternProperties" in node or "propertyNames" in node else holder
        return f"{holder}: " + ", ".join(f"[{titles[name]}](#{_anchor(titles[name])})" for name in sections)
    if "quantity" in node and "anyOf" in node:
        unit = KINDS[node["quantity"]].unit
        return node["quantity"] + ("" if unit == "1" else f" [{unit}]") + _range(node["anyOf"][0])
    if any(choice.get("pattern") == NUMBER for choice in node.get("anyOf", ())):
        return "quantity" + _range(node["anyOf"][0])
    choices = [choice for choice in node.get("anyOf", node.get("oneOf", ())) if choice.get("type") != "null"]
    if choices:
        return " or ".join(dict.fromkeys(_words(choice, titles) for choice in choices))
    if "const" in node:
        return f'`"{node["const"]}"`'
    if "enum" in node:
        return ", ".join(f"`{json.dumps(value)}`" for value in node["enum"])
    if "prefixItems" in node:
        parts = [_words(part, titles) for part in node["prefixItems"]]
        return f"{len(parts)} x {parts[0]}" if len(set(parts)) == 1 else ", ".join(parts)
    if "items" in node:
        return f"list of {_words(node['items'], titles)}"
    if node.get("type") == "object":
        return "table"
    return {"string": "text", "boolean": "`true`, `false`"}.get(
        node.get("type", ""), node.get("type", "value")
    ) + _range(node)


def _range(node: Mapping[str, Any]) -> str:
    signs = (("minimum", ">="), ("exclusiveMinimum", ">"), ("maximum", "<="), ("exclusiveMaximum", "<"))
    return ",".join(f" {sign} {node[key]:g}" for key, sign in signs if key in node)


def _anchor(title: str) -> str:
    """As Markdown viewers make it from a heading."""
    return "".join(c for c in title.lower().replace(" ", "-") if c.isalnum() or c in "-_")
