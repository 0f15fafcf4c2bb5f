"""What a case file says of waves beside their descriptions: a train may stand alone, and none breaks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from heavylift.pipeline.case.described import Chosen, checked
from heavylift.solver.scene.waves import WAVES

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic_core import CoreSchema

__all__ = ["WaveSection", "check_wave", "one_or_many"]

WaveSection = Annotated[Any, Chosen(WAVES)]
"""Waves of any kind."""


class one_or_many:  # noqa: N801  an annotation, used like a function
    """Annotation of a list of tables that may be written as a single table."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        from pydantic_core import core_schema

        return core_schema.no_info_before_validator_function(
            lambda value: [value] if isinstance(value, dict) else value, handler(source)
        )

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        many = handler(schema)
        return {"anyOf": [many["items"], many]} if "items" in many else many


def check_wave(waves: Any, depth: float, gravity: float, key: str) -> None:
    """Refuse heights and periods that no wave of this water has.

    Parameters
    ----------
    waves
        A table of waves.
    depth, gravity
        [m] (infinite for deep water), [m/s^2].
    key
        Of the table, for the message.
    """
    checked(lambda spec: spec.DESCRIBED.check_water(spec, depth, gravity), waves, key)
