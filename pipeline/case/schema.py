"""JSON Schema of case files, for editors."""

from __future__ import annotations

import ast
import importlib
import inspect
import textwrap
from typing import TYPE_CHECKING, Any

from pydantic.json_schema import GenerateJsonSchema

from heavylift.pipeline.case.case_file import Case
from heavylift.pipeline.case.collisions import CollisionSection
from heavylift.solver.scene.collisions import Collision
from heavylift.solver.scene.descriptions import described_fields

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pydantic.json_schema import JsonSchemaValue
    from pydantic_core import core_schema

    from heavylift.solver.scene.descriptions import ChannelKind

__all__ = ["case_schema", "channel_schema"]


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

    def model_schema(self, schema: core_schema.ModelSchema) -> JsonSchemaValue:
        """Schema of a table, with descriptions of its keys."""
        found = super().model_schema(schema)
        section = schema["cls"]
        docs: dict[str, str] = {}
        for base in reversed(section.__mro__):
            docs |= _attribute_docs(base)
        channels = channel_schema("NAME", section.CHANNELS)
        if issubclass(section, CollisionSection):
            channels += channel_schema("NAME.contact_1", Collision.CONTACT_CHANNELS)
        if channels:
            found["channels"] = channels
        described = getattr(section, "DESCRIBED", None)
        if described is not None:
            own = {field.name for field in described_fields(described)}
            for base in reversed(described.__mro__):
                docs |= {name: text for name, text in _attribute_docs(base).items() if name in own}
            docs |= getattr(described, "SENTENCES", {})
        for name, field in section.model_fields.items():
            key = field.alias or name
            if docs.get(name) and key in found.get("properties", {}):
                found["properties"][key]["description"] = docs[name]
        return found


def _attribute_docs(section: type) -> dict[str, str]:
    """Annotated names of a class and the docstrings below them, which may be empty."""
    if not section.__module__.startswith("heavylift."):
        return {}
    importlib.import_module(section.__module__)  # of a kind only the description may have been executed
    try:
        source = inspect.getsource(section)
    except OSError:  # a table for one type of values, made from that for any
        return {}
    (tree,) = ast.parse(textwrap.dedent(source)).body
    assert isinstance(tree, ast.ClassDef)
    found: dict[str, str] = {}
    for field, after in zip(tree.body, [*tree.body[1:], ast.Pass()], strict=True):
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name):
            text = after.value if isinstance(after, ast.Expr) else None
            found[field.target.id] = (
                inspect.cleandoc(str(text.value)) if isinstance(text, ast.Constant) else ""
            )
    return found
