"""From a table of a case to the object of its description: points and directions come into the frames of bodies."""

from __future__ import annotations

from dataclasses import MISSING
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.quantity import Absent, AsDrawn, BodyDirection, BodyPoint, Shape
from heavylift.pipeline.case.fields import Section
from heavylift.pipeline.case.places import located
from heavylift.solver.scene.connections import Between
from heavylift.solver.scene.descriptions import described_fields

if TYPE_CHECKING:
    from collections.abc import Mapping

    from heavylift.pipeline.assemble.sides import Side
    from heavylift.pipeline.case.case_file import Case
    from heavylift.solver.scene.descriptions import DescribedField

__all__ = ["assemble", "assemble_list"]


def assemble_list(case: Case, key: str, sides: Mapping[str, Side]) -> list[Any]:
    """What a list of tables describes; errors name the place in the case file."""
    found = []
    for index, section in enumerate(getattr(case, key)):
        with located(case, f"{key}.{index}"):
            found.append(assemble(section, sides))
    return found


def assemble(section: Any, sides: Mapping[str, Side], body: str = "") -> Any:
    """What a table describes; one within the table of a thing is on the `body` of that thing."""
    described, given = section.DESCRIBED, {}
    if hasattr(section, "name"):
        given["name"] = section.name
    distance, body = 0.0, getattr(section, "body", body)
    if issubclass(described, Between):
        a, b = (sides[name] for name in section.between)
        ends = a.local(section.points[0]), b.local(section.points[1])
        distance = float(np.linalg.norm(b.to_world(ends[1]) - a.to_world(ends[0])))
        body = section.between[0]
        given |= {"body_a": body, "point_a": ends[0], "body_b": section.between[1], "point_b": ends[1]}
    for field in described_fields(described):
        value = getattr(section, field.name)
        if value is None and field.absent:
            if field.mark(AsDrawn) is not None:
                given[field.name] = distance
            elif field.default is MISSING:
                given[field.name] = field.mark(Absent).value
        else:
            given[field.name] = _value(value, field, sides, body)
    return described(**given)


def _value(value: Any, field: DescribedField, sides: Mapping[str, Side], body: str) -> Any:
    """What an object keeps of the value of a key."""
    if value is None:
        return None
    if isinstance(field.quantity, BodyPoint):
        return sides[body].local(value)
    if isinstance(field.quantity, BodyDirection) or field.mark(Shape) is not None:
        return np.array(value, dtype=float)
    if isinstance(value, Section):
        return assemble(value, sides, body)
    if isinstance(value, tuple):
        return tuple(_value(entry, field, sides, body) for entry in value)
    return value
