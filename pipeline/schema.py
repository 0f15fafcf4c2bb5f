"""JSON Schema of case files, for editors."""

from __future__ import annotations

from typing import Any

from heavylift.pipeline.case import Case

__all__ = ["case_schema"]


def case_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of ``case.toml``; quantities are numbers in SI or strings with a unit."""
    schema = Case.model_json_schema(mode="validation")
    # bodies may all come from blocks
    schema["required"] = [key for key in schema["required"] if key != "bodies"]
    schema["anyOf"] = [{"required": ["bodies"]}, {"required": ["repeat"]}]
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "heavylift case",
        **{key: value for key, value in schema.items() if key != "title"},
    }
