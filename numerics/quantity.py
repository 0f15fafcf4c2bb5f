"""Annotations of the numbers that a user gives: what quantity, in which range, in what unit.

They are metadata: a dataclass that carries them knows nothing of case files. Where a case file is read,
pydantic asks the annotation itself how to validate, and gets the parser of units.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import KINDS, Dimension, Kind, parse_quantity, with_article

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic_core import CoreSchema

__all__ = [
    "Absent",
    "AsDrawn",
    "BodyDirection",
    "BodyPoint",
    "ByCoordinate",
    "ByExponent",
    "InWorld",
    "Key",
    "Least",
    "NameOf",
    "PointsFile",
    "Positive",
    "Quantity",
    "Shape",
    "Square",
    "TableFile",
    "WorldDirection",
    "quantity_schema",
]


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


@dataclass(frozen=True)
class BodyDirection:
    """Annotation of a direction, shape (3,), in the axes of the body that a component is on; of two the first."""


@dataclass(frozen=True)
class BodyPoint:
    """Annotation of a point [m], shape (3,), of the body that a component is on.

    A user gives it in the coordinates of the geometry of the body, an object keeps it in its frame.

    Attributes
    ----------
    of
        Key that names the body, in a table with several; ``body`` if empty.
    """

    of: str = ""


@dataclass(frozen=True)
class InWorld:
    """Annotation of a place [m] that a user gives in the world: it moves with tables that are shifted."""


@dataclass(frozen=True)
class ByCoordinate:
    """Annotation of a number that is one quantity for a joint that turns and another one for a joint that slides.

    In a table within the key of an angle or a length it is that of the key: of a function of time, for instance.
    """

    angle: Quantity
    travel: Quantity


@dataclass(frozen=True)
class ByExponent:
    """Annotation of the stiffness k > 0 of a force ``k d^n`` [N/m^n].

    Attributes
    ----------
    exponent
        n; the key ``exponent`` of the same table if None.
    """

    exponent: float | None = None

    def parse(self, value: object, exponent: float) -> float:
        """SI number of an input value.

        Raises
        ------
        InputError
            If it is no number, has a wrong unit or is not positive.
        """
        unit = f"N/m^{exponent:g}"
        kind = Kind("stiffness of a contact", unit, Dimension(1.0 - exponent, 1.0, -2.0))
        number = parse_quantity(value, kind)
        if number <= 0.0:
            raise InputError(f"{value!r} is too small", expected=f"a {kind.name} > 0 {unit}")
        return number


@dataclass(frozen=True)
class NameOf:
    """Annotation of a name of something else in the scene.

    Attributes
    ----------
    what
        ``"body"``; ``"side"``, a body or the ground; ``"hull"``; ``"joint"``, one with an angle or a travel;
        ``"fluid"``, a wind or a current; ``"rope"``.
    """

    what: str


@dataclass(frozen=True)
class TableFile:
    """Annotation of the name of a file with columns of numbers in the case folder, in place of arrays.

    Attributes
    ----------
    headers
        Names of the columns that it may have; angles in degrees end with ``_deg``.
    fields
        Of the object: what the columns become, one each.
    """

    headers: tuple[tuple[str, ...], ...]
    fields: tuple[str, ...]

    def arrays(
        self,
        name: str,  # noqa: ARG002
        header: Sequence[str],
        columns: Sequence[Sequence[float]],
    ) -> dict[str, Any]:
        """Fields of the object, from the name of the file, the names of its columns and their numbers."""
        return {
            key: np.array(np.radians(column) if title.endswith("_deg") else column, dtype=float)
            for key, title, column in zip(self.fields, header, columns, strict=True)
        }


@dataclass(frozen=True)
class PointsFile:
    """Annotation of the name of a file of points in the case folder, lines ``x,y,z`` [m], in place of an array.

    Attributes
    ----------
    field
        Of the object: what the points become, shape (n, 3).
    """

    field: str = "points"


@dataclass(frozen=True)
class Key:
    """Annotation of a key that a user writes with another word than the field, as ``from``, which Python reserves."""

    word: str


@dataclass(frozen=True)
class Shape:
    """Annotation of an array of numbers: how many a user lists along each axis, None for any number."""

    lengths: tuple[int | None, ...]


@dataclass(frozen=True)
class Square:
    """Annotation of a square matrix: a user lists its rows, or the numbers on its diagonal if all others are zero."""

    size: int


@dataclass(frozen=True)
class Least:
    """Annotation of a list: how many entries it has at least."""

    count: int


@dataclass(frozen=True)
class Absent:
    """Annotation of a key that a user may leave out, and that then means something that no value says.

    Attributes
    ----------
    value
        What an object then has, an infinite stiffness for instance; the default of its field if None.
    """

    value: Any = None


@dataclass(frozen=True)
class AsDrawn(Absent):
    """Annotation of a length that a user may leave out: it then is the distance of the two ends at the start."""


def quantity_schema(description: str = "", **limits: float) -> dict[str, Any]:
    """JSON Schema of a number within limits, or a string that begins with a number."""
    text = {"type": "string", "pattern": r"^\s*[+-]?(\d|\.\d)"}
    schema: dict[str, Any] = {"anyOf": [{"type": "number", **limits}, text]}
    return schema | ({"description": description} if description else {})


def Positive(kind: str) -> Quantity:
    """Quantity greater than zero."""
    return Quantity(kind, minimum=0.0)
