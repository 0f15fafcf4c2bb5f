"""Joints, ropes and forces of a case in words and numbers for the report."""

from __future__ import annotations

from dataclasses import MISSING
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.quantity import (
    AsDrawn,
    BodyPoint,
    ByCoordinate,
    NameOf,
    Quantity,
    Shape,
    WorldDirection,
)
from heavylift.pipeline.case.bodies import ProfileSection
from heavylift.pipeline.case.channel_kinds import joint_coordinate, lies_along_edge
from heavylift.pipeline.case.joints import AngleLimitsSection, TravelLimitsSection
from heavylift.pipeline.report.document import short_table
from heavylift.pipeline.results.words import number_words, numbers_words, profile_words, range_words
from heavylift.solver.scene.descriptions import DescribedField, described_fields

if TYPE_CHECKING:
    from collections.abc import Sequence

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.report.document import Table

__all__ = ["connection_tables", "own_words"]


def connection_tables(case: Case) -> list[Table]:
    """Tables of the joints, ropes and forces of a case; none of what it has not."""
    tables = []
    if case.joints:
        columns = ("joint", "type", "between", "place", "axis", "besides")
        tables.append(short_table(columns, [_joint(joint) for joint in case.joints]))
    if case.ropes:
        columns = ("rope", "type", "path", "stiffness", "length", "besides")
        tables.append(short_table(columns, [_rope(rope) for rope in case.ropes]))
    if case.forces:
        kinds: dict[str, str] = {joint.name: joint.type for joint in case.joints}
        tables.append(
            short_table(
                ("force", "type", "on", "place", "value"), [_force(force, kinds) for force in case.forces]
            )
        )
    return tables


def _joint(joint: Any) -> tuple[str, ...]:
    at = getattr(joint, "at", None)
    if lies_along_edge(joint.type):
        place = _edges(joint)
    elif at is not None:
        place = numbers_words(at, "m")
    else:
        place = " and ".join(numbers_words(point, "m") for point in joint.points)
    axes = getattr(joint, "axis", None), getattr(joint, "axes", None)
    axis = numbers_words(axes[0], "") if axes[0] is not None else ""
    if axes[1] is not None:
        axis = " and ".join(numbers_words(entry, "") for entry in axes[1])
    own = described_fields(joint.DESCRIBED)
    directions = [field.name for field in own if not isinstance(field.quantity, Quantity)]
    for key in ("second_axis", *directions):
        if getattr(joint, key, None) is not None:
            axis += f", {key.replace('_', ' ')} {numbers_words(getattr(joint, key), '')}"
    return (joint.name, joint.type.replace("_", "-"), " – ".join(joint.between), place, axis, _besides(joint))


def _edges(joint: Any) -> str:
    """Edges of a joint along them."""
    if joint.edge or joint.edges:
        return " and ".join(joint.edges or (joint.edge,))
    return " and ".join(f"nodes {numbers_words(nodes, '')}" for nodes in joint.node_lists)


def _besides(joint: Any) -> str:
    """Drive, limits, friction, length and whatever else a joint has, compliance."""
    words = [own_words(field, getattr(joint, field.name)) for field in described_fields(joint.DESCRIBED)]
    if joint.compliance:
        words.append(f"compliance {joint.compliance:g} m/N")
    if joint.relaxation:
        words.append(f"relaxation {number_words(joint.relaxation, 's')}")
    return "; ".join(filter(None, words))


def own_words(field: DescribedField, value: Any, coordinate: str = "") -> str:
    """Value of a key of its own; nothing where it is as if absent.

    Parameters
    ----------
    field, value
        The key and its value.
    coordinate
        That of the joint, ``"angle"`` or ``"travel"``, on which the quantity may depend.
    """
    quantity, name = field.quantity, field.name.replace("_", " ")
    if field.mark(AsDrawn) is not None and value is None:
        return f"{name} as drawn"
    if isinstance(quantity, (WorldDirection, BodyPoint, NameOf)):
        return ""
    if (
        value is None
        or value == ()
        or (field.default is not MISSING and np.array_equal(value, field.default))
    ):
        return ""
    if isinstance(quantity, ByCoordinate):
        quantity = quantity.travel if coordinate == "travel" else quantity.angle
    unit = quantity.unit if isinstance(quantity, Quantity) else ""
    if isinstance(value, ProfileSection):
        return f"{_PARTICIPLES.get(field.name, field.name)}: {profile_words(value, unit)}"
    if isinstance(value, (AngleLimitsSection, TravelLimitsSection)):
        return _limits(value, turns=isinstance(value, AngleLimitsSection))
    if isinstance(value, bool):
        return name
    if isinstance(value, float):
        return f"{name} {number_words(value, unit)}"
    if not isinstance(value, tuple):
        return f"{name} {value}"
    if field.mark(Shape) is None or None not in field.mark(Shape).lengths:
        return f"{name} {numbers_words(value, unit)}"
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


def _rope(rope: Any) -> tuple[str, ...]:
    path = " – ".join(
        stop.body + (f" (pulley {number_words(stop.radius, 'm')})" if stop.radius else "")
        for stop in rope.path
    )
    wire = rope.type == "wire"
    stiffness = (
        f"EA {number_words(rope.axial_stiffness, 'N')}" if wire else number_words(rope.stiffness, "N/m")
    )
    words = [f"damping {number_words(rope.damping, 'N s/m')}"] if rope.damping else []
    if wire and rope.winch is not None:
        words.append(f"winch {range_words(rope.winch.speeds, 'm/s')}, {len(rope.winch.times)} points")
    length = "as drawn" if rope.length is None else number_words(rope.length, "m")
    return (rope.name, rope.type, path, stiffness, length, "; ".join(words))


def _force(force: Any, kinds: dict[str, str]) -> tuple[str, ...]:
    """Name, sort, bodies or joint, places, and all else that it says."""
    coordinate = joint_coordinate(kinds[force.joint]) if hasattr(force, "joint") else ""
    points = getattr(force, "points", None) or [force.point] * hasattr(force, "point")
    place = " and ".join(numbers_words(point, "m") for point in points)
    on = " – ".join(getattr(force, "between", ())) or getattr(force, "joint", None) or force.body
    words = [
        own_words(field, getattr(force, field.name), coordinate)
        for field in described_fields(force.DESCRIBED)
    ]
    return (force.name, force.type.replace("_", " "), on, place, "; ".join(filter(None, words)))
