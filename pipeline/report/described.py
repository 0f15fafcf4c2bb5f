"""Tables of a report that follow from descriptions: where each component is, and the values of its keys."""

from __future__ import annotations

from dataclasses import MISSING
from typing import TYPE_CHECKING, Any, Literal, get_origin

import numpy as np

from heavylift.numerics.quantity import (
    AsDrawn,
    BodyPoint,
    ByCoordinate,
    Key,
    NameOf,
    Quantity,
    Shape,
    WorldDirection,
)
from heavylift.pipeline.case.channel_kinds import joint_coordinate
from heavylift.pipeline.case.fields import Section
from heavylift.pipeline.case.joints import AngleLimitsSection, TravelLimitsSection
from heavylift.pipeline.report.document import short_table
from heavylift.pipeline.results.words import number_words, numbers_words, profile_words, range_words
from heavylift.solver.scene.bodies import Profile
from heavylift.solver.scene.descriptions import described_fields

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from heavylift.pipeline.report.document import Table
    from heavylift.solver.scene.descriptions import DescribedField

__all__ = ["described_table", "own_words", "thing_words"]

_PARTS = 4  # tables within a table that are written out at most


def described_table(
    what: str,
    things: Sequence[Any],
    joints: Mapping[str, str] | None = None,
    more: Mapping[str, Sequence[str]] | None = None,
) -> list[Table]:
    """Table of the components of a list of a case: where they are, and their values; none of an empty list.

    Parameters
    ----------
    what
        What each is called.
    things
        Their sections.
    joints
        Types of the joints by name.
    more
        Additional text, by name of the component.
    """
    if not things:
        return []
    rows = []
    for thing in things:
        spec = getattr(thing, "coordinate", None)
        coordinate = joint_coordinate((joints or {})[thing.joint], spec) if hasattr(thing, "joint") else ""
        words = [*thing_words(thing, coordinate), *(more or {}).get(thing.name, ())]
        kind = getattr(thing, "type", "").replace("_", " ")
        rows.append((thing.name, kind, *_place(thing), "; ".join(words)))
    columns = (what, "type", "on", "place", "value")
    kept = [k for k in range(len(columns)) if any(row[k] for row in rows)]
    return [short_table([columns[k] for k in kept], [tuple(row[k] for k in kept) for row in rows])]


def _place(thing: Any) -> tuple[str, str]:
    """Names of the bodies of a component, and its points."""
    points = getattr(thing, "points", None) or filter(None, [getattr(thing, "point", None)])
    names = list(getattr(thing, "between", ())) or [
        getattr(thing, key) for key in ("body", "joint") if hasattr(thing, key)
    ]
    names = names or [getattr(thing, key) for key in [getattr(thing.DESCRIBED, "TARGET", "")] if key]
    for stop in getattr(thing, "path", ()):
        pulley = f" (pulley {number_words(stop.radius, 'm')})" if stop.radius else ""
        names.append(stop.body + pulley)
    return " – ".join(names), " and ".join(numbers_words(point, "m") for point in points)


def thing_words(thing: Any, coordinate: str = "") -> list[str]:
    """Values of the keys of a component, except for where it is."""
    words = [
        own_words(field, getattr(thing, field.name), coordinate)
        for field in described_fields(thing.DESCRIBED)
        if field.name != "path"
    ]
    return [text for text in words if text]


def own_words(field: DescribedField, value: Any, coordinate: str = "") -> str:
    """Value of a key of its own; nothing where it is as if absent.

    Parameters
    ----------
    field, value
        The key and its value.
    coordinate
        That of the joint, ``"angle"`` or ``"travel"``, on which the quantity may depend.
    """
    key = field.mark(Key)
    quantity, name = field.quantity, key.word if key else field.name.replace("_", " ")
    if field.mark(AsDrawn) is not None and value is None:
        return f"initial geometric {name}"
    if isinstance(quantity, (WorldDirection, BodyPoint, NameOf)):
        return ""
    if get_origin(field.hint) is Literal and value is not None:
        return f"{name} {value}"
    if (
        value is None
        or value == ()
        or (field.default is not MISSING and np.array_equal(value, field.default))
    ):
        return ""
    if isinstance(quantity, ByCoordinate):
        quantity = quantity.travel if coordinate == "travel" else quantity.angle
    unit = quantity.unit if isinstance(quantity, Quantity) else ""
    if getattr(value, "DESCRIBED", None) is Profile:
        return f"{_PARTICIPLES.get(field.name, field.name)}: {profile_words(value, unit)}"
    if isinstance(value, (AngleLimitsSection, TravelLimitsSection)):
        return _limits(value, turns=isinstance(value, AngleLimitsSection))
    if isinstance(value, bool):
        return name
    if isinstance(value, float):
        return f"{name} {number_words(value, unit)}"
    if isinstance(value, Section):
        return f"{name}: {', '.join(thing_words(value, coordinate))}"
    if not isinstance(value, tuple):
        return f"{name} {value}"
    if isinstance(value[0], Section):
        parts = ("; ".join(thing_words(part, coordinate)) for part in value)
        return f"{name}: {', then '.join(parts)}" if len(value) <= _PARTS else f"{len(value)} {name}"
    shape = field.mark(Shape)
    if shape is None or None not in shape.lengths:
        rows = value if shape is not None and len(shape.lengths) > 1 else [value]
        return f"{name} {', '.join(numbers_words(row, unit) for row in rows)}"
    return f"{len(value)} {name}: {_ranges(value, unit)}"


def _ranges(values: Sequence[Any], unit: str) -> str:
    """Smallest and largest numbers of a list of numbers or vectors."""
    columns = np.array(values).reshape(len(values), -1)
    if columns.shape[1] == 1:
        return range_words(columns[:, 0].tolist(), unit)
    low, high = columns.min(axis=0).tolist(), columns.max(axis=0).tolist()
    return f"smallest {numbers_words(low, unit)}, largest {numbers_words(high, unit)}"


_PARTICIPLES = {"drive": "driven"}


def _limits(limits: Any, *, turns: bool) -> str:
    unit, stiffness = ("rad", "N m/rad") if turns else ("m", "N/m")
    ends = [
        "" if end is None else f"{word} {number_words(end, unit)}"
        for word, end in (("from", limits.lower), ("to", limits.upper))
    ]
    return f"limits {' '.join(filter(None, ends))}, {number_words(limits.stiffness, stiffness)}"
