"""Joints, ropes and forces of a case in words and numbers for the report."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.channel_kinds import EDGE_JOINTS, JOINT_TRAVELS
from heavylift.pipeline.report_words import (
    number_words,
    numbers_words,
    profile_words,
    range_words,
    short_table,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from heavylift.pipeline.case import Case
    from heavylift.pipeline.report_document import Table

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
    if joint.type in EDGE_JOINTS:
        place = _edges(joint)
    elif at is not None:
        place = numbers_words(at, "m")
    else:
        place = " and ".join(numbers_words(point, "m") for point in joint.points)
    axes = getattr(joint, "axis", None), getattr(joint, "axes", None)
    axis = numbers_words(axes[0], "") if axes[0] is not None else ""
    if axes[1] is not None:
        axis = " and ".join(numbers_words(entry, "") for entry in axes[1])
    for key in ("second_axis", "slide_axis"):
        if getattr(joint, key, None) is not None:
            axis += f", {key.replace('_', ' ')} {numbers_words(getattr(joint, key), '')}"
    return (joint.name, joint.type.replace("_", "-"), " – ".join(joint.between), place, axis, _besides(joint))


def _edges(joint: Any) -> str:
    """Edges of a joint along them."""
    if joint.edge or joint.edges:
        return " and ".join(joint.edges or (joint.edge,))
    return " and ".join(f"nodes {numbers_words(nodes, '')}" for nodes in joint.node_lists)


def _besides(joint: Any) -> str:
    """Drive, limits, friction, compliance and length of a joint."""
    turns = JOINT_TRAVELS[joint.type] == {"angle"}
    words = []
    if getattr(joint, "drive", None) is not None:
        words.append(f"driven: {profile_words(joint.drive, 'rad' if turns else 'm')}")
    if getattr(joint, "limits", None) is not None:
        words.append(_limits(joint.limits, turns=turns))
    if getattr(joint, "friction", 0.0):
        words.append(f"friction {number_words(joint.friction, 'N m' if turns else 'N')}")
    if getattr(joint, "length", None) is not None:
        words.append(f"length {number_words(joint.length, 'm')}")
    if joint.compliance:
        words.append(f"compliance {joint.compliance:g} m/N")
    if joint.relaxation:
        words.append(f"relaxation {number_words(joint.relaxation, 's')}")
    return "; ".join(words)


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
    turns = JOINT_TRAVELS[kinds[force.joint]] == {"angle"}
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
