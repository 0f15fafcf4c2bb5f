"""From a table of a case to the object of its description: points and directions come into the frames of bodies."""

from __future__ import annotations

from dataclasses import MISSING
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.quantity import (
    Absent,
    AsDrawn,
    BodyDirection,
    BodyPoint,
    PointsFile,
    Shape,
    Square,
    TableFile,
)
from heavylift.pipeline.case.columns import read_points, read_table
from heavylift.pipeline.case.fields import Section
from heavylift.pipeline.case.places import located
from heavylift.solver.scene.connections import Between
from heavylift.solver.scene.descriptions import described_fields

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from heavylift.pipeline.assemble.sides import Side
    from heavylift.pipeline.case.case_file import Case
    from heavylift.solver.scene.descriptions import DescribedField

__all__ = ["assemble", "assemble_list", "spec_of"]


def assemble_list(case: Case, key: str, sides: Mapping[str, Side]) -> list[Any]:
    """What a list of tables describes; errors name the place in the case file."""
    found = []
    for index, section in enumerate(getattr(case, key)):
        with located(case, f"{key}.{index}"):
            found.append(assemble(section, sides, case.folder, "", case.begins_at_rest))
    return found


def spec_of(section: Any, described: Any) -> dict[str, Any]:
    """What a section says of the fields of a description; without those that it leaves out."""
    given = {field.name: getattr(section, field.name) for field in described_fields(described)}
    return {name: value for name, value in given.items() if value is not None}


def assemble(
    section: Any,
    sides: Mapping[str, Side],
    folder: Path,
    body: str = "",
    at_rest: bool = False,
    /,
    **more: Any,
) -> Any:
    """What a table describes.

    Parameters
    ----------
    section
        The table.
    sides
        Where bodies are at the start, by name.
    folder
        Of the case, for the files that it names.
    body
        Of the component in whose table it is.
    at_rest
        The case comes to rest before time starts, so that elongations are known only then.
    **more
        Fields of the object that are no keys.
    """
    described, given = section.DESCRIBED, dict(more)
    if hasattr(section, "name"):
        given["name"] = section.name
    body = getattr(section, "body", getattr(section, "hull", body))
    places = []
    if issubclass(described, Between):
        body, other = section.between
        places = list(zip(section.between, section.points, strict=True))
        ends = [sides[name].local(point) for name, point in places]
        given |= {"body_a": body, "point_a": ends[0], "body_b": other, "point_b": ends[1]}
    elif hasattr(section, "path"):
        places = [(stop.body, stop.point) for stop in section.path]
    world = [sides[name].to_world(sides[name].local(point)) for name, point in places]
    for field in described_fields(described):
        value = getattr(section, field.name)
        if value is None and field.absent:
            if field.mark(AsDrawn) is not None:
                given[field.name] = float(np.linalg.norm(world[1] - world[0]))
            elif field.default is MISSING:
                given[field.name] = field.mark(Absent).value
        elif isinstance(field.quantity, TableFile):
            if value is not None:
                given |= field.quantity.arrays(value, *read_table(folder / value, field.quantity))
        elif isinstance(field.quantity, PointsFile):
            if value is not None:
                given[field.quantity.field] = read_points(folder / value)
        else:
            given.setdefault(field.name, _value(value, field, sides, folder, body))
    made = described(**given)
    if hasattr(made, "check_start"):
        made.check_start(world, at_rest=at_rest)
    return made


def _value(value: Any, field: DescribedField, sides: Mapping[str, Side], folder: Path, body: str) -> Any:
    """What an object keeps of the value of a key."""
    if value is None:
        return None
    if isinstance(field.quantity, BodyPoint):
        return sides[body].local(value)
    if isinstance(field.quantity, BodyDirection) or field.mark((Shape, Square)) is not None:
        return np.array(value, dtype=float)
    if isinstance(value, Section):
        return assemble(value, sides, folder, body)
    if isinstance(value, tuple):
        return tuple(_value(entry, field, sides, folder, body) for entry in value)
    return value
