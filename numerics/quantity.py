"""Annotations of the numbers that a user gives: what quantity, in which range, in what unit.

They are metadata: a dataclass that carries them knows nothing of case files. Where a case file is read,
pydantic asks the annotation itself how to validate, and gets the parser of units.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import KINDS, parse_quantity, with_article

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic_core import CoreSchema

__all__ = ["Positive", "Quantity", "WorldDirection", "quantity_schema"]


@dataclass(frozen=True)
class Quantity:
    """Annotation of a number in SI or a string with a unit; validates to the SI number.

    Attributes
    ----------
    kind
        Name of a `heavylift.numerics.units.Kind`.
    minimum, maximum
        Bounds in SI; they themselves are allowed if `closed`.
    closed
        Whether the bounds belong to the range.
    """

    kind: str
    minimum: float | None = None
    maximum: float | None = None
    closed: bool = False

    @property
    def unit(self) -> str:
        """SI unit; "1" for a number."""
        return KINDS[self.kind].unit

    def parse(self, value: object) -> float:
        """SI number of an input value.

        Raises
        ------
        InputError
            If it is no number, has a wrong unit or lies out of range.
        """
        number = parse_quantity(value, KINDS[self.kind])
        name, unit = with_article(self.kind), "" if self.unit == "1" else f" {self.unit}"
        if self.minimum is not None and (
            number < self.minimum or (number == self.minimum and not self.closed)
        ):
            sign = ">=" if self.closed else ">"
            raise InputError(f"{value!r} is too small", expected=f"{name} {sign} {self.minimum:g}{unit}")
        if self.maximum is not None and (
            number > self.maximum or (number == self.maximum and not self.closed)
        ):
            sign = "<=" if self.closed else "<"
            raise InputError(f"{value!r} is too large", expected=f"{name} {sign} {self.maximum:g}{unit}")
        return number

    def validate(self, value: object) -> float:
        """As `parse`, with the error that ends the validation of one field of a case file."""
        try:
            return self.parse(value)
        except InputError as error:
            from pydantic_core import PydanticCustomError

            words = {"problem": error.problem, "expected": error.expected, "key": ""}
            raise PydanticCustomError("case", "{problem}", words) from None

    def __get_pydantic_core_schema__(self, _source: object, _handler: GetCoreSchemaHandler) -> CoreSchema:
        from pydantic_core import core_schema

        return core_schema.no_info_plain_validator_function(self.validate)

    def __get_pydantic_json_schema__(
        self, _schema: CoreSchema, _handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        number: dict[str, Any] = {}
        if self.minimum is not None:
            number["minimum" if self.closed else "exclusiveMinimum"] = self.minimum
        if self.maximum is not None:
            number["maximum" if self.closed else "exclusiveMaximum"] = self.maximum
        words = f"{self.kind}: number in {self.unit}, or a string with a unit"
        return quantity_schema(words, **number) | {"quantity": self.kind}


@dataclass(frozen=True)
class WorldDirection:
    """Annotation of a direction, shape (3,): a user gives it in the world at the start, a body keeps it in its axes."""


def quantity_schema(description: str = "", **limits: float) -> dict[str, Any]:
    """JSON Schema of a number within limits, or a string that begins with a number."""
    text = {"type": "string", "pattern": r"^\s*[+-]?(\d|\.\d)"}
    schema: dict[str, Any] = {"anyOf": [{"type": "number", **limits}, text]}
    return schema | ({"description": description} if description else {})


def Positive(kind: str) -> Quantity:
    """Quantity greater than zero."""
    return Quantity(kind, minimum=0.0)
