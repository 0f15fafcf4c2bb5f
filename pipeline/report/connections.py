"""Joints, ropes and forces of a case in words and numbers for the report."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.quantity import Quantity
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

__all__ = ["connection_tables"]


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
    words = [_own_words(field, getattr(joint, field.name)) for field in described_fields(joint.DESCRIBED)]
    if joint.compliance:
        words.append(f"compliance {joint.compliance:g} m/N")
    if joint.relaxation:
        words.append(f"relaxation {number_words(joint.relaxation, 's')}")
    return "; ".join(filter(None, words))


def _own_words(field: DescribedField, value: Any) -> str:
    """Value of a key of its own; nothing where it is as if absent."""
    if not isinstance(field.quantity, Quantity) or value == field.default:
        return ""
    if isinstance(value, ProfileSection):
        return f"{_PARTICIPLES.get(field.name, field.name)}: {profile_words(value, field.quantity.unit)}"
    if isinstance(value, (AngleLimitsSection, TravelLimitsSection)):
        return _limits(value, turns=isinstance(value, AngleLimitsSection))
    return f"{field.name.replace('_', ' ')} {number_words(value, field.quantity.unit)}"


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
    if force.type == "point":
        value = _load(force.force, force.times, force.forces, "N")
        return (force.name, f"force, {force.frame} axes", force.body, numbers_words(force.point, "m"), value)
    if force.type == "spring":
        place = " and ".join(numbers_words(point, "m") for point in force.points)
        length = "as drawn" if force.length is None else number_words(force.length, "m")
        law = _law(force.stiffness, force.damping, force.elongations, ("m", "N"))
        return (force.name, "spring", " – ".join(force.between), place, f"{law}; length {length}")
    if hasattr(force, "DESCRIBED"):
        place = " and ".join(numbers_words(point, "m") for point in force.points)
        words = [_own_words(field, getattr(force, field.name)) for field in described_fields(force.DESCRIBED)]
        kind = force.type.replace("_", " ")
        return (force.name, kind, " – ".join(force.between), place, "; ".join(filter(None, words)))
    turns = joint_coordinate(kinds[force.joint]) == "angle"
    units = ("rad", "N m") if turns else ("m", "N")
    if force.type == "motor":
        return (force.name, "motor", force.joint, "", _load(force.load, force.times, force.loads, units[1]))
    law = _law(force.stiffness, force.damping, force.deflections, units)
    rest = f"; rest {number_words(force.rest, units[0])}" if force.rest else ""
    return (force.name, "spring along a joint", force.joint, "", law + rest)


def _law(stiffness: float | None, damping: float, table: Sequence[float], units: tuple[str, str]) -> str:
    """Stiffness or table, and damping, of a spring."""
    place, load = units
    over = {"rad": "N m/rad", "m": "N/m"}[place], {"rad": "N m s/rad", "m": "N s/m"}[place]
    words = [f"table of {len(table)} points, {range_words(table, place)}"] if table else []
    words += [number_words(stiffness, over[0])] if stiffness else []
    words += [f"damping {number_words(damping, over[1])}"] if damping else []
    return ", ".join(words) or f"no {load}"


def _load(constant: Any, times: Sequence[float], table: Sequence[Any], unit: str) -> str:
    """A constant load, or the ranges of its table."""
    if constant is not None:
        given = [constant] if isinstance(constant, float) else constant
        return f"constant {numbers_words(given, unit) if len(given) > 1 else number_words(given[0], unit)}"
    values = np.array(table).reshape(len(times), -1)
    return (
        f"table of {len(times)} points, {range_words(times, 's')}; "
        f"smallest {numbers_words(values.min(axis=0).tolist(), unit)}, "
        f"largest {numbers_words(values.max(axis=0).tolist(), unit)}"
    )
